"""Equivalent properties of bearing lines and bridges in reports: tables, notes and files."""

from typing import Any, Final

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.earthquake.properties.bridge import (
    bridge_properties,
    damping_factor,
    hysteretic_ratios,
    periods_table,
    structure_devices,
)
from thermobearing.earthquake.properties.lines import line_properties
from thermobearing.earthquake.properties.links import link_text, trials_note
from thermobearing.earthquake.properties.notes import (
    FIRST,
    OTHER_DISPLACEMENTS,
    SCRAGGED,
    assumed_in_file,
    beyond_note,
    bounded_note,
    cold_lead_note,
    cycle_note,
    elastic_note,
    excess_note,
    heated_lead_note,
    initial_stiffness_note,
    is_elastic,
    is_extrapolated,
    left_out_note,
    loop_name,
    place_names,
    untested_note,
    with_bounds,
)
from thermobearing.earthquake.properties.peaks import PEAKS, Settled
from thermobearing.earthquake.properties.trials import (
    Trials,
    shortfall_note,
    trial_columns,
    try_links,
)
from thermobearing.earthquake.properties.written import with_own_bearing
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import (
    joined,
    plain,
)
from thermobearing.report import content
from thermobearing.results.directory import LINK_TRIALS, LINKS, MODES_FILE, PROPERTIES
from thermobearing.results.ranges import MARKED

DAMPING_RATIOS = ("bearing_damping_ratio", "effective_damping_ratio")
ELASTIC = "Not all bearings yield"
COLD_LEAD = "The strength of cold lead is extrapolated"
HEATED = "Lead is warmer in the runs"
SHOWN_MODES = 10  # of a report; a file has them all
RESERVATIONS: Final = (  # begin of a sentence, and what describes a row in it
    (MARKED, (untested_note, beyond_note, excess_note)),
    (COLD_LEAD, (cold_lead_note,)),
    (HEATED, (heated_lead_note,)),
)


def property_tables(
    settled: Settled, other: Settled | None = None
) -> tuple[dict[str, Table], dict[str, bytes]]:
    """Return the equivalent properties of lines and bridge as tables, and as files.

    `settled` is the analysis, `other` are runs with rubber in the other state (`run_other_bound`),
    whose properties at the coldest temperature (of scragged rubber the warmest) are given too.
    """
    result = settled.first
    analysed = line_properties(result)
    if not len(analysed):
        return {}, {}
    analyses = {str(analysed["state"].iloc[0]): settled}
    parts = [(analysed, bridge_properties(result, analysed))]
    if other is not None and len(of_other := _outermost(line_properties(other.first), analysed)):
        analyses[str(of_other["state"].iloc[0])] = other
        parts.append((of_other, bridge_properties(other.first, of_other)))
    lines = with_bounds(pd.concat([part[0] for part in parts], ignore_index=True))
    bridges = pd.concat([part[1] for part in parts], ignore_index=True)
    trials = try_links(analyses, lines)
    written = lines.drop(
        columns=[
            "kind",
            "excess",
            "has_lead",
            "law",
            "beyond_tests",
            "cold_lead",
            "secant_kN_mm",
            "secant_of",
            "state",
        ]
    )
    files = {
        PROPERTIES: with_own_bearing(written).to_csv(index=False).encode(),
        LINKS: link_text(lines, bridges, structure_devices(result), trials).encode(),
    }
    tables = {"properties": _lines_table(lines)}
    if len(trials.rows):
        tried = trials.rows.drop(columns="state")
        files[LINK_TRIALS] = with_own_bearing(tried).to_csv(index=False).encode()
        tables["link_trials"] = _trials_table(trials)
    tables["bridge_properties"] = _bridge_table(bridges)
    periods, frame = periods_table(
        result, hysteretic_ratios(result, analysed), mode_limit=SHOWN_MODES, lines=analysed
    )
    if len(frame) > SHOWN_MODES:
        files[MODES_FILE] = frame.to_csv(index=False).encode()
    return tables | {"periods": periods}, files


def _outermost(lines: "pd.DataFrame", analysed: "pd.DataFrame") -> "pd.DataFrame":
    """Return lines in the other state at the temperature where they bound the analysed ones."""
    if not len(lines):
        return lines
    ambients = analysed["ambient_degC"]
    scragged = (lines["state"] == SCRAGGED).all()
    outermost = float(ambients.max() if scragged else ambients.min())
    return lines.loc[lines["ambient_degC"] == outermost]


def _trials_table(trials: Trials) -> Table:
    """Return peaks of the bridge with links in place of bearings, and of the coupled analysis."""
    rows = trials.rows
    lines = rows.to_dict("records")
    several = rows["ambient_degC"].nunique() > 1
    shown = {
        "values": [
            (row["bound"] or "no bound") + ", lead heated" * bool(row["lead"]) for row in lines
        ]
    }
    keys = ["bearing"] if rows["bearing"].nunique() > 1 else []
    keys += ["line"] + ["line_bearing"] * bool((rows["line_bearing"] != rows["bearing"]).any())
    keys += ["rubber", "ambient_degC", "values"]
    columns: list[str | Quantity] = list(keys)
    for peak_name, unit in PEAKS.values():
        names = trial_columns(peak_name, unit)
        shown[peak_name] = [_quotient(*(row[name] for name in names)) for row in lines]
        head = peak_name.replace("_", " ").capitalize()
        columns.append(Quantity(head, unit.replace("_", " "), name=peak_name))
    sentences = [trials_note(trials)]
    for key, group in rows.groupby(["bearing", "state", "ambient_degC", "lead"], sort=False):
        if note := shortfall_note(group):
            named = rows["bearing"].nunique() > 1  # else a sentence begins with the rubber
            head = f"{key[0]}, {key[1]} rubber" if named else f"{str(key[1]).capitalize()} rubber"
            head += f" at {key[2]:g} °C" * several + ", lead heated" * bool(key[3])
            sentences.append(f"{head}: {note[:1].lower()}{note[1:]}")
    table = make_table(
        rows.assign(**shown),
        columns,
        "The bridge with links in place of its bearings: with links / coupled analysis = ratio",
        keys=len(keys),
        note=plain(" ".join(sentences)),
        keep_keys=True,
    )
    return table.merged("line")


def _quotient(with_links: float, coupled: float, ratio: float) -> str:
    """Return a peak with links over that of the coupled analysis; empty without one."""
    return f"{with_links:.0f}/{coupled:.0f} = {ratio:.2f}" if np.isfinite(ratio) else ""


def _lines_table(lines: "pd.DataFrame") -> Table:
    """Return the equivalent properties of one bearing of each line, with what they rest on."""
    caption = "Equivalent properties of one bearing of each line at its design displacement"
    note = (
        "Third cycle without heating at the ambient temperature, of the bearing as it was run "
        "(state of the rubber, exposure): upper values at the coldest, lower values at the "
        "warmest ambient temperature of this analysis, which need not be those of the site. "
        f"{OTHER_DISPLACEMENTS} Q_d, K_d and K_1 are those of the bilinear "
        "loop with the same peak force and energy."
    )
    states = lines.drop_duplicates(["line_bearing", "rubber", "ambient_degC"])
    if notes := [
        plain(f"{row['line_bearing']} at {row['ambient_degC']:g} °C: {cycle_note(row)}")
        for row in states.to_dict("records")
        if row["cycle"] == FIRST
    ]:
        note = f"{note} Upper values of virgin rubber are of another cycle ({'; '.join(notes)})."
    # links.txt has the numbers of K_0, which would hide what the note says of the table.
    of_stiffness = plain(initial_stiffness_note(lines, with_numbers=False))
    bounded = plain(bounded_note(lines, "°C"))
    note = " ".join(
        [note, bounded, of_stiffness, plain(left_out_note(lines)), *_reservations(lines)]
    )
    several_states = lines["state"].nunique() > 1
    several = lines["bearing"].nunique() > 1
    keys = ["bearing", "line"] if several else ["line"]
    if (lines["line_bearing"] != lines["bearing"]).any():
        keys.append("line_bearing")
    keys += ["count", "rubber", "ambient_degC"] if several_states else ["count", "ambient_degC"]
    values = ["design_displacement_mm", "K_eff_kN_mm", "h_eff"]
    values += ["Q_d_kN", "K_d_kN_mm", "K_1_kN_mm", "K_v_kN_mm"]
    # The vertical stiffness is that of scragged rubber at its reference temperature or warmer.
    extrapolated = [is_extrapolated(row) for row in lines.to_dict("records")]
    marked = dict.fromkeys([name for name in values[1:] if name != "K_v_kN_mm"], extrapolated)
    options: dict[str, Any] = {"keys": len(keys), "note": note, "keep_keys": True}
    if any(is_elastic(row) for row in lines.to_dict("records")):
        values.insert(1, "loop")  # without a mark
    table = make_table(
        lines.assign(loop=[loop_name(row) for row in lines.to_dict("records")]),
        [*keys, *values],
        caption,
        marked=marked,
        **options,
    )
    return table.merged("line")


def _bridge_table(bridges: "pd.DataFrame") -> Table:
    """Return effective period and damping of the bridge, by ambient temperature."""
    factor = damping_factor()
    source = (
        "First mode with K_eff of all bearings at their design displacement. The damping of "
        "bearings is the energy of all their loops over 2π Σ K_eff D²; the effective damping, that "
        "of B_L, is their damping times their share in the strain energy of this mode: other parts "
        "of the structure store the rest. Their masses count, which the static rule of codes "
        "with D + D_sub neglects. Damping of the structure is not in it. "
    )
    source += f"B_L{'*' if factor.unverified else ''}: {factor.source}."
    if factor.unverified:
        source += " *: not checked against the published text."
    several = bridges["bearing"].nunique() > 1
    bridge_keys = ["bearing"] * several + ["state"] * (bridges["state"].nunique() > 1)
    bridge_keys.append("ambient_degC")
    return make_table(
        bridges,
        [*bridge_keys, "effective_period_s", *DAMPING_RATIOS, "B_L"],
        "Effective period and damping of the bridge",
        keys=len(bridge_keys),
        note=source,
        keep_keys=True,
        heads={"state": "Rubber"},
    )


def _reservations(lines: "pd.DataFrame") -> list[str]:
    """Return what equivalent properties rest on besides tests of the bearing, as sentences."""
    rows = lines.to_dict("records")
    if elastic := [
        plain(f"{row['line']} ({row['line_bearing']}) at {row['ambient_degC']:g} °C: {text}")
        for row in rows
        if (text := elastic_note(row))
    ]:
        elastic = [f"{ELASTIC} ({'; '.join(elastic)})."]
    rows_of_states = lines.drop_duplicates(["line_bearing", "rubber", "ambient_degC"])
    rows = rows_of_states.to_dict("records")
    names = place_names(rows_of_states, "°C")
    sentences = []
    for begins, describes in RESERVATIONS:
        names_by_text: dict[str, list[str]] = {}
        for name, row in zip(names, rows, strict=True):
            for text in filter(None, (describe(row) for describe in describes)):
                names_by_text.setdefault(text, []).append(name)
        texts = [f"{joined(group)}: {text}" for text, group in names_by_text.items()]
        if texts:
            sentences.append(f"{begins} ({'; '.join(texts)}).")
    keys: dict[str, list[str]] = {}
    for row in rows:
        keys.setdefault(row["line_bearing"], []).extend(assumed_in_file(row))
    if parts := [
        f"{name} ({joined(content.key_words(key) for key in dict.fromkeys(chosen))})"
        for name, chosen in keys.items()
        if chosen
    ]:
        sentences.append(f"Not measured, but assumed, borrowed or chosen: {'; '.join(parts)}.")
    return elastic + [plain(sentence) for sentence in sentences]
