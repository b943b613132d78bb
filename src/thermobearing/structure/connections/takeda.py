"""A hinge that degrades (Takeda's rules on a bilinear backbone).

Elastic until yield, then along the backbone. Unloading has the stiffness
K_0 (theta_y/theta_max)^exponent; beyond zero moment the hinge heads for the farthest point it
reached on that side (the yield point before it yielded there). A partial unloading returns to
the point where it turned. Every rule is a straight line, and an increment of any size walks
along them exactly.
"""

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.choose import any_lane, no, select
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
def _unloading_stiffness(hinge: Hinge, farthest: float) -> float:
    """K_0 (theta_y/theta_max)^exponent [kN mm/rad], never softer than the secant: unloading
    further than the origin would leave the rules.
    """
    per = 1.0 / farthest
    degraded: float = hinge.initial * (hinge.yield_rotation * per) ** hinge.unloading
    return max(degraded, backbone(hinge, farthest) * per)


@compiled
def _along_line(
    where: bool, t: float, m: float, slope: float, end: float, to: float, to_moment: float
) -> tuple[float, float, float]:
    """Rotation, moment and slope on the straight way to a point, as far as `end`."""
    line_slope = (to_moment - m) / (to - t)
    stop = min(end, to)
    return (
        select(where, stop, t),
        select(where, m + line_slope * (stop - t), m),
        select(where, line_slope, slope),
    )


@compiled
def _write_side(
    side: Side,
    is_ahead: bool,
    ahead: tuple[float, float, float],
    back: tuple[float, float, float],
) -> None:
    """One direction's memory: that of the side ahead, or of the one left behind."""
    side.farthest = select(is_ahead, ahead[0], back[0])
    side.turned = select(is_ahead, ahead[1], back[1])
    side.turned_moment = select(is_ahead, ahead[2], back[2])


@compiled
def takeda(hinges: Rows[Hinge], old: HingeState, h: int, rotation: float, new: HingeState) -> float:
    """Moment of hinge h at a rotation [rad], written with the rest into `new`; its tangent.

    Negative motion is the mirror image of positive motion: `sign` turns the state over.
    """
    hinge = hinges[h]
    above, below = old.sides[h, ABOVE], old.sides[h, BELOW]
    current, moment = old.bends[h].rotation, old.bends[h].moment
    upward, at_rest = rotation > current, rotation == current
    # From here on the motion is positive: `farthest` and `turned` are ahead of it, `back_` ones
    # behind.
    sign = select(upward, 1.0, -1.0)
    t, m, end = sign * current, sign * moment, sign * rotation
    farthest = sign * select(upward, above.farthest, below.farthest)
    turned = sign * select(upward, above.turned, below.turned)
    turned_moment = sign * select(upward, above.turned_moment, below.turned_moment)
    back_farthest = select(upward, below.farthest, above.farthest)
    back_turned = select(upward, below.turned, above.turned)
    back_moment = select(upward, below.turned_moment, above.turned_moment)
    slope = hinge.initial
    unloads = (m < 0.0) & no(at_rest)  # from the other side
    if any_lane(unloads):
        # The hinge turns round here, unless it turned earlier and has not returned there yet.
        leaves = unloads & (abs(back_turned) == NEVER_TURNED)
        back_turned = select(leaves, current, back_turned)
        back_moment = select(leaves, moment, back_moment)
        slope = select(unloads, _unloading_stiffness(hinge, -sign * back_farthest), slope)
        zero = t - m / slope
        stays = end <= zero
        m = select(unloads, select(stays, m + slope * (end - t), 0.0), m)
        t = select(unloads, select(stays, end, zero), t)
    proceeds = (t < end) & no(at_rest)
    if any_lane(proceeds):
        back_turned = select(proceeds, -sign * NEVER_TURNED, back_turned)
        returns = proceeds & (abs(turned) < NEVER_TURNED) & (turned > t)  # to where it turned
        if any_lane(returns):
            t, m, slope = _along_line(returns, t, m, slope, end, turned, turned_moment)
        heads = proceeds & (t < end) & (t < farthest)  # towards the farthest point
        if any_lane(heads):
            peak = backbone(hinge, farthest)
            t, m, slope = _along_line(heads, t, m, slope, end, farthest, peak)
        yields = proceeds & (t < end)
        if any_lane(yields):
            slope = select(yields, hinge.hardening * hinge.initial, slope)
            m = select(yields, backbone(hinge, end), m)
            t = select(yields, end, t)
        # A point where it turned is forgotten once it is passed.
        forgets = proceeds & no((abs(turned) < NEVER_TURNED) & (t < turned))
        farthest = select(proceeds & (farthest < t), t, farthest)
        turned = select(forgets, NEVER_TURNED, turned)
    ahead = (sign * farthest, sign * turned, sign * turned_moment)
    _write_side(new.sides[h, ABOVE], upward, ahead, (back_farthest, back_turned, back_moment))
    _write_side(new.sides[h, BELOW], no(upward), ahead, (back_farthest, back_turned, back_moment))
    new.bends[h].rotation = rotation
    new.bends[h].moment = select(at_rest, moment, sign * m)
    return slope
