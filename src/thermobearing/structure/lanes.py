"""Many structures shaken for their peaks only: in lockstep where they are alike.

`run_lanes` puts runs of equal shape side by side, WIDTH at a time (core/lanes says how one kernel
serves both). What leaves the lockstep is run alone from its start: a step that has no equilibrium,
a bearing too hot, a number that is not finite. What a run gets depends on its input only, not on
its company or its place.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from thermobearing.core.lanes.memory import WIDTH, aligned, each_lane, side_by_side, twin
from thermobearing.core.types import COMPLETED, Constants, SharedCells
from thermobearing.structure.lines import Kind, kinds_of, start_states
from thermobearing.structure.lockstep import lanes_march
from thermobearing.structure.run import build_system, new_motion
from thermobearing.structure.shaken import (
    Left,
    Run,
    RunPeaks,
    bearings_of,
    check_method,
    no_rows,
    none_kept,
    peaks_of,
    run_peaks,
    scheme_of,
    start_of,
    stored_in,
    told,
    watched,
)
from thermobearing.structure.types import Shaking, System

T = TypeVar("T")


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
        rubber.closed_loops,
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
    sizes = len(run.ground), len(run.prepared.matrices.load)
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
    companies: dict[Any, Company] = {}
    waiting: dict[Any, list[int]] = {}
    found: dict[int, RunPeaks] = {}

    def finish(key: Any, together: list[int]) -> None:
        shaken = companies[key].shake([runs[k] for k in together])
        found.update(zip(together, shaken, strict=True))

    for number, run in enumerate(runs):
        key = likeness(run)
        if key not in companies:
            companies[key] = Company(run)
        waiting.setdefault(key, []).append(number)
        if len(waiting[key]) == WIDTH:
            finish(key, waiting.pop(key))
    for key, together in waiting.items():
        finish(key, together)
    return [found[number] for number in range(len(runs))]


def with_shared_cells(constants: Constants) -> Constants:
    """For a lockstep of bearings that are alike in their heat."""
    return constants._replace(cells=SharedCells(*constants.cells))


class Company:
    """Runs of one shape in lockstep, WIDTH at a time.

    What is the same in several lots of runs is put side by side once, and scratch is copied.
    """

    def __init__(self, run: Run) -> None:
        system = build_system(run.prepared, run.lines)
        self.keep, self.bearings = none_kept(run), bearings_of(run)
        self.motion, self.peaks = new_motion(system), peaks_of(run, system)
        work = tuple(
            (one.durations, one.work, one.elastic, one.hysteretic) for one in self.bearings
        )
        self.scratch = side_by_side([(work, self.motion, self.peaks)] * WIDTH)
        self.rows = side_by_side([no_rows(system, self.bearings)] * WIDTH)
        self._systems: dict[Any, System] = {}
        self._made: dict[Any, tuple[Sequence[Any], Any]] = {}

    def shake(self, runs: Sequence[Run]) -> list[RunPeaks]:
        """At most WIDTH runs; empty lanes repeat the last."""
        filled = [*runs, *[runs[-1]] * (WIDTH - len(runs))]
        starts = [start_states(*start_of(run)) for run in filled]
        work, motion, peaks = twin(self.scratch)
        places, carried = side_by_side([watched(run) for run in filled])
        bearings = self._bearings(filled, starts, work)
        outcomes = aligned((1, WIDTH), np.float64)
        done = lanes_march(
            self._once([self._system(run) for run in filled]),
            bearings,
            motion,
            scheme_of(filled[0], 0),
            self._shaking(filled),
            self.rows,
            peaks._replace(places=places, carried=carried),
            outcomes,
        )
        made = tuple(kind.states for kind in bearings), motion.books, peaks[2:]
        each = each_lane(made, (starts[0], self.motion.books, self.peaks[2:]))
        return [
            self._told(run, starts[lane], *each[lane], int(done))
            if outcomes[0, lane] == COMPLETED
            else run_peaks(run)
            for lane, run in enumerate(runs)
        ]

    def _shaking(self, runs: Sequence[Run]) -> Shaking:
        """What they are exposed to; the air of a run stays as it is."""
        ground, dt = side_by_side([(run.ground, float(run.dt)) for run in runs])
        ambient = aligned((len(self.keep), WIDTH), np.float64)
        ambient[:] = [run.ambient for run in runs]
        return Shaking(ground, dt, ambient, self.keep)

    def _bearings(self, runs: Sequence[Run], starts: Sequence[Any], work: Any) -> Any:
        """Bearings of some runs as one, with their states at the start."""
        found = []
        for k, kind in enumerate(self.bearings):
            line = int(kind.lines[0])
            constants = self._once([run.lines[line].constants for run in runs], with_shared_cells)
            states = side_by_side([start[k] for start in starts])
            own = (*work[k], states, twin(states))
            found.append(Kind(constants, kind.lines, *own))
        return tuple(found)

    def _system(self, run: Run) -> System:
        """The structure of a run; those with the same one and the same lines share it."""
        lines = tuple((line.speed, line.warmer, id(line.begun)) for line in run.lines)
        key = id(run.prepared), lines
        if key not in self._systems:
            self._systems[key] = build_system(run.prepared, run.lines)
        return self._systems[key]

    def _once(self, given: Sequence[T], change: Callable[[T], T] | None = None) -> T:
        """Things that are only read, side by side; the same ones are not put there again."""
        key = tuple(map(id, given))
        if key not in self._made:
            parts = [change(one) for one in given] if change else given
            self._made[key] = given, side_by_side(parts)
        made: T = self._made[key][1]
        return made

    def _told(
        self, run: Run, start: Any, states: Any, books: Any, noted: Any, steps: int
    ) -> RunPeaks:
        """What a run left in its lane."""
        ended = tuple(
            kind._replace(constants=run.lines[int(kind.lines[0])].constants, states=state)
            for kind, state in zip(self.bearings, states, strict=True)
        )
        lines = [kind.lines for kind in self.bearings]
        stored = stored_in(list(zip(lines, start, strict=True)), len(run.lines))
        return told(Left(ended, books, *noted), stored, steps, COMPLETED, alone=False)
