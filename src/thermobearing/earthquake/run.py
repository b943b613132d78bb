"""The runs of an analysis: structure, bearings, motions, weather -> a result.

    structure -> matrices, modes, damping;   bearing -> constants of the one coupled step
    every bearing x motion x temperature -> time integration -> histories -> one dataset

Read `run_earthquake` first; `bridge` and `hybrid` (analysis.py) make the case that it carries out.
The integration is in structure/, the step of the bearing is the same as in every other analysis
(core/step.py).

At rest the heat model is linear: the temperatures after an hour are a matrix times those before it
(cells, lead, and the memory of lead) plus two columns times the ambient temperature at its ends.
The coupled step gives the matrix from unit temperatures, in the growing steps of a rest, so that
`soaked_hours` takes one pass through years of weather and has no second heat model.
"""

import os
import pathlib
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple, Unpack

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import exposed_bilinear
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.state import RubberState
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.schema import check_workers
from thermobearing.climate.hourly import DAY, HOUR, Hourly
from thermobearing.climate.readers import read_air
from thermobearing.core.march import hours_at_rest, march
from thermobearing.core.records import Ints
from thermobearing.core.types import Constants, Floats, Path, State, new_state, new_workspace
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.history import REST_STEP, build_segments, cut_rests, rest_in, room_for
from thermobearing.cyclic.protocol import LARGEST_STRAIN, CyclicTest, lengths
from thermobearing.earthquake.axial import is_unstable, pressed_line, with_axial_outcome
from thermobearing.earthquake.case import (
    EarthquakeCase,
    Laboratory,
    make_earthquake_case,
    settle_surroundings,
)
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.measures import drift, largest, pier_peaks, run_name
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.earlier import BilinearParameters, Model, bilinear_constants
from thermobearing.model.effort import analysis_too_much
from thermobearing.model.handover import begun_from
from thermobearing.model.options import ModelKeywords, ModelOptions, build_model, model_table
from thermobearing.model.outcomes import (
    INTERRUPTED,
    NOT_PHYSICAL,
    PIER_BEYOND_LIMIT,
    UNSTABLE,
)
from thermobearing.model.stack import Stack
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.opensees.specimen import TcpSpecimen, TwinCheck
from thermobearing.results.base import COMPLETED
from thermobearing.structure.model import (
    along,
    list_hinges,
)
from thermobearing.structure.run import (
    AxialHistory,
    Line,
    Prepared,
    StructureHistory,
    prepare_structure,
    run_structure,
    start_under_load,
)

Progress = Callable[[int, int], None]
WORKERS = 2  # at least
STRAIN_LIMIT, PIER_LIMIT = "strain", "pier"  # limits of a bearing that tears, and of a pier
BILINEAR_STRAIN = 100.0  # largest of a bilinear bearing: a design may begin far off
AT_REST = 1e9  # clock of a core whose half-space has settled [s]
SPIN_UP = 60 * DAY  # hours before the first of a typical year
# Any other end of a run after a bearing has become unstable is a consequence of that.
NOT_OF_INSTABILITY = (COMPLETED, NOT_PHYSICAL, INTERRUPTED)
BLIND = np.zeros(1)  # temperature of a bilinear bearing, which has none: no rounding there [degC]


@dataclass(frozen=True)
class Device:
    """A bearing with its constants; `stack` is None for a bilinear one, which has no heat.

    `state` is that of its rubber where it is stated; the constants contain it.
    """

    bearing: Bearing | BilinearBearing
    constants: Constants
    stack: Stack | None
    state: RubberState | None = None

    @property
    def has_lead(self) -> bool:
        """Whether it has lead cores with a temperature."""
        return self.stack is not None and self.constants.lead.cores > 0.0


class Shaking(NamedTuple):
    """A ground motion at the ends of the steps."""

    motion: GroundMotion | MotionPair
    dt: float  # of the steps [s]
    ground: Floats  # [steps + 1] acceleration [mm/s2], or [steps + 1, 2] along x and y
    factor: float = 1.0  # by which the motion was multiplied, in `ground` already
    vertical: Floats | None = None  # [steps + 1] upwards [mm/s2], where it acts


class OneLine(NamedTuple):
    """The bearings of one line in one run, at the start [degC]."""

    device: Device
    temperature: Floats  # [cells]
    lead: float | None
    ambient: float


@dataclass(frozen=True)
class Task:
    """One run; a plain record, so that any executor can take it."""

    prepared: Prepared
    device: Device  # of the analysis; lines may have another one
    shaking: Shaking
    ambient: float
    lines: tuple[OneLine, ...]
    case: EarthquakeCase
    mode: str = ""  # of the laboratory; none without one
    direction: str = ""  # of a structure in plan that is analysed in one direction alone

    def label(self, bearing: str = "") -> str:
        """Return the name of the run in sentences."""
        motion = self.shaking.motion.name
        return run_name(bearing, motion, self.ambient, self.mode, self.direction)

    @cached_property
    def reported_line(self) -> int:
        """Number of the line whose histories are kept."""
        return self.case.reported_line_number

    @cached_property
    def noise(self) -> Floats | None:
        """Error of the measured force in each step [kN]; None without one."""
        lab, steps = self.case.laboratory, len(self.shaking.ground) - 1
        if lab is None or lab.force_noise <= 0.0:
            return None
        return lab.force_noise * np.random.default_rng(lab.seed).standard_normal(steps)

    @property
    def reported(self) -> OneLine:
        """That line."""
        return self.lines[self.reported_line]


def build_device(
    case: EarthquakeCase, bearing: Bearing | BilinearBearing, state: RubberState | None = None
) -> Device:
    """Return a bearing of the case with the constants of the coupled step.

    `state` of its rubber; None: that of the analysis.
    """
    if isinstance(bearing, BilinearBearing):
        exposed = exposed_bilinear(bearing, case.analysis.exposure)
        parameters = BilinearParameters(
            exposed.strength, exposed.post_yield_stiffness, exposed.initial_stiffness
        )
        return Device(bearing, bilinear_constants(parameters), None)
    options = case.analysis
    if state is not None:
        options = options.model_copy(update={"state": state})
    model = build_model(bearing, options, backbone=bilinear_parameters)
    return Device(bearing, model.constants, model.stack, options.state)


def build_shaking(
    case: EarthquakeCase, number: int, motion: GroundMotion | MotionPair, direction: str = ""
) -> Shaking:
    """Return a motion of the case, cut and scaled; of a pair both components, or one direction."""
    steps, dt = case.count_steps(motion)
    times, factor = dt * np.arange(steps + 1), case.motions[number].factor
    upwards = None
    if case.analysis.axial == "vertical":
        record = case.motions[number].load_vertical()
        assert record is not None
        upwards = factor * np.interp(times, record.time, record.acceleration)
    if isinstance(motion, MotionPair) and direction:
        motion = motion.along("y" if direction == "y" else "x")
    if isinstance(motion, MotionPair):
        components = [np.interp(times, motion.time, values) for values in motion.rotated().T]
        return Shaking(motion, dt, factor * np.column_stack(components), factor, upwards)
    ground = factor * np.interp(times, motion.time, motion.acceleration)
    return Shaking(motion, dt, ground, factor, upwards)


def _soaked(device: Device, weather: Ambient) -> tuple[Floats, float | None]:
    """Return the temperatures of cells and lead at the end of a weather, the bearing at rest."""
    cells = len(device.constants.cells.capacity)
    if device.stack is None:
        return BLIND, None
    start = float(weather.time[0])
    # The integration begins at time zero, a weather at any time.
    shifted = Ambient.series(weather.time - start, weather.temperature)
    initial = np.full(cells, weather.temperature[0])
    history = rest_in(device.constants, shifted, float(shifted.time[-1]), initial)
    lead = history.state.branches[0].lead_temperature if device.constants.lead.cores > 0.0 else None
    return history.state.temperature, lead


def run_task(task: Task) -> StructureHistory:
    """Carry out one run; never raises for a failed analysis.

    InputError : nothing answers at the address of a specimen outside.
    """
    case, shaking = task.case, task.shaking
    lab, steps = case.laboratory or Laboratory(), len(shaking.ground) - 1
    outside = None
    if lab.specimen is not None:
        check = TwinCheck(task.reported.device.bearing, task.reported.ambient)
        outside = TcpSpecimen(
            lab.specimen,
            task.reported_line,
            check,
            time_out=lab.time_out,
            displacement_limit=lab.displacement_limit,
            force_limit=lab.force_limit,
        )
    history = run_structure(
        task.prepared,
        lines_to_shake(task),
        shaking.ground,
        shaking.dt,
        np.full(steps, task.ambient),
        method=case.analysis.method,
        noise=task.noise,
        delay=lab.delay,
        compensation=lab.compensation,
        specimen=outside,
        keep_cells="cells" in case.analysis.keep,
        vertical=shaking.vertical,
    )
    if ended_unstable(history.outcome, history.axial):
        return replace(history, outcome=UNSTABLE)
    # Instruments were zeroed after an earlier test, where the bearing kept a displacement.
    if case.initial_state is not None and case.initial_state.zero:
        specimen_displacement = history.rows.bearings["displacement"]
        specimen_displacement = (
            specimen_displacement[..., 0] if case.components > 1 else specimen_displacement
        )
        specimen_displacement -= case.initial_state.zero
    if history.outcome != COMPLETED:
        return history if outside is None else replace(history, note=outside.note)
    displacements = [
        largest(lengths(history.bearing(b)["displacement"])) for b in range(len(task.lines))
    ]
    rotations = largest_rotations(history)
    top_displacements = [row["pier_part_displacement_max"] for row in pier_peaks(task, history)]
    outcome = find_outcome(task, displacements, rotations, top_displacements)
    return replace(history, outcome=with_axial_outcome(outcome, history.axial))


def largest_rotations(history: StructureHistory) -> list[float]:
    """Return the largest rotation of each hinge [rad]."""
    return [largest(history.hinge(h)["rotation"]) for h in range(history.rows.hinges.shape[1])]


def ended_unstable(outcome: str, axial: AxialHistory | None) -> bool:
    """Return whether a run, which ended early or not, is one that became unstable."""
    return outcome not in NOT_OF_INSTABILITY and is_unstable(axial)


def lines_to_shake(task: Task) -> list[Line]:
    """Return the bearing lines of a run as the structure takes them."""
    case, lab = task.case, task.case.laboratory
    begun = None
    if case.initial_state is not None:
        begun = begun_from(case.initial_state, task.device.constants, components=case.components)
    return [
        Line(
            line.device.constants,
            line.temperature,
            line.lead,
            speed=lab.speed if lab is not None and task.mode == "pd" else 0.0,
            warmer=line.ambient - task.ambient,
            begun=begun,
            pressed=pressed_line(case, bearing_line, line.device.bearing),
        )
        for line, bearing_line in zip(task.lines, case.structure.bearings, strict=True)
    ]


def find_outcome(
    task: Task,
    displacements: Sequence[float],
    rotations: Sequence[float],
    top_displacements: Sequence[float],
) -> str:
    """Return the outcome of a run that reached its end: whether the model holds that far.

    The arguments are those of `passed_limits`.
    """
    return outcome_by_limits(passed_limits(task, displacements, rotations, top_displacements))


def outcome_by_limits(limits: Collection[str]) -> str:
    """Return the outcome of a run that reached its end from the limits of `passed_limits`."""
    if STRAIN_LIMIT in limits:
        return NOT_PHYSICAL
    return PIER_BEYOND_LIMIT if PIER_LIMIT in limits else COMPLETED


def passed_limits(
    task: Task,
    displacements: Sequence[float],
    rotations: Sequence[float],
    top_displacements: Sequence[float],
) -> list[str]:
    """Return which limits a run passed up to its end, early or not: "strain" and "pier".

    The peaks of the run show them, but not which of both was passed first.

    `displacements`, `rotations` and `top_displacements` are the largest of each bearing [mm], hinge
    [rad] and pier top [mm].
    """
    structure, limits = task.case.structure, []
    for line, largest_displacement in zip(task.lines, displacements, strict=True):
        largest_strain = BILINEAR_STRAIN if line.device.stack is None else LARGEST_STRAIN
        if largest_displacement / line.device.bearing.total_rubber_thickness > largest_strain:
            limits = [STRAIN_LIMIT]
    hinges = zip(list_hinges(structure), rotations, strict=True)
    ductile = any(
        rotation / hinge.yield_rotation > structure.limits.ductility for hinge, rotation in hinges
    )
    if ductile or drift(task, top_displacements) > structure.limits.drift:
        limits.append(PIER_LIMIT)
    return limits


def _refuse_too_much(
    case: EarthquakeCase, devices: Sequence[Device], motions: Sequence[GroundMotion | MotionPair]
) -> None:
    lines = len(case.structure.bearings) * case.components
    climates = case.climates * len(case.modes) * len(case.directions)
    # A body moves and rocks in each direction; in plan it twists too.
    per_body = 2.0 if case.components == 1 else 5.0
    coordinates = per_body * len(case.structure.bodies)
    runs = []
    for device in devices:
        layers, cells = len(device.constants.multiplicity), len(device.constants.cells.capacity)
        # Some three iterations; elimination takes as long for a number as a cell for 15.
        work = climates * (3.0 * lines * (cells + 5.0 * layers) + coordinates**3 / 15.0)
        profiles = cells if "cells" in case.analysis.keep else 0
        stored = climates * (20.0 + 4.0 * coordinates + lines * (20.0 + layers + profiles))
        runs += [(float(case.count_steps(motion)[0]), work, stored) for motion in motions]
    message = analysis_too_much(runs)
    if message:
        raise InputError(message, case.command)


def build_tasks(case: EarthquakeCase) -> list[Task]:
    """Return all runs of a case: bearings, motions, temperatures, modes, directions."""
    devices = [build_device(case, bearing) for bearing in case.bearings]
    plan = case.structure.plan
    motions = [motion.load_pair() if plan else motion.load() for motion in case.motions]
    _refuse_too_much(case, devices, motions)
    direction_cases = [(name, *_prepare(case, name)) for name in case.directions]
    # A line with a bearing of the analysis shares its device: lines of one device are one kind of
    # bearing in the integration.
    device_by_name = {device.bearing.name: device for device in devices}
    line_devices: list[Device | None] = []
    for item in case.lines:
        line_device = None if item.bearing is None else device_by_name.get(item.bearing.name)
        differs = (
            line_device is None or line_device.bearing != item.bearing or item.state is not None
        )
        if item.bearing is not None and differs:
            line_device = build_device(case, item.bearing, item.state)
        line_devices.append(line_device)
    weather = None if case.weather is None else read_air(case.weather)
    tasks = []
    for device in devices:
        ambients = case.ambient if weather is None else [float(weather.temperature[-1])]
        climates = []
        for ambient in ambients:
            start = partial(one_line, case, ambient=ambient, weather=weather)
            climates.append((ambient, prepared_lines(case, device, line_devices, start)))
        for number, motion in enumerate(motions):
            shaken = [
                (direction_case, build_shaking(case, number, motion, direction_case[0]))
                for direction_case in direction_cases
            ]
            tasks += [
                Task(prepared, device, shaking, ambient, lines, own_case, mode, direction)
                for ambient, lines in climates
                for mode in case.modes
                for (direction, own_case, prepared), shaking in shaken
                # A single record has no component in the other direction: that run would be still.
                if not direction or shaking.ground.any()
            ]
    _refuse_dead_loads(case, tasks)
    return tasks


def _refuse_dead_loads(case: EarthquakeCase, tasks: Sequence[Task]) -> None:
    """Refuse dead loads that are above the critical load at the start."""
    faults = []
    for task in tasks if case.analysis.has_axial else ():
        bearings = task.case.structure.bearings
        for line, bearing_line in zip(lines_to_shake(task), bearings, strict=True):
            if line.pressed is None:
                continue
            start = start_under_load(line, bearing_line.scale)
            if start.axial_force > start.critical_load:
                faults.append(
                    f"bearings, {bearing_line.name}: unstable under its dead load, "
                    f"{line.pressed.dead_loads.max():.4g} kN; the critical load of "
                    f'"{task.device.bearing.name}" at {task.ambient:g} degC is '
                    f"{start.critical_load / bearing_line.scale**2:.4g} kN"
                )
    if faults:
        raise InputError(list(dict.fromkeys(faults)), case.command)


def _prepare(case: EarthquakeCase, direction: str) -> tuple[EarthquakeCase, Prepared]:
    """Return the case of a direction alone, or the case itself, and its structure."""
    if direction:
        structure = along(case.structure, "y" if direction == "y" else "x")
        case = case.model_copy(update={"structure": structure})
    return case, prepare_structure(case.structure, case.analysis.mass, case.analysis.damping)


def prepared_lines(
    case: EarthquakeCase,
    device: Device,
    line_devices: Sequence[Device | None],
    start: Callable[[Device], OneLine],
) -> tuple[OneLine, ...]:
    """Return all lines of a run; `line_devices` are those of `case.lines`, or None."""
    common = start(device)
    line_settings = {
        item.line: (item, line_device)
        for item, line_device in zip(case.lines, line_devices, strict=True)
    }
    lines = []
    for line in case.structure.bearings:
        if line.name not in line_settings:
            lines.append(common)
            continue
        item, line_device = line_settings[line.name]
        # The bearing of the analysis, but with rubber in the state of this line.
        if line_device is None and item.state is not None and device.stack is not None:
            line_device = build_device(case, device.bearing, item.state)
        weather = None if item.weather is None else read_air(item.weather)
        if item.ambient is None and weather is None:
            lines.append(common if line_device is None else start(line_device))
            continue
        ambient = float(weather.temperature[-1]) if weather is not None else item.ambient
        assert ambient is not None
        lines.append(one_line(case, line_device or device, ambient, weather))
    return tuple(lines)


def one_line(
    case: EarthquakeCase, device: Device, ambient: float, weather: Ambient | None
) -> OneLine:
    """Return a line as an earlier test or its weather left it, or at the ambient temperature."""
    earlier_state = case.initial_state
    if earlier_state is not None:
        return OneLine(
            device, np.array(earlier_state.temperature), earlier_state.lead_temperature, ambient
        )
    if weather is not None:
        return OneLine(device, *_soaked(device, weather), ambient)
    cells = len(device.constants.cells.capacity)
    return OneLine(
        device, BLIND if device.stack is None else np.full(cells, ambient), None, ambient
    )


def run_earthquake(
    case: EarthquakeCase, *, executor: Executor | None = None, progress: Progress | None = None
) -> EarthquakeResult:
    """Carry out an analysis; never raises for a failed run (see `EarthquakeResult.outcome`).

    Runs are on threads by default, since the compiled integration releases the lock of the
    interpreter; `progress` is called with (runs done, all runs). A test of a specimen outside is
    on the thread of the caller, whose keyboard interrupt stops the specimen.
    """
    check_workers("run_earthquake()", executor, progress)
    tasks = build_tasks(case)
    if case.specimen is not None:
        return label_analysis(case, tasks, [run_task(task) for task in tasks])
    histories: list[StructureHistory] = []
    threads = None if executor else ThreadPoolExecutor(max(WORKERS, os.cpu_count() or 1))
    pool: Any = executor or threads
    # In the order of tasks, not of completion: after an interrupt the runs that are kept are the
    # first ones, as `label_analysis` expects.
    try:
        futures = [pool.submit(run_task, task) for task in tasks]
        for future in futures:
            histories.append(future.result())
            if progress:
                progress(len(histories), len(tasks))
    except KeyboardInterrupt:
        for future in futures:
            future.cancel()
    finally:
        if threads:
            threads.shutdown(cancel_futures=True)
    return label_analysis(case, tasks, histories)


class _HourMap(NamedTuple):
    """An hour of rest: `kept @ before + early * ambient + late * ambient an hour later`."""

    kept: Floats  # [n, n]
    early: Floats  # [n]
    late: Floats  # [n]


class Soaked(NamedTuple):
    """A bearing at some hours."""

    temperature: Floats  # [hours, cells]
    lead: Floats | None  # [hours]; None without

    def at(self, place: int) -> tuple[Floats, float | None]:
        """Return temperatures of cells and lead at one of the hours, as `soaked`."""
        return self.temperature[place], None if self.lead is None else float(self.lead[place])


def _hour_map(constants: Constants) -> _HourMap:
    size = len(constants.cells.capacity) + _has_lead(constants) + len(constants.lead_modes)
    zeros, zero_ambient = np.zeros(size), Ambient(np.array([0.0, HOUR]), np.zeros(2))
    kept = np.column_stack([_after_an_hour(constants, unit, zero_ambient) for unit in np.eye(size)])
    ends = [
        Ambient(np.array([0.0, HOUR]), np.array(ambient)) for ambient in ([1.0, 0.0], [0.0, 1.0])
    ]
    early, late = (_after_an_hour(constants, zeros, ambient) for ambient in ends)
    return _HourMap(np.ascontiguousarray(kept), early, late)


def _has_lead(constants: Constants) -> bool:
    return constants.lead.cores > 0.0


def _after_an_hour(constants: Constants, before: Floats, ambient: Ambient) -> Floats:
    """Return temperatures after an hour at rest [degC]: cells, lead, terms of lead."""
    # The vector is in the order of `_vector`: cells, lead, memory of the lead's half-space.
    cells = len(constants.cells.capacity)
    state = new_state(constants, before[:cells])
    scratch = new_state(constants, before[:cells])
    if _has_lead(constants):
        state.branches["lead_temperature"] = state.response["lead_temperature"] = before[cells]
        state.branches["clock"] = AT_REST
        state.ends[:] = before[cells + 1 :]
    rest_step: Any = {"step": "rest", "duration": HOUR}
    segment = build_segments(CyclicTest(dt=REST_STEP, steps=[rest_step]), 1.0)[0]
    keep = np.zeros(len(segment.x), dtype=bool)
    segment, keep, _ = cut_rests(constants, segment, keep, 0.0)
    path = Path(segment.x, segment.dt, ambient.means(0.0, segment.dt), keep, 0.0)
    march(constants, new_workspace(constants), state, scratch, path, room_for(constants, 1, ()))
    return _vector(constants, state)


def _vector(constants: Constants, state: State) -> Floats:
    lead = state.branches["lead_temperature"] if _has_lead(constants) else np.zeros(0)
    return np.concatenate([state.temperature, lead, state.ends])


def soaked_hours(device: Device, weather: Hourly, hours: Ints | None = None) -> Soaked:
    """Return the temperatures of a bearing at some hours (all by default) of a weather.

    It is in the weather from hour 0, then at the ambient temperature; in a typical year, from sixty
    days earlier. InputError: an hour that the weather does not have.
    """
    requested = np.arange(len(weather)) if hours is None else np.asarray(hours, dtype=np.int64)
    if len(requested) and not 0 <= requested.min() <= requested.max() < len(weather):
        raise InputError(f"hours must be 0 to {len(weather) - 1}", weather.name)
    if device.stack is None:
        return Soaked(np.zeros((len(requested), 1)), None)
    constants = device.constants
    # A typical year recurs: the bearing has been in it for sixty days before its first hour.
    before = SPIN_UP if weather.recurs else 0
    ambient = np.take(weather.temperature, np.arange(-before, len(weather)), mode="wrap")
    places, inverse = np.unique(requested + before, return_inverse=True)
    hour, state = _hour_map(constants), _uniform(constants, ambient[0])
    kept, temperatures = np.ascontiguousarray(hour.kept.T), np.empty((len(places), len(state)))
    hours_at_rest(
        kept, hour.early, hour.late, ambient, places, state, np.empty_like(state), temperatures
    )
    temperatures = temperatures[inverse]
    cells = len(constants.cells.capacity)
    lead = temperatures[:, cells].copy() if _has_lead(constants) else None
    return Soaked(np.ascontiguousarray(temperatures[:, :cells]), lead)


def history_weights(constants: Constants, hours: int) -> Floats:
    """Return weights [cells and lead, hours + 1] on the ambient temperature at full hours."""
    hour = _hour_map(constants)
    begin = _uniform(constants, 1.0)
    weights = np.zeros((len(begin), hours + 1))
    early, late = hour.early, hour.late
    # Backwards from the last hour: what an hour gives is carried over by all hours after it. Each
    # full hour ends one hour and begins the next, and has weights of both.
    for hours_back in range(hours):
        weights[:, hours - hours_back - 1] += early
        weights[:, hours - hours_back] += late
        early, late, begin = hour.kept @ early, hour.kept @ late, hour.kept @ begin
    weights[:, 0] += begin
    return weights


def soaked_history(
    constants: Constants, weights: Floats, ambient: Floats
) -> tuple[Floats, float | None]:
    """Return temperatures of cells and lead from `history_weights` and hourly temperatures."""
    temperatures = weights @ ambient
    cells = len(constants.cells.capacity)
    return temperatures[:cells].copy(), float(temperatures[cells]) if _has_lead(constants) else None


def _uniform(constants: Constants, ambient: float) -> Floats:
    return _vector(constants, new_state(constants, np.full(len(constants.cells.capacity), ambient)))


@checked
def bearing_weather(
    bearing: str | pathlib.Path | Bearing | BilinearBearing,
    weather: Hourly,
    *,
    model: ModelOptions | Model | None = None,
    **options: Unpack[ModelKeywords],
) -> "pd.DataFrame":
    """Return the temperatures of a bearing at rest in hourly weather: one row an hour.

    Parameters
    ----------
    bearing : str, Path or Bearing
        A name, a file, or a bearing; not a bilinear one, which has no heat.
    weather : Hourly
        From `tb.read_weather` or `tb.generate_weather`.
    model : ModelOptions or str
        As in `tb.bridge` with weather: films of 12 W/(m2 K) at faces and side and 10 mm of cover
        rubber by default.
    exposure, state
        Fields of `ModelOptions`, in place of those of `model`.

    Returns
    -------
    pandas.DataFrame
        Hour, date where it is known, ambient temperature, the mean of the rubber layers, the
        outermost and the innermost one modelled, and lead where there is some [degC].

    Raises
    ------
    InputError
        No such bearing, a bilinear one, an unknown option.

    Examples
    --------
    >>> from thermobearing.climate.generator import generate_weather
    >>> frame = bearing_weather("shen-lhdr-bridge", generate_weather("cold-town", 1, 4))
    >>> frame.columns[2:].tolist()
    ['ambient_degC', 'rubber_degC', 'outer_rubber_degC', 'inner_rubber_degC', 'lead_degC']
    """
    analysis = model_table(model, options)
    table: dict[str, Any] = {"command": "bridge", "bearings": [bearing], "analysis": analysis}
    settle_surroundings(table)
    case = make_earthquake_case(table, "bearing_weather")
    device = build_device(case, case.bearings[0])
    if device.stack is None:
        raise InputError("a bilinear bearing has no temperature", case.bearings[0].name)
    frame, soaked = weather.to_frame(), soaked_hours(device, weather)
    upper, lower = device.stack.middles()
    layers = 0.5 * (soaked.temperature[:, upper] + soaked.temperature[:, lower])
    count = device.constants.multiplicity
    frame["rubber_degC"] = layers @ count / count.sum()
    frame["outer_rubber_degC"], frame["inner_rubber_degC"] = layers[:, 0], layers[:, -1]
    if soaked.lead is not None:
        frame["lead_degC"] = soaked.lead
    return frame
