"""Tables of an analysis of earthquakes for the console and reports, and comparisons of models.

Heads, units and formats are in the register (data/quantities/earthquake.toml).
"""

import tomllib
from collections.abc import Hashable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.cyclic.reported import bearing_check_tables
from thermobearing.earthquake import measures
from thermobearing.earthquake.motions import rotation_frame
from thermobearing.model.earlier import REFERENCE
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report.words import joined
from thermobearing.results.ranges import TESTED
from thermobearing.results.selection import force_differences, more, temperature_differences

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

PEAKS: Final = (  # of a report
    *measures.COLUMNS[:6], "deck_acceleration_max_m_s2", "rubber_max_degC", "lead_max_degC",
)  # fmt: skip
CONSOLE: Final = (  # fits a screen of 100 columns; a warning states the damping where it is much
    *PEAKS[:3], "energy_of_warmest", *PEAKS[3:5], "deck_displacement_max_mm", *PEAKS[-3:],
)  # fmt: skip
SHORT: Final = {  # heads of CONSOLE
    "bearing_force_max_kN": "Force",
    "bearing_energy_kN_mm": "Energy",
    "energy_of_warmest": "Energy ratio",
    "deck_displacement_max_mm": "Deck",
}
COLD: Final = (*PEAKS[:4], "deck_acceleration_max_m_s2")  # compared with the warmest run
BY_DIRECTION: Final = (
    *("bearing_strain_max", "bearing_force_max_kN", "pier_displacement_max_mm", "pier_ductility"),
    *("pier_moment_max_kN_m", "deck_displacement_max_mm", "deck_acceleration_max_m_s2"),
)
# Peaks of analyses with one component at a time, combined as designers do; see `_combined`.
COMBINATIONS: Final = {
    "x": "along",
    "y": "across",
    "larger": "larger one",
    "rule": "100 % + 30 %",
    "srss": "SRSS",
}
COMPARED_PEAKS: Final = (
    *("bearing_strain_max", "bearing_force_max_kN", "pier_displacement_max_mm", "pier_ductility"),
    *("deck_displacement_max_mm", "deck_acceleration_max_m_s2", "rubber_rise_K", "lead_rise_K"),
)
RULE: Final = 0.3  # share of the other direction
PARTS: Final = {
    "line": (
        *("line_bearing", "count", "line_ambient_degC", "strain_max", "force_max_kN"),
        *("total_force_max_kN", "rubber_max_degC", "lead_max_degC"),
    ),
    "pier": (
        *("displacement_max_mm", "displacement_residual_mm", "ductility", "moment_max_kN_m"),
        "top_acceleration_max_m_s2",
    ),
}
MOST_ROWS: Final = 24  # of lines, piers or checks on the console: of more, the largest of all
FAST, SLOW = "rt", "pd"
RATIOS: Final = {  # of a real-time test over the pseudo-dynamic one: column of the table of runs
    "force": "bearing_force_max_kN",
    "strain": "bearing_strain_max",
    "energy": "bearing_energy_kN_mm",
}
RISES: Final = ("outer_layer", "inner_layer", "lead")
ERRORS: Final = (  # columns of comparison.csv on the console
    "inner layer largest K", "lead largest K", "peak force %", "peak strain %", "energy %",
    "pier displacement %", "loop K_eq %",
)  # fmt: skip
# What: table of an analysis with several lines or piers, column there, column of the table of runs.
GOVERNED: Final = {
    "bearing strain": ("line", "strain_max", "bearing_strain_max"),
    "bearing displacement [mm]": ("line", "displacement_max_mm", ""),
    "force of one bearing [kN]": ("line", "force_max_kN", "bearing_force_max_kN"),
    "lead [degC]": ("line", "lead_max_degC", ""),
    "pier displacement [mm]": ("pier", "displacement_max_mm", "pier_displacement_max_mm"),
    "pier ductility": ("pier", "ductility", "pier_ductility"),
    "deck displacement [mm]": ("", "", "deck_displacement_max_mm"),
}


def _largest(values: "pd.Series[float]") -> float:
    return float(measures.farthest(values))


def _keys(frame: "pd.DataFrame") -> list[str]:
    return [name for name in measures.KEYS if name in frame]


def _reported_line(result: "EarthquakeResult") -> str:
    """Return " of line A1", the line whose histories are kept; empty with one of all."""
    return f" of line {result.dataset.attrs['line']}" if result.has_parts else ""


def make_tables(result: "EarthquakeResult") -> dict[str, Table]:
    """Return the tables of results by name; those without a row are left out."""
    ratios, compared = result.modes_table, list(measures.KEYS[:3])
    compared += [f"{name}_ratio" for name in (*RATIOS, *(f"{place}_rise" for place in RISES))]
    found = {
        "governing": _governing_table(result),
        "peaks": _peaks_table(result),
        "directions": _directions_table(result),
        "components": _components_table(result),
        "rotation": _rotation_table(result),
        "cold": _cold_table(result),
        "lines": _parts_table(result, "line"),
        "piers": _parts_table(result, "pier"),
        **bearing_check_tables(result),
        "modes": make_table(ratios, compared, "Real time over pseudo-dynamic", keys=3),
        "loops": _loops_table(result),
        "periods": _periods_table(result),
        "bearing_balance": balance_table(result, bearing=True),
    }
    return {name: table for name, table in found.items() if len(table)}


def console_tables(result: "EarthquakeResult") -> list[Table]:
    """Return the tables of the console: peaks by bearing, the largest of many lines or piers."""
    found = make_tables(result)
    for part in PARTS:
        if f"{part}s" in found:
            found[f"{part}s"] = _parts_table(result, part, most=MOST_ROWS)
    bearings = list(dict.fromkeys(result.table["bearing"]))
    each = [result.sel(bearing=name) for name in bearings] if result.runs > len(bearings) else []
    peaks = [_peaks_table(one, CONSOLE, heads=SHORT) for one in each or [result]]
    note = max((table.note for table in peaks), key=len)
    shown = [replace(table, note="") for table in peaks[:-1]] + [replace(peaks[-1], note=note)]
    last = ("directions", "components", "rotation", "modes", "lines", "piers", "governing")
    shown += [found[name] for name in last if name in found]
    for name, table in bearing_check_tables(result, every_part=False).items():
        shown.append(found[name] if len(found[name]) <= MOST_ROWS else table)
    ratios = found.get("components")  # means, which two temperatures may share by chance
    return [table if table is ratios else table.merged("ambient_degC") for table in shown]


def _peaks_table(
    result: "EarthquakeResult",
    names: tuple[str, ...] = PEAKS,
    heads: Mapping[str, str] | None = None,
) -> Table:
    """Return the peaks of every run, marked where they leave the calibration range."""
    hottest = [result.hottest(run) for run in range(result.runs)]
    frame = result.table.assign(
        rubber_max_degC=[one["rubber"] for one in hottest],
        lead_max_degC=[one["lead"] for one in hottest],
    )
    frame["pier_displacement_max_mm"] = frame["pier_displacement_max_mm"].replace(0.0, np.nan)
    if frame["ambient_degC"].nunique() < 2:  # each run is the warmest
        frame = frame.drop(columns="energy_of_warmest")
    keys = _keys(frame)
    where = [n for n in measures.PLACES if n in frame and frame[n].nunique() > 1 and names == PEAKS]
    ended = ["outcome"] if (frame["outcome"] != "completed").any() else []
    frame["outcome"] = frame["outcome"].str.replace("_", " ")
    limits = [str(text).split() for text in frame["beyond_tested"]]
    columns = {"ambient": "ambient_degC", "strain": "bearing_strain_max"}
    if frame["lead_max_degC"].notna().any():
        columns["lead_temperature"] = "lead_max_degC"
    marked = {name: [limit in one for one in limits] for limit, name in columns.items()}
    others = {limit for one in limits for limit in one} - {*columns, "strain_rate"}
    marked["motion"] = [bool(others.intersection(one)) for one in limits]
    note = "Force and energy are those of one bearing; "
    if frame["pier_displacement_max_mm"].notna().any():
        note += "the displacement of the pier top is relative to its base, "
    note += "the acceleration of the deck absolute; rubber and lead: highest temperature."
    if "energy_of_warmest" in names and "energy_of_warmest" in frame:
        note += " The energy ratio is relative to the warmest run."
    if result.has_parts:
        note += f" Every peak is the largest of all {joined(_plurals(result))}."
    if any(any(flags) for flags in marked.values()):
        words = ", ".join(sorted(TESTED[limit][1] for limit in others))
        note += " Marked values are outside the calibration range"
        note += f" (a marked motion: {words})." if others else "."
    specimen = result.dataset.attrs.get("specimen", "")
    caption = f"Peaks of every run{specimen and f', specimen at {specimen}'}"
    return make_table(
        frame, [*keys, *names, *where, *ended], caption, keys=len(keys),
        heads={"outcome": "Ended"} | dict(heads or {}), marked=marked, note=note,
        governing="bearing_strain_max",
    )  # fmt: skip


def _directions_table(result: "EarthquakeResult") -> Table:
    """Return the largest of all motions in each direction and of the resultant; empty in one."""
    frame = result.by_direction() if result.in_plan else pd.DataFrame()
    caption = "Peaks in each direction and of the resultant, the largest of all motions"
    if not len(frame):
        return make_table(frame, caption=caption)
    keys = [name for name in _keys(frame) if name != "motion"]
    frame = frame.groupby(keys, sort=False)[list(measures.COLUMNS)].agg(_largest).reset_index()
    frame = frame.sort_values(keys[:-1], kind="stable")
    note = (
        "x: along the bridge, y: across it. The resultant combines x and y at the same time, so it "
    )
    note += "may be less than that of their peaks; for hinges it is the larger of x and y."
    return make_table(frame, [*keys, *BY_DIRECTION], caption, keys=len(keys), note=note)


def rotation_measures_frame(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return RotD50 and RotD100 of the peaks of motions at several angles; see `rotation_frame`."""
    motions = tomllib.loads(str(result.dataset.attrs["case"]))["motions"]
    runs = result.by_direction()
    labels = [name for name in _keys(runs) if name != "motion"]
    return rotation_frame(runs, motions, labels, BY_DIRECTION)


def _rotation_table(result: "EarthquakeResult") -> Table:
    """Return the measures of motions at several angles; empty without one."""
    frame = rotation_measures_frame(result)
    caption = "Peaks over the angles of a motion: median (RotD50) and largest (RotD100)"
    own = Quantity("Angles", form="d", name="angles"), Quantity("Measure", name="measure")
    keys: list[str | Quantity] = [*_keys(frame), *own]
    note = "Angles half a turn apart count once: they change the sign of the motion only."
    return make_table(frame, [*keys, *BY_DIRECTION], caption, keys=len(keys), note=note)


def _combined(x: Floats, y: Floats) -> dict[str, Floats]:
    """Return peaks of two unidirectional analyses and their usual combinations."""
    larger = np.maximum(x, y)
    rule = np.hypot(larger, RULE * np.minimum(x, y))
    return {"x": x, "y": y, "larger": larger, "rule": rule, "srss": np.hypot(x, y)}


def components_frame(result: "EarthquakeResult", single: "EarthquakeResult") -> "pd.DataFrame":
    """Return two components of the ground motion compared with one at a time, a row for each peak.

    Of hinges and temperatures only the larger one is compared with that of two components. Runs
    that ended early are left out.
    """
    keys = list(measures.KEYS[:3])
    two = {name: _peaks_by_run(result.sel(direction=name), keys) for name in measures.DIRECTIONS}
    apart = {name: _peaks_by_run(single.sel(direction=name), keys) for name in single.directions}
    runs, none = two["x"].index, pd.DataFrame(columns=two["x"].columns, dtype=float)
    x, y = (apart.get(name, none).reindex(runs) for name in measures.DIRECTIONS[:2])
    still = ~runs.isin(apart["y"].index) if "y" in apart else np.ones(len(runs), dtype=bool)
    y.loc[still, list(COMPARED_PEAKS)] = 0.0  # no motion across the bridge
    parts = []
    for name in COMPARED_PEAKS:
        combinations = _combined(x[name].to_numpy(float), y[name].to_numpy(float))
        if name.startswith("pier_ductility"):
            combinations = {key: combinations[key] for key in ("x", "y", "larger")}
        elif name.endswith("_K"):
            combinations = {"larger": combinations["larger"]}
        for key, values in combinations.items():
            both = two[key if key in measures.DIRECTIONS else measures.DIRECTIONS[-1]][name]
            frame = pd.DataFrame({"one_component": values, "two_components": both.to_numpy()})
            frame["two_over_one"] = frame["two_components"] / frame["one_component"].replace(
                0.0, np.nan
            )
            frame.insert(0, "combination", key)
            frame.insert(0, "quantity", name)
            parts.append(pd.concat([runs.to_frame(index=False), frame], axis=1))
    table = pd.concat(parts, ignore_index=True)
    return table[table["two_over_one"].notna()].reset_index(drop=True)


def _peaks_by_run(result: "EarthquakeResult", keys: list[str]) -> "pd.DataFrame":
    table = pd.concat([result.table, result.largest_rises()], axis=1).set_index(keys)
    peaks = list(COMPARED_PEAKS)
    table[peaks] = table[peaks].astype(float)
    table.loc[table["outcome"] != "completed", peaks] = np.nan
    return table


def components_summary(frame: "pd.DataFrame") -> "pd.DataFrame":
    """Return mean, lowest and highest ratio over the motions of `components_frame`."""
    keys = ["bearing", "ambient_degC", "quantity", "combination"]
    found = frame.groupby(keys, sort=False)["two_over_one"].agg(["mean", "min", "max"])
    return found.reset_index()


def _components_table(result: "EarthquakeResult") -> Table:
    """Return the mean ratios of two components to one at a time; empty without both."""
    frame = result.components
    caption = "Two components of the ground motion over one at a time"
    if not len(frame):
        return make_table(frame, caption=caption)
    caption += ", mean over the motions" if frame["motion"].nunique() > 1 else ""
    rows = components_summary(frame).pivot_table(
        "mean", ["bearing", "ambient_degC", "quantity"], "combination", sort=False
    )
    rows = rows.reset_index()
    rows["quantity"] = [quantity(name).meaning for name in rows["quantity"]]
    columns = [
        Quantity(head, form=".2f", name=name) for name, head in COMBINATIONS.items() if name in rows
    ]
    keys: list[str | Quantity] = ["bearing", "ambient_degC", Quantity("Quantity", name="quantity")]
    note = "Along and across: the peak of that direction over that of its analysis with one "
    note += "component. The others: the resultant over what the two analyses are combined to (the "
    note += "larger one; 100 % of one with 30 % of the other; the root of the sum of squares)."
    return make_table(rows, [*keys, *columns], caption, keys=3, note=note)


def _plurals(result: "EarthquakeResult") -> list[str]:
    return [f"{kind}s" for kind in result.part_kinds]


def governing_runs(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return the largest of every peak over all runs, lines and piers of each bearing."""
    rows = []
    runs = result.table
    parts = {"": pd.DataFrame(), "line": result.lines, "pier": result.piers}
    for bearing in dict.fromkeys(runs["bearing"]):
        for what, (part, own, plain) in GOVERNED.items():
            several = len(parts[part]) > 0
            table, column = (parts[part], own) if several else (runs, plain)
            mine = table[table["bearing"] == bearing]
            if column not in mine or not mine[column].notna().any():
                continue
            worst = mine.iloc[place_of_largest(mine[column])]
            row = {"bearing": bearing, "what": what, "largest": float(worst[column])}
            row |= {"part": str(worst[part]) if several else "", "motion": str(worst["motion"])}
            rows.append(row | {"ambient_degC": float(worst["ambient_degC"])})
    return pd.DataFrame(rows)


def _governing_table(result: "EarthquakeResult") -> Table:
    """Return the largest of all runs, lines and piers; empty for one run of one line."""
    frame = governing_runs(result)
    caption = f"The largest of all {joined(['runs', *_plurals(result)])}"
    if not len(frame) or (result.runs < 2 and not result.has_parts):
        return make_table(pd.DataFrame(), caption=caption)
    frame.loc[frame["what"] == "bearing strain", "largest"] *= 100.0
    words = frame["what"].replace("bearing strain", "bearing strain [%]")
    frame["what"] = [f"{text[:1].upper()}{text[1:]}".replace("deg", "°") for text in words]
    names = ["bearing", "what", "largest", "part", "motion", "ambient_degC"]
    head = " or ".join(result.part_kinds).capitalize()
    return make_table(frame, names, caption, keys=2, heads={"part": head})


def cold_ratios(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return peaks of each run over those at the warmest temperature of the same run otherwise."""
    table = result.table
    table = table[table["outcome"] == "completed"]
    same = [name for name in _keys(table) if name != "ambient_degC"]
    if table["ambient_degC"].nunique() < 2:
        return pd.DataFrame()
    warmest = float(table["ambient_degC"].max())
    warm = table[table["ambient_degC"] == warmest].set_index(same)
    rows = []
    for row in table[table["ambient_degC"] < warmest].to_dict("records"):
        key = tuple(row[name] for name in same)
        if key in warm.index:
            of = warm.loc[key]
            ratios = {name: row[name] / of[name] if of[name] else np.nan for name in COLD}
            rows.append({name: row[name] for name in (*same, "ambient_degC")} | ratios)
    return pd.DataFrame(rows)


def _cold_table(result: "EarthquakeResult") -> Table:
    ratios = cold_ratios(result)
    if not len(ratios):
        return make_table(ratios)
    same = [name for name in _keys(ratios) if name != "motion"]

    def _cell(values: "pd.Series[float]") -> Any:
        known = values.dropna()
        if len(values) == 1 or not len(known):
            return known.iloc[0] if len(known) else ""
        return f"{known.mean():.2f} ({known.min():.2f}–{known.max():.2f})"

    frame = ratios.groupby(same, sort=False)[list(COLD)].agg(_cell).reset_index()
    columns = [quantity(name, unit="", factor=1.0, form=".2f") for name in COLD]
    warmest = f"{result.table['ambient_degC'].max():g}".replace("-", "\N{MINUS SIGN}")
    motions = ratios["motion"].nunique()
    of = f", mean over {motions} motions (lowest–highest)" if motions > 1 else ""
    caption = f"Effect of low temperature: peaks relative to those at {warmest} °C{of}"
    return make_table(frame, [*same, *columns], caption, keys=len(same))


def _parts_table(result: "EarthquakeResult", part: str, most: int | None = None) -> Table:
    """Return a row for each run and line or pier; of more than `most`, the largest of all runs."""
    frame = result.lines if part == "line" else result.piers
    caption = "Every bearing line in each run" if part == "line" else "Every pier in each run"
    if not len(frame) or frame[part].nunique() < 2:
        return make_table(pd.DataFrame(), caption=caption)
    keys, names = _keys(frame), list(PARTS[part])
    if part == "line" and (frame["line_bearing"] == frame["bearing"]).all():
        names.remove("line_bearing")
    if most is not None and len(frame) > most:
        keys = keys[:1] + (["line_bearing"] if "line_bearing" in names else [])
        names = [name for name in names if name not in (*keys, "line_ambient_degC")]
        caption = f"{part.capitalize()}s: the largest of all runs (each run: {part}s.csv)"
        how: Any = {name: "max" if name.endswith("_degC") else _largest for name in names}
        frame = frame.groupby([part, *keys], sort=False).agg(how).reset_index()
    if "count" in frame:
        frame["count"] = frame["count"].astype(int)
    frame = frame.sort_values(part, kind="stable")
    governing = "strain_max" if part == "line" else "displacement_max_mm"
    columns = [part, *keys, *names]
    table = make_table(frame, columns, caption, keys=1 + len(keys), governing=governing)
    return table.merged(part)


def modes_frame(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return real-time tests over pseudo-dynamic ones: a row per bearing, motion, temperature.

    Ratios of peaks, energy and rises of temperature; empty unless both modes were run.
    """
    table = result.table
    rows: list[dict[str, Any]] = []
    if not {FAST, SLOW} <= set(result.modes):
        return pd.DataFrame(rows)
    for key, pair in table.groupby(["bearing", "motion", "ambient_degC"], sort=False):
        runs = dict(zip(pair["mode"].tolist(), pair.index.tolist(), strict=True))
        if not {FAST, SLOW} <= set(runs):  # interrupted
            continue
        fast, slow = (table.loc[runs[mode]].to_dict() for mode in (FAST, SLOW))
        row: dict[str, Any] = dict(zip(measures.KEYS[:3], key, strict=True))
        for name, column in RATIOS.items():
            row[f"{name}_ratio"] = _over(fast[column], slow[column])
        rises = {mode: result.rises(run) for mode, run in runs.items()}
        for place, rise in rises[FAST].items():
            row[f"{place}_rise_rt_K"], row[f"{place}_rise_pd_K"] = rise, rises[SLOW][place]
            row[f"{place}_rise_ratio"] = _over(rise, rises[SLOW][place])
        rows.append(row)
    return pd.DataFrame(rows)


def _over(fast: float, slow: float) -> float:
    return fast / slow if slow else np.nan


def _loops_table(result: "EarthquakeResult") -> Table:
    frame = result.by_direction()
    keys = _keys(frame)
    note = "Loop with the largest displacement, between two zeros of the displacement: K_eq = "
    note += "(|F+| + |F−|)/(|D+| + |D−|), h_eq and G_e as in a test (Eq. 3.1, 3.2)."
    caption = f"Largest loop of one bearing{_reported_line(result)} in each run"
    loop = list(measures.LOOP)
    names = [*loop[4:7], *loop[2:4], *loop[:2], *loop[7:]]
    closed = frame[frame["loop_K_eq_kN_mm"].notna()]
    return make_table(closed, [*keys, *names], caption, keys=len(keys), note=note)


def _periods_table(result: "EarthquakeResult") -> Table:
    """Return periods and damping ratios with equivalent stiffness; empty without a run."""
    attrs = result.dataset.attrs
    if "periods_s" not in attrs:
        return make_table(pd.DataFrame())
    frame = pd.DataFrame({"period_s": np.atleast_1d(attrs["periods_s"])})
    frame["damping_ratio"] = np.atleast_1d(attrs["damping_ratios"])
    frame.insert(0, "mode_number", range(1, len(frame) + 1))
    period = quantity("period_s", head="Period, equivalent stiffness", form=".3f")
    columns: list[str | Quantity] = ["mode_number", period]
    columns.append(quantity("damping_ratio", head="Viscous damping ratio"))
    for name in dict.fromkeys(result["bearing"].values.tolist()):
        frame[name] = np.atleast_1d(attrs[f"initial_periods_s:{name}"])
        columns.append(replace(period, name=name, head=f"Initial period, {name}"))
    note = "Initial periods use the stiffness of the bearings before yielding, at the temperature "
    note += "of the first run."
    caption = "Natural periods and viscous damping"
    if result.directions and not result.in_plan:
        caption += f" along {result.directions[0]}"
    return make_table(frame, columns, caption, note=note)


def balance_table(result: "EarthquakeResult", *, bearing: bool = False) -> Table:
    """Return the energy balance of the structure, or of one bearing, at the end of each run."""
    energy, keys = result.energy, _keys(result.table)
    frame = pd.concat([result.table[keys], energy], axis=1)
    if bearing:
        names = [f"bearing_{name}_kN_mm" for name in measures.BEARING]
        names += ["mechanical_residual", "thermal_residual"]
        caption = f"Energy balance of one bearing{_reported_line(result)}"
        note = "Work in = heat released + recoverable; heat released = stored + lost; of a "
        note += "bilinear bearing all heat counts as stored."
    else:
        known = [name for name in measures.STRUCTURE if f"{name}_kN_mm" in energy]
        names = [*(f"{name}_kN_mm" for name in known), "structure_residual"]
        caption = "Energy balance of the structure"
        note = f"Input = {' + '.join(known[1:])} (all bearings); the residual is relative to the "
        note += "input. The balance of one bearing has its own table."
    heads = {"structure_residual": "Residual", "mechanical_residual": "Residual, mech."}
    heads["thermal_residual"] = "Residual, therm."
    return make_table(frame, [*keys, *names], caption, keys=len(keys), heads=heads, note=note)


def errors_table(rows: "pd.DataFrame") -> Table:
    """Return the error of largest size of each earlier model over the runs of each bearing."""
    shown = [name for name in ERRORS if name in rows]
    worst = rows.groupby(["bearing", "model"], sort=False)[shown].agg(_largest).reset_index()
    caption = "Earlier models: the error of largest size in all runs"
    return make_table(worst, ["bearing", "model", *shown], caption, keys=2)


# Earlier models compared with the multi-layer model. Each drives its own motion of the structure:
# temperatures, forces and displacements are compared at equal times, peaks with peaks.
SINGLE, INNER = "single-temperature", "inner layer"
COMPARED = {  # compared with each other [%]: column of the table of a study
    "peak strain %": "bearing_strain_max",
    "energy %": "bearing_energy_kN_mm",
    "pier displacement %": "pier_displacement_max_mm",
    "pier acceleration %": "pier_top_acceleration_max_m_s2",
    "deck acceleration %": "deck_acceleration_max_m_s2",
    "loop K_eq %": "loop_K_eq_kN_mm",
    "loop h_eq %": "loop_h_eq",
}
UNDERESTIMATES = "underestimates inner layer"


def comparison_table(results: "dict[str, EarthquakeResult]") -> "pd.DataFrame":
    """Return the errors of each earlier model, one row per run and model.

    Errors of temperatures [K], of the force [% of the peak], and of peaks and the largest loop
    [%], up to the end of a run that ended early.
    """
    truth = results[REFERENCE]
    table = truth.table
    found = {name: run_keys(other) for name, other in results.items() if name != REFERENCE}
    rows = [
        _errors(truth, run, name, results[name], runs[key])
        for run, key in enumerate(_labels(table))
        for name, runs in found.items()
        if key in runs
    ]
    return pd.DataFrame(rows)


def _labels(table: "pd.DataFrame") -> list[tuple[Hashable, ...]]:
    return [tuple(row) for row in table[_keys(table)].itertuples(index=False)]


def run_keys(result: "EarthquakeResult") -> dict[tuple[Hashable, ...], int]:
    """Return the runs of a result by bearing, motion, ambient temperature and mode."""
    return {key: run for run, key in enumerate(_labels(result.table))}


def _errors(
    truth: "EarthquakeResult", run: int, name: str, other: "EarthquakeResult", its: int
) -> dict[str, Any]:
    expected, found = truth.table.iloc[run], other.table.iloc[its]
    row: dict[str, Any] = {key: expected[key] for key in measures.KEYS if key in expected}
    row |= {"model": name, "outcome": found["outcome"]}
    places, those = truth.places(run), other.places(its)
    length = min(len(places[INNER]), len(those[INNER]))  # of one that ended early
    for place, values in places.items():
        if np.isfinite(values).all():
            row |= temperature_differences(place, those[place][:length], values[:length])
    inner = those[INNER][:length], places[INNER][:length]
    row[f"{INNER} rise K"] = _rise(inner[0]) - _rise(inner[1])
    row[UNDERESTIMATES] = _underestimates(*inner)
    force = [r["bearing_force"].values[k, :length] for r, k in ((other, its), (truth, run))]
    row |= force_differences(force[0].astype(float), force[1].astype(float))
    row |= {label: more(found[column], expected[column]) for label, column in COMPARED.items()}
    return row


def _underestimates(found: Floats, expected: Floats) -> bool:
    """Return whether both the largest rise of a temperature and its mean over the run are lower.

    >>> late = np.array([0.0, 0.0, 3.0])
    >>> _underestimates(late - [0.0, 0.0, 1.0], late)
    True
    >>> _underestimates(late + [0.0, 4.0, -1.0], late)
    False
    """
    return _rise(found) < _rise(expected) and float(np.mean(found - expected)) < 0.0


def _rise(values: Floats) -> float:
    return float((values - values[0]).max())


def verdict(table: "pd.DataFrame") -> str:
    """Return whether a single temperature underestimates the inner layer, in a sentence."""
    mine = table[table["model"] == SINGLE]
    missed = mine[~mine[UNDERESTIMATES].to_numpy(dtype=bool)]
    low, high = mine[f"{INNER} rise K"].min(), mine[f"{INNER} rise K"].max()
    text = (
        f"a single temperature underestimates the inner layer in {len(mine) - len(missed)} of "
        f"{len(mine)} runs: error of its largest rise {low:+.1f} to {high:+.1f} K"
    )
    not_in = [", ".join(str(part) for part in row) for row in missed[_keys(mine)].to_numpy()]
    return f"{text}; not in {'; '.join(not_in)}" if not_in else text
