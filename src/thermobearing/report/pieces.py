"""What a document is made of: texts, tables, figures, checks. Plain data, no layout."""

import base64
import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from thermobearing.quantities.register import MINUS, Quantity, format_number
from thermobearing.quantities.tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from thermobearing.core.records import Floats

# Verdicts of a check, and their signs; "not assessed" where there is no limit, or no value.
PASSED, EXCEEDED, NOT_ASSESSED = "within", "exceeded", "not assessed"
TENTATIVE = "within so far"  # with fewer motions than the rule of the code needs
VERDICTS = {
    PASSED: "\N{CHECK MARK}",
    EXCEEDED: "\N{MULTIPLICATION X}",
    NOT_ASSESSED: "\N{EN DASH}",
    TENTATIVE: "\N{EN DASH}",
}


MARK = "\N{DAGGER}"  # of a marked cell; a star stands for what was not checked
MARKED = "Marked:"  # a note that holds it says itself what the mark means
MARK_WORDS = "outside the calibration range"
MARK_PHRASES = {  # words of a note on marked cells, and with the mark
    MARKED: MARK,
    "Marked values": f"Values with {MARK}",
    "marked values": f"values with {MARK}",
}


def marked_note(table: Table) -> str:
    """Return the note of a table, with the mark of its cells and what it means.

    Notes are no Markdown: the marks of names of commands are left out.
    """
    note = table.note.replace("`", "")
    for words, with_mark in MARK_PHRASES.items():
        note = note.replace(words, with_mark)
    return f"{MARK} {MARK_WORDS}. {note}".strip() if table.marked and MARK not in note else note


class Link(str):
    """Words of a cell that lead to a figure or table of the same document, by its name."""

    to: str

    def __new__(cls, words: str, to: str) -> "Link":
        """Return the words; `to` is the name of the figure or table in the document."""
        link = super().__new__(cls, words)
        link.to = to
        return link


LONGEST_WORD, BRIEF = 24, 15  # letters of a word that is not broken, of a text that stays on a line


def _count(text: str) -> int:
    """Return how many letters of mean width a text is as wide as; an m is wider than others."""
    return len(text) + round(0.5 * sum(map(text.count, "mMW")))


def column_letters(table: Table, texts: Sequence[Sequence[str]]) -> list[tuple[int, int]]:
    """Return the letters that each column needs, wrapped at its words, and on one line.

    How large the letters of a table are on a screen and on paper follows from it. Numbers and brief
    texts are not wrapped.
    """
    numbers, letters = table.numeric(), []
    for place, column in enumerate(table.columns):
        cells = [row[place] for row in texts]
        head = [_count(word) for word in column.head.split()] + [_count(column.unit) + 2]
        words = [
            word
            for cell in cells
            # At spaces only: others keep words together.
            for word in ([cell] if place in numbers or len(cell) < BRIEF else cell.split(" "))
        ]
        # A column is never narrower than its head, nor than its longest word (up to LONGEST_WORD).
        least = max([*head, *(min(_count(word), LONGEST_WORD) for word in words)])
        letters.append((least, max([least, _count(column.head), *map(_count, cells)])))
    return letters


@dataclass(frozen=True)
class Trace:
    """A line of a plot; a history may have all its points, documents thin it.

    Lines of one name are switched together. NaN interrupts the line. `look` is "line", "broad" (a
    band below other lines), "dashed", "points" or "line with points". With a slider, `frames` are y
    and `frames_x` are x (None where it stays) of each of its places, shape (places, points).
    """

    name: str
    x: "Floats"
    y: "Floats"
    colour: str = "#1a1a1a"
    look: str = "line"
    frames: "Floats | None" = None
    frames_x: "Floats | None" = None


@dataclass(frozen=True)
class Plot:
    """One description of a figure: an HTML page shows it to zoom and read, matplotlib draws it.

    `choices` are traces by the words of a menu (one entry: no menu), `slider` the words of each of
    its places, such as "12.5 s", and `slider_title` what it moves through. `equal` is the same
    scale on both axes; `bands` on the x axis are shaded as outside the tested range. `titles` are
    those of the axes of menu entries whose quantities or units differ from `x_title`, `y_title`.
    """

    x_title: str
    y_title: str
    choices: Mapping[str, Sequence[Trace]]
    slider: Sequence[str] = ()
    slider_title: str = ""
    equal: bool = False
    bands: Sequence[tuple[float, float, str]] = ()
    titles: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def axis_titles(self, choice: str) -> tuple[str, str]:
        """Return the titles of the x and y axis of a menu entry."""
        return self.titles.get(choice, (self.x_title, self.y_title))

    def shaded(self) -> list[str]:
        """Return the words of the bands that the lines reach, each once."""
        traces = [trace for traces in self.choices.values() for trace in traces]
        values = [np.ravel(t.x if t.frames_x is None else t.frames_x) for t in traces]
        reached = np.concatenate([*values, []])
        reached = reached[np.isfinite(reached)]
        if not reached.size:
            return []
        low, high = reached.min(), reached.max()
        return list(dict.fromkeys(w for a, b, w in self.bands if a < high and b > low))


@dataclass(frozen=True)
class ReportFigure:
    """A figure with its caption: drawn, a picture, or a plot that is drawn for paper too.

    `draw` makes the matplotlib figure once; `image` is a picture that exists (SVG or PNG); without
    both the figure of paper is drawn from `plot`, the interactive one of the page. `alt` is what
    readers who cannot see it must know; the caption where it is empty. `plot_caption` is that of a
    plot that shows something else than the figure of paper.
    """

    caption: str
    draw: "Callable[[], Figure] | None" = None
    image: bytes | None = None
    alt: str = ""
    plot: Plot | None = None
    plot_caption: str = ""


@dataclass(frozen=True)
class Check:
    """A number compared with its limit, both in `unit`; a NaN limit is not assessed.

    `what` has the run or place that decides, `limited` says what the limit is of, without these;
    `lower` says that the limit is a lower one, and `of_tests` that it is an end of the calibration
    range and no engineering limit; `runs` are those that pass such an end; `rounded` is the value
    in the digits of a table where these are not three.
    """

    what: str
    value: float
    limit: float
    unit: str
    source: str
    verdict: str
    lower: bool = False
    of_tests: bool = False
    limited: str = ""
    runs: frozenset[str] = frozenset()
    rounded: str = ""

    @property
    def without_limit(self) -> bool:
        """Whether there is a value, but no limit of it."""
        return np.isnan(self.limit) and not np.isnan(self.value)

    @property
    def outside_by(self) -> float:
        """Return how far the value lies beyond its limit, in `unit`; negative within it."""
        return self.limit - self.value if self.lower else self.value - self.limit


def checks_table(
    checks: Sequence[Check], caption: str = "Values and their limits", *, signs: bool = True
) -> Table:
    """Return checks as a table; the limits with a sign, or as plain numbers for a workbook."""
    rows = []
    for check in checks:
        numbers = _value_and_limit(check) if signs else (check.value, check.limit)
        rows.append((check.what, *numbers, check.unit, check.source, check.verdict))
    heads = ("Check", "Value", "Limit", "Unit", "Source of the limit", "Verdict")
    exceeded = [k for k, check in enumerate(checks) if check.verdict == EXCEEDED]
    marked = frozenset() if signs else frozenset((k, 5) for k in exceeded)
    columns = [Quantity(head, form=".6g") for head in heads]
    return Table(caption, columns, rows, marked=marked)


def not_entered(checks: Sequence[Check]) -> str:
    """Return the limits that no office has entered as one sentence, with their governing values."""
    largest: dict[str, Check] = {}
    for check in checks:
        if check.without_limit:
            name = check.limited or check.what
            previous = largest.get(name)
            # Of a least value the smallest is nearest to any limit.
            if previous is None or (
                check.value < previous.value
                if check.lower
                else abs(check.value) > abs(previous.value)
            ):
                largest[name] = check
    if not largest:
        return ""
    values = []
    for name, check in largest.items():
        value = f"{format_number(check.value, '.3g')} {check.unit}".strip()
        values.append(f"{name} ({'smallest ' * check.lower}{value})")
    count_words = f"{len(values)} limits are" if len(values) > 1 else "1 limit is"
    return f"{count_words} not entered: {'; '.join(values)}."


def calibration_table(checks: Sequence[Check]) -> Table:
    """Return what lies outside the calibration range, and by how much, the farthest first."""
    outside = [check for check in checks if check.of_tests and check.verdict == EXCEEDED]
    # Relative to the limit, so that strains [%] and temperatures can be compared.
    outside.sort(key=lambda check: -check.outside_by / (abs(check.limit) or 1.0))
    rows = [
        (check.what, *_value_and_limit(check), float(f"{check.outside_by:.3g}"), check.unit)
        for check in outside
    ]
    columns = [Quantity(head, form=".6g") for head in ("Quantity", "Value", "Tested", "Outside by")]
    return Table("Outside the calibration range", [*columns, Quantity("Unit")], rows)


def _value_and_limit(check: Check) -> tuple[float, str]:
    """Return both with three significant digits; with more where they would look the same."""
    if not np.isfinite(check.limit):
        return float(f"{check.value:.3g}"), "none"
    sign = "\N{GREATER-THAN OR EQUAL TO}" if check.lower else "\N{LESS-THAN OR EQUAL TO}"
    for form in (".3g", ".4g", ".6g"):
        value, limit = format_number(check.value, form), format_number(check.limit, form)
        value = check.rounded or value
        if value != limit or check.value == check.limit:
            break
    # A limit that has four digits is shown with them: 327.5, not 328.
    if float(f"{check.limit:.4g}") == check.limit:
        limit = format_number(check.limit, max(form, ".4g"))
    # From 1000 on, `format_number` keeps all digits before the point: 1765, as entered.
    return float(value.replace(MINUS, "-")), f"{sign} {limit}"


def policy_digest(text: str) -> str:
    """Return what the security policy of a page allows: this script or style and no other."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@dataclass(frozen=True)
class Live:
    """A part of an HTML page in which the reader's browser computes; paper has none.

    `runs` are the words of a menu; `strain` says whether a second slider moves the strain. The
    script reads `data` and `module`, compressed and in base64.
    """

    runs: Sequence[str]
    strain: bool
    script: str = field(repr=False)
    data: str = field(repr=False)
    module: str = field(repr=False)


@dataclass(frozen=True)
class Pieces:
    """Everything that a result has to say; a template decides what is shown, and where.

    The question is a sentence or two, the answer three with numbers. `inputs`, `tables` and
    `figures` are by name. `validity` holds sentences on what left the range that the parameters
    were identified in, `validity_unknown` why there is no verdict on it, `notes` what is no
    warning. `energy` is the energy balance; `identity` has version, input hash and command;
    `range_action` is what to do about results outside the calibration range, in place of the usual;
    `uncounted` is what the number of quantities outside it leaves out;
    `first_actions` are what to do before all that checks ask for;
    `live` computes the result again in an HTML page; `signatures` are the roles of those who sign,
    and `one_page` whether the document is to fit on one; `files` stand next to the document, by
    name.
    """

    command: str
    title: str
    question: str
    answer: Sequence[str]
    inputs: Mapping[str, Table] = field(default_factory=dict)
    tables: Mapping[str, Table] = field(default_factory=dict)
    figures: Mapping[str, ReportFigure] = field(default_factory=dict)
    checks: Sequence[Check] = ()
    validity: Sequence[str] = ()
    validity_unknown: str = ""
    notes: Sequence[str] = ()
    energy: Table | None = None
    assumptions: Sequence[str] = ()
    warnings: Sequence[str] = ()
    identity: Mapping[str, str] = field(default_factory=dict)
    live: Live | None = None
    signatures: Sequence[str] = ()
    one_page: bool = False
    files: Mapping[str, bytes] = field(default_factory=dict)
    range_action: str = ""
    uncounted: str = ""
    first_actions: Sequence[str] = ()


# Blocks of a document, in reading order. Text is Markdown of the template's own sentences:
# **bold**, *italic*, `code`, [words](address).
@dataclass(frozen=True)
class Heading:
    """A heading; level 1 to 3."""

    level: int
    text: str


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of Markdown text; `kind` is "", "warning" or "answer"."""

    text: str
    kind: str = ""


@dataclass(frozen=True)
class Bullets:
    """A list of sentences; `kind` as of a paragraph."""

    items: Sequence[str]
    kind: str = ""


@dataclass(frozen=True)
class TableBlock:
    """A table with its name in the document."""

    name: str
    table: Table


@dataclass(frozen=True)
class FigureBlock:
    """A figure with its name in the document."""

    name: str
    figure: ReportFigure


@dataclass(frozen=True)
class Signer:
    """Who signs: the role, with name and date where the title block has them."""

    role: str
    name: str = ""
    date: str = ""


@dataclass(frozen=True)
class Signatures:
    """A place for the name, the date and the signature of each role."""

    signers: Sequence[Signer]


Block = Heading | Paragraph | Bullets | TableBlock | FigureBlock | Live | Signatures


@dataclass(frozen=True)
class Document:
    """What is written, whatever the format: the title block as given, the blocks in reading order.

    The logo is a PNG or SVG; `identity` is that of `Pieces`.
    """

    title: str
    block: Mapping[str, str]
    logo: bytes | None
    blocks: Sequence[Block]
    identity: Mapping[str, str]
    close: bool = False  # narrow margins and gaps on paper, for one page

    @property
    def foot(self) -> str:
        """Version of the program and date of the result, for the foot of every page."""
        shown = [text for key, text in self.identity.items() if key.startswith(("Version", "Date"))]
        return " \N{MIDDLE DOT} ".join(shown)
