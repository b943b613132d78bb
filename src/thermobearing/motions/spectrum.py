"""Response spectra by the exact solution for an acceleration linear between its samples."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.border.errors import InputError
from thermobearing.border.units import number_list
from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.types import Floats
from thermobearing.motions.record import GroundMotion

STEPS_PER_PERIOD = 40  # a peak between two such steps is at most 0.3 % higher
DAMPING = 0.05


@dataclass(frozen=True)
class ResponseSpectrum:
    """Largest responses of damped oscillators to a ground motion.

    Attributes
    ----------
    periods : natural periods [s].
    damping : ratio of critical damping.
    acceleration : largest absolute acceleration [mm/s2].
    velocity : largest velocity relative to the ground [mm/s].
    displacement : largest displacement relative to the ground [mm].
    pseudo_acceleration, pseudo_velocity : displacement times (2 pi/T)^2 [mm/s2], 2 pi/T [mm/s].
    peaks, peak_times : [2, period] largest absolute acceleration of either sign [mm/s2], upwards
        first, and when it comes [s].
    """

    periods: Floats
    damping: float
    acceleration: Floats
    velocity: Floats
    displacement: Floats
    pseudo_acceleration: Floats
    pseudo_velocity: Floats
    peaks: Floats
    peak_times: Floats


@compiled
def _respond(
    acceleration: Floats, dt: float, omega: Floats, damping: float, parts: Floats, peaks: Floats
) -> None:
    """Largest responses, a row of `peaks` for each oscillator.

    Displacement, velocity, then the largest acceleration upwards, its time, the largest
    downwards, its time.
    """
    for j in range(omega.shape[0]):
        w = omega[j]
        count = int(parts[j])
        h = dt / count
        root = math.sqrt(1.0 - damping * damping)
        wd = w * root
        decay = math.exp(-damping * w * h)
        sine, cosine = math.sin(wd * h), math.cos(wd * h)
        # Free response over a step from unit displacement, and from unit velocity.
        uu = decay * (cosine + damping / root * sine)
        uv = decay * sine / wd
        vu = -decay * w / root * sine
        vv = decay * (cosine - damping / root * sine)
        w2 = w * w
        u, v = 0.0, 0.0
        largest_u, largest_v = 0.0, 0.0
        up, when_up, down, when_down = 0.0, 0.0, 0.0, 0.0
        for i in range(acceleration.shape[0] - 1):
            slope = (acceleration[i + 1] - acceleration[i]) / dt
            # Particular solution of u'' + 2 zeta w u' + w^2 u = -(a + s t): p + q t.
            q = -slope / w2
            for k in range(count):
                start = acceleration[i] + slope * (k * h)
                p = -start / w2 - 2.0 * damping * q / w
                du, dv = u - p, v - q
                u = p + q * h + uu * du + uv * dv
                v = q + vu * du + vv * dv
                a = -2.0 * damping * w * v - w2 * u
                if abs(u) > largest_u:
                    largest_u = abs(u)
                if abs(v) > largest_v:
                    largest_v = abs(v)
                if a > up:
                    up = a
                    when_up = i * dt + (k + 1) * h
                if -a > down:
                    down = -a
                    when_down = i * dt + (k + 1) * h
        peaks[j, 0] = largest_u
        peaks[j, 1] = largest_v
        peaks[j, 2] = up
        peaks[j, 3] = when_up
        peaks[j, 4] = down
        peaks[j, 5] = when_down


def check_damping(damping: float) -> None:
    """InputError unless a damping ratio is in [0, 1)."""
    if not 0.0 <= damping < 1.0:
        raise InputError(f"damping: {damping:g} is outside [0, 1)")


def response_spectrum(
    motion: GroundMotion,
    periods: ArrayLike,
    damping: float = DAMPING,
    *,
    steps_per_period: int = STEPS_PER_PERIOD,
) -> ResponseSpectrum:
    """Largest responses of oscillators at rest to a ground motion.

    Between samples the acceleration is linear and the solution exact (Nigam and Jennings,
    Bulletin of the Seismological Society of America 59, 1969); steps of short periods are
    divided so that no peak between them is missed.

    Parameters
    ----------
    motion : the ground motion.
    periods : natural periods [s], >= 0; at 0 the oscillator moves with the ground.
    damping : ratio of critical damping, in [0, 1).
    steps_per_period : steps that a period has at least; 1 looks at the samples only.

    Returns
    -------
    ResponseSpectrum

    Raises
    ------
    InputError : periods, damping or steps out of range.

    Examples
    --------
    >>> import numpy as np
    >>> step = GroundMotion("step", 0.01, np.full(1000, 1000.0))
    >>> spectrum = response_spectrum(step, [1.0], damping=0.0)
    >>> round(float(spectrum.acceleration[0]))  # a sudden load counts twice
    2000
    """
    values = number_list(periods, "periods [s]")
    if (values < 0.0).any():
        raise InputError("periods [s]: give one or more numbers, not negative", "response_spectrum")
    check_damping(damping)
    if not 1 <= steps_per_period <= 10_000:
        raise InputError(
            f"steps_per_period: {steps_per_period} is outside 1 to 10000", "response_spectrum"
        )
    # Periods below this follow the ground, and would only cost time.
    stiff = values < 1e-3 * motion.dt
    omega = 2.0 * np.pi / np.where(stiff, 1.0, values)
    parts = np.ceil(steps_per_period * motion.dt * omega / (2.0 * np.pi) * (1.0 - 1e-12))
    parts = np.maximum(parts, 1.0) if steps_per_period > 1 else np.ones(len(values))
    rows = np.zeros((len(values), 6))
    acceleration = np.ascontiguousarray(motion.acceleration, dtype=np.float64)
    _respond(acceleration, motion.dt, omega, float(damping), parts, rows)
    if stiff.any():
        high, low = int(acceleration.argmax()), int(acceleration.argmin())
        up, down = max(acceleration[high], 0.0), max(-acceleration[low], 0.0)
        rows[stiff] = [0.0, 0.0, up, high * motion.dt, down, low * motion.dt]
    u, v, up, when_up, down, when_down = rows.T.copy()
    return ResponseSpectrum(
        periods=values,
        damping=float(damping),
        acceleration=np.maximum(up, down),
        velocity=v,
        displacement=u,
        pseudo_acceleration=np.where(stiff, motion.pga, omega**2 * u),
        pseudo_velocity=omega * u,
        peaks=np.array([up, down]),
        peak_times=np.array([when_up, when_down]),
    )
