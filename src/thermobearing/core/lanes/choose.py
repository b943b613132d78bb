"""What kernels say in place of `if` where runs in lockstep may differ.

    select(mask, a, b)   a where the mask holds, b elsewhere
    any_lane(mask)       whether it holds anywhere
    all_lanes(mask)      whether it holds everywhere
    no(mask)             where it does not hold

For one run a mask is True or False: the first is `a if mask else b`, the others are the mask
itself and `not`, and the machine code is that of `if`. In lockstep, `if any_lane(mask):` goes
where any run goes, and `select` keeps what is its own; a loop goes on until all runs have
what they want, and those that have it stay where they are. NaN must end every loop: a run that
failed goes on with it until its company is done.
"""

from typing import Any, TypeVar

from llvmlite import ir
from numba import types
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, type_callable

from thermobearing.core.lanes.kinds import LaneType, MaskType, first_type

T = TypeVar("T")


def select(condition: bool, a: T, b: T) -> T:
    """`a` where the condition holds, `b` elsewhere; both are computed."""
    return a if condition else b


def any_lane(condition: bool) -> bool:
    """Whether it holds in any run; for one, whether it holds."""
    return condition


def all_lanes(condition: bool) -> bool:
    """Whether it holds in all runs; for one, whether it holds."""
    return condition


def no(condition: bool) -> bool:
    """Where it does not hold."""
    return not condition


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
