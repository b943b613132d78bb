"""The result of a calibration: the bearing with its numbers, their uncertainty, the agreement."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

import thermobearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.plausible import implausible
from thermobearing.border.deprecated import renamed
from thermobearing.border.errors import printable
from thermobearing.core.records import Floats
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.fit.parameters import ParameterSet
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.fit.start import Sensitivity
from thermobearing.identify.output import write_identification
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.cycles import compare_largest_loops
from thermobearing.identify.records.record import TestRecord, record_conditions
from thermobearing.identify.uncertainty.agreement import (
    UNUSABLE,
    RecordFit,
    fit_of_record,
    thermocouple_rows,
)
from thermobearing.identify.uncertainty.covariance import Uncertainty
from thermobearing.quantities.tables import Table
from thermobearing.results.base import COMPLETED, Result

if TYPE_CHECKING:
    from thermobearing.identify.uncertainty.posterior import Forecast

OF_ESTIMATE = ["stderr", "stderr_of_tests", "lower", "upper", "at_bound"]  # in summary.json
OF_ESTIMATE += ["determined", "well_determined"]
SENTENCES = {
    "not_converged": "The search stopped before it converged. Give more --starts.",
    "poor_fit": "bearing.toml is marked and does not load. Look at figures/loops.png and the "
    "warnings; --accept-poor writes it without the mark.",
}


@dataclass(frozen=True, repr=False)
class Identification(Result):
    """The result of a calibration.

    Attributes
    ----------
    bearing : the bearing with the identified numbers; its tested range is what the tests cover.
    pset, cube : parameters, and the place of the optimum in their unit cube.
    records, checks, predictions : tests, their checks, the model at their samples.
    uncertainty : standard errors, intervals, correlation, warnings.
    start : starting values by dotted key, each in the unit of its parameter.
    method, evaluations, seconds : of the search; runs of all records, and time [s].
    history : evaluations, and the best mean squared relative residual so far.
    problem : the residuals, for the posterior.
    sensitivity : what the tests would determine; empty if the user chose what is free.
    inputs : options of the fit, for reports.
    outcome : "completed", "not_converged" or "poor_fit".
    forecast : samples of the posterior and predicted bands, shown and saved too; None without.

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
        """What it is and how it ended, in a line."""
        free = ", ".join(
            f"{item.parameter.kind.symbol} = {item.value:.4g}"
            for item in self.uncertainty.estimates.values()
        )
        fits = ", ".join(f"{fit.R2:.4f}" for fit in self.fits)
        return f"Identification of {self.bearing.name}: {free}; R2 {fits}; {self.outcome}"

    @property
    def table(self) -> pd.DataFrame:
        """One row per free parameter: value, standard error, 95 % interval."""
        rows = [
            {
                "parameter": item.parameter.kind.symbol,
                "unit": item.parameter.kind.unit,
                "value": item.value,
                "standard_error": item.stderr,
                "lower": item.lower,
                "upper": item.upper,
                "at_bound": item.at_bound,
            }
            for item in self.uncertainty.estimates.values()
        ]
        return pd.DataFrame(rows)

    @property
    def values(self) -> dict[str, float]:
        """All parameters by dotted key."""
        return self.pset.values(self.cube)

    @cached_property
    def fits(self) -> list[RecordFit]:
        """Agreement with each record."""
        return [
            fit_of_record(record, prediction, self.bearing)
            for record, prediction in zip(self.records, self.predictions, strict=True)
        ]

    @cached_property
    def cycles(self) -> pd.DataFrame:
        """One row for each cycle of each test: test, model and ratios, as of a validation."""
        rows = []
        for fit, prediction in zip(self.fits, self.predictions, strict=True):
            largest = compare_largest_loops(fit.record, prediction.force, fit.loops)
            whose = {"test": fit.record.name, "ambient_degC": fit.record.ambient}
            whose |= {"bearing": self.bearing.name, "model": "identified"}
            rows += [whose | loop.row(largest=loop is largest) for loop in fit.loops]
        return pd.DataFrame(rows)

    @property
    def thermocouples(self) -> list[dict[str, Any]]:
        """Thermocouples of all tests and of the model, a row each."""
        return [
            {"test": record.name, **row}
            for record, prediction in zip(self.records, self.predictions, strict=True)
            for row in thermocouple_rows(record, prediction)
        ]

    @property
    def poor(self) -> list[str]:
        """Why the bearing should not be used; empty for a fit that is good enough."""
        said = [
            f"{fit.record.name}: R2 = {fit.R2:.3f}"
            for fit in self.fits
            if fit.R2 < UNUSABLE and fit.record.weight > 0.0
        ]
        for item in self.uncertainty.estimates.values():
            if item.lost:
                value = f"{item.parameter.kind.symbol} = {item.value:.4g}"
                said.append(f"{value} {item.parameter.kind.unit}".strip() + f" {item.where}")
        return said

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try; empty when it completed."""
        sentence = SENTENCES.get(self.outcome, "")
        return f"{'; '.join(self.poor)}. {sentence}" if self.outcome == "poor_fit" else sentence

    @property
    def warnings(self) -> list[str]:
        """What a reader must know before using the numbers."""
        said = [f.sentence for check in self.checks for f in check.findings if f.level != "note"]
        said = [warning for fit in self.fits for warning in fit.warnings] + said
        if not any(fit.virgin for fit in self.fits):  # which is the cause of the misfit
            said = self.uncertainty.misfit + said
        said += self.uncertainty.warnings
        said += [f"the fitted bearing has {sentence}" for sentence in implausible(self.bearing)]
        if self.poor:
            said.append(f"a poor fit: {'; '.join(self.poor)}")
        if self.outcome == "not_converged":
            said.append("the search stopped before it converged: give more starts")
        return said

    def tables(self) -> dict[str, Table]:
        """Tables of parameters, of the agreement with the tests, and of thermocouples."""
        from thermobearing.identify import tables

        summary = self.summary()
        found = {
            "parameters": tables.parameters_table(summary, tables.BRIEF),
            "records": tables.agreement_table(summary["records"]),
            "thermocouples": tables.thermocouples_table(summary["thermocouples"]),
            "posterior": tables.posterior_table(summary.get("posterior", {})),
        }
        return {name: table for name, table in found.items() if table.rows}

    def notes(self) -> list[str]:
        """Columns of the tests that are not used, and warnings of the forecast."""
        unused = [
            printable(f"{record.name}: columns not used: {', '.join(record.unused)}")
            for record in self.records
            if record.unused
        ]
        ahead = self.forecast.warnings if self.forecast else ()
        return [*dict.fromkeys(unused), *(f"warning: {text}" for text in ahead)]

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json: parameters, measures of each record, warnings."""
        estimates = self.uncertainty.estimates
        rubber = self.bearing.total_rubber_thickness
        summary = {
            "command": "identify",
            "version": thermobearing.__version__,
            "bearing": self.bearing.name,
            "inputs": self.inputs,
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
            "sensitivity": {item.key: item.summary() for item in self.sensitivity},
            "assumed": [item.summary() for item in self.uncertainty.assumed.evidence],
            "records": [
                fit.summary()
                | {"conditions": record_conditions(fit.record, rubber)}
                | {"treatment": check.treatment.summary() if check.treatment else None}
                for fit, check in zip(self.fits, self.checks, strict=True)
            ],
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

    @renamed(force="overwrite")
    def save(
        self,
        directory: str | Path,
        *,
        overwrite: bool = False,
        figures: bool = True,
        forecast: "Forecast | None" = None,
    ) -> Path:
        """Write a result directory; see docs/files.md.

        Parameters
        ----------
        directory : made if needed, with its parents.
        overwrite : replace an earlier result directory.
        figures : draw the figures too.
        forecast : samples of the posterior and bands at other temperatures.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `overwrite` is False, or it cannot be written.
        """
        found = self if forecast is None else replace(self, forecast=forecast)
        return Result.save(found, directory, overwrite=overwrite, figures=figures)

    def _write(self, folder: Path) -> None:
        write_identification(self, folder)
