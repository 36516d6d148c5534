"""Objective functions for optimisers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase
from math import isfinite
from typing import TYPE_CHECKING, Any

from ._errors import SettingError

if TYPE_CHECKING:
    import numpy
    from numpy.typing import ArrayLike, NDArray

    from ._native import Parameter
    from ._program import Analysis, Value
    from ._table import Run

# distance from the limits of the text, which are open, as a share of their range, or of the size of a parameter without a
# range. A choice below all tolerances of manufacture
INSIDE = 1e-6


class Objective:
    """A function of scaled parameters, for optimisers.

    A parameter with two limits counts from 0 at the lower to 1 at the upper one. Another one counts in its value of the
    text.
    """

    parameters: list[str]
    """The paths of the parameters, in the order of the numbers."""
    start: NDArray[numpy.float64]
    """The parameters of the analysis."""
    bounds: list[tuple[float | None, float | None]]
    """The bounds of each number; `None` where the text has no limit."""
    run: Run | None
    """The last run."""
    runs: int
    """The number of runs so far."""

    def __init__(
        self,
        analysis: Analysis,
        value: str | Callable[[Run], float | tuple[float, Mapping[str, float]]],
        over: str | Sequence[str],
        gradient: bool,
        bounds: Mapping[str, tuple[Value, Value]] | None,
        maximise: bool,
        options: Mapping[str, Any],
    ) -> None:
        import numpy

        found = _found(analysis, [over] if isinstance(over, str) else over)
        self.parameters = [parameter.path for parameter in found]
        self._found = found
        self._analysis = analysis
        self._value = value if callable(value) else _of_report(analysis, value)
        self._gradient = gradient
        self._sign = -1.0 if maximise else 1.0
        self._options = dict(options)
        limits = _limits(analysis, found, bounds or {})
        # of each parameter: the value (SI) at 0, and the change (SI) to 1
        self._scales = [
            (low, high - low) if isfinite(low) and isfinite(high) else (0.0, abs(_si(parameter, parameter.value)) or 1.0)
            for parameter, (low, high) in zip(found, limits, strict=True)
        ]
        self._limited = [isfinite(low) and isfinite(high) for low, high in limits]
        starts = [_si(parameter, parameter.value) for parameter in found]
        self.start = numpy.array([(si - zero) / one for si, (zero, one) in zip(starts, self._scales, strict=True)])
        self.bounds = [
            tuple((limit - zero) / one if isfinite(limit) else None for limit in pair)  # type: ignore[misc]
            for pair, (zero, one) in zip(limits, self._scales, strict=True)
        ]
        self.run = None
        self.runs = 0

    @property
    def size(self) -> int:
        """How many numbers there are."""
        return len(self.parameters)

    def settings(self, x: ArrayLike) -> dict[str, float]:
        """The parameters (SI) of some numbers, as `Analysis.run` takes them."""
        import numpy

        numbers = numpy.asarray(x, dtype=float)
        if numbers.shape != (self.size,):
            raise ValueError(f"there are {self.size} parameters, not an array of shape {numbers.shape}")
        scaled = zip(self.parameters, numbers.tolist(), self._scales, strict=True)
        return {path: zero + number * one for path, number, (zero, one) in scaled}

    def scale(self, design: ArrayLike) -> list[dict[str, float]]:
        """The points of a design in the unit cube, such as those of `scipy.stats.qmc`, between the bounds."""
        import numpy

        for path, limited in zip(self.parameters, self._limited, strict=True):
            if not limited:
                raise SettingError(f"{path} has no two limits in the text: state bounds=")
        return [self.settings(row) for row in numpy.atleast_2d(numpy.asarray(design, dtype=float))]

    def __call__(self, x: ArrayLike) -> Any:
        """The value; with gradients, the pair of the value and an array of its derivatives by the numbers."""
        import numpy

        # none in place of those of the text, which take time and may fail
        options = {**self._options, "gradients": self.parameters if self._gradient else []}
        self.run = self._analysis.run(self.settings(x), **options)
        self.runs += 1
        found = self._value(self.run)
        if not self._gradient:
            return self._sign * float(found[0] if isinstance(found, tuple) else found)
        if not isinstance(found, tuple):
            raise TypeError("with gradients, the function returns a value and its derivatives by the paths of parameters")
        value, slopes = found
        # by the unit of the parameter, and that per number of the optimiser
        per = [one / parameter.si_scale for parameter, (_, one) in zip(self._found, self._scales, strict=True)]
        slope = [slopes[path] * by for path, by in zip(self.parameters, per, strict=True)]
        return self._sign * float(value), self._sign * numpy.array(slope, dtype=float)

    def __repr__(self) -> str:
        return f"<Objective of {self._analysis.name} over {', '.join(self.parameters)}>"


def _si(parameter: Parameter, shown: float) -> float:
    return shown * parameter.si_scale + parameter.si_offset


def _found(analysis: Analysis, over: Sequence[str]) -> list[Parameter]:
    """The parameters of some patterns."""
    known = analysis.parameters
    found: dict[str, Parameter] = {}
    for pattern in over:
        # brackets are parts of names
        literal = pattern.replace("[", "[[]")
        matching = [parameter for parameter in known if fnmatchcase(parameter.path, literal)]
        if not matching:
            # the engine names similar paths
            analysis.set({pattern: 0.0})
            raise SettingError(f"there is no parameter {pattern}")
        found |= {parameter.path: parameter for parameter in matching}
    if not found:
        raise SettingError("over: name at least one parameter")
    return list(found.values())


def _limits(
    analysis: Analysis, found: Sequence[Parameter], bounds: Mapping[str, tuple[Value, Value]]
) -> list[tuple[float, float]]:
    """The limits (SI) of parameters: those that the caller states, otherwise a little inside of those of the text."""
    for path in bounds:
        if path not in [parameter.path for parameter in found]:
            raise SettingError(f"bounds: {path} is not among the parameters of the objective")
    limits: list[tuple[float, float]] = []
    for parameter in found:
        if parameter.path in bounds:
            low, high = (_stated(analysis, parameter, value) for value in bounds[parameter.path])
            if not low < high:
                raise SettingError(f"bounds: the lower bound of {parameter.path} is not below the upper one")
        else:
            low, high = (_si(parameter, limit) for limit in (parameter.lower, parameter.upper))
            # without a range, the largest number at hand: the value alone may be zero
            known = [abs(number) for number in (low, high, _si(parameter, parameter.value)) if isfinite(number)]
            inside = INSIDE * (high - low if isfinite(high - low) else max(known, default=0.0))
            low, high = low + inside, high - inside
        limits.append((low, high))
    return limits


def _stated(analysis: Analysis, parameter: Parameter, value: Value) -> float:
    changed = analysis.set({parameter.path: value}).parameters
    return next(_si(other, other.value) for other in changed if other.path == parameter.path)


def _of_report(analysis: Analysis, value: str) -> Callable[[Run], tuple[float, Mapping[str, float]]]:
    """A value of a report, with its derivatives by the parameters of the run's gradients."""
    report, _, name = value.partition(".")
    if not name or report not in analysis.program.reports:
        known = ", ".join(analysis.program.reports)
        raise SettingError(f"{value}: name a report and its value, such as bearings.moft; the reports are: {known}")

    def evaluated(run: Run) -> tuple[float, Mapping[str, float]]:
        of = run.report(report)
        if name not in of.values:
            reason = of.missing.get(name)
            raise SettingError(f"{value}: {reason or 'the report has no such value; it has: ' + ', '.join(of.values)}")
        slopes = {}
        for path in run.gradients:
            by = run.report(report, by=path)
            if name not in by.values:
                raise SettingError(f"{value}: {by.missing.get(name, 'the value has no gradient')}")
            slopes[path] = by.values[name]
        return of.values[name], slopes

    return evaluated
