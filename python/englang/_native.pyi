"""The native part of `englang`."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Literal, SupportsFloat, SupportsIndex, TypeAlias, final

import numpy
from numpy.typing import NDArray

from ._diagnostics import Diagnostic

_Value: TypeAlias = str | SupportsFloat | SupportsIndex
_Path: TypeAlias = str | PathLike[str]

__version__: str

def load(path: _Path) -> Program:
    """Reads and checks a model's file with all that it uses from its folder."""

def from_text(text: str, *, name: str = "model.eng", files: Mapping[str, str] | None = None) -> Program:
    """Checks a text. `files` are further texts that it uses: other models and data, by their names."""

def si(text: str) -> float:
    """The number in SI units of a quantity such as "250 mm"."""

def cli(arguments: Sequence[str]) -> int:
    """Runs the command `eng` with arguments, of which the first is its name, and returns its exit code."""

@final
class Program:
    """A checked text: its models, analyses and reports."""

    @property
    def file(self) -> str:
        """The file's name."""

    @property
    def models(self) -> list[str]:
        """The names of its models."""

    @property
    def analyses(self) -> list[str]:
        """The names of its analyses, in the order of the text."""

    @property
    def reports(self) -> list[str]:
        """The names of its reports, in the order of the text."""

    @property
    def source_hash(self) -> str:
        """Hash of the texts, without reports."""

    def contents(self) -> list[tuple[str, bytes]]:
        """Names and contents of the files that it has opened, for a copy in another process."""

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """Warnings and notes of the check."""

    def model(self, name: str) -> Model:
        """Compiles a model."""

    def analysis(self, name: str) -> Analysis:
        """Compiles the model of an analysis. A model with the same constants is compiled once."""

    def report(self, name: str, *runs: Run) -> Report:
        """Evaluates a report of the text over runs of this text."""

@final
class Parameter:
    """A number of a model that changes without compiling again.

    `value` and the open limits `lower` and `upper` are in `unit`; `shown*si_scale + si_offset` is a value in SI units.
    """

    @property
    def path(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def dimension(self) -> str: ...
    @property
    def value(self) -> float: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def si_scale(self) -> float: ...
    @property
    def si_offset(self) -> float: ...

@final
class Input:
    """A number that a program sets while a simulation runs. The open limits are in `unit`."""

    @property
    def path(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def dimension(self) -> str: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def interpolation(self) -> Literal["hold", "linear", "cubic"]: ...

@final
class Channel:
    """A column that a run records. `frame` names the axes of a component, and is empty for a scalar."""

    @property
    def path(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def dimension(self) -> str: ...
    @property
    def frame(self) -> str: ...

@final
class Model:
    """A compiled model."""

    @property
    def name(self) -> str:
        """The model's name."""

    @property
    def summary(self) -> str:
        """One line: bodies, elements, unknowns, bytes of code."""

    @property
    def parameters(self) -> list[Parameter]:
        """All parameters with their values in the text."""

    @property
    def inputs(self) -> list[Input]:
        """All inputs."""

    @property
    def channels(self) -> list[Channel]:
        """All channels."""

    def simulation(
        self,
        set: Mapping[str, _Value] | None = None,
        *,
        step: _Value | None = None,
        tolerance: float | None = None,
        checkpoint: bytes | None = None,
    ) -> Simulation:
        """Starts a simulation, or continues one from a checkpoint of the same model with the same parameters."""

@final
class Simulation:
    """A running simulation. Numbers are in SI units. One thread at a time may use it."""

    @property
    def time(self) -> float:
        """Time (s)."""

    @property
    def cycle_angle(self) -> float | None:
        """Angle of the cycle (rad) since the start; `None` for a model without a cycle."""

    def step(self) -> float:
        """One step of the integrator. Returns the time reached (s)."""

    def advance(self, to: float) -> float:
        """Steps up to a time (s), which no step crosses. Returns the time reached. Ctrl-C ends it at a step."""

    def set_input(self, path: str, value: _Value) -> None:
        """Sets an input from the present time on."""

    def value(self, path: str) -> float:
        """The value of a channel at the present state."""

    def watch(self, *paths: str) -> Reading:
        """Plans the reading of channels. Calling the plan returns their values at the present state."""

    def checkpoint(self) -> bytes:
        """The state as bytes. A simulation that continues from them gives the same bits as this one."""

@final
class Reading:
    """A plan for reading channels of a simulation."""

    def __call__(self) -> tuple[float, ...]:
        """The values (SI) at the present state, in the order of the plan."""

@final
class Analysis:
    """An analysis of the text with its compiled model. It does not change: `set` returns another one."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def model(self) -> Model:
        """Its compiled model."""

    @property
    def parameters(self) -> list[Parameter]:
        """All parameters of its model with the values of this analysis."""

    @property
    def point(self) -> dict[str, float]:
        """The point of a sweep: the values of its indices in the units of the text."""

    def set(self, set: Mapping[str, _Value]) -> Analysis:
        """The analysis with other parameters, or with other words of choices."""

    def run(
        self,
        set: Mapping[str, _Value] | None = None,
        *,
        step: _Value | None = None,
        tolerance: float | None = None,
        channels: Sequence[str] | None = None,
        folder: _Path | None = None,
        resume: bool = False,
        threads: int = 1,
        gradients: Sequence[str] | None = None,
        patient: bool = False,
        progress: Callable[[float, float], object] | None = None,
    ) -> Run:
        """Runs the analysis; `englang.Analysis.run` explains the arguments."""

    def restored(self, packed: bytes) -> Run:
        """A run of this analysis that another process has packed."""

@final
class Run:
    """The results of an analysis: a table with a column for each channel, in the units of the text.

    Everything that reads Arrow takes it as it is: `polars.DataFrame(run)`, `pyarrow.table(run)`,
    `pandas.DataFrame.from_arrow(run)`.
    """

    @property
    def analysis(self) -> str:
        """The name of the analysis."""

    @property
    def model(self) -> str:
        """The name of the model."""

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns."""

    @property
    def metadata(self) -> dict[str, str]:
        """The entries that result files keep of a run: parameters, version, hash of the texts, facts about the start."""

    @property
    def point(self) -> dict[str, float]:
        """The point of a sweep: the values of its indices in the units of the text."""

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """The warnings of the run."""

    @property
    def gradients(self) -> dict[str, Gradient]:
        """The derivatives of the channels by the parameters of `gradients`, by the paths of these."""

    @property
    def facts(self) -> list[str]:
        """Facts about the run, a line each: steps, iterations, energy."""

    @property
    def failure(self) -> str | None:
        """The reason why the run ended early; `None` for a whole run."""

    def column(self, path: str) -> Column:
        """A column in the unit of the text."""

    def __getitem__(self, path: str, /) -> NDArray[numpy.float64]:
        """The numbers of a column in the unit of the text, as an array of NumPy for reading. It is no copy."""

    def si(self, path: str) -> NDArray[numpy.float64]:
        """The numbers of a column in SI units, as an array of NumPy for reading."""

    def __contains__(self, path: str, /) -> bool: ...
    def __len__(self) -> int:
        """The number of samples."""

    def select(self, *patterns: str) -> Run:
        """The run with the columns of some patterns only, such as `"main[*].force.*"`; time and cycle stay."""

    def report(self, name: str, *, by: str | None = None) -> Report:
        """Evaluates a report of the text over this run alone, or the derivatives of its values by a parameter of `gradients`."""

    def packed(self) -> bytes:
        """All that this run has, as bytes for `Analysis.restored` of the same analysis in another process."""

    def write_parquet(self, folder: _Path) -> Path:
        """Writes `ANALYSIS.parquet` into a folder, as `eng run` does, and returns its path."""

    def __arrow_c_schema__(self) -> object:
        """The schema of the table, for programs that read Arrow."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table, for programs that read Arrow. They share its memory."""

@final
class Gradient:
    """The derivatives of the channels of a run by a parameter: a table with the samples of the run.

    Each number is in the channel's unit per the parameter's unit. Everything that reads Arrow takes it as it is.
    """

    @property
    def parameter(self) -> str:
        """The path of the parameter."""

    @property
    def unit(self) -> str:
        """The unit of the parameter."""

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""

    @property
    def units(self) -> dict[str, str]:
        """The units of the columns."""

    def column(self, path: str) -> Column:
        """A column in the units of the text."""

    def __getitem__(self, path: str, /) -> NDArray[numpy.float64]:
        """The numbers of a column in the units of the text, as an array of NumPy for reading. It is no copy."""

    def si(self, path: str) -> NDArray[numpy.float64]:
        """The numbers of a column in SI units, as an array of NumPy for reading."""

    def __contains__(self, path: str, /) -> bool: ...
    def __len__(self) -> int:
        """The number of samples."""

    def __arrow_c_schema__(self) -> object:
        """The schema of the table, for programs that read Arrow."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The table, for programs that read Arrow. They share its memory."""

@final
class Column:
    """A column of results: 64-bit floats with a unit. `memoryview` and `numpy.asarray` read it without a copy."""

    @property
    def path(self) -> str:
        """`main[5].force.x`."""

    @property
    def unit(self) -> str:
        """The unit of its numbers."""

    @property
    def frame(self) -> str:
        """The axes of a component, as a path; empty for a scalar."""

    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> float: ...
    def __iter__(self) -> Iterator[float]: ...
    def __buffer__(self, flags: int, /) -> memoryview: ...

@final
class Condition:
    """A condition of a report: its message with the values, and whether it holds.

    A condition that only advises gives a warning.
    """

    @property
    def message(self) -> str: ...
    @property
    def holds(self) -> bool: ...
    @property
    def advises(self) -> bool: ...

@final
class Report:
    """A report of the text, evaluated over runs."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def title(self) -> str:
        """Its title."""

    @property
    def values(self) -> dict[str, float]:
        """Its values in the units of the text. The name of one of several numbers is `value.channel`."""

    @property
    def units(self) -> dict[str, str]:
        """The units of the values."""

    @property
    def conditions(self) -> list[Condition]:
        """Its conditions, in the order of the text."""

    @property
    def holds(self) -> bool:
        """Whether all its `require` hold."""

    @property
    def figures(self) -> dict[str, str]:
        """Its figures as texts of SVG."""

    @property
    def missing(self) -> dict[str, str]:
        """The entries that the runs do not give, with the reasons."""
