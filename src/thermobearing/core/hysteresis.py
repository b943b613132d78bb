"""The hysteretic variable Z of one rubber layer (Eq. 4.35-4.37) and its tangent.

    dZ = dd - beta |dd Z| Z - gamma dd Z^2,   beta = 1/((1+s) d_y^2),   gamma = s beta

With sigma the sign of the motion, u = sigma Z and e = |dd| this is the autonomous equation

    du/de = 1 - u^2/d_y^2          for u >= 0   (loading: tanh)
    du/de = 1 + c u^2              for u <  0   (unloading), c = (1-s)/((1+s) d_y^2)

where c > 0 (s < 1) gives a tangent, c = 0 a straight line, c < 0 (s > 1) a tanh. Both are
solved in closed form, so an increment of any size is exact while the motion keeps its sign.
"""

import math

from thermobearing.core.compile import compiled
from thermobearing.core.lanes.choose import any_lane, select


@compiled
def unload(u: float, e: float, curvature: float) -> tuple[float, float]:
    """Move u < 0 towards zero over a path e; returns (u, path left over once u is zero).

    The curvature of runs in lockstep has one sign.
    """
    if any_lane(curvature > 0.0):
        k = math.sqrt(curvature)
        t = math.tan(k * e)
        arrives = (t >= -k * u) | (k * e >= 0.5 * math.pi)
        nearer = (u + t / k) / (1.0 - k * u * t)
        left = e
        if any_lane(arrives):
            reach = math.atan(-k * u) / k
            left = e - reach
        return select(arrives, 0.0, nearer), select(arrives, left, 0.0)
    if any_lane(curvature < 0.0):
        k = math.sqrt(-curvature)
        t = math.tanh(k * e)
        arrives = t >= -k * u
        nearer = (u + t / k) / (1.0 + k * u * t)
        left = e
        if any_lane(arrives):
            reach = math.atanh(-k * u) / k
            left = e - reach
        return select(arrives, 0.0, nearer), select(arrives, left, 0.0)
    arrives = e >= -u
    return select(arrives, 0.0, u + e), select(arrives, e + u, 0.0)


@compiled
def hysteretic_slope(u: float, d_y: float, curvature: float) -> float:
    """dZ/dd at u = sigma Z: the right side of the equations in the module's head."""
    loads = u >= 0.0
    unloading = 1.0 + curvature * u * u
    if not any_lane(loads):
        return unloading
    return select(loads, 1.0 - (u / d_y) * (u / d_y), unloading)


@compiled
def exact_increment(
    z: float, increment: float, d_y: float, curvature: float
) -> tuple[float, float]:
    """Z and dZ/dd after a monotone displacement increment, in closed form.

    `z`, `increment` and `d_y` are in mm, `curvature` in 1/mm2. With a zero increment the
    tangent is that of motion in the positive direction.
    """
    sigma = select(increment >= 0.0, 1.0, -1.0)
    per_d_y = 1.0 / d_y
    u = sigma * z
    e = abs(increment)
    unloads = u < 0.0
    if any_lane(unloads):
        nearer, left = unload(u, e, curvature)
        u, e = select(unloads, nearer, u), select(unloads, left, e)
    loads = u >= 0.0
    if any_lane(loads):
        t = math.tanh(e * per_d_y)
        u = select(loads, (u + d_y * t) / (1.0 + u * t * per_d_y), u)
    return sigma * u, hysteretic_slope(u, d_y, curvature)


@compiled
def euler_increment(
    z: float, increment: float, d_y: float, curvature: float
) -> tuple[float, float]:
    """The published explicit Euler step: the slope at the start, over the whole increment."""
    u = select(increment >= 0.0, z, -z)
    slope = hysteretic_slope(u, d_y, curvature)
    return z + slope * increment, slope
