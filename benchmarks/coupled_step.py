"""Time of one coupled step: sharing, heat, conduction, response, one kept row; and in a plane."""

import math
import time
from collections.abc import Callable

import numpy as np

import thermobearing as tb
from benchmarks.rows import Row, at_most
from benchmarks.specimen import AMBIENTS, step_microseconds
from thermobearing.core.march import march
from thermobearing.core.plane import march_plane
from thermobearing.core.records import Floats
from thermobearing.core.types import Path, new_state, new_workspace
from thermobearing.cyclic.history import room_for
from thermobearing.model.options import build_model

LIMIT = 0.6  # [us]
LEAD = "shen-lhdr-specimen"
LEAD_LIMIT = 1.0  # [us]
PLANE_LIMIT = 2.2  # of the time of a step on a line
CYCLE, STEPS, PLANE_REPEATS = 200, 400, 300


def marching(name: str, x: Floats) -> Callable[[], float]:
    """Return what measures the seconds of a march along displacements [mm] at -20 degC."""
    components = x.ndim
    constants = build_model(tb.load_bearing(name)).constants
    cold = np.full(len(constants.cells.capacity), -20.0)
    columns = (np.full(len(x), 0.02), np.full(len(x), -20.0), np.zeros(len(x), dtype=bool), 0.0)
    path, room = Path(x, *columns), room_for(constants, 1, (), components)
    work = new_workspace(constants, components)
    run = march if components == 1 else march_plane

    def seconds() -> float:
        start, spare = (new_state(constants, cold, None, components) for _ in range(2))
        began = time.perf_counter()
        steps, *_ = run(constants, work, start, spare, path, room)
        assert steps == len(x)
        return time.perf_counter() - began

    return seconds


def plane_rows() -> list[Row]:
    """How many times as long a step takes in a plane; the fastest of runs in turn count."""
    angle = 2.0 * math.pi * np.arange(1, STEPS + 1) / CYCLE
    sine, eight = 45.0 * np.sin(angle), 45.0 * np.sin(2.0 * angle) / 2.0
    paths = {
        "line": sine,
        "circle": np.stack([sine, 45.0 * np.cos(angle) * np.minimum(1.0, angle / 3.0)], axis=1),
        "eight": np.stack([sine, eight], axis=1),
    }
    measured = []
    for name in ("shen-hdr-specimen", LEAD):
        runs = {key: marching(name, x) for key, x in paths.items()}
        times = [{key: run() for key, run in runs.items()} for _ in range(PLANE_REPEATS)]
        best = {key: min(round_times[key] for round_times in times) for key in paths}
        for key in ("circle", "eight"):
            note = f"{1e6 * best[key] / STEPS:.3f} us"
            label = f"coupled step in a plane, {key}, {name}, over one on a line"
            measured.append(at_most(label, best[key] / best["line"], PLANE_LIMIT, "", note))
    return measured


def rows() -> list[Row]:
    """One row per ambient temperature; the fastest of many runs counts, the median is noted."""
    measured = []
    for ambient in AMBIENTS:
        fastest, median = step_microseconds(ambient, repeats=30)
        label = f"coupled step, 19 cells, 3 layers, Table 3.4 at {ambient:g} degC"
        measured.append(at_most(label, fastest, LIMIT, "us", f"median {median:.3f} us"))
    for ambient in AMBIENTS:
        fastest, median = step_microseconds(ambient, 15, LEAD, "finite-plate")
        label = (
            f"coupled step with lead, 29 cells, 3 layers and core, Table 3.4 at {ambient:g} degC"
        )
        measured.append(at_most(label, fastest, LEAD_LIMIT, "us", f"median {median:.3f} us"))
    fastest, median = step_microseconds(-20.0, repeats=15, name=LEAD)
    label = "the same on a half-space, at -20 degC"
    measured.append(at_most(label, fastest, LEAD_LIMIT, "us", f"median {median:.3f} us"))
    return [*measured, *plane_rows()]
