"""Processing of ground motions: baseline, time step, amplitude, length."""

from dataclasses import replace
from fractions import Fraction

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.motions.record import MOST_SAMPLES, GroundMotion, integrate_displacement

POLYNOMIAL = 6  # degree of the drift removed from the displacement
BUTTERWORTH = 4  # order of the high-pass filter
LONGEST_CORNER = 10.0  # period of the filter's corner over the length of the motion, at most
SAME_STEP = 1e-9  # relative difference of time steps that are the same
LARGEST_RATIO = 1000  # numerator and denominator of a ratio of time steps


def with_quiet_end(acceleration: Floats, dt: float) -> Floats:
    """Return the acceleration with a minimal correction so that the ground ends at rest.

    The last axis counts the samples. A smooth hump and its moment, each zero at both ends, are
    subtracted in the sizes that make velocity and displacement zero at the last sample.
    """
    shapes, to_ends = end_shapes(acceleration.shape[-1], dt)
    sizes = np.linalg.solve(to_ends @ shapes.T, to_ends @ np.moveaxis(acceleration, -1, 0))
    return np.asarray(acceleration - sizes.T @ shapes)


def end_shapes(count: int, dt: float) -> tuple[Floats, Floats]:
    """Return what `with_quiet_end` subtracts, and what samples add to the ends; both [2, count].

    The ends are the last velocity and the last displacement.
    """
    place = np.linspace(0.0, 1.0, count)
    hump = np.sin(np.pi * place) ** 2
    # What a sample adds to the ends, exact for an acceleration that is linear between samples: the
    # area of its triangle (half of one at the ends), and that times the time from its centroid.
    velocity = np.full(count, dt)
    velocity[[0, -1]] = 0.5 * dt
    displacement = dt * dt * np.arange(count - 1, -1, -1, dtype=np.float64)
    displacement[0] = dt * dt * (3.0 * count - 4.0) / 6.0
    displacement[-1] = dt * dt / 6.0
    return np.array([hump, hump * (place - 0.5)]), np.array([velocity, displacement])


def _without_drift(acceleration: Floats, dt: float) -> Floats:
    """Return the acceleration minus the second derivative of a polynomial fit to displacement."""
    place = np.linspace(0.0, 1.0, len(acceleration))
    powers = np.arange(2, POLYNOMIAL + 1)  # at rest at the start
    shapes = place[:, np.newaxis] ** powers
    sizes, *_ = np.linalg.lstsq(shapes, integrate_displacement(acceleration, dt), rcond=None)
    length = dt * (len(acceleration) - 1)
    curvature = powers * (powers - 1) * place[:, np.newaxis] ** (powers - 2)
    return np.asarray(acceleration - curvature @ sizes / length**2)


def high_pass_gain(frequency: Floats, corner: float) -> Floats:
    """Return the gain of a Butterworth filter run forwards and backwards, which keeps phases."""
    ratio = (frequency / corner) ** (2 * BUTTERWORTH)
    return np.asarray(ratio / (1.0 + ratio))


def baseline_corrected(motion: GroundMotion, *, high_pass: float | None = None) -> GroundMotion:
    """Return a motion whose velocity and displacement end at zero and do not drift.

    A polynomial of degree six, fitted to the displacement, is removed (as the PEER Ground
    Motion Database does), then the remaining velocity and displacement at the end.

    `high_pass` is the corner of a zero-phase Butterworth filter applied first [Hz], none by
    default; for records whose long periods are noise: 0.05 to 0.1 Hz. Its period is at most ten
    times the length of the motion: longer ones are no part of it.
    """
    values = np.asarray(motion.acceleration, dtype=np.float64)
    if len(values) < 16:
        raise InputError(
            f"has {len(values)} samples; a baseline correction needs at least 16", motion.name
        )
    if high_pass is not None:
        lowest, nyquist = 1.0 / (LONGEST_CORNER * motion.duration), 0.5 / motion.dt
        if not lowest <= high_pass < nyquist:
            raise InputError(
                f"high_pass: {high_pass:g} Hz is outside {lowest:.3g} to {nyquist:g} Hz: its "
                f"period must be at most {LONGEST_CORNER:g} times the length of the motion, and "
                "more than two time steps",
                motion.name,
            )
        # The transform is periodic: zeros for two periods of the corner keep what the filter leaves
        # after the last sample from coming back before the first.
        padded_count = len(values) + int(2.0 / (high_pass * motion.dt))
        frequency = np.asarray(np.fft.rfftfreq(padded_count, motion.dt), dtype=np.float64)
        spectrum = np.fft.rfft(values, padded_count) * high_pass_gain(frequency, high_pass)
        values = np.fft.irfft(spectrum, padded_count)[: len(values)]
    values = with_quiet_end(_without_drift(values, motion.dt), motion.dt)
    return replace(motion, acceleration=values)


def _check_samples(count: float, cause: str, motion: GroundMotion) -> None:
    """Raise InputError if a motion would have too many samples."""
    if count > MOST_SAMPLES:
        raise InputError(
            f"{cause} gives {count:.3g} samples, more than {MOST_SAMPLES}", motion.name
        )


def resampled(motion: GroundMotion, dt: float) -> GroundMotion:
    """Return the motion with another time step [s], without aliasing.

    A step that divides the old one draws the same straight lines between the old samples, so
    that nothing changes but the number of points. Any other step goes through a zero-phase
    low-pass filter (polyphase FIR) that removes frequencies above the new limit; its ratio to
    the old one must be a fraction of integers up to 1000.
    """
    if not (np.isfinite(dt) and 0.0 < dt <= motion.duration):
        raise InputError(
            f"dt: {dt:g} s is outside (0, {motion.duration:g}] s, the length of the motion",
            motion.name,
        )
    _check_samples(motion.duration / dt, f"dt: {dt:g} s", motion)
    ratio = motion.dt / dt
    if abs(ratio - 1.0) < SAME_STEP:
        return motion
    if ratio > 1.0 and abs(ratio - round(ratio)) < SAME_STEP * ratio:
        parts = round(ratio)
        count = parts * (len(motion.acceleration) - 1) + 1
        sample_numbers = np.arange(len(motion.acceleration), dtype=np.float64)
        values = np.interp(np.arange(count) / parts, sample_numbers, motion.acceleration)
        return replace(motion, dt=motion.dt / parts, acceleration=values)
    fraction = Fraction(ratio).limit_denominator(LARGEST_RATIO)
    if fraction.numerator > LARGEST_RATIO or abs(fraction - ratio) > SAME_STEP * ratio:
        raise InputError(
            f"dt: {dt:g} s is not a simple fraction of {motion.dt:g} s; choose a step whose ratio "
            f"to it is a fraction of integers up to {LARGEST_RATIO}",
            motion.name,
        )
    from scipy import signal  # imported here: takes half a second

    values = signal.resample_poly(motion.acceleration, fraction.numerator, fraction.denominator)
    return replace(motion, dt=motion.dt / float(fraction), acceleration=np.asarray(values))


def padded(motion: GroundMotion, before: float = 0.0, after: float = 0.0) -> GroundMotion:
    """Return the motion with the ground at rest for some time before and after it [s]."""
    for name, value in (("before", before), ("after", after)):
        if not (np.isfinite(value) and 0.0 <= value <= 1e5):
            raise InputError(f"padded: {name} = {value:g} s is outside 0 to 100000 s")
    counts = round(before / motion.dt), round(after / motion.dt)
    total = sum(counts) + len(motion.acceleration)
    _check_samples(total, f"padded: {before:g} s and {after:g} s", motion)
    return replace(motion, acceleration=np.pad(motion.acceleration, counts))
