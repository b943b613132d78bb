"""What a validation found: each test beside each bearing and model, ratios, verdicts."""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import thermobearing
from thermobearing.border.deprecated import renamed
from thermobearing.border.showing import Shown
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.records.cycles import Loop
from thermobearing.identify.records.record import TestRecord, record_conditions
from thermobearing.identify.uncertainty.agreement import thermocouple_rows
from thermobearing.model.outcomes import SENTENCES as OUTCOMES
from thermobearing.results.ranges import Row
from thermobearing.results.writing import limits_summary
from thermobearing.validate.case import QUANTITIES

if TYPE_CHECKING:
    from thermobearing.validate.figures import ValidationFigures

Floats = NDArray[np.float64]

SENTENCES = {
    "partly": "The model did not get through every test; see the outcome of each in the table. "
    "Smaller strains, a warmer start or another model would.",
}
RATIOS = ("F+", "F-", "K_eq", "h_eq", "energy")  # of the largest loop, model over test
WITHIN, BEYOND, TOLD = "within", "beyond", "told"


@dataclass(frozen=True)
class Comparison:
    """One test beside one bearing and model.

    Attributes
    ----------
    bearing, model : names.
    record : the test.
    prediction : force and temperatures at its samples; None where the model did not get through.
    R2 : coefficient of determination of the force, Eq. 4.38.
    NRMSE : root mean square error of the force over the largest force of the test.
    loops : full cycles.
    largest : the loop that holds the largest displacement, one of `loops` or not; None where none
        does.
    temperature_errors : error of the temperature rise in time over the largest rise of the test,
        by thermocouple.
    outcome : of the model's run, as of a cyclic test.
    asked : what the test asks of the range that the bearing was tested in, rows of `compared`.
    rubber : total thickness of the bearing [mm]; 0 where nobody said it.
    """

    bearing: str
    model: str
    record: TestRecord
    prediction: Prediction | None
    R2: float
    NRMSE: float
    loops: list[Loop]
    largest: Loop | None
    temperature_errors: dict[str, Floats]
    outcome: str = "completed"
    asked: list[Row] = field(default_factory=list)
    rubber: float = 0.0

    @property
    def errors(self) -> dict[str, float]:
        """Largest error of each quantity over the cycles (or samples), signed; nan without any."""
        found = {}
        for name in ("K_eq", "h_eq", "energy"):
            found[name] = _worst([loop.ratios[name] - 1.0 for loop in self.loops])
        sides = [loop.ratios[side] - 1.0 for loop in self.loops for side in ("F+", "F-")]
        found["force"] = _worst(sides)
        warm = [np.zeros(0), *self.temperature_errors.values()]
        found["temperature"] = _worst(np.concatenate(warm).tolist())
        found["NRMSE"] = self.NRMSE
        return found


def _worst(errors: list[float]) -> float:
    return max(errors, key=abs) if errors else float("nan")


@dataclass(frozen=True, repr=False)
class Validation(Shown):
    """What a validation found.

    Attributes
    ----------
    comparisons : of every test with every bearing and model.
    limits : largest relative error by quantity.
    warnings : what a reader must know.
    inputs : bearings as tables, by name, with the sources of their numbers; for documents.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record("shen-hdr-specimen", 23.0, test)
    >>> found = tb.validate_bearing("shen-hdr-specimen", record)
    >>> found.verdict
    'within'
    """

    comparisons: list[Comparison]
    limits: dict[str, float]
    warnings: list[str] = field(default_factory=list)
    inputs: dict[str, Any] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        return f"Validation: {len(self.comparisons)} comparisons, {self.verdict}, {self.outcome}"

    def show(self) -> None:
        """Print the tables that the command prints."""
        from thermobearing.validate.output import print_validation

        print_validation(self)

    @property
    def outcome(self) -> str:
        """Whether every model got through every test: "completed" or "partly"."""
        done = all(item.prediction is not None for item in self.comparisons)
        return "completed" if done else "partly"

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try; empty when it completed."""
        ended = [item.outcome for item in self.comparisons if item.outcome != "completed"]
        why = [OUTCOMES[name] for name in dict.fromkeys(ended) if name in OUTCOMES]
        return " ".join([SENTENCES[self.outcome], *why]) if self.outcome in SENTENCES else ""

    @property
    def tested_range(self) -> pd.DataFrame:
        """What each test asks of the range that each bearing was tested in, where it is given."""
        return pd.DataFrame([row for item in self.comparisons for row in item.asked])

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each test, bearing and model: R2, largest errors, verdicts, largest loop."""
        rows = []
        for item in self.comparisons:
            row: dict[str, Any] = {
                "test": item.record.name,
                "ambient_degC": item.record.ambient,
                "bearing": item.bearing,
                "model": item.model,
                "outcome": item.outcome,
                "R2": item.R2,
            }
            for name, error in item.errors.items():
                row[f"{name}_error"] = error
                row[f"{name}_verdict"] = self._verdict(name, error)
            row["beyond_tested"] = " ".join(r["limit"] for r in item.asked if r["passed"])
            ratios = item.largest.ratios if item.largest else {}
            row |= {f"{name}_ratio": ratios.get(name, float("nan")) for name in RATIOS}
            rows.append(row)
        return pd.DataFrame(rows)

    @cached_property
    def cycles(self) -> pd.DataFrame:
        """One row for each cycle of each test, bearing and model: test, model and ratios."""
        rows = []
        for item in self.comparisons:
            for loop in item.loops:
                whose = {
                    "test": item.record.name,
                    "ambient_degC": item.record.ambient,
                    "bearing": item.bearing,
                    "model": item.model,
                }
                rows.append(whose | loop.row(largest=loop is item.largest))
        return pd.DataFrame(rows)

    @cached_property
    def thermocouples(self) -> pd.DataFrame:
        """One row for each thermocouple of each test, bearing and model: test, model, errors."""
        return pd.DataFrame(
            [
                {
                    "test": item.record.name,
                    "ambient_degC": item.record.ambient,
                    "bearing": item.bearing,
                    "model": item.model,
                    **row,
                }
                for item in self.comparisons
                if item.prediction is not None
                for row in thermocouple_rows(item.record, item.prediction)
            ]
        )

    def _verdict(self, name: str, error: float) -> str:
        if name not in self.limits or not np.isfinite(error):
            return TOLD
        return WITHIN if abs(error) <= self.limits[name] else BEYOND

    @property
    def verdict(self) -> str:
        """Of all: "beyond" if a limit is passed or a model did not get through, else "within"."""
        told = [
            self._verdict(name, error)
            for item in self.comparisons
            for name, error in item.errors.items()
        ]
        return BEYOND if BEYOND in told or self.outcome != "completed" else WITHIN

    def summary(self) -> dict[str, Any]:
        """The content of summary.json.

        Returns
        -------
        dict : limits, verdicts and measures of each comparison, its largest loop.
        """
        return {
            "command": "validate",
            "version": thermobearing.__version__,
            "inputs": self.inputs,
            "outcome": self.outcome,
            "sentence": self.sentence,
            "verdict": self.verdict,
            "limits": self.limits,
            "warnings": self.warnings,
            **limits_summary(pd.DataFrame(), self.tested_range),
            "comparisons": [self._told(item) for item in self.comparisons],
        }

    def _told(self, item: Comparison) -> dict[str, Any]:
        largest = item.largest
        errors = item.errors
        return {
            "test": item.record.name,
            "file": item.record.file,
            "ambient_degC": item.record.ambient,
            "bearing": item.bearing,
            "model": item.model,
            "conditions": record_conditions(item.record, item.rubber) if item.rubber else None,
            "unused_columns": list(item.record.unused),
            "thermocouples": []
            if item.prediction is None
            else thermocouple_rows(item.record, item.prediction),
            "outcome": item.outcome,
            "R2": _number(item.R2),
            "errors": {
                name: {
                    "what": what,
                    "error": _number(errors[name]),
                    "limit": self.limits.get(name),
                    "verdict": self._verdict(name, errors[name]),
                }
                for name, what in QUANTITIES.items()
            },
            "largest_loop": None
            if largest is None
            else {
                "cycle": largest.cycle or None,
                "D+_mm": largest.displacement_max,
                "D-_mm": largest.displacement_min,
                "test": largest.test,
                "model": largest.model,
                "ratio": largest.ratios,
            },
        }

    @property
    def plot(self) -> "ValidationFigures":
        """Figures: `found.plot.loops()`, `.ratios()`, `.cycles()`, `.temperatures()`."""
        from thermobearing.validate.figures import ValidationFigures

        return ValidationFigures(self)

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see `save_validation`.

        Parameters
        ----------
        directory, force, figures : as in `save_validation`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.validate.output import save_validation

        return save_validation(self, Path(directory), overwrite=overwrite, figures=figures)


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
