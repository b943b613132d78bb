"""Result directories of a validation, and of a fit with tests held out."""

from pathlib import Path

import numpy as np
import pandas as pd

from thermobearing.identify.files import fill_identification
from thermobearing.identify.posterior import Forecast
from thermobearing.results.directory import (
    FIGURES,
    FIT_TABLE,
    FOLDS,
    TABLE,
    THERMOCOUPLES,
    write_directory,
)
from thermobearing.results.directory import VALIDATED_CYCLES as CYCLES
from thermobearing.results.writing import without_formulas, write_csv, write_limits, write_summary
from thermobearing.validate.held_out_result import CrossValidation
from thermobearing.validate.result import Validation


def save_validation(
    found: Validation, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, table.csv, cycles.csv, fit.csv, thermocouples.csv and figures.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
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

    return write_directory(directory, fill, force=force)


def save_cross_validation(
    found: CrossValidation,
    directory: Path,
    *,
    force: bool = False,
    figures: bool = True,
    forecast: Forecast | None = None,
) -> Path:
    """Write what `save_identification` writes of the final fit, table.csv, cycles.csv, folds.csv.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
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
        fill_identification(folder, found.final, found.summary(), forecast, figures=figures)
        write_csv(folder / TABLE, found.table)
        write_csv(folder / CYCLES, found.judged.cycles)
        if found.folds:
            write_csv(folder / FOLDS, found.parameters)
        if figures:
            found.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, force=force)


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
