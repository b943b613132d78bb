"""Figure: the rules of the degrading hinge."""

import numpy as np
from matplotlib.figure import Figure

from thermobearing.core.records import filled
from thermobearing.results import drawing
from thermobearing.structure.connections.takeda import straight_hinges, takeda
from thermobearing.structure.model import load_structure
from thermobearing.structure.types import Hinge

PATH = [1.0, 4.0, 2.8, 4.0, 5.0, 0.0, -3.0, 0.5, 3.0, 1.5, 5.0]  # rotations over yield
RULES = (  # text, leg of the path, place along it, offset of the text
    ("1 elastic", 0, 0.75, (-60, 4)),
    ("2 backbone", 1, 0.55, (-20, -18)),
    ("3 unloads softer,\n   comes back", 2, 0.8, (52, -34)),
    (
        "4 beyond zero: towards the\n   farthest point (yield point\n   before it yielded there)",
        5,
        0.9,
        (8, -42),
    ),
    ("5 backbone on\n   the other side", 6, 0.75, (-10, 16)),
    ("6 reloads towards the\n   farthest point above", 8, 0.2, (-100, -80)),
)
COUNT = 200  # points of a leg


def draw() -> Figure:
    """The hinge of pier P1 along a path that meets every rule."""
    hinge = load_structure("pier-p1").hinges[0]
    y = hinge.yield_rotation
    constants = filled(
        Hinge,
        initial=hinge.stiffness,
        yield_rotation=y,
        hardening=hinge.hardening_ratio,
        unloading=hinge.unloading_exponent,
    )
    state, new = straight_hinges(constants), straight_hinges(constants)
    figure, (ax,) = drawing.panels(1, 1, (7.0, 4.8), "Hinge of pier P1: stiffness-degrading rules")
    rotation_reached, legs = 0.0, []
    for end in PATH:
        leg = [(rotation_reached, state.bends[0].moment / hinge.yield_moment)]
        for rotation in np.linspace(rotation_reached, end, COUNT)[1:]:
            takeda(constants, state, 0, float(rotation * y), new)
            state, new = new, state
            leg.append((float(rotation), state.bends[0].moment / hinge.yield_moment))
        rotation_reached = end
        legs.append(np.array(leg))
    for leg, colour in zip(legs, drawing.ordered_colours(len(legs), "viridis"), strict=True):
        ax.plot(*leg.T, color=colour, linewidth=1.6)
    for text, number, place, offset in RULES:
        at = legs[number][int(place * (COUNT - 1))]
        arrow: drawing.Look = {"arrowstyle": "-", "color": drawing.GREY, "linewidth": 0.6}
        style: drawing.Look = {"fontsize": drawing.SMALL, "arrowprops": arrow}
        ax.annotate(text, at, offset, textcoords="offset points", **style)
    drawing.name_axes(ax, "rotation / yield rotation", "moment / yield moment")
    return figure
