"""Measures of each cycle of a record, without a model."""

import math
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, printable
from thermobearing.border.lazy import pd
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.cycles import closing_cycles
from thermobearing.identify.records.record import PAUSE, TestRecord, build_record
from thermobearing.identify.records.temperatures import check_thermocouples
from thermobearing.identify.records.treatment import describe_treatment
from thermobearing.identify.records.turns import amplitudes_between
from thermobearing.quantities.governing import largest_by
from thermobearing.quantities.words import joined, number, percent
from thermobearing.results import drawing
from thermobearing.results.directory import CYCLE_TABLE, FIGURES, write_directory
from thermobearing.results.figure_style import Wanted, figure_style
from thermobearing.results.metrics import CycleMeasures, cut_cycles, measure_history
from thermobearing.results.writing import without_formulas, write_summary
from thermobearing.tables.laboratory import read_laboratory

STILL = 0.02  # of the largest displacement: moved less over a gap in time, the bearing rested
NEAR = 5  # cycles whose strains agree within so many percent share a panel
FEW = 5  # cycles that a title names one by one
MOST_ACROSS = 2  # panels
UNCUT = 0.0005  # of an amplitude: nearer to the samples than a turn is one of them


@dataclass(frozen=True)
class MeasuredCycles:
    """Measures of the full cycles of a history."""

    measures: list[CycleMeasures]  # in the order of time
    ends: list[str]  # of each cycle: "closed", or "rest" where the motion stops at zero
    notes: list[str]  # on rests, spikes, drift, cycles left out, columns not used
    record: TestRecord  # as measured, without spikes and drift if its sidecar requests it
    rows: list[slice]  # samples of each cycle
    total_rubber_thickness: float  # [mm]

    @property
    def table(self) -> "pd.DataFrame":
        """A row per full cycle: number, strain, measures with units, and the type of its end."""
        rows = [
            {"cycle": number, "strain": strain} | asdict(cycle) | {"ends": ends}
            for number, (strain, cycle, ends) in enumerate(
                zip(self.strains, self.measures, self.ends, strict=True), 1
            )
        ]
        return pd.DataFrame(rows).rename(columns={"stiffness_kN_mm": "K_eq_kN_mm"})

    @cached_property
    def strains(self) -> list[float]:
        """Amplitude of each cycle over the rubber thickness; turns may be between two samples."""
        ends = [(rows.start, rows.stop - 1) for rows in self.rows]
        amplitudes = amplitudes_between(self.record, ends)
        return [amplitude / self.total_rubber_thickness for amplitude in amplitudes]

    def save(
        self, directory: str | Path, *, overwrite: bool = False, figures: Wanted = True
    ) -> Path:
        """Write summary.json, cycles.csv and the figure of the loops; return the directory."""

        def _fill(folder: Path) -> None:
            summary = {"command": "measure", "outcome": "completed", "file": self.record.file}
            cycles = self.table.to_dict("records")
            write_summary(folder, summary | {"notes": list(self.notes), "cycles": cycles})
            without_formulas(self.table).to_csv(folder / CYCLE_TABLE, index=False)
            if figures:
                with figure_style(figures):
                    drawing.save_figures({"loops": partial(_draw_loops, self)}, folder / FIGURES)

        return write_directory(Path(directory), _fill, overwrite=overwrite)


def measure_cycles(path: str | Path, bearing: Bearing) -> MeasuredCycles:
    """Measure the full cycles in a laboratory file.

    `path` is a table with displacement and force, or its sidecar; `bearing` gives the plan area and
    the rubber thickness. A file without a full cycle, or that the checks of a calibration refuse,
    raises InputError.
    """
    readings = read_laboratory(path)
    values = {name: samples for name, samples in readings.values.items() if name != "ambient"}
    record = build_record(replace(readings, values=values))
    # A measured loop depends on no temperature; a column of them in a wrong unit is still told.
    stated = readings.sidecar.ambient
    temperatures = list(
        check_thermocouples(replace(record, ambient=math.nan if stated is None else stated))
    )
    record = replace(record, temperatures={}, conditioning=None, unclear="", assumptions=())
    report = check_test(record, bearing)
    refused = [
        finding.sentence
        for finding in report.findings
        if finding.level == "refused" and finding.check != "cycles"
    ]
    if refused:
        raise InputError(refused, str(path))
    notes = [*readings.assumptions, *(f.sentence for f in report.findings if f.level == "warning")]
    notes += [finding.sentence for finding in temperatures]
    rests: list[tuple[int, int]] = []
    if (treatment := report.treatment) is not None:
        resting = np.abs(np.diff(record.displacement)) <= STILL * record.peak_displacement
        # Loggers that sleep in a rest leave a gap without motion instead of samples.
        unlogged = np.flatnonzero((np.diff(record.time) > PAUSE) & resting).tolist()  # not logged
        record, rests = (
            treatment.cleaned,
            sorted([*treatment.rests, *((k, k + 1) for k in unlogged)]),
        )
        removed = [f for f in describe_treatment(treatment) if f.level == "note"]
        notes += [f.sentence for f in removed if f.check in ("gaps", "spikes", "drift")]
    x = record.displacement
    cycles = cut_cycles(x, rests=rests)
    full = [cycle for cycle in cycles if cycle.ends != "incomplete"]
    ends = [cycle.ends for cycle in full]
    if len(ends) < len(cycles):
        notes.append("an incomplete cycle is not measured")
    if "rest" in ends:
        notes.append("a cycle before a rest ends where the motion stops: Q_d uses the force there")
    if readings.unused:
        notes.append(f"columns not used: {', '.join(readings.unused)}")
    rubber = bearing.total_rubber_thickness
    size = {"area": bearing.area, "total_rubber_thickness": rubber}
    try:
        measures = measure_history(x, record.force, rests=rests, **size)
    except InputError as error:
        raise InputError(error.problems, str(path)) from None
    rows = [slice(cycle.first, cycle.last + 1) for cycle in full]
    measured = MeasuredCycles(measures, ends, notes, record, rows, rubber)
    return replace(measured, notes=[*notes, *_describe_cycles(measured)])


def _describe_cycles(measured: MeasuredCycles) -> list[str]:
    """Return notes on closing cycles, and on turns between two samples."""
    notes = []
    amplitudes = [cycle.amplitude_mm for cycle in measured.measures]
    closing = closing_cycles(amplitudes)
    if numbers := [str(place) for place, flag in enumerate(closing, 1) if flag]:
        notes.append(
            "closing cycles, which stop the motion after a level, and which a calibration counts "
            f"but does not list: {joined(numbers)}; their Q_d is no strength"
        )
    shares = [
        measured.total_rubber_thickness * strain / amplitude - 1.0
        for strain, amplitude in zip(measured.strains, amplitudes, strict=True)
    ]
    cut = largest_by(shares, abs) if shares else 0.0
    if abs(cut) > UNCUT:
        notes.append(
            "strains are those of the turns between two samples, by up to "
            f"{number(100.0 * cut, '+.1f')} % from those of the samples; other measures are of the "
            "samples"
        )
    return notes


def _draw_loops(measured: MeasuredCycles) -> Figure:
    """Draw the loop of each full cycle, those of about one amplitude in a panel."""
    levels: dict[int, list[int]] = {}
    for place, strain in enumerate(measured.strains):
        levels.setdefault(round(100.0 * strain / NEAR) * NEAR, []).append(place)
    across = min(len(levels), MOST_ACROSS)
    down = math.ceil(len(levels) / across)
    title = f"{printable(measured.record.name)}: {len(measured.measures)} full cycles"
    size = (drawing.WIDEST, 0.8 + 2.6 * down)
    figure, axes = drawing.panels(down, across, size, title)
    x, force = measured.record.displacement, measured.record.force
    for ax, (_, numbers) in zip(axes, sorted(levels.items()), strict=False):
        colours = drawing.ordered_colours(len(numbers), "viridis")
        for place, colour in zip(numbers, colours, strict=True):
            rows = measured.rows[place]
            ax.plot(x[rows], force[rows], color=colour, linewidth=0.8)
        listed = ", ".join(str(place + 1) for place in numbers)
        if len(numbers) > FEW:
            listed = f"{numbers[0] + 1} (dark) to {numbers[-1] + 1}"
        strain = float(np.mean([measured.strains[place] for place in numbers]))
        name = f"{percent(strain)}: {'cycle' if len(numbers) == 1 else 'cycles'} {listed}"
        drawing.name_axes(ax, "displacement [mm]", "force [kN]", name)
    for ax in axes[len(levels) :]:
        ax.set_axis_off()
    return figure
