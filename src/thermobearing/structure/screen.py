"""A structure on the terminal: its parts, periods and shapes."""

import pandas as pd
from rich.console import Console
from rich.markup import escape

from thermobearing.structure.model import load_structure
from thermobearing.structure.result import TONNES, StructureResult


def print_structures(names: list[str]) -> None:
    """One line for each structure."""
    for name in names:
        print(f"{name:15}{load_structure(name).description}", flush=True)


def print_structure(result: StructureResult) -> None:
    """What the model is made of, and its modes."""
    console = Console(highlight=False)
    structure = result.structure
    console.print(f"[bold]{escape(structure.name)}[/bold]: {escape(structure.description)}")
    _print_rows(result.parts.rename(columns={"height_mm": "height mm"}))
    console.print(
        f"\n{TONNES * result.mass:g} t in all, {result.mass_model} mass, damping "
        f"{structure.damping.kind}; bearings with their equivalent stiffness"
    )
    table = result.table
    shown = pd.DataFrame(
        {
            "mode": table["mode"].map("{:d}".format),
            "period s": table["period_s"].map("{:.3f}".format),
            "damping": table["damping_ratio"].map("{:.1%}".format),
            "effective mass": table["effective_mass"].map("{:.1%}".format),
        }
    )
    for name in result.prepared.matrices.coordinates:
        shown[name] = table[name].map("{:.3g}".format)
    _print_rows(shown)


def _print_rows(table: pd.DataFrame) -> None:
    """A plain table, numbers right."""
    texts = {
        name: [f"{v:g}" if isinstance(v, float) else str(v) for v in table[name]] for name in table
    }
    words = {"part", "name", "body", "base", "size"}
    widths = {name: max(len(str(name)), *map(len, values)) for name, values in texts.items()}

    def line(cells: dict[str, str]) -> str:
        parts = [
            cell.ljust(widths[name]) if name in words else cell.rjust(widths[name])
            for name, cell in cells.items()
        ]
        return "  ".join(parts).rstrip()

    print(line({str(name): str(name) for name in table}), flush=True)
    for k in range(len(table)):
        print(line({str(name): texts[name][k] for name in texts}), flush=True)
