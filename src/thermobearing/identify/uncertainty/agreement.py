"""Agreement of a calibrated bearing with its tests, and its calibration range."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing, Validity
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.records.cycles import compare_loops, full_cycles
from thermobearing.identify.records.record import TestRecord
from thermobearing.results.ranges import Ends, cycles_in_a_row, largest_speed, reached_by

Floats = NDArray[np.float64]
POOR = 0.98  # coefficient of determination below which the fit is called poor
UNUSABLE = 0.9  # below it a fit is no bearing: forces that are all off by 31 % have this R2
FIRST_CYCLE = 0.04  # of the peak force: first cycles stiffer than later ones by this are told
AVERAGED = (
    "the fitted values are averages of both. Set first_cycle_weight = 0 in the sidecar to fit the "
    "later cycles, or give the bearing a table scragging to fit both"
)
LATER = "they had no weight; the bearing is that of the later ones, and too soft in a first cycle"
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

    def summary(self) -> dict[str, Any]:
        """What summary.json says of the record."""
        return {
            "name": self.record.name,
            "file": self.record.file,
            "ambient_degC": self.record.ambient,
            "R2": self.R2,
            "NRMSE": self.NRMSE,
            "temperature_error": self.temperature_error,
            "unused_columns": list(self.record.unused),
            "cycles": [vars(cycle) for cycle in self.cycles],
        }

    @property
    def virgin(self) -> str:
        """A sentence where first cycles are stronger than heating explains; "" elsewhere."""
        first = [c.force_max_error for c in self.cycles if c.number == 1]
        later = [c.force_max_error for c in self.cycles if c.number > 1]
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
        """What the residuals say of the law itself, in words; of virgin rubber that alone."""
        said, name = [self.virgin] if self.virgin else [], self.record.name
        if self.R2 < POOR:
            said.append(f"{name}: R2 = {self.R2:.3f} is poor for this law, NRMSE {self.NRMSE:.1%}")
        worst = max((abs(c.energy_error) for c in self.cycles), default=0.0)
        if worst > ENERGY and not self.virgin:
            said.append(f"{name}: the energy of a cycle is off by up to {worst:.0%}")
        return said


def determination(measured: Floats, model: Floats) -> float:
    """Coefficient of determination R^2 (contribution rate), Eq. 4.38.

    Parameters
    ----------
    measured, model : the same quantity at the same samples, in any unit; `measured` not constant.

    Returns
    -------
    float : 1 where the model meets every sample; it may be negative.

    Examples
    --------
    >>> determination(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0]))
    1.0
    """
    left = float(np.sum((model - measured) ** 2))
    return 1.0 - left / float(np.sum((measured - measured.mean()) ** 2))


def fit_of_record(record: TestRecord, prediction: Prediction, bearing: Bearing) -> RecordFit:
    """Measures of one record against the model.

    Parameters
    ----------
    record : a test.
    prediction : the model at its samples.
    bearing : total rubber thickness, for the strain of each cycle.

    Returns
    -------
    RecordFit

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 4.0, 401)
    >>> x = 30.0 * np.sin(2.0 * np.pi * t)
    >>> record = record_from_arrays(t, x, 2.0 * x + 10.0 * np.cos(2.0 * np.pi * t), 23.0)
    >>> stronger = Prediction(1.1 * record.force, {}, "completed")
    >>> fit = fit_of_record(record, stronger, load_bearing("shen-hdr-specimen"))
    >>> [round(cycle.force_max_error, 3) for cycle in fit.cycles]
    [0.1, 0.1, 0.1, 0.1]
    """
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


def _cycle_errors(record: TestRecord, force: Floats, bearing: Bearing) -> list[CycleErrors]:
    return [
        CycleErrors(
            cycle=loop.cycle,
            number=loop.number,
            amplitude_strain=loop.amplitude / bearing.total_rubber_thickness,
            G_eq_error=loop.ratios["K_eq"] - 1.0,  # displacements are the same, and cancel
            h_eq_error=loop.ratios["h_eq"] - 1.0,
            energy_error=loop.ratios["energy"] - 1.0,
            force_max_error=loop.peak_ratio - 1.0,
        )
        for loop in compare_loops(record, force)
    ]


def reached_in(
    record: TestRecord, rubber: float, ambient: float, lead: tuple[float, float] | None
) -> dict[str, float | Ends]:
    """What the history of a record asks of a bearing.

    Parameters
    ----------
    record : a test.
    rubber : total thickness of the bearing [mm].
    ambient : temperature of the air [degC].
    lead : coldest and warmest temperature of the lead [degC]; None where it is not known.

    Returns
    -------
    dict : as of `reached_by`.
    """
    time, x = record.time, record.displacement
    air, warm = (ambient, ambient), None if lead is None else np.array(lead)
    speed = largest_speed(time, x)
    return reached_by(time, x, speed, rubber=rubber, ambient=air, lead=warm)


def range_of_tests(
    records: Sequence[TestRecord], predictions: Sequence[Prediction], rubber: float
) -> Validity:
    """Lowest and highest value of each quantity in some tests, as a bearing's file holds it.

    Parameters
    ----------
    records : of the fit.
    predictions : of the fitted model, for the temperature of the lead.
    rubber : total thickness of the bearing [mm].

    Returns
    -------
    Validity : strains of the full cycles (of the whole test without any), largest speeds, air,
        most cycles in a row, and lead as the model has it.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 8.0, 801)
    >>> tests = [record_from_arrays(t, a * np.sin(np.pi * t), t + 1.0, 5.0) for a in (15.0, 60.0)]
    >>> found = range_of_tests(tests, [], 30.0)
    >>> [round(end, 2) for end in found.strain], found.ambient, found.cycles
    ([0.5, 2.0], [5.0, 5.0], [0.0, 4.0])
    """
    strains, speeds = [], []
    for record in records:
        full = [cycle.amplitude for cycle in full_cycles(record) if not cycle.closing]
        strains += [float(size) / rubber for size in full or [record.peak_displacement]]
        speeds.append(largest_speed(record.time, record.displacement) / rubber)
    air = [float(record.ambient) for record in records]
    most = max(cycles_in_a_row(record.time, record.displacement) for record in records)
    leads = [found.lead for found in predictions if found.lead is not None]
    warm = (min(low for low, _ in leads), max(high for _, high in leads)) if leads else None
    return Validity(
        strain=_ends(strains),
        strain_rate=_ends(speeds),
        ambient=_ends(air),
        cycles=[0.0, most],
        lead_temperature=None if warm is None else _ends(warm),
    )


def _ends(values: Sequence[float]) -> list[float]:
    """Lowest and highest, to the digits that a test can know."""
    return [float(f"{end:.5g}") for end in (min(values), max(values))]
