"""Several models through the same test: how far each is from a reference, in numbers and pictures.

The simpler models may have one temperature for all layers, or none that changes; outer and inner
layer of each are compared with those of the reference at the times of the reference.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.cyclic.result import Result
from thermobearing.results import drawing
from thermobearing.results.selection import (
    force_differences,
    more,
    temperature_differences,
)

Floats = NDArray[np.float64]
PLACES = ("outer layer", "inner layer")
PEAK = "peak stress"


def _loading_rows(result: Result, run: int) -> NDArray[np.int64]:
    """Kept steps of a run during which the bearing was being loaded (not at rest)."""
    kinds = np.array([about["kind"] != "rest" for about in result.segments])
    segment = result["segment"].values[run]
    return np.flatnonzero((segment >= 0) & kinds[np.maximum(segment, 0)])


def _temperatures(result: Result, run: int, place: str) -> Floats:
    """Of a layer, or of the lead, at all kept steps."""
    if place == "lead":
        return np.asarray(result["lead_temperature"].values[run])
    values = result["rubber_temperature"].values[run]
    half = bool(result.dataset.attrs["half_stack"])
    inner = values.shape[1] - 1 if half else values.shape[1] // 2
    return np.asarray(values[:, 0 if place == "outer layer" else inner])


def _compared_places(result: Result) -> list[str]:
    """Where temperatures are compared."""
    return [*PLACES, *(["lead"] if result.has_lead else [])]


def comparison_table(results: dict[str, Result], reference: str) -> pd.DataFrame:
    """Errors of each model against the reference, one row per ambient temperature and model.

    Parameters
    ----------
    results : of the same test, by the name of the model.
    reference : name of the one to compare with.

    Returns
    -------
    DataFrame : over the loadings, root mean square and largest temperature error of the outer
        layer, the inner layer and the lead [K]; root mean square force error [% of the peak];
        error of G_e, h_eq and energy of the last cycle and of the peak force [%]. A model whose
        run ended early, which its outcome says, is compared as far as it got.
    """
    truth = results[reference]
    rows = [
        _errors(truth, other, name, run)
        for run in range(truth.dataset.sizes["ambient"])
        for name, other in results.items()
        if name != reference
    ]
    return pd.DataFrame(rows)


def _errors(truth: Result, other: Result, name: str, run: int) -> dict[str, Any]:
    ambient = float(truth["ambient"].values[run])
    row: dict[str, Any] = {"ambient_degC": ambient, "model": name}
    row["outcome"] = str(other["outcome"].values[run])
    cycles = [r.cycles[r.cycles["ambient_degC"] == ambient] for r in (other, truth)]
    if cycles[0].empty:  # nothing to compare
        return row
    kept = np.isfinite(other["force"].values[run])
    loaded = _loading_rows(truth, run)
    loaded = loaded[loaded < len(kept)]
    loaded = loaded[kept[loaded]]
    for place in _compared_places(truth):
        found, expected = (_temperatures(r, run, place)[loaded] for r in (other, truth))
        row |= temperature_differences(place, found, expected)
    row |= force_differences(*(r["force"].values[run, loaded] for r in (other, truth)))
    last = [table.iloc[len(cycles[0]) - 1] for table in cycles]
    for column, label in (("G_eq_MPa", "G_e"), ("h_eq", "h_eq"), ("energy_kN_mm", "energy")):
        row[f"last {label} %"] = more(last[0][column], last[1][column])
    return row


def comparison_figure(results: dict[str, Result], reference: str) -> Figure:
    """Errors of each model at the end of each cycle of the test, one line per model.

    Returns
    -------
    Figure : a row of panels for each place (outer layer, inner layer, lead) [K] and one for the
        peak stress of each cycle [%]; a column for each ambient temperature.
    """
    truth = results[reference]
    ambient = truth["ambient"].values
    rows = [*_compared_places(truth), PEAK]
    others = [name for name in results if name != reference]
    colours = dict(zip(others, drawing.ordered_colours(len(others), "turbo"), strict=True))
    size = (max(7.0, 1.5 + 3.4 * len(ambient)), 1.4 + 1.9 * len(rows))
    title = f"{truth.dataset.attrs['title']}: earlier models against the {reference} one"
    figure, axes = drawing.panels(len(rows), len(ambient), size, title)
    for line, row in enumerate(rows):
        shared = axes[line * len(ambient) : (line + 1) * len(ambient)]
        for run, ax in enumerate(shared):
            expected = _at_cycles(truth, run, row)
            for name, colour in colours.items():
                found = _at_cycles(results[name], run, row)
                same = expected[: len(found)]  # those of a run that ended early
                error = 100.0 * (found / same - 1.0) if row == PEAK else found - same
                numbers = np.arange(1, len(error) + 1)
                ax.plot(numbers, error, color=colour, marker=".", markersize=3.5, linewidth=0.9)
            ax.axhline(0.0, color=drawing.INK, linewidth=0.8)
            if line == 0:
                drawing.name_axes(ax, title=f"ambient {drawing.degrees(float(ambient[run]))}")
        low, high = drawing.common_limits(shared)
        for ax in shared:
            ax.set_ylim(low, high)
        label = f"{row} [%]" if row == PEAK else f"error of {row} [K]"
        drawing.name_axes(shared[0], y=label)
    for ax in axes[-len(ambient) :]:
        drawing.name_axes(ax, "cycle of the test")
    handles = [Line2D([], [], color=colours[name], label=name) for name in others]
    drawing.legend_below(figure, handles)
    return figure


def _at_cycles(result: Result, run: int, row: str) -> Floats:
    """Temperature at the end, or the largest stress, of each cycle."""
    cycles = result.cycles
    mine = cycles[cycles["ambient_degC"] == float(result["ambient"].values[run])]
    if row == PEAK:
        return np.asarray(mine["stress_max_MPa"], dtype=float)
    layers = result.dataset.sizes["layer"]
    inner = layers if result.dataset.attrs["half_stack"] else layers // 2 + 1
    name = {"lead": "lead_degC", "outer layer": "rubber1_degC"}.get(row, f"rubber{inner}_degC")
    return np.asarray(mine[name], dtype=float)
