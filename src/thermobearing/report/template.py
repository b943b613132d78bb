"""A template: Markdown whose lines in braces are replaced by the pieces of a result.

A line is a heading (`#`), a list item (`- `), text of a paragraph, or one placeholder:

    {{ question }}  {{ answer }}  {{ inputs }}  {{ checks }}  {{ validity }}  {{ books }}
    {{ assumptions }}  {{ warnings }}  {{ identity }}
    {{ table NAME }}  {{ figure NAME }}      a piece by its name
    {{ tables }}  {{ figures }}              all that are not called by name

Names of pieces that a result does not always have end with a question mark: `{{ table lead? }}`.
A heading under which nothing stands is left out.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from thermobearing.border.errors import InputError, closest
from thermobearing.border.library import data_path
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_JUDGED,
    PASSED,
    Block,
    Bullets,
    Check,
    ChecksBlock,
    Column,
    Document,
    FigureBlock,
    Heading,
    Paragraph,
    Pieces,
    ReportFigure,
    ReportTable,
    TableBlock,
)
from thermobearing.tables.text import read_text

PLACEHOLDER = re.compile(r"\{\{\s*(\w+)(?:\s+([\w.-]+)(\?)?)?\s*\}\}")
HEADING = re.compile(r"(#{1,3})\s+(.+)")
DEFAULTS = data_path("reports")
BUT_FOR_NOTES = (
    "But for the following, nothing left the range that the parameters were identified in."
)
VALID = "Nothing left the range that the parameters were identified in."


def default_template(command: str) -> Path:
    """The template of the package for a command; that of all where it has none of its own.

    Parameters
    ----------
    command : such as "bridge".

    Examples
    --------
    >>> default_template("bridge").suffix
    '.md'
    """
    own = DEFAULTS / f"{command}.md"
    return own if own.is_file() else DEFAULTS / "any.md"


def arranged(pieces: Pieces, path: str | Path | None = None) -> list[Block]:
    """The pieces of a result in the order of a template.

    Parameters
    ----------
    pieces : of the result.
    path : of a template; None for that of the package.

    Returns
    -------
    list of Block : in reading order.

    Raises
    ------
    InputError : it cannot be read, or names a piece that the result does not have.

    Examples
    --------
    >>> pieces = Pieces("cyclic", "A test", "How stiff?", ["1.2 MPa."])
    >>> [type(block).__name__ for block in arranged(pieces)][:4]
    ['Heading', 'Paragraph', 'Heading', 'Bullets']
    """
    file = default_template(pieces.command) if path is None else Path(path)
    blocks: list[Block] = []
    faults: list[str] = []
    text = read_text(file)
    called = {(m[1], m[2]) for m in PLACEHOLDER.finditer(text) if m[2]}
    for number, line in enumerate(text.splitlines(), 1):
        try:
            blocks += _blocks_of_line(line.strip(), pieces, called)
        except InputError as error:
            faults.append(f"line {number}: {error}")
    if faults:
        raise InputError(faults, str(file))
    return _without_empty_headings(_joined(blocks))


def _blocks_of_line(line: str, pieces: Pieces, called: set[tuple[str, str]]) -> list[Block]:
    """What stands for a line of a template; an empty line ends a paragraph."""
    if heading := HEADING.fullmatch(line):
        return [Heading(len(heading[1]), heading[2])]
    if line.startswith("- "):
        return [Bullets([line[2:].strip()])]
    if placed := PLACEHOLDER.fullmatch(line):
        return list(_placed(placed[1], placed[2], bool(placed[3]), pieces, called))
    if "{{" in line:
        raise InputError("a placeholder stands on a line of its own, such as {{ tables }}")
    return [Paragraph(line)]


def _placed(
    word: str, name: str | None, optional: bool, pieces: Pieces, called: set[tuple[str, str]]
) -> Iterator[Block]:
    """The blocks of a placeholder."""
    if name is None:
        if word in ("tables", "figures"):
            held = getattr(pieces, word)
            rest = [n for n in held if (word[:-1], n) not in called]
            yield from (_block(word[:-1], n, held[n]) for n in rest)
        elif word in WHOLE:
            yield from WHOLE[word](pieces)
        else:
            known = [*WHOLE, "tables", "figures", "table NAME", "figure NAME"]
            raise InputError(f'no placeholder "{word}"{_nearest(word, known)}')
    elif word in ("table", "figure"):
        held = getattr(pieces, f"{word}s")
        if name in held:
            yield _block(word, name, held[name])
        elif not optional:
            raise InputError(
                f'this result has no {word} "{name}"{_nearest(name, held)}; '
                f'write "{name}?" where it may be missing'
            )
    else:
        raise InputError(f'no placeholder "{word} {name}": it is table NAME or figure NAME')


def _nearest(name: str, known: Mapping[str, object] | Sequence[str]) -> str:
    """What was perhaps meant, and what there is."""
    there = ", ".join(known) or "none"
    return f"{closest(name, known)} (there is: {there})"


def _block(word: str, name: str, piece: object) -> Block:
    if word == "table":
        assert isinstance(piece, ReportTable)
        return TableBlock(name, piece)
    assert isinstance(piece, ReportFigure)
    return FigureBlock(name, piece)


def _checks(checks: Sequence[Check]) -> list[Block]:
    """Checks by severity: what is exceeded comes first, then what is not judged."""
    order = (EXCEEDED, NOT_JUDGED, PASSED)
    ranked = sorted(checks, key=lambda check: order.index(check.verdict))
    return [ChecksBlock(ranked)] if ranked else []


def _validity(pieces: Pieces) -> list[Block]:
    notes = _listed(pieces.notes)
    if pieces.validity_unknown:
        return [Paragraph(pieces.validity_unknown, "warning"), *notes]
    if pieces.validity:
        return [Bullets(pieces.validity, "warning"), *notes]
    return [Paragraph(BUT_FOR_NOTES if notes else VALID), *notes]


def _identity(pieces: Pieces) -> list[Block]:
    if not pieces.identity:
        return []
    columns = [Column("What"), Column("Value")]
    rows = list(pieces.identity.items())
    return [TableBlock("identity", ReportTable("To make this result again", columns, rows))]


def _listed(items: Sequence[str], kind: str = "") -> list[Block]:
    return [Bullets(items, kind)] if items else []


WHOLE: Mapping[str, Callable[[Pieces], list[Block]]] = {
    "question": lambda pieces: [Paragraph(pieces.question)],
    "answer": lambda pieces: _listed(pieces.answer, "answer"),
    "inputs": lambda pieces: [TableBlock(name, t) for name, t in pieces.inputs.items()],
    "checks": lambda pieces: _checks(pieces.checks),
    "validity": _validity,
    "books": lambda pieces: [TableBlock("books", pieces.books)] if pieces.books else [],
    "assumptions": lambda pieces: _listed(pieces.assumptions),
    "warnings": lambda pieces: _listed(pieces.warnings, "warning"),
    "identity": _identity,
}


def _joined(blocks: Sequence[Block]) -> list[Block]:
    """Lines of one paragraph, and items of one list, put together; empty lines taken out."""
    found: list[Block] = []
    parted = True
    for block in blocks:
        if isinstance(block, Paragraph) and not block.text:
            parted = True
            continue
        last = found[-1] if found and not parted else None
        if isinstance(block, Paragraph) and isinstance(last, Paragraph) and not block.kind:
            found[-1] = Paragraph(f"{last.text} {block.text}", last.kind)
        elif isinstance(block, Bullets) and isinstance(last, Bullets) and last.kind == block.kind:
            found[-1] = Bullets([*last.items, *block.items], block.kind)
        else:
            found.append(block)
        parted = isinstance(block, Heading)
    return found


def _without_empty_headings(blocks: Sequence[Block]) -> list[Block]:
    """Headings that have something under them."""
    found: list[Block] = []
    for block in reversed(blocks):
        following = found[-1] if found else None
        empty = isinstance(block, Heading) and (
            following is None or (isinstance(following, Heading) and following.level <= block.level)
        )
        if not empty:
            found.append(block)
    return found[::-1]


def document(
    pieces: Pieces,
    block: Mapping[str, str],
    logo: bytes | None = None,
    template: str | Path | None = None,
) -> Document:
    """The document of a result, ready to be written in any format.

    Parameters
    ----------
    pieces : of the result.
    block : the title block, by words such as "Project".
    logo : bytes of a PNG or SVG.
    template : path of one; None for that of the package.

    Raises
    ------
    InputError : see `arranged`.

    Examples
    --------
    >>> pieces = Pieces("cyclic", "A test", "How stiff?", ["1.2 MPa."])
    >>> document(pieces, {"Project": "Bridge 12"}).title
    'A test'
    """
    return Document(pieces.title, block, logo, arranged(pieces, template), pieces.identity)
