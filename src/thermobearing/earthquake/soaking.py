"""Temperatures of a bearing at rest at every hour of years of weather, in one pass.

At rest the heat model is linear: the temperatures after an hour are a matrix times those before it
(cells, lead, and the memory of lead) plus two columns times the ambient temperature at its ends.
The coupled step (core/step.py) gives the matrix from unit temperatures, in the growing steps of a
rest, so there is no second heat model. Soaking from an earlier hour (`run.soaked`) agrees.
"""

from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.climate.hourly import DAY, HOUR, Hourly
from thermobearing.core.march import hours_at_rest, march
from thermobearing.core.records import Ints
from thermobearing.core.types import Constants, Floats, Path, State, new_state, new_workspace
from thermobearing.cyclic.history import build_segments, cut_rests, room_for
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.earthquake.case import make_earthquake_case, settle_surroundings
from thermobearing.earthquake.run import Device, build_device

if TYPE_CHECKING:
    import pandas as pd

AT_REST = 1e9  # clock of a core whose half-space has settled [s]
SPIN_UP = 60 * DAY  # hours before the first of a typical year


class HourMap(NamedTuple):
    """An hour of rest: `kept @ before + early * air + late * air an hour later`."""

    kept: Floats  # [n, n]
    early: Floats  # [n]
    late: Floats  # [n]


class Soaked(NamedTuple):
    """A bearing at some hours."""

    temperature: Floats  # [hours, cells]
    lead: Floats | None  # [hours]; None without

    def at(self, place: int) -> tuple[Floats, float | None]:
        """Return temperatures of cells and lead at one of the hours, as `run.soaked`."""
        return self.temperature[place], None if self.lead is None else float(self.lead[place])


def hour_map(constants: Constants) -> HourMap:
    """Return the map of an hour at rest of a bearing with a stack of cells."""
    size = len(constants.cells.capacity) + _has_lead(constants) + len(constants.lead_modes)
    nothing, still = np.zeros(size), Ambient(np.array([0.0, HOUR]), np.zeros(2))
    kept = np.column_stack([_after_an_hour(constants, unit, still) for unit in np.eye(size)])
    ends = [Ambient(np.array([0.0, HOUR]), np.array(air)) for air in ([1.0, 0.0], [0.0, 1.0])]
    early, late = (_after_an_hour(constants, nothing, air) for air in ends)
    return HourMap(np.ascontiguousarray(kept), early, late)


def _has_lead(constants: Constants) -> bool:
    return constants.lead.cores > 0.0


def _after_an_hour(constants: Constants, before: Floats, air: Ambient) -> Floats:
    """Return temperatures after an hour at rest [degC]: cells, lead, terms of lead."""
    cells = len(constants.cells.capacity)
    state = new_state(constants, before[:cells])
    spare = new_state(constants, before[:cells])
    if _has_lead(constants):
        state.branches["lead_temperature"] = state.books["lead_temperature"] = before[cells]
        state.branches["clock"] = AT_REST
        state.ends[:] = before[cells + 1 :]
    rest: Any = {"step": "rest", "duration": HOUR}
    segment = build_segments(CyclicTest(dt=10.0, steps=[rest]), 1.0)[0]
    nothing = np.zeros(len(segment.x), dtype=bool)
    segment, nothing, _ = cut_rests(constants, segment, nothing, 0.0)
    path = Path(segment.x, segment.dt, air.means(0.0, segment.dt), nothing, 0.0)
    march(constants, new_workspace(constants), state, spare, path, room_for(constants, 1, ()))
    return _vector(constants, state)


def _vector(constants: Constants, state: State) -> Floats:
    lead = state.branches["lead_temperature"] if _has_lead(constants) else np.zeros(0)
    return np.concatenate([state.temperature, lead, state.ends])


def soaked_hours(device: Device, weather: Hourly, hours: Ints | None = None) -> Soaked:
    """Return the temperatures of a bearing at some hours (all by default) of a weather.

    It is in the weather from hour 0, then at the ambient temperature; in a typical year, from sixty
    days earlier. InputError: an hour that the weather does not have.
    """
    wanted = np.arange(len(weather)) if hours is None else np.asarray(hours, dtype=np.int64)
    if len(wanted) and not 0 <= wanted.min() <= wanted.max() < len(weather):
        raise InputError(f"hours must be 0 to {len(weather) - 1}", weather.name)
    if device.stack is None:
        return Soaked(np.zeros((len(wanted), 1)), None)
    constants = device.constants
    before = SPIN_UP if weather.recurs else 0
    air = np.take(weather.temperature, np.arange(-before, len(weather)), mode="wrap")
    places, back = np.unique(wanted + before, return_inverse=True)
    found = _through(hour_map(constants), air, places, _uniform(constants, air[0]))[back]
    cells = len(constants.cells.capacity)
    lead = found[:, cells].copy() if _has_lead(constants) else None
    return Soaked(np.ascontiguousarray(found[:, :cells]), lead)


def history_weights(constants: Constants, hours: int) -> Floats:
    """Return weights [n, hours + 1]: temperatures are weights times the air at full hours.

    Rows are cells, lead and the memory of lead of a bearing that is at first as warm as the air.
    """
    hour = hour_map(constants)
    begin = _uniform(constants, 1.0)
    weights = np.zeros((len(begin), hours + 1))
    early, late = hour.early, hour.late
    for back in range(hours):
        weights[:, hours - back - 1] += early
        weights[:, hours - back] += late
        early, late, begin = hour.kept @ early, hour.kept @ late, hour.kept @ begin
    weights[:, 0] += begin
    return weights


def soaked_history(
    constants: Constants, weights: Floats, air: Floats
) -> tuple[Floats, float | None]:
    """Return temperatures of cells and lead at the end of some hours, as `run.soaked`.

    `weights` are from `history_weights`; `air` is at the full hours [degC], the end included.
    """
    found = weights @ air
    cells = len(constants.cells.capacity)
    return found[:cells].copy(), float(found[cells]) if _has_lead(constants) else None


def _uniform(constants: Constants, air: float) -> Floats:
    return _vector(constants, new_state(constants, np.full(len(constants.cells.capacity), air)))


def _through(hour: HourMap, air: Floats, places: Ints, begin: Floats) -> Floats:
    """Return the states at some increasing places of a series of air."""
    found = np.empty((len(places), len(begin)))
    kept = np.ascontiguousarray(hour.kept.T)
    now, after = begin.copy(), np.empty_like(begin)
    hours_at_rest(kept, hour.early, hour.late, air, places, now, after, found)
    return found


def bearing_weather(
    bearing: str | FilePath | Bearing | BilinearBearing, weather: Hourly, **options: Any
) -> "pd.DataFrame":
    """Return the temperatures of a bearing at rest in hourly weather: one row an hour.

    Parameters
    ----------
    bearing : str, Path or Bearing
        A name, a file, or a bearing; not a bilinear one, which has no heat.
    weather : Hourly
        From `tb.read_weather` or `tb.generate_weather`.
    **options
        Of the model and its heat, as in `tb.bridge` with weather: films of 12 W/(m2 K) at faces
        and side and 10 mm of cover rubber by default.

    Returns
    -------
    pandas.DataFrame
        Hour, date where it is known, ambient temperature, the mean of the rubber layers, the
        outermost and the innermost one modelled, and lead where there is some [degC].

    Raises
    ------
    InputError
        No such bearing, a bilinear one, an unknown option.

    Examples
    --------
    >>> from thermobearing.climate.generator import generate_weather
    >>> frame = bearing_weather("shen-lhdr-bridge", generate_weather("cold-town", 1, 4))
    >>> frame.columns[2:].tolist()
    ['ambient_degC', 'rubber_degC', 'outer_rubber_degC', 'inner_rubber_degC', 'lead_degC']
    """
    table: dict[str, Any] = {"command": "bridge", "bearings": [bearing], "analysis": options}
    settle_surroundings(table)
    case = make_earthquake_case(table, "bearing_weather")
    device = build_device(case, case.bearings[0])
    if device.stack is None:
        raise InputError("a bilinear bearing has no temperature", case.bearings[0].name)
    frame, soaked = weather.to_frame(), soaked_hours(device, weather)
    upper, lower = device.stack.middles()
    layers = 0.5 * (soaked.temperature[:, upper] + soaked.temperature[:, lower])
    count = device.constants.multiplicity
    frame["rubber_degC"] = layers @ count / count.sum()
    frame["outer_rubber_degC"], frame["inner_rubber_degC"] = layers[:, 0], layers[:, -1]
    if soaked.lead is not None:
        frame["lead_degC"] = soaked.lead
    return frame
