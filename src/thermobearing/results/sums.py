"""Sums of products in a fixed order, for numbers that results hold.

BLAS chooses by the type of processor in which order it adds, and whether it rounds products; so do
the residuals of balances and the ties of symmetric parts depend on it. These sums do not.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.core.records import Floats


def sum_of_products(first: ArrayLike, second: ArrayLike) -> float:
    """Return the sum of the products of two lists of numbers; only the products are rounded.

    >>> sum_of_products([1e16, 1.0, -1e16], [1.0, 1.0, 1.0])
    1.0
    """
    products = np.multiply(np.asarray(first, dtype=float), second)
    return math.fsum(products.tolist()) if np.isfinite(products).all() else float(products.sum())


def product_in_order(left: Floats, right: Floats) -> Floats:
    """Return ``left @ right``, where `left` is [.., n] and `right` [n] or [n, m]: column by column.

    Columns of `left` that meet zeros only, as most coordinates of a structure do, are left out.

    >>> product_in_order(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([10.0, 1.0])).tolist()
    [12.0, 34.0]
    """
    product = np.zeros((*left.shape[:-1], *right.shape[1:]))
    for k in range(len(right)):
        if right[k].any():
            column = left[..., k]
            product += column[..., np.newaxis] * right[k] if right.ndim > 1 else column * right[k]
    return product
