"""What numba makes of the functions of `choose.py`."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, type_callable

from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.lanes.kinds import LaneType, MaskType, first_type


@type_callable(select)
def _type_select(context: Any) -> Any:
    def typed(condition: Any, a: Any, b: Any) -> Any:
        wide = first_type(LaneType, (a, b)) or first_type(MaskType, (a, b))
        if wide is None and isinstance(condition, MaskType):
            both = isinstance(a, types.Boolean) and isinstance(b, types.Boolean)
            wide = (MaskType if both else LaneType)(condition.width)
        kind = wide or context.unify_types(types.unliteral(a), types.unliteral(b))
        asked = condition if isinstance(condition, MaskType) else types.boolean
        return signature(kind, asked, kind, kind)

    return typed


@lower_builtin(select, types.Any, types.Any, types.Any)
def _lower_select(_: Any, builder: Any, __: Any, values: Any) -> Any:
    return builder.select(*values)


def _same(_: Any, __: Any, ___: Any, values: Any) -> Any:
    return values[0]


def _bits(builder: Any, values: Any) -> Any:
    return builder.bitcast(values[0], ir.IntType(values[0].type.count))


def _any(_: Any, builder: Any, __: Any, values: Any) -> Any:
    bits = _bits(builder, values)
    return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))


def _all(_: Any, builder: Any, __: Any, values: Any) -> Any:
    bits = _bits(builder, values)
    return builder.icmp_unsigned("==", bits, ir.Constant(bits.type, -1))


def _not(_: Any, builder: Any, __: Any, values: Any) -> Any:
    return builder.not_(values[0])


def _asked(function: Any, result: Any, of_mask: Any, of_bool: Any) -> None:
    """A question to a mask, or to one bool."""

    def typed(_: Any) -> Any:
        return lambda condition: signature(result(condition), condition)

    type_callable(function)(typed)
    lower_builtin(function, MaskType)(of_mask)
    lower_builtin(function, types.Boolean)(of_bool)


_asked(any_lane, lambda _: types.boolean, _any, _same)
_asked(all_lanes, lambda _: types.boolean, _all, _same)
_asked(no, types.unliteral, _not, _not)
