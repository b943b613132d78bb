"""Fits find what made the data, say how well, and say so when another law made them.

Shorter than benchmarks/identification.py, which does ten seeds and forty problems.
"""

from dataclasses import replace

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.parameters import default_free, with_values
from thermobearing.identify.fit.synthetic import generic_start, synthetic_record
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty.covariance import _assumed_groups
from thermobearing.identify.uncertainty.groups import chosen_groups, shift

HDR = tb.load_bearing("shen-hdr-specimen")
LHDR = tb.load_bearing("shen-lhdr-specimen")
AMBIENTS = (-20.0, 0.0, 23.0)
THREE_BEARINGS = ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example")


def true_value(bearing: tb.Bearing, key: str) -> float:
    table, name = key.split(".")
    return float(getattr(getattr(bearing, table), name))


def assert_recovered(result: Identification, truth: tb.Bearing) -> float:
    """Every well determined parameter within three standard errors and 3 %; largest error."""
    assert result.outcome == "completed"
    largest = 0.0
    for key, item in result.uncertainty.estimates.items():
        off = abs(item.value - true_value(truth, key))
        assert off <= tol.RECOVERED_ERRORS * item.stderr, (key, item)
        if item.well_determined:
            largest = max(largest, off / abs(true_value(truth, key)))
    assert largest <= tol.RECOVERED
    assert all(fit.R2 >= tol.DETERMINATION for fit in result.fits)
    return largest


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("truth", "seed", "well"),
    [
        pytest.param(HDR, 0, 6, id="HDR"),  # b is no longer: the thickness is known to 2 %
        pytest.param(HDR, 1, 6, id="HDR, other noise", marks=pytest.mark.thorough),
        pytest.param(LHDR, 0, 7, id="LHDR", marks=pytest.mark.thorough),
    ],
)
def test_recovery_from_a_blind_start(
    truth: tb.Bearing, seed: int, well: int, measured: Recorder
) -> None:
    """Table 3.4 at three temperatures with 2 % of noise, starting from nobody's values."""
    records = [synthetic_record(truth, at, seed=10 * seed + i) for i, at in enumerate(AMBIENTS)]
    records = [replace(record, ambient_uncertainty=0.0) for record in records]
    result = identify_bearing(records, generic_start(truth), seed=seed)
    largest = assert_recovered(result, truth)
    known = [e for e in result.uncertainty.estimates.values() if e.well_determined]
    assert len(known) >= well
    what = f"identified {truth.kind} parameters, largest error of the well determined"
    measured(what, largest, f"<= {tol.RECOVERED:g}")
    assert not any("more than noise" in text for text in result.warnings)


def small_problem(seed: int, memory: float) -> Identification:
    test = tb.cyclic_test(strain=[0.5, 1.5, 2.5], cycles=3, rest=600.0)
    records = [
        synthetic_record(HDR, at, test, seed=100 * seed + i, memory=memory, sampling=25.0)
        for i, at in enumerate((-20.0, 23.0))
    ]
    return identify_bearing(records, HDR, starts=1, start_from="bearing")


@pytest.mark.parametrize(
    "memory",
    [
        pytest.param(0.0, id="white", marks=pytest.mark.thorough),
        pytest.param(0.8, id="correlated", marks=pytest.mark.thorough),
    ],
)
def test_coverage_of_the_intervals(memory: float, measured: Recorder) -> None:
    """95 % intervals hold the truth that often, for white noise and for filtered noise."""
    inside = [
        item.lower <= true_value(HDR, key) <= item.upper
        for seed in range(12)
        for key, item in small_problem(seed, memory).uncertainty.estimates.items()
    ]
    share = float(np.mean(inside))
    kind = "correlated" if memory else "white"
    measured(f"share of 95 % intervals that hold the truth, {kind} noise", share, "0.85 to 0.99")
    assert tol.COVERAGE_LOW <= share <= 1.0  # 84 draws: the upper limit is left to the bench


@pytest.mark.thorough
def test_coverage_with_a_logger_that_runs_through_rests() -> None:
    """Jitter of 0.02 mm at 20 Hz; forty problems in the bench."""
    test = tb.cyclic_test(strain=[0.5, 1.5, 2.5], cycles=3, rest=60.0)
    logger = {"sampling": 20.0, "jitter": 0.02, "through_rests": True}
    inside = []
    for seed in range(3):
        records = [
            synthetic_record(HDR, at, test, seed=600 + 10 * seed + i, **logger)  # type: ignore[arg-type]
            for i, at in enumerate((-20.0, 23.0))
        ]
        result = identify_bearing(records, HDR, starts=1, start_from="bearing")
        assert min(fit.R2 for fit in result.fits) > tol.DETERMINATION
        inside += [
            item.lower <= true_value(HDR, key) <= item.upper
            for key, item in result.uncertainty.estimates.items()
        ]
    assert np.mean(inside) >= tol.COVERAGE_LOW


@pytest.mark.thorough
def test_another_law_is_noticed() -> None:
    """First cycles made 10 % stiffer on purpose: a lower R2 and plain words."""
    clean, spoilt = (
        [synthetic_record(HDR, at, noise=0.005, first_cycle=f) for at in AMBIENTS]
        for f in (1.0, 1.1)
    )
    good, bad = (
        identify_bearing(records, HDR, start_from="bearing", starts=1)
        for records in (clean, spoilt)
    )
    assert not good.warnings
    assert max(f.R2 for f in bad.fits) < min(f.R2 for f in good.fits)
    assert max(f.R2 for f in bad.fits) < tol.MODEL_ERROR_R2
    output = "\n".join(bad.warnings)
    assert "first cycles" in bad.warnings[0]  # the cause, not what follows from it
    assert "more than noise" not in output
    wider = [
        bad.uncertainty.estimates[k].stderr_of_tests / good.uncertainty.estimates[k].stderr_of_tests
        for k in good.uncertainty.estimates
    ]
    assert min(wider) > 2.0
    later = [replace(record, first_cycle_weight=0.0) for record in spoilt]
    b = identify_bearing(later, HDR, start_from="bearing", starts=1)
    key = "hysteresis.layer_stiffness"
    assert abs(b.values[key] - true_value(HDR, key)) < 0.02 * true_value(HDR, key)


def test_what_the_tests_cannot_tell_is_said() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=3, rest=None, closing_strain=None)
    record = synthetic_record(HDR, 23.0, test)
    result = identify_bearing(record, HDR, free=["alpha_0", "K_r", "s", "d_y", "b", "m_T", "n_T"])
    output = "\n".join(result.warnings)
    assert "two ambient temperatures" in output
    held = identify_bearing(record, HDR)
    assert "hysteresis.elastic_temperature_coefficient" not in held.uncertainty.estimates


def test_outliers_and_a_robust_loss() -> None:
    test = tb.cyclic_test(strain=[0.5, 2.0], cycles=3, rest=None)
    record = synthetic_record(HDR, 23.0, test, noise=0.005)
    rng = np.random.default_rng(3)
    force = record.force.copy()
    spikes = rng.choice(len(force), size=len(force) // 100, replace=False)
    force[spikes] += 0.5 * record.peak_force
    spoilt = replace(record, force=force)
    errors = {}
    for loss in ("linear", "cauchy"):
        result = identify_bearing(spoilt, HDR, loss=loss, starts=1)  # type: ignore[arg-type]
        errors[loss] = max(
            abs(item.value - true_value(HDR, key)) / abs(true_value(HDR, key))
            for key, item in result.uncertainty.estimates.items()
        )
    assert errors["cauchy"] < 0.5 * errors["linear"]


def test_thermocouples_are_fitted_and_judged() -> None:
    """Temperatures of two layers besides the force; the rise is judged by Eq. 4.39."""
    test = tb.cyclic_test(strain=[1.0, 2.0], cycles=3, rest=600.0)
    places = {"T1_degC": "rubber 1", "T3_degC": "rubber 4"}
    bare = replace(synthetic_record(HDR, 0.0, test), places=places)
    truth = ForwardModel(bare, HDR, fine=True).run(HDR)
    assert truth is not None
    assert truth.temperatures["T3_degC"].max() > truth.temperatures["T1_degC"].max()
    record = replace(bare, temperatures=truth.temperatures)
    result = identify_bearing(record, HDR, temperatures=True, starts=1)
    (fit,) = result.fits
    assert {row["thermocouple"] for row in fit.thermocouples} == set(places)
    errors = [abs(row["rise_model_K"] / row["rise_test_K"] - 1.0) for row in fit.thermocouples]
    assert max(errors) < tol.TEMPERATURE_RISE
    with pytest.raises(tb.InputError, match="6 rubber layers"):
        identify_bearing(replace(record, places={"T": "rubber 7"}), HDR)


@pytest.mark.thorough
def test_lead_rubber_bearing_with_linear_rubber() -> None:
    truth = tb.load_bearing("lrb-example")
    test = tb.cyclic_test(strain=[0.25, 1.0, 2.0], cycles=3, wave="sine", speed=200.0, rest=None)
    records = [synthetic_record(truth, at, test, seed=i) for i, at in enumerate((-10.0, 30.0))]
    result = identify_bearing(records, truth)
    symbols = {e.parameter.kind.symbol for e in result.uncertainty.estimates.values()}
    assert symbols == {"K_r", "m_T", "K_l", "sigma_Y", "E2"}  # these tests heat the lead by 100 K
    assert_recovered(result, truth)


@pytest.mark.thorough
def test_standard_errors_are_the_exact_ones_of_correlated_noise(measured: Recorder) -> None:
    """Covariance B J^T C J B of least squares, B = (J^T J)^-1, with the C that made the noise."""
    rho, noise = 0.8, 0.02
    ratios = []
    for seed in range(3):
        records = [
            synthetic_record(HDR, at, noise=noise, memory=rho, seed=30 + 10 * seed + i)
            for i, at in enumerate(AMBIENTS)
        ]
        result = identify_bearing(records, HDR, starts=1, start_from="bearing")
        jacobian = result.problem.jacobian(result.cube, fine=True, central=True)
        bread = np.linalg.inv(jacobian.T @ jacobian)
        sizes = np.cumsum([len(record.time) for record in records])[:-1]
        meat = sum(J.T @ ar1_times(J, rho) for J in np.split(jacobian, sizes))
        exact = noise * np.sqrt(np.diag(bread @ meat @ bread))
        items = result.uncertainty.estimates.values()
        slopes = [e.parameter.slope(u) for e, u in zip(items, result.cube, strict=True)]
        ratios.append(np.array([e.stderr_of_tests for e in items]) / slopes / exact)
    mean = np.mean(ratios, axis=0)
    off = float(np.abs(mean - 1.0).max())
    measured("standard errors over those of the known noise, less one", off, "<= 0.15")
    assert off <= tol.STANDARD_ERROR


def ar1_times(columns: np.ndarray, rho: float) -> np.ndarray:
    """The correlation matrix rho^|i - j| times columns, by two recursions."""
    from scipy.signal import lfilter

    ahead = lfilter([1.0], [1.0, -rho], columns, axis=0)
    back = lfilter([1.0], [1.0, -rho], columns[::-1], axis=0)[::-1]
    return np.asarray(ahead + back - columns)


SHORT = {"strain": [0.5, 1.5, 2.5], "cycles": 3, "rest": 600.0}


@pytest.mark.thorough
@pytest.mark.parametrize("yield_stress", [10.0, 14.0])
def test_yield_stress_of_lead_is_identified(yield_stress: float) -> None:
    """The file says 12 MPa; a fit that believed it would be off by a sixth elsewhere."""
    truth = with_values(LHDR, {"lead.yield_stress": yield_stress})
    test = tb.cyclic_test(**SHORT, wave="sine")
    records = [synthetic_record(truth, at, test, seed=i) for i, at in enumerate((-20.0, 23.0))]
    result = identify_bearing(records, LHDR, starts=1)
    estimates = result.uncertainty.estimates
    assert abs(result.values["lead.yield_stress"] / yield_stress - 1.0) < tol.RECOVERED
    for key, item in estimates.items():
        assert abs(item.value - true_value(truth, key)) <= tol.RECOVERED_ERRORS * item.stderr, key


@pytest.mark.parametrize(
    ("bearing", "seeds"),
    [
        pytest.param(HDR, 1, id="HDR, one file"),
        pytest.param(HDR, 3, id="HDR", marks=pytest.mark.thorough),
        pytest.param(LHDR, 3, id="LHDR", marks=pytest.mark.thorough),
    ],
)
def test_coverage_with_a_file_that_is_off(bearing: tb.Bearing, seeds: int) -> None:
    """What is not identified is off by its stated uncertainty; more seeds in the bench."""
    inside = [
        hit for seed in range(seeds) for hit in intervals_with_a_file_that_is_off(bearing, seed)
    ]
    assert np.mean(inside) >= tol.COVERAGE_LOW


def intervals_with_a_file_that_is_off(bearing: tb.Bearing, seed: int) -> list[bool]:
    """Whether the intervals of a fit hold the truth, whose other numbers the fit does not know."""
    rng = np.random.default_rng(1000 + seed)
    truth = bearing
    for group in _assumed_groups(
        bearing, default_free(bearing, (-20.0, 23.0)), chosen_groups(None)
    ):
        off = float(np.clip(rng.normal(), -2.4, 2.4))
        truth = shift(truth, group, abs(off) if group.name == "E2" else off)
    test = tb.cyclic_test(**SHORT, wave="sine" if bearing.lead else "triangular")
    records = [
        synthetic_record(truth, at, test, seed=100 * seed + i, sampling=25.0)
        for i, at in enumerate((-20.0, 23.0))
    ]
    result = identify_bearing(records, bearing, starts=1, start_from="bearing")
    return [
        item.lower <= true_value(truth, key) <= item.upper
        for key, item in result.uncertainty.estimates.items()
    ]


@pytest.mark.parametrize(
    ("slip", "words"),
    quick_cases(
        [
            ("ambients", "ambient temperatures of the tests swapped?"),
            ("clock", "the clock of the tests"),
        ],
        1,
    ),
)
def test_slips_are_reported_with_their_likely_cause(slip: str, words: str) -> None:
    test = tb.cyclic_test(**SHORT)
    records = [synthetic_record(HDR, at, test, seed=i) for i, at in enumerate((-20.0, 23.0))]
    bearing = HDR
    if slip == "ambients":
        records = [replace(r, ambient=at) for r, at in zip(records, (23.0, -20.0), strict=True)]
    elif slip == "clock":
        records = [replace(r, time=0.5 * r.time) for r in records]
    output = "\n".join(identify_bearing(records, bearing, starts=1).warnings)
    assert words in output


@pytest.mark.parametrize(
    ("bearings", "cycles", "limit", "words"),
    [
        (
            ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example"),
            (2, 3),
            tol.ZERO_OF_LEGS,
            "two or more",
        ),
        (THREE_BEARINGS[1:], (1,), tol.ZERO_OF_ONE_CYCLE, "one"),
    ],
    ids=["two cycles or more", "one cycle"],
)
def test_the_zero_of_a_force_is_that_of_the_record(
    bearings: tuple[str, ...], cycles: tuple[int, ...], limit: float, words: str, measured: Recorder
) -> None:
    """An offset of 3 kN in the cold, where each half cycle is weaker than the one before it."""
    errors = []
    for name in bearings:
        wave = "triangular" if name == "shen-hdr-specimen" else "sine"
        for count in cycles:
            test = tb.cyclic_test(strain=[1.0], cycles=count, rest=None, wave=wave)
            record = synthetic_record(name, -20.0, test, noise=0.005, seed=3)
            offsets = check_test(replace(record, force=record.force + 3.0)).offsets
            (force,) = (offset for offset in offsets if offset.name == "force")
            errors.append(abs(force.size - 3.0) / record.peak_force)
    measured(f"zero of the force over its peak, cycles: {words}", max(errors), f"<= {limit:g}")
    assert max(errors) <= limit
