"""Search for the best parameters.

Gandomi & Alavi (2012), "Krill herd: a new bio-inspired optimization algorithm",
Communications in Nonlinear Science and Numerical Simulation 17:4831-4845. Equation numbers
are those of that paper. Departures: the food weights are taken relative to the best krill, so
that the objective may be zero or negative; the best krill is kept (elitism) and diffusion
shrinks with the merit of a krill, both as in the authors' own program.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.identify.case import IdentifyCase
from thermobearing.identify.fit.problem import ROBUST_SCALE, Problem
from thermobearing.quantities.governing import order_from_least

Objective = Callable[[Floats], float]
MAX_INDUCED, MAX_FORAGING, MAX_DIFFUSION = 0.01, 0.02, 0.005  # N_max, V_f, D_max of section 3
TIME_CONSTANT = 0.3  # C_t of Eq. 19, in [0, 2]
CROSSOVER, MUTATION = 0.2, 0.05  # Eq. 21 and 23
TINY = 1e-12


class Found(NamedTuple):
    """Best point, its value, evaluations spent, and the best value after each generation."""

    best: Floats
    value: float
    evaluations: int
    history: list[float]


def _krill_herd(
    objective: Objective,
    dimensions: int,
    *,
    evaluations: int = 5000,
    population: int = 30,
    seed: int = 0,
    start: Floats | None = None,
) -> Found:
    """Minimise a function over the unit cube by the krill herd, in `evaluations` at most."""
    rng = np.random.default_rng(seed)
    x = rng.random((population, dimensions))
    if start is not None:
        x[0] = start
    f = np.array([objective(point) for point in x])
    own, own_f = x.copy(), f.copy()  # the best place of each krill
    induced, foraging = np.zeros_like(x), np.zeros_like(x)
    top, top_f = x[np.argmin(f)].copy(), float(f.min())
    spent, history = population, [top_f]
    generations = max(1, (evaluations - population) // (population + 1))
    for generation in range(generations):
        late = generation / generations
        best, spread = int(np.argmin(f)), max(float(np.ptp(f)), TINY)
        # Centre of food, Eq. 12, weights 1/K with K relative to the best krill.
        weights = 1.0 / (f - f.min() + 0.01 * float(np.ptp(f)) + TINY)
        food = np.asarray(weights @ x / weights.sum())
        food_f = objective(food)
        if food_f < top_f:
            top, top_f = food.copy(), food_f
        inertia = 0.1 + 0.8 * (1.0 - late)
        pull = 2.0 * (rng.random(population) + late)  # C_best, Eq. 9
        induced = MAX_INDUCED * _induced(x, f, best, spread, pull) + inertia * induced  # Eq. 2
        attraction = 2.0 * (1.0 - late) * ((f - food_f) / spread)  # Eq. 14
        sought = attraction[:, None] * _unit(food - x)
        sought = sought + ((f - own_f) / spread)[:, None] * _unit(own - x)
        foraging = MAX_FORAGING * sought + inertia * foraging  # Eq. 10, 11
        worth = ((f - f[best]) / spread)[:, None]
        diffusion = MAX_DIFFUSION * (1.0 - late) * worth * rng.uniform(-1.0, 1.0, x.shape)  # Eq. 17
        scale = TIME_CONSTANT * dimensions  # Eq. 19 in the unit cube
        moved = x + scale * (induced + foraging + diffusion)  # Eq. 18
        x = np.clip(_cross_and_mutate(moved, worth, best, rng), 0.0, 1.0)
        f = np.array([objective(point) for point in x])
        spent += 1 + population
        better = f < own_f
        own[better], own_f[better] = x[better], f[better]
        if f.min() < top_f:
            top, top_f = x[np.argmin(f)].copy(), float(f.min())
        worst = int(np.argmax(f))
        x[worst], f[worst] = top, top_f  # elitism
        history.append(top_f)
    return Found(top, top_f, spent, history)


def _unit(difference: Floats) -> Floats:
    norm = np.linalg.norm(difference, axis=-1, keepdims=True)
    return np.asarray(difference / (norm + TINY))


def _induced(x: Floats, f: Floats, best: int, spread: float, pull: Floats) -> Floats:
    """Return the direction of motion induced by neighbours and the best krill, Eq. 4-8."""
    towards = x[None, :, :] - x[:, None, :]  # from krill i to krill j
    distance = np.linalg.norm(towards, axis=2)
    sensing = distance.mean(axis=1) / 5.0  # Eq. 7
    near = (distance < sensing[:, None]) & ~np.eye(len(x), dtype=bool)
    merit = (f[:, None] - f[None, :]) / spread  # Eq. 6
    local = ((near * merit)[:, :, None] * _unit(towards)).sum(axis=1)  # Eq. 4, 5
    to_best = (f - f[best])[:, None] / spread * _unit(x[best] - x)
    return np.asarray(local + pull[:, None] * to_best)  # Eq. 8


def _cross_and_mutate(x: Floats, merit: Floats, best: int, rng: np.random.Generator) -> Floats:
    """Return the herd after genetic operators, Eq. 20-23: more of both, the worse a krill is."""
    count = len(x)
    partner = rng.integers(count, size=count)
    cross = rng.random(x.shape) < CROSSOVER * merit
    mixed = np.where(cross, x[partner], x)
    p, q = rng.integers(count, size=(2, count))
    rate = MUTATION / np.maximum(merit, MUTATION)
    mutate = (rng.random(x.shape) < rate) & (merit > 0.0)
    jumped = x[best] + rng.random((count, 1)) * (x[p] - x[q])
    return np.asarray(np.where(mutate, jumped, mixed))


AROUND = 0.25  # half width, in the unit cube, of where other starts are drawn
PROBES = 12  # points tried for each start that is taken
MOST_STEPS = 40  # of least squares from one start
POLISH_STEPS = 30
INSIDE = 1e-6  # of the cube: least squares starts strictly inside
MEMBERS = 6  # of differential evolution, for each dimension


def search(problem: Problem, case: IdentifyCase) -> Floats:
    """Return a point of the unit cube near the best one, found with coarse steps of the model."""
    first = np.clip(problem.pset.start, INSIDE, 1.0 - INSIDE)
    if case.method == "krill-herd":
        return _krill_herd(
            problem.cost, len(first), evaluations=case.evaluations, seed=case.seed, start=first
        ).best
    if case.method == "differential-evolution":
        from scipy.optimize import differential_evolution

        generations = max(1, case.evaluations // (MEMBERS * len(first)) - 1)
        how: dict[str, Any] = {
            "maxiter": generations,
            "popsize": MEMBERS,
            "polish": False,
            "tol": 0.0,
        }
        how |= {"init": "latinhypercube", "rng": case.seed, "x0": first}
        found = differential_evolution(problem.cost, [(0.0, 1.0)] * len(first), **how)
        return np.asarray(found.x)
    best, lowest = first, float("inf")
    for point in _starting_points(problem, first, case):
        found, _ = _least_squares(problem, point, MOST_STEPS, fine=False)
        cost = problem.cost(found)
        if cost < lowest:
            best, lowest = found, cost
    return best


def polish(problem: Problem, cube: Floats) -> tuple[Floats, bool]:
    """Return the best point by least squares with fine steps, and whether it converged."""
    return _least_squares(problem, cube, POLISH_STEPS, fine=True)


def _starting_points(problem: Problem, first: Floats, case: IdentifyCase) -> list[Floats]:
    """Return the start from the loops, and the best of a Latin hypercube around it."""
    from scipy.stats import qmc

    if case.starts == 1:
        return [first]
    others = case.starts - 1
    cube = qmc.LatinHypercube(len(first), rng=case.seed).random(PROBES * others)
    probes = np.clip(first + AROUND * (2.0 * cube - 1.0), INSIDE, 1.0 - INSIDE)
    costs = [problem.cost(point) for point in probes]
    return [first, *(probes[i] for i in order_from_least(costs)[:others])]


def _least_squares(
    problem: Problem, start: Floats, steps: int, *, fine: bool
) -> tuple[Floats, bool]:
    """Run bounded trust-region least squares in the unit cube; return whether it converged too."""
    from scipy.optimize import least_squares

    how = {"method": "trf", "loss": problem.loss, "f_scale": ROBUST_SCALE, "x_scale": "jac"}
    found = least_squares(
        lambda u: problem.residuals(u, fine=fine),
        np.clip(start, INSIDE, 1.0 - INSIDE),
        jac=lambda u: problem.jacobian(u, fine=fine),
        bounds=(0.0, 1.0),
        **(how | {"ftol": 1e-7, "xtol": 1e-7, "gtol": 1e-9, "max_nfev": steps}),
    )
    return np.asarray(found.x), bool(found.status > 0)
