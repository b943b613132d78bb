"""Report of a validation."""

from collections.abc import Mapping
from typing import Any

from thermobearing.identify.report import (
    LOOPS,
    cycles_table,
    error_check,
    errors_table,
    loop_trace,
    rounded_down,
    tests_table,
    thermocouples_table,
)
from thermobearing.quantities.governing import largest_by, least_by
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import counted, degrees, joined, percent, tidy
from thermobearing.report import content
from thermobearing.report.pieces import Check, Pieces, Plot, ReportFigure, Trace
from thermobearing.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.results.saved import SavedResult
from thermobearing.validate.result import ERRORS

Summary = Mapping[str, Any]


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the pieces of the report of a validation."""
    summary = saved.summary
    items = summary["comparisons"]
    bearings = (summary.get("inputs") or {}).get("bearings", {})
    words = [bearing_words(entry["table"]) for entry in bearings.values()]
    words = words or list(dict.fromkeys(str(item["bearing"]) for item in items))
    tests = {str(item["test"]): float(item["ambient_degC"]) for item in items}
    inputs = {"tests": tests_table(list({item["test"]: item for item in items}.values()))}
    for entry in bearings.values():
        inputs |= bearing_tables(entry["table"], entry["sources"])
    models = list(dict.fromkeys(str(item["model"]) for item in items))
    return content.build_pieces(
        "validate",
        f"Validation of {joined(dict.fromkeys(str(item['bearing']) for item in items))}",
        f"Validation of {joined(words)} ({joined(models)} model), without calibration, against "
        f"{counted(len(tests), 'test')} ({joined(tests)}; "
        f"{degrees(list(tests.values()))}).",
        _answer(summary),
        checks=_report_checks(summary),
        inputs=inputs,
        tables=_report_tables(saved),
        figures=_report_figures(saved),
        assumptions=[
            "Nothing was calibrated: the bearing follows the measured displacement of each test, "
            "starting at the temperature of the chamber.",
            *model_assumptions(
                {"model": models[0]}, [entry["table"] for entry in bearings.values()]
            ),
        ],
        **content.saved_parts(saved, "thermobearing.validate_bearing(...) in Python"),
    )


def _answer(summary: Summary) -> list[str]:
    """Return sentences on the verdict, the largest errors, and the agreement of the force."""
    items = summary["comparisons"]
    early = [] if summary["outcome"] == "completed" else [tidy(str(summary["sentence"]))]
    compared = [item for item in items if item["R2"] is not None]
    worst = []
    for name in summary["limits"]:
        errors = [(item["errors"][name]["error"], item) for item in compared]
        errors = [(error, item) for error, item in errors if error is not None]
        if errors:
            error, item = largest_by(errors, lambda pair: abs(pair[0]))
            worst.append(f"{name} {percent(error, 1)} ({_comparison_label(item, items)})")
    verdict = {"within": "meets the limits", "beyond": "exceeds a limit"}.get(
        str(summary["verdict"]), str(summary["verdict"])
    )
    largest_errors = f"; largest errors {joined(worst)}" if worst else ""
    sentences = [*early, f"The model {verdict}{largest_errors}."]
    if compared:
        lowest = least_by(compared, lambda item: float(item["R2"]))
        largest = [
            f"{name} x {item['largest_loop']['ratio'][name]:.2f}"
            for item in compared[:1]
            if item["largest_loop"]
            for name in ("K_eq", "h_eq", "energy")
        ]
        first = _comparison_label(compared[0], items)
        loop = f"; its largest loop in {first}: {joined(largest)}" if largest else ""
        sentences.append(
            f"R² of the force is {rounded_down(lowest['R2'])} or more "
            f"(lowest: {_comparison_label(lowest, items)}){loop}."
        )
    return sentences


def _comparison_label(item: Mapping[str, Any], items: list[Mapping[str, Any]]) -> str:
    """Return the name of a comparison: the test, and bearing and model if there are several."""
    several = [
        k for k in ("bearing", "model") if len({str(comparison[k]) for comparison in items}) > 1
    ]
    return ", ".join([str(item["test"]), *(str(item[key]) for key in several)])


def _report_tables(saved: SavedResult) -> dict[str, Table]:
    tables = {"errors": errors_table(ERRORS, saved["table"].to_dict("records"))}
    if "cycles" in saved.tables:
        tables["cycles"] = cycles_table(saved["cycles"])
    items = saved.summary["comparisons"]
    rows = [
        {"test": _comparison_label(item, items), **row}
        for item in items
        for row in item["thermocouples"]
    ]
    tables["thermocouples"] = thermocouples_table(rows)
    return {name: table for name, table in tables.items() if table.rows}


def _report_figures(saved: SavedResult) -> dict[str, ReportFigure]:
    figures = content.saved_figures(saved, "validate")
    if "fit" in saved.tables:
        choices: dict[str, list[Trace]] = {}
        parts = saved["fit"].groupby(["test", "bearing", "model"], sort=False)
        for (test, bearing, model), rows in parts:
            traces = choices.setdefault(str(test), [])
            if not traces:
                traces.append(loop_trace(rows, *LOOPS[0]))
            colour = MODEL_COLOURS[(len(traces) - 1) % len(MODEL_COLOURS)]
            if rows["model_force_kN"].notna().any():
                name = f"{bearing}, {model}"
                traces.append(loop_trace(rows, name, "model_force_kN", colour))
        plot = Plot("displacement [mm]", "force [kN]", choices)
        figures = content.with_plot(figures, "loops", plot, "validate")
    return figures


MODEL_COLOURS = ("#CC3311", "#0077BB", "#009988", "#EE7733")


def _report_checks(summary: Summary) -> list[Check]:
    items = summary["comparisons"]
    checks = []
    for item in items:
        for name, error in item["errors"].items():
            if error["limit"] is not None:
                comparison_name = _comparison_label(item, items)
                checks.append(
                    error_check(
                        name, comparison_name, error["error"], error["limit"], error["verdict"]
                    )
                )
    names = list(dict.fromkeys(str(item["bearing"]) for item in items))
    rows = summary.get("tested_range", [])
    source = f"{content.TESTED_RANGE} of the bearing"
    return checks + content.limit_checks(rows, content.TESTS, source, names)
