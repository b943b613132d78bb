"""The kernels that Python calls, found by running a little of everything that calls one.

What runs is plain Python: the arguments of the calls are wanted, whose types say what to compile.
"""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any

import numba
import numpy as np

import thermobearing as tb
from thermobearing.bearing.ambient import Ambient
from thermobearing.core import axial, lead_ends, march, numbers, plane, step
from thermobearing.core.compiled.faces import Compiled, Description, compile_face, is_for_pages
from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.sources import sources_digest
from thermobearing.cyclic.history import Segment, run_segments
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_device
from thermobearing.model import lead_impedance
from thermobearing.motions import spectrum
from thermobearing.motions.record import motion_from_arrays
from thermobearing.results import loop
from thermobearing.structure import forces, newmark, predictor
from thermobearing.structure import types as structure_types
from thermobearing.structure.lanes import Run, run_lanes, run_peaks
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure, run_structure

BEARING = "shen-lhdr-bridge"
MODULES = (
    *(axial, loop, lead_ends, lead_impedance, march, numbers, plane, step),
    *(forces, newmark, predictor, spectrum),
)


class Recorded(Exception):  # noqa: N818  # it stops a run that is not wanted any further
    """A kernel was called that runs in machine code only."""


def all_kernels() -> list[Kernel]:
    """Return the kernels of the modules that other packages call."""
    kernels = (value for module in MODULES for value in vars(module).values())
    return list({kernel.name: kernel for kernel in kernels if type(kernel) is Kernel}.values())


def _run_everything() -> None:
    result = tb.run(BEARING, tb.cyclic_test(strain=[0.5], cycles=1, dt=0.5), ambient=-20.0)
    assert len(result.cycles)
    short = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.5)
    tb.run(BEARING, short, ambient=-20.0, axial_force=100.0, axial="constant")
    tb.bridge(BEARING, "jra-ii-i-1", -20.0, duration=0.05)
    tb.hybrid(BEARING, ambient=-20.0, duration=0.05, laboratory={"mode": "pd"})
    motion = motion_from_arrays(100.0 * np.arange(5.0), unit="gal", dt=0.01)
    tb.response_spectrum(motion, [1.0], steps_per_period=1)
    with suppress(Recorded):
        tb.rotated_spectrum(tb.MotionPair(motion, motion), [1.0], steps_per_period=1)
    element = tb.element(BEARING, ambient=-20.0)
    element.set_trial(1.0, dt=0.1)
    element.commit()
    with suppress(Recorded):
        tb.element(BEARING, ambient=-20.0, components=2).set_trial((1.0, 1.0), dt=0.1)
    case = make_earthquake_case({"command": "bridge", "bearings": [BEARING]}, "kernels")
    constants = build_device(case, case.bearings[0]).constants
    one_hour, two_hours, places = np.zeros(1), np.zeros(2), np.zeros(1, dtype=np.int64)
    between = (np.zeros((1, 1)), one_hour.copy(), one_hour.copy())
    march.hours_at_rest(*between, two_hours, places, one_hour, one_hour.copy(), np.zeros((1, 1)))
    still, first = np.zeros(1, dtype=np.int32), np.ones(1, dtype=bool)
    segment = Segment("recorded", "", np.ones((1, 2)), np.ones(1), still, first)
    temperature = np.full(len(constants.cells.capacity), -20.0)
    with suppress(Recorded):
        run_segments(constants, [segment], Ambient.constant(-20.0), temperature)
    line = Line(constants, temperature)
    prepared, ground = prepare_structure(load_structure("pier-p1")), np.array([0.0, 1.0, 0.0])
    run = Run(prepared, [line], ground, 0.01, -20.0)
    run_peaks(run)
    with suppress(Recorded):
        run_lanes([run])
    along = prepared.matrices
    vectors = "load", "line_rows", "device_rows"
    both = {name: np.stack([getattr(along, name)] * 2, axis=-1) for name in vectors}
    plan = replace(prepared, matrices=replace(along, **both))
    pair = np.stack([ground] * 2, axis=-1)
    with suppress(Recorded):
        run_structure(plan, [line], pair, 0.01, np.zeros(2))
    with suppress(Recorded):
        run_lanes([Run(plan, [line], pair, 0.01, -20.0)])


@contextmanager
def _recorded(kernels: list[Kernel]) -> Iterator[dict[str, tuple[Any, ...]]]:
    """Record the types of the arguments of the first call of each kernel, which run as Python."""
    kinds: dict[str, tuple[Any, ...]] = {}
    depth = 0

    def recorder(kernel: Kernel) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            nonlocal depth
            if not depth:  # the call is not made by another kernel
                kinds.setdefault(
                    kernel.name, tuple(numba.typeof(argument) for argument in arguments)
                )
            if not is_for_pages(kernel):
                raise Recorded(kernel.name)
            depth += 1
            try:
                return kernel.py_func(*arguments)
            finally:
                depth -= 1

        return call

    before = [kernel.run for kernel in kernels]
    for kernel in kernels:
        kernel.run = recorder(kernel)
    try:
        yield kinds
    finally:
        for kernel, run in zip(kernels, before, strict=True):
            kernel.run = run


def record() -> dict[str, tuple[Any, ...]]:
    """Return the numba types of the arguments of each kernel that Python calls."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"  # kernels that only other kernels call run as Python too
    try:
        with _recorded(all_kernels()) as kinds:
            _run_everything()
    finally:
        del os.environ["NUMBA_DISABLE_JIT"]
    return dict(sorted(kinds.items()))


def compile_all(*, for_pages_only: bool = False) -> tuple[list[Compiled], dict[str, Any]]:
    """Return all faces and their description, or those that pages need."""
    kernels = {kernel.name: kernel for kernel in all_kernels()}
    description, faces = Description(structure_types), []
    for name, kinds in record().items():
        if for_pages_only and not is_for_pages(kernels[name]):
            continue
        face = compile_face(kernels[name], kinds)
        description.add(kernels[name], kinds, face)
        faces.append(face)
        print(f"{name} is compiled", flush=True)
    return faces, description.all(sources_digest())
