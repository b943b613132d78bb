"""Sketch of the default bridge: the model with its numbers, and the displacements of the table."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Rectangle

from thermobearing.results import drawing
from thermobearing.structure.model import load_structure

STEEL, CONCRETE, RUBBER, GROUND = "#334155", "#b6bcc6", "#f07f2e", "#8a7f70"
SMALL = 8.0
TOP, BEARING = 10.0, 0.7  # height of the pier top; of a bearing, drawn larger than it is [m]
AMBIENT = (23, -20)


def draw() -> Figure:
    """Draw pier P1 and what its displacements are, with the peaks of two temperatures."""
    figure = Figure(figsize=(9.4, 4.9))
    for (left, right), draw in (
        ((-7.0, 10.6), lambda ax: _draw_model(ax, load_structure("pier-p1"))),
        ((-4.4, 13.2), lambda ax: _draw_moved(ax, _peaks())),
    ):
        ax = figure.add_axes((0.5 * (left == -4.4), 0.0, 0.5, 1.0))
        draw(ax)
        ax.set(xlim=(left, right), ylim=(-4.3, 14.1))
        ax.set_aspect("equal")
        ax.axis("off")
    return figure


def _peaks() -> list[dict[str, float]]:
    """Return the displacements [mm] when the deck is farthest away, for each temperature."""
    import thermobearing as tb

    result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", ambient=list(AMBIENT))
    peaks = []
    for run in range(len(AMBIENT)):
        history = result.history(run)
        row = history.loc[history["deck_displacement_mm"].abs().idxmax()]
        sign = np.sign(row["deck_displacement_mm"])
        names = ("deck_displacement_mm", "displacement_mm", "pier_displacement_mm")
        deck, bearing, pier = (float(sign * row[name]) for name in names)
        peaks.append({"D": deck, "B": bearing, "P": pier, "F": deck - bearing - pier})
    return peaks


def _draw_model(ax: Axes, structure: Any) -> None:
    masses = {(m.body, m.height): m.mass * 1e3 for m in structure.masses}  # t from kN s2/mm
    hinge, (line,) = structure.hinges[0], structure.bearings
    sway, rocking = structure.springs
    _draw_bridge(ax, 0.0, 0.0, 0.0)
    ax.axhline(-2.0, color=GROUND, lw=0.8, ls=(0, (5, 3)), xmin=0.05, xmax=0.75)
    for (_, height), mass in masses.items():
        y = height / 1e3 + (BEARING + 0.5 if height >= 1e4 else 0.0)
        colour = "white" if height >= 1e4 else "#111827"  # on the deck
        ax.plot(0.0, y, "o", color=colour, ms=6, zorder=5)
        ax.text(
            -0.9,
            y,
            f"{mass:.0f} t",
            ha="right",
            va="center",
            color=colour,
            fontsize=SMALL,
            zorder=6,
        )
    ax.plot(0.0, 0.0, "o", mec="#c81e1e", mfc="white", mew=1.6, ms=9, zorder=6)
    per_m = 1e-3  # kN m from kN mm
    notes = (
        (4.4, TOP + BEARING + 0.45, ["deck"]),
        (
            1.3,
            TOP - 0.1,
            [
                f"{line.name}: one line of {line.count} bearings,",
                f"{line.equivalent_stiffness:.2f} kN/mm each, {TOP:.0f} m above the footing",
            ],
        ),
        (1.0, 5.6, ["pier, rigid above its hinge"]),
        (
            2.1,
            0.3,
            [
                f"plastic hinge: yields at {hinge.yield_moment * per_m:,.0f} kN m",
                f"and {hinge.yield_rotation * 1e3:.2f} mrad, 2 % damping",
            ],
        ),
        (2.1, -1.5, ["rigid footing"]),
        (
            1.7,
            -2.9,
            [
                f"ground springs: {sway.stiffness:,.0f} kN/mm sideways,",
                f"{rocking.rotational_stiffness * 1e-6:,.0f} MN m/rad rocking, 10 % damping",
            ],
        ),
    )
    for x, y, lines in notes:
        for k, text in enumerate(lines):
            ax.text(x, y - 0.75 * k, text, fontsize=SMALL, va="center", color="#111827")
    _draw_spring(ax, -5.6, -1.9, -2.0)
    ax.add_patch(Arc((0.0, -2.0), 2.6, 1.6, theta1=200, theta2=340, color=GROUND, lw=1.6))
    ax.annotate("", (-6.7, -3.2), (-3.9, -3.2), arrowprops={"arrowstyle": "<->", "color": GROUND})
    ax.text(-5.3, -3.95, "ground motion", ha="center", fontsize=SMALL, color=GROUND)


def _draw_moved(ax: Axes, peaks: list[dict[str, float]]) -> None:
    foot, hinge, bearing = 2.6, 1.3, 3.0
    _draw_bridge(ax, 0.0, 0.0, 0.0, alpha=0.25)
    _draw_bridge(ax, foot, hinge, bearing)
    stations = np.cumsum([0.0, foot, hinge, bearing])
    names = ("$u_F$ foundation", "$u_P$ pier", "$u_B$ bearing")
    levels = (12.55, 12.55, 12.55)
    for x in stations:
        ax.plot([x, x], [TOP + 0.1, 13.75], color="#6b7280", lw=0.6, ls=":")
    for k, name in enumerate(names):
        _measure(ax, stations[k], stations[k + 1], levels[k], name.split()[0])
    _measure(ax, stations[0], stations[-1], 13.5, "$u_D$")
    rows = (
        ("$u_D$", "deck to ground", "D"),
        ("$u_B$", "shear of bearing", "B"),
        ("$u_P$", "hinge rotation × 10 m", "P"),
        ("$u_F$", "footing: sway, rocking", "F"),
    )
    x, y = 4.7, 6.4
    ax.text(x, y + 1.9, "HDR bearings in jra-ii-i-1, when the deck", fontsize=SMALL)
    ax.text(x, y + 1.2, "is farthest from where it began [mm]:", fontsize=SMALL)
    for k, colour in enumerate(drawing.ambient_colours(np.array(AMBIENT, dtype=float))):
        position = x + 6.7 + 1.7 * k
        ax.text(position, y, f"{AMBIENT[k]} °C", ha="right", fontsize=SMALL, color=colour)
        for i, (_, _, key) in enumerate(rows):
            text = f"{peaks[k][key]:.0f}"
            ax.text(position, y - 0.9 * (i + 1), text, ha="right", fontsize=SMALL, color=colour)
    for i, (symbol, words, _) in enumerate(rows):
        ax.text(x, y - 0.9 * (i + 1), symbol, fontsize=SMALL)
        ax.text(x + 0.9, y - 0.9 * (i + 1), words, fontsize=SMALL - 1.0)
    ax.text(x, y - 5.2, "$u_D = u_F + u_P + u_B$", fontsize=SMALL + 1)


def _draw_bridge(ax: Axes, foot: float, hinge: float, bearing: float, alpha: float = 1.0) -> None:
    """Draw deck, bearing, pier and footing; displacements are those at the pier top."""
    turn = foot / (TOP + 2.0)  # the footing rocks about its lower face
    base, top = 2.0 * turn, foot + hinge
    look = {"alpha": alpha, "lw": 0, "zorder": 2}
    feet = np.array([[-1.7, -2.0], [1.7, -2.0], [1.7, 0.0], [-1.7, 0.0]])
    shift = np.column_stack([turn * (feet[:, 1] + 2.0), -turn * feet[:, 0]])
    ax.fill(*(feet + shift).T, color=CONCRETE, **look)
    pier = np.array([[base - 0.45, 0.0], [base + 0.45, 0.0], [top + 0.45, TOP], [top - 0.45, TOP]])
    ax.fill(*pier.T, color=CONCRETE, **look)
    low, high = TOP, TOP + BEARING
    block = [[top - 0.8, low], [top + 0.8, low], [top + bearing + 0.8, high]]
    ax.fill(*np.array([*block, [top + bearing - 0.8, high]]).T, color=RUBBER, **look)
    deck = (top + bearing - 4.0, high)
    ax.add_patch(Rectangle(deck, 8.0, 0.9, color=STEEL, **look))
    if foot:
        ax.plot(base, 0.0, "o", mec="#c81e1e", mfc="white", mew=1.6, ms=9, zorder=6)


def _draw_spring(ax: Axes, left: float, right: float, y: float) -> None:
    x = np.linspace(left, right, 13)
    zigzag = np.array([0.0, 0.0, *([0.3, -0.3] * 4), 0.3, 0.0, 0.0])
    ax.plot(x, y + 0.4 + zigzag, color=GROUND, lw=1.4)
    ax.plot([left, left], [y - 0.1, y + 0.9], color=GROUND, lw=2.5)


def _measure(ax: Axes, left: float, right: float, y: float, name: str) -> None:
    arrow = {"arrowstyle": "<->", "shrinkA": 0, "shrinkB": 0, "lw": 0.9}
    ax.annotate("", (left, y), (right, y), arrowprops=arrow)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
    ax.text(0.5 * (left + right), y + 0.05, name, ha="center", va="center", fontsize=9, bbox=box)
