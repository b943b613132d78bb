"""Tables of bearings and of the model, and the assumptions of the model, for all reports."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from thermobearing.bearing.bilinear import BILINEAR, BilinearBearing
from thermobearing.bearing.cells import Cells
from thermobearing.bearing.library import BEARINGS
from thermobearing.bearing.model import Bearing
from thermobearing.border.lazy import pd
from thermobearing.border.toml import flat, to_table
from thermobearing.laws import built_in_laws
from thermobearing.model import checks
from thermobearing.model.axial import compression_constants, compression_sources
from thermobearing.model.constants import SOFTENING_LEAD
from thermobearing.model.earlier import BLIND
from thermobearing.model.options import ModelOptions
from thermobearing.model.outcomes import PASSED_LIMITS, assumption_texts, heat_flow
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity, format_number
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.validity import FAILED, NOT_MODELLED
from thermobearing.quantities.words import joined, number, plain, printed_unit, quantity, tidy
from thermobearing.report.content import RESIDUAL_LIMIT, RIG, input_table, limit_checks
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_ASSESSED,
    PASSED,
    TENTATIVE,
    Check,
    not_entered,
)
from thermobearing.results.base import Result

Inputs = Mapping[str, Any]  # a table of a resolved case
IN_NOTE = ("description", "citation", "name", "kind", "poor_fit")
BUILD = ("geometry", "materials", "cells")
RANGES = ("temperature_law", "tested_range")  # that the parameters were identified in
SETTLED = {  # whose defaults depend on the bearing
    "hardening",
    "small_loops",
    "heat_source",
    "lead_ends",
    "clock",
}
DEFAULT = "default of the program"
# Of the input energy: with average acceleration the balance is exact but for rounding; other
# methods have the error of a step (1e-5 in the default hybrid test).
INEXACT = 1e-2


def vertical_table(bearings: Iterable[Inputs]) -> Table:
    """Return the constants and formulas of vertical stiffness and critical load.

    Of layered bearings of a resolved case; bilinear ones have no plan.
    """
    constants = compression_constants()
    shapes = {
        str(table["geometry"]["plan"]["shape"])
        for table in bearings
        if table.get("kind") != "bilinear"
    }
    keys = ["bulk_modulus"] * bool(shapes)
    keys += ["compression_round"] * ("circular" in shapes)
    keys += ["compression_square"] * bool(shapes - {"circular"})
    values = {key: constants[key] for key in keys}
    note = str(constants["formulas"]) if keys else ""
    caption = "Vertical stiffness and critical load of the bearings"
    return input_table(caption, values, compression_sources(), note=note)


def bearing_tables(
    table: Inputs, file_sources: Mapping[str, str] | None = None, *, otherwise: str = "not stated"
) -> dict[str, Table]:
    """Return the tables of a bearing: what it is, its parameters, the range that they hold for.

    `own` are the sources of its file by dotted key, which a resolved case does not hold; numbers
    that have no source and are no default are marked `otherwise`.
    """
    name, values = str(table["name"]), flat(table)
    defaults = {f"cells.{key}": value for key, value in to_table(Cells()).items()}
    defaults["geometry.sealing_plate_thickness"] = "0.0 mm"
    sources = {key: DEFAULT for key, value in defaults.items() if values.get(key) == value}
    bilinear = table.get("kind") == "bilinear"
    library, model = (BILINEAR, BilinearBearing) if bilinear else (BEARINGS, Bearing)
    sources |= library.sources(model, table) | dict(file_sources or {})
    texts = [table[key] for key in ("description", "citation") if table.get(key)]
    note = " ".join(f"{str(text).rstrip('.')}." for text in texts)
    parameter_keys = [key for key in table if key not in (*IN_NOTE, *BUILD, *RANGES)]
    parts = (
        ("geometry", "geometry and materials", BUILD),
        ("parameters", "parameters of the model", parameter_keys),
        ("range", "calibration range of the parameters", RANGES),
    )
    tables = {}
    for key, caption, part_keys in parts:
        if part := {k: v for k, v in table.items() if k in part_keys}:
            text, note = note, ""  # below the first table
            words: dict[str, Any] = {"note": text, "otherwise": otherwise}
            tables[f"{name}.{key}"] = input_table(f"{name}: {caption}", part, sources, **words)
    return tables


def analysis_table(
    analysis: Inputs, defaults: ModelOptions, default_sources: Mapping[str, str] | None = None
) -> Table:
    """Return the options of the model and of the computation; each is a default, or was given.

    `known` are sources of defaults, by dotted key.
    """
    default_values, sources = flat(to_table(defaults)), {}
    for key, value in flat(analysis).items():
        # The bearing decides on the defaults of SETTLED, so any value of these may be one.
        is_default = default_values.get(key, value if key in SETTLED else None) == value
        sources[key] = (default_sources or {}).get(key, DEFAULT) if is_default else "input"
    return input_table("Model and computation", analysis, sources)


def bearing_words(table: Inputs) -> str:
    """Return name, kind, plan, rubber and lead of a bearing in words."""
    if table.get("kind") == "bilinear":
        return f"{table['name']} (bilinear: no temperature, no rate)"

    def _plain(size: Any) -> str:
        return number(float(str(size).split()[0]))

    geometry, lead = table["geometry"], table.get("lead")
    plan = dict(geometry["plan"])
    shape, hole, layers = plan.pop("shape"), plan.pop("hole", None), geometry["rubber_layers"]
    with_hole = "" if hole is None else f" with a hole of {_plain(hole)} mm"
    words = (
        f"{shape} {' x '.join(map(_plain, plan.values()))} mm{with_hole}, {layers} layers of "
        f"{_plain(geometry['rubber_thickness'])} mm rubber"
    )
    if lead:
        cores = "core" if lead["cores"] == 1 else "cores"
        words += f", {lead['cores']} lead {cores} of {_plain(lead['diameter'])} mm"
    return f"{table['name']} ({table['kind']}, {words})"


def undecided() -> str:
    """Return what no test decides of rubber, in a sentence."""
    return str(assumption_texts()["undecided"])


def model_assumptions(
    analysis: Inputs, bearings: Sequence[Inputs], *, plane: bool = False
) -> list[str]:
    """Return what holds for every run with some options and bearings, in sentences.

    `plane`: whether the bearings move in a plane.
    """
    texts = assumption_texts()
    layered = [table for table in bearings if table.get("kind") != "bilinear"]
    names = [str(table["name"]) for table in bearings if table.get("kind") == "bilinear"]
    direction, axial = "plane" if plane else "shear", analysis.get("axial") or "off"
    acting = direction if axial == "off" else f"{direction}_axial"
    sentences = [texts[acting].format(axial=axial)]
    if names:
        sentences.append(texts["bilinear"].format(names=", ".join(names)))
    if not layered:
        return sentences
    model = str(analysis.get("model", "multi-layer"))
    if model != "multi-layer":
        sentences.append(
            texts["blind_model" if model in BLIND else "earlier_model"].format(model=model)
        )
    published = analysis.get("scheme") == "published"
    sentences.append(heat_flow(analysis, layered))
    sentences.append(texts["scheme"]["published" if published else "conservative"])
    sentences.append(texts["heat_source"][analysis.get("heat_source") or "both"])
    if any(table.get("lead") for table in layered):
        ends = "half-space" if published else analysis.get("lead_ends") or "finite-plate"
        clock = analysis.get("clock")
        clock_text = texts["lead_clock"].format(clock=clock) if clock else ""
        sentences.append(texts["lead"].format(ends=texts["lead_ends"][ends], clock=clock_text))
        if model not in BLIND:
            sentences += _lead_strength([table for table in layered if table.get("lead")])
    aged = analysis.get("exposure") or any(table.get("exposure") for table in bearings)
    sentences += _rubber_states(analysis, layered)
    sentences.append(texts["exposure"]["counted" if aged else "absent"])
    hardening_forms = [
        analysis.get("hardening") or t["hysteresis"].get("hardening_form") for t in layered
    ]
    own_laws = sorted({t["hysteresis_law"]["law"] for t in layered if t.get("hysteresis_law")})
    laws = [
        analysis.get("small_loops") or table["hysteresis"].get("small_loops") or "published"
        for table in layered
        if not table.get("hysteresis_law")
    ]
    built_in = built_in_laws()
    sentences += [built_in["monotone"].description] if "monotone" in hardening_forms else []
    sentences += [texts["own_law"].format(names=", ".join(own_laws))] if own_laws else []
    return sentences + [built_in[law].description for law in sorted(set(laws))]


def _lead_strength(bearings: Sequence[Inputs]) -> list[str]:
    """Return how the strength of lead depends on temperature, with and without tests of it."""
    texts, tested_rates, sentences = assumption_texts(), set(), []
    for table in bearings:
        lead = table["lead"]
        stated_rate = lead.get("softening_beyond_tests")
        default_rate = built_in_laws()[SOFTENING_LEAD].value
        beyond = quantity(default_rate if stated_rate is None else stated_rate)
        if (table.get("tested_range") or {}).get("lead_temperature"):
            tested_rates.add(beyond)
            continue
        words = {"name": table["name"], "rate": quantity(lead.get("softening", NO_SOFTENING))}
        words |= {"beyond": beyond, "reference": quantity(lead["reference_temperature"])}
        sentences.append(plain(texts["lead_untested"].format(**words)))
    if tested_rates:
        text = texts["lead_beyond_tests"].format(rates=joined(sorted(tested_rates)))
        sentences.insert(0, text)
    return sentences


def _rubber_states(analysis: Inputs, layered: Sequence[Inputs]) -> list[str]:
    """Return what holds of the excess stiffness of virgin rubber, in sentences."""
    texts, state = assumption_texts()["virgin"], analysis.get("state", {})
    has_scragging = [bool(table.get("scragging")) for table in layered]
    tested = state.get("rubber") == "tested" or (not state and not any(has_scragging))
    if tested:
        return [texts["absent"]]
    sentences = [texts["recovered"].format(**state)] if state.get("rubber") == "recovered" else []
    sentences.append(texts["modelled"])
    return sentences + ([texts["assumed"]] if state and not all(has_scragging) else [])


def residual_rows(
    energy: "pd.DataFrame", analysis: Inputs, *, measured: bool = False
) -> list[tuple[str, float, float, str]]:
    """Return name, largest value, limit and source of the limit of each residual of a balance.

    `measured` is whether the work of the bearing was measured and its heat calculated.
    """
    gaps = analysis["scheme"] == "published" or analysis.get("model") in BLIND
    exact = analysis.get("method", "average-acceleration") == "average-acceleration"
    rows = []
    for name in ("structure", "element", "mechanical", "thermal"):
        if f"{name}_residual" not in energy:
            continue
        limit, source = RESIDUAL_LIMIT, "energy balance"
        if name == "thermal" and gaps:
            limit, source = float("nan"), "no limit: this model has no closed energy balance"
        elif name == "mechanical" and measured:
            limit, source = float("nan"), "no limit: work is measured, heat is calculated"
        elif name == "structure" and not exact:
            limit, source = INEXACT, "this time integration does not conserve energy exactly"
        largest = float(energy[f"{name}_residual"].abs().max())
        rows.append((f"{name} residual", largest, limit, source))
    return rows


def early_end(subject: str, where: str, result: Result) -> list[str]:
    """Return a sentence on a result that is not complete; none for a completed one."""
    if result.outcome == "completed":
        return []
    return [early_sentence(subject, where, result.outcome, result.sentence)]


def early_sentence(subject: str, where: str, outcome: str, meaning: str) -> str:
    """Return a sentence on an outcome and its meaning: an early end, or a limit that was passed."""
    if outcome in PASSED_LIMITS:
        return f"{subject} passed a limit{where} ({outcome.replace('_', ' ')}): {tidy(meaning)}"
    return (
        f"{subject} ended early{where} ({outcome.replace('_', ' ')}); the results are those "
        f"computed up to then: {tidy(meaning)}"
    )


def checks_table(rows: "pd.DataFrame", caption: str = "Checks", note: str = "") -> Table:
    """Return rows of checks (model/checks.py) as a table; a star marks an unverified source."""
    signs = np.where(rows["least"], "\N{GREATER-THAN OR EQUAL TO}", "\N{LESS-THAN OR EQUAL TO}")
    pairs = zip(signs, rows["limit"], strict=True)
    frame = rows.assign(
        what=rows["what"].map(plain),
        limit=[
            f"{sign} {format_number(limit, '.4g')}" if limit == limit else ""
            for sign, limit in pairs
        ],
        unit=[printed_unit(unit)[0] if unit != "1" else "" for unit in rows["unit"]],
        source=rows["source"].map(plain) + np.where(rows["unverified"], "*", ""),
    )
    if "run" in frame:
        frame["run"] = frame["run"].map(plain)
    # The verdict is last: that column stays in sight where a table is broader than the screen.
    heads = {"what": "Check", "part": "Of", "run": "At", "value": "Value", "limit": "Limit"}
    heads |= {"unit": "Unit", "source": "Source of the limit", "verdict": "Verdict"}
    columns = [Quantity(head, name=name) for name, head in heads.items()]
    marked = {"verdict": frame["verdict"].isin([FAILED, NOT_MODELLED]).tolist()}
    if any(marked["verdict"]):
        note = f"{note} Marked: limit exceeded, or outside the model.".strip()
    keys = 1 + ("part" in frame)
    return make_table(frame, columns, caption, keys=keys, marked=marked, note=note, keep_keys=True)


NAMED_PARTS = 3  # that fail a check, in its name
NO_SOFTENING = "0 1/K"  # of a core whose file states none
OF_BEARINGS = "Checks of the bearings"
CHECKS_NOTE = "The largest use of each limit, and where. Compression is positive."
UNCHECKED = " *: not checked against the published text."


def governing_checks(rows: "pd.DataFrame", *, every_part: bool) -> "pd.DataFrame":
    """Return the checks that use most of their limits, or have the largest value without one.

    One of each code, bearing and check, and of each part if `every_part`; `part` has the bearing
    too where there are several. Strains are in %.
    """
    # Checks without a limit have no use: of these the largest value governs, or the smallest one.
    value = rows["value"].where(~rows["least"].astype(bool), -rows["value"])
    size = rows["used"].where(rows["limit"].notna(), value).astype(float).fillna(-np.inf)
    keys = [rows[name] for name in ("code", "bearing", *["part"] * every_part, "what")]
    groups = [values for _, values in size.groupby(keys, sort=False)]
    governing = rows.loc[[values.index[place_of_largest(values)] for values in groups]]
    if not every_part:
        named = [
            _failing_parts(rows.loc[values.index], row)
            for values, row in zip(groups, governing.to_dict("records"), strict=True)
        ]
        governing = governing.assign(part=named)
    strains = governing["what"].str.endswith("strain")
    governing.loc[strains, ["value", "limit"]] *= 100.0
    governing.loc[strains, "unit"] = "%"
    pairs = zip(governing["run"], governing["bearing"], strict=True)
    governing["run"] = [run.removeprefix(f"{bearing}, ") for run, bearing in pairs]
    if governing["bearing"].nunique() > 1:
        parts = zip(governing["part"], governing["bearing"], strict=True)
        governing["part"] = [f"{part} ({name})" if part else name for part, name in parts]
    return governing if governing["part"].any() else governing.drop(columns="part")


def _failing_parts(rows: "pd.DataFrame", governing: Mapping[Any, Any]) -> str:
    """Return the parts that fail the check of a governing row, that of the row first.

    Of a check that does not fail, the part of the row alone.
    """
    failing = rows[~rows["verdict"].isin(list(VERDICTS))]
    first = str(governing["part"])
    if governing["verdict"] in VERDICTS:
        return first
    names = list(dict.fromkeys([first, *map(str, failing["part"])]))
    if len(names) > NAMED_PARTS:
        return f"{first} and {len(names) - 1} more"
    return joined(names)


def bearing_check_tables(result: Result, *, every_part: bool = True) -> dict[str, Table]:
    """Return the governing checks of bearings as tables, one of each code; nothing without any.

    Lines with equal rows share one; without `every_part` there is the governing line only. Checks
    whose limit is not entered are in one sentence below the others.
    """
    rows, tables = result.bearing_checks, {}
    for code in dict.fromkeys(rows["code"]) if len(rows) else ():
        governing = governing_checks(rows[rows["code"] == code], every_part=every_part)
        name = f"checks_{code.split()[0].lower()}" if code else "bearing_checks"
        caption = f"Checks of the bearings according to {code}" if code else OF_BEARINGS
        limited = governing[governing["verdict"] != checks.NO_LIMIT]
        note = f"{CHECKS_NOTE}{UNCHECKED * bool(not code or limited['unverified'].any())}"
        if len(limited):
            unnamed = governing.assign(code="").to_dict("records")
            note = f"{note} {not_entered(sheet_checks(unnamed))}".strip()
            governing = limited
        tables[name] = checks_table(governing, caption, note).merged("part")
    return tables


VERDICTS = {
    checks.NO_LIMIT: NOT_ASSESSED,
    checks.NO_VALUE: NOT_ASSESSED,
    checks.PASSED: PASSED,
    checks.TOO_FEW: TENTATIVE,
}


def limit_name(row: Mapping[Any, Any]) -> str:
    """Return the code and the check of a row; without edition where an office entered the limit.

    >>> limit_name({"code": "AASHTO GSID (2014)", "what": "uplift", "unverified": False})
    'AASHTO GSID: uplift'
    """
    # Limits of codes are verified where an office has entered them, with its own edition.
    code = str(row.get("code") or "")
    code = code if row.get("unverified") else code.partition(" (")[0]
    return f"{code}: {row['what']}" if code else str(row["what"])


def sheet_checks(rows: Iterable[Mapping[Any, Any]]) -> list[Check]:
    """Return rows of checks (model/checks.py) as those of a report; strains in %."""
    report_checks = []
    for row in rows:
        unit, factor = printed_unit(str(row["unit"]))
        if row["what"].endswith("strain") and unit != "%":
            unit, factor = "%", 100.0
        value, limit = (math.nan if row[n] is None else factor * row[n] for n in ("value", "limit"))
        source = f"{plain(row['source'])}{'*' if row.get('unverified') else ''}"
        verdict = VERDICTS.get(row["verdict"], EXCEEDED)
        limited = plain(limit_name(row))
        what = f"{limited}, {row['part']}" if row.get("part") else limited
        lower = bool(row["least"])
        report_checks.append(
            Check(what, value, limit, unit, source, verdict, lower, limited=limited)
        )
    return report_checks


def result_checks(
    result: Result,
    case: Inputs,
    titles: Mapping[str, str],
    source: str,
    names: Sequence[str] = (),
    rows_tested: Iterable[Mapping[Any, Any]] | None = None,
) -> list[Check]:
    """Return the governing checks of bearings, of the rig and of the calibration range.

    `rows_tested` are those of the calibration range, by default of the result.
    """
    tested = result.tested_range.to_dict("records") if rows_tested is None else rows_tested
    rows, rig = result.bearing_checks, str(case.get("rig", {}).get("name", "rig"))
    rows = governing_checks(rows, every_part=False) if len(rows) else rows
    report_checks = sheet_checks(rows.to_dict("records"))
    report_checks += limit_checks(result.rig.to_dict("records"), RIG, f"rig {rig}")
    return report_checks + limit_checks(tested, titles, source, names)
