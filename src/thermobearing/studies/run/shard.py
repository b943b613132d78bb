"""Runs of a study and their engineering demand parameters.

The definitions are those of an earthquake analysis (earthquake/measures.py), whose table has the
same columns; the register has their units and meanings. Histories are discarded after each run; in
lockstep there are none. `measure_all` runs the analyses for all executors.

A shard is a slice of the plan. A process keeps what runs share between shards. Shards are
independent, and a shard that is lost with its process or its worker in a Dask cluster is computed
again. Only the process that started the study writes files.
"""

import copy
import hashlib
import pickle
import queue
import threading
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import islice
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np

from thermobearing.bearing.model import Tested, calibration_ranges
from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.cyclic.protocol import lengths
from thermobearing.earthquake import measures
from thermobearing.earthquake.axial import AXIAL_COLUMNS, run_extremes, with_axial_outcome
from thermobearing.earthquake.measures import loading_speed
from thermobearing.earthquake.run import (
    STRAIN_LIMIT,
    Task,
    ended_unstable,
    largest_rotations,
    lines_to_shake,
    outcome_by_limits,
    passed_limits,
    run_task,
)
from thermobearing.laws import load_again, loaded_files
from thermobearing.model.outcomes import ALL_SENTENCES, AXIAL_SENTENCES, MELTED, UNSTABLE
from thermobearing.quantities.register import quantity
from thermobearing.results.base import COMPLETED
from thermobearing.results.metrics import BALANCE
from thermobearing.results.ranges import (
    OUTSIDE,
    Ends,
    compare_with_tests,
    farthest,
    reached_by_peaks,
)
from thermobearing.structure.lanes import Run, RunPeaks, run_lanes
from thermobearing.structure.model import list_hinges
from thermobearing.structure.run import StructureHistory
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.prepare import BearingTemperatures, Preparer
from thermobearing.studies.run.processes import AHEAD, KEPT, is_stopped

BAD_INPUT: Final = "bad_input"  # a drawn number that gives no valid bearing or structure
BROKEN: Final = "broken"  # an error of this program
BEYOND_TESTED: Final = "beyond_tested"
DAMPING: Final = "damping_of_input"
LIMITS_PASSED: Final = "limits_passed"
LEAD_LIMIT: Final = "lead_temperature"
TEXTS: Final = ("outcome", "sentence", BEYOND_TESTED, LIMITS_PASSED)
COUNTS: Final = ("steps", "iterations", "substeps")
OF_RUN: Final = {  # columns of an earthquake analysis: name of the measure
    name: quantity(name).variable
    for name in (
        "bearing_displacement_max_mm",
        "bearing_strain_max",
        "bearing_force_max_kN",
        "bearing_energy_kN_mm",
        "bearing_heat_kN_mm",
        "pier_displacement_max_mm",
        "pier_displacement_residual_mm",
        "pier_rotation_max_rad",
        "pier_ductility",
        "pier_moment_max_kN_m",
        "pier_top_displacement_max_mm",
        "pier_top_acceleration_max_m_s2",
        "deck_displacement_max_mm",
        "deck_acceleration_max_m_s2",
        "layer_force_mismatch_max_kN",
        *COUNTS,
    )
}
RESULT_COLUMNS: Final = (  # of the table of runs, after those of the plan
    "outcome",
    "sentence",
    *OF_RUN,
    "bearing_displacement_residual_mm",
    "pier_drift_max",
    "deck_displacement_residual_mm",
    "rubber_max_degC",
    "lead_max_degC",
    LIMITS_PASSED,
    BEYOND_TESTED,
    DAMPING,
    "structure_residual",
    "mechanical_residual",
    "thermal_residual",
)
DECK: Final = -1  # last watch of a run in lockstep, after each pier and its top
DRIFTS: Final = "pier_part_displacement_max"


# Of a bearing line: largest displacement [mm] and speed [mm/s], ends of the lead [degC].
Extent: TypeAlias = tuple[float, float, Ends | None]
# Displacements to watch, and which of them the ground carries, as `Run` has them.
Watches: TypeAlias = tuple[Floats, Floats]
SENTENCES_BY_OUTCOME = ALL_SENTENCES | AXIAL_SENTENCES


class Measured(NamedTuple):
    """One run: a value for each of `RESULT_COLUMNS`, and its histories if they are kept."""

    numbers: dict[str, Any]
    traces: Mapping[str, Any] | None = None


def _measure_all(
    tasks: Sequence[Task], *, keep_every: int = 0, lockstep: bool = False
) -> Iterator[Measured]:
    """Run tasks; keep every n-th step of their histories (0: none). A failure is an outcome."""
    if lockstep and not keep_every:
        watches: dict[int, Watches] = {}
        runs = [_to_shake(task, watches) for task in tasks]
        for task, peaks in zip(tasks, run_lanes(runs), strict=True):
            yield Measured(_numbers_of_peaks(task, peaks))
        return
    for task in tasks:
        history = run_task(task)
        traces = (
            measures.history_traces(task, history)
            if keep_every
            else measures.structure_traces(task, history)
        )
        numbers = _numbers(task, history, traces)
        kept = {
            name: np.ascontiguousarray(values[::keep_every], dtype=np.float32)
            for name, values in (traces if keep_every else {}).items()
        }
        yield Measured(numbers, kept or None)


def _to_shake(task: Task, watches: dict[int, Watches]) -> Run:
    """Return a run in lockstep that records the peaks of each pier, its top, and the deck.

    `watches` keeps these displacements by the address of a structure, for its other runs.
    """
    prepared, shaking = task.prepared, task.shaking
    if id(prepared) not in watches:
        watched = [row for _, top, base in prepared.piers for row in (top - base, top)]
        carried = [*[0.0, 1.0] * len(prepared.piers), 1.0]  # the ground carries tops and deck
        watches[id(prepared)] = np.array([*watched, prepared.deck]), np.array(carried)
    places, carried_by_ground = watches[id(prepared)]
    return Run(
        prepared,
        lines_to_shake(task),
        shaking.ground,
        shaking.dt,
        task.ambient,
        places=places,
        carried=carried_by_ground,
        method=task.case.analysis.method,
        vertical=shaking.vertical,
    )


def _numbers(task: Task, history: StructureHistory, traces: Mapping[str, Floats]) -> dict[str, Any]:
    lines, piers = measures.line_peaks(task, history), measures.pier_peaks(task, history)
    end_displacements = [history.bearing(line)["displacement"][-1] for line in range(len(lines))]
    extents = [_extent(history.bearing(line), task, line) for line in range(len(lines))]
    tops = [row[DRIFTS] for row in piers]
    row = _row(
        task,
        measures.compute_measures(task, history, traces, (lines, piers)),
        end_displacements=np.array(end_displacements),
        limits=passed_limits(task, [line[0] for line in extents], largest_rotations(history), tops),
        tops=tops,
        deck=traces["deck_displacement"][-1],
        rubber=(line["line_rubber_temperature_max"] for line in lines),
        lead=(line["line_lead_temperature_max"] for line in lines),
        extents=extents,
    )
    return row | run_extremes(history.axial)


def _numbers_of_peaks(task: Task, peaks: RunPeaks) -> dict[str, Any]:
    """Return a value for each of `RESULT_COLUMNS` from the peaks of a run in lockstep."""
    devices = [line.device for line in task.lines]
    named_lines, rotations = _named(peaks.lines), peaks.hinges["rotation"].tolist()
    measured = _measures_of_peaks(task, peaks, named_lines)
    # The watches are those of `_to_shake`: each pier relative to its base, its top, then the deck.
    tops = peaks.watches["displacement"][:DECK:2].tolist()
    limits = passed_limits(task, [line["displacement"] for line in named_lines], rotations, tops)
    if ended_unstable(peaks.outcome, peaks.axial):
        measured["outcome"] = UNSTABLE
    elif peaks.outcome == COMPLETED:
        measured["outcome"] = with_axial_outcome(outcome_by_limits(limits), peaks.axial)
    line_peaks = list(zip(named_lines, devices, strict=True))
    row = _row(
        task,
        measured,
        end_displacements=peaks.bearings["displacement"],
        limits=limits,
        tops=tops,
        deck=measures.with_resultant(peaks.watches["residual"])[DECK],
        rubber=(
            peak["rubber_temperature"] for peak, device in line_peaks if device.stack is not None
        ),
        lead=(peak["lead_temperature"] for peak, device in line_peaks if device.has_lead),
        extents=[
            (
                peak["displacement"],
                peak["speed"],
                (peak["coldest_lead"], peak["lead_temperature"]) if device.has_lead else None,
            )
            for peak, device in line_peaks
        ],
    )
    return row | run_extremes(peaks.axial)


def _extent(rows: Any, task: Task, line: int) -> Extent:
    """Return the peaks of a line that its tested range is compared with, from its histories."""
    displacement, speed = (
        float(lengths(values).max()) for values in (rows["displacement"], loading_speed(rows))
    )
    lead = rows["lead_temperature"]
    ends = (float(lead.min()), float(lead.max())) if task.lines[line].device.has_lead else None
    return displacement, speed, ends


def _beyond_tested(task: Task, extents: Sequence[Extent]) -> str:
    """Return the limits of calibration ranges that a run passes with any of its bearings.

    As `bridge` names them, without `cycles`, which need a history.
    """
    # The bearing of the run is the first, as in the table of `bridge`.
    by_bearing: dict[str, tuple[Tested, list[Any]]] = {
        task.device.bearing.name: (task.device.bearing, [])
    }
    for (displacement, speed, lead), installed in zip(extents, task.lines, strict=True):
        on_line = installed.device.bearing
        reached = reached_by_peaks(
            displacement,
            speed,
            rubber=on_line.total_rubber_thickness,
            ambient=(installed.ambient, installed.ambient),
            lead=lead,
        )
        by_bearing.setdefault(on_line.name, (on_line, []))[1].append(reached)
    rows = []
    for name, (bearing, values) in by_bearing.items():
        ranges = calibration_ranges(bearing)
        rows += compare_with_tests(name, farthest(values), ranges)
    return " ".join(dict.fromkeys(row["limit"] for row in rows if row[OUTSIDE]))


def _overall(value: Any) -> Any:
    """Return a number, of a structure in plan the last of x, y and resultant."""
    return value[-1] if isinstance(value, (np.ndarray, list)) and np.ndim(value) else value


def _named(records: Any) -> list[dict[str, float]]:
    """Return records as dictionaries, whose fields are read faster than those of numpy."""
    dictionaries = [dict(zip(records.dtype.names, row, strict=True)) for row in records.tolist()]
    for name in records.dtype.names:
        if records.dtype[name].shape:  # in plan: the resultant
            sizes = records[name][:, -1] if records[name].shape[1] > 2 else lengths(records[name])
            for row, size in zip(dictionaries, sizes.tolist(), strict=True):
                row[name] = size
    return dictionaries


def _measures_of_peaks(
    task: Task, peaks: RunPeaks, lines: Sequence[Mapping[str, float]]
) -> dict[str, Any]:
    """Return the measures of `compute_measures` from peaks; the bearings begin at rest."""
    bearings = _named(peaks.bearings)
    bearing, energies = bearings[task.reported_line], _named(peaks.energies)[0]
    *piers, deck = _named(peaks.watches)
    present = [
        *measures.STRUCTURE_ENERGIES,
        *measures.device_energies(task.case.structure),
    ]
    line_measures = [
        {
            "line_displacement_max": peak["displacement"],
            "line_strain_max": peak["displacement"] / line.device.bearing.total_rubber_thickness,
            "line_force_max": peak["force"],
            "line_energy_end": end["work_in"],
        }
        for peak, end, line in zip(lines, bearings, task.lines, strict=True)
    ]
    pier_measures = [
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
        **measures.governing_peaks(line_measures),
        **measures.governing_peaks(pier_measures),
        "deck_displacement_max": deck["displacement"],
        "deck_acceleration_max": deck["acceleration"] / measures.MM_PER_M,
        "layer_force_mismatch_max": lines[task.reported_line]["mismatch"],
        **{name: getattr(peaks, name) for name in COUNTS},
        **{f"energy_{name}": energies[name] for name in present},
        **{f"heat_{name}": bearing[name] for name in BALANCE},
    }


def _hinge_peaks(task: Task, peaks: RunPeaks, hinges: Sequence[int | None]) -> dict[str, float]:
    """Return the peaks of a pier's hinge, in plan the larger of both directions."""
    directions = []
    for hinge in hinges:
        rotation = moment = limit = np.nan
        if hinge is not None:
            peak = _named(peaks.hinges)[hinge]
            limit = list_hinges(task.case.structure)[hinge].yield_rotation
            rotation, moment = peak["rotation"], peak["moment"] / measures.KN_MM_PER_KN_M
        directions.append((rotation, rotation / limit, moment))
    names = ("pier_part_rotation_max", "pier_part_ductility", "pier_part_moment_max")
    largest = directions[0] if len(directions) == 1 else np.fmax.reduce(directions).tolist()
    return dict(zip(names, largest, strict=True))


def _row(
    task: Task,
    measured: Mapping[str, Any],
    *,
    end_displacements: Floats,
    limits: list[str],
    tops: Sequence[Any],
    deck: Any,
    rubber: Iterable[float],
    lead: Iterable[float],
    extents: Sequence[Extent],
) -> dict[str, Any]:
    """Return all columns, from the measures of a run and those that only a study has."""
    outcome = measured["outcome"]
    # In the order of time as far as peaks show it: a run ends where its lead melts.
    if outcome == MELTED:
        limits.insert(int(STRAIN_LIMIT in limits), LEAD_LIMIT)
    if end_displacements.ndim > 1:  # in plan
        end_displacements = lengths(end_displacements)
    return {
        "outcome": outcome,
        "sentence": "" if outcome == COMPLETED else SENTENCES_BY_OUTCOME.get(outcome, ""),
        **{name: _overall(measured[key]) for name, key in OF_RUN.items()},
        "bearing_displacement_residual_mm": float(measures.signed_peak(end_displacements)),
        "pier_drift_max": measures.drift(task, tops),
        "deck_displacement_residual_mm": _overall(deck),
        "rubber_max_degC": _hottest(rubber),
        "lead_max_degC": _hottest(lead),
        LIMITS_PASSED: " ".join(limits),
        BEYOND_TESTED: _beyond_tested(task, extents),
        DAMPING: float(
            measures.damping_share(measured["energy_damping"], measured["energy_input"])
        ),
        **measures.compute_residuals(measured),
    }


def _hottest(values: Iterable[float]) -> float:
    # A bilinear bearing has no temperature, which is NaN.
    return max((float(value) for value in values if value == value), default=np.nan)


def _not_run(error: Exception) -> Measured:
    """Return the outcome of a run that raised an error; its numbers are missing."""
    outcome, sentence = BROKEN, f"error of the program: {type(error).__name__}: {error}"
    if isinstance(error, InputError):
        outcome, sentence = BAD_INPUT, " ".join(str(error).split())
    numbers = {name: 0 if name in COUNTS else np.nan for name in (*RESULT_COLUMNS, *AXIAL_COLUMNS)}
    texts = {"outcome": outcome, "sentence": sentence, BEYOND_TESTED: "", LIMITS_PASSED: ""}
    return Measured(numbers | texts)


BATCH = 512  # runs that are prepared at a time, to fill the lanes in lockstep


class KeptHistory(NamedTuple):
    """Decimated histories of one run, in single precision."""

    run: int
    id: str
    traces: Mapping[str, Any]


class ShardResult(NamedTuple):
    """The table of the runs of a shard, and their histories."""

    table: "pd.DataFrame"
    histories: tuple[KeptHistory, ...] = ()


class Work(NamedTuple):
    """Number and rows of a shard, and the temperatures of its bearings in weather."""

    number: int
    rows: "pd.DataFrame"
    temperatures: BearingTemperatures | None = None


class BrokenError(Exception):
    """All runs of a shard raised an error: a fault of the program or its environment."""


def run_shard(plan: Plan, plan_rows: "pd.DataFrame") -> "pd.DataFrame":
    """Return the columns of the plan of some runs, and `RESULT_COLUMNS`."""
    preparer = Preparer(plan)
    preparer.compute_temperatures(plan_rows)
    shard = compute_shard(preparer, plan_rows)
    assert shard is not None
    return shard.table


def compute_shard(
    preparer: Preparer, plan_rows: "pd.DataFrame", *, histories: bool = False
) -> ShardResult | None:
    """Return the results of a shard; None if this process was stopped."""
    rows: list[dict[Any, Any]] = plan_rows.to_dict("records")
    keep_every = preparer.study.case.analysis.keep_every if histories else 0
    results: dict[int, Measured] = {}
    # A prepared run holds the matrices of its structure and the states of its bearings: memory must
    # not grow with the size of a shard.
    for first in range(0, len(rows), BATCH):
        tasks: dict[int, Task] = {}
        for number, row in enumerate(rows[first : first + BATCH], first):
            try:
                tasks[number] = preparer.make_task(row)
            except Exception as error:  # the outcome of this row; the others continue
                results[number] = _not_run(error)
        measured = _measured(list(tasks.values()), keep_every, preparer.lockstep)
        if len(measured) < len(tasks):
            return None
        results |= zip(tasks, measured, strict=True)
    runs = [results[number] for number in range(len(rows))]
    # One broken run is an outcome; if none of a shard runs, the next one will not either, and hours
    # of computing would end in an empty table.
    if rows and all(run.numbers["outcome"] == BROKEN for run in runs):
        raise BrokenError(runs[0].numbers["sentence"])
    kept = tuple(
        KeptHistory(int(row["run"]), str(row["id"]), run.traces)
        for row, run in zip(rows, runs, strict=True)
        if run.traces is not None
    )
    columns: dict[str, Any] = {}
    acts = preparer.study.case.analysis.has_axial
    for name in (*RESULT_COLUMNS, *(AXIAL_COLUMNS if acts else ())):
        values = [run.numbers[name] for run in runs]
        kind = np.int64 if name in COUNTS else np.float64
        columns[name] = values if name in TEXTS else np.array(values, dtype=kind)
    plan_columns = plan_rows.reset_index(drop=True)
    return ShardResult(pd.concat([plan_columns, pd.DataFrame(columns)], axis=1), kept)


def _measured(tasks: list[Task], keep_every: int, lockstep: bool) -> list[Measured]:
    """Return the result or the error of each task; fewer if this process was stopped."""
    results: list[Measured] = []
    try:
        for result in _measure_all(tasks, keep_every=keep_every, lockstep=lockstep):
            results.append(result)
            if is_stopped():
                break
    except Exception as error:  # likewise
        if len(tasks) == 1:
            return [_not_run(error)]
        for task in tasks[len(results) :]:  # one by one, to find the run that raises
            results += _measured([task], keep_every, lockstep)
    return results


_THREAD = threading.local()  # threads of a Dask worker share no state


def packed(plan: Plan) -> bytes:
    """Return a plan and the files of its laws as bytes for other processes, without weather."""
    ambient = plan.study.factors.ambient.model_copy()
    # Hourly weather is large, and a shard needs a few hours of it: it gets its temperatures with
    # its rows.
    ambient._series = None
    factors = plan.study.factors.model_copy(update={"ambient": ambient})
    packed_plan = copy.copy(plan)
    packed_plan.study = plan.study.model_copy(update={"factors": factors})
    return pickle.dumps((packed_plan, loaded_files()))


def compute_shard_in_process(shared: tuple[bytes, bool], work: Work) -> ShardResult | None:
    """Compute a shard; `shared` is a plan from `packed`, and whether histories are kept."""
    packed_plan, histories = shared
    digest = hashlib.sha256(packed_plan).digest()
    # Shards of one study follow each other: it is unpacked once, and what runs share is kept.
    if getattr(_THREAD, "digest", None) != digest:
        plan, files = pickle.loads(packed_plan)
        load_again(files)
        _THREAD.preparer, _THREAD.digest = Preparer(plan), digest
    _THREAD.preparer.use_temperatures(work.temperatures)
    return compute_shard(_THREAD.preparer, work.rows, histories=histories)


EXTRA = 'needs distributed: pip install "thermobearing[cluster]"'
SCHEDULER_PATIENCE = 10.0  # timeout of the scheduler [s]
LOOK = 0.5  # interval of checks of the scheduler [s]
FEWEST = 4  # shards that are submitted, for workers that start later
LOST = ("cancelled", "lost")


def on_dask(
    shared: tuple[bytes, bool], works: Iterable[Work], address: Any
) -> Generator[tuple[Work, ShardResult | None]]:
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
) -> Generator[tuple[Work, ShardResult | None]]:
    """Yield shards when they are ready; `AHEAD` are submitted for each thread."""
    from distributed import KilledWorker

    running: dict[Any, Work] = {}
    finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
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
        future.add_done_callback(finished.put)

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
                    future = finished.get(timeout=LOOK)
                except queue.Empty:
                    _check()
            work = running.pop(future)
            if future.status in LOST:
                _send(work)
                continue
            try:
                shard = future.result()
            except KilledWorker:
                raise OutputError(
                    "workers of the Dask cluster died repeatedly on the same runs (out of "
                    f"memory?); {KEPT}, with smaller shards or larger workers"
                ) from None
            yield work, shard
    finally:
        if _answers():
            client.cancel([*running, study])
