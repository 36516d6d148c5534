"""Reports of a text over runs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import _native


@dataclass(frozen=True)
class Condition:
    """A condition of a report: its message with the values, and whether it holds.

    A condition that only advises gives a warning.
    """

    message: str
    holds: bool
    advises: bool


class Figure(str):
    """A figure of a report: a text of SVG that notebooks show as a picture."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        """The picture, for notebooks."""
        return str(self)


class Report:
    """A report of the text, evaluated over runs."""

    def __init__(self, native: _native.Report) -> None:
        self._native: _native.Report | None = native
        self.name: str = native.name
        """Its name."""
        self.title: str = native.title
        """Its title."""
        self.values: dict[str, float] = native.values
        """Its values in the units of the text. The name of one of several numbers is `value.channel`."""
        self.units: dict[str, str] = native.units
        """The units of the values."""
        self.conditions: list[Condition] = [
            Condition(condition.message, condition.holds, condition.advises) for condition in native.conditions
        ]
        """Its conditions, in the order of the text."""
        self.holds: bool = native.holds
        """Whether all its `require` hold."""
        self.missing: dict[str, str] = native.missing
        """The entries that the runs do not give, with the reasons."""

    @cached_property
    def figures(self) -> dict[str, Figure]:
        """Its figures as texts of SVG."""
        figures = {} if self._native is None else self._native.figures
        return {name: Figure(svg) for name, svg in figures.items()}

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "figures": self.figures, "_native": None}

    def __repr__(self) -> str:
        return f"<Report {self.name}: {len(self.values)} values, {len(self.conditions)} conditions>"

    def _repr_html_(self) -> str:
        """Values, conditions and figures, for notebooks."""
        from . import _display

        return _display.report(self)
