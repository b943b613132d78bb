"""Drawn figures of an HTML page: vectors where they are small, points where they are not."""

import html
import io
import re
from typing import Any
from urllib.parse import quote

from matplotlib import rc_context
from matplotlib.figure import Figure

from thermobearing.report.html_text import encoded, escaped
from thermobearing.report.pieces import ReportFigure
from thermobearing.results.drawing import save_figure

LARGEST_VECTORS = 300_000  # letters; a figure of more is written as points
PIXELS = 96  # of a page, an inch
POINTS = 170  # an inch, of a figure of points
# Letters as outlines: the page looks the same wherever it is opened. A fixed salt, no date: the
# same figure has the same bytes.
LOOK: dict[Any, Any] = {"svg.fonttype": "path", "svg.hashsalt": "thermobearing"}
NO_DATE = {"Date": None, "Creator": None, "Format": None, "Type": None}
OUTLINE = re.compile(r'\bd="[^"]*"')
TOO_FINE = re.compile(r"(\.\d\d)\d+")  # below a hundredth of a point


def figure_html(figure: ReportFigure, number: int) -> str:
    """A drawn figure with its caption.

    It is an image of its own, not a part of the page: names and looks within two of them do not
    meet, and a script in a picture from elsewhere does not run.

    Parameters
    ----------
    figure : with `draw` or `image`.
    number : of it in the document.

    Examples
    --------
    >>> "data:image/svg+xml" in figure_html(ReportFigure("A line", image=b"<svg/>"), 2)
    True
    """
    name = f"figure-{number}"
    alt = escaped(figure.alt or figure.caption)
    return (
        f'<figure class="figure" id="{name}">\n{_image(figure, alt)}'
        f'<figcaption><span class="number">Figure {number}.</span> '
        f"{escaped(figure.caption)}</figcaption>\n</figure>\n"
    )


def _image(figure: ReportFigure, alt: str) -> str:
    """The picture of a figure; nothing where it has none."""
    if figure.image is not None:
        return f'<img class="drawn" src="{image_address(figure.image)}" alt="{alt}">\n'
    if figure.draw is None:
        return ""
    drawn = figure.draw()
    width = round(PIXELS * drawn.get_figwidth())
    return f'<img class="drawn" src="{_drawn_address(drawn)}" width="{width}" alt="{alt}">\n'


def image_address(image: bytes) -> str:
    """Bytes of a PNG, JPEG or SVG as an address that holds them."""
    if image.startswith(b"\x89PNG"):
        return encoded(image, "image/png")
    if image.startswith(b"\xff\xd8"):
        return encoded(image, "image/jpeg")
    return encoded(image, "image/svg+xml")


def _drawn_address(figure: Figure) -> str:
    vectors = _vectors(figure)
    if len(vectors) <= LARGEST_VECTORS:
        return vectors
    points = io.BytesIO()
    save_figure(figure, points, POINTS)
    return encoded(points.getvalue(), "image/png")


def _vectors(figure: Figure) -> str:
    """A figure as SVG in an address, in which few signs want to be written otherwise."""
    drawn = io.StringIO()
    with rc_context(LOOK):
        figure.savefig(drawn, format="svg", metadata=NO_DATE)
    text = drawn.getvalue()
    text = re.sub(r"<!--.*?-->", "", text[text.index("<svg") :], flags=re.DOTALL)
    text = OUTLINE.sub(lambda found: TOO_FINE.sub(r"\1", found[0]), text)
    signs = quote(" ".join(text.split()), safe=" ~!*'()/:;=?@$,+<>")
    return html.escape(f"data:image/svg+xml,{signs}", quote=True)
