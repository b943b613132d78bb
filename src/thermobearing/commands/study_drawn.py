"""`thermobearing study figures`, `worst` and `repeat`: what is drawn from a study."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import (
    AsJson,
    Force,
    NoFigures,
    Output,
    Quiet,
    echo_json,
    reported,
    written,
)

Directory = Annotated[Path, typer.Argument(help="Directory of a study.", metavar="DIR")]
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
    from thermobearing.studies.asked import asked_over, keep_asked, kept_asked
    from thermobearing.studies.files import study_result
    from thermobearing.studies.screen import print_answers

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
    from thermobearing.studies.files import study_result
    from thermobearing.studies.screen import print_worst

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
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Carry out one run of a study again with everything kept, as `bridge` does."""
    from thermobearing.results.directory import check_target
    from thermobearing.studies.case import load_study
    from thermobearing.studies.repeat import repeat_run
    from thermobearing.studies.store import STUDY

    if output is not None:
        check_target(output, force=force)
    result = repeat_run(load_study(directory / STUDY), run)
    if not quiet:
        result.show()
    if output is None:
        if as_json:
            echo_json({"exit_status": 0, **result.summary()})
        return 0
    result.save(output, force=force, figures=not no_figures)
    return written(result.outcome, result.sentence, output, as_json=as_json, quiet=quiet)
