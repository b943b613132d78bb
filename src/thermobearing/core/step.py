"""The one coupled step: displacement in, force, heat and temperatures out.

    step(constants, workspace, state, x, dt, ambient, new) -> (force, tangent, outcome)

Cyclic tests, structures, identification and outside solvers all call it. It reads `state`
and writes `new` (two different records), so a trial step is undone by forgetting `new`.
Order within a step, as in Shen (2023): layer stiffness at the temperatures of the start
(`begin`), equal-force sharing of x (`move`), heat of the layers (Eq. 4.22), conduction, and the
energy balance (`settle`). Force and tangent do not depend on the heat of the same step, so a
search for x may call `move` as often as it needs between one `begin` and one `settle`.
"""

import math

from thermobearing.core.compiled.kernel import compiled, compiled_apart, compiled_shared
from thermobearing.core.hardening import hardening_strain, strain_factor
from thermobearing.core.heat import conduct, factor, has_side_loss
from thermobearing.core.hysteresis import remember
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.lead import core_force, lead_step
from thermobearing.core.lead_ends import factor_ports
from thermobearing.core.records import Floats, Rows
from thermobearing.core.scragging import stiffen, wear
from thermobearing.core.sharing import largest_mismatch, share
from thermobearing.core.types import (
    COMPLETED,
    HEAT_FROM_DISSIPATION,
    LEAD_MELTED,
    NOT_FINITE,
    SOFTENED,
    TEMPERATURE_RUNAWAY,
    Constants,
    DurationWork,
    LawPiece,
    Layer,
    LayerCells,
    LayerWork,
    Rubber,
    State,
    Workspace,
)
from thermobearing.core.vector import (
    Matrix,
    Vector,
    dot,
    isotropic,
    minus,
    no_slope,
    plus,
    scaled,
    total,
    zero,
)


@compiled
def layer_temperature(layer_cells: Rows[LayerCells], temperature: Floats, j: int) -> float:
    """Temperature at mid-thickness of layer j [degC]."""
    upper: float = temperature[layer_cells[j].upper_middle]
    lower: float = temperature[layer_cells[j].lower_middle]
    return 0.5 * (upper + lower)


@compiled
def runs_away(constants: Constants, state: State) -> bool:
    """Return whether a rubber layer is colder than possible or decomposes."""
    limits = constants.limits
    outside = layer_temperature(constants.layer_cells, state.temperature, 0) < limits.coldest
    for j in range(len(constants.layer_cells)):
        t = layer_temperature(constants.layer_cells, state.temperature, j)
        outside = outside | (t < limits.coldest) | (t > limits.rubber)
    return outside


@compiled
def of_piece(p: LawPiece, temperature: float) -> tuple[float, float, float]:
    """`tabled` by one piece of the table."""
    t = temperature - p.origin
    elastic = p.elastic_0 + t * (p.elastic_1 + t * (p.elastic_2 + t * p.elastic_3))
    hysteretic = p.hysteretic_0 + t * (p.hysteretic_1 + t * (p.hysteretic_2 + t * p.hysteretic_3))
    viscous = p.viscous_0 + t * (p.viscous_1 + t * (p.viscous_2 + t * p.viscous_3))
    return elastic, hysteretic, viscous


@compiled_apart
def tabled(law: Rows[LawPiece], temperature: float) -> tuple[float, float, float]:
    """Logarithms of the factors of the table on the two stiffness terms and on the viscosity."""
    # One piece serves all runs up to the coldest of them; beyond it each run takes its own.
    k = 0
    while k + 1 < len(law) and all_lanes(temperature >= law[k + 1].lowest):
        k += 1
    elastic, hysteretic, viscous = of_piece(law[k], temperature)
    while k + 1 < len(law) and any_lane(temperature >= law[k + 1].lowest):
        k += 1
        warmer = temperature >= law[k].lowest
        warmer_piece = of_piece(law[k], temperature)
        elastic = select(warmer, warmer_piece[0], elastic)
        hysteretic = select(warmer, warmer_piece[1], hysteretic)
        viscous = select(warmer, warmer_piece[2], viscous)
    return elastic, hysteretic, viscous


@compiled
def stiffness_at(rubber: Rubber, law: Rows[LawPiece], temperature: float) -> tuple[float, float]:
    """Return the two stiffness terms of Eq. 4.34 of a layer at a temperature [kN/mm]."""
    elastic = rubber.elastic_exponent * (temperature - rubber.reference_temperature)
    hysteretic = rubber.hysteretic_exponent * (temperature - rubber.reference_temperature)
    if len(law) > 0:
        exponents = tabled(law, temperature)
        elastic += exponents[0]
        hysteretic += exponents[1]
    return (
        rubber.elastic_stiffness * math.exp(elastic),
        rubber.hysteretic_stiffness * math.exp(hysteretic),
    )


@compiled
def set_stiffness(
    rubber: Rubber,
    law: Rows[LawPiece],
    layer_cells: Rows[LayerCells],
    temperature: Floats,
    work: LayerWork,
) -> None:
    """The two stiffness terms of Eq. 4.34 at each layer's temperature."""
    for j in range(len(work.trial)):
        t = layer_temperature(layer_cells, temperature, j)
        work.elastic[j], work.hysteretic[j] = stiffness_at(rubber, law, t)


@compiled
def recoverable_energy(
    rubber: Rubber, ke: float, kh: float, d: Vector, z: Vector, mean: Vector, w: float
) -> float:
    """Energy one layer would give back: 1/2 ke d^2 + 1/2 (1 + B s^2) kh Z^2 [kN mm]."""
    hardening, _ = strain_factor(rubber, ke, kh, hardening_strain(d, mean, w), z)
    return 0.5 * (dot(scaled(d, ke), d) + dot(scaled(z, (1.0 + hardening) * kh), z))


@compiled
def _add_layer_heat(
    constants: Constants,
    work: Workspace,
    old: Rows[Layer],
    new: Rows[Layer],
    mean_force: Vector,
    viscous_heat: float,
    mean: Vector,
    w: float,
) -> tuple[float, float]:
    """Heat of every layer into the right side of the heat step (Eq. 4.22).

    `viscous_heat` is that of one layer. Returns the heat released and the energy recoverable
    from the layers afterwards, of the complete bearing [kN mm].
    """
    released = 0.0
    recoverable = 0.0
    layer_cells, cells = constants.layer_cells, constants.cells
    for j in range(len(old)):
        heat = viscous_heat + dot(mean_force, minus(new[j].d, old[j].d))
        new[j].stored = 0.0
        if constants.heat_source == HEAT_FROM_DISSIPATION:
            ke, kh = work.layers.elastic[j], work.layers.hysteretic[j]
            new[j].stored = recoverable_energy(
                constants.rubber, ke, kh, new[j].d, new[j].z, mean, w
            )
            heat -= new[j].stored - old[j].stored
            recoverable += constants.multiplicity[j] * new[j].stored
        rise = constants.source_rise * heat
        for i in range(layer_cells[j].first, layer_cells[j].last):
            work.cells.change[i] += rise
            released += cells.capacity[i] * rise
    return released, recoverable


@compiled
def relax(relaxation: float, dt: float, work: DurationWork) -> None:
    """What dt [s] leaves of a force in the viscous branch, and passes of an elastic one.

    `relaxation` is tau = c_v/K_v [s]. Nothing to do if the last step had both.
    """
    if any_lane((work.viscous_dt != dt) | (work.relaxation != relaxation)):
        work.kept = math.exp(-dt / relaxation)
        work.passed = -math.expm1(-dt / relaxation) * relaxation / dt
        work.viscous_dt, work.relaxation = dt, relaxation


@compiled
def maxwell(
    stiffness: float, work: DurationWork, force: Vector, dx: Vector
) -> tuple[Vector, float]:
    """Force [kN] and tangent [kN/mm], the same in all directions, after dx [mm].

    Of a dashpot and a spring in series, parallel to the rubber (Eq. 5.38-5.39),

        f_v' + f_v / tau = K_v x',   tau = c_v / K_v,

    exact for a displacement that changes linearly over the step. `stiffness` is K_v [kN/mm];
    `relax` has the duration of the step.
    """
    tangent = stiffness * work.passed
    return plus(scaled(force, work.kept), scaled(dx, tangent)), tangent


@compiled
def _relaxation(constants: Constants, state: State) -> float:
    """Relaxation time of the viscous branch [s] at the temperatures of the layers.

    The dashpots of the layers are in series and carry one force, so their fluidities add up.
    """
    relaxation = constants.viscous.relaxation
    if len(constants.law) == 0:
        return relaxation
    fluidity = 0.0
    for j in range(len(constants.layer_cells)):
        t = layer_temperature(constants.layer_cells, state.temperature, j)
        fluidity += constants.multiplicity[j] * math.exp(-tabled(constants.law, t)[2])
    return relaxation * (constants.rubber.layer_count / fluidity)


@compiled
def _beside_rubber(
    constants: Constants, work: Workspace, state: State, new: State, x: Vector, dt: float
) -> tuple[Vector, Vector, Matrix]:
    """Forces of lead and of the viscous branch, and their tangent."""
    lead, viscous = constants.lead, constants.viscous
    old, after = state.branches[0], new.branches[0]
    dx = minus(x, state.response[0].displacement)
    lead_force = zero(dx)
    tangent = no_slope(dx)
    after.lead_temperature = old.lead_temperature
    after.core_force = zero(dx)
    after.maxwell_force = zero(dx)
    if any_lane(lead.cores > 0.0):
        core, by_core = core_force(
            lead, constants.heat_source, old.lead_temperature, old.core_force, dx
        )
        after.core_force = core
        lead_force = scaled(core, lead.cores)
        tangent = plus(tangent, scaled(by_core, lead.cores))
    if any_lane(viscous.stiffness > 0.0):
        relax(_relaxation(constants, state), dt, work.duration[0])
        f, slope = maxwell(viscous.stiffness, work.duration[0], old.maxwell_force, dx)
        after.maxwell_force = f
        tangent = plus(tangent, isotropic(dx, slope))
    return lead_force, after.maxwell_force, tangent


@compiled
def _stored_beside_rubber(constants: Constants, new: State) -> float:
    """Energy that lead and viscous branch would give back at the end of a step [kN mm]."""
    # If all work becomes heat at once, nothing is left to be recovered.
    if constants.heat_source != HEAT_FROM_DISSIPATION:
        return 0.0
    lead, viscous, after = constants.lead, constants.viscous, new.branches[0]
    stored = 0.0
    if any_lane(lead.cores > 0.0):
        core = after.core_force
        stored += 0.5 * lead.cores * dot(core, core) / lead.stiffness
    if any_lane(viscous.stiffness > 0.0):
        dashpot = after.maxwell_force
        stored += 0.5 * dot(dashpot, dashpot) / viscous.stiffness
    return stored


@compiled
def _viscous_layer_heat(constants: Constants, state: State, new: State, dx: Vector) -> float:
    """Heat of the viscous branch that goes into each rubber layer over the step [kN mm]."""
    viscous = constants.viscous
    if all_lanes(viscous.stiffness == 0.0) or not viscous.heats:
        return 0.0
    before = state.branches[0].maxwell_force
    after = new.branches[0].maxwell_force
    heat = dot(scaled(plus(before, after), 0.5), dx)
    if constants.heat_source == HEAT_FROM_DISSIPATION:
        heat -= 0.5 * (dot(after, after) - dot(before, before)) / viscous.stiffness
    return heat * constants.rubber.layer_share


@compiled
def heat_step(
    constants: Constants,
    work: Workspace,
    state: State,
    x: Vector,
    dt: float,
    ambient: float,
    new: State,
) -> None:
    """Heat of the step into rubber and lead, conduction, and the heat balance."""
    cells, old, response = constants.cells, state.response[0], new.response[0]
    dx = minus(x, old.displacement)
    # The matrices depend on dt only.
    duration = work.duration[0]
    if any_lane(duration.heat_dt != dt):
        factor(cells, constants.side_implicit, dt, work.cells)
        factor_ports(constants, work, dt)
        duration.heat_dt, duration.sides = dt, has_side_loss(cells)
    for i in range(len(state.temperature)):
        work.cells.change[i] = 0.0
    released, recoverable = _add_layer_heat(
        constants,
        work,
        state.layers,
        new.layers,
        scaled(plus(old.rubber_force, response.rubber_force), 0.5),
        _viscous_layer_heat(constants, state, new, dx),
        scaled(x, constants.rubber.layer_share),
        response.sharing_weight,
    )
    # Lead before conduction: what the cores pass to the plates is a source of the cells.
    lead_stored = 0.0
    if any_lane(constants.lead.cores > 0.0):
        released += lead_step(constants, work, state, new, dx, dt, ambient)
        warmer = new.branches[0].lead_temperature - state.branches[0].lead_temperature
        lead_stored = constants.lead.cores * constants.lead.capacity * warmer
    stored, ends, sides = conduct(
        cells,
        constants.side_implicit,
        any_lane(duration.sides != 0.0),
        state.temperature,
        dt,
        ambient,
        work.cells,
        new.temperature,
    )
    response.heat_released = old.heat_released + released
    response.recoverable = recoverable + _stored_beside_rubber(constants, new)
    response.heat_lost_ends = old.heat_lost_ends + ends
    response.heat_lost_sides = old.heat_lost_sides + sides
    response.heat_stored = old.heat_stored + stored + lead_stored
    response.lead_temperature = new.branches[0].lead_temperature


@compiled_shared
def begin(constants: Constants, work: Workspace, state: State) -> None:
    """Stiffness of every layer for a step from `state`, into `work`."""
    rubber = constants.rubber
    set_stiffness(rubber, constants.law, constants.layer_cells, state.temperature, work.layers)
    if rubber.virgin:
        stiffen(rubber, state.layers, work.layers)


@compiled
def has_failed(outcome: int) -> bool:
    """Return whether a step failed."""
    return (outcome != COMPLETED) & (outcome != SOFTENED)


@compiled_shared
def move(
    constants: Constants, work: Workspace, state: State, x: Vector, dt: float, new: State
) -> tuple[Vector, Matrix, int]:
    """Mechanical part of a step, after `begin`: forces at the displacement x, into `new`.

    May be repeated with another x. Returns force, tangent and outcome as `step` does.
    """
    rubber = constants.rubber
    old, response = state.response[0], new.response[0]
    rubber_force, tangent, w, outcome = share(
        rubber, constants.multiplicity, state, work.layers, old.displacement, x, new.layers
    )
    failed = has_failed(outcome)
    if all_lanes(failed):
        return rubber_force, tangent, outcome
    lead_force, viscous_force, slope = _beside_rubber(constants, work, state, new, x, dt)
    force = plus(plus(rubber_force, lead_force), viscous_force)
    outcome = select(no(failed | math.isfinite(total(force))), NOT_FINITE, outcome)
    if all_lanes(has_failed(outcome)):
        return force, plus(tangent, slope), outcome
    response.displacement = x
    response.force = force
    response.rubber_force = rubber_force
    response.lead_force = lead_force
    response.viscous_force = viscous_force
    response.sharing_weight = w
    return force, plus(tangent, slope), outcome


@compiled_shared
def settle(
    constants: Constants, work: Workspace, state: State, dt: float, ambient: float, new: State
) -> int:
    """Thermal part of a step, after the last `move`: memory, heat, temperatures, energy balance.

    Returns COMPLETED, NOT_FINITE, TEMPERATURE_RUNAWAY or LEAD_MELTED.
    """
    old, response = state.response[0], new.response[0]
    if constants.rubber.virgin:
        share_of_layer = constants.rubber.layer_share
        mean_before = scaled(old.displacement, share_of_layer)
        mean = scaled(response.displacement, share_of_layer)
        wear(constants.rubber, state.layers, new.layers, mean_before, mean)
    if constants.rubber.closed_loops:
        for j in range(len(new.layers)):
            moved = minus(new.layers[j].d, state.layers[j].d)
            remember(constants.rubber, state, new, j, moved)
    x, force = response.displacement, response.force
    response.layer_force_mismatch = largest_mismatch(
        constants.rubber, work.layers, new.layers, response.rubber_force
    )
    response.clock = old.clock + dt
    # Trapezoidal, as the heat of the layers: all carry one force, so that sum F dd_j = F dx and the
    # balance closes to rounding.
    mean_force, dx = scaled(plus(old.force, force), 0.5), minus(x, old.displacement)
    response.work_in = old.work_in + dot(mean_force, dx)
    heat_step(constants, work, state, x, dt, ambient, new)
    not_finite = no(math.isfinite(response.heat_lost_sides + response.heat_released))
    outside = runs_away(constants, new)
    melts = new.branches[0].lead_temperature > constants.limits.lead
    ended = select(outside, TEMPERATURE_RUNAWAY, select(melts, LEAD_MELTED, COMPLETED))
    return select(not_finite, NOT_FINITE, ended)


@compiled
def step(
    constants: Constants,
    work: Workspace,
    state: State,
    x: Vector,
    dt: float,
    ambient: float,
    new: State,
) -> tuple[Vector, Matrix, int]:
    """Move the bearing to displacement x over the time dt.

    On a line displacement, force and tangent are numbers. In a plane (core/plane.py) they are a
    pair, a pair, and rows of pairs.

    Parameters
    ----------
    constants, work : the bearing, and scratch arrays made for it.
    state : where the step starts; not changed.
    x : bearing displacement at the end of the step [mm].
    dt : duration [s], > 0.
    ambient : mean ambient temperature over the step [degC].
    new : where the step ends; overwritten. Meaningless unless the outcome is COMPLETED
        or SOFTENED.

    Returns
    -------
    force : restoring force at the end, positive with positive x [kN].
    tangent : dF/dx [kN/mm].
    outcome : COMPLETED, SOFTENED, NOT_CONVERGED, NOT_FINITE, EULER_UNSTABLE,
        TEMPERATURE_RUNAWAY or LEAD_MELTED.
    """
    begin(constants, work, state)
    force, tangent, outcome = move(constants, work, state, x, dt, new)
    failed = has_failed(outcome)
    if all_lanes(failed):
        return force, tangent, outcome
    ended = settle(constants, work, state, dt, ambient, new)
    return force, tangent, select(failed | (ended == COMPLETED), outcome, ended)
