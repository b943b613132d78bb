"""Any saved result again, whatever analysis it is of."""

from pathlib import Path

from thermobearing.border.errors import is_folder
from thermobearing.cyclic.files import load_cyclic
from thermobearing.cyclic.result import Result
from thermobearing.earthquake.files import load_study
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.results.directory import PARTS
from thermobearing.results.reading import read_dataset
from thermobearing.sequences.files import load_sequence
from thermobearing.sequences.result import SequenceResult


def load_result(path: str | Path) -> Result | EarthquakeResult | SequenceResult:
    """A saved result again, of a cyclic test, of an earthquake study or of a sequence of them.

    Parameters
    ----------
    path : its directory, or the result.nc in it.

    Returns
    -------
    Result, or EarthquakeResult of `bridge` and `hybrid`, or SequenceResult of `sequence`.

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
    if is_folder(Path(path) / PARTS):
        return load_sequence(path)
    study = "structure" in read_dataset(path, ["case"]).attrs
    return load_study(path) if study else load_cyclic(path)
