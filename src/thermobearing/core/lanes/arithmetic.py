"""Operators of lanes and masks, and what processors do with vectors in one instruction."""

import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils

from thermobearing.core.lanes.kinds import DOUBLE, LaneType, MaskType, define

CONTRACT = ("contract",)  # a multiply and an add may become one, as everywhere in kernels


def _fast(name: str) -> Callable[..., Any]:
    return lambda builder, a, b: getattr(builder, name)(a, b, flags=CONTRACT)


def _compared(sign: str) -> Callable[..., Any]:
    return lambda builder, a, b: builder.fcmp_ordered(sign, a, b)


def _llvm(name: str) -> Callable[..., Any]:
    """An LLVM function of vectors of doubles."""

    def code(builder: Any, *values: Any) -> Any:
        kind = values[0].type
        function_type = ir.FunctionType(kind, [kind] * len(values))
        called = f"llvm.{name}.v{kind.count}f64"
        function = cgutils.get_or_insert_function(builder.module, function_type, called)
        return builder.call(function, values)

    return code


def _finite(builder: Any, value: Any) -> Any:
    largest = ir.Constant(value.type, [ir.Constant(DOUBLE, math.inf)] * value.type.count)
    return builder.fcmp_ordered("<", _llvm("fabs")(builder, value), largest)


for name in ("add", "sub", "mul"):
    define(getattr(operator, name), 2, LaneType, _fast(f"f{name}"))
    define(getattr(operator, f"i{name}"), 2, LaneType, _fast(f"f{name}"))
define(operator.truediv, 2, LaneType, _fast("fdiv"))
define(operator.itruediv, 2, LaneType, _fast("fdiv"))
define(operator.neg, 1, LaneType, lambda builder, a: builder.fneg(a))
for name, sign in (("lt", "<"), ("le", "<="), ("gt", ">"), ("ge", ">="), ("eq", "==")):
    define(getattr(operator, name), 2, MaskType, _compared(sign))
define(operator.ne, 2, MaskType, lambda builder, a, b: builder.fcmp_unordered("!=", a, b))
define(operator.and_, 2, MaskType, lambda builder, a, b: builder.and_(a, b), MaskType)
define(operator.or_, 2, MaskType, lambda builder, a, b: builder.or_(a, b), MaskType)
define(max, 2, LaneType, lambda builder, a, b: builder.select(_compared(">")(builder, b, a), b, a))
define(min, 2, LaneType, lambda builder, a, b: builder.select(_compared("<")(builder, b, a), b, a))
define(abs, 1, LaneType, _llvm("fabs"))
define(math.sqrt, 1, LaneType, _llvm("sqrt"))
define(math.ceil, 1, LaneType, _llvm("ceil"))
define(math.copysign, 2, LaneType, _llvm("copysign"))
define(math.isfinite, 1, MaskType, _finite)
