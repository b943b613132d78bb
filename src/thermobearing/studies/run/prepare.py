"""From a row of a plan to what `run_task` takes; whatever rows share is made once."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.run import (
    Device,
    OneLine,
    Shaking,
    Task,
    build_device,
    build_shaking,
    one_line,
    prepared_lines,
)
from thermobearing.model.constants import with_parameters
from thermobearing.structure.run import Prepared, prepare_structure
from thermobearing.studies.definition.columns import (
    AMBIENT,
    HOUR,
    SAMPLE,
    THINGS,
    list_columns,
    list_targets,
)
from thermobearing.studies.definition.designs import in_lockstep
from thermobearing.studies.definition.record import Study
from thermobearing.studies.definition.targets import Path, moves_heat, moves_warmth, with_numbers
from thermobearing.studies.inputs.bearing_temperatures import Key, Warm, Warmth, thermal_key
from thermobearing.studies.inputs.levels import Ints, Levels

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

    Structures, bearings as models, motions on the time step: what rows have in common is made when
    it is first asked for, and kept. The weather before their hours is gone through when rows are
    foreseen. For one process; a study is small to send to another, and so is what was foreseen.

    Parameters
    ----------
    study : from `load_study` or `make_study`.

    Examples
    --------
    >>> from thermobearing.studies.definition.case import make_study
    >>> from thermobearing.studies.definition.designs import plan
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> study = make_study({"kind": "study", "name": "p1", "factors": factors}, "example")
    >>> row = plan(study).to_dict("records")[0]
    >>> Preparer(study).run_input(row).task.ambient
    0.0
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.levels = Levels(study)
        self.lockstep = in_lockstep(study)
        self._places = {
            column.name: {str(name): k for k, name in enumerate(column.levels)}
            for column in list_columns(study)
            if column.name in THINGS
        }
        self._targets = list_targets(study)
        own = any(moves_warmth(target) for target in self._targets)
        self.warmth = Warmth(self.levels, own=own)
        self._prepared: dict[int, Prepared] = {}
        self._devices: dict[int, Device] = {}
        self._shakings: dict[int, Shaking] = {}
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
                "motions": [self.levels.listed[motion]],
                "ambient": [air],
            }
        )
        hour = int(row[HOUR]) if HOUR in row else None
        plain = not changes["case"]
        lines = prepared_lines(
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
            one = case.model_copy(update={"motions": [self.levels.listed[level]]})
            whole = build_shaking(one, 0, self.levels.motions[level])
            if not of_case:
                self._shakings[level] = whole
        ground: Floats = scale * whole.ground
        return Shaking(whole.motion, whole.dt, ground)

    def _soaked_line(self, hour: int, air: float, case: EarthquakeCase, device: Device) -> OneLine:
        """The bearings of a line as warm as the weather before an hour has left them."""
        if not isinstance(device.bearing, Bearing):
            return one_line(case, device, air, None)
        if self.warmth.own:  # nothing that another run could use
            return one_line(case, device, air, self.warmth.before(hour))
        return OneLine(device, *self.warmth.at(device, case, hour), air)

    def foresee(self, rows: pd.DataFrame) -> None:
        """Go through the weather once, for all rows that will be asked for; without, for each.

        Parameters
        ----------
        rows : of the plan.
        """
        if HOUR not in rows:
            return
        if self.warmth.own:
            self.warmth.foresee([])
            return
        plain = self.study.case
        self.warmth.foresee(
            (thermal_key(device, plain), device, hours) for device, hours in self._warmed(rows)
        )

    def foreseen_temperatures(self, rows: pd.DataFrame) -> Warm | None:
        """What was foreseen of some rows, for another process; None of a study without weather."""
        if HOUR not in rows:
            return None
        wanted: dict[Key, list[Ints]] = {}
        for device, hours in [] if self.warmth.own else self._warmed(rows):
            wanted.setdefault(thermal_key(device, self.study.case), []).append(hours)
        return self.warmth.of(
            (key, np.unique(np.concatenate(each))) for key, each in wanted.items()
        )

    def take(self, warm: Warm | None) -> None:
        """Know what another process has foreseen of the rows that come next."""
        if warm is not None:
            self.warmth.take(warm)

    def _warmed(self, rows: pd.DataFrame) -> Iterator[tuple[Device, Ints]]:
        """Bearings with heat, and hours at which rows have them."""
        case, hours = self.study.case, rows[HOUR].to_numpy(np.int64)
        names = self._places["bearing"]
        level = np.array([names[str(name)] for name in rows["bearing"]], dtype=np.int64)
        sample = rows[SAMPLE].to_numpy(np.int64) if SAMPLE in rows else np.full(len(rows), -1)
        place = self.levels.place(level, sample)
        for one in np.unique(place):
            try:
                device = self._device(int(one), {}, case, {})
            except InputError:
                continue  # its runs tell it
            if isinstance(device.bearing, Bearing):
                yield device, np.unique(hours[place == one])
        for mine in self._own(case, True):
            if mine is not None and isinstance(mine.bearing, Bearing):
                yield mine, np.unique(hours)

    @staticmethod
    def _forget(kept: dict[Any, Any]) -> None:
        """Room for one more of what is kept, so that memory has an end."""
        if len(kept) >= MOST_KEPT:
            kept.pop(next(iter(kept)))
