"""What the document of bounding analyses beside the coupled model says."""

from collections.abc import Mapping
from typing import Any

from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.earthquake.case import EarthquakeAnalysis
from thermobearing.earthquake.report_inputs import given_motions_table
from thermobearing.report.limits import IN_EARTHQUAKES, MARKED, TESTED_RANGE, limit_checks, verdict
from thermobearing.report.pieces import Column, Pieces, ReportTable
from thermobearing.report.saved import saved_figures, saved_identity, saved_validity
from thermobearing.report.words import counted, degrees, joined, percent, quantity, tidy
from thermobearing.results.ranges import rate_note
from thermobearing.results.saved import SavedResult
from thermobearing.structure.report import structure_table

CAPTIONS = {"bounds": "Demands of the two bounds and of the coupled model, and their envelope."}
DEMANDS = {
    "bearing_strain_max": ("shear strain", "%", 100.0, ".0f"),
    "bearing_force_max_kN": ("force of one bearing", "kN", 1.0, ".0f"),
    "pier_displacement_max_mm": ("pier top", "mm", 1.0, ".1f"),
    "deck_acceleration_max_m_s2": ("deck acceleration", "m/s²", 1.0, ".2f"),
}


def bounds_pieces(saved: SavedResult) -> Pieces:
    """Of `bounds`.

    Parameters
    ----------
    saved : as `load_result` gives it.
    """
    summary = saved.summary
    validity, unknown, warnings = saved_validity(saved)
    told = {name: one for name, one in (summary.get("inputs") or {}).items() if one}
    names, rows = list(summary["rows"]), summary.get("tested_range", [])

    def bearing_of(run: str) -> str:
        return next((name for name in names if run.startswith(f"{name}, ")), "")

    checks = limit_checks(rows, IN_EARTHQUAKES, f"{TESTED_RANGE} of the bearing", bearing_of)
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
        answer=[*_answer(summary), verdict(checks, validity, unknown, rate)],
        inputs=_inputs(told),
        tables={"demands": _table(summary)},
        figures=saved_figures(saved, CAPTIONS),
        checks=checks,
        validity=validity,
        notes=[tidy(f"{rate[:1].upper()}{rate[1:]}")] if rate else [],
        validity_unknown=unknown,
        assumptions=_assumptions(first, [one["bearing"] for one in told.values()]),
        warnings=warnings,
        identity=saved_identity(saved, "thermobearing.design.run_bounds(...) in Python"),
    )


def _answer(summary: Mapping[str, Any]) -> list[str]:
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
