"""Estimate of the effort of an analysis, so that excessive ones are rejected before they start."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

MAX_STEPS = 20_000_000  # of all runs of an analysis
# A step takes time in proportion to the cells of the stack, some 0.02 us each: half a minute.
MAX_CELL_STEPS = 1.5e9
MAX_ANALYSIS = 2e10  # likewise for all runs of an analysis, in parallel: some minutes
# Analyses that keep all histories.
MOST_OF = {"bearings": 100, "motions": 1000, "ambient": 1000}
MAX_KEPT = 5e8  # numbers in the histories of a result: 4 GB


def too_much(steps: float, cells: int, kept: float) -> list[str]:
    """Return why an analysis would take too much time or memory, and what to change.

    `steps`: of all runs together; `kept`: numbers in all rows that are kept.
    """
    change = "use a larger dt, fewer ambient temperatures"
    if steps > MAX_STEPS:
        return [f"needs {steps:.3g} steps; the limit is {MAX_STEPS}: {change}"]
    if steps * cells > MAX_CELL_STEPS:
        return [
            f"needs {steps:.3g} steps of {cells} cells, {steps * cells:.3g} cell steps; the "
            f"limit is {MAX_CELL_STEPS:.3g}: {change} or fewer cells"
        ]
    if kept > MAX_KEPT:
        return [
            f"stores {kept:.3g} numbers; the limit is {MAX_KEPT:.3g}: make keep_every "
            f"{math.ceil(kept / MAX_KEPT)} times as large, or store fewer histories"
        ]
    return []


def analysis_too_much(runs: Sequence[tuple[float, float, float]]) -> list[str]:
    """Return the same for an analysis of several runs.

    `runs` has of each its steps, and the cells and kept numbers of one step.
    """
    change = (
        "use a larger dt or shorten the motions (duration); for very many runs use `thermobearing "
        "study`, which does not store histories"
    )
    longest = max(steps for steps, _, _ in runs)
    work = sum(steps * cells for steps, cells, _ in runs)
    kept = sum(steps * numbers for steps, _, numbers in runs)
    if longest > MAX_STEPS:
        return [f"a run needs {longest:.3g} steps; the limit is {MAX_STEPS}: {change}"]
    if work > MAX_ANALYSIS:
        return [f"needs {work:.3g} cell steps; the limit is {MAX_ANALYSIS:.3g}: {change}"]
    if kept > MAX_KEPT:
        return [f"stores {kept:.3g} numbers; the limit is {MAX_KEPT:.3g}: {change}"]
    return []


def too_many(table: Mapping[str, Any]) -> list[str]:
    """Return errors for lists of a case that are too long for a result with all histories.

    >>> too_many({"ambient": [0.0] * 36})
    []
    """
    return [
        f"{key}: {len(table[key])} entries; at most {limit}, since the histories of all runs are "
        "stored; for very many runs use `thermobearing study`, which does not store them"
        for key, limit in MOST_OF.items()
        if isinstance(table.get(key), list | tuple) and len(table[key]) > limit
    ]
