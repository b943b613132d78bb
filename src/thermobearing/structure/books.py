"""Energy books of the whole structure, and what a step leaves behind when it is accepted."""

from typing import Any

from thermobearing.core.compile import compiled
from thermobearing.core.march import copy_state
from thermobearing.core.step import layer_temperature
from thermobearing.core.types import BOOKS, WORK_IN, Floats
from thermobearing.structure.types import (
    BEARINGS,
    CLOCK,
    DAMPING,
    FORCE_FACTOR,
    HINGE_STATE,
    HINGES,
    INPUT,
    KINETIC,
    LENGTH_FACTOR,
    MOMENT,
    MOTION_BOOKS,
    PREDICTED_A,
    PREDICTED_V,
    RESTORING,
    ROTATION,
    SPRINGS,
    A,
    Motion,
    Q,
    System,
    V,
)


@compiled
def add_books(system: System, motion: Motion, before: float, after: float, to: int) -> None:
    """Work of one step, trapezoidal; `before` and `after` are ground accelerations [mm/s2].

    The work of the bearings comes from their own books, see `commit`.
    """
    vectors, books, n = motion.vectors, motion.books, motion.tangent.shape[0]
    given = 0.0
    damped = 0.0
    kinetic = 0.0
    stored = 0.0
    for i in range(n):
        dq = vectors[to, i] - vectors[Q, i]
        given += 0.5 * (before + after) * system.load[i] * dq
        for j in range(n):
            mean = 0.5 * (vectors[V, j] + vectors[PREDICTED_V, j])
            damped += dq * system.damping[i, j] * mean
            kinetic += 0.5 * vectors[PREDICTED_V, i] * system.mass[i, j] * vectors[PREDICTED_V, j]
            stored += 0.5 * vectors[to, i] * system.stiffness[i, j] * vectors[to, j]
    hinged = 0.0
    for h in range(system.hinges.shape[0]):
        old, new = motion.hinges, motion.trial_hinges
        turned = new[h, ROTATION] - old[h, ROTATION]
        hinged += 0.5 * (new[h, MOMENT] + old[h, MOMENT]) * turned
    books[INPUT] += given
    books[DAMPING] += damped
    books[HINGES] += hinged
    books[KINETIC] = kinetic
    books[SPRINGS] = stored


@compiled
def commit(
    system: System, states: Any, news: Any, motion: Motion, dt: float, to: int, restoring: int
) -> None:
    """The trial at `vectors[to]` becomes the state."""
    vectors = motion.vectors
    motion.books[BEARINGS] = 0.0
    for i in range(motion.tangent.shape[0]):
        vectors[Q, i] = vectors[to, i]
        vectors[V, i] = vectors[PREDICTED_V, i]
        vectors[A, i] = vectors[PREDICTED_A, i]
        vectors[RESTORING, i] = vectors[restoring, i]
    for h in range(motion.hinges.shape[0]):
        for k in range(HINGE_STATE):
            motion.hinges[h, k] = motion.trial_hinges[h, k]
    for b in range(len(states)):
        copy_state(news[b], states[b])
        per = system.lines[b, FORCE_FACTOR] / system.lines[b, LENGTH_FACTOR]
        motion.books[BEARINGS] += per * states[b].books[WORK_IN]
    motion.books[CLOCK] += dt


@compiled
def write_motion_row(bearings: Any, states: Any, motion: Motion, rows: Floats, row: int) -> None:
    """One kept row: books, then q, v, a, then each hinge, then each bearing with its layers."""
    n = motion.tangent.shape[0]
    at = 0
    for k in range(MOTION_BOOKS):
        rows[row, k] = motion.books[k]
    at = MOTION_BOOKS
    for i in range(n):
        rows[row, at + i] = motion.vectors[Q, i]
        rows[row, at + n + i] = motion.vectors[V, i]
        rows[row, at + 2 * n + i] = motion.vectors[A, i]
    at += 3 * n
    for h in range(motion.hinges.shape[0]):
        rows[row, at] = motion.hinges[h, ROTATION]
        rows[row, at + 1] = motion.hinges[h, MOMENT]
        at += 2
    for b in range(len(states)):
        for k in range(BOOKS):
            rows[row, at + k] = states[b].books[k]
        at += BOOKS
        for j in range(len(bearings[b].multiplicity)):
            rows[row, at] = layer_temperature(bearings[b].layer_cells, states[b].temperature, j)
            at += 1
