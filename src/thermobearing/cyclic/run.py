"""Run cyclic tests: a bearing, a test, an ambient temperature -> a result.

    bearing -> stack of cells -> constants -> one coupled step, many times -> labelled dataset

Read from top to bottom: `run` gathers what the user gave into a Case, `run_case` carries it
out. The physics is in core/step.py, the test in cyclic/protocol.py, the numbers and pictures
in results/.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, short_repr
from thermobearing.climate.readers import read_air
from thermobearing.core.types import Constants
from thermobearing.cyclic import dataset
from thermobearing.cyclic.case import (
    Axial,
    Case,
    Earlier,
    Group,
    InitialState,
    Keep,
    Rig,
    initial_temperatures,
    make_case,
)
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.history import History as Recorded
from thermobearing.cyclic.history import build_segments, run_segments
from thermobearing.cyclic.protocol import CyclicTest, checked_history, lifted
from thermobearing.cyclic.result import Result
from thermobearing.model.axial import axial_rows, column_of
from thermobearing.model.earlier import Model
from thermobearing.model.handover import begun_from
from thermobearing.model.options import ModelKeywords, ModelOptions, build_model, model_table
from thermobearing.model.outcomes import CAVITATED, INTERRUPTED, UNSTABLE

Progress = Callable[[int, int], None]
# Times [s] and displacements [mm]; those along x and across in a plane.
History: TypeAlias = Sequence[ArrayLike]


@checked
def run(
    bearing: Bearing | str | Path,
    test: CyclicTest | History | None = None,
    ambient: float | Sequence[float] | Ambient = 23.0,
    *,
    model: ModelOptions | Model | None = None,
    dt: float | None = None,
    initial: InitialState | float | Sequence[float] | Earlier | str | Path | None = None,
    keep: Keep | Sequence[Group] | None = None,
    rig: Rig | str | Path | dict[str, Any] | None = None,
    axial_force: float | tuple[Sequence[float], Sequence[float]] | None = None,
    axial: Axial | None = None,
    progress: Progress | None = None,
    **options: Unpack[ModelKeywords],
) -> Result:
    """Run a displacement-controlled test of a bearing.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    test : the test, Table 3.4 by default; or a history, two arrays: times [s] that increase and
        displacements [mm], the first where the bearing is (0 mm for a virgin one); straight lines
        between. Three arrays, times and the displacements along x and across (y), move the bearing
        in a plane, as `cyclic_test(path="circle", ...)` does.
    ambient : ambient temperature [degC], in [-100, 100]; several temperatures make several
        runs in one result; an `Ambient` is a series in time.
    model : `ModelOptions`, or the name of an earlier model to compare with (model/earlier.py);
        "multi-layer" by default.
    dt : largest time step while the bearing moves [s], in [1e-6, 10]; that of the test by
        default, which is 0.005 unless it says otherwise.
    initial : temperature at the start [degC]: uniform, or one per cell (upper face first); the
        ambient temperature by default. Or an earlier result of the same bearing, or its
        directory: the test continues where that one ended. `InitialState` holds all of these, the
        temperature of the lead, and the hours of a specimen in its chamber.
    keep : histories to keep in addition to displacement, force and energy, of "rubber",
        "layer_displacement", "hysteretic" and "cells"; the first and last by default. `Keep` also
        states the interval of steps and what is written.
    rig : limits of force [kN], stroke [mm] and speed [mm/s]; a warning says which a run exceeds:
        a name ("shen-rig"), a file or a table; none by default.
    axial_force : on the bearing [kN], positive in compression, in [-1e6, 1e6]; the result then has
        checks of stress and critical load. Two arrays, increasing times [s] and forces [kN], make
        it a history, which acts on the shear force.
    axial : whether the axial force acts on the shear force: "off" (default for a number),
        "constant", or "history" (default for two arrays). It never changes the heat.
    progress : called with (steps done, all steps).
    exposure, state : fields of `ModelOptions`, in place of those of `model`.

    Raises
    ------
    InputError : invalid input; the message names the key and the allowed range.

    Examples
    --------
    >>> import thermobearing as tb
    >>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[1.0], cycles=1), ambient=-20)
    >>> bool(result.cycles["G_eq_MPa"][0] > 1.0)
    True
    """
    series = ambient if isinstance(ambient, Ambient) else None
    case = make_case(
        {},
        "run()",
        bearing=bearing,
        test=_as_test(test),
        ambient=[series.at(0.0)] if series else ambient,
        dt=dt,
        rig=rig,
        **_axial_table(axial_force, axial),
        **InitialState.of(initial).table(),
        **Keep.of(keep).table(),
        **model_table(model, options),
    )
    return run_case(case, series=series, progress=progress)


def _axial_table(axial_force: Any, axial: Axial | None) -> dict[str, Any]:
    """Return an axial force, or its history, as keys of a case."""
    if axial_force is None or np.ndim(axial_force) == 0:
        return {"axial_force": axial_force, "axial": axial}
    try:
        time, force = (np.asarray(values, dtype=float).tolist() for values in axial_force)
    except (TypeError, ValueError):
        message = (
            f"axial_force = {short_repr(axial_force)}: give a number [kN], or two arrays, "
            "times [s] and forces [kN]"
        )
        raise InputError(message, "run()") from None
    history = {"time_s": time, "force_kN": force}
    return {"axial_history": history, "axial": axial or "history"}


def _as_test(test: CyclicTest | History | None) -> CyclicTest | None:
    if test is None or isinstance(test, CyclicTest):
        return test
    try:
        times, displacements, *across = test
        if len(across) > 1:
            raise ValueError
    except (TypeError, ValueError):
        message = (
            f"test = {short_repr(test)}: give a CyclicTest, or two arrays, times [s] and "
            "displacements [mm], or three, with displacements across (y) [mm]"
        )
        raise InputError(message, "run()") from None
    checked_history(times, displacements, None, "run(): test", across[0] if across else None)
    names = ("time_s", "displacement_mm", "displacement_y_mm")
    columns = (np.asarray(values, dtype=float).tolist() for values in test)
    lists = dict(zip(names, columns, strict=False))
    return CyclicTest(name="history", steps=[{"step": "recorded", **lists}])


@checked
def run_case(
    case: Case, *, series: Ambient | None = None, progress: Progress | None = None
) -> Result:
    """Run a complete case; a failed analysis does not raise an error (see `Result.outcome`).

    Parameters
    ----------
    case : from `load_case` or `make_case`.
    series : temperature of the air in time, instead of that of the case.
    progress : called with (steps done, all steps).

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
    steps_done = 0

    def _report(steps: int) -> None:
        nonlocal steps_done
        steps_done += steps
        if progress:
            progress(steps_done, total)

    histories: list[Recorded] = []
    # The model counts displacements from the unloaded virgin bearing; the test and its result from
    # where the instruments read zero.
    zero = (case.initial_state and case.initial_state.zero) or 0.0  # of the instruments
    offset = lifted(zero) if case.test.in_plane else zero
    shifted_segments = [replace(part, x=part.x + offset) for part in segments] if zero else segments
    for climate in climates:
        begin = None
        if case.initial_state is not None:
            components = 2 if case.test.in_plane else 1
            begin = begun_from(case.initial_state, model.constants, case.initial_lead, components)
        cells = len(model.constants.cells.capacity)
        temperature, lead = initial_temperatures(case, cells, climate.at(0.0))
        history = run_segments(
            model.constants,
            shifted_segments,
            climate,
            temperature,
            initial_lead=lead,
            begin=begin,
            keep_every=case.analysis.keep_every,
            groups=(*case.analysis.keep, "rubber")
            if case.analysis.has_axial
            else case.analysis.keep,
            progress=_report,
        )
        if case.analysis.has_axial:
            _press(case, model.constants, history)
        history.rows.response["displacement"][:] -= offset
        histories.append(history)
        if history.outcome == INTERRUPTED:
            break
    return Result(partial(dataset.labelled, case, model, segments, climates, histories))


def _press(case: Case, constants: Constants, history: Recorded) -> None:
    """Take from the shear force what the axial force takes, and note it in a history."""
    response = history.rows.response
    column = column_of(case.bearing, case.analysis.axial_factor or "overlap")
    displacement, force = response["displacement"], case.axial_forces(response["clock"])
    axial = axial_rows(column, constants, displacement, force, history.rows.rubber)
    reduction = axial["stiffness_reduction"]
    if displacement.ndim > 1:
        reduction = np.stack([reduction, axial["stiffness_reduction_y"]], axis=-1)
    response["force"] -= reduction * displacement
    history.axial = axial
    # A run that ended for another reason keeps it: what follows is of the part before the end.
    if history.outcome != "completed":
        return
    if (axial["axial_force"] > axial["critical_load"]).any():
        history.outcome = UNSTABLE
    elif (-axial["axial_force"] > axial["cavitation_force"]).any():
        history.outcome = CAVITATED
