"""Design, property bounds and temperature factors."""

import re
from pathlib import Path
from typing import Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    NO_DOCUMENTS,
    STRUCTURES,
    AsJson,
    Documents,
    FixedBase,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    announce_compiling,
    reported,
    written,
)

Structure_ = Annotated[
    str | None, typer.Option("--structure", help="Name or TOML file.", metavar="NAME/FILE")
]
Motions = Annotated[
    list[str] | None,
    typer.Option("--motion", help="Name or file; may be repeated.", metavar="NAME/FILE"),
]
JudgedAt = Annotated[
    list[float] | None,
    typer.Option(help="Layered ones judged at [degC]."),
]
Peaks = Annotated[
    str | None, typer.Option(help="Of several motions: mean (of three or more), or largest.")
]
Groups = Annotated[
    list[str] | None,
    typer.Option(
        "--group",
        help="Bearing lines of one size, with commas; may be repeated.",
        metavar="LINE,LINE",
    ),
]


@reported
def design(
    case: Annotated[
        Path | None, typer.Argument(help="Case file; without one, the bridge of section 6.2.")
    ] = None,
    start: Annotated[float | None, typer.Option(help="First displacement u_B [mm].")] = None,
    compound: Annotated[str | None, typer.Option(help="G8, G10 or G12.")] = None,
    kind: Annotated[
        str | None, typer.Option("--compound-kind", "--kind", help="HDR or HDR-S.")
    ] = None,
    motion: Motions = None,
    weight: Annotated[float | None, typer.Option(help="Load of one bearing [kN].")] = None,
    structure: Structure_ = None,
    group: Groups = None,
    ambient: JudgedAt = None,
    peaks: Peaks = None,
    tolerance: Annotated[
        float | None, typer.Option(help="Of found over assumed displacement, up to 0.1.")
    ] = None,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Size isolation bearings: assume a displacement, size, analyse, compare, repeat."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.design.case import load_design_case, make_design_case
    from thermobearing.design.output import print_design, print_head, print_round
    from thermobearing.design.run import run_design
    from thermobearing.results.directory import check_target

    groups = [{"lines": [name.strip() for name in text.split(",")]} for text in group or []]
    overrides: dict[str, Any] = {
        "line_groups": groups or None,
        "start": start,
        "compound": compound,
        "compound_kind": kind,
        "motions": motion or None,
        "weight": weight,
        "structure": structure,
        "ambient": ambient or None,
        "peaks": peaks,
        "tolerance": tolerance,
    }
    if case is None:
        complete = make_design_case({}, "command line", **overrides)
    else:
        complete = load_design_case(case, **overrides)
    templates = [load_bearing(name) for name in complete.equal]
    target = output or Path("design")
    check_target(target, overwrite=overwrite)
    announce_compiling(quiet, STRUCTURES)
    if not quiet:
        print_head(complete)
    found = run_design(complete, None if quiet else print_round, templates=templates)
    found.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        print_design(found)
    outcome = "completed" if found.usable else found.outcome
    return written(outcome, found.sentence, target, documents, as_json=as_json, quiet=quiet)


@reported
def bounds(
    bearing: Annotated[
        list[str] | None,
        typer.Option("--bearing", help="Layered; may be repeated.", metavar="NAME/FILE"),
    ] = None,
    motion: Motions = None,
    ambient: Annotated[
        list[float] | None,
        typer.Option("--ambient", help="Temperatures of the coupled model [degC]."),
    ] = None,
    structure: Structure_ = None,
    fixed_base: FixedBase = False,
    strain: Annotated[float, typer.Option(help="Of the bilinear models.")] = 1.75,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Is a bounding analysis good enough? Two bilinear bounds against the coupled model."""
    from thermobearing.design.bounds import AIR, BEARINGS
    from thermobearing.design.output import print_bounds
    from thermobearing.design.run import run_bounds
    from thermobearing.results.directory import check_target

    target = output or Path("bounds")
    check_target(target, overwrite=overwrite)
    announce_compiling(quiet, STRUCTURES)
    on = {"structure": structure, "fixed_base": fixed_base or None}
    report = run_bounds(bearing or BEARINGS, motion, ambient or AIR, strain=strain, **on)
    report.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        print_bounds(report)
    return written(report.outcome, report.sentence, target, documents, as_json=as_json, quiet=quiet)


Reference = Annotated[
    float | None,
    typer.Option(
        "--reference-temperature",
        "--reference",
        help="Reference [degC]; that of the bearing's rubber by default.",
    ),
]
Temperatures = Annotated[
    list[float] | None,
    typer.Option(help="Ambient [degC]; may be repeated; -40 to 40 in steps of 10."),
]
Posterior = Annotated[
    Path | None,
    typer.Option(help="posterior.csv of identify: a band of its samples.", metavar="FILE"),
]
Speed = Annotated[float | None, typer.Option(help="Mean speed [mm/s] instead of the period.")]


@reported
def lambda_(
    bearing: Annotated[
        list[str],
        typer.Argument(help="Name or TOML file; several (a posterior) make bands."),
    ],
    reference: Reference = None,
    temperature: Temperatures = None,
    strain: Annotated[
        list[float] | None, typer.Option(help="May be repeated; 1 and 1.75 by default.")
    ] = None,
    period: Annotated[float | None, typer.Option(help="Of the sine [s]; 2 by default.")] = None,
    speed: Speed = None,
    cycles: Annotated[str, typer.Option(help="3, 1-3, 2-11, all-but-first, or as 2,3,4.")] = "1-3",
    posterior: Posterior = None,
    samples: Annotated[int, typer.Option(help="Of the posterior, evenly through it.")] = 20,
    scale: Annotated[bool, typer.Option("--scale", help="Add sizes 1/6 and 1.")] = False,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Temperature factors from the coupled model: K_eq, Q_d, K_d, h_eq, energy; and bounds."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.design.factors import STRAINS, TEMPERATURES
    from thermobearing.design.output import print_factors
    from thermobearing.design.run import run_factors
    from thermobearing.identify.uncertainty.samples import posterior_bearings
    from thermobearing.results.directory import check_target

    if period is not None and speed is not None:
        raise InputError("give --period or --speed, not both")
    bearings = [load_bearing(name) for name in bearing]
    if posterior is not None:
        if len(bearings) > 1:
            raise InputError("--posterior goes with one bearing, the fitted one")
        bearings = posterior_bearings(bearings[0], posterior, samples)
    target = output or Path(f"lambda-{bearings[0].name}")
    check_target(target, overwrite=overwrite)
    announce_compiling(quiet)
    report = run_factors(
        bearings,
        reference=reference,
        temperatures=temperature or TEMPERATURES,
        strains=strain or STRAINS,
        period=period,
        speed=speed,
        cycles=_cycles(cycles),
        scale=scale,
    )
    report.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        print_factors(report)
    return written("completed", "", target, documents, as_json=as_json, quiet=quiet)


def _cycles(text: str) -> str | list[int]:
    """A preset, or numbers between commas."""
    from thermobearing.design.factors import PRESETS

    parts = [part.strip() for part in text.split(",")]
    if text in PRESETS or not all(re.fullmatch("[0-9]{1,9}", part) for part in parts):
        return text
    return [int(part) for part in text.split(",")]
