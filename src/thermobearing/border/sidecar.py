"""A laboratory's file as histories: columns of samples, and a TOML sidecar that says what they are.

A test is one or several blocks with rests between them, in one file or several; `Readings` holds
all samples in one line of time. What had to be assumed is written down.
"""

import re
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.guess import DOUBTFUL, ColumnGuess, guessed_columns
from thermobearing.border.layout import Layout, Table, make_table
from thermobearing.border.schema import OneLine, Strict, in_unit, validated
from thermobearing.border.sheets import SEPARATORS, Sheet, Told, read_sheets
from thermobearing.border.tables import Columns, list_columns, usable_table
from thermobearing.border.toml import read_toml, split_sources

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ASSUMED_SPEED = 30.0  # mean loading rate of Table 3.4 [mm/s], where a file has no clock
SHORTEST_STEP = 1e-4  # between samples whose clock is made from an assumed speed [s]
PERCENT = 10.0  # largest number from which a column of strains without a unit is in percent
COLUMNS = ("time", "displacement", "force", "ambient")  # that a sidecar may name
PLACE = re.compile(r"^(?:rubber ([1-9]\d*)|lead)$")

Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
Weight = Annotated[float, Field(ge=0, le=100)]
Word = Annotated[str, Field(min_length=1)]


class BlockFile(Strict):
    """One part of a test: a file, a sheet or a part of it, and the rest before it."""

    file: Word
    sheet: Word | None = None
    part: Annotated[int, Field(ge=1, le=10_000)] | None = None
    rest_before: Annotated[float, in_unit("s"), Field(ge=0, le=1e8)] = 0.0


class Sidecar(Strict):
    """What the numbers of a test mean: the keys of the TOML file beside a table of samples.

    `columns` gives the file's own titles of time, displacement, force and ambient, `units` their
    units where the titles do not say them. `thermocouples` maps a title to "rubber 1" (the
    outer layer), "rubber 2", ... or "lead". `separator` (tab, blank, a semicolon, a comma),
    `decimal`, `encoding` and `sheet` are found by looking where they are not given.
    """

    file: Word | None = None
    blocks: Annotated[list[BlockFile], Field(min_length=1)] | None = None
    name: Annotated[str, OneLine] = ""
    bearing: str | None = None
    ambient: Temperature | None = None
    ambient_uncertainty: Annotated[float, in_unit("K"), Field(ge=0, le=20)] | None = None
    lines_before: Annotated[int, Field(ge=0, le=1000)] = 0
    lines_after: Annotated[int, Field(ge=0, le=1000)] = 0
    separator: Word | None = None
    decimal: Word | None = None
    encoding: Word | None = None
    sheet: Word | None = None
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
        places = given.get("thermocouples")
        titles = list(places) if isinstance(places, dict) else []
        for key, known in (("columns", COLUMNS), ("units", (*COLUMNS, *titles))):
            table = given.get(key)  # of any type yet: what is no table is found later
            strange = sorted(set(table) - set(known)) if isinstance(table, dict) else []
            if strange:
                faults.append(f"{key}: unknown {strange[0]!r}; known: {', '.join(sorted(known))}")
        for title, place in places.items() if isinstance(places, dict) else ():
            if not isinstance(place, str) or not PLACE.match(place):
                faults.append(
                    f'thermocouples.{title} = {place!r}: must be "rubber 1", ... or "lead"'
                )
        for key, marks in (
            ("separator", [*SEPARATORS, *SEPARATORS.values()]),
            ("decimal", [".", ","]),
        ):
            if key in given and given[key] not in marks:
                shown = ", ".join(f'"{mark}"' for mark in marks if mark.strip())
                faults.append(f"{key} = {given[key]!r}: must be one of {shown}")
        return faults

    @property
    def told(self) -> Told:
        """The form of the file, as far as it is given."""
        marks = {name: mark for mark, name in SEPARATORS.items()}
        separator = None if self.separator is None else marks.get(self.separator, self.separator)
        return Told(separator, self.decimal, self.encoding, self.sheet)


@dataclass(frozen=True)
class Recognised:
    """The table that a file holds, and what its columns are taken for.

    Attributes
    ----------
    file : that was read.
    sheet : its name, separator and decimal mark.
    alike : names of the sheets with the same titles, which are read one after the other.
    columns : what each column is taken for.
    """

    file: Path
    sheet: Sheet
    alike: list[str]
    columns: list[ColumnGuess]


@dataclass(frozen=True)
class Readings:
    """All samples of a laboratory's file or files, in kN, mm, s, degC.

    Attributes
    ----------
    sidecar : what was said about them, with the thermocouples and the sign that were found.
    file : they came from, the table or its sidecar; names in the sidecar are seen from its folder.
    values : samples by name: time, displacement, force, ambient, strain [percent], and
        thermocouples by title.
    block : number of the block that each sample belongs to.
    recognised : the first file.
    given : the keys of the sidecar as they stand in it.
    assumptions : what the file did not say.
    unused : titles of columns that nothing was made of.
    """

    sidecar: Sidecar
    file: Path
    values: dict[str, Floats]
    block: Ints
    recognised: Recognised
    given: dict[str, Any] = field(default_factory=dict)
    assumptions: list[str] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)

    @property
    def displacement(self) -> Floats:
        """Samples without their offset [mm]."""
        return np.asarray(self.values["displacement"] - self.sidecar.displacement_offset)

    @property
    def force(self) -> Floats:
        """Samples without their offset, with the sign of displacement [kN]."""
        sign = -1.0 if self.sidecar.flip_force else 1.0
        return np.asarray(sign * (self.values["force"] - self.sidecar.force_offset))


def read_laboratory(
    path: str | Path, *, optional: Collection[str] = ("time", "ambient")
) -> Readings:
    r"""Return the histories in a table of samples, or in the files that a sidecar names.

    Every command reads tests in this way. What the sidecar does not say is found by looking:
    encoding, separator, decimal mark, sheets, columns, units, thermocouples, the sign of the
    force. What had to be assumed is listed in `assumptions`.

    Parameters
    ----------
    path : `test.csv` or `test.xlsx` (its sidecar is `test.toml` beside it, if there is one) or the
        sidecar.
    optional : of time, displacement, force, ambient: those that may be missing.

    Returns
    -------
    Readings

    Raises
    ------
    InputError : unreadable file, unknown key or column, wrong unit, a cell that is not a number.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "cold.csv"
    ...     _ = file.write_text("Zeit [s];Weg [cm];Kraft [kN]\n0;0;0\n1;0,5;9\n2;0;-1\n")
    ...     readings = read_laboratory(file)
    >>> readings.displacement.tolist(), readings.force.tolist()
    ([0.0, 5.0, 0.0], [0.0, 9.0, -1.0])
    """
    path = Path(path)
    given: dict[str, Any] = {}
    name, beside = str(path.absolute()), path.parent / f"{path.stem}.toml"
    if path.suffix.lower() == ".toml":
        given, name = split_sources(read_toml(path))[0], path.with_suffix(".csv").name
    elif is_file(beside) and not _is_a_bearing(found := read_toml(beside)):
        given, path, name = split_sources(found)[0], beside, path.name
    sidecar = validated(Sidecar, given, str(path))
    blocks = sidecar.blocks or [BlockFile(file=sidecar.file or name)]
    readings = _readings(sidecar, blocks, path, optional)
    readings = replace(readings, given=given)
    return readings if "force" in optional else _along(readings)


def _is_a_bearing(table: dict[str, Any]) -> bool:
    """Whether a TOML file beside a test describes the bearing, and not the test."""
    geometry = table.get("geometry")
    return isinstance(geometry, dict) and "plan" in geometry


def _along(readings: Readings) -> Readings:
    """The force with the sign of the displacement, unless the sidecar says which sign it has."""
    way, force = readings.values["displacement"], readings.values["force"]
    if "flip_force" in readings.given or way @ (force - force.mean()) >= 0.0:
        return readings
    said = (
        "the recorded force has the opposite sign of the displacement: its sign was reversed; "
        "flip_force in the sidecar states the sign"
    )
    return replace(
        readings,
        sidecar=readings.sidecar.model_copy(update={"flip_force": True}),
        assumptions=[*readings.assumptions, said],
    )


def _readings(
    sidecar: Sidecar, blocks: list[BlockFile], path: Path, optional: Collection[str]
) -> Readings:
    """All blocks of a test in one line of time."""
    assumptions: list[str] = []
    unused: list[str] = []
    parts: list[dict[str, Floats]] = []
    joins: list[tuple[Path, float]] = []
    recognised: list[Recognised] = []
    for block in blocks:
        file = path.parent / block.file
        some, found = _read_block(sidecar, block, file, optional, assumptions, unused)
        parts += some
        joins += [(file, block.rest_before)] + [(file, 0.0)] * (len(some) - 1)
        recognised.append(found)
    if _one_line_of_time(parts, joins):
        assumptions.append(
            "the clock of the file starts anew in its blocks: no rest assumed between them; give "
            "rest_before in blocks of the sidecar"
        )
    held = [name for name in parts[0] if all(name in part for part in parts)]
    counts = [len(part["time"]) for part in parts]
    places = {c.title: c.place for c in recognised[0].columns if c.place and c.title in held}
    return Readings(
        sidecar=sidecar.model_copy(update={"thermocouples": places}),
        file=path,
        values={name: np.concatenate([part[name] for part in parts]) for name in held},
        block=np.repeat(np.arange(len(parts), dtype=np.int64), counts),
        recognised=recognised[0],
        assumptions=list(dict.fromkeys(assumptions)),
        unused=list(dict.fromkeys(unused)),
    )


def _one_line_of_time(parts: list[dict[str, Floats]], joins: list[tuple[Path, float]]) -> bool:
    """Shift the clocks of parts to follow each other; whether a rest had to be assumed."""
    end, own_end, shift, assumed = 0.0, 0.0, 0.0, False
    for number, (part, (file, rest)) in enumerate(zip(parts, joins, strict=True)):
        time = part["time"]
        same = number > 0 and file == joins[number - 1][0] and rest == 0.0
        if number and not (same and time[0] > own_end):
            step = float(np.median(np.diff(time))) if len(time) > 1 else SHORTEST_STEP
            shift = end + max(rest, step) - float(time[0])
            assumed = assumed or same
        own_end = float(time[-1])
        part["time"] = time + shift
        end = float(part["time"][-1])
    return assumed


def _read_block(
    sidecar: Sidecar,
    block: BlockFile,
    file: Path,
    optional: Collection[str],
    assumptions: list[str],
    unused: list[str],
) -> tuple[list[dict[str, Floats]], Recognised]:
    """The parts of one file: sheets, tables below each other, or a clock that starts anew."""
    told = replace(sidecar.told, sheet=block.sheet or sidecar.sheet)
    titles = {**sidecar.columns, **{title: title for title in sidecar.thermocouples}}
    layout = Layout(sidecar.lines_before, sidecar.lines_after, titles, sidecar.units, told)
    sheets = read_sheets(file, told)
    parts: list[dict[str, Floats]] = []
    try:
        recognised, tables = _recognised(file, sheets, layout, sidecar.thermocouples, optional)
        layout, wanted = _completed(tables[0], layout, recognised.columns, optional, assumptions)
        for table in tables:
            found = list_columns(table, wanted, optional, layout)
            unused += found.unused
            parts += _parts_of(sidecar, found, assumptions)
    except InputError as error:
        raise error if error.where else InputError(error.problems, str(file)) from None
    left = [one.name for one in sheets if one.rows and one.name not in recognised.alike]
    if left and told.sheet is None:
        names = ", ".join(f'"{name}"' for name in left)
        assumptions.append(f"sheets that were not read: {names}")
    if len(tables) > 1:
        names = ", ".join(f'"{name}"' for name in recognised.alike)
        assumptions.append(
            f"the sheets {names} are read one after the other, without a rest between them; give "
            "sheet, or blocks with sheet and rest_before"
        )
    if block.part is None:
        return parts, recognised
    if block.part > len(parts):
        raise InputError(f"has {len(parts)} parts, not {block.part}", str(file))
    return parts[block.part - 1 : block.part], recognised


def _recognised(
    file: Path,
    sheets: list[Sheet],
    layout: Layout,
    places: dict[str, str],
    optional: Collection[str],
) -> tuple[Recognised, list[Table]]:
    """The first sheet that holds a test, and the tables of those with the same titles."""
    needed = [name for name in ("displacement", "force") if name not in optional]
    problems: list[str] = []
    for sheet in sheets:
        try:
            table = usable_table(sheet, layout)
            for title in layout.titles.values():
                if title not in table.titles:
                    raise InputError(f'no column "{title}"{nearest(title, table.titles)}')
            columns = guessed_columns(table, layout, places, needed)
        except InputError as error:
            named = f'sheet "{sheet.name}" ' if sheet.name else ""
            problems += [f"{named}{text}" for text in error.problems]
            continue
        found = [
            (one.name, other)
            for one in sheets
            if (other := table if one is sheet else make_table(one, layout)) is not None
            and other.titles == table.titles
            and len(other.rows) > 1
        ]
        alike = [name for name, _ in found]
        return Recognised(file, sheet, alike, columns), [other for _, other in found]
    raise InputError(problems[:5] or ["is empty"])


def _completed(
    table: Table,
    layout: Layout,
    columns: list[ColumnGuess],
    optional: Collection[str],
    assumptions: list[str],
) -> tuple[Layout, dict[str, str]]:
    """The layout with what was guessed, and the units wanted by name.

    Without a force it is a recorded motion, of which nothing but time and displacement is wanted.
    """
    titles, units = dict(layout.titles), dict(layout.units)
    wanted = dict(zip(COLUMNS, ("s", "mm", "kN", "degC"), strict=True))
    wanted |= {title: "degC" for title in titles if title not in COLUMNS}
    if "force" in optional:
        wanted = {name: wanted[name] for name in ("time", "displacement")}
        columns = [column for column in columns if column.holds in wanted]
    for column in columns:
        name = column.title if column.place else column.holds
        if name in titles or not (column.place or name in (*COLUMNS, "strain")):
            continue
        assumed = column.assumed
        if name not in COLUMNS:  # what a test can do without
            try:
                largest = np.abs(table.numbers(table.titles.index(column.title))).max()
            except InputError as error:
                assumptions.append(f"not used: {error.problems[0]}")
                continue
            wanted[name] = "degC" if column.place else "percent"
            if name == "strain" and not column.unit:
                assumed = "percent" if largest >= PERCENT else "dimensionless"
        titles[name] = column.title
        if assumed:
            units[name] = assumed
        if column.assumed:
            assumptions.append(
                f'column "{column.title}" has no unit: {assumed} assumed; give units.{name} in the '
                "sidecar"
            )
        if column.why in DOUBTFUL:
            assumptions.append(
                f'column "{column.title}" is taken as the {name} because of {column.why}; '
                "columns in the sidecar names them"
            )
    return replace(layout, titles=titles, units=units), wanted


def _parts_of(sidecar: Sidecar, found: Columns, assumptions: list[str]) -> list[dict[str, Floats]]:
    """The parts of one table, each with a clock."""
    data = dict(found.values)
    if "time" not in data:
        way = data["displacement"] if "displacement" in data else data["force"]
        data["time"] = _clock(sidecar, way, assumptions)
    elif found.stamped:
        data["time"] = _spread(data["time"], assumptions)
    bounds = [*_starts(found, data["time"]), len(data["time"])]
    return [{name: values[a:b] for name, values in data.items()} for a, b in pairwise(bounds)]


def _starts(found: Columns, time: Floats) -> list[int]:
    """Where parts begin: where the file says so, and where its clock goes back to its start."""
    starts = set(found.parts)
    begin = float(time[0])
    for k in (np.flatnonzero(np.diff(time) < 0.0) + 1).tolist():
        if time[k] <= begin:
            starts.add(k)
            begin = float(time[k])
    return sorted(starts)


def _spread(time: Floats, assumptions: list[str]) -> Floats:
    """Samples of stamps that are coarser than the sampling, evenly between the stamps [s]."""
    ticks = np.flatnonzero(np.diff(time) > 0.0) + 1
    if len(ticks) < 2 or len(ticks) == len(time) - 1 or (np.diff(time) < 0.0).any():
        return time
    counts, steps = np.diff(ticks), np.diff(time[ticks])
    rate = float(np.median(counts / steps))
    number = np.arange(len(time), dtype=np.float64)
    inside = np.interp(number, ticks, time[ticks])
    before = time[ticks[0]] - (ticks[0] - number) / rate
    after = time[ticks[-1]] + (number - ticks[-1]) / rate
    spread = np.where(number < ticks[0], before, np.where(number > ticks[-1], after, inside))
    assumptions.append(
        f"time stamps are {np.median(steps):.3g} s apart, with {np.median(counts):.3g} samples "
        "each: spread evenly between them"
    )
    return np.asarray(spread - spread[0])


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
