"""One structure shaken for its peaks only, without rows; `lanes` shakes many at a time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.records import Floats, Ints, Rows, rows
from thermobearing.core.types import COMPLETED, Books
from thermobearing.model.outcomes import NOT_PHYSICAL
from thermobearing.structure.lines import (
    Bearings,
    build_bearings,
)
from thermobearing.structure.lockstep import peaks_march
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
    ambient : temperature of the air [degC].
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
    ambient: float
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


def no_rows(system: System, bearings: Bearings, count: int = 0) -> MotionRows:
    """No room (or room for `count` rows), in double precision so that it can be room for lanes."""
    none = room_for(system, bearings, count)
    cells: Any = tuple(np.zeros((count, len(kind.lines), 0)) for kind in bearings)
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


def shaking_of(run: Run) -> Shaking:
    """What the structure is exposed to; no step is kept."""
    steps = len(run.ground) - 1
    return Shaking(run.ground, float(run.dt), np.full(steps, run.ambient), none_kept(run))


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

    The same steps as `run_structure`, bit for bit, without its rows. A run that ends early has the
    energies and bearings of its last whole step, as rows have: the halves of a step that were done
    before it ended are in no row, so that the steps up to there are done again.
    """
    check_method(run)
    left, stored, done, outcome, _ = _marched(run, 0)
    found = told(left, stored, done, outcome, alone=True)
    if outcome == COMPLETED:
        return found
    books, ended = rows(MotionBooks, 1), books_of(bearings_of(run), len(run.lines))
    if done > 0:
        kept = _marched(run, done)[-1]
        books = kept.books
        for line in range(len(run.lines)):
            ended[line] = kept.bearings[0, line]
    return found._replace(books=books, bearings=ended)


def _marched(run: Run, kept: int) -> tuple[Left, Floats, int, int, MotionRows]:
    """What a run left, what its bearings had stored, steps, outcome; one row of step `kept`."""
    system, bearings = build_system(run.prepared, run.lines), bearings_of(run)
    motion, peaks, shaking = new_motion(system), peaks_of(run, system), shaking_of(run)
    stored = stored_in([(kind.lines, kind.states) for kind in bearings], len(run.lines))
    room = no_rows(system, bearings, min(kept, 1))
    if kept:
        shaking.keep[kept - 1] = True
    done, _, outcome = peaks_march(
        system, bearings, motion, scheme_of(run, HALVINGS), shaking, room, peaks
    )
    left = Left(bearings, motion.books, peaks.watches, peaks.lines, peaks.hinges)
    return left, stored, int(done), int(outcome), room


def check_method(run: Run) -> None:
    """Only Newmark's method notes peaks."""
    if run.method not in ("average-acceleration", "linear-acceleration"):
        raise ValueError(f"{run.method}: peaks are those of Newmark's method")
