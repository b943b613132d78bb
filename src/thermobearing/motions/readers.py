"""Accelerograms from files: look what it is, then read it.

PEER AT2, K-NET and KiK-net ASCII, JMA CSV, and columns of numbers (CSV or text). The unit must
be told, by the file or by the caller, and the size of the motion must make sense with it.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from thermobearing.border.encodings import read_text
from thermobearing.border.errors import InputError, nearest, printable
from thermobearing.border.sheets import read_sheets
from thermobearing.border.units import HUGEST
from thermobearing.motions.columns import read_columns_of_text
from thermobearing.motions.record import MOST_SAMPLES, GroundMotion, acceleration_unit
from thermobearing.motions.sniffing import (
    LONGEST_LINE,
    NUMBER,
    SHORTEST,
    Options,
    Raw,
    check_size,
    checked_step,
    number,
    running_numbers,
)

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
    return read_columns_of_text(lines, options)


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
    values = running_numbers(body)
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
    counts = running_numbers([(line, text) for line, text in body if text.strip()])
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
