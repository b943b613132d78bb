"""Places of the largest and least values: ties within rounding go to the first of the input."""

import math

import numpy as np
import pytest

from thermobearing.earthquake.measures import signed_peak
from thermobearing.quantities.governing import (
    TIE,
    largest_by,
    least_by,
    order_from_largest,
    order_from_least,
    place_of_largest,
    place_of_least,
    places_of_largest,
)
from thermobearing.results.metrics import find_largest_loop

ROUNDING = 1e-12  # less than the tolerance, more than sums of a thousand numbers lose
NAN, INFINITE = math.nan, math.inf


def test_the_tolerance_is_the_documented_one() -> None:
    assert TIE == 1e-9


@pytest.mark.parametrize("size", [1.0, -1.0, 1e-6, 1e9])
def test_first_of_equal_values_governs(size: float) -> None:
    nudge = abs(size) * ROUNDING
    equal = [size - abs(size), size, size + nudge, size - nudge]
    assert place_of_largest(equal) == 1
    assert place_of_least([-value for value in equal]) == 1
    assert order_from_largest(equal).tolist() == [1, 2, 3, 0]
    assert order_from_least([-value for value in equal]).tolist() == [1, 2, 3, 0]


def test_values_that_differ_by_more_than_the_tolerance_are_no_tie() -> None:
    apart = [1.0, 1.0 + 3.0 * TIE]
    assert place_of_largest(apart) == 1
    assert place_of_least(apart[::-1]) == 1
    assert order_from_largest(apart).tolist() == [1, 0]


def test_tolerance_is_relative_to_the_largest_magnitude() -> None:
    assert place_of_largest([-20.0, 1e-15, 2e-15]) == 1  # temperatures around zero


def test_order_keeps_a_chain_of_distinct_values() -> None:
    values = np.random.default_rng(1).permutation(1000) / 1000.0
    assert order_from_largest(values).tolist() == np.argsort(-values).tolist()


def test_nan_never_governs() -> None:
    assert place_of_largest([NAN, 1.0, 2.0]) == 2
    assert place_of_least([NAN, 1.0, 2.0]) == 1
    assert place_of_largest([NAN, NAN]) == 0
    assert order_from_largest([NAN, -INFINITE, INFINITE, 2.0]).tolist() == [2, 3, 1, 0]
    assert order_from_largest([]).tolist() == []


def test_infinity_governs() -> None:
    assert place_of_largest([1.0, INFINITE, INFINITE]) == 1
    assert place_of_least([1.0, -INFINITE]) == 1


def test_rows_of_an_array_are_decided_each() -> None:
    rows = [[1.0, 2.0, 2.0 + ROUNDING], [NAN, NAN, NAN], [1e9, 2.0, 1e9]]
    assert places_of_largest(rows).tolist() == [1, 0, 0]


def test_items_by_size() -> None:
    runs = [("A1", 1.0), ("A2", 1.0 + ROUNDING), ("A3", 0.5), ("A4", 0.5 - ROUNDING)]
    assert largest_by(runs, lambda run: run[1])[0] == "A1"
    assert least_by(runs, lambda run: run[1])[0] == "A3"


def test_sign_of_the_farthest_part_is_that_of_the_first() -> None:
    assert signed_peak([1.0, -1.0 - ROUNDING]) == 1.0
    assert signed_peak([-1.0, 1.0 + ROUNDING]) == -1.0


def test_later_of_equal_excursions_makes_the_largest_loop() -> None:
    """Of equal excursions before and after the largest, the later counts, also within rounding."""
    angle = np.linspace(0.0, 3.0 * np.pi, 301)
    loops = []
    for deeper in (-ROUNDING, 0.0, ROUNDING):
        sizes = np.where(angle < np.pi, 0.8 + deeper, np.where(angle < 2.0 * np.pi, 1.0, 0.8))
        loops.append(find_largest_loop(sizes * np.sin(angle)))
    assert loops[0] is not None
    assert loops[0] == loops[1] == loops[2]
