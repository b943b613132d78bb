"""Fragility curves of a study: which runs they are of, and what makes them unusable."""

from contextlib import suppress
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.quantities.warned import UNUSABLE, Warned
from thermobearing.quantities.words import joined, number
from thermobearing.studies.definition.designs import AMBIENT
from thermobearing.studies.statistics.demand import TREATMENTS, Failed
from thermobearing.studies.statistics.fragility import Fragility

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult

Temperature: TypeAlias = float | Literal["pooled"] | None
MOST_NAMED = 8  # temperatures in a message


def temperature_words(name: Any) -> str:
    """Return the name of a curve in words: "−20 °C", or "climate"."""
    return f"{number(float(name))} °C" if isinstance(name, int | float) else str(name)


def has_curves(result: "StudyResult") -> bool:
    """Return whether there are fragility curves: several intensities and a capacity."""
    return result.question.capacity is not None and result.table[result.intensity].nunique() > 1


def at_temperature(result: "StudyResult", temperature: Temperature) -> "StudyResult":
    """Return the runs at a temperature; InputError for several levels of which none is named.

    Temperatures that are drawn are a sample, whose curve is that over all temperatures.
    """
    levels = np.unique(result.table[AMBIENT]).tolist()
    factor = result.study.factors.ambient
    if temperature == "pooled" or (temperature is None and len(levels) < 2):
        return result
    if temperature is None and (factor.levels is None or factor.random):
        return result
    choices = f"temperature = {' or '.join(f'{level:g}' for level in levels[:MOST_NAMED])}"
    if temperature is None:
        raise InputError(
            f"the curve would mix {len(levels)} temperatures: give {choices} (degC), "
            '"pooled" for a curve of all runs together, or use `fragilities` for all of them'
        )
    if temperature not in levels:
        raise InputError(f"no run has temperature = {temperature:g}: give {choices} (degC)")
    return result.select(**{AMBIENT: temperature})


def other_medians(result: "StudyResult") -> dict[Any, dict[Failed, float]]:
    """Return the medians with the other treatments of failed runs, by curve and treatment.

    Those of a curve are stated if one of them differs by more than 2 % from its own. Failed
    runs are not like the others: piers fail in the cold, where bearings are stiff. A median
    beyond the intensities of the runs is no number to compare.
    """
    if not result.failed:
        return {}
    curves, medians = result.all_curves(), dict[Any, dict[Failed, float]]()
    for treatment in TREATMENTS:
        if treatment == result.question.failed:
            continue
        changed = result.question.model_copy(update={"failed": treatment})
        others = type(result)(
            result.table, result.study, result.manifest, result.directory, changed
        )
        other_curves = {}
        with suppress(InputError):  # too few runs are left for a regression
            other_curves = others.all_curves()
        for name in curves:
            median = other_curves[name].stated_median if name in other_curves else np.nan
            medians.setdefault(name, {})[treatment] = median
    return {
        name: others
        for name, others in medians.items()
        if any(curves[name].differs_from(median) for median in others.values())
    }


def curve_warnings(result: "StudyResult") -> list[str]:
    """Return which fragility curves contradict their runs, or have intensities too far apart."""
    curves: dict[str, Fragility] = {}
    for part, runs in result.parts().items() if has_curves(result) else ():
        with suppress(InputError):  # no run of this part has a number
            for name, curve in runs.all_curves().items():
                curves[" at ".join(filter(None, (part, temperature_words(name))))] = curve
    faults = {
        "curve_contradicted": {name: curve.misfit for name, curve in curves.items()},
        "coarse_intensities": {name: curve.coarse for name, curve in curves.items()},
    }
    messages: list[str] = []
    for code, sentences in faults.items():
        names = [name for name, sentence in sentences.items() if sentence]
        if names:
            others = f"; so do {joined(names[1:])}" if names[1:] else ""
            messages.append(Warned(f"{sentences[names[0]]}{others}", code, UNUSABLE, names[0]))
    return messages
