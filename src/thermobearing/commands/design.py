"""Design, property bounds and temperature factors."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    OFFICE,
    STRUCTURES,
    Answer,
    Ending,
    announce_compiling,
    app,
)
from thermobearing.commands.earthquake import FIXED_BASE
from thermobearing.commands.options import command, fields, option

if TYPE_CHECKING:
    from thermobearing.design.sizing import Round


@command(
    app,
    "design",
    fields(
        "earthquake.case:EarthquakeCase",
        "structure motions",
        motions="--motion|Ground motion: library name or file.",
    ),
    fields(
        "design.case:DesignCase",
        "start compound compound_kind weight ambient peaks tolerance",
        compound_kind="--compound-kind --kind",
    ),
    examples="design --motion jra-ii-i-1 --compound G10 -o design",
    panel=OFFICE,
    laws=True,
)
def _design(
    case: Annotated[
        Path | None,
        typer.Argument(help="Case file; by default the bridge of section 6.2 of Shen (2023)."),
    ],
    options: dict[str, Any],
    line_groups: Annotated[
        list[str] | None,
        option(
            "--group",
            help="Bearing lines of equal size, separated by commas. May be repeated.",
            metavar="LINE,LINE",
        ),
    ],
    end: Ending,
) -> Answer:
    """Size isolation bearings: assume a displacement, size, analyse, compare, and repeat."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.design.case import load_design_case, make_design_case
    from thermobearing.design.run import run_design

    groups = [{"lines": [name.strip() for name in text.split(",")]} for text in line_groups or []]
    options["line_groups"] = groups or None
    if case is None:
        complete = make_design_case({}, "command line", **options)
    else:
        complete = load_design_case(case, **options)
    templates = [load_bearing(name) for name in complete.equal]
    target = end.target("design")
    announce_compiling(end.quiet, STRUCTURES)
    result = run_design(complete, None if end.quiet else _print_round, templates=templates)
    # The result keeps its own outcome; the exit status says only whether there is a design.
    outcome = "completed" if result.usable else result.outcome
    return end.save(result, target, outcome=outcome)


def _print_round(turn: "Round") -> None:
    """Print the displacements of a round while the design runs."""
    of_group = f" of {turn.group}" if turn.group else ""
    print(
        f"round {turn.number}{of_group}: assumed {turn.assumed:.0f} mm, found {turn.found:.0f} mm"
    )


@command(
    app,
    "bounds",
    fields(
        "earthquake.case:EarthquakeCase",
        "bearings motions structure",
        bearings="--bearing|Bearing: library name or TOML file.",
        motions="--motion|Ground motion: library name or file.",
    ),
    fields("design.bounds:bounds_study", "ambient strain"),
    examples="bounds --bearing shen-hdr-bridge --ambient -20",
    panel=OFFICE,
    laws=True,
)
def _bounds(options: dict[str, Any], fixed_base: FIXED_BASE, end: Ending) -> Answer:
    """Compare a bounds analysis (two bilinear models) with the coupled model."""
    from thermobearing.design.bounds import BEARINGS
    from thermobearing.design.run import run_bounds

    target = end.target("bounds")
    announce_compiling(end.quiet, STRUCTURES)
    bearings, motions = options.pop("bearings", BEARINGS), options.pop("motions", None)
    report = run_bounds(bearings, motions, fixed_base=fixed_base or None, **options)
    return end.save(report, target)


@command(
    app,
    "lambda",
    fields(
        "design.run:run_factors",
        "reference temperatures strains period speed weather return_period state",
        temperatures="--temperature",
        strains="--strain",
        reference="--reference-temperature --reference",
    ),
    fields("tables.conditioning:Conditioning", "conditioned before"),
    examples="lambda shen-hdr-bridge --strain 1.75 -o factors",
    panel=OFFICE,
    laws=True,
    twin="factors",
)
def _lambda(
    bearing: Annotated[
        list[str],
        typer.Argument(
            help="Library name or TOML file; several bearings (of a posterior) give bands."
        ),
    ],
    options: dict[str, Any],
    posterior: Annotated[
        Path | None,
        option(help="File posterior.csv of `identify`, whose samples give a band.", metavar="FILE"),
    ],
    scale: Annotated[
        bool, option("--scale", help="Also compute the factors at scales of 1/6 and 1.")
    ],
    end: Ending,
    cycles: Annotated[
        str,
        option(
            help="Cycles to average: 3, 1-3, 2-11, all-but-first, or a list such as 2,3,4. The "
            "first cycle, too, contains the heating within it."
        ),
    ] = "1-3",
    samples: Annotated[int, option(help="Number of samples taken from the posterior.")] = 400,
) -> Answer:
    """Compute temperature factors of K_eq, Q_d, K_d, h_eq and energy, and their bounds."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.cyclic.case import InitialState
    from thermobearing.design.factors import PRESETS
    from thermobearing.design.run import run_factors
    from thermobearing.identify.uncertainty.samples import posterior_bearings
    from thermobearing.tables.conditioning import Conditioning

    if "period" in options and "speed" in options:
        raise InputError("give --period or --speed, not both")
    bearings = [load_bearing(name) for name in bearing]
    if posterior is not None:
        if len(bearings) > 1:
            raise InputError("--posterior needs exactly one bearing, the calibrated one")
        bearings = posterior_bearings(bearings[0], posterior, samples)
    target = end.target(f"lambda-{bearings[0].name}")
    announce_compiling(end.quiet)
    numbers = [part.strip() for part in cycles.split(",")]
    listed = cycles not in PRESETS and all(re.fullmatch("[0-9]{1,9}", part) for part in numbers)
    selected = [int(part) for part in numbers] if listed else cycles
    conditioning = {key: options.pop(key) for key in Conditioning.model_fields if key in options}
    if conditioning:
        options["initial"] = InitialState(conditioning=conditioning)
    report = run_factors(bearings, cycles=selected, scale=scale, **options)
    return end.save(report, target)
