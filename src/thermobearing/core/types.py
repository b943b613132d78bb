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

# Columns of Constants.layer_cells.
FIRST: Final = 0  # first rubber cell of the layer
LAST: Final = 1  # one past its last
UPPER_MIDDLE: Final = 2  # the two cells whose mean is the mid-thickness temperature
LOWER_MIDDLE: Final = 3

# Rows of State.layers.
D: Final = 0  # displacement d_j [mm]
Z: Final = 1  # hysteretic variable Z_j [mm]
STORED: Final = 2  # recoverable energy of one layer [kN mm]

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
BOOKS: Final = 11

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
    sharing_margin: float  # smallest layer tangent left alone, relative to alpha_0 e^{..} K_r


class Constants(NamedTuple):
    """Everything about one bearing that does not change during a run."""

    rubber: Rubber
    multiplicity: Floats  # [L] layers of the bearing that each modelled layer stands for
    layer_cells: Ints  # [L, 4]
    cells: Floats  # [5, n]
    source_rise: float  # temperature rise of a layer per heat in one whole layer [K/(kN mm)]
    side_implicit: bool  # side loss in Crank-Nicolson (True) or explicit as printed (False)
    heat_source: int  # HEAT_FROM_WORK or HEAT_FROM_DISSIPATION


class State(NamedTuple):
    """Everything that does change. `new_state` makes one, `copy_state` saves one."""

    layers: Floats  # [3, L]
    temperature: Floats  # [n] cell temperatures [degC]
    books: Floats  # [BOOKS]


class Workspace(NamedTuple):
    """Scratch arrays of one run, and the factors of the heat matrix for the last dt."""

    factored_dt: Floats  # [1] dt that the factors belong to [s]; 0: none yet
    layers: Floats  # [7, L]
    cells: Floats  # [4, n]


def new_state(constants: Constants, temperature: Floats) -> State:
    """A virgin bearing (no displacement, no hysteresis) at the given cell temperatures [degC]."""
    return State(
        np.zeros((3, len(constants.multiplicity))),
        np.array(temperature, dtype=np.float64),
        np.zeros(BOOKS),
    )


def new_workspace(constants: Constants) -> Workspace:
    """Scratch arrays for one run; never share them between threads."""
    layers, cells = len(constants.multiplicity), constants.cells.shape[1]
    return Workspace(np.zeros(1), np.zeros((7, layers)), np.zeros((4, cells)))
