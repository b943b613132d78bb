"""How much an analysis is, known before it starts: what is too much is refused."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

MAX_STEPS = 20_000_000  # of all runs of an analysis
# A step takes time in proportion to the cells of the stack, some 0.02 us each: half a minute.
MAX_CELL_STEPS = 1.5e9
MAX_ANALYSIS = 2e10  # the same of all runs of an analysis, which share the processors: some minutes
# Of an analysis whose histories are all kept.
MOST_OF = {"bearings": 100, "motions": 1000, "ambient": 1000}
MAX_KEPT = 5e8  # numbers in the histories of a result: 4 GB


def too_much(steps: float, cells: int, kept: float) -> list[str]:
    """What keeps an analysis from being done in bearable time and memory, and what to change.

    `steps`: of all runs together; `kept`: numbers in all rows that are kept.
    """
    change = "take a larger dt, fewer ambient temperatures"
    if steps > MAX_STEPS:
        return [f"makes {steps:.3g} steps in all; at most {MAX_STEPS} can be done: {change}"]
    if steps * cells > MAX_CELL_STEPS:
        return [
            f"makes {steps:.3g} steps of {cells} cells, {steps * cells:.3g} steps of a cell; at "
            f"most {MAX_CELL_STEPS:.3g} can be done: {change} or fewer cells"
        ]
    if kept > MAX_KEPT:
        return [
            f"keeps {kept:.3g} numbers; at most {MAX_KEPT:.3g} can be kept: give a keep_every "
            f"{math.ceil(kept / MAX_KEPT)} times as large, or keep fewer histories"
        ]
    return []


def analysis_too_much(runs: Sequence[tuple[float, float, float]]) -> list[str]:
    """Return the same for an analysis of several runs.

    `runs` has of each its steps, and the cells and kept numbers of one step.
    """
    change = (
        "take a larger dt or cut the motions (duration); very many runs are for `thermobearing "
        "study`, which forgets their histories"
    )
    longest = max(steps for steps, _, _ in runs)
    work = sum(steps * cells for steps, cells, _ in runs)
    kept = sum(steps * numbers for steps, _, numbers in runs)
    if longest > MAX_STEPS:
        return [f"a run makes {longest:.3g} steps; at most {MAX_STEPS} can be done: {change}"]
    if work > MAX_ANALYSIS:
        return [
            f"makes {work:.3g} steps of a cell; at most {MAX_ANALYSIS:.3g} can be done: {change}"
        ]
    if kept > MAX_KEPT:
        return [f"keeps {kept:.3g} numbers; at most {MAX_KEPT:.3g} can be kept: {change}"]
    return []


def too_many(table: Mapping[str, Any]) -> list[str]:
    """Lists of a case that are longer than a result with all histories can be of.

    >>> too_many({"ambient": [0.0] * 36})
    []
    """
    return [
        f"{key}: {len(table[key])} of them; at most {most}, since the histories of all runs are "
        "kept; very many runs are for `thermobearing study`, which forgets them"
        for key, most in MOST_OF.items()
        if isinstance(table.get(key), list | tuple) and len(table[key]) > most
    ]
