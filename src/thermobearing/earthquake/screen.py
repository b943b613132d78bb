"""Tables of an earthquake study on the terminal."""

from typing import Any

import numpy as np
import pandas as pd
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from thermobearing.earthquake.modes import has_both, modes_table
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.screen import print_warnings

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
# Motion; air; bearing strain, force, energy, that of the warmest run; pier; deck acceleration;
# share of the input energy that viscous damping takes.
HEADS = (
    "motion",
    "degC",
    "strain",
    "kN",
    "kJ",
    "of warm",
    "pier mm",
    "ductility",
    "m/s2",
    "damped",
)


WIDE = 160  # letters that a row of lines and piers may take
PARTS = {  # columns of lines.csv and piers.csv: head, how a number is told
    "line": {
        "count": ("n", "{:.0f}"),
        "line_ambient_degC": ("its air", "{:g}"),
        "strain_max": ("strain", "{:.0%}"),
        "force_max_kN": ("kN each", "{:.0f}"),
        "total_force_max_kN": ("kN all", "{:.0f}"),
        "rubber_max_degC": ("rubber degC", "{:.1f}"),
    },
    "pier": {
        "displacement_max_mm": ("mm", "{:.1f}"),
        "displacement_residual_mm": ("left mm", "{:.1f}"),
        "ductility": ("ductility", "{:.2f}"),
        "moment_max_kN_m": ("kN m", "{:.0f}"),
        "top_acceleration_max_m_s2": ("top m/s2", "{:.2f}"),
    },
}


def print_study(
    result: EarthquakeResult, compared: dict[str, EarthquakeResult] | None = None
) -> None:
    """Periods and damping, one table per bearing, earlier models, the worst energy residual."""
    console = Console()
    attrs = result.dataset.attrs
    console.print(
        f"[bold]{escape(str(attrs['structure']))}: {escape(str(attrs['title']))}[/bold] "
        f"({attrs['mass']} mass, {attrs['method']})",
        soft_wrap=True,
    )
    periods = ", ".join(f"{float(value):.3f}" for value in attrs.get("periods_s", []))
    ratios = ", ".join(f"{float(value):.1%}" for value in attrs.get("damping_ratios", []))
    console.print(f"periods {periods} s with equivalent stiffness")
    console.print(f"viscous damping {attrs['damping']}: ratios of these modes {ratios}")
    table, both = result.table, has_both(result)
    for name in dict.fromkeys(table["bearing"]):
        console.print(_table(name, table[table["bearing"] == name], both))
    for name, rows in modes_table(result).groupby("bearing", sort=False) if both else ():
        console.print(_modes(str(name), rows))
    for part, rows in (("line", result.lines), ("pier", result.piers)):
        if len(rows) and len(set(rows[part])) > 1:
            Console(width=max(console.width, WIDE)).print(_parts(part, rows))  # nothing cut
    marked = table["beyond_tested"].str.split().explode()
    if marked.isin(["strain", "ambient"]).any():
        console.print("! beyond what the bearing was tested at")
    if compared:
        _print_comparison(console, compared)
    if result.runs:
        worst = float(result.energy["structure_residual"].abs().max())
        console.print(f"energy books: largest residual {worst:.1e} of the input")
    print_warnings(console, result.warnings)


def _print_comparison(console: Console, results: dict[str, EarthquakeResult]) -> None:
    """Worst errors of each earlier model over the runs of each bearing, and the verdict."""
    from thermobearing.earthquake.comparison import comparison_table, verdict

    rows = comparison_table(results)
    shown = [column for column in ERRORS if column in rows]
    for bearing, mine in rows.groupby("bearing", sort=False):
        title = f"\n{bearing}: earlier models, the error of largest size in all runs"
        table = Table(title=title, title_justify="left", box=None, pad_edge=False)
        for head in ("model", *(ERRORS[column] for column in shown)):
            table.add_column(head, justify="left" if head == "model" else "right", no_wrap=True)
        for model, its in mine.groupby("model", sort=False):
            errors = [its[column].dropna().to_numpy() for column in shown]
            worst = [f"{e[np.abs(e).argmax()]:.1f}" if len(e) else "" for e in errors]
            table.add_row(str(model), *worst)
        console.print(table)
    console.print(verdict(rows), highlight=False)
    for early in rows[rows["outcome"] != "completed"].to_dict("records"):
        where = f"{early['bearing']}, {early['motion']}, {early['ambient_degC']:g} degC"
        text = f"{early['model']} ended early ({where}): {early['outcome']}"
        console.print(f"[yellow]{escape(text)}; its errors are those until then[/yellow]")


def _modes(name: str, rows: pd.DataFrame) -> Table:
    """Real-time tests of a bearing over the pseudo-dynamic ones."""
    table = Table(title=f"\n{name}: {TITLE}", title_justify="left", box=None, pad_edge=False)
    shown = [column for column in RATIOS if rows[column].notna().any()]
    for head in ("motion", "degC", *(RATIOS[column] for column in shown)):
        table.add_column(head, justify="left" if head == "motion" else "right", no_wrap=True)
    for row in rows.to_dict("records"):
        numbers = [f"{row[column]:.3f}" for column in shown]
        table.add_row(row["motion"], f"{row['ambient_degC']:g}", *numbers)
    return table


def _parts(part: str, rows: pd.DataFrame) -> Table:
    """A row for each run and bearing line, or pier."""
    shown = PARTS[part]
    table = Table(title=f"\n{part}s", title_justify="left", box=None, pad_edge=False)
    for head in (part, "bearing", "motion", "degC", *(head for head, _ in shown.values())):
        text = head in (part, "bearing", "motion")
        table.add_column(head, justify="left" if text else "right", no_wrap=True)
    for row in rows.sort_values(part, kind="stable").to_dict("records"):
        bearing = row.get("line_bearing", row["bearing"])
        motion = f"{row['motion']} {row['mode']}" if "mode" in row else row["motion"]
        numbers = [
            form.format(row[column]) if row[column] == row[column] else ""
            for column, (_, form) in shown.items()
        ]
        table.add_row(row[part], bearing, motion, f"{row['ambient_degC']:g}", *numbers)
    return table


def _mark(row: dict[str, Any], quantity: str) -> str:
    """A mark beside a number that the bearing was not tested at."""
    return "!" if quantity in str(row["beyond_tested"]).split() else ""


def _table(name: str, rows: "object", both: bool) -> Table:
    table = Table(title=f"\n{name}", title_justify="left", box=None, pad_edge=False)
    for head in HEADS:
        table.add_column(head, justify="left" if head == "motion" else "right", no_wrap=True)
    for row in rows.to_dict("records"):  # type: ignore[attr-defined]
        hinged = row["pier_ductility"] == row["pier_ductility"]
        table.add_row(
            f"{row['motion']} {row['mode']}" if both else row["motion"],
            f"{row['ambient_degC']:g}" + _mark(row, "ambient"),
            f"{row['bearing_strain_max']:.0%}" + _mark(row, "strain"),
            f"{row['bearing_force_max_kN']:.0f}",
            f"{1e-3 * row['bearing_energy_kN_mm']:.1f}",
            f"{row['energy_of_warmest']:.0%}",
            f"{row['pier_displacement_max_mm']:.1f}",
            f"{row['pier_ductility']:.2f}" if hinged else "",
            f"{row['deck_acceleration_max_m_s2']:.2f}",
            f"{row['damping_of_input']:.0%}",
            style=None if row["outcome"] == "completed" else "red",
        )
    return table
