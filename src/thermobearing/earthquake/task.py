"""One run of a study as data: a device, a shaking, and where they start."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.core.types import Constants, Floats
from thermobearing.cyclic.protocol import LARGEST_STRAIN
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.model.stack import Stack
from thermobearing.motions.record import GroundMotion
from thermobearing.structure.run import Prepared


@dataclass(frozen=True)
class Device:
    """A bearing ready to be shaken; `stack` is None for a bilinear one, which has no heat."""

    bearing: Bearing | BilinearBearing
    constants: Constants
    stack: Stack | None

    @property
    def heats(self) -> bool:
        """Whether it has temperatures."""
        return self.stack is not None

    @property
    def has_lead(self) -> bool:
        """Whether it has lead cores with a temperature."""
        return self.heats and self.constants.lead.cores > 0.0

    @property
    def tears(self) -> float:
        """Strain beyond which nothing is left to be modelled; a design may begin far off."""
        return LARGEST_STRAIN if self.heats else 100.0


@dataclass(frozen=True)
class Shaking:
    """A ground motion at the ends of the steps: `ground` [mm/s2], `dt` [s]."""

    motion: GroundMotion
    dt: float
    ground: Floats


@dataclass(frozen=True)
class OneLine:
    """The bearings of one line in one run: what they are, how warm they are, in what air [degC]."""

    device: Device
    temperature: Floats
    lead: float | None
    ambient: float


@dataclass(frozen=True)
class Task:
    """One run of a study; a plain record, so that any executor can carry it away.

    `device` is that of the study, which lines may have another instead of.
    """

    prepared: Prepared
    device: Device
    shaking: Shaking
    ambient: float
    lines: tuple[OneLine, ...]
    case: EarthquakeCase
    mode: str = ""  # of the laboratory; none without one

    @cached_property
    def told_line(self) -> int:
        """Number of the line that histories and the table of peaks are about."""
        return self.case.told_line

    @cached_property
    def noise(self) -> Floats | None:
        """Error of the measured force in each step [kN]; None without one."""
        lab, steps = self.case.laboratory, len(self.shaking.ground) - 1
        if lab is None or lab.force_noise <= 0.0:
            return None
        return lab.force_noise * np.random.default_rng(lab.seed).standard_normal(steps)

    @property
    def told(self) -> OneLine:
        """That line."""
        return self.lines[self.told_line]
