"""Motions made to fit a spectrum: names, draws, misfit, near-fault phases."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.core.types import Floats
from thermobearing.motions import synthesis
from thermobearing.motions.library import list_motions, load_motion
from thermobearing.motions.matching import FIRST, LAST, Matched, misfit
from thermobearing.motions.record import GroundMotion, integrate_velocity
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.motions.synthesis import Pulse, near_fault, phases

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
        synthesis.phases(kind, ground, seed, draw, 0.01)[:5000]
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
    found = shape.envelope(time)
    assert_allclose(found, [0.0, 0.0, 0.25, 1.0, 1.0, np.exp(-1.0)], rtol=tol.LOOP)


def test_peaks_come_when_they_are_told_to() -> None:
    """A pulse up after 1 s, one down after 3 s: a stiff oscillator follows the ground."""
    values = np.zeros(500)
    values[100], values[300] = 500.0, -800.0
    found = response_spectrum(GroundMotion("pulses", 0.01, values), [0.0])
    assert_allclose(found.peaks[:, 0], [500.0, 800.0])
    assert_allclose(found.peak_times[:, 0], [1.0, 3.0])
    damped = response_spectrum(GroundMotion("pulses", 0.01, values), [0.05], 0.9)
    assert_allclose(damped.peak_times[:, 0], [1.0, 3.0], atol=0.05)


NAME = "jra-ii-ii-1"
OWN = near_fault()[NAME]
SOURCE_PEAK, HALF_A_SECOND, USED = 8.0, 0.5, 20.0  # s: section 3.4.4, one digit; section 4.4


def peak_time(motion: GroundMotion) -> float:
    return float(np.abs(motion.acceleration).argmax()) * motion.dt


def share_of_pulse(motion: GroundMotion) -> float:
    """How much of the velocity's square, while the pulse lasts, is the pulse at its best size."""
    time = np.arange(len(motion.acceleration)) * motion.dt
    inside = np.abs(time - OWN.pulse.time) <= 0.5 * OWN.pulse.cycles * OWN.pulse.period
    velocity, pulse = motion.velocity[inside], OWN.pulse.velocity(time)[inside]
    return float((velocity @ pulse) ** 2 / ((velocity @ velocity) * (pulse @ pulse)))


def test_peak_is_where_the_source_has_it() -> None:
    found = peak_time(load_motion(NAME))
    assert found == pytest.approx(OWN.peak_time, abs=tol.PEAK_OF_STREAM)
    assert OWN.peak_time == SOURCE_PEAK
    assert abs(found - SOURCE_PEAK) < HALF_A_SECOND
    assert found < USED


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
    velocity = integrate_velocity(pulse.acceleration(time), dt)
    assert_allclose(velocity, pulse.velocity(time), atol=tol.PULSE_INTEGRAL)


def test_noise_has_the_strength_that_the_file_says() -> None:
    dt = 0.01

    def noise(draw: int) -> Floats:
        values = phases("II", "II", 1, draw, dt)
        return values - OWN.pulse.acceleration(OWN.shape.times(dt))

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
