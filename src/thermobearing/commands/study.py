"""Run, resume, inspect and evaluate parameter studies."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermobearing.commands.common import (
    ANALYSES,
    ENDED_EARLY,
    INTERRUPTED,
    STRUCTURES,
    Answer,
    Drawn,
    Group,
    Printed,
    announce_compiling,
    app,
    echo_written,
    megabytes,
    values_by_name,
    with_progress,
)
from thermobearing.commands.options import Overwrite, Quiet, command, fields, option

if TYPE_CHECKING:
    from thermobearing.studies.run.engine import Status

DIRECTORY = Annotated[Path, typer.Argument(help="Directory of the study.", metavar="DIR")]
HELP = "Run and evaluate parameter studies: `study STUDY.toml -o DIR` runs or resumes one."
RUN = "run"
WHERE, HOW = "Study", "Execution"


class _Study(Group):
    """The commands of a study; a file in place of one of them is run."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """`study p1.toml -o p1` is `study run p1.toml -o p1`."""
        asks = {"-h", "--help"} & set(args[:1])
        if args and not asks and args[0] not in self.commands:
            args = [RUN, *args]
        return super().parse_args(ctx, args)


studies = typer.Typer(cls=_Study, help=HELP, no_args_is_help=True, rich_markup_mode="markdown")
app.add_typer(studies, name="study", rich_help_panel=ANALYSES)


@command(
    studies,
    RUN,
    fields(
        "studies.run.engine:run_study",
        "jobs executor address shard resume",
        HOW,
        address="||ADDRESS",
    ),
    examples="study run p1.toml -o p1 --jobs 8\nstudy run p1.toml --dry-run",
    laws=True,
)
def _run(
    study: Annotated[Path, typer.Argument(help="Study file.", metavar="STUDY.toml")],
    output: Annotated[
        Path | None,
        option(
            "-o",
            "--output",
            help="Directory of the study, new or with an interrupted study.",
            panel=WHERE,
        ),
    ],
    dry_run: Annotated[
        bool,
        option(
            "--dry-run",
            help="Print the expected number of runs, time and size; write nothing.",
            panel=WHERE,
        ),
    ],
    options: dict[str, Any],
    quiet: Quiet,
) -> Answer:
    """Run or resume a parameter study."""
    from thermobearing.studies.definition.case import load_study
    from thermobearing.studies.definition.motions import study_notes
    from thermobearing.studies.run.engine import check_resumed, check_start, run_study

    loaded = load_study(study)
    jobs = options.get("jobs")
    if dry_run:
        return _show_forecast(loaded, jobs, quiet)
    target = output or Path(f"study-{loaded.name}")
    if options.get("resume"):
        check_resumed(target)
    _announce_resuming(target, quiet)
    # Generating motions takes minutes: what would stop the study is found before it.
    if loaded.factors.motion.matched is not None:
        check_start(target, **{name: options[name] for name in options if name != "resume"})
        loaded = _with_motions(loaded, target, jobs, quiet)
    if not quiet:
        for note in study_notes(loaded):
            typer.echo(f"warning: {note}", err=True)
    status = with_progress(
        lambda show: run_study(loaded, target, progress=show, **options),
        "runs",
        quiet,
        STRUCTURES,
        resumes=True,
    )
    return _answer(status, quiet, part="shard" in options)


def _announce_resuming(target: Path, quiet: bool) -> None:
    """Say how much of a study is there already."""
    from thermobearing.studies.run.engine import study_status
    from thermobearing.studies.store import is_study

    if not quiet and is_study(target):
        status = study_status(target)
        typer.echo(f"resuming {target}: {status.done} of {status.runs} runs are there", err=True)


@command(studies, "status", examples="study status p1")
def _status(directory: DIRECTORY) -> Answer:
    """Show the progress of a study and the reasons for failed runs."""
    from thermobearing.studies.run.engine import study_status

    status = study_status(directory)
    status.show()
    return {"exit_status": 0, "output": str(directory), **status.summary()}


@command(studies, "table", examples="study table p1 -o p1.csv")
def _table(
    directory: DIRECTORY,
    output: Annotated[
        Path | None,
        option("-o", "--output", help="File, .csv or .xlsx; DIR.csv by default.", metavar="FILE"),
    ],
    overwrite: Overwrite,
) -> Answer:
    """Export all runs that are there, failed ones too, to a table file with one row per run."""
    from thermobearing.studies.store import Store, write_table

    store = Store(directory)
    table = store.table(shards=store.checked_shards())
    file = output or Path(f"{directory}.csv")
    write_table(table, file, overwrite=overwrite)
    echo_written(file, f" ({len(table)} runs)")
    return {"exit_status": 0, "output": str(file), "runs": len(table)}


@command(
    studies,
    "export",
    examples="study export p1 --capacity pier_ductility=4 --output p1-pelicun",
)
def _export(
    directory: DIRECTORY,
    output: Annotated[
        Path | None,
        option("-o", "--output", help="Directory; DIR-pelicun by default.", metavar="DIR"),
    ],
    capacity: Annotated[
        list[str] | None,
        option(
            "--capacity",
            help="Capacity of a demand, in the unit of its column, such as pier_ductility=4; by "
            "default that of question.toml. May be repeated.",
            metavar="COLUMN=VALUE",
        ),
    ],
    overwrite: Overwrite,
) -> Answer:
    """Export demands and fragility curves as pelicun files."""
    from thermobearing.studies.report import write_pelicun
    from thermobearing.studies.result import study_result

    target = output or Path(f"{directory}-pelicun")
    capacities = values_by_name(capacity, "--capacity", "COLUMN=VALUE, such as pier_ductility=4")
    exported = write_pelicun(
        study_result(directory), target, capacities=capacities or None, overwrite=overwrite
    )
    for sentence in exported.not_in_demand:
        typer.echo(sentence)
    for sentence in exported.without_curve:
        typer.echo(f"no curve of {sentence}")
    echo_written(target)
    return {"exit_status": 0, "output": str(target), **exported._asdict()}


@command(
    studies,
    "figures",
    fields(
        "studies.question:Question",
        "demand capacity hazard weather method failed",
    ),
    examples="study figures p1 --hazard site.csv --capacity 4 --figure-width single-column",
)
def _figures(directory: DIRECTORY, options: dict[str, Any], end: Drawn) -> Answer:
    """Draw demand, IDA curves, fragility, annual rates and variance contributions.

    The figures are written into DIR/figures, those of another demand than the default one into
    DIR/figures/DEMAND, and those of another method than stripes into a folder METHOD there, so that
    they replace no others. Figures that an earlier call wrote there and this one does not are
    removed. The settings are stored in
    DIR/question.toml, which `thermobearing report DIR` reads too.
    """
    from thermobearing.results.directory import FIGURES
    from thermobearing.studies.figures import remove_earlier
    from thermobearing.studies.question import (
        QUESTION,
        Question,
        change_question,
        describe_kept,
        load_question,
        save_question,
    )
    from thermobearing.studies.result import study_result

    saved = load_question(directory)
    demands = filter(None, [saved.demand, options.get("demand")])
    result = study_result(directory, saved, demands=list(demands))
    question = change_question(saved, options, default_demand=result.demand_name)
    result.question = question
    folder = directory / FIGURES
    if result.demand_name != result.default_demand:
        folder /= result.demand_name
    if question.method != Question().method:
        folder /= question.method
    files = result.plot.save_all(folder, **end.figures)
    removed = remove_earlier(result, folder, files)
    save_question(directory, question)
    if not end.quiet:
        for sentence in describe_kept(saved, options, question, str(directory / QUESTION)):
            typer.echo(sentence)
        result.show()
        for file in files:
            echo_written(file)
        for file in removed:
            typer.echo(f"removed: {file}, a figure of an earlier call")
    return {
        "exit_status": 0,
        **result.summary(),
        "files": [str(file) for file in files],
        "removed": [str(file) for file in removed],
    }


@command(
    studies,
    "worst",
    fields("studies.question:Question", "demand"),
    examples="study worst p1",
)
def _worst(
    directory: DIRECTORY,
    options: dict[str, Any],
    count: Annotated[int, option(help="Number of runs to list.", min=1)] = 10,
) -> Answer:
    """List the worst runs and one example of each failure mode, with the command to repeat each."""
    from thermobearing.results.screen import say, show_table
    from thermobearing.studies.result import study_result
    from thermobearing.studies.tables import worst_table

    result = study_result(directory)
    table = result.worst(count, options.get("demand"))
    show_table(worst_table(result, table.drop(columns="command")))
    for line in table["command"]:
        say(line)
    return {"exit_status": 0, "runs": table.to_dict("records")}


@command(studies, "repeat", examples="study repeat p1 12 -o p1-run-12", laws=True)
def _repeat(
    directory: DIRECTORY,
    run: Annotated[int, typer.Argument(help="Number of the run.", metavar="RUN", min=0)],
    end: Printed,
) -> Answer:
    """Repeat one run of a study and save all histories, as `bridge` does."""
    from thermobearing.studies.run.engine import repeat_run
    from thermobearing.studies.store import Store

    end.check()
    store = Store(directory)
    return end.save_if_asked(repeat_run(store.study(), run, store))


def _with_motions(study: Any, target: Path, jobs: int | None, quiet: bool) -> Any:
    """Return the study with generated motions, which are announced first."""
    from thermobearing.quantities.words import counted
    from thermobearing.studies.definition.motions import missing_motions, with_matched

    missing = len(missing_motions(study, target))
    if missing and not quiet:
        message = (
            f"{counted(missing, 'motion')} will be generated once to fit "
            f"{study.factors.motion.matched}"
        )
        typer.echo(message, err=True)
    return with_progress(lambda show: with_matched(study, target, jobs, show), "motions", quiet)


def _show_forecast(study: Any, jobs: int | None, quiet: bool) -> Answer:
    """Print the expected number of runs, time and size of a study."""
    from thermobearing.results.screen import print_facts, say
    from thermobearing.studies.definition.motions import study_notes
    from thermobearing.studies.run.engine import forecast, say_duration

    announce_compiling(quiet, STRUCTURES)
    estimate, notes = forecast(study, jobs), study_notes(study)
    if not quiet:
        size = f"{estimate.size / 1e3:.0f} kB" if estimate.size < 1e6 else megabytes(estimate.size)
        failed = f", {estimate.failed} failed" if estimate.failed else ""
        facts = {
            "runs": str(estimate.runs),
            "one run": f"{1e3 * estimate.seconds:.3g} ms, of {estimate.tried} trial runs{failed}",
            "motions": f"{estimate.motions} to be generated first, "
            f"{say_duration(estimate.motion_seconds)} each",
            "total": f"{say_duration(max(estimate.whole_seconds, 1.0))} "
            f"with --jobs {estimate.jobs}, without the start of these processes",
            "size": f"at most {size}",
        }
        if not estimate.motions:
            del facts["motions"]
        print_facts(f"{study.name}: nothing is written", facts)
        for failure in estimate.failures.to_dict("records"):
            say(f"{failure['outcome']}: {failure['sentence']}")
        for note in notes:
            say(note)
    return {
        "outcome": "dry_run",
        "exit_status": 0,
        "notes": notes,
        "runs": estimate.runs,
        "seconds_a_run": estimate.seconds,
        "motions_to_make": estimate.motions,
        "seconds_a_motion": estimate.motion_seconds,
        "failures": estimate.failures.to_dict("records"),
        "jobs": estimate.jobs,
        "seconds": estimate.whole_seconds,
        "bytes": estimate.size,
    }


def _answer(status: "Status", quiet: bool, *, part: bool) -> Answer:
    """Print the progress of a study and return its answer with the exit status."""
    codes = {"interrupted": INTERRUPTED, "some_failed": ENDED_EARLY}
    code = codes.get(status.outcome, 0)
    # A shard is incomplete by design; failed runs in it are an error all the same.
    if status.outcome == "incomplete" and status.failed:
        code = ENDED_EARLY
    with contextlib.suppress(KeyboardInterrupt):  # all is safe by now
        if not quiet:
            status.show(part=part)
        elif code:
            typer.echo(f"thermobearing: {status.sentence}", err=True)
    return {"exit_status": code, "output": str(status.directory), **status.summary()}
