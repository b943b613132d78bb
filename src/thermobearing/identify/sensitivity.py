"""What tests can tell, before anything is fitted to them: the default free parameters.

The derivatives of the forces at the starting values give the information of the tests (Fisher),
with a residual as fits of real tests leave it. What is assumed beside has the spread of its source
as a prior. From all parameters of the bearing those are dropped, worst first, that the tests would
know less well than their source does; each dropped one joins what is assumed. The numbers of
Tables 4.2 and 5.2 and the yield stress of lead, which differ from bearing to bearing by more than
the spread of one compound, are dropped only where the tests tell nothing of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.assumed import (
    CLEAR,
    OF_YIELDING,
    Group,
    assumed_of,
    value_of,
)
from thermobearing.identify.kinds import ENDS, K_R
from thermobearing.identify.linear import AT_BOUND, half_cycles, linearised
from thermobearing.identify.parameters import available, default_free
from thermobearing.identify.problem import Problem

Floats = NDArray[np.float64]

MISFIT = (
    0.03  # residual to come, of the peak force: fits of the real tests at hand leave 2.6 to 3.8 %
)
WORTH = 4.0  # independent samples of a half cycle: residuals of a law are alike along a leg
WIDE = 10.0  # standard uncertainties of the source: what a free parameter may be off
BETTER = 1.0  # of that of its source: what tests know better than this errs less when it is free
NOTHING = 0.9  # of WIDE: tests that leave so much have told nothing


@dataclass(frozen=True)
class Sensitivity:
    """What tests would tell of one parameter.

    Attributes
    ----------
    key : dotted key.
    spread : standard uncertainty of its source, in its unit; 0 where none is stated.
    stderr : what the tests would leave, in the unit of the parameter.
    free : whether it is free by default.
    usual : whether it is one of those that are free unless the tests tell nothing of them.
    """

    key: str
    spread: float
    stderr: float
    free: bool
    usual: bool

    @property
    def added(self) -> bool:
        """Whether it is free because of these tests."""
        return self.free and not self.usual

    @property
    def dropped(self) -> bool:
        """Whether it would be free if these tests told anything of it."""
        return self.usual and not self.free

    def summary(self) -> dict[str, Any]:
        """What summary.json says of it."""
        known = self.spread > 0.0
        return {
            "free": self.free,
            "stderr_of_source": self.spread if known else None,
            "stderr_expected": self.stderr if known else None,
        }


def candidates(problem: Problem, groups: Sequence[Group]) -> list[str]:
    """Parameters that the default free set is chosen from.

    Parameters
    ----------
    problem : residuals of the tests.
    groups : from `chosen_groups`.

    Returns
    -------
    list of str : dotted keys: the usual ones, and all others whose source has an uncertainty.
    """
    bearing = problem.pset.base
    usual = default_free(bearing, [record.ambient for record in problem.records])
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    known = {key for group in groups for key in group.keys}
    more = [
        kind.key
        for kind in available(bearing)
        if kind.key in known and not (linear and kind.key in OF_YIELDING)
    ]
    return list(dict.fromkeys([*usual, *more]))


def sensitivities(problem: Problem, cube: Floats, groups: Sequence[Group]) -> list[Sensitivity]:
    """How well tests would know each parameter, and which of them are therefore free.

    Parameters
    ----------
    problem : residuals of the tests, with the candidates free.
    cube : the starting values, in [0, 1] for each candidate.
    groups : from `chosen_groups`.

    Returns
    -------
    list of Sensitivity : one for each candidate.
    """
    free = [p.kind.key for p in problem.pset.free]
    usual = default_free(problem.pset.base, [record.ambient for record in problem.records])
    limits = np.array([NOTHING * WIDE if key in usual else BETTER for key in free])
    spreads = np.array([_spread(problem, key, groups) for key in free])
    stated = spreads > 0.0
    slopes = np.array([p.slope(float(u)) for p, u in zip(problem.pset.free, cube, strict=True)])
    jacobian = problem.jacobian(cube) * (np.where(stated, spreads, 1.0) / slopes)
    beside = assumed_of(problem, cube, groups, fine=False).columns
    columns = np.column_stack([jacobian, beside])
    information = columns.T @ (columns * _worth(problem)[:, None]) / MISFIT**2
    prior = np.array([WIDE**-2] * len(free) + [1.0] * beside.shape[1])
    ratios, kept = np.zeros(len(free)), np.ones(len(free), dtype=bool)
    movable = stated & (np.array(free) != K_R)
    while True:
        left = np.sqrt(np.diag(np.linalg.inv(information + np.diag(prior))))[: len(free)]
        ratios = np.where(kept, left, ratios)
        over = np.where(kept & movable, ratios / limits, 0.0)
        worst = int(np.argmax(over))
        if over[worst] <= 1.0:
            break
        kept[worst], prior[worst] = False, 1.0
    return [
        Sensitivity(key, float(spread), float(spread * ratio), bool(keep), key in usual)
        for key, spread, ratio, keep in zip(free, spreads, ratios, kept, strict=True)
    ]


def _spread(problem: Problem, key: str, groups: Sequence[Group]) -> float:
    """Standard uncertainty of a parameter's source, in its unit; 0 where none is stated."""
    for group in groups:
        if key in group.keys:
            return group.step(value_of(problem.pset.base, key) or 0.0)
    return 0.0


def _worth(problem: Problem) -> Floats:
    """How many independent samples each residual is."""
    found = []
    for record, weight in zip(problem.records, problem.weights, strict=True):
        legs = half_cycles(record)
        counted = weight > 0.0
        count = np.bincount(legs, weights=counted)[legs]
        share = np.minimum(1.0, WORTH / np.maximum(count, 1.0))
        extra = len(record.temperatures) if problem.temperatures else 0
        found.append(np.tile(share, 1 + extra))
    return np.concatenate(found)


def without_needless(
    problem: Problem, cube: Floats, added: Sequence[str]
) -> tuple[Problem, Floats]:
    """A fit without those added parameters that came out as nothing, as the file has them.

    E2 of lead without softening is one: free it would stop at its end of 0 in half of all fits.

    Parameters
    ----------
    problem : residuals of the tests.
    cube : the optimum, in [0, 1] for each free parameter.
    added : dotted keys that are free because of these tests.

    Returns
    -------
    Problem, ndarray : the same ones where all are needed.
    """
    ends = {key: end for key, end in ENDS if key in added}
    if not ends:
        return problem, cube
    linear = linearised(problem, cube, fine=False)
    stderr = np.full(len(cube), np.inf)
    stderr[linear.inside] = np.sqrt(np.diag(linear.covariance()))
    needless = []
    for p, u, error in zip(problem.pset.free, cube.tolist(), stderr.tolist(), strict=True):
        if p.kind.key in ends:
            file = value_of(problem.pset.base, p.kind.key) or 0.0
            reach = CLEAR * error if np.isfinite(error) else AT_BOUND
            if abs(u - p.place(ends[p.kind.key])) < reach and abs(u - p.place(file)) < reach:
                needless.append(p.kind.key)
    if not needless:
        return problem, cube
    pset = problem.pset.without(needless)
    places = dict(zip((p.kind.key for p in problem.pset.free), cube.tolist(), strict=True))
    return problem.with_parameters(pset), np.array([places[p.kind.key] for p in pset.free])
