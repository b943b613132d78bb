"""Read accelerograms: formats, columns, units and time steps.

PEER AT2, K-NET and KiK-net ASCII, JMA CSV, and columns of numbers (CSV or text). The unit must
be told, by the file or by the caller, and the size of the motion must make sense with it.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from thermobearing.border.errors import InputError, nearest, printable, shortened
from thermobearing.border.units import HUGEST, conversion
from thermobearing.core.types import Floats
from thermobearing.motions.record import (
    ACCELERATION_UNITS,
    MM_S2_PER_GAL,
    MOST_SAMPLES,
    GroundMotion,
    acceleration_unit,
)
from thermobearing.tables.columns import is_called, name_and_unit, number_of, plain_unit
from thermobearing.tables.text import (
    COMMENTS,
    NOT_FINITE,
    Sheet,
    read_sheets,
    read_text,
    sheet_of_text,
)

# A record is used to shake structures. In files whose unit is only a word (or an argument),
# a largest acceleration outside 100 to 2000 gal is refused: the window spans a factor of 20, so
# that a unit wrong by 100 or 981 never passes, nor one wrong by 9.81 if 204 to 981 gal are meant.
# In instruments' own formats the unit belongs to the format and weak records are common.
ASSERTED = (100.0, 2000.0)
INSTRUMENT = (10.0, 5000.0)
NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[EeDd][-+]?\d+)?")
SHORTEST = 2  # samples
SMALLEST = 1e-9  # largest acceleration that is no motion at all, whoever trusts it [gal]
LONGEST_LINE = 500  # characters of a line of a header that are looked at
LARGEST_DT, SMALLEST_DT = 0.1, 1e-5  # plausible time steps of an accelerogram [s]
OFF_GRID = 0.1  # of a time step: how far a printed time may be from an even grid


@dataclass(frozen=True)
class Options:
    """What the caller said about a file beside its path."""

    unit: str | None
    dt: float | None
    component: str | int | None
    trust_unit: bool


@dataclass(frozen=True)
class Raw:
    """What a reader found: numbers in a unit, and how much the unit can be trusted.

    Attributes
    ----------
    values : [n] acceleration in `unit`.
    dt : time step [s].
    unit : as the file spells it, None if it does not say.
    instrument : whether the unit belongs to the format.
    description : of the record, from its header.
    component : its direction, if the file or the caller tells.
    """

    values: Floats
    dt: float | None
    unit: str | None
    instrument: bool = False
    description: str = ""
    component: str = ""


def number(cell: str) -> float:
    """A finite float; NaN, blanks and words are refused."""
    text = cell.strip()
    if not text:
        raise InputError("a number is missing (a gap in the record)")
    return number_of(text)


def _is_not_finite(text: str) -> bool:
    """Whether a cell holds NaN or infinity."""
    return text.strip().lstrip("+-").lower() in NOT_FINITE


def _running_numbers(lines: list[tuple[int, str]]) -> Floats:
    """Numbers of lines with any count of them, columns touching each other allowed."""
    found: list[float] = []
    for line, text in lines:
        left = NUMBER.sub(" ", text).replace(",", " ").split()
        if left:
            what = "is not a finite number" if _is_not_finite(left[0]) else "is not a number"
            raise InputError(f'line {line}: "{shortened(left[0])}" {what}')
        for item in NUMBER.findall(text):
            try:
                found.append(number(item))
            except InputError as error:
                raise InputError(error.lines(f"line {line}")) from None
    return np.array(found)


def even_step(time: Floats, lines: list[int], what: str = "line") -> float:
    """The time step of evenly spaced times [s]; gaps and uneven steps are told with their line.

    `lines` numbers them; `what` the numbers count, lines of a file or samples of an array.
    """
    steps = np.diff(time)
    if (steps <= 0.0).any():
        k = int(np.argmax(steps <= 0.0))
        raise InputError(
            f"{what} {lines[k + 1]}: time does not increase, from {time[k]:g} s to "
            f"{time[k + 1]:g} s"
        )
    usual = float(np.median(steps))
    gap = int(steps.argmax())
    if steps[gap] > 1.5 * usual:
        raise InputError(
            f"{what} {lines[gap + 1]}: a gap of {steps[gap]:g} s, from {time[gap]:g} s to "
            f"{time[gap + 1]:g} s; the time step is {usual:g} s elsewhere"
        )
    dt = float(time[-1] - time[0]) / len(steps)
    off = np.abs(time - time[0] - dt * np.arange(len(time)))
    if off.max() > OFF_GRID * dt:
        k = int(np.argmax(np.abs(steps - usual) > OFF_GRID * usual))
        raise InputError(
            f"{what} {lines[k + 1]}: uneven time steps, {steps[k]:g} s here and {usual:g} s "
            "elsewhere; resample the record to even steps first"
        )
    return round(dt, 9)


def checked_step(found: float | None, given: float | None) -> float:
    """The time step of the file or of the caller, plausible, and the same if both tell it."""
    if given is not None and not (np.isfinite(given) and given > 0.0):
        raise InputError(f"dt = {given:g} s: must be > 0")
    if found is None and given is None:
        raise InputError("the time step is nowhere in the file; give dt [s]")
    if found is not None and given is not None and abs(found / given - 1.0) > 1e-3:
        raise InputError(f"dt = {given:g} s was given, but the file says {found:g} s")
    dt = found if found is not None else given
    assert dt is not None
    if not SMALLEST_DT <= dt <= LARGEST_DT:
        raise InputError(
            f"a time step of {dt:g} s is outside {SMALLEST_DT:g} to {LARGEST_DT:g} s; "
            "is it in seconds?"
        )
    return dt


def check_size(pga: float, unit: str, *, instrument: bool, trusted: bool) -> None:
    """Refuse a largest acceleration [mm/s2] that a wrong unit explains better."""
    gal = pga / MM_S2_PER_GAL
    if gal < SMALLEST:
        about = "zero" if gal == 0.0 else f"less than {SMALLEST:g} gal"
        raise InputError(f"the acceleration is {about} throughout")
    low, high = INSTRUMENT if instrument else ASSERTED
    if trusted or low <= gal <= high:
        return
    number_in_file = pga / ACCELERATION_UNITS[unit]
    plausible = [
        f"{number_in_file * size / MM_S2_PER_GAL:.0f} gal if the numbers are in {other}"
        for other, size in (
            ("g", ACCELERATION_UNITS["g"]),
            ("m/s2", 1e3),
            ("gal", 10.0),
            ("mm/s2", 1.0),
        )
        if other != unit
        and size != ACCELERATION_UNITS[unit]
        and ASSERTED[0] <= number_in_file * size / MM_S2_PER_GAL <= ASSERTED[1]
    ]
    guess = f"; it would be {' or '.join(plausible)}" if plausible else ""
    raise InputError(
        f"largest acceleration {number_in_file:.4g} {unit} = {gal:.4g} gal is outside "
        f"{low:g} to {high:g} gal: is the unit wrong{guess}? If the unit is right, say so with "
        "trust_unit"
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
    fits = [NUMBER.fullmatch(cell) or not cell or _is_not_finite(cell) for cell in cells]
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
    return sheet._replace(rows=rows)


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


def _read_columns_of_text(lines: list[str], options: Options) -> Raw:
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


WORKBOOKS = (".xlsx", ".xlsm")
_NUM = NUMBER.pattern
_AT2_NAMED = re.compile(rf"NPTS\s*=\s*(\d{{1,9}})\s*,?\s*DT\s*=\s*({_NUM})", re.IGNORECASE)
_AT2_FIRST = re.compile(rf"^\s*(\d{{1,9}})\s*,?\s*({_NUM})\s+NPTS\s*,\s*DT", re.IGNORECASE)
_AT2_UNIT = re.compile(
    r"UNITS?\s+(?:OF|ARE|IN|:|=)\s*\(?\s*([A-Za-z][A-Za-z0-9/^]*)", re.IGNORECASE
)
_SCALE = re.compile(rf"({_NUM})\s*\(gal\)\s*/\s*({_NUM})")
_JMA_COMPONENTS = ("NS", "EW", "UD")


def read_motion(
    path: str | Path,
    *,
    unit: str | None = None,
    dt: float | None = None,
    component: str | int | None = None,
    name: str | None = None,
    trust_unit: bool = False,
) -> GroundMotion:
    r"""A ground motion from a file, whose format is found by looking at it.

    Read are PEER AT2 (all headers with NPTS and DT), K-NET and KiK-net ASCII, JMA CSV, and plain
    columns, also of a workbook: time and acceleration, or accelerations alone.

    Parameters
    ----------
    path : the file.
    unit : of the acceleration ("g", "gal", "m/s2", "cm/s2", "mm/s2"), if the file does not tell.
    dt : time step [s], if the file does not tell.
    component : which one, by name ("NS") or by number from 1, if the file holds several.
    name : of the motion; that of the file by default.
    trust_unit : take the motion even if its size speaks against the unit. Without it, a
        largest acceleration outside 100 to 2000 gal (K-NET, KiK-net and JMA, where the unit
        belongs to the format: 10 to 5000 gal) is refused.

    Returns
    -------
    GroundMotion

    Raises
    ------
    InputError : no unit or time step, gaps, uneven steps, cells that are not finite numbers, no
        numbers, contradictions between file and arguments, an implausible size.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "a.csv")
    ...     _ = file.write_text("t_s,acc_gal\n0.00,0\n0.01,300\n0.02,-100\n")
    ...     read_motion(file).pga
    3000.0
    """
    path = Path(path)
    options = Options(unit, dt, component, trust_unit)
    try:
        motion = _finished(_read(_text(path), options), options)
    except InputError as error:
        raise error if error.where else InputError(error.problems, str(path)) from None
    return replace(motion, name=name or printable(path.stem))


def _text(path: Path) -> str:
    """The text of a file; of a workbook the first sheet that holds anything."""
    if path.suffix.lower() not in WORKBOOKS:
        return read_text(path)
    rows = next((sheet.rows for sheet in read_sheets(path) if sheet.rows), [])
    return "\n".join("\t".join(cells) for _, cells in rows)


def _read(text: str, options: Options) -> Raw:
    """Sniff: the first line or a line of the header says what a file is."""
    lines = [line.rstrip() for line in text.splitlines()]
    first = next((line.strip() for line in lines if line.strip()), "")
    if not first:
        raise InputError("is empty")
    readers: list[tuple[bool, Callable[[list[str], Options], Raw]]] = [
        (first.lower().startswith("origin time"), _read_knet),
        (first.lower().startswith("site code"), _read_jma),
        (_at2_header(lines) is not None, _read_at2),
    ]
    for fits, reader in readers:
        if fits:
            return reader(lines, options)
    return _read_columns_of_text(lines, options)


def _finished(raw: Raw, options: Options) -> GroundMotion:
    """Unit, time step and size checked; the motion in mm/s2."""
    if len(raw.values) < SHORTEST:
        raise InputError(f"holds {len(raw.values)} samples; at least {SHORTEST} are needed")
    if len(raw.values) > MOST_SAMPLES:
        raise InputError(f"holds {len(raw.values)} samples; at most {MOST_SAMPLES} can be used")
    dt = checked_step(raw.dt, options.dt)
    unit = options.unit or raw.unit
    if unit is None:
        raise InputError(
            "the unit of the acceleration is nowhere in the file; give unit: g, gal, m/s2, "
            "cm/s2 or mm/s2"
        )
    size = acceleration_unit(unit)
    if options.unit and raw.unit and acceleration_unit(raw.unit) != size:
        raise InputError(
            f'unit "{options.unit}" was given, but the file says "{raw.unit}"; '
            "correct the file if it is wrong"
        )
    plain = {9806.65: "g", 10.0: "gal", 1000.0: "m/s2", 1.0: "mm/s2"}[size]
    values = raw.values * size
    check_size(
        float(np.abs(values).max()), plain, instrument=raw.instrument, trusted=options.trust_unit
    )
    return GroundMotion("", dt, values, raw.description, component=raw.component)


def _only_component(options: Options, held: str = "one component") -> None:
    if options.component not in (None, 1, "1"):
        raise InputError(f'holds {held}; component "{options.component}" is not there')


def _at2_header(lines: list[str]) -> tuple[int, int, float] | None:
    """Line, number of points and time step [s] of an AT2 header, if there is one."""
    for place, line in enumerate(lines[:30]):
        text = line[:LONGEST_LINE]
        match = _AT2_NAMED.search(text) or _AT2_FIRST.search(text)
        if match:
            return place, int(match[1]), number(match[2])
    return None


def _read_at2(lines: list[str], options: Options) -> Raw:
    """PEER AT2: free lines, then number of points and time step, then numbers in rows."""
    found = _at2_header(lines)
    assert found is not None
    place, points, dt = found
    _only_component(options)
    header = " ".join(lines[:place])
    if re.search(r"\b(VELOCITY|DISPLACEMENT)\b", header, re.IGNORECASE):
        raise InputError("holds a velocity or a displacement, not an acceleration")
    body = [
        (line, text)
        for line, text in enumerate(lines[place + 1 :], place + 2)
        if text.strip() and not text.lstrip().startswith(("*", "#", "%"))
    ]
    values = _running_numbers(body)
    if len(values) != points:
        more = "fewer: a gap, or the file is cut off" if len(values) < points else "more"
        raise InputError(f"says NPTS = {points}, but holds {len(values)} numbers ({more})")
    unit = _AT2_UNIT.search(header)
    about = "; ".join(line.strip() for line in lines[:place][:2] if line.strip())
    return Raw(values, dt, unit[1] if unit else None, description=about)


def _entry(text: str) -> float | None:
    """The number that an entry of a header begins with, if it does."""
    found = NUMBER.match(text)
    return number(found[0]) if found else None


def _knet_scale(text: str) -> tuple[float, float]:
    """Numerator [gal] and denominator [counts] of a scale factor."""
    found = _SCALE.match(text)
    if found:
        above, below = number(found[1]), number(found[2])
        if abs(below) > abs(above) / HUGEST:
            return above, below
    raise InputError('has no usable "Scale Factor", such as 3920(gal)/6170801')


def _knet_header(lines: list[str]) -> tuple[int, dict[str, str]]:
    """Line number of "Memo." and the entries by the letters of their names."""
    entries = {}
    for place, line in enumerate(lines):
        entries[re.sub(r"[^a-z]", "", line[:18].lower())] = line[18:].strip()
        if line.lower().startswith("memo"):
            return place, entries
    raise InputError('is a K-NET file without the line "Memo." that ends its header')


def _read_knet(lines: list[str], options: Options) -> Raw:
    """K-NET and KiK-net ASCII: counts of the instrument, scaled to gal, mean taken out.

    The counts have an offset; the network's own "Max. Acc." is that of the counts less their
    mean, and is compared with what was read.
    """
    place, entries = _knet_header(lines)
    about = entries.get("dir", "")
    names = {"1": "NS", "2": "EW", "3": "UD", "4": "NS", "5": "EW", "6": "UD"}
    held = names.get(about, about.replace("-", ""))
    if str(options.component).upper().replace("-", "") != held.upper():
        _only_component(options, f"the component {held}")
    frequency = _entry(entries.get("samplingfreqhz", ""))
    if frequency is None or frequency <= 0.0:
        raise InputError('has no usable "Sampling Freq(Hz)"')
    scale = _knet_scale(entries.get("scalefactor", ""))
    body = list(enumerate(lines[place + 1 :], place + 2))
    counts = _running_numbers([(line, text) for line, text in body if text.strip()])
    dt = 1.0 / frequency
    length = _entry(entries.get("durationtimes", ""))
    points = len(counts) if length is None else round(length / dt)
    if len(counts) < points or not len(counts):
        raise InputError(
            f"says {points} samples ({points * dt:g} s), but holds {len(counts)}: a gap, or the "
            "file is cut off"
        )
    values = (counts - counts.mean()) * scale[0] / scale[1]
    told = _entry(entries.get("maxaccgal", ""))
    largest = float(np.abs(values).max())
    if told is not None and abs(largest - told) > 0.01 * told + 0.01:
        raise InputError(
            f"says Max. Acc. {told:g} gal, but its numbers come to {largest:.4g} gal: is the "
            "scale factor right?"
        )
    station = entries.get("stationcode", "")
    text = f"{station} {held}, earthquake of {entries.get('origintime', '')}"
    return Raw(values, dt, "gal", instrument=True, description=text, component=held)


def _read_jma(lines: list[str], options: Options) -> Raw:
    """JMA CSV: a header of named entries, then NS, EW and UD in columns."""
    head: dict[str, str] = {}
    place = None
    for at, line in enumerate(lines[:20]):
        titles = [cell.strip().upper() for cell in line.split(",")]
        if set(_JMA_COMPONENTS) <= set(titles):
            place = at
            break
        key, _, value = line.partition("=")
        head[key.strip().lower()] = value.strip()
    if place is None:
        raise InputError('is a JMA file without the line "NS,EW,UD" above its columns')
    rate = _entry(head.get("sampling rate", ""))
    if rate is None or rate <= 0.0:
        raise InputError('has no usable "SAMPLING RATE"')
    if options.component is None:
        raise InputError(f"holds the components {', '.join(titles)}; give component")
    wanted = str(options.component).strip().upper()
    wanted = titles[int(wanted) - 1] if wanted in ("1", "2", "3") else wanted
    if wanted not in titles:
        raise InputError(f'no component "{options.component}"{nearest(wanted, titles)}')
    column, values = titles.index(wanted), []
    for at, line in enumerate(lines[place + 1 :], place + 2):
        if not line.strip():
            continue
        cells = line.split(",")
        try:
            if len(cells) != len(titles):
                raise InputError(f"{len(cells)} numbers instead of {len(titles)} (a gap)")
            values.append([number(cell) for cell in cells][column])
        except InputError as error:
            raise InputError(error.lines(f"line {at}")) from None
    unit = head.get("unit", "").split("(")[0].strip() or None
    site = lines[0].partition("=")[2].split(",")[0].strip()
    start = head.get("initial time", "")
    about = f"JMA {site} {wanted}, from {start}"
    known = unit is not None
    series = np.array(values)
    return Raw(series, 1.0 / rate, unit, instrument=known, description=about, component=wanted)
