"""Eng: engines as text.

`load` or `from_text` checks a text, `Program.analysis` compiles the model of an analysis, `Analysis.run` gives a table. Texts
such as "250 mm" are quantities with units, and numbers are in SI units. Nothing here prints.
"""

from ._diagnostics import Diagnostic, Fix, Label, Place
from ._errors import Error, Interrupted, ModelError, RunError, SettingError
from ._native import (
    Analysis,
    Channel,
    Column,
    Condition,
    Gradient,
    Input,
    Model,
    Parameter,
    Program,
    Reading,
    Report,
    Run,
    Simulation,
    __version__,
    from_text,
    load,
)

__all__ = [
    "Analysis",
    "Channel",
    "Column",
    "Condition",
    "Diagnostic",
    "Error",
    "Fix",
    "Gradient",
    "Input",
    "Interrupted",
    "Label",
    "Model",
    "ModelError",
    "Parameter",
    "Place",
    "Program",
    "Reading",
    "Report",
    "Run",
    "RunError",
    "SettingError",
    "Simulation",
    "__version__",
    "from_text",
    "load",
]
