"""What the document of a fit says: what a laboratory signs. From a result as it is loaded."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.identify.report_tables import (
    AT_BOUND,
    NOT,
    POORLY,
    checks_table,
    cycles_table,
    grade,
    held_out_table,
    parameters_table,
    posterior_table,
    records_table,
    relative_error,
    tests_table,
    thermocouples_table,
    treatment_table,
    undetermined_table,
)
from thermobearing.report.limits import verdict_of
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_JUDGED,
    PASSED,
    Check,
    Pieces,
    Plot,
    ReportFigure,
    ReportTable,
    Trace,
)
from thermobearing.report.saved import saved_figures, saved_identity, saved_validity, with_plot
from thermobearing.report.traces import path
from thermobearing.report.words import counted, degrees, joined, number, percent, quantity, tidy
from thermobearing.results.directory import IDENTIFIED
from thermobearing.results.ranges import parted
from thermobearing.results.saved import SavedResult

Summary = Mapping[str, Any]
LOOP_POINTS = 2000  # of a test
POOR = 0.98  # R2 below which a fit is told to be poor, as in identify/agreement.py
UNUSABLE = 0.9
CAPTIONS = {
    "loops": "Measured loops (band) and the fitted model (line) of every test.",
    "cycles": "Measures of each cycle in test and model, with the error of each test.",
    "residuals": "Force of the model less that of the test, sample by sample.",
    "temperatures": "Thermocouples of the tests and the model at their places.",
    "correlation": "Correlation of the estimates.",
    "band": "Prediction: best fit and 95 % band, of loops and of the force at each turn.",
    "held_out_loops": "Loops of the tests that judge the fit, and the model.",
    "held_out_cycles": "Each cycle of the tests that judge the fit: the model off the test.",
    "held_out_ratios": "Largest loop of the tests that judge the fit: the model off the test.",
    "held_out_residuals": "Force of the model less that of the tests that judge the fit.",
    "folds": "Parameters without each group of tests, beside those of all.",
    "convergence": "Best misfit of the search against its evaluations.",
}


def pieces_of(saved: SavedResult) -> Pieces:
    """Everything that the document of a fit, or of a look at tests, says.

    Parameters
    ----------
    saved : of `identify`, as `load_result` gives it.
    """
    summary = saved.summary
    if "parameters" not in summary:
        return _looked_over(saved)
    bearing, sources = bearing_of(saved)
    asked = {**bearing, "name": summary["bearing"]}
    validity, unknown, warnings = saved_validity(saved)
    tests = [str(record["name"]) for record in summary["records"]]
    checks = checks_of(summary)
    return Pieces(
        command="identify",
        title=f"Identification of {summary['bearing']}",
        question=(
            f"Which parameters does the bearing {bearing_words(asked)} have, by "
            f"{counted(len(tests), 'test')} ({joined(tests)}) at "
            f"{degrees([r['ambient_degC'] for r in summary['records']])}, how well are they known, "
            "and how well does the model meet the tests?"
        ),
        answer=[*answer(summary, checks), *_covered(bearing)],
        inputs={
            "tests": tests_table(summary["records"]),
            "treatment": treatment_table(summary["records"]),
            **bearing_tables(bearing, sources),
        },
        tables=tables_of(saved),
        figures=figures_of(saved),
        checks=checks,
        validity=[*validity, *_predicted(summary)],
        validity_unknown=unknown,
        assumptions=assumptions(summary, bearing),
        warnings=warnings,
        identity=saved_identity(saved, "thermobearing.identify_bearing(...) in Python"),
    )


def figures_of(saved: SavedResult) -> dict[str, ReportFigure]:
    """Pictures of the directory; loops of tests and model besides as a plot, one test at a time."""
    found = saved_figures(saved, CAPTIONS)
    names = [str(record["name"]) for record in saved.summary["records"]]
    if "fit" in saved.tables:
        rows = saved["fit"].groupby("record", sort=False)
        choices = {names[int(str(k))]: _loops(mine) for k, mine in rows}
        plot = Plot("displacement [mm]", "force [kN]", choices)
        found = with_plot(found, "loops", plot, CAPTIONS)
    return found


def _loops(rows: pd.DataFrame) -> list[Trace]:
    """Test and model of one record."""
    x = rows["displacement_mm"].to_numpy(dtype=float)
    looks = (("test", "force_kN", "#9aa4b1"), ("model", "model_force_kN", "#CC3311"))
    return [
        Trace(name, *path(x, rows[column].to_numpy(dtype=float), LOOP_POINTS), colour)
        for name, column, colour in looks
    ]


def bearing_of(saved: SavedResult) -> tuple[dict[str, Any], dict[str, str]]:
    """The bearing that was written, and the sources of its numbers; that of a poor fit too."""
    table, sources = split_sources(read_toml(saved.path / IDENTIFIED))
    return table, sources


def answer(summary: Summary, checks: list[Check]) -> list[str]:
    """Parameters with their intervals, how the tests are met, what is not determined."""
    told = []
    if summary["outcome"] != "completed":
        sentence = str(summary.get("sentence") or "; ".join(summary["poor"]))
        told.append(
            f"The fit is not good enough to be used ({summary['outcome'].replace('_', ' ')}): "
            f"{tidy(sentence)}"
        )
    values = [
        f"{item['symbol']} = {number(item['value'], '.4g')} {item['unit']}".strip()
        + f" ({number(item['lower'], '.4g')} to {number(item['upper'], '.4g')})"
        for item in summary["parameters"].values()
    ]
    told.append(f"Identified, with 95 % intervals: {joined(values)}.")
    records = summary["records"]
    lowest = min(records, key=lambda record: record["R2"])
    worst = {
        name: max(
            (abs(cycle[f"{name}_error"]) for r in records for cycle in r["cycles"]), default=0.0
        )
        for name in ("G_eq", "h_eq", "energy")
    }
    told.append(
        f"The model meets the tests with R² of {lowest['R2']:.4f} or more (NRMSE at most "
        f"{percent(max(record['NRMSE'] for record in records), 1)}); of single cycles G_e is off "
        f"by up to {percent(worst['G_eq'], 1)}, h_eq {percent(worst['h_eq'], 1)}, energy "
        f"{percent(worst['energy'], 1)}."
    )
    weak = [
        p["symbol"] for p in summary["parameters"].values() if grade(p) in (POORLY, AT_BOUND, NOT)
    ]
    errors = [relative_error(p) for p in summary["parameters"].values()]
    known = (
        f"Poorly determined by these tests: {joined(weak)}"
        if weak
        else f"Standard errors are at most {percent(max(errors), 1)} of the estimates"
    )
    held = summary.get("held_out")
    judged = f" Tests that were held out: {held['verdict']} the limits." if held else ""
    told.append(f"{known}.{judged} {verdict_of(checks)}")
    return told


def tables_of(saved: SavedResult) -> dict[str, ReportTable]:
    """Parameters first, then how the tests are met, cycle by cycle."""
    summary = saved.summary
    found: dict[str, ReportTable | None] = {
        "parameters": parameters_table(summary),
        "records": records_table(summary["records"]),
        "cycles": cycles_table(saved),
        "thermocouples": thermocouples_table(summary["thermocouples"]),
        "held_out": held_out_table(summary),
        "posterior": posterior_table(summary),
        "undetermined": undetermined_table(summary),
    }
    return {name: table for name, table in found.items() if table is not None and table.rows}


def checks_of(summary: Summary) -> list[Check]:
    """R2 of each test; limits on tests that were held out."""
    found = [
        Check(
            f"R² of {record['name']}",
            float(record["R2"]),
            UNUSABLE,
            "",
            f"below it a fit is no bearing; below {POOR:g} it is told to be poor",
            PASSED if record["R2"] >= UNUSABLE else EXCEEDED,
            lower=True,
        )
        for record in summary["records"]
    ]
    held = summary.get("held_out") or {"tests": [], "limits": {}}
    for test in held["tests"]:
        if test["role"] != "held out":
            continue
        for name, limit in held["limits"].items():
            error = test.get(f"{name}_error")
            verdict = {"within": PASSED, "beyond": EXCEEDED}.get(
                str(test.get(f"{name}_verdict")), NOT_JUDGED
            )
            value = abs(100.0 * error) if error is not None else float("nan")
            what = f"error of {name}, {test['test']} (held out)"
            found.append(Check(what, value, 100.0 * limit, "%", "limit of the fit", verdict))
    return found


def _predicted(summary: Summary) -> list[str]:
    """What predictions ask beyond the tests."""
    told = (summary.get("posterior") or {}).get("warnings", [])
    return [tidy(text) for text in parted(told)[0]]


def _covered(bearing: Mapping[str, Any]) -> list[str]:
    """What the tests cover, for whoever uses the bearing."""
    tested = bearing.get("tested_range") or {}
    if "strain" not in tested:
        return []
    low, high = tested["strain"]
    air = [quantity(end) for end in tested.get("ambient", [])]
    at = f", air of {' to '.join(dict.fromkeys(air))}" if air else ""
    strains = percent(high) if low == high else f"{percent(low)} to {percent(high)}"
    return [
        f"The bearing holds for what these tests cover: shear strains of {strains}{at}; the table "
        "of its range says all."
    ]


def assumptions(summary: Summary, bearing: Mapping[str, Any]) -> list[str]:
    """What was not identified and counts all the same; how the search went."""
    found = [
        f"Search: {summary['method']}, {counted(int(summary['evaluations']), 'evaluation')}. "
        "Standard errors count scatter along each test, and what is not free as the table of "
        "assumptions says."
    ]
    held = [
        f"{fixed_name(key)} = {number(item['value'], '.4g')} {item['unit']}".strip()
        for key, item in summary["fixed"].items()
    ]
    if held:
        found.append(f"Held at the values of the starting bearing: {joined(held)}.")
    said = dict.fromkeys(
        text
        for r in summary["records"]
        for text in (r.get("conditions") or {}).get("assumptions", [])
    )
    found += [tidy(f"Not said by the files: {text}") for text in said]
    contradicted = [item["name"] for item in summary["assumed"] if item["contradicted"]]
    if contradicted:
        found.append(f"The tests speak against what was assumed of {joined(contradicted)}.")
    return [*found, *model_assumptions({"scheme": "conservative", "heat_source": None}, [bearing])]


def fixed_name(key: str) -> str:
    """A dotted key by its end."""
    return key.rsplit(".", 1)[-1].replace("_", " ")


def _looked_over(saved: SavedResult) -> Pieces:
    """Of `identify --check`: findings, nothing fitted."""
    records = saved.summary["records"]
    refused = [str(r["name"]) for r in records if r["outcome"] == "refused"]
    warned = [str(r["name"]) for r in records if r["outcome"] == "warning"]
    told = f"{joined(refused)} cannot be used" if refused else "All of them can be used"
    more = f"; {joined(warned)} only with what is said of them in mind" if warned else ""
    return Pieces(
        command="check",
        title="Tests looked over",
        question=f"Can {counted(len(records), 'test')} "
        f"({joined(str(r['name']) for r in records)}) be fitted?",
        answer=[f"{told}{more}.", f"They hold {sum(int(r['cycles']) for r in records)} cycles."],
        inputs={"treatment": treatment_table(records)},
        tables={"findings": checks_table(records)},
        figures=saved_figures(saved, {"check": "The test as it was read, and its cycles."}),
        validity_unknown="Nothing was fitted, so nothing is said of validity.",
        identity=saved_identity(saved, "thermobearing.identify.check_test(...) in Python"),
    )
