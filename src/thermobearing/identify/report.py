"""Tables and reports of a calibration and of checked tests.

The tables are built from the content of summary.json or of a CSV file. The console shows some of
them, and `validate` uses them too.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.identify.result import POOR_R2, UNUSABLE
from thermobearing.identify.uncertainty.covariance import POOR
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report import content
from thermobearing.report.content import TESTS
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
from thermobearing.report.words import (
    counted,
    degrees,
    joined,
    number,
    percent,
    printed_unit,
    quantity,
    tidy,
)
from thermobearing.results.base import COMPLETED
from thermobearing.results.directory import IDENTIFIED
from thermobearing.results.ranges import MARKED, parted
from thermobearing.results.saved import SavedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Row = Mapping[Any, Any]
STRONG = 0.9  # correlation that is reported
AT_BOUND, POORLY, NOT = "at its bound", "poorly", "no"
MOST_ROWS = 200
CONDITIONS = ["test", "file", "ambient_degC", "duration_s", "samples", "largest_displacement_mm"]
CONDITIONS += ["largest_strain", "largest_force_kN", "largest_speed_mm_s", "weight"]
CONDITIONS += ["thermocouples"]
BRIEF = ["symbol", "unit", "estimate", "standard_error", "interval_lower", "interval_upper"]
BRIEF += ["determined"]
LOOPS = (("test", "force_kN", "#9aa4b1"), ("model", "model_force_kN", "#CC3311"))
CYCLE_MEASURES = ("G_eq_error", "h_eq_error", "energy_error", "force_max_error")


def figure_captions(command: str) -> dict[str, str]:
    """Return the captions of the figures of `identify` or `validate`, by name of the file."""
    found: dict[str, str] = read_toml(data_path("reports", "comparison_figures.toml"))[command]
    return found


def tests_table(records: Sequence[Row]) -> Table:
    """Return the conditions of each test."""
    rows = []
    for record in records:
        held = record.get("conditions") or {}
        places = [f"{title}: {place}" for title, place in held.get("thermocouples", {}).items()]
        row = {name: record.get(name) for name in ("file", "ambient_degC")} | held
        row |= {"test": record.get("name", record.get("test")), "thermocouples": ", ".join(places)}
        rows.append(row)
    usual = all(row.get("weight", 1.0) == 1.0 for row in rows)
    names = [name for name in CONDITIONS if not (usual and name == "weight")]
    return make_table(pd.DataFrame(rows), names, "Tests")


def _treatment_table(records: Sequence[Row]) -> Table:
    """Return the treatment of each record before its fit: noise, rests, spikes, drift of zero."""
    rows = []
    for record in records:
        held = record.get("treatment") or {}
        drift = [f"{name} {value:.3g}" for name, value in held.get("drift", {}).items()]
        rows.append(
            {
                "test": record["name"],
                "noise_displacement_mm": held.get("noise", {}).get("displacement_mm"),
                "noise_force_kN": held.get("noise", {}).get("force_kN"),
                "rests_held": held.get("rests"),
                "samples_at_rest": held.get("samples_at_rest"),
                "spikes_found": sum(held["spikes"].values()) if held else None,
                "spikes_removed": "yes" if held.get("spikes_removed") else "no",
                "drift_of_zero": ", ".join(drift) or "none found",
                "drift_removed": ", ".join(held.get("drift_removed", [])) or "nothing",
                "columns_not_used": ", ".join(record.get("unused_columns", [])),
            }
        )
    note = "Logged rests are held at constant displacement; "
    note += "spikes and drift are removed on request."
    return make_table(pd.DataFrame(rows), caption="Treatment of the records", note=note)


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
    note = "Standard errors include the uncertainty of the parameters that are held. "
    note += _correlated(summary)
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
        return f"No correlation reaches {STRONG:g}."
    return f"Strongly correlated: {joined(pairs)}; interpret them together."


def agreement_table(records: Sequence[Row]) -> Table:
    """Return the agreement of the model with each test, and the errors of its cycles."""
    rows = []
    for record in records:
        row = {"test": record["name"], "ambient_degC": round(record["ambient_degC"], 2)}
        row |= {"R2": record["R2"], "NRMSE": record["NRMSE"], "cycles_found": len(record["cycles"])}
        for name in CYCLE_MEASURES:
            errors = [cycle[name] for cycle in record["cycles"]] or [float("nan")]
            row |= {f"{name}_least": min(errors), f"{name}_largest": max(errors)}
        rows.append(row)
    note = "R² and NRMSE are those of the force over the complete test. Errors of its cycles "
    note += "(model / test - 1) are given from the smallest to the largest."
    return make_table(pd.DataFrame(rows), caption="Agreement with the tests", keys=2, note=note)


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
    left = len(cycles) - len(frame)
    note = "K_eq and h_eq follow Eq. 3.1 and 3.2. The displacement is half the range of a cycle; "
    note += f"the model follows the measured displacement. {CLOSING}"
    note += f" {left} more cycles are in cycles.csv." if left else ""
    heads = dict.fromkeys(("K_eq_error", "h_eq_error", "energy_error"), "error")
    return make_table(
        frame, names, "Cycles measured in test and model", keys=3, heads=heads, note=note
    )


def thermocouples_table(rows: Sequence[Row]) -> Table:
    """Return the thermocouples of test and model."""
    caption = "Thermocouples, model compared with test"
    return make_table(pd.DataFrame(rows), caption=caption, keys=3)


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
    note = "Largest error over the cycles (model / test - 1)."
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
                "unit": printed_unit(str(row["unit"]))[0],
                "predicted_best": values["best"],
                "predicted_lower": values["lower"],
                "predicted_upper": values["upper"],
                "share_not_determined": row["share_not_determined"],
                "outside_tests": ", ".join(beyond).replace("_", " ") or "nothing",
            }
        )
    marks = [row["outside_tests"] != "nothing" for row in rows]
    note = f"From {posterior.get('samples')} samples of the posterior ({posterior.get('source')}), "
    note += "in posterior.csv. Not determined: share of the variance from what the tests did not "
    note += "determine." + (f" {MARKED}; the band is wider there." if any(marks) else "")
    how: dict[str, Any] = {"keys": 2, "marked": {"ambient_degC": marks}, "note": note}
    return make_table(pd.DataFrame(rows), caption="Predicted in the largest loop", **how)


def _undetermined_table(summary: Row) -> Table:
    """Return what is not free or not determined, and why."""
    rows = []
    for item in summary["parameters"].values():
        if (known := _grade(item)) in (AT_BOUND, NOT, POORLY):
            near = {AT_BOUND: AT_BOUND, NOT: "near its bound"}.get(known)
            spread = near or f"± {item['stderr']:.2g} {item['unit']}".strip()
            rows.append((item["symbol"], spread, "free, but poorly determined by the tests"))
    for key, item in summary.get("sensitivity", {}).items():
        if not item.get("free", True):
            why = "held: the tests contain too little information on it"
            if item["stderr_of_source"] is not None and item["stderr_expected"] is not None:
                why = f"held: ± {item['stderr_of_source']:.2g} by its source, "
                why += f"± {item['stderr_expected']:.2g} by these tests"
            rows.append((content.key_words(key), "not free", why))
    for item in summary["assumed"]:
        share, size = item["relative_uncertainty"], item["absolute_uncertainty"]
        spread = f"± {100.0 * share:.3g} %" if share is not None else f"± {size:g}"
        rows.append((item["name"], f"{spread} {item.get('unit', '')}".strip(), item["source"]))
    frame = pd.DataFrame(rows, columns=["what", "uncertainty", "reason_or_source"])
    return make_table(frame, caption="Parameters that the tests do not determine")


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
        f"Calibration of {summary['bearing']}",
        f"Calibration of the bearing {bearing_words(named)} to {counted(len(tests), 'test')} "
        f"({joined(tests)}) at {degrees([r['ambient_degC'] for r in summary['records']])}: "
        "parameters, their uncertainty, and agreement of the model with the tests.",
        _answer(summary, bearing, checks),
        checks=checks,
        judged=False,
        inputs={
            "tests": tests_table(summary["records"]),
            "treatment": _treatment_table(summary["records"]),
            **bearing_tables(bearing, sources),
        },
        tables=_report_tables(saved),
        figures=_report_figures(saved),
        validity=list(map(tidy, parted(predicted)[0])),
        assumptions=_assumptions(summary, bearing),
        **content.saved_parts(saved, "thermobearing.identify_bearing(...) in Python"),
    )


def _report_figures(saved: SavedResult) -> dict[str, ReportFigure]:
    found = content.saved_figures(saved, figure_captions("identify"))
    if "fit" not in saved.tables:
        return found
    choices = {
        str(saved.summary["records"][int(str(k))]["name"]): [
            loop_trace(name, rows, column, colour) for name, column, colour in LOOPS
        ]
        for k, rows in saved["fit"].groupby("record", sort=False)
    }
    plot = Plot("displacement [mm]", "force [kN]", choices)
    return content.with_plot(found, "loops", plot, figure_captions("identify"))


def loop_trace(name: str, rows: "pd.DataFrame", column: str, colour: str) -> Trace:
    """Return the loops of a column of fit.csv as a line of a plot."""
    x, force = (rows[one].to_numpy(dtype=float) for one in ("displacement_mm", column))
    return Trace(name, x, force, colour)


def _answer(summary: Row, bearing: Row, checks: list[Check]) -> list[str]:
    found = []
    if summary["outcome"] != "completed":
        outcome, sentence = summary["outcome"].replace("_", " "), tidy(summary["sentence"])
        found.append(f"The calibrated bearing is not acceptable ({outcome}): {sentence}")
    parameters, records = list(summary["parameters"].values()), summary["records"]
    values = [
        f"{item['symbol']} = {number(item['value'], '.4g')} {item['unit']}".strip()
        + f" ({number(item['lower'], '.4g')} to {number(item['upper'], '.4g')})"
        for item in parameters
    ]
    found.append(f"Calibrated parameters with 95 % intervals: {joined(values)}.")
    cycles = [cycle for record in records for cycle in record["cycles"]]
    worst = ("G_eq_error", "G_e"), ("h_eq_error", "h_eq"), ("energy_error", "energy")
    off = [
        f"{percent(max((abs(cycle[name]) for cycle in cycles), default=0.0), 1)} in {words}"
        for name, words in worst
    ]
    found.append(
        f"R² of the force is at least {min(r['R2'] for r in records):.4f} in every test (NRMSE at "
        f"most {percent(max(r['NRMSE'] for r in records), 1)}); errors of single cycles are up to "
        f"{joined(off)}."
    )
    largest = percent(max(_relative_error(p) for p in parameters), 1)
    known = f"Standard errors are at most {largest} of the estimates"
    if weak := [p["symbol"] for p in parameters if _grade(p) in (POORLY, AT_BOUND, NOT)]:
        known = f"Poorly determined by these tests: {joined(weak)}"
    held = summary.get("held_out")
    judged = f" Validation tests: {held['verdict']} the limits." if held else ""
    found.append(f"{known}.{judged} {content.summarize_checks(checks)}")
    if valid := _valid_for(bearing):
        found.append(f"{valid}; the table of its calibration range lists all limits.")
    return found


def _valid_for(bearing: Row) -> str:
    """Return a sentence on the conditions of the tests, without its full stop; "" if unknown."""
    tested = bearing.get("tested_range") or {}
    if "strain" not in tested:
        return ""
    strains = " to ".join(dict.fromkeys(percent(end) for end in tested["strain"]))
    ambients = " to ".join(dict.fromkeys(quantity(end) for end in tested["ambient"]))
    return (
        f"The bearing is valid for shear strains of {strains} at ambient temperatures of {ambients}"
    )


def _report_tables(saved: SavedResult) -> dict[str, Table]:
    summary = saved.summary
    held = summary.get("held_out") or {"tests": []}
    cycles = saved.tables.get("cycles")
    found = {
        "parameters": parameters_table(summary),
        "records": agreement_table(summary["records"]),
        "cycles": None if cycles is None else cycles_table(cycles),
        "thermocouples": thermocouples_table(summary["thermocouples"]),
        "held_out": errors_table("Validation tests", held["tests"]),
        "posterior": posterior_table(summary.get("posterior") or {}),
        "undetermined": _undetermined_table(summary),
    }
    return {name: table for name, table in found.items() if table and table.rows}


def _report_checks(summary: Row) -> list[Check]:
    found = [
        Check(
            f"R² of {record['name']}",
            float(record["R2"]),
            UNUSABLE,
            "",
            f"minimum for acceptance; below {POOR_R2:g} a warning is given",
            PASSED if record["R2"] >= UNUSABLE else EXCEEDED,
            lower=True,
        )
        for record in summary["records"]
    ]
    held = summary.get("held_out") or {"tests": [], "limits": {}}
    return found + [
        error_check(
            name, f"{test['test']} (held out)", test.get(f"{name}_error"), limit, test[verdict]
        )
        for test in held["tests"]
        if test["role"] == "held out"
        for name, limit in held["limits"].items()
        for verdict in [f"{name}_verdict"]
    ]


def error_check(name: str, whose: str, error: float | None, limit: float, verdict: str) -> Check:
    """Return the check of the largest error of a quantity in a test."""
    value = float("nan") if error is None else abs(100.0 * error)
    known = {"within": PASSED, "beyond": EXCEEDED}.get(str(verdict), NOT_ASSESSED)
    what = f"error of {name}, {whose}"
    return Check(what, value, 100.0 * limit, "%", "limit of the error", known)


def _assumptions(summary: Row, bearing: Row) -> list[str]:
    found = [
        f"Search: {summary['method']}, {counted(int(summary['evaluations']), 'evaluation')}. "
        "Standard errors include the scatter along each test and the uncertainty of the parameters "
        "that are held."
    ]
    held = [
        f"{key.rsplit('.', 1)[-1].replace('_', ' ')} = {number(item['value'], '.4g')} "
        f"{item['unit']}".strip()
        for key, item in summary["fixed"].items()
    ]
    if held:
        found.append(f"Held at the values of the starting bearing: {joined(held)}.")
    said = [text for r in summary["records"] for text in r["conditions"]["assumptions"]]
    found += [tidy(f"Not stated in the files: {text}") for text in dict.fromkeys(said)]
    contradicted = [item["name"] for item in summary["assumed"] if item["contradicted"]]
    if contradicted:
        found.append(f"The tests contradict the assumed {joined(contradicted)}.")
    return [*found, *model_assumptions({"scheme": "conservative", "heat_source": None}, [bearing])]


SIGNED = ("Tested by", "Calibrated by", "Approved by")
PAGE_ROWS = 21  # of all tables on the page of a certificate with a title block and a logo
MOST_LOOPS = 3  # panels of its figure
ABOUT = ["test", "specimen", "laboratory", "date", "ambient_degC", "rubber_before", "cycles_found"]
ABOUT += ["largest_strain", "largest_speed_mm_s", "R2"]


def build_certificate(saved: SavedResult) -> Pieces:
    """Return the pieces of the certificate of a calibration, which fills one page.

    Raises InputError for anything but a completed calibration.
    """
    summary = saved.summary
    if saved.command != "identify" or "parameters" not in summary:
        raise InputError("only a calibration (`identify`) has a certificate", str(saved.path))
    outcome = str(summary["outcome"])
    if outcome != COMPLETED:
        why = f"{outcome.replace('_', ' ')}: {summary['sentence']}"
        raise InputError(f"there is no certificate of this calibration ({why})", str(saved.path))
    bearing, _ = split_sources(read_toml(saved.path / IDENTIFIED))
    named = {**bearing, "name": summary["bearing"]}
    tests = [str(record["name"]) for record in summary["records"]]
    parameters = replace(parameters_table(summary, BRIEF), note="")
    tables = {"tests": _certified_tests(summary["records"])}
    room = PAGE_ROWS - len(tests) - len(parameters.rows)
    if "cycles" in saved.tables and room >= len(tests):
        tables["cycles"] = _certified_cycles(saved["cycles"], room)
    elif "cycles" in saved.tables:
        tables["tests"] = replace(tables["tests"], note="The cycles are in cycles.csv.")
    tables["parameters"] = parameters
    identity = content.saved_identity(saved, "thermobearing.identify_bearing(...) in Python")
    digests = [f"{what}: `{text}`." for what, text in identity.items() if "inputs" in what]
    return Pieces(
        command="certificate",
        title=f"Calibration certificate of {summary['bearing']}",
        question=f"The model of the bearing {bearing_words(named)} was calibrated to "
        f"{counted(len(tests), 'test')} ({joined(tests)}). "
        "Its parameters hold for bearings of the same rubber compound.",
        answer=[*_certified_range(bearing, len(saved.warnings)), *digests],
        tables=tables,
        figures={"loops": _certified_loops(saved)} if "fit" in saved.tables else {},
        identity=identity,
        signatures=SIGNED,
    )


def _certified_tests(records: Sequence[Row]) -> Table:
    """Return what each test was: specimen, laboratory, temperature, rubber before, cycles."""
    words = {True: "scragged", False: "virgin", None: "not stated"}
    rows = []
    for record in records:
        row = {"test": record["name"], "ambient_degC": record["ambient_degC"], "R2": record["R2"]}
        held = record["conditions"]
        row |= {"rubber_before": words[held.get("scragged")]}
        rows.append(held | row | {"cycles_found": len(record["cycles"])})
    heads = {"rubber_before": "Rubber before"}
    return make_table(pd.DataFrame(rows), ABOUT, "Tests", heads=heads, keep_keys=True)


def _certified_cycles(cycles: "pd.DataFrame", room: int) -> Table:
    """Return K_eq, Q_d and h_eq of cycles in test and model, in as many rows as there is room."""
    groups = [rows for _, rows in cycles.groupby("test", sort=False)]
    most = max(1, room // len(groups))
    frame = pd.concat(
        rows.iloc[np.linspace(0, len(rows) - 1, min(most, len(rows))).round().astype(int)]
        for rows in groups
    )
    frame["cycle_displacement_mm"] = 0.5 * (frame["D+_mm"] - frame["D-_mm"])
    names = ["test", "ambient_degC", "cycle", "cycle_displacement_mm"]
    for name in ("K_eq", "Q_d", "h_eq"):
        names += [f"{name}_test", f"{name}_model"]
    notes = []
    if len(frame) < len(cycles):
        listed = f"At most {counted(most, 'cycle')} of each test, spread evenly from the first to "
        notes.append(f"{listed}the last; cycles.csv has all {len(cycles)}.")
    notes += [CLOSING] * any(rows["cycle"].max() > len(rows) for rows in groups)
    caption = "Cycles in test and model"
    return make_table(frame, names, caption, keys=3, note=" ".join(notes), keep_keys=True)


def _certified_range(bearing: Row, warnings: int) -> list[str]:
    """Return the calibration range of a bearing, and how many warnings its calibration has."""
    ranges = bearing.get("tested_range") or {}
    rest = [
        f"{TESTS[name]} {' to '.join(dict.fromkeys(str(quantity(end)) for end in ends))}"
        for name, ends in ranges.items()
        if name not in ("strain", "ambient")
    ]
    valid = _valid_for(bearing)
    found = [f"Calibration range: {valid[:1].lower()}{valid[1:]}; {joined(rest)}."] if valid else []
    if warnings:
        found.append(
            f"The calibration has {counted(warnings, 'warning')}, which report.html lists."
        )
    return found


def _certified_loops(saved: SavedResult) -> ReportFigure:
    """Return the loops of tests and model, in panels side by side."""
    records = saved.summary["records"]
    some = f", {MOST_LOOPS} of {len(records)} tests" if len(records) > MOST_LOOPS else ""

    def _draw() -> "Figure":
        from thermobearing.results import drawing

        groups = list(saved["fit"].groupby("record", sort=False))[:MOST_LOOPS]
        figure, axes = drawing.panels(1, len(groups), (7.0, 1.6), "")
        for ax, (k, rows) in zip(axes, groups, strict=True):
            record = records[int(str(k))]
            for (_, column, colour), width in zip(LOOPS, (2.4, 0.8), strict=True):
                ax.plot(rows["displacement_mm"], rows[column], color=colour, linewidth=width)
            title = f"{record['name']}, {drawing.degrees(record['ambient_degC'])}"
            drawing.name_axes(ax, "displacement [mm]", "force [kN]", title)
        return figure

    caption = f"Loops of the test (grey band) and the model (red line){some}."
    return ReportFigure(caption, draw=_draw)


def _checked(saved: SavedResult) -> Pieces:
    """Return the pieces of the report of `identify --check`, which calibrates nothing."""
    records = saved.summary["records"]
    refused, warned = (
        joined(str(r["name"]) for r in records if r["outcome"] == outcome)
        for outcome in ("refused", "warning")
    )
    verdict = f"{refused} cannot be used" if refused else "All tests can be used"
    more = f"; {warned} with the warnings below" if warned else ""
    return Pieces(
        command="check",
        title="Check of tests",
        question=f"This report assesses the suitability of {counted(len(records), 'test')} "
        f"({joined(str(r['name']) for r in records)}) for a calibration.",
        answer=[
            f"{verdict}{more}.",
            f"They contain {sum(int(r['cycles']) for r in records)} cycles.",
        ],
        inputs={"treatment": _treatment_table(records)},
        tables={"findings": _findings_table(records)},
        figures=content.saved_figures(saved, figure_captions("identify")),
        validity_unknown="Nothing was calibrated, so no statement on validity is made.",
        identity=content.saved_identity(saved, "thermobearing.check_test(...) in Python"),
    )
