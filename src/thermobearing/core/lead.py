"""Lead cores: strength, heating, and the heat they pass to the steel (Eq. 5.1-5.7, 5.31).

Kalpakidis & Constantinou (2009): one temperature for the bulk of a core; its surface rises p
times as much. Each end is a disc heating a half-space (flux over F(t+), Eq. 5.5), the side a
hole heating a plate (t+^{1/3}); t+ = diffusivity x time / r_l^2 since the motion began.
In a plane the yield surface of a core is a circle, to which forces return along the radius.
Beyond the warmest lead of its tests the strength decreases at a second rate (`softened`).
"""

import math

from thermobearing.core.compiled.kernel import compiled, compiled_apart
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.lead_ends import exchange_at_ends
from thermobearing.core.types import (
    HEAT_FROM_DISSIPATION,
    Branches,
    Constants,
    Lead,
    State,
    Workspace,
)
from thermobearing.core.vector import (
    Matrix,
    Pair,
    Square,
    Vector,
    choice,
    direction,
    dot,
    isotropic,
    norm,
    outer,
    pick,
    plus,
    scaled,
    times,
)

STRENGTH_ITERATIONS = 20
STRENGTH_TOLERANCE = 1e-14  # of the strength, on its last Newton correction
SMALL_EXPONENT = 1e-4  # below it two terms of a series are exact to rounding
PER_PI = 1.0 / math.pi
SUBSTEP = 0.25  # largest explicit loss 2 theta of the published scheme in one go


@compiled
def _early_factor(t_plus: float) -> float:
    """F(t+) of Eq. 5.5 below 0.6."""
    q = 0.25 * t_plus
    series = 2.0 - q - q * q - 3.75 * q * q * q
    share = t_plus * PER_PI
    return 2.0 * math.sqrt(share) - share * series


@compiled
def _late_factor(t_plus: float) -> float:
    """F(t+) of Eq. 5.5 from 0.6 on."""
    q = 0.25 / t_plus
    series = 1.0 + q * (-1.0 / 3.0 + q * (1.0 / 6.0 - q * (1.0 / 12.0)))
    return 8.0 / (3.0 * math.pi) - math.sqrt(q * PER_PI) * series


@compiled_apart
def half_space_factor(t_plus: float) -> float:
    """F(t+) of Eq. 5.5: mean surface rise of a disc of constant flux, dimensionless."""
    # Two series; lanes evaluate both only if they lie on both sides.
    early = t_plus < 0.6
    if all_lanes(early):
        return _early_factor(t_plus)
    late = _late_factor(t_plus)
    if not any_lane(early):
        return late
    return select(early, _early_factor(t_plus), late)


@compiled
def end_factor(start: float, end: float) -> float:
    """Mean of 1/F over a step from t+ = start to end; finite at 0, where 1/F ~ t^{-1/2}.

    F is taken where sqrt(t+) has its mean: exact for the singular term.
    """
    middle = 0.5 * (math.sqrt(start) + math.sqrt(end))
    return 1.0 / half_space_factor(middle * middle)


@compiled_apart
def side_factor(start: float, end: float) -> float:
    """Mean of t+^{-1/3} over a step, exact."""
    after: float = end ** (2.0 / 3.0)
    before: float = start ** (2.0 / 3.0)
    return 1.5 * (after - before) / (end - start)


@compiled
def core_heat(lead: Lead, source: int, before: Vector, after: Vector, dx: Vector) -> float:
    """Heat of one core over a displacement increment: its work, or the plastic part of it."""
    heat = dot(scaled(plus(before, after), 0.5), dx)
    if source == HEAT_FROM_DISSIPATION:
        heat -= 0.5 * (dot(after, after) - dot(before, before)) / lead.stiffness
    return heat


@compiled
def _no_turning(lead: Lead, sign: float, q: float, size: float) -> float:
    """A force on a line does not turn."""
    return 0.0


@compiled
def _turning_in_plane(lead: Lead, sign: Pair, q: float, size: float) -> Square:
    """Tangent of a force of constant strength q that turns: q K/|trial| (I - n n')."""
    by = q * lead.stiffness / select(size > 0.0, size, 1.0)
    return plus(isotropic(sign, by), outer(scaled(sign, -by), sign))


_slope_by_turning = choice(_no_turning, _turning_in_plane, at=1)


@compiled
def _yielding_slope_on_line(
    before: float, sign: float, q: float, dx: float, per: float, heat_by_q: float, turning: float
) -> float:
    """Tangent of a core that yields: its work warms it by dx, and softens it by `per`."""
    by_x = -per * q * 0.5 * (before + sign * q) / (1.0 + per * q * heat_by_q)
    return sign * by_x


@compiled
def _yielding_slope_in_plane(
    before: Pair, sign: Pair, q: float, dx: Pair, per: float, heat_by_q: float, turning: Square
) -> Square:
    """`_yielding_slope` in a plane, where the force turns too."""
    mean = plus(plus(before, scaled(sign, q)), times(turning, dx))
    by_x = scaled(mean, -per * q * 0.5 / (1.0 + per * q * heat_by_q))
    return plus(turning, outer(sign, by_x))


_yielding_slope = choice(_yielding_slope_on_line, _yielding_slope_in_plane)


@compiled
def heat_within_tests(lead: Lead, temperature: float) -> float:
    """Heat that warms a core to the warmest lead of the tests [kN mm]."""
    return (lead.warmest_tested - temperature) * lead.capacity


@compiled
def softened(lead: Lead, temperature: float, heat: float) -> tuple[float, float]:
    """Exponent by which `heat` [kN mm] lowers the strength of a core, and its slope [1/(kN mm)].

    It counts from E2 (T - T_0) at the temperature T [degC] before the heat: E2 up to the warmest
    lead of the tests, the second rate beyond. Without a difference of rates, E2 alone.
    """
    per, beyond = lead.softening / lead.capacity, lead.softening_beyond / lead.capacity
    room = heat_within_tests(lead, temperature)
    inside = (lead.softening == lead.softening_beyond) | (heat <= room)
    within = select(inside, heat, room)
    return per * within + beyond * (heat - within), select(inside, per, beyond)


@compiled
def core_force(
    lead: Lead, source: int, temperature: float, before: Vector, dx: Vector
) -> tuple[Vector, Matrix]:
    """Force of one core after an increment dx [mm], and its tangent [kN/mm].

    Elastic, then yielding at Q = Q_0 exp(-E2 (T - T_0)) with T warmed by the work of this
    increment (implicit, so that strength and heat agree at the end of the step), and further
    below it beyond the tested temperatures (`softened`).
    """
    trial = plus(before, scaled(dx, lead.stiffness))
    sign, size = direction(trial), norm(trial)
    fall = lead.softening
    # Without softening the strength is constant within the tests, and needs no iteration. The heat
    # is at most the strength along the whole increment, and is computed only near their end.
    if all_lanes(fall == 0.0):
        constant = lead.strength * norm(dx) <= heat_within_tests(lead, temperature)
        if not all_lanes(constant):
            largest_heat = core_heat(lead, source, before, scaled(sign, lead.strength), dx)
            constant = softened(lead, temperature, largest_heat)[0] == 0.0
        if all_lanes(constant):
            yields = size > lead.strength
            return (
                pick(yields, scaled(sign, lead.strength), trial),
                pick(
                    yields,
                    _slope_by_turning(lead, sign, lead.strength, size),
                    isotropic(dx, lead.stiffness),
                ),
            )
    cold = q = lead.strength * math.exp(-fall * (temperature - lead.reference_temperature))
    # Elastic if the trial stays within the strength that its own heat leaves.
    lowered, _ = softened(lead, temperature, core_heat(lead, source, before, trial, dx))
    elastic = no(size > cold * math.exp(-lowered))
    if all_lanes(elastic):
        return trial, isotropic(dx, lead.stiffness)
    # Newton on q = Q(T + heat(q)/capacity). With dissipation as the source, the energy stored at q
    # is no heat.
    plastic = 1.0 if source == HEAT_FROM_DISSIPATION else 0.0
    converged = elastic
    for _ in range(STRENGTH_ITERATIONS):
        heat = core_heat(lead, source, before, scaled(sign, q), dx)
        lowered, per = softened(lead, temperature, heat)
        heated = cold * math.exp(-lowered)
        heat_by_q = dot(scaled(sign, 0.5), dx) - plastic * q / lead.stiffness
        correction = (q - heated) / (1.0 + per * heated * heat_by_q)
        q = select(converged, q, q - correction)
        converged = converged | no(abs(correction) > STRENGTH_TOLERANCE * cold)
        if all_lanes(converged):
            break
    heat_by_q = dot(scaled(sign, 0.5), dx) - plastic * q / lead.stiffness
    _, per = softened(lead, temperature, core_heat(lead, source, before, scaled(sign, q), dx))
    turning = _slope_by_turning(lead, sign, q, size)
    slope = _yielding_slope(before, sign, q, dx, per, heat_by_q, turning)
    return (
        pick(elastic, trial, scaled(sign, q)),
        pick(elastic, isotropic(dx, lead.stiffness), slope),
    )


@compiled
def _run_clock(lead: Lead, old: Branches, dx: Vector, dt: float, new: Branches) -> float:
    """Advance the clock of the motion; returns t+ at the start of the step.

    A pause as long as the half-space takes to recover (t+ of the pause = 1) stops it: the
    next motion starts it again from zero.
    """
    moves = norm(dx) != 0.0
    recovered = old.idle * lead.clock_rate >= 1.0
    start = select(moves & recovered, 0.0, old.clock)
    new.clock = start + dt
    new.idle = select(moves, 0.0, old.idle + dt)
    return start * lead.clock_rate


@compiled
def phi(z: float) -> tuple[float, float]:
    """(1 - e^-z)/z and (1 - that)/z, also for small z."""
    small = z < SMALL_EXPONENT
    sixth = z * (1.0 / 6.0)
    first_series, second_series = 1.0 - 0.5 * z + z * sixth, 0.5 - sixth
    if all_lanes(small):
        return first_series, second_series
    per = 1.0 / z
    first = -math.expm1(-z) * per
    return select(small, first_series, first), select(small, second_series, (1.0 - first) * per)


@compiled
def exchange(
    constants: Constants,
    work: Workspace,
    state: State,
    heat: float,
    ends: float,
    sides: float,
    dt: float,
) -> float:
    """Heat the cores (all of them: `heat` [kN mm]) and let them exchange heat with the steel.

    What the cores lose, the plate cells gain (into `change`). The cores' excess over the
    cells they touch relaxes exponentially, exactly for two bodies, so any step is stable.
    Returns the lead temperature at the end [degC]; `ends` and `sides` are the means of 1/F
    and t+^{-1/3} over the step.
    """
    lead, touching = constants.lead, constants.lead_cells
    capacities, temperature = constants.cells.capacity, state.temperature
    lead_temperature = state.branches[0].lead_temperature
    # The cells that touch lead count as one body, at their mean by conductance.
    conductance = 0.0
    towards = 0.0
    touched = 0.0
    for k in range(len(touching)):
        i = touching[k].cell
        g = touching[k].end * ends + touching[k].side * sides
        conductance += g
        towards += g * temperature[i]
        touched += capacities[i]
    per_capacity = 1.0 / (lead.cores * lead.capacity)
    if all_lanes(conductance == 0.0):
        return lead_temperature + heat * per_capacity
    per_conductance = 1.0 / conductance
    mean = towards * per_conductance
    # Mean over the step of an excess that decays from its start, and of that which steady heating
    # builds up.
    decay, heating = phi(dt * conductance * (per_capacity + 1.0 / touched))
    passed = dt * conductance * ((lead_temperature - mean) * decay + heat * per_capacity * heating)
    passed_per_conductance = passed * per_conductance
    for k in range(len(touching)):
        i = touching[k].cell
        g = touching[k].end * ends + touching[k].side * sides
        # Cells at unequal temperatures also exchange heat through the lead, whose sum is zero.
        gained = g * (dt * (mean - temperature[i]) + passed_per_conductance)
        work.cells.change[i] += gained / capacities[i]
    return lead_temperature + (heat - passed) * per_capacity


@compiled_apart
def published_exchange(
    constants: Constants,
    work: Workspace,
    state: State,
    heat: float,
    ends: float,
    sides: float,
    dt: float,
    ambient: float,
) -> float:
    """The printed bookkeeping (Eq. 5.15-5.31), with its slips (P4).

    theta contains n_l already and is multiplied by n_l again for the plates; the plates are
    warmed with the lead's c rho; the reference is the ambient. Explicit in time as printed,
    in substeps where the printed step would be unstable (long rests).
    """
    lead, touching = constants.lead, constants.lead_cells
    volume = lead.capacity  # c rho V of one core
    conductance = lead.cores * lead.end_conductance * ends * 2.0 + lead.side_conductance * sides
    loss = dt * conductance / volume
    substeps = max(1.0, math.ceil(loss / SUBSTEP))
    keep: float = (1.0 - loss / substeps) ** substeps
    above = state.branches[0].lead_temperature - ambient
    mean = select(loss == 0.0, above, above * (1.0 - keep) / loss)
    for k in range(len(touching)):
        i = touching[k].cell
        g = touching[k].end * ends + touching[k].side * sides
        theta = dt * g / (lead.fold * volume)
        work.cells.change[i] += lead.cores * theta * mean
    return ambient + above * keep + heat / (lead.cores * lead.capacity)


@compiled
def lead_step(
    constants: Constants,
    work: Workspace,
    state: State,
    new: State,
    dx: Vector,
    dt: float,
    ambient: float,
) -> float:
    """Clock, heat and temperature of the cores after a step; returns their heat [kN mm].

    The forces of the step are in `state` and `new` already. With the terms of a finite plate
    (core/lead_ends.py) the half-space formula and its clock are left out.
    """
    lead, old, after = constants.lead, state.branches[0], new.branches[0]
    source = constants.heat_source
    heat = lead.cores * core_heat(lead, source, old.core_force, after.core_force, dx)
    if constants.lead_ports > 0:
        exchange_at_ends(constants, work, state, new, heat, dt)
        return heat
    start = _run_clock(lead, old, dx, dt, after)
    end = start + dt * lead.clock_rate
    ends = end_factor(start, end)
    # Confined cores have no contact at their sides.
    sides = 0.0
    if any_lane(lead.side_conductance != 0.0):
        sides = side_factor(start, end)
    if lead.published:
        t = published_exchange(constants, work, state, heat, ends, sides, dt, ambient)
    else:
        t = exchange(constants, work, state, heat, ends, sides, dt)
    after.lead_temperature = t
    return heat
