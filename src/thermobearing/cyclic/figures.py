"""Figures of a displacement-controlled test.

The numbers are those of `Result`; nothing is computed here but where to draw them.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby, zip_longest
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd, xr
from thermobearing.core.records import Floats
from thermobearing.cyclic.comparison import compared_places
from thermobearing.cyclic.result import Result, run_name
from thermobearing.cyclic.tables import inner_layer
from thermobearing.quantities.governing import largest_by, place_of_largest
from thermobearing.quantities.register import quantity
from thermobearing.quantities.words import joined, percent
from thermobearing.results import drawing
from thermobearing.results.profiles import (
    MOST_PROFILES,
    ProfilePanel,
    draw_profile_panels,
    draw_stack,
)
from thermobearing.results.ranges import limits_passed
from thermobearing.results.selection import layer_groups
from thermobearing.results.time_axis import DrawnAxis, Stretch, write_above

MOST_POINTS = 2000  # bins of a history across the page, about one per pixel
BOLD_LETTER = 0.0105  # mean width of a letter of a label, of the axis
AT_PEAK = 1.0 - 1e-9  # of the largest displacement, to find its last moment
SHOWN_CYCLES = (1, 2, 5)  # of Fig. 4.8
KJ = 1e-3  # kN mm -> kN m = kJ
STRAIN, STRESS = "shear strain [%]", "shear stress [MPa]"
PEAK = "peak stress"
IN_PLANE = "the bearing moves in a plane; see orbit"
ORBITS = (("displacement", "mm"), ("force", "kN"))
COMPONENT_LOOKS = ("-", ":")  # of x and y
Line = tuple[Floats, drawing.Look]  # values by run and time, and how they are drawn
# Variable, label, colour: safe for colour-blind readers.
SHARES = (
    ("rubber_force", "rubber f_r", "#0072B2"),
    ("lead_force", "lead f_l", "#555555"),
    ("viscous_force", "rate dependence f_v", "#D55E00"),
)
ENERGIES = (
    ("work_in", "#000000", "-", 2.2),
    ("heat_released", "#E69F00", "--", 1.6),
    ("heat_stored", "#D55E00", "-", 1.3),
    ("heat_lost_ends", "#0072B2", "-", 1.3),
    ("heat_lost_sides", "#56B4E9", "-.", 1.3),
    ("recoverable", "#009E73", "-", 1.3),
)
CYCLE_LOOKS = (("-", "o"), ("--", "s"), (":", "^"))  # line and marker
POINTS = ("none", "o")
CLOSING_LOOK: drawing.Look = {"color": drawing.GREY, "linewidth": 0.6}
FORCE: drawing.Look = {"color": drawing.INK, "linewidth": 0.9, "linestyle": "--"}
LEAD, INNER, OUTER = "#222222", "#D55E00", "#56B4E9"
METHODS = (
    "displacement",
    "orbit",
    "loops",
    "measures",
    "layer_temperatures",
    "lead_temperature",
    "force_shares",
    "profiles",
    "layer_shear",
    "energy",
    "comparison",
)
FILES = {"displacement": "imposed_displacement", "energy": "energy_balance"}  # else the method
KEPT = (  # figure, variable that it needs, group of it
    ("layer_temperatures", "rubber_temperature", "rubber"),
    ("lead_temperature", "rubber_temperature", "rubber"),
    ("profiles", "temperature", "cells"),
    ("layer_shear", "layer_displacement", "layer_displacement"),
)
NOT_KEPT = 'the result holds no {}; run with keep=["{}", ...]'
NOTHING = slice(0, 0)
CLOSING = "closing cycle"  # the kind of a segment


class NothingToDrawError(InputError):
    """The result does not hold what a figure shows."""


def _joined(pieces: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Return pieces of a line as one, NaN after each."""
    gap = np.array([np.nan])
    xs, ys = [np.empty(0)], [np.empty(0)]
    for x, y in pieces:
        xs += [x, gap]
        ys += [y, gap]
    return np.concatenate(xs), np.concatenate(ys)


def _cycle_look(line: str, marker: str, colour: str) -> drawing.Look:
    """Return line and marker of one cycle number; only full lines and lone points are filled."""
    face = colour if line in ("-", "none") else "white"
    look: drawing.Look = {"color": colour, "linestyle": line, "linewidth": 1.2}
    return look | {"marker": marker, "markersize": 4.5, "markerfacecolor": face}


def _residual(value: float) -> str:
    """Return a residual for a title: rounding as a power of ten, a real one in per cent."""
    if abs(value) < 1e-3:
        return quantity("mechanical_residual").text(value)
    return f"{100.0 * value:.2g} %".replace("-", "\N{MINUS SIGN}")


class TimeAxis(DrawnAxis):
    """Where the rows of the runs of a result are drawn; with `cut`, without the long rests."""

    def __init__(self, result: Result, *, cut: bool = False) -> None:
        segment = np.asarray(result["segment"].values)
        self._kinds = [str(about["kind"]) for about in result.segments]
        self._labels = [str(about["label"]).replace("%", " %") for about in result.segments]
        self.rows = [int((numbers >= 0).sum()) for numbers in segment]  # what follows is padding
        self.times = [result.time(run)[:rows] for run, rows in enumerate(self.rows)]
        self._numbers = [numbers[:rows] for numbers, rows in zip(segment, self.rows, strict=True)]
        super().__init__(list(self._grouped()), cut=cut)

    @property
    def farthest(self) -> int:
        """The run that got farthest, for what all runs have in common."""
        ends = zip(self._numbers, self.times, strict=True)
        reached = [(int(number[-1]), float(time[-1])) for number, time in ends]
        return reached.index(max(reached))

    def _inside(self, run: int, first: int, last: int) -> slice:
        """Return the rows of segments first to last of a run, with the row where they start."""
        a, b = np.searchsorted(self._numbers[run], [first, last + 1])
        return slice(max(int(a) - 1, 0), int(b)) if b > a else NOTHING

    def _moving_rows(self, run: int, *, closing: bool = False) -> list[slice]:
        """Return the rows of each stretch of a run in which the bearing moves.

        Those of closing cycles only, or without them.
        """
        slices = []
        for stretch in self.stretches:
            segments = range(stretch.first, stretch.last + 1) if not stretch.rest else ()
            for is_closing, group in groupby(segments, lambda n: self._kinds[n] == CLOSING):
                if is_closing == closing:
                    numbers = list(group)
                    slices.append(self._inside(run, numbers[0], numbers[-1]))
        return [inside for inside in slices if inside != NOTHING]

    def _loading_ends(self) -> list[tuple[int, str]]:
        """Return number and name of some segments whose ends are shown: loadings, if any."""
        segments: list[int] = []
        # The first kind that the test has: ramps and rests only where nothing else loads it.
        for kinds in ({"cycles", "path", "recorded"}, {"ramp"}, {"rest", CLOSING}):
            segments = [i for i, kind in enumerate(self._kinds) if kind in kinds]
            if segments:
                break
        names = [self._labels[i] for i in segments]
        chosen = np.unique(np.linspace(0, len(segments) - 1, MOST_PROFILES).round().astype(int))
        return [
            (
                segments[k],
                names[k] + (f" (step {segments[k] + 1})" if names.count(names[k]) > 1 else ""),
            )
            for k in chosen
        ]

    def _grouped(self) -> Iterator[Stretch]:
        """Yield the stretches that any run reached, not yet placed."""
        for is_rest, numbers in groupby(
            range(len(self._kinds)), lambda i: self._kinds[i] == "rest"
        ):
            stretch = list(numbers)
            first, last = stretch[0], stretch[-1]
            # A run that ended early may have reached none of the stretch, or a part of it.
            reached = [(t, self._inside(run, first, last)) for run, t in enumerate(self.times)]
            spans = [float(np.ptp(time[rows])) for time, rows in reached if rows != NOTHING]
            if spans:
                yield Stretch(first, last, is_rest, min(spans), max(spans))

    def trace(self, run: int, values: Floats) -> tuple[Floats, Floats]:
        """Return places and thinned values of a history of a run; NaN between stretches."""
        pieces = []
        for s in self.stretches:
            inside = self._inside(run, s.first, s.last)
            if inside != NOTHING and not (self.cut and s.shortened):
                y, time = values[inside], self.times[run][inside]
                kept = drawing.thin(y, math.ceil(MOST_POINTS * s.width / self.end))
                pieces.append((s.place(time[kept] - time[0]), y[kept]))
        return _joined(pieces)

    def _label_loadings(self, ax: Axes) -> None:
        """Write what is imposed above each loading that is wide enough for its label."""
        run = self.farthest
        times, labelled = self.times[run], ("cycles", "path", "recorded")
        for s in (s for s in self.stretches if not s.rest):
            start = times[self._inside(run, s.first, s.last)]
            for number in range(s.first, s.last + 1):
                time, name = times[self._inside(run, number, number)], self._labels[number]
                if self._kinds[number] in labelled and len(time):
                    middle = s.left + 0.5 * (time[0] + time[-1]) - start[0]
                    if time[-1] - time[0] > BOLD_LETTER * len(name) * self.end:
                        write_above(ax, middle, name, drawing.INK, "bold")


class Figures(drawing.Figures):
    """Figures of a result: `result.plot.loops()` and so on, each a matplotlib Figure.

    Colours go from blue (the coldest ambient temperature) to red (the warmest). The rests of
    a test are long and the loadings short: rests are cut out of, or shortened on, the axis
    of time. A figure whose data the result does not hold raises `NothingToDrawError`.
    """

    def __init__(self, result: Result) -> None:
        super().__init__(result)
        self._data = result.dataset
        self._ambient = np.asarray(result["ambient"].values, dtype=float)
        self._colours = drawing.ambient_colours(self._ambient)

    def absent(self) -> dict[str, str]:
        """Return why a figure cannot be drawn, by name of the figure."""
        result, data = self._result, self._data
        kinds = {about["kind"] for about in result.segments}
        needs = {
            "loops": (kinds - {"rest"}, "the bearing does not move in this test"),
            "measures": (len(result.cycles), "the result has no closed cycle"),
            "force_shares": ("cycles" in kinds, "the test has no cycles"),
            "comparison": (result.compared, "no other models were run"),
        }
        for name, variable, group in KEPT:
            needs[name] = (variable in data, NOT_KEPT.format(variable, group))
        if not result.has_lead:
            needs |= dict.fromkeys(
                ("lead_temperature", "force_shares"), (False, "the bearing has no lead")
            )
        if result.in_plane:
            needs |= dict.fromkeys(("loops", "force_shares", "layer_shear"), (False, IN_PLANE))
        else:
            needs["orbit"] = (False, "the bearing moves on a line; see loops")
        return {name: reason for name, (available, reason) in needs.items() if not available}

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return what draws each figure that the result holds data for, by name of its file."""
        absent = self.absent()
        return {FILES.get(n, n): getattr(self, n) for n in METHODS if n not in absent}

    def _require(self, name: str) -> None:
        if reason := self.absent().get(name):
            raise NothingToDrawError(f"{name}: {reason}")

    def _title(self, what: str) -> str:
        return f"{self._data.attrs.get('title', self._data.attrs['bearing'])}: {what}"

    def _run_titles(self) -> list[str]:
        """Return the ambient temperatures, and what ended the runs that did not complete."""
        rows, titles = self._result.tested_range.to_dict("records"), []
        for ambient, end in zip(self._ambient, self._data["outcome"].values, strict=True):
            title = f"ambient {drawing.degrees(ambient)}"
            if "ambient" in limits_passed(rows, [run_name(ambient)])[0].split():
                title += " (outside calibration range)"
            ended = "" if end == "completed" else f" ({str(end).replace('_', ' ')})"
            titles.append(title + ended)
        return titles

    def _draw_in_time(
        self, what: str, y: str, lines: Sequence[Line], notes: Sequence[str] | None = None
    ) -> tuple[Figure, list[Axes]]:
        """Draw histories, a panel for each run, with loadings and rests marked.

        Without `notes`, which follow the titles, they are temperatures: with the ambient one.
        """
        time, run_count = TimeAxis(self._result), len(self._ambient)
        titles = [a + b for a, b in zip_longest(self._run_titles(), notes or (), fillvalue="")]
        figure, axes = drawing.panels(run_count, 1, (9.5, 1.4 + 2.2 * run_count), self._title(what))
        for run, ax in enumerate(axes):
            time.set_ticks(ax, labels=run == run_count - 1)
            time.shade_rests(ax, labels=run == 0)
            if run == 0:
                time._label_loadings(ax)
            drawing.name_axes(ax, y=y, title=titles[run], pad=17.0 if ax.texts else 5.0)
            for values, look in lines:
                ax.plot(*time.trace(run, values[run]), **look)
            if notes is None:
                ax.axhline(self._ambient[run], color=drawing.GREY, linewidth=0.8, linestyle=":")
        drawing.name_axes(axes[-1], time.caption())
        handles = [Line2D([], [], **look) for _, look in lines]
        drawing.legend_below(figure, handles + [drawing.ambient_handle()] * (notes is None))
        return figure, axes

    def displacement(self) -> Figure:
        """Draw the imposed displacement [mm] and strain [%] against time; rests are cut out."""
        time = TimeAxis(self._result, cut=True)
        figure, (ax,) = drawing.panels(1, 1, (9.0, 3.4), self._title("imposed displacement"))
        moved = np.atleast_2d(self._data["displacement"].values[time.farthest].T)
        for values, line, name in zip(moved, COMPONENT_LOOKS, ("x", "y (across)"), strict=False):
            place, y = time.trace(time.farthest, values)
            ax.plot(place, y, color=drawing.INK, linewidth=0.9, linestyle=line, label=name)
        if len(moved) > 1:
            drawing.legend_below(figure, list(ax.lines))
        time.set_ticks(ax)
        drawing.name_axes(ax, time.caption(), "shear displacement [mm]")
        factor = 100.0 / float(self._data.attrs["total_rubber_thickness_mm"])
        scale: Any = (lambda x: factor * x, lambda y: y / factor)
        strain = ax.secondary_yaxis("right", functions=scale)
        strain.set_ylabel(STRAIN, fontsize=drawing.NORMAL)
        strain.tick_params(labelsize=drawing.SMALL, color=drawing.GREY)
        strain.spines["right"].set_visible(False)  # the panel has one
        time.cut_out_rests(ax)
        time._label_loadings(ax)
        return figure

    def orbit(self) -> Figure:
        """Draw the path of the displacement [mm] and that of the force [kN] in the plane.

        One colour for each ambient temperature; rests are left out.
        """
        self._require("orbit")
        figure, axes = drawing.panels(1, 2, (9.6, 5.2), self._title("paths in the plane"))
        for ax, (name, unit) in zip(axes, ORBITS, strict=True):
            for run, colour in enumerate(self._colours):
                drawing.draw_orbit(ax, *self.plane_path(run, name), name, unit, color=colour)
            for line in (ax.axhline, ax.axvline):
                line(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        pairs = zip(self._colours, self._run_titles(), strict=True)
        drawing.legend_below(figure, [Line2D([], [], color=c, label=t) for c, t in pairs])
        return figure

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str | None = None) -> Figure:
        """Draw stress-strain loops, one panel per ambient temperature, as Fig. 4.7.

        All panels have the same axes. Stress is the force over the gross plan area, strain the
        displacement over the total rubber thickness; rests are left out, and closing cycles grey.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Draw all temperatures into this panel instead, without closing cycles.
        label, color : str, optional
            Of what is drawn into it; the temperature and its colour by default.
        """
        self._require("loops")
        titles, count = self._run_titles(), len(self._ambient)
        paths = [self.path(run) for run in range(count)]
        if ax is not None:
            names = [label, *[""] * (count - 1)] if label else titles
            for path, name, colour in zip(paths, names, self._colours, strict=True):
                ax.plot(*path, color=color or colour, linewidth=0.8, label=name or None)
            drawing.name_axes(ax, STRAIN, STRESS)
            return drawing.parent_figure(ax)
        columns = count if count <= 3 else (count + 1) // 2
        rows = -(-count // columns)
        size = (max(5.5, 1.2 + 3.0 * columns), max(4.5, 0.7 + 3.1 * rows))
        title = self._title("shear stress-strain loops")
        figure, axes = drawing.panels(rows, columns, size, title, share=True)
        for run, (panel, colour) in enumerate(zip(axes, self._colours, strict=False)):
            panel.plot(*paths[run], color=colour, linewidth=0.8)
            panel.plot(*self.path(run, closing=True), **CLOSING_LOOK)
            for line in (panel.axhline, panel.axvline):
                line(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
            lowest, y = run + columns >= count, STRESS if run % columns == 0 else ""
            drawing.name_axes(panel, STRAIN if lowest else "", y, titles[run])
            panel.tick_params(labelbottom=lowest)
        for panel in axes[count:]:
            panel.remove()
        ends = [100.0 * self._result.tested_to(run, "strain") for run in range(count)]
        drawing.shade_untested(axes[:count], [(-end, end) for end in ends])
        if strains := {
            s["amplitude_strain"] for s in self._result.segments if s["kind"] == CLOSING
        }:
            sizes = joined(percent(strain) for strain in sorted(strains))
            label = f"closing cycles of {sizes}, which end the motion of a loading"
            drawing.legend_below(figure, [Line2D([], [], label=label, **CLOSING_LOOK)])
        return figure

    def path(self, run: int, *, closing: bool = False) -> tuple[Floats, Floats]:
        """Return strain [%] and stress [MPa] where the bearing moves, thinned.

        Those of closing cycles only, or without them.
        """
        strain, stress = 100.0 * self._data["strain"].values, self._data["stress"].values
        spans = [max(float(np.nanmax(v) - np.nanmin(v)), 1e-9) for v in (strain, stress)]
        return self._thinned(run, strain, stress, spans[0], spans[1], closing=closing)

    def plane_path(self, run: int, name: str) -> tuple[Floats, Floats]:
        """Return both components of a displacement or force where the bearing moves, thinned."""
        x, y = np.moveaxis(self._data[name].values, -1, 0)
        span = 2.0 * float(np.nanmax(self._result.magnitude(name)))
        return self._thinned(run, x, y, span, span)

    def _thinned(
        self, run: int, x: Floats, y: Floats, span_x: float, span_y: float, closing: bool = False
    ) -> tuple[Floats, Floats]:
        moving = TimeAxis(self._result)._moving_rows(run, closing=closing)
        paths = [(x[run, rows], y[run, rows]) for rows in moving]
        kept = [drawing.thin_loops(a, b, span_x, span_y) for a, b in paths]
        return _joined([(x[k], y[k]) for (x, y), k in zip(paths, kept, strict=True)])

    def measures(self) -> Figure:
        """Draw equivalent modulus [MPa] and damping ratio against strain [%], as Fig. 4.8.

        Cycles 1, 2 and 5 of each amplitude are joined by lines (the last one if there are
        fewer than five). The cycles of a recorded history are points without lines.
        """
        self._require("measures")
        cycles, shown = self._result.cycles, self._shown_cycles()
        figure, axes = drawing.panels(
            1, 2, (9.0, 4.2), self._title("equivalent modulus and damping")
        )
        for ax, name in zip(axes, ("G_eq_MPa", "h_eq"), strict=True):
            for ambient, colour in zip(self._ambient, self._colours, strict=True):
                for _, table, look in shown:
                    rows = table[table["ambient_degC"] == ambient]
                    strain = 100.0 * rows["amplitude_strain"]
                    ax.plot(strain, rows[name], **_cycle_look(*look, colour))
            drawing.name_axes(ax, quantity("amplitude_strain").label, quantity(name).label)
            ax.set_xlim(0.0, 108.0 * float(cycles["amplitude_strain"].max()))
            ax.set_ylim(0.0, 1.08 * float(cycles[name].max()))
        looks = [
            *({"color": colour, "linewidth": 3.0} for colour in self._colours),
            *(_cycle_look(*look, drawing.GREY) for _, _, look in shown),
        ]
        names = [*self._run_titles(), *(name for name, _, _ in shown)]
        handles = [Line2D([], [], label=n, **k) for n, k in zip(names, looks, strict=True)]
        drawing.legend_below(figure, handles)
        return figure

    def _shown_cycles(self) -> "list[tuple[str, pd.DataFrame, tuple[str, str]]]":
        """Return name, rows of `Result.cycles` and look of each line of `measures`."""
        cycles = self._result.cycles
        if any(about["kind"] == "recorded" for about in self._result.segments):
            return [("every cycle", cycles, POINTS)]
        last = min(int(cycles["cycle"].max()), max(SHOWN_CYCLES))
        numbers = sorted({n for n in SHOWN_CYCLES if n <= last} | {last})
        looks = zip(numbers, CYCLE_LOOKS, strict=False)
        return [(f"cycle {n}", cycles[cycles["cycle"] == n], look) for n, look in looks]

    def layer_temperatures(self) -> Figure:
        """Draw the temperature of each rubber layer in time, as Fig. 4.9.

        One panel per ambient temperature, all with the same number of kelvin. Loadings are
        drawn to scale; rests (shaded) start to scale and turn logarithmic.
        """
        self._require("layer_temperatures")
        rubber, lines = self._data["rubber_temperature"].values, self.layer_lines()
        subject = "temperature of the rubber layers"
        figure, axes = self._draw_in_time(subject, "rubber temperature [°C]", lines)
        lows = np.fmin(np.nanmin(rubber, axis=(1, 2)), self._ambient)
        highs = np.fmax(np.nanmax(rubber, axis=(1, 2)), self._ambient)
        # The same number of kelvin in each panel, so that rises can be compared.
        span = max(float(np.max(highs - lows)), 0.1)
        for ax, low in zip(axes, lows, strict=True):
            ax.set_ylim(low - 0.05 * span, low + 1.08 * span)
        return figure

    def layer_lines(self) -> list[Line]:
        """Return the temperatures of the rubber layers that are drawn, and their looks."""
        rubber, groups = self._data["rubber_temperature"].values, drawn_layers(self._result)
        colours = drawing.ordered_colours(len(groups), "viridis")
        widths = 2.0 - 1.2 * np.arange(len(groups)) / len(groups)  # where two agree, both are seen
        return [
            (rubber[:, :, j], {"color": colours[k], "label": name, "linewidth": widths[k]})
            for k, (name, j) in enumerate(groups)
        ]

    def lead_temperature(self) -> Figure:
        """Draw the temperatures of lead, innermost and outermost layer in time, as Fig. 5.8."""
        self._require("lead_temperature")
        rubber = self._data["rubber_temperature"].values
        last = "innermost" if self._data.attrs["half_stack"] else "last"
        lines: list[Line] = [
            (values, {"color": colour, "label": label, "linewidth": width})
            for values, colour, label, width in (
                (self._data["lead_temperature"].values, LEAD, "lead core", 1.6),
                (rubber[:, :, -1], INNER, f"{last} rubber layer", 1.2),
                (rubber[:, :, 0], OUTER, "outermost rubber layer", 1.2),
            )
        ]
        figure, axes = self._draw_in_time("temperature of the lead", "temperature [°C]", lines)
        for run, ax in enumerate(axes):
            tested = self._result.tested_to(run, "lead_temperature")
            drawing.mark_tested(ax, tested, "lead tested to here")
        return figure

    def force_shares(self) -> Figure:
        """Draw the forces of rubber, lead and rate-dependent branch [kN], as Fig. 5.15.

        Over the first and the last cycle of the largest amplitude.
        """
        self._require("force_shares")
        result, count = self._result, len(self._ambient)
        loaded = [n for n, about in enumerate(result.segments) if about["kind"] == "cycles"]
        largest = largest_by(loaded, lambda n: float(result.segments[n]["amplitude_strain"]))
        size = (max(6.0, 1.5 + 3.0 * count), 5.4)
        title, titles = self._title("shares of the force"), self._run_titles()
        figure, axes = drawing.panels(2, count, size, title, share=True)
        for run in range(count):
            inside = np.flatnonzero(result["segment"].values[run] == largest)
            cycles = result["cycle"].values[run, inside]
            for row, number in enumerate((1, int(cycles.max()))):
                ax = axes[row * count + run]
                shares = self._draw_shares(ax, run, inside[cycles == number])
                y = "force [kN]" if run == 0 else ""
                at_peak = f"(peak: {shares})".replace(" ", drawing.UNBROKEN)
                drawing.name_axes(ax, y=y, title=f"{titles[run]}, cycle {number} {at_peak}")
        for ax in axes[count:]:
            drawing.name_axes(ax, "time in the cycle [s]")
        handles = [Line2D([], [], label="bearing force f", **FORCE)]
        handles += [Line2D([], [], color=colour, label=label) for _, label, colour in SHARES]
        drawing.legend_below(figure, handles)
        return figure

    def _draw_shares(self, ax: Axes, run: int, rows: np.ndarray) -> str:
        """Draw all branches over one cycle; return their shares of the force at its peak."""
        time = self._result.time(run)[rows]
        force = self._data["force"].values[run, rows]
        ax.plot(time - time[0], force, **FORCE)
        peak, shares = place_of_largest(force), []
        for name, _, colour in SHARES:
            values = self._data[name].values[run, rows]
            ax.plot(time - time[0], values, color=colour, linewidth=1.3)
            shares.append(f"{values[peak] / force[peak]:.0%}")
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.6)
        return " + ".join(shares)

    def profiles(self) -> Figure:
        """Draw the temperature through the height at the end of each amplitude, as Fig. 4.10.

        Lines join the centres of the cells; bands show steel (grey) and rubber.
        """
        self._require("profiles")
        data, time, cored = self._data, TimeAxis(self._result), self._result.has_lead
        shown, panels = time._loading_ends(), []
        for run, title in enumerate(self._run_titles()):
            lines = []
            for place, (number, _) in enumerate(shown):
                inside = time._inside(run, number, number)
                if inside != NOTHING:
                    row = inside.stop - 1
                    lead = data["lead_temperature"].values[run, row] if cored else None
                    lines.append((place, data["temperature"].values[run, row], lead))
            panels.append(ProfilePanel(title, float(self._ambient[run]), data, lines))
        size = (max(5.5, 1.9 + 2.5 * len(panels)), 5.2)
        title = self._title("temperature at the end of each loading")
        return draw_profile_panels(title, size, len(panels), panels, [name for _, name in shown])

    def layer_shear(self) -> Figure:
        """Draw the displacement of each layer [mm] at the last peak of each amplitude."""
        self._require("layer_shear")
        data, time, titles = self._data, TimeAxis(self._result), self._run_titles()
        shown, count, depth = time._loading_ends(), len(titles), _layer_depths(data)
        colours = drawing.ordered_colours(len(shown), "viridis")
        size = (max(5.5, 1.9 + 2.5 * count), 5.2)
        figure, axes = drawing.panels(1, count, size, self._title("shear of the layers"))
        look: drawing.Look = {"marker": "o", "markersize": 3.5, "linewidth": 1.1}
        for run, ax in enumerate(axes):
            for (number, _), colour in zip(shown, colours, strict=True):
                rows = np.arange(time.rows[run])[time._inside(run, number, number)]
                if len(rows):
                    moved = np.abs(data["displacement"].values[run, rows])
                    # The last of equal peaks: a hold, or further cycles of the same amplitude.
                    peak = rows[np.flatnonzero(moved >= AT_PEAK * moved.max())[-1]]
                    layers = np.abs(data["layer_displacement"].values[run, peak])
                    ax.plot(layers, depth, color=colour, **look)
            draw_stack(ax, data, names=run == count - 1)
            ax.tick_params(labelleft=run == 0)
            y = "distance from the upper face [mm]" if run == 0 else ""
            drawing.name_axes(ax, "displacement of the layer [mm]", y, titles[run])
        marks = zip(shown, colours, strict=True)
        handles = [Line2D([], [], color=c, marker="o", label=name) for (_, name), c in marks]
        drawing.legend_below(figure, handles)
        return figure

    def energy(self) -> Figure:
        """Draw work, heat released, stored and lost, and recoverable energy in time [kJ].

        The titles give the residuals of the balances, relative to the work.
        """
        residuals = self._result.energy[["mechanical_residual", "thermal_residual"]].to_numpy()
        notes = [
            "; relative residual of the balance: mechanical {}, thermal {}".format(
                *map(_residual, residual_pair)
            )
            for residual_pair in residuals
        ]
        lines: list[Line] = [
            (
                KJ * self._data[name].values,
                {"color": colour, "linestyle": line, "linewidth": width}
                | {"label": quantity(f"{name}_kN_mm").head},
            )
            for name, colour, line, width in ENERGIES
        ]
        return self._draw_in_time("energy balance", "energy [kJ = kN m]", lines, notes)[0]

    def comparison(self) -> Figure:
        """Draw the errors of other models at the end of each cycle of the test.

        A row of panels for each place (outer layer, inner layer, lead) [K] and one for the peak
        stress of each cycle [%]; a column for each ambient temperature; one line per model.
        """
        self._require("comparison")
        if self._result.in_plane:
            return self._draw_plane_and_line()
        (reference, reference_result), *other_results = self._result.compared.items()
        count, rows = len(self._ambient), [*compared_places(reference_result), PEAK]
        colours = drawing.ordered_colours(len(other_results), "turbo")
        size = (max(7.0, 1.5 + 3.4 * count), 1.4 + 1.9 * len(rows))
        title = self._title(f"earlier models against the {reference} one")
        figure, axes = drawing.panels(len(rows), count, size, title)
        for line, row in enumerate(rows):
            shared = axes[line * count : (line + 1) * count]  # panels of a row, of one scale
            for ambient, ax in zip(self._ambient, shared, strict=True):
                expected = _at_cycles(reference_result, ambient, row)
                for (_, result), colour in zip(other_results, colours, strict=True):
                    values = _at_cycles(result, ambient, row)
                    expected_values = expected[: len(values)]  # those of a run that ended early
                    error = (
                        100.0 * (values / expected_values - 1.0)
                        if row == PEAK
                        else values - expected_values
                    )
                    numbers = np.arange(1, len(error) + 1)
                    ax.plot(numbers, error, color=colour, marker=".", markersize=3.5, linewidth=0.9)
                ax.axhline(0.0, color=drawing.INK, linewidth=0.8)
                head = f"ambient {drawing.degrees(ambient)}" if line == 0 else ""
                drawing.name_axes(ax, "cycle of the test" if row == PEAK else "", title=head)
            limits = drawing.common_limits(shared)
            for ax in shared:
                ax.set_ylim(*limits)
            label = f"{row} [%]" if row == PEAK else f"error of {row} [K]"
            drawing.name_axes(shared[0], y=label)
        marks = zip(other_results, colours, strict=True)
        drawing.legend_below(figure, [Line2D([], [], color=c, label=n) for (n, _), c in marks])
        return figure

    def _draw_plane_and_line(self) -> Figure:
        """Draw the temperatures in the plane and those of the test on a line [°C]."""
        compared, count = self._result.compared, len(self._ambient)
        parts = [("rubber_temperature", "warmest rubber layer", "-")]
        parts += [("lead_temperature", "lead", "--")] if self._result.has_lead else []
        title = self._title("temperatures compared with those on a line")
        figure, axes = drawing.panels(count, 1, (9.5, 1.4 + 2.4 * count), title)
        handles = []
        for run, (ax, name) in enumerate(zip(axes, self._run_titles(), strict=True)):
            for (kind, result), colour in zip(compared.items(), (INNER, OUTER), strict=True):
                time = TimeAxis(result, cut=True)
                for variable, part, line in parts:
                    look: drawing.Look = {"color": colour, "linestyle": line, "linewidth": 1.4}
                    ax.plot(*time.trace(run, _hottest(result, variable)[run]), **look)
                    if run == 0:
                        handles.append(Line2D([], [], label=f"{part}, {kind}", **look))
                if kind == "plane":
                    time.set_ticks(ax, labels=run == count - 1)
                    caption = time.caption()
            drawing.name_axes(ax, y="temperature [°C]", title=name)
        drawing.name_axes(axes[-1], caption)
        drawing.legend_below(figure, handles)
        return figure


def _hottest(result: Result, name: str) -> Floats:
    """Return the temperature of the warmest rubber layer, or of the lead, [ambient, time]."""
    values = np.asarray(result[name].values)
    return values.max(axis=-1) if name == "rubber_temperature" else values


def drawn_layers(result: Result) -> list[tuple[str, int]]:
    """Return name and index of the rubber layers to draw, one of those that are alike."""
    rubber, half = result["rubber_temperature"].values, bool(result.dataset.attrs["half_stack"])
    span = float(np.max(np.nanmax(rubber, axis=(1, 2)) - np.nanmin(rubber, axis=(1, 2))))
    return layer_groups(rubber, half, drawing.ALIKE * span)


def _at_cycles(result: Result, ambient: float, row: str) -> Floats:
    """Return the temperature at the end, or the largest stress, of each cycle."""
    names = {"lead": "lead_degC", "outer layer": "rubber1_degC", PEAK: "stress_max_MPa"}
    cycles = result.cycles[result.cycles["ambient_degC"] == ambient]
    return np.asarray(cycles[names.get(row, inner_layer(result))], dtype=float)


def _layer_depths(data: "xr.Dataset") -> Floats:
    """Return the depth of the middle of each rubber layer; of a cut one, of its half [mm]."""
    thickness = data["cell_thickness"].values
    bottom = np.cumsum(thickness)
    rubber = np.flatnonzero(data["part"].values == "rubber")
    layers = np.split(rubber, np.flatnonzero(np.diff(rubber) > 1) + 1)
    return np.array([0.5 * (bottom[c[0]] - thickness[c[0]] + bottom[c[-1]]) for c in layers])
