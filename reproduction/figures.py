"""The computed figures of Shen (2023), drawn from the rows of `data/figures.toml`.

A row has the words of its caption and an expression: a view of a result, or one of the functions
`draw_*` here for what no result draws. Its names are those of `measures` and of this module.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reproduction.measures import bilinear_of_g8, evaluate, words
from reproduction.runs import AMBIENT, BILINEAR, BRIDGES, DATA, MODES, MOTIONS, SPECIMENS, Runs
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.toml import read_toml
from thermobearing.design.case import make_design_case
from thermobearing.design.run import run_design
from thermobearing.earthquake.panels import MODE_LOOKS
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.motions.figures import BINS, MOTION_COLOUR
from thermobearing.motions.library import load_motion
from thermobearing.motions.record import MM_S2_PER_GAL
from thermobearing.results import drawing

HYBRID_MOTION = "jra-ii-ii-1"
MULTI, SINGLE = "multi-layer", "single-temperature"
COLOURS = {MULTI: "#000000", SINGLE: "#EE7733"}
LOOP = {  # bars of Fig. 5.11 and 5.14: column of the table of largest loops
    "F+": "F_plus_kN",
    "F\N{MINUS SIGN}": "F_minus_kN",
    "D+": "D_plus_mm",
    "D\N{MINUS SIGN}": "D_minus_mm",
    "MaxE": "energy_kN_mm",
}
DETERMINED = "R\N{SUPERSCRIPT TWO}"
NAMES = {"rt": "real time", "pd": "pseudo-dynamic"}
GROUP = 0.8  # of the distance between two motions
HEIGHT = 3.0  # of a panel [inch]
COLUMNS = 2
BLACK: drawing.Look = {"color": "#000000", "linewidth": 0.7, "linestyle": "--"}


class Row(NamedTuple):
    """A figure: its number ("3.7"), what is shown, run and drawn, and the expression that draws."""

    number: str
    caption: str
    draw: str

    @property
    def name(self) -> str:
        """Return the name of the figure's file, as "fig_3_07"."""
        chapter, _, place = self.number.partition(".")
        return f"fig_{chapter}_{int(place):02d}"

    def figure(self, runs: Runs) -> Figure:
        """Draw the figure."""
        figure: Figure = evaluate(self.draw, figure_words(runs))
        return figure


@cache
def load_figures() -> dict[str, Row]:
    """Return the rows of `figures.toml` by number, in the order of the dissertation."""
    table: Any = read_toml(DATA / "figures.toml")
    rows = {}
    for number, row in table["figures"].items():
        run = [table["runs"].get(row.get("run")), row.get("detail")]
        sentences = [
            f"Fig. {number}: {row['shows']}.",
            f"Run: {', '.join(part for part in run if part)}.",
            f"Drawn: {row['drawn']}.",
            *(table["notes"][note] for note in row.get("notes", ())),
            row.get("remark", ""),
        ]
        rows[number] = Row(number, " ".join(sentences).rstrip(), row["draw"])
    return rows


def figure_words(runs: Runs) -> dict[str, Any]:
    """Return all that the expression of a figure may name."""

    def hybrid_tests(
        bearing: str | Sequence[str], mode: str | Sequence[str] = MODES, model: str = MULTI
    ) -> EarthquakeResult:
        """Return hybrid tests at 23, 0 and -20 degC; all twelve are run together, once."""
        # All figures of hybrid tests share these twelve runs.
        kept = ("rubber", "cells")
        results = runs.hybrid(SPECIMENS, AMBIENT, MODES, HYBRID_MOTION, keep=kept, model=model)
        return results.sel(bearing=bearing, mode=mode)

    def bridge_tests(bearing: str) -> EarthquakeResult:
        """Return pier P1 under the four motions at 23, 0 and -20 degC."""
        return runs.bridge(BRIDGES, MOTIONS).sel(bearing=bearing)

    def bilinear_tests() -> EarthquakeResult:
        """Return pier P1 on the bilinear and both layered bearings at 23 degC."""
        return runs.bridge((BILINEAR, *BRIDGES), MOTIONS, 23.0)

    def both_models(bearing: str, mode: str) -> EarthquakeResult:
        """Return the hybrid tests of a bearing, compared with those of a single temperature."""
        results = {model: hybrid_tests(bearing, mode, model) for model in (MULTI, SINGLE)}
        return EarthquakeResult(results[MULTI].dataset, results)

    run_functions = (
        hybrid_tests,
        bridge_tests,
        bilinear_tests,
        both_models,
        run_design,
        make_design_case,
    )
    drawn = (draw_both_modes, draw_bars, draw_over_bilinear, draw_ground, draw_measures)
    functions: dict[str, Any] = {
        f.__name__: f for f in (*run_functions, *drawn, draw_ratios, draw_bilinear)
    }
    return words(runs) | functions | {"runs": runs}


def draw_both_modes(
    result: EarthquakeResult, variable: str, title: str, label: str, factor: float = 1.0
) -> Figure:
    """Draw a history of both kinds of hybrid test, one panel for each temperature."""
    table = result.table
    ambients = sorted(set(table["ambient_degC"]))
    figure, axes = drawing.panels(len(ambients), 1, (drawing.WIDEST, 5.2), title, share=True)
    for ax, ambient in zip(axes, ambients, strict=True):
        rows = table[table["ambient_degC"] == ambient]
        colours, peaks = [], []
        for run, mode in zip(rows.index.to_numpy(), rows["mode"], strict=True):
            recorded = np.isfinite(result["time"].values[run])
            values = factor * result[variable].values[run][recorded].astype(float)
            samples = drawing.thin(values, BINS)
            style = MODE_LOOKS[mode]
            ax.plot(
                result["time"].values[run][recorded][samples],
                values[samples],
                linewidth=0.9,
                **style,
            )
            colours.append(style["color"])
            peaks.append(f"{factor * float(result[f'{variable}_max'][run]):.3g}")
        ax.margins(y=0.2)
        drawing.note_values(ax, "largest", peaks, colours)
        last = ambient == ambients[-1]
        drawing.name_axes(ax, "time of the earthquake [s]" if last else "", label)
    drawing.head_grid(axes, [""], [drawing.degrees(ambient) for ambient in ambients])
    modes = list(dict.fromkeys(table["mode"]))
    handles = [Line2D([], [], label=NAMES[mode], **MODE_LOOKS[mode]) for mode in modes]
    drawing.legend_below(figure, handles)
    return figure


def _ambients(result: EarthquakeResult) -> dict[float, str]:
    """Return the colour of each ambient temperature, cold to warm."""
    ambients = sorted(set(result.table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    return dict(zip(ambients, colours, strict=True))


def _bars(ax: Axes, at: Any, values: Any, width: float, colour: str, **look: Any) -> None:
    """Draw bars with their numbers above them, and room for those."""
    bars = ax.bar(at, values, width, color=colour)
    drawn: drawing.Look = {"fmt": "%.3g", "padding": 1.0, "fontsize": drawing.SMALL - 1.0}
    ax.bar_label(bars, **drawn | look)
    ax.grid(False, axis="x")


def draw_bars(
    result: EarthquakeResult, title: str, shown: Sequence[tuple[str, str, float]]
) -> Figure:
    """Draw one panel for each column (with label and factor), one group of bars for each motion."""
    table, colours = result.table, dict(reversed(_ambients(result).items()))
    motions = list(dict.fromkeys(table["motion"]))
    bar_width, size = GROUP / len(colours), (drawing.WIDEST, HEIGHT * len(shown) + 0.6)
    figure, axes = drawing.panels(len(shown), 1, size, title)
    for ax, (column, label, factor) in zip(axes, shown, strict=True):
        for place, (ambient, colour) in enumerate(colours.items()):
            rows = table[table["ambient_degC"] == ambient].set_index("motion")
            values = factor * rows.loc[motions, column].to_numpy(dtype=float)
            positions = np.arange(len(motions)) + bar_width * (place - 0.5 * (len(colours) - 1))
            _bars(ax, positions, values, 0.92 * bar_width, colour)
        if column == "pier_ductility":
            drawing.mark_tested(ax, 1.0, "yields")
        ax.set_ylim(0.0, 1.12 * ax.get_ylim()[1])
        ax.set_xticks(range(len(motions)), motions)
        drawing.name_axes(ax, y=label)
    names = {f"ambient {drawing.degrees(value)}": colour for value, colour in colours.items()}
    _legend(figure, names)
    return figure


def _legend(
    figure: Figure, colours: Mapping[str, str], *others: Line2D, width: float = 5.0
) -> None:
    handles = [Line2D([], [], color=c, linewidth=width, label=name) for name, c in colours.items()]
    drawing.legend_below(figure, [*handles, *others])


def draw_over_bilinear(result: EarthquakeResult, designed: EarthquakeResult) -> Figure:
    """Draw loops at three temperatures over those of the bilinear bearing."""
    table, colours = result.table, _ambients(result)
    motions = list(dict.fromkeys(table["motion"]))
    rows = -(-len(motions) // COLUMNS)
    title = f"{table['bearing'].iloc[0]} and the bilinear model"
    size = (drawing.WIDEST, 2.7 * rows + 0.9)
    figure, axes = drawing.panels(rows, COLUMNS, size, title, share=True)
    for panel, (ax, motion) in enumerate(zip(axes, motions, strict=False)):
        group = table[table["motion"] == motion].set_index("ambient_degC", append=True)
        places = {ambient: int(run) for run, ambient in group.index}
        for ambient, colour in reversed(colours.items()):
            _path(ax, result, places[ambient], {"color": colour, "linewidth": 0.9})
        designed_runs = designed.table
        bilinear_runs = designed_runs[
            (designed_runs["bearing"] == BILINEAR) & (designed_runs["motion"] == motion)
        ]
        for run in bilinear_runs.index.to_numpy()[:1]:
            _path(ax, designed, int(run), BLACK)
        foot, side = panel // COLUMNS == rows - 1, panel % COLUMNS == 0
        x, y = "displacement [mm]" if foot else "", "force of one bearing [kN]" if side else ""
        drawing.name_axes(ax, x, y, motion)
    for ax in axes[len(motions) :]:
        ax.remove()
    names = {f"ambient {drawing.degrees(value)}": colour for value, colour in colours.items()}
    _legend(figure, names, Line2D([], [], label="bilinear", **BLACK), width=1.5)
    return figure


def _path(ax: Axes, result: EarthquakeResult, run: int, look: drawing.Look) -> None:
    """Draw the force of one run against its displacement."""
    recorded = np.isfinite(result["time"].values[run])
    x = result["bearing_displacement"].values[run][recorded].astype(float)
    y = result["bearing_force"].values[run][recorded].astype(float)
    samples = drawing.thin_loops(x, y, max(np.ptp(x), 1e-9), max(np.ptp(y), 1e-9))
    ax.plot(x[samples], y[samples], **look)


def draw_ground(names: Sequence[str], title: str) -> Figure:
    """Draw accelerograms on the same axes, with their peaks."""
    size = (drawing.WIDEST, 1.5 * len(names) + 1.2)
    figure, axes = drawing.panels(len(names), 1, size, title, share=True)
    for ax, name in zip(axes, names, strict=True):
        motion = load_motion(name)
        gal = motion.acceleration / MM_S2_PER_GAL
        samples = drawing.thin(gal, BINS)
        ax.plot(motion.time[samples], gal[samples], color=MOTION_COLOUR, linewidth=0.7)
        peak = int(np.abs(gal).argmax())
        peak_text = f"{gal[peak]:.0f} gal at {motion.time[peak]:.2f} s"
        ax.margins(y=0.15)
        drawing.note_values(ax, "largest", [peak_text], [MOTION_COLOUR])
        drawing.name_axes(ax, "time [s]" if name == names[-1] else "", "acceleration [gal]")
    drawing.head_grid(axes, [""], list(names))
    return figure


def draw_measures(
    results: Mapping[str, EarthquakeResult], title: str, shown: Sequence[tuple[str, str]]
) -> Figure:
    """Draw measures of the largest loop by both models, one panel for each measure."""
    figure, axes = drawing.panels(1, len(shown), (drawing.WIDEST, 3.4), title)
    for ax, (column, label) in zip(axes, shown, strict=True):
        for place, (model, result) in enumerate(results.items()):
            loops = result.largest_loops.sort_values("ambient_degC")
            positions = np.arange(len(loops)) + 0.4 * (place - 0.5)
            _bars(ax, positions, loops[column].to_numpy(), 0.36, COLOURS[model])
            ax.set_xticks(range(len(loops)), [drawing.degrees(t) for t in loops["ambient_degC"]])
        ax.set_ylim(0.0, 1.12 * ax.get_ylim()[1])
        drawing.name_axes(ax, "ambient", label)
    _legend(figure, COLOURS)
    return figure


def draw_ratios(results: Mapping[str, EarthquakeResult], title: str) -> Figure:
    """Draw the ratio of single-temperature to multi-layer measures, and R2 of the force."""
    layered, single = (results[name].largest_loops for name in (MULTI, SINGLE))
    order = layered.sort_values("ambient_degC").index.to_numpy()
    figure, axes = drawing.panels(1, len(order), (drawing.WIDEST, 3.4), title, share=True)
    for panel, (ax, run) in enumerate(zip(axes, order, strict=True)):
        ratios = {k: float(single[c][run] / layered[c][run]) for k, c in LOOP.items()}
        ratios[DETERMINED] = _determination(results, int(run))
        values = list(ratios.values())
        _bars(ax, range(len(ratios)), values, 0.7, COLOURS[SINGLE], fmt="%.3f", rotation=90)
        ax.axhline(1.0, color=drawing.GREY, linewidth=0.8, linestyle="--")
        ax.set_xticks(range(len(ratios)), list(ratios))
        ax.set_ylim(0.0, 1.5)
        y = "single-temperature / multi-layer" if panel == 0 else ""
        drawing.name_axes(ax, y=y, title=f"ambient {drawing.degrees(layered['ambient_degC'][run])}")
    return figure


def _determination(results: Mapping[str, EarthquakeResult], run: int) -> float:
    """Return R2 of the force (Eq. 4.38) with the multi-layer model in place of the test."""
    recorded = np.isfinite(results[MULTI]["time"].values[run])
    force = [results[name]["bearing_force"].values[run][recorded] for name in (MULTI, SINGLE)]
    expected, single = (values.astype(float) for values in force)
    return float(1.0 - ((single - expected) ** 2).sum() / ((expected - expected.mean()) ** 2).sum())


def draw_bilinear(runs: Runs) -> Figure:
    """Draw the bilinear model of Table 6.3, and that which follows from K_B and h_B."""
    end, printed = runs.number("u_B"), load_bilinear(BILINEAR)
    table = (printed.strength, printed.initial_stiffness, printed.post_yield_stiffness)
    computed = bilinear_of_g8(runs)
    k_b = computed[0] / end + computed[2]
    figure, (ax,) = drawing.panels(1, 1, (6.0, 4.2), "bilinear model of the design")
    models = (("Table 6.3", "#0072B2", table), ("from K_B and h_B", "#D55E00", computed))
    for name, colour, (q, k1, k2) in models:
        label = f"{name}: Q_d {q:.1f} kN, K_1 {k1:.2f}, K_2 {k2:.2f} kN/mm"
        ax.plot(*_bilinear_loop(q, k1, k2, end), color=colour, linewidth=1.3, label=label)
    label = f"K_B = {k_b:.3f} kN/mm at {end:g} mm"
    style: drawing.Look = {"color": drawing.GREY, "linestyle": "--", "linewidth": 1.0}
    ax.plot([-end, end], [-k_b * end, k_b * end], label=label, **style)
    drawing.name_axes(ax, "displacement [mm]", "force [kN]")
    ax.legend(fontsize=drawing.SMALL, frameon=False, loc="upper left")
    return figure


def _bilinear_loop(
    strength: float, first: float, second: float, end: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a bilinear loop [mm, kN]."""
    top = strength + second * end
    turned = end - 2.0 * strength / (first - second)  # elastic way back: 2 u_y
    x = np.array([end, turned, -end, -turned, end])
    y = np.array([top, top - first * (end - turned), -top, first * (end - turned) - top, top])
    return x, y
