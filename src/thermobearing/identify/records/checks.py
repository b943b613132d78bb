"""Checks of a test record before it is used."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.identify.fit.forward import PAUSE
from thermobearing.identify.records.cycles import Cycle, compute_measures, loop_middles, loop_zeros
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.records.treatment import SURE, UNITS, Treatment, told, treat
from thermobearing.results.metrics import loop_energy

Floats = NDArray[np.float64]
Words = tuple[Literal["refused", "warning", "note"], str, str]
SOFTEST, STIFFEST = 0.2, 12.0  # equivalent shear modulus of bearings, cold ones too [MPa]
LARGEST_STRAIN, SMALLEST_STRAIN = 4.0, 0.05
OTHER_RUBBER = 0.02  # of the total rubber thickness: how far that of the file may be from it
TONF = 9.80665
SLIPS = (  # factors on force and displacement that would mend it, and what was then mixed up
    (TONF, 1.0, "force in tonf labelled kN"),
    (1.0 / TONF, 1.0, "force in kN labelled tonf"),
    (1e-3, 1.0, "force in N labelled kN"),
    (1e3, 1.0, "force in kN labelled N"),
    (1.0, 10.0, "displacement in cm labelled mm"),
    (1.0, 0.1, "displacement in mm labelled cm"),
)


def plausibility(record: TestRecord, bearing: Bearing) -> Iterator[Words]:
    """What the largest strain and the modulus there say of units, as level, check and sentence.

    Parameters
    ----------
    record : a test with rests held and spikes bridged, with one full cycle at least.
    bearing : plan area and rubber thickness.

    Yields
    ------
    tuple of str : "refused" for numbers that no bearing has.

    Examples
    --------
    >>> import numpy as np
    >>> from thermobearing.bearing.library import load_bearing
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 201)
    >>> x = 30.0 * np.sin(2.0 * np.pi * t)
    >>> record = record_from_arrays(t, x, 2000.0 * x, 23.0)
    >>> [words[2] for words in plausibility(record, load_bearing("shen-hdr-specimen"))]
    ... # doctest: +ELLIPSIS
    ['... is 1.04e+03 MPa, more than any bearing has; is force in N labelled kN (1.04 MPa)?']
    """
    rubber = bearing.total_rubber_thickness
    strain = record.peak_displacement / rubber
    if strain > LARGEST_STRAIN:
        yield (
            "refused",
            "strain",
            f"displacement reaches {record.peak_displacement:.4g} mm, {strain:.0%} of the total "
            f"rubber thickness of {rubber:g} mm: wrong unit, or the wrong bearing?",
        )
    elif strain < SMALLEST_STRAIN:
        yield (
            "warning",
            "strain",
            f"displacement reaches {strain:.1%} of the total rubber thickness only: wrong unit?",
        )
    told = record.rubber_thickness
    if told is not None and abs(told - rubber) > OTHER_RUBBER * rubber:
        yield (
            "warning",
            "rubber",
            f"displacement over strain gives a total rubber thickness of {told:.4g} mm, but "
            f"the bearing has {rubber:g} mm: the wrong bearing, or a wrong unit?",
        )
    try:
        measured = compute_measures(record, record.force, bearing.area, rubber)
    except InputError:  # a cycle with too few samples, which the check of sampling has refused
        return
    modulus = max(measured, key=lambda m: m.amplitude_mm).G_eq_MPa
    stated = f"the equivalent shear modulus at the largest amplitude is {modulus:.3g} MPa"
    if modulus < SOFTEST:
        yield "refused", "unit", f"{stated}, less than any rubber has{_slip(modulus, strain)}"
    elif modulus > STIFFEST:
        yield "refused", "unit", f"{stated}, more than any bearing has{_slip(modulus, strain)}"
    else:
        yield "note", "unit", stated


def _slip(modulus: float, strain: float) -> str:
    """Slips of units that would make a modulus [MPa] and a largest strain plausible."""
    said = [
        f"{what} ({modulus * force / way:.3g} MPa)"
        for force, way, what in SLIPS
        if SOFTEST < modulus * force / way < STIFFEST
        and SMALLEST_STRAIN < strain * way < LARGEST_STRAIN
    ]
    return f"; is {' or '.join(said)}?" if said else ""


Level = Literal["refused", "warning", "note"]
FEW_SAMPLES, FEWEST_SAMPLES = 40, 12  # in a cycle: warned, refused
GAP_FACTOR = 5.0  # a sampling gap longer than this times the usual one, while moving
GAP_WAY = 0.05  # of the largest displacement, covered without a sample
OFFSET = 0.03  # of the largest force or displacement, middle of the cycles, however few
SLIGHT, FEWEST_ZEROS = 0.005, 4  # the same where so many cycles agree on it (SURE)
ENDS_AWAY = 0.1  # of the largest displacement
CLIPPED_RUN = 4  # samples in a row at exactly the extreme force ...
CLIPPED_WAY = 0.02  # ... while the bearing moves this part of the largest displacement
SLOWEST, FASTEST = 0.01, 2000.0  # mean speed [mm/s]
COLDEST, HOTTEST = -80.0, 250.0  # thermocouples [degC]


@dataclass(frozen=True)
class Finding:
    """One thing noticed: how grave, which check, and a sentence with numbers."""

    level: Level
    check: str
    sentence: str


@dataclass
class CheckReport:
    """What was found in a record.

    Attributes
    ----------
    record : what was looked at.
    cycles : full cycles, with their amplitude and number.
    findings : in the order of the checks.
    clipped : samples at which the force was saturated; a fit leaves them out.
    treatment : noise, rests, spikes and drift; None for what is no test at all.
    """

    record: TestRecord
    cycles: list[Cycle]
    findings: list[Finding] = field(default_factory=list)
    clipped: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    treatment: Treatment | None = None

    @property
    def steady(self) -> TestRecord:
        """The record with rests held and spikes bridged: what most checks look at."""
        return self.treatment.steady if self.treatment else self.record

    def refuse(self, check: str, sentence: str) -> None:
        """Say why the record cannot be fitted."""
        self.findings.append(Finding("refused", check, sentence))

    def warn(self, check: str, sentence: str) -> None:
        """Say what makes the record doubtful."""
        self.findings.append(Finding("warning", check, sentence))

    def note(self, check: str, sentence: str) -> None:
        """Say what is worth knowing."""
        self.findings.append(Finding("note", check, sentence))

    @property
    def refusals(self) -> list[str]:
        """Why the record cannot be fitted; empty if it can."""
        where = self.record.file or self.record.name
        return [f"{where}: {f.sentence}" for f in self.findings if f.level == "refused"]

    @property
    def outcome(self) -> str:
        """The gravest level: "refused", "warning" or "good"."""
        levels = {finding.level for finding in self.findings}
        return next((level for level in ("refused", "warning") if level in levels), "good")


def checks_summary(reports: list[CheckReport]) -> dict[str, Any]:
    """The content of summary.json for a look at tests: the findings of all records.

    Parameters
    ----------
    reports : from `check_test`, one per record.

    Returns
    -------
    dict : the gravest outcome of all, and the findings of each record.

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 10.0, 500)
    >>> checks_summary([check_test(record_from_arrays(t, 0.0 * t, np.sin(t), 23.0))])["outcome"]
    'refused'
    """
    outcomes = [report.outcome for report in reports]
    worst = next((o for o in ("refused", "warning") if o in outcomes), "good")
    return {
        "command": "identify",
        "outcome": worst,
        "records": [
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
        ],
    }


def check_test(
    record: TestRecord | str | Path, bearing: Bearing | str | Path | None = None
) -> CheckReport:
    """Look a record over.

    Parameters
    ----------
    record : a test, or its file as in `load_test`.
    bearing : plan area and rubber thickness, for the plausibility of strains and stresses: a
        Bearing, a library name, or a TOML file.

    Returns
    -------
    CheckReport : never raises for what is in the record; see `refusals`.

    Raises
    ------
    InputError : a file that cannot be read; no such bearing.

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
    report = CheckReport(record, [])
    report.clipped = np.zeros(len(record.time), dtype=bool)
    for text in record.assumptions:
        report.warn("assumed", text)
    if record.unused:
        report.note("columns", f"columns not used: {', '.join(record.unused)}")
    if record.rubber_thickness is not None:
        report.note(
            "rubber",
            f"displacement over strain gives a total rubber thickness of "
            f"{record.rubber_thickness:.4g} mm",
        )
    if not _is_a_test(report):
        return report
    report.treatment = treat(record)
    report.cycles = report.treatment.cycles
    report.findings += [Finding(*words) for words in told(report.treatment)]
    if not _sign(report):
        return report
    _sampling(report)
    _cycles(report)
    _centred(report)
    _clipping(report)
    if bearing is not None and report.cycles:
        report.findings += [Finding(*words) for words in plausibility(report.steady, bearing)]
    _temperatures(report)
    return report


def _is_a_test(report: CheckReport) -> bool:
    """Numbers that can be a test at all."""
    record = report.record
    if not (np.diff(record.time) > 0.0).all():
        k = int(np.argmin(np.diff(record.time) > 0.0))
        report.refuse(
            "time",
            f"time does not increase from {record.time[k]:g} to {record.time[k + 1]:g} s "
            f"(rows {k + 1} and {k + 2}): files joined, or columns swapped?",
        )
        return False
    for name, values, unit in (
        ("displacement", record.displacement, "mm"),
        ("force", record.force, "kN"),
    ):
        if np.ptp(values) <= 1e-9 * max(1.0, float(np.abs(values).max())):
            report.refuse(name, f"{name} is constant at {values[0]:g} {unit}")
            return False
    return True


def _sign(report: CheckReport) -> bool:
    """Loops that dissipate, with force along displacement."""
    record = report.steady
    d, f = record.displacement, record.force
    if report.cycles:
        loops = [slice(c.first, c.last + 1) for c in report.cycles]
        energy = sum(loop_energy(d[rows], f[rows]) for rows in loops)
    else:
        energy = loop_energy(d, f)
    along = float(np.corrcoef(d, f)[0, 1])
    if energy >= 0.0 and along > 0.0:
        return True
    if energy < 0.0 and along > 0.0:
        report.refuse(
            "columns",
            f"the loops give back work ({energy:.4g} kN mm) although force goes with displacement: "
            "the columns of displacement and force look swapped",
        )
    else:
        report.refuse(
            "sign",
            "force has the opposite sign of displacement: set flip_force = true in the sidecar",
        )
    return False


def _sampling(report: CheckReport) -> None:
    """Enough samples, none missing while the bearing moves, a plausible speed."""
    record = report.steady
    gaps, ways = np.diff(record.time), np.abs(np.diff(record.displacement))
    moving = ways > 1e-4 * record.peak_displacement
    usual = float(np.median(gaps[moving])) if moving.any() else float(np.median(gaps))
    same_block = np.diff(record.block) == 0
    lost = (gaps > GAP_FACTOR * usual) & (ways > GAP_WAY * record.peak_displacement) & same_block
    for k in np.flatnonzero(lost)[:3]:
        report.warn(
            "sampling",
            f"no samples from {record.time[k]:.4g} to {record.time[k + 1]:.4g} s, while the "
            f"bearing moved {ways[k]:.3g} mm",
        )
    speed = float(np.sum(ways[moving]) / max(float(np.sum(gaps[moving])), 1e-12))
    if not SLOWEST <= speed <= FASTEST:
        report.warn(
            "speed",
            f"mean speed is {speed:.3g} mm/s: is the unit of time or displacement right?",
        )
    report.note(
        "sampling",
        f"{len(record.time)} samples, usually {1e3 * usual:.3g} ms apart, mean speed "
        f"{speed:.3g} mm/s, {int(((gaps > PAUSE) & ~moving).sum())} gaps longer than {PAUSE:g} s "
        "at rest",
    )
    counts = [c.last - c.first for c in report.cycles if not c.closing]
    if counts and min(counts) < FEW_SAMPLES:
        say = report.refuse if min(counts) < FEWEST_SAMPLES else report.warn
        say("sampling", f"a cycle has only {min(counts)} samples")


def _cycles(report: CheckReport) -> None:
    """Full cycles, more than one, and an end where they end."""
    record = report.steady
    full = [c for c in report.cycles if not c.closing]
    if not full:
        report.refuse(
            "cycles",
            "no full cycle (zero, one side, other side, zero) was found: a fit needs reversals",
        )
        return
    if len(full) == 1:
        report.warn(
            "cycles",
            "one cycle only: nothing tells the virgin loop from the later ones, amplitude "
            "dependence (b) from stiffness, or heating from the rest",
        )
    levels = sum(c.number == 1 for c in full)
    report.note("cycles", f"{len(full)} full cycles at {levels} amplitudes in a row")
    if abs(record.displacement[-1]) > ENDS_AWAY * record.peak_displacement:
        report.warn(
            "end",
            f"the record ends at {record.displacement[-1]:.4g} mm, in the middle of a cycle: "
            "truncated?",
        )
    if abs(record.displacement[0]) > ENDS_AWAY * record.peak_displacement:
        report.warn(
            "begin",
            f"the record begins at {record.displacement[0]:.4g} mm: the model has to get there "
            "first, from rest",
        )


def _centred(report: CheckReport) -> None:
    """Zero of force and displacement, from the middle of the loops."""
    record = report.steady
    near = []
    for name, values, peak in (
        ("force", record.force, record.peak_force),
        ("displacement", record.displacement, record.peak_displacement),
    ):
        middles, zeros = loop_middles(values, report.cycles), loop_zeros(values, report.cycles)
        if len(middles) == 0:
            continue
        offset = float(np.median(zeros if len(zeros) >= FEWEST_ZEROS else middles))
        error = float(zeros.std()) / np.sqrt(len(zeros)) if len(zeros) else np.inf
        sure = len(zeros) >= FEWEST_ZEROS and abs(offset) > max(SURE * error, SLIGHT * peak)
        shown = f"{offset:.2g} {UNITS[name]}"
        if abs(offset) > OFFSET * peak or sure:
            report.warn(
                "offset",
                f"the middle of the {name} loops is at {shown} ({abs(offset) / peak:.1%} of the "
                f'peak), not at zero: left in; {name}_offset = "{shown}" in the sidecar takes it '
                "away",
            )
        else:
            near.append(f"{shown} in the {name}")
    if near:
        report.note(
            "zero",
            f"middle of the loops at {' and '.join(near)}: no more than these cycles can tell",
        )


def _clipping(report: CheckReport) -> None:
    """Force that stays at exactly its extreme while the bearing moves on."""
    record = report.record
    for extreme in (record.force.max(), record.force.min()):
        at = np.abs(record.force - extreme) <= 1e-9 * record.peak_force
        edges = np.flatnonzero(np.diff(np.concatenate([[False], at, [False]]).astype(np.int8)))
        for a, b in edges.reshape(-1, 2):
            way = float(np.ptp(record.displacement[a:b]))
            if b - a >= CLIPPED_RUN and way > CLIPPED_WAY * record.peak_displacement:
                report.clipped[a:b] = True
    count = int(report.clipped.sum())
    if count:
        largest = float(np.abs(record.force[report.clipped]).max())
        report.warn(
            "saturation",
            f"force is clipped at {largest:.4g} kN in {count} samples: the load cell or amplifier "
            "was saturated; a fit leaves them out, and peak forces of the test are too small",
        )


def _temperatures(report: CheckReport) -> None:
    """Thermocouples that work, and that start near the ambient."""
    record = report.record
    for title, values in record.temperatures.items():
        if values.min() < COLDEST or values.max() > HOTTEST:
            report.warn(
                "thermocouple",
                f"{title} runs from {values.min():.3g} to {values.max():.3g} degC: broken?",
            )
        elif abs(values[0] - record.ambient) > 5.0:
            report.warn(
                "thermocouple",
                f"{title} starts at {values[0]:.3g} degC, the ambient is {record.ambient:g} degC",
            )
