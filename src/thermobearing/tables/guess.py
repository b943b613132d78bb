"""Recognition of the columns of a table from their titles, units and numbers.

The lines above a table may state the temperature of the chamber or the room.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from thermobearing.border.errors import InputError, shortened
from thermobearing.border.opener import read_bytes
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
from thermobearing.tables.gaps import fill_gaps, initial_temperature, is_missing
from thermobearing.tables.text import LARGEST_FILE, Form, Sheet, is_stamp

UNITS = {"time": "s", "displacement": "mm", "force": "kN", "ambient": "degC"}
ACROSS = "displacement_y"  # of a motion in a plane
AXIAL = "axial_force"  # of a test
BY_TITLE = {ACROSS: "mm", AXIAL: "kN"}  # never guessed: columns that a caller or a sidecar names
SAMPLE = 20_000  # rows that are examined
TITLE_BYTES = 10_000  # that hold the titles of a table
MOST_PAIRED = 20  # columns without a recognised title that are compared in pairs
ALONG = 0.3  # correlation of a force with the displacement, or more
EVEN = 0.5  # of the usual step: how much the steps of a clock may differ
CALLED, WORD, UNIT = 4, 2, 1  # scores: full title, a word in it, unit
# Evidence for a column without a recognised title.
EVEN_STEPS = "its even steps"
FORCE_LOOPS = "loops with the force"
DISPLACEMENT_LOOPS = "loops with the displacement"
UNIT_ALONE = "its unit"
STEADY_TEMPERATURE = "a constant temperature"
DOUBTFUL = (EVEN_STEPS, FORCE_LOOPS, DISPLACEMENT_LOOPS, UNIT_ALONE, STEADY_TEMPERATURE)
STEADY = 2.0  # largest change of a constant temperature during a test [K]
KELVIN = (200.0, 330.0)  # numbers that are temperatures in kelvin, of tests and specimens
FROST = -2.0  # a steady column without name and unit, below this, is taken for a temperature [degC]
PLAUSIBLE = (-60.0, 50.0)  # ambient temperatures of tests [degC]
_PLACE = re.compile(r"(?:rubber|layer|gummi|ゴム|層)\s*[_#-]?\s*([1-9]\d?)\b", re.IGNORECASE)
# A temperature in a line of text, with its tolerance if it has one: "-20 °C", "23 ± 2 °C", "23度".
_DIGITS = r"\d{1,4}(?:[.,]\d{1,4})?"
_TOLERANCE = rf"(?:\s{{0,3}}(?:±|\+/?-)\s{{0,3}}{_DIGITS})?"
_SIGNED = rf"(?<![\w.,-])(?P<value>[-+]?{_DIGITS})"
_TEMPERATURE = re.compile(
    rf"{_SIGNED}{_TOLERANCE}\s{{0,3}}(?P<unit>°\s?[CF]|deg\.?\s?[CF]|grad\s?C|[CKF]\b|度)",
    re.IGNORECASE,
)
_NUMBER = re.compile(_DIGITS)
_BARE = re.compile(rf"{_SIGNED}(?![\w.,:/-])")
_RANGE = re.compile(r"\d\s{0,3}(?:-|~|to|bis)\s{0,3}$")  # before the second end of a range
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
    begins: float | None = None  # of what may be a temperature [degC]
    question: str = ""  # why the column may be the temperature of the chamber
    spread: float | None = None  # of what may be a temperature [K]


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
    stated_quantities = {
        at: name for name, at in places_of_titles.items() if name in (*UNITS, *BY_TITLE)
    }
    taken: Taken = {
        c.number: (stated_quantities[c.number], "sidecar")
        for c in columns
        if c.number in stated_quantities
    }
    # Titles and units first: numbers decide only on columns that these leave open.
    for quantity in ("time", "ambient", "displacement", "force"):
        if quantity in stated_quantities.values():
            continue
        best = _best_column(columns, quantity, taken)
        if best is not None and best.title not in places:
            word = "a word in the title" if holds_word(best.name, quantity) else UNIT_ALONE
            reason = "title" if is_called(best.name, quantity) else word
            taken[best.number] = (quantity, "time stamps" if best.stamped else reason)
    _constant_ambient(columns, taken, places)
    _guess_by_numbers(columns, taken)
    recognised = {quantity for quantity, _ in taken.values()}
    missing = [name for name in needed if name not in recognised]
    if missing:
        wrong_units = [
            f'"{column.title}" has the name of a {name}, but "{column.unit}" cannot be converted '
            f"to {UNITS[name]}; give its unit in [units] of a sidecar"
            for name in missing
            for column in columns
            if column.unit
            and column.target != UNITS[name]
            and (is_called(column.name, name) or holds_word(column.name, name))
            and not holds_word(column.name, "other")
        ]
        titles = ", ".join(f'"{column.title}"' for column in columns[:12] if not column.empty)
        raise InputError(
            wrong_units
            or f"no column was recognised as {' or '.join(missing)}; columns: {titles or 'none'}; "
            "name them in [columns] of a sidecar"
        )
    return [_described(column, taken, layout, places) for column in columns]


def _describe_beginning(column: _Column) -> tuple[float | None, str, float | None]:
    """Return where a temperature begins [degC], why it may be that of the chamber, its range [K].

    A column counts if its title or its unit is one of temperatures. One without either counts if it
    is steady and below freezing, as no other column of a test is.
    """
    if column.values is None or column.empty or holds_word(column.name, "other"):
        return None, "", None
    has_temperature_word = any(
        map(partial(holds_word, column.name), ("temperature", "constant", "ambient"))
    )
    if column.unit and column.target != "degC":
        return None, "", None
    scale, offset = conversion(plain_unit(column.unit), "degC") if column.unit else (1.0, 0.0)
    values = scale * column.signal + offset
    begin, spread = initial_temperature(values), float(np.ptp(values))
    steady = spread <= STEADY
    words = f"stays at {begin:.4g} degC" if steady else f"begins at {begin:.4g} degC"
    if not (has_temperature_word or column.unit):
        cold = steady and PLAUSIBLE[0] <= begin <= FROST
        why = f"stays at {begin:.4g}, without a unit"
        return (begin, why, spread) if cold else (None, "", None)
    if KELVIN[0] <= begin <= KELVIN[1] and not column.unit:
        return begin, f"begins at {begin:.4g}, which may be in kelvin (give its unit)", spread
    is_plausible = PLAUSIBLE[0] <= begin <= PLAUSIBLE[1]
    return (begin, words, spread) if is_plausible else (None, "", None)


def _constant_ambient(columns: list[_Column], taken: Taken, places: Mapping[str, str]) -> None:
    """Take the only column titled as a temperature that is constant and plausible as the ambient.

    A thermocouple in the rubber warms by several kelvin; a chamber keeps its temperature.
    """
    if any(quantity == "ambient" for quantity, _ in taken.values()):
        return
    candidates = []
    for column in columns:
        is_free = column.number not in taken and column.title not in places
        words = [holds_word(column.name, word) for word in ("constant", "temperature")]
        of_specimen = holds_word(column.name, "lead") or _PLACE.search(column.name)
        if not (is_free and any(words) and column.values is not None) or of_specimen:
            continue
        if column.target not in (None, "degC") or (column.unit and column.target is None):
            continue
        scale, offset = conversion(plain_unit(column.unit), "degC") if column.unit else (1.0, 0.0)
        values = scale * column.signal + offset
        if np.ptp(values) <= STEADY and PLAUSIBLE[0] <= values.mean() <= PLAUSIBLE[1]:
            candidates.append(column)
    if len(candidates) == 1:
        taken[candidates[0].number] = ("ambient", STEADY_TEMPERATURE)


class HeaderTemperature(NamedTuple):
    """A temperature of the chamber or the room in a line above a table."""

    line: int  # of the file
    text: str
    degC: float


def header_temperatures(table: Table) -> list[HeaderTemperature]:
    """Return the temperatures of the chamber or the room in the lines above a table.

    A number without a unit counts where it is the only one of a line with a word for temperature.
    """
    sheet, first = table.sheet, table.rows[0][0] if table.rows else 0
    lines = [*sheet.comments, *((n, sheet.separator.join(cells)) for n, cells in sheet.rows)]
    temperatures = []
    for number, line in sorted(lines):
        if number >= first or not any(holds_word(line, word) for word in ("ambient", "stated")):
            continue
        # A comma may be a decimal mark, or stand between the name, the value and its unit.
        blanked = line.replace(sheet.separator, " ")
        matches = _find_temperatures(line) or _find_temperatures(blanked)
        words = shortened(" ".join(blanked.split()))
        temperatures += [HeaderTemperature(number, words, degrees) for degrees in matches]
    return temperatures


def _find_temperatures(line: str) -> list[float]:
    """Return the temperatures in a line of text [degC] that are plausible for a test."""
    text = plain_title(line)
    matches = list(_TEMPERATURE.finditer(text))
    if not matches and any(holds_word(text, word) for word in ("temperature", "stated")):
        matches = list(_BARE.finditer(text)) if len(_NUMBER.findall(text)) == 1 else []
    temperatures = []
    for match in matches:
        unit = match.groupdict().get("unit") or "degC"
        unit = unit.upper() if len(unit) == 1 else unit  # kelvin, of a title in small letters
        scale, offset = conversion(plain_unit(unit), "degC")
        value = scale * float(match["value"].replace(",", ".")) + offset
        is_end_of_range = _RANGE.search(text[: match.start()])
        if PLAUSIBLE[0] <= value <= PLAUSIBLE[1] and not is_end_of_range:
            temperatures.append(round(value, 2))
    return temperatures


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
    titles = {}
    if not any(is_called(c.name, "time") for c in columns):
        time = _best_column(columns, "time", {})
        titles = {"time": time.title} if time is not None else {}
    if any(is_called(c.name, "temperature") for c in columns):
        return titles
    temperatures = [c for c in columns if c.values is not None and c.target == "degC"]
    candidates = [c for c in temperatures if holds_word(c.name, "ambient")] or temperatures
    if len(candidates) > 1:
        names = ", ".join(f'"{c.title}"' for c in candidates[:5])
        raise InputError(f"{names} may each be the ambient temperature: rename one to temperature")
    return titles | ({"temperature": candidates[0].title} if candidates else {})


def _examined(table: Table, number: int, layout: Layout) -> _Column:
    """Return a column with its numbers and its score for each quantity."""
    name, unit = table.names[number], table.units[number]
    cells = [row[number].strip() if number < len(row) else "" for _, row in table.rows[:SAMPLE]]
    filled = [cell for cell in cells if not is_missing(cell)]
    stamped = bool(filled) and is_stamp(filled[0])
    target = measured_in(unit) if unit else None
    values = None if stamped or not filled else _numbers(table, cells)
    column = _Column(number, table.titles[number], name, unit, target, stamped, values, not filled)
    for quantity, usual_unit in UNITS.items():
        # A full name counts whatever the cells hold.
        has_full_name = bool(filled) and is_called(name, quantity)
        if values is None and not has_full_name and not (stamped and quantity == "time"):
            continue
        score = CALLED * has_full_name or WORD * holds_word(name, quantity)
        unit_fits = target == usual_unit or (score > 0 and quantity in layout.units)
        if unit and not unit_fits and not stamped:
            continue
        # A temperature whose title does not speak of the surroundings may be a thermocouple's.
        if quantity == "ambient" and not (score and (unit_fits or not unit)):
            continue
        # A word for another quantity outweighs a word for this one together with its unit.
        other_quantity = holds_word(name, "other") or (
            quantity != "ambient" and holds_word(name, "ambient")
        )
        score += UNIT * unit_fits + stamped * CALLED - (WORD + UNIT) * other_quantity
        if quantity == "displacement" and values is not None and np.ptp(values) == 0.0:
            score -= WORD
        column.scores[quantity] = score
    return column


def _numbers(table: Table, cells: list[str]) -> Floats | None:
    """Return numbers of a column, interpolated where there is none; None if it holds words."""
    values = np.full(len(cells), np.nan)
    word_count = 0
    for k, cell in enumerate(cells):
        try:
            values[k] = float(table.sheet.plain(cell).replace("_", "x"))
        except ValueError:
            word_count += not is_missing(cell)
    finite = np.isfinite(values)
    if word_count > 0.1 * len(cells) or not finite.any() or np.abs(values[finite]).max() > 1e12:
        return None
    places = np.arange(len(values), dtype=np.float64)
    return fill_gaps(places, np.where(finite, values, np.nan))


def _best_column(columns: list[_Column], quantity: str, taken: Taken) -> _Column | None:
    """Return the column with the highest score; of equal ones that with the largest variation."""
    candidates = [c for c in columns if c.number not in taken and c.scores.get(quantity, 0) > 0]
    if quantity == "time":
        candidates = [
            c for c in candidates if c.stamped or is_called(c.name, quantity) or _is_clock(c.signal)
        ]

    def _evidence(column: _Column) -> tuple[int, bool, bool, float]:
        travel = 0.0 if quantity == "time" else float(np.abs(np.diff(column.signal)).sum())
        unit_fits, name_fits = column.unit == UNITS[quantity], plain_title(column.name) == quantity
        return column.scores[quantity], unit_fits, name_fits, travel

    return max(candidates, key=_evidence, default=None)


def _is_clock(values: Floats) -> bool:
    """Return whether numbers increase like a clock, which may restart."""
    steps = np.diff(values)
    return len(steps) > 0 and float(np.median(steps)) > 0.0 and (steps > 0.0).mean() > 0.9


def _guess_by_numbers(columns: list[_Column], taken: Taken) -> None:
    """Recognise columns without titles: an even clock, a pair of columns that forms loops."""
    unnamed = [c for c in columns if c.number not in taken and c.values is not None and not c.unit]
    recognised = {quantity for quantity, _ in taken.values()}
    if "time" not in recognised:
        for column in unnamed:
            steps = np.diff(column.signal)
            median_step = float(np.median(steps)) if len(steps) else 0.0
            if (
                median_step > 0.0
                and (np.abs(steps - median_step) < EVEN * median_step).mean() > 0.95
            ):
                taken[column.number] = ("time", EVEN_STEPS)
                break
    if {"displacement", "force"} <= recognised:
        return
    unnamed = [c for c in unnamed if c.number not in taken and np.ptp(c.signal) > 0.0][:MOST_PAIRED]
    recognised_columns = {taken[c.number][0]: c for c in columns if c.number in taken}
    pairs: list[tuple[float, _Column, _Column]] = []
    for displacement in (
        [recognised_columns["displacement"]] if "displacement" in recognised_columns else unnamed
    ):
        for force in [recognised_columns["force"]] if "force" in recognised_columns else unnamed:
            correlation = _correlation(displacement.signal, force.signal)
            # A bearing dissipates energy: with the sign of the correlation, its loop encloses
            # positive work. That also tells force and displacement apart.
            work = np.sign(correlation) * float(np.trapezoid(force.signal, displacement.signal))
            if displacement is not force and abs(correlation) > ALONG and work > 0.0:
                pairs.append((abs(correlation), displacement, force))
    if pairs:
        _, displacement, force = max(pairs, key=lambda pair: pair[0])
        taken.setdefault(displacement.number, ("displacement", FORCE_LOOPS))
        taken.setdefault(force.number, ("force", DISPLACEMENT_LOOPS))


def _correlation(displacement: Floats, force: Floats) -> float:
    """Return the correlation of two columns; 0 where one of them does not move."""
    a, b = displacement - displacement.mean(), force - force.mean()
    size = float(np.sqrt(np.sum(a**2)) * np.sqrt(np.sum(b**2)))
    return float(np.sum(a * b)) / size if size > 1e-100 else 0.0


def _described(
    column: _Column, taken: Taken, layout: Layout, places: Mapping[str, str]
) -> ColumnGuess:
    unit = plain_unit(column.unit) if column.unit else ""
    quantity, reason = taken.get(column.number, ("", ""))
    unit = layout.units.get(quantity or column.title, unit)
    place = assumed = ""
    if quantity:
        assumed = "" if unit or column.stamped else (UNITS | BY_TITLE)[quantity]
    elif column.title in places:
        quantity, reason, place = "temperature", "sidecar", places[column.title]
        assumed = "" if unit else "degC"
    elif column.empty:
        quantity, reason = "nothing", "all cells are empty"
    elif column.values is None:
        quantity, reason = "words", "no numbers"
    elif column.target == "degC" or (not column.unit and holds_word(column.name, "temperature")):
        match = _PLACE.search(column.name)
        if match:
            place = f"rubber {match[1]}"
        elif holds_word(column.name, "lead"):
            place = "lead"
        quantity, reason = (
            "temperature",
            "unit" if column.target == "degC" else "a word in the title",
        )
        assumed = "" if column.unit else "degC"
    elif holds_word(column.title, "strain") and column.target in (None, "percent"):
        unit = "percent" if unit in ("%", "percent") else ""
        quantity, reason = "strain", "a word in the title"
    else:
        quantity, reason = "numbers", "not needed for a test"
    begin, question, spread = (None, "", None) if quantity in UNITS else _describe_beginning(column)
    return ColumnGuess(
        column.title, unit, quantity, reason, place, assumed, begin, question, spread
    )
