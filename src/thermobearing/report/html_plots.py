"""Interactive figures of an HTML report."""

import base64
import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.report.html_tables import escaped
from thermobearing.report.pieces import Plot, ReportFigure, Trace
from thermobearing.results.drawing import thin, thin_loops

Floats = NDArray[np.float64]
MOST_POINTS = 6_000  # of a line: more than a wide screen has places, with room to zoom
FEWEST_POINTS = 400  # of a line, however many there are
ALL_POINTS = 300_000  # of all lines of a page: 3.2 MB of it
CLOSER = 4.0  # a loop is thinned as if it were drawn so many times larger


def points_each(plots: Sequence[Plot]) -> int:
    """Points that every line of a page may keep so that all of them have room.

    Parameters
    ----------
    plots : of the page.

    Returns
    -------
    int : the same for each line; those that are shorter leave room for the others.

    Examples
    --------
    >>> points_each([])
    6000
    """
    lines = [t for plot in plots for traces in plot.choices.values() for t in traces]
    moving = sum(t.frames.size for t in lines if t.frames is not None)
    lengths = sorted(len(t.x) for t in lines if t.frames is None)
    room = ALL_POINTS - moving / 2.0
    for done, length in enumerate(lengths):
        share = room / (len(lengths) - done)
        if length > share:
            return int(np.clip(share, FEWEST_POINTS, MOST_POINTS))
        room -= length
    return MOST_POINTS


def plot_html(figure: ReportFigure, number: int, most: int) -> str:
    """A plot with its menu, slider, caption and numbers.

    Parameters
    ----------
    figure : with a plot.
    number : of it in the document.
    most : points of a line, see `points_each`.

    Examples
    --------
    >>> line = Trace("force", np.array([0.0, 1.0]), np.array([2.0, 3.0]))
    >>> plot = Plot("x [mm]", "force [kN]", {"": [line]})
    >>> "plot-1" in plot_html(ReportFigure("A loop", plot=plot), 1, 100)
    True
    """
    plot = figure.plot
    assert plot is not None
    name = f"plot-{number}"
    alt = escaped(figure.alt or figure.caption)
    shaded = _shaded_words(plot)
    note = f'<p class="note">Shaded: {escaped("; ".join(shaded))}.</p>\n' if shaded else ""
    data = json.dumps(plot_data(plot, most), allow_nan=False, separators=(",", ":"))
    data = data.replace("<", "\\u003c")  # no sign that could end the element
    return (
        f'<figure class="figure has-plot" id="figure-{number}">\n{_steering(plot, name)}'
        f'<div class="plot" id="{name}" role="group" aria-label="{alt}"></div>\n'
        "<noscript><p>This plot is drawn by a script, which this reader does not run; "
        "the PDF has the figure.</p></noscript>\n"
        f'<figcaption><span class="number">Figure {number}.</span> '
        f"{escaped(figure.caption)}</figcaption>\n{note}"
        f'<script type="application/json">{data}</script>\n</figure>\n'
    )


def _steering(plot: Plot, name: str) -> str:
    """Menu and slider, each with its label, and what is chosen, for paper."""
    parts = []
    if len(plot.choices) > 1:
        options = "".join(f"<option>{escaped(words)}</option>" for words in plot.choices)
        parts.append(
            f'<span><label for="{name}-menu">Show</label>'
            f'<select id="{name}-menu" autocomplete="off">{options}</select></span>'
        )
    if plot.slider:
        words = escaped(plot.slider_title.capitalize() or "Place")
        parts.append(
            f'<span class="slide"><label for="{name}-slider">{words}</label>'
            f'<input type="range" id="{name}-slider" min="0" max="{len(plot.slider) - 1}" '
            f'value="0" autocomplete="off">'
            f'<output for="{name}-slider">{escaped(plot.slider[0])}</output></span>'
        )
    if not parts:
        return ""
    return f'<div class="steer">{"".join(parts)}<p class="print-only"></p></div>\n'


def plot_data(plot: Plot, most: int) -> dict[str, Any]:
    """What the script of the page draws a plot from.

    Parameters
    ----------
    plot : to draw.
    most : points of a line.

    Returns
    -------
    dict : `arrays` are 4-byte floats in base64; traces call them by their place, so that an axis
        that many share is written once.

    Examples
    --------
    >>> line = Trace("force", np.array([0.0, 1.0]), np.array([2.0, 3.0]))
    >>> plot_data(Plot("x [mm]", "force [kN]", {"": [line]}), 100)["choices"][0][0]["y"]
    1
    """
    places: dict[str, int] = {}
    choices = [[_trace_data(t, most, places) for t in traces] for traces in plot.choices.values()]
    return {
        "x_title": plot.x_title,
        "y_title": plot.y_title,
        "slider": list(plot.slider),
        "slider_title": plot.slider_title,
        "equal": plot.equal,
        "bands": [[_end(low), _end(high)] for low, high, _ in plot.bands],
        "choices": choices,
        "arrays": list(places),
    }


def _trace_data(trace: Trace, most: int, places: dict[str, int]) -> dict[str, Any]:
    def place(values: Floats | None) -> int | None:
        if values is None:
            return None
        numbers = np.ascontiguousarray(values, dtype="<f4")
        text = base64.b64encode(numbers.tobytes()).decode("ascii")
        return places.setdefault(text, len(places))

    moving = trace.frames is not None or trace.frames_x is not None
    x, y = (trace.x, trace.y) if moving else thinned(trace.x, trace.y, most)
    return {
        "name": trace.name,
        "colour": trace.colour,
        "look": trace.look,
        "x": place(x),
        "y": place(y),
        "frames_x": place(trace.frames_x),
        "frames_y": place(trace.frames),
    }


def thinned(x: Floats, y: Floats, most: int) -> tuple[Floats, Floats]:
    """A line of at most about so many points that looks like all of them.

    Of a history the lowest and highest of every piece of time stay, of a path in the plane its
    shape and where it turns. NaN, which interrupts a line, stays.

    Parameters
    ----------
    x, y : of the line.
    most : points to keep; a path that turns at every point keeps up to twice as many.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 1001)
    >>> len(thinned(x, np.sin(x), 100)[0]) <= 110
    True
    """
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if len(x) <= most:
        return x, y
    there = np.isfinite(x) & np.isfinite(y)
    width, height = (max(float(np.ptp(v[there])), 1e-12) if there.any() else 1.0 for v in (x, y))
    kept = []
    edges = np.flatnonzero(np.diff(there, prepend=False, append=False))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        share = max(2, most * (end - first) // len(x))
        xs, ys = x[first:end], y[first:end]
        if (np.diff(xs) >= 0.0).all():
            found = thin(ys, share // 2)
        else:
            found = thin_loops(xs, ys, width / CLOSER, height / CLOSER, share // 2)
        kept += [first + found, [end] if end < len(x) else []]  # the gap after it
    places = np.concatenate([[0], *kept]).astype(np.int64) if kept else np.arange(1)
    places = np.unique(places)
    return x[places], y[places]


def _end(value: float) -> float | None:
    """End of a band; None where it has none."""
    return float(value) if np.isfinite(value) else None


def _shaded_words(plot: Plot) -> list[str]:
    """Words of the bands that the lines of a plot reach, each once."""
    values = [
        np.ravel(t.x if t.frames_x is None else t.frames_x)
        for traces in plot.choices.values()
        for t in traces
    ]
    reached = np.concatenate([*values, []])
    reached = reached[np.isfinite(reached)]
    if not reached.size:
        return []
    low, high = reached.min(), reached.max()
    return list(dict.fromkeys(w for a, b, w in plot.bands if a < high and b > low))


POINTS = 600  # of a history
DIGITS = 5  # of a number


def rounded(values: Floats, digits: int = DIGITS) -> Floats:
    """Numbers with so many digits; NaN stays.

    Examples
    --------
    >>> rounded(np.array([1.23456789, 0.0, np.nan])).tolist()
    [1.2346, 0.0, nan]
    """
    values = np.asarray(values, dtype=float)
    size = np.where(np.isfinite(values) & (values != 0.0), np.abs(values), 1.0)
    scale = 10.0 ** (digits - 1 - np.floor(np.log10(size)))
    return np.round(values * scale) / scale


def history(x: Floats, y: Floats, points: int = POINTS) -> tuple[Floats, Floats]:
    """A history with about so many points; the extremes of each stretch stay.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 10_001)
    >>> x, y = history(t, np.sin(100.0 * t))
    >>> len(x) < 700, bool(y.max() > 0.9999)
    (True, True)
    """
    kept = thin(y, max(points // 2, 1))
    return rounded(x[kept]), rounded(y[kept])


def path(x: Floats, y: Floats, points: int = POINTS) -> tuple[Floats, Floats]:
    """A path in the plane, a loop, with about so many points; its turning points stay."""
    told = np.isfinite(x) & np.isfinite(y)
    x, y = x[told], y[told]
    if len(x) < 3:
        return rounded(x), rounded(y)
    width, height = (max(float(np.ptp(v)), 1e-12) for v in (x, y))
    kept = thin_loops(x, y, width, height, points // 2)
    return rounded(x[kept]), rounded(y[kept])
