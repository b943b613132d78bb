"""Estimate the time and size of a study before it starts."""

import os
import time
from dataclasses import dataclass

import numpy as np

from thermobearing.studies.definition.columns import list_columns
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.definition.record import Study
from thermobearing.studies.inputs.motions import tried
from thermobearing.studies.run.demand_parameters import COMPLETED, RESULT_COLUMNS
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import carried_out

TRIED = 16  # runs that are measured
NUMBER, HISTORY = 8, 4  # bytes of a number in a table and in a history; neither is compressed well


@dataclass(frozen=True)
class Forecast:
    """What a study will cost.

    Attributes
    ----------
    runs : number of them.
    seconds : of one run in one process.
    jobs : processes that were counted with.
    table_bytes, history_bytes : on the disk, at most.
    failed : of the runs that were tried, those that did not get through.
    tried : how many were.
    motions : to be made first, to fit a spectrum.
    motion_seconds : of one of them in one process.
    """

    runs: int
    seconds: float
    jobs: int
    table_bytes: float
    history_bytes: float
    failed: int
    tried: int
    motions: int = 0
    motion_seconds: float = 0.0

    @property
    def whole_seconds(self) -> float:
        """For all runs, on as many processes."""
        making = self.motions * self.motion_seconds / min(self.jobs, max(self.motions, 1))
        return making + self.runs * self.seconds / min(self.jobs, self.runs)


def forecast(study: Study, jobs: int | None = None) -> Forecast:
    """Carry out a few runs of a study and count the rest.

    Parameters
    ----------
    study : from `load_study`.
    jobs : processes; as many as there are cores by default.

    Returns
    -------
    Forecast

    Raises
    ------
    InputError : what `plan` refuses.

    Examples
    --------
    >>> from thermobearing.studies.definition.case import make_study
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "1 s"}, "factors": factors}
    >>> forecast(make_study(table, "example")).runs
    1
    """
    study, motions, making = tried(study)
    runs = plan(study)
    some = runs.iloc[np.unique(np.linspace(0, len(runs) - 1, TRIED).astype(int))]
    preparer = Preparer(study)
    preparer.foresee(some)
    kept = study.keep.histories
    carried_out(preparer, some.head(1))  # compiled, and shared things made
    begin = time.perf_counter()
    done = carried_out(preparer, some, histories=kept != "none")
    took = (time.perf_counter() - begin) / len(some)
    assert done is not None
    each = [
        sum(values.size for values in history.traces.values()) * HISTORY
        for history in done.histories
    ]
    count = len(runs) if kept == "all" else study.keep.worst
    columns = len(list_columns(study)) + len(RESULT_COLUMNS) + 4
    return Forecast(
        runs=len(runs),
        seconds=took,
        jobs=jobs or os.cpu_count() or 1,
        table_bytes=float(len(runs) * columns * NUMBER),
        history_bytes=float(min(count, len(runs)) * (np.mean(each) if each else 0.0)),
        failed=int((done.table["outcome"] != COMPLETED).sum()),
        tried=len(some),
        motions=motions,
        motion_seconds=making,
    )
