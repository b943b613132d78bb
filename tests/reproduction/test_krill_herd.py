"""Krill herd, the search of the source: known functions, and the same fit as least squares."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from reproduction.krill_herd import krill_herd, krill_herd_search
from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.identify.fit.synthetic import generic_start, synthetic_record
from thermobearing.identify.run import identify_bearing


def test_it_begins_at_the_start_and_keep_the_best() -> None:
    points: list[np.ndarray] = []

    def objective(u: np.ndarray) -> float:
        points.append(u.copy())
        return float(((u - 0.3) ** 2).sum())

    start = np.array([0.31, 0.29, 0.3])
    herd = krill_herd(objective, 3, evaluations=300, population=10, seed=1, start=start)
    assert_allclose(points[0], start)
    assert herd.value <= objective(start)
    assert herd.evaluations == len(points) - 1 <= 300
    assert herd.value == min(float(((u - 0.3) ** 2).sum()) for u in points)
    assert_allclose(objective(herd.best), herd.value)


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
        assert all(herd.evaluations <= 5000 for herd in runs)
        median = float(np.median([herd.value for herd in runs]))
        measured(f"Krill Herd, 7-D {name}, median of 5", median, f"<= {limit:g}")
        assert median <= limit


def test_krill_herd_repeats_itself_and_takes_negative_functions() -> None:
    runs = [krill_herd(lambda u: _sphere(u) - 100.0, 3, evaluations=600, seed=4) for _ in "ab"]
    assert runs[0].value == runs[1].value < -90.0
    assert all(b <= a for a, b in zip(runs[0].history[:-1], runs[0].history[1:], strict=True))


@pytest.mark.thorough
def test_it_ends_at_the_same_place_as_least_squares() -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    test = tb.cyclic_test(strain=[0.5, 2.0], cycles=2, rest=None)
    record = synthetic_record(bearing, 23.0, test, sampling=25.0)
    start = generic_start(bearing)
    best = identify_bearing(record, start)
    other = identify_bearing(record, start, search=krill_herd_search(600))
    assert other.method == "krill_herd_search"
    for key, item in best.uncertainty.estimates.items():
        assert abs(other.values[key] - item.value) < 0.1 * item.stderr, key
