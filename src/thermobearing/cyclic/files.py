"""Files of a cyclic result, and reading them back."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.thinning import COMPLETE, thinned
from thermobearing.results.directory import (
    COMPARISON,
    DATASET,
    FIGURES,
    HISTORY,
    RESOLVED,
    write_directory,
)
from thermobearing.results.reading import read_dataset
from thermobearing.results.writing import (
    DIGITS,
    without_formulas,
    write_dataset,
    write_limits,
    write_summary,
)

CSV_BLOCK = 50_000  # rows formatted at a time
# Heads of a history and names in its dataset; those of layers are after them.
HEADS = {
    **{"displacement_mm": "displacement", "force_kN": "force"},
    **{"stress_MPa": "stress", "strain": "strain"},
}


def save_result(
    result: Result,
    directory: Path,
    *,
    force: bool = False,
    figures: bool = True,
    compared: dict[str, Result] | None = None,
) -> Path:
    """Write summary.json, result.nc, history.csv, case.resolved.toml and figures.

    Parameters
    ----------
    result : what to write.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
    figures : draw the figures too.
    compared : results of the same test by model, this one first: adds a table and a figure.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `check_target`; or the disk is full or not writable. Nothing is left.
    """

    def fill(folder: Path) -> None:
        _write_all(result, folder, figures=figures)
        if compared:
            _write_comparison(compared, folder, figures=figures)

    return write_directory(directory, fill, force=force)


def _write_all(result: Result, folder: Path, *, figures: bool) -> None:
    write_summary(folder, result.summary())
    (folder / RESOLVED).write_text(result.dataset.attrs["case"], encoding="utf-8")
    written = written_part(result)
    with (folder / HISTORY).open("w", encoding="utf-8") as file:
        file.writelines(history_blocks(written))
    write_dataset(written.dataset, folder / DATASET)
    write_limits(folder, result.rig, result.tested_range)
    if figures:
        (folder / FIGURES).mkdir()
        result.plot.save_all(folder / FIGURES)


def written_part(result: Result) -> Result:
    """What of a result is written: all of it where its case asks for complete histories."""
    return result if result.dataset.attrs.get("histories") == COMPLETE else thinned(result)


def _write_comparison(results: dict[str, Result], folder: Path, *, figures: bool) -> None:
    from thermobearing.cyclic.comparison import comparison_figure, comparison_table
    from thermobearing.results.drawing import save_figure

    reference = next(iter(results))
    without_formulas(comparison_table(results, reference)).to_csv(folder / COMPARISON, index=False)
    if figures:
        save_figure(comparison_figure(results, reference), folder / FIGURES / "comparison.png")


def history_blocks(result: Result) -> Iterator[str]:
    """Text of history.csv, block by block: one row per kept step and ambient temperature."""
    last = "" if result.has_lead else ","  # lead_degC stays empty where the bearing has no lead
    names = [*history_columns(result, 0), *(["lead_degC"] if last else [])]
    yield ",".join(["ambient_degC", *names]) + "\n"
    for run, ambient in enumerate(result.dataset["ambient"].values):
        columns = list(history_columns(result, run).values())
        # Long after the start, steps are short: nine digits of time.
        line = f"{ambient:.9g},%.9g," + ",".join([DIGITS] * (len(columns) - 1)) + last + "\n"
        for first in range(0, len(columns[0]), CSV_BLOCK):
            block = np.column_stack([column[first : first + CSV_BLOCK] for column in columns])
            yield (line * len(block)) % tuple(block.ravel().tolist())


def history_columns(result: Result, run: int) -> dict[str, NDArray[np.float64]]:
    """Columns of the history of one run, by their heads.

    Parameters
    ----------
    result : of which the kept steps are taken.
    run : index of the ambient temperature.
    """
    data = result.dataset
    count = int((data["segment"].values[run] >= 0).sum())
    columns = {"time_s": result.time(run)[:count]}
    columns |= {head: data[name].values[run, :count] for head, name in HEADS.items()}
    if "rubber_temperature" in data:
        layers = data["rubber_temperature"].values[run, :count].T
        columns |= {f"rubber{j}_degC": layer for j, layer in enumerate(layers, 1)}
    if result.has_lead:
        columns["lead_degC"] = data["lead_temperature"].values[run, :count]
    return columns


def load_cyclic(path: str | Path) -> Result:
    """A saved result of a cyclic test again; see `load_result`, which reads any.

    Raises
    ------
    InputError : there is no readable result of a cyclic test at that path.
    """
    dataset = read_dataset(path, ("case",))
    if "structure" in dataset.attrs:
        raise InputError("is the result of an earthquake study, not of a test", str(path))
    return Result(read_dataset(path, ("bearing", "case", "segments")))
