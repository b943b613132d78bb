"""Restoring forces of a structure at trial coordinates: springs, hinges, bearings.

One machine code serves any number of them; a tuple with an entry for each line would be another
type, and compile anew, for each number. Only a structure with several kinds of bearings has
several entries.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from thermobearing.core.compiled.kernel import compiled, compiled_apart
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.march import copy_state
from thermobearing.core.records import Floats, Ints, Rows
from thermobearing.core.step import begin, has_failed, layer_temperature, move, settle
from thermobearing.core.types import (
    COMPLETED,
    Constants,
    State,
    Vectors,
    Workspace,
    lead_at_start,
    new_state,
    new_workspace,
)
from thermobearing.core.vector import (
    Matrix,
    Vector,
    across,
    along_x,
    between,
    components,
    diagonal,
    direction,
    dot,
    each_times,
    farther,
    is_nonzero,
    isotropic,
    lowest,
    minus,
    norm,
    outer,
    pick,
    plus,
    scaled,
    zero,
)
from thermobearing.structure.connections.devices import device_force, oil_factor, stored_energy
from thermobearing.structure.connections.takeda import takeda
from thermobearing.structure.types import (
    DAMPER,
    GAP,
    SLIDER,
    Coordinate,
    LineFactors,
    Motion,
    MotionRows,
    System,
)
from thermobearing.structure.vertical import begin_section, keep_section, lend, press_line


@compiled
def _swap_rows(matrix: Floats, vector: Floats, k: int, i: int, where: bool) -> None:
    """Swap rows k and i where `where` is true."""
    for j in range(matrix.shape[0]):
        upper, lower = matrix[k, j], matrix[i, j]
        matrix[k, j], matrix[i, j] = select(where, lower, upper), select(where, upper, lower)
    upper, lower = vector[k], vector[i]
    vector[k], vector[i] = select(where, lower, upper), select(where, upper, lower)


@compiled
def solve_dense(matrix: Floats, vector: Floats) -> bool:
    """Gauss elimination with partial pivoting; `vector` becomes the solution.

    The matrix is destroyed. Returns False if it is singular.
    """
    n = matrix.shape[0]
    singular = False
    for k in range(n):
        # Bubbles the largest entry up instead of looking for it: lanes may need different rows.
        for i in range(k + 1, n):
            larger = abs(matrix[i, k]) > abs(matrix[k, k])
            if any_lane(larger):
                _swap_rows(matrix, vector, k, i, larger)
        singular = singular | (matrix[k, k] == 0.0)
        if all_lanes(singular):
            return no(singular)
        matrix[k, k] = 1.0 / matrix[k, k]
        for i in range(k + 1, n):
            ratio = matrix[i, k] * matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= ratio * matrix[k, j]
            vector[i] -= ratio * vector[k]
    for k in range(n - 1, -1, -1):
        value = vector[k]
        for j in range(k + 1, n):
            value -= matrix[k, j] * vector[j]
        vector[k] = value * matrix[k, k]
    return no(singular)


class Bearing(NamedTuple):
    """The records of the bearing of one line; views of the arrays of its kind."""

    work: Workspace  # the stiffness of the layers lasts from the first trial of a step to its end
    state: State
    trial: State


class Kind(NamedTuple):
    """The lines that have one bearing, where it is in each, and where a trial takes it.

    The arrays of the states have one axis more than those of one bearing, the first: [m] lines.
    """

    constants: Constants
    lines: Ints  # [m] their numbers in the structure
    durations: Floats  # [m] of the trial, on the bearing's own clock [s]
    states: Any  # State, [m]
    bearings: tuple[Bearing, ...]  # [m]


Bearings: TypeAlias = tuple[Kind, ...]


def split(work: Workspace, elastic: Floats, hysteretic: Floats, states: Any, trials: Any) -> Any:
    """Return the records of the bearing of each line from the arrays of all, [m].

    Scratch serves all of them, but each has stiffnesses of its own, of LayerWork [m, L].
    """
    return tuple(
        Bearing(
            work._replace(
                layers=work.layers._replace(elastic=elastic[m], hysteretic=hysteretic[m])
            ),
            State(*[array[m] for array in states]),
            State(*[array[m] for array in trials]),
        )
        for m in range(len(elastic))
    )


def side_by_side(parts: Sequence[Any]) -> Any:
    """Arrays, or records of arrays, with one more axis in front."""
    if isinstance(parts[0], tuple):
        return type(parts[0])(*(side_by_side(column) for column in zip(*parts, strict=True)))
    array = np.empty((len(parts), *parts[0].shape), parts[0].dtype)  # np.stack changes records
    for m, part in enumerate(parts):
        array[m] = part
    return array


def line_kinds(constants: Sequence[Constants]) -> list[list[int]]:
    """Numbers of the lines that are of one kind: their constants are the same object."""
    kinds: dict[int, list[int]] = {}
    for number, bearing_constants in enumerate(constants):
        kinds.setdefault(id(bearing_constants), []).append(number)
    return list(kinds.values())


def build_bearings(
    constants: Sequence[Constants],
    temperatures: Sequence[Floats],
    leads: Sequence[float | None],
    begun: Sequence[State | None] | None = None,
    components: int = 1,
) -> Bearings:
    """Bearings of all lines: where they were left, or virgin at temperatures of cells and lead."""
    kinds = []
    states = start_states(constants, temperatures, leads, begun, components)
    for numbers, start in zip(line_kinds(constants), states, strict=True):
        kind_constants = constants[numbers[0]]
        trials = State(*[array.copy() for array in start])
        elastic, hysteretic = np.zeros((2, len(numbers), len(kind_constants.multiplicity)))
        work = new_workspace(kind_constants, components)
        lines, durations = np.array(numbers), np.zeros(len(numbers))
        bearings = split(work, elastic, hysteretic, start, trials)
        kinds.append(Kind(kind_constants, lines, durations, start, bearings))
    return tuple(kinds)


def start_states(
    constants: Sequence[Constants],
    temperatures: Sequence[Floats],
    leads: Sequence[float | None],
    begun: Sequence[State | None] | None = None,
    components: int = 1,
) -> tuple[Any, ...]:
    """States of each kind, as `Kind` has them; arguments as of `build_bearings`."""
    starts = [
        new_state(bearing_constants, temperatures[b], leads[b], components)
        if begun_state is None
        else begun_state
        for b, (bearing_constants, begun_state) in enumerate(
            zip(constants, begun or [None] * len(constants), strict=True)
        )
    ]
    return tuple(side_by_side([starts[b] for b in numbers]) for numbers in line_kinds(constants))


def start_again(
    virgin: Bearings,
    constants: Sequence[Constants],
    temperatures: Sequence[Floats],
    leads: Sequence[float | None],
) -> tuple[Any, ...]:
    """States of each kind as those of `virgin` bearings, but at other temperatures.

    Same numbers as of `start_states`; arrays that no temperature changes are those of `virgin`, so
    that runs in lockstep share them.
    """
    states = []
    for kind in virgin:
        numbers, state = kind.lines.tolist(), kind.states
        cells = np.array([temperatures[b] for b in numbers], dtype=np.float64)
        branches, response = state.branches, state.response
        if constants[numbers[0]].lead.cores > 0.0:
            branches, response = branches.copy(), response.copy()
            lead = [[lead_at_start(constants[b], temperatures[b], leads[b])] for b in numbers]
            branches["lead_temperature"] = response["lead_temperature"] = lead
        states.append(state._replace(temperature=cells, branches=branches, response=response))
    return tuple(states)


SHORTEST = 1e-6  # s: step of a bearing that is on its own clock and does not move


@compiled
def along(rows: Vectors, row: int, points: Rows[Coordinate]) -> Vector:
    """Stretch or rotation of one connection at the trial coordinates."""
    total = zero(rows[row, 0])
    for i in range(rows.shape[1]):
        total = plus(total, scaled(rows[row, i], points[i].trial))
    return total


@compiled
def spread(rows: Vectors, row: int, force: Vector, stiffness: Matrix, motion: Motion) -> None:
    """Add the force and stiffness of one connection to those of the coordinates."""
    for i in range(rows.shape[1]):
        if any_lane(is_nonzero(rows[row, i])):
            motion.points[i].trial_restoring += dot(rows[row, i], force)
            for j in range(rows.shape[1]):
                motion.tangent[i, j] += between(rows[row, i], stiffness, rows[row, j])


@compiled
def _bearing_dt(line: LineFactors, dt: float, dx: Vector) -> float:
    """Return the time in which the bearing moves by dx [mm]: in the earthquake or its actuator."""
    # With its own clock the bearing takes as long as its actuator.
    quake = line.speed == 0.0
    if all_lanes(quake):
        return dt
    return select(quake, dt, max(norm(dx) / line.speed, SHORTEST))


@compiled
def set_stretches(system: System, motion: Motion) -> None:
    """Bearings follow the structure at once."""
    for b in range(len(system.lines)):
        motion.stretches[b] = along(system.line_rows, b, motion.points)


@compiled
def begin_bearings(system: System, bearings: Bearings) -> None:
    """Prepare the bearings once in a step, before `restoring`."""
    presses = len(system.sections.sections) > 0
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            bearing = kind.bearings[m]
            if presses and system.sections.number[kind.lines[m]] >= 0:
                number = system.sections.number[kind.lines[m]]
                begin_section(system, number, kind.constants, bearing.work, bearing.state)
            else:
                begin(kind.constants, bearing.work, bearing.state)


@compiled
def settle_bearings(system: System, bearings: Bearings, ambient: float) -> int:
    """Heat and energies of the bearings' last trials, once they are accepted.

    A line may be in warmer air than `ambient` [degC].
    Returns an outcome of the coupled step.
    """
    outcome = COMPLETED
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            bearing, dt = kind.bearings[m], kind.durations[m]
            air = ambient + system.lines[kind.lines[m]].warmer
            ended = settle(kind.constants, bearing.work, bearing.state, dt, air, bearing.trial)
            outcome = select(outcome == COMPLETED, ended, outcome)
            if all_lanes(outcome != COMPLETED):
                return outcome
    return outcome


@compiled
def _move_bearings(
    system: System, bearings: Bearings, motion: Motion, dt: float, noise: Vector
) -> int:
    """Forces of the bearing lines at `motion.stretches`, and their tangent, added."""
    outcome = COMPLETED
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            bearing, b = kind.bearings[m], kind.lines[m]
            line, state = system.lines[b], bearing.state
            # A specimen at a scale, which may begin where an earlier test left it.
            x = plus(line.start, scaled(motion.stretches[b], line.length_factor))
            bearing_dt = _bearing_dt(line, dt, minus(x, state.response[0].displacement))
            kind.durations[m] = bearing_dt
            force, slope, move_outcome = move(
                kind.constants, bearing.work, state, x, bearing_dt, bearing.trial
            )
            fails_first = (outcome == COMPLETED) & has_failed(move_outcome)
            outcome = select(fails_first, move_outcome, outcome)
            if all_lanes(outcome != COMPLETED):
                return outcome
            slope = scaled(slope, line.force_factor * line.length_factor)
            # The structure is in balance with the force at rest, so it feels the difference.
            line_force = scaled(plus(minus(force, line.at_rest), noise), line.force_factor)
            if any_lane(line.reduction_x != 0.0):
                stretch = motion.stretches[b]
                reduction = components(stretch, line.reduction_x, line.reduction_y)
                line_force = minus(line_force, each_times(reduction, stretch))
                slope = plus(slope, diagonal(stretch, -line.reduction_x, -line.reduction_y))
                line.tangent = lowest(slope)
            spread(system.line_rows, b, line_force, slope, motion)
    return outcome


@compiled
def begin_devices(system: System, motion: Motion, ambient: float) -> None:
    """Prepare the devices once in a step, before `move_devices`; `ambient` is in degC."""
    devices = system.devices
    for d in range(len(devices.devices)):
        old, new = motion.devices[d], motion.trial_devices[d]
        new.stretch = old.stretch
        new.force = zero(old.force)  # of no iteration yet
        oil = ambient + devices.devices[d].warmer + old.heated
        new.factor = oil_factor(devices, d, oil)


@compiled_apart
def move_devices(system: System, motion: Motion, by_v: float) -> None:
    """Forces of the devices at the trial motion, and their tangent, added to those of `restoring`.

    The trial velocities change by `by_v` with the trial coordinates [1/s].
    """
    points, devices = motion.points, system.devices
    for d in range(len(devices.devices)):
        device, old, new = devices.devices[d], motion.devices[d], motion.trial_devices[d]
        stretch = along(devices.rows, d, points)
        velocity = zero(stretch)
        for i in range(devices.rows.shape[1]):
            velocity = plus(velocity, scaled(devices.rows[d, i], points[i].predicted_v))
        force, by_all, by_force = device_force(device, old, new.factor, stretch, velocity, by_v)
        heading = direction(force)
        slope = plus(isotropic(force, by_all), scaled(outer(heading, heading), by_force))
        # The forces of dampers and sliders are steep where they turn round, and flat beyond:
        # tangents of the flat parts would go to and fro, a chord between them does not.
        turns = dot(force, new.force) < 0.0
        if device.kind != GAP and any_lane(turns):
            moved = norm(minus(stretch, new.stretch))
            chord = norm(minus(force, new.force)) / select(moved > 0.0, moved, 1.0)
            slope = pick(turns, plus(isotropic(force, chord), scaled(slope, 0.0)), slope)
        new.stretch, new.velocity, new.force = stretch, velocity, force
        spread(devices.rows, d, force, slope, motion)


@compiled
def restoring(system: System, bearings: Bearings, motion: Motion, dt: float, noise: Vector) -> int:
    """Restoring forces at the trial coordinates, and their tangent; after `begin_bearings`.

    The bearing lines are at the stretches `motion.stretches`, which an actuator may delay.
    Starts from the committed states and hinges, writes their trials. `noise` is added to the
    force of every modelled bearing [kN]. Returns an outcome of the coupled step.
    """
    points, n = motion.points, motion.tangent.shape[0]
    for i in range(n):
        force = 0.0  # not in the record: eight times as fast with many coordinates
        for j in range(n):
            motion.tangent[i, j] = system.stiffness[i, j]
            force += system.stiffness[i, j] * points[j].trial
        points[i].trial_restoring = force
    for h in range(len(system.hinges)):
        rotation = along(system.hinge_rows, h, motion.points)
        slope = takeda(system.hinges, motion.hinges, h, rotation, motion.trial_hinges)
        spread(system.hinge_rows, h, motion.trial_hinges.bends[h].moment, slope, motion)
    return _move_bearings(system, bearings, motion, dt, noise)


@compiled
def add_energies(system: System, motion: Motion, before: Vector, after: Vector) -> None:
    """Work of one step to the trial, trapezoidal.

    `before` and `after` are ground accelerations [mm/s2]. The work of the bearings comes from
    their own energies, see `commit`.
    """
    energies, points, n = motion.energies[0], motion.points, motion.tangent.shape[0]
    input_work = 0.0
    damping_work = 0.0
    kinetic = 0.0
    stored = 0.0
    for i in range(n):
        dq = points[i].trial - points[i].q
        input_work += dot(scaled(plus(before, after), 0.5), system.load[i]) * dq
        for j in range(n):
            mean = 0.5 * (points[j].v + points[j].predicted_v)
            damping_work += dq * system.damping[i, j] * mean
            kinetic += 0.5 * points[i].predicted_v * system.mass[i, j] * points[j].predicted_v
            stored += 0.5 * points[i].trial * system.stiffness[i, j] * points[j].trial
    hinge_work = 0.0
    for h in range(len(system.hinges)):
        old, new = motion.hinges.bends[h], motion.trial_hinges.bends[h]
        rotation = new.rotation - old.rotation
        hinge_work += 0.5 * (new.moment + old.moment) * rotation
    energies.input += input_work
    energies.damping += damping_work
    energies.hinges += hinge_work
    energies.kinetic = kinetic
    energies.springs = stored


@compiled
def commit(system: System, bearings: Bearings, motion: Motion, dt: float) -> None:
    """The trial becomes the state."""
    energies, points = motion.energies[0], motion.points
    energies.bearings = 0.0
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
            state, line = kind.bearings[m].state, system.lines[kind.lines[m]]
            copy_state(kind.bearings[m].trial, state)
            # The structure does not feel the work of the force at rest, nor the scale of the
            # specimen.
            work = state.response[0].work_in - dot(
                line.at_rest, minus(state.response[0].displacement, line.start)
            )
            energies.bearings += line.force_factor / line.length_factor * work
    if len(system.sections.sections) > 0:
        energies.bearings -= lend(system, motion)
    if len(system.devices.devices) > 0:
        commit_devices(system, motion)
    energies.clock += dt


@compiled_apart
def commit_devices(system: System, motion: Motion) -> None:
    """The trial of the devices becomes their state, with its work and peaks."""
    energies = motion.energies[0]
    for d in range(len(system.devices.devices)):
        device, old, new = system.devices.devices[d], motion.devices[d], motion.trial_devices[d]
        mean = scaled(plus(old.force, new.force), 0.5)
        work = dot(mean, minus(new.stretch, old.stretch))
        new.work = old.work + work
        new.stored = stored_energy(device, new.stretch, new.force)
        new.heated = old.heated
        if device.kind == DAMPER:
            energies.dampers += work
            if any_lane(device.heat_capacity > 0.0):
                warms = device.heat_capacity > 0.0
                capacity = select(warms, device.heat_capacity, 1.0)
                new.heated = select(warms, old.heated + work / capacity, old.heated)
        elif device.kind == SLIDER:
            energies.sliders += work
        else:
            energies.gaps += work
        motion.devices[d] = motion.trial_devices[d]
        peak = motion.device_peaks[d]
        peak.stroke = farther(peak.stroke, new.stretch)
        peak.velocity = farther(peak.velocity, new.velocity)
        peak.force = farther(peak.force, new.force)


@compiled
def press_sections(
    system: System, bearings: Bearings, motion: Motion, ground: float, dt: float
) -> None:
    """Find the axial forces at the end of a step that is committed; `ground` is upwards [mm/s2]."""
    for k in range(len(bearings)):
        kind = bearings[k]
        for m in range(len(kind.lines)):
            b = kind.lines[m]
            number = system.sections.number[b]
            if number >= 0:
                force = scaled(kind.states.response[m, 0].force, system.lines[b].force_factor)
                shear = along_x(force), across(force)
                press_line(system, motion, number, shear[0], shear[1], ground, dt)


@compiled
def less_axial(system: System, b: int, stretch: Vector, force: Vector) -> Vector:
    """Return the force of the modelled bearing of a line, less what axial forces take from it."""
    line = system.lines[b]
    reduction = components(stretch, line.reduction_x, line.reduction_y)
    return minus(force, scaled(each_times(reduction, stretch), 1.0 / line.force_factor))


@compiled
def keep_sections(system: System, motion: Motion, rows: MotionRows, row: int) -> None:
    """Write the axial forces into one row, after `keep_motion`, and what they take from forces."""
    keep_section(system, 1 + row, motion)  # after the start
    for a in range(len(system.sections.sections)):
        b = system.sections.sections[a].line
        response = rows.bearings[row, b]
        response.force = less_axial(system, b, motion.stretches[b], response.force)


@compiled
def keep_motion(bearings: Bearings, motion: Motion, rows: MotionRows, row: int) -> None:
    """Write the state of the structure, its hinges and its bearings into one row."""
    rows.energies[row] = motion.energies[0]
    for i in range(motion.tangent.shape[0]):
        rows.q[row, i] = motion.points[i].q
        rows.v[row, i] = motion.points[i].v
        rows.a[row, i] = motion.points[i].a
    for h in range(len(motion.hinges.bends)):
        rows.hinges[row, h] = motion.hinges.bends[h]
    for d in range(len(motion.devices)):
        rows.devices[row, d] = motion.devices[d]
    for k in range(len(bearings)):
        kind, layers, profiles = bearings[k], rows.layers[k], rows.cells[k]
        cells = kind.constants.layer_cells
        for m in range(len(kind.lines)):
            rows.bearings[row, kind.lines[m]] = kind.states.response[m, 0]
            temperature, kept = kind.states.temperature[m], layers[row, m]
            for j in range(len(cells)):
                kept[j] = layer_temperature(cells, temperature, j)
            for i in range(profiles.shape[2]):
                profiles[row, m, i] = temperature[i]
