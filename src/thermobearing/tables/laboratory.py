"""A laboratory's file as histories: columns of samples, and a TOML sidecar that explains them.

A test is one or several blocks with rests between them, in one file or several; `Readings` holds
all samples in one line of time, and lists what had to be assumed.
"""

import datetime
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import read_data
from thermobearing.border.opener import is_file
from thermobearing.border.schema import OneLine, Strict, in_unit, validated
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.core.records import Floats, Ints
from thermobearing.tables.columns import (
    Columns,
    Layout,
    Table,
    find_title,
    list_columns,
    make_table,
    usable_table,
)
from thermobearing.tables.conditioning import PLACE, Conditioning, Temperature
from thermobearing.tables.gaps import Gaps, fill_gaps, measure_gaps
from thermobearing.tables.guess import (
    ACROSS,
    AXIAL,
    BY_TITLE,
    DOUBTFUL,
    ColumnGuess,
    HeaderTemperature,
    guessed_columns,
    header_temperatures,
)
from thermobearing.tables.text import SEPARATORS, Form, Sheet, read_sheets

ASSUMED_SPEED = 30.0  # mean loading rate of Table 3.4 [mm/s], where a file has no clock
SHORTEST_STEP = 1e-4  # between samples whose clock is made from an assumed speed [s]
PERCENT = 10.0  # largest number from which a column of strains without a unit is in percent
COLUMNS = {"time": "s", "displacement": "mm", "force": "kN", "ambient": "degC"}  # of a sidecar
MOST_PARTS = 0.1  # of the rows of a table, as parts whose clock restarts
LINE = "line of the file"  # the name of its number among the columns of a part
KEY = "Key"  # head of the keys in the sheet that describes a test


Weight = Annotated[float, Field(ge=0, le=100)]
Word = Annotated[str, Field(min_length=1)]
Part = dict[str, Floats]


class BlockFile(Strict):
    """One block of a test: a file, a sheet or a part of it, and the pause before it."""

    file: Word
    sheet: Word | None = None
    part: Annotated[int, Field(ge=1, le=10_000)] | None = None
    rest_before: Annotated[float, in_unit("s"), Field(ge=0, le=1e8)] = 0.0


class Sidecar(Conditioning):
    """The settings of a test: keys of the TOML file (sidecar) of a table of samples.

    `columns` gives the file's own titles of time, displacement, force, ambient and axial_force,
    `units` their units where the titles do not state them. `axial` says whether the axial force,
    positive in compression, acts on the shear force of the model: that of `axial_force`
    ("constant"), or that of the column ("history"). `thermocouples` maps a title to "rubber 1" (the
    outer layer), "rubber 2", ... or "lead". `separator` (tab, blank, a semicolon, a comma),
    `decimal`, `encoding` and `sheet` are detected where they are not given. The keys of
    `Conditioning` state how long the specimen was in its chamber.
    """

    file: Word | None = None
    blocks: Annotated[list[BlockFile], Field(min_length=1)] | None = None
    name: Annotated[str, OneLine] = ""
    specimen: Annotated[str, OneLine] = ""
    laboratory: Annotated[str, OneLine] = ""
    date: Annotated[str, OneLine] = ""
    scragged: bool | None = None
    bearing: str | None = None
    ambient: Temperature | None = None
    axial_force: Annotated[float, in_unit("kN"), Field(ge=-1e6, le=1e6)] | None = None
    axial: Literal["off", "constant", "history"] | None = None  # None: off
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
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        faults = [
            f"give either {first} or {second}"
            for first, second in (("file", "blocks"), ("speed", "sampling"))
            if first in values and second in values
        ] + super()._conflicts(values)
        # May have any type here; it is validated later.
        tables = {key: value for key, value in values.items() if isinstance(value, dict)}
        places = tables.get("thermocouples", {})
        named = {*COLUMNS, AXIAL}
        for key, accepted in (("columns", named), ("units", {*named, *places})):
            unknown = sorted(set(tables.get(key, {})) - accepted)
            if unknown:
                faults.append(
                    f"{key}: unknown {unknown[0]!r}; known: {', '.join(sorted(accepted))}"
                )
        if values.get("axial") == "constant" and "axial_force" not in values:
            faults.append('axial = "constant": needs axial_force, such as "800 kN"')
        if values.get("axial") == "history" and AXIAL not in tables.get("columns", {}):
            faults.append(
                'axial = "history": needs the title of the column of the axial force: '
                'axial_force = "..." in [columns]'
            )
        faults += [
            f'thermocouples.{title} = {place!r}: must be "rubber 1", ... or "lead"'
            for title, place in places.items()
            if not isinstance(place, str) or not PLACE.match(place)
        ]
        separators = [*SEPARATORS, *SEPARATORS.values()]
        for key, marks in (("separator", separators), ("decimal", [".", ","])):
            if key in values and values[key] not in marks:
                quoted = ", ".join(f'"{mark}"' for mark in marks if mark.strip())
                faults.append(f"{key} = {values[key]!r}: must be one of {quoted}")
        return faults


class DescriptionRow(Strict):
    """One row of the sheet that describes a test: a key of its sidecar."""

    key: Word
    unit: str = ""
    choices: list[str] = Field(default_factory=list)
    meaning: Word


class Description(Strict):
    """Names of the two sheets of a laboratory's workbook, and the rows of the description."""

    sheet: Word
    samples: Word
    rows: list[DescriptionRow]


def description() -> Description:
    """Return the rows of the sheet that describes a test in a laboratory's workbook."""
    return read_data(Description, "tables", "description.toml")


def _described_keys(sheets: list[Sheet]) -> dict[str, Any]:
    """Return the keys of a sidecar in the sheet of a workbook that describes the test."""
    rows = {row.key: row for row in description().rows}
    keys: dict[str, Any] = {}
    for sheet in sheets:
        if sheet.name != description().sheet:
            continue
        cells = [[*row, "", ""][:2] for _, row in sheet.rows]
        heads = [k for k, (key, _) in enumerate(cells) if key == KEY]
        for key, value in cells[heads[0] + 1 :] if heads else []:
            if not value:
                continue
            row = rows.get(key)
            if row is None:
                raise InputError(f'sheet "{sheet.name}": no key "{key}"{nearest(key, rows)}')
            if row.choices and value.lower() not in row.choices:
                allowed = " or ".join(row.choices)
                raise InputError(f'sheet "{sheet.name}": {key} = "{value}": must be {allowed}')
            value = value.removesuffix("T00:00:00")  # of a cell that holds a day
            keys[key] = value.lower() == "yes" if row.choices else f"{value} {row.unit}".strip()
    return keys


class Recognised(NamedTuple):
    """The table that a file holds, and what its columns are taken for.

    `same_titles` are the sheets with the same titles, which are read in sequence.
    """

    file: Path
    sheet: Sheet
    same_titles: list[str]
    columns: list[ColumnGuess]
    temperatures: list[HeaderTemperature]  # of the chamber or the room, above the table


@dataclass(frozen=True)
class Readings:
    """All samples of a laboratory's file or files, in kN, mm, s, degC."""

    sidecar: Sidecar  # with the thermocouples and the sign of the force that were found
    file: Path  # the table or its sidecar; names in the sidecar are seen from its folder
    values: Part  # by name: time, displacement, ..., strain [percent], thermocouples by title
    block: Ints  # number of the block that each sample belongs to
    recognised: Recognised  # the first file
    given: dict[str, Any] = field(default_factory=dict)  # the keys of the sidecar
    assumptions: list[str] = field(default_factory=list)  # what the file did not state
    unused: list[str] = field(default_factory=list)  # titles of unused columns
    clock_restarts: bool = False  # in each block: pauses between them are unknown
    files: tuple[Path, ...] = ()  # all that were read: the sidecar, if any, and the tables
    gaps: list[Gaps] = field(default_factory=list)  # missing readings of temperatures

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
    path: str | Path, *, optional: Collection[str] = ("time", "ambient"), across: str | None = None
) -> Readings:
    r"""Return the histories in a table of samples, or in the files that a sidecar names.

    Every command reads tests in this way. `test.csv` or `test.xlsx` has its sidecar `test.toml`
    in the same folder, if there is one. What the sidecar does not state is detected: encoding,
    separator, decimal mark, sheets, columns, units, thermocouples, the sign of the force. All
    assumptions are listed in `assumptions`. `optional` names the quantities that may be missing;
    `across` is the title of the column of a displacement across, for motions in a plane.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "cold.csv"
    ...     _ = file.write_text("Zeit [s];Weg [cm];Kraft [kN]\n0;0;0\n1;0,5;9\n2;0;-1\n")
    ...     readings = read_laboratory(file)
    >>> readings.displacement.tolist(), readings.force.tolist()
    ([0.0, 5.0, 0.0], [0.0, 9.0, -1.0])
    """
    path = Path(path)
    keys: dict[str, Any] = {}
    name, sidecar_file = str(path.absolute()), path.parent / f"{path.stem}.toml"
    if path.suffix.lower() == ".toml":
        keys, name = split_sources(read_toml(path))[0], path.with_suffix(".csv").name
    elif is_file(sidecar_file):
        table = read_toml(sidecar_file)
        geometry = table.get("geometry")  # of a file that describes the bearing, not the test
        if not (isinstance(geometry, dict) and "plan" in geometry):
            keys, path, name = split_sources(table)[0], sidecar_file, path.name
    # Keys of the sidecar replace those of the workbook's own sheet.
    keys = _workbook_keys(path.parent / name) | keys
    if isinstance(stated := keys.get("date"), datetime.date):  # TOML has dates without quotes
        keys["date"] = stated.isoformat()
    sidecar = validated(Sidecar, keys, str(path))
    readings = replace(_Reader(sidecar, path, optional, across).read(name), given=keys)
    displacement, force = readings.values["displacement"], readings.values.get("force")
    if "force" in optional or force is None or "flip_force" in keys:
        return readings
    # A bearing resists its displacement: the force has its sign, whatever offset was recorded.
    if displacement @ (force - force.mean()) >= 0.0:
        return readings
    note = (
        "the force had the opposite sign of the displacement and was reversed; confirm it with "
        "flip_force = true in the sidecar"
    )
    flipped = readings.sidecar.model_copy(update={"flip_force": True})
    return replace(readings, sidecar=flipped, assumptions=[*readings.assumptions, note])


def _workbook_keys(file: Path) -> dict[str, Any]:
    """Return the keys that a workbook itself states; none of another file."""
    if file.suffix.lower() != ".xlsx" or not is_file(file):
        return {}
    try:
        return _described_keys(read_sheets(file, Form(sheet=description().sheet)))
    except InputError as error:
        if any(text.startswith("no sheet") for text in error.problems):
            return {}
        raise error.located(file) from None


class _Reader:
    """Reader of the blocks of one test; collects assumptions and unused columns."""

    def __init__(
        self, sidecar: Sidecar, path: Path, optional: Collection[str], across: str | None
    ) -> None:
        self.sidecar, self.path, self.optional = sidecar, path, optional
        self.across = {} if across is None else {ACROSS: across}
        self.assumptions: list[str] = []
        self.unused: list[str] = []

    def read(self, name: str) -> Readings:
        """Return all blocks of the test in one line of time."""
        blocks = self.sidecar.blocks or [BlockFile(file=self.sidecar.file or name)]
        parts: list[Part] = []
        joins: list[tuple[Path, float]] = []
        recognised: list[Recognised] = []
        for block in blocks:
            file = self.path.parent / block.file
            try:
                block_parts, block_table = self._block(block, file)
            except InputError as error:
                raise error.located(file) from None
            parts += block_parts
            joins += [(file, block.rest_before)] + [(file, 0.0)] * (len(block_parts) - 1)
            recognised.append(block_table)
        clock_restarts = _join_clocks(parts, joins)
        if clock_restarts:
            self.assumptions.append(
                "the clock of the file restarts in each block; no pause between them is assumed. "
                "State rest_before in blocks of the sidecar"
            )
        common_names = [name for name in parts[0] if all(name in part for part in parts)]
        counts = [len(part["time"]) for part in parts]
        values = {name: np.concatenate([part[name] for part in parts]) for name in common_names}
        numbers = np.repeat(np.arange(len(parts), dtype=np.int64), counts)
        files = [file for file, _ in joins]
        gaps = self._settle_gaps(values, numbers, files, recognised[0].columns)
        places = {c.title: c.place for c in recognised[0].columns if c.place and c.title in values}
        return Readings(
            sidecar=self.sidecar.model_copy(update={"thermocouples": places}),
            file=self.path,
            values=values,
            block=numbers,
            recognised=recognised[0],
            assumptions=list(dict.fromkeys(self.assumptions)),
            unused=list(dict.fromkeys(self.unused)),
            clock_restarts=clock_restarts,
            files=(self.path, *dict.fromkeys(file for file, _ in joins if not self._is_path(file))),
            gaps=gaps,
        )

    def _settle_gaps(
        self, values: Part, block: Ints, files: list[Path], columns: list[ColumnGuess]
    ) -> list[Gaps]:
        """Return the missing readings of temperatures; fill those of the chamber in `values`.

        Take the numbers of lines out of `values`, and a column with too many missing readings that
        the test does not need. `files` are those of the blocks.
        """
        time, lines = values["time"], values.pop(LINE)
        settled: list[Gaps] = []
        for name in [name for name in values if np.isnan(values[name]).any()]:
            chamber = name == "ambient"
            title = next((c.title for c in columns if c.holds == name), name)
            first = int(np.isnan(values[name]).argmax())
            file = files[block[first]]
            place = f"line {lines[first]:.0f}" + (f" of {file.name}" if len(set(files)) > 1 else "")
            gaps = measure_gaps(title, place, time, values[name], chamber=chamber)
            needed = self.sidecar.ambient is None if chamber else name in self.sidecar.thermocouples
            if gaps.fault and needed:
                raise InputError(gaps.fault, str(file))
            if gaps.fault:
                del values[name]
                self.assumptions.append(f"not used: {gaps.fault}")
                continue
            if chamber:
                values[name] = fill_gaps(time, values[name])
            settled.append(gaps)
        return settled

    def _is_path(self, file: Path) -> bool:
        """Return whether a file is that of the call: a table without a sidecar."""
        return file == self.path.absolute()

    def _block(self, block: BlockFile, file: Path) -> tuple[list[Part], Recognised]:
        """The parts of one file: sheets, tables below each other, or a clock that restarts."""
        s = self.sidecar
        marks = {name: mark for mark, name in SEPARATORS.items()}
        separator = None if s.separator is None else marks.get(s.separator, s.separator)
        form = Form(separator, s.decimal, s.encoding, block.sheet or s.sheet)
        titles = {**s.columns, **self.across, **{title: title for title in s.thermocouples}}
        layout = Layout(s.lines_before, s.lines_after, titles, s.units, form)
        sheets = read_sheets(file, form)
        sheets = [
            listed_sheet for listed_sheet in sheets if listed_sheet.name != description().sheet
        ] or sheets
        recognised, tables = self._recognised(file, sheets, layout)
        layout, units_by_name = self._completed(tables[0], layout, recognised.columns)
        parts: list[Part] = []
        for table in tables:
            sensors = [name for name, unit in units_by_name.items() if unit == "degC"]
            columns = list_columns(table, units_by_name, self.optional, layout, sensors)
            columns.values[LINE] = np.array([float(line) for line, _ in table.rows])
            self.unused += columns.unused
            parts += self._parts(columns)
        unread = [
            listed_sheet.name
            for listed_sheet in sheets
            if listed_sheet.rows and listed_sheet.name not in recognised.same_titles
        ]
        if unread and form.sheet is None:
            self.assumptions.append(f"sheets that were not read: {_quoted(unread)}")
        if len(tables) > 1:
            self.assumptions.append(
                f"the sheets {_quoted(recognised.same_titles)} were joined, without a pause "
                "between them. State sheet to read one of them, or rest_before in blocks of the "
                "sidecar"
            )
        if block.part is not None:
            if block.part > len(parts):
                raise InputError(f"has {len(parts)} parts, not {block.part}")
            parts = parts[block.part - 1 : block.part]
        return parts, recognised

    def _recognised(
        self, file: Path, sheets: list[Sheet], layout: Layout
    ) -> tuple[Recognised, list[Table]]:
        """The first sheet that holds a test, and the tables of those with the same titles."""
        needed = [name for name in ("displacement", "force") if name not in self.optional]
        problems: list[str] = []
        for sheet in sheets:
            try:
                table = usable_table(sheet, layout)
                for title in layout.titles.values():
                    if find_title(table.titles, title) is None:
                        raise InputError(f'no column "{title}"{nearest(title, table.titles)}')
                columns = guessed_columns(table, layout, self.sidecar.thermocouples, needed)
            except InputError as error:
                sheet_name = f'sheet "{sheet.name}" ' if sheet.name else ""
                problems += [f"{sheet_name}{text}" for text in error.problems]
                continue
            same_tables = {
                candidate.name: candidate_table
                for candidate in sheets
                if (
                    candidate_table := table
                    if candidate is sheet
                    else make_table(candidate, layout)
                )
                is not None
                and candidate_table.titles == table.titles
                and len(candidate_table.rows) > 1
            }
            temperatures = header_temperatures(table)
            tables = list(same_tables.values())
            return Recognised(file, sheet, list(same_tables), columns, temperatures), tables
        raise InputError(problems[:5] or ["is empty"])

    def _completed(
        self, table: Table, layout: Layout, columns: list[ColumnGuess]
    ) -> tuple[Layout, dict[str, str]]:
        """Return the layout with what was guessed, and the wanted units; a motion has no force."""
        titles, units = dict(layout.titles), dict(layout.units)
        units_by_name = {
            **COLUMNS,
            **{title: BY_TITLE.get(title, "degC") for title in titles if title not in COLUMNS},
        }
        if "force" in self.optional:
            units_by_name = {name: units_by_name[name] for name in ("time", "displacement")}
            units_by_name |= dict.fromkeys(self.across, COLUMNS["displacement"])
            columns = [column for column in columns if column.holds in units_by_name]
        for column in columns:
            name = column.title if column.place else column.holds
            if name in titles or not (column.place or name in (*COLUMNS, "strain")):
                continue
            assumed = column.assumed
            if name not in COLUMNS:  # optional in a test
                try:
                    number, gaps = table.titles.index(column.title), bool(column.place)
                    largest = np.abs(table.numbers(number, gaps=gaps)).max()
                except InputError as error:
                    self.assumptions.append(f"not used: {error.problems[0]}")
                    continue
                units_by_name[name] = "degC" if column.place else "percent"
                if name == "strain" and not column.unit:
                    assumed = "percent" if largest >= PERCENT else "dimensionless"
            titles[name] = column.title
            if assumed:
                units[name] = assumed
            if column.assumed:
                self.assumptions.append(
                    f'column "{column.title}" has no unit; {assumed} is assumed. State '
                    f"units.{name} in the sidecar"
                )
            if column.why in DOUBTFUL:
                self.assumptions.append(
                    f'column "{column.title}" is used as the {name} ({column.why}); confirm it in '
                    "columns of the sidecar"
                )
        return layout._replace(titles=titles, units=units), units_by_name

    def _parts(self, columns: Columns) -> list[Part]:
        """Return the parts of one table, each with a clock."""
        data = dict(columns.values)
        if "time" not in data:
            data["time"] = self._clock(data.get("displacement", data.get("force", np.zeros(0))))
        elif columns.stamped:
            data["time"] = self._spread(data["time"])
        # Parts begin where the file has a break, and where its clock goes back to its start.
        time, starts = data["time"], set(columns.parts)
        begin = float(time[0])
        for k in (np.flatnonzero(np.diff(time) < 0.0) + 1).tolist():
            if time[k] <= begin:
                starts.add(k)
                begin = float(time[k])
        if len(starts) > len(columns.parts) + 1 and len(starts) > MOST_PARTS * len(time):
            raise InputError(
                f"time goes back to its start in {len(starts) - 1} of {len(time)} rows: are rows "
                "out of order, or is time another column? Sort the rows, or name the column of "
                "time in columns of the sidecar"
            )
        bounds = [*sorted(starts), len(time)]
        return [{name: values[a:b] for name, values in data.items()} for a, b in pairwise(bounds)]

    def _spread(self, time: Floats) -> Floats:
        """Samples of stamps that are coarser than the sampling, evenly between the stamps [s]."""
        ticks = np.flatnonzero(np.diff(time) > 0.0) + 1
        if len(ticks) < 2 or len(ticks) == len(time) - 1 or (np.diff(time) < 0.0).any():
            return time
        counts, steps = np.diff(ticks), np.diff(time[ticks])
        # Before the first and after the last change of the stamp, at the rate of the other samples.
        rate = float(np.median(counts / steps))
        number = np.arange(len(time), dtype=np.float64)
        spread = np.interp(number, ticks, time[ticks])
        spread = np.where(number < ticks[0], time[ticks[0]] - (ticks[0] - number) / rate, spread)
        spread = np.where(number > ticks[-1], time[ticks[-1]] + (number - ticks[-1]) / rate, spread)
        self.assumptions.append(
            f"each time stamp, {np.median(steps):.3g} s apart, has {np.median(counts):.3g} "
            "samples; they are spread evenly between the stamps"
        )
        return np.asarray(spread - spread[0])

    def _clock(self, displacement: Floats) -> Floats:
        """Return the time of samples that have none, from a sampling rate or a speed [s]."""
        count, sidecar = len(displacement), self.sidecar
        if sidecar.sampling is not None:
            return np.arange(count) / sidecar.sampling
        speed, origin = ASSUMED_SPEED, "is assumed. State speed or sampling in the sidecar"
        if sidecar.speed is not None:
            speed, origin = sidecar.speed, "of the sidecar is used"
        message = f"there is no column of time; a constant speed of {speed:g} mm/s {origin}"
        self.assumptions.append(message)
        steps = np.abs(np.diff(displacement)) / speed
        return np.concatenate([[0.0], np.cumsum(np.maximum(steps, SHORTEST_STEP))])


def _quoted(names: list[str]) -> str:
    return ", ".join(f'"{name}"' for name in names)


def _join_clocks(parts: list[Part], joins: list[tuple[Path, float]]) -> bool:
    """Shift the clocks of parts to follow each other; return whether a pause had to be assumed."""
    end, own_end, shift, assumed = 0.0, 0.0, 0.0, False
    for number, (part, (file, pause)) in enumerate(zip(parts, joins, strict=True)):
        time = part["time"]
        # A clock that goes on in the same file is right. Another part begins after its pause, or
        # one sample after the part before, so that time increases.
        same_file = number > 0 and file == joins[number - 1][0] and pause == 0.0
        if number and not (same_file and time[0] > own_end):
            step = float(np.median(np.diff(time))) if len(time) > 1 else SHORTEST_STEP
            shift = end + max(pause, step) - float(time[0])
            assumed = assumed or same_file
        own_end = float(time[-1])
        part["time"] = time + shift
        end = float(part["time"][-1])
    return assumed
