"""Tables of a calibration and of checked tests, for the console and for reports.

Each is made of what summary.json or a CSV file holds; `validate` shows some of them too.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.identify.uncertainty.covariance import POOR
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report.content import key_words
from thermobearing.report.words import joined

Row = Mapping[Any, Any]
STRONG = 0.9  # correlation that is reported
AT_BOUND, POORLY, NOT = "at its bound", "poorly", "no"
MOST_ROWS = 200
CONDITIONS = ["test", "file", "ambient_degC", "duration_s", "samples", "largest_displacement_mm"]
CONDITIONS += ["largest_strain", "largest_force_kN", "largest_speed_mm_s", "weight"]
CONDITIONS += ["thermocouples", "sha256"]
BRIEF = ["symbol", "unit", "estimate", "standard_error", "interval_lower", "interval_upper"]
BRIEF += ["determined"]
CYCLE_MEASURES = ("G_eq_error", "h_eq_error", "energy_error", "force_max_error")
MARKED = " Marked: beyond what the bearing was tested at."


def tests_table(records: Sequence[Row]) -> Table:
    """Return the conditions of each test."""
    rows = []
    for record in records:
        held = record.get("conditions") or {}
        places = [f"{title}: {place}" for title, place in held.get("thermocouples", {}).items()]
        words = {"thermocouples": ", ".join(places), "sha256": str(held.get("sha256", ""))[:16]}
        name = record.get("name", record.get("test"))
        whose = {"test": name, "file": record["file"], "ambient_degC": record["ambient_degC"]}
        rows.append(whose | held | words)
    usual = all(row.get("weight", 1.0) == 1.0 for row in rows)
    names = [name for name in CONDITIONS if not (usual and name == "weight")]
    note = "Of the hash the first 16 digits; all are in summary.json."
    return make_table(pd.DataFrame(rows), names, "Tests", note=note)


def treatment_table(records: Sequence[Row]) -> Table:
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
    note = "Rests that were logged are held; spikes and drift are removed only on request."
    return make_table(pd.DataFrame(rows), caption="Treatment of the records", note=note)


def findings_table(records: Sequence[Row]) -> Table:
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
            "parameter": key_words(key).removesuffix(f" {item['symbol']}"),
            "symbol": item["symbol"],
            "unit": item["unit"],
            "estimate": item["value"],
            "standard_error": None if item["at_bound"] else item["stderr"],
            "standard_error_of_tests": None if item["at_bound"] else item["stderr_of_tests"],
            "interval_lower": item["lower"],
            "interval_upper": item["upper"],
            "determined": grade(item),
            "start_value": item["start"],
        }
        for key, item in summary["parameters"].items()
    ]
    note = f"Standard errors include those of the values that are not free. {_correlated(summary)}"
    return make_table(pd.DataFrame(rows), names, "Identified parameters", keys=2, note=note)


def relative_error(item: Row) -> float:
    """Return the standard error over the estimate; infinite if it is not determined."""
    if not item.get("determined", not item["at_bound"]) or item["stderr"] is None:
        return float("inf")
    return float(item["stderr"]) / max(abs(float(item["value"])), 1e-12)


def grade(item: Row) -> str:
    """Return how well the tests determine a parameter."""
    if item["at_bound"]:
        return AT_BOUND
    if not item.get("determined", True):
        return NOT
    if relative_error(item) > POOR:
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
    return f"Strongly correlated: {joined(pairs)}; read them together."


def agreement_table(records: Sequence[Row]) -> Table:
    """Return the agreement of the model with each test, and the errors of its cycles."""
    rows = []
    for record in records:
        row = {"test": record["name"], "ambient_degC": round(record["ambient_degC"], 2)}
        row |= {"R2": record["R2"], "NRMSE": record["NRMSE"]}
        row |= {"cycles_found": len(record["cycles"])}
        for name in CYCLE_MEASURES:
            errors = [cycle[name] for cycle in record["cycles"]] or [float("nan")]
            row |= {f"{name}_least": min(errors), f"{name}_largest": max(errors)}
        rows.append(row)
    note = "R² and NRMSE of the force over the whole test; errors of its cycles (model over test, "
    note += "less one) from the least to the largest."
    return make_table(pd.DataFrame(rows), caption="Agreement with the tests", keys=2, note=note)


def cycles_table(cycles: pd.DataFrame) -> Table:
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
    note = "K_eq and h_eq as Eq. 3.1 and 3.2; displacement: half the range of a cycle, which is "
    note += "the test's and moves the model."
    note += f" {left} more cycles are in cycles.csv." if left else ""
    heads = dict.fromkeys(("K_eq_error", "h_eq_error", "energy_error"), "error")
    caption = "Cycles measured in test and model"
    return make_table(frame, names, caption, keys=3, heads=heads, note=note)


def thermocouples_table(rows: Sequence[Row], caption: str = "") -> Table:
    """Return the thermocouples of test and model."""
    caption = caption or "Thermocouples, model compared with test"
    return make_table(pd.DataFrame(rows), caption=caption, keys=3)


def errors_table(caption: str, tests: Sequence[Row], keys: Sequence[str]) -> Table:
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
    note = "Largest error over the cycles (model over test, less one)."
    note += MARKED if any(marks) else ""
    columns = [*keys, "ambient_degC", "R2", *(f"{name}_error" for name in names), "beyond_a_limit"]
    marked = {"ambient_degC": marks}
    return make_table(frame, columns, caption, keys=len(keys), marked=marked, note=note)


def posterior_table(posterior: Row) -> Table:
    """Return the peak forces that the samples of the posterior predict."""
    rows = posterior.get("peak_force", [])
    marks = ["ambient" in str(row.get("beyond_tested") or "").split() for row in rows]
    note = f"Of {posterior.get('samples')} samples of the posterior ({posterior.get('source')}); "
    note += "they are in posterior.csv." + (MARKED if any(marks) else "")
    names = ("ambient_degC", "best_kN", "lower_kN", "upper_kN")
    marked = {"ambient_degC": marks}
    caption = "Predicted peak force"
    return make_table(pd.DataFrame(rows), names, caption, keys=0, marked=marked, note=note)


def undetermined_table(summary: Row) -> Table:
    """Return what is not free or not determined, and why."""
    rows = []
    for item in summary["parameters"].values():
        if (known := grade(item)) in (AT_BOUND, NOT, POORLY):
            near = {AT_BOUND: AT_BOUND, NOT: "near its bound"}.get(known)
            spread = near or f"± {item['stderr']:.2g} {item['unit']}".strip()
            rows.append((item["symbol"], spread, "free, and hardly determined by the tests"))
    for key, item in summary.get("sensitivity", {}).items():
        if not item.get("free", True):
            why = "held: these tests say too little about it"
            if item["stderr_of_source"] is not None and item["stderr_expected"] is not None:
                why = f"held: its source knows it to ± {item['stderr_of_source']:.2g}, these tests "
                why += f"to ± {item['stderr_expected']:.2g}"
            rows.append((key_words(key), "not free", why))
    for item in summary["assumed"]:
        share, size = item["relative_uncertainty"], item["absolute_uncertainty"]
        spread = f"± {100.0 * share:.3g} %" if share is not None else f"± {size:g}"
        rows.append((item["name"], f"{spread} {item.get('unit', '')}".strip(), item["source"]))
    frame = pd.DataFrame(rows, columns=["what", "uncertainty", "reason_or_source"])
    return make_table(frame, caption="What the tests do not determine")
