"""Measures of each cycle of a record, without a model."""

import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from thermobearing.bearing.model import Bearing
from thermobearing.border.deprecated import renamed
from thermobearing.border.errors import InputError, printable
from thermobearing.identify.fit.forward import PAUSE
from thermobearing.identify.records.checks import plausibility
from thermobearing.identify.records.cycles import full_cycles
from thermobearing.identify.records.record import TestRecord, build_record
from thermobearing.identify.records.treatment import told, treat
from thermobearing.results import drawing
from thermobearing.results.directory import FIGURES, VALIDATED_CYCLES, write_directory
from thermobearing.results.metrics import CycleMeasures, found_cycles, measure_history
from thermobearing.results.writing import without_formulas, write_summary
from thermobearing.tables.laboratory import read_laboratory

STILL = 0.02  # of the largest displacement: moved less over a gap in time, the bearing rested


@dataclass(frozen=True)
class MeasuredCycles:
    """What the full cycles of a history measure.

    Attributes
    ----------
    measures : of each full cycle, in the order of time.
    ends : of each: "closed", or "rest" where the motion stops at zero.
    notes : what else was found: rests, spikes, drift, a cycle left out, columns not used.
    record : what was measured, spikes and drift taken out where its sidecar tells so.
    rows : samples of each full cycle.
    total_rubber_thickness : that strains are of [mm].
    """

    measures: list[CycleMeasures]
    ends: list[str]
    notes: list[str]
    record: TestRecord
    rows: list[slice]
    total_rubber_thickness: float

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see `_save_measured`.

        Parameters
        ----------
        directory, force, figures : as in `_save_measured`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        return _save_measured(self, Path(directory), overwrite=overwrite, figures=figures)


def measured_cycles(path: str | Path, bearing: Bearing) -> MeasuredCycles:
    r"""Measures of the full cycles in a laboratory's file.

    Parameters
    ----------
    path : a table with displacement and force, or its sidecar.
    bearing : of the test: plan area and rubber thickness.

    Returns
    -------
    MeasuredCycles

    Raises
    ------
    InputError : a file that cannot be read, no full cycle.

    Examples
    --------
    >>> import tempfile
    >>> import thermobearing as tb
    >>> t = np.linspace(0.0, 2.0, 401)
    >>> x = 30.0 * np.sin(2.0 * np.pi * t)
    >>> rows = "".join(f"{a},{b},{2.0 * b}\n" for a, b in zip(t, x))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "t.csv"
    ...     _ = file.write_text("time_s,displacement_mm,force_kN\n" + rows)
    ...     found = measured_cycles(file, tb.load_bearing("shen-hdr-specimen"))
    >>> [round(cycle.stiffness_kN_mm, 3) for cycle in found.measures], found.ends
    ([2.0, 2.0], ['closed', 'closed'])
    """
    readings = read_laboratory(path)
    values = {name: some for name, some in readings.values.items() if name != "ambient"}
    record = build_record(replace(readings, values=values))
    notes = list(readings.assumptions)
    rests: list[tuple[int, int]] = []
    if (np.diff(record.time) > 0.0).all() and np.ptp(record.displacement) and np.ptp(record.force):
        found = treat(record)
        record, rests = found.cleaned, sorted([*found.rests, *_gaps(record)])
        notes += [sentence for _, check, sentence in told(found) if check in ("spikes", "drift")]
    x = record.displacement
    cycles = found_cycles(x, rests=rests)
    full = [cycle for cycle in cycles if cycle.ends != "incomplete"]
    ends = [cycle.ends for cycle in full]
    if len(ends) < len(cycles):
        notes.append("a cycle that is not complete was left out")
    if "rest" in ends:
        notes.append("a cycle before a rest ends where the motion stops: Q_d takes the force there")
    if full_cycles(record):
        notes += [said for level, _, said in plausibility(record, bearing) if level != "note"]
    if readings.unused:
        notes.append(f"columns not used: {', '.join(readings.unused)}")
    try:
        measures = measure_history(
            x,
            record.force,
            area=bearing.area,
            total_rubber_thickness=bearing.total_rubber_thickness,
            rests=rests,
        )
    except InputError as error:
        raise InputError(error.problems, str(path)) from None
    rows = [slice(cycle.first, cycle.last + 1) for cycle in full]
    return MeasuredCycles(measures, ends, notes, record, rows, bearing.total_rubber_thickness)


def _gaps(record: TestRecord) -> list[tuple[int, int]]:
    """Rests that the logger slept through: two samples, long apart and close together."""
    still = np.abs(np.diff(record.displacement)) <= STILL * record.peak_displacement
    long = np.flatnonzero((np.diff(record.time) > PAUSE) & still)
    return [(k, k + 1) for k in long.tolist()]


TITLES = {"stiffness_kN_mm": "K_eq_kN_mm"}  # as in the cycles of a result
NEAR = 5  # cycles share a panel whose strain is the same to so many percent
FEW = 5  # cycles that a title names one by one
MOST_ACROSS = 2  # panels
MAP = "viridis"


def _measured_table(found: MeasuredCycles) -> pd.DataFrame:
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


def _save_measured(
    found: MeasuredCycles, directory: Path, *, overwrite: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, cycles.csv and the picture of the loops.

    Parameters
    ----------
    found : from `measured_cycles`.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
    figures : draw the picture too.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        table = _measured_table(found)
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
            drawing.save_figures({"loops": lambda: _loops_figure(found)}, folder / FIGURES)

    return write_directory(directory, fill, overwrite=overwrite)


def _loops_figure(found: MeasuredCycles) -> Figure:
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
