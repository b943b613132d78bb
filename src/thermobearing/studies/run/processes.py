"""Worker processes: how they start and end, and calls of a function on them."""

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager
from itertools import chain
from multiprocessing import (
    connection,
    forkserver,
    get_all_start_methods,
    get_context,
    parent_process,
    resource_tracker,
)
from typing import Any, TypeVar

from thermobearing.border.errors import OutputError
from thermobearing.border.threads import one_blas_thread

PRELOADED = "thermobearing.studies.run.shard"  # module that processes import
KEPT = "completed shards are kept, run the same command again"
AHEAD = 2  # items that are submitted for each worker
PATIENCE = 3  # times in a row that processes may die without a result
S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")
_PROCESS: dict[str, Any] = {}  # of a process of a pool: event to stop, and shared data


def _set_up_process(stop: Any, shared: Any) -> None:
    """Set up a process of a pool; its parent handles Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _PROCESS.update(stop=stop, shared=shared)
    parent = parent_process()
    assert parent is not None
    # A parent that is killed sends no signal, and its processes would compute for nobody.
    threading.Thread(target=_end_with_parent, args=(parent.sentinel,), daemon=True).start()


def _end_with_parent(parent: Any) -> None:
    """End this process when its parent ends, also if that is killed."""
    connection.wait([parent])
    # `sys.exit` would end this thread only.
    os._exit(1)


def _call_with_shared(call: Callable[[Any, T], R], item: T) -> R:
    return call(_PROCESS["shared"], item)


def is_stopped() -> bool:
    """Return whether this is a process of a pool that should stop."""
    return "stop" in _PROCESS and bool(_PROCESS["stop"].is_set())


class StoppedError(Exception):
    """The result of this process is not needed any more."""


def raise_if_stopped(*_: Any) -> None:
    """Raise StoppedError if this process should stop; a progress callback of long calls."""
    if is_stopped():
        raise StoppedError


def _context() -> Any:
    """Return a fork server, since a fork while threads run may hang; spawning without one."""
    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload([PRELOADED])
    # The server imports for a second before it ignores Ctrl-C, which its parent handles. The
    # tracker starts first, since it unblocks signals.
    resource_tracker.ensure_running()
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
    return context


@contextmanager
def _handled(handler: Any, *numbers: int) -> Iterator[None]:
    """Handle signals otherwise for a time; only the main thread can, in others nothing changes."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, earlier in previous.items():
            signal.signal(number, signal.SIG_DFL if earlier is None else earlier)


def _exit(number: int, _: Any) -> None:
    raise SystemExit(128 + number)  # as a shell reports the signal


def ended_by_sigterm() -> AbstractContextManager[None]:
    """Exit on SIGTERM by an exception, so that processes end and their semaphores are removed."""
    return _handled(_exit, signal.SIGTERM)


def _submit(pool: ProcessPoolExecutor, call: Callable[[S, T], R], item: T) -> Future[R]:
    """Submit one item to a pool.

    Raises
    ------
    BrokenProcessPool
        If the pool is broken, or breaks while it starts a process for the item: the thread that
        manages the pool then closes the pipes which that process needs.
    """
    try:
        return pool.submit(_call_with_shared, call, item)
    except (OSError, EOFError) as error:
        raise BrokenProcessPool(str(error)) from error


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
    context, failures = _context(), 0
    pending: Iterator[tuple[int, T]] = enumerate(items)
    submitted: dict[int, T] = {}
    while True:
        stop = context.Event()
        pool = ProcessPoolExecutor(jobs, context, _set_up_process, (stop, shared))
        running: dict[Future[R], int] = {}
        try:
            while True:
                while len(running) < AHEAD * jobs and (entry := next(pending, None)) is not None:
                    number, item = entry
                    submitted[number] = item
                    running[_submit(pool, call, item)] = number
                if not running:
                    return
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    result, number = future.result(), running.pop(future)
                    # Only deaths without any result between them count: they are the fault of the
                    # items.
                    failures = 0
                    yield submitted.pop(number), result
        except BrokenProcessPool:
            failures += 1
            if failures >= PATIENCE:
                raise OutputError(
                    f"processes of the study died {failures} times in a row (out of memory? A "
                    'program that calls tb.study must do so below `if __name__ == "__main__":`); '
                    f"{KEPT}, perhaps with fewer jobs"
                ) from None
            # Which item killed its process is unknown: all that were submitted are computed again.
            pending, submitted = chain(list(submitted.items()), pending), {}
        finally:
            # A second Ctrl-C would leave the processes behind, for which Python waits at its end.
            with _handled(signal.SIG_IGN, signal.SIGINT, signal.SIGTERM):
                stop.set()
                pool.shutdown(cancel_futures=True)
