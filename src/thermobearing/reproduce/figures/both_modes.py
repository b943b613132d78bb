"""A history in real time over the same in the pseudo-dynamic test, a panel a temperature."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from thermobearing.earthquake.loop_figures import MODE_LOOKS
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

NAMES = {"rt": "real time", "pd": "pseudo-dynamic"}
BINS = 900


def draw_both_modes(
    result: EarthquakeResult, variable: str, title: str, label: str, factor: float = 1.0
) -> Figure:
    """Panels below each other, from cold to warm, on the time of the earthquake.

    Parameters
    ----------
    result : hybrid tests of one bearing in both modes.
    variable : of its dataset, beside its largest value, "..._max".
    title : of the figure.
    label : of the vertical axis, with the unit that `factor` makes.
    factor : on the values.
    """
    table = result.table
    ambients = sorted(set(table["ambient_degC"]))
    figure, axes = drawing.panels(len(ambients), 1, (drawing.WIDEST, 5.2), title, share=True)
    for ax, ambient in zip(axes, ambients, strict=True):
        mine = table[table["ambient_degC"] == ambient]
        colours, peaks = [], []
        for run, mode in zip(mine.index.to_numpy(), mine["mode"], strict=True):
            told = np.isfinite(result["time"].values[run])
            values = factor * result[variable].values[run][told].astype(float)
            kept = drawing.thin(values, BINS)
            look = MODE_LOOKS[mode]
            ax.plot(result["time"].values[run][told][kept], values[kept], linewidth=0.9, **look)
            colours.append(look["color"])
            peaks.append(f"{factor * float(result[f'{variable}_max'][run]):.3g}")
        ax.margins(y=0.2)
        drawing.note_values(ax, "largest", peaks, colours)
        last = ambient == ambients[-1]
        drawing.name_axes(ax, "time of the earthquake [s]" if last else "", label)
    drawing.head_grid(axes, [""], [drawing.degrees(ambient) for ambient in ambients])
    modes = list(dict.fromkeys(table["mode"]))
    handles = [Line2D([], [], label=NAMES[mode], **MODE_LOOKS[mode]) for mode in modes]
    drawing.legend_below(figure, handles)
    return figure
