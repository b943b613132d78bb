"""Shards on a Dask cluster, the user's own: by the address of its scheduler, or a client of it."""

import queue
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from typing import Any

from thermobearing.border.errors import InputError, OutputError
from thermobearing.studies.executors import AHEAD, Finished
from thermobearing.studies.processes import KEPT
from thermobearing.studies.shard import Work, carry_out

EXTRA = 'needs distributed: pip install "thermobearing[cluster]"'
PATIENCE = 10.0  # for a scheduler that does not answer [s]
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
        client = make(str(address), timeout=PATIENCE, set_as_default=False)
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
