"""Files of an earthquake study."""

import json
from pathlib import Path

from thermobearing.cyclic.files import without_nan
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.directory import (
    DATASET,
    FIGURES,
    HISTORY,
    RESOLVED,
    SUMMARY,
    TABLE,
    write_directory,
)

DIGITS = "%.7g"


def save_earthquake(
    result: EarthquakeResult, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, table.csv, history.csv, result.nc, case.resolved.toml and figures.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        text = json.dumps(without_nan(result.summary()), indent=2, allow_nan=False)
        (folder / SUMMARY).write_text(text + "\n", encoding="utf-8")
        (folder / RESOLVED).write_text(result.dataset.attrs["case"], encoding="utf-8")
        result.table.to_csv(folder / TABLE, index=False, float_format=DIGITS)
        _write_histories(result, folder / HISTORY)
        result.dataset.to_netcdf(folder / DATASET, engine="h5netcdf")
        if figures:
            (folder / FIGURES).mkdir()
            result.plot.save_all(folder / FIGURES)

    return write_directory(directory, fill, force=force)


def _write_histories(result: EarthquakeResult, path: Path) -> None:
    """Main histories of all runs below each other."""
    for run in range(result.runs):
        frame = result.history(run)
        for name in ("ambient", "motion", "bearing"):
            label = "ambient_degC" if name == "ambient" else name
            frame.insert(0, label, result.dataset[name].values[run])
        frame.to_csv(
            path, mode="a" if run else "w", header=run == 0, index=False, float_format=DIGITS
        )
