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
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pandas as pd

from thermobearing.border.errors import InputError, OutputError
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_task
from thermobearing.results.directory import check_target, locked
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.definition.motions import Progress, is_matched, with_matched
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.processes import call_on_processes
from thermobearing.studies.run.shard import (
    COMPLETED,
    BrokenError,
    Done,
    Work,
    carry_out,
    on_dask,
    packed,
    run_shard,
)
from thermobearing.studies.run.status import Pace, Status, study_status
from thermobearing.studies.statistics.demand import RANKED, worst_runs
from thermobearing.studies.store import HISTORIES_FOLDER, MANIFEST, WORST, Store, open_or_make

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult

ExecutorName = Literal["process", "dask"]
EXECUTORS = ("process", "dask")
MOST_JOBS = 1024
Finished = Generator[tuple[Work, Done | None]]


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


def _checked_part(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    first, slash, last = text.partition("/")
    if not (slash and first.strip().isdecimal() and last.strip().isdecimal()):
        raise InputError(f'shard "{text}": give i/n, such as 3/8 for the third of eight parts')
    part, parts = int(first), int(last)
    if not 1 <= part <= parts:
        raise InputError(f'shard "{text}": parts of {parts} have the numbers 1 to {parts}')
    return part, parts


def check_start(
    directory: Path,
    executor: str = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    size: int | None = None,
) -> tuple[int, int] | None:
    """Refuse what `run_study` would refuse, before anything takes time; the part of the shards."""
    part = _checked_part(shard)
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
        if begun or not is_matched(study) or not (directory / MANIFEST).exists():
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
    with closing(_carried_out(study, works, len(missing), how)) as finished:
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


def _carried_out(
    study: Study, works: Iterator[Work], count: int, how: tuple[str, int | None, Any]
) -> Finished:
    executor, jobs, address = how
    shared = packed(study), study.keep.histories == "all"
    if executor == "dask":
        yield from on_dask(shared, works, address)
    else:
        jobs = min(jobs or os.cpu_count() or 1, max(count, 1))
        yield from call_on_processes(carry_out, shared, works, jobs)


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
