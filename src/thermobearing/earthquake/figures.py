"""Figures of earthquakes: histories, loops, peaks, lines and piers, profiles, earlier models.

Rows are bearings, columns motions, colours ambient temperatures from cold (blue) to warm (red).
Of an analysis with many motions the first few are shown; the table has them all.
"""

import math
import tomllib
from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.earthquake.axial import axial_forces_change
from thermobearing.earthquake.motions import motion_targets
from thermobearing.earthquake.panels import (
    DISPLACEMENT,
    FORCE,
    LINES,
    LOOP_PANEL,
    MODES,
    MOST_COLUMNS,
    STRAIN,
    TIME_BINS,
    Cell,
    Draw,
    Panels,
    list_moments,
)
from thermobearing.earthquake.tables import COMBINATIONS
from thermobearing.quantities.governing import order_from_largest, place_of_largest
from thermobearing.quantities.register import quantity
from thermobearing.results import drawing
from thermobearing.results.profiles import draw_profile_panels

PANEL, SPEED_PANEL = (2.9, 2.4), (4.2, 2.3)  # width, height [inch]
KJ, MN_M, ENERGY = 1e-3, 1e-3, "energy [kJ]"
WIDER = 0.8  # of its width: each line that lies below another
NOTE_ROOM = 0.12  # of the height of a panel, for the values that are printed in it
THIN, THICK = 0.6, 1.7  # lines of the outer and of the innermost layer
TOTAL = ("bearing_force", "total force", "#b5b5b5")
SHARES = (
    ("rubber_force", "rubber", "#0072B2"),
    ("lead_force", "lead cores", "#000000"),
    ("viscous_force", "rate-dependent branch", "#D55E00"),
)
# The two terms of a bilinear model are no parts of the bearing: an HDR bearing has no lead.
BILINEAR = (
    ("rubber_force", "bilinear: elastic part", "#56B4E9"),
    ("lead_force", "bilinear: yielding part", "#CC79A7"),
)
PART_PANELS = (  # part, column, label
    ("line", "strain_max", "bearing strain [%]"),
    ("line", "total_force_max_kN", "force of the line [kN]"),
    ("pier", "displacement_max_mm", "pier displacement [mm]"),
    ("pier", "ductility", "pier ductility"),
)
ABOVE = 1.08  # upper end of an axis from zero, of the largest value
PART_SPREAD = 0.9  # of the room of a part that its dots take
SHOWN = {  # columns of the table of runs: label
    "bearing_strain_max": "bearing strain",
    "bearing_force_max_kN": "bearing force",
    "bearing_energy_kN_mm": "bearing energy",
    "pier_displacement_max_mm": "pier displacement",
    "pier_ductility": "pier ductility",
    "deck_acceleration_max_m_s2": "deck acceleration",
}
OF_RESULTANT = ("peaks", "parts", "energy", "temperature", "profiles", "axial_forces")  # or none
SPREAD = 0.5  # of the room of a temperature that its dots take
PEAK_COLUMNS = 3  # of quantities side by side
MEAN = 0.36  # half the length of the line at a mean


class EarthquakeFigures(Panels):
    """Figures of an analysis: `result.plot.loops()` and so on, each a matplotlib Figure.

    Lines of pseudo-dynamic tests compared with real time are dashed.
    """

    def _by_motion(
        self,
        subject: str,
        labels: tuple[str, str],
        draw: Draw,
        ax: Axes | None = None,
        *,
        strain: Literal["x", "y"] | None = None,
        sizes: str = "",
        notes: bool = False,
    ) -> tuple[Figure, list[Cell]]:
        """Return one panel per bearing and motion; `draw` is called for every run in it.

        All runs go into `ax`, and there are no panels, where it is given. `strain` is the axis
        that shows the strain [%]: beyond the tested range it is shaded. `sizes` names the
        variable whose largest run is drawn first, below the others; `notes` leaves room for values.
        """
        if ax is not None:
            for run in self._table.index:
                draw(ax, int(run))
            drawing.name_axes(ax, *labels)
            return drawing.parent_figure(ax), []
        title = self._title(subject, motions=True)
        motions = self._motions[:MOST_COLUMNS]
        figure, cells = self._grid(
            title,
            PANEL,
            self._bearings,
            motions,
            labels,
            heads=motions,
            sides=self._shown,
            share="col",
        )
        untested = []
        for panel, bearing, motion in cells:
            chosen = self._table[self._table["bearing"] == bearing]
            runs = [int(run) for run in chosen.index[chosen["motion"] == motion]]
            if sizes in self._data:  # the largest first, so that none hides a smaller one
                size = np.nan_to_num(self._data[sizes].values)
                runs = [runs[place] for place in order_from_largest(size[runs])]
            for run in runs:
                draw(panel, run)
            for place, line in enumerate(panel.get_lines()):  # equal ones remain visible
                line.set_linewidth(line.get_linewidth() * (1.0 + WIDER * (len(runs) - 1 - place)))
            untested.append(100.0 * self._result.tested_to(runs, "strain"))
            # Runs of a bilinear bearing lie on each other; the first panel of a row says why.
            is_bilinear = bool(self._data.attrs.get(f"bilinear:{bearing}", 0))
            if is_bilinear and len(runs) > 1 and motion == motions[0]:
                drawing.say_why(panel, "bilinear: the same\nat all temperatures")
        axes = [panel for panel, _, _ in cells]
        # Panels of a column share their axes: the room made in the first row is that of all.
        for panel in axes[: len(motions)] if notes else []:
            low, high = panel.get_ylim()
            panel.set_ylim(low, high + NOTE_ROOM * (high - low))
        if strain is not None:
            drawing.shade_untested(axes, [(-end, end) for end in untested], strain)
        self._legend(figure)
        return figure, cells

    def _curve(self, x: str, y: str, x_factor: float = 1.0, y_factor: float = 1.0) -> Draw:
        """Return what draws a history y against time or against another history x."""

        def _draw(ax: Axes, run: int) -> None:
            a, b = x_factor * self._values(x, run), y_factor * self._values(y, run)
            if x != "time":
                # Spans are divisors; that of a history which stays zero is zero.
                kept = drawing.thin_loops(a, b, max(np.ptp(a), 1e-12), max(np.ptp(b), 1e-12))
                width = 0.8
            elif np.isfinite(b).all():
                kept, width = drawing.thin(b, TIME_BINS), 0.7
            else:  # a bearing without this quantity, such as the lead of one without cores
                return
            look: drawing.Look = {"linewidth": width, "linestyle": self._line(run)}
            ax.plot(a[kept], b[kept], color=self._colour(run), **look)

        return _draw

    def _history(
        self,
        name: str,
        subject: str,
        y: str,
        ax: Axes | None,
        factor: float = 1.0,
        strain: Literal["y"] | None = None,
    ) -> Figure:
        """Return a history in the strong part of each motion, its peaks marked and printed."""
        draw, peaks = self._curve("time", name, y_factor=factor), f"{name}_max"
        look: drawing.Look = {"strain": strain, "sizes": peaks, "notes": True}
        title = f"{subject}, strong part of the motion"
        figure, cells = self._by_motion(title, ("time [s]", y), draw, ax, **look)
        for panel, bearing, motion in cells:
            runs = self._find_runs(bearing=bearing, motion=motion)
            panel.set_xlim(*self._strong_part(self._find_runs(motion=motion), name))
            for run in runs:
                values = factor * self._values(name, run)
                if np.isfinite(values).all():
                    place = place_of_largest(np.abs(values))
                    mark: drawing.Look = {"color": self._colour(run), "markeredgecolor": "white"}
                    time = self._values("time", run)[place]
                    panel.plot([time], [values[place]], "o", markersize=4.0, zorder=4, **mark)
            self._note(panel, "peak", runs, [factor * float(self._data[peaks][r]) for r in runs])
        return figure

    def loops(
        self,
        ax: Axes | None = None,
        *,
        label: str = "",
        color: str | None = None,
        line: str | None = None,
    ) -> Figure:
        """Return the force of one bearing against its strain, as Fig. 6.9 and 6.12.

        Parameters
        ----------
        ax : Axes, optional
            Draw all runs into this panel instead of one for each bearing and motion.
        label, color : str, optional
            Of what is drawn into it; the colours of the temperatures by default.
        line : str, optional
            Bearing line, by default that of the reported pier.
        """
        view = self._select("line", line)
        plain = view._curve("bearing_strain", "bearing_force", 100.0)

        def _draw(panel: Axes, run: int) -> None:
            plain(panel, run)
            if color:
                panel.get_lines()[-1].set_color(color)
            if label and run == 0:
                panel.get_lines()[-1].set_label(label)

        subject, sizes = "hysteresis of one bearing", "bearing_strain_max"
        return view._by_motion(subject, (STRAIN, FORCE), _draw, ax, strain="x", sizes=sizes)[0]

    def largest_loops(self) -> Figure:
        """Return the largest loop, the bearings over each other, as Fig. 4.12 and 6.6."""
        loops, motions = self._result.largest_loops, self._motions[:MOST_COLUMNS]
        colours = drawing.ordered_colours(len(self._bearings), "viridis")
        looks = dict(zip(self._bearings, colours, strict=True))
        names = dict(zip(self._bearings, self._shown, strict=True))
        title = self._of("line")._title("largest loop of one bearing", motions=True)
        sides = [f"ambient {drawing.degrees(value)}" for value in self._ambients]
        figure, cells = self._grid(
            title,
            LOOP_PANEL,
            self._ambients,
            motions,
            (DISPLACEMENT, FORCE),
            heads=motions,
            sides=sides,
            zero=True,
        )
        for ax, ambient, motion in cells:
            for run in self._find_runs(ambient_degC=ambient, motion=motion):
                loop, time = loops.loc[run], self._data["time"].values[run]
                inside = (time >= loop["start_s"]) & (time <= loop["end_s"])  # none of no loop
                x = self._data["bearing_displacement"].values[run, inside]
                y = self._data["bearing_force"].values[run, inside]
                look: drawing.Look = {"linestyle": self._line(run), "linewidth": 1.1}
                ax.plot(x, y, color=looks[loop["bearing"]], **look)
        handles = [Line2D([], [], color=c, label=names[name]) for name, c in looks.items()]
        self._legend(figure, handles)
        return figure

    def strain(self, ax: Axes | None = None, *, line: str | None = None) -> Figure:
        """Return shear strain in time, as Fig. 6.10 and 6.13; of the bearings of any `line`."""
        subject = "shear strain of the bearings"
        return self._select("line", line)._history(
            "bearing_strain", subject, STRAIN, ax, 100.0, "y"
        )

    def pier(self, ax: Axes | None = None, *, pier: str | None = None) -> Figure:
        """Return the displacement of a pier's top relative to its base, as Fig. 6.17 and 6.19."""
        view, subject = self._select("pier", pier), "pier top relative to its base"
        return view._history("pier_displacement", subject, DISPLACEMENT, ax)

    def pier_acceleration(self, ax: Axes | None = None) -> Figure:
        """Return the absolute acceleration of the pier top, as Fig. 3.27, 3.29, 4.15, 5.18."""
        view, subject = self._select("pier", None), "acceleration of the pier top"
        return view._history("pier_top_acceleration", subject, "acceleration [m/s²]", ax)

    def deck(self, ax: Axes | None = None) -> Figure:
        """Return the absolute acceleration of the deck, as Fig. 6.23 and 6.25."""
        subject = "acceleration of the deck"
        return self._of()._history("deck_acceleration", subject, "acceleration [m/s²]", ax)

    def energy(self, ax: Axes | None = None) -> Figure:
        """Return the work done on one bearing in time, as Fig. 3.25."""
        draw, labels = self._curve("time", "bearing_energy", y_factor=KJ), ("time [s]", ENERGY)
        return self._of("line")._by_motion("energy taken by one bearing", labels, draw, ax)[0]

    def hinge(self, ax: Axes | None = None, *, pier: str | None = None) -> Figure:
        """Return moment against rotation of a pier's base, as Fig. 6.21 and 6.22."""
        if self._result.in_plan:
            raise InputError('hinge: select one direction, such as result.sel(direction="x")')
        view = self._select("pier", pier)
        draw = view._curve("pier_rotation", "pier_moment", 1e3, MN_M)
        labels = "rotation [mrad]", "moment [MN m]"
        subject = "pier base (dashed: where it yields; numbers: ductility)"
        figure, cells = view._by_motion(subject, labels, draw, ax, sizes="pier_rotation_max")
        for panel, bearing, motion in cells:
            runs = view._find_runs(bearing=bearing, motion=motion)
            yield_points = [view._yield_point(run) for run in runs]
            # The hinge is the same in all runs: the first one that moved it gives the point.
            for point in [point for point in yield_points if point is not None][:1]:
                rotation, moment = 1e3 * point[0], MN_M * point[1]
                look: drawing.Look = {"color": drawing.GREY, "linewidth": 0.8, "linestyle": "--"}
                for sign in (-1.0, 1.0):
                    panel.axhline(sign * moment, zorder=1.2, **look)
                    panel.plot([sign * rotation], [sign * moment], "D", color=drawing.INK, ms=3.5)
            ductility = [float(view._data["pier_ductility"][run]) for run in runs]
            self._note(panel, "", runs, ductility)
            if max(ductility) < 1.0:
                drawing.say_why(panel, "stays elastic", (0.98, 0.12))
            panel.relim()
            low, high = panel.dataLim.intervaly  # with room above the line where it yields
            panel.set_ylim(1.08 * low, (1.08 + 2.0 * NOTE_ROOM) * high)
        return figure

    def temperature(self) -> Figure:
        """Return the rise of the rubber layers and, below, of the lead, as Fig. 3.20 and 5.16."""
        shown = dict(zip(self._bearings, self._shown, strict=True))
        rows = []  # a bearing, and its rubber or lead; without heat there is no row
        for bearing in self._bearings:
            bearing_data = self._data.isel(run=self._find_runs(bearing=bearing))
            for name in ("rubber", "lead"):
                if np.isfinite(bearing_data[f"{name}_temperature"].values).any():
                    rows.append((bearing, name))
        motions = self._motions[:MOST_COLUMNS]
        title = self._of("line")._title("rise of the temperature in one bearing", motions=True)
        # The only bearing is in the title.
        sides = [name for _, name in rows]
        if len(self._bearings) > 1:
            sides = [f"{shown[bearing]}\n{name}" for bearing, name in rows]
        figure, cells = self._grid(
            title,
            (2.9, 2.1),
            rows,
            motions,
            ("time [s]", "rise [K]"),
            heads=motions,
            sides=sides,
            share=False,
        )
        highest = {"rubber": 0.0, "lead": 0.0}
        for ax, (bearing, name), motion in cells:
            start, end = self._strong_part(self._find_runs(motion=motion))
            self._rise(ax, name, self._find_runs(bearing=bearing, motion=motion), end)
            ax.set_xlim(start, end)
            highest[name] = max(highest[name], ax.get_ylim()[1])
        for ax, (_, name), _ in cells:  # one scale for all rubber and one for all lead
            ax.set_ylim(-0.04 * highest[name], (1.0 + NOTE_ROOM) * highest[name])
        half = bool(self._data.attrs.get("half_stack", 1))
        names = ("outer layer", "innermost layer") if half else ("upper layer", "lower layer")
        widths = [
            Line2D([], [], color=drawing.GREY, linewidth=width, label=name)
            for name, width in zip(names, (THIN, THICK), strict=True)
        ]
        self._legend(figure, extra_entries=widths)
        return figure

    def _rise(self, ax: Axes, name: str, runs: list[int], end_of_panel: float) -> None:
        """Draw layers from thin (outer) to thick (innermost), or the lead, and their maxima.

        Maxima that come after the end of the panel [s] are printed with their times.
        """
        hottest, later = [], []
        for run in runs:
            time, values = self._values("time", run), self._values(f"{name}_temperature", run)
            values = values.reshape(len(time), -1)
            values = values[:, np.isfinite(values).all(axis=0)]
            rise, count = values - values[0], values.shape[1]
            for j in range(count):
                kept = drawing.thin(rise[:, j], TIME_BINS)
                inwards = (j + 1) / count if count > 1 else 0.5
                width = THIN + (THICK - THIN) * inwards
                look: drawing.Look = {"linewidth": width, "linestyle": self._line(run)}
                ax.plot(time[kept], rise[kept, j], color=self._colour(run), alpha=0.8, **look)
            hottest.append(float(values.max()) if values.size else np.nan)
            if values.size and (at := time[place_of_largest(values.max(axis=1))]) > end_of_panel:
                later.append(float(at))
            end = self._result.tested_to([run], "lead_temperature")
            if name == "lead" and np.isfinite(end):
                drawing.mark_tested(ax, end - float(values[0, 0]), "tested to here")
        texts = [f"{value:.0f}" for value in hottest]
        texts[-1] += " °C"
        drawing.note_values(ax, "hottest", texts, [self._colour(run) for run in runs])
        if later:  # at the left a rise is small and leaves room
            ends = dict.fromkeys(f"{at:.0f}" for at in (min(later), max(later)))
            look = {"fontsize": drawing.SMALLEST, "color": drawing.GREY, "va": "top"}
            note = f"hottest at {' to '.join(ends)} s"
            ax.text(0.03, 0.84, note, transform=ax.transAxes, **look)  # below that of values

    def speed(self) -> Figure:
        """Return the loading speed of the bearing on its own clock, as Fig. 3.15.

        Rows are bearings, columns modes: a slow test takes longer and has its own axes. The first
        motion; the fastest run lies below, and the largest speeds are printed.
        """
        motion = self._motions[0]
        labels = ("time in the laboratory [s]", "speed [mm/s]")
        title = self._title(f"loading speed of the specimen, {motion}")
        rows, columns = self._bearings, self._run_modes
        figure, cells = self._grid(title, SPEED_PANEL, rows, columns, labels, share="col")
        clock = "bearing_clock" if "bearing_clock" in self._data else "time"
        for ax, bearing, mode in cells:
            runs = self._find_runs(bearing=bearing, motion=motion)
            runs = [run for run in runs if self._result.modes[run] == mode]
            largest = {run: np.abs(self._values("bearing_speed", run)).max() for run in runs}
            fastest = order_from_largest(list(largest.values()))
            for place, run in enumerate(runs[k] for k in fastest):
                speed = self._values("bearing_speed", run)
                kept, width = drawing.thin(speed, TIME_BINS), 1.1 if place == 0 else 0.7
                time = self._values(clock, run)[kept]
                ax.plot(time, speed[kept], color=self._colour(run), linewidth=width)
            ax.margins(y=0.14)
            self._note(ax, "largest", runs, list(largest.values()))
            name = ", ".join(part for part in (bearing, MODES[mode]) if part)
            drawing.name_axes(ax, title=name)
            ax.title.set_fontsize(drawing.SMALL)
        self._legend(figure)
        return figure

    def shares(self) -> Figure:
        """Return shares of the force in the largest loop of the first motion, as Fig. 5.15.

        Without a closed loop the full history is drawn, and the panel states it.
        """
        used: dict[str, str] = {}

        def _draw(ax: Axes, run: int) -> None:
            time = self._data["time"].values[run]
            inside = np.isfinite(time)
            ends = [float(self._data[name][run]) for name in ("loop_start", "loop_end")]
            if np.isfinite(ends).all():
                inside &= (time >= ends[0]) & (time <= ends[1])
            else:
                look: drawing.Look = {"fontsize": drawing.SMALLEST, "color": drawing.GREY}
                note = "no closed loop: complete history"
                ax.text(0.01, 0.985, note, transform=ax.transAxes, va="top", **look)
            bilinear = self._data.attrs.get(f"bilinear:{self._data['bearing'].values[run]}", 0)
            x = self._data["bearing_displacement"].values[run][inside].astype(float)
            for name, label, colour in (TOTAL, *(BILINEAR if bilinear else SHARES)):
                y = self._data[name].values[run][inside].astype(float)
                if not y.any():  # the bearing has no such branch
                    continue
                kept = drawing.thin_loops(x, y, max(np.ptp(x), 1e-12), max(np.ptp(y), 1e-12))
                width = 2.4 if name == TOTAL[0] else 1.0
                ax.plot(x[kept], y[kept], color=colour, linewidth=width, linestyle=self._line(run))
                used[label] = colour

        subject, labels = "shares of the force in the largest loop", (DISPLACEMENT, FORCE)
        figure = self._by_bearing(subject, PANEL, labels, _draw, zero=True)
        # In this order, whichever bearing was drawn first.
        drawn = [label for _, label, _ in (TOTAL, *SHARES, *BILINEAR) if label in used]
        self._legend(figure, [Line2D([], [], color=used[label], label=label) for label in drawn])
        return figure

    def parts(self) -> Figure:
        """Return peaks of lines (strain, force) and piers (displacement, ductility).

        The bearings that are compared stand side by side at each part, with other markers; each
        has its motions from the left.
        """
        tables = {"line": self._result.lines, "pier": self._result.piers}
        tables = {part: table for part, table in tables.items() if len(table)}
        shown = [
            (part, column, label)
            for part, column, label in PART_PANELS
            if part in tables and tables[part][column].notna().any()
        ]
        names = {part: list(dict.fromkeys(table[part])) for part, table in tables.items()}
        if "pier" in names:  # the table begins with the pier of the report
            bodies = tomllib.loads(str(self._data.attrs["case"]))["structure"]["bodies"]
            place_by_body = {str(body["name"]): place for place, body in enumerate(bodies)}
            names["pier"].sort(key=lambda name: place_by_body.get(name, -1))
        motions, rows = self._motions, (len(shown) + 1) // 2
        most_parts = max(len(parts) for parts in names.values())
        size = (max(3.6, 1.0 + 0.8 * most_parts) * 2, 2.7 * rows + 0.9)
        states_order = 1 < len(motions) < 5  # more names would be longer than the figure
        order = f" (motions from the left: {', '.join(motions)})" if states_order else ""
        title = self._title(f"bearing {' and '.join(f'{part}s' for part in tables)}{order}")
        figure, axes = drawing.panels(rows, 2, size, title)
        markers = {
            name: drawing.MARKERS[k % len(drawing.MARKERS)] for k, name in enumerate(self._bearings)
        }
        offsets = np.linspace(-0.5, 0.5, len(motions) * len(markers) + 2)[1:-1] * PART_SPREAD
        for empty_panel in axes[len(shown) :]:
            empty_panel.set_visible(False)
        none: drawing.Look = {"linestyle": "none"}
        for ax, (part, column, label) in zip(axes, shown, strict=False):
            for row in tables[part].to_dict("records"):
                place = self._bearings.index(row["bearing"]) * len(motions)
                x = names[part].index(row[part]) + offsets[place + motions.index(row["motion"])]
                look = none | {"color": self._colours[row["ambient_degC"]], "markersize": 3.5}
                y = quantity(column).shown(row[column])
                ax.plot([x], [y], marker=markers[row["bearing"]], **look)
            ticks: drawing.Look = {"rotation": 30, "ha": "right", "rotation_mode": "anchor"}
            ax.set_xticks(range(len(names[part])), names[part], **ticks)
            ax.set_xlim(-0.6, len(names[part]) - 0.4)
            ax.set_ylim(0.0, ABOVE * float(ax.dataLim.y1) or 1.0)  # of equal dots too
            ax.grid(False, axis="x")
            drawing.name_axes(ax, "", label)
        handles = [
            Line2D([], [], color=c, marker="o", label=drawing.degrees(t), **none)
            for t, c in self._colours.items()
        ]
        for name, marker in markers.items() if len(markers) > 1 else ():
            handles.append(Line2D([], [], color=drawing.GREY, marker=marker, label=name, **none))
        drawing.legend_below(figure, handles)
        return figure

    def peaks(self) -> Figure:
        """Return peaks of every run, as Fig. 6.11, 6.14 to 6.16, 6.18, 6.20, 6.24 and 6.26.

        Rows are quantities, columns bearings; in a panel ambient temperatures, marks of motions.
        Lines are means over the motions; a pseudo-dynamic test has empty marks and dashed means.
        """
        table, ambients = self._table.assign(mode=self._result.modes), self._ambients
        shown = [quantity(name, head=head) for name, head in SHOWN.items()]
        shown = [item for item in shown if np.isfinite(table[item.name]).any()]
        bearings = len(self._bearings)
        # Of one bearing the quantities stand side by side, or the figure would be a narrow column.
        columns = bearings if bearings > 1 else min(PEAK_COLUMNS, len(shown))
        rows_of_panels = math.ceil(len(shown) * bearings / columns)
        panel_width = max(1.9, 0.5 * len(ambients) + 0.9)
        if bearings == 1:  # each panel has a label of its own at the side
            panel_width += 0.5
        size = (max(panel_width * columns, 4.0) + 0.8, 1.55 * rows_of_panels + 1.2)
        kinds = " and ".join(f"{kind}s" for kind in self._result.part_kinds)
        of_all = f" (largest of all {kinds})" if self._result.has_parts else ""
        figure, axes = drawing.panels(rows_of_panels, columns, size, self._title(f"peaks{of_all}"))
        for empty_panel in axes[len(shown) * bearings :]:
            empty_panel.set_visible(False)
        axes = axes[: len(shown) * bearings]
        names = [drawing.degrees(value).removesuffix(" °C") for value in ambients]
        for panel, ax in enumerate(axes):
            item, last = shown[panel // bearings], panel + columns >= len(axes)
            bearing_runs = table[table["bearing"] == self._bearings[panel % bearings]]
            for place, ambient in enumerate(ambients):
                rows = bearing_runs[bearing_runs["ambient_degC"] == ambient]
                self._dots(ax, place, rows.assign(value=item.shown(rows[item.name])))
            top = item.shown(float(np.nanmax(table[item.name])))
            ax.set_ylim(0.0, 1.2 * top or 1.0)  # a deck on the ground has no pier that moves
            if item.name == "bearing_strain_max":
                end = self._result.tested_to(list(bearing_runs.index), "strain")
                drawing.mark_tested(ax, item.shown(end), "tested to here")
            if item.name == "pier_ductility" and ax.get_ylim()[1] > 1.0:
                drawing.mark_tested(ax, 1.0, "yields")
            label = item.title if panel % bearings == 0 else ""
            drawing.name_axes(ax, "ambient [°C]" if last else "", label)
            ax.yaxis.label.set_fontsize(drawing.SMALL)
            ax.set_xticks(range(len(names)), names if last else [""] * len(names))
            ax.set_xlim(-0.6, len(names) - 0.4)
            ax.grid(False, axis="x")
        if bearings > 1:
            drawing.head_grid(axes, self._bearings, [])
        figure.align_ylabels()
        look: drawing.Look = {"color": drawing.GREY}
        motions = self._motions if len(self._motions) <= len(drawing.MARKERS) else []
        handles = [
            Line2D([], [], marker=drawing.MARKERS[k], linestyle="none", label=motion, **look)
            for k, motion in enumerate(motions)
        ]
        for mode in self._run_modes if len(self._run_modes) > 1 else [""]:
            label = f"mean, {MODES[mode]}" if mode else "mean"
            handles.append(Line2D([], [], label=label, linestyle=LINES[mode], **look))
        drawing.legend_below(figure, handles)
        return figure

    def _dots(self, ax: Axes, place: int, rows: "pd.DataFrame") -> None:
        """Draw marks of one temperature side by side by motion, and their mean for each mode."""
        offsets = np.linspace(-0.5, 0.5, len(self._motions) + 2)[1:-1] * SPREAD
        colour = self._colours[self._ambients[place]]
        for mode, mode_rows in rows.groupby("mode", sort=False):
            slow = mode == "pd"
            for row in mode_rows.to_dict("records"):
                number = self._motions.index(row["motion"])
                look: drawing.Look = {"markerfacecolor": "none" if slow else colour}
                look |= {"marker": drawing.MARKERS[number % len(drawing.MARKERS)]}
                x, y = [place + offsets[number]], [row["value"]]
                ax.plot(x, y, color=colour, markersize=4.5, linestyle="none", **look)
            line: drawing.Look = {"linewidth": 1.2, "linestyle": "--" if slow else "-"}
            ends = [place - MEAN, place + MEAN]
            ax.plot(ends, [float(mode_rows["value"].mean())] * 2, color=colour, zorder=1.5, **line)

    def profiles(self, times: Sequence[float] | None = None) -> Figure:
        """Return temperatures through the height, as Fig. 4.14 and 5.17.

        A row for each bearing that has heat, a column for each temperature; the first motion.

        Parameters
        ----------
        times : sequence of float, optional
            Since the start of the motion [s], at most 8; quarters of it by default.

        Raises
        ------
        InputError
            The analysis did not keep cells, or a time is not in it.
        """
        data, table = self._data, self._table
        if "temperature" not in data:
            hint = 'the result holds no cells; run with keep = ["rubber", "cells"]'
            raise InputError(f"profiles: {hint}")
        chosen = table[np.isfinite(data["depth"].values).any(axis=1)]
        shown = []  # the first motion, the first mode
        for label in ("motion", "mode"):
            if label in chosen:
                shown.append(str(chosen[label].iloc[0]))
                chosen = chosen[chosen[label] == shown[-1]]
        moments = list_moments(data["time"].values[chosen.index.to_numpy()], times)
        bearings = list(dict.fromkeys(chosen["bearing"]))
        chosen = chosen.sort_values("ambient_degC", kind="stable")
        drawn = [
            self._profile_panel(int(run), f"{bearing}, " if len(bearings) > 1 else "", moments)
            for bearing in bearings
            for run in chosen.index[chosen["bearing"] == bearing]
        ]
        columns = chosen["ambient_degC"].nunique()
        size = (max(5.5, 1.9 + 2.6 * columns), 0.9 + 4.0 * len(bearings))
        subject = str(data.attrs["structure"]) + (f", {bearings[0]}" if len(bearings) == 1 else "")
        title = f"{subject}: temperature through the height, {', '.join(shown)}"
        names = [f"{moment:g} s" for moment in moments]
        return draw_profile_panels(title, size, columns, drawn, names)

    def components(self) -> Figure:
        """Return peaks with two components over those with one at a time, a dot for each run.

        A row of panels for each bearing: each direction, and the resultant over the larger of both
        unidirectional peaks, over 100 % of one with 30 % of the other, and over their SRSS.
        """
        frame = self._result.components
        names = [name for name in COMBINATIONS if name in set(frame["combination"])]
        peaks = list(dict.fromkeys(frame["quantity"]))
        figure, cells = self._grid(
            self._title("two components over one at a time"),
            (2.2, 0.4 * len(peaks)),
            self._bearings,
            names,
            ("ratio", ""),
            heads=[COMBINATIONS[name] for name in names],
            sides=self._bearings,
        )
        for ax, bearing, name in cells:
            ax.axvline(1.0, color=drawing.GREY, linewidth=0.8, zorder=1)
            ratios = frame[(frame["bearing"] == bearing) & (frame["combination"] == name)]
            for row in ratios.to_dict("records"):
                # From the coldest, 0, to the warmest, 1: dots of one peak lie below each other.
                rank = self._ambients.index(row["ambient_degC"]) / max(len(self._ambients) - 1, 1)
                y = peaks.index(row["quantity"]) + SPREAD * (rank - 0.5)
                look: drawing.Look = {"color": self._colours[row["ambient_degC"]], "markersize": 3}
                ax.plot([row["two_over_one"]], [y], "o", **look)
            ax.set_yticks(range(len(peaks)), [quantity(peak).meaning for peak in peaks])
            ax.set_ylim(len(peaks) - 0.5, -0.5)
        self._legend(figure)
        return figure

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return what draws each figure that the analysis holds data for, by name of its file.

        In plan some are of the resultant, and there is one for each direction of the others.
        """
        result, figures = self._result, self._draw_one()
        if not result.directions:
            return figures
        of_all = (*OF_RESULTANT, "comparison") if result.in_plan else ()
        figures = {name: draw for name, draw in figures.items() if name in of_all}
        figures |= {"orbit": self.orbit} if result.in_plan else {}
        figures |= {"components": self.components} if len(result.components) else {}
        for direction in result.directions:
            if not result.moves_along(direction):
                continue
            direction_figures = result.sel(direction=direction).plot.draw_all()
            figures |= {
                f"{name}_{direction}": draw
                for name, draw in direction_figures.items()
                if name not in figures
            }
        return figures

    def _draw_one(self) -> dict[str, Callable[[], Figure]]:
        """Return what draws the figures of the resultant, or of one direction."""

        def _holds(name: str) -> bool:
            return name in self._data and bool(np.isfinite(self._data[name].values).any())

        compared = self._result.compared
        always = (self.loops, self.strain, self.energy)
        figures: dict[str, Callable[[], Figure]] = {
            draw.__name__: draw for draw in (*always, self.deck, self.peaks)
        }
        has_pier = self._result.has_pier
        sometimes = (
            (self.pier, has_pier),
            (self.pier_acceleration, has_pier),
            (self.parts, self._result.has_parts),
            (self.largest_loops, _holds("loop_start")),
            (self.modes, {"rt", "pd"} <= set(self._run_modes)),
            (self.hinge, _holds("pier_rotation")),
            (self.temperature, _holds("rubber_temperature")),
            (self.profiles, _holds("depth")),
            (self.shares, _holds("lead_temperature")),
            (self.axial_forces, axial_forces_change(self._data)),
            (self.speed, self._data.attrs["command"] == "hybrid"),
            (self.motion_spectra, bool(motion_targets(self._data))),
        )
        figures |= {draw.__name__: draw for draw, holds in sometimes if holds}
        if compared:
            figures["comparison"] = self.comparison
            figures["comparison_loops"] = self.comparison_loops
        return figures
