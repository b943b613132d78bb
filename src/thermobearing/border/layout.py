"""The table in a sheet: where its titles are, rows of units, parts below each other."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, shortened
from thermobearing.border.sheets import LONGEST_NUMBER, NOT_FINITE, Row, Sheet, Told, is_numeric
from thermobearing.border.titles import is_called, measured_in, name_and_unit
from thermobearing.border.units import HUGEST

Floats = NDArray[np.float64]

DATA = 0.5  # of the cells that hold anything are numbers: a row of data, with faults perhaps
USUAL = 200  # rows whose cells are counted
UNITLESS = re.compile(r"[-–]*|[hHmMsSdDyY./: -]*[:/.][hHmMsSdDyY./: -]*f*")  # in a row of units


@dataclass(frozen=True)
class Layout:
    """How a laboratory's file differs from a plain table.

    Attributes
    ----------
    lines_before : lines before the line that names the columns; 0 finds it.
    lines_after : rows between it and the first numbers (of units, of channels); 0 finds them.
    titles : the file's own title of a column, by the name it is wanted by.
    units : unit of a column, by that name; wins over what the title says.
    told : separator, decimal mark, encoding, sheet.
    """

    lines_before: int = 0
    lines_after: int = 0
    titles: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    told: Told = field(default_factory=Told)


@dataclass(frozen=True)
class Table:
    """Rows of a sheet below their titles.

    Attributes
    ----------
    sheet : that it is in.
    titles : of the columns, each once: a second "force_kN" is "force_kN (2)".
    units : from a row of units below the titles, "" where there is none.
    rows : of numbers, with their line in the file.
    parts : number of the row that each part begins with; a title repeated or a row with one word
        ends a part.
    """

    sheet: Sheet
    titles: list[str]
    units: list[str]
    rows: list[Row]
    parts: list[int]

    def cells(self, column: int) -> list[str]:
        """What stands in a column."""
        return [row[column].strip() if column < len(row) else "" for _, row in self.rows]

    def unit(self, column: int) -> str:
        """The unit of a column, from its title or the row of units; "" if neither says it."""
        return name_and_unit(self.titles[column])[1] or self.units[column]

    def numbers(self, column: int, scale: float = 1.0, offset: float = 0.0) -> Floats:
        """One converted column; names the line of the first cell that is not a finite number."""
        values = np.empty(len(self.rows))
        plain = self.sheet.plain
        for i, (line, row) in enumerate(self.rows):
            try:
                values[i] = number_of(plain(row[column]) if column < len(row) else "")
            except InputError as error:
                raise InputError(error.lines(f"line {line}, {self.titles[column]}")) from None
        return values * scale + offset


def number_of(text: str) -> float:
    """Return a finite float; Python would also take "1_0" and "nan".

    Raises
    ------
    InputError : no number, none that is finite, or one that is too large.
    """
    try:
        value = float(text.replace("_", "x").replace("D", "E").replace("d", "e"))
    except ValueError:
        finite = "finite " if text.strip().lstrip("+-").lower() in NOT_FINITE else ""
        raise InputError(f'"{shortened(text)}" is not a {finite}number') from None
    if not math.isfinite(value):
        raise InputError(f'"{shortened(text)}" is not a finite number')
    if abs(value) > HUGEST:
        raise InputError(f'"{shortened(text)}" is too large, more than {HUGEST:g}')
    return value


def _share(row: list[str]) -> float:
    """Share of numbers in the cells that hold anything."""
    held = [is_numeric(cell) for cell in row if cell.strip()]
    return sum(held) / max(len(held), 1)


def _held(row: list[str]) -> int:
    """Cells that hold anything: "Date;05.02.2026" above a table has fewer than its rows."""
    return sum(bool(cell.strip()) for cell in row)


def _is_units(row: list[str]) -> bool:
    """Whether a row holds units: "[s]", "kN", "-"."""
    bare = [cell.strip().strip("[]()").strip() for cell in row]
    if any(len(text) > LONGEST_NUMBER for text in bare):
        return False
    some = [text for text in bare if not UNITLESS.fullmatch(text)]
    return bool(some) and all(measured_in(text) for text in some)


def make_table(sheet: Sheet, layout: Layout | None = None) -> Table | None:
    """The table in a sheet: titles, units, rows; None where there is nothing.

    Parameters
    ----------
    sheet : from `read_sheets`.
    layout : where the titles are, if they are not to be found by looking.

    Raises
    ------
    InputError : fewer lines than the layout says.
    """
    layout = layout or Layout()
    rows = sheet.rows
    if layout.lines_before:
        rows = [row for row in rows if row[0] > layout.lines_before]
        if not rows and sheet.rows:
            last = sheet.rows[-1][0]
            raise InputError(f"has {last} lines, not {layout.lines_before} before its header")
        head = 0
    else:
        head = _head(rows)
    if not rows:
        return None
    titles, first = rows[head][1], head + 1
    if head == 0 and not layout.lines_before and _share(titles) > DATA:
        titles, first = _commented(sheet, len(titles)), 0
    units = [""] * len(titles)
    body = rows[first:]
    skipped = layout.lines_after or next(
        (n for n, (_, row) in enumerate(body) if _share(row) >= DATA or not _looks_like_head(row)),
        len(body),
    )
    for _, row in body[:skipped]:
        if _is_units(row):
            bare = [cell.strip().strip("[]()").strip(" -") for cell in row]
            units = ["" if UNITLESS.fullmatch(text) else text for text in bare]
            units += [""] * (len(titles) - len(units))
    kept, parts = _in_parts(body[skipped:], titles)
    return Table(sheet, _once(titles), units, kept, parts)


def _looks_like_head(row: list[str]) -> bool:
    """A row of units or of names of channels: words, and more than one."""
    held = [cell for cell in row if cell.strip()]
    return len(held) > 1 and not any(is_numeric(cell) for cell in held)


def _head(rows: list[Row]) -> int:
    """Number of the row of titles: the widest row of words before the first row of numbers."""
    usual = int(np.median([_held(row) for _, row in rows[:USUAL]])) if rows else 0
    first = next(
        (
            n
            for n, (_, row) in enumerate(rows)
            if _share(row) >= DATA and (_held(row) >= usual or is_numeric(row[0]))
        ),
        len(rows),
    )
    before = rows[:first]
    if not before:
        return 0
    widths = [sum(bool(cell.strip()) for cell in row) for _, row in before]
    if first < len(rows):
        widths = [min(width, len(rows[first][1])) for width in widths]
    words = [n for n in range(len(before)) if widths[n] == max(widths)]
    titled = [n for n in words if not _is_units(before[n][1])]
    # Of several the last, but not a row of channel numbers below one that says what they are.
    called = [n for n in titled if any(_means(cell) for cell in before[n][1])]
    return (called or titled or words)[0 if called else -1]


def _means(title: str) -> bool:
    name = name_and_unit(title)[0]
    return any(is_called(name, wanted) for wanted in ("time", "displacement", "force"))


def _commented(sheet: Sheet, width: int) -> list[str]:
    """Titles from a comment above the numbers; else the columns are called by their numbers."""
    for line, text in reversed(sheet.comments):
        cells = re.split(r"\s*[;,\t]\s*|\s+", text)
        if line < sheet.rows[0][0] and len(cells) == width and not all(map(is_numeric, cells)):
            return cells
    return [f"column {n}" for n in range(1, width + 1)]


def _once(titles: list[str]) -> list[str]:
    """Titles without blanks around them; the second of a kind is told by its number."""
    found: list[str] = []
    for number, text in enumerate(titles, 1):
        title = text.strip() or f"column {number}"
        count = sum(one == title or one.startswith(f"{title} (") for one in found) + 1
        found.append(title if count == 1 or title not in found else f"{title} ({count})")
    return found


def _in_parts(rows: list[Row], titles: list[str]) -> tuple[list[Row], list[int]]:
    """Rows of numbers, and where a new part begins: after titles repeated, or one word alone."""
    names = [title.strip() for title in titles]
    kept: list[Row] = []
    parts, fresh = [0], False
    for line, row in rows:
        held = [cell.strip() for cell in row if cell.strip()]
        alone = len(names) > 1 and len(held) == 1 and not is_numeric(held[0])
        if alone or [cell.strip() for cell in row] == names:
            fresh = True
        elif fresh and _share(row) == 0.0 and _is_units(row):
            continue
        else:
            if fresh and kept:
                parts.append(len(kept))
            fresh = False
            kept.append((line, row))
    return kept, parts
