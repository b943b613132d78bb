"""The hardening term of a layer (Eq. 4.34), and at which strain it is taken.

    f = ke d + (1 + B s^2) kh Z,   s = (1 - w) d + w x/N,   B = b/t_r^2

w = 0 is the published law. Where a strained layer unloads, d and Z have opposite signs, and the
hardening makes the layer tangent small or negative; there w goes to 1 (see sharing.py). With
`monotone` the law itself is changed there, and there only: B s^2 continues as a straight line from
the strain where its slope could take more than 1 - `sharing_start` of ke. Every tangent is then
at least `sharing_start` ke, and w stays 0.
"""

import math
from typing import Any

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.hysteresis import advance
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.types import EULER, Layer, LayerWork, Rubber, State
from thermobearing.core.vector import (
    Matrix,
    Pair,
    Vector,
    choice,
    dot,
    isotropic,
    minus,
    norm,
    outer,
    pick,
    plus,
    scaled,
    transposed_times,
    zero,
)


@compiled
def _strain_factor_on_line(
    rubber: Rubber, ke: float, kh: float, s: float, z: float
) -> tuple[float, float]:
    """B s^2 and its derivative by s, or their monotone form where s and Z differ in sign."""
    b = rubber.hardening
    if rubber.monotone and any_lane(s * z < 0.0):
        # B s^2 may rise until its slope takes all but `sharing_start` of ke at |Z| = d_y.
        steepest = (1.0 - rubber.sharing_start) * ke / (kh * rubber.yield_displacement)
        straight = (s * z < 0.0) & (2.0 * b * abs(s) > steepest)
        if any_lane(straight):
            # p |s| - p^2/(4 B) touches B s^2 where the slope is p (docs/theory.md, Eq. T5).
            line = steepest * (abs(s) - 0.25 * steepest / b)
            return (
                select(straight, line, b * s * s),
                select(straight, math.copysign(steepest, s), 2.0 * b * s),
            )
    by_half = b * s
    return by_half * s, 2.0 * by_half


@compiled
def _strain_factor_in_plane(
    rubber: Rubber, ke: float, kh: float, s: Pair, z: Pair
) -> tuple[float, Pair]:
    """`strain_factor` in a plane, where there is no monotone form."""
    b = rubber.hardening
    return b * dot(s, s), scaled(s, 2.0 * b)


strain_factor = choice(_strain_factor_on_line, _strain_factor_in_plane, at=3)


@compiled
def hardening_strain(d: Vector, mean: Vector, w: float) -> Vector:
    """Strain s at which the hardening factor is taken, as a displacement [mm]."""
    if all_lanes(w == 0.0):
        return d
    return plus(scaled(d, 1.0 - w), scaled(mean, w))


@compiled
def force_and_tangent(
    rubber: Rubber,
    ke: float,
    kh: float,
    d: Vector,
    z: Vector,
    slope: Matrix,
    mean: Vector,
    w: float,
) -> tuple[Vector, Matrix]:
    """Layer force [kN] and tangent [kN/mm] from d, Z and dZ/dd (Eq. 4.34, hardening at s)."""
    strain_term, by_s = strain_factor(rubber, ke, kh, hardening_strain(d, mean, w), z)
    hardening = 1.0 + strain_term
    if any_lane(w != 0.0):
        by_s = scaled(by_s, 1.0 - w)
    by_strain = outer(z, by_s)
    force = plus(scaled(d, ke), scaled(z, hardening * kh))
    return force, plus(isotropic(d, ke), scaled(plus(scaled(slope, hardening), by_strain), kh))


@compiled
def surely_stiff(rubber: Rubber, ke: float, kh: float, layer: Layer, step: float) -> bool:
    """Return whether the margin surely exceeds `sharing_start`: a bound on Z, not the closed form.

    |Z| unloads fastest at the start, or where an inner branch starts, and loads by at most 1; the
    margin falls with Z against d.
    """
    d, d_y = layer.d + step, rubber.yield_displacement
    crosses = d * layer.d <= 0.0
    if rubber.integrator == EULER or rubber.law != 0 or all_lanes(crosses):
        return False
    largest = max(abs(layer.z), layer.amplitude)
    steepest = max(1.0, 1.0 + rubber.unloading_curvature * largest * largest)
    # The largest |Z| against d after the step: unloading as fast as it can, less the |Z| that is
    # with d now.
    against = steepest * abs(step) - math.copysign(layer.z, layer.z * d)
    never_opposed, too_far = against <= 0.0, against >= d_y
    if all_lanes(never_opposed):
        return no(crosses)
    if all_lanes(too_far):
        return False
    u, b = against * rubber.per_yield_displacement, rubber.hardening
    # Both terms of the margin are smallest at that Z.
    lowest = (1.0 + b * d * d) * (1.0 - u * u) - 2.0 * b * abs(d) * against
    enough = ke + kh * lowest >= rubber.sharing_start * ke
    return no(crosses | too_far) & (never_opposed | enough)


@compiled
def _margin_on_line(
    rubber: Rubber, ke: float, kh: float, old: State, j: int, step: float
) -> tuple[float, float]:
    """Layer tangent / ke at w = 0 after the increment `step`, and its derivative [1/mm].

    Z' is that of motion towards larger |Z| whichever way the layer moves, so that the margin is
    a function of d and Z alone and does not jump where the motion turns. 1 where d and Z have
    one sign: hardening only stiffens there.
    """
    b, d_y, layer = rubber.hardening, rubber.yield_displacement, old.layers[j]
    sigma = select(step >= 0.0, 1.0, -1.0)
    loading = (sigma * layer.d >= 0.0) & (sigma * layer.z >= 0.0)
    d = layer.d + step
    # |Z| <= d_y bounds the negative term. Bounds come first: most steps need no closed form.
    harmful = 2.0 * b * abs(d) * kh * d_y > (1.0 - rubber.sharing_start) * ke
    stiffens = loading | no(harmful)
    if all_lanes(stiffens):
        return 1.0, 0.0
    stiffens = stiffens | surely_stiff(rubber, ke, kh, layer, step)
    if all_lanes(stiffens):
        return 1.0, 0.0
    z, by = advance(rubber, old, j, d, step)
    stiffens = stiffens | (d * z >= 0.0)
    if all_lanes(stiffens):
        return 1.0, 0.0
    per = rubber.per_yield_displacement
    relative = z * per
    slope = 1.0 - relative * relative
    by_slope = -2.0 * relative * by * per
    hardening, ratio = 1.0 + b * d * d, kh / ke
    value = 1.0 + ratio * (hardening * slope + 2.0 * b * d * z)
    rate = ratio * (2.0 * b * (d * slope + z + d * by) + hardening * by_slope)
    return select(stiffens, 1.0, value), select(stiffens, 0.0, rate)


@compiled
def _least_hardening(b: float, d_y: float, d: Pair, z: Pair) -> tuple[float, float, float]:
    """Smallest eigenvalue, and two parts of it, of the symmetric b (Z d' + d Z') - h Z Z'/d_y^2.

    h = 1 + b |d|^2. It is half - root with the trace of 2 half; returns these three.
    """
    h = 1.0 + b * dot(d, d)
    half = b * dot(z, d) - 0.5 * h * dot(z, z) / (d_y * d_y)
    skew = b * (z[0] * d[1] - z[1] * d[0])
    root = math.sqrt(half * half + skew * skew)
    return half - root, half, root


@compiled
def _margin_in_plane(
    rubber: Rubber, ke: float, kh: float, old: State, j: int, step: Pair
) -> tuple[float, Pair]:
    """`margin` in a plane: smallest eigenvalue of the symmetric part of the layer tangent / ke.

    dZ/dd is that of loading in all directions, I - Z Z'/d_y^2.
    """
    b, d_y, start = rubber.hardening, rubber.yield_displacement, rubber.sharing_start
    z0: Any = old.layers[j].z
    d: Any = plus(old.layers[j].d, step)
    # The bounds of a line, with norms.
    harmful = 2.0 * b * norm(d) * kh * d_y > (1.0 - start) * ke
    if all_lanes(no(harmful)):
        return 1.0, zero(step)
    h = 1.0 + b * dot(d, d)
    steepest = max(1.0, 1.0 + rubber.unloading_curvature * dot(z0, z0))
    z_change = steepest * norm(
        step
    )  # |Z| changes by at most that, and the eigenvalue by a multiple
    least = _least_hardening(b, d_y, d, z0)[0]
    lowest = least - 2.0 * (h / d_y * (1.0 + z_change / d_y) + b * norm(d)) * z_change
    bounded = rubber.law_in_plane == 0  # by the closed form
    fine = no(harmful) | (bounded & (ke + kh * (h + lowest) >= start * ke))
    if all_lanes(fine):
        return 1.0, zero(step)
    z: Any
    z, by = advance(rubber, old, j, d, step)
    least, half, root = _least_hardening(b, d_y, d, z)
    value = 1.0 + kh / ke * (h + least)
    # The derivatives of half and skew by d and Z, and of both by the step.
    per, skew = dot(z, z) / (d_y * d_y), b * (z[0] * d[1] - z[1] * d[0])
    half_by_d = minus(scaled(z, b), scaled(d, b * per))
    half_by_z = minus(scaled(d, b), scaled(z, h / (d_y * d_y)))
    skew_by_d: Pair = (-b * z[1], b * z[0])
    skew_by_z: Pair = (b * d[1], -b * d[0])
    over_root = 1.0 / select(root > 0.0, root, 1.0)
    of_half, of_skew = 1.0 - half * over_root, -skew * over_root
    by_d = plus(scaled(half_by_d, of_half), scaled(skew_by_d, of_skew))
    by_z = plus(scaled(half_by_z, of_half), scaled(skew_by_z, of_skew))
    by_d = plus(by_d, scaled(d, 2.0 * b))
    rate = scaled(plus(by_d, transposed_times(by, by_z)), kh / ke)
    return select(fine, 1.0, value), pick(fine, zero(step), rate)


margin = choice(_margin_on_line, _margin_in_plane, at=5)


@compiled
def weight(rubber: Rubber, old: State, work: LayerWork, step: Vector) -> tuple[float, Vector]:
    """w, and its derivative by the increment `step` of all layers [1/mm]."""
    smallest, rate = 1.0, zero(step)
    if rubber.monotone:
        return 0.0, zero(step)
    for j in range(len(work.trial)):
        value, by = margin(rubber, work.elastic[j], work.hysteretic[j], old, j, step)
        is_smaller = value < smallest
        smallest, rate = select(is_smaller, value, smallest), pick(is_smaller, by, rate)
    none, all_of_it = smallest >= rubber.sharing_start, smallest <= rubber.sharing_full
    if all_lanes(none):
        return 0.0, zero(step)
    if all_lanes(all_of_it):
        return 1.0, zero(step)
    width = rubber.sharing_start - rubber.sharing_full
    t = (rubber.sharing_start - smallest) / width
    # A smooth step, whose slope is zero at both ends: the tangent stays continuous.
    w = t * t * (3.0 - 2.0 * t)
    by_step = scaled(rate, -6.0 * t * (1.0 - t) / width)
    return (
        select(none, 0.0, select(all_of_it, 1.0, w)),
        pick(none | all_of_it, zero(step), by_step),
    )
