"""The command `thermobearing`: thin calls into the library, clear ends.

Exit status: 0 done; 2 bad input or a target that cannot be written (one message, nothing
written; `intake` writes what it could read); 3 the analysis ended early (partial results
written); 4 a poor fit (written, the bearing marked); 130 interrupted (partial results kept).
Heavy imports wait until a command needs them, so that --help is quick.
"""

import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

import thermobearing
from thermobearing.border.threads import one_blas_thread
from thermobearing.commands import cyclic, design, earthquake, identify, intake, motions, study
from thermobearing.commands.common import (
    ANALYSES,
    BAD_INPUT,
    FILES,
    LABORATORY,
    OFFICE,
    Group,
    echo_json,
    patient_streams,
)
from thermobearing.commands.new import new
from thermobearing.commands.options import AsJson, add, command
from thermobearing.commands.report import report


class _Commands(Group):
    """The commands; wrong usage too ends with a line of JSON if --json is among the words."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        words = args[0] if args else kwargs.get("args")
        words = sys.argv[1:] if words is None else words
        try:
            return super().main(*args, **kwargs)
        except SystemExit as end:
            usage = getattr(end.__context__, "format_message", None)
            if end.code == BAD_INPUT and usage is not None and "--json" in words:
                echo_json({"outcome": "bad_input", "exit_status": BAD_INPUT, "message": usage()})
            raise


app = typer.Typer(
    name="thermobearing",
    cls=_Commands,
    help="Rubber isolation bearings in the cold: heat conduction coupled to hysteresis.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # or units in brackets vanish from the help
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"thermobearing {thermobearing.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Rubber isolation bearings in the cold."""


@add(app, "list", "list", panel=FILES)
@command()
def list_(as_json: AsJson) -> int:
    """What is built in."""
    from thermobearing.bearing.bilinear import list_bilinear, load_bilinear
    from thermobearing.bearing.compound import list_compounds, load_compound
    from thermobearing.bearing.library import list_bearings, load_bearing
    from thermobearing.cyclic.case import RIGS, load_rig
    from thermobearing.motions.library import list_motions
    from thermobearing.structure.model import list_structures, load_structure

    bearings = [load_bearing(name) for name in list_bearings()]
    for bearing in bearings:
        typer.echo(f"{bearing.name:24}  {bearing.kind:8}  {bearing.description}")
    for backbone in map(load_bilinear, list_bilinear()):
        typer.echo(f"{backbone.name:24}  {backbone.kind:8}  {backbone.description}")
    typer.echo("")
    for compound in map(load_compound, list_compounds()):
        typer.echo(f"{compound.name:24}  compound  {compound.description}")
    typer.echo("")
    for structure in map(load_structure, list_structures()):
        typer.echo(f"{structure.name:24}  structure  {structure.description}")
    rigs = [load_rig(name) for name in RIGS.names()]
    for rig in rigs:
        typer.echo(f"{rig.name:24}  rig        {rig.description}")
    motions = list_motions()
    typer.echo(f"\n{len(motions)} ground motions, see `thermobearing motions list`")
    if as_json:
        echo_json(
            {
                "bearings": [bearing.name for bearing in bearings],
                "bilinear_bearings": list_bilinear(),
                "compounds": list_compounds(),
                "structures": list_structures(),
                "rigs": [rig.name for rig in rigs],
                "motions": motions,
            }
        )
    return 0


@add(app, "check", "check bearing.toml", panel=FILES)
@command()
def check(
    file: Annotated[Path, typer.Argument(help="A bearing, a compound, a case, or any other TOML.")],
    as_json: AsJson,
) -> int:
    """Validate a file without running it, and say what was understood.

    Numbers that usual bearings do not have are warnings: units, signs. Of a bearing also what its
    heat cells cost in accuracy, by a short test on it.
    """
    from thermobearing.commands.check import cells_facts, check_file
    from thermobearing.results.screen import print_facts, print_warnings

    kind, facts, warnings = check_file(file)
    facts |= cells_facts(file) if kind == "bearing" else {}
    print_facts(f"{file}: a valid {kind}", facts)
    print_warnings(warnings)
    if as_json:
        echo_json({"outcome": "valid", "kind": kind, "file": str(file), "warnings": warnings})
    return 0


EXAMPLES = """
cyclic --bearing shen-lhdr-specimen --ambient -20 --ambient 23 -o my-run
cyclic --strain 1.75 --wave sine --frequency 0.5 --cycles 11
bridge --motion jra-ii-i-1 --ambient -20 -o pier
hybrid --mode rt --mode pd --ambient -20 -o hybrid
sequence case.toml -o sequence
measure test.csv --bearing shen-hdr-specimen
intake cold.xlsx warm.csv --bearing mine.toml -o looked
new pier-3 --compound natural-rubber --plan 1000x1000mm --layers 20x8mm --shim 3mm --lead 180mm
identify cold.csv warm.csv --bearing mine.toml -o fit
validate mine.toml other-test.csv --limit energy=0.2
design --motion jra-ii-i-1 --compound G10 -o design
bounds --bearing shen-hdr-bridge --ambient -20
lambda shen-hdr-bridge --strain 1.75 -o factors
report pier --title number=B12-7 --title revision=B
"""
COMMANDS = {
    ANALYSES: {
        "cyclic": cyclic.cyclic,
        "bridge": earthquake.bridge,
        "hybrid": earthquake.hybrid,
        "sequence": cyclic.sequence,
    },
    LABORATORY: {
        "measure": intake.measure,
        "intake": intake.intake,
        "identify": identify.identify,
        "validate": identify.validate,
    },
    OFFICE: {"design": design.design, "bounds": design.bounds, "lambda": design.lambda_},
    FILES: {"new": new, "report": report},
}
for panel, functions in COMMANDS.items():
    for name, function in functions.items():
        examples = [line for line in EXAMPLES.splitlines() if line.split(" ")[0] == name]
        add(app, name, *examples, panel=panel)(function)
app.add_typer(study.app, name="study", rich_help_panel=ANALYSES)
app.add_typer(motions.app, name="motions", rich_help_panel=FILES)
app.add_typer(earthquake.app, name="structures", rich_help_panel=FILES)


def main() -> None:
    """Entry point of the console script."""
    one_blas_thread()
    patient_streams()
    os.environ.pop("MPLBACKEND", None)  # all is drawn without a window; a wrong one ends imports
    try:
        epoch = os.environ.get("SOURCE_DATE_EPOCH", "0")
        if not (epoch.isascii() and epoch.isdecimal()):
            typer.echo(f"thermobearing: SOURCE_DATE_EPOCH={epoch}: must be whole seconds", err=True)
            sys.exit(BAD_INPUT)
        app()
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        lost = getattr(sys.stdout, "lost", "")
        if lost:
            typer.echo(f"thermobearing: the output could not be written: {lost}", err=True)
            sys.exit(BAD_INPUT)


if __name__ == "__main__":
    main()
