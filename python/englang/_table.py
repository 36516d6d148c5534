"""Tables of a run: its samples, and their derivatives by a parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, TypeVar

from ._frames import pandas_of, polars_of
from ._report import Report

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    import numpy
    import pandas
    import polars
    from numpy.typing import NDArray

    from . import _native
    from ._diagnostics import Diagnostic
    from ._native import Column
    from ._program import Analysis

_Native = TypeVar("_Native", "_native.Run", "_native.Gradient")


class Table(Generic[_Native]):
    """A table with a column for each channel, in the units of the text.

    Everything that reads Arrow takes it as it is: `polars.DataFrame(run)`, `pyarrow.table(run)`.
    """

    __slots__ = ("_native",)
    _native: _Native

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return self._native.columns

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns."""
        return self._native.units

    def column(self, path: str) -> Column:
        """A column in the unit of the text."""
        return self._native.column(path)

    def __getitem__(self, path: str) -> NDArray[numpy.float64]:
        """The numbers of a column in the unit of the text, as an array of NumPy for reading. It is no copy."""
        return self._native[path]

    def si(self, path: str) -> NDArray[numpy.float64]:
        """The numbers of a column in SI units, as an array of NumPy for reading."""
        return self._native.si(path)

    def __contains__(self, path: str) -> bool:
        return path in self._native

    # an index that is no name has an error; without this, `iter` would ask for column 0
    __iter__ = None

    def __len__(self) -> int:
        """The number of samples."""
        return len(self._native)

    def to_pandas(self, *patterns: str) -> pandas.DataFrame:
        """The columns of some patterns as a frame of pandas; all without a pattern. `attrs["units"]` has the units."""
        return pandas_of(self._kept(patterns))

    def to_polars(self, *patterns: str) -> polars.DataFrame:
        """The columns of some patterns as a frame of polars; all without a pattern."""
        return polars_of(self._kept(patterns))

    def _kept(self, patterns: tuple[str, ...]) -> Table[Any]:
        raise NotImplementedError

    def __arrow_c_schema__(self) -> object:
        """The schema of the table, for programs that read Arrow."""
        return self._native.__arrow_c_schema__()

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table, for programs that read Arrow. They share its memory."""
        return self._native.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return repr(self._native)

    def _repr_html_(self) -> str:
        """The first rows with units, for notebooks."""
        from . import _display

        return _display.table(self)


class Run(Table["_native.Run"]):
    """The results of an analysis: a table with a column for each channel, in the units of the text.

    Everything that reads Arrow takes it as it is: `polars.DataFrame(run)`, `pyarrow.table(run)`,
    `pandas.DataFrame.from_arrow(run)`.
    """

    __slots__ = ("_of",)

    def __init__(self, native: _native.Run, of: Analysis) -> None:
        self._native = native
        self._of = of

    @property
    def analysis(self) -> str:
        """The name of the analysis."""
        return self._native.analysis

    @property
    def model(self) -> str:
        """The name of the model."""
        return self._native.model

    @property
    def metadata(self) -> dict[str, str]:
        """The entries that result files keep of a run: parameters, version, hash of the texts, facts about the start."""
        return self._native.metadata

    @property
    def point(self) -> dict[str, float]:
        """The point of a sweep: the values of its indices in the units of the text."""
        return self._native.point

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The warnings of the run."""
        return self._native.warnings

    @property
    def gradients(self) -> dict[str, Gradient]:
        """The derivatives of the channels by the parameters of `gradients`, by the paths of these."""
        return {path: Gradient(self, native) for path, native in self._native.gradients.items()}

    @property
    def facts(self) -> list[str]:
        """Facts about the run, a line each: steps, iterations, energy."""
        return self._native.facts

    @property
    def failure(self) -> str | None:
        """The reason why the run ended early; `None` for a whole run."""
        return self._native.failure

    def select(self, *patterns: str) -> Run:
        """The run with the columns of some patterns only, such as `"main[*].force.*"`; time and cycle stay."""
        return Run(self._native.select(*patterns), self._of)

    def _kept(self, patterns: tuple[str, ...]) -> Run:
        return self.select(*patterns) if patterns else self

    @property
    def reports(self) -> list[str]:
        """The names of the reports of its text, some of which may be about other analyses."""
        return self._of.program.reports

    def report(self, name: str, *, by: str | None = None) -> Report:
        """Evaluates a report of the text over this run alone; see `Program.report`.

        With `by`, its values are the derivatives by a parameter of `gradients`.
        """
        return Report(self._native.report(name) if by is None else self._native.report(name, by=by))

    def write_parquet(self, folder: str | PathLike[str]) -> Path:
        """Writes `ANALYSIS.parquet` into a folder, as `eng run` does, and returns its path."""
        return self._native.write_parquet(folder)

    def _repr_html_(self) -> str:
        """The first rows with units, and values and figures of the reports over this run alone, for notebooks."""
        from . import _display

        return _display.run(self)

    def __reduce__(self) -> tuple[object, ...]:
        return (_restored, (self._of, self._native.packed()))


def _restored(of: Analysis, packed: bytes) -> Run:
    """The run of an analysis that another process has made."""
    return Run(of._native.restored(packed), of)


class Gradient(Table["_native.Gradient"]):
    """The derivatives of the channels of a run by a parameter: a table with the samples of the run.

    Each number is in the channel's unit per the parameter's unit. Everything that reads Arrow takes it as it is.
    """

    __slots__ = ("_of",)

    def __init__(self, of: Run, native: _native.Gradient) -> None:
        self._native = native
        self._of = of

    @property
    def parameter(self) -> str:
        """The path of the parameter."""
        return self._native.parameter

    @property
    def unit(self) -> str:
        """The unit of the parameter."""
        return self._native.unit

    def _kept(self, patterns: tuple[str, ...]) -> Gradient:
        return self._of.select(*patterns).gradients[self.parameter] if patterns else self

    def __reduce__(self) -> tuple[object, ...]:
        return (_gradient_of, (self._of, self.parameter))


def _gradient_of(of: Run, parameter: str) -> Gradient:
    return of.gradients[parameter]
