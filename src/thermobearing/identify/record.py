"""A laboratory's test as data: CSV of samples, and a TOML sidecar that says what they are.

A test is one or several blocks with rests between them; `TestRecord` holds all samples in
one line of time. What had to be assumed (clock, ambient temperature) is written down.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from thermobearing.bearing.ambient import check_temperature
from thermobearing.border.errors import InputError, is_file
from thermobearing.border.numbers import number_list
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.tables import Layout, read_columns
from thermobearing.border.toml import read_toml, split_sources

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ASSUMED_SPEED = 30.0  # mean loading rate of Table 3.4 [mm/s], where a file has no clock
ASSUMED_AMBIENT = 23.0  # laboratory temperature of Table 3.4 [degC]
SHORTEST_STEP = 1e-4  # between samples whose clock is made from an assumed speed [s]
COLUMNS = {"time", "displacement", "force"}  # that a sidecar may name
PLACE = re.compile(r"^(?:rubber ([1-9]\d*)|lead)$")

Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
Weight = Annotated[float, Field(ge=0, le=100)]


class BlockFile(Strict):
    """One file of a test in several parts, and the rest before it."""

    file: Annotated[str, Field(min_length=1)]
    rest_before: Annotated[float, in_unit("s"), Field(ge=0, le=1e8)] = 0.0


class Sidecar(Strict):
    """What the numbers of a test mean: the keys of the TOML file beside a CSV file.

    `columns` gives the file's own titles of time, displacement and force, `units` their
    units where the titles do not say them. `thermocouples` maps a title to "rubber 1" (the
    outer layer), "rubber 2", ... or "lead".
    """

    file: Annotated[str, Field(min_length=1)] | None = None
    blocks: Annotated[list[BlockFile], Field(min_length=1)] | None = None
    name: str = ""
    bearing: str | None = None
    ambient: Temperature | None = None
    lines_before: Annotated[int, Field(ge=0, le=1000)] = 0
    lines_after: Annotated[int, Field(ge=0, le=1000)] = 0
    columns: dict[str, str] = Field(default_factory=dict)
    units: dict[str, str] = Field(default_factory=dict)
    thermocouples: dict[str, str] = Field(default_factory=dict)
    speed: Annotated[float, in_unit("mm/s"), Field(gt=0)] | None = None
    sampling: Annotated[float, in_unit("Hz"), Field(gt=0)] | None = None
    flip_force: bool = False
    force_offset: Annotated[float, in_unit("kN")] = 0.0
    displacement_offset: Annotated[float, in_unit("mm")] = 0.0
    weight: Weight = 1.0
    first_cycle_weight: Weight = 1.0
    cycle_balance: Annotated[float, Field(ge=0, le=1)] = 0.0
    despike: bool = False
    detrend: Literal["", "force", "displacement", "both"] = ""

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """One way to name the files, one way to make a clock, known names only."""
        faults = []
        if "file" in given and "blocks" in given:
            faults.append("give either file or blocks")
        if "speed" in given and "sampling" in given:
            faults.append("give either speed or sampling")
        for key in ("columns", "units"):
            table = given.get(key)  # of any type yet: what is no table is found later
            strange = sorted(set(table) - COLUMNS) if isinstance(table, dict) else []
            if strange:
                faults.append(f"{key}: unknown {strange[0]!r}; known: {', '.join(sorted(COLUMNS))}")
        places = given.get("thermocouples")
        for title, place in places.items() if isinstance(places, dict) else ():
            if not isinstance(place, str) or not PLACE.match(place):
                faults.append(
                    f'thermocouples.{title} = {place!r}: must be "rubber 1", ... or "lead"'
                )
        return faults


@dataclass(frozen=True)
class TestRecord:
    """One test of one bearing at one ambient temperature.

    Attributes
    ----------
    name, file : what it is called, where it came from.
    time, displacement, force : samples [s, mm, kN]; force has the sign of displacement.
    block : number of the block that each sample belongs to.
    ambient : temperature of the chamber [degC]; the bearing starts at it.
    temperatures : samples of thermocouples [degC] by title, and
    places : where each of them sits, "rubber 1" (outer layer), ..., "lead".
    weight, first_cycle_weight : of this record in a fit; of its first cycles in addition.
    cycle_balance : 0 counts forces as they are, 1 relative to the peak of their own cycle; between
        them, to that power. Small cycles count for nothing else where large ones are in the record.
    assumptions : what the file did not say.
    bearing : name or file of the bearing, if the sidecar gave one.
    despike : take spikes out before a fit.
    detrend : whose drift to take out before a fit: "force", "displacement", "both", or "".
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
    despike: bool = False
    detrend: str = ""

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
    """A record from histories in memory; gaps in time while nothing moves are rests.

    Parameters
    ----------
    time : [s], increasing.
    displacement, force : [mm], [kN], force with the sign of displacement.
    ambient : [degC].
    name : what reports call it.

    Returns
    -------
    TestRecord

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
    r"""A test from its CSV file or from its sidecar TOML.

    Parameters
    ----------
    path : `test.csv` (its sidecar is `test.toml` beside it, if there is one) or the sidecar.

    Returns
    -------
    TestRecord

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
    path = Path(path)
    if path.suffix.lower() == ".toml":
        return _from_sidecar(path, None)
    beside = path.parent / f"{path.stem}.toml"
    if is_file(beside) and not _is_a_bearing(beside):
        return _from_sidecar(beside, path)
    return _assemble(Sidecar(), [BlockFile(file=str(path))], path.parent, path)


def _is_a_bearing(path: Path) -> bool:
    """Whether a TOML file beside a test describes the bearing, and not the test."""
    geometry = read_toml(path).get("geometry")
    return isinstance(geometry, dict) and "plan" in geometry


def _from_sidecar(path: Path, data: Path | None) -> TestRecord:
    values, _ = split_sources(read_toml(path))
    sidecar = validated(Sidecar, values, str(path))
    blocks = sidecar.blocks
    if blocks is None:
        file = sidecar.file or (data.name if data else path.with_suffix(".csv").name)
        blocks = [BlockFile(file=file)]
    return _assemble(sidecar, blocks, path.parent, path)


def _assemble(sidecar: Sidecar, blocks: list[BlockFile], folder: Path, path: Path) -> TestRecord:
    """All blocks in one line of time."""
    assumptions: list[str] = []
    parts: dict[str, list[Floats]] = {}
    numbers: list[Ints] = []
    end = 0.0
    for number, block in enumerate(blocks):
        file = Path(block.file) if Path(block.file).is_absolute() else folder / block.file
        if not sidecar.file and sidecar.blocks is None and file.name == path.name:
            file = path
        data = _read_block(sidecar, file)
        if "time" not in data:
            data["time"] = _clock(sidecar, data["displacement"], assumptions)
        step = float(np.median(np.diff(data["time"])))
        if number:
            data["time"] = data["time"] - data["time"][0] + end + max(block.rest_before, step)
        end = float(data["time"][-1])
        for name, values in data.items():
            parts.setdefault(name, []).append(values)
        numbers.append(np.full(len(data["time"]), number, dtype=np.int64))
    joined = {name: np.concatenate(values) for name, values in parts.items()}
    ambient = _ambient(sidecar, joined.pop("ambient", None), assumptions, str(path))
    sign = -1.0 if sidecar.flip_force else 1.0
    where = Path(sidecar.bearing) if sidecar.bearing else None
    inside = where is not None and where.suffix == ".toml" and not where.is_absolute()
    return TestRecord(
        name=sidecar.name or path.stem,
        file=str(path),
        time=joined["time"],
        displacement=joined["displacement"] - sidecar.displacement_offset,
        force=sign * (joined["force"] - sidecar.force_offset),
        block=np.concatenate(numbers),
        ambient=ambient,
        temperatures={title: joined[title] for title in sidecar.thermocouples},
        places=dict(sidecar.thermocouples),
        weight=sidecar.weight,
        first_cycle_weight=sidecar.first_cycle_weight,
        cycle_balance=sidecar.cycle_balance,
        despike=sidecar.despike,
        detrend=sidecar.detrend,
        assumptions=tuple(dict.fromkeys(assumptions)),
        bearing=str(folder / where) if inside and where else sidecar.bearing,
    )


def _read_block(sidecar: Sidecar, file: Path) -> dict[str, Floats]:
    titles = {**sidecar.columns, **{title: title for title in sidecar.thermocouples}}
    layout = Layout(sidecar.lines_before, sidecar.lines_after, titles, sidecar.units)
    wanted = {"time": "s", "displacement": "mm", "force": "kN", "ambient": "degC"}
    wanted |= dict.fromkeys(sidecar.thermocouples, "degC")
    return read_columns(file, wanted, optional=("time", "ambient"), layout=layout)


def _clock(sidecar: Sidecar, displacement: Floats, assumptions: list[str]) -> Floats:
    """Time of samples that have none, from a sampling rate or a speed [s]."""
    count = len(displacement)
    if sidecar.sampling is not None:
        assumptions.append(f"no time column: sampled at {sidecar.sampling:g} Hz, as told")
        return np.arange(count) / sidecar.sampling
    told = "as told" if sidecar.speed is not None else "assumed; give speed or sampling"
    speed = sidecar.speed if sidecar.speed is not None else ASSUMED_SPEED
    assumptions.append(f"no time column: moved at {speed:g} mm/s throughout, {told}")
    way = np.abs(np.diff(displacement)) / speed
    return np.concatenate([[0.0], np.cumsum(np.maximum(way, SHORTEST_STEP))])


def _ambient(sidecar: Sidecar, column: Floats | None, assumptions: list[str], where: str) -> float:
    """Chamber temperature: as told, or the file's own column, or assumed [degC]."""
    if sidecar.ambient is not None:
        return sidecar.ambient
    if column is not None:
        if np.ptp(column) > 3.0:
            raise InputError(
                f"ambient runs from {column.min():g} to {column.max():g} degC; one record has one "
                "ambient temperature: cut the file in one per temperature",
                where,
            )
        return float(column.mean())
    assumptions.append(f"no ambient temperature: {ASSUMED_AMBIENT:g} degC assumed; give ambient")
    return ASSUMED_AMBIENT
