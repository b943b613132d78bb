"""From a row of a plan to the task of `run_task`; rows share what they have in common.

The process that starts a study integrates the temperatures over its weather once for each thermal
key of a bearing (`foresee`). The temperatures of a shard are sent with its rows
(`foreseen_temperatures`, `take`), so that workers need no weather.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
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


def _make_room(kept: dict[Any, Any]) -> None:
    if len(kept) >= MOST_KEPT:
        kept.pop(next(iter(kept)))


class Preparer:
    """Prepares the runs of a study in one process, and stores what rows have in common."""

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
        self._own_heat = any(map(moves_warmth, self._targets))  # each run has its thermal key
        self._history = study.factors.ambient.history
        self._known = Warm()
        self._weights: dict[Key, Floats] = {}
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
        ambient = float(row[AMBIENT])
        case = shared.model_copy(
            update={
                "structure": prepared.structure,
                "bearings": [device.bearing],
                "motions": [self.levels.listed[motion]],
                "ambient": [ambient],
            }
        )
        line = (
            partial(self._soaked_line, int(row[HOUR]), ambient, case)
            if HOUR in row
            else partial(one_line, case, ambient=ambient, weather=None)
        )
        lines = prepared_lines(case, device, self._own(case, plain), line)
        return Task(prepared, device, shaking, ambient, lines, case, case.modes[0])

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
            constants = with_parameters(shared.constants, changed, shared.stack, only_tests=False)
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

    @property
    def _weather(self) -> Hourly:
        """Weather of the study, received or read here."""
        found = self._known.weather or self.study.factors.ambient.read_weather()
        assert found is not None
        return found

    def _soaked_line(
        self, hour: int, ambient: float, case: EarthquakeCase, device: Device
    ) -> OneLine:
        """Return the bearings of a line with their temperatures at an hour of the weather."""
        if not isinstance(device.bearing, Bearing):
            return one_line(case, device, ambient, None)
        if self._own_heat:
            assert self._history is not None
            return one_line(case, device, ambient, self._weather.before(hour, self._history))
        key = _thermal_key(device, case)
        hours, soaked = self._known.soaked.get(key, (np.zeros(0, dtype=np.int64), None))
        place = int(np.searchsorted(hours, hour))
        if soaked is not None and place < len(hours) and hours[place] == hour:
            return OneLine(device, *soaked.at(place), ambient)
        return OneLine(device, *self._soaked(key, device, np.array([hour])).at(0), ambient)

    def _soaked(self, key: Key, device: Device, hours: Ints) -> Soaked:
        """Return temperatures at some hours, after the history or all weather before."""
        weather = self._weather
        if self._history is None:
            return soaked_hours(device, weather, hours)
        if key not in self._weights:
            _make_room(self._weights)
            full = weather.full_hours(self._history)
            self._weights[key] = history_weights(device.constants, full)
        before = (weather.before(int(hour), self._history).temperature for hour in hours)
        each = [soaked_history(device.constants, self._weights[key], one) for one in before]
        lead = None if each[0][1] is None else np.array([one for _, one in each])
        return Soaked(np.array([cells for cells, _ in each]), lead)

    def foresee(self, rows: "pd.DataFrame") -> None:
        """Compute the temperatures of the bearings of all rows."""
        if HOUR in rows:
            found = {
                key: (hours, self._soaked(key, device, hours))
                for key, (device, hours) in self._warmed(rows).items()
            }
            self._known = Warm(found, self._weather if self._own_heat else None)

    def foreseen_temperatures(self, rows: "pd.DataFrame") -> Warm | None:
        """Return the temperatures of some rows, for another process; None without weather."""
        if HOUR not in rows:
            return None
        found = {}
        for key, (_, hours) in self._warmed(rows).items():
            every, soaked = self._known.soaked[key]
            places = np.searchsorted(every, hours)
            lead = None if soaked.lead is None else soaked.lead[places]
            found[key] = hours, Soaked(soaked.temperature[places], lead)
        return Warm(found, self._known.weather)

    def take(self, warm: Warm | None) -> None:
        """Use temperatures from another process."""
        if warm is not None:
            self._known = warm

    def _warmed(self, rows: "pd.DataFrame") -> dict[Key, tuple[Device, Ints]]:
        """Return layered bearings and the hours of their rows; none if all thermal keys differ."""
        if self._own_heat:
            return {}
        case, hours = self.study.case, rows[HOUR].to_numpy(np.int64)
        names = self._places["bearing"]
        level = np.array([names[str(name)] for name in rows["bearing"]], dtype=np.int64)
        sample = rows[SAMPLE].to_numpy(np.int64) if SAMPLE in rows else np.full(len(rows), -1)
        place = self.levels.place(level, sample)
        each = [(device, hours) for device in self._own(case, True) if device is not None]
        for one in np.unique(place):
            with suppress(InputError):  # reported by its runs
                each.append((self._device(int(one), {}, case, True), hours[place == one]))
        found: dict[Key, tuple[Device, Ints]] = {}
        for device, some in each:
            if isinstance(device.bearing, Bearing):
                key = _thermal_key(device, case)
                before = found[key][1] if key in found else some
                found[key] = device, np.union1d(before, some)
        return found
