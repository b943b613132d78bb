"""`thermobearing identify`: parameters of a bearing from its tests, or a look at the tests."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermobearing.border.errors import InputError
from thermobearing.commands.common import (
    BAD_INPUT,
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    echo_json,
    reported,
    written,
)

if TYPE_CHECKING:
    from thermobearing.bearing.model import Bearing
    from thermobearing.identify.checks import CheckReport
    from thermobearing.identify.record import TestRecord
    from thermobearing.identify.run import Identification

SENTENCES = {"not_converged": "The search stopped before it converged. Give more --starts."}
MARKS = {"refused": "REFUSED", "warning": "warning", "note": "note"}


@reported
def identify(
    tests: Annotated[list[Path], typer.Argument(help="Tests: CSV files or their TOML sidecars.")],
    start: Annotated[
        str | None,
        typer.Option(help="Bearing: geometry, fixed values.", metavar="NAME/FILE"),
    ] = None,
    free: Annotated[
        str | None, typer.Option(help="Free parameters, such as K_r,d_y or n_T=2.4*m_T.")
    ] = None,
    method: Annotated[
        str, typer.Option(help="least-squares, krill-herd or differential-evolution.")
    ] = "least-squares",
    polish: Annotated[
        bool, typer.Option("--polish/--no-polish", help="End with least squares.")
    ] = True,
    seed: Annotated[int, typer.Option(help="Of all random numbers.")] = 0,
    starts: Annotated[int, typer.Option(help="Starts of least squares.")] = 3,
    evaluations: Annotated[int, typer.Option(help="Budget of the other methods.")] = 2000,
    loss: Annotated[str, typer.Option(help="linear, soft_l1, huber or cauchy.")] = "linear",
    temperatures: Annotated[
        bool, typer.Option("--temperatures", help="Fit the thermocouples too.")
    ] = False,
    from_start: Annotated[
        bool, typer.Option("--from-start", help="Begin at the bearing's own values.")
    ] = False,
    check: Annotated[bool, typer.Option("--check", help="Only look the tests over.")] = False,
    posterior: Annotated[
        bool, typer.Option("--posterior", help="Sample the posterior (needs emcee).")
    ] = False,
    predict: Annotated[
        list[float] | None,
        typer.Option(help="Ambient temperature [degC] to predict a band at; may be repeated."),
    ] = None,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Identify a bearing's parameters from cyclic tests, with their uncertainty."""
    from thermobearing.identify.run import identify_bearing as fit
    from thermobearing.results.directory import check_target

    records, bearing = _load(tests, start, needed=not check)
    kind = "check" if check else "identify"
    target = output or Path(f"{kind}-" + re.sub(r"[^\w.+-]+", "-", records[0].name))
    check_target(target, force=force)
    if check:
        return _check(records, bearing, target, force, no_figures, as_json, quiet)
    assert bearing is not None
    names = [name.strip() for name in free.split(",")] if free is not None else None
    found = fit(
        records, bearing, free=names, method=method, seed=seed, starts=starts,  # type: ignore[arg-type]
        loss=loss, temperatures=temperatures, blind=not from_start, polish=polish,  # type: ignore[arg-type]
        evaluations=evaluations,
    )  # fmt: skip
    _save(found, target, seed, posterior, predict or [], force=force, draw=not no_figures)
    if not quiet:
        _print(found)
    sentence = SENTENCES.get(found.outcome, "")
    return written(found.outcome, sentence, target, as_json=as_json, quiet=quiet)


def _load(
    tests: list[Path], start: str | None, *, needed: bool
) -> "tuple[list[TestRecord], Bearing | None]":
    """Tests, and the one bearing they belong to."""
    from thermobearing.bearing.library import load_bearing
    from thermobearing.identify.record import load_test

    records = [load_test(path) for path in tests]
    names = {record.bearing for record in records if record.bearing}
    if start is None and len(names) > 1:
        raise InputError(f"the tests name several bearings ({', '.join(sorted(names))})")
    chosen = start or next(iter(names), None)
    if chosen is None and needed:
        raise InputError(
            "which bearing? give --start NAME/FILE, or bearing = ... in the sidecar: a fit needs "
            "its geometry and materials (thermobearing list names the built-in ones)"
        )
    return records, load_bearing(chosen) if chosen else None


def _check(
    records: "list[TestRecord]",
    bearing: "Bearing | None",
    target: Path,
    force: bool,
    no_figures: bool,
    as_json: bool,
    quiet: bool,
) -> int:
    """Look the tests over; status 2 if one cannot be used."""
    from thermobearing.identify.checks import check_test
    from thermobearing.identify.files import save_checks

    reports: list[CheckReport] = [check_test(record, bearing) for record in records]
    save_checks(reports, target, force=force, draw=not no_figures)
    if not quiet:
        for report in reports:
            typer.echo(f"{report.record.name}: {report.outcome}")
            for finding in report.findings:
                typer.echo(f"  {MARKS[finding.level]:8} {finding.check}: {finding.sentence}")
        typer.echo(f"written: {target}")
    refused = any(report.outcome == "refused" for report in reports)
    if as_json:
        outcomes = {report.record.name: report.outcome for report in reports}
        status = BAD_INPUT if refused else 0
        echo_json({"outcome": outcomes, "exit_status": status, "output": str(target)})
    return BAD_INPUT if refused else 0


def _save(
    found: "Identification",
    target: Path,
    seed: int,
    posterior: bool,
    predict: list[float],
    *,
    force: bool,
    draw: bool,
) -> None:
    """Write the result directory, with samples and bands if wanted."""
    import thermobearing
    from thermobearing.identify.files import save_identification
    from thermobearing.identify.posterior import (
        laplace_samples,
        posterior_samples,
        predictive_band,
    )

    samples, bands = None, []
    if posterior or predict:
        draw_samples = posterior_samples if posterior else laplace_samples
        samples = draw_samples(found, seed=seed)
        at = predict or [found.records[0].ambient]
        bands = [predictive_band(found, samples, ambient, seed=seed) for ambient in at]
    save_identification(
        found, target, version=thermobearing.__version__, force=force, draw=draw,
        samples=samples, bands=bands,
    )  # fmt: skip


def _print(found: "Identification") -> None:
    """Parameters, measures of each record, warnings."""
    from rich.console import Console
    from rich.table import Table

    from thermobearing.identify.report import fits

    console = Console()
    table = Table(title=f"{found.bearing.name}: {found.method}, {found.seconds:.1f} s")
    for head in ("parameter", "value", "standard error", "95 % interval", "unit"):
        table.add_column(head, justify="left" if head in ("parameter", "unit") else "right")
    for item in found.uncertainty.estimates.values():
        kind = item.parameter.kind
        error = "at its bound" if item.at_bound else f"{item.stderr:.2g}"
        table.add_row(
            kind.symbol, f"{item.value:.4g}", error, f"{item.lower:.4g} to {item.upper:.4g}",
            kind.unit,
        )  # fmt: skip
    console.print(table)
    measures = Table(title="model against test, errors over the cycles")
    for head in ("record", "ambient", "R²", "NRMSE", "G_e", "h_eq", "energy", "peak force"):
        measures.add_column(head, justify="left" if head == "record" else "right")
    for fit in fits(found):
        spans = []
        for name in ("G_eq_error", "h_eq_error", "energy_error", "force_max_error"):
            values = [100.0 * getattr(c, name) for c in fit.cycles]
            spans.append(f"{min(values):+.1f} to {max(values):+.1f} %")
        measures.add_row(
            fit.record.name, f"{fit.record.ambient:g} °C", f"{fit.R2:.4f}", f"{fit.NRMSE:.2%}",
            *spans,
        )  # fmt: skip
    console.print(measures)
    for warning in found.warnings:
        console.print(f"[yellow]warning:[/] {warning}", highlight=False, soft_wrap=True)
