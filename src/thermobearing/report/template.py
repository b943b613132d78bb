"""A template: Markdown whose lines in braces are replaced by the pieces of a result.

A line is a heading (`#`), a list item (`- `), text of a paragraph, or one placeholder:

    {{ question }}  {{ answer }}  {{ exceeded }}  {{ actions }}  {{ inputs }}  {{ checks }}
    {{ validity }}  {{ books }}  {{ assumptions }}  {{ warnings }}  {{ identity }}  {{ live }}
    {{ signatures }}
    {{ table NAME }}  {{ figure NAME }}      a table or figure by its name
    {{ tables }}  {{ figures }}              all tables or figures that are not called by name

Names of pieces that a result does not always have end with a question mark: `{{ table lead? }}`.
A heading under which nothing stands is left out.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from thermobearing.border.errors import InputError, closest
from thermobearing.border.library import data_path
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report.content import TESTED_RANGE
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_ASSESSED,
    PASSED,
    Block,
    Bullets,
    Document,
    FigureBlock,
    Heading,
    Live,
    Paragraph,
    Pieces,
    Signatures,
    TableBlock,
    checks_table,
)
from thermobearing.tables.text import read_text

PLACEHOLDER = re.compile(r"\{\{\s*(\w+)(?:\s+([\w.-]+)(\?)?)?\s*\}\}")
HEADING = re.compile(r"(#{1,3})\s+(.+)")
ALL_VALID = "ll results lie inside the calibration range."
EXTRAPOLATED = "Results outside the calibration range of a bearing are extrapolated."
ACTIONS = {  # what to do about a check, by its verdict and the beginning of the limit's source
    f"{EXCEEDED} {TESTED_RANGE}": "Do not rely on results outside the calibration range, or extend "
    "the range by tests of the bearing.",
    f"{EXCEEDED} rig": "Reduce the amplitude or the speed of the test, or choose another rig.",
    EXCEEDED: "Change the bearing or the structure until no limit is exceeded.",
    f"{NOT_ASSESSED} needs": "Repeat the analysis with the inputs that missing values need.",
    NOT_ASSESSED: "Compare values without a limit with the limits of your design code.",
}
SEVERITY = (EXCEEDED, NOT_ASSESSED, PASSED)


def document(
    pieces: Pieces,
    block: Mapping[str, str],
    logo: bytes | None = None,
    template: str | Path | None = None,
) -> Document:
    """Return the document of a result, ready to be written in any format."""
    blocks = _arranged(pieces, template)
    close = bool(pieces.signatures)  # what is signed is one page
    return Document(pieces.title, block, logo, blocks, pieces.identity, close)


def on_paper(document: Document) -> Document:
    """Return a document without what only a browser can show."""
    blocks = [block for block in document.blocks if not isinstance(block, Live)]
    return replace(document, blocks=_without_empty_headings(blocks))


def _arranged(pieces: Pieces, path: str | Path | None = None) -> list[Block]:
    """Return the pieces of a result in the order of a template, of the package if none is given."""
    own = data_path("reports", f"{pieces.command}.md")
    file = Path(path or (own if own.is_file() else data_path("reports", "any.md")))
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


def _blocks_of_line(line: str, pieces: Pieces, called: set[tuple[str, str]]) -> Sequence[Block]:
    """Return what stands for a line of a template; an empty line ends a paragraph."""
    if heading := HEADING.fullmatch(line):
        return [Heading(len(heading[1]), heading[2])]
    if line.startswith("- "):
        return [Bullets([line[2:].strip()])]
    placed = PLACEHOLDER.fullmatch(line)
    if placed is None:
        if "{{" in line:
            raise InputError("a placeholder must be alone on its line, such as {{ tables }}")
        return [Paragraph(line)]
    word, name, optional = placed.groups()
    if name is None and word in SECTIONS:
        return SECTIONS[word](pieces)
    kind = word if name else word.removesuffix("s")
    if kind not in ("table", "figure") or (name is None and word == kind):
        if name:
            raise InputError(f'no placeholder "{word} {name}": it is table NAME or figure NAME')
        known = [*SECTIONS, "tables", "figures", "table NAME", "figure NAME"]
        raise InputError(f'no placeholder "{word}"{_nearest(word, known)}')
    found: dict[str, Block] = (
        {key: TableBlock(key, table) for key, table in pieces.tables.items()}
        if kind == "table"
        else {key: FigureBlock(key, figure) for key, figure in pieces.figures.items()}
    )
    if name is None:
        return [block for key, block in found.items() if (kind, key) not in called]
    if name not in found and not optional:
        raise InputError(
            f'this result has no {word} "{name}"{_nearest(name, found)}; '
            f'write "{name}?" where it may be missing'
        )
    return [found[name]] if name in found else []


def _nearest(name: str, known: Mapping[str, object] | Sequence[str]) -> str:
    """Return what was perhaps meant, and what there is."""
    return f"{closest(name, known)} (there is: {', '.join(known) or 'none'})"


def _validity(pieces: Pieces) -> list[Block]:
    notes = _listed(pieces.notes)
    found: Block = Paragraph(f"{'Except for the following, a' if notes else 'A'}{ALL_VALID}")
    if pieces.validity_unknown:
        found = Paragraph(pieces.validity_unknown, "warning")
    elif pieces.validity:
        return [Paragraph(EXTRAPOLATED), Bullets(pieces.validity, "warning"), *notes]
    return [found, *notes]


def _checks(pieces: Pieces) -> list[Block]:
    """Return the checks by severity."""
    ranked = sorted(pieces.checks, key=lambda check: SEVERITY.index(check.verdict))
    return [TableBlock("checks", checks_table(ranked))] if ranked else []


def _exceeded(pieces: Pieces) -> list[Block]:
    """Return the checks that are exceeded."""
    failed = [check for check in pieces.checks if check.verdict == EXCEEDED]
    return [TableBlock("exceeded", checks_table(failed, "Exceeded limits"))] if failed else []


def _actions(pieces: Pieces) -> list[Block]:
    """Return what to do about exceeded limits and unknown ones."""
    found = dict.fromkeys(
        next(text for start, text in ACTIONS.items() if f"{c.verdict} {c.source}".startswith(start))
        for c in sorted(pieces.checks, key=lambda check: SEVERITY.index(check.verdict))
        if c.verdict != PASSED
    )
    return [Paragraph("**Recommended actions**"), Bullets(list(found))] if found else []


def _identity(pieces: Pieces) -> list[Block]:
    columns, rows = [Quantity("What"), Quantity("Value")], list(pieces.identity.items())
    table = Table("How to reproduce this result", columns, rows)
    return [TableBlock("identity", table)] if rows else []


def _listed(items: Sequence[str], kind: str = "") -> list[Block]:
    return [Bullets(items, kind)] if items else []


SECTIONS: Mapping[str, Callable[[Pieces], list[Block]]] = {
    "question": lambda pieces: [Paragraph(pieces.question)],
    "answer": lambda pieces: _listed(pieces.answer, "answer"),
    "inputs": lambda pieces: [TableBlock(name, t) for name, t in pieces.inputs.items()],
    "exceeded": _exceeded,
    "actions": _actions,
    "checks": _checks,
    "validity": _validity,
    "books": lambda pieces: [TableBlock("books", pieces.books)] if pieces.books else [],
    "assumptions": lambda pieces: _listed(pieces.assumptions),
    "warnings": lambda pieces: _listed(pieces.warnings, "warning"),
    "identity": _identity,
    "live": lambda pieces: [pieces.live] if pieces.live else [],
    "signatures": lambda pieces: [Signatures(pieces.signatures)] if pieces.signatures else [],
}


def _joined(blocks: Sequence[Block]) -> list[Block]:
    """Return lines of one paragraph, and items of one list, put together; without empty lines."""
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
    """Return the blocks without headings that have nothing under them."""
    found: list[Block] = []
    for block in reversed(blocks):
        below = found[-1] if found else Heading(1, "")
        if isinstance(block, Heading) and isinstance(below, Heading) and below.level <= block.level:
            continue
        found.append(block)
    return found[::-1]
