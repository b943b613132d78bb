"""Executors of a study: this process, local processes, a Dask cluster.

Each takes shards one by one and gives back what came of them as it is ready; a few are on their
way at a time, so that the memory of a study does not grow with it. Shards know nothing of each
other, and a shard that is lost with its process is carried out again: nobody writes but the
process that began.
"""

import queue
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from itertools import chain
from typing import Any

from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.threads import one_blas_thread
from thermobearing.studies.run.processes import KEPT, begin, context_of_processes, is_stopped
from thermobearing.studies.run.shard import Done, Work, carry_out

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


EXTRA = 'needs distributed: pip install "thermobearing[cluster]"'
SCHEDULER_PATIENCE = 10.0  # for a scheduler that does not answer [s]
LOOK = 0.5  # how often it is asked whether it is still there [s]
FEWEST = 4  # shards on their way, so that workers that come later find some
LOST = ("cancelled", "lost")


def on_dask(
    study: bytes, works: Iterable[Work], address: Any, *, histories: bool
) -> Iterator[Finished]:
    """On the workers of a cluster; a shard whose worker dies is given to another.

    Parameters
    ----------
    study : from `packed`.
    works : shards with their rows.
    address : of the scheduler, "tcp://host:8786", or a `distributed.Client`.
    histories : bring them too.

    Raises
    ------
    InputError : distributed is not installed, or no scheduler answers at the address.
    OutputError : the scheduler is gone, or a shard takes its workers down again and again.
    """
    with ExitStack() as stack:
        client = _client(address, stack)
        try:
            yield from _Shards(client, study, works, histories).finished()
        except (OSError, TimeoutError) as error:  # a connection that broke while it was used
            raise OutputError(f"the Dask cluster is gone ({error}); {KEPT}") from None


def _client(address: Any, stack: ExitStack) -> Any:
    """A client of the scheduler; closed at the end if it is ours."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError(f"executor dask {EXTRA}") from None
    if isinstance(address, Client):
        return address
    if not address:
        raise InputError('executor dask: say where its scheduler is, as address "tcp://host:8786"')
    try:
        make: Any = Client
        client = make(str(address), timeout=SCHEDULER_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f'address "{address}": no Dask scheduler answers there ({type(error).__name__}); is it '
            "running, and can it be reached from here?"
        ) from None
    stack.callback(client.close)
    return client


class _Shards:
    """Shards on their way, and those that wait."""

    def __init__(self, client: Any, study: bytes, works: Iterable[Work], histories: bool) -> None:
        self.client, self.histories = client, histories
        self.works = iter(works)
        self.running: dict[Any, Work] = {}
        self.ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
        # As a task, and not as data: a worker that dies with it takes nothing away.
        self.study = client.submit(bytes, study, pure=False)

    def finished(self) -> Iterator[Finished]:
        """All shards, as they are ready."""
        try:
            while self._send_more():
                future = self._next_ready()
                work = self.running.pop(future)
                if future.status in LOST:
                    self._send(work)
                    continue
                yield work.number, self._result(future)
        finally:
            if self._is_there():
                self.client.cancel([*self.running, self.study])

    def _send_more(self) -> bool:
        """Keep every worker busy; whether anything is on its way."""
        threads = sum(self.client.nthreads().values()) if self._is_there() else 0
        while len(self.running) < max(FEWEST, AHEAD * threads):
            work = next(self.works, None)
            if work is None:
                break
            self._send(work)
        return bool(self.running)

    def _send(self, work: Work) -> None:
        self._check()
        future = self.client.submit(carry_out, self.study, work, self.histories, pure=False)
        self.running[future] = work
        future.add_done_callback(self.ready.put)

    def _next_ready(self) -> Any:
        """The next that is done, whatever came of it."""
        while True:
            try:
                return self.ready.get(timeout=LOOK)
            except queue.Empty:
                self._check()

    def _is_there(self) -> bool:
        return bool(self.client.status == "running")

    def _check(self) -> None:
        """OutputError if the scheduler is gone."""
        if not self._is_there():
            raise OutputError(f"the Dask scheduler is gone ({self.client.status}); {KEPT}")

    def _result(self, future: Any) -> Any:
        from distributed import KilledWorker

        try:
            return future.result()
        except KilledWorker:
            raise OutputError(
                "workers of the Dask cluster died again and again on the same runs (out of "
                f"memory?); {KEPT}, with smaller shards or larger workers"
            ) from None
