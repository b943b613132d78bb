"""Shares of variance against functions whose shares are known, and against scipy."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import qmc
from scipy.stats import sobol_indices as of_scipy

from tests import tolerances
from thermobearing.studies.statistics.variance import sobol_indices, sobol_table, variance_shares

# Ishigami & Homma (1990) with a = 7, b = 0.1: indices in closed form (Saltelli and others 2008).
A, B = 7.0, 0.1
WHOLE = A**2 / 8.0 + B * np.pi**4 / 5.0 + B**2 * np.pi**8 / 18.0 + 0.5
ONE = 0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2
BOTH = 8.0 * B**2 * np.pi**8 / 225.0
FIRST = np.array([ONE, A**2 / 8.0, 0.0]) / WHOLE
TOTAL = np.array([ONE + BOTH, A**2 / 8.0, BOTH]) / WHOLE


def ishigami(x: np.ndarray) -> np.ndarray:
    return np.sin(x[..., 0]) + A * np.sin(x[..., 1]) ** 2 + B * x[..., 2] ** 4 * np.sin(x[..., 0])


def arranged(rows: int, rng: np.random.Generator, *, sobol: bool) -> list[np.ndarray]:
    points = qmc.Sobol(6, rng=rng).random(rows) if sobol else rng.random((rows, 6))
    a, b = np.pi * (2.0 * points[:, :3] - 1.0), np.pi * (2.0 * points[:, 3:] - 1.0)
    swapped = [np.where(np.arange(3) == k, b, a) for k in range(3)]
    return [ishigami(x) for x in (a, b, *swapped)]


def as_table(values: list[np.ndarray]) -> pd.DataFrame:
    names = ["A", "B", "AB x1", "AB x2", "AB x3"]
    frames = [
        pd.DataFrame({"matrix": name, "sample": np.arange(len(y)), "drift": y})
        for name, y in zip(names, values, strict=True)
    ]
    return pd.concat(frames, ignore_index=True).assign(outcome="completed")


def test_ishigami() -> None:
    a, b, *swapped = arranged(2**14, np.random.default_rng(1), sobol=True)
    first, total = sobol_indices(a, b, np.array(swapped))
    assert first == pytest.approx(FIRST, abs=tolerances.SOBOL_INDEX)
    assert total == pytest.approx(TOTAL, abs=tolerances.SOBOL_INDEX)


def test_the_estimators_of_scipy() -> None:
    a, b, *swapped = arranged(256, np.random.default_rng(2), sobol=True)
    given = {"f_A": a[None], "f_B": b[None], "f_AB": np.array(swapped)[:, None, :]}
    theirs = of_scipy(func=given, n=256)
    first, total = sobol_indices(a, b, np.array(swapped))
    assert first == pytest.approx(theirs.first_order.ravel(), abs=tolerances.SAME_ESTIMATOR)
    assert total == pytest.approx(theirs.total_order.ravel(), abs=tolerances.SAME_ESTIMATOR)


def test_bands_of_indices_hold_the_truth_as_often_as_they_say() -> None:
    rng = np.random.default_rng(6)
    held, times = np.zeros(6), 60
    for seed in range(times):
        table = as_table(arranged(300, rng, sobol=False))
        found = sobol_table(table, "drift", samples=119, seed=seed)
        held[:3] += (found["first_low"] <= FIRST) & (found["first_high"] >= FIRST)
        held[3:] += (found["total_low"] <= TOTAL) & (found["total_high"] >= TOTAL)
    assert held.min() / times > tolerances.LEAST_COVERAGE
    assert held.mean() < times


def test_a_failed_run_leaves_all_matrices() -> None:
    values = arranged(64, np.random.default_rng(3), sobol=True)
    table = as_table(values)
    table.loc[[5, 64 + 7], "outcome"] = "not_converged"
    kept = ~np.isin(np.arange(64), [5, 7])
    found = sobol_table(table, "drift", samples=10)
    first, total = sobol_indices(values[0][kept], values[1][kept], np.array(values[2:])[:, kept])
    assert found["first"].to_numpy() == pytest.approx(first)
    assert found["total"].to_numpy() == pytest.approx(total)
    assert found[["rows", "left_out"]].iloc[0].tolist() == [62, 2]


def test_correlation_ratio_of_a_sum_and_a_product() -> None:
    """x + 2 y + 3 x y of levels -1 and 1: shares 1, 4 and 9 of 14."""
    rows = [(x, y, x + 2 * y + 3 * x * y) for x in (-1, 1) for y in (-1, 1) for _ in range(500)]
    table = pd.DataFrame(rows, columns=["x", "y", "drift"])
    found = variance_shares(table, "drift", ["x", "y"])
    shares = np.array([1.0, 4.0, 9.0]) / 14.0
    assert found["share"].to_numpy() == pytest.approx(shares, abs=tolerances.CHANCE_OF_2000)


def test_correlation_ratio_of_draws_has_no_bias_and_holds_the_truth() -> None:
    """Levels drawn by lot, 1 and 4 parts of 6, one that does nothing, and numbers in classes."""
    rng = np.random.default_rng(7)
    held, times, mean = np.zeros(4), 60, np.zeros(4)
    truth = np.array([1.0, 4.0, 0.0, 1.0]) / 6.0
    for seed in range(times):
        x, y, level = rng.integers(0, 10, (3, 300))  # of variance (100 - 1) / 12
        number = rng.normal(size=300)
        drift = (x + 2.0 * y) / np.sqrt(99.0 / 12.0) + number
        table = pd.DataFrame({"x": x, "y": y, "level": level, "number": number, "drift": drift})
        factors = ["x", "y", "level", "number"]
        found = variance_shares(table, "drift", factors, samples=100, seed=seed)
        share = found["share"].to_numpy()[:4]
        mean += share / times
        held += (found["share_low"][:4] <= truth) & (truth <= found["share_high"][:4])
    assert mean == pytest.approx(truth, abs=tolerances.RATIO_IN_CLASSES)
    assert held.min() / times > tolerances.LEAST_COVERAGE_OF_RATIOS


def test_runs_without_a_number_are_one_class() -> None:
    """Half the runs have it; the demand follows their order, of which the number knows nothing."""
    number = np.where(np.arange(400) < 200, np.random.default_rng(9).random(400), np.nan)
    drift = np.tile(np.arange(200.0), 2)
    table = pd.DataFrame({"number": number, "few": np.round(3.0 * number), "drift": drift})
    found = variance_shares(table, "drift", ["number", "few"], samples=50)
    assert np.abs(found["share"][:2]).max() < 0.1
    assert found["levels"].tolist() == [15, 5, 0]


def test_many_draws_of_a_number_have_many_classes() -> None:
    """A straight line of 2000 draws: 44 classes leave about one part in 44^2 inside."""
    x = np.random.default_rng(8).random(2000)
    found = variance_shares(pd.DataFrame({"x": x, "drift": x}), "drift", ["x"], samples=100)
    assert 0.0 < 1.0 - found["share"][0] < 2.0 * 44.0**-2
    assert found["share_low"][0] <= found["share"][0] <= found["share_high"][0]


def test_bands_of_shares_are_around_what_was_found() -> None:
    """Ten levels that are alike: drawn again they never are, which is no share of theirs."""
    table = pd.DataFrame({"level": np.arange(60) % 10, "drift": np.arange(60) // 10})
    found = variance_shares(table, "drift", ["level"]).iloc[0]
    assert found["share"] == pytest.approx(1.0 - 59.0 / 50.0)
    assert found["share_low"] < found["share"] < found["share_high"]
