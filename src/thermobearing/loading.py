"""Any saved result again, whatever analysis it is of."""

from dataclasses import replace
from pathlib import Path

from thermobearing.bearing.bilinear import BilinearBearing, load_bilinear
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.opener import is_file, is_folder
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.result import Result
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.opensees.result import ServedResult
from thermobearing.results.directory import BEARINGS, DATASET, IDENTIFIED, PARTS
from thermobearing.results.saved import SavedResult, is_saved, read_dataset, read_saved
from thermobearing.sequences.result import SequenceResult, load_sequence
from thermobearing.studies.result import StudyResult, study_result
from thermobearing.studies.store import is_study

POOR_FIT = "poor_fit"
WITH_DATASET = {"cyclic", "bridge", "hybrid", "sequence", "serve"}  # commands
AnyResult = Result | EarthquakeResult | SequenceResult | ServedResult | StudyResult | SavedResult


@checked
def load_result(path: str | Path) -> AnyResult:
    """Load a saved result of any command.

    Parameters
    ----------
    path : its directory, or the result.nc in it.

    Returns
    -------
    Result, or EarthquakeResult of `bridge` and `hybrid`, or SequenceResult of `sequence`, or
    ServedResult of `serve`, or StudyResult of `study`;
    of all others (identify, validate, design, lambda, bounds, motions) a SavedResult: summary,
    tables, figures and bearings.

    Raises
    ------
    InputError : there is no readable result at that path.

    Examples
    --------
    >>> import tempfile
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[0.5], cycles=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     saved = tb.run("shen-hdr-specimen", test).save(f"{folder}/out", figures=False)
    ...     load_result(saved).outcome
    'completed'
    """
    if not isinstance(path, str | Path):
        raise InputError(f"load_result(): {type(path).__name__} is no path of a result")
    if is_study(path):
        return study_result(path)
    if is_folder(Path(path) / PARTS):
        return load_sequence(path)
    if is_saved(path) and not is_file(Path(path) / DATASET):
        return _with_bearings(read_saved(path))
    data = read_dataset(path, ["case"])
    if "structure" in data.attrs:
        return EarthquakeResult(data)
    if data.attrs.get("command") == "serve":
        return ServedResult(data)
    return Result(read_dataset(path, ("bearing", "case", "segments")))


def _with_bearings(result: SavedResult) -> SavedResult:
    """Return the bearing that was identified, or those that were designed, read too."""
    if result.command in WITH_DATASET:
        raise InputError(f"no result.nc there, which {result.command} writes", str(result.path))
    files = [result.path / IDENTIFIED, *sorted((result.path / BEARINGS).glob("*.toml"))]
    if result.outcome == POOR_FIT:  # its file is marked, and does not load
        files = files[1:]
    loaded = [_read_bearing(file) for file in files if is_file(file)]
    return replace(result, bearings={bearing.name: bearing for bearing in loaded})


def _read_bearing(file: Path) -> Bearing | BilinearBearing:
    kind = read_toml(file).get("kind")
    return load_bilinear(file) if kind == "bilinear" else load_bearing(file)
