"""Drawn figures of an HTML page, each an image of its own with its caption."""

import html
from urllib.parse import quote

from thermobearing.report.html_text import encoded, escaped
from thermobearing.report.pictures import page_picture, size_of
from thermobearing.report.pieces import ReportFigure

PIXEL = 25.4 / 96.0  # of a page [mm]


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
    return (
        f'<figure class="figure" id="{name}">\n{_image(figure)}'
        f'<figcaption><span class="number">Figure {number}.</span> '
        f"{escaped(figure.caption)}</figcaption>\n</figure>\n"
    )


def _image(figure: ReportFigure) -> str:
    """The picture of a figure, as broad as it says; nothing where it has none."""
    picture = page_picture(figure)
    if picture is None:
        return ""
    alt = escaped(figure.alt or figure.caption)
    width = round(size_of(picture)[0] / PIXEL)
    return f'<img class="drawn" src="{image_address(picture)}" width="{width}" alt="{alt}">\n'


def image_address(image: bytes) -> str:
    """Bytes of a PNG, JPEG or SVG as an address that holds them."""
    if image.startswith(b"\x89PNG"):
        return encoded(image, "image/png")
    if image.startswith(b"\xff\xd8"):
        return encoded(image, "image/jpeg")
    # Of an SVG few signs want to be written otherwise: shorter than base64.
    signs = quote(b" ".join(image.split()), safe=" ~!*'()/:;=?@$,+<>")
    return html.escape(f"data:image/svg+xml,{signs}", quote=True)
