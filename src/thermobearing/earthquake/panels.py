"""Panels of figures of earthquakes: grids, parts, strong motion, paths, axial forces, models."""

import copy
from collections.abc import Callable, Sequence
from typing import Any, Literal, Self

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.lazy import xr
from thermobearing.core.records import Floats
from thermobearing.earthquake.axial import (
    axial_forces_change,
    governing_axial_line,
    valid_until,
)
from thermobearing.earthquake.earlier import INNER, SINGLE, run_keys
from thermobearing.earthquake.measures import DIRECTION, GOVERNING, MM_PER_M
from thermobearing.earthquake.motions import motion_targets
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.earlier import REFERENCE
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import quantity
from thermobearing.quantities.words import part_label
from thermobearing.results import drawing
from thermobearing.results.profiles import MOST_PROFILES, ProfilePanel
from thermobearing.structure.fields import GROUND

TIME_BINS = 900  # points of a history are thinned to two per bin
STRAIN, FORCE, DISPLACEMENT = "shear strain [%]", "force [kN]", "displacement [mm]"
FIRST, LAST = 0.05, 0.95  # of the Arias intensity
MARGIN = 0.2  # of the strong part, on both sides: the answer of the structure comes later
QUARTERS = 4
MOST_COLUMNS = 4
SPECTRUM_PERIODS, SPECTRUM_POINTS = (0.05, 5.0), 120  # of the figure of spectra [s]
TARGET_LINES = ("--", "-.", ":")
OTHER_LINES = ("-", (0, (4, 1)), (0, (2, 1)), (0, (6, 1, 1, 1)))  # of motions without a target
LINES: dict[str, Any] = {"": "-", "rt": "-", "pd": "--"}
MODES = {"": "", "rt": "real time", "pd": "pseudo-dynamic"}
MODE_LOOKS: dict[str, drawing.Look] = {
    "rt": {"color": "#CC3311"},
    "pd": {"color": "#0077BB", "linestyle": "--"},
}
Draw = Callable[[Axes, int], None]
COMPARISON_SIZE = (3.1, 2.3)  # of one panel [inch]
LOOP_PANEL = (3.0, 2.7)  # likewise
BLACK: drawing.Look = {"color": "#000000", "linewidth": 1.6}
AXIAL_PANEL = (3.4, 2.4)
AXIAL_LIMITS: dict[str, drawing.Look] = {  # in the order of the legend
    "critical load": {"color": "#a33", "linewidth": 0.9, "linestyle": (0, (6, 2, 1, 2))},
    "no axial force": {"color": drawing.INK, "linewidth": 0.9, "linestyle": "-"},
    "cavitation, 3 G A": {"color": "#a33", "linewidth": 0.9, "linestyle": (0, (1.5, 1.5))},
}
INVALID = "#f6dede"  # after a bearing has become unstable
FARTHEST_LIMIT = 2.0  # of the largest axial force: a critical load beyond that is out of the panel
OUTER, INNER_LINE = 1.1, 0.6  # widths of lines: outermost bearings, and those between
LOOP_LOOKS = {REFERENCE: BLACK, SINGLE: {"color": "#EE7733", "linewidth": 0.9}}


Cell = tuple[Axes, Any, Any]  # a panel, what its row and what its column stand for


PARTS = ("line", "pier")


def part_names(dataset: "xr.Dataset", parts: Sequence[str] = PARTS) -> str:
    """Return which line and pier tables and histories show; empty where there is one of each."""
    if "line" not in dataset.coords:
        return ""
    names = {part: str(dataset.attrs[part]) for part in parts}
    if names.get("pier") == GROUND:  # the deck has no pier
        del names["pier"]
    return ", ".join(part_label(part, name) for part, name in names.items())


def select_part(dataset: "xr.Dataset", part: str, name: str | None) -> "xr.Dataset":
    """Return the dataset with peaks and histories of one part, by default the reported one."""
    several = "line" in dataset.coords
    name = dataset.attrs.get(part) if name is None else name
    if name is None or (name == dataset.attrs.get(part) and not several):
        return dataset
    dimension = "line" if part == "line" else "pier_part"
    names = [str(label) for label in dataset[dimension].values] if several else []
    choices = names or [str(dataset.attrs.get(part, ""))]
    if name not in names:
        raise InputError(f'{part} = "{name}": no {part} has that name{nearest(str(name), choices)}')
    part_data = dataset.sel({dimension: name}, drop=True)
    if part == "pier":
        histories = ("displacement", "rotation", "moment")
        changed = {f"pier_{key}": part_data[f"pier_part_{key}"] for key in histories}
        changed |= {
            peak: part_data[part_peak]
            for peak, part_peak in GOVERNING.items()
            if peak.startswith("pier_")
        }
    else:
        # A line that does not move has no ratio of strain to displacement, and strains of NaN.
        displacement = part_data["line_displacement_max"]
        per_mm = part_data["line_strain_max"] / displacement.where(displacement > 0.0)
        changed = {
            "bearing_strain": part_data["line_displacement"] * per_mm,
            "bearing_strain_max": part_data["line_strain_max"],
            "bearing_displacement": part_data["line_displacement"],
            "bearing_force": part_data["line_force"],
        }
    # Without coordinates, which would have to agree with those of the dataset.
    kept = {key: value.variable for key, value in changed.items()}
    return dataset.assign(kept).assign_attrs({part: name})


def list_moments(time: Floats, times: Sequence[float] | None) -> list[float]:
    """Return the given times, or quarters of the longest run [s]."""
    longest = float(np.nanmax(time))
    if times is None:
        return [longest * (k + 1) / QUARTERS for k in range(QUARTERS)]
    faults = [f"times: {t} s is not in 0 to {longest:g} s" for t in times if not 0 <= t <= longest]
    if not 1 <= len(times) <= MOST_PROFILES:
        faults.append(f"times: {len(times)} given; 1 to {MOST_PROFILES} can be shown")
    if faults:
        raise InputError(faults, "profiles()")
    return [float(t) for t in times]


class Panels(drawing.Figures):
    """Base of the figures: panels of runs, and comparisons of models."""

    def __init__(self, result: EarthquakeResult) -> None:
        self._result, self._data = result, result.resultant.dataset
        self._table = result.table
        self._bearings = list(dict.fromkeys(self._table["bearing"]))
        self._shown = self._bearings_of_line()
        self._motions = list(dict.fromkeys(self._table["motion"]))
        self._ambients = sorted(set(self._table["ambient_degC"]))
        colours = drawing.ambient_colours(np.array(self._ambients, dtype=float))
        self._colours = dict(zip(self._ambients, colours, strict=True))
        self._run_modes = list(dict.fromkeys(result.modes))
        self._parts: Sequence[str] = PARTS  # that titles name

    def _title(self, subject: str, motions: bool = False) -> str:
        """Return the title of a figure, with the bearing and the motion where there is one.

        With `motions` it also states how many of them are shown, and parts.
        """
        count = min(len(self._motions), MOST_COLUMNS)
        several = motions and count < len(self._motions)
        remarks = []
        if several:
            remarks.append(f" (first {count} of {len(self._motions)} motions)")
        if motions and (parts := part_names(self._data, self._parts)):
            remarks.append(f" ({parts})")
        direction = self._data.attrs.get(DIRECTION, "")
        labels = self._result.bearing_labels
        of_line = motions and "line" in self._parts
        bearings = self._shown if of_line else self._bearings
        if not of_line and any(name != label for name, label in labels.items()):
            bearings = []  # several on one bridge: the caption and the tables name them
        names = [entries[0] for entries in (bearings, self._motions) if len(entries) == 1]
        place = ", ".join(filter(None, [str(self._data.attrs["structure"]), str(direction)]))
        title = f"{place}: {subject}{''.join(remarks)}"
        return ", ".join([title, *(name for name in names if name not in subject)])

    def _bearings_of_line(self) -> list[str]:
        """Return the bearing of the line whose histories are shown, by bearing of the analysis."""
        line, lines = str(self._data.attrs.get("line", "")), self._result.line_bearings
        return [lines.get(name, {}).get(line, name) for name in self._bearings]

    def _of(self, *parts: str) -> Self:
        """Return these figures with titles that name some parts only."""
        view = copy.copy(self)
        view._parts = parts
        return view

    def _select(self, part: str, name: str | None) -> Self:
        """Return the figures of one line or pier, by default the reported one."""
        view = self._of(part)
        view._data = select_part(self._data, part, name)
        view._result = EarthquakeResult(view._data)
        view._shown = view._bearings_of_line()
        return view

    def _values(self, name: str, run: int) -> Floats:
        """Return a history of a run as far as it goes."""
        values = self._data[name].values[run]
        return np.asarray(values[np.isfinite(self._data["time"].values[run])], dtype=float)

    def _find_runs(self, **labels: Any) -> list[int]:
        """Return the runs with some labels (columns of the table), from cold to warm."""
        frame = self._table
        for name, value in labels.items():
            frame = frame[frame[name] == value]
        return [int(run) for run in frame.sort_values("ambient_degC", kind="stable").index]

    def _colour(self, run: int) -> str:
        return str(self._colours[self._table["ambient_degC"][run]])

    def _line(self, run: int) -> Any:
        return LINES[self._result.modes[run]] if len(self._run_modes) > 1 else "-"

    def _legend(
        self,
        figure: Figure,
        entries: list[Line2D] | None = None,
        extra_entries: Sequence[Line2D] = (),
    ) -> None:
        """Add a legend: ambient temperatures or other entries, and several modes."""
        drawing.legend_below(figure, self._handles(entries, extra_entries))

    def _handles(
        self, entries: list[Line2D] | None = None, extra_entries: Sequence[Line2D] = ()
    ) -> list[Line2D]:
        """Return the entries of a legend, by default ambient temperatures and several modes."""
        handles = entries or [
            Line2D([], [], color=colour, label=f"ambient {drawing.degrees(value)}")
            for value, colour in self._colours.items()
        ]
        handles = [*handles, *extra_entries]
        for mode in self._run_modes if len(self._run_modes) > 1 else []:
            look: drawing.Look = {"linestyle": LINES[mode], "label": MODES[mode]}
            handles.append(Line2D([], [], color=drawing.GREY, **look))
        return handles

    def _note(self, ax: Axes, name: str, runs: list[int], values: Sequence[float]) -> None:
        texts = [f"{value:.3g}" for value in values]
        drawing.note_values(ax, name, texts, [self._colour(run) for run in runs])

    def _by_bearing(
        self,
        subject: str,
        size: tuple[float, float],
        labels: tuple[str, str],
        draw: Draw,
        *,
        share: bool = True,
        zero: bool = False,
    ) -> Figure:
        """Return the runs of the first motion: rows are bearings, columns ambient temperatures."""
        motion = self._motions[0]
        heads = [f"ambient {drawing.degrees(value)}" for value in self._ambients]
        # The grid leaves out the head of a single column.
        only_head = heads if len(heads) == 1 else []
        title = self._title(", ".join([subject, motion, *only_head]))
        figure, cells = self._grid(
            title,
            size,
            self._bearings,
            self._ambients,
            labels,
            heads=heads,
            sides=self._shown,
            share=share,
            zero=zero,
        )
        for ax, bearing, ambient in cells:
            for run in self._find_runs(bearing=bearing, ambient_degC=ambient, motion=motion):
                draw(ax, run)
        return figure

    def _grid(
        self,
        title: str,
        size: tuple[float, float],
        rows: Sequence[Any],
        columns: Sequence[Any],
        labels: tuple[str, str],
        *,
        heads: list[str] | None = None,
        sides: list[str] | None = None,
        share: bool | Literal["row", "col"] = True,
        zero: bool = False,
    ) -> tuple[Figure, list[Cell]]:
        """Return a figure and its panels, each with what its row and its column stand for.

        The only name of a column or row is left out; the title has it.
        """
        count = len(columns)
        if heads is not None and len(heads) == 1:
            heads = [""] * count
        if sides is not None and len(sides) == 1:
            sides = [""] * count
        inches = (max(size[0] * count, 5.0) + 0.6, size[1] * len(rows) + 1.0)
        figure, axes = drawing.panels(len(rows), count, inches, title, share=share)
        for k, ax in enumerate(axes):
            last, first = k // count == len(rows) - 1, k % count == 0
            drawing.name_axes(ax, labels[0] if last else "", labels[1] if first else "")
            for line in (ax.axhline, ax.axvline) if zero else ():
                line(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        if heads is not None:
            drawing.head_grid(axes, heads, sides or [])
        return figure, [(ax, rows[k // count], columns[k % count]) for k, ax in enumerate(axes)]

    def _strong_part(self, runs: Sequence[int], name: str = "") -> tuple[float, float]:
        """Return start and end [s] of what is shown of some runs of one motion.

        From 5 to 95 % of the Arias intensity and a fifth more on both sides, with the largest value
        of the history `name`; the full time without a ground acceleration.
        """
        data = self._data
        starts, ends, lasts = [], [], []
        for run in runs:
            time = data["time"].values[run].astype(float)
            kept = np.isfinite(time)
            time, ground = time[kept], data["ground_acceleration"].values[run][kept].astype(float)
            if not len(time):
                continue
            growth = np.cumsum(ground**2)  # the Arias intensity but for a factor
            first, last = time[0], time[-1]
            if growth[-1] > 0.0:
                first, last = time[np.searchsorted(growth, [FIRST * growth[-1], LAST * growth[-1]])]
            room = MARGIN * (last - first)
            values = data[name].values[run][kept] if name else ground[:0]
            is_complete = bool(name) and np.isfinite(values).all()
            largest_at = [time[place_of_largest(np.abs(values))]] if is_complete else []
            starts += [place - room for place in [first, *largest_at]]
            ends += [place + room for place in [last, *largest_at]]
            lasts.append(time[-1])
        if not lasts:
            return 0.0, 1.0
        return max(0.0, min(starts)), min(max(lasts), max(ends))

    def _yield_point(self, run: int) -> tuple[float, float] | None:
        """Return rotation [rad] and moment [kN m] at the first yielding of the hinge, if any."""
        data = self._data
        ductility = float(data["pier_ductility"][run])
        if not np.isfinite(ductility) or ductility <= 0.0:
            return None
        # The ductility is the largest rotation over that at yield. Until the hinge yields, the
        # moment is linear in the rotation: the largest elastic point extends to the yield point.
        rotation = float(data["pier_rotation_max"][run]) / ductility
        path = data["pier_rotation"].values[run].astype(float)
        path = path[np.isfinite(path)]
        beyond = np.abs(path) > rotation
        elastic = slice(0, int(beyond.argmax()) if beyond.any() else len(path))
        place = place_of_largest(np.abs(path[elastic])) if len(path[elastic]) else 0
        if not path[place]:
            return None
        return rotation, rotation * float(data["pier_moment"][run, place]) / path[place]

    def _profile_panel(self, run: int, prefix: str, moments: list[float]) -> ProfilePanel:
        """Return profiles of one run at the kept steps nearest to the times."""
        data = self._data
        run_data = data.isel(run=run)
        time = run_data["time"].values
        stack = run_data.isel(cell=np.isfinite(run_data["depth"].values))
        stack.attrs["half_stack"] = data.attrs["half_stack"]
        lead = run_data["lead_temperature"].values
        lines: list[tuple[int, Floats, float | None]] = []
        for number, moment in enumerate(moments):
            if moment > np.nanmax(time) * (1.0 + 1e-6):  # a run that ended early
                continue
            row = int(np.nanargmin(np.abs(time - moment)))
            core = float(lead[row]) if np.isfinite(lead[row]) else None
            lines.append((number, stack["temperature"].values[row].astype(float), core))
        ambient = float(run_data["ambient"])
        return ProfilePanel(f"{prefix}{drawing.degrees(ambient)}", ambient, stack, lines)

    def motion_spectra(self) -> Figure:
        """Return response spectra of all motions as run, and the spectra that some are to fit.

        Motions that were not made to fit a spectrum are grey. Of a structure in plan, those of the
        motions along the bridge.
        """
        targets = motion_targets(self._data)
        data = self._result.dataset
        title = f"{data.attrs['structure']}: response spectra of the ground motions, 5 % damping"
        figure, (ax,) = drawing.panels(1, 1, (6.4, 4.0), title)
        periods = np.geomspace(*SPECTRUM_PERIODS, SPECTRUM_POINTS)
        colours = drawing.ordered_colours(len(targets), "viridis")
        # Grey lines of records are told apart by their dashes, as far as there are some.
        others = [name for name in self._motions if name not in targets]
        looks: dict[str, drawing.Look] = {
            name: {"color": drawing.GREY, "linestyle": OTHER_LINES[place % len(OTHER_LINES)]}
            for place, name in enumerate(others)
        }
        looks |= {name: {"color": c} for name, c in zip(targets, colours, strict=True)}
        handles = []
        for name, look in looks.items():
            run = self._find_runs(motion=name)[0]
            time = data["time"].values[run].astype(float)
            count = int(np.isfinite(time).sum())
            ground = data["ground_acceleration"].values[run, :count].astype(float) * MM_PER_M
            ground = ground if ground.ndim == 1 else ground[:, 0]
            motion = GroundMotion(name, float(time[count - 1]) / (count - 1), ground)
            values = response_spectrum(motion, periods).acceleration / MM_PER_M
            handles += ax.plot(periods, values, linewidth=1.0, label=name, **look)
        distinct = {str(target.spectrum): target.spectrum for target in targets.values()}
        for place, spectrum in enumerate(distinct.values()):
            label = spectrum.words.removeprefix("the ")
            values = spectrum.at(periods) / MM_PER_M
            target_look: drawing.Look = {"color": drawing.INK, "linestyle": TARGET_LINES[place % 3]}
            handles += ax.plot(periods, values, linewidth=1.8, label=label, **target_look)
        ax.set_xscale("log")
        ax.set_xlim(*SPECTRUM_PERIODS)
        ax.set_ylim(bottom=0.0)
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        drawing.name_axes(ax, "period [s]", "acceleration [m/s²]")
        drawing.legend_below(figure, handles)
        return figure

    def orbit(self) -> Figure:
        """Return the paths of displacement and force of one bearing in plan.

        They lie below each other, or side by side where there is one motion.
        """
        view, data = self._of("line"), self._result.dataset
        view._data = data  # with both directions
        names = (("bearing_displacement", "displacement"), ("bearing_force", "force"))
        motions, sides = self._motions[:MOST_COLUMNS], self._shown
        rows: list[tuple[str, ...]] = [(bearing,) for bearing in self._bearings]
        columns: list[tuple[str, ...]] = [(motion,) for motion in motions]
        if len(motions) > 1:
            rows = [(*row, *name) for row in rows for name in names]
            sides = [f"{bearing}\n{label}" for bearing in self._shown for _, label in names]
        else:
            columns = [(*name, *motions) for name in names]
        title = view._title("paths of one bearing in plan", motions=True)
        figure, cells = self._grid(
            title,
            LOOP_PANEL,
            rows,
            columns,
            ("", ""),
            heads=motions,
            sides=sides,
            share=False,
            zero=True,
        )
        for ax, row, column in cells:
            # The variable and its label are at the end of the row or at the start of the column.
            bearing, name, label, motion = row + column
            for run in self._find_runs(bearing=bearing, motion=motion):
                kept = np.isfinite(data["time"].values[run])
                x, y = data[name].values[run, kept, :2].astype(float).T
                span = max(np.ptp([x, y]), 1e-12)  # of both axes, which have the same scale
                thin = drawing.thin_loops(x, y, span, span)
                look = {"color": self._colour(run)}
                drawing.draw_orbit(ax, x[thin], y[thin], label, quantity(name).unit, **look)
        self._legend(figure)
        return figure

    def modes(self) -> Figure:
        """Return loops of the specimen in both modes, as Fig. 3.16 to 3.19."""

        def _draw(ax: Axes, run: int) -> None:
            strain = 100.0 * self._values("bearing_strain", run)
            look = MODE_LOOKS[self._result.modes[run]]
            ax.plot(strain, self._values("bearing_force", run), linewidth=0.9, **look)

        subject = "real time over pseudo-dynamic"
        figure = self._by_bearing(subject, LOOP_PANEL, (STRAIN, FORCE), _draw)
        handles = [Line2D([], [], label=MODES[k], **look) for k, look in MODE_LOOKS.items()]
        drawing.legend_below(figure, handles)
        return figure

    def axial_forces(self, *, line: str | None = None) -> Figure:
        """Return axial forces of the bearings of a line, with the limits that they have.

        A row for the coldest and for the warmest ambient temperature, a column for each motion.

        Parameters
        ----------
        line : str, optional
            Bearing line, by default that with a bearing nearest to a limit.

        Raises
        ------
        InputError
            Axial forces do not change in time, or no such line has them.
        """
        if not axial_forces_change(self._data):
            hint = 'analysis.axial = "overturning" or "vertical" lets them'
            raise InputError(f"axial_forces: axial forces do not change in time; {hint}")
        names = [str(name) for name in self._data["axial_line"].values]
        line = governing_axial_line(self._result) if line is None else line
        if line not in names:
            reason = "no line with axial forces has that name"
            raise InputError(f'line = "{line}": {reason}{nearest(line, names)}')
        motions = self._motions[:MOST_COLUMNS]
        ends = list(dict.fromkeys([self._ambients[0], self._ambients[-1]]))
        rows = [(bearing, ambient) for bearing in self._bearings for ambient in ends]
        sides = [f"ambient {drawing.degrees(ambient)}" for _, ambient in rows]
        if len(self._bearings) > 1:
            sides = [f"{bearing}\n{side}" for (bearing, _), side in zip(rows, sides, strict=True)]
        only = f", {sides[0]}" if len(rows) == 1 else ""
        view = self._of()
        view._data = self._data.assign_attrs({DIRECTION: ""})  # an axial force has none
        title = view._title(f"axial forces of line {line}{only}", motions=True)
        labels = ("time [s]", "axial force [kN]")
        figure, cells = self._grid(
            title, AXIAL_PANEL, rows, motions, labels, heads=motions, sides=sides, share="col"
        )
        drawn: dict[str, Artist] = {}
        for ax, (bearing, ambient), motion in cells:
            for run in self._find_runs(bearing=bearing, ambient_degC=ambient, motion=motion):
                drawn |= self._axial_panel(ax, run, line, names.index(line))
        order = [label for label in drawn if label not in AXIAL_LIMITS]
        order += [label for label in AXIAL_LIMITS if label in drawn]
        drawing.legend_below(figure, [drawn[label] for label in order])
        return figure

    def _axial_panel(self, ax: Axes, run: int, line: str, place: int) -> dict[str, Artist]:
        """Draw the axial forces of a run, and their limits; return what the legend needs."""
        data, time = self._data, self._values("time", run)
        chosen = np.flatnonzero(data["support"].values == line)
        forces = data["axial_force"].values[run, : len(time), chosen].astype(float)
        drawn: dict[str, Artist] = {}
        colours = drawing.ordered_colours(len(forces), "viridis")
        for number, (force, colour) in enumerate(zip(forces, colours, strict=True), 1):
            kept = drawing.thin(force, TIME_BINS)
            width = OUTER if number in (1, len(forces)) else INNER_LINE
            look: drawing.Look = {"color": colour, "linewidth": width}
            drawn[f"bearing {number}"] = Line2D([], [], label=f"bearing {number}", **look)
            # Outermost bearings, whose lines are wide, lie above the others.
            ax.plot(time[kept], force[kept], zorder=2.0 + 0.1 * width, **look)
        limits = {"no axial force": np.zeros(len(time))}
        limits["critical load"] = data["critical_load"].values[run, : len(time), place]
        limits["cavitation, 3 G A"] = -data["cavitation_force"].values[run, : len(time), place]
        if (nearest_limit := limits["critical load"].min()) > FARTHEST_LIMIT * forces.max():
            del limits["critical load"]
            drawing.say_why(ax, f"critical load: at least {nearest_limit:.0f} kN", (0.98, 0.98))
        for label, values in limits.items():
            if np.isfinite(values).all():
                kept = drawing.thin(values, TIME_BINS)
                ax.plot(time[kept], values[kept], zorder=1.8, **AXIAL_LIMITS[label])
                drawn[label] = Line2D([], [], label=label, **AXIAL_LIMITS[label])
        low, high = self._strong_part([run])
        extremes = time[[int(forces.max(axis=0).argmax()), int(forces.min(axis=0).argmin())]]
        ax.set_xlim(min(low, extremes.min()), max(high, extremes.max()))
        first = valid_until(self._result)[run]
        if np.isfinite(first):
            ax.axvspan(first, time[-1], color=INVALID, zorder=0.5)
            drawn["no results: unstable"] = Patch(color=INVALID, label="no results: unstable")
        return drawn

    def comparison(self) -> Figure:
        """Return the inner layer in time, all models over each other (Fig. 4.13, 5.16)."""
        results = self._result.compared
        names = [name for name in results if name != REFERENCE]
        colours = drawing.ordered_colours(len(names), "turbo")
        looks = {REFERENCE: BLACK} | {
            name: {"color": colour, "linewidth": 0.9}
            for name, colour in zip(names, colours, strict=True)
        }

        def _draw(ax: Axes, name: str, run: int) -> None:
            values = results[name].places(run)[INNER]
            time = results[name]["time"].values[run][: len(values)]
            kept = drawing.thin(values, TIME_BINS)
            ax.plot(time[kept], values[kept], **looks[name])

        subject = "temperature of the inner layer"
        return self._compare(looks, _draw, subject, ("time [s]", "temperature [°C]"), share=False)

    def comparison_loops(self) -> Figure:
        """Return loops of multi-layer and single-temperature model (Fig. 4.11, 5.9, 5.12)."""
        return self._compare_single("loops", ("bearing_strain", "bearing_force"), (STRAIN, FORCE))

    def comparison_strains(self) -> Figure:
        """Return strains of the multi-layer and the single-temperature model (Fig. 5.10, 5.13)."""
        return self._compare_single("strain", ("time", "bearing_strain"), ("time [s]", STRAIN))

    def _compare_single(
        self, subject: str, names: tuple[str, str], labels: tuple[str, str]
    ) -> Figure:
        """Return the multi-layer model and a single temperature in the plane of two histories."""

        def _draw(ax: Axes, name: str, run: int) -> None:
            data = self._result.compared[name].dataset
            kept = np.isfinite(data["time"].values[run])
            path = (
                quantity(variable).shown(data[variable].values[run, kept].astype(float))
                for variable in names
            )
            ax.plot(*path, **LOOP_LOOKS[name])

        return self._compare(LOOP_LOOKS, _draw, f"{subject} of one bearing", labels)

    def _compare(
        self,
        looks: dict[str, drawing.Look],
        draw: Callable[[Axes, str, int], None],
        subject: str,
        labels: tuple[str, str],
        share: bool = True,
    ) -> Figure:
        """Return a row for each bearing, a column for each temperature; `draw` draws each model."""
        runs = {name: run_keys(self._result.compared[name]) for name in looks}
        panels = type(self)(self._result.compared[REFERENCE])  # without bilinear bearings
        keys, modes = list(runs[REFERENCE]), panels._result.modes

        def _draw_models(ax: Axes, run: int) -> None:
            for name in looks if modes[run] == modes[0] else ():
                if keys[run] in runs[name]:
                    draw(ax, name, runs[name][keys[run]])

        subject = f"{subject}, {modes[0]}" if modes[0] else subject
        figure = panels._by_bearing(subject, COMPARISON_SIZE, labels, _draw_models, share=share)
        drawing.legend_below(figure, [Line2D([], [], label=k, **look) for k, look in looks.items()])
        return figure
