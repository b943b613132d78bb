"""Figures of ground motions: histories and response spectra."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

from thermobearing.motions.measures import significant_interval
from thermobearing.motions.record import MM_S2_PER_GAL, GroundMotion
from thermobearing.motions.run import MM_PER_CM, MotionResult
from thermobearing.motions.targets import DesignSpectrum, find_kind, load_spectrum
from thermobearing.quantities.governing import place_of_largest
from thermobearing.results import drawing

BINS = 2000
MOTION_COLOUR, ACROSS_COLOUR = "#0077BB", "#009988"
REFERENCE_LOOKS = (("#CC3311", "--"), ("#EE7733", "-."))
BOTH_TYPES = ("jra-i-i", "jra-ii-i")  # for a motion without a target


def _draw_histories(axes: Sequence[Axes], motion: GroundMotion, name: str, *, labels: bool) -> None:
    """Draw acceleration, velocity and displacement, the significant part shaded."""
    histories = (
        ("acceleration [gal]", "largest {:.0f} gal", motion.acceleration / MM_S2_PER_GAL),
        ("velocity [cm/s]", "largest {:.1f} cm/s", motion.velocity / MM_PER_CM),
        ("displacement [cm]", "largest {:.1f} cm", motion.displacement / MM_PER_CM),
    )
    time, strong = motion.time, significant_interval(motion)
    for ax, (label, title, values) in zip(axes, histories, strict=True):
        ax.axvspan(*strong, color=drawing.PALE, zorder=0, linewidth=0)
        kept = drawing.thin(values, BINS)
        ax.plot(time[kept], values[kept], color=MOTION_COLOUR, linewidth=0.8)
        peak = place_of_largest(np.abs(values))
        ax.plot(time[peak], values[peak], "o", color=drawing.INK, markersize=3.5)
        ax.set_xlim(0.0, time[-1])
        size = name + title.format(abs(values[peak]))
        drawing.name_axes(ax, y=label if labels else "", title=size)
    drawing.name_axes(axes[-1], "time [s]")


def _reference_label(reference: DesignSpectrum) -> str:
    if not reference.standard:
        return f"{reference.words.removeprefix('the ')}, 5 %"
    kind, ground = find_kind(reference.name)
    return f"standard, Level 2 Type {kind}, ground {ground}, 5 %"


class MotionFigures(drawing.Figures):
    """Figures of one ground motion."""

    vector = True
    names = ("motion", "spectrum")
    _result: MotionResult

    def motion(self) -> Figure:
        """Acceleration, velocity and displacement of the ground, the significant part shaded."""
        result = self._result
        records = [(result.motion, "")]
        if result.across is not None:
            pairs = zip([result.motion, result.across.motion], result.records, strict=True)
            records = [(motion, f"{name}: ") for motion, name in pairs]
        count = len(records)
        figure, axes = drawing.panels(3, count, (9.0, 6.2), result.headline, share="row")
        for column, (motion, name) in enumerate(records):
            _draw_histories(axes[column::count], motion, name, labels=column == 0)
        label = "5 to 95 % of Arias intensity"
        drawing.legend_below(figure, [Line2D([], [], color="#d5dae2", linewidth=7.0, label=label)])
        return figure

    def spectrum(self) -> Figure:
        """Response spectra of acceleration and displacement, with standard ones."""
        result, response = self._result, self._result.spectrum
        periods = response.periods
        figure, (left, right) = drawing.panels(1, 2, (10.0, 4.6), result.headline)
        spectra = self._spectra()
        handles = [Line2D([], [], label=label, **look) for label, _, _, look in spectra]
        references = [result.reference] if result.reference else map(load_spectrum, BOTH_TYPES)
        for reference, (colour, line) in zip(references, REFERENCE_LOOKS, strict=False):
            look: drawing.Look = {"color": colour, "linestyle": line, "linewidth": 1.6}
            values = reference.at(periods)
            left.plot(periods, values / MM_S2_PER_GAL, **look)
            # Pseudo displacement: S_a (T / 2 pi)^2.
            right.plot(periods, values * (periods / (2.0 * np.pi)) ** 2 / MM_PER_CM, **look)
            handles.append(Line2D([], [], label=_reference_label(reference), **look))
        for _, acceleration, displacement, look in spectra:
            left.plot(periods, acceleration, **look)
            right.plot(periods, displacement, **look)
        left.set_yscale("log")
        left.yaxis.set_major_formatter(plain := FuncFormatter(lambda value, _: f"{value:g}"))
        percent = f"{100.0 * response.damping:g} % damping"
        kinds = (left, "absolute acceleration", "gal"), (right, "displacement", "cm")
        for ax, kind, unit in kinds:
            ax.set_xscale("log")
            ax.set_xlim(periods[0], periods[-1])
            ax.xaxis.set_major_formatter(plain)
            ax.xaxis.set_minor_formatter(NullFormatter())
            label = f"{kind.split()[-1]} [{unit}]"
            drawing.name_axes(ax, "period [s]", label, f"{kind}, {percent}")
        drawing.legend_below(figure, handles)
        return figure

    def _spectra(self) -> list[tuple[str, Any, Any, drawing.Look]]:
        """Return label, acceleration [gal], displacement [cm] and look of each spectrum."""
        result, response, table = self._result, self._result.spectrum, self._result.table
        first_values = response.acceleration / MM_S2_PER_GAL, response.displacement / MM_PER_CM
        look: drawing.Look = {"color": MOTION_COLOUR, "linewidth": 1.2}
        if result.across is None:
            return [("this motion", *first_values, look)]
        across = result.across.spectrum
        second_values = across.acceleration / MM_S2_PER_GAL, across.displacement / MM_PER_CM
        first, second = result.records
        rotated = [
            (name, table[f"{key}_gal"], table[f"{key}_cm"], {"color": drawing.INK, **line})
            for name, key, line in (
                ("RotD50", "rotd50", {"linewidth": 1.4}),
                ("RotD100", "rotd100", {"linewidth": 1.4, "linestyle": ":"}),
            )
        ]
        return [
            (first, *first_values, look),
            (second, *second_values, {"color": ACROSS_COLOUR, "linewidth": 1.2}),
            *rotated,
        ]
