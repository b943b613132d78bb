"""Numbers that Python functions are given: of a kind that can be counted with, or refused."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, shortened
from thermobearing.border.units import HUGEST

LARGEST = int(np.finfo(np.float64).max)
Floats = NDArray[np.float64]


def is_number(value: Any) -> bool:
    """Whether a value is one plain number that a double can hold; true and false are none.

    Examples
    --------
    >>> [is_number(value) for value in (3, 2.5, True, "3", [3], 10**400)]
    [True, True, False, False, False, False]
    """
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    return isinstance(value, float | np.floating) or abs(int(value)) <= LARGEST


def one_or_several(given: Any) -> list[Any]:
    """The items of a list, or the one thing that was given alone.

    Examples
    --------
    >>> one_or_several(3), one_or_several((3, 4)), one_or_several("ab")
    ([3], [3, 4], ['ab'])
    """
    if isinstance(given, Iterable) and not isinstance(given, str | bytes | Mapping):
        return list(given)
    return [given]


def refuse_hidden(values: Any, what: str) -> None:
    """Refuse what numpy would silently take apart: masked values, and imaginary parts.

    Parameters
    ----------
    values : array or list.
    what : it is called, for the message.

    Raises
    ------
    InputError : values are masked, or complex.

    Examples
    --------
    >>> refuse_hidden(np.ma.array([1.0, 2.0]), "force")
    >>> refuse_hidden([1.0, 2.0 + 1.0j], "force")
    Traceback (most recent call last):
    thermobearing.border.errors.InputError: force: the numbers are complex; give their real part...
    """
    listed = values if isinstance(values, list | tuple) else ()
    if np.ma.is_masked(values) or any(value is np.ma.masked for value in listed):
        raise InputError(f"{what}: values are masked; fill them, or cut the record there")
    if np.iscomplexobj(values) or any(isinstance(value, complex) for value in listed):
        raise InputError(f"{what}: the numbers are complex; give their real part if it is meant")


def number_list(values: Any, what: str) -> Floats:
    """A list of finite numbers as an array; one number counts as a list of one.

    Parameters
    ----------
    values : what was given.
    what : it is called, for the message.

    Raises
    ------
    InputError : it is something else, empty, nested, or holds what is not finite or too large.

    Examples
    --------
    >>> number_list([1, 2.5], "periods").tolist()
    [1.0, 2.5]
    """
    refuse_hidden(values, what)
    try:
        found = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        found = np.zeros((0, 0))
    if found.ndim != 1 or not len(found):
        raise InputError(f"{what}: must be a list of numbers, got {shortened(repr(values))}")
    if not np.isfinite(found).all():
        at = int(np.argmin(np.isfinite(found)))
        raise InputError(f"{what}: {found[at]:g} at place {at + 1} (index {at}) is not finite")
    if float(np.abs(found).max()) > HUGEST:
        at = int(np.abs(found).argmax())
        raise InputError(
            f"{what}: {found[at]:g} at place {at + 1} (index {at}) is more than {HUGEST:g}"
        )
    return found
