"""Agreement of the model with tests, and the range that tests cover."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing, Validity
from thermobearing.core.records import Floats
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.records.cycles import Loop, compare_loops, full_cycles
from thermobearing.identify.records.record import TestRecord
from thermobearing.results.ranges import Ends, cycles_in_a_row, largest_speed, reached_by

POOR = 0.98  # coefficient of determination below which the fit is called poor
UNUSABLE = 0.9  # below it a fit is no bearing: forces that are all off by 31 % have this R2
FIRST_CYCLE = 0.04  # of the peak force: first cycles stiffer than later ones by this are reported
AVERAGED = (
    "the fitted values are averages of both. Set first_cycle_weight = 0 in the sidecar to fit the "
    "later cycles, or give the bearing a table scragging to fit both"
)
LATER = "they had no weight; the bearing is that of the later ones, and too soft in a first cycle"
ENERGY = 0.15  # error of a cycle's energy that is reported
LEAST_RISE = 0.5  # [K]: relative errors of less mean nothing


@dataclass(frozen=True)
class RecordFit:
    """Agreement of the model with one record."""

    record: TestRecord
    R2: float  # coefficient of determination of the force, Eq. 4.38
    NRMSE: float  # root mean square error of the force over the largest force of the test
    rubber: float  # total thickness [mm]
    loops: list[Loop]  # each full cycle in the test and in the model
    temperature_error: dict[str, float]  # of the rise by thermocouple, Eq. 4.39

    def summary(self) -> dict[str, Any]:
        """Return what summary.json says of the record."""
        return {
            "name": self.record.name,
            "file": self.record.file,
            "ambient_degC": self.record.ambient,
            "R2": self.R2,
            "NRMSE": self.NRMSE,
            "temperature_error": self.temperature_error,
            "unused_columns": list(self.record.unused),
            "cycles": [
                {
                    "cycle": loop.cycle,
                    "number": loop.number,
                    "amplitude_strain": loop.amplitude / self.rubber,
                }
                | loop.errors
                for loop in self.loops
            ],
        }

    @property
    def virgin(self) -> str:
        """A sentence if first cycles are stronger than heating explains; else ""."""
        first = [loop.errors["force_max_error"] for loop in self.loops if loop.number == 1]
        later = [loop.errors["force_max_error"] for loop in self.loops if loop.number > 1]
        stiffer = float(np.mean(later)) - float(np.mean(first)) if first and later else 0.0
        if stiffer <= FIRST_CYCLE:
            return ""
        return (
            f"{self.record.name}: first cycles are {stiffer:.0%} stronger in the test than later "
            "ones beyond what heating explains (scragging); "
            f"{AVERAGED if self.record.first_cycle_weight else LATER}"
        )

    @property
    def warnings(self) -> list[str]:
        """What the residuals say about the law itself; of virgin rubber that alone."""
        said, name = [self.virgin] if self.virgin else [], self.record.name
        if self.R2 < POOR:
            said.append(f"{name}: R2 = {self.R2:.3f} is poor for this law, NRMSE {self.NRMSE:.1%}")
        worst = max((abs(loop.errors["energy_error"]) for loop in self.loops), default=0.0)
        if worst > ENERGY and not self.virgin:
            said.append(f"{name}: the energy of a cycle is off by up to {worst:.0%}")
        return said


def determination(measured: Floats, model: Floats) -> float:
    """Return the coefficient of determination R^2 (contribution rate), Eq. 4.38."""
    left = float(np.sum((model - measured) ** 2))
    return 1.0 - left / float(np.sum((measured - measured.mean()) ** 2))


def fit_of_record(record: TestRecord, prediction: Prediction, bearing: Bearing) -> RecordFit:
    """Return the agreement of a record with the model at its samples."""
    off = prediction.force - record.force
    return RecordFit(
        record=record,
        R2=determination(record.force, prediction.force),
        NRMSE=float(np.sqrt(np.mean(off**2))) / record.peak_force,
        rubber=bearing.total_rubber_thickness,
        loops=compare_loops(record, prediction.force),
        temperature_error={
            row["thermocouple"]: abs(row["rise_model_K"] - row["rise_test_K"]) / row["rise_test_K"]
            for row in thermocouple_rows(record, prediction)
            if row["rise_error"] is not None
        },
    )


def thermocouple_rows(record: TestRecord, prediction: Prediction) -> list[dict[str, Any]]:
    """Return a row of thermocouples.csv for each thermocouple, the model compared with the test.

    `rise_error` is that of the largest rise (Eq. 4.39 with its sign), None where the test rises by
    less than half a kelvin.
    """
    rows = []
    for title, test in record.temperatures.items():
        model = prediction.temperatures[title]
        rise, modelled = float(test.max() - test[0]), float(model.max() - model[0])
        rows.append(
            {
                "thermocouple": title,
                "place": record.places[title],
                "start_test_degC": float(test[0]),
                "highest_test_degC": float(test.max()),
                "highest_model_degC": float(model.max()),
                "rise_test_K": rise,
                "rise_model_K": modelled,
                "rise_error": modelled / rise - 1.0 if rise > LEAST_RISE else None,
                "rms_difference_K": float(np.sqrt(np.mean((model - test) ** 2))),
            }
        )
    return rows


def reached_in(
    record: TestRecord, rubber: float, ambient: float, lead: tuple[float, float] | None
) -> dict[str, float | Ends]:
    """Return what the history of a record asks of a bearing, as `reached_by` does.

    `rubber` is the total thickness [mm], `ambient` the air [degC], `lead` the coldest and warmest
    lead [degC].
    """
    time, x = record.time, record.displacement
    air, warm = (ambient, ambient), None if lead is None else np.array(lead)
    speed = largest_speed(time, x)
    return reached_by(time, x, speed, rubber=rubber, ambient=air, lead=warm)


def range_of_tests(
    records: Sequence[TestRecord], predictions: Sequence[Prediction], rubber: float
) -> Validity:
    """Return the range of each quantity in some tests, as the file of a bearing holds it.

    Strains are those of the full cycles (of the whole test without any), over the total thickness
    `rubber` [mm]; the temperature of the lead is the model's.
    """
    strains, speeds = [], []
    for record in records:
        full = [cycle.amplitude for cycle in full_cycles(record) if not cycle.closing]
        strains += [float(size) / rubber for size in full or [record.peak_displacement]]
        speeds.append(largest_speed(record.time, record.displacement) / rubber)
    leads = [end for found in predictions for end in found.lead or ()]
    ends = {
        name: [float(f"{end:.5g}") for end in (min(values), max(values))]
        for name, values in (
            ("strain", strains),
            ("strain_rate", speeds),
            ("ambient", [float(record.ambient) for record in records]),
            ("lead_temperature", leads),
        )
        if values
    }
    most = max(cycles_in_a_row(record.time, record.displacement) for record in records)
    return Validity(**ends, cycles=[0.0, most])
