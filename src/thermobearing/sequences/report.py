"""What the document of a sequence says, from a result as it is loaded again."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.cyclic.dataset import written_part
from thermobearing.cyclic.report import rig_table, words_of_test
from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.cyclic.result import Result
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.report.content import (
    BOOKS_CLOSE,
    MARKED,
    RIG,
    TESTED_RANGE,
    TESTS,
    limit_checks,
    quality_table,
    verdict,
)
from thermobearing.report.figures import history, path
from thermobearing.report.pieces import (
    Check,
    Column,
    Pieces,
    Plot,
    ReportFigure,
    ReportTable,
    Trace,
)
from thermobearing.report.words import (
    change,
    counted,
    identity_rows,
    joined,
    number,
    quantity,
    tidy,
)
from thermobearing.results.drawing import INK, ordered_colours
from thermobearing.results.ranges import TESTED, parted
from thermobearing.sequences.case import SequenceAnalysis
from thermobearing.sequences.result import SequenceResult
from thermobearing.structure.report import structure_table

BETWEEN = {  # the rig, after each part
    "unloaded": "After each part the specimen is unloaded to zero force and its instruments are "
    "zeroed there; neither Z nor the force of lead relaxes in a rest.",
    "as-left": "After each part the specimen is held where it is, with its force: neither Z nor "
    "the force of lead relaxes in a rest, so that the next part begins with an offset.",
}
Case = Mapping[str, Any]
KJ = 1e-3
PART = Column("Part")


def build_pieces(result: SequenceResult) -> Pieces:
    """Everything that the document of a sequence says.

    Parameters
    ----------
    result : of `sequence`, or loaded again: both give the same.
    """
    parts = [written_part(p) if isinstance(p, Result) else p for p in result.parts]
    result = SequenceResult(result.case, parts, interrupted=result.interrupted)
    text = result.case.to_toml()
    case = tomllib.loads(text)
    found, warnings = parted(result.warnings)
    given = case["bearing"].get("tested_range") is not None
    validity = [tidy(words) for words in found] if given else []
    unknown = "" if given else " ".join(map(tidy, dict.fromkeys(found)))
    checks = report_checks(result, case) if parts else []
    tables = {"parts": parts_table(result)} if parts else {}
    poor: list[str] = []
    if parts:
        tables["quality"], poor = quality_of(result, case)
    return Pieces(
        command="sequence",
        title=f"Sequence of tests on {case['bearing']['name']}: {case['name']}",
        question=question(result, case),
        answer=answer(result, verdict(checks, validity, unknown)),
        inputs=input_tables(result, case),
        tables=tables,
        figures=report_figures(result) if parts else {},
        checks=checks,
        validity=validity,
        validity_unknown=unknown,
        books=books_table(result) if parts else None,
        assumptions=[
            "One specimen goes through all parts: each begins with the temperatures and the memory "
            "of rubber and lead that the one before left.",
            BETWEEN[str(case["between"])],
            "Hybrid parts begin with the structure straight, at rest and in balance.",
            *model_assumptions(case["analysis"], [case["bearing"]]),
        ],
        warnings=[*poor, *(tidy(words) for words in warnings)],
        identity=identity_rows(
            thermobearing.__version__ if not parts else str(parts[0].dataset.attrs["version"]),
            text,
            "thermobearing sequence case.resolved.toml",
        ),
    )


def question(result: SequenceResult, case: Case) -> str:
    """What was asked: specimen, parts, air."""
    told = [f"{k}. {_words_of_part(part)}" for k, part in enumerate(case["parts"], 1)]
    return (
        f"What does {bearing_words(case['bearing'])} do in these tests, one after the other on one "
        f"specimen at ambient {quantity(case['ambient'])}? {'; '.join(told)}."
    )


def _words_of_part(part: Case) -> str:
    """A part in words."""
    kind = str(part["part"])
    name = str(part.get("name") or kind)
    air = f" at {quantity(part['ambient'])}" if "ambient" in part else ""
    if kind == "cyclic":
        return words_of_test({"name": name, "steps": part["steps"]}) + air
    if kind == "rest":
        if "duration" in part:
            return f"{name}: rest of {quantity(part['duration'])}{air}"
        return f"{name}: rest until within {quantity(part['within'])} of the air{air}"
    motion = Path(part["motion"]["name"]).name
    return f"{name}: hybrid test of {part['structure']['name']} under {motion}{air}"


def answer(result: SequenceResult, told: str) -> list[str]:
    """What governs, what the parts before change, whether limits were kept."""
    if not result.parts:
        return [f"No part was finished: {tidy(result.sentence)}"]
    early = []
    if result.outcome != "completed":
        early = [
            f"The sequence ended early in part {len(result.parts)} of {len(result.case.parts)} "
            f"({result.outcome.replace('_', ' ')}), and what follows is what had been computed "
            f"until then: {tidy(result.sentence)}"
        ]
    return [*early, _governing(result), _memory(result), told]


def _governing(result: SequenceResult) -> str:
    """Largest force and strain, and their parts."""
    table = result.table
    force = np.abs(table[["force_max_kN", "force_min_kN"]].to_numpy()).max(axis=1)
    far = table["displacement_max_mm"].to_numpy()
    rubber = result.case.bearing.total_rubber_thickness
    pushed, moved = int(force.argmax()), int(far.argmax())
    return (
        f"Of {counted(len(table), 'part')}, the largest force is {number(force[pushed], '.4g')} kN "
        f"({table['part'][pushed]}) and the largest shear strain {100.0 * far[moved] / rubber:.0f} "
        f"% ({table['part'][moved]}); the specimen takes {KJ * table['energy_kN_mm'].sum():.1f} kJ."
    )


def _memory(result: SequenceResult) -> str:
    """What earlier parts change: equal kinds beside each other, and warming."""
    table = result.table
    told = []
    hybrid = table[table["kind"] == "hybrid"]
    if len(hybrid) > 1:
        first, last = hybrid.iloc[0], hybrid.iloc[-1]
        force = max(last["force_max_kN"], -last["force_min_kN"])
        force /= max(first["force_max_kN"], -first["force_min_kN"])
        strain = last["displacement_max_mm"] / first["displacement_max_mm"]
        told.append(
            f"{last['part']} against {first['part']}: force {change(force, 'more', 'less')}, "
            f"displacement {change(strain, 'more', 'less')}"
        )
    names = [n for n in map(str, table) if n.endswith("_start_degC")]
    for stem, what in ((_inner(names), "innermost rubber"), ("lead", "lead")):
        if f"{stem}_end_degC" in table:
            start, end = (table[f"{stem}_{name}_degC"].to_numpy() for name in ("start", "end"))
            most = int((end - start).argmax())
            told.append(
                f"the {what} warms most in {table['part'][most]}, from {number(start[most])} to "
                f"{number(end[most])} °C"
            )
    text = "; ".join(told) or "temperatures were not kept"
    return tidy(f"{text[:1].upper()}{text[1:]}")


def _inner(names: list[str]) -> str:
    rubber = [name for name in names if name.startswith("rubber")]
    return rubber[-1].removesuffix("_start_degC") if rubber else "rubber"


def parts_table(result: SequenceResult) -> ReportTable:
    """A row a part: what it reached, and the temperatures at its ends."""
    table, rubber = result.table, result.case.bearing.total_rubber_thickness
    stems = [_inner([n for n in map(str, table) if n.endswith("_start_degC")]), "lead"]
    stems = [stem for stem in stems if f"{stem}_end_degC" in table]
    columns = [
        PART,
        Column("Kind"),
        Column("Ambient", "°C", "g"),
        Column("Duration", "s", ".1f"),
        Column("Displacement", "mm", ".1f"),
        Column("Strain", "%", ".0f"),
        Column("Largest force", "kN", ".1f"),
        Column("Least force", "kN", ".1f"),
        Column("Energy", "kJ", ".2f"),
    ]
    for stem in stems:
        name = "Inner rubber" if stem.startswith("rubber") else "Lead"
        columns += [Column(f"{name}: start", "°C", ".1f"), Column("end", "°C", ".1f")]
    ended = (table["outcome"] != "completed").any()
    columns += [Column("Ended")] if ended else []
    places = {"ambient": 2, "strain": 5}
    if "lead" in stems:
        places["lead_temperature"] = len(columns) - 1 - int(ended)
    rows: list[list[Any]] = []
    marked: set[tuple[int, int]] = set()
    others: set[str] = set()
    for row in table.to_dict("records"):
        cells = [
            row["part"],
            row["kind"],
            row["ambient_degC"],
            row["duration_s"],
            row["displacement_max_mm"],
            100.0 * row["displacement_max_mm"] / rubber,
            row["force_max_kN"],
            row["force_min_kN"],
            KJ * row["energy_kN_mm"],
        ]
        for stem in stems:
            cells += [row[f"{stem}_start_degC"], row[f"{stem}_end_degC"]]
        cells += [row["outcome"].replace("_", " ")] if ended else []
        for limit in str(row["beyond_tested"]).split():
            marked.add((len(rows), places.get(limit, 0)))
            others |= {TESTED[limit][1]} - {TESTED[k][1] for k in places}
        rows.append(cells)
    note = f"{MARKED}{f' (a part: {joined(sorted(others))})' if others else ''}." if marked else ""
    return ReportTable("Parts of the sequence", columns, rows, 1, frozenset(marked), note)


def books_table(result: SequenceResult) -> ReportTable:
    """Energy books of the specimen in each part."""
    names = ("work_in", "heat_released", "recoverable", "heat_stored")
    lost = ("heat_lost_ends", "heat_lost_sides")
    columns = [
        PART,
        *(Column(n.replace("_", " ").capitalize(), "kJ", ".2f") for n in (*names, *lost)),
        Column("Residual, mechanical", "", ".1e"),
        Column("Residual, thermal", "", ".1e"),
    ]
    rows = []
    for number_, part in enumerate(result.parts):
        book = part.energy.iloc[0]
        before = "" if "work_in_kN_mm" in book else "bearing_"
        values = [KJ * float(book[f"{before}{name}_kN_mm"]) for name in (*names, *lost)]
        residuals = [float(book["mechanical_residual"]), float(book["thermal_residual"])]
        rows.append([result.case.label(number_), *values, *residuals])
    note = "Of the specimen, since the start of each part: work in = heat released + recoverable; "
    note += "heat released = stored + lost."
    return ReportTable("Energy books of the specimen", columns, rows, note=note)


def report_checks(result: SequenceResult, case: Case) -> list[Check]:
    """Return the checks of rig and tested range: the part that goes farthest."""
    rig = str(case.get("rig", {}).get("name", "rig"))

    def rows(table: Any) -> list[dict[Any, Any]]:
        return [{**row, "run": row["part"]} for row in table.to_dict("records")]

    found = limit_checks(rows(result.rig), RIG, f"rig {rig}")
    source = f"{TESTED_RANGE} of {case['bearing']['name']}"
    hybrid = [result.case.label(k) for k, p in enumerate(result.parts) if not isinstance(p, Result)]
    tested = [
        row
        for row in rows(result.tested_range)
        if row["limit"] != "strain_rate" or row["run"] not in hybrid
    ]
    return found + limit_checks(tested, TESTS, source)


def quality_of(result: SequenceResult, case: Case) -> tuple[ReportTable, list[str]]:
    """Return the largest residuals of the energy balance, and warnings of those too large."""
    found = []
    gaps = case["analysis"]["scheme"] == "published"
    for name in ("mechanical", "thermal"):
        worst = max(abs(float(part.energy[f"{name}_residual"].iloc[0])) for part in result.parts)
        limit = float("nan") if gaps and name == "thermal" else BOOKS_CLOSE
        source = "energy balance" if limit == limit else "no limit: this model's books have gaps"
        found.append((f"{name} residual", worst, limit, source))
    return quality_table(found)


def input_tables(result: SequenceResult, case: Case) -> dict[str, ReportTable]:
    """Tables of what went in: parts, specimen, structures, rig, model."""
    own = {name: told for part in result.parts for name, told in _number_sources(part).items()}
    columns = (Column("Part", form="d"), Column("What"), Column("Air"), Column("Step of time"))
    rows = [
        (
            k,
            _words_of_part(part),
            quantity(part.get("ambient", case["ambient"])),
            quantity(part["dt"]) if "dt" in part else "",
        )
        for k, part in enumerate(case["parts"], 1)
    ]
    found = {"sequence": ReportTable(f"Sequence: {case['name']}", columns, rows)}
    found |= bearing_tables(case["bearing"], own.get(str(case["bearing"]["name"])))
    for part in case["parts"]:
        if "structure" in part:
            name = str(part["structure"]["name"])
            found.setdefault(f"structure.{name}", structure_table(part["structure"], own.get(name)))
    if "rig" in case:
        found["rig"] = rig_table(case["rig"], own.get(case["rig"].get("name")))
    found["analysis"] = analysis_table(case["analysis"], SequenceAnalysis())
    return found


def _number_sources(part: Result | EarthquakeResult) -> dict[str, dict[str, str]]:
    """Of the numbers of what a part was made of, where its own files had some."""
    return dict(tomllib.loads(part.dataset.attrs["case"]).get("sources", {}))


def report_figures(result: SequenceResult) -> dict[str, ReportFigure]:
    """Loops and temperatures of every part."""
    loops: dict[str, list[Trace]] = {}
    warm: dict[str, list[Trace]] = {}
    for number_ in range(len(result.parts)):
        frame, name = result.history(number_), result.case.label(number_)
        x, force = (frame[c].to_numpy(dtype=float) for c in ("displacement_mm", "force_kN"))
        loops[name] = [Trace(name, *path(x, force, 1500), INK)]
        places = [str(column) for column in frame if str(column).endswith("_degC")]
        colours = ordered_colours(len(places), "viridis")
        time = frame["time_s"].to_numpy(dtype=float)
        warm[name] = [
            Trace(
                place.removesuffix("_degC").replace("rubber", "layer "),
                *history(time, frame[place].to_numpy(dtype=float)),
                INK if place == "lead_degC" else colour,
                "dashed" if place == "lead_degC" else "line",
            )
            for place, colour in zip(places, colours, strict=True)
        ]
    caption = "Force over displacement, and temperatures in time, a column for each part."
    found = {
        "sequence": ReportFigure(
            caption,
            draw=result.plot.sequence,
            plot=Plot("displacement [mm]", "force [kN]", loops),
        )
    }
    if any(warm.values()):
        found["temperatures"] = ReportFigure(
            "Temperatures of rubber layers and lead in each part.",
            plot=Plot("time [s]", "temperature [°C]", {k: v for k, v in warm.items() if v}),
        )
    return found
