"""Bootstrap: runs drawn again with replacement, all runs of a motion at a time; its bands.

Runs of one motion at several intensities and temperatures are not independent of each other, so
that motions are drawn again with all their runs (the cluster bootstrap: Davison & Hinkley 1997,
Bootstrap Methods and their Application, 3.8). Bands are percentiles (Efron & Tibshirani 1993, An
Introduction to the Bootstrap, 13), of pivots or at a level `widened` for few motions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtr, stdtrit

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats, Ints

SAMPLES = 500  # of a bootstrap, by default
LEVEL = 0.95  # confidence of bands, by default
ROUNDING = 1e-9  # of a number of samples
MOST_AT_ONCE = 2_000_000  # numbers of one piece of work


def check_level(level: float) -> None:
    """Raise InputError for a confidence level that is not between 0 and 1."""
    if not 0.0 < level < 1.0:
        raise InputError(f"level = {level:g} is not between 0 and 1")


@dataclass(frozen=True)
class Draw:
    """How runs are drawn again."""

    groups: Ints  # number of the group of each run
    count: int  # of groups
    samples: int  # of the bootstrap
    seed: tuple[int, ...]  # of its generator
    alone: bool  # every run is a group by itself

    @classmethod
    def of_labels(
        cls, labels: Sequence[Any] | None, runs: int, samples: int = SAMPLES, seed: int = 0
    ) -> "Draw":
        """Return groups by their labels; without labels, or in one group, every run by itself."""
        if samples < 1 or seed < 0:
            raise InputError(f"samples = {samples} and seed = {seed}: at least 1, and 0")
        codes = np.arange(runs)
        if labels is not None:
            codes = np.asarray(pd.factorize(np.asarray(labels, dtype=object))[0], dtype=np.int64)
        if labels is None or codes.max(initial=0) == 0:
            return cls(np.arange(runs), runs, samples, (seed,), True)
        return cls(codes, int(codes.max()) + 1, samples, (seed,), False)

    def of(self, kept: NDArray[np.bool_]) -> "Draw":
        """Return the draw of some of the runs; groups stay the same, and are drawn the same."""
        if not self.alone:
            return replace(self, groups=self.groups[kept])
        count = int(kept.sum())
        seed = (*self.seed, int(kept.argmax()))  # single runs need not be drawn like others
        return replace(self, groups=np.arange(count), count=count, seed=seed)

    def generator(self) -> np.random.Generator:
        """Return a generator at its beginning."""
        return np.random.default_rng(self.seed)

    def weights(self) -> Iterator[Floats]:
        """Yield how often each group is in each sample, shape (some samples, groups)."""
        rng = self.generator()
        chunk = max(1, MOST_AT_ONCE // max(self.count, 1))
        shares = np.full(self.count, 1.0 / self.count)
        for first in range(0, self.samples, chunk):
            rows = min(chunk, self.samples - first)
            yield rng.multinomial(self.count, shares, size=rows).astype(float)

    def sums(self, values: Floats) -> Floats:
        """Return a row of sums over the runs of each sample, from a row of values for each run."""
        of_groups = np.zeros((self.count, values.shape[1]))
        np.add.at(of_groups, self.groups, values)
        return self.again(of_groups)

    def again(self, of_groups: Floats) -> Floats:
        """Return the sums of each sample, a row, from those of each group."""
        return np.concatenate([weights @ of_groups for weights in self.weights()])


def widened(level: float, groups: int) -> float:
    """Return the level whose percentiles hold the truth at `level`, with few groups too.

    Hesterberg (2015), The American Statistician 69(4): 371-386, 3.3: quantiles of Student's t, and
    sqrt(n / (n - 1)) for what a bootstrap of n groups is too narrow by; as it is below 2 groups.

    >>> round(widened(0.95, 12), 4), round(widened(0.95, 1000), 4)
    (0.9785, 0.9504)
    """
    if groups < 2:
        return level
    at = stdtrit(groups - 1.0, 0.5 * (1.0 + level)) * np.sqrt(groups / (groups - 1.0))
    return float(2.0 * ndtr(at) - 1.0)


def quantile(values: Floats, share: float) -> float:
    """Return a sample quantile with straight lines between values, some of which may be infinite.

    >>> quantile(np.array([1.0, 3.0, np.inf]), 0.5), quantile(np.array([1.0, 3.0, np.inf]), 0.75)
    (3.0, inf)
    """
    ordered = np.sort(np.asarray(values, dtype=float))
    place = share * (len(ordered) - 1)
    low = int(np.floor(place))
    part = place - low
    if part < 1e-12 or low + 1 >= len(ordered):
        return float(ordered[low])
    if np.isinf(ordered[low : low + 2]).any():
        return float(ordered[low + 1] if np.isinf(ordered[low + 1]) else ordered[low])
    return float(ordered[low] + part * (ordered[low + 1] - ordered[low]))


def percentiles(samples: Floats, level: float) -> tuple[Floats, Floats]:
    """Return the ends of the middle of samples, along their first axis.

    Ordered samples, equally many outside on either side, at level (count + 1): some may be
    infinite, between which nothing lies.
    """
    ordered = np.sort(samples, axis=0)
    outside = max(int(0.5 * (1.0 - level) * (len(ordered) + 1) + ROUNDING), 1)
    return np.asarray(ordered[outside - 1]), np.asarray(ordered[-outside])
