"""What a document is made of: texts, tables, figures, checks. Plain data, no layout."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

# Names that analyses use until all their tables come from the register.
Column: TypeAlias = Quantity
ReportTable: TypeAlias = Table

# Verdicts of a check; the third where there is no limit, or nothing to hold beside it.
PASSED, EXCEEDED, NOT_JUDGED = "within", "exceeded", "not judged"


class Link(str):
    """Words of a cell that lead to a figure or table of the same document, where a format can.

    Examples
    --------
    >>> Link("Fig. 3.8", "fig_3_08").to
    'fig_3_08'
    """

    to: str

    def __new__(cls, words: str, to: str) -> "Link":
        """`to` is the name of the figure or table in the document."""
        made = super().__new__(cls, words)
        made.to = to
        return made


@dataclass(frozen=True)
class Trace:
    """A line of a plot.

    Attributes
    ----------
    name : in the legend; lines of one name are switched together.
    x, y : equally long; NaN interrupts the line.
    colour : such as "#0077BB".
    look : "line", "dashed", "points" or "line with points".
    frames : with a slider: y (and x, if `frames_x`) of each of its places, shape (places, points).
    frames_x : as `frames`; None where x stays.
    """

    name: str
    x: Floats
    y: Floats
    colour: str = "#1a1a1a"
    look: str = "line"
    frames: Floats | None = None
    frames_x: Floats | None = None


@dataclass(frozen=True)
class Plot:
    """A picture that a reader of the HTML page can zoom and ask; the PDF has the drawn figure.

    Attributes
    ----------
    x_title, y_title : with units.
    choices : traces by the words of a menu (one menu entry: no menu), such as one per motion.
    slider : words of each place of the slider, such as "12.5 s"; empty without one.
    slider_title : what the slider moves through, such as "time".
    equal : the same scale on both axes, as an orbit wants it.
    bands : (lower, upper, words) on the x axis shaded as outside the tested range.
    """

    x_title: str
    y_title: str
    choices: Mapping[str, Sequence[Trace]]
    slider: Sequence[str] = ()
    slider_title: str = ""
    equal: bool = False
    bands: Sequence[tuple[float, float, str]] = ()


@dataclass(frozen=True)
class ReportFigure:
    """A figure with its caption.

    Attributes
    ----------
    caption : what is to be seen, in words that stand without the text.
    draw : makes the figure; called once, when a document is written. None: only the plot.
    image : bytes of a picture that exists (SVG or PNG), instead of `draw`.
    alt : what somebody who does not see it must know; the caption where it is empty.
    plot : its interactive counterpart for the HTML page; None: the drawn figure stands there too.
    """

    caption: str
    draw: "Callable[[], Figure] | None" = None
    image: bytes | None = None
    alt: str = ""
    plot: Plot | None = None


@dataclass(frozen=True)
class Check:
    """A number beside its limit.

    Attributes
    ----------
    what : with the run or place that decides.
    value, limit : in `unit`; NaN limit: not judged.
    unit : "" for pure numbers.
    source : of the limit: a code, a table, the data file.
    verdict : "within", "exceeded" or "not judged".
    lower : the limit is a lower one.
    """

    what: str
    value: float
    limit: float
    unit: str
    source: str
    verdict: str
    lower: bool = False


@dataclass(frozen=True)
class Pieces:
    """Everything that a result has to say; which of it is shown, and where, a template says.

    Attributes
    ----------
    command : that made the result, such as "bridge".
    title : of the document, without the project.
    question : what was asked: a sentence or two.
    answer : what came out: three sentences with numbers.
    inputs : tables of what went in, each value with unit and source.
    tables, figures : by name; a template calls them by it, the rest comes in this order.
    checks : numbers beside limits.
    validity : sentences on what left the range that the parameters were identified in; empty:
        nothing did, or `validity_unknown`.
    validity_unknown : why there is no verdict on it; "" where there is one.
    notes : sentences on validity that are no warnings, such as of strain rates in earthquakes.
    books : table of the energy books; None where nothing moves.
    assumptions : sentences.
    warnings : sentences; those of the result.
    identity : version, input hash, the command that makes it again, date of the run, by name.
    """

    command: str
    title: str
    question: str
    answer: Sequence[str]
    inputs: Mapping[str, ReportTable] = field(default_factory=dict)
    tables: Mapping[str, ReportTable] = field(default_factory=dict)
    figures: Mapping[str, ReportFigure] = field(default_factory=dict)
    checks: Sequence[Check] = ()
    validity: Sequence[str] = ()
    validity_unknown: str = ""
    notes: Sequence[str] = ()
    books: ReportTable | None = None
    assumptions: Sequence[str] = ()
    warnings: Sequence[str] = ()
    identity: Mapping[str, str] = field(default_factory=dict)


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
    table: ReportTable


@dataclass(frozen=True)
class FigureBlock:
    """A figure with its name in the document."""

    name: str
    figure: ReportFigure


@dataclass(frozen=True)
class ChecksBlock:
    """The checks of a result."""

    checks: Sequence[Check]


Block = Heading | Paragraph | Bullets | TableBlock | FigureBlock | ChecksBlock


@dataclass(frozen=True)
class Document:
    """What is written, whatever the format.

    Attributes
    ----------
    title : of the document.
    block : the title block: project, structure, client, author, number, date, revision; what is
        not given is not there. `logo` is apart.
    logo : bytes of a PNG or SVG; None without.
    blocks : in reading order.
    identity : as of `Pieces`; in the foot of every page what is short of it.
    """

    title: str
    block: Mapping[str, str]
    logo: bytes | None
    blocks: Sequence[Block]
    identity: Mapping[str, str]
