"""A hinge that degrades (Takeda's rules on a bilinear backbone).

Elastic until yield, then along the backbone. Unloading has the stiffness
K_0 (theta_y/theta_max)^exponent; beyond zero moment the hinge heads for the farthest point it
reached on that side (the yield point before it yielded there). A partial unloading returns to
the point where it turned. Every rule is a straight line, and an increment of any size walks
along them exactly.
"""

from thermobearing.core.compile import compiled
from thermobearing.core.types import Floats
from thermobearing.structure.types import (
    HARDENING,
    HIGHEST,
    HINGE_STATE,
    INITIAL,
    LOWEST,
    MOMENT,
    ROTATION,
    TURNED_HIGH,
    TURNED_HIGH_MOMENT,
    TURNED_LOW,
    TURNED_LOW_MOMENT,
    UNLOADING,
    YIELD,
)

NEVER_TURNED = 1e30


@compiled
def backbone(hinges: Floats, h: int, rotation: float) -> float:
    """Moment on the backbone at a positive rotation [kN mm]."""
    first = hinges[h, INITIAL] * min(rotation, hinges[h, YIELD])
    beyond = max(rotation - hinges[h, YIELD], 0.0)
    moment: float = first + hinges[h, HARDENING] * hinges[h, INITIAL] * beyond
    return moment


@compiled
def unloading_stiffness(hinges: Floats, h: int, farthest: float) -> float:
    """K_0 (theta_y/theta_max)^exponent [kN mm/rad], never softer than the secant: unloading
    further than the origin would leave the rules.
    """
    ratio = hinges[h, YIELD] / farthest
    degraded: float = hinges[h, INITIAL] * ratio ** hinges[h, UNLOADING]
    return max(degraded, backbone(hinges, h, farthest) / farthest)


@compiled
def takeda(hinges: Floats, old: Floats, h: int, rotation: float, new: Floats) -> float:
    """Moment of hinge h at a rotation [rad], written with the rest into `new`; its tangent.

    Negative motion is the mirror image of positive motion: `sign` turns the state over.
    """
    for k in range(HINGE_STATE):
        new[h, k] = old[h, k]
    here: float = old[h, ROTATION]
    moment: float = old[h, MOMENT]
    if rotation == here:
        return unloading_stiffness(hinges, h, hinges[h, YIELD])
    sign = 1.0 if rotation > here else -1.0
    ahead, ahead_turned, ahead_moment = HIGHEST, TURNED_HIGH, TURNED_HIGH_MOMENT
    back, back_turned, back_moment = LOWEST, TURNED_LOW, TURNED_LOW_MOMENT
    if sign < 0.0:
        ahead, ahead_turned, ahead_moment = LOWEST, TURNED_LOW, TURNED_LOW_MOMENT
        back, back_turned, back_moment = HIGHEST, TURNED_HIGH, TURNED_HIGH_MOMENT
    t, m, end = sign * here, sign * moment, sign * rotation
    farthest = sign * old[h, ahead]
    slope = 0.0
    if m < 0.0:  # unloading from the other side
        if abs(old[h, back_turned]) == NEVER_TURNED:
            new[h, back_turned] = here
            new[h, back_moment] = moment
        slope = unloading_stiffness(hinges, h, -sign * old[h, back])
        zero = t - m / slope
        if end <= zero:
            m += slope * (end - t)
            t = end
        else:
            t, m = zero, 0.0
    if t < end:
        new[h, back_turned] = -sign * NEVER_TURNED
        turned = sign * old[h, ahead_turned]
        if abs(turned) < NEVER_TURNED and turned > t:  # back to where it turned
            slope = (sign * old[h, ahead_moment] - m) / (turned - t)
            stop = min(end, turned)
            m += slope * (stop - t)
            t = stop
        if t < end and t < farthest:  # towards the farthest point
            slope = (backbone(hinges, h, farthest) - m) / (farthest - t)
            stop = min(end, farthest)
            m += slope * (stop - t)
            t = stop
        if t < end:
            slope = hinges[h, HARDENING] * hinges[h, INITIAL]
            m = backbone(hinges, h, end)
            t = end
        if sign * new[h, ahead] < t:
            new[h, ahead] = sign * t
        if not abs(turned) < NEVER_TURNED or t >= turned:
            new[h, ahead_turned] = sign * NEVER_TURNED
    new[h, ROTATION] = rotation
    new[h, MOMENT] = sign * m
    return slope
