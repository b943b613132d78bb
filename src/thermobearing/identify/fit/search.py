"""Search for the best parameters: bounded least squares from several starting points."""

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.identify.case import IdentifyCase
from thermobearing.identify.fit.problem import ROBUST_SCALE, Problem
from thermobearing.quantities.governing import order_from_least

AROUND = 0.25  # half width, in the unit cube, of where other starts are drawn
PROBES = 12  # points tried for each start that is taken
MOST_STEPS = 40  # of least squares from one start
POLISH_STEPS = 30
INSIDE = 1e-6  # of the cube: least squares starts strictly inside


def search(problem: Problem, case: IdentifyCase) -> Floats:
    """Return a point of the unit cube near the best one, found with coarse steps of the model."""
    first = np.clip(problem.pset.start, INSIDE, 1.0 - INSIDE)
    if case.search is not None:
        return np.clip(case.search(problem.cost, first), INSIDE, 1.0 - INSIDE)
    best, lowest = first, float("inf")
    for point in _starting_points(problem, first, case):
        optimum, _ = _least_squares(problem, point, MOST_STEPS, fine=False)
        cost = problem.cost(optimum)
        # With a plain less-than, the earlier start wins a tie, whatever the number of starts.
        if cost < lowest:
            best, lowest = optimum, cost
    return best


def polish(problem: Problem, cube: Floats) -> tuple[Floats, bool]:
    """Return the best point by least squares with fine steps, and whether it converged."""
    return _least_squares(problem, cube, POLISH_STEPS, fine=True)


def _starting_points(problem: Problem, first: Floats, case: IdentifyCase) -> list[Floats]:
    """Return the start from the loops, and the best of a Latin hypercube around it."""
    from scipy.stats import qmc

    if case.starts == 1:
        return [first]
    count = case.starts - 1
    cube = qmc.LatinHypercube(len(first), rng=case.seed).random(PROBES * count)
    # Probes lie around the start from the loops: a hypercube over all of the cube would waste
    # most of its points.
    probes = np.clip(first + AROUND * (2.0 * cube - 1.0), INSIDE, 1.0 - INSIDE)
    costs = [problem.cost(point) for point in probes]
    return [first, *(probes[i] for i in order_from_least(costs)[:count])]


def _least_squares(
    problem: Problem, start: Floats, steps: int, *, fine: bool
) -> tuple[Floats, bool]:
    """Run bounded trust-region least squares in the unit cube; return whether it converged too."""
    from scipy.optimize import least_squares

    result = least_squares(
        lambda u: problem.residuals(u, fine=fine),
        np.clip(start, INSIDE, 1.0 - INSIDE),
        jac=lambda u: problem.jacobian(u, fine=fine),
        bounds=(0.0, 1.0),
        method="trf",
        loss=problem.loss,
        f_scale=ROBUST_SCALE,
        x_scale="jac",
        ftol=1e-7,
        xtol=1e-7,
        gtol=1e-9,
        max_nfev=steps,
    )
    return np.asarray(result.x), bool(result.status > 0)
