"""Fig. 6.3: bilinear model of the HDR bearing that the bridge was designed with."""

import numpy as np
from matplotlib.figure import Figure

from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.design.case import STIFFNESS_RATIO
from thermobearing.design.result import source_design
from thermobearing.design.rubber import (
    bilinear_of,
    damping_ratio,
    equivalent_stiffness,
    load_rubber,
)
from thermobearing.reproduce.figures.words import BILINEAR
from thermobearing.reproduce.runs import Runs
from thermobearing.results import drawing

CAPTION = (
    "Fig. 6.3: bilinear model of the HDR bearing in the design. Run: nothing; K_1, K_2 and Q_d of "
    "Table 6.3, and those that follow from K_B and h_B of rubber G8 (Eq. 6.1 to 6.3, Tables A.1 "
    "and A.2) at the design displacement. Drawn: force against displacement of both, and the "
    "equivalent stiffness."
)


def draw(_runs: Runs) -> Figure:
    """As the caption says."""
    design = source_design()["bearing"]
    end, printed, rubber = design["u_B_mm"], load_bilinear(BILINEAR), load_rubber("G8")
    thickness = printed.total_rubber_thickness
    k_b = equivalent_stiffness(rubber, design["side_mm"] ** 2, thickness, end)
    made = bilinear_of(k_b, damping_ratio(rubber, end / thickness), end, STIFFNESS_RATIO)
    figure, (ax,) = drawing.panels(1, 1, (6.0, 4.2), "bilinear model of the design")
    for name, colour, numbers in (
        (
            "Table 6.3",
            "#0072B2",
            (printed.strength, printed.initial_stiffness, printed.post_yield_stiffness),
        ),
        ("from K_B and h_B", "#D55E00", (made.strength, made.initial, made.post_yield)),
    ):
        q, k1, k2 = numbers
        told = f"{name}: Q_d {q:.1f} kN, K_1 {k1:.2f}, K_2 {k2:.2f} kN/mm"
        ax.plot(*loop(q, k1, k2, end), color=colour, linewidth=1.3, label=told)
    told = f"K_B = {k_b:.3f} kN/mm at {end:g} mm"
    look: drawing.Look = {"color": drawing.GREY, "linestyle": "--", "linewidth": 1.0}
    ax.plot([-end, end], [-k_b * end, k_b * end], label=told, **look)
    drawing.name_axes(ax, "displacement [mm]", "force [kN]")
    ax.legend(fontsize=drawing.SMALL, frameon=False, loc="upper left")
    return figure


def loop(strength: float, first: float, second: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a bilinear loop to both sides [mm, kN]."""
    top = strength + second * end
    turned = end - 2.0 * strength / (first - second)  # elastic way back: 2 u_y
    x = np.array([end, turned, -end, -turned, end])
    y = np.array([top, top - first * (end - turned), -top, first * (end - turned) - top, top])
    return x, y
