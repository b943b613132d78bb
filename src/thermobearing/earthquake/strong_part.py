"""The part of a history that a figure shows: the strong part of the motion, and the peaks."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Floats = NDArray[np.float64]
FIRST, LAST = 0.05, 0.95  # of the Arias intensity
MARGIN = 0.2  # of the strong part, on both sides: the answer of the structure comes later


def strong_part(data: xr.Dataset, runs: Sequence[int], name: str = "") -> tuple[float, float]:
    """Start and end [s] of what is shown of some runs of one motion.

    Parameters
    ----------
    data : of an earthquake study.
    runs : their numbers.
    name : of the history that is shown; its largest values are within.

    Returns
    -------
    From 5 to 95 % of the Arias intensity of what was run and a fifth more on both sides; the
    whole time without an acceleration of the ground.
    """
    starts, ends, lasts = [], [], []
    for run in runs:
        time = data["time"].values[run].astype(float)
        told = np.isfinite(time)
        time, ground = time[told], data["ground_acceleration"].values[run][told].astype(float)
        if not len(time):
            continue
        growth = np.cumsum(ground**2)
        first, last = time[0], time[-1]
        if growth[-1] > 0.0:
            first, last = time[np.searchsorted(growth, [FIRST * growth[-1], LAST * growth[-1]])]
        room = MARGIN * (last - first)
        starts.append(first - room)
        ends.append(last + room)
        lasts.append(time[-1])
        peak = peak_of(data[name].values[run][told]) if name else None
        if peak is not None:
            starts.append(time[peak] - room)
            ends.append(time[peak] + room)
    if not lasts:
        return 0.0, 1.0
    return max(0.0, min(starts)), min(max(lasts), max(ends))


def peak_of(values: Floats) -> int | None:
    """Place of the largest absolute value; None where a value is missing."""
    return int(np.abs(values).argmax()) if np.isfinite(values).all() else None
