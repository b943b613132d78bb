"""Content that the reports of all analyses share: inputs, limits, validity, identity.

`build_pieces` puts it together; the `report.py` of a package adds question, answer, tables, figures
and assumptions.
"""

import json
import math
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path
from thermobearing.border.opener import LARGEST_MEMBER, read_bytes, read_json
from thermobearing.border.toml import flat, read_toml
from thermobearing.border.units import split_quantity
from thermobearing.quantities.governing import SLACK_KELVIN, largest_by, least_by
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import (
    counted,
    identity_rows,
    joined,
    plain,
    printed_unit,
    tidy,
)
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_ASSESSED,
    PASSED,
    TENTATIVE,
    Check,
    Pieces,
    Plot,
    ReportFigure,
)
from thermobearing.results.directory import COMPARISON, FIGURES, SUMMARY
from thermobearing.results.ranges import (
    NOT_GIVEN,
    SLACK,
    TESTED,
    parted,
    rate_clause,
    rate_note,
    ring_note,
    runs_of,
)
from thermobearing.results.saved import SavedResult, read_csv

Row = Mapping[Any, Any]
# A law of the user in a resolved case: its name and the digest of its source.
OWN_LAW = re.compile(r'^law = "[^"@]+@[0-9a-f]+"', re.MULTILINE)
PREPARED = "Prepared by"
SIGNED = (PREPARED, "Checked by", "Approved by")  # roles, also words of the title block


def build_pieces(
    command: str,
    title: str,
    question: str,
    answer: Sequence[str],
    *,
    identity: Mapping[str, str],
    warnings: Iterable[str] = (),
    checks: Sequence[Check] = (),
    judged: bool = True,
    rate_rows: Iterable[Row] = (),
    lead_rise: float = float("nan"),
    residuals: Iterable[tuple[str, float, float, str]] = (),
    tables: Mapping[str, Table] | None = None,
    validity: Sequence[str] = (),
    **parts: Any,
) -> Pieces:
    """Return the content of the report of a result.

    A package gives question, answer, tables, figures, inputs and assumptions; the rest follows from
    the warnings, checks and residuals of the result. A package whose results are files passes
    ``**saved_parts(saved, command)``, one whose results are datasets
    ``**result_parts(result, case, command)``.

    Warnings on the range behind the parameters become the validity, which is unknown of bearings
    that state no range. `judged` ends the answer with a sentence on limits and validity.
    `rate_rows` of the tested range give a note on strain rates in earthquakes, `lead_rise` [K] one
    on the rubber around the lead, `residuals` of the energy balance the table "quality".
    """
    of_range, other_warnings = parted(dict.fromkeys(warnings))
    unstated = [text for text in of_range if NOT_GIVEN in text]
    beyond = [*(tidy(text) for text in of_range if text not in unstated), *validity]
    rate_rows = list(rate_rows)
    rate, ring = rate_note(rate_rows), ring_note(lead_rise)
    uncounted = rate_clause(rate_rows)
    quality, residual_warnings = _quality_table(residuals)
    verdict = [_verdict(checks, beyond, unstated, uncounted)] if judged else []
    parts.setdefault("signatures", SIGNED)
    return Pieces(
        command=command,
        title=title,
        question=question,
        answer=[*answer, *verdict],
        tables={**(tables or {}), **({"quality": quality} if len(quality) else {})},
        checks=checks,
        uncounted=uncounted,
        validity=beyond,
        validity_unknown=" ".join(map(tidy, unstated)),
        notes=[tidy(f"{note[:1].upper()}{note[1:]}") for note in (rate, ring) if note],
        warnings=[*residual_warnings, *map(tidy, other_warnings)],
        identity=identity,
        **parts,
    )


def result_parts(result: Any, case: str, command: str) -> dict[str, Any]:
    """Return what `build_pieces` needs of a result with a dataset, and of its resolved case."""
    version = str(result.dataset.attrs["version"])
    # A law of the user is in a file of the user: the case holds its name and the digest only.
    law = " --law FILE" if OWN_LAW.search(case) else ""
    repeat_command = f"thermobearing {command} case.resolved.toml{law}"
    identity = identity_rows(version, case, repeat_command)
    return {"identity": identity, "warnings": result.warnings}


def saved_parts(saved: SavedResult, otherwise: str) -> dict[str, Any]:
    """Return what `build_pieces` needs of a result that is read back from its directory.

    `otherwise` made it where no command was typed.
    """
    return {"identity": saved_identity(saved, otherwise), "warnings": saved.warnings}


def saved_identity(saved: SavedResult, otherwise: str) -> dict[str, str]:
    """Return version, hash of what went in, and the command that was typed, or `otherwise`."""
    summary = saved.summary
    hashed_name, tests = "summary.json", {}
    hashed: Any = summary
    # Where the summary has the inputs, they identify the result; otherwise all of it does.
    if (inputs := summary.get("inputs")) is not None:
        records = summary.get("records", summary.get("comparisons", []))
        records = [*records, *(summary.get("held_out") or {}).get("records", [])]
        digests = [str((record.get("conditions") or {}).get("sha256", "")) for record in records]
        names = [str(record.get("name", record.get("test"))) for record in records]
        tests = {
            f"SHA-256 of the samples of {name} (time, displacement, force; 8 bytes each)": digest
            for name, digest in zip(names, digests, strict=True)
            if digest
        }
        tests |= {f"SHA-256 of the file {name}": digest for name, digest in input_files(records)}
        hashed_name = "`inputs` and the digests of all samples in summary.json"
        hashed = [inputs, digests]
    command = str(summary.get("command_line") or otherwise)
    version, text = str(summary.get("version", "unknown")), json.dumps(hashed, sort_keys=True)
    return identity_rows(version, text, command, hashed_name) | tests


def input_files(records: Iterable[Row]) -> list[tuple[str, str]]:
    """Return path and SHA-256 of each file that records of a summary were read from, once each."""
    files = ((record.get("conditions") or {}).get("files", {}) for record in records)
    return list({path: digest for group in files for path, digest in group.items()}.items())


# Limits.
# Largest residual of the energy balance, of the largest energy in it: rounding comes to 1e-10, what
# is more is a fault of the computation.
RESIDUAL_LIMIT = 1e-6
TESTED_RANGE = "calibration range"  # how the source of those limits begins
RIG = {"force": "force", "stroke": "stroke", "speed": "speed"}
TESTS = {name: title for name, (_, title, _, _) in TESTED.items()} | {
    "strain": "shear strain",
    "ambient": "ambient temperature",
    "lead_temperature": "temperature of the lead",
}
IN_EARTHQUAKES = {name: title for name, title in TESTS.items() if name != "strain_rate"}


def limit_checks(
    rows: Iterable[Row],
    titles: Mapping[str, str],
    source: str,
    bearings: Sequence[str] = (),
) -> list[Check]:
    """Return a check for each end of each limit: the run that goes farthest.

    `rows` are those of `results.ranges.compared`, `titles` the words of the limits that are taken,
    `bearings` names with which runs begin, whose limits are their own (none: one for all runs).
    """
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row["limit"] in titles:
            run = str(row["run"])
            bearing = next((name for name in bearings if run.startswith(f"{name}, ")), "")
            groups.setdefault((bearing, row["limit"]), []).append(row)
    checks = []
    for (bearing, limit), group_rows in groups.items():
        name = f"{bearing}: {titles[limit]}" if bearing else titles[limit]
        # The upper end always, the lower one only where a run passes it.
        passed = [row for row in group_rows if row["outside"]]
        too_low = [row for row in passed if row["demand"] < row["lowest"]]
        above = largest_by(group_rows, lambda row: float(row["demand"]))
        runs = runs_of(row for row in passed if row not in too_low)
        checks.append(_check(name, above, bearing, source, runs, lower=False))
        if too_low:
            below = least_by(too_low, lambda row: float(row["demand"]))
            checks.append(_check(name, below, bearing, source, runs_of(too_low), lower=True))
    of_tests = source.startswith(TESTED_RANGE)
    return [replace(check, of_tests=of_tests) for check in checks]


def _check(
    name: str, row: Row, bearing: str, source: str, runs: Collection[str], *, lower: bool
) -> Check:
    """Return the check of one end of a limit, which `runs` pass."""
    limit, value = float(row["lowest"] if lower else row["largest"]), float(row["demand"])
    unit, factor = ("%", 100.0) if row["limit"] == "strain" else printed_unit(str(row["unit"]))
    outside = value < limit if lower else value > limit
    # A value that is outside by no more than the slack is still within; the source says so.
    passed = bool(row["outside"]) and outside
    if outside and not passed:
        allowance = f"{SLACK_KELVIN:g} K" if row["unit"] == "degC" else f"{100.0 * SLACK:.0f} %"
        source = f"{source}, and {allowance} more"
    label = f"{name} ({plain(str(row['run']).removeprefix(f'{bearing}, '))})"
    verdict = EXCEEDED if passed else PASSED
    check = Check(label, factor * value, factor * limit, unit, source, verdict, lower)
    return replace(check, runs=frozenset(runs), limited=name)


def _quality_table(rows: Iterable[tuple[str, float, float, str]]) -> tuple[Table, list[str]]:
    """Return the residuals of the energy balance as a table, and warnings of those too large."""
    cells, warnings = [], []
    for name, value, limit, source in rows:
        if value != value or limit != limit:  # NaN
            verdict = NOT_ASSESSED
        else:
            verdict = PASSED if abs(value) <= limit else EXCEEDED
        cells.append([name, abs(value), limit, source, verdict])
        if verdict == EXCEEDED:
            warnings.append(
                f"The {name} of the energy balance is {abs(value):.1e}, above {limit:.0e}: the "
                "results are not accurate; use a smaller dt."
            )
    heads = ("Energy balance", "Largest", "Limit", "Source of the limit", "Verdict")
    forms = ("", ".1e", ".0e", "", "")
    columns = [Quantity(head, form=form) for head, form in zip(heads, forms, strict=True)]
    columns[1] = replace(columns[1], rounding=quantity("structure_residual").rounding)
    return Table("Numerical quality", columns, cells), warnings


INSIDE = "results lie inside the calibration range."
OUTSIDE = "outside the calibration range"


def _quantities(count: int) -> str:
    return "1 quantity" if count == 1 else f"{count} quantities"


def summarize_checks(checks: Sequence[Check], uncounted: str = "") -> str:
    """Return how many checks fail, lie outside the calibration range, or lack limit or value.

    A quantity of a bearing that is outside at both ends of its range counts once; the runs are
    those that leave the range in any quantity. `uncounted` (`rate_clause`) is no such quantity.
    """
    engineering = [check for check in checks if not check.of_tests]
    if not engineering:
        return "No engineering limit was given."
    exceeded = sum(check.verdict == EXCEEDED for check in engineering)
    beyond = [check for check in checks if check.of_tests and check.verdict == EXCEEDED]
    outside = len({check.limited or check.what for check in beyond})
    runs = frozenset[str]().union(*(check.runs for check in beyond))
    in_runs = f" in {counted(len(runs), 'run')}" if runs else ""
    in_runs += f" (not counting {uncounted})" if uncounted else ""
    lacking = [check for check in engineering if check.without_limit]
    # As the sentence of `not_entered` counts them: a limit of several bearings is one to enter.
    limits, without = len({check.limited or check.what for check in lacking}), len(lacking)
    verb = "is" if limits == 1 else "are"
    missing = sum(check.verdict == NOT_ASSESSED for check in engineering) - without
    tentative = sum(check.verdict == TENTATIVE for check in engineering)
    parts = [
        f"{counted(exceeded, 'check')} exceed{'s its' if exceeded == 1 else ' their'} limit",
        f"{_quantities(outside)} {'is' if outside == 1 else 'are'} {OUTSIDE}{in_runs}",
        f"{counted(limits, 'limit')} {verb} not entered ({counted(without, 'check')})",
        f"{counted(missing, 'check')} {'lacks' if missing == 1 else 'lack'} an input",
        f"{counted(tentative, 'check')} of codes {'has' if tentative == 1 else 'have'} too few "
        "motions for the rule of the code",
    ]
    counts = exceeded, outside, without, missing, tentative
    clauses = [text for text, count in zip(parts, counts, strict=True) if count]
    # The table of limits has no row of the calibration range, which a clause of its own is about.
    satisfied = len(engineering) - exceeded - without - missing - tentative
    if not clauses:
        return f"No limit is exceeded ({counted(satisfied, 'check')})."
    if satisfied:
        clauses.append(f"the other {satisfied} {'is' if satisfied == 1 else 'are'} satisfied")
    return f"{'; '.join(clauses)}."


def _verdict(
    checks: Sequence[Check],
    beyond: Sequence[str],
    unstated: Sequence[str] = (),
    uncounted: str = "",
) -> str:
    """Return the sentences on limits and validity, the last of an answer.

    `beyond` are the sentences on what lies outside a range, `unstated` those on bearings without
    one: of these the validity is unknown, which counts as neither inside nor outside. `uncounted`
    are strain rates above the tests (`rate_clause`).
    """
    sentences = [summarize_checks(checks, uncounted)]
    if beyond and OUTSIDE not in sentences[0]:
        sentences.append("Some results are outside the calibration range.")
    if unstated:
        # One warning may be about several bearings, and begin with a step of a sequence.
        names = re.findall(rf"([^:;]+): {NOT_GIVEN}", "; ".join(unstated))
        bearings = dict.fromkeys(name.strip() for name in names)
        sentences.append(
            f"The calibration range of {joined(bearings)} is not stated, so the validity of "
            "results with it is unknown."
        )
    elif not beyond:
        sentences.append(f"{'Except for strain rates, all' if uncounted else 'All'} {INSIDE}")
    return " ".join(sentences)


def beyond_mark(rows: Iterable[Row], run: str, limit: str, value: float) -> bool:
    """Return whether a value of a run lies outside the range, and the run was found to leave it."""
    exceeded_rows = [
        row for row in rows if (row["run"], row["limit"]) == (run, limit) and row["outside"]
    ]
    return any(not row["lowest"] <= value <= row["largest"] for row in exceeded_rows)


# Inputs.
COLUMNS = (Quantity("What"), Quantity("Value", form=".4g"), Quantity("Unit"), Quantity("Source"))
RANGES = ("tested_range.",)  # keys whose two values are ends


@cache
def _input_names() -> dict[str, str]:
    return tomllib.loads(data_path("reports", "input_names.toml").read_text(encoding="utf-8"))


def key_words(key: str) -> str:
    """Return words for a dotted key of an input; the key in words where nothing is known."""
    parts = key.split(".")
    # The longest ending of the key that has words: "lead.diameter" before "diameter".
    for first in range(len(parts)):
        if phrase := _input_names().get(".".join(parts[first:])):
            return phrase
    words = ", ".join(part.split("[")[0].replace("_", " ") for part in parts)
    return words[:1].upper() + words[1:]


def input_table(
    caption: str,
    table: Mapping[str, Any],
    sources: Mapping[str, str] | None = None,
    *,
    without: Collection[str] = (),
    otherwise: str = "",
    note: str = "",
) -> Table:
    """Return a row for each value of a table of a resolved input."""
    source_by_key = sources or {}
    rows = []
    for key, value in flat(table).items():
        if any(key == prefix or key.startswith((f"{prefix}.", f"{prefix}[")) for prefix in without):
            continue
        source = source_by_key.get(key) or source_by_key.get(key.split("[")[0]) or otherwise
        rows.append((key_words(key), *value_and_unit(value, ends=key.startswith(RANGES)), source))
    return with_sources(Table(caption, COLUMNS, rows, note=note))


def with_sources(table: Table) -> Table:
    """Return a table of `COLUMNS`; without the sources where no value has one."""
    if any(row[-1] for row in table.rows):
        return table
    return replace(table, columns=table.columns[:-1], rows=[row[:-1] for row in table.rows])


def value_and_unit(value: Any, *, ends: bool = False) -> tuple[Any, str]:
    """Return a value of TOML, such as "0.4 kN s^2/mm", as number or text with its printed unit.

    With `ends` two values are the ends of a range.
    """
    if isinstance(value, list | tuple):
        return _several([value_and_unit(item) for item in value], ends)
    number, unit = (split_quantity(value) if isinstance(value, str) else None) or ("nan", "")
    # "2nd pier" is a name: a unit stands apart from its number.
    apart = bool(unit) and value.strip()[len(number)].isspace()
    if not apart or not math.isfinite(float(number)):
        return value, ""
    unit, factor = printed_unit(unit)
    return factor * float(number), unit


def _several(pairs: Sequence[tuple[Any, str]], ends: bool) -> tuple[Any, str]:
    """Return the values of a list in one cell, where they have one unit."""
    cell = COLUMNS[1]
    units = {unit for _, unit in pairs}
    if len(units) > 1:
        return ", ".join(f"{cell.text(value)} {unit}".strip() for value, unit in pairs), ""
    if ends and len(pairs) == 2:
        if pairs[0] == pairs[1]:
            return pairs[0]
        return " to ".join(cell.text(value) for value, _ in pairs), "".join(units)
    return ", ".join(cell.text(value) for value, _ in pairs), "".join(units)


# Saved results.
# Ends of names of columns and of keys of a summary, and the unit that they say.
UNITS = {
    "mm": "mm",
    "kN": "kN",
    "MPa": "MPa",
    "s": "s",
    "K": "K",
    "t": "t",
    "Hz": "Hz",
    "gal": "gal",
    "kJ": "kJ",
    "m": "m",
    "rad": "rad",
    "degC": "°C",
    "kN_mm": "kN mm",
    "kN_per_mm": "kN/mm",
    "mm_s": "mm/s",
    "m_s2": "m/s²",
    "cm_s": "cm/s",
    "cm": "cm",
    "kN_m": "kN m",
    "kNmm": "kN mm",
    "percent": "%",
    "m_s": "m/s",
}
MOST_ROWS = 400  # of a table in a document; longer ones stay in their files
SHOWN_ELSEWHERE = {"command", "warnings", "outcome", "sentence", "version", "tested_range", "rig"}


def pieces_of_saved(saved: SavedResult) -> Pieces:
    """Return summary, tables and pictures of a result directory of any command."""
    summary = saved.summary
    facts = []
    for key, value in summary.items():
        if isinstance(value, list) and all(isinstance(item, str | int | float) for item in value):
            value = ", ".join(map(str, value))
        if isinstance(value, str | int | float) and key not in SHOWN_ELSEWHERE:
            facts.append((words(key)[0], value, words(key)[1]))
    without_source = [column for column in COLUMNS if column.head != "Source"]
    inputs = {"facts": Table("Values of the summary", without_source, facts)} if facts else {}
    return Pieces(
        command=saved.command,
        title=f"Result of {saved.command}",
        question=f"This report gives the results of `thermobearing {saved.command}`.",
        answer=[str(summary.get("sentence") or f"The analysis ended: {saved.outcome}.")],
        inputs=inputs,
        tables={name: make_table(name, table) for name, table in saved.tables.items()},
        figures=saved_figures(saved),
        warnings=saved.warnings,
        identity={"Program": f"thermobearing {summary.get('version', '')}".strip()},
    )


def shaded_note(tested: Iterable[float]) -> str:
    """Return what is shaded where runs exceed a tested value; empty without one (infinity)."""
    return " Shaded: outside the calibration range." if any(map(math.isfinite, tested)) else ""


def figure_captions(command: str) -> dict[str, str]:
    """Return the captions of the figures of a command, by the beginning of their names."""
    captions: dict[str, str] = read_toml(data_path("reports", "captions.toml")).get(command, {})
    return captions


def saved_figures(saved: SavedResult, command: str = "") -> dict[str, ReportFigure]:
    """Return the pictures of a result directory with their captions, as SVG where there is one.

    The captions of the command are by the beginning of the file's name (the longest that fits
    counts); those come first, in this order.
    """
    captions = figure_captions(command)
    names = {path.stem: path for path in saved.figures}
    order = list(captions)

    def _beginning(name: str) -> str:
        return max((start for start in captions if name.startswith(start)), key=len, default="")

    def _place(name: str) -> int:
        return order.index(_beginning(name)) if _beginning(name) else len(order)

    figures = {}
    for name in sorted(names, key=_place):
        vector = names[name].with_suffix(".svg")
        image = read_bytes(vector if vector.is_file() else names[name], LARGEST_MEMBER)
        title = name.replace("_", " ").replace("-", " ")
        caption = captions.get(_beginning(name), f"{title[:1].upper()}{title[1:]}.")
        figures[name] = ReportFigure(caption, image=image, alt=caption)
    return figures


def with_plot(
    figures: dict[str, ReportFigure], name: str, plot: Plot, command: str
) -> dict[str, ReportFigure]:
    """Return figures with a plot of one of them; first, drawn from it, where it has none."""
    if name in figures:
        return {**figures, name: replace(figures[name], plot=plot)}
    caption = figure_captions(command)[name]
    return {name: ReportFigure(caption, alt=caption, plot=plot), **figures}


def words(name: str) -> tuple[str, str]:
    """Return words and unit of a column such as "peak_force_kN"."""
    ends = {"kN_mm": "kN/mm"} if name.startswith("K_") else {}  # elsewhere kN_mm is an energy
    # Longest endings first: "_kN_mm" ends with "_mm" too.
    for end, unit in sorted((UNITS | ends).items(), key=lambda item: -len(item[0])):
        if name.endswith(f"_{end}"):
            return re.sub(r"[_\s]+", " ", name.removesuffix(f"_{end}")), unit
    return re.sub(r"[_\s]+", " ", name), ""


def make_table(name: str, table: "pd.DataFrame") -> Table:
    """Return a table of a result directory as its file has it; of a long one its first rows."""
    shown = table.head(MOST_ROWS).dropna(axis="columns", how="all")
    rows = [tuple(row) for row in shown.itertuples(index=False, name=None)]
    row_excess = len(table) - len(shown)
    note = (
        f"The first {MOST_ROWS} of {len(table)} rows; all are in {name}.csv." if row_excess else ""
    )
    columns = [_table_column(str(title), shown[title]) for title in shown.columns]
    return Table(words(name)[0].capitalize(), columns, rows, note=note)


def _table_column(title: str, values: "pd.Series[Any]") -> Quantity:
    """Return a column of a table of a result directory, in the unit of the file."""
    head, unit = words(title)
    first_word = head.split(" ")[0]
    head = f"{head[:1].upper()}{head[1:]}" if len(first_word) > 1 else head
    digits = 4  # or as many as the integer part has: 12345 and not 1.234e+04
    if pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_bool_dtype(values):
        digits = max(4, len(f"{float(values.abs().max()):.0f}"))
    return Quantity(head, unit, f".{digits}g")


LINE = "Warming compared with the test on a line of equal amplitude and period"
NOTE = "Model minus multi-layer model; rms: root mean square."
ALIKE = ("motion", "mode")  # said once where all runs have the same


def comparison_pieces(directory: Path) -> tuple[Table, dict[str, ReportFigure]]:
    """Return table and pictures of the comparison of models in a result directory."""
    frame = read_csv(directory / COMPARISON)
    if "outcome" in frame and (frame["outcome"] == "completed").all():
        frame = frame.drop(columns="outcome")
    frame = frame.dropna(axis="columns", how="all")
    shared = {k: frame[k].iloc[0] for k in ALIKE if k in frame and frame[k].nunique() == 1}
    frame = frame.drop(columns=list(shared))
    columns = []
    for name in map(str, frame.columns):
        title, _, unit = name.rpartition(" ")  # the unit is the last word, or the end of the key
        in_title = Quantity(f"{title[:1].upper()}{title[1:]}", unit, "+.1f")
        columns.append(in_title if unit in ("K", "%") else _table_column(name, frame[name]))
    rows = frame.astype(object).where(frame.notna(), None).to_numpy().tolist()
    verdict = read_json(directory / SUMMARY).get("verdict")
    note = "".join(f"{key.capitalize()}: {value}. " for key, value in shared.items()) + NOTE
    note = f"{note} {tidy(verdict[:1].upper() + verdict[1:])}." if verdict else note
    caption = "Earlier models compared with the multi-layer one"
    captions = figure_captions("models")
    if "line_rise_K" in frame:  # of a test in a plane
        caption, note = LINE, ""
        captions = captions | {"comparison": f"{LINE}."}
    table = Table(caption, columns, rows, note=note)
    figures = {
        name: ReportFigure(caption, image=read_bytes(file, LARGEST_MEMBER), alt=caption)
        for name, caption in captions.items()
        if (file := directory / FIGURES / f"{name}.png").is_file()
    }
    return table, figures
