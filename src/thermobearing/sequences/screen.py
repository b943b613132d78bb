"""Table of a sequence on the terminal."""

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from thermobearing.results.screen import print_warnings
from thermobearing.sequences.result import SequenceResult

SHOWN = {  # column of the table: head, digits
    "displacement_end_mm": ("to mm", "{:.1f}"),
    "displacement_max_mm": ("max mm", "{:.1f}"),
    "force_start_kN": ("from kN", "{:.0f}"),
    "force_max_kN": ("max kN", "{:.0f}"),
    "energy_kN_mm": ("kN mm", "{:.0f}"),
}


def print_sequence(result: SequenceResult) -> None:
    """One row a part; inner layer and lead at its start and end."""
    console = Console()
    case, rows = result.case, result.table
    console.print(f"[bold]{escape(case.name)}: {escape(case.bearing.name)}[/bold]")
    print_warnings(console, result.warnings)
    table = Table(box=None, pad_edge=False, header_style="bold")
    stems = [name.removesuffix("_start_degC") for name in map(str, rows) if "_start_degC" in name]
    rubber = [stem for stem in stems if stem.startswith("rubber")][-1:]
    warm = rubber + [stem for stem in stems if stem == "lead"]
    table.add_column("part", no_wrap=True)
    for head in [
        *(head for head, _ in SHOWN.values()),
        *(s.replace("rubber", "layer ") for s in warm),
    ]:
        table.add_column(head, justify="right", no_wrap=True)
    if rows["beyond_tested"].any():
        table.add_column("not tested", no_wrap=True)
    for row in rows.to_dict("records"):
        table.add_row(
            str(row["part"]),
            *(form.format(row[name]) for name, (_, form) in SHOWN.items()),
            *(f"{row[f'{s}_start_degC']:.1f} > {row[f'{s}_end_degC']:.1f}" for s in warm),
            *([str(row["beyond_tested"])] if rows["beyond_tested"].any() else []),
            style=None if row["outcome"] == "completed" else "red",
        )
    console.print(table)
