"""Standard spectra of Level 2 and the motions that fit them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from thermobearing.core.types import Floats
from thermobearing.motions.library import STORED, list_motions, load_motion
from thermobearing.motions.matching import Matched, matched, misfit
from thermobearing.motions.measures import measure_motion
from thermobearing.motions.process import padded, resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import ROOM, make_motion, match_spectrum
from thermobearing.motions.targets import standard_spectrum

# Type, ground: rise, first corner, plateau, second corner, fall [gal, s].
TABLE = {
    ("I", "I"): (2579, 0.16, 1400, 0.6, 840),
    ("I", "II"): (2153, 0.22, 1300, 0.9, 1170),
    ("I", "III"): (1719, 0.34, 1200, 1.4, 1680),
    ("II", "I"): (4463, 0.3, 2000, 0.7, 1104),
    ("II", "II"): (3224, 0.4, 1750, 1.2, 2371),
    ("II", "III"): (2381, 0.5, 1500, 1.5, 2948),
}
POWERS = {"I": (1.0 / 3.0, -1.0), "II": (2.0 / 3.0, -5.0 / 3.0)}


@pytest.mark.parametrize(("kind", "ground"), TABLE)
def test_branches_of_the_standard_spectra(kind: str, ground: str) -> None:
    rise, first, plateau, second, fall = TABLE[kind, ground]
    up, down = POWERS[kind]
    for period, gal in (
        (0.1, rise * 0.1**up),
        (first, plateau),
        (0.5 * (first + second), plateau),
        (second, plateau),
        (2.5, fall * 2.5**down),
    ):
        result = standard_spectrum(kind, ground, [period])
        assert_allclose(result, 10.0 * gal, rtol=1e-12)


@pytest.mark.parametrize(("kind", "ground"), TABLE)
def test_standard_spectra_are_continuous_at_their_corners(
    kind: str, ground: str, measured: Recorder
) -> None:
    for corner in (TABLE[kind, ground][1], TABLE[kind, ground][3]):
        below, above = standard_spectrum(kind, ground, [corner * (1 - 1e-9), corner * (1 + 1e-9)])
        measured("Standard spectra: jump at a corner", abs(below / above - 1.0), f"{tol.CORNER:g}")
        assert below == pytest.approx(above, rel=tol.CORNER)


def test_zone_factor_multiplies() -> None:
    whole, part = (standard_spectrum(1, 2, [0.1, 1.0], zone_factor=c) for c in (1.0, 0.7))
    assert_allclose(part, 0.7 * whole, rtol=1e-15)


def test_eighteen_motions_are_built_in() -> None:
    names = list_motions()
    wanted = [
        f"jra-{k}-{g}-{s}" for k in ("i", "ii") for g in ("i", "ii", "iii") for s in (1, 2, 3)
    ]
    assert names == sorted(wanted)
    assert STORED.stat().st_size < 1e6


@pytest.mark.parametrize("name", quick_cases(list_motions(), 0, 7, 10))
def test_built_in_motion_fits_and_ends_at_rest(name: str, measured: Recorder) -> None:
    kind, ground = name.split("-")[1:3]
    motion = load_motion(name)
    error = misfit(motion, lambda periods: standard_spectrum(kind, ground, periods), count=500)
    measured("Built-in motions: rms misfit over 0.1-3 s", error, f"{tol.MISFIT:g}")
    assert error <= tol.MISFIT
    measures = measure_motion(motion)
    assert abs(measures.end_velocity) < tol.END_VELOCITY
    assert abs(measures.end_displacement) < tol.END_DISPLACEMENT
    measured("Built-in motions: largest ground displacement [mm]", measures.pgd, "1000")
    assert measures.pgd < tol.PGD_BOUND
    assert motion.acceleration[0] == pytest.approx(0.0, abs=1e-3)
    assert "NOT an accelerogram of the specifications" in motion.description
    assert "Japan Road Association" in motion.citation


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("kind", "ground", "seed"),
    [
        pytest.param("I", "I", 1, marks=pytest.mark.thorough),
        ("II", "I", 3),
        pytest.param("II", "II", 1, marks=pytest.mark.thorough),
        pytest.param("II", "III", 1, marks=pytest.mark.thorough),
    ],
)
def test_seed_makes_the_stored_motion(
    kind: str, ground: str, seed: int, measured: Recorder
) -> None:
    made = make_motion(kind, ground, seed)
    stored = load_motion(made.name)
    assert made.description == stored.description
    error = np.abs(made.acceleration - stored.acceleration).max() / stored.pga
    measured("Built-in motions made again, of the peak", float(error), f"{tol.REMADE:g}")
    assert error < tol.REMADE
    assert abs(made.velocity[-1]) < tol.QUIET_END
    assert abs(made.displacement[-1]) < tol.QUIET_END


@pytest.mark.thorough
@pytest.mark.parametrize(("seed", "dt"), [(11, 0.01), (15, 0.005), (13, 0.02)])
def test_other_seeds_and_steps_fit_too(seed: int, dt: float) -> None:
    motion = make_motion("II", "II", seed, dt)
    assert misfit(motion, lambda t: standard_spectrum("II", "II", t)) <= tol.MISFIT
    assert motion.dt == dt


def test_matching_keeps_phases(measured: Recorder) -> None:
    """Every Fourier coefficient is turned by little; what turns it are the tapered ends."""
    record = load_motion("jra-ii-ii-1")
    fitted = match_spectrum(record, "II", "I")
    before, after = (
        np.fft.rfft(values)
        for values in (padded(record, ROOM, ROOM).acceleration, fitted.acceleration)
    )
    frequency = np.fft.rfftfreq(len(fitted.acceleration), fitted.dt)
    inside = (frequency > 0.4) & (frequency < 10.0)
    turned = np.angle(after * before.conj())[inside]
    weight = np.abs(after)[inside]
    mean = float((weight * np.abs(turned)).sum() / weight.sum())
    measured("Spectral matching: mean turn of phases [rad]", mean, f"{tol.PHASES:g}")
    assert mean < tol.PHASES


def softest(periods: Floats) -> Floats:
    return standard_spectrum("II", "III", periods)


@pytest.fixture(scope="module")
def poor() -> tuple[GroundMotion, Matched]:
    """A motion made for hard ground with room to ring, and asked to fit the softest one."""
    record = padded(resampled(load_motion("jra-ii-i-2"), 0.02), ROOM, ROOM)
    return record, matched(record.acceleration, record.dt, softest)


@pytest.mark.thorough
def test_finer_bands_fit_where_coarse_ones_cannot(poor: tuple[GroundMotion, Matched]) -> None:
    record, coarse = poor
    fine = matched(record.acceleration, record.dt, softest, finer=True)
    assert coarse.misfit > tol.MISFIT
    assert fine.misfit < tol.POOR_PHASES


@pytest.mark.thorough  # golden cases keep the misfit of motions that are made
def test_matched_reports_the_misfit_of_its_history(poor: tuple[GroundMotion, Matched]) -> None:
    record, fit = poor
    again = misfit(GroundMotion("again", record.dt, fit.acceleration), softest)
    assert fit.misfit == pytest.approx(again, rel=1e-12)
