"""Ground motions: read or generate -> correct -> measure -> compare with a standard spectrum.

a record, or a name ............... load_motion -> `examine_motion` -> MotionResult
a standard spectrum and phases .... MotionCase  -> `run_motion`     -> MotionResult
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import thermobearing
from thermobearing.border.lazy import pd
from thermobearing.core.types import Floats
from thermobearing.motions.library import load_motion
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
from thermobearing.motions.targets import kind_and_ground, standard_spectrum
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import MOTION, SPECTRUM

MM_PER_CM, MM_PER_M = 10.0, 1000.0
DEFAULT_SEED, DEFAULT_DT = 1, 0.01  # [s]
FIRST, LAST, COUNT = 0.05, 5.0, 200  # periods of spectrum.csv [s]
SHOWN = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0)  # periods on the console [s]
POOR_FIT = "poor_fit"
MEASURES = (
    *("dt_s", "samples", "duration_s", "pga_gal", "pgv_cm_s", "pgd_cm", "arias_intensity_m_s"),
    *("significant_duration_s", "bracketed_duration_s", "cumulative_absolute_velocity_m_s"),
    *("end_velocity_cm_s", "end_displacement_cm"),
)
SPECTRA = ("period_s", "acceleration_gal", "velocity_cm_s", "displacement_cm", "standard_gal")
PAIR_SPECTRA = (
    *("period_s", "acceleration_gal", "across_acceleration_gal", "rotd50_gal", "rotd100_gal"),
    *("rotd50_cm", "rotd100_cm", "standard_gal"),
)


class Reference(NamedTuple):
    """The standard spectrum that a motion is compared with: type, ground, c_z of the region."""

    kind: str
    ground: str
    zone_factor: float = 1.0

    def at(self, periods: Any) -> Floats:
        """Return the acceleration at natural periods [mm/s2]."""
        return standard_spectrum(self.kind, self.ground, periods, zone_factor=self.zone_factor)


@dataclass(frozen=True, repr=False)
class MotionResult(Result):
    """The result of one ground motion, or of the first record of a pair: measures and spectra.

    `across` is the result of the second record. `damping` is that of `spectrum`, a ratio of
    critical damping; `misfit` the root mean square of spectrum / reference - 1 over 0.1 to 3 s, 5 %
    damping, None of a pair. The outcome is "completed", or "poor_fit" for a generated motion that
    does not fit.
    """

    _figures = "MotionFigures"

    command: str
    motion: GroundMotion
    measures: MotionMeasures
    damping: float
    reference: Reference | None
    misfit: float | None
    outcome: str = COMPLETED
    across: "MotionResult | None" = field(default=None, kw_only=True)

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
        both = [self.motion, self.across.motion]
        ways = [[one.component for one in both], [one.name for one in both], ["first", "second"]]
        return next(found for found in ways if all(found) and found[0] != found[1])

    @property
    def sentence(self) -> str:
        """The meaning of the outcome and what to try."""
        if self.outcome != POOR_FIT or self.misfit is None:
            return ""
        return (
            f"the search ended with a misfit of {100 * self.misfit:.2g} % rms, above "
            f"{100 * LARGEST_MISFIT:g} %; try another record or seed"
        )

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
            columns["standard_gal"] = self.reference.at(spectrum.periods) / MM_S2_PER_GAL
        return pd.DataFrame(columns)

    def tables(self) -> dict[str, Table]:
        """Return tables of the measures, or (`motions spectrum`) of the spectrum at ten periods."""
        if self.command != "motions spectrum":
            return {"measures": measures_table(self.summary())}
        frame = self._spectrum_frame(response_spectrum(self.motion, SHOWN, self.damping))
        return {"spectrum": spectrum_table(frame, self.damping)}

    def notes(self) -> list[str]:
        """Return the fit to its standard spectrum, and a description."""
        found = [self.motion.description] if self.motion.description else []
        if self.reference is not None and self.misfit is not None:
            found.append(
                f"misfit {100 * self.misfit:.1f} % rms over 0.1 to 3 s compared with "
                f"{standard_words(self.reference._asdict())}"
            )
        return found

    def summary(self) -> dict[str, Any]:
        """Content of summary.json."""
        motion, measures, reference = self.motion, self.measures, self.reference
        across = None if self.across is None else self.across.summary()
        standard = None
        if reference is not None:
            kind, ground, factor = reference
            standard = {"type": kind, "ground": ground, "zone_factor": factor}
            standard["misfit_rms"] = self.misfit
        return {
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
            "standard_spectrum": standard,
        } | ({} if self.across is None else {"records": self.records, "across": across})

    def _write(self, folder: Path) -> None:
        acceleration = self.motion.acceleration / MM_S2_PER_GAL
        motion = pd.DataFrame({"t_s": self.motion.time, "acc_gal": acceleration})
        if self.across is not None:
            motion["across_gal"] = self.across.motion.acceleration / MM_S2_PER_GAL
        for file, frame, form in ((MOTION, motion, "%.6f"), (SPECTRUM, self.table, "%.6g")):
            look: dict[str, Any] = {"fmt": form, "delimiter": ",", "comments": ""}
            np.savetxt(folder / file, frame, header=",".join(frame.columns), **look)


def _rotated_columns(pair: MotionPair, found: ResponseSpectrum) -> dict[str, Floats]:
    """Return the spectrum of the second record, RotD50 and RotD100 at the periods of the first."""
    turned = rotated_spectrum(pair, found.periods, found.damping)
    second = int(np.flatnonzero(turned.angles == 90.0)[0])
    sizes = {
        "gal": turned.acceleration / MM_S2_PER_GAL,
        "pseudo_gal": turned.pseudo_acceleration / MM_S2_PER_GAL,
        "cm": turned.displacement / MM_PER_CM,
    }
    return {"across_acceleration_gal": turned.acceleration[second] / MM_S2_PER_GAL} | {
        f"{measure}_{unit}": values
        for unit, responses in sizes.items()
        for measure, values in rotation_measures(responses)._asdict().items()
    }


def standard_words(standard: Mapping[str, Any]) -> str:
    """Return a standard spectrum in words, from a summary or the fields of a `Reference`."""
    kind = standard.get("type", standard.get("kind"))
    zone = float(standard["zone_factor"])
    return f"Level 2 Type {kind}, ground {standard['ground']}, c_z = {zone:g}"


def measures_table(summary: Mapping[str, Any]) -> Table:
    """Return the measures of a summary, a row each; rounding errors of the ends are zeros."""
    known = [quantity(name) for name in MEASURES if summary.get(name) is not None]
    records, heads = [summary], ["Value"]
    if across := summary.get("across"):
        records, heads = [summary, across], list(summary["records"])
    rows = [
        (one.head, *(one.text(round(each[one.name], 6)) for each in records), one.unit)
        for one in known
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
    damping: float = DAMPING,
    baseline: bool = False,
    high_pass: float | None = None,
    command: str = "motions show",
) -> MotionResult:
    """Return size, duration, ends and spectrum of a ground motion, with a standard spectrum.

    Of a pair, they are those of both records, with RotD50 and RotD100 of their responses.

    If neither `kind` nor `ground` of the standard spectrum is given, they are those that a built-in
    motion was made for; there is none for others. `baseline` or a corner `high_pass` [Hz] corrects
    the base line first; see `baseline_corrected`.
    """
    if isinstance(motion, MotionPair):
        options = {"damping": damping, "baseline": baseline, "high_pass": high_pass}
        first, second = (
            examine_motion(one, kind, ground, command=command, **options)  # type: ignore[arg-type]
            for one in (motion.first, motion.second)
        )
        return replace(first, misfit=None, across=second)
    if baseline or high_pass is not None:
        motion = baseline_corrected(motion, high_pass=high_pass)
    return _measured(command, motion, _reference(motion, kind, ground), damping)


@dataclass(frozen=True)
class MotionCase:
    """Input of a generated motion: the standard spectrum to fit, and the phases.

    Phases are random, from a seed, or those of a record. The time step `dt` [s] is
    that of the record, or 0.01 s, where it is None.
    """

    kind: str
    ground: str
    zone_factor: float = 1.0
    seed: int = DEFAULT_SEED
    record: GroundMotion | None = None
    dt: float | None = None

    @property
    def name(self) -> str:
        """Name of the result directory."""
        if self.record is None:
            return f"jra-{self.kind}-{self.ground}-{self.seed}".lower()
        name = f"{self.record.name}-as-{self.kind}-{self.ground}".lower()
        return re.sub(r"[^\w.+-]+", "-", name)


def make_motion_case(
    kind: str | int = "II",
    ground: str | int = "I",
    *,
    seed: int | None = None,
    record: str | Path | GroundMotion | None = None,
    dt: float | None = None,
    zone_factor: float = 1.0,
    unit: str | None = None,
    component: str | None = None,
    trust_unit: bool = False,
) -> MotionCase:
    """Return the validated input of a generated motion; see `MotionCase`.

    `record` may be a motion, a name or a file; unit, component and trust_unit are those of
    `load_motion`.
    """
    kind, ground = kind_and_ground(kind, ground)
    if record is not None and not isinstance(record, GroundMotion):
        record = load_motion(record, unit=unit, component=component, trust_unit=trust_unit)
    seed = DEFAULT_SEED if seed is None else seed
    return MotionCase(kind, ground, zone_factor, seed, record, dt)


def run_motion(case: MotionCase, *, progress: Progress | None = None) -> MotionResult:
    """Generate the motion of a case and measure its fit.

    `progress` is called after each round of the fit with (rounds done, at most).
    """
    kind, ground, factor = case.kind, case.ground, case.zone_factor
    if case.record is None:
        dt = DEFAULT_DT if case.dt is None else case.dt
        motion = make_motion(kind, ground, case.seed, dt, zone_factor=factor, progress=progress)
    else:
        record = case.record if case.dt is None else resampled(case.record, case.dt)
        motion = match_spectrum(record, kind, ground, zone_factor=factor, progress=progress)
    result = _measured("motions make", motion, Reference(kind, ground, factor), DAMPING)
    assert result.misfit is not None
    return replace(result, outcome=POOR_FIT) if result.misfit > LARGEST_MISFIT else result


def _reference(motion: GroundMotion, kind: str | None, ground: str | None) -> Reference | None:
    """Return the spectrum to compare with: the given one, or the target of a built-in motion."""
    if kind or ground:
        return Reference(*kind_and_ground(kind or "II", ground or "I"))
    named = re.fullmatch(r"jra-(i|ii)-(i|ii|iii)-\d+", motion.name)
    return Reference(named[1].upper(), named[2].upper()) if named else None


def _measured(
    command: str, motion: GroundMotion, reference: Reference | None, damping: float
) -> MotionResult:
    check_damping(damping)
    measures = measure_motion(motion)
    error = None if reference is None else misfit(motion, reference.at)
    return MotionResult(command, motion, measures, damping, reference, error)
