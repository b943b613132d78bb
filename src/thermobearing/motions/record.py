"""Ground accelerations, evenly sampled, with checks of time step, unit and amplitude."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.units import HUGEST, is_number, number_list, split_quantity
from thermobearing.core.types import Floats

if TYPE_CHECKING:
    from thermobearing.motions.targets import DesignSpectrum

MM_S2_PER_GAL = 10.0
MOST_SAMPLES = 2_000_000  # of a motion, read, resampled or padded: an hour at 500 Hz
STANDARD_GRAVITY = 9806.65  # [mm/s2], ISO 80000-3
# Units of acceleration as records spell them, in lower case without blanks and "^".
ACCELERATION_UNITS = {
    "g": STANDARD_GRAVITY,
    "gal": MM_S2_PER_GAL,
    "cm/s2": MM_S2_PER_GAL,
    "cm/s/s": MM_S2_PER_GAL,
    "cm/sec2": MM_S2_PER_GAL,
    "cm/sec/sec": MM_S2_PER_GAL,
    "m/s2": 1000.0,
    "m/s/s": 1000.0,
    "m/sec2": 1000.0,
    "m/sec/sec": 1000.0,
    "mm/s2": 1.0,
    "mm/s/s": 1.0,
}
# A record is used to shake structures. In files whose unit is only a word (or an argument),
# a largest acceleration outside 100 to 2000 gal is refused: the window spans a factor of 20, so
# that a unit wrong by 100 or 981 never passes, nor one wrong by 9.81 if 204 to 981 gal are meant.
# In instruments' own formats the unit belongs to the format and weak records are common.
ASSERTED = (100.0, 2000.0)
INSTRUMENT = (10.0, 5000.0)
SMALLEST = 1e-9  # smallest peak of a motion, also with trust_unit [gal]
SHORTEST = 2  # samples
LARGEST_DT, SMALLEST_DT = 0.1, 1e-5  # plausible time steps of an accelerogram [s]
OFF_GRID = 0.1  # of a time step: how far a printed time may be from an even grid
# Words of the descriptions of generated motions, by which files without a target tell them.
SYNTHETIC, ADJUSTED = "synthetic, fits", "with Fourier amplitudes adjusted to"


@checked
@dataclass(frozen=True)
class GroundMotion:
    """Acceleration of the ground.

    Attributes
    ----------
    name : for tables and file names.
    dt : time between samples [s], > 0; the first sample is at time zero.
    acceleration : [n] ground acceleration [mm/s2]; 10 mm/s2 = 1 gal.
    description, citation : content and origin.
    component : direction, such as "NS", if that is known; distinguishes motions of one name.
    target : spectrum that a generated motion was made to fit; None for others.

    Raises
    ------
    InputError : not a list of finite numbers, or an implausible time step.

    Examples
    --------
    >>> import numpy as np
    >>> motion = GroundMotion("two samples", 0.01, np.array([0.0, 100.0]))
    >>> motion.duration, motion.pga
    (0.01, 100.0)
    """

    name: str
    dt: float
    acceleration: Floats
    description: str = ""
    citation: str = ""
    component: str = ""
    target: "DesignSpectrum | None" = None

    def __post_init__(self) -> None:
        where = f'GroundMotion "{self.name}"'
        try:
            values = number_list(self.acceleration, "acceleration [mm/s2]")
        except InputError as error:
            raise InputError(error.problems, where) from None
        if not is_number(self.dt) or not 0.0 < self.dt < HUGEST:
            raise InputError(f"dt = {self.dt!r}: must be a number of seconds > 0", where)
        if len(values) > MOST_SAMPLES:
            raise InputError(f"{len(values)} samples; at most {MOST_SAMPLES} can be used", where)
        object.__setattr__(self, "acceleration", values)

    @property
    def time(self) -> Floats:
        """Times of the samples [s]."""
        return np.arange(len(self.acceleration), dtype=np.float64) * self.dt

    @property
    def is_generated(self) -> bool:
        """Whether it was made or adjusted to fit a spectrum, as its target or description says."""
        words = self.description.lower()
        return self.target is not None or any(
            phrase.lower() in words for phrase in (SYNTHETIC, ADJUSTED)
        )

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return self.dt * (len(self.acceleration) - 1)

    def __repr__(self) -> str:
        name = f"{self.name} {self.component}".strip()
        size = f"{self.pga / MM_S2_PER_GAL:.0f} gal, {self.duration:g} s in steps of {self.dt:g} s"
        return f"<GroundMotion {name}: {size}>"

    @property
    def pga(self) -> float:
        """Largest absolute acceleration [mm/s2]."""
        return float(np.abs(self.acceleration).max())

    @property
    def velocity(self) -> Floats:
        """Ground velocity [mm/s], from rest; exact for an acceleration linear between samples."""
        return _integrate_velocity(self.acceleration, self.dt)

    @property
    def displacement(self) -> Floats:
        """Ground displacement [mm], from rest; exact for an acceleration linear between samples."""
        return integrate_displacement(self.acceleration, self.dt)


def _integrate_velocity(acceleration: Floats, dt: float) -> Floats:
    """Integral from rest of an acceleration that is linear between its samples."""
    steps = 0.5 * dt * (acceleration[1:] + acceleration[:-1])
    return np.concatenate([[0.0], np.cumsum(steps)])


def integrate_displacement(acceleration: Floats, dt: float) -> Floats:
    """Second integral from rest of an acceleration that is linear between its samples."""
    velocity = _integrate_velocity(acceleration, dt)
    steps = velocity[:-1] * dt + dt * dt * (2.0 * acceleration[:-1] + acceleration[1:]) / 6.0
    return np.concatenate([[0.0], np.cumsum(steps)])


def acceleration_unit(text: str) -> float:
    """Return the size of a unit of acceleration [mm/s2]; InputError for an unknown one.

    >>> acceleration_unit("gal"), acceleration_unit("cm/sec^2")
    (10.0, 10.0)
    """
    normalised = text.strip().lower().replace(" ", "").replace("^", "").replace("**", "")
    normalised = normalised.replace("²", "2")
    if normalised not in ACCELERATION_UNITS:
        hint = nearest(normalised, ["g", "gal", "cm/s2", "m/s2", "mm/s2"])
        raise InputError(f'unknown unit of acceleration "{text}"{hint}')
    return ACCELERATION_UNITS[normalised]


def parse_acceleration(text: str) -> float:
    """Return the acceleration of a text such as "0.4 g" [mm/s2].

    >>> parse_acceleration("0.5 g"), parse_acceleration("2 m/s2")
    (4903.325, 2000.0)
    """
    number, unit = split_quantity(text) or ("", "")
    if not unit or not math.isfinite(float(number)):
        raise InputError(f'"{shortened(text)}": give a number with its unit, such as "2 m/s2"')
    return float(number) * acceleration_unit(unit)


def even_step(time: Floats, lines: Sequence[int], row_name: str = "line") -> float:
    """Return the time step of evenly spaced times [s]; a gap or an uneven step is an error.

    `lines` numbers the times, as lines of a file or samples of an array (`row_name`).
    """
    steps = np.diff(time)
    if (steps <= 0.0).any():
        k = int(np.argmax(steps <= 0.0))
        raise InputError(
            f"{row_name} {lines[k + 1]}: time does not increase, from {time[k]:g} s to "
            f"{time[k + 1]:g} s"
        )
    median_step = float(np.median(steps))
    # A missing sample doubles its step; rounding of printed times (OFF_GRID) changes it by less.
    gap = int(steps.argmax())
    if steps[gap] > 1.5 * median_step:
        raise InputError(
            f"{row_name} {lines[gap + 1]}: a gap of {steps[gap]:g} s, from {time[gap]:g} s to "
            f"{time[gap + 1]:g} s; the time step is {median_step:g} s elsewhere"
        )
    dt = float(time[-1] - time[0]) / len(steps)
    offsets = np.abs(time - time[0] - dt * np.arange(len(time)))
    if offsets.max() > OFF_GRID * dt:
        k = int(np.argmax(np.abs(steps - median_step) > OFF_GRID * median_step))
        raise InputError(
            f"{row_name} {lines[k + 1]}: uneven time steps, {steps[k]:g} s here and "
            f"{median_step:g} s elsewhere; resample the record to even steps first"
        )
    return round(dt, 9)


def refuse_many(count: int, what: str = "samples") -> None:
    """Raise InputError if a motion has more than MOST_SAMPLES samples."""
    if count > MOST_SAMPLES:
        raise InputError(
            f"has {count} {what}; at most {MOST_SAMPLES} samples can be used: keep the strong part "
            "of the motion, or every second sample after a low-pass filter"
        )


def checked_motion(
    values: Floats,
    unit: str,
    stated_dt: float | None,
    requested_dt: float | None,
    *,
    trusted: bool,
    instrument: bool = False,
    name: str = "",
    description: str = "",
    component: str = "",
) -> GroundMotion:
    """Return a motion after checks of length, time step, unit and amplitude.

    `values` are in `unit`; `stated_dt` is the time step of the file or of the times,
    `requested_dt` that of the caller [s].
    """
    if len(values) < SHORTEST:
        raise InputError(f"has {len(values)} samples; at least {SHORTEST} are needed")
    refuse_many(len(values))
    if requested_dt is not None and not (np.isfinite(requested_dt) and requested_dt > 0.0):
        raise InputError(f"dt = {requested_dt:g} s: must be > 0")
    dt = requested_dt if stated_dt is None else stated_dt
    if dt is None:
        raise InputError("the file does not state the time step; give dt [s]")
    if (
        stated_dt is not None
        and requested_dt is not None
        and abs(stated_dt / requested_dt - 1.0) > 1e-3
    ):
        raise InputError(f"dt = {requested_dt:g} s was given, but the file has {stated_dt:g} s")
    if not SMALLEST_DT <= dt <= LARGEST_DT:
        raise InputError(
            f"a time step of {dt:g} s is outside {SMALLEST_DT:g} to {LARGEST_DT:g} s; "
            "is it in seconds?"
        )
    size = acceleration_unit(unit)
    motion = GroundMotion(name, dt, values * size, description, component=component)
    check_size(motion.pga, unit, instrument=instrument, trusted=trusted)
    return motion


def check_size(pga: float, unit: str, *, instrument: bool, trusted: bool) -> None:
    """Reject an implausible peak acceleration [mm/s2], which suggests a wrong unit."""
    gal, size = pga / MM_S2_PER_GAL, acceleration_unit(unit)
    if gal < SMALLEST:
        amount = "zero" if gal == 0.0 else f"less than {SMALLEST:g} gal"
        raise InputError(f"the acceleration is {amount} throughout")
    low, high = INSTRUMENT if instrument else ASSERTED
    if trusted or low <= gal <= high:
        return
    number = pga / size
    sizes = {name: ACCELERATION_UNITS[name] for name in ("g", "m/s2", "gal", "mm/s2")}
    unit_name = next(name for name, factor in sizes.items() if factor == size)
    plausible = [
        f"{number * factor / MM_S2_PER_GAL:.0f} gal if the numbers are in {name}"
        for name, factor in sizes.items()
        if factor != size and ASSERTED[0] <= number * factor / MM_S2_PER_GAL <= ASSERTED[1]
    ]
    guess = f"; it would be {' or '.join(plausible)}" if plausible else ""
    raise InputError(
        f"largest acceleration {number:.4g} {unit_name} = {gal:.4g} gal is outside "
        f"{low:g} to {high:g} gal: is the unit wrong{guess}? If the unit is right, confirm it with "
        "trust_unit"
    )


@checked
def motion_from_arrays(
    acceleration: Any,
    *,
    unit: str,
    dt: float | None = None,
    time: Any = None,
    name: str = "motion",
    component: str = "",
    trust_unit: bool = False,
) -> GroundMotion:
    """Return a ground motion from arrays, with the checks of a file.

    Parameters
    ----------
    acceleration : [n] of the ground, evenly sampled, n >= 2.
    unit : of the acceleration: "g", "gal", "m/s2", "cm/s2" or "mm/s2".
    dt : time step [s], in [1e-5, 0.1]; or
    time : [n] times of the samples [s], increasing in even steps.
    name : of the motion, for tables and figures.
    component : direction, such as "NS"; distinguishes motions of one name.
    trust_unit : take the motion even if its largest acceleration is outside 100 to 2000 gal.

    Raises
    ------
    InputError : another shape, numbers that are not finite, times that do not increase evenly, an
        unknown unit, an implausible size.

    Examples
    --------
    >>> time = 0.01 * np.arange(200)
    >>> motion_from_arrays(3.0 * np.sin(20.0 * time), unit="m/s2", time=time).dt
    0.01
    """
    try:
        values = number_list(acceleration, "acceleration")
        time_step = None
        if time is not None:
            times = number_list(time, "time [s]")
            if len(times) != len(values):
                raise InputError(f"{len(times)} times and {len(values)} accelerations")
            if len(times) >= SHORTEST:
                time_step = even_step(times, list(range(1, len(times) + 1)), "sample")
        if dt is not None and not is_number(dt):
            raise InputError(f"dt = {dt!r}: must be a number of seconds")
        if not isinstance(unit, str):
            raise InputError(f'unit = {unit!r}: must be text, such as "gal"')
        return checked_motion(
            values, unit, time_step, dt, trusted=trust_unit, name=str(name), component=component
        )
    except InputError as error:
        raise InputError(error.problems, f'motion "{name}"') from None
