"""Sums of products in a fixed order."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from thermobearing.results.sums import product_in_order, sum_of_products

STREAM = np.random.default_rng(7)


def test_sum_of_products_is_that_of_any_order() -> None:
    first, second = STREAM.normal(size=(2, 1000)) * 10.0 ** STREAM.integers(-8, 9, (2, 1000))
    expected = sum_of_products(first, second)
    for _ in range(5):
        order = STREAM.permutation(1000)
        assert sum_of_products(first[order], second[order]) == expected
    assert sum_of_products([1e16, 1.0, -1e16], np.ones(3)) == 1.0
    assert np.isnan(sum_of_products([np.nan, 1.0], [1.0, 1.0]))


def test_products_are_added_from_the_first_column_on() -> None:
    left, right = STREAM.normal(size=(50, 9)), STREAM.normal(size=(9, 2))
    right[[0, 4]] = 0.0
    expected = np.zeros((50, 2))
    for k in range(9):
        for i in range(50):
            for j in range(2):
                expected[i, j] += left[i, k] * right[k, j]
    assert_array_equal(product_in_order(left, right), expected)
    assert_array_equal(product_in_order(left, right[:, 0]), expected[:, 0])
    assert_allclose(product_in_order(left, right), left @ right, rtol=1e-12, atol=1e-13)
    assert_array_equal(product_in_order(left, np.zeros(9)), np.zeros(50))
