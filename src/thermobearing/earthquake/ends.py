"""Where the runs of a study left their bearings: what another test can go on from."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.model.handover import (
    MEMORY,
    OF_LOOPS,
    PREFIX,
    SpecimenState,
    attributes_of,
    dimension_of,
    memory_of,
    specimen_state,
)
from thermobearing.structure.run import StructureHistory

if TYPE_CHECKING:
    from thermobearing.earthquake.task import Task

ENDS = {  # temperatures at the end
    "final_temperature": {"units": "degC", "long_name": "temperature of the cell at the end"},
    "final_lead_temperature": {"units": "degC", "long_name": "temperature of the lead at the end"},
}


def end_of(task: "Task", history: StructureHistory) -> SpecimenState:
    """Where the bearing of the first line is at the end of a run; not a bilinear one.

    Parameters
    ----------
    task, history : a run, and what came of it.

    Returns
    -------
    SpecimenState
    """
    end, cored = history.end(), task.device.constants.lead.cores > 0.0
    lead = end.books[0].lead_temperature if cored else float("nan")
    return specimen_state(end.temperature, lead, memory_of(end))


def labelled_ends(tasks: Sequence["Task"], histories: Sequence[StructureHistory]) -> dict[str, Any]:
    """The ends of all runs for a dataset, as in those of cyclic tests, filled up with NaN.

    Nothing where the structure has several bearing lines, which end each elsewhere.
    """
    warm = [task.device.stack is not None for task in tasks]
    if not any(warm) or len(tasks[0].case.structure.bearings) > 1:
        return {}
    ends: list[dict[str, Any]] = []
    for task, history, has_heat in zip(tasks, histories, warm, strict=True):
        end, cored = history.end(), task.device.constants.lead.cores > 0.0
        lead = end.books[0].lead_temperature if cored else np.nan
        found = {"final_temperature": end.temperature, "final_lead_temperature": lead}
        ends.append(found | memory_of(end) if has_heat else {})
    dims = {"final_temperature": "cell", "final_lead_temperature": None}
    memory = [*MEMORY, *(key for key in OF_LOOPS if any(key in end for end in ends))]
    dims |= {key: dimension_of(key) for key in memory}
    data: dict[str, Any] = {}
    for key, dimension in dims.items():
        parts = [np.atleast_1d(end.get(key, np.nan)) for end in ends]
        whole = np.full((len(parts), max(len(part) for part in parts)), np.nan)
        for row, part in zip(whole, parts, strict=True):
            row[: len(part)] = part
        name, about = (PREFIX + key, attributes_of(key)) if key in memory else (key, ENDS[key])
        if dimension is None:
            data[name] = (("run",), whole[:, 0], about)
        elif whole.size:
            data[name] = (("run", dimension), whole, about)
    return data
