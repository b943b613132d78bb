"""Figures of served bearings."""

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.opensees.result import ServedResult
from thermobearing.results import drawing

MOST_POINTS = 1500  # of a line
MOST_ELEMENTS = 6  # that are drawn
WIDTH, HEIGHT = 2.3, 5.2  # of an element, of the figure [in]


class ServedFigures(drawing.Figures):
    """Figures of served bearings: `result.plot.elements()`, a matplotlib Figure."""

    _result: ServedResult

    def elements(self) -> Figure:
        """Draw force over displacement, and temperatures in time, a column for each element."""
        result = self._result
        names = [str(name) for name in result.dataset["element"].values[:MOST_ELEMENTS]]
        count, attrs = len(names), result.dataset.attrs
        title = f"{attrs['bearing']} in OpenSees: {drawing.degrees(attrs['ambient_degC'])}"
        figure, axes = drawing.panels(2, count, (max(4.5, 0.9 + WIDTH * count), HEIGHT), title)
        histories = [result.history(k) for k in range(count)]
        places = [str(name) for name in histories[0] if str(name).endswith("_degC")]
        colours = drawing.ordered_colours(len(places), "viridis")
        looks = dict(zip(places, colours, strict=True)) | (
            {"lead_degC": drawing.INK} if result.has_lead else {}
        )
        for k, (name, history) in enumerate(zip(names, histories, strict=True)):
            loop, warm = axes[k], axes[count + k]
            x, f = history["displacement_mm"].to_numpy(), history["force_kN"].to_numpy()
            kept = drawing.thin_loops(x, f, max(np.ptp(x), 1e-9), max(np.ptp(f), 1e-9))
            loop.plot(x[kept], f[kept], color=drawing.GREY, linewidth=0.8)
            force = "force of one bearing [kN]" if k == 0 else ""
            drawing.name_axes(loop, "displacement [mm]", force, f"element {name}")
            time = history["time_s"].to_numpy()
            for place, colour in looks.items():
                values = history[place].to_numpy()
                kept = drawing.thin(values, MOST_POINTS)
                warm.plot(time[kept], values[kept], color=colour, linewidth=1.0)
            drawing.name_axes(warm, "time [s]", "temperature [°C]" if k == 0 else "")
        for row in (axes[:count], axes[count:]):
            low, high = drawing.common_limits(row)
            for ax in row:
                ax.set_ylim(low, high)
        words = [p.removesuffix("_degC").replace("rubber", "layer ") for p in places]
        handles = [
            Line2D([], [], color=looks[place], label=word)
            for place, word in zip(places, words, strict=True)
        ]
        drawing.legend_below(figure, handles)
        return figure

    def draw_all(self) -> dict[str, Callable[[], Figure]]:
        """Return the function that draws each figure, by name of its file."""
        return {"elements": self.elements}
