"""What was done to records before their fit, in the table of a report and in sentences.

Both are built from the content of summary.json. Records are used as recorded only where nothing
changes their motion or their force.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from thermobearing.border.lazy import pd
from thermobearing.identify.records.cycles import DEAD
from thermobearing.identify.records.treatment import (
    DRIFT,
    KEPT,
    MAY_REMAIN,
    NOT_SIGNIFICANT,
    SIGNIFICANCE,
)
from thermobearing.identify.records.turns import describe_change
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import counted, joined, number, percent
from thermobearing.results.ranges import names_by_sentence

Row = Mapping[Any, Any]
REST_AND_JITTER = "used as recorded, rests and jitter of the displacement apart"
WEIGHTED = {  # words for the weights of a record, and the usual ones
    "weight": ("weight", 1.0),
    "first_cycle_weight": ("weight of first cycles", 1.0),
    "cycle_balance": ("balance of cycles", 0.0),
}
OF_ALL_RECORDS = (
    "Rests are held at their mean displacement, jitter of the displacement within "
    f"{DEAD:g} times its noise is no motion, and the zero of the force is fitted; no signal was "
    "filtered, scaled or shifted in time otherwise."
)


def treatment_table(records: Sequence[Row]) -> Table:
    """Return the treatment of each record before its fit: noise, turns, rests, spikes, drift."""
    rows = []
    gaps = [_missing_readings(record.get("treatment") or {}) for record in records]
    for record, missing in zip(records, gaps, strict=True):
        treatment = record.get("treatment") or {}
        removed = treatment.get("drift_removed", [])
        drift = [
            f"{name} {size}{', removed' if name in removed else ''}"
            for name, size in _drift_sizes(treatment).items()
        ]
        spikes = str(sum(treatment["spikes"].values())) if treatment else ""
        steps = [*_subtracted(treatment), *_reversed(treatment)]
        rows.append(
            {
                "test": record["name"],
                "noise_displacement_mm": treatment.get("noise", {}).get("displacement_mm"),
                "noise_force_kN": treatment.get("noise", {}).get("force_kN"),
                "dead_band_mm": treatment.get("dead_band_mm"),
                "turns_added": treatment.get("turns_added"),
                "largest_sample_mm": treatment.get("largest_sample_mm"),
                "largest_turned_mm": treatment.get("largest_displacement_mm"),
                "largest_change": _change_of_largest(treatment),
                "rests_held": treatment.get("rests"),
                "samples_at_rest": treatment.get("samples_at_rest"),
                "spikes": f"{spikes}, removed" if treatment.get("spikes_removed") else spikes,
                "drift_of_zero": "; ".join(drift) or "none",
                "offset_and_sign": ", ".join(steps) or "nothing",
                **({"missing_readings": "; ".join(missing) or "none"} if any(gaps) else {}),
                "columns_not_used": ", ".join(record.get("unused_columns", [])),
            }
        )
    note = (
        "Turns are added where straight legs meet between two samples, and the largest "
        "displacement becomes that of the motion with them; within its dead band the displacement "
        "is jitter, which the model does not follow. Rests are held at constant displacement; "
        "spikes and drift are removed on request. A drift "
        f"is stated where it is significant (two-sided, {percent(1.0 - SIGNIFICANCE)}) and exceeds "
        f"{percent(DRIFT)} of the peak of the smallest cycles, or where its removal was requested. "
        "Samples in rests are those of the file. Of each rest the calibration uses its two ends, "
        f"or {KEPT} samples where there are thermocouples; the samples in the table of tests "
        "contain these."
    )
    return make_table(pd.DataFrame(rows), caption="Treatment of the records", note=note)


def describe_treatments(records: Sequence[Row]) -> list[str]:
    """Return what was done to each record before its fit, with numbers, in the order it was done.

    Records with the same treatment share a sentence.
    """
    treated = ((str(record["name"]), record.get("treatment") or {}) for record in records)
    weights = [_weights(record.get("conditions") or {}) for record in records]
    sentences = (
        (name, _treatment_words(treatment, weighted))
        for (name, treatment), weighted in zip(treated, weights, strict=True)
    )
    return [f"{names}: {steps}." for names, steps in names_by_sentence(sentences)]


def motion_notes(records: Sequence[Row]) -> list[str]:
    """Return a sentence on the turns that were added to records, for the console."""
    treated = ((str(record["name"]), record.get("treatment") or {}) for record in records)
    sentences = ((name, joined(_added_turns(treatment))) for name, treatment in treated)
    return [f"{names}: {text}" for names, text in names_by_sentence(sentences) if text]


def _change_of_largest(treatment: Row) -> float | None:
    """Return the relative change of the largest displacement by turns that were added."""
    if not treatment.get("turns_added"):
        return None
    return float(treatment["largest_displacement_mm"] / treatment["largest_sample_mm"] - 1.0)


def _added_turns(treatment: Row) -> list[str]:
    """Return how many turns were added to a motion, and its largest displacement with them."""
    if not (count := treatment.get("turns_added")):
        return []
    ends = treatment["largest_sample_mm"], treatment["largest_displacement_mm"]
    return [
        f"{counted(count, 'turning point')} added between samples (largest displacement "
        f"{describe_change(*ends)})"
    ]


def _weights(conditions: Row) -> list[str]:
    """Return the weights of a record that are not the usual ones, in words."""
    return [
        f"{words} {number(conditions[name], '.3g')}"
        for name, (words, usual) in WEIGHTED.items()
        if conditions.get(name, usual) != usual
    ]


def _treatment_words(treatment: Row, weights: Sequence[str]) -> str:
    """Return the steps of the treatment of a record and its weights, or that there were none."""
    if steps := [*_treatment_steps(treatment), *weights]:
        return joined(steps)
    changed = treatment.get("rests") or treatment.get("dead_band_mm")
    return REST_AND_JITTER if changed else "used as recorded"


def _treatment_steps(treatment: Row) -> list[str]:
    """Return the steps of the treatment of a record, in the words of a sentence."""
    steps = [*_subtracted(treatment), *_reversed(treatment), *_missing_readings(treatment)]
    if treatment.get("spikes_removed"):
        for name, count in treatment["spikes"].items():
            steps += [f"{counted(count, 'spike')} of the {name} removed"] if count else []
    for name, size in _drift_sizes(treatment).items():
        if name in treatment["drift_removed"]:
            steps.append(f"a drift of the {name} of {size} removed{_remainder(treatment, name)}")
        else:
            steps.append(f"a drift of the {name} of {size} not removed")
    for key, offset in treatment.get("offsets", {}).items():
        name, _, unit = key.rpartition("_")
        steps.append(f"an offset of the {name} of {number(offset, '.2g')} {unit} not removed")
    if count := treatment.get("clipped_samples"):
        steps.append(f"{counted(count, 'clipped sample')} of the force left out")
    return [*steps, *_added_turns(treatment)]


def _subtracted(treatment: Row) -> list[str]:
    """Return the offsets that were subtracted from the readings of a record."""
    offsets = []
    for key, offset in treatment.get("subtracted", {}).items():
        name, _, unit = key.rpartition("_")
        offsets.append(f"{number(offset, '.3g')} {unit} subtracted from the {name}")
    return offsets


def _reversed(treatment: Row) -> list[str]:
    """Return whether the sign of the force was reversed, in words."""
    return ["the sign of the force reversed"] if treatment.get("force_reversed") else []


def _missing_readings(treatment: Row) -> list[str]:
    """Return how many readings of each temperature were missing, and how they were treated."""
    return [
        f"{counted(item['readings'], 'missing reading')} of {title} "
        f"{'filled in time' if item['filled'] else 'left out'}"
        for title, item in treatment.get("missing_readings", {}).items()
    ]


def _remainder(treatment: Row, name: str) -> str:
    """Return how much of the drift of a signal may remain after its removal, in brackets."""
    for key, error in treatment.get("drift_error", {}).items():
        signal, _, unit = key.rpartition("_")
        if signal == name:
            significant = treatment.get("drift_significant", {}).get(key, True)
            chance = "" if significant else f"; {NOT_SIGNIFICANT[:1].lower()}{NOT_SIGNIFICANT[1:]}"
            return f" (up to {number(error, '.2g')} {unit} {MAY_REMAIN}{chance})"
    return ""


def _drift_sizes(treatment: Row) -> dict[str, str]:
    """Return the drift of each signal that has one, with its 95 % interval where that is known."""
    sizes, errors = {}, treatment.get("drift_error", {})
    for key, drift in treatment.get("drift", {}).items():
        name, _, unit = key.rpartition("_")
        error = f" \N{PLUS-MINUS SIGN} {number(errors[key], '.2g')}" if key in errors else ""
        sizes[name] = f"{number(drift, '.3g')}{error} {unit}"
    return sizes
