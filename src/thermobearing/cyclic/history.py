"""Sample the steps of a test and march a bearing through them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.ambient import Ambient
from thermobearing.border.errors import InputError
from thermobearing.core.lead_ends import longest_rest_step
from thermobearing.core.march import keep_row, march
from thermobearing.core.plane import count_components, march_plane, plain
from thermobearing.core.records import Floats, Rows, unset
from thermobearing.core.types import (
    COMPLETED,
    SOFTENED,
    AxialResponse,
    BearingResponse,
    Constants,
    Kept,
    Path,
    State,
    Workspace,
    new_state,
    new_workspace,
)
from thermobearing.cyclic.protocol import (
    FEWEST_STEPS,
    REST_GROWTH,
    REST_START,
    SIDES,
    TINY,
    Cycles,
    CyclicTest,
    PlanePath,
    Ramp,
    Recorded,
    Rest,
    distance,
    lengths,
    lifted,
    place_text,
    survey,
)
from thermobearing.model.outcomes import INTERRUPTED, NAMES, NOT_PHYSICAL, is_physical


@dataclass(frozen=True)
class Segment:
    """One step of a test, sampled: where the bearing is at the end of each time step."""

    kind: str
    label: str
    x: Floats  # [mm]; [steps], or [steps, 2] in a plane
    dt: Floats  # [s]
    cycle: NDArray[np.int32]  # number of the cycle within the segment, 0 outside cycles
    turning: NDArray[np.bool_]  # a leg ends here: always kept in a result
    amplitude_strain: float = 0.0
    within: float = 0.0  # stop once within this of the ambient [K]
    assumed: tuple[str, ...] = ()  # what the file of a recording does not say


def _equal_steps(duration: float, dt: float) -> int:
    # A quotient that exceeds an integer by its rounding makes no further step.
    return max(1, math.ceil(duration / dt - TINY))


def _cycle_shape(wave: str, steps: int) -> Floats:
    rising = np.arange(1, steps + 1) / steps
    if wave == "sine":
        rising = np.sin(0.5 * np.pi * rising)
    falling = np.concatenate([rising[-2::-1], [0.0]])
    return np.concatenate([rising, falling, -rising, -falling])


def _cycle_segments(step: Cycles, rubber: float, dt: float) -> list[Segment]:
    label = f"{step.strain:.0%}" if step.strain else f"{step.amplitude:g} mm"
    parts = [(step.size(rubber), step.count, "cycles", label)]
    if step.closing_strain is not None:
        parts.append((step.closing_strain * rubber, 1, "closing cycle", f"{label}, closing cycle"))
    segments = []
    for (size, count, kind, name), quarter in zip(parts, step.quarters(rubber), strict=True):
        steps = max(FEWEST_STEPS, _equal_steps(quarter, dt))
        x = np.tile(size * _cycle_shape(step.wave, steps), count)
        numbers = np.repeat(np.arange(1, count + 1, dtype=np.int32), 4 * steps)
        segments.append(
            Segment(
                kind=kind,
                label=name,
                x=x,
                dt=np.broadcast_to(quarter / steps, len(x)),
                cycle=numbers if kind == "cycles" else np.zeros_like(numbers),
                turning=np.arange(1, len(x) + 1) % steps == 0,
                amplitude_strain=size / rubber,
            )
        )
    return segments


def _path_segments(step: PlanePath, rubber: float, dt: float) -> list[Segment]:
    """Return the turns on a path, with ramps from the origin and to it where they are away."""
    duration, size = step.turn_duration(rubber), step.size(rubber)
    sides = step.sides(duration, dt)
    points, steps_per_turn = size * step.points(sides), SIDES * sides
    count, origin, ramp = steps_per_turn * step.count, np.zeros(2), step.ramp_duration(rubber)
    label = f"{step.strain:.0%}" if step.strain else f"{step.amplitude:g} mm"
    turns = Segment(
        kind="path",
        label=f"{step.path} of {label}",
        x=points[1:],
        dt=np.full(count, duration / steps_per_turn),
        cycle=np.repeat(np.arange(1, step.count + 1, dtype=np.int32), steps_per_turn),
        turning=np.arange(1, count + 1) % sides == 0,
        amplitude_strain=size / rubber,
    )
    # A path may begin or end at the origin, as a cruciform does: no ramp is needed there.
    segments = [turns]
    if distance(points[0]):
        segments.insert(0, _straight(origin, points[0], ramp, dt))
    if distance(points[-1]):
        segments.append(_straight(points[-1], origin, ramp, dt))
    return segments


def _ramp(step: Ramp, rubber: float, dt: float, start: float | Floats) -> Segment:
    target = step.target(rubber)
    end = target if np.ndim(start) == 0 else lifted(target)
    return _straight(start, end, step.seconds(distance(end, start)), dt)


def _straight(start: float | Floats, end: float | Floats, duration: float, dt: float) -> Segment:
    steps = _equal_steps(duration, dt)
    part = np.arange(1, steps + 1)
    x = np.stack([a + (b - a) * part / steps for a, b in np.atleast_2d(np.c_[start, end])], axis=-1)
    # The next step begins at `end` itself, not within a rounding of it.
    x[-1] = end
    x = x[:, 0] if np.ndim(start) == 0 else x
    # A ramp to where the bearing is takes no time, but a step of the model needs some.
    span = max(duration, TINY)
    return _segment_without_cycles(
        "ramp", f"ramp to {place_text(end)} mm", x, np.full(steps, span / steps)
    )


def _rest(step: Rest, dt: float, start: float | Floats) -> Segment:
    duration, longest = step.span, step.longest_step(dt)
    steps = [min(dt, duration, REST_START)]
    remaining = duration - steps[0]
    while remaining > 0.0:
        size = min(steps[-1] * REST_GROWTH, longest)
        # The last step takes what would remain as less than half a step.
        if remaining < 1.5 * size:
            size = remaining
        steps.append(size)
        remaining -= size
    label = f"rest {duration:g} s" if step.duration else f"rest until within {step.within:g} K"
    x = np.full((len(steps), *np.shape(start)), start)
    return _segment_without_cycles("rest", label, x, np.array(steps), step.within or 0.0)


def _segment_without_cycles(
    kind: str, label: str, x: Floats, dt: Floats, within: float = 0.0
) -> Segment:
    turning = np.arange(len(x)) == len(x) - 1
    return Segment(kind, label, x, dt, np.zeros(len(x), dtype=np.int32), turning, within=within)


def _recorded(step: Recorded, rubber: float, dt: float, start: float | Floats) -> Segment:
    gaps, displacement, assumed = step.points(start)
    if np.ndim(start) and displacement.ndim == 1:
        displacement = lifted(displacement)
    # Gaps longer than dt are divided into equal steps on a straight line.
    counts = np.maximum(1, np.ceil(gaps / dt - TINY).astype(np.int64))
    steps = np.repeat(gaps / counts, counts)
    ends = np.concatenate([[0], np.cumsum(counts)])
    numbers = np.arange(counts.sum()) + 1
    turns, peak = np.isin(numbers, ends), float(lengths(displacement).max()) / rubber
    x = np.stack(
        [np.interp(numbers, ends, component) for component in np.atleast_2d(displacement.T)],
        axis=-1,
    )
    x = x if displacement.ndim > 1 else x[:, 0]
    cycle = np.zeros(len(x), dtype=np.int32)
    assumptions = tuple(f"{step.name}: {text}" for text in assumed)
    return Segment("recorded", step.name, x, steps, cycle, turns, peak, assumed=assumptions)


def build_segments(
    test: CyclicTest, total_rubber_thickness: float, start: float | Floats = 0.0
) -> list[Segment]:
    """Sample a test for a bearing of some rubber thickness [mm] that is at `start` [mm].

    In a test in the plane all segments have displacements [steps, 2].
    """
    faults, _ = survey(test, total_rubber_thickness, start)
    if faults:
        raise InputError(faults, test.name)
    segments: list[Segment] = []
    rubber, plane = total_rubber_thickness, test.in_plane
    at: float | Floats = lifted(start) if plane and np.ndim(start) == 0 else start
    for step in test.steps:
        match step:
            case Cycles():
                cycle_segments = _cycle_segments(step, rubber, test.dt)
                if plane:
                    cycle_segments = [replace(part, x=lifted(part.x)) for part in cycle_segments]
                segments += cycle_segments
            case PlanePath():
                segments += _path_segments(step, rubber, test.dt)
            case Ramp():
                segments.append(_ramp(step, rubber, test.dt, at))
            case Rest():
                segments.append(_rest(step, test.dt, at))
            case _:
                segments.append(_recorded(step, rubber, test.dt, at))
        at = segments[-1].x[-1] if plane else float(segments[-1].x[-1])
    return segments


REST_STEP = 10.0  # longest of the first steps of a rest through hours [s]
CHUNK = 20_000  # steps between two looks at the progress bar and at Ctrl-C
Progress = Callable[[int], None]


@dataclass
class History:
    """Kept rows of one run, and how it ended.

    Cell temperatures are in single precision: a micro-kelvin is plenty, and the cells are most
    of a long history.
    """

    rows: Kept
    segment: NDArray[np.int32]
    cycle: NDArray[np.int32]
    initial: Floats  # cell temperatures at the start [degC]
    state: State  # where the run ended
    outcome: str = "completed"
    softened_steps: int = 0
    mismatch: float = 0.0  # largest of the run [kN]
    steps: int = 0
    kept: int = 0
    axial: Rows[AxialResponse] | None = None  # what an axial force does; a row for each kept one


def room_for(
    constants: Constants, count: int, groups: tuple[str, ...], components: int = 1
) -> Kept:
    """Return rows for the energy balance and the chosen groups; other groups have no columns."""
    vector = (components,) if components > 1 else ()
    layers, cells = len(constants.multiplicity), len(constants.cells.capacity)
    widths = {name: layers if name in groups else 0 for name in Kept._fields}
    return Kept(
        response=unset(BearingResponse, count, components=components),
        rubber=np.empty((count, widths["rubber"])),
        layer_displacement=np.empty((count, widths["layer_displacement"], *vector)),
        hysteretic=np.empty((count, widths["hysteretic"], *vector)),
        cells=np.empty((count, cells if "cells" in groups else 0), dtype=np.float32),
    )


def _kept_steps(segment: Segment, keep_every: int) -> NDArray[np.bool_]:
    """Return which steps of a segment are kept: every n-th, and the ends of legs."""
    keep = segment.turning.copy()
    keep[keep_every - 1 :: keep_every] = True
    return keep


def cut_rests(
    constants: Constants, segment: Segment, keep: NDArray[np.bool_], start: float | Floats
) -> tuple[Segment, NDArray[np.bool_], NDArray[np.int64]]:
    """Cut steps without motion into pieces short enough for the heat flow out of lead.

    Returns the segment, which of its pieces are kept, and the piece that each step ends with.
    """
    longest = longest_rest_step(constants)
    if longest == np.inf:
        return segment, keep, np.arange(len(segment.x))
    start_positions = np.concatenate([np.reshape(start, (1, *segment.x.shape[1:])), segment.x[:-1]])
    still = (segment.x == start_positions).reshape(len(start_positions), -1).all(axis=1)
    pieces = np.where(still, np.maximum(1.0, np.ceil(segment.dt / longest)), 1.0).astype(np.int64)
    ends = np.cumsum(pieces) - 1
    if len(ends) == ends[-1] + 1:
        return segment, keep, ends
    kept_pieces = np.zeros(pieces.sum(), dtype=bool)
    kept_pieces[ends] = keep
    x, dt = np.repeat(segment.x, pieces, axis=0), np.repeat(segment.dt / pieces, pieces)
    return replace(segment, x=x, dt=dt, cycle=np.repeat(segment.cycle, pieces)), kept_pieces, ends


def run_segments(
    constants: Constants,
    segments: list[Segment],
    ambient: Ambient,
    initial: Floats,
    *,
    initial_lead: float | None = None,
    begin: State | None = None,
    keep_every: int = 1,
    groups: tuple[str, ...] = ("rubber", "cells"),
    progress: Progress | None = None,
) -> History:
    """Run a test; return what was computed in any case, with a typed outcome.

    The cells begin at `initial`, the lead at `initial_lead` [degC], by default the mean of the
    cells next to it; `begin` is the state that another test left, by default a virgin one. The
    bearing moves on a line, or in a plane if the segments have displacements [steps, 2]. Every
    n-th step and the ends of legs are kept, of the histories in `groups`. `progress` is called
    with the number of steps done since its last call.
    """
    # One row more per segment: a rest that settles early keeps the step at which it does.
    capacity = 1 + sum(int(_kept_steps(part, keep_every).sum()) + 1 for part in segments)
    components = 1 if segments[0].x.ndim == 1 else 2
    initial = np.array(initial, dtype=np.float64)
    if len(initial) != len(constants.cells.capacity):  # compiled code would write past the end
        raise ValueError(f"{len(initial)} temperatures for {len(constants.cells.capacity)} cells")
    run = History(
        rows=room_for(constants, capacity, groups, components),
        segment=np.zeros(capacity, dtype=np.int32),
        cycle=np.zeros(capacity, dtype=np.int32),
        initial=initial,
        state=begin or new_state(constants, initial, initial_lead, components),
    )
    keep = plain(keep_row, run.state)
    keep(constants, run.state, run.rows, 0)
    run.kept = 1
    # Scratch serves all segments: with many short ones, making it takes as long as their steps.
    components = count_components(run.state)
    work = new_workspace(constants, components)
    scratch = work, new_state(constants, run.initial, components=components)
    try:
        for number, segment in enumerate(segments):
            keep_steps = _kept_steps(segment, keep_every)
            if not _run_segment(
                constants, run, scratch, number, segment, ambient, keep_steps, progress
            ):
                break
    except KeyboardInterrupt:
        run.outcome = INTERRUPTED
    last = run.kept - 1
    if run.rows.response[last].clock != run.state.response[0].clock:
        # The run was cut off: its last row is kept too, so that energies and profiles agree.
        keep(constants, run.state, run.rows, run.kept)
        run.segment[run.kept], run.cycle[run.kept] = run.segment[last], run.cycle[last]
        run.kept += 1
    run.rows = run.rows.part(0, run.kept)
    run.segment, run.cycle = run.segment[: run.kept], run.cycle[: run.kept]
    return run


def rest_in(
    constants: Constants,
    air: Ambient,
    duration: float,
    initial: Floats,
    groups: tuple[str, ...] = (),
) -> History:
    """Return the rest of a bearing for some time [s] in air, in growing steps; it has not moved.

    The cells begin at `initial`, the lead at the mean of the cells next to it [degC].
    """
    step = {"step": "rest", "duration": duration}
    segments = build_segments(CyclicTest(dt=REST_STEP, steps=[step]), 1.0)
    return run_segments(constants, segments, air, initial, groups=groups)


def _run_segment(
    constants: Constants,
    run: History,
    scratch: tuple[Workspace, State],
    number: int,
    segment: Segment,
    ambient: Ambient,
    keep: NDArray[np.bool_],
    progress: Progress | None,
) -> bool:
    work, spare = scratch
    run_path = march if count_components(run.state) == 1 else march_plane
    segment, keep, ends = cut_rests(constants, segment, keep, run.state.response["displacement"][0])
    for first in range(0, len(segment.x), CHUNK):
        part = slice(first, first + CHUNK)
        dt = np.ascontiguousarray(segment.dt[part])
        means = ambient.means(run.state.response[0].clock, dt)
        path = Path(np.ascontiguousarray(segment.x[part]), dt, means, keep[part], segment.within)
        free_rows = run.rows.part(run.kept, len(run.segment))
        steps_done, rows_kept, outcome, softened, mismatch = run_path(
            constants, work, run.state, spare, path, free_rows
        )
        run.steps += steps_done
        run.softened_steps += softened
        run.mismatch = max(run.mismatch, mismatch)
        run.segment[run.kept : run.kept + rows_kept] = number
        # A rest that settles early keeps one more row than `keep` says; it is in no cycle.
        cycle = segment.cycle[part][:steps_done][keep[part][:steps_done]]
        run.cycle[run.kept : run.kept + len(cycle)] = cycle
        run.kept += rows_kept
        if progress:
            # Steps of the test count as progress, not the pieces that rests are cut into.
            progress(int(np.diff(np.searchsorted(ends, [first, first + steps_done]))[0]))
        if outcome not in (COMPLETED, SOFTENED):
            run.outcome = NAMES[outcome]
            return False
        if not is_physical(constants, run.state, run.rows.response["recoverable"][0]):
            run.outcome = NOT_PHYSICAL
            return False
        if steps_done < len(dt):  # the rest settled
            break
    return True
