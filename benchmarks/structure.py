"""A bridge pier in an earthquake: one analysis, the same in OpenSees, the default study."""

import json
import subprocess
import sys
import time

import numpy as np

import thermobearing as tb
from benchmarks.rows import Row, at_least, at_most, failed, plain
from benchmarks.specimen import seconds
from thermobearing.core.types import Floats
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.motions.library import load_motion
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure, run_structure

STRUCTURE, BEARING, MOTION, LINE = "pier-p1", "shen-lhdr-bridge", "jra-ii-i-1", 5
DT, DURATION, AMBIENT = 0.005, 40.0, -20.0
LIMIT_MS, LIMIT_RATIO, LIMIT_STUDY = 40.0, 100.0, 6.0
LIMIT_PLAN = 2.2  # of the time in one direction
PLAN = "pier P1 on LHDR in plan with two components, over the same in one direction"
ACROSS = "jra-ii-i-2"
THEIRS = "OpenSees, pier P1 on LeadRubberX with lead heating"


def ground(name: str = MOTION) -> Floats:
    """40 s of a Level 2 motion at 5 ms [mm/s2]; silence after its end."""
    motion = load_motion(name)
    time_ = DT * np.arange(round(DURATION / DT) + 1)
    values = np.interp(time_, motion.time, motion.acceleration, right=0.0)
    values[0] = 0.0
    return np.asarray(values)


def one_analysis(*, plan: bool = False) -> float:
    """Fastest of some analyses with every step kept [ms], of two components in plan."""
    bearing = tb.load_bearing(BEARING)
    stack = build_stack(bearing, half=True)
    constants = build_constants(bearing, stack, upper=EndFace(eta=2.0), lower=None)
    prepared = prepare_structure(load_structure(STRUCTURE).model_copy(update={"plan": plan}))
    acceleration = np.stack([ground(), ground(ACROSS)], axis=-1) if plan else ground()
    line = Line(constants, np.full(len(constants.cells.capacity), AMBIENT))
    air = np.full(len(acceleration) - 1, AMBIENT)
    times = seconds(lambda: run_structure(prepared, [line], acceleration, DT, air), 15)
    return 1e3 * times[0]


def study() -> tuple[float, int]:
    """Wall time of the default study on all cores, without figures and files [s]; its runs."""
    case = make_earthquake_case({"command": "bridge"}, "bench")
    run_earthquake(case)
    begin = time.perf_counter()
    result = run_earthquake(case)
    return time.perf_counter() - begin, result.runs


def rows() -> list[Row]:
    """Ours, theirs in the same run, the study."""
    ours, plan = one_analysis(), one_analysis(plan=True)
    wall, runs = study()
    measured = [
        at_most("pier P1 on LHDR, 40 s, 8000 steps of 5 ms, one core", ours, LIMIT_MS, "ms"),
        at_most(PLAN, plan / ours, LIMIT_PLAN, "", f"{plan:.0f} ms"),
        at_most(f"default bridge study, {runs} runs, two cores", wall, LIMIT_STUDY, "s"),
    ]
    command = [sys.executable, "-m", "benchmarks.opensees_pier_model"]
    process = subprocess.run(command, capture_output=True, text=True, check=False)
    if process.returncode:
        reason = (process.stderr.strip().splitlines() or ["no message"])[-1]
        return [*measured, failed(THEIRS, reason, f">= {LIMIT_RATIO:g}")]
    theirs = json.loads(process.stdout.splitlines()[-1])
    # Once more after theirs: the machine may have become faster or slower meanwhile.
    repeated = min(ours, one_analysis())
    note = f"lead {theirs['rise']:.0f} K warmer, {theirs['iterations']} iterations in the last step"
    slow = 1e3 * theirs["seconds"]
    return [
        *measured,
        plain(THEIRS, slow, "ms", note),
        at_least(
            "ratio of the two, pier P1",
            slow / repeated,
            LIMIT_RATIO,
            note=f"ours {repeated:.1f} ms",
        ),
    ]
