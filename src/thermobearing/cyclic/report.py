"""What the document of a cyclic test says, from a result as it is loaded again."""

import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.cyclic.case import Analysis
from thermobearing.cyclic.files import written_part
from thermobearing.cyclic.report_plots import figures_of
from thermobearing.cyclic.report_steps import table_of_test, words_of_test
from thermobearing.cyclic.report_tables import (
    KJ,
    books_table,
    cold_table,
    cycles_table,
    peaks,
    warming_table,
)
from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.rig import RIGS, Rig
from thermobearing.model.earlier import BLIND
from thermobearing.report.identity import identity_of
from thermobearing.report.inputs import input_table
from thermobearing.report.limits import (
    BOOKS_CLOSE,
    RIG,
    TESTED_RANGE,
    TESTS,
    limit_checks,
    quality_table,
    verdict,
)
from thermobearing.report.pieces import Check, Pieces, ReportTable
from thermobearing.report.words import change, degrees, joined, number, percent, quantity, tidy
from thermobearing.results.ranges import parted, ring_note

Case = Mapping[str, Any]


def pieces_of(result: Result) -> Pieces:
    """Everything that the document of a cyclic test says.

    Parameters
    ----------
    result : of a run, or loaded again: both give the same.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> pieces = pieces_of(tb.run("shen-hdr-specimen", test, ambient=[-20, 23]))
    >>> pieces.tables["cycles"].caption
    'Measures of each cycle'
    """
    result = written_part(result)
    case = tomllib.loads(result.dataset.attrs["case"])
    validity, warnings = parted(result.warnings)
    given = case["bearing"].get("tested_range") is not None
    checks = checks_of(result, case)
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
        inputs=inputs_of(result, case),
        tables=tables_of(result) | {"quality": quality},
        figures=figures_of(result),
        checks=checks,
        validity=within,
        notes=[tidy(f"{ring[:1].upper()}{ring[1:]}")] if ring else [],
        validity_unknown=unknown,
        books=books_table(result),
        assumptions=[*_start(case), *model_assumptions(case["analysis"], [case["bearing"]])],
        warnings=[*poor, *(tidy(text) for text in warnings)],
        identity=identity_of(
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
    table = warming_table(result)
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


def tables_of(result: Result) -> dict[str, ReportTable]:
    """Tables of what came out, by name."""
    found = {
        "cycles": cycles_table(result) if len(result.cycles) else None,
        "cold": cold_table(result),
        "warming": warming_table(result),
    }
    return {name: table for name, table in found.items() if table is not None}


def inputs_of(result: Result, case: Case) -> dict[str, ReportTable]:
    """Tables of what went in: test, bearing, air, rig, model."""
    sources = case.get("sources", {}).get(result.bearing_name)
    found = {"test": table_of_test(case["test"]), **bearing_tables(case["bearing"], sources)}
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


def checks_of(result: Result, case: Case) -> list[Check]:
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
