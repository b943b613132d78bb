"""The plain records that pass through the step: constants, state, workspace, outcome.

Units: kN, mm, s, degC, J = kN mm. `L` counts the rubber layers that the stack models (half of
them when the stack is cut at its symmetry plane), `n` its heat cells. What is remembered of one
thing stands in one row (`records.py`), since every array handed to a compiled function costs
nanoseconds; what long loops run through, cells and scratch, is stored in columns (measured).
"""

from typing import Annotated, Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.records import MATRIX, VECTOR, Rows, Vector, rows, vector_fields
from thermobearing.core.records import Floats as Floats
from thermobearing.core.records import Ints as Ints

# How Z is advanced (Rubber.integrator).
EXACT: Final = 0
EULER: Final = 1

# What part of the mechanical work becomes heat (Constants.heat_source).
HEAT_FROM_WORK: Final = 0
HEAT_FROM_DISSIPATION: Final = 1

# Outcome of one step. The sentences for users are in model/outcomes.py.
COMPLETED: Final = 0
SOFTENED: Final = 1  # a layer tangent was not safely positive: hardening was shared
NOT_CONVERGED: Final = 2
NOT_FINITE: Final = 3
EULER_UNSTABLE: Final = 4
TEMPERATURE_RUNAWAY: Final = 5
LEAD_MELTED: Final = 6

DEPTH: Final = 12  # turning points that a layer remembers where small loops close

# One number for each layer or step on a line; in a plane these axes come last.
Vectors: TypeAlias = Annotated[Floats, VECTOR]
Matrices: TypeAlias = Annotated[Floats, MATRIX]

NEVER_MOVED: Final = 1e30  # Branches.idle of a virgin bearing: the first motion starts the clock


class Cells(NamedTuple):
    """The heat cells: exchange rates, and capacity counted for the complete bearing; all [n]."""

    to_previous: Floats  # [1/s], as the next three
    to_next: Floats
    end_loss: Floats  # to the ambient, through an end face
    side_loss: Floats  # to the ambient, through the side
    capacity: Floats  # [kN mm/K]
    beside_lead: Floats  # height of lead next to the cell [mm]


class SharedCells(Cells):
    """Cells that are the same in all runs of a lockstep: each number once, so that memory is near.

    Kernels take them as they take `Cells`.
    """


class LeadCell:
    """A heat cell that touches lead: conductance to all cores together, or part of a port."""

    cell: int  # its number
    end: float  # before 1/F(t+) [kN mm/(s K)], as the next
    side: float  # before t+^{-1/3}
    port: int  # through which lead heats it
    share: float  # of the flow through that port; they add up to one


class LayerCells:
    """The position of a rubber layer in the stack of cells."""

    first: int  # its first cell
    last: int  # one past its last
    upper_middle: int  # the two cells whose mean is the mid-thickness temperature
    lower_middle: int


class Mode:
    """One term of what separates lead and a port (core/lead_ends.py)."""

    resistance: float  # a [K s/(kN mm)]
    relaxation: float  # tau [s]
    port: int
    weight: float  # of the term there
    second_port: int  # another one, or the same with a weight of zero
    second_weight: float


class LawPiece:
    """A piece of the temperature table: cubics in T - origin for the logarithms of its factors."""

    lowest: float  # where the piece begins [degC]
    origin: float  # [degC]
    elastic_0: float  # on alpha_0 K_r, by power of T - origin
    elastic_1: float
    elastic_2: float
    elastic_3: float
    hysteretic_0: float  # on (1 - alpha_0) K_r
    hysteretic_1: float
    hysteretic_2: float
    hysteretic_3: float
    viscous_0: float  # on c_v
    viscous_1: float
    viscous_2: float
    viscous_3: float


class Layer:
    """The memory of a rubber layer."""

    d: Vector  # displacement d_j [mm]
    z: Vector  # hysteretic variable Z_j [mm]
    stored: float  # recoverable energy of one layer [kN mm]
    farthest: float  # largest mean displacement |x|/N so far [mm] (core/scragging.py)
    virgin: float  # share of the virgin stiffness that is left, 1 to 0
    turns: float  # turning points that are remembered, 0 to DEPTH (core/hysteresis.py)
    amplitude: float  # |Z| of the outermost of them [mm]; 0 without one
    heading: float  # sign of the last motion; 0 before it


class Turn:
    """A turning point of a rubber layer."""

    d: float  # [mm]
    z: float  # [mm]


class Branches:
    """Lead cores and rate dependence, parallel to the rubber."""

    lead_temperature: float  # [degC]; 0 without lead
    core_force: Vector  # of one core [kN]
    maxwell_force: Vector  # of the rate-dependent branch [kN]
    clock: float  # time since the motion began [s]
    idle: float  # time since it stopped [s]


class RubberResponse:
    """The results of every bearing: energies since the start; `recoverable` is the present one."""

    clock: Annotated[float, "s", "time since the start"]
    displacement: Annotated[Vector, "mm", "shear displacement of the bearing"]
    force: Annotated[Vector, "kN", "restoring force, positive with positive displacement"]
    work_in: Annotated[float, "kN mm", "mechanical work done on the bearing"]
    heat_released: Annotated[float, "kN mm", "heat released in the rubber layers"]
    recoverable: Annotated[float, "kN mm", "recoverable energy stored in the rubber layers"]
    heat_lost_ends: Annotated[float, "kN mm", "heat lost through the end faces"]
    heat_lost_sides: Annotated[float, "kN mm", "heat lost through the sides"]
    heat_stored: Annotated[float, "kN mm", "heat stored in the bearing since the start"]
    layer_force_mismatch: Annotated[
        float, "kN", "largest difference of a layer law from the force"
    ]  # of this step
    sharing_weight: Annotated[float, "1", "weight of the mean strain in the hardening factor"]


class BearingResponse(RubberResponse):
    """Further results of a bearing with lead or rate dependence."""

    rubber_force: Annotated[Vector, "kN", "share of the rubber layers in the force"]
    lead_force: Annotated[Vector, "kN", "share of the lead cores in the force"]
    viscous_force: Annotated[Vector, "kN", "share of the rate-dependent branch in the force"]
    lead_temperature: Annotated[float, "degC", "temperature of the lead cores"]


class AxialResponse:
    """What an axial force does to a bearing; energies since the start."""

    axial_force: Annotated[float, "kN", "axial force, positive in compression"]
    critical_load: Annotated[float, "kN", "critical load at the present displacement"]
    cavitation_force: Annotated[float, "kN", "tension at which the rubber cavitates"]
    vertical_stiffness: Annotated[float, "kN/mm", "vertical stiffness at the present displacement"]
    shortening: Annotated[float, "mm", "vertical shortening"]
    stiffness_reduction: Annotated[float, "kN/mm", "shear stiffness taken by the axial force"]
    lent: Annotated[float, "kN mm", "work that the axial force gives to the shear"]
    axial_work: Annotated[float, "kN mm", "work of the axial force on the shortening"]
    axial_stored: Annotated[float, "kN mm", "energy stored in compression"]
    axial_mismatch: Annotated[float, "kN mm", "energy without source, by the overlap in kappa"]
    stiffness_reduction_y: Annotated[float, "kN/mm", "the same across"]
    next_reduction: Annotated[float, "kN/mm", "shear stiffness taken in the next step"]
    next_reduction_y: Annotated[float, "kN/mm", "the same across"]
    next_potential: Annotated[float, "kN/mm", "the same without the overlap"]
    next_potential_y: Annotated[float, "kN/mm", "the same across, without the overlap"]


class LayerWork(NamedTuple):
    """Scratch of the rubber layers; all [L]."""

    elastic: Floats  # alpha_0 e^{..} K_r at the layer's temperature [kN/mm]
    hysteretic: Floats  # (1 - alpha_0) e^{..} K_r
    force: Vectors  # at the present iterate [kN]
    tangent: Matrices  # [kN/mm]
    trial: Vectors  # layer displacement at the present iterate [mm]
    direction: Vectors  # Newton correction [mm]
    slope: Matrices  # dZ/dd
    flexibility: Matrices  # inverse of the tangent [mm/kN]


class CellWork(NamedTuple):
    """Scratch of the heat cells: factors of the matrix for the last dt, and the right side."""

    elimination: Floats
    pivot: Floats
    upper: Floats
    change: Floats  # right side, then temperature change [K]


class ModeWork:
    """A term of a port for the last dt."""

    kept: float  # exp(-dt/tau)
    gain: float  # a (1 - exp(-dt/tau))


class DurationWork:
    """What depends on the duration of a step, kept while steps have the same."""

    heat_dt: float  # of the factors of cells and ports [s]; 0: none yet
    sides: float  # 1 if a cell loses heat through its side, else 0
    viscous_dt: float  # duration and relaxation time of the next two [s]
    relaxation: float
    kept: float  # exp(-dt/tau)
    passed: float  # (1 - exp(-dt/tau)) tau/dt


class PortWork(NamedTuple):
    """The ways out of a core, all [P]."""

    conductance: Floats  # [P, P] flows by excess of the lead, for the last dt [kN mm/(s K)]
    base: Floats  # temperature of the lead above which heat leaves, in this step [degC]
    flow: Floats  # of one core, in this step [kN mm/s]


class Rubber(NamedTuple):
    """Numbers of ONE rubber layer, and how its equations are solved; scalars only."""

    layer_count: float  # rubber layers in the complete bearing, N
    layer_share: float  # 1/N; products take less time than quotients
    elastic_stiffness: float  # alpha_0 K_r [kN/mm]
    hysteretic_stiffness: float  # (1 - alpha_0) K_r [kN/mm]
    elastic_exponent: float  # m_T / 100 [1/K]
    hysteretic_exponent: float  # n_T / 100 [1/K]
    reference_temperature: float  # 23 degC in Eq. 4.34
    hardening: float  # b / t_r^2 [1/mm2]
    monotone: bool  # whether unloading is monotone (core/hardening.py)
    yield_displacement: float  # d_y [mm]
    per_yield_displacement: float  # 1/d_y [1/mm]
    unloading_curvature: float  # beta - gamma = (1 - s) / ((1 + s) d_y^2) [1/mm2]
    integrator: int  # EXACT or EULER
    closed_loops: bool  # whether small loops close; the published law leaves them open
    virgin: bool  # whether the rubber is stiffer before it has worked (core/scragging.py)
    scragging_amplitude: float  # b
    scragging_displacement: float  # gamma t_r [mm]
    mullins_amplitude: float  # a
    mullins_decay: float  # c
    mullins_renewal: float  # l
    sharing_start: float  # layer tangent / (alpha_0 e^{..} K_r) below which w leaves zero
    sharing_full: float  # and at which it is one
    law: int = 0  # address of a user's law of Z on a line (core/hysteresis.py); 0 for none
    law_in_plane: int = 0  # the same in a plane
    law_1: float = 0.0  # its parameters
    law_2: float = 0.0
    law_3: float = 0.0
    law_4: float = 0.0


class Lead(NamedTuple):
    """Numbers of ONE lead core, and how its heat is booked; scalars only."""

    cores: float  # in the complete bearing, n_l; 0 for none
    stiffness: float  # K_l [kN/mm]
    strength: float  # Q_l at the reference temperature [kN]
    softening: float  # E2 of exp(-E2 (T - T_0)) [1/K]; 0 for constant strength
    softening_beyond: float  # the same above `warmest_tested` [1/K]
    reference_temperature: float  # T_0 [degC]
    warmest_tested: float  # warmest lead of the tests behind strength and E2 [degC]
    capacity: float  # c rho V [kN mm/K]
    clock_rate: float  # diffusivity / r_l^2 [1/s]: t+ per time
    end_conductance: float  # A_l p k_s / r_l of one end, before 1/F [kN mm/(s K)]
    side_conductance: float  # of all cores and plates, before t+^{-1/3} [kN mm/(s K)]
    fold: float  # 2 for a half stack
    published: bool  # the printed bookkeeping of the heat (P4)


class Viscous(NamedTuple):
    """The rate-dependent branch; scalars only."""

    stiffness: float  # K_v [kN/mm]; 0 for none
    relaxation: float  # c_v / K_v at the reference temperature [s]
    heats: bool  # whether its work warms the rubber


class Limits(NamedTuple):
    """Temperatures that end a run [degC]."""

    coldest: float  # absolute zero
    rubber: float  # decomposes
    lead: float  # melts


class Constants(NamedTuple):
    """Everything about one bearing that does not change during a run."""

    rubber: Rubber
    lead: Lead
    viscous: Viscous
    law: Rows[
        LawPiece
    ]  # table of the temperature law, in addition to the exponents; empty for none
    multiplicity: Floats  # [L] layers of the bearing that each modelled layer stands for
    layer_cells: Rows[LayerCells]  # [L]
    cells: Cells
    lead_cells: Rows[LeadCell]  # those that touch lead
    lead_ports: int  # ways out of a core, P; 0 for the half-space formula
    lead_modes: Rows[Mode]  # [K] of all ports
    source_rise: float  # temperature rise of a layer per heat in one layer [K/(kN mm)]
    side_implicit: bool  # side loss in Crank-Nicolson (True) or explicit as printed (False)
    heat_source: int  # HEAT_FROM_WORK or HEAT_FROM_DISSIPATION
    limits: Limits


class State(NamedTuple):
    """Everything that does change. `new_state` makes one, `copy_state` saves one."""

    layers: Rows[Layer]  # [L]
    turns: Any  # Rows[Turn], [L, DEPTH + 2], the newest first; [L, 0] where small loops stay open
    temperature: Floats  # [n] cell temperatures [degC]
    branches: Rows[Branches]  # [1]
    ends: Floats  # [K] the terms y of Constants.lead_modes [K]
    response: Rows[BearingResponse]  # [1]


class Workspace(NamedTuple):
    """Scratch arrays of one run, and what lasts for the next steps of the same duration."""

    duration: Rows[DurationWork]  # [1]
    layers: LayerWork
    cells: CellWork
    lead_ports: PortWork
    lead_modes: Rows[ModeWork]  # [K]


class Path(NamedTuple):
    """Displacements to march through; arrays have one entry per step."""

    x: Vectors  # [mm]
    dt: Floats  # [s]
    ambient: Floats  # mean ambient temperature of the step [degC]
    keep: NDArray[np.bool_]  # whether the end of the step is kept
    settled: float  # stop once every cell is this close to the ambient [K]; 0 never stops early


class Kept(NamedTuple):
    """Room for the steps that are kept; arrays of layers and cells may have no columns."""

    response: Rows[BearingResponse]  # [rows]
    rubber: Floats  # [rows, L] temperatures at mid-thickness [degC]
    layer_displacement: Vectors  # [rows, L] d_j [mm]
    hysteretic: Vectors  # [rows, L] Z_j [mm]
    cells: NDArray[np.floating]  # [rows, n] temperatures, single or double precision [degC]

    def part(self, first: int, end: int) -> "Kept":
        """The same rows from `first` to before `end`, not a copy."""
        selection = slice(first, end)
        return Kept(
            self.response[selection],
            self.rubber[selection],
            self.layer_displacement[selection],
            self.hysteretic[selection],
            self.cells[selection],
        )


def new_state(
    constants: Constants,
    temperature: Floats,
    lead_temperature: float | None = None,
    components: int = 1,
) -> State:
    """A virgin bearing (no displacement, no hysteresis) at the given temperatures [degC].

    It moves on a line, or in a plane with two components. The lead starts at the mean temperature
    of the cells between its ends, unless given.
    """
    layers = len(constants.multiplicity)
    state = State(
        layers=rows(Layer, layers, components=components),
        turns=rows(Turn, layers, DEPTH + 2 if constants.rubber.closed_loops else 0),
        temperature=np.array(temperature, dtype=np.float64),
        branches=rows(Branches, 1, components=components),
        ends=np.zeros(len(constants.lead_modes)),
        response=rows(BearingResponse, 1, components=components),
    )
    state.layers["virgin"] = 1.0
    state.branches["idle"] = NEVER_MOVED
    if constants.lead.cores > 0.0:
        lead = lead_at_start(constants, temperature, lead_temperature)
        state.branches["lead_temperature"] = state.response["lead_temperature"] = lead
    return state


def lead_at_start(
    constants: Constants, temperature: Floats, lead_temperature: float | None = None
) -> float:
    """Return the temperature of the lead of a virgin bearing [degC], as `new_state` says."""
    if lead_temperature is not None:
        return lead_temperature
    # Mean of the cells that lie next to the lead, by the height of lead there.
    height = constants.cells.beside_lead
    return float(height @ temperature / height.sum())


def new_workspace(constants: Constants, components: int = 1) -> Workspace:
    """Scratch arrays for one run; never share them between threads."""
    layers, cells = len(constants.multiplicity), len(constants.cells.capacity)
    ports, vector_shapes = constants.lead_ports, vector_fields(LayerWork)
    return Workspace(
        duration=rows(DurationWork, 1),
        layers=LayerWork(
            *(
                np.zeros((layers, *(vector_shapes.get(name, ()) if components > 1 else ())))
                for name in LayerWork._fields
            )
        ),
        cells=CellWork(*np.zeros((4, cells))),
        lead_ports=PortWork(np.zeros((ports, ports)), np.zeros(ports), np.zeros(ports)),
        lead_modes=rows(ModeWork, len(constants.lead_modes)),
    )
