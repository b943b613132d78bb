"""Ground motions: read or generate -> correct -> measure -> compare with a target spectrum.

a record, or a name ............... load_motion -> `examine_motion` -> MotionResult
a target spectrum and phases ...... MotionCase  -> `run_motion`     -> MotionResult
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.types import Floats
from thermobearing.motions.library import header_lines, load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, Progress, misfit
from thermobearing.motions.measures import MotionMeasures, measure_motion
from thermobearing.motions.pair import MotionPair, rotation_measures
from thermobearing.motions.process import baseline_corrected, resampled
from thermobearing.motions.record import MM_S2_PER_GAL, GroundMotion
from thermobearing.motions.spectrum import (
    DAMPING,
    ResponseSpectrum,
    check_damping,
    response_spectrum,
    rotated_spectrum,
)
from thermobearing.motions.synthesis import make_motion, match_spectrum
from thermobearing.motions.targets import (
    STANDARD,
    DesignSpectrum,
    find_kind,
    kind_and_ground,
    load_spectrum,
    standard_target,
)
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.warned import UNUSABLE, Warned
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import MOTION, SPECTRUM

MM_PER_CM, MM_PER_M = 10.0, 1000.0
DEFAULT_SEED, DEFAULT_DT = 1, 0.01  # [s]
FIRST, LAST, COUNT = 0.05, 5.0, 200  # periods of spectrum.csv [s]
SHOWN = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0)  # periods on the console [s]
POOR_FIT = "poor_fit"
USUAL = ("II", "I")  # type and ground
# Our choice: a ground that still moves at the end at this share of its largest velocity has
# drifted, as by a constant error of the accelerometer; a permanent offset ends at rest.
DRIFTING = 0.1
FARTHEST = 3000.0  # of the ground [mm]; few records next to a fault have moved as far
MEASURES = (
    "dt_s",
    "samples",
    "duration_s",
    "pga_gal",
    "pgv_cm_s",
    "pgd_cm",
    "arias_intensity_m_s",
    "significant_duration_s",
    "bracketed_duration_s",
    "cumulative_absolute_velocity_m_s",
    "end_velocity_cm_s",
    "end_displacement_cm",
)
TARGETS = ("standard_gal", "target_gal")  # the spectrum that a motion is compared with
SPECTRA = ("period_s", "acceleration_gal", "velocity_cm_s", "displacement_cm", *TARGETS)
# What the envelope of a generated motion is by its type, and how to choose the other.
ENVELOPES = {
    "I": "Type I, long, without a velocity pulse; --kind II makes a short motion with one",
    "II": "Type II, short, with a velocity pulse; --kind I makes a long motion without one",
}
STANDARD_WORDS = "the standard spectrum of "
PAIR_SPECTRA = (
    "period_s",
    "acceleration_gal",
    "across_acceleration_gal",
    "rotd50_gal",
    "rotd100_gal",
    "rotd50_cm",
    "rotd100_cm",
    *TARGETS,
)


@dataclass(frozen=True, repr=False)
class MotionResult(Result):
    """The result of one ground motion, or of the first record of a pair: measures and spectra.

    `across` is the result of the second record. `damping` is that of `spectrum`, a ratio of
    critical damping; `misfit` the root mean square of spectrum / reference - 1 over 0.1 to 3 s, 5 %
    damping, None of a pair. The outcome is "completed", or "poor_fit" for a generated motion that
    does not fit. `envelope` says what kind of motion was generated for a spectrum of one's own.
    """

    _figures = "MotionFigures"

    command: str
    motion: GroundMotion
    measures: MotionMeasures
    damping: float
    reference: DesignSpectrum | None
    misfit: float | None
    outcome: str = COMPLETED
    across: "MotionResult | None" = field(default=None, kw_only=True)
    envelope: str = field(default="", kw_only=True)

    @property
    def headline(self) -> str:
        """Name of the motion or of the pair."""
        return self.motion.name if self.pair is None else self.pair.name

    @property
    def pair(self) -> MotionPair | None:
        """Both records of a pair."""
        return None if self.across is None else MotionPair(self.motion, self.across.motion)

    @property
    def records(self) -> list[str]:
        """Words that distinguish the records of a pair: components, names, or their order."""
        if self.across is None:
            return []
        motions = [self.motion, self.across.motion]
        candidates = [
            [motion.component for motion in motions],
            [motion.name for motion in motions],
            ["first", "second"],
        ]
        return next(names for names in candidates if all(names) and names[0] != names[1])

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try."""
        if self.outcome != POOR_FIT or self.misfit is None:
            return ""
        return (
            f"the search ended with a misfit of {100 * self.misfit:.2g} % rms, above "
            f"{100 * LARGEST_MISFIT:g} %; try another record or seed"
        )

    @property
    def warnings(self) -> list[str]:
        """A sentence on a ground that drifts, with the cure."""
        results = [self] if self.across is None else [self, self.across]
        names = self.records or [""]
        return [
            text.about(name) if name else text
            for name, result in zip(names, results, strict=True)
            for text in _drift_warnings(result.measures)
        ]

    @cached_property
    def spectrum(self) -> ResponseSpectrum:
        """Response spectrum at 200 periods from 0.05 to 5 s."""
        return response_spectrum(self.motion, np.geomspace(FIRST, LAST, COUNT), self.damping)

    @property
    def table(self) -> "pd.DataFrame":
        """The spectrum as in spectrum.csv."""
        return self._spectrum_frame(self.spectrum)

    def _spectrum_frame(self, spectrum: ResponseSpectrum) -> "pd.DataFrame":
        """Return the spectrum, that of the second record, RotD50 and RotD100 at its periods."""
        columns = {
            "period_s": spectrum.periods,
            "acceleration_gal": spectrum.acceleration / MM_S2_PER_GAL,
            "pseudo_acceleration_gal": spectrum.pseudo_acceleration / MM_S2_PER_GAL,
            "velocity_cm_s": spectrum.velocity / MM_PER_CM,
            "displacement_cm": spectrum.displacement / MM_PER_CM,
        }
        if self.pair is not None:
            columns |= _rotated_columns(self.pair, spectrum)
        if self.reference is not None:
            column = "standard_gal" if self.reference.standard else "target_gal"
            columns[column] = self.reference.at(spectrum.periods) / MM_S2_PER_GAL
        return pd.DataFrame(columns)

    def tables(self) -> dict[str, Table]:
        """Return tables of the measures, or (`motions spectrum`) of the spectrum at ten periods."""
        if self.command != "motions spectrum":
            return {"measures": measures_table(self.summary())}
        frame = self._spectrum_frame(response_spectrum(self.motion, SHOWN, self.damping))
        return {"spectrum": spectrum_table(frame, self.damping)}

    def notes(self) -> list[str]:
        """Return the fit to its standard spectrum, and a description."""
        sentences = [self.motion.description] if self.motion.description else []
        if self.reference is not None and self.misfit is not None:
            sentences.append(
                f"misfit {100 * self.misfit:.1f} % rms over 0.1 to 3 s compared with "
                f"{self.reference.words.removeprefix(STANDARD_WORDS)}"
            )
        return sentences + [self.envelope] * bool(self.envelope)

    def summary(self) -> dict[str, Any]:
        """Content of summary.json."""
        motion, measures, reference = self.motion, self.measures, self.reference
        spectrum_row = None
        if reference is not None:
            spectrum_row = _reference_row(reference) | {"misfit_rms": self.misfit}
        content = {
            "command": self.command,
            "motion": self.headline,
            "description": motion.description,
            "citation": motion.citation,
            "version": thermobearing.__version__,
            "outcome": self.outcome,
            "dt_s": motion.dt,
            "samples": len(motion.acceleration),
            "duration_s": motion.duration,
            "pga_gal": measures.pga / MM_S2_PER_GAL,
            "pgv_cm_s": measures.pgv / MM_PER_CM,
            "pgd_cm": measures.pgd / MM_PER_CM,
            "end_velocity_cm_s": measures.end_velocity / MM_PER_CM,
            "end_displacement_cm": measures.end_displacement / MM_PER_CM,
            "arias_intensity_m_s": measures.arias_intensity / MM_PER_M,
            "significant_duration_s": measures.significant_duration,
            "bracketed_duration_s": measures.bracketed_duration,
            "cumulative_absolute_velocity_m_s": measures.cumulative_absolute_velocity / MM_PER_M,
            "damping": self.damping,
            "standard_spectrum": spectrum_row,
        }
        if self.across is not None:
            content |= {"records": self.records, "across": self.across.summary()}
        return content | ({"warnings": self.warnings} if self.warnings else {})

    def _write(self, folder: Path) -> None:
        acceleration = self.motion.acceleration / MM_S2_PER_GAL
        motion = pd.DataFrame({"t_s": self.motion.time, "acc_gal": acceleration})
        if self.across is not None:
            motion["across_gal"] = self.across.motion.acceleration / MM_S2_PER_GAL
        for file, frame, form in ((MOTION, motion, "%.6f"), (SPECTRUM, self.table, "%.6g")):
            text_format: dict[str, Any] = {"fmt": form, "delimiter": ",", "comments": ""}
            lines = header_lines(self.motion) if file == MOTION else []
            header = "\n".join([*lines, ",".join(frame.columns)])
            np.savetxt(folder / file, frame, header=header, encoding="utf-8", **text_format)


def _rotated_columns(pair: MotionPair, spectrum: ResponseSpectrum) -> dict[str, Floats]:
    """Return the spectrum of the second record, RotD50 and RotD100 at the periods of the first."""
    rotated = rotated_spectrum(pair, spectrum.periods, spectrum.damping)
    # At 90° the pair along the axis is the second record itself.
    second = int(np.flatnonzero(rotated.angles == 90.0)[0])
    sizes = {
        "gal": rotated.acceleration / MM_S2_PER_GAL,
        "pseudo_gal": rotated.pseudo_acceleration / MM_S2_PER_GAL,
        "cm": rotated.displacement / MM_PER_CM,
    }
    return {"across_acceleration_gal": rotated.acceleration[second] / MM_S2_PER_GAL} | {
        f"{measure}_{unit}": values
        for unit, responses in sizes.items()
        for measure, values in rotation_measures(responses)._asdict().items()
    }


def _drift_warnings(measures: MotionMeasures) -> list[Warned]:
    """Return a sentence if the displacement of the ground is that of a wrong baseline."""
    moving = abs(measures.end_velocity) > DRIFTING * measures.pgv
    if not moving and measures.pgd <= FARTHEST:
        return []
    size = f"the ground displacement reaches {measures.pgd / MM_PER_CM:.3g} cm"
    if moving:
        share = abs(measures.end_velocity) / measures.pgv
        size += f", and the ground still moves at {100 * share:.0f} % of its PGV at the end"
    sentence = f"{size}. The record drifts; correct its baseline (--baseline)"
    return [Warned(sentence, "drifting_record", UNUSABLE)]


def _reference_row(reference: DesignSpectrum) -> dict[str, Any]:
    """Return a spectrum as in summary.json."""
    if not reference.standard:
        return {"name": reference.name, "words": reference.words, "factor": reference.factor}
    kind, ground = find_kind(reference.name)
    return {"type": kind, "ground": ground, "zone_factor": reference.factor}


def reference_words(row: Mapping[str, Any]) -> str:
    """Return in words the spectrum that a summary names."""
    if "words" in row:
        return str(row["words"])
    zone = float(row["zone_factor"])
    return f"{STANDARD_WORDS}Level 2 Type {row['type']}, ground {row['ground']}, c_z = {zone:g}"


def measures_table(summary: Mapping[str, Any]) -> Table:
    """Return the measures of a summary, a row each; rounding errors of the ends are zeros."""
    measures = [quantity(name) for name in MEASURES if summary.get(name) is not None]
    records, heads = [summary], ["Value"]
    if across := summary.get("across"):
        records, heads = [summary, across], list(summary["records"])
    rows = [
        (
            measure.head,
            *(measure.text(round(record[measure.name], 6)) for record in records),
            measure.unit,
        )
        for measure in measures
    ]
    columns = [Quantity("Measure"), *map(Quantity, heads), Quantity("Unit")]
    return Table("Measures of the motion", columns, rows)


def spectrum_table(frame: "pd.DataFrame", damping: float) -> Table:
    """Return a response spectrum as a table."""
    names = PAIR_SPECTRA if "rotd50_gal" in frame else SPECTRA
    return make_table(frame, names, f"Response spectrum, damping {100.0 * damping:g} %")


def examine_motion(
    motion: GroundMotion | MotionPair,
    kind: str | None = None,
    ground: str | None = None,
    *,
    compare: str | Path | DesignSpectrum | None = None,
    damping: float = DAMPING,
    baseline: bool = False,
    high_pass: float | None = None,
    command: str = "motions show",
) -> MotionResult:
    """Return size, duration, ends and spectrum of a ground motion, with a spectrum to compare.

    Of a pair, they are those of both records, with RotD50 and RotD100 of their responses.

    Without `compare`, `kind` and `ground` a built-in or generated motion is compared with the
    spectrum it was made for, and others with none. For `baseline` and `high_pass` see
    `baseline_corrected`.

    Parameters
    ----------
    kind : type of the standard spectrum: I or II.
    ground : ground of the standard spectrum: I, II or III.
    compare : spectrum to compare with, in place of a standard one: a table of periods and
        accelerations, or the shape of a code as a TOML file.
    damping : damping ratio; 0.05 by default.
    baseline : correct the baseline first.
    high_pass : corner frequency of an additional high-pass filter [Hz].
    """
    if compare is not None and (kind or ground):
        raise InputError("give compare, or type and ground of the standard spectrum, not both")
    if compare is not None and not isinstance(compare, DesignSpectrum):
        compare = load_spectrum(compare)
    if isinstance(motion, MotionPair):
        options: dict[str, Any] = {"damping": damping, "baseline": baseline, "high_pass": high_pass}
        options["compare"] = compare
        first, second = (
            examine_motion(record, kind, ground, command=command, **options)
            for record in (motion.first, motion.second)
        )
        return replace(first, misfit=None, across=second)
    if baseline or high_pass is not None:
        motion = baseline_corrected(motion, high_pass=high_pass)
    return _measured(command, motion, compare or _reference(motion, kind, ground), damping)


@dataclass(frozen=True)
class MotionCase:
    """Input of a generated motion: the spectrum to fit, and the phases.

    Phases are random, from a seed, with the envelope of a type and a ground, or those of a record.
    The time step `dt` [s] is that of the record, or 0.01 s, where it is None.
    """

    kind: str
    ground: str
    spectrum: DesignSpectrum
    seed: int = DEFAULT_SEED
    record: GroundMotion | None = None
    dt: float | None = None

    @property
    def name(self) -> str:
        """Name of the result directory."""
        target = self.spectrum.name
        if self.record is None:
            name = f"{target}-{self.seed}"
        else:
            name = f"{self.record.name}-as-{target.removeprefix('jra-')}".lower()
        return re.sub(r"[^\w.+-]+", "-", name)


def make_motion_case(
    kind: str | int | None = None,
    ground: str | int | None = None,
    *,
    seed: int | None = None,
    record: str | Path | GroundMotion | None = None,
    dt: float | None = None,
    zone_factor: float = 1.0,
    spectrum: str | Path | DesignSpectrum | None = None,
    unit: str | None = None,
    component: str | None = None,
    trust_unit: bool = False,
) -> MotionCase:
    """Return the validated input of a generated motion; see `MotionCase`.

    Type and ground, by default those of the standard spectrum, determine the envelope of random
    phases. `spectrum` may be one from `load_spectrum`, and `record` a motion.

    Parameters
    ----------
    kind : type of the standard spectrum: I (long) or II (pulse-like, default).
    ground : ground of the standard spectrum: I (hard, default), II or III (soft).
    seed : seed of the random phases; 1 by default.
    record : record or motion whose phases are kept.
    dt : time step [s]; 0.01 by default.
    zone_factor : factor of the spectrum, of a standard one c_z; 1 by default.
    spectrum : spectrum to fit in place of the standard one: a table of periods and accelerations,
        or the shape of a code as a TOML file; type and ground then give the duration.
    unit : unit of the acceleration of the record, if its file has none.
    component : component, by name (NS) or number from 1, if the file has several.
    trust_unit : accept a peak acceleration that is implausible for the unit.
    """
    if spectrum is not None and not isinstance(spectrum, DesignSpectrum):
        spectrum = load_spectrum(spectrum, zone_factor)
    default_class = find_kind(spectrum.name) if spectrum and spectrum.standard else USUAL
    kind, ground = kind_and_ground(
        default_class[0] if kind is None else kind, default_class[1] if ground is None else ground
    )
    spectrum = spectrum or standard_target(kind, ground, zone_factor)
    if record is not None and not isinstance(record, GroundMotion):
        record = load_motion(record, unit=unit, component=component, trust_unit=trust_unit)
    seed = DEFAULT_SEED if seed is None else seed
    return MotionCase(kind, ground, spectrum, seed, record, dt)


def run_motion(case: MotionCase, *, progress: Progress | None = None) -> MotionResult:
    """Generate the motion of a case and measure its fit.

    `progress` is called after each round of the fit with (rounds done, at most).
    """
    options: dict[str, Any] = {"spectrum": case.spectrum, "progress": progress}
    if case.record is None:
        dt = DEFAULT_DT if case.dt is None else case.dt
        motion = make_motion(case.kind, case.ground, case.seed, dt, **options)
    else:
        record = case.record if case.dt is None else resampled(case.record, case.dt)
        motion = match_spectrum(record, case.kind, case.ground, **options)
    result = _measured("motions make", motion, case.spectrum, DAMPING)
    assert result.misfit is not None
    outcome = POOR_FIT if result.misfit > LARGEST_MISFIT else result.outcome
    # The type of a standard spectrum is in its name.
    of_own = case.record is None and not case.spectrum.standard
    return replace(result, outcome=outcome, envelope=ENVELOPES[case.kind] if of_own else "")


def _reference(motion: GroundMotion, kind: str | None, ground: str | None) -> DesignSpectrum | None:
    """Return the spectrum to compare with: the given one, or that which the motion was made for."""
    if kind or ground:
        return standard_target(*kind_and_ground(kind or USUAL[0], ground or USUAL[1]))
    if motion.target is not None:
        return motion.target
    # The name of a built-in motion is that of its spectrum and a seed.
    match = re.fullmatch(rf"({STANDARD.pattern})-\d+", motion.name)
    return load_spectrum(match[1]) if match else None


def _measured(
    command: str, motion: GroundMotion, reference: DesignSpectrum | None, damping: float
) -> MotionResult:
    check_damping(damping)
    measures = measure_motion(motion)
    error = None if reference is None else misfit(motion, reference.at)
    return MotionResult(command, motion, measures, damping, reference, error)
