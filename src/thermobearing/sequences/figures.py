"""One figure of a sequence: loops and temperatures of every part, side by side."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.results.drawing import (
    GREY,
    legend_below,
    name_axes,
    ordered_colours,
    panels,
    save_figures,
    thin,
)

if TYPE_CHECKING:
    from thermobearing.sequences.result import SequenceResult

MOST_POINTS = 1500  # of a line
WIDTH, HEIGHT = 2.3, 5.2  # of a part, of the figure [in]
LEAD = "#1a1a1a"


class SequenceFigures:
    """Views of a sequence."""

    def __init__(self, result: "SequenceResult") -> None:
        self.result = result

    def sequence(self) -> Figure:
        """Force over displacement, and temperatures in time, a column for each part."""
        result, case = self.result, self.result.case
        count = len(result.parts)
        size = (max(4.5, 0.9 + WIDTH * count), HEIGHT)
        figure, axes = panels(2, count, size, f"{case.name}: {case.bearing.name}")
        histories = [result.history(k) for k in range(count)]
        degrees = [str(n) for n in histories[0] if str(n).endswith("_degC")]
        colours = dict(zip(degrees, ordered_colours(len(degrees), "viridis"), strict=True))
        colours |= {"lead_degC": LEAD}
        for k, history in enumerate(histories):
            loop, warm = axes[k], axes[count + k]
            x, f = history["displacement_mm"].to_numpy(), history["force_kN"].to_numpy()
            loop.plot(x, f, color=GREY, linewidth=0.8)
            loop.plot(x[:1], f[:1], "o", color=GREY, markersize=3)
            name_axes(loop, "displacement [mm]", "force [kN]" if k == 0 else "", case.label(k))
            time = history["time_s"].to_numpy()
            size_of, unit = (60.0, "min") if time[-1] > 600.0 else (1.0, "s")
            for name in degrees:
                values = history[name].to_numpy(dtype=float)
                kept = thin(values, MOST_POINTS)
                warm.plot(time[kept] / size_of, values[kept], color=colours[name], linewidth=1.0)
            name_axes(warm, f"time [{unit}]", "temperature [degC]" if k == 0 else "")
        self._alike(axes[:count], moving=True)
        self._alike(axes[count:], moving=False)
        handles = [
            Line2D(
                [], [], color=colours[n], label=n.removesuffix("_degC").replace("rubber", "layer ")
            )
            for n in degrees
        ]
        legend_below(figure, handles)
        return figure

    def _alike(self, axes: list[Any], *, moving: bool) -> None:
        """The same limits in a row of panels."""
        low, high = np.array([ax.get_ylim() for ax in axes]).T
        for ax in axes:
            ax.set_ylim(low.min(), high.max())
        if moving:
            reach = max(abs(value) for ax in axes for value in ax.get_xlim())
            for ax in axes:
                ax.set_xlim(-reach, reach)

    def save_all(self, folder: Path) -> list[Path]:
        """Write every figure."""
        return save_figures({"sequence": self.sequence}, folder)
