"""Content of the report of a sequence, from its saved result."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import thermobearing
from thermobearing import reported
from thermobearing.border.lazy import pd
from thermobearing.cyclic.dataset import written_part
from thermobearing.cyclic.report import rig_table, words_of_test
from thermobearing.cyclic.result import Result
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import change, counted, identity_rows, number, quantity, tidy
from thermobearing.report import content
from thermobearing.report.figures import plot_from_axes
from thermobearing.report.pieces import Check, Pieces, ReportFigure
from thermobearing.results import drawing
from thermobearing.results.metrics import BALANCE
from thermobearing.sequences.case import SequenceAnalysis
from thermobearing.sequences.result import SequenceResult
from thermobearing.structure.report import structure_table

BETWEEN = {  # the rig, after each part
    "unloaded": "After each part the specimen is unloaded to zero force and its instruments are "
    "zeroed there; the rubber and the lead keep their force in a rest.",
    "as-left": "After each part the specimen is held at its displacement and force: neither Z nor "
    "the force of lead relaxes in a rest, so the next part begins with an offset.",
}
Case = Mapping[str, Any]
KJ = 1e-3
BALANCE_NOTE = (
    "Specimen, since the start of each part: work in = heat released + recoverable; heat released "
    "= stored + lost."
)


def build_pieces(result: SequenceResult) -> Pieces:
    """Return the content of the report of a sequence."""
    parts = [written_part(p) if isinstance(p, Result) else p for p in result.parts]
    result = SequenceResult(result.case, parts, interrupted=result.interrupted)
    text = result.case.to_toml()
    case = tomllib.loads(text)
    version = parts[0].dataset.attrs["version"] if parts else thermobearing.__version__
    return content.build_pieces(
        "sequence",
        f"Sequence of tests on {case['bearing']['name']}: {case['name']}",
        _question(case),
        _answer(result),
        identity=identity_rows(str(version), text, "thermobearing sequence case.resolved.toml"),
        warnings=result.warnings,
        checks=_checks(result, case),
        residuals=reported.residual_rows(_energies(result), case["analysis"]) if parts else [],
        inputs=_inputs(result, case),
        tables=result.tables(),
        figures=_figures(result) if parts else {},
        energy=(
            make_table(
                _energies(result), caption="Energy balance of the specimen", note=BALANCE_NOTE
            )
            if parts
            else None
        ),
        assumptions=[
            "All parts use the same specimen: each begins with the temperatures and the history "
            "variables of rubber and lead at the end of the previous one.",
            BETWEEN[str(case["between"])],
            "Hybrid parts begin with the structure undeformed, at rest and in equilibrium.",
            *reported.model_assumptions(case["analysis"], [case["bearing"]]),
        ],
    )


def _question(case: Case) -> str:
    parts = [f"{k}. {_words_of_part(part)}" for k, part in enumerate(case["parts"], 1)]
    return (
        f"This report gives the response of {reported.bearing_words(case['bearing'])} in a "
        f"sequence of tests on one specimen at ambient temperature {quantity(case['ambient'])}. "
        f"{'; '.join(parts)}."
    )


def _words_of_part(part: Case) -> str:
    kind = str(part["part"])
    name = str(part.get("name") or kind)
    ambient = f" at {quantity(part['ambient'])}" if "ambient" in part else ""
    if kind == "cyclic":
        return f"{name}: {words_of_test(part)}{ambient}"
    if kind == "rest":
        if "duration" in part:
            return f"{name}: rest of {quantity(part['duration'])}{ambient}"
        within = f"within {quantity(part['within'])} of the ambient temperature"
        return f"{name}: rest until {within}{ambient}"
    motion = Path(part["motion"]["name"]).name
    return f"{name}: hybrid test of {part['structure']['name']} under {motion}{ambient}"


def _answer(result: SequenceResult) -> list[str]:
    if not result.parts:
        return [f"No part was finished: {tidy(result.sentence)}"]
    part = f" in part {len(result.parts)} of {len(result.case.parts)}"
    early = reported.early_end("The sequence", part, result)
    table, rubber = result.table, result.case.bearing.total_rubber_thickness
    force = table[["force_max_kN", "force_min_kN"]].abs().max(axis=1)
    displacement = table["displacement_max_mm"]
    force_row, displacement_row = place_of_largest(force), place_of_largest(displacement)
    percent = 100.0 * displacement[displacement_row] / rubber
    governing = (
        f"Of {counted(len(table), 'part')}, the largest force is "
        f"{number(force[force_row], '.4g')} kN ({table['part'][force_row]}) and the largest shear "
        f"strain {percent:.0f} % ({table['part'][displacement_row]}); the specimen takes "
        f"{KJ * table['energy_kN_mm'].sum():.1f} kJ."
    )
    return [*early, governing, _memory(table, force)]


def _memory(table: "pd.DataFrame", force: "pd.Series[Any]") -> str:
    """Return the effect of earlier parts: first and last hybrid test, and warming."""
    words = []
    hybrid = table[table["kind"] == "hybrid"]
    if len(hybrid) > 1:
        first, last = hybrid.iloc[0], hybrid.iloc[-1]
        stiffer = force[hybrid.index[-1]] / force[hybrid.index[0]]
        strain = last["displacement_max_mm"] / first["displacement_max_mm"]
        words.append(
            f"{last['part']} compared with {first['part']}: "
            f"force {change(stiffer, 'more', 'less')}, "
            f"displacement {change(strain, 'more', 'less')}"
        )
    ends = [name for name in map(str, table) if name.endswith("_end_degC")]
    layers = [name for name in ends if name.startswith("rubber")]
    stems = {layers[-1].removesuffix("_end_degC"): "innermost rubber"} if layers else {}
    for stem, part_name in (stems | {"lead": "lead"}).items():
        if f"{stem}_end_degC" in table:
            start, end = (table[f"{stem}_{name}_degC"].to_numpy() for name in ("start", "end"))
            warmest = place_of_largest(end - start)
            words.append(
                f"the {part_name} warms most in {table['part'][warmest]}, from "
                f"{number(start[warmest])} to {number(end[warmest])} °C"
            )
    text = "; ".join(words) or "temperatures were not stored"
    return tidy(f"{text[:1].upper()}{text[1:]}")


def _energies(result: SequenceResult) -> "pd.DataFrame":
    """Return the energy balance of the specimen in each part [kN mm]."""
    names = [*(f"{name}_kN_mm" for name in BALANCE), "mechanical_residual", "thermal_residual"]
    rows = [
        part.energy.iloc[0].rename(lambda name: name.removeprefix("bearing_"))[names]
        for part in result.parts
    ]
    frame = pd.DataFrame(rows, index=range(len(rows)), dtype=float)
    frame.insert(0, "part", [result.case.label(k) for k in frame.index])
    return frame


def _checks(result: SequenceResult, case: Case) -> list[Check]:
    def _rows(table: "pd.DataFrame") -> list[dict[Any, Any]]:
        return [row | {"run": row["part"]} for row in table.to_dict("records")]

    rig = str(case.get("rig", {}).get("name", "rig"))
    hybrid = {result.case.label(k) for k, p in enumerate(result.parts) if not isinstance(p, Result)}
    checks = content.limit_checks(_rows(result.rig), content.RIG, f"rig {rig}")
    tested = _rows(result.tested_range)
    # As of earthquakes, the strain rates of hybrid parts are no limit (`content.IN_EARTHQUAKES`).
    tested = [r for r in tested if r["limit"] != "strain_rate" or r["run"] not in hybrid]
    source = f"{content.TESTED_RANGE} of {case['bearing']['name']}"
    return checks + content.limit_checks(tested, content.TESTS, source)


def _inputs(result: SequenceResult, case: Case) -> dict[str, Table]:
    file_sources: dict[str, dict[str, str]] = {}  # sources of numbers in files of parts
    for part in result.parts:
        file_sources |= tomllib.loads(part.dataset.attrs["case"]).get("sources", {})
    rows = []
    for k, part in enumerate(case["parts"], 1):
        step = quantity(part["dt"]) if "dt" in part else ""
        rows.append((k, _words_of_part(part), quantity(part.get("ambient", case["ambient"])), step))
    heads = ("Test", "Ambient", "Time step")
    columns = (Quantity("Part", form="d"), *(Quantity(head) for head in heads))
    tables = {"sequence": Table(f"Sequence: {case['name']}", columns, rows)}
    tables |= reported.bearing_tables(
        case["bearing"], file_sources.get(str(case["bearing"]["name"]))
    )
    for part in case["parts"]:
        if "structure" in part:
            name = str(part["structure"]["name"])
            tables.setdefault(
                f"structure.{name}", structure_table(part["structure"], file_sources.get(name))
            )
    if "rig" in case:
        tables["rig"] = rig_table(case["rig"], file_sources.get(case["rig"].get("name")))
    tables["analysis"] = reported.analysis_table(case["analysis"], SequenceAnalysis())
    return tables


def _figures(result: SequenceResult) -> dict[str, ReportFigure]:
    captions = content.figure_captions("sequence")
    labels = [result.case.label(k) for k in range(len(result.parts))]
    with drawing.every_point():
        axes = result.plot.sequence().axes
    loops, temperatures = (
        plot_from_axes(dict(zip(labels, row, strict=True)))
        for row in (axes[: len(labels)], axes[len(labels) :])
    )
    figures = {
        "sequence": ReportFigure(captions["sequence"], draw=result.plot.sequence, plot=loops)
    }
    if temperatures.choices:
        figures["temperatures"] = ReportFigure(captions["temperatures"], plot=temperatures)
    return figures
