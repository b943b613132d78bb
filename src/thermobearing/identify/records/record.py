"""The record of a laboratory's test, and the conditions that its summary reports.

`TestRecord` holds all samples in one line of time; tables/laboratory.py reads them from files and
sidecars. Assumptions (clock, ambient temperature) are stored with it.
"""

import hashlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from thermobearing.bearing.ambient import check_temperature
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.units import number_list
from thermobearing.core.records import Floats, Ints
from thermobearing.results.ranges import Ends, cycles_in_a_row, largest_speed, reached_by
from thermobearing.tables.laboratory import Readings, read_laboratory

PARTS = 20  # of the test, in time: noise and a door that was opened are not drift
READ_TO = 1  # decimals of a temperature in K
ASSUMED_AMBIENT = 23.0  # laboratory temperature of Table 3.4 [degC]
TOGETHER = 0.05  # of the largest displacement: largest deviation of a proportional strain
WEIGHTS = ["weight", "first_cycle_weight", "cycle_balance"]
SETTINGS = [*WEIGHTS, "despike", "detrend", "ambient_uncertainty"]  # of a sidecar
ABOUT = ("specimen", "laboratory", "date", "scragged")  # of a sidecar
PAUSE = 1.0  # a longer gap between samples is a rest, divided into growing steps [s]
STEADY = 3.0  # largest range of an ambient temperature that a mean represents [K]


class ChamberNumbers(Strict):
    """Content of data/identify/ambient.toml [K]."""

    ambient_drift: Annotated[float, in_unit("K"), Field(gt=0)]


def _describe_drift(time: Floats, ambient: Floats) -> str:
    """Return a sentence if the ambient temperature [degC] drifts within a test, else ""."""
    if not (np.diff(time) > 0.0).all():  # a look at the test refuses it
        return ""
    part = np.minimum((time - time[0]) / np.ptp(time) * PARTS, PARTS - 1).astype(np.int64)
    middles = np.array([np.median(ambient[part == k]) for k in np.unique(part)])
    line = float(np.polyfit(time - time.mean(), ambient, 1)[0] * np.ptp(time))
    wandered = max(abs(line), float(np.ptp(middles)))
    known = read_data(ChamberNumbers, "identify", "ambient.toml")
    if round(wandered, READ_TO) < known.ambient_drift:
        return ""
    straight = abs(line) >= 0.5 * wandered
    way = "wanders" if not straight else "rises" if line > 0.0 else "falls"
    return (
        f"the ambient temperature {way} by {wandered:.1f} K within the test, from "
        f"{middles[0]:.1f} to {middles[-1]:.1f} degC: the mean, {ambient.mean():.1f} degC, is used "
        "for the complete test; split the file or state ambient if that is too inaccurate"
    )


@dataclass(frozen=True)
class TestRecord:
    """One test of one bearing at one ambient temperature.

    Attributes
    ----------
    name, file : name of the test, and the file that it was read from.
    time, displacement, force : samples [s, mm, kN]; force has the sign of displacement.
    block : number of the block that each sample belongs to.
    ambient : temperature of the chamber [degC]; the bearing starts at it, plus `start_offset`.
    temperatures : samples of thermocouples [degC] by title, and
    places : position of each of them, "rubber 1" (outer layer), ..., "lead".
    weight, first_cycle_weight : of this record in a calibration; of its first cycles in addition.
    cycle_balance : 0 uses forces as they are, 1 relative to the peak of their own cycle; between
        them, to that power. Otherwise small cycles have no effect next to large ones.
    assumptions : values that the file did not state.
    bearing : name or file of the bearing, if the sidecar gave one.
    unused : titles of the columns of the file that are not used.
    rubber_thickness : total rubber thickness [mm], from displacement and a column of strains.
    guessed_places : thermocouples whose place was inferred from their title.
    despike : remove spikes before a calibration.
    detrend : signals whose drift is removed before a calibration: "force", "displacement",
        "both", or "".
    ambient_uncertainty : standard uncertainty of `ambient` [K], >= 0; None for the usual 0.5 K.
    start_offset : temperature of the specimen at the start, less that of the chamber [K].
    about : specimen, laboratory, date and scragged (whether the rubber was loaded before), as
        stated.
    """

    __test__ = False  # not a test for pytest

    name: str
    time: Floats
    displacement: Floats
    force: Floats
    block: Ints
    ambient: float
    file: str = ""
    temperatures: dict[str, Floats] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    weight: float = 1.0
    first_cycle_weight: float = 1.0
    cycle_balance: float = 0.0
    assumptions: tuple[str, ...] = ()
    bearing: str | None = None
    unused: tuple[str, ...] = ()
    despike: bool = False
    detrend: str = ""
    rubber_thickness: float | None = None
    ambient_uncertainty: float | None = None
    guessed_places: tuple[str, ...] = ()
    start_offset: float = 0.0
    about: dict[str, str | bool] = field(default_factory=dict)

    def of_bearing(self, bearing: Bearing) -> "TestRecord":
        """Return the test without thermocouples at guessed places that a bearing does not have."""
        layers = [f"rubber {k + 1}" for k in range(bearing.geometry.rubber_layers)]
        held = {*layers, "lead"} if bearing.lead is not None else set(layers)
        lost = {title for title in self.guessed_places if self.places.get(title) not in held}
        if not lost:
            return self
        return replace(
            self,
            places={title: place for title, place in self.places.items() if title not in lost},
            temperatures={t: values for t, values in self.temperatures.items() if t not in lost},
            unused=(*self.unused, *sorted(lost - set(self.unused))),
        )

    @property
    def peak_force(self) -> float:
        """Largest force, either way [kN]."""
        return float(np.abs(self.force).max())

    @property
    def peak_displacement(self) -> float:
        """Largest displacement, either way [mm]."""
        return float(np.abs(self.displacement).max())


def record_from_arrays(
    time: Floats, displacement: Floats, force: Floats, ambient: float, *, name: str = "test"
) -> TestRecord:
    """Create a record from arrays; gaps in time without motion are rests.

    Parameters
    ----------
    time : [s], increasing.
    displacement, force : [mm], [kN], force with the sign of displacement.
    ambient : [degC].
    name : of the test in reports.

    Raises
    ------
    InputError : lists that differ in length or are not finite numbers.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 200)
    >>> record_from_arrays(t, np.sin(t), 2.0 * np.sin(t), 23.0).peak_force > 1.9
    True
    """
    given = {"time": time, "displacement": displacement, "force": force}
    columns = [number_list(values, f"{name}: {what}") for what, values in given.items()]
    if len({len(values) for values in columns}) != 1:
        raise InputError("time, displacement and force must be lists of the same length", name)
    block = np.zeros(len(columns[0]), dtype=np.int64)
    x, f = columns[1], columns[2]
    at = check_temperature(ambient, f"{name}: ambient")
    return TestRecord(name, columns[0], x, f, block=block, ambient=float(at))


def load_test(path: str | Path) -> TestRecord:
    r"""Read a test from its table of samples or from its TOML sidecar.

    Parameters
    ----------
    path : `test.csv` or `test.xlsx` (its sidecar is `test.toml` in the same folder, if any) or the
        sidecar.

    Raises
    ------
    InputError : unreadable file, unknown key or column, wrong unit, a cell that is not a number.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "cold.csv"
    ...     _ = file.write_text("time_s,displacement_mm,force_kN\n0,0,0\n1,5,9\n2,0,-1\n")
    ...     _ = file.with_suffix(".toml").write_text('ambient = "-20 degC"')
    ...     record = load_test(file)
    >>> record.name, record.ambient, record.peak_force
    ('cold', -20.0, 9.0)
    """
    return build_record(read_laboratory(path))


def build_record(readings: Readings) -> TestRecord:
    """Return a test from the columns and settings that were read of its file."""
    sidecar, values = readings.sidecar, readings.values
    assumptions = list(readings.assumptions)
    where = Path(sidecar.bearing) if sidecar.bearing else None
    inside = where is not None and where.suffix == ".toml" and not where.is_absolute()
    thickness = _rubber_thickness(values, assumptions)
    given = readings.given.get("thermocouples", {})
    return TestRecord(
        name=sidecar.name or readings.file.stem,
        file=str(readings.file),
        time=values["time"],
        displacement=readings.displacement,
        force=readings.force,
        block=readings.block,
        ambient=_ambient(readings, assumptions),
        temperatures={title: values[title] for title in sidecar.thermocouples},
        places=dict(sidecar.thermocouples),
        assumptions=tuple(dict.fromkeys(assumptions)),
        bearing=str(readings.file.parent / where) if inside and where else sidecar.bearing,
        unused=tuple(readings.unused),
        rubber_thickness=thickness,
        guessed_places=tuple(title for title in sidecar.thermocouples if title not in given),
        about={k: getattr(sidecar, k) for k in ABOUT if getattr(sidecar, k) not in ("", None)},
        **{name: getattr(sidecar, name) for name in SETTINGS},
    )


def _rubber_thickness(values: dict[str, Floats], assumptions: list[str]) -> float | None:
    """Return displacement over shear strain [mm] if the file has both and they are proportional."""
    strain = values.get("strain")
    if strain is None or not np.ptp(strain):
        return None
    way, strain = values["displacement"] - values["displacement"].mean(), strain - strain.mean()
    slope = float(way @ strain / (strain @ strain))
    if float(np.abs(way - slope * strain).max()) > TOGETHER * float(np.abs(way).max()):
        assumptions.append("the strains are not proportional to the displacement and are not used")
        return None
    return abs(100.0 * slope)


def _ambient(readings: Readings, assumptions: list[str]) -> float:
    """Return the chamber temperature [degC]: given, or the mean of a column, or assumed."""
    if readings.sidecar.ambient is not None:
        return readings.sidecar.ambient
    column = readings.values.get("ambient")
    if column is None:
        said = f"no ambient temperature is stated: {ASSUMED_AMBIENT:g} degC is assumed"
        assumptions.append(said)
        return ASSUMED_AMBIENT
    if np.ptp(column) > STEADY:
        raise InputError(
            f"the ambient temperature ranges from {column.min():g} to {column.max():g} degC, but a "
            "record has one: split the file by temperature, or state ambient",
            str(readings.file),
        )
    drift = _describe_drift(readings.values["time"], column) if "time" in readings.values else ""
    assumptions += [drift] if drift else []
    return check_temperature(float(column.mean()), f"{readings.file}: ambient")


def record_conditions(record: TestRecord, rubber: float) -> dict[str, Any]:
    """Return the content of summary.json about the conditions of a test.

    `rubber` is the total thickness of the bearing's rubber [mm]. The digest is the SHA-256 of time,
    displacement and force as they were read.
    """
    digest = hashlib.sha256()
    for values in (record.time, record.displacement, record.force):
        digest.update(values.astype("<f8").tobytes())
    return {
        "duration_s": float(record.time[-1] - record.time[0]),
        "samples": len(record.time),
        "largest_displacement_mm": record.peak_displacement,
        "largest_strain": record.peak_displacement / rubber,
        "largest_force_kN": record.peak_force,
        "largest_speed_mm_s": largest_speed(record.time, record.displacement),
        "cycles_in_a_row": cycles_in_a_row(record.time, record.displacement),
        "thermocouples": dict(record.places),
        **{name: getattr(record, name) for name in WEIGHTS},
        **record.about,
        "assumptions": list(record.assumptions),
        "sha256": digest.hexdigest(),
    }


def reached_values(
    record: TestRecord, rubber: float, ambient: float, lead: tuple[float, float] | None
) -> dict[str, float | Ends]:
    """Return the strain, rate and temperatures that a record reaches, as `reached_by` does.

    `rubber` is the total rubber thickness [mm], `ambient` the ambient temperature [degC], `lead`
    the lowest and highest temperature of the lead [degC].
    """
    time, x = record.time, record.displacement
    ends, warm = (ambient, ambient), None if lead is None else np.array(lead)
    speed = largest_speed(time, x)
    return reached_by(time, x, speed, rubber=rubber, ambient=ends, lead=warm)
