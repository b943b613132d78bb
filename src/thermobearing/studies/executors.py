"""Who carries out shards: this process, processes of its own, or a Dask cluster.

Each takes shards one by one and gives back what came of them as it is ready; a few are on their
way at a time, so that the memory of a study does not grow with it. Shards know nothing of each
other, and a shard that is lost with its process is carried out again: nobody writes but the
process that began.
"""

from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import chain
from typing import Any

from thermobearing.border.errors import OutputError
from thermobearing.border.threads import one_blas_thread
from thermobearing.studies.processes import KEPT, begin, context_of_processes, is_stopped
from thermobearing.studies.shard import Done, Work, carry_out

Finished = tuple[int, Done]
AHEAD = 2  # shards for each worker that are on their way
PATIENCE = 3  # times in a row that workers may die with nothing done between


def in_turn(study: bytes, works: Iterable[Work], *, histories: bool) -> Iterator[Finished]:
    """One after the other, in this process."""
    for work in works:
        done = carry_out(study, work, histories)
        if done is not None:
            yield work.number, done


_OWN: dict[str, bytes] = {}  # of a process of the pool: its study


def _begin(study: bytes, stop: Any) -> None:
    """What a process of the pool does first."""
    begin(stop)
    _OWN["study"] = study


def _carry_out_here(work: Work, histories: bool) -> Done | None:
    return carry_out(_OWN["study"], work, histories, stop=is_stopped)


def on_processes(
    study: bytes, works: Iterable[Work], jobs: int, *, histories: bool
) -> Iterator[Finished]:
    """On so many processes of their own; those that die are replaced.

    Raises
    ------
    OutputError : they die again and again.
    """
    one_blas_thread()  # the processes inherit it
    waiting, deaths = _Waiting(works), 0
    while True:
        try:
            for finished in _of_one_pool(study, waiting, jobs, histories):
                deaths = 0
                yield finished
            return
        except BrokenProcessPool:
            deaths += 1
            if deaths >= PATIENCE:
                raise OutputError(
                    f"processes of the study died {deaths} times in a row (out of memory? A "
                    'program that calls tb.study must do so below `if __name__ == "__main__":`); '
                    f"{KEPT}, perhaps with fewer jobs"
                ) from None


class _Waiting:
    """Shards that nobody has yet, and those that were taken by processes that may die."""

    def __init__(self, works: Iterable[Work]) -> None:
        self._works = iter(works)
        self.taken: dict[int, Work] = {}

    def take(self) -> Work | None:
        """One to be carried out; None if there is no more."""
        work = next(self._works, None)
        if work is not None:
            self.taken[work.number] = work
        return work

    def give_back(self) -> None:
        """Those that were taken, and are not done, wait again."""
        self._works = chain(list(self.taken.values()), self._works)
        self.taken = {}


def _of_one_pool(study: bytes, waiting: _Waiting, jobs: int, histories: bool) -> Iterator[Finished]:
    """What one pool of processes does until all is done, or one of them dies."""
    context = context_of_processes()
    stop = context.Event()
    pool = ProcessPoolExecutor(jobs, context, _begin, (study, stop))
    running: dict[Future[Done | None], int] = {}
    try:
        while True:
            while len(running) < AHEAD * jobs and (work := waiting.take()) is not None:
                running[pool.submit(_carry_out_here, work, histories)] = work.number
            if not running:
                return
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                done, number = future.result(), running.pop(future)
                del waiting.taken[number]
                if done is not None:
                    yield number, done
    finally:
        stop.set()
        pool.shutdown(cancel_futures=True)
        waiting.give_back()
