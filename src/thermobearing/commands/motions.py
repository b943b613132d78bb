"""`thermobearing motions`: what is built in, a look at a record, motions that fit a spectrum."""

from typing import Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import Ending, Group, echo_json
from thermobearing.commands.options import AsJson, add, command, fields

HELP = "Ground motions: built in, read, made to fit a spectrum."
app = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")

RECORD = Annotated[str, typer.Argument(help="A record, or the name of a built-in motion.")]
READING = "unit dt component trust_unit"  # what a file does not say
READ = fields(
    "motions.readers:read_motion",
    READING,
    unit="|Unit of the acceleration (g, gal, m/s2, cm/s2, mm/s2), if the file does not say.",
    dt="|Time step [s], if the file does not say.",
    component="|Name such as NS, or number from 1, if the file holds several.",
    trust_unit="|Accept a size that is implausible for the unit.",
)
EXAMINED = fields(
    "motions.run:examine_motion",
    "kind ground baseline high_pass",
    kind="--type|Type of the standard spectrum: I or II.",
    ground="|Ground of the standard spectrum: I, II or III.",
    baseline="|Correct the base line.",
    high_pass="|Filter below this frequency [Hz] besides.",
)


@add(app, "list", "motions list")
@command()
def list_(as_json: AsJson) -> int:
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


def _examined(file: str, given: dict[str, Any], command: str = "motions show") -> Any:
    """Return a look at a record."""
    from thermobearing.motions.library import load_motion
    from thermobearing.motions.run import examine_motion

    read = {name: given.pop(name) for name in READING.split() if name in given}
    return examine_motion(load_motion(file, **read), command=command, **given)


@add(app, "show", "motions show record.csv --unit gal -o record")
@command(READ, EXAMINED)
def show(file: RECORD, given: dict[str, Any], end: Ending) -> int:
    """Size, duration and ends of a motion; with -o its histories, spectra and figures."""
    end.check()
    return end.save_if_asked(_examined(file, given))


@add(app, "spectrum", "motions spectrum jra-ii-i-1 --type II --ground I")
@command(
    READ,
    EXAMINED,
    fields(
        "motions.run:examine_motion",
        "damping",
        damping="|Ratio of critical damping; 0.05 by default.",
    ),
)
def spectrum(file: RECORD, given: dict[str, Any], end: Ending) -> int:
    """Response spectrum of a motion, compared with a standard one (5 % damping)."""
    end.check()
    return end.save_if_asked(_examined(file, given, "motions spectrum"))


@add(app, "make", "motions make --type II --ground I --seed 7 -o motion")
@command(
    fields(
        "motions.run:make_motion_case",
        "kind ground seed record dt zone_factor unit component trust_unit",
        kind="--type|I (long) or II (pulse-like); II by default.",
        ground="|I (hard), II or III (soft); I by default.",
        seed="|Seed of the random phases; 1 by default.",
        record="--from|Keep the phases of this record or motion.",
        dt="|Time step [s]; 0.01 by default.",
        zone_factor="|Factor c_z of the region; 1 by default.",
        unit="|Unit of the acceleration, if the file does not say.",
        component="|Name such as NS, or number from 1, if the file holds several.",
        trust_unit="|Accept a size that is implausible for the unit.",
    )
)
def make(given: dict[str, Any], end: Ending) -> int:
    """A motion that fits a standard spectrum: from a seed, or from the phases of a record."""
    from thermobearing.motions.run import make_motion_case, run_motion

    if "record" not in given and {"unit", "component", "trust_unit"} & set(given):
        raise InputError("--unit, --component and --trust-unit belong to a record (--from)")
    if "record" in given and "seed" in given:
        raise InputError("--seed belongs to random phases; --from keeps those of a record")
    case = make_motion_case(given.pop("kind", "II"), given.pop("ground", "I"), **given)
    target = end.target(f"motion-{case.name}")
    result = end.progress(
        lambda show: run_motion(case, progress=show), "rounds of the fit, at most"
    )
    return end.save(result, target)
