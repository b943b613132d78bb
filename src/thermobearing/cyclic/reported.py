"""Tables of bearings and of the model, and the assumptions of the model, for all reports."""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from thermobearing.bearing.bilinear import BILINEAR, BilinearBearing
from thermobearing.bearing.library import BEARINGS
from thermobearing.bearing.model import Bearing, Cells
from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path
from thermobearing.border.toml import flat, read_toml, to_table
from thermobearing.laws import built_in_laws
from thermobearing.model import checks
from thermobearing.model.constants import SOFTENING_LEAD
from thermobearing.model.earlier import BLIND
from thermobearing.model.options import ModelOptions
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report.content import BOOKS_CLOSE, RIG, input_table, limit_checks
from thermobearing.report.pieces import EXCEEDED, NOT_ASSESSED, PASSED, Check
from thermobearing.report.words import joined, number, plain, printed_unit, quantity, tidy
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


@cache
def _sentences() -> Mapping[str, Any]:
    return read_toml(data_path("reports", "assumptions.toml"))


def bearing_tables(
    table: Inputs, own: Mapping[str, str] | None = None, *, otherwise: str = "not stated"
) -> dict[str, Table]:
    """Return the tables of a bearing: what it is, its parameters, the range that they hold for.

    `own` are the sources of its file by dotted key, which a resolved case does not hold; numbers
    that have no source and are no default are marked `otherwise`.
    """
    name, given = str(table["name"]), flat(table)
    usual = {f"cells.{key}": value for key, value in to_table(Cells()).items()}
    usual["geometry.sealing_plate_thickness"] = "0.0 mm"
    sources = {key: DEFAULT for key, value in usual.items() if given.get(key) == value}
    bilinear = table.get("kind") == "bilinear"
    library, model = (BILINEAR, BilinearBearing) if bilinear else (BEARINGS, Bearing)
    sources |= library.sources(model, table) | dict(own or {})
    note = " ".join(f"{str(table[k]).rstrip('.')}." for k in IN_NOTE[:2] if table.get(k))
    rest = [key for key in table if key not in (*IN_NOTE, *BUILD, *RANGES)]
    parts = (
        ("geometry", "geometry and materials", BUILD),
        ("parameters", "parameters of the model", rest),
        ("range", "calibration range of the parameters", RANGES),
    )
    found = {}
    for key, caption, held in parts:
        if part := {k: v for k, v in table.items() if k in held}:
            text, note = note, ""  # below the first table
            words: dict[str, Any] = {"note": text, "otherwise": otherwise}
            found[f"{name}.{key}"] = input_table(f"{name}: {caption}", part, sources, **words)
    return found


def analysis_table(
    analysis: Inputs, defaults: ModelOptions, known: Mapping[str, str] | None = None
) -> Table:
    """Return the options of the model and of the computation; each is a default, or was given.

    `known` are sources of defaults, by dotted key.
    """
    usual, sources = flat(to_table(defaults)), {}
    for key, value in flat(analysis).items():
        is_default = usual.get(key, value if key in SETTLED else None) == value
        sources[key] = (known or {}).get(key, DEFAULT) if is_default else "input"
    return input_table("Model and computation", analysis, sources)


def bearing_words(table: Inputs) -> str:
    """Return name, kind, plan, rubber and lead of a bearing in words."""
    if table.get("kind") == "bilinear":
        return f"{table['name']} (bilinear: no temperature, no rate)"

    def _plain(size: Any) -> str:
        return number(float(str(size).split()[0]))

    geometry, lead = table["geometry"], table.get("lead")
    plan = dict(geometry["plan"])
    shape, layers = plan.pop("shape"), geometry["rubber_layers"]
    words = f"{shape} {' x '.join(map(_plain, plan.values()))} mm, {layers} layers of "
    words += f"{_plain(geometry['rubber_thickness'])} mm rubber"
    if lead:
        cores = "core" if lead["cores"] == 1 else "cores"
        words += f", {lead['cores']} lead {cores} of {_plain(lead['diameter'])} mm"
    return f"{table['name']} ({table['kind']}, {words})"


def model_assumptions(
    analysis: Inputs, bearings: Sequence[Inputs], *, plane: bool = False
) -> list[str]:
    """Return what holds for every run with some options and bearings, in sentences.

    `plane`: whether the bearings move in a plane.
    """
    said = _sentences()
    layered = [table for table in bearings if table.get("kind") != "bilinear"]
    names = [str(table["name"]) for table in bearings if table.get("kind") == "bilinear"]
    found = [said["plane" if plane else "shear"]]
    if names:
        found.append(said["bilinear"].format(names=", ".join(names)))
    if not layered:
        return found
    model = str(analysis.get("model", "multi-layer"))
    if model != "multi-layer":
        found.append(said["blind_model" if model in BLIND else "earlier_model"].format(model=model))
    published = analysis.get("scheme") == "published"
    found.append(heat_flow(analysis, layered))
    found.append(said["scheme"]["published" if published else "conservative"])
    found.append(said["heat_source"][analysis.get("heat_source") or "both"])
    if any(table.get("lead") for table in layered):
        ends = "half-space" if published else analysis.get("lead_ends") or "finite-plate"
        clock = analysis.get("clock")
        timed = said["lead_clock"].format(clock=clock) if clock else ""
        found.append(said["lead"].format(ends=said["lead_ends"][ends], clock=timed))
        if model not in BLIND:
            usual = built_in_laws()[SOFTENING_LEAD].value
            cores = [table["lead"] for table in layered if table.get("lead")]
            stated = [core.get("softening_beyond_tests") for core in cores]
            rates = sorted({quantity(usual if rate is None else rate) for rate in stated})
            found.append(said["lead_beyond_tests"].format(rates=joined(rates)))
    virgin = any(table.get("scragging") for table in layered)
    aged = analysis.get("exposure") or any(table.get("exposure") for table in bearings)
    found.append(said["virgin"]["modelled" if virgin else "absent"])
    found.append(said["exposure"]["counted" if aged else "absent"])
    forms = [analysis.get("hardening") or t["hysteresis"].get("hardening_form") for t in layered]
    named = sorted({t["hysteresis_law"]["law"] for t in layered if t.get("hysteresis_law")})
    laws = [
        analysis.get("small_loops") or table["hysteresis"].get("small_loops") or "published"
        for table in layered
        if not table.get("hysteresis_law")
    ]
    known = built_in_laws()
    found += [known["monotone"].description] if "monotone" in forms else []
    found += [said["own_law"].format(names=", ".join(named))] if named else []
    return found + [known[law].description for law in sorted(set(laws))]


def heat_flow(analysis: Inputs, bearings: Sequence[Inputs]) -> str:
    """Return how heat flows through bearings and out of them, in a sentence."""
    said = _sentences()
    films = {str(table["materials"].get("side_film", "0.0 W/(m^2 K)")) for table in bearings}
    values = sorted(float(film.split()[0]) for film in films)
    sides = said["side_film"].format(film=" or ".join(number(v) for v in values))
    if values == [0.0]:
        sides = said["no_sides"]
    if side := analysis.get("side"):
        cover = quantity(side.get("cover", "0 mm"))
        sides = said["side_cover"].format(film=quantity(side["film"]), cover=cover)
    faces = []
    for name in ("upper", "lower"):
        face = analysis.get(f"{name}_face", {"eta": 2.0})
        if "eta" in face:
            faces.append(f"{name} η_B = {face['eta']:g} (1 adiabatic, 3 at ambient)")
        else:
            behind = face.get("heat_capacity")
            more = f" beyond {quantity(behind)}" if behind else ""
            faces.append(f"{name} film {quantity(face['film'])}{more}")
    text: str = said["heat_flow"].format(sides=sides, faces=", ".join(faces))
    return text


def residual_rows(
    energy: "pd.DataFrame", analysis: Inputs, *, measured: bool = False
) -> list[tuple[str, float, float, str]]:
    """Return name, largest value, limit and source of the limit of each residual of a balance.

    `measured` is whether the work of the bearing was measured and its heat calculated.
    """
    gaps = analysis["scheme"] == "published" or analysis.get("model") in BLIND
    exact = analysis.get("method", "average-acceleration") == "average-acceleration"
    found = []
    for name in ("structure", "mechanical", "thermal"):
        if f"{name}_residual" not in energy:
            continue
        limit, source = BOOKS_CLOSE, "energy balance"
        if name == "thermal" and gaps:
            limit, source = float("nan"), "no limit: this model has no closed energy balance"
        elif name == "mechanical" and measured:
            limit, source = float("nan"), "no limit: work is measured, heat is calculated"
        elif name == "structure" and not exact:
            limit, source = INEXACT, "this time integration does not conserve energy exactly"
        largest = float(energy[f"{name}_residual"].abs().max())
        found.append((f"{name} residual", largest, limit, source))
    return found


def early_end(subject: str, where: str, result: Result) -> list[str]:
    """Return a sentence on a result that is not complete; none for a completed one."""
    if result.outcome == "completed":
        return []
    return [early_sentence(subject, where, result.outcome, result.sentence)]


def early_sentence(subject: str, where: str, outcome: str, meaning: str) -> str:
    """Return a sentence on an early end with its outcome and the meaning of that."""
    return (
        f"{subject} ended early{where} ({outcome.replace('_', ' ')}); the results are those "
        f"computed up to then: {tidy(meaning)}"
    )


def checks_table(rows: "pd.DataFrame", caption: str = "Checks", note: str = "") -> Table:
    """Return rows of checks (model/checks.py) as a table; a star marks an unverified source."""
    signs = np.where(rows["least"], "\N{GREATER-THAN OR EQUAL TO}", "\N{LESS-THAN OR EQUAL TO}")
    pairs = zip(signs, rows["limit"], strict=True)
    frame = rows.assign(
        limit=[f"{sign} {limit:g}" if limit == limit else "" for sign, limit in pairs],
        unit=rows["unit"].replace("1", ""),
        source=rows["source"].map(plain) + np.where(rows["unverified"], "*", ""),
    )
    if "run" in frame:
        frame["run"] = frame["run"].map(plain)
    heads = {"what": "Check", "part": "Of", "value": "Value", "limit": "Limit", "unit": "Unit"}
    heads |= {"verdict": "Verdict", "source": "Source of the limit", "run": "At"}
    columns = [Quantity(head, name=name) for name, head in heads.items()]
    marked = {"verdict": frame["verdict"].isin([checks.FAILED, checks.NOT_MODELLED]).tolist()}
    keys = 1 + ("part" in frame)
    return make_table(frame, columns, caption, keys=keys, marked=marked, note=note, keep_keys=True)


OF_BEARINGS = "Checks of the bearings"
CHECKS_NOTE = (
    "The largest use of each limit, and where. Compression is positive. *: not checked against the "
    "published text."
)


def governing_checks(rows: "pd.DataFrame", *, every_part: bool) -> "pd.DataFrame":
    """Return the checks that use most of their limits, or have the largest value without one.

    One of each code, bearing and check, and of each part if `every_part`; `part` has the bearing
    too where there are several. Strains are in %.
    """
    size = rows["used"].where(rows["limit"].notna(), rows["value"]).astype(float).fillna(-np.inf)
    keys = [rows[name] for name in ("code", "bearing", *["part"] * every_part, "what")]
    groups = [values for _, values in size.groupby(keys, sort=False)]
    governing = rows.loc[[values.index[place_of_largest(values)] for values in groups]]
    strains = governing["what"].str.endswith("strain")
    governing.loc[strains, ["value", "limit"]] *= 100.0
    governing.loc[strains, "unit"] = "%"
    pairs = zip(governing["run"], governing["bearing"], strict=True)
    governing["run"] = [run.removeprefix(f"{bearing}, ") for run, bearing in pairs]
    names = ["bearing", "part"] if governing["bearing"].nunique() > 1 else ["part"]
    parts = governing[names]
    governing["part"] = [", ".join(filter(None, row)) for row in parts.itertuples(index=False)]
    return governing if governing["part"].any() else governing.drop(columns="part")


def bearing_check_tables(result: Result, *, every_part: bool = True) -> dict[str, Table]:
    """Return the governing checks of bearings as tables, one of each code; nothing without any.

    Lines with equal rows share one; without `every_part` there is the governing line only.
    """
    rows, found = result.bearing_checks, {}
    for code in dict.fromkeys(rows["code"]) if len(rows) else ():
        mine = governing_checks(rows[rows["code"] == code], every_part=every_part)
        name = f"checks_{code.split()[0].lower()}" if code else "bearing_checks"
        caption = f"Checks of the bearings according to {code}" if code else OF_BEARINGS
        found[name] = checks_table(mine, caption, CHECKS_NOTE).merged("part")
    return found


VERDICTS = dict.fromkeys((checks.NO_LIMIT, checks.NO_VALUE), NOT_ASSESSED) | {checks.PASSED: PASSED}


def sheet_checks(rows: Iterable[Mapping[Any, Any]]) -> list[Check]:
    """Return rows of checks (model/checks.py) as those of a report; strains in %."""
    found = []
    for one in rows:
        unit, factor = printed_unit(str(one["unit"]))
        if one["what"].endswith("strain") and unit != "%":
            unit, factor = "%", 100.0
        value, limit = (math.nan if one[n] is None else factor * one[n] for n in ("value", "limit"))
        source = f"{plain(one['source'])}{'*' if one.get('unverified') else ''}"
        verdict = VERDICTS.get(one["verdict"], EXCEEDED)
        what = f"{one['what']}, {one['part']}" if one.get("part") else one["what"]
        what = f"{one['code']}: {what}" if one.get("code") else what
        found.append(Check(what, value, limit, unit, source, verdict, bool(one["least"])))
    return found


def result_checks(
    result: Result, case: Inputs, titles: Mapping[str, str], source: str, names: Sequence[str] = ()
) -> list[Check]:
    """Return the governing checks of bearings, of the rig and of the calibration range."""
    rows, rig = result.bearing_checks, str(case.get("rig", {}).get("name", "rig"))
    rows = governing_checks(rows, every_part=False) if len(rows) else rows
    found = sheet_checks(rows.to_dict("records"))
    found += limit_checks(result.rig.to_dict("records"), RIG, f"rig {rig}")
    return found + limit_checks(result.tested_range.to_dict("records"), titles, source, names)
