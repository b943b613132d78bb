"""One horizontal ground acceleration, evenly sampled."""

from dataclasses import dataclass

import numpy as np

from thermobearing.core.types import Floats

MM_S2_PER_GAL = 10.0


@dataclass(frozen=True)
class GroundMotion:
    """A ground acceleration.

    Attributes
    ----------
    name : for tables and file names.
    dt : time between samples [s], > 0; the first sample is at time zero.
    acceleration : [n] ground acceleration [mm/s2]; 10 mm/s2 = 1 gal.
    description, citation : what it is and where it comes from.
    """

    name: str
    dt: float
    acceleration: Floats
    description: str = ""
    citation: str = ""

    @property
    def time(self) -> Floats:
        """Times of the samples [s]."""
        return np.arange(len(self.acceleration), dtype=np.float64) * self.dt

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return self.dt * (len(self.acceleration) - 1)

    @property
    def pga(self) -> float:
        """Largest absolute acceleration [mm/s2]."""
        return float(np.abs(self.acceleration).max())
