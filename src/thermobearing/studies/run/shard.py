"""Some runs of a study, one after the other, wherever they are carried out.

A shard is a slice of the plan. A process keeps what runs share between shards, so that another one
costs nothing to begin; it holds the results of one shard, however many there are.
"""

import hashlib
import pickle
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.studies.definition.record import Study
from thermobearing.studies.inputs.bearing_temperatures import Warm
from thermobearing.studies.run.demand_parameters import (
    BROKEN,
    RESULT_COLUMNS,
    Measured,
    error_outcome,
    measure_all,
    not_run,
)
from thermobearing.studies.run.prepare import Preparer, RunInput

BATCH = 256  # runs that are ready at a time, so that each finds others of its shape: inputs only
Stop = Callable[[], bool]


@dataclass(frozen=True)
class Kept:
    """Histories of one run, every so many steps of them, in single precision."""

    run: int
    id: str
    traces: Mapping[str, Any]


@dataclass(frozen=True)
class Done:
    """What came of a shard: the table of its runs, and histories that were asked for."""

    table: pd.DataFrame
    histories: tuple[Kept, ...] = ()


class BrokenError(Exception):
    """Every run of a shard raised what no run should: a fault of the program, or around it."""


def run_shard(study: Study, plan_rows: pd.DataFrame) -> pd.DataFrame:
    """The table of some runs: the columns of the plan, then `RESULT_COLUMNS`.

    Parameters
    ----------
    study : from `load_study`.
    plan_rows : of its plan.

    Returns
    -------
    DataFrame : one row a run, in the order of the plan; a run that fails has its outcome.

    Examples
    --------
    >>> from thermobearing.studies.definition.case import make_study
    >>> from thermobearing.studies.definition.designs import plan
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "2 s"}, "factors": factors}
    >>> study = make_study(table, "example")
    >>> run_shard(study, plan(study))["outcome"].tolist()
    ['completed']
    """
    preparer = Preparer(study)
    preparer.foresee(plan_rows)
    done = carried_out(preparer, plan_rows)
    assert done is not None
    return done.table


def carried_out(
    preparer: Preparer,
    plan_rows: pd.DataFrame,
    *,
    histories: bool = False,
    stop: Stop = lambda: False,
) -> Done | None:
    """A shard; None if `stop` said so before it was complete.

    Raises
    ------
    BrokenError : every run raised what no run should.
    """
    rows = plan_rows.to_dict("records")
    every = preparer.study.case.analysis.keep_every
    numbers: list[dict[str, Any]] = []
    kept: list[Kept] = []
    for first in range(0, len(rows), BATCH):
        batch = rows[first : first + BATCH]
        found = _batch(preparer, batch, every if histories else 0, stop)
        if len(found) < len(batch):
            return None
        numbers += [one.numbers for one in found]
        kept += [
            Kept(int(row["run"]), str(row["id"]), one.traces)
            for row, one in zip(batch, found, strict=True)
            if one.traces is not None
        ]
    if rows and all(one["outcome"] == BROKEN for one in numbers):
        raise BrokenError(numbers[0]["sentence"])
    return Done(_with_results(plan_rows, numbers), tuple(kept))


def _batch(
    preparer: Preparer, rows: list[dict[Any, Any]], every: int, stop: Stop
) -> list[Measured]:
    """What each row came to, as far as it went; one that raises has the reason as its outcome."""
    found: dict[int, Measured] = {}
    ready: dict[int, RunInput] = {}
    for number, row in enumerate(rows):
        try:
            ready[number] = preparer.run_input(row)
        except Exception as error:  # whatever breaks is told in its row: the others go on
            found[number] = Measured(not_run(*error_outcome(error)))
    done = _measured(list(ready.values()), every, stop, preparer.lockstep)
    found |= dict(zip(ready, done, strict=False))
    return [found[number] for number in sorted(found)] if len(found) == len(rows) else []


def _measured(inputs: list[RunInput], every: int, stop: Stop, lockstep: bool) -> list[Measured]:
    """Each run's numbers, and every so many steps of its histories (none: 0), until `stop`."""
    done: list[Measured] = []
    try:
        for found in measure_all(inputs, traces=every > 0, lockstep=lockstep):
            done.append(_thinned(found, every))
            if stop():
                break
    except Exception as error:  # likewise
        if len(inputs) == 1:
            return [Measured(not_run(*error_outcome(error)))]
        for one in inputs[len(done) :]:  # the others have nothing to do with it
            done += _measured([one], every, stop, lockstep)
    return done


def _thinned(found: Measured, every: int) -> Measured:
    """The same with histories as they are kept."""
    if found.traces is None:
        return found
    own = {
        name: np.ascontiguousarray(values[::every], dtype=np.float32)
        for name, values in found.traces.items()
    }
    return Measured(found.numbers, own)


def _with_results(plan_rows: pd.DataFrame, numbers: list[dict[str, Any]]) -> pd.DataFrame:
    """Rows of the plan with what came out beside them."""
    kinds = {"number": np.float64, "count": np.int64}
    columns: dict[str, Any] = {}
    for name, _, _, kind in RESULT_COLUMNS:
        values = [one[name] for one in numbers]
        columns[name] = np.array(values, dtype=kinds[kind]) if kind in kinds else values
    return pd.concat([plan_rows.reset_index(drop=True), pd.DataFrame(columns)], axis=1)


_OWN = threading.local()  # of a thread: those of a Dask worker share nothing that one may change


@dataclass(frozen=True)
class Work:
    """A shard that is to be carried out, and what was found for all of them at once.

    Attributes
    ----------
    number : of the shard.
    rows : of the plan.
    warm : what the weather made of the bearings of these rows; None of a study without.
    """

    number: int
    rows: pd.DataFrame
    warm: Warm | None = None


def packed(study: Study) -> bytes:
    """A study to be sent to other processes, without the weather, which they need not know."""
    ambient = study.factors.ambient.model_copy()
    ambient.keep_series(None)
    factors = study.factors.model_copy(update={"ambient": ambient})
    return pickle.dumps(study.model_copy(update={"factors": factors}))


def carry_out(study: bytes, work: Work, histories: bool, stop: Stop = lambda: False) -> Done | None:
    """`carried_out` in another process, which keeps its preparer between shards.

    Parameters
    ----------
    study : from `packed`.
    work : the shard.
    histories, stop : as there.
    """
    mark = hashlib.sha256(study).digest()
    if getattr(_OWN, "mark", None) != mark:
        _OWN.preparer, _OWN.mark = Preparer(pickle.loads(study)), mark
    _OWN.preparer.take(work.warm)
    return carried_out(_OWN.preparer, work.rows, histories=histories, stop=stop)
