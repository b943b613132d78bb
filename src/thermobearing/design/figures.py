"""What a designer looks at: rounds of the loop, bounds, temperature factors, the size effect."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.border.errors import InputError
from thermobearing.cyclic.result import Result
from thermobearing.design.bounds import DEMANDS, least_safe
from thermobearing.design.published import FOOTNOTE, published_tables
from thermobearing.design.result import BoundsReport, Design, FactorReport
from thermobearing.results import drawing

Floats = NDArray[np.float64]

BAND = "#e1e4e8"
BAR = 0.5  # width, of the distance between two motions
UNSAFE_RED = "#aa0000"
RATIO = "envelope of the bounds over the coupled model"
EDGES = {  # column of the table: the bearing it belongs to, its colour
    "lower_bound": ("warmest", "#f0a08c"),
    "upper_bound": ("coldest", "#8cbfe0"),
}
LOOPS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7")
LOOKS = {
    "first": ("#0072B2", "first cycle"),
    "heated": ("#D55E00", "with self-heating"),
    "mean": ("#009E73", "mean of the cycles"),
}
OTHERS = ("#333333", "#777777")  # greys of other sources; markers tell them apart
DOTTED = {"markerfacecolor": "white", "markersize": 4.0, "linestyle": ":", "linewidth": 1.0}
ACROSS = 3  # panels of factors beside each other
PARTS: dict[str, Any] = {"inner layer": "-", "outer layer": "--", "lead": ":"}


class DesignFigures:
    """Figures of a design: `design.plot.rounds()`, `.equal()`.

    Parameters
    ----------
    design : from `run_design`.

    Examples
    --------
    >>> from thermobearing.design.case import make_design_case
    >>> from thermobearing.design.run import run_design
    >>> case = make_design_case({"tolerance": 0.1}, "example", motions=["jra-ii-i-1"])
    >>> design = run_design(case)
    >>> len(DesignFigures(design).rounds().axes)
    1
    """

    def __init__(self, design: Design) -> None:
        self._design = design

    def rounds(self) -> Figure:
        """Assumed and found displacement, round by round, a panel for each group of lines."""
        design = self._design
        title = f"{design.case.structure.name}: design loop"
        count = len(design.taken)
        figure, axes = drawing.panels(1, count, (6.5 if count == 1 else 4.2 * count, 3.6), title)
        for ax, turn, bearing in zip(axes, design.taken, design.bearings, strict=True):
            mine = [one.row() for one in design.rounds if one.group == turn.group]
            numbers = [row["round"] for row in mine]
            for column, name, colour, marker in (
                ("u_B_assumed_mm", "assumed", "#0072B2", "o"),
                ("u_found_mm", "found", "#D55E00", "s"),
            ):
                values = [row[column] for row in mine]
                ax.plot(numbers, values, color=colour, marker=marker, linewidth=1.2, label=name)
            ax.set_xticks(numbers)
            end = (calibration_ranges(bearing) or {})["strain"][1] * bearing.total_rubber_thickness
            if turn.found > end:
                drawing.mark_tested(ax, end, "the curves end here")
            drawing.name_axes(ax, "round", "displacement of the bearing [mm]", turn.group)
        axes[0].legend(fontsize=drawing.SMALL, frameon=False)
        return figure

    def equal(self) -> Figure:
        """Loops of the bilinear bearing and the layered ones of its stiffness, as Fig. 6.6."""
        title = f"{self._design.case.structure.name}: bearings of equal stiffness, 23 degC"
        groups = self._design.loops
        size = (6.0 if len(groups) == 1 else 4.8 * len(groups), 4.4)
        figure, axes = drawing.panels(1, len(groups), size, title)
        for ax, (group, loops) in zip(axes, groups.items(), strict=True):
            for (name, (x, force)), colour in zip(loops.items(), LOOPS, strict=False):
                ax.plot(x, force, color=colour, linewidth=1.3, label=name)
            drawing.name_axes(ax, "displacement [mm]", "force [kN]", group)
            ax.legend(fontsize=drawing.SMALL, frameon=False)
        return figure

    def save_all(self, folder: Path) -> list[Path]:
        """Every figure, as PNG.

        Parameters
        ----------
        folder : where to; made if it does not exist.

        Returns
        -------
        list of the files written.
        """
        figures = {"rounds": self.rounds, "equal": self.equal}
        return drawing.save_figures(figures, folder, vector=True)


class BoundsFigures:
    """Figures of bounding analyses: `report.plot.demands(name)`.

    Parameters
    ----------
    report : from `run_bounds`.

    Examples
    --------
    >>> from thermobearing.design.run import run_bounds
    >>> report = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0])
    >>> len(BoundsFigures(report).demands("shen-hdr-bridge").axes)
    4
    """

    def __init__(self, report: BoundsReport) -> None:
        self._report = report

    def demands(self, name: str) -> Figure:
        """Bars between the bounds of a bearing, dots of the coupled model.

        Parameters
        ----------
        name : of one of the bearings.

        Returns
        -------
        Figure
        """
        on = self._report.structure
        title = f"{name} on {on}: bilinear bounds (bars) and coupled model (dots)"
        return draw_bounds(self._report.tables[name], title)

    def save_all(self, folder: Path) -> list[Path]:
        """A figure for each bearing, as PNG.

        Parameters
        ----------
        folder : where to; made if it does not exist.

        Returns
        -------
        list of the files written.
        """
        figures = {f"bounds-{n}": partial(self.demands, n) for n in self._report.tables}
        return drawing.save_figures(figures, folder, vector=True)


class FactorFigures:
    """Figures of temperature factors: `report.plot.factors()`, `.sizes()`.

    Parameters
    ----------
    report : from `run_factors`.

    Examples
    --------
    >>> from thermobearing.design.run import run_factors
    >>> report = run_factors(["shen-hdr-bridge"], temperatures=[-20.0], strains=[1.0])
    >>> len(FactorFigures(report).factors().axes)  # five quantities and the legend
    6
    """

    def __init__(self, report: FactorReport) -> None:
        self._report = report

    def factors(self) -> Figure:
        """One panel per quantity at the largest strain, the legend in a free one.

        Bands where the table has them; published factors dotted, at their own reference
        temperature; a footnote marks those of which no source was read.
        """
        report = self._report
        what = f"temperature factors, {report.motion}, strain {report.strain:.0%}"
        rows = report.table[report.table["strain"] == report.strain]
        quantities = list(dict.fromkeys(report.table["quantity"]))
        down = -(-(len(quantities) + 1) // ACROSS)  # with room for the legend
        size = (3.5 * ACROSS, 0.5 + 3.1 * down)
        figure, axes = drawing.panels(down, ACROSS, size, f"{report.name}: {what}")
        looks = _published_looks(quantities)
        shown, free = axes[: len(quantities)], axes[len(quantities) :]
        for ax, quantity in zip(shown, quantities, strict=True):
            _draw_factors(ax, rows[rows["quantity"] == quantity])
            for item in published_tables():
                if item.quantity == quantity:
                    ax.plot(item.temperatures, item.factors, **looks[item.label])
            ax.axvline(report.reference, color=drawing.GREY, linewidth=0.7)
            ax.axhline(1.0, color=drawing.GREY, linewidth=0.7)
            at = drawing.degrees(report.reference)
            name = f"{quantity} over {quantity} at {at}"
            drawing.name_axes(ax, "ambient temperature [°C]", "factor", name)
        limits = [ax.get_xlim() for ax in shown]  # one scale: some sources reach further
        for ax in shown:
            ax.set_xlim(min(low for low, _ in limits), max(high for _, high in limits))
        tested = (calibration_ranges(report.bearings[0]) or {}).get("ambient", (-np.inf, np.inf))
        drawing.shade_untested(shown, [tested] * len(shown))
        for ax in free:
            ax.set_axis_off()
        handles = [Line2D([], [], color=colour, label=label) for colour, label in LOOKS.values()]
        if looks:
            words = "other sources, at their own reference:"
            handles.append(Line2D([], [], linestyle="none", label=words))
        handles += [Line2D([], [], label=label, **look) for label, look in looks.items()]
        if any(label.endswith("*") for label in looks):
            handles.append(Line2D([], [], linestyle="none", label=FOOTNOTE))
        free[0].legend(handles=handles, loc="center left", fontsize=drawing.SMALL, frameon=False)
        return figure

    def sizes(self) -> Figure:
        """Temperature rises and loops at two sizes, where the study has them."""
        if self._report.sizes is None:
            raise InputError("the size effect was not studied: run it with scale = true")
        return draw_scale(self._report.bearings[0], self._report.sizes[1])

    def save_all(self, folder: Path) -> list[Path]:
        """Every figure that the report holds data for, as PNG.

        Parameters
        ----------
        folder : where to; made if it does not exist.

        Returns
        -------
        list of the files written.
        """
        figures = {"factors": self.factors}
        if self._report.sizes is not None:
            figures["scale"] = self.sizes
        return drawing.save_figures(figures, folder, vector=True)


def draw_bounds(table: pd.DataFrame, title: str) -> Figure:
    """Bars between the bounds, dots of the coupled model: a dot above its bar is unsafe.

    Parameters
    ----------
    table : of `bounds_study`; of several lines or piers the least safe is drawn, with its name.
    title : of the figure.

    Returns
    -------
    Figure : a panel for each demand.

    Examples
    --------
    >>> import thermobearing as tb
    >>> bearing = tb.load_bearing("shen-hdr-bridge")
    >>> table = tb.bounds_study(bearing, ["jra-ii-i-1"], [23.0, -20.0])
    >>> len(draw_bounds(table, "bounds").axes)
    4
    """
    table = least_safe(table)
    names = [str(name) for name in table.columns]
    temperatures = [
        float(name.split("_")[1])
        for name in names
        if name.startswith("coupled_") and name.endswith("_degC") and name != "coupled_at_degC"
    ]
    colours = drawing.ambient_colours(np.array(temperatures))
    motions = list(dict.fromkeys(table["motion"]))
    wide = max(4.4, 0.5 * len(motions) + 1.2)
    figure, axes = drawing.panels(2, 2, (2.0 * wide, 6.4), title)
    most = (table.attrs.get("ranges") or {}).get("strain", (0.0, np.inf))[1]
    for ax, (column, label) in zip(axes, DEMANDS.items(), strict=True):
        rows = table[table["demand"] == column].set_index("motion").loc[motions]
        _draw_demand(ax, rows, temperatures, colours)
        if column == "bearing_strain_max" and ax.get_ylim()[1] > most:
            ax.set_ylim(top=max(ax.get_ylim()[1], 1.1 * most))
            drawing.mark_tested(ax, most, "tested to here")
        ax.set_xticks(np.arange(len(motions)), motions if ax in axes[2:] else [""] * len(motions))
        ax.tick_params(axis="x", labelrotation=0 if len(motions) == 1 else 45)
        drawing.name_axes(ax, "", "", label.replace("m/s2", "m/s²"))
    handles = [
        Line2D([], [], color=c, marker="o", linestyle="none", label=drawing.degrees(t))
        for t, c in zip(temperatures, colours, strict=True)
    ]
    edges = [
        Line2D([], [], color=colour, linewidth=2.0, label=f"{name} bearing (bound)")
        for name, colour in EDGES.values()
    ]
    ratio = Line2D([], [], linestyle="none", label=f"number: {RATIO}, red if unsafe")
    drawing.legend_below(figure, [*edges, *handles, ratio])
    return figure


def _draw_demand(
    ax: Axes, rows: pd.DataFrame, temperatures: list[float], colours: list[str]
) -> None:
    """One demand: a bar with its two bounds for each motion, dots beside each other on it."""
    at = np.arange(len(rows))
    ends = [rows[bound].to_numpy() for bound in EDGES]
    low, high = np.minimum(*ends), np.maximum(*ends)
    ax.bar(at, high - low, bottom=low, width=BAR, color=BAND, zorder=1)
    for end, (_, colour) in zip(ends, EDGES.values(), strict=True):
        ax.hlines(end, at - 0.5 * BAR, at + 0.5 * BAR, color=colour, linewidth=2.0, zorder=2)
    places = (np.arange(len(temperatures)) - 0.5 * (len(temperatures) - 1)) * BAR
    top = high.copy()
    for temperature, colour, place in zip(temperatures, colours, places, strict=True):
        values = rows[f"coupled_{temperature:g}_degC"].to_numpy()
        top = np.fmax(top, values)
        beside = at + place / len(temperatures)
        ax.plot(beside, values, "o", color=colour, markeredgecolor="white", zorder=3)
    look: drawing.Look = {"ha": "center", "va": "bottom", "textcoords": "offset points"}
    told = rows.assign(part=rows.get("part", ""))[["envelope_over_coupled", "verdict", "part"]]
    for x, y, (ratio, verdict, part) in zip(at, top, told.to_numpy(), strict=True):
        if np.isfinite([y, ratio]).all():
            colour = UNSAFE_RED if verdict == "unsafe" else drawing.GREY
            look |= {"color": colour, "fontsize": drawing.SMALL, "xytext": (0, 5)}
            ax.annotate(f"{part} {ratio:.2f}".strip(), (x, y), **look)
    highest = float(np.nanmax(top, initial=0.0))
    ax.set_ylim(0.0, 1.15 * highest or 1.0)  # a dot on the frame is cut, and numbers need room
    ax.set_xlim(-0.8, len(rows) - 0.2)
    ax.grid(False, axis="x")


def _draw_factors(ax: Axes, rows: pd.DataFrame) -> None:
    """Factors of one quantity over temperature, a line and a band for each basis."""
    for basis, (colour, _) in LOOKS.items():
        one = rows[rows["basis"] == basis].sort_values("ambient_degC")
        x = one["ambient_degC"].to_numpy()
        if np.isfinite(one["factor_low"]).all():
            low, high = one["factor_low"].to_numpy(), one["factor_high"].to_numpy()
            ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
        ax.plot(x, one["factor"].to_numpy(), ".-", color=colour, linewidth=1.3, markersize=4.5)


def _published_looks(quantities: list[str]) -> dict[str, dict[str, Any]]:
    """How the factors of each other source are drawn, by its name in the legend."""
    names = dict.fromkeys(item.label for item in published_tables() if item.quantity in quantities)
    marks = drawing.MARKERS
    return {
        name: {"color": OTHERS[k % len(OTHERS)], "marker": marks[k % len(marks)], **DOTTED}
        for k, name in enumerate(names)
    }


def draw_scale(bearing: Bearing, results: dict[float, Result]) -> Figure:
    """Temperature rises in time and loops of a bearing at some sizes.

    Parameters
    ----------
    bearing : at full size.
    results : of `scale_study`, by factor on all lengths.

    Returns
    -------
    Figure

    Examples
    --------
    >>> import thermobearing as tb
    >>> bearing = tb.load_bearing("shen-hdr-bridge")
    >>> from thermobearing.design.factors import scale_study
    >>> _, results = scale_study(bearing, [0.5])
    >>> len(draw_scale(bearing, results).axes)
    2
    """
    title = f"{bearing.name}: five cycles of 175 % in 10 s, then rest, at two sizes"
    figure, (left, right) = drawing.panels(1, 2, (10.0, 4.2), title)
    colours = drawing.ordered_colours(len(results), "viridis")
    handles = []
    for (factor, result), colour in zip(results.items(), colours, strict=True):
        for part, rise in _rises(result).items():
            left.plot(result.time(0), rise, color=colour, linestyle=PARTS[part], linewidth=1.2)
        strain, stress = (result[name].values[0] for name in ("strain", "stress"))
        kept = drawing.thin_loops(strain, stress, float(np.ptp(strain)), float(np.ptp(stress)))
        right.plot(100.0 * strain[kept], stress[kept], color=colour, linewidth=0.9)
        handles.append(Line2D([], [], color=colour, label=f"scale {factor:.3g}"))
    left.set_xscale("symlog", linthresh=20.0)
    left.set_xticks([0, 10, 20, 60, 600, 3600], ["0", "10", "20", "60", "600", "3600"])
    drawing.name_axes(left, "time [s]", "rise over the ambient [K]", "temperature")
    drawing.name_axes(right, "shear strain [%]", "stress [MPa]", "loops, cycles 1 to 5")
    parts = {part for result in results.values() for part in _rises(result)}
    handles += [
        Line2D([], [], color=drawing.INK, linestyle=style, label=part)
        for part, style in PARTS.items()
        if part in parts
    ]
    drawing.legend_below(figure, handles)
    return figure


def _rises(result: Result) -> dict[str, Floats]:
    """Temperatures above the ambient [K] by part of the bearing."""
    ambient = float(result["ambient"].values[0])
    layers = result["rubber_temperature"].values[0] - ambient
    lead = {"lead": result["lead_temperature"].values[0] - ambient} if result.has_lead else {}
    return {"inner layer": layers[:, -1], "outer layer": layers[:, 0]} | lead
