"""Fragility curves, annual rates and shares of variance against known answers."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize
from scipy.stats import binom, linregress, norm, qmc
from scipy.stats import sobol_indices as of_scipy

from tests import tolerances
from thermobearing.studies.statistics.fragility import (
    Fragility,
    Method,
    combine_curves,
    fragility_curve,
    fragility_curves,
)
from thermobearing.studies.statistics.hazard import Hazard, Rate, annual_rate, ratio, shares_of_time
from thermobearing.studies.statistics.likelihood import Curves, Estimate
from thermobearing.studies.statistics.variance import (
    WIDE,
    _sobol_indices,
    sobol_table,
    variance_shares,
    wide_note,
)

MEDIAN, DISPERSION = 1.0, 0.4
LEVELS = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0])
TIMES = 80  # repetitions of an experiment


def of_counts(beyond: np.ndarray, runs: int) -> pd.DataFrame:
    """Runs at each level, so many of them beyond 1."""
    drift = [np.r_[np.full(k, 2.0), np.full(runs - k, 0.5)] for k in beyond]
    return pd.DataFrame({"im": np.repeat(LEVELS, runs), "drift": np.concatenate(drift)})


def test_stripes_are_the_likeliest_by_another_search() -> None:
    rng = np.random.default_rng(3)
    beyond = rng.binomial(40, norm.cdf(np.log(LEVELS / MEDIAN) / DISPERSION))

    def unlikely(p: np.ndarray) -> float:
        share = norm.cdf((np.log(LEVELS) - p[0]) / np.exp(p[1]))
        return -float(binom.logpmf(beyond, 40, share).sum())

    options = {"xatol": 1e-10, "fatol": 1e-12, "maxiter": 5000}
    searched = minimize(unlikely, [0.2, -1.0], method="Nelder-Mead", options=options)
    result = fragility_curve(of_counts(beyond, 40), "drift", 1.0, "im", samples=1)
    assert np.log(result.median) == pytest.approx(searched.x[0], abs=tolerances.LIKELIEST)
    assert np.log(result.dispersion) == pytest.approx(searched.x[1], abs=tolerances.LIKELIEST)


@pytest.mark.thorough
def test_bands_of_independent_stripes_hold_the_truth_as_often_as_they_say() -> None:
    rng, at, held = np.random.default_rng(11), np.array([0.5, 1.0, 1.5]), np.zeros(5)
    truth = norm.cdf(np.log(at / MEDIAN) / DISPERSION)
    for seed in range(TIMES):
        beyond = rng.binomial(40, norm.cdf(np.log(LEVELS / MEDIAN) / DISPERSION))
        result = fragility_curve(of_counts(beyond, 40), "drift", 1.0, "im", samples=119, seed=seed)
        row, (low, high) = result.row(), result.band_at(at)
        held[:3] += (low <= truth) & (truth <= high)
        held[3] += row["dispersion_low"] <= DISPERSION <= row["dispersion_high"]
        held[4] += row["median_low"] <= MEDIAN <= row["median_high"]
    assert held.min() / TIMES > tolerances.LEAST_COVERAGE
    assert held.max() < TIMES


def test_motions_drawn_as_a_whole_widen_the_band() -> None:
    """Ten motions that each do the same ten times over: ten runs, not a hundred."""
    rng = np.random.default_rng(5)
    held = {"motion": 0, None: 0}
    for seed in range(TIMES // 2):
        capacity = np.exp(rng.normal(0.0, DISPERSION, 10))
        rows = [
            (motion, im, 1.0 if im > reached else 0.1)
            for motion, reached in enumerate(capacity)
            for im in LEVELS
            for _ in range(10)
        ]
        table = pd.DataFrame(rows, columns=["motion", "im", "drift"])
        for groups in held:
            result = fragility_curve(
                table, "drift", 1.0, "im", groups=groups, samples=119, seed=seed
            )
            row = result.row()
            held[groups] += row["median_low"] <= MEDIAN <= row["median_high"]
    assert held["motion"] > 0.8 * (TIMES // 2)
    assert held[None] < 0.6 * (TIMES // 2)


def test_capacities_of_motions_that_all_reach_it() -> None:
    capacity = np.array([0.6, 0.8, 1.0, 1.3, 1.9])
    rows = [(m, im, im / c) for m, c in enumerate(capacity) for im in np.arange(0.25, 2.6, 0.25)]
    table = pd.DataFrame(rows, columns=["motion", "im", "drift"])
    result = fragility_curve(table, "drift", 1.0, "im", method="ida", samples=20)
    logs = np.log(capacity)  # straight through zero, so that interpolation is exact
    assert np.log(result.median) == pytest.approx(logs.mean(), abs=tolerances.LIKELIEST)
    assert result.dispersion == pytest.approx(logs.std(ddof=1), rel=tolerances.LIKELIEST)


def test_capacities_that_were_not_reached_by_another_search() -> None:
    rng = np.random.default_rng(8)
    capacity, top = np.exp(rng.normal(0.0, 0.4, 30)), 1.2
    rows = [(m, im, im / c) for m, c in enumerate(capacity) for im in (0.3, 0.6, 0.9, top)]
    table = pd.DataFrame(rows, columns=["motion", "im", "drift"])
    result = fragility_curve(table, "drift", 1.0, "im", method="ida", samples=20)

    def unlikely(p: np.ndarray) -> float:
        score = (np.log(np.minimum(capacity, top)) - p[0]) / np.exp(p[1])
        return -float(np.where(capacity <= top, norm.logpdf(score) - p[1], norm.logsf(score)).sum())

    searched = minimize(
        unlikely, [0.0, -1.0], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12}
    )
    assert (capacity > top).sum() > 3
    assert np.log(result.median) == pytest.approx(searched.x[0], abs=tolerances.LIKELIEST)
    assert np.log(result.dispersion) == pytest.approx(searched.x[1], abs=tolerances.LIKELIEST)


def test_cloud_is_the_regression_of_scipy() -> None:
    rng = np.random.default_rng(4)
    im = np.exp(rng.normal(-0.2, 0.6, 80))
    drift = 1.5 * im**1.2 * np.exp(0.35 * rng.normal(size=80))
    result = fragility_curve(
        pd.DataFrame({"im": im, "drift": drift}), "drift", 2.0, "im", method="cloud"
    )
    line = linregress(np.log(im), np.log(drift))
    left = np.log(drift) - line.intercept - line.slope * np.log(im)
    sigma = np.sqrt((left**2).sum() / 78)
    median = np.exp((np.log(2.0) - line.intercept) / line.slope)
    assert result.median == pytest.approx(median, rel=tolerances.LIKELIEST)
    assert result.dispersion == pytest.approx(sigma / line.slope, rel=tolerances.LIKELIEST)
    assert result.probability(median)[0] == pytest.approx(0.5, rel=tolerances.LIKELIEST)


def test_cloud_with_collapse_has_five_parameters() -> None:
    """Share of collapse by a logistic curve, the rest as without: both known."""
    rng = np.random.default_rng(9)
    im = np.exp(rng.normal(0.0, 0.7, 4000))
    drift = im * np.exp(0.3 * rng.normal(size=4000))
    collapse = rng.random(4000) < 1.0 / (1.0 + np.exp(2.0 - 3.0 * np.log(im)))
    outcome = np.where(collapse, "not_converged", "completed")
    table = pd.DataFrame({"im": im, "drift": np.where(collapse, np.nan, drift), "outcome": outcome})
    at = np.array([0.5, 1.0, 2.0])
    share = 1.0 / (1.0 + np.exp(2.0 - 3.0 * np.log(at)))
    beyond = norm.cdf(np.log(at / 1.5) / 0.3)
    result = fragility_curve(
        table, "drift", 1.5, "im", method="cloud", failed="collapse", samples=100
    )
    low, high = result.band_at(at)
    truth = beyond * (1.0 - share) + share
    assert result.probability(at) == pytest.approx(truth, abs=tolerances.SHARE_OF_4000)
    assert (low < truth).all()
    assert (truth < high).all()
    without = fragility_curve(table, "drift", 1.5, "im", method="cloud", samples=1)
    assert without.probability(at) == pytest.approx(beyond, abs=tolerances.SHARE_OF_4000)
    assert (without.left_out, without.collapsed) == (result.collapsed, result.left_out)
    assert result.collapsed > result.left_out == 0


@pytest.mark.parametrize("collapse_at", [0.8, 1.6, 6.0])
def test_numbers_of_a_cloud_with_collapse_are_those_of_its_whole_curve(collapse_at: float) -> None:
    """Collapse before, at and after the capacity: the median is where the curve is one half."""
    rng = np.random.default_rng(4)
    motion = np.repeat(np.arange(12), 60)
    im = np.exp(rng.normal(0.0, 0.8, motion.size))
    drift = im * np.exp(0.3 * rng.normal(size=motion.size))
    steepness = 4.0 * (np.log(im) - np.log(collapse_at))
    outcome = np.where(
        rng.random(motion.size) < 1.0 / (1.0 + np.exp(-steepness)), "not_converged", "completed"
    )
    table = pd.DataFrame({"motion": motion, "im": im, "drift": drift, "outcome": outcome})
    curve = fragility_curve(table, "drift", 1.5, "im", method="cloud", failed="collapse")
    assert curve.collapsed > 0
    assert curve.probability(curve.median)[0] == pytest.approx(0.5, rel=tolerances.LIKELIEST)
    grid = np.exp(np.linspace(-6.0, 6.0, 200001))
    low, middle, high = np.interp(norm.cdf([-1.0, 0.0, 1.0]), curve.probability(grid), np.log(grid))
    assert np.log(curve.median) == pytest.approx(middle, abs=tolerances.OF_A_GRID)
    assert curve.dispersion == pytest.approx(0.5 * (high - low), abs=tolerances.OF_A_GRID)
    # The medians of the band are those of the curves that it is made of.
    row = curve.row()
    ends = np.array([row["median_low"], row["median_high"]])
    assert row["median_low"] < curve.median < row["median_high"]
    medians = np.exp(curve.estimate.medians)
    at_one_half = np.diag(curve.family(medians))
    assert at_one_half == pytest.approx(np.full(len(medians), 0.5), rel=tolerances.LIKELIEST)
    assert np.isin(ends, medians).all()


def test_collapse_at_any_intensity_has_no_end_of_a_curve() -> None:
    """Of runs that collapse by chance: 30 % at every intensity leave no intensity with 16 %."""
    rng = np.random.default_rng(6)
    im = np.tile(np.geomspace(0.1, 10.0, 20), 20)
    drift = im * np.exp(0.2 * rng.normal(size=im.size))
    fell = np.repeat(np.arange(20), 20) % 10 < 3
    table = pd.DataFrame({"im": im, "drift": drift, "outcome": "completed"})
    table.loc[fell, "outcome"] = "not_converged"
    curve = fragility_curve(table, "drift", 1.5, "im", method="cloud", failed="collapse", samples=9)
    assert curve.probability(curve.median)[0] == pytest.approx(0.5, rel=tolerances.LIKELIEST)
    assert curve.dispersion == np.inf


def test_curves_of_temperatures_share_their_motions() -> None:
    """The median of the cold is 0.8 of the warm one, motion by motion: so in every sample."""
    rng = np.random.default_rng(2)
    capacity = np.exp(rng.normal(0.0, 0.4, 25))
    rows = [
        (m, t, f * im, im / c)
        for m, c in enumerate(capacity)
        for t, f in ((-20.0, 0.8), (23.0, 1.0))
        for im in np.arange(0.1, 4.0, 0.1)
    ]
    table = pd.DataFrame(rows, columns=["motion", "ambient_degC", "im", "drift"])
    result = fragility_curves(table, "drift", 1.0, "im", "ambient_degC", method="ida", samples=50)
    cold, warm = result[-20.0].estimate, result[23.0].estimate
    moved = np.exp(cold.samples.place - warm.samples.place)
    assert list(result) == [-20.0, 23.0]
    assert moved == pytest.approx(0.8, rel=tolerances.LIKELIEST)


OF_MOTIONS, OF_RUNS = 0.35, 0.2  # deviations of ln demand; runs by themselves make no IDA curve
WHOLE = float(np.hypot(OF_MOTIONS, OF_RUNS))
MEDIANS = {"warm": 1.0, "cold": 0.8}
STEEP = 2.5  # of the hazard


def made_up(motions: int, method: Method, rng: np.random.Generator) -> pd.DataFrame:
    """Motions scaled to some intensities at two temperatures, of known medians and dispersion."""
    every = 2 if method == "cloud" else 1
    levels = np.array([0.4, 0.55, 0.7, 0.85, 1.0, 1.2, 1.45, 1.8, 2.2])[::every]
    apart = 0.1 if method == "ida" else 0.0  # what a motion does at one temperature only
    of_motion = rng.normal(0.0, np.sqrt(WHOLE**2 - apart**2), motions)
    if method != "ida":
        of_motion *= OF_MOTIONS / WHOLE
    parts = []
    for air, median in MEDIANS.items():
        part = pd.DataFrame(
            {"motion": np.repeat(np.arange(motions), len(levels)), "im": np.tile(levels, motions)}
        )
        effect = (of_motion + apart * rng.normal(size=motions))[part["motion"]]
        if method != "ida":
            effect = effect + OF_RUNS * rng.normal(size=len(part))
        parts.append(part.assign(air=air, drift=part["im"] / median * np.exp(effect)))
    return pd.concat(parts, ignore_index=True)


def coverage(motions: int, method: Method, times: int, samples: int = 199) -> np.ndarray:
    """How often bands of 95 % hold the median, the dispersion, the rate and the ratio of rates."""
    rng = np.random.default_rng(motions)
    ends = np.array([0.05, 50.0])
    hazard = Hazard(ends, 1e-2 * ends**-STEEP)
    exact = closed_form(1.0, WHOLE, 1e-2, STEEP)
    held, done = np.zeros(4), 0
    for seed in range(times):
        curves = fragility_curves(
            made_up(motions, method, rng), "drift", 1.0, "im", "air", method=method,
            samples=samples, seed=seed,
        )  # fmt: skip
        if not all(curve.estimate.known for curve in curves.values()):
            continue
        row, done = curves["warm"].row(), done + 1
        warm, cold = (annual_rate(curves[air], hazard) for air in MEDIANS)
        bands = [
            (row["median_low"], 1.0, row["median_high"]),
            (row["dispersion_low"], WHOLE, row["dispersion_high"]),
            (warm.low, exact, warm.high),
        ]
        _, low, high = ratio(cold, warm)
        bands.append((low, MEDIANS["cold"] ** -STEEP, high))
        held += [low <= truth <= high for low, truth, high in bands]
    assert done > 0.9 * times
    return held / done


@pytest.mark.thorough
def test_bands_hold_the_truth_with_a_dozen_motions() -> None:
    """Percentiles of the same bootstrap hold the dispersion in 79 % of such tables."""
    assert coverage(12, "ida", 60, 99).min() > tolerances.LEAST_COVERAGE_OF_FEW


@pytest.mark.thorough
@pytest.mark.parametrize("motions", [12, 20, 40])
@pytest.mark.parametrize("method", ["stripes", "ida", "cloud"])
def test_bands_hold_the_truth_with_few_motions(method: Method, motions: int) -> None:
    held = coverage(motions, method, 300)
    assert held.min() > tolerances.LEAST_COVERAGE_OF_FEW


def test_none_beyond_is_bounded_as_by_clopper_and_pearson() -> None:
    """None of 12 motions at 2.0: at most 26 % of all go beyond there, with 97.5 % confidence."""
    im = [0.5, 1.0, 2.0]
    table = pd.DataFrame(
        {"motion": np.repeat(np.arange(12), 3), "im": np.tile(im, 12), "drift": 0.1}
    )
    result = fragility_curve(table, "drift", 1.0, "im", samples=3999)
    assert result.outcome == "none_beyond"
    assert result.band_at(2.0)[1][0] == pytest.approx(1.0 - 0.025 ** (1.0 / 12.0), rel=0.01)
    site = Hazard(np.array([0.01, 100.0]), np.array([1e4, 1e-4]))
    rate = annual_rate(result, site)
    assert (rate.rate, rate.groups) == (0.0, 12)
    # All 12 stay below at 2.0, so that the median is above, without an assumed dispersion.
    assert (result.row()["median_low"], result.row()["median_high"]) == (2.0, np.inf)
    bounds = result.band_at([2.0])[1]
    median = 2.0 * np.exp(-0.6 * norm.ppf(bounds[0]))
    assert np.isnan([result.row()["dispersion_low"], result.row()["dispersion_high"]]).all()
    assert rate.high == pytest.approx(closed_form(median, 0.6, 1.0, 2.0), rel=0.01)


def closed_form(median: float, dispersion: float, factor: float, exponent: float) -> float:
    """Cornell's rate for a lognormal fragility and a hazard of factor * im ** -exponent."""
    return float(factor * median**-exponent * np.exp(0.5 * (exponent * dispersion) ** 2))


@pytest.mark.parametrize("method", ["stripes", "ida", "cloud"])
@pytest.mark.parametrize("of_motions", [0.0, 0.9])  # share of the variance between motions
def test_lognormal_capacities_hardly_ever_contradict_their_curve(
    method: Any, of_motions: float
) -> None:
    """Six draws of each of twelve motions; more repetitions have 0 and 2 % (docs/theory.md)."""
    rng = np.random.default_rng(1)
    motion, sample = np.repeat(np.arange(12), 6), np.tile(np.arange(6), 12)
    contradicted = 0
    for _ in range(12):
        between, within = rng.normal(size=12)[motion], rng.normal(size=72)
        error = np.sqrt(of_motions) * between + np.sqrt(1.0 - of_motions) * within
        capacity = 1.3 * np.exp(0.3 * error)
        runs = pd.concat(
            [
                pd.DataFrame({"motion": motion, "sample": sample, "im": im, "drift": im / capacity})
                for im in (0.2, 0.5, 0.8, 1.1, 1.4, 1.8, 2.3, 3.0)
            ]
        )
        options: dict[str, Any] = {"curves": ("motion", "sample"), "samples": 1}
        curve = fragility_curve(runs, "drift", 1.0, "im", method=method, **options)
        contradicted += curve.outcome == "contradicted"
    assert contradicted <= 1


def lognormal(median: float, dispersion: float, others: int = 1) -> Fragility:
    place, slope = np.log([median]), np.array([1.0 / dispersion])
    spread = np.linspace(-0.1, 0.1, others)
    estimate = Estimate(Curves(place, slope), Curves(place + spread, np.repeat(slope, others)))
    # At the median, where each count of one run is likely.
    counts = pd.DataFrame({"im": [median], "runs": [1], "beyond": [0]})
    counts = counts.assign(first=median, last=median)
    return Fragility("", "stripes", "drift", "im", 1.0, [(1.0, estimate)], 0.95, 1, counts, 0, 0)


def power_law(exponent: float, ends: tuple[float, float] = (1e-3, 1e4), points: int = 9) -> Hazard:
    im = np.geomspace(*ends, points)
    return Hazard(im, 1e-2 * im**-exponent, "PGA")


@pytest.mark.parametrize("exponent", [1.0, 2.5, 4.0])
@pytest.mark.parametrize("dispersion", [0.05, 0.3, 0.6])
def test_power_law_has_a_closed_form(exponent: float, dispersion: float) -> None:
    result = annual_rate(lognormal(2.0, dispersion), power_law(exponent))
    exact = closed_form(2.0, dispersion, 1e-2, exponent)
    assert result.rate == pytest.approx(exact, rel=tolerances.HAZARD)
    assert result.notes == ()
    assert result.return_period * result.rate == pytest.approx(1.0)
    assert result.probability(50.0) == pytest.approx(1.0 - np.exp(-50.0 * result.rate))


def test_kinked_hazard_is_integrated_piece_by_piece() -> None:
    im, rate = np.array([0.1, 1.0, 3.0, 100.0]), np.array([1.0, 0.05, 2e-3, 1e-9])
    median, dispersion = 1.5, 0.4
    exact = 0.0
    for k in range(3):
        n = -np.log(rate[k + 1] / rate[k]) / np.log(im[k + 1] / im[k])
        z = np.log(im[k : k + 2] / median) / dispersion
        tails = norm.cdf(z + n * dispersion)
        moved = median**-n * np.exp(0.5 * (n * dispersion) ** 2)
        # By parts: what is gained at the ends of a piece, and the density of the capacity in it.
        ends = rate[k] * norm.cdf(z[0]) - rate[k + 1] * norm.cdf(z[1])
        exact += ends + rate[k] * im[k] ** n * moved * (tails[1] - tails[0])
    exact += rate[-1] * norm.cdf(z[1])  # beyond the last point, with the probability there
    result = annual_rate(lognormal(median, dispersion), Hazard(im, rate))
    assert result.rate == pytest.approx(exact, rel=tolerances.HAZARD)


def test_ends_of_the_hazard_curve_are_reported() -> None:
    early = annual_rate(lognormal(2.0, 0.4), power_law(2.0, (1e-3, 2.0)))
    late = annual_rate(lognormal(2.0, 0.4), power_law(2.0, (1.5, 1e3)))
    assert "ends at 2" in early.notes[0]
    assert "begins at 1.5" in late.notes[0]
    # What goes beyond at the end already is counted, and nothing is to be reported.
    assert annual_rate(lognormal(0.5, 0.1), power_law(2.0, (1e-3, 2.0))).notes == ()
    # What is beyond the end counts with the probability there.
    assert early.rate < closed_form(2.0, 0.4, 1e-2, 2.0)
    jump = annual_rate(lognormal(1.9, 1e-4), power_law(2.0, (1e-3, 2.0)))
    assert jump.rate == pytest.approx(1e-2 / 1.9**2, rel=2 * tolerances.HAZARD_JUMP)


def test_band_and_ratio_of_rates() -> None:
    """Every sample of the cold has 0.8 of the warm median: rates go with its power."""
    warm, cold = lognormal(2.0, 0.4, 21), lognormal(1.6, 0.4, 21)
    hazard = power_law(2.0)
    a, b = annual_rate(cold, hazard), annual_rate(warm, hazard)
    result = ratio(a, b)
    assert result == pytest.approx([0.8**-2.0] * 3, rel=tolerances.HAZARD)
    assert (a.low, a.high) == pytest.approx(
        (a.rate * np.exp(-0.2), a.rate * np.exp(0.2)), rel=tolerances.HAZARD
    )


def test_the_band_of_a_ratio_is_of_the_samples_alone() -> None:
    cold = Rate(2.5, 0.0, 0.0, np.array([1.0, 3.0, 2.0, np.nan]))
    warm = Rate(1.0, 0.0, 0.0, np.ones(4))
    assert ratio(cold, warm) == (2.5, 1.0, 3.0)
    # Where all samples are on one side of the ratio, the band is extended to it.
    above = Rate(10.0, 0.0, 0.0, cold.family)
    assert ratio(above, warm) == (10.0, 1.0, 10.0)


def test_climate_is_the_mean_of_its_temperatures() -> None:
    parts = {
        -20.0: lognormal(1.6, 0.4, 5),
        23.0: lognormal(2.0, 0.3, 5),
        40.0: lognormal(9.0, 0.3, 5),
    }
    climate = combine_curves(parts, [0.25, 0.75, 0.0])
    hazard = power_law(2.0)
    rate = annual_rate(climate, hazard).rate
    exact = 0.25 * closed_form(1.6, 0.4, 1e-2, 2.0) + 0.75 * closed_form(2.0, 0.3, 1e-2, 2.0)
    assert rate == pytest.approx(exact, rel=tolerances.HAZARD)
    below = [norm.cdf(np.log(climate.median / at) / b) for at, b in ((1.6, 0.4), (2.0, 0.3))]
    assert 0.25 * below[0] + 0.75 * below[1] == pytest.approx(0.5, rel=tolerances.HAZARD)
    assert np.isnan(climate.dispersion)


def test_shares_of_time_keep_the_mean() -> None:
    rng = np.random.default_rng(1)
    hours = rng.uniform(-20.0, 30.0, 5000)
    levels = [30.0, -20.0, 0.0, 10.0]
    shares = shares_of_time(levels, hours)
    assert shares.sum() == pytest.approx(1.0)
    assert float(shares @ levels) == pytest.approx(hours.mean())
    assert shares_of_time([0.0, 10.0], [-5.0, 50.0]).tolist() == [0.5, 0.5]
    assert shares_of_time([3.0], [-5.0, 50.0]).tolist() == [1.0]


# Ishigami & Homma (1990) with a = 7, b = 0.1: indices in closed form (Saltelli and others 2008).
A, B = 7.0, 0.1
WHOLE_VARIANCE = A**2 / 8.0 + B * np.pi**4 / 5.0 + B**2 * np.pi**8 / 18.0 + 0.5
ONE = 0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2
BOTH = 8.0 * B**2 * np.pi**8 / 225.0
FIRST = np.array([ONE, A**2 / 8.0, 0.0]) / WHOLE_VARIANCE
TOTAL = np.array([ONE + BOTH, A**2 / 8.0, BOTH]) / WHOLE_VARIANCE


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
    first, total = _sobol_indices(a, b, np.array(swapped))
    assert first == pytest.approx(FIRST, abs=tolerances.SOBOL_INDEX)
    assert total == pytest.approx(TOTAL, abs=tolerances.SOBOL_INDEX)


def test_the_estimators_of_scipy() -> None:
    a, b, *swapped = arranged(256, np.random.default_rng(2), sobol=True)
    given = {"f_A": a[None], "f_B": b[None], "f_AB": np.array(swapped)[:, None, :]}
    theirs = of_scipy(func=given, n=256)
    first, total = _sobol_indices(a, b, np.array(swapped))
    assert first == pytest.approx(theirs.first_order.ravel(), abs=tolerances.SAME_ESTIMATOR)
    assert total == pytest.approx(theirs.total_order.ravel(), abs=tolerances.SAME_ESTIMATOR)


class FirstHalf:
    """A draw of the first half of the rows."""

    def sums(self, values: np.ndarray) -> np.ndarray:
        return np.asarray(values[: len(values) // 2].sum(axis=0)[None, :])


def test_a_draw_of_some_rows_has_their_own_mean() -> None:
    a, b, *swapped = arranged(64, np.random.default_rng(4), sobol=True)
    a, others = a + 5.0 * (np.arange(64) < 32), np.array(swapped)
    _, total = _sobol_indices(a, b, others, FirstHalf())  # type: ignore[arg-type]
    _, alone = _sobol_indices(a[:32], b[:32], others[:, :32])
    assert total[0] == pytest.approx(alone, rel=tolerances.SAME_ESTIMATOR)


def test_bands_of_indices_hold_the_truth_as_often_as_they_say() -> None:
    rng = np.random.default_rng(6)
    held, times = np.zeros(6), 60
    for seed in range(times):
        table = as_table(arranged(300, rng, sobol=False))
        result = sobol_table(table, "drift", samples=119, seed=seed)
        held[:3] += (result["first_low"] <= FIRST) & (result["first_high"] >= FIRST)
        held[3:] += (result["total_low"] <= TOTAL) & (result["total_high"] >= TOTAL)
    assert held.min() / times > tolerances.LEAST_COVERAGE
    assert held.mean() < times


def test_samples_that_make_a_wide_band_narrow() -> None:
    """A band of Sobol' indices is as wide as 1 / sqrt(n): the stated samples make it 0.2."""
    widths = {}
    for rows in (64, 1024):
        values = arranged(rows, np.random.default_rng(rows), sobol=False)
        indices = sobol_table(as_table(values), "drift")
        note = wide_note(indices[[name for name in indices if not name.startswith("total")]])
        widths[rows] = (indices["first_high"] - indices["first_low"]).max(), note
        of_totals = (indices["total_high"] - indices["total_low"]).max()
        stated = wide_note(indices).partition("total up to ")[2]
        assert bool(stated) == (of_totals > WIDE)
        assert stated.startswith(f"{of_totals:.2f}" * bool(stated))
    assert widths[64][0] > WIDE
    needed = int(widths[64][1].partition("some ")[2].split()[0])
    assert needed >= 64 * (widths[64][0] / WIDE) ** 2 > 0.5 * needed
    assert not widths[1024][1] or widths[1024][0] > WIDE


def test_a_failed_run_leaves_all_matrices() -> None:
    values = arranged(64, np.random.default_rng(3), sobol=True)
    table = as_table(values)
    table.loc[[5, 64 + 7], "outcome"] = "not_converged"
    kept = ~np.isin(np.arange(64), [5, 7])
    result = sobol_table(table, "drift", samples=10)
    first, total = _sobol_indices(values[0][kept], values[1][kept], np.array(values[2:])[:, kept])
    assert result["first"].to_numpy() == pytest.approx(first)
    assert result["total"].to_numpy() == pytest.approx(total)
    assert result[["rows", "left_out"]].iloc[0].tolist() == [62, 2]


def test_correlation_ratio_of_a_sum_and_a_product() -> None:
    """x + 2 y + 3 x y of levels -1 and 1: shares 1, 4 and 9 of 14."""
    rows = [(x, y, x + 2 * y + 3 * x * y) for x in (-1, 1) for y in (-1, 1) for _ in range(500)]
    table = pd.DataFrame(rows, columns=["x", "y", "drift"])
    result = variance_shares(table, "drift", ["x", "y"])
    shares = np.array([1.0, 4.0, 9.0]) / 14.0
    assert result["share"].to_numpy() == pytest.approx(shares, abs=tolerances.CHANCE_OF_2000)


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
        result = variance_shares(table, "drift", factors, samples=100, seed=seed)
        share = result["share"].to_numpy()[:4]
        mean += share / times
        held += (result["share_low"][:4] <= truth) & (truth <= result["share_high"][:4])
    assert mean == pytest.approx(truth, abs=tolerances.RATIO_IN_CLASSES)
    assert held.min() / times > tolerances.LEAST_COVERAGE_OF_RATIOS


def test_runs_without_a_number_are_one_class() -> None:
    """Half the runs have it; the demand follows their order, of which the number knows nothing."""
    number = np.where(np.arange(400) < 200, np.random.default_rng(9).random(400), np.nan)
    drift = np.tile(np.arange(200.0), 2)
    table = pd.DataFrame({"number": number, "few": np.round(3.0 * number), "drift": drift})
    result = variance_shares(table, "drift", ["number", "few"], samples=50)
    assert np.abs(result["share"][:2]).max() < 0.1
    assert result["levels"].tolist() == [15, 5, 0]


def test_many_draws_of_a_number_have_many_classes() -> None:
    """A straight line of 2000 draws: 44 classes leave about one part in 44^2 inside."""
    x = np.random.default_rng(8).random(2000)
    result = variance_shares(pd.DataFrame({"x": x, "drift": x}), "drift", ["x"], samples=100)
    assert 0.0 < 1.0 - result["share"][0] < 2.0 * 44.0**-2
    assert result["share_low"][0] <= result["share"][0] <= result["share_high"][0]


def test_bands_of_shares_are_around_what_was_found() -> None:
    """Ten levels that are alike: drawn again they never are, which is no share of theirs."""
    table = pd.DataFrame({"level": np.arange(60) % 10, "drift": np.arange(60) // 10})
    result = variance_shares(table, "drift", ["level"]).iloc[0]
    assert result["share"] == pytest.approx(1.0 - 59.0 / 50.0)
    assert result["share_low"] < result["share"] < result["share_high"]
