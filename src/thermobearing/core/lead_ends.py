"""Confined lead cores on end plates of finite thickness, without p and without a clock.

The bulk of a core is warmer than the end plate under it (mean over the plan) by everything
that passed between them, remembered in K exponentials (model/lead_ends.py has their numbers):

    T_l - T_plate = sum of y,      dy/dt = (a q - y)/tau

with q the heat flow of one core into one plate.
"""

import math

from thermobearing.core.compile import compiled
from thermobearing.core.types import (
    CAPACITY,
    CHANGE,
    GAIN,
    KEPT,
    LEAD_ROWS,
    LEAD_TEMPERATURE,
    RELAXATION,
    RESISTANCE,
    Floats,
    Ints,
    Lead,
)


@compiled
def factor_modes(lead_modes: Floats, dt: float, factors: Floats) -> None:
    """What each term keeps over dt [s], and what it gains from a constant flow."""
    for k in range(lead_modes.shape[1]):
        factors[KEPT, k] = math.exp(-dt / lead_modes[RELAXATION, k])
        gained = -math.expm1(-dt / lead_modes[RELAXATION, k])
        factors[GAIN, k] = lead_modes[RESISTANCE, k] * gained


@compiled
def exchange_at_ends(
    lead: Lead,
    rates: Floats,
    lead_cells: Ints,
    factors: Floats,
    temperature: Floats,
    cells: Floats,
    old: Floats,
    heat: float,
    dt: float,
    new: Floats,
) -> None:
    """Heat all cores by `heat` [kN mm]; they and the plates under them exchange heat.

    The flow q is constant over the step, and such that the excess of the lead agrees with the
    terms at its end: implicit in lead, plate and terms, so any step is stable. What the cores
    lose, the plate cells gain (into row CHANGE).
    """
    terms = factors.shape[1]
    gain = 0.0
    for k in range(terms):
        gain += factors[GAIN, k]
    share = dt * lead.fold / lead.capacity  # of one modelled end, in the temperature of the lead
    ease = 0.0
    towards = 0.0
    for e in range(len(lead_cells)):
        i = lead_cells[e]
        base: float = temperature[i]
        for k in range(LEAD_ROWS + e * terms, LEAD_ROWS + (e + 1) * terms):
            new[k] = factors[KEPT, k - LEAD_ROWS - e * terms] * old[k]
            base += new[k]
        resistance = gain + dt * lead.fold * lead.cores / rates[CAPACITY, i]
        ease += 1.0 / resistance
        towards += base / resistance
    warmed = old[LEAD_TEMPERATURE] + heat / (lead.cores * lead.capacity)
    t = (warmed + share * towards) / (1.0 + share * ease)
    for e in range(len(lead_cells)):
        i = lead_cells[e]
        base = temperature[i]
        for k in range(LEAD_ROWS + e * terms, LEAD_ROWS + (e + 1) * terms):
            base += new[k]
        q = (t - base) / (gain + dt * lead.fold * lead.cores / rates[CAPACITY, i])
        for k in range(terms):
            new[LEAD_ROWS + e * terms + k] += factors[GAIN, k] * q
        cells[CHANGE, i] += dt * lead.fold * lead.cores * q / rates[CAPACITY, i]
    new[LEAD_TEMPERATURE] = t
