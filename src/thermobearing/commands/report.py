"""Write reports of results."""

from pathlib import Path
from typing import Annotated

import typer

from thermobearing.border.errors import printable
from thermobearing.commands.common import REPORT, echo_json, megabytes
from thermobearing.commands.options import (
    AsJson,
    Quiet,
    Template,
    Title,
    Workbook,
    command,
    option,
)


@command()
def report(
    directory: Annotated[Path, typer.Argument(help="Result directory of any command.")],
    title: Title,
    template: Template,
    no_pdf: Annotated[bool, option("--no-pdf", help="The HTML page alone.", panel=REPORT)],
    xlsx: Workbook,
    as_json: AsJson,
    quiet: Quiet,
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
        last = {"outcome": "completed", "exit_status": 0, "files": [str(file) for file in files]}
        echo_json(last)
    return 0
