"""The plain records that pass through the step: constants, state, workspace, outcome.

Units: kN, mm, s, degC, J = kN mm. `L` counts the rubber layers that the stack models (half of
them when the stack is cut at its symmetry plane), `n` its heat cells. Few arrays with named
rows, because every array handed to a compiled function costs nanoseconds.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# How Z is advanced (Rubber.integrator).
EXACT: Final = 0
EULER: Final = 1

# What part of the mechanical work becomes heat (Constants.heat_source).
HEAT_FROM_WORK: Final = 0
HEAT_FROM_DISSIPATION: Final = 1

# Outcome of one step. The sentences for people are in simulate.py.
COMPLETED: Final = 0
SOFTENED: Final = 1  # a layer tangent was not safely positive: hardening was shared
NOT_CONVERGED: Final = 2
NOT_FINITE: Final = 3
EULER_UNSTABLE: Final = 4
TEMPERATURE_RUNAWAY: Final = 5

# Rows of Constants.cells: exchange rates [1/s], then capacity of the whole bearing [kN mm/K].
TO_PREVIOUS: Final = 0
TO_NEXT: Final = 1
END_LOSS: Final = 2  # to the ambient, through an end face
SIDE_LOSS: Final = 3  # to the ambient, through the side
CAPACITY: Final = 4
# Conductance to all lead cores together, before 1/F(t+) and t+^{-1/3} [kN mm/(s K)].
LEAD_END: Final = 5
LEAD_SIDE: Final = 6
BESIDE_LEAD: Final = 7  # height of lead beside the cell [mm]

# Columns of Constants.layer_cells.
FIRST: Final = 0  # first rubber cell of the layer
LAST: Final = 1  # one past its last
UPPER_MIDDLE: Final = 2  # the two cells whose mean is the mid-thickness temperature
LOWER_MIDDLE: Final = 3

# Rows of State.layers.
D: Final = 0  # displacement d_j [mm]
Z: Final = 1  # hysteretic variable Z_j [mm]
STORED: Final = 2  # recoverable energy of one layer [kN mm]
FARTHEST: Final = 3  # largest |d_j| so far [mm]
VIRGIN: Final = 4  # share of the virgin stiffness that is left, 1 to 0
LAYER_ROWS: Final = 5

# Rows of State.lead.
LEAD_TEMPERATURE: Final = 0  # [degC]
CORE_FORCE: Final = 1  # of one core [kN]
MAXWELL_FORCE: Final = 2  # of the rate-dependent branch [kN]
CLOCK: Final = 3  # time since the motion began [s]
IDLE: Final = 4  # time since it stopped [s]
NEVER_MOVED: Final = 1e30  # IDLE of a virgin bearing: the first motion starts the clock
LEAD_ROWS: Final = 5  # then, for each end of a core, the terms y of Constants.lead_modes [K]

# Rows of Constants.lead_modes.
RESISTANCE: Final = 0  # a [K s/(kN mm)]
RELAXATION: Final = 1  # tau [s]
# Rows of Workspace.lead_modes, for the last dt.
KEPT: Final = 0  # exp(-dt/tau)
GAIN: Final = 1  # a (1 - exp(-dt/tau))

# Rows of State.books.
TIME: Final = 0  # [s]
DISPLACEMENT: Final = 1  # of the bearing [mm]
FORCE: Final = 2  # [kN]
WORK_IN: Final = 3  # [kN mm], since the start, as all that follow
HEAT_RELEASED: Final = 4
RECOVERABLE: Final = 5  # stored now, not since the start
HEAT_LOST_ENDS: Final = 6
HEAT_LOST_SIDES: Final = 7
HEAT_STORED: Final = 8
MISMATCH: Final = 9  # largest |layer force - bearing force| of this step [kN]
SHARING: Final = 10  # weight w of the mean-strain hardening in this step [0, 1]
RUBBER_FORCE: Final = 11  # share of the rubber layers [kN]
LEAD_FORCE: Final = 12  # share of all lead cores
VISCOUS_FORCE: Final = 13  # share of the rate-dependent branch
LEAD_DEGC: Final = 14  # lead temperature [degC]; 0 without lead
BOOKS: Final = 15

# Rows of Workspace.layers.
ELASTIC: Final = 0  # alpha_0 e^{..} K_r at the layer's temperature [kN/mm]
HYSTERETIC: Final = 1  # (1 - alpha_0) e^{..} K_r
LAYER_FORCE: Final = 2  # at the present iterate [kN]
TANGENT: Final = 3  # [kN/mm]
TRIAL: Final = 4  # layer displacement at the present iterate [mm]
DIRECTION: Final = 5  # Newton correction [mm]
SLOPE: Final = 6  # dZ/dd

# Rows of Workspace.cells.
ELIMINATION: Final = 0
PIVOT: Final = 1
UPPER: Final = 2
CHANGE: Final = 3  # right side, then temperature change [K]


class Rubber(NamedTuple):
    """Numbers of ONE rubber layer, and how its equations are solved; scalars only."""

    layer_count: float  # rubber layers in the whole bearing, N
    elastic_stiffness: float  # alpha_0 K_r [kN/mm]
    hysteretic_stiffness: float  # (1 - alpha_0) K_r [kN/mm]
    elastic_exponent: float  # m_T / 100 [1/K]
    hysteretic_exponent: float  # n_T / 100 [1/K]
    reference_temperature: float  # 23 degC in Eq. 4.34
    hardening: float  # b / t_r^2 [1/mm2]
    yield_displacement: float  # d_y [mm]
    unloading_curvature: float  # beta - gamma = (1 - s) / ((1 + s) d_y^2) [1/mm2]
    integrator: int  # EXACT or EULER
    virgin: bool  # whether the rubber is stiffer before it has worked (core/scragging.py)
    scragging_amplitude: float  # b
    scragging_displacement: float  # gamma t_r [mm]
    mullins_amplitude: float  # a
    mullins_decay: float  # c
    mullins_renewal: float  # l
    sharing_margin: float  # smallest layer tangent left alone, relative to alpha_0 e^{..} K_r


class Lead(NamedTuple):
    """Numbers of ONE lead core, and how its heat is booked; scalars only."""

    cores: float  # in the whole bearing, n_l; 0 for none
    stiffness: float  # K_l [kN/mm]
    strength: float  # Q_l at the reference temperature [kN]
    softening: float  # E2 of exp(-E2 (T - T_0)) [1/K]; 0 for constant strength
    reference_temperature: float  # T_0 [degC]
    capacity: float  # c rho V [kN mm/K]
    clock_rate: float  # diffusivity / r_l^2 [1/s]: t+ per time
    end_conductance: float  # A_l p k_s / r_l of one end, before 1/F [kN mm/(s K)]
    side_conductance: float  # of all cores and plates, before t+^{-1/3} [kN mm/(s K)]
    fold: float  # 2 for a half stack
    published: bool  # the printed bookkeeping of the heat (P4)


class Viscous(NamedTuple):
    """The rate-dependent branch; scalars only."""

    stiffness: float  # K_v [kN/mm]; 0 for none
    relaxation: float  # c_v / K_v [s]
    heats: bool  # whether its work warms the rubber


class Constants(NamedTuple):
    """Everything about one bearing that does not change during a run."""

    rubber: Rubber
    lead: Lead
    viscous: Viscous
    multiplicity: Floats  # [L] layers of the bearing that each modelled layer stands for
    layer_cells: Ints  # [L, 4]
    cells: Floats  # [8, n]
    lead_cells: Ints  # cells that touch lead
    lead_modes: Floats  # [2, K] core end on a finite plate; K = 0 for the half-space formula
    source_rise: float  # temperature rise of a layer per heat in one whole layer [K/(kN mm)]
    side_implicit: bool  # side loss in Crank-Nicolson (True) or explicit as printed (False)
    heat_source: int  # HEAT_FROM_WORK or HEAT_FROM_DISSIPATION


class State(NamedTuple):
    """Everything that does change. `new_state` makes one, `copy_state` saves one."""

    layers: Floats  # [LAYER_ROWS, L]
    temperature: Floats  # [n] cell temperatures [degC]
    lead: Floats  # [LEAD_ROWS + K per end]
    books: Floats  # [BOOKS]


class Workspace(NamedTuple):
    """Scratch arrays of one run, and the factors of the heat matrix for the last dt."""

    factored_dt: Floats  # [1] dt that the factors belong to [s]; 0: none yet
    layers: Floats  # [7, L]
    cells: Floats  # [4, n]
    lead_modes: Floats  # [2, K]


def new_state(
    constants: Constants, temperature: Floats, lead_temperature: float | None = None
) -> State:
    """A virgin bearing (no displacement, no hysteresis) at the given temperatures [degC].

    The lead starts at the mean temperature of the cells between its ends, unless given.
    """
    state = State(
        np.zeros((LAYER_ROWS, len(constants.multiplicity))),
        np.array(temperature, dtype=np.float64),
        np.zeros(LEAD_ROWS + constants.lead_modes.shape[1] * len(constants.lead_cells)),
        np.zeros(BOOKS),
    )
    state.layers[VIRGIN] = 1.0
    state.lead[IDLE] = NEVER_MOVED
    if constants.lead.cores > 0.0:
        beside = constants.cells[BESIDE_LEAD]
        mean = float(beside @ temperature / beside.sum())
        state.lead[LEAD_TEMPERATURE] = mean if lead_temperature is None else lead_temperature
    state.books[LEAD_DEGC] = state.lead[LEAD_TEMPERATURE]
    return state


def new_workspace(constants: Constants) -> Workspace:
    """Scratch arrays for one run; never share them between threads."""
    layers, cells = len(constants.multiplicity), constants.cells.shape[1]
    modes = np.zeros_like(constants.lead_modes)
    return Workspace(np.zeros(1), np.zeros((7, layers)), np.zeros((4, cells)), modes)
