"""Programs and analyses. They travel to other processes as their texts."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, SupportsFloat, SupportsIndex, TypeAlias

from . import _native
from ._errors import Interrupted, RunError, SettingError
from ._quantities import texts_of
from ._report import Report
from ._table import Run

if TYPE_CHECKING:
    from concurrent.futures import Executor
    from os import PathLike
    from typing import TypedDict, Unpack

    from ._diagnostics import Diagnostic
    from ._native import Model, Parameter
    from ._objective import Objective
    from ._study import Study

Value: TypeAlias = str | SupportsFloat | SupportsIndex

if TYPE_CHECKING:

    class _Options(TypedDict, total=False):
        """Arguments of `Analysis.run` that several runs may share."""

        step: Value | None
        tolerance: float | None
        channels: str | Sequence[str] | None
        threads: int
        patient: bool

    class _StudyOptions(_Options, total=False):
        gradients: str | Sequence[str] | None


def load(path: str | bytes | PathLike[str] | PathLike[bytes]) -> Program:
    """Reads and checks a model's file with all that it uses from its folder."""
    return Program(_native.load(os.fsdecode(path)), None)


def from_text(text: str, *, name: str = "model.eng", files: Mapping[str, str] | None = None) -> Program:
    """Checks a text. `files` are further texts that it uses: other models and data, by their names."""
    kept = tuple(sorted((files or {}).items()))
    return Program(_native.from_text(text, name=name, files=dict(kept)), (text, name, kept))


class Program:
    """A checked text: its models, analyses and reports."""

    __slots__ = ("__weakref__", "_files", "_native", "_texts")

    def __init__(self, native: _native.Program, texts: tuple[str, str, tuple[tuple[str, str], ...]] | None) -> None:
        self._native = native
        # the arguments of `from_text`
        self._texts = texts
        # names and contents of the files of a loaded program, from its first pickling on
        self._files: tuple[tuple[str, bytes], ...] | None = None

    @property
    def file(self) -> str:
        """The file's name."""
        return self._native.file

    @property
    def models(self) -> list[str]:
        """The names of its models."""
        return self._native.models

    @property
    def analyses(self) -> list[str]:
        """The names of its analyses, in the order of the text."""
        return self._native.analyses

    @property
    def reports(self) -> list[str]:
        """The names of its reports, in the order of the text."""
        return self._native.reports

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """Warnings and notes of the check."""
        return self._native.warnings

    def model(self, name: str) -> Model:
        """Compiles a model."""
        return self._native.model(name)

    def analysis(self, name: str) -> Analysis:
        """Compiles the model of an analysis. A model with the same constants is compiled once."""
        return Analysis(self, name, {}, self._native.analysis(name))

    def report(self, name: str, *runs: Run) -> Report:
        """Evaluates a report of the text over runs of this text."""
        return Report(self._native.report(name, *(run._native for run in runs)))

    def study(
        self,
        analysis: str,
        points: object,
        *,
        values: Callable[[Run], float | Mapping[str, float]] | None = None,
        reports: str | Iterable[str] | None = None,
        executor: Executor | None = None,
        **options: Unpack[_StudyOptions],
    ) -> Study:
        """Runs an analysis at many points, and returns one table with a row for each, in their order.

        `points` are a list of dictionaries, a dictionary of lists, or a frame of pandas or polars. Their names are
        paths of parameters, such as `"length"`, or paths with a unit for all numbers, such as `"length [mm]"`. Each
        point has a row with the values of `reports`, which are all reports of the text if neither they nor `values`
        are named. `values` is a function of the run that gives a number, or several by their names. A point that
        fails has the message in its row. `executor` is any of `concurrent.futures`, such as a process pool or that
        of Dask; threads are the default. Further arguments are `step`, `tolerance`, `channels`, `threads`, `patient` and
        `gradients` of `Analysis.run`.
        """
        from ._study import studied

        _shared(options, {"gradients"})
        return studied(self.analysis(analysis), points, values, reports, executor, options)

    def objective(
        self,
        analysis: str,
        value: str | Callable[[Run], float | tuple[float, Mapping[str, float]]],
        over: str | Sequence[str],
        *,
        gradient: bool = True,
        bounds: Mapping[str, tuple[Value, Value]] | None = None,
        maximise: bool = False,
        **options: Unpack[_Options],
    ) -> Objective:
        """A function of scaled parameters for optimisers such as `scipy.optimize.minimize`.

        `value` is a value of a report, such as `"bearings.moft"`, or a function of the run. `over` are paths of
        parameters; `*` stands for any characters. With `gradient` it gives the pair of value and gradient that
        `jac=True` expects; a function of the run then returns its value and its derivatives by the paths. `bounds`
        take the place of limits in the text. Further arguments are `step`, `tolerance`, `channels`, `threads` and `patient`
        of `Analysis.run`.
        """
        from ._objective import Objective

        _shared(options, set())
        return Objective(self.analysis(analysis), value, over, gradient, bounds, maximise, options)

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[object, ...]:
        if self._texts is not None:
            return (_of_texts, self._texts)
        if self._files is None:
            # a study pickles the program for each of its tasks: the files are read once
            self._files = tuple((name, bytes(content)) for name, content in self._native.contents())
        return (_of_files, (self.file, self._files, self._native.source_hash))


def _shared(options: Mapping[str, object], more: set[str]) -> None:
    """Refuses arguments that several runs cannot share, such as a folder."""
    known = {"step", "tolerance", "channels", "threads", "patient"} | more
    for name in options:
        if name not in known:
            raise TypeError(f"{name} is no argument for many runs: there are {', '.join(sorted(known))}")


# programs that came from other processes; each is compiled once. A choice: few are in use at a time
_KEPT: dict[object, Program] = {}
_MOST = 8


def _kept(key: object, made: Callable[[], Program]) -> Program:
    program = _KEPT.get(key)
    if program is None:
        program = made()
        while len(_KEPT) >= _MOST:
            _KEPT.pop(next(iter(_KEPT)), None)
        _KEPT[key] = program
    return program


def _of_texts(text: str, name: str, files: tuple[tuple[str, str], ...]) -> Program:
    return _kept((text, name, files), lambda: from_text(text, name=name, files=dict(files)))


def _of_files(file: str, files: tuple[tuple[str, bytes], ...], source_hash: str) -> Program:
    return _kept((file, files), lambda: _unpacked(file, files, source_hash))


def _unpacked(file: str, files: tuple[tuple[str, bytes], ...], source_hash: str) -> Program:
    """The program of files in a folder that lasts as long as the program."""
    import shutil
    import tempfile
    from multiprocessing.util import Finalize
    from pathlib import Path

    folder = Path(tempfile.mkdtemp(prefix="englang-"))
    try:
        for name, content in files:
            place = folder / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
        program = load(folder / file)
        if program._native.source_hash != source_hash:
            raise SettingError(f"{file} has changed since it was loaded; load it again")
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    # `weakref.finalize` does not run at the end of a worker process, and runs in a forked process that drops the program
    # of its parent
    Finalize(program, shutil.rmtree, args=(folder,), kwargs={"ignore_errors": True}, exitpriority=0)
    return program


class Analysis:
    """An analysis of the text with its compiled model. It does not change: `set` returns another one."""

    __slots__ = ("_native", "_set", "program")

    program: Program
    """Its program."""

    def __init__(self, program: Program, name: str, set: Mapping[str, Value], native: _native.Analysis) -> None:
        self.program = program
        self._set = dict(set)
        self._native = native

    @property
    def name(self) -> str:
        """Its name."""
        return self._native.name

    @property
    def model(self) -> Model:
        """Its compiled model."""
        return self._native.model

    @property
    def parameters(self) -> list[Parameter]:
        """All parameters of its model with the values of this analysis."""
        return self._native.parameters

    @property
    def point(self) -> dict[str, float]:
        """The point of a sweep: the values of its indices in the units of the text."""
        return self._native.point

    def set(self, set: Mapping[str, Value]) -> Analysis:
        """The analysis with other parameters, or with other words of choices."""
        set = texts_of(set)
        return Analysis(self.program, self.name, {**self._set, **set}, self._native.set(set))

    def run(
        self,
        set: Mapping[str, Value] | None = None,
        *,
        step: Value | None = None,
        tolerance: float | None = None,
        channels: str | Sequence[str] | None = None,
        folder: str | PathLike[str] | None = None,
        resume: bool = False,
        threads: int = 1,
        gradients: str | Sequence[str] | None = None,
        patient: bool = False,
        progress: Callable[[float, float], object] | None = None,
    ) -> Run:
        """Runs the analysis. Other threads of Python go on meanwhile.

        `set` gives parameters other values: texts with units, quantities of pint, or numbers in SI units. `step` takes fixed steps and
        `tolerance` scales the allowed errors, in place of the text's. `channels` are patterns of the columns to keep.
        `folder` receives the samples during the run and `ANALYSIS.parquet` at its end; `resume` continues an
        interrupted run there. `threads` solve the films on cells of this run. `gradients` are paths of parameters by
        which the channels are differentiated, in place of those of the text. A run that would take more than a day is
        stopped, unless it is `patient`. `progress` is called up to twenty times a second with the finished part
        (0 to 1) and the time (s), and at the end with 1; its exception stops the run.
        """
        if progress is not None and not callable(progress):
            raise TypeError(f"progress is a function of two numbers, not {type(progress).__name__}")
        analysis = self if set is None else self.set(set)
        try:
            native = analysis._native.run(
                step=step,
                tolerance=tolerance,
                channels=_texts("channels", channels),
                folder=folder,
                resume=resume,
                threads=threads,
                gradients=_texts("gradients", gradients),
                patient=patient,
                progress=progress,
            )
        except (RunError, Interrupted) as error:
            if isinstance(error.partial, _native.Run):
                error.partial = Run(error.partial, analysis)
            raise
        if progress is not None:
            progress(1.0, native.column("time")[-1] if "time" in native and len(native) else 0.0)
        return Run(native, analysis)

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[object, ...]:
        return (_analysis_of, (self.program, self.name, self._set))


def _analysis_of(program: Program, name: str, set: Mapping[str, Value]) -> Analysis:
    analysis = program.analysis(name)
    return analysis.set(set) if set else analysis


def _texts(name: str, texts: str | Sequence[str] | None) -> list[str] | None:
    """A list of texts; one text is a list of one."""
    if texts is None:
        return None
    listed = [texts] if isinstance(texts, str) else list(texts)
    for text in listed:
        if not isinstance(text, str):
            raise TypeError(f"{name} are texts, not {type(text).__name__}")
    return listed
