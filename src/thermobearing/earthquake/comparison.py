"""Earlier models compared with the multi-layer model.

Every model drives its own motion of the structure: temperatures, forces and displacements are
compared at equal times, peaks with peaks.
"""

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from thermobearing.core.records import Floats
from thermobearing.earthquake.measures import KEYS
from thermobearing.model.earlier import REFERENCE
from thermobearing.results.selection import force_differences, more, temperature_differences

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

SINGLE, INNER = "single-temperature", "inner layer"
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


def comparison_table(results: "dict[str, EarthquakeResult]") -> pd.DataFrame:
    """Return the errors of each earlier model, one row per run and model.

    `results` are by the name of the model, the multi-layer one among them (`compare_models`). The
    columns hold the root mean square and largest temperature error of the outer layer, the inner
    layer and the lead [K], over the whole run; the error of the largest rise of the inner layer
    [K] and whether the model underestimates it; the root mean square error of the force [% of
    the peak]; errors of peaks and of the largest loop [%]. A run that ended early, which its
    outcome says, is compared up to its end.
    """
    truth = results[REFERENCE]
    table = truth.table
    found = {name: run_keys(other) for name, other in results.items() if name != REFERENCE}
    rows = [
        _errors(truth, run, name, results[name], runs[key])
        for run, key in enumerate(_keys(table))
        for name, runs in found.items()
        if key in runs
    ]
    return pd.DataFrame(rows)


def _keys(table: pd.DataFrame) -> list[tuple[Hashable, ...]]:
    known = [name for name in KEYS if name in table]
    return [tuple(row) for row in table[known].itertuples(index=False)]


def run_keys(result: "EarthquakeResult") -> dict[tuple[Hashable, ...], int]:
    """Return the runs of a result by bearing, motion, ambient temperature and mode."""
    return {key: run for run, key in enumerate(_keys(result.table))}


def _errors(
    truth: "EarthquakeResult", run: int, name: str, other: "EarthquakeResult", its: int
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
    """Return whether both the largest rise of a temperature and its mean over the run are lower.

    Examples
    --------
    >>> late = np.array([0.0, 0.0, 3.0])
    >>> underestimates(late - [0.0, 0.0, 1.0], late), underestimates(late + [0.0, 4.0, -1.0], late)
    (True, False)
    """
    return _rise(found) < _rise(expected) and float(np.mean(found - expected)) < 0.0


def _rise(values: Floats) -> float:
    return float((values - values[0]).max())


def verdict(table: pd.DataFrame) -> str:
    """Return whether a single temperature underestimates the inner layer, in a sentence.

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
