"""Many coupled steps in a row, with the rows that the user asked to keep."""

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.compile import compiled
from thermobearing.core.step import layer_temperature, step
from thermobearing.core.types import (
    BOOKS,
    COMPLETED,
    MISMATCH,
    SOFTENED,
    Constants,
    D,
    Floats,
    Ints,
    State,
    Workspace,
    Z,
)


@compiled
def copy_state(source: State, target: State) -> None:
    """Overwrite `target` with `source`."""
    for row in range(source.layers.shape[0]):
        for j in range(source.layers.shape[1]):
            target.layers[row, j] = source.layers[row, j]
    for i in range(len(source.temperature)):
        target.temperature[i] = source.temperature[i]
    for i in range(len(source.lead)):
        target.lead[i] = source.lead[i]
    for i in range(len(source.books)):
        target.books[i] = source.books[i]


@compiled
def farthest_from(temperature: Floats, ambient: float) -> float:
    """Largest |cell temperature - ambient| [K]."""
    largest = 0.0
    for i in range(len(temperature)):
        largest = max(largest, abs(temperature[i] - ambient))
    return largest


@compiled
def write_row(layer_cells: Ints, state: State, row: Floats) -> None:
    """One kept row: books, layer temperatures, layer displacements, Z."""
    layers = state.layers.shape[1]
    for k in range(BOOKS):
        row[k] = state.books[k]
    for j in range(layers):
        row[BOOKS + j] = layer_temperature(layer_cells, state.temperature, j)
        row[BOOKS + layers + j] = state.layers[D, j]
        row[BOOKS + 2 * layers + j] = state.layers[Z, j]


@compiled
def march(
    constants: Constants,
    work: Workspace,
    state: State,
    spare: State,
    x: Floats,
    dt: Floats,
    ambient: Floats,
    keep: NDArray[np.bool_],
    settled: float,
    columns: Ints,
    row: Floats,
    rows: Floats,
    cells: NDArray[np.floating],
) -> tuple[int, int, int, int, float]:
    """Step through the displacements x [mm] with steps dt [s].

    Parameters
    ----------
    state : start, and on return the last good step. `spare` is a second state to work in.
    ambient : mean ambient temperature of each step [degC].
    keep : whether the step's end is to be kept as a row of `rows` and `cells`.
    columns : which columns of `write_row` go into `rows`; `row` is scratch for one of them.
    cells : cell temperatures of the kept rows, single or double precision; no columns if
        they are not wanted.
    settled : stop once every cell is this close to the ambient [K]; 0 never stops early.

    Returns
    -------
    steps done, rows written, outcome of the last step, number of softened steps, largest
    mismatch of layer forces [kN].
    """
    kept = 0
    softened = 0
    mismatch = 0.0
    start = state
    outcome = COMPLETED
    done = 0
    for i in range(len(x)):
        _, _, outcome = step(constants, work, start, x[i], dt[i], ambient[i], spare)
        if outcome != COMPLETED and outcome != SOFTENED:
            break
        start, spare = spare, start
        done += 1
        if outcome == SOFTENED:
            softened += 1
        mismatch = max(mismatch, start.books[MISMATCH])
        settle = settled > 0.0 and farthest_from(start.temperature, ambient[i]) <= settled
        if keep[i] or settle:
            write_row(constants.layer_cells, start, row)
            for k in range(len(columns)):
                rows[kept, k] = row[columns[k]]
            for k in range(cells.shape[1]):
                cells[kept, k] = start.temperature[k]
            kept += 1
        if settle:
            break
    if done % 2 == 1:
        copy_state(start, spare)
    return done, kept, outcome, softened, mismatch
