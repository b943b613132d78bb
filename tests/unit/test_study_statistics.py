"""Edges of what is drawn from a study: failed runs, counts without a curve, bad input."""

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.stats import binom

from thermobearing.border.errors import InputError
from thermobearing.studies.statistics import hazard
from thermobearing.studies.statistics.comparison import (
    compare_counts,
    find_contradiction,
    find_half,
    reached_counts,
)
from thermobearing.studies.statistics.demand import (
    Draw,
    _median_places,
    _medians,
    counted,
    demand_against,
)
from thermobearing.studies.statistics.fragility import (
    combine_curves,
    fragility_curve,
    fragility_curves,
)
from thermobearing.studies.statistics.ida import ida_curves
from thermobearing.studies.statistics.likelihood import (
    MOST_STRIPES,
    Curves,
    _classes,
    _fit_curves,
    cloud,
    pivoted,
    stripes,
)
from thermobearing.studies.statistics.variance import sobol_table, variance_shares

HAZARD = hazard.Hazard(np.array([0.1, 1.0, 10.0]), np.array([1.0, 1e-2, 1e-4]))


def split_runs(**columns: Any) -> pd.DataFrame:
    return pd.DataFrame(columns)


def two_levels(first: list[float], second: list[float]) -> pd.DataFrame:
    return split_runs(
        im=[1.0] * len(first) + [2.0] * len(second),
        drift=[*first, *second],
        motion=[*range(len(first)), *range(len(second))],
    )


def test_failed_runs_are_reported_and_count_only_when_asked() -> None:
    table = two_levels([0.1, 0.1, 0.1, 3.0], [0.1, np.nan, 3.0, np.nan])
    table["outcome"] = ["completed"] * 5 + ["not_converged", "completed", "broken"]
    out = fragility_curve(table, "drift", 1.0, "im", samples=5)
    collapse = fragility_curve(table, "drift", 1.0, "im", failed="collapse", samples=5)
    assert out.counts["beyond"].tolist() == [1, 1]
    assert out.counts["runs"].tolist() == [4, 2]
    assert collapse.counts["beyond"].tolist() == [1, 2]
    assert collapse.counts["runs"].tolist() == [4, 3]  # a fault of the program says nothing
    assert out.sentence == "2 of 8 runs failed and are left out"
    assert (collapse.left_out, collapse.collapsed) == (1, 1)
    assert collapse.sentence.count("2 of 8 runs failed") == 1
    assert out.row()["sentence"] == out.sentence


@pytest.mark.parametrize(
    ("first", "second", "outcome", "message"),
    [
        ([0.1] * 4, [0.1] * 4, "none_beyond", "larger intensities"),
        ([3.0] * 4, [3.0] * 4, "all_beyond", "smaller intensities"),
        ([0.1] * 4, [3.0] * 4, "apart", "up to 1, all do from 2"),
        ([0.1, 0.1, 0.1, 3.0], [3.0] * 4, "completed", ""),
        ([0.1, 0.1, 3.0, 3.0], [0.1, 3.0, 0.1, 3.0], "not_rising", "does not rise"),
        ([3.0] * 4, [0.1] * 4, "not_rising", "does not rise"),
    ],
)
def test_counts_without_a_curve(
    first: list[float], second: list[float], outcome: str, message: str
) -> None:
    table = pd.concat([two_levels(first, second), two_levels([0.1], [3.0])]).iloc[: -2 or None]
    if outcome == "completed":  # overlap: one that stays below at the larger intensity too
        table = pd.concat([table, two_levels([], [0.1])])
    result = fragility_curve(table.reset_index(drop=True), "drift", 1.0, "im", samples=20)
    assert result.outcome == outcome
    assert message in result.estimate.sentence
    row = result.row()
    numbers = [row["median"], row["dispersion"], result.probability(1.5)[0]]
    assert np.isfinite(numbers).all() == (outcome == "completed")
    rate = hazard.annual_rate(result, HAZARD)
    has_bounds = outcome in ("all_beyond", "apart")
    assert (rate.is_bounded, np.isfinite(rate.high)) == (has_bounds, outcome != "not_rising")
    assert np.isnan(rate.rate) == (has_bounds or outcome == "not_rising")
    assert (rate.low < rate.high) == (outcome != "not_rising")


def test_a_step_has_the_rates_that_its_counts_allow() -> None:
    """The median may lie anywhere between the two intensities; shares count where they are mixed.

    At 95 % one of six exceedances has a probability of 0.0042 to 0.6412 (Clopper & Pearson).
    """
    at = np.repeat([1.0, 2.0, 4.0], 6)
    drift = np.where(at < 4.0, 0.1, 3.0)
    motion = np.tile(np.arange(6), 3)
    table = split_runs(im=at, drift=drift, motion=motion)
    step = fragility_curve(table, "drift", 1.0, "im", samples=20)
    rate = hazard.annual_rate(step, HAZARD)
    rates = HAZARD.at([1.0, 2.0, 4.0])
    assert_allclose([rate.low, rate.high], rates[:0:-1], rtol=1e-12)
    assert hazard.RATE_OF_COUNTS in rate.notes
    drift[6] = 3.0  # one of six exceeds the capacity at 2
    mixed = fragility_curve(table.assign(drift=drift), "drift", 1.0, "im", samples=20)
    assert mixed.outcome == "apart"
    other = hazard.annual_rate(mixed, HAZARD)
    low = 0.00421 * (rates[1] - rates[2]) + rates[2]
    high = 0.64123 * (rates[0] - rates[1]) + rates[1]
    assert_allclose([other.low, other.high], [low, high], rtol=1e-3)
    quotient, *ends = hazard.ratio(rate, other)
    assert np.isnan(quotient)
    assert_allclose(ends, [rate.low / other.high, rate.high / other.low])
    mean = hazard.annual_rate(combine_curves({0.0: step, 20.0: mixed}, [0.25, 0.75]), HAZARD)
    assert_allclose(mean.low, 0.25 * rate.low + 0.75 * other.low)
    assert_allclose(mean.high, 0.25 * rate.high + 0.75 * other.high)


@pytest.mark.parametrize("shift", [-1.0, 1.0])
def test_the_band_of_a_rate_contains_it(shift: float) -> None:
    """All curves of the band are on one side of the best one, as of a biased bootstrap."""
    table = two_levels([0.1, 0.1, 0.1, 3.0], [0.1, 3.0, 3.0, 3.0])
    curve = fragility_curve(table, "drift", 1.0, "im", samples=20)
    best = curve.estimate.best
    samples = Curves(np.full(20, best.place[0] + shift), np.full(20, best.slope[0]))
    biased = replace(curve, parts=[(1.0, replace(curve.estimate, samples=samples))])
    rate = hazard.annual_rate(biased, HAZARD)
    assert rate.low < rate.high
    assert rate.rate == (rate.low if shift < 0.0 else rate.high)


def test_two_motions_have_no_division_by_zero() -> None:
    at = np.repeat([1.0, 2.0, 3.0, 4.0], 2)
    drift = [0.1, 0.1, 3.0, 0.1, 0.1, 3.0, 3.0, 3.0]
    table = split_runs(im=at, drift=drift, motion=np.tile([0, 1], 4))
    best, draws = (
        Curves(np.array(place), np.array(slope))
        for place, slope in (([0.0], [2.0]), ([0.1, 0.1], [1.0, 3.0]))
    )
    assert np.isinf(pivoted(best, draws, 2, 0.95).slope).tolist() == [True, False]
    assert fragility_curve(table, "drift", 1.0, "im", samples=20).estimate.known


def test_one_mixed_intensity_is_passed_on_the_side_of_the_half() -> None:
    """With less than half beyond there, the half comes between it and the next intensity."""
    yes = np.array([[0.0, 1.0, 4.0], [0.0, 2.0, 4.0], [0.0, 3.0, 4.0], [0.0, 0.0, 1.0]])
    no = np.array([[4.0, 3.0, 0.0], [4.0, 2.0, 0.0], [4.0, 1.0, 0.0], [4.0, 4.0, 3.0]])
    result = _fit_curves(np.array([1.0, 2.0, 4.0]), yes, no)
    assert np.isinf(result.slope).all()
    assert_allclose(np.exp(result.place), [np.sqrt(8.0), 2.0, np.sqrt(2.0), 4.0])
    table = two_levels([0.1, 0.1, 0.1, 3.0], [3.0] * 4)
    output = fragility_curve(table, "drift", 1.0, "im", samples=20).estimate.sentence
    assert "only at 1 do some runs exceed the capacity and others not (1 of 4 do)" in output


@pytest.mark.parametrize(
    ("beyond", "advice"),
    [
        ([0, 0, 1], "add larger intensities"),
        ([1, 4, 4], "add smaller intensities"),
        ([0, 1, 4], "add intensities close to it"),
        ([1], "add smaller and larger intensities"),
    ],
)
def test_one_mixed_intensity_names_the_side_that_lacks_runs(beyond: list[int], advice: str) -> None:
    at = np.repeat(np.arange(1.0, len(beyond) + 1.0), 4)
    above = np.concatenate([np.arange(4) < count for count in beyond])
    result = stripes(at, above, Draw.of_labels(None, len(at), 5))
    assert (result.outcome, result.sentence.split("; ")[1]) == ("apart", advice)
    with_unit = stripes(at, above, Draw.of_labels(None, len(at), 5), "m/s²")
    assert " m/s² do some" in with_unit.sentence


def test_a_curve_that_hardly_rises_has_no_upper_end() -> None:
    """Some bootstrap samples fall, or have nothing beyond: neither has a largest median."""
    table = two_levels([0.1, 0.1, 0.1, 3.0], [0.1, 0.1, 3.0, 3.0])
    row = fragility_curve(table, "drift", 1.0, "im", groups=None, samples=200).row()
    assert (row["median_high"], row["dispersion_high"]) == (np.inf, np.inf)
    assert np.isfinite([row["median"], row["dispersion"], row["median_low"]]).all()


def test_many_intensities_are_put_into_classes_at_their_geometric_mean() -> None:
    at = np.geomspace(1.0, 100.0, 2 * MOST_STRIPES)[::-1]
    levels, place = _classes(at)
    assert levels == pytest.approx(np.sqrt(at[::-2] * at[-2::-2]))
    assert place.tolist() == [k // 2 for k in reversed(range(len(at)))]


def test_a_demand_that_falls_is_as_likely_beyond_everywhere() -> None:
    at = np.geomspace(1.0, 2.0, 20)
    result = cloud(at, 5.0 / at + 0.1 * np.sin(50.0 * at), 1.0, Draw.of_labels(None, 20, 5))
    assert result.outcome == "not_rising"
    assert (result.best.probability(np.array([0.1, 10.0])) > 0.99).all()


def test_a_cloud_is_compared_with_the_exceedances_of_its_own_runs() -> None:
    """Of a demand with a kink, which a line in logarithms misses, and of one without."""
    rng = np.random.default_rng(3)
    im = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 50)
    noise = np.exp(rng.normal(0.0, 0.25, len(im)))
    straight = pd.DataFrame({"Sa_m_s2": im, "drift": 0.25 * im * noise})
    kinked = straight.assign(drift=np.where(im > 3.5, im / 4.0, 0.02 * im) ** 2 * noise)
    of_straight, of_kinked = (
        fragility_curve(table, "drift", 1.0, "Sa_m_s2", method="cloud", groups=None, samples=5)
        for table in (straight, kinked)
    )
    assert of_straight.misfit == ""
    contradiction = of_kinked.contradiction or pytest.fail("the kink is not noticed")
    at, _, beyond, runs, low, high = contradiction
    assert (of_straight.outcome, of_kinked.outcome) == ("completed", "contradicted")
    row = of_kinked.counts[np.isclose(of_kinked.counts["Sa_m_s2"], at)].iloc[0]
    assert (row["runs"], row["beyond"]) == (runs, beyond)
    assert runs == 50
    assert not low <= beyond <= high
    share = of_kinked.probability([at])[0]
    tail = 0.025 / 6  # of six intensities together
    assert (low, high) == (binom.ppf(tail, 50, share), binom.ppf(1.0 - tail, 50, share))
    assert f"at {at:.4g} m/s²" in of_kinked.misfit
    stripes_of_kinked = fragility_curve(kinked, "drift", 1.0, "Sa_m_s2", groups=None, samples=5)
    assert stripes_of_kinked.misfit == ""


def test_many_intensities_are_compared_in_ten_classes() -> None:
    im = np.geomspace(1.0, 10.0, 300)
    table = pd.DataFrame({"im": im, "drift": np.where(im > 9.0, 5.0, 0.1 * im**0.5)})
    curve = fragility_curve(table, "drift", 1.0, "im", method="cloud", groups=None, samples=5)
    assert len(curve.counts) == MOST_STRIPES
    assert curve.contradiction is not None
    assert curve.contradiction.runs == pytest.approx(len(im) / 10, abs=1)


def shares_with_a_step() -> "pd.DataFrame":
    """40 motions at six intensities; half reach the capacity at 1 or 2, the others at 5 or 6."""
    capacity = np.repeat([0.5, 1.5, 4.5, 5.5], 10)
    motion, im = (grid.ravel() for grid in np.meshgrid(np.arange(40), np.arange(1.0, 7.0)))
    drift = 1.0001 * im / capacity[motion]
    return pd.DataFrame({"motion": motion, "im": im, "drift": drift})


@pytest.mark.parametrize("method", ["stripes", "ida"])
def test_shares_that_do_not_follow_one_lognormal_curve_contradict_it(method: Any) -> None:
    """Shares of 1/4, 1/2, 1/2, 1/2, 3/4 and 1, where no curve rises and stays as these do."""
    table = pd.concat(
        [shares_with_a_step().assign(motion=lambda t, k=k: t["motion"] + 40 * k) for k in range(3)]
    )
    curve = fragility_curve(table, "drift", 1.0, "im", method=method, samples=5)
    assert curve.comparison["beyond"].tolist() == [30, 60, 60, 60, 90, 120]
    assert curve.outcome == curve.row()["outcome"] == "contradicted"
    assert curve.estimate.known
    (worst,) = [row for row in curve.comparison.to_dict("records") if row["im"] == 6.0]
    tail = 0.025 / 6
    share = curve.probability([6.0])[0]
    assert worst["low"] == binom.ppf(tail, 120, share)
    assert worst["high"] == binom.ppf(1.0 - tail, 120, share)
    assert "dispersion" in repr(curve)
    assert find_half(curve.comparison) == (1.0, 2.0)
    assert find_half(curve.comparison[1:]) is None
    fewer = fragility_curve(
        table[table["motion"] % 10 == 0], "drift", 1.0, "im", method=method, samples=5
    )
    assert fewer.outcome != "contradicted"


@pytest.mark.parametrize(
    ("motions", "lowest"), [(5, np.nan), (6, 1.0), (7, 4.0), (8, 5.0), (12, 5.0)]
)
def test_a_capacity_that_none_exceeds_is_above_the_largest_intensity_of_six_motions(
    motions: int, lowest: float
) -> None:
    """The sixth largest of the largest intensities of the motions, by whichever capacity."""
    largest = [1.0, 4.0, *[5.0] * (motions - 2)]
    motion = np.repeat(np.arange(motions), 2)
    table = pd.DataFrame({"motion": motion, "im": 0.5, "drift": 0.1})
    table.loc[1::2, "im"] = largest
    for capacity in (1.0, 3.0):
        curve = fragility_curve(table, "drift", capacity, "im", samples=20)
        assert curve.outcome == "none_beyond"
        assert_allclose(curve.row()["median_low"], lowest)


def test_a_ratio_of_no_exceedances_lies_in_its_band() -> None:
    cold = hazard.Rate(rate=0.0, low=0.0, high=0.1, family=np.linspace(0.01, 0.1, 50), groups=12)
    warm = hazard.Rate(rate=0.5, low=0.4, high=0.6, family=np.linspace(0.4, 0.6, 50), groups=12)
    quotient, low, high = hazard.ratio(cold, warm)
    assert (quotient, low) == (0.0, 0.0)
    assert 0.0 < high < 0.3
    assert hazard.ratio(warm, cold)[::2] == (np.inf, np.inf)


def test_capacities_that_are_not_known_contradict_no_curve() -> None:
    """Two of three curves end below 3, so that they may or may not have reached it there."""
    crossings = pd.DataFrame({"low": [1.0, 1.0, 2.0], "high": [2.0, np.inf, np.inf]})
    counts = reached_counts(crossings, np.array([3.0, 1.0, 2.0, 1.0]), "im")
    assert counts["im"].tolist() == [1.0, 2.0, 3.0]
    assert counts["beyond"].tolist() == [0, 1, 1]
    assert counts["most"].tolist() == [0, 2, 3]
    many = pd.concat([crossings] * 40)
    at = reached_counts(many, np.array([1.0, 2.0, 3.0]), "im")
    surely = compare_counts(at, "im", lambda im: np.where(np.asarray(im) > 2.5, 0.99, 0.4), 0.95)
    assert find_contradiction(surely.iloc[[2]]) is None
    never = compare_counts(at, "im", lambda im: np.full(len(im), 0.01), 0.95)
    contradiction = find_contradiction(never) or pytest.fail("one third exceed")
    assert (contradiction.beyond, contradiction.runs) == (40, 120)
    assert len(reached_counts(crossings, np.geomspace(1.0, 9.0, 200), "im")) == 10


def many_levels(runs: int) -> pd.DataFrame:
    """Thirteen levels of the intensity 1 to 13, of which all runs exceed the capacity above 5."""
    motion, im = np.repeat(np.arange(runs), 13), np.tile(np.arange(1.0, 14.0), runs)
    return pd.DataFrame({"motion": motion, "im": im, "drift": np.where(im > 5.0, 2.0, 0.1)})


@pytest.mark.parametrize("method", ["stripes", "ida", "cloud"])
def test_counts_of_many_levels_are_those_of_each_level(method: Any) -> None:
    table = many_levels(4)
    table["drift"] *= 1.0 + 0.1 * table["motion"]
    table.loc[(table["im"] == 6.0) & (table["motion"] < 2), "drift"] = 0.5
    curve = fragility_curve(table, "drift", 1.0, "im", method=method, samples=5)
    compared = curve.comparison
    assert_allclose(compared["im"], np.arange(1.0, 14.0))
    assert compared["first"].tolist() == compared["last"].tolist() == list(range(1, 14))
    assert compared["beyond"].tolist() == [0, 0, 0, 0, 0, 2, *[4] * 7]
    assert find_half(compared) == (5.0, 6.0)
    tail = 0.025 / 13
    share = float(curve.probability([6.0])[0])
    row = compared.iloc[5]
    assert (row["low"], row["high"]) == (binom.ppf(tail, 4, share), binom.ppf(1 - tail, 4, share))


@pytest.mark.parametrize("runs", [100, 1000])  # above 200 in classes of their own
def test_counts_of_drawn_intensities_are_in_ten_classes_with_their_ends(runs: int) -> None:
    im = np.random.default_rng(1).uniform(1.0, 9.0, runs)
    beyond = im > np.random.default_rng(2).uniform(3.0, 7.0, runs)
    table = pd.DataFrame({"motion": range(runs), "im": im, "drift": np.where(beyond, 2.0, 0.1)})
    compared = fragility_curve(table, "drift", 1.0, "im", samples=5).comparison
    ordered = np.sort(im).reshape(10, -1)
    assert compared["runs"].tolist() == [runs // 10] * 10
    assert_allclose(compared["first"], ordered[:, 0])
    assert_allclose(compared["last"], ordered[:, -1])
    low, high = find_half(compared) or pytest.fail("half exceed at the largest")
    shares = (compared["beyond"] / compared["runs"]).to_numpy()
    k = int((shares >= 0.5).argmax())
    assert (low, high) == (ordered[k - 1, 0], ordered[k, -1])


@pytest.mark.parametrize(("share", "contradicts"), [(0.54, False), (0.56, True), (0.44, True)])
def test_small_differences_of_very_many_runs_contradict_no_curve(
    share: float, contradicts: bool
) -> None:
    runs = 100_000
    counts = pd.DataFrame({"im": [1.0], "runs": [runs], "beyond": [int(share * runs)]})
    compared = compare_counts(counts, "im", lambda im: np.full(len(im), 0.5), 0.95)
    assert not compared["low"][0] <= counts["beyond"][0] <= compared["high"][0]
    assert (find_contradiction(compared) is not None) == contradicts


def test_the_mean_of_curves_that_contradict_their_runs_does_so_too() -> None:
    cold = shares_with_a_step().assign(motion=lambda t: t["motion"] % 40, ambient_degC=-20.0)
    cold = pd.concat([cold.assign(motion=cold["motion"] + 40 * k) for k in range(3)])
    warm = cold.assign(ambient_degC=23.0, drift=cold["drift"] * 0.01)
    curves = fragility_curves(
        pd.concat([cold, warm], ignore_index=True), "drift", 1.0, "im", "ambient_degC", samples=40
    )
    assert [curve.outcome for curve in curves.values()] == ["contradicted", "none_beyond"]
    climate, never = (combine_curves(curves, [share, 1.0 - share]) for share in (0.3, 0.0))
    assert (climate.outcome, never.outcome) == ("contradicted", "none_beyond")
    assert "-20" in climate.misfit
    rate = hazard.annual_rate(climate, HAZARD)
    assert rate.outcome == "contradicted"
    assert hazard.RATE_OF_MISFIT in rate.notes


@pytest.mark.parametrize(("count", "motions"), [(1, 6), (7, 6), (1000, 12), (1001, 300)])
def test_medians_of_samples_are_those_of_the_sums_up_to_each_value(
    count: int, motions: int
) -> None:
    rng = np.random.default_rng(count)
    ordered = np.sort(rng.normal(size=count))
    groups = rng.integers(0, motions, count)
    weights = rng.multinomial(motions, np.full(motions, 1.0 / motions), size=300).astype(float)
    sums = weights[:, groups].cumsum(axis=1)
    sums = sums[sums[:, -1] > 0.0]
    expected = ordered[(sums >= 0.5 * sums[:, -1:]).argmax(axis=1)]
    np.testing.assert_array_equal(_medians(ordered, groups, weights), expected)


def test_a_temperature_at_which_nothing_went_beyond_counts_with_zero_in_a_climate() -> None:
    cold = two_levels([0.1, 0.1, 0.1, 3.0], [0.1, 3.0, 3.0, 3.0]).assign(ambient_degC=-20.0)
    warm = two_levels([0.1] * 4, [0.1] * 4).assign(ambient_degC=23.0)
    table = pd.concat([cold, warm], ignore_index=True)
    result = fragility_curves(table, "drift", 1.0, "im", "ambient_degC", samples=40)
    climate = combine_curves(result, [0.25, 0.75])
    assert climate.probability([1.5]) == pytest.approx(0.25 * result[-20.0].probability([1.5]))
    low, high = climate.band_at([1.5])
    assert low[0] <= climate.probability([1.5])[0] <= high[0]
    assert hazard.annual_rate(result[23.0], HAZARD).rate == 0.0
    assert climate.counts["runs"].tolist() == [8, 8]
    # A quarter of the time never reaches one half, three quarters do where the cold has 2/3.
    assert climate.outcome == "completed"
    assert np.isnan(climate.median)
    mostly_cold = combine_curves(result, [0.75, 0.25])
    assert result[-20.0].probability([mostly_cold.median])[0] == pytest.approx(2.0 / 3.0)
    assert mostly_cold.outcome == hazard.annual_rate(mostly_cold, HAZARD).outcome == "completed"


def test_a_temperature_without_a_curve_matters_where_it_comes() -> None:
    cold = two_levels([0.1, 0.1, 0.1, 3.0], [0.1, 3.0, 3.0, 3.0]).assign(ambient_degC=-20.0)
    falls = two_levels([3.0] * 4, [0.1] * 4).assign(ambient_degC=40.0)
    table = pd.concat([cold, falls], ignore_index=True)
    result = fragility_curves(table, "drift", 1.0, "im", "ambient_degC", samples=5)
    never, often = (combine_curves(result, [1.0 - s, s]) for s in (0.0, 0.1))
    assert never.probability([1.5]) == result[-20.0].probability([1.5])
    assert never.median == result[-20.0].median > 0.0
    assert np.isnan(often.probability([1.5])).all()


def test_demand_classes_and_failures() -> None:
    rng = np.random.default_rng(1)
    air = rng.uniform(-20.0, 30.0, 240)
    table = split_runs(ambient_degC=air, drift=50.0 - air, bearing=["a", "b"] * 120)
    table["outcome"] = "completed"
    table.loc[air < -18.0, ["drift", "outcome"]] = [np.nan, "not_converged"]
    result = demand_against(table, "drift", by=("bearing",))
    assert result["bearing"].tolist() == ["a"] * 12 + ["b"] * 12
    assert result["runs"].sum() + result["failed"].sum() == 240
    assert (result["0.16"] <= result["0.5"]).all()
    assert (np.diff(result["mean"][:12]) < 0.0).all()
    asked = demand_against(table, "drift", by=("bearing",), failed="collapse")
    assert np.isinf(asked["mean"][0])
    assert asked["runs"].sum() == 240


@pytest.mark.parametrize(("count", "level"), [(5, 0.95), (6, 0.95), (40, 0.9), (1, 0.95)])
def test_band_of_a_median_holds_it_as_often_as_it_says(count: int, level: float) -> None:
    """Of n values k are below the median with the chance of n throws of a coin."""
    low, high = _median_places(count, level)
    throws = np.array([1.0])
    for _ in range(count):
        throws = np.convolve(throws, [0.5, 0.5])
    held = throws[max(low + 1, 0) : high + 1].sum()
    narrower = throws[max(low + 2, 0) : high].sum()
    assert held >= level > narrower


def test_curves_of_single_motions() -> None:
    table = split_runs(
        motion=["a"] * 3 + ["b"] * 3,
        scale=[1.0, 2.0, 3.0] * 2,
        drift=[1.0, 3.0, 2.0, 2.0, 3.0, np.nan],
        outcome=["completed"] * 5 + ["not_converged"],
    )
    out = ida_curves(table, "drift", "scale")
    asked = ida_curves(table, "drift", "scale", failed="collapse")
    # In logarithms between two runs, linear from zero.
    first = 2.0 ** (np.log(2.5) / np.log(3.0))
    second = 2.0 ** (np.log(2.5 / 2.0) / np.log(3.0 / 2.0))
    capacities = out.crossings(2.5)
    assert_allclose(capacities["capacity"], [first, second], rtol=1e-12)
    assert capacities["low"].tolist() == capacities["high"].tolist()
    steeper = table.assign(drift=[0.7, 3.0, 2.0, 2.0, 3.0, np.nan])  # than the square of the scale
    capacities = ida_curves(steeper, "drift", "scale").crossings(2.5)
    assert capacities["low"].tolist()[0] == 1.0
    assert capacities["high"].tolist()[0] == 2.0
    assert out.crossings(1.75)["capacity"].tolist()[1] == 0.875  # the first crossing
    assert out.crossings(4.0)["capacity"].tolist() == [np.inf, np.inf]
    assert out.crossings(4.0)["largest"].tolist() == [3.0, 2.0]
    assert asked.crossings(4.0)["capacity"].tolist() == [np.inf, 2.0]
    assert asked.crossings(4.0)["low"].tolist() == [3.0, 2.0]
    assert asked.crossings(4.0)["high"].tolist() == [np.inf, 3.0]
    spread = asked.fractiles(np.array([0.5, 2.0, 2.5]), [0.0, 0.5, 1.0])
    assert spread["0"].tolist() == [0.5, 3.0, 2.5]
    assert spread["1"].tolist() == [1.0, 3.0, np.inf]
    assert out.fractiles()["curves"].tolist() == [2, 2, 1]


FAULTS: list[tuple[Any, str]] = [
    (lambda t: fragility_curve(t, "drfit", 1.0, "im"), 'did you mean "drift"'),
    (lambda t: fragility_curve(t, "drift", 0.0, "im"), "capacity = 0"),
    (lambda t: fragility_curve(t, "drift", 1.0, "im", method="clod"), "stripes"),
    (lambda t: fragility_curve(t, "drift", 1.0, "im", level=95), "level = 95"),
    (lambda t: fragility_curve(t, "drift", 1.0, "im", samples=0), "samples = 0"),
    (lambda t: fragility_curve(t.assign(im=-1.0), "drift", 1.0, "im"), "has -1"),
    (lambda t: fragility_curve(t.assign(im=1.0), "drift", 1.0, "im"), "two intensities"),
    (
        lambda t: fragility_curve(t.assign(drift=-1.0), "drift", 1.0, "im", method="cloud"),
        "without a logarithm",
    ),
    (lambda t: fragility_curve(t.assign(drift="x"), "drift", 1.0, "im"), 'column "drift"'),
    (lambda t: fragility_curve(t.assign(drift=np.nan), "drift", 1.0, "im"), "have no number"),
    (lambda t: counted(t.assign(outcome="broken"), "drift"), "none of 8 runs"),
    (lambda t: counted(t, "drift", "ignored"), '"left-out" or "collapse"'),
    (lambda t: ida_curves(t.assign(motion="a"), "drift", "im"), "two runs of motion a"),
    (lambda t: ida_curves(t.assign(motion=range(len(t))), "drift", "im"), "`paired = true`"),
    (lambda t: fragility_curves(t.assign(im=1.0), "drift", 1.0, "im", "motion"), "motion = 0"),
    (lambda t: sobol_table(t, "drift"), 'no column "matrix"'),
    (lambda t: variance_shares(t.assign(drift=1.0), "drift", ["im"]), "at least 8"),
    (lambda t: hazard.Hazard([1.0, 2.0], [1.0, 2.0]), "rate of a hazard curve must decrease"),
    (lambda t: hazard.Hazard([1.0, 1.0], [2.0, 1.0]), "from 1 to 1"),
    (lambda t: hazard.Hazard([1.0], [2.0]), "2 numbers or more"),
    (lambda t: hazard.Hazard(["a", "b"], [2.0, 1.0]), "list of numbers"),
    (lambda t: hazard.Hazard([0.0, 1.0], [2.0, 1.0]), "intensity of a hazard curve"),
    (lambda t: hazard.shares_of_time([0.0], [np.nan]), "without gaps"),
    (lambda t: hazard.shares_of_time([0.0, 0.0], [1.0]), "twice"),
    (lambda t: combine_curves({}, np.ones(1)), "must be 1"),
]


@pytest.mark.parametrize(("ask", "message"), FAULTS)
def test_bad_input_has_one_message(ask: Any, message: str) -> None:
    table = two_levels([0.1, 0.2, 0.3, 3.0], [0.4, 3.0, 4.0, 5.0])
    with pytest.raises(InputError, match=r".") as caught:
        ask(table)
    assert message in str(caught.value)


def test_hazard_file_needs_rates_or_periods(tmp_path: Any) -> None:
    file = tmp_path / "site.csv"
    file.write_text("PGA [m/s^2]\n1\n4\n")
    with pytest.raises(InputError, match=r"site\.csv.*rate"):
        hazard.load_hazard(file)
    file.write_text("PGA [m/s^2],return_period [year]\n1,50\n4,1000\n")
    assert hazard.load_hazard(file).rate.tolist() == [0.02, 0.001]
    assert np.isnan(hazard.load_hazard(file).at([0.9, 4.1])).all()
    file.write_text("PGA [m/s^2],rate [1/year]\n1,0.001\n4,0.02\n")
    with pytest.raises(InputError, match=r"site\.csv: rate"):
        hazard.load_hazard(file)
