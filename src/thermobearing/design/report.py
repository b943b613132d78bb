"""What the documents of a design, of factors and of bounds say, from results as they are loaded."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.border.encodings import read_text
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import analysis_table, bearing_tables
from thermobearing.design.peaks import of_group
from thermobearing.design.published import FOOTNOTE
from thermobearing.design.report_bounds import bounds_pieces
from thermobearing.design.report_factors import factors_pieces
from thermobearing.design.result import USABLE
from thermobearing.earthquake.case import EarthquakeAnalysis
from thermobearing.earthquake.report_inputs import given_motions_table
from thermobearing.report.identity import identity_of
from thermobearing.report.inputs import input_table
from thermobearing.report.limits import IN_EARTHQUAKES, TESTED_RANGE, limit_checks, verdict
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Column, Pieces, ReportTable
from thermobearing.report.saved import saved_figures, saved_validity
from thermobearing.report.words import degrees, joined, number, printed_unit, tidy
from thermobearing.results.directory import BEARINGS, RESOLVED
from thermobearing.results.ranges import rate_note
from thermobearing.results.saved import SavedResult
from thermobearing.structure.report import structure_table

Summary = Mapping[str, Any]
KINDS = {"lambda": factors_pieces, "bounds": bounds_pieces}
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


def pieces_of(saved: SavedResult) -> Pieces:
    """Everything that the document of a design, of factors or of bounds says.

    Parameters
    ----------
    saved : of `design`, `lambda` or `bounds`, as `load_result` gives it.
    """
    make = KINDS.get(saved.command, design_pieces)
    return make(saved)


def design_pieces(saved: SavedResult) -> Pieces:
    """Of a design."""
    summary = saved.summary
    case, text = read_toml(saved.path / RESOLVED), read_text(saved.path / RESOLVED)
    validity, unknown, warnings = saved_validity(saved)
    checks = checks_of(saved)
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
        inputs=inputs_of(saved, case),
        tables=tables_of(saved),
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
        identity=identity_of(
            str(summary["version"]), text, "thermobearing design case.resolved.toml"
        ),
    )


def names_of(summary: Summary) -> list[str]:
    """Return the names of the bilinear bearings, in the order of the groups of lines."""
    return list(np.atleast_1d(summary["bearing"]))


def chosen_rounds(summary: Summary) -> list[Summary]:
    """Return the rounds of the turn that was taken, one for each group of lines."""
    return [turn for turn in summary["rounds"] if turn["round"] == summary["chosen_round"]]


def answer(summary: Summary, told: str) -> list[str]:
    """The bearing, what the cold makes of it, limits and validity."""
    sizes = []
    for name, turn in zip(names_of(summary), chosen_rounds(summary), strict=True):
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


def inputs_of(saved: SavedResult, case: Mapping[str, Any]) -> dict[str, ReportTable]:
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


def tables_of(saved: SavedResult) -> dict[str, ReportTable]:
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


def checks_of(saved: SavedResult) -> list[Check]:
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
    names = [*names_of(summary), *(str(one["name"]) for one in summary["equal"])]

    def bearing_of(run: str) -> str:
        return next((name for name in names if run.startswith(f"{name}, ")), "")

    rows = summary.get("tested_range", [])
    return found + limit_checks(rows, IN_EARTHQUAKES, f"{TESTED_RANGE} of the bearing", bearing_of)
