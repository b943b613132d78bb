"""Recognition of the columns of a table from their titles, units and numbers."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from thermobearing.border.errors import InputError, read_bytes
from thermobearing.border.units import conversion
from thermobearing.core.records import Floats
from thermobearing.tables.columns import (
    Columns,
    Layout,
    Table,
    find_title,
    first_readable,
    holds_word,
    is_called,
    list_columns,
    measured_in,
    plain_title,
    plain_unit,
    usable_table,
)
from thermobearing.tables.text import LARGEST_FILE, Form, Sheet, is_stamp

UNITS = {"time": "s", "displacement": "mm", "force": "kN", "ambient": "degC"}
ACROSS = "displacement_y"  # of a motion in a plane: never guessed
SAMPLE = 20_000  # rows that are examined
TITLE_BYTES = 10_000  # that hold the titles of a table
MOST_PAIRED = 20  # columns without a recognised title that are compared in pairs
ALONG = 0.3  # correlation of a force with the displacement, or more
EVEN = 0.5  # of the usual step: how much the steps of a clock may differ
CALLED, WORD, UNIT = 4, 2, 1  # scores: full title, a word in it, unit
# Evidence for a column without a recognised title.
DOUBTFUL = (
    *("its even steps", "loops with the force", "loops with the displacement", "its unit"),
    "a constant temperature",
)
STEADY = 2.0  # largest change of a constant temperature during a test [K]
PLAUSIBLE = (-60.0, 50.0)  # ambient temperatures of tests [degC]
_PLACE = re.compile(r"(?:rubber|layer|gummi|ゴム|層)\s*[_#-]?\s*([1-9]\d?)\b", re.IGNORECASE)
Taken = dict[int, tuple[str, str]]  # quantity and reason by the number of the column


@dataclass(frozen=True)
class ColumnGuess:
    """One column of a file and its recognised quantity."""

    title: str
    unit: str  # "" where neither title nor a row of units states it
    holds: str  # time, displacement, force, ambient, temperature, strain, numbers, words, nothing
    why: str  # the evidence
    place: str = ""  # of a thermocouple, where its title states it
    assumed: str = ""  # the unit assumed where the file states none


@dataclass(frozen=True)
class _Column:
    number: int
    title: str
    name: str
    unit: str
    target: str | None
    stamped: bool
    values: Floats | None
    empty: bool
    scores: dict[str, int] = field(default_factory=dict)

    @property
    def signal(self) -> Floats:
        return np.zeros(2) if self.values is None else self.values


def guessed_columns(
    table: Table,
    layout: Layout | None = None,
    places: Mapping[str, str] | None = None,
    needed: Sequence[str] = ("displacement", "force"),
) -> list[ColumnGuess]:
    """Return what each column of a table holds, in the order of the file.

    Titles by quantity in `layout`, and the places of thermocouples by title, are not guessed.
    Raises InputError if no column looks like a needed quantity.
    """
    layout, places = layout or Layout(), places or {}
    columns = [_examined(table, number, layout) for number in range(len(table.titles))]
    places_of_titles = {name: find_title(table.titles, t) for name, t in layout.titles.items()}
    stated = {at: name for name, at in places_of_titles.items() if name in (*UNITS, ACROSS)}
    taken: Taken = {c.number: (stated[c.number], "sidecar") for c in columns if c.number in stated}
    for quantity in ("time", "ambient", "displacement", "force"):
        best = None if quantity in stated.values() else _best(columns, quantity, taken)
        if best is not None and best.title not in places:
            word = "a word in the title" if holds_word(best.name, quantity) else DOUBTFUL[3]
            why = "title" if is_called(best.name, quantity) else word
            taken[best.number] = (quantity, "time stamps" if best.stamped else why)
    _constant_ambient(columns, taken, places)
    _by_numbers(columns, taken)
    held = {quantity for quantity, _ in taken.values()}
    missing = [name for name in needed if name not in held]
    if missing:
        other = [
            f'"{column.title}" has the name of a {name}, but "{column.unit}" cannot be converted '
            f"to {UNITS[name]}; give its unit in [units] of a sidecar"
            for name in missing
            for column in columns
            if column.unit
            and column.target != UNITS[name]
            and (is_called(column.name, name) or holds_word(column.name, name))
            and not holds_word(column.name, "other")
        ]
        shown = ", ".join(f'"{column.title}"' for column in columns[:12] if not column.empty)
        raise InputError(
            other
            or f"no column was recognised as {' or '.join(missing)}; columns: {shown or 'none'}; "
            "name them in [columns] of a sidecar"
        )
    return [_described(column, taken, layout, places) for column in columns]


def _constant_ambient(columns: list[_Column], taken: Taken, places: Mapping[str, str]) -> None:
    """Take the only column titled as a temperature that is constant and plausible as the ambient.

    A thermocouple in the rubber warms by several kelvin; a chamber keeps its temperature.
    """
    if any(quantity == "ambient" for quantity, _ in taken.values()):
        return
    found = []
    for column in columns:
        free = column.number not in taken and column.title not in places
        named = holds_word(column.name, "constant") and not holds_word(column.name, "lead")
        if not (free and named and column.values is not None) or _PLACE.search(column.name):
            continue
        if column.target not in (None, "degC") or (column.unit and column.target is None):
            continue
        scale, offset = conversion(plain_unit(column.unit), "degC") if column.unit else (1.0, 0.0)
        values = scale * column.signal + offset
        if np.ptp(values) <= STEADY and PLAUSIBLE[0] <= values.mean() <= PLAUSIBLE[1]:
            found.append(column)
    if len(found) == 1:
        taken[found[0].number] = ("ambient", DOUBTFUL[4])


def read_air_columns(path: str | Path) -> Columns:
    """Return the columns `time` [s] and `temperature` [degC] of a table of weather.

    Times have their unit, or are dates in one zone without summer time.
    """

    def _read(sheet: Sheet) -> Columns:
        table = usable_table(sheet)
        layout = Layout(titles=_guessed_air(table))
        return list_columns(table, {"time": "s", "temperature": "degC"}, (), layout)

    # "2024-01-31 22:00,5" alone may be 5 degC, or half a second: the titles state the separator.
    raw = read_bytes(Path(path), LARGEST_FILE)[:TITLE_BYTES]
    lines = raw.decode("utf-8-sig", errors="replace").splitlines()
    titles = next((line for line in lines if line[:1].isalpha()), "")
    marks = [mark for mark in ("\t", ";", ",") if mark in titles]
    return first_readable(path, _read, Form(marks[0] if len(marks) == 1 else None))


def _guessed_air(table: Table) -> dict[str, str]:
    """Titles of time and temperature by quantity, without those that no column looks like."""
    columns = [_examined(table, number, Layout()) for number in range(len(table.titles))]
    found = {}
    if not any(is_called(c.name, "time") for c in columns):
        time = _best(columns, "time", {})
        found = {"time": time.title} if time is not None else {}
    if any(is_called(c.name, "temperature") for c in columns):
        return found
    warm = [c for c in columns if c.values is not None and c.target == "degC"]
    some = [c for c in warm if holds_word(c.name, "ambient")] or warm
    if len(some) > 1:
        shown = ", ".join(f'"{c.title}"' for c in some[:5])
        raise InputError(f"{shown} may each be the ambient temperature: rename one to temperature")
    return found | ({"temperature": some[0].title} if some else {})


def _examined(table: Table, number: int, layout: Layout) -> _Column:
    """Return a column with its numbers and its score for each quantity."""
    name, unit = table.names[number], table.units[number]
    cells = [row[number].strip() if number < len(row) else "" for _, row in table.rows[:SAMPLE]]
    held = [cell for cell in cells if cell]
    stamped = bool(held) and is_stamp(held[0])
    target = measured_in(unit) if unit else None
    values = None if stamped or not held else _numbers(table, cells)
    column = _Column(number, table.titles[number], name, unit, target, stamped, values, not held)
    for quantity, wanted in UNITS.items():
        called = bool(held) and is_called(name, quantity)  # by its title, whatever its cells hold
        if values is None and not called and not (stamped and quantity == "time"):
            continue
        score = CALLED * called or WORD * holds_word(name, quantity)
        fits = target == wanted or (score > 0 and quantity in layout.units)
        if unit and not fits and not stamped:
            continue
        if quantity == "ambient" and not (score and (fits or not unit)):
            continue
        other = holds_word(name, "other") or (quantity != "ambient" and holds_word(name, "ambient"))
        score += UNIT * fits + stamped * CALLED - (WORD + UNIT) * other
        if quantity == "displacement" and values is not None and np.ptp(values) == 0.0:
            score -= WORD
        column.scores[quantity] = score
    return column


def _numbers(table: Table, cells: list[str]) -> Floats | None:
    """Return numbers of a column, interpolated where there is none; None if it holds words."""
    values = np.full(len(cells), np.nan)
    wrong = 0
    for k, cell in enumerate(cells):
        try:
            values[k] = float(table.sheet.plain(cell).replace("_", "x"))
        except ValueError:
            wrong += bool(cell)
    good = np.isfinite(values)
    if wrong > 0.1 * len(cells) or not good.any() or np.abs(values[good]).max() > 1e12:
        return None
    return np.asarray(np.interp(np.arange(len(values)), np.flatnonzero(good), values[good]))


def _best(columns: list[_Column], quantity: str, taken: Taken) -> _Column | None:
    """Return the column with the highest score; of equal ones that with the largest variation."""
    some = [c for c in columns if c.number not in taken and c.scores.get(quantity, 0) > 0]
    if quantity == "time":
        some = [c for c in some if c.stamped or is_called(c.name, quantity) or _runs(c.signal)]

    def _evidence(column: _Column) -> tuple[int, bool, bool, float]:
        way = 0.0 if quantity == "time" else float(np.abs(np.diff(column.signal)).sum())
        fits, plain = column.unit == UNITS[quantity], plain_title(column.name) == quantity
        return column.scores[quantity], fits, plain, way

    return max(some, key=_evidence, default=None)


def _runs(values: Floats) -> bool:
    """Return whether numbers increase like a clock, which may restart."""
    steps = np.diff(values)
    return len(steps) > 0 and float(np.median(steps)) > 0.0 and (steps > 0.0).mean() > 0.9


def _by_numbers(columns: list[_Column], taken: Taken) -> None:
    """Recognise columns without titles: an even clock, a pair of columns that forms loops."""
    free = [c for c in columns if c.number not in taken and c.values is not None and not c.unit]
    held = {quantity for quantity, _ in taken.values()}
    if "time" not in held:
        for column in free:
            steps = np.diff(column.signal)
            usual = float(np.median(steps)) if len(steps) else 0.0
            if usual > 0.0 and (np.abs(steps - usual) < EVEN * usual).mean() > 0.95:
                taken[column.number] = ("time", DOUBTFUL[0])
                break
    if {"displacement", "force"} <= held:
        return
    free = [c for c in free if c.number not in taken and np.ptp(c.signal) > 0.0][:MOST_PAIRED]
    known = {taken[c.number][0]: c for c in columns if c.number in taken}
    pairs: list[tuple[float, _Column, _Column]] = []
    for way in [known["displacement"]] if "displacement" in known else free:
        for force in [known["force"]] if "force" in known else free:
            along = _correlation(way.signal, force.signal)
            work = np.sign(along) * float(np.trapezoid(force.signal, way.signal))
            if way is not force and abs(along) > ALONG and work > 0.0:
                pairs.append((abs(along), way, force))
    if pairs:
        _, way, force = max(pairs, key=lambda pair: pair[0])
        taken.setdefault(way.number, ("displacement", DOUBTFUL[1]))
        taken.setdefault(force.number, ("force", DOUBTFUL[2]))


def _correlation(way: Floats, force: Floats) -> float:
    """Return the correlation of two columns; 0 where one of them does not move."""
    a, b = way - way.mean(), force - force.mean()
    size = float(np.sqrt(np.sum(a**2)) * np.sqrt(np.sum(b**2)))
    return float(np.sum(a * b)) / size if size > 1e-100 else 0.0


def _described(
    column: _Column, taken: Taken, layout: Layout, places: Mapping[str, str]
) -> ColumnGuess:
    unit = plain_unit(column.unit) if column.unit else ""
    quantity, why = taken.get(column.number, ("", ""))
    unit = layout.units.get(quantity or column.title, unit)
    place = assumed = ""
    if quantity:
        assumed = "" if unit or column.stamped else UNITS.get(quantity, "mm")
    elif column.title in places:
        quantity, why, place = "temperature", "sidecar", places[column.title]
        assumed = "" if unit else "degC"
    elif column.empty:
        quantity, why = "nothing", "all cells are empty"
    elif column.values is None:
        quantity, why = "words", "no numbers"
    elif column.target == "degC" or (not column.unit and holds_word(column.name, "temperature")):
        found = _PLACE.search(column.name)
        place = f"rubber {found[1]}" if found else "lead" if holds_word(column.name, "lead") else ""
        quantity, why = "temperature", "unit" if column.target == "degC" else "a word in the title"
        assumed = "" if column.unit else "degC"
    elif holds_word(column.title, "strain") and column.target in (None, "percent"):
        unit = "percent" if unit in ("%", "percent") else ""
        quantity, why = "strain", "a word in the title"
    else:
        quantity, why = "numbers", "not needed for a test"
    return ColumnGuess(column.title, unit, quantity, why, place, assumed)
