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

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.keywords import checked_keywords
from thermobearing.climate.readers import read_air
from thermobearing.cyclic import dataset
from thermobearing.cyclic.case import (
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
from thermobearing.model.earlier import Model
from thermobearing.model.handover import begun_from
from thermobearing.model.options import ModelKeywords, ModelOptions, build_model, model_table
from thermobearing.model.outcomes import INTERRUPTED

Progress = Callable[[int, int], None]
# Times [s] and displacements [mm]; those along x and across in a plane.
History: TypeAlias = (
    tuple[Sequence[float], Sequence[float]]
    | tuple[Sequence[float], Sequence[float], Sequence[float]]
)


@checked_keywords
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
    axial_force: float | None = None,
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
        directory: the test continues where that one ended. `InitialState` holds all of these and
        the temperature of the lead.
    keep : histories to keep in addition to displacement, force and energy, of "rubber",
        "layer_displacement", "hysteretic" and "cells"; the first and last by default. `Keep` also
        states the interval of steps and what is written.
    rig : limits of force [kN], stroke [mm] and speed [mm/s]; a warning says which a run exceeds:
        a name ("shen-rig"), a file or a table; none by default.
    axial_force : on the bearing [kN], positive in compression, in [-1e6, 1e6]. It changes neither
        force nor heat; the result then has checks of stress and critical load.
    progress : called with (steps done, all steps).
    options : fields of `ModelOptions`, such as scheme or lead_ends.

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
        axial_force=axial_force,
        **InitialState.of(initial).table(),
        **Keep.of(keep).table(),
        **model_table(model, options),
    )
    return run_case(case, series=series, progress=progress)


def _as_test(test: CyclicTest | History | None) -> CyclicTest | None:
    if test is None or isinstance(test, CyclicTest):
        return test
    try:
        times, displacements, *across = test
        if len(across) > 1:
            raise ValueError
    except (TypeError, ValueError):
        message = (
            f"test = {shortened(repr(test))}: give a CyclicTest, or two arrays, times [s] and "
        )
        message += "displacements [mm], or three, with displacements across (y) [mm]"
        raise InputError(message, "run()") from None
    checked_history(times, displacements, None, "run(): test", across[0] if across else None)
    names = ("time_s", "displacement_mm", "displacement_y_mm")
    columns = (np.asarray(values, dtype=float).tolist() for values in test)
    lists = dict(zip(names, columns, strict=False))
    return CyclicTest(name="history", steps=[{"step": "recorded", **lists}])


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
    done = 0

    def _report(steps: int) -> None:
        nonlocal done
        done += steps
        if progress:
            progress(done, total)

    histories: list[Recorded] = []
    zero = (case.initial_state and case.initial_state.zero) or 0.0  # of the instruments
    offset = lifted(zero) if case.test.in_plane else zero
    moved = [replace(one, x=one.x + offset) for one in segments] if zero else segments
    for climate in climates:
        begin = None
        if case.initial_state is not None:
            components = 2 if case.test.in_plane else 1
            begin = begun_from(case.initial_state, model.constants, case.initial_lead, components)
        history = run_segments(
            model.constants,
            moved,
            climate,
            initial_temperatures(case, len(model.constants.cells.capacity), climate.at(0.0)),
            initial_lead=case.initial_lead,
            begin=begin,
            keep_every=case.analysis.keep_every,
            groups=case.analysis.keep,
            progress=_report,
        )
        history.rows.books["displacement"][:] -= offset
        histories.append(history)
        if history.outcome == INTERRUPTED:
            break
    return Result(partial(dataset.labelled, case, model, segments, climates, histories))
