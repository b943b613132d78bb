"""CSV tables with units in their headers, as laboratories write them.

A header is `name_unit` or `name [unit]`: `time_s`, `displacement_mm`, `force [kN]`. UTF-8
(with or without byte order mark) and Japanese cp932 are read.
"""

import csv
import io
import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest, read_bytes, shortened
from thermobearing.border.units import HUGEST, conversion

Floats = NDArray[np.float64]

_HEADER = re.compile(
    r"^\s*(?P<name>[A-Za-z][A-Za-z ]*?)\s*(?:_|\[|\()\s*(?P<unit>[^\])]+?)\s*[\])]?\s*$"
)
LONGEST_TITLE = 200  # characters; the search for a unit takes time that grows with the square
LARGEST_FILE = 100_000_000  # bytes; in memory, cell by cell, it is ten times that
ALIASES = {"disp": "displacement", "t": "time", "load": "force"}


def read_text(path: Path) -> str:
    """Text of a file, UTF-8 or cp932; InputError if it cannot be read."""
    raw = read_bytes(path, LARGEST_FILE)
    if b"\0" in raw:
        raise InputError("is not a text file: it holds null bytes", str(path))
    for encoding in ("utf-8-sig", "cp932"):
        try:
            return raw.decode(encoding)
        except UnicodeDecodeError:
            continue
    raise InputError("is neither UTF-8 nor cp932 text", str(path))


def _columns(header: list[str]) -> dict[tuple[str, str], int]:
    """(name, unit) -> column number, for the headers that have both."""
    found: dict[tuple[str, str], int] = {}
    for number, title in enumerate(header):
        match = _HEADER.match(title) if len(title) <= LONGEST_TITLE else None
        if match:
            name = match["name"].strip().lower()
            found.setdefault((ALIASES.get(name, name), match["unit"]), number)
    return found


def _pick(
    columns: dict[tuple[str, str], int], name: str, unit: str, header: list[str]
) -> tuple[int, float, float]:
    """Column number of a quantity, and scale and offset to the wanted unit."""
    units = {u: number for (n, u), number in columns.items() if n == name}
    if unit in units:
        return units[unit], 1.0, 0.0
    for given, number in units.items():
        try:
            return number, *conversion(given, unit)
        except InputError as error:
            raise InputError(error.lines(f'column "{header[number]}"')) from None
    hint = nearest(f"{name}_{unit}", header)
    raise InputError(f'no column "{name}_{unit}"{hint}')


def _number(cell: str) -> float:
    """A finite float; Python would also take "1_0" and "nan"."""
    try:
        value = float(cell.replace("_", "x"))
    except ValueError:
        raise InputError(f'"{shortened(cell)}" is not a number') from None
    if not math.isfinite(value):
        raise InputError(f'"{shortened(cell)}" is not a finite number')
    if abs(value) > HUGEST:
        raise InputError(f'"{shortened(cell)}" is too large, more than {HUGEST:g}')
    return value


def _numbers(
    rows: list[tuple[int, list[str]]], number: int, title: str, scale: float, offset: float
) -> Floats:
    """One converted column; names the line of the first cell that is not a finite number."""
    values = np.empty(len(rows))
    for i, (line, row) in enumerate(rows):
        cell = row[number].strip() if number < len(row) else ""
        try:
            values[i] = _number(cell) * scale + offset
        except InputError as error:
            raise InputError(error.lines(f"line {line}, {title}")) from None
    return values


def _rows(path: Path, layout: "Layout") -> list[tuple[int, list[str]]]:
    """Header and rows that hold anything, with their line numbers."""
    lines = io.StringIO(read_text(path), newline=None).readlines()
    if layout.lines_before >= len(lines) > 0:
        raise InputError(f"has {len(lines)} lines, not {layout.lines_before} before its header")
    reader = csv.reader(lines[layout.lines_before :], strict=True)
    try:
        rows = [
            (reader.line_num + layout.lines_before, row)
            for row in reader
            if any(cell.strip() for cell in row)
        ]
    except csv.Error as error:
        line = reader.line_num + layout.lines_before
        raise InputError(f"line {line}: {error}") from None
    return rows[:1] + rows[1 + layout.lines_after :]


@dataclass(frozen=True)
class Layout:
    """How a laboratory's file differs from a plain table.

    Attributes
    ----------
    lines_before : lines before the line that names the columns.
    lines_after : lines between that line and the first numbers (of units, of channels).
    titles : the file's own title of a column, by the name it is wanted by.
    units : unit of a column, by that name; wins over what the title says.
    """

    lines_before: int = 0
    lines_after: int = 0
    titles: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)


def _titled(
    name: str, unit: str, header: list[str], columns: dict[tuple[str, str], int], layout: Layout
) -> tuple[int, float, float]:
    """Column number, scale and offset of a quantity whose title or unit the user gave."""
    known = {number: key for key, number in columns.items()}
    if name in layout.titles:
        title = layout.titles[name]
        if title not in header:
            raise InputError(f'no column "{title}"{nearest(title, header)}')
        number = header.index(title)
    else:
        by_name = [number for (n, _), number in columns.items() if n == name]
        by_name += [number for number, title in enumerate(header) if title.lower() == name]
        if not by_name:
            raise InputError(f'no column "{name}"{nearest(name, header)}')
        number = by_name[0]
    given = layout.units.get(name) or known.get(number, ("", ""))[1]
    if not given:
        bracket = re.search(r"[\[(（_]([^\])）_]+)[\])）]?$", header[number])
        if bracket is None:
            raise InputError(f'column "{header[number]}" has no unit; give units.{name}')
        given = bracket[1]
    try:
        return number, *conversion(given, unit)
    except InputError as error:
        raise InputError(error.lines(f'column "{header[number]}"')) from None


def read_columns(
    path: Path | str,
    wanted: dict[str, str],
    *,
    optional: Collection[str] = (),
    layout: Layout | None = None,
) -> dict[str, Floats]:
    r"""Columns of a CSV file by name, converted to the wanted units.

    Parameters
    ----------
    path : the file; its first line names the columns and their units.
    wanted : unit by column name, such as {"time": "s", "displacement": "mm"}.
    optional : names that may be missing; they are then missing from what is returned.
    layout : extra lines and other titles and units, if the file is not a plain table.

    Raises
    ------
    InputError : unreadable or empty file, missing column, wrong unit, a cell that is not a
        finite number (with its line).

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "ramp.csv"
    >>> _ = file.write_text("time_s,displacement_cm\n0,0\n1,2.5\n")
    >>> read_columns(file, {"time": "s", "displacement": "mm"})["displacement"].tolist()
    [0.0, 25.0]
    """
    try:
        return _read_columns(Path(path), wanted, optional, layout or Layout())
    except InputError as error:
        raise error if error.where else InputError(error.problems, str(path)) from None


def _read_columns(
    path: Path, wanted: dict[str, str], optional: Collection[str], layout: Layout
) -> dict[str, Floats]:
    rows = _rows(path, layout)
    if not rows:
        raise InputError("is empty")
    if len(rows[0][1]) == 1 and re.search("[;\t]", rows[0][1][0]):
        raise InputError("columns must be separated by commas (and decimals take a point)")
    header, body = [title.strip() for title in rows[0][1]], rows[1:]
    columns, picked, problems = _columns(header), {}, []
    for name, unit in wanted.items():
        try:
            if name in layout.titles or name in layout.units:
                picked[name] = _titled(name, unit, header, columns, layout)
            elif name not in optional or any(n == name for n, _ in columns):
                picked[name] = _pick(columns, name, unit, header)
        except InputError as error:
            problems += error.problems
    if len(body) < 2:
        problems.append(f"has {len(body)} rows of numbers; at least 2 are needed")
    if problems:
        raise InputError(problems)
    return {
        name: _numbers(body, number, header[number], scale, offset)
        for name, (number, scale, offset) in picked.items()
    }
