"""Calibrate bearings to tests, and validate them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    BAD_INPUT,
    INPUT,
    LABORATORY,
    RESULT,
    SEARCH,
    Answer,
    Ending,
    announce_compiling,
    app,
    echo_written,
    values_by_name,
    with_progress,
)
from thermobearing.commands.options import command, fields, option

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing
    from thermobearing.identify.records.record import TestRecord
    from thermobearing.identify.result import Identification
    from thermobearing.validate.result import CrossValidation

TESTS = Annotated[list[Path], typer.Argument(help="Tests: CSV files or their TOML sidecars.")]
LIMITS = Annotated[
    list[str] | None,
    option(
        "--limit",
        help="Largest relative error of K_eq, h_eq (0.15 each by default), energy, force, "
        "temperature or NRMSE in a validation test. May be repeated.",
        metavar="QUANTITY=NUMBER",
    ),
]
FOR_QUOFEM = Annotated[
    bool, option("--quofem", help="Also write a quoFEM folder, DIR/quofem.", panel=RESULT)
]
FIT_OPTIONS = (
    fields(
        "identify.case:find_bearing",
        "start",
        INPUT,
        start="--bearing --start||NAME/FILE",
    ),
    fields(
        "identify.case:IdentifyCase",
        "free assumed one_temperature temperatures start_from",
        INPUT,
        free="||KEY,KEY",
        assumed="||KEY=NUMBER",
    ),
    fields(
        "identify.records.treatment:request_treatment",
        "ambient_uncertainty despike detrend",
        INPUT,
        ambient_uncertainty="||KELVIN",
        detrend="||SIGNAL",
    ),
    fields("identify.case:IdentifyCase", "polish seed starts loss", SEARCH),
    fields(
        "identify.uncertainty.posterior:forecast",
        "posterior predict",
        posterior="|Sample the posterior distribution (requires emcee).",
        predict="|Ambient temperature [degC] at which a prediction band is computed.",
    ),
    fields(
        "validate.run:cross_validate",
        "hold_out folds",
        hold_out="|Test that is used for validation only.|FILE",
        folds="|Number of groups for cross-validation; the final calibration uses all tests.",
    ),
    fields("identify.case:IdentifyCase", "accept_poor"),
)


@command(
    app,
    "identify",
    *FIT_OPTIONS,
    examples="identify cold.csv warm.csv --bearing mine.toml -o fit",
    panel=LABORATORY,
    laws=True,
)
def _identify(
    tests: TESTS,
    options: dict[str, Any],
    check: Annotated[bool, option("--check", help="Check the tests without calibrating.")],
    quofem: FOR_QUOFEM,
    limit: LIMITS,
    end: Ending,
) -> Answer:
    """Calibrate the parameters of a bearing to cyclic tests, with their uncertainty."""
    from thermobearing.identify.case import find_bearing
    from thermobearing.identify.records.record import load_test
    from thermobearing.identify.records.treatment import request_treatment
    from thermobearing.identify.uncertainty.posterior import need_emcee

    records = [load_test(path) for path in [*tests, *options.pop("hold_out", [])]]
    bearing = find_bearing(records, options.pop("start", None))
    names = ("despike", "detrend", "ambient_uncertainty")
    treatment: dict[str, Any] = {name: options.pop(name) for name in names if name in options}
    if check:  # writes nothing without an output directory
        if end.output is not None:
            end.target()
        return _check_tests(request_treatment(records, **treatment), bearing, end)
    if bearing is None:
        raise InputError(
            "no bearing is given: a calibration needs its geometry and materials; use --bearing "
            "NAME/FILE, or the key bearing of the sidecar (`thermobearing list` names the library)"
        )
    target = end.target(f"identify-{records[0].name}")
    records = request_treatment(records, **treatment)
    sampled, predicted = options.pop("posterior", False), options.pop("predict", [])
    if sampled:
        need_emcee()
    announce_compiling(end.quiet)
    form = "KEY=NUMBER, such as sigma_Y=0.1"
    assumed = values_by_name(options.pop("assumed", []), "--assumed", form)
    options["assumed"] = assumed
    if "free" in options:
        options["free"] = [name.strip() for name in ",".join(options["free"]).split(",")]
    # Any of these asks for a validation; without them it is one calibration.
    if len(records) > len(tests) or "folds" in options or limit:
        options |= {"hold_out": records[len(tests) :], "limits": _limits(limit)}
    result = _fit(records[: len(tests)], bearing, options, end)
    if sampled or predicted:
        seed = options.get("seed", 0)
        result = result.with_forecast(_forecast(result, sampled, predicted, seed, end.quiet))
    answer = end.save(result, target)
    if quofem:
        from thermobearing.identify.quofem import write_quofem
        from thermobearing.results.directory import QUOFEM

        folder = write_quofem(_final(result), target / QUOFEM)
        if not end.quiet:
            echo_written(folder)
    return answer


def _fit(
    records: "list[TestRecord]", bearing: "Bearing", options: dict[str, Any], end: Ending
) -> "Identification | CrossValidation":
    """Return a fit to all tests, or one that is validated with those held out."""
    from thermobearing.identify.case import make_identify_case
    from thermobearing.identify.run import run_identify
    from thermobearing.validate.run import cross_validate

    if "hold_out" not in options:
        return run_identify(make_identify_case(records, bearing, **options))
    return with_progress(
        lambda show: cross_validate(records, bearing, progress=show, **options), "fits", end.quiet
    )


def _forecast(
    result: "Identification | CrossValidation",
    posterior: bool,
    predict: list[float],
    seed: int,
    quiet: bool,
) -> Any:
    """Return posterior and predictions of a fit; the runs that it takes are announced first."""
    from thermobearing.identify.uncertainty.posterior import forecast, posterior_effort
    from thermobearing.results.time_axis import duration

    final = _final(result)
    if posterior and not quiet:
        runs, seconds = posterior_effort(final)
        tests = "1 test" if len(final.records) == 1 else f"{len(final.records)} tests"
        effort = f"up to {runs} runs of the model through {tests}, about {duration(seconds)}"
        typer.echo(f"posterior: {effort}", err=True)
    return forecast(final, predict, posterior=posterior, seed=seed)


def _final(result: "Identification | CrossValidation") -> "Identification":
    """Return the calibration, of a cross-validation the one to all tests that are not held out."""
    from thermobearing.validate.result import CrossValidation

    return result.final if isinstance(result, CrossValidation) else result


def _limits(words: list[str] | None) -> dict[str, float]:
    return values_by_name(words, "--limit", "QUANTITY=NUMBER, such as K_eq=0.1")


def _check_tests(records: "list[TestRecord]", bearing: "Bearing | None", end: Ending) -> Answer:
    """Print the findings of the tests, without a fit; status 2 if one of them cannot be used."""
    from thermobearing.identify.records.checks import check_test, print_checks, save_checks

    target = end.output
    if target is None and end.with_report:
        raise InputError(
            "the report of a check is written into a result directory: give it with -o"
        )
    reports = [check_test(record, bearing) for record in records]
    documents: list[Path] = []
    if target is not None:
        save_checks(reports, target, overwrite=end.overwrite, figures=end.figures)
        documents = end.documents(target)
    if not end.quiet:
        print_checks(reports)
        if target is not None:
            echo_written(target, "".join(f", {file.name}" for file in documents))
    status = BAD_INPUT if any(report.outcome == "refused" for report in reports) else 0
    outcomes = {report.record.name: report.outcome for report in reports}
    last: Answer = {"outcome": outcomes, "exit_status": status}
    return last if target is None else last | {"output": str(target)}


@command(
    app,
    "validate",
    examples="validate mine.toml other-test.csv --limit energy=0.2",
    panel=LABORATORY,
    laws=True,
)
def _validate(
    bearing: Annotated[str, typer.Argument(help="Bearing: library name or TOML file.")],
    tests: TESTS,
    compare_with: Annotated[
        list[str] | None,
        option(
            "--compare-with",
            help="Another bearing for comparison. May be repeated.",
            metavar="NAME/FILE",
        ),
    ],
    model: Annotated[
        list[str] | None,
        option(help="Model: multi-layer (default) or an earlier one. May be repeated."),
    ],
    limit: LIMITS,
    end: Ending,
) -> Answer:
    """Validate a bearing with tests that were not used in its calibration."""
    from thermobearing.bearing.library import as_bearing
    from thermobearing.validate.run import check_limits, validate_bearing

    limits = check_limits(_limits(limit))
    first = as_bearing(bearing)
    target = end.target(f"validate-{first.name}")
    announce_compiling(end.quiet)
    models: Any = model or "multi-layer"
    result = validate_bearing([first, *(compare_with or [])], tests, models=models, limits=limits)
    return end.save(result, target)
