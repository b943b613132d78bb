"""Write the report of any result into its directory.

Reports are written atomically: on failure the earlier ones are kept.
"""

import os
import shutil
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.opener import is_file, is_folder
from thermobearing.border.schema import validated
from thermobearing.border.text_file import write_through
from thermobearing.border.title import TitleBlock, read_title
from thermobearing.live.report import live_section
from thermobearing.report.content import comparison_pieces, pieces_of_saved
from thermobearing.report.figures import drawn
from thermobearing.report.markdown import check_packages
from thermobearing.report.pdf import pdf_bytes, the_compiler
from thermobearing.report.pieces import Pieces
from thermobearing.report.template import document, on_paper
from thermobearing.report.workbook import workbook_bytes
from thermobearing.results.directory import (
    CERTIFICATE_HTML,
    CERTIFICATE_PDF,
    COMPARISON,
    LINK_TRIALS,
    LINKS,
    LOGO,
    MODES_FILE,
    PROPERTIES,
    REPORT_HTML,
    REPORT_PDF,
    SUMMARY,
    TITLE,
    WORKBOOK,
    new_sibling,
)
from thermobearing.results.saved import SavedResult

if TYPE_CHECKING:
    from thermobearing.loading import AnyResult

DOCUMENTS = (REPORT_HTML, REPORT_PDF, WORKBOOK, CERTIFICATE_HTML, CERTIFICATE_PDF)
WRITTEN = (*DOCUMENTS, TITLE, LOGO, PROPERTIES, LINKS, LINK_TRIALS, MODES_FILE)
# Packages whose `report.py` gives the content of the document of a command.
PACKAGES = {
    "cyclic": "cyclic",
    "bridge": "earthquake",
    "hybrid": "earthquake",
    "sequence": "sequences",
    "serve": "opensees",
    "identify": "identify",
    "validate": "validate",
    "design": "design",
    "bounds": "design",
    "lambda": "design",
    "study": "studies",
    "structures show": "structure",
    "structures import": "structure",
    "motions show": "motions",
    "motions make": "motions",
    "motions spectrum": "motions",
}
COMPARED = {"cyclic", "bridge", "hybrid"}  # commands with --compare
# Exceptions that edited files, or files of another version, raise.
UNFIT = (OSError, LookupError, TypeError, ValueError, AttributeError, AssertionError)


@checked
def make_report(
    result: "AnyResult | str | Path",
    directory: str | Path | None = None,
    *,
    title: TitleBlock | Mapping[str, str] | None = None,
    template: str | Path | None = None,
    html: bool = True,
    pdf: bool = True,
    workbook: bool = False,
    live: bool = True,
    certificate: bool = False,
) -> list[Path]:
    """Write report.html and report.pdf of a result into its directory.

    Nothing is run again, but a bridge: all motions at the ambient temperatures that govern, with
    rubber in the other state (virgin for tested), for the summary on the first page, and all runs
    with links in place of bearings, for links.txt.

    Parameters
    ----------
    result : a result, or the directory of one.
    directory : that a result was saved in; of a path not needed.
    title : title block (project, structure, client, author, checked, approved, number, date,
        revision, logo); missing values are those of report.toml in the directory.
    template : Markdown file that orders the pieces; None for that of the package.
    html : write report.html; without it report.pdf is not written either. All three formats need
        the extra `report`.
    pdf : write report.pdf too.
    workbook : write report.xlsx too.
    live : let report.html of a cyclic test or a bridge compute the analysis again in the browser,
        at other temperatures and strains; needs kernels for web pages (`make kernels`), without
        which the section is left out.
    certificate : write certificate.html and certificate.pdf of a calibration instead: one page to
        be signed.

    Returns
    -------
    list of Path : what was written.

    Raises
    ------
    InputError : there is no readable result there, title block or template is wrong, or what a
        format needs is not installed.
    OutputError : a file cannot be written; earlier ones are unchanged.

    Examples
    --------
    >>> import tempfile
    >>> import thermobearing as tb
    >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     saved = result.save(f"{folder}/out", figures=False)
    ...     files = make_report(saved, title={"project": "Bridge 12"}, pdf=False)
    ...     print(*(file.name for file in files))
    report.html
    """
    stated_title = (
        validated(TitleBlock, dict(title), "title") if isinstance(title, Mapping) else title
    )
    file = Path(template) if template is not None else None
    place = _report_place(result, directory)
    _check_place(place)
    title_file = place / TITLE
    block = (stated_title or TitleBlock()).over(
        read_title(title_file if is_file(title_file) else None)
    )
    # A path alone needs the readers of all results, which a result in memory does not import.
    loaded = _load(result) if isinstance(result, str | Path) else result
    if certificate:
        return _write_certificate(place, block, file, pdf=pdf)
    kinds = {"html": html, "pdf": pdf, "workbook": workbook, "live": live}
    return _report_of_result(loaded, place, block, file, **kinds)


def _report_of_result(
    result: "AnyResult",
    place: Path,
    block: TitleBlock,
    template: Path | None,
    *,
    html: bool,
    pdf: bool,
    workbook: bool,
    live: bool,
) -> list[Path]:
    """Write the documents of a result into a directory."""
    pieces = build_pieces(result, place)
    if html and live:
        pieces = replace(pieces, live=live_section(result))
    content = _title_files(block) | _headed(pieces, block)
    if html:
        content |= report_files(pieces, block, template, pdf=pdf)
    if workbook:
        from thermobearing.histories import histories_by_run

        content[WORKBOOK] = workbook_bytes(pieces, histories_by_run(result))
    return put_files(place, content)


def _headed(pieces: Pieces, block: TitleBlock) -> dict[str, bytes]:
    """Return the files of a report, the text for other programs with what it belongs to."""
    files = dict(pieces.files)
    if LINKS in files:
        entries = block.words() | dict(pieces.identity)
        head = "".join(f"{name}: {text}\n" for name, text in entries.items())
        files[LINKS] = f"{head}\n".encode() + files[LINKS]
    return files


def _load(path: str | Path) -> "AnyResult":
    """Return the result of a directory, whatever analysis it is of."""
    from thermobearing.loading import load_result

    return load_result(path)


def _write_certificate(
    place: Path, block: TitleBlock, template: Path | None, *, pdf: bool
) -> list[Path]:
    """Write the certificate of a calibration that is saved in a directory."""
    from thermobearing.identify.certificate import build_certificate

    saved = _load(place)
    if not isinstance(saved, SavedResult):
        raise InputError("only a calibration (`identify`) has a certificate", str(place))
    pieces = _dated(_consistent(lambda: build_certificate(saved), place), place)
    names = CERTIFICATE_HTML, CERTIFICATE_PDF
    files = report_files(pieces, block, template, pdf=pdf, names=names)
    return put_files(place, _title_files(block) | files)


def _report_place(result: "AnyResult | str | Path", directory: str | Path | None) -> Path:
    """Return the directory that documents go into."""
    if directory is not None:
        return Path(directory)
    if isinstance(result, SavedResult):
        return result.path
    if not isinstance(result, str | Path):
        raise InputError("save the result first, and give its directory")
    path = Path(result)
    return path.parent if is_file(path) else path  # result.nc of a directory stands for it


def build_pieces(result: "AnyResult", directory: Path) -> Pieces:
    """Return the content of the report of a result.

    It includes the comparison with earlier models and the date of the files in the directory.
    """
    return _dated(_consistent(lambda: _pieces(result, directory), directory), directory)


def _pieces(result: "AnyResult", directory: Path) -> Pieces:
    summary = result.summary if isinstance(result, SavedResult) else result.summary()
    command = str(summary["command"])
    if command in PACKAGES:
        module = import_module(f"thermobearing.{PACKAGES[command]}.report")
        pieces = cast(Pieces, module.build_pieces(result))
    else:
        pieces = pieces_of_saved(cast(SavedResult, result))
    if command in COMPARED and is_file(directory / COMPARISON):
        table, figures = comparison_pieces(directory)
        tables = {**pieces.tables, "comparison": table}
        pieces = replace(pieces, tables=tables, figures={**pieces.figures, **figures})
    return pieces


def _consistent(build: Callable[[], Pieces], directory: Path) -> Pieces:
    """Return the pieces; InputError if the files of the result do not belong together."""
    try:
        return build()
    except InputError:
        raise
    except UNFIT as error:
        raise InputError(
            "its files are inconsistent: they were changed, or are of another version "
            f"({type(error).__name__}: {error}); run its case again",
            str(directory),
        ) from None


def _dated(pieces: Pieces, directory: Path) -> Pieces:
    """Return the pieces with the date of the files of the result."""
    file = directory / SUMMARY
    if not is_file(file):
        return pieces
    day = datetime.fromtimestamp(file.stat().st_mtime, UTC).date()
    written = {"Date of the result's files": day.isoformat()}
    return replace(pieces, identity={**pieces.identity, **written})


# Files.


def _check_place(directory: Path) -> None:
    """Refuse a directory that no document can be written into, before one is made."""
    if not is_folder(directory):
        raise OutputError(f"{directory}: is not a directory")
    for folder in (directory.resolve(), directory.resolve().parent):
        if not os.access(folder, os.W_OK | os.X_OK):
            raise OutputError(f"{folder}: is not writable, so that no report can be written there")
    for name in WRITTEN:
        if is_folder(directory / name):
            raise OutputError(f"{directory / name}: is a directory; a report cannot replace it")


def report_files(
    pieces: Pieces,
    title: TitleBlock,
    template: Path | None = None,
    *,
    pdf: bool = True,
    names: tuple[str, str] = (REPORT_HTML, REPORT_PDF),
) -> dict[str, bytes | None]:
    """Return report.html and report.pdf (or other `names`), by name.

    Without `pdf`, a report.pdf that is there goes, since it would show another state.
    """
    check_packages()
    from thermobearing.report.html import html_page  # which imports these packages

    page = document(pieces, title.words(), title.logo_bytes(), template)
    if not pdf:
        return {names[0]: html_page(page).encode(), names[1]: None}
    the_compiler()  # before anything is drawn
    drawn_page = drawn(page)
    return {names[0]: html_page(drawn_page).encode(), names[1]: pdf_bytes(on_paper(drawn_page))}


def _title_files(title: TitleBlock) -> dict[str, bytes | None]:
    """Return the title block as files of a result directory; none where nothing is given."""
    if title == TitleBlock():
        return {TITLE: None, LOGO: None}
    logo = title.logo_bytes()
    saved_title = title.model_copy(update={"logo": LOGO if logo is not None else None})
    return {TITLE: saved_title.to_toml().encode(), LOGO: logo}


def keep_title(directory: Path, title: TitleBlock) -> None:
    """Keep a title block for a document that is made later."""
    if title != TitleBlock():
        put_files(directory, _title_files(title))


def put_files(directory: Path, content: Mapping[str, bytes | None]) -> list[Path]:
    """Put files into a directory, all of them or none; None takes one away.

    They are written next to the directory first: a process that is killed leaves nothing in it
    that is no result, and the next one takes away what it left.
    """
    final = directory.resolve()
    try:
        with new_sibling(final) as partial:
            for name, raw in content.items():
                if raw is not None:
                    write_through(partial / name, raw)
            _exchange(partial, final, list(content))
    except OSError as error:
        raise OutputError(
            f"{directory}: the report cannot be written: {error.strerror or error}; "
            "the earlier files are unchanged"
        ) from None
    return [directory / name for name in DOCUMENTS if content.get(name) is not None]


def _exchange(partial: Path, final: Path, names: list[str]) -> None:
    """Move new files over old ones; whatever stops it, the old ones come back."""
    earlier = partial / "earlier"
    earlier.mkdir()
    for name in names:
        if (final / name).exists():
            shutil.copy2(final / name, earlier / name)

    def _move(source: Path, name: str) -> None:
        if (source / name).exists():
            os.replace(source / name, final / name)
        else:
            (final / name).unlink(missing_ok=True)

    moved_names = []
    try:
        for name in names:
            moved_names.append(name)
            _move(partial, name)
    except BaseException:  # Ctrl-C too
        for name in moved_names:
            _move(earlier, name)
        raise
