"""Directory, figures and console tables of a sequence of tests."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.border.errors import InputError, is_file
from thermobearing.cyclic.result import load_cyclic
from thermobearing.earthquake.result import load_study
from thermobearing.results.directory import FIGURES, PARTS, RESOLVED, TABLE, write_directory
from thermobearing.results.drawing import (
    GREY,
    legend_below,
    name_axes,
    ordered_colours,
    panels,
    save_figures,
    thin,
)
from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.results.writing import write_csv, write_limits, write_summary
from thermobearing.sequences.case import HybridPart, load_sequence_case
from thermobearing.sequences.result import SequenceResult


def save_sequence(
    result: SequenceResult, directory: Path, *, overwrite: bool = False, figures: bool = True
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

    return write_directory(directory, fill, overwrite=overwrite)


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


MOST_POINTS = 1500  # of a line
WIDTH, HEIGHT = 2.3, 5.2  # of a part, of the figure [in]
LEAD = "#1a1a1a"


class SequenceFigures:
    """Views of a sequence."""

    def __init__(self, result: "SequenceResult") -> None:
        self.result = result

    def sequence(self) -> Figure:
        """Force over displacement, and temperatures in time, a column for each part."""
        result, case = self.result, self.result.case
        count = len(result.parts)
        size = (max(4.5, 0.9 + WIDTH * count), HEIGHT)
        figure, axes = panels(2, count, size, f"{case.name}: {case.bearing.name}")
        histories = [result.history(k) for k in range(count)]
        degrees = [str(n) for n in histories[0] if str(n).endswith("_degC")]
        colours = dict(zip(degrees, ordered_colours(len(degrees), "viridis"), strict=True))
        colours |= {"lead_degC": LEAD}
        for k, history in enumerate(histories):
            loop, warm = axes[k], axes[count + k]
            x, f = history["displacement_mm"].to_numpy(), history["force_kN"].to_numpy()
            loop.plot(x, f, color=GREY, linewidth=0.8)
            loop.plot(x[:1], f[:1], "o", color=GREY, markersize=3)
            name_axes(loop, "displacement [mm]", "force [kN]" if k == 0 else "", case.label(k))
            time = history["time_s"].to_numpy()
            scale, unit = (60.0, "min") if time[-1] > 600.0 else (1.0, "s")
            for name in degrees:
                values = history[name].to_numpy(dtype=float)
                kept = thin(values, MOST_POINTS)
                warm.plot(time[kept] / scale, values[kept], color=colours[name], linewidth=1.0)
            name_axes(warm, f"time [{unit}]", "temperature [degC]" if k == 0 else "")
        self._alike(axes[:count], moving=True)
        self._alike(axes[count:], moving=False)
        handles = [
            Line2D(
                [], [], color=colours[n], label=n.removesuffix("_degC").replace("rubber", "layer ")
            )
            for n in degrees
        ]
        legend_below(figure, handles)
        return figure

    def _alike(self, axes: list[Any], *, moving: bool) -> None:
        """The same limits in a row of panels."""
        low, high = np.array([ax.get_ylim() for ax in axes]).T
        for ax in axes:
            ax.set_ylim(low.min(), high.max())
        if moving:
            reach = max(abs(value) for ax in axes for value in ax.get_xlim())
            for ax in axes:
                ax.set_xlim(-reach, reach)

    def save_all(self, folder: Path) -> list[Path]:
        """Write every figure."""
        return save_figures({"sequence": self.sequence}, folder)


SHOWN = {  # column of the table: head, digits
    "displacement_end_mm": ("to mm", "{:.1f}"),
    "displacement_max_mm": ("max mm", "{:.1f}"),
    "force_start_kN": ("from kN", "{:.0f}"),
    "force_max_kN": ("max kN", "{:.0f}"),
    "energy_kN_mm": ("kN mm", "{:.0f}"),
}


def print_sequence(result: SequenceResult) -> None:
    """One row a part; inner layer and lead at its start and end."""
    case, rows = result.case, result.table
    say(f"{case.name}: {case.bearing.name}", "bold")
    print_warnings(result.warnings)
    stems = [name.removesuffix("_start_degC") for name in map(str, rows) if "_start_degC" in name]
    rubber = [stem for stem in stems if stem.startswith("rubber")][-1:]
    warm = rubber + [stem for stem in stems if stem == "lead"]
    heads = ["part", *(head for head, _ in SHOWN.values())]
    heads += [f"{stem.replace('rubber', 'layer ')} degC" for stem in warm]
    untested = rows["beyond_tested"].any() if "beyond_tested" in rows else False
    heads += ["not tested"] if untested else []
    cells = [
        (
            str(row["part"]),
            *(form.format(row[name]) for name, (_, form) in SHOWN.items()),
            *(f"{row[f'{s}_start_degC']:.1f} > {row[f'{s}_end_degC']:.1f}" for s in warm),
            *([str(row["beyond_tested"])] if untested else []),
        )
        for row in rows.to_dict("records")
    ]
    styles = ["" if outcome == "completed" else "red" for outcome in rows.get("outcome", [])]
    print_table(heads, cells, styles=styles)
