"""Files of an earthquake study."""

from functools import partial
from pathlib import Path

from thermobearing.earthquake.modes import has_both, modes_table
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.directory import (
    COMPARISON,
    DATASET,
    FIGURES,
    HISTORY,
    LINES,
    MODES,
    PIERS,
    RESOLVED,
    TABLE,
    write_directory,
)
from thermobearing.results.reading import read_dataset
from thermobearing.results.writing import (
    write_csv,
    write_dataset,
    write_limits,
    write_summary,
)


def save_earthquake(
    result: EarthquakeResult,
    directory: Path,
    *,
    force: bool = False,
    figures: bool = True,
    compared: dict[str, EarthquakeResult] | None = None,
) -> Path:
    """Write summary.json, table.csv, history.csv, result.nc, case.resolved.toml and figures.

    With several bearing lines or piers also lines.csv and piers.csv.

    Parameters
    ----------
    result : what to write.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
    figures : draw the figures too.
    compared : results of the same study by model (`compare_models`): adds a table, two figures
        and a verdict in summary.json.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        told = result.summary()
        (folder / RESOLVED).write_text(result.dataset.attrs["case"], encoding="utf-8")
        write_csv(folder / TABLE, result.table)
        if has_both(result):
            write_csv(folder / MODES, modes_table(result))
        write_limits(folder, result.rig, result.tested_range)
        for name, parts in ((LINES, result.lines), (PIERS, result.piers)):
            if len(parts):
                write_csv(folder / name, parts)
        _write_histories(result, folder / HISTORY)
        write_dataset(result.dataset, folder / DATASET)
        if figures:
            (folder / FIGURES).mkdir()
            result.plot.save_all(folder / FIGURES)
        if compared:
            told["verdict"] = _write_comparison(compared, folder, figures=figures)
        write_summary(folder, told)

    return write_directory(directory, fill, force=force)


def _write_comparison(results: dict[str, EarthquakeResult], folder: Path, *, figures: bool) -> str:
    """Table and figures of the earlier models; returns the verdict on a single temperature."""
    from thermobearing.earthquake.comparison import (
        comparison_figure,
        comparison_loops,
        comparison_table,
        verdict,
    )
    from thermobearing.results.drawing import save_figures

    table = comparison_table(results)
    write_csv(folder / COMPARISON, table)
    if figures:
        drawn = {"comparison": comparison_figure, "comparison_loops": comparison_loops}
        save_figures({k: partial(draw, results) for k, draw in drawn.items()}, folder / FIGURES)
    return verdict(table)


def _write_histories(result: EarthquakeResult, path: Path) -> None:
    """Main histories of all runs below each other."""
    for run in range(result.runs):
        frame = result.history(run)
        if any(result.modes):
            frame.insert(0, "mode", result.modes[run])
        for name in ("ambient", "motion", "bearing"):
            label = "ambient_degC" if name == "ambient" else name
            frame.insert(0, label, result.dataset[name].values[run])
        write_csv(path, frame, below=run > 0)


def load_study(path: str | Path) -> EarthquakeResult:
    """A saved result of an earthquake study again; see `load_result`, which reads any.

    Raises
    ------
    InputError : there is no readable result of a study at that path.
    """
    return EarthquakeResult(read_dataset(path, ("structure", "case")))
