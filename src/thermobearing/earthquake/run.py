"""The story of an earthquake study: structure, bearings, motions, weather -> a result.

    structure -> matrices, modes, damping;   bearing -> constants of the one coupled step
    every bearing x motion x temperature -> time integration -> histories -> one dataset

Read `run_earthquake` first; `bridge` and `hybrid` (study.py) gather what the user gave into the
case that it carries out. The integration is in structure/, the step of the bearing is
the same as in every other analysis (core/step.py).
"""

import os
from collections.abc import Callable
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.core.types import Floats
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.history import run_segments
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.segments import build_segments
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.label import label_study
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.task import Device, Shaking, Task
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.options import build_model
from thermobearing.structure.run import (
    Line,
    StructureHistory,
    prepare_structure,
    run_structure,
)

Progress = Callable[[int, int], None]
WORKERS = 2  # at least


def build_device(case: EarthquakeCase, bearing: Bearing | BilinearBearing) -> Device:
    """Constants of the coupled step for a bearing of the case."""
    if isinstance(bearing, BilinearBearing):
        parameters = BilinearParameters(
            bearing.strength, bearing.post_yield_stiffness, bearing.initial_stiffness
        )
        return Device(bearing, bilinear_constants(parameters), None)
    model = build_model(bearing, case.analysis, backbone=bilinear_parameters)
    return Device(bearing, model.constants, model.stack)


def build_shaking(case: EarthquakeCase, number: int) -> Shaking:
    """A motion of the case, cut, scaled, and linear between its samples."""
    chosen = case.motions[number]
    motion = chosen.load()
    steps, dt = case.steps_of(motion)
    times = dt * np.arange(steps + 1)
    ground = chosen.factor * np.interp(times, motion.time, motion.acceleration)
    return Shaking(motion, dt, ground)


def soaked(device: Device, weather: Ambient) -> tuple[Floats, float | None]:
    """Temperatures of cells and lead after a time of weather, at its end.

    The bearing is at rest, at first uniform at the first ambient temperature. The same heat
    model as in motion, in growing steps.
    """
    cells = len(device.constants.cells.capacity)
    if device.stack is None:
        return np.full(cells, weather.temperature[-1]), None
    start = float(weather.time[0])
    shifted = Ambient.series(weather.time - start, weather.temperature)
    rest = {"step": "rest", "duration": float(shifted.time[-1])}
    segments = build_segments(CyclicTest(dt=10.0, steps=[rest]), 1.0)
    initial = np.full(cells, weather.temperature[0])
    history = run_segments(device.constants, segments, shifted, initial, groups=())
    lead = history.state.branches[0].lead_temperature if device.constants.lead.cores > 0.0 else None
    return history.state.temperature, lead


def run_task(task: Task) -> StructureHistory:
    """One run; never raises for a failed analysis."""
    case, shaking = task.case, task.shaking
    lab, steps = case.laboratory, len(shaking.ground) - 1
    speed = lab.speed if lab is not None and lab.mode == "pd" else 0.0
    noise = None
    if lab is not None and lab.force_noise > 0.0:
        noise = lab.force_noise * np.random.default_rng(lab.seed).standard_normal(steps)
    temperature, lead = task.start
    line = Line(task.device.constants, temperature, lead, speed)
    return run_structure(
        task.prepared,
        [line] * len(case.structure.bearings),
        shaking.ground,
        shaking.dt,
        np.full(steps, task.ambient),
        method=case.analysis.method,
        noise=noise,
        delay=0.0 if lab is None else lab.delay,
    )


def build_tasks(case: EarthquakeCase) -> list[Task]:
    """All runs of a case: bearings, then motions, then ambient temperatures."""
    prepared = prepare_structure(case.structure, case.analysis.mass)
    devices = [build_device(case, bearing) for bearing in case.bearings]
    shakings = [build_shaking(case, number) for number in range(len(case.motions))]
    weather = None if case.weather is None else Ambient.from_csv(case.weather)
    tasks = []
    for device in devices:
        if weather is not None:
            starts = [(float(weather.temperature[-1]), soaked(device, weather))]
        else:
            cells = len(device.constants.cells.capacity)
            starts = [(value, (np.full(cells, value), None)) for value in case.ambient]
        for shaking in shakings:
            tasks += [Task(prepared, device, shaking, air, start, case) for air, start in starts]
    return tasks


def run_earthquake(
    case: EarthquakeCase,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> EarthquakeResult:
    """Carry out a study; never raises for a failed analysis (see `EarthquakeResult.outcome`).

    Parameters
    ----------
    case : from `load_earthquake_case` or `make_earthquake_case`.
    executor : any `concurrent.futures` executor; threads by default, since the compiled
        integration lets go of the interpreter.
    progress : called with (runs done, all runs).

    Examples
    --------
    >>> from thermobearing.earthquake.case import make_earthquake_case
    >>> table = {"command": "bridge", "bearings": ["shen-bilinear-bridge"], "duration": "2 s"}
    >>> run_earthquake(make_earthquake_case(table, "example")).runs
    12
    """
    tasks = build_tasks(case)
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
    return label_study(case, tasks, histories)
