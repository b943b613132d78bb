"""How far earlier models are from the multi-layer one in earthquakes, in numbers and pictures.

Every model drives its own motion of the structure: temperatures, forces and displacements are
compared at equal times, peaks with peaks.
"""

from collections.abc import Callable, Hashable
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.core.records import Floats
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.earlier import REFERENCE
from thermobearing.results import drawing
from thermobearing.results.differences import force_differences, more, temperature_differences

SINGLE, INNER = "single-temperature", "inner layer"
KEYS = ("bearing", "motion", "ambient_degC", "mode")
PEAKS = {  # compared with each other [%]: column of the table of a study
    "peak strain %": "bearing_strain_max",
    "energy %": "bearing_energy_kN_mm",
    "pier displacement %": "pier_displacement_max_mm",
    "pier acceleration %": "pier_top_acceleration_max_m_s2",
    "deck acceleration %": "deck_acceleration_max_m_s2",
    "loop K_eq %": "loop_K_eq_kN_mm",
    "loop h_eq %": "loop_h_eq",
}
UNDERESTIMATES = "underestimates inner layer"
TIME_BINS = 900
WIDTH, HEIGHT = 3.1, 2.3  # of one panel [inch]
BLACK: drawing.Look = {"color": "#000000", "linewidth": 1.6}
LOOP_LOOKS = {REFERENCE: BLACK, SINGLE: {"color": "#EE7733", "linewidth": 0.9}}


def comparison_table(results: dict[str, EarthquakeResult]) -> pd.DataFrame:
    """Errors of each earlier model, one row per run and model.

    Parameters
    ----------
    results : by the name of the model, the multi-layer one among them (`compare_models`).

    Returns
    -------
    DataFrame : root mean square and largest temperature error of the outer layer, the inner
        layer and the lead [K], over the whole run; error of the largest rise of the inner layer
        [K] and whether the model underestimates it; root mean square error of the force [% of
        the peak]; errors of peaks and of the largest loop [%]. A model whose run ended early,
        which its outcome says, is compared as far as it got.
    """
    truth = results[REFERENCE]
    table = truth.table
    found = {name: _runs(other) for name, other in results.items() if name != REFERENCE}
    rows = [
        _errors(truth, run, name, results[name], runs[key])
        for run, key in enumerate(_keys(table))
        for name, runs in found.items()
        if key in runs
    ]
    return pd.DataFrame(rows)


def _keys(table: pd.DataFrame) -> list[tuple[Hashable, ...]]:
    """What tells runs apart."""
    known = [name for name in KEYS if name in table]
    return [tuple(row) for row in table[known].itertuples(index=False)]


def _runs(result: EarthquakeResult) -> dict[tuple[Hashable, ...], int]:
    return {key: run for run, key in enumerate(_keys(result.table))}


def _errors(
    truth: EarthquakeResult, run: int, name: str, other: EarthquakeResult, its: int
) -> dict[str, Any]:
    expected, found = truth.table.iloc[run], other.table.iloc[its]
    row: dict[str, Any] = {key: expected[key] for key in KEYS if key in expected}
    row |= {"model": name, "outcome": found["outcome"]}
    places, those = truth.places(run), other.places(its)
    length = min(len(places[INNER]), len(those[INNER]))  # of one that ended early
    for place, values in places.items():
        if np.isfinite(values).all():
            row |= temperature_differences(place, those[place][:length], values[:length])
    inner = those[INNER][:length], places[INNER][:length]
    row[f"{INNER} rise K"] = _rise(inner[0]) - _rise(inner[1])
    row[UNDERESTIMATES] = underestimates(*inner)
    force = [r["bearing_force"].values[k, :length] for r, k in ((other, its), (truth, run))]
    row |= force_differences(force[0].astype(float), force[1].astype(float))
    row |= {label: more(found[column], expected[column]) for label, column in PEAKS.items()}
    return row


def underestimates(found: Floats, expected: Floats) -> bool:
    """Whether both the largest rise of a temperature and its mean over the run are lower.

    Examples
    --------
    >>> late = np.array([0.0, 0.0, 3.0])
    >>> underestimates(late - [0.0, 0.0, 1.0], late), underestimates(late + [0.0, 4.0, -1.0], late)
    (True, False)
    """
    return _rise(found) < _rise(expected) and float(np.mean(found - expected)) < 0.0


def _rise(values: Floats) -> float:
    """Largest rise over the start [K]."""
    return float((values - values[0]).max())


def verdict(table: pd.DataFrame) -> str:
    """Whether a single temperature underestimates the inner layer (4.4.2, 5.4.2), in a sentence.

    It does where the largest rise of the inner layer and its mean over the run are both lower.
    """
    mine = table[table["model"] == SINGLE]
    missed = mine[~mine[UNDERESTIMATES].to_numpy(dtype=bool)]
    low, high = mine[f"{INNER} rise K"].min(), mine[f"{INNER} rise K"].max()
    text = (
        f"a single temperature underestimates the inner layer in {len(mine) - len(missed)} of "
        f"{len(mine)} runs: error of its largest rise {low:+.1f} to {high:+.1f} K"
    )
    known = [name for name in KEYS if name in mine]
    not_in = [", ".join(str(part) for part in row) for row in missed[known].to_numpy()]
    return f"{text}; not in {'; '.join(not_in)}" if not_in else text


def comparison_figure(results: dict[str, EarthquakeResult]) -> Figure:
    """Inner layer in time, all models over each other (Fig. 4.13, 5.16); the first motion.

    Returns
    -------
    Figure : a row for each bearing, a column for each ambient temperature.
    """
    names = [name for name in results if name != REFERENCE]
    colours = drawing.ordered_colours(len(names), "turbo")
    looks = {REFERENCE: BLACK} | {
        name: {"color": colour, "linewidth": 0.9}
        for name, colour in zip(names, colours, strict=True)
    }

    def draw(ax: Axes, name: str, run: int) -> None:
        values = results[name].places(run)[INNER]
        time = results[name]["time"].values[run][: len(values)]
        kept = drawing.thin(values, TIME_BINS)
        ax.plot(time[kept], values[kept], **looks[name])

    what = "temperature of the inner layer"
    return _panels(results, looks, draw, what, ("time [s]", "temperature [°C]"), True)


def comparison_loops(results: dict[str, EarthquakeResult]) -> Figure:
    """Loops of the multi-layer model and of a single temperature (Fig. 4.11, 5.9, 5.12)."""

    def draw(ax: Axes, name: str, run: int) -> None:
        data = results[name].dataset
        told = np.isfinite(data["time"].values[run])
        strain = 100.0 * data["bearing_strain"].values[run, told]
        ax.plot(strain, data["bearing_force"].values[run, told], **LOOP_LOOKS[name])

    what = "loops of one bearing"
    return _panels(results, LOOP_LOOKS, draw, what, ("shear strain [%]", "force [kN]"), False)


def comparison_strains(results: dict[str, EarthquakeResult]) -> Figure:
    """Strain in time of the multi-layer model and of a single temperature (Fig. 5.10, 5.13)."""

    def draw(ax: Axes, name: str, run: int) -> None:
        strain = 100.0 * results[name]["bearing_strain"].values[run].astype(float)
        kept = drawing.thin(strain[np.isfinite(strain)], TIME_BINS)
        ax.plot(results[name]["time"].values[run][kept], strain[kept], **LOOP_LOOKS[name])

    what = "strain of one bearing"
    return _panels(results, LOOP_LOOKS, draw, what, ("time [s]", "shear strain [%]"), False)


def _panels(
    results: dict[str, EarthquakeResult],
    looks: dict[str, drawing.Look],
    draw: Callable[[Axes, str, int], None],
    what: str,
    labels: tuple[str, str],
    own_limits: bool,
) -> Figure:
    """A row for each bearing, a column for each temperature; `draw` is called for each model."""
    truth = results[REFERENCE]
    table = truth.table
    bearings, ambients = list(dict.fromkeys(table["bearing"])), sorted(set(table["ambient_degC"]))
    first = table[table["motion"] == table["motion"].iloc[0]]
    told = [str(first["motion"].iloc[0])]
    if "mode" in first:
        first = first[first["mode"] == first["mode"].iloc[0]]
        told.append(str(first["mode"].iloc[0]))
    columns = len(ambients)
    size = (max(WIDTH * columns, 6.0) + 0.6, HEIGHT * len(bearings) + 1.1)
    title = f"{truth.dataset.attrs['structure']}: {what}, {', '.join(told)}"
    figure, axes = drawing.panels(len(bearings), columns, size, title, share=not own_limits)
    runs = {name: _runs(results[name]) for name in looks}
    keys = _keys(table)
    for panel, ax in enumerate(axes):
        bearing, ambient = bearings[panel // columns], ambients[panel % columns]
        mine = first[(first["bearing"] == bearing) & (first["ambient_degC"] == ambient)]
        for key in (keys[int(run)] for run in mine.index.to_numpy()):
            for name in looks:
                if key in runs[name]:
                    draw(ax, name, runs[name][key])
        drawing.name_axes(
            ax,
            labels[0] if panel // columns == len(bearings) - 1 else "",
            labels[1] if panel % columns == 0 else "",
            f"{bearing}, {drawing.degrees(ambient)}",
        )
        ax.title.set_fontsize(drawing.SMALL)
    drawing.legend_below(figure, [Line2D([], [], label=k, **look) for k, look in looks.items()])
    return figure
