"""What the document of a validation says, from a result as it is loaded again."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from thermobearing.cyclic.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.identify.report import (
    LOOP_POINTS,
    cycles_table,
    errors_table,
    tests_table,
    thermocouples_table,
)
from thermobearing.report.content import (
    TESTED_RANGE,
    TESTS,
    limit_checks,
    saved_figures,
    saved_identity,
    saved_validity,
    verdict,
    with_plot,
)
from thermobearing.report.figures import path
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
from thermobearing.report.words import counted, degrees, joined, percent, tidy
from thermobearing.results.saved import SavedResult

Summary = Mapping[str, Any]
VERDICTS = {"within": PASSED, "beyond": EXCEEDED}
CAPTIONS = {
    "loops": "Measured loops (band) and the model (line) of every test.",
    "ratios": "Model over test of the largest loop of each test.",
    "cycles": "Measures of each cycle in test and model.",
    "residuals": "Force of the model less that of the test, sample by sample.",
    "temperatures": "Thermocouples of the tests and the model at their places.",
}


def build_pieces(saved: SavedResult) -> Pieces:
    """Everything that the document of a validation says.

    Parameters
    ----------
    saved : of `validate`, as `load_result` gives it.
    """
    summary = saved.summary
    validity, unknown, warnings = saved_validity(saved)
    checks = report_checks(summary)
    items = summary["comparisons"]
    bearings = (summary.get("inputs") or {}).get("bearings", {})
    words = [bearing_words(one["table"]) for one in bearings.values()]
    words = words or list(dict.fromkeys(str(item["bearing"]) for item in items))
    tests = {str(item["test"]): float(item["ambient_degC"]) for item in items}
    inputs = {"tests": tests_table(list({item["test"]: item for item in items}.values()))}
    for one in bearings.values():
        inputs |= bearing_tables(one["table"], one["sources"])
    models = list(dict.fromkeys(str(item["model"]) for item in items))
    return Pieces(
        command="validate",
        title=f"Validation of {joined(dict.fromkeys(str(item['bearing']) for item in items))}",
        question=(
            f"Does {joined(words, 'or')} ({joined(models)} model), as it is and without a fit, do "
            f"what {counted(len(tests), 'test')} measured ({joined(tests)}; "
            f"{degrees(list(tests.values()))})?"
        ),
        answer=answer(summary, verdict(checks, validity, unknown)),
        inputs=inputs,
        tables=report_tables_by_name(saved),
        figures=report_figures(saved),
        checks=checks,
        validity=validity,
        validity_unknown=unknown,
        assumptions=[
            "Nothing was fitted: the displacement of each test moves the bearing, from the "
            "temperature of the chamber on.",
            *model_assumptions({"model": models[0]}, [one["table"] for one in bearings.values()]),
        ],
        warnings=warnings,
        identity=saved_identity(saved, "thermobearing.validate_bearing(...) in Python"),
    )


def answer(summary: Summary, told: str) -> list[str]:
    """The verdict with the largest errors, how the force is met, limits and validity."""
    items = summary["comparisons"]
    early = []
    if summary["outcome"] != "completed":
        early = [tidy(str(summary.get("sentence") or "The model did not get through every test"))]
    known = [item for item in items if item["R2"] is not None]
    worst = []
    for name in summary["limits"]:
        errors = [(item["errors"][name]["error"], item) for item in known]
        errors = [(error, item) for error, item in errors if error is not None]
        if errors:
            error, item = max(errors, key=lambda pair: abs(pair[0]))
            worst.append(f"{name} {percent(error, 1)} ({_whose(item, items)})")
    verdict_ = {"within": "meets the limits", "beyond": "is beyond a limit"}.get(
        str(summary["verdict"]), str(summary["verdict"])
    )
    errors_ = f"; largest errors {joined(worst)}" if worst else ""
    found = [*early, f"The model {verdict_}{errors_}."]
    if known:
        lowest = min(known, key=lambda item: item["R2"])
        largest = [
            f"{name} x {item['largest_loop']['ratio'][name]:.2f}"
            for item in known[:1]
            if item["largest_loop"]
            for name in ("K_eq", "h_eq", "energy")
        ]
        first = _whose(known[0], items)
        loop = f"; its largest loop in {first}: {joined(largest)}" if largest else ""
        found.append(
            f"The force is met with R² of {lowest['R2']:.4f} or more "
            f"({_whose(lowest, items)} the lowest){loop}."
        )
    return [*found, told]


def _whose(item: Mapping[str, Any], items: list[Mapping[str, Any]]) -> str:
    """A comparison in words, as far as there are several of a kind."""
    several = [k for k in ("bearing", "model") if len({str(one[k]) for one in items}) > 1]
    return ", ".join([str(item["test"]), *(str(item[key]) for key in several)])


def report_tables_by_name(saved: SavedResult) -> dict[str, ReportTable]:
    """Errors of each test, its cycles, thermocouples."""
    items = saved.summary["comparisons"]
    tests = [
        {
            **{k: item[k] for k in ("test", "bearing", "model", "ambient_degC", "R2")},
            **{f"{n}_error": one["error"] for n, one in item["errors"].items()},
            **{f"{n}_verdict": one["verdict"] for n, one in item["errors"].items()},
            "beyond_tested": beyond,
        }
        for item, beyond in zip(items, _beyond(saved, len(items)), strict=True)
    ]
    keys = ["test"] + [k for k in ("bearing", "model") if len({str(i[k]) for i in items}) > 1]
    rows = [{"test": _whose(item, items), **row} for item in items for row in item["thermocouples"]]
    found = {
        "errors": errors_table("Largest errors of the model in each test", tests, keys),
        "cycles": cycles_table(saved),
        "thermocouples": thermocouples_table(rows),
    }
    return {name: table for name, table in found.items() if table is not None and table.rows}


def _beyond(saved: SavedResult, count: int) -> list[str]:
    """Quantities in which each comparison leaves the tested range."""
    if "table" not in saved.tables or "beyond_tested" not in saved["table"]:
        return [""] * count
    return [str(value) for value in saved["table"]["beyond_tested"].fillna("")]


def report_figures(saved: SavedResult) -> dict[str, ReportFigure]:
    """Pictures of the directory; loops of tests and models besides as a plot."""
    found = saved_figures(saved, CAPTIONS)
    if "fit" in saved.tables:
        choices: dict[str, list[Trace]] = {}
        for (test, bearing, model), rows in saved["fit"].groupby(
            ["test", "bearing", "model"], sort=False
        ):
            traces = choices.setdefault(str(test), [])
            if not traces:
                traces.append(_loop(rows, "test", "force_kN", "#9aa4b1"))
            colour = MODEL_COLOURS[(len(traces) - 1) % len(MODEL_COLOURS)]
            if rows["model_force_kN"].notna().any():
                traces.append(_loop(rows, f"{bearing}, {model}", "model_force_kN", colour))
        plot = Plot("displacement [mm]", "force [kN]", choices)
        found = with_plot(found, "loops", plot, CAPTIONS)
    return found


MODEL_COLOURS = ("#CC3311", "#0077BB", "#009988", "#EE7733")


def _loop(rows: pd.DataFrame, name: str, column: str, colour: str) -> Trace:
    x, force = (rows[one].to_numpy(dtype=float) for one in ("displacement_mm", column))
    return Trace(name, *path(x, force, LOOP_POINTS), colour)


def report_checks(summary: Summary) -> list[Check]:
    """Limits of the validation, and the tested range of each bearing."""
    items = summary["comparisons"]
    found = []
    for item in items:
        for name, one in item["errors"].items():
            if one["limit"] is None:
                continue
            value = float("nan") if one["error"] is None else abs(100.0 * one["error"])
            verdict_ = VERDICTS.get(str(one["verdict"]), NOT_JUDGED)
            what = f"error of {name}, {_whose(item, items)}"
            limit = 100.0 * one["limit"]
            found.append(Check(what, value, limit, "%", "limit of the validation", verdict_))
    names = list(dict.fromkeys(str(item["bearing"]) for item in items))
    rows = summary.get("tested_range", [])
    return found + limit_checks(rows, TESTS, f"{TESTED_RANGE} of the bearing", names)
