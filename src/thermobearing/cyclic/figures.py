"""Figures of a displacement-controlled test.

The numbers are those of `Result`; nothing is computed here but where to draw them.
"""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.cyclic.result import Result, run_name
from thermobearing.results import drawing
from thermobearing.results.drawing import INK, name_axes, panels, thin
from thermobearing.results.profiles import (
    MOST_PROFILES,
    ProfilePanel,
    draw_profile_panels,
    draw_stack,
)
from thermobearing.results.ranges import limits_passed
from thermobearing.results.time_axis import DrawnAxis, Stretch, write_above

Floats = NDArray[np.float64]
MOST_POINTS = 2000  # bins of a history across the page, about one per pixel
BOLD_LETTER = 0.0105  # mean width of a letter of a label, of the axis


class TimeAxis(DrawnAxis):
    """Where the rows of the runs of a result are drawn; with `cut`, without the long rests."""

    def __init__(self, result: Result, *, cut: bool = False) -> None:
        segment = np.asarray(result["segment"].values)
        self.kinds = [str(about["kind"]) for about in result.segments]
        self.labels = [str(about["label"]).replace("%", " %") for about in result.segments]
        self.rows = [int((numbers >= 0).sum()) for numbers in segment]  # what follows is padding
        self.times = [result.time(run)[:rows] for run, rows in enumerate(self.rows)]
        self.numbers = [numbers[:rows] for numbers, rows in zip(segment, self.rows, strict=True)]
        super().__init__(list(self._grouped()), cut=cut)

    @property
    def farthest(self) -> int:
        """The run that got farthest, for what all runs have in common."""
        ends = zip(self.numbers, self.times, strict=True)
        reached = [(int(number[-1]), float(time[-1])) for number, time in ends]
        return reached.index(max(reached))

    def inside(self, run: int, first: int, last: int) -> slice:
        """Rows of segments first to last of a run, with the row before, where they start."""
        a, b = np.searchsorted(self.numbers[run], [first, last + 1])
        return slice(max(int(a) - 1, 0), int(b)) if b > a else slice(0, 0)

    def last_row(self, run: int, segment: int) -> int | None:
        """Where a segment ended in a run; None if the run did not reach it."""
        return self.inside(run, segment, segment).stop - 1 if segment in self.numbers[run] else None

    def moving_rows(self, run: int) -> list[slice]:
        """Rows of each stretch of a run in which the bearing moves."""
        found = [self.inside(run, s.first, s.last) for s in self.stretches if not s.rest]
        return [inside for inside in found if inside != slice(0, 0)]

    def loading_ends(self, most: int) -> list[tuple[int, str]]:
        """Number and name of the segments whose end is worth a look: the loadings, if any."""
        found: list[int] = []
        for kinds in ({"cycles", "recorded"}, {"ramp"}, {"rest", "closing cycle"}):
            found = found or [i for i, kind in enumerate(self.kinds) if kind in kinds]
        names = [self.labels[i] for i in found]
        names = [
            name if names.count(name) == 1 else f"{name} (step {i + 1})"
            for i, name in zip(found, names, strict=True)
        ]
        chosen = np.unique(np.linspace(0, len(found) - 1, most).round().astype(int))
        return [(found[k], names[k]) for k in chosen]

    def _grouped(self) -> Iterator[Stretch]:
        """Stretches that any run reached, not yet placed."""
        rests = [kind == "rest" for kind in self.kinds]
        starts = [i for i, rest in enumerate(rests) if i == 0 or rest != rests[i - 1]]
        for first, after in zip(starts, [*starts[1:], len(rests)], strict=True):
            spans = [
                float(np.ptp(time[inside]))
                for run, time in enumerate(self.times)
                if (inside := self.inside(run, first, after - 1)) != slice(0, 0)
            ]
            if spans:
                yield Stretch(first, after - 1, rests[first], min(spans), max(spans))

    def trace(self, run: int, values: Floats) -> tuple[Floats, Floats]:
        """Places and thinned values of a history of a run; NaN between stretches."""
        xs, ys = [np.empty(0)], [np.empty(0)]
        for s in self.stretches:
            inside = self.inside(run, s.first, s.last)
            if inside == slice(0, 0) or (self.cut and s.shortened):
                continue
            y, time = values[inside], self.times[run][inside]
            kept = thin(y, math.ceil(MOST_POINTS * s.width / self.end))
            xs += [s.place(time[kept] - time[0]), np.array([np.nan])]
            ys += [y[kept], np.array([np.nan])]
        return np.concatenate(xs), np.concatenate(ys)

    def rows_of_panels(self, title: str, titles: list[str]) -> tuple[Figure, list[Axes]]:
        """A panel per run, one below the other, with loadings and rests marked."""
        count = len(titles)
        figure, axes = panels(count, 1, (9.5, 1.4 + 2.2 * count), title)
        for run, ax in enumerate(axes):
            self.set_ticks(ax, labels=run == count - 1)
            self.shade_rests(ax, labels=run == 0)
            if run == 0:
                self.label_loadings(ax)
            name_axes(ax, title=titles[run], pad=17.0 if ax.texts else 5.0)
        name_axes(axes[-1], self.caption())
        return figure, axes

    def label_loadings(self, ax: Axes) -> None:
        """What is imposed, above each loading that is wide enough for its label."""
        run = self.farthest
        for s in (s for s in self.stretches if not s.rest):
            start = self.times[run][self.inside(run, s.first, s.last)]
            for number in range(s.first, s.last + 1):
                time, label = self.times[run][self.inside(run, number, number)], self.labels[number]
                if self.kinds[number] not in ("cycles", "recorded") or len(time) == 0:
                    continue
                if time[-1] - time[0] > BOLD_LETTER * len(label) * self.end:
                    middle = s.left + 0.5 * (time[0] + time[-1]) - start[0]
                    write_above(ax, middle, label, INK, "bold")


# Variable, label, colour: safe for colour-blind readers.
SHARES = (
    ("rubber_force", "rubber f_r", "#0072B2"),
    ("lead_force", "lead f_l", "#555555"),
    ("viscous_force", "rate dependence f_v", "#D55E00"),
)
LEAD, INNER, OUTER = "#222222", "#D55E00", "#56B4E9"


def _draw_lead_temperature(result: Result, title: str, titles: list[str]) -> Figure:
    """Lead, innermost and outermost rubber layer in time, one panel per ambient temperature."""
    data = result.dataset
    time = TimeAxis(result)
    figure, axes = time.rows_of_panels(title, titles)
    rubber = data["rubber_temperature"].values
    for run, ax in enumerate(axes):
        rows = time.rows[run]
        for values, colour, width in (
            (data["lead_temperature"].values[run, :rows], LEAD, 1.6),
            (rubber[run, :rows, -1], INNER, 1.2),
            (rubber[run, :rows, 0], OUTER, 1.2),
        ):
            ax.plot(*time.trace(run, values), color=colour, linewidth=width)
        ax.axhline(data["ambient"].values[run], color=drawing.GREY, linewidth=0.8, linestyle=":")
        drawing.name_axes(ax, y="temperature [°C]")
        drawing.mark_tested(ax, result.tested_to(run, "lead_temperature"), "lead tested to here")
    last = "innermost" if data.attrs["half_stack"] else "last"
    handles = [
        Line2D([], [], color=colour, linewidth=1.6, label=label)
        for colour, label in (
            (LEAD, "lead core"),
            (INNER, f"{last} rubber layer"),
            (OUTER, "outermost rubber layer"),
        )
    ]
    drawing.legend_below(figure, [*handles, drawing.ambient_handle()])
    return figure


def _draw_force_shares(result: Result, title: str, titles: list[str]) -> Figure:
    """Forces of the branches over the first and the last cycle of the largest amplitude."""
    loaded = [n for n, about in enumerate(result.segments) if about["kind"] == "cycles"]
    largest = max(loaded, key=lambda n: float(result.segments[n]["amplitude_strain"]))
    ambient = result["ambient"].values
    size = (max(6.0, 1.5 + 3.0 * len(ambient)), 5.4)
    figure, axes = drawing.panels(2, len(ambient), size, title, share=True)
    for run in range(len(ambient)):
        inside = np.flatnonzero(result["segment"].values[run] == largest)
        cycles = result["cycle"].values[run, inside]
        for row, number in enumerate((1, int(cycles.max()))):
            ax = axes[row * len(ambient) + run]
            _draw_cycle(ax, result, run, inside[cycles == number])
            label = f"{titles[run]}, cycle {number}"
            drawing.name_axes(ax, title=label, y="force [kN]" if run == 0 else "")
    for ax in axes[len(ambient) :]:
        drawing.name_axes(ax, "time in the cycle [s]")
    handles = [Line2D([], [], color=colour, label=label) for _, label, colour in SHARES]
    total = Line2D(
        [], [], color=drawing.INK, linewidth=0.9, linestyle="--", label="bearing force f"
    )
    drawing.legend_below(figure, [total, *handles])
    return figure


def _draw_cycle(ax: Axes, result: Result, run: int, rows: np.ndarray) -> None:
    """All branches over one cycle, with their share of the peak force at its moment."""
    time = result.time(run)[rows]
    force = result["force"].values[run, rows]
    ax.plot(time - time[0], force, color=drawing.INK, linewidth=0.9, linestyle="--")
    peak = int(np.argmax(force))
    shares = []
    for name, _, colour in SHARES:
        values = result[name].values[run, rows]
        ax.plot(time - time[0], values, color=colour, linewidth=1.3)
        shares.append(f"{values[peak] / force[peak]:.0%}")
    told = "at the peak: " + " + ".join(shares)
    look: drawing.Look = {"fontsize": drawing.SMALL - 0.5, "color": drawing.GREY}
    ax.text(0.98, 0.95, told, ha="right", va="top", transform=ax.transAxes, **look)
    ax.axhline(0.0, color=drawing.GREY, linewidth=0.6)


X, Y = "shear strain [%]", "shear stress [MPa]"


def _draw_loops(
    result: Result, title: str, titles: Sequence[str], colours: Sequence[str]
) -> Figure:
    """A panel per run, all with the same axes; rests are left out."""
    count = len(titles)
    columns = count if count <= 3 else (count + 1) // 2
    rows = -(-count // columns)
    size = (max(5.5, 1.2 + 3.0 * columns), max(4.5, 0.7 + 3.1 * rows))
    figure, axes = drawing.panels(rows, columns, size, title, share=True)
    for run, (ax, colour) in enumerate(zip(axes, colours, strict=False)):
        ax.plot(*_path(result, run), color=colour, linewidth=0.8)
        ax.axhline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        ax.axvline(0.0, color=drawing.GREY, linewidth=0.6, zorder=1)
        drawing.name_axes(
            ax,
            X if run + columns >= count else "",
            Y if run % columns == 0 else "",
            titles[run],
        )
        ax.tick_params(labelbottom=run + columns >= count)
    for ax in axes[count:]:
        ax.remove()
    ends = [100.0 * result.tested_to(run, "strain") for run in range(count)]
    drawing.shade_untested(axes[:count], [(-end, end) for end in ends])
    return figure


def _add_loops(ax: Axes, result: Result, labels: Sequence[str], colours: Sequence[str]) -> None:
    """All runs into a panel of somebody else."""
    for run, (label, colour) in enumerate(zip(labels, colours, strict=True)):
        ax.plot(*_path(result, run), color=colour, linewidth=0.8, label=label or None)
    drawing.name_axes(ax, X, Y)


def _path(result: Result, run: int) -> tuple[Floats, Floats]:
    """Strain [%] and stress [MPa] where the bearing moves, thinned as far as nobody sees it."""
    strain, stress = 100.0 * result["strain"].values, result["stress"].values
    spans = [max(float(np.nanmax(v) - np.nanmin(v)), 1e-9) for v in (strain, stress)]
    paths = [(strain[run, rows], stress[run, rows]) for rows in TimeAxis(result).moving_rows(run)]
    return drawing.thin_paths(paths, spans[0], spans[1])


AT_PEAK = 1.0 - 1e-9  # of the largest displacement, to find its last moment


def draw_profiles(result: Result, title: str, titles: list[str]) -> Figure:
    """One panel per ambient temperature, one line per amplitude (Fig. 4.10, 5.17)."""
    data, ambient = result.dataset, result["ambient"].values
    time = TimeAxis(result)
    shown = time.loading_ends(MOST_PROFILES)
    panels = []
    for run, name in enumerate(titles):
        lines = []
        for place, (number, _) in enumerate(shown):
            row = time.last_row(run, number)
            if row is None:
                continue
            lead = float(data["lead_temperature"].values[run, row]) if result.has_lead else None
            lines.append((place, data["temperature"].values[run, row], lead))
        panels.append(ProfilePanel(name, float(ambient[run]), data, lines))
    count = len(ambient)
    size = (max(5.5, 1.9 + 2.5 * count), 5.2)
    return draw_profile_panels(title, size, count, panels, [name for _, name in shown])


def _draw_layer_shear(result: Result, title: str, titles: list[str]) -> Figure:
    """Displacement of each layer at the last peak of each amplitude, one panel a temperature."""
    data, time = result.dataset, TimeAxis(result)
    shown = time.loading_ends(MOST_PROFILES)
    colours = drawing.ordered_colours(len(shown), "viridis")
    count = len(titles)
    figure, axes = drawing.panels(1, count, (max(5.5, 1.9 + 2.5 * count), 5.2), title)
    depth = _layer_depths(data)
    for run, ax in enumerate(axes):
        for (number, _), colour in zip(shown, colours, strict=True):
            rows = np.arange(len(time.numbers[run]))[time.inside(run, number, number)]
            if len(rows):
                moved = np.abs(data["displacement"].values[run, rows])
                peak = rows[np.flatnonzero(moved >= AT_PEAK * moved.max())[-1]]
                layers = np.abs(data["layer_displacement"].values[run, peak])
                ax.plot(layers, depth, color=colour, marker="o", markersize=3.5, linewidth=1.1)
        draw_stack(ax, data, names=run == count - 1)
        ax.tick_params(labelleft=run == 0)
        y = "distance from the upper face [mm]" if run == 0 else ""
        drawing.name_axes(ax, "displacement of the layer [mm]", y, titles[run])
    marks = zip(shown, colours, strict=True)
    handles = [Line2D([], [], color=c, marker="o", label=name) for (_, name), c in marks]
    drawing.legend_below(figure, handles)
    return figure


def _layer_depths(data: xr.Dataset) -> Floats:
    """Depth of the middle of each rubber layer; of one that the half stack cuts, of its half."""
    thickness = data["cell_thickness"].values
    bottom = np.cumsum(thickness)
    rubber = np.flatnonzero(data["part"].values == "rubber")
    each = np.split(rubber, np.flatnonzero(np.diff(rubber) > 1) + 1)
    return np.array([0.5 * (bottom[c[0]] - thickness[c[0]] + bottom[c[-1]]) for c in each])


SHOWN_CYCLES = (1, 2, 5)  # of Fig. 4.8
KJ = 1e-3  # kN mm -> kN m = kJ


class NothingToDrawError(InputError):
    """The result does not hold what a figure shows."""


class Figures:
    """Figures of a result: `result.plot.loops()` and so on, each a matplotlib Figure.

    Colours go from blue (the coldest ambient temperature) to red (the warmest). The rests of
    a test are long and the loadings short: rests are cut out of, or shortened on, the axis
    of time.

    Parameters
    ----------
    result : of a displacement-controlled test.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> figure = tb.run("shen-hdr-specimen", test, ambient=23).plot.loops()
    >>> figure.savefig("loops.png")  # doctest: +SKIP
    """

    def __init__(self, result: Result) -> None:
        self._result = result
        self._data = result.dataset
        self._ambient = np.asarray(result["ambient"].values, dtype=float)
        self._colours = drawing.ambient_colours(self._ambient)

    def _title(self, what: str) -> str:
        return f"{self._data.attrs.get('title', self._result.bearing_name)}: {what}"

    def _run_title(self, run: int) -> str:
        """The ambient temperature, and what ended the run if it did not complete."""
        outcome = str(self._data["outcome"].values[run])
        ended = "" if outcome == "completed" else f" ({outcome.replace('_', ' ')})"
        rows = self._result.tested_range.to_dict("records")
        untested = "ambient" in limits_passed(rows, [run_name(self._ambient[run])])[0].split()
        told = " (not tested)" if untested else ""
        return f"ambient {drawing.degrees(self._ambient[run])}{told}{ended}"

    def _needs(self, name: str, figure: str, group: str) -> None:
        if name not in self._data:
            raise NothingToDrawError(
                f'{figure}: the result holds no {name}; run with keep=["{group}", ...]'
            )

    def displacement(self) -> Figure:
        """Imposed displacement against time, as Fig. 3.5; the rests are cut out.

        Returns
        -------
        Figure : shear displacement [mm] on the left, shear strain [%] on the right.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.displacement().axes[0].get_ylabel()
        'shear displacement [mm]'
        """
        time = TimeAxis(self._result, cut=True)
        figure, (ax,) = drawing.panels(1, 1, (9.0, 3.4), self._title("imposed displacement"))
        run = time.farthest
        ax.plot(
            *time.trace(run, self._data["displacement"].values[run]),
            color=drawing.INK,
            linewidth=0.9,
        )
        time.set_ticks(ax)
        drawing.name_axes(ax, time.caption(), "shear displacement [mm]")
        factor = 100.0 / float(self._data.attrs["total_rubber_thickness_mm"])
        strain = ax.secondary_yaxis("right", functions=drawing.scaling(factor))
        strain.set_ylabel("shear strain [%]", fontsize=drawing.NORMAL)
        strain.tick_params(labelsize=drawing.SMALL, color=drawing.GREY)
        strain.spines["right"].set_visible(False)  # the panel has one
        time.cut_out_rests(ax)
        time.label_loadings(ax)
        return figure

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str | None = None) -> Figure:
        """Stress-strain loops, one panel per ambient temperature, as Fig. 4.7.

        All panels have the same axes. Stress is the force over the gross plan area, strain the
        displacement over the total rubber thickness; rests are left out.

        Parameters
        ----------
        ax : draw all temperatures into this panel instead.
        label, color : of what is drawn into it; the temperature and its colour by default.

        Returns
        -------
        Figure : shear stress [MPa] against shear strain [%].

        Raises
        ------
        NothingToDrawError : the test only rests.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.loops().axes[0].get_xlabel()
        'shear strain [%]'
        """
        if all(about["kind"] == "rest" for about in self._result.segments):
            raise NothingToDrawError("loops: the bearing does not move in this test")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        if ax is None:
            title = self._title("shear stress-strain loops")
            return _draw_loops(self._result, title, titles, self._colours)
        labels = [label, *[""] * (len(titles) - 1)] if label else titles
        _add_loops(ax, self._result, labels, [color] * len(titles) if color else self._colours)
        return drawing.parent_figure(ax)

    def measures(self) -> Figure:
        """Equivalent shear modulus and damping ratio against strain, as Fig. 4.8.

        Cycles 1, 2 and 5 of each amplitude are joined by lines (the last one if there are
        fewer than five). The cycles of a recorded history are points without lines.

        Returns
        -------
        Figure : G_e [MPa] (Eq. 3.1) and h_eq (Eq. 3.2) against shear strain [%].

        Raises
        ------
        NothingToDrawError : no cycle was closed.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> [ax.get_ylabel() for ax in result.plot.measures().axes]
        ['equivalent shear modulus $G_e$ [MPa]', 'equivalent damping ratio $h_{eq}$ [-]']
        """
        cycles = self._result.cycles
        if len(cycles) == 0:
            raise NothingToDrawError("measures: the result has no closed cycle")
        shown = self._shown_cycles()
        figure, axes = drawing.panels(
            1, 2, (9.0, 4.2), self._title("equivalent modulus and damping")
        )
        for ax, column, label in (
            (axes[0], "G_eq_MPa", "equivalent shear modulus $G_e$ [MPa]"),
            (axes[1], "h_eq", "equivalent damping ratio $h_{eq}$ [-]"),
        ):
            for ambient, colour in zip(self._ambient, self._colours, strict=True):
                for _, table, look in shown:
                    mine = table[table["ambient_degC"] == ambient]
                    strain = 100.0 * mine["amplitude_strain"]
                    ax.plot(strain, mine[column], **drawing.cycle_look(*look, colour))
            drawing.name_axes(ax, "shear strain amplitude [%]", label)
            ax.set_xlim(0.0, 108.0 * float(cycles["amplitude_strain"].max()))
            ax.set_ylim(0.0, 1.08 * float(cycles[column].max()))
        handles = [
            Line2D([], [], color=colour, linewidth=3.0, label=self._run_title(run))
            for run, colour in enumerate(self._colours)
        ]
        handles += [
            Line2D([], [], label=name, **drawing.cycle_look(*look, drawing.GREY))
            for name, _, look in shown
        ]
        drawing.legend_below(figure, handles)
        return figure

    def _shown_cycles(self) -> list[tuple[str, pd.DataFrame, tuple[str, str]]]:
        """Name, rows of `Result.cycles` and look of each line of `measures`."""
        cycles = self._result.cycles
        if any(about["kind"] == "recorded" for about in self._result.segments):
            return [("every cycle", cycles, drawing.POINTS)]
        last = min(int(cycles["cycle"].max()), max(SHOWN_CYCLES))
        numbers = sorted({n for n in SHOWN_CYCLES if n <= last} | {last})
        return [
            (f"cycle {n}", cycles[cycles["cycle"] == n], look)
            for n, look in zip(numbers, drawing.CYCLE_LOOKS, strict=False)
        ]

    def layer_temperatures(self) -> Figure:
        """Temperature of each rubber layer in time, as Fig. 4.9.

        One panel per ambient temperature, all with the same number of kelvin. Loadings are
        drawn to scale; rests (shaded) start to scale and turn logarithmic.

        Returns
        -------
        Figure : temperature at mid-thickness of the layers [degC].

        Raises
        ------
        NothingToDrawError : layer temperatures were not kept.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.layer_temperatures().axes[0].get_ylabel()
        'rubber temperature [°C]'
        """
        self._needs("rubber_temperature", "layer_temperatures", "rubber")
        time = TimeAxis(self._result)
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        figure, axes = time.rows_of_panels(self._title("temperature of the rubber layers"), titles)
        names = drawing.layer_names(self._data.sizes["layer"], bool(self._data.attrs["half_stack"]))
        colours = drawing.ordered_colours(len(names), "plasma")
        lows, highs = [], []
        for run, ax in enumerate(axes):
            values = self._data["rubber_temperature"].values[run, : time.rows[run]]
            for j, (name, colour) in enumerate(zip(names, colours, strict=True)):
                x, y = time.trace(run, values[:, j])
                # Later layers are thinner: where two agree, both are seen.
                ax.plot(x, y, color=colour, label=name, linewidth=2.0 - 1.2 * j / len(names))
            ax.axhline(self._ambient[run], color=drawing.GREY, linewidth=0.8, linestyle=":")
            drawing.name_axes(ax, y="rubber temperature [°C]")
            lows.append(min(float(values.min()), self._ambient[run]))
            highs.append(max(float(values.max()), self._ambient[run]))
        span = max(float(np.max(np.subtract(highs, lows))), 0.1)
        for ax, low in zip(axes, lows, strict=True):
            ax.set_ylim(low - 0.05 * span, low + 1.08 * span)
        drawing.legend_below(figure, [*axes[0].get_lines()[: len(names)], drawing.ambient_handle()])
        return figure

    def profiles(self) -> Figure:
        """Temperature through the height at the end of each amplitude, as Fig. 4.10.

        Lines join the centres of the cells; bands show steel (grey) and rubber.

        Returns
        -------
        Figure : distance from the upper face [mm] against temperature [degC].

        Raises
        ------
        NothingToDrawError : cell temperatures were not kept.
        """
        self._needs("temperature", "profiles", "cells")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        title = self._title("temperature at the end of each loading")
        return draw_profiles(self._result, title, titles)

    def layer_shear(self) -> Figure:
        """Displacement of each layer at the last peak of each amplitude, as Fig. 4.1 sketches it.

        Raises
        ------
        NothingToDrawError : layer displacements were not kept (`keep`).
        """
        self._needs("layer_displacement", "layer_shear", "layer_displacement")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        return _draw_layer_shear(self._result, self._title("shear of the layers"), titles)

    def lead_temperature(self) -> Figure:
        """Temperature of the lead beside that of the innermost rubber layer, as Fig. 5.8.

        Raises
        ------
        NothingToDrawError : the bearing has no lead, or layers were not kept.
        """
        self._needs_lead("lead_temperature")
        self._needs("rubber_temperature", "lead_temperature", "rubber")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        return _draw_lead_temperature(self._result, self._title("temperature of the lead"), titles)

    def force_shares(self) -> Figure:
        """Shares of rubber, lead and rate-dependent branch in the force, as Fig. 5.15.

        Raises
        ------
        NothingToDrawError : nothing but rubber carries force, or there are no cycles.
        """
        self._needs_lead("force_shares")
        if not any(about["kind"] == "cycles" for about in self._result.segments):
            raise NothingToDrawError("force_shares: the test has no cycles")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        return _draw_force_shares(self._result, self._title("shares of the force"), titles)

    def _needs_lead(self, figure: str) -> None:
        if not self._result.has_lead:
            raise NothingToDrawError(f"{figure}: the bearing has no lead")

    def energy(self) -> Figure:
        """Where the work goes: heat released, stored and lost, and recoverable energy, in time.

        The titles give the residuals of the balances, relative to the work.

        Returns
        -------
        Figure : energies since the start [kJ = kN m].

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.energy().axes[0].get_ylabel()
        'energy [kJ = kN m]'
        """
        time = TimeAxis(self._result)
        titles = [
            f"{self._run_title(run)}; relative residual of the balance: "
            f"mechanical {drawing.residual(mechanical)}, thermal {drawing.residual(thermal)}"
            for run, (mechanical, thermal) in enumerate(
                self._result.energy[["mechanical_residual", "thermal_residual"]].to_numpy()
            )
        ]
        figure, axes = time.rows_of_panels(self._title("energy balance"), titles)
        for run, ax in enumerate(axes):
            for name, label, colour, line, width in drawing.ENERGIES:
                values = KJ * self._data[name].values[run]
                look: drawing.Look = {"color": colour, "linestyle": line, "linewidth": width}
                ax.plot(*time.trace(run, values), label=label, **look)
            drawing.name_axes(ax, y="energy [kJ = kN m]")
        drawing.legend_below(figure, axes[0].get_lines()[: len(drawing.ENERGIES)])
        return figure

    def save_all(self, directory: str | Path) -> list[Path]:
        """Write every figure the result holds data for, as PNG.

        Parameters
        ----------
        directory : where to; made if it does not exist.

        Returns
        -------
        list of the files written; figures without data are left out.

        Examples
        --------
        >>> import tempfile
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> with tempfile.TemporaryDirectory() as directory:
        ...     files = result.plot.save_all(directory)
        >>> len(files)
        6
        """
        directory = Path(directory)
        directory.mkdir(parents=True, exist_ok=True)
        written = []
        for name, draw in (
            ("imposed_displacement", self.displacement),
            ("loops", self.loops),
            ("measures", self.measures),
            ("layer_temperatures", self.layer_temperatures),
            ("lead_temperature", self.lead_temperature),
            ("force_shares", self.force_shares),
            ("profiles", self.profiles),
            ("layer_shear", self.layer_shear),
            ("energy_balance", self.energy),
        ):
            try:
                figure = draw()
            except NothingToDrawError:
                continue
            path = directory / f"{name}.png"
            drawing.save_figure(figure, path)
            written.append(path)
        return written
