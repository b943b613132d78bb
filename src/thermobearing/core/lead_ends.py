"""Confined lead cores on end plates of finite thickness, without p and without a clock.

The bulk of a core is warmer than the end plate under it (mean over the plan) by everything
that passed between them, remembered in K exponentials (model/lead_ends.py has their numbers):

    T_l - T_plate = sum of y,      dy/dt = (a q - y)/tau

with q the heat flow of one core into one plate.
"""

import math

from thermobearing.core.compile import compiled
from thermobearing.core.records import Rows
from thermobearing.core.types import Constants, Mode, ModeWork, State, Workspace


@compiled
def factor_modes(lead_modes: Rows[Mode], dt: float, factors: Rows[ModeWork]) -> None:
    """What each term keeps over dt [s], and what it gains from a constant flow."""
    for k in range(len(lead_modes)):
        factors[k].kept = math.exp(-dt / lead_modes[k].relaxation)
        gained = -math.expm1(-dt / lead_modes[k].relaxation)
        factors[k].gain = lead_modes[k].resistance * gained


@compiled
def exchange_at_ends(
    constants: Constants, work: Workspace, state: State, new: State, heat: float, dt: float
) -> None:
    """Heat all cores by `heat` [kN mm]; they and the plates under them exchange heat.

    The flow q is constant over the step, and such that the excess of the lead agrees with the
    terms at its end: implicit in lead, plate and terms, so any step is stable. What the cores
    lose, the plate cells gain (into `change`).
    """
    lead, rates, lead_cells = constants.lead, constants.cells, constants.lead_cells
    factors, temperature = work.lead_modes, state.temperature
    terms = len(factors)
    gain = 0.0
    for k in range(terms):
        gain += factors[k].gain
    share = dt * lead.fold / lead.capacity  # of one modelled end, in the temperature of the lead
    ease = 0.0
    towards = 0.0
    for e in range(len(lead_cells)):
        i = lead_cells[e].cell
        base: float = temperature[i]
        for k in range(e * terms, (e + 1) * terms):
            new.ends[k] = factors[k - e * terms].kept * state.ends[k]
            base += new.ends[k]
        resistance = gain + dt * lead.fold * lead.cores / rates.capacity[i]
        ease += 1.0 / resistance
        towards += base / resistance
    warmed = state.branches[0].lead_temperature + heat / (lead.cores * lead.capacity)
    t = (warmed + share * towards) / (1.0 + share * ease)
    for e in range(len(lead_cells)):
        i = lead_cells[e].cell
        base = temperature[i]
        for k in range(e * terms, (e + 1) * terms):
            base += new.ends[k]
        q = (t - base) / (gain + dt * lead.fold * lead.cores / rates.capacity[i])
        for k in range(terms):
            new.ends[e * terms + k] += factors[k].gain * q
        work.cells.change[i] += dt * lead.fold * lead.cores * q / rates.capacity[i]
    new.branches[0].lead_temperature = t
