"""Capacities of IDA between two runs: the likelihood by another search, and coarse levels."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize
from scipy.stats import norm

from tests import tolerances
from thermobearing.studies.statistics.fragility import fragility_curve
from thermobearing.studies.statistics.ida import ida_curves

MEDIAN, DISPERSION = 8.6, 0.13


def yielding(levels: Any, power: float = 4.0) -> pd.DataFrame:
    """Curves of 200 motions, flat below their capacity, that rise with a power beyond.

    As the ductility of a pier, which stays at the yield level before it jumps.
    """
    rng = np.random.default_rng(12)
    at_yield = np.exp(np.log(MEDIAN) + DISPERSION * rng.normal(size=200))
    im, one = np.meshgrid(np.asarray(levels, dtype=float), at_yield)
    drift = np.where(im < one, 0.95 * (im / one) ** 0.1, (im / one) ** power)
    names = np.repeat(np.arange(200), im.shape[1])
    return pd.DataFrame({"motion": names, "im": im.ravel(), "drift": drift.ravel()})


@pytest.mark.parametrize("step", [1.05, 1.25])
def test_levels_do_not_move_the_median(step: float) -> None:
    """Interpolation through the jump gives 7.7 at a step of 1.25, 0.9 of the truth."""
    levels = 4.0 * step ** np.arange(np.ceil(np.log(5.0) / np.log(step)))
    curve = fragility_curve(yielding(levels), "drift", 1.0, "im", method="ida", samples=99)
    error = 3.0 * DISPERSION / np.sqrt(200.0)
    assert np.log(curve.median) == pytest.approx(np.log(MEDIAN), abs=error)
    assert curve.dispersion == pytest.approx(DISPERSION, rel=tolerances.DEVIATION_OF_200)
    row = curve.row()
    assert row["median_low"] < MEDIAN < row["median_high"]
    assert not curve.coarse


def test_levels_too_far_apart_are_named() -> None:
    curve = fragility_curve(
        yielding([5.0, 7.5, 11.0, 16.0]), "drift", 1.0, "im", method="ida", samples=9
    )
    assert "ratio 1.47" in curve.coarse
    assert curve.estimate.between > 100


def test_all_in_one_interval_have_no_curve() -> None:
    curve = fragility_curve(yielding([3.0, 30.0], 8.0), "drift", 1.0, "im", method="ida", samples=9)
    assert curve.outcome == "apart"
    assert "between 3 and 30" in curve.row()["sentence"]


def test_likelihood_of_values_and_intervals_by_another_search() -> None:
    """Values, intervals, collapses at the first run, and motions that did not reach it."""
    rng = np.random.default_rng(3)
    rows = []
    for motion, capacity in enumerate(np.exp(rng.normal(0.0, 0.4, 30))):
        power = 1.0 if motion % 3 else 6.0
        for im in (0.7, 0.9, 1.2, 1.5):
            fell = motion % 7 == 0 and im >= capacity
            drift = np.nan if fell else (im / capacity) ** power
            rows.append((motion, im, drift, "not_converged" if fell else "completed"))
    table = pd.DataFrame(rows, columns=["motion", "im", "drift", "outcome"])
    options: Any = {"failed": "collapse"}
    ends = ida_curves(table, "drift", "im", **options).crossings(1.0)
    low, high = (ends[name].to_numpy() for name in ("low", "high"))
    exact = low == high
    assert exact.any()
    assert (low == 0.0).any()
    assert np.isinf(high).any()
    assert ((low > 0.0) & ~exact & np.isfinite(high)).any()
    with np.errstate(divide="ignore"):
        y, a, b = np.log(low[exact]), np.log(low[~exact]), np.log(high[~exact])

    def unlikely(parameters: Any) -> float:
        place, spread = parameters[0], np.exp(parameters[1])
        between = norm.cdf((b - place) / spread) - norm.cdf((a - place) / spread)
        return float(-norm.logpdf(y, place, spread).sum() - np.log(between).sum())

    search: Any = {"xatol": 1e-10, "fatol": 1e-13, "maxiter": 4000}
    best = minimize(unlikely, [0.0, -1.0], method="Nelder-Mead", options=search)
    curve = fragility_curve(table, "drift", 1.0, "im", method="ida", samples=5, **options)
    assert np.log(curve.median) == pytest.approx(best.x[0], abs=tolerances.LIKELIEST)
    assert curve.dispersion == pytest.approx(np.exp(best.x[1]), rel=tolerances.LIKELIEST)
