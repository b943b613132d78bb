"""Tables of a parameter study, and its summary in sentences."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.cyclic.protocol import LARGEST_STRAIN
from thermobearing.earthquake.result import STRAIN
from thermobearing.earthquake.run import PIER_LIMIT, STRAIN_LIMIT
from thermobearing.model.outcomes import MELTED, PIER_BEYOND_LIMIT
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import counted, joined, number, percent
from thermobearing.report.content import words
from thermobearing.results.base import COMPLETED
from thermobearing.studies.curves import has_curves, other_medians, temperature_words
from thermobearing.studies.definition.designs import AMBIENT, Plan
from thermobearing.studies.run.shard import LEAD_LIMIT, LIMITS_PASSED
from thermobearing.studies.statistics.comparison import CONTRADICTED
from thermobearing.studies.statistics.demand import (
    ANY,
    LEAST_MOTIONS,
    LEVEL,
    Failed,
    stopped_runs,
)
from thermobearing.studies.statistics.demand import counted as count_failed
from thermobearing.studies.statistics.fragility import Fragility
from thermobearing.studies.statistics.hazard import CLIMATE, TOGETHER, Rate
from thermobearing.studies.statistics.likelihood import ALL_BEYOND, NONE_BEYOND, with_intensity_unit
from thermobearing.studies.statistics.variance import sampling_note
from thermobearing.studies.store import label_plan

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult

NAMES = {"ambient_degC": "ambient temperature", "hour": "hour of the weather"}
OF_CHOSEN = "Shares are those of the levels and distributions that were chosen for the factors."
TOO_FEW = "too few"  # motions or levels for a number
DECIMALS_OF_SHARES = 4  # of a curve, far finer than the shares of its runs
OF_CURVE = ["probability", "low", "high"]  # columns of counts that a curve has
DISPERSION_BANDS = ("dispersion_low", "dispersion_high")
RATE_BANDS = ("rate_low", "rate_high", "over_low", "over_high")
ALL_BEYOND_WORDS = "all runs exceed the capacity, also at the smallest intensity"
RATIOS = ("over_reference", "over_low", "over_high")
NO_UPPER = "no upper bound"  # of a ratio
NO_EXCEEDANCE = "the rate at {} may be zero in samples of its motions"
RATE_UNITS = dict.fromkeys(["rate", "rate_low", "rate_high"], "1/year")
RATE_UNITS |= {"return_period_years": "year"}
# Columns that are not in a table of curves.
IN_CAPTION = ["method", "capacity", "left_out", "collapsed", "computed", "larger", "sentence"]


def column_words(column: str) -> str:
    """Return the words of a column without its unit: "largest pier displacement"."""
    if ", " in column:  # several factors that are drawn together
        return ", ".join(map(column_words, column.split(", ")))
    if "." in column:
        return column
    name = NAMES.get(column) or words(column)[0]
    return f"largest {name.removesuffix(' max')}" if name.endswith(" max") else name


def find_unit(column: str) -> str:
    """Return the unit in the name of a column, such as "m/s"; "" without one."""
    return "" if "." in column else words(column)[1]


def limit_words(result: "StudyResult") -> str:
    """Return the capacity with its unit: "250 mm"."""
    return f"{result.capacity:g} {find_unit(result.demand_name)}".strip()


# Columns that tell which limits a run passed; runs of earlier versions lack the first.
FAILURE_COLUMNS = (LIMITS_PASSED, STRAIN)
LIMIT_WORDS = {
    STRAIN_LIMIT: f"beyond {percent(LARGEST_STRAIN)} strain",
    LEAD_LIMIT: "with melted lead",
    PIER_LIMIT: "with a pier beyond its limits",
}
# What the outcome says already.
LIMIT_OF_OUTCOME = {MELTED: LEAD_LIMIT, PIER_BEYOND_LIMIT: PIER_LIMIT}


def count_failures(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return number, share, first run and sentence of each failure mode.

    The mode of a run is what ended it; `also` counts the other limits that its runs passed before.
    Runs whose lead melted come first, then the others by frequency.
    """
    failed = table[table["outcome"] != COMPLETED]
    groups = failed.groupby("outcome", sort=True, observed=True)
    failures = groups.agg(
        runs=("run", "size"), first=("run", "min"), sentence=("sentence", "first")
    )
    failures.insert(1, "share", failures["runs"] / max(len(table), 1))
    limits = _limits_passed(failed)
    failures["also"] = [
        joined(
            f"{count} {LIMIT_WORDS[limit]}"
            for limit, count in _count_limits(limits[(failed["outcome"] == outcome).to_numpy()])
            if limit != LIMIT_OF_OUTCOME.get(str(outcome))
        )
        for outcome in failures.index
    ]
    failures = failures.sort_values("runs", ascending=False, kind="stable").reset_index()
    failures = failures.sort_values("outcome", key=lambda names: names != MELTED, kind="stable")
    return failures.reset_index(drop=True)


def _limits_passed(failed: "pd.DataFrame") -> "pd.Series":
    """Return the names of the limits that runs passed, separated by blanks."""
    if LIMITS_PASSED in failed:
        return failed[LIMITS_PASSED].fillna("")
    # Runs of earlier versions have the largest strain, but not the limits of their pier.
    names = np.full(len(failed), "", dtype=object)
    if STRAIN in failed:
        names[(failed[STRAIN] > LARGEST_STRAIN).to_numpy(dtype=bool)] = STRAIN_LIMIT
    return pd.Series(names, index=failed.index)


def _count_limits(limits: "pd.Series") -> list[tuple[str, int]]:
    """Return the number of runs that passed each limit, of those that some passed."""
    runs = {tuple(str(text).split()): int(count) for text, count in limits.value_counts().items()}
    counts = [
        (limit, sum(count for names, count in runs.items() if limit in names))
        for limit in LIMIT_WORDS
    ]
    return [(limit, count) for limit, count in counts if count]


def failures_table(failures: "pd.DataFrame") -> Table:
    """Return `count_failures` as a table for readers."""
    columns = [
        Quantity("Outcome", form=".3g", name="outcome"),
        Quantity("Runs", form="d", name="runs"),
        Quantity("Share", form=".3g", name="share"),
        Quantity("First run", form="d", name="first"),
        Quantity("Explanation", name="sentence"),
        Quantity("Of these", name="also"),
    ]
    return make_table(failures, columns, "Failed runs")


def answer(result: "StudyResult") -> list[str]:
    """Return sentences on runs, failures, demand at both ends of the temperature, and rates."""
    modes = [
        f"{row['runs']} {row['outcome'].replace('_', ' ')}"
        + (f", of these {row['also']}" if row["also"] else "")
        for row in count_failures(result.table).to_dict("records")
    ]
    lost = f"; {counted(result.failed, 'run')} failed ({'; '.join(modes)})" if modes else ""
    completion = result.incomplete or f"All {result.runs} runs are complete"
    sentences = [f"{completion}{lost}."]
    parts = {f"{name}: " if name else "": part for name, part in result.parts().items()}
    for prefix, part in parts.items():
        medians = _median_sentences(part, prefix) if has_curves(result) else []
        if not medians and AMBIENT in result.factors:
            medians = _demand_sentences(part, prefix)
        sentences += medians
    if result.question.hazard is not None:
        for prefix, part in parts.items():
            sentences += _rate_sentences(part, prefix)
    return sentences


def _rate_sentences(part: "StudyResult", prefix: str) -> list[str]:
    """Return the annual rate over all temperatures, or those of the governing and the warmest.

    The governing temperature has the largest rate.
    """
    curves, rates = part.find_rates()
    table = part.rates_table(curves, rates)
    rows, warm = [table.iloc[-1]], temperature_words(list(curves)[-1])
    # Of a rate with bounds the upper one, since it may be the largest.
    sizes = table["rate"].fillna(table["rate_high"]).fillna(0.0)
    largest = sizes.argmax()
    if rows[0]["name"] not in TOGETHER and sizes.iloc[largest] > sizes.iloc[-1]:
        rows.insert(0, table.iloc[largest])
    sentences: list[str] = []
    for row in rows:
        where, rate = temperature_words(row["name"]), rates[row["name"]]
        if row["name"] in TOGETHER:
            where = _over(row["name"])
        elif len(rows) > 1 and not sentences:
            where += ", which may govern" if rate.is_bounded else ", which governs"
        ratio = _ratio_words(row, rate, warm) if temperature_words(row["name"]) != warm else ""
        where = where if prefix else _head(where)
        if row["outcome"] == CONTRADICTED:
            ratio += f", of a curve that is {CONTRADICTED} by its own runs"
        sentences.append(f"{prefix}{where}: {_period(rate)}{ratio}.")
    return sentences


def _ratio_words(row: Any, rate: Rate, warm: str) -> str:
    """Return how often a capacity is exceeded in comparison with the warmest temperature."""
    quotient, low, high = (float(row[name]) for name in RATIOS)
    times = f"times as often as at {warm}"
    # Too few motions have no band.
    if not 0.0 < quotient < np.inf:
        has_bounds = np.isnan(quotient) and low < np.inf and not rate.few_motions
        return f", {_band_words(low, high, warm)} {times}" if has_bounds else ""
    band = f" ({_band_words(low, high, warm)})" if not rate.few_motions else ""
    return f", {quotient:.2f} {times}{band}"


def _band_words(low: float, high: float, warm: str) -> str:
    """Return the ends of a band of a ratio, and why it has no upper one.

    >>> _band_words(0.5, 2.0, "23 °C"), _band_words(0.5, np.inf, "23 °C").partition(":")[0]
    ('0.50 to 2.00', '0.50 or more; no upper bound')
    """
    if high < np.inf:
        return f"{low:.2f} to {high:.2f}"
    return f"{low:.2f} or more; {NO_UPPER}: {NO_EXCEEDANCE.format(warm)}"


LONGEST_PERIOD = 1e6  # [year] that is written without a power of ten
MOST_STATED = 10  # levels of the intensity whose medians a sentence has


def _demand_sentences(part: "StudyResult", prefix: str) -> list[str]:
    """Return the median demand at each intensity, at the lowest and the highest temperature.

    A median over all intensities together would say which levels were chosen. None of so many
    intensities that each run has its own.
    """
    demand, failed = part.demand_name, part.question.failed
    is_measure = part.study.factors.scale.of == "intensity" or "scale" not in part.table
    level = part.intensity if is_measure else "scale"
    levels = np.unique(part.table[level]).tolist() if level in part.table else [None]
    if len(levels) > MOST_STATED:
        return []
    by = (level,) if len(levels) > 1 else ()
    rows, least = (part.demand(demand, by=by, failed=failed, least=end) for end in (False, True))
    unit = f" {find_unit(demand)}".rstrip()
    rows["stated"] = [
        text if isinstance(text, str) else number(text) if np.isfinite(text) else "collapse"
        for text in between_words(least["0.5"], rows["0.5"])
    ]
    temperatures = np.unique(rows[AMBIENT])
    if len(levels) > 1 and len(temperatures) * len(levels) != len(rows):
        return []  # classes of drawn temperatures, which not every intensity has
    texts = [
        f"{joined(rows['stated'][rows[AMBIENT] == at])}{unit} at {number(at)} °C"
        for at in temperatures[[0, -1]]
    ]
    the, where = "the" if prefix else "The", ""
    if len(levels) > 1:
        stated = joined(f"{value:.3g}" for value in levels)
        where = f" at {column_words(level)} = {stated} {find_unit(level)}".rstrip()
    verb = "are" if where else "is"
    plural = "s" if where else ""
    return [
        f"{prefix}{the} median{plural} of the {column_words(demand)}{where} {verb} "
        f"{' and '.join(texts)}."
    ]


def _over(name: str) -> str:
    """Return what a curve of all temperatures together is over, in words."""
    return f"over {'the ' * (name == CLIMATE)}{name}"


def _median_sentences(part: "StudyResult", prefix: str) -> list[str]:
    """Return the median intensities of the coldest and warmest curve and of all together."""
    curves, unit = part.all_curves(), find_unit(part.intensity)
    texts, missing = [], []
    # The first, the last temperature, and the climate if any.
    separate = [name for name in curves if name not in TOGETHER]
    together = [name for name in curves if name in TOGETHER]
    for name in dict.fromkeys([*separate[:1], *separate[-1:], *together]):
        curve = curves[name]
        if np.isnan(curve.stated_median):
            least = curve.row()["median_low"] if curve.outcome == NONE_BEYOND else np.nan
            bound = f" (above {with_intensity_unit(least, unit)})" if least > 0.0 else ""
            where = temperature_words(name) if name not in TOGETHER else _over(name)
            missing.append(f"{where}{bound}")
            continue
        row = curve.row()
        has_band = not curve.few_motions and np.isfinite(row["median_low"])
        remarks = [f"{row['median_low']:.3g} to {row['median_high']:.3g}"] * bool(has_band)
        remarks += [CONTRADICTED] * bool(curve.misfit)
        remark = f" ({'; '.join(remarks)})" if remarks else ""
        stated = f"{with_intensity_unit(curve.median, unit)}{remark}"
        texts.append(
            f"{stated} at {temperature_words(name)}"
            if name not in TOGETHER
            else f"{stated} {_over(name)}"
        )
    if not texts:
        return []
    the = "the" if prefix else "The"
    none = (
        f"; no median {'at ' * (not missing[0].startswith('over '))}{joined(missing)}"
        if missing
        else ""
    )
    return [
        f"{prefix}{the} {column_words(part.demand_name)} exceeds {limit_words(part)} with a "
        f"probability of one half at {column_words(part.intensity)} = {joined(texts)}{none}.",
        *_contradictions(curves, prefix),
    ]


def _contradictions(curves: Mapping[Any, Fragility], prefix: str) -> list[str]:
    """Return which curves contradict their own runs, the first with its counts, as a sentence."""
    wrong = {temperature_words(name): curve for name, curve in curves.items() if curve.misfit}
    if not wrong:
        return []
    (first, curve), *others = wrong.items()
    half = f"; {curve.half_words}" if curve.half_words else ""
    also = f"; also {CONTRADICTED}: {joined(name for name, _ in others)}" if others else ""
    the = "the" if prefix else "The"
    return [
        f"{prefix}{the} curve ({first}) is {CONTRADICTED} by its own runs: "
        f"{curve.misfit_words}{half}{also}."
    ]


def _period(rate: Rate) -> str:
    """Return the return period with its band, or a bound."""
    last = f" to {_years(1.0 / rate.low)}" if rate.low > 0.0 else " or more"
    if rate.outcome == ALL_BEYOND and rate.low > 0.0 and not rate.few_motions:
        # The upper end is that of the hazard curve, not of the counts.
        return f"exceeded once in {_years(1.0 / rate.low)} years or less ({ALL_BEYOND_WORDS})"
    if rate.is_bounded and not rate.few_motions:
        reason = f"{rate.outcome}: bounds of the counts, which determine no curve"
        return f"exceeded once in {_years(1.0 / rate.high)}{last} years ({reason})"
    if np.isnan(rate.rate):
        return "there is no fragility curve; see the tables"
    if rate.rate == 0.0:
        bound = f": the return period is at least {_years(1.0 / rate.high)} years"
        return f"no run exceeds the capacity{bound if rate.high > 0.0 else ''}"
    band = rate.few_motions or f"{_years(1.0 / rate.high)}{last}"
    return f"exceeded once in {_years(rate.return_period)} years ({band})"


def _years(period: float) -> str:
    """Return a return period with three digits, "5810"; of a million years or more with a power."""
    rounded = f"{period:.3g}"
    return f"{float(rounded):.0f}" if 1000.0 <= period < LONGEST_PERIOD else rounded


def column_units(result: "StudyResult") -> dict[str, str]:
    """Return the unit of each factor, by its column."""
    labels = label_plan(Plan(result.study), result.factors)
    return {name: find_unit(name) or unit.removeprefix("1") for name, (unit, _) in labels.items()}


def result_tables(result: "StudyResult") -> dict[str, Table]:
    """Return failures, demand, fragility, rates and variance, as far as the study has them."""
    demand = result.demand_name
    tables: dict[str, Table] = {}
    failures = count_failures(result.table)
    if len(failures):
        tables["outcomes"] = failures_table(failures)
    if AMBIENT in result.factors:
        tables["demand"] = _demand_table(result)
    if has_curves(result):
        for name, part in result.parts().items():
            tables |= _curve_tables(part, name)
    if result.has_variance:
        table = result.variance(demand)
        table["factor"] = table["factor"].map(column_words)
        note = f"{result.lost_demands().sentence}."
        notes = (note, OF_CHOSEN, sampling_note(table), _paired_note(table))
        note = " ".join(filter(None, notes))
        caption = f"Shares of the variance of the {column_words(demand)}"
        tables["variance"] = _table(table.drop(columns=["rows", "left_out"]), caption, note=note)
    return tables


def _demand_table(result: "StudyResult") -> Table:
    """Return mean, fractiles and median of the demand by temperature, with its failed runs."""
    demand, failed = result.demand_name, result.question.failed
    table = result.demand(demand, failed=failed)
    least = result.demand(demand, failed=failed, least=True)
    shares = {c: f"{100 * float(c):g} %" for c in map(str, table) if c.startswith("0.")}
    ends = ("median_low", "median_high")
    for name in ("mean", *shares):
        table[name] = between_words(least[name], table[name])
    table["median_low"] = least["median_low"]
    few = table["median_high"].isna().to_numpy() & (table["runs"] > 0).to_numpy()
    _mark_cells(table, few, ends)
    heads = shares | {end: _head(_with_level(end, percent(LEVEL))) for end in ends}
    heads |= {"runs": "Runs counted", "all_runs": "Of runs", "failed": "Of these failed"}
    pooled = pooled_words(result)
    caption = f"{column_words(demand)} by ambient temperature{pooled}{_of_runs(result)}"
    note = f"{count_failed(result.table, demand, failed, ANY).sentence}."
    if few.any():
        note += (
            f" {TOO_FEW.capitalize()}: a median of fewer than {LEAST_MOTIONS} motions has no band."
        )
    units = dict.fromkeys(["mean", *shares, *ends], find_unit(demand))
    return _table(table, caption, units=units, heads=heads, note=note)


def between_words(least: "pd.Series", most: "pd.Series") -> "pd.Series":
    """Return numbers where bounds are equal, and words where failed runs leave a range."""
    texts = most.astype(object)
    for row in np.flatnonzero(np.isfinite(least) & (least != most)).tolist():
        low, high = float(least.iloc[row]), float(most.iloc[row])
        end = f"{low:.4g} to {high:.4g}" if np.isfinite(high) else f"at least {low:.4g}"
        texts.iloc[row] = end
    return texts if (least != most).any() else most


def pooled_words(result: "StudyResult") -> str:
    """Return ", over all 8 intensities together" of several intensities; "" of one."""
    intensities = result.table[result.intensity].nunique()
    return f", over all {intensities} intensities together" if intensities > 1 else ""


def _with_level(end: str, level: str) -> str:
    """Return the words of an end of a band: "median, 95 % low"."""
    name, _, side = end.rpartition("_")
    return f"{name}, {level} {side}" if side in ("low", "high") else end


def _of_runs(result: "StudyResult") -> str:
    return f", {result.selection}" if result.selection else ""


def _paired_note(contributions: "pd.DataFrame") -> str:
    """Return what factors with one common share need for a share of each; "" without them."""
    if not contributions["factor"].str.contains(", ").any():
        return ""
    return (
        "Paired factors have the same draws in all combinations of levels and one share together: "
        "a share of each needs a study with paired = false in [design]."
    )


def worst_table(result: "StudyResult", worst: "pd.DataFrame") -> Table:
    """Return `StudyResult.worst` as a table for readers."""
    caption, rows = "The worst runs, and the first of each failure mode", worst.drop(columns="id")
    by_run = result.table.set_index("run", drop=False).loc[worst["run"]]
    stopped, note = stopped_runs(by_run), ""
    by = next(name for name in reversed(list(map(str, worst))) if name != "command")
    if stopped.any():
        last_values = [f"at least {number(value, '.4g')}" for value in worst[by]]
        rows[by] = rows[by].astype(object).where(~stopped, last_values)
        note = (
            f"Runs whose lead melted or whose bearing passed {percent(LARGEST_STRAIN)} strain have "
            "a demand of at least their recorded value."
        )
    return _table(rows, caption, units=column_units(result), note=note)


def _curve_tables(part: "StudyResult", name: str) -> dict[str, Table]:
    """Return the tables of fragility and rates of one structure and bearing."""
    of, ending = (f", {name}", f"-{name}") if name else ("", "")
    hazard = part.question.hazard is not None
    curves, rates = part.find_rates() if hazard else (part.find_curves()[0], {})
    all_curves = part.all_curves()
    table = pd.DataFrame([curve.row() for curve in all_curves.values()])
    table["name"] = [temperature_words(level) for level in all_curves]
    ambient = _head(column_words(AMBIENT))
    im, unit = column_words(part.intensity), find_unit(part.intensity)
    medians = [end for end in map(str, table) if end.startswith("median")]
    level = percent(next(iter(all_curves.values())).level)
    heads = {
        end: _head(_with_level(end, level).replace("median", f"median {im}", 1)) for end in medians
    }
    heads |= {end: _head(_with_level(end, level)) for end in DISPERSION_BANDS}
    units = dict.fromkeys(medians, unit)
    if unit == "m/s²":  # levels are often given in g
        in_g = table["median"] / (STANDARD_GRAVITY / 1000.0)
        table.insert(list(table).index("median") + 1, "median_g", in_g)
        heads["median_g"], units["median_g"] = heads["median"], "g"
    _mark_too_few(table, all_curves)
    demand = f"{column_words(part.demand_name)} above {limit_words(part)}"
    mixed = any(curve.mixture for curve in all_curves.values())
    kind = "fragility" if mixed else "lognormal fragility"
    tables = {
        f"fragility{ending}": _table(
            table.drop(columns=IN_CAPTION),
            f"{demand}: {kind} by {part.question.method}{of}{_of_runs(part)}",
            units=units,
            heads=heads
            | {
                "name": ambient,
                "beyond": "Exceedances",
                "runs": "Runs counted",
                "all_runs": "Of runs",
            },
            note=_curve_notes(all_curves, other_medians(part), unit),
        )
    }
    tables |= _count_tables(all_curves, part, name)
    if rates:
        tables[f"rates{ending}"] = _rates_table(part, curves, rates, of)
    return tables


def _rates_table(
    part: "StudyResult", curves: Mapping[Any, Fragility], rates: Mapping[Any, Rate], of: str
) -> Table:
    """Return annual rates, with the weights of the temperatures and what limits a rate."""
    rows = part.rates_table(curves, rates)
    few_motions = [rate.few_motions for rate in rates.values()]
    warm = temperature_words(list(curves)[-1])
    limits = (text for rate in rates.values() for text in rate.notes)
    notes = [*few_motions, *limits, _weights_note(list(part.all_curves().values())[-1])]
    unlimited = np.isinf(rows["over_high"].to_numpy(dtype=float))
    if unlimited.any():
        rows["over_high"] = rows["over_high"].astype(object).where(~unlimited, NO_UPPER)
        notes.append(f"{NO_UPPER}: {NO_EXCEEDANCE.format(warm)}")
    _mark_cells(rows, np.array([bool(text) for text in few_motions]), RATE_BANDS)
    rows["name"] = rows["name"].map(temperature_words)
    over = f"Ratio to {warm}"
    heads: dict[str, str] = {
        "name": _head(column_words(AMBIENT)),
        "in_50_years": "Probability in 50 years",
    }
    heads |= {"return_period_years": "Return period", "over_reference": over}
    heads |= {"over_low": f"{over}, low", "over_high": f"{over}, high"}
    return _table(
        rows.drop(columns=["reference", "notes"]),
        f"Annual rates{of}",
        units=RATE_UNITS,
        heads=heads,
        note="; ".join(dict.fromkeys(filter(None, notes))),
    )


def _weights_note(curve: Fragility) -> str:
    """Return the weights of the temperatures in the rate of their mean; "" of one curve."""
    weights = joined(
        f"{percent(share, 1)} ({temperature_words(at)})" for at, share in curve.shares.items()
    )
    between = "an hour between two levels counts for both, by linear interpolation"
    return f"weights over the {curve.name}: {weights} of the time; {between}" if weights else ""


def _count_tables(
    curves: Mapping[Any, Fragility], part: "StudyResult", name: str
) -> dict[str, Table]:
    """Return the counts of each curve, which are to be used in place of one that they contradict.

    A temperature without a curve has its counts alone.
    """
    rows = []
    for level, curve in curves.items():
        if len(curve.parts) > 1:
            continue
        counts = curve.comparison.assign(name=temperature_words(level))
        counts["share"] = counts["beyond"] / counts["runs"]
        counts["probability"] = counts["probability"].round(DECIMALS_OF_SHARES)
        if not curve.estimate.known:
            counts[OF_CURVE] = np.nan
        rows.append(counts[["name", "first", "last", "runs", "beyond", "share", *OF_CURVE]])
    frame = pd.concat(rows, ignore_index=True)
    if (frame["first"] == frame["last"]).all():
        frame = frame.drop(columns="last")
    of, ending = (f", {name}", f"-{name}") if name else ("", "")
    level = percent(next(iter(curves.values())).level)
    im, unit = column_words(part.intensity), find_unit(part.intensity)
    heads = {
        "name": _head(column_words(AMBIENT)),
        "first": f"{im}, from" if "last" in frame else im,
        "last": f"{im}, to",
        "runs": "Single curves" if part.question.method == "ida" else "Runs",
        "beyond": "Exceedances",
        "share": "Share of exceedances",
        "probability": "Share of the curve",
        "low": "Exceedances of the curve, low",
        "high": "Exceedances of the curve, high",
    }
    wrong = joined(temperature_words(name) for name, curve in curves.items() if curve.contradiction)
    note = f"The ends are those of binomial intervals, {level} for all counts of a curve together."
    note += f" Counts contradict the curve: {wrong}." if wrong else ""
    caption, units = f"Counts of runs and share of their curve{of}", {"first": unit, "last": unit}
    return {f"counts{ending}": _table(frame, caption, units=units, heads=heads, note=note)}


def _curve_notes(
    curves: Mapping[Any, Fragility], medians: Mapping[Any, Mapping[Failed, float]], unit: str
) -> str:
    """Return the failed runs of curves, and what is wrong with them, each with its temperatures.

    Where failed runs matter, the medians with their other treatments follow the count.
    """
    notes: dict[str, list[str]] = {}
    for level, curve in curves.items():
        others = medians.get(level, {})
        stated = joined(
            f'{with_intensity_unit(median, unit)} with failed = "{treatment}"'
            for treatment, median in others.items()
            if np.isfinite(median)
        )
        missing = joined(f'"{name}"' for name, median in others.items() if np.isnan(median))
        reason = curve.estimate.sentence
        texts: tuple[str, ...] = (
            reason,
            "" if reason and not others else curve.sentence,
            f"the median is {stated}" if stated else "",
            f"there is no median with failed = {missing}" if missing else "",
        )
        for text in filter(None, texts):
            notes.setdefault(text, []).append(temperature_words(level))
    for level, curve in curves.items():
        # The numbers of a misfit, which differ from curve to curve, are in a table and a warning.
        misfit = curve.misfit.partition(":")[0]
        texts = (
            curve.incomplete_levels,
            curve.beyond_levels,
            curve.wide_bands,
            curve.mixture,
            curve.few_mixed,
            curve.coarse.partition(",")[0],
            misfit,
        )
        for text in filter(None, texts):
            notes.setdefault(text, []).append(temperature_words(level))
    sentences = [f"{joined(levels)}: {text}." for text, levels in notes.items()]
    return " ".join([*sentences, *[f"{CLIMATE}: all temperatures together."] * (CLIMATE in curves)])


def _mark_too_few(table: "pd.DataFrame", curves: Mapping[Any, Fragility]) -> None:
    """Put words in place of the bands of few motions, and of medians that are no results."""
    beyond = np.array([bool(curve.beyond_levels) for curve in curves.values()])
    with_few_motions = np.array([bool(curve.few_motions) for curve in curves.values()])
    sizes = [name for name in map(str, table) if name.startswith(("median", "dispersion"))]
    # A curve is there, but no number of it is a result.
    table["outcome"] = [
        curve.few_words if curve.beyond_levels and curve.outcome == COMPLETED else curve.outcome
        for curve in curves.values()
    ]
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
