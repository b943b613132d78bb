"""The hysteretic variable Z of one rubber layer (Eq. 4.35-4.37) and its tangent.

    dZ = dd - beta |dd Z| Z - gamma dd Z^2,   beta = 1/((1+s) d_y^2),   gamma = s beta

With sigma the sign of the motion, u = sigma Z and e = |dd| this is the autonomous equation

    du/de = 1 - u^2/d_y^2          for u >= 0   (loading: tanh)
    du/de = 1 + c u^2              for u <  0   (unloading), c = (1-s)/((1+s) d_y^2)

where c > 0 (s < 1) gives a tangent, c = 0 a straight line, c < 0 (s > 1) a tanh. Both are
solved in closed form, so an increment of any size is exact while the motion keeps its sign.

**Small loops.** With s < 0 unloading is much steeper than reloading, so that a small reversal does
not come back to where it began. Where small loops close, a layer remembers its turning points
(d_i, Z_i), i = 1..n. The first of them, with the amplitude Z_P = |Z_1|, begins an outer branch,
which is that of the law above. A reversal inside of it begins an inner branch, the reflection of
the outer one: the same equation about the centre Z_n + sigma Z_P in place of zero. It ends at the
last turning point but one (d_{n-1}, Z_{n-1}), where the branch before goes on and both points are
forgotten. On steady loops there are no inner branches, and the law is the published one.

**In a plane** Z and d are vectors, and the law must not depend on the choice of axes:

    dZ = dd - Z [gamma (dd . Z) + beta |dd . Z|]

Over a straight increment of length a in the direction e, the part p = Z . e follows the law of a
line, and the part q across it decays with the same f(u) = du/de:  q'/q = sqrt(f(p')/f(p)).
Explicit Euler and closed small loops are for a line only.

**A law of a user** is a C function that kernels call by its address. It moves Z/d_y over a straight
increment of d/d_y, and gives dZ/dd at its end.
"""

import ctypes
import math
from typing import Any

from thermobearing.core.compiled.kernel import compiled, compiled_apart
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.records import Rows
from thermobearing.core.types import DEPTH, EULER, Layer, Rubber, State, Turn
from thermobearing.core.vector import (
    Pair,
    Square,
    choice,
    direction,
    dot,
    isotropic,
    norm,
    outer,
    over,
    pick,
    plus,
    scaled,
)

COMPONENTS = {1: 2, 2: 6}  # numbers that a law of a user returns on a line and in a plane
LEAST_STEP = 1e-9  # increment, relative to d_y, that shows the slope at its start
NO_MOTION = 1e-12  # displacement, relative to d_y, too small for its direction to matter
SHORT = 1e-7  # the same, below which differences of a closed form are taken from its limit


def law_type(components: int) -> Any:
    """Return the C type of a user's law: Z and d (x, y), four parameters, and room for results."""
    return ctypes.CFUNCTYPE(
        None, *[ctypes.c_double] * (2 * components + 4), ctypes.POINTER(ctypes.c_double)
    )


def _call(components: int, address: int, *numbers: float) -> Any:
    results = (ctypes.c_double * COMPONENTS[components])()
    law_type(components)(address)(*numbers, results)
    return tuple(results)


def call_on_line(
    address: int, z: float, d: float, a: float, b: float, c: float, e: float
) -> tuple[float, float]:
    """Call a law of a user on a line: Z and its slope, all relative to d_y.

    Compiled kernels have other code for it (lanes/choices.py).
    """
    result: tuple[float, float] = _call(1, address, z, d, a, b, c, e)
    return result


def call_in_plane(
    address: int,
    zx: float,
    zy: float,
    dx: float,
    dy: float,
    a: float,
    b: float,
    c: float,
    e: float,
) -> tuple[float, float, float, float, float, float]:
    """Call a law of a user in a plane: Z and the rows of its slope, all relative to d_y."""
    result: tuple[float, ...] = _call(2, address, zx, zy, dx, dy, a, b, c, e)
    return result  # type: ignore[return-value]


@compiled_apart
def user_law_on_line(rubber: Rubber, z: float, moved: float) -> tuple[float, float]:
    """Z and dZ/dd after a motion by the law of a user."""
    d_y, r = rubber.yield_displacement, rubber
    u, slope = call_on_line(r.law, z / d_y, moved / d_y, r.law_1, r.law_2, r.law_3, r.law_4)
    return u * d_y, slope


@compiled_apart
def user_law_in_plane(rubber: Rubber, z: Pair, moved: Pair) -> tuple[Pair, Square]:
    """`user_law_on_line` in a plane."""
    d_y, r = rubber.yield_displacement, rubber
    u: Any = over(z, d_y)
    d: Any = over(moved, d_y)
    ux, uy, xx, xy, yx, yy = call_in_plane(
        r.law_in_plane, u[0], u[1], d[0], d[1], r.law_1, r.law_2, r.law_3, r.law_4
    )
    return (ux * d_y, uy * d_y), ((xx, xy), (yx, yy))


@compiled
def unload(u: float, e: float, curvature: float) -> tuple[float, float]:
    """Move u < 0 towards zero over a path e; returns (u, path left over once u is zero).

    The curvature of runs in lockstep has one sign.
    """
    # c > 0: k u = tan(k e + atan(k u_0)), written with the addition theorem. From a quarter turn on
    # tan begins again, but u has passed zero.
    if any_lane(curvature > 0.0):
        k = math.sqrt(curvature)
        path, start = k * e, k * u
        t = math.tan(path)
        arrives = (t >= -start) | (path >= 0.5 * math.pi)
        nearer = (start + t) / (k * (1.0 - start * t))
        remaining = e
        if any_lane(arrives):
            reach = math.atan(-start) / k
            remaining = e - reach
        return select(arrives, 0.0, nearer), select(arrives, remaining, 0.0)
    # c < 0 (s > 1): the same with tanh, which has no quarter turn.
    if any_lane(curvature < 0.0):
        k = math.sqrt(-curvature)
        t = math.tanh(k * e)
        arrives = t >= -k * u
        nearer = (u + t / k) / (1.0 + k * u * t)
        remaining = e
        if any_lane(arrives):
            reach = math.atanh(-k * u) / k
            remaining = e - reach
        return select(arrives, 0.0, nearer), select(arrives, remaining, 0.0)
    # c = 0 (s = 1): a straight line of slope one.
    arrives = e >= -u
    return select(arrives, 0.0, u + e), select(arrives, e + u, 0.0)


@compiled
def hysteretic_slope(u: float, per_d_y: float, curvature: float) -> float:
    """dZ/dd at u = sigma Z: the right side of the equations in the module's head.

    `per_d_y` is 1/d_y [1/mm].
    """
    loads = u >= 0.0
    curved = select(loads, -per_d_y * per_d_y, curvature)
    return 1.0 + curved * u * u


@compiled
def exact_increment(
    z: float, increment: float, d_y: float, per_d_y: float, curvature: float
) -> tuple[float, float]:
    """Z and dZ/dd after a monotone displacement increment, in closed form.

    `z`, `increment` and `d_y` are in mm, `per_d_y` = 1/d_y in 1/mm, `curvature` in 1/mm2. With a
    zero increment the tangent is that of motion in the positive direction.
    """
    sigma = select(increment >= 0.0, 1.0, -1.0)
    u = sigma * z
    e = abs(increment)
    # An increment may unload to zero and load with the rest of its path.
    unloads = u < 0.0
    if any_lane(unloads):
        nearer, remaining = unload(u, e, curvature)
        u, e = select(unloads, nearer, u), select(unloads, remaining, e)
    loads = u >= 0.0
    if any_lane(loads):
        # u = d_y tanh(e/d_y + atanh(u_0/d_y)), written with the addition theorem.
        t = math.tanh(e * per_d_y)
        u = select(loads, (u + d_y * t) / (1.0 + u * t * per_d_y), u)
    return sigma * u, hysteretic_slope(u, per_d_y, curvature)


@compiled
def euler_increment(
    z: float, increment: float, per_d_y: float, curvature: float
) -> tuple[float, float]:
    """The published explicit Euler step: the slope at the start, over the complete increment."""
    u = select(increment >= 0.0, z, -z)
    slope = hysteretic_slope(u, per_d_y, curvature)
    return z + slope * increment, slope


@compiled_apart
def entry(layer: Layer, turns: Rows[Turn], sigma: float) -> tuple[bool, float, float, float, float]:
    """Find the branch on which a layer sets out in the direction sigma.

    Returns whether it reverses, how many turning points are remembered then, the centre of the
    branch, and d and Z where it ends if it is an inner one.
    """
    reverses = layer.heading * sigma < 0.0
    # A reversal at |Z| of the outermost turning point or beyond it replaces the memory.
    is_outer = (layer.turns < 2.0) & (-sigma * layer.z >= layer.amplitude)
    remembered = select(reverses, select(is_outer, 1.0, layer.turns + 1.0), layer.turns)
    newest_z = select(reverses, layer.z, turns[0].z)
    # An inner branch is the reflection of the outer one, about Z_n + sigma Z_P.
    centre = select(remembered > 1.0, newest_z + sigma * layer.amplitude, 0.0)
    # It ends at the last turning point but one, which is turns[0] where the reversal itself has
    # just become the last.
    to_d, to_z = select(reverses, turns[0].d, turns[1].d), select(reverses, turns[0].z, turns[1].z)
    return reverses, remembered, centre, to_d, to_z


@compiled_apart
def branch(
    layer: Layer, turns: Rows[Turn], d: float, sigma: float
) -> tuple[float, float, float, float, float]:
    """Find the branch on which a layer is at d after a motion in the direction sigma.

    Returns displacement and Z where the motion came to that branch, its centre, how many turning
    points are left, and where the branch ends if it is an inner one.
    """
    x, z = layer.d, layer.z
    # The usual case: no inner branch, and no reversal.
    plain = (layer.turns < 2.0) & (layer.heading * sigma >= 0.0)
    if all_lanes(plain):
        return x, z, 0.0, layer.turns, d
    reverses, remaining, centre, to_d, to_z = entry(layer, turns, sigma)
    reached = (remaining > 1.0) & (sigma * (d - to_d) >= 0.0)
    k = 0
    # A long motion may pass the ends of several inner branches; each end forgets two points. A
    # reversal in this motion is not in `turns` yet: its newest entry is the last but one.
    while any_lane(reached):
        x, z = select(reached, to_d, x), select(reached, to_z, z)
        remaining = select(reached, remaining - 2.0, remaining)
        k += 2
        newest_z = select(reverses, turns[k - 1].z, turns[k].z)
        inner = select(remaining > 1.0, newest_z + sigma * layer.amplitude, 0.0)
        centre = select(reached, inner, centre)
        to_d = select(reached, select(reverses, turns[k].d, turns[k + 1].d), to_d)
        to_z = select(reached, select(reverses, turns[k].z, turns[k + 1].z), to_z)
        reached = reached & (remaining > 1.0) & (sigma * (d - to_d) >= 0.0)
    return x, z, centre, remaining, to_d


@compiled
def _decay(p: float, e: float, d_y: float, curvature: float) -> tuple[float, float, float]:
    """Move Z . e = p over a path e; returns it, by what the part across shrinks, and d of that/dp.

    The last two are R = sqrt(f(p')/f(p)) and dR/dp.
    """
    u, loading_path, ratio = p, e, 1.0
    unloads = p < 0.0
    start = 1.0 + curvature * p * p
    if any_lane(unloads):
        nearer, remainder = unload(p, e, curvature)
        u, loading_path = select(unloads, nearer, p), select(unloads, remainder, e)
        ratio = math.sqrt((1.0 + curvature * u * u) / start)
        ratio = select(unloads, ratio, 1.0)
    sinh_term, divisor = 0.0, 1.0
    loads = u >= 0.0
    if any_lane(loads):
        # With q = exp(-loading_path/d_y), 1 + q^2 = 2 q cosh and 1 - q^2 = 2 q sinh: no overflow on
        # long paths, no lost digits on short ones.
        exp_minus_one = math.expm1(-loading_path / d_y)
        cosh_term = 1.0 + (1.0 + exp_minus_one) * (1.0 + exp_minus_one)
        sinh_term = -exp_minus_one * (2.0 + exp_minus_one)
        divisor = cosh_term + u / d_y * sinh_term  # 2 q (cosh + u/d_y sinh)
        ratio = select(loads, ratio * 2.0 * (1.0 + exp_minus_one) / divisor, ratio)
        u = select(loads, (u * cosh_term + d_y * sinh_term) / divisor, u)
    growth = select(u < 0.0, curvature * u, -u / (d_y * d_y))
    by_unloading = (growth - curvature * p) / start
    return u, ratio, ratio * select(unloads, by_unloading, -sinh_term / (d_y * divisor))


@compiled
def plane_increment(z: Pair, increment: Pair, d_y: float, curvature: float) -> tuple[Pair, Square]:
    """Z and dZ/dd after a straight increment in the plane, in closed form.

    With a zero increment the tangent is that of loading.
    """
    e = norm(increment)
    along: Pair = pick(e > 0.0, direction(increment), direction(z))
    across: Pair = -along[1], along[0]
    p, q = dot(z, along), dot(z, across)
    after, ratio, by_p = _decay(p, e, d_y, curvature)
    growth = select(after < 0.0, curvature * after, -after / (d_y * d_y))
    start = select(p < 0.0, curvature, -1.0 / (d_y * d_y))
    # Quotients by e are differences of nearly equal numbers where e is short; their limits are
    # taken there.
    short = e <= SHORT * d_y
    per = 1.0 / select(short, d_y, e)
    side = ratio * q
    # dZ/dd in the directions along and across: by turning the increment, across.
    ee, ne = hysteretic_slope(after, 1.0 / d_y, curvature), side * growth
    en = select(short, q * start * p, side * (ratio - 1.0) * per)
    nn = select(short, 1.0 + start * q * q, (after - ratio * p + q * q * by_p) * per)
    by_along = plus(scaled(along, ee), scaled(across, ne))
    by_across = plus(scaled(along, en), scaled(across, nn))
    slope = plus(outer(by_along, along), outer(by_across, across))
    return plus(scaled(along, after), scaled(across, side)), slope


@compiled
def _advance_on_line(
    rubber: Rubber, old: State, j: int, d: float, moved: float
) -> tuple[float, float]:
    """Z and dZ/dd of layer j after a monotone motion to d, by `moved`."""
    per_d_y, curvature = rubber.per_yield_displacement, rubber.unloading_curvature
    layer = old.layers[j]
    z, centre, sigma = layer.z, 0.0, 1.0
    if rubber.law != 0:
        return user_law_on_line(rubber, z, moved)
    if rubber.integrator == EULER:
        return euler_increment(z, moved, per_d_y, curvature)
    if rubber.closed_loops:
        sigma = select(moved >= 0.0, 1.0, -1.0)
        x, z, centre, _, _ = branch(layer, old.turns[j], d, sigma)
        # On any branch Z - centre obeys the law of the outer one, turned into the positive
        # direction.
        z, moved = sigma * (z - centre), abs(d - x)
    z, slope = exact_increment(z, moved, rubber.yield_displacement, per_d_y, curvature)
    if rubber.closed_loops:
        z = centre + sigma * z
    return z, slope


@compiled
def _advance_in_plane(
    rubber: Rubber, old: State, j: int, d: Pair, moved: Pair
) -> tuple[Pair, Square]:
    """`advance` in a plane."""
    z: Any = old.layers[j].z
    if rubber.law_in_plane != 0:
        return user_law_in_plane(rubber, z, moved)
    return plane_increment(z, moved, rubber.yield_displacement, rubber.unloading_curvature)


advance = choice(_advance_on_line, _advance_in_plane, at=3)


@compiled
def _start_slope_on_line(rubber: Rubber, old: State, j: int, step: float) -> float:
    """dZ/dd where layer j sets out in the direction of `step`."""
    sigma, centre = direction(step), 0.0
    if rubber.law != 0:
        # A law of the user gives its slope at the end of a motion only: the least motion shows it.
        return user_law_on_line(
            rubber, old.layers[j].z, sigma * LEAST_STEP * rubber.yield_displacement
        )[1]
    if rubber.closed_loops:
        centre = entry(old.layers[j], old.turns[j], sigma)[2]
    u = sigma * (old.layers[j].z - centre)
    return hysteretic_slope(u, rubber.per_yield_displacement, rubber.unloading_curvature)


@compiled
def _start_slope_in_plane(rubber: Rubber, old: State, j: int, step: Pair) -> Square:
    """`start_slope` in a plane: I - (gamma + beta sign(step . Z)) Z Z'."""
    z: Any = old.layers[j].z
    if rubber.law_in_plane != 0:
        least = scaled(direction(step), LEAST_STEP * rubber.yield_displacement)
        return user_law_in_plane(rubber, z, least)[1]
    per = -1.0 / (rubber.yield_displacement * rubber.yield_displacement)
    curvature = select(dot(z, step) < 0.0, rubber.unloading_curvature, per)
    return plus(isotropic(z, 1.0), outer(scaled(z, curvature), z))


start_slope = choice(_start_slope_on_line, _start_slope_in_plane, at=3)


@compiled
def _path_from_zero(u: float, d_y: float, curvature: float) -> float:
    """Path of a motion from u = 0 to u, the inverse of `exact_increment`; u < 0 lies behind."""
    loading = d_y * math.atanh(min(max(u, 0.0) / d_y, 1.0))
    unloading = min(u, 0.0)
    if any_lane(curvature > 0.0):
        k = math.sqrt(curvature)
        unloading = math.atan(k * unloading) / k
    elif any_lane(curvature < 0.0):
        k = math.sqrt(-curvature)
        unloading = math.atanh(k * unloading) / k
    return loading + unloading


@compiled_apart
def forget(turns: Rows[Turn], full: bool, amplitude: float, d_y: float, curvature: float) -> None:
    """Drop the two oldest inner turning points of DEPTH + 1.

    The outermost moves to where the next inner branch comes to its Z, so that nothing jumps there.
    """
    outermost, inner = turns[DEPTH], turns[DEPTH - 3]
    sigma = select(outermost.d >= inner.d, 1.0, -1.0)
    u = sigma * (outermost.z - inner.z) - amplitude
    path = _path_from_zero(u, d_y, curvature) - _path_from_zero(-amplitude, d_y, curvature)
    d = inner.d + sigma * min(path, abs(outermost.d - inner.d))
    turns[DEPTH - 2].d = select(full, d, turns[DEPTH - 2].d)
    turns[DEPTH - 2].z = select(full, outermost.z, turns[DEPTH - 2].z)


@compiled
def _remember_on_line(rubber: Rubber, old: State, new: State, j: int, moved: float) -> None:
    """Turning points of layer j after a step by `moved`, once it is accepted."""
    layer, after, past, turns = old.layers[j], new.layers[j], old.turns[j], new.turns[j]
    d_y = rubber.yield_displacement
    sigma = select(moved >= 0.0, 1.0, -1.0)
    rests = abs(moved) <= NO_MOTION * d_y  # what is left is rounding, not a reversal
    after.heading = select(rests, layer.heading, sigma)
    after.turns, after.amplitude = layer.turns, layer.amplitude
    plain = (layer.turns < 2.0) & (layer.heading * sigma >= 0.0)
    if all_lanes(plain):
        turns[0].d, turns[0].z = past[0].d, past[0].z
        return
    reverses, remembered, _, _, _ = entry(layer, past, sigma)
    remaining = branch(layer, past, after.d, sigma)[3]
    no_reversal = reverses & rests
    reverses = reverses & no(no_reversal)
    remembered = select(no_reversal, layer.turns, remembered)
    remaining = select(no_reversal, layer.turns, remaining)
    is_outer = reverses & (remembered == 1.0)
    # Z_P is |Z| at the outermost turning point; an outer reversal becomes that point.
    amplitude = select(remaining == 0.0, 0.0, select(is_outer, abs(layer.z), layer.amplitude))
    # The newest point comes first: a reversal moves the others by one place.
    for k in range(DEPTH + 1):
        if all_lanes(remembered <= k):
            break
        turns[k].d = select(reverses, layer.d if k == 0 else past[k - 1].d, past[k].d)
        turns[k].z = select(reverses, layer.z if k == 0 else past[k - 1].z, past[k].z)
    # Branches that ended in this step take their two points with them.
    drop = remembered > remaining
    while any_lane(drop):
        for k in range(DEPTH):
            turns[k].d = select(drop, turns[k + 2].d, turns[k].d)
            turns[k].z = select(drop, turns[k + 2].z, turns[k].z)
        remembered = select(drop, remembered - 2.0, remembered)
        drop = remembered > remaining
    full = remaining > DEPTH
    if any_lane(full):
        forget(turns, full, amplitude, d_y, rubber.unloading_curvature)
    after.turns = select(full, remaining - 2.0, remaining)
    after.amplitude = amplitude


@compiled
def _nothing_to_remember(rubber: Rubber, old: State, new: State, j: int, moved: Pair) -> None:
    """Small loops stay open in a plane."""


remember = choice(_remember_on_line, _nothing_to_remember, at=4)


@compiled
def _leaves_branch(rubber: Rubber, old: State, j: int, d: float, by: float) -> bool:
    """Return whether a correction `by` of layer j at d passes a turning point."""
    sigma = direction(d - old.layers[j].d)
    x, _, _, remaining, end = branch(old.layers[j], old.turns[j], d, sigma)
    ends = (remaining > 1.0) & (sigma * (d + by - end) >= 0.0)
    return ends | (sigma * (d + by - x) < 0.0)


@compiled
def _stays_on_branch(rubber: Rubber, old: State, j: int, d: Pair, by: Pair) -> bool:
    """There are no branches in a plane."""
    return False


leaves_branch = choice(_leaves_branch, _stays_on_branch, at=3)
