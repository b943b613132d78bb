"""Many coupled steps in a row, with the rows to be kept."""

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.choose import all_lanes, select
from thermobearing.core.records import Floats, Ints, Rows
from thermobearing.core.step import has_failed, layer_temperature, step
from thermobearing.core.types import (
    COMPLETED,
    SOFTENED,
    BearingResponse,
    Constants,
    Kept,
    Path,
    State,
    Workspace,
)

MISSING = 1e-3  # largest relative error of the energy balance; rounding is about 1e-10
LEAST = 1e-3  # smallest reference energy [kN mm]


@compiled
def copy_state(source: State, target: State) -> None:
    """Overwrite `target` with `source`."""
    for j in range(len(source.layers)):
        target.layers[j] = source.layers[j]
        for k in range(source.turns.shape[1]):
            target.turns[j, k] = source.turns[j, k]
    for i in range(len(source.temperature)):
        target.temperature[i] = source.temperature[i]
    target.branches[0] = source.branches[0]
    for i in range(len(source.ends)):
        target.ends[i] = source.ends[i]
    target.response[0] = source.response[0]


@compiled
def _farthest_from(temperature: Floats, ambient: float) -> float:
    """Largest |cell temperature - ambient| [K]."""
    largest = 0.0
    for i in range(len(temperature)):
        largest = max(largest, abs(temperature[i] - ambient))
    return largest


@compiled
def keep_row(constants: Constants, state: State, kept: Kept, row: int) -> None:
    """Write the kept quantities of a state into one row."""
    kept.response[row] = state.response[0]
    for j in range(kept.rubber.shape[1]):
        kept.rubber[row, j] = layer_temperature(constants.layer_cells, state.temperature, j)
    for j in range(kept.layer_displacement.shape[1]):
        kept.layer_displacement[row, j] = state.layers[j].d
    for j in range(kept.hysteretic.shape[1]):
        kept.hysteretic[row, j] = state.layers[j].z
    for i in range(kept.cells.shape[1]):
        kept.cells[row, i] = state.temperature[i]


@compiled
def march(
    constants: Constants,
    work: Workspace,
    state: State,
    spare: State,
    path: Path,
    rows: Kept,
) -> tuple[int, int, int, int, float]:
    """Step through the displacements of a path.

    Parameters
    ----------
    state : start, and on return the last good step. `spare` is a second state to work in.
    path : displacements, time steps, ambient temperatures, and which ends of steps to keep.
    rows : where those go.

    Returns
    -------
    steps done, rows written, outcome of the last step, number of softened steps, largest
    mismatch of layer forces [kN].
    """
    row = 0
    softened = 0
    mismatch = 0.0
    start = state
    outcome, failure = COMPLETED, COMPLETED
    steps = 0
    for i in range(len(path.x)):
        ambient = path.ambient[i]
        _, _, outcome = step(constants, work, start, path.x[i], path.dt[i], ambient, spare)
        failure = select((failure == COMPLETED) & has_failed(outcome), outcome, failure)
        if all_lanes(failure != COMPLETED):
            break
        # The two states take turns, so that no step copies one.
        start, spare = spare, start
        steps += 1
        softened += select(outcome == SOFTENED, 1, 0)
        mismatch = max(mismatch, start.response[0].layer_force_mismatch)
        settle = all_lanes(path.settled > 0.0) and all_lanes(
            _farthest_from(start.temperature, ambient) <= path.settled
        )
        if path.keep[i] or settle:
            keep_row(constants, start, rows, row)
            row += 1
        if settle:
            break
    # After an odd number of steps the last good state is in the spare of the caller.
    if steps % 2 == 1:
        copy_state(start, spare)
    return steps, row, select(failure != COMPLETED, failure, outcome), softened, mismatch


@compiled
def is_possible(
    temperature: Floats,
    response: Rows[BearingResponse],
    recoverable_before: float,
    coldest: float,
    hottest: float,
    balanced: bool,
) -> bool:
    """Return whether every cell has a possible temperature and the energy balance closes.

    `recoverable_before` is the recoverable energy at the start [kN mm]; `coldest` and `hottest`
    are in degC. Where the balance is not `balanced`, only temperatures are checked.
    """
    for i in range(len(temperature)):
        # Not `<` or `>`, which NaN would pass.
        if not (temperature[i] >= coldest and temperature[i] <= hottest):
            return False
    if not balanced:
        return True
    last = response[0]
    work, released = last.work_in, last.heat_released
    recoverable = last.recoverable - recoverable_before
    heat_lost = last.heat_lost_ends + last.heat_lost_sides
    largest = max(abs(work), abs(recoverable), abs(released), abs(last.heat_stored), abs(heat_lost))
    scale = MISSING * max(LEAST, largest)
    unbalanced = abs(work - released - recoverable)
    return unbalanced <= scale and abs(released - last.heat_stored - heat_lost) <= scale


@compiled
def hours_at_rest(
    kept: Floats,
    early: Floats,
    late: Floats,
    air: Floats,
    places: Ints,
    temperature: Floats,
    after: Floats,
    requested: Floats,
) -> None:
    """Compute hourly temperatures: after an hour, kept @ temperature + early * air + late * air.

    Parameters
    ----------
    kept : [n, n], transposed: row j is what temperature j gives to all an hour later.
    early, late : [n] what the air at the two ends of the hour gives.
    air : at full hours [degC].
    places : requested hours, increasing.
    temperature : [n] at hour 0 [degC]; overwritten, as `after`, which is scratch.
    requested : [places, n] temperatures at these hours [degC].
    """
    hour = 0
    for row in range(len(places)):
        while hour < places[row]:
            for i in range(len(temperature)):
                after[i] = early[i] * air[hour] + late[i] * air[hour + 1]
            for j in range(len(temperature)):
                part = temperature[j]
                for i in range(len(temperature)):
                    after[i] += kept[j, i] * part
            for i in range(len(temperature)):
                temperature[i] = after[i]
            hour += 1
        for i in range(len(temperature)):
            requested[row, i] = temperature[i]
