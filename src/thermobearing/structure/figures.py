"""A structure drawn: bodies, masses, springs, hinges and bearings; its plan and its mode shapes.

Heights are those of the model, of masses too; a deck is a bar at the height of its bearing lines,
which are small symbols below it, of the same size in every drawing. Supports stand
where their bearing lines are, to scale; without coordinates side by side in the order of the
lines, at equal distances. Lines on the ground stand on their own abutment.
"""

import textwrap
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox, offset_copy

from thermobearing.core.records import Floats
from thermobearing.results import drawing
from thermobearing.structure.fields import GROUND
from thermobearing.structure.matrices import displacement_row, mean_height
from thermobearing.structure.model import Mass, Spring, Structure, device_ends
from thermobearing.structure.report import EFFECTIVE_MASSES
from thermobearing.structure.result import StructureResult

M = 1e-3  # m per mm
MOST_MODES = 6
PIER, DECK, SPRING, BEARING, HINGE = "#6b7280", "#374151", "#0077BB", "#EE7733", "#CC3311"
DEVICE = "#009988"
NEXT_DEVICE = 0.11  # distance of a device from its line, and from the next, of that of piers
TEETH = 5  # of a spring
THICK = 11.0  # of a deck and of a bearing line [pt]
# A bearing line as a marker: a square whose top is half the thickness of a deck below its height.
BELOW_DECK = ((-1, -3), (1, -3), (1, -1), (-1, -1), (-1, -3))
SEAT = 0.26  # distance of two lines on one pier, of the spacing of piers
OVERHANG = 0.09  # of a deck beyond its last line, likewise
NAME = 0.09  # distance of the name of a body, likewise
NAME_WIDTH = 14  # letters of a line of the name of a bearing line
NEXT_TO_MASS = 6.0  # distance of a name from a mass above its line [pt]
ABOVE_DECK = 8.0  # height of these names above the top of a line [pt]
MOST_GAPS = 5  # of the size of a structure in the spacing of its supports
ALONG, ACROSS = "along the bridge, x [m]", "across, y [m]"
REST: drawing.Look = {"color": "#c8ccd2", "linewidth": 3.0}
MOVED: drawing.Look = {"color": "#CC3311", "linewidth": 1.8}
LEGEND = 105  # letters of a line of the legend
TEXT: drawing.Look = {"textcoords": "offset points", "fontsize": drawing.SMALL}
TEXT |= {"zorder": 8, "color": drawing.INK}
ON_DECK: drawing.Look = {"color": "white", "fontsize": drawing.SMALLEST}
ROOM_OF_MODEL = 2.2  # in height, that a narrow figure of the model can do without [inch]
BELOW: drawing.Look = {"loc": "outside lower center", "frameon": False, "fontsize": drawing.SMALL}
NONE: drawing.Look = {"linestyle": "none"}
SIDES = {  # of a point where its name may be: offset [pt] and alignment
    "a": (0.0, 9.0, "center", "bottom"),
    "b": (0.0, -9.0, "center", "top"),
    "l": (-9.0, 0.0, "right", "center"),
    "r": (9.0, 0.0, "left", "center"),
}
CENTRED: drawing.Look = {"ha": "center", "va": "center"}
FRAME, ROOM = 6.3, 0.7  # width of a plan, and what it has above and below the decks [inch]
OVERHANG_IN_PLAN = 0.03  # of a deck beyond its lines, of its size
PLAN_MARKS = {  # of a plan: marker, size, colour, colour of its edge, order
    "bearing line": ("s", 7, BEARING, BEARING, 5),
    "pier": ("s", 13, PIER, PIER, 3),
    "abutment": ("s", 13, drawing.STEEL, drawing.GREY, 2),
    "ground spring": ("D", 11, "none", SPRING, 2),
    "centre of mass of a deck": ("o", 8, "none", drawing.INK, 6),
    "centre of stiffness of its bearing lines": ("x", 8, HINGE, HINGE, 6),
}
HANDLES: dict[str, drawing.Look] = {
    "mass": {"color": drawing.INK, "marker": "o"} | NONE,
    "bearings": {"color": BEARING, "marker": "s"} | NONE,
    "spring": {"color": SPRING},
    "hinge": {"color": "white", "markeredgecolor": HINGE, "marker": "o"} | NONE,
    "damper": {"color": DEVICE, "marker": "D"} | NONE,
    "slider": {"color": DEVICE, "marker": "_", "markeredgewidth": 2.5} | NONE,
    "gap": {"color": DEVICE, "marker": "|", "markeredgewidth": 2.5} | NONE,
}


class _Layout(NamedTuple):
    """Places of bodies and bearing lines, and ends of bodies [m]."""

    columns: dict[str, float]  # of bodies
    seats: dict[str, float]  # of bearing lines
    ends: dict[str, tuple[float, float]]
    decks: tuple[str, ...]
    spacing: float  # of supports
    rise: float  # unit of sizes in the direction of height
    scaled: bool  # heights are those of the model
    placed: bool  # so are places along the bridge


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
    else:
        ends |= {deck: (_level(structure, deck),) * 2 for deck in decks}
    rise = spacing = 0.8 * max(float(np.ptp(list(ends.values()))), 1e-6)
    supports = {
        line.name: ("ground", line.name) if line.base == GROUND else _root(structure, line.base)
        for line in structure.bearings
    }
    at = {line.name: M * structure.point(line)[0] for line in structure.bearings}
    placed = np.ptp(list(at.values())) > 0.0
    order = list(dict.fromkeys([*supports.values(), *(_root(structure, n) for n in upright)]))
    lines_by_support = [
        [name for name in supports if supports[name] == support] for support in order
    ]
    if placed:
        support_places: list[Any] = [
            np.mean([at[name] for name in names]) if names else M * structure.place(str(support))[0]
            for support, names in zip(order, lines_by_support, strict=True)
        ]
        # The size of symbols follows the spacing: two supports close to each other must not make
        # all of them too small to see.
        spacing = max(_gap(support_places), np.ptp([*support_places, *at.values()]) / MOST_GAPS)
        seats = at
    else:
        support_places = [spacing * k for k in range(len(order))]
        seats = {
            name: support_places[k] + SEAT * spacing * (names.index(name) - 0.5 * (len(names) - 1))
            for k, names in enumerate(lines_by_support)
            for name in names
        }
    columns = {name: support_places[order.index(_root(structure, name))] for name in upright}
    for deck in decks:
        under = [seats[line.name] for line in structure.bearings if line.body == deck]
        columns[deck] = 0.5 * (min(under) + max(under))
    return _Layout(columns, seats, ends, decks, spacing, rise, bool(scaled), bool(placed))


def _level(structure: Structure, deck: str) -> float:
    """Return the height at which a deck is drawn: that of its highest bearing line [m]."""
    return M * max(line.height for line in structure.bearings if line.body == deck)


def _gap(places: Iterable[float]) -> float:
    """Return the smallest distance of different places; zero of one place."""
    gaps = np.diff(np.unique(np.round(list(places), 6)))
    return float(gaps.min()) if len(gaps) else 0.0


def _ends(structure: Structure, name: str) -> tuple[float, float]:
    heights = [mass.height for mass in structure.masses if mass.body == name]
    heights += [line.height for line in structure.bearings if name in (line.body, line.base)]
    springs = [spring for spring in structure.springs if spring.stiffness is not None]
    heights += [spring.height for spring in springs if name == spring.body]
    heights += [body.base_height for body in structure.bodies if body.on == name]
    body = structure.body(name)
    if not any(line.body == name for line in structure.bearings):
        heights.append(body.base_height)
    if structure.report.pier == name:
        heights.append(structure.report.pier_top)
    return M * min(heights, default=0.0), M * max(heights, default=0.0)


def _separate(
    figure: Figure, names: list[Annotation], taken: Iterable[Bbox] = (), sides: str = ""
) -> list[Bbox]:
    """Move names off each other and off the boxes that are `taken`.

    A name goes to the first of the `sides` of its point (letters of SIDES) that is free; if none
    is, it is raised above what it overlaps. Boxes are in pixels of the figure after its layout.
    Sorts the names along the bridge, and returns their boxes in that order.
    """
    # Boxes of texts are known only after the layout.
    figure.draw_without_rendering()
    point = figure.dpi / 72.0
    placed = list(taken)
    names.sort(key=lambda name: float(name.xy[0]))

    def _boxes_on(box: Bbox) -> list[Bbox]:
        return [placed_box for placed_box in placed if placed_box.padded(point).overlaps(box)]

    for name in names:
        for side in (*sides, *sides[:1]):  # back to the first side where none is free
            across, up, horizontal, vertical = SIDES[side]
            name.xyann = (across, up)
            name.set(ha=horizontal, va=vertical)
            box = name.get_window_extent()
            if not _boxes_on(box):
                break
        box = name.get_window_extent()
        # Raised above one name it may reach another.
        while overlapping := _boxes_on(box):
            rise = max(placed_box.y1 for placed_box in overlapping) + 2.0 * point - box.y0
            name.xyann = (name.xyann[0], name.xyann[1] + rise / point)
            box = box.translated(0.0, rise)
        placed.append(box)
    return placed[len(placed) - len(names) :]


def _make_room(ax: Axes, names: list[Annotation], placed: list[Bbox]) -> None:
    """Raise the upper limit of a panel above names in it."""
    frame, point = ax.get_window_extent(), drawing.parent_figure(ax).dpi / 72.0
    low, high = ax.get_ylim()
    # A name has a fixed height in pixels: the limit that leaves room above its point.
    for name, box in zip(names, placed, strict=True):
        place = float(name.xy[1])
        above = box.y1 + 4.0 * point - ax.transData.transform((0.0, place))[1]
        high = max(high, low + (place - low) * frame.height / max(frame.height - above, 1.0))
    ax.set_ylim(low, high)


def _mark(ax: Axes, at: Any, kind: str) -> None:
    """Draw a mark of a plan at a place [m]."""
    marker, size, colour, edge, order = PLAN_MARKS[kind]
    look: drawing.Look = {"color": colour, "markeredgecolor": edge, "zorder": order} | NONE
    ax.plot(*at, label=kind, marker=marker, markersize=size, **look)


class StructureFigures(drawing.Figures):
    """Figures of a structure: `result.plot.model()`, `.modes()`."""

    def __init__(self, result: StructureResult) -> None:
        super().__init__(result)
        self._structure = result.structure
        self._layout = _lay_out(result.structure)

    def model(self) -> Figure:
        """Return bodies, masses, springs, hinges and bearings; the legend states their sizes."""
        size, title = self._model_size(), f"{self._structure.name}: the model"
        figure, (ax,) = drawing.panels(1, 1, size, title)
        figure.set_figheight(max(figure.get_figheight(), size[1] - ROOM_OF_MODEL))
        self._model(ax)
        return figure

    def _model_size(self) -> tuple[float, float]:
        """Return width and height of the figure of the model [inch]."""
        layout = self._layout
        places = [*layout.columns.values(), *layout.seats.values()]
        supports = 1.0 + np.ptp(places) / layout.spacing if layout.placed else len(set(places))
        lines = sum(1 + label.count("\n") for _, label in self._sizes())
        return max(6.5, 3.0 + 1.3 * float(supports)), 4.6 + 0.16 * lines

    def _model(self, ax: Axes) -> None:
        """Draw the model in a panel, with the legend below all panels."""
        layout, structure, figure = self._layout, self._structure, drawing.parent_figure(ax)
        places = [*layout.columns.values(), *layout.seats.values()]
        ax.grid(False, axis="x")
        low = min(low for low, _ in layout.ends.values())
        names_by_place: dict[Any, list[str]] = {}
        for body in structure.bodies:
            place = layout.columns[body.name], layout.ends[body.name]
            names_by_place.setdefault(place, []).append(body.name)
        bodies = [self._body(ax, names) for names in names_by_place.values()]
        for spring in structure.springs:
            self._spring(ax, spring)
        for hinge in structure.hinges:
            at = [layout.columns[hinge.body]], [M * structure.body(hinge.body).base_height]
            ax.plot(*at, zorder=6, markersize=9, **HANDLES["hinge"])
        heads = [self._bearings(ax, line, low) for line in structure.bearings]
        self._devices(ax)
        for mass in structure.masses:
            x, (bottom, top) = self._across(mass), layout.ends[mass.body]
            y = M * mass.height if layout.scaled else 0.5 * (bottom + top)
            if mass.body in layout.decks and y != top:
                ax.plot([x, x], [top, y], color=DECK, linewidth=2.0, zorder=1)
            ax.plot([x], [y], markersize=7, zorder=7, **HANDLES["mass"])
        ax.axhline(low, color=drawing.GREY, linewidth=0.8, linestyle=(0, (6, 3)), zorder=0)
        if not layout.placed:
            ax.set_xticks([])
        ax.set_xlim(min(places) - 0.6 * layout.spacing, max(places) + 0.6 * layout.spacing)
        ax.margins(y=0.12)
        drawing.name_axes(ax, ALONG if layout.placed else "", self._height())
        handles = [Line2D([], [], label=label, **HANDLES[part]) for part, label in self._sizes()]
        figure.legend(handles=handles, **BELOW)
        _separate(figure, bodies)
        _make_room(ax, heads, _separate(figure, heads))

    def plan(self) -> Figure:
        """Return decks, piers and bearing lines in plan, to scale, with their coordinates."""
        structure = self._structure
        outlines = [self._outline(deck) for deck in self._layout.decks]
        part_places = [structure.place(body.name) for body in structure.bodies]
        part_places += [structure.point(spring) for spring in structure.springs]
        corners = np.concatenate([*outlines, M * np.array(part_places)])
        low, size = corners.min(axis=0), np.ptp(corners, axis=0)
        arm = 0.07 * float(size.max())
        origin = np.array([low[0] - 2.2 * arm, low[1] + 0.5 * size[1]])
        ends = origin[0] - 0.5 * arm, low[0] + size[0] + arm
        inch = (ends[1] - ends[0]) / FRAME  # in m
        room = ROOM * inch
        height = 1.3 + min((size[1] + 2.0 * room) / inch, FRAME)
        title = f"{structure.name}: plan"
        figure, (ax,) = drawing.panels(1, 1, (drawing.WIDEST, height), title)
        ax.set(xlim=ends, ylim=(low[1] - room, low[1] + size[1] + room), aspect="equal")
        decks = [self._deck_in_plan(ax, deck) for deck in self._layout.decks]
        names = [self._line_in_plan(ax, line) for line in structure.bearings]
        below = [*self._piers_in_plan(ax), *decks]
        for spring in structure.springs:
            if spring.stiffness is not None and spring.base == GROUND:
                at = M * np.array(structure.point(spring))
                _mark(ax, at, "ground spring")
        for axis, step in (("x", (arm, 0.0)), ("y", (0.0, arm))):
            look: drawing.Look = {"arrowstyle": "->", "color": drawing.INK}
            ax.annotate("", tuple(origin + step), tuple(origin), arrowprops=look)
            at = origin + 1.25 * np.array(step)
            ax.annotate(axis, tuple(at), (0, 0), **TEXT | CENTRED)
        drawing.name_axes(ax, ALONG, ACROSS)
        handles = {str(line.get_label()): line for line in ax.lines}
        place: drawing.Look = BELOW | {"ncols": drawing.fitting(3), "markerscale": 0.6}
        figure.legend(handles=list(handles.values()), **place)
        self._part_names(ax, names, below, [origin, origin + 1.5 * arm])
        return figure

    def _part_names(
        self, ax: Axes, above: list[Annotation], below: list[Annotation], arrows: list[Floats]
    ) -> None:
        """Move names apart and off marks and arrows, and make the figure high enough."""
        figure = drawing.parent_figure(ax)
        # The layout would make the plan smaller for names that go beyond the panel.
        for name in (*above, *below):
            name.set_in_layout(False)
        figure.draw_without_rendering()
        point = figure.dpi / 72.0
        marks = [
            Bbox([at, at]).padded(0.5 * point * line.get_markersize())
            for line in ax.lines
            for at in ax.transData.transform(line.get_xydata())
        ]
        marks.append(Bbox(ax.transData.transform(arrows)))
        placed = _separate(figure, above, marks, "ablr")
        placed += _separate(figure, below, [*marks, *placed], "balr")
        frame = ax.get_window_extent()
        excess = max(max(box.y1 - frame.y1, frame.y0 - box.y0) for box in placed) + 4.0 * point
        excess = max(excess, 0.0) / frame.height
        low, high = ax.get_ylim()
        ax.set_ylim(low - excess * (high - low), high + excess * (high - low))
        # The figure becomes higher by as much as the limits: the scale of the plan stays.
        figure.set_figheight(figure.get_figheight() + 2.0 * excess * frame.height / figure.dpi)

    def _outline(self, deck: str) -> Floats:
        """Return the corners of a deck in plan [m]: a little more than its lines and masses."""
        structure = self._structure
        points = [structure.point(line) for line in structure.bearings if line.body == deck]
        points += [structure.point(mass) for mass in structure.masses if mass.body == deck]
        low, high = M * np.min(points, axis=0), M * np.max(points, axis=0)
        room = OVERHANG_IN_PLAN * max(float(np.max(high - low)), 1.0)
        low, high = low - room, high + room
        return np.array([low, (high[0], low[1]), high, (low[0], high[1])])

    def _deck_in_plan(self, ax: Axes, deck: str) -> Annotation:
        """Draw a deck, its centre of mass and that of its bearing lines; return its name."""
        structure, corners = self._structure, self._outline(deck)
        ax.add_patch(Polygon(corners, facecolor=drawing.STEEL, linewidth=0, alpha=0.6, zorder=1))
        centres = {
            "centre of mass of a deck": [
                (structure.point(mass), mass.mass) for mass in structure.masses if mass.body == deck
            ],
            "centre of stiffness of its bearing lines": [
                (structure.point(line), line.count * line.equivalent_stiffness)
                for line in structure.bearings
                if deck in (line.body, line.base)
            ],
        }
        for kind, weighed in centres.items():
            if weighed:
                points, weights = zip(*weighed, strict=True)
                _mark(ax, M * np.average(points, axis=0, weights=weights), kind)
        return ax.annotate(deck, tuple(corners[0]), (0, -3), ha="left", va="top", **TEXT)

    def _line_in_plan(self, ax: Axes, line: Any) -> Annotation:
        """Draw a bearing line, and return its name with its coordinates."""
        x, y = (M * place for place in self._structure.point(line))
        if line.base == GROUND:
            _mark(ax, (x, y), "abutment")
        _mark(ax, (x, y), "bearing line")
        label = f"{textwrap.fill(line.name, NAME_WIDTH)}\n({x:g}, {y:g})"
        return ax.annotate(label, (x, y), (0, 9), ha="center", va="bottom", **TEXT)

    def _piers_in_plan(self, ax: Axes) -> list[Annotation]:
        """Draw the bodies that are no decks; return the names of those at each place."""
        structure = self._structure
        names: dict[tuple[float, float], list[str]] = {}
        for body in structure.bodies:
            if body.name not in self._layout.decks:
                names.setdefault(structure.place(body.name), []).append(body.name)
        annotations = []
        for (x, y), body_names in names.items():
            _mark(ax, (M * x, M * y), "pier")
            words = "\n".join(textwrap.fill(name, NAME_WIDTH) for name in reversed(body_names))
            look: drawing.Look = TEXT | {"ha": "center", "va": "top", "fontweight": "bold"}
            annotations.append(ax.annotate(words, (M * x, M * y), (0, -9), **look))
        return annotations

    def _across(self, part: Mass | Spring) -> float:
        """Return the place of a part in an elevation: of the pier that it is on, or its own."""
        if self._structure.plan and part.body in self._layout.decks:
            return M * self._structure.point(part)[0]
        return self._layout.columns[part.body]

    def _sizes(self) -> list[tuple[str, str]]:
        """Return a line of the legend for each kind of part: equal ones share their size."""
        entries, room = [], drawing.fitting(LEGEND)
        for part, table in self._result.parts.groupby("part", sort=False):
            sizes_by_name = table.groupby("name", sort=False)["size"].agg(", ".join)
            names = sizes_by_name.reset_index().groupby("size", sort=False)["name"].agg(", ".join)
            text = "; ".join(f"{size} ({names_of_size})" for size, names_of_size in names.items())
            entries.append((str(part), textwrap.fill(f"{part}: {text}", room)))
        return entries

    def modes(self) -> Figure:
        """Return the first six mode shapes; bearings with their equivalent stiffness."""
        table = self._result.table
        shapes = self._result.prepared.modes.shapes
        count = min(len(table), MOST_MODES)
        columns = min(count, 3)
        rows = -(-count // columns)
        plan = bool(self._structure.plan)
        size = (3.2 * columns + 0.6, (2.0 if plan else 3.0) * rows + 0.9)
        title = f"{self._structure.name}: mode shapes"
        figure, axes = drawing.panels(rows, columns, size, title, share=not plan)
        for k, ax in enumerate(axes):
            if not plan:
                ax.set_xticks([])
            if k >= count:
                ax.set_visible(False)
                continue
            draw_mode = self._mode_in_plan if plan else self._mode
            draw_mode(ax, shapes[:, k])
            row = table.iloc[k]
            masses = [
                f"{name.removeprefix('effective_mass_')}{drawing.UNBROKEN}{row[name]:.0%}"
                for name in EFFECTIVE_MASSES
                if plan and np.isfinite(row[name])
            ]
            head = (
                f"{row['period_s']:.3f} s, viscous {row['damping_ratio']:.1%}, mass "
                f"{', '.join(masses) or format(row['effective_mass'], '.0%')}"
            )
            side = ACROSS if plan else self._height()
            drawing.name_axes(ax, "", side if k % columns == 0 else "", head)
            ax.title.set_fontsize(drawing.SMALL)
        return figure

    def _mode(self, ax: Axes, shape: Floats) -> None:
        """Draw bodies at rest and in a mode, seen from the side."""
        layout = self._layout
        moved = {name: self._moved(name, shape) for name in layout.ends}
        largest = max(float(np.abs(values).max()) for values in moved.values())
        # The scale of a mode shape is arbitrary: its largest displacement is 0.4 of the spacing.
        factor = 0.4 * layout.spacing / max(largest, 1e-30)
        for name, values in moved.items():
            self._shape(ax, name, np.zeros(2), REST)
            self._shape(ax, name, factor * values, MOVED)

    def _mode_in_plan(self, ax: Axes, shape: Floats) -> None:
        """Draw outlines of decks and tops of piers at rest and in a mode, seen from above."""
        structure = self._structure
        motions: list[tuple[Floats, Floats]] = []  # places and displacements
        for deck in self._layout.decks:
            corners, height = self._outline(deck), mean_height(structure, deck)
            motions.append(self._motion(deck, height, np.vstack([corners, corners[:1]]), shape))
        for line in structure.bearings:
            if line.base != GROUND:
                at = M * np.array([structure.point(line)])
                motions.append(self._motion(line.base, line.height, at, shape))
        corners = np.concatenate([places for places, _ in motions])
        size = float(np.ptp(corners, axis=0).max())
        largest = max(float(np.abs(moved).max()) for _, moved in motions)
        for places, moved in motions:
            ends = places + 0.12 * size / max(largest, 1e-30) * moved
            for points, look in ((places, REST), (ends, MOVED)):
                ax.plot(*points.T, **look, marker="o" if len(points) == 1 else "", markersize=4)
        ax.set_aspect("equal", adjustable="datalim")
        ax.margins(0.1)

    def _motion(
        self, name: str, height: float, places: Floats, shape: Floats
    ) -> tuple[Floats, Floats]:
        """Return places in plan [m] and the displacements of a body there in a mode."""
        moved = [
            displacement_row(self._structure, name, height, *at / M).T @ shape for at in places
        ]
        return places, np.array(moved)

    def _height(self) -> str:
        return "height [m]" if self._layout.scaled else "no heights given: not to scale"

    def _moved(self, name: str, shape: Floats) -> Floats:
        """Return the sideways motion of the ends of a body in a mode."""
        structure, (low, high) = self._structure, self._layout.ends[name]
        if name in self._layout.decks:
            at = mean_height(structure, name)
            return np.full(2, displacement_row(structure, name, at) @ shape)
        return np.array([displacement_row(structure, name, end / M) @ shape for end in (low, high)])

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

    def _body(self, ax: Axes, names: list[str]) -> Annotation:
        """Draw bodies at one place, a deck across, others upright; return their names as drawn."""
        name = names[0]
        layout, (low, high) = self._layout, self._layout.ends[name]
        x = layout.columns[name]
        look: drawing.Look = {"solid_capstyle": "butt", "zorder": 1}
        if name in layout.decks:
            span = self._span(name)
            ax.plot(span, [high, high], color=DECK, linewidth=THICK, **look | {"zorder": 2})
            seats = sorted(layout.seats[b.name] for b in self._structure.bearings if b.body == name)
            edges = seats if len(seats) > 1 else [span[0], x]  # of bearings and of the mass
            share = 0.37
            if layout.placed:
                body_masses = [mass for mass in self._structure.masses if mass.body in names]
                masses = [self._across(mass) for mass in body_masses]
                edges, share = sorted([*span, *seats, *masses]), 0.5
            widest_gap = int(np.argmax(np.round(np.diff(edges), 6)))
            at = (edges[widest_gap] + share * (edges[widest_gap + 1] - edges[widest_gap]), high)
            words = ", ".join(names)
            return ax.annotate(words, at, (0, 0), ha="center", va="center", **TEXT | ON_DECK)
        if low == high:
            across = [x - 0.15 * layout.spacing, x + 0.15 * layout.spacing]
            ax.plot(across, [low] * 2, color=PIER, linewidth=6)
        else:
            width = 12.5 if self._structure.body(name).moves else 10.0
            ax.plot([x, x], [low, high], color=PIER, alpha=0.45, linewidth=width, **look)
        words = "\n".join(textwrap.fill(name, 10) for name in names)
        at = (x - NAME * layout.spacing, 0.5 * (low + high))
        look = TEXT | {"ha": "right", "va": "center", "fontweight": "bold"}
        return ax.annotate(words, at, (0, 0), **look)

    def _spring(self, ax: Axes, spring: Any) -> None:
        """Draw teeth towards its base, or an open ring against rotation."""
        layout = self._layout
        low = layout.ends[spring.body][0]
        x = self._across(spring)
        y, rise = M * spring.height if layout.scaled else low, layout.rise
        if spring.stiffness is None:
            ax.plot([x], [low], "o", color="none", markeredgecolor=SPRING, markersize=15, zorder=5)
            return
        base_x = x - 0.35 * layout.spacing if spring.base == GROUND else layout.columns[spring.base]
        across = np.linspace(base_x, x, 2 * TEETH + 2)
        teeth = np.where(np.arange(2 * TEETH + 2) % 2, 1.0, -1.0) * 0.02 * rise
        teeth[[0, -1]] = 0.0
        ax.plot(across, y + teeth, color=SPRING, linewidth=1.3, zorder=4)
        ax.plot([base_x, base_x], [y - 0.04 * rise, y + 0.04 * rise], color=SPRING)

    def _bearings(self, ax: Axes, line: Any, low: float) -> Annotation:
        """Draw a bearing line, on an abutment if its base is the ground; return its name."""
        layout, x = self._layout, self._layout.seats[line.name]
        top = layout.ends[line.body][1]
        y = M * line.height if layout.scaled else top
        look: drawing.Look = {"linewidth": THICK}
        if line.base == GROUND and y > low:
            ax.plot([x, x], [low, y], color=drawing.STEEL, solid_capstyle="butt", zorder=1, **look)
        if y < top:  # the deck reaches down to this line
            ax.plot([x, x], [y, top], color=DECK, solid_capstyle="projecting", zorder=2, **look)
        ax.plot([x], [y], marker=BELOW_DECK, markersize=3.0 * THICK, color=BEARING, zorder=5)
        label = textwrap.fill(line.name, NAME_WIDTH)
        above = [
            self._across(mass)
            for mass in self._structure.masses
            if mass.body == line.body and layout.scaled and M * mass.height > top
        ]
        # Where the mass of the deck stands over this line, the name is next to it.
        covered = any(abs(place - x) < 0.1 * layout.spacing for place in above)
        aside, side = (-NEXT_TO_MASS, "right") if covered else (0.0, "center")
        return ax.annotate(label, (x, top), (aside, ABOVE_DECK), ha=side, va="bottom", **TEXT)

    def _devices(self, ax: Axes) -> None:
        """Draw the mark of each device next to its line, or next to its body."""
        layout, drawn = self._layout, dict.fromkeys(self._layout.seats, 0)
        # Below the deck, as the bearings.
        below = offset_copy(ax.transData, drawing.parent_figure(ax), 0.0, -THICK, units="points")
        for device in self._structure.device_list:
            body, base, height = device_ends(self._structure, device)
            place = device.line or f"{body}, {base}"
            drawn[place] = drawn.get(place, 0) + 1
            x = layout.seats[device.line] if device.line else layout.columns[body]
            y = M * height if layout.scaled else layout.ends[body][0]
            at = x + NEXT_DEVICE * layout.spacing * drawn[place]
            look: drawing.Look = {"markersize": 9, "zorder": 7, "transform": below} | HANDLES[
                device.kind
            ]
            ax.plot([at], [y], **look)

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        figures = {"model": self.model, "plan": self.plan, "modes": self.modes}
        if not self._structure.plan:
            del figures["plan"]
        return figures


class FrameFigures(StructureFigures):
    """Figures of an imported structure: `result.plot.frame()`, and those of any structure."""

    def frame(self) -> Figure:
        """Return the frame with its nodes, and the structure that it became."""
        frame, name = self._result.frame, self._structure.name
        width, height = self._model_size()
        figure, (ax, right) = drawing.panels(1, 2, (2.0 * width, height), f"{name}: the frame")
        at = {name: (node.x, node.z) for name, node in frame.nodes.items()}
        for element in frame.elements:
            if element.is_member:
                rigid = element.stiffness is None
                look: drawing.Look = {"linestyle": "--"} if rigid else {"linewidth": 3.0}
                points = np.array([at[end] for end in element.ends])
                ax.plot(*points.T, color=PIER, zorder=1, **look)
        # Nodes at one place, such as the two of a bearing, have one mark and one label.
        nodes_by_place: dict[Any, list[str]] = {}
        for node_name, place in at.items():
            nodes_by_place.setdefault(place, []).append(node_name)
        for place in {at[node] for node, fixities in frame.held.items() if any(fixities)}:
            ax.plot(*place, "^", color=drawing.STEEL, markersize=15, zorder=0)
        for element in frame.elements:
            if not element.is_member:
                ends = [end for end in element.ends if end != GROUND]
                line = any(self._result.bodies[end].startswith("deck") for end in ends)
                look = HANDLES["bearings" if line else "spring"] | {"marker": "s"}
                ax.plot(*at[ends[-1]], markersize=11, zorder=2, **look)
        for place, nodes in nodes_by_place.items():
            mass = sum(frame.nodes[node].mass[0] for node in nodes)
            ax.plot(*place, "o", color=drawing.INK, markersize=6 if mass else 3, zorder=3)
        names = [
            ax.annotate(", ".join(nodes), place, (9, 0), bbox=drawing.BOX, **TEXT)
            for place, nodes in nodes_by_place.items()
        ]
        ax.margins(0.25, 0.12)
        drawing.name_axes(ax, ALONG, "height [m]", "nodes and members (dashed: rigid)")
        if len({x for x, _ in at.values()}) == 1:
            ax.set(xticks=[], xlabel="")
        self._model(right)
        drawing.name_axes(right, title="bodies")
        _make_room(ax, names, _separate(figure, names, sides="rlab"))
        return figure

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {"frame": self.frame} | super().draw_all()
