"""A document as PDF: PDF/A-2a for archives and PDF/UA-1 for screen readers in one file.

The typst compiler (a wheel with fonts inside) sets `data/reports/report.typ`, which reads the
document as data: what a user wrote is never a part of the source, so that no name can be a
command.
"""

import json
import re
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, date, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any
from unicodedata import category

from thermobearing.border.errors import HIDDEN, InputError, printable
from thermobearing.border.library import data_path
from thermobearing.report.figures import drawn, missing_words
from thermobearing.report.layout import SEAM, laid_out
from thermobearing.report.pieces import Document, Paragraph

SOURCE = "report.typ"
STANDARDS = ["a-2a", "ua-1"]  # both in one file
OLDEST = (0, 15)  # of the compiler
NO_DATE = date(1980, 1, 1)  # of a document that nobody dated: PDF/A wants one
DATED = re.compile(r"\d{4}-\d{2}-\d{2}")
UNDRAWN = re.compile(r'the text `"(.+?)"` could not be displayed')


def pdf_bytes(document: Document) -> bytes:
    """The document as PDF/A-2a and PDF/UA-1; the same bytes for the same document.

    Parameters
    ----------
    document : what is written.

    Raises
    ------
    InputError : typst is not installed, or a picture or logo cannot be read.
    """
    the_compiler()  # before anything is drawn
    document = drawn(document)
    missing = _letters_without_font(_letters(document))
    spoken = document
    if missing:
        told = Paragraph(missing_words(sorted(missing), "its text"), "warning")
        spoken = replace(document, blocks=[told, *document.blocks])
    day = document_date(document)
    with tempfile.TemporaryDirectory(prefix="thermobearing-") as name:
        folder = Path(name)
        content = laid_out(spoken, folder) | {"date": [day.year, day.month, day.day]}
        text = json.dumps(_each_text(content, lambda text: _speakable(text, missing)))
        (folder / "document.json").write_text(text, encoding="utf-8")
        (folder / SOURCE).write_bytes(data_path("reports", SOURCE).read_bytes())
        return compiled(folder / SOURCE, day, system_fonts=not _shipped_fonts_do(document))


def compiled(source: Path, day: date, *, system_fonts: bool) -> bytes:
    """A PDF of a typst source."""
    typst = the_compiler()
    when = datetime(day.year, day.month, day.day, tzinfo=UTC)
    try:
        done = typst.compile(
            str(source),
            format="pdf",
            root=str(source.parent),
            ignore_system_fonts=not system_fonts,
            pdf_standards=STANDARDS,
            timestamp=when,
        )
    except typst.TypstError as error:
        raise InputError(f"the PDF cannot be made: {error.message}") from None
    return bytes(done)


def the_compiler() -> Any:
    """The typst compiler.

    Raises
    ------
    InputError : it is not installed, or too old for both standards in one file.
    """
    try:
        import typst

        old = tuple(map(int, version("typst").split(".")[:2])) < OLDEST
    except ImportError:
        old = True
    if old:
        raise InputError(
            'a PDF needs the typst compiler (0.15): pip install "thermobearing[report]"; '
            "`thermobearing report DIR --no-pdf` writes the HTML page alone"
        )
    return typst


def document_date(document: Document) -> date:
    """The day of a document: of its title block, else of the run; never that of its making."""
    told = [text for key, text in document.block.items() if key == "Date"]
    told += [text for key, text in document.identity.items() if "date" in key.lower()]
    for text in told:
        if found := DATED.search(text):
            try:
                return date.fromisoformat(found[0])
            except ValueError:
                continue
    return NO_DATE


def _speakable(text: str, missing: set[str]) -> str:
    """Text whose letters all have a font; codes stand for the others."""
    text = SEAM.join(map(printable, text.split(SEAM)))
    if not missing or text.isascii():
        return text
    return "".join(f"[U+{ord(mark):04X}]" if mark in missing else mark for mark in text)


def _letters(document: Document) -> set[str]:
    """The letters of a document that are not plain ones."""
    found: set[str] = set()

    def note(text: str) -> str:
        found.update(text)
        return text

    _each_text(laid_out(document, None), note)
    return {m for m in found if not (m.isascii() or m.isspace() or category(m) in HIDDEN)}


def _shipped_fonts_do(document: Document) -> bool:
    """Whether the fonts that come with the compiler have all letters of a document.

    Then no other is looked at, and every machine makes the same bytes.
    """
    return not _undrawn(_letters(document), system_fonts=False)


def _letters_without_font(letters: set[str]) -> set[str]:
    """Those of some letters that neither the compiler's fonts nor the machine's have."""
    missing = _undrawn(letters, system_fonts=False)
    return _undrawn(missing, system_fonts=True) if missing else missing


def _undrawn(letters: set[str], *, system_fonts: bool) -> set[str]:
    """Letters that the compiler has no font for: it refuses to write an archive with them."""
    # Letters for private use, or of no use yet, mean nothing in an archive whatever the font.
    missing = {mark for mark in letters if category(mark) in ("Co", "Cn")}
    typst = the_compiler()
    left = sorted(letters - missing)
    while left:
        quoted = json.dumps(" ".join(left), ensure_ascii=False)
        source = f'#set document(title: "x")\n#text(font: "Libertinus Serif", {quoted})'
        try:
            typst.compile(
                source.encode(),
                format="pdf",
                ignore_system_fonts=not system_fonts,
                pdf_standards=["ua-1"],
            )
        except typst.TypstError as error:
            found = set("".join(UNDRAWN.findall(error.diagnostic))) & set(left)
            if not found:
                return missing | set(left)
            missing |= found
            left = sorted(set(left) - found)
        else:
            break
    return missing


def _each_text(content: Any, change: Callable[[str], str]) -> Any:
    """The same content with every text changed."""
    if isinstance(content, str):
        return change(content)
    if isinstance(content, Mapping):
        return {key: _each_text(value, change) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_each_text(value, change) for value in content]
    return content
