"""`thermobearing structures`: what is built in, a structure drawn with its periods and shapes."""

from typing import Annotated

import typer

from thermobearing.commands.common import (
    AsJson,
    FixedBase,
    Force,
    NoFigures,
    Output,
    Quiet,
    echo_json,
    reported,
    written,
)
from thermobearing.commands.help import Command, Group

HELP = "Structures: built in, or drawn and checked before they are shaken."
app = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")


@app.command("list", cls=Command, epilog="Example: thermobearing structures list")
@reported
def list_(as_json: AsJson = False) -> int:
    """The built-in structures."""
    from thermobearing.structure.model import list_structures
    from thermobearing.structure.screen import print_structures

    names = list_structures()
    print_structures(names)
    if as_json:
        echo_json({"structures": names})
    return 0


@app.command(cls=Command, epilog="Example: thermobearing structures show pier-p1 -o pier")
@reported
def show(
    structure: Annotated[str, typer.Argument(help="Name or TOML file.", metavar="NAME/FILE")],
    fixed_base: FixedBase = False,
    mass: Annotated[str, typer.Option(help="consistent or published.")] = "consistent",
    damping: Annotated[
        str | None, typer.Option(help="modal, rayleigh, element, none or source.")
    ] = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Parts, periods, damping and mode shapes; with -o a drawing of the model too."""
    from thermobearing.results.directory import check_target
    from thermobearing.structure.result import examine_structure
    from thermobearing.structure.screen import print_structure

    if output is not None:
        check_target(output, force=force)
    result = examine_structure(structure, fixed=fixed_base, mass=mass, damping=damping)  # type: ignore[arg-type]
    if not quiet:
        print_structure(result)
    if output is None:
        if as_json:
            echo_json({"exit_status": 0, **result.summary()})
        return 0
    result.save(output, force=force, figures=not no_figures)
    return written("completed", "", output, as_json=as_json, quiet=quiet)
