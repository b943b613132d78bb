"""Report of a calibration, and of checked tests."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.identify import tables
from thermobearing.identify.tables import AT_BOUND, NOT, POORLY, grade, relative_error
from thermobearing.identify.uncertainty.agreement import POOR, UNUSABLE
from thermobearing.quantities.tables import Table
from thermobearing.report import content
from thermobearing.report.figures import path
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_JUDGED,
    PASSED,
    Check,
    Pieces,
    Plot,
    ReportFigure,
    Trace,
)
from thermobearing.report.words import counted, degrees, joined, number, percent, quantity, tidy
from thermobearing.results.directory import IDENTIFIED
from thermobearing.results.ranges import parted
from thermobearing.results.saved import SavedResult

Summary = Mapping[str, Any]
LOOP_POINTS = 2000  # of a test
ROLE = ("role", "test")
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
    "folds": "Parameters without each group of tests, compared with those of all.",
    "convergence": "Best misfit of the search against its evaluations.",
}


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the pieces of the report of a calibration, or of checked tests."""
    summary = saved.summary
    if "parameters" not in summary:
        return _checked(saved)
    bearing, sources = split_sources(read_toml(saved.path / IDENTIFIED))
    named = {**bearing, "name": summary["bearing"]}
    predicted = (summary.get("posterior") or {}).get("warnings", [])
    tests = [str(record["name"]) for record in summary["records"]]
    checks = _report_checks(summary)
    return content.build_pieces(
        "identify",
        f"Identification of {summary['bearing']}",
        f"Which parameters does the bearing {bearing_words(named)} have, by "
        f"{counted(len(tests), 'test')} ({joined(tests)}) at "
        f"{degrees([r['ambient_degC'] for r in summary['records']])}, how well are they known, "
        "and how well does the model agree with the tests?",
        _answer(summary, bearing, checks),
        checks=checks,
        judged=False,
        inputs={
            "tests": tables.tests_table(summary["records"]),
            "treatment": tables.treatment_table(summary["records"]),
            **bearing_tables(bearing, sources),
        },
        tables=_report_tables(saved),
        figures=_report_figures(saved),
        validity=list(map(tidy, parted(predicted)[0])),
        assumptions=_assumptions(summary, bearing),
        **content.saved_parts(saved, "thermobearing.identify_bearing(...) in Python"),
    )


def _report_figures(saved: SavedResult) -> dict[str, ReportFigure]:
    found = content.saved_figures(saved, CAPTIONS)
    if "fit" in saved.tables:
        choices = {
            str(saved.summary["records"][int(str(k))]["name"]): [
                loop_trace("test", rows, "force_kN", "#9aa4b1"),
                loop_trace("model", rows, "model_force_kN", "#CC3311"),
            ]
            for k, rows in saved["fit"].groupby("record", sort=False)
        }
        plot = Plot("displacement [mm]", "force [kN]", choices)
        found = content.with_plot(found, "loops", plot, CAPTIONS)
    return found


def loop_trace(name: str, rows: pd.DataFrame, column: str, colour: str) -> Trace:
    """Return the loops of a column of fit.csv as a line of a plot."""
    x, force = (rows[one].to_numpy(dtype=float) for one in ("displacement_mm", column))
    return Trace(name, *path(x, force, LOOP_POINTS), colour)


def _answer(summary: Summary, bearing: Summary, checks: list[Check]) -> list[str]:
    found = []
    if summary["outcome"] != "completed":
        outcome, sentence = summary["outcome"].replace("_", " "), tidy(summary["sentence"])
        found.append(f"The fit is not good enough to be used ({outcome}): {sentence}")
    parameters, records = list(summary["parameters"].values()), summary["records"]
    values = [
        f"{item['symbol']} = {number(item['value'], '.4g')} {item['unit']}".strip()
        + f" ({number(item['lower'], '.4g')} to {number(item['upper'], '.4g')})"
        for item in parameters
    ]
    found.append(f"Identified, with 95 % intervals: {joined(values)}.")
    cycles = [cycle for record in records for cycle in record["cycles"]]
    worst = {"G_eq_error": "G_e", "h_eq_error": "h_eq", "energy_error": "energy"}
    off = [
        f"{percent(max((abs(cycle[name]) for cycle in cycles), default=0.0), 1)} in {words}"
        for name, words in worst.items()
    ]
    found.append(
        f"The model agrees with the tests with R² of {min(r['R2'] for r in records):.4f} or more "
        f"(NRMSE at most {percent(max(r['NRMSE'] for r in records), 1)}); single cycles are off "
        f"by up to {joined(off)}."
    )
    known = f"at most {percent(max(relative_error(p) for p in parameters), 1)} of the estimates"
    known = f"Standard errors are {known}"
    if weak := [p["symbol"] for p in parameters if grade(p) in (POORLY, AT_BOUND, NOT)]:
        known = f"Poorly determined by these tests: {joined(weak)}"
    held = summary.get("held_out")
    judged = f" Tests that were held out: {held['verdict']} the limits." if held else ""
    found.append(f"{known}.{judged} {content.verdict_of(checks)}")
    tested = bearing.get("tested_range") or {}
    if "strain" in tested:
        strains = " to ".join(dict.fromkeys(percent(end) for end in tested["strain"]))
        air = " to ".join(dict.fromkeys(quantity(end) for end in tested["ambient"]))
        found.append(
            f"The bearing is valid for what these tests cover: shear strains of {strains}, air of "
            f"{air}; the table of its range is complete."
        )
    return found


def _report_tables(saved: SavedResult) -> dict[str, Table]:
    summary = saved.summary
    held = summary.get("held_out") or {"tests": []}
    cycles = saved.tables.get("cycles")
    found = {
        "parameters": tables.parameters_table(summary),
        "records": tables.agreement_table(summary["records"]),
        "cycles": None if cycles is None else tables.cycles_table(cycles),
        "thermocouples": tables.thermocouples_table(summary["thermocouples"]),
        "held_out": tables.errors_table("Tests that judge the fit", held["tests"], ROLE),
        "posterior": tables.posterior_table(summary.get("posterior") or {}),
        "undetermined": tables.undetermined_table(summary),
    }
    return {name: table for name, table in found.items() if table and table.rows}


def _report_checks(summary: Summary) -> list[Check]:
    found = [
        Check(
            f"R² of {record['name']}",
            float(record["R2"]),
            UNUSABLE,
            "",
            f"below it a fit is not used; below {POOR:g} it is reported as poor",
            PASSED if record["R2"] >= UNUSABLE else EXCEEDED,
            lower=True,
        )
        for record in summary["records"]
    ]
    held = summary.get("held_out") or {"tests": [], "limits": {}}
    found += [
        error_check(
            name,
            f"{test['test']} (held out)",
            test.get(f"{name}_error"),
            limit,
            test[f"{name}_verdict"],
        )
        for test in held["tests"]
        if test["role"] == "held out"
        for name, limit in held["limits"].items()
    ]
    return found


def error_check(name: str, whose: str, error: float | None, limit: float, verdict: str) -> Check:
    """Return the check of the largest error of a quantity in a test."""
    value = float("nan") if error is None else abs(100.0 * error)
    known = {"within": PASSED, "beyond": EXCEEDED}.get(str(verdict), NOT_JUDGED)
    what = f"error of {name}, {whose}"
    return Check(what, value, 100.0 * limit, "%", "limit of the errors", known)


def _assumptions(summary: Summary, bearing: Mapping[str, Any]) -> list[str]:
    found = [
        f"Search: {summary['method']}, {counted(int(summary['evaluations']), 'evaluation')}. "
        "Standard errors include the scatter along each test and the uncertainty of the values "
        "that are not free."
    ]
    held = [
        f"{key.rsplit('.', 1)[-1].replace('_', ' ')} = {number(item['value'], '.4g')} "
        f"{item['unit']}".strip()
        for key, item in summary["fixed"].items()
    ]
    if held:
        found.append(f"Held at the values of the starting bearing: {joined(held)}.")
    said = [text for r in summary["records"] for text in r["conditions"]["assumptions"]]
    found += [tidy(f"Not given by the files: {text}") for text in dict.fromkeys(said)]
    contradicted = [item["name"] for item in summary["assumed"] if item["contradicted"]]
    if contradicted:
        found.append(f"The tests contradict the assumed {joined(contradicted)}.")
    return [*found, *model_assumptions({"scheme": "conservative", "heat_source": None}, [bearing])]


def _checked(saved: SavedResult) -> Pieces:
    """Return the pieces of the report of `identify --check`: findings, nothing fitted."""
    records = saved.summary["records"]
    refused, warned = (
        joined(str(r["name"]) for r in records if r["outcome"] == outcome)
        for outcome in ("refused", "warning")
    )
    verdict = f"{refused} cannot be used" if refused else "All of them can be used"
    more = f"; {warned} with the warnings below" if warned else ""
    return Pieces(
        command="check",
        title="Checked tests",
        question=f"Can {counted(len(records), 'test')} "
        f"({joined(str(r['name']) for r in records)}) be fitted?",
        answer=[f"{verdict}{more}.", f"They hold {sum(int(r['cycles']) for r in records)} cycles."],
        inputs={"treatment": tables.treatment_table(records)},
        tables={"findings": tables.findings_table(records)},
        figures=content.saved_figures(saved, {"check": "The test as it was read, and its cycles."}),
        validity_unknown="Nothing was fitted, so there is no verdict on validity.",
        identity=content.saved_identity(saved, "thermobearing.check_test(...) in Python"),
    )
