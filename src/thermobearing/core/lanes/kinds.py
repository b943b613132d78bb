"""Lanes and masks: the numba types of several numbers, and of several yes or no, side by side.

Kernels are written once. Called with a float they compute one run; called with a lane in its
place they compute as many runs as it is wide, in lockstep. A lane is an LLVM vector of doubles,
on which the processor works with one instruction, or a few. No operation mixes lanes: the
result of a run does not depend on the runs next to it.
"""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typeconv.castgraph import Conversion
from numba.core.typing.templates import signature
from numba.extending import lower_builtin, lower_cast, models, register_model, type_callable

BYTES = 8  # of a double
DOUBLE, BIT, PLACE = ir.DoubleType(), ir.IntType(1), ir.IntType(32)
NUMBERS = types.Float | types.Integer | types.Boolean


class LaneType(types.Type):
    """Doubles side by side."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(f"Lane({width})")

    def can_convert_from(self, _: Any, other: Any) -> Any:
        """A number is the same in all lanes."""
        return Conversion.safe if isinstance(other, NUMBERS) else None


class MaskType(types.Type):
    """Whether something holds, lane by lane."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(f"Mask({width})")

    def can_convert_from(self, _: Any, other: Any) -> Any:
        """What holds, holds in all lanes."""
        return Conversion.safe if isinstance(other, types.Boolean) else None


@register_model(LaneType)
class LaneModel(models.PrimitiveModel):
    """A vector of doubles, in memory too."""

    def __init__(self, manager: Any, kind: LaneType) -> None:
        super().__init__(manager, kind, ir.VectorType(DOUBLE, kind.width))


@register_model(MaskType)
class MaskModel(models.PrimitiveModel):
    """A vector of bits; never in memory."""

    def __init__(self, manager: Any, kind: MaskType) -> None:
        super().__init__(manager, kind, ir.VectorType(BIT, kind.width))


def everywhere(builder: Any, value: Any, width: int) -> Any:
    """A number in every lane."""
    vector = ir.VectorType(value.type, width)
    empty = ir.Constant(vector, ir.Undefined)
    first = builder.insert_element(empty, value, ir.Constant(PLACE, 0))
    order = ir.Constant(ir.VectorType(PLACE, width), [0] * width)
    return builder.shuffle_vector(first, empty, order)


def _number_to_lane(context: Any, builder: Any, old: Any, new: Any, value: Any) -> Any:
    return everywhere(builder, context.cast(builder, value, old, types.float64), new.width)


def _bool_to_mask(context: Any, builder: Any, old: Any, new: Any, value: Any) -> Any:
    return everywhere(builder, context.cast(builder, value, old, types.boolean), new.width)


for number in (types.Float, types.Integer, types.Boolean):
    lower_cast(number, LaneType)(_number_to_lane)
lower_cast(types.Boolean, MaskType)(_bool_to_mask)


def first_type(kind: type, candidates: Sequence[Any]) -> Any:
    """The first type of a kind, None if there is none."""
    return next((candidate for candidate in candidates if isinstance(candidate, kind)), None)


def define(
    function: Any,
    count: int,
    result: type,
    code: Callable[..., Any],
    kind: type = LaneType,
) -> None:
    """Teach numba a function of `count` lanes (or masks): `code(builder, *values)` writes it.

    Where one argument is a lane, the numbers passed with it become lanes.
    """

    def typed(*arguments: Any) -> Any:
        lane = first_type(kind, arguments)
        return None if lane is None else signature(result(lane.width), *[lane] * count)

    def one(_: Any) -> Any:
        def of_one(a: Any) -> Any:
            return typed(a)

        return of_one

    def two(_: Any) -> Any:
        def of_two(a: Any, b: Any) -> Any:
            return typed(a, b)

        return of_two

    def lower(_: Any, builder: Any, __: Any, values: Any) -> Any:
        return code(builder, *values)

    type_callable(function)(one if count == 1 else two)
    lower_builtin(function, *[kind] * count)(lower)
