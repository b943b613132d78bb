"""A test compared with a model at its samples: force, cycles and thermocouples."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from thermobearing.border.errors import printable
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.records.cycles import Loop, compare_loops
from thermobearing.identify.records.record import TestRecord
from thermobearing.quantities.governing import largest_by
from thermobearing.results.base import COMPLETED
from thermobearing.results.ranges import Row, names_by_sentence
from thermobearing.tables.gaps import initial_temperature

LEAST_RISE = 0.5  # [K]: relative errors of smaller temperature rises are not reported
# Sides of a loop that each error of the table takes into account.
SIDES = {"K_eq": ("K_eq",), "h_eq": ("h_eq",), "energy": ("energy",), "force": ("F+", "F-")}
NAN = float("nan")
# Largest relative errors of a test held out, unless others are stated. They are a criterion of this
# program: no standard limits the errors of a model of a bearing.
LIMITS = {"K_eq": 0.15, "h_eq": 0.15}


@dataclass(frozen=True)
class Comparison:
    """One test compared with one bearing and model."""

    record: TestRecord
    bearing: str  # name
    model: str  # name; "identified" is the model of a calibration
    rubber: float  # total thickness [mm]
    prediction: Prediction | None  # at the samples of the test; None if it ended early
    outcome: str = COMPLETED  # of the model's run, as of a cyclic test
    # Rows of `results.ranges.compared`, for the calibration range of the bearing.
    compared: list[Row] = field(default_factory=list)

    @cached_property
    def R2(self) -> float:
        """Coefficient of determination of the force (Eq. 4.38)."""
        if self.prediction is None:
            return NAN
        measured = self.record.force
        unexplained = float(np.sum((self.prediction.force - measured) ** 2))
        return 1.0 - unexplained / float(np.sum((measured - measured.mean()) ** 2))

    @cached_property
    def NRMSE(self) -> float:
        """Root mean square error of the force over the largest force of the test."""
        if self.prediction is None:
            return NAN
        residual = self.prediction.force - self.record.force
        return float(np.sqrt(np.mean(residual**2))) / self.record.peak_force

    @cached_property
    def loops(self) -> list[Loop]:
        """Full cycles in the test and in the model."""
        return self._loops[0]

    @cached_property
    def largest(self) -> Loop | None:
        """The loop of the largest displacement, which may be no full cycle."""
        return self._loops[1]

    @cached_property
    def _loops(self) -> tuple[list[Loop], Loop | None]:
        return compare_loops(self.record, self.prediction.force) if self.prediction else ([], None)

    @cached_property
    def thermocouples(self) -> list[dict[str, Any]]:
        """A row of thermocouples.csv for each thermocouple.

        `rise_error` is that of the largest rise (Eq. 4.39 with its sign), None where the test rises
        by less than half a kelvin.
        """
        rows: list[dict[str, Any]] = []
        if self.prediction is None:
            return rows
        for title, test, model in self.compared_temperatures():
            begin, begin_model = map(initial_temperature, (test, model))
            rise, modelled = float(test.max()) - begin, float(model.max()) - begin_model
            rows.append(
                {
                    "thermocouple": title,
                    "place": self.record.places[title],
                    "start_test_degC": begin,
                    "start_model_degC": begin_model,
                    "highest_test_degC": float(test.max()),
                    "highest_model_degC": float(model.max()),
                    "rise_test_K": rise,
                    "rise_model_K": modelled,
                    "rise_error": modelled / rise - 1.0 if rise > LEAST_RISE else None,
                    "rms_difference_K": float(np.sqrt(np.mean((model - test) ** 2))),
                }
            )
        return rows

    @property
    def rise_error(self) -> float:
        """Largest error of a temperature rise in time, relative to the largest rise of the test.

        Eq. 4.39 with its sign, but its denominator is not the rise so far: half a kelvin at the
        start of a test would be an error of 50 %. Thermocouples that do not rise are left out.
        """
        errors: list[Floats] = []
        if self.prediction is None:
            return NAN
        for _, test, model in self.compared_temperatures():
            rise = test - initial_temperature(test)
            if rise.max() > 0.0:
                errors.append((model - initial_temperature(model) - rise) / rise.max())
        # An empty array first: concatenate refuses an empty list.
        return _worst(np.concatenate([np.zeros(0), *errors]).tolist())

    def compared_temperatures(self) -> Iterator[tuple[str, Floats, Floats]]:
        """Yield title, readings and model [degC] of each thermocouple, without missing readings."""
        if self.prediction is None:
            return
        for title, test in self.record.temperatures.items():
            read = ~np.isnan(test)
            if read.any():
                yield title, test[read], self.prediction.temperatures[title][read]

    @property
    def errors(self) -> dict[str, float]:
        """Largest error of each quantity over the cycles (or samples), signed; nan without any."""
        largest_errors = {
            name: _worst([loop.ratios[side] - 1.0 for loop in self.loops for side in sides])
            for name, sides in SIDES.items()
        }
        return largest_errors | {"temperature": self.rise_error, "NRMSE": self.NRMSE}

    @property
    def names(self) -> dict[str, Any]:
        """The first columns of its rows in tables."""
        test = {"test": self.record.name, "ambient_degC": self.record.ambient}
        return test | {"bearing": self.bearing, "model": self.model}

    @property
    def samples(self) -> dict[str, Any]:
        """Columns of the test and the model sample by sample [s, mm, kN, degC]."""
        record, model = self.record, self.prediction
        columns: dict[str, Any] = {
            "time_s": record.time,
            "displacement_mm": record.displacement,
            "force_kN": record.force,
            "model_force_kN": model.force if model else NAN,
        }
        for title, values in record.temperatures.items():
            modelled = model.temperatures[title] if model else NAN
            columns |= {title: values, f"model_{title}": modelled}
        return columns


def _worst(errors: list[float]) -> float:
    return largest_by(errors, abs) if errors else NAN


def limit_source(name: str, limit: float) -> str:
    """Return where the limit of an error comes from.

    >>> limit_source("K_eq", 0.1)
    'stated by the user'
    """
    if LIMITS.get(name) == limit:
        return "criterion of thermobearing, of no standard"
    return "stated by the user"


def cycles_frame(comparisons: list[Comparison]) -> "pd.DataFrame":
    """Return the rows of cycles.csv: test, model and ratios of each cycle."""
    rows = [
        comparison.names | loop.row(largest=loop is comparison.largest)
        for comparison in comparisons
        for loop in comparison.loops
    ]
    return pd.DataFrame(rows)


def unused_columns(records: list[TestRecord]) -> list[str]:
    """Return a sentence on columns that are not used, for all tests whose files have the same."""
    unused = dict.fromkeys(
        (record.name, f"columns not used: {', '.join(record.unused)}")
        for record in records
        if record.unused
    )
    return [printable(f"{names}: {sentence}") for names, sentence in names_by_sentence(unused)]
