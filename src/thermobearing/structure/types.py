"""The plain records that the compiled time integration reads and writes.

Units: kN, mm, s; mass in kN s2/mm, rotations in rad, moments in kN mm. `n` coordinates, `h`
hinges, `b` bearing lines. In plan, vectors have two components.
"""

from typing import Annotated, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.axial import Column
from thermobearing.core.records import Floats, Ints, Rows, rows
from thermobearing.core.types import BearingResponse, Vectors
from thermobearing.core.vector import Peak, Vector

# Outcomes in addition to those of the coupled step (core/types.py).
NO_EQUILIBRIUM: Final = 20
DIVERGED: Final = 21
MEASURE: Final = 22  # the march waits for a force from outside

FARTHEST: Final = 1e9  # a coordinate beyond this has diverged [mm or rad]

# Kinds of devices.
DAMPER: Final = 0
SLIDER: Final = 1
GAP: Final = 2

# Columns of HingeState.sides.
ABOVE: Final = 0  # positive rotations
BELOW: Final = 1


class Hinge:
    """Numbers of a hinge."""

    initial: float  # stiffness K_0 [kN mm/rad]
    yield_rotation: float  # [rad]
    hardening: float  # stiffness beyond yield over K_0
    unloading: float  # exponent of the unloading stiffness, K_0 (theta_y/theta_max)^exponent


class Bend:
    """The position of a hinge."""

    rotation: float  # [rad]
    moment: float  # [kN mm]


class Side:
    """The memory of a hinge in one direction."""

    farthest: float  # rotation so far, with its sign; at least the yield rotation
    turned: float  # rotation and moment where it last turned back
    turned_moment: float


class Device:
    """Numbers of a device parallel to bearings, of one or several side by side."""

    kind: int  # DAMPER, SLIDER or GAP
    damping: float  # c of a damper [kN (s/mm)^exponent]
    exponent: float
    heat_capacity: float  # of its oil [kN mm/K]; 0: the oil keeps its temperature
    warmer: float  # the air around it than that of the run [K]
    friction: float  # of a fast slider [kN]
    slow_friction: float  # as the velocity goes to zero [kN]
    rate: float  # of the velocity dependence [s/mm]
    stiffness: float  # of a slider before it slides, or of a gap in contact [kN/mm]
    gap: float  # opening [mm]
    closes_above: float  # 1 if it closes at a positive stretch, else 0
    closes_below: float
    dissipation: float  # lambda of a gap [s/mm]


class DeviceResponse:
    """The results of a device; in plan along its axis first. Works are those since the start."""

    stretch: Annotated[Vector, "mm", "displacement of the body of the device less its base's"]
    velocity: Annotated[Vector, "mm/s", "velocity of the stretch"]
    force: Annotated[Vector, "kN", "force of the device, positive with positive stretch"]
    work: Annotated[float, "kN mm", "work done on the device"]
    stored: Annotated[float, "kN mm", "energy that the device gives back"]
    heated: Annotated[float, "K", "temperature of the oil above that of the air"]
    factor: Annotated[float, "1", "factor of the temperature of the oil, in this step"]


class DevicePeak:
    """Largest numbers of a device, either way."""

    stroke: Peak  # [mm]
    velocity: Peak  # [mm/s]
    force: Peak  # [kN]


class LineFactors:
    """Between the structure and the bearing that is modelled for a line."""

    force_factor: float  # force in the structure over force of the modelled bearing
    length_factor: float  # displacement of the modelled bearing over that in the structure
    speed: float  # of a bearing that lives on its own clock [mm/s]; 0: earthquake time
    start: Vector  # displacement of the modelled bearing when the structure is straight [mm]
    at_rest: Vector  # its force then, in balance with something that stays [kN]
    warmer: float  # the air around it than that of the run [K]
    reduction_x: float  # of the line's stiffness by axial forces, in this step [kN/mm]
    reduction_y: float
    tangent: float  # smallest of the line with axial forces, at the trial [kN/mm]


class Coordinate:
    """The motion of the structure in one coordinate, and that of a trial."""

    q: float
    v: float
    a: float
    restoring: float  # force of springs, hinges and bearings
    trial: float  # q at the end of the step, as all that follow
    trial_restoring: float
    predicted_v: float
    predicted_a: float
    load: float  # Delta a_p of the predictor


class MotionEnergies:
    """Energies since the start, and what the integration took."""

    clock: Annotated[float, "s", "time since the start"]
    input: Annotated[float, "kN mm", "work of the ground, on motion relative to it"]
    kinetic: Annotated[float, "kN mm", "kinetic energy now"]
    damping: Annotated[float, "kN mm", "work of damping"]
    springs: Annotated[float, "kN mm", "energy stored in linear springs now, less that of weights"]
    hinges: Annotated[float, "kN mm", "work done on hinges, partly recoverable"]
    bearings: Annotated[float, "kN mm", "work done on bearings, as the structure feels it"]
    dampers: Annotated[float, "kN mm", "work done on viscous dampers"]
    sliders: Annotated[float, "kN mm", "work done on friction sliders, partly recoverable"]
    gaps: Annotated[float, "kN mm", "work done on closed gaps, partly recoverable"]
    iterations: Annotated[float, "1", "iterations of Newton's method"]
    substeps: Annotated[float, "1", "halvings of a step"]


class Section:
    """The bearings of a line side by side below a rigid section of the deck, and its motion.

    Vertical motion is positive downwards (shortening), roll presses the bearings at larger places.
    """

    line: int
    first: int  # its first bearing
    last: int  # one past its last
    moves: int  # 1 if axial forces change in time, 0 if they are constant
    across: int  # 1 if overturning is by the component along y (plan), 0 on a line
    overturns: int  # 1 if the shear of the line overturns the section
    dowelled: int  # 1 for bearings that lift, 0 for bolted ones that cavitate
    scale: float  # length of the modelled bearing over that in the structure
    weight: float  # dead load of all bearings [kN]
    mass: float  # that moves vertically [kN s2/mm]; 0: none
    damping: float  # of vertical motion [kN s/mm]
    span_stiffness: float  # of the deck between its mass and the line [kN/mm]; 0: rigid
    roll_inertia: float  # of the section about its centre [kN mm s2]; 0: roll is static
    height: float  # of the inertia above mid-height of the bearings [mm]
    dowel_length: float  # [mm]; 0: not stated
    span: float  # sum of the squares of the places of its bearings [mm2]
    offset: float  # sum of the shortenings under the dead loads [mm]
    offset_moment: float  # the same times the places [mm2]
    largest_offset: float  # |x| beyond which a falling force is an instability [mm]
    compression: float  # c of the modelled bearing, at the start of the step [mm3/kN]
    shear: float  # sum t_r/G [mm3/kN]
    softest: float  # smallest G of a layer [GPa]
    stiffness: float  # of a bearing in compression, at the start of the step [kN/mm]
    strength: float  # cavitation force F_c of a bearing, at the start of the step [kN]
    buckling: float  # critical load of a bearing without displacement, at the same time [kN]
    x: float  # of the modelled bearing, at the start of the step [mm]
    y: float
    overlap: float  # that the critical load counts, at `overlap_x` and `overlap_y`
    overlap_x: float  # of the modelled bearing [mm]
    overlap_y: float
    taken_x: float  # force that axial forces took from the line at the end of the last step [kN]
    taken_y: float
    clock: float  # [s]
    shortening: float  # v [mm]
    sunk: float  # displacement of the mass, downwards [mm]; v on a rigid deck
    velocity: float  # of the mass [mm/s]
    acceleration: float
    roll: float  # [rad]
    roll_velocity: float  # [rad/s]
    roll_acceleration: float
    dead_moment: float  # of the dead loads [kN mm]
    moment: float  # overturning moment, with that of the dead loads [kN mm]
    ground: float  # vertical ground acceleration, upwards [mm/s2]


class SectionEnergies:
    """Energies of a section since the start, and the iterations of its equilibrium."""

    lent: Annotated[float, "kN mm", "work that axial forces give to the shear"]
    axial_work: Annotated[float, "kN mm", "work of axial forces on the shortening of bearings"]
    weight: Annotated[float, "kN mm", "work of the dead load"]
    overturning: Annotated[float, "kN mm", "work of the overturning moment"]
    vertical_input: Annotated[float, "kN mm", "work of the vertical ground motion"]
    vertical_damping: Annotated[float, "kN mm", "work of damping of the vertical motion"]
    vertical_kinetic: Annotated[float, "kN mm", "kinetic energy of vertical motion and roll"]
    span_stored: Annotated[float, "kN mm", "energy stored in the spans"]
    iterations: Annotated[float, "1", "iterations of the equilibrium of the section"]


class Support:
    """A bearing of a section."""

    place: float  # from the centre of the section [mm]
    offset: float  # shortening under the dead load [mm]
    axial_force: float  # P [kN]
    shortening: float  # [mm]
    memory: float  # largest extension so far over that of cavitation, at least 1
    largest: float  # axial force so far [kN]
    least: float


class SectionPeak:
    """The extremes of the axial forces of a section."""

    share: float  # largest axial force over critical load of a bearing
    share_bearing: float  # its number, from 0
    share_time: float  # [s]
    share_x: float  # displacement of the modelled bearing then [mm]
    share_force: float  # [kN]
    share_limit: float  # [kN]
    exceeded: float  # time for which a bearing is above its critical load [s]
    first: float  # time when that begins [s]; negative: never
    line_share: float  # largest sum of axial forces over that of critical loads
    least: float  # smallest axial force [kN]
    least_bearing: float
    least_time: float
    tension: float  # largest tension over F_c
    tension_time: float
    cavitation_force: float  # F_c at the smallest axial force [kN]
    uplift: float  # largest of a dowelled bearing [mm]
    damage: float  # largest 1 - F_cn/F_c
    falling: float  # time when the force of the line falls as it moves on [s]; negative: never
    unbalanced: float  # steps without equilibrium of the section


class Sections(NamedTuple):
    """Axial forces of the bearings of some lines; all empty where they do not act."""

    number: Ints  # [b] of the section of a line; -1: none
    columns: Rows[Column]  # [a]
    sections: Rows[Section]  # [a]
    energies: Rows[SectionEnergies]  # [a]
    peaks: Rows[SectionPeak]  # [a]
    supports: Rows[Support]  # [s]
    vertical: Floats  # [steps + 1] ground acceleration upwards [mm/s2]
    kept: Floats  # [rows, s] axial forces of kept steps, the start first [kN]
    limits: Floats  # [rows, a] critical load of one bearing then [kN]


NO_SECTIONS: Final = Sections(
    number=np.zeros(0, dtype=np.int64),
    columns=rows(Column, 0),
    sections=rows(Section, 0),
    energies=rows(SectionEnergies, 0),
    peaks=rows(SectionPeak, 0),
    supports=rows(Support, 0),
    vertical=np.zeros(0),
    kept=np.zeros((0, 0)),
    limits=np.zeros((0, 0)),
)


class Devices(NamedTuple):
    """The devices parallel to bearings; all empty without one."""

    rows: Vectors  # [d, n] stretch of a device per coordinate
    devices: Rows[Device]  # [d]
    temperatures: Floats  # [d, k] of the oil of dampers [degC], rising
    factors: Floats  # [d, k] of their force at these temperatures


NO_DEVICES: Final = Devices(
    rows=np.zeros((0, 0)),
    devices=rows(Device, 0),
    temperatures=np.zeros((0, 1)),
    factors=np.zeros((0, 1)),
)


class System(NamedTuple):
    """A structure, without its bearings' insides."""

    mass: Floats  # [n, n]
    damping: Floats  # [n, n]
    stiffness: Floats  # [n, n] of the linear springs and of weights
    load: Vectors  # [n] force on each coordinate per ground acceleration, with its sign
    hinge_rows: Floats  # [h, n] rotation of a hinge per coordinate
    hinges: Rows[Hinge]  # [h]
    line_rows: Vectors  # [b, n] stretch of a bearing line per coordinate
    lines: Rows[LineFactors]  # [b]
    sections: Sections = NO_SECTIONS
    devices: Devices = NO_DEVICES


class HingeState(NamedTuple):
    """The positions and memories of the hinges."""

    bends: Rows[Bend]  # [h]
    sides: Rows[Side]  # [h, 2]


class Motion(NamedTuple):
    """The motion of the structure, and scratch of the integration."""

    points: Rows[Coordinate]  # [n]
    unknowns: Floats  # [n] right side, then solution of the equations
    matrix: Floats  # [n, n] effective tangent, destroyed by the solution
    tangent: Floats  # [n, n]
    hinges: HingeState
    trial_hinges: HingeState
    stretches: Vectors  # [b] of the bearing lines at the trial [mm]
    energies: Rows[MotionEnergies]  # [1]
    devices: Rows[DeviceResponse]  # [d]
    trial_devices: Rows[DeviceResponse]  # [d]
    device_peaks: Rows[DevicePeak]  # [d]


class Scheme(NamedTuple):
    """Parameters of the time integration; scalars only."""

    beta: float
    gamma: float
    tolerance: float  # of the residual, over the largest inertia force
    iterations: int  # Newton steps before a step is cut in half
    halvings: int  # largest number of halvings


class Shaking(NamedTuple):
    """The loads of a structure."""

    ground: Vectors  # [steps + 1] acceleration at the ends of steps [mm/s2], linear between
    dt: float  # of the steps [s]
    ambient: Floats  # [steps] mean ambient temperature [degC]
    keep: NDArray[np.bool_]  # [steps] whether the end of the step is kept


class Actuators(NamedTuple):
    """A specimen in the loop: what predicts, and what is imperfect (predictor-corrector)."""

    stiffness: Floats  # [n, n] of the predictor, initial stiffness of everything
    noise: Floats  # [steps] added to the force of every modelled bearing [kN]
    targets: Floats  # [steps + 1, b] scratch: stretches of the structure; zeros
    commands: Floats  # [steps + 1, b] scratch: stretches to reach; zeros
    weights: Floats  # [b, terms] of the targets in the command of a line, which are `ahead` apart
    ahead: float  # time by which commands are extrapolated, in steps, >= 0
    lag: float  # delay, in steps, >= 0: the force is read at the displacements commanded then
    outside: bool  # whether the march waits in every step for a force from outside


class Watch:
    """Displacement somewhere, as a sum of coordinates: the largest of a run, and its last."""

    displacement: Peak  # largest, either way [mm], or [rad] of a rotation
    residual: Vector  # at the end
    acceleration: Peak  # largest, either way, with that of the ground [mm/s2]


class LinePeak:
    """Largest numbers of a modelled bearing, either way, and warmest ones."""

    displacement: Peak  # [mm]
    force: Peak  # [kN]
    mismatch: float  # of layer forces [kN]
    rubber_temperature: float  # of any layer, at mid-thickness [degC]
    lead_temperature: float  # [degC]; 0 without lead
    coldest_lead: float  # [degC]
    speed: Peak  # mean of a step, on the clock of the bearing [mm/s]
    last_displacement: Vector  # at the end of the last step [mm], and its clock [s]
    clock: float


class HingePeak:
    """Largest numbers of a hinge, either way."""

    rotation: float  # [rad]
    moment: float  # [kN mm]


class Peaks(NamedTuple):
    """Quantities noted at the end of every step in place of rows; all may be empty."""

    places: Vectors  # [p, n] displacement that is watched, per coordinate
    carried: Floats  # [p] 1 where the ground moves what is watched, 0 for a difference
    watches: Rows[Watch]  # [p]
    lines: Rows[LinePeak]  # [b]
    hinges: Rows[HingePeak]  # [h]


class MotionRows(NamedTuple):
    """Room for the steps that are kept."""

    energies: Rows[MotionEnergies]  # [rows]
    q: Floats  # [rows, n]
    v: Floats
    a: Floats
    hinges: Rows[Bend]  # [rows, h]
    bearings: Rows[BearingResponse]  # [rows, b]
    devices: Rows[DeviceResponse]  # [rows, d]
    layers: tuple[Floats, ...]  # [kinds] of [rows, m, L]: temperatures at mid-thickness [degC]
    # [kinds] of [rows, m, N]: temperatures of the cells [degC], no columns if they are not kept
    cells: tuple[NDArray[np.float32], ...]

    def part(self, first: int, end: int) -> "MotionRows":
        """The same rows from `first` to before `end`, not a copy."""
        selection = slice(first, end)
        return MotionRows(
            self.energies[selection],
            self.q[selection],
            self.v[selection],
            self.a[selection],
            self.hinges[selection],
            self.bearings[selection],
            self.devices[selection],
            tuple(layers[selection] for layers in self.layers),
            tuple(cells[selection] for cells in self.cells),
        )
