"""Links in place of bearings: the same bridge, motions and temperatures with bilinear loops.

A link has stiffness and damping of one cycle at one displacement, at one temperature. How far an
analysis with links is from the coupled one depends on the bridge and its motions, so that it is
computed for each set of links that `links.txt` states. Both are repeated at half the step until
their peaks settle (properties/peaks.py).
"""

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.earthquake.case import (
    EarthquakeCase,
    OnLine,
    list_bearing_tables,
    make_earthquake_case,
)
from thermobearing.earthquake.properties.lines import design_peak, load_device
from thermobearing.earthquake.properties.notes import BOUND_SLACK, is_lower, is_upper
from thermobearing.earthquake.properties.peaks import (
    MOST_STEPS_OF_LINKS,
    PEAKS,
    Settled,
    design_peaks,
    line_peaks,
    settle_case,
)
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.earlier import REFERENCE
from thermobearing.quantities.governing import place_of_largest, place_of_least
from thermobearing.quantities.words import degrees, joined
from thermobearing.quantities.words import number as number_text
from thermobearing.results.base import COMPLETED

SHORTFALL = 0.05  # of a peak, from which on links are said to be unsafe
RIGID = 1e7  # kN, largest strength of a bilinear bearing: a line that does not move stays elastic
AXIAL = "links have no axial force that acts on the shear force"
BILINEAR_MODEL = "the analysis is of bilinear bearings itself"
IN_PLAN = "the structure moves in two directions"
NO_LOOP = "a line has no yield at its design displacement"


class Trials(NamedTuple):
    """Peaks with links and of the coupled analysis, and what was run for them."""

    rows: "pd.DataFrame"
    runs: int  # with links
    reasons: list[str]  # why sets of links, or all of them, were not run
    coupled_runs: int = 0  # at smaller steps
    left_out: tuple[str, ...] = ()  # runs that links or the coupled analysis did not complete


def trial_columns(peak_name: str, unit: str) -> tuple[str, str, str]:
    """Return the columns of a peak: with links, of the coupled analysis, and their ratio."""
    return f"{peak_name}_links_{unit}", f"{peak_name}_coupled_{unit}", f"{peak_name}_ratio"


def try_links(analyses: Mapping[str, Settled], lines: "pd.DataFrame") -> Trials:
    """Run a bridge with the links of its lines in place of its bearings.

    Parameters
    ----------
    analyses : coupled analyses of the bridge by `state` of their rubber.
    lines : the properties of `line_properties` of these analyses.

    Returns
    -------
    Trials
        A row for each bearing of the analysis, line, state of the rubber and ambient temperature,
        and another (`lead` is "heated") with the lead of the lower values at its highest
        temperature: largest displacement [mm], force of one bearing [kN] and moment of its pier
        [kN m], the mean over motions where there are as many as a design displacement needs for it.
        `..._ratio` is that with links over that of the coupled analysis. Both are at the smallest
        step at which they were repeated (`links_step_s`, `coupled_step_s`), after `links_halvings`
        and `coupled_halvings`; `links_change` and `coupled_change` are by how much the last two
        halvings, or the only one, moved a peak of the analysis at most.
    """
    frames, reasons, runs = [], [], 0
    left_out = dict[str, None]()
    for state, group in lines.groupby("state", sort=False):
        coupled = analyses[str(state)]
        table = tomllib.loads(str(coupled.first.dataset.attrs["case"]))
        if (reason := IN_PLAN if coupled.first.directions else _refusal(table)) is not None:
            reasons.append(reason)
            continue
        case = make_earthquake_case(table, "result")
        devices = {str(item["name"]): load_device(item) for item in list_bearing_tables(table)}
        thickness = {name: device.total_rubber_thickness for name, device in devices.items()}
        # Links of bilinear bearings alone are these bearings.
        layered = group.groupby(["bearing", "ambient_degC"])["rubber"].transform("max") != ""
        for heated, rows in _sets_of_links(group[layered]):
            try:
                linked = _settle_links(_with_links(case, rows, thickness, heated=heated), rows)
            except InputError as error:
                reasons.append(error.problems[0])
                continue
            runs += linked.first.runs + linked.runs
            frames.append(_compared(coupled, linked, rows, heated=heated))
            left_out |= dict.fromkeys(_incomplete(coupled, linked, rows))
    compared = pd.concat(frames, ignore_index=True) if frames else pd.DataFrame()
    coupled_runs = sum(analysis.runs for analysis in analyses.values()) if frames else 0
    return Trials(compared, runs, list(dict.fromkeys(reasons)), coupled_runs, tuple(left_out))


def _incomplete(coupled: Settled, linked: Settled, rows: "pd.DataFrame") -> Iterator[str]:
    """Yield the runs of a set of links, in words, that it or the coupled analysis do not complete.

    Their motions are left out of the peaks of both (`_compared`).
    """
    first = rows.iloc[0]
    for analysis, words in ((linked, "with links"), (coupled, "coupled")):
        table = analysis.result.table
        chosen = (table["outcome"] != COMPLETED) & (table["ambient_degC"] == first["ambient_degC"])
        if analysis is coupled:
            chosen &= table["bearing"] == first["bearing"]
        for run in table[chosen].to_dict("records"):
            place = f"{run['motion']} at {degrees([run['ambient_degC']])}"
            state = f" and {first['rubber']} rubber" if first["rubber"] else ""
            yield f"{place}{state}, {words} ({run['outcome'].replace('_', ' ')})"


def _settle_links(case: EarthquakeCase, rows: "pd.DataFrame") -> Settled:
    """Return the analysis with the links of some lines at the step at which their peaks settle."""

    def _peaks_of_links(result: EarthquakeResult) -> "pd.DataFrame":
        peaks = design_peaks(result)
        return peaks[peaks.index.get_level_values("line").isin(rows["line"])]

    return settle_case(case, run_earthquake(case), _peaks_of_links, MOST_STEPS_OF_LINKS)


def shortfall_note(rows: "pd.DataFrame") -> str:
    """Return by how much links understate peaks of the coupled analysis, as a sentence; else empty.

    `rows` are those of one line, or of all lines of a set of links. Of each peak that is more than
    5 % too small the line counts where it is smallest.
    """
    phrases = []
    for peak_name, unit in PEAKS.values():
        names = trial_columns(peak_name, unit)
        short = rows[rows[names[-1]] < 1.0 - SHORTFALL]
        if short.empty:
            continue
        row = short.iloc[place_of_least(short[names[-1]])]
        with_links, coupled, ratio = (row[name] for name in names)
        phrases.append(
            f"{100.0 * (1.0 - ratio):.0f} % less {peak_name.replace('_', ' ')} than the "
            f"coupled analysis ({row['line']}: {number_text(with_links)} instead of "
            f"{number_text(coupled)} {unit.replace('_', ' ')}; multiply it by {1.0 / ratio:.2f})"
        )
    if not phrases:
        return ""
    other = "or take the values of the coupled analysis"
    return f"In this bridge these links give {joined(phrases)}, {other}."


def upper_note(rows: "pd.DataFrame") -> str:
    """Return which forces links of upper values do not make largest, as a sentence; else empty.

    Of each peak the line counts where other links exceed those of upper values most.
    """
    phrases = []
    for peak_name, unit in PEAKS.values():
        name = trial_columns(peak_name, unit)[0]
        excesses = []
        for _, group in rows[rows[name].notna()].groupby(["bearing", "line"], sort=False):
            upper = group[[is_upper(row) for row in group.to_dict("records")]]
            largest = group.iloc[place_of_largest(group[name])]
            if len(upper) and unit != "mm" and largest[name] > BOUND_SLACK * upper[name].max():
                excesses.append((float(upper[name].max()), largest))
        if excesses:
            value, row = excesses[place_of_largest([row[name] / value for value, row in excesses])]
            rubber = f"{row['rubber']} rubber".strip() + ", lead heated" * bool(row["lead"])
            phrases.append(
                f"{peak_name.replace('_', ' ')} ({row['line']}: {number_text(value)} "
                f"{unit.replace('_', ' ')}, with links of {rubber} at {row['ambient_degC']:g} degC "
                f"{number_text(row[name])} {unit.replace('_', ' ')})"
            )
    if not phrases:
        return ""
    return (
        f"Links of upper values do not give the largest {joined(phrases)}: take the largest peaks "
        "of all links."
    )


def _refusal(table: Mapping[str, Any]) -> str | None:
    """Return why a resolved case cannot have links; None if it can."""
    analysis = table["analysis"]
    if analysis.get("axial", "off") != "off":
        return AXIAL
    return None if analysis.get("model", REFERENCE) == REFERENCE else BILINEAR_MODEL


def _sets_of_links(lines: "pd.DataFrame") -> Iterator[tuple[bool, "pd.DataFrame"]]:
    """Yield the links of one bridge at one temperature, and whether their lead is heated."""
    for _, rows in lines.groupby(["bearing", "ambient_degC"], sort=False):
        yield False, rows
        if rows["lead_degC"].notna().any() and any(map(is_lower, rows.to_dict("records"))):
            yield True, rows


def _with_links(
    case: EarthquakeCase, rows: "pd.DataFrame", thickness: Mapping[str, float], *, heated: bool
) -> EarthquakeCase:
    """Return a case with the links of a set in place of its bearings; InputError if it cannot be.

    Lines that have no link, since they do not move, keep the stiffness that the structure states.
    """
    links = {
        str(row["line"]): _link(row, number, thickness[row["line_bearing"]], heated=heated)
        for number, row in enumerate(rows.to_dict("records"), 1)
    }
    for place, line in enumerate(case.structure.bearings, 1):
        if line.name not in links:
            links[line.name] = BilinearBearing(
                name=f"unmoved-{place}",
                total_rubber_thickness=max(thickness.values()),
                strength=RIGID,
                initial_stiffness=line.equivalent_stiffness,
                post_yield_stiffness=0.5 * line.equivalent_stiffness,
            )
    first, *others = links
    # Links have neither temperature nor rubber.
    analysis = case.analysis.model_copy(update={"state": None, "exposure": None})
    linked = case.model_copy(
        update={
            "bearings": [links[first]],
            "lines": tuple(OnLine(line=name, bearing=links[name]) for name in others),
            "ambient": [float(rows["ambient_degC"].iloc[0])],
            "weather": None,
            "initial_state": None,
            "rig": None,
            "limits": None,
            "codes": None,
            "rotation": None,
            "zone": None,
            "axial_force": None,
            "bands": None,
            "sources": None,
            "analysis": analysis,
        }
    )
    if faults := linked.faults():
        raise InputError(faults, "links")
    return linked


def _link(
    row: Mapping[Any, Any], number: int, thickness: float, *, heated: bool
) -> BilinearBearing:
    """Return the bilinear loop of a line; InputError where it has none."""
    strength = row["Q_d_kN"]
    if heated and not np.isnan(row["Q_d_heated_kN"]):
        strength = row["Q_d_heated_kN"]
    if np.isnan(row["K_1_kN_mm"]):
        raise InputError(f"{NO_LOOP} ({row['line']}, {row['line_bearing']})", "links")
    return BilinearBearing(
        name=f"link-{number}",
        total_rubber_thickness=thickness,
        strength=strength,
        initial_stiffness=row["K_1_kN_mm"],
        post_yield_stiffness=row["K_d_kN_mm"],
    )


def _compared(
    coupled: Settled, linked: Settled, rows: "pd.DataFrame", *, heated: bool
) -> "pd.DataFrame":
    """Return the design peaks of a set of links, and those of the coupled analysis."""
    moved, moved_with_links = line_peaks(coupled.result), line_peaks(linked.result)
    steps = {
        "links_step_s": linked.step,
        "links_halvings": linked.halvings,
        "links_change": linked.change,
        "coupled_step_s": coupled.step,
        "coupled_halvings": coupled.halvings,
        "coupled_change": coupled.change,
    }
    compared = []
    for row in rows.to_dict("records"):
        keys = ["bearing", "line", "line_bearing", "state", "rubber", "ambient_degC", "bound"]
        peaks: dict[str, Any] = {key: row[key] for key in keys}
        peaks["lead"] = "heated" if heated else ""
        chosen = (moved["bearing"] == row["bearing"]) & (
            moved["ambient_degC"] == row["ambient_degC"]
        )
        of_line = moved[chosen & (moved["line"] == row["line"])].set_index("motion")
        with_links = moved_with_links[moved_with_links["line"] == row["line"]].set_index("motion")
        motions = [motion for motion in of_line.index if motion in with_links.index]
        for column, name in PEAKS.items():
            values = [
                design_peak(table.loc[motions, column].to_numpy(dtype=float)) if motions else np.nan
                for table in (with_links, of_line)
            ]
            ratio = values[0] / values[1] if values[1] else np.nan
            peaks |= dict(zip(trial_columns(*name), (*values, ratio), strict=True))
        compared.append(peaks | steps)
    return pd.DataFrame(compared)
