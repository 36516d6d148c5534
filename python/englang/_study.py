"""Studies: an analysis at many points."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from . import _display, _native
from ._errors import Error, SettingError
from ._frames import frame_of, imported, rows_of
from ._quantities import text_of

if TYPE_CHECKING:
    import pandas
    import polars

    from ._program import Analysis, Value
    from ._table import Run

Values = Callable[["Run"], "float | Mapping[str, float]"]

# columns about the outcome of a point, behind its numbers
OUTCOME = ("state", "code", "message", "place")
# tasks for each worker of an executor. A choice: enough for an even load. Each task carries the program with its files,
# which may be large meshes
TASKS_EACH = 4
# workers of an executor that does not tell their number. A choice: enough tasks for a small cluster
WORKERS = 64


@dataclass(frozen=True)
class Study:
    """The results of a study: one row for each point, in the order of the points.

    The columns are the parameters of the points, the values, and `state` (`complete` or `failed`), `code`, `message`
    and `place` of a failure. The numbers of a failed point are `None`.
    """

    analysis: str
    """The name of the analysis."""
    rows: list[dict[str, Any]]
    """A dictionary for each point. All have the same names."""
    units: dict[str, str]
    """The units of the numbers, as far as the text has them."""

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return list(self.rows[0]) if self.rows else []

    @property
    def failures(self) -> list[dict[str, Any]]:
        """The rows of failed points."""
        return [row for row in self.rows if row["state"] == "failed"]

    def __len__(self) -> int:
        """The number of points."""
        return len(self.rows)

    def __getitem__(self, column: str) -> list[Any]:
        """A column as a list."""
        if column not in self.columns:
            raise KeyError(f"the study has no column {column}; it has: {', '.join(self.columns)}")
        return [row[column] for row in self.rows]

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a frame of pandas. `attrs["units"]` has the units."""
        frame: pandas.DataFrame = frame_of(imported("pandas"), {name: self[name] for name in self.columns})
        frame.attrs["units"] = self.units
        return frame

    def to_polars(self) -> polars.DataFrame:
        """The table as a frame of polars."""
        frame: polars.DataFrame = frame_of(imported("polars"), {name: self[name] for name in self.columns})
        return frame

    def __repr__(self) -> str:
        return f"<Study of {self.analysis}: {len(self)} points, {len(self.failures)} failed>"

    def _repr_html_(self) -> str:
        """The first rows with units, for notebooks."""
        return _display.study(self)


@dataclass
class _Point:
    """The numbers of a point, with their units."""

    numbers: dict[str, Any]
    units: dict[str, str]
    outcome: dict[str, str | None]


class _Misnamed(SettingError):
    """The function of a user names columns that the study has. It ends the study."""


@dataclass(frozen=True)
class _Task:
    """What a process needs for its part of the points."""

    analysis: Analysis
    values: Values | None
    reports: tuple[str, ...]
    paths: tuple[str, ...]
    options: Mapping[str, Any]

    def all(self, settings: Sequence[Mapping[str, Value]]) -> list[_Point]:
        return [self.one(setting) for setting in settings]

    def one(self, setting: Mapping[str, Value]) -> _Point:
        """Runs a point. A failure is a result."""
        try:
            numbers, units, message = self.evaluated(self.analysis.run(setting, **self.options))
        except _Misnamed:
            raise
        except Exception as error:  # the values of a user may raise anything
            return _failed(error)
        return _Point(numbers, units, {"state": "complete", "code": None, "message": message, "place": None})

    def evaluated(self, run: Run) -> tuple[dict[str, Any], dict[str, str], str | None]:
        """The numbers of a run with their units, and the requirements that do not hold."""
        numbers: dict[str, Any] = {}
        units: dict[str, str] = {}
        broken: list[str] = []
        for name in self.reports:
            report = run.report(name)
            for value, number in report.values.items():
                numbers[f"report.{name}.{value}"] = number
                units[f"report.{name}.{value}"] = report.units[value]
            if report.conditions:
                numbers[f"report.{name}.holds"] = report.holds
            broken += [c.message for c in report.conditions if not (c.holds or c.advises)]
        if self.values is not None:
            found = self.values(run)
            of_user = found if isinstance(found, Mapping) else {"value": found}
            taken = [name for name in of_user if name in numbers or name in self.paths or name in OUTCOME]
            if taken:
                raise _Misnamed(f"values: {', '.join(taken)} are columns of the study already; choose other names")
            numbers.update(of_user)
        return numbers, units, "; ".join(broken) or None


def _failed(error: BaseException) -> _Point:
    outcome: dict[str, str | None] = {"state": "failed", "code": None, "place": None}
    outcome["message"] = str(error) if isinstance(error, Error) else f"{type(error).__name__}: {error}"
    if isinstance(error, Error) and error.diagnostics:
        first = error.diagnostics[0]
        outcome |= {"code": first.code, "message": first.title, "place": str(first.place) if first.place else None}
    return _Point({}, {}, outcome)


def studied(
    analysis: Analysis,
    points: object,
    values: Values | None,
    reports: str | Iterable[str] | None,
    executor: Executor | None,
    options: Mapping[str, Any],
) -> Study:
    """See `Program.study`."""
    names = _reports(analysis, values, reports)
    settings, shown, units = _settings(analysis, rows_of(points))
    paths = tuple(dict.fromkeys(path for point in shown for path in point))
    task = _Task(analysis, values, names, paths, options)
    done = _in_threads(task, settings) if executor is None else _gathered(executor, task, settings)
    numbers = list(dict.fromkeys(name for point in done for name in point.numbers))
    rows = [
        {path: point.get(path) for path in paths}
        | {name: result.numbers.get(name) for name in numbers}
        | {name: result.outcome[name] for name in OUTCOME}
        for point, result in zip(shown, done, strict=True)
    ]
    for result in done:
        units |= result.units
    return Study(analysis.name, rows, units)


def _reports(analysis: Analysis, values: Values | None, reports: str | Iterable[str] | None) -> tuple[str, ...]:
    known = analysis.program.reports
    if reports is None:
        if values is None and not known:
            raise SettingError("the text has no report: state values=, a function of the run")
        return tuple(known) if values is None else ()
    names = (reports,) if isinstance(reports, str) else tuple(reports)
    for name in names:
        if name not in known:
            raise SettingError(f"there is no report {name}; there are: {', '.join(known)}")
    return names


def _settings(
    analysis: Analysis, rows: Sequence[Mapping[str, Any]]
) -> tuple[list[dict[str, Value]], list[dict[str, Any]], dict[str, str]]:
    """What a run gets at each point, what the table shows of it, and the units there."""
    units: dict[str, str] = {}
    settings: list[dict[str, Value]] = []
    shown: list[dict[str, Any]] = []
    parameters = {parameter.path: parameter for parameter in analysis.parameters}
    for row in rows:
        setting: dict[str, Value] = {}
        point: dict[str, Any] = {}
        for name, value in row.items():
            path, unit = _split(name)
            # a frame has no other sign for a parameter that a point does not set
            if value is None:
                continue
            if path in setting:
                raise SettingError(f"{path} is stated twice")
            value = text_of(path, value)
            parameter = parameters.get(path)
            with_unit = unit is not None and not isinstance(value, str)
            setting[path] = f"{float(value)!r} {unit}" if with_unit else value
            if parameter is None:
                # a word of a choice
                point[path] = value
                continue
            if unit is not None and with_unit:
                point[path] = float(value)
            else:
                si = _native.si(value) if isinstance(value, str) else float(value)
                point[path], unit = (si - parameter.si_offset) / parameter.si_scale, parameter.unit
            if units.setdefault(path, unit) != unit:
                raise SettingError(f"{path}: the points have it in {units[path]} and in {unit}; use one of them")
        # a name or a unit that is wrong is a mistake of the caller, not a failure of a point
        analysis.set(setting)
        settings.append(setting)
        shown.append(point)
    return settings, shown, units


def _split(name: str) -> tuple[str, str | None]:
    """`length [mm]` as path and unit."""
    found = re.fullmatch(r"(.*\S)\s+\[(.+)\]", name)
    return (found[1], found[2]) if found else (name, None)


def _gathered(executor: Executor, task: _Task, settings: Sequence[Mapping[str, Value]]) -> list[_Point]:
    """The results of an executor, in the order of the points."""
    # threads carry nothing, and end sooner after small tasks
    known = None if isinstance(executor, ThreadPoolExecutor) else getattr(executor, "_max_workers", None)
    workers: int = known or WORKERS
    each = -(-len(settings) // (TASKS_EACH * workers)) or 1
    parts = [settings[begin : begin + each] for begin in range(0, len(settings), each)]
    futures: list[Future[list[_Point]]] = []
    done: list[_Point] = []
    lost: list[BaseException] = []
    try:
        for part in parts:
            futures.append(executor.submit(task.all, part))
        for future, part in zip(futures, parts, strict=True):
            try:
                done += future.result()
            except _Misnamed:
                raise
            except Exception as error:  # a lost worker costs its points only
                lost.append(error)
                done += [_failed(error) for _ in part]
    finally:
        for future in futures:
            future.cancel()
    if lost and len(lost) == len(parts):
        # no point at all: the executor cannot do this work
        raise lost[0]
    return done


class _Stopped(BaseException):
    """Ctrl-C has ended the study. A point that fails is an `Exception`, after which the study goes on."""


def _in_threads(task: _Task, settings: Sequence[Mapping[str, Value]]) -> list[_Point]:
    """The results of threads, as many as this process may use processors."""
    stopped = threading.Event()

    def progress(_fraction: float, _time: float) -> None:
        if stopped.is_set():
            raise _Stopped

    watched = replace(task, options={**task.options, "progress": progress})
    affinity = getattr(os, "sched_getaffinity", None)
    workers = len(affinity(0)) if affinity is not None else os.cpu_count()
    with ThreadPoolExecutor(workers) as pool:
        try:
            return _gathered(pool, watched, settings)
        except BaseException:
            stopped.set()
            raise
