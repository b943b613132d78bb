"""Ground motions processed, measured and made to fit a spectrum."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.core.types import Floats
from thermobearing.motions import measures, process, record, synthesis
from thermobearing.motions.library import list_motions, load_motion
from thermobearing.motions.matching import FIRST, LAST, Matched, misfit
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.motions.synthesis import Pulse, _near_fault, _phases

DT = 0.01
TIME = np.arange(4001) * DT


def sine(frequency: float) -> record.GroundMotion:
    return record.GroundMotion("sine", DT, 1000.0 * np.sin(2.0 * np.pi * frequency * TIME))


@settings(max_examples=30, derandomize=True, deadline=None, database=None)
@given(st.integers(0, 1000), st.integers(16, 3000), st.sampled_from([0.002, 0.01, 0.02]))
def test_quiet_end_for_any_motion(seed: int, count: int, dt: float) -> None:
    values = 1000.0 * np.random.default_rng(seed).standard_normal(count)
    quiet = process.with_quiet_end(values, dt)
    assert abs(record._integrate_velocity(quiet, dt)[-1]) < tol.QUIET_END
    assert abs(record.integrate_displacement(quiet, dt)[-1]) < tol.QUIET_END
    assert quiet[0] == pytest.approx(values[0])
    assert_allclose(process.with_quiet_end(quiet, dt), quiet, atol=1e-6)


def test_quiet_end_of_several_rows_is_that_of_each() -> None:
    rows = np.random.default_rng(1).standard_normal((3, 500))
    together = process.with_quiet_end(rows, DT)
    for row, quiet in zip(rows, together, strict=True):
        assert_allclose(quiet, process.with_quiet_end(row, DT), atol=1e-12)


@pytest.mark.parametrize("high_pass", [None, 0.05])
def test_drift_is_taken_out_and_the_spectrum_stays(high_pass: float | None) -> None:
    clean = load_motion("jra-ii-i-1")
    tilt = 5.0 + 0.3 * clean.time
    tilted = record.GroundMotion("tilted", clean.dt, clean.acceleration + tilt)
    assert np.abs(tilted.displacement).max() > 8000.0
    mended = process.baseline_corrected(tilted, high_pass=high_pass)
    assert abs(mended.velocity[-1]) < tol.QUIET_END
    assert abs(mended.displacement[-1]) < tol.QUIET_END
    assert np.abs(mended.displacement).max() < tol.PGD_BOUND
    periods = np.geomspace(0.1, 3.0, 50)
    one, other = (response_spectrum(m, periods).acceleration for m in (clean, mended))
    assert_allclose(other, one, rtol=0.03)


def test_finer_step_is_the_same_motion() -> None:
    motion = load_motion("jra-ii-ii-2")
    fine = process.resampled(motion, 0.0025)
    assert fine.dt == 0.0025
    assert fine.duration == pytest.approx(motion.duration)
    assert_allclose(fine.acceleration[::4], motion.acceleration, rtol=0.0, atol=0.0)
    assert fine.velocity[-1] == pytest.approx(motion.velocity[-1], abs=1e-6)
    periods = [0.2, 1.0, 2.0]
    one, other = (response_spectrum(m, periods, steps_per_period=400) for m in (motion, fine))
    assert_allclose(other.displacement, one.displacement, rtol=1e-4)
    assert process.resampled(motion, motion.dt) is motion


@pytest.mark.parametrize("dt", [0.02, 0.025, 0.04])
def test_coarser_step_does_not_fold_back(dt: float) -> None:
    middle = slice(round(5.0 / dt), round(35.0 / dt))
    limit = 0.5 / dt
    gone = process.resampled(sine(1.4 * limit), dt)
    assert np.abs(gone.acceleration[middle]).max() < 1000.0 * tol.STOPBAND
    kept = process.resampled(sine(0.3 * limit), dt)
    wanted = 1000.0 * np.sin(2.0 * np.pi * 0.3 * limit * kept.time)
    assert np.abs(kept.acceleration - wanted)[middle].max() < 1000.0 * tol.PASSBAND
    # Taking every n-th sample would have kept it at another frequency.
    assert kept.dt == pytest.approx(dt)


def test_drift_is_the_second_derivative_of_a_polynomial() -> None:
    """Displacement t^2 to t^6 of a whole record is drift and nothing else; a sine stays."""
    x = TIME / TIME[-1]
    powers = np.arange(2, 7)
    drift = (powers * (powers - 1) * x[:, np.newaxis] ** (powers - 2)).sum(axis=1)
    wave = np.sin(2.0 * np.pi * 2.0 * TIME) * np.sin(np.pi * x) ** 2
    mended = process.baseline_corrected(record.GroundMotion("drift", DT, 10.0 * drift + wave))
    assert_allclose(mended.acceleration, wave, atol=0.02)


def test_sixteen_samples_are_enough_for_a_baseline() -> None:
    process.baseline_corrected(record.GroundMotion("short", DT, np.sin(np.arange(16.0))))
    with pytest.raises(tb.InputError, match="15 samples"):
        process.baseline_corrected(record.GroundMotion("short", DT, np.sin(np.arange(15.0))))


def test_high_pass_gain_is_that_of_a_filter_run_twice() -> None:
    """Fourth order, both ways: a half at the corner, (f/f_c)^8 far below."""
    gain = process.high_pass_gain(np.array([0.5, 1.0, 2.0]), 1.0)
    assert_allclose(gain, [1.0 / 257.0, 0.5, 256.0 / 257.0], rtol=tol.LOOP)


def test_step_that_does_not_divide() -> None:
    motion = sine(2.0)
    other = process.resampled(motion, 0.006)
    middle = slice(round(5.0 / 0.006), round(35.0 / 0.006))
    wanted = 1000.0 * np.sin(4.0 * np.pi * other.time)
    assert np.abs(other.acceleration - wanted)[middle].max() < 1000.0 * tol.PASSBAND
    assert other.duration == pytest.approx(motion.duration, abs=0.012)


def test_padded_with_rest() -> None:
    motion = load_motion("jra-i-i-1")
    longer = process.padded(motion, 1.0, 2.5)
    expected = np.concatenate([np.zeros(100), motion.acceleration, np.zeros(250)])
    assert_allclose(longer.acceleration, expected)
    assert (longer.name, longer.citation) == (motion.name, motion.citation)


def test_significant_interval_lies_where_the_shaking_is() -> None:
    """Even shaking from 10 to 20 s: 5 % of it after half a second, 95 % half a second early."""
    values = np.zeros(3001)
    values[1000:2001] = 600.0
    even = record.GroundMotion("even", DT, values)
    assert_allclose(measures.significant_interval(even), [10.5, 19.5], atol=0.5 * DT)
    assert measures.measure_motion(even).significant_duration == pytest.approx(9.0, abs=0.02)
    assert measures.bracketed_duration(even) == pytest.approx(10.0)
    assert measures.bracketed_duration(even, 700.0) == 0.0
    steps = record.GroundMotion("steps", 1.0, np.array([0.0, 1.0, 1.0, 1.0, 0.0]))
    # growth 0, 1/2, 3/2, 5/2, 3: linear between the samples
    assert_allclose(measures.significant_interval(steps), [0.3, 3.7], rtol=tol.LOOP)
    assert_allclose(measures.significant_interval(steps, 0.5, 1.0), [2.0, 4.0], rtol=tol.LOOP)


def test_measures_by_hand() -> None:
    """A downward block of 1 m/s2 for 2 s, one upwards of 0.5 m/s2 for 2 s, samples every second."""
    motion = record.GroundMotion(
        "blocks", 1.0, np.array([0.0, -1000.0, -1000.0, 500.0, 500.0, 0.0])
    )
    m = measures.measure_motion(motion)
    velocity = np.array([0.0, -500.0, -1500.0, -1750.0, -1250.0, -1000.0])
    assert_allclose(motion.velocity, velocity, rtol=tol.LOOP)
    # Straight lines of acceleration: v dt + (2 a0 + a1) dt^2 / 6
    steps = velocity[:-1] + np.array([-1000.0, -3000.0, -1500.0, 1500.0, 1000.0]) / 6.0
    assert_allclose(motion.displacement, np.concatenate([[0.0], np.cumsum(steps)]), rtol=tol.LOOP)
    assert m.pga == 1000.0
    assert m.pgv == 1750.0
    assert m.end_velocity == -1000.0
    assert m.end_displacement == pytest.approx(steps.sum(), rel=tol.LOOP)
    assert m.pgd == pytest.approx(-steps.sum(), rel=tol.LOOP)
    squares = 1e6 * (0.5 + 1.0 + 0.625 + 0.25 + 0.125)
    assert m.arias_intensity == pytest.approx(np.pi / 2.0 / 9806.65 * squares, rel=tol.LOOP)
    assert m.cumulative_absolute_velocity == pytest.approx(500 + 1000 + 750 + 500 + 250)
    assert m.bracketed_duration == 1.0  # beyond 50 gal (500 mm/s2) at 1 and 2 s only
    assert motion.duration == 5.0


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("g", 9806.65),
        ("Gal", 10.0),
        ("cm/sec^2", 10.0),
        ("CM/S/S", 10.0),
        ("m/s²", 1000.0),
        ("m / s ** 2", 1000.0),
        ("mm/s2", 1.0),
    ],
)
def test_spellings_of_units(text: str, size: float) -> None:
    assert record.acceleration_unit(text) == size


MOTION = load_motion("jra-ii-i-1")


def test_misfit_is_a_root_mean_square() -> None:
    """Half too high, half too low by the same part: the mean error is nothing."""
    middle = np.sqrt(FIRST * LAST)

    def target(periods: np.ndarray) -> np.ndarray:
        own = response_spectrum(MOTION, periods).acceleration
        return np.asarray(own / np.where(periods < middle, 1.2, 0.8))

    assert_allclose(misfit(MOTION, target), 0.2, rtol=tol.LOOP)


def test_best_of_the_draws_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """Phases are drawn again until a fit is good enough, eight times at most."""
    offered = iter([0.05, 0.04, 0.03, 0.024, 0.01])
    asked: list[float] = []

    def fit(values: np.ndarray, *_: object, **__: object) -> Matched:
        asked.append(float(values[1000]))
        return Matched(values, next(offered))

    monkeypatch.setattr(synthesis, "matched", fit)
    made = synthesis.make_motion("II", "I", 1)
    assert "misfit 2.4 %" in made.description
    assert len(set(asked)) == 4
    offered = iter([0.05, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.01])
    assert "misfit 3.0 %" in synthesis.make_motion("II", "I", 1).description


def test_every_motion_has_its_own_noise() -> None:
    draws = [
        synthesis._phases(kind, ground, seed, draw, 0.01)[:5000]
        for kind, ground, seed, draw in (
            ("I", "I", 1, 0), ("I", "II", 1, 0), ("I", "III", 1, 0), ("I", "I", 2, 0),
            ("I", "I", 1, 1),
        )
    ]  # fmt: skip
    alike = np.corrcoef(draws) - np.eye(len(draws))
    assert np.abs(alike).max() < tol.OTHER_NOISE


def test_envelope_rises_stays_and_dies_away() -> None:
    shape = synthesis.SHAPES["II"]
    time = np.array([4.0, 5.0, 7.0, 9.0, 12.0, 15.5])
    result = shape._envelope(time)
    assert_allclose(result, [0.0, 0.0, 0.25, 1.0, 1.0, np.exp(-1.0)], rtol=tol.LOOP)


def test_peaks_come_when_they_are_reported_to() -> None:
    """A pulse up after 1 s, one down after 3 s: a stiff oscillator follows the ground."""
    values = np.zeros(500)
    values[100], values[300] = 500.0, -800.0
    result = response_spectrum(record.GroundMotion("pulses", 0.01, values), [0.0])
    assert_allclose(result.peaks[:, 0], [500.0, 800.0])
    assert_allclose(result.peak_times[:, 0], [1.0, 3.0])
    damped = response_spectrum(record.GroundMotion("pulses", 0.01, values), [0.05], 0.9)
    assert_allclose(damped.peak_times[:, 0], [1.0, 3.0], atol=0.05)


NAME = "jra-ii-ii-1"
OWN = _near_fault()[NAME]
SOURCE_PEAK, HALF_A_SECOND, USED = 8.0, 0.5, 20.0  # s: section 3.4.4, one digit; section 4.4


def peak_time(motion: record.GroundMotion) -> float:
    return float(np.abs(motion.acceleration).argmax()) * motion.dt


def share_of_pulse(motion: record.GroundMotion) -> float:
    """How much of the velocity's square, while the pulse lasts, is the pulse at its best size."""
    time = np.arange(len(motion.acceleration)) * motion.dt
    inside = np.abs(time - OWN.pulse.time) <= 0.5 * OWN.pulse.cycles * OWN.pulse.period
    velocity, pulse = motion.velocity[inside], OWN.pulse.velocity(time)[inside]
    return float((velocity @ pulse) ** 2 / ((velocity @ velocity) * (pulse @ pulse)))


def test_peak_is_where_the_source_has_it() -> None:
    result = peak_time(load_motion(NAME))
    assert result == pytest.approx(OWN.peak_time, abs=tol.PEAK_OF_STREAM)
    assert OWN.peak_time == SOURCE_PEAK
    assert abs(result - SOURCE_PEAK) < HALF_A_SECOND
    assert result < USED


def test_pulse_is_the_largest_swing() -> None:
    """It is still there after the fit, and no other motion of the type has it by chance."""
    motion = load_motion(NAME)
    when = float(np.abs(motion.velocity).argmax()) * motion.dt
    assert abs(when - OWN.pulse.time) < 0.5 * OWN.pulse.period
    assert share_of_pulse(motion) > tol.SHARE_OF_PULSE
    others = [name for name in list_motions() if name.startswith("jra-ii-") and name != NAME]
    assert max(share_of_pulse(load_motion(name)) for name in others) < tol.SHARE_BY_CHANCE


@pytest.mark.parametrize("cycles", [1.3, 2.0, 3.0])
@pytest.mark.parametrize("phase", [0.0, 1.0, 4.7])
def test_pulse_by_hand(cycles: float, phase: float) -> None:
    """Its middle, its ends, and its acceleration against the acceleration's own integral."""
    pulse = Pulse(amplitude=100.0, period=1.6, cycles=cycles, phase=phase, time=5.0)
    assert_allclose(pulse.velocity(np.array([5.0])), 100.0 * np.cos(phase), rtol=tol.LOOP)
    end = 0.5 * cycles * 1.6
    beside = np.array([5.0 - end - 1e-6, 5.0 + end + 1e-6, 0.0, 50.0])
    assert not pulse.velocity(beside).any()
    assert not pulse.acceleration(beside).any()
    dt = 1e-3
    time = np.arange(10_001) * dt
    velocity = record._integrate_velocity(pulse.acceleration(time), dt)
    assert_allclose(velocity, pulse.velocity(time), atol=tol.PULSE_INTEGRAL)


def test_noise_has_the_strength_that_the_file_says() -> None:
    dt = 0.01

    def noise(draw: int) -> Floats:
        values = _phases("II", "II", 1, draw, dt)
        return values - OWN.pulse.acceleration(OWN.shape._times(dt))

    strong = slice(round(OWN.shape.strong / dt), round(OWN.shape.end / dt))
    parts = np.array([noise(draw)[strong] for draw in range(20)])
    assert np.sqrt(np.mean(parts**2)) == pytest.approx(OWN.noise, rel=tol.NOISE_STRENGTH)
    assert abs(np.corrcoef(parts[:2])[0, 1]) < tol.OTHER_DRAW


def test_design_of_the_bridge_closes_on_its_stand_ins() -> None:
    """Section 6.2.2: the largest displacement differs from the design's by at most 10 %."""
    motions = [f"jra-{kind}-i-{seed}" for kind in ("i", "ii") for seed in (1, 2, 3)]
    table = tb.bridge("shen-bilinear-bridge", motions, 23.0, keep=tb.Keep(every=1000)).table
    closed = table["bearing_strain_max"].to_numpy(dtype=float) * 112.0 / 178.0
    assert_allclose(closed[3:], [1.062, 1.077, 0.939], atol=0.001)
    assert np.abs(closed[:3].mean() - 1.0) < 0.1  # Type I by the mean of the three waves
    assert np.abs(closed[3:] - 1.0).max() < 0.1
