"""Tables of designs, bounds and temperature factors from their summaries, live or read again."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.cyclic.reported import checks_table
from thermobearing.design.bounds import BOUNDS_NOTE
from thermobearing.design.codes import FOOTNOTE
from thermobearing.design.peaks import COLLECTED
from thermobearing.quantities.governing import least_by
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report.words import counted, degrees, printed_unit, tidy
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
    what = DEMANDS.get(least["demand"], (least["demand"],))[0]
    first = (
        f"Of {counted(len(rows), 'demand')}, {unsafe} are unsafe (below 0.95 of the coupled "
        f"model) and {wasteful} wasteful (above 1.3)."
    )
    second = (
        f"The least safe is the {what} of {name} under {least['motion']}: the envelope of the "
        f"bounds gives {least['envelope_over_coupled']:.2f} of what the coupled model gives at "
        f"{degrees([least['coupled_at_degC']])}."
    )
    return [*early, first, second]


def demands_table(summary: Summary) -> Table:
    """Return a row for each bearing, motion and demand."""
    frame = pd.DataFrame(
        [{"bearing": name} | row for name, table in summary["rows"].items() for row in table]
    )
    shown = [DEMANDS.get(name, (name, "", 1.0)) for name in frame["demand"]]
    frame["demand"], frame["unit"], factors = map(list, zip(*shown, strict=True))
    for name in ("lower_bound", "upper_bound", "coupled_max"):
        frame[name] *= factors
    names: Names = ["bearing", "motion", "demand", Quantity("Unit", name="unit"), "part"]
    keys = 4 + ("part" in frame)
    names += ["lower_bound", "upper_bound", "coupled_max", "coupled_at_degC"]
    names += ["envelope_over_coupled", "verdict"]
    beyond = [bool(str(text or "")) for text in frame["beyond_tested"]]
    note = "unsafe: envelope below 0.95 of the coupled model; wasteful: above 1.3."
    note += f" {MARKED} (some run of that motion)." * any(beyond)
    caption = f"Bounds compared with the coupled model on {summary['structure']}"
    return make_table(frame, names, caption, keys=keys, marked={"motion": beyond}, note=note)


def factor_tables(summary: Summary) -> dict[str, Table]:
    """Return factors with a column for each temperature, and bounds."""
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
    for at, (key, by_temperature) in enumerate(lines.items()):
        factors = [by_temperature.get(temperature) for temperature in temperatures]
        cells.append([*key, values.get(key), *(row and _cell(row) for row in factors)])
        marked |= {
            (at, 5 + place)
            for place, row in enumerate(factors)
            if row is not None and "ambient" in str(row.get("beyond_tested") or "").split()
        }
        outside = " ".join(str(row.get("beyond_tested") or "") for row in factors if row).split()
        marked |= {(at, 0)} if {"strain", "strain_rate"} & set(outside) else set()
    note = "first: the first cycle; heated: the last cycle, after self-heating; mean: the mean of "
    note += (
        "the cycles." + f" {BAND.format(summary['samples'])}" * bands + f" {MARKED}." * bool(marked)
    )
    caption = f"Temperature factors of {summary['bearing']} over {reference} "
    caption += f"({summary['motion']}, cycles {summary['cycles']})"
    ratio = summary["stiffness_ratio"]
    bounds_note = f"K_2/K_1 = {ratio['K_2_over_K_1']:g}: {ratio['source']}. {BOUNDS_NOTE}."
    names: Names = [Quantity("Bound", name="bound"), quantity("strain", form="g")]
    names += [Quantity("Cycle", name="basis"), "ambient_degC"]
    names += ["Q_d_kN", "K_1_kN_mm", "K_2_kN_mm", "Q_y_kN"]
    bounds = pd.DataFrame(summary["bounds"])
    tables = {"factors": Table(caption, columns, cells, 4, frozenset(marked), note)}
    if summary.get("compared"):
        tables["compared"] = _compared_table(summary)
    tables["bounds"] = make_table(
        bounds, names, "Lower and upper bilinear model", keys=4, note=bounds_note
    )
    return tables | (_site_tables(summary["site"]) if summary.get("site") else {})


def site_sentence(site: Summary) -> str:
    """Return the design temperature of a site, and what it is."""
    period = site["return_period"]
    what = f"once in {period} years" if period else "the lowest on record, from few winters"
    return (
        f"Design temperature for instantaneous stiffening at {site['name']}: "
        f"{degrees([round(site['design_temperature'], 1)])}, daily mean, {what} "
        f"({counted(site['winters'], 'winter')})."
    )


def _site_tables(site: Summary) -> dict[str, Table]:
    """Return the coldest days of a site by return period, and its cold days in a row."""
    stiffening = pd.DataFrame(site["stiffening"])
    found = {
        "site_stiffening": make_table(
            stiffening,
            caption=f"Instantaneous stiffening: coldest days of {site['name']}",
            note=f"{site_sentence(site)} Gumbel distribution; low and high: 90 % interval. The row "
            "without a return period is the coldest day on record.",
        )
    }
    if site["cold_days"]:
        found["site_cold_days"] = make_table(
            pd.DataFrame(site["cold_days"]),
            caption=f"Crystallization: consecutive cold days of {site['name']}",
            note="A day is cold if its mean temperature is below that of the row; the last column "
            "is the longest run of days whose highest temperature is below it.",
        )
    return found


def _cell(row: Mapping[str, Any], name: str = "factor") -> Any:
    """Return a factor, with its band where there is one."""
    low, high = row.get(f"{name}_low"), row.get(f"{name}_high")
    if low is None or high is None or not np.isfinite([low, high]).all():
        return row[name]
    return f"{row[name]:.2f} ({low:.2f}–{high:.2f})"


BAND = "In brackets: 5 to 95 % of {} bearings, the given one and its samples."
UNCHECKED = "None of these provisions was checked against the text of the code"


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
    note = (
        f"{BAND.format(summary['samples'])} "
        if summary["samples"] > 1
        else "One bearing has no interval; samples of a posterior give one. "
    )
    note += (
        "Difference: first cycle compared with the nearest factor of a code. Factors of codes are "
        "divided by that at the reference temperature and interpolated linearly; those of K_eq and "
        "h_eq belong to a bilinear loop with the code's factors of Q_d and K_d. "
    )
    note += f"{'. '.join(summary['reasons'])}."
    note += f" {UNCHECKED}." * _all_unverified(codes)
    at = degrees([rows[0]["ambient_degC"]])
    caption = f"Factors of {summary['bearing']} at {at} compared with codes"
    return Table(caption, columns, cells, 1, note=note)


def _all_unverified(codes: Sequence[Summary]) -> bool:
    return all(code["unverified"] for code in codes)


def code_sentences(codes: Sequence[Summary]) -> list[str]:
    """Return the clause, the provision and the origin of each code."""
    some = not _all_unverified(codes)
    found = [
        f"{one['code']}{'*' * (some and one['unverified'])}, clause: {one['clause']}: "
        f"{one['says']}; origin: {one['origin']}."
        for one in codes
    ]
    return [*found, f"{FOOTNOTE}." if some else f"{UNCHECKED}."]


ROUNDS = (
    *("round", LINES, "u_B_assumed_mm", "side_mm", "layers", "layer_thickness_mm", "K_B_kN_mm"),
    *("h_B", "Q_d_kN", "K_1_kN_mm", quantity("K_2_kN_mm", form=".2f"), "u_found_mm"),
    *("difference", quantity("pier_ductility", head="Pier ductility")),
)


def design_tables(summary: Summary) -> dict[str, Table]:
    """Return rounds, layered bearings of the same stiffness, and peaks by temperature."""
    rounds = pd.DataFrame(summary["rounds"])
    several = "group" in rounds
    note = f"Round {summary['chosen_round']} was taken."
    caption = "Rounds of the design"
    found = {"rounds": make_table(rounds, ROUNDS, caption, keys=1 + several, note=note)}
    names: Names
    if summary["equal"]:
        names = [Quantity("Bearing", name="name"), LINES, "K_eq_kN_mm", "h_eq"]
        caption = "Layered bearings of the same stiffness, third cycle at the design displacement"
        found["equal"] = make_table(pd.DataFrame(summary["equal"]), names, caption)
    if summary["temperatures"]:
        names = ["bearing", LINES, "ambient_degC", *COLLECTED.values()]
        names += [quantity("pier", head="Governing pier"), "verdict", "fails"]
        frame = pd.DataFrame(summary["temperatures"])
        caption = "Layered bearings at every temperature"
        found["temperatures"] = make_table(
            frame, names, caption, keys=2 + several, drop_empty=False
        )
    return found


def design_checks_table(summary: Summary) -> Table:
    """Return the calculation sheet of a design."""
    return checks_table(pd.DataFrame(summary["checks"]))
