"""Reports of designs, bounds and temperature factors, from results as they are loaded again."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic import reported
from thermobearing.design import tables
from thermobearing.design.codes import FOOTNOTE
from thermobearing.design.peaks import of_group
from thermobearing.design.result import USABLE
from thermobearing.earthquake.case import EarthquakeAnalysis
from thermobearing.earthquake.report import given_motions_table
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report import content
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Pieces
from thermobearing.report.words import degrees, identity_rows, joined, number, percent, tidy
from thermobearing.report.words import quantity as quantity_words
from thermobearing.results.directory import BEARINGS, RESOLVED
from thermobearing.results.saved import SavedResult
from thermobearing.structure.report import structure_table
from thermobearing.tables.text import read_text

Summary = Mapping[str, Any]


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the content of the report of a design, of factors or of bounds."""
    kinds = {"lambda": _factors_pieces, "bounds": _bounds_pieces}
    return kinds.get(saved.command, _design_pieces)(saved)


BOUNDS_CAPTIONS = {
    "bounds": "Demands of the two bounds and of the coupled model, and their envelope."
}


def _bounds_pieces(saved: SavedResult) -> Pieces:
    """Return the document of `bounds`."""
    summary = saved.summary
    inputs = summary["inputs"]
    names, rows = list(summary["rows"]), summary.get("tested_range", [])
    words = [reported.bearing_words(one["bearing"]) for one in inputs.values()]
    motions = dict.fromkeys(str(r["motion"]) for table in summary["rows"].values() for r in table)
    first: Summary = next(iter(inputs.values()))
    temperatures = degrees([float(str(value).split()[0]) for value in first["ambient"]])
    return content.build_pieces(
        "bounds",
        f"Bounding analyses on {summary['structure']}",
        f"Compare a bounding analysis, which uses a lower and an upper bilinear model of "
        f"{joined(words)}, with the coupled model at {temperatures}, on {summary['structure']} "
        f"under {joined(motions)}.",
        tables.bounds_sentences(summary),
        inputs=_bounds_inputs(inputs),
        tables={"demands": tables.demands_table(summary)},
        figures=content.saved_figures(saved, BOUNDS_CAPTIONS),
        checks=content.limit_checks(
            rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of the bearing", names
        ),
        rate_rows=rows,
        assumptions=_assumptions(first, [one["bearing"] for one in inputs.values()]),
        **content.saved_parts(saved, "thermobearing.design.run_bounds(...) in Python"),
    )


def _bounds_inputs(inputs: Summary) -> dict[str, Table]:
    """Return structure, motions, bearings, model."""
    found: dict[str, Table] = {}
    for one in inputs.values():
        found.setdefault("structure", structure_table(one["structure"]))
        found.setdefault("motions", given_motions_table(one["motions"]))
        found |= reported.bearing_tables(one["bearing"], one["sources"])
        for bound in one.get("bounds", []):
            found |= reported.bearing_tables(bound, otherwise="equal peak force and loop area")
        found["analysis"] = reported.analysis_table(one["analysis"], EarthquakeAnalysis())
    return found


def _assumptions(first: Mapping[str, Any], bearings: list[Mapping[str, Any]]) -> list[str]:
    """Return how the bounds are made, and what holds for the coupled runs."""
    temperatures = [float(str(value).split()[0]) for value in first["ambient"]]
    found = (
        "The bounds are bilinear models of the bearing soaked at "
        f"{degrees([max(temperatures)])} (lower) and {degrees([min(temperatures)])} (upper): equal "
        "peak force and loop area in the third cycle at "
        f"{percent(float(first['strain']))} shear strain."
    )
    analysis = first["analysis"]
    how = (
        f"Time integration: {analysis['method'].replace('-', ' ')}, steps of at most "
        f"{quantity_words(analysis['dt'])}; bodies are rigid and move in one direction."
    )
    return [found, how, *reported.model_assumptions(analysis, bearings)]


FACTORS_CAPTIONS = {
    "factors": "Factors of stiffness, strength and energy, compared with published ones.",
    "scale": "Rise of temperature, and loops, of the bearing at its own and at another size.",
}
QUANTITIES = ("K_eq", "Q_d", "K_d", "energy", "h_eq")


def _factors_pieces(saved: SavedResult) -> Pieces:
    """Return the document of `lambda`."""
    summary = saved.summary
    name, table = str(summary["bearing"]), summary["inputs"]["bearing"]
    temperatures = sorted({float(row["ambient_degC"]) for row in summary["factors"]})
    strains = sorted({float(row["strain"]) for row in summary["factors"]})
    reference = degrees([summary["reference_degC"]])
    rows = summary.get("tested_range", [])
    return content.build_pieces(
        "lambda",
        f"Temperature factors of {name}",
        f"Determine the temperature factors of stiffness, strength and energy of "
        f"{reported.bearing_words(table)}, relative to {reference}, at {degrees(temperatures)} and "
        f"{joined(percent(s) for s in strains)} shear strain ({summary['motion']}, cycles "
        f"{summary['cycles']}).",
        _factors_answer(summary),
        inputs=reported.bearing_tables(table, summary["inputs"]["sources"]),
        tables=tables.factor_tables(summary) | _codes_table(summary["codes"]),
        figures=content.saved_figures(saved, FACTORS_CAPTIONS),
        checks=content.limit_checks(
            rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of {name}"
        ),
        rate_rows=rows,
        assumptions=[
            "Every test begins with all parts of the bearing at the ambient temperature; factors "
            f"are relative to {reference}.",
            *reported.model_assumptions({}, [table]),
        ],
        **content.saved_parts(saved, "thermobearing.design.run_factors(...) in Python"),
    )


def _factors_answer(summary: Mapping[str, Any]) -> list[str]:
    """Return the coldest day in factors, and the bounds that follow."""
    most = max(float(row["strain"]) for row in summary["factors"])
    coldest = min(float(row["ambient_degC"]) for row in summary["factors"])
    parts = []
    for basis in dict.fromkeys(str(row["basis"]) for row in summary["factors"]):
        found = {
            str(row["quantity"]): float(row["factor"])
            for row in summary["factors"]
            if (row["strain"], row["ambient_degC"], row["basis"]) == (most, coldest, basis)
        }
        shown = [f"{name} x {found[name]:.2f}" for name in QUANTITIES if name in found]
        parts.append(f"{basis} {joined(shown)}")
    bounds = [
        f"{one['bound']} (Q_d {one['Q_d_kN']:.0f} kN, K_2 {one['K_2_kN_mm']:.2f} kN/mm, from "
        f"{degrees([one['ambient_degC']])})"
        for one in summary["bounds"]
    ]
    return [
        f"At {degrees([coldest])} and {percent(most)} shear strain: {'; '.join(parts)}.",
        f"Bilinear bounds that follow: {joined(bounds)}.",
        *([tables.site_sentence(summary["site"])] if summary.get("site") else []),
    ]


def _codes_table(codes: list[Summary]) -> dict[str, Table]:
    """Return the provisions of codes, if the summary has any."""
    if not codes:
        return {}
    heads = {"code": "Code and clause", "says": "Provision", "origin": "Origin"}
    names = [Quantity(head, name=name) for name, head in heads.items()]
    frame = pd.DataFrame(codes)
    note = f"{tables.code_sentences(codes)[-1]}"
    if not note.startswith(tables.UNCHECKED):
        frame["code"] += np.where(frame["unverified"], "*", "")
    frame["code"] += "; clause: " + frame["clause"]
    return {"codes": make_table(frame, names, "Provisions of codes", note=note)}


CAPTIONS = {
    "rounds": "Assumed and found displacement of each round of the design.",
    "equal": "Loops of the bilinear bearing and of layered ones of the same stiffness.",
}


def _design_pieces(saved: SavedResult) -> Pieces:
    """Return the document of a design."""
    summary = saved.summary
    case, text = read_toml(saved.path / RESOLVED), read_text(saved.path / RESOLVED)
    again = "thermobearing design case.resolved.toml"
    motions = [str(one.get("label") or one["name"]) for one in case["motions"]]
    identity = identity_rows(str(summary["version"]), text, again)
    parts = content.saved_parts(saved, again) | {"identity": identity}
    return content.build_pieces(
        "design",
        f"Design of the bearings of {summary['structure']}",
        f"Size the bearings of {summary['structure']} so that the assumed displacement agrees "
        f"with that of a dynamic analysis under {joined(motions)}, and check layered bearings of "
        "the same stiffness at every temperature.",
        _design_answer(summary),
        inputs=_design_inputs(saved, case),
        tables=tables.design_tables(summary),
        figures=content.saved_figures(saved, CAPTIONS),
        checks=_design_checks(summary),
        rate_rows=summary.get("tested_range", []),
        assumptions=[
            "The rounds use a bilinear bearing, which is independent of temperature and rate; "
            "layered bearings are checked afterwards.",
            f"The response to several motions is {summary['peaks']['says']} "
            f"({summary['peaks']['source']}).",
            f"Sources of limits: {FOOTNOTE}.",
        ],
        **parts,
    )


def _design_answer(summary: Summary) -> list[str]:
    """Return the bearing, what the cold makes of it, limits and validity."""
    sizes = []
    chosen = [turn for turn in summary["rounds"] if turn["round"] == summary["chosen_round"]]
    for name, turn in zip(np.atleast_1d(summary["bearing"]), chosen, strict=True):
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
    first = (
        f"The design is {found}" if usable else f"No design was found; the last round is {found}"
    )
    cold = [tidy(text.replace("%", " %")) for text in summary.get("coldest_day", [])]
    second = " ".join(cold) or "No layered bearing was checked at other temperatures."
    return [first, second]


def _design_inputs(saved: SavedResult, case: Summary) -> dict[str, Table]:
    """Return the case: limits and loads of the design, structure, the bearings that were found."""
    lists = ("structure", "motions", "analysis", "lines", "templates", "bearings", "equal")
    rest = {k: v for k, v in case.items() if k not in lists and not isinstance(v, list)}
    shown = [f"{one['name']} ({', '.join(one['lines'])})" for one in case.get("line_groups", [])]
    rest |= {"line_groups": "; ".join(shown)} if shown else {}
    found = {
        "design": content.input_table(
            "What was to be designed", rest, otherwise="case, or default"
        ),
        "structure": structure_table(case["structure"]),
        "motions": given_motions_table(case["motions"]),
    }
    for path in sorted((saved.path / BEARINGS).glob("*.toml")):
        table, sources = split_sources(read_toml(path))
        found |= reported.bearing_tables(table, sources, otherwise="this design")
    if "analysis" in case:
        found["analysis"] = reported.analysis_table(case["analysis"], EarthquakeAnalysis())
    return found


# Checks of layered bearings by temperature: name, unit, factor.
LAYERED = {"strain": ("shear strain", "%", 100.0), "ductility": ("pier ductility", "", 1.0)}


def _design_checks(summary: Summary) -> list[Check]:
    """Return the calculation sheet, and the tested ranges."""
    found = reported.sheet_checks(summary["checks"])
    limits = {str(one["what"]): float(one["limit"]) for one in summary["checks"]}
    source = "limit of the design, for layered bearings"
    for row in summary["temperatures"]:
        fails = str(row["fails"] or "").split()
        ended = [word for word in fails if word not in LAYERED]
        name = of_group(row["bearing"], row.get("group", ""))
        where = ", ".join([name, degrees([row["ambient_degC"]]), *ended])
        for key, (what, unit, factor) in LAYERED.items():
            if what not in limits or row[key] is None or not np.isfinite(row[key]):
                continue
            verdict = EXCEEDED if ended or key in fails else PASSED
            numbers = factor * float(row[key]), factor * limits[what]
            found.append(Check(f"{what} ({where})", *numbers, unit, source, verdict))
    names = [*np.atleast_1d(summary["bearing"]), *(str(one["name"]) for one in summary["equal"])]
    rows = summary.get("tested_range", [])
    return found + content.limit_checks(
        rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of the bearing", names
    )
