"""A hinge that degrades (Takeda's rules on a bilinear backbone).

Elastic until yield, then along the backbone. Unloading has the stiffness
K_0 (theta_y/theta_max)^exponent; beyond zero moment the hinge heads for the farthest point it
reached on that side (the yield point before it yielded there). A partial unloading returns to
the point where it turned. Every rule is a straight line, and an increment of any size walks
along them exactly.
"""

from thermobearing.core.compile import compiled
from thermobearing.core.records import Rows, rows
from thermobearing.structure.types import ABOVE, BELOW, Bend, Hinge, HingeState, Side

NEVER_TURNED = 1e30


def straight_hinges(hinges: Rows[Hinge]) -> HingeState:
    """Hinges that were never bent."""
    state = HingeState(rows(Bend, len(hinges)), rows(Side, len(hinges), 2))
    for h in range(len(hinges)):
        for side, sign in ((ABOVE, 1.0), (BELOW, -1.0)):
            state.sides[h, side].farthest = sign * hinges[h].yield_rotation
            state.sides[h, side].turned = sign * NEVER_TURNED
    return state


@compiled
def backbone(hinge: Hinge, rotation: float) -> float:
    """Moment on the backbone at a positive rotation [kN mm]."""
    first = hinge.initial * min(rotation, hinge.yield_rotation)
    beyond = max(rotation - hinge.yield_rotation, 0.0)
    return first + hinge.hardening * hinge.initial * beyond


@compiled
def unloading_stiffness(hinge: Hinge, farthest: float) -> float:
    """K_0 (theta_y/theta_max)^exponent [kN mm/rad], never softer than the secant: unloading
    further than the origin would leave the rules.
    """
    ratio = hinge.yield_rotation / farthest
    degraded: float = hinge.initial * ratio**hinge.unloading
    return max(degraded, backbone(hinge, farthest) / farthest)


@compiled
def takeda(hinges: Rows[Hinge], old: HingeState, h: int, rotation: float, new: HingeState) -> float:
    """Moment of hinge h at a rotation [rad], written with the rest into `new`; its tangent.

    Negative motion is the mirror image of positive motion: `sign` turns the state over.
    """
    hinge = hinges[h]
    new.sides[h, ABOVE] = old.sides[h, ABOVE]
    new.sides[h, BELOW] = old.sides[h, BELOW]
    new.bends[h] = old.bends[h]
    here = old.bends[h].rotation
    moment = old.bends[h].moment
    if rotation == here:
        return unloading_stiffness(hinge, hinge.yield_rotation)
    sign, ahead, back = (1.0, ABOVE, BELOW) if rotation > here else (-1.0, BELOW, ABOVE)
    t, m, end = sign * here, sign * moment, sign * rotation
    farthest = sign * old.sides[h, ahead].farthest
    slope = 0.0
    if m < 0.0:  # unloading from the other side
        if abs(old.sides[h, back].turned) == NEVER_TURNED:
            new.sides[h, back].turned = here
            new.sides[h, back].turned_moment = moment
        slope = unloading_stiffness(hinge, -sign * old.sides[h, back].farthest)
        zero = t - m / slope
        if end <= zero:
            m += slope * (end - t)
            t = end
        else:
            t, m = zero, 0.0
    if t < end:
        new.sides[h, back].turned = -sign * NEVER_TURNED
        turned = sign * old.sides[h, ahead].turned
        if abs(turned) < NEVER_TURNED and turned > t:  # back to where it turned
            slope = (sign * old.sides[h, ahead].turned_moment - m) / (turned - t)
            stop = min(end, turned)
            m += slope * (stop - t)
            t = stop
        if t < end and t < farthest:  # towards the farthest point
            slope = (backbone(hinge, farthest) - m) / (farthest - t)
            stop = min(end, farthest)
            m += slope * (stop - t)
            t = stop
        if t < end:
            slope = hinge.hardening * hinge.initial
            m = backbone(hinge, end)
            t = end
        if sign * new.sides[h, ahead].farthest < t:
            new.sides[h, ahead].farthest = sign * t
        if not abs(turned) < NEVER_TURNED or t >= turned:
            new.sides[h, ahead].turned = sign * NEVER_TURNED
    new.bends[h].rotation = rotation
    new.bends[h].moment = sign * m
    return slope
