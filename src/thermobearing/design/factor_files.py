"""Files of temperature factors."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import thermobearing
from thermobearing.bearing.model import Bearing
from thermobearing.cyclic.result import Result
from thermobearing.design.bound_models import (
    BoundModel,
    bound_models,
    bounds_table,
    opensees_text,
)
from thermobearing.design.factor_figures import draw_factors, draw_scale
from thermobearing.design.factors import published_tables
from thermobearing.design.files import DPI, write_json
from thermobearing.design.scale import scale_study
from thermobearing.results.directory import (
    BOUNDS,
    BOUNDS_PYTHON,
    BOUNDS_TCL,
    FACTORS,
    FIGURES,
    SCALE,
    SUMMARY,
    write_directory,
)


@dataclass
class FactorReport:
    """What `lambda` found.

    Attributes
    ----------
    bearings : the first gives the values, all of them the bands.
    table : of `temperature_factors`.
    reference : temperature [degC].
    motion, cycles : how it was tested, for people.
    scale : whether to add the study of sizes.
    """

    bearings: list[Bearing]
    table: pd.DataFrame
    reference: float
    motion: str
    cycles: str
    scale: bool = False

    @property
    def strain(self) -> float:
        """The largest strain, that of the bounds and the figure."""
        return float(self.table["strain"].max())

    @cached_property
    def bounds(self) -> list[BoundModel]:
        """Lower and upper bilinear model."""
        return bound_models(self.table, self.strain, self.bearings[0].total_rubber_thickness)


def save_factors(
    report: FactorReport, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write factors.csv, bounds.csv, bounds.tcl, bounds.py, summary.json, figures, scale.csv."""
    name = report.bearings[0].name

    def fill(folder: Path) -> None:
        report.table.to_csv(folder / FACTORS, index=False, float_format="%.7g")
        bounds_table(report.bounds).to_csv(folder / BOUNDS, index=False, float_format="%.7g")
        (folder / BOUNDS_TCL).write_text(opensees_text(report.bounds, name, "tcl"))
        (folder / BOUNDS_PYTHON).write_text(opensees_text(report.bounds, name, "python"))
        write_json(folder / SUMMARY, _summary(report))
        if figures:
            (folder / FIGURES).mkdir()
            title = f"{name}: temperature factors, {report.motion}, strain {report.strain:.0%}"
            draw_factors(
                report.table, report.strain, report.reference, title, published_tables()
            ).savefig(folder / FIGURES / "factors.png", dpi=DPI)
        if report.scale:
            _save_scale(report.bearings[0], folder, figures)

    return write_directory(directory, fill, force=force)


def _summary(report: FactorReport) -> dict[str, Any]:
    return {
        "command": "lambda",
        "bearing": report.bearings[0].name,
        "samples": len(report.bearings),
        "version": thermobearing.__version__,
        "outcome": "completed",
        "reference_degC": report.reference,
        "motion": report.motion,
        "cycles": report.cycles,
        "bounds": bounds_table(report.bounds).to_dict("records"),
        "factors": report.table.to_dict("records"),
        "published": [item.model_dump() for item in published_tables()],
    }


def _save_scale(bearing: Bearing, folder: Path, figures: bool) -> None:
    """The same bearing at 1/6 and 1."""
    table, results = scale_study(bearing)
    table.to_csv(folder / SCALE, index=False, float_format="%.7g")
    if figures:
        scale_figure(bearing, results).savefig(folder / FIGURES / "scale.png", dpi=DPI)


def scale_figure(bearing: Bearing, results: dict[float, Result]) -> Figure:
    """Rises and loops of a `scale_study`."""
    histories, loops = {}, {}
    for factor, result in results.items():
        ambient = float(result["ambient"].values[0])
        layers = result["rubber_temperature"].values[0] - ambient
        rises = {"inner layer": layers[:, -1], "outer layer": layers[:, 0]}
        if result.has_lead:
            rises["lead"] = result["lead_temperature"].values[0] - ambient
        histories[factor] = (result.time(0), {k: np.asarray(v) for k, v in rises.items()})
        loops[factor] = (result["strain"].values[0], result["stress"].values[0])
    title = f"{bearing.name}: five cycles of 175 % in 10 s, then rest, at two sizes"
    return draw_scale(histories, loops, title)
