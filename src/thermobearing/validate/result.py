"""What a validation found: each test beside each bearing and model, ratios, verdicts."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.border.showing import table_html
from thermobearing.identify.forward import Prediction
from thermobearing.identify.record import TestRecord
from thermobearing.validate.case import QUANTITIES

if TYPE_CHECKING:
    from thermobearing.validate.figures import ValidationFigures

Floats = NDArray[np.float64]

SENTENCES = {
    "partly": "The model did not get through every test; see the outcome of each in the table. "
    "Smaller strains, a warmer start or another model would.",
}
WITHIN, BEYOND, TOLD = "within", "beyond", "told"


@dataclass(frozen=True)
class Loop:
    """One cycle of a test and of the model.

    Attributes
    ----------
    cycle, number : of the record, and within its amplitude, from 1.
    amplitude : of the displacement [mm]; that of the test moves the model.
    displacement_max, displacement_min : D+ and D- [mm].
    test, model : F+ and F- [kN], K_eq [kN/mm], h_eq and energy [kN mm], by name.
    """

    cycle: int
    number: int
    amplitude: float
    displacement_max: float
    displacement_min: float
    test: dict[str, float]
    model: dict[str, float]

    @property
    def ratios(self) -> dict[str, float]:
        """Model over test."""
        return {name: self.model[name] / value for name, value in self.test.items()}


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
    largest : the cycle that holds the largest displacement; None where there is no full cycle.
    temperature_errors : RE of Eq. 4.39 in time, by thermocouple; nan where the test has not yet
        warmed by a twentieth of its largest rise.
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

    @property
    def errors(self) -> dict[str, float]:
        """Largest error of each quantity over the cycles (or samples), signed; nan without any."""
        found = {}
        for name in ("K_eq", "h_eq", "energy"):
            found[name] = _worst([loop.ratios[name] - 1.0 for loop in self.loops])
        sides = [loop.ratios[side] - 1.0 for loop in self.loops for side in ("F+", "F-")]
        found["force"] = _worst(sides)
        warm = [values[np.isfinite(values)] for values in self.temperature_errors.values()]
        found["temperature"] = _worst(np.concatenate([*warm, np.zeros(0)]).tolist())
        found["NRMSE"] = self.NRMSE
        return found


def _worst(errors: list[float]) -> float:
    return max(errors, key=abs) if errors else float("nan")


@dataclass(frozen=True)
class Validation:
    """What a validation found.

    Attributes
    ----------
    comparisons : of every test with every bearing and model.
    limits : largest relative error by quantity.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.identify.synthetic_record("shen-hdr-specimen", 23.0, test)
    >>> found = tb.validate.validate("shen-hdr-specimen", record)
    >>> found.verdict
    'within'
    """

    comparisons: list[Comparison]
    limits: dict[str, float]

    def __repr__(self) -> str:
        return f"<Validation: {len(self.comparisons)} comparisons, {self.verdict}, {self.outcome}>"

    def _repr_html_(self) -> str:
        return table_html(repr(self)[1:-1], self.table)

    def show(self) -> None:
        """Print the tables that the command prints."""
        from thermobearing.validate.screen import print_validation

        print_validation(self)

    @property
    def outcome(self) -> str:
        """Whether every model got through every test: "completed" or "partly"."""
        done = all(item.prediction is not None for item in self.comparisons)
        return "completed" if done else "partly"

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try; empty when it completed."""
        return SENTENCES.get(self.outcome, "")

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each test, bearing and model: R2, and the largest errors and verdicts."""
        rows = []
        for item in self.comparisons:
            row: dict[str, Any] = {
                "test": item.record.name,
                "ambient_degC": item.record.ambient,
                "bearing": item.bearing,
                "model": item.model,
                "outcome": "completed" if item.prediction else "did not get through",
                "R2": item.R2,
            }
            for name, error in item.errors.items():
                row[f"{name}_error"] = error
                row[f"{name}_verdict"] = self._verdict(name, error)
            rows.append(row)
        return pd.DataFrame(rows)

    @cached_property
    def cycles(self) -> pd.DataFrame:
        """One row for each cycle of each test, bearing and model: test, model and ratios."""
        rows = []
        for item in self.comparisons:
            for loop in item.loops:
                row: dict[str, Any] = {
                    "test": item.record.name,
                    "ambient_degC": item.record.ambient,
                    "bearing": item.bearing,
                    "model": item.model,
                    "cycle": loop.cycle,
                    "number": loop.number,
                    "largest": loop is item.largest,
                    "D+_mm": loop.displacement_max,
                    "D-_mm": loop.displacement_min,
                }
                for name, ratio in loop.ratios.items():
                    row[f"{name}_test"] = loop.test[name]
                    row[f"{name}_model"] = loop.model[name]
                    row[f"{name}_ratio"] = ratio
                rows.append(row)
        return pd.DataFrame(rows)

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
            "outcome": self.outcome,
            "verdict": self.verdict,
            "limits": self.limits,
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
                "cycle": largest.cycle,
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

    def save(self, directory: str | Path, *, force: bool = False, figures: bool = True) -> Path:
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
        from thermobearing.validate.files import save_validation

        return save_validation(self, Path(directory), force=force, figures=figures)


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
