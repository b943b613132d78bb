"""Warnings about the validity of the result of a study."""

from contextlib import suppress
from typing import TYPE_CHECKING

from thermobearing.border.errors import InputError
from thermobearing.earthquake.measures import LARGEST_DAMPING_SHARE, damping_sentence
from thermobearing.quantities.warned import UNTESTED, UNUSABLE, Warned
from thermobearing.quantities.words import joined
from thermobearing.studies.curves import curve_warnings
from thermobearing.studies.definition.motions import study_notes
from thermobearing.studies.run.shard import DAMPING
from thermobearing.studies.statistics.variance import MATRIX, wide_note
from thermobearing.studies.tables import column_words

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult


def study_warnings(result: "StudyResult") -> list[str]:
    """Return warnings about the validity of a result."""
    messages: list[str] = []
    if result.incomplete:
        messages.append(Warned(result.incomplete, "incomplete", UNUSABLE))
    if result.failed:
        messages.append(Warned(result._failure_sentence(), "failed_runs", UNUSABLE))
    messages += [*result.beyond_ranges(), *curve_warnings(result), *_damping_warnings(result)]
    if result.has_variance and (lost := result.lost_demands()).many:
        sentence = f"shares of the variance: {lost.sentence}"
        messages.append(Warned(sentence, "variance_incomplete", UNUSABLE))
    if result._has_sobol_design and result.has_variance:
        with suppress(InputError):  # the demand is the same in all runs
            indices = result.variance(result.demand_name)
            indices["factor"] = indices["factor"].map(column_words)
            if wide := wide_note(indices):
                messages.append(Warned(wide, "wide_indices"))
    if MATRIX in result.table and not result._has_sobol_design:
        ratios = (
            "the shares of variance are correlation ratios, not Sobol' indices, which need "
            "one combination of levels (motion, bearing, structure, temperature): make a study "
            "of each"
        )
        messages.append(Warned(ratios, "correlation_ratios"))
    return messages + study_notes(result.study)


def _damping_warnings(result: "StudyResult") -> list[Warned]:
    """Return how much of the input energy viscous damping takes, if that is much in some runs."""
    if DAMPING not in result.table:  # a table of an earlier version, or of another origin
        return []
    case, levels = result.study.case, result.study.factors.structure.levels or []
    stated = case.analysis.damping
    kinds = [stated] if stated else dict.fromkeys(level.damping.kind for level in levels)
    shares = result.table[DAMPING].dropna().to_numpy(dtype=float)
    sentence = damping_sentence(shares, joined(map(str, kinds)))
    # The screen shows few warnings, and the ranges of two bearings would leave this one out.
    effect = UNTESTED + LARGEST_DAMPING_SHARE
    return [Warned(sentence, "viscous_damping", effect)] if sentence else []
