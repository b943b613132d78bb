"""Measures of one loop, as a kernel: plain numbers, for Python and the live page."""

import math

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.records import Floats

FIT_FROM, FIT_TO = 0.5, 0.9  # part of the loading branch that gives K_d, of the peak


@compiled
def _force_at_zero(displacement: Floats, force: Floats, sign: float) -> float:
    """Force at the last zero of the displacement in one direction; NaN without.

    The cycle is closed: its second point follows its last, which may miss zero by a rounding.
    """
    found, count = math.nan, len(displacement)
    for i in range(count):
        after = i + 1 if i + 1 < count else 1
        here, there = sign * displacement[i], sign * displacement[after]
        if here < 0.0 and there >= 0.0:
            share = -here / (there - here)
            found = force[i] + share * (force[after] - force[i])
    return found


@compiled
def _branch_slope(displacement: Floats, force: Floats, sign: float, peak: float) -> float:
    """Least-squares slope of a loading branch between 50 and 90 % of its peak; NaN without."""
    count, last = 0, len(displacement) - 1
    mean_d, mean_f, low, high = 0.0, 0.0, math.inf, -math.inf
    for sums in range(2):
        square, product = 0.0, 0.0
        for i in range(last + 1):
            d = sign * displacement[i]
            ahead, behind = displacement[min(i + 1, last)], displacement[max(i - 1, 0)]
            loads = sign * (ahead - behind) > 0.0
            if not (loads and d >= FIT_FROM * peak and d <= FIT_TO * peak):
                continue
            if sums == 0:
                count += 1
                mean_d += d
                mean_f += sign * force[i]
                low, high = min(low, d), max(high, d)
            else:
                square += (d - mean_d) ** 2
                product += (d - mean_d) * (sign * force[i] - mean_f)
        if sums == 1:
            return product / square
        if count < 2 or high <= low:
            return math.nan
        mean_d, mean_f = mean_d / count, mean_f / count
    return math.nan


@compiled
def measure_loop(
    displacement: Floats,
    force: Floats,
    area: float,
    total_rubber_thickness: float,
    work: float,
    slope: bool,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """Return the measures of one closed cycle, in the order of `CycleMeasures`.

    `work` is the energy of the cycle [kN mm], or NaN to take it from the points. Without `slope`
    the post-yield stiffness is NaN.
    """
    d_max, d_min, f_max, f_min = -math.inf, math.inf, -math.inf, math.inf
    energy = 0.0
    for i in range(len(displacement)):
        d_max, d_min = max(d_max, displacement[i]), min(d_min, displacement[i])
        f_max, f_min = max(f_max, force[i]), min(f_min, force[i])
        if i > 0:
            mean = 0.5 * (force[i] + force[i - 1])
            energy += mean * (displacement[i] - displacement[i - 1])
    if not math.isnan(work):
        energy = work
    swing = abs(d_max) + abs(d_min)
    stiffness = (abs(f_max) + abs(f_min)) / swing
    triangle = 0.5 * stiffness * (0.5 * swing) ** 2
    up, down = _force_at_zero(displacement, force, 1.0), _force_at_zero(displacement, force, -1.0)
    post_yield = math.nan
    if slope:
        one = _branch_slope(displacement, force, 1.0, d_max)
        other = _branch_slope(displacement, force, -1.0, -d_min)
        post_yield = 0.5 * (one + other)
        if math.isnan(one):
            post_yield = other
        elif math.isnan(other):
            post_yield = one
    return (
        0.5 * (d_max - d_min),
        1e3 * stiffness * total_rubber_thickness / area,
        energy / (4.0 * math.pi * triangle) if triangle > 0.0 else math.nan,
        energy,
        stiffness,
        0.5 * (up - down),
        post_yield,
        f_max,
        f_min,
        d_max,
        d_min,
    )
