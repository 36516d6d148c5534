"""Messages about a text, with their places and fixes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Place:
    """A place in a text. Lines and columns count from 1, `start` and `end` are bytes from 0; the ends are exclusive."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    start: int
    end: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True)
class Label:
    """A place with a few words. The primary ones are the places of the mistake."""

    place: Place | None
    message: str
    primary: bool


@dataclass(frozen=True)
class Fix:
    """A change of the text that corrects the mistake."""

    title: str
    place: Place | None
    replacement: str


@dataclass(frozen=True)
class Diagnostic:
    """A message: its code, one sentence, places, further facts, remedies, fixes."""

    severity: Literal["error", "warning", "note"]
    code: str
    title: str
    place: Place | None
    labels: tuple[Label, ...]
    notes: tuple[str, ...]
    help: tuple[str, ...]
    fixes: tuple[Fix, ...]

    def __str__(self) -> str:
        before = f"{self.place}: " if self.place else ""
        return f"{before}{self.severity} {self.code}: {self.title}"


def parsed(messages: str) -> tuple[Diagnostic, ...]:
    """The messages of the JSON that `eng check --format json` prints."""
    # most programs have no messages, and this import takes long
    import json

    return tuple(_diagnostic(entry) for entry in json.loads(messages)["diagnostics"])


def _diagnostic(entry: dict[str, Any]) -> Diagnostic:
    return Diagnostic(
        severity=entry["severity"],
        code=entry["code"],
        title=entry["title"],
        place=_place(entry),
        labels=tuple(Label(_place(label), label["message"], label["primary"]) for label in entry["labels"]),
        notes=tuple(entry["notes"]),
        help=tuple(entry["help"]),
        fixes=tuple(Fix(fix["title"], _place(fix), fix["replacement"]) for fix in entry["fixes"]),
    )


def _place(entry: dict[str, Any]) -> Place | None:
    if entry["file"] is None:
        return None
    return Place(**{name: entry[name] for name in Place.__dataclass_fields__})
