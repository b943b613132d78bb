"""What a fit found: the bearing with its numbers, how well they are known, what they are worth."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import thermobearing
from thermobearing.bearing.model import Bearing, Validity
from thermobearing.bearing.plausible import implausible
from thermobearing.border.deprecated import renamed
from thermobearing.border.showing import Shown
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.fit.parameters import ParameterSet
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.fit.start import Sensitivity
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.conditions import cycle_row, record_conditions
from thermobearing.identify.records.cycles import compare_largest_loops, compare_loops
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.thermocouples import thermocouple_rows
from thermobearing.identify.uncertainty.agreement import (
    UNUSABLE,
    RecordFit,
    fit_of_record,
    range_of_tests,
)
from thermobearing.identify.uncertainty.covariance import Estimate, Uncertainty

if TYPE_CHECKING:
    from thermobearing.identify.figures import IdentificationFigures
    from thermobearing.identify.uncertainty.posterior import Forecast

Floats = NDArray[np.float64]

SENTENCES = {
    "not_converged": "The search stopped before it converged. Give more --starts.",
    "poor_fit": "bearing.toml is marked and does not load. Look at figures/loops.png and the "
    "warnings; --accept-poor writes it without the mark.",
}


@dataclass(frozen=True, repr=False)
class Identification(Shown):
    """What a fit found.

    Attributes
    ----------
    bearing : the bearing with the identified numbers.
    pset, cube : parameters, and where the optimum lies in their unit cube.
    records, checks, predictions : tests, what was said of them, the model at their samples.
    uncertainty : standard errors, intervals, correlation, warnings in words.
    start : values the fit started from, each in the unit of its parameter.
    method, evaluations, seconds : how, and what it took: runs of all records, and time [s].
    history : evaluations, and the best mean squared relative residual so far, for a figure.
    outcome : "completed", or why not.
    problem : the residuals, for the posterior.
    sensitivity : what the tests can tell, and what is therefore free; empty where that was told.
    inputs : options of the fit, for documents.

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
    outcome: str
    problem: Problem
    sensitivity: list[Sensitivity] = field(default_factory=list)
    inputs: dict[str, Any] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        free = ", ".join(
            f"{item.parameter.kind.symbol} = {item.value:.4g}"
            for item in self.uncertainty.estimates.values()
        )
        fits = ", ".join(f"{fit.R2:.4f}" for fit in self.fits)
        return f"Identification of {self.bearing.name}: {free}; R2 {fits}; {self.outcome}"

    def show(self) -> None:
        """Print the tables that the command prints."""
        from thermobearing.identify.output import print_identification

        print_identification(self)

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
        """How well each record is met."""
        return [
            fit_of_record(record, prediction, self.bearing)
            for record, prediction in zip(self.records, self.predictions, strict=True)
        ]

    @cached_property
    def tested_range(self) -> Validity:
        """What these tests cover; it goes into the file of the bearing."""
        rubber = self.bearing.total_rubber_thickness
        return range_of_tests(self.records, self.predictions, rubber)

    @cached_property
    def cycles(self) -> pd.DataFrame:
        """One row for each cycle of each test: test, model and ratios, as of a validation."""
        rows = []
        for record, prediction in zip(self.records, self.predictions, strict=True):
            loops = compare_loops(record, prediction.force)
            largest = compare_largest_loops(record, prediction.force, loops)
            whose = {"test": record.name, "ambient_degC": record.ambient}
            whose |= {"bearing": self.bearing.name, "model": "identified"}
            rows += [whose | cycle_row(loop, largest=loop is largest) for loop in loops]
        return pd.DataFrame(rows)

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
                kind = item.parameter.kind
                said.append(
                    f"{kind.symbol} = {item.value:.4g} {kind.unit}".strip() + f" {item.where}"
                )
        return said

    def judged(self, *, accept_poor: bool = False) -> "Identification":
        """The same with the outcome "poor_fit" where it is one, unless that is accepted.

        Parameters
        ----------
        accept_poor : the user will use the bearing all the same.

        Returns
        -------
        Identification
        """
        return replace(self, outcome="poor_fit") if self.poor and not accept_poor else self

    @property
    def thermocouples(self) -> list[dict[str, Any]]:
        """Thermocouples of all tests beside the model, a row each; see `thermocouple_rows`."""
        return [
            {"test": record.name, **row}
            for record, prediction in zip(self.records, self.predictions, strict=True)
            for row in thermocouple_rows(record, prediction)
        ]

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try; empty when it completed."""
        sentence = SENTENCES.get(self.outcome, "")
        return f"{'; '.join(self.poor)}. {sentence}" if self.outcome == "poor_fit" else sentence

    @property
    def warnings(self) -> list[str]:
        """Everything a reader of the numbers must know."""
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

    def summary(self) -> dict[str, Any]:
        """The content of summary.json.

        Returns
        -------
        dict : parameters with their uncertainty, measures of each record, warnings.
        """
        estimates = self.uncertainty.estimates
        return {
            "command": "identify",
            "version": thermobearing.__version__,
            "bearing": self.bearing.name,
            "inputs": self.inputs,
            "parameters": {
                key: _estimate_summary(item, self.start.get(key)) for key, item in estimates.items()
            },
            "fixed": {
                p.kind.key: {"value": self.values[p.kind.key], "unit": p.kind.unit}
                for p in self.pset.parameters
                if p.kind.key not in estimates
            },
            "sensitivity": {item.key: item.summary() for item in self.sensitivity},
            "assumed": [told.summary() for told in self.uncertainty.assumed.told],
            "records": [
                fit.summary()
                | {"conditions": record_conditions(fit.record, self.bearing.total_rubber_thickness)}
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

    @property
    def plot(self) -> "IdentificationFigures":
        """Figures: `found.plot.loops()`, `.residuals()`, `.cycles()`, ... ."""
        from thermobearing.identify.figures import IdentificationFigures

        return IdentificationFigures(self)

    @renamed(force="overwrite")
    def save(
        self,
        directory: str | Path,
        *,
        overwrite: bool = False,
        figures: bool = True,
        forecast: "Forecast | None" = None,
    ) -> Path:
        """Write a result directory; see `save_identification`.

        Parameters
        ----------
        directory, force, figures, forecast : as in `save_identification`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.identify.output import save_identification

        return save_identification(
            self, Path(directory), overwrite=overwrite, figures=figures, forecast=forecast
        )


def _estimate_summary(item: Estimate, start: float | None) -> dict[str, Any]:
    return {
        "symbol": item.parameter.kind.symbol,
        "value": item.value,
        "unit": item.parameter.kind.unit,
        "stderr": item.stderr,
        "stderr_of_tests": item.stderr_of_tests,
        "lower": item.lower,
        "upper": item.upper,
        "at_bound": item.at_bound,
        "determined": item.determined,
        "well_determined": item.well_determined,
        "start": start,
        "bounds": [item.parameter.lower, item.parameter.upper],
    }
