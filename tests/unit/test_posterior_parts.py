"""Likelihood and bands of a fit by hand: the sampler and the model are replaced."""

import sys
from dataclasses import replace
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.test_identify_numbers import sines
from thermobearing.identify.fit.forward import Prediction
from thermobearing.identify.uncertainty import diagnosis, groups, posterior
from thermobearing.identify.uncertainty.evidence import NEGLIGIBLE


def fit_with(problem: Any, cube: np.ndarray, **uncertainty: Any) -> Any:
    (group,) = (g for g in groups.chosen_groups(None) if g.name == "b")
    assumed = SimpleNamespace(
        shifts=np.array([[0.03], [0.0]]), spread=np.array([[0.25]]),
        widening=np.array([1.5]), groups=(group,),
    )  # fmt: skip
    about = {
        "of_tests": np.diag([0.01**2, 0.02**2]), "widening": 1.2, "assumed": assumed,
        "samples": 200, "effective_samples": 50.0, "stretching": np.ones(2),
    } | uncertainty  # fmt: skip
    return SimpleNamespace(
        problem=problem, cube=cube, uncertainty=SimpleNamespace(**about), bearing="best",
        records=[sines((10.0,))], pset=SimpleNamespace(bearing=lambda place: float(place[0])),
    )  # fmt: skip


def test_posterior_is_tempered_by_what_the_samples_are_worth(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """50 of 200 samples are independent: a quarter of the textbook's log likelihood."""
    asked: list[Any] = []

    class Sampler:
        acceptance_fraction = np.array([0.4])

        def __init__(self, walkers: int, dimensions: int, _log_probability: Any) -> None:
            asked.append(_log_probability)
            self.shape = walkers, dimensions

        def run_mcmc(self, start: np.ndarray, steps: int, **_: Any) -> None:
            assert start.shape == self.shape

        def get_autocorr_time(self, **_: Any) -> np.ndarray:
            return np.array([3.0])

        def get_chain(self, **_: Any) -> np.ndarray:
            return np.zeros((5, 2))

    fake: Any = ModuleType("emcee")
    fake.EnsembleSampler = Sampler
    monkeypatch.setitem(sys.modules, "emcee", fake)
    residual = np.full(200, 0.1)
    problem = SimpleNamespace(parts=lambda u, *, fine: [residual * (1.0 + u[0])])
    result = fit_with(problem, np.array([0.0, 0.5]))
    drawn = posterior._posterior_samples(result)
    assert (drawn.source, drawn.held.shape) == ("emcee", (5, 1))
    _log_probability = asked[0]
    variance = 200 * 0.01 / 198  # of the residuals at the best place
    for place in (0.0, 0.5):
        wanted = -0.5 * 0.25 * 200 * 0.01 * (1.0 + place) ** 2 / variance
        assert _log_probability(np.array([place, 0.5])) == pytest.approx(wanted)
    assert _log_probability(np.array([0.5, 1.1])) == -np.inf


def test_band_is_that_of_95_percent_of_the_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    class Model:
        def __init__(self, *_: Any, ambient: float, **__: Any) -> None:
            asked.append(ambient)

        def rebuilt(self, _: Any) -> "Model":
            return self

        def run(self, bearing: Any) -> Prediction:
            size = 1.0 if bearing == "best" else bearing
            return Prediction(size * np.array([10.0, -20.0]), {})

    monkeypatch.setattr(posterior, "ForwardModel", Model)
    monkeypatch.setattr(posterior, "drawn_bearing", lambda _, cube, held: float(cube[0] + held[0]))
    monkeypatch.setattr(
        posterior,
        "_measure_of_test",
        lambda _: lambda force: {"force": float(np.abs(force).max())},
    )
    cube = np.column_stack([np.linspace(0.5, 1.5, 401), np.zeros(401)])
    held = np.full((401, 1), 0.25)
    draws = posterior.Samples(cube, "laplace", held)
    fit = fit_with(None, np.array([0.75, 0.5]))
    band = posterior._predictive_band(fit, draws, -30.0, count=300, seed=3)
    sizes = 0.25 + cube[np.random.default_rng(3).choice(401, size=300, replace=False), 0]
    low, high = np.quantile(sizes, [0.025, 0.975])
    assert set(asked) == {-30.0}
    assert_allclose(band.lower, [10.0 * low, -20.0 * high], rtol=tol.LOOP)
    assert_allclose(band.upper, [10.0 * high, -20.0 * low], rtol=tol.LOOP)
    peaks = (band.peak, band.peak_lower, band.peak_upper)
    assert_allclose(peaks, [20.0, 20.0 * low, 20.0 * high], rtol=tol.LOOP)
    (reported,) = posterior.Forecast(draws, (band,)).summary()["peak_force"]
    assert [reported[f"{name}_kN"] for name in ("best", "lower", "upper")] == list(peaks)
    assert reported["ambient_degC"] == -30.0


def test_shares_of_a_linear_prediction_by_hand() -> None:
    """y = 10 u_0 + 4 z, and z moves u_0 by 0.03: errors 0.12 by the tests, 0.5 * 1.5 * 4.3 by z."""
    fit = fit_with(None, np.array([0.5, 0.5]))
    errors = posterior.propagate_errors(
        fit, lambda cube, changes: {"y": float(10.0 * cube[0] + 4.0 * changes[0])}, {"y": 5.0}
    )
    error = errors["y"]
    shares, held_share = error.shares, error.share_of_held
    of_tests, of_group = (10.0 * 1.2 * 0.01) ** 2, 0.25 * (1.5 * 4.3) ** 2
    assert error.size == pytest.approx(np.sqrt(of_tests + of_group))
    assert shares["tests"] == pytest.approx(of_tests / (of_tests + of_group))
    assert shares["b"] == held_share == pytest.approx(of_group / (of_tests + of_group))


def test_draws_are_widened_as_the_intervals_are() -> None:
    """Variances of draws: those by the tests and by the group, each with its own factor."""
    cube, held = posterior._draw(fit_with(None, np.array([0.5, 0.5])), 20000, seed=1)
    assert held.std() == pytest.approx(0.5 * 1.5, rel=0.02)
    wanted = [np.hypot(1.2 * 0.01, 0.03 * 0.5 * 1.5), 1.2 * 0.02]
    assert cube.std(axis=0) == pytest.approx(wanted, rel=0.03)
    assert np.corrcoef(cube[:, 0], held[:, 0])[0, 1] > 0.85


def test_draws_at_a_bound_are_on_one_side() -> None:
    cube, _ = posterior._draw(fit_with(None, np.array([0.5, 0.0])), 400, seed=1)
    assert len(cube) == 400
    assert (cube[:, 1] > 0.0).all()
    assert np.median(cube[:, 1]) == pytest.approx(0.674 * 1.2 * 0.02, rel=0.1)  # half normal


def test_no_cause_is_named_for_no_misfit() -> None:
    """Residuals of 0.02 % are no misfit, whatever removes them."""
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    record = tb.synthetic_record("shen-hdr-specimen", 23.0, test, noise=2e-4, memory=0.9)
    exact = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    assumed = exact.uncertainty.assumed
    evidence = tuple(
        replace(item, explained=0.9, sigmas=50.0, stderr=1.0) for item in assumed.evidence
    )
    result = replace(exact.uncertainty, assumed=replace(assumed, evidence=evidence))
    assert result.rms < NEGLIGIBLE
    assert (result.suspects, diagnosis.describe_misfit(exact.problem, result)) == ([], [])
    large = replace(result, rms=2.0 * NEGLIGIBLE)
    assert large.suspects
    assert diagnosis.describe_misfit(exact.problem, large)


@pytest.mark.parametrize(("parameters", "walkers"), [(1, 4), (2, 6), (5, 15)])
def test_walkers_are_more_than_twice_the_parameters(parameters: int, walkers: int) -> None:
    result: Any = SimpleNamespace(cube=np.zeros(parameters))
    assert posterior._walkers(result) == walkers
