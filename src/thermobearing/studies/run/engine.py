"""Run the missing shards of a study.

A study is written by one process, or by several that have a part of it each (`--shard i/n`): then
each part by one. Locks belong to the open file, so that the system lets go of them by itself when
a process is killed. Where there are no locks (Windows, some networks) writers are not told apart:
they would do the same work, and put the same files in place.

    study -> plan -> directory; shards that have no file -> executor -> one file each, whole

The files are the only memory: whatever stops this (Ctrl-C, a full disk, a killed process), the
next start finds the shards that are done and does the others. A shard's numbers depend on its
rows of the plan only, so that executor, number of workers and order leave no trace.
"""

import os
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Any, Literal

import pandas as pd

from thermobearing.border.errors import InputError, OutputError
from thermobearing.results.directory import check_target, locked
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.definition.record import Study
from thermobearing.studies.inputs.motions import is_matched, with_matched
from thermobearing.studies.output import study_result
from thermobearing.studies.result import StudyResult
from thermobearing.studies.run.demand_parameters import COMPLETED
from thermobearing.studies.run.executors import Finished, in_turn, on_processes
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import BrokenError, Work, carry_out, packed, run_shard
from thermobearing.studies.run.status import Status, study_status
from thermobearing.studies.run.worst import RANKED, worst_runs
from thermobearing.studies.store.directory import MANIFEST, Pace, Store, open_or_make


@contextmanager
def only_writer(directory: Path, part: str = "") -> Iterator[None]:
    """Keep others from writing the study, or the part of it.

    Parameters
    ----------
    directory : of the study.
    part : such as "3-of-8"; others may then write other parts. The whole by default.

    Raises
    ------
    OutputError : another process writes it, or nobody can.
    """
    with ExitStack() as stack:
        _lock(stack, directory, directory, shared=bool(part))
        if part:
            own = directory / f".part-{part}"
            try:
                own.touch()
            except OSError as error:
                told = error.strerror or error
                raise OutputError(f"{directory}: cannot be written: {told}") from None
            _lock(stack, own, directory, shared=False)
            stack.callback(own.unlink, missing_ok=True)
        yield


def _lock(stack: ExitStack, path: Path, directory: Path, *, shared: bool) -> None:
    if stack.enter_context(locked(path, wait=False, shared=shared)) is False:
        raise OutputError(
            f"{directory}: another process is writing this study; wait for it, or look at it with "
            "`thermobearing study status`"
        )


Progress = Callable[[int, int], None]
ExecutorName = Literal["process", "dask"]
EXECUTORS = ("process", "dask")
MOST_JOBS = 1024


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
    """Carry out a study, or what is missing of it; never raises for a failed run.

    Parameters
    ----------
    study : from `load_study` or `make_study`.
    directory : new, or where this study was begun.
    executor : "process": processes on this machine; "dask": workers of a Dask cluster.
    jobs : processes, 1 to 1024; as many as there are cores by default. One is this process itself.
    address : of Dask's scheduler, "tcp://host:8786", or a `distributed.Client`.
    shard : "i/n": every n-th shard only, from the i-th, for batch systems; processes with other
        parts may write the same directory.
    size : runs of a shard, in a new directory; by default a hundredth of the study (in lockstep a
        25th), 16 to 1008.
    progress : called with (runs done, all runs).

    Returns
    -------
    Status : with a table of why runs failed; interrupted by Ctrl-C it says so.

    Raises
    ------
    InputError : words that cannot be used; another study was begun there; pyarrow or distributed
        are not installed; no scheduler answers.
    OutputError : the directory holds something else, another process writes the study, the disk is
        full, or workers die again and again. What is done is kept.

    Examples
    --------
    >>> import tempfile
    >>> from thermobearing.studies.definition.case import make_study
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "1 s"}, "factors": factors}
    >>> directory = Path(tempfile.mkdtemp()) / "p1"
    >>> run_study(make_study(table, "example"), directory, jobs=1).sentence
    '1 of 1 runs of p1 are done.'
    """
    directory = Path(directory)
    part = check_start(directory, executor, jobs, address, shard, size)
    study, runs, store = _opened(study, directory, size, jobs)
    with only_writer(directory, "" if part is None else f"{part[0]}-of-{part[1]}"):
        try:
            _do_missing(store, study, runs, part, (executor, jobs, address), progress)
        except KeyboardInterrupt:
            store.log.say("interrupted")
            return study_status(directory, interrupted=True)
        except BrokenError as error:
            store.log.say(f"broken: {error}")
            raise OutputError(f"{directory}: every run of a shard broke: {error}") from error
    return study_status(directory)


def _checked_part(text: str | None) -> tuple[int, int] | None:
    """The numbers of "i/n"; None for the whole.

    Raises
    ------
    InputError : it is not so.

    Examples
    --------
    >>> _checked_part("3/8")
    (3, 8)
    """
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
    """Refuse what `run_study` would refuse, before anything takes time; the part of the shards.

    Parameters
    ----------
    directory, executor, jobs, address, shard, size : as there.

    Raises
    ------
    InputError : words that cannot be used.
    OutputError : the directory holds something else.
    """
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
    """A study with its motions, its plan, and its directory, new or begun."""
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
    """Shards without a file, and the histories of the worst runs."""
    done = set(store.done())
    mine = [k for k in range(store.shards) if part is None or k % part[1] == part[0] - 1]
    missing = [k for k in mine if k not in done]
    store.clean(mine)
    pace = Pace(_shard_runs(store, [k for k in mine if k in done]), _shard_runs(store, mine))
    store.log.say(f"started: {pace.told()}" + (f"; part {part[0]} of {part[1]}" if part else ""))
    if progress:
        progress(pace.done, pace.total)
    works = _works(study, runs, [(k, store.place(k)) for k in missing])
    with closing(_carried_out(study, works, len(missing), how)) as finished:
        for number, shard in finished:
            store.write(number, shard)
            pace.done += len(shard.table)
            failed = int((shard.table["outcome"] != COMPLETED).sum())
            store.log.say(f"shard {number}: {failed} failed; {pace.told()}")
            if progress:
                progress(pace.done, pace.total)
    _keep_worst(store, study, runs)


def _works(study: Study, runs: pd.DataFrame, shards: Sequence[tuple[int, slice]]) -> Iterator[Work]:
    """Shards with what the weather made of their bearings, which is found once."""
    if not shards:
        return
    preparer = Preparer(study)
    preparer.foresee(pd.concat([runs.iloc[place] for _, place in shards]))
    for number, place in shards:
        rows = runs.iloc[place]
        yield Work(number, rows, preparer.foreseen_temperatures(rows))


def _shard_runs(store: Store, shards: list[int]) -> int:
    return sum(store.place(k).stop - store.place(k).start for k in shards)


def _carried_out(
    study: Study, works: Iterator[Work], count: int, how: tuple[str, int | None, Any]
) -> Generator[Finished]:
    """What came of shards, as they are ready."""
    executor, jobs, address = how
    histories, sent = study.keep.histories == "all", packed(study)
    jobs = min(jobs or os.cpu_count() or 1, max(count, 1))
    if executor == "dask":
        from thermobearing.studies.run.executors import on_dask

        yield from on_dask(sent, works, address, histories=histories)
    elif jobs == 1:
        yield from in_turn(sent, works, histories=histories)
    else:
        yield from on_processes(sent, works, jobs, histories=histories)


def _keep_worst(store: Store, study: Study, runs: pd.DataFrame) -> None:
    """Histories of the worst runs, once all are done: these are carried out again."""
    if not study.keep.worst or store.has_worst or len(done := store.done()) < store.shards:
        return
    table = store.table(["run", "outcome", *RANKED], done)
    worst = worst_runs(table, study.keep.worst)
    (work,) = _works(study, runs.iloc[sorted(worst)], [(0, slice(None))])
    again = carry_out(packed(study), work, histories=True)
    assert again is not None
    store.write_worst(again.histories)
    store.log.say(f"histories of the worst {len(worst)} runs kept")


def study(
    source: Study | dict[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    executor: ExecutorName = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    progress: Progress | None = None,
) -> StudyResult:
    """A study of very many runs: plan, runs, and what is drawn from them.

    Parameters
    ----------
    source : a TOML file (docs/files.md), its table, or a Study.
    directory : where it is kept, new or begun with the same study, of which the rest is done; needs
        the extra `study`. None: nothing is written, and all runs are done here one by one.
    executor : "process" or "dask".
    jobs : processes, 1 to 1024; as many as there are cores by default.
    address : of Dask's scheduler, or a `distributed.Client`.
    shard : "i/n": every n-th part only, from the i-th.
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
    made = _made(source)
    if directory is not None:
        run_study(
            made,
            directory,
            executor=executor,
            jobs=jobs,
            address=address,
            shard=shard,
            progress=progress,
        )
        return study_result(directory)
    if executor != "process" or jobs is not None or address is not None or shard is not None:
        raise InputError("executor, jobs, address and shard need a directory", "study()")
    runs = plan(made)
    return StudyResult(run_shard(made, runs), made, {"runs": len(runs)})


def _made(source: Any) -> Study:
    """The study that something stands for."""
    if isinstance(source, Study):
        return source
    if isinstance(source, dict):
        return make_study(source, "study()")
    if isinstance(source, str | Path):
        return load_study(source)
    raise InputError(f"{type(source).__name__}: must be a file, its table, or a Study", "study()")
