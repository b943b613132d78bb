"""The worst runs of a study, and how to repeat them."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.earthquake.dataset import label_study
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_task
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.demand_parameters import COMPLETED
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.statistics.failed_runs import OUTCOME, numbers

RANKED = ("pier_ductility", "pier_displacement_max_mm", "bearing_displacement_max_mm")
WORST = 10


def ranked_by(table: pd.DataFrame) -> str:
    """What runs are ranked by: ductility of the pier; without a hinge its displacement, without a
    pier that of the bearing.
    """
    found = [name for name in RANKED if name in table and table[name].notna().any()]
    if not found:
        raise InputError(f"what are runs to be ranked by? None of {', '.join(RANKED)} is there")
    return found[0]


def worst_runs(table: pd.DataFrame, count: int = WORST, by: str | None = None) -> list[int]:
    """Numbers of the runs with the largest demand, the worst first.

    Parameters
    ----------
    table : of runs; failed ones have not come to their end, and are left out.
    count : how many.
    by : column that is ranked; by default ductility of the pier, or what there is instead.

    Raises
    ------
    InputError : no such column.

    Examples
    --------
    >>> runs = {"run": [0, 1, 2], "outcome": ["completed", "diverged", "completed"]}
    >>> worst_runs(pd.DataFrame(runs | {"pier_ductility": [0.5, 9.0, 1.5]}), 1)
    [2]
    """
    whole = table[table[OUTCOME] == COMPLETED]
    if len(whole) == 0:
        return []
    name = by or ranked_by(whole)
    order = pd.Series(numbers(whole, name), index=whole.index)
    return [
        int(k) for k in whole.loc[order.sort_values(ascending=False, kind="stable").index, "run"]
    ][:count]


def worst_table(
    table: pd.DataFrame,
    directory: str | Path,
    factors: Sequence[str],
    count: int = WORST,
    by: str | None = None,
) -> pd.DataFrame:
    """The worst runs, and the first run of each way to fail, with the command to repeat each.

    Parameters
    ----------
    table : of runs.
    directory : of the study.
    factors : columns that say what went into a run.
    count : how many of the worst.
    by : as of `worst_runs`.

    Returns
    -------
    DataFrame : `run`, `id`, `outcome`, the factors, the demand, `command`.
    """
    some = worst_runs(table, count, by)
    failed = table[table[OUTCOME] != COMPLETED]
    some += [int(run) for run in failed.groupby(OUTCOME, sort=True, observed=True)["run"].min()]
    demand = by or ranked_by(table)
    columns = ["run", "id", OUTCOME, *factors, demand]
    found = table.set_index("run", drop=False).loc[some, columns].reset_index(drop=True)
    return found.assign(command=[_repeat_command(directory, run) for run in some])


def _repeat_command(directory: str | Path, run: int) -> str:
    """The command that carries out one run of a study again, with everything kept.

    Examples
    --------
    >>> _repeat_command("out/p1", 12)
    'thermobearing study repeat out/p1 12 -o out/p1-run-12'
    """
    place = str(directory).rstrip("/")
    to = shlex.quote(f"{place}-run-{run}")
    return f"thermobearing study repeat {shlex.quote(place)} {run} -o {to}"


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
    >>> from thermobearing.studies.definition.case import make_study
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
