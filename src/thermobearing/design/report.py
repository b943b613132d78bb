"""Reports of designs, bounds and temperature factors, from results as they are loaded again."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.design.bounds import BOUNDS_NOTE
from thermobearing.design.factors import FOOTNOTE
from thermobearing.design.peaks import JUDGED, of_group
from thermobearing.design.result import USABLE
from thermobearing.earthquake.case import EarthquakeAnalysis
from thermobearing.earthquake.report import given_motions_table
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report import content
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Pieces
from thermobearing.report.words import (
    counted,
    degrees,
    identity_rows,
    joined,
    number,
    percent,
    printed_unit,
    tidy,
)
from thermobearing.report.words import (
    quantity as quantity_words,
)
from thermobearing.results.directory import BEARINGS, RESOLVED
from thermobearing.results.saved import SavedResult
from thermobearing.structure.report import structure_table
from thermobearing.tables.text import read_text

Summary = Mapping[str, Any]
LINES = Quantity("Lines", name="group")
Names = list[str | Quantity]


def build_pieces(saved: SavedResult) -> Pieces:
    """Return everything that the document of a design, of factors or of bounds says."""
    kinds = {"lambda": _factors_pieces, "bounds": _bounds_pieces}
    return kinds.get(saved.command, _design_pieces)(saved)


BOUNDS_CAPTIONS = {
    "bounds": "Demands of the two bounds and of the coupled model, and their envelope."
}
DEMANDS = {  # words, unit, factor
    "bearing_strain_max": ("shear strain", "%", 100.0),
    "bearing_force_max_kN": ("force of one bearing", "kN", 1.0),
    "pier_displacement_max_mm": ("pier top", "mm", 1.0),
    "deck_acceleration_max_m_s2": ("deck acceleration", "m/s²", 1.0),
}


def _bounds_pieces(saved: SavedResult) -> Pieces:
    """Return the document of `bounds`."""
    summary = saved.summary
    inputs = summary["inputs"]
    names, rows = list(summary["rows"]), summary.get("tested_range", [])
    words = [bearing_words(one["bearing"]) for one in inputs.values()]
    motions = dict.fromkeys(str(r["motion"]) for table in summary["rows"].values() for r in table)
    first: Summary = next(iter(inputs.values()))
    airs = degrees([float(str(air).split()[0]) for air in first["ambient"]])
    return content.build_pieces(
        "bounds",
        f"Bounding analyses on {summary['structure']}",
        f"Is it enough to run {summary['structure']} twice, with a lower and an upper bilinear "
        f"model of {joined(words, 'or')}, instead of the coupled model at {airs}, under "
        f"{joined(motions)}?",
        _bounds_answer(summary),
        inputs=_bounds_inputs(inputs),
        tables={"demands": _demands_table(summary)},
        figures=content.saved_figures(saved, BOUNDS_CAPTIONS),
        checks=content.limit_checks(
            rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of the bearing", names
        ),
        rate_rows=rows,
        assumptions=_assumptions(first, [one["bearing"] for one in inputs.values()]),
        **content.saved_parts(saved, "thermobearing.design.run_bounds(...) in Python"),
    )


def _bounds_answer(summary: Mapping[str, Any]) -> list[str]:
    """Return how many demands are unsafe, and the worst of them."""
    rows = [(name, row) for name, table in summary["rows"].items() for row in table]
    early = []
    if summary["outcome"] != "completed":
        sentence = tidy(str(summary.get("sentence", "")))
        early = [f"Not every run came to its end ({summary['outcome']}): {sentence}"]
    verdicts = [row["verdict"] for _, row in rows]
    unsafe, wasteful = verdicts.count("unsafe"), verdicts.count("wasteful")
    name, least = min(rows, key=lambda pair: pair[1]["envelope_over_coupled"])
    what = DEMANDS.get(least["demand"], (least["demand"],))[0]
    first = (
        f"Of {counted(len(rows), 'demand')}, {unsafe} are unsafe (below 0.95 of the coupled "
        f"model) and {wasteful} wasteful (above 1.3)."
    )
    second = (
        f"The least safe is the {what} of {name} under {least['motion']}: the envelope of the "
        f"bounds gives {least['envelope_over_coupled']:.2f} of what the coupled model gives at "
        f"{degrees([least['coupled_at_degC']])}."
    )
    return [*early, first, second]


def _demands_table(summary: Summary) -> Table:
    """Return a row for each bearing, motion and demand."""
    frame = pd.DataFrame(
        [{"bearing": name} | row for name, table in summary["rows"].items() for row in table]
    )
    shown = [DEMANDS.get(name, (name, "", 1.0)) for name in frame["demand"]]
    frame["demand"], frame["unit"], factors = map(list, zip(*shown, strict=True))
    for name in ("lower_bound", "upper_bound", "coupled_max"):
        frame[name] *= factors
    names: Names = ["bearing", "motion", "demand", Quantity("Unit", name="unit"), "part"]
    keys = 4 + ("part" in frame)
    names += ["lower_bound", "upper_bound", "coupled_max", "coupled_at_degC"]
    names += ["envelope_over_coupled", "verdict"]
    beyond = [bool(str(text or "")) for text in frame["beyond_tested"]]
    note = "unsafe: envelope below 0.95 of the coupled model; wasteful: above 1.3."
    note += f" {content.MARKED} (some run of that motion)." * any(beyond)
    caption = "Bounds compared with the coupled model"
    return make_table(frame, names, caption, keys=keys, marked={"motion": beyond}, note=note)


def _bounds_inputs(inputs: Summary) -> dict[str, Table]:
    """Return structure, motions, bearings, model."""
    found: dict[str, Table] = {}
    for one in inputs.values():
        found.setdefault("structure", structure_table(one["structure"]))
        found.setdefault("motions", given_motions_table(one["motions"]))
        found |= bearing_tables(one["bearing"], one["sources"])
        for bound in one.get("bounds", []):
            found |= bearing_tables(bound, otherwise="equal peak force and loop area")
        found["analysis"] = analysis_table(one["analysis"], EarthquakeAnalysis())
    return found


def _assumptions(first: Mapping[str, Any], bearings: list[Mapping[str, Any]]) -> list[str]:
    """Return how the bounds are made, and what holds for the coupled runs."""
    airs = [float(str(air).split()[0]) for air in first["ambient"]]
    found = (
        f"The bounds are bilinear models of the bearing soaked at {degrees([max(airs)])} (lower) "
        f"and {degrees([min(airs)])} (upper): equal peak force and loop area in the third cycle at "
        f"{percent(float(first['strain']))} shear strain."
    )
    analysis = first["analysis"]
    how = (
        f"Time integration: {analysis['method'].replace('-', ' ')}, steps of at most "
        f"{quantity_words(analysis['dt'])}; bodies are rigid and move in one direction."
    )
    return [found, how, *model_assumptions(analysis, bearings)]


FACTORS_CAPTIONS = {
    "factors": "Factors of stiffness, strength and energy, compared with published ones.",
    "scale": "Rise of temperature, and loops, of the bearing at its own and at another size.",
}
QUANTITIES = ("K_eq", "Q_d", "K_d", "energy", "h_eq")


def _factors_pieces(saved: SavedResult) -> Pieces:
    """Return the document of `lambda`."""
    summary = saved.summary
    name, table = str(summary["bearing"]), summary["inputs"]["bearing"]
    airs = sorted({float(row["ambient_degC"]) for row in summary["factors"]})
    strains = sorted({float(row["strain"]) for row in summary["factors"]})
    reference = degrees([summary["reference_degC"]])
    rows = summary.get("tested_range", [])
    return content.build_pieces(
        "lambda",
        f"Temperature factors of {name}",
        f"By which factors do stiffness, strength and energy of "
        f"{bearing_words(table)} change, from {reference} to {degrees(airs)}, "
        f"at {joined(percent(s) for s in strains)} shear strain ({summary['motion']}, cycles "
        f"{summary['cycles']})?",
        _factors_answer(summary),
        inputs=bearing_tables(table, summary["inputs"]["sources"]),
        tables=_factor_tables(summary),
        figures=content.saved_figures(saved, FACTORS_CAPTIONS),
        checks=content.limit_checks(rows, content.TESTS, f"{content.TESTED_RANGE} of {name}"),
        assumptions=[
            f"Every test begins with the bearing at the temperature of the air throughout; "
            f"factors are over {reference}.",
            *model_assumptions({}, [table]),
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
    ]


def _factor_tables(summary: Summary) -> dict[str, Table]:
    """Return factors with a column for each temperature, bounds, published factors."""
    rows = summary["factors"]
    airs = sorted({float(row["ambient_degC"]) for row in rows})
    bands = any(row.get("factor_low") is not None for row in rows)
    lines: dict[tuple[Any, ...], dict[float, Any]] = {}
    values: dict[tuple[Any, ...], float] = {}
    for row in rows:
        unit, factor = printed_unit(str(row["unit"]))
        key = (100.0 * row["strain"], row["basis"], row["quantity"], unit)
        lines.setdefault(key, {})[float(row["ambient_degC"])] = row
        if row["ambient_degC"] == summary["reference_degC"]:
            values[key] = factor * row["value"]
    reference = degrees([summary["reference_degC"]])
    columns = [quantity("strain", form="g"), *map(Quantity, ("Cycle", "Quantity", "Unit"))]
    columns.append(Quantity(f"Value at {reference}", form=".3g"))
    columns += [Quantity(f"Factor at {degrees([air])}", form=".2f") for air in airs]
    cells: list[list[Any]] = []
    marked: set[tuple[int, int]] = set()
    for at, (key, found) in enumerate(lines.items()):
        each = [found.get(air) for air in airs]
        cells.append([*key, values.get(key), *(one and _cell(one) for one in each)])
        marked |= {
            (at, 5 + place)
            for place, one in enumerate(each)
            if one is not None and "ambient" in str(one.get("beyond_tested") or "").split()
        }
    note = "first: the first cycle; heated: the last cycle, after self-heating; mean: the mean of "
    note += (
        "the cycles."
        + " In brackets: band over the samples." * bands
        + f" {content.MARKED}." * bool(marked)
    )
    caption = f"Temperature factors over {reference}"
    ratio = summary["stiffness_ratio"]
    bounds_note = f"K_2/K_1 = {ratio['K_2_over_K_1']:g}: {ratio['source']}. {BOUNDS_NOTE}."
    names: Names = [Quantity("Bound", name="bound"), quantity("strain", form="g")]
    names += [Quantity("Cycle", name="basis"), "ambient_degC"]
    names += ["Q_d_kN", "K_1_kN_mm", "K_2_kN_mm", "Q_y_kN"]
    bounds = pd.DataFrame(summary["bounds"])
    tables = {
        "factors": Table(caption, columns, cells, 4, frozenset(marked), note),
        "bounds": make_table(
            bounds, names, "Lower and upper bilinear model", keys=4, note=bounds_note
        ),
    }
    if summary.get("coldest_day"):
        words = [[tidy(text)] for text in summary["coldest_day"]]
        note = f"{FOOTNOTE}." if any("*" in text for (text,) in words) else ""
        caption = "The coldest day, compared with published factors"
        tables["coldest"] = Table(caption, [Quantity("Factors")], words, note=note)
    if summary["codes"]:
        codes = pd.DataFrame(summary["codes"])
        names = [Quantity(name.capitalize(), name=name) for name in ("code", "provision", "source")]
        unverified = codes["unverified"]
        note = f"{FOOTNOTE}."
        if not unverified.all():
            codes["code"] += np.where(unverified, "*", "")
        elif len(codes):
            note = "None of these provisions was verified against the text of the code."
        codes = codes.rename(columns={"says": "provision"})
        tables["codes"] = make_table(codes, names, "Provisions of codes", note=note)
    return tables


def _cell(row: Mapping[str, Any]) -> Any:
    """Return a factor, with its band where there is one."""
    low, high = row.get("factor_low"), row.get("factor_high")
    if low is None or high is None or not np.isfinite([low, high]).all():
        return row["factor"]
    return f"{row['factor']:.2f} ({low:.2f}–{high:.2f})"


CAPTIONS = {
    "rounds": "Assumed and found displacement of each round of the design.",
    "equal": "Loops of the bilinear bearing and of layered ones of the same stiffness.",
}
ROUNDS = (
    *("round", LINES, "u_B_assumed_mm", "side_mm", "layers", "layer_thickness_mm", "K_B_kN_mm"),
    *("h_B", "Q_d_kN", "K_1_kN_mm", quantity("K_2_kN_mm", form=".2f"), "u_found_mm"),
    *("difference", quantity("pier_ductility", head="Pier ductility")),
)


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
        f"Which bearing does {summary['structure']} need, so that the displacement that was "
        f"assumed is the one that a dynamic analysis finds, under {joined(motions)}; and what do "
        "layered bearings of the same stiffness do, at every temperature?",
        _design_answer(summary),
        inputs=_design_inputs(saved, case),
        tables=_design_tables(summary),
        figures=content.saved_figures(saved, CAPTIONS),
        checks=_design_checks(summary),
        rate_rows=summary.get("tested_range", []),
        assumptions=[
            "The rounds run with a bilinear bearing, independent of temperature and rate; layered "
            "bearings are judged after them.",
            f"Of several motions counts {summary['peaks']['says']} ({summary['peaks']['source']}).",
            f"Sources of limits, {FOOTNOTE}.",
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
    first = f"The design is {found}" if usable else f"There is no design; the last round: {found}"
    cold = [tidy(text.replace("%", " %")) for text in summary.get("coldest_day", [])]
    second = " ".join(cold) or "No layered bearing was judged at other temperatures."
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
        found |= bearing_tables(table, sources, otherwise="this design")
    if "analysis" in case:
        found["analysis"] = analysis_table(case["analysis"], EarthquakeAnalysis())
    return found


def _design_tables(summary: Summary) -> dict[str, Table]:
    """Return rounds, equal bearings, every temperature."""
    rounds = pd.DataFrame(summary["rounds"])
    several = "group" in rounds
    note = f"Round {summary['chosen_round']} was taken."
    caption = "Rounds of the design"
    found = {"rounds": make_table(rounds, ROUNDS, caption, keys=1 + several, note=note)}
    names: Names
    if summary["equal"]:
        names = [Quantity("Bearing", name="name"), LINES, "K_eq_kN_mm", "h_eq"]
        caption = "Layered bearings of the same stiffness, third cycle at the design displacement"
        found["equal"] = make_table(pd.DataFrame(summary["equal"]), names, caption)
    if summary["temperatures"]:
        names = ["bearing", LINES, "ambient_degC", *JUDGED.values()]
        names += [quantity("pier", head="Governing pier"), "verdict", "fails"]
        frame = pd.DataFrame(summary["temperatures"])
        caption = "Layered bearings at every temperature"
        found["temperatures"] = make_table(
            frame, names, caption, keys=2 + several, drop_empty=False
        )
    return found


def _design_checks(summary: Summary) -> list[Check]:
    """Return the calculation sheet, and the tested ranges."""
    found = []
    for one in summary["checks"]:
        unit, factor = printed_unit(str(one["unit"]))
        if one["what"].endswith("strain"):
            unit, factor = "%", 100.0
        of = f", {one['part']}" if one.get("part") else ""
        value, limit = (factor * float(one[key]) for key in ("value", "limit"))
        source = f"{one['source']}{'*' if one.get('unverified') else ''}"
        verdict = PASSED if one["verdict"] == "OK" else EXCEEDED
        what = f"{one['what']}{of}"
        found.append(Check(what, value, limit, unit, source, verdict, bool(one["least"])))
    for row in summary["temperatures"]:
        failed = f": {row['fails']}" if row["fails"] else ""
        name = of_group(row["bearing"], row.get("group", ""))
        what = f"{name} at {degrees([row['ambient_degC']])}{failed}"
        verdict = PASSED if row["verdict"] == "OK" else EXCEEDED
        source = "limits of the design, for layered bearings"
        found.append(Check(what, np.nan, np.nan, "", source, verdict))
    names = [*np.atleast_1d(summary["bearing"]), *(str(one["name"]) for one in summary["equal"])]
    rows = summary.get("tested_range", [])
    return found + content.limit_checks(
        rows, content.IN_EARTHQUAKES, f"{content.TESTED_RANGE} of the bearing", names
    )
