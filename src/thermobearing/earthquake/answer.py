"""Main results of an analysis of earthquakes in sentences, as a report begins."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from thermobearing import reported
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.scaling import rubber_modulus
from thermobearing.bearing.sources import STIFFNESS, STRENGTH, assumed_clause
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.units import parse_quantity
from thermobearing.earthquake.analysis import (
    DUCTILITY,
    FORCE,
    STRAIN,
    OtherBound,
    run_other_bound,
)
from thermobearing.earthquake.case import list_bearing_tables
from thermobearing.earthquake.measures import cold_ratios, key_columns, ratio_of_means
from thermobearing.earthquake.properties.lines import few_motions_note, motions_for_mean
from thermobearing.earthquake.properties.notes import bearing_sources, temperature_note
from thermobearing.earthquake.properties.strength import StrengthBand, strength_sentence
from thermobearing.earthquake.properties.written import place_in_words
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.outcomes import INTERRUPTED, MELTED
from thermobearing.quantities.governing import SLACK_KELVIN, place_of_largest
from thermobearing.quantities.validity import has_invalid, stable_rows
from thermobearing.quantities.words import (
    change,
    counted,
    degrees,
    joined,
    number,
    part_label,
    percent,
    plain,
    quantity,
    tidy,
)
from thermobearing.reported import limit_name
from thermobearing.results.base import COMPLETED
from thermobearing.results.writing import from_attribute

UNMEASURED = "Forces and displacements rest on numbers that were not measured: {phrases}."
# Words of the numbers that forces rest on, by the keys of their sources.
NOT_MEASURED = {
    STIFFNESS[0]: "shear modulus of the rubber G",
    STRENGTH[0]: "yield stress of lead σ_Y",
}


def main_results(
    result: EarthquakeResult,
    bound: OtherBound | str | None = None,
    strengths: StrengthBand | None = None,
) -> list[str]:
    """Return the effect of the cold, whether piers yield, and what governs; an early end first.

    `bound` are the runs with rubber in the other state (`find_other_bound`), `strengths` those with
    other strengths of lead that was never tested.
    """
    if not result.runs:
        return [f"No run was completed ({result.outcome}): {tidy(result.sentence)}"]
    cold = _cold(result)
    note = _temperature_note(result)
    count_note = few_motions(result, few_motions_note)
    answer = [*_early_end_sentences(result), count_note, cold, note]
    answer += [_yielding(result), _governing(result)]
    if not cold:
        answer.append(_heating(result))
    if bound is not None:
        answer.append(bound if isinstance(bound, str) else _other_bound(result, bound))
    unmeasured = strength_note(tomllib.loads(str(result.dataset.attrs["case"])))
    answer.append(f"{unmeasured} {strength_sentence(strengths)}" if strengths else unmeasured)
    return [sentence for sentence in answer if sentence]


def few_motions(result: EarthquakeResult, words: Callable[[int], str]) -> str:
    """Return the words on the number of motions of a bridge; empty of a hybrid test."""
    if result.dataset.attrs["command"] != "bridge" or not result.runs:
        return ""
    return words(int(result.table["motion"].nunique()))


def find_other_bound(result: EarthquakeResult) -> OtherBound | str | None:
    """Return the runs with rubber in the other state (`run_other_bound`), or why there are none."""
    try:
        return run_other_bound(result) if result.runs else None
    except InputError as error:  # such as a record that is not there any more
        return f"The other state of the rubber was not computed: {tidy(error.problems[0])}"


def strength_note(case: Mapping[str, Any]) -> str:
    """Return which stiffnesses and strengths of bearings were not measured, with their values.

    Forces and displacements of all runs rest on them. Empty where those of all bearings were.
    """
    phrases = []
    for table in list_bearing_tables(case):
        sources = bearing_sources(case, table)
        values = [
            f"{NOT_MEASURED[key]} {quantity(value)} ({clause})"
            for key, value in _stated_values(table).items()
            if (clause := assumed_clause(sources.get(key, ""), to_end=True))
        ]
        if values:
            phrases.append(f"of {table['name']}, {joined(values)}")
    return plain(UNMEASURED.format(phrases="; ".join(phrases))) if phrases else ""


def _stated_values(table: Mapping[str, Any]) -> dict[str, str]:
    """Return modulus of rubber and strength of lead of a layered bearing, by their keys."""
    if table.get("kind") == "bilinear":
        return {}
    bearing = as_bearing(dict(table), str(table["name"]))
    values = {STIFFNESS[0]: f"{rubber_modulus(bearing):.3g} MPa"}
    if bearing.lead is not None:
        values[STRENGTH[0]] = f"{bearing.lead.yield_stress:.3g} MPa"
    return values


def _temperature_note(result: EarthquakeResult) -> str:
    """Return which coefficients were not measured, if a temperature is not that of their law."""
    case = tomllib.loads(str(result.dataset.attrs["case"]))
    references = [
        parse_quantity(str(table["hysteresis"]["reference_temperature"]), "degC")
        for table in list_bearing_tables(case)
        if table.get("kind") != "bilinear"
    ]
    ambients = result.table["ambient_degC"]
    differences = [abs(ambients - reference).max() for reference in references]
    return temperature_note(case) if max(differences, default=0.0) > SLACK_KELVIN else ""


def _early_end_sentences(result: EarthquakeResult) -> list[str]:
    """Return a sentence on each failure mode and on missing runs, those of melted lead first."""
    modes: dict[str, list[str]] = {}
    for name, outcome in zip(result.run_names, result["outcome"].values, strict=True):
        if outcome != COMPLETED:
            modes.setdefault(str(outcome), []).append(name)
    # The runs that an interruption left out are not in the dataset.
    if result.outcome == INTERRUPTED:
        modes.setdefault(INTERRUPTED, [])
    sentences = from_attribute(result.dataset, "sentences")
    return [
        reported.early_sentence(
            "The analysis",
            f" in {counted(len(names), 'run')}, first {plain(names[0])}" if names else "",
            outcome,
            str(sentences.get(outcome, "")),
        )
        for outcome, names in sorted(modes.items(), key=lambda mode: mode[0] != MELTED)
    ]


def largest_place(result: EarthquakeResult, column: str, part: str = "") -> tuple[float, str]:
    """Return the largest value of a column, and its run and line or pier in words.

    Runs that became unstable are left out where others remain; of them alone the words say so.
    """
    table = result.table
    stable = stable_rows(table)
    if not stable[column].notna().any():
        return float("nan"), ""
    place = int(stable.index[place_of_largest(stable[column])])
    note = ", unstable: no result" if has_invalid(stable) else ""
    return float(table[column].iloc[place]), f"{_place_in_words(result, place, part)}{note}"


NO_CAPACITY = "top and bottom no longer overlap"  # where a limit is zero


class Shown(NamedTuple):
    """A bearing line or pier that figures show, and why."""

    name: str
    reason: str
    bearing: str = ""  # where lines have several kinds

    def caption(self, part: str) -> str:
        """Return what a figure shows and why, as a sentence."""
        bearing, scope = "", ""
        if self.bearing:
            bearing, scope = f" ({self.bearing})", f" among the lines with {self.bearing}"
        return f"Shown: {part_label(part, self.name)}{bearing}, which {self.reason}{scope}."


def governing_lines(result: EarthquakeResult) -> list[Shown]:
    """Return the line of each kind of bearing that uses most of an engineering limit.

    Without a limit of its own checks, that with the largest shear strain. Lines whose bearings are
    the same in all analyses are of one kind; empty where there is one line.
    """
    if not result.has_parts or result.dataset.sizes["line"] < 2 or not result.runs:
        return []
    bearings = list(dict.fromkeys(str(name) for name in result["bearing"].values))
    kinds: dict[tuple[str, ...], list[str]] = {}
    for line in map(str, result["line"].values):
        kind = [result.line_bearings.get(name, {}).get(line, name) for name in bearings]
        kinds.setdefault(tuple(kind), []).append(line)
    shown = [_governing_line(result, lines) for lines in kinds.values()]
    if len(kinds) == 1:
        return shown
    return [
        line._replace(bearing=" or ".join(dict.fromkeys(kind)))
        for line, kind in zip(shown, kinds, strict=True)
    ]


def _governing_line(result: EarthquakeResult, lines: Sequence[str]) -> Shown:
    """Return which of some lines uses most of an engineering limit, or is strained most."""
    checks = result.bearing_checks
    if len(checks):
        checks = checks[checks["part"].isin(lines) & checks["limit"].notna()]
    if len(checks):
        check = checks.iloc[place_of_largest(checks["used"].astype(float))]
        name, used = limit_name(check.to_dict()), float(check["used"])
        share = percent(used) if np.isfinite(used) else NO_CAPACITY
        use = f"uses most of an engineering limit ({share}, {name})"
        return Shown(str(check["part"]), use)
    rows = result.resultant.lines
    rows = rows[rows["line"].isin(lines)]
    strains = rows["strain_max"].fillna(0.0)
    return Shown(str(rows["line"].iloc[place_of_largest(strains)]), "has the largest shear strain")


def governing_pier(result: EarthquakeResult) -> Shown | None:
    """Return the pier with the largest ductility, or displacement without a hinge."""
    piers = result.resultant.piers
    if not len(piers) or piers["pier"].nunique() < 2:
        return None
    for column, words in (("ductility", "ductility"), ("displacement_max_mm", "displacement")):
        if piers[column].notna().any():
            pier = piers["pier"].iloc[place_of_largest(piers[column].abs())]
            return Shown(str(pier), f"has the largest {words}")
    return None


def _place_in_words(result: EarthquakeResult, place: int, part: str) -> str:
    """Return the name of a run and of the line or pier that governs a peak of it."""
    table, run = result.table, result.run_names[place]
    if part not in table:
        return plain(run)
    bearing, name = (str(table[column].iloc[place]) for column in ("bearing", part))
    return plain(place_in_words(result.line_bearings, run, bearing, part, name))


def _governing(result: EarthquakeResult) -> str:
    """Return the largest strain, force and pier displacement, each with its run."""
    strain, strain_place = largest_place(result, "bearing_strain_max", "strain_line")
    force, force_place = largest_place(result, "bearing_force_max_kN", "force_line")
    article = "a" if len(result.piers) else "the"
    pier, pier_place = largest_place(result, "pier_displacement_max_mm", "displacement_pier")
    # The same place in words is the same run and the same line.
    force_source = force_place if force_place != strain_place else "the same run"
    phrases = [
        f"the largest shear strain is {percent(strain)} ({strain_place})",
        f"the largest force of one bearing {number(force)} kN ({force_source})",
    ]
    if not np.isnan(pier):  # a deck on the ground has no pier
        phrases.append(
            f"{article} pier top moves {number(pier)} mm relative to its base ({pier_place})"
        )
    stable = len(stable_rows(result.table))
    kind = "stable run" if stable < result.runs else "run"
    scope = f"Of {counted(stable, kind)}, " if result.runs > 1 else ""
    text = f"{scope}{joined(phrases)}."
    return f"{text[:1].upper()}{text[1:]}"


def _yielding(result: EarthquakeResult) -> str:
    """Return whether piers yield, and where most; empty without a hinge."""
    ductility, place = largest_place(result, "pier_ductility", "ductility_pier")
    if np.isnan(ductility):
        return ""
    if ductility <= 1.0:
        subject = "No pier yields" if len(result.piers) else "The pier does not yield"
        return f"{subject} (ductility {number(ductility)} at most, {place})."
    piers = result.piers
    names = ["the pier"]
    if len(piers):
        yielding = set(piers.loc[piers["ductility"] > 1.0, "pier"])
        in_order = dict.fromkeys(piers["pier"])  # of the structure, not of the runs
        names = [part_label("pier", str(name)) for name in in_order if name in yielding]
    verb = "yield" if len(names) > 1 else "yields"
    text = f"{joined(names)} {verb} (ductility {number(ductility)}, {place})."
    return f"{text[:1].upper()}{text[1:]}"


def _cold(result: EarthquakeResult) -> str:
    """Return the effect of the coldest temperature by bearing; empty where there is no cold."""
    ratios = cold_ratios(result)
    # Bilinear bearings are the same at all temperatures: their ratios of 1 would read as a result.
    bilinear_names = {
        str(n) for n in result["bearing"].values if result.dataset.attrs.get(f"bilinear:{n}")
    }
    if len(ratios):
        ratios = ratios[~ratios["bearing"].isin(bilinear_names)]
    if not len(ratios):
        return ""
    coldest, warmest = ratios["ambient_degC"].min(), result.table["ambient_degC"].max()
    cold = ratios[ratios["ambient_degC"] == coldest]
    motions = cold["motion"].nunique()
    groups = list(cold.groupby("bearing", sort=False))
    several = len(result.bearing_labels) > 1
    sentences: list[str] = []
    for name, group in groups:
        means = f" (means over {counted(motions, 'motion')})" if motions > 1 else ""
        start = f"At {degrees([coldest])}, compared with {degrees([warmest])}{means}, "
        if "line_bearing" in group and group["line_bearing"].nunique() > 1:
            changes = _cold_by_kind(group, motions > 1)
            subject = f"of the analysis with {name}, " if several else ""
        else:
            changes = joined(_cold_changes(group, motions > 1))
            subject = f"with {result.bearing_labels[str(name)]} " if several else ""
        sentences.append(f"{start}{subject}{changes}.")
    if bilinear_names:
        sentences.append(f"{joined(sorted(bilinear_names))} does not depend on temperature.")
    return " ".join(sentences)


def _cold_by_kind(group: "pd.DataFrame", several: bool) -> str:
    """Return clauses on force and strain of each kind of bearings, then on the pier."""
    clauses = [
        f"with {kind} {joined(_cold_changes(rows, several, PEAKS_OF_BEARINGS))}"
        for kind, rows in group.groupby("line_bearing", sort=False)
    ]
    # All kinds of a run have the same piers.
    runs = group.drop_duplicates(key_columns(group))
    clauses += _cold_changes(runs, several, PEAK_OF_PIER)
    return "; ".join(clauses)


PEAKS_OF_BEARINGS = {FORCE: "bearing force", STRAIN: "shear strain"}
PEAK_OF_PIER = {"pier_displacement_max_mm": "displacement of the pier top"}


def _cold_changes(
    group: "pd.DataFrame", several: bool, peaks: Mapping[str, str] | None = None
) -> list[str]:
    """Return clauses on peaks in the cold, of means over motions; of bearings and pier by default.

    `peaks` are the words of each column.
    """
    mean = "mean " if several else ""
    clauses: list[str] = []
    for column, peak_name in (peaks or PEAKS_OF_BEARINGS | PEAK_OF_PIER).items():
        if not group[column].notna().any():
            continue
        verb = "" if clauses else " is"  # one verb for all clauses
        size = _size(ratio_of_means(group, column))
        clauses.append(f"the {mean}{peak_name}{verb} {size}{_range_of_motions(group, column)}")
    return clauses


def _size(ratio: float) -> str:
    return change(ratio, "larger", "smaller").replace("as much", "as large")


def _range_of_motions(group: "pd.DataFrame", column: str) -> str:
    """Return the smallest and largest change of the motions; empty where a mean of them counts."""
    by_motion = group.groupby("motion", sort=False)[column].mean().dropna()
    if not 1 < len(by_motion) < motions_for_mean():
        return ""
    low, high = (_size(float(ratio)) for ratio in (by_motion.min(), by_motion.max()))
    if low == high:
        return ""
    for direction in (" % larger", " % smaller"):
        if low.endswith(direction) and high.endswith(direction):
            ends = sorted((text.removesuffix(direction) for text in (low, high)), key=float)
            return f" (single motions: {' to '.join(ends)}{direction})"
    return f" (single motions: {low} to {high})"


OTHER_PEAKS = {  # of the other state of the rubber: words, factor, unit and column of the place
    FORCE: ("the largest force of one bearing", 1.0, "kN", "force_line"),
    STRAIN: ("the largest shear strain", 100.0, "%", "strain_line"),
    DUCTILITY: ("the pier ductility", 1.0, "", "ductility_pier"),
}


def _other_bound(result: EarthquakeResult, bound: OtherBound) -> str:
    """Return the largest peaks with rubber in the state of the other bound, as a sentence."""
    phrases = []
    for peak in bound.peaks:
        peak_name, factor, unit, part = OTHER_PEAKS[peak.column]
        before, after = (
            number(factor * float(table[peak.column][place]))
            for table, place in (
                (result.table, peak.place),
                (bound.result.table, peak.other_place),
            )
        )
        place = _place_in_words(result, peak.place, part)
        other_place = _place_in_words(bound.result, peak.other_place, part)
        outcome = str(bound.result.table["outcome"][peak.other_place])
        ending = "" if outcome == COMPLETED else f", {outcome.replace('_', ' ')}"
        source = "" if place == other_place else f" ({place})"
        after_with_unit = f"{after} {unit}".strip()
        phrases.append(
            f"{peak_name} is {after_with_unit} ({other_place}{ending}) instead of {before}{source}"
        )
    if not phrases:
        return ""
    unknown = ", whose scragging is assumed," if bound.assumed else ""
    changes = f"{joined(phrases)}; {_other_runs(bound.result)}{_ended_clause(bound.result)}."
    return f"With {bound.state.rubber} rubber{unknown} {changes}"


def _ended_clause(other: EarthquakeResult) -> str:
    """Return how many runs have another outcome than completed, whose peaks are those until then.

    With a comma before it; empty where all are complete.
    """
    ended = [str(text) for text in other.table["outcome"] if text != COMPLETED]
    if not ended:
        return ""
    kinds = joined(text.replace("_", " ") for text in dict.fromkeys(ended))
    return f", of which {len(ended)} did not complete ({kinds}; the peaks are those until then)"


def _other_runs(other: EarthquakeResult) -> str:
    """Return how many more runs of an analysis were made, and of what."""
    motions = other.table["motion"].nunique()
    motion_words = "all motions" if motions > 1 else "the motion"
    ambients = list(dict.fromkeys(other.table["ambient_degC"]))
    return (
        f"{counted(other.runs, 'more run')} of the analysis, {motion_words} at {degrees(ambients)}"
    )


def _heating(result: EarthquakeResult) -> str:
    """Return the largest rises of rubber and lead, each with its run and line, as a sentence."""
    rises_by_material: dict[str, list[tuple[float, str]]] = {"rubber": [], "lead": []}
    for run, name in enumerate(result.run_names):
        for layer, rise in result.rises(run).items():
            rises_by_material["lead" if layer == "lead" else "rubber"].append((rise, name))
    if result.has_parts:
        lines = result.lines
        names = np.repeat(result.run_names, len(lines) // result.runs)
        places = [
            place_in_words(result.line_bearings, str(run), str(bearing), "line", str(line))
            for run, bearing, line in zip(names, lines["bearing"], lines["line"], strict=True)
        ]
        # Other lines may be warmer than the one whose layers are kept.
        rises_by_material = {
            material: list(zip(lines[f"{material}_rise_K"], places, strict=True))
            for material in rises_by_material
        }
    warmed = []
    for material, rises in rises_by_material.items():
        if finite := [(rise, place) for rise, place in rises if np.isfinite(rise)]:
            rise, place = max(finite)
            warmed.append(f"the {material} by up to {rise:.1f} K ({plain(place)})")
    if not warmed:
        return "The bearings are bilinear and do not depend on temperature."
    return f"The motions warm {joined(warmed)}."
