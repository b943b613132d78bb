"""Warnings of a calibration: misfit and its causes, weak parameters, and signals that are too poor.

Advice on further tests is given only where the tests do not have it already.
"""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.parameters import at_one_temperature
from thermobearing.identify.fit.problem import BLOCK_TURN, Problem
from thermobearing.identify.records.cycles import (
    SAME,
    estimate_noise,
    level_amplitudes,
    turning_points,
)
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.turns import describe_coarsest
from thermobearing.identify.uncertainty.evidence import (
    LARGEST_ERROR,
    MUCH,
    NEGLIGIBLE,
    Evidence,
    Uncertainty,
)
from thermobearing.identify.uncertainty.groups import CELLS, FORCE, OF_EACH_TEST
from thermobearing.quantities.governing import largest_by, place_of_largest
from thermobearing.quantities.words import number, percent

POOR = 0.1  # relative standard error of a poorly determined one
CORRELATED = 0.95
ALIKE = 0.2  # effective over actual samples, below which residuals are not noise
TEMPERATURE_SPAN = 15.0  # K between tests that fix a temperature coefficient
# Entropy stiffens warm rubber by T/T_0, a third in 100 K; no more.
ENTROPIC = 0.35
MOST_CAUSES = 3  # that are explained
MISFIT = "model and test differ by more than noise"  # a warning begins with it
SIGNALS = "{signals}"  # in a sentence, the words of `examined_signals`
CANNOT_TELL = (
    f"Possible causes of {SIGNALS}, one or several of them, which these tests do not distinguish, "
    "the most plausible first: "
)
SURELY = 3.0  # ... and by so many standard errors
ROUNDING = 1e-9  # a parameter nearer to zero is at it
SPEED_SPAN = 3.0  # ratio of speeds that fixes rate dependence
NOISY = 0.1  # of d_y: such noise changes the force after a reversal by a tenth of the strength
NONE_PLAUSIBLE = (
    f"No assumed value explains {SIGNALS} by a change of at most "
    f"{LARGEST_ERROR:g} usual errors: the description of the bearing (plan, number and thickness "
    "of the rubber layers) or the clock of the tests may be wrong"
)
LARGER = "Larger changes that would explain it: "
LIKELY = f"The likely cause of {SIGNALS}: "


def describe_weakness(problem: Problem, uncertainty: Uncertainty, d_y: float) -> list[str]:
    """Return warnings of bounds, weak and correlated parameters, and tests that are too similar.

    `d_y` [mm] is the yield displacement of a layer. Advice on tests names what these do not have,
    after the misfit where that has possible causes, which widen all intervals.
    """
    warnings, estimates = describe_similar_tests(problem), uncertainty.estimates
    advice = _Advice(problem, bool(uncertainty.causes))
    coefficients = [estimates[key] for key in (kinds.M_T, kinds.N_T) if key in estimates]
    # Rubber softens as it warms, but for entropic elasticity: a larger coefficient is a mistake.
    if coefficients and all(item.lower > ENTROPIC for item in coefficients):  # of no rubber
        values = " and ".join(f"{e.parameter.kind.symbol} = {e.value:.2f}" for e in coefficients)
        warnings.append(
            f"{values} describes a rubber that stiffens as it warms: are the ambient temperatures "
            "of the tests swapped?"
        )
    # Rates act on the steep branch after a turn, which the samples must resolve.
    coarse = describe_coarsest(problem.records, d_y, also_sharp=True)
    denser = {key: f"denser samples: {coarse}" for key in (kinds.K_V, kinds.C_V) if coarse}
    for item in estimates.values():
        kind = item.parameter.kind
        value = 0.0 if abs(item.value) < ROUNDING else item.value
        values = f"{kind.symbol} = {value:.3g} {kind.unit}".strip()
        remedy = advice.on(kind, also=denser.get(kind.key, ""))
        if not item.determined:
            warnings.append(
                f"{kind.symbol} cannot be determined from these tests: its value, "
                f"{f'{value:.3g} {kind.unit}'.strip()}, is {item.where}{remedy}"
            )
        elif item.relative_error > POOR:
            error = f"its standard error is {item.relative_error:.0%}"
            warnings.append(f"{values} is poorly determined, {error}{remedy}")
    for i, j in zip(*np.triu_indices(len(estimates), 1), strict=True):
        rho, pair = (
            float(uncertainty.correlation[i, j]),
            [list(estimates.values())[k] for k in (i, j)],
        )
        # Of determined parameters a correlation is no decision of the reader: a note lists it.
        vague = any(not item.determined or item.relative_error > POOR for item in pair)
        if abs(rho) > CORRELATED and vague:
            names = " and ".join(item.parameter.kind.symbol for item in pair)
            warnings.append(
                f"the tests determine {names} only in combination (correlation {rho:.2f})"
                f"{advice.on(*(item.parameter.kind for item in pair))}"
            )
    return warnings


def examined_signals(*, temperatures: bool) -> str:
    """Return the residuals that causes of a misfit explain; `temperatures` says what is fitted."""
    return f"the difference of {'force and temperatures' if temperatures else 'the force'}"


def describe_misfit(problem: Problem, uncertainty: Uncertainty) -> list[str]:
    """Return possible causes of residuals that are not noise, the least surprising first."""
    if uncertainty.rms <= NEGLIGIBLE:  # the model met the tests: there is no misfit to explain
        return []
    sentences = []
    suspects = uncertainty.causes
    if suspects:
        peak = max(record.peak_force for record in problem.records)
        causes = [
            _suspicion(
                item,
                problem.pset.base,
                peak,
                range_words(uncertainty.sizes(item), item.size[1]),
                explained=place < MOST_CAUSES,
            )
            for place, item in enumerate(suspects)
        ]
        words = LIKELY if len(suspects) == 1 else CANNOT_TELL
        if not suspects[0].plausible:
            words = f"{NONE_PLAUSIBLE}. {LARGER}"
        words = words.replace(SIGNALS, examined_signals(temperatures=problem.temperatures))
        sentences.append(f"{MISFIT}. {words}{'; '.join(causes)}")
    evidence = list(uncertainty.assumed.evidence)
    if at_one_temperature(record.ambient for record in problem.records):  # freeing needs more
        evidence = [item for item in evidence if item.group.keys[0] not in (kinds.M_T, kinds.N_T)]
    candidates = [
        item
        for item in evidence
        if (key := item.group.keys[0]) in kinds.KINDS or key.startswith(kinds.LAWS)
        if item.explained > MUCH and abs(item.sigmas) > SURELY * item.stderr
    ]
    if candidates:  # parameters whose freedom would remove much of the misfit
        worst = largest_by(candidates, lambda item: item.explained)
        name = worst.group.name
        free = [*(item.parameter.kind.symbol for item in uncertainty.estimates.values()), name]
        sentences.append(
            f"another {name} than that of the file would reduce the squared error of the force by "
            f"{worst.explained:.0%}: calibrate it too (--free {','.join(free)})"
        )
    if not sentences and uncertainty.effective_samples < ALIKE * uncertainty.samples:
        sentences.append(
            f"{MISFIT}, and none of the causes that were examined "
            "(assumed values, zeros, drift, delay, ambient temperatures) explains it alone. The "
            "model may lack an effect. The standard errors hold for this model only"
        )
    return sentences


def size_words(size: float, unit: str) -> str:
    """Return the size of a cause with its sign in two digits, without an exponent.

    >>> size_words(485.2, "%")
    '+490 %'
    """
    return f"{number(float(f'{size:.2g}'), '+g')} {unit}".rstrip()


def range_words(sizes: Sequence[float], unit: str) -> str:
    """Return the smallest and the largest size of a cause; one of them where they agree.

    >>> range_words((1.02, 1.32), "K")
    '+1 to +1.3 K'
    """
    smallest, largest = (size_words(size, unit) for size in sizes)
    if smallest == largest:
        return largest
    return f"{smallest.removesuffix(unit).rstrip()} to {largest}"


def start_words(difference: float) -> str:
    """Return by how much the thermocouples of a test begin above or below the model [K]."""
    state = "warmer" if difference > 0.0 else "colder"
    return f"its thermocouples begin {number(abs(difference), '.2g')} K {state} than the model"


def _suspicion(
    item: Evidence, bearing: Bearing, peak: float, sizes: str, *, explained: bool
) -> str:
    """Return a suspect with its `sizes`, and with what else it stands for where `explained`.

    `peak` is the largest force of the tests [kN].
    """
    key = item.group.key
    words = f"{item.group.name} off by {sizes}"
    if key in kinds.KINDS:
        value = kinds.dotted_value(bearing, key) or 0.0
        moved = item.group.moved(key, value, item.sigmas)
        words = f"{item.group.name} = {moved:.3g} instead of {value:.3g}"
    if key == CELLS:
        words = item.group.name
    elif key in OF_EACH_TEST:
        words = f"{item.group.name} of {sizes}"
    remarks = [] if item.plausible else [f"{number(abs(item.sigmas), '.3g')} usual errors"]
    if key == FORCE:
        remarks.append(f"{size_words(0.01 * item.size[0] * peak, 'kN')} at the peak")
    if item.group.measured is not None:
        remarks.append(start_words(item.group.measured))
    if item.cause and explained:
        remarks.append(item.cause)
    return f"{words} ({'; '.join(remarks)})" if remarks else words


def describe_signals(records: Sequence[TestRecord], d_y: float) -> list[str]:
    """Return warnings of displacements that are too noisy, or sampled too rarely, for intervals.

    Each kind is about its worst test. The scale is the displacement d_y [mm], within which the
    force changes after a reversal.
    """
    warnings = []
    too_narrow = "The 95 % intervals of s, d_y, K_v, c_v, G_e, h_eq and K_d are too narrow"
    noises = [estimate_noise(record.displacement) for record in records]
    worst = place_of_largest(noises)
    if noises[worst] > NOISY * d_y:
        warnings.append(
            f"{records[worst].name}: the noise of the displacement, {noises[worst]:.2g} mm, is "
            f"{percent(noises[worst] / d_y)} of d_y = {d_y:.3g} mm. {too_narrow}, because they "
            "contain no error of the displacement. Filter the displacement before it is sampled, "
            f"or measure it with a noise below {NOISY * d_y:.2g} mm"
        )
    if coarse := describe_coarsest(records, d_y):
        warnings.append(f"{coarse}. {too_narrow}")
    return warnings


def describe_similar_tests(problem: Problem) -> list[str]:
    """Return warnings of tests at too similar temperatures or speeds."""
    warnings = []
    free = {p.kind.key for p in problem.pset.free}
    ambients = [record.ambient for record in problem.records]
    low, high = min(ambients), max(ambients)
    if free & {kinds.M_T, kinds.N_T} and high - low < TEMPERATURE_SPAN:
        span = f"{low:.4g} to {high:.4g}" if high > low else f"{low:.4g}"
        warnings.append(
            f"m_T and n_T rest on tests at {span} degC only, mostly on self-heating. "
            f"{kinds.remedy(kinds.KINDS[kinds.M_T])}"
        )
    if free & {kinds.C_V, kinds.K_V}:
        speeds = _mean_speeds(problem.records)
        if speeds.max() < SPEED_SPAN * speeds.min():
            span = f"{speeds.min():.3g} to {speeds.max():.3g} mm/s"
            warnings.append(
                f"c_v and K_v rest on mean speeds of {span} only. "
                f"{kinds.remedy(kinds.KINDS[kinds.C_V])}"
            )
    return warnings


def _mean_speeds(records: Sequence[TestRecord]) -> Floats:
    """Return the mean speeds of large half cycles of all tests [mm/s]."""
    speeds = np.empty(0)
    for record in records:
        turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
        travel, time = np.abs(np.diff(record.displacement[turns])), np.diff(record.time[turns])
        # Small half cycles at the end of a block have other speeds and little force of their own.
        large = travel > 0.5 * travel.max()
        speeds = np.append(speeds, travel[large] / time[large])
    return speeds


class _Advice:
    """Advice on tests that would determine parameters, where the tests do not have them."""

    def __init__(self, problem: Problem, misfit: bool) -> None:
        """Take the tests of a problem; `misfit` says whether another cause comes first."""
        self._problem, self._misfit = problem, misfit

    def on(self, *parameters: kinds.Kind, also: str = "") -> str:
        """Return what to do about some parameters, to be added to a sentence; "" if nothing.

        `also` is more that would help.
        """
        group = kinds.remedy_group(*parameters)
        tests = "" if group in self._satisfied else kinds.remedy(*parameters)
        if also:
            tests = f"{tests}, and {also}" if tests else f"{also[:1].upper()}{also[1:]}"
        first = "Remove the misfit first" if self._misfit else ""
        return "".join(f". {sentence}" for sentence in (first, tests) if sentence)

    @cached_property
    def _satisfied(self) -> set[str]:
        """The groups of remedies whose tests are there already."""
        records, enough = self._problem.records, kinds.ENOUGH
        ambients = [record.ambient for record in records]
        rubber = self._problem.pset.base.total_rubber_thickness
        amplitudes = [size for record in records for size in level_amplitudes(record).values()]
        satisfied = {"temperature": max(ambients) - min(ambients) >= enough.temperature}
        if amplitudes:
            least, largest = min(amplitudes), max(amplitudes)
            several = largest / least - 1.0 > SAME
            satisfied |= {
                "amplitudes": several,
                "hardening": several and 100.0 * largest / rubber >= enough.hardening,
                "lead": 100.0 * least / rubber < enough.lead,
            }
            speeds = _mean_speeds(records)
            satisfied["rate"] = bool(speeds.max() >= enough.rate * speeds.min())
        return {group for group, is_met in satisfied.items() if is_met}
