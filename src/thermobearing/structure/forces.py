"""Restoring forces of a structure at trial coordinates: springs, hinges, bearings."""

from typing import Any

from thermobearing.core.compile import compiled
from thermobearing.core.step import step
from thermobearing.core.types import COMPLETED, DISPLACEMENT, SOFTENED, Floats
from thermobearing.structure.takeda import takeda
from thermobearing.structure.types import (
    FORCE_FACTOR,
    LENGTH_FACTOR,
    MOMENT,
    SPEED,
    Motion,
    System,
)

SHORTEST = 1e-6  # s: step of a bearing that is on its own clock and does not move


@compiled
def along(rows: Floats, row: int, vectors: Floats, of: int) -> float:
    """Stretch or rotation of one connection at the coordinates `vectors[of]`."""
    total = 0.0
    for i in range(rows.shape[1]):
        total += rows[row, i] * vectors[of, i]
    return total


@compiled
def spread(
    rows: Floats,
    row: int,
    force: float,
    stiffness: float,
    vectors: Floats,
    to: int,
    tangent: Floats,
) -> None:
    """Add the force and stiffness of one connection to those of the coordinates."""
    for i in range(rows.shape[1]):
        if rows[row, i] != 0.0:
            vectors[to, i] += rows[row, i] * force
            for j in range(rows.shape[1]):
                tangent[i, j] += rows[row, i] * rows[row, j] * stiffness


@compiled
def bearing_dt(line: Floats, b: int, dt: float, dx: float) -> float:
    """How long the modelled bearing takes for dx [mm]: earthquake time, or that of its actuator."""
    if line[b, SPEED] == 0.0:
        return dt
    moving: float = max(abs(dx) / line[b, SPEED], SHORTEST)
    return moving


@compiled
def set_stretches(system: System, motion: Motion, at: int) -> None:
    """Bearings follow the structure at once."""
    for b in range(system.lines.shape[0]):
        motion.stretches[b] = along(system.line_rows, b, motion.vectors, at)


@compiled
def restoring(
    system: System,
    bearings: Any,
    works: Any,
    states: Any,
    news: Any,
    motion: Motion,
    at: int,
    to: int,
    dt: float,
    ambient: float,
    noise: float,
) -> int:
    """Restoring forces at the coordinates `vectors[at]`, into `vectors[to]`, and their tangent.

    The bearing lines are at the stretches `motion.stretches`, which an actuator may delay.
    Starts from the committed `states` and hinges, writes `news` and `trial_hinges`. `noise` is
    added to the force of every modelled bearing [kN]. Returns an outcome of the coupled step.
    """
    vectors, tangent = motion.vectors, motion.tangent
    n = tangent.shape[0]
    for i in range(n):
        vectors[to, i] = 0.0
        for j in range(n):
            tangent[i, j] = system.stiffness[i, j]
            vectors[to, i] += system.stiffness[i, j] * vectors[at, j]
    for h in range(system.hinges.shape[0]):
        rotation = along(system.hinge_rows, h, vectors, at)
        slope = takeda(system.hinges, motion.hinges, h, rotation, motion.trial_hinges)
        moment = motion.trial_hinges[h, MOMENT]
        spread(system.hinge_rows, h, moment, slope, vectors, to, tangent)
    for b in range(len(bearings)):
        x = system.lines[b, LENGTH_FACTOR] * motion.stretches[b]
        own_dt = bearing_dt(system.lines, b, dt, x - states[b].books[DISPLACEMENT])
        force, slope, outcome = step(bearings[b], works[b], states[b], x, own_dt, ambient, news[b])
        if outcome != COMPLETED and outcome != SOFTENED:
            return outcome
        factor = system.lines[b, FORCE_FACTOR]
        slope *= factor * system.lines[b, LENGTH_FACTOR]
        spread(system.line_rows, b, factor * (force + noise), slope, vectors, to, tangent)
    return COMPLETED
