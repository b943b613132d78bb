"""Tables and interactive figures in the report of an analysis of earthquakes."""

from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
import pandas as pd

from thermobearing.earthquake.figures import describe_all
from thermobearing.earthquake.measures import STRUCTURE
from thermobearing.earthquake.modes import has_both, modes_table
from thermobearing.earthquake.parts import governing_runs, has_parts, told_of_parts
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.report.content import (
    MARKED,
)
from thermobearing.report.figures import POINTS, history, path, rounded
from thermobearing.report.pieces import Column, Plot, ReportFigure, ReportTable, Trace
from thermobearing.report.words import degrees, plain
from thermobearing.results import drawing
from thermobearing.results.drawing import Floats
from thermobearing.results.ranges import TESTED

KJ = 1e-3
KEYS = {
    "bearing": Column("Bearing"),
    "motion": Column("Motion"),
    "ambient_degC": Column("Ambient", "°C", "g"),
    "mode": Column("Mode"),
}
PEAKS = {  # column of the table: head, factor
    "bearing_strain_max": (Column("Strain", "%", ".0f"), 100.0),
    "bearing_force_max_kN": (Column("Force of one", "kN", ".0f"), 1.0),
    "bearing_energy_kN_mm": (Column("Energy of one", "kJ", ".1f"), KJ),
    "pier_displacement_max_mm": (Column("Pier top", "mm", ".1f"), 1.0),
    "pier_ductility": (Column("Ductility", "", ".2f"), 1.0),
    "pier_moment_max_kN_m": (Column("Pier moment", "kN m", ".0f"), 1.0),
    "deck_acceleration_max_m_s2": (Column("Deck", "m/s²", ".2f"), 1.0),
}
PLACES = {  # of the governing line or pier: head
    "strain_line": Column("Line, strain"),
    "force_line": Column("Line, force"),
    "displacement_pier": Column("Pier, top"),
    "ductility_pier": Column("Pier, ductility"),
}
HOTTEST = {"rubber": Column("Rubber", "°C", ".1f"), "lead": Column("Lead", "°C", ".1f")}
COLD = {  # of the warmest: column of the table, head
    "bearing_strain_max": "Strain",
    "bearing_force_max_kN": "Force",
    "bearing_energy_kN_mm": "Energy",
    "pier_displacement_max_mm": "Pier top",
    "deck_acceleration_max_m_s2": "Deck acceleration",
}
LOOP = {
    "K_eq_kN_mm": (Column("K_eq", "kN/mm", ".3f"), 1.0),
    "h_eq": (Column("h_eq", "", ".3f"), 1.0),
    "G_e_MPa": (Column("G_e", "MPa", ".3f"), 1.0),
    "D_plus_mm": (Column("D+", "mm", ".1f"), 1.0),
    "D_minus_mm": (Column("D−", "mm", ".1f"), 1.0),
    "F_plus_kN": (Column("F+", "kN", ".0f"), 1.0),
    "F_minus_kN": (Column("F−", "kN", ".0f"), 1.0),
    "energy_kN_mm": (Column("Energy", "kJ", ".1f"), KJ),
}
PARTS = {
    "line": {
        "line_bearing": (Column("Bearing of the line"), 1.0),
        "count": (Column("Bearings", form="d"), 1),
        "line_ambient_degC": (Column("Its air", "°C", "g"), 1.0),
        "strain_max": (Column("Strain", "%", ".0f"), 100.0),
        "force_max_kN": (Column("Force of one", "kN", ".0f"), 1.0),
        "total_force_max_kN": (Column("Force of all", "kN", ".0f"), 1.0),
        "rubber_max_degC": (Column("Rubber", "°C", ".1f"), 1.0),
        "lead_max_degC": (Column("Lead", "°C", ".1f"), 1.0),
    },
    "pier": {
        "displacement_max_mm": (Column("Top", "mm", ".1f"), 1.0),
        "displacement_residual_mm": (Column("Left", "mm", ".2f"), 1.0),
        "ductility": (Column("Ductility", "", ".2f"), 1.0),
        "moment_max_kN_m": (Column("Moment", "kN m", ".0f"), 1.0),
        "top_acceleration_max_m_s2": (Column("Acceleration of the top", "m/s²", ".2f"), 1.0),
    },
}
RATIOS = {
    "force_ratio": "Force",
    "strain_ratio": "Strain",
    "energy_ratio": "Energy",
    "outer_layer_rise_ratio": "Rise, outer layer",
    "inner_layer_rise_ratio": "Rise, inner layer",
    "lead_rise_ratio": "Rise, lead",
}


def report_tables_by_name(result: EarthquakeResult) -> dict[str, ReportTable]:
    """Tables of what came out, by name."""
    found = {
        "governing": _governing_table(result),
        "peaks": _peaks_table(result),
        "cold": cold_table(result),
        "lines": parts_table(result, "line"),
        "piers": parts_table(result, "pier"),
        "modes": _ratios_table(result),
        "loops": _loops_table(result),
        "periods": _periods_table(result),
        "bearing_books": bearing_books(result),
    }
    return {name: table for name, table in found.items() if table is not None}


def _keys(table: pd.DataFrame) -> list[str]:
    return [name for name in KEYS if name in table]


def _line(result: EarthquakeResult) -> str:
    """Return " of line A1", the line whose histories are kept; empty with one of all."""
    return f" of line {result.dataset.attrs['line']}" if len(result.lines) else ""


def _told(table: pd.DataFrame, columns: Sequence[str]) -> list[str]:
    """Those that some run has."""
    return [name for name in columns if name in table and table[name].notna().any()]


def _governing_table(result: EarthquakeResult) -> ReportTable | None:
    """Return the largest of all runs, lines and piers, a column a bearing; None for one run."""
    governing = governing_runs(result).to_dict("records")
    if result.runs < 2 and not len(result.lines):
        return None
    bearings = list(dict.fromkeys(row["bearing"] for row in governing))
    found: dict[str, dict[str, list[Any]]] = {}
    for row in governing:
        what, _, unit = str(row["what"]).removesuffix("]").partition(" [")
        value, form, unit = row["largest"], ".4g", plain(unit and f" {unit}").strip()
        if what == "bearing strain":
            value, form, unit = 100.0 * value, ".0f", "%"
        air = degrees([row["ambient_degC"]])
        where = ", ".join(part for part in (row["part"], row["motion"], air) if part)
        key = f"{what[:1].upper()}{what[1:]}" + (f" [{unit}]" if unit else "")
        found.setdefault(key, {})[row["bearing"]] = [float(format(value, form)), where]
    columns = [Column("Largest of all runs")]
    for name in bearings:
        columns += [Column(name, form="g"), Column("Where")]
    rows = [
        [what, *(cell for name in bearings for cell in cells.get(name, ["", ""]))]
        for what, cells in found.items()
    ]
    return ReportTable(
        "The largest of all runs, lines and piers, and where it occurs", columns, rows
    )


def _peaks_table(result: EarthquakeResult) -> ReportTable:
    """Largest value of everything that counts, a row a run."""
    table, keys = result.table, _keys(result.table)
    names = _told(table, list(PEAKS))
    where = [name for name in PLACES if name in table and table[name].nunique() > 1]
    hottest = [result.hottest(run) for run in range(result.runs)]
    warm = [name for name in HOTTEST if any(np.isfinite(one[name]) for one in hottest)]
    columns = [*(KEYS[key] for key in keys), *(PEAKS[name][0] for name in names)]
    columns += [HOTTEST[name] for name in warm] + [PLACES[name] for name in where]
    ended = (table["outcome"] != "completed").any()
    columns += [Column("Ended")] if ended else []
    places = {"ambient": keys.index("ambient_degC")}
    places |= {"strain": len(keys) + names.index("bearing_strain_max")}
    if "lead" in warm:
        places["lead_temperature"] = len(keys) + len(names) + warm.index("lead")
    rows, marked, others = [], set(), set()
    for run, row in enumerate(table.to_dict("records")):
        cells = [row[key] for key in keys] + [PEAKS[name][1] * row[name] for name in names]
        cells += [hottest[run][name] for name in warm] + [row[name] for name in where]
        rows.append([*cells, *([row["outcome"].replace("_", " ")] if ended else [])])
        for limit in str(row["beyond_tested"]).split():
            if limit in places:
                marked.add((run, places[limit]))
            elif (
                limit != "strain_rate"
            ):  # no column of its own: the run is marked where its name ends
                marked.add((run, keys.index("motion")))
                others.add(TESTED[limit][1])
    note = "Force, energy: of one bearing. Pier top: relative to its base. Deck: absolute "
    note += "acceleration. Rubber, lead: highest temperature."
    if len(result.lines):
        note += " Every peak is the largest of all lines and piers, which follow line by line."
    if marked:
        note += f" {MARKED}" + (f" (a motion: {', '.join(sorted(others))})." if others else ".")
    return ReportTable("Peaks of every run", columns, rows, len(keys), frozenset(marked), note)


def cold_ratios(result: EarthquakeResult) -> pd.DataFrame:
    """Peaks of each run over those at the warmest air, same bearing, motion and mode."""
    table = result.table
    table = table[table["outcome"] == "completed"]
    same = [name for name in ("bearing", "motion", "mode") if name in table]
    if table["ambient_degC"].nunique() < 2:
        return pd.DataFrame()
    warmest = float(table["ambient_degC"].max())
    warm = table[table["ambient_degC"] == warmest].set_index(same)
    cold = table[table["ambient_degC"] < warmest]
    rows = []
    for row in cold.to_dict("records"):
        key = tuple(row[name] for name in same)
        if key not in warm.index:
            continue
        of = warm.loc[key]
        ratios = {name: row[name] / of[name] if of[name] else np.nan for name in COLD}
        rows.append({name: row[name] for name in (*same, "ambient_degC")} | ratios)
    return pd.DataFrame(rows)


def cold_table(result: EarthquakeResult) -> ReportTable | None:
    """What the cold changes: mean over the motions, lowest and highest; None without cold."""
    ratios = cold_ratios(result)
    if not len(ratios):
        return None
    warmest = f"{result.table['ambient_degC'].max():g}".replace("-", "\N{MINUS SIGN}")
    same = [name for name in ("bearing", "ambient_degC", "mode") if name in ratios]
    rows = []
    for key, group in ratios.groupby(same, sort=False):
        several = len(group) > 1
        cells: list[Any] = list(key)
        for name in COLD:
            values = group[name].dropna()
            if not len(values):
                cells.append("")
            elif several:
                cells.append(f"{values.mean():.2f} ({values.min():.2f}–{values.max():.2f})")
            else:
                cells.append(float(values.iloc[0]))
        rows.append(cells)
    columns = [KEYS[name] for name in same] + [Column(head, "", ".2f") for head in COLD.values()]
    motions = ratios["motion"].nunique()
    of = f", mean over {motions} motions (lowest–highest)" if motions > 1 else ""
    caption = f"The cold: peaks over those at {warmest} °C{of}"
    return ReportTable(caption, columns, rows, len(same))


def _loops_table(result: EarthquakeResult) -> ReportTable | None:
    """The largest loop of one bearing in each run; None where none is closed."""
    if "loop_stiffness" not in result.dataset:
        return None
    loops = result.largest_loops
    loops = loops[loops["K_eq_kN_mm"].notna()]
    if not len(loops):
        return None
    keys, names = _keys(loops), _told(loops, list(LOOP))
    columns = [*(KEYS[key] for key in keys), *(LOOP[name][0] for name in names)]
    rows = [
        [*(row[key] for key in keys), *(LOOP[name][1] * row[name] for name in names)]
        for row in loops.to_dict("records")
    ]
    note = "The loop that holds the largest displacement, from zero to zero displacement: K_eq = "
    note += "(|F+| + |F−|)/(|D+| + |D−|), h_eq and G_e as of a test (Eq. 3.1, 3.2)."
    caption = f"Largest loop of one bearing{_line(result)} in each run"
    return ReportTable(caption, columns, rows, len(keys), note=note)


def parts_table(result: EarthquakeResult, part: str) -> ReportTable | None:
    """A row for each run and bearing line, or pier; None with one of all."""
    table = result.lines if part == "line" else result.piers
    if not len(table) or table[part].nunique() < 2:
        return None
    shown = {name: PARTS[part][name] for name in _told(table, list(PARTS[part]))}
    keys = _keys(table)
    columns = [Column(part.capitalize()), *(KEYS[key] for key in keys)]
    columns += [column for column, _ in shown.values()]
    rows = []
    for row in table.to_dict("records"):
        values = [
            row[name] if isinstance(row[name], str) else factor * row[name]
            for name, (_, factor) in shown.items()
        ]
        values = [int(v) if name == "count" else v for name, v in zip(shown, values, strict=True)]
        rows.append([row[part], *(row[key] for key in keys), *values])
    of = "Every bearing line" if part == "line" else "Every pier"
    return ReportTable(f"{of} in each run", columns, rows, 1 + len(keys))


def _ratios_table(result: EarthquakeResult) -> ReportTable | None:
    """Real time over pseudo-dynamic; None where only one was run."""
    if not has_both(result):
        return None
    table = modes_table(result)
    names, keys = _told(table, list(RATIOS)), _keys(table)
    columns = [*(KEYS[key] for key in keys), *(Column(RATIOS[n], "", ".3f") for n in names)]
    rows = [[row[name] for name in (*keys, *names)] for row in table.to_dict("records")]
    return ReportTable("Real time over pseudo-dynamic", columns, rows, len(keys))


def _periods_table(result: EarthquakeResult) -> ReportTable | None:
    """Periods and damping ratios with equivalent stiffness; None of a study without a run."""
    attrs = result.dataset.attrs
    if "periods_s" not in attrs:
        return None
    names = [n for n in dict.fromkeys(result["bearing"].values.tolist())]
    columns = [
        Column("Mode", form="d"),
        Column("Period, equivalent stiffness", "s", ".3f"),
        Column("Viscous damping ratio", "%", ".1f"),
        *(Column(f"Initial period, {name}", "s", ".3f") for name in names),
    ]
    periods = np.atleast_1d(attrs["periods_s"])
    ratios = np.atleast_1d(attrs["damping_ratios"])
    initial = [np.atleast_1d(attrs[f"initial_periods_s:{name}"]) for name in names]
    rows = [
        [k + 1, float(periods[k]), 100.0 * float(ratios[k]), *(float(one[k]) for one in initial)]
        for k in range(len(periods))
    ]
    note = "Initial periods are with the stiffness of the bearings before they yield, at the "
    note += "temperature of the first run."
    return ReportTable("Natural periods and viscous damping", columns, rows, note=note)


def _books(result: EarthquakeResult, heads: dict[str, str], residuals: dict[str, str]) -> Any:
    """Columns and rows of energies [kJ] and residuals, a row a run."""
    keys = _keys(result.table)
    columns = [*(KEYS[key] for key in keys), *(Column(h, "kJ", ".1f") for h in heads.values())]
    columns += [Column(head, "", ".1e") for head in residuals.values()]
    runs = zip(result.table.to_dict("records"), result.energy.to_dict("records"), strict=True)
    rows = [
        [
            *(row[key] for key in keys),
            *(KJ * energy[f"{name}_kN_mm"] for name in heads),
            *(energy[name] for name in residuals),
        ]
        for row, energy in runs
    ]
    return columns, rows, len(keys)


def books_table(result: EarthquakeResult) -> ReportTable:
    """Energy books of the structure at the end of each run."""
    names = [name for name in STRUCTURE if f"energy_{name}" in result.dataset]
    heads = {name: name.capitalize() for name in names}
    columns, rows, keys = _books(result, heads, {"structure_residual": "Residual"})
    note = f"Input = {' + '.join(names[1:])} (all bearings); the residual is "
    note += "relative to the input. Books of one bearing stand in their own table."
    return ReportTable("Energy books of the structure", columns, rows, keys, note=note)


def bearing_books(result: EarthquakeResult) -> ReportTable:
    """Energy books of one bearing at the end of each run."""
    heads = {
        "bearing_work_in": "Work in",
        "bearing_heat_released": "Heat released",
        "bearing_recoverable": "Recoverable",
        "bearing_heat_stored": "Heat stored",
        "bearing_heat_lost_ends": "Lost, ends",
        "bearing_heat_lost_sides": "Lost, sides",
    }
    residuals = {"mechanical_residual": "Residual, mech.", "thermal_residual": "Residual, therm."}
    columns, rows, keys = _books(result, heads, residuals)
    note = "Work in = heat released + recoverable; heat released = stored + lost; of a bilinear "
    note += "bearing all heat counts as stored."
    return ReportTable(
        f"Energy balance of one bearing{_line(result)}", columns, rows, keys, note=note
    )


ALL_POINTS = 40_000  # of the traces of one plot together
MOST_CHOICES = 40  # entries of a menu
MOMENTS = 24  # places of a slider
UNTESTED = "#aa3333"
CAPTIONS = {
    "loops": "Force of one bearing against its shear strain. Shaded: beyond the tested strain.",
    "strain": "Shear strain of one bearing in the strong part of each motion; dots are peaks.",
    "energy": "Energy that one bearing takes.",
    "pier": "Displacement of the pier top relative to its base in the strong part of each motion.",
    "pier_acceleration": "Absolute acceleration of the pier top.",
    "deck": "Absolute acceleration of the deck.",
    "peaks": "Peaks of every run against the ambient temperature.",
    "parts": "Every bearing line and every pier beside each other.",
    "largest_loops": "The largest loop of each run, bearings over each other.",
    "modes": "Real time over pseudo-dynamic: loops of the specimen.",
    "hinge": "Moment against rotation of the pier base; dashed: where it yields.",
    "temperature": "Rise of the rubber layers and of the lead over the start.",
    "profiles": "Temperature through the height of the bearings.",
    "shares": "Shares of rubber, lead and rate branch in the force of the largest loop.",
    "speed": "Loading speed of the specimen on its own clock.",
}
OF_ALL = ("peaks", "parts", "deck")  # figures of the whole structure
ORDER = ("peaks", "loops", "strain", "pier", "hinge", "deck", "pier_acceleration", "temperature")


def report_figures(result: EarthquakeResult) -> dict[str, ReportFigure]:
    """Every figure that the study holds data for, by name."""
    held = result.plot.held() if result.runs else {}
    plots = _interactive_plots(result)
    names = [name for name in ORDER if name in held] + [n for n in held if n not in ORDER]
    shown = told_of_parts(result.dataset)
    about = {n: CAPTIONS[n] for n in names}
    about |= {n: f"{about[n]} Shown: {shown}." for n in names if shown and n not in OF_ALL}
    return {
        name: ReportFigure(
            about[name],
            draw=held[name],
            alt=about[name] + _largest(result, name),
            plot=plots.get(name),
        )
        for name in names
    }


def _largest(result: EarthquakeResult, name: str) -> str:
    """Return the largest value that a figure shows, and its run, for those who do not see it."""
    column = {
        "loops": ("bearing_strain_max", "largest shear strain {:.0%}"),
        "strain": ("bearing_strain_max", "largest shear strain {:.0%}"),
        "pier": ("pier_displacement_max_mm", "largest {:.1f} mm"),
        "hinge": ("pier_ductility", "largest ductility {:.2f}"),
        "deck": ("deck_acceleration_max_m_s2", "largest {:.2f} m/s²"),
        "pier_acceleration": ("pier_top_acceleration_max_m_s2", "largest {:.2f} m/s²"),
    }.get(name)
    if column is None:
        return ""
    view = result.dataset
    for part in ("line", "pier") if has_parts(view) else ():
        view = describe_all(view, part, None)
    values = EarthquakeResult(view).table[column[0]]
    if not values.notna().any():
        return ""
    run = result.run_names[int(np.nanargmax(values.to_numpy(dtype=float)))]
    told = column[1].format(values.max()).replace("%", " %")
    return f" {told[:1].upper()}{told[1:]} ({plain(run)})."


def _interactive_plots(result: EarthquakeResult) -> dict[str, Plot]:
    """Plots by the name of the figure that they stand beside."""
    runs = [run for run in range(result.runs)][: MOST_CHOICES * 10]
    if not runs:
        return {}
    force, strain = "force of one bearing [kN]", "shear strain [%]"
    found = {
        "loops": _plane(result, "bearing_strain", "bearing_force", 100.0, (strain, force)),
        "strain": _histories(result, "bearing_strain", 100.0, strain),
        "pier": _histories(result, "pier_displacement", 1.0, "pier top, of its base [mm]"),
        "deck": _histories(result, "deck_acceleration", 1.0, "acceleration of the deck [m/s²]"),
        "hinge": _plane(
            result, "pier_rotation", "pier_moment", 1e3, ("rotation [mrad]", "moment [kN m]")
        ),
        "temperature": _temperatures(result),
        "profiles": _profiles(result),
    }
    return {name: plot for name, plot in found.items() if plot is not None}


def _groups(result: EarthquakeResult) -> dict[str, list[int]]:
    """Runs of each menu entry: a bearing and a motion, at all temperatures."""
    table = result.table
    several = table["bearing"].nunique() > 1
    groups: dict[str, list[int]] = {}
    for run, row in enumerate(table.to_dict("records")):
        name = f"{row['bearing']}, {row['motion']}" if several else str(row["motion"])
        if name in groups or len(groups) < MOST_CHOICES:
            groups.setdefault(name, []).append(run)
    return groups


def _colours(result: EarthquakeResult) -> dict[float, str]:
    ambients = sorted(set(result.table["ambient_degC"]))
    colours = drawing.ambient_colours(np.array(ambients, dtype=float))
    return dict(zip(ambients, colours, strict=True))


def _label(result: EarthquakeResult, run: int) -> str:
    """Temperature of a run, and its mode where there are several."""
    air = degrees([float(result["ambient"].values[run])])
    mode = result.modes[run] if len(set(result.modes)) > 1 else ""
    return f"{air}, {mode}" if mode else air


def _values(result: EarthquakeResult, name: str, run: int) -> Floats:
    told = np.isfinite(result["time"].values[run])
    return np.asarray(result[name].values[run][told], dtype=float)


def _points(result: EarthquakeResult) -> int:
    return int(np.clip(ALL_POINTS // max(result.runs, 1), 120, POINTS))


def _choices(
    result: EarthquakeResult, make: Callable[[int], tuple[Floats, Floats] | None]
) -> dict[str, list[Trace]]:
    """Traces of every run that has any, by menu entry."""
    colours = _colours(result)
    found: dict[str, list[Trace]] = {}
    for name, runs in _groups(result).items():
        traces = []
        for run in runs:
            made = make(run)
            if made is not None:
                slow = result.modes[run] == "pd" and len(set(result.modes)) > 1
                colour = colours[float(result["ambient"].values[run])]
                look = "dashed" if slow else "line"
                traces.append(Trace(_label(result, run), *made, colour, look))
        if traces:
            found[name] = traces
    return found


def _plane(
    result: EarthquakeResult, x: str, y: str, factor: float, titles: tuple[str, str]
) -> Plot | None:
    """Paths in the plane of two histories."""
    points = _points(result)

    def make(run: int) -> tuple[Floats, Floats] | None:
        a, b = factor * _values(result, x, run), _values(result, y, run)
        known = len(a) and np.isfinite(a).all() and np.isfinite(b).all()
        return path(a, b, points) if known else None

    choices = _choices(result, make)
    if not choices:
        return None
    if x == "bearing_strain":
        _add_tested(result, choices, along="x")
    return Plot(*titles, choices)


def _add_tested(
    result: EarthquakeResult, choices: dict[str, list[Trace]], along: Literal["x", "y"]
) -> None:
    """Dashed lines at the largest tested strain in the panels that go beyond it.

    Bearings are tested to different strains, so that one band for all entries would be wrong.
    """
    for name, runs in _groups(result).items():
        end = 100.0 * result.tested_to(runs, "strain")
        if name not in choices or not np.isfinite(end):
            continue
        across = [trace.y if along == "x" else trace.x for trace in choices[name]]
        low, high = (float(f([f(v) for v in across])) for f in (np.nanmin, np.nanmax))
        gap, span = np.nan, (low, high)
        at, other = np.array([end, end, gap, -end, -end]), np.array([*span, gap, *span])
        points = (at, other) if along == "x" else (other, at)
        choices[name].append(Trace(f"tested to {end:g} %", *points, UNTESTED, "dashed"))


def _histories(result: EarthquakeResult, name: str, factor: float, title: str) -> Plot | None:
    """A history of every run."""
    points = _points(result)

    def make(run: int) -> tuple[Floats, Floats] | None:
        time, values = _values(result, "time", run), factor * _values(result, name, run)
        known = len(values) and np.isfinite(values).all()
        return history(time, values, points) if known else None

    choices = _choices(result, make)
    if name == "bearing_strain":
        _add_tested(result, choices, along="y")
    return Plot("time [s]", title, choices) if choices else None


def _temperatures(result: EarthquakeResult) -> Plot | None:
    """Innermost rubber layer (full) and lead (dashed) of every run."""
    points, colours, choices = _points(result) // 2, _colours(result), {}
    for name, runs in _groups(result).items():
        traces = []
        for run in runs:
            places, time = result.places(run), _values(result, "time", run)
            colour = colours[float(result["ambient"].values[run])]
            for place, look in (("inner layer", "line"), ("lead", "dashed")):
                values = places[place]
                if len(values) and np.isfinite(values).all():
                    what = "rubber" if place == "inner layer" else place
                    label = f"{what}, {_label(result, run)}"
                    traces.append(Trace(label, *history(time, values, points), colour, look))
        if traces:
            choices[name] = traces
    return Plot("time [s]", "temperature [°C]", choices) if choices else None


def _profiles(result: EarthquakeResult) -> Plot | None:
    """Temperature through the height, moved through the motion by a slider."""
    data = result.dataset
    if "temperature" not in data:
        return None
    longest = float(np.nanmax(data["time"].values))
    moments = np.linspace(0.0, longest, MOMENTS)
    colours, choices = _colours(result), {}
    for name, runs in _groups(result).items():
        traces = []
        for run in runs:
            depth = data["depth"].values[run]
            own = np.isfinite(depth)
            if not own.any():
                continue
            time = _values(result, "time", run)
            at = np.searchsorted(time, moments).clip(0, len(time) - 1)
            frames = rounded(data["temperature"].values[run][at][:, own])
            level = -rounded(depth[own])
            y = np.tile(level, (len(moments), 1))
            colour = colours[float(data["ambient"].values[run])]
            label = _label(result, run)
            traces.append(Trace(label, frames[0], level, colour, "line with points", y, frames))
        if traces:
            choices[name] = traces
    if not choices:
        return None
    return Plot(
        "temperature [°C]",
        "level relative to the upper face [mm]",
        choices,
        slider=[f"{moment:.1f} s" for moment in moments],
        slider_title="time",
    )
