"""Results of a validation: tests compared with models, verdicts, and fits by fold."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import thermobearing
from thermobearing.border.arguments import checked
from thermobearing.border.lazy import pd
from thermobearing.identify.comparison import NAN, Comparison, cycles_frame, unused_columns
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.conditions import record_conditions
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import (
    Identification,
    check_warnings,
    record_summary,
    write_digests,
    write_samples,
)
from thermobearing.identify.treatments import motion_notes
from thermobearing.model.outcomes import SENTENCES as OUTCOMES
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import counted, joined, percent
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import (
    CYCLE_TABLE,
    FIT_TABLE,
    FOLDS,
    HELD_OUT_SAMPLES,
    TABLE,
    THERMOCOUPLES,
)
from thermobearing.results.writing import without_formulas, write_csv

if TYPE_CHECKING:
    from thermobearing.identify.uncertainty.bands import Forecast

PARTLY = (
    "The model did not complete every test; the table lists the outcome of each. Try smaller "
    "strains, a warmer start or another model."
)
OF_A_FOLD = "The calibration of a fold did not converge. Increase --starts."
# Quantities with limits: relative errors, and NRMSE relative to the largest force.
QUANTITIES = {
    "K_eq": "equivalent stiffness",
    "h_eq": "equivalent damping ratio",
    "energy": "energy of a cycle",
    "force": "peak force of a cycle, either side",
    "temperature": "temperature rise, Eq. 4.39",
    "NRMSE": "root mean square error of the force",
}
RATIOS = ("F+", "F-", "K_eq", "h_eq", "energy")  # of the largest loop, model over test
ERRORS = "Largest errors of the model in each test"
WITHIN, BEYOND, REPORTED = "within", "beyond", "reported"
FITTED, HELD_OUT = "fitted", "held out"


def _verdict(limits: Mapping[str, float], name: str, error: float) -> str:
    if name not in limits or not np.isfinite(error):
        return REPORTED
    return WITHIN if abs(error) <= limits[name] else BEYOND


def _comparison_summary(item: Comparison, limits: Mapping[str, float]) -> dict[str, Any]:
    """Return the content of summary.json about a comparison."""
    top = item.largest
    largest = top and {
        "cycle": top.cycle or None,
        "D+_mm": top.displacement_max,
        "D-_mm": top.displacement_min,
        "test": top.test,
        "model": top.model,
        "ratio": top.ratios,
    }
    errors = {
        name: {
            "what": QUANTITIES[name],
            "error": error if np.isfinite(error) else None,
            "limit": limits.get(name),
            "verdict": _verdict(limits, name, error),
        }
        for name, error in item.errors.items()
    }
    return item.names | {
        "file": item.record.file,
        "conditions": record_conditions(item.record, item.rubber),
        "unused_columns": list(item.record.unused),
        "thermocouples": item.thermocouples,
        "outcome": item.outcome,
        "R2": item.R2 if np.isfinite(item.R2) else None,
        "errors": errors,
        "largest_loop": largest,
    }


@checked
@dataclass(frozen=True, repr=False)
class Validation(Result):
    """The result of a validation.

    Attributes
    ----------
    comparisons : list of Comparison
        Of every test with every bearing and model.
    limits : dict
        Largest relative error by quantity.
    warnings : list of str
        Warnings about the validity of the result.
    inputs : dict
        Bearings as tables, by name, with the sources of their numbers; for reports.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record("shen-hdr-specimen", 23.0, test)
    >>> found = tb.validate_bearing("shen-hdr-specimen", record)
    >>> found.verdict
    'within'
    """

    _figures = "ValidationFigures"
    _report_of_files = True

    comparisons: list[Comparison]
    limits: dict[str, float]
    warnings: list[str] = field(default_factory=list)
    inputs: dict[str, Any] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """The result in a line."""
        count = counted(len(self.comparisons), "comparison")
        return f"Validation: {count}, {self.verdict}, {self.outcome}"

    @property
    def outcome(self) -> str:
        """Outcome: "completed" if every model completed every test, else "partly"."""
        all_completed = all(item.prediction is not None for item in self.comparisons)
        return COMPLETED if all_completed else "partly"

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try; empty if completed."""
        outcomes = dict.fromkeys(item.outcome for item in self.comparisons)
        meanings = [OUTCOMES[name] for name in outcomes if name != COMPLETED and name in OUTCOMES]
        return "" if self.outcome == COMPLETED else " ".join([PARTLY, *meanings])

    @property
    def tested_range(self) -> "pd.DataFrame":
        """Use of the calibration range of each bearing by each test, where it is given."""
        return pd.DataFrame([row for item in self.comparisons for row in item.compared])

    @cached_property
    def table(self) -> "pd.DataFrame":
        """One row for each test, bearing and model: R2, largest errors, verdicts, largest loop."""
        rows = []
        for item in self.comparisons:
            row = item.names | {"outcome": item.outcome, "R2": item.R2}
            for name, error in item.errors.items():
                row[f"{name}_error"] = error
                row[f"{name}_verdict"] = _verdict(self.limits, name, error)
            row["beyond_tested"] = " ".join(r["limit"] for r in item.compared if r["outside"])
            ratios = item.largest.ratios if item.largest else {}
            rows.append(row | {f"{name}_ratio": ratios.get(name, NAN) for name in RATIOS})
        return pd.DataFrame(rows)

    @cached_property
    def cycles(self) -> "pd.DataFrame":
        """One row for each cycle of each test, bearing and model: test, model and ratios."""
        return cycles_frame(self.comparisons)

    @cached_property
    def thermocouples(self) -> "pd.DataFrame":
        """One row for each thermocouple of each test, bearing and model: test, model, errors."""
        rows = [item.names | row for item in self.comparisons for row in item.thermocouples]
        return pd.DataFrame(rows)

    @property
    def verdict(self) -> str:
        """Verdict: "beyond" if a limit is exceeded or a test is not completed, else "within"."""
        beyond = any(
            _verdict(self.limits, name, error) == BEYOND
            for item in self.comparisons
            for name, error in item.errors.items()
        )
        return BEYOND if beyond or self.outcome != COMPLETED else WITHIN

    def tables(self) -> dict[str, Table]:
        """Return tables of the largest errors of each test, and of thermocouples."""
        from thermobearing.identify.report import errors_table, thermocouples_table

        tables_by_name = {"errors": errors_table(ERRORS, self.table.to_dict("records"))}
        if len(self.thermocouples):
            rows = self.thermocouples.to_dict("records")
            tables_by_name["thermocouples"] = thermocouples_table(rows)
        return tables_by_name

    def notes(self) -> list[str]:
        """Unused columns of the tests, and the limits with the verdict."""
        limits = joined(f"{name} {percent(limit)}" for name, limit in self.limits.items())
        return [
            *unused_columns([item.record for item in self.comparisons]),
            f"verdict: {self.verdict} the limits of the error ({limits})",
        ]

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json: limits, verdicts and measures of each comparison."""
        return {
            "command": "validate",
            "version": thermobearing.__version__,
            "inputs": self.inputs,
            "outcome": self.outcome,
            "sentence": self.sentence,
            "verdict": self.verdict,
            "limits": self.limits,
            "warnings": self.warnings,
            **self._limits_summary(),
            "comparisons": [_comparison_summary(item, self.limits) for item in self.comparisons],
        }

    def _write(self, folder: Path) -> None:
        tables = {TABLE: self.table, CYCLE_TABLE: self.cycles, THERMOCOUPLES: self.thermocouples}
        for name, table in tables.items():
            if len(table) or name != THERMOCOUPLES:
                without_formulas(table).to_csv(folder / name, index=False)
        labels = ("test", "bearing", "model")
        samples = [
            pd.DataFrame({name: item.names[name] for name in labels} | item.samples)
            for item in self.comparisons
        ]
        write_csv(folder / FIT_TABLE, pd.concat(samples, ignore_index=True))


@dataclass(frozen=True, repr=False)
class CrossValidation(Result):
    """The result of a cross-validation: calibrations, with the tests used and held out."""

    _figures = "CrossValidationFigures"
    _report_of_files = True

    final: Identification  # calibration to all tests, or to those that the user did not hold out
    folds: list[Identification]  # without each group of tests; none if the user named them
    groups: list[list[TestRecord]]  # the tests held out, by fold
    fitted: Validation  # of the final calibration with its own tests
    held_out: Validation  # of each test held out with the calibration that did not use it
    checks: list[CheckReport]  # of the tests of `held_out`, in their order

    @property
    def headline(self) -> str:
        """The result in a line."""
        return f"{self.final.headline}; tests held out: {self.verdict}"

    @property
    def outcome(self) -> str:
        """The outcome of the fits and of the runs of the tests held out."""
        outcomes = (result.outcome for result in (self.final, *self.folds))
        return next((name for name in outcomes if name != COMPLETED), self.held_out.outcome)

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try; empty if completed."""
        if self.outcome == self.held_out.outcome:
            return self.held_out.sentence
        return self.final.sentence or OF_A_FOLD

    @property
    def verdict(self) -> str:
        """Verdict: "beyond" if a test held out exceeds a limit, else "within"."""
        return self.held_out.verdict

    @property
    def warnings(self) -> list[str]:
        """Warnings about the validity of the result."""
        # With folds, the tests are those of the final fit, which has their findings.
        checks = [] if self.folds else self.checks
        findings = [*check_warnings(checks, of_zeros=True), *check_warnings(checks, of_zeros=False)]
        fitted = self.final.warnings
        findings = [f"held out, {text}" for text in findings if text not in fitted]
        return [*fitted, *findings, *self.held_out.warnings]

    @cached_property
    def judged(self) -> Validation:
        """Comparisons of both kinds, for figures; the bearing's name includes the kind."""
        items = [
            replace(item, bearing=f"{item.bearing}, {role}")
            for role, validation in ((FITTED, self.fitted), (HELD_OUT, self.held_out))
            for item in validation.comparisons
        ]
        return Validation(items, self.held_out.limits)

    def _find_fold(self, record: TestRecord) -> int:
        """Return the fold that a test is held out of, from 1; 0 if none."""
        groups = self.groups if self.folds else []
        folds = (
            k for k, group in enumerate(groups, 1) if any(record is member for member in group)
        )
        return next(folds, 0)

    @cached_property
    def table(self) -> "pd.DataFrame":
        """One row for each test in each role: R2, largest errors and verdicts, largest loop."""
        parts = []
        for role, validation in ((FITTED, self.fitted), (HELD_OUT, self.held_out)):
            part = validation.table.copy()
            records = [item.record for item in validation.comparisons]
            fold_numbers = [
                self._find_fold(record) if role == HELD_OUT else 0 for record in records
            ]
            part.insert(0, "fold", fold_numbers)
            part.insert(0, "role", role)
            parts.append(part)
        return pd.concat(parts, ignore_index=True)

    @cached_property
    def parameters(self) -> "pd.DataFrame":
        """One row for the final fit (fold 0) and one for each fold: free parameters."""
        fits = [self.final, *self.folds]
        keys = list(dict.fromkeys(key for fit in fits for key in fit.uncertainty.estimates))
        symbols = {p.kind.key: p.kind.symbol for fit in fits for p in fit.pset.parameters}
        rows: list[dict[str, Any]] = []
        for fold, fit in enumerate(fits):
            row: dict[str, Any] = {"fold": fold, "tests": len(fit.records), "outcome": fit.outcome}
            for key in keys:
                item = fit.uncertainty.estimates.get(key)
                row[symbols[key]] = fit.values.get(key, NAN)
                row[f"{symbols[key]}_stderr"] = item.stderr if item else NAN
            rows.append(row)
        return pd.DataFrame(rows)

    @property
    def free(self) -> dict[str, str]:
        """Units of the free parameters, by symbol."""
        fits = (self.final, *self.folds)
        estimates = [item for fit in fits for item in fit.uncertainty.estimates.values()]
        return {item.parameter.kind.symbol: item.parameter.kind.unit for item in estimates}

    @cached_property
    def spread(self) -> dict[str, float]:
        """Standard error of each parameter by the jackknife over folds, by symbol.

        sqrt((K - 1) / K sum (theta_k - mean)^2), theta_k without group k: the effect of the scatter
        between tests on the parameters. Empty without folds.
        """
        rows = self.parameters.iloc[1:]
        part = (len(rows) - 1.0) / max(len(rows), 1)
        return {
            symbol: float(np.sqrt(part * ((rows[symbol] - rows[symbol].mean()) ** 2).sum()))
            for symbol in self.free
            if len(rows)
        }

    def tables(self) -> dict[str, Table]:
        """Return tables of the final fit, of parameters by fold, and of both kinds of tests."""
        from thermobearing.identify.report import errors_table

        tables_by_name = self.final.tables()
        # Those below have the errors of all tests, with the limits.
        tables_by_name.pop("records", None)
        if self.folds:
            tables_by_name["folds"] = self._folds_table()
        for role, judged in (("used in the calibration", self.fitted), (HELD_OUT, self.held_out)):
            tables_by_name[role] = errors_table(
                f"Largest errors in each test {role}", judged.table.to_dict("records")
            )
        return tables_by_name

    def _folds_table(self) -> Table:
        """Return the parameters without each fold, and their jackknife standard errors."""
        units = self.free
        columns = [Quantity("Fold"), Quantity("Held out")]
        columns += [Quantity(symbol, unit, ".4g") for symbol, unit in units.items()]
        rows: list[list[Any]] = []
        for group, row in zip([[], *self.groups], self.parameters.to_dict("records"), strict=True):
            names = ", ".join(record.name for record in group) or "none"
            rows.append([str(row["fold"] or "all"), names, *(row[symbol] for symbol in units)])
        rows.append(["", "jackknife standard error", *(self.spread[symbol] for symbol in units)])
        return Table("Parameters without each fold", columns, rows, keys=2)

    def notes(self) -> list[str]:
        """Return notes of the final fit, turns added to tests held out, and the verdict."""
        of_motion = [f"held out, {text}" for text in motion_notes(self._records_held_out)]
        return [*self.final.notes(), *of_motion, *self.held_out.notes()]

    @property
    def _records_held_out(self) -> list[dict[str, Any]]:
        """Records of the tests held out, for summary.json; none of folds.

        With folds, each test is held out once, and is among the records of the final fit.
        """
        return [*map(record_summary, self._comparisons_held_out, self.checks)]

    @property
    def _comparisons_held_out(self) -> list[Comparison]:
        """Comparisons of tests that no calibration used; none of folds."""
        return [] if self.folds else self.held_out.comparisons

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json: that of the final fit, and `held_out`."""
        held_out = {
            "verdict": self.verdict,
            "outcome": self.outcome,
            "limits": self.held_out.limits,
            "tests": self.table.to_dict("records"),
            "records": self._records_held_out,
            "thermocouples": [
                {"test": fit.record.name, **row}
                for fit in self._comparisons_held_out
                for row in fit.thermocouples
            ],
            "folds": self.parameters.to_dict("records") if self.folds else [],
            "jackknife_stderr": self.spread,
        }
        changes = {"outcome": self.outcome, "warnings": self.warnings, "held_out": held_out}
        return self.final.summary() | changes

    def with_forecast(self, forecast: "Forecast") -> "CrossValidation":
        """Return the result with a forecast of the final fit."""
        return replace(self, final=replace(self.final, forecast=forecast))

    def _write(self, folder: Path) -> None:
        self.final._write(folder)
        held_out = [item.record for item in self.held_out.comparisons]
        write_digests(folder, [*self.final.records, *held_out])
        write_csv(folder / TABLE, self.table)
        write_csv(folder / CYCLE_TABLE, self.judged.cycles)
        if fits := self._comparisons_held_out:
            write_samples(folder / HELD_OUT_SAMPLES, fits)
        if self.folds:
            write_csv(folder / FOLDS, self.parameters)
