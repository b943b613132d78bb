"""The story of a sequence: each part is a case of its own, begun where the one before ended."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from thermobearing.border.errors import InputError
from thermobearing.border.overrides import check_workers
from thermobearing.cyclic.case import Case
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run_case
from thermobearing.cyclic.start import final_state
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.ends import end_of
from thermobearing.earthquake.label import label_study
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.model.handover import SpecimenState
from thermobearing.sequences.case import SequenceCase, load_sequence_case, make_sequence_case
from thermobearing.sequences.result import SequenceResult

Progress = Callable[[int, int], None]


def sequence(
    case: SequenceCase | str | Path | dict[str, Any],
    *,
    progress: Progress | None = None,
    **overrides: Any,
) -> SequenceResult:
    """Tests one after the other on one specimen: hybrid, cyclic, rests between.

    Parameters
    ----------
    case : a case file, a table such as that of a file (every number says its unit), or a case.
    progress : called with (parts done, all parts).
    overrides : values that replace those of a file or table, by key: `bearing`, `ambient` [degC],
        `rig`, and every key of `analysis`.

    Returns
    -------
    SequenceResult

    Raises
    ------
    InputError : anything that cannot be used, named with what is allowed.

    Examples
    --------
    >>> cycles = {"step": "cycles", "strain": 0.5, "speed": "30 mm/s", "count": 1}
    >>> parts = [{"part": "cyclic", "steps": [cycles]}, {"part": "hybrid", "duration": "2 s"}]
    >>> result = sequence({"parts": parts, "ambient": "-20 degC"})
    >>> list(result.table["kind"]), result.outcome
    (['cyclic', 'hybrid'], 'completed')
    """
    if isinstance(case, str | Path):
        case = load_sequence_case(case, **overrides)
    elif isinstance(case, dict):
        case = make_sequence_case(case, "sequence()", **overrides)
    elif not isinstance(case, SequenceCase):
        raise InputError("needs a file, a table or a SequenceCase", "sequence()")
    elif overrides:
        raise InputError("a finished case takes no further values", "sequence()")
    return run_sequence(case, progress=progress)


def run_sequence(case: SequenceCase, *, progress: Progress | None = None) -> SequenceResult:
    """Carry out a sequence; a part that ends early is the last (see `SequenceResult.outcome`).

    Parameters
    ----------
    case : from `load_sequence_case` or `make_sequence_case`.
    progress : called with (parts done, all parts).

    Returns
    -------
    SequenceResult

    Examples
    --------
    >>> rest = {"parts": [{"part": "rest", "duration": "1 h"}]}
    >>> run_sequence(make_sequence_case(rest, "example")).outcome
    'completed'
    """
    check_workers("run_sequence()", progress=progress)
    found: list[Result | EarthquakeResult] = []
    state: SpecimenState | None = None
    interrupted = False
    try:
        for number in range(len(case.parts)):
            result, state = _run_part(case.whole_part(number, state))
            found.append(result)
            if progress:
                progress(number + 1, len(case.parts))
            if result.outcome != "completed":
                break
    except KeyboardInterrupt:
        interrupted = True
    return SequenceResult(case, found, interrupted=interrupted)


def _run_part(case: Case | EarthquakeCase) -> tuple[Result | EarthquakeResult, SpecimenState]:
    """What a part leaves behind, and where the specimen is then."""
    if isinstance(case, Case):
        result = run_case(case)
        return result, final_state(result.dataset, case.ambient)
    (task,) = build_tasks(case)
    history = run_task(task)
    return label_study(case, [task], [history]), end_of(task, history)
