"""How far a study is, and its worst runs, on a terminal."""

from typing import Any

import pandas as pd

from thermobearing.results.screen import print_facts, print_table, say
from thermobearing.studies.result import StudyResult
from thermobearing.studies.status import Status


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
        _print("why runs failed", status.failures)
    if status.done < status.runs and not part:
        say("the same command again does the rest")


def print_worst(result: StudyResult, count: int, by: str | None) -> None:
    """The worst runs and how to repeat each."""
    say(result.headline)
    found = result.worst(count, by)
    _print("worst runs", found.drop(columns="command"))
    for command in found["command"]:
        say(f"  {command}")


def _print(title: str, frame: pd.DataFrame) -> None:
    """A table of a study."""
    rows = [[_cell(value) for value in row] for row in frame.itertuples(index=False)]
    print_table([str(name) for name in frame.columns], rows, title=title)


def _cell(value: Any) -> str:
    """A number with the digits that count; other things as they are."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
