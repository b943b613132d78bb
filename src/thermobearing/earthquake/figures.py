"""What an engineer looks at after an earthquake study: small multiples, readable.

Rows are bearings, columns motions, colours ambient temperatures from cold (blue) to warm (red).
A study with many motions shows the first few; the table has them all.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from thermobearing.earthquake.loop_figures import draw_largest_loops, draw_modes, has_loops
from thermobearing.earthquake.modes import has_both
from thermobearing.earthquake.parts import has_parts
from thermobearing.earthquake.parts_figure import draw_parts
from thermobearing.earthquake.profile_figure import draw_profiles
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results import drawing

Floats = NDArray[np.float64]
MOST_COLUMNS = 4
WIDTH, HEIGHT = 2.9, 2.4  # of one panel [inch]
TIME_BINS = 900  # points of a history are thinned to two per bin
KJ = 1e-3
SHARES = (
    ("rubber_force", "rubber", "#0072B2"),
    ("lead_force", "lead cores", "#000000"),
    ("viscous_force", "rate-dependent branch", "#D55E00"),
)
LINES: dict[str, Any] = {"": "-", "rt": "-", "pd": "--"}
MODES = {"rt": "real time", "pd": "pseudo-dynamic"}
Draw = Callable[[Axes, int, str], None]


class EarthquakeFigures:
    """Figures of a study: `result.plot.loops()` and so on, each a matplotlib Figure."""

    def __init__(self, result: EarthquakeResult) -> None:
        self._result = result
        self._data = result.dataset
        self._table = result.table
        self._bearings = list(dict.fromkeys(self._table["bearing"]))
        self._motions = list(dict.fromkeys(self._table["motion"]))
        self._ambients = sorted(set(self._table["ambient_degC"]))
        colours = drawing.ambient_colours(np.array(self._ambients, dtype=float))
        self._colours = dict(zip(self._ambients, colours, strict=True))
        self._run_modes = np.array(result.modes)
        self._modes = list(dict.fromkeys(result.modes))

    def _values(self, name: str, run: int) -> Floats:
        values = self._data[name].values[run]
        return np.asarray(values[np.isfinite(self._data["time"].values[run])], dtype=float)

    def _legend(self, figure: Figure, *, modes: bool = True) -> None:
        handles = [
            Line2D([], [], color=self._colours[value], label=f"ambient {drawing.degrees(value)}")
            for value in self._ambients
        ]
        drawing.legend_below(figure, handles + (self._mode_handles() if modes else []))

    def _mode_handles(self) -> list[Line2D]:
        """Legend entries of the modes of a laboratory, if there are several."""
        if len(self._modes) < 2:
            return []
        return [
            Line2D([], [], color=drawing.GREY, linestyle=LINES[mode], label=MODES[mode])
            for mode in self._modes
        ]

    def _line(self, run: int) -> Any:
        """Style of the lines of a run: dashed for pseudo-dynamic beside real time."""
        return LINES[self._result.modes[run]] if len(self._modes) > 1 else "-"

    def _grid(
        self,
        what: str,
        x: str,
        y: str,
        draw: Draw,
        ax: Axes | None = None,
        *,
        strain: Literal["x", "y"] | None = None,
    ) -> Figure:
        """One panel per bearing and motion; `draw` is called for every run in it.

        All runs go into `ax` where somebody gives one. `strain` is the axis that shows the strain
        [%]: beyond the tested range it is shaded.
        """
        if ax is not None:
            for run, ambient in zip(self._table.index, self._table["ambient_degC"], strict=True):
                draw(ax, int(run), self._colours[ambient])
            drawing.name_axes(ax, x, y)
            return drawing.figure_of(ax)
        untested = []
        motions = self._motions[:MOST_COLUMNS]
        rows, columns = len(self._bearings), len(motions)
        size = (max(WIDTH * columns, 5.0) + 0.6, HEIGHT * rows + 0.9)
        more = len(self._motions) - columns
        note = f" (first {columns} of {len(self._motions)} motions)" if more else ""
        title = f"{self._data.attrs['structure']}: {what}{note}"
        figure, axes = drawing.panels(rows, columns, size, title, share=True)
        for panel, ax in enumerate(axes):
            bearing, motion = self._bearings[panel // columns], motions[panel % columns]
            chosen = self._table.query("bearing == @bearing and motion == @motion")
            for run, ambient in zip(chosen.index, chosen["ambient_degC"], strict=True):
                draw(ax, int(run), self._colours[ambient])
            untested.append(100.0 * self._result.tested_to(list(chosen.index), "strain"))
            drawing.name_axes(
                ax,
                x if panel // columns == rows - 1 else "",
                y if panel % columns == 0 else "",
                f"{motion}, {bearing}" if columns > 1 else bearing,
            )
            ax.title.set_fontsize(drawing.SMALL)
        if strain is not None:
            drawing.shade_untested(axes, [(-end, end) for end in untested], strain)
        self._legend(figure)
        return figure

    def _plane(self, x: str, y: str, factor: float = 1.0) -> Draw:
        """A path in the plane of two histories."""

        def draw(ax: Axes, run: int, colour: str) -> None:
            a, b = factor * self._values(x, run), self._values(y, run)
            width, height = max(np.ptp(a), 1e-12), max(np.ptp(b), 1e-12)
            kept = drawing.thin_loops(a, b, width, height)
            ax.plot(a[kept], b[kept], color=colour, linewidth=0.8, linestyle=self._line(run))

        return draw

    def _time(self, name: str, factor: float = 1.0) -> Draw:
        """A history."""

        def draw(ax: Axes, run: int, colour: str) -> None:
            time, values = self._values("time", run), factor * self._values(name, run)
            if not np.isfinite(values).all():
                return
            kept = drawing.thin(values, TIME_BINS)
            line = self._line(run)
            ax.plot(time[kept], values[kept], color=colour, linewidth=0.7, linestyle=line)

        return draw

    def loops(self, ax: Axes | None = None, *, label: str = "", color: str | None = None) -> Figure:
        """Force of one bearing against its strain, as Fig. 6.9 and 6.12 (3.16 to 3.19).

        Parameters
        ----------
        ax : draw all runs into this panel instead of one for each bearing and motion.
        label, color : of what is drawn into it; the colours of the temperatures by default.
        """
        plain = self._plane("bearing_strain", "bearing_force", 100.0)

        def draw(panel: Axes, run: int, colour: str) -> None:
            plain(panel, run, color or colour)
            if label and run == 0:
                panel.get_lines()[-1].set_label(label)

        what, x = "hysteresis of one bearing", "shear strain [%]"
        return self._grid(what, x, "force [kN]", draw, ax, strain="x")

    def largest_loops(self) -> Figure:
        """The largest loop, the bearings over each other, as Fig. 4.12 and 6.6."""
        return draw_largest_loops(self._result)

    def parts(self) -> Figure:
        """Every bearing line and every pier beside each other, where there are several."""
        return draw_parts(self._result)

    def modes(self) -> Figure:
        """Real time over pseudo-dynamic: loops of the specimen, as Fig. 3.16 to 3.19."""
        return draw_modes(self._result)

    def strain(self, ax: Axes | None = None) -> Figure:
        """Shear strain in time, as Fig. 6.10 and 6.13."""
        draw = self._time("bearing_strain", 100.0)
        what, y = "shear strain of the bearings", "shear strain [%]"
        return self._grid(what, "time [s]", y, draw, ax, strain="y")

    def pier(self, ax: Axes | None = None) -> Figure:
        """Displacement of the pier top relative to its base, as Fig. 6.17 and 6.19."""
        draw = self._time("pier_displacement")
        return self._grid(
            "pier top relative to its base", "time [s]", "displacement [mm]", draw, ax
        )

    def pier_acceleration(self, ax: Axes | None = None) -> Figure:
        """Absolute acceleration of the pier top, as Fig. 3.27, 3.29, 4.15, 5.18 and 5.20."""
        draw = self._time("pier_top_acceleration")
        return self._grid(
            "acceleration of the pier top", "time [s]", "acceleration [m/s2]", draw, ax
        )

    def hinge(self, ax: Axes | None = None) -> Figure:
        """Moment against rotation of the pier base, as Fig. 6.21 and 6.22."""
        draw = self._plane("pier_rotation", "pier_moment", 1e3)
        return self._grid("pier base", "rotation [mrad]", "moment [kN m]", draw, ax)

    def deck(self, ax: Axes | None = None) -> Figure:
        """Absolute acceleration of the deck, as Fig. 6.23 and 6.25."""
        draw = self._time("deck_acceleration")
        return self._grid("acceleration of the deck", "time [s]", "acceleration [m/s2]", draw, ax)

    def energy(self, ax: Axes | None = None) -> Figure:
        """Work done on one bearing in time, as Fig. 3.25."""
        draw = self._time("bearing_energy", KJ)
        return self._grid("energy taken by one bearing", "time [s]", "energy [kJ]", draw, ax)

    def temperature(self) -> Figure:
        """Rubber layers (solid, outer layer palest) and lead (dashed), as Fig. 3.20 and 5.16."""

        def draw(ax: Axes, run: int, colour: str) -> None:
            time = self._values("time", run)
            layers = self._data["rubber_temperature"].values[run][: len(time)]
            count = int(np.isfinite(layers[0]).sum())
            for j in range(count):
                fade = 0.35 + 0.65 * (j + 1) / count
                kept = drawing.thin(layers[:, j].astype(float), TIME_BINS)
                look: drawing.Look = {"color": colour, "alpha": fade, "linewidth": 0.9}
                line = ":" if self._line(run) == "--" else "-"  # lead is dashed
                ax.plot(time[kept], layers[kept, j], linestyle=line, **look)
            lead = self._values("lead_temperature", run)
            if np.isfinite(lead).all():
                end = self._result.tested_to([run], "lead_temperature")
                drawing.mark_tested(ax, end, "lead tested to here")
                kept = drawing.thin(lead, TIME_BINS)
                line = "-." if self._line(run) == "--" else "--"
                ax.plot(time[kept], lead[kept], color=colour, linewidth=0.9, linestyle=line)

        what = "rubber layers (solid; outer palest) and lead (dashed)"
        what += "; pseudo-dynamic dotted and dash-dotted" if len(self._modes) > 1 else ""
        return self._grid(what, "time [s]", "temperature [°C]", draw)

    def speed(self) -> Figure:
        """Loading speed of the bearing on its own clock, as Fig. 3.15."""
        draw = self._time("bearing_speed")
        return self._grid("loading speed", "time [s]", "speed [mm/s]", draw)

    def profiles(self, times: Sequence[float] | None = None) -> Figure:
        """Temperature through the height, the bearings below each other, as Fig. 4.14 and 5.17.

        Parameters
        ----------
        times : since the start of the motion [s], at most 8; quarters of it by default.

        Raises
        ------
        InputError : the study did not keep cells, or a time is not in it.
        """
        return draw_profiles(self._result, times)

    def shares(self) -> Figure:
        """Shares of rubber, lead and rate dependence in the force, as Fig. 5.15.

        The first motion; rows are bearings, columns ambient temperatures.
        """
        motion, columns = self._motions[0], len(self._ambients)
        size = (max(WIDTH * columns, 5.0) + 0.6, HEIGHT * len(self._bearings) + 0.9)
        title = f"{self._data.attrs['structure']}: shares of the force of one bearing, {motion}"
        figure, axes = drawing.panels(len(self._bearings), columns, size, title, share=True)
        for panel, ax in enumerate(axes):
            bearing, ambient = self._bearings[panel // columns], self._ambients[panel % columns]
            chosen = self._table.query(
                "bearing == @bearing and motion == @motion and ambient_degC == @ambient"
            )
            for run in chosen.index:
                time = self._values("time", int(run))
                for name, _, colour in SHARES:
                    values = self._values(name, int(run))
                    if not values.any():  # the bearing has no such branch
                        continue
                    kept = drawing.thin(values, TIME_BINS)
                    line = self._line(int(run))
                    ax.plot(time[kept], values[kept], color=colour, linewidth=0.7, linestyle=line)
            drawing.name_axes(
                ax,
                "time [s]" if panel // columns == len(self._bearings) - 1 else "",
                "force [kN]" if panel % columns == 0 else "",
                f"{bearing}, {drawing.degrees(ambient)}",
            )
            ax.title.set_fontsize(drawing.SMALL)
        drawing.legend_below(
            figure,
            [Line2D([], [], color=colour, label=label) for _, label, colour in SHARES]
            + self._mode_handles(),
        )
        return figure

    def peaks(self) -> Figure:
        """Peaks of every run, as Fig. 6.11, 6.14 to 6.16, 6.18, 6.20, 6.24 and 6.26."""
        shown: list[tuple[str, str, float]] = [
            ("bearing_strain_max", "bearing strain [%]", 100.0),
            ("bearing_force_max_kN", "bearing force [kN]", 1.0),
            ("bearing_energy_kN_mm", "bearing energy [kJ]", KJ),
            ("pier_displacement_max_mm", "pier displacement [mm]", 1.0),
            ("pier_ductility", "pier ductility", 1.0),
            ("deck_acceleration_max_m_s2", "deck acceleration [m/s2]", 1.0),
        ]
        table = self._table
        shown = [item for item in shown if np.isfinite(table[item[0]]).any()]
        columns = len(self._bearings)
        wide = max(1.9, 0.42 * len(self._motions) + 0.9)
        size = (max(wide * columns, 4.0) + 0.8, 1.55 * len(shown) + 1.2)
        title = f"{self._data.attrs['structure']}: peaks"
        title += " (pseudo-dynamic: hatched)" if len(self._modes) > 1 else ""
        figure, axes = drawing.panels(len(shown), columns, size, title)
        for panel, ax in enumerate(axes):
            name, label, factor = shown[panel // columns]
            bearing = self._bearings[panel % columns]
            self._bars(ax, table[table["bearing"] == bearing], name, factor)
            ax.set_ylim(0.0, 1.08 * factor * float(np.nanmax(table[name])))
            if name == "bearing_strain_max":
                mine = list(table.index[table["bearing"] == bearing])
                end = factor * self._result.tested_to(mine, "strain")
                drawing.mark_tested(ax, end, "tested to here")
            first, last = panel // columns == 0, panel // columns == len(shown) - 1
            drawing.name_axes(
                ax, "", label if panel % columns == 0 else "", bearing if first else ""
            )
            ax.yaxis.label.set_fontsize(drawing.SMALL)
            ax.title.set_fontsize(drawing.SMALL)
            names = self._motions if last else [""] * len(self._motions)
            ax.set_xticks(range(len(names)), names, rotation=60, ha="right", rotation_mode="anchor")
            ax.grid(False, axis="x")
        self._legend(figure, modes=False)
        return figure

    def _bars(self, ax: Axes, rows: Any, name: str, factor: float) -> None:
        """Groups of bars: one group per motion, one bar per temperature (and mode; pd hatched)."""
        groups = [(ambient, mode) for ambient in self._ambients for mode in self._modes]
        width = 0.8 / len(groups)
        for place, (ambient, mode) in enumerate(groups):
            chosen = (rows["ambient_degC"] == ambient) & (self._run_modes[rows.index] == mode)
            mine = rows[chosen].set_index("motion")[name]
            heights = [factor * float(mine.get(motion, np.nan)) for motion in self._motions]
            at = np.arange(len(heights)) + (place - 0.5 * (len(groups) - 1)) * width
            hatch = "////" if mode == "pd" and len(self._modes) > 1 else ""
            look: drawing.Look = {"color": self._colours[ambient], "edgecolor": "white"}
            ax.bar(at, heights, width=width, hatch=hatch, linewidth=0.0, zorder=2, **look)

    def save_all(self, folder: Path) -> list[Path]:
        """Every figure that the study holds, as PNG."""
        figures = {
            "loops": self.loops,
            "strain": self.strain,
            "energy": self.energy,
            "pier": self.pier,
            "pier_acceleration": self.pier_acceleration,
            "deck": self.deck,
            "peaks": self.peaks,
        }
        if has_parts(self._data):
            figures["parts"] = self.parts
        if has_loops(self._result):
            figures["largest_loops"] = self.largest_loops
        if has_both(self._result):
            figures["modes"] = self.modes
        if np.isfinite(self._data["pier_rotation"].values).any():
            figures["hinge"] = self.hinge
        if np.isfinite(self._data["rubber_temperature"].values).any():
            figures["temperature"] = self.temperature
        if np.isfinite(self._data.get("depth", np.nan)).any():
            figures["profiles"] = self.profiles
        if np.isfinite(self._data["lead_temperature"].values).any():
            figures["shares"] = self.shares
        if self._data.attrs["command"] == "hybrid":
            figures["speed"] = self.speed
        written = []
        for name, make in figures.items():
            path = folder / f"{name}.png"
            drawing.save_figure(make(), path)
            written.append(path)
        return written
