"""Accelerograms in columns of numbers, with or without a line that names them."""

import re
from dataclasses import dataclass, replace

import numpy as np

from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.sheets import COMMENTS, Sheet, sheet_of_text
from thermobearing.border.titles import is_called, name_and_unit, plain_unit
from thermobearing.border.units import conversion
from thermobearing.motions.record import acceleration_unit
from thermobearing.motions.sniffing import (
    LONGEST_LINE,
    NUMBER,
    Options,
    Raw,
    even_step,
    is_not_finite,
    number,
)

_NAME = re.compile(r"[^\W\d_][^\d=]*")
_STEP = re.compile(
    rf"\b(?:dt|time\s*step|delta\s*t|time\s*interval)\s*[=:]?\s*({NUMBER.pattern})\s*(ms|s)?",
    re.IGNORECASE,
)
_UNIT = re.compile(
    r"(?<![\w/])(mm/s(?:ec)?(?:\^?2|/s(?:ec)?)|cm/s(?:ec)?(?:\^?2|/s(?:ec)?)"
    r"|m/s(?:ec)?(?:\^?2|/s(?:ec)?)|gal)(?![\w/])|[\[(]\s*(g)\s*[\])]|\b(?:in|of)\s+(g)\b",
    re.IGNORECASE,
)
_DIRECTION = re.compile(r"\b(N-?S|E-?W|U-?D)\b", re.IGNORECASE)
_MARKS = "".join(COMMENTS) + " "


@dataclass(frozen=True)
class _Column:
    """One column: its number, its name, and its unit if the file tells."""

    number: int
    name: str
    unit: str | None


def _is_row(cells: list[str]) -> bool:
    """Whether cells are numbers (or what should be numbers) and nothing else."""
    fits = [NUMBER.fullmatch(cell) or not cell or is_not_finite(cell) for cell in cells]
    return all(fits) and any(cells)


def _without_gaps(sheet: Sheet) -> Sheet:
    """Without columns in which no row has anything: two tabs between numbers are one gap."""
    width = max((len(cells) for _, cells in sheet.rows), default=0)
    kept = [
        column
        for column in range(width)
        if any(column < len(cells) and cells[column].strip() for _, cells in sheet.rows)
    ]
    if len(kept) == width:
        return sheet
    rows = [(at, [cells[c] for c in kept if c < len(cells)]) for at, cells in sheet.rows]
    return replace(sheet, rows=rows)


def _numbers(sheet: Sheet, first: int, width: int) -> tuple[list[int], list[list[float]]]:
    """Lines and rows of numbers from a line on.

    Raises
    ------
    InputError : a row of another length, a cell that is not a finite number.
    """
    lines, rows = [], []
    for at, cells in sheet.rows:
        if at < first:
            continue
        try:
            if len(cells) != width:
                shown = shortened(sheet.separator.join(cells).strip())
                raise InputError(
                    f'"{shown}" has {len(cells)} columns instead of {width} (a gap in the record?)'
                )
            rows.append([number(sheet.plain(cell)) for cell in cells])
            lines.append(at)
        except InputError as error:
            raise InputError(error.lines(f"line {at}")) from None
    return lines, rows


def read_columns_of_text(lines: list[str], options: Options) -> Raw:
    """Columns of numbers below a free header.

    Raises
    ------
    InputError : no numbers, rows of different length, cells that are not finite numbers, uneven
        times, several components and none chosen.
    """
    sheet = _without_gaps(sheet_of_text("\n".join(lines), quotes=False))
    plain = [(at, [sheet.plain(cell) for cell in cells]) for at, cells in sheet.rows]
    start, width = next(((at, len(cells)) for at, cells in plain if _is_row(cells)), (0, 0))
    if not start:
        raise InputError("holds no numbers; is it an accelerogram?")
    header = [line[:LONGEST_LINE] for line in lines[: start - 1] if line.strip()]
    numbered, rows = _numbers(sheet, start, width)
    table = np.array(rows)
    time, others = _sorted_columns(header, table, width)
    dt = None
    if time is not None:
        scale, _ = conversion(plain_unit(time.unit or "s"), "s")
        if len(table) > 1:
            dt = even_step(table[:, time.number] * scale, numbered)
    else:
        dt = _told_step(header)
    column = _chosen(others, options)
    unit = column.unit or _told_unit(header)
    about = " ".join(line.strip().lstrip(_MARKS) for line in header if len(line.split()) > 3)
    told = column.name if len(others) > 1 else ""
    return Raw(table[:, column.number], dt, unit, description=about[:200], component=told)


def _told_step(header: list[str]) -> float | None:
    """A time step in the free header, such as "dt=0.005 sec" [s]."""
    match = _STEP.search(" ".join(header))
    if not match:
        return None
    return number(match[1]) * (1e-3 if (match[2] or "").lower() == "ms" else 1.0)


def _told_unit(header: list[str]) -> str | None:
    """A unit of acceleration in the free header, such as "Acc. in cm/sec^2"."""
    found = {next(part for part in match if part) for match in _UNIT.findall(" ".join(header))}
    sizes = {acceleration_unit(text) for text in found}
    if len(sizes) > 1:
        raise InputError(f"the header names several units: {', '.join(sorted(found))}; give unit")
    return min(found) if found else None


def _titles(header: list[str], width: int) -> list[str] | None:
    """Names of the columns, if the last line of the header has as many as there are columns.

    A row of units may stand below them.
    """
    units = _cells(header[-1], width) if header else None
    if units is None:
        return None
    above = _cells(header[-2], width) if len(header) > 1 else None
    if above is None or not all(_is_unit(text) for text in units):
        return units
    return [f"{name} [{unit}]" for name, unit in zip(above, units, strict=True)]


def _is_unit(text: str) -> bool:
    """Whether a cell of a header holds a unit of time or acceleration, and nothing else."""
    bare = text.strip("[]() ")
    return bool(_UNIT.fullmatch(bare)) or bare == "g" or plain_unit(bare) in ("s", "ms")


def _cells(line: str, width: int) -> list[str] | None:
    """The words of a line of the header, if there are as many as columns."""
    line = line.strip().lstrip(_MARKS).strip()
    for cells in (re.split(r"[;,\t]", line), re.split(r"\s{2,}", line), line.split()):
        titles = [cell.strip() for cell in cells if cell.strip()]
        if len(titles) == width and all(re.match(r"[^\W\d]|[\[(]", title) for title in titles):
            return [title.strip("[]()") if _is_unit(title) else title for title in titles]
    return None


def _sorted_columns(
    header: list[str], table: "np.ndarray[tuple[int, int], np.dtype[np.float64]]", width: int
) -> tuple[_Column | None, list[_Column]]:
    """The column of time, if there is one, and those of acceleration."""
    titles = _titles(header, width)
    columns = []
    for at in range(width):
        name, unit = name_and_unit(titles[at]) if titles else ("", "")
        told = unit and _NAME.fullmatch(name)  # "dt = 0.01 s" is no title
        columns.append(
            _Column(at, name, unit) if told else _Column(at, titles[at] if titles else "", None)
        )
    clock = next((column for column in columns if is_called(column.name, "time")), None)
    if clock is not None:
        return clock, [column for column in columns if column is not clock]
    if not titles and width > 1 and len(table) > 2 and (np.diff(table[:, 0]) > 0.0).all():
        return columns[0], columns[1:]
    if titles:
        return None, columns
    # Two columns under a comment that tells their directions in this order.
    ways = [way.upper().replace("-", "") for way in _DIRECTION.findall(" ".join(header))]
    if len(ways) == width and len(set(ways)) == width:
        columns = [_Column(at, way, None) for at, way in enumerate(ways)]
    return None, columns


def _chosen(columns: list[_Column], options: Options) -> _Column:
    """The wanted component; InputError if there are several and none was chosen."""
    if not columns:
        raise InputError("holds a column of time and no acceleration")
    names = [column.name or str(place) for place, column in enumerate(columns, 1)]
    if options.component is None:
        if len(columns) > 1:
            raise InputError(
                f"holds {len(columns)} components ({', '.join(names)}); give component"
            )
        return columns[0]
    wanted = str(options.component).strip()
    for place, column in enumerate(columns, 1):
        if wanted == str(place):
            return column
    for name, column in zip(names, columns, strict=True):
        if name.lower() == wanted.lower().replace("-", ""):
            return column
    raise InputError(f'no component "{wanted}"{nearest(wanted, names)}')
