"""Tables and report of a parameter study."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import OutputError
from thermobearing.border.lazy import pd
from thermobearing.border.text_file import file_names, write_file
from thermobearing.border.toml import to_table
from thermobearing.model.outcomes import heat_flow
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import counted, joined, number, tidy
from thermobearing.report.content import figure_captions, pieces_of_saved
from thermobearing.report.pieces import Pieces, ReportFigure
from thermobearing.results.base import COMPLETED
from thermobearing.results.saved import SavedResult
from thermobearing.studies.definition.designs import AMBIENT, Plan
from thermobearing.studies.definition.record import stated_laws
from thermobearing.studies.figures import StudyFigures, column_words, find_unit, limit_words
from thermobearing.studies.result import CLIMATE, StudyResult
from thermobearing.studies.run.engine import count_failures, failures_table
from thermobearing.studies.statistics.demand import OUTCOME, failure_rule
from thermobearing.studies.statistics.fragility import Fragility
from thermobearing.studies.statistics.hazard import Rate
from thermobearing.studies.statistics.variance import sampling_note
from thermobearing.studies.store import label_plan

UNKNOWN = (
    "The table of runs does not contain the calibration ranges of the bearings; repeat a run to "
    "see them."
)
MOST_LEVELS = 12  # that are named
TOO_FEW = "too few"  # motions or levels for a number
RATE_BANDS = ("rate_low", "rate_high", "over_low", "over_high")
RATE_UNITS = dict.fromkeys(["rate", "rate_low", "rate_high"], "1/year")
RATE_UNITS |= {"return_period_years": "year"}
IN_CAPTION = ["method", "capacity", "left_out", "collapsed", "sentence"]  # not in a table of curves


def build_pieces(result: Any) -> Pieces:
    """Return the content of the report of a study."""
    if isinstance(result, SavedResult):
        return pieces_of_saved(result)
    hourly = result.study.factors.ambient.hourly
    return Pieces(
        command="study",
        title=f"Study {result.study.name}",
        question=_scope(result),
        answer=answer(result),
        inputs=_input_tables(result),
        tables=result_tables(result) | {"worst": worst_table(result, result.worst())},
        figures=_figures(result),
        validity_unknown=UNKNOWN,
        assumptions=[
            f"Statistics of the {column_words(result.demand_name)}: "
            f"{failure_rule(result.demand_name, result.question.failed)}",
            "Bands have 95 % confidence unless another value is given; those of fragility and "
            "rates come from a studentised bootstrap that resamples motions with all their runs.",
            "Every run begins with bearings at rest that have no earlier loading.",
            *([heat_flow(to_table(result.study.case.analysis), [])] if hourly else []),
        ],
        warnings=[tidy(text) for text in result.warnings],
        identity={
            "Version": f"thermobearing {result.manifest.get('versions', {}).get('thermobearing')}",
            "Input (digest of all runs)": str(result.manifest.get("input", "")),
            "Command": f"thermobearing study study.toml -o {result.directory.name}",
        },
    )


def _scope(result: StudyResult) -> str:
    words = column_words(result.demand_name)
    factors = joined(map(column_words, result.factors))
    runs = f"{counted(result.runs, 'run')} that differ in {factors}"
    if result.question.capacity is None:
        return f"Distribution of the {words} over {runs}."
    rates = "" if result.question.hazard is None else " and annual rate"
    return f"Probability{rates} of a {words} above {limit_words(result)}, from {runs}."


def answer(result: StudyResult) -> list[str]:
    """Return sentences on runs, failures, demand at both ends of the temperature, and rates."""
    demand = result.demand_name
    modes = [
        f"{row['runs']} {row['outcome'].replace('_', ' ')}"
        for row in count_failures(result.table).to_dict("records")
    ]
    lost = f"; {counted(result.failed, 'run')} failed ({', '.join(modes)})" if modes else ""
    planned = int(result.manifest.get("runs", result.runs))
    completion = (
        f"All {planned} runs are complete" if result.runs == planned else result.warnings[0]
    )
    sentences = [f"{completion}{lost}."]
    parts = {f"{name}: " if name else "": part for name, part in result.parts().items()}
    if AMBIENT in result.factors:
        unit = f" {find_unit(demand)}".rstrip()
        for prefix, part in parts.items():
            rows = part.demand(by=(), failed=result.question.failed).to_dict("records")
            ends = " and ".join(
                f"{number(row['0.5'])}{unit} at {number(row[AMBIENT])} °C"
                for row in (rows[0], rows[-1])
            )
            sentences.append(f"{prefix}the median of the {column_words(demand)} is {ends}.")
    if result.question.hazard is not None:
        for prefix, part in parts.items():
            curves, rates = part.find_rates()
            row = part.rates_table(curves, rates).iloc[-1]
            where = f"over the {CLIMATE}" if row["name"] == CLIMATE else _temperature(row["name"])
            period = _period(rates[row["name"]])
            warm = _temperature(list(curves)[-1])
            ratio = ""
            if 0.0 < row["over_reference"] < np.inf and _temperature(row["name"]) != warm:
                ratio = f", {row['over_reference']:.2f} times as often as at {warm}"
                # Too few motions have no band.
                if not rates[row["name"]].few_motions:
                    ratio = f"{ratio} ({row['over_low']:.2f} to {row['over_high']:.2f})"
            sentences.append(f"{prefix}{where}: {period}{ratio}.")
    return sentences


def _period(rate: Rate) -> str:
    """Return the return period with its band, or a bound."""
    if np.isnan(rate.rate):
        return "there is no fragility curve; see the tables"
    if rate.rate == 0.0:
        bound = f": the return period is at least {1.0 / rate.high:.3g} years"
        return f"no run exceeds the capacity{bound if rate.high > 0.0 else ''}"
    last = f" to {1.0 / rate.low:.3g}" if rate.low > 0.0 else " or more"
    band = rate.few_motions or f"{1.0 / rate.high:.3g}{last}"
    return f"exceeded once in {rate.return_period:.3g} years ({band})"


def _temperature(name: Any) -> str:
    return f"{number(float(name))} °C" if isinstance(name, int | float) else str(name)


def _input_tables(result: StudyResult) -> dict[str, Table]:
    """Return the factors that vary, and the design."""
    rows, units = [], _units(result)
    for name in result.factors:
        values = result.table[name]
        levels = list(values.unique())
        shown = levels[:MOST_LEVELS]
        text = ", ".join(number(v, ".6g") if isinstance(v, float) else str(v) for v in shown)
        if len(levels) > MOST_LEVELS and pd.api.types.is_numeric_dtype(values):
            low, high = (number(float(value), ".5g") for value in (values.min(), values.max()))
            text = f"{low} to {high}, {len(levels)} values"
        elif len(levels) > MOST_LEVELS:
            text = f"{text} and {len(levels) - MOST_LEVELS} more"
        rows.append((column_words(name), units[name], text))
    design = result.study.design
    chosen = [
        ("kind", design.kind),
        ("samples of each combination of levels", design.samples or "none"),
        ("seed", design.seed),
        ("arrangement", design.arrangement),
    ]
    heads = [list(map(Quantity, row)) for row in (("Factor", "Unit", "Values"), ("Key", "Value"))]
    return {
        "factors": Table("Factors that vary between the runs", heads[0], rows),
        "constant": Table("The same in all runs", heads[1], _constant_rows(result)),
        "design": Table("Design", heads[1], chosen),
    }


def _constant_rows(result: StudyResult) -> list[tuple[str, str]]:
    """Return what all runs share: structure, bearing and motion, and how long it is."""
    factors, rows = result.study.factors, []
    for name in ("structure", "bearing", "motion"):
        levels = getattr(factors, name).levels or []
        if len(levels) == 1 and name not in result.factors:
            rows.append((name, str(getattr(levels[0], "label", None) or levels[0].name)))
    laws = {
        level.name: joined(stated_laws(level))
        for level in factors.bearing.levels
        if stated_laws(level)
    }
    rows += [(f"law of {name}", law) for name, law in laws.items()]
    duration = result.study.case.duration
    return rows + ([("duration", f"at most {duration:g} s")] if duration else [])


def _units(result: StudyResult) -> dict[str, str]:
    labels = label_plan(Plan(result.study), result.factors)
    return {name: find_unit(name) or unit.removeprefix("1") for name, (unit, _) in labels.items()}


def result_tables(result: StudyResult) -> dict[str, Table]:
    """Return failures, demand, fragility, rates and variance, as far as the study has them."""
    demand, question = result.demand_name, result.question
    tables: dict[str, Table] = {}
    failures = count_failures(result.table)
    if len(failures):
        tables["outcomes"] = failures_table(failures)
    if AMBIENT in result.factors:
        table = result.demand(failed=question.failed)
        shares = {c: f"{100 * float(c):g} %" for c in map(str, table) if c.startswith("0.")}
        units = dict.fromkeys(["mean", *shares, "median_low", "median_high"], find_unit(demand))
        caption = f"{column_words(demand)} by ambient temperature"
        tables["demand"] = _table(table, caption, units=units, heads=shares)
    if result.table[result.intensity].nunique() > 1 and question.capacity is not None:
        for name, part in result.parts().items():
            tables |= _curve_tables(part, name)
    if result.has_variance:
        table = result.variance()
        table["factor"] = table["factor"].map(column_words)
        rows, failed = (int(table[name].iloc[0]) for name in ("rows", "left_out"))
        note = f"{rows} {'samples' if 'total' in table else 'runs'}, {failed} failed and left out."
        note = f"{note} {sampling_note(table)}".strip()
        caption = f"Shares of the variance of the {column_words(demand)}"
        tables["variance"] = _table(table.drop(columns=["rows", "left_out"]), caption, note=note)
    return tables


def worst_table(result: StudyResult, worst: "pd.DataFrame") -> Table:
    """Return `StudyResult.worst` as a table for readers."""
    caption = "The worst runs, and the first of each failure mode"
    return _table(worst.drop(columns="id"), caption, units=_units(result))


def _curve_tables(part: StudyResult, name: str) -> dict[str, Table]:
    """Return the tables of fragility and rates of one structure and bearing."""
    of, ending = (f", {name}", f"-{name}") if name else ("", "")
    hazard = part.question.hazard is not None
    curves, rates = part.find_rates() if hazard else (part.find_curves()[0], {})
    table = pd.DataFrame([curve.row() for curve in curves.values()])
    notes: dict[str, list[str]] = {}
    for level, sentence in zip(curves, table["sentence"], strict=True):
        notes.setdefault(sentence, []).append(_temperature(level))
    for level, curve in curves.items():
        for text in filter(None, (curve.beyond_levels, curve.wide_bands)):
            notes.setdefault(text, []).append(_temperature(level))
    table["name"] = [_temperature(level) for level in curves]
    ambient = _head(column_words(AMBIENT))
    im, unit = column_words(part.intensity), find_unit(part.intensity)
    medians = [end for end in map(str, table) if end.startswith("median")]
    heads = {end: _head(end.replace("median", f"median {im}")) for end in medians}
    units = dict.fromkeys(medians, unit)
    if unit == "m/s²":  # levels are often given in g
        in_g = table["median"] / (STANDARD_GRAVITY / 1000.0)
        table.insert(list(table).index("median") + 1, "median_g", in_g)
        heads["median_g"], units["median_g"] = heads["median"], "g"
    _mark_too_few(table, curves)
    demand = f"{column_words(part.demand_name)} above {limit_words(part)}"
    tables = {
        f"fragility{ending}": _table(
            table.drop(columns=IN_CAPTION),
            f"{demand}: lognormal fragility by {part.question.method}{of}",
            units=units,
            heads=heads | {"name": ambient, "beyond": "Exceedances"},
            note="; ".join(f"{joined(levels)}: {text}" for text, levels in notes.items()),
        )
    }
    if rates:
        rows = part.rates_table(curves, rates)
        few_motions = [rate.few_motions for rate in rates.values()]
        _mark_cells(rows, np.array([bool(text) for text in few_motions]), RATE_BANDS)
        rows["name"] = rows["name"].map(_temperature)
        over = f"Ratio to {_temperature(list(curves)[-1])}"
        heads = {"name": ambient, "in_50_years": "Probability in 50 years"}
        heads |= {"return_period_years": "Return period", "over_reference": over}
        heads |= {"over_low": f"{over}, low", "over_high": f"{over}, high"}
        tables[f"rates{ending}"] = _table(
            rows.drop(columns=["reference", "notes"]),
            f"Annual rates{of}",
            units=RATE_UNITS,
            heads=heads,
            note="; ".join(dict.fromkeys(text for text in [*few_motions, *rows["notes"]] if text)),
        )
    return tables


def _mark_too_few(table: "pd.DataFrame", curves: Mapping[Any, Fragility]) -> None:
    """Put words in place of the bands of few motions, and of medians beyond all intensities."""
    beyond = np.array([bool(curve.beyond_levels) for curve in curves.values()])
    with_few_motions = np.array([bool(curve.few_motions) for curve in curves.values()])
    sizes = [name for name in map(str, table) if name.startswith(("median", "dispersion"))]
    _mark_cells(table, beyond, sizes)
    _mark_cells(
        table,
        with_few_motions & ~beyond,
        [name for name in sizes if name.endswith(("_low", "_high"))],
    )


def _mark_cells(table: "pd.DataFrame", rows: "np.ndarray[Any, Any]", names: Sequence[str]) -> None:
    """Put "too few" in some rows of some columns."""
    for name in names if rows.any() else ():
        table[name] = table[name].astype(object).where(~rows, TOO_FEW)


def _head(words: str) -> str:
    if "." in words:  # a key of a file, such as bearing.K_r
        return words
    words = words.replace("_", " ")
    return f"{words[:1].upper()}{words[1:]}" if len(words.split(" ")[0]) > 1 else words


def _table(
    frame: "pd.DataFrame",
    caption: str,
    *,
    units: Mapping[str, str] | None = None,
    heads: Mapping[str, str] | None = None,
    note: str = "",
) -> Table:
    """Return a table; `units` and `heads` are those that the names of the columns do not give."""
    columns = [
        Quantity(
            (heads or {}).get(name) or _head(column_words(name)),
            (units or {}).get(name) or find_unit(name),
            "d" if frame[name].dtype.kind in "iu" else ".4g",
            name=name,
        )
        for name in map(str, frame)
    ]
    return make_table(frame, columns, f"{caption[:1].upper()}{caption[1:]}", note=note)


def _figures(result: StudyResult) -> dict[str, ReportFigure]:
    figures = {}
    for name, draw in StudyFigures(result).draw_all().items():
        kind, _, subject = name.partition("-")
        caption = figure_captions("study")[kind] + (f" {subject}." if subject else "")
        figures[name] = ReportFigure(caption, draw=draw, alt=caption)
    return figures


# Columns of runs as demands of pelicun: type, unit. The first three are types of pelicun's damage
# models, the others are for demand files alone.
DEMANDS = {
    "PGA_m_s2": ("PGA", "mps2"),
    "PGV_m_s": ("PGV", "mps"),
    "Sa_m_s2": ("SA_{period:g}", "mps2"),
    "deck_acceleration_max_m_s2": ("PFA", "mps2"),
    "deck_displacement_max_mm": ("PFD", "mm"),
    "pier_drift_max": ("PID", "rad"),
    "bearing_strain_max": ("BSS", "unitless"),
    "bearing_force_max_kN": ("BSF", "kN"),
    "pier_ductility": ("PDU", "unitless"),
}
MEASURES = {  # intensity: its name in damage models
    "PGA": "Peak Ground Acceleration",
    "PGV": "Peak Ground Velocity",
    "Sa": "Spectral Acceleration|{period:g}",
}


def _demand_table(result: StudyResult) -> "pd.DataFrame":
    """Return the completed runs as a demand sample of pelicun, the row of units first."""
    period = result.study.factors.scale.period or 0.0
    completed = result.table[result.table[OUTCOME] == COMPLETED]
    columns: dict[str, list[Any]] = {}
    for name, (kind, unit) in DEMANDS.items():
        if name in completed and completed[name].notna().all():
            head = f"1-{kind.format(period=period)}-1-1"
            columns[head] = [unit, *completed[name].tolist()]
    return pd.DataFrame(columns, index=["Units", *map(str, range(len(completed)))])


def _damage_row(name: str, curve: Fragility, demand: str, unit: str) -> dict[str, Any]:
    """Return a fragility curve as a row of a damage database of pelicun."""
    return {
        "ID": name,
        "Incomplete": 0,
        "Demand-Type": demand,
        "Demand-Unit": unit,
        "Demand-Offset": 0,
        "Demand-Directional": 1,
        "LS1-Family": "lognormal",
        "LS1-Theta_0": curve.median,
        "LS1-Theta_1": curve.dispersion,
        "LS1-DamageStateWeights": "",
    }


def write_pelicun(
    result: StudyResult,
    folder: str | Path,
    *,
    capacities: Mapping[str, float] | None = None,
    overwrite: bool = False,
) -> list[str]:
    """Write a study for pelicun; return the components without a fragility curve.

    Each combination of structure, bearing and temperature has a file `demand-NAME.csv` of its
    completed runs; `damage.csv` has a component for each combination and capacity. `capacities`
    are by column of the demand, by default that of the question; without any there is no
    `damage.csv`.
    """
    question = result.question
    if capacities is None:
        capacities = {} if question.capacity is None else {result.demand_name: question.capacity}
    scale = result.study.factors.scale
    demand = MEASURES[scale.measure].format(period=scale.period or 0.0)
    files, rows, without_curve = {}, [], []
    levels = result.study.factors.ambient.levels is not None
    for part, runs in result.parts().items():
        temperatures = sorted(set(runs.table[AMBIENT])) if levels else [None]
        for ambient in temperatures:
            group_runs = runs if ambient is None else runs.select(**{AMBIENT: ambient})
            label = "" if ambient is None else f"{ambient:g}degC".replace("-", "minus")
            name = "-".join(word for word in (part, label) if word) or result.study.name
            files[f"demand-{name}"] = _demand_table(group_runs).to_csv(lineterminator="\n")
            for column, capacity in capacities.items():
                curve = group_runs.fragility(
                    capacity, column, method=question.method, failed=question.failed
                )
                component = f"{name}.{column}.{capacity:g}".replace("-", "_")
                if curve.beyond_levels:
                    without_curve.append(f"{component}: {curve.beyond_levels}")
                elif np.isfinite(curve.dispersion) and curve.dispersion > 0.0:
                    unit = DEMANDS[result.intensity][1]
                    rows.append(_damage_row(component, curve, demand, unit))
                else:
                    without_curve.append(f"{component}: {curve.row()['sentence']}")
    names = file_names(files)
    texts = dict(zip(names, files.values(), strict=True))
    if rows:
        texts["damage"] = pd.DataFrame(rows).to_csv(index=False, lineterminator="\n")
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made: {error.strerror}") from None
    for stem, text in texts.items():
        write_file(Path(folder) / f"{stem}.csv", text, overwrite=overwrite)
    return without_curve
