"""A document is written into its result directory whole, or the earlier one stays as it was."""

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

from thermobearing.border.errors import OutputError, is_folder
from thermobearing.border.text_file import write_through
from thermobearing.report.figures import drawn
from thermobearing.report.html import html_page
from thermobearing.report.pdf import pdf_bytes, the_compiler
from thermobearing.report.pieces import Pieces
from thermobearing.report.template import document
from thermobearing.report.title import TitleBlock
from thermobearing.results.directory import (
    LOGO,
    REPORT_HTML,
    REPORT_PDF,
    TITLE,
    WORKBOOK,
    new_sibling,
)

WRITTEN = (REPORT_HTML, REPORT_PDF, WORKBOOK, TITLE, LOGO)


def check_place(directory: Path) -> None:
    """Refuse a directory that no document can be written into, before one is made."""
    if not is_folder(directory):
        raise OutputError(f"{directory}: is no directory")
    for folder in (directory.resolve(), directory.resolve().parent):
        if not os.access(folder, os.W_OK | os.X_OK):
            raise OutputError(f"{folder}: is not writable, so no document can be put there")
    for name in WRITTEN:
        if is_folder(directory / name):
            raise OutputError(f"{directory / name}: is a directory, where a document is to go")


def report_files(
    pieces: Pieces, title: TitleBlock, template: Path | None = None, *, pdf: bool = True
) -> dict[str, bytes | None]:
    """Return report.html and report.pdf, by name.

    Without `pdf`, a report.pdf that is there goes, since it would show another state.
    """
    made = document(pieces, title.words(), title.logo_bytes(), template)
    if not pdf:
        return {REPORT_HTML: html_page(made).encode(), REPORT_PDF: None}
    the_compiler()  # before anything is drawn
    shown = drawn(made)
    return {REPORT_HTML: html_page(shown).encode(), REPORT_PDF: pdf_bytes(shown)}


def title_files(title: TitleBlock) -> dict[str, bytes | None]:
    """Return the title block as files of a result directory; none where nothing is given."""
    if title == TitleBlock():
        return {TITLE: None, LOGO: None}
    logo = title.logo_bytes()
    kept = title.model_copy(update={"logo": LOGO if logo is not None else None})
    return {TITLE: kept.to_toml().encode(), LOGO: logo}


def keep_title(directory: Path, title: TitleBlock) -> None:
    """Keep a title block for a document that is made later."""
    if title != TitleBlock():
        put_files(directory, title_files(title))


def put_files(directory: Path, content: Mapping[str, bytes | None]) -> list[Path]:
    """Put files into a directory, all of them or none; None takes one away.

    They are written beside the directory first: a process that is killed leaves nothing in it
    that is no result, and the next one takes away what it left beside.
    """
    final = directory.resolve()
    try:
        with new_sibling(final) as partial:
            try:
                for name, raw in content.items():
                    if raw is not None:
                        write_through(partial / name, raw)
                _exchange(partial, final, list(content))
            finally:
                shutil.rmtree(partial, ignore_errors=True)
    except OSError as error:
        raise OutputError(
            f"{directory}: the document cannot be written: {error.strerror or error}; "
            "what was there is as it was"
        ) from None
    documents = (REPORT_HTML, REPORT_PDF, WORKBOOK)
    return [directory / name for name in documents if content.get(name) is not None]


def _exchange(partial: Path, final: Path, names: list[str]) -> None:
    """Move new files over old ones; whatever stops it, the old ones come back."""
    earlier = partial / "earlier"
    earlier.mkdir()
    for name in names:
        if (final / name).exists():
            shutil.copy2(final / name, earlier / name)

    def move(source: Path, name: str) -> None:
        if (source / name).exists():
            os.replace(source / name, final / name)
        else:
            (final / name).unlink(missing_ok=True)

    begun = []
    try:
        for name in names:
            begun.append(name)
            move(partial, name)
    except BaseException:  # Ctrl-C too
        for name in begun:
            move(earlier, name)
        raise
