"""Directory and console tables of a study."""

from pathlib import Path

import pandas as pd

from thermobearing.border.errors import InputError, is_file
from thermobearing.report.pieces import ReportTable
from thermobearing.results.screen import print_facts, print_table, print_warnings, say
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.options import Question, kept_asked
from thermobearing.studies.report import answer, report_tables_by_name
from thermobearing.studies.result import StudyResult
from thermobearing.studies.run.status import Status
from thermobearing.studies.store.directory import MANIFEST, STUDY, Store

LATER = ("worst",)  # tables with a command of their own


def print_answers(result: StudyResult, asked: Question) -> None:
    """Tables of the document, and its answer.

    Parameters
    ----------
    result : of `study_result`.
    asked : demand, capacity, hazard.
    """
    for name, table in report_tables_by_name(result, asked).items():
        if name not in LATER:
            _print(table)
    for sentence in answer(result, asked):
        say(sentence)
    print_warnings(result.warnings)


def _print(table: ReportTable) -> None:
    """A table of the document."""
    heads = [column.title for column in table.columns]
    rows = [
        [column.text(value) for column, value in zip(table.columns, row, strict=True)]
        for row in table.rows
    ]
    print_table(heads, rows, title=table.caption, keys=table.keys)
    if table.note:
        say(table.note)


def print_worst(table: pd.DataFrame) -> None:
    """Runs with their demand, and below them the commands that repeat them.

    Parameters
    ----------
    table : of `StudyResult.worst`.
    """
    shown = table.drop(columns=["id", "command"])
    rows = [
        [
            "" if value != value else f"{value:.4g}" if isinstance(value, float) else str(value)
            for value in row
        ]
        for row in shown.itertuples(index=False, name=None)
    ]
    print_table(
        [str(name) for name in shown], rows, title="worst runs, and one of each way to fail"
    )
    for command in table["command"]:
        say(command)


def print_status(status: Status, *, part: bool = False) -> None:
    """How many runs are done, and a table of why some failed.

    Parameters
    ----------
    status : from `study_status`.
    part : only a part of the study was asked for.
    """
    facts = {
        "runs": f"{status.done} of {status.runs}",
        "shards": f"{status.shards_done} of {status.shards}",
        "failed": str(status.failed),
    }
    print_facts(f"{status.directory}: {status.name}, {status.outcome}", facts)
    if status.failed:
        rows = [
            (one["outcome"], str(one["runs"]), f"{one['share']:.3g}", str(one["first"]))
            for one in status.failures.to_dict("records")
        ]
        print_table(("outcome", "runs", "share", "first run"), rows, title="why runs failed")
        for one in status.failures.to_dict("records"):
            say(f"{one['outcome']}: {one['sentence']}")
    if status.done < status.runs and not part:
        say("the same command again does the rest")


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
    >>> from thermobearing.studies.definition.case import make_study
    >>> from thermobearing.studies.run.engine import run_study
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
