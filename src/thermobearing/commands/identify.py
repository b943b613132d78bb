"""`thermobearing identify`: parameters of a bearing from its tests, or a look at the tests."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    BAD_INPUT,
    INPUT,
    SEARCH,
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    announce_compiling,
    echo_json,
    numbers_by_name,
    reported,
    written,
)

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing
    from thermobearing.identify.checks import CheckReport
    from thermobearing.identify.record import TestRecord


Spreads = Annotated[
    list[str] | None,
    typer.Option(
        help="Relative standard uncertainty of what is not free, such as "
        "materials.side_film=0.1 or sigma_Y=0; may be repeated.",
        metavar="KEY=NUMBER",
        rich_help_panel=INPUT,
    ),
]
Predicted = Annotated[
    list[float] | None,
    typer.Option(help="Ambient temperature [degC] to predict a band at; may be repeated."),
]


@reported
def identify(
    tests: Annotated[list[Path], typer.Argument(help="Tests: CSV files or their TOML sidecars.")],
    start: Annotated[
        str | None,
        typer.Option(
            "--bearing",
            "--start",
            help="Geometry, fixed values.",
            metavar="NAME/FILE",
            rich_help_panel=INPUT,
        ),
    ] = None,
    free: Annotated[
        str | None,
        typer.Option(
            help="Free parameters, such as K_r,d_y or n_T=2.4*m_T.", rich_help_panel=INPUT
        ),
    ] = None,
    assumed: Spreads = None,
    method: Annotated[
        str,
        typer.Option(
            help="least-squares, krill-herd or differential-evolution.", rich_help_panel=SEARCH
        ),
    ] = "least-squares",
    polish: Annotated[
        bool,
        typer.Option(
            "--polish/--no-polish", help="End with least squares.", rich_help_panel=SEARCH
        ),
    ] = True,
    seed: Annotated[int, typer.Option(help="Of all random numbers.", rich_help_panel=SEARCH)] = 0,
    starts: Annotated[
        int, typer.Option(help="Starts of least squares.", rich_help_panel=SEARCH)
    ] = 3,
    evaluations: Annotated[
        int, typer.Option(help="Budget of the other methods.", rich_help_panel=SEARCH)
    ] = 2000,
    loss: Annotated[
        str, typer.Option(help="linear, soft_l1, huber or cauchy.", rich_help_panel=SEARCH)
    ] = "linear",
    temperatures: Annotated[
        bool,
        typer.Option("--temperatures", help="Fit the thermocouples too.", rich_help_panel=INPUT),
    ] = False,
    from_start: Annotated[
        bool,
        typer.Option(
            "--from-start", help="Begin at the bearing's own values.", rich_help_panel=INPUT
        ),
    ] = False,
    check: Annotated[bool, typer.Option("--check", help="Only look the tests over.")] = False,
    posterior: Annotated[
        bool, typer.Option("--posterior", help="Sample the posterior (needs emcee).")
    ] = False,
    predict: Predicted = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Identify a bearing's parameters from cyclic tests, with their uncertainty."""
    from thermobearing.identify.case import make_identify_case
    from thermobearing.identify.posterior import forecast
    from thermobearing.identify.run import run_identify
    from thermobearing.identify.screen import print_identification

    records, bearing, target = _read(tests, start, check, output, force)
    if check or bearing is None:
        return _look_over(records, bearing, target, force, no_figures, as_json, quiet)
    names = [name.strip() for name in free.split(",")] if free is not None else None
    announce_compiling(quiet)
    search = {"method": method, "seed": seed, "starts": starts, "evaluations": evaluations}
    how: dict[str, Any] = {
        **{"loss": loss, "temperatures": temperatures, "blind": not from_start},
        "polish": polish,
        "assumed": numbers_by_name(assumed or [], "--assumed", "KEY=NUMBER, such as sigma_Y=0.1"),
    }
    found = run_identify(make_identify_case(records, bearing, free=names, **search, **how))
    drawn = None
    if posterior or predict:
        drawn = forecast(found, predict or [], posterior=posterior, seed=seed)
    found.save(target, force=force, figures=not no_figures, forecast=drawn)
    if not quiet:
        print_identification(found)
    return written(found.outcome, found.sentence, target, as_json=as_json, quiet=quiet)


def _read(
    tests: list[Path], start: str | None, check: bool, output: Path | None, force: bool
) -> "tuple[list[TestRecord], Bearing | None, Path]":
    """Tests, their bearing, and where the result goes, which is free to be written."""
    from thermobearing.identify.case import bearing_of
    from thermobearing.identify.record import load_test
    from thermobearing.results.directory import check_target

    records = [load_test(path) for path in tests]
    bearing = bearing_of(records, start)
    if bearing is None and not check:
        raise InputError(
            "which bearing? give --bearing NAME/FILE, or bearing = ... in the sidecar: a fit needs "
            "its geometry and materials (thermobearing list names the built-in ones)"
        )
    kind = "check" if check else "identify"
    target = output or Path(f"{kind}-" + re.sub(r"[^\w.+-]+", "-", records[0].name))
    check_target(target, force=force)
    return records, bearing, target


def _look_over(
    records: "list[TestRecord]",
    bearing: "Bearing | None",
    target: Path,
    force: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """The findings of the tests, without a fit."""
    from thermobearing.identify.checks import check_test
    from thermobearing.identify.files import save_checks
    from thermobearing.identify.screen import print_checks

    reports = [check_test(record, bearing) for record in records]
    save_checks(reports, target, force=force, figures=not no_figures)
    if not quiet:
        print_checks(reports)
        typer.echo(f"written: {target}")
    return _checked(reports, target, as_json)


def _checked(reports: "list[CheckReport]", target: Path, as_json: bool) -> int:
    """How a look at tests ends: status 2 if one of them cannot be used."""
    refused = any(report.outcome == "refused" for report in reports)
    status = BAD_INPUT if refused else 0
    if as_json:
        outcomes = {report.record.name: report.outcome for report in reports}
        echo_json({"outcome": outcomes, "exit_status": status, "output": str(target)})
    return status
