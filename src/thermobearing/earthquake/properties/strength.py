"""The strength of lead that was never tested: peaks with the ends of the range of tested cores."""

import tomllib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.bearing.sources import STIFFNESS, STRENGTH, is_assumed
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.earthquake.case import (
    EarthquakeCase,
    list_bearing_tables,
    make_earthquake_case,
)
from thermobearing.earthquake.measures import CONDITIONS
from thermobearing.earthquake.properties.notes import bearing_sources, lead_strength
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.outcomes import MELTED
from thermobearing.quantities.words import counted, degrees, joined, number, percent, plain
from thermobearing.results.base import COMPLETED

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

STRAIN: Final = "bearing_strain_max"
NAMED_RUNS = 2  # that end early, in a sentence
OF_STRENGTH: Final = {  # column of the table of runs: words, factor and unit
    "bearing_force_max_kN": ("force of one bearing", 1.0, "kN"),
    STRAIN: ("shear strain", 100.0, "%"),
    "pier_moment_max_kN_m": ("pier moment", 1.0, "kN m"),
}


class Comparison(NamedTuple):
    """The largest peaks with other strengths of lead, of runs that all of them complete."""

    stresses: list[float]  # of the lead [MPa]
    compared: int  # runs of each strength, and of the analysis, that are compared
    peaks: dict[str, list[float]]  # largest of these runs: of the analysis, then by stress


class EarlyEnd(NamedTuple):
    """Runs with one strength of lead that were not completed, with one outcome."""

    stress: float  # [MPa]
    outcome: str
    runs: list[str]
    strain: float  # largest until then


class StrengthBand(NamedTuple):
    """The largest peaks of a bridge with lead of other strengths, where it was never tested."""

    names: list[str]  # of the bearings
    stresses: list[float]  # of their lead [MPa]
    comparisons: list[Comparison]  # one, where all strengths complete the same runs
    early: list[EarlyEnd]  # melted lead first
    runs: int  # besides those of the analysis
    of_analysis: int  # runs of the analysis, and so of each strength


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
    resolved = tomllib.loads(str(result.dataset.attrs["case"]))
    if resolved["command"] != "bridge" or "initial_state" in resolved or not result.runs:
        return None
    case = make_earthquake_case(resolved, "result")
    devices = [*case.bearings, *(item.bearing for item in case.lines)]
    untested = untested_bearings(resolved, STRENGTH[0])
    names = [
        device.name
        for device in devices
        if isinstance(device, Bearing) and device.lead is not None and device.name in untested
    ]
    if not names:
        return None
    band = lead_strength()
    stresses = [band.lowest, band.highest]
    analysed, runs = _table_by_run(result), 0
    tables: dict[float, pd.DataFrame] = {}
    try:
        for stress in stresses:
            table = _table_by_run(run_earthquake(_with_strength(case, names, stress)))
            runs += len(table)
            # A selection of the runs of a case has fewer.
            tables[stress] = table[table.index.isin(analysed.index)]
    except InputError:
        return None
    comparisons = _comparisons(analysed, tables)
    early = [end for stress, table in tables.items() for end in _early_ends(stress, table)]
    names = list(dict.fromkeys(names))
    return StrengthBand(names, stresses, comparisons, early, runs, result.runs)


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


def _table_by_run(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return the table of runs by their names in sentences, such as "strong-3 at 23 °C"."""
    table = result.table
    bearings = table["bearing"].nunique() > 1
    names = [
        f"{bearing}, " * bearings + f"{motion} at {degrees([ambient])}"
        for bearing, motion, ambient in table[list(CONDITIONS)].itertuples(index=False)
    ]
    return table.set_index(pd.Index(names))


def _comparisons(
    analysed: "pd.DataFrame", tables: Mapping[float, "pd.DataFrame"]
) -> list[Comparison]:
    """Return the largest peaks of strengths next to those of the same runs of the analysis.

    A run that one of both did not complete is left out of both: its peaks are not known.
    """
    stresses_by_runs: dict[tuple[int, ...], list[float]] = {}
    for stress, table in tables.items():
        both = [
            place
            for place, pair in enumerate(zip(analysed["outcome"], table["outcome"], strict=True))
            if set(pair) == {COMPLETED}
        ]
        stresses_by_runs.setdefault(tuple(both), []).append(stress)
    comparisons = []
    for places, stresses in stresses_by_runs.items():
        compared = [
            table.iloc[list(places)] for table in (analysed, *(tables[s] for s in stresses))
        ]
        peaks = {
            column: [float(table[column].max()) for table in compared] for column in OF_STRENGTH
        }
        comparisons.append(Comparison(stresses, len(places), peaks))
    return comparisons


def _early_ends(stress: float, table: "pd.DataFrame") -> list[EarlyEnd]:
    """Return the runs with a strength of lead that were not completed, by outcome."""
    ended = table[table["outcome"] != COMPLETED]
    ends = [
        EarlyEnd(stress, str(outcome), list(rows.index), float(rows[STRAIN].max()))
        for outcome, rows in ended.groupby("outcome", sort=False)
    ]
    return sorted(ends, key=lambda end: end.outcome != MELTED)


def _early_clause(band: StrengthBand, end: EarlyEnd) -> str:
    """Return which runs with a strength of lead were not completed, as a clause."""
    where = joined(end.runs)
    strain = f"shear strain {percent(end.strain)} until then"
    if len(end.runs) > NAMED_RUNS:
        where = f"{len(end.runs)} of {counted(band.of_analysis, 'run')}"
        strain = f"shear strain up to {percent(end.strain)} until then"
    happens = "the lead melts in" if end.outcome == MELTED else "there is no complete result of"
    outcome = "" if end.outcome == MELTED else f"{end.outcome.replace('_', ' ')}, "
    return f"with {end.stress:g} MPa {happens} {where} ({outcome}{strain})"


def _peak_phrases(comparison: Comparison) -> str:
    """Return the largest peaks of a comparison as clauses."""
    phrases = []
    for column, values in comparison.peaks.items():
        words, factor, unit = OF_STRENGTH[column]
        if np.isfinite(values).all():
            before, *others = (number(factor * value) for value in values)
            phrases.append(f"the largest {words} is {joined(others)} instead of {before} {unit}")
    return joined(phrases)


def strength_sentence(band: StrengthBand) -> str:
    """Return the largest peaks with other strengths of lead, and which runs end early."""
    stresses, names = _stresses(band.stresses), joined(band.names)
    more = f"({counted(band.runs, 'more run')} of the analysis)"
    if [item.compared for item in band.comparisons] == [band.of_analysis]:
        return (
            f"With {stresses} MPa, the range of tested lead cores, in place of the yield stress of "
            f"{names}, {_peak_phrases(band.comparisons[0])} {more}."
        )
    sentences = [
        f"{stresses} MPa, the range of tested lead cores, were run in place of the yield stress of "
        f"{names} {more}"
    ]
    for end in band.early:
        clause = _early_clause(band, end)
        sentences.append(f"{clause[:1].upper()}{clause[1:]}")
    for comparison in band.comparisons:
        if not (phrases := _peak_phrases(comparison)):
            continue
        scope = _scope(band, comparison)
        sentences.append(f"With {_stresses(comparison.stresses)} MPa{scope}, {phrases}")
    return f"{'. '.join(sentences)}."


def _scope(band: StrengthBand, comparison: Comparison) -> str:
    """Return which runs a comparison is of; empty where it is of all."""
    if comparison.compared == band.of_analysis:
        return ""
    runs = counted(comparison.compared, "run")
    strengths = "these strengths" if len(comparison.stresses) > 1 else "this strength"
    return f" in the {runs} that are complete with {strengths} and in the analysis"


def _stresses(stresses: Sequence[float]) -> str:
    return joined(f"{stress:g}" for stress in stresses)


def action_on_untested(case: Mapping[str, Any], band: StrengthBand | None) -> str:
    """Return what to do about bearings that were never tested; empty where all were.

    `band` states by how much the strength of their lead changes the largest peaks of runs that
    both complete, and which runs are not completed.
    """
    of_rubber = untested_bearings(case, STIFFNESS[0])
    if band is None:
        return f"Have {joined(of_rubber)} tested, or ask the maker for G." if of_rubber else ""
    effects = [_early_clause(band, end) for end in band.early]
    for comparison in band.comparisons:
        if changes := _changes(comparison):
            ends = " to ".join(f"{stress:g}" for stress in comparison.stresses)
            several = len(comparison.stresses) > 1
            cause = "yield stresses" if several else "a yield stress"
            cause += f" of lead of {ends} MPa {'change' if several else 'changes'} the largest"
            effects.append(f"{cause} {joined(changes)}{_scope(band, comparison)}")
    names = dict.fromkeys([*of_rubber, *band.names])
    values = "G and Q_d" if of_rubber else "Q_d"
    consequences = f": {'; '.join(effects)}" if effects else ""
    return plain(f"Have {joined(names)} tested, or ask the maker for {values}{consequences}.")


def _changes(comparison: Comparison) -> list[str]:
    """Return by how much strengths of lead change the largest peaks."""
    changes = []
    for column, peaks in comparison.peaks.items():
        low, high = (100.0 * (value / peaks[0] - 1.0) for value in (min(peaks), max(peaks)))
        if np.isfinite(low) and np.isfinite(high):
            changes.append(f"{OF_STRENGTH[column][0]} by {low:+.0f} to {high:+.0f} %")
    return changes
