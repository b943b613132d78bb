"""The record of a laboratory's test, and the conditions that its summary reports.

`TestRecord` holds all samples in one line of time; tables/laboratory.py reads them from files and
sidecars. Assumptions (clock, ambient temperature) are stored with it.
"""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from thermobearing.bearing.ambient import check_temperature
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.library import read_data
from thermobearing.border.opener import LARGEST_MEMBER, file_digest, is_file
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.units import number_list
from thermobearing.core.records import Floats, Ints
from thermobearing.cyclic.conditioning import filled
from thermobearing.quantities.words import joined
from thermobearing.results.ranges import Ends, largest_speed, reached_by
from thermobearing.tables.conditioning import Conditioning
from thermobearing.tables.gaps import Gaps, initial_temperature
from thermobearing.tables.guess import AXIAL, HeaderTemperature
from thermobearing.tables.laboratory import Readings, read_laboratory

PARTS = 20  # of the test, in time: noise and a door that was opened are not drift
MOST_SHOWN = 3  # columns in a question
READ_TO = 1  # decimals of a temperature in K
MEAN_TO = 2  # decimals of the beginning and the mean of the column of a chamber [degC]
ASSUMED_AMBIENT = 23.0  # laboratory temperature of Table 3.4 [degC]
TOGETHER = 0.05  # of the largest displacement: largest deviation of a proportional strain
WEIGHTS = ["weight", "first_cycle_weight", "cycle_balance"]
SETTINGS = [*WEIGHTS, "despike", "detrend", "ambient_uncertainty"]  # of a sidecar
ABOUT = ("specimen", "laboratory", "date", "scragged")  # of a sidecar
PAUSE = 1.0  # a longer gap between samples is a rest, divided into growing steps [s]
CLOSE = 2.0  # to the assumed ambient temperature: what a thermocouple may deviate from it [K]
STEADY = 3.0  # largest range of an ambient temperature that a mean represents [K]


class ChamberNumbers(Strict):
    """Content of data/identify/ambient.toml [K]."""

    ambient_drift: Annotated[float, in_unit("K"), Field(gt=0)]


def _describe_drift(time: Floats, ambient: Floats) -> str:
    """Return a sentence if the ambient temperature [degC] drifts within a test, else ""."""
    if not (np.diff(time) > 0.0).all():  # a look at the test refuses it
        return ""
    # Medians of parts of the test: noise and a door that was opened are not drift.
    part = np.minimum((time - time[0]) / np.ptp(time) * PARTS, PARTS - 1).astype(np.int64)
    middles = np.array([np.median(ambient[part == k]) for k in np.unique(part)])
    line = float(np.polyfit(time - time.mean(), ambient, 1)[0] * np.ptp(time))
    wandered = max(abs(line), float(np.ptp(middles)))
    numbers = read_data(ChamberNumbers, "identify", "ambient.toml")
    if round(wandered, READ_TO) <= numbers.ambient_drift:
        return ""
    low, high = float(middles.min()), float(middles.max())
    change = f"varies between {low:.1f} and {high:.1f} degC"
    first = initial_temperature(ambient)
    # Mostly a straight line: a trend is named as one.
    if abs(line) >= 0.5 * wandered:
        begin, end = np.mean(ambient) - 0.5 * line, np.mean(ambient) + 0.5 * line
        change = f"{'rises' if line > 0.0 else 'falls'} from {begin:.1f} to {end:.1f} degC"
    return (
        f"the ambient temperature {change} within the test; the bearing starts at {first:.1f} "
        f"degC, and exchanges heat with air at the mean, {ambient.mean():.1f} degC. Split the "
        "file, or state ambient, if that is too inaccurate"
    )


class AxialRecord(NamedTuple):
    """The axial force of a test in time."""

    time: Floats  # increasing, on the clock of the record [s]
    force: Floats  # positive in compression [kN]

    def at(self, time: Floats) -> Floats:
        """Return the axial force at some times [kN]."""
        return np.interp(time, self.time, self.force)


@checked
@dataclass(frozen=True)
class TestRecord:
    """One test of one bearing at one ambient temperature.

    Attributes
    ----------
    name, file : name of the test, and the file that it was read from.
    time, displacement, force : samples [s, mm, kN]; force has the sign of displacement.
    block : number of the block that each sample belongs to.
    ambient : temperature of the chamber when the test begins, after the soak [degC]; the bearing
        starts at it, plus `start_offset`, and the test is named by it.
    air_offset : mean temperature of the chamber during the test, at which the faces of the bearing
        exchange heat, less `ambient` [K].
    temperatures : samples of thermocouples [degC] by title, NaN where a reading is missing, and
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
    conditioning : how long the specimen was in its chamber, and from what temperature: the bearing
        then starts at temperatures of the soaking model, plus `start_offset`; None where the record
        does not state it.
    about : specimen, laboratory, date and scragged (whether the rubber was loaded before), as
        stated.
    unclear : why `ambient` is not known although a column of the file may state it; "" if it is.
        `load_test` refuses such a file, and so does every check.
    subtracted : offsets that the sidecar subtracts from the readings of "force" [kN] and
        "displacement" [mm], before the sign is reversed.
    reversed_force : the sign of the readings of the force was reversed.
    digests : SHA-256 of each file that the test was read from, by its path: sidecar and tables.
    ambient_from : where `ambient` was read, if a line above the table states it.
    axial : the axial force, where it acts on the shear force of the model; None where it does not.
    stated_axial_force : axial force of the test [kN], whether it acts in the model or not: that of
        the sidecar, or the mean of its column; None where it is not stated.
    gaps : missing readings of the chamber and of thermocouples.
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
    air_offset: float = 0.0
    conditioning: Conditioning | None = None
    about: dict[str, str | bool] = field(default_factory=dict)
    unclear: str = ""
    subtracted: dict[str, float] = field(default_factory=dict)
    reversed_force: bool = False
    ambient_from: str = ""
    digests: dict[str, str] = field(default_factory=dict)
    axial: AxialRecord | None = None
    stated_axial_force: float | None = None
    gaps: tuple[Gaps, ...] = ()

    def of_bearing(self, bearing: Bearing) -> "TestRecord":
        """Return the test without thermocouples at guessed places that a bearing does not have."""
        layers = [f"rubber {k + 1}" for k in range(bearing.geometry.rubber_layers)]
        bearing_places = {*layers, "lead"} if bearing.lead is not None else set(layers)
        absent = {
            title for title in self.guessed_places if self.places.get(title) not in bearing_places
        }
        if not absent:
            return self
        return replace(
            self,
            places={title: place for title, place in self.places.items() if title not in absent},
            temperatures={t: values for t, values in self.temperatures.items() if t not in absent},
            unused=(*self.unused, *sorted(absent - set(self.unused))),
            gaps=tuple(item for item in self.gaps if item.title not in absent),
        )

    @property
    def peak_force(self) -> float:
        """Largest force, either way [kN]."""
        return float(np.abs(self.force).max())

    @property
    def peak_displacement(self) -> float:
        """Largest displacement, either way [mm]."""
        return float(np.abs(self.displacement).max())


@checked
def record_from_arrays(
    time: Floats,
    displacement: Floats,
    force: Floats,
    ambient: float,
    *,
    name: str = "test",
    axial_force: float | Floats | None = None,
) -> TestRecord:
    """Create a record from arrays; gaps in time without motion are rests.

    Parameters
    ----------
    time : [s], increasing.
    displacement, force : [mm], [kN], force with the sign of displacement.
    ambient : [degC].
    name : of the test in reports.
    axial_force : on the bearing [kN], positive in compression, one number or one for each sample;
        it then acts on the shear force of the model. By default it does not.

    Raises
    ------
    InputError : lists that differ in length or are not finite numbers.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 200)
    >>> record_from_arrays(t, np.sin(t), 2.0 * np.sin(t), 23.0).peak_force > 1.9
    True
    """
    samples = {"time": time, "displacement": displacement, "force": force}
    columns = [number_list(values, f"{name}: {signal}") for signal, values in samples.items()]
    if len({len(values) for values in columns}) != 1:
        raise InputError("time, displacement and force must be lists of the same length", name)
    block = np.zeros(len(columns[0]), dtype=np.int64)
    x, f = columns[1], columns[2]
    temperature = check_temperature(ambient, f"{name}: ambient")
    axial = None
    if axial_force is not None:
        constant = np.ndim(axial_force) == 0
        pressing = number_list(
            np.full(len(x), axial_force) if constant else axial_force, f"{name}: axial_force"
        )
        if len(pressing) != len(x):
            raise InputError("axial_force must be a number or a list as long as time", name)
        axial = AxialRecord(columns[0], pressing)
    return TestRecord(name, columns[0], x, f, block=block, ambient=float(temperature), axial=axial)


@checked
def load_test(path: str | Path) -> TestRecord:
    r"""Read a test from its table of samples or from its TOML sidecar.

    Parameters
    ----------
    path : `test.csv` or `test.xlsx` (its sidecar is `test.toml` in the same folder, if any) or the
        sidecar.

    Raises
    ------
    InputError : unreadable file, unknown key or column, wrong unit, a cell that is not a number; no
        ambient temperature is stated, but a column may be that of the chamber.

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
    record = build_record(read_laboratory(path))
    if record.unclear:
        raise InputError(record.unclear, record.file)
    return record


def build_record(readings: Readings) -> TestRecord:
    """Return a test from the columns and settings that were read of its file."""
    sidecar, values = readings.sidecar, readings.values
    assumptions = list(readings.assumptions)
    bearing_file = Path(sidecar.bearing) if sidecar.bearing else None
    inside = (
        bearing_file is not None
        and bearing_file.suffix == ".toml"
        and not bearing_file.is_absolute()
    )
    thickness = _rubber_thickness(values, assumptions)
    stated_places = readings.given.get("thermocouples", {})
    unclear = _describe_unclear_ambient(readings)
    header = _header_temperature(readings)
    return TestRecord(
        name=sidecar.name or readings.file.stem,
        file=str(readings.file),
        time=values["time"],
        displacement=readings.displacement,
        force=readings.force,
        block=readings.block,
        ambient=math.nan if unclear else _ambient(readings, assumptions),
        air_offset=0.0 if unclear else _air_offset(readings),
        unclear=unclear,
        ambient_from=f'line {header.line} of the file, "{header.text}"' if header else "",
        conditioning=_conditioning(readings, assumptions),
        temperatures={title: values[title] for title in sidecar.thermocouples},
        places=dict(sidecar.thermocouples),
        assumptions=tuple(dict.fromkeys(assumptions)),
        bearing=str(readings.file.parent / bearing_file)
        if inside and bearing_file
        else sidecar.bearing,
        unused=tuple(readings.unused),
        rubber_thickness=thickness,
        guessed_places=tuple(
            title for title in sidecar.thermocouples if title not in stated_places
        ),
        subtracted={
            "force": sidecar.force_offset,
            "displacement": sidecar.displacement_offset,
        },
        reversed_force=sidecar.flip_force,
        digests={
            str(file): file_digest(file, LARGEST_MEMBER) for file in readings.files if is_file(file)
        },
        axial=_axial(readings),
        stated_axial_force=_stated_axial_force(readings),
        gaps=tuple(readings.gaps),
        about={k: getattr(sidecar, k) for k in ABOUT if getattr(sidecar, k) not in ("", None)},
        **{name: getattr(sidecar, name) for name in SETTINGS},
    )


def _axial(readings: Readings) -> AxialRecord | None:
    """Return the axial force that acts on the shear force of the model; None without one."""
    sidecar, time = readings.sidecar, readings.values["time"]
    if sidecar.axial == "constant":
        return AxialRecord(time, np.full(len(time), sidecar.axial_force))
    return AxialRecord(time, readings.values[AXIAL]) if sidecar.axial == "history" else None


def _stated_axial_force(readings: Readings) -> float | None:
    """Return the axial force that the sidecar or a column states [kN]; None without one."""
    if readings.sidecar.axial_force is not None:
        return float(readings.sidecar.axial_force)
    column = readings.values.get(AXIAL)
    return None if column is None else float(column.mean())


def _rubber_thickness(values: dict[str, Floats], assumptions: list[str]) -> float | None:
    """Return displacement over shear strain [mm] if the file has both and they are proportional."""
    strain = values.get("strain")
    if strain is None or not np.ptp(strain):
        return None
    motion, strain = values["displacement"] - values["displacement"].mean(), strain - strain.mean()
    slope = float(motion @ strain / (strain @ strain))
    if float(np.abs(motion - slope * strain).max()) > TOGETHER * float(np.abs(motion).max()):
        assumptions.append("the strains are not proportional to the displacement and are not used")
        return None
    return abs(100.0 * slope)


def _header_temperature(readings: Readings) -> HeaderTemperature | None:
    """Return the ambient temperature that a line above the table states, if nothing else does."""
    if readings.sidecar.ambient is not None or "ambient" in readings.values:
        return None
    return next(iter(readings.recognised.temperatures), None)


def _describe_unclear_ambient(readings: Readings) -> str:
    """Return why the ambient temperature cannot be assumed; "" if it is stated, or nothing is.

    A column that begins at another temperature than the one that a line above the table states,
    or than the assumed one, contradicts it: it is that of the chamber, or of a specimen that was in
    one.
    """
    columns = readings.recognised.columns
    if readings.sidecar.ambient is not None or any(c.holds == "ambient" for c in columns):
        return ""
    stated = readings.recognised.temperatures
    texts = [f'"{item.text}" (line {item.line})' for item in stated]
    if len({item.degC for item in stated}) > 1:
        return (
            f"the lines above the table state several temperatures: {joined(texts)}. State which "
            'is that of the chamber: ambient = "... degC" in the sidecar'
        )
    ambient = stated[0].degC if stated else ASSUMED_AMBIENT
    colder = [
        column
        for column in columns
        if column.begins is not None and abs(column.begins - ambient) > CLOSE
    ]
    if not colder:
        return ""
    column_texts = " and ".join(
        f'"{column.title}" {column.question}' for column in colder[:MOST_SHOWN]
    )
    statement = f"{texts[0]} is stated" if stated else "no ambient temperature is stated"
    # Only a column that `_ambient` takes is offered: one in a specimen warms during the test.
    steady = [column for column in colder if (column.spread or 0.0) <= STEADY]
    if steady:
        return (
            f"{statement}, but column {column_texts}: is that the temperature of the chamber? Set "
            f'ambient = "{steady[0].title}" in [columns] of the sidecar, or state '
            'ambient = "... degC" there'
        )
    return (
        f"{statement}, but column {column_texts} and then varies by {colder[0].spread:.3g} K or "
        "more, as in a specimen that was in a chamber: state the temperature of the chamber when "
        'the test begins, ambient = "... degC" in the sidecar, and the place of a thermocouple in '
        "[thermocouples]"
    )


def _ambient(readings: Readings, assumptions: list[str]) -> float:
    """Return the chamber temperature [degC]: given, or where a column begins, or assumed."""
    if readings.sidecar.ambient is not None:
        return readings.sidecar.ambient
    if header := _header_temperature(readings):
        return header.degC
    column = readings.values.get("ambient")
    if column is None:
        message = f"no ambient temperature is stated; {ASSUMED_AMBIENT:g} degC is assumed"
        assumptions.append(message)
        return ASSUMED_AMBIENT
    if np.ptp(column) > STEADY:
        raise InputError(
            f"the ambient temperature ranges from {column.min():.3g} to {column.max():.3g} degC, "
            'but a test has one: split the file by temperature, or state ambient = "... degC" in '
            "the sidecar. A thermocouple in the specimen has its place in [thermocouples]",
            str(readings.file),
        )
    drift = _describe_drift(readings.values["time"], column) if "time" in readings.values else ""
    assumptions += [drift] if drift else []
    return check_temperature(_rounded(initial_temperature(column)), f"{readings.file}: ambient")


def _air_offset(readings: Readings) -> float:
    """Return the mean of the column of the chamber less its beginning [K]; 0 without a column."""
    column = readings.values.get("ambient")
    if column is None or readings.sidecar.ambient is not None:
        return 0.0
    return _rounded(float(column.mean())) - _rounded(initial_temperature(column))


def _rounded(temperature: float) -> float:
    """Return a temperature of a chamber, which no one knows to better than a hundredth of a kelvin.

    Zero has no sign.
    """
    return round(temperature, MEAN_TO) + 0.0


def _conditioning(readings: Readings, assumptions: list[str]) -> Conditioning | None:
    """Return how the specimen was brought to the temperature of its chamber, if that is stated."""
    stated = readings.sidecar.conditioning
    if stated is None:
        return None
    complete = filled(stated)
    if stated.before is None:
        assumptions.append(
            f"the temperature of the specimen before its time in the chamber is not stated; "
            f"{complete.before:g} degC is assumed. State before in the sidecar"
        )
    return complete


def reached_values(
    record: TestRecord, rubber: float, ambient: float, lead: tuple[float, float] | None
) -> dict[str, float | Ends]:
    """Return the strain, rate and temperatures that a record reaches, as `reached_by` does.

    `rubber` is the total rubber thickness [mm], `ambient` the ambient temperature [degC], `lead`
    the lowest and highest temperature of the lead [degC].
    """
    time, x = record.time, record.displacement
    ends, lead_ends = (ambient, ambient), None if lead is None else np.array(lead)
    speed = largest_speed(time, x)
    return reached_by(time, x, speed, rubber=rubber, ambient=ends, lead=lead_ends)
