"""A study in its directory as a result again, and its table as one file for anybody."""

from pathlib import Path

import pandas as pd

from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.text_file import write_text_file
from thermobearing.studies.case import load_study
from thermobearing.studies.result import StudyResult
from thermobearing.studies.store import STUDY, Store

MOST_ROWS = 1_048_575  # of a sheet of a workbook, beside its head


def study_result(directory: str | Path) -> StudyResult:
    """What a study has come to so far.

    Parameters
    ----------
    directory : of `run_study`, finished or not.

    Returns
    -------
    StudyResult

    Raises
    ------
    InputError : no study is there.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.studies import make_study, run_study
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "1 s"}, "factors": factors}
    >>> directory = Path(tempfile.mkdtemp()) / "p1"
    >>> _ = run_study(make_study(table, "example"), directory, jobs=1)
    >>> study_result(directory).runs
    1
    """
    store = Store(Path(directory))
    study = load_study(store.directory / STUDY)
    return StudyResult(store.table(), study, store.manifest, store.directory)


def write_table(table: pd.DataFrame, path: Path, *, force: bool = False) -> None:
    """A table of runs as text (.csv) or as a workbook (.xlsx).

    Parameters
    ----------
    table : of runs.
    path : of the file.
    force : replace one that is there.

    Raises
    ------
    InputError : another ending, more runs than a sheet has rows, openpyxl is not installed.
    OutputError : the file is there, or cannot be written.
    """
    if path.suffix == ".csv":
        write_text_file(path, table.to_csv(index=False), force=force)
        return
    if path.suffix != ".xlsx":
        raise InputError(f'"{path}": a table of runs is written as .csv or .xlsx')
    if len(table) > MOST_ROWS:
        raise InputError(f"{len(table)} runs; a sheet has room for {MOST_ROWS}: write .csv")
    from thermobearing.report.workbook import the_writer

    the_writer()
    if path.exists() and not force:
        raise OutputError(f"{path} exists; give another name, or replace it with --force")
    beside = path.with_name(f".{path.name}.part.xlsx")
    try:
        table.to_excel(beside, index=False, sheet_name="runs")
        beside.replace(path)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        beside.unlink(missing_ok=True)
