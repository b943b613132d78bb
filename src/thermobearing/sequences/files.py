"""Files of a sequence: its own, and a result directory of each part below them."""

from pathlib import Path

from thermobearing.border.errors import InputError, is_file
from thermobearing.cyclic.files import load_cyclic
from thermobearing.earthquake.files import load_study
from thermobearing.results.directory import (
    FIGURES,
    PARTS,
    RESOLVED,
    TABLE,
    write_directory,
)
from thermobearing.results.writing import write_csv, write_limits, write_summary
from thermobearing.sequences.case import HybridPart, load_sequence_case
from thermobearing.sequences.result import SequenceResult


def save_sequence(
    result: SequenceResult, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, table.csv, case.resolved.toml, a figure, and parts/NN-name.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        write_summary(folder, result.summary())
        (folder / RESOLVED).write_text(result.case.to_toml(), encoding="utf-8")
        write_csv(folder / TABLE, result.table)
        write_limits(folder, result.rig, result.tested_range)
        for number, part in enumerate(result.parts):
            part.save(folder / PARTS / result.case.label(number), figures=figures)
        if figures and result.parts:
            (folder / FIGURES).mkdir()
            result.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, force=force)


def load_sequence(path: str | Path) -> SequenceResult:
    """A saved sequence again; see `load_result`, which reads any.

    Raises
    ------
    InputError : there is no readable sequence at that path.
    """
    folder = Path(path)
    if not is_file(folder / RESOLVED):
        raise InputError("is no result of a sequence: no case.resolved.toml", str(folder))
    case = load_sequence_case(folder / RESOLVED)
    parts = []
    for number, part in enumerate(case.parts):
        place = folder / PARTS / case.label(number)
        if place.is_dir():
            parts.append(load_study(place) if isinstance(part, HybridPart) else load_cyclic(place))
    ended = bool(parts) and parts[-1].outcome != "completed"
    return SequenceResult(case, parts, interrupted=len(parts) < len(case.parts) and not ended)
