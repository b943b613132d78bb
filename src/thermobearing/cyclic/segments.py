"""A test sampled for one bearing: where it is at the end of each time step."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.cyclic.protocol import (
    FEWEST_STEPS,
    REST_GROWTH,
    REST_START,
    TINY,
    Cycles,
    CyclicTest,
    Floats,
    Ramp,
    Recorded,
    Rest,
    survey,
)


@dataclass(frozen=True)
class Segment:
    """One step of a test, sampled: where the bearing is at the end of each time step."""

    kind: str
    label: str
    x: Floats  # [mm]
    dt: Floats  # [s]
    cycle: NDArray[np.int32]  # number of the cycle within the segment, 0 outside cycles
    turning: NDArray[np.bool_]  # a leg ends here: always kept in a result
    amplitude_strain: float = 0.0
    settle: float = 0.0  # stop once within this of the ambient [K]
    assumed: tuple[str, ...] = ()  # what the file of a recording does not say


def _legs(duration: float, dt: float) -> int:
    """Number of equal steps, none longer than dt, that fill a leg."""
    return max(1, math.ceil(duration / dt - TINY))


def _cycle_shape(wave: str, steps: int) -> Floats:
    """One cycle 0, 1, 0, -1, 0 of unit amplitude; `steps` per quarter, peaks hit exactly."""
    rising = np.arange(1, steps + 1) / steps
    if wave == "sine":
        rising = np.sin(0.5 * np.pi * rising)
    falling = np.concatenate([rising[-2::-1], [0.0]])
    return np.concatenate([rising, falling, -rising, -falling])


def _cycles(step: Cycles, rubber: float, dt: float, label: str) -> list[Segment]:
    parts = [(step.size(rubber), step.count, "cycles", label)]
    if step.closing_strain is not None:
        parts.append((step.closing_strain * rubber, 1, "closing cycle", f"{label}, closing cycle"))
    segments = []
    for (size, count, kind, name), quarter in zip(parts, step.quarters(rubber), strict=True):
        steps = max(FEWEST_STEPS, _legs(quarter, dt))
        shape = _cycle_shape(step.wave, steps)
        turning = np.zeros(4 * steps, dtype=bool)
        turning[steps - 1 :: steps] = True
        numbers = np.repeat(np.arange(1, count + 1, dtype=np.int32), 4 * steps)
        segments.append(
            Segment(
                kind=kind,
                label=name,
                x=np.tile(size * shape, count),
                dt=np.broadcast_to(quarter / steps, 4 * steps * count),
                cycle=numbers if kind == "cycles" else np.zeros_like(numbers),
                turning=np.tile(turning, count),
                amplitude_strain=size / rubber,
            )
        )
    return segments


def _ramp(step: Ramp, rubber: float, dt: float, start: float) -> Segment:
    target = step.target(rubber)
    duration = step.seconds(abs(target - start))
    steps = _legs(duration, dt)
    x = start + (target - start) * np.arange(1, steps + 1) / steps
    x[-1] = target
    span = max(duration, TINY)
    return _plain("ramp", f"ramp to {target:g} mm", x, np.full(steps, span / steps))


def _rest(step: Rest, dt: float, start: float) -> Segment:
    duration, longest = step.span, step.longest_step(dt)
    steps = [min(dt, duration, REST_START)]
    left = duration - steps[0]
    while left > 0.0:
        size = min(steps[-1] * REST_GROWTH, longest)
        if left < 1.5 * size:
            size = left
        steps.append(size)
        left -= size
    label = f"rest {duration:g} s" if step.duration else f"rest until within {step.within:g} K"
    return _plain("rest", label, np.full(len(steps), start), np.array(steps), step.within or 0.0)


def _plain(kind: str, label: str, x: Floats, dt: Floats, settle: float = 0.0) -> Segment:
    turning = np.zeros(len(x), dtype=bool)
    turning[-1] = True
    return Segment(kind, label, x, dt, np.zeros(len(x), dtype=np.int32), turning, settle=settle)


def _recorded(step: Recorded, rubber: float, dt: float, start: float) -> Segment:
    """A recorded history, each of its intervals cut into equal steps no longer than dt."""
    gaps, displacement, assumed = step.points(start)
    counts = np.maximum(1, np.ceil(gaps / dt - TINY).astype(np.int64))
    steps = np.repeat(gaps / counts, counts)
    ends = np.cumsum(counts) - 1
    x = np.interp(np.arange(counts.sum()) + 1, np.concatenate([[0], ends + 1]), displacement)
    turns = np.zeros(len(x), dtype=bool)
    turns[ends] = True
    cycle = np.zeros(len(x), dtype=np.int32)
    peak = float(np.abs(displacement).max()) / rubber
    said = tuple(f"{step.name}: {text}" for text in assumed)
    return Segment("recorded", step.name, x, steps, cycle, turns, peak, assumed=said)


def build_segments(
    test: CyclicTest, total_rubber_thickness: float, start: float = 0.0
) -> list[Segment]:
    """Sample a test for a bearing.

    Parameters
    ----------
    test : what to do.
    total_rubber_thickness : what strains refer to [mm].
    start : where the bearing is at the beginning [mm].

    Raises
    ------
    InputError : a step that cannot follow the one before, or an unusable recording.
    """
    faults, _ = survey(test, total_rubber_thickness, start)
    if faults:
        raise InputError(faults, test.name)
    segments: list[Segment] = []
    at = start
    for step in test.steps:
        if isinstance(step, Cycles):
            label = f"{step.strain:.0%}" if step.strain else f"{step.amplitude:g} mm"
            segments += _cycles(step, total_rubber_thickness, test.dt, label)
        elif isinstance(step, Ramp):
            segments.append(_ramp(step, total_rubber_thickness, test.dt, at))
        elif isinstance(step, Rest):
            segments.append(_rest(step, test.dt, at))
        else:
            segments.append(_recorded(step, total_rubber_thickness, test.dt, at))
        at = float(segments[-1].x[-1])
    return segments


def longest_layer_increment(segments: list[Segment], layers: int, start: float = 0.0) -> float:
    """Largest displacement of one rubber layer in a step of a test from `start` on [mm]."""
    x = np.concatenate([[start], *(segment.x for segment in segments)])
    return float(np.abs(np.diff(x)).max()) / layers
