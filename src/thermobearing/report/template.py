"""A template: Markdown whose lines in braces are replaced by the pieces of a result.

A line is a heading (`#`), a list item (`- `), text of a paragraph, or one placeholder:

    {{ question }}  {{ answer }}  {{ exceeded }}  {{ actions }}  {{ inputs }}  {{ checks }}
    {{ validity }}  {{ energy }}  {{ assumptions }}  {{ warnings }}  {{ identity }}  {{ live }}
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
from thermobearing.quantities.words import joined
from thermobearing.report.content import PREPARED, TESTED_RANGE, summarize_checks
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_ASSESSED,
    PASSED,
    TENTATIVE,
    Block,
    Bullets,
    Check,
    Document,
    FigureBlock,
    Heading,
    Live,
    Paragraph,
    Pieces,
    Signatures,
    Signer,
    TableBlock,
    calibration_table,
    checks_table,
    not_entered,
)
from thermobearing.results.ranges import TESTED_TO
from thermobearing.tables.text import read_text

PLACEHOLDER = re.compile(r"\{\{\s*(\w+)(?:\s+([\w.-]+)(\?)?)?\s*\}\}")
HEADING = re.compile(r"(#{1,3})\s+(.+)")
ALL_VALID = "ll results lie inside the calibration range."
EXTRAPOLATED = "Results outside the calibration range of a bearing are extrapolated."
WARNINGS_OF_RANGE = "warnings on the calibration range are"
OF_RANGE = f"{EXCEEDED} {TESTED_RANGE}"
ACTIONS = {  # what to do about a check, by its verdict and the beginning of the limit's source
    OF_RANGE: "Do not rely on results outside the calibration range, or extend "
    "the range by tests of the bearing.",
    f"{EXCEEDED} rig": "Reduce the amplitude or the speed of the test, or choose another rig.",
    EXCEEDED: "Change the bearing or the structure until no limit is exceeded.",
    f"{NOT_ASSESSED} needs": "Repeat the analysis with the inputs that missing values need.",
    NOT_ASSESSED: "Compare values without a limit with your design code; of a bridge, enter its "
    "limits (`thermobearing limits new`).",
}
AUTHOR = "Author"  # of the title block
SEVERITY = (EXCEEDED, TENTATIVE, NOT_ASSESSED, PASSED)


def document(
    pieces: Pieces,
    block: Mapping[str, str],
    logo: bytes | None = None,
    template: str | Path | None = None,
) -> Document:
    """Return the document of a result, ready to be written in any format."""
    blocks = [_named(part, block) for part in _arranged(pieces, template)]
    return Document(pieces.title, block, logo, blocks, pieces.identity, pieces.one_page)


def _named(part: Block, title: Mapping[str, str]) -> Block:
    """Return a block; of signatures with the names and the date of the title block."""
    if not isinstance(part, Signatures):
        return part
    signers = []
    for signer in part.signers:
        name = title.get(AUTHOR if signer.role == PREPARED else signer.role, "")
        # The date of the document is that of its author; others sign later.
        date = title.get("Date", "") if name and signer.role == PREPARED else ""
        signers.append(replace(signer, name=name, date=date))
    return Signatures(signers)


def on_paper(document: Document) -> Document:
    """Return a document without what only a browser can show."""
    blocks = [block for block in document.blocks if not isinstance(block, Live)]
    return replace(document, blocks=_without_empty_headings(blocks))


def _arranged(pieces: Pieces, path: str | Path | None = None) -> list[Block]:
    """Return the pieces of a result in the order of a template, of the package if none is given."""
    command_template = data_path("reports", f"{pieces.command}.md")
    file = Path(
        path or (command_template if command_template.is_file() else data_path("reports", "any.md"))
    )
    blocks: list[Block] = []
    faults: list[str] = []
    text = read_text(file)
    # {{ tables }} and {{ figures }} leave out what the template names anywhere, also further below.
    named = {(m[1], m[2]) for m in PLACEHOLDER.finditer(text) if m[2]}
    for number, line in enumerate(text.splitlines(), 1):
        try:
            blocks += _blocks_of_line(line.strip(), pieces, named)
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
        placeholders = [*SECTIONS, "tables", "figures", "table NAME", "figure NAME"]
        raise InputError(f'no placeholder "{word}"{_nearest(word, placeholders)}')
    named_blocks: dict[str, Block] = (
        {key: TableBlock(key, table) for key, table in pieces.tables.items()}
        if kind == "table"
        else {key: FigureBlock(key, figure) for key, figure in pieces.figures.items()}
    )
    if name is None:
        return [block for key, block in named_blocks.items() if (kind, key) not in called]
    if name not in named_blocks and not optional:
        raise InputError(
            f'this result has no {word} "{name}"{_nearest(name, named_blocks)}; '
            f'write "{name}?" where it may be missing'
        )
    return [named_blocks[name]] if name in named_blocks else []


def _nearest(name: str, choices: Mapping[str, object] | Sequence[str]) -> str:
    """Return what was perhaps meant, and what there is."""
    return f"{closest(name, choices)} (there is: {', '.join(choices) or 'none'})"


def _validity(pieces: Pieces) -> list[Block]:
    notes = _listed(pieces.notes)
    unknown = [Paragraph(pieces.validity_unknown, "warning")] if pieces.validity_unknown else []
    if pieces.validity:
        table, sentences = calibration_table(pieces.checks), pieces.validity
        if table.rows:  # it has what the sentences on ends of the range say
            sentences = [text for text in sentences if TESTED_TO not in text]
        tables = [TableBlock("outside", table)] if table.rows else []
        outside = [Paragraph(EXTRAPOLATED), *tables, *_listed(sentences, "warning")]
        return [*outside, *unknown, *notes]
    all_valid = Paragraph(f"{'Except for the following, a' if notes else 'A'}{ALL_VALID}")
    return [*(unknown or [all_valid]), *notes]


def _engineering(pieces: Pieces) -> list[Check]:
    """Return the checks of engineering limits by severity."""
    checks = [check for check in pieces.checks if not check.of_tests]
    return sorted(checks, key=lambda check: SEVERITY.index(check.verdict))


def _checks(pieces: Pieces) -> list[Block]:
    """Return how many checks fail, the engineering limits by severity, and those not entered."""
    checks = _engineering(pieces)
    if not checks:
        return []
    limited = [check for check in checks if not check.without_limit]
    blocks: list[Block] = [Paragraph(summarize_checks(pieces.checks, pieces.uncounted))]
    if limited:
        blocks.append(TableBlock("checks", checks_table(limited, "Engineering limits")))
    # Checks without a limit have no verdict, and a sentence in place of rows.
    unentered = not_entered(checks)
    return [*blocks, Paragraph(""), Paragraph(unentered)] if unentered else blocks


def _exceeded(pieces: Pieces) -> list[Block]:
    """Return the engineering limits that are exceeded."""
    failed = [check for check in _engineering(pieces) if check.verdict == EXCEEDED]
    table = checks_table(failed, "Exceeded engineering limits")
    return [TableBlock("exceeded", table)] if failed else []


def _actions(pieces: Pieces) -> list[Block]:
    """Return what to do about exceeded limits and unknown ones."""
    texts = ACTIONS | ({OF_RANGE: pieces.range_action} if pieces.range_action else {})
    of_checks = dict.fromkeys(
        next(text for start, text in texts.items() if f"{c.verdict} {c.source}".startswith(start))
        for c in sorted(pieces.checks, key=lambda check: SEVERITY.index(check.verdict))
        if c.verdict not in (PASSED, TENTATIVE)  # more motions are a first action
    )
    missing = joined(dict.fromkeys(c.limited or c.what for c in pieces.checks if c.without_limit))
    actions = [
        f"{text.removesuffix('.')}: {missing}." if text == ACTIONS[NOT_ASSESSED] else text
        for text in of_checks
    ]
    items = [*pieces.first_actions, *actions]
    return [Paragraph("**Recommended actions**"), Bullets(items)] if items else []


def _identity(pieces: Pieces) -> list[Block]:
    columns = [Quantity("What"), Quantity("Value")]
    # Cells are no Markdown, in which a certificate states the same.
    rows = [(label.replace("`", ""), value) for label, value in pieces.identity.items()]
    table = Table("How to reproduce this result", columns, rows)
    return [TableBlock("identity", table)] if rows else []


def _listed(items: Sequence[str], kind: str = "") -> list[Block]:
    return [Bullets(items, kind)] if items else []


def _warnings(pieces: Pieces) -> list[Block]:
    """Return the warnings that are about no range, and how many stand under Validity."""
    elsewhere = len(pieces.validity) + bool(pieces.validity_unknown)
    blocks = _listed(pieces.warnings, "warning")
    if not elsewhere:
        return blocks
    subject = "warning on the calibration range is" if elsewhere == 1 else WARNINGS_OF_RANGE
    more = "more " if blocks else ""
    return [*blocks, Paragraph(""), Paragraph(f"{elsewhere} {more}{subject} under Validity.")]


SECTIONS: Mapping[str, Callable[[Pieces], list[Block]]] = {
    "question": lambda pieces: [Paragraph(pieces.question)],
    "answer": lambda pieces: _listed(pieces.answer, "answer"),
    "inputs": lambda pieces: [TableBlock(name, t) for name, t in pieces.inputs.items()],
    "exceeded": _exceeded,
    "actions": _actions,
    "checks": _checks,
    "validity": _validity,
    "energy": lambda pieces: [TableBlock("energy", pieces.energy)] if pieces.energy else [],
    "assumptions": lambda pieces: _listed(pieces.assumptions),
    "warnings": _warnings,
    "identity": _identity,
    "live": lambda pieces: [pieces.live] if pieces.live else [],
    "signatures": lambda pieces: (
        [Signatures([Signer(role) for role in pieces.signatures])] if pieces.signatures else []
    ),
}


def _joined(blocks: Sequence[Block]) -> list[Block]:
    """Return lines of one paragraph, and items of one list, put together; without empty lines."""
    merged: list[Block] = []
    separated = True
    for block in blocks:
        if isinstance(block, Paragraph) and not block.text:
            separated = True
            continue
        last = merged[-1] if merged and not separated else None
        if isinstance(block, Paragraph) and isinstance(last, Paragraph) and not block.kind:
            merged[-1] = Paragraph(f"{last.text} {block.text}", last.kind)
        elif isinstance(block, Bullets) and isinstance(last, Bullets) and last.kind == block.kind:
            merged[-1] = Bullets([*last.items, *block.items], block.kind)
        else:
            merged.append(block)
        separated = isinstance(block, Heading)
    return merged


def _without_empty_headings(blocks: Sequence[Block]) -> list[Block]:
    """Return the blocks without headings that have nothing under them."""
    kept: list[Block] = []
    # From the end: whether a heading is empty depends on the blocks below it that stay.
    for block in reversed(blocks):
        below = kept[-1] if kept else Heading(1, "")
        if isinstance(block, Heading) and isinstance(below, Heading) and below.level <= block.level:
            continue
        kept.append(block)
    return kept[::-1]
