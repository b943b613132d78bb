"""Comparison of a fragility curve with the exceedances of the runs behind it.

At each level of the intensity, or in ten classes where more than ten intensities are drawn, the
number of exceedances is compared with the binomial interval of the curve. The intervals contain
all counts together with the confidence of the bands (Bonferroni), if the runs are independent.
Counts of stripes and of a cloud are those of runs; of IDA those of the single curves that have
reached the capacity, whose shares are the empirical distribution of their capacities.

Counts that determine no curve have bounds of the probability. It rises with the intensity: between
two intensities of the runs it is at least that of the smaller and at most that of the larger one.
The share of exceedances at an intensity with both outcomes is known within the interval of Clopper
& Pearson (1934, Biometrika 26: 404-413). Where no run exceeds the capacity the probability is taken
as 0, and where all do as 1, once enough runs have that outcome for a sign test of the median (six
at 95 %); the rate then lies between those of a median at either intensity.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy

from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.studies.statistics.ida import LEAST_AT_LEVEL

CONTRADICTED = "contradicted"  # outcome of a curve whose own runs are unlikely
# Of shares, our choice: of very many runs, smaller differences are significant and do not matter.
LEAST_DIFFERENCE = 0.05
MOST_COMPARED = 10  # classes of drawn intensities in which a curve is compared with the counts


class Contradiction(NamedTuple):
    """The count of runs that is furthest from a curve, outside the interval of the curve."""

    first: float  # intensity of the runs, of a class the smallest and the largest
    last: float
    beyond: int
    runs: int
    low: int  # ends of the binomial interval
    high: int


def are_levels(runs: Any) -> bool:
    """Return whether intensities with such numbers of runs are levels, not drawn ones.

    Of a level some runs may be left out, so that half of the intensities may have fewer.
    """
    return bool(np.median(runs) >= LEAST_AT_LEVEL)


def reached_counts(crossings: "pd.DataFrame", levels: Floats, name: str) -> "pd.DataFrame":
    """Return how many curves of IDA have reached a capacity at intensities of their runs.

    `crossings` is from `Ida.crossings`. Of more than ten drawn intensities, ten of equal distance
    in rank are taken. `beyond` are the curves that have reached the capacity, `most` also those
    whose capacity may be below or above: it lies between two of their runs, or above the last.
    """
    levels, runs_at = np.unique(levels, return_counts=True)
    if len(levels) > MOST_COMPARED and not are_levels(runs_at):
        ranks = (np.arange(MOST_COMPARED) + 0.5) * len(levels) / MOST_COMPARED
        levels = levels[ranks.astype(int)]
    low, high = (crossings[end].to_numpy(dtype=float)[None, :] for end in ("low", "high"))
    at = levels[:, None]
    beyond = (high <= at).sum(axis=1)
    unknown = ((low < at) & (at < high)).sum(axis=1)
    runs = np.full(len(levels), len(crossings))
    return pd.DataFrame({name: levels, "runs": runs, "beyond": beyond, "most": beyond + unknown})


def compare_counts(
    counts: "pd.DataFrame", name: str, probability: Callable[[Any], Floats], level: float
) -> "pd.DataFrame":
    """Return counts of levels or classes with the share of a curve and its binomial interval.

    Drawn intensities form at most ten classes of the same number of intensities, by more or less
    one; each level of more has a separate row, since a class would have no intensity of a run.

    Parameters
    ----------
    counts : DataFrame
        The intensity `name`, numbers of `runs` and of those `beyond` the capacity; `most` is the
        largest number that may be beyond, where that is not known of all, `first` and `last` are
        the smallest and the largest intensity of the runs, where they differ.
    name : str
        Column of the intensity.
    probability : callable
        Probability of exceedance of the curve at intensities.
    level : float
        Confidence of the intervals of all rows together.

    Returns
    -------
    DataFrame
        A row for each level or class: its mean intensity, the `first` and the `last` of its runs,
        `runs`, `beyond`, `most`, the mean `probability` of the curve, and the ends `low` and `high`
        of the interval, as numbers of runs.
    """
    at, runs, beyond = (counts[column].to_numpy(dtype=float) for column in (name, "runs", "beyond"))
    most = counts["most"].to_numpy(dtype=float) if "most" in counts else beyond
    first, last = (counts[end if end in counts else name] for end in ("first", "last"))
    has_levels = are_levels(np.where(first == last, runs, 0.0))
    rows_wanted = len(at) if has_levels else min(len(at), MOST_COMPARED)
    parts = np.array_split(np.arange(len(at)), rows_wanted)
    tail = 0.5 * (1.0 - level) / len(parts)
    rows = []
    for part in parts:
        total = int(runs[part].sum())
        share = float((runs[part] * probability(at[part])).sum() / total)
        possible = np.arange(total + 1.0)
        below = scipy.special.bdtr(possible, total, share)  # probability of at most so many
        low, high = (int(np.argmax(below >= end)) for end in (tail, 1.0 - tail))
        mean = float(np.exp((runs[part] * np.log(at[part])).sum() / total))
        row = {name: mean, "first": float(first.iloc[part[0]]), "last": float(last.iloc[part[-1]])}
        row |= {"runs": total, "beyond": int(beyond[part].sum())}
        row |= {"most": int(most[part].sum()), "probability": share, "low": low, "high": high}
        rows.append(row)
    return pd.DataFrame(rows)


def find_contradiction(comparison: "pd.DataFrame") -> Contradiction | None:
    """Return the count that is furthest outside the interval of a curve; None if all are likely.

    `comparison` is from `compare_counts`. Of a count that is not known, the nearest possible number
    counts. Shares that differ by less than `LEAST_DIFFERENCE` contradict no curve.
    """
    unlikely: list[tuple[float, Contradiction]] = []
    for row in comparison.to_dict("records"):
        beyond = int(np.clip(round(row["runs"] * row["probability"]), row["beyond"], row["most"]))
        distance = abs(beyond / row["runs"] - row["probability"])
        if distance > LEAST_DIFFERENCE and not row["low"] <= beyond <= row["high"]:
            numbers = (int(row["runs"]), int(row["low"]), int(row["high"]))
            ends = float(row["first"]), float(row["last"])
            unlikely.append((distance, Contradiction(*ends, beyond, *numbers)))
    return max(unlikely)[1] if unlikely else None


def find_half(comparison: "pd.DataFrame") -> tuple[float, float] | None:
    """Return the intensities between which the share of runs first passes one half; None if none.

    `comparison` is from `compare_counts`. They are intensities of runs: two levels, or the ends of
    two classes.
    """
    shares = (comparison["beyond"] / comparison["runs"]).to_numpy(dtype=float)
    first = int((shares >= 0.5).argmax())
    if first == 0:
        return None
    return float(comparison["first"].iloc[first - 1]), float(comparison["last"].iloc[first])


@dataclass(frozen=True)
class Bounds:
    """Smallest and largest probability of exceedance at intensities, which rise along them."""

    first: Floats  # smallest and largest intensity of the runs of each level or class
    last: Floats
    low: Floats  # ends of the probability
    high: Floats

    def at_ends(self, smallest: float, largest: float) -> Floats:
        """Return the largest probability at one intensity, and the smallest at a larger one."""
        upper, lower = np.append(self.high, 1.0), np.append(0.0, self.low)
        place = np.searchsorted(self.first, smallest), np.searchsorted(self.last, largest, "right")
        return np.array([upper[place[0]], lower[place[1]]])


def least_runs(level: float) -> int:
    """Return how many equal outcomes exclude the median by a sign test: six at 95 %."""
    return int(np.ceil(np.log2(2.0 / (1.0 - level))))


def allowed_probabilities(counts: "pd.DataFrame", name: str, level: float) -> Bounds:
    """Return the probabilities that counts allow, at a confidence for each intensity.

    `counts` has the intensity `name`, numbers of `runs` and of those `beyond` the capacity, and
    `first` and `last` of classes of intensities; `most` may be beyond where that is not known.
    """
    runs, beyond = (counts[column].to_numpy(dtype=float) for column in ("runs", "beyond"))
    most = counts["most"].to_numpy(dtype=float) if "most" in counts else beyond
    first, last = (
        counts[end if end in counts else name].to_numpy(dtype=float) for end in ("first", "last")
    )
    tail, needed = 0.5 * (1.0 - level), least_runs(level)
    low = np.where(
        beyond > 0.0,
        scipy.special.betaincinv(np.maximum(beyond, 1.0), runs - beyond + 1.0, tail),
        0.0,
    )
    high = np.where(
        most < runs,
        scipy.special.betaincinv(most + 1.0, np.maximum(runs - most, 1.0), 1.0 - tail),
        1.0,
    )
    none = np.cumsum(most) == 0.0
    every = np.cumsum((runs - beyond)[::-1])[::-1] == 0.0
    # Where no run exceeds the capacity, those at larger intensities that do not either count too;
    # where all do, those at smaller intensities that do.
    without = np.cumsum((runs * none)[::-1])[::-1]
    with_all = np.cumsum(runs * every)
    high = np.where(
        none, np.where(without >= needed, 0.0, 1.0 - tail ** (1.0 / np.maximum(without, 1.0))), high
    )
    low = np.where(
        every, np.where(with_all >= needed, 1.0, tail ** (1.0 / np.maximum(with_all, 1.0))), low
    )
    return Bounds(first, last, np.maximum.accumulate(low), np.minimum.accumulate(high[::-1])[::-1])
