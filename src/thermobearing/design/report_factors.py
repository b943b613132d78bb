"""What the document of temperature factors says."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.cyclic.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.design.bilinear import BOUNDS_NOTE
from thermobearing.design.published import FOOTNOTE
from thermobearing.report.limits import MARKED, TESTED_RANGE, TESTS, limit_checks, verdict
from thermobearing.report.pieces import Column, Pieces, ReportTable
from thermobearing.report.saved import saved_figures, saved_identity, saved_validity
from thermobearing.report.words import degrees, joined, percent, printed_unit, tidy
from thermobearing.results.saved import SavedResult

CAPTIONS = {
    "factors": "Temperature factors of stiffness, strength and energy, beside published ones.",
    "scale": "Rise of temperature, and loops, of the bearing at its own and at another size.",
}
QUANTITIES = ("K_eq", "Q_d", "K_d", "energy", "h_eq")


def factors_pieces(saved: SavedResult) -> Pieces:
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
        answer=[*_answer(summary), verdict(checks, validity, unknown)],
        inputs=bearing_tables(table, told.get("sources")) if table else {},
        tables=_tables(summary),
        figures=saved_figures(saved, CAPTIONS),
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


def _answer(summary: Mapping[str, Any]) -> list[str]:
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
