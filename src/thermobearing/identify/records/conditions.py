"""Conditions of a test for its report: duration, amplitude, strain rate, digest of the data."""

import hashlib
from typing import Any

from thermobearing.identify.records.cycles import Loop
from thermobearing.identify.records.record import TestRecord
from thermobearing.results.ranges import cycles_in_a_row, largest_speed


def record_conditions(record: TestRecord, rubber: float) -> dict[str, Any]:
    """Conditions of a test as summary.json has them.

    Parameters
    ----------
    record : a test.
    rubber : total thickness of the bearing [mm].

    Returns
    -------
    dict : length, samples, what was reached, weights, what the file left to assume, and the
        SHA-256 of time, displacement and force as they were read.

    Examples
    --------
    >>> import numpy as np
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 4.0, 401)
    >>> record = record_from_arrays(t, 30.0 * np.sin(np.pi * t), t + 1.0, 23.0)
    >>> record_conditions(record, 30.0)["largest_strain"]
    1.0
    """
    digest = hashlib.sha256()
    for values in (record.time, record.displacement, record.force):
        digest.update(values.astype("<f8").tobytes())
    return {
        "duration_s": float(record.time[-1] - record.time[0]),
        "samples": len(record.time),
        "largest_displacement_mm": record.peak_displacement,
        "largest_strain": record.peak_displacement / rubber,
        "largest_force_kN": record.peak_force,
        "largest_speed_mm_s": largest_speed(record.time, record.displacement),
        "cycles_in_a_row": cycles_in_a_row(record.time, record.displacement),
        "thermocouples": dict(record.places),
        "weight": record.weight,
        "first_cycle_weight": record.first_cycle_weight,
        "cycle_balance": record.cycle_balance,
        "assumptions": list(record.assumptions),
        "sha256": digest.hexdigest(),
    }


def cycle_row(loop: Loop, *, largest: bool) -> dict[str, Any]:
    """A row of cycles.csv: a cycle in the test and in the model, and the ratio of the two."""
    row: dict[str, Any] = {
        "cycle": loop.cycle,
        "number": loop.number,
        "largest": largest,
        "D+_mm": loop.displacement_max,
        "D-_mm": loop.displacement_min,
    }
    for name, ratio in loop.ratios.items():
        row[f"{name}_test"] = loop.test[name]
        row[f"{name}_model"] = loop.model[name]
        row[f"{name}_ratio"] = ratio
    return row
