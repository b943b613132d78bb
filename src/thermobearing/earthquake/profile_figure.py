"""Temperature through the height of bearings at chosen times of an earthquake."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from thermobearing.border.errors import InputError
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing
from thermobearing.results.profiles import MOST_PROFILES, ProfilePanel, draw_profile_panels

QUARTERS = 4


def draw_profiles(result: EarthquakeResult, times: Sequence[float] | None) -> Figure:
    """A row for each bearing that has heat, a column for each temperature (Fig. 4.14, 5.17)."""
    data, table = result.dataset, result.table
    if "temperature" not in data:
        raise InputError('profiles: the result holds no cells; run with keep = ["rubber", "cells"]')
    warm = [run for run in range(result.runs) if np.isfinite(data["depth"].values[run]).any()]
    chosen = table.loc[warm]
    told = [str(chosen["motion"].iloc[0])]
    chosen = chosen[chosen["motion"] == told[0]]
    if "mode" in chosen:
        told.append(str(chosen["mode"].iloc[0]))
        chosen = chosen[chosen["mode"] == told[1]]
    moments = _moments(data["time"].values[chosen.index.to_numpy()], times)
    bearings, ambients = (list(dict.fromkeys(chosen[k])) for k in ("bearing", "ambient_degC"))
    panels = []
    for bearing in bearings:
        for ambient in sorted(ambients):
            mine = chosen[(chosen["bearing"] == bearing) & (chosen["ambient_degC"] == ambient)]
            whose = f"{bearing}, " if len(bearings) > 1 else ""
            panels += [_panel(data, int(run), whose, moments) for run in mine.index.to_numpy()]
    columns = len(ambients)
    size = (max(5.5, 1.9 + 2.6 * columns), 0.9 + 4.0 * len(bearings))
    whole = str(data.attrs["structure"]) + (f", {bearings[0]}" if len(bearings) == 1 else "")
    title = f"{whole}: temperature through the height, {', '.join(told)}"
    names = [f"{moment:g} s" for moment in moments]
    return draw_profile_panels(title, size, columns, panels, names)


def _moments(time: np.ndarray, times: Sequence[float] | None) -> list[float]:
    """The times asked for, or quarters of the longest run [s]."""
    longest = float(np.nanmax(time))
    if times is None:
        return [longest * (k + 1) / QUARTERS for k in range(QUARTERS)]
    faults = [f"times: {t} s is not in 0 to {longest:g} s" for t in times if not 0 <= t <= longest]
    if not 1 <= len(times) <= MOST_PROFILES:
        faults.append(f"times: {len(times)} given; 1 to {MOST_PROFILES} can be shown")
    if faults:
        raise InputError(faults, "profiles()")
    return [float(t) for t in times]


def _panel(data: xr.Dataset, run: int, whose: str, moments: list[float]) -> ProfilePanel:
    """Profiles of one run at the kept steps nearest to the times; `whose` begins its title."""
    mine = data.isel(run=run)
    time = mine["time"].values
    stack = mine.isel(cell=np.isfinite(mine["depth"].values))
    stack.attrs["half_stack"] = data.attrs["half_stack"]
    lead = mine["lead_temperature"].values
    lines: list[tuple[int, np.ndarray, float | None]] = []
    for number, moment in enumerate(moments):
        if moment > np.nanmax(time) * (1.0 + 1e-6):  # a run that ended early
            continue
        row = int(np.nanargmin(np.abs(time - moment)))
        core = float(lead[row]) if np.isfinite(lead[row]) else None
        lines.append((number, stack["temperature"].values[row].astype(float), core))
    ambient = float(mine["ambient"])
    return ProfilePanel(f"{whose}{drawing.degrees(ambient)}", ambient, stack, lines)
