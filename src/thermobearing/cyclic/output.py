"""Directory and console tables of a displacement-controlled test."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.cyclic.dataset import COMPLETE, thinned
from thermobearing.cyclic.result import Result, run_name
from thermobearing.results.directory import (
    COMPARISON,
    DATASET,
    FIGURES,
    HISTORY,
    RESOLVED,
    write_directory,
)
from thermobearing.results.metrics import CycleMeasures
from thermobearing.results.ranges import titles_passed
from thermobearing.results.saved import read_dataset
from thermobearing.results.screen import print_table, print_warnings, say
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
    overwrite: bool = False,
    figures: bool = True,
    compared: dict[str, Result] | None = None,
) -> Path:
    """Write summary.json, result.nc, history.csv, case.resolved.toml and figures.

    Parameters
    ----------
    result : what to write.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
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

    return write_directory(directory, fill, overwrite=overwrite)


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


SCREEN_HEADS = (
    "strain",
    "cycle",
    "G_e MPa",
    "K_eq kN/mm",
    "h_eq",
    "energy kN mm",
    "Q_d kN",
    "K_d kN/mm",
)


def print_result(result: Result, compared: dict[str, Result] | None = None) -> None:
    """Per-cycle table of each run, its energy books, and earlier models beside it."""
    say(f"{result.dataset.attrs['title']} ({result.dataset.attrs['scheme']})", "bold")
    print_warnings(result.warnings)
    cycles, reached = result.cycles, result.tested_range.to_dict("records")
    warm = [str(name) for name in cycles.columns if _is_place(str(name))]
    for run, ambient in enumerate(result["ambient"].values):
        mine = cycles[cycles["ambient_degC"] == ambient] if len(cycles) else cycles
        rows = [
            [*_cycle_cells(row), *(f"{row[name]:.2f}" for name in warm)]
            for row in mine.to_dict("records")
        ]
        untested = titles_passed(reached, run_name(float(ambient)))
        told = f"; not tested: {untested}" if untested else ""
        if rows:
            heads = [*SCREEN_HEADS, *(_place_title(name) for name in warm)]
            print_table(heads, rows, title=f"{ambient:g} degC{told}", keys=2)
        _print_books(result, run)
    if compared:
        _print_comparison(compared)


def _print_comparison(results: dict[str, Result]) -> None:
    """Errors of the earlier models, one row per ambient temperature and model."""
    from thermobearing.cyclic.comparison import comparison_table

    rows = comparison_table(results, next(iter(results)))
    shown = {
        "ambient_degC": "degC",
        "model": "model",
        "inner layer largest K": "inner K",
        "lead largest K": "lead K",
        "peak force %": "peak f %",
        "last G_e %": "G_e %",
        "last h_eq %": "h_eq %",
        "last energy %": "energy %",
    }
    names = [name for name in shown if name in rows]
    title = "earlier models: largest temperature error, error of the peak force and the last cycle"
    cells = [
        [v if isinstance(v, str) else f"{v:.3g}" for v in row]
        for row in rows[names].itertuples(index=False)
    ]
    print_table([shown[name] for name in names], cells, title=title, keys=2)
    for early in rows[rows["outcome"] != "completed"].to_dict("records"):
        about = (
            f"{early['model']} at {early['ambient_degC']:g} degC ended early: {early['outcome']}"
        )
        say(f"{about}; its errors are those until then", "yellow")


def _is_place(name: str) -> bool:
    """Whether a column of the cycles is a temperature of a layer or of the lead."""
    return name.startswith("rubber") or name == "lead_degC"


def _place_title(name: str) -> str:
    place = name.removesuffix("_degC")
    return f"{place.replace('rubber', 'layer ')} degC"


def _cycle_cells(row: dict[Any, Any]) -> list[str]:
    return [
        f"{row['amplitude_strain']:.0%}",
        f"{row['cycle']:d}",
        f"{row['G_eq_MPa']:.3f}",
        f"{row['K_eq_kN_mm']:.3f}",
        f"{row['h_eq']:.4f}",
        f"{row['energy_kN_mm']:.0f}",
        f"{row['characteristic_strength_kN']:.2f}",
        f"{row['post_yield_stiffness_kN_mm']:.3f}",
    ]


def _print_books(result: Result, run: int) -> None:
    books = result.energy.iloc[run]
    steps = int(result["steps"].values[run])
    softened = int(result["softened_steps"].values[run])
    mismatch = float(result["layer_force_mismatch_max"].values[run])
    lost = books["heat_lost_ends_kN_mm"] + books["heat_lost_sides_kN_mm"]
    say(
        f"{books['ambient_degC']:g} degC: work in {books['work_in_kN_mm']:.0f} kN mm = heat "
        f"{books['heat_released_kN_mm']:.0f} + recoverable {books['recoverable_kN_mm']:.0f}; "
        f"heat = stored {books['heat_stored_kN_mm']:.0f} + lost {lost:.0f}; residuals "
        f"{books['mechanical_residual']:.1e} (mechanical), "
        f"{books['thermal_residual']:.1e} (thermal)"
    )
    if softened:
        say(
            f"  softened layers in {softened} of {steps} steps, layer law at most "
            f"{mismatch:.3g} kN from the force"
        )


def print_measures(
    cycles: list[CycleMeasures], ends: list[str], total_rubber_thickness: float
) -> None:
    """Measures of each cycle of a measured history, and how it ends."""
    heads = ("cycle", "strain", *SCREEN_HEADS[2:], "ends")
    rows = [
        (
            str(number),
            f"{m.amplitude_mm / total_rubber_thickness:.1%}",
            f"{m.G_eq_MPa:.3f}",
            f"{m.stiffness_kN_mm:.3f}",
            f"{m.h_eq:.4f}",
            f"{m.energy_kN_mm:.0f}",
            f"{m.characteristic_strength_kN:.2f}",
            f"{m.post_yield_stiffness_kN_mm:.3f}",
            end,
        )
        for number, (m, end) in enumerate(zip(cycles, ends, strict=True), 1)
    ]
    print_table(heads, rows)
