"""Style of the figures that a result saves: kind of the files, width in print, titles."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from thermobearing.border.errors import InputError, nearest, short_repr
from thermobearing.border.units import parse_quantity

# Widths of columns [mm] and the smallest letters [pt] in the instructions of a large publisher
# (Elsevier, "Sizing of artwork"); other journals differ by a few millimetres.
COLUMNS = {"single-column": 90.0, "double-column": 190.0}
SMALLEST = 7.0
FORMATS = ("png", "pdf", "svg")
NARROWEST, WIDEST = 60.0, 400.0  # of a figure [mm]
INCH = 25.4  # [mm]


@dataclass(frozen=True)
class FigureStyle:
    """How figures are drawn and saved; a width of None is that of each figure [inch]."""

    format: str = "png"
    width: float | None = None
    titles: bool = True


STYLE_KEYS = ("format", "width", "titles")
Wanted = bool | Mapping[str, Any]  # figures: none, as usual, or with keywords of `check_style`
USUAL = FigureStyle()
STYLE: ContextVar[FigureStyle] = ContextVar("figure_style", default=USUAL)


def check_style(format: str = "png", width: str | None = None, titles: bool = True) -> FigureStyle:
    """Return the style of these keywords, or raise an InputError that names the wrong one.

    >>> check_style("pdf", "127 mm").width
    5.0
    """
    if format not in FORMATS:
        raise InputError(
            f"figure_format = {short_repr(format)}: must be one of {', '.join(FORMATS)}"
        )
    if width is None:
        return FigureStyle(format, None, titles)
    allowed_forms = f'{" or ".join(COLUMNS)}, or a length with a unit such as "120 mm"'
    try:
        size = COLUMNS.get(width) or parse_quantity(width, "mm")
    except InputError as error:
        raise InputError(f"figure_width = {width!r}: {error}; give {allowed_forms}") from None
    if not NARROWEST <= size <= WIDEST:
        limits = f"from {NARROWEST:g} mm to {WIDEST:g} mm"
        raise InputError(f"figure_width = {width!r}: must be {limits}")
    return FigureStyle(format, size / INCH, titles)


@contextmanager
def figure_style(keywords: Wanted) -> Iterator[None]:
    """Draw and save figures within the block with the keywords of `check_style`, if there are any.

    >>> with figure_style({"titles": False}):
    ...     STYLE.get().titles
    False
    """
    if not isinstance(keywords, Mapping) or not keywords:
        yield
        return
    unknown = [str(key) for key in keywords if key not in STYLE_KEYS]
    if unknown:
        raise InputError(
            [f'figures: unknown key "{key}"{nearest(key, STYLE_KEYS)}' for key in unknown]
        )
    token = STYLE.set(check_style(**keywords))
    try:
        yield
    finally:
        STYLE.reset(token)
