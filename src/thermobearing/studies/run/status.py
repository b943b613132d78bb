"""How far a study is, why runs failed, and what a study will cost before it starts."""

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.results.screen import print_facts, say, show_table
from thermobearing.studies.definition.designs import list_columns, plan
from thermobearing.studies.definition.motions import with_first_motion
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import COMPLETED, RESULT_COLUMNS, carried_out
from thermobearing.studies.store import Store


@dataclass(frozen=True)
class Status:
    """How far a study is; `failures` are those of `count_failures`."""

    directory: Path
    name: str
    runs: int
    done: int  # runs whose results are kept
    shards: int
    shards_done: int
    failures: pd.DataFrame
    interrupted: bool = False  # by Ctrl-C, now

    @property
    def failed(self) -> int:
        """Number of runs that failed."""
        return int(self.failures["runs"].sum())

    @property
    def outcome(self) -> str:
        """The word "completed", "some_failed", "incomplete" or "interrupted"."""
        if self.interrupted:
            return "interrupted"
        if self.done < self.runs:
            return "incomplete"
        return "some_failed" if self.failed else "completed"

    @property
    def sentence(self) -> str:
        """The outcome in a sentence."""
        text = f"{self.done} of {self.runs} runs of {self.name} are done"
        if self.failed:
            text += f", {self.failed} of them failed"
        if self.done < self.runs:
            text += "; start again to do the rest"
        return f"{text}."

    def summary(self) -> dict[str, Any]:
        """Return the status for machines."""
        names = ("name", "outcome", "runs", "done", "failed", "shards", "shards_done")
        found = {name: getattr(self, name) for name in names}
        return found | {"failures": self.failures.to_dict("records")}

    def show(self, *, part: bool = False) -> None:
        """Print how many runs are done, and why some failed; `part` of the study was started."""
        facts = {
            "runs": f"{self.done} of {self.runs}",
            "shards": f"{self.shards_done} of {self.shards}",
            "failed": str(self.failed),
        }
        print_facts(f"{self.directory}: {self.name}, {self.outcome}", facts)
        if self.failed:
            show_table(failures_table(self.failures.drop(columns="sentence")))
            for one in self.failures.to_dict("records"):
                say(f"{one['outcome']}: {one['sentence']}")
        if self.done < self.runs and not part:
            say("the same command again does the rest")


def study_status(directory: str | Path, *, interrupted: bool = False) -> Status:
    """Return how far the study in a directory is, even while another process writes there."""
    store = Store(Path(directory))
    shards = store.done()
    table = store.table(["run", "outcome", "sentence"], shards)
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
    """Return why runs failed, the most frequent outcome first; no rows if none did.

    The columns are `outcome`, `runs`, `share` (of those in the table), `first` (number of the first
    such run) and its `sentence`.
    """
    failed = table[table["outcome"] != COMPLETED]
    groups = failed.groupby("outcome", sort=True, observed=True)
    found = groups.agg(runs=("run", "size"), first=("run", "min"), sentence=("sentence", "first"))
    found.insert(1, "share", found["runs"] / max(len(table), 1))
    return found.sort_values("runs", ascending=False, kind="stable").reset_index()


def failures_table(failures: pd.DataFrame) -> Table:
    """Return why runs failed as a table for readers."""
    heads = {"outcome": "Outcome", "runs": "Runs", "share": "Share", "first": "First run"}
    columns = [
        Quantity(head, form="d" if name in ("runs", "first") else ".3g", name=name)
        for name, head in heads.items()
    ]
    columns.append(Quantity("Explanation", name="sentence"))
    return make_table(failures, columns, "Why runs failed")


TRIED = 16  # runs that are measured
NUMBER, HISTORY = 8, 4  # bytes of a number in a table and in a history; neither is compressed well


@dataclass(frozen=True)
class Forecast:
    """What a study will cost."""

    runs: int  # number of them
    seconds: float  # of one run in one process
    jobs: int  # number of processes
    size: float  # on the disk, at most [bytes]
    failed: int  # of the runs that were tried, those that did not complete
    tried: int  # how many were
    motions: int  # to be made first, to fit a spectrum
    motion_seconds: float  # of one of them in one process

    @property
    def whole_seconds(self) -> float:
        """For all runs, on as many processes."""
        making = self.motions * self.motion_seconds / min(self.jobs, max(self.motions, 1))
        return making + self.runs * self.seconds / min(self.jobs, self.runs)


def forecast(study: Study, jobs: int | None = None) -> Forecast:
    """Carry out a few runs of a study, and extrapolate to all."""
    study, motions, making = with_first_motion(study)
    runs = plan(study)
    some = runs.iloc[np.unique(np.linspace(0, len(runs) - 1, TRIED).astype(int))]
    preparer = Preparer(study)
    preparer.foresee(some)
    kept = study.keep.histories
    carried_out(preparer, some.head(1))  # compiled, and shared things made
    begin = time.perf_counter()
    done = carried_out(preparer, some, histories=kept != "none")
    took = (time.perf_counter() - begin) / len(some)
    assert done is not None
    each = [
        sum(values.size for values in history.traces.values()) * HISTORY
        for history in done.histories
    ]
    count = len(runs) if kept == "all" else study.keep.worst
    columns = len(list_columns(study)) + len(RESULT_COLUMNS) + 4
    histories = min(count, len(runs)) * (np.mean(each) if each else 0.0)
    return Forecast(
        runs=len(runs),
        seconds=took,
        jobs=jobs or os.cpu_count() or 1,
        size=float(len(runs) * columns * NUMBER + histories),
        failed=int((done.table["outcome"] != COMPLETED).sum()),
        tried=len(some),
        motions=motions,
        motion_seconds=making,
    )


def say_duration(seconds: float) -> str:
    """Return a time in words: "42 s", "3 min 20 s", "11 h 6 min"."""
    rounded = round(seconds)
    if rounded < 60:
        return f"{rounded} s"
    if rounded < 3600:
        return f"{rounded // 60} min {rounded % 60} s"
    return f"{rounded // 3600} h {rounded % 3600 // 60} min"


class Pace:
    """How quickly runs are done, of so many at the start and in all."""

    def __init__(self, done: int, total: int) -> None:
        self.done, self.total = done, total
        self._first, self._began = done, time.monotonic()

    def __str__(self) -> str:
        """Return words such as "192 of 256 runs, 61.2 a second, 1 s left"."""
        passed = time.monotonic() - self._began
        text = f"{self.done} of {self.total} runs"
        if self.done == self._first or passed <= 0.0:
            return text
        rate = (self.done - self._first) / passed
        return f"{text}, {rate:.3g} a second, {say_duration((self.total - self.done) / rate)} left"
