"""A bearing at rest through hourly weather of years: its temperatures at every hour in one pass.

At rest the heat model is linear: where an hour leads to is a matrix times the temperatures at its
beginning (cells, lead, and what lead remembers) plus two columns times the air at its two ends.
The matrix is what the one coupled step (core/step.py) makes of unit temperatures, in the growing
steps of a rest, so there is no second heat model; a series of fifty years is then a matrix product
an hour. Soaking from an earlier hour (`run.soaked`) comes to the same.
"""

from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

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


@dataclass(frozen=True)
class HourMap:
    """Where an hour of rest leads to: `kept @ before + early * air + late * air an hour later`."""

    kept: Floats  # [n, n]
    early: Floats  # [n]
    late: Floats  # [n]


@dataclass(frozen=True)
class Soaked:
    """A bearing at some hours: cell temperatures [hours, cells] and that of the lead [hours].

    `lead` is None for a bearing without.
    """

    temperature: Floats
    lead: Floats | None

    def at(self, place: int) -> tuple[Floats, float | None]:
        """Temperatures of cells and lead at one of the hours, as `run.soaked` returns them."""
        return self.temperature[place], None if self.lead is None else float(self.lead[place])


def hour_map(constants: Constants) -> HourMap:
    """The map of an hour at rest, from the coupled step.

    Parameters
    ----------
    constants : of a bearing with a stack of cells.
    """
    size = len(constants.cells.capacity) + _has_lead(constants) + len(constants.lead_modes)
    nothing, still = np.zeros(size), Ambient(np.array([0.0, HOUR]), np.zeros(2))
    kept = np.column_stack([_after_an_hour(constants, unit, still) for unit in np.eye(size)])
    ends = [Ambient(np.array([0.0, HOUR]), np.array(air)) for air in ([1.0, 0.0], [0.0, 1.0])]
    early, late = (_after_an_hour(constants, nothing, air) for air in ends)
    return HourMap(np.ascontiguousarray(kept), early, late)


def _has_lead(constants: Constants) -> bool:
    return constants.lead.cores > 0.0


def _after_an_hour(constants: Constants, before: Floats, air: Ambient) -> Floats:
    """Temperatures after an hour at rest [degC]: cells, lead, terms of lead."""
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
    air_of_steps = air.means(0.0, segment.dt)
    path = Path(segment.x, segment.dt, air_of_steps, nothing, 0.0)
    march(constants, new_workspace(constants), state, spare, path, room_for(constants, 1, ()))
    return _vector(constants, state)


def _vector(constants: Constants, state: State) -> Floats:
    lead = state.branches["lead_temperature"] if _has_lead(constants) else np.zeros(0)
    return np.concatenate([state.temperature, lead, state.ends])


def soaked_hours(device: Device, weather: Hourly, hours: Ints | None = None) -> Soaked:
    """Temperatures of a bearing at hours of a weather that it has been in since the beginning.

    At hour 0 it is as warm as the air; of a typical year, it has had the sixty days before.

    Parameters
    ----------
    device : from `run.build_device`.
    weather : hourly.
    hours : those that are wanted, in any order; all of them by default.

    Raises
    ------
    InputError : an hour that the weather does not have.
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
    """What the air of some hours leaves behind: temperatures are these weights times the air.

    Parameters
    ----------
    constants : of a bearing with a stack of cells, at first as warm as the air.
    hours : of the history, at least 1.

    Returns
    -------
    [n, hours + 1] : rows are cells, lead and what lead remembers; columns the air at full hours.
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
    """Temperatures of cells and lead at the end of some hours, as `run.soaked` returns them.

    Parameters
    ----------
    constants : of the bearing.
    weights : from `history_weights`.
    air : at the full hours [degC], the end included.
    """
    found = weights @ air
    cells = len(constants.cells.capacity)
    return found[:cells].copy(), float(found[cells]) if _has_lead(constants) else None


def _uniform(constants: Constants, air: float) -> Floats:
    return _vector(constants, new_state(constants, np.full(len(constants.cells.capacity), air)))


def _through(hour: HourMap, air: Floats, places: Ints, begin: Floats) -> Floats:
    """States at some increasing places of a series of air."""
    found = np.empty((len(places), len(begin)))
    kept = np.ascontiguousarray(hour.kept.T)
    now, after = begin.copy(), np.empty_like(begin)
    hours_at_rest(kept, hour.early, hour.late, air, places, now, after, found)
    return found


def bearing_weather(
    bearing: str | FilePath | Bearing | BilinearBearing, weather: Hourly, **options: Any
) -> "pd.DataFrame":
    """How warm a bearing at rest is through hourly weather: one row an hour.

    Parameters
    ----------
    bearing : a name, a file, or a bearing; none that is bilinear, which has no heat.
    weather : from `tb.read_weather` or `tb.generate_weather`.
    **options : of the model and its heat, as in `tb.bridge` with weather: films of 12 W/(m2 K) at
        faces and side and 10 mm of cover rubber by default.

    Returns
    -------
    DataFrame : hour, date where it is known, air, the mean of the rubber layers, the outermost and
        the innermost one modelled, and lead where there is some [degC].

    Raises
    ------
    InputError : no such bearing, a bilinear one, an unknown option.

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
