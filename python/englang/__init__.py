"""Eng: engines as text.

`load` or `from_text` checks a text, `Program.analysis` compiles the model of an analysis, `Analysis.run` gives a table. Texts
such as "250 mm" are quantities with units, and numbers are in SI units. Nothing here prints.
"""

from typing import TYPE_CHECKING, Any

from ._diagnostics import Diagnostic, Fix, Label, Place
from ._errors import Error, Interrupted, ModelError, RunError, SettingError
from ._native import Channel, Column, Input, Model, Parameter, Reading, Simulation, __version__
from ._program import Analysis, Program, from_text, load
from ._report import Condition, Figure, Report
from ._table import Gradient, Run, Table

if TYPE_CHECKING:
    from ._objective import Objective
    from ._study import Study

__all__ = [
    "Analysis",
    "Channel",
    "Column",
    "Condition",
    "Diagnostic",
    "Error",
    "Figure",
    "Fix",
    "Gradient",
    "Input",
    "Interrupted",
    "Label",
    "Model",
    "ModelError",
    "Objective",
    "Parameter",
    "Place",
    "Program",
    "Reading",
    "Report",
    "Run",
    "RunError",
    "SettingError",
    "Simulation",
    "Study",
    "Table",
    "__version__",
    "from_text",
    "load",
]


def __getattr__(name: str) -> Any:
    # these need more of Python than a program that only runs a model, so they are imported at their first use
    if name == "Objective":
        from ._objective import Objective

        return Objective
    if name == "Study":
        from ._study import Study

        return Study
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
