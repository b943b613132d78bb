"""Loops of several results over each other."""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from thermobearing.border.errors import InputError
from thermobearing.results import drawing

COLOURS = ("#0077BB", "#CC3311", "#009988", "#EE7733", "#33BBEE", "#EE3377", "#BBBBBB")


def overlay(results: Mapping[str, Any], title: str = "hysteresis loops") -> Figure:
    """Loops of several results in one panel, a colour each.

    Parameters
    ----------
    results : by name, of one kind: of tests, of studies, or of fits.
    title : above the panel.

    Returns
    -------
    Figure

    Raises
    ------
    InputError : nothing to draw, or results whose loops have other axes.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1)
    >>> names = ["shen-hdr-specimen", "shen-lhdr-specimen"]
    >>> figure = overlay({name: tb.run(name, test) for name in names})
    >>> [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    ['shen-hdr-specimen', 'shen-lhdr-specimen']
    """
    if not results:
        raise InputError("no results to draw", "overlay()")
    figure, (ax,) = drawing.panels(1, 1, (6.0, 5.0), title)
    labels = ""
    for number, (name, result) in enumerate(results.items()):
        result.plot.loops(ax=ax, label=name, color=COLOURS[number % len(COLOURS)])
        mine = f"{ax.get_ylabel()} against {ax.get_xlabel()}"
        if labels and mine != labels:
            raise InputError(f'"{name}" has loops of {mine}, not of {labels}', "overlay()")
        labels = mine
    ax.legend(fontsize=drawing.SMALL, frameon=False)
    return figure
