"""The search for the best point of the unit cube, with coarse steps, and the last polish."""

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify.case import IdentifyCase
from thermobearing.identify.krill import krill_herd
from thermobearing.identify.problem import ROBUST_SCALE, Problem

Floats = NDArray[np.float64]

AROUND = 0.25  # half width, in the unit cube, of where other starts are drawn
PROBES = 12  # points looked at for each start that is taken
MOST_STEPS = 40  # of least squares from one start
POLISH_STEPS = 30
INSIDE = 1e-6  # of the cube: least squares starts strictly inside
MEMBERS = 6  # of differential evolution, for each dimension


def search(problem: Problem, case: IdentifyCase) -> Floats:
    """A point of the unit cube near the best one, with coarse steps of the model.

    Parameters
    ----------
    problem : residuals of the tests; its search begins at the starting values.
    case : method, seed, starts and budget.

    Returns
    -------
    ndarray : place of each free parameter between its bounds, in [0, 1].

    Examples
    --------
    >>> import thermobearing as tb
    >>> from thermobearing.identify.case import make_identify_case
    >>> from thermobearing.identify.parameters import parameter_set
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None)
    >>> record = tb.identify.synthetic_record(bearing, 23.0, test, noise=0.0)
    >>> problem = Problem([record], parameter_set(bearing, ["K_r"], [23.0]))
    >>> cube = search(problem, make_identify_case(record, bearing, starts=1))
    >>> problem.cost(polish(problem, cube)[0]) < 1e-4
    True
    """
    first = np.clip(problem.pset.start, INSIDE, 1.0 - INSIDE)
    if case.method == "krill-herd":
        return krill_herd(
            problem.cost, len(first), evaluations=case.evaluations, seed=case.seed, start=first
        ).best
    if case.method == "differential-evolution":
        return _differential_evolution(problem, first, case)
    best, lowest = first, float("inf")
    for point in _starting_points(problem, first, case):
        found, _ = _least_squares(problem, point, MOST_STEPS, fine=False)
        cost = problem.cost(found)
        if cost < lowest:
            best, lowest = found, cost
    return best


def polish(problem: Problem, cube: Floats) -> tuple[Floats, bool]:
    """Least squares from a point near the best one, with a step of the model at every sample.

    Parameters
    ----------
    problem : residuals of the tests.
    cube : from `search`, each in [0, 1].

    Returns
    -------
    the best point, and whether the search converged; see `search` for an example.
    """
    return _least_squares(problem, cube, POLISH_STEPS, fine=True)


def _starting_points(problem: Problem, first: Floats, case: IdentifyCase) -> list[Floats]:
    """The start from the loops, and the best of a Latin hypercube around it."""
    from scipy.stats import qmc

    if case.starts == 1:
        return [first]
    others = case.starts - 1
    cube = qmc.LatinHypercube(len(first), rng=case.seed).random(PROBES * others)
    probes = np.clip(first + AROUND * (2.0 * cube - 1.0), INSIDE, 1.0 - INSIDE)
    costs = [problem.cost(point) for point in probes]
    return [first, *(probes[i] for i in np.argsort(costs)[:others])]


def _differential_evolution(problem: Problem, first: Floats, case: IdentifyCase) -> Floats:
    from scipy.optimize import differential_evolution

    found = differential_evolution(
        problem.cost,
        [(0.0, 1.0)] * len(first),
        maxiter=max(1, case.evaluations // (MEMBERS * len(first)) - 1),
        popsize=MEMBERS,
        rng=case.seed,
        polish=False,
        x0=first,
        tol=0.0,
        init="latinhypercube",
    )
    return np.asarray(found.x)


def _least_squares(
    problem: Problem, start: Floats, steps: int, *, fine: bool
) -> tuple[Floats, bool]:
    """Bounded trust-region least squares in the unit cube; whether it converged."""
    from scipy.optimize import least_squares

    found = least_squares(
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
    return np.asarray(found.x), bool(found.status > 0)
