"""A document as PDF: PDF/A-2a for archives and PDF/UA-1 for screen readers in one file.

The typst compiler (a wheel with fonts inside) sets `data/reports/report.typ`, which reads the
document as data: user text is never a part of the template, so that no name can be a
command.
"""

import json
import math
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import UTC, date, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple
from unicodedata import category

from thermobearing.border.errors import HIDDEN, InputError, printable
from thermobearing.border.library import data_path
from thermobearing.border.title import logo_kind
from thermobearing.quantities.tables import Table
from thermobearing.report.figures import drawn, picture_size
from thermobearing.report.markdown import Data, check_packages, split_runs
from thermobearing.report.pieces import (
    Block,
    Bullets,
    Document,
    FigureBlock,
    Heading,
    Paragraph,
    ReportFigure,
    Signatures,
    TableBlock,
    column_letters,
    marked_note,
)
from thermobearing.results.drawing import missing_letters

SOURCE = "report.typ"
STANDARDS = ["a-2a", "ua-1"]  # both in one file
OLDEST = (0, 15)  # of the compiler
NO_DATE = date(1980, 1, 1)  # of a document that nobody dated: PDF/A wants one
DATED = re.compile(r"\d{4}-\d{2}-\d{2}")
UNDRAWN = re.compile(r'the text `"(.+?)"` could not be displayed')
SEAM = "\N{ZERO WIDTH SPACE}"  # where a long word may be broken


def pdf_bytes(document: Document) -> bytes:
    """Return the document as PDF/A-2a and PDF/UA-1; the same bytes for the same document."""
    the_compiler()  # before anything is drawn
    document = drawn(document)
    letters = _letters(document)
    # First with the fonts of the compiler alone; only letters that they lack are looked for in the
    # fonts of the machine.
    foreign = _undrawn(letters, system_fonts=False)
    missing = _undrawn(foreign, system_fonts=True) if foreign else foreign
    annotated = document
    if missing:
        note = Paragraph(missing_letters(missing, "its text"), "warning")
        annotated = replace(document, blocks=[note, *document.blocks])
    day = _document_date(document)
    with tempfile.TemporaryDirectory(prefix="thermobearing-") as name:
        folder = Path(name)
        content = _laid_out(annotated, folder) | {"date": [day.year, day.month, day.day]}
        text = json.dumps(_each_text(content, lambda text: _speakable(text, missing)))
        (folder / "document.json").write_text(text, encoding="utf-8")
        (folder / SOURCE).write_bytes(data_path("reports", SOURCE).read_bytes())
        # Without foreign letters no other font is looked at: every machine makes the same bytes.
        return _compiled(folder / SOURCE, day, system_fonts=bool(foreign))


def the_compiler() -> Any:
    """Return the typst compiler; InputError where it or another package is not installed."""
    check_packages()
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


def _compiled(source: Path, day: date, *, system_fonts: bool) -> bytes:
    typst = the_compiler()
    try:
        pdf = typst.compile(
            str(source),
            format="pdf",
            root=str(source.parent),
            ignore_system_fonts=not system_fonts,
            pdf_standards=STANDARDS,
            timestamp=datetime(day.year, day.month, day.day, tzinfo=UTC),
        )
    except typst.TypstError as error:
        raise InputError(f"the PDF cannot be made: {error.message}") from None
    return bytes(pdf)


def _document_date(document: Document) -> date:
    """Return the day of the title block, else of the run; never that of the making."""
    texts = [document.block.get("Date", "")]
    texts += [text for key, text in document.identity.items() if "date" in key.lower()]
    for text in texts:
        if match := DATED.search(text):
            try:
                return date.fromisoformat(match[0])
            except ValueError:
                continue
    return NO_DATE


# Letters.
def _speakable(text: str, missing: set[str]) -> str:
    """Return text whose letters all have a font; codes stand for the others."""
    text = SEAM.join(map(printable, text.split(SEAM)))
    if not missing or text.isascii():
        return text
    return "".join(f"[U+{ord(mark):04X}]" if mark in missing else mark for mark in text)


def _letters(document: Document) -> set[str]:
    """Return the letters of a document that are not plain ones."""
    letters: set[str] = set()
    _each_text(_laid_out(document, None), lambda text: letters.update(text) or text)  # type: ignore[func-returns-value]
    return {m for m in letters if not (m.isascii() or m.isspace() or category(m) in HIDDEN)}


def _undrawn(letters: set[str], *, system_fonts: bool) -> set[str]:
    """Return letters that the compiler has no font for: it refuses to archive them."""
    # Letters for private use, or of no use yet, mean nothing in an archive whatever the font.
    missing = {mark for mark in letters if category(mark) in ("Co", "Cn")}
    typst = the_compiler()
    # The compiler names the missing letters of one text at a time: repeat without them until it
    # accepts the rest.
    while remaining := sorted(letters - missing):
        quoted = json.dumps(" ".join(remaining), ensure_ascii=False)
        source = f'#set document(title: "x")\n#text(font: "Libertinus Serif", {quoted})'
        look = {"format": "pdf", "pdf_standards": ["ua-1"], "ignore_system_fonts": not system_fonts}
        try:
            typst.compile(source.encode(), **look)
        except typst.TypstError as error:
            undrawn = set("".join(UNDRAWN.findall(error.diagnostic))) & set(remaining)
            if not undrawn:
                return letters
            missing |= undrawn
        else:
            break
    return missing


def _each_text(content: Any, change: Callable[[str], str]) -> Any:
    """Return the same content with every text changed."""
    if isinstance(content, str):
        return change(content)
    if isinstance(content, Mapping):
        return {key: _each_text(value, change) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_each_text(value, change) for value in content]
    return content


# Blocks as data for the compiler.
UPRIGHT, TURNED = (170.0, 222.0), (267.0, 156.0)  # room: width, height [mm], as report.typ has it
LONG_BOX = 2500  # letters of a box that may go over two pages
SMALL_PRINT = 0.75  # a picture that must be made smaller than this is shown on a turned page
GAIN = 1.15  # by which it must be larger there


def _laid_out(document: Document, folder: Path | None) -> Data:
    """Return what the typst source reads; pictures are written into a folder, if there is one."""
    blocks: list[Data] = []
    level, numbers = 0, Counter[type]()
    for number, block in enumerate(document.blocks):
        if isinstance(block, Heading):  # one level below the one before at most
            level = min(block.level, level + 1)
            blocks.append({"kind": "heading", "level": level, "runs": split_runs(block.text)})
        else:
            parts = _data(block, f"figure-{number}", folder, upright=document.close)
            numbers[type(block)] += 1
            # Parts of a table share its number, which is that in the page.
            blocks += [part | {"number": numbers[type(block)]} for part in parts]
    title = document.block
    revision = f"revision {title['Revision']}" if "Revision" in title else ""
    return {
        "title": document.title,
        "block": [list(item) for item in title.items()],
        "author": title.get("Author", ""),
        "logo": _picture_file(document.logo, "logo", folder) if document.logo else "",
        "head": [
            title.get("Project", document.title),
            ", ".join(filter(None, [title.get("Document", ""), revision])),
        ],
        "foot": document.foot,
        "close": document.close,
        "contents": sum(item["kind"] == "heading" for item in blocks) > 2,
        "blocks": _turned_together(blocks),
    }


def _data(block: Block, name: str, folder: Path | None, *, upright: bool) -> list[Data]:
    """Return a block as data; a table in several parts where its columns do not fit.

    `upright` keeps tables from being turned.
    """
    match block:
        case Paragraph():
            runs = split_runs(block.text)
            return [{"kind": "paragraph", "box": block.kind, "runs": runs, "unbroken": True}]
        case Bullets():
            items = [split_runs(item) for item in block.items]
            unbroken = sum(map(len, block.items)) < LONG_BOX
            return [{"kind": "bullets", "box": block.kind, "items": items, "unbroken": unbroken}]
        case TableBlock():
            return _table(block.table, upright=upright)
        case FigureBlock():
            return _figure(block.figure, name, folder)
        case Signatures():
            return [{"kind": "signatures", "signers": [asdict(s) for s in block.signers]}]
    raise AssertionError(block)


def _figure(figure: ReportFigure, name: str, folder: Path | None) -> list[Data]:
    """Return a picture, as large as it is or as fits; nothing where it is not drawn yet."""
    if figure.image is None:
        return []
    width, height = picture_size(figure.image)
    upright, across = (min(1.0, room[0] / width, room[1] / height) for room in (UPRIGHT, TURNED))
    turned = upright < SMALL_PRINT and across > GAIN * upright
    file = _picture_file(figure.image, name, folder)
    size = {"width": round(width * (across if turned else upright), 2), "turned": turned}
    words = {"caption": figure.caption, "alt": figure.alt or figure.caption}
    return [{"kind": "figure", "file": file, **words, **size}]


def _picture_file(image: bytes, name: str, folder: Path | None) -> str:
    """Return the name of the file that a picture is put into."""
    file = f"{name}.{logo_kind(image) or 'png'}"
    if folder is not None:
        (folder / file).write_bytes(image)
    return file


def _turned_together(blocks: Sequence[Data]) -> list[Data]:
    """Return blocks with turned ones after the upright text and tables that follow them.

    So no page before a turned one stays empty. They stay before the next heading or figure; the
    headings with nothing upright below them move along.
    """
    arranged: list[Data] = []
    turned: list[Data] = []

    def _put() -> None:
        if not turned:
            return
        headings: list[Data] = []
        while arranged and arranged[-1]["kind"] == "heading":
            headings.insert(0, arranged.pop())
        if not (arranged and arranged[-1]["kind"] == "turned"):
            arranged.append({"kind": "turned", "blocks": []})
        arranged[-1]["blocks"] += [*headings, *turned]
        turned.clear()

    for block in blocks:
        if block["kind"] in ("heading", "figure"):
            _put()
        (turned if block.get("turned") else arranged).append(block)
    _put()
    return arranged


# Tables: as large as fits, upright or turned, and in parts where even a turned page is too small.
SIZES = (8.5, 8.0, 7.5, 7.0)  # of letters [pt], upright; below these a page is turned
TURNED_SIZES = (*SIZES, 6.5, 6.0)
SIZE_OF_PARTS = 6.5
POINT = 25.4 / 72.0  # [mm]
GAP = 3.2  # between columns [mm]
LETTER, ROUNDING = 0.54, 0.05  # mean width of a letter, of its size; of a number of letters


class Part(NamedTuple):
    """Columns of a table that stand side by side: widths [mm], size of letters [pt]."""

    places: list[int]
    widths: list[float]
    size: float
    turned: bool

    def broken(self, text: str, column: int) -> str:
        """Return the text of a column with seams after signs, and in words that are too long."""
        room = self.widths[self.places.index(column)] - GAP
        count = max(3, int(room / (LETTER * POINT * self.size) + ROUNDING))

        def _seamed(match: re.Match[str]) -> str:
            word = match[0]
            if len(word) <= count:
                return word
            # After signs such as "/" and "_" first; what is still too long, anywhere.
            parts = re.findall(r"[^/\\_.,;:=-]*[/\\_.,;:=-]?", word)
            return SEAM.join(p[k : k + count] for p in parts for k in range(0, len(p), count))

        return re.sub(r"\S+", _seamed, text)


def _table(table: Table, *, upright: bool) -> list[Data]:
    """Return a table as text, in parts that fit a page in width, each with the key columns."""
    cells, columns = table.texts(), table.columns
    numbers = table.numeric()
    parts = _fitted(column_letters(table, cells), table.keys, upright=upright)
    note = marked_note(table)
    blocks = []
    for number, part in enumerate(parts, 1):
        marked = [
            [row, part.places.index(k)] for row, k in sorted(table.marked) if k in part.places
        ]
        rows = [
            [r[k] if k in numbers else part.broken(r[k], k) for k in part.places] for r in cells
        ]
        blocks.append(
            {
                "kind": "table",
                "caption": table.caption + f" ({number} of {len(parts)})" * (len(parts) > 1),
                "note": note if number == len(parts) else "",
                "heads": [[columns[k].head, columns[k].unit] for k in part.places],
                "rows": rows,
                "right": [k in numbers for k in part.places],
                "marked": marked,
                "verdicts": columns[part.places[-1]].head == "Verdict",
                "widths": part.widths,
                "size": part.size,
                "turned": part.turned,
            }
        )
    return blocks


def _fitted(letters: Sequence[tuple[int, int]], keys: int, *, upright: bool = False) -> list[Part]:
    """Return columns in parts that fit a page, as large as can be; all upright on request."""
    all_places = list(range(len(letters)))

    def _total(places: Sequence[int], size: float) -> float:
        return sum(letters[k][0] * LETTER * POINT * size + GAP for k in places)

    def _part(places: list[int], room: float, size: float) -> Part:
        """Give each column what it needs, and of what is left a share of what it would like."""
        letter, left = LETTER * POINT * size, room - _total(places, size)
        wanted = sum(letters[k][1] - letters[k][0] for k in places) * letter
        share = min(1.0, left / wanted) if wanted > 0.0 else 0.0
        ends = [letters[k] for k in places]
        widths = [(least + share * (preferred - least)) * letter + GAP for least, preferred in ends]
        # Rounded down: the sum of rounded widths must not exceed the page.
        widths = [math.floor(100.0 * width) / 100.0 for width in widths]
        return Part(places, widths, size, room == TURNED[0])

    # Upright at the largest size of letters that fits, then turned, then in parts.
    widest = UPRIGHT[0] if upright else TURNED[0]
    for room, sizes in ((UPRIGHT[0], SIZES), (widest, TURNED_SIZES)):
        for size in sizes:
            if _total(all_places, size) <= room:
                return [_part(all_places, room, size)]
    key_places = all_places[: min(keys, len(letters) - 1)]
    # Each part repeats the key columns, without which its rows could not be read, and has one more
    # column at least, however wide.
    groups = [[*key_places]]
    for column in all_places[len(key_places) :]:
        is_full = _total([*groups[-1], column], SIZE_OF_PARTS) > widest
        if is_full and len(groups[-1]) > len(key_places):
            groups.append([*key_places])
        groups[-1].append(column)
    return [_part(places, widest, SIZE_OF_PARTS) for places in groups]
