"""List, examine and generate ground motions."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from thermobearing.border.errors import InputError, printable
from thermobearing.commands.common import (
    FILES,
    Answer,
    Ending,
    Group,
    app,
    echo_written,
    with_progress,
)
from thermobearing.commands.options import Overwrite, command, fields

HELP = "List, examine and generate ground motions."
motions = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")
app.add_typer(motions, name="motions", rich_help_panel=FILES)

RECORD = Annotated[str, typer.Argument(help="File of a record, or name of a built-in motion.")]
READING = "unit dt component trust_unit"  # what a file may not state
READ = fields("motions.readers:read_motion", READING)
ACROSS = fields(
    "earthquake.motions:Motion",
    "across across_component resample",
    across="||NAME/FILE",
)
EXAMINED = fields(
    "motions.run:examine_motion",
    "kind ground compare baseline high_pass",
    compare="||FILE",
)


@command(motions, "list", examples="motions list")
def _list() -> Answer:
    """List the built-in motions, which fit the standard spectra of Level 2."""
    from thermobearing.motions.library import list_motions, load_motion
    from thermobearing.motions.record import MM_S2_PER_GAL

    names = list_motions()
    for motion in map(load_motion, names):
        size = f"{motion.pga / MM_S2_PER_GAL:5.0f} gal {motion.duration:6.1f} s"
        typer.echo(f"{motion.name:15}{size}  {motion.description}")
    return {"motions": names}


def _examine(file: str, options: dict[str, Any], end: Ending, command: str) -> Answer:
    """Examine a motion, and save the result where an output directory is given."""
    from thermobearing.motions.library import load_motion
    from thermobearing.motions.pair import MotionPair, make_pair
    from thermobearing.motions.record import GroundMotion
    from thermobearing.motions.run import examine_motion

    end.check()
    read = {name: options.pop(name) for name in READING.split() if name in options}
    second, component = options.pop("across", None), options.pop("across_component", None)
    resample = bool(options.pop("resample", False))
    first = load_motion(file, **read)
    motion: GroundMotion | MotionPair = first
    if second is not None or component is not None:
        across = load_motion(second or file, **read | {"component": component})
        motion = make_pair(first, across, resample=resample)
    return end.save_if_asked(examine_motion(motion, command=command, **options))


@command(
    motions, "show", READ, ACROSS, EXAMINED, examples="motions show record.csv --unit gal -o record"
)
def _show(file: RECORD, options: dict[str, Any], end: Ending) -> Answer:
    """Show the measures of a motion; with -o also write histories, spectra and figures."""
    return _examine(file, options, end, "motions show")


@command(
    motions,
    "spectrum",
    READ,
    ACROSS,
    EXAMINED,
    fields("motions.run:examine_motion", "damping"),
    examples="motions spectrum jra-ii-i-1 --kind II --ground I\n"
    "motions spectrum jra-ii-i-1 --compare site.csv",
)
def _spectrum(file: RECORD, options: dict[str, Any], end: Ending) -> Answer:
    """Compute the response spectrum of a motion and compare it with a target spectrum."""
    return _examine(file, options, end, "motions spectrum")


@command(
    motions,
    "save",
    READ,
    fields("motions.run:examine_motion", "baseline high_pass"),
    examples="motions save jra-ii-i-1 motion.AT2\nmotions save record.csv new.csv --unit gal",
)
def _save(
    file: RECORD,
    target: Annotated[
        Path,
        typer.Argument(help="File, .csv or .AT2 (PEER).", metavar="TARGET", show_default=False),
    ],
    options: dict[str, Any],
    overwrite: Overwrite,
) -> Answer:
    """Write a motion to a file: a table of times and accelerations, or AT2."""
    from thermobearing.motions.library import load_motion, save_motion
    from thermobearing.motions.process import baseline_corrected

    baseline, high_pass = options.pop("baseline", False), options.pop("high_pass", None)
    motion = load_motion(file, **options)
    if baseline or high_pass is not None:
        motion = baseline_corrected(motion, high_pass=high_pass)
    save_motion(motion, target, overwrite=overwrite)
    echo_written(target)
    return {"exit_status": 0, "output": str(target), "motion": motion.name}


@command(
    motions,
    "make",
    fields(
        "motions.run:make_motion_case",
        "kind ground spectrum seed record dt zone_factor unit component trust_unit",
        spectrum="||FILE",
    ),
    examples="motions make --kind II --ground I --seed 7 -o motion\n"
    "motions make --spectrum site.csv --seed 2 -o site-2",
)
def _make(options: dict[str, Any], end: Ending) -> Answer:
    """Generate a motion that fits a spectrum, from a seed or from a record."""
    from thermobearing.motions.run import make_motion_case, run_motion

    if "record" not in options and {"unit", "component", "trust_unit"} & set(options):
        raise InputError("--unit, --component and --trust-unit require a record (--record)")
    if "record" in options and "seed" in options:
        raise InputError("give --seed or --record, not both: --record keeps the phases of a record")
    case = make_motion_case(**options)
    target = end.target(f"motion-{case.name}")
    unit = "rounds"
    result = with_progress(lambda show: run_motion(case, progress=show), unit, end.quiet)
    if end.output is not None:  # the name under which `load_motion` reads the file
        name = printable(target.absolute().name)
        result = replace(result, motion=replace(result.motion, name=name))
    return end.save(result, target)
