"""`thermobearing motions`: what is built in, a look at a record, motions that fit a spectrum."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    NO_DOCUMENTS,
    AsJson,
    Command,
    Documents,
    Group,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    echo_json,
    reported,
    with_progress,
    written,
)

if TYPE_CHECKING:
    from thermobearing.motions.run import MotionResult

HELP = "Ground motions: built in, read, made to fit a spectrum."
app = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")

Record = Annotated[str, typer.Argument(help="A record, or the name of a built-in motion.")]
Unit = Annotated[str | None, typer.Option(help="Of the numbers, if the file does not tell.")]
Step = Annotated[float | None, typer.Option(help="Time step [s], if the file does not tell.")]
Component = Annotated[str | None, typer.Option(help="Which one, such as NS, or a number from 1.")]
TrustUnit = Annotated[bool, typer.Option("--trust-unit", help="Accept an implausible size.")]
Baseline = Annotated[bool, typer.Option("--baseline", help="Correct the base line.")]
HighPass = Annotated[float | None, typer.Option(help="And filter below this frequency [Hz].")]
Kind = Annotated[str | None, typer.Option("--type", help="Standard spectrum: I or II.")]
Ground = Annotated[str | None, typer.Option(help="Standard spectrum: I, II or III.")]


@app.command("list", cls=Command, epilog="Example: thermobearing motions list")
@reported
def list_(as_json: AsJson = False) -> int:
    """The built-in motions: stand-ins that fit the standard spectra of Level 2."""
    from thermobearing.motions.library import list_motions, load_motion
    from thermobearing.motions.record import MM_S2_PER_GAL

    names = list_motions()
    for motion in map(load_motion, names):
        size = f"{motion.pga / MM_S2_PER_GAL:5.0f} gal {motion.duration:6.1f} s"
        typer.echo(f"{motion.name:15}{size}  {motion.description}")
    if as_json:
        echo_json({"motions": names})
    return 0


@app.command(
    cls=Command, epilog="Example: thermobearing motions show record.csv --unit gal -o record"
)
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
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Size, duration and ends of a motion; with -o its histories, spectra and figures."""
    from thermobearing.motions.library import load_motion
    from thermobearing.motions.run import examine_motion

    motion = load_motion(file, unit=unit, dt=dt, component=component, trust_unit=trust_unit)
    result = examine_motion(motion, kind, ground, baseline=baseline, high_pass=high_pass)
    if not quiet:
        result.show()
    return _end(result, output, overwrite, no_figures, as_json, quiet, documents)


@app.command(
    cls=Command, epilog="Example: thermobearing motions spectrum jra-ii-i-1 --type II --ground I"
)
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
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Response spectrum of a motion, beside a standard one (5 % damping)."""
    from thermobearing.motions.library import load_motion
    from thermobearing.motions.run import examine_motion

    motion = load_motion(file, unit=unit, dt=dt, component=component, trust_unit=trust_unit)
    result = examine_motion(
        motion,
        kind,
        ground,
        damping=damping,
        baseline=baseline,
        high_pass=high_pass,
        command="motions spectrum",
    )
    if not quiet:
        result.show()
    return _end(result, output, overwrite, no_figures, as_json, quiet, documents)


@app.command(
    cls=Command,
    epilog="Example: thermobearing motions make --type II --ground I --seed 7 -o motion",
)
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
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """A motion that fits a standard spectrum: from a seed, or from the phases of a record."""
    from thermobearing.motions.run import make_motion_case, run_motion
    from thermobearing.results.directory import check_target

    if record is None and (unit or component or trust_unit):
        raise InputError("--unit, --component and --trust-unit belong to a record (--from)")
    if record is not None and seed is not None:
        raise InputError("--seed belongs to random phases; --from keeps those of a record")
    case = make_motion_case(
        kind,
        ground,
        seed=seed,
        record=record,
        dt=dt,
        zone_factor=zone_factor,
        unit=unit,
        component=component,
        trust_unit=trust_unit,
    )
    target = output or Path(f"motion-{case.name}")
    check_target(target, overwrite=overwrite)
    result = with_progress(
        lambda show: run_motion(case, progress=show), "rounds of the fit, at most", quiet
    )
    if not quiet:
        result.show()
    return _end(result, target, overwrite, no_figures, as_json, quiet, documents)


def _end(
    result: "MotionResult",
    target: Path | None,
    overwrite: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
    documents: Documents,
) -> int:
    """Write the result directory if there is to be one; the exit status."""
    if target is None:
        if documents.report or documents.workbook:
            raise InputError("a report goes into a result directory: give -o")
        if as_json:
            echo_json({"exit_status": 0, **result.summary()})
        return 0
    result.save(target, overwrite=overwrite, figures=not no_figures)
    return written(result.outcome, result.sentence, target, documents, as_json=as_json, quiet=quiet)
