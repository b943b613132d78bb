"""Files of a structure that was looked at."""

from pathlib import Path

from thermobearing.border.toml import sourced_toml
from thermobearing.results.directory import (
    FIGURES,
    PERIODS,
    RESOLVED,
    STRUCTURE_PARTS,
    write_directory,
)
from thermobearing.results.writing import write_csv, write_summary
from thermobearing.structure.result import StructureResult


def save_structure(
    result: StructureResult, directory: Path, *, force: bool = False, figures: bool = True
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

    return write_directory(directory, fill, force=force)
