"""Response spectra and measures against eqsig, another implementation."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from thermobearing.motions import measures
from thermobearing.motions.library import load_motion
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.motions.spectrum import response_spectrum, rotated_spectrum

eqsig = pytest.importorskip("eqsig", reason="eqsig is not installed")
MOTIONS = ["jra-i-ii-1", "jra-ii-i-2", "jra-ii-iii-3"]


@pytest.mark.parametrize("damping", quick_cases([0.02, 0.05, 0.2], 1))
@pytest.mark.parametrize("name", quick_cases(MOTIONS, 1))
def test_spectra_are_those_of_eqsig(name: str, damping: float, measured: Recorder) -> None:
    motion = load_motion(name)
    periods = np.geomspace(0.07, 5.0, 60)  # eqsig takes shorter periods as rigid
    ours = response_spectrum(motion, periods, damping, steps_per_period=1)
    u, v, a = eqsig.sdof.true_response_spectra(motion.acceleration, motion.dt, periods, damping)
    for mine, theirs in ((ours.displacement, u), (ours.velocity, v), (ours.acceleration, a)):
        measured(
            "Response spectra against eqsig",
            float(np.abs(mine / theirs - 1.0).max()),
            f"{tol.EQSIG_SPECTRUM:g}",
        )
        assert_allclose(mine, theirs, rtol=tol.EQSIG_SPECTRUM)
    _, _, pseudo = eqsig.sdof.pseudo_response_spectra(
        motion.acceleration, motion.dt, periods, damping
    )
    assert_allclose(ours.pseudo_acceleration, pseudo, rtol=tol.EQSIG_SPECTRUM)


@pytest.mark.parametrize("name", MOTIONS)
def test_measures_are_those_of_eqsig(name: str) -> None:
    motion = load_motion(name)
    other = eqsig.AccSignal(motion.acceleration, motion.dt)
    ours = measures.measure_motion(motion)
    gravity = 9.81 / STANDARD_GRAVITY  # theirs is in m and has g = 9.81 m/s2
    theirs = eqsig.im.calc_arias_intensity(other) * gravity
    near = {"rtol": tol.EQSIG_MEASURE, "atol": tol.EQSIG_MEASURE * ours.arias_intensity}
    assert_allclose(measures._arias_growth(motion), theirs, **near)
    cav = eqsig.im.calc_cav(other)[-1]
    assert ours.cumulative_absolute_velocity == pytest.approx(cav, rel=tol.EQSIG_MEASURE)
    steps = 2.0 * tol.EQSIG_DURATION * motion.dt
    assert measures.measure_motion(motion).significant_duration == pytest.approx(
        eqsig.im.calc_sig_dur(other), abs=steps
    )
    assert measures.bracketed_duration(motion) == pytest.approx(
        eqsig.im.calc_brac_dur(other, measures.BRACKET), abs=1e-9
    )
    assert ours.pga == other.pga
    assert ours.pgv == pytest.approx(np.abs(other.velocity).max(), rel=1e-9)


@pytest.mark.thorough
def test_rotated_responses_are_those_of_eqsig(measured: Recorder) -> None:
    """eqsig rotates the records, in the other sense."""
    pair = MotionPair(load_motion("jra-ii-i-1"), load_motion("jra-ii-i-2"))
    periods = np.array([0.2, 1.5])
    ours = rotated_spectrum(pair, periods, steps_per_period=1)
    records = [eqsig.AccSignal(one.acceleration, one.dt) for one in (pair.first, pair.second)]
    for place, period in enumerate(periods):

        def _pseudo(one: Any, period: float = float(period)) -> float:
            result = eqsig.sdof.pseudo_response_spectra(
                one.values, one.dt, np.array([period]), 0.05
            )
            return float(result[2][0])

        degrees, theirs = eqsig.compute_rotated(*records, func=_pseudo, points=13)
        places = np.round(-degrees).astype(int) % 180
        mine = ours.pseudo_acceleration[places, place]
        measured(
            "Responses to rotated pairs against eqsig",
            float(np.abs(mine / theirs - 1.0).max()),
            f"{tol.EQSIG_SPECTRUM:g}",
        )
        assert_allclose(mine, theirs, rtol=tol.EQSIG_SPECTRUM)
