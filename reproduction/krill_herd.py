"""Search by the krill herd, as in section 4.4.1.1 of Shen (2023).

Gandomi & Alavi (2012), "Krill herd: a new bio-inspired optimization algorithm",
Communications in Nonlinear Science and Numerical Simulation 17:4831-4845. Equation numbers
are those of that paper. Departures: the food weights are taken relative to the best krill, so
that the objective may be zero or negative; the best krill is kept (elitism) and diffusion
shrinks with the merit of a krill, both as in the authors' own program.

    tb.identify_bearing(records, bearing, search=krill_herd_search(2000))
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from thermobearing.core.records import Floats

Objective = Callable[[Floats], float]
MAX_INDUCED, MAX_FORAGING, MAX_DIFFUSION = 0.01, 0.02, 0.005  # N_max, V_f, D_max of section 3
TIME_CONSTANT = 0.3  # C_t of Eq. 19, in [0, 2]
CROSSOVER, MUTATION = 0.2, 0.05  # Eq. 21 and 23
TINY = 1e-12


class HerdResult(NamedTuple):
    """Best point, its value, evaluations spent, and the best value after each generation."""

    best: Floats
    value: float
    evaluations: int
    history: list[float]


def krill_herd(
    objective: Objective,
    dimensions: int,
    *,
    evaluations: int = 5000,
    population: int = 30,
    seed: int = 0,
    start: Floats | None = None,
) -> HerdResult:
    """Minimise a function over the unit cube by the krill herd, in `evaluations` at most."""
    rng = np.random.default_rng(seed)
    x = rng.random((population, dimensions))
    if start is not None:
        x[0] = start
    f = np.array([objective(point) for point in x])
    personal_best, personal_cost = x.copy(), f.copy()  # the best place of each krill
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
        sought = sought + ((f - personal_cost) / spread)[:, None] * _unit(personal_best - x)
        foraging = MAX_FORAGING * sought + inertia * foraging  # Eq. 10, 11
        worth = ((f - f[best]) / spread)[:, None]
        diffusion = MAX_DIFFUSION * (1.0 - late) * worth * rng.uniform(-1.0, 1.0, x.shape)  # Eq. 17
        scale = TIME_CONSTANT * dimensions  # Eq. 19 in the unit cube
        moved = x + scale * (induced + foraging + diffusion)  # Eq. 18
        x = np.clip(_cross_and_mutate(moved, worth, best, rng), 0.0, 1.0)
        f = np.array([objective(point) for point in x])
        spent += 1 + population
        better = f < personal_cost
        personal_best[better], personal_cost[better] = x[better], f[better]
        if f.min() < top_f:
            top, top_f = x[np.argmin(f)].copy(), float(f.min())
        worst = int(np.argmax(f))
        x[worst], f[worst] = top, top_f  # elitism
        history.append(top_f)
    return HerdResult(top, top_f, spent, history)


def _unit(difference: Floats) -> Floats:
    norm = np.linalg.norm(difference, axis=-1, keepdims=True)
    return np.asarray(difference / (norm + TINY))


def _induced(x: Floats, f: Floats, best: int, spread: float, pull: Floats) -> Floats:
    """Return the direction of motion induced by neighbours and the best krill, Eq. 4-8."""
    towards = x[None, :, :] - x[:, None, :]  # from krill i to krill j
    distance = np.linalg.norm(towards, axis=2)
    sensing = distance.mean(axis=1) / 5.0  # Eq. 7
    neighbours = (distance < sensing[:, None]) & ~np.eye(len(x), dtype=bool)
    merit = (f[:, None] - f[None, :]) / spread  # Eq. 6
    local = ((neighbours * merit)[:, :, None] * _unit(towards)).sum(axis=1)  # Eq. 4, 5
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


def krill_herd_search(
    evaluations: int = 2000, seed: int = 0
) -> Callable[[Objective, Floats], Floats]:
    """Return a search for `tb.identify_bearing` that spends so many evaluations of the model."""

    def search(objective: Objective, start: Floats) -> Floats:
        herd = krill_herd(objective, len(start), evaluations=evaluations, seed=seed, start=start)
        return herd.best

    return search
