"""The result of a calibration: bearing, parameters with their uncertainty, and agreement."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w

import thermobearing
from thermobearing.bearing.library import bearing_from_table
from thermobearing.bearing.model import Bearing, TemperatureLaw
from thermobearing.bearing.plausible import implausible
from thermobearing.bearing.scaling import extract_compound
from thermobearing.border.arguments import checked
from thermobearing.border.lazy import pd
from thermobearing.border.toml import sourced_toml, to_table, with_sources
from thermobearing.core.records import Floats
from thermobearing.identify.comparison import Comparison, cycles_frame, unused_columns
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.fit.parameters import ParameterSet, is_of_temperature
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.fit.start import Sensitivity
from thermobearing.identify.misfit import Difference, describe_differences, measure_differences
from thermobearing.identify.properties import Property, list_properties, properties_table
from thermobearing.identify.records.checks import COARSE, CheckReport, Offset
from thermobearing.identify.records.conditions import record_conditions
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.treatment import UNITS
from thermobearing.identify.records.turns import turned_amplitudes
from thermobearing.identify.treatments import motion_notes
from thermobearing.identify.uncertainty.diagnosis import MISFIT, examined_signals
from thermobearing.identify.uncertainty.evidence import Uncertainty
from thermobearing.quantities.governing import largest_by
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import percent
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import (
    COMPOUND,
    CYCLE_TABLE,
    FIT_TABLE,
    IDENTIFIED,
    INPUT_DIGESTS,
    PREDICTED,
    SAMPLES,
    THERMOCOUPLES,
)
from thermobearing.results.ranges import names_by_sentence
from thermobearing.results.writing import without_formulas, write_csv

if TYPE_CHECKING:
    from thermobearing.identify.uncertainty.bands import Forecast

REACHED_TO = 1  # decimals of a temperature that a thermocouple reached [degC]
POOR_R2 = 0.98  # coefficient of determination below which a warning is given
UNUSABLE = 0.9  # minimum for acceptance: forces with an error of 31 % throughout have this R2
FIRST_CYCLE = 0.04  # of the peak force: first cycles stiffer than later ones by this are reported
AVERAGED = (
    "The calibrated values are averages of both; first_cycle_weight = 0 in the sidecar uses the "
    "later cycles only, and a table scragging in the bearing file models both"
)
LATER = "They had no weight, so that the calibrated bearing is too soft in a first cycle"
OF_ZEROS = ("offset", "drift")  # checks of the zeros of force and displacement
ENERGY = 0.15  # error of a cycle's energy that is reported
# Fields of an estimate in summary.json.
OF_ESTIMATE = [
    "stderr",
    "stderr_of_tests",
    "lower",
    "upper",
    "at_bound",
    "determined",
    "well_determined",
]
SENTENCES = {
    "not_converged": "The search did not converge. Increase --starts.",
    "poor_fit": "bearing.toml is marked as a poor fit and cannot be loaded. See figures/loops.png "
    "and the warnings; --accept-poor writes it without the mark.",
}


def _virgin_warning(fit: Comparison) -> str:
    """Return a sentence if first cycles are stronger than heating explains; else ""."""
    first = [loop.errors["force_max_error"] for loop in fit.loops if loop.number == 1]
    later = [loop.errors["force_max_error"] for loop in fit.loops if loop.number > 1]
    stiffer = float(np.mean(later)) - float(np.mean(first)) if first and later else 0.0
    if stiffer <= FIRST_CYCLE:
        return ""
    return (
        f"{fit.record.name}: the first cycles are {percent(stiffer)} stronger than later ones, "
        "more than heating explains (scragging). "
        + (AVERAGED if fit.record.first_cycle_weight else LATER)
    )


def check_warnings(checks: Sequence[CheckReport], of_zeros: bool) -> list[str]:
    """Return the warnings of the checks, each once, with the names of its tests.

    Those of the zeros, which the checks measured, or all others. Whether samples are too far apart
    after a turn is stated of the calibrated d_y, not here.
    """
    findings = (
        (check.record.name, finding.sentence)
        for check in checks
        for finding in check.findings
        if finding.level != "note"
        and finding.check != COARSE
        and (finding.check in OF_ZEROS) is of_zeros
    )
    return [f"{names}: {sentence}" for names, sentence in names_by_sentence(findings)]


def _fit_warnings(fit: Comparison) -> list[str]:
    """Return what the residuals say about the law itself; for virgin rubber only that."""
    virgin, name = _virgin_warning(fit), fit.record.name
    warnings = [virgin] if virgin else []
    if fit.R2 < POOR_R2:
        warnings.append(f"{name}: poor agreement of the force, R2 = {fit.R2:.3f}")
    worst = max((abs(loop.errors["energy_error"]) for loop in fit.loops), default=0.0)
    if worst > ENERGY and not virgin:
        warnings.append(f"{name}: the energy of a cycle is off by up to {percent(worst)}")
    return warnings


@checked
@dataclass(frozen=True, repr=False)
class Identification(Result):
    """The result of a calibration.

    Attributes
    ----------
    bearing : the calibrated bearing; its tested range is that of the tests.
    pset, cube : parameters, and the place of the optimum in their unit cube.
    records, checks, predictions : tests, their checks, the model at their samples.
    uncertainty : standard errors, intervals, correlation, warnings.
    start : starting values by dotted key, each in the unit of its parameter.
    method, evaluations, seconds : of the search; runs of all records, and time [s].
    history : evaluations, and the best mean squared relative residual so far.
    problem : the residuals, for the posterior.
    sensitivity : how well the tests would determine each parameter; empty if `free` was given.
    inputs : options of the calibration, for reports.
    outcome : "completed", "not_converged" or "poor_fit".
    forecast : samples of the posterior and predicted bands; None without.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> found.outcome, [fit.R2 > 0.99 for fit in found.fits]
    ('completed', [True])
    >>> len(found.plot.loops().axes)
    1
    """

    _figures = "IdentificationFigures"
    _report_of_files = True

    bearing: Bearing
    pset: ParameterSet
    cube: Floats
    records: list[TestRecord]
    checks: list[CheckReport]
    predictions: list[Prediction]
    uncertainty: Uncertainty
    start: dict[str, float]
    method: str
    evaluations: int
    seconds: float
    history: list[tuple[int, float]]
    problem: Problem
    sensitivity: list[Sensitivity] = field(default_factory=list)
    inputs: dict[str, Any] = field(default_factory=dict)
    outcome: str = COMPLETED
    forecast: "Forecast | None" = None

    @property
    def headline(self) -> str:
        """Return the type and outcome of the result in a line."""
        free = ", ".join(
            f"{item.parameter.kind.symbol} = {item.value:.4g}"
            for item in self.uncertainty.estimates.values()
        )
        fits = ", ".join(f"{fit.R2:.4f}" for fit in self.fits)
        return f"Calibration of {self.bearing.name}: {free}; R2 {fits}; {self.outcome}"

    @property
    def table(self) -> "pd.DataFrame":
        """One row per free parameter: value, standard error, 95 % interval."""
        rows = [
            {"parameter": item.parameter.kind.symbol, "unit": item.parameter.kind.unit}
            | {"value": item.value, "standard_error": item.stderr}
            | {name: getattr(item, name) for name in ("lower", "upper", "at_bound")}
            for item in self.uncertainty.estimates.values()
        ]
        return pd.DataFrame(rows)

    @property
    def values(self) -> dict[str, float]:
        """All parameters by dotted key."""
        return self.pset.values(self.cube)

    @cached_property
    def fits(self) -> list[Comparison]:
        """The comparison of each test with the calibrated model."""
        name, rubber = self.bearing.name, self.bearing.total_rubber_thickness
        return [
            Comparison(record, name, "identified", rubber, prediction)
            for record, prediction in zip(self.records, self.predictions, strict=True)
        ]

    @cached_property
    def properties(self) -> list[Property]:
        """G_e, h_eq, Q_d and K_d at the temperatures of the tests, and their ratios."""
        return list_properties(self)

    @cached_property
    def cycles(self) -> "pd.DataFrame":
        """One row for each cycle of each test: test, model and ratios, as of a validation."""
        return cycles_frame(self.fits)

    @property
    def thermocouples(self) -> list[dict[str, Any]]:
        """Thermocouples of all tests and of the model, a row each."""
        return [{"test": fit.record.name, **row} for fit in self.fits for row in fit.thermocouples]

    @cached_property
    def differences(self) -> list[Difference]:
        """The differences of model and tests, signal by signal."""
        return measure_differences(self.fits, self.checks, self.problem.weights)

    def _with_size(self, sentence: str) -> str:
        """Return a sentence on the misfit with its size, signal and test."""
        size = describe_differences(self.differences)
        if not size or not sentence.startswith(MISFIT):
            return sentence
        return f"{MISFIT}: {size}{sentence.removeprefix(MISFIT)}"

    def _moved_most(self, group: int) -> dict[str, Any]:
        """Return the parameter that a standard uncertainty of an assumed group moves most.

        Relative to its value, by the shift of the optimum.
        """
        shifts = self.uncertainty.assumed.shifts[:, group]
        moves = [
            (item.parameter.kind.symbol, float(shift) * item.parameter.slope(u) / item.value)
            for item, u, shift in zip(
                self.uncertainty.estimates.values(), self.cube, shifts, strict=True
            )
            if item.value
        ]
        symbol, change = largest_by(moves, lambda move: abs(move[1])) if moves else ("", 0.0)
        return {"moves": symbol, "moves_by": change}

    def _measured_zeros(self) -> list[tuple[str, Offset]]:
        """Return the offsets that the checks warn of, each with the name of its test.

        That of a signal which drifts is a part of its drift.
        """
        return [
            (check.record.name, offset)
            for check in self.checks
            for offset in check.offsets
            if offset.warned and check.treatment and offset.name not in check.treatment.drifts
        ]

    @property
    def poor(self) -> list[str]:
        """Reasons why the bearing should not be used; empty if the agreement is acceptable."""
        reasons = [
            f"{fit.record.name}: R2 = {fit.R2:.3f}"
            for fit in self.fits
            if fit.R2 < UNUSABLE and fit.record.weight > 0.0
        ]
        for item in self.uncertainty.estimates.values():
            if item.lost and not item.parameter.kind.optional:
                value = f"{item.parameter.kind.symbol} = {item.value:.4g}"
                reasons.append(f"{value} {item.parameter.kind.unit}".strip() + f" {item.where}")
        return reasons

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try; empty if completed."""
        sentence = SENTENCES.get(self.outcome, "")
        return f"{'; '.join(self.poor)}. {sentence}" if self.outcome == "poor_fit" else sentence

    @property
    def warnings(self) -> list[str]:
        """Warnings about the validity of the result."""
        sentences = check_warnings(self.checks, of_zeros=False)
        sentences = [warning for fit in self.fits for warning in _fit_warnings(fit)] + sentences
        # First cycles that are too strong explain the misfit: other suspects would mislead.
        if not any(map(_virgin_warning, self.fits)):  # which is the cause of the misfit
            sentences = [*map(self._with_size, self.uncertainty.misfit), *sentences]
        # What was measured comes before what the residuals suggest.
        sentences = check_warnings(self.checks, of_zeros=True) + sentences
        sentences += self.uncertainty.warnings
        sentences += [
            f"the calibrated bearing has {sentence}" for sentence in implausible(self.bearing)
        ]
        if self.poor:
            sentences.append(f"this is a poor fit: {'; '.join(self.poor)}")
        if self.outcome == "not_converged":
            sentences.append("the search did not converge; increase starts")
        return sentences

    def tables(self) -> dict[str, Table]:
        """Return tables: properties, prediction, parameters, agreement, thermocouples."""
        from thermobearing.identify import report

        summary = self.summary()
        all_tables = {
            "properties": properties_table(summary["properties"]),
            "posterior": report.posterior_table(summary.get("posterior", {})),
            "parameters": report.parameters_table(summary, report.BRIEF),
            "records": report.agreement_table(summary["records"]),
            "thermocouples": report.thermocouples_table(summary["thermocouples"]),
        }
        return {name: table for name, table in all_tables.items() if table.rows}

    def notes(self) -> list[str]:
        """Return columns that are not used, turns that were added, and what the forecast says."""
        records = [*map(record_summary, self.fits, self.checks)]
        notes = [*unused_columns(self.records), *motion_notes(records)]
        if self.forecast is None:
            return notes
        return [*notes, *self.forecast.notes, *(f"warning: {t}" for t in self.forecast.warnings)]

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json: parameters, measures of each record, warnings."""
        estimates = self.uncertainty.estimates
        summary = {
            "command": "identify",
            "version": thermobearing.__version__,
            "bearing": self.bearing.name,
            "inputs": self.inputs,
            "properties": [item.summary() for item in self.properties],
            "parameters": {
                key: {
                    "symbol": item.parameter.kind.symbol,
                    "value": item.value,
                    "unit": item.parameter.kind.unit,
                    **{name: getattr(item, name) for name in OF_ESTIMATE},
                    "start": self.start.get(key),
                    "bounds": [item.parameter.lower, item.parameter.upper],
                }
                for key, item in estimates.items()
            },
            "fixed": {
                p.kind.key: {"value": self.values[p.kind.key], "unit": p.kind.unit}
                for p in self.pset.parameters
                if p.kind.key not in estimates
            },
            "sensitivity": {
                item.key: {
                    "free": item.free,
                    "stderr_of_source": item.spread if item.spread > 0.0 else None,
                    "stderr_expected": item.stderr if item.spread > 0.0 else None,
                }
                for item in self.sensitivity
            },
            **self._diagnosis(),
            "records": [*map(record_summary, self.fits, self.checks)],
            "poor": self.poor,
            "thermocouples": self.thermocouples,
            "correlation": {
                "parameters": list(estimates),
                "matrix": self.uncertainty.correlation.tolist(),
            },
            "samples": self.uncertainty.samples,
            "effective_samples": self.uncertainty.effective_samples,
            "warnings": self.warnings,
            "method": self.method,
            "evaluations": self.evaluations,
            "seconds": self.seconds,
            "outcome": self.outcome,
            "sentence": self.sentence,
        }
        return summary | ({"posterior": self.forecast.summary()} if self.forecast else {})

    def _diagnosis(self) -> dict[str, Any]:
        """Return the content of summary.json about assumed values and the causes of a misfit."""
        assumed = self.uncertainty.assumed
        suspects, named = self.uncertainty.suspects, self.uncertainty.causes
        return {
            "assumed": [
                item.summary() | {"enlarged_by": factor} | self._moved_most(k)
                for k, (item, factor) in enumerate(
                    zip(assumed.evidence, assumed.enlarging.tolist(), strict=True)
                )
            ],
            "removed_by_finer_cells": (
                cells.explained if (cells := self.uncertainty.of_cells) is not None else None
            ),
            "suspects": [
                *(zero.suspicion(name) for name, zero in self._measured_zeros()),
                *(
                    item.suspicion()
                    | {"named": item in named, "sizes": list(self.uncertainty.sizes(item))}
                    | {"explains": examined_signals(temperatures=self.problem.temperatures)}
                    for item in suspects
                ),
            ],
            "differences": [item.summary() for item in self.differences],
            "difference": describe_differences(self.differences),
        }

    def with_forecast(self, forecast: "Forecast") -> "Identification":
        """Return the result with samples of the posterior and predicted bands."""
        return replace(self, forecast=forecast)

    def _write(self, folder: Path) -> None:
        if self.forecast is not None:
            samples = pd.DataFrame(self.forecast.columns)
            samples.to_csv(folder / SAMPLES, index=False, float_format="%.6g", lineterminator="\n")
            if rows := self.forecast.cycles:
                write_csv(folder / PREDICTED, pd.DataFrame(rows))
        table = _bearing_table(self)
        (folder / IDENTIFIED).write_text(tomli_w.dumps(table), encoding="utf-8")
        if self.outcome != "poor_fit":  # other bearings must not be derived from it
            compound = extract_compound(
                bearing_from_table(table, "fit"), f"{self.bearing.name}-compound"
            )
            text = sourced_toml(compound, compound.sources)
            (folder / COMPOUND).write_text(text, encoding="utf-8")
        write_digests(folder, self.records)
        write_samples(folder / FIT_TABLE, self.fits)
        if len(self.cycles):
            write_csv(folder / CYCLE_TABLE, self.cycles)
        if rows := self.thermocouples:
            without_formulas(pd.DataFrame(rows)).to_csv(folder / THERMOCOUPLES, index=False)


def write_digests(folder: Path, records: Sequence[TestRecord]) -> None:
    """Write inputs.sha256: the digests of the files of tests, as `sha256sum -c` reads them.

    Nothing is written for tests without files.
    """
    digests = {path: digest for record in records for path, digest in record.digests.items()}
    lines = [f"{digest}  {path}\n" for path, digest in digests.items()]
    if lines:
        text = "".join(lines)
        (folder / INPUT_DIGESTS).write_text(text, encoding="utf-8", errors="surrogateescape")


def record_summary(fit: Comparison, check: CheckReport) -> dict[str, Any]:
    """Return the content of summary.json about a test, compared with the calibrated model."""
    record, amplitudes = fit.record, turned_amplitudes(fit.record)
    return {
        "name": record.name,
        "file": record.file,
        "ambient_degC": record.ambient,
        "R2": fit.R2,
        "NRMSE": fit.NRMSE,
        "temperature_error": {  # of the rise, Eq. 4.39
            row["thermocouple"]: abs(row["rise_model_K"] - row["rise_test_K"]) / row["rise_test_K"]
            for row in fit.thermocouples
            if row["rise_error"] is not None
        },
        "largest_rise_error": None if np.isnan(fit.rise_error) else fit.rise_error,
        "unused_columns": list(record.unused),
        "cycles": [
            {"cycle": loop.cycle, "number": loop.number}
            | {"amplitude_strain": amplitudes[loop.cycle - 1] / fit.rubber}
            | loop.errors
            for loop in fit.loops
        ],
        "conditions": record_conditions(record, fit.rubber),
        "treatment": check.treatment.summary() | _left(check) if check.treatment else None,
    }


def _left(check: CheckReport) -> dict[str, Any]:
    """Return offsets of which a check warns and that remain, and samples left out as clipped."""
    offsets = {
        f"{offset.name}_{UNITS[offset.name]}": offset.size
        for offset in check.offsets
        if offset.warned
    }
    return {"offsets": offsets, "clipped_samples": int(check.clipped.sum())}


def _bearing_table(identification: "Identification") -> dict[str, Any]:
    """Return the fitted bearing as the table of a library file, each number with its source."""
    bearing, tested = identification.bearing, identification.bearing.tested_range
    tests = ", ".join(record.name for record in identification.records)
    fitted = "; ".join(f"{fit.record.name}: R2 = {fit.R2:.4f}" for fit in identification.fits)
    changes: dict[str, Any] = {
        "name": f"{bearing.name}-identified",
        "description": f"{bearing.description} (identified from tests)".strip(),
        "citation": f"thermobearing {thermobearing.__version__} identify, {identification.method}; "
        f"{fitted}",
        "temperature_law": _range_of_law(identification),
    }
    if identification.outcome == "poor_fit":
        changes["poor_fit"] = "; ".join(identification.poor)
    sources = _sources(identification, tests)
    for name in tested.ranges() if tested else ():
        sources[f"tested_range.{name}"] = (
            f"the fitted model in {tests}" if name == "lead_temperature" else f"tests {tests}"
        )
    # Only a range that comes from these tests has them as its source.
    if changes["temperature_law"] is not bearing.temperature_law:
        keys = ("temperature_law.coldest", "temperature_law.warmest")
        source = "ambient temperatures of the tests; the rubber was warmer"
        if _rubber_temperatures(identification):
            source = "ambient temperatures of the tests, and the highest of their thermocouples"
        sources |= dict.fromkeys(keys, source)
    return with_sources(to_table(bearing.model_copy(update=changes)), sources)


def _range_of_law(identification: "Identification") -> TemperatureLaw | None:
    """Return the temperature law with the temperatures of the tests as its range.

    From the coldest chamber to the warmest, or to the highest temperature that a thermocouple in
    the rubber reached. Only if m_T, n_T or parameters of a registered law were free. Tests at one
    ambient temperature determine no range.
    """
    law = identification.bearing.temperature_law
    if not any(map(is_of_temperature, identification.uncertainty.estimates)):
        return law
    ambients = [record.ambient for record in identification.records]
    reached = _rubber_temperatures(identification)
    low, high = None, None
    if len(set(ambients)) > 1:
        low, high = min(ambients), round(max([*ambients, *reached]), REACHED_TO)
    if law is None or not law.has_factors:
        return TemperatureLaw(coldest=low, warmest=high) if low is not None else None
    return law.model_copy(update={"coldest": low, "warmest": high})


def _rubber_temperatures(identification: "Identification") -> list[float]:
    """Return the highest temperature [degC] of each thermocouple in the rubber of the tests."""
    return [
        float(np.nanmax(values))
        for record in identification.records
        for title, values in record.temperatures.items()
        if record.places[title].startswith("rubber")
    ]


def _sources(identification: "Identification", tests: str) -> dict[str, str]:
    estimates, sources = identification.uncertainty.estimates, identification.bearing.sources
    for key, item in estimates.items():
        error = f"standard error {item.stderr:.2g} {item.parameter.kind.unit}".rstrip()
        error += f" ({abs(item.stderr / item.value):.1%})" if item.value else ""
        error = error if item.determined else f"not determined, {item.where}"
        sources[key] = f"identified from {tests}; {error}"
    for p in identification.pset.parameters:
        if p.tie is not None:
            sources[p.kind.key] = f"tied to {p.tie[1]:g} x {p.tie[0]}"
        else:
            sources.setdefault(p.kind.key, "held at the value of the starting bearing")
    return sources


def write_samples(file: Path, fits: Sequence[Comparison]) -> None:
    """Write tests and model sample by sample: number of the record, s, mm, kN, degC."""
    frames = (pd.DataFrame({"record": k, **fit.samples}) for k, fit in enumerate(fits))
    table = without_formulas(pd.concat(frames))
    table.to_csv(file, index=False, float_format="%.9g", lineterminator="\n")
