"""What numba makes of the functions of `choose.py`, and of calls of a user's law."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, type_callable

from thermobearing.core.hysteresis import COMPONENTS, call_in_plane, call_on_line
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.lanes.kinds import DOUBLE, PLACE, LaneType, MaskType, first_type


@type_callable(select)
def _type_select(context: Any) -> Any:
    def typed(condition: Any, a: Any, b: Any) -> Any:
        lane_type = first_type(LaneType, (a, b)) or first_type(MaskType, (a, b))
        if lane_type is None and isinstance(condition, MaskType):
            are_booleans = isinstance(a, types.Boolean) and isinstance(b, types.Boolean)
            lane_type = (MaskType if are_booleans else LaneType)(condition.width)
        kind = lane_type or context.unify_types(types.unliteral(a), types.unliteral(b))
        condition_type = condition if isinstance(condition, MaskType) else types.boolean
        return signature(kind, condition_type, kind, kind)

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


def _define_mask_query(function: Any, result: Any, of_mask: Any, of_bool: Any) -> None:
    """A question to a mask, or to one bool."""

    def typed(_: Any) -> Any:
        return lambda condition: signature(result(condition), condition)

    type_callable(function)(typed)
    lower_builtin(function, MaskType)(of_mask)
    lower_builtin(function, types.Boolean)(of_bool)


_define_mask_query(any_lane, lambda _: types.boolean, _any, _same)
_define_mask_query(all_lanes, lambda _: types.boolean, _all, _same)
_define_mask_query(no, types.unliteral, _not, _not)


def _typed_call(components: int, arguments: Any) -> Any:
    number_type = first_type(LaneType, arguments) or types.float64
    result_type = types.UniTuple(number_type, COMPONENTS[components])
    return signature(result_type, types.int64, *[number_type] * (len(arguments) - 1))


@type_callable(call_on_line)
def _type_on_line(_: Any) -> Any:
    return lambda address, z, d, a, b, c, e: _typed_call(1, (address, z, d, a, b, c, e))


@type_callable(call_in_plane)
def _type_in_plane(_: Any) -> Any:
    def typed(
        address: Any, zx: Any, zy: Any, dx: Any, dy: Any, a: Any, b: Any, c: Any, e: Any
    ) -> Any:
        return _typed_call(2, (address, zx, zy, dx, dy, a, b, c, e))

    return typed


@lower_builtin(call_on_line, types.int64, *[types.Any] * 6)
@lower_builtin(call_in_plane, types.int64, *[types.Any] * 8)
def _lower_call(context: Any, builder: Any, sig: Any, values: Any) -> Any:
    """Call the function at the address, in lockstep for each lane."""
    address, *numbers = values
    kind, count = sig.return_type.dtype, sig.return_type.count
    room = cgutils.alloca_once(builder, DOUBLE, count)
    function_type = ir.FunctionType(ir.VoidType(), [DOUBLE] * len(numbers) + [DOUBLE.as_pointer()])
    function = builder.inttoptr(address, function_type.as_pointer())

    def called(*arguments: Any) -> list[Any]:
        builder.call(function, [*arguments, room])
        return [builder.load(cgutils.gep(builder, room, k)) for k in range(count)]

    if not isinstance(kind, LaneType):
        return context.make_tuple(builder, sig.return_type, called(*numbers))
    results = [ir.Constant(context.get_value_type(kind), ir.Undefined)] * count
    for lane in range(kind.width):
        place = ir.Constant(PLACE, lane)
        lane_results = called(*(builder.extract_element(number, place) for number in numbers))
        results = [
            builder.insert_element(joined, number, place)
            for joined, number in zip(results, lane_results, strict=True)
        ]
    return context.make_tuple(builder, sig.return_type, results)
