"""Comparison of earlier models with the multi-layer model: errors of each run, and a verdict.

Each model drives its own motion of the structure: temperatures, forces and displacements are
compared at equal times, peaks with peaks.
"""

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.earthquake import measures
from thermobearing.model.earlier import REFERENCE
from thermobearing.results.selection import force_differences, more, temperature_differences

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

SINGLE, INNER = "single-temperature", "inner layer"
COMPARED = {  # compared with each other [%]: column of the table of a study
    "peak strain %": "bearing_strain_max",
    "energy %": "bearing_energy_kN_mm",
    "pier displacement %": "pier_displacement_max_mm",
    "pier acceleration %": "pier_top_acceleration_max_m_s2",
    "deck acceleration %": "deck_acceleration_max_m_s2",
    "loop K_eq %": "loop_K_eq_kN_mm",
    "loop h_eq %": "loop_h_eq",
}
UNDERESTIMATES = "underestimates inner layer"


def comparison_table(results: "dict[str, EarthquakeResult]") -> "pd.DataFrame":
    """Return the errors of each earlier model, one row per run and model.

    Errors of temperatures [K], of the force [% of the peak], and of peaks and the largest loop
    [%], up to the end of a run that ended early.
    """
    reference = results[REFERENCE]
    table = reference.table
    # Models that do not fit a bearing leave out its runs, so that numbers of runs differ.
    runs_by_model = {
        name: run_keys(model_result) for name, model_result in results.items() if name != REFERENCE
    }
    rows = [
        _errors(reference, run, name, results[name], runs[key])
        for run, key in enumerate(_labels(table))
        for name, runs in runs_by_model.items()
        if key in runs
    ]
    return pd.DataFrame(rows)


def _labels(table: "pd.DataFrame") -> list[tuple[Hashable, ...]]:
    return [tuple(row) for row in table[measures.key_columns(table)].itertuples(index=False)]


def run_keys(result: "EarthquakeResult") -> dict[tuple[Hashable, ...], int]:
    """Return the runs of a result by bearing, motion, ambient temperature and mode."""
    return {key: run for run, key in enumerate(_labels(result.table))}


def _errors(
    reference: "EarthquakeResult",
    run: int,
    name: str,
    model_result: "EarthquakeResult",
    model_run: int,
) -> dict[str, Any]:
    expected, model_row = reference.table.iloc[run], model_result.table.iloc[model_run]
    row: dict[str, Any] = {key: expected[key] for key in measures.KEYS if key in expected}
    row |= {"model": name, "outcome": model_row["outcome"]}
    places, model_places = reference.places(run), model_result.places(model_run)
    # Of a run that ended early the other's history is cut: errors are at equal times.
    length = min(len(places[INNER]), len(model_places[INNER]))
    for place, values in places.items():
        if np.isfinite(values).all():
            row |= temperature_differences(place, model_places[place][:length], values[:length])
    model_inner, inner = model_places[INNER][:length], places[INNER][:length]
    row[f"{INNER} rise K"] = _rise(model_inner) - _rise(inner)
    row[UNDERESTIMATES] = _underestimates(model_inner, inner)
    model_force = model_result["bearing_force"].values[model_run, :length].astype(float)
    force = reference["bearing_force"].values[run, :length].astype(float)
    row |= force_differences(model_force, force)
    row |= {label: more(model_row[column], expected[column]) for label, column in COMPARED.items()}
    return row


def _underestimates(model_values: Floats, expected: Floats) -> bool:
    """Return whether both the largest rise of a temperature and its mean over the run are lower.

    >>> late = np.array([0.0, 0.0, 3.0])
    >>> _underestimates(late - [0.0, 0.0, 1.0], late)
    True
    >>> _underestimates(late + [0.0, 4.0, -1.0], late)
    False
    """
    return _rise(model_values) < _rise(expected) and float(np.mean(model_values - expected)) < 0.0


def _rise(values: Floats) -> float:
    return float((values - values[0]).max())


def verdict(table: "pd.DataFrame") -> str:
    """Return whether a single temperature underestimates the inner layer, in a sentence."""
    single_rows = table[table["model"] == SINGLE]
    missed = single_rows[~single_rows[UNDERESTIMATES].to_numpy(dtype=bool)]
    low, high = single_rows[f"{INNER} rise K"].min(), single_rows[f"{INNER} rise K"].max()
    count, runs = len(single_rows) - len(missed), len(single_rows)
    text = (
        f"a single temperature underestimates the inner layer in {count} of {runs} runs: error of "
        f"its largest rise {low:+.1f} to {high:+.1f} K"
    )
    not_in = [
        ", ".join(str(part) for part in row)
        for row in missed[measures.key_columns(single_rows)].to_numpy()
    ]
    return f"{text}; not in {'; '.join(not_in)}" if not_in else text
