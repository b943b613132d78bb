"""Calibrate bearings to tests, and validate them."""

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError, printable
from thermobearing.commands.common import (
    BAD_INPUT,
    INPUT,
    NO_DOCUMENTS,
    SEARCH,
    AsJson,
    Documents,
    Limit,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    announce_compiling,
    echo_json,
    limit_numbers,
    numbers_by_name,
    reported,
    with_progress,
    written,
)

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing
    from thermobearing.identify.records.checks import CheckReport
    from thermobearing.identify.records.record import TestRecord
    from thermobearing.identify.result import Identification
    from thermobearing.identify.uncertainty.posterior import Forecast
    from thermobearing.validate.hold_out import CrossValidation

Spreads = Annotated[
    list[str] | None,
    typer.Option(
        help="Relative standard uncertainty of what is not free, such as "
        "materials.side_film=0.1 or sigma_Y=0; may be repeated.",
        metavar="KEY=NUMBER",
        rich_help_panel=INPUT,
    ),
]
AmbientUncertainty = Annotated[
    float | None,
    typer.Option(
        help="Standard uncertainty of the ambient temperature of every test [K]; 0.5 by default.",
        metavar="KELVIN",
        rich_help_panel=INPUT,
    ),
]
Method = Annotated[
    str,
    typer.Option(
        help="least-squares, krill-herd or differential-evolution.", rich_help_panel=SEARCH
    ),
]
Polish = Annotated[
    bool,
    typer.Option("--polish/--no-polish", help="End with least squares.", rich_help_panel=SEARCH),
]
Starts = Annotated[int, typer.Option(help="Starts of least squares.", rich_help_panel=SEARCH)]
Evaluations = Annotated[
    int, typer.Option(help="Budget of the other methods.", rich_help_panel=SEARCH)
]
Loss = Annotated[
    str, typer.Option(help="linear, soft_l1, huber or cauchy.", rich_help_panel=SEARCH)
]
Thermocouples = Annotated[
    bool,
    typer.Option("--temperatures", help="Fit the thermocouples too.", rich_help_panel=INPUT),
]
FromStart = Annotated[
    bool,
    typer.Option("--from-start", help="Begin at the bearing's own values.", rich_help_panel=INPUT),
]
Sampled = Annotated[bool, typer.Option("--posterior", help="Sample the posterior (needs emcee).")]
Predicted = Annotated[
    list[float] | None,
    typer.Option(help="Ambient temperature [degC] to predict a band at; may be repeated."),
]
Despike = Annotated[
    bool, typer.Option("--despike", help="Take spikes out of all tests before the fit.")
]
Detrend = Annotated[
    str,
    typer.Option(
        help="Take the drift of zero out of all tests: of force, displacement or both.",
        metavar="SIGNAL",
    ),
]
AcceptPoor = Annotated[
    bool,
    typer.Option("--accept-poor", help="Write the bearing of a poor fit (status 4) unmarked."),
]
OneTemperature = Annotated[
    bool,
    typer.Option(
        help="Free m_T and n_T of --free though all tests are at one temperature.",
        rich_help_panel=INPUT,
    ),
]
HeldOut = Annotated[
    list[Path] | None,
    typer.Option(help="Test to judge the fit by, not fitted; may be repeated.", metavar="FILE"),
]
Folds = Annotated[
    int | None,
    typer.Option(help="Hold every test out once, in so many groups; then fit to all of them."),
]
Start = Annotated[
    str | None,
    typer.Option(
        "--bearing",
        "--start",
        help="Geometry, fixed values.",
        metavar="NAME/FILE",
        rich_help_panel=INPUT,
    ),
]
Free = Annotated[
    str | None,
    typer.Option(help="Free parameters, such as K_r,d_y or n_T=2.4*m_T.", rich_help_panel=INPUT),
]


@reported
def identify(
    tests: Annotated[list[Path], typer.Argument(help="Tests: CSV files or their TOML sidecars.")],
    start: Start = None,
    free: Free = None,
    assumed: Spreads = None,
    ambient_uncertainty: AmbientUncertainty = None,
    method: Method = "least-squares",
    polish: Polish = True,
    seed: Annotated[int, typer.Option(help="Of all random numbers.", rich_help_panel=SEARCH)] = 0,
    starts: Starts = 3,
    evaluations: Evaluations = 2000,
    loss: Loss = "linear",
    temperatures: Thermocouples = False,
    from_start: FromStart = False,
    check: Annotated[
        bool, typer.Option("--check", help="Only look the tests over; written with -o.")
    ] = False,
    posterior: Sampled = False,
    predict: Predicted = None,
    hold_out: HeldOut = None,
    folds: Folds = None,
    limit: Limit = None,
    despike: Despike = False,
    detrend: Detrend = "",
    accept_poor: AcceptPoor = False,
    one_temperature: OneTemperature = False,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Identify a bearing's parameters from cyclic tests, with their uncertainty."""
    from thermobearing.identify.records.treatment import to_be_treated
    from thermobearing.identify.uncertainty.posterior import need_emcee

    records, bearing, target = _read([*tests, *(hold_out or [])], start, check, output, overwrite)
    records = to_be_treated(records, despike, detrend, ambient_uncertainty)
    if check or bearing is None or target is None:
        how = (overwrite, no_figures, as_json, quiet, documents)
        return _look_over(records, bearing, target, *how)
    if posterior:
        need_emcee()
    announce_compiling(quiet)
    fit: dict[str, Any] = {
        "free": [name.strip() for name in free.split(",")] if free is not None else None,
        **{"method": method, "seed": seed, "starts": starts, "evaluations": evaluations},
        **{"loss": loss, "temperatures": temperatures, "blind": not from_start, "polish": polish},
        **{"accept_poor": accept_poor, "one_temperature": one_temperature},
        "assumed": numbers_by_name(assumed or [], "--assumed", "KEY=NUMBER, such as sigma_Y=0.1"),
    }
    if hold_out or folds is not None or limit:
        fit |= {"hold_out": records[len(tests) :], "folds": folds, "limits": limit_numbers(limit)}
    found = _found(records[: len(tests)], bearing, fit, quiet)
    drawn = _drawn(found, posterior, predict, seed, quiet) if posterior or predict else None
    found.save(target, overwrite=overwrite, figures=not no_figures, forecast=drawn)
    if not quiet:
        _show(found, drawn)
    return written(found.outcome, found.sentence, target, documents, as_json=as_json, quiet=quiet)


def _drawn(
    found: "Identification | CrossValidation",
    posterior: bool,
    predict: list[float] | None,
    seed: int,
    quiet: bool,
) -> "Forecast":
    """Posterior and predictions of a fit, announced first."""
    from thermobearing.identify.result import Identification
    from thermobearing.identify.uncertainty.posterior import forecast

    final = found if isinstance(found, Identification) else found.final
    if posterior and not quiet:
        _announce_posterior(final)
    return forecast(final, predict or [], posterior=posterior, seed=seed)


def _announce_posterior(found: "Identification") -> None:
    """Before the posterior is sampled: how many runs that takes, and about how long."""
    from thermobearing.identify.uncertainty.posterior import posterior_effort
    from thermobearing.results.time_axis import duration

    runs, seconds = posterior_effort(found)
    tests = "1 test" if len(found.records) == 1 else f"{len(found.records)} tests"
    typer.echo(
        f"posterior: up to {runs} runs of the model through {tests}, about {duration(seconds)}",
        err=True,
    )


def _found(
    records: "list[TestRecord]", bearing: "Bearing", how: dict[str, Any], quiet: bool
) -> "Identification | CrossValidation":
    """A fit to all tests, or one that is judged by those held out."""
    from thermobearing.identify.case import make_identify_case
    from thermobearing.identify.run import run_identify
    from thermobearing.validate.hold_out import make_hold_out_case, run_hold_out

    if "hold_out" not in how:
        return run_identify(make_identify_case(records, bearing, **how))
    case = make_hold_out_case(records, bearing, **how)
    return with_progress(lambda show: run_hold_out(case, progress=show), "fits", quiet)


def _show(found: "Identification | CrossValidation", drawn: "Forecast | None") -> None:
    from thermobearing.identify.result import Identification
    from thermobearing.validate.output import print_cross_validation

    if isinstance(found, Identification):
        replace(found, forecast=drawn).show()
    else:
        print_cross_validation(found, drawn)


def _read(
    tests: list[Path], start: str | None, check: bool, output: Path | None, overwrite: bool
) -> "tuple[list[TestRecord], Bearing | None, Path | None]":
    """Tests, their bearing, and where the result goes, which is free to be written.

    A look at tests writes nothing unless it is told where.
    """
    from thermobearing.identify.case import bearing_of
    from thermobearing.identify.records.record import load_test
    from thermobearing.results.directory import check_target

    records = [load_test(path) for path in tests]
    bearing = bearing_of(records, start)
    if bearing is None and not check:
        raise InputError(
            "which bearing? give --bearing NAME/FILE, or bearing = ... in the sidecar: a fit needs "
            "its geometry and materials (thermobearing list names the built-in ones)"
        )
    target = output
    if target is None and not check:
        target = Path("identify-" + re.sub(r"[^\w.+-]+", "-", records[0].name))
    if target is not None:
        check_target(target, overwrite=overwrite)
    return records, bearing, target


def _look_over(
    records: "list[TestRecord]",
    bearing: "Bearing | None",
    target: Path | None,
    overwrite: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
    documents: Documents,
) -> int:
    """The findings of the tests, without a fit."""
    from thermobearing.identify.output import print_checks, save_checks
    from thermobearing.identify.records.checks import check_test

    if target is None and (documents.report or documents.workbook):
        raise InputError("a look at tests is written where -o says: give -o DIR with --report")
    reports = [check_test(record, bearing) for record in records]
    made: list[Path] = []
    if target is not None:
        save_checks(reports, target, overwrite=overwrite, figures=not no_figures)
        made = documents.write(target)
    if not quiet:
        print_checks(reports)
        if target is not None:
            where = printable(str(target))
            typer.echo(", ".join([f"written: {where}", *(file.name for file in made)]))
    return _checked(reports, target, as_json)


def _checked(reports: "list[CheckReport]", target: Path | None, as_json: bool) -> int:
    """How a look at tests ends: status 2 if one of them cannot be used."""
    refused = any(report.outcome == "refused" for report in reports)
    status = BAD_INPUT if refused else 0
    if as_json:
        outcomes = {report.record.name: report.outcome for report in reports}
        told = {"outcome": outcomes, "exit_status": status}
        echo_json(told if target is None else told | {"output": str(target)})
    return status


@reported
def validate(
    bearing: Annotated[str, typer.Argument(help="Bearing: a name or a TOML file.")],
    tests: Annotated[list[Path], typer.Argument(help="Tests: CSV files or their TOML sidecars.")],
    beside: Annotated[
        list[str] | None,
        typer.Option(help="Another bearing beside it; may be repeated.", metavar="NAME/FILE"),
    ] = None,
    model: Annotated[
        list[str] | None,
        typer.Option(help="multi-layer (default) or an earlier model; may be repeated."),
    ] = None,
    limit: Limit = None,
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Judge a bearing by tests it was not fitted to; nothing is fitted."""
    from thermobearing.results.directory import check_target
    from thermobearing.validate.case import make_validate_case
    from thermobearing.validate.output import print_validation
    from thermobearing.validate.run import run_validate

    case = make_validate_case(
        [bearing, *(beside or [])],
        tests,
        models=model or ["multi-layer"],  # type: ignore[arg-type]
        limits=limit_numbers(limit),
    )
    target = output or Path("validate-" + re.sub(r"[^\w.+-]+", "-", case.bearings[0].name))
    check_target(target, overwrite=overwrite)
    announce_compiling(quiet)
    found = run_validate(case)
    found.save(target, overwrite=overwrite, figures=not no_figures)
    if not quiet:
        print_validation(found)
    return written(found.outcome, found.sentence, target, documents, as_json=as_json, quiet=quiet)
