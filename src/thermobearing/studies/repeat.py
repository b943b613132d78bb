"""One run of a study in full: its histories, loops and books, as `bridge` has them."""

from dataclasses import replace

from thermobearing.border.errors import InputError
from thermobearing.earthquake.label import label_study
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_task
from thermobearing.studies.designs import plan
from thermobearing.studies.prepare import Preparer
from thermobearing.studies.record import Study


def repeat_run(study: Study, run: int) -> EarthquakeResult:
    """Carry out one run of a study again; the same numbers, to the last bit or, of a study in
    lockstep, within rounding.

    Where the study has weather, the bearing begins as warm as in it; the case that the result tells
    of says the air of that hour only.

    Parameters
    ----------
    study : from `load_study`.
    run : its number in the plan.

    Returns
    -------
    EarthquakeResult

    Raises
    ------
    InputError : there is no such run.

    Examples
    --------
    >>> from thermobearing.studies.case import make_study
    >>> factors = {"bearing": "shen-bilinear-bridge", "motion": "jra-ii-i-1", "ambient": "0 degC"}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "2 s"}, "factors": factors}
    >>> repeat_run(make_study(table, "example"), 0).runs
    1
    """
    runs = plan(study)
    if not 0 <= run < len(runs):
        raise InputError(f"no run {run}; {study.name} has 0 to {len(runs) - 1}")
    row = runs.iloc[[run]].to_dict("records")[0]
    task = Preparer(study).run_input({str(key): value for key, value in row.items()}).task
    history = run_task(task)
    # What is kept of it says the scaled motion.
    motion = task.case.motions[0]
    scaled = motion.model_copy(update={"factor": motion.factor * float(row["scale"])})
    case = task.case.model_copy(update={"motions": [scaled]})
    return label_study(case, [replace(task, case=case)], [history])
