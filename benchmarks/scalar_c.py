"""Compare the coupled step with that of 0.2.0 in C, and its stored histories with a copy."""

import ctypes
import math
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing as tb
from benchmarks.rows import Row, at_most, failed, plain
from benchmarks.specimen import NAME
from thermobearing.core.march import march
from thermobearing.core.records import Floats
from thermobearing.core.types import Constants, new_state, new_workspace
from thermobearing.core.types import Path as Steps
from thermobearing.cyclic.history import room_for
from thermobearing.model.options import build_model

SOURCE = Path(__file__).with_name("coupled_step.c")
# Of its text: the work of a step does not change from release to release.
DIGEST = "2db8690afe3b2a067d65e943a7bfda78fb31f68298ec8356b447f48c90bd20c1"
FLAGS = ("-O3", "-march=native", "-shared", "-fPIC")
LIMIT = 1.2  # of the time of C
CLOSE = 1e-9  # of force, energies and temperatures, relative to the largest
AMPLITUDE, DT, COLD = 45.0, 0.02, -20.0  # [mm], [s], [degC]
STEPS, CYCLE, REPEATS = 4000, 200, 60
WHAT = "coupled step of march, HDR specimen at -20 degC, over C of the step of 0.2.0"
RUBBER = (
    "layer_count",
    "elastic_stiffness",
    "hysteretic_stiffness",
    "elastic_exponent",
    "hysteretic_exponent",
    "reference_temperature",
    "hardening",
    "yield_displacement",
    "unloading_curvature",
    "sharing_start",
    "sharing_full",
)


def steps(*, keep: bool) -> Steps:
    """Return sine waves of constant amplitude, of which nothing or every step is kept."""
    x = AMPLITUDE * np.sin(2.0 * math.pi * np.arange(1, STEPS + 1) / CYCLE)
    return Steps(x, np.full(STEPS, DT), np.full(STEPS, COLD), np.full(STEPS, keep), 0.0)


def address(array: np.ndarray) -> int:
    """Return the address of a contiguous array."""
    return int(array.ctypes.data)


def compiled_march(constants: Constants, path: Steps, library: Path) -> Callable[[], Floats]:
    """Return the march in C; it returns force, energies and temperatures at the end."""
    rubber = [float(getattr(constants.rubber, name)) for name in RUBBER]
    numbers = np.array([*rubber, constants.source_rise])
    cells = constants.cells
    layers = constants.layer_cells
    places = np.array([[int(cell) for cell in layer] for layer in layers], dtype=np.int64)
    columns = [
        np.ascontiguousarray(column, dtype=float)
        for column in (
            constants.multiplicity,
            cells.to_previous,
            cells.to_next,
            cells.end_loss,
            cells.side_loss,
            cells.capacity,
        )
    ]
    heads = [len(layers), len(cells.capacity), *map(address, columns), address(places)]
    stack = np.array(heads, dtype=np.int64)
    results = np.zeros(5 + len(cells.capacity))
    code = ctypes.CDLL(str(library)).hdr_march
    code.restype, code.argtypes = ctypes.c_long, [*[ctypes.c_void_p] * 2, ctypes.c_long]
    code.argtypes = [*code.argtypes, *[ctypes.c_void_p] * 4]
    addresses = [address(cell) for cell in (path.x, path.dt, path.ambient, results)]
    # The addresses are of these arrays: a reference in the function keeps them from being freed.
    arrays = columns, places

    def run() -> Floats:
        assert code(address(numbers), address(stack), STEPS, *addresses) == STEPS, arrays
        return results

    return run


def own_march(constants: Constants, path: Steps) -> Callable[[], Floats]:
    """Return the same of the program."""
    cold = np.full(len(constants.cells.capacity), COLD)
    work, room = new_workspace(constants), room_for(constants, STEPS, ())
    start, spare = new_state(constants, cold), new_state(constants, cold)
    virgin = new_state(constants, cold)

    def run() -> Floats:
        for fresh, used in zip(virgin, start, strict=True):
            used[:] = fresh
        step_count, *_ = march(constants, work, start, spare, path, room)
        assert step_count == STEPS
        balance: Any = start.response[0]
        lost = balance.heat_lost_ends + balance.heat_lost_sides
        numbers = [balance.force, balance.work_in, balance.heat_released, balance.heat_stored, lost]
        return np.array([*numbers, *start.temperature])

    return run


def microseconds(runs: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Return the fastest time of a step of each, run in turn [us]."""
    best = dict.fromkeys(runs, math.inf)
    for _ in range(REPEATS):
        # In turn, so that a machine that becomes slower does so for all.
        for name, run in runs.items():
            begin = time.perf_counter()
            run()
            best[name] = min(best[name], 1e6 * (time.perf_counter() - begin) / STEPS)
    return best


def rows() -> list[Row]:
    """Build the C code where there is a compiler; what both compute must agree."""
    compiler = shutil.which("cc")
    if compiler is None:
        return [failed(WHAT, "there is no C compiler")]
    constants = build_model(tb.load_bearing(NAME)).constants
    quiet, full = steps(keep=False), steps(keep=True)
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "step.so"
        subprocess.run([compiler, *FLAGS, "-o", library, SOURCE, "-lm"], check=True)
        ours, theirs = own_march(constants, quiet), compiled_march(constants, quiet, library)
        our_results, their_results = ours(), theirs()
        error = float(
            np.max(np.abs(our_results - their_results) / np.maximum(np.abs(our_results), 1.0))
        )
        if not error <= CLOSE:
            return [failed(WHAT, f"results differ by {error:.1e}", f"<= {LIMIT:g}")]
        kept = room_for(constants, STEPS, ("rubber", "layer_displacement", "hysteretic"))
        # Arrays far larger than any cache, so that the copy measures the speed of the memory.
        copy = np.empty(32 * 2**20)
        source = np.ones_like(copy)
        runs = {"ours": ours, "C": theirs, "kept": own_march(constants, full)}
        best = microseconds(runs)
        begin = time.perf_counter()
        for _ in range(5):
            np.copyto(copy, source)
        speed = 2 * 5 * copy.nbytes / (time.perf_counter() - begin)  # read and written [bytes/s]
    size = kept.response.dtype.itemsize
    roof = 1e6 * 2 * size / speed
    note = f"{best['ours']:.3f} and {best['C']:.3f} us; results within {error:.0e}"
    return [
        at_most(WHAT, best["ours"] / best["C"], LIMIT, "", note),
        plain(
            "share of the speed of memory that a march with every step kept takes",
            100.0 * roof / best["kept"],
            "%",
            f"{size} bytes a step, {speed / 1e9:.1f} GB/s",
        ),
    ]
