"""One structure, one ground motion, bearings with their heat: from matrices to histories."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil
from typing import Any, Literal, Protocol, TypeAlias

import numpy as np

from thermobearing.core.records import Floats, Ints, Rows, rows, unset
from thermobearing.core.types import Books, Constants, State
from thermobearing.model.outcomes import (
    INTERRUPTED,
    NAMES,
    NOT_PHYSICAL,
    is_physical,
)
from thermobearing.structure.forces import Bearing, Bearings, build_bearings, keep_motion
from thermobearing.structure.matrices import (
    Matrices,
    Modes,
    build_damping,
    build_matrices,
    displacement_row,
    find_modes,
    hinge_stiffness,
    line_stiffness,
    mode_damping,
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
from thermobearing.structure.takeda import straight_hinges
from thermobearing.structure.types import (
    DIVERGED,
    MEASURE,
    NO_EQUILIBRIUM,
    Actuators,
    Bend,
    Coordinate,
    Hinge,
    HingePeak,
    LineFactors,
    LinePeak,
    Motion,
    MotionBooks,
    MotionRows,
    Peaks,
    Scheme,
    Shaking,
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
SPECIMEN_LOST = "specimen_lost"
FORCE_LIMIT = "force_limit"
DISPLACEMENT_LIMIT = "displacement_limit"
OUTCOMES = {**NAMES, NO_EQUILIBRIUM: "no_equilibrium", DIVERGED: "diverged"}


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


class SpecimenError(Exception):
    """A specimen can go no further; `args[0]` is the outcome of the run."""


class Specimen(Protocol):
    """What takes the place of the modelled bearing of one line, outside of this program."""

    line: int

    def move(self, displacement: float, speed: float, time: float) -> float:
        """Return the force [kN] after a move [mm] at a speed [mm/s]; SpecimenError ends the run."""

    def stop(self) -> None:
        """Hold the specimen where it is, and end the test."""


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

    def bearing(self, line: int = 0) -> Rows[Books]:
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
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    stiffness = stiffness + line_stiffness(structure, matrices)
    modes = find_modes(matrices.mass, stiffness, structure.name, matrices.coordinates)
    matrix = build_damping(structure, matrices, modes)
    ratios = mode_damping(matrix, modes)
    return Prepared(structure, matrices, modes, matrix, ratios, stiffness)


def build_system(prepared: Prepared, lines: Sequence[Line]) -> System:
    """Return the structure as the compiled integration takes it."""
    structure, matrices = prepared.structure, prepared.matrices
    given_hinges = list_hinges(structure)
    hinges = rows(Hinge, len(given_hinges))
    for h, hinge in enumerate(given_hinges):
        hinges[h].initial = hinge.stiffness
        hinges[h].yield_rotation = hinge.yield_rotation
        hinges[h].hardening = hinge.hardening_ratio
        hinges[h].unloading = hinge.unloading_exponent
    factors = rows(LineFactors, len(lines), components=matrices.load.ndim)
    for b, (given, line) in enumerate(zip(structure.bearings, lines, strict=True)):
        factors[b].force_factor = given.count / given.scale**2
        factors[b].length_factor = given.scale
        factors[b].speed = line.speed
        factors[b].warmer = line.warmer
        if line.begun is not None:
            factors[b].start = line.begun.books[0].displacement
            factors[b].at_rest = line.begun.books[0].force
    return System(
        mass=np.ascontiguousarray(matrices.mass),
        damping=np.ascontiguousarray(prepared.damping),
        stiffness=np.ascontiguousarray(matrices.springs),
        load=np.ascontiguousarray(matrices.load),
        hinge_rows=np.ascontiguousarray(matrices.hinge_rows),
        hinges=hinges,
        line_rows=np.ascontiguousarray(matrices.line_rows),
        lines=factors,
    )


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
    n = len(system.load)
    return Motion(
        points=rows(Coordinate, n),
        unknowns=np.zeros(n),
        matrix=np.zeros((n, n)),
        tangent=np.zeros((n, n)),
        hinges=straight_hinges(system.hinges),
        trial_hinges=straight_hinges(system.hinges),
        stretches=np.zeros((len(system.lines), *system.load.shape[1:])),
        books=rows(MotionBooks, 1),
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
        books=unset(MotionBooks, count),
        q=np.empty((count, n)),
        v=np.empty((count, n)),
        a=np.empty((count, n)),
        hinges=unset(Bend, count, len(system.hinges)),
        bearings=unset(Books, count, len(system.lines), components=components),
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
    places = -ahead * np.arange(order + 1)
    others = [np.delete(places, i) for i in range(order + 1)]
    signed = [np.prod((lag - far) / (x - far)) for x, far in zip(places, others, strict=True)]
    weights = np.tile(signed, (lines, 1))
    if outside is not None:
        weights[:] = np.eye(order + 1)[0]
        weights[outside] = signed
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
        self._move(self._bearing().state.books[0], 0.0, 0.0)

    def take(self) -> None:
        """Replace the force of the modelled bearing in the trial by that of the specimen."""
        bearing = self._bearing()
        trial, state = bearing.trial.books[0], bearing.state.books[0]
        step = trial.clock - state.clock
        self._move(trial, (trial.displacement - state.displacement) / step, trial.clock)
        line = self.system.lines[self.specimen.line]
        error = (self.force[-1] - self.force[0]) - (trial.force - line.at_rest)
        row = self.system.line_rows[self.specimen.line]
        self.motion.points["trial_restoring"] += row * (line.force_factor * error)

    def write(self, rows: MotionRows, kept: Ints) -> None:
        """Replace force and work of the modelled bearing in rows; `kept` are their steps."""
        line, factors = self.specimen.line, self.system.lines[self.specimen.line]
        force, x = np.array(self.force), np.array(self.displacement)
        work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(x))])
        books = rows.bearings[:, line]
        work = work[kept] + books["work_in"][0]
        error = work - books["work_in"] - (force[0] - factors.at_rest) * (x[kept] - x[0])
        rows.books["bearings"] += factors.force_factor / factors.length_factor * error
        books["force"], books["work_in"] = force[kept], work

    def _move(self, books: Any, speed: float, time: float) -> None:
        force = self.specimen.move(float(books.displacement), float(speed), float(time))
        self.force.append(force)
        self.displacement.append(float(books.displacement))

    def _bearing(self) -> Bearing:
        for kind in self.bearings:
            if self.specimen.line in kind.lines:
                return kind.bearings[list(kind.lines).index(self.specimen.line)]
        raise IndexError(self.specimen.line)


_Given: TypeAlias = tuple[System, Bearings, Motion, Scheme, Shaking, Actuators, MotionRows]


def _march_with(specimen: Specimen, given: _Given, rows: MotionRows) -> tuple[int, int, str]:
    """March with a specimen outside into all `rows`; return steps done, rows and outcome."""
    measured = _Measured(specimen, *given[:3])
    done, kept, outcome = -1, 0, MEASURE
    try:
        measured.begin()
        while outcome == MEASURE:
            done, kept, outcome = predictor_march(*given, done, kept)
            if outcome == MEASURE:
                measured.take()
        named = OUTCOMES[int(outcome)]
    except SpecimenError as error:
        named = str(error.args[0])
    except KeyboardInterrupt:
        named = INTERRUPTED
    finally:
        specimen.stop()
    if measured.force:
        keep = given[4].keep[: max(done, 0)]
        measured.write(rows.part(0, 1 + kept), np.append(0, 1 + np.flatnonzero(keep)))
    return max(done, 0), kept, named


def _start(
    given: tuple[System, Bearings, Motion, Scheme, Shaking], kept: MotionRows
) -> Callable[..., tuple[int, int, int]]:
    """Keep the structure at rest under the first ground acceleration; return Newmark's march."""
    system, bearings, motion, _, shaking = given
    if system.load.ndim == 1:
        start_motion(system, motion, shaking.ground[0])
        keep_motion(bearings, motion, kept, 0)
        return newmark_march
    at_rest = shaking._replace(ground=shaking.ground[:1])  # no step
    plane_march(*given[:4], at_rest, kept, _no_peaks(system))
    getattr(keep_motion, "py_func", keep_motion)(bearings, motion, kept, 0)
    return plane_march


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
) -> StructureHistory:
    """Integrate the motion of a structure; a failed run has an outcome and its rows until then.

    `ground` [steps + 1], in plan [steps + 1, 2], is the ground acceleration at the ends of steps of
    `dt` [s], linear between [mm/s2]; `ambient` [steps] the mean temperature of each step [degC].
    Of the laboratory and for the predictor-corrector only are `noise` [steps] of the measured force
    [kN], `delay` [s], `compensation` (order of the polynomial) and a `specimen` in place of the
    bearing of its line, whose force and work then are in the rows.
    """
    system = build_system(prepared, lines)
    if method == "predictor-corrector" and system.load.ndim > 1:
        raise ValueError("predictor-corrector: not for a structure in plan")
    motion = new_motion(system)
    bearings = build_bearings(*start_arguments(prepared, lines))
    steps = len(ground) - 1
    keep = np.zeros(steps, dtype=np.bool_)
    keep[keep_every - 1 :: keep_every] = True
    keep[-1] = True
    kept_rows = room_for(system, bearings, 1 + int(keep.sum()), keep_cells=keep_cells)
    scheme = Scheme(BETA[method], GAMMA, TOLERANCE, ITERATIONS, HALVINGS)
    shaking = Shaking(np.ascontiguousarray(ground), dt, ambient, keep)
    after = kept_rows.part(1, len(keep) + 1)
    march = _start((system, bearings, motion, scheme, shaking), kept_rows)
    if method == "predictor-corrector":
        outside = None if specimen is None else specimen.line
        noise = np.zeros(steps) if noise is None else noise
        actuators = _actuators(prepared, noise, len(lines), delay / dt, compensation, outside)
        given = system, bearings, motion, scheme, shaking, actuators, after
        if specimen is not None:
            done, kept, named = _march_with(specimen, given, kept_rows)
        else:
            done, kept, outcome = predictor_march(*given, -1, 0)
            named = OUTCOMES[int(outcome)]
    else:
        peaks = _no_peaks(system)
        done, kept, outcome = march(system, bearings, motion, scheme, shaking, after, peaks)
        named = OUTCOMES[int(outcome)]
    if named == "completed" and not all_physical(bearings, kept_rows.bearings["recoverable"][0]):
        named = NOT_PHYSICAL
    books = motion.books[0]
    return StructureHistory(
        rows=kept_rows.part(0, 1 + kept),
        bearings=bearings,
        outcome=named,
        steps=int(done),
        iterations=int(books.iterations),
        substeps=int(books.substeps),
    )
