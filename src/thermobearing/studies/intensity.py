"""How strong a motion is, in the measure that a study counts by."""

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.spectrum import DAMPING, response_spectrum
from thermobearing.studies.distributions import MM_PER_M
from thermobearing.studies.factors import ScaleFactor

COLUMNS = {"PGA": "PGA_m_s2", "PGV": "PGV_m_s", "Sa": "Sa_m_s2"}


def intensity(motion: GroundMotion, scale: ScaleFactor) -> float:
    """The measure of a whole motion, before any scale [m/s2], PGV [m/s].

    Raises
    ------
    InputError : the motion is zero throughout.

    Examples
    --------
    >>> from thermobearing.motions.library import load_motion
    >>> round(intensity(load_motion("jra-ii-i-1"), ScaleFactor(levels=[1.0])), 2)
    6.47
    """
    if scale.measure == "PGA":
        found = motion.pga
    elif scale.measure == "PGV":
        found = float(np.abs(motion.velocity).max())
    else:
        period = np.array([scale.period])
        found = float(response_spectrum(motion, period, scale.damping or DAMPING).acceleration[0])
    if not found > 0.0:
        raise InputError(f'motion "{motion.name}" is zero throughout and has no {scale.measure}')
    return found / MM_PER_M
