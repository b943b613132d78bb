"""Run the missing shards of a study.

A study is written by one process, or by several that have a part of it each (`--shard i/n`): then
each part by one. Locks belong to the open file, so that the system releases them by itself when a
process is killed. Where there are no locks (Windows, some networks) several writers would do the
same work, and put the same files in place.

    study -> plan -> directory; shards that have no file -> executor -> one file each

The files are the only memory: whatever stops this (Ctrl-C, a full disk, a killed process), the
next start finds the shards that are done and does the others. A shard's numbers depend on its
rows of the plan only, so that executor, number of workers and order leave no trace.
"""

import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pandas as pd

from thermobearing.border.errors import InputError, OutputError
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_task
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.results.directory import check_target, locked
from thermobearing.results.screen import print_facts, say, show_table
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import list_columns, plan
from thermobearing.studies.definition.motions import Progress, with_first_motion, with_matched
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.processes import call_on_processes
from thermobearing.studies.run.shard import (
    COMPLETED,
    RESULT_COLUMNS,
    BrokenError,
    Work,
    carried_out,
    carry_out,
    on_dask,
    packed,
    run_shard,
)
from thermobearing.studies.statistics.demand import RANKED, worst_runs
from thermobearing.studies.store import HISTORIES_FOLDER, MANIFEST, WORST, Store, open_or_make

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult


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
    columns = [
        Quantity("Outcome", form=".3g", name="outcome"),
        Quantity("Runs", form="d", name="runs"),
        Quantity("Share", form=".3g", name="share"),
        Quantity("First run", form="d", name="first"),
        Quantity("Explanation", name="sentence"),
    ]
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
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest} s" if minutes else f"{rest} s"
    return f"{minutes // 60} h {minutes % 60} min"


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


ExecutorName = Literal["process", "dask"]
EXECUTORS = ("process", "dask")
MOST_JOBS = 1024


@contextmanager
def _only_writer(directory: Path, part: str = "") -> Iterator[None]:
    """Keep others from writing the study, or a part of it such as "3-of-8"."""
    with ExitStack() as stack:
        _lock(stack, directory, directory, shared=bool(part))
        if part:
            own = directory / f".part-{part}"
            try:
                own.touch()
            except OSError as error:
                reason = error.strerror or error
                raise OutputError(f"{directory}: cannot be written: {reason}") from None
            _lock(stack, own, directory, shared=False)
            stack.callback(own.unlink, missing_ok=True)
        yield


def _lock(stack: ExitStack, path: Path, directory: Path, *, shared: bool) -> None:
    if stack.enter_context(locked(path, wait=False, shared=shared)) is False:
        raise OutputError(
            f"{directory}: another process is writing this study; wait for it, or look at it with "
            "`thermobearing study status`"
        )


def run_study(
    study: Study,
    directory: str | Path,
    *,
    executor: ExecutorName = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    size: int | None = None,
    progress: Progress | None = None,
) -> Status:
    """Carry out a study, or what is missing of it; a failed run does not raise."""
    directory = Path(directory)
    part = check_start(directory, executor, jobs, address, shard, size)
    study, runs, store = _opened(study, directory, size, jobs)
    with _only_writer(directory, "" if part is None else f"{part[0]}-of-{part[1]}"):
        try:
            _do_missing(store, study, runs, part, (executor, jobs, address), progress)
        except KeyboardInterrupt:
            store.log("interrupted")
            return study_status(directory, interrupted=True)
        except BrokenError as error:
            store.log(f"broken: {error}")
            raise OutputError(f"{directory}: every run of a shard broke: {error}") from error
    return study_status(directory)


def check_start(
    directory: Path,
    executor: str = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    size: int | None = None,
) -> tuple[int, int] | None:
    """Refuse what `run_study` would refuse, before anything takes time; the part of the shards."""
    part = None
    if shard is not None:
        found = re.fullmatch(r"\s*(\d+)\s*/\s*(\d+)\s*", shard)
        if found is None:
            raise InputError(f'shard "{shard}": give i/n, such as 3/8 for the third of eight parts')
        part = int(found[1]), int(found[2])
        if not 1 <= part[0] <= part[1]:
            raise InputError(f'shard "{shard}": parts of {part[1]} have the numbers 1 to {part[1]}')
    if executor not in EXECUTORS:
        raise InputError(f'executor "{executor}": must be "process" or "dask"')
    if jobs is not None and not 1 <= jobs <= MOST_JOBS:
        raise InputError(f"jobs: {jobs} is not in [1, {MOST_JOBS}]")
    if size is not None and size < 1:
        raise InputError(f"size: {size} runs are no shard; at least 1")
    if executor == "process" and address is not None:
        raise InputError('address: only of executor "dask"')
    if not (directory / MANIFEST).exists():
        check_target(directory, overwrite=False)
    return part


def _opened(
    study: Study, directory: Path, size: int | None, jobs: int | None
) -> tuple[Study, pd.DataFrame, Store]:
    begun = (directory / MANIFEST).exists()
    made = with_matched(study, directory, jobs)
    runs = plan(made)
    try:
        return made, runs, open_or_make(directory, made, runs, size)
    except InputError:
        # Another part was quicker, perhaps on a machine of other last bits: its are taken.
        if begun or study.factors.motion.matched is None or not (directory / MANIFEST).exists():
            raise
        return _opened(study, directory, size, jobs)


def _do_missing(
    store: Store,
    study: Study,
    runs: pd.DataFrame,
    part: tuple[int, int] | None,
    how: tuple[str, int | None, Any],
    progress: Progress | None,
) -> None:
    """Carry out shards without a file, and keep the histories of the worst runs."""
    done = set(store.done())
    mine = [k for k in range(store.shards) if part is None or k % part[1] == part[0] - 1]
    missing = [k for k in mine if k not in done]
    store.clean(mine)
    pace = Pace(store.count([k for k in mine if k in done]), store.count(mine))
    store.log(f"started: {pace}" + (f"; part {part[0]} of {part[1]}" if part else ""))
    if progress:
        progress(pace.done, pace.total)
    works = _works(study, runs, [(k, store.place(k)) for k in missing])
    shared, (executor, jobs, address) = (packed(study), study.keep.histories == "all"), how
    jobs = min(jobs or os.cpu_count() or 1, max(len(missing), 1))
    with closing(
        on_dask(shared, works, address)
        if executor == "dask"
        else call_on_processes(carry_out, shared, works, jobs)
    ) as finished:
        for work, shard in finished:
            if shard is None:  # stopped
                continue
            store.write(work.number, shard)
            pace.done += len(shard.table)
            failed = int((shard.table["outcome"] != COMPLETED).sum())
            store.log(f"shard {work.number}: {failed} failed; {pace}")
            if progress:
                progress(pace.done, pace.total)
    _keep_worst(store, study, runs)


def _works(study: Study, runs: pd.DataFrame, shards: Sequence[tuple[int, slice]]) -> Iterator[Work]:
    """Yield shards with the temperatures of their bearings, which are found once."""
    if not shards:
        return
    preparer = Preparer(study)
    preparer.foresee(pd.concat([runs.iloc[place] for _, place in shards]))
    for number, place in shards:
        rows = runs.iloc[place]
        yield Work(number, rows, preparer.foreseen_temperatures(rows))


def _keep_worst(store: Store, study: Study, runs: pd.DataFrame) -> None:
    """Keep histories of the worst runs, once all are done: these are carried out again."""
    kept = store.directory / HISTORIES_FOLDER / WORST
    if not study.keep.worst or kept.exists() or len(done := store.done()) < store.shards:
        return
    table = store.table(["run", "outcome", *RANKED], done)
    worst = worst_runs(table, study.keep.worst)
    (work,) = _works(study, runs.iloc[sorted(worst)], [(0, slice(None))])
    again = carry_out((packed(study), True), work)
    assert again is not None
    store.write_histories(WORST, again.histories)
    store.log(f"histories of the worst {len(worst)} runs kept")


def repeat_run(study: Study, run: int) -> EarthquakeResult:
    """Carry out one run of a study again; the same numbers, to the last bit or, of a study in
    lockstep, within rounding.

    Where the study has weather, the bearing begins as warm as in it; the case of the result has
    the ambient temperature of that hour only.
    """
    runs = plan(study)
    if not 0 <= run < len(runs):
        raise InputError(f"no run {run}; {study.name} has 0 to {len(runs) - 1}")
    row = runs.iloc[[run]].to_dict("records")[0]
    task = Preparer(study).make_task({str(key): value for key, value in row.items()})
    history = run_task(task)
    motion = task.case.motions[0]
    scaled = motion.model_copy(update={"factor": motion.factor * float(row["scale"])})
    case = task.case.model_copy(update={"motions": [scaled]})
    return label_analysis(case, [replace(task, case=case)], [history])


def study(
    source: Study | dict[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    executor: ExecutorName = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> "StudyResult":
    """Carry out a parameter study of very many runs, and return its result.

    Parameters
    ----------
    source : a TOML file (docs/files.md), its table, or a Study.
    directory : where it is kept, new or begun with the same study, of which the rest is done; needs
        the extra `study`. None: nothing is written, and all runs are done here one by one.
    executor : "process": processes on this machine; "dask": workers of a Dask cluster.
    jobs : processes, 1 to 1024; as many as there are cores by default. One is this process itself.
    address : of Dask's scheduler, "tcp://host:8786", or a `distributed.Client`.
    shard : "i/n": every n-th shard only, from the i-th, for batch systems; processes with other
        parts may write the same directory.
    progress : called with (runs done, all runs); with a directory.

    Returns
    -------
    StudyResult

    Raises
    ------
    InputError : everything that is wrong with the study; another one was begun there.
    OutputError : the directory cannot be written.

    Examples
    --------
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "2 s"}, "factors": factors}
    >>> study(table).table["outcome"].tolist()
    ['completed']
    """
    from thermobearing.studies.result import StudyResult, study_result  # reads statistics

    if isinstance(source, dict):
        made = make_study(source, "study()")
    elif isinstance(source, str | Path):
        made = load_study(source)
    elif isinstance(source, Study):
        made = source
    else:
        name = type(source).__name__
        raise InputError(f"{name}: must be a file, its table, or a Study", "study()")
    how: dict[str, Any] = {"executor": executor, "jobs": jobs, "address": address, "shard": shard}
    if directory is not None:
        run_study(made, directory, progress=progress, **how)
        return study_result(directory)
    if how != {"executor": "process", "jobs": None, "address": None, "shard": None}:
        raise InputError("executor, jobs, address and shard need a directory", "study()")
    runs = plan(made)
    return StudyResult(run_shard(made, runs), made, {"runs": len(runs)})
