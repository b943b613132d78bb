"""Write reports of results."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import (
    REPORT,
    AsJson,
    Quiet,
    Template,
    Title,
    Workbook,
    echo_json,
    megabytes,
    reported,
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
