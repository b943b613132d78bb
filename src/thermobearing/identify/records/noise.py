"""What a logger adds to a signal: noise, estimated robustly, and spikes. Nothing is filtered."""

import math

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.records import Floats

# Sixth differences take away what is smooth: of a sine of 40 samples a cycle they leave 1e-5,
# where second differences leave 2 %, more than the noise that is sought.
ORDER = 6
GAIN = math.sqrt(math.comb(2 * ORDER, ORDER))  # of their standard deviation, over white noise
NORMAL = 1.4826  # standard deviation over median absolute deviation of normal noise
NONE = 1e-6  # of the peak: rounding, and no noise
WINDOW = 7  # samples of the running median: spikes of up to three are seen
SURE = 8.0  # of the noise: that of filtered noise is measured too small by up to a half
OF_SPAN = 0.5  # of what the force does anyway within the window: the tip of a loop is no spike
SMALL = 0.02  # of the peak: smaller ones do a fit no harm


def estimate_noise(values: Floats) -> float:
    """Return the standard deviation of the noise of a signal; 0 without noise.

    It comes from the median absolute sixth difference, which neither the motion nor spikes move.
    """
    if len(values) <= ORDER + 1:
        return 0.0
    noise = NORMAL * float(np.median(np.abs(np.diff(values, ORDER)))) / GAIN
    return noise if noise > NONE * float(np.abs(values).max()) else 0.0


def find_spikes(values: Floats, possible: Floats | float = 0.0) -> NDArray[np.bool_]:
    """Return which samples leap out of a signal and come back.

    A Hampel test for loops: a sample is a spike if it lies outside all running medians around it
    by more than eight times the noise, by more than half of what the signal does there anyway, so
    that the tip of a loop is none, and by more than the motion makes possible.
    """
    from scipy.ndimage import maximum_filter1d, median_filter, minimum_filter1d

    level = median_filter(values, WINDOW, mode="nearest")
    # The first sees noise that repeats itself, the second noise on what is sampled sparsely.
    noise = max(NORMAL * float(np.median(np.abs(values - level))), estimate_noise(values))
    high, low = maximum_filter1d(level, WINDOW), minimum_filter1d(level, WINDOW)
    beyond = np.maximum(values - high, low - values)
    least = np.maximum(SURE * noise, SMALL * float(np.abs(level).max()))
    return np.asarray(beyond > np.maximum(least, OF_SPAN * (high - low)) + possible)


def bridged(time: Floats, values: Floats, bad: NDArray[np.bool_]) -> Floats:
    """Return a signal with its bad samples on straight lines between their good neighbours."""
    if not bad.any():
        return values
    good = ~bad
    return np.where(bad, np.interp(time, time[good], values[good]), values)


def split_runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the first and last sample of each run of flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]
