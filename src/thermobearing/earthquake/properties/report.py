"""Equivalent properties of bearing lines and bridges in reports: tables, notes and files."""

from typing import Any, Final

from thermobearing.border.lazy import pd
from thermobearing.earthquake.measures import with_own_bearing
from thermobearing.earthquake.properties.bridge import (
    bridge_properties,
    damping_factor,
    hysteretic_ratios,
    periods_table,
    structure_devices,
)
from thermobearing.earthquake.properties.lines import line_properties
from thermobearing.earthquake.properties.links import link_text
from thermobearing.earthquake.properties.notes import (
    FIRST,
    OTHER_DISPLACEMENTS,
    assumed_in_file,
    beyond_note,
    cold_lead_note,
    cycle_note,
    elastic_note,
    excess_note,
    heated_lead_note,
    initial_stiffness_note,
    is_elastic,
    is_extrapolated,
    loop_name,
)
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import (
    joined,
    plain,
)
from thermobearing.report import content
from thermobearing.results.directory import LINKS, MODES_FILE, PROPERTIES
from thermobearing.results.ranges import MARKED

DAMPING_RATIOS = ("bearing_damping_ratio", "effective_damping_ratio")
ELASTIC = "Not all bearings yield"
COLD_LEAD = "The strength of cold lead is extrapolated"
HEATED = "Lead is warmer in the runs"
SHOWN_MODES = 10  # of a report; a file has them all
RESERVATIONS: Final = (  # begin of a sentence, and what describes a row in it
    (MARKED, (beyond_note, excess_note)),
    (COLD_LEAD, (cold_lead_note,)),
    (HEATED, (heated_lead_note,)),
)


def property_tables(result: EarthquakeResult) -> tuple[dict[str, Table], dict[str, bytes]]:
    """Return the equivalent properties of lines and bridge as tables, and as files."""
    lines = line_properties(result)
    if not len(lines):
        return {}, {}
    bridges = bridge_properties(result, lines)
    written = lines.drop(
        columns=["kind", "excess", "law", "cold_lead", "secant_kN_mm", "secant_of"]
    )
    files = {
        PROPERTIES: with_own_bearing(written).to_csv(index=False).encode(),
        LINKS: link_text(lines, bridges, structure_devices(result)).encode(),
    }
    tables = {"properties": _lines_table(lines), "bridge_properties": _bridge_table(bridges)}
    periods, frame = periods_table(
        result, hysteretic_ratios(result, lines), mode_limit=SHOWN_MODES, lines=lines
    )
    if len(frame) > SHOWN_MODES:
        files[MODES_FILE] = frame.to_csv(index=False).encode()
    return tables | {"periods": periods}, files


def _lines_table(lines: "pd.DataFrame") -> Table:
    """Return the equivalent properties of one bearing of each line, with what they rest on."""
    caption = "Equivalent properties of one bearing of each line at its design displacement"
    note = (
        "Third cycle without heating at the ambient temperature, of the bearing as it was run "
        "(state of the rubber, exposure): upper values at the coldest, lower values at the "
        f"warmest. {OTHER_DISPLACEMENTS} Q_d, K_d and K_1 are those of the bilinear loop with the "
        "same peak force and energy."
    )
    states = lines.drop_duplicates(["line_bearing", "rubber", "ambient_degC"])
    if notes := [
        plain(f"{row['line_bearing']} at {row['ambient_degC']:g} °C: {cycle_note(row)}")
        for row in states.to_dict("records")
        if row["cycle"] == FIRST
    ]:
        note = f"{note} The upper values are those of the first cycle ({'; '.join(notes)})."
    note = " ".join([note, plain(initial_stiffness_note(lines)), *_reservations(lines)])
    several = lines["bearing"].nunique() > 1
    keys = ["bearing", "line"] if several else ["line"]
    if (lines["line_bearing"] != lines["bearing"]).any():
        keys.append("line_bearing")
    keys += ["count", "ambient_degC"]
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
        "First mode with K_eff of all bearings at their design displacement. The effective damping "
        "is that of the bearings times their share in the strain energy of this mode: other "
        "parts of the structure store the rest. Their masses count, which the static rule of codes "
        "with D + D_sub neglects. Damping of the structure is not in it. "
    )
    source += f"B_L{'*' if factor.unverified else ''}: {factor.source}."
    if factor.unverified:
        source += " *: not checked against the published text."
    several = bridges["bearing"].nunique() > 1
    bridge_keys = ["bearing", "ambient_degC"] if several else ["ambient_degC"]
    return make_table(
        bridges,
        [*bridge_keys, "effective_period_s", *DAMPING_RATIOS, "B_L"],
        "Effective period and damping of the bridge",
        keys=len(bridge_keys),
        note=source,
        keep_keys=True,
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
    rows = lines.drop_duplicates(["line_bearing", "rubber", "ambient_degC"]).to_dict("records")
    names = [f"{row['line_bearing']} at {row['ambient_degC']:g} °C" for row in rows]
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
