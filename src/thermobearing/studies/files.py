"""The directory of a study as a result."""

from pathlib import Path

from thermobearing.border.errors import InputError, is_file
from thermobearing.studies.asked import kept_asked
from thermobearing.studies.case import load_study
from thermobearing.studies.result import StudyResult
from thermobearing.studies.store import MANIFEST, STUDY, Store

PLACE = "run"


def is_study(path: str | Path) -> bool:
    """Whether a directory is that of a study."""
    return is_file(Path(path) / MANIFEST) and is_file(Path(path) / STUDY)


def study_result(directory: str | Path) -> StudyResult:
    """What came out of a study so far, whether it is at its end or not.

    Parameters
    ----------
    directory : of `run_study`.

    Returns
    -------
    StudyResult

    Raises
    ------
    InputError : no study is there, or no run is done.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.studies import make_study, run_study
    >>> factors = {"bearing": "shen-bilinear-bridge", "motion": "jra-ii-i-1", "ambient": "0 degC"}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "2 s"}, "factors": factors}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = run_study(make_study(table, "example"), f"{folder}/p1", jobs=1)
    ...     study_result(f"{folder}/p1")
    <StudyResult of p1: 1 runs, 0 failed>
    """
    store = Store(Path(directory))
    table = store.table()
    if len(table) == 0:
        raise InputError("no run is done yet", str(directory))
    ordered = table.sort_values(PLACE, kind="stable").reset_index(drop=True)
    study, question = load_study(store.directory / STUDY), kept_asked(store.directory).question()
    return StudyResult(ordered, study, store.manifest, directory, question)
