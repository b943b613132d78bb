"""`thermobearing study`: very many runs, planned, carried out, looked at."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.commands.common import (
    ENDED_EARLY,
    INTERRUPTED,
    STRUCTURES,
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    announce_compiling,
    echo_json,
    megabytes,
    reported,
    with_progress,
    written,
)
from thermobearing.commands.help import Command, Group

if TYPE_CHECKING:
    from thermobearing.studies.forecast import Forecast
    from thermobearing.studies.status import Status

HELP = "Studies of very many runs: `study STUDY.toml -o DIR` carries one out, or what is missing."
RUN = "run"
WHERE, HOW = "Study", "How"


class _Study(Group):
    """The words of a study; a file instead of one of them is carried out."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """`study p1.toml -o p1` is `study run p1.toml -o p1`."""
        asks = {"-h", "--help"} & set(args[:1])
        if args and not asks and args[0] not in self.commands:
            args = [RUN, *args]
        return super().parse_args(ctx, args)


app = typer.Typer(cls=_Study, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")
Directory = Annotated[Path, typer.Argument(help="Directory of the study.", metavar="DIR")]


@app.command(
    RUN,
    cls=Command,
    epilog="Example: thermobearing study p1.toml -o p1 --jobs 8\n\n"
    "Example: thermobearing study p1.toml --dry-run",
)
@reported
def run(
    study: Annotated[Path, typer.Argument(help="Study file.", metavar="STUDY.toml")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Directory, new or where this study was begun.",
            rich_help_panel=WHERE,
        ),
    ] = None,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Number of runs, time and size that are expected; nothing is written.",
            rich_help_panel=WHERE,
        ),
    ] = False,
    jobs: Annotated[
        int | None, typer.Option(help="Processes; one a core by default.", rich_help_panel=HOW)
    ] = None,
    executor: Annotated[
        str, typer.Option(help="process or dask.", rich_help_panel=HOW)
    ] = "process",
    address: Annotated[
        str | None,
        typer.Option(help="Of Dask's scheduler, tcp://HOST:8786.", rich_help_panel=HOW),
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(
            help="Every n-th part from the i-th, for batch systems.",
            metavar="i/n",
            rich_help_panel=HOW,
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Carry out a study, or what is missing of it."""
    from thermobearing.studies.case import load_study

    made = load_study(study)
    if dry_run:
        return _told(made, jobs, as_json, quiet)
    from thermobearing.studies.engine import run_study

    target = output or Path(f"study-{made.name}")
    words: dict[str, Any] = {"executor": executor, "jobs": jobs, "address": address, "shard": shard}
    status = with_progress(
        lambda show: run_study(made, target, progress=show, **words), "runs", quiet, STRUCTURES
    )
    return _ended(status, as_json, quiet, part=shard is not None)


def _told(study: Any, jobs: int | None, as_json: bool, quiet: bool) -> int:
    """What a study will cost."""
    from thermobearing.results.screen import print_facts
    from thermobearing.studies.forecast import forecast
    from thermobearing.studies.log import duration

    announce_compiling(quiet, STRUCTURES)
    found: Forecast = forecast(study, jobs)
    if not quiet:
        size = megabytes(found.table_bytes + found.history_bytes)
        failed = f", {found.failed} of which failed" if found.failed else ""
        facts = {
            "runs": str(found.runs),
            "one run": f"{1e3 * found.seconds:.3g} ms, of {found.tried} that were tried{failed}",
            "all": f"{duration(found.whole_seconds)} with --jobs {found.jobs}",
            "size": f"at most {size}",
        }
        print_facts(f"{study.name}: nothing is written", facts)
    if as_json:
        echo_json(
            {
                "outcome": "dry_run",
                "exit_status": 0,
                "runs": found.runs,
                "seconds_a_run": found.seconds,
                "jobs": found.jobs,
                "seconds": found.whole_seconds,
                "bytes": found.table_bytes + found.history_bytes,
            }
        )
    return 0


def _ended(status: "Status", as_json: bool, quiet: bool, *, part: bool) -> int:
    """Say how far a study is and why runs failed; the exit status."""
    from thermobearing.studies.screen import print_status

    codes = {"interrupted": INTERRUPTED, "some_failed": ENDED_EARLY}
    code = codes.get(status.outcome, 0)
    if status.outcome == "incomplete" and status.failed:
        code = ENDED_EARLY
    with contextlib.suppress(KeyboardInterrupt):  # all is safe by now
        if not quiet:
            print_status(status, part=part)
        elif code:
            typer.echo(f"thermobearing: {status.sentence}", err=True)
    if as_json:
        echo_json({"exit_status": code, "output": str(status.directory), **status.summary()})
    return code


@app.command("status", cls=Command, epilog="Example: thermobearing study status p1")
@reported
def status_(directory: Directory, as_json: AsJson = False) -> int:
    """How far it is, and why runs failed; looks only, whoever is writing there."""
    from thermobearing.studies.screen import print_status
    from thermobearing.studies.status import study_status

    found = study_status(directory)
    print_status(found)
    if as_json:
        echo_json({"exit_status": 0, "output": str(directory), **found.summary()})
    return 0


@app.command(cls=Command, epilog="Example: thermobearing study table p1 -o p1.csv")
@reported
def table(
    directory: Directory,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="All runs, as .csv or .xlsx.", metavar="FILE"),
    ] = None,
    worst: Annotated[int, typer.Option(help="How many of the worst to show.", min=1)] = 10,
    by: Annotated[str | None, typer.Option(help="Column that ranks them.")] = None,
    force: Force = False,
    as_json: AsJson = False,
) -> int:
    """The worst runs, each with the command to repeat it; with -o all runs as one file."""
    from thermobearing.studies.saved import study_result, write_table
    from thermobearing.studies.screen import print_worst

    result = study_result(directory)
    if output is not None:
        write_table(result.table, output, force=force)
        typer.echo(f"written: {output} ({result.runs} runs)")
    elif result.runs:
        print_worst(result, worst, by)
    else:
        typer.echo("no run is done yet")
    if as_json:
        told = {"outcome": result.outcome, "exit_status": 0, "runs": result.runs}
        echo_json(told | ({"output": str(output)} if output is not None else {}))
    return 0


@app.command(
    cls=Command, epilog="Example: thermobearing study figures p1 --hazard site.csv --capacity 4"
)
@reported
def figures(
    directory: Directory,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder; `figures` in DIR by default."),
    ] = None,
    demand: Annotated[
        str | None, typer.Option(help="Column; pier_ductility by default.", metavar="COLUMN")
    ] = None,
    capacity: Annotated[
        float | None, typer.Option(help="Of the demand, in its unit; 1 of a ductility.")
    ] = None,
    method: Annotated[str, typer.Option(help="stripes, ida or cloud.")] = "stripes",
    failed: Annotated[str, typer.Option(help="Failed runs: left-out or collapse.")] = "left-out",
    hazard: Annotated[
        Path | None, typer.Option(help="Hazard curve of the site, for annual rates.")
    ] = None,
    climate: Annotated[
        str | None,
        typer.Option(
            help="Of the site, where the study has levels of temperature: name, TOML or weather.",
            metavar="NAME/FILE",
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Demand, IDA, fragility, annual rates and shares of variance."""
    from thermobearing.studies.question import Question
    from thermobearing.studies.saved import study_result
    from thermobearing.studies.site import choice, site_hazard, site_temperatures

    choice("--method", method, ("stripes", "ida", "cloud"))
    choice("--failed", failed, ("left-out", "collapse"))
    result = study_result(directory)
    asked = Question(
        demand=demand,
        capacity=capacity,
        method=method,  # type: ignore[arg-type]
        failed=failed,  # type: ignore[arg-type]
        hazard=None if hazard is None else site_hazard(result, hazard),
        temperatures=None if climate is None else site_temperatures(climate),
    )
    folder = output or Path(directory, "figures")
    made = result.plot.save_all(folder, asked)
    if not quiet:
        for path in made:
            typer.echo(f"written: {path}")
    if as_json:
        told = {"outcome": result.outcome, "exit_status": 0, "output": str(folder)}
        echo_json(told | {"files": sorted(path.name for path in made)})
    return 0


@app.command(cls=Command, epilog="Example: thermobearing study repeat p1 12 -o p1-run-12")
@reported
def repeat(
    directory: Directory,
    number: Annotated[int, typer.Argument(help="Number of the run.", metavar="RUN")],
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """One run in full: histories, loops, books, as `bridge` has them."""
    from thermobearing.earthquake.files import save_earthquake
    from thermobearing.earthquake.screen import print_study
    from thermobearing.results.directory import check_target
    from thermobearing.studies.case import load_study
    from thermobearing.studies.repeat import repeat_run
    from thermobearing.studies.store import STUDY, Store

    target = output or Path(f"{directory}-run-{number}")
    check_target(target, force=force)
    store = Store(directory)
    announce_compiling(quiet, STRUCTURES)
    result = repeat_run(load_study(store.directory / STUDY), number)
    save_earthquake(result, target, force=force, figures=not no_figures)
    if not quiet:
        with contextlib.suppress(KeyboardInterrupt):
            print_study(result)
    return written(result.outcome, result.sentence, target, as_json=as_json, quiet=quiet)
