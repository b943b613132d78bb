"""What a fit is worth, in numbers that an engineer checks: per record and per cycle."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing
from thermobearing.border.schema import unit_of
from thermobearing.border.units import with_unit
from thermobearing.identify.cycles import cycles_of
from thermobearing.identify.forward import Prediction
from thermobearing.identify.record import TestRecord
from thermobearing.results.metrics import loop_energy

if TYPE_CHECKING:
    from thermobearing.identify.run import Identification

Floats = NDArray[np.float64]

POOR = 0.98  # coefficient of determination below which the fit is called poor
FIRST_CYCLE = 0.04  # of the peak force: first cycles stiffer than later ones by this are told
SMOOTHED = 20  # running means of a cycle over a twentieth of it, for its peaks
ENERGY = 0.15  # error of a cycle's energy that is told


@dataclass(frozen=True)
class CycleErrors:
    """Model over test minus one, of one cycle; `number` counts within the amplitude."""

    cycle: int
    number: int
    amplitude_strain: float
    G_eq_error: float
    h_eq_error: float
    energy_error: float
    force_max_error: float


@dataclass(frozen=True)
class RecordFit:
    """How well one record is met.

    Attributes
    ----------
    R2 : coefficient of determination of the force, Eq. 4.38.
    NRMSE : root mean square error of the force over the largest force of the test.
    cycles : errors of each full cycle.
    temperature_error : relative error of the temperature rise by thermocouple, Eq. 4.39.
    """

    record: TestRecord
    R2: float
    NRMSE: float
    cycles: list[CycleErrors]
    temperature_error: dict[str, float]


def determination(measured: Floats, model: Floats) -> float:
    """Coefficient of determination R^2 (contribution rate), Eq. 4.38.

    Examples
    --------
    >>> determination(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0]))
    1.0
    """
    left = float(np.sum((model - measured) ** 2))
    return 1.0 - left / float(np.sum((measured - measured.mean()) ** 2))


def fit_of_record(record: TestRecord, prediction: Prediction, bearing: Bearing) -> RecordFit:
    """Measures of one record against the model."""
    off = prediction.force - record.force
    rises = {}
    for title, values in record.temperatures.items():
        rise = float(values.max() - values[0])
        modelled = prediction.temperatures[title]
        if rise > 0.5:
            rises[title] = abs(float(modelled.max() - modelled[0]) - rise) / rise
    return RecordFit(
        record=record,
        R2=determination(record.force, prediction.force),
        NRMSE=float(np.sqrt(np.mean(off**2))) / record.peak_force,
        cycles=_cycle_errors(record, prediction.force, bearing),
        temperature_error=rises,
    )


def _peaks(force: Floats) -> tuple[float, float]:
    """Highest and lowest force of a cycle, of a short running mean: noise adds to extremes."""
    window = max(1, len(force) // SMOOTHED)
    mean = np.convolve(force, np.full(window, 1.0 / window), "valid")
    return float(mean.max()), float(mean.min())


def _cycle_errors(record: TestRecord, force: Floats, bearing: Bearing) -> list[CycleErrors]:
    found = []
    for number, cycle in enumerate(cycles_of(record), start=1):
        if cycle.closing:
            continue
        rows = slice(cycle.first, cycle.last + 1)
        x, test, model = record.displacement[rows], record.force[rows], force[rows]
        a, b = _peaks(test), _peaks(model)
        # G_e and h_eq as in Eq. 3.1 and 3.2; displacements are the same, and cancel.
        stiffness = (abs(b[0]) + abs(b[1])) / (abs(a[0]) + abs(a[1]))
        energy = loop_energy(x, model) / loop_energy(x, test)
        found.append(
            CycleErrors(
                cycle=number,
                number=cycle.number,
                amplitude_strain=cycle.amplitude / bearing.total_rubber_thickness,
                G_eq_error=stiffness - 1.0,
                h_eq_error=energy / stiffness - 1.0,
                energy_error=energy - 1.0,
                force_max_error=max(map(abs, b)) / max(map(abs, a)) - 1.0,
            )
        )
    return found


def fits(found: "Identification") -> list[RecordFit]:
    """Measures of all records of a fit."""
    return [
        fit_of_record(record, prediction, found.bearing)
        for record, prediction in zip(found.records, found.predictions, strict=True)
    ]


def model_warnings(found: "Identification") -> list[str]:
    """What the residuals say of the law itself, in words."""
    said = []
    for fit in fits(found):
        name = fit.record.name
        if fit.R2 < POOR:
            said.append(f"{name}: R2 = {fit.R2:.3f} is poor for this law, NRMSE {fit.NRMSE:.1%}")
        first = [c.force_max_error for c in fit.cycles if c.number == 1]
        later = [c.force_max_error for c in fit.cycles if c.number > 1]
        if first and later:
            stiffer = float(np.mean(later)) - float(np.mean(first))
            if stiffer > FIRST_CYCLE:
                said.append(
                    f"{name}: first cycles are {stiffer:.0%} stronger in the test than later ones "
                    "beyond what heating explains (scragging): the fitted values are averages "
                    "that belong to neither; first_cycle_weight = 0 fits the later ones"
                )
        worst = max((abs(c.energy_error) for c in fit.cycles), default=0.0)
        if worst > ENERGY:
            said.append(f"{name}: the energy of a cycle is off by up to {worst:.0%}")
    if found.outcome != "completed":
        said.append("the search stopped before it converged: give more starts")
    return said


def summary(found: "Identification") -> dict[str, Any]:
    """Content of summary.json."""
    estimates = found.uncertainty.estimates
    keys = list(estimates)
    return {
        "command": "identify",
        "bearing": found.bearing.name,
        "parameters": {
            key: {
                "symbol": item.parameter.kind.symbol,
                "value": item.value,
                "unit": item.parameter.kind.unit,
                "stderr": item.stderr,
                "lower": item.lower,
                "upper": item.upper,
                "at_bound": item.at_bound,
                "well_determined": item.well_determined,
                "start": found.start.get(key),
                "bounds": [item.parameter.lower, item.parameter.upper],
            }
            for key, item in estimates.items()
        },
        "fixed": {
            p.kind.key: {"value": found.values[p.kind.key], "unit": p.kind.unit}
            for p in found.pset.parameters
            if p.kind.key not in estimates
        },
        "records": [_record_summary(fit) for fit in fits(found)],
        "correlation": {
            "parameters": keys,
            "matrix": found.uncertainty.correlation.tolist(),
        },
        "samples": found.uncertainty.samples,
        "effective_samples": found.uncertainty.effective_samples,
        "warnings": found.warnings,
        "method": found.method,
        "evaluations": found.evaluations,
        "seconds": found.seconds,
        "outcome": found.outcome,
    }


def _record_summary(fit: RecordFit) -> dict[str, Any]:
    return {
        "name": fit.record.name,
        "file": fit.record.file,
        "ambient_degC": fit.record.ambient,
        "R2": fit.R2,
        "NRMSE": fit.NRMSE,
        "temperature_error": fit.temperature_error,
        "cycles": [vars(cycle) for cycle in fit.cycles],
    }


def bearing_table(found: "Identification", version: str) -> dict[str, Any]:
    """The fitted bearing as a library file: every number with where it comes from."""
    estimates = found.uncertainty.estimates
    tests = ", ".join(record.name for record in found.records)
    sources = found.bearing.sources
    for key, item in estimates.items():
        error = f"standard error {item.stderr:.2g}" if not item.at_bound else "at its bound"
        sources[key] = f"identified from {tests}; {error}"
    for p in found.pset.parameters:
        if p.tie is not None:
            sources[p.kind.key] = f"tied to {p.tie[1]:g} x {p.tie[0]}"
        elif p.kind.key not in estimates:
            sources.setdefault(p.kind.key, "held at the value of the starting bearing")
    table = _with_units(found.bearing, sources, "")
    table["name"] = f"{found.bearing.name}-identified"
    table["description"] = f"{found.bearing.description} (identified from tests)".strip()
    fitted = "; ".join(f"{fit.record.name}: R2 = {fit.R2:.4f}" for fit in fits(found))
    table["citation"] = f"thermobearing {version} identify, {found.method}; {fitted}"
    return table


def _with_units(model: Any, sources: dict[str, str], prefix: str) -> dict[str, Any]:
    """Nested table of a record, numbers as text with their units, sources beside them."""
    table: dict[str, Any] = {}
    for name in type(model).model_fields:
        value = getattr(model, name)
        key = f"{prefix}{name}"
        if value is None:
            continue
        if hasattr(type(value), "model_fields"):
            table[name] = _with_units(value, sources, f"{key}.")
            continue
        unit = unit_of(type(model), name)
        plain = with_unit(value, unit) if unit else value
        table[name] = {"value": plain, "source": sources[key]} if key in sources else plain
    return table


def bearing_text(found: "Identification", version: str) -> str:
    """The same as TOML, ready for `load_bearing`."""
    return tomli_w.dumps(bearing_table(found, version))


def fit_table(found: "Identification") -> str:
    """CSV of tests and model, sample by sample."""
    lines = ["record,time_s,displacement_mm,force_kN,model_force_kN\n"]
    for number, (record, prediction) in enumerate(
        zip(found.records, found.predictions, strict=True)
    ):
        columns = (record.time, record.displacement, record.force, prediction.force)
        rows = np.column_stack([np.full(len(record.time), float(number)), *columns])
        lines.append(("%d,%.9g,%.9g,%.9g,%.9g\n" * len(rows)) % tuple(rows.ravel().tolist()))
    return "".join(lines)


def write_json(path: Path, content: dict[str, Any]) -> None:
    """JSON without NaN."""
    from thermobearing.cyclic.files import without_nan

    text = json.dumps(without_nan(content), indent=2, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")
