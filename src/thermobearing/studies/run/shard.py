"""Runs of a study and their engineering demand parameters.

The definitions are those of an earthquake analysis (earthquake/measures.py), whose table has the
same columns; the register has their units and meanings. Histories are discarded after each run; in
lockstep there are none. `measure_all` runs the analyses for all executors.

A shard is a slice of the plan. A process keeps what runs share between shards. Shards are
independent, and a shard that is lost with its process or its worker in a Dask cluster is computed
again. Only the process that started the study writes files.
"""

import hashlib
import pickle
import queue
import threading
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import islice
from typing import Any, Final, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.cyclic.protocol import lengths
from thermobearing.earthquake import measures
from thermobearing.earthquake.run import Task, find_outcome, lines_to_shake, run_task
from thermobearing.laws import load_again, loaded_files
from thermobearing.model.outcomes import ALL_SENTENCES
from thermobearing.quantities.register import quantity
from thermobearing.results.base import COMPLETED
from thermobearing.structure.lanes import Run, RunPeaks, run_lanes
from thermobearing.structure.model import list_hinges
from thermobearing.structure.run import StructureHistory
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.prepare import Preparer, Warm
from thermobearing.studies.run.processes import AHEAD, KEPT, is_stopped

BAD_INPUT: Final = "bad_input"  # a drawn number that gives no valid bearing or structure
BROKEN: Final = "broken"  # an error of this program
TEXTS: Final = ("outcome", "sentence")
COUNTS: Final = ("steps", "iterations", "substeps")
OF_RUN: Final = {  # columns of an earthquake analysis: name of the measure
    name: quantity(name).variable
    for name in (
        *("bearing_displacement_max_mm", "bearing_strain_max", "bearing_force_max_kN"),
        *("bearing_energy_kN_mm", "bearing_heat_kN_mm", "pier_displacement_max_mm"),
        *("pier_displacement_residual_mm", "pier_rotation_max_rad", "pier_ductility"),
        *("pier_moment_max_kN_m", "pier_top_displacement_max_mm", "pier_top_acceleration_max_m_s2"),
        *("deck_displacement_max_mm", "deck_acceleration_max_m_s2", "layer_force_mismatch_max_kN"),
        *COUNTS,
    )
}
RESULT_COLUMNS: Final = (  # of the table of runs, after those of the plan
    *TEXTS,
    *OF_RUN,
    "bearing_displacement_residual_mm",
    "pier_drift_max",
    "deck_displacement_residual_mm",
    "rubber_max_degC",
    "lead_max_degC",
    "structure_residual",
    "mechanical_residual",
    "thermal_residual",
)
DECK: Final = -1  # last watch of a run in lockstep, after each pier and its top
DRIFTS: Final = "pier_part_displacement_max"


class Measured(NamedTuple):
    """One run: a value for each of `RESULT_COLUMNS`, and its histories if they are kept."""

    numbers: dict[str, Any]
    traces: Mapping[str, Any] | None = None


def _measure_all(
    tasks: Sequence[Task], *, every: int = 0, lockstep: bool = False
) -> Iterator[Measured]:
    """Run tasks; keep every n-th step of their histories (0: none). A failure is an outcome."""
    if lockstep and not every:
        for task, peaks in zip(tasks, run_lanes([_to_shake(task) for task in tasks]), strict=True):
            yield Measured(_numbers_of_peaks(task, peaks))
        return
    for task in tasks:
        history = run_task(task)
        traces = (
            measures.history_traces(task, history)
            if every
            else measures.structure_traces(task, history)
        )
        numbers = _numbers(task, history, traces)
        kept = {
            name: np.ascontiguousarray(values[::every], dtype=np.float32)
            for name, values in (traces if every else {}).items()
        }
        yield Measured(numbers, kept or None)


def _to_shake(task: Task) -> Run:
    """Return a run in lockstep that records the peaks of each pier, its top, and the deck."""
    piers, shaking = task.prepared.piers, task.shaking
    watched = [row for _, top, base in piers for row in (top - base, top)]
    return Run(
        task.prepared,
        lines_to_shake(task),
        shaking.ground,
        shaking.dt,
        task.ambient,
        places=np.array([*watched, task.prepared.deck]),
        carried=np.array([*[0.0, 1.0] * len(piers), 1.0]),  # the ground carries tops and deck
        method=task.case.analysis.method,
    )


def _numbers(task: Task, history: StructureHistory, traces: Mapping[str, Floats]) -> dict[str, Any]:
    lines, piers = measures.line_peaks(task, history), measures.pier_peaks(task, history)
    return _row(
        task,
        measures.compute_measures(task, history, traces, (lines, piers)),
        left=np.array([history.bearing(b)["displacement"][-1] for b in range(len(lines))]),
        tops=[row[DRIFTS] for row in piers],
        deck=traces["deck_displacement"][-1],
        rubber=(line["line_rubber_temperature_max"] for line in lines),
        lead=(line["line_lead_temperature_max"] for line in lines),
    )


def _numbers_of_peaks(task: Task, peaks: RunPeaks) -> dict[str, Any]:
    """Return a value for each of `RESULT_COLUMNS` from the peaks of a run in lockstep."""
    found = _measures_of_peaks(task, peaks)
    tops = peaks.watches["displacement"][:DECK:2].tolist()
    if peaks.outcome == COMPLETED:
        moved = [line["displacement"] for line in _named(peaks.lines)]
        found["outcome"] = find_outcome(task, moved, peaks.hinges["rotation"].tolist(), tops)
    each = list(zip(_named(peaks.lines), [one.device for one in task.lines], strict=True))
    return _row(
        task,
        found,
        left=peaks.bearings["displacement"],
        tops=tops,
        deck=measures.with_resultant(peaks.watches["residual"])[DECK],
        rubber=(peak["rubber_temperature"] for peak, one in each if one.stack is not None),
        lead=(peak["lead_temperature"] for peak, one in each if one.has_lead),
    )


def _overall(value: Any) -> Any:
    """Return a number, of a structure in plan the last of x, y and resultant."""
    return value[-1] if np.ndim(value) else value


def _named(rows: Any) -> list[dict[str, float]]:
    """Return records as dictionaries, whose fields are read faster than those of numpy."""
    found = [dict(zip(rows.dtype.names, row, strict=True)) for row in rows.tolist()]
    for name in rows.dtype.names:
        if rows.dtype[name].shape:  # in plan: the resultant
            sizes = rows[name][:, -1] if rows[name].shape[1] > 2 else lengths(rows[name])
            for row, size in zip(found, sizes.tolist(), strict=True):
                row[name] = size
    return found


def _measures_of_peaks(task: Task, peaks: RunPeaks) -> dict[str, Any]:
    """Return the measures of `compute_measures` from peaks; the bearings begin at rest."""
    bearings, lines = _named(peaks.bearings), _named(peaks.lines)
    bearing, books = bearings[task.reported_line], _named(peaks.books)[0]
    *piers, deck = _named(peaks.watches)
    of_lines = [
        {
            "line_displacement_max": peak["displacement"],
            "line_strain_max": peak["displacement"] / one.device.bearing.total_rubber_thickness,
            "line_force_max": peak["force"],
            "line_energy_end": end["work_in"],
        }
        for peak, end, one in zip(lines, bearings, task.lines, strict=True)
    ]
    of_piers = [
        {
            "pier_part_displacement_max": piers[2 * k]["displacement"],
            "pier_part_displacement_residual": piers[2 * k]["residual"],
            "pier_part_top_displacement_max": piers[2 * k + 1]["displacement"],
            "pier_part_top_acceleration_max": piers[2 * k + 1]["acceleration"] / measures.MM_PER_M,
            **_hinge_peaks(task, peaks, pier.hinges),
        }
        for k, (pier, _, _) in enumerate(task.prepared.piers)
    ]
    return {
        "outcome": peaks.outcome,
        **measures.governing_peaks(of_lines),
        **measures.governing_peaks(of_piers),
        "deck_displacement_max": deck["displacement"],
        "deck_acceleration_max": deck["acceleration"] / measures.MM_PER_M,
        "layer_force_mismatch_max": lines[task.reported_line]["mismatch"],
        **{name: getattr(peaks, name) for name in COUNTS},
        **{f"energy_{name}": books[name] for name in measures.STRUCTURE_ENERGIES},
        **{f"heat_{name}": bearing[name] for name in measures.BEARING},
    }


def _hinge_peaks(task: Task, peaks: RunPeaks, hinges: Sequence[int | None]) -> dict[str, float]:
    """Return the peaks of a pier's hinge, in plan the larger of both directions."""
    each = []
    for hinge in hinges:
        rotation = moment = limit = np.nan
        if hinge is not None:
            found = _named(peaks.hinges)[hinge]
            limit = list_hinges(task.case.structure)[hinge].yield_rotation
            rotation, moment = found["rotation"], found["moment"] / measures.KN_MM_PER_KN_M
        each.append((rotation, rotation / limit, moment))
    names = ("pier_part_rotation_max", "pier_part_ductility", "pier_part_moment_max")
    largest = each[0] if len(each) == 1 else np.fmax.reduce(each).tolist()
    return dict(zip(names, largest, strict=True))


def _row(
    task: Task,
    found: Mapping[str, Any],
    *,
    left: Floats,
    tops: Sequence[Any],
    deck: Any,
    rubber: Iterable[float],
    lead: Iterable[float],
) -> dict[str, Any]:
    """Return all columns, from the measures of a run and those that only a study has."""
    ended = found["outcome"]
    return {
        "outcome": ended,
        "sentence": "" if ended == COMPLETED else ALL_SENTENCES.get(ended, ""),
        **{name: _overall(found[key]) for name, key in OF_RUN.items()},
        "bearing_displacement_residual_mm": float(
            measures.farthest(left if left.ndim == 1 else lengths(left))
        ),
        "pier_drift_max": measures.drift(task, tops),
        "deck_displacement_residual_mm": _overall(deck),
        "rubber_max_degC": _hottest(rubber),
        "lead_max_degC": _hottest(lead),
        **measures.compute_residuals(found),
    }


def _hottest(values: Iterable[float]) -> float:
    return max((float(value) for value in values if value == value), default=np.nan)


def _not_run(error: Exception) -> Measured:
    """Return the outcome of a run that raised an error; its numbers are missing."""
    outcome, sentence = BROKEN, f"error of the program: {type(error).__name__}: {error}"
    if isinstance(error, InputError):
        outcome, sentence = BAD_INPUT, " ".join(str(error).split())
    found = {name: 0 if name in COUNTS else np.nan for name in RESULT_COLUMNS}
    return Measured(found | {"outcome": outcome, "sentence": sentence})


BATCH = 256  # runs that are prepared at a time, to fill the lanes in lockstep


class Kept(NamedTuple):
    """Decimated histories of one run, in single precision."""

    run: int
    id: str
    traces: Mapping[str, Any]


class Done(NamedTuple):
    """The table of the runs of a shard, and their histories."""

    table: "pd.DataFrame"
    histories: tuple[Kept, ...] = ()


class Work(NamedTuple):
    """Number and rows of a shard, and the temperatures of its bearings in weather."""

    number: int
    rows: "pd.DataFrame"
    warm: Warm | None = None


class BrokenError(Exception):
    """All runs of a shard raised an error: a fault of the program or its environment."""


def run_shard(study: Study, plan_rows: "pd.DataFrame") -> "pd.DataFrame":
    """Return the columns of the plan of some runs, and `RESULT_COLUMNS`."""
    preparer = Preparer(study)
    preparer.foresee(plan_rows)
    done = compute_shard(preparer, plan_rows)
    assert done is not None
    return done.table


def compute_shard(
    preparer: Preparer, plan_rows: "pd.DataFrame", *, histories: bool = False
) -> Done | None:
    """Return the results of a shard; None if this process was stopped."""
    rows: list[dict[Any, Any]] = plan_rows.to_dict("records")
    every = preparer.study.case.analysis.keep_every if histories else 0
    done: dict[int, Measured] = {}
    for first in range(0, len(rows), BATCH):
        ready: dict[int, Task] = {}
        for number, row in enumerate(rows[first : first + BATCH], first):
            try:
                ready[number] = preparer.make_task(row)
            except Exception as error:  # the outcome of this row; the others continue
                done[number] = _not_run(error)
        measured = _measured(list(ready.values()), every, preparer.lockstep)
        if len(measured) < len(ready):
            return None
        done |= zip(ready, measured, strict=True)
    found = [done[number] for number in range(len(rows))]
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


def _measured(tasks: list[Task], every: int, lockstep: bool) -> list[Measured]:
    """Return the result or the error of each task; fewer if this process was stopped."""
    done: list[Measured] = []
    try:
        for found in _measure_all(tasks, every=every, lockstep=lockstep):
            done.append(found)
            if is_stopped():
                break
    except Exception as error:  # likewise
        if len(tasks) == 1:
            return [_not_run(error)]
        for one in tasks[len(done) :]:  # one by one, to find the run that raises
            done += _measured([one], every, lockstep)
    return done


_OWN = threading.local()  # threads of a Dask worker share no state


def packed(study: Study) -> bytes:
    """Return a study and the files of its laws as bytes for other processes, without weather."""
    ambient = study.factors.ambient.model_copy()
    ambient._series = None
    factors = study.factors.model_copy(update={"ambient": ambient})
    return pickle.dumps((study.model_copy(update={"factors": factors}), loaded_files()))


def compute_shard_in_process(shared: tuple[bytes, bool], work: Work) -> Done | None:
    """Compute a shard; `shared` is a study from `packed`, and whether histories are kept."""
    study, histories = shared
    mark = hashlib.sha256(study).digest()
    if getattr(_OWN, "mark", None) != mark:
        unpacked, files = pickle.loads(study)
        load_again(files)
        _OWN.preparer, _OWN.mark = Preparer(unpacked), mark
    _OWN.preparer.take(work.warm)
    return compute_shard(_OWN.preparer, work.rows, histories=histories)


EXTRA = 'needs distributed: pip install "thermobearing[cluster]"'
SCHEDULER_PATIENCE = 10.0  # timeout of the scheduler [s]
LOOK = 0.5  # interval of checks of the scheduler [s]
FEWEST = 4  # shards that are submitted, for workers that start later
LOST = ("cancelled", "lost")


def on_dask(
    shared: tuple[bytes, bool], works: Iterable[Work], address: Any
) -> Generator[tuple[Work, Done | None]]:
    """Yield shards that a cluster computes; those of a dead worker are repeated."""
    with ExitStack() as stack:
        client = _client(address, stack)
        try:
            yield from _on_client(client, shared, iter(works))
        except (OSError, TimeoutError) as error:  # a lost connection
            raise OutputError(
                f"the connection to the Dask cluster was lost ({error}); {KEPT}"
            ) from None


def _client(address: Any, stack: ExitStack) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise InputError(f"executor dask {EXTRA}") from None
    if isinstance(address, Client):
        return address
    if not address:
        raise InputError(
            'executor dask: the address of its scheduler is missing, such as "tcp://host:8786"'
        )
    try:
        make: Any = Client
        client = make(str(address), timeout=SCHEDULER_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f'address "{address}": no Dask scheduler answers there ({type(error).__name__}); check '
            "that it is running and can be reached"
        ) from None
    stack.callback(client.close)
    return client


def _on_client(
    client: Any, shared: tuple[bytes, bool], works: Iterator[Work]
) -> Generator[tuple[Work, Done | None]]:
    """Yield shards when they are ready; `AHEAD` are submitted for each thread."""
    from distributed import KilledWorker

    running: dict[Any, Work] = {}
    ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
    # As a task and not as data, which would be lost with its worker.
    study = client.submit(tuple, shared, pure=False)

    def _answers() -> bool:
        return bool(client.status == "running")

    def _check() -> None:
        if not _answers():
            raise OutputError(f"the Dask scheduler has stopped ({client.status}); {KEPT}")

    def _send(work: Work) -> None:
        _check()
        future = client.submit(compute_shard_in_process, study, work, pure=False)
        running[future] = work
        future.add_done_callback(ready.put)

    try:
        while True:
            threads = sum(client.nthreads().values()) if _answers() else 0
            for work in islice(works, max(max(FEWEST, AHEAD * threads) - len(running), 0)):
                _send(work)
            if not running:
                return
            future = None
            while future is None:
                try:
                    future = ready.get(timeout=LOOK)
                except queue.Empty:
                    _check()
            work = running.pop(future)
            if future.status in LOST:
                _send(work)
                continue
            try:
                done = future.result()
            except KilledWorker:
                raise OutputError(
                    "workers of the Dask cluster died repeatedly on the same runs (out of "
                    f"memory?); {KEPT}, with smaller shards or larger workers"
                ) from None
            yield work, done
    finally:
        if _answers():
            client.cancel([*running, study])
