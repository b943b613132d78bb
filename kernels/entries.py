"""The kernels that Python calls, found by running a little of everything that calls one."""

from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

import thermobearing as tb
from kernels.faces import Compiled, Description, Recorded, compile_face, is_for_pages, recorded
from thermobearing.bearing.ambient import Ambient
from thermobearing.core import lead_ends, march, numbers, plane, step
from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.sources import sources_digest
from thermobearing.cyclic.history import Segment, run_segments
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_device, soaked_hours
from thermobearing.model import lead_impedance
from thermobearing.motions import spectrum
from thermobearing.results import loop
from thermobearing.structure import forces, newmark, predictor
from thermobearing.structure.lanes import Run, run_lanes, run_peaks
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure, run_structure

BEARING = "shen-lhdr-bridge"
MODULES = (
    *(loop, lead_ends, lead_impedance, march, numbers, plane, step),
    *(forces, newmark, predictor, spectrum),
)


def all_kernels() -> list[Kernel]:
    """Return the kernels of the modules that other packages call."""
    found = {
        one.name: one for module in MODULES for one in vars(module).values() if type(one) is Kernel
    }
    return list(found.values())


def _run_everything() -> None:
    result = tb.run(BEARING, tb.cyclic_test(strain=[0.5], cycles=1, dt=0.5), ambient=-20.0)
    assert len(result.cycles)
    tb.bridge(BEARING, "jra-ii-i-1", -20.0, duration=0.05)
    tb.hybrid(BEARING, ambient=-20.0, duration=0.05, laboratory={"mode": "pd"})
    motion = tb.load_motion("jra-ii-i-1")
    tb.response_spectrum(motion, [1.0], steps_per_period=1)
    tb.rotated_spectrum(tb.MotionPair(motion, motion), [1.0], steps_per_period=1)
    element = tb.element(BEARING, ambient=-20.0)
    element.set_trial(1.0, dt=0.1)
    element.commit()
    tb.element(BEARING, ambient=-20.0, components=2).set_trial((1.0, 1.0), dt=0.1)
    case = make_earthquake_case({"command": "bridge", "bearings": [BEARING]}, "kernels")
    device = build_device(case, case.bearings[0])
    soaked_hours(device, tb.Hourly([1.0, 2.0, 3.0]))
    constants = device.constants
    still, first = np.zeros(1, dtype=np.int32), np.ones(1, dtype=bool)
    segment = Segment("recorded", "", np.ones((1, 2)), np.ones(1), still, first)
    run_segments(
        constants, [segment], Ambient.constant(-20.0), np.full(len(constants.cells.capacity), -20.0)
    )
    line = Line(constants, np.full(len(constants.cells.capacity), -20.0))
    prepared, ground = prepare_structure(load_structure("pier-p1")), np.array([0.0, 1.0, 0.0])
    run = Run(prepared, [line], ground, 0.01, -20.0)
    run_peaks(run)
    with suppress(Recorded):
        run_lanes([run])
    along = prepared.matrices
    both = {name: np.stack([getattr(along, name)] * 2, axis=-1) for name in ("load", "line_rows")}
    plan = replace(prepared, matrices=replace(along, **both))
    pair = np.stack([ground] * 2, axis=-1)
    with suppress(Recorded):
        run_structure(plan, [line], pair, 0.01, np.zeros(2))
    with suppress(Recorded):
        run_lanes([Run(plan, [line], pair, 0.01, -20.0)])


def record() -> dict[str, tuple[Any, ...]]:
    """Return the numba types of the arguments of each kernel that Python calls."""
    with recorded(all_kernels()) as found:
        _run_everything()
    return dict(sorted(found.items()))


def compile_all(*, all_of_them: bool = True) -> tuple[list[Compiled], dict[str, Any]]:
    """Return all faces and their description, or those that pages need."""
    known = {kernel.name: kernel for kernel in all_kernels()}
    description, faces = Description(), []
    for name, given in record().items():
        if not (all_of_them or is_for_pages(known[name])):
            continue
        face = compile_face(known[name], given)
        description.add(known[name], given, face)
        faces.append(face)
        print(f"{name} is compiled", flush=True)
    return faces, description.all(sources_digest())
