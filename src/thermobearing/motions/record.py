"""One horizontal ground acceleration, evenly sampled."""

from dataclasses import dataclass

import numpy as np

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.units import HUGEST, is_number, number_list
from thermobearing.core.types import Floats

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


@dataclass(frozen=True)
class GroundMotion:
    """A ground acceleration.

    Attributes
    ----------
    name : for tables and file names.
    dt : time between samples [s], > 0; the first sample is at time zero.
    acceleration : [n] ground acceleration [mm/s2]; 10 mm/s2 = 1 gal.
    description, citation : what it is and where it comes from.
    component : direction, such as "NS", if that is known; tells motions of one name apart.

    Raises
    ------
    InputError : no row of finite numbers, or no plausible time step.

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
        return integrate_velocity(self.acceleration, self.dt)

    @property
    def displacement(self) -> Floats:
        """Ground displacement [mm], from rest; exact for an acceleration linear between samples."""
        return integrate_displacement(self.acceleration, self.dt)


def integrate_velocity(acceleration: Floats, dt: float) -> Floats:
    """Integral from rest of an acceleration that is linear between its samples."""
    steps = 0.5 * dt * (acceleration[1:] + acceleration[:-1])
    return np.concatenate([[0.0], np.cumsum(steps)])


def integrate_displacement(acceleration: Floats, dt: float) -> Floats:
    """Second integral from rest of an acceleration that is linear between its samples."""
    velocity = integrate_velocity(acceleration, dt)
    steps = velocity[:-1] * dt + dt * dt * (2.0 * acceleration[:-1] + acceleration[1:]) / 6.0
    return np.concatenate([[0.0], np.cumsum(steps)])


def acceleration_unit(text: str) -> float:
    """Size of a unit of acceleration [mm/s2]; InputError for an unknown one.

    Examples
    --------
    >>> acceleration_unit("gal"), acceleration_unit("cm/sec^2")
    (10.0, 10.0)
    """
    plain = text.strip().lower().replace(" ", "").replace("^", "").replace("**", "")
    plain = plain.replace("²", "2")
    if plain not in ACCELERATION_UNITS:
        hint = nearest(plain, ["g", "gal", "cm/s2", "m/s2", "mm/s2"])
        raise InputError(f'unknown unit of acceleration "{text}"{hint}')
    return ACCELERATION_UNITS[plain]
