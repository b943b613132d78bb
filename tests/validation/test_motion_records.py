"""Real records: every format is read, with the sizes that their table tells."""

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.shared_data import shared_data
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import misfit
from thermobearing.motions.measures import significant_interval
from thermobearing.motions.process import baseline_corrected, resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import ROOM, _near_fault, match_spectrum
from thermobearing.motions.targets import standard_spectrum

KOBE, TAKATORI = "jma_kobe_ns_ew_gal_dt0.005.txt", "TAK000.AT2"
# file, component, time step [s], samples, largest acceleration [gal]
RECORDS = [
    (KOBE, "NS", 0.005, 6000, 825.0),
    (KOBE, "EW", 0.005, 6000, 619.0),
    (TAKATORI, None, 0.01, 4096, 605.8),
    ("RSN6_IMPVALL.I_I-ELC180.AT2", None, 0.01, 5372, 275.4),
    ("STAIRlab_elCentro.at2", None, 0.02, 1559, 312.7),
    ("RSN1546_CHICHI_TCU122-N.AT2", None, 0.005, 18000, 256.0),
    ("TKYH121103111446.NS2", None, 0.01, 30000, 157.2),
    ("TKYH121103111446.EW2", "EW", 0.01, 30000, 105.9),
    ("TKYH121103111446.UD2", None, 0.01, 30000, 65.5),
    ("Q4149CF2.csv", "NS", 0.01, 30000, 327.0),
    ("KNG007_NS_t_g.txt", None, 0.02, 15000, 230.3),
    ("II-I-1_like_JMA_NS.csv", None, 0.01, 4998, 827.0),
    ("II-I-2_like_JMA_EW.csv", None, 0.01, 5000, 802.0),
    ("II-II-1_like_TAK000.csv", None, 0.01, 4096, 607.0),
]


def record(name: str, component: str | None = None) -> GroundMotion:
    return load_motion(shared_data(f"motions/{name}"), component=component)


@pytest.mark.parametrize(
    ("name", "component", "dt", "samples", "pga"), quick_cases(RECORDS, 0, 2, 3, 6)
)
def test_record_has_the_size_of_the_table(
    name: str, component: str | None, dt: float, samples: int, pga: float
) -> None:
    motion = record(name, component)
    assert motion.dt == pytest.approx(dt, rel=tol.RECORD_STEP)
    assert len(motion.acceleration) == samples
    assert motion.pga / 10.0 == pytest.approx(pga, rel=tol.RECORD_PGA)
    assert motion.name == name.rsplit(".", 1)[0]


@pytest.mark.parametrize("component", quick_cases(["NS", "EW", "UD", "1", 2, "ud"], 0, 4))
def test_jma_file_holds_three_components(component: str | int) -> None:
    motion = load_motion(shared_data("motions/Q4149CF2.csv"), component=component)
    assert len(motion.acceleration) == 30000
    assert "宇城市松橋町" in motion.description


@pytest.mark.parametrize(
    ("name", "component"), quick_cases([row[:2] for row in RECORDS], 0, 1, 2, 3)
)
def test_corrected_record_ends_at_rest(name: str, component: str | None) -> None:
    motion = baseline_corrected(record(name, component), high_pass=0.1)
    assert abs(motion.velocity[-1]) < tol.QUIET_END
    assert abs(motion.displacement[-1]) < tol.QUIET_END
    if "_like_" not in name:  # those were made without regard to their long periods
        assert np.abs(motion.displacement).max() < tol.PGD_BOUND


# One record and ground, and all with all of them where everything is run.
@cache
def fit_record(name: str, component: str | None, ground: str) -> GroundMotion:
    return match_spectrum(record(name, component), "II", ground)


FITTED = [
    pytest.param(
        name, component, ground, marks=[] if first == second == 0 else [pytest.mark.thorough]
    )
    for first, (name, component) in enumerate([(KOBE, "NS"), (KOBE, "EW"), (TAKATORI, None)])
    for second, ground in enumerate(["I", "II", "III"])
]


@pytest.mark.parametrize(("name", "component", "ground"), FITTED)
def test_kobe_records_fit_type_ii(
    name: str, component: str | None, ground: str, measured: Recorder
) -> None:
    fitted = fit_record(name, component, ground)
    error = misfit(fitted, lambda periods: standard_spectrum("II", ground, periods))
    measured("Spectral matching of Kobe records: rms misfit", error, f"{tol.MISFIT:g}")
    assert error <= tol.MISFIT
    assert abs(fitted.velocity[-1]) < tol.QUIET_END
    assert abs(fitted.displacement[-1]) < tol.QUIET_END
    assert np.abs(fitted.displacement).max() < tol.PGD_BOUND


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["KNG007_NS_t_g.txt", "TKYH121103111446.NS2"])
def test_long_records_fit_type_i(name: str) -> None:
    fitted = match_spectrum(record(name), "I", "I")
    assert misfit(fitted, lambda t: standard_spectrum("I", "I", t)) <= tol.MISFIT
    assert np.abs(fitted.displacement).max() < tol.PGD_BOUND


@pytest.mark.parametrize(
    ("name", "component", "ground", "given"),
    quick_cases(
        [
            (KOBE, "NS", "I", "II-I-1_like_JMA_NS.csv"),
            (KOBE, "EW", "I", "II-I-2_like_JMA_EW.csv"),
            (TAKATORI, None, "II", "II-II-1_like_TAK000.csv"),
        ],
        0,
    ),
)
def test_same_as_given_motions_of_the_same_phases(
    name: str, component: str | None, ground: str, given: str, measured: Recorder
) -> None:
    fitted = fit_record(name, component, ground)
    ours = resampled(fitted, 0.01).acceleration[round(ROOM / 0.01) :]
    theirs = record(given).acceleration
    # The given motion may begin earlier or later than the record, or point the other way; it
    # was made without regard to what velocity and displacement come to.
    both = np.correlate(theirs, ours[: len(theirs) - 1000], "full")
    whole = max(abs(both.max()), abs(both.min()))
    whole /= np.linalg.norm(theirs) * np.linalg.norm(ours[: len(theirs) - 1000])
    measured(f"Correlation with {given}", f"{whole:.3f}", f"at least {tol.STAND_IN:g}")
    assert whole > tol.STAND_IN


def test_stand_in_grows_as_the_record(measured: Recorder) -> None:
    """Arias intensity of the built-in II-II-1 against Takatori's, as recorded and fitted."""
    own = _near_fault()["jra-ii-ii-1"]
    built_in = load_motion("jra-ii-ii-1")
    raw, fitted = record(TAKATORI), record("II-II-1_like_TAK000.csv")
    shares = (0.05, 0.25, 0.5, 0.75, 0.95)
    times = [
        np.array([significant_interval(motion, 0.0, share)[1] for share in shares])
        for motion in (built_in, raw, fitted)
    ]
    reported = ["; ".join(f"{time:.1f}" for time in some) for some in times]
    measured(
        "jra-ii-ii-1: 5, 25, 50, 75, 95 % of the Arias intensity, s",
        reported[0],
        "between the next two, 1 s more at most",
    )
    measured("Takatori: the same, s", reported[1], "PEER, TAK000")
    measured("Takatori fitted to the spectrum: the same, s", reported[2], "the same phases")
    assert np.all(times[0] > np.minimum(times[1], times[2]) - tol.GROWTH_OF_RECORD)
    assert np.all(times[0] < np.maximum(times[1], times[2]) + tol.GROWTH_OF_RECORD)
    # The fastest ground is in the same pulse, half a period away or less.
    fastest = [float(np.abs(m.velocity).argmax()) * m.dt for m in (built_in, raw)]
    assert abs(fastest[0] - fastest[1]) < 0.5 * own.pulse.period
    # Largest acceleration at the same time as that of the record when it fits the spectrum.
    peaks = [float(np.abs(m.acceleration).argmax()) * m.dt for m in (built_in, fitted)]
    assert abs(peaks[0] - peaks[1]) < tol.PEAK_OF_STREAM


def test_network_maximum_is_that_of_the_numbers() -> None:
    assert_allclose(record("TKYH121103111446.NS2").pga, 1571.80, atol=0.01)
