"""Run, resume, inspect and evaluate parameter studies."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import (
    ENDED_EARLY,
    INTERRUPTED,
    STRUCTURES,
    AsJson,
    Command,
    Group,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    announce_compiling,
    echo_json,
    megabytes,
    reported,
    with_progress,
    written,
)

if TYPE_CHECKING:
    from thermobearing.studies.run.dry_run import Forecast
    from thermobearing.studies.run.status import Status

Directory = Annotated[Path, typer.Argument(help="Directory of the study.", metavar="DIR")]
Demand = Annotated[
    str | None,
    typer.Option(help="Column of the table of runs; ductility of the pier by default."),
]


@reported
def figures(
    directory: Directory,
    demand: Demand = None,
    capacity: Annotated[
        float | None,
        typer.Option(help="Of the demand, in the unit of its column; fragility needs it."),
    ] = None,
    hazard: Annotated[
        str | None, typer.Option(help="Hazard curve of the site: a file.", metavar="FILE")
    ] = None,
    weather: Annotated[
        str | None,
        typer.Option(help="Of the site by the hour: file or climate.", metavar="FILE/NAME"),
    ] = None,
    method: Annotated[str | None, typer.Option(help="Of fragility: stripes, ida or cloud.")] = None,
    failed: Annotated[
        str | None, typer.Option(help="Failed runs: left-out (the default) or collapse.")
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Draw demand, IDA curves, fragility, annual rates and shares of variance into DIR/figures.

    What was asked is kept in DIR/question.toml; `thermobearing report DIR` asks the same.
    """
    from thermobearing.results.directory import FIGURES
    from thermobearing.studies.options import asked_over, keep_asked, kept_asked
    from thermobearing.studies.output import print_answers, study_result

    options = {"demand": demand, "capacity": capacity, "hazard": hazard, "weather": weather}
    options |= {"method": method, "failed": failed}
    asked = asked_over(kept_asked(directory), options)
    result = study_result(directory)
    question = asked.question()
    files = result.plot.save_all(directory / FIGURES, question)
    keep_asked(directory, asked)
    if not quiet:
        print_answers(result, question)
        for file in files:
            typer.echo(f"written: {printable(str(file))}")
    if as_json:
        echo_json({"exit_status": 0, **result.summary(), "files": [str(file) for file in files]})
    return 0


@reported
def worst(
    directory: Directory,
    count: Annotated[int, typer.Option(help="How many.", min=1)] = 10,
    demand: Demand = None,
    as_json: AsJson = False,
) -> int:
    """The worst runs, and one of each way to fail, with the command that repeats each in full."""
    from thermobearing.studies.output import print_worst, study_result

    table = study_result(directory).worst(count, demand)
    print_worst(table)
    if as_json:
        echo_json({"exit_status": 0, "runs": table.to_dict("records")})
    return 0


@reported
def repeat(
    directory: Directory,
    run: Annotated[int, typer.Argument(help="Number of the run.", metavar="RUN", min=0)],
    output: Output = None,
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Carry out one run of a study again with everything kept, as `bridge` does."""
    from thermobearing.results.directory import check_target
    from thermobearing.studies.definition.case import load_study
    from thermobearing.studies.run.worst import repeat_run
    from thermobearing.studies.store.directory import STUDY

    if output is not None:
        check_target(output, overwrite=overwrite)
    result = repeat_run(load_study(directory / STUDY), run)
    if not quiet:
        result.show()
    if output is None:
        if as_json:
            echo_json({"exit_status": 0, **result.summary()})
        return 0
    result.save(output, overwrite=overwrite, figures=not no_figures)
    return written(result.outcome, result.sentence, output, as_json=as_json, quiet=quiet)


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


@app.command(
    RUN,
    cls=Command,
    epilog="Example: thermobearing study run p1.toml -o p1 --jobs 8\n\n"
    "Example: thermobearing study run p1.toml --dry-run",
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
    from thermobearing.studies.definition.case import load_study

    made = load_study(study)
    if dry_run:
        return _told(made, jobs, as_json, quiet)
    from thermobearing.studies.inputs.motions import is_matched
    from thermobearing.studies.run.engine import check_start, run_study

    target = output or Path(f"study-{made.name}")
    words: dict[str, Any] = {"executor": executor, "jobs": jobs, "address": address, "shard": shard}
    if is_matched(made):
        check_start(target, **words)
        made = _with_motions(made, target, jobs, quiet)
    status = with_progress(
        lambda show: run_study(made, target, progress=show, **words), "runs", quiet, STRUCTURES
    )
    return _ended(status, as_json, quiet, part=shard is not None)


def _with_motions(study: Any, target: Path, jobs: int | None, quiet: bool) -> Any:
    """A study whose motions are made; says first that this takes its time."""
    from thermobearing.report.words import counted
    from thermobearing.studies.inputs.motions import missing_motions, with_matched

    missing = len(missing_motions(study, target))
    if missing and not quiet:
        told = (
            f"{counted(missing, 'motion')} to be made to fit {study.factors.motion.matched}, once"
        )
        typer.echo(told, err=True)
    return with_progress(
        lambda show: with_matched(study, target, jobs, show), "motions made", quiet
    )


def _told(study: Any, jobs: int | None, as_json: bool, quiet: bool) -> int:
    """What a study will cost."""
    from thermobearing.results.screen import print_facts
    from thermobearing.studies.run.dry_run import forecast
    from thermobearing.studies.store.directory import duration

    announce_compiling(quiet, STRUCTURES)
    found: Forecast = forecast(study, jobs)
    if not quiet:
        size = found.table_bytes + found.history_bytes
        told = f"{size / 1e3:.0f} kB" if size < 1e6 else megabytes(size)
        failed = f", {found.failed} of which failed" if found.failed else ""
        facts = {
            "runs": str(found.runs),
            "one run": f"{1e3 * found.seconds:.3g} ms, of {found.tried} that were tried{failed}",
            "motions": f"{found.motions} to be made first, {duration(found.motion_seconds)} each",
            "all": f"{duration(max(found.whole_seconds, 1.0))} with --jobs {found.jobs}",
            "size": f"at most {told}",
        }
        if not found.motions:
            del facts["motions"]
        print_facts(f"{study.name}: nothing is written", facts)
    if as_json:
        echo_json(
            {
                "outcome": "dry_run",
                "exit_status": 0,
                "runs": found.runs,
                "seconds_a_run": found.seconds,
                "motions_to_make": found.motions,
                "seconds_a_motion": found.motion_seconds,
                "jobs": found.jobs,
                "seconds": found.whole_seconds,
                "bytes": found.table_bytes + found.history_bytes,
            }
        )
    return 0


def _ended(status: "Status", as_json: bool, quiet: bool, *, part: bool) -> int:
    """Say how far a study is and why runs failed; the exit status."""
    from thermobearing.studies.output import print_status

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
    from thermobearing.studies.output import print_status
    from thermobearing.studies.run.status import study_status

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
        typer.Option(
            "-o", "--output", help="File, .csv or .xlsx; DIR.csv by default.", metavar="FILE"
        ),
    ] = None,
    overwrite: Overwrite = False,
    as_json: AsJson = False,
) -> int:
    """All runs that are done as one file, a row each."""
    from thermobearing.studies.store.directory import Store
    from thermobearing.studies.store.parquet import write_table

    found = Store(directory).table()
    file = output or Path(f"{directory}.csv")
    write_table(found, file, overwrite=overwrite)
    typer.echo(f"written: {printable(str(file))} ({len(found)} runs)")
    if as_json:
        echo_json({"exit_status": 0, "output": str(file), "runs": len(found)})
    return 0


app.command(
    cls=Command,
    epilog="Example: thermobearing study figures p1 --hazard site.csv --capacity 4",
)(figures)
app.command(cls=Command, epilog="Example: thermobearing study worst p1")(worst)
app.command(cls=Command, epilog="Example: thermobearing study repeat p1 12 -o p1-run-12")(repeat)
