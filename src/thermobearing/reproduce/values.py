"""Numbers out of results in the shape that claims want: warm to cold, strain by strain."""

from collections.abc import Sequence

import numpy as np

from thermobearing.core.types import Floats
from thermobearing.cyclic.result import Result
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.reproduce.runs import AMBIENT, Runs

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
SPECIMENS = (HDR, LHDR)
MODES = ("rt", "pd")
FORCE, STRAIN = "bearing_force_max_kN", "bearing_strain_max"
ENERGY, PIER = "bearing_energy_kN_mm", "pier_displacement_max_mm"
ACCELERATION = "pier_top_acceleration_max_m_s2"
Numbers = float | tuple[float, ...] | list[tuple[float, ...]]  # what a claim gives


def told(values: Floats) -> tuple[float, ...]:
    """As plain numbers."""
    return tuple(float(value) for value in values)


def rows(values: Floats) -> list[tuple[float, ...]]:
    """As plain numbers, row by row."""
    return [told(row) for row in values]


def of_cycle(runs: Runs, bearing: str, column: str, cycle: int) -> Floats:
    """A measure of one cycle of Table 3.4, a row per amplitude, warm to cold."""
    table = runs.once(lambda: runs.cyclic(bearing).cycles, "cycles", bearing)
    rows = table[table["cycle"] == cycle]
    found = rows.pivot(index="amplitude_strain", columns="ambient_degC", values=column)
    return np.asarray(found[list(AMBIENT)], dtype=float)


def all_cycles(runs: Runs, bearing: str, column: str) -> Floats:
    """A measure of the cycles 1 to 5, a row per amplitude and temperature."""
    return np.stack([of_cycle(runs, bearing, column, n).ravel() for n in range(1, 6)], axis=1)


def rises_in_loading(runs: Runs, bearing: str, place: str) -> Floats:
    """Largest rise of layers ("rubber1", ...) or "lead" at each amplitude, warm to cold [K]."""
    result = runs.cyclic(bearing)
    found = []
    for run, air in enumerate(result["ambient"].values):
        inside = result["cycle"].values[run] > 0
        segment = result["segment"].values[run]
        values = temperature_at(result, place, run)
        parts = np.unique(segment[inside])
        found.append([values[inside & (segment == part)].max() - air for part in parts])
    return np.array(found).T


def temperature_at(result: Result, place: str, run: int) -> Floats:
    """History of a layer ("rubber1" is the outer one) or of the lead [degC]."""
    if place == "lead":
        return np.asarray(result["lead_temperature"].values[run], dtype=float)
    layer = int(place.removeprefix("rubber")) - 1
    return np.asarray(result["rubber_temperature"].values[run, :, layer], dtype=float)


def last_loading(result: Result, run: int) -> int:
    """Sample at which the last loading (of 250 % in Table 3.4) ends."""
    return int(np.flatnonzero(result["cycle"].values[run] > 0)[-1])


def loadings(result: Result, run: int) -> list[tuple[int, int]]:
    """First and last sample of the five cycles of every amplitude."""
    inside = result["cycle"].values[run] > 0
    segment = result["segment"].values[run]
    parts = [np.flatnonzero(inside & (segment == part)) for part in np.unique(segment[inside])]
    return [(int(part[0]), int(part[-1])) for part in parts]


def both(runs: Runs) -> EarthquakeResult:
    """Both specimens at three temperatures in real time and pseudo-dynamically: 12 runs."""
    return runs.hybrid(SPECIMENS, mode=MODES)


def of_hybrid(runs: Runs, bearing: str, mode: str, column: str) -> Floats:
    """Of the table of the hybrid tests, warm to cold."""
    table = runs.once(lambda: both(runs).table, "table of both")
    rows = table[(table["bearing"] == bearing) & (table["mode"] == mode)]
    rows = rows.sort_values("ambient_degC", ascending=False)
    return np.asarray(rows[column], dtype=float)


def every_hybrid(runs: Runs, column: str) -> Floats:
    """The same, a row for each specimen and mode."""
    return np.array([of_hybrid(runs, b, m, column) for b in SPECIMENS for m in MODES])


def real_over_pseudo(runs: Runs, bearing: str, column: str) -> Floats:
    """Real time over pseudo-dynamic, warm to cold."""
    return of_hybrid(runs, bearing, "rt", column) / of_hybrid(runs, bearing, "pd", column)


def rise_ratios(runs: Runs, bearing: str, place: str) -> Floats:
    """Rise in real time over pseudo-dynamic ("outer_layer", "inner_layer", "lead")."""
    table = runs.once(lambda: both(runs).modes_table, "modes of both")
    rows = table[table["bearing"] == bearing].sort_values("ambient_degC", ascending=False)
    return np.asarray(rows[f"{place}_rise_ratio"], dtype=float)


def histories(result: EarthquakeResult, run: int, name: str) -> tuple[Floats, Floats]:
    """Time and a history of one run, without what comes after its end."""
    time = np.asarray(result["time"].values[run], dtype=float)
    known = np.isfinite(time)
    return time[known], np.asarray(result[name].values[run], dtype=float)[known]


def at_moments(result: EarthquakeResult, run: int, name: str, moments: Sequence[float]) -> Floats:
    """A history (of layers or cells a column each) at some moments [s]."""
    time, values = histories(result, run, name)
    columns = values.reshape(len(time), -1)
    return np.stack([np.interp(moments, time, column) for column in columns.T], axis=1)
