"""`thermobearing lambda`: temperature factors of a bearing."""

import re
from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    NO_DOCUMENTS,
    AsJson,
    Documents,
    Force,
    NoFigures,
    Output,
    Quiet,
    announce_compiling,
    reported,
    written,
)

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
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Temperature factors from the coupled model: K_eq, Q_d, K_d, h_eq, energy; and bounds."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.design.factors import STRAINS, TEMPERATURES
    from thermobearing.design.run import run_factors
    from thermobearing.design.screen import print_factors
    from thermobearing.identify.samples import posterior_bearings
    from thermobearing.results.directory import check_target

    if period is not None and speed is not None:
        raise InputError("give --period or --speed, not both")
    bearings = [load_bearing(name) for name in bearing]
    if posterior is not None:
        if len(bearings) > 1:
            raise InputError("--posterior goes with one bearing, the fitted one")
        bearings = posterior_bearings(bearings[0], posterior, samples)
    target = output or Path(f"lambda-{bearings[0].name}")
    check_target(target, force=force)
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
    report.save(target, force=force, figures=not no_figures)
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
