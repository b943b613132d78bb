"""Misprinted equations of Shen (2023), evaluated as printed: functions of expressions.

Heat of one cell: a bearing as warm as the air, in which nothing moves, has to stay as it is.
"""

from typing import Any

import numpy as np

from reproduction.runs import HDR, LHDR, PIER, Runs
from thermobearing.core.records import Floats
from thermobearing.core.step import step
from thermobearing.core.types import Constants, new_state, new_workspace
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.stack import build_stack
from thermobearing.structure.matrices import build_matrices

DT = 0.005  # of the equations typed here [s]
ETA = 2.0
BETA_NEWMARK = 1.0 / 6.0
MM2_PER_M2 = 1e6


def diffusivity(runs: Runs, bearing: str, material: str) -> float:
    """Return k/(rho c) of a material [mm2/s]."""
    properties = getattr(runs.bearing(bearing).materials, material)
    return float(properties.conductivity / 1e3 / properties.volumetric_heat)


def constants(runs: Runs, bearing: str, scheme: Any) -> Constants:
    """Return the numbers of a scheme that the coupled step is given."""
    return build_model(runs.bearing(bearing), ModelOptions(scheme=scheme)).constants


def _beta(runs: Runs, bearing: str, thickness: float) -> float:
    """Alpha dt/(2 dx^2) of steel."""
    return diffusivity(runs, bearing, "steel") * DT / (2.0 * thickness**2)


def _end_and_rubber(runs: Runs) -> tuple[float, float, float]:
    """Return beta of an end plate cell, and gamma_AB and gamma_BA next to rubber (Eq. 4.19)."""
    stack = build_stack(runs.bearing(HDR), half=True)
    end, rubber = stack.part.index("end_plate"), stack.part.index("rubber")
    k, dx = stack.conductivity, stack.thickness
    end_term, rubber_term = k[end] * dx[rubber], k[rubber] * dx[end]
    gamma = end_term / (end_term + rubber_term)
    return _beta(runs, HDR, dx[end]), float(gamma), float(1.0 - gamma)


def _theta(runs: Runs) -> float:
    """4 h dt/(a c rho), rubber."""
    bearing = runs.bearing(HDR)
    film = bearing.materials.side_film / MM2_PER_M2
    heat = bearing.materials.rubber.volumetric_heat
    return film * bearing.geometry.plan.perimeter / bearing.area * DT / heat


def cell_4_16(runs: Runs) -> float:
    """Return one degree after a step of Eq. 4.16, which has theta T_A but no theta T."""
    beta, theta = _end_and_rubber(runs)[0], _theta(runs)
    left_side = -beta + (3.0 * beta + 1.0) - 2.0 * beta
    return (beta - (3.0 * beta - 1.0) + 2.0 * beta + theta) / left_side


def cell_4_20(runs: Runs) -> float:
    """Return one degree after a step of Eq. 4.20, whose right side has a factor 2 too much."""
    beta, ab, ba = _end_and_rubber(runs)
    left_side = -beta + (beta * (3.0 - 2.0 * ab) + 1.0) - 2.0 * beta * ba
    right_side = beta - (2.0 * beta * (3.0 - 2.0 * ab) - 1.0) + 2.0 * beta * ba
    return (right_side + _theta(runs)) / left_side


def cell_4_21(runs: Runs) -> float:
    """Return one degree after a step of Eq. 4.21, which has theta T_A but no theta T."""
    beta, ab, ba = _end_and_rubber(runs)
    left_side = -2.0 * beta * ba + (beta * (3.0 - 2.0 * ab) + 1.0) - beta
    right_side = 2.0 * beta * ba - (beta * (3.0 - 2.0 * ab) - 1.0) + beta
    return (right_side + _theta(runs)) / left_side


def cell_4_25(runs: Runs) -> float:
    """Return one degree after a step of Eq. 4.25, where the layer of Eq. 4.20 is right."""
    (beta, ab, ba), theta = _end_and_rubber(runs), _theta(runs)
    left_side = -beta + (beta * (3.0 - 2.0 * ab) + 1.0) - 2.0 * beta * ba
    right_side = beta - (beta * (3.0 - 2.0 * ab) + theta - 1.0) + 2.0 * beta * ba + theta
    return right_side / left_side


def _steel_plates(runs: Runs) -> tuple[float, float, float]:
    """beta_s2, gamma_s1s2, gamma_s2s1 of Eq. 5.14 and 5.16."""
    stack = build_stack(runs.bearing(LHDR), half=True)
    end_plate = stack.thickness[stack.part.index("end_plate")]
    sealing_plate = stack.thickness[stack.part.index("sealing_plate")]
    return (
        _beta(runs, LHDR, sealing_plate),
        float(sealing_plate / (end_plate + sealing_plate)),
        float(end_plate / (end_plate + sealing_plate)),
    )


def cell_5_22(runs: Runs) -> float:
    """Return one degree after a step of Eq. 5.16 and 5.22, where a minus sign is lost."""
    beta, g12, g21 = _steel_plates(runs)
    left_side = 2.0 * beta * g12 + (beta * (3.0 - 2.0 * g21) + 1.0) - beta
    right_side = 2.0 * beta * g12 - (beta * (3.0 - 2.0 * g21) - 1.0) + beta
    return right_side / left_side


def cell_5_23(runs: Runs) -> float:
    """Return one degree after a step of Eq. 5.23 with its stray factors 2."""
    beta = _steel_plates(runs)[0]
    return (beta - 2.0 * (beta - 1.0) + beta) / (-2.0 * beta + (2.0 * beta + 1.0) - beta)


def cell_5_19(runs: Runs) -> float:
    """Return one degree after a step of Eq. 5.19: theta_B (0 here) where eta_B belongs."""
    stack = build_stack(runs.bearing(LHDR), half=True)
    beta = _beta(runs, LHDR, float(stack.thickness[0]))
    left_side = ETA * beta + 1.0 - beta
    return (-(ETA * beta - 1.0) + beta + 2.0 * (0.0 - 1.0) * beta) / left_side


def shim_flux(runs: Runs) -> float:
    """Return what a shim receives over what its rubber loses, Eq. 4.27 and 4.28."""
    cells = constants(runs, HDR, "published").cells
    shim = build_stack(runs.bearing(HDR), half=True).part.index("shim")
    heat_lost = cells.capacity[shim - 1] * cells.to_next[shim - 1]
    return float(cells.capacity[shim] * cells.to_previous[shim] / heat_lost)


def plates_gain(runs: Runs) -> float:
    """Return the heat that the plates gain over what the cores lose, Eq. 5.21 and 5.31."""
    printed = constants(runs, LHDR, "published")
    lead, touched = printed.lead, printed.lead_cells[0]
    capacity = printed.cells.capacity[touched.cell]
    gained = lead.cores * touched.end / (lead.fold * lead.capacity) * capacity
    return float(gained / (lead.cores * lead.cores * lead.end_conductance * 2.0))


def uphill(runs: Runs) -> float:
    """Return the change of lead 10 K above the air among steel 20 K above it by Eq. 5.31 [K]."""
    printed = constants(runs, LHDR, "published")
    steel, lead = np.full(len(printed.cells.capacity), 20.0), 10.0
    state, new = new_state(printed, steel, lead), new_state(printed, steel, lead)
    step(printed, new_workspace(printed), state, 0.0, DT, 0.0, new)
    return float(new.branches[0].lead_temperature) - lead


def correction_3_15(_runs: Runs) -> tuple[float, float]:
    """Return velocity and displacement after Eq. 3.15, 3.16 over those of Eq. 3.6, 3.7, 3.14."""
    before, predicted, corrected = 1.0, 0.5, 0.2  # accelerations; their sizes do not matter
    change = predicted - corrected  # Eq. 3.14
    velocity = before * DT + 0.5 * change * DT
    displacement = 0.5 * before * DT**2 + BETA_NEWMARK * change * DT**2
    printed_velocity = before * DT + 0.5 * predicted * DT + 0.5 * corrected * DT
    printed_displacement = 0.5 * before * DT**2 + BETA_NEWMARK * (predicted + corrected) * DT**2
    return printed_velocity / velocity, printed_displacement / displacement


def dashpots_6_5(runs: Runs) -> float:
    """Return the smallest eigenvalue of the c_1 terms of Eq. 6.4-6.7 over the largest."""
    row = build_matrices(runs.structure(PIER)).line_rows[0]
    unit = np.sign(row)  # lengths scaled out
    signed: Floats = np.outer(np.abs(unit), unit)
    values = np.linalg.eigvalsh(0.5 * (signed + signed.T))
    return float(values[0] / values[-1])
