"""Krill Herd, the method of the source (4.4.1.1), vectorised, in the unit cube.

Gandomi & Alavi (2012), "Krill herd: a new bio-inspired optimization algorithm",
Communications in Nonlinear Science and Numerical Simulation 17:4831-4845. Equation numbers
are those of that paper. Departures: the food weights are taken relative to the best krill, so
that the objective may be zero or negative; the best krill is kept (elitism) and diffusion
shrinks with the merit of a krill, both as in the authors' own program.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Objective = Callable[[Floats], float]

MAX_INDUCED, MAX_FORAGING, MAX_DIFFUSION = 0.01, 0.02, 0.005  # N_max, V_f, D_max of section 3
TIME_CONSTANT = 0.3  # C_t of Eq. 19, in [0, 2]
CROSSOVER, MUTATION = 0.2, 0.05  # Eq. 21 and 23
TINY = 1e-12


@dataclass(frozen=True)
class Found:
    """Best point, its value, evaluations spent, and the best value after each generation."""

    best: Floats
    value: float
    evaluations: int
    history: list[float]


def _unit(difference: Floats) -> Floats:
    """Directions of vectors along the last axis."""
    norm = np.linalg.norm(difference, axis=-1, keepdims=True)
    return np.asarray(difference / (norm + TINY))


def _induced(x: Floats, f: Floats, best: int, spread: float, pull: Floats) -> Floats:
    """Direction alpha of the motion induced by neighbours and the best krill, Eq. 4-8."""
    towards = x[None, :, :] - x[:, None, :]  # from krill i to krill j
    distance = np.linalg.norm(towards, axis=2)
    sensing = distance.mean(axis=1) / 5.0  # Eq. 7
    near = (distance < sensing[:, None]) & ~np.eye(len(x), dtype=bool)
    merit = (f[:, None] - f[None, :]) / spread  # Eq. 6
    local = ((near * merit)[:, :, None] * _unit(towards)).sum(axis=1)  # Eq. 4, 5
    to_best = (f - f[best])[:, None] / spread * _unit(x[best] - x)
    return np.asarray(local + pull[:, None] * to_best)  # Eq. 8


def _foraging(
    x: Floats, f: Floats, own: Floats, own_f: Floats, spread: float, food_f: float, food: Floats,
    attraction: float,
) -> Floats:  # fmt: skip
    """Direction beta towards the food and each krill's own best, Eq. 11-15."""
    to_food = attraction * ((f - food_f) / spread)[:, None] * _unit(food - x)
    to_own = ((f - own_f) / spread)[:, None] * _unit(own - x)
    return np.asarray(to_food + to_own)


def _food(x: Floats, f: Floats) -> Floats:
    """Centre of food, Eq. 12, weights 1/K with K relative to the best krill."""
    span = float(np.ptp(f))
    weights = 1.0 / (f - f.min() + 0.01 * span + TINY)
    return np.asarray(weights @ x / weights.sum())


def _cross_and_mutate(
    x: Floats, f: Floats, best: int, spread: float, rng: np.random.Generator
) -> Floats:
    """Genetic operators, Eq. 20-23: more of both, the worse a krill is."""
    count = len(x)
    merit = ((f - f[best]) / spread)[:, None]
    partner = rng.integers(count, size=count)
    cross = rng.random(x.shape) < CROSSOVER * merit
    mixed = np.where(cross, x[partner], x)
    p, q = rng.integers(count, size=(2, count))
    rate = MUTATION / np.maximum(merit, MUTATION)
    mutate = (rng.random(x.shape) < rate) & (merit > 0.0)
    jumped = x[best] + rng.random((count, 1)) * (x[p] - x[q])
    return np.asarray(np.where(mutate, jumped, mixed))


def krill_herd(
    objective: Objective,
    dimensions: int,
    *,
    evaluations: int = 5000,
    population: int = 30,
    seed: int = 0,
    start: Floats | None = None,
) -> Found:
    """Minimise a function over the unit cube.

    Parameters
    ----------
    objective : called with a point of the cube.
    dimensions : of the cube, >= 1.
    evaluations : at most so many calls.
    population : krill in the herd, >= 4.
    seed : of all random numbers; the same seed gives the same path.
    start : a point that one krill starts from.

    Returns
    -------
    Found

    Examples
    --------
    >>> found = krill_herd(lambda u: float(((u - 0.3) ** 2).sum()), 2, evaluations=2000)
    >>> found.value < 1e-3
    True
    """
    rng = np.random.default_rng(seed)
    x = rng.random((population, dimensions))
    if start is not None:
        x[0] = start
    f = np.array([objective(point) for point in x])
    own, own_f = x.copy(), f.copy()
    induced, foraging = np.zeros_like(x), np.zeros_like(x)
    top, top_f = x[np.argmin(f)].copy(), float(f.min())
    generations = max(1, (evaluations - population) // (population + 1))
    spent, history = population, [top_f]
    for generation in range(generations):
        late = generation / generations
        inertia = 0.1 + 0.8 * (1.0 - late)
        best = int(np.argmin(f))
        spread = max(float(np.ptp(f)), TINY)
        food = _food(x, f)
        food_f = objective(food)
        spent += 1
        if food_f < top_f:
            top, top_f = food.copy(), food_f
        pull = 2.0 * (rng.random(population) + late)  # C_best, Eq. 9
        attraction = 2.0 * (1.0 - late)  # C_food, Eq. 14
        induced = MAX_INDUCED * _induced(x, f, best, spread, pull) + inertia * induced  # Eq. 2
        beta = _foraging(x, f, own, own_f, spread, food_f, food, attraction)
        foraging = MAX_FORAGING * beta + inertia * foraging  # Eq. 10
        worth = ((f - f[best]) / spread)[:, None]
        diffusion = MAX_DIFFUSION * (1.0 - late) * worth * rng.uniform(-1.0, 1.0, x.shape)  # Eq. 17
        scale = TIME_CONSTANT * dimensions  # Eq. 19 in the unit cube
        moved = x + scale * (induced + foraging + diffusion)  # Eq. 18
        moved = _cross_and_mutate(moved, f, best, spread, rng)
        x = np.clip(moved, 0.0, 1.0)
        f = np.array([objective(point) for point in x])
        spent += population
        better = f < own_f
        own[better], own_f[better] = x[better], f[better]
        if f.min() < top_f:
            top, top_f = x[np.argmin(f)].copy(), float(f.min())
        worst = int(np.argmax(f))
        x[worst], f[worst] = top, top_f  # elitism
        history.append(top_f)
    return Found(top, top_f, spent, history)
