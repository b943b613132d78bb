"""Write reports of results, and reproduce Shen (2023)."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import (
    NO_DOCUMENTS,
    REPORT,
    AsJson,
    Documents,
    NoFigures,
    Output,
    Overwrite,
    Quiet,
    Template,
    Title,
    Workbook,
    echo_json,
    megabytes,
    reported,
    with_progress,
    written,
)


@reported
def report(
    directory: Annotated[Path, typer.Argument(help="Result directory of any command.")],
    title: Title = None,
    template: Template = None,
    no_pdf: Annotated[
        bool, typer.Option("--no-pdf", help="The HTML page alone.", rich_help_panel=REPORT)
    ] = False,
    xlsx: Workbook = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> int:
    """Write report.html and report.pdf of a result into its directory; nothing is run again."""
    from thermobearing.report.title import title_given
    from thermobearing.reporting import make_report

    block = title_given(title or [])
    files = make_report(directory, title=block, template=template, pdf=not no_pdf, workbook=xlsx)
    if not quiet:
        for file in files:
            typer.echo(f"written: {printable(str(file))} ({megabytes(file.stat().st_size)})")
    if as_json:
        told = {"outcome": "completed", "exit_status": 0, "files": [str(file) for file in files]}
        echo_json(told)
    return 0


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
    overwrite: Overwrite = False,
    no_figures: NoFigures = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    documents: Documents = NO_DOCUMENTS,
) -> int:
    """Make the source's tables and figures again, and judge every claim of it.

    From the data files and the code alone; what needs the source's own measurements says so.
    """
    from thermobearing.reproduce.result import print_reproduction
    from thermobearing.reproduce.run import reproduce_source
    from thermobearing.results.directory import check_target

    target = output or Path("reproduction")
    check_target(target, overwrite=overwrite)
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
    found.save(target, overwrite=overwrite)
    if not quiet:
        print_reproduction(found)
    return written(found.outcome, found.sentence, target, documents, as_json=as_json, quiet=quiet)
