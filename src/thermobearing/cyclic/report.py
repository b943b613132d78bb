"""Report of a displacement-controlled test."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.cyclic.case import RIGS, Analysis, Rig
from thermobearing.cyclic.output import written_part
from thermobearing.cyclic.report_plots import report_figures
from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.cyclic.result import Result, run_name
from thermobearing.model.earlier import BLIND
from thermobearing.report.content import (
    BOOKS_CLOSE,
    MARKED,
    RIG,
    TESTED_RANGE,
    TESTS,
    beyond_mark,
    input_table,
    limit_checks,
    quality_table,
    verdict,
)
from thermobearing.report.pieces import Check, Column, Pieces, ReportTable
from thermobearing.report.words import (
    change,
    counted,
    degrees,
    identity_rows,
    joined,
    number,
    percent,
    quantity,
    tidy,
)
from thermobearing.results import drawing
from thermobearing.results.ranges import parted, ring_note
from thermobearing.results.time_axis import duration

Step = Mapping[str, Any]
MOST_STEPS = 40  # rows of the table of a test


def words_of_test(test: Mapping[str, Any]) -> str:
    """What was done to the bearing, in a sentence without its end.

    Parameters
    ----------
    test : table of a resolved case.

    Examples
    --------
    >>> cycles = {"step": "cycles", "wave": "sine", "frequency": "0.5 Hz", "count": 11}
    >>> words_of_test({"name": "mine", "steps": [cycles | {"strain": 1.75}]})
    'mine: 11 cycles of 175 % shear strain (sine, 0.5 Hz)'
    """
    steps: Sequence[Step] = test["steps"]
    told = []
    for alike, group in groupby([s for s in steps if s["step"] != "rest"], key=_alike):
        same = list(group)
        told.append(_alike_words(alike, same))
    rests = [step for step in steps if step["step"] == "rest"]
    if rests and told:
        told.append(f"{counted(len(rests), 'rest')} ({_rest_words(rests)})")
    elif rests:
        told.append(f"rest ({_rest_words(rests)})")
    return f"{test.get('name', 'test')}: {joined(told)}"


def _alike(step: Step) -> tuple[str, ...]:
    """What steps have in common that are told together."""
    if step["step"] != "cycles":
        return (str(step["step"]),)
    return ("cycles", str(step["count"]), str(step["wave"]), _timing(step))


def _alike_words(alike: tuple[str, ...], steps: Sequence[Step]) -> str:
    if alike[0] == "cycles":
        sizes = [step.get("strain") for step in steps]
        if all(size is not None for size in sizes):
            shown = joined(f"{100.0 * float(size):g}" for size in sizes if size is not None)
            what = f"{shown} % shear strain"
        else:
            what = joined(_amplitude(step) for step in steps)
        each = " each" if len(steps) > 1 else ""
        count = counted(int(alike[1]), "cycle")
        return f"{count}{each} of {what} ({alike[2]}, {alike[3]})"
    if alike[0] == "ramp":
        return f"{counted(len(steps), 'ramp')} to {joined(_target(step) for step in steps)}"
    names = joined(_recording(step) for step in steps)
    return f"the recorded displacement of {names}"


def _timing(step: Step) -> str:
    for key, what in (("speed", "mean speed "), ("period", "period "), ("frequency", "")):
        if step.get(key) is not None:
            return f"{what}{quantity(step[key])}"
    return ""


def _amplitude(step: Step) -> str:
    if step.get("strain") is not None:
        return percent(float(step["strain"]))
    return quantity(step["amplitude"])


def _target(step: Step) -> str:
    if step.get("to_strain") is not None:
        return percent(float(step["to_strain"]))
    return quantity(step["to"])


def _recording(step: Step) -> str:
    return Path(str(step["file"])).name if step.get("file") else "a history given in Python"


def _rest_words(rests: Sequence[Step]) -> str:
    lasts = []
    for step in rests:
        if step.get("duration") is not None:
            lasts.append(duration(float(str(step["duration"]).split()[0])))
        else:
            lasts.append(f"until within {quantity(step['within'])} of the air")
    return joined(dict.fromkeys(lasts), "or")


def _table_of_test(test: Mapping[str, Any]) -> ReportTable:
    """The steps of a test, one row each."""
    columns = (
        Column("Step", form="d"),
        Column("What"),
        Column("Size"),
        Column("Course"),
        Column("Cycles", form="d"),
        Column("Closing cycle"),
    )
    rows: list[tuple[Any, ...]] = []
    for place, step in enumerate(test["steps"][:MOST_STEPS], 1):
        kind = str(step["step"])
        closing = step.get("closing_strain")
        if kind == "cycles":
            course = f"{step['wave']}, {_timing(step)}"
            end = percent(float(closing)) if closing is not None else "none"
            rows.append((place, kind, _amplitude(step), course, int(step["count"]), end))
        elif kind == "ramp":
            course = quantity(step.get("speed") or step["duration"])
            rows.append((place, kind, _target(step), course, None, ""))
        elif kind == "rest":
            rows.append((place, kind, "", _rest_words([step]), None, ""))
        else:
            rows.append((place, kind, "", _recording(step), None, ""))
    left = len(test["steps"]) - len(rows)
    note = f"Largest time step {quantity(test['dt'])}. Sizes are shear strains of the total rubber "
    note += "thickness, or displacements."
    if left:
        note += f" {counted(left, 'more step')}: see case.resolved.toml."
    return ReportTable(f"Test: {test.get('name', 'test')}", columns, rows, note=note)


KJ = 1e-3
MOST_ROWS = 60
AMBIENT = Column("Ambient", "°C", "g")


def _shown_cycles(cycles: pd.DataFrame) -> pd.DataFrame:
    """First and last cycle of each amplitude of each run; every one of a short record."""
    if not len(cycles):
        return cycles
    group = _block(cycles)
    first = group != group.shift()
    last = group != group.shift(-1)
    chosen = cycles[first | last]
    return cycles if len(cycles) <= MOST_ROWS // 3 else chosen.head(MOST_ROWS)


def _block(cycles: pd.DataFrame) -> pd.Series:
    """A number for each loading: cycles of one run that follow each other."""
    new = (cycles["cycle"].diff() != 1) | (cycles["ambient_degC"].diff() != 0)
    return new.cumsum()


def cycles_table(result: Result) -> ReportTable:
    """Measures of the first and the last cycle of each amplitude."""
    cycles, ranges = _shown_cycles(result.cycles), result.tested_range.to_dict("records")
    stress = result.dataset.attrs["area_mm2"] / 1e3
    inner, names = inner_layer(result), list(result.cycles.columns)
    heat: list[tuple[Column, str]] = []
    if inner in names:
        heat.append((Column("Inner rubber", "°C", ".1f"), inner))
    if "lead_degC" in names:
        heat.append((Column("Lead", "°C", ".1f"), "lead_degC"))
    columns = [
        AMBIENT,
        Column("Strain", "%", ".0f"),
        Column("Cycle", form="d"),
        Column("G_e", "MPa", ".3f"),
        Column("K_eq", "kN/mm", ".3f"),
        Column("h_eq", "", ".3f"),
        Column("Energy", "kJ", ".2f"),
        Column("Peak force", "kN", ".0f"),
        Column("Q_d", "kN", ".1f"),
        Column("K_d", "kN/mm", ".3f"),
        *(column for column, _ in heat),
    ]
    rows: list[tuple[Any, ...]] = []
    marked: set[tuple[int, int]] = set()
    for row in cycles.to_dict("records"):
        run, place = run_name(float(row["ambient_degC"])), len(rows)
        rows.append(
            (
                float(row["ambient_degC"]),
                100.0 * row["amplitude_strain"],
                int(row["cycle"]),
                row["G_eq_MPa"],
                row["K_eq_kN_mm"],
                row["h_eq"],
                KJ * row["energy_kN_mm"],
                stress * max(row["stress_max_MPa"], -row["stress_min_MPa"]),
                row["characteristic_strength_kN"],
                row["post_yield_stiffness_kN_mm"],
                *(float(row[name]) for _, name in heat),
            )
        )
        asked = {
            0: ("ambient", row["ambient_degC"]),
            1: ("strain", row["amplitude_strain"]),
            2: ("cycles", row["cycle"]),
            10 + len(heat) - 1: ("lead_temperature", row.get("lead_degC", math.nan)),
        }
        marked |= {
            (place, column)
            for column, (limit, value) in asked.items()
            if value == value and beyond_mark(ranges, run, limit, float(value))
        }
    of = "each cycle" if len(cycles) == len(result.cycles) else "first and last cycle"
    note = "G_e: equivalent shear modulus (Eq. 3.1); h_eq: equivalent damping ratio (Eq. 3.2); "
    note += "Q_d, K_d: characteristic strength and post-yield stiffness of the bearing; "
    note += "temperatures at the end of the cycle."
    note += f" {MARKED}." if marked else ""
    caption = f"Measures of {of} of each amplitude" if of != "each cycle" else f"Measures of {of}"
    return ReportTable(caption, columns, rows, 3, frozenset(marked), note)


def inner_layer(result: Result) -> str:
    """Column of `Result.cycles` of the layer that gets warmest by its place."""
    layers = int(result.dataset.sizes.get("layer", 1))
    half = bool(result.dataset.attrs["half_stack"])
    return f"rubber{layers if half else layers // 2 + 1}_degC"


def cold_table(result: Result) -> ReportTable | None:
    """Last cycle of each amplitude over that at the warmest ambient; None with one temperature."""
    cycles = result.cycles
    if not len(cycles) or cycles["ambient_degC"].nunique() < 2:
        return None
    last = cycles[_block(cycles) != _block(cycles).shift(-1)]
    warmest = float(last["ambient_degC"].max())
    names = {
        "G_eq_MPa": Column("G_e ratio", "", ".2f"),
        "h_eq": Column("h_eq ratio", "", ".2f"),
        "energy_kN_mm": Column("Energy ratio", "", ".2f"),
        "characteristic_strength_kN": Column("Q_d ratio", "", ".2f"),
    }
    rows = []
    warm = last[last["ambient_degC"] == warmest].reset_index(drop=True)
    for ambient in sorted(set(last["ambient_degC"]) - {warmest}):
        mine = last[last["ambient_degC"] == ambient].reset_index(drop=True)
        for k in range(min(len(mine), len(warm))):
            if mine["cycle"][k] != warm["cycle"][k]:  # a run that ended early
                continue
            share = [float(mine[name][k] / warm[name][k]) for name in names]
            strain = 100.0 * float(mine["amplitude_strain"][k])
            rows.append((float(ambient), strain, int(mine["cycle"][k]), *share))
    if not rows:
        return None
    columns = [AMBIENT, Column("Strain", "%", ".0f"), Column("Cycle", form="d"), *names.values()]
    caption = f"The cold: last cycle of each amplitude over that at {warmest:g} °C"
    return ReportTable(caption.replace("-", "\N{MINUS SIGN}"), columns, rows, 3)


def _warming_table(result: Result) -> ReportTable | None:
    """Largest rise of each rubber layer and of the lead over the start, a row per temperature."""
    data = result.dataset
    if "rubber_temperature" not in data:
        return None
    names = drawing.layer_names(data.sizes["layer"], bool(data.attrs["half_stack"]))
    places = [0, len(names) - 1] if len(names) > 3 else list(range(len(names)))
    columns = [AMBIENT]
    for place in places:
        columns += [Column(f"{names[place]}: highest", "°C", ".1f"), Column("rise", "K", ".1f")]
    if result.has_lead:
        columns += [Column("lead: highest", "°C", ".1f"), Column("rise", "K", ".1f")]
    rows = []
    for run, ambient in enumerate(data["ambient"].values):
        told = data["segment"].values[run] >= 0
        histories = [data["rubber_temperature"].values[run, told, place] for place in places]
        if result.has_lead:
            histories.append(data["lead_temperature"].values[run, told])
        values: list[Any] = [float(ambient)]
        for history in histories:
            values += [float(history.max()), float(history.max() - history[0])]
        rows.append(tuple(values))
    return ReportTable("Warming during the test", columns, rows)


def books_table(result: Result) -> ReportTable:
    """Energy books at the end of each run."""
    columns = [
        AMBIENT,
        Column("Work in", "kJ", ".2f"),
        Column("Heat released", "kJ", ".2f"),
        Column("Recoverable", "kJ", ".3f"),
        Column("Heat stored", "kJ", ".2f"),
        Column("Heat lost, ends", "kJ", ".2f"),
        Column("Heat lost, sides", "kJ", ".2f"),
        Column("Residual, mechanical", "", ".1e"),
        Column("Residual, thermal", "", ".1e"),
    ]
    names = ["work_in", "heat_released", "recoverable", "heat_stored", "heat_lost_ends"]
    names.append("heat_lost_sides")
    rows = [
        (
            row["ambient_degC"],
            *(KJ * row[f"{name}_kN_mm"] for name in names),
            row["mechanical_residual"],
            row["thermal_residual"],
        )
        for row in result.energy.to_dict("records")
    ]
    note = "Work in = heat released + recoverable; heat released = stored + lost. Residuals are "
    note += "relative to the largest of these energies."
    return ReportTable("Energy books at the end of each run", columns, rows, note=note)


def peaks(result: Result, run: int) -> tuple[float, float]:
    """Largest |force| [kN] and |strain| of a run."""
    force, strain = (result[name].values[run] for name in ("force", "strain"))
    return float(np.nanmax(np.abs(force))), float(np.nanmax(np.abs(strain)))


Case = Mapping[str, Any]


def build_pieces(result: Result) -> Pieces:
    """Everything that the document of a cyclic test says.

    Parameters
    ----------
    result : of a run, or loaded again: both give the same.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> pieces = build_pieces(tb.run("shen-hdr-specimen", test, ambient=[-20, 23]))
    >>> pieces.tables["cycles"].caption
    'Measures of each cycle'
    """
    result = written_part(result)
    case = tomllib.loads(result.dataset.attrs["case"])
    validity, warnings = parted(result.warnings)
    given = case["bearing"].get("tested_range") is not None
    checks = report_checks(result, case)
    quality, poor = quality_of(result, case)
    lead = result["lead_temperature"].values if result.has_lead else np.zeros((1, 1))
    ring = ring_note(float(np.nanmax(lead - lead[:, :1])))
    within = [tidy(text) for text in validity] if given else []
    unknown = "" if given else " ".join(map(tidy, validity))
    return Pieces(
        command="cyclic",
        title=f"Cyclic test of {result.bearing_name}",
        question=question(result, case),
        answer=answer(result, verdict(checks, within, unknown)),
        inputs=input_tables(result, case),
        tables=report_tables_by_name(result) | {"quality": quality},
        figures=report_figures(result),
        checks=checks,
        validity=within,
        notes=[tidy(f"{ring[:1].upper()}{ring[1:]}")] if ring else [],
        validity_unknown=unknown,
        books=books_table(result),
        assumptions=[*_start(case), *model_assumptions(case["analysis"], [case["bearing"]])],
        warnings=[*poor, *(tidy(text) for text in warnings)],
        identity=identity_rows(
            str(result.dataset.attrs["version"]),
            str(result.dataset.attrs["case"]),
            "thermobearing cyclic case.resolved.toml",
        ),
    )


def question(result: Result, case: Case) -> str:
    """What was asked: bearing, test, temperatures."""
    air = f"ambient {degrees(result['ambient'].values.tolist())}"
    if case.get("ambient_series"):
        air = f"the air of {case['ambient_series']}"
    return (
        f"How stiff is the bearing {bearing_words(case['bearing'])}, how much energy does it take "
        f"and how warm does it get, at {air}, in this displacement-controlled test? "
        f"{words_of_test(case['test'])}."
    )


def answer(result: Result, told: str) -> list[str]:
    """What came out: what governs, what cold and warming change, whether limits were kept."""
    early = early_words(result)
    if not len(result.cycles):
        return [*early, _without_cycles(result), told]
    return [*early, _governing(result), _cold_and_warming(result), told]


def early_words(result: Result) -> list[str]:
    """That the analysis ended early, where and why; nothing if it did not."""
    if result.outcome == "completed":
        return []
    outcomes = [str(name) for name in result["outcome"].values]
    places = zip(result["ambient"].values, outcomes, strict=True)
    where = degrees([float(air) for air, name in places if name != "completed"])
    return [
        f"The analysis ended early at {where} ({result.outcome.replace('_', ' ')}), and what "
        f"follows is what had been computed until then: {tidy(result.sentence)}"
    ]


def _governing(result: Result) -> str:
    """Stiffness and force in the last cycle of the largest amplitude."""
    cycles = result.cycles
    largest = float(cycles["amplitude_strain"].max())
    rows = cycles[cycles["amplitude_strain"] >= 0.999 * largest]
    last = rows.groupby("ambient_degC", sort=False).last().reset_index()
    told = [
        f"{row['G_eq_MPa']:.3f} MPa at {degrees([row['ambient_degC']])} (h_eq {row['h_eq']:.3f}, "
        f"{KJ * row['energy_kN_mm']:.2f} kJ a cycle)"
        for row in last.to_dict("records")
    ]
    forces = [peaks(result, run)[0] for run in range(len(result["ambient"]))]
    governs = forces.index(max(forces))
    air = degrees([float(result["ambient"].values[governs])])
    return (
        f"At {percent(largest)} shear strain the equivalent shear modulus G_e of the last cycle is "
        f"{joined(told)}; the largest force is {number(forces[governs], '.4g')} kN, at {air}."
    )


def _cold_and_warming(result: Result) -> str:
    """What the cold changes at the largest amplitude, and what the test's own heat does."""
    cycles = result.cycles
    largest = cycles["amplitude_strain"].max()
    rows = cycles[cycles["amplitude_strain"] >= 0.999 * largest]
    last = rows.groupby("ambient_degC").last()
    told = []
    if len(last) > 1:
        cold, warm = last.index.min(), last.index.max()
        stiffer = float(last["G_eq_MPa"][cold] / last["G_eq_MPa"][warm])
        energy = float(last["energy_kN_mm"][cold] / last["energy_kN_mm"][warm])
        told.append(
            f"There, {degrees([cold])} against {degrees([warm])} makes the modulus "
            f"{change(stiffer, 'higher', 'lower')} and the energy of a cycle {change(energy)}"
        )
    warming = _warmest(result)
    first = rows.groupby("ambient_degC").first()
    softer = (last["G_eq_MPa"] / first["G_eq_MPa"]).min()
    heated = f"the test itself warms {warming}" if warming else ""
    if (last["cycle"] > first["cycle"]).any():
        air = degrees([float((last["G_eq_MPa"] / first["G_eq_MPa"]).idxmin())])
        fall = change(float(softer), "higher", "lower")
        heated += f"{', and ' if heated else ''}the modulus of the last cycle of that strain is "
        heated += f"{fall} than that of its first ({air})"
    told += [heated] if heated else []
    sentence = "; ".join(told)
    return f"{sentence[:1].upper()}{sentence[1:]}." if sentence else "One cycle at one temperature."


def _warmest(result: Result) -> str:
    """The largest rises, in words."""
    table = _warming_table(result)
    if table is None:
        return ""
    rises = [column for column, head in enumerate(table.columns) if head.head == "rise"]
    told = []
    for name, place in (("rubber", rises[:-1] if result.has_lead else rises), ("lead", rises[-1:])):
        if name == "lead" and not result.has_lead:
            continue
        value, air = max((float(row[c]), float(row[0])) for row in table.rows for c in place)
        told.append(f"the {name} by up to {value:.1f} K ({degrees([air])})")
    return joined(told)


def _without_cycles(result: Result) -> str:
    """Of a test that closes no cycle."""
    told = []
    for run, ambient in enumerate(result["ambient"].values):
        force, strain = peaks(result, run)
        told.append(f"{number(force, '.4g')} kN at {percent(strain)} ({degrees([float(ambient)])})")
    warming = _warmest(result)
    more = f"; the test warms {warming}" if warming else ""
    return f"No cycle was closed; the largest force and shear strain are {joined(told)}{more}."


def report_tables_by_name(result: Result) -> dict[str, ReportTable]:
    """Tables of what came out, by name."""
    found = {
        "cycles": cycles_table(result) if len(result.cycles) else None,
        "cold": cold_table(result),
        "warming": _warming_table(result),
    }
    return {name: table for name, table in found.items() if table is not None}


def input_tables(result: Result, case: Case) -> dict[str, ReportTable]:
    """Tables of what went in: test, bearing, air, rig, model."""
    sources = case.get("sources", {}).get(result.bearing_name)
    found = {"test": _table_of_test(case["test"]), **bearing_tables(case["bearing"], sources)}
    air = {key: case[key] for key in ("ambient", "ambient_series", *STARTS) if key in case}
    found["air"] = input_table("Temperatures", air, otherwise="as asked for")
    if "rig" in case:
        found["rig"] = rig_table(case["rig"], case.get("sources", {}).get(case["rig"].get("name")))
    found["analysis"] = analysis_table(case["analysis"], Analysis())
    return found


def rig_table(rig: Mapping[str, Any], own: Mapping[str, str] | None = None) -> ReportTable:
    """Limits of a rig of a resolved case.

    Parameters
    ----------
    rig : its table.
    own : sources of its file, by key.
    """
    limits = {key: rig[key] for key in RIG if key in rig}
    about = [str(rig[key]).rstrip(".") for key in ("description", "citation") if rig.get(key)]
    note = ". ".join(about) + "." if about else ""
    told = {f"rig.{key}": text for key, text in (RIGS.sources(Rig, rig) | dict(own or {})).items()}
    title = f"Rig: {rig.get('name', 'rig')}"
    return input_table(title, {"rig": limits}, told, otherwise="not stated", note=note)


STARTS = ("initial", "initial_lead")


def _start(case: Case) -> list[str]:
    """How the bearing begins, and the air."""
    if "initial_state" in case:
        begins = "The bearing begins where an earlier test left it, with temperatures and memory."
    elif "initial_profile" in case:
        begins = "The bearing begins with a given temperature in each cell."
    elif "initial" in case:
        begins = f"The bearing begins at {quantity(case['initial'])} throughout."
    else:
        begins = "The bearing begins at the temperature of the air throughout."
    series = "ambient_series" in case
    air = "The air follows the series." if series else "The air keeps its temperature."
    return [f"{begins} {air}", "Displacements are imposed exactly; inertia plays no part."]


def report_checks(result: Result, case: Case) -> list[Check]:
    """Return the checks: what was asked of the rig and beyond the tests."""
    bearing = result.bearing_name
    rig = str(case.get("rig", {}).get("name", "rig"))
    found = limit_checks(result.rig.to_dict("records"), RIG, f"rig {rig}")
    tested = result.tested_range.to_dict("records")
    return found + limit_checks(tested, TESTS, f"{TESTED_RANGE} of {bearing}")


def quality_of(result: Result, case: Case) -> tuple[ReportTable, list[str]]:
    """Return the largest residuals of the energy balance, and warnings of those too large."""
    found = []
    analysis = case["analysis"]
    gaps = analysis["scheme"] == "published" or analysis["model"] in BLIND
    for name in ("mechanical", "thermal"):
        values = result.energy[f"{name}_residual"].abs()
        limit = float("nan") if gaps and name == "thermal" else BOOKS_CLOSE
        source = "energy balance" if limit == limit else "no limit: this model's books have gaps"
        found.append((f"{name} residual", float(values.max()), limit, source))
    return quality_table(found)
