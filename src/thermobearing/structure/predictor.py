"""The source's predictor-corrector (Eq. 3.8-3.16), as a hybrid test runs it.

The displacement is predicted with the initial stiffness, the specimen is moved there once, and
the force that it answers with corrects acceleration, velocity and displacement. Two slips of
the print are mended: Eq. 3.7 says Delta a_n for a_n, and Eq. 3.15-3.16 subtract
Delta a_c dt/2 and beta Delta a_c dt^2.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.compile import compiled
from thermobearing.core.types import COMPLETED, Floats
from thermobearing.structure.books import add_books, commit, write_motion_row
from thermobearing.structure.dense import solve_dense
from thermobearing.structure.forces import along, restoring
from thermobearing.structure.types import (
    COMMAND,
    DIVERGED,
    LOAD,
    NO_EQUILIBRIUM,
    PREDICTED_A,
    PREDICTED_V,
    RESIDUAL,
    RESTORING,
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
def effective_mass(
    system: System, motion: Motion, stiffness: Floats, beta: float, dt: float
) -> None:
    """M + C dt/2 + beta K dt^2 (Eq. 3.9), into the scratch matrix."""
    n = motion.tangent.shape[0]
    for i in range(n):
        for j in range(n):
            motion.matrix[i, j] = (
                system.mass[i, j]
                + 0.5 * dt * system.damping[i, j]
                + beta * dt * dt * stiffness[i, j]
            )


@compiled
def predict(
    system: System,
    motion: Motion,
    stiffness: Floats,
    beta: float,
    dt: float,
    ground_change: float,
) -> bool:
    """Delta a_p of Eq. 3.12 into row LOAD, the predicted displacement into row TRIAL."""
    vectors, n = motion.vectors, motion.tangent.shape[0]
    for i in range(n):
        force = system.load[i] * ground_change
        for j in range(n):
            by_a = dt * system.damping[i, j] + 0.5 * dt * dt * stiffness[i, j]  # Eq. 3.10
            force -= by_a * vectors[A, j] + dt * stiffness[i, j] * vectors[V, j]  # Eq. 3.11
        vectors[LOAD, i] = force
    effective_mass(system, motion, stiffness, beta, dt)
    if not solve_dense(motion.matrix, vectors, LOAD):
        return False
    for i in range(n):
        vectors[TRIAL, i] = (
            vectors[Q, i]
            + dt * vectors[V, i]
            + dt * dt * (0.5 * vectors[A, i] + beta * vectors[LOAD, i])
        )
    return True


@compiled
def correct(system: System, motion: Motion, stiffness: Floats, beta: float, dt: float) -> bool:
    """Acceleration, velocity and displacement with the measured force (Eq. 3.13-3.16)."""
    vectors, n = motion.vectors, motion.tangent.shape[0]
    for i in range(n):
        force = vectors[TRIAL_RESTORING, i] - vectors[RESTORING, i]
        for j in range(n):
            force -= stiffness[i, j] * (vectors[TRIAL, j] - vectors[Q, j])
        vectors[RESIDUAL, i] = force
    effective_mass(system, motion, stiffness, beta, dt)
    if not solve_dense(motion.matrix, vectors, RESIDUAL):
        return False
    for i in range(n):
        change = vectors[LOAD, i] - vectors[RESIDUAL, i]
        vectors[PREDICTED_A, i] = vectors[A, i] + change
        vectors[PREDICTED_V, i] = vectors[V, i] + dt * (vectors[A, i] + 0.5 * change)
        vectors[COMMAND, i] = vectors[TRIAL, i] - beta * dt * dt * vectors[RESIDUAL, i]
    return True


@compiled
def delayed(system: System, motion: Motion, commands: Floats, k: int, lag: float) -> None:
    """Where the actuators are at the end of step k: where they were told to be `lag` steps ago."""
    for b in range(system.lines.shape[0]):
        commands[k + 1, b] = along(system.line_rows, b, motion.vectors, TRIAL)
        place = max(k + 1 - lag, 0.0)
        before = int(place)
        after = min(before + 1, k + 1)
        part = place - before
        motion.stretches[b] = (1.0 - part) * commands[before, b] + part * commands[after, b]


@compiled
def predictor_march(
    system: System,
    bearings: Any,
    works: Any,
    states: Any,
    spares: Any,
    motion: Motion,
    scheme: Scheme,
    stiffness: Floats,
    ground: Floats,
    dt: float,
    ambient: Floats,
    noise: Floats,
    commands: Floats,
    lag: float,
    keep: NDArray[np.bool_],
    rows: Floats,
) -> tuple[int, int, int]:
    """March with one force per step, as with a specimen in the loop.

    Parameters
    ----------
    stiffness : [n, n] of the predictor, initial stiffness of everything.
    noise : [steps] added to the force of every modelled bearing [kN].
    commands : [steps + 1, b] scratch: stretches that the actuators were told to reach; zeros.
    lag : delay of the actuators, in steps, >= 0: the force is read where they were told to be then.

    Returns
    -------
    steps done, rows written, outcome.
    """
    vectors, n = motion.vectors, motion.tangent.shape[0]
    kept = 0
    for k in range(len(ground) - 1):
        if not predict(system, motion, stiffness, scheme.beta, dt, ground[k + 1] - ground[k]):
            return k, kept, NO_EQUILIBRIUM
        for i in range(n):
            if not abs(vectors[TRIAL, i]) < FARTHEST:
                return k, kept, DIVERGED
        delayed(system, motion, commands, k, lag)
        outcome = restoring(
            system, bearings, works, states, spares, motion, TRIAL, TRIAL_RESTORING, dt,
            ambient[k], noise[k],
        )  # fmt: skip
        if outcome != COMPLETED:
            return k, kept, outcome
        if not correct(system, motion, stiffness, scheme.beta, dt):
            return k, kept, NO_EQUILIBRIUM
        add_books(system, motion, ground[k], ground[k + 1], COMMAND)
        commit(system, states, spares, motion, dt, COMMAND, TRIAL_RESTORING)
        if keep[k]:
            write_motion_row(bearings, states, motion, rows, kept)
            kept += 1
    return len(ground) - 1, kept, COMPLETED
