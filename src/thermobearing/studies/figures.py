"""Figures of a parameter study."""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.ticker import LogLocator

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.motions.spectrum import DAMPING
from thermobearing.quantities.governing import order_from_least
from thermobearing.quantities.words import joined
from thermobearing.results import drawing
from thermobearing.studies.curves import Temperature
from thermobearing.studies.definition.designs import AMBIENT
from thermobearing.studies.result import StudyResult
from thermobearing.studies.statistics.comparison import CONTRADICTED
from thermobearing.studies.statistics.demand import (
    ANY,
    Counted,
    counted,
    describe_failures,
    equal_classes,
    in_classes,
)
from thermobearing.studies.statistics.fragility import Fragility, describe_wide
from thermobearing.studies.statistics.hazard import TOGETHER, Hazard, Rate
from thermobearing.studies.statistics.ida import FRACTILES, Ida
from thermobearing.studies.statistics.variance import REST, sampling_note
from thermobearing.studies.tables import column_words, find_unit, limit_words, pooled_words


def _title(column: str) -> str:
    unit = find_unit(column)
    return f"{column_words(column)} [{unit}]" if unit else column_words(column)


WIDTH, HEIGHT, MOST_COLUMNS = 2.3, 2.7, 4
BANDS = (("0.05", "0.95", 0.15, "5 to 95 %"), ("0.16", "0.84", 0.3, "16 to 84 % of runs"))
COLOUR, RED = "#0077BB", "#CC3311"


def _legend(figure: Figure, *axes: Axes, note: str = "") -> None:
    """Draw one legend of panels below the figure, each name once, with a note above it."""
    handles = [handle for ax in axes for handle in ax.get_legend_handles_labels()[0]]
    drawing.legend_below(figure, list({handle.get_label(): handle for handle in handles}.values()))
    if note:
        # The layout reserves one strip below the panels, so that the legend has the note.
        (legend,) = figure.legends
        legend.set_title(_wrapped(figure, note), prop=FontProperties(size=drawing.SMALL))
        legend.get_title().set_color(drawing.GREY)


def _wrapped(figure: Figure, text: str) -> str:
    """Return a note in lines that are not longer than the figure."""
    room = int(WRAPPED * figure.get_figwidth() / drawing.WIDEST)
    return "\n".join(textwrap.fill(line, room) for line in text.splitlines())


def _note_below(figure: Figure, text: str) -> None:
    """Write a note below the panels."""
    look: drawing.Look = {"ha": "left", "fontsize": drawing.SMALL, "color": drawing.GREY}
    figure.supxlabel(_wrapped(figure, text), x=0.02, **look)


def _draw_demand(
    quantiles: "pd.DataFrame", result: StudyResult, across: str, runs: Counted
) -> Figure:
    demand, by, capacity = result.demand_name, result.things, result.question.capacity or np.nan
    groups = quantiles.groupby(list(by), sort=False, observed=True) if by else [((), quantiles)]
    cells = [(label, rows) for label, rows in groups]
    columns = min(len(cells), MOST_COLUMNS)
    count = -(-len(cells) // columns)
    size = (max(WIDTH * columns, 4.6) + 0.6, HEIGHT * count + 0.9)
    title = f"{column_words(demand)} against {column_words(across)}"
    figure, axes = drawing.panels(count, columns, size, title, share=True)
    look: drawing.Look = {"fontsize": drawing.SMALL, "fontweight": "bold", "color": drawing.INK}
    for ax in axes[len(cells) :]:
        ax.set_visible(False)
    for place, (ax, (label, rows)) in enumerate(zip(axes, cells, strict=False)):
        x = rows[across].to_numpy(dtype=float)
        for low, high, alpha, words_ in BANDS:
            ends = rows[low].to_numpy(dtype=float), rows[high].to_numpy(dtype=float)
            words_ += _where_finite(quantiles[high], 1.0 - float(high), runs)
            # Where collapses make either end infinite there is no band.
            if _continues(np.add(*ends)):
                ax.fill_between(x, *ends, color=COLOUR, alpha=alpha, linewidth=0, label=words_)
        lowest, median, highest = (
            rows[name].to_numpy(dtype=float) for name in ("median_low", "0.5", "median_high")
        )
        finite = np.isfinite(lowest) & np.isfinite(highest)
        reach = [median[finite] - lowest[finite], highest[finite] - median[finite]]
        name = "median, 95 % band" if finite.any() else "median"
        points: drawing.Look = {"marker": "o", "markersize": 3, "label": name}
        ax.plot(x, median, color=COLOUR, linewidth=1.4, **points)
        ax.errorbar(
            x[finite], median[finite], yerr=reach, fmt="none", ecolor=COLOUR, elinewidth=1.0
        )
        mean = rows["mean"].to_numpy(dtype=float)
        if np.isfinite(mean).any():
            # A single temperature without failures has a mark in place of a line.
            marker = "" if _continues(mean) else "_"
            dashed: drawing.Look = {"color": drawing.INK, "linewidth": 0.9, "linestyle": "--"}
            where = _where_finite(quantiles["mean"], 0.0, runs)
            ax.plot(x, mean, marker=marker, label=f"mean{where}", **dashed)
        if np.isfinite(capacity):
            ax.axhline(capacity, label="capacity", **drawing.LIMIT)
        is_lowest, is_leftmost = place + columns >= len(cells), place % columns == 0
        drawing.name_axes(
            ax, _title(across) if is_lowest else "", _title(demand) if is_leftmost else ""
        )
        ax.set_title(", ".join(map(str, label)), **look)
        ax.tick_params(labelbottom=is_lowest)
    axes[0].set_ylim(0.0, 1.08 * _largest_drawn(quantiles, capacity) or 1.0)
    notes = [
        result.incomplete,
        pooled_words(result).removeprefix(", "),
        runs.sentence,
        _missing_bands(quantiles, axes),
    ]
    _legend(figure, *axes[: len(cells)], note="; ".join(filter(None, notes)))
    return figure


def _largest_drawn(quantiles: "pd.DataFrame", capacity: float) -> float:
    """Return the largest finite number of a figure of the demand, 0 without one."""
    # Where more than 5 % of the runs collapse, the upper fractile is infinite, the median is not.
    drawn = quantiles[[*(high for _, high, _, _ in BANDS), "median_high", "0.5", "mean"]]
    values = np.append(drawn.to_numpy(dtype=float), capacity)
    return float(values[np.isfinite(values)].max(initial=0.0))


def _missing_bands(quantiles: "pd.DataFrame", axes: Sequence[Axes]) -> str:
    """Return which bands of fractiles no panel has because of failed runs; "" if none lacks."""
    labels = [label for ax in axes for label in ax.get_legend_handles_labels()[1]]
    missing = [
        name
        for _, high, _, name in BANDS
        if np.isinf(quantiles[high].to_numpy(dtype=float)).any()
        and not any(label.startswith(name) for label in labels)
    ]
    return f"no band {joined(missing)}, whose upper end failed runs leave unknown" * bool(missing)


def _continues(values: Floats) -> bool:
    """Return whether two neighbours are finite, so that a line between them is drawn."""
    finite = np.isfinite(values)
    return bool((finite[1:] & finite[:-1]).any())


def _where_finite(values: "pd.Series", share: float, runs: Counted) -> str:
    """Return where a line is drawn, if failed runs end it: "", or ", where no run failed"."""
    if not np.isinf(values.to_numpy(dtype=float)).any():
        return ""
    if runs.larger:
        return ", where it is known"  # runs that stopped have an unknown demand
    return f", where less than {100 * share:g} % failed" if share else ", where no run failed"


POINTS = 160
FRAGILITY_NOTE = 95  # letters of a line above the panel
FRAGILITY_ROOM = 1.1  # right end of the curves over the largest intensity of the runs
LARGEST_MARK, SMALLEST_MARK = 8.0, 3.5  # diameters of the marks of the temperatures
MOST_MARKS, MARKS = 40, 15  # intensities with a mark each; classes of more


def _level_colours(names: list[Any]) -> list[str]:
    """Return colours from cold to warm of temperatures, or of their classes in that order."""
    numbers = all(isinstance(name, int | float | np.number) for name in names)
    at = np.array(names if numbers else range(len(names)), dtype=float)
    return drawing.ambient_colours(at) if len(names) else []


def _draw_fragility(
    curves: Mapping[Any, Fragility],
    climate: Fragility | None,
    title: str,
    intensity: str,
    incomplete: str = "",
) -> Figure:
    """Draw the probability of exceedance against intensity; that of all temperatures in black."""
    figure, (ax,) = drawing.panels(1, 1, (5.6, 4.2), title)
    intensities = np.concatenate(
        [curve.counts[curve.intensity].to_numpy() for curve in curves.values()]
    )
    im = np.linspace(0.0, FRAGILITY_ROOM * float(intensities.max()), POINTS + 1)[1:]
    estimated = [name for name, curve in curves.items() if curve.has_median]
    ends = {*estimated[:1], *estimated[-1:]}
    banded = {_label(name): curves[name] for name in curves if name in ends}
    # Open marks, the first the largest: those of the same share lie inside each other.
    sizes = np.linspace(LARGEST_MARK, SMALLEST_MARK, len(curves))
    for (name, curve), colour, size in zip(
        curves.items(), _level_colours(list(curves)), sizes, strict=True
    ):
        # Bands of all would lie over each other; those of the ends compare cold and warm.
        _curve(ax, curve, im, colour, _label(name), banded=name in ends)
        _marks(ax, curve, colour, float(size))
    if climate is not None:
        _curve(ax, climate, im, drawing.INK, climate.name)
        if climate.has_median:
            banded[climate.name] = climate
    share: drawing.Look = {"marker": "o", "linestyle": "none", "markerfacecolor": "none"}
    ax.plot([], [], color=drawing.GREY, markersize=SMALLEST_MARK, label="share of runs", **share)
    ax.set_xlim(0.0, float(im[-1]))
    ax.set_ylim(-0.02, 1.02)
    drawing.name_axes(ax, intensity, "probability of exceedance")
    left_out = sum(curve.left_out for curve in curves.values())
    collapsed = sum(curve.collapsed for curve in curves.values())
    computed = sum(curve.computed for curve in curves.values())
    larger = sum(curve.larger for curve in curves.values())
    runs = sum(curve.runs for curve in curves.values()) + left_out
    method = next(iter(curves.values())).method
    bands = _describe_bands(list(curves.values()), banded)
    failures = describe_failures(runs, left_out, collapsed, computed, larger)
    note = "; ".join(filter(None, [incomplete, method, bands, failures]))
    texts = [
        f"{_label(name)}: {curve.misfit_words}" for name, curve in curves.items() if curve.misfit
    ]
    wrong = next(iter(texts), "")
    note += f"; {CONTRADICTED} by its own runs, {wrong}" if wrong else ""
    lines = textwrap.wrap(note, drawing.fitting(FRAGILITY_NOTE))
    look: drawing.Look = {"loc": "left", "fontsize": drawing.SMALLEST, "color": drawing.GREY}
    ax.set_title("\n".join(lines), **look)
    _legend(figure, ax)
    return figure


def _label(name: Any) -> str:
    return drawing.degrees(name) if isinstance(name, int | float) else str(name)


def _describe_bands(curves: Sequence[Fragility], banded: Mapping[str, Fragility]) -> str:
    """Return whose bands are drawn, and what few motions make of them."""
    # Curves of the same motions; that of a temperature without exceedances says nothing of them.
    drawn = list(banded.values())
    few_motions = next((curve.few_motions for curve in [*drawn, *curves] if curve.few_motions), "")
    if few_motions:
        return few_motions
    motions = max(curve.estimate.groups for curve in curves)
    if not drawn:
        return f"no curve and no bands; {motions} motions"
    subject = f" of {joined(banded)}" if len(curves) + len(drawn) > 2 else ""
    bands = f"{100 * drawn[0].level:g} % bands{subject}"
    return "; ".join(filter(None, [bands, describe_wide(motions)]))


def _curve(
    ax: Axes, curve: Fragility, im: Any, colour: str, label: str, *, banded: bool = True
) -> None:
    """Draw a curve with its band, or only say in the legend that there is none."""
    if not curve.has_median:
        reason = curve.few_words or "no curve"
        ax.plot([], [], color=colour, linewidth=1.4, label=f"{label} ({reason})")
        return
    if banded and not curve.few_motions:
        ax.fill_between(im, *curve.band_at(im), color=colour, alpha=0.13, linewidth=0)
    look: drawing.Look = {"color": colour, "linewidth": 1.8 if len(curve.parts) > 1 else 1.4}
    if curve.misfit:
        look |= {"linestyle": "--"}
        label = f"{label} ({CONTRADICTED})"
    ax.plot(im, curve.probability(im), label=label, **look)


def _marks(ax: Axes, curve: Fragility, colour: str, size: float) -> None:
    """Draw the shares of runs at their intensities as open marks of a size."""
    counts = curve.counts
    if len(counts) > MOST_MARKS:
        sums = counts.groupby(equal_classes(counts[curve.intensity].to_numpy(), MARKS))
        counts = (
            sums[["runs", "beyond"]].sum().assign(**{curve.intensity: sums[curve.intensity].mean()})
        )
    at, share = counts[curve.intensity], counts["beyond"] / counts["runs"]
    look: drawing.Look = {"color": colour, "linestyle": "none", "marker": "o"}
    look |= {"markersize": size, "markerfacecolor": "none", "markeredgewidth": 1.0}
    ax.plot(at, share, **look)


LOOKS = dict(zip(FRACTILES, (":", "-", "--"), strict=True))
MOST_CURVES = 400  # that are drawn; of more every n-th


def _draw_ida(
    parts: Mapping[str, Ida],
    demand: str,
    intensity: str,
    runs: Counted,
    capacity: float,
    medians: Mapping[str, float],
    title: str,
    incomplete: str = "",
) -> Figure:
    """Draw IDA curves, a panel for each part, with the `medians` of the fragility by part."""
    columns = min(len(parts), MOST_COLUMNS)
    count = -(-len(parts) // columns)
    size = (max(WIDTH * columns + 0.6, 5.2), max(HEIGHT * count, 3.3) + 0.9)
    options: Any = {"share": True, "least": WIDTH}  # in a narrow figure, panels below each other
    figure, axes = drawing.panels(count, columns, size, title, **options)
    grid: Any = axes[0].get_gridspec()
    columns = grid.ncols
    curves = [curve for ida in parts.values() for curve in ida.curves]
    widest = float(max(curve.demand[np.isfinite(curve.demand)].max() for curve in curves))
    if np.isfinite(capacity):
        # Demands far beyond the capacity would leave the curves near it no width.
        widest = min(widest, max(4.0 * capacity, 1e-300))
    outside, end = 0, "collapse or stop" if runs.larger else "collapse"
    for place, (name, ida) in enumerate(parts.items()):
        outside += _ida_panel(axes[place], ida, capacity, widest, f"last before {end}")
        if medians.get(name, np.nan) > 0.0:
            # Of a capacity between two runs the curve interpolates, and the likelihood does not.
            diamond: drawing.Look = {"color": drawing.INK, "markersize": 6, "zorder": 4}
            label = "median of the fragility by ida"
            axes[place].plot(capacity, medians[name], "D", label=label, mfc="none", **diamond)
        is_lowest, is_leftmost = place + columns >= len(parts), place % columns == 0
        names = _title(demand) if is_lowest else "", intensity if is_leftmost else ""
        curve_count = f"{len(ida.curves)} curves"
        drawing.name_axes(axes[place], *names, f"{name}, {curve_count}" if name else curve_count)
        axes[place].tick_params(labelbottom=is_lowest)
    for ax in axes[len(parts) :]:
        ax.set_visible(False)
    axes[0].set_xlim(0.0, 1.03 * widest)
    axes[0].set_ylim(0.0, 1.03 * max(float(curve.intensity[-1]) for curve in curves))
    collapses = sum(bool(np.isinf(curve.demand).any()) for curve in curves)
    beyond = f"{outside} of {collapses} curves have their last run before {end} beyond the axis"
    note = f"of these curves, {runs.sentence}"
    notes = [incomplete, note, beyond * bool(outside)]
    _legend(figure, *axes, note="; ".join(filter(None, notes)))
    return figure


def _ida_panel(ax: Axes, ida: Ida, capacity: float, widest: float, last: str) -> int:
    """Draw the curves of motions, their last points before a collapse, and their fractiles.

    What has a demand beyond `widest` is outside the panel. Returns the number of such last points.
    """
    stride = -(-len(ida.curves) // MOST_CURVES)
    label, last_points, outside = "single curves", [], 0
    for number, curve in enumerate(ida.curves):
        finite = np.isfinite(curve.demand)
        first = len(finite) if finite.all() else int((~finite).argmax())
        x, y = curve.demand[:first], curve.intensity[:first]
        outside += int(first < len(finite) and x[-1] > widest)
        if number % stride:
            continue
        ax.plot(x, y, color=drawing.GREY, linewidth=0.6, alpha=0.5, label=label)
        label = ""
        if first < len(finite) and x[-1] <= widest:
            last_points.append((x[-1], y[-1]))
    if last_points:
        cross: drawing.Look = {"color": RED, "markersize": 4, "label": last}
        ax.plot(*np.transpose(last_points), "x", clip_on=False, zorder=3, **cross)
    # Fractiles end where the first curve ends: beyond, they would jump.
    table = ida.fractiles()
    table = table[table["curves"] == len(ida.curves)]
    for share, line in LOOKS.items() if len(table) else ():
        x = np.append(0.0, table[f"{share:g}"].to_numpy(dtype=float))
        y = np.append(0.0, table[ida.intensity].to_numpy(dtype=float))
        finite = np.isfinite(x)
        if not _continues(x):
            continue
        look: drawing.Look = {"color": COLOUR, "linewidth": 1.6, "linestyle": line}
        ax.plot(x[finite], y[finite], label=f"{100 * share:g} % fractile", **look)
    if np.isfinite(capacity):
        ax.axvline(capacity, label="capacity", **drawing.LIMIT)
    return outside


WRAPPED = 120  # characters of a line of a note
DECADES = 6  # of rates below the largest that are drawn


def _draw_rates(
    hazard: Hazard, rates: Mapping[Any, Rate], title: str, measure: str, note: str
) -> Figure:
    """Draw the hazard curve, and the annual rate of each temperature or climate."""
    figure, (left, right) = drawing.panels(1, 2, (7.1, 3.2), title, least=drawing.NARROW)
    left.loglog(hazard.intensity, hazard.rate, color=drawing.INK, linewidth=1.4, marker="o", ms=3)
    drawing.name_axes(left, measure, "rate of exceedance [1/year]", "hazard curve of the site")
    _bars(right, rates)
    drawing.name_axes(right, title="exceedance of the capacity")
    notes = dict.fromkeys([note, *(text for rate in rates.values() for text in rate.notes)])
    notes |= dict.fromkeys(rate.few_motions for rate in rates.values())
    _note_below(figure, "\n".join(filter(None, notes)))
    left.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    left.xaxis.set_major_formatter("{x:g}")
    left.xaxis.set_minor_formatter("{x:g}")
    left.tick_params(which="both", labelsize=drawing.SMALL)
    return figure


def _bars(ax: Axes, rates: Mapping[Any, Rate]) -> None:
    names = list(rates)
    levels = [name for name in names if name not in TOGETHER]
    warm = dict(zip(levels, _level_colours(levels), strict=True)) if len(levels) > 1 else {}
    top = max((rate.high for rate in rates.values() if np.isfinite(rate.high)), default=1.0)
    # A lower end of zero has no place on a logarithmic axis.
    floor = top * 10.0**-DECADES if top > 0.0 else 1e-9
    for place, name in enumerate(names):
        rate, colour = rates[name], warm.get(name, drawing.INK)
        if rate.is_bounded and not rate.few_motions:
            ends = [max(end, floor) for end in (rate.low, rate.high)]
            between: drawing.Look = {"color": colour, "linewidth": 1.0, "linestyle": ":"}
            ax.plot([place, place], ends, marker="_", markersize=8, **between)
            continue
        if not rate.rate > 0.0:
            reason = "no exceedance,\nupper bound" if rate.rate == 0.0 else "no curve"
            look: drawing.Look = {"ha": "center", "color": drawing.GREY}
            look |= {"fontsize": drawing.SMALLEST}
            if rate.high > 0.0:  # an upper bound, with its words where the panel has room
                ax.plot(place, rate.high, "v", color=colour, markersize=5, markerfacecolor="none")
                side, vertical = (-1, "top") if rate.high >= top else (1, "bottom")
                offset: Any = {"xytext": (0, 6 * side), "textcoords": "offset points"}
                ax.annotate(reason, (place, rate.high), va=vertical, **offset, **look)
            else:
                bottom = ax.get_xaxis_transform()
                ax.text(place, 0.02, reason, transform=bottom, va="bottom", **look)
            continue
        filled = colour if rate.outcome != CONTRADICTED else "none"
        ax.plot(place, rate.rate, "o", color=colour, markersize=5, markerfacecolor=filled)
        if not rate.few_motions:
            ax.vlines(place, max(rate.low, floor), rate.high, color=colour, linewidth=1.4)
    ax.set_yscale("log")
    ax.tick_params(which="both", labelsize=drawing.SMALL)
    ax.set_xlim(-0.6, len(names) - 0.4)
    ticks = [f"{_label(name)}{_remark(rates[name])}" for name in names]
    rotated: drawing.Look = {"rotation": 30, "ha": "right"} if len(names) > 4 else {}
    ax.set_xticks(range(len(names)), ticks, **rotated)
    ax.grid(False, axis="x")
    drawing.name_axes(ax, "", "rate of exceedance [1/year]")


def _remark(rate: Rate) -> str:
    """Return what is wrong with a rate, on a line below its name; "" where nothing is."""
    if rate.outcome == CONTRADICTED:
        return f"\n({CONTRADICTED})"
    return f"\n({rate.outcome.replace('_', ' ')}, bounds)" if rate.is_bounded else ""


KINDS = {
    "share": ("share", "#0077BB"),
    "first": ("first-order index", "#0077BB"),
    "total": ("total index, with interactions", "#EE7733"),
}


LEGEND_IN_A_ROW = 5.0  # least width of such a figure [inch]


def _draw_variance(contributions: "pd.DataFrame", demand: str, counts: str) -> Figure:
    kinds = [kind for kind in KINDS if kind in contributions]
    by = "total" if "total" in contributions else "share"
    is_rest = contributions["factor"] == REST
    factors = contributions[~is_rest]
    rows = pd.concat([contributions[is_rest], factors.iloc[order_from_least(factors[by])]])
    size = (5.6, 1.2 + 0.42 * len(rows))
    title = f"Variance contributions, {column_words(demand)}"
    figure, (ax,) = drawing.panels(1, 1, size, title)
    places = np.arange(len(rows), dtype=float)
    height = 0.7 / len(kinds)
    negative = 0
    for number, kind in enumerate(kinds):
        shares = 100.0 * rows[[f"{kind}{end}" for end in ("", "_low", "_high")]].to_numpy(float)
        negative += int((shares[:, 0] < 0.0).sum())
        share, low, high = shares.clip(min=0.0).T
        positions = places + height * (0.5 * (len(kinds) - 1) - number)
        label, colour = KINDS[kind]
        ax.barh(positions, share, height=0.9 * height, color=colour, alpha=0.85, label=label)
        band = "" if number else "95 % band"
        ax.hlines(positions, low, high, color=drawing.INK, linewidth=1.0, label=band)
    ax.set_yticks(places, [column_words(str(name)).replace(", ", ",\n") for name in rows["factor"]])
    ax.grid(False, axis="y")
    ax.axvline(0.0, color=drawing.GREY, linewidth=0.7)
    if negative:
        counts += f"; shares below zero, which are sampling errors, are drawn as zero ({negative})"
    drawing.name_axes(ax, "share of the variance [%]")
    _note_below(figure, "\n".join(filter(None, [counts, sampling_note(contributions)])))
    # The layout reserves one strip below the panels, which the note has; inside, a legend would
    # cover bars.
    above: drawing.Look = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "frameon": False}
    in_a_row = figure.get_figwidth() > LEGEND_IN_A_ROW
    ax.legend(ncols=len(kinds) + 1 if in_a_row else 1, fontsize=drawing.SMALL, **above)
    return figure


class StudyFigures(drawing.Figures):
    """Figures of a study, of the question of the result.

    The figures of fragility need a result of one bearing: `result.select(bearing=...)`.
    """

    _result: StudyResult

    def demand(self, across: str = AMBIENT) -> Figure:
        """Draw fractiles of the demand against the temperature; a panel for each bearing."""
        result = self._result
        demand, failed = result.demand_name, result.question.failed
        quantiles = result.demand(demand, across, failed=failed)
        least = result.demand(demand, across, failed=failed, least=True)
        # Only numbers that runs that stopped leave certain; the ends of a band are bounds.
        names = ["mean", *(name for name in map(str, quantiles) if name.startswith("0."))]
        quantiles[names] = quantiles[names].where(quantiles[names] == least[names], np.inf)
        quantiles["median_low"] = least["median_low"]
        runs = counted(result.table, demand, failed, ANY)
        return _draw_demand(quantiles, result, across, runs)

    def ida(self) -> Figure:
        """Draw IDA curves of motions with their fractiles; a panel for each temperature."""
        result, question = self._result, self._result.question
        demand = result.demand_name
        failed, capacity = question.failed, question.capacity
        runs = counted(result.table, demand, failed, ANY if capacity is None else capacity)
        table, by = in_classes(runs.table, AMBIENT)
        levels = np.unique(table[AMBIENT]).tolist() if by == AMBIENT else []
        temperatures: dict[str, Temperature] = {"": "pooled"}
        if len(levels) > 1:
            temperatures = {drawing.degrees(level): level for level in levels}
        options: Any = {"demand": demand, "failed": failed}
        curves, medians = {}, {}
        for name, at in temperatures.items():
            options["temperature"] = at
            curves[name] = result.ida(capacity=capacity, **options)
            if capacity is not None:
                with suppress(InputError):  # all runs have one intensity
                    # The median needs no bootstrap.
                    curve = result.fragility(capacity, method="ida", samples=1, **options)
                    medians[name] = curve.stated_median
        title = f"incremental dynamic analysis, {column_words(demand)}{self._of_bearing()}"
        limit = np.nan if capacity is None else capacity
        texts = title, result.incomplete
        return _draw_ida(curves, demand, self._intensity(), runs, limit, medians, *texts)

    def fragility(self) -> Figure:
        """Draw the fragility curves of each temperature and over the climate."""
        title = self._title("fragility")
        curves, climate = self._result.find_curves()
        incomplete = self._result.incomplete
        return _draw_fragility(curves, climate, title, self._intensity(), incomplete)

    def rates(self) -> Figure:
        """Draw the hazard curve and the annual rates of exceedance."""
        result = self._result
        _, rates = result.find_rates()
        assert result.question.hazard is not None  # else the line above has raised
        hazard, title = result.question.hazard._curve(), self._title("annual rate")
        return _draw_rates(hazard, rates, title, self._intensity(), _count_sentence(result))

    def variance(self) -> Figure:
        """Draw the share of each factor in the variance of the demand."""
        demand = self._result.demand_name
        counts = _with_incomplete(self._result, self._result.lost_demands().sentence)
        return _draw_variance(self._result.variance(demand), demand, counts)

    def _intensity(self) -> str:
        """Return the label of an axis of the intensity; Sa with its period and damping."""
        scale, name = self._result.study.factors.scale, self._result.intensity
        if scale.measure != "Sa":
            return _title(name)
        damping = DAMPING if scale.damping is None else scale.damping
        return f"Sa(T = {scale.period:g} s, {100.0 * damping:g} %) [{find_unit(name)}]"

    def _title(self, what: str) -> str:
        result = self._result
        title = f"{what}, {column_words(result.demand_name)} above {limit_words(result)}"
        title += self._of_bearing()
        return ", ".join(filter(None, [title, result.selection]))

    def _of_bearing(self) -> str:
        """Return the end of a title: the bearing of all runs, or ""."""
        names = self._result.table["bearing"].unique()
        return f", {names[0]}" if len(names) == 1 else ""

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return a function for each figure that this study has, by name of its file."""
        result, question = self._result, self._result.question
        figures: dict[str, Callable[[], Figure]] = {}
        if AMBIENT in result.factors:
            figures["demand"] = self.demand
        if result.has_variance:
            figures["variance"] = self.variance
        if question.hazard is not None:
            result.capacity  # noqa: B018 - it raises without one
        for name, part in result.parts().items():
            part_figures = StudyFigures(part)
            ending = f"-{name}" if name else ""
            if part.has_ida:
                figures[f"ida{ending}"] = part_figures.ida
            if question.capacity is None or part.table[part.intensity].nunique() < 2:
                continue
            figures[f"fragility{ending}"] = part_figures.fragility
            if question.hazard is not None:
                figures[f"rates{ending}"] = part_figures.rates
        return figures


def _count_sentence(result: StudyResult) -> str:
    runs = counted(result.table, result.demand_name, result.question.failed, result.capacity)
    return _with_incomplete(result, runs.sentence)


def _with_incomplete(result: StudyResult, sentence: str) -> str:
    """Return a sentence on runs after how many of a study that is not complete there are."""
    return "; ".join(filter(None, [result.incomplete, sentence]))


FIGURE_KINDS = ("demand", "variance", "ida", "fragility", "rates")  # beginnings of file names
FIGURE_ENDINGS = (".png", ".pdf", ".svg")


def remove_earlier(result: StudyResult, folder: Path, written: Sequence[Path]) -> list[Path]:
    """Remove figures in a folder that an earlier call wrote and this one did not; return them.

    They are of fewer runs or of another question. Only names that figures of the study can have
    are removed: all other files are those of the user.
    """
    factors = result.study.factors
    levels = [
        [str(level.name) for level in factor.levels or []]
        for factor in (factors.structure, factors.bearing)
    ]
    parts = [
        "",
        *(f"-{name}" for name in [*levels[0], *levels[1], *map("-".join, product(*levels))]),
    ]
    # One that is drawn now in another format may be in a paper: it stays.
    drawn = {path.stem for path in written}
    stems = [name for name in map("".join, product(FIGURE_KINDS, parts)) if name not in drawn]
    earlier = [folder / f"{stem}{ending}" for stem, ending in product(stems, FIGURE_ENDINGS)]
    earlier = [path for path in earlier if path.is_file()]
    for path in earlier:
        path.unlink()
    return earlier
