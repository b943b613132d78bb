"""Units, parsed once at the border: "5 mm", "30.738 kN/mm", "-20 degC" -> plain numbers.

Inside the package every number is in kN, mm, s, degC and J = kN mm. pint does the
conversions; it is imported only when a quantity is actually parsed.
"""

import math
import re
from functools import cache
from typing import Any

from thermobearing.errors import InputError

_NUMBER_AND_UNIT = re.compile(
    r"^\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\S.*?)?\s*$"
)
CUBIC_MM_PER_CUBIC_M = 1e9
NEWTON_PER_KILONEWTON = 1e3

# What a person may write for a unit that pint spells otherwise.
_SPELLINGS = {"°C": "degC", "C": "degC", "℃": "degC", "%": "percent", "tonf": "metric_ton_force"}


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)


@cache
def conversion(unit: str, target: str) -> tuple[float, float]:
    """Scale and offset from `unit` to `target`; InputError if that makes no sense."""
    import pint

    registry = _registry()
    try:
        zero = registry.Quantity(0.0, _SPELLINGS.get(unit, unit)).to(target).magnitude
        one = registry.Quantity(1.0, _SPELLINGS.get(unit, unit)).to(target).magnitude
    except pint.DimensionalityError:
        raise InputError(f'unit "{unit}" cannot be converted to {target}') from None
    except (pint.UndefinedUnitError, pint.PintError, AttributeError, TypeError, ValueError):
        raise InputError(f'unknown unit "{unit}"; expected {target} or a unit like it') from None
    if zero != 0.0 and target != "degC":
        raise InputError(f'"{unit}" is a temperature; a difference is given in {target}')
    scale = 1.0 if _SPELLINGS.get(unit, unit) == target else one - zero
    return scale, zero


def parse_quantity(text: str, unit: str) -> float:
    """Number with unit, as text, converted to `unit`.

    Parameters
    ----------
    text : such as "5 mm", "0.31 W/(m K)", "-20 degC".
    unit : unit of the returned number.

    Raises
    ------
    InputError : no number, no unit, a unit of another kind, or a number that is not finite.

    Examples
    --------
    >>> parse_quantity("3.2 cm", "mm")
    32.0
    """
    match = _NUMBER_AND_UNIT.match(text)
    if match is None:
        raise InputError(f'"{text}" is not a number with a unit, such as "1.5 {unit}"')
    if not match["unit"]:
        raise InputError(f'"{text}" has no unit; write "{text.strip()} {unit}" if that is meant')
    scale, offset = conversion(match["unit"], unit)
    value = float(match["number"]) * scale + offset
    if not math.isfinite(value):
        raise InputError(f'"{text}" is not a finite number')
    return value


def with_unit(value: float, unit: str) -> str:
    """The text that `parse_quantity` reads back to the same bits."""
    return f"{value!r} {unit}"
