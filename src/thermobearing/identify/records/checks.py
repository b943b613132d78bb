"""Checks of a test record before it is used."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.text_file import file_names
from thermobearing.core.records import Floats
from thermobearing.cyclic.conditioning import (
    chamber_numbers,
    conditioning_faults,
    hours_to_settle,
    soaked_start,
)
from thermobearing.identify.records.cycles import (
    NONE,
    SAME,
    Cycle,
    compute_measures,
    level_amplitudes,
    loop_middles,
    measure_zeros,
    property_cycles,
    split_runs,
)
from thermobearing.identify.records.limits import check_limits, suspected_slip
from thermobearing.identify.records.record import PAUSE, TestRecord, load_test
from thermobearing.identify.records.temperatures import check_starts, check_thermocouples
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
from thermobearing.identify.records.turns import (
    describe_coarse_samples,
    describe_cut_turns,
    describe_levels,
)
from thermobearing.quantities.words import counted, percent
from thermobearing.results.directory import FIGURES, write_directory
from thermobearing.results.figure_style import Wanted, figure_style
from thermobearing.results.metrics import loop_energy
from thermobearing.results.writing import write_summary
from thermobearing.tables.conditioning import Conditioning

NOT_NEEDED = ("cycles", "sampling")  # checks of a calibration that any history may fail
COARSE = "turns"  # the check of the distance of samples after a turn
MARKS = {"refused": "REFUSED", "warning": "warning", "note": "note"}
MILLI = 1e3  # seconds labelled ms, or milliseconds labelled s


@dataclass(frozen=True)
class Offset:
    """The zero of a signal of a record."""

    name: str  # "force" or "displacement"
    size: float  # [kN or mm]
    peak: float  # largest value of the signal, of either sign
    smallest_peak: float  # of the cycles of the smallest amplitude
    warned: bool  # whether it is so large, or so certain, that the reader has to decide

    def suspicion(self, test: str) -> dict[str, Any]:
        """Return the content of summary.json about the offset in a test, as a suspect."""
        return {
            "name": f"zero of the {self.name} of {test}",
            "key": f"{self.name}_offset",
            "ambient_degC": None,
            "size": self.size,
            "unit": UNITS[self.name],
            "explained": None,
        }

    @property
    def text(self) -> str:
        """The size with its unit."""
        return f"{self.size:.2g} {UNITS[self.name]}"


@dataclass
class CheckReport:
    """The findings in a record."""

    record: TestRecord
    cycles: list[Cycle] = field(default_factory=list)  # full ones
    findings: list[Finding] = field(default_factory=list)  # in the order of the checks
    # Samples at which the force was saturated; a calibration ignores them.
    clipped: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    treatment: Treatment | None = None  # None for what is no test at all
    offsets: list[Offset] = field(default_factory=list)  # of the signals of a record with cycles

    @property
    def steady(self) -> TestRecord:
        """The record with rests held and spikes bridged, which most checks use."""
        return self.treatment.steady if self.treatment else self.record

    @property
    def refusals(self) -> list[str]:
        """Reasons why the record cannot be used in a calibration; empty if it can."""
        source = self.record.file or self.record.name
        return [f"{source}: {f.sentence}" for f in self.findings if f.level == "refused"]

    @property
    def outcome(self) -> str:
        """The most severe level: "refused", "warning" or "good"."""
        return _gravest({finding.level for finding in self.findings})


def _gravest(levels: set[Any]) -> str:
    return next((level for level in ("refused", "warning") if level in levels), "good")


@checked
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
    # The treatment needs increasing time and signals that vary; nothing else can be checked here.
    if refused := list(_check_numbers(record)):
        findings += refused
        return report
    report.treatment = treat(record)
    report.cycles = cycles = report.treatment.cycles
    findings += describe_treatment(report.treatment)
    steady = report.steady
    # With swapped columns or a wrong sign, all further findings would be consequences.
    if refused := list(_check_sign(steady, cycles)):
        findings += refused
        return report
    report.clipped = _find_clipped(record)
    full = [cycle for cycle in cycles if not cycle.closing]
    findings += _check_repeats(record)
    findings += _check_loops(steady, full)
    findings += _check_sampling(steady, full)
    findings += _check_cycles(steady, full)
    # An offset is what remains without the drift: who removes both must not remove a part twice.
    report.offsets = _measure_offsets(report.treatment.without_drifts(), cycles)
    findings += _check_zero(steady, report.offsets)
    if report.clipped.any():
        largest = float(np.abs(record.force[report.clipped]).max())
        message = (
            f"the force is clipped at {largest:.4g} kN in {int(report.clipped.sum())} samples. "
            "A calibration ignores them; the true peak forces are larger"
        )
        findings.append(warn("saturation", message))
    else:
        findings += _check_level_force(steady, full)
    if bearing is not None and cycles:
        findings += check_plausibility(steady, bearing)
    if not record.unclear:
        if bearing is not None:
            findings += _check_conditioning(record, bearing)
        findings += check_thermocouples(record)
        findings += check_starts(report.treatment.to_fit(report.clipped)[0])
    return report


def _check_file(record: TestRecord) -> Iterator[Finding]:
    """Yield assumptions, and content of the file that is not used."""
    if record.unclear:
        yield refuse("ambient", record.unclear)
    for text in record.assumptions:
        yield warn("assumed", text)
    if record.air_offset:
        yield note(
            "ambient",
            f"the chamber is at {record.ambient:.4g} degC when the test begins, at which the "
            f"bearing starts, and at {record.ambient + record.air_offset:.4g} degC on average, the "
            "temperature of the air around it",
        )
    if record.ambient_from and not record.unclear:
        message = f"the ambient temperature, {record.ambient:.4g} degC, was read in "
        yield note("ambient", message + record.ambient_from)
    if record.unused:
        yield note("columns", f"columns not used: {', '.join(record.unused)}")
    if record.rubber_thickness is not None:
        message = f"displacement over strain is {record.rubber_thickness:.4g} mm, "
        yield note("rubber", f"{message}the total rubber thickness")


def _check_numbers(record: TestRecord) -> Iterator[Finding]:
    """Yield a refusal if time does not increase or a signal is constant."""
    backward = np.flatnonzero(~(np.diff(record.time) > 0.0))
    if len(backward):
        k = int(backward[0])
        message = (
            f"time does not increase from {record.time[k]:g} to {record.time[k + 1]:g} s (rows "
        )
        yield refuse(
            "time", f"{message}{k + 1} and {k + 2}): were files joined, or columns swapped?"
        )
        return
    for name, unit in UNITS.items():
        values = getattr(record, name)
        if np.ptp(values) <= 1e-9 * max(1.0, float(np.abs(values).max())):
            yield refuse(name, f"{name} is constant at {values[0]:g} {unit}")
            return


def _check_sign(record: TestRecord, cycles: list[Cycle]) -> Iterator[Finding]:
    """Yield a refusal unless the loops dissipate, with the force along the displacement."""
    d, f = record.displacement, record.force
    if not (np.ptp(d) and np.ptp(f)):
        message = "the displacement has only spikes and rests: are rows out of order?"
        yield refuse("rows", message)
        return
    loops = [slice(c.first, c.last + 1) for c in cycles] or [slice(None)]
    energy = sum(loop_energy(d[rows], f[rows]) for rows in loops)
    along = float(np.corrcoef(d, f)[0, 1])
    # Swapping the axes of a loop reverses its sense and so the sign of its energy; a force of the
    # opposite sign makes the correlation negative.
    if energy < 0.0 and along > 0.0:
        message = (
            f"the loops generate energy ({energy:.4g} kN mm) although the force has the sign of "
            "the displacement: the columns of displacement and force seem to be swapped"
        )
        yield refuse("columns", message)
    elif not along > 0.0:
        message = (
            "the force has the opposite sign of the displacement: set flip_force = true in the "
            "sidecar"
        )
        yield refuse("sign", message)


def _check_repeats(record: TestRecord) -> Iterator[Finding]:
    """Yield rows that are in the file twice, and blocks that begin far from the end of the last."""
    limits = check_limits()
    x, peak = record.displacement, record.peak_displacement
    # A copied row is as far from its original as the row before it is. Noise repeats itself never.
    _, first, inverse = np.unique(x + 1j * record.force, return_index=True, return_inverse=True)
    distance = np.arange(len(x)) - first[inverse]
    for a, b in split_runs((np.diff(distance) == 0) & (distance[1:] > 0)):
        if b - a + 2 >= limits.repeated and np.ptp(x[a : b + 2]) > limits.clipped_way * peak:
            begin = int(first[inverse[a]])
            yield warn(
                "rows",
                f"displacement and force of the {b - a + 2} samples from number {a + 1} on are "
                f"those from number {begin + 1} on: are rows in the file twice? Remove one copy",
            )
            break
    ends = np.flatnonzero(np.diff(record.block))
    away = ends[np.abs(x[ends + 1] - x[ends]) > limits.jump * peak]
    if len(away):
        k = int(away[0])
        yield warn(
            "blocks",
            f"the displacement is {x[k]:.3g} mm at the end of block {record.block[k] + 1} and "
            f"{x[k + 1]:.3g} mm at the beginning of the next one: are rows missing, repeated or "
            "out of order? Put each test into a file of its own",
        )


def _check_loops(record: TestRecord, full: list[Cycle]) -> Iterator[Finding]:
    """Yield a refusal if a cycle generates energy, or the displacement jumps: rows out of order."""
    limits = check_limits()
    steps = np.abs(np.diff(record.displacement))
    moving = steps[steps > 1e-4 * record.peak_displacement]
    fast = float(np.quantile(moving, 0.9)) if len(moving) else 0.0
    usual_gap = np.diff(record.time) <= limits.gap_factor * float(np.median(np.diff(record.time)))
    smallest_jump = max(limits.jump * record.peak_displacement, limits.many_steps * fast)
    # A long step over a gap in time, or from one block to the next, is no jump.
    jumps = np.flatnonzero((steps > smallest_jump) & usual_gap & (np.diff(record.block) == 0))
    if len(jumps):
        k = int(jumps[0])
        yield refuse(
            "rows",
            f"the displacement jumps by {steps[k]:.3g} mm from one sample to the next at "
            f"{record.time[k]:.4g} s (rows {k + 1} and {k + 2}), {len(jumps)} times in all: are "
            "rows missing or out of order?",
        )
    largest = -np.inf
    for place, cycle in enumerate(full, start=1):
        rows = slice(cycle.first, cycle.last + 1)
        x, force = record.displacement[rows], record.force[rows]
        # Equivalent damping (Eq. 3.2) of the range of the force, which noise hardly changes.
        damping = 2.0 * loop_energy(x, force) / (np.pi * float(np.ptp(force) * np.ptp(x)))
        if damping < -limits.generated:
            yield refuse(
                "energy",
                f"full cycle {place} generates energy (h_eq = {damping:.3f}), which no bearing "
                "does: are rows out of order, or does the force lag behind the displacement?",
            )
            return
        largest = max(largest, damping)
    if full and largest < limits.undamped:
        yield warn(
            "energy",
            f"the loops dissipate almost no energy (h_eq = {largest:.4f}), less than any rubber: "
            "was the column of the force computed from the displacement?",
        )


def _mean_speed(record: TestRecord) -> float:
    """Return the mean speed while the bearing moves [mm/s]."""
    gaps, steps = np.diff(record.time), np.abs(np.diff(record.displacement))
    moving = steps > 1e-4 * record.peak_displacement
    return float(np.sum(steps[moving]) / max(float(np.sum(gaps[moving])), 1e-12))


def _check_sampling(record: TestRecord, full: list[Cycle]) -> Iterator[Finding]:
    """Yield gaps while the bearing moves, implausible speeds, cycles of few samples."""
    limits = check_limits()
    gaps, steps = np.diff(record.time), np.abs(np.diff(record.displacement))
    moving = steps > 1e-4 * record.peak_displacement
    usual_gap = float(np.median(gaps[moving])) if moving.any() else float(np.median(gaps))
    same_block = np.diff(record.block) == 0
    has_gap = (
        (gaps > limits.gap_factor * usual_gap)
        & (steps > limits.gap_way * record.peak_displacement)
        & same_block
    )
    for k in np.flatnonzero(has_gap)[:3]:
        message = f"samples are missing from {record.time[k]:.4g} to {record.time[k + 1]:.4g} s, "
        yield warn("sampling", f"{message}while the bearing moved {steps[k]:.2g} mm")
    speed = _mean_speed(record)
    # A slow test may be one in ms labelled s; only rare samples make that likely.
    sparse = usual_gap >= limits.sparse and speed < limits.slow
    if sparse or not limits.slowest <= speed <= limits.fastest:
        message = f"the mean speed is {speed:.3g} mm/s"
        if speed < limits.slow and limits.slowest <= MILLI * speed <= limits.fastest:
            message += f": is time in ms labelled s ({MILLI * speed:.3g} mm/s)?"
        elif limits.slowest <= speed / MILLI <= limits.fastest:
            message += f": is time in s labelled ms ({speed / MILLI:.3g} mm/s)?"
        else:
            message += ": check the units of time and displacement"
        yield warn("speed", message)
    rests = int(((gaps > PAUSE) & ~moving).sum())
    pauses = f", {counted(rests, 'pause')} longer than {PAUSE:g} s" if rests else ""
    yield note(
        "sampling",
        f"{len(record.time)} samples, usually {1e3 * usual_gap:.3g} ms apart, mean speed "
        f"{speed:.2g} mm/s{pauses}",
    )
    if cut := describe_cut_turns(record):
        yield note(COARSE, cut)
    fewest = min((c.last - c.first for c in full), default=limits.few_samples)
    if fewest < limits.few_samples:
        message = (
            f"a cycle has only {fewest} samples; {limits.few_samples} or more give accurate loops"
        )
        yield (refuse if fewest < limits.fewest_samples else warn)("sampling", message)


def _check_cycles(record: TestRecord, full: list[Cycle]) -> Iterator[Finding]:
    """Yield the number of full cycles, and a record that does not begin and end at zero."""
    limits = check_limits()
    if not full:
        message = (
            "no full cycle (zero, one side, other side, zero) was found: a calibration needs "
            "reversals"
        )
        yield refuse("cycles", message)
        return
    # b is a change of strength with amplitude, scragging one from cycle to cycle.
    if len(full) == 1:
        message = (
            "only one cycle: scragging, heating and the effect of the amplitude (b) cannot be "
        )
        yield warn("cycles", message + "distinguished")
    levels = sum(c.number == 1 for c in full)
    amplitudes = counted(levels, "amplitude")
    yield note("cycles", f"{counted(len(full), 'full cycle')} at {amplitudes} in a row")
    first, last = record.displacement[0], record.displacement[-1]
    limit = limits.ends_away * record.peak_displacement
    if abs(last) > limit:
        message = f"the record ends at {last:.3g} mm, in the middle of a cycle: is it truncated?"
        yield warn("end", message)
    if abs(first) > limit:
        message = f"the record begins at {first:.3g} mm, not at zero: the model moves there first"
        yield warn("begin", message)


def _measure_offsets(record: TestRecord, cycles: list[Cycle]) -> list[Offset]:
    """Return the zeros of force and displacement, of a record that has full cycles."""
    limits = check_limits()
    offsets = []
    for name, peak in ("force", record.peak_force), ("displacement", record.peak_displacement):
        zeros = measure_zeros(record, name, cycles).values
        if len(zeros) == 0:
            continue
        values = getattr(record, name)
        offset, middle = (float(np.median(v)) for v in (zeros, loop_middles(values, cycles)))
        # One loop of several that is far off moves the median of the middles less.
        offset = offset if abs(offset - middle) < limits.leaning * peak else middle
        offset = offset if abs(offset) > NONE * peak else 0.0
        error = float(zeros.std()) / np.sqrt(len(zeros))
        # A small offset counts only if many legs agree on it by several standard errors.
        certain = len(zeros) >= limits.fewest_zeros and abs(offset) > max(
            SURE * error, limits.slight_offset * peak
        )
        smallest_peak, middle = _smallest_loops(values, cycles)
        # A small offset of the peak may be a large part of the smallest cycles: then both must
        # agree.
        in_small = min(abs(offset), middle * float(np.sign(offset))) > limits.offset * smallest_peak
        warned = bool(abs(offset) > limits.offset * peak or certain or in_small)
        offsets.append(Offset(name, offset, peak, smallest_peak, warned))
    return offsets


def _check_zero(record: TestRecord, offsets: Sequence[Offset]) -> Iterator[Finding]:
    """Yield the zero of force and displacement."""
    near_zero = []
    for offset in offsets:
        name, size = offset.name, abs(offset.size)
        if not offset.warned:
            share = percent(size / offset.smallest_peak, 1)
            near_zero.append(f"{offset.text} in the {name} ({share})")
            continue
        reading = reading_at_zero(record, name, offset.size)
        message = (
            f"the zero of the {name} is off by {offset.text} ({percent(size / offset.peak, 1)} of "
            f"the peak, {percent(size / offset.smallest_peak, 1)} of that of the smallest "
            "cycles); "
            f'{name}_offset = "{reading} {UNITS[name]}" in the sidecar removes it'
        )
        yield warn("offset", message)
    if near_zero:
        message = (
            f"the zero is off by {' and '.join(near_zero)}, of the peak of the smallest cycles"
        )
        yield note("zero", message)


def reading_at_zero(record: TestRecord, name: str, offset: float) -> str:
    """Return what the instrument reads at zero: the offset that belongs in the sidecar.

    The sidecar subtracts it from the readings before it reverses their sign, and may have
    subtracted a part of it already.
    """
    reversed_sign = record.reversed_force and name == "force"
    subtracted = record.subtracted.get(name, 0.0)
    reading = subtracted + (-offset if reversed_sign else offset)
    return f"{reading:.3g}" if subtracted else f"{reading:.2g}"


def _smallest_loops(values: Floats, cycles: list[Cycle]) -> tuple[float, float]:
    """Return half the range of a signal in the cycles of the smallest amplitude, and its middle.

    The first cycle of the amplitude, which leans to its first side, counts only if it is alone.
    """
    full = [cycle for cycle in cycles if not cycle.closing]
    smallest = min(cycle.amplitude for cycle in full)
    level = [cycle for cycle in full if cycle.amplitude < (1.0 + SAME) * smallest]
    level = [cycle for cycle in level if cycle.number > 1] or level
    loops = [values[cycle.first : cycle.last + 1] for cycle in level]
    half_ranges = [0.5 * float(np.ptp(loop)) for loop in loops]
    return float(np.median(half_ranges)), float(np.median(loop_middles(values, level)))


def _find_clipped(record: TestRecord) -> NDArray[np.bool_]:
    """Return the samples whose force stays at exactly its extreme while the bearing moves on."""
    limits = check_limits()
    clipped = np.zeros(len(record.time), dtype=bool)
    for extreme in (record.force.max(), record.force.min()):
        for a, b in split_runs(np.abs(record.force - extreme) <= 1e-9 * record.peak_force):
            travel = float(np.ptp(record.displacement[a : b + 1]))
            # A plateau at rest is no saturation: the bearing must move on below it.
            if (
                b - a + 1 >= limits.clipped_run
                and travel > limits.clipped_way * record.peak_displacement
            ):
                clipped[a : b + 1] = True
    return clipped


def _check_level_force(record: TestRecord, full: list[Cycle]) -> Iterator[Finding]:
    """Yield a side on which the force stops rising: a saturated load cell, with noise.

    Bearings stiffen or stay as stiff towards their largest displacement.
    """
    limits = check_limits()
    largest = max((cycle.amplitude for cycle in full), default=0.0)
    level = [cycle for cycle in full if cycle.amplitude > (1.0 - SAME) * largest]
    for side in (1.0, -1.0):
        rises = [_rises(record, cycle, side) for cycle in level]
        if level and all(
            before > limits.level_rise * record.peak_force and after < limits.level_rise * before
            for before, after in rises
        ):
            top = float((side * record.force).max())
            yield warn(
                "saturation",
                f"the force does not rise over the last {percent(limits.level_part)} of the "
                f"displacement to the {'positive' if side > 0.0 else 'negative'} side, at about "
                f"{side * top:.4g} kN: was the load cell saturated? The true peak forces are "
                "larger; leave out these cycles, or repeat the test with another range",
            )


def _rises(record: TestRecord, cycle: Cycle, side: float) -> tuple[float, float]:
    """Return by how much the force rises in the last part of a way out, and in the part before."""
    limits = check_limits()
    x = side * record.displacement[cycle.first : cycle.last + 1]
    force = side * record.force[cycle.first : cycle.last + 1]
    end = int(x.argmax())
    crossings = np.flatnonzero(x[:end] <= 0.0)
    begin = int(crossings[-1]) if len(crossings) else 0
    place, force = x[begin : end + 1] / x[end], force[begin : end + 1]
    slopes = []
    for low in (1.0 - 2.0 * limits.level_part, 1.0 - limits.level_part):
        part = (place >= low) & (place <= low + limits.level_part)
        if part.sum() < limits.fewest_of_part or not np.ptp(place[part]):
            return 0.0, 0.0
        slopes.append(float(np.polyfit(place[part], force[part], 1)[0]))
    return limits.level_part * slopes[0], limits.level_part * slopes[1]


def check_plausibility(record: TestRecord, bearing: Bearing) -> Iterator[Finding]:
    """Yield findings on the units of a test, from its largest strain and the shear modulus there.

    The record has its rests held and spikes bridged, and one full cycle at least. Numbers that no
    bearing has are refused.
    """
    limits = check_limits()
    rubber = bearing.total_rubber_thickness
    strain = record.peak_displacement / rubber
    reached = f"displacement reaches {record.peak_displacement:.4g} mm"
    if strain > limits.largest_strain:
        message = (
            f"{percent(strain)} of the total rubber thickness, {rubber:g} mm: wrong unit, or the "
        )
        yield refuse("strain", f"{reached}, {message}wrong bearing?")
    elif strain < limits.smallest_strain:
        message = f"{reached}, only {percent(strain, 1)} of the total rubber thickness: wrong unit?"
        yield warn("strain", message)
    speed = _mean_speed(record)
    if speed <= limits.fastest and speed / rubber > limits.fastest_rate:
        message = f"the mean speed is {speed:.4g} mm/s, a strain rate of {speed / rubber:.3g} 1/s: "
        yield warn("speed", f"{message}is time in minutes or ms labelled s?")
    d_y = float(bearing.hysteresis.yield_displacement)
    if coarse := describe_coarse_samples(record, d_y):
        yield warn(COARSE, coarse)
    file_thickness = record.rubber_thickness
    if file_thickness is not None and abs(file_thickness - rubber) > limits.other_rubber * rubber:
        message = (
            f"displacement and strain give a total rubber thickness of {file_thickness:.4g} mm, "
            f"but the bearing has {rubber:g} mm: the wrong bearing, or a wrong unit?"
        )
        yield warn("rubber", message)
    try:
        measured = compute_measures(record, record.force, bearing.area, rubber)
    except InputError:  # a cycle with too few samples, which the check of sampling has refused
        return
    modulus = float(
        np.mean([measured[k].G_eq_MPa for k in property_cycles([level_amplitudes(record)])[0]])
    )
    stated = (
        "the equivalent shear modulus at the largest amplitude, the mean of its cycles without the "
        f"first if there are more, is {modulus:.3g} MPa"
    )
    if not limits.softest <= modulus <= limits.stiffest:
        comparison = "less than any rubber" if modulus < limits.softest else "more than any bearing"
        yield refuse("unit", f"{stated}, {comparison} has{suspected_slip(modulus, strain)}")
    else:
        yield note("unit", stated)
    if levels := describe_levels(record, rubber):
        yield note("strain", levels)


def _check_conditioning(record: TestRecord, bearing: Bearing) -> Iterator[Finding]:
    """Yield a warning if the bearing cannot have reached the temperature of its chamber."""
    numbers, ambient = chamber_numbers(), record.ambient
    stated = record.conditioning
    conditioning = stated or Conditioning(conditioned=numbers.usual)
    if faults := conditioning_faults(conditioning, bearing, ambient):
        for fault in faults:
            yield refuse("conditioning", fault)
        return
    hours = hours_to_settle(bearing, conditioning, ambient)
    if stated is None:
        if hours > numbers.usual:
            message = f"a bearing of this size takes {hours:.0f} h in a chamber to reach "
            yield note(
                "conditioning", f"{message}{ambient:.4g} degC; state conditioned if it had less"
            )
        return
    start = soaked_start(bearing, stated, ambient)
    if abs(start.rubber - ambient) > numbers.settled:
        message = (
            f"after {stated.conditioned:g} h the rubber is at {start.rubber:.1f} degC on average "
            f"and not yet at {ambient:.4g} degC, which takes {hours:.0f} h; a calibration starts "
            "from the computed temperatures"
        )
        if stated.inside is not None:
            message += f" after {start.hours:.1f} h, which agree with the reading inside"
        yield warn("conditioning", message)


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
