"""`thermobearing reproduce`: the source again, with a verdict on every claim."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.commands.common import (
    NO_DOCUMENTS,
    AsJson,
    Documents,
    Force,
    NoFigures,
    Output,
    Quiet,
    reported,
    with_progress,
    written,
)


@reported
def reproduce(
    chapter: Annotated[
        int | None, typer.Option(min=3, max=7, help="One chapter alone; 7: conclusions.")
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=64, help="Processes; one a core by default.")
    ] = None,
    no_flips: Annotated[
        bool, typer.Option("--no-flips", help="Verdicts alone, not what would flip them.")
    ] = False,
    output: Output = None,
    force: Force = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Make the source's tables and figures again, and judge every claim of it.

    From the data files and the code alone; what needs the source's own measurements says so.
    """
    from thermobearing.reproduce.run import reproduce_source
    from thermobearing.reproduce.screen import print_reproduction
    from thermobearing.results.directory import check_target

    target = output or Path("reproduction")
    check_target(target, force=force)
    found = with_progress(
        lambda progress: reproduce_source(
            chapter=chapter,
            figures=not no_figures,
            flips=not no_flips,
            jobs=jobs,
            progress=progress,
        ),
        "claims, figures, tables",
        quiet,
    )
    found.save(target, force=force)
    if not quiet:
        print_reproduction(found)
    return written(found.outcome, found.sentence, target, documents, as_json=as_json, quiet=quiet)
