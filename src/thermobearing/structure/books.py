"""Energy books of the whole structure, and what a step leaves behind when it is accepted."""

from thermobearing.core.compile import compiled
from thermobearing.core.march import copy_state
from thermobearing.core.step import layer_temperature
from thermobearing.structure.lines import Bearings, state_of
from thermobearing.structure.types import Motion, MotionRows, System


@compiled
def add_books(system: System, motion: Motion, before: float, after: float) -> None:
    """Work of one step to the trial, trapezoidal.

    `before` and `after` are ground accelerations [mm/s2]. The work of the bearings comes from
    their own books, see `commit`.
    """
    books, points, n = motion.books[0], motion.points, motion.tangent.shape[0]
    given = 0.0
    damped = 0.0
    kinetic = 0.0
    stored = 0.0
    for i in range(n):
        dq = points[i].trial - points[i].q
        given += 0.5 * (before + after) * system.load[i] * dq
        for j in range(n):
            mean = 0.5 * (points[j].v + points[j].predicted_v)
            damped += dq * system.damping[i, j] * mean
            kinetic += 0.5 * points[i].predicted_v * system.mass[i, j] * points[j].predicted_v
            stored += 0.5 * points[i].trial * system.stiffness[i, j] * points[j].trial
    hinged = 0.0
    for h in range(len(system.hinges)):
        old, new = motion.hinges.bends[h], motion.trial_hinges.bends[h]
        turned = new.rotation - old.rotation
        hinged += 0.5 * (new.moment + old.moment) * turned
    books.input += given
    books.damping += damped
    books.hinges += hinged
    books.kinetic = kinetic
    books.springs = stored


@compiled
def commit(system: System, bearings: Bearings, motion: Motion, dt: float) -> None:
    """The trial becomes the state."""
    books, points = motion.books[0], motion.points
    books.bearings = 0.0
    for i in range(motion.tangent.shape[0]):
        points[i].q = points[i].trial
        points[i].v = points[i].predicted_v
        points[i].a = points[i].predicted_a
        points[i].restoring = points[i].trial_restoring
    for h in range(len(system.hinges)):
        motion.hinges.bends[h] = motion.trial_hinges.bends[h]
        for side in range(2):
            motion.hinges.sides[h, side] = motion.trial_hinges.sides[h, side]
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            state, line = state_of(kind.states, m), system.lines[kind.lines[m]]
            copy_state(state_of(kind.trials, m), state)
            bearing = state.books[0]
            felt = bearing.work_in - line.at_rest * (bearing.displacement - line.start)
            books.bearings += line.force_factor / line.length_factor * felt
    books.clock += dt


@compiled
def keep_motion(bearings: Bearings, motion: Motion, rows: MotionRows, row: int) -> None:
    """Write the state of the structure, its hinges and its bearings into one row."""
    rows.books[row] = motion.books[0]
    for i in range(motion.tangent.shape[0]):
        rows.q[row, i] = motion.points[i].q
        rows.v[row, i] = motion.points[i].v
        rows.a[row, i] = motion.points[i].a
    for h in range(len(motion.hinges.bends)):
        rows.hinges[row, h] = motion.hinges.bends[h]
    for k in range(len(bearings)):
        kind, layers, profiles = bearings[k], rows.layers[k], rows.cells[k]
        cells = kind.constants.layer_cells
        for m in range(len(kind.lines)):
            rows.bearings[row, kind.lines[m]] = kind.states.books[m, 0]
            temperature, kept = kind.states.temperature[m], layers[row, m]
            for j in range(len(cells)):
                kept[j] = layer_temperature(cells, temperature, j)
            for i in range(profiles.shape[2]):
                profiles[row, m, i] = temperature[i]
