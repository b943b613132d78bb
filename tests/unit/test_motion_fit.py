"""How made motions are named, drawn by chance, and told to fit."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.motions import synthesis
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import FIRST, LAST, Matched, misfit
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.spectrum import response_spectrum

MOTION = load_motion("jra-ii-i-1")


def test_misfit_is_a_root_mean_square() -> None:
    """Half too high, half too low by the same part: the mean error is nothing."""
    middle = np.sqrt(FIRST * LAST)

    def target(periods: np.ndarray) -> np.ndarray:
        own = response_spectrum(MOTION, periods).acceleration
        return np.asarray(own / np.where(periods < middle, 1.2, 0.8))

    assert_allclose(misfit(MOTION, target), 0.2, rtol=tol.LOOP)


@pytest.mark.parametrize("fit", [0.0123, 0.0249])
def test_description_tells_the_misfit_in_per_cent(
    fit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(synthesis, "matched", lambda *_, **__: Matched(MOTION.acceleration, fit))
    made = synthesis.make_motion("I", "II", 7, zone_factor=0.85)
    assert made.name == "jra-i-ii-7"
    assert f"misfit {100 * fit:.1f} % rms" in made.description
    assert "Type I, ground II, c_z = 0.85 (seed 7" in made.description
    like = synthesis.match_spectrum(MOTION, "I", "III", zone_factor=0.7)
    assert f"(misfit {100 * fit:.1f} % rms" in like.description
    assert like.name == "jra-ii-i-1-as-i-iii"


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


def test_pseudo_spectra_are_the_displacement_times_the_frequency() -> None:
    periods = np.array([0.3, 1.0, 2.0])
    found = response_spectrum(MOTION, periods, 0.02)
    omega = 2.0 * np.pi / periods
    assert_allclose(found.pseudo_velocity, omega * found.displacement, rtol=tol.LOOP)
    assert_allclose(found.pseudo_acceleration, omega**2 * found.displacement, rtol=tol.LOOP)
    # Without damping the absolute acceleration is the pseudo one.
    bare = response_spectrum(MOTION, periods, 0.0)
    assert_allclose(bare.acceleration, bare.pseudo_acceleration, rtol=tol.LOOP)


def test_peaks_come_when_they_are_told_to() -> None:
    """A pulse up after 1 s, one down after 3 s: a stiff oscillator follows the ground."""
    values = np.zeros(500)
    values[100], values[300] = 500.0, -800.0
    found = response_spectrum(GroundMotion("pulses", 0.01, values), [0.0])
    assert_allclose(found.peaks[:, 0], [500.0, 800.0])
    assert_allclose(found.peak_times[:, 0], [1.0, 3.0])
    damped = response_spectrum(GroundMotion("pulses", 0.01, values), [0.05], 0.9)
    assert_allclose(damped.peak_times[:, 0], [1.0, 3.0], atol=0.05)
