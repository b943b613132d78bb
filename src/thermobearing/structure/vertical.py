"""Axial forces of the bearings of a line: equilibrium of a rigid section of the deck, and peaks.

The section rests on bearings at places y_i, with shortenings v + theta y_i:

    sum P_i + m (w'' - a) + c w' = W,     sum P_i y_i + J theta'' = F H + 1/2 sum P_i x

(dead load W, vertical ground acceleration a upwards, shear F of the line at the height H of its
inertia, sway x; y_i from their centre). The mass sinks by w = v on a rigid deck; the spans of a
flexible one carry W + k (w - v), and w is eliminated. It is solved after each horizontal step; what
the axial forces take from the shear (`reduction`) is that of the start of the next one, so that it
is a constant of the horizontal equations.
"""

from thermobearing.core.axial import (
    Column,
    buckling_load,
    cavitated_strength,
    compliance,
    counted_overlap,
    stiffness_reduction,
    tension,
    vertical_stiffness,
)
from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.records import Rows
from thermobearing.core.step import begin, set_stiffness
from thermobearing.core.types import Constants, State, Workspace
from thermobearing.core.vector import across, along_x
from thermobearing.structure.types import LineFactors, Motion, Section, Support, System

MOST_ITERATIONS, MOST_HALVINGS = 60, 40
TOLERANCE = 1e-11  # of the unbalanced force, over the dead load
FLOATING = 1e-12  # stiffness of a section that has left all bearings, over that in compression
ENOUGH = 0.5  # slope along a correction, over that at its start, which ends its halving


@compiled
def begin_section(
    system: System, a: int, constants: Constants, work: Workspace, state: State
) -> None:
    """`begin` of the bearing of a line, and what axial forces take from its shear in the step."""
    sections = system.sections
    section, column = sections.sections[a], sections.columns[a]
    line = system.lines[section.line]
    rubber = constants.rubber
    if rubber.virgin:
        # Moduli under an axial force are those of scragged rubber.
        set_stiffness(rubber, constants.law, constants.layer_cells, state.temperature, work.layers)
    else:
        begin(constants, work, state)
    layers = work.layers
    c, g, softest = compliance(column, constants.multiplicity, layers.elastic, layers.hysteretic)
    if rubber.virgin:
        begin(constants, work, state)
    section.compression, section.shear, section.softest = c, g, softest
    section.x, section.y = (
        along_x(state.response[0].displacement),
        across(state.response[0].displacement),
    )
    set_law(section, column)
    overlap = 1.0
    if column.by_overlap == 1:
        overlap = find_overlap(section, column, section.x, section.y)
    set_reduction(section, column, line, sections.supports, overlap)


@compiled
def set_reduction(
    section: Section, column: Column, line: LineFactors, supports: Rows[Support], overlap: float
) -> None:
    """Set kappa of a line, the sum over its bearings [kN/mm]."""
    total_x, total_y = 0.0, 0.0
    for i in range(section.first, section.last):
        # A specimen at a scale carries its share of the axial force.
        force = section.scale * section.scale * supports[i].axial_force
        kappa_x, kappa_y = stiffness_reduction(column, section.compression, force, overlap)
        total_x += kappa_x
        total_y += kappa_y
    line.reduction_x, line.reduction_y = total_x / section.scale, total_y / section.scale


@compiled
def set_law(section: Section, column: Column) -> None:
    """Set what a bearing has under axial forces in a step, by the sums over its layers."""
    # The law of the modelled bearing, whose lengths are `scale` of those of the structure.
    s, compression = section.scale, section.compression
    section.stiffness = vertical_stiffness(column, compression, section.x, section.y) / s
    section.strength = column.cavitation * section.softest * column.area / (s * s)
    section.buckling = buckling_load(column, compression, section.shear) / (s * s)


@compiled
def find_overlap(section: Section, column: Column, x: float, y: float) -> float:
    """Overlap that the critical load counts, at a displacement of the modelled bearing [mm]."""
    # The end of a step is the start of the next one, and an overlap takes two roots and an arc.
    if any_lane((section.overlap_x != x) | (section.overlap_y != y)):
        section.overlap = counted_overlap(column, x, y)
        section.overlap_x, section.overlap_y = x, y
    return section.overlap


@compiled
def bearing_force(
    column: Column, section: Section, shortening: float, memory: float
) -> tuple[float, float]:
    """Axial force [kN] and tangent [kN/mm] of a bearing of a section.

    Stiffness and strength have the displacement and the temperatures of the start of the step.
    """
    stiffness = section.stiffness
    if section.dowelled == 1:
        lifted = shortening < 0.0
        return select(lifted, 0.0, stiffness * shortening), select(lifted, 0.0, stiffness)
    # Of the modelled bearing, as in `set_law`.
    s, strength = section.scale, section.strength
    pulled, slope = tension(column, -s * shortening, s * stiffness, s * s * strength, memory)
    return -pulled / (s * s), slope / s


@compiled
def section_forces(
    column: Column, section: Section, supports: Rows[Support], shortening: float, roll: float
) -> tuple[float, float, float, float, float]:
    """Sum of axial forces, their moment, and the tangent (three numbers) of a section."""
    force, moment, by_v, by_both, by_roll = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(section.first, section.last):
        place = supports[i].place
        pressed, tangent = bearing_force(
            column, section, supports[i].offset + shortening + roll * place, supports[i].memory
        )
        force += pressed
        moment += pressed * place
        by_v += tangent
        by_both += tangent * place
        by_roll += tangent * place * place
    return force, moment, by_v, by_both, by_roll


@compiled
def solve_section(
    column: Column,
    section: Section,
    supports: Rows[Support],
    load: float,
    moment: float,
    inertia: float,
    roll_inertia: float,
) -> tuple[float, float, float, bool]:
    """Solve sum P_i + `inertia` v = `load`, sum P_i y_i + `roll_inertia` theta = `moment`.

    Returns the shortening [mm], the roll [rad], the iterations, and whether it was found. Bearings
    that are all in compression are linear. Otherwise the potential is convex, and a correction that
    passes its minimum along the line is halved.
    """
    count, span, stiffness = section.last - section.first, section.span, section.stiffness
    rolls = span > 0.0
    divisor = select(rolls, stiffness * span + roll_inertia, 1.0)
    v = (load - stiffness * section.offset) / (stiffness * count + inertia)
    roll = select(rolls, (moment - stiffness * section.offset_moment) / divisor, 0.0)
    least = v * 0.0
    for i in range(section.first, section.last):
        least = min(least, supports[i].offset + v + roll * supports[i].place)
    balanced, iterations = least >= 0.0, 0.0
    if all_lanes(balanced):
        return v, roll, iterations, balanced
    v = select(balanced, v, section.shortening)
    roll = select(balanced, roll, section.roll)
    floor = FLOATING * stiffness
    p, m, k, kr, krr = section_forces(column, section, supports, v, roll)
    force, turn = p + inertia * v - load, m + roll_inertia * roll - moment
    arm = (span / count) ** 0.5
    limit = TOLERANCE * (section.weight + abs(moment) / select(arm > 0.0, arm, 1.0))
    balanced = balanced | ((abs(force) <= limit) & (abs(turn) <= limit * max(arm, 1.0)))
    for _ in range(MOST_ITERATIONS):
        if all_lanes(balanced):
            break
        iterations += select(balanced, 0.0, 1.0)
        a11, a12 = k + inertia + floor * count, kr
        a22 = krr + roll_inertia + floor * span
        a22 = select(rolls, a22, 1.0)
        determinant = a11 * a22 - a12 * a12
        dv = -(a22 * force - a12 * turn) / determinant
        droll = select(rolls, -(a11 * turn - a12 * force) / determinant, 0.0)
        slope = force * dv + turn * droll
        part, settled = 1.0, balanced
        for _ in range(MOST_HALVINGS):
            next_v = v + part * dv
            next_roll = roll + part * droll
            p, m, k, kr, krr = section_forces(column, section, supports, next_v, next_roll)
            force = p + inertia * next_v - load
            turn = m + roll_inertia * next_roll - moment
            settled = settled | (force * dv + turn * droll <= -ENOUGH * slope)
            if all_lanes(settled):
                break
            part = select(settled, part, 0.5 * part)
        v = select(balanced, v, v + part * dv)
        roll = select(balanced, roll, roll + part * droll)
        balanced = balanced | ((abs(force) <= limit) & (abs(turn) <= limit * max(arm, 1.0)))
    return v, roll, iterations, balanced


@compiled
def commit_section(system: System, a: int, moment: float, ground: float, dt: float) -> bool:
    """Move a section to the equilibrium at the end of a step; returns whether there is one."""
    sections = system.sections
    section, column, energies = sections.sections[a], sections.columns[a], sections.energies[a]
    supports = sections.supports
    by_a, by_v = 4.0 / (dt * dt), 2.0 / dt
    # m w'' + c w' of the end is `inertia` w less what the start of the step gives.
    inertia = section.mass * by_a + section.damping * by_v
    start_a = by_a * (section.sunk + dt * section.velocity) + section.acceleration
    start_v = by_v * section.sunk + section.velocity
    moved_by = section.mass * (ground + start_a) + section.damping * start_v
    # Spans in series with the mass: of its motion the line feels a share.
    spring = section.span_stiffness
    flexible = spring > 0.0
    softened = select(flexible, inertia + spring, 1.0)
    share = select(flexible, spring / softened, 1.0)
    turned = by_a * (section.roll + dt * section.roll_velocity) + section.roll_acceleration
    v, roll, iterations, balanced = solve_section(
        column,
        section,
        supports,
        section.weight + share * moved_by,
        moment + section.roll_inertia * turned,
        share * inertia,
        section.roll_inertia * by_a,
    )
    sunk = select(flexible, (moved_by + spring * v) / softened, v)
    dv, fall, droll = v - section.shortening, sunk - section.sunk, roll - section.roll
    mean_ground = 0.5 * (ground + section.ground)
    energies.weight += section.weight * dv
    energies.overturning += 0.5 * (moment + section.moment) * droll
    energies.vertical_input += section.mass * mean_ground * fall
    velocity = by_v * fall - section.velocity
    acceleration = by_a * (fall - dt * section.velocity) - section.acceleration
    roll_velocity = by_v * droll - section.roll_velocity
    section.roll_acceleration = (
        by_a * (droll - dt * section.roll_velocity) - section.roll_acceleration
    )
    energies.vertical_damping += section.damping * 0.5 * (velocity + section.velocity) * fall
    energies.vertical_kinetic = 0.5 * section.mass * velocity * velocity
    energies.vertical_kinetic += 0.5 * section.roll_inertia * roll_velocity * roll_velocity
    energies.span_stored = 0.5 * spring * (sunk - v) * (sunk - v)
    energies.iterations += iterations
    relative = section.stiffness / section.strength  # of cavitation
    for i in range(section.first, section.last):
        support = supports[i]
        shortening = support.offset + v + roll * support.place
        force, _ = bearing_force(column, section, shortening, support.memory)
        moved = shortening - support.shortening
        energies.axial_work += 0.5 * (force + support.axial_force) * moved
        support.axial_force, support.shortening = force, shortening
        support.memory = max(support.memory, -shortening * relative)
    section.shortening, section.roll, section.sunk = v, roll, sunk
    section.velocity, section.acceleration = velocity, acceleration
    section.roll_velocity = roll_velocity
    section.moment, section.ground = moment, ground
    return balanced


@compiled
def note_section(system: System, a: int, x: float, y: float, dt: float, falling: bool) -> None:
    """Update the peaks of a section at the end of a step; x, y of the modelled bearing [mm]."""
    sections = system.sections
    section, column, peak = sections.sections[a], sections.columns[a], sections.peaks[a]
    limit, strength = critical_load_at(section, column, x, y), section.strength
    per_limit, per_strength = 1.0 / limit, 1.0 / strength
    relative = section.stiffness * per_strength
    line_force, any_above = 0.0, limit < 0.0
    for i in range(section.first, section.last):
        support = sections.supports[i]
        force = support.axial_force
        number = float(i - section.first)
        line_force += force
        share = force * per_limit
        any_above = any_above | (share > 1.0)
        larger = share > peak.share
        peak.share = select(larger, share, peak.share)
        peak.share_bearing = select(larger, number, peak.share_bearing)
        peak.share_time = select(larger, section.clock, peak.share_time)
        peak.share_x = select(larger, (x * x + y * y) ** 0.5, peak.share_x)
        peak.share_force = select(larger, force, peak.share_force)
        peak.share_limit = select(larger, limit, peak.share_limit)
        smaller = force < peak.least
        peak.cavitation_force = select(smaller, strength, peak.cavitation_force)
        peak.least = select(smaller, force, peak.least)
        peak.least_bearing = select(smaller, number, peak.least_bearing)
        peak.least_time = select(smaller, section.clock, peak.least_time)
        support.largest = max(support.largest, force)
        support.least = min(support.least, force)
        pulled = -force * per_strength
        if section.dowelled == 1:
            pulled = 0.0 * force
            peak.uplift = max(peak.uplift, -support.shortening)
        else:
            if any_lane(support.memory > 1.0):
                weakened = cavitated_strength(column, strength, support.memory)
                peak.damage = max(peak.damage, 1.0 - weakened / strength)
            # The virgin curve rises beyond F_c, so that the extension says whether it cavitates.
            pulled = max(pulled, select(pulled > 0.0, -support.shortening * relative, 0.0))
        more = pulled > peak.tension
        peak.tension = select(more, pulled, peak.tension)
        peak.tension_time = select(more, section.clock, peak.tension_time)
    count = section.last - section.first
    peak.line_share = max(peak.line_share, line_force * per_limit / count)
    peak.exceeded += select(any_above, dt, 0.0)
    begins = any_above & (peak.first < 0.0)
    peak.first = select(begins, section.clock, peak.first)
    peak.falling = select(falling & (peak.falling < 0.0), section.clock, peak.falling)


@compiled
def critical_load_at(section: Section, column: Column, x: float, y: float) -> float:
    """Critical load of one bearing of a section at a displacement of the modelled one [kN]."""
    return section.buckling * find_overlap(section, column, x, y)


@compiled
def lend(system: System, motion: Motion) -> float:
    """Work that axial forces give to the shear of all lines so far [kN mm], with this step."""
    lent = 0.0
    for a in range(len(system.sections.sections)):
        section, energies = system.sections.sections[a], system.sections.energies[a]
        line, stretch = system.lines[section.line], motion.stretches[section.line]
        x, y = along_x(stretch), across(stretch)
        before_x, before_y = section.x / section.scale, section.y / section.scale
        # Trapezoidal, as all works of the structure, whose balance then closes to rounding.
        taken_x, taken_y = line.reduction_x * x, line.reduction_y * y
        energies.lent += 0.5 * (section.taken_x + taken_x) * (x - before_x)
        energies.lent += 0.5 * (section.taken_y + taken_y) * (y - before_y)
        section.taken_x, section.taken_y = taken_x, taken_y
        lent += energies.lent
    return lent


@compiled
def press_line(
    system: System, motion: Motion, a: int, force_x: float, force_y: float, ground: float, dt: float
) -> None:
    """Find the axial forces of a line at the end of a step, and note their extremes.

    `force_x` and `force_y` are the shear of the line without axial forces [kN].
    """
    section = system.sections.sections[a]
    line, stretch = system.lines[section.line], motion.stretches[section.line]
    x, y = along_x(stretch), across(stretch)
    section.clock += dt
    if section.moves == 1:
        shear, sway = force_x - line.reduction_x * x, x
        if section.across == 1:
            shear, sway = force_y - line.reduction_y * y, y
        moment = section.dead_moment + 0.0 * shear
        if section.overturns == 1:
            compression = 0.0
            for i in range(section.first, section.last):
                compression += system.sections.supports[i].axial_force
            moment += shear * section.height + 0.5 * compression * sway
        balanced = commit_section(system, a, moment, ground, dt)
        system.sections.peaks[a].unbalanced += select(no(balanced), 1.0, 0.0)
    s = section.scale
    moved, before = s * s * (x * x + y * y), section.x * section.x + section.y * section.y
    offset = section.largest_offset
    falling = (line.tangent < 0.0) & (moved > before) & (moved > offset * offset)
    note_section(system, a, s * x, s * y, dt, falling)


@compiled
def keep_section(system: System, row: int, motion: Motion) -> None:
    """Write the axial forces of all bearings, and their critical loads, into one row."""
    sections = system.sections
    for i in range(len(sections.supports)):
        sections.kept[row, i] = sections.supports[i].axial_force
    for a in range(len(sections.sections)):
        section = sections.sections[a]
        stretch = motion.stretches[section.line]
        x, y = section.scale * along_x(stretch), section.scale * across(stretch)
        sections.limits[row, a] = critical_load_at(section, sections.columns[a], x, y)
