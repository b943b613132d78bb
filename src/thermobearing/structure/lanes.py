"""Many structures shaken for their peaks only: in lockstep where they are alike, or one by one.

`run_lanes` puts runs of equal shape side by side, WIDTH at a time (core/lanes says how one kernel
serves both). What leaves the lockstep is run alone from its start: a step that has no equilibrium,
a bearing too hot, a number that is not finite. What a run gets depends on its input only, not on
its company or its place.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.lanes.memory import WIDTH, aligned, each_lane, side_by_side, twin
from thermobearing.core.records import Floats, Ints, Rows, rows
from thermobearing.core.types import COMPLETED, Books, Constants, SharedCells
from thermobearing.model.outcomes import NOT_PHYSICAL
from thermobearing.structure.lines import (
    Bearings,
    Kind,
    build_bearings,
    kinds_of,
    start_states,
)
from thermobearing.structure.lockstep import lanes_march, peaks_march
from thermobearing.structure.run import (
    BETA,
    GAMMA,
    HALVINGS,
    ITERATIONS,
    OUTCOMES,
    TOLERANCE,
    Line,
    Method,
    Prepared,
    all_physical,
    build_system,
    new_motion,
    room_for,
)
from thermobearing.structure.types import (
    HingePeak,
    LinePeak,
    MotionBooks,
    MotionRows,
    Peaks,
    Scheme,
    Shaking,
    System,
    Watch,
)

COLDEST = -1e9  # degC: below every temperature, where the largest one begins


@dataclass(frozen=True)
class Run:
    """A structure to be shaken.

    Attributes
    ----------
    prepared : from `prepare_structure`.
    lines : one per bearing line of the structure.
    ground : [steps + 1] ground acceleration at the ends of steps [mm/s2], linear between.
    dt : of the steps [s].
    ambient : [steps] mean ambient temperature of each step [degC].
    places : [p, n] displacements to watch beside bearings and hinges, per coordinate
        (structure/matrices.py makes such rows); the coordinates themselves by default.
    carried : [p] 1 for those that the ground carries, so that its acceleration is added; 0 for
        differences and rotations. All 0 by default.
    method : of Newmark.
    """

    prepared: Prepared
    lines: Sequence[Line]
    ground: Floats
    dt: float
    ambient: Floats
    places: Floats | None = None
    carried: Floats | None = None
    method: Method = "average-acceleration"


class RunPeaks(NamedTuple):
    """What a run came to.

    Largest numbers are those at the ends of all steps that were done, and at the start.
    """

    outcome: str
    steps: int
    iterations: int
    substeps: int
    watches: Rows[Watch]  # [p]
    lines: Rows[LinePeak]  # [b]
    hinges: Rows[HingePeak]  # [h]
    books: Rows[MotionBooks]  # [1] energies at the end
    bearings: Rows[Books]  # [b] of the modelled bearing of each line, at the end
    alone: bool  # whether it was run alone


class Left(NamedTuple):
    """What a run left behind, with arrays of its own."""

    bearings: Bearings
    books: Rows[MotionBooks]  # [1]
    watches: Rows[Watch]
    lines: Rows[LinePeak]
    hinges: Rows[HingePeak]


def no_rows(system: System, bearings: Bearings) -> MotionRows:
    """No room, in double precision so that it can be room for lanes."""
    none = room_for(system, bearings, 0)
    cells: Any = tuple(np.zeros((0, len(kind.lines), 0)) for kind in bearings)
    return none._replace(cells=cells)


def bearings_of(run: Run) -> Bearings:
    """The bearings of a run at its start."""
    return build_bearings(*start_of(run))


def start_of(run: Run) -> tuple[Any, ...]:
    """Arguments of `build_bearings` and `start_states`."""
    lines = run.lines
    return (
        [line.constants for line in lines],
        [line.temperature for line in lines],
        [line.lead for line in lines],
        [line.begun for line in lines],
    )


def watched(run: Run) -> tuple[Floats, Floats]:
    """Which displacements are watched, and which of them the ground carries."""
    places = np.eye(len(run.prepared.matrices.load)) if run.places is None else run.places
    carried = np.zeros(len(places)) if run.carried is None else run.carried
    return (
        np.ascontiguousarray(places, dtype=np.float64),
        np.ascontiguousarray(carried, dtype=np.float64),
    )


def peaks_of(run: Run, system: System) -> Peaks:
    """Nothing noted yet."""
    places, carried = watched(run)
    peaks = Peaks(
        places=places,
        carried=carried,
        watches=rows(Watch, len(places)),
        lines=rows(LinePeak, len(run.lines)),
        hinges=rows(HingePeak, len(system.hinges)),
    )
    peaks.lines["rubber_temperature"] = COLDEST
    peaks.lines["lead_temperature"] = COLDEST
    return peaks


def shaking_of(run: Run, keep: NDArray[np.bool_]) -> Shaking:
    """What the structure is exposed to."""
    return Shaking(run.ground, float(run.dt), run.ambient, keep)


def none_kept(run: Run) -> NDArray[np.bool_]:
    """No step is kept."""
    return np.zeros(len(run.ground) - 1, dtype=np.bool_)


def stored_in(kinds: Sequence[tuple[Ints, Any]], lines: int) -> Floats:
    """Energy stored in the bearings of all lines [b], from lines and states of each kind."""
    found = np.zeros(lines)
    for numbers, states in kinds:
        found[numbers] = states.books["recoverable"][:, 0]
    return found


def books_of(bearings: Bearings, lines: int) -> Rows[Books]:
    """Books of the modelled bearings of all lines [b]."""
    found = rows(Books, lines)
    for kind in bearings:
        for m, line in enumerate(kind.lines):
            found[int(line)] = kind.states.books[m, 0]
    return found


def scheme_of(run: Run, halvings: int) -> Scheme:
    """How time is integrated."""
    return Scheme(BETA[run.method], GAMMA, TOLERANCE, ITERATIONS, halvings)


def told(left: Left, recoverable: Floats, steps: int, outcome: int, *, alone: bool) -> RunPeaks:
    """What a run left, named."""
    named = OUTCOMES[outcome]
    if named == "completed" and not all_physical(left.bearings, recoverable):
        named = NOT_PHYSICAL
    return RunPeaks(
        outcome=named,
        steps=steps,
        iterations=int(left.books[0].iterations),
        substeps=int(left.books[0].substeps),
        watches=left.watches,
        lines=left.lines,
        hinges=left.hinges,
        books=left.books,
        bearings=books_of(left.bearings, len(recoverable)),
        alone=alone,
    )


def run_peaks(run: Run) -> RunPeaks:
    """Shake one structure; always returns what was reached, with a typed outcome.

    The same steps as `run_structure`, bit for bit, without its rows.
    """
    check_method(run)
    system, bearings = build_system(run.prepared, run.lines), bearings_of(run)
    motion, peaks = new_motion(system), peaks_of(run, system)
    stored = stored_in([(kind.lines, kind.states) for kind in bearings], len(run.lines))
    done, _, outcome = peaks_march(
        system,
        bearings,
        motion,
        scheme_of(run, HALVINGS),
        shaking_of(run, none_kept(run)),
        no_rows(system, bearings),
        peaks,
    )
    left = Left(bearings, motion.books, peaks.watches, peaks.lines, peaks.hinges)
    return told(left, stored, int(done), int(outcome), alone=True)


def check_method(run: Run) -> None:
    """Only Newmark's method notes peaks."""
    if run.method not in ("average-acceleration", "linear-acceleration"):
        raise ValueError(f"{run.method}: peaks are those of Newmark's method")


def choices(constants: Constants) -> tuple[bool, ...]:
    """Where kernels go one way for all runs in lockstep."""
    rubber, lead = constants.rubber, constants.lead
    return (
        rubber.unloading_curvature > 0.0,
        rubber.unloading_curvature < 0.0,
        lead.cores > 0.0,
        lead.softening == 0.0,
        lead.side_conductance == 0.0,
        constants.viscous.stiffness > 0.0,
    )


def shape_of(constants: Constants) -> Any:
    """What bearings in lockstep have in common: shapes, whole numbers and choices."""
    rubber = constants.rubber
    cells: Any = constants.layer_cells
    ends: Any = constants.lead_cells
    modes: Any = constants.lead_modes
    places = [(cells, name) for name in ("first", "last", "upper_middle", "lower_middle")]
    places += [(ends, "cell"), (ends, "port"), (modes, "port"), (modes, "other")]
    return (
        *(rows_[name].tobytes() for rows_, name in places),
        len(constants.law),
        len(constants.cells.capacity),
        constants.lead_ports,
        constants.side_implicit,
        constants.heat_source,
        rubber.monotone,
        rubber.integrator,
        rubber.virgin,
        constants.lead.published,
        constants.viscous.heats,
        *choices(constants),
    )


def likeness(run: Run) -> Any:
    """Runs in one lockstep have the same."""
    check_method(run)
    structure, constants = run.prepared.structure, [line.constants for line in run.lines]
    sizes = len(run.ground), len(run.ambient), len(run.prepared.matrices.load)
    watched = None if run.places is None else len(run.places)
    moving = tuple(bool(line.speed != 0.0) for line in run.lines)
    kinds: list[Any] = []
    for numbers in kinds_of(constants):
        one = constants[numbers[0]]
        heat = b"".join(array.tobytes() for array in one.cells)
        kinds.append((tuple(numbers), shape_of(one), heat))
    return sizes, len(structure.hinges), watched, run.dt, run.method, moving, *kinds


def run_lanes(runs: Sequence[Run]) -> list[RunPeaks]:
    """Shake many structures, WIDTH in lockstep where they are alike.

    Parameters
    ----------
    runs : of any shapes; those of one shape, with bearings that are alike in capacities and
        conductances of their cells, are put together in their order.

    Returns
    -------
    What each came to, in their order. A number may differ from that of `run_peaks` by rounding
    (1e-12 of the largest), and never by what else is run.
    """
    groups: dict[Any, list[int]] = {}
    found: dict[int, RunPeaks] = {}

    def finish(together: list[int]) -> None:
        shaken = in_lockstep([runs[k] for k in together])
        found.update(zip(together, shaken, strict=True))

    for number, run in enumerate(runs):
        key = likeness(run)
        groups.setdefault(key, []).append(number)
        if len(groups[key]) == WIDTH:
            finish(groups.pop(key))
    for together in groups.values():
        finish(together)
    return [found[number] for number in range(len(runs))]


def systems_of(runs: Sequence[Run]) -> list[System]:
    """Structures of some runs; those with the same structure and lines share one."""
    made: dict[Any, System] = {}
    found = []
    for run in runs:
        lines = tuple((line.speed, line.warmer, id(line.begun)) for line in run.lines)
        key = id(run.prepared), lines
        if key not in made:
            made[key] = build_system(run.prepared, run.lines)
        found.append(made[key])
    return found


def with_shared_cells(constants: Constants) -> Constants:
    """For a lockstep of bearings that are alike in their heat."""
    return constants._replace(cells=SharedCells(*constants.cells))


def bearings_side_by_side(first: Bearings, runs: Sequence[Run], starts: Sequence[Any]) -> Any:
    """Bearings of several runs as one: `first` are those of the first, `starts` their states."""
    found = []
    for k, kind in enumerate(first):
        line = int(kind.lines[0])
        each = [with_shared_cells(run.lines[line].constants) for run in runs]
        states = side_by_side([start[k] for start in starts])
        own = (kind.durations, kind.work, kind.elastic, kind.hysteretic)
        scratch = side_by_side([own] * WIDTH)
        found.append(Kind(side_by_side(each), kind.lines, *scratch, states, twin(states)))
    return tuple(found)


def in_lockstep(runs: Sequence[Run]) -> list[RunPeaks]:
    """At most WIDTH runs of one shape; empty lanes repeat the last."""
    filled = [*runs, *[runs[-1]] * (WIDTH - len(runs))]
    systems, keep = systems_of(filled), none_kept(filled[0])
    bearings, none = bearings_of(filled[0]), peaks_of(filled[0], systems[0])
    starts = [start_states(*start_of(run)) for run in filled]
    motion = side_by_side([new_motion(systems[0])] * WIDTH)
    peaks = side_by_side([none] * WIDTH)
    places, carried = side_by_side([watched(run) for run in filled])
    wide = bearings_side_by_side(bearings, filled, starts)
    outcomes = aligned((1, WIDTH), np.float64)
    done = lanes_march(
        side_by_side(systems),
        wide,
        motion,
        scheme_of(filled[0], 0),
        side_by_side([shaking_of(run, keep) for run in filled]),
        side_by_side([no_rows(systems[0], bearings)] * WIDTH),
        peaks._replace(places=places, carried=carried),
        outcomes,
    )
    made = tuple(kind.states for kind in wide), motion.books, peaks[2:]
    like = starts[0], new_motion(systems[0]).books, none[2:]
    found = []
    each = each_lane(made, like)
    for lane, run in enumerate(runs):
        if outcomes[0, lane] != COMPLETED:
            found.append(run_peaks(run))
            continue
        states, books, noted = each[lane]
        ended = tuple(
            kind._replace(constants=run.lines[int(kind.lines[0])].constants, states=state)
            for kind, state in zip(bearings, states, strict=True)
        )
        numbers = [kind.lines for kind in bearings]
        stored = stored_in(list(zip(numbers, starts[lane], strict=True)), len(run.lines))
        left = Left(ended, books, *noted)
        found.append(told(left, stored, int(done), COMPLETED, alone=False))
    return found
