"""Names, units and provenance for what the runs of a case left behind."""

from functools import partial

import numpy as np
import xarray as xr

import thermobearing
from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.exposure import exposure_attribute, exposures, told_of
from thermobearing.bearing.validity import ranges_of
from thermobearing.core.records import labels
from thermobearing.core.types import Books, RubberBooks
from thermobearing.cyclic.case import Case
from thermobearing.cyclic.dataset import RunRecord, StackLabels, build_dataset
from thermobearing.cyclic.history import History, has_branches
from thermobearing.cyclic.result import Result, run_name
from thermobearing.cyclic.rig import asked_of, beyond
from thermobearing.cyclic.segments import Segment, longest_layer_increment
from thermobearing.model.earlier import BLIND
from thermobearing.model.handover import memory_of
from thermobearing.model.options import BearingModel
from thermobearing.model.outcomes import SENTENCES, SHARING_SENTENCES
from thermobearing.model.temperature import outside_law
from thermobearing.results.ranges import Row, asked_of_tests, outside_tests, reached_by


def warnings_of(case: Case, segments: list[Segment], climates: list[Ambient]) -> list[str]:
    """What a user should know about a result, in sentences."""
    found = list(dict.fromkeys(text for segment in segments for text in segment.assumed))
    if case.ambient_series is None and any(len(climate.time) > 1 for climate in climates):
        found.append(
            "the ambient series was given in Python: case.resolved.toml has its first value only; "
            "give it as a CSV file (ambient_series) to be able to run the case again"
        )
    if case.initial_state is not None and not case.initial_state.whole:
        found.append(
            "the earlier result hands over temperatures only (it was written before results held "
            "the whole state): rubber and lead begin unloaded and virgin, at zero displacement"
        )
    layers = case.bearing.geometry.rubber_layers
    increment = longest_layer_increment(segments, layers, case.starts_at)
    yielding = case.bearing.hysteresis.yield_displacement
    if increment > yielding:
        found.append(
            f"a step moves each rubber layer by up to {increment:.3g} mm, more than its yield "
            f"displacement of {yielding:g} mm: work and heat of such steps are coarse; use a "
            "smaller dt"
        )
    return found


def extrapolated(case: Case, climates: list[Ambient], histories: list[History]) -> list[str]:
    """Whether rubber left the range of its temperature law, where the model has one."""
    if case.analysis.model in BLIND:
        return []
    runs = [
        (f"{climate.at(0.0):g} degC", history.rows.books["clock"], np.asarray(history.rows.rubber))
        for climate, history in zip(climates, histories, strict=False)
    ]
    return outside_law(case.bearing.name, case.bearing.temperature_law, runs)


def stack_labels(model: BearingModel) -> StackLabels:
    """What the layers and cells of a run are; a single cell stands for the whole bearing."""
    stack, constants = model.stack, model.constants
    layers = len(constants.multiplicity)
    books = labels(Books if has_branches(constants) else RubberBooks)
    if len(constants.cells.capacity) == len(stack.part):
        return StackLabels(stack.depth, stack.thickness, stack.part, layers, books)
    height = stack.thickness.sum()
    return StackLabels(
        np.array([0.5 * height]), np.array([height]), ("whole bearing",), layers, books
    )


def asked(
    case: Case, segments: list[Segment], climates: list[Ambient], histories: list[History]
) -> dict[str, list[Row]]:
    """What each run asks of the rig and of the tests behind the bearing, where they are given.

    The speed is that of the whole test.
    """
    x = np.concatenate([[case.starts_at], *(segment.x for segment in segments)])
    dt = np.concatenate([segment.dt for segment in segments])
    speed = float((np.abs(np.diff(x)) / dt).max())
    rig: list[Row] = []
    tested: list[Row] = []
    for climate, history in zip(climates, histories, strict=False):
        books, name = history.rows.books, run_name(climate.at(0.0))
        peaks = [float(np.abs(books[one]).max()) for one in ("force", "displacement")]
        rig += asked_of(case.rig, name, [*peaks, speed])
        reached = reached_by(
            books["clock"],
            books["displacement"],
            speed,
            rubber=case.bearing.total_rubber_thickness,
            ambient=(float(climate.temperature.min()), float(climate.temperature.max())),
            lead=books["lead_temperature"] if case.bearing.lead else None,
        )
        tested += asked_of_tests(name, reached, ranges_of(case.bearing))
    return {"rig": rig, "tested_range": tested}


def run_record(case: Case, climate: Ambient, history: History, what: StackLabels) -> RunRecord:
    """What one run left behind, as plain arrays."""
    return RunRecord(
        ambient=climate.at(0.0),
        books={name: history.rows.books[name] for name, _, _ in what.books},
        groups=history.rows._asdict(),
        segment=history.segment,
        cycle=history.cycle,
        initial=history.initial,
        final=history.state.temperature,
        final_lead=history.state.books[0].lead_temperature if case.bearing.lead else np.nan,
        memory=memory_of(history.state),
        outcome=history.outcome,
        softened_steps=history.softened_steps,
        mismatch=history.mismatch,
        steps=history.steps,
    )


def label(
    case: Case,
    model: BearingModel,
    segments: list[Segment],
    climates: list[Ambient],
    histories: list[History],
) -> Result:
    """What the runs left behind; names, units and provenance when they are first asked for."""
    return Result(partial(labelled, case, model, segments, climates, histories))


def labelled(
    case: Case,
    model: BearingModel,
    segments: list[Segment],
    climates: list[Ambient],
    histories: list[History],
) -> xr.Dataset:
    """Names, units and provenance for what the runs left behind."""
    what = stack_labels(model)
    records = [
        run_record(case, climate, history, what)
        for climate, history in zip(climates, histories, strict=False)
    ]
    rows = asked(case, segments, climates, histories)
    constants, options = model.constants, model.options
    factors = exposures([case.bearing], case.analysis.exposure)
    lead_capacity = constants.lead.cores * constants.lead.capacity
    attributes = {
        "title": f"{case.bearing.name}, {case.test.name}",
        "command": "cyclic",
        "bearing": case.bearing.name,
        "model": options.model,
        "scheme": options.scheme,
        "integrator": options.integrator,
        "heat_source": options.heat_source,
        "lead_capacity_kN_mm_per_K": lead_capacity if case.bearing.lead else 0.0,
        "version": thermobearing.__version__,
        "case": case.to_toml(),
        "citation": case.bearing.citation,
        "area_mm2": case.bearing.area,
        "total_rubber_thickness_mm": case.bearing.total_rubber_thickness,
        "heat_capacity_kN_mm_per_K": constants.cells.capacity.tolist(),
        "histories": case.analysis.histories,  # of files
        "half_stack": int(model.stack.fold == 2),
        "segments": [
            {"kind": s.kind, "label": s.label, "amplitude_strain": s.amplitude_strain}
            for s in segments
        ],
        "warnings": told_of(factors)
        + warnings_of(case, segments, climates)
        + extrapolated(case, climates, histories)
        + beyond(case.rig, rows["rig"])
        + outside_tests(case.bearing.name, rows["tested_range"], ranges_of(case.bearing)),
        **{name: found for name, found in rows.items() if found},
        **exposure_attribute(factors),
        "sentences": SENTENCES | SHARING_SENTENCES,
    }
    return build_dataset(
        records,
        what,
        case.analysis.keep,
        area=case.bearing.area,
        total_rubber_thickness=case.bearing.total_rubber_thickness,
        attributes=attributes,
    )
