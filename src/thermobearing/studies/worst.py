"""The worst runs of a study, each with the command that repeats it in full."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.studies.counted import OUTCOME, numbers
from thermobearing.studies.peaks import COMPLETED

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
    return found.assign(command=[repeat_command(directory, run) for run in some])


def repeat_command(directory: str | Path, run: int) -> str:
    """The command that carries out one run of a study again, with everything kept.

    Examples
    --------
    >>> repeat_command("out/p1", 12)
    'thermobearing study repeat out/p1 12 -o out/p1-run-12'
    """
    place = str(directory).rstrip("/")
    to = shlex.quote(f"{place}-run-{run}")
    return f"thermobearing study repeat {shlex.quote(place)} {run} -o {to}"
