"""Measures of each cycle of a laboratory's file, rests and unfinished cycles told apart."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.sidecar import read_laboratory
from thermobearing.identify.cycles import cycles_of
from thermobearing.identify.forward import PAUSE
from thermobearing.identify.plausible import plausibility
from thermobearing.identify.record import TestRecord, record_of
from thermobearing.identify.treatment import told, treat
from thermobearing.results.metrics import CycleMeasures, found_cycles, measure_history

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

    def save(self, directory: str | Path, *, force: bool = False, figures: bool = True) -> Path:
        """Write a result directory; see `save_measured`.

        Parameters
        ----------
        directory, force, figures : as in `save_measured`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.identify.measured_files import save_measured

        return save_measured(self, Path(directory), force=force, figures=figures)


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
    record = record_of(replace(readings, values=values))
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
    if cycles_of(record):
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
