"""Result directories of a design, of a bounds study and of temperature factors."""

from pathlib import Path

import pandas as pd

from thermobearing.border.text_file import file_names
from thermobearing.border.toml import to_toml
from thermobearing.design.bilinear import bounds_table, opensees_text
from thermobearing.design.result import BoundsReport, Design, FactorReport
from thermobearing.results.directory import (
    BEARINGS,
    BOUNDS,
    BOUNDS_PYTHON,
    BOUNDS_TCL,
    CHECKS,
    FACTORS,
    FIGURES,
    RESOLVED,
    ROUNDS,
    SCALE,
    TABLE,
    TEMPERATURES,
    write_directory,
)
from thermobearing.results.writing import write_csv, write_limits, write_summary


def save_design(
    design: Design, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write rounds, checks, bearings (TOML, ready for `bridge`), summary and figures.

    Parameters
    ----------
    design : from `run_design`.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
    figures : draw the figures too.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.design.case import make_design_case
    >>> from thermobearing.design.run import run_design
    >>> case = make_design_case({"tolerance": 0.1}, "example", motions=["jra-ii-i-1"])
    >>> design = run_design(case)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = save_design(design, Path(folder) / "out", figures=False)
    ...     print(*sorted(path.name for path in written.iterdir()))
    bearings case.resolved.toml checks.csv rounds.csv summary.json tested_range.csv
    """

    def fill(folder: Path) -> None:
        write_summary(folder, design.summary())
        (folder / RESOLVED).write_text(design.case.to_toml(), encoding="utf-8")
        write_csv(folder / ROUNDS, design.table)
        write_csv(folder / CHECKS, pd.DataFrame(design.sheet))
        write_limits(folder, pd.DataFrame(), design.tested_range)
        if len(design.temperatures):
            write_csv(folder / TEMPERATURES, design.temperatures)
        (folder / BEARINGS).mkdir()
        bearings = _bearings(design)
        for name, text in zip(file_names(bearings), bearings.values(), strict=True):
            (folder / BEARINGS / f"{name}.toml").write_text(text, encoding="utf-8")
        if figures:
            design.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, force=force)


def _bearings(design: Design) -> dict[str, str]:
    """TOML of the bilinear bearings and of the layered ones, by name."""
    layered = {item.bearing.name: to_toml(item.bearing) for item in design.equal}
    return {bearing.name: to_toml(bearing) for bearing in design.bearings} | layered


def save_bounds(
    report: BoundsReport, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write table.csv, summary.json with a paragraph for each bearing, and a figure for each.

    Parameters
    ----------
    report : from `run_bounds`.
    directory, force, figures : as in `save_design`.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.design.run import run_bounds
    >>> report = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = save_bounds(report, Path(folder) / "out", figures=False)
    ...     print(*sorted(path.name for path in written.iterdir()))
    summary.json table.csv tested_range.csv
    """

    def fill(folder: Path) -> None:
        write_csv(folder / TABLE, report.table)
        write_limits(folder, pd.DataFrame(), report.tested_range)
        write_summary(folder, report.summary())
        if figures:
            report.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, force=force)


def save_factors(
    report: FactorReport, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write factors.csv, bounds.csv, bounds.tcl, bounds.py, summary.json, figures, scale.csv.

    Parameters
    ----------
    report : from `run_factors`.
    directory, force, figures : as in `save_design`.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.design.run import run_factors
    >>> report = run_factors(["shen-hdr-bridge"], temperatures=[-20.0], strains=[1.0])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = save_factors(report, Path(folder) / "out", figures=False)
    ...     print(*sorted(path.name for path in written.iterdir()))
    bounds.csv bounds.py bounds.tcl factors.csv summary.json tested_range.csv
    """

    def fill(folder: Path) -> None:
        write_csv(folder / FACTORS, report.table)
        write_limits(folder, pd.DataFrame(), report.tested_range)
        write_csv(folder / BOUNDS, bounds_table(report.bounds))
        for file, language in ((BOUNDS_TCL, "tcl"), (BOUNDS_PYTHON, "python")):
            text = opensees_text(report.bounds, report.name, language)
            (folder / file).write_text(text, encoding="utf-8")
        write_summary(folder, report.summary())
        if report.sizes is not None:
            write_csv(folder / SCALE, report.sizes[0])
        if figures:
            report.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, force=force)
