"""Analyse structures on bearings in earthquakes."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.commands.common import (
    INPUT,
    MODEL,
    NO_DOCUMENTS,
    STRUCTURES,
    AsJson,
    Command,
    Compare,
    Documents,
    EarlierModel,
    Exposed,
    FixedBase,
    Group,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    RigName,
    SmallLoops,
    echo_json,
    exposure_given,
    reported,
    with_progress,
    written,
)

if TYPE_CHECKING:
    from thermobearing.earthquake.case import EarthquakeCase

Case = Annotated[Path | None, typer.Argument(help="Case file; without one, the default study.")]
Bearings = Annotated[
    list[str] | None,
    typer.Option(
        "--bearing",
        help="Name or TOML file; may be repeated.",
        metavar="NAME/FILE",
        rich_help_panel=INPUT,
    ),
]
Motions = Annotated[
    list[str] | None,
    typer.Option(
        "--motion",
        help="Name or file; may be repeated.",
        metavar="NAME/FILE",
        rich_help_panel=INPUT,
    ),
]
Ambients = Annotated[
    list[float] | None,
    typer.Option(
        "--ambient", help="Ambient temperature [degC]; may be repeated.", rich_help_panel=INPUT
    ),
]
Dt = Annotated[float | None, typer.Option(help="Largest time step [s].", rich_help_panel=MODEL)]
Structure_ = Annotated[
    str | None,
    typer.Option(
        "--structure", help="Name or TOML file.", metavar="NAME/FILE", rich_help_panel=INPUT
    ),
]
Method = Annotated[
    str | None,
    typer.Option(
        help="average-acceleration, linear-acceleration or predictor-corrector.",
        rich_help_panel=MODEL,
    ),
]
Damping_ = Annotated[
    str | None,
    typer.Option(
        "--damping", help="modal, rayleigh, element, none or source.", rich_help_panel=MODEL
    ),
]
Duration = Annotated[
    float | None, typer.Option(help="Cut motions to this [s].", rich_help_panel=INPUT)
]
Weather = Annotated[
    str | None,
    typer.Option(
        help="Ambient temperature that ends at the earthquake: table or EPW.",
        metavar="FILE",
        rich_help_panel=INPUT,
    ),
]


@reported
def bridge(
    case: Case = None,
    bearing: Bearings = None,
    motion: Motions = None,
    ambient: Ambients = None,
    weather: Weather = None,
    mass: Annotated[
        str | None, typer.Option(help="consistent or published.", rich_help_panel=MODEL)
    ] = None,
    structure: Structure_ = None,
    fixed_base: FixedBase = False,
    damping: Damping_ = None,
    method: Method = None,
    dt: Dt = None,
    duration: Duration = None,
    small_loops: SmallLoops = None,
    model: EarlierModel = None,
    exposure: Exposed = None,
    compare: Compare = False,
    rig: RigName = None,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """A bridge pier on isolation bearings in earthquakes, at several temperatures."""
    overrides = {
        "bearings": bearing or None,
        "motions": motion or None,
        "ambient": ambient or None,
        "weather": weather,
        "mass": mass,
        "structure": structure,
        "fixed_base": fixed_base or None,
        "damping": damping,
        "method": method,
        "dt": dt,
        "duration": duration,
        "small_loops": small_loops,
        "model": model,
        "exposure": exposure_given(exposure),
        "rig": rig,
    }
    complete = _case("bridge", case, overrides)
    return _carry_out(complete, output, overwrite, no_figures, as_json, quiet, compare, documents)


ForceNoise = Annotated[
    float | None,
    typer.Option(
        help="Standard deviation of the measured force [kN].", rich_help_panel="Laboratory"
    ),
]
Modes = Annotated[
    list[str] | None,
    typer.Option(
        help="rt (real time) or pd (pseudo-dynamic); may be repeated.",
        rich_help_panel="Laboratory",
    ),
]


@reported
def hybrid(
    case: Case = None,
    mode: Modes = None,
    bearing: Bearings = None,
    motion: Motions = None,
    ambient: Ambients = None,
    structure: Structure_ = None,
    fixed_base: FixedBase = False,
    damping: Damping_ = None,
    delay: Annotated[
        float | None, typer.Option(help="Delay of the actuator [s].", rich_help_panel="Laboratory")
    ] = None,
    force_noise: ForceNoise = None,
    seed: Annotated[
        int | None, typer.Option(help="Of the noise.", rich_help_panel="Laboratory")
    ] = None,
    method: Method = None,
    dt: Dt = None,
    duration: Duration = None,
    small_loops: SmallLoops = None,
    model: EarlierModel = None,
    exposure: Exposed = None,
    compare: Compare = False,
    rig: RigName = None,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """A hybrid test, simulated: a specimen in the loop with a calculated pier."""
    from thermobearing.border.units import with_unit

    lab: dict[str, Any] = {"mode": mode or None, "seed": seed}
    lab["delay"] = None if delay is None else with_unit(delay, "s")
    lab["force_noise"] = None if force_noise is None else with_unit(force_noise, "kN")
    overrides = {
        "bearings": bearing or None,
        "motions": motion or None,
        "ambient": ambient or None,
        "structure": structure,
        "fixed_base": fixed_base or None,
        "damping": damping,
        "method": method,
        "dt": dt,
        "duration": duration,
        "small_loops": small_loops,
        "model": model,
        "exposure": exposure_given(exposure),
        "rig": rig,
        "laboratory": {key: value for key, value in lab.items() if value is not None} or None,
    }
    complete = _case("hybrid", case, overrides)
    return _carry_out(complete, output, overwrite, no_figures, as_json, quiet, compare, documents)


def _case(command: str, path: Path | None, overrides: dict[str, Any]) -> "EarthquakeCase":
    from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case

    if path is None:
        return make_earthquake_case({"command": command}, "command line", **overrides)
    return load_earthquake_case(path, command=command, **overrides)


def _carry_out(
    case: "EarthquakeCase",
    output: Path | None,
    overwrite: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
    compare: bool,
    documents: Documents,
) -> int:
    """Check the target, run, write, tell."""
    from thermobearing.earthquake.run import run_earthquake
    from thermobearing.earthquake.study import compare_models, refuse_incomparable
    from thermobearing.results.directory import check_target

    target = output or Path(f"{case.command}-{case.structure.name}")
    check_target(target, overwrite=overwrite)
    if compare:
        refuse_incomparable(case)
    predicted = case.analysis.method == "predictor-corrector"
    kernel = "predictor.predictor_march" if predicted else STRUCTURES
    result = with_progress(lambda show: run_earthquake(case, progress=show), "runs", quiet, kernel)
    if compare and result.outcome == "completed":
        result.compared = compare_models(case)
    result.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
            result.show()
    return written(result.outcome, result.sentence, target, documents, as_json=as_json, quiet=quiet)


HELP = "Structures: built in, or drawn and checked before they are shaken."
app = typer.Typer(cls=Group, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")


@app.command("list", cls=Command, epilog="Example: thermobearing structures list")
@reported
def list_(as_json: AsJson = False) -> int:
    """The built-in structures."""
    from thermobearing.structure.model import list_structures
    from thermobearing.structure.output import print_structures

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
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Parts, periods, damping and mode shapes; with -o a drawing of the model too."""
    from thermobearing.results.directory import check_target
    from thermobearing.structure.output import print_structure
    from thermobearing.structure.result import examine_structure

    if output is not None:
        check_target(output, overwrite=overwrite)
    result = examine_structure(structure, fixed=fixed_base, mass=mass, damping=damping)  # type: ignore[arg-type]
    if not quiet:
        print_structure(result)
    if output is None:
        if as_json:
            echo_json({"exit_status": 0, **result.summary()})
        return 0
    result.save(output, overwrite=overwrite, figures=not no_figures)
    return written("completed", "", output, as_json=as_json, quiet=quiet)
