"""Conditions of a test for summary.json: length, largest motion, sensors, digests."""

import hashlib
from typing import Any

from thermobearing.identify.records.record import WEIGHTS, TestRecord
from thermobearing.identify.records.turns import largest_displacement
from thermobearing.results.ranges import cycles_in_a_row, largest_speed
from thermobearing.tables.conditioning import Conditioning


def record_conditions(record: TestRecord, rubber: float) -> dict[str, Any]:
    """Return the content of summary.json about the conditions of a test.

    The largest displacement is that of the motion, which may turn between two samples. `rubber` is
    the total thickness of the bearing's rubber [mm]. `sha256` is the digest of time,
    displacement and force of the record, `files` has those of the files that it was read from.
    """
    largest = largest_displacement(record)
    digest = hashlib.sha256()
    for values in (record.time, record.displacement, record.force):
        digest.update(values.astype("<f8").tobytes())
    return {
        "duration_s": float(record.time[-1] - record.time[0]),
        "samples": len(record.time),
        "largest_displacement_mm": largest,
        "largest_strain": largest / rubber,
        "largest_force_kN": record.peak_force,
        "largest_speed_mm_s": largest_speed(record.time, record.displacement),
        "cycles_in_a_row": cycles_in_a_row(record.time, record.displacement),
        "mean_ambient_degC": record.ambient + record.air_offset,
        "thermocouples": dict(record.places),
        **{name: getattr(record, name) for name in WEIGHTS},
        **record.about,
        **_stated_conditioning(record.conditioning),
        **_stated_axial(record),
        "assumptions": list(record.assumptions),
        "sha256": digest.hexdigest(),
        **({"files": dict(record.digests)} if record.digests else {}),
    }


def _stated_conditioning(conditioning: Conditioning | None) -> dict[str, Any]:
    """Return the conditioning of a record for summary.json; nothing if it is not stated."""
    if conditioning is None:
        return {}
    return {
        "conditioned_h": conditioning.conditioned,
        "before_degC": conditioning.before,
        "inside_degC": conditioning.inside,
        "inside_place": conditioning.inside_place,
        "chamber_film_W_m2K": conditioning.chamber_film,
    }


def _stated_axial(record: TestRecord) -> dict[str, Any]:
    """Return the axial force of a record for summary.json; nothing where none is stated.

    The ends of one that acts on the shear force of the model, or the value of one that does not.
    """
    if record.axial is not None:
        force = record.axial.force
        return {"axial_force_kN": [float(force.min()), float(force.max())]}
    stated = record.stated_axial_force
    return {} if stated is None else {"stated_axial_force_kN": stated}
