"""Result directories of checks and fits."""

import re
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from thermobearing.identify import figures
from thermobearing.identify.checks import CheckReport
from thermobearing.identify.posterior import Band, Samples
from thermobearing.identify.report import bearing_text, fit_table, fits, summary, write_json
from thermobearing.identify.run import Identification
from thermobearing.results.directory import (
    FIGURES,
    FIT_TABLE,
    IDENTIFIED,
    SAMPLES,
    SUMMARY,
    write_directory,
)

DPI = 150
ERRORS = {
    "G_eq_error": "equivalent shear modulus G_e",
    "h_eq_error": "equivalent damping ratio h_eq",
    "energy_error": "energy",
    "force_max_error": "peak force",
}


def save_checks(
    reports: list[CheckReport], directory: Path, *, force: bool = False, draw: bool = True
) -> Path:
    """Write summary.json and a figure per record."""

    def fill(folder: Path) -> None:
        write_json(folder / SUMMARY, checks_summary(reports))
        if draw:
            (folder / FIGURES).mkdir()
            for number, report in enumerate(reports, start=1):
                name = re.sub(r"[^\w.+-]+", "-", report.record.name)
                _save(_check_figure(report), folder / FIGURES / f"check_{number}_{name}.png")

    return write_directory(directory, fill, force=force)


def checks_summary(reports: list[CheckReport]) -> dict[str, Any]:
    """Findings of all records, for summary.json."""
    outcomes = [report.outcome for report in reports]
    worst = next((o for o in ("refused", "warning") if o in outcomes), "good")
    return {
        "command": "identify",
        "outcome": worst,
        "records": [
            {
                "name": report.record.name,
                "file": report.record.file,
                "ambient_degC": report.record.ambient,
                "outcome": report.outcome,
                "cycles": len(report.cycles),
                "findings": [vars(finding) for finding in report.findings],
            }
            for report in reports
        ],
    }


def save_identification(
    found: Identification,
    directory: Path,
    *,
    version: str,
    force: bool = False,
    draw: bool = True,
    samples: Samples | None = None,
    bands: list[Band] | None = None,
) -> Path:
    """Write summary.json, bearing.toml, fit.csv, posterior.csv and figures."""

    def fill(folder: Path) -> None:
        content = summary(found)
        if samples is not None:
            content["posterior"] = posterior_summary(found, samples, bands or [])
            (folder / SAMPLES).write_text(_samples_text(found, samples), encoding="utf-8")
        write_json(folder / SUMMARY, content)
        (folder / IDENTIFIED).write_text(bearing_text(found, version), encoding="utf-8")
        (folder / FIT_TABLE).write_text(fit_table(found), encoding="utf-8")
        if draw:
            (folder / FIGURES).mkdir()
            for name, figure in _figures(found, bands or []).items():
                _save(figure, folder / FIGURES / f"{name}.png")

    return write_directory(directory, fill, force=force)


def posterior_summary(found: Identification, samples: Samples, bands: list[Band]) -> dict[str, Any]:
    """Draws and bands in numbers."""
    return {
        "source": samples.source,
        "samples": len(samples.cube),
        "acceptance": samples.acceptance,
        "autocorrelation_steps": samples.autocorrelation,
        "peak_force": [
            {
                "ambient_degC": band.ambient,
                "best_kN": band.peak,
                "lower_kN": band.peak_lower,
                "upper_kN": band.peak_upper,
            }
            for band in bands
        ],
    }


def _samples_text(found: Identification, samples: Samples) -> str:
    free = found.pset.free
    lines = [",".join(p.kind.symbol for p in free)]
    for row in samples.cube:
        lines.append(",".join(f"{p.at(float(u)):.6g}" for p, u in zip(free, row, strict=True)))
    return "\n".join(lines) + "\n"


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, dpi=DPI)


def _check_figure(report: CheckReport) -> Figure:
    record = report.record
    return figures.check_figure(
        f"{record.name}: {report.outcome}",
        record.time,
        record.displacement,
        record.force,
        cycles=[(c.first, c.last) for c in report.cycles if not c.closing],
        starts=[c.first for c in report.cycles],
        clipped=report.clipped,
        sentences=[f"{f.level}: {f.sentence}" for f in report.findings],
    )


def _panels(found: Identification) -> list[figures.Panel]:
    panels = []
    for fit, prediction in zip(fits(found), found.predictions, strict=True):
        record = fit.record
        cycles = np.array([c.cycle for c in fit.cycles], dtype=float)
        errors = {
            title: np.array([getattr(c, name) for c in fit.cycles])
            for name, title in ERRORS.items()
        }
        degrees = f"{record.ambient:g} °C".replace("-", "\N{MINUS SIGN}")
        title = f"{record.name}, {degrees}, R² = {fit.R2:.4f}"
        panels.append(
            figures.Panel(
                title, record.time, record.displacement, record.force, prediction.force,
                cycles, errors,
            )
        )  # fmt: skip
    return panels


def _figures(found: Identification, bands: list[Band]) -> dict[str, Figure]:
    """Every figure of a fit by file name."""
    panels, name = _panels(found), found.bearing.name
    symbols = [e.parameter.kind.symbol for e in found.uncertainty.estimates.values()]
    made = {
        "loops": figures.loops_figure(f"{name}: test and model", panels),
        "residuals": figures.residual_figure(f"{name}: residuals", panels),
        "convergence": figures.convergence_figure(f"{name}: convergence", found.history),
        "correlation": figures.correlation_figure(
            f"{name}: correlation", symbols, found.uncertainty.correlation
        ),
        "cycles": figures.cycle_figure(f"{name}: errors of each cycle", panels),
    }
    for band in bands:
        degrees = f"{band.ambient:g} °C".replace("-", "\N{MINUS SIGN}")
        title = f"{name}: predicted at {degrees}"
        made[f"band_{band.ambient:g}"] = figures.band_figure(
            title, band.displacement, band.best, band.lower, band.upper,
            (band.peak, band.peak_lower, band.peak_upper),
        )  # fmt: skip
    return made
