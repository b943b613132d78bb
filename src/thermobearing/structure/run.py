"""One structure, one ground motion, bearings with their heat: from matrices to histories."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil
from typing import Any, Literal, Protocol, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.axial import Column
from thermobearing.core.records import Floats, Ints, Rows, rows, unset
from thermobearing.core.types import AxialResponse, BearingResponse, Constants, State
from thermobearing.model.axial import axial_rows
from thermobearing.model.outcomes import (
    INTERRUPTED,
    NAMES,
    NOT_PHYSICAL,
    is_physical,
)
from thermobearing.structure.connections.model import build_devices
from thermobearing.structure.connections.takeda import straight_hinges
from thermobearing.structure.forces import Bearing, Bearings, build_bearings, keep_motion
from thermobearing.structure.matrices import (
    Matrices,
    Modes,
    build_damping,
    build_matrices,
    check_stands,
    displacement_row,
    find_modes,
    mode_damping,
    total_stiffness,
)
from thermobearing.structure.model import (
    Damping,
    DampingKind,
    MassModel,
    Pier,
    Structure,
    list_hinges,
    list_piers,
)
from thermobearing.structure.newmark import newmark_march, plane_march, start_motion
from thermobearing.structure.predictor import predictor_march
from thermobearing.structure.types import (
    DIVERGED,
    MEASURE,
    NO_EQUILIBRIUM,
    NO_SECTIONS,
    Actuators,
    Bend,
    Coordinate,
    DevicePeak,
    DeviceResponse,
    Devices,
    Hinge,
    HingePeak,
    LineFactors,
    LinePeak,
    Motion,
    MotionEnergies,
    MotionRows,
    Peaks,
    Scheme,
    Section,
    SectionEnergies,
    SectionPeak,
    Sections,
    Shaking,
    Support,
    System,
    Watch,
)

Method = Literal["average-acceleration", "linear-acceleration", "predictor-corrector"]
BETA = {
    "average-acceleration": 1.0 / 4.0,
    "linear-acceleration": 1.0 / 6.0,
    "predictor-corrector": 1.0 / 6.0,
}
GAMMA = 0.5
TOLERANCE = 1e-10  # of the largest inertia force
ITERATIONS = 15
HALVINGS = 8
NO_VELOCITY = (
    "not for a structure with devices, whose forces need the velocity of the step; use "
    'method = "average-acceleration", or omit the devices'
)
SPECIMEN_LOST = "specimen_lost"
FORCE_LIMIT = "force_limit"
DISPLACEMENT_LIMIT = "displacement_limit"
IMPLAUSIBLE_FORCE = "implausible_force"
IMPLAUSIBLE_STIFFNESS = "implausible_stiffness"
IMPLAUSIBLE_ENERGY = "implausible_energy"
SENSOR_STUCK = "sensor_stuck"
OUTCOMES = {**NAMES, NO_EQUILIBRIUM: "no_equilibrium", DIVERGED: "diverged"}


@dataclass(frozen=True)
class PressedLine:
    """The axial forces of the bearings of a line, which act on its shear force."""

    columns: Rows[Column]  # [1] of the modelled bearing
    dead_loads: Floats  # [count] on each bearing [kN]
    places: Floats  # [count] across the line [mm]; zeros where axial forces are constant
    moves: bool = False  # whether axial forces change in time
    overturns: bool = False  # by the shear of the line, too
    height: float = 0.0  # of the inertia above mid-height of the bearings [mm]
    dowelled: bool = False  # lifts; otherwise bolted
    dowel_length: float = 0.0  # [mm]; 0: not stated
    mass: float = 0.0  # that moves vertically [kN s2/mm]
    damping_ratio: float = 0.0  # of the vertical motion
    span_stiffness: float = 0.0  # of the deck between its mass and the line [kN/mm]; 0: rigid
    roll_inertia: float = 0.0  # [kN mm s2]; 0: roll is static


@dataclass(frozen=True)
class Line:
    """A bearing line in one run."""

    constants: Constants  # of the modelled bearing
    temperature: Floats  # of its cells at the start [degC]
    lead: float | None = None  # temperature of its lead at the start [degC]; None: of the cells
    speed: float = 0.0  # of its actuator [mm/s], if it has its own clock; 0: earthquake time
    warmer: float = 0.0  # ambient temperature of this line less that of the run [K]
    # Where an earlier test left it (its temperatures count then); None: virgin. The structure is
    # straight and in balance with the force that the bearing has there.
    begun: State | None = None
    pressed: PressedLine | None = None  # None: axial forces do not act


class SpecimenError(Exception):
    """A specimen can go no further; `args[0]` is the outcome of the run."""


class Specimen(Protocol):
    """What takes the place of the modelled bearing of one line, outside of this program."""

    line: int

    def move(self, displacement: float, speed: float, time: float, twin: float) -> float:
        """Return the force [kN] after a move [mm] at a speed [mm/s]; SpecimenError ends the run.

        `twin` is the force of the modelled bearing [kN], by which that of the specimen is judged.
        """

    def stop(self) -> None:
        """Hold the specimen where it is, and end the test."""


@dataclass
class AxialHistory:
    """Axial forces of the bearings of some lines in one run; rows as of the history."""

    lines: list[int]  # [a] numbers of the lines
    force: Floats  # [rows, s] axial forces of all bearings, those of a line side by side [kN]
    limit: Floats  # [rows, a] critical load of one bearing of a line [kN]
    peaks: Rows[SectionPeak]  # [a]
    energies: Rows[SectionEnergies]  # [a] energies at the end
    supports: Rows[Support]  # [s] bearings at the end, with their extremes
    sections: Rows[Section]  # [a]


@dataclass
class StructureHistory:
    """Kept rows of one run, the start first."""

    rows: MotionRows
    bearings: Bearings  # where they are at the end
    outcome: str = "completed"
    steps: int = 0
    iterations: int = 0
    substeps: int = 0
    note: str = ""  # a warning of the specimen
    axial: AxialHistory | None = None  # where axial forces act
    device_peaks: Any = ()  # [d] records of DevicePeak

    def device(self, number: int = 0) -> Rows[DeviceResponse]:
        """Return stretch, force and energies of a device."""
        return self.rows.devices[:, number]

    def bearing(self, line: int = 0) -> Rows[BearingResponse]:
        """Return the energies and forces of the modelled bearing of a line."""
        return self.rows.bearings[:, line]

    def layers(self, line: int = 0) -> Floats:
        """Return the temperatures of its rubber layers [degC]."""
        kind, place = self._where(line)
        return np.asarray(self.rows.layers[kind][:, place])

    def cells(self, line: int = 0) -> Floats:
        """Return the temperatures of its cells [degC], if they are kept."""
        kind, place = self._where(line)
        return np.asarray(self.rows.cells[kind][:, place])

    def _where(self, line: int) -> tuple[int, int]:
        """Return the number of the kind of bearing that a line has, and its place in it."""
        for number, kind in enumerate(self.bearings):
            if line in kind.lines:
                return number, list(kind.lines).index(line)
        raise IndexError(line)

    def end(self, line: int = 0) -> State:
        """Return the state of the modelled bearing of a line at the end."""
        kind, place = self._where(line)
        return State(*[array[place] for array in self.bearings[kind].states])

    def hinge(self, number: int = 0) -> Rows[Bend]:
        """Return rotation and moment of a hinge."""
        return self.rows.hinges[:, number]


@dataclass(frozen=True)
class Prepared:
    """A structure that is ready to be shaken by any number of motions."""

    structure: Structure
    matrices: Matrices
    modes: Modes  # with the equivalent stiffness of the bearings
    damping: Floats  # [n, n]
    ratios: Floats  # damping ratio of each mode
    predictor: Floats = field(repr=False)  # [n, n] stiffness of the predictor

    @cached_property
    def deck(self) -> Floats:
        """Displacement of the deck per coordinate, relative to the ground: [n], or [n, 2]."""
        deck = self.structure.report.deck
        return displacement_row(self.structure, deck, self.structure.body(deck).base_height)

    @cached_property
    def piers(self) -> list[tuple[Pier, Floats, Floats]]:
        """Every pier, with displacements per coordinate of its top, and of it if its base moves.

        That of the report is the first.
        """
        structure = self.structure
        return [
            (
                pier,
                displacement_row(structure, pier.name, pier.top),
                displacement_row(structure, pier.base, pier.top),
            )
            for pier in list_piers(structure)
        ]


def prepare_structure(
    structure: Structure, mass_model: MassModel = "consistent", damping: DampingKind | None = None
) -> Prepared:
    """Return matrices, modes and damping, of another kind than the structure's if given."""
    if damping is not None and damping != structure.damping.kind:
        structure = structure.model_copy(update={"damping": Damping(kind=damping)})
    matrices = build_matrices(structure, mass_model)
    # Modes and predictor count the bearings with their equivalent stiffness.
    stiffness = total_stiffness(structure, matrices)
    check_stands(structure, matrices, stiffness)
    modes = find_modes(matrices.mass, stiffness, structure.name, matrices.coordinates)
    matrix = build_damping(structure, matrices, modes)
    ratios = mode_damping(matrix, modes)
    return Prepared(structure, matrices, modes, matrix, ratios, stiffness)


def start_under_load(line: Line, scale: float) -> AxialResponse:
    """Return stiffness and critical load of the modelled bearing of a line at its start."""
    assert line.pressed is not None
    cells, temperature = line.constants.layer_cells, line.temperature
    layers = 0.5 * (temperature[cells["upper_middle"]] + temperature[cells["lower_middle"]])
    load = np.array([scale**2 * line.pressed.dead_loads.max()])
    return axial_rows(line.pressed.columns, line.constants, np.zeros(1), load, layers[None])[0]


def _fill_section(
    section: Section,
    peak: SectionPeak,
    supports: Rows[Support],
    load: PressedLine,
    stiffness: float,
) -> None:
    """Put a section to rest under its dead loads; `stiffness` is vertical, of one bearing."""
    section.moves, section.overturns = int(load.moves), int(load.overturns)
    section.dowelled, section.dowel_length = int(load.dowelled), load.dowel_length
    section.weight, section.mass, section.height = load.dead_loads.sum(), load.mass, load.height
    section.span_stiffness, section.roll_inertia = load.span_stiffness, load.roll_inertia
    line_stiffness = len(load.dead_loads) * stiffness
    section.damping = 2.0 * load.damping_ratio * np.sqrt(load.mass * line_stiffness)
    column = load.columns[0]
    section.largest_offset = 0.5 * column.layer_thickness * column.layer_count
    places = load.places - load.places.mean()
    section.dead_moment = section.moment = (load.dead_loads * places).sum()
    section.span = (places * places).sum()
    section.offset, section.offset_moment = section.weight / stiffness, section.moment / stiffness
    section.overlap = 1.0  # without displacement
    supports["place"], supports["memory"] = places, 1.0
    supports["offset"] = supports["shortening"] = load.dead_loads / stiffness
    supports["axial_force"] = supports["largest"] = supports["least"] = load.dead_loads
    peak.first = peak.falling = -1.0
    peak.least = load.dead_loads.min()


def build_sections(
    structure: Structure, lines: Sequence[Line], rows_kept: int, vertical: Floats | None
) -> Sections:
    """Return the axial forces of the lines that have them, at rest under their dead loads."""
    pressed = [(b, line, line.pressed) for b, line in enumerate(lines) if line.pressed is not None]
    if not pressed:
        return NO_SECTIONS
    columns: list[Any] = [load.columns for _, _, load in pressed]
    ends = np.cumsum([len(load.dead_loads) for _, _, load in pressed])
    sections, supports = rows(Section, len(pressed)), rows(Support, int(ends[-1]))
    peaks, number = rows(SectionPeak, len(pressed)), np.full(len(lines), -1)
    kept, limits = np.zeros((1 + rows_kept, len(supports))), np.zeros((1 + rows_kept, len(pressed)))
    for a, (b, line, load) in enumerate(pressed):
        section, scale = sections[a], structure.bearings[b].scale
        start, first = start_under_load(line, scale), int(ends[a]) - len(load.dead_loads)
        section.line, section.first, section.last = b, first, int(ends[a])
        section.across, section.scale = int(bool(structure.plan)), scale
        stiffness = start.vertical_stiffness / scale
        _fill_section(section, peaks[a], supports[first : int(ends[a])], load, stiffness)
        # At rest the ground acceleration of the first sample presses already.
        section.ground = 0.0 if vertical is None else vertical[0]
        section.acceleration = section.ground if load.mass > 0.0 else 0.0
        limits[0, a] = start.critical_load / scale**2
        number[b] = a
    kept[0] = supports["axial_force"]
    return Sections(
        number=number,
        columns=cast(Rows[Column], np.concatenate(columns)),
        sections=sections,
        energies=rows(SectionEnergies, len(pressed)),
        peaks=peaks,
        supports=supports,
        vertical=np.zeros(0) if vertical is None else np.ascontiguousarray(vertical),
        kept=kept,
        limits=limits,
    )


def build_system(prepared: Prepared, lines: Sequence[Line]) -> System:
    """Return the structure as the compiled integration takes it."""
    structure, matrices = prepared.structure, prepared.matrices
    all_hinges = list_hinges(structure)
    hinges = rows(Hinge, len(all_hinges))
    for h, hinge in enumerate(all_hinges):
        hinges[h].initial = hinge.stiffness
        hinges[h].yield_rotation = hinge.yield_rotation
        hinges[h].hardening = hinge.hardening_ratio
        hinges[h].unloading = hinge.unloading_exponent
    factors = rows(LineFactors, len(lines), components=matrices.load.ndim)
    for b, (bearing_line, line) in enumerate(zip(structure.bearings, lines, strict=True)):
        factors[b].force_factor = bearing_line.count / bearing_line.scale**2
        factors[b].length_factor = bearing_line.scale
        factors[b].speed = line.speed
        factors[b].warmer = line.warmer
        if line.begun is not None:
            factors[b].start = line.begun.response[0].displacement
            factors[b].at_rest = line.begun.response[0].force
    return System(
        mass=np.ascontiguousarray(matrices.mass),
        damping=np.ascontiguousarray(prepared.damping),
        stiffness=np.ascontiguousarray(matrices.springs + matrices.geometric),
        load=np.ascontiguousarray(matrices.load),
        hinge_rows=np.ascontiguousarray(matrices.hinge_rows),
        hinges=hinges,
        line_rows=np.ascontiguousarray(matrices.line_rows),
        lines=factors,
        devices=_build_devices(prepared, lines),
    )


def _build_devices(prepared: Prepared, lines: Sequence[Line]) -> Devices:
    """Return the devices, in the air of the lines that they are parallel to."""
    structure = prepared.structure
    warmer = {
        bearing_line.name: line.warmer
        for bearing_line, line in zip(structure.bearings, lines, strict=True)
    }
    air = [warmer.get(device.line or "", 0.0) for device in structure.device_list]
    rows_of_devices = np.ascontiguousarray(prepared.matrices.device_rows)
    return Devices(rows_of_devices, *build_devices(structure.device_list, air))


def start_arguments(prepared: Prepared, lines: Sequence[Line]) -> tuple[Any, ...]:
    """Return the arguments of `build_bearings` and `start_states`."""
    return (
        [line.constants for line in lines],
        [line.temperature for line in lines],
        [line.lead for line in lines],
        [line.begun for line in lines],
        prepared.matrices.load.ndim,
    )


def new_motion(system: System) -> Motion:
    """Return a structure at rest, its hinges never bent."""
    n, d, components = len(system.load), len(system.devices.devices), system.load.ndim
    return Motion(
        points=rows(Coordinate, n),
        unknowns=np.zeros(n),
        matrix=np.zeros((n, n)),
        tangent=np.zeros((n, n)),
        hinges=straight_hinges(system.hinges),
        trial_hinges=straight_hinges(system.hinges),
        stretches=np.zeros((len(system.lines), *system.load.shape[1:])),
        energies=rows(MotionEnergies, 1),
        devices=rows(DeviceResponse, d, components=components),
        trial_devices=rows(DeviceResponse, d, components=components),
        device_peaks=rows(DevicePeak, d, components=components),
    )


def _no_peaks(system: System) -> Peaks:
    """Return no room for peaks: the rows are kept."""
    return Peaks(
        places=np.zeros((0, *system.load.shape)),
        carried=np.zeros(0),
        watches=rows(Watch, 0, components=system.load.ndim),
        lines=rows(LinePeak, 0, components=system.load.ndim),
        hinges=rows(HingePeak, 0),
    )


def room_for(
    system: System, bearings: Bearings, count: int, *, keep_cells: bool = False
) -> MotionRows:
    """Return rows for states of a structure and its bearings, not filled."""
    n, components = len(system.load), system.load.ndim
    return MotionRows(
        energies=unset(MotionEnergies, count),
        q=np.empty((count, n)),
        v=np.empty((count, n)),
        a=np.empty((count, n)),
        hinges=unset(Bend, count, len(system.hinges)),
        bearings=unset(BearingResponse, count, len(system.lines), components=components),
        devices=unset(DeviceResponse, count, len(system.devices.devices), components=components),
        layers=tuple(
            np.empty((count, len(kind.lines), len(kind.constants.multiplicity)))
            for kind in bearings
        ),
        cells=tuple(
            np.empty((count, *kind.states.temperature.shape), dtype=np.float32)
            if keep_cells
            else np.empty((count, len(kind.lines), 0), dtype=np.float32)
            for kind in bearings
        ),
    )


def all_physical(bearings: Bearings, recoverable: Floats) -> bool:
    """Return whether every bearing ended in a possible state, given its energy at the start."""
    return all(
        is_physical(
            kind.constants, State(*[array[m] for array in kind.states]), float(recoverable[line])
        )
        for kind in bearings
        for m, line in enumerate(kind.lines)
    )


def _actuators(
    prepared: Prepared, noise: Floats, lines: int, lag: float, order: int, outside: int | None
) -> Actuators:
    """Return the actuators of `lines` lines, with a delay of `lag` steps.

    Commands are extrapolated by the delay with a polynomial of `order` (Horiuchi et al., 1999);
    if the line `outside` has a specimen, that of the specimen alone, which has its own delay.
    """
    ahead = max(ceil(lag - 1e-9), 1.0)
    nodes = -ahead * np.arange(order + 1)
    other_nodes = [np.delete(nodes, i) for i in range(order + 1)]
    # Lagrange's polynomials through the last targets, at the time of the delay.
    coefficients = [
        np.prod((lag - remaining) / (x - remaining))
        for x, remaining in zip(nodes, other_nodes, strict=True)
    ]
    weights = np.tile(coefficients, (lines, 1))
    if outside is not None:
        weights[:] = np.eye(order + 1)[0]
        weights[outside] = coefficients
    commands = np.zeros((len(noise) + 1, lines))
    return Actuators(
        stiffness=np.ascontiguousarray(prepared.predictor),
        noise=noise,
        targets=np.zeros_like(commands),
        commands=commands,
        weights=weights,
        ahead=ahead,
        lag=lag if outside is None else 0.0,
        outside=outside is not None,
    )


@dataclass
class _Measured:
    """The forces of a specimen outside, and where it was; one value for the start and each step."""

    specimen: Specimen
    system: System
    bearings: Bearings
    motion: Motion
    force: list[float] = field(default_factory=list)
    displacement: list[float] = field(default_factory=list)

    def begin(self) -> None:
        """Measure the force at rest, with which the structure is in balance."""
        self._move(self._bearing().state.response[0], 0.0, 0.0)

    def take(self) -> None:
        """Replace the force of the modelled bearing in the trial by that of the specimen."""
        bearing = self._bearing()
        trial, state = bearing.trial.response[0], bearing.state.response[0]
        step = trial.clock - state.clock
        self._move(trial, (trial.displacement - state.displacement) / step, trial.clock)
        line = self.system.lines[self.specimen.line]
        # Both forces count from rest, where the structure is in balance.
        error = (self.force[-1] - self.force[0]) - (trial.force - line.at_rest)
        row = self.system.line_rows[self.specimen.line]
        self.motion.points["trial_restoring"] += row * (line.force_factor * error)

    def write(self, rows: MotionRows, kept: Ints) -> None:
        """Replace force and work of the modelled bearing in rows; `kept` are their steps."""
        line, factors = self.specimen.line, self.system.lines[self.specimen.line]
        force, x = np.array(self.force), np.array(self.displacement)
        work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(x))])
        response = rows.bearings[:, line]
        work = work[kept] + response["work_in"][0]
        # The march has added the work of the modelled bearing: the difference is put right.
        error = work - response["work_in"] - (force[0] - factors.at_rest) * (x[kept] - x[0])
        rows.energies["bearings"] += factors.force_factor / factors.length_factor * error
        response["force"], response["work_in"] = force[kept], work

    def _move(self, response: Any, speed: float, time: float) -> None:
        force = self.specimen.move(
            float(response.displacement), float(speed), float(time), float(response.force)
        )
        self.force.append(force)
        self.displacement.append(float(response.displacement))

    def _bearing(self) -> Bearing:
        for kind in self.bearings:
            if self.specimen.line in kind.lines:
                return kind.bearings[list(kind.lines).index(self.specimen.line)]
        raise IndexError(self.specimen.line)


_Arguments: TypeAlias = tuple[System, Bearings, Motion, Scheme, Shaking, Actuators, MotionRows]


def _march_with(
    specimen: Specimen, arguments: _Arguments, rows: MotionRows
) -> tuple[int, int, str]:
    """March with a specimen outside into all `rows`; return steps done, rows and outcome."""
    system, bearings, motion, _, shaking, _, _ = arguments
    measured = _Measured(specimen, system, bearings, motion)
    steps, kept, outcome = -1, 0, MEASURE
    try:
        measured.begin()
        while outcome == MEASURE:
            # The march returns in each step for the force of the specimen, and is called again
            # there.
            steps, kept, outcome = predictor_march(*arguments, steps, kept)
            if outcome == MEASURE:
                measured.take()
        outcome_name = OUTCOMES[int(outcome)]
    except SpecimenError as error:
        outcome_name = str(error.args[0])
    except KeyboardInterrupt:
        outcome_name = INTERRUPTED
    finally:
        specimen.stop()
    if measured.force:
        keep = shaking.keep[: max(steps, 0)]
        measured.write(rows.part(0, 1 + kept), np.append(0, 1 + np.flatnonzero(keep)))
    return max(steps, 0), kept, outcome_name


def _start(
    arguments: tuple[System, Bearings, Motion, Scheme, Shaking], kept: MotionRows
) -> Callable[..., tuple[int, int, int]]:
    """Keep the structure at rest under the first ground acceleration; return Newmark's march."""
    system, bearings, motion, scheme, shaking = arguments
    if system.load.ndim == 1:
        start_motion(system, motion, shaking.ground[0])
        keep_motion(bearings, motion, kept, 0)
        return newmark_march
    # Vectors of a plane need the compiled march: it sets the accelerations and takes no step.
    at_rest = shaking._replace(ground=shaking.ground[:1])  # no step
    plane_march(system, bearings, motion, scheme, at_rest, kept, _no_peaks(system))
    getattr(keep_motion, "py_func", keep_motion)(bearings, motion, kept, 0)
    return plane_march


def _kept_steps(steps: int, keep_every: int) -> NDArray[np.bool_]:
    """Return which steps are kept: every n-th and the end; the start is a row before them."""
    keep = np.zeros(steps, dtype=np.bool_)
    keep[keep_every - 1 :: keep_every] = True
    keep[-1] = True
    return keep


def _refuse_other_structures(system: System) -> None:
    """Refuse what the predictor-corrector cannot integrate."""
    if system.load.ndim > 1:
        raise ValueError("predictor-corrector: not for a structure in plan")
    if len(system.devices.devices):
        raise ValueError(f"predictor-corrector: {NO_VELOCITY}")


def run_structure(
    prepared: Prepared,
    lines: Sequence[Line],
    ground: Floats,
    dt: float,
    ambient: Floats,
    *,
    method: Method = "average-acceleration",
    keep_every: int = 1,
    noise: Floats | None = None,
    delay: float = 0.0,
    compensation: int = 0,
    specimen: Specimen | None = None,
    keep_cells: bool = False,
    vertical: Floats | None = None,
) -> StructureHistory:
    """Integrate the motion of a structure; a failed run has an outcome and its rows until then.

    `ground` [steps + 1], in plan [steps + 1, 2], is the ground acceleration at the ends of steps of
    `dt` [s], linear between [mm/s2]; `ambient` [steps] the mean temperature of each step [degC].
    Of the laboratory and for the predictor-corrector only are `noise` [steps] of the measured force
    [kN], `delay` [s], `compensation` (order of the polynomial) and a `specimen` in place of the
    bearing of its line, whose force and work then are in the rows. `vertical` [steps + 1] is the
    ground acceleration upwards, for the axial forces of lines that have them [mm/s2].
    """
    system = build_system(prepared, lines)
    if method == "predictor-corrector":
        _refuse_other_structures(system)
    motion = new_motion(system)
    bearings = build_bearings(*start_arguments(prepared, lines))
    steps = len(ground) - 1
    keep = _kept_steps(steps, keep_every)
    sections = build_sections(prepared.structure, lines, int(keep.sum()), vertical)
    system = system._replace(sections=sections)
    kept_rows = room_for(system, bearings, 1 + int(keep.sum()), keep_cells=keep_cells)
    scheme = Scheme(BETA[method], GAMMA, TOLERANCE, ITERATIONS, HALVINGS)
    shaking = Shaking(np.ascontiguousarray(ground), dt, ambient, keep)
    after = kept_rows.part(1, len(keep) + 1)
    march = _start((system, bearings, motion, scheme, shaking), kept_rows)
    if method == "predictor-corrector":
        outside = None if specimen is None else specimen.line
        noise = np.zeros(steps) if noise is None else noise
        actuators = _actuators(prepared, noise, len(lines), delay / dt, compensation, outside)
        arguments = system, bearings, motion, scheme, shaking, actuators, after
        if specimen is not None:
            steps_done, kept, outcome_name = _march_with(specimen, arguments, kept_rows)
        else:
            steps_done, kept, outcome = predictor_march(*arguments, -1, 0)
            outcome_name = OUTCOMES[int(outcome)]
    else:
        peaks = _no_peaks(system)
        steps_done, kept, outcome = march(system, bearings, motion, scheme, shaking, after, peaks)
        outcome_name = OUTCOMES[int(outcome)]
    if outcome_name == "completed" and not all_physical(
        bearings, kept_rows.bearings["recoverable"][0]
    ):
        outcome_name = NOT_PHYSICAL
    energies = motion.energies[0]
    return StructureHistory(
        rows=kept_rows.part(0, 1 + kept),
        bearings=bearings,
        outcome=outcome_name,
        steps=int(steps_done),
        iterations=int(energies.iterations),
        substeps=int(energies.substeps),
        axial=axial_history(sections, kept),
        device_peaks=motion.device_peaks,
    )


def axial_history(sections: Sections, kept: int) -> AxialHistory | None:
    """Return the axial forces of a run; None where they did not act."""
    if not len(sections.sections):
        return None
    return AxialHistory(
        lines=[int(line) for line in sections.sections["line"]],
        force=sections.kept[: 1 + kept],
        limit=sections.limits[: 1 + kept],
        peaks=sections.peaks,
        energies=sections.energies,
        supports=sections.supports,
        sections=sections.sections,
    )
