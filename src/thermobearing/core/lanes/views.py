"""What numba makes of `as_lanes`: the same memory with lanes in place of the last axes."""

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
from thermobearing.core.types import SharedCells


class LaneRecord(types.Record):
    """A record with lanes in place of floats."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Only its size counts."""
        return np.dtype((np.void, self.size))


@register_model(LaneRecord)
class LaneRecordModel(models.RecordModel):
    """Bytes, as of any record."""


def _lane_record(record: Any, width: int) -> LaneRecord:
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
        if getattr(kind, "instance_class", None) is SharedCells:
            return kind
        columns: Any = kind
        inner = [lane_kind(one, width) for one in columns.types]
        return types.BaseTuple.from_types(inner, getattr(kind, "instance_class", None))
    if hasattr(kind, "in_lanes"):  # what stands in a table
        return kind.in_lanes(width)
    if not isinstance(kind, types.Array):
        return kind
    if isinstance(kind.dtype, types.Record):
        return types.Array(_lane_record(kind.dtype, width), kind.ndim, kind.layout, aligned=False)
    if kind.dtype != types.float64:
        return kind
    if kind.ndim == 1:
        return LaneType(width)
    return types.Array(LaneType(width), kind.ndim - 1, "C", aligned=False)


def converted(context: Any, builder: Any, old: Any, value: Any, width: int) -> Any:
    """The value with the type of `lane_kind`; arrays keep their memory, one lane is loaded."""
    new = lane_kind(old, width)
    if new == old:
        return value
    if isinstance(old, types.BaseTuple):
        columns: Any = old
        parts = [
            converted(context, builder, one, builder.extract_value(value, k), width)
            for k, one in enumerate(columns.types)
        ]
        return context.make_tuple(builder, new, parts)
    if not isinstance(old, types.Array):
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
    wide = width.literal_value

    def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return converted(context, builder, signature.args[0], values[0], wide)

    return lane_kind(made, wide)(made, width), code


# numba finds an intrinsic by the function that kernels call, which needs no numba.
_view: Any = intrinsic(prefer_literal=True)(_as_lanes)
infer_global(
    as_lanes,
    types.Function(make_intrinsic_template(_view, _as_lanes, "as_lanes", prefer_literal=True)),
)
