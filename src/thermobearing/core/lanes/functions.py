"""exp, tanh, tan and their like of lanes: no library has them for vectors that numba can call.

Each brings its argument near zero and sums a series, or a continued fraction as a quotient of
polynomials, that is exact there to rounding; errors are a few units in the last place (measured in
tests/unit/test_lanes.py). Where the argument is NaN so is the result. Range reduction by ln 2 in
two parts follows Cody & Waite (1980), Software Manual for the Elementary Functions; the fractions
are those of Lambert (tan) and Gauss (arctan), Abramowitz & Stegun 4.3.94 and 4.4.43.
"""

import math
import operator
from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typing.templates import signature
from numba.extending import intrinsic, overload

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.compiled.sources import OPTIONS
from thermobearing.core.lanes.arithmetic import CONTRACT
from thermobearing.core.lanes.choose import select
from thermobearing.core.lanes.kinds import DOUBLE, LaneType

LONG = ir.IntType(64)
FRACTION = 52  # bits of a double below its exponent
ROUNDER = 1.5 * 2.0**FRACTION  # added to a number, leaves its nearest integer in the last bits
LOG2_E = 1.0 / math.log(2.0)
LN_2_HIGH = 0.693147180369123816490  # 32 bits of ln 2: exact times an exponent
LN_2_LOW = 1.90821492927058770002e-10  # what is left of it
LEAST, MOST = -708.0, 709.0  # beyond them exp is taken for 0 or infinite
HALF_ROOT = 0x3FE6A09E667F3BCD  # sqrt(1/2) as bits
TAN_PI_8, HALF_PI_LOW = math.sqrt(2.0) - 1.0, 6.123233995736766e-17


def fraction(level: int, square: bool, sign: float) -> tuple[list[float], list[float]]:
    """P and Q by powers of z of 1/(1 + sz/(3 + n sz/(5 + ...))), n = 1, or 1, 4, 9 if `square`."""
    above: list[list[float]] = [[0.0], [1.0]]
    below: list[list[float]] = [[1.0], [1.0]]
    for k in range(1, level):
        by = sign * (k * k if square else 1.0)
        for rows in (above, below):
            older, last = rows[-2], rows[-1]
            if rows is above and k == 1:
                rows.append([3.0])
                continue
            new = [(2 * k + 1) * c for c in last] + [0.0] * 2
            for power, c in enumerate(older):
                new[power + 1] += by * c
            while new[-1] == 0.0:
                new.pop()
            rows.append(new)
    scale = below[-1][0]
    return [c / scale for c in above[-1]], [c / scale for c in below[-1]]


def polynomial(coefficients: Sequence[float]) -> Any:
    """A function of a lane: the sum of coefficients times powers, lowest first."""

    @intrinsic
    def value(_: Any, x: Any) -> Any:
        def code(__: Any, builder: Any, ___: Any, values: Any) -> Any:
            vector = values[0].type
            constants = [
                ir.Constant(vector, [ir.Constant(DOUBLE, c)] * vector.count) for c in highest_first
            ]
            total = constants[0]
            for coefficient in constants[1:]:
                product = builder.fmul(total, values[0], flags=CONTRACT)
                total = builder.fadd(product, coefficient, flags=CONTRACT)
            return total

        return signature(x, x), code

    highest_first = list(reversed(coefficients))
    return value


def _longs(builder: Any, value: Any) -> Any:
    return builder.bitcast(value, ir.VectorType(LONG, value.type.count))


def _all(value: Any, number: int) -> Any:
    return ir.Constant(value.type, [ir.Constant(LONG, number)] * value.type.count)


def _piece(count: int, code: Callable[..., Any]) -> Any:
    """An intrinsic of one or two lanes."""

    def lower(_: Any, builder: Any, __: Any, values: Any) -> Any:
        return code(builder, *values)

    def one(_: Any, x: Any) -> Any:
        return signature(x, x), lower

    def two(_: Any, x: Any, y: Any) -> Any:
        return signature(x, x, y), lower

    return intrinsic(one if count == 1 else two)


def _times_power(builder: Any, p: Any, shifted: Any) -> Any:
    exponent = _longs(builder, shifted)
    exponent = builder.shl(exponent, _all(exponent, FRACTION))
    return builder.bitcast(builder.add(_longs(builder, p), exponent), p.type)


def _exponent_bits(builder: Any, x: Any) -> Any:
    bits = _longs(builder, x)
    return builder.ashr(builder.sub(bits, _all(bits, HALF_ROOT)), _all(bits, FRACTION))


def _exponent(builder: Any, x: Any) -> Any:
    return builder.sitofp(_exponent_bits(builder, x), x.type)


def _mantissa(builder: Any, x: Any) -> Any:
    bits, exponent = _longs(builder, x), _exponent_bits(builder, x)
    return builder.bitcast(builder.sub(bits, builder.shl(exponent, _all(bits, FRACTION))), x.type)


times_power = _piece(2, _times_power)  # p 2^k, k in the last bits of k + ROUNDER
exponent = _piece(1, _exponent)  # k of x = m 2^k with m in [sqrt(1/2), sqrt(2))
mantissa = _piece(1, _mantissa)  # m of it
exp_rest = polynomial([1.0 / math.factorial(k) for k in range(2, 14)])  # (e^r - 1 - r)/r^2
atanh_over = polynomial([1.0 / (2 * k + 1) for k in range(11)])  # atanh(s)/s by s^2, s < 0.172
_TAN, _ATAN = fraction(9, square=False, sign=-1.0), fraction(12, square=True, sign=1.0)
tan_above, tan_below = polynomial(_TAN[0]), polynomial(_TAN[1])
atan_above, atan_below = polynomial(_ATAN[0]), polynomial(_ATAN[1])


@compiled
def powers(x: float) -> tuple[float, float]:
    """2^k and e^r - 1 of x = k ln 2 + r, for x between LEAST and MOST."""
    shifted = x * LOG2_E + ROUNDER
    k = shifted - ROUNDER
    r = (x - k * LN_2_HIGH) - k * LN_2_LOW
    # The last bits of NaN are no exponent: the factor makes the result NaN.
    one_or_nan = select(x == x, 1.0, x)
    return times_power(one_or_nan, shifted), r + r * r * exp_rest(r)


@compiled
def _lane_exp(x: float) -> float:
    """e^x."""
    # Clamped, since larger exponents do not fit the bits; both ends are set below.
    inside = select(x < LEAST, LEAST, select(x > MOST, MOST, x))
    power, remainder = powers(inside)
    value = power + power * remainder
    return select(x < LEAST, 0.0, select(x > MOST, math.inf, value))


@compiled
def _lane_expm1(x: float) -> float:
    """e^x - 1."""
    inside = select(x < LEAST, LEAST, select(x > MOST, MOST, x))
    power, remainder = powers(inside)
    value = power * remainder + (power - 1.0)
    return select(x > MOST, math.inf, value)


@compiled
def _lane_tanh(x: float) -> float:
    """(1 - e^-2x)/(1 + e^-2x)."""
    part = _lane_expm1(-2.0 * abs(x))
    return math.copysign(-part / (2.0 + part), x)


@compiled
def _lane_tan(x: float) -> float:
    """For x from 0 to pi/2."""
    # Beyond pi/4 by the complement, tan x = 1/tan(pi/2 - x), with pi/2 in two parts.
    is_reflected = x > 0.25 * math.pi
    y = select(is_reflected, (0.5 * math.pi - x) + HALF_PI_LOW, x)
    z = y * y
    above, below = y * tan_above(z), tan_below(z)
    quotient: float = select(is_reflected, below, above) / select(is_reflected, above, below)
    return quotient


@compiled
def _lane_atan(x: float) -> float:
    """Brought within tan(pi/8) by the angle pi/4 or pi/2."""
    size = abs(x)
    large, small = size > 1.0 / TAN_PI_8, size <= TAN_PI_8
    above = select(small, size, select(large, -1.0, size - 1.0))
    below = select(small, 1.0, select(large, size, size + 1.0))
    angle = select(small, 0.0, select(large, 0.5 * math.pi, 0.25 * math.pi))
    y = above / below
    z = y * y
    return math.copysign(angle + y * (atan_above(z) / atan_below(z)), x)


@compiled
def _lane_log(x: float) -> float:
    """Ln x = k ln 2 + 2 atanh((m - 1)/(m + 1)), for finite x."""
    m, k = mantissa(x), exponent(x)
    s = (m - 1.0) / (m + 1.0)
    value = k * LN_2_HIGH + (2.0 * s * atanh_over(s * s) + k * LN_2_LOW)
    logarithm: float = select(x > 0.0, value, select(x == 0.0, -math.inf, math.nan))
    return logarithm


@compiled
def _lane_atanh(x: float) -> float:
    """For |x| < 1."""
    # The logarithm of nearly one loses the digits that the series keeps.
    small = abs(x) < 0.17
    series_argument = select(small, x, 0.0)
    by_logarithm = 0.5 * _lane_log((1.0 + x) / (1.0 - x))
    result: float = select(
        small, series_argument * atanh_over(series_argument * series_argument), by_logarithm
    )
    return result


@compiled
def _lane_power(x: float, y: float) -> float:
    """x^y for x >= 0 and y > 0, or any y where x > 0."""
    return select(y == 0.0, 1.0, _lane_exp(y * _lane_log(x)))


def _of_lanes(function: Callable[..., Any], lane_function: Any) -> None:
    """Calls of a function with a lane are calls of ours."""

    def call(x: Any) -> Any:
        return lane_function(x)

    @overload(function, jit_options=OPTIONS)
    def _(x: Any) -> Any:
        return call if isinstance(x, LaneType) else None


for known, ours in (
    (math.exp, _lane_exp),
    (math.expm1, _lane_expm1),
    (math.tanh, _lane_tanh),
    (math.tan, _lane_tan),
    (math.atan, _lane_atan),
    (math.log, _lane_log),
    (math.atanh, _lane_atanh),
):
    _of_lanes(known, ours)


def _call_power(x: Any, y: Any) -> Any:
    return _lane_power(x, y)


@overload(operator.pow, jit_options=OPTIONS)
def _power(x: Any, y: Any) -> Any:
    of_lanes = isinstance(x, LaneType) and isinstance(y, LaneType | types.Float)
    return _call_power if of_lanes else None
