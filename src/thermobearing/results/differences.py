"""How far one model is from another, in the numbers that every comparison shows."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def temperature_differences(place: str, found: Floats, expected: Floats) -> dict[str, float]:
    """Root mean square and largest error of a temperature, with its sign [K].

    Examples
    --------
    >>> temperature_differences("lead", np.array([1.0, -3.0]), np.array([0.0, 0.0]))
    {'lead rms K': 2.23606797749979, 'lead largest K': -3.0}
    """
    error = found - expected
    return {
        f"{place} rms K": float(np.sqrt(np.mean(error**2))),
        f"{place} largest K": float(error[np.abs(error).argmax()]),
    }


def force_differences(found: Floats, expected: Floats) -> dict[str, float]:
    """Root mean square error of a force and error of its peak, of the expected peak [%].

    Examples
    --------
    >>> force_differences(np.array([1.0, -3.0]), np.array([1.0, -2.0]))["peak force %"]
    50.0
    """
    peak = float(np.abs(expected).max())
    rms = float(np.sqrt(np.mean((found - expected) ** 2)))
    return {"force rms %": per_cent(rms, peak), "peak force %": more(np.abs(found).max(), peak)}


def per_cent(part: float, whole: float) -> float:
    """A part of a whole [%]; NaN of nothing."""
    return 100.0 * part / whole if whole else float("nan")


def more(found: float, expected: float) -> float:
    """How much more than expected [%]; NaN of nothing."""
    return per_cent(float(found) - float(expected), float(expected))
