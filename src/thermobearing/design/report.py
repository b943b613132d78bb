"""Reports of designs, bounds and temperature factors."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.design.bounds import BOUNDS_NOTE
from thermobearing.design.peaks import of_group
from thermobearing.design.published import FOOTNOTE
from thermobearing.design.result import USABLE
from thermobearing.earthquake.case import EarthquakeAnalysis
from thermobearing.earthquake.report import given_motions_table
from thermobearing.report.content import (
    IN_EARTHQUAKES,
    MARKED,
    TESTED_RANGE,
    TESTS,
    input_table,
    limit_checks,
    saved_figures,
    saved_identity,
    saved_validity,
    verdict,
)
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Column, Pieces, ReportTable
from thermobearing.report.words import (
    counted,
    degrees,
    identity_rows,
    joined,
    number,
    percent,
    printed_unit,
    quantity,
    tidy,
)
from thermobearing.results.directory import BEARINGS, RESOLVED
from thermobearing.results.ranges import rate_note
from thermobearing.results.saved import SavedResult
from thermobearing.structure.report import structure_table
from thermobearing.tables.text import read_text

BOUNDS_CAPTIONS = {
    "bounds": "Demands of the two bounds and of the coupled model, and their envelope."
}
DEMANDS = {
    "bearing_strain_max": ("shear strain", "%", 100.0, ".0f"),
    "bearing_force_max_kN": ("force of one bearing", "kN", 1.0, ".0f"),
    "pier_displacement_max_mm": ("pier top", "mm", 1.0, ".1f"),
    "deck_acceleration_max_m_s2": ("deck acceleration", "m/s²", 1.0, ".2f"),
}


def _bounds_pieces(saved: SavedResult) -> Pieces:
    """Of `bounds`.

    Parameters
    ----------
    saved : as `load_result` gives it.
    """
    summary = saved.summary
    validity, unknown, warnings = saved_validity(saved)
    told = {name: one for name, one in (summary.get("inputs") or {}).items() if one}
    names, rows = list(summary["rows"]), summary.get("tested_range", [])
    checks = limit_checks(rows, IN_EARTHQUAKES, f"{TESTED_RANGE} of the bearing", names)
    rate = rate_note(rows)
    words = [bearing_words(one["bearing"]) for one in told.values()] or names
    motions = dict.fromkeys(str(r["motion"]) for table in summary["rows"].values() for r in table)
    first: Mapping[str, Any] = next(iter(told.values()), {})
    airs = degrees([float(str(air).split()[0]) for air in first.get("ambient", [])])
    return Pieces(
        command="bounds",
        title=f"Bounding analyses on {summary['structure']}",
        question=(
            f"Is it enough to run {summary['structure']} twice, with a lower and an upper bilinear "
            f"model of {joined(words, 'or')}, instead of the coupled model at {airs}, under "
            f"{joined(motions)}?"
        ),
        answer=[*_bounds_answer(summary), verdict(checks, validity, unknown, rate)],
        inputs=_inputs(told),
        tables={"demands": _table(summary)},
        figures=saved_figures(saved, BOUNDS_CAPTIONS),
        checks=checks,
        validity=validity,
        notes=[tidy(f"{rate[:1].upper()}{rate[1:]}")] if rate else [],
        validity_unknown=unknown,
        assumptions=_assumptions(first, [one["bearing"] for one in told.values()]),
        warnings=warnings,
        identity=saved_identity(saved, "thermobearing.design.run_bounds(...) in Python"),
    )


def _bounds_answer(summary: Mapping[str, Any]) -> list[str]:
    """How many demands are unsafe, and the worst of them."""
    rows = [(name, row) for name, table in summary["rows"].items() for row in table]
    early = []
    if summary["outcome"] != "completed":
        sentence = tidy(str(summary.get("sentence", "")))
        early = [f"Not every run came to its end ({summary['outcome']}): {sentence}"]
    unsafe = [pair for pair in rows if pair[1]["verdict"] == "unsafe"]
    wasteful = [pair for pair in rows if pair[1]["verdict"] == "wasteful"]
    name, least = min(rows, key=lambda pair: pair[1]["envelope_over_coupled"])
    what = DEMANDS.get(least["demand"], (least["demand"],))[0]
    first = (
        f"Of {counted(len(rows), 'demand')}, {len(unsafe)} are unsafe (below 0.95 of the coupled "
        f"model) and {len(wasteful)} wasteful (above 1.3)."
    )
    second = (
        f"The least safe is the {what} of {name} under {least['motion']}: the envelope of the "
        f"bounds gives {least['envelope_over_coupled']:.2f} of what the coupled model gives at "
        f"{degrees([least['coupled_at_degC']])}."
    )
    return [*early, first, second]


def _table(summary: Mapping[str, Any]) -> ReportTable:
    """A row for each bearing, motion and demand."""
    parts = any(row.get("part") for table in summary["rows"].values() for row in table)
    columns = [Column("Bearing"), Column("Motion"), Column("Demand"), Column("Unit")]
    columns += [Column("Part")] if parts else []
    columns += [
        Column("Lower bound", "", ".4g"),
        Column("Upper bound", "", ".4g"),
        Column("Coupled, largest", "", ".4g"),
        Column("at", "°C", "g"),
        Column("Envelope over coupled", "", ".2f"),
        Column("Verdict"),
    ]
    rows: list[list[Any]] = []
    marked = set()
    for name, table in summary["rows"].items():
        for row in table:
            what, unit, factor, _ = DEMANDS.get(row["demand"], (row["demand"], "", 1.0, ""))
            cells = [name, row["motion"], what, unit, *([row.get("part", "")] if parts else [])]
            cells += [factor * row[n] for n in ("lower_bound", "upper_bound", "coupled_max")]
            cells += [row["coupled_at_degC"], row["envelope_over_coupled"], row["verdict"]]
            if str(row.get("beyond_tested") or ""):
                marked.add((len(rows), 1))
            rows.append(cells)
    note = "unsafe: envelope below 0.95 of the coupled model; wasteful: above 1.3."
    note += f" {MARKED} (some run of that motion)." if marked else ""
    caption = "Bounds beside the coupled model"
    return ReportTable(caption, columns, rows, 4 + parts, frozenset(marked), note)


def _inputs(told: Mapping[str, Any]) -> dict[str, ReportTable]:
    """Structure, motions, bearings, model."""
    found: dict[str, ReportTable] = {}
    for one in told.values():
        found.setdefault("structure", structure_table(one["structure"]))
        found.setdefault("motions", given_motions_table(one["motions"]))
        found |= bearing_tables(one["bearing"], one["sources"])
        for bound in one.get("bounds", []):
            found |= bearing_tables(bound, otherwise="equal peak force and loop area")
        found["analysis"] = analysis_table(one["analysis"], EarthquakeAnalysis())
    return found


def _assumptions(first: Mapping[str, Any], bearings: list[Mapping[str, Any]]) -> list[str]:
    """How the bounds are made, and what holds for the coupled runs."""
    if not first:
        return []
    airs = [float(str(air).split()[0]) for air in first["ambient"]]
    found = (
        f"The bounds are bilinear models of the bearing soaked at {degrees([max(airs)])} (lower) "
        f"and {degrees([min(airs)])} (upper): equal peak force and loop area in the third cycle at "
        f"{percent(float(first['strain']))} shear strain."
    )
    analysis = first["analysis"]
    how = (
        f"Time integration: {analysis['method'].replace('-', ' ')}, steps of at most "
        f"{quantity(analysis['dt'])}; bodies are rigid and move in one direction."
    )
    return [found, how, *model_assumptions(analysis, bearings)]


FACTORS_CAPTIONS = {
    "factors": "Temperature factors of stiffness, strength and energy, beside published ones.",
    "scale": "Rise of temperature, and loops, of the bearing at its own and at another size.",
}
QUANTITIES = ("K_eq", "Q_d", "K_d", "energy", "h_eq")


def _factors_pieces(saved: SavedResult) -> Pieces:
    """Of `lambda`.

    Parameters
    ----------
    saved : as `load_result` gives it.
    """
    summary = saved.summary
    validity, unknown, warnings = saved_validity(saved)
    told = summary.get("inputs") or {}
    name, table = str(summary["bearing"]), told.get("bearing")
    rows = summary.get("tested_range", [])
    checks = limit_checks(rows, TESTS, f"{TESTED_RANGE} of {name}")
    airs = sorted({float(row["ambient_degC"]) for row in summary["factors"]})
    strains = sorted({float(row["strain"]) for row in summary["factors"]})
    words = bearing_words(table) if table else name
    reference = degrees([summary["reference_degC"]])
    return Pieces(
        command="lambda",
        title=f"Temperature factors of {name}",
        question=(
            f"By which factors do stiffness, strength and energy of {words} change, from "
            f"{reference} to {degrees(airs)}, at {joined(percent(s) for s in strains)} shear "
            f"strain ({summary['motion']}, cycles {summary['cycles']})?"
        ),
        answer=[*_factors_answer(summary), verdict(checks, validity, unknown)],
        inputs=bearing_tables(table, told.get("sources")) if table else {},
        tables=_tables(summary),
        figures=saved_figures(saved, FACTORS_CAPTIONS),
        checks=checks,
        validity=validity,
        validity_unknown=unknown,
        assumptions=[
            f"Every test begins with the bearing at the temperature of the air throughout; "
            f"factors are over {reference}.",
            *model_assumptions({}, [table] if table else []),
        ],
        warnings=warnings,
        identity=saved_identity(saved, "thermobearing.design.run_factors(...) in Python"),
    )


def _factors_answer(summary: Mapping[str, Any]) -> list[str]:
    """The coldest day in factors, and the bounds that follow."""
    most = max(float(row["strain"]) for row in summary["factors"])
    coldest = min(float(row["ambient_degC"]) for row in summary["factors"])
    parts = []
    for basis in dict.fromkeys(str(row["basis"]) for row in summary["factors"]):
        found = {
            str(row["quantity"]): float(row["factor"])
            for row in summary["factors"]
            if (row["strain"], row["ambient_degC"], row["basis"]) == (most, coldest, basis)
        }
        told = [f"{name} x {found[name]:.2f}" for name in QUANTITIES if name in found]
        parts.append(f"{basis} {joined(told)}")
    bounds = [
        f"{one['bound']} (Q_d {one['Q_d_kN']:.0f} kN, K_2 {one['K_2_kN_mm']:.2f} kN/mm, from "
        f"{degrees([one['ambient_degC']])})"
        for one in summary["bounds"]
    ]
    return [
        f"At {degrees([coldest])} and {percent(most)} shear strain: {'; '.join(parts)}.",
        f"Bilinear bounds that follow: {joined(bounds)}.",
    ]


def _tables(summary: Mapping[str, Any]) -> dict[str, ReportTable]:
    """Factors with a column for each temperature, bounds, published factors."""
    rows = summary["factors"]
    airs = sorted({float(row["ambient_degC"]) for row in rows})
    bands = any(row.get("factor_low") is not None for row in rows)
    keys: dict[tuple[Any, ...], dict[float, Any]] = {}
    values: dict[tuple[Any, ...], float] = {}
    for row in rows:
        unit, factor = printed_unit(str(row["unit"]))
        key = (100.0 * row["strain"], row["basis"], row["quantity"], unit)
        keys.setdefault(key, {})[float(row["ambient_degC"])] = row
        if row["ambient_degC"] == summary["reference_degC"]:
            values[key] = factor * row["value"]
    columns = [Column("Strain", "%", "g"), Column("Cycle"), Column("Quantity"), Column("Unit")]
    reference = degrees([summary["reference_degC"]])
    columns.append(Column(f"Value at {reference}", "", ".4g"))
    columns += [Column(f"Factor at {degrees([air])}", "", ".2f") for air in airs]
    cells: list[list[Any]] = []
    marked: set[tuple[int, int]] = set()
    for key, found in keys.items():
        line: list[Any] = [*key, values.get(key)]
        for place, air in enumerate(airs):
            row = found.get(air)
            line.append(None if row is None else _cell(row, bands))
            if row is not None and "ambient" in str(row.get("beyond_tested") or "").split():
                marked.add((len(cells), 5 + place))
        cells.append(line)
    note = "first: the first cycle; heated: mean of the cycles with the bearing's own heat."
    note += " In brackets: band over the samples." if bands else ""
    note += f" {MARKED}." if marked else ""
    caption = f"Temperature factors over {reference}"
    tables = {"factors": ReportTable(caption, columns, cells, 4, frozenset(marked), note)}
    tables["bounds"] = _bounds(summary)
    if summary.get("coldest_day"):
        words = [[tidy(text)] for text in summary["coldest_day"]]
        caption = "The coldest day, compared with published factors"
        tables["coldest"] = ReportTable(caption, [Column("Factors")], words, note=f"{FOOTNOTE}.")
    if summary.get("codes"):
        heads = [Column("Code"), Column("Says"), Column("Source"), Column("Verified")]
        told = [
            [one["code"], one["says"], one["source"], not one.get("unverified", False)]
            for one in summary["codes"]
        ]
        tables["codes"] = ReportTable("What codes say", heads, told)
    return tables


def _cell(row: Mapping[str, Any], bands: bool) -> Any:
    """A factor, with its band where there is one."""
    low, high = row.get("factor_low"), row.get("factor_high")
    if not bands or low is None or high is None or not np.isfinite([low, high]).all():
        return row["factor"]
    return f"{row['factor']:.2f} ({low:.2f}–{high:.2f})"


def _bounds(summary: Mapping[str, Any]) -> ReportTable:
    columns = (
        Column("Bound"),
        Column("Strain", "%", "g"),
        Column("Cycle"),
        Column("Ambient", "°C", "g"),
        Column("Q_d", "kN", ".1f"),
        Column("K_1", "kN/mm", ".2f"),
        Column("K_2", "kN/mm", ".3f"),
        Column("Q_y", "kN", ".1f"),
    )
    rows = [
        (
            one["bound"],
            100.0 * one["strain"],
            one["basis"],
            one["ambient_degC"],
            one["Q_d_kN"],
            one["K_1_kN_mm"],
            one["K_2_kN_mm"],
            one["Q_y_kN"],
        )
        for one in summary["bounds"]
    ]
    ratio = summary["stiffness_ratio"]
    note = f"K_2/K_1 = {ratio['K_2_over_K_1']:g}: {ratio['source']}. {BOUNDS_NOTE}."
    return ReportTable("Lower and upper bilinear model", columns, rows, note=note)


Summary = Mapping[str, Any]
KINDS = {"lambda": _factors_pieces, "bounds": _bounds_pieces}
CAPTIONS = {
    "rounds": "Assumed and found displacement of each round of the design.",
    "equal": "Loops of the bilinear bearing and of layered ones of the same stiffness.",
}
ROUNDS = {  # column of rounds.csv: head, factor
    "u_B_assumed_mm": (Column("Assumed displacement", "mm", ".0f"), 1.0),
    "side_mm": (Column("Side", "mm", "g"), 1.0),
    "layers": (Column("Layers", form="g"), 1.0),
    "layer_thickness_mm": (Column("of", "mm", "g"), 1.0),
    "K_B_kN_mm": (Column("K_B", "kN/mm", ".3f"), 1.0),
    "h_B": (Column("h_B", "", ".3f"), 1.0),
    "Q_d_kN": (Column("Q_d", "kN", ".1f"), 1.0),
    "K_1_kN_mm": (Column("K_1", "kN/mm", ".2f"), 1.0),
    "K_2_kN_mm": (Column("K_2", "kN/mm", ".2f"), 1.0),
    "u_found_mm": (Column("Found displacement", "mm", ".0f"), 1.0),
    "difference": (Column("Difference", "%", "+.1f"), 100.0),
    "pier_ductility": (Column("Pier ductility", "", ".2f"), 1.0),
}
TEMPERATURES = {
    "displacement_mm": (Column("Displacement", "mm", ".0f"), 1.0),
    "strain": (Column("Strain", "%", ".0f"), 100.0),
    "force_kN": (Column("Force of one", "kN", ".0f"), 1.0),
    "pier_displacement_mm": (Column("Pier top", "mm", ".1f"), 1.0),
    "ductility": (Column("Ductility", "", ".2f"), 1.0),
    "deck_acceleration_m_s2": (Column("Deck", "m/s²", ".2f"), 1.0),
}


def build_pieces(saved: SavedResult) -> Pieces:
    """Everything that the document of a design, of factors or of bounds says.

    Parameters
    ----------
    saved : of `design`, `lambda` or `bounds`, as `load_result` gives it.
    """
    make = KINDS.get(saved.command, _design_pieces)
    return make(saved)


def _design_pieces(saved: SavedResult) -> Pieces:
    """Of a design."""
    summary = saved.summary
    case, text = read_toml(saved.path / RESOLVED), read_text(saved.path / RESOLVED)
    validity, unknown, warnings = saved_validity(saved)
    checks = report_checks(saved)
    rate = rate_note(summary.get("tested_range", []))
    motions = [str(one.get("label") or one["name"]) for one in case["motions"]]
    return Pieces(
        command="design",
        title=f"Design of the bearings of {summary['structure']}",
        question=(
            f"Which bearing does {summary['structure']} need, so that the displacement that was "
            f"assumed is the one that a dynamic analysis finds, under {joined(motions)}; and what "
            "do layered bearings of the same stiffness do, at every temperature?"
        ),
        answer=answer(summary, verdict(checks, validity, unknown, rate)),
        inputs=input_tables(saved, case),
        tables=report_tables_by_name(saved),
        figures=saved_figures(saved, CAPTIONS),
        checks=checks,
        validity=validity,
        notes=[tidy(f"{rate[:1].upper()}{rate[1:]}")] if rate else [],
        validity_unknown=unknown,
        assumptions=[
            "The rounds run with a bilinear bearing, blind to temperature and rate; layered "
            "bearings are judged after them.",
            f"Of several motions counts {summary['peaks']['says']} ({summary['peaks']['source']}).",
            f"Sources of limits, {FOOTNOTE}.",
        ],
        warnings=warnings,
        identity=identity_rows(
            str(summary["version"]), text, "thermobearing design case.resolved.toml"
        ),
    )


def _safe_file_names(summary: Summary) -> list[str]:
    """Return the names of the bilinear bearings, in the order of the groups of lines."""
    return list(np.atleast_1d(summary["bearing"]))


def _chosen_rounds(summary: Summary) -> list[Summary]:
    """Return the rounds of the turn that was taken, one for each group of lines."""
    return [turn for turn in summary["rounds"] if turn["round"] == summary["chosen_round"]]


def answer(summary: Summary, told: str) -> list[str]:
    """The bearing, what the cold makes of it, limits and validity."""
    sizes = []
    for name, turn in zip(_safe_file_names(summary), _chosen_rounds(summary), strict=True):
        size = (
            f"{number(turn['side_mm'], 'g')} mm square, {number(turn['layers'], 'g')} layers of "
            f"{number(turn['layer_thickness_mm'], 'g')} mm"
        )
        on = f"for {turn['group']}, " if "group" in turn else ""
        sizes.append(
            f"{on}{name} ({size}; K_B {turn['K_B_kN_mm']:.2f} kN/mm, Q_d {turn['Q_d_kN']:.0f} kN)"
        )
    usable = summary["outcome"] in USABLE
    found = f"{joined(sizes)}. {tidy(summary['sentence'])}"
    first = f"The design is {found}" if usable else f"There is no design; the last round: {found}"
    cold = [tidy(text.replace("%", " %")) for text in summary.get("coldest_day", [])]
    second = " ".join(cold) or "No layered bearing was judged at other temperatures."
    return [first, second, told]


def input_tables(saved: SavedResult, case: Mapping[str, Any]) -> dict[str, ReportTable]:
    """The case: limits and loads of the design, structure, the bearings that were found."""
    lists = ("structure", "motions", "analysis", "lines", "templates", "bearings", "equal")
    rest = {k: v for k, v in case.items() if k not in lists and not isinstance(v, list)}
    told = [f"{one['name']} ({', '.join(one['lines'])})" for one in case.get("line_groups", [])]
    rest |= {"line_groups": "; ".join(told)} if told else {}
    found = {
        "design": input_table("What was to be designed", rest, otherwise="case, or default"),
        "structure": structure_table(case["structure"]),
        "motions": given_motions_table(case["motions"]),
    }
    for path in sorted((saved.path / BEARINGS).glob("*.toml")):
        table, sources = split_sources(read_toml(path))
        found |= bearing_tables(table, sources, otherwise="this design")
    if "analysis" in case:
        found["analysis"] = analysis_table(case["analysis"], EarthquakeAnalysis())
    return found


def report_tables_by_name(saved: SavedResult) -> dict[str, ReportTable]:
    """Rounds, equal bearings, every temperature."""
    summary = saved.summary
    names = [name for name in ROUNDS if name in summary["rounds"][0]]
    group = ["group"] if "group" in summary["rounds"][0] else []
    lines = [Column("Lines")] if group else []
    rows = [
        [
            turn["round"],
            *(turn[n] for n in group),
            *(ROUNDS[n][1] * turn[n] if turn[n] is not None else None for n in names),
        ]
        for turn in summary["rounds"]
    ]
    columns = [Column("Round", form="d"), *lines, *(ROUNDS[name][0] for name in names)]
    note = f"Round {summary['chosen_round']} was taken."
    caption = "Rounds of the design"
    found = {"rounds": ReportTable(caption, columns, rows, 1 + len(lines), note=note)}
    if summary["equal"]:
        columns = [Column("Bearing"), *lines]
        columns += [Column("K_eq", "kN/mm", ".3f"), Column("h_eq", "", ".3f")]
        values = ["name", *group, "K_eq_kN_mm", "h_eq"]
        rows = [[one[n] for n in values] for one in summary["equal"]]
        caption = "Layered bearings of the same stiffness, third cycle at the design displacement"
        found["equal"] = ReportTable(caption, columns, rows)
    if summary["temperatures"]:
        told = [name for name in TEMPERATURES if name in summary["temperatures"][0]]
        columns = [Column("Bearing"), *lines, Column("Ambient", "°C", "g")]
        columns += [TEMPERATURES[name][0] for name in told]
        columns += [Column("Governing pier")] if group else []
        columns += [Column("Verdict"), Column("Fails")]
        before = ["bearing", *group, "ambient_degC"]
        after = [*(["pier"] if group else []), "verdict", "fails"]
        rows = [
            [
                *(row[n] for n in before),
                *(TEMPERATURES[n][1] * row[n] if row[n] is not None else None for n in told),
                *(row[n] for n in after),
            ]
            for row in summary["temperatures"]
        ]
        caption = "Layered bearings at every temperature"
        found["temperatures"] = ReportTable(caption, columns, rows, len(before))
    return found


def report_checks(saved: SavedResult) -> list[Check]:
    """The calculation sheet, and the tested ranges."""
    summary = saved.summary
    found = []
    for one in summary["checks"]:
        unit, factor = printed_unit(str(one["unit"]))
        if one["what"].endswith("strain"):
            unit, factor = "%", 100.0
        of = f", {one['part']}" if one.get("part") else ""
        found.append(
            Check(
                f"{one['what']}{of}",
                factor * float(one["value"]),
                factor * float(one["limit"]),
                unit,
                f"{one['source']}{'*' if one.get('unverified') else ''}",
                PASSED if one["verdict"] == "OK" else EXCEEDED,
                lower=bool(one["least"]),
            )
        )
    for row in summary["temperatures"]:
        failed = f": {row['fails']}" if row["fails"] else ""
        name = of_group(row["bearing"], row.get("group", ""))
        found.append(
            Check(
                f"{name} at {degrees([row['ambient_degC']])}{failed}",
                float("nan"),
                float("nan"),
                "",
                "limits of the design, for layered bearings",
                PASSED if row["verdict"] == "OK" else EXCEEDED,
            )
        )
    names = [*_safe_file_names(summary), *(str(one["name"]) for one in summary["equal"])]
    rows = summary.get("tested_range", [])
    return found + limit_checks(rows, IN_EARTHQUAKES, f"{TESTED_RANGE} of the bearing", names)
