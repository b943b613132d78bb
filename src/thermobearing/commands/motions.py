"""`thermobearing motions`: what is built in, a look at a record, motions that fit a spectrum."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    echo_json,
    reported,
    written,
)

if TYPE_CHECKING:
    from thermobearing.motions.record import GroundMotion
    from thermobearing.motions.spectrum import ResponseSpectrum

MM_PER_CM = 10.0
LARGEST_MISFIT, POOR_FIT, COMPLETED = 0.03, "poor_fit", "completed"
FIRST, LAST, COUNT = 0.05, 5.0, 200  # periods of spectrum.csv [s]
TOLD = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0)  # periods on the screen [s]

app = typer.Typer(help="Ground motions: built in, read, made to fit a spectrum.",
                  no_args_is_help=True)  # fmt: skip

Record = Annotated[str, typer.Argument(help="A record, or the name of a built-in motion.")]
Unit = Annotated[str | None, typer.Option(help="Of the numbers, if the file does not tell.")]
Step = Annotated[float | None, typer.Option(help="Time step [s], if the file does not tell.")]
Component = Annotated[str | None, typer.Option(help="Which one, such as NS, or a number from 1.")]
TrustUnit = Annotated[bool, typer.Option("--trust-unit", help="Accept an implausible size.")]
Baseline = Annotated[bool, typer.Option("--baseline", help="Correct the base line.")]
HighPass = Annotated[float | None, typer.Option(help="And filter below so many Hz.")]
Kind = Annotated[str | None, typer.Option("--type", help="Standard spectrum: I or II.")]
Ground = Annotated[str | None, typer.Option(help="Standard spectrum: I, II or III.")]


@app.command("list")
@reported
def list_(as_json: AsJson = False) -> int:
    """The built-in motions: stand-ins that fit the standard spectra of Level 2."""
    from thermobearing.motions.library import list_motions, load_motion

    motions = [load_motion(name) for name in list_motions()]
    for motion in motions:
        size = f"{motion.pga / MM_PER_CM:5.0f} gal {motion.duration:6.1f} s"
        typer.echo(f"{motion.name:15}{size}  {motion.description}")
    if as_json:
        echo_json({"motions": [motion.name for motion in motions]})
    return 0


@app.command()
@reported
def show(
    file: Record,
    unit: Unit = None,
    dt: Step = None,
    component: Component = None,
    trust_unit: TrustUnit = False,
    baseline: Baseline = False,
    high_pass: HighPass = None,
    kind: Kind = None,
    ground: Ground = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Size, duration and ends of a motion; with -o its histories, spectra and figures."""
    motion = _load(file, unit, dt, component, trust_unit)
    motion = _corrected(motion, baseline, high_pass)
    summary = _summary("motions show", motion, _reference(motion, kind, ground))
    if not quiet:
        _print_summary(summary)
    return _end(motion, summary, output, force, no_figures, as_json, quiet)


@app.command()
@reported
def spectrum(
    file: Record,
    unit: Unit = None,
    dt: Step = None,
    component: Component = None,
    trust_unit: TrustUnit = False,
    baseline: Baseline = False,
    high_pass: HighPass = None,
    kind: Kind = None,
    ground: Ground = None,
    damping: Annotated[float, typer.Option(help="Ratio of critical damping.")] = 0.05,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Response spectrum of a motion, beside a standard one (5 % damping)."""
    motion = _load(file, unit, dt, component, trust_unit)
    motion = _corrected(motion, baseline, high_pass)
    reference = _reference(motion, kind, ground)
    summary = _summary("motions spectrum", motion, reference, damping)
    if not quiet:
        _print_spectrum(motion, reference, damping)
    return _end(motion, summary, output, force, no_figures, as_json, quiet)


@app.command()
@reported
def make(
    kind: Annotated[str, typer.Option("--type", help="I (long) or II (pulse-like).")] = "II",
    ground: Annotated[str, typer.Option(help="I (hard), II or III (soft).")] = "I",
    seed: Annotated[int | None, typer.Option(help="Of the random phases [default: 1].")] = None,
    record: Annotated[
        str | None, typer.Option("--from", help="Keep the phases of this record or motion.")
    ] = None,
    dt: Annotated[float | None, typer.Option(help="Time step [s] [default: 0.01].")] = None,
    zone_factor: Annotated[float, typer.Option(help="c_z of the region.")] = 1.0,
    unit: Unit = None,
    component: Component = None,
    trust_unit: TrustUnit = False,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """A motion that fits a standard spectrum: from a seed, or from the phases of a record."""
    from thermobearing.motions.jra import kind_and_ground
    from thermobearing.motions.process import resampled
    from thermobearing.motions.synthesis import make_motion, match_spectrum
    from thermobearing.results.directory import check_target

    kind, ground = kind_and_ground(kind, ground)
    if record is None:
        if unit or component or trust_unit:
            raise InputError("--unit, --component and --trust-unit belong to a record (--from)")
        number = 1 if seed is None else seed
        target = output or Path(f"motion-jra-{kind}-{ground}-{number}".lower())
        check_target(target, force=force)
        step = 0.01 if dt is None else dt
        motion = make_motion(kind, ground, number, step, zone_factor=zone_factor)
    else:
        if seed is not None:
            raise InputError("--seed belongs to random phases; --from keeps those of a record")
        given = _load(record, unit, None, component, trust_unit)
        target = output or Path(
            "motion-" + re.sub(r"[^\w.+-]+", "-", f"{given.name}-as-{kind}-{ground}".lower())
        )
        check_target(target, force=force)
        given = given if dt is None else resampled(given, dt)
        motion = match_spectrum(given, kind, ground, zone_factor=zone_factor)
    summary = _summary("motions make", motion, (kind, ground, zone_factor))
    if summary["standard_spectrum"]["misfit_rms"] > LARGEST_MISFIT:
        summary["outcome"] = POOR_FIT
    if not quiet:
        _print_summary(summary)
    return _end(motion, summary, target, force, no_figures, as_json, quiet)


def _load(
    file: str, unit: str | None, dt: float | None, component: str | None, trust_unit: bool
) -> "GroundMotion":
    from thermobearing.motions.library import load_motion

    return load_motion(file, unit=unit, dt=dt, component=component, trust_unit=trust_unit)


def _corrected(motion: "GroundMotion", baseline: bool, high_pass: float | None) -> "GroundMotion":
    """With its base line corrected, if that was asked for."""
    from thermobearing.motions.process import baseline_corrected

    if not baseline and high_pass is None:
        return motion
    return baseline_corrected(motion, high_pass=high_pass)


def _reference(
    motion: "GroundMotion", kind: str | None, ground: str | None
) -> tuple[str, str, float] | None:
    """Type, ground and zone factor to compare with: what was asked, or what it was made for."""
    from thermobearing.motions.jra import kind_and_ground

    named = re.fullmatch(r"jra-(i|ii)-(i|ii|iii)-\d+", motion.name)
    if kind or ground:
        return *kind_and_ground(kind or "II", ground or "I"), 1.0
    return (named[1].upper(), named[2].upper(), 1.0) if named else None


def _spectrum(motion: "GroundMotion", damping: float) -> "ResponseSpectrum":
    import numpy as np

    from thermobearing.motions.spectrum import response_spectrum

    return response_spectrum(motion, np.geomspace(FIRST, LAST, COUNT), damping)


def _summary(
    command: str,
    motion: "GroundMotion",
    reference: tuple[str, str, float] | None,
    damping: float = 0.05,
) -> dict[str, Any]:
    """What summary.json tells."""
    import thermobearing
    from thermobearing.motions.jra import standard_spectrum
    from thermobearing.motions.matching import misfit
    from thermobearing.motions.measures import measure_motion
    from thermobearing.motions.spectrum import check_damping

    check_damping(damping)
    measures = measure_motion(motion)
    standard = None
    if reference is not None:
        kind, ground, factor = reference
        error = misfit(motion, lambda t: standard_spectrum(kind, ground, t, zone_factor=factor))
        standard = {"type": kind, "ground": ground, "zone_factor": factor, "misfit_rms": error}
    return {
        "command": command,
        "motion": motion.name,
        "description": motion.description,
        "citation": motion.citation,
        "version": thermobearing.__version__,
        "outcome": COMPLETED,
        "dt_s": motion.dt,
        "samples": len(motion.acceleration),
        "duration_s": motion.duration,
        "pga_gal": measures.pga / MM_PER_CM,
        "pgv_cm_s": measures.pgv / MM_PER_CM,
        "pgd_cm": measures.pgd / MM_PER_CM,
        "end_velocity_cm_s": measures.end_velocity / MM_PER_CM,
        "end_displacement_cm": measures.end_displacement / MM_PER_CM,
        "arias_intensity_m_s": measures.arias_intensity / 1000.0,
        "significant_duration_s": measures.significant_duration,
        "bracketed_duration_s": measures.bracketed_duration,
        "cumulative_absolute_velocity_m_s": measures.cumulative_absolute_velocity / 1000.0,
        "damping": damping,
        "standard_spectrum": standard,
    }


def _print_summary(summary: dict[str, Any]) -> None:
    from thermobearing.cyclic.screen import print_facts

    facts = {
        "samples": f"{summary['samples']} every {summary['dt_s']:g} s",
        "largest acceleration": f"{summary['pga_gal']:.1f} gal",
        "largest velocity": f"{summary['pgv_cm_s']:.1f} cm/s",
        "largest displacement": f"{summary['pgd_cm']:.1f} cm",
        "at the end": f"{summary['end_velocity_cm_s']:.3g} cm/s, "
        f"{summary['end_displacement_cm']:.3g} cm",
        "Arias intensity": f"{summary['arias_intensity_m_s']:.2f} m/s",
        "duration": f"{summary['duration_s']:g} s, of which 5 to 95 %: "
        f"{summary['significant_duration_s']:.1f} s",
    }
    standard = summary["standard_spectrum"]
    if standard is not None:
        facts["misfit"] = (
            f"{100 * standard['misfit_rms']:.1f} % rms over 0.1 to 3 s against Level 2 "
            f"Type {standard['type']}, ground {standard['ground']}"
        )
    facts["description"] = summary["description"] or "-"
    print_facts(summary["motion"], facts)


def _print_spectrum(
    motion: "GroundMotion", reference: tuple[str, str, float] | None, damping: float
) -> None:
    from thermobearing.motions.jra import standard_spectrum
    from thermobearing.motions.spectrum import response_spectrum

    found = response_spectrum(motion, TOLD, damping)
    standard = reference and standard_spectrum(reference[0], reference[1], TOLD)
    last = f"  Type {reference[0]}, ground {reference[1]} [gal]" if reference else ""
    typer.echo(f"{motion.name}, {100 * damping:g} % damping")
    typer.echo(f"period [s]  acceleration [gal]  velocity [cm/s]  displacement [cm]{last}")
    for i, period in enumerate(TOLD):
        a, v, d = (
            float(values[i]) / MM_PER_CM
            for values in (found.acceleration, found.velocity, found.displacement)
        )
        end = f"{standard[i] / MM_PER_CM:20.0f}" if standard is not None else ""
        typer.echo(f"{period:10g}{a:20.1f}{v:17.1f}{d:19.2f}{end}")


def _end(
    motion: "GroundMotion",
    summary: dict[str, Any],
    target: Path | None,
    force: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Write the result directory if there is to be one; the exit status."""
    if target is None:
        if as_json:
            echo_json({"exit_status": 0, **summary})
        return 0
    from thermobearing.results.directory import write_directory

    def fill(folder: Path) -> None:
        _write(motion, summary, folder, figures=not no_figures)

    write_directory(target, fill, force=force)
    sentence = f"misfit above {100 * LARGEST_MISFIT:g} % rms; try another record or seed"
    return written(summary["outcome"], sentence, target, as_json=as_json, quiet=quiet)


def _write(motion: "GroundMotion", summary: dict[str, Any], folder: Path, *, figures: bool) -> None:
    import numpy as np

    from thermobearing.results.directory import FIGURES, MOTION, SPECTRUM, SUMMARY

    text = json.dumps(summary, indent=2, allow_nan=False, ensure_ascii=False)
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8")
    rows = np.column_stack([motion.time, motion.acceleration / MM_PER_CM])
    np.savetxt(folder / MOTION, rows, fmt=("%.6f", "%.6f"), delimiter=",",
               header="t_s,acc_gal", comments="")  # fmt: skip
    found = _spectrum(motion, summary["damping"])
    columns = {
        "period_s": found.periods,
        "acceleration_gal": found.acceleration / MM_PER_CM,
        "pseudo_acceleration_gal": found.pseudo_acceleration / MM_PER_CM,
        "velocity_cm_s": found.velocity / MM_PER_CM,
        "displacement_cm": found.displacement / MM_PER_CM,
    }
    references = _references(summary, found.periods)
    if summary["standard_spectrum"] is not None:
        columns["standard_gal"] = next(iter(references.values()))
    table = np.column_stack(list(columns.values()))
    np.savetxt(folder / SPECTRUM, table, fmt="%.6g", delimiter=",", header=",".join(columns),
               comments="")  # fmt: skip
    if figures:
        (folder / FIGURES).mkdir()
        _draw(motion, found, references, folder / FIGURES)


def _references(summary: dict[str, Any], periods: Any) -> dict[str, Any]:
    """Standard spectra to draw [gal]: the one compared with, or both types on ground I."""
    from thermobearing.motions.jra import standard_spectrum

    about = summary["standard_spectrum"]
    wanted = [("I", "I", 1.0), ("II", "I", 1.0)]
    if about is not None:
        wanted = [(about["type"], about["ground"], about["zone_factor"])]
    return {
        f"standard, Level 2 Type {kind}, ground {ground}, 5 %": standard_spectrum(
            kind, ground, periods, zone_factor=factor
        )
        / MM_PER_CM
        for kind, ground, factor in wanted
    }


def _draw(
    motion: "GroundMotion", found: "ResponseSpectrum", references: dict[str, Any], folder: Path
) -> None:
    from thermobearing.motions.figures import DPI, motion_figure, spectrum_figure
    from thermobearing.motions.measures import significant_interval

    drawn = {
        "motion": motion_figure(
            motion.name, motion.time, motion.acceleration / MM_PER_CM,
            motion.velocity / MM_PER_CM, motion.displacement / MM_PER_CM,
            significant_interval(motion),
        ),
        "spectrum": spectrum_figure(
            motion.name, found.periods, found.acceleration / MM_PER_CM,
            found.displacement / MM_PER_CM, references, found.damping,
        ),
    }  # fmt: skip
    for name, figure in drawn.items():
        figure.savefig(folder / f"{name}.png", dpi=DPI)
