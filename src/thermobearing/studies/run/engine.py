"""Run the missing shards of a study.

One process writes a study, or one process for each part of it (`--shard i/n`). Locks belong to the
open file, so that the system releases them when a process is killed. Without locks (Windows, some
networks) several writers do the same work and write the same files.

    study -> plan -> directory; shards without a file -> executor -> a file each

The state is in the files only: after any interruption (Ctrl-C, a full disk, a killed process) the
next start computes the missing shards. The numbers of a shard depend on its rows of the plan only,
not on the executor, the number of workers or the order.
"""

import os
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.lazy import pd
from thermobearing.border.opener import is_file
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.result import STRAIN, EarthquakeResult
from thermobearing.earthquake.run import run_task
from thermobearing.results.base import COMPLETED
from thermobearing.results.directory import check_target, locked
from thermobearing.results.screen import print_facts, say, show_table
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.definition.motions import Progress, with_first_motion, with_matched
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.processes import call_on_processes, ended_by_sigterm
from thermobearing.studies.run.shard import (
    RESULT_COLUMNS,
    BrokenError,
    Work,
    compute_shard,
    compute_shard_in_process,
    on_dask,
    packed,
    run_shard,
)
from thermobearing.studies.statistics.demand import RANKED, worst_runs
from thermobearing.studies.store import HISTORIES_FOLDER, MANIFEST, WORST, Store, open_or_make
from thermobearing.studies.tables import FAILURE_COLUMNS, count_failures, failures_table

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult


class Effort(NamedTuple):
    """What one start of a study took."""

    computed_runs: int
    seconds: float
    peak_memory_MB: float | None  # of the largest process; None on Windows

    def __str__(self) -> str:
        """Return text such as "4 s, 61.2 runs per second, 310 MB in the largest process"."""
        speed = self.computed_runs / max(self.seconds, 1e-9)
        text = f"{say_duration(self.seconds)}, {speed:.3g} runs per second"
        if self.peak_memory_MB is None:
            return text
        return f"{text}, {self.peak_memory_MB:.0f} MB in the largest process"


@dataclass(frozen=True)
class Status:
    """Progress of a study; `failures` is from `count_failures`."""

    directory: Path
    name: str
    runs: int
    done: int  # completed or failed runs
    shards: int
    shards_done: int
    failures: "pd.DataFrame"
    interrupted: bool = False  # by Ctrl-C
    effort: "Effort | None" = None  # of this start; None where nothing was computed

    @property
    def failed(self) -> int:
        """Number of failed runs."""
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
        text = f"{self.done} of {self.runs} runs of {self.name} are complete"
        if self.failed:
            text += f", {self.failed} of them failed"
        if self.done < self.runs:
            text += "; run the same command again to resume"
        return f"{text}."

    def summary(self) -> dict[str, Any]:
        """Return the status as data."""
        names = ("name", "outcome", "runs", "done", "failed", "shards", "shards_done")
        content = {name: getattr(self, name) for name in names}
        content |= {} if self.effort is None else self.effort._asdict()
        return content | {"failures": self.failures.to_dict("records")}

    def show(self, *, part: bool = False) -> None:
        """Print the progress and the failures; `part`: only a part was started."""
        facts = {
            "runs": f"{self.done} of {self.runs}",
            "shards": f"{self.shards_done} of {self.shards}",
            "failed": str(self.failed),
        }
        if self.effort is not None:
            facts["effort"] = str(self.effort)
        print_facts(f"{self.directory}: {self.name}, {self.outcome}", facts)
        if self.failed:
            show_table(failures_table(self.failures.drop(columns="sentence")))
            for failure in self.failures.to_dict("records"):
                say(f"{failure['outcome']}: {failure['sentence']}")
        if self.done < self.runs and not part:
            say("Run the same command again to resume the study.")


def study_status(
    directory: str | Path, *, interrupted: bool = False, effort: Effort | None = None
) -> Status:
    """Return the progress of the study in a directory, also while another process writes it."""
    store = Store(Path(directory))
    shards = store.done()
    table = store.table(["run", "outcome", "sentence", *FAILURE_COLUMNS], shards)
    return Status(
        directory=store.directory,
        name=str(store.manifest["name"]),
        runs=store.runs,
        done=len(table),
        shards=store.shards,
        shards_done=len(shards),
        failures=count_failures(table),
        interrupted=interrupted,
        effort=effort,
    )


def _peak_memory() -> float | None:
    """Return the largest memory of this process and of those that it started [MB]."""
    if sys.platform == "win32":
        return None
    import resource

    unit = 1 if sys.platform == "darwin" else 1024  # [bytes]
    processes = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return 1e-6 * unit * max(resource.getrusage(process).ru_maxrss for process in processes)


TRIED = 16  # runs that are timed
NUMBER, HISTORY = 8, 4  # bytes of a number in a table and in a history, without compression


@dataclass(frozen=True)
class Forecast:
    """Expected time and size of a study."""

    runs: int
    seconds: float  # of one run in one process
    jobs: int  # number of processes
    size: float  # on the disk, at most [bytes]
    failures: "pd.DataFrame"  # of the timed runs, as of a status: outcome, runs, sentence
    tried: int  # number of timed runs
    motions: int  # to be matched to a spectrum first
    motion_seconds: float  # of one of them in one process

    @property
    def failed(self) -> int:
        """Number of the timed runs that failed."""
        return int(self.failures["runs"].sum())

    @property
    def whole_seconds(self) -> float:
        """Time of all motions and runs on all processes."""
        making = self.motions * self.motion_seconds / min(self.jobs, max(self.motions, 1))
        return making + self.runs * self.seconds / min(self.jobs, self.runs)


def forecast(study: Study, jobs: int | None = None) -> Forecast:
    """Run a few analyses of a study, and extrapolate to all."""
    study, motions, motion_seconds = with_first_motion(study)
    plan = Plan(study)
    runs = plan.runs
    sample = runs.iloc[np.unique(np.linspace(0, len(runs) - 1, TRIED).astype(int))]
    preparer = Preparer(plan)
    preparer.compute_temperatures(sample)
    histories_kept = study.keep.histories
    compute_shard(preparer, sample.head(1))  # compiles, and prepares what runs share
    begin = time.perf_counter()
    shard = compute_shard(preparer, sample, histories=histories_kept != "none")
    seconds = (time.perf_counter() - begin) / len(sample)
    assert shard is not None
    history_sizes = [
        sum(values.size for values in history.traces.values()) * HISTORY
        for history in shard.histories
    ]
    count = len(runs) if histories_kept == "all" else study.keep.worst
    columns = len(plan.columns) + len(RESULT_COLUMNS) + 4  # run, id, seed and sample
    histories = min(count, len(runs)) * (np.mean(history_sizes) if history_sizes else 0.0)
    return Forecast(
        runs=len(runs),
        seconds=seconds,
        jobs=jobs or os.cpu_count() or 1,
        size=float(len(runs) * columns * NUMBER + histories),
        failures=count_failures(shard.table),
        tried=len(sample),
        motions=motions,
        motion_seconds=motion_seconds,
    )


def say_duration(seconds: float) -> str:
    """Return a duration in words: "42 s", "3 min 20 s", "11 h 6 min"."""
    minutes, remaining_seconds = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {remaining_seconds} s" if minutes else f"{remaining_seconds} s"
    return f"{minutes // 60} h {minutes % 60} min"


class Pace:
    """Progress and speed, with the numbers of runs that are done and in all."""

    def __init__(self, done: int, total: int) -> None:
        self.done, self.total = done, total
        self._first, self._began = done, time.monotonic()

    @property
    def computed(self) -> int:
        """Number of runs since the start."""
        return self.done - self._first

    @property
    def passed(self) -> float:
        """Time since the start [s]."""
        return time.monotonic() - self._began

    def __str__(self) -> str:
        """Return text such as "192 of 256 runs, 61.2 per second, 1 s left"."""
        passed = self.passed
        text = f"{self.done} of {self.total} runs"
        if not self.computed or passed <= 0.0:
            return text
        rate = self.computed / passed
        return (
            f"{text}, {rate:.3g} per second, {say_duration((self.total - self.done) / rate)} left"
        )


ExecutorName = Literal["process", "dask"]
EXECUTORS = ("process", "dask")
MOST_JOBS = 1024


@contextmanager
def _only_writer(directory: Path, part: str = "") -> Iterator[None]:
    """Lock the study, or a part of it such as "3-of-8", against other writers."""
    # Parts share the lock of the directory, which excludes a start of the whole study, and each has
    # the lock of a file of its own.
    with ExitStack() as stack:
        _lock(stack, directory, directory, shared=bool(part))
        if part:
            part_file = directory / f".part-{part}"
            try:
                part_file.touch()
            except OSError as error:
                reason = error.strerror or error
                raise OutputError(f"{directory}: cannot be written: {reason}") from None
            _lock(stack, part_file, directory, shared=False)
            stack.callback(part_file.unlink, missing_ok=True)
        yield


def _lock(stack: ExitStack, path: Path, directory: Path, *, shared: bool) -> None:
    if stack.enter_context(locked(path, wait=False, shared=shared)) is False:
        raise OutputError(
            f"{directory}: another process is writing this study; see its progress with "
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
    resume: bool = False,
    progress: Progress | None = None,
) -> Status:
    """Run or resume a study; a failed run does not raise.

    What a directory holds of the same study is never computed again. With `resume` the directory
    must hold some of it, so that a wrong name does not begin a study anew.

    Parameters
    ----------
    executor : where runs are computed: "process" (default) or "dask".
    jobs : number of processes; by default one for each core.
    address : address of the Dask scheduler, tcp://HOST:8786.
    shard : part i/n of the study, for batch systems: every n-th chunk from the i-th.
    resume : compute only what is missing in the directory, which must hold this study. Without it
        an interrupted study is resumed too, and a new one begins elsewhere.
    """
    directory = Path(directory)
    if resume:
        check_resumed(directory)
    part = check_start(directory, executor, jobs, address, shard, size)
    plan, store = _opened(study, directory, size, jobs)
    writer = _only_writer(directory, "" if part is None else f"{part[0]}-of-{part[1]}")
    with writer, ended_by_sigterm():
        try:
            store.remove_changed_histories()
            pace = _do_missing(store, plan, part, (executor, jobs, address), progress)
        except KeyboardInterrupt:
            store.log("interrupted")
            return study_status(directory, interrupted=True)
        except BrokenError as error:
            store.log(f"broken: {error}")
            raise OutputError(f"{directory}: all runs of a shard raised: {error}") from error
    computed = pace.computed
    effort = Effort(computed, pace.passed, _peak_memory()) if computed else None
    return study_status(directory, effort=effort)


def check_resumed(directory: Path) -> None:
    """Raise InputError for a directory without a study."""
    if not (directory / MANIFEST).exists():
        raise InputError(
            "holds no study to resume; without resume, one begins there", str(directory)
        )


def check_start(
    directory: Path,
    executor: str = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    size: int | None = None,
) -> tuple[int, int] | None:
    """Check the arguments of `run_study` at once; return number and count of the part, if any."""
    part = None
    if shard is not None:
        match = re.fullmatch(r"\s*(\d+)\s*/\s*(\d+)\s*", shard)
        if match is None:
            raise InputError(
                f'shard "{shard}": must be i/n, such as 3/8 for the third of eight parts'
            )
        part = int(match[1]), int(match[2])
        if not 1 <= part[0] <= part[1]:
            raise InputError(f'shard "{shard}": the part must be from 1 to {part[1]}')
    if executor not in EXECUTORS:
        raise InputError(f'executor "{executor}": must be "process" or "dask"')
    if jobs is not None and not 1 <= jobs <= MOST_JOBS:
        raise InputError(f"jobs: {jobs} must be from 1 to {MOST_JOBS}")
    if size is not None and size < 1:
        raise InputError(f"size: {size} must be at least 1 run")
    if executor == "process" and address is not None:
        raise InputError('address: only with executor "dask"')
    if not is_file(directory / MANIFEST):
        check_target(directory, overwrite=False)
    return part


def _opened(
    study: Study, directory: Path, size: int | None, jobs: int | None
) -> tuple[Plan, Store]:
    exists = (directory / MANIFEST).exists()
    plan = Plan(with_matched(study, directory, jobs))
    try:
        return plan, open_or_make(directory, plan, size)
    except InputError:
        # Another process was quicker, perhaps on another machine: its motions are used.
        if exists or study.factors.motion.matched is None or not (directory / MANIFEST).exists():
            raise
        return _opened(study, directory, size, jobs)


def _do_missing(
    store: Store,
    plan: Plan,
    part: tuple[int, int] | None,
    how: tuple[str, int | None, Any],
    progress: Progress | None,
) -> Pace:
    """Compute shards without a file, and write the histories of the worst runs."""
    completed = set(store.done())
    # Every n-th and not the n-th block: neighbours are alike, so that parts take the same time.
    part_shards = [k for k in range(store.shards) if part is None or k % part[1] == part[0] - 1]
    missing = [k for k in part_shards if k not in completed]
    store.clean(part_shards)
    pace = Pace(store.count([k for k in part_shards if k in completed]), store.count(part_shards))
    store.log(f"started: {pace}" + (f"; part {part[0]} of {part[1]}" if part else ""))
    if progress:
        progress(pace.done, pace.total)
    works = _works(plan, [(k, store.place(k)) for k in missing])
    histories = plan.study.keep.histories == "all"
    packed_plan, (executor, jobs, address) = packed(plan), how
    shared = packed_plan, histories
    jobs = min(jobs or os.cpu_count() or 1, max(len(missing), 1))
    # Closing stops the processes if a file cannot be written or the user interrupts.
    with closing(
        on_dask(shared, works, address)
        if executor == "dask"
        else call_on_processes(compute_shard_in_process, shared, works, jobs)
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
    _keep_worst(store, plan, packed_plan)
    return pace


def _works(plan: Plan, shards: Sequence[tuple[int, slice | list[int]]]) -> Iterator[Work]:
    """Yield shards with the temperatures of their bearings, which are computed once."""
    if not shards:
        return
    preparer = Preparer(plan)
    preparer.compute_temperatures(pd.concat([plan.runs.iloc[place] for _, place in shards]))
    for number, place in shards:
        rows = plan.runs.iloc[place]
        yield Work(number, rows, preparer.select_temperatures(rows))


def _keep_worst(store: Store, plan: Plan, packed_plan: bytes) -> None:
    """Repeat the worst runs, once all are complete, and write their histories."""
    path, count = store.directory / HISTORIES_FOLDER / WORST, plan.study.keep.worst
    if not count or path.exists() or len(completed := store.done()) < store.shards:
        return
    # The worst are known only when all runs are. They are computed twice, so that the histories of
    # the others need no room on the disk.
    table = store.table(["run", "outcome", STRAIN, *RANKED], completed)
    worst = worst_runs(table, count)
    (work,) = _works(plan, [(0, sorted(worst))])
    repeated = compute_shard_in_process((packed_plan, True), work)
    assert repeated is not None
    store.write_histories(WORST, repeated.histories)
    store.log(f"histories of the worst {len(worst)} runs written")


def repeat_run(study: Study, run: int, store: Store | None = None) -> EarthquakeResult:
    """Repeat one run of a study: the same bits, or within rounding for a study in lockstep.

    With weather the bearing has the initial temperatures of the study; the case of the result
    has the ambient temperature of that hour only. A `store` whose study has other runs, since a
    file that it refers to was changed, or whose kept history of the run was, is refused.
    """
    plan = Plan(study)
    runs = plan.runs
    if store is not None:
        store.check_runs(study, runs)
    if not 0 <= run < len(runs):
        raise InputError(f"no run {run}; {study.name} has runs 0 to {len(runs) - 1}")
    if store is not None:
        store.check_history(run)
    row = runs.iloc[[run]].to_dict("records")[0]
    task = Preparer(plan).make_task({str(key): value for key, value in row.items()})
    history = run_task(task)
    motion = task.case.motions[0]
    # The case that is stored with the result must give this run by itself.
    scaled = motion.model_copy(update={"factor": motion.factor * float(row["scale"])})
    case = task.case.model_copy(update={"motions": [scaled]})
    return label_analysis(case, [replace(task, case=case)], [history])


@checked
def study(
    source: Study | dict[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    executor: ExecutorName = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    resume: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> "StudyResult":
    """Run a parameter study, and return its result.

    Parameters
    ----------
    source : str, Path, dict or Study
        A TOML file (docs/files.md), its table, or a Study.
    directory : str or Path, optional
        Directory of the study, new or to be resumed; needs the extra `study`. Without it nothing
        is written, and all runs are computed one by one in this process.
    executor : {"process", "dask"}
        Processes of this machine, or workers of a Dask cluster.
    jobs : int, optional
        Number of processes, 1 to 1024; that of the cores by default. One is this process.
    address : str or distributed.Client, optional
        Address of the scheduler of Dask, such as "tcp://host:8786".
    shard : str, optional
        "i/n": every n-th shard from the i-th, for batch systems. Processes with other parts may
        write the same directory at the same time.
    resume : bool
        Compute only what is missing in the directory, which must hold this study. Without it an
        interrupted study is resumed too, and a new one begins in a directory without a study.
    progress : callable, optional
        Called with the numbers of completed runs and of all runs; with a directory.

    Raises
    ------
    InputError
        The study has errors (all are listed), the directory contains another study, or `resume`
        is set and it contains none.
    OutputError
        The directory cannot be written.

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
        run_study(made, directory, resume=resume, progress=progress, **how)
        return study_result(directory)
    if (
        resume
        or executor != "process"
        or any(how[key] is not None for key in ("jobs", "address", "shard"))
    ):
        raise InputError("executor, jobs, address, shard and resume need a directory", "study()")
    plan = Plan(made)
    return StudyResult(run_shard(plan, plan.runs), made, {"runs": len(plan.runs)})
