"""Figures as pictures that a document holds: drawn once, the same bytes for the same result."""

import io
import logging
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import matplotlib as mpl
from matplotlib import font_manager
from matplotlib.figure import Figure

from thermobearing.report.pieces import Document, FigureBlock, Paragraph, ReportFigure
from thermobearing.results.drawing import save_figure

# Fonts with Japanese letters that systems have, by the names that they go by; for figures, whose
# own font (DejaVu Sans) has Latin, Greek and Cyrillic letters.
JAPANESE = (
    *("Noto Sans CJK JP", "Noto Sans JP", "Source Han Sans JP", "IPAexGothic", "IPAGothic"),
    *("Yu Gothic", "Meiryo", "MS Gothic", "Hiragino Sans", "TakaoGothic", "VL Gothic"),
)
MISSING = re.compile(r"Glyph (\d+) \(.*\) missing from font")
# What two neighbouring pieces of a line may be off their sum, in points at 72 an inch: a line of
# 20 000 samples has then hundreds of pieces, and nobody sees it at print width.
SIMPLIFY = 0.15
LOOK: dict[Any, Any] = {
    "svg.fonttype": "path",
    "svg.hashsalt": "thermobearing",  # else names of parts differ from run to run
    "path.simplify": True,
    "path.simplify_threshold": SIMPLIFY,
}
NO_DATE = {"Date": None, "Creator": None}
LARGEST_VECTORS = 300_000  # bytes; a figure of more is written as points into a page
POINTS = 170  # an inch, of a figure of points
OUTLINE = re.compile(rb'\bd="[^"]*"')
TOO_FINE = re.compile(rb"(\.\d\d)\d+")  # below a hundredth of a point
COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)


def drawn(document: Document) -> Document:
    """The document with every figure as a picture, and a warning where letters are missing."""
    missing: set[str] = set()
    blocks = [
        replace(block, figure=_pictured(block.figure, missing))
        if isinstance(block, FigureBlock)
        else block
        for block in document.blocks
    ]
    if missing:
        blocks.insert(0, Paragraph(missing_words(sorted(missing), "the figures"), "warning"))
    return replace(document, blocks=blocks)


def page_picture(figure: ReportFigure) -> bytes | None:
    """The picture of a figure as an HTML page takes it: points where it is of many vectors.

    Parameters
    ----------
    figure : drawn or not; None comes back where it has no picture.
    """
    if figure.draw is None:
        return figure.image
    made = _pictured(figure, set())
    assert made.image is not None
    assert made.draw is not None
    if len(made.image) <= LARGEST_VECTORS:
        return made.image
    points = io.BytesIO()
    save_figure(made.draw(), points, POINTS)
    return points.getvalue()


def missing_words(letters: Sequence[str], where: str) -> str:
    """What a reader is told of letters that no font has."""
    codes = ", ".join(f"U+{ord(letter):04X}" for letter in letters[:20])
    more = f" and {len(letters) - 20} more" if len(letters) > 20 else ""
    return (
        f"No font of the machine that made this document has some letters of {where} "
        f"({codes}{more}); they are shown by their codes or as boxes. For Japanese install a "
        'font such as "Noto Sans CJK JP", and make the document again.'
    )


def _in_fonts(draw: Callable[[], Figure]) -> Callable[[], Figure]:
    """What draws a figure with letters of Japanese fonts too, where the machine has one."""

    def drawn_in_fonts() -> Figure:
        teller = logging.getLogger("matplotlib.font_manager")
        before = teller.level
        teller.setLevel(logging.ERROR)  # that a font has no bold is of no matter to a reader
        try:
            with mpl.rc_context({"font.family": ["DejaVu Sans", *_japanese_fonts()]}):
                return draw()
        finally:
            teller.setLevel(before)

    return drawn_in_fonts


@cache
def _japanese_fonts() -> tuple[str, ...]:
    """Those of the machine."""
    there = {font.name for font in font_manager.fontManager.ttflist}
    return tuple(name for name in JAPANESE if name in there)


def _pictured(figure: ReportFigure, missing: set[str]) -> ReportFigure:
    if figure.image is not None or figure.draw is None:
        return figure
    draw = cache(_in_fonts(figure.draw))
    return replace(figure, draw=draw, image=svg_bytes(draw(), missing))


def svg_bytes(figure: Figure, missing: set[str]) -> bytes:
    """A figure as SVG, its letters as outlines; letters without a font are added to `missing`.

    The figure keeps its layout: half of the time of a drawing goes into it.
    """
    written = io.BytesIO()
    with mpl.rc_context(LOOK), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        figure.savefig(written, format="svg", metadata=NO_DATE)
    figure.set_layout_engine("none")
    for warning in caught:
        told = MISSING.search(str(warning.message))
        if told:
            missing.add(chr(int(told[1])))
        else:
            warnings.warn(warning.message, warning.category, stacklevel=2)
    lean = COMMENT.sub(b"", written.getvalue())
    return OUTLINE.sub(lambda found: TOO_FINE.sub(rb"\1", found[0]), lean)


def picture_size(image: bytes) -> tuple[float, float]:
    """Width and height of a picture [mm], as it says them; of a PNG at its own points an inch."""
    if image.startswith(b"\x89PNG"):
        from PIL import Image

        with Image.open(io.BytesIO(image)) as picture:
            dots = float(picture.info.get("dpi", (150.0, 150.0))[0]) or 150.0
            return picture.width / dots * 25.4, picture.height / dots * 25.4
    head = image[:4096].decode(errors="replace")
    found = [re.search(rf'\b{name}="([\d.]+)(pt|mm|cm|in|px)?"', head) for name in SIDES]
    if not all(found):
        return 160.0, 100.0
    width, height = (float(m[1]) * UNITS[m[2] or "px"] for m in found if m)
    return width, height


SIDES = ("width", "height")
UNITS = {"pt": 25.4 / 72.0, "mm": 1.0, "cm": 10.0, "in": 25.4, "px": 25.4 / 96.0}  # [mm]
