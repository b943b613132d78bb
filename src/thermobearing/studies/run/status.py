"""How far a study is, and what became of its runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from thermobearing.studies.run.demand_parameters import COMPLETED
from thermobearing.studies.statistics.failed_runs import OUTCOME
from thermobearing.studies.store.directory import Store


@dataclass(frozen=True)
class Status:
    """How far a study is.

    Attributes
    ----------
    directory : of the study.
    name : of the study.
    runs, done : runs in all, and those whose results are kept.
    shards, shards_done : likewise.
    failures : why runs failed: a row for each outcome but "completed", with `outcome`, `runs`,
        `share` (of those done), `first` (number of the first such run) and its `sentence`.
    interrupted : whether it was stopped by Ctrl-C now.
    """

    directory: Path
    name: str
    runs: int
    done: int
    shards: int
    shards_done: int
    failures: pd.DataFrame
    interrupted: bool = False

    @property
    def failed(self) -> int:
        """Number of runs that failed."""
        return int(self.failures["runs"].sum())

    @property
    def outcome(self) -> str:
        """In a word: "completed", "some_failed", "incomplete" or "interrupted"."""
        if self.interrupted:
            return "interrupted"
        if self.done < self.runs:
            return "incomplete"
        return "some_failed" if self.failed else "completed"

    @property
    def sentence(self) -> str:
        """The same in a sentence."""
        told = f"{self.done} of {self.runs} runs of {self.name} are done"
        if self.failed:
            told += f", {self.failed} of them failed"
        if self.done < self.runs:
            told += "; start again to do the rest"
        return f"{told}."

    def summary(self) -> dict[str, Any]:
        """The same for machines."""
        return {
            "name": self.name,
            "outcome": self.outcome,
            "runs": self.runs,
            "done": self.done,
            "failed": self.failed,
            "shards": self.shards,
            "shards_done": self.shards_done,
            "failures": self.failures.to_dict("records"),
        }


def study_status(directory: str | Path, *, interrupted: bool = False) -> Status:
    """How far the study in a directory is; looks only, whoever is writing there.

    Parameters
    ----------
    directory : of `run_study`.
    interrupted : told in the status.

    Raises
    ------
    InputError : no study is there.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.studies.definition.case import make_study
    >>> from thermobearing.studies.run.engine import run_study
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "1 s"}, "factors": factors}
    >>> directory = Path(tempfile.mkdtemp()) / "p1"
    >>> _ = run_study(make_study(table, "example"), directory, jobs=1)
    >>> study_status(directory).outcome
    'completed'
    """
    store = Store(Path(directory))
    shards = store.done()
    table = store.table(["run", OUTCOME, "sentence"], shards)
    return Status(
        directory=store.directory,
        name=str(store.manifest["name"]),
        runs=store.runs,
        done=len(table),
        shards=store.shards,
        shards_done=len(shards),
        failures=count_failures(table),
        interrupted=interrupted,
    )


def count_failures(table: pd.DataFrame) -> pd.DataFrame:
    """Why runs failed, the most frequent outcome first; no rows if none did.

    Parameters
    ----------
    table : of runs, with `run`, `outcome` and `sentence`.

    Examples
    --------
    >>> runs = {"run": [0, 1, 2], "outcome": ["completed", "diverged", "diverged"]}
    >>> found = count_failures(pd.DataFrame(runs | {"sentence": ["", "Try.", "Try."]}))
    >>> found.to_dict("records")
    [{'outcome': 'diverged', 'runs': 2, 'share': 0.66..., 'first': 1, 'sentence': 'Try.'}]
    """
    failed = table[table[OUTCOME] != COMPLETED]
    groups = failed.groupby(OUTCOME, sort=True, observed=True)
    found = groups.agg(runs=("run", "size"), first=("run", "min"), sentence=("sentence", "first"))
    found.insert(1, "share", found["runs"] / max(len(table), 1))
    return found.sort_values("runs", ascending=False, kind="stable").reset_index()
