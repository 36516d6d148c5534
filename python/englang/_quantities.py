"""Quantities of pint as texts with units. pint is not imported: an object with its methods is one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._errors import SettingError

if TYPE_CHECKING:
    from collections.abc import Mapping

# the units that remain at the end of all definitions of pint, with the units of Eng. pint has grams there; kilograms keep the bits of a
# mass in kilograms
ROOTS = {
    "meter": ("meter", "m"),
    "gram": ("kilogram", "kg"),
    "second": ("second", "s"),
    "kelvin": ("kelvin", "K"),
    "radian": ("radian", "rad"),
}


def text_of(name: str, value: Any) -> Any:
    """A quantity of pint as a text in SI units, such as `"9.81 m*s^-2"`; any other value as it is.

    The text has the unit, so that a wrong dimension is refused. `float` of a quantity without a dimension would be a number without a
    unit: 30 degrees would count as 0.52 m. `name` is the parameter's, for messages.
    """
    if not (hasattr(value, "to_root_units") and hasattr(value, "unit_items")):
        return value
    theirs: list[str] = []
    ours: list[str] = []
    for root, exponent in value.to_root_units().unit_items():
        if root not in ROOTS:
            raise SettingError(f"{name}: there is no unit {root} in Eng; {value} has it")
        if exponent != int(exponent):
            raise SettingError(f"{name}: {value} has a root of a unit")
        pint, unit = ROOTS[root]
        theirs.append(f"{pint} ** {int(exponent)}")
        ours.append(unit if exponent == 1 else f"{unit}^{int(exponent)}")
    try:
        number = float(value.to(" * ".join(theirs)).magnitude)
    except TypeError:
        raise TypeError(f"{name}: a value is one number, not {value}") from None
    return f"{number!r} {'*'.join(ours)}".rstrip()


def texts_of(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of parameters, with quantities of pint as texts."""
    return {name: text_of(name, value) for name, value in {**values}.items()}
