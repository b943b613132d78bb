"""What the document of a study says."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.border.toml import to_table
from thermobearing.cyclic.reported import heat_flow
from thermobearing.report.content import (
    make_table,
    table_column,
)
from thermobearing.report.pieces import Column, Pieces, ReportFigure, ReportTable
from thermobearing.report.words import counted, joined, number, tidy
from thermobearing.studies.definition.columns import AMBIENT
from thermobearing.studies.figures import StudyFigures, column_words, find_unit
from thermobearing.studies.options import Question
from thermobearing.studies.result import StudyResult
from thermobearing.studies.run.status import count_failures
from thermobearing.studies.statistics.hazard import Rate
from thermobearing.studies.store.directory import about_plan

UNKNOWN = (
    "The table of runs says nothing of the ranges that the bearings were tested in; a run that is "
    "repeated in full does."
)
MOST_LEVELS = 12  # that are named
RATE_UNITS = dict.fromkeys(["rate", "rate_low", "rate_high"], "1/year") | {"return period": "year"}
TOLD_ONCE = ["method", "capacity", "left_out", "collapsed"]  # of a table of curves, elsewhere
CAPTIONS = {
    "demand": "Demand against temperature: median with its band, fractiles of the runs.",
    "variance": "Share of each factor in the variance of the demand.",
    "ida": "Incremental dynamic analysis: a line a motion, fractiles of the demand.",
    "fragility": "Probability of going beyond the capacity, with bands.",
    "rates": "Hazard curve, and how often a year the capacity is passed.",
}


def build_pieces(result: StudyResult, asked: Question | None = None) -> Pieces:
    """Everything that the document of a study says.

    Parameters
    ----------
    result : of `study_result`.
    asked : demand, capacity, hazard; those that the study itself asks for by default.
    """
    asked = asked or result.asked
    demand = asked.chosen_demand(result)
    tables = report_tables_by_name(result, asked)
    hourly = result.study.factors.ambient.hourly
    return Pieces(
        command="study",
        title=f"Study {result.study.name}",
        question=question(result, asked),
        answer=answer(result, asked),
        inputs=input_tables(result),
        tables=tables,
        figures=report_figures(result, asked),
        validity_unknown=UNKNOWN,
        assumptions=[
            f"Failed runs are {'left out' if asked.failed == 'left-out' else 'taken as collapse'} "
            f"wherever {column_words(demand)} is counted.",
            "Bands are of 95 %, if nothing else is said: of fragility and rates from a studentised "
            "bootstrap that draws whole motions again.",
            "Every run begins with a bearing that was not moved before.",
            *([heat_flow(to_table(result.study.case.analysis), [])] if hourly else []),
        ],
        warnings=[tidy(text) for text in result.warnings],
        identity={
            "Version": f"thermobearing {result.manifest.get('versions', {}).get('thermobearing')}",
            "Input (digest of all runs)": str(result.manifest.get("input", "")),
            "Command": f"thermobearing study study.toml -o {result.directory.name}",
        },
    )


def question(result: StudyResult, asked: Question) -> str:
    """What was asked."""
    demand, capacity = asked.chosen_demand(result), asked.capacity
    told = [column_words(name) for name in result.factors]
    runs = counted(result.runs, "run")
    if capacity is None:
        return f"How does {column_words(demand)} spread over {runs} that differ in {joined(told)}?"
    limit = f"{capacity:g} {find_unit(demand)}".strip()
    often = " how often a year," if asked.hazard is not None else ""
    return (
        f"How likely,{often} and in which air does {column_words(demand)} go beyond {limit}, by "
        f"{runs} that differ in {joined(told)}?"
    )


def answer(result: StudyResult, asked: Question) -> list[str]:
    """Runs and failures; demand in the cold beside the warm; rates over the climate."""
    demand = asked.chosen_demand(result)
    lost = f"; {counted(result.failed, 'run')} failed" if result.failed else ""
    planned = int(result.manifest.get("runs", result.runs))
    done = f"All {planned} runs are done" if result.runs == planned else result.warnings[0]
    found = [f"{done}{lost}."]
    if AMBIENT in result.factors:
        found += [_cold(part, demand, asked, name) for name, part in result.parts().items()]
    if asked.hazard is not None:
        for name, part in result.parts().items():
            curves, rates = asked.chosen_rates(part)
            table = part.rates_table(curves, rates)
            row, of = table.iloc[-1], f"{name}: " if name else ""
            told = f"{of}{_air(row['name'])}: {_period(rates[row['name']])}"
            if 0.0 < row["over_reference"] < np.inf:
                told += (
                    f", {row['over_reference']:.2f} times as often as at {_air(list(curves)[-1])} "
                    f"({row['over_low']:.2f} to {row['over_high']:.2f})"
                )
            found.append(f"{told}.")
    return found


def _period(rate: Rate) -> str:
    """How often a capacity is passed, in years with the band, or a bound where it was not."""
    if np.isnan(rate.rate):
        return "there is no curve; see the tables"
    if rate.rate == 0.0:
        bound = f"{1.0 / rate.high:.3g} years" if rate.high > 0.0 else "the hazard curve says"
        return f"no run goes beyond the capacity: passed less often than once in {bound}"
    last = f" to {1.0 / rate.low:.3g}" if rate.low > 0.0 else " or more"
    return f"passed once in {rate.return_period:.3g} years ({1.0 / rate.high:.3g}{last})"


def _air(name: Any) -> str:
    """A temperature, or a class of them, in words."""
    return f"{number(float(name))} °C" if isinstance(name, int | float) else str(name)


def _cold(part: StudyResult, demand: str, asked: Question, name: str) -> str:
    """Median of the coldest and of the warmest runs."""
    rows = part.demand(demand, by=(), failed=asked.failed)
    cold, warm = rows.iloc[0], rows.iloc[-1]
    of = f"{name}: " if name else ""
    unit = f" {find_unit(demand)}".rstrip()
    return (
        f"{of}the median of {column_words(demand)} is {number(float(cold['0.5']))}{unit} at "
        f"{number(float(cold[AMBIENT]))} °C and {number(float(warm['0.5']))}{unit} at "
        f"{number(float(warm[AMBIENT]))} °C."
    )


def input_tables(result: StudyResult) -> dict[str, ReportTable]:
    """What differs between runs, and how it was chosen."""
    rows, units = [], _units_of(result)
    for name in result.factors:
        values = result.table[name]
        levels = list(values.unique())
        told = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in levels[:MOST_LEVELS])
        if len(levels) > MOST_LEVELS and pd.api.types.is_numeric_dtype(values):
            told = f"{float(values.min()):.4g} to {float(values.max()):.4g}, {len(levels)} values"
        elif len(levels) > MOST_LEVELS:
            told += f" and {len(levels) - MOST_LEVELS} more"
        rows.append((column_words(name), units[name], told))
    columns = [Column("Factor"), Column("Unit"), Column("Values in the runs")]
    design = result.study.design
    chosen = [
        ("kind", design.kind),
        ("draws of each combination of levels", design.samples or "none"),
        ("seed", design.seed),
        ("arrangement", design.arrangement),
    ]
    return {
        "factors": ReportTable("What differs between the runs", columns, rows),
        "design": ReportTable("How they were chosen", [Column("What"), Column("Value")], chosen),
    }


def _units_of(result: StudyResult) -> dict[str, str]:
    """Unit of each factor; "" of one without."""
    about = about_plan(result.study, result.table[result.factors])
    return {name: find_unit(name) or one.unit.removeprefix("1") for name, one in about.items()}


def report_tables_by_name(result: StudyResult, asked: Question) -> dict[str, ReportTable]:
    """Failures, demand, fragility, rates, variance, worst runs."""
    demand = asked.chosen_demand(result)
    found: dict[str, ReportTable] = {}
    failures = count_failures(result.table)
    if len(failures):
        found["outcomes"] = _table("outcomes", failures, "Why runs failed")
    if AMBIENT in result.factors:
        table = result.demand(demand, failed=asked.failed)
        shares = {c: f"{100 * float(str(c)):g} %" for c in table if str(c).startswith("0.")}
        table = table.rename(columns=shares)
        spread = ["mean", *shares.values(), "median_low", "median_high"]
        unit = dict.fromkeys(spread, find_unit(demand))
        caption = f"{column_words(demand)} by ambient temperature"
        found["demand"] = _table("demand", table, caption, units=unit)
    if result.table[result.intensity].nunique() > 1 and asked.capacity is not None:
        for name, part in result.parts().items():
            found |= _curves(part, asked, f"-{name}" if name else "", name)
    if len(result.factors) > 1:
        shared = result.variance(demand)
        shared["factor"] = shared["factor"].map(column_words)
        caption = f"Shares of the variance of the {column_words(demand)}"
        found["variance"] = _table("variance", shared, caption, _of_indices(shared))
    worst = result.worst(by=demand).drop(columns="id")
    units = {name: unit for name, unit in _units_of(result).items() if name in worst}
    caption = "The worst runs, and one of each way to fail"
    found["worst"] = _table("worst", worst, caption, units=units)
    return found


def _of_indices(table: pd.DataFrame) -> str:
    """A note where an index of Sobol' is beyond what it can be."""
    if "total" not in table or not (table["total"] < table["first"]).any():
        return ""
    return "A total index below that of first order is an error of sampling: take more samples."


def _curves(part: StudyResult, asked: Question, ending: str, name: str) -> dict[str, ReportTable]:
    """Parameters of fragility curves, and rates."""
    of = f", {name}" if name else ""
    rates: Mapping[Any, Rate] | None = None
    if asked.hazard is None:
        curves = asked.chosen_curves(part)[0]
    else:
        curves, rates = asked.chosen_rates(part)
    table = pd.DataFrame([curve.row() for curve in curves.values()])
    said: dict[str, list[str]] = {}
    for air, sentence in zip(curves, table["sentence"], strict=True):
        said.setdefault(sentence, []).append(_air(air))
    note = "; ".join(f"{joined(airs)}: {sentence}" for sentence, airs in said.items())
    im = column_words(part.intensity)
    medians = {
        end: end.replace("median", f"median {im}") for end in map(str, table) if "median" in end
    }
    table = table.drop(columns=[*TOLD_ONCE, "sentence"]).rename(columns={"name": AMBIENT} | medians)
    limit = f"{asked.capacity:g} {find_unit(asked.chosen_demand(part))}".strip()
    caption = f"{column_words(asked.chosen_demand(part))} beyond {limit}: lognormal fragility by "
    caption += f"{asked.method}{of}"
    units = dict.fromkeys(medians.values(), find_unit(part.intensity))
    found = {f"fragility{ending}": _table("fragility", table, caption, note, units)}
    if rates is not None:
        rows = part.rates_table(curves, rates)
        note = "; ".join(dict.fromkeys(text for text in rows["notes"] if text))
        over = f"times that at {_air(list(curves)[-1])}"
        heads = {"name": AMBIENT, "return_period_years": "return period", "over_reference": over}
        heads["in_50_years"] = "probability in 50 years"
        heads |= {"over_low": f"{over}, low", "over_high": f"{over}, high"}
        rows = rows.drop(columns=["reference", "notes"]).rename(columns=heads)
        found[f"rates{ending}"] = _table("rates", rows, f"Annual rates{of}", note, RATE_UNITS)
    return found


def _table(
    name: str,
    table: pd.DataFrame,
    caption: str,
    note: str = "",
    units: Mapping[str, str] | None = None,
) -> ReportTable:
    """A table of a document with its caption, and units that names of columns do not say."""
    found = make_table(name, table.astype(_plain(table)))
    known = {table_column(at, table[at]).head: unit for at, unit in (units or {}).items()}
    columns = [replace(c, unit=c.unit or known.get(c.head, "")) for c in found.columns]
    return replace(found, caption=caption, columns=columns, note=note or found.note)


def _plain(table: pd.DataFrame) -> dict[Any, Any]:
    """Names of things are categories in a plan; as words they can be written."""
    return {c: object for c in table if isinstance(table[c].dtype, pd.CategoricalDtype)}


def report_figures(result: StudyResult, asked: Question) -> dict[str, ReportFigure]:
    """Every figure of the study."""
    found = {}
    for name, draw in StudyFigures(result).draw_all(asked).items():
        kind, _, of = name.partition("-")
        caption = CAPTIONS[kind] + (f" {of}." if of else "")
        found[name] = ReportFigure(caption, draw=draw, alt=caption)
    return found
