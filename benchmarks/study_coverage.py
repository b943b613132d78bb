"""How often bands of 95 % of fragility curves hold the truth: numbers of docs/theory.md.

    python -m benchmarks.study_coverage

Each line: runs of a stripe or motions, estimator, and the shares of 600 repetitions in which the
band holds the probability at half, once and one and a half times the median, the median, and the
dispersion; "percentile" is the bootstrap without its small-sample correction. Some minutes.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import norm

from thermobearing.studies.statistics.fragility import fragility_curve

TIMES, SAMPLES = 600, 299
LEVELS = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0])
DISPERSION = 0.4  # of a curve with its median at one
AT = np.array([0.5, 1.0, 1.5])


def stripes(runs: int, rng: np.random.Generator) -> pd.DataFrame:
    beyond = rng.binomial(runs, norm.cdf(np.log(LEVELS) / DISPERSION))
    drift = [np.r_[np.full(k, 2.0), np.full(runs - k, 0.5)] for k in beyond]
    return pd.DataFrame({"im": np.repeat(LEVELS, runs), "drift": np.concatenate(drift)})


def motions(runs: int, rng: np.random.Generator) -> pd.DataFrame:
    capacity = np.exp(rng.normal(0.0, DISPERSION, runs))
    rows = [(m, im, im / c) for m, c in enumerate(capacity) for im in (0.3, 0.7, 1.1, 1.5)]
    return pd.DataFrame(rows, columns=["motion", "im", "drift"])


def cloud(runs: int, rng: np.random.Generator) -> pd.DataFrame:
    im = np.exp(rng.normal(0.0, 0.6, runs))
    return pd.DataFrame({"im": im, "drift": im * np.exp(DISPERSION * rng.normal(size=runs))})


def coverage(
    draw: Any, runs: int, method: Any, percentile: bool, rng: np.random.Generator
) -> np.ndarray:
    counts = np.zeros(5)
    truth = norm.cdf(np.log(AT) / DISPERSION)
    for seed in range(TIMES):
        curve = fragility_curve(
            draw(runs, rng), "drift", 1.0, "im", method=method, samples=SAMPLES, seed=seed
        )
        if percentile:
            curve = replace(curve, parts=[(1.0, curve.estimate.drawn or curve.estimate)])
        (low, high), row = curve.band_at(AT), curve.row()
        counts[:3] += (low <= truth) & (truth <= high)
        counts[3] += row["median_low"] <= 1.0 <= row["median_high"]
        counts[4] += row["dispersion_low"] <= DISPERSION <= row["dispersion_high"]
    return counts / TIMES


def main() -> None:
    rng = np.random.default_rng(0)
    for runs in (12, 20, 40):
        for method, draw in (("stripes", stripes), ("ida", motions), ("cloud", cloud)):
            for percentile in (False, True):
                covered = coverage(draw, runs, method, percentile, rng)
                shares = " ".join(f"{share:.3f}" for share in covered)
                name = f"{method}, percentile" if percentile else method
                print(f"{runs} {name}: {shares}", flush=True)


if __name__ == "__main__":
    main()
