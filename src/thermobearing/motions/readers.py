"""Read accelerograms: formats, columns, units and time steps.

PEER AT2, K-NET and KiK-net ASCII, JMA CSV, and columns of numbers (CSV or text). The file or the
caller must state the unit, and the size of the motion must make sense with it.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError, nearest, printable, shortened
from thermobearing.border.opener import is_file
from thermobearing.border.units import FORTRAN_NUMBER, HUGEST, conversion
from thermobearing.core.types import Floats
from thermobearing.motions.record import (
    MOST_SAMPLES,
    GroundMotion,
    acceleration_unit,
    checked_motion,
    even_step,
    refuse_many,
)
from thermobearing.results.directory import MOTION, SUMMARY
from thermobearing.tables.columns import (
    even_table,
    find_title,
    is_called,
    name_and_unit,
    plain_unit,
    read_number,
)
from thermobearing.tables.text import (
    COMMENTS,
    SEPARATOR_ROWS,
    Row,
    Sheet,
    is_not_finite,
    read_sheets,
    read_text,
    sheet_of_text,
)

if TYPE_CHECKING:
    from thermobearing.motions.targets import DesignSpectrum

NUMBER = re.compile(FORTRAN_NUMBER)
TARGET = "target:"  # begins the comment with the spectrum that a motion was made to fit
LONGEST_LINE = 500  # characters of a header line that are examined
WORKBOOKS = (".xlsx", ".xlsm")
JMA_COMPONENTS = ("NS", "EW", "UD")
HEAD = 1000  # lines that show how the cells of a long file are separated
LONGEST_DESCRIPTION = 300  # characters
KNET_TITLE = 18  # characters of the title of an entry in a K-NET header
KNET_COMPONENTS = {"1": "NS", "2": "EW", "3": "UD", "4": "NS", "5": "EW", "6": "UD"}
_NUM, _MARKS = FORTRAN_NUMBER, "".join(COMMENTS) + " "
_AT2_NAMED = re.compile(rf"NPTS\s*=\s*(\d{{1,9}})\s*,?\s*DT\s*=\s*({_NUM})", re.IGNORECASE)
_AT2_FIRST = re.compile(rf"^\s*(\d{{1,9}})\s*,?\s*({_NUM})\s+NPTS\s*,\s*DT", re.IGNORECASE)
_AT2_UNIT = re.compile(
    r"UNITS?\s+(?:OF|ARE|IN|:|=)\s*\(?\s*([A-Za-z][A-Za-z0-9/^]*)", re.IGNORECASE
)
_SCALE = re.compile(rf"({_NUM})\s*\(gal\)\s*/\s*({_NUM})")
# A word, a unit, or "２－Ⅰ－１": a number, a hyphen and a letter, all of them of any width.
_TITLE = re.compile(r"[^\W\d]|[\[(]|\d+[-\u2010-\u2015\u2212\uff0d][^\W\d]")
_NAME = re.compile(r"[^\W\d_][^\d=]*")
_STEP = re.compile(
    rf"\b(?:dt|time\s*step|delta\s*t|time\s*interval)\s*[=:]?\s*({_NUM})\s*(ms|s)?", re.IGNORECASE
)
_UNIT = re.compile(
    r"(?<![\w/])(mm/s(?:ec)?(?:\^?2|/s(?:ec)?)|cm/s(?:ec)?(?:\^?2|/s(?:ec)?)"
    r"|m/s(?:ec)?(?:\^?2|/s(?:ec)?)|gal)(?![\w/])|[\[(]\s*(g)\s*[\])]|\b(?:in|of)\s+(g)\b",
    re.IGNORECASE,
)
_DIRECTION = re.compile(r"\b(N-?S|E-?W|U-?D)\b", re.IGNORECASE)


class _Raw(NamedTuple):
    """Content of a file; `dt` [s] and `unit` are None where the file does not state them."""

    values: Floats
    dt: float | None
    unit: str | None
    instrument: bool = False
    description: str = ""
    component: str = ""
    target: "DesignSpectrum | None" = None


class _Column(NamedTuple):
    """One column: its number, its name, and its unit if the file states it."""

    number: int
    name: str
    unit: str | None


def read_motion(
    path: str | Path,
    *,
    unit: str | None = None,
    dt: float | None = None,
    component: str | int | None = None,
    name: str | None = None,
    trust_unit: bool = False,
) -> GroundMotion:
    r"""Return a ground motion from a file, whose format is detected.

    Formats are PEER AT2 (all headers with NPTS and DT), K-NET and KiK-net ASCII, JMA CSV, and plain
    columns, also of a workbook: time and acceleration, or accelerations alone.

    A largest acceleration outside 100 to 2000 gal (K-NET, KiK-net and JMA, where the unit belongs
    to the format: 10 to 5000 gal) is refused unless `trust_unit`. Gaps, uneven steps, cells that
    are not finite numbers and contradictions between file and arguments are errors.

    Parameters
    ----------
    unit : unit of the acceleration (g, gal, m/s2, cm/s2 or mm/s2), if the file has none.
    dt : time step [s], if the file has none.
    component : component, by name (NS) or number from 1, if the file has several.
    trust_unit : accept a peak acceleration that is implausible for the unit.
    """
    path = Path(path)
    try:
        raw = _read(_text(path), None if component is None else str(component).strip())
        effective_unit = unit or raw.unit
        if effective_unit is None:
            raise InputError(
                "the file does not state the unit of the acceleration; give unit: g, gal, m/s2, "
                "cm/s2 or mm/s2"
            )
        if raw.unit and acceleration_unit(raw.unit) != acceleration_unit(effective_unit):
            raise InputError(
                f'unit "{unit}" was given, but the file states "{raw.unit}"; '
                "correct the file if it is wrong"
            )
        motion = checked_motion(
            raw.values,
            effective_unit,
            raw.dt,
            dt,
            trusted=trust_unit,
            instrument=raw.instrument,
            description=raw.description,
            component=raw.component,
        )
    except InputError as error:
        raise error.located(path) from None
    return replace(motion, name=name or printable(_name(path)), target=raw.target)


def _name(path: Path) -> str:
    """Return the name of a file without its ending; of a result directory that of the folder."""
    # Every result of `motions make` has a file of the same name.
    folder = path.absolute().parent
    is_result = path.name == MOTION and is_file(folder / SUMMARY)
    return folder.name if is_result and folder.name else path.stem


def _text(path: Path) -> str:
    """Return the text of a file; of a workbook the first sheet that holds anything."""
    if path.suffix.lower() not in WORKBOOKS:
        return read_text(path)
    rows = next((sheet.rows for sheet in read_sheets(path) if sheet.rows), [])
    return "\n".join("\t".join(cells) for _, cells in rows)


def _read(text: str, component: str | None) -> _Raw:
    """Read by the format that the first line, or a line of the header, shows."""
    lines = [line.rstrip() for line in text.splitlines()]
    first = next((line.strip().lower() for line in lines if line.strip()), "")
    if not first:
        raise InputError("is empty")
    if len(lines) > MOST_SAMPLES + HEAD:  # before a minute of reading
        refuse_many(len(lines) - lines.count(""), "lines")
    if first.startswith("origin time"):
        return _read_knet(lines, component)
    if first.startswith("site code"):
        return _read_jma(lines, component)
    for place, line in enumerate(lines[:30]):  # a header of AT2: number of points, time step [s]
        text = line[:LONGEST_LINE]
        if match := _AT2_NAMED.search(text) or _AT2_FIRST.search(text):
            return _read_at2(lines, component, place, int(match[1]), _number(match[2]))
    return _read_columns(lines, component)


def _number(cell: str) -> float:
    """Return a finite float; NaN, blanks and words are refused."""
    text = cell.strip()
    if not text:
        raise InputError("a number is missing (a gap in the record)")
    return read_number(text)


def _rows(rows: Iterable[Row], width: int, separator: str = ",") -> list[list[float]]:
    """Rows of numbers; InputError, with the line, for another length or a cell that is none."""
    numbers = []
    for line, cells in rows:
        try:
            if len(cells) != width:
                text = shortened(separator.join(cells).strip())
                raise InputError(
                    f'"{text}" has {len(cells)} columns instead of {width} (a gap in the record?)'
                )
            numbers.append([_number(cell) for cell in cells])
        except InputError as error:
            raise InputError(error.lines(f"line {line}")) from None
    return numbers


def _running_numbers(lines: Iterable[tuple[int, str]]) -> Floats:
    """Return the numbers of lines of any length; columns may touch each other."""
    numbers: list[float] = []
    for line, text in lines:
        words = NUMBER.sub(" ", text).replace(",", " ").split()
        if words:
            fault = "is not a finite number" if is_not_finite(words[0]) else "is not a number"
            raise InputError(f'line {line}: "{shortened(words[0])}" {fault}')
        items = NUMBER.findall(text)
        if len(numbers) > MOST_SAMPLES:
            refuse_many(len(numbers), f"samples up to line {line}")
        numbers += [value for row in _rows([(line, items)], len(items)) for value in row]
    return np.array(numbers)


def _entry(text: str) -> float | None:
    """Return the number that an entry of a header begins with, if it does."""
    match = NUMBER.match(text)
    return _number(match[0]) if match else None


def _only_component(component: str | None, contents: str = "one component") -> None:
    if component not in (None, "1"):
        raise InputError(f'has {contents}, and no component "{component}"')


def _read_at2(lines: list[str], component: str | None, place: int, points: int, dt: float) -> _Raw:
    """PEER AT2: free lines, then number of points and time step, then numbers in rows."""
    _only_component(component)
    header = " ".join(lines[:place])
    if re.search(r"\b(VELOCITY|DISPLACEMENT)\b", header, re.IGNORECASE):
        raise InputError("contains a velocity or a displacement, not an acceleration")
    values = _running_numbers(
        (line, text)
        for line, text in enumerate(lines[place + 1 :], place + 2)
        if text.strip() and not text.lstrip().startswith(("*", "#", "%"))
    )
    if len(values) != points:
        difference = "fewer: a gap, or the file is cut off" if len(values) < points else "more"
        raise InputError(
            f"states NPTS = {points}, but contains {len(values)} numbers ({difference})"
        )
    unit = _AT2_UNIT.search(header)
    description = "; ".join(line.strip() for line in lines[:place][:2] if line.strip())
    return _Raw(values, dt, unit[1] if unit else None, description=description)


def _read_knet(lines: list[str], component: str | None) -> _Raw:
    """K-NET and KiK-net ASCII: counts of the instrument, scaled to gal, mean taken out.

    The counts have an offset; the network's own "Max. Acc." is that of the counts less their
    mean, and is compared with what was read.
    """
    place = next((k for k, line in enumerate(lines) if line.lower().startswith("memo")), None)
    if place is None:
        raise InputError('is a K-NET file without the line "Memo." that ends its header')
    entries = {
        re.sub(r"[^a-z]", "", line[:KNET_TITLE].lower()): line[KNET_TITLE:].strip()
        for line in lines[: place + 1]
    }
    direction = entries.get("dir", "")
    component_name = KNET_COMPONENTS.get(direction, direction.replace("-", ""))
    if component is None or find_title([component_name], component) is None:
        _only_component(component, f"the component {component_name}")
    frequency = _entry(entries.get("samplingfreqhz", ""))
    if frequency is None or frequency <= 0.0:
        raise InputError('has no usable "Sampling Freq(Hz)"')
    scale_match = _SCALE.match(entries.get("scalefactor", ""))
    gal, divisor = 0.0, 0.0
    if scale_match is not None:
        gal, divisor = _number(scale_match[1]), _number(scale_match[2])
    # Without a factor, with a divisor of zero, or with one whose quotient is not a finite number.
    if abs(divisor) <= abs(gal) / HUGEST:
        raise InputError('has no usable "Scale Factor", such as 3920(gal)/6170801')
    body = enumerate(lines[place + 1 :], place + 2)
    counts = _running_numbers((line, text) for line, text in body if text.strip())
    dt = 1.0 / frequency
    length = _entry(entries.get("durationtimes", ""))
    points = len(counts) if length is None else round(length / dt)
    if len(counts) < points or not len(counts):
        raise InputError(
            f"states {points} samples ({points * dt:g} s), but contains {len(counts)}: a gap, or "
            "the file is cut off"
        )
    values = (counts - counts.mean()) * gal / divisor
    stated_peak = _entry(entries.get("maxaccgal", ""))
    largest = float(np.abs(values).max())
    if stated_peak is not None and abs(largest - stated_peak) > 0.01 * stated_peak + 0.01:
        raise InputError(
            f"states Max. Acc. {stated_peak:g} gal, but its largest value is {largest:.4g} gal: is "
            "the scale factor right?"
        )
    station, origin = entries.get("stationcode", ""), entries.get("origintime", "")
    description = f"{station} {component_name}, earthquake of {origin}"
    return _Raw(
        values, dt, "gal", instrument=True, description=description, component=component_name
    )


def _read_jma(lines: list[str], component: str | None) -> _Raw:
    """JMA CSV: a header of named entries, then NS, EW and UD in columns."""
    heads = [[cell.strip().upper() for cell in line.split(",")] for line in lines[:20]]
    place = next((k for k, cells in enumerate(heads) if set(JMA_COMPONENTS) <= set(cells)), None)
    if place is None:
        raise InputError('is a JMA file without the line "NS,EW,UD" above its columns')
    titles = heads[place]
    pairs = (line.partition("=") for line in lines[:place])
    entries = {key.strip().lower(): value.strip() for key, _, value in pairs}
    rate = _entry(entries.get("sampling rate", ""))
    if rate is None or rate <= 0.0:
        raise InputError('has no usable "SAMPLING RATE"')
    if component is None:
        raise InputError(f"has the components {', '.join(titles)}; give component")
    place_of_title = int(component) - 1 if component in ("1", "2", "3") else None
    if place_of_title is None:
        place_of_title = find_title(titles, component)
    if place_of_title is None:
        raise InputError(f'no component "{component}"{nearest(component.upper(), titles)}')
    component_name = titles[place_of_title]
    body = enumerate(lines[place + 1 :], place + 2)
    rows = _rows(((line, text.split(",")) for line, text in body if text.strip()), len(titles))
    unit = entries.get("unit", "").split("(")[0].strip() or None
    site = lines[0].partition("=")[2].split(",")[0].strip()
    description = f"JMA {site} {component_name}, from {entries.get('initial time', '')}"
    series = np.array([row[place_of_title] for row in rows])
    return _Raw(series, 1.0 / rate, unit, unit is not None, description, component_name)


def _read_columns(lines: list[str], component: str | None) -> _Raw:
    """Return columns of numbers below a free header."""
    table, numbers = _even_columns(lines) or _uneven_columns(lines)
    start, width = numbers[0], table.shape[1]
    target = None
    header = []
    for line in lines[: start - 1]:
        comment = line.lstrip(_MARKS)
        if comment.startswith(TARGET) and comment != line:
            from thermobearing.motions.targets import read_target  # few files need scipy

            target = read_target(comment.removeprefix(TARGET))
        elif line.strip():
            header.append(line[:LONGEST_LINE])
    time, components = _sorted_columns(header, table, width)
    dt = None
    if time is None:
        step_match = _STEP.search(" ".join(header))  # such as "dt=0.005 sec"
        if step_match:
            dt = _number(step_match[1]) * (1e-3 if (step_match[2] or "").lower() == "ms" else 1.0)
    elif len(table) > 1:
        scale, _ = conversion(plain_unit(time.unit or "s"), "s")
        dt = even_step(table[:, time.number] * scale, numbers)
    column = _select_component(components, component)
    unit = column.unit or _unit_in_header(header)
    description = " ".join(line.strip().lstrip(_MARKS) for line in header if len(line.split()) > 3)
    name = column.name if len(components) > 1 else ""
    description = description[:LONGEST_DESCRIPTION]
    values = table[:, column.number]
    return _Raw(values, dt, unit, description=description, component=name, target=target)


def _filled_rows(sheet: Sheet) -> list[Row]:
    """Return rows of plain cells; InputError without any row of numbers, the first of the list."""
    # Empty columns are omitted: two tabs between numbers are one separator.
    filled_columns = sorted(
        {c for _, cells in sheet.rows for c, cell in enumerate(cells) if cell.strip()}
    )
    rows = [
        (line, [sheet.plain(cells[c]) for c in filled_columns if c < len(cells)])
        for line, cells in sheet.rows
    ]
    first = next((k for k, (_, cells) in enumerate(rows) if _is_row(cells)), None)
    if first is None:
        raise InputError("contains no numbers; is it an accelerogram?")
    return rows[first:]


def _even_columns(lines: list[str]) -> tuple[Floats, Sequence[int]] | None:
    """Return what `_uneven_columns` does, of a long file whose rows are all alike; otherwise None.

    Ten times as fast.
    """
    if len(lines) <= HEAD:
        return None
    try:
        sheet = sheet_of_text("\n".join(lines[:HEAD]), quotes=False)
        rows = _filled_rows(sheet)
    except InputError:  # which the complete file may not deserve
        return None
    start, cells = rows[0]
    if len(rows) < SEPARATOR_ROWS:
        return None
    end = len(lines)
    while not lines[end - 1]:
        end -= 1
    table = even_table(lines[start - 1 : end], sheet)
    if table is None or table.shape[1] != len(cells):
        return None
    return table, range(start, end + 1)


def _uneven_columns(lines: list[str]) -> tuple[Floats, Sequence[int]]:
    """Return the table of numbers, and the line in which each of its rows is."""
    sheet = sheet_of_text("\n".join(lines), quotes=False)
    rows = _filled_rows(sheet)
    table = np.array(_rows(rows, len(rows[0][1]), sheet.separator))
    return table, [line for line, _ in rows]


def _is_row(cells: list[str]) -> bool:
    """Return whether all cells are numbers, or should be."""
    fits = [NUMBER.fullmatch(cell) or not cell or is_not_finite(cell) for cell in cells]
    return all(fits) and any(cells)


def _unit_in_header(header: list[str]) -> str | None:
    """Return a unit of acceleration in the free header, such as "Acc. in cm/sec^2"."""
    units = {next(part for part in match if part) for match in _UNIT.findall(" ".join(header))}
    sizes = {acceleration_unit(text) for text in units}
    if len(sizes) > 1:
        raise InputError(f"the header names several units: {', '.join(sorted(units))}; give unit")
    return min(units, default=None)


def _titles(header: list[str], width: int) -> list[str] | None:
    """Names of the columns from the last line of the header, or from one above a row of units."""
    candidates = [_cells(line, width) for line in header[-2:]]
    last = candidates[-1] if candidates else None
    above = candidates[0] if len(candidates) > 1 else None
    if last is None or above is None or not all(map(_is_unit, last)):
        return last
    return [f"{name} [{unit}]" for name, unit in zip(above, last, strict=True)]


def _is_unit(text: str) -> bool:
    """Return whether a header cell is a unit of time or acceleration."""
    bare = text.strip("[]() ")
    return bool(_UNIT.fullmatch(bare)) or bare == "g" or plain_unit(bare) in ("s", "ms")


def _cells(line: str, width: int) -> list[str] | None:
    """Return the words of a line of the header, if there are as many as columns."""
    line = line.strip().lstrip(_MARKS).strip()
    for cells in (re.split(r"[;,\t]", line), re.split(r"\s{2,}", line), line.split()):
        titles = [cell.strip() for cell in cells if cell.strip()]
        if len(titles) == width and all(map(_TITLE.match, titles)):
            return [title.strip("[]()") if _is_unit(title) else title for title in titles]
    return None


def _sorted_columns(
    header: list[str], table: Floats, width: int
) -> tuple[_Column | None, list[_Column]]:
    """Return the column of time, if there is one, and those of acceleration."""
    titles = _titles(header, width)
    columns = [_Column(number, title, None) for number, title in enumerate(titles or [""] * width)]
    for number, title in enumerate(titles or []):
        name, unit = name_and_unit(title)
        if unit and _NAME.fullmatch(name):  # "dt = 0.01 s" is no title
            columns[number] = _Column(number, name, unit)
    time_column = next((column for column in columns if is_called(column.name, "time")), None)
    if time_column is not None:
        return time_column, [column for column in columns if column is not time_column]
    if titles:
        return None, columns
    # Without titles, a first column that increases throughout is time: no acceleration does.
    if width > 1 and len(table) > 2 and (np.diff(table[:, 0]) > 0.0).all():
        return columns[0], columns[1:]
    # Columns under a comment that states their directions in this order.
    directions = [
        direction.upper().replace("-", "") for direction in _DIRECTION.findall(" ".join(header))
    ]
    if len(directions) == width and len(set(directions)) == width:
        columns = [_Column(number, direction, None) for number, direction in enumerate(directions)]
    return None, columns


def _select_component(columns: list[_Column], component: str | None) -> _Column:
    """Return the wanted component; InputError if there are several and none was chosen."""
    if not columns:
        raise InputError("has a column of time, but none of acceleration")
    names = [column.name or str(place) for place, column in enumerate(columns, 1)]
    if component is None:
        if len(columns) > 1:
            raise InputError(f"has {len(columns)} components ({', '.join(names)}); give component")
        return columns[0]
    numbered = {str(place): column for place, column in enumerate(columns, 1)}
    if component in numbered:
        return numbered[component]
    place = find_title(names, component)
    if place is None:
        raise InputError(f'no component "{component}"{nearest(component, names)}')
    return columns[place]
