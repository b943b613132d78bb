"""A displacement-controlled test in the words and the table of a document."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from thermobearing.report.pieces import Column, ReportTable
from thermobearing.report.words import counted, joined, percent, quantity
from thermobearing.results.time_axis import duration

Step = Mapping[str, Any]
MOST_STEPS = 40  # rows of the table of a test


def words_of_test(test: Mapping[str, Any]) -> str:
    """What was done to the bearing, in a sentence without its end.

    Parameters
    ----------
    test : table of a resolved case.

    Examples
    --------
    >>> cycles = {"step": "cycles", "wave": "sine", "frequency": "0.5 Hz", "count": 11}
    >>> words_of_test({"name": "mine", "steps": [cycles | {"strain": 1.75}]})
    'mine: 11 cycles of 175 % shear strain (sine, 0.5 Hz)'
    """
    steps: Sequence[Step] = test["steps"]
    told = []
    for alike, group in groupby([s for s in steps if s["step"] != "rest"], key=_alike):
        same = list(group)
        told.append(_alike_words(alike, same))
    rests = [step for step in steps if step["step"] == "rest"]
    if rests and told:
        told.append(f"{counted(len(rests), 'rest')} ({_rest_words(rests)})")
    elif rests:
        told.append(f"rest ({_rest_words(rests)})")
    return f"{test.get('name', 'test')}: {joined(told)}"


def _alike(step: Step) -> tuple[str, ...]:
    """What steps have in common that are told together."""
    if step["step"] != "cycles":
        return (str(step["step"]),)
    return ("cycles", str(step["count"]), str(step["wave"]), _timing(step))


def _alike_words(alike: tuple[str, ...], steps: Sequence[Step]) -> str:
    if alike[0] == "cycles":
        sizes = [step.get("strain") for step in steps]
        if all(size is not None for size in sizes):
            shown = joined(f"{100.0 * float(size):g}" for size in sizes if size is not None)
            what = f"{shown} % shear strain"
        else:
            what = joined(_amplitude(step) for step in steps)
        each = " each" if len(steps) > 1 else ""
        count = counted(int(alike[1]), "cycle")
        return f"{count}{each} of {what} ({alike[2]}, {alike[3]})"
    if alike[0] == "ramp":
        return f"{counted(len(steps), 'ramp')} to {joined(_target(step) for step in steps)}"
    names = joined(_recording(step) for step in steps)
    return f"the recorded displacement of {names}"


def _timing(step: Step) -> str:
    for key, what in (("speed", "mean speed "), ("period", "period "), ("frequency", "")):
        if step.get(key) is not None:
            return f"{what}{quantity(step[key])}"
    return ""


def _amplitude(step: Step) -> str:
    if step.get("strain") is not None:
        return percent(float(step["strain"]))
    return quantity(step["amplitude"])


def _target(step: Step) -> str:
    if step.get("to_strain") is not None:
        return percent(float(step["to_strain"]))
    return quantity(step["to"])


def _recording(step: Step) -> str:
    return Path(str(step["file"])).name if step.get("file") else "a history given in Python"


def _rest_words(rests: Sequence[Step]) -> str:
    lasts = []
    for step in rests:
        if step.get("duration") is not None:
            lasts.append(duration(float(str(step["duration"]).split()[0])))
        else:
            lasts.append(f"until within {quantity(step['within'])} of the air")
    return joined(dict.fromkeys(lasts), "or")


def table_of_test(test: Mapping[str, Any]) -> ReportTable:
    """The steps of a test, one row each."""
    columns = (
        Column("Step", form="d"),
        Column("What"),
        Column("Size"),
        Column("Course"),
        Column("Cycles", form="d"),
        Column("Closing cycle"),
    )
    rows: list[tuple[Any, ...]] = []
    for place, step in enumerate(test["steps"][:MOST_STEPS], 1):
        kind = str(step["step"])
        closing = step.get("closing_strain")
        if kind == "cycles":
            course = f"{step['wave']}, {_timing(step)}"
            end = percent(float(closing)) if closing is not None else "none"
            rows.append((place, kind, _amplitude(step), course, int(step["count"]), end))
        elif kind == "ramp":
            course = quantity(step.get("speed") or step["duration"])
            rows.append((place, kind, _target(step), course, None, ""))
        elif kind == "rest":
            rows.append((place, kind, "", _rest_words([step]), None, ""))
        else:
            rows.append((place, kind, "", _recording(step), None, ""))
    left = len(test["steps"]) - len(rows)
    note = f"Largest time step {quantity(test['dt'])}. Sizes are shear strains of the total rubber "
    note += "thickness, or displacements."
    if left:
        note += f" {counted(left, 'more step')}: see case.resolved.toml."
    return ReportTable(f"Test: {test.get('name', 'test')}", columns, rows, note=note)
