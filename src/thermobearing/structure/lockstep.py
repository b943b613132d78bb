"""The time integration of several structures in lockstep, and of one, for their peaks only."""

from thermobearing.core.compile import compiled
from thermobearing.core.lanes.memory import WIDTH, as_lanes
from thermobearing.core.lockstep import TAUGHT as TAUGHT
from thermobearing.core.records import Floats
from thermobearing.structure.lines import Bearings
from thermobearing.structure.newmark import newmark_march, start_motion
from thermobearing.structure.peaks import note_peaks
from thermobearing.structure.types import Motion, MotionRows, Peaks, Scheme, Shaking, System


@compiled
def peaks_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
) -> tuple[int, int, int]:
    """From rest through the ground acceleration; returns what `newmark_march` does."""
    start_motion(system, motion, shaking.ground[0])
    note_peaks(system, bearings, motion, shaking.ground[0], peaks)
    return newmark_march(system, bearings, motion, scheme, shaking, rows, peaks)


@compiled
def lanes_march(
    system: System,
    bearings: Bearings,
    motion: Motion,
    scheme: Scheme,
    shaking: Shaking,
    rows: MotionRows,
    peaks: Peaks,
    outcomes: Floats,
) -> int:
    """`peaks_march` of WIDTH runs; all but `scheme` come from `side_by_side`.

    Whole steps only (`scheme.halvings` is 0): a run that needs smaller ones ends early, which its
    entry of `outcomes` [1, WIDTH] says, and is to be run alone. Returns the steps done.
    """
    done, _, outcome = peaks_march(
        as_lanes(system, WIDTH),
        as_lanes(bearings, WIDTH),
        as_lanes(motion, WIDTH),
        scheme,
        as_lanes(shaking, WIDTH),
        as_lanes(rows, WIDTH),
        as_lanes(peaks, WIDTH),
    )
    ended = as_lanes(outcomes, WIDTH)
    ended[0] = outcome
    return done
