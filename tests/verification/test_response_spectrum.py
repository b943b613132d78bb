"""Response spectra against closed forms and scipy; the sensitivities of spectral matching."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import signal

from tests import tolerances as tol
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import COARSE, _Amplitudes
from thermobearing.motions.pair import MotionPair, make_pair, rotation_measures
from thermobearing.motions.process import padded, with_quiet_end
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.spectrum import ANGLES, DAMPING, response_spectrum, rotated_spectrum
from thermobearing.motions.synthesis import ROOM


def make_motion(values: object, dt: float = 0.01) -> GroundMotion:
    return GroundMotion("test", dt, np.asarray(values, dtype=np.float64))


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
def test_sudden_load_overshoots_as_the_closed_form(damping: float) -> None:
    """u_max = a / w^2 (1 + exp(-pi zeta / sqrt(1 - zeta^2))), at half a damped period."""
    period = 1.0 * np.sqrt(1.0 - damping**2)  # so that the peak is on a sample
    result = response_spectrum(make_motion(np.full(301, 1000.0)), [period], damping)
    over = 1.0 + np.exp(-np.pi * damping / np.sqrt(1.0 - damping**2))
    exact = 1000.0 * (period / (2.0 * np.pi)) ** 2 * over
    assert result.displacement[0] == pytest.approx(exact, rel=tol.EXACT_OSCILLATOR)
    assert result.pseudo_acceleration[0] == pytest.approx(1000.0 * over, rel=tol.EXACT_OSCILLATOR)
    assert result.pseudo_velocity[0] == pytest.approx(
        exact * 2.0 * np.pi / period, rel=tol.EXACT_OSCILLATOR
    )


def test_linear_acceleration_is_followed_exactly() -> None:
    """Undamped under a = s t: u = -s (t - sin(w t) / w) / w^2, whatever the time step."""
    slope, w = 500.0, 2.0 * np.pi / 0.8
    end = 2.0
    result = response_spectrum(make_motion([0.0, slope * end], end), [0.8], 0.0, steps_per_period=1)
    exact = slope * (end - np.sin(w * end) / w) / w**2
    assert result.displacement[0] == pytest.approx(exact, rel=tol.EXACT_OSCILLATOR)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 3.0])
def test_steady_vibration_under_a_sine(ratio: float) -> None:
    damping, period = 0.05, 1.0
    time = np.arange(0.0, 60.0, 0.005)
    motion = make_motion(100.0 * np.sin(2.0 * np.pi * ratio * time), 0.005)
    quiet = 8000  # the free vibration has died away after 40 s
    w = 2.0 * np.pi / period
    system = signal.lti([-2.0 * damping * w, -(w**2)], [1.0, 2.0 * damping * w, w**2])
    _, response, _ = signal.lsim(system, motion.acceleration, time)
    gain = np.sqrt(
        (1.0 + (2.0 * damping * ratio) ** 2)
        / ((1.0 - ratio**2) ** 2 + (2.0 * damping * ratio) ** 2)
    )
    assert np.abs(response[quiet:]).max() == pytest.approx(100.0 * gain, rel=tol.HARMONIC)
    if ratio == 1.0:  # nothing before was larger
        result = response_spectrum(motion, [period], damping).acceleration[0]
        assert result == pytest.approx(100.0 * gain, rel=tol.HARMONIC)


@pytest.mark.parametrize("period", [0.1, 0.5, 2.0])
def test_whole_histories_peak_as_with_scipy(period: float) -> None:
    """scipy.signal.lsim takes the input as linear between samples too."""
    motion, damping = load_motion("jra-ii-i-1"), 0.05
    w = 2.0 * np.pi / period
    matrix = np.array([[0.0, 1.0], [-(w**2), -2.0 * damping * w]])
    wanted = np.array([[1.0, 0.0], [0.0, 1.0], [-(w**2), -2.0 * damping * w]])
    system = signal.StateSpace(matrix, [[0.0], [-1.0]], wanted, np.zeros((3, 1)))
    _, response, _ = signal.lsim(system, motion.acceleration, motion.time)
    result = response_spectrum(motion, [period], damping, steps_per_period=1)
    peaks = np.abs(response).max(axis=0)
    ours = [result.displacement[0], result.velocity[0], result.acceleration[0]]
    assert_allclose(ours, peaks, rtol=tol.LSIM_SPECTRUM)


def test_ends_of_the_period_axis() -> None:
    """A rigid oscillator moves with the ground, a very soft one stays where it was."""
    motion = load_motion("jra-ii-i-1")
    result = response_spectrum(motion, [0.0, 1e-9, 1000.0])
    assert_allclose(result.acceleration[:2], motion.pga, rtol=1e-12)
    assert result.displacement[0] == 0.0
    assert result.displacement[2] == pytest.approx(np.abs(motion.displacement).max(), rel=0.05)


def test_steps_within_a_period_miss_no_peak() -> None:
    motion = load_motion("jra-ii-i-1")
    periods = np.geomspace(0.05, 0.5, 30)
    usual = response_spectrum(motion, periods)
    fine = response_spectrum(motion, periods, steps_per_period=1000)
    coarse = response_spectrum(motion, periods, steps_per_period=1)
    assert (fine.acceleration >= usual.acceleration * (1.0 - 1e-12)).all()
    assert_allclose(usual.acceleration, fine.acceleration, rtol=tol.PEAK_BETWEEN)
    assert (coarse.acceleration < 0.99 * fine.acceleration).any()


def shaken_amplitudes() -> _Amplitudes:
    motion = padded(load_motion("jra-ii-i-1"), before=ROOM, after=10.0 * ROOM)
    amplitudes = _Amplitudes(motion.acceleration, motion.dt, COARSE)
    stream = np.random.default_rng(1)
    amplitudes.logarithm = 0.3 * stream.standard_normal(COARSE.bands)
    return amplitudes


def test_sensitivity_is_the_response_to_each_band() -> None:
    """The same forwards: the history of each band with its ends in order, and its response."""
    amplitudes = shaken_amplitudes()
    which = np.arange(0, COARSE.periods, 7)
    times = np.linspace(5.0, 40.0, len(which)) + 0.0037  # between the samples too
    bands = amplitudes.bands.toarray().T * amplitudes.multiplied()
    tapered = np.fft.irfft(bands, amplitudes.size)[:, : amplitudes.length] * amplitudes.taper
    parts = np.fft.rfft(with_quiet_end(tapered, amplitudes.dt), amplitudes.size)
    parts[:, 1:-1] *= 2.0  # of each pair of frequencies, one is kept
    w = 2.0 * np.pi * amplitudes.frequency
    wn = 2.0 * np.pi / amplitudes.periods[which, np.newaxis]
    spring = wn**2 + 2.0j * DAMPING * wn * w
    waves = spring / (spring - w**2) * np.exp(1j * w * times[:, np.newaxis])
    forwards = np.real(waves @ parts.T) / amplitudes.size
    backwards = amplitudes.sensitivity(which, times)
    assert_allclose(backwards, forwards, rtol=0.0, atol=tol.ADJOINT * np.abs(forwards).max())


def test_bands_add_up_to_the_peak_of_the_response() -> None:
    """Waves between the samples there, straight lines in the spectrum: not quite the same."""
    amplitudes = shaken_amplitudes()
    spectrum = response_spectrum(amplitudes.motion(), amplitudes.periods, DAMPING)
    first = np.where(spectrum.peaks[0] > spectrum.peaks[1], 0, 1)
    times = spectrum.peak_times[first, np.arange(COARSE.periods)]
    added = amplitudes.sensitivity(np.arange(COARSE.periods), times).sum(axis=1)
    long = amplitudes.periods > 0.5
    assert_allclose(np.abs(added[long]), spectrum.acceleration[long], rtol=tol.STRAIGHT_LINES)


PAIR = MotionPair(load_motion("jra-ii-i-1"), load_motion("jra-ii-i-2"))
PERIODS = np.array([0.0, 0.06, 0.3, 1.0, 2.5])
QUANTITIES = ("acceleration", "displacement", "pseudo_acceleration")


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_motion_along_a_line_has_the_rotation_measures_of_a_cosine(angle: float) -> None:
    """Along an axis at an angle a the response is |cos a| times its own: median cos 45 deg."""
    motion = PAIR.first
    x, y = make_pair(motion, angle=angle).rotated().T
    result = rotated_spectrum(MotionPair(make_motion(x), make_motion(y)), PERIODS)
    own = response_spectrum(motion, PERIODS)
    for name in QUANTITIES:
        rotd50, rotd100 = rotation_measures(getattr(result, name), ANGLES.tolist())
        assert_allclose(rotd100, getattr(own, name), rtol=tol.ROTATED)
        assert_allclose(rotd50, np.sqrt(0.5) * getattr(own, name), rtol=tol.ROTATED)


@pytest.mark.parametrize("angle", [0, 17, 90, 151])
def test_rotated_responses_are_those_to_rotated_records(angle: int) -> None:
    result = rotated_spectrum(PAIR, PERIODS, 0.1)
    turned = response_spectrum(make_motion(PAIR.rotated(float(angle))[:, 0]), PERIODS, 0.1)
    for name in QUANTITIES:
        assert_allclose(
            getattr(result, name)[angle], getattr(turned, name), rtol=tol.ROTATED, atol=0.0
        )


def test_rotation_measures_do_not_depend_on_the_axes_of_the_records() -> None:
    x, y = PAIR.rotated(41.0).T
    turned = rotated_spectrum(MotionPair(make_motion(x), make_motion(y)), PERIODS)
    result = rotated_spectrum(PAIR, PERIODS)
    for name in QUANTITIES:
        for one, other in zip(
            rotation_measures(getattr(result, name)),
            rotation_measures(getattr(turned, name)),
            strict=True,
        ):
            assert_allclose(one, other, rtol=tol.ROTATED)
