"""Result directory of `measure`: a table of its cycles, and a picture of the loops."""

import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from thermobearing.border.errors import printable
from thermobearing.identify.measured import MeasuredCycles
from thermobearing.results import drawing
from thermobearing.results.directory import FIGURES, VALIDATED_CYCLES, write_directory
from thermobearing.results.writing import without_formulas, write_summary

TITLES = {"stiffness_kN_mm": "K_eq_kN_mm"}  # as in the cycles of a result
NEAR = 5  # cycles share a panel whose strain is the same to so many percent
FEW = 5  # cycles that a title names one by one
MOST_ACROSS = 2  # panels
MAP = "viridis"


def measured_table(found: MeasuredCycles) -> pd.DataFrame:
    """A row per full cycle, its measures in columns named with units.

    Parameters
    ----------
    found : from `measured_cycles`.

    Returns
    -------
    DataFrame : `cycle`, `strain`, the measures of `CycleMeasures`, and how the cycle `ends`.
    """
    rows: list[dict[str, Any]] = [
        {"cycle": number, "strain": cycle.amplitude_mm / found.total_rubber_thickness}
        | {TITLES.get(key, key): value for key, value in asdict(cycle).items()}
        | {"ends": ends}
        for number, (cycle, ends) in enumerate(zip(found.measures, found.ends, strict=True), 1)
    ]
    return pd.DataFrame(rows)


def save_measured(
    found: MeasuredCycles, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, cycles.csv and the picture of the loops.

    Parameters
    ----------
    found : from `measured_cycles`.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
    figures : draw the picture too.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        table = measured_table(found)
        summary = {
            "command": "measure",
            "outcome": "completed",
            "file": found.record.file,
            "notes": list(found.notes),
            "cycles": table.to_dict("records"),
        }
        write_summary(folder, summary)
        without_formulas(table).to_csv(folder / VALIDATED_CYCLES, index=False)
        if figures:
            drawing.save_figures({"loops": lambda: loops_figure(found)}, folder / FIGURES)

    return write_directory(directory, fill, force=force)


def loops_figure(found: MeasuredCycles) -> Figure:
    """The loop of each full cycle, those of about one amplitude in a panel.

    Parameters
    ----------
    found : from `measured_cycles`.

    Returns
    -------
    Figure
    """
    levels: dict[int, list[int]] = {}
    for number, cycle in enumerate(found.measures):
        strain = cycle.amplitude_mm / found.total_rubber_thickness
        levels.setdefault(round(100.0 * strain / NEAR) * NEAR, []).append(number)
    across = min(len(levels), MOST_ACROSS)
    down = math.ceil(len(levels) / across)
    title = f"{printable(found.record.name)}: {len(found.measures)} full cycles"
    size = (drawing.WIDEST, 0.8 + 2.6 * down)
    figure, axes = drawing.panels(down, across, size, title)
    x, force = found.record.displacement, found.record.force
    for ax, (level, numbers) in zip(axes, sorted(levels.items()), strict=False):
        for number, colour in zip(numbers, drawing.ordered_colours(len(numbers), MAP), strict=True):
            rows = found.rows[number]
            ax.plot(x[rows], force[rows], color=colour, linewidth=0.8)
        which = ", ".join(str(number + 1) for number in numbers)
        if len(numbers) > FEW:
            which = f"{numbers[0] + 1} (dark) to {numbers[-1] + 1}"
        name = f"about {level} %: {'cycle' if len(numbers) == 1 else 'cycles'} {which}"
        drawing.name_axes(ax, "displacement [mm]", "force [kN]", name)
    for ax in axes[len(levels) :]:
        ax.set_axis_off()
    return figure
