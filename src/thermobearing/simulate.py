"""The whole story in one file: a bearing, a test, an ambient temperature -> a result.

    bearing -> stack of cells -> constants -> one coupled step, many times -> labelled dataset

Read from top to bottom: `run` gathers what the user gave into a Case, `run_case` carries it
out. The physics is in core/step.py, the test in drive/protocol.py, the numbers and pictures
in results/.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import thermobearing
from thermobearing.bearing.model import Bearing
from thermobearing.case import Case, EndFace, make_case, resolved_toml
from thermobearing.core.types import LEAD_DEGC, Constants
from thermobearing.drive.ambient import Ambient
from thermobearing.drive.assemble import build_constants
from thermobearing.drive.outcomes import INTERRUPTED, SENTENCES, SHARING_SENTENCES
from thermobearing.drive.protocol import (
    CyclicTest,
    Segment,
    build_segments,
    longest_layer_increment,
)
from thermobearing.drive.run import History, run_segments
from thermobearing.errors import InputError
from thermobearing.results.dataset import RunRecord, StackLabels, build_dataset
from thermobearing.results.result import Result
from thermobearing.stack import Stack, build_stack

Floats = NDArray[np.float64]
Progress = Callable[[int, int], None]


def run(
    bearing: Bearing | str | Path,
    test: CyclicTest | None = None,
    ambient: float | Sequence[float] | Ambient = 23.0,
    *,
    dt: float | None = None,
    scheme: str | None = None,
    integrator: str | None = None,
    heat_source: str | None = None,
    upper_face: EndFace | None = None,
    lower_face: EndFace | None = None,
    initial: float | Sequence[float] | Result | None = None,
    keep: Sequence[str] | None = None,
    keep_every: int | None = None,
    stack: str | None = None,
    progress: Progress | None = None,
) -> Result:
    """Put a bearing through a displacement-controlled test.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    test : what to do; Table 3.4 if not given.
    ambient : temperature of the air [degC], in [-100, 100]; several temperatures make several
        runs in one result; an `Ambient` is a series in time.
    dt : largest time step while the bearing moves [s], in (0, 10].
    scheme : "conservative" (default) or "published" heat scheme.
    integrator : "exact" (default) or "euler" integration of Z.
    heat_source : "work" (default, Eq. 4.22) or "dissipation".
    upper_face, lower_face : heat exchange of the end faces; eta_B = 2 by default.
    initial : temperature at the start [degC]: uniform, one per cell (upper face first), or
        the final profile of an earlier result; the ambient temperature by default.
    keep : of "rubber", "layer_displacement", "hysteretic", "cells": histories to keep
        besides displacement, force and energy; the first and last by default.
    keep_every : keep every n-th step (turning points are kept besides).
    stack : "auto" (default), "half" or "full" height.
    progress : called with (steps done, all steps).

    Returns
    -------
    Result

    Raises
    ------
    InputError : anything that cannot be used, named with what is allowed.

    Examples
    --------
    >>> import thermobearing as tb
    >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[1.0], cycles=1), ambient=-20)
    >>> bool(result.cycles["G_eq_MPa"][0] > 1.0)
    True
    """
    series = ambient if isinstance(ambient, Ambient) else None
    profile = final_profile(initial, ambient) if isinstance(initial, Result) else initial
    uniform = profile is None or np.ndim(profile) == 0
    options: dict[str, Any] = {
        "bearing": bearing,
        "test": test,
        "ambient": [series.at(0.0)] if series else np.atleast_1d(np.asarray(ambient, float)),
        "dt": dt,
        "scheme": scheme,
        "integrator": integrator,
        "heat_source": heat_source,
        "stack": stack,
        "upper_face": upper_face,
        "lower_face": lower_face,
        "keep": keep,
        "keep_every": keep_every,
        "initial": profile if uniform else None,
        "initial_profile": None if uniform else profile,
        "initial_lead": final_lead(initial, ambient) if isinstance(initial, Result) else None,
    }
    return run_case(make_case({}, "run()", **options), series=series, progress=progress)


def final_profile(result: Result, ambient: Any) -> Floats:
    """Cell temperatures at the end of an earlier result; of the run at the same ambient."""
    return np.asarray(result["final_temperature"].values[_same_run(result, ambient)])


def final_lead(result: Result, ambient: Any) -> float | None:
    """Lead temperature at the end of an earlier result; None without lead."""
    value = float(result["final_lead_temperature"].values[_same_run(result, ambient)])
    return None if np.isnan(value) else value


def _same_run(result: Result, ambient: Any) -> int:
    """Number of the run of a result at an ambient temperature; the only run, if there is one."""
    runs = result["ambient"].values
    if len(runs) == 1:
        return 0
    match = np.flatnonzero(runs == ambient)
    if np.ndim(ambient) != 0 or len(match) != 1:
        raise InputError(f"initial: the earlier result has runs at {runs} degC; use one of them")
    return int(match[0])


def run_case(
    case: Case, *, series: Ambient | None = None, progress: Progress | None = None
) -> Result:
    """Carry out a complete case; never raises for a failed analysis (see `Result.outcome`)."""
    bearing, analysis = case.bearing, case.analysis
    stack = build_stack(bearing, half=analysis.half)
    constants = build_constants(
        bearing,
        stack,
        upper=analysis.upper_face.face(),
        lower=None if analysis.half else analysis.lower_face.face(),
        scheme=analysis.scheme,
        integrator=analysis.integrator,
        heat_source=analysis.heat_source,
    )
    segments = build_segments(case.test, bearing.total_rubber_thickness)
    if case.ambient_series is not None:
        series = Ambient.from_csv(case.ambient_series)
    climates = [series] if series else [Ambient.constant(value) for value in case.ambient]
    total = len(climates) * sum(len(segment.x) for segment in segments)
    done = 0

    def report(steps: int) -> None:
        nonlocal done
        done += steps
        if progress:
            progress(done, total)

    histories: list[History] = []
    for climate in climates:
        history = run_segments(
            constants,
            segments,
            climate,
            _initial_temperatures(case, stack, climate.at(0.0)),
            initial_lead=case.initial_lead,
            keep_every=analysis.keep_every,
            groups=analysis.keep,
            progress=report,
        )
        histories.append(history)
        if history.outcome == INTERRUPTED:
            break
    return _label(case, stack, constants, segments, climates, histories)


def _initial_temperatures(case: Case, stack: Stack, ambient: float) -> Floats:
    """Cell temperatures at the start [degC]."""
    cells = len(stack.part)
    if case.initial_profile is not None:
        if len(case.initial_profile) != cells:
            raise InputError(
                f"initial_profile has {len(case.initial_profile)} temperatures, "
                f"but the stack has {cells} cells"
            )
        return np.array(case.initial_profile)
    return np.full(cells, ambient if case.initial is None else case.initial)


def warnings_of(case: Case, segments: list[Segment]) -> list[str]:
    """What a user should know about the accuracy of a case, in sentences."""
    increment = longest_layer_increment(segments, case.bearing.geometry.rubber_layers)
    yielding = case.bearing.hysteresis.yield_displacement
    if increment <= yielding:
        return []
    return [
        f"a step moves each rubber layer by up to {increment:.3g} mm, more than its yield "
        f"displacement of {yielding:g} mm: work and heat of such steps are coarse; use a smaller dt"
    ]


def _label(
    case: Case,
    stack: Stack,
    constants: Constants,
    segments: list[Segment],
    climates: list[Ambient],
    histories: list[History],
) -> Result:
    """Names, units and provenance for what the runs left behind."""
    records = [
        RunRecord(
            ambient=climate.at(0.0),
            rows=history.rows,
            cells=history.cells,
            segment=history.segment,
            cycle=history.cycle,
            initial=history.initial,
            final=history.state.temperature,
            final_lead=float(history.state.books[LEAD_DEGC]) if case.bearing.lead else np.nan,
            outcome=history.outcome,
            softened_steps=history.softened_steps,
            mismatch=history.mismatch,
            steps=history.steps,
        )
        for climate, history in zip(climates, histories, strict=False)
    ]
    branches = case.bearing.lead is not None or case.bearing.rate is not None
    labels = StackLabels(stack.depth, stack.thickness, stack.part, len(stack.first_cell), branches)
    attributes = {
        "title": f"{case.bearing.name}, {case.test.name}",
        "command": "cyclic",
        "bearing": case.bearing.name,
        "scheme": case.analysis.scheme,
        "integrator": case.analysis.integrator,
        "heat_source": case.analysis.heat_source,
        "lead_capacity_kN_mm_per_K": constants.lead.cores * constants.lead.capacity,
        "version": thermobearing.__version__,
        "case": resolved_toml(case),
        "citation": case.bearing.citation,
        "area_mm2": case.bearing.area,
        "total_rubber_thickness_mm": case.bearing.total_rubber_thickness,
        "heat_capacity_kN_mm_per_K": stack.heat_capacity.tolist(),
        "half_stack": int(case.analysis.half),
        "segments": [
            {"kind": s.kind, "label": s.label, "amplitude_strain": s.amplitude_strain}
            for s in segments
        ],
        "warnings": warnings_of(case, segments),
        "sentences": SENTENCES | SHARING_SENTENCES,
    }
    return Result(
        build_dataset(
            records,
            labels,
            case.analysis.keep,
            area=case.bearing.area,
            total_rubber_thickness=case.bearing.total_rubber_thickness,
            attributes=attributes,
        )
    )
