"""Report of a parameter study."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from thermobearing.border.errors import OutputError
from thermobearing.border.lazy import pd
from thermobearing.border.text_file import file_names, write_file
from thermobearing.border.toml import to_table
from thermobearing.model.outcomes import PIER_BEYOND_LIMIT, heat_flow
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.warned import BEYOND_TESTS, NO_RANGE
from thermobearing.quantities.words import counted, joined, number, tidy
from thermobearing.report.content import figure_captions, pieces_of_saved
from thermobearing.report.pieces import Pieces, ReportFigure
from thermobearing.results.base import COMPLETED
from thermobearing.results.saved import SavedResult
from thermobearing.studies.definition.designs import AMBIENT, HOUR, NAMED_FACTORS, SAMPLE
from thermobearing.studies.definition.record import YEARS, Drawn, Study, stated_laws
from thermobearing.studies.figures import StudyFigures
from thermobearing.studies.result import StudyResult
from thermobearing.studies.statistics.demand import NEVER_RUN, OUTCOME, failure_rule
from thermobearing.studies.statistics.fragility import Fragility
from thermobearing.studies.tables import (
    answer,
    column_units,
    column_words,
    limit_words,
    result_tables,
    worst_table,
)

OF_RANGE = (BEYOND_TESTS, NO_RANGE)  # warnings that stand under Validity
MOST_LEVELS = 12  # that are named
SAME_DRAWS = "true: all combinations of levels have the same draws"
SEPARATE_DRAWS = "false: each combination of levels has its own draws"


def build_pieces(result: Any) -> Pieces:
    """Return the content of the report of a study."""
    if isinstance(result, SavedResult):
        return pieces_of_saved(result)
    hourly = result.study.factors.ambient.hourly
    on_range = [text for text in result.warnings if getattr(text, "code", "") in OF_RANGE]
    unknown = [text for text in on_range if getattr(text, "code", "") == NO_RANGE]
    # Too few runs for a warning are no reason to say that all lie inside.
    few = [tidy(text) for text in result.beyond_ranges(0.0) if text not in on_range]
    return Pieces(
        command="study",
        title=f"Study {result.study.name}",
        question=_scope(result),
        answer=answer(result),
        inputs=_input_tables(result),
        tables=result_tables(result)
        | {"worst": worst_table(result, result.worst(by=result.demand_name))},
        figures=_figures(result),
        validity=[tidy(text) for text in on_range if text not in unknown],
        notes=few,
        validity_unknown=" ".join(map(tidy, unknown)),
        assumptions=[
            f"Statistics of the {column_words(result.demand_name)}: "
            f"{failure_rule(result.demand_name, result.question.failed)}",
            "Bands have 95 % confidence unless another value is given; those of fragility and "
            "rates come from a studentised bootstrap that resamples motions with all their runs.",
            "Every run begins with bearings at rest that have no earlier loading.",
            *([heat_flow(to_table(result.study.case.analysis), [])] if hourly else []),
        ],
        warnings=[tidy(text) for text in result.warnings if text not in on_range],
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


def _input_tables(result: StudyResult) -> dict[str, Table]:
    """Return the factors that vary, and the design."""
    rows, units = [], column_units(result)
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
        rows.append((column_words(name), units[name], text, _definition(result.study, name)))
    design = result.study.design
    chosen = [
        ("kind", design.kind),
        ("samples of each combination of levels", design.samples or "none"),
        ("seed", design.seed),
        ("arrangement", design.arrangement),
    ]
    if design.samples:
        chosen.append(("paired", SAME_DRAWS if design.paired else SEPARATE_DRAWS))
    titles = (("Factor", "Unit", "Values", "Defined as"), ("Key", "Value"))
    heads = [list(map(Quantity, row)) for row in titles]
    return {
        "factors": Table("Factors that vary between the runs", heads[0], rows),
        "constant": Table("The same in all runs", heads[1], _constant_rows(result)),
        "design": Table("Design", heads[1], chosen),
    }


def _definition(study: Study, name: str) -> str:
    """Return how a factor is defined: its levels, its distribution, or its weather."""
    factors = study.factors
    if name == SAMPLE:
        return "drawn from the posterior samples of the bearing"
    if name in (AMBIENT, HOUR):
        factor: Any = factors.ambient
    else:
        factor = factors.numbers.get(name) or getattr(factors, name)
    if getattr(factor, "hourly", False):
        source = f"weather of {Path(factor.weather).name}" if factor.weather else ""
        source = source or f"climate {factor.climate}, {counted(factor.years or YEARS, 'year')}"
        return f"a random hour of the {source}"
    table = to_table(factor)
    subject = f"{table['of']}: " if table.get("of") in ("value", "factor") else ""
    if table.get("of") == "intensity":
        period = f" at {number(float(factor.period))} s" if factor.period else ""
        subject = f"{factor.measure}{period}: "
    if table.get("distribution"):
        parameters = [f"{key} {table[key]}" for key in Drawn.model_fields if key in table]
        return subject + ", ".join(parameters).removeprefix("distribution ")
    drawn = "levels, drawn at random" if factor.random else "levels"
    levels = table.get("levels") or []
    if name in NAMED_FACTORS or len(levels) > MOST_LEVELS:
        return subject + drawn
    return f"{subject}{drawn} {', '.join(map(str, levels))}"


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


class Exported(NamedTuple):
    """What the files of a study for pelicun do not have, in sentences."""

    without_curve: list[str]  # components without a fragility curve that can be used
    not_in_demand: list[str]  # runs that did not complete, for each file of demands


def _demand_table(runs: "pd.DataFrame", names: Sequence[str], period: float) -> "pd.DataFrame":
    """Return columns of runs as a demand sample of pelicun, the row of units first."""
    columns: dict[str, list[Any]] = {}
    for name in names:
        kind, unit = DEMANDS[name]
        if name in runs and runs[name].notna().all():
            columns[f"1-{kind.format(period=period)}-1-1"] = [unit, *runs[name].tolist()]
    return pd.DataFrame(columns, index=["Units", *map(str, range(len(runs)))])


def _describe_missing(table: "pd.DataFrame", file: str) -> str:
    """Return which runs are not in a file of demands, and why; "" if all are there."""
    outcomes = table.loc[table[OUTCOME] != COMPLETED, OUTCOME].astype(str).value_counts()
    if outcomes.empty:
        return ""
    reasons, failed = joined(f"{n} {name}" for name, n in outcomes.items()), int(outcomes.sum())
    verb, piers = ("is", "its pier") if failed == 1 else ("are", "their piers")
    if list(outcomes.index) == [PIER_BEYOND_LIMIT]:
        reasons = f"{piers} exceeded a limit"
    return f"{failed} of {len(table)} runs {verb} not in {file}: {reasons}"


def _damage_row(name: str, curve: Fragility, demand: str, unit: str) -> dict[str, Any]:
    """Return a fragility curve as a row of a damage database of pelicun.

    One that its own runs contradict is marked as incomplete, which pelicun leaves out and reports.
    """
    return {
        "ID": name,
        "Incomplete": int(bool(curve.misfit)),
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
) -> Exported:
    """Write a study for pelicun; return what its files do not have.

    Each combination of structure, bearing and temperature has a file `demand-NAME.csv` of its
    completed runs, and `intensity-NAME.csv` with the intensity of all its runs, since fragility
    curves count failed ones too. `damage.csv` has a component for each combination and capacity,
    `Incomplete` where its own runs contradict the curve, which is returned too. `capacities` are
    by column of the demand, by default that of the question; without any there is no `damage.csv`.
    """
    question = result.question
    if capacities is None:
        capacities = {} if question.capacity is None else {result.demand_name: question.capacity}
    scale = result.study.factors.scale
    period = scale.period or 0.0
    demand = MEASURES[scale.measure].format(period=period)
    groups: dict[str, StudyResult] = {}
    levels = result.study.factors.ambient.levels is not None
    for part, runs in result.parts().items():
        temperatures = sorted(set(runs.table[AMBIENT])) if levels else [None]
        for ambient in temperatures:
            group_runs = runs if ambient is None else runs.select(**{AMBIENT: ambient})
            label = "" if ambient is None else f"{ambient:g}degC".replace("-", "minus")
            name = "-".join(word for word in (part, label) if word) or result.study.name
            groups[name] = group_runs
    files, rows, exported = {}, [], Exported([], [])
    for name, file, group_runs in zip(groups, file_names(groups), groups.values(), strict=True):
        table = group_runs.table
        completed = table[table[OUTCOME] == COMPLETED]
        computed = table[~table[OUTCOME].isin(NEVER_RUN)]
        files[f"demand-{file}"] = _demand_table(completed, list(DEMANDS), period)
        files[f"intensity-{file}"] = _demand_table(computed, [result.intensity], period)
        exported.not_in_demand.extend(
            filter(None, [_describe_missing(table, f"demand-{file}.csv")])
        )
        for column, capacity in capacities.items():
            curve = group_runs.fragility(
                capacity, column, method=question.method, failed=question.failed
            )
            component = f"{name}.{column}.{capacity:g}".replace("-", "_")
            if curve.beyond_levels:
                exported.without_curve.append(f"{component}: {curve.beyond_levels}")
            elif np.isfinite(curve.dispersion) and curve.dispersion > 0.0:
                unit = DEMANDS[result.intensity][1]
                rows.append(_damage_row(component, curve, demand, unit))
                if curve.misfit:
                    unusable = f"{component} that can be used: {curve.misfit}"
                    exported.without_curve.append(unusable)
            else:
                exported.without_curve.append(f"{component}: {curve.row()['sentence']}")
    texts = {stem: table.to_csv(lineterminator="\n") for stem, table in files.items()}
    if rows:
        texts["damage"] = pd.DataFrame(rows).to_csv(index=False, lineterminator="\n")
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made: {error.strerror}") from None
    for stem, text in texts.items():
        write_file(Path(folder) / f"{stem}.csv", text, overwrite=overwrite)
    return exported
