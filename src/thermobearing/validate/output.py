"""Directory and console tables of a validation."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.border.errors import printable
from thermobearing.identify.output import write_identification
from thermobearing.identify.tables import thermocouples_table
from thermobearing.identify.uncertainty.posterior import Forecast
from thermobearing.results.directory import (
    FIGURES,
    FIT_TABLE,
    FOLDS,
    TABLE,
    THERMOCOUPLES,
    write_directory,
)
from thermobearing.results.directory import VALIDATED_CYCLES as CYCLES
from thermobearing.results.screen import print_table, print_warnings, say, show_table
from thermobearing.results.writing import without_formulas, write_csv, write_limits, write_summary
from thermobearing.validate.case import QUANTITIES
from thermobearing.validate.hold_out import CrossValidation
from thermobearing.validate.result import BEYOND, Validation


def save_validation(
    found: Validation, directory: Path, *, overwrite: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, table.csv, cycles.csv, fit.csv, thermocouples.csv and figures.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
    figures : draw the figures too.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        write_summary(folder, found.summary())
        without_formulas(found.table).to_csv(folder / TABLE, index=False)
        without_formulas(found.cycles).to_csv(folder / CYCLES, index=False)
        write_csv(folder / FIT_TABLE, samples(found))
        if len(found.thermocouples):
            without_formulas(found.thermocouples).to_csv(folder / THERMOCOUPLES, index=False)
        write_limits(folder, pd.DataFrame(), found.tested_range)
        if figures:
            found.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, overwrite=overwrite)


def save_cross_validation(
    found: CrossValidation,
    directory: Path,
    *,
    overwrite: bool = False,
    figures: bool = True,
    forecast: Forecast | None = None,
) -> Path:
    """Write what `save_identification` writes of the final fit, table.csv, cycles.csv, folds.csv.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.
    figures : draw the figures too.
    forecast : samples of the posterior of the final fit, and bands.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        final = replace(found.final, forecast=forecast)
        write_identification(final, folder)
        drawn = {"posterior": forecast.summary()} if forecast else {}
        write_summary(folder, found.summary() | drawn)
        if figures:
            final.plot.save_all(folder / FIGURES)
        write_csv(folder / TABLE, found.table)
        write_csv(folder / CYCLES, found.judged.cycles)
        if found.folds:
            write_csv(folder / FOLDS, found.parameters)
        if figures:
            found.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, overwrite=overwrite)


def samples(found: Validation) -> pd.DataFrame:
    """Tests and models sample by sample: force [kN], temperatures [degC].

    Parameters
    ----------
    found : a validation.

    Returns
    -------
    DataFrame : one row for each sample of each comparison.
    """
    frames = []
    for item in found.comparisons:
        record, model = item.record, item.prediction
        nothing = np.full(len(record.time), np.nan)
        columns = {
            "test": record.name,
            "bearing": item.bearing,
            "model": item.model,
            "time_s": record.time,
            "displacement_mm": record.displacement,
            "force_kN": record.force,
            "model_force_kN": nothing if model is None else model.force,
        }
        for title, values in record.temperatures.items():
            columns[title] = values
            columns[f"model_{title}"] = nothing if model is None else model.temperatures[title]
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True)


WHOSE = ("test", "ambient_degC", "bearing", "model")  # of a row, by comparison
HEADS = ("test", "degC", "R²", "K_eq", "h_eq", "energy", "force", "rise", "NRMSE")


def print_validation(found: Validation, which: str = "tests") -> None:
    """Largest errors of each comparison, those beyond their limit marked, and the verdict.

    Parameters
    ----------
    found : from `validate`.
    which : what its tests are called.
    """
    for (bearing, model), rows in found.table.groupby(["bearing", "model"], sort=False):
        cells = [
            (
                str(row["test"]),
                f"{round(row['ambient_degC'], 2):g}",
                f"{row['R2']:.3f}",
                *(_cell(row, name) for name in QUANTITIES),
            )
            for row in rows.to_dict("records")
        ]
        title = f"{bearing}, {model}: largest errors, model against {which}"
        styles = ["yellow" if any("!" in cell for cell in line) else "" for line in cells]
        print_table(HEADS, cells, title=title, keys=2, styles=styles)
    shown = found.thermocouples
    for (bearing, model), rows in (
        shown.groupby(["bearing", "model"], sort=False) if len(shown) else ()
    ):
        caption = f"{bearing}, {model}: thermocouples, model compared with test"
        names = ["test", *(name for name in rows if name not in WHOSE)]
        show_table(thermocouples_table(rows[names].to_dict("records"), caption))
    for name, unused in dict.fromkeys((c.record.name, c.record.unused) for c in found.comparisons):
        if unused:
            say(printable(f"{name}: columns not used: {', '.join(unused)}"))
    limits = ", ".join(f"{name} {limit:.0%}" for name, limit in found.limits.items())
    say(f"limits: {limits}; verdict: {found.verdict} (! beyond its limit)")
    print_warnings(found.warnings)


def print_cross_validation(found: CrossValidation, forecast: Forecast | None = None) -> None:
    """Print the final fit, parameters by fold, and both kinds of tests."""
    replace(found.final, forecast=forecast).show()
    if found.folds:
        _print_folds(found)
    print_validation(found.fitted, "tests it is fitted to")
    print_validation(found.held_out, "tests held out")


def _print_folds(found: CrossValidation) -> None:
    symbols = list(found.free)
    rows = []
    for row in found.parameters.to_dict("records"):
        group = found.groups[row["fold"] - 1] if row["fold"] else []
        names = ", ".join(record.name for record in group) or "none"
        shown = [f"{row[symbol]:.4g}" for symbol in symbols]
        rows.append((str(row["fold"] or "all"), names, *shown))
    rows.append(("", "jackknife standard error", *(f"{found.spread[s]:.2g}" for s in symbols)))
    print_table(("fold", "held out", *symbols), rows, title="without each fold", keys=2)


def _cell(row: dict[Any, Any], name: str) -> str:
    error = row[f"{name}_error"]
    if error != error:
        return "-"
    shown = f"{error:.0%}" if name == "NRMSE" else f"{error:+.0%}"
    return f"{shown}!" if row[f"{name}_verdict"] == BEYOND else shown
