"""What the readers share: text into numbers, checks of unit, size and time steps."""

import re
from dataclasses import dataclass

import numpy as np

from thermobearing.border.errors import InputError, shortened
from thermobearing.border.layout import number_of
from thermobearing.border.sheets import NOT_FINITE
from thermobearing.core.types import Floats
from thermobearing.motions.record import ACCELERATION_UNITS, MM_S2_PER_GAL

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


def is_not_finite(text: str) -> bool:
    """Whether a cell holds NaN or infinity."""
    return text.strip().lstrip("+-").lower() in NOT_FINITE


def running_numbers(lines: list[tuple[int, str]]) -> Floats:
    """Numbers of lines with any count of them, columns touching each other allowed."""
    found: list[float] = []
    for line, text in lines:
        left = NUMBER.sub(" ", text).replace(",", " ").split()
        if left:
            what = "is not a finite number" if is_not_finite(left[0]) else "is not a number"
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
