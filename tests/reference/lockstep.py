"""Many coupled steps of several bearings in lockstep (core/lanes), with the kernels of one run."""

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.memory import WIDTH, as_lanes
from thermobearing.core.march import march
from thermobearing.core.records import Floats
from thermobearing.core.types import Constants, Kept, Path, State, Workspace


@compiled
def march_lanes(
    constants: Constants,
    work: Workspace,
    state: State,
    spare: State,
    path: Path,
    rows: Kept,
    ends: Floats,
) -> tuple[int, int]:
    """`march` of WIDTH runs, all arguments from `side_by_side`.

    Writes into `ends` [3, WIDTH] what ended each run, its softened steps and its largest mismatch
    of layer forces [kN]. A run that failed continues without a use.

    Returns
    -------
    steps done, rows written.
    """
    results = as_lanes(ends, WIDTH)
    done, kept, outcome, softened, mismatch = march(
        as_lanes(constants, WIDTH),
        as_lanes(work, WIDTH),
        as_lanes(state, WIDTH),
        as_lanes(spare, WIDTH),
        as_lanes(path, WIDTH),
        as_lanes(rows, WIDTH),
    )
    results[0] = outcome
    results[1] = softened
    results[2] = mismatch
    return done, kept
