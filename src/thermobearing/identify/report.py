"""Report of a calibration."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.reported import bearing_tables, bearing_words, model_assumptions
from thermobearing.identify.uncertainty.agreement import POOR as POOR_R2
from thermobearing.identify.uncertainty.covariance import POOR
from thermobearing.report.content import (
    key_words,
    saved_figures,
    saved_identity,
    saved_validity,
    verdict_of,
    with_plot,
)
from thermobearing.report.figures import path
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_JUDGED,
    PASSED,
    Check,
    Column,
    Pieces,
    Plot,
    ReportFigure,
    ReportTable,
    Trace,
)
from thermobearing.report.words import counted, degrees, joined, number, percent, quantity, tidy
from thermobearing.results.directory import IDENTIFIED
from thermobearing.results.ranges import parted
from thermobearing.results.saved import SavedResult

Record = Mapping[str, Any]
TEST = Column("Test")
STRONG = 0.9  # correlation that is told
AT_BOUND, POORLY, NOT = "at its bound", "poorly", "no"
MOST_ROWS = 200
AMBIENT = Column("Ambient", "°C", "g")


def tests_table(records: Sequence[Record]) -> ReportTable:
    """Conditions of each test."""
    columns = (
        TEST,
        Column("File"),
        AMBIENT,
        Column("Length", "s", ".1f"),
        Column("Samples", form="d"),
        Column("Largest displacement", "mm", ".1f"),
        Column("Largest strain", "%", ".0f"),
        Column("Largest force", "kN", ".1f"),
        Column("Largest speed", "mm/s", ".3g"),
        Column("Weight", form="g"),
        Column("Thermocouples"),
        Column("SHA-256 of its samples"),
    )
    rows = []
    for record in records:
        told = record.get("conditions") or {}
        places = [f"{title}: {place}" for title, place in told.get("thermocouples", {}).items()]
        strain = told.get("largest_strain")
        rows.append(
            (
                record.get("name", record.get("test")),
                record.get("file", ""),
                record["ambient_degC"],
                told.get("duration_s"),
                told.get("samples"),
                told.get("largest_displacement_mm"),
                None if strain is None else 100.0 * strain,
                told.get("largest_force_kN"),
                told.get("largest_speed_mm_s"),
                told.get("weight"),
                ", ".join(places),
                str(told.get("sha256", ""))[:16],
            )
        )
    note = "Of the hash the first 16 signs; all are in summary.json."
    usual = {"Weight": (None, 1), "Thermocouples": ("",)}  # what goes without saying
    said = [
        place
        for place, column in enumerate(columns)
        if any(row[place] not in usual.get(column.head, ()) for row in rows)
        or column.head not in usual
    ]
    cells = [[row[place] for place in said] for row in rows]
    return ReportTable("Tests", [columns[place] for place in said], cells, note=note)


def _treatment_table(records: Sequence[Record]) -> ReportTable:
    """What is between each record and its fit: noise, rests, spikes, drift, zero."""
    columns = (
        TEST,
        Column("Noise of displacement", "mm", ".2g"),
        Column("Noise of force", "kN", ".2g"),
        Column("Rests held", form="d"),
        Column("Samples in them", form="d"),
        Column("Spikes found", form="d"),
        Column("Spikes taken out"),
        Column("Drift of zero"),
        Column("Drift taken out"),
        Column("Columns not used"),
    )
    rows = []
    for record in records:
        told = record.get("treatment") or {}
        noise = told.get("noise", {})
        drift = [f"{name} {value:.3g}" for name, value in _drifts(told.get("drift", {}))]
        rows.append(
            (
                record.get("name"),
                noise.get("displacement_mm"),
                noise.get("force_kN"),
                told.get("rests"),
                told.get("samples_at_rest"),
                sum(told.get("spikes", {}).values()) if told else None,
                "yes" if told.get("spikes_removed") else "no",
                ", ".join(drift) or "none found",
                ", ".join(told.get("drift_removed", [])) or "nothing",
                ", ".join(record.get("unused_columns", [])),
            )
        )
    note = "Rests that the logger ran through are held; spikes and drift are taken out only where "
    note += "that was asked for."
    return ReportTable("Treatment of the records", columns, rows, note=note)


def _drifts(told: Mapping[str, Any]) -> list[tuple[str, float]]:
    """Numbers of the drift of each signal, whatever else is told of it."""
    found = []
    for name, value in told.items():
        if isinstance(value, Mapping):
            numbers = [(f"{name}, {key}", one) for key, one in value.items()]
        else:
            numbers = [(str(name), value)]
        found += [(key, float(one)) for key, one in numbers if isinstance(one, int | float)]
    return found


def _parameters_table(summary: Mapping[str, Any]) -> ReportTable:
    """Estimates with standard errors and intervals; strong correlation in words."""
    columns = (
        Column("Parameter"),
        Column("Symbol"),
        Column("Unit"),
        Column("Estimate", form=".4g"),
        Column("Standard error", form=".2g"),
        Column("of the tests alone", form=".2g"),
        Column("95 % from", form=".4g"),
        Column("to", form=".4g"),
        Column("Determined"),
        Column("Start", form=".4g"),
    )
    rows = []
    for key, item in summary["parameters"].items():
        errors = [None, None] if item["at_bound"] else [item["stderr"], item["stderr_of_tests"]]
        ends = [item["lower"], item["upper"]]
        head = (key_words(key).removesuffix(f" {item['symbol']}"), item["symbol"], item["unit"])
        rows.append((*head, item["value"], *errors, *ends, grade(item), item["start"]))
    note = "Standard errors count what was assumed of the numbers that are not free; beside them "
    note += f"those of the tests alone. {_correlated(summary)}"
    return ReportTable("Identified parameters", columns, rows, 2, note=note.strip())


def relative_error(item: Mapping[str, Any]) -> float:
    """Standard error over the estimate; infinite where it is not known."""
    if not item.get("determined", not item["at_bound"]) or item["stderr"] is None:
        return float("inf")
    return float(item["stderr"]) / max(abs(float(item["value"])), 1e-12)


def grade(item: Mapping[str, Any]) -> str:
    """How well the tests know a parameter."""
    if item["at_bound"]:
        return AT_BOUND
    if not item.get("determined", True):
        return NOT
    if relative_error(item) > POOR:
        return POORLY
    return "well" if item["well_determined"] else "yes"


def _correlated(summary: Mapping[str, Any]) -> str:
    """Pairs of parameters that the tests hardly tell apart."""
    told = summary["correlation"]
    symbols = [summary["parameters"][key]["symbol"] for key in told["parameters"]]
    matrix = np.array(told["matrix"], dtype=float).reshape(len(symbols), len(symbols))
    pairs = [
        f"{symbols[i]} and {symbols[j]} ({matrix[i, j]:+.2f})".replace("-", "\N{MINUS SIGN}")
        for i in range(len(symbols))
        for j in range(i)
        if abs(matrix[i, j]) >= STRONG
    ]
    if not pairs:
        return f"No correlation reaches {STRONG:g}."
    return f"Strongly correlated: {joined(pairs)}; read them together."


def _records_table(records: Sequence[Record]) -> ReportTable:
    """How well each test is met."""
    names = {"G_eq": "G_e", "h_eq": "h_eq", "energy": "Energy", "force_max": "Peak force"}
    columns = [TEST, AMBIENT, Column("R²", form=".4f"), Column("NRMSE", "%", ".2f")]
    columns += [Column("Cycles", form="d")]
    for head in names.values():
        columns += [Column(f"{head}: least error", "%", "+.1f"), Column("largest", "%", "+.1f")]
    rows = []
    for record in records:
        cells = [record["name"], record["ambient_degC"], record["R2"], 100.0 * record["NRMSE"]]
        cells.append(len(record["cycles"]))
        for name in names:
            errors = [100.0 * cycle[f"{name}_error"] for cycle in record["cycles"]]
            cells += [min(errors), max(errors)] if errors else [None, None]
        rows.append(cells)
    note = "R² and NRMSE of the force over the whole test; errors (model over test, less one) over "
    note += "its cycles."
    return ReportTable("Residuals of the tests", columns, rows, note=note)


def cycles_table(saved: SavedResult) -> ReportTable | None:
    """Each cycle measured in the test and in the model."""
    if "cycles" not in saved.tables:
        return None
    table = saved["cycles"]
    names = {"K_eq": ("K_eq", "kN/mm", ".3f"), "h_eq": ("h_eq", "", ".3f")}
    columns = [TEST, AMBIENT, Column("Cycle", form="d"), Column("Displacement", "mm", ".1f")]
    for head, unit, form in names.values():
        columns += [Column(f"{head}, test", unit, form), Column("model", unit, form)]
        columns.append(Column("error", "%", "+.1f"))
    columns += [Column("Energy, test", "kJ", ".2f"), Column("model", "kJ", ".2f")]
    columns += [Column("error", "%", "+.1f"), Column("F+, test", "kN", ".1f")]
    columns += [Column("model", "kN", ".1f"), Column("F−, test", "kN", ".1f")]
    columns.append(Column("model", "kN", ".1f"))
    rows = []
    for row in table.head(MOST_ROWS).to_dict("records"):
        far = 0.5 * (row["D+_mm"] - row["D-_mm"])
        role = str(row["bearing"]).partition(", ")[2]  # of a fit that is judged
        test = f"{row['test']} ({role})" if role else row["test"]
        cells = [test, row["ambient_degC"], int(row["cycle"]), far]
        for name, factor in (("K_eq", 1.0), ("h_eq", 1.0), ("energy", 1e-3)):
            cells += [factor * row[f"{name}_test"], factor * row[f"{name}_model"]]
            cells.append(100.0 * (row[f"{name}_ratio"] - 1.0))
        cells += [row[f"{side}_{who}"] for side in ("F+", "F-") for who in ("test", "model")]
        rows.append(cells)
    left = len(table) - len(rows)
    note = "K_eq and h_eq as Eq. 3.1 and 3.2; displacement: half of what is between the ends of a "
    note += "cycle, which is the test's and moves the model."
    note += f" {left} more cycles are in cycles.csv." if left else ""
    return ReportTable("Cycles measured in test and model", columns, rows, 3, note=note)


def thermocouples_table(rows: Sequence[Mapping[str, Any]]) -> ReportTable | None:
    """Thermocouples of test and model; None without any."""
    if not rows:
        return None
    columns = (
        TEST,
        Column("Thermocouple"),
        Column("Place"),
        Column("Start", "°C", ".1f"),
        Column("Highest, test", "°C", ".1f"),
        Column("Highest, model", "°C", ".1f"),
        Column("Rise, test", "K", ".2f"),
        Column("Rise, model", "K", ".2f"),
        Column("Error of the rise", "%", "+.1f"),
        Column("rms difference", "K", ".2f"),
    )
    cells = [
        (
            row["test"],
            row["thermocouple"],
            row["place"],
            row["start_test_degC"],
            row["highest_test_degC"],
            row["highest_model_degC"],
            row["rise_test_K"],
            row["rise_model_K"],
            None if row["rise_error"] is None else 100.0 * row["rise_error"],
            row["rms_difference_K"],
        )
        for row in rows
    ]
    return ReportTable("Thermocouples, model beside test", columns, cells, 2)


def _held_out_table(summary: Mapping[str, Any]) -> ReportTable | None:
    """Tests that were fitted and those that judge the fit; None without any."""
    held = summary.get("held_out")
    if not held:
        return None
    return errors_table("Tests that judge the fit", held["tests"], ("role", "test"))


def errors_table(
    caption: str, tests: Sequence[Mapping[str, Any]], keys: Sequence[str]
) -> ReportTable:
    """Largest error of each quantity of each test, and its verdict."""
    heads = {"role": "Role", "test": "Test", "bearing": "Bearing", "model": "Model"}
    names = {"K_eq": "K_eq", "h_eq": "h_eq", "energy": "Energy", "force": "Force"}
    names |= {"temperature": "Temperature rise", "NRMSE": "NRMSE"}
    told = [n for n in names if any(_is_known(test.get(f"{n}_error")) for test in tests)]
    columns = [*(Column(heads[key]) for key in keys), AMBIENT, Column("R²", form=".4f")]
    columns += [Column(names[name], "%", "+.1f") for name in told]
    columns += [Column("Beyond a limit")]
    rows, marked = [], set()
    for place, test in enumerate(tests):
        errors = [test.get(f"{name}_error") for name in told]
        beyond = [names[name] for name in told if test.get(f"{name}_verdict") == "beyond"]
        cells: list[Any] = [test[key] for key in keys]
        cells += [test["ambient_degC"], test["R2"]]
        cells += [100.0 * float(e) if e is not None and e == e else None for e in errors]
        rows.append([*cells, joined(beyond) or "none"])
        if "ambient" in str(test.get("beyond_tested") or "").split():
            marked.add((place, len(keys)))
    note = "Largest error over the cycles (model over test, less one)."
    note += " Marked: beyond what the bearing was tested at." if marked else ""
    return ReportTable(caption, columns, rows, len(keys), frozenset(marked), note)


def _is_known(value: Any) -> bool:
    return value is not None and value == value


def _posterior_table(summary: Mapping[str, Any]) -> ReportTable | None:
    """What the samples of the posterior say of the peak force; None without any."""
    told = summary.get("posterior") or {}
    columns = (
        AMBIENT,
        Column("Peak force, best fit", "kN", ".1f"),
        Column("95 % from", "kN", ".1f"),
        Column("to", "kN", ".1f"),
    )
    keys = ("ambient_degC", "best_kN", "lower_kN", "upper_kN")
    rows = [[row[key] for key in keys] for row in told.get("peak_force", [])]
    marked = frozenset(
        (place, 0)
        for place, row in enumerate(told.get("peak_force", []))
        if "ambient" in str(row.get("beyond_tested") or "").split()
    )
    note = f"Of {told.get('samples')} samples of the posterior ({told.get('source')}); they are "
    note += "in posterior.csv."
    note += " Marked: beyond what the bearing was tested at." if marked else ""
    return ReportTable("Predicted peak force", columns, rows, 0, marked, note) if rows else None


def _undetermined_table(summary: Mapping[str, Any]) -> ReportTable | None:
    """What is not free or not known, and why."""
    columns = (Column("What"), Column("Known how well"), Column("Why, or source"))
    rows = []
    for item in summary["parameters"].values():
        if grade(item) in (AT_BOUND, NOT, POORLY):
            near = {AT_BOUND: AT_BOUND, NOT: "near its bound"}.get(grade(item))
            spread = near or f"± {item['stderr']:.2g} {item['unit']}"
            rows.append((item["symbol"], spread.strip(), "free, and hardly told by the tests"))
    rows += [
        (key_words(key), "not free", _why(item))
        for key, item in summary.get("sensitivity", {}).items()
        if not item.get("free", True)
    ]
    for item in summary["assumed"]:
        share, size = item["relative_uncertainty"], item["absolute_uncertainty"]
        spread = f"± {100.0 * share:.3g} %" if share is not None else f"± {size:g}"
        spread = f"{spread} {item.get('unit', '')}".strip()
        rows.append((item["name"], spread, item["source"]))
    return ReportTable("What the tests do not determine", columns, rows) if rows else None


def _why(item: Mapping[str, Any]) -> str:
    """What the tests would tell of a parameter that was held."""
    source, left = item.get("stderr_of_source"), item.get("stderr_expected")
    if source is None or left is None:
        return "held: these tests tell too little of it"
    return f"held: its source knows it to ± {source:.2g}, these tests to ± {left:.2g}"


def _checks_table(records: Sequence[Record]) -> ReportTable:
    """Findings of a look at tests."""
    columns = (TEST, Column("Finding"), Column("About"), Column("Sentence"))
    rows = [
        (record["name"], finding["level"], finding["check"], finding["sentence"])
        for record in records
        for finding in record["findings"]
    ]
    rows = rows or [(record["name"], "nothing", "", "") for record in records]
    return ReportTable("What was found", columns, rows)


Summary = Mapping[str, Any]
LOOP_POINTS = 2000  # of a test
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


def build_pieces(saved: SavedResult) -> Pieces:
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
    checks = report_checks(summary)
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
            "treatment": _treatment_table(summary["records"]),
            **bearing_tables(bearing, sources),
        },
        tables=report_tables_by_name(saved),
        figures=report_figures(saved),
        checks=checks,
        validity=[*validity, *_predicted(summary)],
        validity_unknown=unknown,
        assumptions=assumptions(summary, bearing),
        warnings=warnings,
        identity=saved_identity(saved, "thermobearing.identify_bearing(...) in Python"),
    )


def report_figures(saved: SavedResult) -> dict[str, ReportFigure]:
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


def report_tables_by_name(saved: SavedResult) -> dict[str, ReportTable]:
    """Parameters first, then how the tests are met, cycle by cycle."""
    summary = saved.summary
    found: dict[str, ReportTable | None] = {
        "parameters": _parameters_table(summary),
        "records": _records_table(summary["records"]),
        "cycles": cycles_table(saved),
        "thermocouples": thermocouples_table(summary["thermocouples"]),
        "held_out": _held_out_table(summary),
        "posterior": _posterior_table(summary),
        "undetermined": _undetermined_table(summary),
    }
    return {name: table for name, table in found.items() if table is not None and table.rows}


def report_checks(summary: Summary) -> list[Check]:
    """R2 of each test; limits on tests that were held out."""
    found = [
        Check(
            f"R² of {record['name']}",
            float(record["R2"]),
            UNUSABLE,
            "",
            f"below it a fit is no bearing; below {POOR_R2:g} it is told to be poor",
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
        f"{_fixed_name(key)} = {number(item['value'], '.4g')} {item['unit']}".strip()
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


def _fixed_name(key: str) -> str:
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
        inputs={"treatment": _treatment_table(records)},
        tables={"findings": _checks_table(records)},
        figures=saved_figures(saved, {"check": "The test as it was read, and its cycles."}),
        validity_unknown="Nothing was fitted, so nothing is said of validity.",
        identity=saved_identity(saved, "thermobearing.check_test(...) in Python"),
    )
