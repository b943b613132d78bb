"""Spectral matching: Fourier amplitudes adjusted to a target response spectrum.

The phases are kept: every Fourier coefficient is multiplied by a positive number, a smooth
function of frequency. What counts is the final history, tapered and with its velocity and
displacement brought to zero at the end; its spectrum is what is compared in every round.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from thermobearing.core.types import Floats, Ints
from thermobearing.motions.process import end_shapes, high_pass_gain, with_quiet_end
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.spectrum import DAMPING, response_spectrum

FIRST, LAST = 0.1, 3.0  # periods over which the misfit counts [s]
SHORTEST, LONGEST = 0.09, 3.6  # periods that are adjusted: some more, so that the ends fit too
GOAL = 0.015  # misfit at which the rounds end
ENOUGH = 0.022  # misfit above which shaken multipliers are tried
LARGEST_MISFIT = 0.03  # documented limit
SHAKES, SHAKE = 3, 0.15  # how often, and by how much (of the logarithm)
RATIO_ROUNDS, NEWTON_ROUNDS = 8, 40
MOST_ROUNDS = 400  # of one search, over all draws and finenesses: a hundred are usual
HOPELESS = 0.1  # misfit above which nothing is shaken, and a search that is stuck ends ...
PATIENCE, GAIN = 10, 0.01  # ... when so many rounds have not made it smaller by this part of it
LONGEST_FIT = 120_000  # samples; a round takes half a second, and memory grows with them
SMALLEST_PEAK = 1e-100  # [mm/s2]; only keeps zero out of a logarithm
FAR = 10.0  # logarithm of target / spectrum beyond which the motion is first made larger or smaller
HIGH_PASS = 0.2  # [Hz]: three times longer than the longest period, so that the ground returns
WIDENING = 0.3  # [Hz]
TAPER = 4.0  # [s] at both ends
NEARLY = 0.05  # a peak of the other sign this close (logarithm) to the target is held
LARGEST_STEP = 0.3  # of the logarithm of a multiplier, in one round
TOGETHER = 16  # oscillators in one go: their histories stay in the processor's cache
STRIDE = 64  # of the coarser of two tables of exponentials
DAMPING_START, DAMPING_END = 0.05, 1e2  # weight of size and bending of a change, adapted

Complexes = NDArray[np.complex128]
Target = Callable[[Floats], Floats]
Progress = Callable[[int, int], None]


class _Fineness(NamedTuple):
    """How finely amplitudes are multiplied."""

    bands: int  # of frequency, each with its multiplier
    periods: int  # compared in every round
    roughness: float  # weight of the bending of the multipliers over the bands


# Smooth multipliers ring less; finer ones can fill a hole where waves cancel, at the price of
# a longer motion.
COARSE = _Fineness(bands=100, periods=120, roughness=0.01)
FINE = _Fineness(bands=200, periods=160, roughness=0.002)


class Matched(NamedTuple):
    """An adjusted acceleration [mm/s2] and the `misfit` of its spectrum."""

    acceleration: Floats
    misfit: float


def misfit(motion: GroundMotion, target: Target, count: int = 300) -> float:
    """Return the rms of spectrum / target - 1, at periods evenly spaced in log T, 0.1 to 3 s."""
    periods = np.geomspace(FIRST, LAST, count)
    ratio = response_spectrum(motion, periods, DAMPING).acceleration / target(periods)
    return float(np.sqrt(np.mean((ratio - 1.0) ** 2)))


class Effort:
    """The rounds that a search may take; `progress` is called with (rounds done, at most)."""

    def __init__(self, rounds: int | None = None, progress: Progress | None = None) -> None:
        self.rounds = MOST_ROUNDS if rounds is None else rounds
        self.progress, self.done = progress, 0

    def count(self) -> None:
        """Count one more round."""
        self.done += 1
        if self.progress:
            self.progress(min(self.done, self.rounds), self.rounds)

    @property
    def spent(self) -> bool:
        """Whether there is no round left."""
        return self.done >= self.rounds


class _Amplitudes:
    """The Fourier coefficients of a motion, multiplied band by band."""

    def __init__(
        self, acceleration: Floats, dt: float, fineness: _Fineness, effort: Effort | None = None
    ) -> None:
        self.effort = effort or Effort()
        self.fineness, bands = fineness, fineness.bands
        self.dt, self.length = dt, len(acceleration)
        size = scipy.fft.next_fast_len(self.length, real=True)
        self.size = size
        self.frequency = np.asarray(np.fft.rfftfreq(size, dt), dtype=np.float64)
        gain = high_pass_gain(self.frequency, HIGH_PASS)
        self.coefficients = np.fft.rfft(acceleration, size) * gain
        # Triangles over log(f + WIDENING), the outermost ones going on at one: narrow bands at
        # low frequencies would ring for longer than the motion lasts.
        low, high = (float(np.log(1.0 / end + WIDENING)) for end in (LONGEST, SHORTEST))
        nodes = np.linspace(low, high, bands)
        places = np.arange(bands, dtype=np.float64)
        place = np.interp(np.log(self.frequency + WIDENING), nodes, places)
        triangles = np.maximum(0.0, 1.0 - np.abs(place[:, np.newaxis] - np.arange(bands)))
        self.bands = scipy.sparse.csr_array(triangles)  # two of them at most at one frequency
        self.nodes = 1.0 / (np.exp(nodes) - WIDENING)  # as periods
        self.logarithm = np.zeros(bands)
        edge = max(2, round(TAPER / dt))
        ramp = np.sin(0.5 * np.pi * np.arange(edge) / edge) ** 2
        self.taper = np.concatenate([ramp, np.ones(self.length - 2 * edge), ramp[::-1]])
        self.periods = np.geomspace(SHORTEST, LONGEST, fineness.periods)
        w = 2.0 * np.pi * self.frequency
        wn = 2.0 * np.pi / self.periods[:, np.newaxis]
        spring = wn**2 - 2.0j * DAMPING * wn * w
        # [period, frequency] absolute acceleration by that of the ground, conjugate.
        self.oscillators: Complexes = np.asarray(spring / (spring - w**2))

    def multiplied(self) -> Complexes:
        """Return the coefficients with the present multipliers."""
        return np.asarray(self.coefficients * np.exp(self.bands @ self.logarithm))

    def motion(self) -> GroundMotion:
        """Return the history with the present multipliers and its ends in order."""
        values = np.fft.irfft(self.multiplied(), self.size)[: self.length]
        return GroundMotion("matched", self.dt, with_quiet_end(values * self.taper, self.dt))

    def sensitivity(self, oscillator_indices: Ints, times: Floats) -> Floats:
        """Return [response, band] acceleration at the given times by the part of each band [mm/s2].

        The sum over the bands is the response itself, since they add up to one. All that leads
        from the coefficients of a band to a response is linear; it is followed backwards, from
        each response to all bands at once: how much each sample adds to the response, and then
        what each band adds to these samples. `oscillator_indices` are those of the oscillators of
        the responses in `periods`.
        """
        # The sizes of the shapes that `with_quiet_end` subtracts are linear in the history, too:
        # `sizes` [2, band] are those of each band.
        shapes, to_ends = end_shapes(self.length, self.dt)
        to_sizes = np.asarray(np.linalg.solve(to_ends @ shapes.T, to_ends), dtype=np.float64)
        sizes = self._by_band(to_sizes)
        rows = []
        for first in range(0, len(times), TOGETHER):
            chunk = slice(first, first + TOGETHER)
            waves = self.oscillators[oscillator_indices[chunk]] * self._phase_factors(times[chunk])
            weights = np.asarray(np.fft.irfft(waves, self.size)[:, : self.length])
            rows.append(self._by_band(weights) - weights @ shapes.T @ sizes)
        return np.concatenate(rows)

    def _phase_factors(self, times: Floats) -> Complexes:
        """[time, frequency] exp(-i w t), as products: exponentials would take most of the time."""
        turn = -2.0j * np.pi * times[:, np.newaxis]
        coarse = np.exp(turn * self.frequency[::STRIDE])
        fine = np.exp(turn * self.frequency[:STRIDE])
        products = coarse[:, :, np.newaxis] * fine[:, np.newaxis, :]
        return np.asarray(products.reshape(len(times), -1)[:, : len(self.frequency)])

    def _by_band(self, weights: Floats) -> Floats:
        """[row, band] sum of each row of weights times the tapered history of each band."""
        spectrum = np.fft.rfft(weights * self.taper, self.size)
        # Of a real history only half the coefficients are stored: all count twice but that of
        # frequency zero and, of an even number of samples, that of the Nyquist frequency.
        scale = np.full(len(self.frequency), 2.0 / self.size)
        scale[0] = 1.0 / self.size
        if self.size % 2 == 0:
            scale[-1] = 1.0 / self.size
        return np.asarray(np.real(spectrum.conj() * (scale * self.multiplied())) @ self.bands)


def matched(
    acceleration: Floats,
    dt: float,
    target: Target,
    *,
    finer: bool = False,
    effort: Effort | None = None,
) -> Matched:
    """Adjust the Fourier amplitudes of a motion until its spectrum is the target.

    First each amplitude is multiplied by target / spectrum at its own period, a few times over.
    Then Newton's method: the response of each oscillator at the time of its peak is linear in
    the amplitudes of the bands, so that the changes of all of them follow from damped least
    squares (smooth over frequency), with new peaks looked up in every round. The best round
    is returned; what it fits is checked on the final history.

    The motion [mm/s2] needs room at both ends for ringing. With `finer`, finer bands are tried if
    the misfit stays above 3 %: they fit better and ring longer.
    """
    fits: list[Matched] = []
    effort = effort or Effort()
    with threadpool_limits(1, "blas"):  # of small matrices: others would only wait
        for fineness in (COARSE, FINE) if finer else (COARSE,):
            if fits and effort.spent:
                break
            best = _matched(acceleration, dt, target, fineness, effort)
            fits.append(Matched(best.motion.acceleration, misfit(best.motion, target)))
            if fits[-1].misfit <= LARGEST_MISFIT:
                break
    return min(fits, key=lambda fit: fit.misfit)


def _matched(
    acceleration: Floats, dt: float, target: Target, fineness: _Fineness, effort: Effort
) -> "_Round":
    amplitudes = _Amplitudes(acceleration, dt, fineness, effort)
    target_values = target(amplitudes.periods)
    best = _compare(amplitudes, target_values)
    mean_gap = float(np.mean(best.gaps[0]))
    # The rounds below would take many limited steps to get there.
    if abs(mean_gap) > FAR:
        amplitudes.coefficients = amplitudes.coefficients * np.exp(mean_gap)
        best = _compare(amplitudes, target_values)
    for _ in range(RATIO_ROUNDS):
        if effort.spent:
            return best
        # The nodes are periods in decreasing order, and np.interp needs increasing ones.
        change = np.interp(amplitudes.nodes[::-1], amplitudes.periods, best.gaps[0])[::-1]
        amplitudes.logarithm = best.logarithm + np.clip(change, -LARGEST_STEP, LARGEST_STEP)
        best = _compare(amplitudes, target_values)
    best = _improved(amplitudes, target_values, best)
    # Where peaks at two times hold each other, shaken multipliers find a way out.
    stream = np.random.default_rng(0)
    for _ in range(SHAKES):
        if best.error <= ENOUGH or best.error > HOPELESS or effort.spent:
            break
        amplitudes.logarithm = best.logarithm + SHAKE * stream.standard_normal(fineness.bands)
        start = _compare(amplitudes, target_values)
        trial = _improved(amplitudes, target_values, start)
        best = min(best, trial, key=lambda iterate: iterate.error)
    return best


class _Round(NamedTuple):
    """Multipliers, the history they make, and how far its spectrum is from the target."""

    logarithm: Floats
    motion: GroundMotion
    peak_times: Floats  # [2, period] of the larger peak, and of that of the other sign
    gaps: Floats  # [2, period] logarithm of target / peak
    error: float


def _compare(amplitudes: _Amplitudes, target_values: Floats) -> _Round:
    amplitudes.effort.count()
    motion = amplitudes.motion()
    spectrum = response_spectrum(motion, amplitudes.periods, DAMPING)
    error = float(np.sqrt(np.mean((spectrum.acceleration / target_values - 1.0) ** 2)))
    order = np.argsort(-spectrum.peaks, axis=0, kind="stable")
    peaks = np.take_along_axis(spectrum.peaks, order, axis=0)
    times = np.take_along_axis(spectrum.peak_times, order, axis=0)
    # Where a response has one sign only, the other peak is zero.
    gaps = np.log(target_values / np.maximum(peaks, SMALLEST_PEAK))
    return _Round(amplitudes.logarithm.copy(), motion, times, gaps, error)


def _improved(amplitudes: _Amplitudes, target_values: Floats, start: _Round) -> _Round:
    """Newton's rounds from a start, with damping that follows their success."""
    best, damping, errors = start, DAMPING_START, [start.error]
    linear: _Linear | None = None  # at the best round: most of the work, so kept while that stays
    for _ in range(NEWTON_ROUNDS):
        stuck = len(errors) > PATIENCE and best.error > (1.0 - GAIN) * errors[-1 - PATIENCE]
        if best.error <= GOAL or damping > DAMPING_END or amplitudes.effort.spent:
            break
        if stuck and best.error > HOPELESS:
            break
        amplitudes.logarithm = best.logarithm
        linear = linear or _linear(amplitudes, best)
        change = _newton(amplitudes.fineness, linear, best, damping)
        amplitudes.logarithm = best.logarithm + np.clip(change, -LARGEST_STEP, LARGEST_STEP)
        trial = _compare(amplitudes, target_values)
        # As in Levenberg and Marquardt's method: a step that fails is repeated with more damping,
        # about the same round.
        if trial.error < best.error:
            best, damping, linear = trial, damping / 2.0, None
        else:
            damping *= 4.0
        errors.append(best.error)
    return best


class _Linear(NamedTuple):
    """How the peaks of a round follow the multipliers, and how far they should go."""

    slopes: Floats  # [peak, band] change of the logarithm of a peak by that of a multiplier
    gaps: Floats  # [peak] logarithm of target / peak


def _linear(amplitudes: _Amplitudes, iterate: _Round) -> _Linear:
    # The peak of the other sign must not grow where it is nearly as large.
    rivals = np.flatnonzero(iterate.gaps[1] < NEARLY)
    gaps = np.concatenate([iterate.gaps[0], np.minimum(iterate.gaps[1, rivals], 0.0)])
    parts = amplitudes.sensitivity(
        np.concatenate([np.arange(len(amplitudes.periods)), rivals]),
        np.concatenate([iterate.peak_times[0], iterate.peak_times[1, rivals]]),
    )
    return _Linear(parts / parts.sum(axis=1, keepdims=True), gaps)


def _newton(fineness: _Fineness, linear: _Linear, iterate: _Round, damping: float) -> Floats:
    """Changes of the multipliers' logarithms that close the gaps, by damped least squares."""
    bands, roughness = fineness.bands, fineness.roughness
    bending = np.diff(np.eye(bands), 2, axis=0)
    weight = np.sqrt(damping)
    identity = weight * np.eye(bands)
    system = np.vstack([linear.slopes, identity, weight * bending, roughness * bending])
    straightening = -roughness * (bending @ iterate.logarithm)
    right_side = np.concatenate([linear.gaps, np.zeros(2 * bands - 2), straightening])
    # The damping keeps the system of full rank, so that singular values, ten times as slow, are
    # not needed.
    columns, triangle = np.linalg.qr(system)
    return np.asarray(scipy.linalg.solve_triangular(triangle, columns.T @ right_side))
