"""Tables, runs, reports, studies and errors in notebooks: short texts of HTML."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._report import Report
    from ._study import Study
    from ._table import Run, Table

# most rows and columns of a table, and most figures of a report; choices for a page that is read
ROWS, COLUMNS, FIGURES = 5, 8, 4


def number(value: object) -> str:
    """A number with the digits that a reader compares."""
    return f"{value:.6g}" if isinstance(value, float) else escape(str(value))


def _table(head: Iterable[str], rows: Iterable[Sequence[object]]) -> str:
    titles = "".join(f"<th>{title}</th>" for title in head)
    lines = ("".join(f"<td>{number(cell)}</td>" for cell in row) for row in rows)
    return f"<table><thead><tr>{titles}</tr></thead><tbody>{''.join(f'<tr>{line}</tr>' for line in lines)}</tbody></table>"


def _titles(columns: Sequence[str], units: dict[str, str]) -> list[str]:
    # the unit of a number without a dimension is 1
    with_unit = ((escape(path), escape(units.get(path, "1"))) for path in columns)
    return [path if unit == "1" else f"{path}<br>[{unit}]" for path, unit in with_unit]


def _lengths(rows: int, what: str, columns: int) -> str:
    more = f", of which {COLUMNS} are here" if columns > COLUMNS else ""
    return f"{rows} {what}, {columns} columns{more}"


def table(of: Table[Any]) -> str:
    """The first rows of a table with units, and its size."""
    paths = of.columns[:COLUMNS]
    columns = [of.column(path) for path in paths]
    shown = min(ROWS, len(of))
    rows = [[column[row] for column in columns] for row in range(shown)]
    if len(of) > shown:
        rows.append(["…" for _ in columns])  # type: ignore[misc]
    size = _lengths(len(of), "samples", len(of.columns))
    return f"<div><p>{escape(repr(of).strip('<>').split(':')[0])}: {size}</p>{_table(_titles(paths, of.units), rows)}</div>"


def run(of: Run) -> str:
    """The first rows of a run, and values, conditions and figures of the reports over this run alone."""
    parts = [table(of)]
    room = FIGURES
    for name in of.reports:
        found = of.report(name)
        # a report over other analyses has nothing to show here
        if found.values or found.conditions or found.figures:
            parts.append(_entries(found, room))
            room = max(room - len(found.figures), 0)
    return f"<div>{''.join(parts)}</div>"


def study(of: Study) -> str:
    """The first rows of a study with units, and its size."""
    paths = of.columns[:COLUMNS]
    rows = [["" if of.rows[row][path] is None else of.rows[row][path] for path in paths] for row in range(min(ROWS, len(of)))]
    failed = f", {len(of.failures)} failed" if of.failures else ""
    size = _lengths(len(of), "points", len(of.columns))
    return f"<div><p>Study of {escape(of.analysis)}: {size}{failed}</p>{_table(_titles(paths, of.units), rows)}</div>"


def report(of: Report) -> str:
    """Values, conditions and the first figures of a report, and the reasons for missing entries."""
    missing = "".join(f"<p>{escape(name)}: {escape(reason)}</p>" for name, reason in of.missing.items())
    return f"<div>{_entries(of, FIGURES)}{missing}</div>"


def _entries(of: Report, most: int) -> str:
    """Values, conditions and at most so many figures of a report."""
    parts = [f"<h4>{escape(of.title or of.name)}</h4>"]
    if of.values:
        rows = [(name, value, of.units[name]) for name, value in of.values.items()]
        parts.append(_table(["value", "", "unit"], rows))
    for condition in of.conditions:
        mark = "✓" if condition.holds else "⚠" if condition.advises else "✗"
        # a condition that holds has nothing to say
        parts.append(f"<p>{mark} {escape(condition.message) if not condition.holds else 'a condition holds'}</p>")
    figures = list(of.figures.items())
    parts.extend(f"<div>{_picture(name, svg)}</div>" for name, svg in figures[:most])
    if len(figures) > most:
        parts.append(f"<p>{len(figures) - most} more figures: <code>figures</code> of the report {escape(of.name)}</p>")
    return "".join(parts)


def _picture(name: str, svg: str) -> str:
    """A figure as wide as the cell at most.

    As a picture of its own it keeps its identifiers: those of its clip areas would be the ones of other figures of the page.
    """
    coded = b64encode(svg.encode()).decode()
    return f'<img alt="{escape(name)}" style="max-width: 100%" src="data:image/svg+xml;base64,{coded}">'
