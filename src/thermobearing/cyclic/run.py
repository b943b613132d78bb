"""The whole story in one file: a bearing, a test, an ambient temperature -> a result.

    bearing -> stack of cells -> constants -> one coupled step, many times -> labelled dataset

Read from top to bottom: `run` gathers what the user gave into a Case, `run_case` carries it
out. The physics is in core/step.py, the test in cyclic/protocol.py, the numbers and pictures
in results/.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.exposure import Exposure
from thermobearing.bearing.model import Bearing, Clock, SmallLoops
from thermobearing.border.errors import InputError
from thermobearing.climate.readers import read_air
from thermobearing.cyclic.case import (
    Case,
    Earlier,
    Group,
    Histories,
    Rig,
    initial_temperatures,
    make_case,
)
from thermobearing.cyclic.dataset import label
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.history import History, build_segments, run_segments
from thermobearing.cyclic.protocol import CyclicTest, checked_history
from thermobearing.cyclic.result import Result
from thermobearing.model.constants import Hardening, HeatSource, Integrator, LeadEnds
from thermobearing.model.earlier import Model, models_that_fit
from thermobearing.model.handover import begun_from
from thermobearing.model.options import EndFace, Side, Stacked, build_model
from thermobearing.model.outcomes import INTERRUPTED
from thermobearing.model.stack import Scheme

Progress = Callable[[int, int], None]


def run(
    bearing: Bearing | str | Path,
    test: CyclicTest | None = None,
    ambient: float | Sequence[float] | Ambient = 23.0,
    *,
    history: tuple[Sequence[float], Sequence[float]] | None = None,
    dt: float | None = None,
    scheme: Scheme | None = None,
    integrator: Integrator | None = None,
    hardening: Hardening | None = None,
    small_loops: SmallLoops | None = None,
    heat_source: HeatSource | None = None,
    lead_ends: LeadEnds | None = None,
    clock: Clock | None = None,
    upper_face: EndFace | None = None,
    lower_face: EndFace | None = None,
    side: Side | None = None,
    initial: float | Sequence[float] | Earlier | str | Path | None = None,
    initial_lead: float | None = None,
    keep: Sequence[Group] | None = None,
    keep_every: int | None = None,
    histories: Histories | None = None,
    stack: Stacked | None = None,
    model: Model | None = None,
    exposure: Exposure | dict[str, Any] | None = None,
    rig: Rig | str | Path | dict[str, Any] | None = None,
    progress: Progress | None = None,
) -> Result:
    """Put a bearing through a displacement-controlled test.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    test : what to do; Table 3.4 if not given.
    ambient : temperature of the air [degC], in [-100, 100]; several temperatures make several
        runs in one result; an `Ambient` is a series in time.
    history : instead of a test: two arrays, times [s] that increase and displacements [mm],
        the first where the bearing is (0 mm for a virgin one); straight lines between.
    dt : largest time step while the bearing moves [s], in [1e-6, 10]; that of the test by
        default, which is 0.005 unless told.
    scheme : "conservative" (default) or "published" heat scheme.
    integrator : "exact" (default) or "euler" integration of Z.
    hardening : "printed" (default, Eq. 4.34), or "monotone": unloading that never goes up.
    small_loops : "published" (Eq. 4.35), after which a small reversal does not come back to the
        force where it began, or "closed": it does. By default that of the bearing, "published"
        unless it says otherwise.
    heat_source : "work" (Eq. 4.22) or "dissipation"; by default that of the bearing, dissipation
        for natural rubber (LRB), else work.
    lead_ends : how lead passes heat to steel: "finite-plate" (default) or "half-space"
        (Eq. 5.4-5.5), which the published scheme and the earlier models have.
    clock : of lead on a half-space, "lead" (Eq. 5.6 as printed) or "steel"; by default that of the
        bearing, or, if it says none, lead with the published scheme and steel otherwise.
    upper_face, lower_face : heat exchange of the end faces; eta_B = 2 by default.
    side : heat exchange of the side, a `tb.Side`; by default the film of the bearing's
        materials without cover.
    initial : temperature at the start [degC]: uniform, or one per cell (upper face first); the
        ambient temperature by default. Or an earlier result of the same bearing (of a test, or of
        `hybrid` or `bridge`), or its directory: the test goes on where that one ended, with
        temperatures, forces and all memory.
    initial_lead : lead temperature at the start [degC]; that of the cells beside it by default.
    keep : of "rubber", "layer_displacement", "hysteretic", "cells": histories to keep
        besides displacement, force and energy; the first and last by default.
    keep_every : keep every n-th step (turning points are kept besides).
    histories : in the files of `save`: "thinned" (default), turning points and 200 points a
        cycle, or "complete".
    stack : "auto" (default), "half" or "full" height.
    model : "multi-layer" (default) or an earlier model to compare with (model/earlier.py).
    exposure : factors for long cold and age, {"stiffness": 1.3, "strength": 1.2, "source": "..."};
        by default those of the bearing, which is none.
    rig : limits of force [kN], stroke [mm] and speed [mm/s] that are told when a run passes them:
        a name ("shen-rig"), a file or a table; none by default.
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
    earlier = isinstance(initial, Earlier | str | Path)
    uniform = initial is None or np.ndim(initial) == 0  # type: ignore[arg-type]
    options: dict[str, Any] = {
        "bearing": bearing,
        "test": _as_test(test, history),
        "ambient": [series.at(0.0)] if series else ambient,
        "dt": dt,
        "scheme": scheme,
        "integrator": integrator,
        "hardening": hardening,
        "small_loops": small_loops,
        "heat_source": heat_source,
        "lead_ends": lead_ends,
        "clock": clock,
        "stack": stack,
        "model": model,
        "exposure": exposure,
        "upper_face": upper_face,
        "lower_face": lower_face,
        "side": side,
        "keep": keep,
        "keep_every": keep_every,
        "histories": histories,
        "initial": initial if uniform and not earlier else None,
        "initial_profile": None if uniform or earlier else initial,
        "initial_result": initial if earlier else None,
        "initial_lead": initial_lead,
        "rig": rig,
    }
    return run_case(make_case({}, "run()", **options), series=series, progress=progress)


def _as_test(test: CyclicTest | None, history: Any) -> CyclicTest | None:
    """The test, or a history as one."""
    if history is None:
        return test
    if test is not None:
        raise InputError("give test or history, not both", "run()")
    try:
        times, displacements = history
    except (TypeError, ValueError):
        raise InputError(
            "history: give two arrays, times [s] and displacements [mm]", "run()"
        ) from None
    checked_history(times, displacements, None, "run(): history")
    lists = {
        "time_s": np.asarray(times, dtype=float).tolist(),
        "displacement_mm": np.asarray(displacements, dtype=float).tolist(),
    }
    step = {"step": "recorded", **lists}
    return CyclicTest(name="history", steps=[step])


def run_case(
    case: Case, *, series: Ambient | None = None, progress: Progress | None = None
) -> Result:
    """Carry out a complete case; never raises for a failed analysis (see `Result.outcome`).

    Parameters
    ----------
    case : from `load_case` or `make_case`.
    series : temperature of the air in time, instead of that of the case.
    progress : called with (steps done, all steps).

    Returns
    -------
    Result

    Examples
    --------
    >>> from thermobearing.cyclic.protocol import cyclic_test
    >>> test = cyclic_test(strain=[0.5], cycles=1)
    >>> run_case(make_case({}, "example", test=test, ambient=-20)).outcome
    'completed'
    """
    model = build_model(case.bearing, case.analysis, backbone=bilinear_parameters)
    segments = build_segments(case.test, case.bearing.total_rubber_thickness, case.starts_at)
    if case.ambient_series is not None:
        series = read_air(case.ambient_series)
    climates = [series] if series else [Ambient.constant(value) for value in case.ambient]
    total = len(climates) * sum(len(segment.x) for segment in segments)
    done = 0

    def report(steps: int) -> None:
        nonlocal done
        done += steps
        if progress:
            progress(done, total)

    histories: list[History] = []
    zero = (case.initial_state and case.initial_state.zero) or 0.0  # of the instruments
    moved = [replace(one, x=one.x + zero) for one in segments] if zero else segments
    for climate in climates:
        begin = None
        if case.initial_state is not None:
            begin = begun_from(case.initial_state, model.constants, case.initial_lead)
        history = run_segments(
            model.constants,
            moved,
            climate,
            initial_temperatures(case, len(model.constants.cells.capacity), climate.at(0.0)),
            initial_lead=case.initial_lead,
            begin=begin,
            keep_every=case.analysis.keep_every,
            groups=case.analysis.keep,
            progress=report,
        )
        history.rows.books["displacement"][:] -= zero
        histories.append(history)
        if history.outcome == INTERRUPTED:
            break
    return label(case, model, segments, climates, histories)


def compare_models(case: Case) -> dict[str, Result]:
    """Results of models by name, the multi-layer one first.

    Parameters
    ----------
    case : with the conservative scheme and automatic stack, as earlier models use them.

    Returns
    -------
    dict of Result

    Raises
    ------
    InputError : scheme or stack are not those.

    Examples
    --------
    >>> from thermobearing.cyclic.case import make_case
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1)
    >>> results = compare_models(make_case({}, "example", test=test, ambient=[23.0]))
    >>> list(results)[:2]
    ['multi-layer', 'adiabatic']
    """
    results: dict[str, Result] = {}
    for model in models_that_fit(case.bearing):
        analysis = case.analysis.model_copy(
            update={"model": model, "scheme": "conservative", "stack": "auto"}
        )
        results[model] = run_case(case.model_copy(update={"analysis": analysis}))
    return results
