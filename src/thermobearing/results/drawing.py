"""Style of figures: panels, colours, legends, thinned histories. Used by figures.py only.

Everything is set on the artists themselves, so that a figure looks the same under any
matplotlib settings and none of the user's settings are touched.
"""

import io
import logging
import math
import re
import textwrap
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Literal

import matplotlib as mpl
import numpy as np
from matplotlib import colormaps, font_manager
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection, PathCollection
from matplotlib.colors import LinearSegmentedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.mathtext import MathTextParser
from matplotlib.patches import Patch
from matplotlib.path import Path as Path2D
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from PIL import Image

from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.core.records import Floats, Ints
from thermobearing.results.figure_style import COLUMNS, INCH, STYLE, figure_style
from thermobearing.results.figure_style import SMALLEST as SMALLEST

MOST_POINTS = 3000  # of a line; what has more is drawn as points at the fineness below
FINENESS = 200  # points an inch of what is no vector
# Letters as outlines: a document shows them without the font. Names of parts do not change.
LOOK = {"svg.fonttype": "path", "svg.hashsalt": "thermobearing"}
# Letters as text that can be edited; the font is embedded in a PDF.
AS_TEXT = LOOK | {"svg.fonttype": "none", "pdf.fonttype": 42}


def _vector_bytes(figure: Figure, kind: str = "svg", *, as_text: bool = False) -> bytes:
    """Return a figure as SVG or PDF; the same bytes for the same figure."""
    for ax in figure.axes:
        for line in ax.get_lines():
            if np.size(line.get_xdata()) > MOST_POINTS:
                line.set_rasterized(True)
    buffer = io.BytesIO()
    date = "Date" if kind == "svg" else "CreationDate"
    dpi = PRINTED_DPI if as_text else FINENESS
    with mpl.rc_context(AS_TEXT if as_text else LOOK):  # type: ignore[arg-type]
        figure.savefig(buffer, format=kind, dpi=dpi, metadata={date: None, "Creator": None})
    return buffer.getvalue()


Look = dict[str, Any]  # how an artist is drawn
DPI = 150  # of a saved figure
PRINTED_DPI = 500  # of a figure of given width
NOTEBOOK_DPI = 100
COLOURS = 256  # of a saved figure: its lines, and their edges that fade into the paper
LARGE, NORMAL, SMALL = SMALLEST + 2.5, SMALLEST + 1.5, SMALLEST + 0.5  # font sizes [pt]
WIDEST = 7.1  # of a figure [inch]: a page of A4 between its margins
FLATTER = 0.6  # power of the factor by which a figure becomes narrower, for its height
LETTER, BOLD_LETTER = 0.56, 0.66  # mean width of a letter, of the font size
MARGIN = 0.7  # between panels, for their labels [inch]
BELOW, LOWEST = 1.0, 1.3  # legend and labels below the panels, and a panel, in height [inch]
LOW = 0.65  # height of panels that go below each other, of their width
NARROWEST = 1.3  # panel of a paper; below it with few ticks [inch]
NARROW = 2.5  # panels below this width break the note on the calibration range [inch]
SHORTEST_LINE = 12  # letters of a title or a label before it is broken
UNBROKEN = "\N{NO-BREAK SPACE}"
HANDLE = 4.5  # width of a legend's line and gaps, of the font size
INK, GREY, PALE, STEEL, RUBBER = "#1a1a1a", "#6b6b6b", "#eef0f3", "#d3d8de", "#fdf6ec"
# Temperatures in every figure, from blue to orange. The lightness (L of OKLab) rises evenly from
# 0.40 to 0.68, so that the order also shows to colour-blind readers and in grey, and ends where
# the contrast with white is still 3 to 1.
COLD_TO_WARM = LinearSegmentedColormap.from_list(
    "cold_to_warm",
    ["#013aa8", "#562dbf", "#8928b4", "#b52698", "#d82b6f", "#ee4337", "#e67502"],
)
COLD, WARM = -20.0, 23.0  # ends of the scale for a single ambient temperature [degC]
HISTORY_POINTS = 1500  # of a line in time
MOST_LOOP_POINTS = 60_000
MARKERS = "os^Dv<>p"
SIDES = {0.02: "left", 0.5: "center", 0.98: "right"}  # places of a note, and how it is aligned
HEIGHTS = {0.02: "bottom", 0.5: "center", 0.98: "top"}
AROUND = 3.0  # a note, where markers may not lie [pt]
BOX: Look = {"facecolor": "white", "pad": 0.5, "linewidth": 0}  # behind a note in a panel
LIMIT: Look = {"color": "#a33", "linewidth": 0.8, "linestyle": (0, (6, 2, 1, 2))}
UNTESTED = "#f6dede"  # outside the calibration range
DRAWING = threading.RLock()  # fonts of matplotlib are shared, and not for several threads
FORMULAS = MathTextParser("agg")
EAST_ASIAN = tuple(read_toml(data_path("reports", "fonts.toml"))["east_asian"])
FIRST_EAST_ASIAN = "\u2e80"  # radicals of Chinese letters
NO_GLYPH = re.compile(r"Glyph (\d+) \(.*\) missing from font")
MOST_CODES = 20  # of missing letters in a sentence
ALIKE = 0.03  # of the range of temperatures: layers this close are drawn as one
LOOP_STEP = 1 / 250  # distance of kept points of a loop, of the size of the panel
EVERY_POINT: ContextVar[bool] = ContextVar("every_point", default=False)


@contextmanager
def every_point() -> Iterator[None]:
    """Draw lines with all of their points within the block, for a plot that can be enlarged."""
    token = EVERY_POINT.set(True)
    try:
        yield
    finally:
        EVERY_POINT.reset(token)


def missing_letters(letters: Iterable[str], where: str) -> str:
    """Return a sentence on letters that no installed font has, and how to get a font."""
    codes = [f"U+{ord(letter):04X}" for letter in sorted(letters)]
    listed = ", ".join(codes[:MOST_CODES])
    if len(codes) > MOST_CODES:
        listed = f"{listed} and {len(codes) - MOST_CODES} more"
    return (
        f"No installed font has some letters of {where} ({listed}); "
        "boxes or codes replace them. Install a font with these letters and draw again: for "
        "Chinese, Japanese and Korean Noto Sans CJK (on Debian and Ubuntu fonts-noto-cjk)."
    )


class MissingLettersWarning(UserWarning):
    """Letters of figures that no installed font has."""

    def __init__(self, letters: set[str]) -> None:
        super().__init__(letters)
        self.letters = letters

    def __str__(self) -> str:
        shown = "".join(letter for letter in sorted(self.letters) if letter.isprintable())
        return missing_letters(self.letters, f"the figures: {shown}".removesuffix(": "))


def without_font(caught: Iterable[warnings.WarningMessage]) -> set[str]:
    """Return the letters of which recorded warnings say that no font has them; raise the others."""
    letters: set[str] = set()
    for warning in caught:
        if isinstance(warning.message, MissingLettersWarning):
            letters |= warning.message.letters
        elif match := NO_GLYPH.search(str(warning.message)):
            letters.add(chr(int(match[1])))
        else:
            warnings.warn(warning.message, warning.category, stacklevel=3)
    return letters


@contextmanager
def _one_warning() -> Iterator[None]:
    """Warn once of all letters without a font in what is drawn."""
    with DRAWING:
        with warnings.catch_warnings(record=True) as recorded:
            warnings.simplefilter("always")
            yield
        if letters := without_font(recorded):
            warnings.warn(MissingLettersWarning(letters), stacklevel=4)


@cache
def _east_asian_fonts() -> list[str]:
    """Return the families of installed fonts with Chinese, Japanese and Korean letters."""
    fonts = font_manager.fontManager.ttflist
    if not {font.name for font in fonts} & set(EAST_ASIAN):  # perhaps installed since the list
        for path in set(font_manager.findSystemFonts()) - {font.fname for font in fonts}:
            with suppress(OSError, RuntimeError):
                font_manager.fontManager.addfont(path)
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return [name for name in EAST_ASIAN if name in installed]


class Picture(Figure):
    """A figure for notebooks, drawn without pyplot."""

    def draw(self, renderer: Any) -> None:
        """Draw all parts; East Asian letters in an installed font that has them.

        Invalid formulas between dollar signs are drawn as plain text.
        """
        for text in self.findobj(Text):
            assert isinstance(text, Text)
            words = text.get_text()
            if words.count("$") > 1:
                try:
                    FORMULAS.parse(words)
                except ValueError:
                    text.set_parse_math(False)
            if max(words, default="") >= FIRST_EAST_ASIAN and (fonts := _east_asian_fonts()):
                text.set_fontfamily(["DejaVu Sans", *fonts])
        log = logging.getLogger("matplotlib.font_manager")
        before = log.level
        log.setLevel(logging.ERROR)  # a font without a bold face needs no message
        try:
            with _one_warning():
                super().draw(renderer)
        finally:
            log.setLevel(before)

    def _repr_png_(self) -> bytes:
        drawn = io.BytesIO()
        self.savefig(drawn, format="png", dpi=NOTEBOOK_DPI)
        return drawn.getvalue()


def parent_figure(ax: Axes) -> Figure:
    """Return the figure that a panel belongs to."""
    figure = ax.get_figure(root=True)
    assert isinstance(figure, Figure)
    return figure


def degrees(value: float) -> str:
    """Return a temperature for a title, with a true minus sign."""
    return f"{round(value, 2):g} °C".replace("-", "\N{MINUS SIGN}")


def ambient_colours(ambient: Floats) -> list[str]:
    """Return colours from cold (blue) to warm (red); of a single temperature by its value."""
    place = np.clip((ambient - COLD) / (WARM - COLD), 0.0, 1.0)
    if len(ambient) > 1:
        place = np.argsort(np.argsort(ambient, kind="stable")) / (len(ambient) - 1)
    return [to_hex(COLD_TO_WARM(float(p))) for p in place]


def ordered_colours(count: int, name: str) -> list[str]:
    """Return colours in a readable order, without the end of the map that is too pale for lines."""
    return [to_hex(colormaps[name](p)) for p in np.linspace(0.0, 0.82, max(count, 2))[:count]]


def panels(
    rows: int,
    columns: int,
    size: tuple[float, float],
    title: str,
    *,
    share: bool | Literal["row", "col"] = False,
    widths: list[float] | None = None,
    least: float = 0.0,
) -> tuple[Figure, list[Axes]]:
    """Return a figure of so many inches with its panels row by row, styled but empty.

    A wider figure is reduced to the width of a page, so that letters have the same size in print.
    The width of `figure_style` counts instead where it has one, or two columns of a paper where
    panels would become too narrow. Panels that need at `least` so many inches go below each other.
    """
    style = STYLE.get()
    width = style.width or min(size[0], WIDEST)
    count = rows * columns
    if style.width and width / columns < least:
        columns = max(int(width / least), 1)
        rows = math.ceil(count / columns)
        size = width, LOW * width * rows / columns
    if style.width and width / columns < NARROWEST:
        width = max(width, COLUMNS["double-column"] / INCH)
    # A narrower figure loses less of its height: labels and legends keep their size.
    size = width, min(1.0, width / size[0]) ** FLATTER * size[1]
    if style.width:
        size = width, max(size[1], BELOW + LOWEST * rows)
    title = title if style.titles else ""
    figure = Picture(figsize=size, layout="constrained")
    if title:
        wrapped, letters = _wrapped_title(title, size[0])
        figure.suptitle(wrapped, fontsize=letters, fontweight="bold", color=INK)
    shared: Look = {"squeeze": False, "sharex": share, "sharey": share, "width_ratios": widths}
    axes = figure.subplots(rows, columns, **shared)
    for ax in axes.flat:
        if width / columns < NARROWEST:
            ax.xaxis.set_major_locator(MaxNLocator(3))
        ax.set_axisbelow(True)
        ax.tick_params(labelsize=SMALL, color=GREY, labelcolor=INK)
        ax.spines[:].set(color=GREY, linewidth=0.7)
        ax.grid(True, color="#dddddd", linewidth=0.6)
    for ax in axes.flat[count:]:
        ax.set_visible(False)
    return figure, list(axes.flat[:count])


TITLE_LINES = 2


def _wrapped_title(title: str, width: float) -> tuple[str, float]:
    """Return a title in at most two lines of a figure so many inches wide, and its font size.

    Letters become smaller before words are left out at the end.
    """
    sizes = np.arange(LARGE, SMALLEST - 0.25, -0.5)
    for letters in sizes:
        room = int(width * 72.0 / (BOLD_LETTER * letters))
        before, colon, after = title.partition(": ")
        for text in (f"{before}:\n{after}" if colon and len(title) > room else title, title):
            lines = [
                part
                for line in text.splitlines()
                for part in textwrap.wrap(line, room, break_on_hyphens=False)
            ]
            if len(lines) <= TITLE_LINES:
                return "\n".join(lines), float(letters)
    lines = textwrap.wrap(
        title, room, max_lines=TITLE_LINES, placeholder=" \N{HORIZONTAL ELLIPSIS}"
    )
    return "\n".join(lines), float(sizes[-1])


def fitting(count: int) -> int:
    """Return how many letters or columns fit in the width of `figure_style`, of those on a page."""
    return int(count * min(1.0, (STYLE.get().width or WIDEST) / WIDEST))


def save_figure(figure: Figure, path: str | Path | io.BytesIO, dpi: int | None = None) -> None:
    """Write a figure as PNG with a palette, a third as large as one with a colour a point."""
    dpi = DPI if dpi is None else dpi
    previous_dpi, figure.dpi = figure.dpi, dpi
    # Laid out and drawn in one go: `savefig` draws twice, and packs a PNG that is unpacked here.
    canvas: Any = FigureCanvasAgg(figure)
    with DRAWING:
        canvas.draw()
    drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    figure.dpi = previous_dpi
    picture = drawn.quantize(COLOURS, dither=Image.Dither.NONE)
    picture.save(path, "PNG", optimize=True, dpi=(dpi, dpi))


def name_axes(ax: Axes, x: str = "", y: str = "", title: str = "", pad: float = 5.0) -> None:
    """Labels with units, and the title of the panel, in lines that are not longer than it."""
    grid = ax.get_gridspec()
    rows, columns = grid.get_geometry() if grid else (1, 1)
    size = parent_figure(ax).get_size_inches()
    width, height = size[0] / columns - MARGIN, (size[1] - BELOW) / rows - 0.5 * MARGIN

    def _fill(text: str, inch: float) -> str:
        room = max(int(inch * 72.0 / (LETTER * NORMAL)), SHORTEST_LINE)
        # A unit stays in the line of its number or name.
        unbroken = text.replace(" °C", f"{UNBROKEN}°C").replace(" [", f"{UNBROKEN}[")
        return textwrap.fill(unbroken, room, break_long_words=False).replace(UNBROKEN, " ")

    if x:
        ax.set_xlabel(_fill(x, width) if STYLE.get().width else x, fontsize=NORMAL)
    if y:
        ax.set_ylabel(_fill(y, height) if STYLE.get().width else y, fontsize=NORMAL)
    if title:
        ax.set_title(_fill(title, width), fontsize=NORMAL, loc="left", pad=pad)


def head_grid(axes: list[Axes], heads: list[str], sides: list[str]) -> None:
    """Write names of columns above a grid of panels, and of rows at its right edge, once each."""
    look: Look = {"fontsize": SMALL, "fontweight": "bold", "color": INK}
    for ax, head in zip(axes, heads, strict=False):
        ax.set_title(head, **look)
    look |= {"rotation": -90, "va": "center", "ha": "left", "textcoords": "offset points"}
    for ax, side in zip(axes[len(heads) - 1 :: len(heads)], sides, strict=False):
        ax.annotate(side, (1.0, 0.5), (4.0, 0.0), xycoords="axes fraction", **look)


class _Note(Text):
    """A note below the lines of a panel that moves, when drawn, to where it meets fewest."""

    def draw(self, renderer: Any) -> None:
        ax = self.axes
        assert ax is not None
        paths = [line.get_path().transformed(line.get_transform()) for line in ax.lines]
        other_texts = [text for text in ax.texts if text is not self and text.get_text()]
        boxes = [text.get_window_extent(renderer) for text in other_texts]

        def _covered(place: tuple[float, float]) -> int:
            self.set(position=place, ha=SIDES[place[0]], va=HEIGHTS[place[1]])
            box = self.get_window_extent(renderer).padded(renderer.points_to_pixels(AROUND))
            inside = sum(int(box.count_contains(path.vertices)) for path in paths)
            crossed = sum(path.intersects_bbox(box, filled=False) for path in paths)
            return inside + crossed + MOST_POINTS * box.count_overlaps(boxes)

        usual = self.get_position()
        # The fewest crossings first, then the place nearest to the usual one.
        places = [(x, y) for x in SIDES for y in HEIGHTS]
        _covered(min(places, key=lambda at: (_covered(at), math.dist(at, usual))))
        super().draw(renderer)


def say_why(ax: Axes, why: str, at: tuple[float, float] = (0.02, 0.02), **look: Any) -> None:
    """Write in a panel why its content is incomplete, near `at` where nothing is drawn there."""
    usual: Look = {"fontsize": SMALLEST, "color": GREY, "zorder": 1.9, "transform": ax.transAxes}
    note = _Note(*at, why, **usual | {"bbox": BOX | {"alpha": 0.7}} | look)
    note.set_in_layout(False)
    ax.add_artist(note)


class EmptyFigureWarning(RuntimeWarning):
    """A figure that holds no data, and is not written."""


def holds_data(figure: Figure) -> bool:
    """Return whether any panel shows a finite point, bar, area or picture.

    Lines and areas across a whole panel, such as a limit, are no data.
    """
    return any(
        bool(ax.images)
        or any(in_data(ax, line) for line in ax.lines)
        or any(_is_finite(ax, patch, patch_path(patch)) for patch in ax.patches)
        or any(map(_collection_holds_data, ax.collections))
        for ax in figure.axes
        if ax.get_visible()
    )


def patch_path(patch: Patch) -> Path2D:
    """Return the outline of a patch in the coordinates of the data."""
    return patch.get_path().transformed(patch.get_patch_transform())


def in_data(ax: Axes, line: Line2D) -> bool:
    """Return whether a line shows finite data, and is no line across the whole panel."""
    return _is_finite(ax, line, line.get_path())


def _is_finite(ax: Axes, artist: Artist, path: Path2D) -> bool:
    """Return whether an artist in the coordinates of the data has a finite point."""
    in_data = all(artist.get_transform().contains_branch_seperately(ax.transData))
    return in_data and bool(np.isfinite(path.vertices).all(axis=-1).any())


def _collection_holds_data(collection: Collection) -> bool:
    if isinstance(collection, PathCollection):
        return bool(np.isfinite(np.ma.filled(collection.get_offsets(), np.nan)).any())
    return any(bool(np.isfinite(path.vertices).any()) for path in collection.get_paths())


def save_figures(
    figures: Mapping[str, Callable[[], Figure]], folder: Path, *, vector: bool = False
) -> list[Path]:
    """Draw and write figures by the name of each file, and return the files.

    They are PNG; a PDF or SVG of `figure_style` is written too. With `vector` as SVG too, for
    documents of results that are read back as tables and pictures. A figure without data is not
    written; an `EmptyFigureWarning` names it.
    """
    style = STYLE.get()
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with _one_warning():
        for name, draw in figures.items():
            figure = draw()
            if not holds_data(figure):
                message = f"the figure {name} holds no data and is not written"
                warnings.warn(EmptyFigureWarning(message), stacklevel=4)
                continue
            written.append(folder / f"{name}.png")
            dpi = PRINTED_DPI if style.width and style.format == "png" else None
            save_figure(figure, written[-1], dpi)
            if style.format != "png":
                written[-1] = folder / f"{name}.{style.format}"
                written[-1].write_bytes(_vector_bytes(figure, style.format, as_text=True))
            if vector and style.format != "svg":
                (folder / f"{name}.svg").write_bytes(_vector_bytes(figure))
    return written


class Figures:
    """Base of the figures of a result.

    A subclass names its figures, or defines `draw_all`: what draws each figure that the result
    holds data for, by name of its file.
    """

    names: ClassVar[tuple[str, ...]] = ()  # of methods that draw a figure
    vector: ClassVar[bool] = False  # as SVG too

    def __init__(self, result: Any) -> None:
        self._result = result

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {name: getattr(self, name) for name in self.names}

    def save_all(self, folder: str | Path, **style: Any) -> list[Path]:
        """Write every figure that the result has data for, and return the files.

        Parameters
        ----------
        folder : str or Path
            Made if needed.
        format : str
            "png" (default), or "pdf" or "svg" with editable text, together with a PNG.
        width : str, optional
            "single-column" (90 mm), "double-column" (190 mm) or a length with a unit; by default
            each figure has its own.
        titles : bool
            Whether figures have a title; that of a panel stays. Default True.

        Raises
        ------
        InputError
            An unknown format, or a width that is no length or not from 60 mm to 400 mm.
        """
        with figure_style(style):
            return save_figures(self.draw_all(), Path(folder), vector=self.vector)


def thin(values: Floats, bins: int) -> Ints:
    """Return points that draw like all: the first, the last, and the extremes of each bin."""
    size = max(1, len(values) // max(bins, 1))
    if size <= 2 or EVERY_POINT.get():  # two extremes of two points: nothing to leave out
        return np.arange(len(values))
    binned = len(values) // size * size
    shaped = values[:binned].reshape(-1, size)
    start = np.arange(0, binned, size)
    remainder = np.arange(binned, len(values))
    picked = [[0], start + shaped.argmin(axis=1), start + shaped.argmax(axis=1), remainder]
    return np.unique(np.concatenate([*picked, [len(values) - 1]])).astype(np.int64)


def thin_loops(
    x: Floats, y: Floats, width: float, height: float, most: int = MOST_LOOP_POINTS
) -> Ints:
    """Return points of a path in the plane that keep its shape.

    They are evenly along it, where it turns, and the extremes of both axes.
    """
    if len(x) < 3 or EVERY_POINT.get():
        return np.arange(len(x))
    path_length = np.concatenate(
        [[0.0], np.cumsum(np.hypot(np.diff(x) / width, np.diff(y) / height))]
    )
    # Lengths are in units of the panel, so that a step is as long on paper in any direction; a
    # point is kept where the path enters another step.
    step = max(LOOP_STEP, path_length[-1] / most)
    kept = np.flatnonzero(np.diff(np.floor(path_length / step), prepend=-1.0))
    turns = 1 + np.flatnonzero(np.diff(x)[:-1] * np.diff(x)[1:] < 0.0)
    noisy = len(turns) >= most  # noise causes the turns: extremes of pieces of the path stay
    pieces = most // (4 if noisy else 16)
    if noisy:
        turns = thin(x, pieces)
    if step > LOOP_STEP:  # a peak beside a turn could be between two kept points
        kept = np.union1d(kept, thin(y, pieces))
    extremes = [place for values in (x, y) for place in (values.argmin(), values.argmax())]
    return np.unique(np.concatenate([kept, turns, extremes, [len(x) - 1]])).astype(np.int64)


def draw_orbit(ax: Axes, x: Floats, y: Floats, name: str, unit: str, **look: Any) -> None:
    """Draw the path of a vector in plan, with equal scales along and across."""
    ax.plot(x, y, linewidth=0.8, **look)
    ax.set_aspect("equal", adjustable="datalim")
    name_axes(ax, f"{name} along x [{unit}]", f"{name} across (y) [{unit}]")


def ambient_handle() -> Line2D:
    """Return the legend entry of the dotted line at the ambient temperature."""
    return Line2D([], [], color=GREY, linewidth=1.0, linestyle=":", label="ambient")


def legend_below(figure: Figure, handles: Sequence[Artist]) -> None:
    """Draw one legend for all panels, in as few rows as the width of the figure allows."""
    room = figure.get_figwidth() * 72.0 / SMALL
    lines = [str(handle.get_label()).splitlines() for handle in handles]
    widths = [LETTER * max(map(len, label_lines), default=0) + HANDLE for label_lines in lines]
    look: Look = {"loc": "outside lower center", "fontsize": SMALL, "frameon": False}
    # Columns of a legend are as wide as their longest entry: rows by the sum of all widths, but no
    # fewer than with columns of the largest width.
    rows = math.ceil(max(sum(widths) / room, len(handles) / max(room // max(widths), 1.0)))
    figure.legend(handles=handles, ncols=math.ceil(len(handles) / rows), **look)


def common_limits(axes: list[Axes]) -> tuple[float, float]:
    """Return the limits that hold the lines of all panels of a row."""
    limits = [ax.dataLim.intervaly for ax in axes if np.isfinite(ax.dataLim.intervaly).all()]
    low, high = min(a for a, _ in limits), max(b for _, b in limits)
    room = 0.06 * max(high - low, 1e-9)
    return low - room, high + room


def temperature_looks(columns: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Return name and colour of the columns of a history that are temperatures."""
    places = [column for column in columns if column.endswith("_degC")]
    names = [place.removesuffix("_degC").replace("rubber", "layer ") for place in places]
    pairs = zip(names, ordered_colours(len(places), "viridis"), strict=True)
    looks = [(name, INK if name == "lead" else colour) for name, colour in pairs]
    return dict(zip(places, looks, strict=True))


def draw_histories(title: str, histories: Mapping[str, Any], force: str = "force [kN]") -> Figure:
    """Draw force over displacement, and temperatures in time, a column for each history.

    A history has the columns displacement_mm, force_kN, time_s, and temperatures (`_degC`).
    """
    count = len(histories)
    figure, axes = panels(2, count, (max(4.5, 0.9 + 2.3 * count), 5.2), title)
    looks = temperature_looks(map(str, next(iter(histories.values()))))
    for k, (name, history) in enumerate(histories.items()):
        loop, warm = axes[k], axes[count + k]
        x, f, time = (history[n].to_numpy() for n in ("displacement_mm", "force_kN", "time_s"))
        kept = thin_loops(x, f, max(np.ptp(x), 1e-9), max(np.ptp(f), 1e-9))
        loop.plot(x[kept], f[kept], color=GREY, linewidth=0.8)
        loop.plot(x[:1], f[:1], "o", color=GREY, markersize=3)
        name_axes(loop, "displacement [mm]", force if k == 0 else "", name)
        scale, unit = (60.0, "min") if time[-1] > 600.0 else (1.0, "s")
        for place, (_, colour) in looks.items():
            values = history[place].to_numpy(dtype=float)
            kept = thin(values, HISTORY_POINTS)
            warm.plot(time[kept] / scale, values[kept], color=colour, linewidth=1.0)
        name_axes(warm, f"time [{unit}]", "temperature [°C]" if k == 0 else "")
    for row in (axes[:count], axes[count:]):
        for ax in row:
            ax.set_ylim(*common_limits(row))
    reach = max(abs(value) for ax in axes[:count] for value in ax.get_xlim())
    for ax in axes[:count]:
        ax.set_xlim(-reach, reach)
    handles = [Line2D([], [], color=colour, label=name) for name, colour in looks.values()]
    legend_below(figure, handles)
    return figure


def shade_untested(
    axes: list[Axes],
    tested: list[tuple[float, float]],
    along: Literal["x", "y"] = "x",
    *,
    note: bool = True,
) -> bool:
    """Shade the area outside the calibration range, with a `note` in each panel.

    Returns whether any panel has such an area.
    """
    place = (0.98, 0.98) if along == "x" else (0.02, 0.02)
    shaded = False
    for ax, (lowest, highest) in zip(axes, tested, strict=False):
        if not np.isfinite([lowest, highest]).any():
            continue
        low, high = ax.get_xlim() if along == "x" else ax.get_ylim()
        span = ax.axvspan if along == "x" else ax.axhspan
        outside = [(a, b) for a, b in ((highest, high), (low, lowest)) if b > a]
        for first, last in outside:
            span(first, last, color=UNTESTED, zorder=0.2, linewidth=0)
        ax.set(**{f"{along}lim": (low, high)})
        shaded = shaded or bool(outside)
        if not (outside and note):
            continue
        grid = ax.get_gridspec()
        narrow = grid is not None and parent_figure(ax).get_figwidth() < NARROW * grid.ncols
        text = f"shaded: outside{chr(10) if narrow else ' '}calibration range"
        say_why(ax, text, place, color=LIMIT["color"])
    return shaded


def note_values(ax: Axes, name: str, values: list[str], colours: list[str]) -> None:
    """Write a name and values at the upper right of a panel, each value in its own colour."""
    look: Look = {"fontsize": SMALLEST, "va": "top", "ha": "right", "zorder": 5}
    look |= {"textcoords": "offset points", "bbox": BOX | {"alpha": 0.7}}
    anchor: Any = ax.transAxes
    at, gap = (1.0, 1.0), (-3.0, -3.0)
    pairs = list(zip(values, colours, strict=True))
    for text, colour in [*reversed(pairs), *([(name, GREY)] if name else [])]:
        words = text.replace("-", "\N{MINUS SIGN}")
        label = ax.annotate(words, at, gap, xycoords=anchor, color=colour, **look)
        label.set_in_layout(False)
        anchor, at, gap = label, (0.0, 1.0), (-4.0, 0.0)


def mark_tested(ax: Axes, largest: float, name: str) -> None:
    """Draw a line at the largest tested value of what the vertical axis shows, if finite.

    Its name stands above the line, or below it where data lie just above.
    """
    if np.isfinite(largest):
        low, high = ax.get_ylim()
        drawn = np.concatenate([np.ravel(line.get_ydata()) for line in ax.lines] + [np.empty(0)])
        data_above = ((drawn > largest) & (drawn < largest + 0.15 * (high - low))).any()
        ax.axhline(largest, **LIMIT)
        look: Look = {
            "fontsize": SMALLEST,
            "color": LIMIT["color"],
            "bbox": BOX | {"alpha": 0.6},
        }
        look |= {
            "va": "top" if data_above else "bottom",
            "ha": "left",
            "zorder": 1.9,
        }  # below lines
        ax.text(0.01, largest, name, transform=ax.get_yaxis_transform(), **look)
