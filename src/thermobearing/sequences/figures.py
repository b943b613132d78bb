"""Figures of a sequence of tests."""

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results import drawing
from thermobearing.sequences.result import SequenceResult

MOST_POINTS = 1500  # of a line
WIDTH, HEIGHT = 2.3, 5.2  # of a part, of the figure [in]


def place_looks(places: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return name and colour of each column of temperatures of a history."""
    colours = drawing.ordered_colours(len(places), "viridis")
    names = [place.removesuffix("_degC").replace("rubber", "layer ") for place in places]
    found = dict(zip(places, zip(names, colours, strict=True), strict=True))
    return {k: (name, drawing.INK if name == "lead" else c) for k, (name, c) in found.items()}


class SequenceFigures(drawing.Figures):
    """Figures of a sequence: `result.plot.sequence()`, a matplotlib Figure."""

    _result: SequenceResult

    def sequence(self) -> Figure:
        """Draw force over displacement, and temperatures in time, a column for each part."""
        result, case = self._result, self._result.case
        count = len(result.parts)
        size = (max(4.5, 0.9 + WIDTH * count), HEIGHT)
        figure, axes = drawing.panels(2, count, size, f"{case.name}: {case.bearing.name}")
        histories = [result.history(k) for k in range(count)]
        looks = place_looks([str(n) for n in histories[0] if str(n).endswith("_degC")])
        for k, history in enumerate(histories):
            loop, warm = axes[k], axes[count + k]
            x, f = history["displacement_mm"].to_numpy(), history["force_kN"].to_numpy()
            loop.plot(x, f, color=drawing.GREY, linewidth=0.8)
            loop.plot(x[:1], f[:1], "o", color=drawing.GREY, markersize=3)
            label = case.label(k)
            drawing.name_axes(loop, "displacement [mm]", "force [kN]" if k == 0 else "", label)
            time = history["time_s"].to_numpy()
            scale, unit = (60.0, "min") if time[-1] > 600.0 else (1.0, "s")
            for place, (_, colour) in looks.items():
                values = history[place].to_numpy(dtype=float)
                kept = drawing.thin(values, MOST_POINTS)
                warm.plot(time[kept] / scale, values[kept], color=colour, linewidth=1.0)
            drawing.name_axes(warm, f"time [{unit}]", "temperature [degC]" if k == 0 else "")
        for row in (axes[:count], axes[count:]):
            _same_limits(row)
        reach = max(abs(value) for ax in axes[:count] for value in ax.get_xlim())
        for ax in axes[:count]:
            ax.set_xlim(-reach, reach)
        handles = [Line2D([], [], color=colour, label=name) for name, colour in looks.values()]
        drawing.legend_below(figure, handles)
        return figure

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {"sequence": self.sequence}


def _same_limits(axes: Sequence[Axes]) -> None:
    ends = [ax.get_ylim() for ax in axes]
    for ax in axes:
        ax.set_ylim(min(low for low, _ in ends), max(high for _, high in ends))
