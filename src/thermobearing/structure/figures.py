"""A structure drawn: bodies, masses, springs, hinges and bearings; its mode shapes.

Heights are those of the model; side by side stand the bodies that carry others, in a column for
each, wherever the bridge has them.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from thermobearing.core.records import Floats
from thermobearing.results import drawing
from thermobearing.structure.matrices import displacement_row, mean_height
from thermobearing.structure.model import GROUND, Structure
from thermobearing.structure.result import TONNES, StructureResult

M = 1e-3  # m per mm
MOST_MODES = 6
PIER, DECK, SPRING, BEARING, HINGE = "#6b7280", "#374151", "#0077BB", "#EE7733", "#CC3311"
TEETH = 5  # of a spring


class Layout(NamedTuple):
    """Places of bodies: columns of supports, ends, decks on bearings [m]."""

    columns: dict[str, float]
    ends: dict[str, tuple[float, float]]
    decks: tuple[str, ...]
    spacing: float
    scaled: bool  # heights are those of the model

    def x(self, name: str) -> float:
        """Return the place of a body, or of the ground, along the bridge."""
        return self.columns.get(name, -0.5 * self.spacing)


def lay_out(structure: Structure) -> Layout:
    """Return columns for the bodies that do not lie on bearings, decks over all of them."""
    decks = tuple(dict.fromkeys(line.body for line in structure.bearings))
    roots: dict[str, list[str]] = {}
    for body in structure.bodies:
        if body.name not in decks:
            root = body.name
            while structure.body(root).on not in (None, GROUND):
                root = structure.body(root).on or root
            roots.setdefault(root, []).append(body.name)
    ends = {body.name: _ends(structure, body.name) for body in structure.bodies}
    heights = [height for pair in ends.values() for height in pair]
    scaled = np.ptp(heights) > 0.0
    if not scaled:  # without heights one above the other
        names = [body.name for body in structure.bodies]
        ends = {name: (0.0, 1.0) for name in names if name not in decks}
        ends |= {name: (1.0, 1.0) for name in decks}
        heights = [0.0, 1.0]
    spacing = 0.8 * max(float(np.ptp(heights)), 1e-6)
    lift = 0.07 * spacing  # room for the bearings under a deck
    ends |= {name: (high + lift, high + lift) for name, (_, high) in ends.items() if name in decks}
    columns = {name: spacing * k for k, group in enumerate(roots.values()) for name in group}
    middle = spacing * 0.5 * max(len(roots) - 1, 0)
    columns |= dict.fromkeys(decks, middle)
    return Layout(columns, ends, decks, spacing, bool(scaled))


def _ends(structure: Structure, name: str) -> tuple[float, float]:
    heights = [mass.height for mass in structure.masses if mass.body == name]
    heights += [line.height for line in structure.bearings if name in (line.body, line.base)]
    heights += [
        spring.height
        for spring in structure.springs
        if name == spring.body and (spring.stiffness is not None)
    ]
    heights += [body.base_height for body in structure.bodies if body.on == name]
    body = structure.body(name)
    on_bearings = any(line.body == name for line in structure.bearings)
    heights += [] if on_bearings else [body.base_height]
    if structure.report.pier == name:
        heights.append(structure.report.pier_top)
    return M * min(heights, default=0.0), M * max(heights, default=0.0)


class StructureFigures(drawing.Figures):
    """Figures of a structure: `result.plot.model()`, `.modes()`."""

    def __init__(self, result: StructureResult) -> None:
        super().__init__(result)
        self._structure = result.structure
        self._layout = lay_out(result.structure)

    def model(self) -> Figure:
        """Return bodies, masses, springs, hinges and bearings with their sizes."""
        layout, structure = self._layout, self._structure
        wide = max(6.5, 3.0 + 2.6 * len(set(layout.columns.values())))
        figure, (ax,) = drawing.panels(1, 1, (wide, 5.6), f"{structure.name}: the model")
        ax.grid(False, axis="x")
        for body in structure.bodies:
            self._body(ax, body.name)
        for spring in structure.springs:
            self._spring(ax, spring)
        for hinge in structure.hinges:
            at = M * structure.body(hinge.body).base_height
            x = layout.x(hinge.body)
            ax.plot([x], [at], "o", color="white", markeredgecolor=HINGE, markersize=9, zorder=6)
            moment = hinge.yield_moment / 1e3
            _say(ax, x, at, f"{hinge.name}: {moment:g} kN m, {1e3 * hinge.yield_rotation:g} mrad")
        for k, line in enumerate(structure.bearings):
            self._bearings(ax, line, k)
        for mass in structure.masses:
            x, y = layout.x(mass.body), M * mass.height
            y = y if layout.scaled else layout.ends[mass.body][1]
            y = float(np.clip(y, *layout.ends[mass.body]))
            ax.plot([x], [y], "o", color=drawing.INK, markersize=7, zorder=7)
            deck = mass.body in layout.decks
            up = -13.0 if deck else 0.0
            _say(ax, x, y, f"{TONNES * mass.mass:g} t", up, ha="right")
        low = min(low for low, _ in layout.ends.values())
        ax.axhline(low, color=drawing.GREY, linewidth=0.8, linestyle=(0, (6, 3)), zorder=0)
        ax.set_xticks([])
        right = max(layout.columns.values())
        ax.set_xlim(-1.0 * layout.spacing, right + 1.3 * layout.spacing)
        ax.margins(y=0.12)
        drawing.name_axes(ax, "", self._height())
        drawing.legend_below(figure, self._handles())
        return figure

    def modes(self) -> Figure:
        """Return the first six mode shapes; bearings with their equivalent stiffness."""
        table, layout = self._result.table, self._layout
        shapes = self._result.prepared.modes.shapes
        count = min(len(table), MOST_MODES)
        columns = min(count, 3)
        rows = -(-count // columns)
        size = (3.2 * columns + 0.6, 3.0 * rows + 0.9)
        title = f"{self._structure.name}: mode shapes"
        figure, axes = drawing.panels(rows, columns, size, title, share=True)
        for k, ax in enumerate(axes):
            ax.set_xticks([])
            if k >= count:
                ax.set_visible(False)
                continue
            moved = {name: self._moved(name, shapes[:, k]) for name in layout.ends}
            largest = max(float(np.abs(values).max()) for values in moved.values())
            factor = 0.4 * layout.spacing / max(largest, 1e-30)
            for name, values in moved.items():
                self._shape(ax, name, np.zeros(2), {"color": "#c8ccd2", "linewidth": 3.0})
                look: dict[str, Any] = {"color": "#CC3311", "linewidth": 1.8}
                self._shape(ax, name, factor * values, look)
            row = table.iloc[k]
            told = f"{row['period_s']:.3f} s, damping {row['damping_ratio']:.1%}, "
            told += f"mass {row['effective_mass']:.0%}"
            drawing.name_axes(ax, "", self._height() if k % columns == 0 else "", told)
            ax.title.set_fontsize(drawing.SMALL)
        return figure

    def _height(self) -> str:
        return "height [m]" if self._layout.scaled else "no heights given: not to scale"

    def _moved(self, name: str, shape: Floats) -> Floats:
        """Return the sideways motion of the ends of a body in a mode."""
        structure, (low, high) = self._structure, self._layout.ends[name]
        if name in self._layout.decks:
            at = mean_height(structure, name)
            return np.full(2, displacement_row(structure, name, at) @ shape)
        ends = [displacement_row(structure, name, end / M) @ shape for end in (low, high)]
        return np.array(ends)

    def _shape(self, ax: Axes, name: str, moved: Floats, look: dict[str, Any]) -> None:
        layout, (low, high) = self._layout, self._layout.ends[name]
        if name in layout.decks:
            left, right = self._span(name)
            ax.plot(np.array([left, right]) + moved[0], [high, high], **look)
        else:
            x = layout.x(name)
            ax.plot(x + moved, [low, high], marker="o", markersize=2.5, **look)

    def _span(self, name: str) -> tuple[float, float]:
        layout = self._layout
        under = [layout.x(line.base) for line in self._structure.bearings if line.body == name]
        return min(under) - 0.35 * layout.spacing, max(under) + 0.35 * layout.spacing

    def _body(self, ax: Axes, name: str) -> None:
        """Draw a deck across, anything else upright."""
        layout, (low, high) = self._layout, self._layout.ends[name]
        if name in layout.decks:
            left, right = self._span(name)
            ax.plot([left, right], [high, high], color=DECK, linewidth=7, solid_capstyle="butt")
            _say(ax, right, high, name)
            return
        x = layout.x(name)
        if low == high:
            half = 0.15 * layout.spacing
            ax.plot([x - half, x + half], [low] * 2, color=PIER, linewidth=6)
        else:
            look: dict[str, Any] = {"color": PIER, "alpha": 0.45, "zorder": 1}
            look["linewidth"] = 12.5 if self._structure.body(name).moves else 10.0
            ax.plot([x, x], [low, high], solid_capstyle="butt", **look)
        _say(ax, x - 0.22 * layout.spacing, 0.5 * (low + high), name, ha="right", fontweight="bold")

    def _spring(self, ax: Axes, spring: Any) -> None:
        """Draw teeth towards its base, or an open ring against rotation."""
        layout = self._layout
        x, low = layout.x(spring.body), layout.ends[spring.body][0]
        y = max(M * spring.height, low)
        if spring.stiffness is None:
            ax.plot([x], [low], "o", color="none", markeredgecolor=SPRING, markersize=15, zorder=5)
            size = f"{spring.rotational_stiffness / 1e3:g} kN m/rad"
            _say(ax, x, low, f"{spring.name}: {size}", up=-14)
            return
        far = x - 0.45 * layout.spacing if spring.base == GROUND else layout.x(spring.base)
        across = np.linspace(far, x, 2 * TEETH + 2)
        teeth = np.where(np.arange(2 * TEETH + 2) % 2, 1.0, -1.0) * 0.02 * layout.spacing
        teeth[[0, -1]] = 0.0
        ax.plot(across, y + teeth, color=SPRING, linewidth=1.3, zorder=4)
        ax.plot([far, far], [y - 0.04 * layout.spacing, y + 0.04 * layout.spacing], color=SPRING)
        _say(ax, x, y, f"{spring.name}: {spring.stiffness:g} kN/mm", up=-26)

    def _bearings(self, ax: Axes, line: Any, number: int) -> None:
        """Draw a box between the two bodies of a line."""
        layout = self._layout
        x = layout.x(line.base)
        y = M * line.height if line.base == GROUND else layout.ends[line.base][1]
        top = layout.ends[line.body][1]
        height = max(top - y, 0.03 * layout.spacing)
        wide = 0.16 * layout.spacing
        box = Rectangle((x - 0.5 * wide, y), wide, height, color=BEARING, zorder=5)
        ax.add_patch(box)
        told = f"{line.name}: {line.count} x {line.equivalent_stiffness:.4g} kN/mm"
        _say(ax, x, top, told, up=14 + 11 * (number % 2))

    def _handles(self) -> list[Line2D]:
        none: dict[str, Any] = {"linestyle": "none"}
        found = [Line2D([], [], color=drawing.INK, marker="o", label="mass", **none)]
        found.append(Line2D([], [], color=BEARING, marker="s", label="bearings", **none))
        if self._structure.springs:
            found.append(Line2D([], [], color=SPRING, label="spring"))
        if self._structure.hinges:
            ring: dict[str, Any] = {"color": "white", "markeredgecolor": HINGE}
            found.append(Line2D([], [], marker="o", label="hinge", **ring, **none))
        return found

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {"model": self.model, "modes": self.modes}


def _say(ax: Axes, x: float, y: float, text: str, up: float = 0.0, **look: Any) -> None:
    """Write words at the right of a point, or at the left of it with ha = "right"."""
    usual: drawing.Look = {"va": "center", "ha": "left", "fontsize": drawing.SMALL, "zorder": 8}
    look = usual | look
    at = (-12.0 if look["ha"] == "right" else 12.0, up)
    ax.annotate(text, (x, y), at, textcoords="offset points", **look)
