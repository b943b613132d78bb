"""Directory and console tables of a structure."""

from pathlib import Path

import pandas as pd

from thermobearing.border.toml import sourced_toml
from thermobearing.results.directory import (
    FIGURES,
    PERIODS,
    RESOLVED,
    STRUCTURE_PARTS,
    write_directory,
)
from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.results.writing import write_csv, write_summary
from thermobearing.structure.model import load_structure
from thermobearing.structure.result import TONNES, StructureResult


def save_structure(
    result: StructureResult, directory: Path, *, overwrite: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, parts.csv, periods.csv, the structure as TOML, and figures.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        write_summary(folder, result.summary())
        write_csv(folder / STRUCTURE_PARTS, result.parts)
        write_csv(folder / PERIODS, result.table)
        (folder / RESOLVED).write_text(
            sourced_toml(result.structure, result.structure.sources), encoding="utf-8"
        )
        if figures:
            result.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, overwrite=overwrite)


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
