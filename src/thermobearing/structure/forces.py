"""Restoring forces of a structure at trial coordinates: springs, hinges, bearings."""

from thermobearing.core.compile import compiled
from thermobearing.core.lanes.choose import all_lanes, any_lane, select
from thermobearing.core.records import Floats, Rows
from thermobearing.core.step import begin, has_failed, move, settle
from thermobearing.core.types import COMPLETED
from thermobearing.structure.lines import Bearings, state_of, work_of
from thermobearing.structure.takeda import takeda
from thermobearing.structure.types import Coordinate, LineFactors, Motion, System

SHORTEST = 1e-6  # s: step of a bearing that is on its own clock and does not move


@compiled
def along(rows: Floats, row: int, points: Rows[Coordinate]) -> float:
    """Stretch or rotation of one connection at the trial coordinates."""
    total = 0.0
    for i in range(rows.shape[1]):
        total += rows[row, i] * points[i].trial
    return total


@compiled
def spread(rows: Floats, row: int, force: float, stiffness: float, motion: Motion) -> None:
    """Add the force and stiffness of one connection to those of the coordinates."""
    for i in range(rows.shape[1]):
        if any_lane(rows[row, i] != 0.0):
            motion.points[i].trial_restoring += rows[row, i] * force
            for j in range(rows.shape[1]):
                motion.tangent[i, j] += rows[row, i] * rows[row, j] * stiffness


@compiled
def bearing_dt(line: LineFactors, dt: float, dx: float) -> float:
    """How long the modelled bearing takes for dx [mm]: earthquake time, or that of its actuator."""
    quake = line.speed == 0.0
    if all_lanes(quake):
        return dt
    return select(quake, dt, max(abs(dx) / line.speed, SHORTEST))


@compiled
def set_stretches(system: System, motion: Motion) -> None:
    """Bearings follow the structure at once."""
    for b in range(len(system.lines)):
        motion.stretches[b] = along(system.line_rows, b, motion.points)


@compiled
def begin_bearings(bearings: Bearings) -> None:
    """What the bearings need once a step, before `restoring`."""
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            begin(kind.constants, work_of(kind, m), state_of(kind.states, m))


@compiled
def settle_bearings(system: System, bearings: Bearings, ambient: float) -> int:
    """Heat and books of the bearings' last trials, once they are accepted.

    A line may be in warmer air than `ambient` [degC].
    Returns an outcome of the coupled step.
    """
    outcome = COMPLETED
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            state, work = state_of(kind.states, m), work_of(kind, m)
            trial, dt = state_of(kind.trials, m), kind.durations[m]
            air = ambient + system.lines[kind.lines[m]].warmer
            ended = settle(kind.constants, work, state, dt, air, trial)
            outcome = select(outcome == COMPLETED, ended, outcome)
            if all_lanes(outcome != COMPLETED):
                return outcome
    return outcome


@compiled
def move_bearings(
    system: System, bearings: Bearings, motion: Motion, dt: float, noise: float
) -> int:
    """Forces of the bearing lines at `motion.stretches`, and their tangent, added."""
    outcome = COMPLETED
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            state, work = state_of(kind.states, m), work_of(kind, m)
            trial = state_of(kind.trials, m)
            line, b = system.lines[kind.lines[m]], kind.lines[m]
            x = line.start + line.length_factor * motion.stretches[b]
            own_dt = bearing_dt(line, dt, x - state.books[0].displacement)
            kind.durations[m] = own_dt
            force, slope, moved = move(kind.constants, work, state, x, own_dt, trial)
            outcome = select((outcome == COMPLETED) & has_failed(moved), moved, outcome)
            if all_lanes(outcome != COMPLETED):
                return outcome
            slope *= line.force_factor * line.length_factor
            felt = line.force_factor * (force - line.at_rest + noise)
            spread(system.line_rows, b, felt, slope, motion)
    return outcome


@compiled
def restoring(system: System, bearings: Bearings, motion: Motion, dt: float, noise: float) -> int:
    """Restoring forces at the trial coordinates, and their tangent; after `begin_bearings`.

    The bearing lines are at the stretches `motion.stretches`, which an actuator may delay.
    Starts from the committed states and hinges, writes their trials. `noise` is added to the
    force of every modelled bearing [kN]. Returns an outcome of the coupled step.
    """
    points, n = motion.points, motion.tangent.shape[0]
    for i in range(n):
        points[i].trial_restoring = 0.0
        for j in range(n):
            motion.tangent[i, j] = system.stiffness[i, j]
            points[i].trial_restoring += system.stiffness[i, j] * points[j].trial
    for h in range(len(system.hinges)):
        rotation = along(system.hinge_rows, h, motion.points)
        slope = takeda(system.hinges, motion.hinges, h, rotation, motion.trial_hinges)
        spread(system.hinge_rows, h, motion.trial_hinges.bends[h].moment, slope, motion)
    return move_bearings(system, bearings, motion, dt, noise)
