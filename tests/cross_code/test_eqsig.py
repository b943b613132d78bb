"""Response spectra and measures against eqsig."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.drive.motions.measures import arias_growth, significant_duration
from thermobearing.drive.motions.spectrum import response_spectrum

eqsig = pytest.importorskip("eqsig", reason="eqsig is not installed")
PERIODS = np.geomspace(0.1, 4.0, 40)


@pytest.mark.parametrize("name", ["jra-i-iii-2", "jra-ii-i-1"])
@pytest.mark.parametrize("damping", [0.02, 0.05, 0.2])
def test_pseudo_spectra(name: str, damping: float, measured: Recorder) -> None:
    """The same piecewise exact method: peaks at samples only, as eqsig takes them."""
    motion = tb.load_motion(name)
    ours = response_spectrum(motion, PERIODS, damping, steps_per_period=1)
    d, v, a = eqsig.sdof.response_series(
        motion=motion.acceleration, dt=motion.dt, periods=PERIODS, xi=damping
    )
    error = np.abs(ours.displacement / np.abs(d).max(axis=1) - 1.0).max()
    measured(
        f"response spectrum of {name}, {damping:.0%} damping, against eqsig",
        f"{error:.1e}",
        f"{tol.EQSIG:g}",
    )
    assert error < tol.EQSIG
    assert_allclose(ours.velocity, np.abs(v).max(axis=1), rtol=tol.EQSIG)
    assert a.shape == d.shape


def test_arias_intensity_and_duration() -> None:
    motion = tb.load_motion("jra-ii-i-1")
    signal = eqsig.AccSignal(motion.acceleration / 1e3, motion.dt)
    theirs = eqsig.im.calc_arias_intensity(signal)
    assert_allclose(arias_growth(motion)[-1] / 1e3, theirs[-1], rtol=tol.EQSIG_ARIAS)
    assert significant_duration(motion) == pytest.approx(
        eqsig.im.calc_sig_dur(signal), abs=2.0 * motion.dt
    )
