"""What an engineer looks at after a test: six figures of a result, drawn from its dataset.

The numbers are those of `Result`; nothing is computed here but where to draw them.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.cyclic.lead_figures import draw_force_shares, draw_lead_temperature
from thermobearing.cyclic.loop_figure import add_loops, draw_loops
from thermobearing.cyclic.profile_figure import draw_profiles
from thermobearing.cyclic.result import Result, run_name
from thermobearing.cyclic.time_axis import TimeAxis
from thermobearing.results import drawing
from thermobearing.results.ranges import limits_passed

Floats = NDArray[np.float64]

SHOWN_CYCLES = (1, 2, 5)  # of Fig. 4.8
KJ = 1e-3  # kN mm -> kN m = kJ


class NothingToDrawError(InputError):
    """The result does not hold what a figure shows."""


class Figures:
    """Figures of a result: `result.plot.loops()` and so on, each a matplotlib Figure.

    Colours go from blue (the coldest ambient temperature) to red (the warmest). The rests of
    a test are long and the loadings short: rests are cut out of, or shortened on, the axis
    of time.

    Parameters
    ----------
    result : of a displacement-controlled test.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> figure = tb.run("shen-hdr-specimen", test, ambient=23).plot.loops()
    >>> figure.savefig("loops.png")  # doctest: +SKIP
    """

    def __init__(self, result: Result) -> None:
        self._result = result
        self._data = result.dataset
        self._ambient = np.asarray(result["ambient"].values, dtype=float)
        self._colours = drawing.ambient_colours(self._ambient)

    def _title(self, what: str) -> str:
        return f"{self._data.attrs.get('title', self._result.bearing_name)}: {what}"

    def _run_title(self, run: int) -> str:
        """The ambient temperature, and what ended the run if it did not complete."""
        outcome = str(self._data["outcome"].values[run])
        ended = "" if outcome == "completed" else f" ({outcome.replace('_', ' ')})"
        rows = self._result.tested_range.to_dict("records")
        untested = "ambient" in limits_passed(rows, [run_name(self._ambient[run])])[0].split()
        told = " (not tested)" if untested else ""
        return f"ambient {drawing.degrees(self._ambient[run])}{told}{ended}"

    def _needs(self, name: str, figure: str, group: str) -> None:
        if name not in self._data:
            raise NothingToDrawError(
                f'{figure}: the result holds no {name}; run with keep=["{group}", ...]'
            )

    def displacement(self) -> Figure:
        """Imposed displacement against time, as Fig. 3.5; the rests are cut out.

        Returns
        -------
        Figure : shear displacement [mm] on the left, shear strain [%] on the right.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.displacement().axes[0].get_ylabel()
        'shear displacement [mm]'
        """
        time = TimeAxis(self._result, cut=True)
        figure, (ax,) = drawing.panels(1, 1, (9.0, 3.4), self._title("imposed displacement"))
        run = time.farthest
        ax.plot(
            *time.trace(run, self._data["displacement"].values[run]),
            color=drawing.INK,
            linewidth=0.9,
        )
        time.set_ticks(ax)
        drawing.name_axes(ax, time.caption(), "shear displacement [mm]")
        factor = 100.0 / float(self._data.attrs["total_rubber_thickness_mm"])
        strain = ax.secondary_yaxis("right", functions=drawing.scaling(factor))
        strain.set_ylabel("shear strain [%]", fontsize=drawing.NORMAL)
        strain.tick_params(labelsize=drawing.SMALL, color=drawing.GREY)
        strain.spines["right"].set_visible(False)  # the panel has one
        time.cut_out_rests(ax)
        time.label_loadings(ax)
        return figure

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str | None = None) -> Figure:
        """Stress-strain loops, one panel per ambient temperature, as Fig. 4.7.

        All panels have the same axes. Stress is the force over the gross plan area, strain the
        displacement over the total rubber thickness; rests are left out.

        Parameters
        ----------
        ax : draw all temperatures into this panel instead.
        label, color : of what is drawn into it; the temperature and its colour by default.

        Returns
        -------
        Figure : shear stress [MPa] against shear strain [%].

        Raises
        ------
        NothingToDrawError : the test only rests.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.loops().axes[0].get_xlabel()
        'shear strain [%]'
        """
        if all(about["kind"] == "rest" for about in self._result.segments):
            raise NothingToDrawError("loops: the bearing does not move in this test")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        if ax is None:
            title = self._title("shear stress-strain loops")
            return draw_loops(self._result, title, titles, self._colours)
        labels = [label, *[""] * (len(titles) - 1)] if label else titles
        add_loops(ax, self._result, labels, [color] * len(titles) if color else self._colours)
        return drawing.figure_of(ax)

    def measures(self) -> Figure:
        """Equivalent shear modulus and damping ratio against strain, as Fig. 4.8.

        Cycles 1, 2 and 5 of each amplitude are joined by lines (the last one if there are
        fewer than five). The cycles of a recorded history are points without lines.

        Returns
        -------
        Figure : G_e [MPa] (Eq. 3.1) and h_eq (Eq. 3.2) against shear strain [%].

        Raises
        ------
        NothingToDrawError : no cycle was closed.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> [ax.get_ylabel() for ax in result.plot.measures().axes]
        ['equivalent shear modulus $G_e$ [MPa]', 'equivalent damping ratio $h_{eq}$ [-]']
        """
        cycles = self._result.cycles
        if len(cycles) == 0:
            raise NothingToDrawError("measures: the result has no closed cycle")
        shown = self._shown_cycles()
        figure, axes = drawing.panels(
            1, 2, (9.0, 4.2), self._title("equivalent modulus and damping")
        )
        for ax, column, label in (
            (axes[0], "G_eq_MPa", "equivalent shear modulus $G_e$ [MPa]"),
            (axes[1], "h_eq", "equivalent damping ratio $h_{eq}$ [-]"),
        ):
            for ambient, colour in zip(self._ambient, self._colours, strict=True):
                for _, table, look in shown:
                    mine = table[table["ambient_degC"] == ambient]
                    strain = 100.0 * mine["amplitude_strain"]
                    ax.plot(strain, mine[column], **drawing.look_of(*look, colour))
            drawing.name_axes(ax, "shear strain amplitude [%]", label)
            ax.set_xlim(0.0, 108.0 * float(cycles["amplitude_strain"].max()))
            ax.set_ylim(0.0, 1.08 * float(cycles[column].max()))
        handles = [
            Line2D([], [], color=colour, linewidth=3.0, label=self._run_title(run))
            for run, colour in enumerate(self._colours)
        ]
        handles += [
            Line2D([], [], label=name, **drawing.look_of(*look, drawing.GREY))
            for name, _, look in shown
        ]
        drawing.legend_below(figure, handles)
        return figure

    def _shown_cycles(self) -> list[tuple[str, pd.DataFrame, tuple[str, str]]]:
        """Name, rows of `Result.cycles` and look of each line of `measures`."""
        cycles = self._result.cycles
        if any(about["kind"] == "recorded" for about in self._result.segments):
            return [("every cycle", cycles, drawing.POINTS)]
        last = min(int(cycles["cycle"].max()), max(SHOWN_CYCLES))
        numbers = sorted({n for n in SHOWN_CYCLES if n <= last} | {last})
        return [
            (f"cycle {n}", cycles[cycles["cycle"] == n], look)
            for n, look in zip(numbers, drawing.CYCLE_LOOKS, strict=False)
        ]

    def layer_temperatures(self) -> Figure:
        """Temperature of each rubber layer in time, as Fig. 4.9.

        One panel per ambient temperature, all with the same number of kelvin. Loadings are
        drawn to scale; rests (shaded) start to scale and turn logarithmic.

        Returns
        -------
        Figure : temperature at mid-thickness of the layers [degC].

        Raises
        ------
        NothingToDrawError : layer temperatures were not kept.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.layer_temperatures().axes[0].get_ylabel()
        'rubber temperature [°C]'
        """
        self._needs("rubber_temperature", "layer_temperatures", "rubber")
        time = TimeAxis(self._result)
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        figure, axes = time.rows_of_panels(self._title("temperature of the rubber layers"), titles)
        names = drawing.layer_names(self._data.sizes["layer"], bool(self._data.attrs["half_stack"]))
        colours = drawing.ordered_colours(len(names), "plasma")
        lows, highs = [], []
        for run, ax in enumerate(axes):
            values = self._data["rubber_temperature"].values[run, : time.rows[run]]
            for j, (name, colour) in enumerate(zip(names, colours, strict=True)):
                x, y = time.trace(run, values[:, j])
                # Later layers are thinner: where two agree, both are seen.
                ax.plot(x, y, color=colour, label=name, linewidth=2.0 - 1.2 * j / len(names))
            ax.axhline(self._ambient[run], color=drawing.GREY, linewidth=0.8, linestyle=":")
            drawing.name_axes(ax, y="rubber temperature [°C]")
            lows.append(min(float(values.min()), self._ambient[run]))
            highs.append(max(float(values.max()), self._ambient[run]))
        span = max(float(np.max(np.subtract(highs, lows))), 0.1)
        for ax, low in zip(axes, lows, strict=True):
            ax.set_ylim(low - 0.05 * span, low + 1.08 * span)
        drawing.legend_below(figure, [*axes[0].get_lines()[: len(names)], drawing.ambient_handle()])
        return figure

    def profiles(self) -> Figure:
        """Temperature through the height at the end of each amplitude, as Fig. 4.10.

        Lines join the centres of the cells; bands show steel (grey) and rubber. A half stack
        ends at the plane of symmetry, a full stack at the lower face.

        Returns
        -------
        Figure : distance from the upper face [mm] against temperature [degC].

        Raises
        ------
        NothingToDrawError : cell temperatures were not kept.

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.profiles().axes[0].get_ylabel()
        'distance from the upper face [mm]'
        """
        self._needs("temperature", "profiles", "cells")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        title = self._title("temperature at the end of each loading")
        return draw_profiles(self._result, title, titles)

    def lead_temperature(self) -> Figure:
        """Temperature of the lead beside that of the innermost rubber layer, as Fig. 5.8.

        Raises
        ------
        NothingToDrawError : the bearing has no lead, or layers were not kept.
        """
        self._needs_lead("lead_temperature")
        self._needs("rubber_temperature", "lead_temperature", "rubber")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        return draw_lead_temperature(self._result, self._title("temperature of the lead"), titles)

    def force_shares(self) -> Figure:
        """Shares of rubber, lead and rate-dependent branch in the force, as Fig. 5.15.

        Raises
        ------
        NothingToDrawError : nothing but rubber carries force, or there are no cycles.
        """
        self._needs_lead("force_shares")
        if not any(about["kind"] == "cycles" for about in self._result.segments):
            raise NothingToDrawError("force_shares: the test has no cycles")
        titles = [self._run_title(run) for run in range(len(self._ambient))]
        return draw_force_shares(self._result, self._title("shares of the force"), titles)

    def _needs_lead(self, figure: str) -> None:
        if not self._result.has_lead:
            raise NothingToDrawError(f"{figure}: the bearing has no lead")

    def energy(self) -> Figure:
        """Where the work goes: heat released, stored and lost, and recoverable energy, in time.

        The titles give the residuals of the balances at the end, relative to the work. The
        published scheme does not conserve heat, so its residual is not zero.

        Returns
        -------
        Figure : energies since the start [kJ = kN m].

        Examples
        --------
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> result.plot.energy().axes[0].get_ylabel()
        'energy [kJ = kN m]'
        """
        time = TimeAxis(self._result)
        titles = [
            f"{self._run_title(run)}; relative residual of the balance: "
            f"mechanical {drawing.residual(mechanical)}, thermal {drawing.residual(thermal)}"
            for run, (mechanical, thermal) in enumerate(
                self._result.energy[["mechanical_residual", "thermal_residual"]].to_numpy()
            )
        ]
        figure, axes = time.rows_of_panels(self._title("energy balance"), titles)
        for run, ax in enumerate(axes):
            for name, label, colour, line, width in drawing.ENERGIES:
                values = KJ * self._data[name].values[run]
                look: drawing.Look = {"color": colour, "linestyle": line, "linewidth": width}
                ax.plot(*time.trace(run, values), label=label, **look)
            drawing.name_axes(ax, y="energy [kJ = kN m]")
        drawing.legend_below(figure, axes[0].get_lines()[: len(drawing.ENERGIES)])
        return figure

    def save_all(self, directory: str | Path) -> list[Path]:
        """Write every figure the result holds data for, as PNG.

        Parameters
        ----------
        directory : where to; made if it does not exist.

        Returns
        -------
        list of the files written; figures without data are left out.

        Examples
        --------
        >>> import tempfile
        >>> import thermobearing as tb
        >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
        >>> with tempfile.TemporaryDirectory() as directory:
        ...     files = result.plot.save_all(directory)
        >>> len(files)
        6
        """
        directory = Path(directory)
        directory.mkdir(parents=True, exist_ok=True)
        written = []
        for name, draw in (
            ("imposed_displacement", self.displacement),
            ("loops", self.loops),
            ("measures", self.measures),
            ("layer_temperatures", self.layer_temperatures),
            ("lead_temperature", self.lead_temperature),
            ("force_shares", self.force_shares),
            ("profiles", self.profiles),
            ("energy_balance", self.energy),
        ):
            try:
                figure = draw()
            except NothingToDrawError:
                continue
            path = directory / f"{name}.png"
            drawing.save_figure(figure, path)
            written.append(path)
        return written
