"""Drive one bearing through the segments of a test at one ambient temperature."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.march import march
from thermobearing.core.types import (
    BOOKS,
    COMPLETED,
    SOFTENED,
    TIME,
    Constants,
    State,
    new_state,
    new_workspace,
)
from thermobearing.drive.ambient import Ambient
from thermobearing.drive.outcomes import INTERRUPTED, NAMES
from thermobearing.drive.protocol import Segment

Floats = NDArray[np.float64]
CHUNK = 20_000  # steps between two looks at the progress bar and at Ctrl-C

Progress = Callable[[int], None]


@dataclass
class History:
    """What one run left behind: kept rows and how it ended.

    `rows` has one row per kept step and one column per entry of `columns`, which counts
    through books, layer temperatures, layer displacements, Z and cell temperatures.
    """

    columns: list[int]
    rows: Floats
    segment: NDArray[np.int64]
    cycle: NDArray[np.int64]
    initial: Floats  # cell temperatures at the start [degC]
    state: State  # where the run ended
    outcome: str = "completed"
    softened_steps: int = 0
    mismatch: float = 0.0  # largest of the run [kN]
    steps: int = 0
    chunks: list[tuple[Floats, NDArray[np.int64], NDArray[np.int64]]] = field(
        default_factory=list, repr=False
    )


def column_numbers(layers: int, cells: int, groups: tuple[str, ...]) -> list[int]:
    """Columns of a kept row for the chosen groups; the books are always kept."""
    ends = np.cumsum([0, BOOKS, layers, layers, layers, cells])
    names = ("books", "rubber", "layer_displacement", "hysteretic", "cells")
    chosen = {"books", *groups}
    return [
        int(column)
        for name, start, end in zip(names, ends[:-1], ends[1:], strict=True)
        if name in chosen
        for column in range(start, end)
    ]


def run_segments(
    constants: Constants,
    segments: list[Segment],
    ambient: Ambient,
    initial: Floats,
    *,
    keep_every: int = 1,
    groups: tuple[str, ...] = ("rubber", "cells"),
    progress: Progress | None = None,
) -> History:
    """Run a test; always returns what was computed, with a typed outcome.

    Parameters
    ----------
    constants : the bearing (drive/assemble.py).
    segments : the test (drive/protocol.py).
    ambient : temperature of the air.
    initial : cell temperatures at the start [degC].
    keep_every : keep every n-th step; ends of legs are kept besides.
    groups : of "rubber", "layer_displacement", "hysteretic", "cells": what to keep.
    progress : called with the number of steps done since the last call.
    """
    layers, cells = len(constants.multiplicity), constants.cells.shape[1]
    columns = column_numbers(layers, cells, groups)
    state = new_state(constants, initial)
    run = History(
        columns=columns,
        rows=np.empty((0, len(columns))),
        segment=np.empty(0, dtype=np.int64),
        cycle=np.empty(0, dtype=np.int64),
        initial=np.array(initial, dtype=np.float64),
        state=state,
    )
    start = np.zeros((1, BOOKS + 3 * layers + cells))
    middles = constants.layer_cells[:, 2:]
    start[0, BOOKS : BOOKS + layers] = 0.5 * (initial[middles[:, 0]] + initial[middles[:, 1]])
    start[0, BOOKS + 3 * layers :] = initial
    run.chunks.append((start[:, columns], np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)))
    try:
        for number, segment in enumerate(segments):
            if not _run_segment(constants, run, number, segment, ambient, keep_every, progress):
                break
    except KeyboardInterrupt:
        run.outcome = INTERRUPTED
    run.rows = np.concatenate([chunk[0] for chunk in run.chunks])
    run.segment = np.concatenate([chunk[1] for chunk in run.chunks])
    run.cycle = np.concatenate([chunk[2] for chunk in run.chunks])
    run.chunks.clear()
    return run


def _run_segment(
    constants: Constants,
    run: History,
    number: int,
    segment: Segment,
    ambient: Ambient,
    keep_every: int,
    progress: Progress | None,
) -> bool:
    """One segment in chunks; False when the run cannot go on."""
    work, spare = new_workspace(constants), new_state(constants, run.initial)
    air = ambient.means(float(run.state.books[TIME]), segment.dt)
    keep = segment.turning.copy()
    keep[keep_every - 1 :: keep_every] = True
    numbers = np.array(run.columns, dtype=np.int64)
    row = np.empty(BOOKS + 3 * len(constants.multiplicity) + constants.cells.shape[1])
    for first in range(0, len(segment.x), CHUNK):
        part = slice(first, first + CHUNK)
        rows = np.empty((int(keep[part].sum()) + 1, len(numbers)))
        done, kept, outcome, softened, mismatch = march(
            constants, work, run.state, spare, segment.x[part], segment.dt[part], air[part],
            keep[part].astype(np.float64), segment.settle, numbers, row, rows,
        )  # fmt: skip
        run.steps += done
        run.softened_steps += softened
        run.mismatch = max(run.mismatch, mismatch)
        settled = done < len(segment.x[part])
        cycle = segment.cycle[part][:done][keep[part][:done]]
        cycle = np.concatenate([cycle, np.zeros(kept - len(cycle), dtype=np.int64)])
        run.chunks.append((rows[:kept], np.full(kept, number), cycle))
        if progress:
            progress(done)
        if outcome not in (COMPLETED, SOFTENED):
            run.outcome = NAMES[outcome]
            return False
        if settled:
            break
    return True
