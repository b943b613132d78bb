"""Floating point operations of a step of pier P1 in the strong part of a motion.

The kernels run as plain Python on numbers that count what is done with them, so that the count is
the same on every machine. An addition, multiplication, division or square root is one operation,
and a function as many as its series of core/lanes/functions.py takes; signs, comparisons and
choices are none. A fused multiplication and addition counts as two.
"""

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

import thermobearing as tb
from benchmarks.rows import Row, at_most, plain
from benchmarks.structure import AMBIENT, DT, STRUCTURE, ground
from thermobearing.core import heat, sharing, step
from thermobearing.core.compiled.kernel import Kernel
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.structure import newmark
from thermobearing.structure.lanes import Run, run_peaks
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure

GRADED = {"end_plate": 5, "sealing_plate": 5, "plate_grading": 1.3}
# Bearings of the library, and what their heat cells have different.
BEARINGS: dict[str, tuple[str, dict[str, Any]]] = {
    "LHDR": ("shen-lhdr-bridge", {}),
    "LHDR, graded plates": ("shen-lhdr-bridge", GRADED),
    "HDR": ("shen-hdr-bridge", {}),
}
FIRST, STEPS = 1300, 300  # of the motion: 1.5 s of its strong part
# Operations and divisions of a step.
LIMITS = {"LHDR": (3840, 80), "LHDR, graded plates": (3420, 80), "HDR": (3700, 73)}
REST = "stiffness, lead, Maxwell branch and other parts of the bearing"
STRUCTURE_PART = "structure: residual, solution, distribution of forces"
# The part that each kernel and all that it calls belong to, unless they are named here themselves.
PARTS = {
    heat.eliminate: "heat, way down",
    heat.substitute: "heat, way up",
    sharing.share: "sharing of displacement between layers",
    newmark._note_peaks: "peaks and energies of the motion",
    newmark.add_energies: "peaks and energies of the motion",
    newmark.commit: "peaks and energies of the motion",
    step.begin: REST,
    step.move: REST,
    step.settle: REST,
}
# Operations of the series of a function, divisions among them.
SERIES = {
    "exp": (34, 0),
    "expm1": (35, 0),
    "tanh": (38, 1),
    "tan": (21, 1),
    "atan": (29, 2),
    "atanh": (33, 2),
    "pow": (66, 1),
    "sqrt": (1, 0),
}


@dataclass
class Work:
    """What a part of a step takes."""

    operations: float = 0
    divisions: float = 0  # among the operations
    functions: float = 0  # exp and others, whose series are among the operations
    calls: float = 0  # of the kernels that begin the part


class Tally:
    """What was counted, by part, in the part that runs now."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget what was counted, and count for the structure."""
        self.parts = {part: Work() for part in (STRUCTURE_PART, *PARTS.values())}
        self.work = self.parts[STRUCTURE_PART]

    def add(self, operations: int, divisions: int = 0, functions: int = 0) -> None:
        """Count what an operator or a function takes."""
        self.work.operations += operations
        self.work.divisions += divisions
        self.work.functions += functions


TALLY = Tally()


def _counted(name: str, operations: int, divisions: int) -> Callable[..., Any]:
    plain_operation = getattr(float, name)

    def operation(*numbers: Any) -> Any:
        TALLY.add(operations, divisions, int(operations > 1))
        return Counted(plain_operation(*numbers))

    return operation


class Counted(float):
    """A number whose operations are counted; signs are not."""

    __slots__ = ()

    def __neg__(self) -> "Counted":
        return Counted(float.__neg__(self))

    def __abs__(self) -> "Counted":
        return Counted(float.__abs__(self))


for _name in ("add", "sub", "mul", "truediv", "pow"):
    _series = SERIES.get(_name, (1, int(_name == "truediv")))
    setattr(Counted, f"__{_name}__", _counted(f"__{_name}__", *_series))
    setattr(Counted, f"__r{_name}__", _counted(f"__r{_name}__", *_series))


class CountedMath:
    """The module `math` for kernels, whose functions are counted."""

    def __getattr__(self, name: str) -> Any:
        """Return a function, or a constant."""
        value = getattr(math, name)
        if name not in SERIES:
            return value

        def function(number: float) -> Counted:
            TALLY.add(*SERIES[name], functions=int(name != "sqrt"))
            return Counted(value(number))

        return function


def counting(value: Any, arrays: dict[int, Any]) -> Any:
    """Return the records of a kernel's argument with counted numbers.

    `arrays` has the arrays that were replaced by their address, since some are views of others.
    """
    if isinstance(value, tuple):
        parts = [counting(part, arrays) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, float):
        return Counted(value)
    if not isinstance(value, np.ndarray) or value.dtype.kind in "ib":
        return value
    base = value.base if isinstance(value.base, np.ndarray) else value
    if base is not value and base.shape[1:] == value.shape and base.size:
        place = (value.ctypes.data - base.ctypes.data) // base.strides[0]
        return counting(base, arrays)[place]
    if id(value) not in arrays:
        arrays[id(value)] = _counted_array(value)
    return arrays[id(value)]


def _counted_array(value: Any) -> Any:
    if value.dtype.names is None:
        numbers = np.empty(value.shape, dtype=object)
        numbers.flat[:] = [Counted(number) for number in value.flat]
        return numbers
    kinds = [
        (name, object if value.dtype[name].kind == "f" else value.dtype[name])
        for name in value.dtype.names
    ]
    records = np.zeros(value.shape, dtype=np.dtype((np.record, kinds)))
    for name, _ in kinds:
        records[name] = counting(np.array(value[name]), {})
    return records


def _in_part(kernel: Kernel) -> Callable[..., Any]:
    """Return the plain Python of a kernel, what it does being counted in its part."""
    part = PARTS.get(kernel)
    if part is None:
        return kernel.py_func

    def run(*arguments: Any) -> Any:
        before, TALLY.work = TALLY.work, TALLY.parts[part]
        TALLY.work.calls += 1
        try:
            return kernel.py_func(*arguments)
        finally:
            TALLY.work = before

    return run


def _kernel_modules() -> list[Any]:
    names = ("thermobearing.core.", "thermobearing.structure.")
    return [module for name, module in sys.modules.items() if name.startswith(names)]


@contextmanager
def plain_kernels(march: Kernel, replacement: Callable[..., Any]) -> Iterator[None]:
    """Run kernels as plain Python that counts, and `replacement` in place of one of them."""
    modules = _kernel_modules()
    kernels = {
        id(item): item
        for module in modules
        for item in vars(module).values()
        if isinstance(item, Kernel)
    }.values()
    before = [kernel.run for kernel in kernels]
    with_math = [module for module in modules if vars(module).get("math") is math]
    for kernel in kernels:
        kernel.run = _in_part(kernel)
    for module in with_math:
        module.math = CountedMath()
    march.run = replacement
    try:
        yield
    finally:
        for kernel, run in zip(kernels, before, strict=True):
            kernel.run = run
        for module in with_math:
            module.math = math


def count(bearing_name: str, cells: dict[str, Any]) -> dict[str, Work]:
    """Return what a step of pier P1 on a bearing takes on average, by part."""
    bearing = tb.load_bearing(bearing_name)
    bearing = bearing.model_copy(update={"cells": bearing.cells.model_copy(update=cells)})
    stack = build_stack(bearing, half=True)
    constants = build_constants(bearing, stack, upper=EndFace(eta=2.0), lower=None)
    prepared = prepare_structure(load_structure(STRUCTURE))
    line = Line(constants, np.full(len(constants.cells.capacity), AMBIENT))
    run = Run(prepared, [line], ground()[FIRST : FIRST + STEPS + 1], DT, AMBIENT)

    def march(*arguments: Any) -> tuple[int, int, int]:
        counted = counting(arguments, {})
        TALLY.clear()
        result: tuple[int, int, int] = newmark.peaks_march.py_func(*counted)
        return result

    with plain_kernels(newmark.peaks_march, march):
        peaks = run_peaks(run)
    assert peaks.steps == STEPS, peaks.outcome
    return {
        part: Work(*(number / STEPS for number in vars(work).values()))
        for part, work in TALLY.parts.items()
    }


def total(parts: dict[str, Work]) -> Work:
    """Return the sum of the parts of a step, and its trials as calls."""
    columns = zip(*(vars(work).values() for work in parts.values()), strict=True)
    operations, divisions, functions, _ = map(sum, columns)
    return Work(operations, divisions, functions, parts[PARTS[sharing.share]].calls)


def rows() -> list[Row]:
    """One row for each part and bearing, and the sum with its limit."""
    table = []
    for name, (operations, divisions) in LIMITS.items():
        parts = count(*BEARINGS[name])
        step_work = total(parts)
        for part, work in parts.items():
            note = f"{work.divisions:.0f} divisions, {work.functions:.1f} functions"
            table.append(plain(f"{name}, {part}", work.operations, note=note))
        note = f"{step_work.calls:.2f} trials, {step_work.functions:.1f} functions"
        what = f"{name}: operations of a step, pier P1"
        table.append(at_most(what, step_work.operations, operations, note=note))
        what = f"{name}: divisions of a step, pier P1"
        table.append(at_most(what, step_work.divisions, divisions))
    return table
