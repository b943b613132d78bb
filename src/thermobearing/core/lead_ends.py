"""Lead cores on plates of finite thickness, without p and without a clock.

Heat leaves a core through ports: into the end plate under it, and, if it is not confined, into
the steel around it. The bulk of the core is warmer than what a port leads to (mean over the
plan) by everything that passed through it, remembered in exponentials (model/lead_impedance.py
has their numbers):

    T_l - T_port = sum of y,      dy/dt = (a q - y)/tau

with q the heat flow of one core through the port.
"""

import math
from typing import Final

from thermobearing.core.compiled.kernel import compiled, compiled_apart
from thermobearing.core.records import Floats
from thermobearing.core.types import Constants, State, Workspace

STEPS_OF_LEAD: Final = 50.0


@compiled
def _invert(matrix: Floats) -> None:
    """Turn a positive definite matrix into its inverse (Gauss and Jordan)."""
    for p in range(len(matrix)):
        pivot = 1.0 / matrix[p, p]
        matrix[p, p] = 1.0
        for j in range(len(matrix)):
            matrix[p, j] *= pivot
        for i in range(len(matrix)):
            if i != p:
                factor = matrix[i, p]
                matrix[i, p] = 0.0
                for j in range(len(matrix)):
                    matrix[i, j] -= factor * matrix[p, j]


@compiled_apart
def factor_ports(constants: Constants, work: Workspace, dt: float) -> None:
    """Return each term's decay over dt [s], its gain from a flow, and the ports' conductance."""
    lead, lead_cells, lead_modes = constants.lead, constants.lead_cells, constants.lead_modes
    excess = work.lead_ports.conductance
    excess[:] = 0.0
    # Excess of the lead over each port by unit flows through each: of the terms, then of the cells
    # that the flow warms. Its inverse gives flows by excess.
    for k in range(len(lead_modes)):
        work.lead_modes[k].kept = math.exp(-dt / lead_modes[k].relaxation)
        gain = -math.expm1(-dt / lead_modes[k].relaxation) * lead_modes[k].resistance
        work.lead_modes[k].gain = gain
        first, first_weight = lead_modes[k].port, lead_modes[k].weight
        second, second_weight = lead_modes[k].second_port, lead_modes[k].second_weight
        excess[first, first] += first_weight * first_weight * gain
        excess[first, second] += first_weight * second_weight * gain
        excess[second, first] += first_weight * second_weight * gain
        excess[second, second] += second_weight * second_weight * gain
    if constants.lead_ports > 0:
        for e in range(len(lead_cells)):
            first, share = lead_cells[e].port, lead_cells[e].share
            capacity = constants.cells.capacity[lead_cells[e].cell]
            excess[first, first] += dt * lead.fold * lead.cores * share * share / capacity
    _invert(excess)


@compiled
def exchange_at_ends(
    constants: Constants, work: Workspace, state: State, new: State, heat: float, dt: float
) -> None:
    """Heat all cores by `heat` [kN mm]; they and what their ports lead to exchange heat.

    The flows q are constant over the step, and such that the excess of the lead agrees with the
    terms at its end: implicit in lead, cells and terms, so any step is stable. What the cores
    lose, the cells gain (into `change`).
    """
    lead, lead_cells, lead_modes = constants.lead, constants.lead_cells, constants.lead_modes
    base, flow = work.lead_ports.base, work.lead_ports.flow
    conductance = work.lead_ports.conductance
    base[:] = 0.0
    for e in range(len(lead_cells)):
        base[lead_cells[e].port] += lead_cells[e].share * state.temperature[lead_cells[e].cell]
    # What the terms are at the end of the step without any flow.
    for k in range(len(lead_modes)):
        y = work.lead_modes[k].kept * state.ends[k]
        new.ends[k] = y
        base[lead_modes[k].port] += lead_modes[k].weight * y
        base[lead_modes[k].second_port] += lead_modes[k].second_weight * y
    ease = 0.0
    towards = 0.0
    for p in range(len(base)):
        for i in range(len(base)):
            ease += conductance[p, i]
            towards += conductance[p, i] * base[i]
    # Balance of the lead: t = warmed - share sum G (t - base).
    warmed = state.branches[0].lead_temperature + heat / (lead.cores * lead.capacity)
    share = dt * lead.fold / lead.capacity  # of one flow, in the temperature of the lead
    t = (warmed + share * towards) / (1.0 + share * ease)
    for p in range(len(base)):
        flow[p] = 0.0
        for i in range(len(base)):
            flow[p] += conductance[p, i] * (t - base[i])
    for k in range(len(lead_modes)):
        q = lead_modes[k].weight * flow[lead_modes[k].port]
        q += lead_modes[k].second_weight * flow[lead_modes[k].second_port]
        new.ends[k] += work.lead_modes[k].gain * q
    all_cores = dt * lead.fold * lead.cores
    for e in range(len(lead_cells)):
        i = lead_cells[e].cell
        gained = all_cores * lead_cells[e].share * flow[lead_cells[e].port]
        work.cells.change[i] += gained / constants.cells.capacity[i]
    new.branches[0].lead_temperature = t


@compiled
def longest_rest_step(constants: Constants) -> float:
    """Return the longest step of a rest that follows lead and shims in touch [s].

    The flows out of the lead are constant over a step, and heat the cells that they reach before
    these pass it on: as if a resistance dt/C were added to that of the port, with C the heat
    capacity of those cells. It is held at a fiftieth of what is between shims and end plates.
    Confined lead carries no heat from shims to plates, and takes steps of any length.

    `constants`: of the coupled step.
    """
    lead, per_step, resistance = constants.lead, 0.0, 0.0
    if constants.lead_ports * lead.fold <= 2.0:  # ends only
        return math.inf
    for e in range(len(constants.lead_cells)):
        cell = constants.lead_cells[e]
        if cell.port < 2:
            capacity = constants.cells.capacity[cell.cell]
            per_step += lead.fold * lead.cores * cell.share**2 / capacity
    for k in range(len(constants.lead_modes)):
        mode = constants.lead_modes[k]
        resistance += mode.weight**2 * mode.resistance if mode.port < 2 else 0.0
        resistance += mode.second_weight**2 * mode.resistance if mode.second_port < 2 else 0.0
    return resistance / per_step / STEPS_OF_LEAD
