"""The model with the displacement of a record, with parameters that are quick to change.

Stack, cells and time steps are built once per record; an evaluation changes the numbers of
rubber, lead and rate dependence only. Steps may be coarser than the samples: fine where the
motion turns (the loop is steep there) and longer along a leg; Z is exact for any increment,
and the force between two steps is interpolated along the displacement. No step is shorter than
the noise of the displacement: jitter is not motion. A turn between two samples is a step too.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats, Ints
from thermobearing.core.types import Constants, Kept
from thermobearing.cyclic.conditioning import soaked_start
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.history import Segment, run_segments
from thermobearing.identify.records.cycles import TURN, dead_band, turning_points
from thermobearing.identify.records.record import PAUSE, TestRecord
from thermobearing.identify.records.turns import find_cut_turns
from thermobearing.model.axial import axial_rows, column_of
from thermobearing.model.constants import with_parameters
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.outcomes import INTERRUPTED

FIRST_STEP = 0.002  # of the largest displacement, after a turn
GROWTH = 0.15  # of the way since the turn: step along a leg
PART_OF_BAND = 0.5  # of the dead band: step along a leg of a noisy record
LONGEST_STEP = 0.05  # of the largest displacement
PAUSE_FIRST, PAUSE_GROWTH, PAUSE_STEPS = 0.05, 1.2, 40


@dataclass(frozen=True)
class Prediction:
    """Force and temperatures of the model at the samples of a record."""

    force: Floats  # [kN]
    temperatures: dict[str, Floats]  # by title of the thermocouple [degC]
    lead: tuple[float, float] | None = None  # coldest and warmest lead in the run [degC]
    critical_share: float | None = None  # largest axial force over the critical load


class _Grid(NamedTuple):
    """Steps of the model, and where each sample lies between them."""

    x: Floats
    dt: Floats
    before: Ints  # row of the step at or before each sample
    after: Ints
    part: Floats  # of the way between them


def _nodes(time: Floats, x: Floats, band: float, fine: bool) -> Ints:
    """Return the samples where steps end: all but jitter, or turns and ever sparser after."""
    peak = float(np.abs(x).max())
    # Without noise every sample is motion. With noise, steps of the noise itself would move the
    # model by jitter, and steps of the whole dead band would cut the steep branch after a turn.
    if fine and band <= 0.0:
        return np.arange(len(x))
    if fine:
        step = PART_OF_BAND * band
        return _along(time, x, turning_points(x, band), np.arange(step, 2.2 * peak, step))
    # Steps grow in proportion to the distance since the turn: the loop is steep there, and ever
    # flatter along the leg. A leg from one side to the other is at most 2 peaks long; 2.2 is safe.
    distances = [0.0]
    while distances[-1] < 2.2 * peak:
        step = min(max(FIRST_STEP * peak, GROWTH * distances[-1]), LONGEST_STEP * peak)
        distances.append(distances[-1] + step)
    return _along(time, x, turning_points(x, max(TURN * peak, band)), np.array(distances[1:]))


def _along(time: Floats, x: Floats, turns: Ints, distances: Floats) -> Ints:
    """Return turns, samples where a leg first passes each distance, and ends of gaps."""
    nodes = [turns]
    for a, b in pairwise(turns.tolist()):
        travel = np.maximum.accumulate(np.abs(x[a : b + 1] - x[a]))
        nodes.append(a + np.searchsorted(travel, distances[distances < travel[-1]]))
    # Both ends of a gap are nodes, so that a rest is a step of its own and can be divided.
    gaps = np.flatnonzero(np.diff(time) > PAUSE)
    return np.unique(np.concatenate([*nodes, gaps, gaps + 1])).astype(np.int64)


def _pause(duration: float, before: float, growth: float, steps: int) -> Floats:
    """Return growing steps that fill a pause [s], continuing those of a pause `before` it."""
    sizes, remaining = [], duration
    size = min(max(PAUSE_FIRST, before), duration)
    while remaining > 0.0:
        # The last step takes what is left, so that no sliver of a step follows it.
        if remaining < 1.5 * size:
            size = remaining
        sizes.append(size)
        remaining -= size
        size = min(size * growth, max(size, duration / steps))
    return np.array(sizes)


def _grid(record: TestRecord, fine: bool) -> _Grid:
    """Return the steps of the model through a record."""
    turns, band = find_cut_turns(record.time, record.displacement), dead_band(record.displacement)
    # The motion has turns that the samples cut off. After a turn the loop is so steep that half a
    # step of the logger matters.
    places = [turn.before + 1 for turn in turns]
    time = np.insert(record.time, places, [turn.time for turn in turns])
    x = np.insert(record.displacement, places, [turn.displacement for turn in turns])
    samples = np.arange(len(record.time))
    samples += np.searchsorted(places, samples, side="right")
    nodes = _nodes(time, x, band, fine)
    growth, steps = (1.05, 100) if fine else (PAUSE_GROWTH, PAUSE_STEPS)
    rest_motion = max(TURN * record.peak_displacement, band)
    usual_gap = float(np.median(np.diff(time)))
    xs, dts = [x[:1]], [np.array([usual_gap])]
    gaps, moves = np.diff(time[nodes]), np.diff(x[nodes])
    counts = np.ones(len(gaps), dtype=np.int64)
    first = 0
    # Only a gap without motion is a rest: cooling is fast at first, so that its steps grow.
    for k in np.flatnonzero((gaps > PAUSE) & (np.abs(moves) <= rest_motion)).tolist():
        sizes = _pause(float(gaps[k]), float(gaps[k - 1]) if k else 0.0, growth, steps)
        counts[k] = len(sizes)
        xs += [x[nodes[first + 1 : k + 1]], np.full(len(sizes), x[nodes[k + 1]])]
        dts += [gaps[first:k], sizes]
        first = k + 1
    xs.append(x[nodes[first + 1 :]])
    dts.append(gaps[first:])
    row_ends = 1 + np.concatenate([[0], np.cumsum(counts)])
    # Each sample lies between two nodes. Its force is interpolated along the displacement, with
    # which the force varies; where that hardly moves, along time.
    place = np.clip(np.searchsorted(nodes, samples, side="right") - 1, 0, len(nodes) - 2)
    a, b = nodes[place], nodes[place + 1]
    travel, span = x[samples] - x[a], x[b] - x[a]
    by_time = (time[samples] - time[a]) / (time[b] - time[a])
    # A span of nearly zero would divide by rounding.
    moved = np.abs(span) > 0.1 * FIRST_STEP * record.peak_displacement
    part = np.where(moved, travel / np.where(moved, span, 1.0), by_time)
    return _Grid(
        x=np.concatenate(xs),
        dt=np.concatenate(dts),
        before=row_ends[place],
        after=row_ends[place + 1],
        part=np.clip(part, -0.5, 1.5),
    )


def unstable_tests(
    records: Sequence[TestRecord], predictions: Sequence[Prediction | None]
) -> list[str]:
    """Return a sentence for each test whose axial force exceeds the critical load of the model."""
    return [
        f"{record.name}: the axial force exceeds the critical load of the model, to "
        f"{prediction.critical_share:.2f} of it; the shear law under axial force is not valid "
        "there. Leave the test out, or cut off the part with the largest displacements"
        for record, prediction in zip(records, predictions, strict=True)
        if prediction is not None and (prediction.critical_share or 0.0) > 1.0
    ]


class ForwardModel:
    """The model of one record, for many bearings that differ in parameters only.

    It steps at every sample if `fine`; else fine at turns and coarse along legs, some five times
    faster. `ambient`, at which the bearing is cold or warm throughout, replaces the record's
    temperature [degC], `options` the default model.
    """

    def __init__(
        self,
        record: TestRecord,
        bearing: Bearing,
        *,
        fine: bool = False,
        ambient: float | None = None,
        options: ModelOptions | None = None,
    ) -> None:
        self.record, self._options = record, options
        model = build_model(bearing, options, backbone=bilinear_parameters)
        self._stack, self._constants = model.stack, model.constants
        self._grid = grid = _grid(record, fine)
        no_turns, cycle = np.zeros(len(grid.x), dtype=bool), np.zeros(len(grid.x), dtype=np.int32)
        self._segment = Segment("recorded", record.name, grid.x, grid.dt, cycle, no_turns)
        self._chamber = record.ambient if ambient is None else ambient
        self._conditioning = record.conditioning if ambient is None else None
        air_offset = record.air_offset if ambient is None else 0.0
        self._ambient = Ambient.constant(self._chamber + air_offset)
        self._initial, self._initial_lead = self._start(bearing)
        self._bearing = bearing
        self._groups = ("rubber",) if record.places or record.axial is not None else ()
        if record.axial is not None and options is not None and options.model == "bilinear":
            raise InputError(
                'axial: model "bilinear" has no rubber layers; use model "multi-layer", or axial = '
                '"off" in the sidecar',
                record.file or record.name,
            )
        self._layers = self._thermocouples(bearing)
        self.ended = ""  # outcome of the last run

    def rebuilt(self, bearing: Bearing) -> "ForwardModel":
        """Return the model of a bearing of other sizes or materials, with the same steps."""
        forward = copy(self)
        model = build_model(bearing, self._options, backbone=bilinear_parameters)
        forward._stack, forward._constants = model.stack, model.constants
        forward._bearing = bearing
        forward._initial, forward._initial_lead = forward._start(bearing)
        return forward

    def _start(self, bearing: Bearing) -> tuple[Floats, float | None]:
        """Return the temperatures of cells and lead when the test begins [degC]."""
        offset = self.record.start_offset
        # No soaking is computed: all cells start at the temperature of the chamber.
        if self._conditioning is None:
            count = len(self._constants.cells.capacity)
            return np.full(count, self._chamber + offset), None
        try:
            start = soaked_start(bearing, self._conditioning, self._chamber, self._options)
        except InputError as error:
            raise error.located(self.record.file or self.record.name) from None
        return start.temperature + offset, None if start.lead is None else start.lead + offset

    def _thermocouples(self, bearing: Bearing) -> dict[str, int | None]:
        """Return the modelled layer of each thermocouple, from the outside; None in lead."""
        layers: dict[str, int | None] = {}
        for title, place in self.record.places.items():
            if place == "lead":
                if bearing.lead is None:
                    raise InputError(f"thermocouples.{title}: the bearing has no lead")
                layers[title] = None
                continue
            # The half stack is modelled: a layer and its mirror image have the same temperature.
            layer, count = int(place.split()[1]), bearing.geometry.rubber_layers
            if layer > count:
                raise InputError(f"thermocouples.{title}: the bearing has {count} rubber layers")
            layers[title] = min(layer, count + 1 - layer) - 1
        return layers

    def run(self, bearing: Bearing | None = None) -> Prediction | None:
        """Run the model's bearing, or one with other parameters; None if it ends early."""
        constants = self._constants
        if bearing is not None:
            try:
                constants = with_parameters(constants, bearing, self._stack)
            except InputError as error:  # of a registered law, at these parameters
                self.ended = str(error)
                return None
        history = run_segments(
            constants,
            [self._segment],
            self._ambient,
            self._initial,
            initial_lead=self._initial_lead,
            groups=self._groups,
        )
        # Ctrl-C reaches a kernel as an outcome; the search must not take it for a bad point.
        if history.outcome == INTERRUPTED:
            raise KeyboardInterrupt
        self.ended = history.outcome
        if history.outcome != "completed":
            return None
        balance, rubber = history.rows.response, history.rows.rubber
        lead = balance["lead_temperature"]
        temperatures = {
            title: self._at_samples(lead if layer is None else rubber[:, layer])
            for title, layer in self._layers.items()
        }
        ends = (float(lead.min()), float(lead.max())) if constants.lead.cores > 0.0 else None
        force, share = balance["force"], None
        if self.record.axial is not None:
            force, share = self._pressed(bearing or self._bearing, constants, history.rows)
        return Prediction(self._at_samples(force), temperatures, ends, share)

    def _pressed(self, bearing: Bearing, constants: Constants, rows: Kept) -> tuple[Floats, float]:
        """Return the force less what the axial force takes, and the largest share of its limit."""
        assert self.record.axial is not None
        # The first step of the grid leads to the first sample.
        clock = self.record.time[0] + rows.response["clock"] - self._grid.dt[0]
        displacement, pressing = rows.response["displacement"], self.record.axial.at(clock)
        axial = axial_rows(column_of(bearing), constants, displacement, pressing, rows.rubber)
        # Steps along a leg are long here: what the axial force takes at their end is nearer to the
        # law than what it took at their start, by which short steps compute.
        taken = axial["next_reduction"] * displacement
        return rows.response["force"] - taken, float((pressing / axial["critical_load"]).max())

    def _at_samples(self, values: Floats) -> Floats:
        grid = self._grid
        before = values[grid.before]
        return np.asarray(before + grid.part * (values[grid.after] - before))
