"""Some runs of a study, one after the other, wherever they are carried out.

A shard is a slice of the plan. A process keeps what runs share between shards, so that another one
costs nothing to begin; it holds the results of one shard, however many there are. Shards do not
depend on each other, and a shard that is lost with its process or its worker in a Dask cluster is
carried out again: only the process that began writes files.
"""

import hashlib
import pickle
import queue
import threading
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from thermobearing.border.errors import InputError, OutputError
from thermobearing.earthquake.run import Task
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.demand_parameters import (
    BROKEN,
    COUNTS,
    RESULT_COLUMNS,
    TEXTS,
    Measured,
    error_outcome,
    measure_all,
    not_run,
)
from thermobearing.studies.run.prepare import Preparer, Warm
from thermobearing.studies.run.processes import AHEAD, KEPT, is_stopped

BATCH = 256  # runs that are ready at a time, so that each finds others of its shape: inputs only


class Kept(NamedTuple):
    """Histories of one run, every so many steps of them, in single precision."""

    run: int
    id: str
    traces: Mapping[str, Any]


class Done(NamedTuple):
    """The table of the runs of a shard, and the histories that are kept."""

    table: pd.DataFrame
    histories: tuple[Kept, ...] = ()


class Work(NamedTuple):
    """Number and rows of a shard to be carried out; temperatures of its bearings in weather."""

    number: int
    rows: pd.DataFrame
    warm: Warm | None = None


class BrokenError(Exception):
    """Every run of a shard raised what no run should: a fault of the program, or around it."""


def run_shard(study: Study, plan_rows: pd.DataFrame) -> pd.DataFrame:
    """Return the columns of the plan of some runs, then `RESULT_COLUMNS`, a row each.

    A run that fails has its outcome.
    """
    preparer = Preparer(study)
    preparer.foresee(plan_rows)
    done = carried_out(preparer, plan_rows)
    assert done is not None
    return done.table


def carried_out(
    preparer: Preparer, plan_rows: pd.DataFrame, *, histories: bool = False
) -> Done | None:
    """Return the results of a shard; None if this process was stopped before it was complete."""
    rows = plan_rows.to_dict("records")
    every = preparer.study.case.analysis.keep_every if histories else 0
    found: list[Measured] = []
    for first in range(0, len(rows), BATCH):
        batch = rows[first : first + BATCH]
        found += _batch(preparer, batch, every)
        if len(found) < first + len(batch):
            return None
    if rows and all(one.numbers["outcome"] == BROKEN for one in found):
        raise BrokenError(found[0].numbers["sentence"])
    kept = tuple(
        Kept(int(row["run"]), str(row["id"]), one.traces)
        for row, one in zip(rows, found, strict=True)
        if one.traces is not None
    )
    columns: dict[str, Any] = {}
    for name in RESULT_COLUMNS:
        values = [one.numbers[name] for one in found]
        kind = np.int64 if name in COUNTS else np.float64
        columns[name] = values if name in TEXTS else np.array(values, dtype=kind)
    plain = plan_rows.reset_index(drop=True)
    return Done(pd.concat([plain, pd.DataFrame(columns)], axis=1), kept)


def _batch(preparer: Preparer, rows: list[dict[Any, Any]], every: int) -> list[Measured]:
    """Return the result of each row; of one that raises the reason. Fewer if stopped."""
    found: dict[int, Measured] = {}
    ready: dict[int, Task] = {}
    for number, row in enumerate(rows):
        try:
            ready[number] = preparer.make_task(row)
        except Exception as error:  # any fault is the outcome of its row: the others go on
            found[number] = Measured(not_run(*error_outcome(error)))
    done = _measured(list(ready.values()), every, preparer.lockstep)
    found |= dict(zip(ready, done, strict=False))
    return [found[number] for number in sorted(found)] if len(found) == len(rows) else []


def _measured(tasks: list[Task], every: int, lockstep: bool) -> list[Measured]:
    """Return each run's numbers and every so many steps of its histories (none: 0)."""
    done: list[Measured] = []
    try:
        for found in measure_all(tasks, traces=every > 0, lockstep=lockstep):
            if found.traces is not None:
                thin = {
                    name: np.ascontiguousarray(values[::every], dtype=np.float32)
                    for name, values in found.traces.items()
                }
                found = found._replace(traces=thin)
            done.append(found)
            if is_stopped():
                break
    except Exception as error:  # likewise
        if len(tasks) == 1:
            return [Measured(not_run(*error_outcome(error)))]
        for one in tasks[len(done) :]:  # the others do not depend on it
            done += _measured([one], every, lockstep)
    return done


_OWN = threading.local()  # of a thread: those of a Dask worker share nothing that one may change


def packed(study: Study) -> bytes:
    """Return a study to be sent to other processes, without the weather, which they do not need."""
    ambient = study.factors.ambient.model_copy()
    ambient.keep_series(None)
    factors = study.factors.model_copy(update={"ambient": ambient})
    return pickle.dumps(study.model_copy(update={"factors": factors}))


def carry_out(shared: tuple[bytes, bool], work: Work) -> Done | None:
    """Carry out a shard in a process, which keeps its preparer between shards.

    `shared` are the study, from `packed`, and whether histories are kept.
    """
    study, histories = shared
    mark = hashlib.sha256(study).digest()
    if getattr(_OWN, "mark", None) != mark:
        _OWN.preparer, _OWN.mark = Preparer(pickle.loads(study)), mark
    _OWN.preparer.take(work.warm)
    return carried_out(_OWN.preparer, work.rows, histories=histories)


EXTRA = 'needs distributed: pip install "thermobearing[cluster]"'
SCHEDULER_PATIENCE = 10.0  # for a scheduler that does not answer [s]
LOOK = 0.5  # between two looks whether it still answers [s]
FEWEST = 4  # shards on their way, so that workers that come later find some
LOST = ("cancelled", "lost")


def on_dask(
    shared: tuple[bytes, bool], works: Iterable[Work], address: Any
) -> Iterator[tuple[Work, Done | None]]:
    """Yield shards done by the workers of a cluster; one whose worker dies goes to another.

    `address` is that of the scheduler, "tcp://host:8786", or a `distributed.Client`.
    """
    with ExitStack() as stack:
        client = _client(address, stack)
        try:
            yield from _on_client(client, shared, iter(works))
        except (OSError, TimeoutError) as error:  # a connection that broke while it was used
            raise OutputError(f"the Dask cluster is gone ({error}); {KEPT}") from None


def _client(address: Any, stack: ExitStack) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise InputError(f"executor dask {EXTRA}") from None
    if isinstance(address, Client):
        return address
    if not address:
        raise InputError('executor dask: give its scheduler, as address "tcp://host:8786"')
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


def _on_client(
    client: Any, shared: tuple[bytes, bool], works: Iterator[Work]
) -> Iterator[tuple[Work, Done | None]]:
    """Yield shards as they are ready; every worker has `AHEAD` of them."""
    from distributed import KilledWorker

    running: dict[Any, Work] = {}
    ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
    # As a task, and not as data: a worker that dies with it takes nothing away.
    study = client.submit(tuple, shared, pure=False)

    def answers() -> bool:
        return bool(client.status == "running")

    def check() -> None:
        if not answers():
            raise OutputError(f"the Dask scheduler is gone ({client.status}); {KEPT}")

    def send(work: Work) -> None:
        check()
        future = client.submit(carry_out, study, work, pure=False)
        running[future] = work
        future.add_done_callback(ready.put)

    try:
        while True:
            threads = sum(client.nthreads().values()) if answers() else 0
            for work in islice(works, max(max(FEWEST, AHEAD * threads) - len(running), 0)):
                send(work)
            if not running:
                return
            future = None
            while future is None:
                try:
                    future = ready.get(timeout=LOOK)
                except queue.Empty:
                    check()
            work = running.pop(future)
            if future.status in LOST:
                send(work)
                continue
            try:
                done = future.result()
            except KilledWorker:
                raise OutputError(
                    "workers of the Dask cluster died again and again on the same runs (out of "
                    f"memory?); {KEPT}, with smaller shards or larger workers"
                ) from None
            yield work, done
    finally:
        if answers():
            client.cancel([*running, study])
