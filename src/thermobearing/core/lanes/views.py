"""What numba makes of `as_lanes` and `as_plane`: the same memory with other last axes.

Lanes take the place of the axis of the runs, and pairs that of the axes of vectors and matrices.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import infer_global, make_intrinsic_template
from numba.extending import intrinsic, models, register_model
from numba.np import arrayobj

from thermobearing.core.lanes.kinds import BYTES, DOUBLE, LaneType
from thermobearing.core.lanes.memory import as_lanes
from thermobearing.core.records import vector_fields
from thermobearing.core.types import SharedCells
from thermobearing.core.vector import as_plane


class ViewedRecord(types.Record):
    """A record with lanes in place of floats, or pairs in place of vectors."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Only its size counts."""
        return np.dtype((np.void, self.size))


@register_model(ViewedRecord)
class ViewedRecordModel(models.RecordModel):
    """Bytes, as of any record."""


def _viewed_record(record: Any, viewed: Callable[[Any], Any], *, aligned: bool) -> ViewedRecord:
    """The numba type of a record whose fields that are arrays are viewed."""
    fields: Any = []
    for name, field in record.fields.items():
        kind = field.type
        if isinstance(kind, types.NestedArray):
            kind = viewed(kind)
        fields.append((name, {"type": kind, "offset": field.offset}))
    return ViewedRecord(fields, record.size, aligned)


def lane_kind(kind: Any, width: int) -> Any:
    """The type that `as_lanes` gives to what `side_by_side` made."""
    if isinstance(kind, types.BaseTuple):
        if getattr(kind, "instance_class", None) is SharedCells:
            return kind
        columns: Any = kind
        inner = [lane_kind(field, width) for field in columns.types]
        return types.BaseTuple.from_types(inner, getattr(kind, "instance_class", None))
    if hasattr(kind, "viewed"):  # a record in a table
        return kind.viewed(lambda field: lane_kind(field, width))
    if not isinstance(kind, types.Array):
        return kind
    if isinstance(kind.dtype, types.Record):
        record = _viewed_record(
            kind.dtype, lambda field: _nested(field.shape[:-1], LaneType(width)), aligned=False
        )
        return types.Array(record, kind.ndim, kind.layout, aligned=False)
    if kind.dtype != types.float64:
        return kind
    if kind.ndim == 1:
        return LaneType(width)
    return types.Array(LaneType(width), kind.ndim - 1, "C", aligned=False)


def _nested(shape: tuple[int, ...], kind: Any = types.float64) -> Any:
    """The type of a vector or a matrix."""
    for count in reversed(shape):
        kind = types.UniTuple(kind, count)
    return kind


def plane_kind(kind: Any, shape: tuple[int, ...] = ()) -> Any:
    """The type that `as_plane` gives to a record, or to an array whose last axes are `shape`."""
    if isinstance(kind, types.BaseTuple):
        columns: Any = kind
        record_class = getattr(kind, "instance_class", None)
        vector_shapes = vector_fields(record_class) if record_class else {}
        names = getattr(kind, "fields", range(len(columns.types)))
        inner = [
            plane_kind(field, vector_shapes.get(name, ()))
            for name, field in zip(names, columns.types, strict=True)
        ]
        return types.BaseTuple.from_types(inner, record_class)
    if hasattr(kind, "viewed"):
        return kind.viewed(plane_kind)
    if not isinstance(kind, types.Array):
        return kind
    if isinstance(kind.dtype, types.Record):
        if not any(
            isinstance(field.type, types.NestedArray) for field in kind.dtype.fields.values()
        ):
            return kind
        record = _viewed_record(kind.dtype, lambda field: _nested(field.shape), aligned=True)
        return types.Array(record, kind.ndim, kind.layout)
    if not shape:
        return kind
    vectors = _nested(shape, kind.dtype)
    return types.Array(vectors, kind.ndim - len(shape), "C", aligned=kind.aligned)


def converted(context: Any, builder: Any, old: Any, value: Any, new: Any) -> Any:
    """The value with a type of `lane_kind` or `plane_kind`.

    Arrays keep their memory, one lane is loaded.
    """
    if new == old:
        return value
    if isinstance(old, types.BaseTuple):
        columns: Any = old
        parts = [
            converted(context, builder, field, builder.extract_value(value, k), new.types[k])
            for k, field in enumerate(columns.types)
        ]
        return context.make_tuple(builder, new, parts)
    if not isinstance(old, types.Array):
        return value
    array = context.make_array(old)(context, builder, value)
    if isinstance(new, LaneType):
        vector = ir.VectorType(DOUBLE, new.width).as_pointer()
        return builder.load(builder.bitcast(array.data, vector), align=BYTES)
    viewed = context.make_array(new)(context, builder)
    itemsize = array.itemsize
    if not isinstance(new.dtype, types.Record):
        size = context.get_abi_sizeof(context.get_data_type(new.dtype))
        itemsize = context.get_constant(types.intp, size)
    arrayobj.populate_array(
        viewed,
        data=builder.bitcast(array.data, context.get_data_type(new.dtype).as_pointer()),
        shape=cgutils.unpack_tuple(builder, array.shape, old.ndim)[: new.ndim],
        strides=cgutils.unpack_tuple(builder, array.strides, old.ndim)[: new.ndim],
        itemsize=itemsize,
        meminfo=None,
    )
    return viewed._getvalue()


def _as_lanes(_: Any, joined: Any, width: Any) -> Any:
    lane_count = width.literal_value

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = signature.args[0]
        return converted(context, builder, kind, values[0], lane_kind(kind, lane_count))

    return lane_kind(joined, lane_count)(joined, width), code


def _as_plane(_: Any, record: Any) -> Any:
    viewed = plane_kind(record)

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return converted(context, builder, signature.args[0], values[0], viewed)

    return viewed(record), code


# numba finds an intrinsic by the function that kernels call, which needs no numba.
for name, function, typed in (("as_lanes", as_lanes, _as_lanes), ("as_plane", as_plane, _as_plane)):
    handle: Any = intrinsic(prefer_literal=True)(typed)
    template = make_intrinsic_template(handle, typed, name, prefer_literal=True)
    infer_global(function, types.Function(template))
