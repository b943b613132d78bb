"""Parts of identification: parameters, krill herd, effective samples, quick forward model."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.border.errors import InputError
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.parameters import KINDS, _full_key, parameter_set
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.fit.search import krill_herd
from thermobearing.identify.fit.start import loop_start
from thermobearing.identify.fit.synthetic import forgotten, synthetic_record
from thermobearing.identify.records.cycles import turning_points
from thermobearing.identify.uncertainty.covariance import effective_samples

HDR, LHDR = tb.load_bearing("shen-hdr-specimen"), tb.load_bearing("shen-lhdr-specimen")
SHORT = tb.cyclic_test(strain=[0.5, 2.5], cycles=2, rest=600.0)


def test_symbols_and_keys_name_the_same() -> None:
    for kind in KINDS:
        assert _full_key(kind.symbol) == _full_key(kind.key) == kind.key
    assert _full_key("Q_l") == "lead.yield_stress"
    with pytest.raises(InputError, match="K_r"):
        _full_key("Kr")


def test_values_come_back_from_the_cube() -> None:
    found = parameter_set(LHDR, None, [-20.0, 23.0])
    assert len(found.free) == 11
    for key, value in found.values(found.start).items():
        table, name = key.split(".")
        assert_allclose(value, getattr(getattr(LHDR, table), name), rtol=tol.CONVERSION)


def test_slope_is_the_derivative() -> None:
    for p in parameter_set(LHDR, None, [-20.0, 23.0]).free:
        u, h = 0.4, 1e-6
        assert_allclose(p.slope(u), (p.at(u + h) - p.at(u - h)) / (2.0 * h), rtol=1e-6)


def test_ties_and_bounds() -> None:
    found = parameter_set(HDR, ["m_T", "n_T = 2.5 * m_T"], [23.0], {"m_T": (-2.0, 0.0)})
    values = found.values(np.array([0.25]))
    assert_allclose(values["hysteresis.elastic_temperature_coefficient"], -1.5)
    assert_allclose(values["hysteresis.hysteretic_temperature_coefficient"], -3.75)


def test_unusable_choices() -> None:
    for free, said in ((["K_l"], "no lead"), ([], "nothing is free"), (["Kr"], "K_r")):
        with pytest.raises(InputError, match=said):
            parameter_set(HDR, free, [23.0])
    with pytest.raises(InputError, match="empty"):
        parameter_set(HDR, ["K_r"], [23.0], {"K_r": (3.0, 2.0)})


def test_one_temperature_frees_no_coefficients() -> None:
    symbols = [p.kind.symbol for p in parameter_set(HDR, None, [23.0, 23.0]).free]
    assert symbols == ["alpha_0", "K_r", "s", "d_y", "b"]


def test_turns_in_noise() -> None:
    t = np.linspace(0.0, 3.0, 3001)
    x = np.sin(2.0 * np.pi * t) + np.random.default_rng(0).normal(size=len(t)) * 1e-3
    assert len(turning_points(x, 0.05)) == 2 + 6


@pytest.mark.parametrize(("bearing", "at"), [(HDR, -20.0), (LHDR, -20.0), (HDR, 23.0)])
def test_coarse_steps_are_near_all_steps(bearing: tb.Bearing, at: float) -> None:
    record = synthetic_record(bearing, at, SHORT, noise=0.0)
    coarse, fine = (ForwardModel(record, bearing, fine=fine) for fine in (False, True))
    assert coarse.steps < 0.8 * fine.steps
    a, b = coarse.run(bearing), fine.run(bearing)
    assert a is not None
    assert b is not None
    rms = float(np.sqrt(np.mean((a.force - b.force) ** 2)))
    assert rms < tol.COARSE_FORCE * record.peak_force


def test_forward_model_is_the_simulation() -> None:
    """Every step recorded: the same force as `run`, from constants that were only updated."""
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    record = synthetic_record(LHDR, 0.0, test, noise=0.0, sampling=200.0)
    model = ForwardModel(record, forgotten(LHDR), fine=True)
    predicted = model.run(LHDR)
    assert predicted is not None
    assert_allclose(predicted.force[1:], record.force[1:], atol=tol.SAME_FORCE * record.peak_force)


def test_a_weight_counts_force_and_temperature_alike() -> None:
    """Weight w makes the squared residuals of a record w times as large, row by row."""
    test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None)
    bare = replace(synthetic_record(HDR, 23.0, test, noise=0.05), places={"T": "rubber 1"})
    record = replace(bare, temperatures={"T": np.full(len(bare.time), 30.0)})
    pset = parameter_set(HDR, ["K_r"], [23.0])
    one, four = (
        Problem([replace(record, weight=weight)], pset, temperatures=True).parts(pset.start)[0]
        for weight in (1.0, 4.0)
    )
    assert np.abs(one[-len(record.time) :]).min() > 0.0  # the rows of the temperature are there
    assert_allclose(four, 2.0 * one, rtol=tol.ROUNDING)


def test_start_from_the_loops_knows_the_order_of_things() -> None:
    records = [synthetic_record(HDR, at, SHORT) for at in (-20.0, 23.0)]
    pset = parameter_set(forgotten(HDR), None, [-20.0, 23.0])
    start = loop_start(records, pset, Problem(records, pset).coarse)
    assert_allclose(start["hysteresis.layer_stiffness"], 30.7, rtol=tol.BACKBONE_START)
    assert_allclose(
        start["hysteresis.hysteretic_temperature_coefficient"], -2.19, rtol=tol.BACKBONE_START
    )


def _sphere(u: np.ndarray) -> float:
    return float(((10.0 * u - 5.0) ** 2).sum())


def _rosenbrock(u: np.ndarray) -> float:
    x = 10.0 * u - 5.0
    return float((100.0 * (x[1:] - x[:-1] ** 2) ** 2 + (1.0 - x[:-1]) ** 2).sum())


def test_krill_herd_on_known_functions(measured: Recorder) -> None:
    for name, function, limit in (
        ("sphere", _sphere, tol.KRILL_SPHERE),
        ("Rosenbrock", _rosenbrock, tol.KRILL_ROSENBROCK),
    ):
        runs = [krill_herd(function, 7, evaluations=5000, seed=seed) for seed in range(5)]
        assert all(found.evaluations <= 5000 for found in runs)
        median = float(np.median([found.value for found in runs]))
        measured(f"Krill Herd, 7-D {name}, median of 5", median, f"<= {limit:g}")
        assert median <= limit


def test_krill_herd_repeats_itself_and_takes_negative_functions() -> None:
    runs = [krill_herd(lambda u: _sphere(u) - 100.0, 3, evaluations=600, seed=4) for _ in "ab"]
    assert runs[0].value == runs[1].value < -90.0
    assert all(b <= a for a, b in zip(runs[0].history[:-1], runs[0].history[1:], strict=True))


def test_effective_samples_of_correlated_noise() -> None:
    """An AR(1) series with rho = 0.9 is worth n (1 - rho) / (1 + rho)."""
    rng, rho, n = np.random.default_rng(1), 0.9, 40_000
    x = rng.normal(size=n)
    for i in range(1, n):
        x[i] += rho * x[i - 1]
    assert_allclose(effective_samples(x), n * (1.0 - rho) / (1.0 + rho), rtol=0.2)
