"""From a row of a plan to what `run_task` takes; whatever rows share is made once."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.run import build_device, build_shaking, lines_of, one_line
from thermobearing.earthquake.soaking import Soaked, history_weights, soaked_history, soaked_hours
from thermobearing.earthquake.task import Device, OneLine, Shaking, Task
from thermobearing.model.constants import with_parameters
from thermobearing.structure.run import Prepared, prepare_structure
from thermobearing.studies.columns import (
    AMBIENT,
    HOUR,
    SAMPLE,
    THINGS,
    columns_of,
    targets_of,
)
from thermobearing.studies.designs import hours_of, in_lockstep
from thermobearing.studies.levels import Levels
from thermobearing.studies.names import Path, moves_heat, moves_warmth, with_numbers
from thermobearing.studies.record import Study

MOST_KEPT = 2000  # bearings as models, of samples of a posterior
Changes = dict[Path, float]


@dataclass(frozen=True)
class RunInput:
    """One run, ready.

    Attributes
    ----------
    run, id, seed : of its row in the plan.
    task : what `earthquake.run.run_task` takes: prepared structure, device, ground motion at the
        steps, air, bearing lines, case.
    """

    run: int
    id: str
    seed: int
    task: Task


class Preparer:
    """Makes the runs of a study ready, one after the other.

    Structures, bearings as models, motions on the time step, bearings in the hours of a weather:
    what rows have in common is made when it is first asked for, and kept. For one process; a
    study is small to send to another.

    Parameters
    ----------
    study : from `load_study` or `make_study`.

    Examples
    --------
    >>> from thermobearing.studies.case import make_study
    >>> from thermobearing.studies.designs import plan
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> study = make_study({"kind": "study", "name": "p1", "factors": factors}, "example")
    >>> row = plan(study).to_dict("records")[0]
    >>> Preparer(study).run_input(row).task.ambient
    0.0
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.lockstep = in_lockstep(study)
        self.levels = Levels(study)
        self._places = {
            column.name: {str(name): k for k, name in enumerate(column.levels)}
            for column in columns_of(study)
            if column.name in THINGS
        }
        self._targets = targets_of(study)
        self._heats = any(moves_warmth(target) for target in self._targets)
        self._prepared: dict[int, Prepared] = {}
        self._devices: dict[int, Device] = {}
        self._shakings: dict[int, Shaking] = {}
        self._soaked: dict[Any, Soaked] = {}
        self._weights: dict[Any, Floats] = {}
        self._hours: dict[int, int] = {}
        self._others: list[Device | None] | None = None

    def run_input(self, row: Mapping[str, Any]) -> RunInput:
        """What a run needs.

        Parameters
        ----------
        row : of the plan, by column: one of `plan(study).to_dict("records")`.

        Raises
        ------
        InputError : numbers that do not go together in this run.
        """
        structure, bearing, motion = (self._places[name][str(row[name])] for name in THINGS)
        level = {"structure": structure, "bearing": bearing, "case": 0}
        place = int(self.levels.place(np.array(bearing), np.array(int(row.get(SAMPLE, -1)))))
        record = {
            "bearing": self.levels.bearings[place],
            "structure": self.study.factors.structure.levels[structure],
            "case": self.study.case,
        }
        changes: dict[str, Changes] = {part: {} for part in level}
        for target in self._targets:
            number = float(row[target.name])
            if not math.isnan(number):
                part = target.part
                changes[part] |= target.change(level[part], record[part], number)
        shared = self._case(changes["case"], row)
        device = self._device(place, changes["bearing"], shared, changes["case"])
        prepared = self._structure(structure, changes["structure"], shared, changes["case"])
        shaking = self._shaking(motion, shared, changes["case"], float(row["scale"]))
        air = float(row[AMBIENT])
        case = shared.model_copy(
            update={
                "structure": prepared.structure,
                "bearings": [device.bearing],
                "motions": [self.study.factors.motion.levels[motion]],
                "ambient": [air],
            }
        )
        hour = int(row[HOUR]) if HOUR in row else None
        plain = not changes["case"]
        lines = lines_of(
            case,
            device,
            self._own(case, plain),
            partial(one_line, case, air=air, weather=None)
            if hour is None
            else partial(self._soaked_line, hour, air, case),
        )
        task = Task(prepared, device, shaking, air, lines, case, case.modes[0])
        return RunInput(int(row["run"]), str(row["id"]), int(row["seed"]), task)

    def _case(self, changes: Changes, row: Mapping[str, Any]) -> EarthquakeCase:
        """What all runs share, with the numbers of this one; noise of its own in a laboratory."""
        case = self.study.case
        if changes:
            case = with_numbers(case, changes)
        if case.laboratory is not None and case.laboratory.force_noise > 0.0:
            own = case.laboratory.model_copy(update={"seed": int(row["seed"])})
            case = case.model_copy(update={"laboratory": own})
        return case

    def _structure(
        self, level: int, changes: Changes, case: EarthquakeCase, of_case: Changes
    ) -> Prepared:
        """A structure with its matrices, modes and damping."""
        if level in self._prepared and not changes and not of_case:
            return self._prepared[level]
        structure = self.study.factors.structure.levels[level]
        if changes:
            structure = with_numbers(structure, changes)
        made = prepare_structure(structure, case.analysis.mass, case.analysis.damping)
        if not changes and not of_case:
            self._prepared[level] = made
        return made

    def _device(
        self, place: int, changes: Changes, case: EarthquakeCase, of_case: Changes
    ) -> Device:
        """A bearing as the coupled step wants it."""
        bearing = self.levels.bearings[place]
        if of_case:
            return build_device(case, with_numbers(bearing, changes))
        if place not in self._devices:
            self._forget(self._devices)
            self._devices[place] = build_device(case, bearing)
        whole = self._devices[place]
        if not changes:
            return whole
        changed = with_numbers(bearing, changes)
        plain = case.analysis.exposure is None and case.analysis.model == "multi-layer"
        if plain and isinstance(changed, Bearing) and not any(map(moves_heat, changes)):
            assert whole.stack is not None
            constants = with_parameters(whole.constants, changed, whole.stack)
            return Device(changed, constants, whole.stack)
        return build_device(case, changed)

    def _own(self, case: EarthquakeCase, plain: bool) -> list[Device | None]:
        """Devices of lines that have a bearing of their own."""
        if self._others is not None and plain:
            return self._others
        found = [
            None if line.bearing is None else build_device(case, line.bearing)
            for line in case.lines
        ]
        if plain:
            self._others = found
        return found

    def _shaking(self, level: int, case: EarthquakeCase, of_case: Changes, scale: float) -> Shaking:
        """A motion on the time step, scaled."""
        whole = None if of_case else self._shakings.get(level)
        if whole is None:
            motion = self.study.factors.motion.levels[level]
            one = case.model_copy(update={"motions": [motion]})
            whole = build_shaking(one, 0, self.levels.motions[level])
            if not of_case:
                self._shakings[level] = whole
        ground: Floats = scale * whole.ground
        return Shaking(whole.motion, whole.dt, ground)

    def _soaked_line(self, hour: int, air: float, case: EarthquakeCase, device: Device) -> OneLine:
        """The bearings of a line as warm as the weather before an hour has left them."""
        if not isinstance(device.bearing, Bearing):
            return one_line(case, device, air, None)
        weather, history = self.levels.weather, self.study.factors.ambient.history
        assert weather is not None
        key = (heat_of(device.bearing), case.analysis.upper_face, case.analysis.lower_face)
        if history is not None and self._heats:  # nothing that another run could use
            return one_line(case, device, air, weather.before(hour, history))
        if history is not None:
            if key not in self._weights:
                self._forget(self._weights)
                hours = weather.full_hours(history)
                self._weights[key] = history_weights(device.constants, hours)
            before = weather.before(hour, history).temperature
            found = soaked_history(device.constants, self._weights[key], before)
            return OneLine(device, *found, air)
        if not self._hours:
            met = hours_of(self.study, self.levels)
            self._hours = {int(one): k for k, one in enumerate(met)}
        if hour not in self._hours:
            return OneLine(device, *soaked_hours(device, weather, np.array([hour])).at(0), air)
        if key not in self._soaked:
            self._soaked[key] = soaked_hours(device, weather, np.array(list(self._hours)))
        return OneLine(device, *self._soaked[key].at(self._hours[hour]), air)

    @staticmethod
    def _forget(kept: dict[Any, Any]) -> None:
        """Room for one more of what is kept, so that memory has an end."""
        if len(kept) >= MOST_KEPT:
            kept.pop(next(iter(kept)))


def heat_of(bearing: Bearing) -> tuple[Any, ...]:
    """What of a bearing its heat knows: bearings that are alike in it are as warm at rest."""
    lead = bearing.lead
    cores = lead and (
        lead.cores,
        lead.diameter,
        lead.confined,
        lead.clock,
        lead.end_spreading,
        lead.surface_ratio,
    )
    return bearing.kind, bearing.geometry, bearing.materials, bearing.cells, cores
