"""Comparison of a fragility curve with the exceedances of its own runs.

At each intensity, or in ten classes of intensities where there are more, the number of exceedances
is compared with the binomial interval of the curve. The intervals contain the counts of all classes
together with the confidence of the bands (Bonferroni), if the runs are independent. Counts of
stripes and of a cloud are those of runs; of IDA those of the single curves that have reached the
capacity, whose shares are the empirical distribution of their capacities.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy

from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats

CONTRADICTED = "contradicted"  # outcome of a curve whose own runs are unlikely
# Of shares, our choice: of very many runs, smaller differences are significant and do not matter.
LEAST_DIFFERENCE = 0.05
MOST_COMPARED = 10  # classes of intensities in which a curve is compared with the counts


class Contradiction(NamedTuple):
    """The count of runs that is furthest from a curve, outside the interval of the curve."""

    intensity: float
    beyond: int
    runs: int
    low: int  # ends of the binomial interval
    high: int


def reached_counts(crossings: "pd.DataFrame", levels: Floats, name: str) -> "pd.DataFrame":
    """Return how many curves of IDA have reached a capacity at intensities of their runs.

    `crossings` is from `Ida.crossings`. Of more than ten levels, ten of equal distance in rank are
    taken. `beyond` are the curves that have reached the capacity, `most` also those whose capacity
    may be below or above: it lies between two of their runs, or above the last of them.
    """
    levels = np.unique(levels)
    if len(levels) > MOST_COMPARED:
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
    """Return counts in at most ten classes with the share of a curve and its binomial interval.

    Parameters
    ----------
    counts : DataFrame
        The intensity `name`, numbers of `runs` and of those `beyond` the capacity; `most` is the
        largest number that may be beyond, where that is not known of all.
    name : str
        Column of the intensity.
    probability : callable
        Probability of exceedance of the curve at intensities.
    level : float
        Confidence of the intervals of all classes together.

    Returns
    -------
    DataFrame
        A row for each class: mean intensity, `runs`, `beyond`, `most`, the mean `probability` of
        the curve, and the ends `low` and `high` of the interval, as numbers of runs.
    """
    at, runs, beyond = (counts[column].to_numpy(dtype=float) for column in (name, "runs", "beyond"))
    most = counts["most"].to_numpy(dtype=float) if "most" in counts else beyond
    parts = np.array_split(np.arange(len(at)), min(len(at), MOST_COMPARED))
    tail = 0.5 * (1.0 - level) / len(parts)
    rows = []
    for part in parts:
        total = int(runs[part].sum())
        share = float((runs[part] * probability(at[part])).sum() / total)
        possible = np.arange(total + 1.0)
        below = scipy.special.bdtr(possible, total, share)  # probability of at most so many
        low, high = (int(np.argmax(below >= end)) for end in (tail, 1.0 - tail))
        mean = float(np.exp((runs[part] * np.log(at[part])).sum() / total))
        row = {name: mean, "runs": total, "beyond": int(beyond[part].sum())}
        row |= {"most": int(most[part].sum()), "probability": share, "low": low, "high": high}
        rows.append(row)
    return pd.DataFrame(rows)


def find_contradiction(comparison: "pd.DataFrame", name: str) -> Contradiction | None:
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
            unlikely.append((distance, Contradiction(float(row[name]), beyond, *numbers)))
    return max(unlikely)[1] if unlikely else None


def find_half(comparison: "pd.DataFrame", name: str) -> tuple[float, float] | None:
    """Return the intensities between which the share of runs first passes one half; None if none.

    `comparison` is from `compare_counts`.
    """
    shares = (comparison["beyond"] / comparison["runs"]).to_numpy(dtype=float)
    first = int((shares >= 0.5).argmax())
    if first == 0:
        return None
    low, high = comparison[name].iloc[[first - 1, first]]
    return float(low), float(high)
