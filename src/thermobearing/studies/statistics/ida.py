"""Incremental dynamic analysis: demand of one motion, scaled up step by step.

Curves of demand against intensity, their fractiles (16, 50 and 84 %, demand given intensity) and
the intensity at which a curve first reaches a capacity.

Vamvatsikos, D., Cornell, C.A. (2002). Incremental dynamic analysis. Earthquake Engineering and
Structural Dynamics 31(3): 491-514; (2004). Applied incremental dynamic analysis. Earthquake
Spectra 20(2): 523-553. Between two runs a curve is straight here, not a spline; it begins at zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.studies.statistics.bootstrap import quantile
from thermobearing.studies.statistics.failed_runs import Failed, column, counted, positive

Floats = NDArray[np.float64]
FRACTILES = (0.16, 0.5, 0.84)


@dataclass(frozen=True)
class IdaCurve:
    """Demand of one motion against its intensity.

    Attributes
    ----------
    name : values of the columns that say which curve it is.
    intensity : increasing, beginning with 0.
    demand : at each, beginning with 0; infinite where a run failed and counts as collapse.
    first : place of its first run among the runs that count.
    """

    name: tuple[Any, ...]
    intensity: Floats
    demand: Floats
    first: int

    def at(self, intensity: Floats) -> Floats:
        """Demand at intensities; NaN beyond the last run, infinite beyond the last one before a
        collapse: what collapsed does not stand up again at a larger intensity.
        """
        failed = np.isinf(self.demand)
        first = int(failed.argmax()) if failed.any() else len(failed)
        found = np.full(len(intensity), np.inf if failed.any() else np.nan)
        inside = intensity <= self.intensity[first - 1]
        found[inside] = np.interp(intensity[inside], self.intensity[:first], self.demand[:first])
        return found

    def crossing(self, capacity: float) -> float:
        """The lowest intensity at which the demand is at the capacity; infinite without one.

        Towards a collapse it is the largest intensity that the motion got through (that of the
        collapse, if it got through none).
        """
        beyond = np.flatnonzero(self.demand >= capacity)
        if len(beyond) == 0:
            return float("inf")
        first = int(beyond[0])
        x0, x1 = self.intensity[first - 1 : first + 1]
        y0, y1 = self.demand[first - 1 : first + 1]
        if np.isinf(y1):
            return float(x0 if x0 > 0.0 else x1)
        return float(x0 + (capacity - y0) / (y1 - y0) * (x1 - x0))


@dataclass(frozen=True)
class Ida:
    """Curves of all motions.

    Attributes
    ----------
    curves : one for each motion (and whatever else differs).
    by : columns that tell curves apart.
    demand, intensity : names of the columns.
    sentence : what became of runs that failed.
    """

    curves: list[IdaCurve]
    by: tuple[str, ...]
    demand: str
    intensity: str
    sentence: str

    def fractiles(
        self, intensity: Floats | None = None, shares: Sequence[float] = FRACTILES
    ) -> pd.DataFrame:
        """Fractiles of the demand over the curves at intensities.

        Parameters
        ----------
        intensity : where; by default every intensity that has runs.
        shares : of the curves below, between 0 and 1.

        Returns
        -------
        DataFrame : the intensity, `curves` (that reach so far), and a column for each share, such
            as `0.5`; infinite where so many curves collapsed.
        """
        if intensity is None:
            intensity = np.unique(np.concatenate([curve.intensity[1:] for curve in self.curves]))
        values = np.array([curve.at(intensity) for curve in self.curves])
        rows = []
        for place, at in zip(values.T, intensity, strict=True):
            known = place[~np.isnan(place)]
            found = {f"{share:g}": quantile(known, share) for share in shares} if len(known) else {}
            rows.append({self.intensity: float(at), "curves": len(known), **found})
        return pd.DataFrame(rows)

    def crossings(self, capacity: float) -> pd.DataFrame:
        """The intensity at which each curve first reaches a capacity.

        Returns
        -------
        DataFrame : columns that tell the curves apart, `capacity` (infinite where it was not
            reached) and `largest`, the largest intensity that a curve has.
        """
        rows = []
        for curve in self.curves:
            name = dict(zip(self.by, curve.name, strict=True))
            found = {"capacity": curve.crossing(capacity), "largest": float(curve.intensity[-1])}
            rows.append({**name, **found})
        return pd.DataFrame(rows)


def ida_curves(
    table: pd.DataFrame,
    demand: str,
    intensity: str,
    by: Sequence[str] = ("motion",),
    *,
    failed: Failed = "left-out",
) -> Ida:
    """Curves of incremental dynamic analysis from a table of runs.

    Parameters
    ----------
    table : of runs, one for each curve and intensity.
    demand, intensity : names of columns of numbers; intensities above 0.
    by : columns that tell curves apart: the motion, and every other factor that differs.
    failed : runs that failed are "left-out", or count as "collapse" of their curve.

    Raises
    ------
    InputError : no such column, two runs at one intensity of a curve, or no curve of more than
        one intensity.

    Examples
    --------
    >>> runs = pd.DataFrame({"motion": ["a", "a"], "scale": [1.0, 2.0], "drift": [1.0, 3.0]})
    >>> ida_curves(runs, "drift", "scale").crossings(2.0)["capacity"].tolist()
    [1.5]
    """
    runs = counted(table, demand, failed)
    values = positive(runs.table, intensity)
    labels = list(zip(*(column(runs.table, name) for name in by), strict=True))
    places: dict[tuple[Any, ...], list[int]] = {}
    for place, label in enumerate(labels):
        places.setdefault(label, []).append(place)
    curves = []
    for label, mine in places.items():
        order = np.array(mine)[np.argsort(values[mine], kind="stable")]
        x, y = values[order], runs.demand[order]
        if (np.diff(x) == 0.0).any():
            twice = x[:-1][np.diff(x) == 0.0][0]
            told = ", ".join(f"{key} {value}" for key, value in zip(by, label, strict=True))
            raise InputError(
                f"two runs of {told} at {intensity} = {twice:g}: name the column that tells them "
                f'apart in "by"'
            )
        curves.append(IdaCurve(label, np.append(0.0, x), np.append(0.0, y), mine[0]))
    if all(len(curve.intensity) == 2 for curve in curves):
        raise InputError(
            f"each of the {len(curves)} curves has a run at one intensity only, so that it is no "
            "curve: the same draws are needed at several intensities (`paired = true` in "
            "[design]); or take stripes or cloud"
        )
    return Ida(curves, tuple(by), demand, intensity, runs.sentence)
