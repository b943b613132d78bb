"""Displacement-controlled tests as a list of typed steps: cycles, ramps, rests, recordings.

Steps are data (they come from TOML or Python and go back to it); `build_segments` turns them
into displacements and time steps for one bearing. Amplitudes are given as shear strain of
the total rubber thickness or in mm.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from thermobearing.bearing.schema import Strict, in_unit
from thermobearing.errors import InputError
from thermobearing.tables import read_columns

Floats = NDArray[np.float64]
Seconds = Annotated[float, in_unit("s"), Field(gt=0)]
Strain = Annotated[float, Field(gt=0, le=5)]
Millimetres = Annotated[float, in_unit("mm"), Field(gt=0)]

REST_GROWTH = 1.05  # each step of a rest against the one before
REST_STEPS = 100  # no step of a rest is longer than this part of it
SETTLE_LIMIT = 14 * 24 * 3600.0  # "until within" gives up after two weeks [s]
MAX_STEPS = 50_000_000  # of one segment: more is surely a slip in dt or a period
TINY = 1e-9


def _exactly_one(names: Mapping[str, object], what: str) -> None:
    given = [name for name, value in names.items() if value is not None]
    if len(given) != 1:
        raise ValueError(f"{what}: give exactly one of {', '.join(names)}; got {given or 'none'}")


class Cycles(Strict):
    """Fully reversed cycles about zero.

    `speed` gives every cycle the period 4a/speed, for the triangle its constant speed, for
    the sine the same mean speed (Table 3.4).
    """

    step: Literal["cycles"] = "cycles"
    strain: Strain | None = None
    amplitude: Millimetres | None = None
    wave: Literal["triangular", "sine"] = "triangular"
    speed: Annotated[float, in_unit("mm/s"), Field(gt=0)] | None = None
    period: Seconds | None = None
    frequency: Annotated[float, in_unit("Hz"), Field(gt=0)] | None = None
    count: Annotated[int, Field(ge=1, le=100_000)] = 5
    closing_strain: Strain | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Cycles":
        _exactly_one({"strain": self.strain, "amplitude": self.amplitude}, "cycles")
        timing = {"speed": self.speed, "period": self.period, "frequency": self.frequency}
        _exactly_one(timing, "cycles")
        return self


class Ramp(Strict):
    """One straight move to a strain or displacement, at a speed or over a time."""

    step: Literal["ramp"] = "ramp"
    to_strain: Annotated[float, Field(ge=-5, le=5)] | None = None
    to: Annotated[float, in_unit("mm")] | None = None
    speed: Annotated[float, in_unit("mm/s"), Field(gt=0)] | None = None
    duration: Seconds | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Ramp":
        _exactly_one({"to_strain": self.to_strain, "to": self.to}, "ramp")
        _exactly_one({"speed": self.speed, "duration": self.duration}, "ramp")
        return self


class Rest(Strict):
    """No motion, for a time or until every cell is `within` some kelvin of the ambient."""

    step: Literal["rest"] = "rest"
    duration: Seconds | None = None
    within: Annotated[float, in_unit("K"), Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Rest":
        _exactly_one({"duration": self.duration, "within": self.within}, "rest")
        return self


class Recorded(Strict):
    """A displacement history from a CSV file with columns time and displacement."""

    step: Literal["recorded"] = "recorded"
    file: Annotated[str, Field(min_length=1)]


Step = Annotated[Cycles | Ramp | Rest | Recorded, Field(discriminator="step")]


class CyclicTest(Strict):
    """A named list of steps. `dt` is the largest time step while the bearing moves."""

    name: str = "test"
    dt: Annotated[float, in_unit("s"), Field(gt=0, le=10)] = 0.005
    steps: Annotated[list[Step], Field(min_length=1)]


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


def _legs(duration: float, dt: float) -> int:
    """Number of equal steps, none longer than dt, that fill a leg."""
    count = max(1, math.ceil(duration / dt - TINY))
    if count > MAX_STEPS:
        raise InputError(f"a leg of {duration:g} s in steps of {dt:g} s makes {count} steps")
    return count


def _cycle_shape(wave: str, steps: int) -> Floats:
    """One cycle 0, 1, 0, -1, 0 of unit amplitude; `steps` per quarter, peaks hit exactly."""
    rising = np.arange(1, steps + 1) / steps
    if wave == "sine":
        rising = np.sin(0.5 * np.pi * rising)
    falling = np.concatenate([rising[-2::-1], [0.0]])
    return np.concatenate([rising, falling, -rising, -falling])


def _cycles(step: Cycles, rubber: float, dt: float, label: str) -> list[Segment]:
    amplitude = step.amplitude if step.amplitude is not None else (step.strain or 0.0) * rubber
    period = step.period or (1.0 / step.frequency if step.frequency else None)
    speed = step.speed if period is None else 4.0 * amplitude / period
    assert speed is not None  # one of the three was given: see Cycles._consistent
    parts = [(amplitude, step.count, "cycles", label)]
    if step.closing_strain is not None:
        parts.append((step.closing_strain * rubber, 1, "closing cycle", f"{label}, closing cycle"))
    segments = []
    for size, count, kind, name in parts:
        quarter = size / speed
        steps = _legs(quarter, dt)
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
    target = step.to if step.to is not None else (step.to_strain or 0.0) * rubber
    distance = abs(target - start)
    duration = step.duration or distance / (step.speed or 1.0)
    steps = _legs(duration, dt)
    x = start + (target - start) * np.arange(1, steps + 1) / steps
    x[-1] = target
    span = max(duration, TINY)
    return _plain("ramp", f"ramp to {target:g} mm", x, np.full(steps, span / steps))


def _rest(step: Rest, dt: float, start: float) -> Segment:
    duration = step.duration or SETTLE_LIMIT
    longest = max(dt, min(duration / REST_STEPS, 600.0))
    steps = [min(dt, duration)]
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
    data = read_columns(step.file, {"time": "s", "displacement": "mm"})
    time, displacement = data["time"], data["displacement"]
    gaps = np.diff(time)
    if not (gaps > 0).all():
        line = int(np.argmin(gaps > 0)) + 3
        raise InputError(f"line {line}: time does not increase", step.file)
    if abs(displacement[0] - start) > 1e-3 * max(1.0, float(np.abs(displacement).max())):
        raise InputError(
            f"starts at {displacement[0]:g} mm but the bearing is at {start:g} mm; "
            "put a ramp before it",
            step.file,
        )
    if np.abs(displacement).max() > 5.0 * rubber:
        raise InputError(
            f"reaches {np.abs(displacement).max():g} mm, more than 500 % of the total rubber "
            f"thickness of {rubber:g} mm; is the unit right?",
            step.file,
        )
    counts = np.maximum(1, np.ceil(gaps / dt - TINY).astype(np.int64))
    if counts.sum() > MAX_STEPS:
        raise InputError(f"needs {counts.sum()} steps of {dt:g} s", step.file)
    steps = np.repeat(gaps / counts, counts)
    ends = np.cumsum(counts) - 1
    x = np.interp(np.arange(counts.sum()) + 1, np.concatenate([[0], ends + 1]), displacement)
    turns = np.zeros(len(x), dtype=bool)
    turns[ends] = True
    cycle = np.zeros(len(x), dtype=np.int32)
    name = Path(step.file).name
    peak = float(np.abs(displacement).max()) / rubber
    return Segment("recorded", name, x, steps, cycle, turns, amplitude_strain=peak)


def build_segments(test: CyclicTest, total_rubber_thickness: float) -> list[Segment]:
    """Sample a test for a bearing.

    Parameters
    ----------
    test : what to do.
    total_rubber_thickness : what strains refer to [mm].

    Raises
    ------
    InputError : a step that cannot follow the one before, or an unusable recording.
    """
    segments: list[Segment] = []
    at = 0.0
    for number, step in enumerate(test.steps, 1):
        if isinstance(step, Cycles):
            if abs(at) > TINY:
                raise InputError(
                    f"step {number}: cycles start from zero, but the bearing is at {at:g} mm; "
                    "put a ramp to 0 mm before them"
                )
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


def longest_layer_increment(segments: list[Segment], layers: int) -> float:
    """Largest displacement of one rubber layer in one step of a test [mm]."""
    x = np.concatenate([[0.0], *(segment.x for segment in segments)])
    return float(np.abs(np.diff(x)).max()) / layers


def cyclic_test(
    strain: list[float] | tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 2.5),
    *,
    cycles: int = 5,
    wave: Literal["triangular", "sine"] = "triangular",
    speed: float = 30.0,
    rest: float | None = 4500.0,
    closing_strain: float | None = 0.1,
    dt: float = 0.005,
) -> CyclicTest:
    """Cycles at several amplitudes with rests between; without arguments, Table 3.4.

    Parameters
    ----------
    strain : shear strain amplitudes, each > 0.
    cycles : fully reversed cycles at each amplitude.
    wave : "triangular" (constant speed) or "sine"; both have the period 4a/speed.
    speed : mean loading rate [mm/s].
    rest : pause between amplitudes [s], 1.25 h by default (the source says 1 to 1.5 h);
        None for no pause.
    closing_strain : amplitude of the one small cycle that stops the loading smoothly after
        each amplitude (section 3.3.1; its size is not printed, 0.1 is our choice); None for
        none.
    dt : largest time step while the bearing moves [s].

    Returns
    -------
    CyclicTest

    Raises
    ------
    InputError : a value out of range.

    Examples
    --------
    >>> [step.step for step in cyclic_test(strain=[0.5, 1.0]).steps]
    ['cycles', 'rest', 'cycles']
    """
    from thermobearing.bearing.schema import validated

    steps: list[dict[str, object]] = []
    for level in np.atleast_1d(np.asarray(strain, dtype=float)):
        if steps and rest is not None:
            steps.append({"step": "rest", "duration": rest})
        steps.append(
            {
                "step": "cycles",
                "strain": float(level),
                "count": cycles,
                "wave": wave,
                "speed": speed,
                "closing_strain": closing_strain,
            }
        )
    data = {"name": "Table 3.4" if len(steps) == 9 else "cyclic test", "dt": dt, "steps": steps}
    return validated(CyclicTest, data, "cyclic_test()", from_file=False)
