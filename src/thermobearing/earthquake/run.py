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
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import exposed_bilinear
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.schema import check_workers
from thermobearing.climate.hourly import DAY, HOUR, Hourly
from thermobearing.climate.readers import read_air
from thermobearing.core.march import hours_at_rest, march
from thermobearing.core.records import Ints
from thermobearing.core.types import Constants, Floats, Path, State, new_state, new_workspace
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.history import build_segments, cut_rests, room_for, run_segments
from thermobearing.cyclic.protocol import LARGEST_STRAIN, CyclicTest, lengths
from thermobearing.earthquake.case import (
    EarthquakeCase,
    Laboratory,
    make_earthquake_case,
    settle_surroundings,
)
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.measures import drift, largest, pier_peaks
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.specimen import TcpSpecimen
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.effort import analysis_too_much
from thermobearing.model.handover import begun_from
from thermobearing.model.options import build_model
from thermobearing.model.outcomes import NOT_PHYSICAL, PIER_BEYOND_LIMIT
from thermobearing.model.stack import Stack
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.results.base import COMPLETED
from thermobearing.structure.model import along, list_hinges
from thermobearing.structure.run import (
    Line,
    Prepared,
    StructureHistory,
    prepare_structure,
    run_structure,
)

Progress = Callable[[int, int], None]
WORKERS = 2  # at least
BILINEAR_STRAIN = 100.0  # largest of a bilinear bearing: a design may begin far off
AT_REST = 1e9  # clock of a core whose half-space has settled [s]
SPIN_UP = 60 * DAY  # hours before the first of a typical year
BLIND = np.zeros(1)  # temperature of a bilinear bearing, which has none: no rounding there [degC]


@dataclass(frozen=True)
class Device:
    """A bearing with its constants; `stack` is None for a bilinear one, which has no heat."""

    bearing: Bearing | BilinearBearing
    constants: Constants
    stack: Stack | None

    @property
    def has_lead(self) -> bool:
        """Whether it has lead cores with a temperature."""
        return self.stack is not None and self.constants.lead.cores > 0.0


class Shaking(NamedTuple):
    """A ground motion at the ends of the steps."""

    motion: GroundMotion | MotionPair
    dt: float  # of the steps [s]
    ground: Floats  # [steps + 1] acceleration [mm/s2], or [steps + 1, 2] along x and y


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


def build_device(case: EarthquakeCase, bearing: Bearing | BilinearBearing) -> Device:
    """Return a bearing of the case with the constants of the coupled step."""
    if isinstance(bearing, BilinearBearing):
        made = exposed_bilinear(bearing, case.analysis.exposure)
        parameters = BilinearParameters(
            made.strength, made.post_yield_stiffness, made.initial_stiffness
        )
        return Device(bearing, bilinear_constants(parameters), None)
    model = build_model(bearing, case.analysis, backbone=bilinear_parameters)
    return Device(bearing, model.constants, model.stack)


def build_shaking(
    case: EarthquakeCase, number: int, motion: GroundMotion | MotionPair, direction: str = ""
) -> Shaking:
    """Return a motion of the case, cut and scaled; of a pair both components, or one direction."""
    steps, dt = case.count_steps(motion)
    times, factor = dt * np.arange(steps + 1), case.motions[number].factor
    if isinstance(motion, MotionPair) and direction:
        motion = motion.along("y" if direction == "y" else "x")
    if isinstance(motion, MotionPair):
        each = [np.interp(times, motion.time, values) for values in motion.rotated().T]
        return Shaking(motion, dt, factor * np.column_stack(each))
    return Shaking(motion, dt, factor * np.interp(times, motion.time, motion.acceleration))


def _soaked(device: Device, weather: Ambient) -> tuple[Floats, float | None]:
    """Return the temperatures of cells and lead at the end of a weather, the bearing at rest."""
    cells = len(device.constants.cells.capacity)
    if device.stack is None:
        return BLIND, None
    start = float(weather.time[0])
    shifted = Ambient.series(weather.time - start, weather.temperature)
    rest = {"step": "rest", "duration": float(shifted.time[-1])}
    segments = build_segments(CyclicTest(dt=10.0, steps=[rest]), 1.0)
    initial = np.full(cells, weather.temperature[0])
    history = run_segments(device.constants, segments, shifted, initial, groups=())
    lead = history.state.branches[0].lead_temperature if device.constants.lead.cores > 0.0 else None
    return history.state.temperature, lead


def run_task(task: Task) -> StructureHistory:
    """Carry out one run; never raises for a failed analysis.

    InputError : nothing answers at the address of a specimen outside.
    """
    case, shaking = task.case, task.shaking
    lab, steps = case.laboratory or Laboratory(), len(shaking.ground) - 1
    outside = None if lab.specimen is None else TcpSpecimen(lab, task.reported_line)
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
    )
    if case.initial_state is not None and case.initial_state.zero:
        along = history.rows.bearings["displacement"]
        along = along[..., 0] if case.components > 1 else along
        along -= case.initial_state.zero
    if history.outcome != COMPLETED:
        return history if outside is None else replace(history, note=outside.note)
    moved = [largest(lengths(history.bearing(b)["displacement"])) for b in range(len(task.lines))]
    turned = [largest(history.hinge(h)["rotation"]) for h in range(history.rows.hinges.shape[1])]
    tops = [row["pier_part_displacement_max"] for row in pier_peaks(task, history)]
    return replace(history, outcome=find_outcome(task, moved, turned, tops))


def lines_to_shake(task: Task) -> list[Line]:
    """Return the bearing lines of a run as the structure takes them."""
    case, lab = task.case, task.case.laboratory
    begun = None
    if case.initial_state is not None:
        begun = begun_from(case.initial_state, task.device.constants, components=case.components)
    return [
        Line(
            one.device.constants,
            one.temperature,
            one.lead,
            speed=lab.speed if lab is not None and task.mode == "pd" else 0.0,
            warmer=one.ambient - task.ambient,
            begun=begun,
        )
        for one in task.lines
    ]


def find_outcome(
    task: Task, moved: Sequence[float], turned: Sequence[float], tops: Sequence[float]
) -> str:
    """Return the outcome of a run that reached its end: whether the model holds that far.

    `moved`, `turned` and `tops` are the largest movements of each bearing [mm], hinge [rad] and
    pier top [mm].
    """
    structure = task.case.structure
    for one, far in zip(task.lines, moved, strict=True):
        largest_strain = BILINEAR_STRAIN if one.device.stack is None else LARGEST_STRAIN
        if far / one.device.bearing.total_rubber_thickness > largest_strain:
            return NOT_PHYSICAL
    hinges = zip(list_hinges(structure), turned, strict=True)
    ductile = any(far / hinge.yield_rotation > structure.limits.ductility for hinge, far in hinges)
    if ductile or drift(task, tops) > structure.limits.drift:
        return PIER_BEYOND_LIMIT
    return COMPLETED


def _refuse_too_much(
    case: EarthquakeCase, devices: Sequence[Device], motions: Sequence[GroundMotion | MotionPair]
) -> None:
    lines, climates = len(case.structure.bearings), case.climates * len(case.modes)
    lines, climates = lines * case.components, climates * len(case.directions)
    coordinates = (2.0 if case.components == 1 else 5.0) * len(case.structure.bodies)
    runs = []
    for device in devices:
        layers, cells = len(device.constants.multiplicity), len(device.constants.cells.capacity)
        # Some three iterations; elimination takes as long for a number as a cell for 15.
        work = climates * (3.0 * lines * (cells + 5.0 * layers) + coordinates**3 / 15.0)
        profiles = cells if "cells" in case.analysis.keep else 0
        kept = climates * (20.0 + 4.0 * coordinates + lines * (20.0 + layers + profiles))
        runs += [(float(case.count_steps(motion)[0]), work, kept) for motion in motions]
    found = analysis_too_much(runs)
    if found:
        raise InputError(found, case.command)


def build_tasks(case: EarthquakeCase) -> list[Task]:
    """Return all runs of a case: bearings, motions, temperatures, modes, directions."""
    devices = [build_device(case, bearing) for bearing in case.bearings]
    plan = case.structure.plan
    motions = [motion.load_pair() if plan else motion.load() for motion in case.motions]
    _refuse_too_much(case, devices, motions)
    ways = [(way, *_prepare(case, way)) for way in case.directions]
    same = {device.bearing.name: device for device in devices}  # so that they are of one kind
    own: list[Device | None] = []
    for item in case.lines:
        known = None if item.bearing is None else same.get(item.bearing.name)
        if item.bearing is not None and (known is None or known.bearing != item.bearing):
            known = build_device(case, item.bearing)
        own.append(known)
    weather = None if case.weather is None else read_air(case.weather)
    tasks = []
    for device in devices:
        ambients = case.ambient if weather is None else [float(weather.temperature[-1])]
        climates = []
        for ambient in ambients:
            start = partial(one_line, case, ambient=ambient, weather=weather)
            climates.append((ambient, prepared_lines(case, device, own, start)))
        for number, motion in enumerate(motions):
            shaken = [(way, build_shaking(case, number, motion, way[0])) for way in ways]
            tasks += [
                Task(prepared, device, shaking, ambient, lines, own_case, mode, direction)
                for ambient, lines in climates
                for mode in case.modes
                for (direction, own_case, prepared), shaking in shaken
                if not direction or shaking.ground.any()
            ]
    return tasks


def _prepare(case: EarthquakeCase, direction: str) -> tuple[EarthquakeCase, Prepared]:
    """Return the case of a direction alone, or the case itself, and its structure."""
    if direction:
        structure = along(case.structure, "y" if direction == "y" else "x")
        case = case.model_copy(update={"structure": structure})
    return case, prepare_structure(case.structure, case.analysis.mass, case.analysis.damping)


def prepared_lines(
    case: EarthquakeCase,
    device: Device,
    own: Sequence[Device | None],
    start: Callable[[Device], OneLine],
) -> tuple[OneLine, ...]:
    """Return all lines of a run; `own` are the devices of the case's own lines, or None."""
    usual = start(device)
    special = {item.line: (item, mine) for item, mine in zip(case.lines, own, strict=True)}
    found = []
    for line in case.structure.bearings:
        if line.name not in special:
            found.append(usual)
            continue
        item, mine = special[line.name]
        before = None if item.weather is None else read_air(item.weather)
        if item.ambient is None and before is None:
            found.append(usual if mine is None else start(mine))
            continue
        here = float(before.temperature[-1]) if before is not None else item.ambient
        assert here is not None
        found.append(one_line(case, mine or device, here, before))
    return tuple(found)


def one_line(
    case: EarthquakeCase, device: Device, ambient: float, weather: Ambient | None
) -> OneLine:
    """Return a line as an earlier test or its weather left it, or at the ambient temperature."""
    left = case.initial_state
    if left is not None:
        return OneLine(device, np.array(left.temperature), left.lead_temperature, ambient)
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
    own = None if executor else ThreadPoolExecutor(max(WORKERS, os.cpu_count() or 1))
    pool: Any = executor or own
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
        if own:
            own.shutdown(cancel_futures=True)
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
    nothing, still = np.zeros(size), Ambient(np.array([0.0, HOUR]), np.zeros(2))
    kept = np.column_stack([_after_an_hour(constants, unit, still) for unit in np.eye(size)])
    ends = [
        Ambient(np.array([0.0, HOUR]), np.array(ambient)) for ambient in ([1.0, 0.0], [0.0, 1.0])
    ]
    early, late = (_after_an_hour(constants, nothing, ambient) for ambient in ends)
    return _HourMap(np.ascontiguousarray(kept), early, late)


def _has_lead(constants: Constants) -> bool:
    return constants.lead.cores > 0.0


def _after_an_hour(constants: Constants, before: Floats, ambient: Ambient) -> Floats:
    """Return temperatures after an hour at rest [degC]: cells, lead, terms of lead."""
    cells = len(constants.cells.capacity)
    state = new_state(constants, before[:cells])
    spare = new_state(constants, before[:cells])
    if _has_lead(constants):
        state.branches["lead_temperature"] = state.books["lead_temperature"] = before[cells]
        state.branches["clock"] = AT_REST
        state.ends[:] = before[cells + 1 :]
    rest: Any = {"step": "rest", "duration": HOUR}
    segment = build_segments(CyclicTest(dt=10.0, steps=[rest]), 1.0)[0]
    nothing = np.zeros(len(segment.x), dtype=bool)
    segment, nothing, _ = cut_rests(constants, segment, nothing, 0.0)
    path = Path(segment.x, segment.dt, ambient.means(0.0, segment.dt), nothing, 0.0)
    march(constants, new_workspace(constants), state, spare, path, room_for(constants, 1, ()))
    return _vector(constants, state)


def _vector(constants: Constants, state: State) -> Floats:
    lead = state.branches["lead_temperature"] if _has_lead(constants) else np.zeros(0)
    return np.concatenate([state.temperature, lead, state.ends])


def soaked_hours(device: Device, weather: Hourly, hours: Ints | None = None) -> Soaked:
    """Return the temperatures of a bearing at some hours (all by default) of a weather.

    It is in the weather from hour 0, then at the ambient temperature; in a typical year, from sixty
    days earlier. InputError: an hour that the weather does not have.
    """
    wanted = np.arange(len(weather)) if hours is None else np.asarray(hours, dtype=np.int64)
    if len(wanted) and not 0 <= wanted.min() <= wanted.max() < len(weather):
        raise InputError(f"hours must be 0 to {len(weather) - 1}", weather.name)
    if device.stack is None:
        return Soaked(np.zeros((len(wanted), 1)), None)
    constants = device.constants
    before = SPIN_UP if weather.recurs else 0
    ambient = np.take(weather.temperature, np.arange(-before, len(weather)), mode="wrap")
    places, back = np.unique(wanted + before, return_inverse=True)
    hour, now = _hour_map(constants), _uniform(constants, ambient[0])
    kept, found = np.ascontiguousarray(hour.kept.T), np.empty((len(places), len(now)))
    hours_at_rest(kept, hour.early, hour.late, ambient, places, now, np.empty_like(now), found)
    found = found[back]
    cells = len(constants.cells.capacity)
    lead = found[:, cells].copy() if _has_lead(constants) else None
    return Soaked(np.ascontiguousarray(found[:, :cells]), lead)


def history_weights(constants: Constants, hours: int) -> Floats:
    """Return weights [cells and lead, hours + 1] on the ambient temperature at full hours."""
    hour = _hour_map(constants)
    begin = _uniform(constants, 1.0)
    weights = np.zeros((len(begin), hours + 1))
    early, late = hour.early, hour.late
    for back in range(hours):
        weights[:, hours - back - 1] += early
        weights[:, hours - back] += late
        early, late, begin = hour.kept @ early, hour.kept @ late, hour.kept @ begin
    weights[:, 0] += begin
    return weights


def soaked_history(
    constants: Constants, weights: Floats, ambient: Floats
) -> tuple[Floats, float | None]:
    """Return temperatures of cells and lead from `history_weights` and hourly temperatures."""
    found = weights @ ambient
    cells = len(constants.cells.capacity)
    return found[:cells].copy(), float(found[cells]) if _has_lead(constants) else None


def _uniform(constants: Constants, ambient: float) -> Floats:
    return _vector(constants, new_state(constants, np.full(len(constants.cells.capacity), ambient)))


def bearing_weather(
    bearing: str | pathlib.Path | Bearing | BilinearBearing, weather: Hourly, **options: Any
) -> "pd.DataFrame":
    """Return the temperatures of a bearing at rest in hourly weather: one row an hour.

    Parameters
    ----------
    bearing : str, Path or Bearing
        A name, a file, or a bearing; not a bilinear one, which has no heat.
    weather : Hourly
        From `tb.read_weather` or `tb.generate_weather`.
    **options
        Of the model and its heat, as in `tb.bridge` with weather: films of 12 W/(m2 K) at faces
        and side and 10 mm of cover rubber by default.

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
    table: dict[str, Any] = {"command": "bridge", "bearings": [bearing], "analysis": options}
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
