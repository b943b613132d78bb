"""Worker processes: how they start and end, and calls of a function on them."""

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import chain
from multiprocessing import connection, get_all_start_methods, get_context, parent_process
from typing import Any, TypeVar

from thermobearing.border.errors import OutputError
from thermobearing.border.threads import one_blas_thread

HERE = "thermobearing.studies.run.shard"  # module that processes import
KEPT = "completed shards are kept, run the same command again"
AHEAD = 2  # items that are submitted for each worker
PATIENCE = 3  # times in a row that processes may die without a result
S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")
_OWN: dict[str, Any] = {}  # of a process of a pool: event to stop, and shared data


def _begin(stop: Any, shared: Any) -> None:
    """Set up a process of a pool; its parent handles Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _OWN.update(stop=stop, shared=shared)
    parent = parent_process()
    assert parent is not None
    threading.Thread(target=_follow, args=(parent.sentinel,), daemon=True).start()


def _follow(parent: Any) -> None:
    """End this process when its parent ends, also if that is killed."""
    connection.wait([parent])
    os._exit(1)


def _call_here(call: Callable[[Any, T], R], item: T) -> R:
    return call(_OWN["shared"], item)


def is_stopped() -> bool:
    """Return whether this is a process of a pool that should stop."""
    return "stop" in _OWN and bool(_OWN["stop"].is_set())


class StoppedError(Exception):
    """The result of this process is not needed any more."""


def go_on(*_: Any) -> None:
    """Raise StoppedError if this process should stop; a progress callback of long calls."""
    if is_stopped():
        raise StoppedError


def _context() -> Any:
    """Return a fork server, since a fork while threads run may hang; spawning without one."""
    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload([HERE])
    return context


def call_on_processes(
    call: Callable[[S, T], R], shared: S, items: Iterable[T], jobs: int
) -> Generator[tuple[T, R]]:
    """Yield each item with `call(shared, item)` when it is ready; one job is this process.

    A few items are submitted at a time, so that memory does not grow with their number. Processes
    that die are replaced, and their items are computed again.
    """
    if jobs <= 1:
        yield from ((item, call(shared, item)) for item in items)
        return
    one_blas_thread()  # the processes inherit it
    context, deaths = _context(), 0
    waiting: Iterator[tuple[int, T]] = enumerate(items)
    taken: dict[int, T] = {}
    while True:
        stop = context.Event()
        pool = ProcessPoolExecutor(jobs, context, _begin, (stop, shared))
        running: dict[Future[R], int] = {}
        try:
            while True:
                while len(running) < AHEAD * jobs and (one := next(waiting, None)) is not None:
                    taken[one[0]] = one[1]
                    running[pool.submit(_call_here, call, one[1])] = one[0]
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    result, number = future.result(), running.pop(future)
                    deaths = 0
                    yield taken.pop(number), result
        except BrokenProcessPool:
            deaths += 1
            if deaths >= PATIENCE:
                raise OutputError(
                    f"processes of the study died {deaths} times in a row (out of memory? A "
                    'program that calls tb.study must do so below `if __name__ == "__main__":`); '
                    f"{KEPT}, perhaps with fewer jobs"
                ) from None
            waiting, taken = chain(list(taken.items()), waiting), {}
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)
