"""From a row of a plan to the task of `run_task`; rows share what they have in common.

The process that starts a study integrates the temperatures over its weather once for each thermal
key of a bearing (`compute_temperatures`). The temperatures of a shard are sent with its rows
(`select_temperatures`, `use_temperatures`), so that workers need no weather.
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
    NAMED_FACTORS,
    SAMPLE,
    Plan,
)
from thermobearing.studies.definition.targets import NumberPath, affects_heat_cells, with_numbers

Key = tuple[Any, ...]
Changes = dict[NumberPath, float]
MOST_KEPT = 2000  # models of bearings that are stored


@dataclass(frozen=True)
class BearingTemperatures:
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


def _drop_oldest(cache: dict[Any, Any]) -> None:
    if len(cache) >= MOST_KEPT:
        cache.pop(next(iter(cache)))


class Preparer:
    """Prepares the runs of a study in one process, and stores what rows have in common."""

    def __init__(self, plan: Plan) -> None:
        self.study = plan.study
        self.levels = plan.levels
        self.lockstep = plan.lockstep
        self._places = {
            column.name: {str(name): k for k, name in enumerate(column.levels)}
            for column in plan.columns
            if column.name in NAMED_FACTORS
        }
        self._targets = plan.targets
        # If so, each run has its thermal key.
        self._varies_temperature = plan.varies_rest_temperature
        self._history = self.study.factors.ambient.history
        self._temperatures = BearingTemperatures()
        self._weights: dict[Key, Floats] = {}
        self._prepared: dict[int, Prepared] = {}
        self._devices: dict[int, Device] = {}
        self._shakings: dict[int, Shaking] = {}
        self._line_devices: list[Device | None] | None = None

    def make_task(self, row: Mapping[str, Any]) -> Task:
        """Return the task of a row of `Plan(study).runs.to_dict("records")`."""
        structure, bearing, motion = (self._places[name][str(row[name])] for name in NAMED_FACTORS)
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
        # What follows from an unchanged case, structure, bearing or motion is kept for other rows.
        shared = self._case(changes["case"], row)
        unchanged_case = not changes["case"]
        device = self._device(place, changes["bearing"], shared, unchanged_case)
        prepared = self._structure(structure, changes["structure"], shared, unchanged_case)
        shaking = self._shaking(motion, shared, unchanged_case, float(row["scale"]))
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
        lines = prepared_lines(case, device, self._devices_of_lines(case, unchanged_case), line)
        return Task(prepared, device, shaking, ambient, lines, case, case.modes[0])

    def _case(self, changes: Changes, row: Mapping[str, Any]) -> EarthquakeCase:
        case = with_numbers(self.study.case, changes) if changes else self.study.case
        if case.laboratory is not None and case.laboratory.force_noise > 0.0:
            # The noise of each run has its own random numbers.
            laboratory = case.laboratory.model_copy(update={"seed": int(row["seed"])})
            case = case.model_copy(update={"laboratory": laboratory})
        return case

    def _structure(
        self, level: int, changes: Changes, case: EarthquakeCase, unchanged_case: bool
    ) -> Prepared:
        shared = unchanged_case and not changes
        if shared and level in self._prepared:
            return self._prepared[level]
        structure = with_numbers(self.study.factors.structure.levels[level], changes)
        prepared = prepare_structure(structure, case.analysis.mass, case.analysis.damping)
        if shared:
            self._prepared[level] = prepared
        return prepared

    def _device(
        self, place: int, changes: Changes, case: EarthquakeCase, unchanged_case: bool
    ) -> Device:
        bearing = self.levels.bearings[place]
        if not unchanged_case:
            return build_device(case, with_numbers(bearing, changes))
        if place not in self._devices:
            _drop_oldest(self._devices)
            self._devices[place] = build_device(case, bearing)
        shared = self._devices[place]
        if not changes:
            return shared
        changed = with_numbers(bearing, changes)
        analysis = case.analysis
        plain_layers = (
            analysis.model == "multi-layer" and analysis.exposure is None and analysis.state is None
        )
        same_cells = isinstance(changed, Bearing) and not any(map(affects_heat_cells, changes))
        # Then the stack of heat cells and what depends on it stay, and only the law changes.
        if plain_layers and same_cells:
            assert isinstance(changed, Bearing)
            assert shared.stack is not None
            constants = with_parameters(shared.constants, changed, shared.stack, only_tests=False)
            return Device(changed, constants, shared.stack)
        return build_device(case, changed)

    def _devices_of_lines(self, case: EarthquakeCase, unchanged_case: bool) -> list[Device | None]:
        if self._line_devices is not None and unchanged_case:
            return self._line_devices
        devices = [
            None if line.bearing is None else build_device(case, line.bearing, line.state)
            for line in case.lines
        ]
        if unchanged_case:
            self._line_devices = devices
        return devices

    def _shaking(
        self, level: int, case: EarthquakeCase, unchanged_case: bool, scale: float
    ) -> Shaking:
        shared = self._shakings.get(level) if unchanged_case else None
        if shared is None:
            motion_case = case.model_copy(update={"motions": [self.levels.listed[level]]})
            shared = build_shaking(motion_case, 0, self.levels.motions[level])
            if unchanged_case:
                self._shakings[level] = shared
        ground: Floats = scale * shared.ground
        vertical = None if shared.vertical is None else scale * shared.vertical
        return Shaking(shared.motion, shared.dt, ground, scale * shared.factor, vertical)

    @property
    def _weather(self) -> Hourly:
        """Weather of the study, received or read here."""
        weather = self._temperatures.weather or self.study.factors.ambient.read_weather()
        assert weather is not None
        return weather

    def _soaked_line(
        self, hour: int, ambient: float, case: EarthquakeCase, device: Device
    ) -> OneLine:
        """Return the bearings of a line with their temperatures at an hour of the weather."""
        if not isinstance(device.bearing, Bearing):
            return one_line(case, device, ambient, None)
        if self._varies_temperature:
            assert self._history is not None
            return one_line(case, device, ambient, self._weather.before(hour, self._history))
        key = _thermal_key(device, case)
        # The hour of a run that is repeated alone was not computed before.
        hours, soaked = self._temperatures.soaked.get(key, (np.zeros(0, dtype=np.int64), None))
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
            _drop_oldest(self._weights)
            full = weather.full_hours(self._history)
            self._weights[key] = history_weights(device.constants, full)
        histories = (weather.before(int(hour), self._history).temperature for hour in hours)
        outcomes = [
            soaked_history(device.constants, self._weights[key], temperatures)
            for temperatures in histories
        ]
        lead = None
        if outcomes[0][1] is not None:
            lead = np.array([lead_temperature for _, lead_temperature in outcomes])
        return Soaked(np.array([cells for cells, _ in outcomes]), lead)

    def compute_temperatures(self, rows: "pd.DataFrame") -> None:
        """Compute the temperatures of the bearings of all rows."""
        if HOUR in rows:
            soaked = {
                key: (hours, self._soaked(key, device, hours))
                for key, (device, hours) in self._hours_by_key(rows).items()
            }
            self._temperatures = BearingTemperatures(
                soaked, self._weather if self._varies_temperature else None
            )

    def select_temperatures(self, rows: "pd.DataFrame") -> BearingTemperatures | None:
        """Return the temperatures of some rows, for another process; None without weather."""
        if HOUR not in rows:
            return None
        selected = {}
        for key, (_, hours) in self._hours_by_key(rows).items():
            all_hours, soaked = self._temperatures.soaked[key]
            places = np.searchsorted(all_hours, hours)
            lead = None if soaked.lead is None else soaked.lead[places]
            selected[key] = hours, Soaked(soaked.temperature[places], lead)
        return BearingTemperatures(selected, self._temperatures.weather)

    def use_temperatures(self, temperatures: BearingTemperatures | None) -> None:
        """Use temperatures from another process."""
        if temperatures is not None:
            self._temperatures = temperatures

    def _hours_by_key(self, rows: "pd.DataFrame") -> dict[Key, tuple[Device, Ints]]:
        """Return layered bearings and the hours of their rows; none if all thermal keys differ."""
        if self._varies_temperature:
            return {}
        case, hours = self.study.case, rows[HOUR].to_numpy(np.int64)
        names = self._places["bearing"]
        level = np.array([names[str(name)] for name in rows["bearing"]], dtype=np.int64)
        sample = rows[SAMPLE].to_numpy(np.int64) if SAMPLE in rows else np.full(len(rows), -1)
        place = self.levels.place(level, sample)
        device_hours = [
            (device, hours) for device in self._devices_of_lines(case, True) if device is not None
        ]
        for bearing_place in np.unique(place):
            with suppress(InputError):  # reported by its runs
                device = self._device(int(bearing_place), {}, case, True)
                device_hours.append((device, hours[place == bearing_place]))
        groups: dict[Key, tuple[Device, Ints]] = {}
        for device, hours_of_device in device_hours:
            if isinstance(device.bearing, Bearing):
                key = _thermal_key(device, case)
                earlier_hours = groups[key][1] if key in groups else hours_of_device
                groups[key] = device, np.union1d(earlier_hours, hours_of_device)
        return groups
