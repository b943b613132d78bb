"""Vectors of one or two horizontal directions, from the same kernels.

A bearing that moves on a line has floats for displacement, Z, force and tangent. A bearing that
moves in a plane has pairs (x, y) in place of these vectors, and two rows of pairs in place of the
2 x 2 tangents. Kernels call the functions below, and numba decides by the type of an argument
which version it compiles. On a line each is the operation of floats that its name says, so that a
kernel gives the same bits as one written with operators. In annotations, `Vector` and `Matrix` are
floats, as in a kernel for runs in lockstep.
"""

import math
from collections.abc import Callable
from typing import Any, TypeAlias, TypeVar, cast

from thermobearing.core.compiled.kernel import Kernel, compiled
from thermobearing.core.lanes.choose import select
from thermobearing.core.records import Matrix as Matrix
from thermobearing.core.records import Peak as Peak
from thermobearing.core.records import Vector as Vector

Pair: TypeAlias = Any  # (x, y)
Square: TypeAlias = Any  # two rows of pairs
Triple: TypeAlias = Any  # of a peak
F = TypeVar("F", bound=Callable[..., Any])


class Choice:
    """A kernel in versions for a line and a plane; the argument at one place decides."""

    def __init__(self, at: int, *versions: Any) -> None:
        self.at, self.versions = at, cast("tuple[Kernel, ...]", versions)

    def __call__(self, *arguments: Any) -> Any:
        """Run the version for the arguments."""
        rank = 0
        argument = arguments[self.at]
        while not isinstance(argument, (float, int)):
            rank, argument = rank + 1, argument[0]
        return self.versions[rank](*arguments)


def choice(line: F, *plane: Any, at: int = 0) -> F:
    """Return a function with versions for floats, pairs and rows of pairs as argument `at`."""
    return cast(F, Choice(at, line, *plane))


def as_plane(record: Any) -> Any:
    """Return a record of arrays for kernels, with pairs in place of the last axes of vectors.

    Compiled kernels view the same memory (lanes/views.py). Plain Python needs no view.
    """
    return record


@compiled
def _plus(a: float, b: float) -> float:
    return a + b


@compiled
def _plus_pairs(a: Pair, b: Pair) -> Pair:
    return a[0] + b[0], a[1] + b[1]


@compiled
def _plus_squares(a: Square, b: Square) -> Square:
    return _plus_pairs(a[0], b[0]), _plus_pairs(a[1], b[1])


@compiled
def _minus(a: float, b: float) -> float:
    return a - b


@compiled
def _minus_pairs(a: Pair, b: Pair) -> Pair:
    return a[0] - b[0], a[1] - b[1]


@compiled
def _scaled(a: float, by: float) -> float:
    return a * by


@compiled
def _scaled_pair(a: Pair, by: float) -> Pair:
    return a[0] * by, a[1] * by


@compiled
def _scaled_square(a: Square, by: float) -> Square:
    return _scaled_pair(a[0], by), _scaled_pair(a[1], by)


@compiled
def _over(a: float, by: float) -> float:
    return a / by


@compiled
def _over_pair(a: Pair, by: float) -> Pair:
    return a[0] / by, a[1] / by


@compiled
def _over_square(a: Square, by: float) -> Square:
    return _over_pair(a[0], by), _over_pair(a[1], by)


@compiled
def _pick(where: bool, a: float, b: float) -> float:
    return select(where, a, b)


@compiled
def _pick_pair(where: bool, a: Pair, b: Pair) -> Pair:
    return select(where, a[0], b[0]), select(where, a[1], b[1])


@compiled
def _pick_square(where: bool, a: Square, b: Square) -> Square:
    return _pick_pair(where, a[0], b[0]), _pick_pair(where, a[1], b[1])


@compiled
def _norm(a: float) -> float:
    return abs(a)


@compiled
def _norm_pair(a: Pair) -> float:
    square: float = a[0] * a[0] + a[1] * a[1]
    return math.sqrt(square)


@compiled
def _total(a: float) -> float:
    return a


@compiled
def _total_pair(a: Pair) -> float:
    component_sum: float = a[0] + a[1]
    return component_sum


@compiled
def _direction(a: float) -> float:
    return select(a >= 0.0, 1.0, -1.0)


@compiled
def _direction_pair(a: Pair) -> Pair:
    size = _norm_pair(a)
    rests = size == 0.0
    # A zero vector points along x, as a zero on a line counts as positive; no run divides by zero.
    per = 1.0 / select(rests, 1.0, size)
    return select(rests, 1.0, a[0] * per), a[1] * per


@compiled
def _zero(a: float) -> float:
    return 0.0


@compiled
def _zero_pair(a: Pair) -> Pair:
    return 0.0, 0.0


@compiled
def _no_slope_pair(a: Pair) -> Square:
    return (0.0, 0.0), (0.0, 0.0)


@compiled
def _isotropic(a: float, by: float) -> float:
    return by


@compiled
def _isotropic_pair(a: Pair, by: float) -> Square:
    return (by, 0.0), (0.0, by)


@compiled
def _dot(a: float, b: float) -> float:
    return a * b


@compiled
def _dot_pair(a: Pair, b: Pair) -> float:
    scalar_product: float = a[0] * b[0] + a[1] * b[1]
    return scalar_product


@compiled
def _each_times_pair(a: Pair, b: Pair) -> Pair:
    return a[0] * b[0], a[1] * b[1]


@compiled
def _is_nonzero(a: float) -> bool:
    return a != 0.0


@compiled
def _is_nonzero_pair(a: Pair) -> bool:
    nonzero: bool = (a[0] != 0.0) | (a[1] != 0.0)
    return nonzero


@compiled
def _no_peak_pair(a: Pair) -> Triple:
    return 0.0, 0.0, 0.0


@compiled
def _farther(largest: float, a: float) -> float:
    return max(largest, abs(a))


@compiled
def _farther_pair(largest: Triple, a: Pair) -> Triple:
    return _farther(largest[0], a[0]), _farther(largest[1], a[1]), max(largest[2], _norm_pair(a))


@compiled
def _outer_pair(a: Pair, b: Pair) -> Square:
    return _scaled_pair(b, a[0]), _scaled_pair(b, a[1])


@compiled
def _times_pair(a: Square, b: Pair) -> Pair:
    return _dot_pair(a[0], b), _dot_pair(a[1], b)


@compiled
def _transposed_times_pair(a: Square, b: Pair) -> Pair:
    return a[0][0] * b[0] + a[1][0] * b[1], a[0][1] * b[0] + a[1][1] * b[1]


@compiled
def _between(a: float, k: float, b: float) -> float:
    return a * b * k


@compiled
def _between_pairs(a: Pair, k: Square, b: Pair) -> float:
    return _dot_pair(_times_pair(k, b), a)


@compiled
def _product_square(a: Square, b: Square) -> Square:
    return _transposed_times_pair(b, a[0]), _transposed_times_pair(b, a[1])


@compiled
def _inverse(a: float, by: float) -> float:
    return by / a


@compiled
def _inverse_square(a: Square, by: float) -> Square:
    per = by / (a[0][0] * a[1][1] - a[0][1] * a[1][0])
    return (per * a[1][1], -per * a[0][1]), (-per * a[1][0], per * a[0][0])


@compiled
def _solve(a: float, b: float) -> float:
    return b / a


@compiled
def _solve_square(a: Square, b: Pair) -> Pair:
    return _times_pair(_inverse_square(a, 1.0), b)


@compiled
def _along(a: float) -> float:
    return a


@compiled
def _along_pair(a: Pair) -> float:
    component: float = a[0]
    return component


@compiled
def _across_pair(a: Pair) -> float:
    component: float = a[1]
    return component


@compiled
def _components(a: float, x: float, y: float) -> float:
    return x


@compiled
def _components_pair(a: Pair, x: float, y: float) -> Pair:
    return x, y


@compiled
def _diagonal_pair(a: Pair, x: float, y: float) -> Square:
    return (x, 0.0), (0.0, y)


@compiled
def _lowest(a: float) -> float:
    return a


@compiled
def _lowest_square(a: Square) -> float:
    half, cross = 0.5 * (a[0][0] - a[1][1]), 0.5 * (a[0][1] + a[1][0])
    eigenvalue: float = 0.5 * (a[0][0] + a[1][1]) - math.sqrt(half * half + cross * cross)
    return eigenvalue


along_x = choice(_along, _along_pair)  # the component along x
across = choice(_zero, _across_pair)  # the component along y, zero on a line
components = choice(_components, _components_pair)  # a vector of two numbers, like a vector
diagonal = choice(_components, _diagonal_pair)  # the matrix of two numbers, like a vector
plus = choice(_plus, _plus_pairs, _plus_squares)
minus = choice(_minus, _minus_pairs)
scaled = choice(_scaled, _scaled_pair, _scaled_square)
over = choice(_over, _over_pair, _over_square)
pick = choice(_pick, _pick_pair, _pick_square, at=1)  # `select` of vectors or matrices
norm = choice(_norm, _norm_pair)
total = choice(_total, _total_pair)  # the sum of components: finite where all of them are
direction = choice(_direction, _direction_pair)  # of unit length, positive for a zero
zero = choice(_zero, _zero_pair)  # the zero vector, like a vector
no_slope = choice(_zero, _no_slope_pair)  # the zero matrix, like a vector
isotropic = choice(_isotropic, _isotropic_pair)  # a multiple of the unit matrix, like a vector
no_peak = choice(_zero, _no_peak_pair)  # a peak before anything is seen, like a vector
farther = choice(_farther, _farther_pair, at=1)  # a peak after a vector is seen
is_nonzero = choice(_is_nonzero, _is_nonzero_pair)  # whether a vector has a component
each_times = choice(_dot, _each_times_pair)  # the products of the components
between = choice(_between, _between_pairs)  # a vector times a matrix times a vector
dot = choice(_dot, _dot_pair)
outer = choice(_dot, _outer_pair)
times = choice(_dot, _times_pair, at=1)  # a matrix times a vector
product = choice(_dot, None, _product_square)  # a matrix times a matrix
inverse = choice(_inverse, None, _inverse_square)  # of a matrix, times a number
transposed_times = choice(_dot, _transposed_times_pair, at=1)
solve = choice(_solve, _solve_square, at=1)  # the inverse of a matrix times a vector
lowest = choice(_lowest, None, _lowest_square)  # smallest eigenvalue of the symmetric part
