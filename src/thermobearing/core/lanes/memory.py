"""From arrays of several runs to lanes, and the arrays themselves.

`side_by_side` puts the records of several runs into one: every float becomes an array with the
runs along its last axis, integers and choices must be alike. In a kernel `as_lanes` gives the
same memory the types that the kernels want: the last axis becomes a lane.
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, TypeVar

import numpy as np

from thermobearing.core.types import SharedCells

T = TypeVar("T")

WIDTH = 16  # runs in lockstep
ALIGNED = 64  # bytes: the widest vectors are loaded at once from such places


def aligned(shape: tuple[int, ...], dtype: Any) -> Any:
    """An array of zeros that starts where vectors load fast."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    memory = np.zeros(size + ALIGNED, dtype=np.uint8)
    first = -memory.ctypes.data % ALIGNED
    return memory[first : first + size].view(dtype).reshape(shape)


@cache
def _lane_row(row: np.dtype[Any]) -> np.dtype[Any]:
    """The numpy type of a record with lanes in place of floats."""
    fields = []
    for name in row.names or ():
        base, shape = row[name].base, row[name].shape
        fields.append((name, base, (*shape, WIDTH) if base == np.float64 else shape))
    return np.dtype(fields)


@cache
def _has_numbers(row: np.dtype[Any]) -> bool:
    """Whether a record has integers too."""
    return any(row[name].base != np.float64 for name in row.names or ())


def _row_shape(row: np.dtype[Any]) -> tuple[int, ...]:
    """Of the floats of one entry: one for each number of a record."""
    return (row.itemsize // 8,) if row.names else ()


def plain(own: Any) -> Any:
    """The floats of an array, those of a record along its last axis; not a copy."""
    if not own.dtype.names:
        return own
    return own.reshape(-1).view(np.float64).reshape(*own.shape, *_row_shape(own.dtype))


def _remade(given: T, parts: Sequence[Any]) -> T:
    """A tuple of that kind with other parts."""
    kind: Any = type(given)
    made: T = kind(*parts) if hasattr(given, "_fields") else kind(parts)
    return made


def side_by_side(parts: Sequence[T]) -> T:
    """Records, numbers or arrays of WIDTH runs as one.

    Raises
    ------
    ValueError : they differ in shape, in an integer or in a choice.
    """
    first: Any = parts[0]
    every: Sequence[Any] = parts
    made: Any
    if isinstance(first, SharedCells):
        if not all(alike(one, first) for one in every):
            raise ValueError("runs of unequal heat")
        made = first
    elif isinstance(first, tuple):
        made = _remade(first, _columns_side_by_side(list(zip(*every, strict=True))))
    elif isinstance(first, float):
        made = aligned((WIDTH,), np.float64)
        made[:] = every
    elif not isinstance(first, np.ndarray):
        if any(one != first for one in every):
            raise ValueError("runs of unequal shape")
        made = first
    elif _has_numbers(first.dtype):
        made = aligned(first.shape, _lane_row(first.dtype))
        for name in first.dtype.names:
            made[name] = side_by_side([np.asarray(one[name]) for one in every])
    elif first.dtype.names or first.dtype == np.float64:
        made = aligned((*first.shape, *_row_shape(first.dtype), WIDTH), np.float64)
        spread(every, made)
        if first.dtype.names:
            made = made.reshape(-1).view(_lane_row(first.dtype)).reshape(first.shape)
    else:
        if not all(alike(one, first) for one in every):
            raise ValueError("runs of unequal shape")
        made = first
    found: T = made
    return found


def _columns_side_by_side(columns: Sequence[Any]) -> list[Any]:
    """Each of some columns of WIDTH; numbers stand in one array."""
    numbers = [k for k, column in enumerate(columns) if isinstance(column[0], float)]
    block = aligned((len(numbers), WIDTH), np.float64)
    if numbers:
        block[:] = [columns[k] for k in numbers]
    found = dict(zip(numbers, block, strict=True))
    return [found[k] if k in found else side_by_side(one) for k, one in enumerate(columns)]


def spread(every: Sequence[Any], made: Any) -> None:
    """Write the floats of arrays of one shape into lanes; one array for all is spread at once."""
    first = every[0]
    if all(one is first for one in every):
        made[...] = plain(first)[..., None]
        return
    together = np.empty((WIDTH, *first.shape), first.dtype)  # np.stack changes records
    for lane, one in enumerate(every):
        if one.shape != first.shape:
            raise ValueError("runs of unequal shape")
        together[lane] = one
    made[...] = np.moveaxis(plain(together), 0, -1)


def alike(one: Any, other: Any) -> bool:
    """Whether arrays, or tuples of them, are the same to the bit."""
    if isinstance(one, tuple):
        return all(map(alike, one, other))
    same: bool = one is other or (one.shape == other.shape and one.tobytes() == other.tobytes())
    return same


def twin(made: T) -> T:
    """Arrays of the same numbers as some of `side_by_side`."""
    array: Any = made
    if isinstance(made, tuple):
        return _remade(made, [twin(one) for one in array])
    other = aligned(array.shape, array.dtype)
    other[...] = array
    found: T = other
    return found


def each_lane(made: Any, like: T) -> list[T]:
    """Return separate arrays with what every run has in `made`, of the given kinds."""
    given: Any = like
    if isinstance(like, tuple):
        parts = [each_lane(one, own) for one, own in zip(made, given, strict=True)]
        return [_remade(like, one) for one in zip(*parts, strict=True)]
    if not given.size:
        return [like] * WIDTH
    shape = (*given.shape, *_row_shape(given.dtype), WIDTH)
    turned = np.ascontiguousarray(
        np.moveaxis(made.reshape(-1).view(np.float64).reshape(shape), -1, 0)
    )
    own: Any = turned.reshape(-1).view(given.dtype).reshape(WIDTH, *given.shape)
    return list(own)


def as_lanes(made: T, width: int) -> T:
    """What `side_by_side` made, with lanes of `width` runs in place of its last axes.

    Only compiled kernels can do that (views.py).
    """
    raise NotImplementedError(f"{width} lanes of {type(made).__name__} outside a kernel")
