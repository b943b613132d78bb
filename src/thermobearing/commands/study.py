"""`thermobearing study`: very many runs, planned, carried out, looked at."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.border.errors import printable
from thermobearing.commands import study_drawn
from thermobearing.commands.common import (
    ENDED_EARLY,
    INTERRUPTED,
    STRUCTURES,
    AsJson,
    Force,
    Quiet,
    announce_compiling,
    echo_json,
    megabytes,
    reported,
    with_progress,
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
    from thermobearing.studies.case import load_study

    made = load_study(study)
    if dry_run:
        return _told(made, jobs, as_json, quiet)
    from thermobearing.studies.engine import check_start, run_study
    from thermobearing.studies.matched import is_matched

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
    from thermobearing.studies.matched import missing_of, with_matched

    missing = len(missing_of(study, target))
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
    from thermobearing.studies.forecast import forecast
    from thermobearing.studies.log import duration

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
        typer.Option(
            "-o", "--output", help="File, .csv or .xlsx; DIR.csv by default.", metavar="FILE"
        ),
    ] = None,
    force: Force = False,
    as_json: AsJson = False,
) -> int:
    """All runs that are done as one file, a row each."""
    from thermobearing.studies.export import write_table
    from thermobearing.studies.store import Store

    found = Store(directory).table()
    file = output or Path(f"{directory}.csv")
    write_table(found, file, force=force)
    typer.echo(f"written: {printable(str(file))} ({len(found)} runs)")
    if as_json:
        echo_json({"exit_status": 0, "output": str(file), "runs": len(found)})
    return 0


app.command(
    cls=Command,
    epilog="Example: thermobearing study figures p1 --hazard site.csv --capacity 4",
)(study_drawn.figures)
app.command(cls=Command, epilog="Example: thermobearing study worst p1")(study_drawn.worst)
app.command(cls=Command, epilog="Example: thermobearing study repeat p1 12 -o p1-run-12")(
    study_drawn.repeat
)
