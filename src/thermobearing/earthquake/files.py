"""Files of an earthquake study."""

from pathlib import Path

from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.directory import (
    DATASET,
    FIGURES,
    HISTORY,
    RESOLVED,
    RIG,
    TABLE,
    write_directory,
)
from thermobearing.results.reading import read_dataset
from thermobearing.results.writing import DIGITS, write_csv, write_dataset, write_summary


def save_earthquake(
    result: EarthquakeResult, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, table.csv, history.csv, result.nc, case.resolved.toml and figures.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        write_summary(folder, result.summary())
        (folder / RESOLVED).write_text(result.dataset.attrs["case"], encoding="utf-8")
        write_csv(folder / TABLE, result.table)
        if len(result.rig):
            write_csv(folder / RIG, result.rig)
        _write_histories(result, folder / HISTORY)
        write_dataset(result.dataset, folder / DATASET)
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


def load_study(path: str | Path) -> EarthquakeResult:
    """A saved result of an earthquake study again; see `load_result`, which reads any.

    Raises
    ------
    InputError : there is no readable result of a study at that path.
    """
    return EarthquakeResult(read_dataset(path, ("structure", "case")))
