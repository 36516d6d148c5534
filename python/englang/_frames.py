"""Frames of pandas and polars, which are imported when they are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas
    import polars

    from ._table import Table


def imported(name: str) -> Any:
    """A package that is not required."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise ModuleNotFoundError(f"this needs {name}: pip install {name}", name=name) from None


def pandas_of(table: Table[Any]) -> pandas.DataFrame:
    """A table as a frame of pandas."""
    frame = frame_of(imported("pandas"), {path: table[path] for path in table.columns})
    frame.attrs["units"] = table.units
    return frame


def polars_of(table: Table[Any]) -> polars.DataFrame:
    """A table as a frame of polars."""
    frame: polars.DataFrame = imported("polars").DataFrame(table)
    return frame


def frame_of(package: Any, columns: Mapping[str, Any]) -> Any:
    """Columns as a frame of pandas or polars."""
    return package.DataFrame(dict(columns))


def rows_of(points: object) -> list[dict[str, Any]]:
    """The rows of a list of mappings, a mapping of columns, a frame of pandas or polars, or a table of pyarrow."""
    if isinstance(points, Mapping):
        return _rows_of_columns(points)
    for method in ("to_dicts", "to_pylist"):
        if hasattr(points, method):
            return [dict(row) for row in getattr(points, method)()]
    if hasattr(points, "to_dict"):
        return [_stated(row) for row in points.to_dict("records")]
    if isinstance(points, str) or not hasattr(points, "__iter__"):
        raise TypeError(_FORMS)
    rows = list(points)
    if not all(isinstance(row, Mapping) for row in rows):
        raise TypeError(_FORMS)
    return [dict(row) for row in rows]


def _stated(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row of pandas without its missing values, which are NaN or `pandas.NA` there."""
    pandas = imported("pandas")
    scalar = pandas.api.types.is_scalar
    return {name: value for name, value in row.items() if not (scalar(value) and pandas.isna(value))}


_FORMS = "points are a list of dictionaries, a dictionary of lists, or a frame of pandas or polars"


def _rows_of_columns(points: Mapping[str, Any]) -> list[dict[str, Any]]:
    for name, column in points.items():
        if isinstance(column, str) or not hasattr(column, "__iter__"):
            raise TypeError(f"{name}: a column of points is a list of values, not {type(column).__name__}")
    columns = {name: list(column) for name, column in points.items()}
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        stated = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ValueError(f"the columns of points have different lengths: {stated}")
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
