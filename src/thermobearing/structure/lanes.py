"""Many structures shaken for their peaks only: in lockstep where they are alike, or one by one.

`run_lanes` puts runs of equal shape side by side, WIDTH at a time (core/lanes says how one kernel
serves both). What leaves the lockstep is run alone from its start: a step that has no equilibrium,
a bearing too hot, a number that is not finite. What a run gets depends on its input only, not on
its company or its place.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from thermobearing.core.lanes.memory import WIDTH, aligned, lane_back, side_by_side
from thermobearing.core.records import Floats, Rows, rows
from thermobearing.core.types import COMPLETED, Books, Constants
from thermobearing.model.outcomes import NOT_PHYSICAL
from thermobearing.structure.lines import Bearings, build_bearings
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
    Motion,
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


@dataclass
class Ready:
    """A run as the kernels want it."""

    run: Run
    system: System
    bearings: Bearings
    motion: Motion
    shaking: Shaking
    rows: MotionRows
    peaks: Peaks
    recoverable: Floats = field(repr=False)  # [b] energy stored in the bearings at the start

    @property
    def kernel(self) -> tuple[Any, ...]:
        """What is put side by side."""
        return (self.system, self.bearings, self.motion, self.shaking, self.rows, self.peaks)

    @property
    def results(self) -> tuple[Any, ...]:
        """What the kernel wrote that is asked for."""
        states = tuple(kind.states for kind in self.bearings)
        return states, self.motion.books, self.peaks.watches, self.peaks.lines, self.peaks.hinges


def no_rows(system: System, bearings: Bearings) -> MotionRows:
    """No room, in double precision so that it can be room for lanes."""
    none = room_for(system, bearings, 0)
    cells: Any = tuple(np.zeros((0, len(kind.lines), 0)) for kind in bearings)
    return none._replace(cells=cells)


def ready(run: Run) -> Ready:
    """Everything that one run writes into, and what it reads."""
    if run.method not in ("average-acceleration", "linear-acceleration"):
        raise ValueError(f"{run.method}: peaks are those of Newmark's method")
    lines = run.lines
    system = build_system(run.prepared, lines)
    bearings = build_bearings(
        [line.constants for line in lines],
        [line.temperature for line in lines],
        [line.lead for line in lines],
        [line.begun for line in lines],
    )
    places = np.eye(len(system.load)) if run.places is None else run.places
    carried = np.zeros(len(places)) if run.carried is None else run.carried
    peaks = Peaks(
        places=np.ascontiguousarray(places, dtype=np.float64),
        carried=np.ascontiguousarray(carried, dtype=np.float64),
        watches=rows(Watch, len(places)),
        lines=rows(LinePeak, len(lines)),
        hinges=rows(HingePeak, len(system.hinges)),
    )
    peaks.lines["rubber_temperature"] = COLDEST
    peaks.lines["lead_temperature"] = COLDEST
    keep = np.zeros(len(run.ground) - 1, dtype=np.bool_)
    return Ready(
        run=run,
        system=system,
        bearings=bearings,
        motion=new_motion(system),
        shaking=Shaking(run.ground, float(run.dt), run.ambient, keep),
        rows=no_rows(system, bearings),
        peaks=peaks,
        recoverable=books_of(bearings, len(lines))["recoverable"],
    )


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


def told(one: Ready, steps: int, outcome: int, *, alone: bool) -> RunPeaks:
    """What the kernel left, named."""
    named = OUTCOMES[outcome]
    if named == "completed" and not all_physical(one.bearings, one.recoverable):
        named = NOT_PHYSICAL
    books = one.motion.books
    return RunPeaks(
        outcome=named,
        steps=steps,
        iterations=int(books[0].iterations),
        substeps=int(books[0].substeps),
        watches=one.peaks.watches,
        lines=one.peaks.lines,
        hinges=one.peaks.hinges,
        books=books,
        bearings=books_of(one.bearings, len(one.run.lines)),
        alone=alone,
    )


def run_peaks(run: Run) -> RunPeaks:
    """Shake one structure; always returns what was reached, with a typed outcome.

    The same steps as `run_structure`, bit for bit, without its rows.
    """
    one = ready(run)
    done, _, outcome = peaks_march(
        one.system,
        one.bearings,
        one.motion,
        scheme_of(run, HALVINGS),
        one.shaking,
        one.rows,
        one.peaks,
    )
    return told(one, int(done), int(outcome), alone=True)


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


def likeness(one: Ready) -> Any:
    """Runs in one lockstep have the same."""
    run, motion = one.run, one.motion
    sizes = len(run.ground), len(run.ambient), len(motion.points), len(one.system.hinges)
    moving = tuple(bool(line.speed != 0.0) for line in run.lines)
    kinds = [(tuple(map(int, kind.lines)), shape_of(kind.constants)) for kind in one.bearings]
    return sizes, one.peaks.places.shape, run.dt, run.method, moving, *kinds


def run_lanes(runs: Sequence[Run]) -> list[RunPeaks]:
    """Shake many structures, WIDTH in lockstep where they are alike.

    Parameters
    ----------
    runs : of any shapes; those of one shape are put together, in their order.

    Returns
    -------
    What each came to, in their order. A number may differ from that of `run_peaks` by rounding
    (1e-12 of the largest), and never by what else is run.
    """
    groups: dict[Any, list[int]] = {}
    waiting: dict[int, Ready] = {}
    found: dict[int, RunPeaks] = {}
    for number, run in enumerate(runs):
        waiting[number] = ready(run)
        key = likeness(waiting[number])
        groups.setdefault(key, []).append(number)
        if len(groups[key]) == WIDTH:
            together = groups.pop(key)
            found |= zip(together, in_lockstep([waiting.pop(k) for k in together]), strict=True)
    for together in groups.values():
        found |= zip(together, in_lockstep([waiting.pop(k) for k in together]), strict=True)
    return [found[number] for number in range(len(runs))]


def in_lockstep(group: Sequence[Ready]) -> list[RunPeaks]:
    """At most WIDTH runs of one shape; empty lanes repeat the last."""
    filled = [*group, *[group[-1]] * (WIDTH - len(group))]
    system, bearings, motion, shaking, kept, peaks = side_by_side([one.kernel for one in filled])
    outcomes = aligned((1, WIDTH), np.float64)
    scheme = scheme_of(group[0].run, 0)
    done = lanes_march(system, bearings, motion, scheme, shaking, kept, peaks, outcomes)
    states = tuple(kind.states for kind in bearings)
    made = states, motion.books, peaks.watches, peaks.lines, peaks.hinges
    found = []
    for lane, one in enumerate(group):
        if outcomes[0, lane] != COMPLETED:
            found.append(run_peaks(one.run))
            continue
        lane_back(made, lane, one.results)
        found.append(told(one, int(done), COMPLETED, alone=False))
    return found
