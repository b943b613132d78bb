"""The multi-layer model beside the earlier one with a single temperature, in hybrid tests.

The source lays the test beside both. Its records are not public: here the one model is measured by
the other, which says how much the layers change, not which of the two is right.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.reproduce.figures.words import MULTI, SINGLE, hybrid_tests
from thermobearing.reproduce.runs import Runs
from thermobearing.results import drawing

COLOURS = {MULTI: "#000000", SINGLE: "#EE7733"}
LOOP = {  # bars of Fig. 5.11 and 5.14: column of the table of largest loops
    "F+": "F_plus_kN",
    "F\N{MINUS SIGN}": "F_minus_kN",
    "D+": "D_plus_mm",
    "D\N{MINUS SIGN}": "D_minus_mm",
    "MaxE": "energy_kN_mm",
}
DETERMINED = "R\N{SUPERSCRIPT TWO}"


def both_models(runs: Runs, bearing: str, mode: str) -> dict[str, EarthquakeResult]:
    """Hybrid tests of a bearing by each model, by its name."""
    return {model: hybrid_tests(runs, bearing, mode, model) for model in (MULTI, SINGLE)}


def draw_measures(
    results: dict[str, EarthquakeResult], title: str, shown: Sequence[tuple[str, str]]
) -> Figure:
    """Bars of measures of the largest loop: a panel a measure, a group a temperature.

    Parameters
    ----------
    results : by the name of the model.
    title : of the figure.
    shown : column of `largest_loops`, and label, of each panel.
    """
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


def draw_ratios(results: dict[str, EarthquakeResult], title: str) -> Figure:
    """Measures with a single temperature over those with layers, and R2 of the force between them.

    A panel a temperature; 1 is agreement.
    """
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
        y = "single temperature over multi-layer" if panel == 0 else ""
        drawing.name_axes(ax, y=y, title=f"ambient {drawing.degrees(layered['ambient_degC'][run])}")
    return figure


def _determination(results: dict[str, EarthquakeResult], run: int) -> float:
    """R2 of the force of one bearing (Eq. 4.38), the layers in the place of the test."""
    told = np.isfinite(results[MULTI]["time"].values[run])
    force = [results[name]["bearing_force"].values[run][told] for name in (MULTI, SINGLE)]
    expected, found = (values.astype(float) for values in force)
    return float(1.0 - ((found - expected) ** 2).sum() / ((expected - expected.mean()) ** 2).sum())


def _legend(figure: Figure, names: Sequence[str]) -> None:
    """The models' colours."""
    handles = [Line2D([], [], color=COLOURS[name], linewidth=5.0, label=name) for name in names]
    drawing.legend_below(figure, handles)
