"""How warm the bearings of a study are when the earthquake comes, by the weather before it.

The process that starts a study goes through its weather once, for each way in which a bearing
takes on warmth (`foresee`); what came of it at the hours of a shard travels with the rows of the
shard (`of`, `take`), so that no worker reads the weather, or goes through it again.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.model import Bearing
from thermobearing.climate.hourly import Hourly
from thermobearing.core.records import Floats, Ints
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.run import Device
from thermobearing.earthquake.soaking import Soaked, history_weights, soaked_history, soaked_hours
from thermobearing.studies.inputs.levels import Levels

Key = tuple[Any, ...]
MOST_KEPT = 2000  # bearings whose temperatures are kept when rows come one by one


@dataclass(frozen=True)
class Warm:
    """What the weather made of the bearings of some runs; small enough to be sent with them.

    Attributes
    ----------
    soaked : for each way to take on warmth hours, increasing, and the bearing at them.
    weather : itself, where each run takes on warmth in a way of its own.
    """

    soaked: Mapping[Key, tuple[Ints, Soaked]] = field(default_factory=dict)
    weather: Hourly | None = None


def thermal_key(device: Device, case: EarthquakeCase) -> Key:
    """What of a bearing its heat knows: bearings that are alike in it are as warm at rest."""
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
    """Temperatures of the bearings of a study at the hours of its weather, each found once.

    Parameters
    ----------
    levels : of the study.
    own : every run takes on warmth in a way of its own, and nothing of it is kept.
    """

    def __init__(self, levels: Levels, *, own: bool) -> None:
        self.levels, self.own = levels, own
        self.history = levels.study.factors.ambient.history
        self._known = Warm()
        self._weights: dict[Key, Floats] = {}

    @property
    def weather(self) -> Hourly:
        """Of the study, as it was sent or read here."""
        found = self._known.weather or self.levels.weather
        assert found is not None
        return found

    def before(self, hour: int) -> Ambient:
        """The air of the history of an hour."""
        assert self.history is not None
        return self.weather.before(hour, self.history)

    def foresee(self, wanted: Iterable[tuple[Key, Device, Ints]]) -> None:
        """Find all temperatures that will be asked for.

        Parameters
        ----------
        wanted : ways to take on warmth, a bearing of each, and hours.
        """
        devices: dict[Key, Device] = {}
        hours: dict[Key, list[Ints]] = {}
        for key, device, some in wanted:
            devices[key] = device
            hours.setdefault(key, []).append(some)
        found = {}
        for key, device in devices.items():
            every = np.unique(np.concatenate(hours[key]))
            found[key] = every, self._soaked(key, device, every)
        self._known = Warm(found, self.weather if self.own else None)

    def of(self, wanted: Iterable[tuple[Key, Ints]]) -> Warm:
        """What was foreseen of some hours.

        Parameters
        ----------
        wanted : ways to take on warmth, and hours, increasing.
        """
        found = {}
        for key, hours in wanted:
            every, soaked = self._known.soaked[key]
            places = np.searchsorted(every, hours)
            lead = None if soaked.lead is None else soaked.lead[places]
            found[key] = hours, Soaked(soaked.temperature[places], lead)
        return Warm(found, self._known.weather)

    def take(self, warm: Warm) -> None:
        """Know what another process has found, and forget the rest."""
        self._known = warm

    def at(self, device: Device, case: EarthquakeCase, hour: int) -> tuple[Floats, float | None]:
        """Temperatures of cells and lead of a bearing at an hour; found here if nobody has."""
        key = thermal_key(device, case)
        hours, soaked = self._known.soaked.get(key, (np.zeros(0, dtype=np.int64), None))
        place = int(np.searchsorted(hours, hour))
        if soaked is not None and place < len(hours) and hours[place] == hour:
            return soaked.at(place)
        return self._soaked(key, device, np.array([hour])).at(0)

    def _soaked(self, key: Key, device: Device, hours: Ints) -> Soaked:
        """A bearing at some hours: after its history, or after all the weather before."""
        if self.history is None:
            return soaked_hours(device, self.weather, hours)
        if key not in self._weights:
            if len(self._weights) >= MOST_KEPT:
                self._weights.pop(next(iter(self._weights)))
            full = self.weather.full_hours(self.history)
            self._weights[key] = history_weights(device.constants, full)
        each = [
            soaked_history(device.constants, self._weights[key], self.before(int(h)).temperature)
            for h in hours
        ]
        lead = None if each[0][1] is None else np.array([one for _, one in each])
        return Soaked(np.array([cells for cells, _ in each]), lead)
