"""What the made motions of a study are made of: a spectrum, and random phases or a record."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import astuple, dataclass
from typing import Any

from thermobearing.border.errors import InputError
from thermobearing.motions.matching import misfit
from thermobearing.motions.process import resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import check_record, make_motion, match_spectrum
from thermobearing.motions.targets import DesignSpectrum, kind_of, list_spectra, load_spectrum
from thermobearing.studies.factors import MotionFactor

SEED, STEP = 1, 0.01  # where nothing is said; [s]
PHASES = "jra-ii-i"  # likewise, of a spectrum of one's own
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Recipe:
    """What one motion is made of: random phases of a seed, or those of a record.

    Attributes
    ----------
    name : of the motion.
    spectrum : that it shall fit.
    phases : type and ground of the shaking, of random phases.
    seed, dt : of random phases.
    record : whose phases are kept instead.
    """

    name: str
    spectrum: DesignSpectrum
    phases: tuple[str, str] = ("II", "I")
    seed: int = SEED
    dt: float = STEP
    record: GroundMotion | None = None

    @property
    def key(self) -> str:
        """Digest of all that goes into it, whatever it is called."""
        told: list[Any] = [astuple(self.spectrum.curve), self.spectrum.factor]
        raw = b""
        if self.record is None:
            told += [self.phases, self.seed, self.dt]
        else:
            told += [self.record.dt]
            raw = self.record.acceleration.astype("<f8").tobytes()
        return hashlib.sha256(json.dumps(told).encode() + raw).hexdigest()

    def make(self, progress: Progress | None = None) -> "Fitted":
        """Make it; takes seconds."""
        words: dict[str, Any] = {"spectrum": self.spectrum, "progress": progress}
        if self.record is None:
            motion = make_motion(*self.phases, self.seed, self.dt, **words)
        else:
            motion = match_spectrum(self.record, **words)
        return Fitted(motion, misfit(motion, self.spectrum.at))


@dataclass(frozen=True)
class Fitted:
    """A motion that was made, and the root mean square of how far it is from its spectrum."""

    motion: GroundMotion
    misfit: float


def recipes(factor: MotionFactor) -> list[Recipe]:
    """What the motions of a factor are made of.

    Parameters
    ----------
    factor : with `matched`.

    Raises
    ------
    InputError : no such spectrum, records that cannot be adjusted.
    """
    assert factor.matched is not None
    spectrum = load_spectrum(factor.matched, factor.zone_factor or 1.0)
    faults: list[str] = []
    if factor.levels is None:
        named = spectrum.name if spectrum.name in list_spectra() else PHASES
        phases, first = kind_of(factor.phases or named), factor.seed
        first = SEED if first is None else first
        return [
            Recipe(name, spectrum, phases, first + place, factor.dt or STEP)
            for place, name in enumerate(factor.names)
        ]
    found = []
    for name, level in zip(factor.names, factor.levels, strict=True):
        try:
            record = level.load()
            record = record if factor.dt is None else resampled(record, factor.dt)
            check_record(record)
            found.append(Recipe(name, spectrum, record=record))
        except InputError as error:
            faults += error.lines()
    if faults:
        raise InputError(faults)
    return found
