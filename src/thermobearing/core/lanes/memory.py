"""From arrays of several runs to lanes, and the arrays themselves.

`side_by_side` puts the records of several runs into one: every float becomes an array with the
runs along its last axis, whole numbers and choices must be alike. In a kernel `as_lanes` gives the
same memory the types that the kernels want: the last axis becomes a lane.
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, TypeVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, register_model
from numba.np import arrayobj

from thermobearing.core.lanes.kinds import BYTES, DOUBLE, LaneType

T = TypeVar("T")

WIDTH = 8  # runs in lockstep
ALIGNED = 64  # bytes: the widest vectors are loaded at once from such places


def aligned(shape: tuple[int, ...], dtype: Any) -> Any:
    """An array of zeros that starts where vectors load fast."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    memory = np.zeros(size + ALIGNED, dtype=np.uint8)
    first = -memory.ctypes.data % ALIGNED
    return memory[first : first + size].view(dtype).reshape(shape)


@cache
def lane_row(row: np.dtype[Any]) -> np.dtype[Any]:
    """The numpy type of a record with lanes in place of floats."""
    fields = []
    for name in row.names or ():
        wide = row[name] == np.float64
        fields.append((name, row[name], (WIDTH,)) if wide else (name, row[name]))
    return np.dtype(fields)


@cache
def has_numbers(row: np.dtype[Any]) -> bool:
    """Whether a record has whole numbers too."""
    return any(row[name] != np.float64 for name in row.names or ())


def row_shape(row: np.dtype[Any]) -> tuple[int, ...]:
    """Of the floats of one entry: one for each field of a record."""
    return (len(row.names),) if row.names else ()


def plain(own: Any) -> Any:
    """The floats of an array, those of a record along its last axis; not a copy."""
    if not own.dtype.names:
        return own
    return own.reshape(-1).view(np.float64).reshape(*own.shape, len(own.dtype.names))


def side_by_side(parts: Sequence[T]) -> T:
    """Records, numbers or arrays of WIDTH runs as one.

    Raises
    ------
    ValueError : they differ in shape, in a whole number or in a choice.
    """
    first: Any = parts[0]
    every: Sequence[Any] = parts
    made: Any
    if isinstance(first, tuple):
        columns = [side_by_side(column) for column in zip(*every, strict=True)]
        made = type(first)(*columns) if hasattr(first, "_fields") else tuple(columns)
    elif isinstance(first, float):
        made = aligned((WIDTH,), np.float64)
        made[:] = every
    elif not isinstance(first, np.ndarray):
        if any(one != first for one in every):
            raise ValueError("runs of unequal shape")
        made = first
    elif has_numbers(first.dtype):
        made = aligned(first.shape, lane_row(first.dtype))
        for name in first.dtype.names:
            made[name] = side_by_side([np.asarray(one[name]) for one in every])
    elif first.dtype.names or first.dtype == np.float64:
        made = aligned((*first.shape, *row_shape(first.dtype), WIDTH), np.float64)
        for lane, one in enumerate(every):
            if one.shape != first.shape:
                raise ValueError("runs of unequal shape")
            made[..., lane] = plain(one)
        if first.dtype.names:
            made = made.reshape(-1).view(lane_row(first.dtype)).reshape(first.shape)
    else:
        if not all(np.array_equal(one, first) for one in every):
            raise ValueError("runs of unequal shape")
        made = first
    return made  # type: ignore[no-any-return]


def lane_back(made: Any, lane: int, own: Any) -> None:
    """Copy what one run has in `made` into its own arrays, which are contiguous."""
    if isinstance(own, tuple):
        for there, here in zip(made, own, strict=True):
            lane_back(there, lane, here)
    elif own.size and own.dtype.names:
        floats = made.reshape(-1).view(np.float64)
        plain(own)[...] = floats.reshape(*own.shape, len(own.dtype.names), WIDTH)[..., lane]
    elif own.size:
        own[...] = made[..., lane]


class LaneRecord(types.Record):
    """A record with lanes in place of floats."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Only its size counts."""
        return np.dtype((np.void, self.size))


@register_model(LaneRecord)
class LaneRecordModel(models.RecordModel):
    """Bytes, as of any record."""


def lane_record(record: Any, width: int) -> LaneRecord:
    """The numba type of a record whose floats are arrays of `width`."""
    fields: Any = []
    for name, field in record.fields.items():
        kind = field.type
        if isinstance(kind, types.NestedArray):
            kind = LaneType(width)
        fields.append((name, {"type": kind, "offset": field.offset}))
    return LaneRecord(fields, record.size, False)


def lane_kind(kind: Any, width: int) -> Any:
    """The type that `as_lanes` gives to what `side_by_side` made."""
    if isinstance(kind, types.BaseTuple):
        columns: Any = kind
        inner = [lane_kind(one, width) for one in columns.types]
        return types.BaseTuple.from_types(inner, getattr(kind, "instance_class", None))
    if not isinstance(kind, types.Array):
        return kind
    if isinstance(kind.dtype, types.Record):
        return types.Array(lane_record(kind.dtype, width), kind.ndim, kind.layout, aligned=False)
    if kind.dtype != types.float64:
        return kind
    if kind.ndim == 1:
        return LaneType(width)
    return types.Array(LaneType(width), kind.ndim - 1, "C", aligned=False)


def _converted(context: Any, builder: Any, old: Any, value: Any, width: int) -> Any:
    """The value with the type of `lane_kind`; arrays keep their memory, one lane is loaded."""
    new = lane_kind(old, width)
    if isinstance(old, types.BaseTuple):
        columns: Any = old
        parts = [
            _converted(context, builder, one, builder.extract_value(value, k), width)
            for k, one in enumerate(columns.types)
        ]
        return context.make_tuple(builder, new, parts)
    if new == old:
        return value
    array = context.make_array(old)(context, builder, value)
    if isinstance(new, LaneType):
        vector = ir.VectorType(DOUBLE, width).as_pointer()
        return builder.load(builder.bitcast(array.data, vector), align=BYTES)
    made = context.make_array(new)(context, builder)
    itemsize = array.itemsize
    if isinstance(new.dtype, LaneType):
        itemsize = context.get_constant(types.intp, BYTES * width)
    arrayobj.populate_array(
        made,
        data=builder.bitcast(array.data, context.get_data_type(new.dtype).as_pointer()),
        shape=cgutils.unpack_tuple(builder, array.shape, old.ndim)[: new.ndim],
        strides=cgutils.unpack_tuple(builder, array.strides, old.ndim)[: new.ndim],
        itemsize=itemsize,
        meminfo=None,
    )
    return made._getvalue()


def _as_lanes(_: Any, made: Any, width: Any) -> Any:
    """What `side_by_side` made, with lanes of `width` runs in place of its last axes."""
    wide = width.literal_value

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _converted(context, builder, signature.args[0], values[0], wide)

    return lane_kind(made, wide)(made, width), code


as_lanes: Any = intrinsic(prefer_literal=True)(_as_lanes)
