"""A structure drawn: bodies, masses, springs, hinges and bearings; its mode shapes.

Heights are those of the model. Supports stand side by side in the order of the bearing lines, at
equal distances; lines on the ground stand on an abutment of their own.
"""

import textwrap
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox

from thermobearing.core.records import Floats
from thermobearing.results import drawing
from thermobearing.structure.matrices import displacement_row, mean_height
from thermobearing.structure.model import GROUND, Structure
from thermobearing.structure.result import StructureResult

M = 1e-3  # m per mm
MOST_MODES = 6
PIER, DECK, SPRING, BEARING, HINGE = "#6b7280", "#374151", "#0077BB", "#EE7733", "#CC3311"
TEETH = 5  # of a spring
SEAT = 0.26  # distance of two lines on one pier, of the spacing of piers
OVERHANG = 0.09  # of a deck beyond its last line, likewise
NAME = 0.09  # distance of the name of a body, likewise
NAME_WIDTH = 14  # letters of a line of the name of a bearing line
ABOVE_DECK = 8.0  # height of these names above the top of a line [pt]
LEGEND = 105  # letters of a line of the legend
TEXT: drawing.Look = {
    "textcoords": "offset points",
    "fontsize": drawing.SMALL,
    "zorder": 8,
    "color": drawing.INK,
}
ON_DECK: drawing.Look = {"color": "white", "fontsize": drawing.SMALL - 1.0}
NONE: drawing.Look = {"linestyle": "none"}
HANDLES: dict[str, drawing.Look] = {
    "mass": {"color": drawing.INK, "marker": "o"} | NONE,
    "bearings": {"color": BEARING, "marker": "s"} | NONE,
    "spring": {"color": SPRING},
    "hinge": {"color": "white", "markeredgecolor": HINGE, "marker": "o"} | NONE,
}


class _Layout(NamedTuple):
    """Places of bodies and bearing lines, and ends of bodies [m]."""

    columns: dict[str, float]  # of bodies
    seats: dict[str, float]  # of bearing lines
    ends: dict[str, tuple[float, float]]
    decks: tuple[str, ...]
    spacing: float
    scaled: bool  # heights are those of the model


def _root(structure: Structure, name: str) -> str:
    """Return the body on which others stand that stands on none."""
    while (below := structure.body(name).on) not in (None, GROUND):
        name = str(below)
    return name


def _lay_out(structure: Structure) -> _Layout:
    """Return a place for each support, decks over their lines."""
    decks = tuple(dict.fromkeys(line.body for line in structure.bearings))
    upright = [body.name for body in structure.bodies if body.name not in decks]
    ends = {body.name: _ends(structure, body.name) for body in structure.bodies}
    scaled = np.ptp(list(ends.values())) > 0.0
    if not scaled:  # without heights one above the other
        ends = {name: (1.0, 1.0) if name in decks else (0.0, 1.0) for name in ends}
    spacing = 0.8 * max(float(np.ptp(list(ends.values()))), 1e-6)
    lift = 0.07 * spacing  # room for the bearings under a deck
    ends |= {name: (ends[name][1] + lift,) * 2 for name in decks}
    supports = {
        line.name: ("ground", line.name) if line.base == GROUND else _root(structure, line.base)
        for line in structure.bearings
    }
    order = list(dict.fromkeys([*supports.values(), *(_root(structure, n) for n in upright)]))
    columns = {name: spacing * order.index(_root(structure, name)) for name in upright}
    seats = {}
    for name, support in supports.items():
        same = [other for other in supports if supports[other] == support]
        aside = SEAT * (same.index(name) - 0.5 * (len(same) - 1))
        seats[name] = spacing * (order.index(support) + aside)
    for deck in decks:
        under = [seats[line.name] for line in structure.bearings if line.body == deck]
        columns[deck] = 0.5 * (min(under) + max(under))
    return _Layout(columns, seats, ends, decks, spacing, bool(scaled))


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


def _separate(figure: Figure, ax: Axes, names: list[Annotation]) -> None:
    """Raise names of bearing lines above the neighbours that they overlap, and make room for them.

    Boxes are in pixels of the figure after its layout.
    """
    figure.draw_without_rendering()
    point = figure.dpi / 72.0
    placed: list[Bbox] = []
    names = sorted(names, key=lambda name: float(name.xy[0]))
    for name in names:
        box = name.get_window_extent()
        while below := [other for other in placed if other.padded(point).overlaps(box)]:
            rise = max(other.y1 for other in below) + 2.0 * point - box.y0
            name.xyann = (0.0, name.xyann[1] + rise / point)
            box = box.translated(0.0, rise)
        placed.append(box)
    frame = ax.get_window_extent()
    low, high = ax.get_ylim()
    for name, box in zip(names, placed, strict=True):
        place = float(name.xy[1])
        above = box.y1 + 4.0 * point - ax.transData.transform((0.0, place))[1]
        high = max(high, low + (place - low) * frame.height / max(frame.height - above, 1.0))
    ax.set_ylim(low, high)


class StructureFigures(drawing.Figures):
    """Figures of a structure: `result.plot.model()`, `.modes()`."""

    def __init__(self, result: StructureResult) -> None:
        super().__init__(result)
        self._structure = result.structure
        self._layout = _lay_out(result.structure)

    def model(self) -> Figure:
        """Return bodies, masses, springs, hinges and bearings; the legend states their sizes."""
        layout, structure = self._layout, self._structure
        places = [*layout.columns.values(), *layout.seats.values()]
        wide = max(6.5, 3.0 + 1.3 * len(set(places)))
        labels = self._sizes()
        height = 4.6 + 0.16 * sum(1 + label.count("\n") for _, label in labels)
        figure, (ax,) = drawing.panels(1, 1, (wide, height), f"{structure.name}: the model")
        ax.grid(False, axis="x")
        low = min(low for low, _ in layout.ends.values())
        for body in structure.bodies:
            self._body(ax, body.name)
        for spring in structure.springs:
            self._spring(ax, spring)
        for hinge in structure.hinges:
            at = [layout.columns[hinge.body]], [M * structure.body(hinge.body).base_height]
            ax.plot(*at, zorder=6, markersize=9, **HANDLES["hinge"])
        names = [self._bearings(ax, line, low) for line in structure.bearings]
        for mass in structure.masses:
            y = M * mass.height if layout.scaled else layout.ends[mass.body][1]
            y = float(np.clip(y, *layout.ends[mass.body]))
            ax.plot([layout.columns[mass.body]], [y], markersize=7, zorder=7, **HANDLES["mass"])
        ax.axhline(low, color=drawing.GREY, linewidth=0.8, linestyle=(0, (6, 3)), zorder=0)
        ax.set_xticks([])
        ax.set_xlim(min(places) - 0.6 * layout.spacing, max(places) + 0.6 * layout.spacing)
        ax.margins(y=0.12)
        drawing.name_axes(ax, "", self._height())
        handles = [Line2D([], [], label=label, **HANDLES[part]) for part, label in labels]
        look: drawing.Look = {"loc": "outside lower center", "frameon": False}
        figure.legend(handles=handles, fontsize=drawing.SMALL, **look)
        _separate(figure, ax, names)
        return figure

    def _sizes(self) -> list[tuple[str, str]]:
        """Return a line of the legend for each kind of part: equal ones share their size."""
        found = []
        for part, table in self._result.parts.groupby("part", sort=False):
            each = table.groupby("name", sort=False)["size"].agg(", ".join)
            names = each.reset_index().groupby("size", sort=False)["name"].agg(", ".join)
            text = "; ".join(f"{size} ({who})" for size, who in names.items())
            found.append((str(part), textwrap.fill(f"{part}: {text}", LEGEND)))
        return found

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
            head = f"{row['period_s']:.3f} s, damping {row['damping_ratio']:.1%}, "
            head += f"mass {row['effective_mass']:.0%}"
            drawing.name_axes(ax, "", self._height() if k % columns == 0 else "", head)
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
            ax.plot(self._span(name) + moved[0], [high, high], **look)
        else:
            ax.plot(layout.columns[name] + moved, [low, high], marker="o", markersize=2.5, **look)

    def _span(self, name: str) -> Floats:
        """Return the ends of a deck along the bridge."""
        lines = [line for line in self._structure.bearings if line.body == name]
        under = [self._layout.seats[line.name] for line in lines]
        beyond = OVERHANG * self._layout.spacing * (1.0 if len(lines) > 1 else 3.0)
        return np.array([min(under) - beyond, max(under) + beyond])

    def _body(self, ax: Axes, name: str) -> None:
        """Draw a deck across, anything else upright."""
        layout, (low, high) = self._layout, self._layout.ends[name]
        x = layout.columns[name]
        look: drawing.Look = {"solid_capstyle": "butt", "zorder": 1}
        if name in layout.decks:
            span = self._span(name)
            ax.plot(span, [high, high], color=DECK, linewidth=11, **look)
            seats = sorted(layout.seats[b.name] for b in self._structure.bearings if b.body == name)
            free = seats if len(seats) > 1 else [span[0], x]  # of bearings and of the mass
            at = (free[0] + 0.37 * (free[1] - free[0]), high)
            ax.annotate(name, at, (0, 0), ha="center", va="center", **TEXT | ON_DECK)
            return
        if low == high:
            across = [x - 0.15 * layout.spacing, x + 0.15 * layout.spacing]
            ax.plot(across, [low] * 2, color=PIER, linewidth=6)
        else:
            width = 12.5 if self._structure.body(name).moves else 10.0
            ax.plot([x, x], [low, high], color=PIER, alpha=0.45, linewidth=width, **look)
        words = textwrap.fill(name, 10)
        at = (x - NAME * layout.spacing, 0.5 * (low + high))
        ax.annotate(words, at, (0, 0), ha="right", va="center", fontweight="bold", **TEXT)

    def _spring(self, ax: Axes, spring: Any) -> None:
        """Draw teeth towards its base, or an open ring against rotation."""
        layout = self._layout
        x, low = layout.columns[spring.body], layout.ends[spring.body][0]
        y = max(M * spring.height, low)
        if spring.stiffness is None:
            ax.plot([x], [low], "o", color="none", markeredgecolor=SPRING, markersize=15, zorder=5)
            return
        far = x - 0.35 * layout.spacing if spring.base == GROUND else layout.columns[spring.base]
        across = np.linspace(far, x, 2 * TEETH + 2)
        teeth = np.where(np.arange(2 * TEETH + 2) % 2, 1.0, -1.0) * 0.02 * layout.spacing
        teeth[[0, -1]] = 0.0
        ax.plot(across, y + teeth, color=SPRING, linewidth=1.3, zorder=4)
        ax.plot([far, far], [y - 0.04 * layout.spacing, y + 0.04 * layout.spacing], color=SPRING)

    def _bearings(self, ax: Axes, line: Any, low: float) -> Annotation:
        """Draw a box between the two bodies of a line, on an abutment if its base is the ground.

        Returns the name of the line, which stands above the deck.
        """
        layout, ground = self._layout, line.base == GROUND
        x, wide = layout.seats[line.name], 0.14 * layout.spacing
        y = M * line.height if ground else layout.ends[line.base][1]
        top = layout.ends[line.body][1]
        if ground and y > low:
            look: drawing.Look = {"facecolor": drawing.STEEL, "linewidth": 0}
            ax.add_patch(Rectangle((x - 0.5 * wide, low), wide, y - low, zorder=1, **look))
        height = max(top - y, 0.03 * layout.spacing)
        ax.add_patch(Rectangle((x - 0.5 * wide, y), wide, height, color=BEARING, zorder=5))
        words = textwrap.fill(line.name, NAME_WIDTH)
        return ax.annotate(words, (x, top), (0, ABOVE_DECK), ha="center", va="bottom", **TEXT)

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {"model": self.model, "modes": self.modes}
