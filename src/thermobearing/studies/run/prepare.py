"""From a row of a plan to the task of `run_task`; rows share what they have in common.

The process that starts a study integrates the temperatures over its weather once for each thermal
key of a bearing (`foresee`). The temperatures of a shard are sent with its rows
(`foreseen_temperatures`, `take`), so that workers need no weather.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.climate.hourly import Hourly
from thermobearing.core.records import Floats, Ints
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.run import (
    Device,
    OneLine,
    Shaking,
    Soaked,
    Task,
    build_device,
    build_shaking,
    history_weights,
    one_line,
    prepared_lines,
    soaked_history,
    soaked_hours,
)
from thermobearing.model.constants import with_parameters
from thermobearing.structure.run import Prepared, prepare_structure
from thermobearing.studies.definition.designs import (
    AMBIENT,
    HOUR,
    SAMPLE,
    THINGS,
    Levels,
    NumberPath,
    in_lockstep,
    list_columns,
    list_targets,
    moves_heat,
    moves_warmth,
    with_numbers,
)
from thermobearing.studies.definition.record import Study

Key = tuple[Any, ...]
Changes = dict[NumberPath, float]
MOST_KEPT = 2000  # models of bearings that are stored


@dataclass(frozen=True)
class Warm:
    """Temperatures of the bearings of some runs, to be sent with them."""

    # by thermal key: hours, increasing, and temperatures of the bearing at them
    soaked: Mapping[Key, tuple[Ints, Soaked]] = field(default_factory=dict)
    weather: Hourly | None = None  # if each run has its own thermal key


def _thermal_key(device: Device, case: EarthquakeCase) -> Key:
    """Return the properties that determine the temperature of a bearing at rest."""
    bearing = device.bearing
    assert isinstance(bearing, Bearing)
    lead = bearing.lead
    cores = lead and (
        lead.cores,
        lead.diameter,
        lead.confined,
        lead.clock,
        lead.end_spreading,
        lead.surface_ratio,
    )
    heat = bearing.kind, bearing.geometry, bearing.materials, bearing.cells, cores
    analysis = case.analysis
    return (*heat, analysis.upper_face, analysis.lower_face, analysis.side)


class Warmth:
    """Temperatures of the bearings of a study at the hours of its weather, computed once.

    With `own` every run has its own thermal key, and no temperatures are stored.
    """

    def __init__(self, levels: Levels, *, own: bool) -> None:
        self.levels, self.own = levels, own
        self.history = levels.study.factors.ambient.history
        self.known = Warm()
        self._weights: dict[Key, Floats] = {}

    @property
    def _weather(self) -> Hourly:
        """Weather of the study, received or read here."""
        found = self.known.weather or self.levels.weather
        assert found is not None
        return found

    def _before(self, hour: int) -> Ambient:
        """Return the ambient temperature of the history of an hour."""
        assert self.history is not None
        return self._weather.before(hour, self.history)

    def _foresee(self, wanted: Iterable[tuple[Key, Device, Ints]]) -> None:
        """Compute the temperatures of devices, by thermal key and hours."""
        devices: dict[Key, Device] = {}
        hours: dict[Key, list[Ints]] = {}
        for key, device, some in wanted:
            devices[key] = device
            hours.setdefault(key, []).append(some)
        found = {}
        for key, device in devices.items():
            every = np.unique(np.concatenate(hours[key]))
            found[key] = every, self._soaked(key, device, every)
        self.known = Warm(found, self._weather if self.own else None)

    def _at(self, device: Device, case: EarthquakeCase, hour: int) -> tuple[Floats, float | None]:
        """Return temperatures of cells and lead of a bearing at an hour."""
        key = _thermal_key(device, case)
        hours, soaked = self.known.soaked.get(key, (np.zeros(0, dtype=np.int64), None))
        place = int(np.searchsorted(hours, hour))
        if soaked is not None and place < len(hours) and hours[place] == hour:
            return soaked.at(place)
        return self._soaked(key, device, np.array([hour])).at(0)

    def _soaked(self, key: Key, device: Device, hours: Ints) -> Soaked:
        """Return temperatures at some hours, after the history or all weather before."""
        if self.history is None:
            return soaked_hours(device, self._weather, hours)
        if key not in self._weights:
            _make_room(self._weights)
            full = self._weather.full_hours(self.history)
            self._weights[key] = history_weights(device.constants, full)
        each = [
            soaked_history(device.constants, self._weights[key], self._before(int(h)).temperature)
            for h in hours
        ]
        lead = None if each[0][1] is None else np.array([one for _, one in each])
        return Soaked(np.array([cells for cells, _ in each]), lead)


def _make_room(kept: dict[Any, Any]) -> None:
    if len(kept) >= MOST_KEPT:
        kept.pop(next(iter(kept)))


class Preparer:
    """Prepares the runs of a study in one process.

    Structures, bearing models and motions on the time step that rows have in common are built when
    they are first needed, and stored.
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
        self.warmth = Warmth(self.levels, own=any(map(moves_warmth, self._targets)))
        self._prepared: dict[int, Prepared] = {}
        self._devices: dict[int, Device] = {}
        self._shakings: dict[int, Shaking] = {}
        self._others: list[Device | None] | None = None

    def make_task(self, row: Mapping[str, Any]) -> Task:
        """Return the task of a row of `plan(study).to_dict("records")`."""
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
        plain = not changes["case"]
        device = self._device(place, changes["bearing"], shared, plain)
        prepared = self._structure(structure, changes["structure"], shared, plain)
        shaking = self._shaking(motion, shared, plain, float(row["scale"]))
        air = float(row[AMBIENT])
        case = shared.model_copy(
            update={
                "structure": prepared.structure,
                "bearings": [device.bearing],
                "motions": [self.levels.listed[motion]],
                "ambient": [air],
            }
        )
        line = (
            partial(self._soaked_line, int(row[HOUR]), air, case)
            if HOUR in row
            else partial(one_line, case, air=air, weather=None)
        )
        lines = prepared_lines(case, device, self._own(case, plain), line)
        return Task(prepared, device, shaking, air, lines, case, case.modes[0])

    def _case(self, changes: Changes, row: Mapping[str, Any]) -> EarthquakeCase:
        case = with_numbers(self.study.case, changes) if changes else self.study.case
        if case.laboratory is not None and case.laboratory.force_noise > 0.0:
            own = case.laboratory.model_copy(update={"seed": int(row["seed"])})
            case = case.model_copy(update={"laboratory": own})
        return case

    def _structure(
        self, level: int, changes: Changes, case: EarthquakeCase, plain: bool
    ) -> Prepared:
        shared = plain and not changes
        if shared and level in self._prepared:
            return self._prepared[level]
        structure = with_numbers(self.study.factors.structure.levels[level], changes)
        made = prepare_structure(structure, case.analysis.mass, case.analysis.damping)
        if shared:
            self._prepared[level] = made
        return made

    def _device(self, place: int, changes: Changes, case: EarthquakeCase, plain: bool) -> Device:
        bearing = self.levels.bearings[place]
        if not plain:
            return build_device(case, with_numbers(bearing, changes))
        if place not in self._devices:
            _make_room(self._devices)
            self._devices[place] = build_device(case, bearing)
        shared = self._devices[place]
        if not changes:
            return shared
        changed = with_numbers(bearing, changes)
        multi_layer = case.analysis.exposure is None and case.analysis.model == "multi-layer"
        if multi_layer and isinstance(changed, Bearing) and not any(map(moves_heat, changes)):
            assert shared.stack is not None
            constants = with_parameters(shared.constants, changed, shared.stack)
            return Device(changed, constants, shared.stack)
        return build_device(case, changed)

    def _own(self, case: EarthquakeCase, plain: bool) -> list[Device | None]:
        if self._others is not None and plain:
            return self._others
        found = [
            None if line.bearing is None else build_device(case, line.bearing)
            for line in case.lines
        ]
        if plain:
            self._others = found
        return found

    def _shaking(self, level: int, case: EarthquakeCase, plain: bool, scale: float) -> Shaking:
        shared = self._shakings.get(level) if plain else None
        if shared is None:
            one = case.model_copy(update={"motions": [self.levels.listed[level]]})
            shared = build_shaking(one, 0, self.levels.motions[level])
            if plain:
                self._shakings[level] = shared
        ground: Floats = scale * shared.ground
        return Shaking(shared.motion, shared.dt, ground)

    def _soaked_line(self, hour: int, air: float, case: EarthquakeCase, device: Device) -> OneLine:
        """Return the bearings of a line with their temperatures at an hour of the weather."""
        if not isinstance(device.bearing, Bearing):
            return one_line(case, device, air, None)
        if self.warmth.own:
            return one_line(case, device, air, self.warmth._before(hour))
        return OneLine(device, *self.warmth._at(device, case, hour), air)

    def foresee(self, rows: pd.DataFrame) -> None:
        """Compute the temperatures of the bearings of all rows."""
        if HOUR in rows:
            case = self.study.case
            self.warmth._foresee(
                (_thermal_key(device, case), device, hours) for device, hours in self._warmed(rows)
            )

    def foreseen_temperatures(self, rows: pd.DataFrame) -> Warm | None:
        """Return the temperatures of some rows, for another process; None without weather."""
        if HOUR not in rows:
            return None
        wanted: dict[Key, list[Ints]] = {}
        for device, hours in self._warmed(rows):
            wanted.setdefault(_thermal_key(device, self.study.case), []).append(hours)
        found = {}
        for key, each in wanted.items():
            every, soaked = self.warmth.known.soaked[key]
            hours = np.unique(np.concatenate(each))
            places = np.searchsorted(every, hours)
            lead = None if soaked.lead is None else soaked.lead[places]
            found[key] = hours, Soaked(soaked.temperature[places], lead)
        return Warm(found, self.warmth.known.weather)

    def take(self, warm: Warm | None) -> None:
        """Use temperatures from another process."""
        if warm is not None:
            self.warmth.known = warm

    def _warmed(self, rows: pd.DataFrame) -> Iterator[tuple[Device, Ints]]:
        """Yield layered bearings and the hours of their rows; none if all thermal keys differ."""
        if self.warmth.own:
            return
        case, hours = self.study.case, rows[HOUR].to_numpy(np.int64)
        names = self._places["bearing"]
        level = np.array([names[str(name)] for name in rows["bearing"]], dtype=np.int64)
        sample = rows[SAMPLE].to_numpy(np.int64) if SAMPLE in rows else np.full(len(rows), -1)
        place = self.levels.place(level, sample)
        for one in np.unique(place):
            try:
                device = self._device(int(one), {}, case, True)
            except InputError:
                continue  # reported by its runs
            if isinstance(device.bearing, Bearing):
                yield device, np.unique(hours[place == one])
        for mine in self._own(case, True):
            if mine is not None and isinstance(mine.bearing, Bearing):
                yield mine, np.unique(hours)
