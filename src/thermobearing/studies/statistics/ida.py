"""Curves of incremental dynamic analysis, their fractiles and capacities.

Incremental dynamic analysis has curves of demand against intensity, their fractiles (16, 50 and
84 %, demand given intensity) and the intensity at which a curve first reaches a capacity:
Vamvatsikos, D., Cornell, C.A. (2002), Earthquake Engineering and Structural Dynamics 31(3):
491-514; (2004), Earthquake Spectra 20(2): 523-553. Here fractiles are linear between two runs, not
splines, and begin at zero.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.studies.statistics.demand import (
    ANY,
    COMPUTED,
    MOTION,
    Counted,
    Failed,
    combinations,
    counted,
    members,
    positive,
    quantile,
)

STEEP = 2.0  # power of the intensity up to which the demand is interpolated between two runs
FRACTILES = (0.16, 0.5, 0.84)
LEAST_AT_LEVEL = 3  # runs of a stripe, of which a share says something


class IdaCurve(NamedTuple):
    """Demand of one motion against its intensity."""

    name: tuple[Any, ...]  # values of the columns that identify the curve
    intensity: Floats  # increasing, beginning with 0
    demand: Floats  # at each, beginning with 0; infinite for a run that counts as collapse
    first: int  # index of its first run among the runs that count

    def _at(self, intensity: Floats) -> Floats:
        """Return the demand at intensities; NaN above the last run, infinite above a collapse."""
        failed = np.isinf(self.demand)
        first = int(failed.argmax()) if failed.any() else len(failed)
        demands = np.full(len(intensity), np.inf if failed.any() else np.nan)
        inside = intensity <= self.intensity[first - 1]
        demands[inside] = np.interp(intensity[inside], self.intensity[:first], self.demand[:first])
        return demands

    def _crossing(self, capacity: float) -> tuple[float, float, float]:
        """Return the lowest intensity that reaches the capacity, or inf, and its bounds.

        The bounds are equal where the demand is interpolated: linear from zero, and in logarithms
        of both between two runs, unless the demand rises there or up to the next run faster than
        with the power `STEEP` of the intensity. Then the curve bends between the runs, as where a
        pier yields.
        """
        beyond = np.flatnonzero(self.demand >= capacity)
        if len(beyond) == 0:
            return float("inf"), float(self.intensity[-1]), float("inf")
        first = int(beyond[0])
        x0, x1 = map(float, self.intensity[first - 1 : first + 1])
        y0, y1 = map(float, self.demand[first - 1 : first + 1])
        # The capacity lies between the last run that stood and the collapse: the smaller intensity
        # is stated, except zero, which has no logarithm.
        if np.isinf(y1):
            return x0 if x0 > 0.0 else x1, x0, x1
        if x0 == 0.0 or y0 <= 0.0:
            at = x0 + (capacity - y0) / (y1 - y0) * (x1 - x0)
            return at, at, at
        at = float(x0 * (x1 / x0) ** (np.log(capacity / y0) / np.log(y1 / y0)))
        rises = y1 / y0 > (x1 / x0) ** STEEP
        if first + 1 < len(self.demand) and np.isfinite(self.demand[first + 1]):
            power = (self.intensity[first + 1] / x1) ** STEEP
            rises = rises or bool(self.demand[first + 1] / y1 > power)
        return (at, x0, x1) if rises else (at, at, at)


class Ida(NamedTuple):
    """Curves of all motions."""

    curves: list[IdaCurve]
    by: tuple[str, ...]  # columns that identify curves
    demand: str  # names of the columns
    intensity: str
    sentence: str  # how failed runs count

    def fractiles(
        self, intensity: Floats | None = None, shares: Sequence[float] = FRACTILES
    ) -> "pd.DataFrame":
        """Return fractiles of the demand over `curves` curves, at all intensities of runs."""
        if intensity is None:
            intensity = np.unique(np.concatenate([curve.intensity[1:] for curve in self.curves]))
        values = np.array([curve._at(intensity) for curve in self.curves])
        rows = []
        for demands, at in zip(values.T, intensity, strict=True):
            finite = demands[~np.isnan(demands)]
            row = {self.intensity: float(at), "curves": len(finite)}
            if len(finite):
                row |= {f"{share:g}": quantile(finite, share) for share in shares}
            rows.append(row)
        return pd.DataFrame(rows)

    def crossings(self, capacity: float) -> "pd.DataFrame":
        """Return where each curve first reaches a capacity (or inf), and its largest intensity.

        `low` and `high` differ where the capacity is known to lie between two intensities only.
        """
        rows = []
        for curve in self.curves:
            name = dict(zip(self.by, curve.name, strict=True))
            at, low, high = curve._crossing(capacity)
            largest = float(curve.intensity[-1])
            rows.append({**name, "capacity": at, "low": low, "high": high, "largest": largest})
        return pd.DataFrame(rows)


def ida_curves(
    table: "pd.DataFrame",
    demand: str,
    intensity: str,
    by: Sequence[str] = (MOTION,),
    *,
    failed: Failed = COMPUTED,
    capacity: float = ANY,
) -> Ida:
    """Return curves of incremental dynamic analysis; the columns `by` identify them.

    Failed runs count as in the fragility of the `capacity`; without one, a run that stopped is
    larger than all others.
    """
    runs = counted(table, demand, failed, capacity)
    return curves_of(runs, positive(runs.table, intensity), demand, intensity, by)


def curves_of(runs: Counted, values: Floats, demand: str, intensity: str, by: Sequence[str]) -> Ida:
    """Return the curves of the runs that count, at their intensities."""
    codes, labels = combinations(runs.table, by)
    curves = []
    for label, indices in zip(labels, members(codes), strict=True):
        order = indices[np.argsort(values[indices], kind="stable")]
        x, y = values[order], runs.demand[order]
        if (np.diff(x) == 0.0).any():
            repeated = x[:-1][np.diff(x) == 0.0][0]
            description = ", ".join(f"{key} {value}" for key, value in zip(by, label, strict=True))
            raise InputError(
                f"two runs of {description} have {intensity} = {repeated:g}: add the column in "
                'which they differ to "by"'
            )
        curves.append(IdaCurve(label, np.append(0.0, x), np.append(0.0, y), int(indices[0])))
    if all(len(curve.intensity) == 2 for curve in curves):
        # Stripes count runs at each level; the regression of a cloud needs none.
        repeated = np.unique(values, return_counts=True)[1] >= LEAST_AT_LEVEL
        other = "stripes" if repeated.all() else "cloud"
        raise InputError(
            f"IDA needs the same draw at several intensities (`paired = true` in [design]); each "
            f"of the {len(curves)} curves has one run; use {other} instead, since "
            + ("each intensity has several runs" if repeated.all() else "most intensities have one")
        )
    return Ida(curves, tuple(by), demand, intensity, runs.sentence)
