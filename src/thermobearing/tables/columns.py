"""Columns of a table by name or quantity: titles, units, blocks of rows, time stamps.

A title is `name_unit` or `name [unit]`: `time_s`, `displacement_mm`, `force [kN]`; the unit may
also be in a separate row below.
"""

import math
import re
import unicodedata
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple, TypeVar

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.border.units import HUGEST, conversion
from thermobearing.core.records import Floats
from thermobearing.tables.gaps import is_missing
from thermobearing.tables.text import (
    LARGEST_SHEET,
    LONGEST_NUMBER,
    Form,
    Row,
    Sheet,
    is_not_finite,
    is_numeric,
    is_stamp,
    read_sheets,
)

T = TypeVar("T")
LONGEST_TITLE = 200  # characters that are examined
# Quantities by the unit of this package.
MEASURED = ("mm", "kN", "s", "degC", "mm/s^2", "mm/s", "Hz", "MPa", "percent", "degree", "V")
DATA = 0.5  # share of numeric cells from which a row counts as data
USUAL = 200  # rows whose cells are counted
UNITLESS = re.compile(r"[-–]*|[hHmMsSdDyY./: -]*[:/.][hHmMsSdDyY./: -]*f*")  # in a row of units
DAY = 86400.0  # [s]
ONLY_TEMPERATURES = "only temperatures of a test may have missing readings"
_BRACKET = re.compile(r"^(?P<name>[^\[(（]*)[\[(（](?P<unit>[^\])）]*)[\])）]?$")
_JOINED = re.compile(r"^(?P<name>.*[^\s_])_(?P<unit>[^_\d][^_]*)$")
_APART = re.compile(r"^(?P<name>.*\S)(?:\s*[,:/]\s*|\s+)(?P<unit>\S+)$")
_HYPHEN = re.compile("[\u2010-\u2015\u2043\u2212]")  # NFKC unifies the others
_COMMA = re.compile(r"(:\d+),(\d+)")
_YEAR_LAST = re.compile(r"^\d{1,2}[./-]\d{1,2}[./-]\d{4}\b")


@cache
def _words(table: str) -> Mapping[str, tuple[str, ...]]:
    """Return one table of data/tables/words.toml: names, within, joined or units."""
    content = read_toml(data_path("tables", "words.toml"))
    return {name: tuple(spellings) for name, spellings in content[table].items()}


def plain_title(text: str) -> str:
    """Return a title in lower case, with single blanks between its words and one kind of hyphen.

    >>> plain_title(" Temp_Ambient "), plain_title("Ｔ－ａｍｂ"), plain_title("Ⅱ−Ⅰ‐１")
    ('temp ambient', 't-amb', 'ii-i-1')
    """
    flat = unicodedata.normalize("NFKC", text[:LONGEST_TITLE]).lower()
    return " ".join(re.split(r"[\s_]+", _HYPHEN.sub("-", flat).strip(" _\t")))


def find_title(titles: Sequence[str], wanted: str) -> int | None:
    """Return the place of the title that a user writes; None if there is none, or several.

    It is the same text, or else the only title that differs by letter case, blanks, full-width
    characters and kinds of hyphens; its unit, and at last all hyphens, may be left out.

    >>> find_title(["time_s", "Ⅱ－Ⅰ－１ [gal]", "Ⅱ－Ⅰ－２ [gal]"], "II-I-2")
    2
    """
    if wanted in titles:
        return titles.index(wanted)
    plain_names = [name_and_unit(title)[0] for title in titles]
    # From the strictest comparison to the loosest: the first that fits any title decides.
    simplifications: tuple[Callable[[str], str], ...] = (plain_title, _without_hyphens)
    for simplify, names in product(simplifications, (titles, plain_names)):
        places = [at for at, name in enumerate(names) if simplify(name) == simplify(wanted)]
        if places:
            return places[0] if len(places) == 1 else None
    return None


def _without_hyphens(title: str) -> str:
    return plain_title(title).replace("-", "")


def plain_unit(text: str) -> str:
    """Return a unit in pint's spelling (laboratories also write "sec", "℃", "tf")."""
    flat = unicodedata.normalize("NFKC", text).strip()
    return next(
        (unit for unit, spellings in _words("units").items() if flat.lower() in spellings), flat
    )


@cache
def measured_in(unit: str) -> str | None:
    """Return the unit of this package that a column's unit converts to, or None.

    >>> measured_in("tf"), measured_in("cm"), measured_in("no")
    ('kN', 'mm', None)
    """
    for target in MEASURED:
        try:
            conversion(plain_unit(unit), target)
        except InputError:
            continue
        return target
    return None


def name_and_unit(title: str) -> tuple[str, str]:
    """Return the two parts of "time_s", "Force [kN]", "Weg, mm"; no unit is "".

    >>> name_and_unit("temp_ambient_C"), name_and_unit("Force [kN]"), name_and_unit("Shear disp")
    (('temp_ambient', 'C'), ('Force', 'kN'), ('Shear disp', ''))
    """
    text = title.strip()
    if len(text) > LONGEST_TITLE:
        return text[:LONGEST_TITLE], ""
    bracket = _BRACKET.match(text)
    if bracket and bracket["name"].strip(" _"):
        return bracket["name"].strip(" _"), bracket["unit"].strip()
    joined = _JOINED.match(text)
    if joined:
        plain = plain_title(text)
        # "temp_chamber" is a name in itself. The last word of another title counts as its unit even
        # where that is unknown, so that a misspelled unit is reported.
        is_name = any(plain in spellings for spellings in _words("names").values())
        if is_name and not _is_known_unit(joined["unit"]):
            return text, ""
        return joined["name"].strip(), joined["unit"].strip()
    separated = _APART.match(text)
    if separated and _is_known_unit(separated["unit"]):
        return separated["name"].rstrip(" ,:/"), separated["unit"].strip()
    return text, ""


def _is_known_unit(unit: str) -> bool:
    return not unit[0].isdigit() and measured_in(unit) is not None


def is_called(name: str, quantity: str) -> bool:
    """Return whether a column of this name holds a quantity ("disp" is a displacement)."""
    flat = plain_title(name)
    return flat == quantity or flat in _words("names").get(quantity, ())


def holds_word(name: str, quantity: str) -> bool:
    """Whether one of the words of a title refers to a quantity.

    >>> holds_word("Chamber air T3", "ambient"), holds_word("repair", "ambient")
    (True, False)
    >>> holds_word("Kammertemperatur", "ambient")
    True
    """
    flat = plain_title(name)
    if any(part in flat for part in _words("joined").get(quantity, ())):
        return True
    tokens = {token.rstrip("0123456789.") for token in re.split(r"[^\w]+|_", flat)}
    return any(
        word in tokens or (word in flat and (" " in word or not word.isascii()))
        for word in _words("within")[quantity]
    )


class Layout(NamedTuple):
    """Layout of a file that is not a plain table.

    `lines_before` counts the lines before the line of titles and `lines_after` the rows between
    it and the first numbers; 0 finds them. `titles` holds the file's own title and `units` the unit
    of a column, by quantity; such a unit has priority over that in the title.
    """

    lines_before: int = 0
    lines_after: int = 0
    titles: Mapping[str, str] = MappingProxyType({})
    units: Mapping[str, str] = MappingProxyType({})
    form: Form = Form()


class Table(NamedTuple):
    """Rows of numbers of a sheet, with their line in the file, below their titles.

    Each title occurs once: a second "force_kN" is "force_kN (2)". `names` are the titles without
    their units; `units` come from the titles or a row of units, "" where neither states them.
    `parts` are the numbers of the rows that parts begin with: a title repeated or a row with one
    word ends a part.
    """

    sheet: Sheet
    titles: list[str]
    names: list[str]
    units: list[str]
    rows: list[Row]
    parts: list[int]

    def cells(self, column: int) -> list[str]:
        """Return the text of the cells of a column."""
        return [row[column].strip() if column < len(row) else "" for _, row in self.rows]

    def numbers(
        self, column: int, scale: float = 1.0, offset: float = 0.0, *, gaps: bool = False
    ) -> Floats:
        """Return a converted column; an error names the line of the first cell without a number.

        With `gaps`, missing readings are NaN.
        """
        values = np.empty(len(self.rows))
        plain = self.sheet.plain
        for i, (line, row) in enumerate(self.rows):
            cell = row[column] if column < len(row) else ""
            try:
                values[i] = read_number(plain(cell))
            except InputError as error:
                missing = is_missing(cell)
                if gaps and missing:
                    values[i] = math.nan
                    continue
                problems = error.lines(f"line {line}, {self.titles[column]}")
                hint = f"; {ONLY_TEMPERATURES}" if missing else ""
                raise InputError([f"{text}{hint}" for text in problems]) from None
        return values * scale + offset


def even_table(lines: list[str], sheet: Sheet) -> Floats | None:
    r"""Return lines as a table of numbers, read in C; `sheet` is of the first lines of their file.

    None where a line differs from the first in any way that concerns reading (its number of cells,
    blank, a comment, a cell that only `read_number` reads or refuses): these are read in Python.

    >>> from thermobearing.tables.text import sheet_of_text
    >>> sheet = sheet_of_text("t;a\n0;5\n1;25\n")
    >>> even_table(["0;5", "1;2.5"], sheet)
    array([[0. , 5. ],
           [1. , 2.5]])
    >>> even_table(["0;5", "1;2,5"], sheet) is None
    True
    """
    if sheet.decimal != "." or not all(map(str.isascii, lines)):
        return None
    # The blank separates cells in Python, but any white space in C.
    if sheet.separator == " " and any("\t" in line for line in lines):
        return None
    separator = None if sheet.separator == " " else sheet.separator
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            table = np.loadtxt(lines, delimiter=separator, comments=None, ndmin=2)
    except (ValueError, UserWarning):
        return None
    is_even = len(table) == len(lines) and table.size <= LARGEST_SHEET
    return table if is_even and bool((np.abs(table) <= HUGEST).all()) else None


def read_number(text: str, limit: float = HUGEST) -> float:
    """Return a finite float of a plausible size; Python would also take "1_0" and "nan"."""
    try:
        value = float(text.replace("_", "x").replace("D", "E").replace("d", "e"))
    except ValueError:
        finite = "finite " if is_not_finite(text) else ""
        raise InputError(f'"{shortened(text)}" is not a {finite}number') from None
    if not math.isfinite(value):
        raise InputError(f'"{shortened(text)}" is not a finite number')
    if abs(value) > limit:
        raise InputError(f'"{shortened(text)}" is too large, more than {limit:g}')
    return value


def _filled(row: list[str]) -> list[str]:
    """Return the cells with content: "Date;05.02.2026" above a table has fewer than its rows."""
    return [cell.strip() for cell in row if cell.strip()]


def _share(row: list[str]) -> float:
    """Return the share of numbers in the cells with content."""
    numeric = [is_numeric(cell) for cell in _filled(row)]
    return sum(numeric) / max(len(numeric), 1)


def _bare_units(row: list[str]) -> list[str] | None:
    """Return the units in a row of "[s]", "kN", "-", ...; None for another row."""
    bare = [cell.strip().strip("[]()").strip() for cell in row]
    if any(len(text) > LONGEST_NUMBER for text in bare):
        return None
    units = [text for text in bare if not UNITLESS.fullmatch(text)]
    return bare if units and all(measured_in(text) for text in units) else None


def make_table(sheet: Sheet, layout: Layout | None = None) -> Table | None:
    """Return the table in a sheet: titles, units, rows; None where there is nothing.

    Raises InputError for fewer lines than the layout states.
    """
    layout = layout or Layout()
    rows = sheet.rows
    if layout.lines_before:
        rows = [row for row in rows if row[0] > layout.lines_before]
        if not rows and sheet.rows:
            last = sheet.rows[-1][0]
            raise InputError(f"has {last} lines, not {layout.lines_before} before its header")
    if not rows:
        return None
    head = 0 if layout.lines_before else _head(rows)
    titles, first = rows[head][1], head + 1
    if head == 0 and not layout.lines_before and _share(titles) > DATA:
        # The first row holds numbers already: no row is left for the titles.
        titles, first = _titles_of_comment(sheet, len(titles)), 0
    units = [""] * len(titles)
    body = rows[first:]
    skipped = layout.lines_after or next(
        (
            n
            for n, (_, row) in enumerate(body)  # units and names of channels: words, more than one
            if len(_filled(row)) < 2 or any(map(is_numeric, _filled(row)))
        ),
        len(body),
    )
    for _, row in body[:skipped]:
        if (bare := _bare_units(row)) is not None:
            units = ["" if UNITLESS.fullmatch(unit := text.strip(" -")) else unit for text in bare]
            units += [""] * (len(titles) - len(units))
    data_rows, parts = _in_parts(body[skipped:], titles)
    titles = _unique_titles(titles)
    pairs = [name_and_unit(title) for title in titles]
    # Brackets without a unit are a part of the title where a row below has the unit.
    pairs = [
        (title, "") if row_unit and title_unit and measured_in(title_unit) is None else pair
        for title, pair, row_unit in zip(titles, pairs, units, strict=False)
        for _, title_unit in [pair]
    ]
    units = [
        title_unit or row_unit for (_, title_unit), row_unit in zip(pairs, units, strict=False)
    ]
    return Table(sheet, titles, [name for name, _ in pairs], units, data_rows, parts)


def _head(rows: list[Row]) -> int:
    """Number of the row of titles: the widest row of words before the first row of numbers."""
    median_width = int(np.median([len(_filled(row)) for _, row in rows[:USUAL]]))
    first = next(
        (
            n
            for n, (_, row) in enumerate(rows)
            if _share(row) >= DATA and (len(_filled(row)) >= median_width or is_numeric(row[0]))
        ),
        len(rows),
    )
    rows_above = [row for _, row in rows[:first]]
    if not rows_above:
        return 0
    width = len(rows[first][1]) if first < len(rows) else len(max(rows_above, key=len))
    widths = [min(len(_filled(row)), width) for row in rows_above]
    widest = [n for n in range(len(rows_above)) if widths[n] == max(widths)]
    titled = [n for n in widest if _bare_units(rows_above[n]) is None]
    # The last of several, but not a row of channel numbers below a row of names.
    named = [n for n in titled if any(_names_quantity(cell) for cell in rows_above[n])]
    return named[0] if named else (titled or widest)[-1]


def _names_quantity(title: str) -> bool:
    name = name_and_unit(title)[0]
    return any(is_called(name, quantity) for quantity in ("time", "displacement", "force"))


def _titles_of_comment(sheet: Sheet, width: int) -> list[str]:
    """Titles from a comment above the numbers; else the columns are called by their numbers."""
    for line, text in reversed(sheet.comments):
        cells = re.split(r"\s*[;,\t]\s*|\s+", text)
        if line < sheet.rows[0][0] and len(cells) == width and not all(map(is_numeric, cells)):
            return cells
    return [f"column {n}" for n in range(1, width + 1)]


def _unique_titles(titles: list[str]) -> list[str]:
    """Return the titles without blanks around them; the second of a kind gets a number."""
    unique_titles: list[str] = []
    for number, text in enumerate(titles, 1):
        title = text.strip() or f"column {number}"
        same = [
            earlier
            for earlier in unique_titles
            if earlier == title or earlier.startswith(f"{title} (")
        ]
        unique_titles.append(f"{title} ({len(same) + 1})" if title in unique_titles else title)
    return unique_titles


def _in_parts(rows: list[Row], titles: list[str]) -> tuple[list[Row], list[int]]:
    """Rows of numbers, and where a new part begins: after titles repeated, or one word alone."""
    names = [title.strip() for title in titles]
    data_rows: list[Row] = []
    parts, new_part = [0], False
    for line, row in rows:
        filled = _filled(row)
        lone_word = len(names) > 1 and len(filled) == 1 and not is_numeric(filled[0])
        if lone_word or [cell.strip() for cell in row] == names:
            new_part = True
        # A row of units below repeated titles belongs to them.
        elif not new_part or _share(row) > 0.0 or _bare_units(row) is None:
            if new_part and data_rows:
                parts.append(len(data_rows))
            new_part = False
            data_rows.append((line, row))
    return data_rows, parts


class Columns(NamedTuple):
    """What was read from a file.

    `values` are in the wanted units, by the wanted names; `parts` the numbers of the samples that
    parts begin with; `unused` the titles of other columns with content. `begins` is the date of the
    first stamp, if the time came from stamps (`stamped`) and these have dates.
    """

    values: dict[str, Floats]
    parts: list[int]
    unused: list[str]
    stamped: bool = False
    begins: np.datetime64 | None = None


@checked
def read_columns(
    path: Path | str,
    wanted: dict[str, str],
    *,
    optional: Collection[str] = (),
    layout: Layout | None = None,
) -> dict[str, Floats]:
    r"""Return columns of a file by name, converted to the wanted units.

    Parameters
    ----------
    path : text with any separator, or `.xlsx`; a line names the columns and their units.
    wanted : unit by column name, such as {"time": "s", "displacement": "mm"}.
    optional : names that may be missing; they are then absent from the result.
    layout : extra lines and other titles and units, if the file is not a plain table.

    Raises
    ------
    InputError : unreadable or empty file, missing column, wrong unit, a cell that is not a
        finite number (with its line).

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "ramp.csv"
    >>> _ = file.write_text("time_s;displacement_cm\n0;0\n1;2,5\n")
    >>> read_columns(file, {"time": "s", "displacement": "mm"})["displacement"].tolist()
    [0.0, 25.0]
    """
    form = layout or Layout()

    def _read(sheet: Sheet) -> Columns:
        return list_columns(usable_table(sheet, form), wanted, optional, form)

    return first_readable(path, _read, form.form).values


def first_readable(path: Path | str, read: Callable[[Sheet], T], form: Form | None = None) -> T:
    """Return the result of `read` for the first sheet of a file that it can read."""
    first: InputError | None = None
    for sheet in read_sheets(Path(path), form):
        try:
            return read(sheet)
        except InputError as error:
            first = first or error
    raise (first or InputError("is empty")).located(path) from None


def usable_table(sheet: Sheet, layout: Layout | None = None) -> Table:
    """Return the table in a sheet; InputError for fewer than two rows of numbers."""
    table = make_table(sheet, layout)
    if table is None:
        raise InputError("is empty")
    width, problems = len(table.titles), []
    doubled = bool(table.rows) and all(len(row) == 2 * width for _, row in table.rows[:50])
    if sheet.separator == "," and width > 1 and doubled:
        problems.append(
            f"has {width} titles and {2 * width} numbers in a row: decimal commas between commas "
            "are ambiguous; separate columns by semicolons"
        )
    if len(table.rows) < 2:
        problems.append(f"has {len(table.rows)} rows of numbers; at least 2 are needed")
    if problems:
        raise InputError(problems)
    return table


def list_columns(
    table: Table,
    wanted: dict[str, str],
    optional: Collection[str],
    layout: Layout,
    gaps: Collection[str] = (),
) -> Columns:
    """Return the wanted columns of a table, its parts and its unused titles; see `read_columns`.

    Missing readings of the columns in `gaps` are NaN.
    """
    columns_by_name: dict[str, tuple[int, float, float]] = {}
    problems: list[str] = []
    for name, unit in wanted.items():
        try:
            match = _find_column(table, name, unit, layout, needed=name not in optional)
            if match is not None:
                columns_by_name[name] = match
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    used_columns = {column for column, *_ in columns_by_name.values()}
    values: dict[str, Floats] = {}
    stamped, begins = False, None
    for name, (column, scale, offset) in columns_by_name.items():
        if name == "time" and is_stamp(table.cells(column)[0]):
            values[name], begins, dates = _stamps(table, column)
            used_columns |= dates
            stamped = True
        else:
            values[name] = table.numbers(column, scale, offset, gaps=name in gaps)
    unused = [
        title
        for n, title in enumerate(table.titles)
        if n not in used_columns and any(table.cells(n)[:50])
    ]
    return Columns(values, table.parts, unused, stamped, begins)


def _find_column(
    table: Table, name: str, unit: str, layout: Layout, *, needed: bool
) -> tuple[int, float, float] | None:
    """Column number of a quantity, scale and offset to the wanted unit; None if it may be missing.

    Raises InputError where there is none and it is needed, or none with a fitting unit.
    """
    if name in layout.titles:
        title = layout.titles[name]
        place = find_title(table.titles, title)
        if place is None:
            raise InputError(f'no column "{title}"{nearest(title, table.titles)}')
        candidates = [place]
    else:
        candidates = [
            n for n, column_name in enumerate(table.names) if is_called(column_name, name)
        ]
        # Columns of exactly this name before those of a synonym.
        candidates.sort(key=lambda n: plain_title(table.names[n]) != name)
    for n in candidates:
        if name == "time" and table.rows and is_stamp(table.cells(n)[0]):
            return n, 1.0, 0.0
    units = {n: layout.units.get(name) or table.units[n] for n in candidates}
    # A column in the wanted unit is preferred to one that must be converted.
    best = next((n for n, column_unit in units.items() if column_unit == unit), None)
    if best is not None:
        return best, 1.0, 0.0
    for n, column_unit in units.items():
        if column_unit:
            try:
                return n, *conversion(plain_unit(column_unit), unit)
            except InputError as error:
                raise InputError(error.lines(f'column "{table.titles[n]}"')) from None
    if not needed and not (name in layout.titles or name in layout.units):
        return None
    if name in layout.titles or (candidates and name in layout.units):
        raise InputError(f'column "{table.titles[candidates[0]]}" has no unit; give units.{name}')
    expected_title = name if name in layout.units else f"{name}_{unit}"
    raise InputError(f'no column "{expected_title}"{nearest(expected_title, table.titles)}')


def _stamps(table: Table, column: int) -> tuple[Floats, np.datetime64 | None, set[int]]:
    """Return seconds of a column of stamps, their start, and the column of dates, if separate."""
    heads = {n: table.cells(n)[0] for n in range(len(table.titles)) if n != column}
    cells = table.cells(column)
    paired: list[int] = []
    if ":" not in cells[0]:  # a date: the time of day is in the next column
        paired = [n for n, head in heads.items() if ":" in head][:1]
        pairs = [(cells, table.cells(n)) for n in paired]
    elif " " not in cells[0]:
        days = [n for n, head in heads.items() if is_stamp(head) and ":" not in head]
        paired = [n for n in days if is_called(table.names[n], "time")][:1]
        pairs = [(table.cells(n), cells) for n in paired]
    else:
        pairs = []
    for dates, times in pairs:
        cells = [f"{day} {time}" for day, time in zip(dates, times, strict=True)]
    try:
        return *_seconds_and_start(cells), set(paired)
    except InputError as error:
        raise InputError(error.lines(f'column "{table.titles[column]}"')) from None


def _seconds_and_start(stamps: list[str]) -> tuple[Floats, np.datetime64 | None]:
    """Return the seconds since the first stamp, and its date (None for a clock without dates).

    Stamps are all dates with times, or all times ("23:59:58.5", also hours of a running clock). A
    clock without dates that passes midnight continues. If the order of day and month is
    ambiguous, the order that gives the shorter record is used. A time zone is dropped. The
    seconds are not checked to increase.

    >>> _seconds_and_start(["23:59:59.5", "00:00:00,5"])[0].tolist()
    [0.0, 1.0]
    >>> _seconds_and_start(["31.01.2024 23:59", "01.02.2024 00:01"])[0].tolist()
    [0.0, 120.0]
    """
    cells = [_COMMA.sub(r"\1.\2", cell.strip().replace("/", "-")) for cell in stamps]
    if all(re.match(r"^\d+:", cell) for cell in cells):
        return _clock(cells), None
    orders = (True, False) if _YEAR_LAST.match(cells[0]) else (False,)
    results = [result for day_first in orders if (result := _parsed(cells, day_first)) is not None]
    if not results:
        raise InputError(f'"{shortened(cells[0])}" or a stamp below it is not a date and time')
    forward = [result for result in results if (np.diff(result[0]) >= 0.0).all()] or results
    return min(forward, key=lambda result: float(np.ptp(result[0])))


def _clock(cells: list[str]) -> Floats:
    """Return seconds of times of day since the first."""
    padded = [cell if cell.count(":") > 1 else f"{cell}:00" for cell in cells]
    if all(cell.count(":") == 1 and "." in cell for cell in cells):
        padded = [f"00:{cell}" for cell in cells]  # minutes and seconds with decimals
    try:
        values = pd.to_timedelta(pd.Series(padded)).dt.total_seconds().to_numpy(dtype=float)
    except (ValueError, OverflowError):
        values = np.array([np.nan])
    if not np.isfinite(values).all():
        raise InputError("contains a cell that is not a time of day such as 23:59:58.5")
    # A step back by more than half a day is midnight; a smaller one is an error of the clock.
    midnights = np.cumsum(np.concatenate([[0.0], np.diff(values) < -0.5 * DAY]))
    shifted = values + DAY * midnights
    return np.asarray(shifted - shifted[0], dtype=np.float64)


def _parsed(cells: list[str], day_first: bool) -> tuple[Floats, np.datetime64] | None:
    """Seconds since the first, and its date; None if they are not all dates of this order."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # pandas warns about its guess, which is checked here
        for form in ("ISO8601", None, "mixed"):
            try:
                stamps = pd.to_datetime(pd.Series(cells), format=form, dayfirst=day_first)
                values = (stamps - stamps.iloc[0]).dt.total_seconds().to_numpy(dtype=float)
            except (ValueError, TypeError, OverflowError, AttributeError):
                continue
            if np.isfinite(values).all():
                start = stamps.iloc[0].tz_localize(None).to_datetime64()
                return np.asarray(values, dtype=np.float64), start
    return None
