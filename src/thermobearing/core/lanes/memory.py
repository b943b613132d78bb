"""From arrays of several runs to lanes, and the arrays themselves.

`side_by_side` puts the records of several runs into one: every float becomes an array with the
runs along its last axis, integers and choices must be alike. In a kernel `as_lanes` gives the
same memory the types that the kernels want: the last axis becomes a lane.
"""

import ctypes
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
    # numpy need not align as much; a little more memory has such a place. `memory.ctypes.data` is
    # the same address, but takes four times as long.
    start: Any = memory
    first = -ctypes.addressof(ctypes.c_byte.from_buffer(start)) % ALIGNED
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


def plain(array: Any) -> Any:
    """The floats of an array, those of a record along its last axis; not a copy."""
    if not array.dtype.names:
        return array
    return array.reshape(-1).view(np.float64).reshape(*array.shape, *_row_shape(array.dtype))


def _rebuilt(template: T, parts: Sequence[Any]) -> T:
    """A tuple of that kind with other parts."""
    kind: Any = type(template)
    rebuilt: T = kind(*parts) if hasattr(template, "_fields") else kind(parts)
    return rebuilt


def side_by_side(parts: Sequence[T]) -> T:
    """Records, numbers or arrays of WIDTH runs as one.

    Raises
    ------
    ValueError : they differ in shape, in an integer or in a choice.
    """
    first: Any = parts[0]
    runs: Sequence[Any] = parts
    joined: Any
    # Records recur down to floats and arrays; what kernels branch on must be alike in all runs.
    if isinstance(first, SharedCells):
        if not all(alike(run, first) for run in runs):
            raise ValueError("runs of unequal heat")
        joined = first
    elif isinstance(first, tuple):
        joined = _rebuilt(first, _columns_side_by_side(list(zip(*runs, strict=True))))
    elif isinstance(first, float):
        joined = aligned((WIDTH,), np.float64)
        joined[:] = runs
    elif not isinstance(first, np.ndarray):
        if any(run != first for run in runs):
            raise ValueError("runs of unequal shape")
        joined = first
    elif _has_numbers(first.dtype):
        joined = aligned(first.shape, _lane_row(first.dtype))
        for name in first.dtype.names:
            joined[name] = side_by_side([np.asarray(run[name]) for run in runs])
    elif first.dtype.names or first.dtype == np.float64:
        joined = aligned((*first.shape, *_row_shape(first.dtype), WIDTH), np.float64)
        spread(runs, joined)
        if first.dtype.names:
            joined = joined.reshape(-1).view(_lane_row(first.dtype)).reshape(first.shape)
    else:
        if not all(alike(run, first) for run in runs):
            raise ValueError("runs of unequal shape")
        joined = first
    result: T = joined
    return result


def _columns_side_by_side(columns: Sequence[Any]) -> list[Any]:
    """Each of some columns of WIDTH; numbers stand in one array."""
    numbers = [k for k, column in enumerate(columns) if isinstance(column[0], float)]
    block = aligned((len(numbers), WIDTH), np.float64)
    if numbers:
        block[:] = [columns[k] for k in numbers]
    lanes = dict(zip(numbers, block, strict=True))
    return [lanes[k] if k in lanes else side_by_side(values) for k, values in enumerate(columns)]


def refill(joined: Any, parts: Sequence[Any]) -> None:
    """Write other runs into what `side_by_side` made of runs of the same shapes.

    Only floats: arrays, and tuples of them.
    """
    if isinstance(joined, tuple):
        for column, runs in zip(joined, zip(*parts, strict=True), strict=True):
            refill(column, runs)
    elif joined.size:
        spread(parts, _lane_view(joined, parts[0]))


def _lane_view(joined: Any, like: Any) -> Any:
    """Return a view of the floats of lanes, with the numbers of a record along a separate axis."""
    shape = (*like.shape, *_row_shape(like.dtype), WIDTH)
    return joined.reshape(-1).view(np.float64).reshape(shape)


def restore(copy: Any, joined: Any) -> None:
    """Write the numbers of some arrays into those that `twin` made of them."""
    if isinstance(joined, tuple):
        for written, original in zip(copy, joined, strict=True):
            restore(written, original)
    else:
        copy[...] = joined


def spread(arrays: Sequence[Any], lanes: Any) -> None:
    """Write the floats of arrays of one shape into lanes; one array for all is spread at once."""
    first = arrays[0]
    if all(array is first for array in arrays):
        lanes[...] = plain(first)[..., None]
        return
    together = np.empty((WIDTH, *first.shape), first.dtype)  # np.stack changes records
    for lane, array in enumerate(arrays):
        if array.shape != first.shape:
            raise ValueError("runs of unequal shape")
        together[lane] = array
    lanes[...] = np.moveaxis(plain(together), 0, -1)


def alike(first: Any, second: Any) -> bool:
    """Whether arrays, or tuples of them, are the same to the bit."""
    if isinstance(first, tuple):
        return all(map(alike, first, second))
    same: bool = first is second or (
        first.shape == second.shape and first.tobytes() == second.tobytes()
    )
    return same


def twin(joined: T) -> T:
    """Arrays of the same numbers as some of `side_by_side`."""
    array: Any = joined
    if isinstance(joined, tuple):
        return _rebuilt(joined, [twin(part) for part in array])
    copy = aligned(array.shape, array.dtype)
    copy[...] = array
    result: T = copy
    return result


def each_lane(joined: Any, like: T) -> list[T]:
    """Return separate arrays with what every run has in `joined`, of the given kinds."""
    template: Any = like
    if isinstance(like, tuple):
        columns = [each_lane(*pair) for pair in zip(joined, template, strict=True)]
        return [_rebuilt(like, parts) for parts in zip(*columns, strict=True)]
    if not template.size:
        return [like] * WIDTH
    # A copy in any case: the next runs in lockstep are written into the same lanes.
    lane_first = np.array(np.moveaxis(_lane_view(joined, template), -1, 0), order="C")
    separate: Any = lane_first.reshape(-1).view(template.dtype).reshape(WIDTH, *template.shape)
    return list(separate)


def as_lanes(joined: T, width: int) -> T:
    """What `side_by_side` made, with lanes of `width` runs in place of its last axes.

    Only compiled kernels can do that (views.py).
    """
    raise NotImplementedError(f"{width} lanes of {type(joined).__name__} outside a kernel")
