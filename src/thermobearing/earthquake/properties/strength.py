"""The strength of lead that was never tested: peaks with the ends of the range of tested cores."""

import tomllib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.bearing.sources import STIFFNESS, STRENGTH, is_assumed
from thermobearing.border.errors import InputError
from thermobearing.earthquake.case import (
    EarthquakeCase,
    list_bearing_tables,
    make_earthquake_case,
)
from thermobearing.earthquake.properties.notes import bearing_sources, lead_strength
from thermobearing.earthquake.run import run_earthquake
from thermobearing.quantities.words import counted, joined, number, plain
from thermobearing.results.base import COMPLETED

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

OF_STRENGTH: Final = {  # column of the table of runs: words, factor and unit
    "bearing_force_max_kN": ("force of one bearing", 1.0, "kN"),
    "bearing_strain_max": ("shear strain", 100.0, "%"),
    "pier_moment_max_kN_m": ("pier moment", 1.0, "kN m"),
}


class StrengthBand(NamedTuple):
    """The largest peaks of a bridge with lead of other strengths, where it was never tested."""

    names: list[str]  # of the bearings
    stresses: list[float]  # of their lead [MPa]
    peaks: dict[str, list[float]]  # largest of all runs: of the analysis, then by stress
    runs: int


def untested_bearings(case: Mapping[str, Any], key: str) -> list[str]:
    """Return the bearings of a resolved case whose number of a key was not measured."""
    return [
        str(table["name"])
        for table in list_bearing_tables(case)
        if is_assumed(bearing_sources(case, table).get(key, ""))
    ]


def run_strength_band(result: "EarthquakeResult") -> StrengthBand | None:
    """Run a bridge with the lowest and highest strength of tested lead cores.

    In place of the yield stress of each bearing whose own was assumed or chosen
    (data/materials/lead-strength.toml). None for hybrid tests, without such a bearing, and where a
    record of the motions is not there any more.
    """
    table = tomllib.loads(str(result.dataset.attrs["case"]))
    if table["command"] != "bridge" or "initial_state" in table or not result.runs:
        return None
    case = make_earthquake_case(table, "result")
    devices = [*case.bearings, *(item.bearing for item in case.lines)]
    untested = untested_bearings(table, STRENGTH[0])
    names = [
        device.name
        for device in devices
        if isinstance(device, Bearing) and device.lead is not None and device.name in untested
    ]
    if not names:
        return None
    band = lead_strength()
    stresses = [band.lowest, band.highest]
    peaks = _largest_peaks(result)
    runs = 0
    try:
        for stress in stresses:
            other = run_earthquake(_with_strength(case, names, stress))
            runs += other.runs
            for column, values in _largest_peaks(other).items():
                peaks[column] += values
    except InputError:
        return None
    return StrengthBand(list(dict.fromkeys(names)), stresses, peaks, runs)


def _with_strength(case: EarthquakeCase, names: list[str], stress: float) -> EarthquakeCase:
    """Return a case with the lead of some bearings of a yield stress [MPa]."""

    def _changed(device: Any) -> Any:
        if device is None or device.name not in names:
            return device
        lead = device.lead.model_copy(update={"yield_stress": stress})
        return device.model_copy(update={"lead": lead})

    lines = [
        line.model_copy(update={"bearing": _changed(line.bearing)})
        if line.bearing is not None
        else line
        for line in case.lines
    ]
    update = {"bearings": [_changed(item) for item in case.bearings], "lines": tuple(lines)}
    return case.model_copy(update=update)


def _largest_peaks(result: "EarthquakeResult") -> dict[str, list[float]]:
    """Return the largest value of each peak over the completed runs; NaN without one."""
    table = result.table[result.table["outcome"] == COMPLETED]
    peaks = {}
    for column in OF_STRENGTH:
        values = table[column].dropna().to_numpy(dtype=float)
        peaks[column] = [float(values.max()) if len(values) else np.nan]
    return peaks


def strength_sentence(band: StrengthBand) -> str:
    """Return the largest peaks with other strengths of lead, as a sentence."""
    phrases = []
    for column, values in band.peaks.items():
        words, factor, unit = OF_STRENGTH[column]
        if np.isfinite(values).all():
            before, *others = (number(factor * value) for value in values)
            phrases.append(f"the largest {words} is {joined(others)} instead of {before} {unit}")
    stresses = joined(f"{stress:g}" for stress in band.stresses)
    return (
        f"With {stresses} MPa, the range of tested lead cores, in place of the yield stress of "
        f"{joined(band.names)}, {joined(phrases)} ({counted(band.runs, 'more run')} of the "
        "analysis)."
    )


def action_on_untested(case: Mapping[str, Any], band: StrengthBand | None) -> str:
    """Return what to do about bearings that were never tested; empty where all were.

    `band` states by how much the strength of their lead changes the governing peaks.
    """
    of_rubber = untested_bearings(case, STIFFNESS[0])
    if band is None:
        return f"Have {joined(of_rubber)} tested, or ask the maker for G." if of_rubber else ""
    changes = []
    for column, peaks in band.peaks.items():
        low, high = (100.0 * (value / peaks[0] - 1.0) for value in (min(peaks), max(peaks)))
        if np.isfinite(low) and np.isfinite(high):
            changes.append(f"{OF_STRENGTH[column][0]} by {low:+.0f} to {high:+.0f} %")
    names = dict.fromkeys([*of_rubber, *band.names])
    values = "G and Q_d" if of_rubber else "Q_d"
    ends = " to ".join(f"{stress:g}" for stress in band.stresses)
    return plain(
        f"Have {joined(names)} tested, or ask the maker for {values}: yield stresses of lead of "
        f"{ends} MPa change the largest {joined(changes)}."
    )
