"""Peaks of many structures, integrated in lockstep where they are alike.

`run_lanes` puts runs of equal shape side by side, WIDTH at a time (core/lanes says how one kernel
serves both). A run that leaves the lockstep (a step without equilibrium, a bearing too hot, a
number that is not finite) is run alone from its start. The result of a run depends on its input
only, not on the others or its place.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.lanes.memory import (
    WIDTH,
    aligned,
    each_lane,
    refill,
    restore,
    side_by_side,
    twin,
)
from thermobearing.core.records import Floats, Ints, Rows, rows
from thermobearing.core.types import (
    COMPLETED,
    BearingResponse,
    Constants,
    SharedCells,
    Workspace,
    new_workspace,
)
from thermobearing.model.outcomes import NOT_PHYSICAL
from thermobearing.structure import types
from thermobearing.structure.forces import (
    Bearings,
    Kind,
    build_bearings,
    line_kinds,
    split,
    start_again,
    start_states,
)
from thermobearing.structure.newmark import lanes_march, peaks_march, plane_lanes_march, plane_march
from thermobearing.structure.run import (
    BETA,
    GAMMA,
    HALVINGS,
    ITERATIONS,
    OUTCOMES,
    TOLERANCE,
    AxialHistory,
    Line,
    Method,
    Prepared,
    all_physical,
    axial_history,
    build_sections,
    build_system,
    new_motion,
    room_for,
    start_arguments,
)

COLDEST = -1e9  # degC: below every temperature, where the largest one begins
WARMEST = 1e9  # degC: above every temperature, where the lowest one begins


@dataclass(frozen=True)
class Run:
    """A structure and its ground motion."""

    prepared: Prepared
    lines: Sequence[Line]  # one per bearing line of the structure
    # [steps + 1], or [steps + 1, 2] in plan: acceleration at the ends of steps [mm/s2], linear
    # between
    ground: Floats
    dt: float  # of the steps [s]
    ambient: float  # temperature [degC]
    # [p, n], or [p, n, 2] in plan: displacements to watch besides bearings and hinges, per
    # coordinate; the coordinates themselves by default. [p] 1 for those that the ground carries, so
    # that its acceleration is added; 0 (by default) for differences and rotations.
    places: Floats | None = None
    carried: Floats | None = None
    method: Method = "average-acceleration"  # of Newmark
    # [steps + 1] ground acceleration upwards [mm/s2], for lines with axial forces; None: none.
    vertical: Floats | None = None


class RunPeaks(NamedTuple):
    """Peaks of a run, at the start and at the ends of all steps that were done."""

    outcome: str
    steps: int
    iterations: int
    substeps: int
    watches: Rows[types.Watch]  # [p]
    lines: Rows[types.LinePeak]  # [b]
    hinges: Rows[types.HingePeak]  # [h]
    energies: Rows[types.MotionEnergies]  # [1] energies at the end
    bearings: Rows[BearingResponse]  # [b] of the modelled bearing of each line, at the end
    alone: bool  # whether it was run alone
    devices: Rows[types.DevicePeak]  # [d]
    axial: AxialHistory | None  # with the row of the start only; None where none act


def _no_rows(system: types.System, bearings: Bearings) -> types.MotionRows:
    """Return no room for rows; in double precision, as lanes need it."""
    cells: Any = tuple(np.zeros((0, len(kind.lines), 0)) for kind in bearings)
    return room_for(system, bearings, 0)._replace(cells=cells)


def _watched(run: Run) -> tuple[Floats, Floats]:
    """Return the watched displacements, and which of them the ground carries."""
    load = run.prepared.matrices.load
    places = run.places
    if places is None:
        places = np.zeros((len(load), *load.shape))
        places.reshape(*places.shape[:2], -1)[..., 0] = np.eye(len(load))
    carried = np.zeros(len(places)) if run.carried is None else run.carried
    return np.ascontiguousarray(places, np.float64), np.ascontiguousarray(carried, np.float64)


def _empty_peaks(run: Run, system: types.System) -> types.Peaks:
    places, carried = _watched(run)
    peaks = types.Peaks(
        places=places,
        carried=carried,
        watches=rows(types.Watch, len(places), components=system.load.ndim),
        lines=rows(types.LinePeak, len(run.lines), components=system.load.ndim),
        hinges=rows(types.HingePeak, len(system.hinges)),
    )
    peaks.lines["rubber_temperature"] = peaks.lines["lead_temperature"] = COLDEST
    peaks.lines["coldest_lead"] = WARMEST
    return peaks


def _none_kept(run: Run) -> NDArray[np.bool_]:
    return np.zeros(len(run.ground) - 1, dtype=np.bool_)


def _stored_in(kinds: Sequence[tuple[Ints, Any]], lines: int) -> Floats:
    """Return the energy stored in the bearings of all lines [b]."""
    energies = np.zeros(lines)
    for numbers, states in kinds:
        energies[numbers] = states.response["recoverable"][:, 0]
    return energies


def _modelled_responses(bearings: Bearings, lines: int) -> Rows[BearingResponse]:
    """Return the records of the modelled bearings of all lines [b]."""
    components = bearings[0].states.response["displacement"].ndim - 1
    response = rows(BearingResponse, lines, components=components)
    for kind in bearings:
        for m, line in enumerate(kind.lines):
            response[int(line)] = kind.states.response[m, 0]
    return response


def _build_sections(run: Run, rows_kept: int = 0) -> types.Sections:
    """Return the axial forces of a run at its start."""
    return build_sections(run.prepared.structure, run.lines, rows_kept, run.vertical)


def _build_scheme(run: Run, halvings: int) -> types.Scheme:
    return types.Scheme(BETA[run.method], GAMMA, TOLERANCE, ITERATIONS, halvings)


def _collect_peaks(
    bearings: Bearings,
    energies: Any,
    peaks: Sequence[Any],
    device_peaks: Any,
    axial: AxialHistory | None,
    stored: Floats,
    steps: int,
    outcome: int,
) -> RunPeaks:
    """Return the peaks of a run alone from its records; `stored` [b] is the energy at its start."""
    outcome_name = OUTCOMES[outcome]
    if outcome_name == "completed" and not all_physical(bearings, stored):
        outcome_name = NOT_PHYSICAL
    watches, lines, hinges = peaks
    return RunPeaks(
        outcome=outcome_name,
        steps=steps,
        iterations=int(energies["iterations"][0]),
        substeps=int(energies["substeps"][0]),
        watches=watches,
        lines=lines,
        hinges=hinges,
        energies=energies,
        bearings=_modelled_responses(bearings, len(stored)),
        alone=True,
        devices=device_peaks,
        axial=axial,
    )


def run_peaks(run: Run) -> RunPeaks:
    """Integrate one structure alone: the steps of `run_structure`, bit for bit, without its rows.

    Energies and bearings of a run that ends early are those of its last full step, for which
    the steps up to there are done again.
    """
    _check_method(run)
    peaks, _ = _marched(run, 0)
    if peaks.steps == len(run.ground) - 1:
        return peaks
    # The run ended within a step: `peaks` has the last full step, but energies and bearings do not.
    virgin = build_bearings(*start_arguments(run.prepared, run.lines))
    energies, ended = rows(types.MotionEnergies, 1), _modelled_responses(virgin, len(run.lines))
    if peaks.steps > 0:
        _, kept = _marched(run, peaks.steps)
        energies = kept.energies
        for line in range(len(run.lines)):
            ended[line] = kept.bearings[0, line]
    return peaks._replace(energies=energies, bearings=ended)


def _marched(run: Run, kept: int) -> tuple[RunPeaks, types.MotionRows]:
    """Return the peaks of a run, and its state after `kept` steps (0: none) as a row."""
    system = build_system(run.prepared, run.lines)
    system = system._replace(sections=_build_sections(run, min(kept, 1)))
    bearings = build_bearings(*start_arguments(run.prepared, run.lines))
    motion, peaks = new_motion(system), _empty_peaks(run, system)
    air = np.full(len(run.ground) - 1, run.ambient)
    shaking = types.Shaking(np.ascontiguousarray(run.ground), float(run.dt), air, _none_kept(run))
    stored = _stored_in([(kind.lines, kind.states) for kind in bearings], len(run.lines))
    room = room_for(system, bearings, min(kept, 1))
    if kept:
        shaking.keep[kept - 1] = True
    march = peaks_march if system.load.ndim == 1 else plane_march
    scheme = _build_scheme(run, HALVINGS)
    steps, _, outcome = march(system, bearings, motion, scheme, shaking, room, peaks)
    return _collect_peaks(
        bearings,
        motion.energies,
        peaks[2:],
        motion.device_peaks,
        axial_history(system.sections, 0),
        stored,
        int(steps),
        int(outcome),
    ), room


def _check_method(run: Run) -> None:
    if run.method not in ("average-acceleration", "linear-acceleration"):
        raise ValueError(f"{run.method}: peaks are those of Newmark's method")


T = TypeVar("T")


def _constants_shape(constants: Constants) -> Any:
    """Return what bearings in lockstep have in common: shapes, integers and choices."""
    rubber = constants.rubber
    cells: Any = constants.layer_cells
    ends: Any = constants.lead_cells
    modes: Any = constants.lead_modes
    places = [(cells, name) for name in ("first", "last", "upper_middle", "lower_middle")]
    places += [(ends, "cell"), (ends, "port"), (modes, "port"), (modes, "second_port")]
    return (
        *(rows_[name].tobytes() for rows_, name in places),
        len(constants.law),
        len(constants.cells.capacity),
        constants.lead_ports,
        constants.side_implicit,
        constants.heat_source,
        rubber.monotone,
        rubber.closed_loops,
        rubber.integrator,
        (rubber.law, rubber.law_in_plane),
        rubber.virgin,
        constants.lead.published,
        constants.viscous.heats,
        rubber.unloading_curvature > 0.0,  # from here on: choices made once for all runs
        rubber.unloading_curvature < 0.0,
        constants.lead.cores > 0.0,
        constants.lead.softening == 0.0,
        constants.lead.softening == constants.lead.softening_beyond,
        constants.lead.side_conductance == 0.0,
        constants.viscous.stiffness > 0.0,
    )


def _likeness(run: Run, shapes: dict[int, Any]) -> Any:
    """Return what runs in one lockstep have in common.

    `shapes` keeps that of constants by their address, for other runs with the same ones.
    """
    _check_method(run)
    matrices, constants = run.prepared.matrices, [line.constants for line in run.lines]
    sizes = run.ground.shape, len(matrices.load)
    watched = None if run.places is None else len(run.places)
    moving = tuple(bool(line.speed != 0.0) for line in run.lines)
    kinds: list[Any] = []
    for numbers in line_kinds(constants):
        kind_constants = constants[numbers[0]]
        if id(kind_constants) not in shapes:
            # Cells are shared in a lockstep (`SharedCells`), so they must be alike to the bit.
            heat = b"".join(array.tobytes() for array in kind_constants.cells)
            shapes[id(kind_constants)] = _constants_shape(kind_constants), heat
        kinds.append((tuple(numbers), shapes[id(kind_constants)]))
    devices = tuple(
        (device.kind, len(device.oil()[0])) for device in run.prepared.structure.device_list
    )
    hinges = len(matrices.hinge_rows)
    pressed = run.vertical is not None, *(_axial_shape(line) for line in run.lines)
    return sizes, hinges, devices, watched, run.dt, run.method, moving, pressed, *kinds


def _axial_shape(line: Line) -> Any:
    """Return what lines in one lockstep have in common of their axial forces."""
    load = line.pressed
    if load is None:
        return None
    column = load.columns[0]
    choices = load.moves, load.overturns, load.dowelled, column.circular, column.by_overlap
    return len(load.dead_loads), *map(int, choices)


def run_lanes(runs: Sequence[Run]) -> list[RunPeaks]:
    """Return the peaks of runs in their order, WIDTH in lockstep where they are alike.

    Numbers differ from those of `run_peaks` by rounding (1e-12 of the largest), and never by
    the other runs.
    """
    locksteps: dict[Any, Lockstep] = {}
    waiting: dict[Any, list[int]] = {}
    results: dict[int, RunPeaks] = {}
    shapes: dict[int, Any] = {}

    def _finish(key: Any, together: list[int]) -> None:
        peaks = locksteps[key].shake([runs[k] for k in together])
        results.update(zip(together, peaks, strict=True))

    for number, run in enumerate(runs):
        key = _likeness(run, shapes)
        if key not in locksteps:
            locksteps[key] = Lockstep(run)
        waiting.setdefault(key, []).append(number)
        if len(waiting[key]) == WIDTH:
            _finish(key, waiting.pop(key))
    for key, numbers in waiting.items():
        _finish(key, numbers)
    return [results[number] for number in range(len(runs))]


def with_shared_cells(constants: Constants) -> Constants:
    """Return constants for a lockstep of bearings with the same cells."""
    return constants._replace(cells=SharedCells(*constants.cells))


def _scratch(kind: Kind) -> tuple[Workspace, Floats, Floats]:
    """Return scratch for the lines of a kind, as `split` takes it."""
    constants = kind.constants
    elastic, hysteretic = np.zeros((2, len(kind.lines), len(constants.multiplicity)))
    components = kind.states.response["displacement"].ndim - 1
    return new_workspace(constants, components), elastic, hysteretic


def _each_axial(
    joined: types.Sections, starts: Sequence[types.Sections]
) -> list[AxialHistory | None]:
    """Return the axial forces of each run in lockstep, from lanes at the end and from its start."""
    if not len(starts[0].sections):
        return [None] * len(starts)
    ended = joined.peaks, joined.energies, joined.supports
    start = starts[0]
    rows_of_runs = each_lane(ended, (start.peaks, start.energies, start.supports))
    return [
        axial_history(sections._replace(peaks=peaks, energies=energies, supports=supports), kept=0)
        for sections, (peaks, energies, supports) in zip(starts, rows_of_runs, strict=True)
    ]


class Lockstep:
    """Runs of one shape in lockstep, WIDTH at a time; inputs that they share are stored."""

    def __init__(self, run: Run) -> None:
        system = build_system(run.prepared, run.lines)
        self.keep = _none_kept(run)
        constants, temperatures, leads, _, components = start_arguments(run.prepared, run.lines)
        self.bearings = build_bearings(constants, temperatures, leads, None, components)
        self.motion, self.peaks = new_motion(system), _empty_peaks(run, system)
        originals = tuple((kind.durations, *_scratch(kind)) for kind in self.bearings)
        self.scratch = side_by_side([(originals, self.motion, self.peaks)] * WIDTH)
        self.rows = side_by_side([_no_rows(system, self.bearings)] * WIDTH)
        # What a march writes into; the originals above serve the next runs.
        self.lanes = twin(self.scratch)
        self.states = [side_by_side([kind.states] * WIDTH) for kind in self.bearings]
        self.trials = twin(tuple(self.states))
        work = self.lanes[0]
        self.split = [
            split(scratch, elastic, hysteretic, self.states[k], self.trials[k])
            for k, (_, scratch, elastic, hysteretic) in enumerate(work)
        ]
        self.ground, self.dt = side_by_side([(run.ground, float(run.dt))] * WIDTH)
        self.ambient = aligned((len(self.keep), WIDTH), np.float64)
        self._systems: dict[Any, types.System] = {}
        self._joined: dict[Any, tuple[Sequence[Any], Any]] = {}

    def shake(self, runs: Sequence[Run]) -> list[RunPeaks]:
        """Return the peaks of at most WIDTH runs; empty lanes repeat the last."""
        # All lanes run: those without a run of their own repeat one, and are not read.
        filled = [*runs, *[runs[-1]] * (WIDTH - len(runs))]
        starts = [self._start(run) for run in filled]
        restore(self.lanes, self.scratch)
        _, motion, peaks = self.lanes
        places, carried = side_by_side([_watched(run) for run in filled])
        bearings = self._bearings(filled, starts)
        outcomes = aligned((1, WIDTH), np.float64)
        march = lanes_march if runs[0].ground.ndim == 1 else plane_lanes_march
        system = self._once([self._system(run) for run in filled])
        sections = [_build_sections(run) for run in filled]
        if len(sections[0].sections):
            # They move and have memories: none of another group of runs, and not shared.
            system = system._replace(sections=side_by_side(sections))
        steps = march(
            system,
            bearings,
            motion,
            _build_scheme(filled[0], 0),
            self._shaking(filled),
            self.rows,
            peaks._replace(places=places, carried=carried),
            outcomes,
        )
        states = tuple(kind.states for kind in bearings)
        records = states, motion.energies, peaks[2:], motion.device_peaks
        like = starts[0], self.motion.energies, self.peaks[2:], self.motion.device_peaks
        run_records = each_lane(records, like)
        axial = _each_axial(system.sections, sections)
        return [
            self._peaks(run, starts[lane], *run_records[lane], axial[lane], int(steps))
            if outcomes[0, lane] == COMPLETED
            else run_peaks(run)
            for lane, run in enumerate(runs)
        ]

    def _start(self, run: Run) -> tuple[Any, ...]:
        """Return the states of the bearings of a run at its start."""
        constants, temperatures, leads, begun, components = start_arguments(run.prepared, run.lines)
        if any(state is not None for state in begun):
            return start_states(constants, temperatures, leads, begun, components)
        return start_again(self.bearings, constants, temperatures, leads)

    def _shaking(self, runs: Sequence[Run]) -> types.Shaking:
        refill(self.ground, [run.ground for run in runs])
        self.ambient[:] = [run.ambient for run in runs]
        return types.Shaking(self.ground, self.dt, self.ambient, self.keep)

    def _bearings(self, runs: Sequence[Run], starts: Sequence[Any]) -> Any:
        """Return the bearings of some runs as one, with their states at the start."""
        kinds = []
        for k, kind in enumerate(self.bearings):
            line = int(kind.lines[0])
            constants = self._once([run.lines[line].constants for run in runs], with_shared_cells)
            states, durations = self.states[k], self.lanes[0][k][0]
            refill(states, [start[k] for start in starts])
            restore(self.trials[k], states)
            kinds.append(Kind(constants, kind.lines, durations, states, self.split[k]))
        return tuple(kinds)

    def _system(self, run: Run) -> types.System:
        """Return the structure of a run; runs with the same one and the same lines share it."""
        lines = tuple((line.speed, line.warmer, id(line.begun)) for line in run.lines)
        key = id(run.prepared), lines
        if key not in self._systems:
            self._systems[key] = build_system(run.prepared, run.lines)
        return self._systems[key]

    def _once(self, inputs: Sequence[T], change: Callable[[T], T] | None = None) -> T:
        """Return inputs that are only read, side by side; made once for the same ones."""
        # Inputs are told apart by address. They are kept with the result, so that no other gets
        # theirs.
        key = tuple(map(id, inputs))
        if key not in self._joined:
            parts = [change(entry) for entry in inputs] if change else inputs
            self._joined[key] = inputs, side_by_side(parts)
        joined: T = self._joined[key][1]
        return joined

    def _peaks(
        self,
        run: Run,
        start: Any,
        states: Any,
        energies: Any,
        noted_peaks: Any,
        device_peaks: Any,
        axial: AxialHistory | None,
        steps: int,
    ) -> RunPeaks:
        ended = tuple(
            kind._replace(constants=run.lines[int(kind.lines[0])].constants, states=state)
            for kind, state in zip(self.bearings, states, strict=True)
        )
        lines = [kind.lines for kind in self.bearings]
        stored = _stored_in(list(zip(lines, start, strict=True)), len(run.lines))
        peaks = _collect_peaks(
            ended, energies, noted_peaks, device_peaks, axial, stored, steps, COMPLETED
        )
        return peaks._replace(alone=False)
