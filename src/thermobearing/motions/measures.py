"""Intensity and duration measures of ground motions."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.motions.record import MM_S2_PER_GAL, STANDARD_GRAVITY, GroundMotion

BRACKET = 50.0 * MM_S2_PER_GAL  # 50 gal, about 0.05 g [mm/s2]


@dataclass(frozen=True)
class MotionMeasures:
    """Usual measures of a ground motion."""

    pga: float  # largest acceleration [mm/s2]
    pgv: float  # largest velocity [mm/s]
    pgd: float  # largest displacement [mm]
    end_velocity: float  # at the last sample [mm/s]
    end_displacement: float  # likewise [mm]
    arias_intensity: float  # pi / (2 g) times the integral of the squared acceleration [mm/s]
    significant_duration: float  # from 5 to 95 % of the Arias intensity [s]
    bracketed_duration: float  # from the first to the last time that 50 gal are exceeded [s]
    cumulative_absolute_velocity: float  # integral of the absolute acceleration [mm/s]


def _arias_growth(motion: GroundMotion) -> Floats:
    """Return the Arias intensity up to each sample [mm/s] by the trapezoidal rule (Arias, 1970)."""
    squares = motion.acceleration**2
    steps = 0.5 * motion.dt * (squares[1:] + squares[:-1])
    return np.concatenate([[0.0], np.cumsum(steps)]) * np.pi / (2.0 * STANDARD_GRAVITY)


def significant_interval(
    motion: GroundMotion, start: float = 0.05, end: float = 0.95
) -> tuple[float, float]:
    """Return the times at which the Arias intensity reaches two shares of its total [s].

    Their difference is the significant duration: Trifunac and Brady, Bulletin of the Seismological
    Society of America 65, 1975. Between samples the growth is taken as linear; shares are
    0 <= start < end <= 1.
    """
    if not 0.0 <= start < end <= 1.0:
        raise InputError(f"shares {start:g} and {end:g}: need 0 <= start < end <= 1")
    growth = _arias_growth(motion)
    if growth[-1] <= 0.0:
        raise InputError("is zero throughout and has no duration", motion.name)
    # Of several samples with the same intensity, the interval begins after the last and ends at the
    # first: zeros before and after the shaking do not lengthen it.
    sides: tuple[tuple[float, Any], ...] = ((start, "right"), (end, "left"))
    indices = [int(np.searchsorted(growth, share * growth[-1], side=side)) for share, side in sides]
    times = [
        (index - 1 + (share * growth[-1] - growth[index - 1]) / (growth[index] - growth[index - 1]))
        * motion.dt
        for index, share in zip(indices, (start, end), strict=True)
    ]
    return float(times[0]), float(times[1])


def bracketed_duration(motion: GroundMotion, threshold: float = BRACKET) -> float:
    """Return the time from the first to the last sample beyond a threshold [mm/s2], or 0."""
    beyond = np.flatnonzero(np.abs(motion.acceleration) > threshold)
    return float((beyond[-1] - beyond[0]) * motion.dt) if len(beyond) else 0.0


def measure_motion(motion: GroundMotion) -> MotionMeasures:
    """Return all measures of a ground motion; InputError if it is zero throughout."""
    velocity, displacement = motion.velocity, motion.displacement
    start, end = significant_interval(motion)
    absolute = np.abs(motion.acceleration)
    return MotionMeasures(
        pga=motion.pga,
        pgv=float(np.abs(velocity).max()),
        pgd=float(np.abs(displacement).max()),
        end_velocity=float(velocity[-1]),
        end_displacement=float(displacement[-1]),
        arias_intensity=float(_arias_growth(motion)[-1]),
        significant_duration=end - start,
        bracketed_duration=bracketed_duration(motion),
        cumulative_absolute_velocity=float(0.5 * motion.dt * (absolute[1:] + absolute[:-1]).sum()),
    )
