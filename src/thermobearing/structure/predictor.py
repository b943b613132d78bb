"""The predictor-corrector of Shen (2023), Eq. 3.8-3.16, as a hybrid test runs it.

The displacement is predicted with the initial stiffness, the specimen is moved there once, and
its measured force corrects the acceleration, the velocity and the displacement. Two misprints are
corrected: Eq. 3.7 has Delta a_n in place of a_n, and Eq. 3.15-3.16 subtract Delta a_c dt/2 and
beta Delta a_c dt^2.
"""

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.records import Floats
from thermobearing.core.types import COMPLETED
from thermobearing.structure.forces import (
    Bearings,
    add_energies,
    along,
    begin_bearings,
    commit,
    keep_motion,
    restoring,
    settle_bearings,
    solve_dense,
)
from thermobearing.structure.types import (
    DIVERGED,
    FARTHEST,
    MEASURE,
    NO_EQUILIBRIUM,
    Actuators,
    Motion,
    MotionRows,
    Scheme,
    Shaking,
    System,
)


@compiled
def effective_mass(
    system: System, motion: Motion, stiffness: Floats, beta: float, dt: float
) -> None:
    """Write M + C dt/2 + beta K dt^2 (Eq. 3.9) into the scratch matrix."""
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
    """Write Delta a_p of Eq. 3.12 into `load`, and the predicted displacement into `trial`."""
    points, unknowns, n = motion.points, motion.unknowns, motion.tangent.shape[0]
    for i in range(n):
        force = system.load[i] * ground_change
        for j in range(n):
            by_a = dt * system.damping[i, j] + 0.5 * dt * dt * stiffness[i, j]  # Eq. 3.10
            force -= by_a * points[j].a + dt * stiffness[i, j] * points[j].v  # Eq. 3.11
        unknowns[i] = force
    effective_mass(system, motion, stiffness, beta, dt)
    if not solve_dense(motion.matrix, unknowns):
        return False
    for i in range(n):
        points[i].load = unknowns[i]
        points[i].trial = (
            points[i].q + dt * points[i].v + dt * dt * (0.5 * points[i].a + beta * points[i].load)
        )
    return True


@compiled
def correct(system: System, motion: Motion, stiffness: Floats, beta: float, dt: float) -> bool:
    """Correct acceleration, velocity and displacement by the measured force (Eq. 3.13-3.16)."""
    points, unknowns, n = motion.points, motion.unknowns, motion.tangent.shape[0]
    for i in range(n):
        force = points[i].trial_restoring - points[i].restoring
        for j in range(n):
            force -= stiffness[i, j] * (points[j].trial - points[j].q)
        unknowns[i] = force
    effective_mass(system, motion, stiffness, beta, dt)
    if not solve_dense(motion.matrix, unknowns):
        return False
    for i in range(n):
        change = points[i].load - unknowns[i]
        points[i].predicted_a = points[i].a + change
        points[i].predicted_v = points[i].v + dt * (points[i].a + 0.5 * change)
        points[i].trial = points[i].trial - beta * dt * dt * unknowns[i]
    return True


@compiled
def _command(actuators: Actuators, b: int, k: int) -> float:
    """Return the stretch of line b to command at the end of step k, extrapolated by the delay."""
    targets, command = actuators.targets, 0.0
    for i in range(actuators.weights.shape[1]):
        # Before the start the structure was straight; between steps targets are linear.
        place = max(k + 1 - i * actuators.ahead, 0.0)
        before = int(place)
        part = place - before
        early, late = targets[before, b], targets[min(before + 1, k + 1), b]
        command += actuators.weights[b, i] * (early + part * (late - early))
    return command


@compiled
def set_positions(system: System, motion: Motion, actuators: Actuators, k: int) -> None:
    """Set the positions of the actuators at the end of step k: their commands `lag` steps ago."""
    commands = actuators.commands
    for b in range(len(system.lines)):
        actuators.targets[k + 1, b] = along(system.line_rows, b, motion.points)
        commands[k + 1, b] = _command(actuators, b, k)
        place = max(k + 1 - actuators.lag, 0.0)
        before = int(place)
        after = min(before + 1, k + 1)
        part = place - before
        motion.stretches[b] = (1.0 - part) * commands[before, b] + part * commands[after, b]


@compiled
def _move(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    actuators: Actuators,
    k: int,
) -> int:
    """Predict step k and move the bearings there; returns an outcome."""
    points, ground, dt = motion.points, shaking.ground, shaking.dt
    change = ground[k + 1] - ground[k]
    if not predict(system, motion, actuators.stiffness, scheme.beta, dt, change):
        return NO_EQUILIBRIUM
    for i in range(motion.tangent.shape[0]):
        if not abs(points[i].trial) < FARTHEST:
            return DIVERGED
    set_positions(system, motion, actuators, k)
    begin_bearings(system, bearings)
    outcome = restoring(system, bearings, motion, dt, actuators.noise[k])
    if outcome != COMPLETED:
        return outcome
    return settle_bearings(system, bearings, shaking.ambient[k])


@compiled
def predictor_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    actuators: Actuators,
    rows: MotionRows,
    moved: int,
    kept: int,
) -> tuple[int, int, int]:
    """March with one force per step, as with a specimen in the loop.

    With a specimen outside (`actuators.outside`) the march returns MEASURE in every step, when
    the bearings have moved. The caller replaces the force of the specimen in the restoring forces
    of the trial, and calls again with the number of that step as `moved` and the rows written so
    far as `kept`. At first these are -1 and 0.

    Returns
    -------
    steps done, rows written, outcome.
    """
    ground, dt = shaking.ground, shaking.dt
    for k in range(max(moved, 0), len(ground) - 1):
        if k != moved:
            outcome = _move(system, bearings, motion, scheme, shaking, actuators, k)
            if outcome != COMPLETED:
                return k, kept, outcome
            if actuators.outside:
                return k, kept, MEASURE
        if not correct(system, motion, actuators.stiffness, scheme.beta, dt):
            return k, kept, NO_EQUILIBRIUM
        add_energies(system, motion, ground[k], ground[k + 1])
        commit(system, bearings, motion, dt)
        if shaking.keep[k]:
            keep_motion(bearings, motion, rows, kept)
            kept += 1
    return len(ground) - 1, kept, COMPLETED
