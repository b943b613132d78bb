"""Blocks of a report as data for the typesetter: columns, inline text, figures."""

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt

from thermobearing.report.figures import picture_size
from thermobearing.report.pieces import (
    Block,
    Bullets,
    Check,
    ChecksBlock,
    Column,
    Document,
    FigureBlock,
    Heading,
    Paragraph,
    ReportFigure,
    ReportTable,
    TableBlock,
)
from thermobearing.report.title import logo_kind

UPRIGHT, TURNED = (170.0, 222.0), (267.0, 156.0)  # room: width, height [mm]
UPRIGHT_WIDTH, TURNED_WIDTH = UPRIGHT[0], TURNED[0]
SIZES = (8.5, 8.0, 7.5, 7.0)  # of letters [pt], upright; below these a page is turned
TURNED_SIZES = (*SIZES, 6.5, 6.0)
# Widths of letters, of their size; bold ones of a head are wider.
NARROW, FIGURE, WIDE, CAPITAL, FULL, BOLD = 0.31, 0.5, 0.82, 0.68, 1.05, 1.08
POINT = 25.4 / 72.0  # [mm]
GAP = 3.2  # between columns [mm]
LONGEST_WORD = 12.0  # a longer one (a path, a digest) may be broken; of the size of letters
ROUNDING = 0.01  # of widths, of the size of letters
SHORT = 7.0  # such a text is not broken between words either
SEAM = "\N{ZERO WIDTH SPACE}"


@dataclass(frozen=True)
class Columns:
    """Columns of a table that stand beside each other.

    Attributes
    ----------
    places : their numbers in the table.
    widths : [mm].
    size : of the letters [pt].
    turned : whether they need a turned page.
    """

    places: list[int]
    widths: list[float]
    size: float
    turned: bool

    def broken(self, text: str, column: int) -> str:
        """Text of a column with places where long words may be broken."""
        room = self.widths[self.places.index(column)] - GAP
        most = room / (POINT * self.size) + ROUNDING
        return re.sub(r"\S+", lambda word: _seamed(word[0], most), text)


def _seamed(word: str, most: float) -> str:
    """A word that may be broken after signs, and else wherever it is too long."""
    if _width(word) <= most:
        return word
    parts = re.findall(r"[^/\\_.,;:=-]*[/\\_.,;:=-]?", word)
    count = max(3, int(most / CAPITAL))
    pieces = [part[k : k + count] for part in parts for k in range(0, len(part), count)]
    return SEAM.join(pieces)


def fitted(
    heads: Sequence[str], cells: Sequence[Sequence[str]], numbers: set[int], keys: int
) -> list[Columns]:
    """Columns in parts that fit a page, as large as can be.

    Parameters
    ----------
    heads : with units.
    cells : rows of text.
    numbers : columns of numbers, which are never broken.
    keys : leading columns that each part begins with.
    """
    everything = list(range(len(heads)))
    least = [_least(heads[k], [row[k] for row in cells], k in numbers) for k in everything]
    most = [max([least[k], *(_width(row[k]) for row in cells)]) for k in everything]
    for room, sizes, turned in ((UPRIGHT_WIDTH, SIZES, False), (TURNED_WIDTH, TURNED_SIZES, True)):
        for size in sizes:
            if _total(least, size) <= room:
                return [Columns(everything, _shared(least, most, room, size), size, turned)]
    return _in_parts(least, most, min(keys, len(heads) - 1))


def _in_parts(least: list[float], most: list[float], keys: int) -> list[Columns]:
    """More columns than even a turned page holds: parts below each other."""
    size = TURNED_SIZES[-2]
    first = list(range(keys))
    groups: list[list[int]] = [[]]
    for column in range(keys, len(least)):
        together = [least[k] for k in (*first, *groups[-1], column)]
        if groups[-1] and _total(together, size) > TURNED_WIDTH:
            groups.append([])
        groups[-1].append(column)
    parts = []
    for group in groups:
        places = [*first, *group]
        few, many = [least[k] for k in places], [most[k] for k in places]
        parts.append(Columns(places, _shared(few, many, TURNED_WIDTH, size), size, True))
    return parts


def _total(widths: Sequence[float], size: float) -> float:
    """Width of columns [mm] from widths of their texts, of the size of letters."""
    return sum(widths) * POINT * size + GAP * len(widths)


def _shared(least: list[float], most: list[float], room: float, size: float) -> list[float]:
    """Widths [mm]: what each needs at least, and of what is left what it would like."""
    letter = POINT * size
    left = room - _total(least, size)
    wanted = [(high - low) * letter for low, high in zip(least, most, strict=True)]
    share = min(1.0, left / sum(wanted)) if sum(wanted) > 0.0 else 0.0
    low = [width * letter + GAP for width in least]
    return [round(width + share * more, 2) for width, more in zip(low, wanted, strict=True)]


def _width(text: str) -> float:
    """Width of a line, of the size of its letters."""
    return sum(map(_letter, text))


def _letter(mark: str) -> float:
    if mark in "ijlt.,;:'|!()[]-/ ":
        return NARROW
    if mark in "mwMW%@":
        return WIDE
    if ord(mark) > 0x2E7F:  # Chinese and Japanese
        return FULL
    return CAPITAL if mark.isupper() else FIGURE


def _least(head: str, cells: Sequence[str], number: bool) -> float:
    """What a column needs: its longest word, or its longest number."""
    told = [BOLD * _width(word) for word in head.split(" ")]
    told += [_width(text) for text in cells] if number else [_words(text) for text in cells]
    return max([1.5, *told])


def _words(text: str) -> float:
    """The longest word of a text; short texts stay on a line."""
    whole = _width(text)
    if whole <= SHORT:
        return whole
    return max(min(_width(word), LONGEST_WORD) for word in text.split() or [""])


@dataclass(frozen=True)
class Run:
    """Letters that look alike; `address` of a link."""

    text: str
    bold: bool = False
    italic: bool = False
    code: bool = False
    address: str = ""


@cache
def _parser() -> MarkdownIt:
    return MarkdownIt("zero").enable(["emphasis", "backticks", "link", "escape"])


def split_runs(text: str) -> list[Run]:
    """The runs of a line.

    Examples
    --------
    >>> [run.text for run in split_runs("as *strong* as `$x$`")]
    ['as ', 'strong', ' as ', '$x$']
    """
    found: list[Run] = []
    bold, italic, address = 0, 0, ""
    for block in _parser().parseInline(text):
        for token in block.children or []:
            bold += token.nesting if token.tag == "strong" else 0
            italic += token.nesting if token.tag == "em" else 0
            if token.tag == "a":
                address = str(token.attrs["href"]) if token.nesting > 0 else ""
            elif token.content:
                code = token.type == "code_inline"
                found.append(Run(token.content, bold > 0, italic > 0, code, address))
            elif token.type in ("softbreak", "hardbreak"):
                found.append(Run(" ", bold > 0, italic > 0, False, address))
    return found


# Room for a picture [mm], upright and on a turned page; `data/reports/report.typ` has the margins.
LONG_BOX = 2500  # letters of a box that may go over two pages
SMALL_PRINT = 0.75  # a picture that must be made smaller than this is looked at on a turned page
GAIN = 1.15  # by which it must be larger there
UNTESTED = "beyond what the bearing was tested at"
CHECK_COLUMNS = (
    *(Column("Check"), Column("Value"), Column("Limit"), Column("Unit")),
    *(Column("Source of the limit"), Column("Verdict")),
)
UNBROKEN = "\N{NO-BREAK SPACE}"
Data = dict[str, Any]


def laid_out(document: Document, folder: Path | None) -> Data:
    """What the typst source reads; pictures are written into a folder, if there is one."""
    blocks: list[Data] = []
    for number, block in enumerate(document.blocks):
        blocks += _data(block, f"figure-{number}", folder)
    _without_skipped_levels(blocks)
    return {
        "title": document.title,
        "block": [list(item) for item in document.block.items()],
        "author": document.block.get("Author", ""),
        "logo": _picture_file(document.logo, "logo", folder) if document.logo else "",
        "head": [document.block.get("Project", document.title), _number(document)],
        "foot": foot(document),
        "contents": sum(item["kind"] == "heading" for item in blocks) > 2,
        "blocks": _turned_together(blocks),
    }


def foot(document: Document) -> str:
    """Program and input, short: what tells one print-out from another."""
    told = document.identity.items()
    version = next((v for k, v in told if "version" in k.lower() or "program" in k.lower()), "")
    version = version if version.startswith("thermobearing") else f"thermobearing {version}"
    digest = next((v for k, v in told if "hash" in k.lower() or "sha" in k.lower()), "")
    return version.strip() + (f" \N{MIDDLE DOT} input {digest[:12]}" if digest else "")


def _number(document: Document) -> str:
    number, revision = (document.block.get(key, "") for key in ("Document", "Revision"))
    said = [number, f"revision {revision}" if revision else ""]
    return ", ".join(word for word in said if word)


def _data(block: Block, name: str, folder: Path | None) -> list[Data]:
    """A block as data; a table in several parts where its columns do not fit."""
    if isinstance(block, Heading):
        return [{"kind": "heading", "level": block.level, "runs": _runs(block.text)}]
    if isinstance(block, Paragraph):
        return [{"kind": "paragraph", "box": block.kind, "runs": _runs(block.text), "whole": True}]
    if isinstance(block, Bullets):
        items = [_runs(item) for item in block.items]
        whole = sum(map(len, block.items)) < LONG_BOX
        return [{"kind": "bullets", "box": block.kind, "items": items, "whole": whole}]
    if isinstance(block, TableBlock):
        return _table(block.table)
    if isinstance(block, ChecksBlock):
        return _checks(block.checks)
    assert isinstance(block, FigureBlock)
    return _figure(block.figure, name, folder)


def _runs(text: str) -> list[Data]:
    return [asdict(run) for run in split_runs(text)]


def _figure(figure: ReportFigure, name: str, folder: Path | None) -> list[Data]:
    """A picture, as large as it is or as fits; nothing where only a plot is."""
    told = {"kind": "figure", "caption": figure.caption, "alt": figure.alt or figure.caption}
    if figure.image is None:
        moving = {"kind": "paragraph", "box": "", "whole": True}
        return [
            moving | {"runs": [asdict(Run(f"{figure.caption} (in the HTML page).", italic=True))]}
        ]
    width, height = picture_size(figure.image)
    upright = min(1.0, UPRIGHT[0] / width, UPRIGHT[1] / height)
    across = min(1.0, TURNED[0] / width, TURNED[1] / height)
    turned = upright < SMALL_PRINT and across > GAIN * upright
    file = _picture_file(figure.image, name, folder)
    size = width * (across if turned else upright)
    return [told | {"file": file, "width": round(size, 2), "turned": turned}]


def _picture_file(image: bytes, name: str, folder: Path | None) -> str:
    """Name of the file that a picture is put into."""
    file = f"{name}.{logo_kind(image) or 'png'}"
    if folder is not None:
        (folder / file).write_bytes(image)
    return file


def _checks(checks: Sequence[Check]) -> list[Data]:
    number = Column("", "", ".4g")
    rows = []
    for check in checks:
        sign = "\N{GREATER-THAN OR EQUAL TO}" if check.lower else "\N{LESS-THAN OR EQUAL TO}"
        limit = number.text(check.limit)
        told = f"{sign} {limit}" if limit else ""
        value = number.text(check.value)
        rows.append((check.what, value, told, check.unit, check.source, check.verdict))
    table = ReportTable("Checks", CHECK_COLUMNS, rows)
    return [part | {"verdicts": True} for part in _table(table, right=(1, 2))]


def _table(table: ReportTable, right: Sequence[int] = ()) -> list[Data]:
    """A table as text, in parts that fit a page in width; each part begins with the key columns."""
    cells = [
        [column.text(value) for column, value in zip(table.columns, row, strict=True)]
        for row in table.rows
    ]
    numbers = {k for k in range(len(table.columns)) if _is_numbers(table, k)} | set(right)
    heads = [(column.head, column.unit) for column in table.columns]
    parts = fitted([_whole_head(*head) for head in heads], cells, numbers, table.keys)
    note = table.note or (f"Marked: {UNTESTED}." if table.marked else "")
    found = []
    for number, part in enumerate(parts):
        found.append(
            {
                "kind": "table",
                "caption": table.caption + (f" ({number + 1} of {len(parts)})" * (len(parts) > 1)),
                "note": note if number == len(parts) - 1 else "",
                "heads": [list(heads[k]) for k in part.places],
                "rows": [
                    [row[k] if k in numbers else part.broken(row[k], k) for k in part.places]
                    for row in cells
                ],
                "right": [k in numbers for k in part.places],
                "marked": [
                    [row, part.places.index(column)]
                    for row, column in sorted(table.marked)
                    if column in part.places
                ],
                "widths": part.widths,
                "size": part.size,
                "turned": part.turned,
                "verdicts": False,
            }
        )
    return found


def _whole_head(head: str, unit: str) -> str:
    """A head with its unit, which is not broken."""
    return f"{head} [{unit.replace(' ', UNBROKEN)}]" if unit else head


def _is_numbers(table: ReportTable, column: int) -> bool:
    """Whether a column holds numbers, and so stands to the right."""
    values = [row[column] for row in table.rows if row[column] is not None]
    return bool(values) and not any(isinstance(value, str | bool) for value in values)


def _without_skipped_levels(blocks: list[Data]) -> None:
    """Headings one level below the one before at most: a screen reader steps through them."""
    before = 0
    for block in blocks:
        if block["kind"] == "heading":
            block["level"] = before = min(block["level"], before + 1)


def _turned_together(blocks: Sequence[Data]) -> list[Data]:
    """What needs turned pages in groups, with the headings that stand before it."""
    found: list[Data] = []
    for block in blocks:
        if not block.get("turned"):
            found.append(block)
            continue
        headings: list[Data] = []
        while found and found[-1]["kind"] == "heading":
            headings.insert(0, found.pop())
        if not (found and found[-1]["kind"] == "turned"):
            found.append({"kind": "turned", "blocks": []})
        found[-1]["blocks"] += [*headings, block]
    return found
