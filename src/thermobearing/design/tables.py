"""Tables of designs, bounds and temperature factors from their summaries, live or read again."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from thermobearing.bearing.undecided import band_text
from thermobearing.border.lazy import pd
from thermobearing.design.bounds import BOUNDS_NOTE, INITIAL_NOTE, VIRGIN_BOUND
from thermobearing.design.codes import FOOTNOTE
from thermobearing.design.peaks import COLLECTED
from thermobearing.quantities.governing import least_by
from thermobearing.quantities.register import MINUS, Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import counted, degrees, joined, printed_unit, tidy
from thermobearing.reported import checks_table
from thermobearing.results.ranges import MARKED

Summary = Mapping[str, Any]
LINES = Quantity("Lines", name="group")
Names = list[str | Quantity]
DEMANDS = {  # words, unit, factor
    "bearing_strain_max": ("shear strain", "%", 100.0),
    "bearing_force_max_kN": ("force of one bearing", "kN", 1.0),
    "pier_displacement_max_mm": ("pier top", "mm", 1.0),
    "deck_acceleration_max_m_s2": ("deck acceleration", "m/s²", 1.0),
}
RECOMMENDED = (
    "For dynamic analysis use Q_d, K_1 and K_2: displacements and forces depend on peak force and "
    "energy. The loops of the next table have the Q_d that factors multiply, the same peak force, "
    "and the stated ratio of the energy."
)


def bounds_sentences(summary: Summary) -> list[str]:
    """Return how many demands are unsafe, and the worst of them."""
    rows = [(name, row) for name, table in summary["rows"].items() for row in table]
    early = []
    if summary["outcome"] != "completed":
        sentence = tidy(str(summary.get("sentence", "")))
        early = [f"Some runs did not complete ({summary['outcome']}): {sentence}"]
    verdicts = [row["verdict"] for _, row in rows]
    unsafe, wasteful = verdicts.count("unsafe"), verdicts.count("wasteful")
    name, least = least_by(rows, lambda pair: float(pair[1]["envelope_over_coupled"]))
    demand = DEMANDS.get(least["demand"], (least["demand"],))[0]
    first = (
        f"Of {counted(len(rows), 'demand')}, {unsafe} are unsafe (below 0.95 of the coupled "
        f"model) and {wasteful} wasteful (above 1.3)."
    )
    second = (
        f"The least safe is the {demand} of {name} under {least['motion']}: the envelope of the "
        f"bounds gives {least['envelope_over_coupled']:.2f} of what the coupled model gives at "
        f"{degrees([least['coupled_at_degC']])}."
    )
    return [*early, first, second, *_states_sentence(summary, rows)]


def _states_sentence(summary: Summary, rows: Sequence[tuple[str, Summary]]) -> list[str]:
    """Return how many demands are unsafe if the rubber may be in either state."""
    rows = [pair for pair in rows if "other_state" in pair[1]]
    if not rows:
        return []
    unsafe = [row["verdict_of_both"] for _, row in rows].count("unsafe")
    state, marks = rows[0][1]["other_state"], (summary.get("rubber_state") or {}).values()
    unknown = " (scragging assumed)" if any(mark.get("assumed") for mark in marks) else ""
    name, least = least_by(rows, lambda pair: float(pair[1]["envelope_over_both"]))
    demand = DEMANDS.get(least["demand"], (least["demand"],))[0]
    return [
        f"If the rubber may also be {state}{unknown}, {unsafe} of {counted(len(rows), 'demand')} "
        f"{'is' if unsafe == 1 else 'are'} unsafe with the bound of that state too; the least safe "
        f"is the {demand} of {name} under {least['motion']}, {least['envelope_over_both']:.2f}."
    ]


def demands_tables(summary: Summary) -> dict[str, Table]:
    """Return a row for each bearing, motion and demand: as analysed, and in both states."""
    frame = pd.DataFrame(
        [{"bearing": name} | row for name, table in summary["rows"].items() for row in table]
    )
    shown = [DEMANDS.get(name, (name, "", 1.0)) for name in frame["demand"]]
    frame["demand"], frame["unit"], factors = map(list, zip(*shown, strict=True))
    numbers = ("lower_bound", "upper_bound", "coupled_max", "other_bound", "other_coupled_max")
    for name in numbers:
        if name in frame:
            frame[name] *= factors
    keys: Names = ["bearing", "motion", "demand", Quantity("Unit", name="unit"), "part"]
    names: Names = ["lower_bound", "upper_bound", "coupled_max", "coupled_at_degC"]
    names += ["envelope_over_coupled", "verdict"]
    beyond = [bool(str(text or "")) for text in frame["beyond_tested"]]
    notes = ["unsafe: envelope below 0.95 of the coupled model; wasteful: above 1.3."]
    if any(beyond):
        notes.append(f"{MARKED} (some run of that motion).")
    note = " ".join(notes)
    where = f"the coupled model on {summary['structure']}"
    options: dict[str, Any] = {"keys": 4 + ("part" in frame), "marked": {"motion": beyond}}
    caption = f"Bounds compared with {where}"
    tables = {"demands": make_table(frame, [*keys, *names], caption, note=note, **options)}
    if "other_state" in frame:
        names = ["other_state", "other_bound", "other_coupled_max", "other_coupled_at_degC"]
        names += ["envelope_over_both", quantity("verdict", name="verdict_of_both")]
        caption = f"Rubber in the other state: its bound and {where}; envelope of all bounds"
        tables["states"] = make_table(frame, [*keys, *names], caption, note=STATES_NOTE, **options)
    return tables


USUAL_REFERENCES = (20.0, 23.0)  # of published factors, and of tests of Shen (2023) [degC]
OTHER_REFERENCE = (
    "Relative to {}: published factors refer mostly to 20 °C, and examples of the documentation to "
    "23 °C; --reference makes factors comparable."
)
STATES_NOTE = (
    "Virgin rubber bounds forces and piers, in its first cycle at the coldest temperature; tested "
    "rubber bounds displacements, in its third cycle at the warmest."
)


def factor_tables(summary: Summary) -> dict[str, Table]:
    """Return factors with a column for each temperature, and bounds."""
    tables = {"factors": _factors_table(summary)}
    ratio = summary["stiffness_ratio"]
    bounds_note = (
        f"K_2/K_1 = {ratio['K_2_over_K_1']:g}: {ratio['source']}. {INITIAL_NOTE}. "
        f"{BOUNDS_NOTE}. {RECOMMENDED}"
    )
    names: Names = [Quantity("Bound", name="bound"), quantity("strain", form="g")]
    names += [Quantity("Cycle", name="basis"), "ambient_degC"]
    keys = list(names)
    names += ["Q_d_kN", "K_1_kN_mm", "K_2_kN_mm", "Q_y_kN"]
    bounds = pd.DataFrame(summary["bounds"])
    if summary.get("compared"):
        tables["compared"] = _compared_table(summary)
    if summary.get("makers"):
        tables["makers"] = _makers_table(summary)
    if summary.get("bands"):
        tables["bands"] = _bands_table(summary)
    caption = "Lower and upper bilinear model"
    if summary["states"]:
        caption = f"{caption}, also of virgin rubber"
        bounds_note = f"{VIRGIN_BOUND}. {bounds_note}"
    tables["bounds"] = make_table(bounds, names, caption, keys=4, note=bounds_note)
    names = [*keys, "cycle_Q_d_kN", "cycle_K_2_kN_mm", "cycle_energy_ratio"]
    caption = "The same bounds with the force of the cycle at zero displacement, and its peak force"
    tables["bounds_of_cycles"] = make_table(bounds, names, caption, keys=4)
    if summary["states"]:
        tables["states"] = _states_table(summary)
    return tables | (_site_tables(summary["site"]) if summary.get("site") else {})


def _factors_table(summary: Summary) -> Table:
    """Return the factors, with a column for each temperature."""
    rows = summary["factors"]
    temperatures = sorted({float(row["ambient_degC"]) for row in rows})
    bands = any(pd.notna(row.get("factor_low")) for row in rows)
    lines: dict[tuple[Any, ...], dict[float, Any]] = {}
    values: dict[tuple[Any, ...], float] = {}
    for row in rows:
        unit, factor = printed_unit(str(row["unit"]))
        key = (100.0 * row["strain"], row["basis"], row["quantity"], unit)
        lines.setdefault(key, {})[float(row["ambient_degC"])] = row
        if row["ambient_degC"] == summary["reference_degC"]:
            values[key] = factor * row["value"]
    reference = degrees([summary["reference_degC"]])
    columns = [quantity("strain", form="g"), *map(Quantity, ("Cycle", "Quantity", "Unit"))]
    columns.append(Quantity(f"Value at {reference}", form=".3g"))
    columns += [
        Quantity(f"Factor at {degrees([temperature])}", form=".2f") for temperature in temperatures
    ]
    cells: list[list[Any]] = []
    marked: set[tuple[int, int]] = set()
    for line_number, (key, by_temperature) in enumerate(lines.items()):
        factors = [by_temperature.get(temperature) for temperature in temperatures]
        cells.append([*key, values.get(key), *(row and _cell(row) for row in factors)])
        # Five columns (strain to value) stand before the factors.
        marked |= {
            (line_number, 5 + place)
            for place, row in enumerate(factors)
            if row is not None and "ambient" in str(row.get("beyond_tested") or "").split()
        }
        outside = " ".join(str(row.get("beyond_tested") or "") for row in factors if row).split()
        marked |= {(line_number, 0)} if {"strain", "strain_rate"} & set(outside) else set()
    notes = [
        "first: the first cycle, with the heating within it; heated: the last cycle, after "
        "self-heating; mean: the mean of the cycles."
    ]
    # The largest strain is that of the bounds and of the comparison with codes.
    strain = max(row["strain"] for row in rows)
    rises = {
        float(row["ambient_degC"]): row["lead_rise_K"]
        for row in summary.get("lead_rises", [])
        if row["strain"] == strain
    }
    if rises:
        parts = [f"{rises[t]:.0f} K at {degrees([t])}" for t in sorted(rises)]
        shear = f"{100.0 * strain:g} %"
        notes.append(f"Rise of the lead in the first cycle of {shear}: {joined(parts)}.")
    if summary["reference_degC"] not in USUAL_REFERENCES:
        notes.append(OTHER_REFERENCE.format(reference))
    if bands:
        notes.append(BAND.format(summary["samples"]))
    if marked:
        notes.append(f"{MARKED}.")
    note = " ".join(notes)
    rubber = f", rubber {summary['state']}" if summary.get("state") else ""
    caption = (
        f"Temperature factors of {summary['bearing']} over {reference} "
        f"({summary['motion']}, cycles {summary['cycles']}{rubber}){BRACKETS if bands else ''}"
    )
    return Table(caption, columns, cells, 4, frozenset(marked), note)


def _bands_table(summary: Summary) -> Table:
    """Return how far the range of the rate factor moves the values, a row for each strain."""
    frame = pd.DataFrame(summary["bands"])
    pairs = zip(frame["lowest"], frame["highest"], strict=True)
    frame["text"] = [band_text(*pair).replace("-", MINUS) for pair in pairs]
    by_quantity = frame.pivot_table("text", "strain", "quantity", aggfunc="first", sort=False)
    columns = [Quantity(str(name), name=str(name)) for name in by_quantity]
    at = degrees([summary["reference_degC"]])
    caption = f"Not decided by tests: change of the values at {at} by the rate dependence"
    note = (
        "The range of the factor on the rate branch (rate_band of the bearing), of the same "
        "motion; mean over the cycles. The factors above are relative and change less."
    )
    names: Names = [quantity("strain", form=".0f"), *columns]
    return make_table(by_quantity.reset_index(), names, caption, keys=1, note=note)


def _states_table(summary: Summary) -> Table:
    """Return the first cycle of virgin over that of tested rubber, by temperature."""
    frame = pd.DataFrame(summary["states"])
    temperatures = sorted(set(frame["ambient_degC"]))
    columns = [quantity("strain", form="g"), Quantity("Quantity")]
    columns += [
        Quantity(f"At {degrees([temperature])}", form=".2f") for temperature in temperatures
    ]
    groups = frame.groupby(["strain", "quantity"], sort=False)
    cells = [
        [
            100.0 * group["strain"].iloc[0],
            name,
            *group.set_index("ambient_degC").loc[temperatures, "ratio"],
        ]
        for (_, name), group in groups
    ]
    (mark,) = summary["rubber_state"].values()
    note = "Scragging of the table of the bearing."
    if mark["assumed"]:
        note = (
            "The scragging of this rubber is not known and assumed: that of one test of another "
            "compound. The table scragging of the bearing replaces it."
        )
    caption = f"Virgin over tested rubber of {summary['bearing']}, first cycle"
    return Table(caption, columns, cells, 2, note=note)


def site_sentence(site: Summary) -> str:
    """Return the design temperature of a site, and what it is."""
    period = site["return_period"]
    meaning = f"once in {period} years" if period else "the lowest on record, from few winters"
    return (
        f"Design temperature for instantaneous stiffening at {site['name']}: "
        f"{degrees([round(site['design_temperature'], 1)])}, daily mean, {meaning} "
        f"({counted(site['winters'], 'winter')})."
    )


def _site_tables(site: Summary) -> dict[str, Table]:
    """Return the coldest days of a site by return period, and its cold days in a row."""
    stiffening = pd.DataFrame(site["stiffening"])
    tables = {
        "site_stiffening": make_table(
            stiffening,
            caption=f"Instantaneous stiffening: coldest days of {site['name']}",
            note=f"{site_sentence(site)} Gumbel distribution; low and high: 90 % interval. The row "
            "without a return period is the coldest day on record.",
        )
    }
    if site["cold_days"]:
        tables["site_cold_days"] = make_table(
            pd.DataFrame(site["cold_days"]),
            caption=f"Crystallization: consecutive cold days of {site['name']}",
            note="A day is cold if its mean temperature is below that of the row; the last column "
            "is the longest run of days whose highest temperature is below it.",
        )
    return tables


def _cell(row: Mapping[str, Any], name: str = "factor") -> Any:
    """Return a factor, with its band where there is one."""
    low, high = row.get(f"{name}_low"), row.get(f"{name}_high")
    if low is None or high is None or not np.isfinite([low, high]).all():
        return row[name]
    return f"{row[name]:.2f} ({low:.2f}–{high:.2f})"


BRACKETS = ", in brackets 5 to 95 %"  # in captions
BAND = "In brackets: 5 to 95 % of {} bearings, the given one and its samples."
UNCHECKED = "None of these provisions was checked against the text of the code"


MAKERS = "Factors of makers are divided by that at the reference temperature."
OTHER_KIND = "Rows of another kind of bearing than {} are of another rubber."


def _makers_table(summary: Summary) -> Table:
    """Compare the factors of a bearing with those that makers publish."""
    rows, kind = summary["makers"], summary["inputs"]["bearing"]["kind"]
    columns = [Quantity(head) for head in ("Quantity", "Maker", "Of")]
    columns += [Quantity("Ambient [°C]", form="g")]
    columns += [Quantity(head, form=".2f") for head in ("Factor", "First", "Heated")]
    names = ("ambient_degC", "factor", "first", "heated")
    cells = [
        [row["quantity"], row["name"], "/".join(row["kinds"]), *(row[name] for name in names)]
        for row in rows
    ]
    others = any(kind not in row["kinds"] for row in rows)
    note = " ".join([MAKERS, *([OTHER_KIND.format(kind)] if others else [])])
    caption = f"Factors of makers compared with those of {summary['bearing']}, {kind}"
    return Table(caption, columns, cells, 2, note=note)


def _compared_table(summary: Summary) -> Table:
    """Compare the factors of a bearing with those of codes."""
    rows, codes = summary["compared"], summary["codes"]
    columns = [Quantity("Quantity"), Quantity("First", form=".2f")]
    columns.append(Quantity("Heated", form=".2f"))
    cells = [[row["quantity"], _cell(row, "first"), _cell(row, "heated")] for row in rows]
    for code in codes:
        rubbers = list(rows[0]["codes"].get(code["name"], {}))
        columns += [Quantity(f"{code['name']} {rubber}", form=".2f") for rubber in rubbers]
        for cell, row in zip(cells, rows, strict=True):
            cell += [row["codes"][code["name"]][rubber] for rubber in rubbers]
        if not rubbers:
            columns.append(Quantity(code["name"]))
            text = f"as {code['same_as']}" if code["same_as"] in rows[0]["codes"] else "none"
            for cell in cells:
                cell.append(text)
    columns.append(Quantity("Difference"))
    for cell, row in zip(cells, rows, strict=True):
        cell.append(row["difference"])
    interval = "One bearing has no interval; samples of a posterior give one."
    if summary["samples"] > 1:
        interval = BAND.format(summary["samples"])
    notes = [
        interval,
        "Difference: first cycle compared with the nearest factor of a code. Factors of codes are "
        "divided by that at the reference temperature and interpolated linearly; those of K_eq and "
        "h_eq belong to a bilinear loop with the code's factors of Q_d and K_d.",
        f"{'. '.join(summary['reasons'])}.",
    ]
    if _all_unverified(codes):
        notes.append(f"{UNCHECKED}.")
    note = " ".join(notes)
    at = degrees([rows[0]["ambient_degC"]])
    brackets = BRACKETS if summary["samples"] > 1 else ""
    caption = f"Factors of {summary['bearing']} at {at} compared with codes{brackets}"
    return Table(caption, columns, cells, 1, note=note)


def _all_unverified(codes: Sequence[Summary]) -> bool:
    return all(code["unverified"] for code in codes)


def code_sentences(codes: Sequence[Summary]) -> list[str]:
    """Return the clause, the provision and the origin of each code."""
    some_verified = not _all_unverified(codes)
    sentences = [
        f"{code['code']}{'*' * (some_verified and code['unverified'])}, clause: {code['clause']}: "
        f"{code['says']}; origin: {code['origin']}."
        for code in codes
    ]
    return [*sentences, f"{FOOTNOTE}." if some_verified else f"{UNCHECKED}."]


ROUNDS = (
    "round",
    LINES,
    "u_B_assumed_mm",
    "side_mm",
    "layers",
    "layer_thickness_mm",
    "K_B_kN_mm",
    "h_B",
    "Q_d_kN",
    "K_1_kN_mm",
    quantity("K_2_kN_mm", form=".2f"),
    "u_found_mm",
    "difference",
    quantity("pier_ductility", head="Pier ductility"),
)


def design_tables(summary: Summary) -> dict[str, Table]:
    """Return rounds, layered bearings of the same stiffness, and peaks by temperature."""
    rounds = pd.DataFrame(summary["rounds"])
    several = "group" in rounds
    note = f"Round {summary['chosen_round']} was taken."
    caption = "Rounds of the design"
    tables = {"rounds": make_table(rounds, ROUNDS, caption, keys=1 + several, note=note)}
    names: Names
    if summary["equal"]:
        names = [Quantity("Bearing", name="name"), LINES, "K_eq_kN_mm", "h_eq"]
        caption = "Layered bearings of the same stiffness, third cycle at the design displacement"
        tables["equal"] = make_table(pd.DataFrame(summary["equal"]), names, caption)
    if summary["temperatures"]:
        names = ["bearing", LINES, "ambient_degC", *COLLECTED.values()]
        names += [quantity("pier", head="Governing pier"), "verdict", "fails"]
        frame = pd.DataFrame(summary["temperatures"])
        caption = "Layered bearings at every temperature"
        tables["temperatures"] = make_table(
            frame, names, caption, keys=2 + several, drop_empty=False
        )
        if summary.get("virgin"):
            tables["virgin"] = make_table(
                pd.DataFrame(summary["virgin"]),
                names,
                "The same bearings with virgin rubber, which bounds forces and piers",
                keys=2 + several,
                drop_empty=False,
                note="Scragging assumed of one test of another compound, where the bearing has no "
                "table of it.",
            )
    return tables


def design_checks_table(summary: Summary) -> Table:
    """Return the calculation sheet of a design."""
    return checks_table(pd.DataFrame(summary["checks"]))
