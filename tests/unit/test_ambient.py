"""Ambient temperature: means of a series over time steps are exact, ends are constant."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import SPECIMEN

NIGHT = tb.Ambient.series(np.array([10.0, 20.0, 40.0]), np.array([0.0, -10.0, 10.0]))


def test_constant() -> None:
    assert_array_equal(tb.Ambient.constant(-20.0).means(5.0, np.array([1.0, 2.0])), [-20.0, -20.0])


def test_points_between_and_beyond() -> None:
    assert [NIGHT.at(t) for t in (0.0, 10.0, 15.0, 20.0, 30.0, 99.0)] == [0, 0, -5, -10, 0, 10]


@pytest.mark.parametrize(
    ("start", "dt", "mean"),
    [
        (0.0, 5.0, 0.0),  # before the series begins
        (10.0, 5.0, -2.5),
        (8.0, 4.0, -0.5),  # over the first point: (2 * 0 + 2 * -1) / 4
        (15.0, 10.0, -7.5),  # over a turn: (5 * -7.5 + 5 * -7.5) / 10
        (10.0, 30.0, -5.0 / 3.0),  # the whole series in one step: (-50 + 0) / 30
        (0.0, 100.0, 5.5),  # and far beyond: (-50 + 60 * 10) / 100
        (90.0, 1.0, 10.0),
    ],
)
def test_means_by_hand(start: float, dt: float, mean: float) -> None:
    assert_allclose(NIGHT.means(start, np.array([dt])), [mean], rtol=tol.MEAN, atol=tol.MEAN)


def test_means_add_up_whatever_the_steps() -> None:
    """Sums over uneven steps that hit no point of the series equal the integral."""
    rng = np.random.default_rng(4)
    series = tb.Ambient.series(np.cumsum(rng.uniform(0.1, 9.0, 50)), rng.uniform(-40.0, 40.0, 50))
    dt = rng.uniform(0.001, 30.0, 40)
    span = dt.sum()
    fine = series.means(1.7, np.full(1000, span / 1000))
    total = float(series.means(1.7, dt) @ dt)
    assert_allclose(total, fine.sum() * span / 1000, rtol=tol.MEAN)
    inside = series.time[(series.time > 1.7) & (series.time < 1.7 + span)]
    nodes = np.concatenate([[1.7], inside, [1.7 + span]])
    values = [series.at(node) for node in nodes]
    assert_allclose(total, np.trapezoid(values, nodes), rtol=tol.MEAN)


def test_run_begins_at_the_start_of_the_series_and_follows_it() -> None:
    """After a long rest under a steady end of the series, the bearing has its temperature."""
    series = tb.Ambient.series([0.0, 600.0], [5.0, -15.0])
    test = tb.CyclicTest(steps=[{"step": "rest", "duration": 1e6}])
    result = tb.run(SPECIMEN, test, ambient=series)
    assert result["ambient"].values.tolist() == [5.0]
    assert_array_equal(result["initial_temperature"].values[0], 5.0)
    assert_allclose(result["final_temperature"].values[0], -15.0, atol=tol.SETTLED)


@pytest.mark.parametrize(
    ("time", "temperature", "words"),
    [
        ([0.0, 5.0, 5.0], [0.0, 1.0, 2.0], "does not increase from 5 to 5 s"),
        ([0.0, 5.0, 4.0], [0.0, 1.0, 2.0], "does not increase from 5 to 4 s"),
        ([0.0, 5.0], [0.0, 101.0], "101 degC is outside -100 to 100 degC"),
        ([0.0, 5.0], [-101.0, 0.0], "-101 degC is outside"),
        ([0.0], [0.0], "at least 2 numbers"),
        ([0.0, np.inf], [0.0, 0.0], "not finite"),
    ],
)
def test_unusable_series(time: list[float], temperature: list[float], words: str) -> None:
    with pytest.raises(tb.InputError, match=words):
        tb.Ambient.series(np.array(time), np.array(temperature))
