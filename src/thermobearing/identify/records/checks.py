"""Checks of a test record before it is used."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.text_file import file_names
from thermobearing.core.records import Floats
from thermobearing.identify.records.cycles import Cycle, compute_measures, loop_middles, split_runs
from thermobearing.identify.records.record import PAUSE, TestRecord, load_test
from thermobearing.identify.records.treatment import (
    SURE,
    UNITS,
    Finding,
    Treatment,
    describe_treatment,
    note,
    refuse,
    treat,
    warn,
)
from thermobearing.quantities.governing import largest_by
from thermobearing.results.directory import FIGURES, write_directory
from thermobearing.results.figure_style import Wanted, figure_style
from thermobearing.results.metrics import loop_energy
from thermobearing.results.writing import write_summary

SOFTEST, STIFFEST = 0.2, 12.0  # equivalent shear modulus of bearings, cold ones too [MPa]
LARGEST_STRAIN, SMALLEST_STRAIN = 4.0, 0.05
OTHER_RUBBER = 0.02  # of the total rubber thickness: how far that of the file may be from it
TONF = 9.80665
SLIPS = (  # factors on force and displacement that would correct a mistake, and the mistake
    (TONF, 1.0, "force in tonf labelled kN"),
    (1.0 / TONF, 1.0, "force in kN labelled tonf"),
    (1e-3, 1.0, "force in N labelled kN"),
    (1e3, 1.0, "force in kN labelled N"),
    (1.0, 10.0, "displacement in cm labelled mm"),
    (1.0, 0.1, "displacement in mm labelled cm"),
)
FEW_SAMPLES, FEWEST_SAMPLES = 40, 12  # in a cycle: warned, refused
GAP_FACTOR = 5.0  # a sampling gap longer than this times the usual one, while moving
GAP_WAY = 0.05  # of the largest displacement, covered without a sample
OFFSET = 0.03  # of the largest force or displacement, middle of the cycles, however few
SLIGHT, FEWEST_ZEROS = 0.005, 4  # the same where so many cycles agree on it (SURE)
ENDS_AWAY = 0.1  # of the largest displacement
MARKS = {"refused": "REFUSED", "warning": "warning", "note": "note"}
CLIPPED_RUN = 4  # samples in a row at exactly the extreme force ...
CLIPPED_WAY = 0.02  # ... while the bearing moves this part of the largest displacement
SLOWEST, FASTEST = 0.01, 2000.0  # mean speed [mm/s]
COLDEST, HOTTEST = -80.0, 250.0  # thermocouples [degC]


@dataclass
class CheckReport:
    """The findings in a record."""

    record: TestRecord
    cycles: list[Cycle] = field(default_factory=list)  # full ones
    findings: list[Finding] = field(default_factory=list)  # in the order of the checks
    # Samples at which the force was saturated; a calibration ignores them.
    clipped: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    treatment: Treatment | None = None  # None for what is no test at all

    @property
    def steady(self) -> TestRecord:
        """The record with rests held and spikes bridged, which most checks use."""
        return self.treatment.steady if self.treatment else self.record

    @property
    def refusals(self) -> list[str]:
        """Reasons why the record cannot be used in a calibration; empty if it can."""
        where = self.record.file or self.record.name
        return [f"{where}: {f.sentence}" for f in self.findings if f.level == "refused"]

    @property
    def outcome(self) -> str:
        """The most severe level: "refused", "warning" or "good"."""
        return _gravest({finding.level for finding in self.findings})


def _gravest(levels: set[Any]) -> str:
    return next((level for level in ("refused", "warning") if level in levels), "good")


def check_test(
    record: TestRecord | str | Path, bearing: Bearing | str | Path | None = None
) -> CheckReport:
    """Check a record.

    Parameters
    ----------
    record : a test, or its file as in `load_test`.
    bearing : plan area and rubber thickness, for the plausibility of strains and stresses: a
        Bearing, a library name, or a TOML file.

    Returns
    -------
    CheckReport : for any record; see its `refusals`.

    Raises
    ------
    InputError : the file cannot be read; there is no such bearing.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 10.0, 500)
    >>> still = record_from_arrays(t, 0.0 * t, np.sin(t), 23.0)
    >>> check_test(still).outcome
    'refused'
    """
    record = record if isinstance(record, TestRecord) else load_test(record)
    bearing = None if bearing is None else as_bearing(bearing)
    report = CheckReport(record, clipped=np.zeros(len(record.time), dtype=bool))
    findings = report.findings
    findings += _check_file(record)
    if refused := list(_check_numbers(record)):
        findings += refused
        return report
    report.treatment = treat(record)
    report.cycles = cycles = report.treatment.cycles
    findings += describe_treatment(report.treatment)
    steady = report.steady
    if refused := list(_check_sign(steady, cycles)):
        findings += refused
        return report
    report.clipped = _find_clipped(record)
    full = [cycle for cycle in cycles if not cycle.closing]
    findings += _check_sampling(steady, full)
    findings += _check_cycles(steady, full)
    findings += _check_zero(steady, cycles)
    if report.clipped.any():
        largest = float(np.abs(record.force[report.clipped]).max())
        said = (
            f"the force is clipped at {largest:.4g} kN in {int(report.clipped.sum())} samples: the "
        )
        said += (
            "load cell or amplifier was saturated; a calibration ignores these samples, and the "
        )
        findings.append(warn("saturation", said + "peak forces of the test are too small"))
    if bearing is not None and cycles:
        findings += check_plausibility(steady, bearing)
    findings += _check_thermocouples(record)
    return report


def _check_file(record: TestRecord) -> Iterator[Finding]:
    """Yield assumptions, and content of the file that is not used."""
    for text in record.assumptions:
        yield warn("assumed", text)
    if record.unused:
        yield note("columns", f"columns not used: {', '.join(record.unused)}")
    if record.rubber_thickness is not None:
        said = "the ratio of displacement to strain gives a total rubber thickness of "
        yield note("rubber", f"{said}{record.rubber_thickness:.4g} mm")


def _check_numbers(record: TestRecord) -> Iterator[Finding]:
    """Yield a refusal if time does not increase or a signal is constant."""
    back = np.flatnonzero(~(np.diff(record.time) > 0.0))
    if len(back):
        k = int(back[0])
        said = f"time does not increase from {record.time[k]:g} to {record.time[k + 1]:g} s (rows "
        yield refuse("time", f"{said}{k + 1} and {k + 2}): were files joined, or columns swapped?")
        return
    for name, unit in UNITS.items():
        values = getattr(record, name)
        if np.ptp(values) <= 1e-9 * max(1.0, float(np.abs(values).max())):
            yield refuse(name, f"{name} is constant at {values[0]:g} {unit}")
            return


def _check_sign(record: TestRecord, cycles: list[Cycle]) -> Iterator[Finding]:
    """Yield a refusal unless the loops dissipate, with the force along the displacement."""
    d, f = record.displacement, record.force
    loops = [slice(c.first, c.last + 1) for c in cycles] or [slice(None)]
    energy = sum(loop_energy(d[rows], f[rows]) for rows in loops)
    along = float(np.corrcoef(d, f)[0, 1])
    if energy < 0.0 and along > 0.0:
        said = f"the loops generate energy ({energy:.4g} kN mm) although the force has the sign of "
        said += "the displacement: the columns of displacement and force seem to be swapped"
        yield refuse("columns", said)
    elif not along > 0.0:
        said = "the force has the opposite sign of the displacement: set flip_force = true in the "
        said += "sidecar"
        yield refuse("sign", said)


def _check_sampling(record: TestRecord, full: list[Cycle]) -> Iterator[Finding]:
    """Yield gaps while the bearing moves, implausible speeds, cycles of few samples."""
    gaps, ways = np.diff(record.time), np.abs(np.diff(record.displacement))
    moving = ways > 1e-4 * record.peak_displacement
    usual = float(np.median(gaps[moving])) if moving.any() else float(np.median(gaps))
    same_block = np.diff(record.block) == 0
    lost = (gaps > GAP_FACTOR * usual) & (ways > GAP_WAY * record.peak_displacement) & same_block
    for k in np.flatnonzero(lost)[:3]:
        said = f"no samples from {record.time[k]:.4g} to {record.time[k + 1]:.4g} s, while the "
        yield warn("sampling", f"{said}bearing moved {ways[k]:.3g} mm")
    speed = float(np.sum(ways[moving]) / max(float(np.sum(gaps[moving])), 1e-12))
    if not SLOWEST <= speed <= FASTEST:
        said = f"the mean speed is {speed:.3g} mm/s: check the units of time and displacement"
        yield warn("speed", said)
    rests = int(((gaps > PAUSE) & ~moving).sum())
    said = f"{len(record.time)} samples, usually {1e3 * usual:.3g} ms apart, mean speed {speed:.3g}"
    yield note("sampling", f"{said} mm/s, {rests} gaps longer than {PAUSE:g} s at rest")
    fewest = min((c.last - c.first for c in full), default=FEW_SAMPLES)
    if fewest < FEW_SAMPLES:
        said = f"a cycle has only {fewest} samples"
        yield (refuse if fewest < FEWEST_SAMPLES else warn)("sampling", said)


def _check_cycles(record: TestRecord, full: list[Cycle]) -> Iterator[Finding]:
    """Yield the number of full cycles, and a record that does not begin and end at zero."""
    if not full:
        said = "no full cycle (zero, one side, other side, zero) was found: a calibration needs "
        said += "reversals"
        yield refuse("cycles", said)
        return
    if len(full) == 1:
        said = "only one cycle: the tests cannot distinguish an unscragged loop from later ones, "
        yield warn("cycles", said + "amplitude dependence (b) from stiffness, or heating from both")
    levels = sum(c.number == 1 for c in full)
    yield note("cycles", f"{len(full)} full cycles at {levels} successive amplitudes")
    first, last = record.displacement[0], record.displacement[-1]
    away = ENDS_AWAY * record.peak_displacement
    if abs(last) > away:
        said = f"the record ends at {last:.4g} mm, in the middle of a cycle: is it truncated?"
        yield warn("end", said)
    if abs(first) > away:
        said = f"the record begins at {first:.4g} mm: the model moves there first, from rest"
        yield warn("begin", said)


def _check_zero(record: TestRecord, cycles: list[Cycle]) -> Iterator[Finding]:
    """Yield the zero of force and displacement, from the middle of the loops."""
    near = []
    for name, peak in ("force", record.peak_force), ("displacement", record.peak_displacement):
        values = getattr(record, name)
        middles, zeros = loop_middles(values, cycles), _loop_zeros(values, cycles)
        if len(middles) == 0:
            continue
        offset = float(np.median(zeros if len(zeros) >= FEWEST_ZEROS else middles))
        error = float(zeros.std()) / np.sqrt(len(zeros)) if len(zeros) else np.inf
        sure = len(zeros) >= FEWEST_ZEROS and abs(offset) > max(SURE * error, SLIGHT * peak)
        shown = f"{offset:.2g} {UNITS[name]}"
        if abs(offset) > OFFSET * peak or sure:
            said = f"the middle of the {name} loops is at {shown} ({abs(offset) / peak:.1%} of the "
            said += f'peak), not at zero: set {name}_offset = "{shown}" in the sidecar to '
            yield warn("offset", said + "remove the offset")
        else:
            near.append(f"{shown} in the {name}")
    if near:
        said = f"offset of {' and '.join(near)}: not significant"
        yield note("zero", said)


def _loop_zeros(values: Floats, cycles: list[Cycle]) -> Floats:
    """Return the zero of a signal by each cycle that is the third of its amplitude or later.

    A rubber that softens makes the second side of each loop weaker than the first, by up to 1 %
    of the peak in the cold. So the first extreme is compared with the mean of those before and
    after it. First cycles lean to their first side and do not count.
    """
    full = [cycle for cycle in cycles if not cycle.closing]
    ends = []  # the two extremes of each loop, in the order of time
    for cycle in full:
        loop = values[cycle.first : cycle.last + 1]
        ends.append(loop[np.sort([loop.argmin(), loop.argmax()])])
    found = []
    for k in range(1, len(full)):
        if full[k - 1].number >= 2 and full[k].number == full[k - 1].number + 1:
            found.append(0.5 * ends[k][0] + 0.25 * (ends[k - 1][1] + ends[k][1]))
    return np.array(found)


def _find_clipped(record: TestRecord) -> NDArray[np.bool_]:
    """Return the samples whose force stays at exactly its extreme while the bearing moves on."""
    clipped = np.zeros(len(record.time), dtype=bool)
    for extreme in (record.force.max(), record.force.min()):
        for a, b in split_runs(np.abs(record.force - extreme) <= 1e-9 * record.peak_force):
            way = float(np.ptp(record.displacement[a : b + 1]))
            if b - a + 1 >= CLIPPED_RUN and way > CLIPPED_WAY * record.peak_displacement:
                clipped[a : b + 1] = True
    return clipped


def check_plausibility(record: TestRecord, bearing: Bearing) -> Iterator[Finding]:
    """Yield findings on the units of a test, from its largest strain and the shear modulus there.

    The record has its rests held and spikes bridged, and one full cycle at least. Numbers that no
    bearing has are refused.
    """
    rubber = bearing.total_rubber_thickness
    strain = record.peak_displacement / rubber
    reached = f"displacement reaches {record.peak_displacement:.4g} mm"
    if strain > LARGEST_STRAIN:
        said = f"{strain:.0%} of the total rubber thickness of {rubber:g} mm: wrong unit, or the "
        yield refuse("strain", f"{reached}, {said}wrong bearing?")
    elif strain < SMALLEST_STRAIN:
        said = f"displacement reaches only {strain:.1%} of the total rubber thickness: wrong unit?"
        yield warn("strain", said)
    file = record.rubber_thickness
    if file is not None and abs(file - rubber) > OTHER_RUBBER * rubber:
        said = f"displacement and strain give a total rubber thickness of {file:.4g} mm, but "
        said += f"the bearing has {rubber:g} mm: the wrong bearing, or a wrong unit?"
        yield warn("rubber", said)
    try:
        measured = compute_measures(record, record.force, bearing.area, rubber)
    except InputError:  # a cycle with too few samples, which the check of sampling has refused
        return
    modulus = largest_by(measured, lambda m: m.amplitude_mm).G_eq_MPa
    stated = f"the equivalent shear modulus at the largest amplitude is {modulus:.3g} MPa"
    if not SOFTEST <= modulus <= STIFFEST:
        less = "less than any rubber" if modulus < SOFTEST else "more than any bearing"
        yield refuse("unit", f"{stated}, {less} has{_suspected_slip(modulus, strain)}")
    else:
        yield note("unit", stated)


def _suspected_slip(modulus: float, strain: float) -> str:
    """Return the mistakes in units that would explain a modulus [MPa] and a strain."""
    said = [
        f"{what} ({modulus * force / way:.3g} MPa)"
        for force, way, what in SLIPS
        if SOFTEST < modulus * force / way < STIFFEST
        and SMALLEST_STRAIN < strain * way < LARGEST_STRAIN
    ]
    return f"; is {' or '.join(said)}?" if said else ""


def _check_thermocouples(record: TestRecord) -> Iterator[Finding]:
    """Yield thermocouples that look broken, or do not start near the ambient temperature."""
    for title, values in record.temperatures.items():
        if values.min() < COLDEST or values.max() > HOTTEST:
            ends = f"{values.min():.3g} to {values.max():.3g} degC"
            said = f"{title} reads {ends}: is the sensor broken?"
            yield warn("thermocouple", said)
        elif abs(values[0] - record.ambient) > 5.0:
            said = f"{title} starts at {values[0]:.3g} degC, but the ambient temperature is "
            said += f"{record.ambient:g} degC"
            yield warn("thermocouple", said)


def print_checks(reports: list[CheckReport]) -> None:
    """Print the outcome of each record, and a line for each finding."""
    for report in reports:
        print(f"{report.record.name}: {report.outcome}")
        for finding in report.findings:
            print(f"  {MARKS[finding.level]:8} {finding.check}: {finding.sentence}")


def save_checks(
    reports: list[CheckReport], directory: Path, *, overwrite: bool = False, figures: Wanted = True
) -> Path:
    """Write summary.json and a figure per record; return the directory."""
    records = [
        {
            "name": report.record.name,
            "file": report.record.file,
            "ambient_degC": report.record.ambient,
            "outcome": report.outcome,
            "cycles": len(report.cycles),
            "findings": [vars(finding) for finding in report.findings],
            "treatment": report.treatment.summary() if report.treatment else None,
        }
        for report in reports
    ]
    outcome = _gravest({report.outcome for report in reports})

    def _fill(folder: Path) -> None:
        write_summary(folder, {"command": "identify", "outcome": outcome, "records": records})
        if figures:
            from thermobearing.identify.records.figures import RecordFigures, draw_record

            names = file_names(report.record.name for report in reports)
            drawn = {
                f"check_{number}_{name}": partial(draw_record, report)
                for number, (name, report) in enumerate(zip(names, reports, strict=True), start=1)
            }
            with figure_style(figures):
                RecordFigures(drawn).save_all(folder / FIGURES)

    return write_directory(directory, _fill, overwrite=overwrite)
