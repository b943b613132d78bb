"""Figures of documents: pictures drawn once, and plots that a page draws and matplotlib too."""

import base64
import io
import json
import re
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.core.records import Floats
from thermobearing.report.pieces import Document, FigureBlock, Paragraph, Plot, ReportFigure, Trace
from thermobearing.results import drawing

LOOK: dict[Any, Any] = {
    "svg.fonttype": "path",
    "svg.hashsalt": "thermobearing",  # else names of parts differ from run to run
    "path.simplify": True,
    # What two neighbouring pieces of a line may be off their sum, in points at 72 an inch: a line
    # of 20 000 samples has then hundreds of pieces, and nobody sees it at print width.
    "path.simplify_threshold": 0.15,
}
LARGEST_VECTORS = 300_000  # bytes; a figure of more is written as points into a page
POINTS_AN_INCH = 170  # of a figure of points
OUTLINE = re.compile(rb'\bd="[^"]*"')
TOO_FINE = re.compile(rb"(\.\d\d)\d+")  # below a hundredth of a point
COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
SIDES = ("width", "height")
UNITS = {"pt": 25.4 / 72.0, "mm": 1.0, "cm": 10.0, "in": 25.4, "px": 25.4 / 96.0}  # [mm]


def drawn(document: Document) -> Document:
    """Return the document with every figure as a picture; a warning where letters are missing.

    Figures without data are left out.
    """
    missing: set[str] = set()
    blocks = [
        replace(block, figure=_pictured(block.figure, missing))
        if isinstance(block, FigureBlock)
        else block
        for block in document.blocks
    ]
    blocks = [
        block
        for block in blocks
        if not isinstance(block, FigureBlock)
        or block.figure.draw is None
        or drawing.holds_data(block.figure.draw())
    ]
    if missing:
        blocks.insert(0, Paragraph(drawing.missing_letters(missing, "the figures"), "warning"))
    return replace(document, blocks=blocks)


def page_picture(figure: ReportFigure) -> bytes | None:
    """Return the picture of a figure for a page: points where it is of many vectors."""
    if figure.draw is None:
        return figure.image
    # Beyond this size a figure of points takes less room in the page than its vectors.
    pictured = _pictured(figure, set())
    assert pictured.image is not None
    assert pictured.draw is not None
    if len(pictured.image) <= LARGEST_VECTORS:
        return pictured.image
    points = io.BytesIO()
    drawing.save_figure(pictured.draw(), points, POINTS_AN_INCH)
    return points.getvalue()


def _pictured(figure: ReportFigure, missing: set[str]) -> ReportFigure:
    """Return a figure with its picture, from its drawing or its plot."""
    plot = figure.plot
    draw = figure.draw or (None if plot is None else lambda: _draw_plot(plot))
    if figure.image is not None or draw is None:
        return figure
    draw_once = cache(draw)
    return replace(figure, draw=draw_once, image=_svg_bytes(draw_once(), missing))


def _svg_bytes(figure: Figure, missing: set[str]) -> bytes:
    """Return a figure as SVG, its letters as outlines; letters without a font go to `missing`."""
    buffer = io.BytesIO()
    with mpl.rc_context(LOOK), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    figure.set_layout_engine("none")
    missing |= drawing.without_font(caught)
    without_comments = COMMENT.sub(b"", buffer.getvalue())
    return OUTLINE.sub(lambda outline: TOO_FINE.sub(rb"\1", outline[0]), without_comments)


def picture_size(image: bytes) -> tuple[float, float]:
    """Return width and height of a picture [mm]; of a PNG at its own points an inch."""
    if image.startswith(b"\x89PNG"):
        from PIL import Image

        with Image.open(io.BytesIO(image)) as picture:
            dots = float(picture.info.get("dpi", (150.0, 150.0))[0]) or 150.0
            return picture.width / dots * 25.4, picture.height / dots * 25.4
    head = image[:4096].decode(errors="replace")
    matches = [re.search(rf'\b{name}="([\d.]+)(pt|mm|cm|in|px)?"', head) for name in SIDES]
    if not all(matches):
        return 160.0, 100.0
    width, height = (float(m[1]) * UNITS[m[2] or "px"] for m in matches if m)
    return width, height


# Plots.
MOST_POINTS = 2_400  # of a line: more than a wide screen has places, with room to zoom
FEWEST_POINTS = 400  # of a line, however many there are
ALL_POINTS = 80_000  # of all lines of a page: 0.9 MB of it
CLOSER = 4.0  # a loop is thinned as if it were drawn so many times larger
MOST_PANELS, MOST_FRAMES = 6, 8  # of a plot on paper
NO_MARKER = (None, "None", "none", "", " ")
LOOKS: Mapping[str, dict[str, Any]] = {
    "line": {"linestyle": "-"},
    "broad": {"linestyle": "-", "linewidth": 4.0},
    "dashed": {"linestyle": "--"},
    "points": {"linestyle": "none", "marker": "o"},
    "line with points": {"linestyle": "-", "marker": "o"},
}


OUTSIDE = "outside calibration range"


def blank_panel() -> Axes:
    """Return a panel for what only an interactive plot shows."""
    return Figure().add_subplot()


def plot_from_axes(panels: Mapping[str, Axes], legend: Iterable[Line2D] = ()) -> Plot:
    """Return the interactive plot of drawn panels, which are by the words of a menu.

    Lines have the labels that they were drawn with, or the words of their colour and line in
    `legend` or the legends of the figure. Lines across a panel, such as axes through zero, and
    panels without data are left out; areas outside the calibration range become bands.
    """
    choices: dict[str, list[Trace]] = {}
    bands: dict[tuple[float, float, str], None] = {}
    for words, ax in panels.items():
        figure = drawing.parent_figure(ax)
        drawn_handles = [handle for drawn in figure.legends for handle in drawn.legend_handles]
        handles = [*legend, *(handle for handle in drawn_handles if isinstance(handle, Line2D))]
        if traces := [_trace(line, handles) for line in ax.lines if drawing.in_data(ax, line)]:
            choices[words] = traces
            reached = np.concatenate([trace.x for trace in traces])
            low, high = np.nanmin(reached), np.nanmax(reached)
            shaded = [p for p in ax.patches if to_hex(p.get_facecolor()) == drawing.UNTESTED]
            extents = [drawing.patch_path(patch).get_extents() for patch in shaded]
            bands |= {(e.x0, e.x1, OUTSIDE): None for e in extents if e.x0 < high and e.x1 > low}
    titles = {words: (panels[words].get_xlabel(), panels[words].get_ylabel()) for words in choices}
    x_title, y_title = next(iter(titles.values()), ("", ""))
    # Of panels side by side only the first has a label.
    titles = {words: (x or x_title, y or y_title) for words, (x, y) in titles.items()}
    is_equal = any(panels[words].get_aspect() == 1.0 for words in choices)
    different = {words: pair for words, pair in titles.items() if pair != (x_title, y_title)}
    return Plot(x_title, y_title, choices, equal=is_equal, bands=list(bands), titles=different)


def _trace(line: Line2D, handles: Sequence[Line2D]) -> Trace:
    """Return a drawn line with its name, colour and look."""
    x, y = (np.asarray(values, dtype=np.float64) for values in line.get_data())
    colour, style = to_hex(line.get_color()), line.get_linestyle()
    look = "line" if style == "-" else "dashed"
    if line.get_marker() not in NO_MARKER:
        look = "points" if style == "None" else "line with points"
    name = str(line.get_label())
    if name.startswith("_"):  # matplotlib's own, of a line without a label
        # A grey entry of a legend explains the kind of line, whatever its colour.
        alike = [
            handle
            for handle in handles
            if (drawn := to_hex(handle.get_color())) == colour
            or (drawn == drawing.GREY and handle.get_linestyle() == style)
        ]
        name = ", ".join(str(handle.get_label()) for handle in alike)
    return Trace(name, x, y, colour, look)


def _draw_plot(plot: Plot) -> Figure:
    """Draw a plot for paper: a panel for each choice, the places of a slider as shades."""
    chosen = [list(plot.choices.items())[k] for k in _evenly(len(plot.choices), MOST_PANELS)]
    columns = 1 if len(chosen) == 1 else 2
    rows = -(-len(chosen) // columns)
    size = (7.0, 2.7 * rows + 0.4)
    if columns == 1:
        size = (4.6 if plot.equal else 6.6, 4.4)
    figure, axes = drawing.panels(rows, columns, size, "")
    handles: dict[str, Line2D] = {}
    for ax, (words, traces) in zip(axes, chosen, strict=False):
        for trace in traces:
            _draw_trace(ax, plot, trace, handles)
        low, high = ax.get_xlim()
        for start, end, _ in plot.bands:
            if start < high and end > low:
                ends = max(start, low), min(end, high)
                ax.axvspan(*ends, color=drawing.UNTESTED, zorder=0.2, linewidth=0)
        if plot.equal:
            ax.set_aspect("equal", adjustable="datalim")
        else:
            ax.set_xlim(low, high)
        title = words if len(plot.choices) > 1 else ""
        drawing.name_axes(ax, *plot.axis_titles(words), title)
    for ax in axes[len(chosen) :]:
        ax.remove()
    if len(handles) > 1 or plot.slider:
        drawing.legend_below(figure, list(handles.values()))
    return figure


def _evenly(count: int, most: int) -> list[int]:
    return sorted({round(k) for k in np.linspace(0, count - 1, min(count, most))})


def _draw_trace(ax: Axes, plot: Plot, trace: Trace, handles: dict[str, Line2D]) -> None:
    """Draw a line, or some frames of one that a slider moves."""
    look: drawing.Look = {"linewidth": 1.1, "markersize": 3.0, "color": trace.colour}
    look |= LOOKS[trace.look]
    moving = trace.frames is not None or trace.frames_x is not None
    places = _evenly(len(plot.slider), MOST_FRAMES) if moving else [0]
    for order, place in enumerate(places, 1):
        x = trace.x if trace.frames_x is None else trace.frames_x[place]
        y = trace.y if trace.frames is None else trace.frames[place]
        if not moving:
            x, y = _thinned(x, y, MOST_POINTS)
        (line,) = ax.plot(x, y, alpha=order / len(places), **look)
    name = trace.name
    if moving:
        name = f"{name} ({plot.slider[places[0]]} to {plot.slider[places[-1]]}, later darker)"
    if trace.name:
        handles.setdefault(trace.name, line).set_label(name)


def points_each(plots: Sequence[Plot]) -> int:
    """Return the points that every line of a page may keep so that all of them have room.

    Lines that are shorter leave room for the others.
    """
    lines = [t for plot in plots for traces in plot.choices.values() for t in traces]
    moving = sum(t.frames.size for t in lines if t.frames is not None)
    lengths = sorted(len(t.x) for t in lines if t.frames is None)
    # Shortest first: what they do not use is divided among the longer ones.
    room = ALL_POINTS - moving / 2.0
    for assigned, length in enumerate(lengths):
        share = room / (len(lengths) - assigned)
        if length > share:
            return int(np.clip(share, FEWEST_POINTS, MOST_POINTS))
        room -= length
    return MOST_POINTS


def plot_json(plot: Plot, most: int) -> str:
    """Return what the script of a page draws a plot from.

    `arrays` are 4-byte floats in base64; traces call them by their place, so that an axis that
    many share is written once. A line keeps about `most` points.
    """
    places: dict[str, int] = {}

    def _place(values: Floats | None) -> int | None:
        if values is None:
            return None
        numbers = np.ascontiguousarray(values, dtype="<f4").tobytes()
        return places.setdefault(base64.b64encode(numbers).decode("ascii"), len(places))

    def _trace_data(trace: Trace) -> dict[str, Any]:
        moving = trace.frames is not None or trace.frames_x is not None
        x, y = (trace.x, trace.y) if moving else _thinned(trace.x, trace.y, most)
        data: dict[str, Any] = {"name": trace.name, "colour": trace.colour, "look": trace.look}
        data |= {"x": _place(x), "y": _place(y)}
        return data | {"frames_x": _place(trace.frames_x), "frames_y": _place(trace.frames)}

    data = {
        "titles": [plot.axis_titles(choice) for choice in plot.choices],
        "equal": plot.equal,
        "slider": list(plot.slider),
        "slider_title": plot.slider_title,
        "bands": [
            [float(end) if np.isfinite(end) else None for end in (start, stop)]
            for start, stop, _ in plot.bands
        ],
        "choices": [[_trace_data(trace) for trace in traces] for traces in plot.choices.values()],
    }
    data["arrays"] = list(places)
    return json.dumps(data, allow_nan=False, separators=(",", ":"))


def _thinned(x: Floats, y: Floats, most: int) -> tuple[Floats, Floats]:
    """Return a line of at most about so many points that looks like all of them.

    Of a history the lowest and highest of every piece of time stay, of a path in the plane its
    shape and where it turns (a path that turns at every point keeps up to twice as many). NaN,
    which interrupts a line, stays.
    """
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if len(x) <= most:
        return x, y
    finite = np.isfinite(x) & np.isfinite(y)
    width, height = (max(float(np.ptp(v[finite])), 1e-12) if finite.any() else 1.0 for v in (x, y))
    kept: list[Any] = [[0]]
    # Stretches between gaps are thinned one by one: each has its share of the points.
    edges = np.flatnonzero(np.diff(finite, prepend=False, append=False))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        share = max(2, most * (end - first) // len(x))
        xs, ys = x[first:end], y[first:end]
        if (np.diff(xs) >= 0.0).all():  # a history; otherwise a path in the plane
            chosen = drawing.thin(ys, share // 2)
        else:
            chosen = drawing.thin_loops(xs, ys, width / CLOSER, height / CLOSER, share // 2)
        kept += [first + chosen, [end] if end < len(x) else []]  # the gap after it
    places = np.unique(np.concatenate(kept).astype(np.int64))
    return x[places], y[places]
