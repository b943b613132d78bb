"""A ground motion, measured and set beside a standard spectrum: what summary.json tells."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.border.deprecated import renamed
from thermobearing.core.types import Floats
from thermobearing.motions.jra import standard_spectrum
from thermobearing.motions.matching import LARGEST_MISFIT
from thermobearing.motions.measures import MotionMeasures
from thermobearing.motions.record import MM_S2_PER_GAL, GroundMotion
from thermobearing.motions.spectrum import ResponseSpectrum, response_spectrum

MM_PER_CM, MM_PER_M = 10.0, 1000.0
FIRST, LAST, COUNT = 0.05, 5.0, 200  # periods of spectrum.csv [s]
COMPLETED, POOR_FIT = "completed", "poor_fit"


@dataclass(frozen=True)
class Reference:
    """The standard spectrum that a motion is compared with.

    Attributes
    ----------
    kind, ground : "I" or "II"; "I", "II" or "III".
    zone_factor : c_z of the region.
    """

    kind: str
    ground: str
    zone_factor: float = 1.0

    def at(self, periods: Any) -> Floats:
        """Acceleration at natural periods [mm/s2]."""
        return standard_spectrum(self.kind, self.ground, periods, zone_factor=self.zone_factor)


@dataclass(frozen=True)
class MotionResult:
    """What is known about one ground motion.

    Attributes
    ----------
    command : that asked for it.
    motion : the ground motion itself.
    measures : how strong it is and how long it lasts.
    damping : of `spectrum`, a ratio of critical damping.
    reference : the standard spectrum to compare with; None if there is none.
    misfit : relative: root mean square of spectrum / reference - 1 over 0.1 to 3 s, 5 % damping.
    outcome : "completed", or "poor_fit" for a motion that was made and does not fit.
    """

    command: str
    motion: GroundMotion
    measures: MotionMeasures
    damping: float
    reference: Reference | None
    misfit: float | None
    outcome: str = COMPLETED

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try."""
        if self.outcome != POOR_FIT or self.misfit is None:
            return ""
        return (
            f"the search ended with a misfit of {100 * self.misfit:.2g} % rms, above "
            f"{100 * LARGEST_MISFIT:g} %; try another record or seed"
        )

    @cached_property
    def spectrum(self) -> ResponseSpectrum:
        """Response spectrum at 200 periods from 0.05 to 5 s."""
        return response_spectrum(self.motion, np.geomspace(FIRST, LAST, COUNT), self.damping)

    def summary(self) -> dict[str, Any]:
        """Content of summary.json."""
        motion, measures, reference = self.motion, self.measures, self.reference
        standard = None
        if reference is not None:
            standard = {
                "type": reference.kind,
                "ground": reference.ground,
                "zone_factor": reference.zone_factor,
                "misfit_rms": self.misfit,
            }
        return {
            "command": self.command,
            "motion": motion.name,
            "description": motion.description,
            "citation": motion.citation,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "dt_s": motion.dt,
            "samples": len(motion.acceleration),
            "duration_s": motion.duration,
            "pga_gal": measures.pga / MM_S2_PER_GAL,
            "pgv_cm_s": measures.pgv / MM_PER_CM,
            "pgd_cm": measures.pgd / MM_PER_CM,
            "end_velocity_cm_s": measures.end_velocity / MM_PER_CM,
            "end_displacement_cm": measures.end_displacement / MM_PER_CM,
            "arias_intensity_m_s": measures.arias_intensity / MM_PER_M,
            "significant_duration_s": measures.significant_duration,
            "bracketed_duration_s": measures.bracketed_duration,
            "cumulative_absolute_velocity_m_s": measures.cumulative_absolute_velocity / MM_PER_M,
            "damping": self.damping,
            "standard_spectrum": standard,
        }

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write summary.json, motion.csv, spectrum.csv and figures.

        Parameters
        ----------
        directory : to be made; see `force`.
        overwrite : replace an earlier result directory.
        figures : draw them.

        Raises
        ------
        OutputError : the directory exists, or cannot be written; nothing is left.
        """
        from thermobearing.motions.output import save_motion

        return save_motion(self, Path(directory), overwrite=overwrite, figures=figures)
