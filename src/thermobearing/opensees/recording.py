"""Histories of served bearings: recorded step by step, in memory and in a file.

A server may run for days and may be killed. Committed steps are therefore moved from memory into a
temporary file, which outlives the process: whoever notices its end (`keeper`, or the script that
started it) reads the histories from there. The file is a sequence of pickled `Part`s of histories,
written by this program only and readable by its user only.
"""

import pickle
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import groupby
from typing import IO, Any, NamedTuple

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.model.element import BearingElement

ROWS_IN_MEMORY = 512  # of a bearing, before they are written
JOURNAL = "histories"  # the file of a server that is a child, in the folder of its parent


class Served(NamedTuple):
    """The history of one bearing in one direction, from the start or a reset to the end."""

    tag: int
    pair: int  # place of the bearing in its element, from 1
    direction: int
    run: int  # 1, and one more for each reset or new element of the same tag
    outcome: str
    time: Floats  # of the model
    response: dict[
        str, Floats
    ]  # of core.types.BearingResponse; energies are those of both directions
    axial: dict[str, Floats]  # of core.types.AxialResponse; empty unless the axial force acts
    rubber: Floats  # temperatures of the layers [degC]
    initial: Floats  # temperatures of the cells [degC]
    final: Floats


def layer_temperatures(bearing: BearingElement) -> Floats:
    """Return the temperatures of the rubber layers at mid-thickness [degC]."""
    cells, temperature = bearing.constants.layer_cells, bearing.state.temperature
    middle: Floats = 0.5 * (temperature[cells["upper_middle"]] + temperature[cells["lower_middle"]])
    return middle


class Label(NamedTuple):
    """Which bearing a history is of; see `Served`."""

    tag: int
    pair: int
    directions: tuple[int, ...]
    run: int


class Row(NamedTuple):
    """A committed step of one bearing."""

    time: float  # of the model
    response: Any  # one record of core.types.BearingResponse
    rubber: Floats
    axial: Any  # one record of core.types.AxialResponse, or None


class Part(NamedTuple):
    """Consecutive committed steps of one bearing."""

    history: int  # number of the history in its journal
    label: Label
    outcome: str
    time: Floats
    response: Any  # records of core.types.BearingResponse
    rubber: Floats
    axial: Any  # records of core.types.AxialResponse, or None
    initial: Floats
    final: Floats  # after the last of these steps
    discarded: bool = False  # the history is not wanted: a gravity stage before a reset


class Journal:
    """A file of histories, of which every part is complete or absent."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._histories = 0
        self.problem = ""  # why histories remain in memory

    def new_history(self) -> int:
        """Return the number of another history."""
        self._histories += 1
        return self._histories

    def append(self, part: Part) -> int | None:
        """Write a part and return its place; None if it must remain in memory (full disk)."""
        if self.problem:
            return None
        try:
            place = self._file.seek(0, 2)
            self._file.write(pickle.dumps(part))
            self._file.flush()
        except OSError as error:
            # What follows a part that was written by half could not be read again.
            self.problem = f"histories are kept in memory: {error.strerror or error}"
            return None
        return place

    def read(self, places: Iterable[int]) -> list[Part]:
        """Return the parts at some places."""
        parts = []
        for place in places:
            self._file.seek(place)
            parts.append(pickle.load(self._file))
        return parts

    def histories(self) -> list[Served]:
        """Return all histories in the file, in the order in which they began."""
        self._file.seek(0)
        parts = sorted(self._parts(), key=lambda part: part.history)
        served = []
        for _, group in groupby(parts, key=lambda part: part.history):
            of_history = list(group)
            if not of_history[-1].discarded:
                served += merge(of_history)
        return served

    def _parts(self) -> Iterator[Part]:
        with suppress(EOFError, pickle.UnpicklingError):  # the end, or a part written by half
            while True:
                yield pickle.load(self._file)


def merge(parts: Sequence[Part]) -> list[Served]:
    """Return the history of a bearing, in each direction, from its parts in a row."""
    last = parts[-1]
    response_table = np.concatenate([part.response for part in parts])
    response = {name: response_table[name].copy() for name in response_table.dtype.names or ()}
    time = np.concatenate([part.time for part in parts])
    rubber = np.concatenate([part.rubber for part in parts])
    axial = [_axial_columns(parts, place) for place in range(len(last.label.directions))]
    return [
        Served(
            tag=last.label.tag,
            pair=last.label.pair,
            direction=direction,
            run=last.label.run,
            outcome=last.outcome,
            time=time,
            response=_pressed(
                {
                    key: column[:, place] if column.ndim > 1 else column
                    for key, column in response.items()
                },
                axial[place],
            ),
            axial=axial[place],
            rubber=rubber,
            initial=last.initial,
            final=last.final,
        )
        for place, direction in enumerate(last.label.directions)
    ]


def _axial_columns(parts: Sequence[Part], place: int) -> dict[str, Floats]:
    """Return what the axial force does to a bearing in its first or second direction."""
    if parts[-1].axial is None:
        return {}
    table = np.concatenate([part.axial for part in parts])
    columns = {name: table[name].copy() for name in table.dtype.names or ()}
    if place:
        columns["stiffness_reduction"] = columns["stiffness_reduction_y"]
    return columns


def _pressed(response: dict[str, Floats], axial: dict[str, Floats]) -> dict[str, Floats]:
    """Return a response whose force is less by what the axial force takes, as in cyclic tests."""
    if not axial:
        return response
    taken = axial["stiffness_reduction"] * response["displacement"]
    return response | {"force": response["force"] - taken}


class Recording:
    """The ends of all committed steps of a bearing."""

    def __init__(
        self, label: Label, bearing: BearingElement, journal: Journal | None, axial: Any = None
    ) -> None:
        self.label, self._journal = label, journal
        self._layers = len(bearing.constants.layer_cells)
        self._initial = bearing.state.temperature.copy()
        self._final = self._initial
        self._history = 0 if journal is None else journal.new_history()
        self._rows: list[Row] = []
        self._no_axial = None if axial is None else axial[:0].copy()
        self._places: list[int] = []  # of the parts in the journal
        self._start = bearing.state.response["displacement"].copy()
        self._no_response = bearing.state.response[:0].copy()
        self.displaced = False  # a gravity stage alone leaves no history
        self.outcome = "completed"
        self.keep(0.0, bearing, axial)

    def keep(self, time: float, bearing: BearingElement, axial: Any = None) -> None:
        """Append the committed state; `axial` is a record of core.types.AxialResponse."""
        state = bearing.state
        row = Row(time, state.response.copy(), layer_temperatures(bearing), axial)
        self._rows.append(row)
        self._final = state.temperature.copy()
        if not self.displaced:
            self.displaced = bool((state.response["displacement"] != self._start).any())
        if len(self._rows) >= ROWS_IN_MEMORY:
            self.flush()

    def flush(self) -> None:
        """Move the steps in memory into the journal, if there is one."""
        if self._journal is None or not self._rows:
            return
        place = self._journal.append(self._part())
        if place is not None:
            self._places.append(place)
            self._rows = []

    def discard(self) -> None:
        """Mark the steps in the journal as not wanted."""
        if self._journal is not None and self._places:
            self._journal.append(self._part()._replace(discarded=True))

    def served(self) -> list[Served]:
        """Return the history so far, in each direction."""
        earlier = [] if self._journal is None else self._journal.read(self._places)
        return merge([*earlier, self._part()])

    def _part(self) -> Part:
        """Return the steps in memory; none where all have been written."""
        time = np.array([row.time for row in self._rows])
        response: Any = self._no_response
        axial: Any = self._no_axial
        rubber = np.empty((0, self._layers))
        if self._rows:
            response = np.concatenate([row.response for row in self._rows])
            rubber = np.array([row.rubber for row in self._rows])
            if axial is not None:
                axial = np.concatenate([row.axial for row in self._rows])
        return Part(
            history=self._history,
            label=self.label,
            outcome=self.outcome,
            time=time,
            response=response,
            rubber=rubber,
            axial=axial,
            initial=self._initial,
            final=self._final,
        )
