"""Which of several values governs, decided alike on every processor.

Symmetric parts of a structure, or equal runs, have values that differ by rounding only, and
rounding depends on the processor and its libraries. Values within `TIE` of the largest are
therefore equal to it, and the first of them in the order of the input governs.
"""

import re
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

SLACK_KELVIN = 2.0  # beyond tested temperatures: chambers are held within 1 to 2 K
TIE = 1e-9  # of the largest magnitude among the values that are compared

Places = NDArray[np.intp]
T = TypeVar("T")


def places_of_largest(values: ArrayLike) -> Places:
    """Return the place of the largest value along the last axis, the first of equal ones.

    NaN never governs; where no value is a number, the place is 0.

    >>> places_of_largest([[2.0, 3.0, 3.0 + 1e-12], [np.nan, -1.0, -2.0]])
    array([1, 1])
    """
    numbers: Any = np.asarray(values, dtype=float)
    comparable = np.where(np.isnan(numbers), -np.inf, numbers)
    least = comparable.max(axis=-1, keepdims=True) - TIE * _scale(numbers)
    return np.asarray((comparable >= least).argmax(axis=-1))


def place_of_largest(values: ArrayLike) -> int:
    """Return the place of the largest of some values, the first of equal ones.

    >>> place_of_largest([2.0, 3.0, 3.0 + 1e-12])
    1
    """
    return int(places_of_largest(np.ravel(np.asarray(values, dtype=float))))


def place_of_least(values: ArrayLike) -> int:
    """Return the place of the least of some values, the first of equal ones."""
    return place_of_largest(-np.asarray(values, dtype=float))


def largest_by(items: Sequence[T], size: Callable[[T], float]) -> T:
    """Return the item of the largest size, the first of equal ones."""
    return items[place_of_largest([size(item) for item in items])]


def least_by(items: Sequence[T], size: Callable[[T], float]) -> T:
    """Return the item of the least size, the first of equal ones."""
    return items[place_of_least([size(item) for item in items])]


def order_from_largest(values: ArrayLike) -> Places:
    """Return the order of values from the largest to the least; equal ones as in the input.

    NaN comes last.

    >>> order_from_largest([1.0, np.nan, 3.0, 3.0 + 1e-12]).tolist()
    [2, 3, 0, 1]
    """
    numbers: Any = np.ravel(np.asarray(values, dtype=float))
    comparable = np.where(np.isnan(numbers), -np.inf, numbers)
    order = np.argsort(-comparable, kind="stable")
    ranked = comparable[order]
    lower = ranked[1:] < ranked[:-1] - TIE * _scale(numbers)
    ranks = np.concatenate([[0], np.cumsum(lower)])[: len(order)]
    # NaN below -inf: both are numbers of the sort, only one is a value.
    return np.asarray(order[np.lexsort((order, ranks, np.isnan(numbers)[order]))])


def order_from_least(values: ArrayLike) -> Places:
    """Return the order of values from the least to the largest; equal ones as in the input."""
    return order_from_largest(-np.asarray(values, dtype=float))


def _scale(numbers: Any) -> Any:
    """Return the largest finite magnitude along the last axis, which is kept."""
    sizes = np.where(np.isfinite(numbers), np.abs(numbers), 0.0)
    return sizes.max(axis=-1, keepdims=True, initial=0.0)


def place_words(count: int, runs: int, where: str, most: str = "largest") -> str:
    """Return in how many of the runs something occurs, and where most of it.

    >>> place_words(5, 9, "Tohoku, 23 degC")
    'in 5 of 9 runs; largest in Tohoku at 23 degC'
    >>> place_words(1, 1, "the run at 40 degC")
    'in the run at 40 degC'
    """
    place = where if " at " in where else re.sub(r", (?=-?[\d.]+ degC$)", " at ", where)
    if runs == 1:
        return f"in {place}"
    return f"in {count} of {runs} runs; {most} in {place}"
