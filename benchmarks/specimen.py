"""What most benches run: the HDR specimen (19 cells, 3 layers in the half stack), Table 3.4."""

import time
from collections.abc import Callable

import numpy as np

import thermobearing as tb
from thermobearing.bearing.ambient import Ambient
from thermobearing.core.types import Constants
from thermobearing.cyclic.history import History, Segment, build_segments, run_segments
from thermobearing.model.constants import LeadEnds, build_constants
from thermobearing.model.stack import EndFace, build_stack

NAME = "shen-hdr-specimen"
AMBIENTS = (-20.0, 0.0, 23.0)  # [degC]
ETA = 2.0


def specimen_constants(name: str = NAME, lead_ends: LeadEnds = "half-space") -> Constants:
    """Of the half stack, conservative scheme, exact integrator."""
    bearing = tb.load_bearing(name)
    stack = build_stack(bearing, half=True)
    return build_constants(bearing, stack, upper=EndFace(eta=ETA), lower=None, lead_ends=lead_ends)


def table_34(name: str = NAME) -> list[Segment]:
    """The whole of Table 3.4 with its rests, steps of 5 ms; sine waves for bearings with lead."""
    bearing = tb.load_bearing(name)
    test = tb.cyclic_test(wave="triangular" if bearing.lead is None else "sine")
    return build_segments(test, bearing.total_rubber_thickness)


def run_at(constants: Constants, segments: list[Segment], ambient: float) -> History:
    """One run, everything kept that is kept by default."""
    start = np.full(len(constants.cells.capacity), ambient)
    return run_segments(constants, segments, Ambient.constant(ambient), start)


def seconds(function: Callable[[], object], repeats: int) -> list[float]:
    """Processor time of each call, after one that does not count; sorted.

    Everything here runs on one core, where this is the wall time of an idle machine; on a busy
    one the wall time would count the neighbours.
    """
    function()
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        function()
        times.append(time.process_time() - begin)
    return sorted(times)


def step_microseconds(
    ambient: float = 23.0,
    repeats: int = 20,
    name: str = NAME,
    lead_ends: LeadEnds = "half-space",
) -> tuple[float, float]:
    """Fastest and median time of one coupled step over Table 3.4, histories kept [us]."""
    constants, segments = specimen_constants(name, lead_ends), table_34(name)
    count = run_at(constants, segments, ambient).steps
    times = seconds(lambda: run_at(constants, segments, ambient), repeats)
    return 1e6 * times[0] / count, 1e6 * times[len(times) // 2] / count
