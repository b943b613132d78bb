"""Runs in lockstep against the same runs one by one: how many more a core does in a second."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import thermobearing as tb
from benchmarks.rows import Row, at_least, at_most
from benchmarks.structure import AMBIENT, BEARING, DT, STRUCTURE, ground
from tests.reference.lockstep import march_lanes
from thermobearing.core.lanes.memory import WIDTH, aligned, side_by_side
from thermobearing.core.march import march
from thermobearing.core.records import rows as records
from thermobearing.core.types import (
    BearingResponse,
    Constants,
    Kept,
    Path,
    new_state,
    new_workspace,
)
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.structure.lanes import Run, RunPeaks, run_lanes, run_peaks, with_shared_cells
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure

REPEATS, STEPS, STEP = 12, 4000, 0.005
RATIO, MINUTES = 4.0, 6.0
HISTORIES = 4 * WIDTH
BEARINGS = {
    "HDR specimen, 19 cells": "shen-hdr-specimen",
    "LHDR bridge bearing, 63 cells": BEARING,
}


def constants_of(name: str, stiffer: float) -> Constants:
    """A library bearing with another stiffness of its rubber, half stack."""
    bearing = tb.load_bearing(name)
    hysteresis = bearing.hysteresis
    change = {"layer_stiffness": stiffer * hysteresis.layer_stiffness}
    bearing = bearing.model_copy(update={"hysteresis": hysteresis.model_copy(update=change)})
    stack = build_stack(bearing, half=True)
    return build_constants(bearing, stack, upper=EndFace(eta=2.0), lower=None)


def cycles(name: str, lane: int) -> tuple[Any, ...]:
    """Arguments of a march without rows: growing sines, another temperature for every lane."""
    constants = constants_of(name, 0.8 + 0.05 * lane)
    air, cells = -20.0 + 5.0 * lane, len(constants.cells.capacity)
    time_ = STEP * np.arange(1, STEPS + 1)
    largest = tb.load_bearing(name).total_rubber_thickness * (0.4 + 0.05 * lane)
    x = largest * time_ / time_[-1] * np.sin(np.pi * time_ + 0.7 * lane)
    state, spare = (new_state(constants, np.full(cells, air)) for _ in range(2))
    path = Path(x, np.full(STEPS, STEP), np.full(STEPS, air), np.zeros(STEPS, np.bool_), 0.0)
    room = Kept(records(BearingResponse, 0), *[np.zeros((0, 0))] * 3, np.zeros((0, 0)))
    return constants, new_workspace(constants), state, spare, path, room


def seconds(function: Callable[[], object]) -> float:
    """Processor time of something."""
    begin = time.process_time()
    function()
    return time.process_time() - begin


def each_alone(runs: list[tuple[Any, ...]]) -> None:
    """March after march."""
    for run in runs:
        march(*run)


def bearing_row(label: str, name: str) -> Row:
    """Many steps of one bearing, by turns alone and together, always from a virgin one."""
    best, ends = [np.inf, np.inf], aligned((3, WIDTH), np.float64)
    for _ in range(REPEATS):
        # New states in each round: a march leaves them worn.
        alone, lanes = ([cycles(name, lane) for lane in range(WIDTH)] for _ in range(2))
        together = side_by_side([(with_shared_cells(run[0]), *run[1:]) for run in lanes])
        times = (
            seconds(partial(each_alone, alone)),
            seconds(partial(march_lanes, *together, ends)),
        )
        best = [min(pair) for pair in zip(best, times, strict=True)]
        if ends[0].any():
            raise RuntimeError(f"{label}: outcomes {ends[0]}")
    slow, fast = best
    count = WIDTH * STEPS
    note = f"{1e9 * fast / count:.0f} ns a bearing-step, {1e9 * slow / count:.0f} alone"
    return at_least(f"lockstep over one by one, {label}", slow / fast, RATIO, note=note)


def shakes() -> list[Run]:
    """Pier P1 under one motion at other scales, with other bearings and temperatures."""
    prepared, acceleration = prepare_structure(load_structure(STRUCTURE)), ground()
    random = np.random.default_rng(1)
    runs = []
    for _ in range(HISTORIES):
        constants = constants_of(BEARING, random.uniform(0.8, 1.2))
        air = AMBIENT + random.uniform(0.0, 40.0)
        line = Line(constants, np.full(len(constants.cells.capacity), air))
        shaken = random.uniform(0.5, 1.2) * acceleration
        runs.append(Run(prepared, [line], shaken, DT, air))
    return runs


def one_by_one(runs: list[Run]) -> list[RunPeaks]:
    """Each alone."""
    return [run_peaks(run) for run in runs]


def structure_rows() -> list[Row]:
    """Forty seconds of pier P1, everything around the kernel included."""
    runs = shakes()
    alone = sum(run.alone for run in run_lanes(runs))
    run_peaks(runs[0])
    best = [np.inf, np.inf]
    for _ in range(3):
        for place, function in enumerate((one_by_one, run_lanes)):
            best[place] = min(best[place], seconds(partial(function, runs)))
    slow, fast = (1e3 * run / len(runs) for run in best)
    note = f"{fast:.2f} ms a history, {slow:.2f} alone; {alone} of {len(runs)} left the lockstep"
    minutes = fast * 1e5 / 1e3 / 60.0 / 2.0
    return [
        at_least("lockstep over one by one, pier P1, 8000 steps", slow / fast, RATIO, note=note),
        at_most("100 000 histories of pier P1, two cores", minutes, MINUTES, "min", "peaks only"),
    ]


def rows() -> list[Row]:
    """Bearings, then a bridge."""
    measured = [bearing_row(label, name) for label, name in BEARINGS.items()]
    return [*measured, *structure_rows()]
