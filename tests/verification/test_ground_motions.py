"""Spectra against exact responses; motions that fit a spectrum and end at rest."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.shared_data import shared_data
from thermobearing.drive.motions.jra import GROUNDS, KINDS, standard_spectrum
from thermobearing.drive.motions.measures import arias_growth, measure_motion
from thermobearing.drive.motions.process import resampled
from thermobearing.drive.motions.readers import read_motion
from thermobearing.drive.motions.record import GroundMotion
from thermobearing.drive.motions.spectrum import response_spectrum
from thermobearing.drive.motions.synthesis import make_motion, match_spectrum

PERIODS = np.geomspace(0.1, 3.0, 120)


def rms(motion: GroundMotion, kind: str, ground: str) -> float:
    """Misfit of the spectrum, by a frequency grid of our own and the pseudo acceleration's peer."""
    found = response_spectrum(motion, PERIODS).acceleration / 10.0
    wanted = standard_spectrum(kind, ground, PERIODS) / 10.0
    return float(np.sqrt(np.mean((found / wanted - 1.0) ** 2)))


def test_standard_spectra_are_continuous_and_as_printed() -> None:
    corners = {
        ("I", "I"): (0.16, 0.6), ("I", "II"): (0.22, 0.9), ("I", "III"): (0.34, 1.4),
        ("II", "I"): (0.3, 0.7), ("II", "II"): (0.4, 1.2), ("II", "III"): (0.5, 1.5),
    }  # fmt: skip
    flat = {("I", "I"): 1400, ("I", "II"): 1300, ("I", "III"): 1200,
            ("II", "I"): 2000, ("II", "II"): 1750, ("II", "III"): 1500}  # fmt: skip
    for (kind, ground), ends in corners.items():
        middle = standard_spectrum(kind, ground, np.array([np.mean(ends)]))[0] / 10.0
        assert middle == pytest.approx(flat[kind, ground])
        for corner in ends:
            near = standard_spectrum(kind, ground, np.array([corner - 1e-6, corner + 1e-6])) / 10.0
            assert abs(near[0] / near[1] - 1.0) < tol.SPECTRUM_CORNER
    assert standard_spectrum("II", "I", np.array([1.0]))[0] / 10.0 == pytest.approx(1104.0)


def test_spectrum_of_a_pulse_is_exact() -> None:
    """A constant ground acceleration: u_max = (a/w^2)(1 + exp(-zeta pi/sqrt(1 - zeta^2)))."""
    motion = GroundMotion("step", 0.01, np.full(2001, 1000.0))
    damping = 0.05
    found = response_spectrum(motion, np.array([0.5, 1.0, 2.0]), damping)
    w = 2.0 * np.pi / found.periods
    overshoot = 1.0 + np.exp(-damping * np.pi / np.sqrt(1.0 - damping**2))
    assert_allclose(found.displacement, 1000.0 / w**2 * overshoot, rtol=tol.SPECTRUM_STEP)


@pytest.mark.parametrize("name", tb.list_motions())
def test_built_in_motions_fit_and_end_at_rest(name: str, measured: Recorder) -> None:
    _, kind, ground, _ = name.upper().split("-")
    motion = tb.load_motion(name)
    misfit = rms(motion, kind, ground)
    velocity, displacement = motion.velocity, motion.displacement
    measured(
        f"{name}: misfit, end velocity, largest and end displacement",
        f"{100 * misfit:.1f} %, {abs(velocity[-1]):.0e} mm/s, "
        f"{np.abs(displacement).max() / 10:.0f} cm, {abs(displacement[-1]):.0e} mm",
        f"{100 * tol.MISFIT:g} %, 0",
    )
    assert misfit < tol.MISFIT
    assert abs(velocity[-1]) < tol.STORED_END * np.abs(velocity).max()
    assert abs(displacement[-1]) < tol.STORED_END * np.abs(displacement).max()
    assert np.abs(displacement).max() < tol.FARTHEST_GROUND
    assert "NOT an accelerogram" in motion.description


def test_long_and_pulse_like() -> None:
    """Type I shakes for half a minute and more; Type II in a few strong pulses."""
    for ground in GROUNDS:
        long, short = (
            measure_motion(tb.load_motion(f"jra-{kind}-{ground.lower()}-1")) for kind in ("i", "ii")
        )
        assert long.significant_duration > 25.0
        assert short.significant_duration < 15.0
        assert short.pgv / short.pga > 0.0


def test_seeds_and_stored_motions() -> None:
    """The stored motion is the one its seed makes."""
    kind, ground = KINDS[1], GROUNDS[1]
    made = make_motion(kind, ground, 1)
    stored = tb.load_motion("jra-ii-ii-1")
    assert_allclose(made.acceleration, stored.acceleration, atol=tol.STORED_MOTION * stored.pga)
    other = tb.load_motion("jra-ii-ii-2")
    assert abs(np.corrcoef(stored.acceleration, other.acceleration)[0, 1]) < 0.5


@pytest.mark.parametrize(
    ("name", "ground"), [("TAK000.AT2", "II"), ("RSN6_IMPVALL.I_I-ELC180.AT2", "I")]
)
def test_recorded_motion_keeps_its_phases(name: str, ground: str, measured: Recorder) -> None:
    record = read_motion(shared_data(f"motions/{name}"))
    matched = match_spectrum(record, "II", ground)
    misfit = rms(matched, "II", ground)
    shift = (len(matched.acceleration) - len(record.acceleration)) // 2
    inner = matched.acceleration[shift : shift + len(record.acceleration)]
    likeness = float(np.corrcoef(inner, record.acceleration)[0, 1])
    measured(
        f"{name} adjusted to Type II, ground {ground}: misfit, correlation with the record",
        f"{100 * misfit:.1f} %, {likeness:.2f}",
        f"{100 * tol.MISFIT:g} %",
    )
    assert misfit < tol.MISFIT
    assert likeness > 0.6
    assert abs(matched.velocity[-1]) < tol.QUIET_END
    assert abs(matched.displacement[-1]) < tol.QUIET_END


def test_arias_intensity_of_a_sine() -> None:
    """pi/(2 g) a^2 t/2 over whole periods; 5 to 95 % of it in 90 % of the time."""
    time = 0.001 * np.arange(10_001)
    motion = GroundMotion("sine", 0.001, 2000.0 * np.sin(2.0 * np.pi * time))
    exact = np.pi / (2.0 * 9806.65) * 2000.0**2 * 10.0 / 2.0
    assert_allclose(arias_growth(motion)[-1], exact, rtol=1e-9)
    found = measure_motion(motion)
    assert found.significant_duration == pytest.approx(9.0, abs=0.06)
    assert_allclose(found.pgv, 2000.0 / np.pi, rtol=1e-5)
    assert_allclose(found.cumulative_absolute_velocity, 2000.0 * 20.0 / np.pi, rtol=1e-5)


def test_resampled_motion_has_the_same_spectrum() -> None:
    motion = tb.load_motion("jra-ii-i-1")
    fine = resampled(motion, 0.005)
    one, two = (response_spectrum(m, PERIODS[20:]).acceleration for m in (motion, fine))
    assert_allclose(two, one, rtol=tol.RESAMPLED_SPECTRUM)
