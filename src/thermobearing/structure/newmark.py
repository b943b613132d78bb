"""Newmark's method with Newton iterations on the coupled bearings, and its energy books.

beta = 1/4, gamma = 1/2 (constant mean acceleration) keeps the books to the tolerance of the
iterations: every work is the trapezoidal sum of forces at the ends of steps, and for those
the scheme is exact. beta = 1/6 (linear acceleration, the source's) does not.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.compile import compiled
from thermobearing.core.types import COMPLETED, Floats
from thermobearing.structure.books import add_books, commit, write_motion_row
from thermobearing.structure.dense import solve_dense
from thermobearing.structure.forces import restoring, set_stretches
from thermobearing.structure.types import (
    DIVERGED,
    ITERATIONS,
    NO_EQUILIBRIUM,
    PREDICTED_A,
    PREDICTED_V,
    RESIDUAL,
    SUBSTEPS,
    TRIAL,
    TRIAL_RESTORING,
    A,
    Motion,
    Q,
    Scheme,
    System,
    V,
)

FARTHEST = 1e9  # a coordinate beyond this has diverged [mm or rad]


@compiled
def start_motion(system: System, motion: Motion, ground: float) -> bool:
    """Acceleration at rest under the first ground acceleration."""
    n = motion.tangent.shape[0]
    for i in range(n):
        motion.vectors[A, i] = system.load[i] * ground
        for j in range(n):
            motion.matrix[i, j] = system.mass[i, j]
    return solve_dense(motion.matrix, motion.vectors, A)


@compiled
def residual(system: System, motion: Motion, scheme: Scheme, dt: float, ground: float) -> float:
    """Unbalanced forces at the trial coordinates, the effective tangent, and a norm of them.

    Each force is weighed with its own effective stiffness, since rotations and displacements
    have different units; the norm has the unit of the square root of an energy.
    """
    vectors, n = motion.vectors, motion.tangent.shape[0]
    by_a, by_v = 1.0 / (scheme.beta * dt * dt), scheme.gamma / (scheme.beta * dt)
    for i in range(n):
        change = vectors[TRIAL, i] - vectors[Q, i]
        a = by_a * (change - dt * vectors[V, i]) - (0.5 / scheme.beta - 1.0) * vectors[A, i]
        vectors[PREDICTED_A, i] = a
        vectors[PREDICTED_V, i] = vectors[V, i] + dt * (
            (1.0 - scheme.gamma) * vectors[A, i] + scheme.gamma * a
        )
    norm = 0.0
    for i in range(n):
        r = system.load[i] * ground - vectors[TRIAL_RESTORING, i]
        for j in range(n):
            r -= system.mass[i, j] * vectors[PREDICTED_A, j]
            r -= system.damping[i, j] * vectors[PREDICTED_V, j]
            motion.matrix[i, j] = (
                motion.tangent[i, j] + by_a * system.mass[i, j] + by_v * system.damping[i, j]
            )
        vectors[RESIDUAL, i] = r
        norm += r * r / abs(motion.matrix[i, i])
    return norm


@compiled
def newmark_step(
    system: System,
    bearings: Any,
    works: Any,
    states: Any,
    news: Any,
    motion: Motion,
    scheme: Scheme,
    dt: float,
    ground: float,
    ambient: float,
    scale: float,
) -> int:
    """One step to the end of dt, where the ground acceleration is `ground`; nothing committed.

    `scale` is the largest ground acceleration of the motion, which makes the tolerance relative.
    """
    vectors, n = motion.vectors, motion.tangent.shape[0]
    for i in range(n):
        vectors[TRIAL, i] = vectors[Q, i] + dt * vectors[V, i] + 0.5 * dt * dt * vectors[A, i]
    for _ in range(scheme.iterations):
        set_stretches(system, motion, TRIAL)
        outcome = restoring(
            system, bearings, works, states, news, motion, TRIAL, TRIAL_RESTORING, dt, ambient, 0.0
        )
        if outcome != COMPLETED:
            return outcome
        norm = residual(system, motion, scheme, dt, ground)
        limit = 0.0
        for i in range(n):
            force = scheme.tolerance * system.load[i] * scale
            limit += force * force / abs(motion.matrix[i, i])
        motion.books[ITERATIONS] += 1.0
        if norm <= limit:
            return COMPLETED
        if not solve_dense(motion.matrix, vectors, RESIDUAL):
            return NO_EQUILIBRIUM
        for i in range(n):
            vectors[TRIAL, i] += vectors[RESIDUAL, i]
            if not abs(vectors[TRIAL, i]) < FARTHEST:
                return DIVERGED
    return NO_EQUILIBRIUM


@compiled
def newmark_march(
    system: System,
    bearings: Any,
    works: Any,
    states: Any,
    spares: Any,
    motion: Motion,
    scheme: Scheme,
    ground: Floats,
    dt: float,
    ambient: Floats,
    keep: NDArray[np.bool_],
    rows: Floats,
) -> tuple[int, int, int]:
    """March through the ground acceleration [mm/s2], steps of dt [s].

    A step without equilibrium is cut in half, again and again up to `scheme.halvings` times;
    the ground acceleration is linear between its samples.

    Returns
    -------
    steps done, rows written, outcome. `motion` and `states` hold the last good state.
    """
    scale = 0.0
    for k in range(len(ground)):
        scale = max(scale, abs(ground[k]))
    outcome = COMPLETED
    kept = 0
    for k in range(len(ground) - 1):
        done = 0  # of the step, in units of its smallest part
        whole = 1 << scheme.halvings
        part = whole
        while done < whole:
            share = (done + part) / whole
            target = ground[k] + share * (ground[k + 1] - ground[k])
            sub = dt * part / whole
            outcome = newmark_step(
                system, bearings, works, states, spares, motion, scheme, sub, target, ambient[k],
                scale,
            )  # fmt: skip
            if outcome == COMPLETED:
                before = ground[k] + done / whole * (ground[k + 1] - ground[k])
                add_books(system, motion, before, target, TRIAL)
                commit(system, states, spares, motion, sub, TRIAL, TRIAL_RESTORING)
                done += part
                continue
            if part == 1:
                return k, kept, outcome
            part //= 2
            motion.books[SUBSTEPS] += 1.0
        if keep[k]:
            write_motion_row(bearings, states, motion, rows, kept)
            kept += 1
    return len(ground) - 1, kept, outcome
