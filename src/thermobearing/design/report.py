"""Reports of designs, bounds and temperature factors, from results as they are loaded again."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing import reported
from thermobearing.border.lazy import pd
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.design import tables
from thermobearing.design.bounds import VIRGIN_BOUND
from thermobearing.design.codes import FOOTNOTE
from thermobearing.design.peaks import of_group
from thermobearing.design.result import USABLE
from thermobearing.earthquake.case import EarthquakeAnalysis
from thermobearing.earthquake.motions import given_motions_table
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import degrees, identity_rows, joined, number, percent, tidy
from thermobearing.quantities.words import quantity as quantity_words
from thermobearing.report import content
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Pieces
from thermobearing.results.directory import BEARINGS, RESOLVED
from thermobearing.results.saved import SavedResult
from thermobearing.structure.report import structure_table
from thermobearing.tables.text import read_text

Summary = Mapping[str, Any]


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the content of the report of a design, of factors or of bounds."""
    kinds = {"lambda": _factors_pieces, "bounds": _bounds_pieces}
    return kinds.get(saved.command, _design_pieces)(saved)


def _bounds_pieces(saved: SavedResult) -> Pieces:
    """Return the document of `bounds`."""
    summary = saved.summary
    inputs = summary["inputs"]
    names, rows = list(summary["rows"]), summary.get("tested_range", [])
    words = [reported.bearing_words(entry["bearing"]) for entry in inputs.values()]
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
        tables=tables.demands_tables(summary),
        figures=content.saved_figures(saved, "bounds"),
        checks=content.limit_checks(
            rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of the bearing", names
        ),
        rate_rows=rows,
        assumptions=_assumptions(first, [entry["bearing"] for entry in inputs.values()]),
        **content.saved_parts(saved, "thermobearing.design.run_bounds(...) in Python"),
    )


def _bounds_inputs(inputs: Summary) -> dict[str, Table]:
    """Return structure, motions, bearings, model."""
    input_tables: dict[str, Table] = {}
    for entry in inputs.values():
        input_tables.setdefault("structure", structure_table(entry["structure"]))
        input_tables.setdefault("motions", given_motions_table(entry["motions"]))
        input_tables |= reported.bearing_tables(entry["bearing"], entry["sources"])
        for bound in entry.get("bounds", []):
            input_tables |= reported.bearing_tables(
                bound, otherwise="equal peak force and loop area"
            )
        input_tables["analysis"] = reported.analysis_table(entry["analysis"], EarthquakeAnalysis())
    return input_tables


def _assumptions(first: Mapping[str, Any], bearings: list[Mapping[str, Any]]) -> list[str]:
    """Return how the bounds are made, and what holds for the coupled runs."""
    temperatures = [float(str(value).split()[0]) for value in first["ambient"]]
    bounds = (
        "The bounds are bilinear models of the bearing soaked at "
        f"{degrees([max(temperatures)])} (lower) and {degrees([min(temperatures)])} (upper): equal "
        "peak force and loop area in the third cycle at "
        f"{percent(float(first['strain']))} shear strain. {tables.STATES_NOTE}"
    )
    analysis = first["analysis"]
    integration = (
        f"Time integration: {analysis['method'].replace('-', ' ')}, steps of at most "
        f"{quantity_words(analysis['dt'])}; bodies are rigid and move in one direction."
    )
    return [bounds, integration, *reported.model_assumptions(analysis, bearings)]


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
        figures=content.saved_figures(saved, "lambda"),
        checks=content.limit_checks(
            rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of {name}"
        ),
        rate_rows=rows,
        assumptions=[
            "Every test begins with all parts of the bearing at the ambient temperature; factors "
            f"are relative to {reference}.",
            *reported.model_assumptions({}, [table]),
            *([f"{VIRGIN_BOUND}."] if summary["states"] else []),
        ],
        **content.saved_parts(saved, "thermobearing.design.run_factors(...) in Python"),
    )


def _factors_answer(summary: Mapping[str, Any]) -> list[str]:
    """Return the coldest day in factors, and the bounds that follow."""
    largest_strain = max(float(row["strain"]) for row in summary["factors"])
    coldest = min(float(row["ambient_degC"]) for row in summary["factors"])
    parts = []
    for basis in dict.fromkeys(str(row["basis"]) for row in summary["factors"]):
        factors = {
            str(row["quantity"]): float(row["factor"])
            for row in summary["factors"]
            if (row["strain"], row["ambient_degC"], row["basis"])
            == (largest_strain, coldest, basis)
        }
        shown = [f"{name} x {factors[name]:.2f}" for name in QUANTITIES if name in factors]
        parts.append(f"{basis} {joined(shown)}")
    bounds = [
        f"{bound['bound']} (Q_d {bound['Q_d_kN']:.0f} kN, K_2 {bound['K_2_kN_mm']:.2f} kN/mm, from "
        f"{degrees([bound['ambient_degC']])})"
        for bound in summary["bounds"]
    ]
    return [
        f"At {degrees([coldest])} and {percent(largest_strain)} shear strain: {'; '.join(parts)}.",
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
    # Where no provision was checked, the note says so in place of a star at each.
    if not note.startswith(tables.UNCHECKED):
        frame["code"] += np.where(frame["unverified"], "*", "")
    frame["code"] += "; clause: " + frame["clause"]
    return {"codes": make_table(frame, names, "Provisions of codes", note=note)}


VIRGIN_CHECK = (
    "Sizes and checks are of tested rubber. Layered bearings are computed once more with virgin "
    "rubber, whose scragging is assumed where a bearing has no table of it."
)


def _design_pieces(saved: SavedResult) -> Pieces:
    """Return the document of a design."""
    summary = saved.summary
    case, text = read_toml(saved.path / RESOLVED), read_text(saved.path / RESOLVED)
    command = "thermobearing design case.resolved.toml"
    motions = [str(motion.get("label") or motion["name"]) for motion in case["motions"]]
    identity = identity_rows(str(summary["version"]), text, command)
    parts = content.saved_parts(saved, command) | {"identity": identity}
    return content.build_pieces(
        "design",
        f"Design of the bearings of {summary['structure']}",
        f"Size the bearings of {summary['structure']} so that the assumed displacement agrees "
        f"with that of a dynamic analysis under {joined(motions)}, and check layered bearings of "
        "the same stiffness at every temperature.",
        _design_answer(summary),
        inputs=_design_inputs(saved, case),
        tables=tables.design_tables(summary),
        figures=content.saved_figures(saved, "design"),
        checks=_design_checks(summary),
        rate_rows=summary.get("tested_range", []),
        assumptions=[
            "The rounds use a bilinear bearing, which is independent of temperature and rate; "
            "layered bearings are checked afterwards.",
            f"The response to several motions is {summary['peaks']['says']} "
            f"({summary['peaks']['source']}).",
            f"Sources of limits: {FOOTNOTE}.",
            *([VIRGIN_CHECK] if summary.get("virgin") else []),
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
        prefix = f"for {turn['group']}, " if "group" in turn else ""
        sizes.append(
            f"{prefix}{name} ({size}; K_B {turn['K_B_kN_mm']:.2f} kN/mm, "
            f"Q_d {turn['Q_d_kN']:.0f} kN)"
        )
    usable = summary["outcome"] in USABLE
    design = f"{joined(sizes)}. {tidy(summary['sentence'])}"
    first = (
        f"The design is {design}" if usable else f"No design was found; the last round is {design}"
    )
    sentences = [*summary.get("coldest_day", []), *summary.get("both_states", [])]
    cold = [tidy(text.replace("%", " %")) for text in sentences]
    second = " ".join(cold) or "No layered bearing was checked at other temperatures."
    return [first, second]


def _design_inputs(saved: SavedResult, case: Summary) -> dict[str, Table]:
    """Return the case: limits and loads of the design, structure, the bearings that were found."""
    lists = ("structure", "motions", "analysis", "lines", "templates", "bearings", "equal")
    scalars = {k: v for k, v in case.items() if k not in lists and not isinstance(v, list)}
    groups = [
        f"{group['name']} ({', '.join(group['lines'])})" for group in case.get("line_groups", [])
    ]
    scalars |= {"line_groups": "; ".join(groups)} if groups else {}
    input_tables = {
        "design": content.input_table(
            "What was to be designed", scalars, otherwise="case, or default"
        ),
        "structure": structure_table(case["structure"]),
        "motions": given_motions_table(case["motions"]),
    }
    for path in sorted((saved.path / BEARINGS).glob("*.toml")):
        table, sources = split_sources(read_toml(path))
        input_tables |= reported.bearing_tables(table, sources, otherwise="this design")
    if "analysis" in case:
        input_tables["analysis"] = reported.analysis_table(case["analysis"], EarthquakeAnalysis())
    return input_tables


# Checks of layered bearings by temperature: name, unit, factor.
LAYERED = {"strain": ("shear strain", "%", 100.0), "ductility": ("pier ductility", "", 1.0)}


def _design_checks(summary: Summary) -> list[Check]:
    """Return the calculation sheet, and the tested ranges."""
    checks = reported.sheet_checks(summary["checks"])
    limits = {str(item["what"]): float(item["limit"]) for item in summary["checks"]}
    source = "limit of the design, for layered bearings"
    for row in summary["temperatures"]:
        fails = str(row["fails"] or "").split()
        ended = [word for word in fails if word not in LAYERED]
        name = of_group(row["bearing"], row.get("group", ""))
        where = ", ".join([name, degrees([row["ambient_degC"]]), *ended])
        for key, (label, unit, factor) in LAYERED.items():
            if label not in limits or row[key] is None or not np.isfinite(row[key]):
                continue
            verdict = EXCEEDED if ended or key in fails else PASSED
            numbers = factor * float(row[key]), factor * limits[label]
            checks.append(Check(f"{label} ({where})", *numbers, unit, source, verdict))
    names = [*np.atleast_1d(summary["bearing"]), *(str(item["name"]) for item in summary["equal"])]
    rows = summary.get("tested_range", [])
    return checks + content.limit_checks(
        rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of the bearing", names
    )
