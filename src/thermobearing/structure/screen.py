"""A structure on the terminal: its parts, periods and shapes."""

import pandas as pd

from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.structure.model import load_structure
from thermobearing.structure.result import TONNES, StructureResult


def print_structures(names: list[str]) -> None:
    """One line for each structure."""
    for name in names:
        print(f"{name:15}{load_structure(name).description}", flush=True)


def print_structure(result: StructureResult) -> None:
    """What the model is made of, and its modes."""
    structure = result.structure
    say(f"{structure.name}: {structure.description}", "bold")
    _print_rows(result.parts.rename(columns={"height_mm": "height mm"}))
    say(
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
    print_warnings(result.warnings)


def _print_rows(table: pd.DataFrame) -> None:
    """A plain table, numbers right."""
    texts = {
        name: [f"{v:g}" if isinstance(v, float) else str(v) for v in table[name]] for name in table
    }
    keys = sum(name in {"part", "name", "body", "base", "mode"} for name in texts)
    rows = [[texts[name][k] for name in texts] for k in range(len(table))]
    print_table([str(name) for name in texts], rows, keys=keys)
