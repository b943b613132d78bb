"""Bearing lines with the same bearing side by side in the same arrays.

One machine code serves any number of them; a tuple with an entry for each line would be another
type, and compile anew, for each number. Only a structure with several kinds of bearings has
several entries.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from thermobearing.core.compile import compiled
from thermobearing.core.records import Floats, Ints
from thermobearing.core.types import (
    Constants,
    LayerWork,
    State,
    Workspace,
    new_state,
    new_workspace,
)


class Kind(NamedTuple):
    """The lines that have one bearing, where it is in each, and where a trial takes it.

    The arrays of the states have one axis more than those of one bearing, the first: [m] lines.
    """

    constants: Constants
    lines: Ints  # [m] their numbers in the structure
    durations: Floats  # [m] of the trial, on the bearing's own clock [s]
    work: Workspace
    elastic: Floats  # [m, L] of LayerWork: it lasts from the first trial of a step to its end
    hysteretic: Floats  # [m, L]
    states: Any  # State, [m]
    trials: Any  # State, [m]


Bearings: TypeAlias = tuple[Kind, ...]


@compiled
def state_of(states: Any, m: int) -> State:
    """Where the bearing of one line is; not a copy."""
    return State(
        states.layers[m],
        states.turns[m],
        states.temperature[m],
        states.branches[m],
        states.ends[m],
        states.books[m],
    )


@compiled
def work_of(kind: Kind, m: int) -> Workspace:
    """Scratch for one line: that of the kind, with the line's own stiffness."""
    work, layers = kind.work, kind.work.layers
    return Workspace(
        work.factored_dt,
        LayerWork(
            kind.elastic[m],
            kind.hysteretic[m],
            layers.force,
            layers.tangent,
            layers.trial,
            layers.direction,
            layers.slope,
        ),
        work.cells,
        work.lead_ports,
        work.lead_modes,
    )


def side_by_side(parts: Sequence[Any]) -> Any:
    """Arrays, or records of arrays, with one more axis in front."""
    if isinstance(parts[0], tuple):
        return type(parts[0])(*(side_by_side(column) for column in zip(*parts, strict=True)))
    array = np.empty((len(parts), *parts[0].shape), parts[0].dtype)  # np.stack changes records
    for m, part in enumerate(parts):
        array[m] = part
    return array


def kinds_of(constants: Sequence[Constants]) -> list[list[int]]:
    """Numbers of the lines that are of one kind: their constants are the same object."""
    kinds: dict[int, list[int]] = {}
    for number, one in enumerate(constants):
        kinds.setdefault(id(one), []).append(number)
    return list(kinds.values())


def build_bearings(
    constants: Sequence[Constants],
    temperatures: Sequence[Floats],
    leads: Sequence[float | None],
    begun: Sequence[State | None] | None = None,
) -> Bearings:
    """Bearings of all lines: where they were left, or virgin at temperatures of cells and lead."""
    found = []
    states = start_states(constants, temperatures, leads, begun)
    for numbers, start in zip(kinds_of(constants), states, strict=True):
        one = constants[numbers[0]]
        trials = State(*[array.copy() for array in start])
        elastic, hysteretic = np.zeros((2, len(numbers), len(one.multiplicity)))
        work = new_workspace(one)
        lines, durations = np.array(numbers), np.zeros(len(numbers))
        found.append(Kind(one, lines, durations, work, elastic, hysteretic, start, trials))
    return tuple(found)


def start_states(
    constants: Sequence[Constants],
    temperatures: Sequence[Floats],
    leads: Sequence[float | None],
    begun: Sequence[State | None] | None = None,
) -> tuple[Any, ...]:
    """States of each kind, as `Kind` has them; arguments as of `build_bearings`."""
    starts = [
        new_state(one, temperatures[b], leads[b]) if left is None else left
        for b, (one, left) in enumerate(
            zip(constants, begun or [None] * len(constants), strict=True)
        )
    ]
    return tuple(side_by_side([starts[b] for b in numbers]) for numbers in kinds_of(constants))
