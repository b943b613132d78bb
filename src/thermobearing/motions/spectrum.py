"""Response spectra by the exact solution for an acceleration linear between its samples."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.units import number_list
from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.types import Floats
from thermobearing.motions.pair import MotionPair, pair_direction
from thermobearing.motions.record import GroundMotion

STEPS_PER_PERIOD = 40  # a peak between two such steps is at most 0.3 % higher
DAMPING = 0.05
ANGLES = np.arange(180.0)  # of a pair to an axis, each once [deg]


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


@dataclass(frozen=True)
class RotatedSpectrum:
    """Largest responses of damped oscillators to a pair, along horizontal axes at all angles.

    Attributes
    ----------
    periods : natural periods [s].
    damping : ratio of critical damping.
    angles : [angle] of the pair to the axis [deg], 0 to 179: half a turn more gives the same.
    acceleration : [angle, period] largest absolute acceleration along the axis [mm/s2].
    displacement : [angle, period] largest displacement relative to the ground [mm].
    pseudo_acceleration : displacement times (2 pi/T)^2 [mm/s2].

    Notes
    -----
    The median over the angles, `np.median(spectrum.pseudo_acceleration, axis=0)`, is RotD50, and
    the largest value, `spectrum.pseudo_acceleration.max(axis=0)`, is RotD100 (Boore, Bulletin of
    the Seismological Society of America 100, 2010).
    """

    periods: Floats
    damping: float
    angles: Floats
    acceleration: Floats
    displacement: Floats
    pseudo_acceleration: Floats


@compiled
def _free_response(w: float, damping: float, h: float) -> tuple[float, float, float, float]:
    """Return displacement and velocity after a step from unit displacement, then from velocity."""
    root = math.sqrt(1.0 - damping * damping)
    wd = w * root
    decay = math.exp(-damping * w * h)
    sine, cosine = math.sin(wd * h), math.cos(wd * h)
    uu = decay * (cosine + damping / root * sine)
    vu = -decay * w / root * sine
    return uu, vu, decay * sine / wd, decay * (cosine - damping / root * sine)


@compiled
def _step(
    u: float,
    v: float,
    start: float,
    slope: float,
    w: float,
    damping: float,
    h: float,
    free: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Return displacement and velocity after a step under the acceleration start + slope t."""
    uu, vu, uv, vv = free
    # Particular solution of u'' + 2 zeta w u' + w^2 u = -(a + s t): p + q t.
    w2 = w * w
    q = -slope / w2
    p = -start / w2 - 2.0 * damping * q / w
    du, dv = u - p, v - q
    return p + q * h + uu * du + uv * dv, q + vu * du + vv * dv


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
        free = _free_response(w, damping, h)
        u, v = 0.0, 0.0
        largest_u, largest_v = 0.0, 0.0
        up, when_up, down, when_down = 0.0, 0.0, 0.0, 0.0
        for i in range(acceleration.shape[0] - 1):
            slope = (acceleration[i + 1] - acceleration[i]) / dt
            for k in range(count):
                start = acceleration[i] + slope * (k * h)
                u, v = _step(u, v, start, slope, w, damping, h, free)
                a = -2.0 * damping * w * v - w * w * u
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


@compiled
def _respond_rotated(
    first: Floats,
    second: Floats,
    dt: float,
    omega: Floats,
    damping: float,
    parts: Floats,
    directions: Floats,
    peaks: Floats,
) -> None:
    """Largest displacement and acceleration of each oscillator along each of the directions.

    `directions` [2, angle] has cosines and sines; `peaks` [2, oscillator, angle]. The response is
    linear: that to a component of the ground motion is this component of both responses. No
    direction sees more than the resultant, so that most steps need no look at the directions.
    """
    for j in range(omega.shape[0]):
        w = omega[j]
        count = int(parts[j])
        h = dt / count
        free = _free_response(w, damping, h)
        ux, vx, uy, vy = 0.0, 0.0, 0.0, 0.0
        least_u, least_a = 0.0, 0.0  # of the peaks along all directions
        for i in range(first.shape[0] - 1):
            slope_x = (first[i + 1] - first[i]) / dt
            slope_y = (second[i + 1] - second[i]) / dt
            for k in range(count):
                t = k * h
                ux, vx = _step(ux, vx, first[i] + slope_x * t, slope_x, w, damping, h, free)
                uy, vy = _step(uy, vy, second[i] + slope_y * t, slope_y, w, damping, h, free)
                ax = -2.0 * damping * w * vx - w * w * ux
                ay = -2.0 * damping * w * vy - w * w * uy
                if ux * ux + uy * uy > least_u * least_u:
                    least_u = _raised(peaks[0, j], directions, ux, uy)
                if ax * ax + ay * ay > least_a * least_a:
                    least_a = _raised(peaks[1, j], directions, ax, ay)


@compiled
def _raised(peaks: Floats, directions: Floats, x: float, y: float) -> float:
    """Raise the peaks along directions to those of a vector; return the least."""
    least = math.inf
    for n in range(peaks.shape[0]):
        peaks[n] = max(peaks[n], abs(directions[0, n] * x + directions[1, n] * y))
        least = min(least, peaks[n])
    return least


def check_damping(damping: float) -> None:
    """InputError unless a damping ratio is in [0, 1)."""
    if not 0.0 <= damping < 1.0:
        raise InputError(f"damping: {damping:g} is outside [0, 1)")


def _oscillators(
    dt: float, periods: ArrayLike, damping: float, steps_per_period: int
) -> tuple[Floats, Any, Floats, Floats]:
    """Return periods, which of them follow the ground, frequencies, and parts of a time step."""
    values = number_list(periods, "periods [s]")
    if (values < 0.0).any():
        raise InputError("periods [s]: give one or more numbers, not negative", "response spectrum")
    check_damping(damping)
    if not 1 <= steps_per_period <= 10_000:
        raise InputError(
            f"steps_per_period: {steps_per_period} is outside 1 to 10000", "response spectrum"
        )
    # Periods below this follow the ground, and would only cost time.
    stiff = values < 1e-3 * dt
    omega = 2.0 * np.pi / np.where(stiff, 1.0, values)
    parts = np.ceil(steps_per_period * dt * omega / (2.0 * np.pi) * (1.0 - 1e-12))
    parts = np.maximum(parts, 1.0) if steps_per_period > 1 else np.ones(len(values))
    return values, stiff, omega, parts


@checked
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
    values, stiff, omega, parts = _oscillators(motion.dt, periods, damping, steps_per_period)
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


@checked
def rotated_spectrum(
    pair: MotionPair,
    periods: ArrayLike,
    damping: float = DAMPING,
    *,
    steps_per_period: int = STEPS_PER_PERIOD,
) -> RotatedSpectrum:
    """Largest responses to a pair of ground motions along an axis, at each angle of the pair.

    Parameters
    ----------
    pair : both components; its own angle does not matter.
    periods, damping, steps_per_period : as of `response_spectrum`.

    Returns
    -------
    RotatedSpectrum

    Raises
    ------
    InputError : periods, damping or steps out of range.

    Examples
    --------
    >>> import numpy as np
    >>> step = GroundMotion("step", 0.01, np.full(1000, 1000.0))
    >>> still = GroundMotion("still", 0.01, np.zeros(1000))
    >>> found = rotated_spectrum(MotionPair(step, still), [1.0], damping=0.0)
    >>> [round(float(value)) for value in found.acceleration[[0, 45, 60], 0]]
    [2000, 1414, 1000]
    """
    values, stiff, omega, parts = _oscillators(pair.dt, periods, damping, steps_per_period)
    turned = [pair_direction(float(angle)) for angle in ANGLES]
    directions = np.array([[cosine, -sine] for cosine, sine in turned]).T.copy()
    first, second = pair.rotated(0.0).T.copy()
    peaks = np.zeros((2, len(values), len(ANGLES)))
    _respond_rotated(first, second, pair.dt, omega, float(damping), parts, directions, peaks)
    ground = np.abs(directions.T @ np.array([first, second])).max(axis=1)
    peaks[0, stiff], peaks[1, stiff] = 0.0, ground
    displacement, acceleration = peaks.transpose(0, 2, 1)
    pseudo = np.where(stiff, ground[:, np.newaxis], omega**2 * displacement)
    return RotatedSpectrum(
        values, float(damping), ANGLES.copy(), acceleration, displacement, pseudo
    )
