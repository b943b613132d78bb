"""What the print has wrong, computed: a function for each row of `data/claims/misprints.toml`.

Where an equation is typed here, it is typed as printed. Tables and the model are in
`misprints_of_tables`.
"""

import numpy as np

from thermobearing.bearing.model import Bearing, Material
from thermobearing.core.step import step
from thermobearing.core.types import Floats, new_state, new_workspace
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.stack import build_stack
from thermobearing.reproduce.chapter_5 import LHDR
from thermobearing.reproduce.runs import Runs, full_cycles
from thermobearing.reproduce.values import Numbers
from thermobearing.structure.matrices import build_matrices

HDR, PIER = "shen-hdr-specimen", "pier-p1"
DT = 0.005  # of the equations typed here [s]
ETA = 2.0
BETA_NEWMARK = 1.0 / 6.0
MM_PER_M = 1e3


# Heat of one cell: a bearing as warm as the air, in which nothing moves, has to stay as it is.


def _beta(material: Material, thickness: float) -> float:
    """Alpha dt/(2 dx^2)."""
    diffusivity = material.conductivity / MM_PER_M / material.volumetric_heat
    return diffusivity * DT / (2.0 * thickness**2)


def _end_and_rubber(bearing: Bearing) -> tuple[float, float, float]:
    """Of the cells of an end plate beta, beside rubber gamma_AB and gamma_BA (Eq. 4.19)."""
    stack = build_stack(bearing, half=True)
    end, rubber = stack.part.index("end_plate"), stack.part.index("rubber")
    k, dx = stack.conductivity, stack.thickness
    one, other = k[end] * dx[rubber], k[rubber] * dx[end]
    gamma = one / (one + other)
    return _beta(bearing.materials.steel, dx[end]), float(gamma), float(1.0 - gamma)


def _theta(bearing: Bearing) -> float:
    """4 h dt/(a c rho), rubber."""
    film = bearing.materials.side_film / MM_PER_M**2
    heat = bearing.materials.rubber.volumetric_heat
    return film * bearing.geometry.plan.perimeter / bearing.area * DT / heat


def cell_4_16(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 4.16, which has theta T_A but no theta T."""
    bearing = runs.bearing(HDR)
    beta, theta = _end_and_rubber(bearing)[0], _theta(bearing)
    left = -beta + (3.0 * beta + 1.0) - 2.0 * beta
    return (beta - (3.0 * beta - 1.0) + 2.0 * beta + theta) / left


def cell_4_20(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 4.20, whose right side has a factor 2 more than the left."""
    bearing = runs.bearing(HDR)
    beta, ab, ba = _end_and_rubber(bearing)
    left = -beta + (beta * (3.0 - 2.0 * ab) + 1.0) - 2.0 * beta * ba
    right = beta - (2.0 * beta * (3.0 - 2.0 * ab) - 1.0) + 2.0 * beta * ba
    return (right + _theta(bearing)) / left


def cell_4_21(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 4.21, which has theta T_A but no theta T."""
    bearing = runs.bearing(HDR)
    beta, ab, ba = _end_and_rubber(bearing)
    left = -2.0 * beta * ba + (beta * (3.0 - 2.0 * ab) + 1.0) - beta
    right = 2.0 * beta * ba - (beta * (3.0 - 2.0 * ab) - 1.0) + beta
    return (right + _theta(bearing)) / left


def cell_4_25(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 4.25, where the layer of Eq. 4.20 is right."""
    bearing = runs.bearing(HDR)
    beta, ab, ba = _end_and_rubber(bearing)
    theta = _theta(bearing)
    left = -beta + (beta * (3.0 - 2.0 * ab) + 1.0) - 2.0 * beta * ba
    right = beta - (beta * (3.0 - 2.0 * ab) + theta - 1.0) + 2.0 * beta * ba + theta
    return right / left


def _steel_plates(runs: Runs) -> tuple[float, float, float]:
    """beta_s2, gamma_s1s2, gamma_s2s1 of Eq. 5.14 and 5.16."""
    bearing = runs.bearing(LHDR)
    stack = build_stack(bearing, half=True)
    one = stack.thickness[stack.part.index("end_plate")]
    two = stack.thickness[stack.part.index("sealing_plate")]
    return _beta(bearing.materials.steel, two), float(two / (one + two)), float(one / (one + two))


def cell_5_22(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 5.16 and 5.22, whose first term has lost its minus sign."""
    beta, g12, g21 = _steel_plates(runs)
    left = 2.0 * beta * g12 + (beta * (3.0 - 2.0 * g21) + 1.0) - beta
    right = 2.0 * beta * g12 - (beta * (3.0 - 2.0 * g21) - 1.0) + beta
    return right / left


def cell_5_23(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 5.23 with its stray factors 2."""
    beta = _steel_plates(runs)[0]
    return (beta - 2.0 * (beta - 1.0) + beta) / (-2.0 * beta + (2.0 * beta + 1.0) - beta)


def cell_5_19(runs: Runs) -> Numbers:
    """One degree after a step of Eq. 5.19: theta_B where eta_B belongs, and theta is 0 here."""
    bearing = runs.bearing(LHDR)
    stack = build_stack(bearing, half=True)
    beta = _beta(bearing.materials.steel, float(stack.thickness[0]))
    left = ETA * beta + 1.0 - beta
    return (-(ETA * beta - 1.0) + beta + 2.0 * (0.0 - 1.0) * beta) / left


def source_4_15(runs: Runs) -> Numbers:
    """Rise by `Delta w Delta t/(c rho)` of Eq. 4.15-4.17 and 4.20 over that of Eq. 4.10.

    Delta w is the heat of a step already (Eq. 4.22).
    """
    rate = 1.0 / runs.bearing(HDR).materials.rubber.volumetric_heat
    return (rate * DT * DT) / (rate * DT)


def heat_rate_5_2(runs: Runs) -> Numbers:
    """Rate of heat by Eq. 5.2 in the second second over the first, yielding at constant speed.

    The integral is the heat, not its rate; Eq. 4.3 has no dot.
    """
    lead = runs.bearing(LHDR).lead
    assert lead is not None
    at = [lead.yield_stress * time for time in (1.0, 2.0)]
    return at[1] / at[0]


# Heat between parts, as the published scheme computes it


def shim_flux(runs: Runs) -> Numbers:
    """What a shim receives over what its rubber loses, Eq. 4.27 and 4.28."""
    cells = build_model(runs.bearing(HDR), ModelOptions(scheme="published")).constants.cells
    stack = build_stack(runs.bearing(HDR), half=True)
    shim = stack.part.index("shim")
    lost = cells.capacity[shim - 1] * cells.to_next[shim - 1]
    return float(cells.capacity[shim] * cells.to_previous[shim] / lost)


def heat_created(runs: Runs) -> Numbers:
    """Heat that the published scheme has too much, of the work: HDR, 250 %, -20 degC."""
    result = runs.cyclic(HDR, -20.0, full_cycles([2.5], closing_strain=None), scheme="published")
    return float(abs(result.energy["thermal_residual"].iloc[0]))


def heat_kept(runs: Runs) -> Numbers:
    """The same of the conservative scheme."""
    result = runs.cyclic(HDR, -20.0, full_cycles([2.5], closing_strain=None))
    return float(abs(result.energy["thermal_residual"].iloc[0]))


def inner_layer(runs: Runs) -> Numbers:
    """Rise of the inner layer, published over conservative: HDR, 250 %, -20 degC."""
    test = full_cycles([2.5], closing_strain=None)
    rises = [
        float(runs.cyclic(HDR, -20.0, test, scheme=scheme).cycles["rubber3_degC"].iloc[-1]) + 20.0
        for scheme in ("published", "conservative")
    ]
    return rises[0] / rises[1]


def side_loss_of_steel(runs: Runs) -> Numbers:
    """Rate of side loss of a steel cell as printed, with rubber's c rho, over its own."""
    both = [
        build_model(runs.bearing(HDR), ModelOptions(scheme=scheme)).constants.cells.side_loss[0]
        for scheme in ("published", "conservative")
    ]
    return float(both[0] / both[1])


def clock_of_lead(runs: Runs) -> Numbers:
    """Diffusivity of lead (Eq. 5.6, 5.7) over that of the steel whose half-space it is."""
    materials = runs.bearing(LHDR).materials
    assert materials.lead is not None
    parts = (materials.lead, materials.steel)
    both = [part.conductivity / part.volumetric_heat for part in parts]
    return both[0] / both[1]


def flux_of_a_core(runs: Runs) -> Numbers:
    """What one core loses by Eq. 5.13 and 5.31 over its own flux of Eq. 5.3."""
    lead = build_model(runs.bearing(LHDR), ModelOptions(scheme="published")).constants.lead
    own = 2.0 * lead.end_conductance
    return lead.cores * lead.end_conductance * 2.0 / own  # theta_l1 has n_l in it


def plates_gain(runs: Runs) -> Numbers:
    """Heat that the plates gain over what the cores lose, Eq. 5.21 and 5.31."""
    constants = build_model(runs.bearing(LHDR), ModelOptions(scheme="published")).constants
    lead, touched = constants.lead, constants.lead_cells[0]
    capacity = constants.cells.capacity[touched.cell]
    gained = lead.cores * touched.end / (lead.fold * lead.capacity) * capacity
    return float(gained / (lead.cores * lead.cores * lead.end_conductance * 2.0))


def uphill(runs: Runs) -> Numbers:
    """Change of lead 10 K above the air among steel 20 K above it, one step of Eq. 5.31 [K]."""
    constants = build_model(runs.bearing(LHDR), ModelOptions(scheme="published")).constants
    steel, lead = np.full(len(constants.cells.capacity), 20.0), 10.0
    state, new = new_state(constants, steel, lead), new_state(constants, steel, lead)
    step(constants, new_workspace(constants), state, 0.0, DT, 0.0, new)
    return float(new.branches[0].lead_temperature) - lead


def initial_rate_share(runs: Runs) -> Numbers:
    """K_v over all stiffnesses of Table 5.2: the share of the rate-dependent force at the start."""
    bearing = runs.bearing(LHDR)
    assert bearing.rate is not None
    assert bearing.lead is not None
    rubber = bearing.hysteresis.layer_stiffness / bearing.geometry.rubber_layers
    cores = bearing.lead.cores * bearing.lead.stiffness
    return bearing.rate.stiffness / (bearing.rate.stiffness + rubber + cores)


# Equations of motion


def ground_3_3(runs: Runs) -> Numbers:
    """Absolute acceleration of a deck that nothing holds, over that of the ground, by Eq. 3.3."""
    relative = 1.0  # [M]{a} = [M]{a_g}
    return relative + 1.0


def step_3_7(runs: Runs) -> Numbers:
    """Displacement in a step of constant acceleration by Eq. 3.7 over a dt^2/2."""
    return (0.5 * 0.0 + BETA_NEWMARK * 0.0) / 0.5  # Delta a_n is zero, a_n is not


def correction_3_15(runs: Runs) -> Numbers:
    """Velocity and displacement after Eq. 3.15, 3.16 over those of Eq. 3.6, 3.7, 3.14."""
    before, predicted, corrected = 1.0, 0.5, 0.2  # accelerations; their sizes do not matter
    change = predicted - corrected  # Eq. 3.14
    velocity = before * DT + 0.5 * change * DT
    displacement = 0.5 * before * DT**2 + BETA_NEWMARK * change * DT**2
    told_velocity = before * DT + 0.5 * predicted * DT + 0.5 * corrected * DT
    told_displacement = 0.5 * before * DT**2 + BETA_NEWMARK * (predicted + corrected) * DT**2
    return told_velocity / velocity, told_displacement / displacement


def dashpots_6_5(runs: Runs) -> Numbers:
    """Smallest eigenvalue of the c_1 terms of Eq. 6.4-6.7 as signed, over the largest."""
    row = build_matrices(runs.structure(PIER)).line_rows[0]
    unit = np.sign(row)  # lengths scaled out
    signed: Floats = np.outer(np.abs(unit), unit)
    values = np.linalg.eigvalsh(0.5 * (signed + signed.T))
    return float(values[0] / values[-1])
