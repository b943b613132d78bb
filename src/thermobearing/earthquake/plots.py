"""Interactive figures in the report of an analysis of earthquakes."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.summary_figures import RunPanels
from thermobearing.report.figures import POINTS, history, path, rounded
from thermobearing.report.pieces import Plot, Trace
from thermobearing.report.words import degrees

ALL_POINTS = 40_000  # of the traces of one plot together
MOST_CHOICES = 40  # entries of a menu
MOMENTS = 24  # places of a slider
UNTESTED = "#aa3333"
PLACES = (("rubber", "inner layer", "line"), ("lead", "lead", "dashed"))
Choices = dict[str, list[Trace]]


def interactive_plots(result: EarthquakeResult) -> dict[str, Plot]:
    """Return plots by the name of the figure that they replace in an HTML page."""
    if not result.runs:
        return {}
    panels = _Panels(result)
    force, strain = "force of one bearing [kN]", "shear strain [%]"
    found = {
        "loops": panels._plane("bearing_strain", "bearing_force", 100.0, (strain, force)),
        "strain": panels._history("bearing_strain", 100.0, strain),
        "pier": panels._history("pier_displacement", 1.0, "pier top relative to its base [mm]"),
        "deck": panels._history("deck_acceleration", 1.0, "acceleration of the deck [m/s²]"),
        "hinge": panels._plane(
            "pier_rotation", "pier_moment", 1e3, ("rotation [mrad]", "moment [kN m]")
        ),
        "temperature": panels._temperatures(),
        "profiles": panels._profiles(),
    }
    return {name: plot for name, plot in found.items() if plot is not None}


class _Panels(RunPanels):
    """Runs of each menu entry: a bearing and a motion, at all temperatures."""

    def __init__(self, result: EarthquakeResult) -> None:
        super().__init__(result)
        several = len(self._bearings) > 1
        self.groups: dict[str, list[int]] = {}
        for run, row in enumerate(self._table.to_dict("records")):
            name = f"{row['bearing']}, {row['motion']}" if several else str(row["motion"])
            if name in self.groups or len(self.groups) < MOST_CHOICES:
                self.groups.setdefault(name, []).append(run)
        self.points = int(np.clip(ALL_POINTS // max(result.runs, 1), 120, POINTS))

    def _label(self, run: int) -> str:
        """Return the temperature of a run, and its mode where there are several."""
        air = degrees([float(self._table["ambient_degC"][run])])
        return f"{air}, {self._result.modes[run]}" if len(self._run_modes) > 1 else air

    def _choices(self, make: Callable[[int], list[Trace]]) -> Choices:
        """Return the traces of every run that has any, by menu entry."""
        found = {
            name: [trace for run in runs for trace in make(run)]
            for name, runs in self.groups.items()
        }
        return {name: traces for name, traces in found.items() if traces}

    def _trace(self, run: int, xy: tuple[Floats, Floats]) -> Trace:
        """Return a line of a run; that of a pseudo-dynamic test is dashed."""
        look = "dashed" if self._line(run) == "--" else "line"
        return Trace(self._label(run), *xy, self._colour(run), look)

    def _plane(self, x: str, y: str, factor: float, titles: tuple[str, str]) -> Plot | None:
        """Return paths in the plane of two histories."""

        def _make(run: int) -> list[Trace]:
            a, b = factor * self._values(x, run), self._values(y, run)
            known = len(a) and np.isfinite(a).all() and np.isfinite(b).all()
            return [self._trace(run, path(a, b, self.points))] if known else []

        choices = self._choices(_make)
        if x == "bearing_strain":
            self._add_tested(choices, along="x")
        return Plot(*titles, choices) if choices else None

    def _history(self, name: str, factor: float, title: str) -> Plot | None:
        """Return a history of every run."""

        def _make(run: int) -> list[Trace]:
            time, values = self._values("time", run), factor * self._values(name, run)
            known = len(values) and np.isfinite(values).all()
            return [self._trace(run, history(time, values, self.points))] if known else []

        choices = self._choices(_make)
        if name == "bearing_strain":
            self._add_tested(choices, along="y")
        return Plot("time [s]", title, choices) if choices else None

    def _add_tested(self, choices: Choices, along: Literal["x", "y"]) -> None:
        """Add dashed lines at the largest tested strain in the panels that go beyond it.

        Bearings are tested to different strains: one band for all entries would be wrong.
        """
        for name, traces in choices.items():
            end = 100.0 * self._result.tested_to(self.groups[name], "strain")
            if not np.isfinite(end):
                continue
            across = [trace.y if along == "x" else trace.x for trace in traces]
            low, high = (float(f([f(v) for v in across])) for f in (np.nanmin, np.nanmax))
            at = np.array([end, end, np.nan, -end, -end])
            other = np.array([low, high, np.nan, low, high])
            points = (at, other) if along == "x" else (other, at)
            traces.append(Trace(f"tested to {end:g} %", *points, UNTESTED, "dashed"))

    def _temperatures(self) -> Plot | None:
        """Return the innermost rubber layer (full) and the lead (dashed) of every run."""

        def _make(run: int) -> list[Trace]:
            places, time = self._result.places(run), self._values("time", run)
            return [
                Trace(
                    f"{what}, {self._label(run)}",
                    *history(time, places[place], self.points // 2),
                    self._colour(run),
                    look,
                )
                for what, place, look in PLACES
                if len(places[place]) and np.isfinite(places[place]).all()
            ]

        choices = self._choices(_make)
        return Plot("time [s]", "temperature [°C]", choices) if choices else None

    def _profiles(self) -> Plot | None:
        """Return temperatures through the height, moved through the motion by a slider."""
        if "temperature" not in self._data:
            return None
        moments = np.linspace(0.0, float(np.nanmax(self._data["time"].values)), MOMENTS)

        def _make(run: int) -> list[Trace]:
            depth = self._data["depth"].values[run]
            own = np.isfinite(depth)
            if not own.any():
                return []
            time = self._values("time", run)
            at = np.searchsorted(time, moments).clip(0, len(time) - 1)
            frames = rounded(self._data["temperature"].values[run][at][:, own])
            level = -rounded(depth[own])
            y = np.tile(level, (len(moments), 1))
            look = (self._colour(run), "line with points")
            return [Trace(self._label(run), frames[0], level, *look, y, frames)]

        choices = self._choices(_make)
        if not choices:
            return None
        return Plot(
            "temperature [°C]",
            "level relative to the upper face [mm]",
            choices,
            slider=[f"{moment:.1f} s" for moment in moments],
            slider_title="time",
        )
