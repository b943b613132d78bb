"""What would take hours or more memory than there is, is reported before anything is computed."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.inputs import SPECIMEN, assert_refused
from tests.verification.structures import real_bearing, shaken
from thermobearing.cyclic.equivalent import MOST_STEPS, isothermal_cycle
from thermobearing.cyclic.history import build_segments
from thermobearing.cyclic.protocol import MAX_CYCLES, survey
from thermobearing.design.factors import scaled_bearing
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.record import record_from_arrays
from thermobearing.model import effort
from thermobearing.structure import newmark

HDR = "shen-hdr-bridge"

RUBBER = 30.0
TIME = np.linspace(0.0, 4.0, 161)
MOVED = 30.0 * np.sin(np.pi * TIME)
RECORD = record_from_arrays(TIME, MOVED, 2.0 * MOVED, 23.0)


def steps(*given: dict[str, Any], **options: Any) -> tb.CyclicTest:
    return tb.CyclicTest(steps=list(given), **options)


def cycles(**changes: Any) -> dict[str, Any]:
    return {"step": "cycles", "strain": 1.0, "period": 2.0, "count": 1} | changes


COUNTED = {
    "cycles": steps(cycles(count=7), dt=0.01),
    "closing cycle": steps(cycles(closing_strain=0.1, speed=30.0, period=None), dt=0.01),
    "coarse cycles": steps(cycles(count=50), dt=10.0),
    "ramp": steps({"step": "ramp", "to_strain": 1.0, "duration": 33.3}, dt=0.1),
    "rest": steps({"step": "rest", "duration": 4500.0}),
    "rest of years": steps({"step": "rest", "duration": 1e8}),
    "rest of a blink": steps({"step": "rest", "duration": 1e-6}, dt=10.0),
    "rest until": steps({"step": "rest", "within": 0.5}),
}


@pytest.mark.parametrize("test", COUNTED.values(), ids=COUNTED)
def test_steps_are_known_before_they_are_made(test: tb.CyclicTest) -> None:
    _, counted = survey(test, RUBBER)
    made = sum(len(segment.x) for segment in build_segments(test, RUBBER))
    assert made <= counted + 8.0
    assert counted <= 1.02 * made + 350.0  # a rest of a blink counts the growth it has no time for


@pytest.mark.parametrize(
    ("make", "pieces"),
    [
        (
            lambda: tb.run(SPECIMEN, steps(cycles(count=20_000), cycles(count=1))),
            ["test.", f"20001 cycles; the limit for one test is {MAX_CYCLES}"],
        ),
        (
            lambda: tb.run(SPECIMEN, steps(*[{"step": "rest", "duration": 1e8}] * 200)),
            ["3.34e+07 steps", f"the limit is {effort.MAX_STEPS}"],
        ),
        (
            lambda: tb.run(SPECIMEN, steps(cycles(count=20_000)), [-20, 0, 23]),
            ["2.4e+07 steps;", "fewer ambient temperatures"],
        ),
        (
            lambda: tb.run(large_stack(), steps(cycles(count=10_000), dt=0.002)),
            ["1e+07 steps of 4", "fewer cells"],
        ),
        (
            lambda: tb.run(SPECIMEN, steps(cycles(count=20_000), dt=0.002)),
            ["numbers", "keep_every", "times as large"],
        ),
        (lambda: tb.run(SPECIMEN, steps(*[cycles()] * 10_001)), ["steps", "at most 10000 entries"]),
        (
            lambda: tb.run(SPECIMEN, steps(cycles()), list(np.linspace(-50, 50, 1001))),
            ["ambient", "at most 1000 entries"],
        ),
        (
            lambda: tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 0, dt=1e-6),
            ["needs 5e+07 steps", "larger dt"],
        ),
        (
            lambda: tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 0, duration=0.001),
            ["duration = 0.001 s", "shorter than a step"],
        ),
        (
            lambda: tb.bridge("shen-hdr-bridge", "jra-ii-i-1", np.linspace(-50, 50, 1000)),
            ["stores", "`thermobearing study`"],
        ),
        (
            lambda: tb.bridge("shen-hdr-bridge", "jra-ii-i-1", np.linspace(-50, 50, 1500)),
            ["ambient: 1500 entries", "at most 1000", "`thermobearing study`"],
        ),
        (
            lambda: tb.identify_bearing([RECORD], SPECIMEN, starts=10**9),
            ["starts = 1000000000", "from 1 to 100"],
        ),
        (lambda: tb.equal_bearing("shen-hdr-bridge", 2.0, 5e4), ["1681 layers", "limit is 200"]),
        (lambda: tb.equal_bearing("shen-hdr-bridge", float("nan"), 200), ["stiffness = nan"]),
        (lambda: synthetic_record(SPECIMEN, 23.0, sampling=0.0), ["sampling = 0.0"]),
    ],
    ids=range(15),
)
def test_too_much_is_reported(
    make: Callable[[], Any], pieces: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: Any, **__: Any) -> None:
        pytest.fail("it was begun")

    for place in ("cyclic.run.run_segments", "earthquake.run.run_structure"):
        monkeypatch.setattr(f"thermobearing.{place}", never)
    assert_refused(make, *pieces)


def large_stack() -> tb.Bearing:
    bearing = tb.load_bearing(SPECIMEN)
    geometry = bearing.geometry.model_copy(update={"rubber_layers": 200})
    cells = bearing.cells.model_copy(update={"shim": 2})
    return bearing.model_copy(update={"geometry": geometry, "cells": cells})


def test_what_is_honest_is_not_too_much() -> None:
    """A million steps of the largest bearing; twenty million of a usual one, few of them kept."""
    assert effort.too_much(1e6, 600, 1e8) == []
    assert effort.too_much(effort.MAX_STEPS, 19, 1e8) == []
    assert effort.too_much(effort.MAX_STEPS, 19, 1.01 * effort.MAX_KEPT) != []
    assert effort.too_much(1e6, 1.01 * effort.MAX_CELL_STEPS / 1e6, 1e8) != []
    assert effort.analysis_too_much([(8000.0, 100.0, 60.0)] * 500) == []
    assert effort.analysis_too_much([(8000.0, 100.0, 60.0)] * 50_000) != []


def test_a_cycle_without_heat_has_a_bounded_number_of_steps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A bearing of metres at 30 mm/s took millions of steps to find its bilinear model."""
    from thermobearing.cyclic import equivalent

    lengths = []
    run_segments = equivalent.run_segments

    def counted(constants: Any, segments: Any, *rest: Any, **options: Any) -> Any:
        lengths.append(sum(len(segment.x) for segment in segments))
        return run_segments(constants, segments, *rest, **options)

    monkeypatch.setattr(equivalent, "run_segments", counted)
    small, large = (
        isothermal_cycle(scaled_bearing("shen-hdr-bridge", factor), 1.75) for factor in (1.0, 100.0)
    )
    assert lengths[0] < lengths[1] <= 3 * 4 * MOST_STEPS
    assert large.h_eq == pytest.approx(small.h_eq, rel=1e-3)


@pytest.mark.parametrize("most", [100, 0])
def test_iterations_of_a_run_are_bounded(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A step may take hundreds of iterations in its parts, all steps together may not."""
    monkeypatch.setattr(newmark, "MOST_ITERATIONS", most)
    march = "thermobearing.structure.run.newmark_march"
    monkeypatch.setattr(march, newmark.newmark_march.py_func)  # compiled, it has its own number
    jumps = np.array([0.0, *[1e4, -1e4] * 10])  # mm/s2, every 0.1 s
    _, history = shaken("pier-p1", real_bearing("shen-hdr-bridge"), jumps, 0.1)
    assert history.outcome == ("completed" if most else "no_equilibrium")
    assert (history.substeps > 0) is bool(most)
