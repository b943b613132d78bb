"""What a designer looks at: rounds of the loop, bounds, temperature factors, the size effect."""

import re
import textwrap
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.cyclic.result import Result
from thermobearing.design.bounds import DEMANDS, least_safe
from thermobearing.design.codes import code_factors, tables_for
from thermobearing.design.result import BoundsReport, Design, FactorReport
from thermobearing.results import drawing

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
CODES = "codes (not checked against their texts; K_eq, h_eq from Q_d and K_d):"
MAKERS = "makers:"
LEGEND_WIDTH = 26  # letters of a line of the legend of factors
ACROSS = 3  # panels of factors side by side
PARTS: dict[str, Any] = {"inner layer": "-", "outer layer": "--", "lead": ":"}


class DesignFigures(drawing.Figures):
    """Figures of a design: `design.plot.rounds()`, `.equal()`."""

    vector = True
    names = ("rounds", "equal")
    _result: Design

    def rounds(self) -> Figure:
        """Draw assumed and found displacement, round by round, a panel for each group of lines."""
        design = self._result
        title = f"{design.case.structure.name}: design loop"
        count = len(design.taken)
        size = (6.5 if count == 1 else 4.2 * count, 3.6)
        figure, axes = drawing.panels(1, count, size, title, least=drawing.NARROW)
        for ax, turn, bearing in zip(axes, design.taken, design.bearings, strict=True):
            group_rounds = [item for item in design.rounds if item.group == turn.group]
            rows = [item.row() for item in group_rounds]
            numbers = [row["round"] for row in rows]
            for column, name, colour, marker in (
                ("u_B_assumed_mm", "assumed", "#0072B2", "o"),
                ("u_found_mm", "found", "#D55E00", "s"),
            ):
                values = [row[column] for row in rows]
                ax.plot(numbers, values, color=colour, marker=marker, linewidth=1.2, label=name)
            ax.set_xticks(numbers)
            largest_tested = (calibration_ranges(bearing) or {})["strain"][
                1
            ] * bearing.total_rubber_thickness
            if turn.found > largest_tested:
                drawing.mark_tested(ax, largest_tested, "the curves end here")
            drawing.name_axes(ax, "round", "displacement of the bearing [mm]", turn.group)
        drawing.legend_below(figure, axes[0].get_legend_handles_labels()[0])
        return figure

    def equal(self) -> Figure:
        """Draw loops of the bilinear bearing and layered ones of its stiffness, as Fig. 6.6."""
        title = f"{self._result.case.structure.name}: bearings of equal stiffness, 23 °C"
        groups = self._result.loops
        size = (6.0 if len(groups) == 1 else 4.8 * len(groups), 4.4)
        figure, axes = drawing.panels(1, len(groups), size, title, least=drawing.NARROW)
        for ax, (group, loops) in zip(axes, groups.items(), strict=True):
            for (name, (x, force)), colour in zip(loops.items(), LOOPS, strict=False):
                ax.plot(x, force, color=colour, linewidth=1.3, label=name)
            drawing.name_axes(ax, "displacement [mm]", "force [kN]", group)
            ax.legend(fontsize=drawing.SMALL, frameon=False)
        return figure


class BoundsFigures(drawing.Figures):
    """Figures of bounding analyses: `report.plot.demands(name)`."""

    vector = True
    _result: BoundsReport

    def demands(self, name: str) -> Figure:
        """Draw bars between the bounds of a bearing, dots of the coupled model."""
        on = self._result.structure
        title = f"{name} on {on}: bilinear bounds (bars) and coupled model (dots)"
        return draw_bounds(self._result.studies[name], title)

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {f"bounds-{n}": partial(self.demands, n) for n in self._result.studies}


class FactorFigures(drawing.Figures):
    """Figures of temperature factors: `report.plot.factors()`, `.sizes()`."""

    vector = True
    _result: FactorReport

    def factors(self) -> Figure:
        """Draw one panel per quantity at the largest strain, the legend in a free one.

        Bands where the table has them; factors of codes and makers dotted, over their factor at
        the same reference temperature.
        """
        report = self._result
        conditions = f"temperature factors, {report.motion}, strain {report.strain:.0%}"
        rows = report.table[report.table["strain"] == report.strain]
        quantities = list(dict.fromkeys(report.table["quantity"]))
        panel_rows = -(-(len(quantities) + 1) // ACROSS)  # with room for the legend
        size = (3.5 * ACROSS, 0.5 + 3.1 * panel_rows)
        figure, axes = drawing.panels(panel_rows, ACROSS, size, f"{report.name}: {conditions}")
        sources = _other_sources(report)
        names = [name for group in sources.values() for name in group]
        marks = drawing.MARKERS
        looks: dict[str, dict[str, Any]] = {
            name: {"color": OTHERS[k % len(OTHERS)], "marker": marks[k % len(marks)], **DOTTED}
            for k, name in enumerate(names)
        }
        shown, free = axes[: len(quantities)], axes[len(quantities) :]
        for ax, quantity in zip(shown, quantities, strict=True):
            _draw_factors(ax, rows[rows["quantity"] == quantity])
            for name, curves in (pair for group in sources.values() for pair in group.items()):
                if quantity in curves:
                    ax.plot(*curves[quantity], **looks[name])
            ax.axvline(report.reference, color=drawing.GREY, linewidth=0.7)
            ax.axhline(1.0, color=drawing.GREY, linewidth=0.7)
            reference = drawing.degrees(report.reference)
            name = f"{quantity} / {quantity} at {reference}"
            drawing.name_axes(ax, "ambient temperature [°C]", "factor", name)
        limits = [ax.get_xlim() for ax in shown]  # one scale: some sources reach further
        for ax in shown:
            ax.set_xlim(min(low for low, _ in limits), max(high for _, high in limits))
        tested = (calibration_ranges(report.bearings[0]) or {}).get("ambient", (-np.inf, np.inf))
        shaded = drawing.shade_untested(shown, [tested] * len(shown), note=False)
        for ax in free:
            ax.set_axis_off()
        handles: list[Artist] = [
            Line2D([], [], color=colour, label=label) for colour, label in LOOKS.values()
        ]
        if shaded:  # in the panels the note would lie on the lines
            handles.append(Patch(color=drawing.UNTESTED, label="outside calibration range"))
        for head, group in sources.items():
            handles.append(Line2D([], [], linestyle="none", label=_wrapped(head)))
            handles += [Line2D([], [], label=_wrapped(name), **looks[name]) for name in group]
        free[0].legend(handles=handles, loc="center left", fontsize=drawing.SMALL, frameon=False)
        return figure

    def sizes(self) -> Figure:
        """Draw temperature rises and loops at two sizes, where the study has them."""
        if self._result.sizes is None:
            raise InputError("the size effect was not studied: run it with scale = true")
        return draw_scale(self._result.bearings[0], self._result.sizes[1])

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        scale = {"scale": self.sizes} if self._result.sizes is not None else {}
        return {"factors": self.factors} | scale


def draw_bounds(table: "pd.DataFrame", title: str) -> Figure:
    """Draw bars between the bounds, dots of the coupled model: a dot above its bar is unsafe."""
    table = least_safe(table)  # of several lines or piers the governing one
    ends = (re.fullmatch(r"coupled_(.*\d)_degC", str(name)) for name in table.columns)
    temperatures = [float(end[1]) for end in ends if end]
    colours = drawing.ambient_colours(np.array(temperatures))
    motions = list(dict.fromkeys(table["motion"]))
    panel_width = max(4.4, 0.5 * len(motions) + 1.2)
    figure, axes = drawing.panels(2, 2, (2.0 * panel_width, 6.4), title, least=drawing.NARROW)
    ranges, _ = table.attrs.get("ranges", (None, False))
    tested_strain = (ranges or {}).get("strain", (0.0, np.inf))[1]
    for ax, (column, label) in zip(axes, DEMANDS.items(), strict=True):
        rows = table[table["demand"] == column].set_index("motion").loc[motions]
        _draw_demand(ax, rows, temperatures, colours)
        if column == "bearing_strain_max" and ax.get_ylim()[1] > tested_strain:
            # With room above the line for its label.
            ax.set_ylim(top=max(ax.get_ylim()[1], 1.1 * tested_strain))
            drawing.mark_tested(ax, tested_strain, "tested to here")
        ax.set_xticks(np.arange(len(motions)), motions if ax in axes[2:] else [""] * len(motions))
        ax.tick_params(axis="x", labelrotation=0 if len(motions) == 1 else 45)
        drawing.name_axes(ax, "", "", label)
    handles = [
        Line2D([], [], color=c, marker="o", linestyle="none", label=drawing.degrees(t))
        for t, c in zip(temperatures, colours, strict=True)
    ]
    edges = [
        Line2D([], [], color=colour, linewidth=2.0, label=f"{name} bearing (bound)")
        for name, colour in EDGES.values()
    ]
    words = _wrapped(f"number: {RATIO}, red if unsafe")
    ratio = Line2D([], [], linestyle="none", label=words)
    drawing.legend_below(figure, [*edges, *handles, ratio])
    return figure


def _draw_demand(
    ax: Axes, rows: "pd.DataFrame", temperatures: list[float], colours: list[str]
) -> None:
    """Draw one demand: a bar with its two bounds for each motion, dots side by side on it."""
    positions = np.arange(len(rows))
    ends = [rows[bound].to_numpy() for bound in EDGES]
    low, high = np.minimum(*ends), np.maximum(*ends)
    ax.bar(positions, high - low, bottom=low, width=BAR, color=BAND, zorder=1)
    for end, (_, colour) in zip(ends, EDGES.values(), strict=True):
        ax.hlines(
            end, positions - 0.5 * BAR, positions + 0.5 * BAR, color=colour, linewidth=2.0, zorder=2
        )
    places = (np.arange(len(temperatures)) - 0.5 * (len(temperatures) - 1)) * BAR
    top = high.copy()
    for temperature, colour, place in zip(temperatures, colours, places, strict=True):
        values = rows[f"coupled_{temperature:g}_degC"].to_numpy()
        top = np.fmax(top, values)  # a run that failed has no value
        shifted = positions + place / len(temperatures)
        ax.plot(shifted, values, "o", color=colour, markeredgecolor="white", zorder=3)
    look: drawing.Look = {"ha": "center", "va": "bottom", "textcoords": "offset points"}
    shown = rows.assign(part=rows.get("part", ""))[["envelope_over_coupled", "verdict", "part"]]
    for x, y, (ratio, verdict, part) in zip(positions, top, shown.to_numpy(), strict=True):
        if np.isfinite([y, ratio]).all():
            colour = UNSAFE_RED if verdict == "unsafe" else drawing.GREY
            look |= {"color": colour, "fontsize": drawing.SMALL, "xytext": (0, 5)}
            ax.annotate(f"{part} {ratio:.2f}".strip(), (x, y), **look)
    highest = float(np.nanmax(top, initial=0.0))
    ax.set_ylim(0.0, 1.2 * highest or 1.0)  # a dot on the frame is cut, and numbers need room
    ax.set_xlim(-0.8, len(rows) - 0.2)
    ax.grid(False, axis="x")


def _other_sources(report: FactorReport) -> dict[str, dict[str, dict[str, tuple[Any, Any]]]]:
    """Return temperatures and factors by heading of the legend, source and quantity."""
    sources: dict[str, dict[str, dict[str, tuple[Any, Any]]]] = {}
    for item in tables_for(report.bearings[0].kind):
        temperatures = np.array(item.temperatures)
        curves = sources.setdefault(CODES if item.code else MAKERS, {}).setdefault(item.name, {})
        if item.code:
            codes = code_factors(
                item.kinds[0], report.reference, temperatures, report.strength_share
            )
            curves |= {name: (temperatures, y) for name, y in codes[item.code, item.rubber].items()}
        else:
            curves[item.quantity] = (temperatures, item.relative_to(report.reference, temperatures))
    return sources


def _wrapped(label: str) -> str:
    """Return a label of the legend in lines that fit the width of a panel."""
    return textwrap.fill(label, LEGEND_WIDTH)


def _draw_factors(ax: Axes, rows: "pd.DataFrame") -> None:
    """Draw factors of one quantity over temperature, a line and a band for each basis."""
    for basis, (colour, _) in LOOKS.items():
        branch = rows[rows["basis"] == basis].sort_values("ambient_degC", kind="stable")
        x = branch["ambient_degC"].to_numpy()
        if np.isfinite(branch["factor_low"]).all():
            low, high = branch["factor_low"].to_numpy(), branch["factor_high"].to_numpy()
            ax.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
        ax.plot(x, branch["factor"].to_numpy(), ".-", color=colour, linewidth=1.3, markersize=4.5)


def draw_scale(bearing: Bearing, results: dict[float, Result]) -> Figure:
    """Draw temperature rises in time and loops of a bearing at some sizes."""
    title = f"{bearing.name}: five cycles of 175 % in 10 s, then rest, at two sizes"
    figure, (left, right) = drawing.panels(1, 2, (10.0, 4.2), title, least=drawing.NARROW)
    colours = drawing.ordered_colours(len(results), "viridis")
    handles = []
    for (factor, result), colour in zip(results.items(), colours, strict=True):
        for part, rise in _rises(result).items():
            left.plot(result.time(0), rise, color=colour, linestyle=PARTS[part], linewidth=1.2)
        strain, stress = (result[name].values[0] for name in ("strain", "stress"))
        kept = drawing.thin_loops(strain, stress, float(np.ptp(strain)), float(np.ptp(stress)))
        right.plot(100.0 * strain[kept], stress[kept], color=colour, linewidth=0.9)
        handles.append(Line2D([], [], color=colour, label=f"scale {factor:.3g}"))
    # Linear over the ten seconds of loading, logarithmic over the hour of rest.
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
    """Return temperatures above the ambient [K] by part of the bearing."""
    ambient = float(result["ambient"].values[0])
    layers = result["rubber_temperature"].values[0] - ambient
    lead = {"lead": result["lead_temperature"].values[0] - ambient} if result.has_lead else {}
    return {"inner layer": layers[:, -1], "outer layer": layers[:, 0]} | lead
