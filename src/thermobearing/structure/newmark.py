"""Newmark's method with Newton iterations on the coupled bearings, and its energy balance.

With beta = 1/4 and gamma = 1/2 (constant mean acceleration) the energy balance closes to the
tolerance of the iterations: every work is the trapezoidal sum of the forces at the ends of the
steps, and for those the scheme is exact. With beta = 1/6 (linear acceleration, as in Shen (2023))
it does not.

Runs in lockstep (core/lanes) do not halve their steps: a run without equilibrium in a full step
leaves the lockstep. It is filled with NaN, which ends every iteration at once, and its outcome
says that it must be run alone.
"""

import math

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.choose import all_lanes, any_lane, select
from thermobearing.core.lanes.memory import WIDTH, as_lanes
from thermobearing.core.records import Floats
from thermobearing.core.step import layer_temperature
from thermobearing.core.types import COMPLETED, LEAD_MELTED, TEMPERATURE_RUNAWAY
from thermobearing.core.vector import (
    Peak,
    Vector,
    as_plane,
    dot,
    each_times,
    farther,
    minus,
    no_peak,
    plus,
    scaled,
    zero,
)
from thermobearing.structure.forces import (
    Bearings,
    add_energies,
    begin_bearings,
    begin_devices,
    commit,
    keep_motion,
    keep_sections,
    less_axial,
    move_devices,
    press_sections,
    restoring,
    set_stretches,
    settle_bearings,
    solve_dense,
)
from thermobearing.structure.types import (
    DIVERGED,
    FARTHEST,
    NO_EQUILIBRIUM,
    Motion,
    MotionRows,
    Peaks,
    Scheme,
    Shaking,
    System,
)


@compiled
def _note_watches(motion: Motion, ground: Vector, peaks: Peaks) -> None:
    """Update the displacements and accelerations; `ground` is that of the ground [mm/s2]."""
    for p in range(len(peaks.watches)):
        watch = peaks.watches[p]
        displacement, acceleration = zero(ground), scaled(ground, peaks.carried[p])
        for i in range(motion.tangent.shape[0]):
            displacement = plus(displacement, scaled(peaks.places[p, i], motion.points[i].q))
            acceleration = plus(acceleration, scaled(peaks.places[p, i], motion.points[i].a))
        watch.displacement = farther(watch.displacement, displacement)
        watch.residual = displacement
        watch.acceleration = farther(watch.acceleration, acceleration)


@compiled
def _note_lines(system: System, bearings: Bearings, motion: Motion, peaks: Peaks) -> None:
    """Update the peaks of every bearing line."""
    for k in range(len(bearings)):
        kind = bearings[k]
        cells = kind.constants.layer_cells
        for m in range(len(kind.lines)):
            peak, response = peaks.lines[kind.lines[m]], kind.states.response[m, 0]
            peak.displacement = farther(peak.displacement, response.displacement)
            force = response.force
            if len(system.sections.sections) > 0:
                b = kind.lines[m]
                force = less_axial(system, b, motion.stretches[b], force)
            peak.force = farther(peak.force, force)
            peak.mismatch = max(peak.mismatch, response.layer_force_mismatch)
            lead = kind.states.branches[m, 0].lead_temperature
            peak.lead_temperature = max(peak.lead_temperature, lead)
            peak.coldest_lead = min(peak.coldest_lead, lead)
            # The clock of a bearing stands still until it moves.
            elapsed = response.clock - peak.clock
            per_time = select(elapsed > 0.0, 1.0 / max(elapsed, TINY), 0.0)
            moved = minus(response.displacement, peak.last_displacement)
            peak.speed = farther(peak.speed, scaled(moved, per_time))
            peak.last_displacement, peak.clock = response.displacement, response.clock
            temperature = kind.states.temperature[m]
            for j in range(len(cells)):
                warm = layer_temperature(cells, temperature, j)
                peak.rubber_temperature = max(peak.rubber_temperature, warm)


@compiled
def _note_peaks(
    system: System, bearings: Bearings, motion: Motion, ground: Vector, peaks: Peaks
) -> None:
    """Update the peaks of the structure, the hinges and the bearings."""
    _note_watches(motion, ground, peaks)
    if len(peaks.lines) > 0:
        _note_lines(system, bearings, motion, peaks)
    for h in range(len(peaks.hinges)):
        peak, bend = peaks.hinges[h], motion.hinges.bends[h]
        peak.rotation = max(peak.rotation, abs(bend.rotation))
        peak.moment = max(peak.moment, abs(bend.moment))


TINY = 1e-300  # in place of zero in a divisor
ROUNDING = 2.0**-52  # of a coordinate, as a share of it
MOST_ITERATIONS, GRACE = 100, 1000  # a step on average, after so many steps; usual are 3


@compiled
def start_motion(system: System, motion: Motion, ground: Vector) -> bool:
    """Set the acceleration at rest under the first ground acceleration."""
    points, n = motion.points, motion.tangent.shape[0]
    for i in range(n):
        motion.unknowns[i] = dot(system.load[i], ground)
        for j in range(n):
            motion.matrix[i, j] = system.mass[i, j]
    solved = solve_dense(motion.matrix, motion.unknowns)
    for i in range(n):
        points[i].a = motion.unknowns[i]
    return solved


@compiled
def rate_factors(scheme: Scheme, dt: float) -> tuple[float, float, float]:
    """What a change of displacement over dt [s] adds to acceleration and velocity; see `residual`.

    The last is what the acceleration of the start takes from that of the end.
    """
    per_beta = 1.0 / scheme.beta
    per_dt = 1.0 / dt
    by_v = per_beta * per_dt
    return by_v * per_dt, scheme.gamma * by_v, 0.5 * per_beta - 1.0


@compiled
def residual(
    system: System,
    motion: Motion,
    scheme: Scheme,
    factors: tuple[float, float, float],
    dt: float,
    ground: Vector,
    scale: Peak,
) -> bool:
    """Compute the unbalanced forces at the trial coordinates, and the effective tangent.

    Each force is weighted with its own effective stiffness, since rotations and displacements
    have different units. Returns whether the residual is within the tolerance, relative to the
    inertial forces of an acceleration `scale`, or within what rounding the coordinates makes of
    it: the inertial force divides them by dt^2, so that no coordinate meets the tolerance in
    steps below about 1e-4 s. `factors` are those of `rate_factors`.
    """
    points, unknowns, n = motion.points, motion.unknowns, motion.tangent.shape[0]
    # a = (dq - dt v_0)/(beta dt^2) - (1/(2 beta) - 1) a_0, and v from gamma.
    by_a, by_v, by_start = factors
    for i in range(n):
        change = points[i].trial - points[i].q
        a = by_a * (change - dt * points[i].v) - by_start * points[i].a
        points[i].predicted_a = a
        points[i].predicted_v = points[i].v + dt * (
            (1.0 - scheme.gamma) * points[i].a + scheme.gamma * a
        )
    if len(system.devices.devices) > 0:
        move_devices(system, motion, by_v)
    weighted_square, limit, rounding = 0.0, 0.0, 0.0
    for i in range(n):
        r = dot(system.load[i], ground) - points[i].trial_restoring
        for j in range(n):
            r -= system.mass[i, j] * points[j].predicted_a
            r -= system.damping[i, j] * points[j].predicted_v
            motion.matrix[i, j] = (
                motion.tangent[i, j] + by_a * system.mass[i, j] + by_v * system.damping[i, j]
            )
        unknowns[i] = r
        force = each_times(scaled(system.load[i], scheme.tolerance), scale)
        stiffness = abs(motion.matrix[i, i])
        flexibility = 1.0 / stiffness
        weighted_square += r * r * flexibility
        limit += dot(force, force) * flexibility
        rounded = ROUNDING * points[i].trial
        rounding += rounded * rounded * stiffness
    return weighted_square <= max(limit, rounding)


@compiled
def leave(motion: Motion, failed: bool) -> None:
    """Fill the runs that failed in lockstep with NaN."""
    for i in range(motion.tangent.shape[0]):
        motion.points[i].q = select(failed, math.nan, motion.points[i].q)


@compiled
def _newmark_step(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    dt: float,
    ground: Vector,
    ambient: float,
    scale: Peak,
) -> int:
    """Take one step of dt to the ground acceleration `ground`, without committing it.

    `scale` is the largest ground acceleration of the motion, which makes the tolerance relative.
    """
    points, unknowns, n = motion.points, motion.unknowns, motion.tangent.shape[0]
    for i in range(n):
        points[i].trial = points[i].q + dt * points[i].v + 0.5 * dt * dt * points[i].a
    begin_bearings(system, bearings)
    if len(system.devices.devices) > 0:
        begin_devices(system, motion, ambient)
    # The prediction has the acceleration of the start.
    factors = rate_factors(scheme, dt)
    outcome, converged = COMPLETED, False
    for _ in range(scheme.iterations):
        set_stretches(system, motion)
        trial_outcome = restoring(system, bearings, motion, dt, zero(ground))
        outcome = select(outcome == COMPLETED, trial_outcome, outcome)
        failed = outcome != COMPLETED
        if all_lanes(failed):
            return outcome
        motion.energies[0].iterations += select(converged | failed, 0.0, 1.0)
        # A run of a lockstep that failed counts as converged: the others decide when to stop.
        converged = failed | residual(system, motion, scheme, factors, dt, ground, scale)
        if all_lanes(converged):
            ended = settle_bearings(system, bearings, ambient)
            return select(failed, outcome, ended)
        solved = solve_dense(motion.matrix, unknowns)
        inside = True
        for i in range(n):
            points[i].trial = select(converged, points[i].trial, points[i].trial + unknowns[i])
            inside = inside & (abs(points[i].trial) < FARTHEST)
        outcome = select(converged | inside, outcome, DIVERGED)
        outcome = select(converged | solved, outcome, NO_EQUILIBRIUM)
        if all_lanes(outcome != COMPLETED):
            return outcome
    if not any_lane(converged):
        return select(outcome == COMPLETED, NO_EQUILIBRIUM, outcome)
    ended = settle_bearings(system, bearings, ambient)
    ended = select(converged, ended, NO_EQUILIBRIUM)
    return select(outcome == COMPLETED, ended, outcome)


@compiled
def _upwards(system: System, k: int, share: float) -> float:
    """Vertical ground acceleration at a share of step k [mm/s2]; zero without a record."""
    vertical = system.sections.vertical
    if len(vertical) == 0:
        return 0.0
    acceleration: float = vertical[k] + share * (vertical[k + 1] - vertical[k])
    return acceleration


@compiled
def newmark_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
) -> tuple[int, int, int]:
    """March through the ground acceleration.

    A step without equilibrium is cut in half, again and again up to `scheme.halvings` times;
    the ground acceleration is linear between its samples. If one of these attempts finds its
    equilibrium and then an overheated bearing, the run ends with that outcome, whatever smaller
    steps give.

    Returns
    -------
    steps done, rows written, outcome. `motion` and `bearings` hold the last good state.
    """
    ground = shaking.ground
    # Relative to the largest ground acceleration, since a quiet sample has no force to compare
    # with.
    scale = no_peak(ground[0])
    for k in range(len(ground)):
        scale = farther(scale, ground[k])
    outcome, failure = COMPLETED, COMPLETED
    presses = len(system.sections.sections) > 0
    kept = 0
    for k in range(len(ground) - 1):
        elapsed = 0  # of the step, in units of its smallest part
        overheated = COMPLETED
        parts = 1 << scheme.halvings
        part = parts
        while elapsed < parts:
            share = (elapsed + part) / parts
            change = minus(ground[k + 1], ground[k])
            target = plus(ground[k], scaled(change, share))
            sub = shaking.dt * part / parts
            air = shaking.ambient[k]
            outcome = _newmark_step(system, bearings, motion, scheme, sub, target, air, scale)
            failed = outcome != COMPLETED
            if not all_lanes(failed | (failure != COMPLETED)):
                before = plus(ground[k], scaled(change, elapsed / parts))
                add_energies(system, motion, before, target)
                commit(system, bearings, motion, sub)
                if presses:
                    upwards = _upwards(system, k, share)
                    press_sections(system, bearings, motion, upwards, sub)
                failure = select(failure == COMPLETED, outcome, failure)
                if any_lane(failed):
                    leave(motion, failed)
                elapsed += part
                continue
            hot = (outcome == TEMPERATURE_RUNAWAY) | (outcome == LEAD_MELTED)
            overheated = select(hot, outcome, overheated)
            if part == 1:
                outcome = select(failure == COMPLETED, outcome, failure)
                return k, kept, select(overheated == COMPLETED, outcome, overheated)
            # Bounds the effort of a run, which halving alone does not.
            if all_lanes(motion.energies[0].iterations > MOST_ITERATIONS * (k + GRACE)):
                return k, kept, select(overheated == COMPLETED, NO_EQUILIBRIUM, overheated)
            part //= 2
            motion.energies[0].substeps += 1.0
        _note_peaks(system, bearings, motion, ground[k + 1], peaks)
        if shaking.keep[k]:
            keep_motion(bearings, motion, rows, kept)
            if presses:
                keep_sections(system, motion, rows, kept)
            kept += 1
    return len(ground) - 1, kept, failure


@compiled
def peaks_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
) -> tuple[int, int, int]:
    """March from rest through the ground acceleration, as `newmark_march`."""
    start_motion(system, motion, shaking.ground[0])
    _note_peaks(system, bearings, motion, shaking.ground[0], peaks)
    return newmark_march(system, bearings, motion, scheme, shaking, rows, peaks)


@compiled
def plane_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
) -> tuple[int, int, int]:
    """`peaks_march` of a structure in plan, in two horizontal directions."""
    return peaks_march(
        as_plane(system),
        as_plane(bearings),
        as_plane(motion),
        scheme,
        as_plane(shaking),
        as_plane(rows),
        as_plane(peaks),
    )


@compiled
def lanes_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
    outcomes: Floats,
) -> int:
    """`peaks_march` of WIDTH runs; all but `scheme` come from `side_by_side`.

    Full steps only (`scheme.halvings` is 0): a run that needs smaller ones ends early, which its
    entry of `outcomes` [1, WIDTH] says, and is to be run alone. Returns the steps done.
    """
    steps, _, outcome = peaks_march(
        as_lanes(system, WIDTH),
        as_lanes(bearings, WIDTH),
        as_lanes(motion, WIDTH),
        scheme,
        as_lanes(shaking, WIDTH),
        as_lanes(rows, WIDTH),
        as_lanes(peaks, WIDTH),
    )
    ended = as_lanes(outcomes, WIDTH)
    ended[0] = outcome
    return steps


@compiled
def plane_lanes_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
    outcomes: Floats,
) -> int:
    """`lanes_march` of structures in plan."""
    steps, _, outcome = plane_march(
        as_lanes(system, WIDTH),
        as_lanes(bearings, WIDTH),
        as_lanes(motion, WIDTH),
        scheme,
        as_lanes(shaking, WIDTH),
        as_lanes(rows, WIDTH),
        as_lanes(peaks, WIDTH),
    )
    ended = as_lanes(outcomes, WIDTH)
    ended[0] = outcome
    return steps
