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


def _towards(x: Floats, place: Floats, worth: Floats) -> Floats:
    """Direction from each krill towards a place, times what going there is worth to it."""
    return np.asarray(worth[:, None] * _unit(place - x))


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


@dataclass
class _Herd:
    """Where krill are and what that is worth; their own best places; their motions."""

    x: Floats
    f: Floats
    own: Floats
    own_f: Floats
    induced: Floats
    foraging: Floats
    top: Floats
    top_f: float

    def keep_best(self) -> None:
        """Remember the best places of each krill and of all."""
        better = self.f < self.own_f
        self.own[better], self.own_f[better] = self.x[better], self.f[better]
        self.see(self.x[np.argmin(self.f)], float(self.f.min()))

    def see(self, place: Floats, value: float) -> None:
        """Remember a place that is better than all so far."""
        if value < self.top_f:
            self.top, self.top_f = place.copy(), value


def _herd(objective: Objective, x: Floats) -> _Herd:
    """Krill at rest."""
    f = np.array([objective(point) for point in x])
    still, best = np.zeros_like(x), int(np.argmin(f))
    return _Herd(x, f, x.copy(), f.copy(), still, still.copy(), x[best].copy(), float(f[best]))


def _moved(
    herd: _Herd, food: Floats, food_f: float, late: float, rng: np.random.Generator
) -> Floats:
    """Where the krill swim, Eq. 2, 10, 17 and 18, and what genetics make of it; not yet clipped."""
    x, f = herd.x, herd.f
    best, spread = int(np.argmin(f)), max(float(np.ptp(f)), TINY)
    inertia = 0.1 + 0.8 * (1.0 - late)
    pull = 2.0 * (rng.random(len(x)) + late)  # C_best, Eq. 9
    attraction = 2.0 * (1.0 - late)  # C_food, Eq. 14
    induced = MAX_INDUCED * _induced(x, f, best, spread, pull)
    herd.induced = induced + inertia * herd.induced  # Eq. 2
    to_food = _towards(x, food, attraction * ((f - food_f) / spread))
    to_own = _towards(x, herd.own, (f - herd.own_f) / spread)
    herd.foraging = MAX_FORAGING * (to_food + to_own) + inertia * herd.foraging  # Eq. 10, 11
    worth = ((f - f[best]) / spread)[:, None]
    diffusion = MAX_DIFFUSION * (1.0 - late) * worth * rng.uniform(-1.0, 1.0, x.shape)  # Eq. 17
    scale = TIME_CONSTANT * x.shape[1]  # Eq. 19 in the unit cube
    moved = x + scale * (herd.induced + herd.foraging + diffusion)  # Eq. 18
    return _cross_and_mutate(moved, f, best, spread, rng)


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
    seed : of all random numbers, >= 0; the same seed gives the same path.
    start : a point that one krill starts from, each number in [0, 1].

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
    herd = _herd(objective, x)
    spent, history = population, [herd.top_f]
    generations = max(1, (evaluations - population) // (population + 1))
    for generation in range(generations):
        food = _food(herd.x, herd.f)
        food_f = objective(food)
        herd.see(food, food_f)
        moved = _moved(herd, food, food_f, generation / generations, rng)
        herd.x = np.clip(moved, 0.0, 1.0)
        herd.f = np.array([objective(point) for point in herd.x])
        spent += 1 + population
        herd.keep_best()
        worst = int(np.argmax(herd.f))
        herd.x[worst], herd.f[worst] = herd.top, herd.top_f  # elitism
        history.append(herd.top_f)
    return Found(herd.top, herd.top_f, spent, history)
