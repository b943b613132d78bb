"""The computed figures of Shen (2023), drawn from the rows of `data/claims/figures.toml`.

A row names the analysis, the bearing and the view; the functions here draw the views that no
result has: bars of the numbers of all runs, both kinds of hybrid test, two models, and the bilinear
model of the design.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.design.case import STIFFNESS_RATIO, make_design_case
from thermobearing.design.result import source_design
from thermobearing.design.rubber import (
    damping_ratio,
    equivalent_bilinear,
    equivalent_stiffness,
    load_rubber,
)
from thermobearing.design.run import run_design
from thermobearing.earthquake import summary_figures as comparison
from thermobearing.earthquake.figures import MODE_LOOKS
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.motions.figures import BINS, MOTION_COLOUR
from thermobearing.motions.library import load_motion
from thermobearing.motions.record import MM_S2_PER_GAL
from thermobearing.reproduce.runs import AMBIENT, Runs
from thermobearing.results import drawing

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
BRIDGE_HDR, BRIDGE_LHDR = "shen-hdr-bridge", "shen-lhdr-bridge"
BILINEAR = "shen-bilinear-bridge"
MOTIONS = ("jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2")
HYBRID_MOTION = "jra-ii-ii-1"
MULTI, SINGLE = "multi-layer", "single-temperature"
BOTH = ("rt", "pd")
MOMENTS = (5.0, 10.0, 15.0, 20.0)  # of the profiles of the hybrid tests [s]
KEPT = ("rubber", "cells")
WORDS = ("shows", "run", "detail", "drawn", "notes", "remark", "draw")  # other keys are arguments
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


@dataclass(frozen=True)
class Row:
    """A figure: its number, its caption, and how it is drawn.

    Attributes
    ----------
    number : as "3.7".
    caption : what is shown, run and drawn.
    draw : name of the function in `DRAWN`.
    arguments : of that function.
    """

    number: str
    caption: str
    draw: str
    arguments: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Return the name of the figure's file, as "fig_3_07"."""
        chapter, _, place = self.number.partition(".")
        return f"fig_{chapter}_{int(place):02d}"

    def figure(self, runs: Runs) -> Figure:
        """Draw the figure."""
        return DRAWN[self.draw](runs, **self.arguments)


@cache
def load_figures() -> dict[str, Row]:
    """Return the rows of `figures.toml` by number, in the order of the dissertation."""
    table: Any = read_toml(data_path("claims", "figures.toml"))
    found = {}
    for number, row in table["figures"].items():
        run = [table["runs"].get(row.get("run")), row.get("detail")]
        sentences = [
            f"Fig. {number}: {row['shows']}.",
            f"Run: {', '.join(part for part in run if part)}.",
            f"Drawn: {row['drawn']}.",
            *(table["notes"][note] for note in row.get("notes", ())),
            row.get("remark", ""),
        ]
        arguments = {key: value for key, value in row.items() if key not in WORDS}
        caption = " ".join(sentences).rstrip()
        found[number] = Row(number, caption, row["draw"], arguments)
    return found


def hybrid_tests(
    runs: Runs, bearing: str | Sequence[str], mode: str | Sequence[str] = BOTH, model: str = MULTI
) -> EarthquakeResult:
    """Return hybrid tests at 23, 0 and -20 degC; all twelve are run together, once."""
    made = runs.hybrid((HDR, LHDR), AMBIENT, BOTH, HYBRID_MOTION, keep=KEPT, model=model)
    return made.sel(bearing=bearing, mode=mode)


def bridge_study(runs: Runs, bearing: str) -> EarthquakeResult:
    """Return pier P1 on one kind of bearing under four motions at 23, 0 and -20 degC."""
    return runs.bridge((BRIDGE_HDR, BRIDGE_LHDR), MOTIONS).sel(bearing=bearing)


def _bilinear_study(runs: Runs) -> EarthquakeResult:
    """Return pier P1 on the bilinear and both layered bearings at 23 degC."""
    return runs.bridge((BILINEAR, BRIDGE_HDR, BRIDGE_LHDR), MOTIONS, 23.0)


def _both_models(runs: Runs, bearing: str, mode: str) -> dict[str, EarthquakeResult]:
    """Return the hybrid tests of a bearing by each model, by its name."""
    return {model: hybrid_tests(runs, bearing, mode, model) for model in (MULTI, SINGLE)}


def _draw_cyclic(runs: Runs, bearing: str, view: str, **options: Any) -> Figure:
    """Draw a view of the cyclic test of Table 3.4."""
    figure: Figure = getattr(runs.cyclic(bearing, **options).plot, view)()
    return figure


def _draw_hybrid(
    runs: Runs,
    bearing: str | Sequence[str],
    view: str,
    mode: str | Sequence[str] = BOTH,
    ambient: float | None = None,
) -> Figure:
    """Draw a view of the hybrid tests."""
    result = hybrid_tests(runs, bearing, mode)
    if ambient is not None:
        result = result.sel(ambient=ambient)
    moments = [MOMENTS] if view == "profiles" else []
    figure: Figure = getattr(result.plot, view)(*moments)
    return figure


def _draw_bridge(runs: Runs, bearing: str, view: str) -> Figure:
    """Draw a view of pier P1 under the four motions."""
    figure: Figure = getattr(bridge_study(runs, bearing).plot, view)()
    return figure


def _draw_models(runs: Runs, bearing: str, mode: str, view: str) -> Figure:
    """Draw hybrid tests by the multi-layer and by the single-temperature model."""
    figure: Figure = getattr(comparison, view)(_both_models(runs, bearing, mode))
    return figure


def _draw_three_bearings(runs: Runs) -> Figure:
    """Draw the largest loops of the bilinear, the HDR and the LHDR bearing."""
    return _bilinear_study(runs).plot.largest_loops()


def _draw_design(_runs: Runs) -> Figure:
    """Draw the rounds of the design of section 6.2."""
    case = make_design_case({}, "Fig. 6.4", start=178.0, tolerance=0.1)
    return run_design(case).plot.rounds()


def _draw_both_modes(
    runs: Runs, bearing: str, variable: str, title: str, label: str, factor: float = 1.0
) -> Figure:
    """Draw a history of both kinds of hybrid test, one panel for each temperature."""
    result = hybrid_tests(runs, bearing)
    table = result.table
    ambients = sorted(set(table["ambient_degC"]))
    figure, axes = drawing.panels(len(ambients), 1, (drawing.WIDEST, 5.2), title, share=True)
    for ax, ambient in zip(axes, ambients, strict=True):
        mine = table[table["ambient_degC"] == ambient]
        colours, peaks = [], []
        for run, mode in zip(mine.index.to_numpy(), mine["mode"], strict=True):
            known = np.isfinite(result["time"].values[run])
            values = factor * result[variable].values[run][known].astype(float)
            kept = drawing.thin(values, BINS)
            look = MODE_LOOKS[mode]
            ax.plot(result["time"].values[run][known][kept], values[kept], linewidth=0.9, **look)
            colours.append(look["color"])
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


def _draw_bars(
    runs: Runs, bearing: str, title: str, shown: Sequence[tuple[str, str, float]]
) -> Figure:
    """Draw one panel for each column (with label and factor), one group of bars for each motion."""
    table = bridge_study(runs, bearing).table
    ambients = sorted(set(table["ambient_degC"]), reverse=True)
    motions = list(dict.fromkeys(table["motion"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    wide, size = GROUP / len(ambients), (drawing.WIDEST, HEIGHT * len(shown) + 0.6)
    figure, axes = drawing.panels(len(shown), 1, size, title)
    for ax, (column, label, factor) in zip(axes, shown, strict=True):
        for place, (ambient, colour) in enumerate(zip(ambients, colours, strict=True)):
            mine = table[table["ambient_degC"] == ambient].set_index("motion")
            values = factor * mine.loc[motions, column].to_numpy(dtype=float)
            at = np.arange(len(motions)) + wide * (place - 0.5 * (len(ambients) - 1))
            bars = ax.bar(at, values, 0.92 * wide, color=colour)
            ax.bar_label(bars, fmt="%.3g", fontsize=drawing.SMALL - 1.0, padding=1.0)
        if column == "pier_ductility":
            drawing.mark_tested(ax, 1.0, "yields")
        ax.set_ylim(0.0, 1.12 * ax.get_ylim()[1])
        ax.set_xticks(range(len(motions)), motions)
        ax.grid(False, axis="x")
        drawing.name_axes(ax, y=label)
    known = [f"ambient {drawing.degrees(value)}" for value in ambients]
    pairs = zip(known, colours, strict=True)
    handles = [Line2D([], [], color=colour, linewidth=5.0, label=name) for name, colour in pairs]
    drawing.legend_below(figure, handles)
    return figure


def _draw_over_bilinear(runs: Runs, bearing: str) -> Figure:
    """Draw loops at three temperatures over those of the bilinear bearing."""
    result, designed = bridge_study(runs, bearing), _bilinear_study(runs)
    table = result.table
    ambients = sorted(set(table["ambient_degC"]))
    motions = list(dict.fromkeys(table["motion"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    rows = -(-len(motions) // COLUMNS)
    title = f"{table['bearing'].iloc[0]} and the bilinear model"
    size = (drawing.WIDEST, 2.7 * rows + 0.9)
    figure, axes = drawing.panels(rows, COLUMNS, size, title, share=True)
    for panel, (ax, motion) in enumerate(zip(axes, motions, strict=False)):
        mine = table[table["motion"] == motion].set_index("ambient_degC", append=True)
        places = {ambient: int(run) for run, ambient in mine.index}
        for ambient, colour in reversed(list(zip(ambients, colours, strict=True))):
            _path(ax, result, places[ambient], {"color": colour, "linewidth": 0.9})
        of = designed.table
        chosen = of[(of["bearing"] == BILINEAR) & (of["motion"] == motion)]
        for run in chosen.index.to_numpy()[:1]:
            _path(ax, designed, int(run), BLACK)
        foot, side = panel // COLUMNS == rows - 1, panel % COLUMNS == 0
        x, y = "displacement [mm]" if foot else "", "force of one bearing [kN]" if side else ""
        drawing.name_axes(ax, x, y, motion)
    for ax in axes[len(motions) :]:
        ax.remove()
    pairs = zip(ambients, colours, strict=True)
    handles = [Line2D([], [], color=c, label=f"ambient {drawing.degrees(t)}") for t, c in pairs]
    drawing.legend_below(figure, [*handles, Line2D([], [], label="bilinear", **BLACK)])
    return figure


def _path(ax: Axes, result: EarthquakeResult, run: int, look: drawing.Look) -> None:
    """Draw the force of one run against its displacement."""
    known = np.isfinite(result["time"].values[run])
    x = result["bearing_displacement"].values[run][known].astype(float)
    y = result["bearing_force"].values[run][known].astype(float)
    kept = drawing.thin_loops(x, y, max(np.ptp(x), 1e-9), max(np.ptp(y), 1e-9))
    ax.plot(x[kept], y[kept], **look)


def _draw_ground(_runs: Runs, motions: Sequence[str], title: str) -> Figure:
    """Draw accelerograms on the same axes, with their peaks."""
    names = motions
    size = (drawing.WIDEST, 1.5 * len(names) + 1.2)
    figure, axes = drawing.panels(len(names), 1, size, title, share=True)
    for ax, name in zip(axes, names, strict=True):
        motion = load_motion(name)
        gal = motion.acceleration / MM_S2_PER_GAL
        kept = drawing.thin(gal, BINS)
        ax.plot(motion.time[kept], gal[kept], color=MOTION_COLOUR, linewidth=0.7)
        peak = int(np.abs(gal).argmax())
        known = f"{gal[peak]:.0f} gal at {motion.time[peak]:.2f} s"
        ax.margins(y=0.15)
        drawing.note_values(ax, "largest", [known], [MOTION_COLOUR])
        drawing.name_axes(ax, "time [s]" if name == names[-1] else "", "acceleration [gal]")
    drawing.head_grid(axes, [""], list(names))
    return figure


def _draw_measures(
    runs: Runs, bearing: str, mode: str, title: str, shown: Sequence[tuple[str, str]]
) -> Figure:
    """Draw measures of the largest loop by both models, one panel for each measure."""
    results = _both_models(runs, bearing, mode)
    figure, axes = drawing.panels(1, len(shown), (drawing.WIDEST, 3.4), title)
    for ax, (column, label) in zip(axes, shown, strict=True):
        for place, (model, result) in enumerate(results.items()):
            loops = result.largest_loops.sort_values("ambient_degC")
            at = np.arange(len(loops)) + 0.4 * (place - 0.5)
            bars = ax.bar(at, loops[column].to_numpy(), 0.36, color=COLOURS[model])
            ax.bar_label(bars, fmt="%.3g", fontsize=drawing.SMALL - 1.0, padding=1.0)
            ax.set_xticks(range(len(loops)), [drawing.degrees(t) for t in loops["ambient_degC"]])
        ax.set_ylim(0.0, 1.12 * ax.get_ylim()[1])
        ax.grid(False, axis="x")
        drawing.name_axes(ax, "ambient", label)
    _legend(figure, list(results))
    return figure


def _draw_ratios(runs: Runs, bearing: str, mode: str, title: str) -> Figure:
    """Draw the ratio of single-temperature to multi-layer measures, and R2 of the force."""
    results = _both_models(runs, bearing, mode)
    layered, single = (results[name].largest_loops for name in (MULTI, SINGLE))
    order = layered.sort_values("ambient_degC").index.to_numpy()
    figure, axes = drawing.panels(1, len(order), (drawing.WIDEST, 3.4), title, share=True)
    for panel, (ax, run) in enumerate(zip(axes, order, strict=True)):
        ratios = {k: float(single[c][run] / layered[c][run]) for k, c in LOOP.items()}
        ratios[DETERMINED] = _determination(results, int(run))
        bars = ax.bar(range(len(ratios)), list(ratios.values()), 0.7, color=COLOURS[SINGLE])
        ax.bar_label(bars, fmt="%.3f", fontsize=drawing.SMALL - 1.0, padding=1.0, rotation=90)
        ax.axhline(1.0, color=drawing.GREY, linewidth=0.8, linestyle="--")
        ax.set_xticks(range(len(ratios)), list(ratios))
        ax.set_ylim(0.0, 1.5)
        ax.grid(False, axis="x")
        y = "single-temperature / multi-layer" if panel == 0 else ""
        drawing.name_axes(ax, y=y, title=f"ambient {drawing.degrees(layered['ambient_degC'][run])}")
    return figure


def _determination(results: dict[str, EarthquakeResult], run: int) -> float:
    """Return R2 of the force (Eq. 4.38) with the multi-layer model in place of the test."""
    known = np.isfinite(results[MULTI]["time"].values[run])
    force = [results[name]["bearing_force"].values[run][known] for name in (MULTI, SINGLE)]
    expected, found = (values.astype(float) for values in force)
    return float(1.0 - ((found - expected) ** 2).sum() / ((expected - expected.mean()) ** 2).sum())


def _legend(figure: Figure, names: Sequence[str]) -> None:
    """Draw the legend of the models."""
    handles = [Line2D([], [], color=COLOURS[name], linewidth=5.0, label=name) for name in names]
    drawing.legend_below(figure, handles)


def _draw_bilinear(_runs: Runs) -> Figure:
    """Draw the bilinear model of Table 6.3, and that which follows from K_B and h_B."""
    design = source_design()["bearing"]
    end, printed, rubber = design["u_B_mm"], load_bilinear(BILINEAR), load_rubber("G8")
    thickness = printed.total_rubber_thickness
    k_b = equivalent_stiffness(rubber, design["side_mm"] ** 2, thickness, end)
    made = equivalent_bilinear(k_b, damping_ratio(rubber, end / thickness), end, STIFFNESS_RATIO)
    figure, (ax,) = drawing.panels(1, 1, (6.0, 4.2), "bilinear model of the design")
    for name, colour, numbers in (
        (
            "Table 6.3",
            "#0072B2",
            (printed.strength, printed.initial_stiffness, printed.post_yield_stiffness),
        ),
        ("from K_B and h_B", "#D55E00", (made.strength, made.initial, made.post_yield)),
    ):
        q, k1, k2 = numbers
        known = f"{name}: Q_d {q:.1f} kN, K_1 {k1:.2f}, K_2 {k2:.2f} kN/mm"
        ax.plot(*_bilinear_loop(q, k1, k2, end), color=colour, linewidth=1.3, label=known)
    known = f"K_B = {k_b:.3f} kN/mm at {end:g} mm"
    look: drawing.Look = {"color": drawing.GREY, "linestyle": "--", "linewidth": 1.0}
    ax.plot([-end, end], [-k_b * end, k_b * end], label=known, **look)
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


DRAWN: dict[str, Callable[..., Figure]] = {
    "cyclic": _draw_cyclic,
    "hybrid": _draw_hybrid,
    "both-modes": _draw_both_modes,
    "bridge": _draw_bridge,
    "bars": _draw_bars,
    "models": _draw_models,
    "measures": _draw_measures,
    "ratios": _draw_ratios,
    "over-bilinear": _draw_over_bilinear,
    "three-bearings": _draw_three_bearings,
    "ground": _draw_ground,
    "bilinear": _draw_bilinear,
    "design": _draw_design,
}
