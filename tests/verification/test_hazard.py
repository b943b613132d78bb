"""Annual rates against the closed form, climates against their parts."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from tests import tolerances
from thermobearing.studies.statistics.fragility import Fragility
from thermobearing.studies.statistics.hazard import (
    ClimateFragility,
    Hazard,
    Rate,
    annual_rate,
    ratio,
    shares_of_time,
)
from thermobearing.studies.statistics.likelihood import Curves, Estimate


def closed_form(median: float, dispersion: float, factor: float, exponent: float) -> float:
    """Cornell's rate for a lognormal fragility and a hazard of factor * im ** -exponent."""
    return float(factor * median**-exponent * np.exp(0.5 * (exponent * dispersion) ** 2))


def lognormal(median: float, dispersion: float, others: int = 1) -> Fragility:
    place, slope = np.log([median]), np.array([1.0 / dispersion])
    spread = np.linspace(-0.1, 0.1, others)
    estimate = Estimate(Curves(place, slope), Curves(place + spread, np.repeat(slope, others)))
    counts = pd.DataFrame({"im": [1.0], "runs": [1], "beyond": [0]})
    settings = ("drift", "im", 1.0, estimate, "bootstrap", 0.95, 1, counts, 0, 0)
    return Fragility("", "stripes", *settings)  # type: ignore[arg-type]


def power_law(exponent: float, ends: tuple[float, float] = (1e-3, 1e4), points: int = 9) -> Hazard:
    im = np.geomspace(*ends, points)
    return Hazard(im, 1e-2 * im**-exponent, "PGA")


@pytest.mark.parametrize("exponent", [1.0, 2.5, 4.0])
@pytest.mark.parametrize("dispersion", [0.05, 0.3, 0.6])
def test_power_law_has_a_closed_form(exponent: float, dispersion: float) -> None:
    found = annual_rate(lognormal(2.0, dispersion), power_law(exponent))
    exact = closed_form(2.0, dispersion, 1e-2, exponent)
    assert found.rate == pytest.approx(exact, rel=tolerances.HAZARD)
    assert found.notes == ()


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
    found = annual_rate(lognormal(median, dispersion), Hazard(im, rate))
    assert found.rate == pytest.approx(exact, rel=tolerances.HAZARD)


def test_ends_of_the_hazard_curve_are_told() -> None:
    early = annual_rate(lognormal(2.0, 0.4), power_law(2.0, (1e-3, 2.0)))
    late = annual_rate(lognormal(2.0, 0.4), power_law(2.0, (1.5, 1e3)))
    assert "ends at 2" in early.notes[0]
    assert "begins at 1.5" in late.notes[0]
    # What goes beyond at the end already is counted, and nothing is to be told.
    assert annual_rate(lognormal(0.5, 0.1), power_law(2.0, (1e-3, 2.0))).notes == ()
    # What is beyond the end counts with the probability there.
    assert early.rate < closed_form(2.0, 0.4, 1e-2, 2.0)
    jump = annual_rate(lognormal(1.9, 1e-4), power_law(2.0, (1e-3, 2.0)))
    assert jump.rate == pytest.approx(1e-2 / 1.9**2, rel=2 * tolerances.HAZARD_JUMP)


def test_years_and_return_period() -> None:
    found = annual_rate(lognormal(2.0, 0.4), power_law(2.0))
    assert found.return_period == pytest.approx(1.0 / found.rate)
    assert found.probability(50.0) == pytest.approx(1.0 - np.exp(-50.0 * found.rate))


def test_band_and_ratio_of_rates() -> None:
    """Every sample of the cold has 0.8 of the warm median: rates go with its power."""
    warm, cold = lognormal(2.0, 0.4, 21), lognormal(1.6, 0.4, 21)
    hazard = power_law(2.0)
    a, b = annual_rate(cold, hazard), annual_rate(warm, hazard)
    found = ratio(a, b)
    assert found == pytest.approx([0.8**-2.0] * 3, rel=tolerances.HAZARD)
    assert (a.low, a.high) == pytest.approx(
        (a.rate * np.exp(-0.2), a.rate * np.exp(0.2)), rel=tolerances.HAZARD
    )


def test_the_band_of_a_ratio_is_of_the_samples_alone() -> None:
    cold = Rate(10.0, 0.0, 0.0, np.array([1.0, 3.0, 2.0, np.nan]))
    warm = Rate(1.0, 0.0, 0.0, np.ones(4))
    assert ratio(cold, warm) == (10.0, 1.0, 3.0)


def test_climate_is_the_mean_of_its_temperatures() -> None:
    parts = {
        -20.0: lognormal(1.6, 0.4, 5),
        23.0: lognormal(2.0, 0.3, 5),
        40.0: lognormal(9.0, 0.3, 5),
    }
    climate = ClimateFragility(parts, np.array([0.25, 0.75, 0.0]))
    hazard = power_law(2.0)
    rate = annual_rate(climate, hazard).rate
    exact = 0.25 * closed_form(1.6, 0.4, 1e-2, 2.0) + 0.75 * closed_form(2.0, 0.3, 1e-2, 2.0)
    assert rate == pytest.approx(exact, rel=tolerances.HAZARD)
    table = climate.rates(hazard)
    assert table["part"].sum() == pytest.approx(1.0)
    assert (table["share"] * table["rate"]).sum() == pytest.approx(rate)


def test_shares_of_time_keep_the_mean() -> None:
    rng = np.random.default_rng(1)
    hours = rng.uniform(-20.0, 30.0, 5000)
    levels = [30.0, -20.0, 0.0, 10.0]
    shares = shares_of_time(levels, hours)
    assert shares.sum() == pytest.approx(1.0)
    assert float(shares @ levels) == pytest.approx(hours.mean())
    assert shares_of_time([0.0, 10.0], [-5.0, 50.0]).tolist() == [0.5, 0.5]
    assert shares_of_time([3.0], [-5.0, 50.0]).tolist() == [1.0]
