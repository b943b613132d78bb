"""List, examine and generate ground motions."""

from typing import Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import FILES, RESAMPLE, Answer, Ending, Group, app, with_progress
from thermobearing.commands.options import command, fields

HELP = "List, examine and generate ground motions."
motions = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")
app.add_typer(motions, name="motions", rich_help_panel=FILES)

RECORD = Annotated[str, typer.Argument(help="File of a record, or name of a built-in motion.")]
READING = "unit dt component trust_unit"  # what a file may not state
READ = fields(
    "motions.readers:read_motion",
    READING,
    unit="|Unit of the acceleration (g, gal, m/s2, cm/s2 or mm/s2), if the file has none.",
    dt="|Time step [s], if the file has none.",
    component="|Component, by name (NS) or number from 1, if the file has several.",
    trust_unit="|Accept a peak acceleration that is implausible for the unit.",
)
ACROSS = fields(
    "earthquake.motions:Motion",
    "across across_component resample",
    across="|File or built-in name of the second record of a pair.|NAME/FILE",
    across_component="|Component of the second record; makes a pair with the same file.",
    resample=RESAMPLE,
)
EXAMINED = fields(
    "motions.run:examine_motion",
    "kind ground baseline high_pass",
    kind="--type|Type of the standard spectrum: I or II.",
    ground="|Ground of the standard spectrum: I, II or III.",
    baseline="|Correct the baseline.",
    high_pass="|Corner frequency of an additional high-pass filter [Hz].",
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


def _examine(file: str, given: dict[str, Any], end: Ending, command: str) -> Answer:
    """Examine a motion, and save the result where an output directory is given."""
    from thermobearing.motions.library import load_motion
    from thermobearing.motions.pair import MotionPair, make_pair
    from thermobearing.motions.record import GroundMotion
    from thermobearing.motions.run import examine_motion

    end.check()
    read = {name: given.pop(name) for name in READING.split() if name in given}
    second, component = given.pop("across", None), given.pop("across_component", None)
    resample = bool(given.pop("resample", False))
    first = load_motion(file, **read)
    motion: GroundMotion | MotionPair = first
    if second is not None or component is not None:
        across = load_motion(second or file, **read | {"component": component})
        motion = make_pair(first, across, resample=resample)
    return end.save_if_asked(examine_motion(motion, command=command, **given))


@command(
    motions, "show", READ, ACROSS, EXAMINED, examples="motions show record.csv --unit gal -o record"
)
def _show(file: RECORD, given: dict[str, Any], end: Ending) -> Answer:
    """Show the measures of a motion; with -o also write histories, spectra and figures."""
    return _examine(file, given, end, "motions show")


@command(
    motions,
    "spectrum",
    READ,
    ACROSS,
    EXAMINED,
    fields("motions.run:examine_motion", "damping", damping="|Damping ratio; 0.05 by default."),
    examples="motions spectrum jra-ii-i-1 --type II --ground I",
)
def _spectrum(file: RECORD, given: dict[str, Any], end: Ending) -> Answer:
    """Compute the response spectrum of a motion and compare it with a standard spectrum."""
    return _examine(file, given, end, "motions spectrum")


@command(
    motions,
    "make",
    fields(
        "motions.run:make_motion_case",
        "kind ground seed record dt zone_factor unit component trust_unit",
        kind="--type|Type of the standard spectrum: I (long) or II (pulse-like, default).",
        ground="|Ground of the standard spectrum: I (hard, default), II or III (soft).",
        seed="|Seed of the random phases; 1 by default.",
        record="--from|Record or motion whose phases are kept.",
        dt="|Time step [s]; 0.01 by default.",
        zone_factor="|Regional factor c_z; 1 by default.",
        unit="|Unit of the acceleration, if the file has none.",
        component="|Component, by name (NS) or number from 1, if the file has several.",
        trust_unit="|Accept a peak acceleration that is implausible for the unit.",
    ),
    examples="motions make --type II --ground I --seed 7 -o motion",
)
def _make(given: dict[str, Any], end: Ending) -> Answer:
    """Generate a motion that fits a standard spectrum, from a seed or from a record."""
    from thermobearing.motions.run import make_motion_case, run_motion

    if "record" not in given and {"unit", "component", "trust_unit"} & set(given):
        raise InputError("--unit, --component and --trust-unit require a record (--from)")
    if "record" in given and "seed" in given:
        raise InputError("give --seed or --from, not both: --from keeps the phases of a record")
    case = make_motion_case(given.pop("kind", "II"), given.pop("ground", "I"), **given)
    target = end.target(f"motion-{case.name}")
    what = "rounds"
    result = with_progress(lambda show: run_motion(case, progress=show), what, end.quiet)
    return end.save(result, target)
