"""Run a sequence: each part is a case that begins in the final state of the previous one."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from thermobearing.border.arguments import checked
from thermobearing.border.cases import made_case
from thermobearing.border.errors import InputError
from thermobearing.border.schema import check_workers
from thermobearing.cyclic.case import Case, final_state
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run_case
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.dataset import end_state_at, label_analysis
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.model.element import BearingElement
from thermobearing.model.handover import SpecimenState, specimen_state, state_memory
from thermobearing.model.options import build_model
from thermobearing.sequences.case import SequenceCase, load_sequence_case, make_sequence_case
from thermobearing.sequences.result import SequenceResult

Progress = Callable[[int, int], None]
UNLOADING = 1.0  # speed of the actuator [mm/s]
PIECES = 20  # steps of unloading
NEAREST, FARTHEST = 0.1, 1e3  # range of the unloading displacement [mm]


@checked
def sequence(
    case: SequenceCase | str | Path | dict[str, Any],
    *,
    progress: Progress | None = None,
    **overrides: Any,
) -> SequenceResult:
    """Run a sequence of tests on one specimen: hybrid, cyclic, rests.

    Parameters
    ----------
    case : a case file, a table as in a file (dimensional numbers as text with a unit), or a case.
    progress : called with (parts done, all parts).
    overrides : values that replace those of a file or table, by key: `bearing`, `ambient` [degC],
        `rig`, and every key of `analysis`.

    Raises
    ------
    InputError : invalid input; the message names the key and the allowed range.

    Examples
    --------
    >>> cycles = {"step": "cycles", "strain": 0.5, "speed": "30 mm/s", "count": 1}
    >>> parts = [{"part": "cyclic", "steps": [cycles]}, {"part": "hybrid", "duration": "2 s"}]
    >>> result = sequence({"parts": parts, "ambient": "-20 degC"})
    >>> list(result.table["kind"]), result.outcome
    (['cyclic', 'hybrid'], 'completed')
    """
    loaders = (SequenceCase, load_sequence_case, make_sequence_case, "sequence()")
    return run_sequence(made_case(case, *loaders, overrides), progress=progress)


def run_sequence(case: SequenceCase, *, progress: Progress | None = None) -> SequenceResult:
    """Run a sequence; a part that ends early is the last. `progress`: called with (done, all)."""
    check_workers("run_sequence()", progress=progress)
    results: list[Result | EarthquakeResult] = []
    state: SpecimenState | None = None
    interrupted = False
    try:
        for number in range(len(case.parts)):
            result, state = _run_part(case.whole_part(number, state))
            results.append(result)
            if progress:
                progress(number + 1, len(case.parts))
            if result.outcome != "completed":
                break
            if case.between == "unloaded" and number + 1 < len(case.parts):
                state = _unloaded(case, number, state)
    except KeyboardInterrupt:
        interrupted = True
    return SequenceResult(case, results, interrupted=interrupted)


def _unloaded(case: SequenceCase, number: int, state: SpecimenState) -> SpecimenState:
    """Return the state after unloading at the speed UNLOADING, with instruments zeroed there."""
    part = case.parts[number]
    ambient = case.ambient if part.ambient is None else part.ambient
    constants = build_model(case.bearing, case.analysis, backbone=bilinear_parameters).constants
    element = BearingElement.from_constants(constants, ambient, initial=state)
    start, dt = state.at, 1.0

    def _force(x: float) -> float:
        return element.set_trial(x, dt, ambient).force

    def _other_side(x: float) -> float:
        """Return a displacement at which the force has the other sign; x where there is none."""
        direction, distance = -np.sign(_force(x)), NEAREST if _force(x) else 0.0
        while _force(x + direction * distance) * direction < 0.0:
            distance *= 2.0
            if distance > FARTHEST:
                raise InputError(
                    f"{case.label(number)}: no displacement within {FARTHEST:g} mm unloads the "
                    'specimen; give between = "as-left"'
                )
        return float(x + direction * distance)

    # In one step of a second at first: the distance to zero force gives the time of the unloading.
    beyond = _other_side(start)
    if beyond == start:
        return state.model_copy(update={"zero": start})
    end = scipy.optimize.brentq(_force, start, beyond, xtol=1e-9)
    dt = max(abs(end - start) / UNLOADING / PIECES, 1e-3)
    # At the speed UNLOADING the force is zero at another displacement, since it depends on the rate
    # and on the path: the last step ends there.
    for piece in range(1, PIECES):
        element.set_trial(start + (end - start) * piece / PIECES, dt, ambient)
        element.commit()
    displacement = start + (end - start) * (PIECES - 1) / PIECES
    beyond = start + 2.0 * (end - start)
    if _force(displacement) * _force(beyond) > 0.0:  # a faster motion: the force is zero elsewhere
        beyond = _other_side(displacement)
    end = scipy.optimize.brentq(_force, displacement, beyond, xtol=1e-12)
    element.set_trial(end, dt, ambient)
    element.commit()
    end_state, has_lead = element.state, state.lead_temperature is not None
    lead_temperature = float(end_state.response[0].lead_temperature) if has_lead else float("nan")
    return specimen_state(
        end_state.temperature, lead_temperature, state_memory(end_state)
    ).model_copy(update={"zero": end})


def _run_part(case: Case | EarthquakeCase) -> tuple[Result | EarthquakeResult, SpecimenState]:
    if isinstance(case, Case):
        result = run_case(case)
        return result, final_state(result.dataset, case.ambient)
    (task,) = build_tasks(case)
    history = run_task(task)
    return label_analysis(case, [task], [history]), end_state_at(task, history)
