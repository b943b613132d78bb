"""Conversion of text with units ("5 mm", "30.738 kN/mm", "-20 degC") to plain numbers.

Inside the package every number is in kN, mm, s, degC and J = kN mm. pint does the
conversions; it is imported only when a quantity is actually parsed.
"""

import math
import re
import tokenize
import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, short_repr, shortened

Floats = NDArray[np.float64]
# All patterns of numbers are made of these. No part of a text fits two parts of one, so that none
# tries a long text in many ways.
UNSIGNED = r"(?:\d+(?:\.\d*)?|\.\d+)"
NUMBER = rf"[-+]?{UNSIGNED}(?:[eE][-+]?\d+)?"
FORTRAN_NUMBER = rf"[-+]?{UNSIGNED}(?:[eEdD][-+]?\d+)?"
_NUMBER_AND_UNIT = re.compile(
    rf"^\s*(?P<number>{NUMBER}|[-+]?(?i:nan|inf(?:inity)?)\b)\s*(?P<unit>\S.*?)?\s*$"
)
# Names, products, quotients, brackets and powers of one digit. pint evaluates what it is given
# as arithmetic, so a tower such as mm**9**9**9 must not reach it.
_UNIT = re.compile(r"^(?:[^\W\d]|[°℃%²³⁻¹·*/() ]|\^?-?\d(?!\s*(?:\d|\^|\*\*)))+$")
_POWER = re.compile(r"(?<=[A-Za-z])(?=[234](?!\d))")  # m2 means m^2
LONGEST = 200  # characters of a number with its unit
# Without other limits: a size beyond this is an error in a unit or an exponent, and so is a
# number that must be positive and is less than its inverse.
HUGEST = 1e12
CUBIC_MM_PER_CUBIC_M = 1e9
NEWTON_PER_KILONEWTON = 1e3
# Spellings of units that differ from those of pint.
_SPELLINGS = {"°C": "degC", "C": "degC", "℃": "degC", "%": "percent"}


@cache
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)
    registry.define("tonf = metric_ton_force")
    return registry


@cache
def conversion(unit: str, target: str) -> tuple[float, float]:
    """Return scale and offset from `unit` to `target`; InputError if that makes no sense."""
    if unit == target:
        return 1.0, 0.0
    factor = _common_factors().get(target, {}).get(unit)
    # pint takes longer to be imported than a small run, and most files have no other units.
    return (factor, 0.0) if factor is not None else _pint_conversion(unit, target)


@cache
def _common_factors() -> dict[str, dict[str, float]]:
    """Return factors of common units, by wanted unit and given unit."""
    table = resources.files("thermobearing") / "data" / "units" / "usual.toml"
    content = tomllib.loads(table.read_text(encoding="utf-8"))
    factors: dict[str, dict[str, float]] = content["factors"]
    return factors


def _pint_conversion(unit: str, target: str) -> tuple[float, float]:
    """Return scale and offset as pint finds them."""
    import pint

    registry = _registry()
    spelled = _POWER.sub("^", _SPELLINGS.get(unit, unit))
    unknown = InputError(
        f'unknown unit "{shortened(unit)}"; expected {target} or a compatible unit'
    )
    if not _UNIT.match(spelled):
        raise unknown
    try:
        unit_quantity = registry.Quantity(1.0, spelled)
        # A conversion is linear: its scale and offset follow from two points. Only temperatures
        # have an offset.
        at_one = unit_quantity.to(target).magnitude
        at_zero = registry.Quantity(0.0, spelled).to(target).magnitude
        # pint counts radians as 1, which would make 1 rad/s into 1 Hz.
        angular = "radian" in str(unit_quantity.to_root_units().units)
    except pint.DimensionalityError:
        raise InputError(f'unit "{unit}" cannot be converted to {target}') from None
    except (pint.PintError, ArithmeticError, AssertionError, AttributeError, LookupError):
        raise unknown from None
    except (RecursionError, SyntaxError, TypeError, ValueError, tokenize.TokenError):
        raise unknown from None
    if angular and target == "Hz":
        raise InputError(
            f'unit "{unit}" is an angular frequency; give cycles per second, in {target}'
        )
    if target == "deg" and not angular:  # nor percent, which pint takes as parts of a radian
        raise InputError(f'unit "{unit}" cannot be converted to {target}')
    if at_zero != 0.0 and target != "degC":
        raise InputError(f'"{unit}" is a temperature; a difference is given in {target}')
    scale = 1.0 if spelled == target else at_one - at_zero
    return scale, at_zero


def split_quantity(text: str) -> tuple[str, str] | None:
    """Return the number of a text and its unit ("" without one); None for any other text.

    The minus sign of printed numbers counts as that of files, so that reports can be copied.

    >>> split_quantity("1.5e3 kN/mm"), split_quantity("nan"), split_quantity("two mm")
    (('1.5e3', 'kN/mm'), ('nan', ''), None)
    """
    text = text.replace("\N{MINUS SIGN}", "-")
    match = _NUMBER_AND_UNIT.match(text) if len(text) <= LONGEST else None
    return None if match is None else (match["number"], match["unit"] or "")


def parse_quantity(text: str, unit: str) -> float:
    """Return the number of a text such as "5 mm" or "-20 degC", converted to `unit`.

    >>> parse_quantity("3.2 cm", "mm")
    32.0
    """
    parts = split_quantity(text)
    if parts is None:
        raise InputError(f'"{shortened(text)}" is not a number with a unit, such as "1.5 {unit}"')
    number, number_unit = parts
    if not number_unit:
        raise InputError(
            f'"{text}" has no unit; write "{text.strip()} {unit}" if this is the intended unit'
        )
    if number_unit.startswith(","):
        raise InputError(f'"{shortened(text)}": use a decimal point, as in "1.5 {unit}"')
    scale, offset = conversion(number_unit, unit)
    value = float(number) * scale + offset
    if not math.isfinite(value):
        raise InputError(f'"{text}" is not a finite number')
    return value


def with_unit(value: float, unit: str) -> str:
    """Return the text that `parse_quantity` reads back to the same bits."""
    try:
        return f"{float(value) + 0.0!r} {unit}"  # no -0.0, which is read as 0.0
    except OverflowError:  # an integer beyond doubles
        return f"{'-' if value < 0 else ''}inf {unit}"


LARGEST = int(np.finfo(np.float64).max)


def is_number(value: Any) -> bool:
    """Return whether a value is a plain number within the range of a double; booleans are not."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    return isinstance(value, float | np.floating) or abs(int(value)) <= LARGEST


def one_or_several(value: Any) -> list[Any]:
    """Return the items of a list, or a list of a single value."""
    if isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping):
        return list(value)
    return [value]


def refuse_hidden(values: Any, label: str) -> None:
    """Reject masked values and complex numbers, which numpy would convert silently."""
    elements = values if isinstance(values, list | tuple) else ()
    if np.ma.is_masked(values) or any(value is np.ma.masked for value in elements):
        raise InputError(f"{label}: values are masked; fill them, or cut the record before them")
    if np.iscomplexobj(values) or any(isinstance(value, complex) for value in elements):
        raise InputError(
            f"{label}: the numbers are complex; give the real part if that is intended"
        )


def number_list(values: Any, label: str) -> Floats:
    """Return a list of finite numbers as an array; one number counts as a list of one."""
    refuse_hidden(values, label)
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        numbers = np.zeros((0, 0))
    if numbers.ndim != 1 or not len(numbers):
        raise InputError(f"{label}: must be a list of numbers, got {short_repr(values)}")
    if not np.isfinite(numbers).all():
        index = int(np.argmin(np.isfinite(numbers)))
        raise InputError(
            f"{label}: {numbers[index]:g} at place {index + 1} (index {index}) is not finite"
        )
    if float(np.abs(numbers).max()) > HUGEST:
        index = int(np.abs(numbers).argmax())
        raise InputError(
            f"{label}: {numbers[index]:g} at place {index + 1} (index {index}) is more than "
            f"{HUGEST:g}"
        )
    return numbers
