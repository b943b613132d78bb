"""Tables of an analysis of earthquakes for the console and reports.

Heads, units and formats are in the register (data/quantities/earthquake.toml).
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import gt, or_
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from thermobearing.bearing.undecided import UNDECIDED_OF, band, band_text
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.earthquake import measures
from thermobearing.earthquake.axial import axial_table
from thermobearing.earthquake.motions import rotation_frame
from thermobearing.earthquake.properties.bridge import periods_table
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import MINUS, Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.validity import VALID_UNTIL, stable_rows, with_invalid_marked
from thermobearing.quantities.words import degrees, joined, part_label
from thermobearing.reported import bearing_check_tables
from thermobearing.results.directory import LINES
from thermobearing.results.metrics import BALANCE
from thermobearing.results.ranges import TESTED, rate_clause

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

PEAKS: Final = (  # of a report
    "bearing_strain_max",
    "bearing_force_max_kN",
    "bearing_energy_kN_mm",
    "pier_displacement_max_mm",
    "pier_ductility",
    "pier_moment_max_kN_m",
    "deck_acceleration_max_m_s2",
    "rubber_max_degC",
    "lead_max_degC",
)
CONSOLE: Final = (  # fits a screen of 100 columns; a warning states the damping where it is much
    "bearing_strain_max",
    "bearing_force_max_kN",
    "bearing_energy_kN_mm",
    "energy_of_warmest",
    "pier_displacement_max_mm",
    "pier_ductility",
    "deck_displacement_max_mm",
    "deck_acceleration_max_m_s2",
    "rubber_max_degC",
    "lead_max_degC",
)
SHORT: Final = {  # heads of CONSOLE
    "bearing_force_max_kN": "Force",
    "bearing_energy_kN_mm": "Energy",
    "energy_of_warmest": "Energy ratio",
    "deck_displacement_max_mm": "Deck",
}
BY_DIRECTION: Final = (
    "bearing_strain_max",
    "bearing_force_max_kN",
    "pier_displacement_max_mm",
    "pier_ductility",
    "pier_moment_max_kN_m",
    "deck_displacement_max_mm",
    "deck_acceleration_max_m_s2",
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
    "bearing_strain_max",
    "bearing_force_max_kN",
    "pier_displacement_max_mm",
    "pier_ductility",
    "deck_displacement_max_mm",
    "deck_acceleration_max_m_s2",
    "rubber_rise_K",
    "lead_rise_K",
)
BANDED: Final = (  # of what tests do not decide
    "bearing_strain_max",
    "bearing_force_max_kN",
    "bearing_energy_kN_mm",
    "pier_displacement_max_mm",
)
RULE: Final = 0.3  # share of the other direction
PARTS: Final = {
    "line": (
        "line_bearing",
        "count",
        "line_ambient_degC",
        "strain_max",
        "force_max_kN",
        "total_force_max_kN",
        "rubber_max_degC",
        "lead_max_degC",
    ),
    "pier": (
        "displacement_max_mm",
        "displacement_residual_mm",
        "ductility",
        "moment_max_kN_m",
        "top_acceleration_max_m_s2",
    ),
}
EXTREMES: Final = ("D_plus_mm", "D_minus_mm", "F_plus_kN", "F_minus_kN", "energy_kN_mm")
# Of the largest loop: properties first, then the extremes that give them.
LOOP: Final = [f"loop_{n}" for n in ("K_eq_kN_mm", "h_eq", "G_e_MPa", *EXTREMES)]
MOST_ROWS: Final = 24  # of lines, piers or checks on the console: of more, the largest of all
FAST, SLOW = "rt", "pd"
RATIOS: Final = {  # of a real-time test over the pseudo-dynamic one: column of the table of runs
    "force": "bearing_force_max_kN",
    "strain": "bearing_strain_max",
    "energy": "bearing_energy_kN_mm",
}
RISES: Final = ("outer_layer", "inner_layer", "lead")
ERRORS: Final = (  # columns of comparison.csv on the console
    "inner layer largest K",
    "lead largest K",
    "peak force %",
    "peak strain %",
    "energy %",
    "pier displacement %",
    "loop K_eq %",
)
# Peak: table of an analysis with several lines or piers, column there, column of the table of runs.
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
    return float(measures.signed_peak(values))


def _reported_line(result: "EarthquakeResult") -> str:
    """Return " of line A1", the line whose histories are kept; empty with one of all."""
    return f" of {part_label('line', result.dataset.attrs['line'])}" if result.has_parts else ""


def make_tables(result: "EarthquakeResult") -> dict[str, Table]:
    """Return the tables of results by name; those without a row are left out."""
    return {
        name: _with_all_bearings(table, result.bearing_labels)
        for name, table in _tables(result).items()
    }


def _tables(result: "EarthquakeResult") -> dict[str, Table]:
    """Return the tables of results, with the bearings of the analysis alone."""
    mode_columns = [
        *measures.CONDITIONS,
        *(f"{name}_ratio" for name in RATIOS),
        *(f"{place}_rise_ratio" for place in RISES),
    ]
    tables = {
        "governing": _governing_table(result),
        "peaks": _peaks_table(result),
        "directions": _directions_table(result),
        "components": _components_table(result),
        "bands": _bands_table(result),
        "rotation": _rotation_table(result),
        "cold": _cold_table(result),
        "lines": _parts_table(result, "line"),
        "piers": _parts_table(result, "pier"),
        "axial": axial_table(result.axial),
        "devices": _devices_table(result.devices),
        **bearing_check_tables(result),
        "modes": make_table(
            result.modes_table,
            mode_columns,
            "Real time over pseudo-dynamic",
            keys=len(measures.CONDITIONS),
        ),
        "loops": _loops_table(result),
        "periods": periods_table(result)[0],
        "bearing_balance": _balance_table(result, bearing=True),
    }
    return {name: table for name, table in tables.items() if len(table)}


def _devices_table(rows: "pd.DataFrame") -> Table:
    """Return the peaks and energies of devices; the rise of oil only where it warms."""
    names = [str(name) for name in rows if name != "oil_rise_K" or rows[name].any()]
    return make_table(rows, names, "Devices parallel to the bearings", keys=2)


def _with_all_bearings(table: Table, labels: Mapping[str, str]) -> Table:
    """Return a table that names each bearing of the analysis with those of the other lines."""
    changed = {name: label for name, label in labels.items() if label != name}
    if not changed:
        return table
    # The caption names the bearing where all rows have it, since that column is then left out.
    caption = table.caption
    for name, label in changed.items():
        caption = caption.replace(f"bearing: {name}", f"bearings: {label}")
    places = [place for place, column in enumerate(table.columns) if column.name == "bearing"]
    rows = [list(row) for row in table.rows]
    for row in rows:
        for place in places:
            row[place] = changed.get(str(row[place]), row[place])
    return replace(table, caption=caption, rows=rows)


def console_tables(result: "EarthquakeResult") -> list[Table]:
    """Return the tables of the console: peaks by bearing, the largest of many lines or piers."""
    tables = _tables(result)
    for part in PARTS:
        if f"{part}s" in tables:
            tables[f"{part}s"] = _parts_table(result, part, row_limit=MOST_ROWS)
    bearings = list(dict.fromkeys(result.table["bearing"]))
    # A table for each bearing, unless each has a single run: then one table compares them.
    shown_results = [result]
    if result.runs > len(bearings):
        shown_results = [result.sel(bearing=name) for name in bearings]
    peaks = [_peaks_table(part, CONSOLE, heads=SHORT) for part in shown_results]
    # One note, the longest, stands below the last table for all of them.
    note = max((table.note for table in peaks), key=len)
    shown = [replace(table, note="") for table in peaks[:-1]] + [replace(peaks[-1], note=note)]
    last = "directions", "components", "rotation", "modes", "lines", "piers", "devices", "governing"
    shown += [tables[name] for name in last if name in tables]
    for name, table in bearing_check_tables(result, every_part=False).items():
        shown.append(tables[name] if len(tables[name]) <= MOST_ROWS else table)
    ratios = tables.get("components")  # means, which two temperatures may share by chance
    merged = [table if table is ratios else table.merged("ambient_degC") for table in shown]
    return [_with_all_bearings(table, result.bearing_labels) for table in merged]


def _peaks_table(
    result: "EarthquakeResult",
    names: tuple[str, ...] = PEAKS,
    heads: Mapping[str, str] | None = None,
) -> Table:
    """Return the peaks of every run, marked where they leave the calibration range."""
    hottest = [result.hottest(run) for run in range(result.runs)]
    frame = result.table.assign(
        rubber_max_degC=[temperatures["rubber"] for temperatures in hottest],
        lead_max_degC=[temperatures["lead"] for temperatures in hottest],
    )
    # A pier that cannot move has an empty cell, and a column of empty cells is left out.
    frame["pier_displacement_max_mm"] = frame["pier_displacement_max_mm"].replace(0.0, np.nan)
    if frame["ambient_degC"].nunique() < 2 or frame["energy_of_warmest"].isna().all():
        frame = frame.drop(columns="energy_of_warmest")
    keys = measures.key_columns(frame)
    place_columns: list[str] = []
    if names == PEAKS:  # the screen has no room for them
        place_columns = [n for n in measures.PLACES if n in frame and frame[n].nunique() > 1]
    ended = ["outcome"] if (frame["outcome"] != "completed").any() else []
    ended += [VALID_UNTIL] if VALID_UNTIL in frame else []
    frame["outcome"] = frame["outcome"].str.replace("_", " ")
    limits = [str(text).split() for text in frame["beyond_tested"]]
    columns = {"ambient": "ambient_degC", "strain": "bearing_strain_max"}
    if frame["lead_max_degC"].notna().any():
        columns["lead_temperature"] = "lead_max_degC"
    marked = {name: [limit in passed for passed in limits] for limit, name in columns.items()}
    # What has no column marks the motion; the strain rate does not, as the note says.
    other_limits = {limit for passed in limits for limit in passed} - {*columns, "strain_rate"}
    marked["motion"] = [bool(other_limits.intersection(passed)) for passed in limits]
    elsewhere = measures.strained_elsewhere(result)
    if any(elsewhere):  # the strain of another line than the one with the largest
        marked["bearing_strain_max"] = list(map(gt, marked["bearing_strain_max"], elsewhere))
        marked["motion"] = list(map(or_, marked["motion"], elsewhere))
    causes = sorted(TESTED[limit][1] for limit in other_limits)
    if any(elsewhere):
        causes.append("strain of other lines")
    sentences = _peaks_sentences(result, frame, names)
    if any(any(flags) for flags in marked.values()):
        of_motion = f" (a marked motion: {', '.join(causes)})" if causes else ""
        other = "Other marked" if VALID_UNTIL in frame else "Marked"
        rates = rate_clause(measures.tested_rows(result))
        of_motion += f"; {rates}, are not marked" if rates else ""
        sentences.append(f"{other} values are outside the calibration range{of_motion}.")
    at_specimen = f", specimen at {text}" if (text := result.dataset.attrs.get("specimen")) else ""
    table = make_table(
        frame,
        [*keys, *names, *place_columns, *ended],
        f"Peaks of every run{at_specimen}",
        keys=len(keys),
        heads={"outcome": "Ended"} | dict(heads or {}),
        marked=marked,
        note=" ".join(sentences),
        governing="bearing_strain_max",
    )
    return with_invalid_marked(table, frame, names)


def _peaks_sentences(
    result: "EarthquakeResult", frame: "pd.DataFrame", names: Sequence[str]
) -> list[str]:
    """Return what the columns of peaks refer to, for the note below them."""
    has_pier = frame["pier_displacement_max_mm"].notna().any()
    of_pier = "the displacement of the pier top is relative to its base, " if has_pier else ""
    sentences = [
        f"Force and energy are those of one bearing; {of_pier}the acceleration of the deck "
        "absolute; rubber and lead: highest temperature."
    ]
    if "energy_of_warmest" in names and "energy_of_warmest" in frame:
        same = " of the same line" * result.has_parts
        sentences.append(f"The energy ratio is relative to the warmest run{same}.")
    if result.has_parts:
        sentences.append(f"Every peak is the largest of all {joined(_plurals(result))}.")
    return sentences


def _directions_table(result: "EarthquakeResult") -> Table:
    """Return the largest of all motions in each direction and of the resultant; empty in one."""
    frame = result.by_direction() if result.in_plan else pd.DataFrame()
    caption = "Peaks in each direction and of the resultant, the largest of all motions"
    if not len(frame):
        return make_table(frame, caption=caption)
    keys = [name for name in measures.key_columns(frame) if name != "motion"]
    columns = [name for name in (*measures.COLUMNS, VALID_UNTIL) if name in frame]
    frame = frame.groupby(keys, sort=False)[columns].agg(_largest).reset_index()
    by_run = [name for name in keys if name != measures.DIRECTION]
    frame = frame.sort_values(by_run, kind="stable")  # directions of a run next to each other
    note = (
        "x: along the bridge, y: across it. The resultant combines x and y at the same time, so it "
        "may be less than that of their peaks; for hinges it is the larger of x and y."
    )
    table = make_table(frame, [*keys, *BY_DIRECTION], caption, keys=len(keys), note=note)
    return with_invalid_marked(table, frame, BY_DIRECTION)


def rotation_measures_frame(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return RotD50 and RotD100 of the peaks of motions at several angles; see `rotation_frame`."""
    motions = tomllib.loads(str(result.dataset.attrs["case"]))["motions"]
    runs = result.by_direction()
    labels = [name for name in measures.key_columns(runs) if name != "motion"]
    return rotation_frame(runs, motions, labels, BY_DIRECTION)


def _rotation_table(result: "EarthquakeResult") -> Table:
    """Return the measures of motions at several angles; empty without one."""
    frame = rotation_measures_frame(result)
    caption = "Peaks over the angles of a motion: median (RotD50) and largest (RotD100)"
    extra_keys = Quantity("Angles", form="d", name="angles"), Quantity("Measure", name="measure")
    keys: list[str | Quantity] = [*measures.key_columns(frame), *extra_keys]
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
    keys = list(measures.CONDITIONS)
    joint_peaks = {
        name: _peaks_by_run(result.sel(direction=name), keys) for name in measures.DIRECTIONS
    }
    single_peaks = {
        name: _peaks_by_run(single.sel(direction=name), keys) for name in single.directions
    }
    runs, none = joint_peaks["x"].index, pd.DataFrame(columns=joint_peaks["x"].columns, dtype=float)
    x, y = (single_peaks.get(name, none).reindex(runs) for name in measures.AXES)
    # A motion without a component across is not run in y: its peaks there are zero, not unknown.
    not_run = (
        ~runs.isin(single_peaks["y"].index)
        if "y" in single_peaks
        else np.ones(len(runs), dtype=bool)
    )
    y.loc[not_run, list(COMPARED_PEAKS)] = 0.0
    parts = []
    for name in COMPARED_PEAKS:
        combinations = _combined(x[name].to_numpy(float), y[name].to_numpy(float))
        # Hinges have no resultant, and rises of temperature no direction.
        if name.startswith("pier_ductility"):
            combinations = {key: combinations[key] for key in ("x", "y", "larger")}
        elif name.endswith("_K"):
            combinations = {"larger": combinations["larger"]}
        for key, values in combinations.items():
            direction = key if key in measures.DIRECTIONS else measures.RESULTANT
            two_components = joint_peaks[direction][name].to_numpy()
            frame = pd.DataFrame({"one_component": values, "two_components": two_components})
            divisor = frame["one_component"].replace(0.0, np.nan)
            frame["two_over_one"] = frame["two_components"] / divisor
            frame.insert(0, "combination", key)
            frame.insert(0, "quantity", name)
            parts.append(pd.concat([runs.to_frame(index=False), frame], axis=1))
    table = pd.concat(parts, ignore_index=True)
    return table[table["two_over_one"].notna()].reset_index(drop=True)


def _peaks_by_run(result: "EarthquakeResult", keys: list[str]) -> "pd.DataFrame":
    table = pd.concat([result.table, result.largest_rises()], axis=1).set_index(keys)
    columns = list(COMPARED_PEAKS)
    table[columns] = table[columns].astype(float)
    table.loc[table["outcome"] != "completed", columns] = np.nan
    return table


def components_summary(frame: "pd.DataFrame") -> "pd.DataFrame":
    """Return mean, lowest and highest ratio over the motions of `components_frame`."""
    keys = ["bearing", "ambient_degC", "quantity", "combination"]
    ratios = frame.groupby(keys, sort=False)["two_over_one"].agg(["mean", "min", "max"])
    return ratios.reset_index()


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
    note = (
        "Along and across: the peak of that direction over that of its analysis with one "
        "component. The others: the resultant over what the two analyses are combined to (the "
        "larger one; 100 % of one with 30 % of the other; the root of the sum of squares)."
    )
    return make_table(rows, [*keys, *columns], caption, keys=3, note=note)


def changes_by_run(
    result: "EarthquakeResult", alternative: "EarthquakeResult", undecided: str
) -> list[dict[str, Any]]:
    """Return the relative changes of peaks and energy with an alternative, a row for each run.

    `undecided` is what tests do not decide. Runs that ended early are left out.
    """
    keys, rows = measures.key_columns(result.table), []
    before, after = (
        runs.table[runs.table["outcome"] == "completed"].set_index(keys)
        for runs in (result, alternative)
    )
    for run in after.index.intersection(before.index):
        row = dict(zip(keys, run, strict=True)) | {"undecided": undecided}
        for name in BANDED:
            base = float(before.loc[run, name])
            row[name] = float(after.loc[run, name]) / base - 1.0 if base else np.nan
        rows.append(row)
    return rows


def bands_frame(rows: list[dict[str, Any]]) -> "pd.DataFrame":
    """Return the bands of `changes_by_run` over motions and alternatives, a row for each quantity.

    The analysis itself, without a change, is part of each band.
    """
    frame, bands = pd.DataFrame(rows), []
    keys = ["bearing", "ambient_degC", "undecided", UNDECIDED_OF]
    for key, group in frame.groupby(keys, sort=False) if len(frame) else ():
        for name in BANDED:
            if group[name].notna().any():
                low, high = band(group[name])
                row = dict(zip(keys, key, strict=True)) | {"quantity": name}
                bands.append(row | {"lowest": low, "highest": high})
    return pd.DataFrame(bands)


def _bands_table(result: "EarthquakeResult") -> Table:
    """Return what tests do not decide, as bands of each quantity; empty if it was not analysed."""
    frame, caption = result.bands, "What tests do not decide: change of the largest values"
    if not len(frame):
        return make_table(frame, caption=caption)
    keys = ["bearing", "ambient_degC", "undecided"]
    if UNDECIDED_OF in frame and not (frame[UNDECIDED_OF] == frame["bearing"]).all():
        keys.append(UNDECIDED_OF)  # lines have their own bearings
    pairs = zip(frame["lowest"], frame["highest"], strict=True)
    frame = frame.assign(text=[band_text(*pair).replace("-", MINUS) for pair in pairs])
    pivoted = frame.pivot_table("text", keys, "quantity", aggfunc="first", sort=False).reset_index()
    columns = [quantity(name, unit="", form="") for name in BANDED if name in pivoted]
    note = (
        "rate: the range of the factor on the rate branch (rate_band of the bearing); small loops: "
        "with the other law of small reversals, published or closed."
    )
    return make_table(pivoted, [*keys, *columns], caption, keys=len(keys), note=note)


def _plurals(result: "EarthquakeResult") -> list[str]:
    return [f"{kind}s" for kind in result.part_kinds]


def governing_runs(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return the largest of every peak over all (stable) runs, lines and piers of each bearing."""
    rows = []
    runs = result.table
    parts = {"": pd.DataFrame(), "line": result.lines, "pier": result.piers}
    for bearing in dict.fromkeys(runs["bearing"]):
        for peak, (part, part_column, run_column) in GOVERNED.items():
            # Of one line and one pier there are no tables of parts: the table of runs has the peak.
            several = len(parts[part]) > 0
            table, column = (parts[part], part_column) if several else (runs, run_column)
            candidates = stable_rows(table[table["bearing"] == bearing])
            if column not in candidates or not candidates[column].notna().any():
                continue
            worst = candidates.iloc[place_of_largest(candidates[column])]
            row = {"bearing": bearing, "what": peak, "largest": float(worst[column])}
            row |= {"part": str(worst[part]) if several else "", "motion": str(worst["motion"])}
            row |= {VALID_UNTIL: float(worst[VALID_UNTIL])} if VALID_UNTIL in worst else {}
            rows.append(row | {"ambient_degC": float(worst["ambient_degC"])})
    return pd.DataFrame(rows)


def _governing_table(result: "EarthquakeResult") -> Table:
    """Return the largest of all runs, lines and piers; empty for one run of one line."""
    frame = governing_runs(result)
    caption = f"The largest of all {joined(['runs', *_plurals(result)])}"
    if not len(frame) or (result.runs < 2 and not result.has_parts):
        return make_table(pd.DataFrame(), caption=caption)
    kinds = frame["what"].tolist()
    frame.loc[frame["what"] == "bearing strain", "largest"] *= 100.0
    words = frame["what"].replace("bearing strain", "bearing strain [%]")
    frame["what"] = [f"{text[:1].upper()}{text[1:]}".replace("deg", "°") for text in words]
    lines = result.line_bearings
    frame["part"] = [
        f"{part} ({lines[bearing][part]})"
        if GOVERNED[peak][0] == "line" and part and lines
        else part
        for bearing, peak, part in zip(frame["bearing"], kinds, frame["part"], strict=True)
    ]
    names = ["bearing", "what", "largest", "part", "motion", "ambient_degC"]
    head = " or ".join(result.part_kinds).capitalize()
    table = make_table(frame, names, caption, keys=2, heads={"part": head})
    return with_invalid_marked(table, frame, ["largest"])


def _cold_table(result: "EarthquakeResult") -> Table:
    ratios = measures.cold_ratios(result)
    if not len(ratios):
        return make_table(ratios)
    keys = [n for n in (*measures.key_columns(ratios), "line_bearing") if n in ratios]
    keys.remove("motion")

    def _cell(group: "pd.DataFrame", name: str) -> Any:
        finite, mean = group[name].dropna(), measures.ratio_of_means(group, name)
        if len(group) == 1 or not len(finite):
            return mean if len(finite) else ""
        return f"{mean:.2f} ({finite.min():.2f}–{finite.max():.2f})"

    groups = ratios.groupby(keys, sort=False)
    cells = {name: [_cell(group, name) for _, group in groups] for name in measures.COLD}
    frame = groups[keys].first().reset_index(drop=True).assign(**cells)
    columns = [quantity(name, unit="", factor=1.0, form=".2f") for name in measures.COLD]
    warmest, count = degrees([result.table["ambient_degC"].max()]), ratios["motion"].nunique()
    means = f"means over {count} motions (lowest–highest of one) of " if count > 1 else ""
    caption = f"Effect of low temperature: {means}peaks relative to those at {warmest}"
    of_lines = "Strain, force and energy" if "line_bearing" in ratios else "Energy"
    note = f"{of_lines}: means over the lines of a bearing." if len(result.lines) else ""
    return make_table(frame, [*keys, *columns], caption, keys=len(keys), note=note)


def _parts_table(result: "EarthquakeResult", part: str, row_limit: int | None = None) -> Table:
    """Return a row for each run and line or pier; beyond `row_limit`, the largest of all runs."""
    frame = result.lines if part == "line" else result.piers
    caption = "Every bearing line in each run" if part == "line" else "Every pier in each run"
    if not len(frame) or frame[part].nunique() < 2:
        return make_table(pd.DataFrame(), caption=caption)
    keys, names = measures.key_columns(frame), list(PARTS[part])
    if part == "line" and (frame["line_bearing"] == frame["bearing"]).all():
        names.remove("line_bearing")
    if row_limit is not None and len(frame) > row_limit:
        keys = ["bearing", *(["line_bearing"] if "line_bearing" in names else [])]
        names = [name for name in names if name not in (*keys, "line_ambient_degC")]
        caption = f"{part.capitalize()}s: the largest of all runs (each run: {part}s.csv)"
        # -20 degC is larger in size than 10 degC but not the highest temperature.
        moments = [VALID_UNTIL] if VALID_UNTIL in frame else []
        aggregates: Any = {
            name: "max" if name.endswith("_degC") else _largest for name in (*names, *moments)
        }
        frame = frame.groupby([part, *keys], sort=False).agg(aggregates).reset_index()
    if "count" in frame:
        frame["count"] = frame["count"].astype(int)
    frame = frame.sort_values(part, kind="stable")
    governing = "strain_max" if part == "line" else "displacement_max_mm"
    columns = [part, *keys, *names]
    note = _residual_note(frame) if part == "pier" else ""
    options: Any = {"keys": 1 + len(keys), "governing": governing, "note": note}
    table = make_table(frame, columns, caption, **options)
    labels = "line_bearing", "count", "line_ambient_degC"
    return with_invalid_marked(table, frame, {*names} - {*labels}).merged(part)


def _residual_note(piers: "pd.DataFrame") -> str:
    """Return what holds elastic piers, also those without a hinge, away from their position."""
    elastic = piers[~(piers["ductility"] > 1.0)]
    if not elastic["displacement_residual_mm"].abs().any():
        return ""
    return "The residual displacement of an elastic pier is that under the force of its bearings."


def modes_frame(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return real-time tests over pseudo-dynamic ones: a row per bearing, motion, temperature.

    Ratios of peaks, energy and rises of temperature; empty unless both modes were run.
    """
    table = result.table
    rows: list[dict[str, Any]] = []
    if not {FAST, SLOW} <= set(result.modes):
        return pd.DataFrame(rows)
    for key, pair in table.groupby(list(measures.CONDITIONS), sort=False):
        runs = dict(zip(pair["mode"].tolist(), pair.index.tolist(), strict=True))
        if not {FAST, SLOW} <= set(runs):  # interrupted
            continue
        fast, slow = (table.loc[runs[mode]].to_dict() for mode in (FAST, SLOW))
        row: dict[str, Any] = dict(zip(measures.CONDITIONS, key, strict=True))
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
    keys = measures.key_columns(frame)
    note = (
        "Loop with the largest displacement, between two zeros of the displacement: K_eq = "
        "(|F+| + |F−|)/(|D+| + |D−|), h_eq and G_e as in a test (Eq. 3.1, 3.2). K_eff of the "
        "equivalent properties differs: it is of a symmetric loop at the design displacement."
    )
    note += f" Peaks of each line are in {LINES}." if result.has_parts else ""
    caption = f"Largest loop of one bearing{_reported_line(result)} in each run"
    closed = measures.with_partial_loops(frame[frame["loop_K_eq_kN_mm"].notna()])
    if len(closed) < len(frame):
        places = frame.drop(closed.index)[keys].astype(str).agg("; ".join, axis=1)
        note = f"{note} Without a row, since the loop does not close: {joined(places)}."
    note += measures.PARTIAL_NOTE * bool(closed["loop"].any())
    table = make_table(closed, [*keys, "loop", *LOOP], caption, keys=len(keys), note=note)
    return with_invalid_marked(table, closed, LOOP)


def structure_balance(result: "EarthquakeResult") -> Table:
    """Return the energy balance of the structure, with the bearings of all lines in its caption."""
    return _with_all_bearings(_balance_table(result), result.bearing_labels)


def _balance_table(result: "EarthquakeResult", *, bearing: bool = False) -> Table:
    """Return the energy balance of the structure, or of one bearing, at the end of each run."""
    energy, keys = result.energy, measures.key_columns(result.table)
    frame = pd.concat([result.table[keys], energy], axis=1)
    if bearing:
        names = [f"bearing_{name}_kN_mm" for name in BALANCE]
        names += ["mechanical_residual", "thermal_residual"]
        caption = f"Energy balance of one bearing{_reported_line(result)}"
        note = (
            "Work in = heat released + recoverable; heat released = stored + lost; of a "
            "bilinear bearing all heat counts as stored."
        )
    else:
        energies = [name for name in measures.STRUCTURE if f"{name}_kN_mm" in energy]
        names = [*(f"{name}_kN_mm" for name in energies), "structure_residual"]
        caption = "Energy balance of the structure"
        absorbed = " + ".join(name for name in energies if name != "input")
        note = f"Input = {absorbed} (all bearings); the residual is relative to the input. "
        note += "The balance of one bearing has its own table."
    heads = {
        "structure_residual": "Residual",
        "mechanical_residual": "Residual, mech.",
        "thermal_residual": "Residual, therm.",
    }
    return make_table(frame, [*keys, *names], caption, keys=len(keys), heads=heads, note=note)


def errors_table(rows: "pd.DataFrame") -> Table:
    """Return the error of largest size of each earlier model over the runs of each bearing."""
    shown = [name for name in ERRORS if name in rows]
    worst = rows.groupby(["bearing", "model"], sort=False)[shown].agg(_largest).reset_index()
    caption = "Earlier models: the error of largest size in all runs"
    return make_table(worst, ["bearing", "model", *shown], caption, keys=2)
