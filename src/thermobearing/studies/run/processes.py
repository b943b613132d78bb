"""Processes of this machine: how they begin and end, and a call on each of some things."""

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection, get_all_start_methods, get_context, parent_process
from typing import Any, TypeVar

from thermobearing.border.errors import OutputError
from thermobearing.border.threads import one_blas_thread

HERE = "thermobearing.studies.run.shard"  # what the work of a process is in
KEPT = "what is done is kept: start again to go on"
T = TypeVar("T")
R = TypeVar("R")
_OWN: dict[str, Any] = {}  # of a process of a pool: the event that says that nobody waits for it


def begin(stop: Any) -> None:
    """What a process of a pool does first; Ctrl-C is for the one that made it.

    Parameters
    ----------
    stop : event that is set when the work is to end.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _OWN["stop"] = stop
    parent = parent_process()
    assert parent is not None
    threading.Thread(target=_follow, args=(parent.sentinel,), daemon=True).start()


def _follow(parent: Any) -> None:
    """End with the process that made this one, even if that is killed and says nothing."""
    connection.wait([parent])
    os._exit(1)


def is_stopped() -> bool:
    """Whether this is a process of a pool whose work is to end."""
    return "stop" in _OWN and bool(_OWN["stop"].is_set())


class StoppedError(Exception):
    """Nobody waits for what this process makes."""


def go_on(*_: Any) -> None:
    """StoppedError where the work is to end; for the progress of long calls."""
    if is_stopped():
        raise StoppedError


def context_of_processes() -> Any:
    """How processes are begun: copies of one that has read the program, and does nothing else.

    A process that is forked while threads run may wait for ever; where there is no such server
    (Windows) each reads the program itself.
    """
    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    context = get_context("forkserver")
    context.set_forkserver_preload([HERE])
    return context


def each_on_processes(
    call: Callable[[T], R], items: Sequence[T], jobs: int
) -> Iterator[tuple[T, R]]:
    """What a call makes of each of some things, as it is ready; on one process here.

    Raises
    ------
    OutputError : processes die.
    """
    jobs = min(jobs, len(items))
    if jobs <= 1:
        yield from ((item, call(item)) for item in items)
        return
    one_blas_thread()
    context = context_of_processes()
    stop = context.Event()
    pool = ProcessPoolExecutor(jobs, context, begin, (stop,))
    try:
        running = {pool.submit(call, item): item for item in items}
        for future in as_completed(running):
            yield running[future], future.result()
    except BrokenProcessPool:
        raise OutputError(f"processes died while motions were made; {KEPT}") from None
    finally:
        stop.set()
        pool.shutdown(cancel_futures=True)
