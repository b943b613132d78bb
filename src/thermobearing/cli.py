"""The command `thermobearing`: thin calls into the library, clear ends.

Exit status: 0 done; 2 bad input or a target that cannot be written (one message, nothing
written); 3 the analysis ended early (partial results written); 4 a poor fit (written, the
bearing marked); 130 interrupted (partial results kept). Heavy imports wait until a command needs
them, so that --help is quick.
"""

import contextlib
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
import typer.core

import thermobearing
from thermobearing.border.errors import InputError
from thermobearing.commands import design, earthquake, factors, sequence
from thermobearing.commands.common import (
    BAD_INPUT,
    AsJson,
    Exposed,
    Force,
    NoFigures,
    Output,
    Quiet,
    RigName,
    echo_json,
    exposure_given,
    reported,
    with_progress,
    written,
)
from thermobearing.commands.identify import identify
from thermobearing.commands.intake import intake
from thermobearing.commands.measure import measure
from thermobearing.commands.motions import app as motions
from thermobearing.commands.new import new
from thermobearing.commands.streams import patient_streams
from thermobearing.commands.structures import app as structures
from thermobearing.commands.threads import one_blas_thread
from thermobearing.commands.validate import validate

if TYPE_CHECKING:
    from thermobearing.cyclic.case import Case
    from thermobearing.cyclic.result import Result


class _Commands(typer.core.TyperGroup):
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
    add_completion=False,
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


app.add_typer(motions, name="motions")
app.add_typer(structures, name="structures")
app.command()(earthquake.bridge)
app.command()(earthquake.hybrid)
app.command()(sequence.sequence)
app.command()(design.design)
app.command()(design.bounds)
app.command("lambda")(factors.lambda_)


BearingName = Annotated[
    str | None, typer.Option(help="Library name or TOML file.", metavar="NAME/FILE")
]
Ambients = Annotated[
    list[float] | None, typer.Option(help="Ambient temperature [degC]; may be repeated.")
]


@app.command()
@reported
def cyclic(
    case: Annotated[
        Path | None, typer.Argument(help="Case file; without one, Table 3.4 on the HDR specimen.")
    ] = None,
    bearing: BearingName = None,
    ambient: Ambients = None,
    dt: Annotated[float | None, typer.Option(help="Largest time step in motion [s].")] = None,
    scheme: Annotated[str | None, typer.Option(help="conservative or published.")] = None,
    integrator: Annotated[str | None, typer.Option(help="exact or euler.")] = None,
    hardening: Annotated[str | None, typer.Option(help="printed or monotone.")] = None,
    heat_source: Annotated[str | None, typer.Option(help="work or dissipation.")] = None,
    lead_ends: Annotated[str | None, typer.Option(help="finite-plate or half-space.")] = None,
    clock: Annotated[str | None, typer.Option(help="Of a half-space: lead or steel.")] = None,
    model: Annotated[str | None, typer.Option(help="An earlier model, see docs/theory.md.")] = None,
    exposure: Exposed = None,
    compare: Annotated[bool, typer.Option("--compare", help="Earlier models beside it.")] = False,
    keep_every: Annotated[int | None, typer.Option(help="Keep every n-th step.")] = None,
    rig: RigName = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Displacement-controlled cyclic test of a bearing, heat and hysteresis coupled."""
    from thermobearing.cyclic.case import load_case, make_case
    from thermobearing.cyclic.files import save_result
    from thermobearing.cyclic.run import run_case
    from thermobearing.cyclic.screen import print_result
    from thermobearing.results.directory import check_target

    overrides = {
        "bearing": bearing,
        "ambient": ambient or None,
        "dt": dt,
        "scheme": scheme,
        "integrator": integrator,
        "hardening": hardening,
        "heat_source": heat_source,
        "lead_ends": lead_ends,
        "clock": clock,
        "model": model,
        "exposure": exposure_given(exposure),
        "keep_every": keep_every,
        "rig": rig,
    }
    if case is None:
        complete = make_case({}, "command line", **overrides)
    else:
        complete = load_case(case, **overrides)
    target = output or Path("cyclic-" + re.sub(r"[^\w.+-]+", "-", complete.bearing.name))
    check_target(target, force=force)
    result = with_progress(lambda show: run_case(complete, progress=show), "stepping", quiet)
    others = _others(complete, result) if compare and result.outcome == "completed" else {}
    save_result(result, target, force=force, figures=not no_figures, compared=others)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
            print_result(result, others)
    return written(result.outcome, result.sentence, target, as_json=as_json, quiet=quiet)


def _others(case: "Case", result: "Result") -> "dict[str, Result]":
    """The result and those of the earlier models, by name; InputError without cycles."""
    from thermobearing.cyclic.compare import compare_models

    if len(result.cycles) == 0:
        raise InputError("--compare needs a test with cycles")
    return compare_models(case)


@app.command("list")
@reported
def list_(as_json: AsJson = False) -> int:
    """What is built in."""
    from thermobearing.bearing.bilinear import list_bilinear, load_bilinear
    from thermobearing.bearing.compound import list_compounds, load_compound
    from thermobearing.bearing.library import list_bearings, load_bearing
    from thermobearing.cyclic.rig import RIGS, load_rig
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


@app.command()
@reported
def check(
    file: Annotated[Path, typer.Argument(help="A bearing, a compound, a case, or any other TOML.")],
    as_json: AsJson = False,
) -> int:
    """Validate a file without running it, and say what was understood.

    Numbers that usual bearings do not have are warnings: units, signs. Of a bearing also what its
    heat cells cost in accuracy, by a short test on it.
    """
    from rich.console import Console

    from thermobearing.commands.check import cells_facts, check_file
    from thermobearing.results.screen import print_facts, print_warnings

    kind, facts, warnings = check_file(file)
    facts |= cells_facts(file) if kind == "bearing" else {}
    print_facts(f"{file}: a valid {kind}", facts)
    print_warnings(Console(), warnings)
    if as_json:
        echo_json({"outcome": "valid", "kind": kind, "file": str(file), "warnings": warnings})
    return 0


app.command()(new)
app.command()(measure)
app.command()(intake)
app.command()(identify)
app.command()(validate)


def main() -> None:
    """Entry point of the console script."""
    one_blas_thread()
    patient_streams()
    try:
        app()
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()


if __name__ == "__main__":
    main()
