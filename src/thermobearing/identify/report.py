"""Tables and reports of a calibration and of checked tests.

The tables are built from the content of summary.json or of a CSV file. The console shows some of
them, and `validate` uses them too.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.identify.comparison import limit_source
from thermobearing.identify.properties import (
    AS_IN_THE_TEST,
    predicted_cycles_table,
    prediction_sentence,
    properties_table,
    property_sentence,
)
from thermobearing.identify.result import POOR_R2, UNUSABLE
from thermobearing.identify.treatments import treatment_table
from thermobearing.identify.uncertainty.diagnosis import MISFIT, POOR, size_words
from thermobearing.quantities.governing import largest_by
from thermobearing.quantities.register import quantity as registered
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import (
    counted,
    degrees,
    joined,
    number,
    percent,
    printed_unit,
    quantity,
    tidy,
)
from thermobearing.report import content
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_ASSESSED,
    PASSED,
    Check,
    Pieces,
    Plot,
    ReportFigure,
    Trace,
)
from thermobearing.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.results.directory import IDENTIFIED
from thermobearing.results.ranges import MARKED, parted
from thermobearing.results.saved import SavedResult

Row = Mapping[Any, Any]
STRONG = 0.9  # correlation that is reported
AT_BOUND, POORLY, NOT = "at its bound", "poorly", "no"
MOST_ROWS = 200
OF_ONE_TEST = re.compile(r" of -?[\d.]+ degC$")
LARGER = 1.5  # factors on standard uncertainties that notes state
SEEN = 0.001  # of a parameter: what a standard uncertainty moves by less is not listed
NOT_CONTAINED = (
    "They contain no error of the model, and none of the clock, the plan and the number of layers."
)
CONDITIONS = ["test", "file", "ambient_degC", "mean_ambient_degC", "duration_s", "samples"]
CONDITIONS += [
    "largest_displacement_mm",
    "largest_strain",
    "largest_force_kN",
    "largest_speed_mm_s",
    "weight",
]
CONDITIONS += ["thermocouples"]
BRIEF = ["symbol", "unit", "estimate", "standard_error", "interval_lower", "interval_upper"]
BRIEF += ["determined"]
# Of the page: name, column, colour and look.
LOOPS = (
    ("test", "force_kN", "#9aa4b1", "broad"),
    ("model", "model_force_kN", "#CC3311", "line"),
)
CYCLE_MEASURES = ("G_eq_error", "h_eq_error", "energy_error", "force_max_error")


def tests_table(records: Sequence[Row]) -> Table:
    """Return the conditions of each test."""
    rows = []
    for record in records:
        conditions = record.get("conditions") or {}
        sensors = conditions.get("thermocouples", {})
        places = [f"{title}: {place}" for title, place in sensors.items()]
        row = {name: record.get(name) for name in ("file", "ambient_degC")} | conditions
        row |= {"test": record.get("name", record.get("test")), "thermocouples": ", ".join(places)}
        rows.append(row)
    usual = all(row.get("weight", 1.0) == 1.0 for row in rows)
    names = [name for name in CONDITIONS if not (usual and name == "weight")]
    note = (
        "Ambient: of the chamber when the test begins, at which the bearing starts. The bearing "
        "exchanges heat with air at the mean of the chamber during the test."
    )
    return make_table(pd.DataFrame(rows), names, "Tests", note=note)


def _findings_table(records: Sequence[Row]) -> Table:
    """Return the findings of the checks of tests."""
    rows = [
        (record["name"], finding["level"], finding["check"], finding["sentence"])
        for record in records
        for finding in record["findings"]
    ]
    rows = rows or [(record["name"], "nothing", "", "") for record in records]
    frame = pd.DataFrame(rows, columns=["test", "finding", "about", "sentence"])
    return make_table(frame, caption="Findings", heads={"sentence": "Sentence"})


def parameters_table(summary: Row, names: Sequence[str] | None = None) -> Table:
    """Return the estimates with standard errors and intervals; strong correlation in the note.

    `names` are the columns; all by default, those in `BRIEF` on the console.
    """
    rows = [
        {
            "parameter": content.key_words(key).removesuffix(f" {item['symbol']}"),
            "symbol": item["symbol"],
            "unit": item["unit"],
            "estimate": item["value"],
            "standard_error": None if item["at_bound"] else item["stderr"],
            "standard_error_of_tests": None if item["at_bound"] else item["stderr_of_tests"],
            "interval_lower": item["lower"],
            "interval_upper": item["upper"],
            "determined": _grade(item),
            "start_value": item["start"],
        }
        for key, item in summary["parameters"].items()
    ]
    note = (
        "Standard errors include the uncertainty of the parameters that are held. Intervals are "
        "1.96 of them to each side, and wider where an uncertainty is itself known from few "
        f"degrees of freedom (Student's distribution). {_correlated(summary)}"
    )
    caption = "Identified parameters"
    return make_table(pd.DataFrame(rows), names, caption, keys=2, note=note, keep_keys=True)


def _relative_error(item: Row) -> float:
    """Return the standard error over the estimate; infinite if it is not determined."""
    if not item.get("determined", not item["at_bound"]) or item["stderr"] is None:
        return float("inf")
    return float(item["stderr"]) / max(abs(float(item["value"])), 1e-12)


def _grade(item: Row) -> str:
    """Return how well the tests determine a parameter."""
    if item["at_bound"]:
        return AT_BOUND
    if not item.get("determined", True):
        return NOT
    if _relative_error(item) > POOR:
        return POORLY
    return "well" if item["well_determined"] else "yes"


def _correlated(summary: Row) -> str:
    """Return a sentence on pairs of parameters that the tests hardly separate."""
    keys, matrix = summary["correlation"]["parameters"], summary["correlation"]["matrix"]
    symbols = [summary["parameters"][key]["symbol"] for key in keys]
    values = np.array(matrix, dtype=float).reshape(len(symbols), len(symbols))
    pairs = [
        f"{symbols[i]} and {symbols[j]} ({values[i, j]:+.2f})".replace("-", "\N{MINUS SIGN}")
        for i in range(len(symbols))
        for j in range(i)
        if abs(values[i, j]) >= STRONG
    ]
    if not pairs:
        text = f"By the tests alone, no correlation reaches {STRONG:g}"
    else:
        text = f"By the tests alone strongly correlated: {joined(pairs)}; interpret them together"
    return f"{text}. Errors of assumed values, which estimates share, correlate them more."


def agreement_table(records: Sequence[Row]) -> Table:
    """Return the agreement of the model with each test, and the errors of its cycles."""
    rows = []
    for record in records:
        row = {"test": record["name"], "ambient_degC": record["ambient_degC"]}
        row |= {"R2": record["R2"], "NRMSE": record["NRMSE"], "cycles_found": len(record["cycles"])}
        for name in CYCLE_MEASURES:
            errors = [cycle[name] for cycle in record["cycles"]] or [float("nan")]
            row |= {f"{name}_least": min(errors), f"{name}_largest": max(errors)}
        rows.append(row)
    note = "R² and NRMSE: force over the complete test. Others: range of the error over the cycles "
    note += "(model / test \N{MINUS SIGN} 1). The peak force is the larger one of the two sides."
    return make_table(pd.DataFrame(rows), caption="Agreement with the tests", keys=2, note=note)


def worst_error(record: Row, name: str) -> float:
    """Return the error of largest magnitude of a measure over the cycles of a test; NaN without."""
    errors = [float(cycle[name]) for cycle in record["cycles"]]
    return largest_by(errors, abs) if errors else float("nan")


JUDGED = "Largest errors in the tests used in the calibration and held out"
CLOSING = "Small cycles that end a block of a test are counted but not listed."


def cycles_table(cycles: "pd.DataFrame") -> Table:
    """Return the measures of each cycle in the test and in the model, of cycles.csv."""
    frame = cycles.head(MOST_ROWS).copy()
    roles = frame["bearing"].astype(str).str.partition(", ")[2]  # of a fit that is judged
    tests = frame["test"].astype(str)
    frame["test"] = tests.where(roles == "", tests + " (" + roles + ")")
    frame["cycle_displacement_mm"] = 0.5 * (frame["D+_mm"] - frame["D-_mm"])
    names = ["test", "ambient_degC", "cycle", "cycle_displacement_mm"]
    for name in ("K_eq", "h_eq", "energy"):
        frame[f"{name}_error"] = frame[f"{name}_ratio"] - 1.0
        names += [f"{name}_test", f"{name}_model", f"{name}_error"]
    names += ["F+_test", "F+_model", "F-_test", "F-_model"]
    remaining = len(cycles) - len(frame)
    note = (
        "K_eq and h_eq follow Eq. 3.1 and 3.2. The displacement is half the range of the samples "
        "of a cycle, between two of which a motion may turn; the model follows the measured "
        f"displacement. {CLOSING}"
    )
    note += f" {remaining} more cycles are in cycles.csv." if remaining else ""
    heads = dict.fromkeys(("K_eq_error", "h_eq_error", "energy_error"), "error")
    return make_table(
        frame, names, "Cycles measured in test and model", keys=3, heads=heads, note=note
    )


def thermocouples_table(rows: Sequence[Row]) -> Table:
    """Return the thermocouples of test and model."""
    note = (
        "rms difference: of the temperatures, over all samples, with the difference at the start. "
        "That of a misfit, if there is one, is of the rise since the start."
    )
    caption = "Thermocouples, model compared with test"
    return make_table(pd.DataFrame(rows), caption=caption, keys=3, note=note if rows else "")


def held_out_rows(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return rows of tests that were held out, which say so in the name of the test."""
    return [{**row, "test": f"{row['test']} (held out)"} for row in rows]


def errors_table(caption: str, tests: Sequence[Row]) -> Table:
    """Return the largest error of each quantity of each test, and those beyond a limit."""
    frame = pd.DataFrame(tests)
    if frame.empty:
        return Table(caption, (), ())
    names = ("K_eq", "h_eq", "energy", "force", "temperature", "NRMSE")
    verdicts = frame.reindex(columns=[f"{name}_verdict" for name in names])
    frame["beyond_a_limit"] = [
        joined(name for name, verdict in zip(names, row, strict=True) if verdict == "beyond")
        or "none"
        for row in verdicts.itertuples(index=False)
    ]
    beyond = frame.get("beyond_tested", pd.Series("", index=frame.index)).fillna("")
    marks = ["ambient" in str(names).split() for names in beyond]
    note = (
        "Largest error over the cycles (model / test \N{MINUS SIGN} 1); of the force, the larger "
        "one of the two sides. Temperature rise: largest difference at any time over the largest "
        "rise of the test, not that of the largest rises. NRMSE: over all samples; the rms "
        "difference of a misfit leaves out samples at rest, and the mean, which is a fitted zero."
    )
    note += f" {MARKED}." if any(marks) else ""
    keys = [name for name in ("role", "test") if name in frame]
    keys += [name for name in ("bearing", "model") if frame[name].nunique() > 1]
    columns = [*keys, "ambient_degC", "R2", *(f"{name}_error" for name in names), "beyond_a_limit"]
    marked = {"ambient_degC": marks}
    return make_table(frame, columns, caption, keys=len(keys), marked=marked, note=note)


def posterior_table(posterior: Row) -> Table:
    """Return the quantities that the samples of the posterior predict."""
    rows = []
    for row in posterior.get("predicted", []):
        _, factor = printed_unit(str(row["unit"]))
        values = {name: factor * row[name] for name in ("best", "lower", "upper")}
        beyond = str(row.get("beyond_tested") or "").split()
        rows.append(
            {
                "ambient_degC": row["ambient_degC"],
                "quantity": {"force": "peak force"}.get(row["quantity"], row["quantity"]),
                "predicted_in": row.get("cycles", ""),
                "unit": printed_unit(str(row["unit"]))[0],
                "predicted_best": values["best"],
                "predicted_lower": values["lower"],
                "predicted_upper": values["upper"],
                "share_not_determined": row["share_not_determined"],
                "outside_tests": ", ".join(beyond).replace("_", " ") or "nothing",
            }
        )
    marks = [row["outside_tests"] != "nothing" for row in rows]
    note = (
        "K_eq, h_eq, Q_d and energy of the first cycle of the largest amplitude in the first test, "
        "the peak force of all of it. Means without the first cycle, if there are more, are over "
        "the cycles of the table of properties, so that their ratios are factors of temperature. "
        f"{AS_IN_THE_TEST} "
    )
    note += (
        f"From {posterior.get('samples')} samples of the posterior ({posterior.get('source')}), "
    )
    note += "in posterior.csv. Not determined: share of the variance from what the tests did not "
    note += "determine." + (f" {MARKED}; the band is wider there." if any(marks) else "")
    options: dict[str, Any] = {"keys": 3, "marked": {"ambient_degC": marks}, "note": note}
    return make_table(pd.DataFrame(rows), caption="Predicted as in the first test", **options)


def _undetermined_table(summary: Row) -> Table:
    """Return what is not free or not determined, and why."""
    rows = []
    for item in summary["parameters"].values():
        if (grade := _grade(item)) in (AT_BOUND, NOT, POORLY):
            position = {AT_BOUND: AT_BOUND, NOT: "near its bound"}.get(grade)
            spread = position or f"± {item['stderr']:.2g} {item['unit']}".strip()
            rows.append((item["symbol"], spread, "", "free, but poorly determined by the tests"))
    for key, item in summary.get("sensitivity", {}).items():
        if not item.get("free", True):
            reason = "held: these tests say too little about it"
            if item["stderr_of_source"] is not None and item["stderr_expected"] is not None:
                reason = f"held: ± {item['stderr_of_source']:.2g} by its source, "
                reason += f"± {item['stderr_expected']:.2g} by these tests"
            rows.append((content.key_words(key), "not free", "", reason))
    for item in summary["assumed"]:
        moved = ""
        if item.get("moves"):
            moved = f"{item['moves']} by {number(100.0 * item['moves_by'], '+.1f')} %"
        rows.append((item["name"], _spread(item), moved, item["source"]))
    frame = pd.DataFrame(rows, columns=["what", "uncertainty", "moves_most", "reason_or_source"])
    note = (
        "Moves most: the parameter whose estimate one standard uncertainty changes most, relative "
        "to its value. Intervals of parameters contain these errors."
    )
    caption = "Assumed values, and parameters that are held or poorly determined"
    return make_table(frame, caption=caption, note=note if summary["assumed"] else "")


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the pieces of the report of a calibration, or of checked tests."""
    summary = saved.summary
    if "parameters" not in summary:
        return _checked(saved)
    bearing, sources = split_sources(read_toml(saved.path / IDENTIFIED))
    named = {**bearing, "name": summary["bearing"]}
    predicted = (summary.get("posterior") or {}).get("warnings", [])
    tests = [str(record["name"]) for record in summary["records"]]
    held_out = (summary.get("held_out") or {}).get("records", [])
    listed = [*summary["records"], *(r | {"name": f"{r['name']} (held out)"} for r in held_out)]
    checks = _report_checks(summary)
    return content.build_pieces(
        "identify",
        f"Calibration of {summary['bearing']}",
        f"Calibration of the bearing {bearing_words(named)} to {counted(len(tests), 'test')} "
        f"({joined(tests)}) at {degrees([r['ambient_degC'] for r in summary['records']])}: "
        "parameters, their uncertainty, and agreement of the model with the tests.",
        _answer(summary, bearing, checks),
        checks=checks,
        judged=False,
        inputs={
            "tests": tests_table(listed),
            "treatment": treatment_table(listed),
            **bearing_tables(bearing, sources),
        },
        tables=_report_tables(saved),
        figures=_report_figures(saved),
        validity=list(map(tidy, parted(predicted)[0])),
        assumptions=_assumptions(summary, bearing),
        **content.saved_parts(saved, "thermobearing.identify_bearing(...) in Python"),
    )


def _report_figures(saved: SavedResult) -> dict[str, ReportFigure]:
    figures = content.saved_figures(saved, "identify")
    if "fit" not in saved.tables:
        return figures
    names = [str(record["name"]) for record in saved.summary["records"]]
    choices = {
        names[int(str(k))]: [loop_trace(rows, *loop) for loop in LOOPS]
        for k, rows in saved["fit"].groupby("record", sort=False)
    }
    plot = Plot("displacement [mm]", "force [kN]", choices)
    return content.with_plot(figures, "loops", plot, "identify")


def loop_trace(
    rows: "pd.DataFrame", name: str, column: str, colour: str, look: str = "line"
) -> Trace:
    """Return the loops of a column of fit.csv as a line of a plot."""
    x, force = (rows[heading].to_numpy(dtype=float) for heading in ("displacement_mm", column))
    return Trace(name, x, force, colour, look)


def _answer(summary: Row, bearing: Row, checks: list[Check]) -> list[str]:
    sentences = []
    if summary["outcome"] != "completed":
        outcome, sentence = summary["outcome"].replace("_", " "), tidy(summary["sentence"])
        sentences.append(f"The calibrated bearing is not acceptable ({outcome}): {sentence}")
    sentences += filter(None, [property_sentence(summary.get("properties") or [])])
    sentences += filter(None, [prediction_sentence(summary.get("posterior") or {})])
    parameters, records = list(summary["parameters"].values()), summary["records"]
    values = [
        f"{item['symbol']} = {number(item['value'], '.4g')} {item['unit']}".strip()
        + f" ({number(item['lower'], '.4g')} to {number(item['upper'], '.4g')})"
        for item in parameters
    ]
    sentences.append(f"Calibrated parameters with 95 % intervals: {joined(values)}.")
    cycles = [cycle for record in records for cycle in record["cycles"]]
    measures = ("G_eq_error", "G_e"), ("h_eq_error", "h_eq"), ("energy_error", "energy")
    errors = [
        f"{percent(max((abs(cycle[name]) for cycle in cycles), default=0.0), 1)} in {words}"
        for name, words in measures
    ]
    sentences.append(
        f"The smallest R² of the force in a test is {_rounded_R2(min(r['R2'] for r in records))}. "
        f"Single cycles of the tests used are off by up to {joined(errors)}."
    )
    if any(str(text).startswith(MISFIT) for text in summary["warnings"]):
        size = f": {summary['difference']}" if summary.get("difference") else ""
        sentences.append(
            f"{MISFIT[:1].upper()}{MISFIT[1:]}{size}. Possible causes are under Warnings."
        )
    largest = percent(max(_relative_error(p) for p in parameters), 1)
    precision = f"The standard errors of the parameters are at most {largest}"
    if weak := [p["symbol"] for p in parameters if _grade(p) in (POORLY, AT_BOUND, NOT)]:
        precision = f"These tests determine {joined(weak)} poorly"
    held_out = summary.get("held_out")
    judged = f" Validation tests: {held_out['verdict']} the limits." if held_out else ""
    sentences.append(f"{precision}.{judged} {content.summarize_checks(checks)}")
    if valid := valid_for(bearing):
        sentences.append(f"{valid} (all limits: table of the calibration range).")
    return sentences


def rounded_down(value: float) -> str:
    """Return a lower limit in four digits, so that "1.0000" is only said of a perfect agreement."""
    return f"{math.floor(1e4 * value) / 1e4:.4f}"


def _rounded_R2(value: float) -> str:
    """Return R2 as other tables have it, but "1.0000" of a perfect agreement only."""
    text = registered("R2").text(value)
    return text if value >= 1.0 or float(text) < 1.0 else rounded_down(value)


def rounded_range(ends: Sequence[Any]) -> str:
    """Return a range as one reads it: two digits, its unit once; whole degrees."""
    values, unit = [], ""
    for end in ends:
        text, _, unit = str(end).partition(" ")
        form = ".0f" if unit == "degC" else ".2g"
        values.append(f"{float(format(float(text), form)) + 0.0:g}")
    low = [number(float(value), "g") for value in values[:-1] if value != values[-1]]
    return " to ".join([*low, str(quantity(f"{values[-1]} {unit}".strip()))])


def valid_for(bearing: Row) -> str:
    """Return a sentence on the conditions of the tests, without its full stop; "" if unknown."""
    tested = bearing.get("tested_range") or {}
    if "strain" not in tested:
        return ""
    strains = " to ".join(dict.fromkeys(percent(end) for end in tested["strain"]))
    ambients = rounded_range(tested["ambient"])
    rates = ""
    if "strain_rate" in tested:
        text = rounded_range(tested["strain_rate"])
        rates = f" and strain rates of {'' if ' to ' in text else 'about '}{text}"
    return (
        "The parameters hold within the ranges of the tests, shear strains of "
        f"{strains} at ambient temperatures of {ambients}{rates}"
    )


def _report_tables(saved: SavedResult) -> dict[str, Table]:
    summary = saved.summary
    held_out = summary.get("held_out") or {"tests": []}
    cycles = saved.tables.get("cycles")
    tables = {
        "properties": properties_table(summary.get("properties") or []),
        "parameters": with_basis(parameters_table(summary), summary),
        # The table of tests that were held out has the errors of all tests.
        "records": None if held_out["tests"] else agreement_table(summary["records"]),
        "cycles": None if cycles is None else cycles_table(cycles),
        "thermocouples": thermocouples_table(
            [*summary["thermocouples"], *held_out_rows(held_out.get("thermocouples", []))]
        ),
        "held_out": errors_table(JUDGED, held_out["tests"]),
        "posterior": _with_sources(summary.get("posterior") or {}),
        "predicted_cycles": predicted_cycles_table(summary.get("posterior") or {}),
        "undetermined": _undetermined_table(summary),
    }
    return {name: table for name, table in tables.items() if table and table.rows}


def _with_sources(posterior: Row) -> Table:
    """Return what is predicted; its note states where the bands come from and what narrows them.

    On the console these are notes of their own.
    """
    table = posterior_table(posterior)
    notes = [tidy(str(note)) for note in posterior.get("notes", [])]
    return replace(table, note=" ".join([table.note, *notes])) if table.rows else table


def with_basis(table: Table, summary: Row) -> Table:
    """Return the table of the parameters; its note states what the intervals rest on."""
    return replace(table, note=f"{table.note} {_basis(summary['assumed'])}")


def _basis(assumed: Sequence[Row]) -> str:
    """Return a sentence on the systematic errors that intervals contain, and on what they do not.

    Those that move a parameter, each with the parameter that one standard uncertainty moves most.
    """
    largest: dict[str, Row] = {}
    for item in assumed:
        name = OF_ONE_TEST.sub("", str(item["name"]))
        if abs(item.get("moves_by") or 0.0) >= max(
            SEEN, abs(largest.get(name, {}).get("moves_by", 0.0))
        ):
            largest[name] = item
    if not largest:
        return f"Standard errors contain the scatter of the tests. {NOT_CONTAINED}"
    parts = [
        f"{name} {_spread(item)} ({item['moves']} by {percent(abs(item['moves_by']), 1)})"
        for name, item in largest.items()
    ]
    return (
        "Standard errors and intervals contain the scatter of the tests and these systematic "
        "errors, each with the parameter that one standard uncertainty moves most: "
        f"{joined(parts)}. {_enlarged(assumed)}{NOT_CONTAINED}"
    )


def _enlarged(assumed: Sequence[Row]) -> str:
    """Return by which factors systematic errors are larger than stated; "" where none is.

    Where model and test differ by more than noise, the errors are so large that they explain it.
    """
    factors: dict[str, float] = {}
    for item in assumed:
        name = OF_ONE_TEST.sub("", str(item["name"]))
        factors[name] = max(factors.get(name, 0.0), item.get("enlarged_by") or 0.0)
    parts = [
        f"{name} by {number(factor, '.2g')}" for name, factor in factors.items() if factor >= LARGER
    ]
    if not parts:
        return ""
    return (
        "Since model and tests differ by more than noise, some of these errors were multiplied "
        f"until they explain the difference ({joined(parts)}), in intervals and draws too. "
    )


def _spread(item: Row) -> str:
    """Return the standard uncertainty of an assumed value with its unit."""
    share, size = item["relative_uncertainty"], item["absolute_uncertainty"]
    spread = f"± {100.0 * share:.3g} %" if share is not None else f"± {size:g}"
    return f"{spread} {item.get('unit', '')}".strip()


def _report_checks(summary: Row) -> list[Check]:
    checks = [
        Check(
            f"R² of {record['name']}",
            float(record["R2"]),
            UNUSABLE,
            "",
            f"minimum for acceptance; below {POOR_R2:g} a warning is given",
            PASSED if record["R2"] >= UNUSABLE else EXCEEDED,
            lower=True,
            rounded=_rounded_R2(float(record["R2"])),
        )
        for record in summary["records"]
    ]
    held_out = summary.get("held_out") or {"tests": [], "limits": {}}
    return checks + [
        error_check(
            name, f"{test['test']} (held out)", test.get(f"{name}_error"), limit, test[verdict]
        )
        for test in held_out["tests"]
        if test["role"] == "held out"
        for name, limit in held_out["limits"].items()
        for verdict in [f"{name}_verdict"]
    ]


def error_check(name: str, whose: str, error: float | None, limit: float, verdict: str) -> Check:
    """Return the check of the largest error of a quantity in a test."""
    value = float("nan") if error is None else abs(100.0 * error)
    outcome = {"within": PASSED, "beyond": EXCEEDED}.get(str(verdict), NOT_ASSESSED)
    label = f"error of {name}, {whose}"
    return Check(label, value, 100.0 * limit, "%", limit_source(name, limit), outcome)


def _assumptions(summary: Row, bearing: Row) -> list[str]:
    sentences = [
        f"Search: {summary['method']}, {counted(int(summary['evaluations']), 'evaluation')}. "
        "Standard errors include the scatter of the tests and the uncertainty of what is held."
    ]
    fixed = [
        f"{key.rsplit('.', 1)[-1].replace('_', ' ')} = {number(item['value'], '.4g')} "
        f"{item['unit']}".strip()
        for key, item in summary["fixed"].items()
    ]
    if fixed:
        sentences.append(f"Not calibrated, but taken from the starting bearing: {joined(fixed)}.")
    assumptions = [text for r in summary["records"] for text in r["conditions"]["assumptions"]]
    sentences += [
        tidy(f"Assumed in reading the files: {text}") for text in dict.fromkeys(assumptions)
    ]
    sentences += _contradictions(summary["assumed"], summary.get("suspects") or [])
    removed = summary.get("removed_by_finer_cells")
    if removed is not None and abs(removed) < 1.0:
        sentences.append(
            "A finer division into heat cells, twice as many in rubber and shims or the defaults "
            f"where the file has fewer, changes the squared residuals by "
            f"{number(-100.0 * removed, '+.2g')} %."
        )
    sentences += model_assumptions({"scheme": "conservative", "heat_source": None}, [bearing])
    return sentences


def _contradictions(assumed: Sequence[Row], suspects: Sequence[Row]) -> list[str]:
    """Return which assumed values the tests contradict, and how that relates to the misfit.

    The causes of the misfit are `suspects`, in the order in which Warnings name them.
    """
    imitated = [item["name"] for item in assumed if item.get("imitated")]
    causes = [item["name"] for item in suspects if item.get("named")]
    sentences = []
    for item in assumed:
        if not item.get("contradicted"):
            continue
        text = "With the other assumed values as they are, the tests require another "
        text += str(item["name"])
        if item.get("tests_ask_for") is not None:  # results of older versions have no sizes
            size = size_words(item["tests_ask_for"], item["unit_of_that"])
            errors = number(abs(item["tests_ask_for_sigmas"]), ".3g")
            text += f", {size} ({errors} usual errors)"
        if item["name"] in causes:
            place = causes.index(item["name"]) + 1
            text += f". This is one possible cause of the misfit, number {place} of {len(causes)}"
            text += " under Warnings"
        if causes:
            text += ". A wrong description of the bearing (plan, number and thickness of the "
            text += "rubber layers) would require it as well"
        sentences.append(f"{text}.")
    if imitated:
        sentences.append(
            f"The tests do not contradict the assumed {joined(imitated)}: model and test differ "
            "(possible causes: Warnings), and with one of these causes removed the tests no longer "
            "require another value."
        )
    return sentences


def _checked(saved: SavedResult) -> Pieces:
    """Return the pieces of the report of `identify --check`, which calibrates nothing."""
    records = saved.summary["records"]
    refused, warned = (
        joined(str(r["name"]) for r in records if r["outcome"] == outcome)
        for outcome in ("refused", "warning")
    )
    verdict = f"{refused} cannot be used" if refused else "All tests can be used"
    remark = f"; {warned} with the warnings below" if warned else ""
    return Pieces(
        command="check",
        title="Check of tests",
        question=f"This report assesses the suitability of {counted(len(records), 'test')} "
        f"({joined(str(r['name']) for r in records)}) for a calibration.",
        answer=[
            f"{verdict}{remark}.",
            f"They contain {sum(int(r['cycles']) for r in records)} cycles.",
        ],
        inputs={"treatment": treatment_table(records)},
        tables={"findings": _findings_table(records)},
        figures=content.saved_figures(saved, "identify"),
        validity_unknown="Nothing was calibrated, so no statement on validity is made.",
        identity=content.saved_identity(saved, "thermobearing.check_test(...) in Python"),
    )
