"""Directory and console tables of an analysis of earthquakes."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.earthquake.modes import has_both, modes_table
from thermobearing.earthquake.parts import farthest, governing_runs, has_parts
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.directory import (
    COMPARISON,
    DATASET,
    FIGURES,
    HISTORY,
    LINES,
    MODES,
    PIERS,
    RESOLVED,
    TABLE,
    write_directory,
)
from thermobearing.results.ranges import rate_note
from thermobearing.results.saved import read_dataset
from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.results.writing import write_csv, write_dataset, write_limits, write_summary


def save_earthquake(
    result: EarthquakeResult,
    directory: Path,
    *,
    overwrite: bool = False,
    figures: bool = True,
    compared: dict[str, EarthquakeResult] | None = None,
) -> Path:
    """Write summary.json, table.csv, history.csv, result.nc, case.resolved.toml and figures.

    With several bearing lines or piers also lines.csv and piers.csv.

    Parameters
    ----------
    result : what to write.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
    figures : draw the figures too.
    compared : results of the same study by model (`compare_models`): adds a table, two figures
        and a verdict in summary.json.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        told = result.summary()
        (folder / RESOLVED).write_text(result.dataset.attrs["case"], encoding="utf-8")
        write_csv(folder / TABLE, result.table)
        if has_both(result):
            write_csv(folder / MODES, modes_table(result))
        write_limits(folder, result.rig, result.tested_range)
        for name, parts in ((LINES, result.lines), (PIERS, result.piers)):
            if len(parts):
                write_csv(folder / name, parts)
        _write_histories(result, folder / HISTORY)
        write_dataset(result.dataset, folder / DATASET)
        if figures:
            (folder / FIGURES).mkdir()
            result.plot.save_all(folder / FIGURES)
        if compared:
            told["verdict"] = _write_comparison(compared, folder, figures=figures)
        write_summary(folder, told)

    return write_directory(directory, fill, overwrite=overwrite)


def _write_comparison(results: dict[str, EarthquakeResult], folder: Path, *, figures: bool) -> str:
    """Table and figures of the earlier models; returns the verdict on a single temperature."""
    from thermobearing.earthquake.summary_figures import (
        comparison_figure,
        comparison_loops,
        comparison_table,
        verdict,
    )
    from thermobearing.results.drawing import save_figures

    table = comparison_table(results)
    write_csv(folder / COMPARISON, table)
    if figures:
        drawn = {"comparison": comparison_figure, "comparison_loops": comparison_loops}
        save_figures({k: partial(draw, results) for k, draw in drawn.items()}, folder / FIGURES)
    return verdict(table)


def _write_histories(result: EarthquakeResult, path: Path) -> None:
    """Main histories of all runs below each other."""
    for run in range(result.runs):
        frame = result.history(run)
        if any(result.modes):
            frame.insert(0, "mode", result.modes[run])
        for name in ("ambient", "motion", "bearing"):
            label = "ambient_degC" if name == "ambient" else name
            frame.insert(0, label, result.dataset[name].values[run])
        write_csv(path, frame, below=run > 0)


def load_study(path: str | Path) -> EarthquakeResult:
    """A saved result of an earthquake study again; see `load_result`, which reads any.

    Raises
    ------
    InputError : there is no readable result of a study at that path.
    """
    return EarthquakeResult(read_dataset(path, ("structure", "case")))


TITLE = "real time over pseudo-dynamic"
RATIOS = {  # columns of modes.csv
    "force_ratio": "force",
    "strain_ratio": "strain",
    "energy_ratio": "energy",
    "outer_layer_rise_ratio": "outer rise",
    "inner_layer_rise_ratio": "inner rise",
    "lead_rise_ratio": "lead rise",
}
ERRORS = {  # columns of comparison.csv
    "inner layer largest K": "inner K",
    "lead largest K": "lead K",
    "peak force %": "force %",
    "peak strain %": "strain %",
    "energy %": "energy %",
    "pier displacement %": "pier %",
    "loop K_eq %": "K_eq %",
}
KEYS = ("motion", "degC")
# Bearing strain, force, energy, that of the warmest run; pier; deck: how far from the ground, its
# acceleration; share of the input energy that viscous damping takes; hottest rubber and lead.
HEADS = (
    "strain",
    "force kN",
    "energy kJ",
    "of warmest",
    "pier mm",
    "ductility",
    "deck mm",
    "deck m/s2",
    "viscous",
    "rubber degC",
    "lead degC",
)
MOST_ROWS = 24  # of lines or piers: of more, the largest of all runs are printed
PARTS = {  # columns of lines.csv and piers.csv: head, how a number is told
    "line": {
        "count": ("n", "{:.0f}"),
        "line_ambient_degC": ("ambient degC", "{:g}"),
        "strain_max": ("strain", "{:.0%}"),
        "force_max_kN": ("kN each", "{:.0f}"),
        "total_force_max_kN": ("kN all", "{:.0f}"),
        "rubber_max_degC": ("rubber degC", "{:.1f}"),
        "lead_max_degC": ("lead degC", "{:.1f}"),
    },
    "pier": {
        "displacement_max_mm": ("top mm", "{:.1f}"),
        "displacement_residual_mm": ("residual mm", "{:.1f}"),
        "ductility": ("ductility", "{:.2f}"),
        "moment_max_kN_m": ("kN m", "{:.0f}"),
        "top_acceleration_max_m_s2": ("top m/s2", "{:.2f}"),
    },
}


def print_study(
    result: EarthquakeResult, compared: dict[str, EarthquakeResult] | None = None
) -> None:
    """Periods and damping, one table per bearing, earlier models, the worst energy residual."""
    attrs = result.dataset.attrs
    title = f"{attrs['structure']}: {attrs['title']}"
    say(f"{title} ({attrs['mass']} mass, {attrs['method']})", "bold")
    periods = ", ".join(f"{float(value):.3f}" for value in attrs.get("periods_s", []))
    ratios = ", ".join(f"{float(value):.1%}" for value in attrs.get("damping_ratios", []))
    say(f"periods {periods} s with equivalent stiffness")
    say(f"viscous damping {attrs['damping']}: ratios of these modes {ratios}")
    if "surroundings" in attrs:
        say(attrs["surroundings"])
    table, both = result.table, has_both(result)
    for name in dict.fromkeys(table["bearing"]):
        _print_runs(result, table[table["bearing"] == name], both)
    for name, rows in modes_table(result).groupby("bearing", sort=False) if both else ():
        _print_modes(str(name), rows)
    for part, rows in (("line", result.lines), ("pier", result.piers)):
        if len(rows) and len(set(rows[part])) > 1:
            _print_parts(part, rows)
    if result.runs > 1 or has_parts(result.dataset):
        _print_governing(result)
    marked = table["beyond_tested"].str.split().explode()
    if marked.isin(["strain", "ambient"]).any():
        say("! beyond what the bearing was tested at")
    if compared:
        _print_comparison(compared)
    if result.runs:
        worst = float(result.energy["structure_residual"].abs().max())
        say(f"energy balance: largest residual {worst:.1e} of the input")
    if note := rate_note(result.tested_range.to_dict("records")):
        say(note)
    print_warnings(result.warnings)


def _print_comparison(results: dict[str, EarthquakeResult]) -> None:
    """Worst errors of each earlier model over the runs of each bearing, and the verdict."""
    from thermobearing.earthquake.summary_figures import comparison_table, verdict

    rows = comparison_table(results)
    shown = [column for column in ERRORS if column in rows]
    for bearing, mine in rows.groupby("bearing", sort=False):
        cells = []
        for model, its in mine.groupby("model", sort=False):
            errors = [its[column].dropna().to_numpy() for column in shown]
            worst = [f"{e[np.abs(e).argmax()]:.1f}" if len(e) else "" for e in errors]
            cells.append((str(model), *worst))
        title = f"{bearing}: earlier models, the error of largest size in all runs"
        print_table(("model", *(ERRORS[column] for column in shown)), cells, title=title)
    say(verdict(rows))
    for early in rows[rows["outcome"] != "completed"].to_dict("records"):
        where = f"{early['bearing']}, {early['motion']}, {early['ambient_degC']:g} degC"
        text = f"{early['model']} ended early ({where}): {early['outcome']}"
        say(f"{text}; its errors are those until then", "yellow")


def _print_modes(name: str, rows: pd.DataFrame) -> None:
    """Real-time tests of a bearing over the pseudo-dynamic ones."""
    shown = [column for column in RATIOS if rows[column].notna().any()]
    cells = [
        (row["motion"], f"{row['ambient_degC']:g}", *(f"{row[column]:.3f}" for column in shown))
        for row in rows.to_dict("records")
    ]
    heads = (*KEYS, *(RATIOS[column] for column in shown))
    print_table(heads, cells, title=f"{name}: {TITLE}", keys=2)


def _print_runs(result: EarthquakeResult, rows: pd.DataFrame, both: bool) -> None:
    """One row a run of a bearing; columns that none of them has are left out."""
    several = rows["ambient_degC"].nunique() > 1  # or each run would be the warmest
    cells = [
        _cells(row, result.hottest(int(run)), both, several)
        for run, row in zip(rows.index, rows.to_dict("records"), strict=True)
    ]
    heads = (*KEYS, *HEADS)
    more = ": the largest of all lines and piers" if has_parts(result.dataset) else ""
    told = [k for k in range(len(heads)) if k < len(KEYS) or any(line[k] for line in cells)]
    print_table(
        [heads[k] for k in told],
        [[line[k] for k in told] for line in cells],
        title=f"{rows['bearing'].iloc[0]}{more}",
        keys=len(KEYS),
        styles=["" if outcome == "completed" else "red" for outcome in rows["outcome"]],
    )


def _print_parts(part: str, rows: pd.DataFrame) -> None:
    """Print a row for each run and bearing line, or pier; the largest of many runs."""
    shown, title = PARTS[part], f"{part}s"
    rows = rows.assign(bearing=rows.get("line_bearing", rows["bearing"]))
    keys = ["bearing", "motion", *(["mode"] if "mode" in rows else []), "ambient_degC"]
    if len(rows) > MOST_ROWS:
        keys, title = keys[:1], f"{part}s: the largest of all runs (each run: {part}s.csv)"
        groups = rows.groupby([part, *keys], sort=False)[list(shown)]
        rows = groups.agg(farthest).reset_index()
    cells: dict[tuple[str, ...], list[str]] = {}  # equal ones in one row
    for row in rows.sort_values(part, kind="stable").to_dict("records"):
        told = [f"{row[key]:g}" if key == "ambient_degC" else str(row[key]) for key in keys]
        told += [_told(row[column], form) for column, (_, form) in shown.items()]
        cells.setdefault(tuple(told), []).append(str(row[part]))
    heads = (part, *keys, *(head for head, _ in shown.values()))
    lines = [(", ".join(names), *told) for told, names in cells.items()]
    print_table(
        [head.replace("ambient_", "") for head in heads], lines, title=title, keys=1 + len(keys)
    )


def _print_governing(result: EarthquakeResult) -> None:
    """The largest of all runs, and where it is."""
    cells = [
        (
            row["bearing"],
            row["what"],
            f"{row['largest']:.0%}" if row["what"] == "bearing strain" else f"{row['largest']:.4g}",
            row["part"],
            row["motion"],
            f"{row['ambient_degC']:g}",
        )
        for row in governing_runs(result).to_dict("records")
    ]
    heads = ("bearing", "what", "largest", "line or pier", "motion", "degC")
    several = any(line[3] for line in cells)
    kept = [k for k in range(len(heads)) if k != 3 or several]
    told = [[line[k] for k in kept] for line in cells]
    print_table([heads[k] for k in kept], told, title="largest of all runs", keys=2)


def _cells(row: dict[Any, Any], hottest: dict[str, float], both: bool, several: bool) -> list[str]:
    return [
        f"{row['motion']} {row['mode']}" if both else row["motion"],
        f"{row['ambient_degC']:g}" + _mark(row, "ambient"),
        f"{row['bearing_strain_max']:.0%}" + _mark(row, "strain"),
        f"{row['bearing_force_max_kN']:.0f}",
        f"{1e-3 * row['bearing_energy_kN_mm']:.1f}",
        f"{row['energy_of_warmest']:.0%}" if several else "",
        _told(row["pier_displacement_max_mm"] or np.nan, "{:.1f}"),  # none: no pier
        _told(row["pier_ductility"], "{:.2f}"),
        _told(row.get("deck_displacement_max_mm", np.nan), "{:.0f}"),
        f"{row['deck_acceleration_max_m_s2']:.2f}",
        f"{row['damping_of_input']:.0%}",
        _told(hottest["rubber"], "{:.1f}"),
        _told(hottest["lead"], "{:.1f}"),
    ]


def _told(value: float, form: str) -> str:
    """A number, or nothing where there is none."""
    return "" if value != value else form.format(value)


def _mark(row: dict[Any, Any], quantity: str) -> str:
    """A mark beside a number that the bearing was not tested at."""
    return "!" if quantity in str(row["beyond_tested"]).split() else ""
