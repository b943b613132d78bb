"""Histories thinned to what can be seen, with few digits, for pictures that a reader can zoom."""

import numpy as np
from numpy.typing import NDArray

from thermobearing.results.drawing import thin, thin_loops

Floats = NDArray[np.float64]
POINTS = 600  # of a history
DIGITS = 5  # of a number


def rounded(values: Floats, digits: int = DIGITS) -> Floats:
    """Numbers with so many digits; NaN stays.

    Examples
    --------
    >>> rounded(np.array([1.23456789, 0.0, np.nan])).tolist()
    [1.2346, 0.0, nan]
    """
    values = np.asarray(values, dtype=float)
    size = np.where(np.isfinite(values) & (values != 0.0), np.abs(values), 1.0)
    scale = 10.0 ** (digits - 1 - np.floor(np.log10(size)))
    return np.round(values * scale) / scale


def history(x: Floats, y: Floats, points: int = POINTS) -> tuple[Floats, Floats]:
    """A history with about so many points; the extremes of each stretch stay.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 10_001)
    >>> x, y = history(t, np.sin(100.0 * t))
    >>> len(x) < 700, bool(y.max() > 0.9999)
    (True, True)
    """
    kept = thin(y, max(points // 2, 1))
    return rounded(x[kept]), rounded(y[kept])


def path(x: Floats, y: Floats, points: int = POINTS) -> tuple[Floats, Floats]:
    """A path in the plane, a loop, with about so many points; its turning points stay."""
    told = np.isfinite(x) & np.isfinite(y)
    x, y = x[told], y[told]
    if len(x) < 3:
        return rounded(x), rounded(y)
    width, height = (max(float(np.ptp(v)), 1e-12) for v in (x, y))
    kept = thin_loops(x, y, width, height, points // 2)
    return rounded(x[kept]), rounded(y[kept])
