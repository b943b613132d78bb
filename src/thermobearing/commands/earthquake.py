"""`thermobearing bridge` and `thermobearing hybrid`: structures in earthquakes."""

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
    Compare,
    Documents,
    EarlierModel,
    Exposed,
    FixedBase,
    Force,
    NoFigures,
    Output,
    Quiet,
    RigName,
    SmallLoops,
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
    force: Force = False,
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
    return _carry_out(complete, output, force, no_figures, as_json, quiet, compare, documents)


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
    force: Force = False,
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
    return _carry_out(complete, output, force, no_figures, as_json, quiet, compare, documents)


def _case(command: str, path: Path | None, overrides: dict[str, Any]) -> "EarthquakeCase":
    from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case

    if path is None:
        return make_earthquake_case({"command": command}, "command line", **overrides)
    return load_earthquake_case(path, command=command, **overrides)


def _carry_out(
    case: "EarthquakeCase",
    output: Path | None,
    force: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
    compare: bool,
    documents: Documents,
) -> int:
    """Check the target, run, write, tell."""
    from thermobearing.earthquake.compare import compare_models, refuse_incomparable
    from thermobearing.earthquake.files import save_earthquake
    from thermobearing.earthquake.run import run_earthquake
    from thermobearing.earthquake.screen import print_study
    from thermobearing.results.directory import check_target

    target = output or Path(f"{case.command}-{case.structure.name}")
    check_target(target, force=force)
    if compare:
        refuse_incomparable(case)
    predicted = case.analysis.method == "predictor-corrector"
    kernel = "predictor.predictor_march" if predicted else STRUCTURES
    result = with_progress(lambda show: run_earthquake(case, progress=show), "runs", quiet, kernel)
    others = compare_models(case) if compare and result.outcome == "completed" else {}
    save_earthquake(result, target, force=force, figures=not no_figures, compared=others)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):  # the result is safe by now
            print_study(result, others)
    return written(result.outcome, result.sentence, target, documents, as_json=as_json, quiet=quiet)
