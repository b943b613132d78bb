"""Uncertainty of calibrated parameters from the tests and from the values that are assumed.

Each number that is not identified has a standard uncertainty (data/identify/assumed.toml). The
columns of derivatives by them propagate it to the calibrated ones, and show when the tests require
another value than that in the file. The covariance by the tests is that of problem.py; both add up.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.parameters import Parameter, at_one_temperature
from thermobearing.identify.fit.problem import AT_BOUND, BLOCK_TURN, Linear, Problem, linearise
from thermobearing.identify.records.cycles import estimate_noise, turning_points
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.turns import describe_coarsest
from thermobearing.identify.uncertainty.groups import (
    AMBIENT,
    CELLS,
    CONDITIONING,
    DELAY,
    FORCE,
    NORMAL_FREEDOM,
    OF_EACH_TEST,
    Group,
    chosen_groups,
    groups_of_tests,
    half_interval,
    moved_record,
    shift,
    widening,
)
from thermobearing.quantities.governing import (
    largest_by,
    order_from_largest,
    place_of_largest,
)
from thermobearing.quantities.words import percent

PART = 0.25  # of a standard uncertainty: the step of a derivative
SURE, BEYOND = 5.0, 3.0  # standard errors of the tests, of tests and source together
CLEAR = 2.0  # standard errors between a determined number and its bounds
UNSEEN = 1e-3  # of the variance: numbers that move the residuals less are not seen by the tests
WELL = 0.01  # relative standard error of a well determined parameter: three are within 3 %
OPEN = 0.5  # of the range of the search: the interval of a parameter that the tests leave open
NEAR_BOUND = 0.05  # of the range of the search: nearer to a bound no parameter is determined
POOR = 0.1  # relative standard error of a poorly determined one
LEAST = 0.1  # m_T, n_T, b and s may be zero: errors are relative to this at least
CORRELATED = 0.95
NEGLIGIBLE = 1e-3  # of the peak force: smaller residuals are no matter for a warning
ALIKE = 0.2  # effective over actual samples, below which residuals are not noise
TEMPERATURE_SPAN = 15.0  # K between tests that fix a temperature coefficient
# Entropy stiffens warm rubber by T/T_0, a third in 100 K; no more.
ENTROPIC = 0.35
MOST_CAUSES = 3  # that are named
MISFIT = "model and test differ by more than noise"  # a warning begins with it
CANNOT_TELL = "Possible causes, which these tests do not distinguish, the most plausible first: "
MILLI = 1e3  # ms in a second
MAIN = 0.2  # of the squared residuals: what a mistake of a usual size explains to be a suspect
LAST = 1e6  # standard uncertainties: more than any that is wanted
TENFOLD = 10.0
AS_LIKELY = 0.7  # of what the likeliest cause explains
MUCH = 0.1  # of the squared misfit, which one more free parameter would take away ...
SURELY = 3.0  # ... and by so many standard errors
ROUNDING = 1e-9  # a parameter nearer to zero is at it
SPEED_SPAN = 3.0  # ratio of speeds that fixes rate dependence
NOISY = 0.1  # of d_y: such noise changes the force after a reversal by a tenth of the strength


class Assumed(NamedTuple):
    """Numbers that a calibration does not identify."""

    groups: tuple[Group, ...]  # of the bearing, not free and not known exactly
    columns: Floats  # [residual, group] change by one standard uncertainty


def _assumed_groups(
    bearing: Bearing, identified: Sequence[str], groups: Sequence[Group]
) -> list[Group]:
    """Return the groups that a calibration assumes: neither identified nor exact nor zero."""
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    assumed, without = [], {*identified, *kinds.replaced_by_laws(bearing)}
    for group in groups:
        if group.mistake:
            continue
        keys = [key for key in group.keys if key not in without]
        if linear:
            keys = [key for key in keys if key not in kinds.OF_YIELDING]
        values = [kinds.dotted_value(bearing, key) for key in keys]
        if any(value is not None and group.step(value) > 0.0 for value in values):
            assumed.append(group.model_copy(update={"keys": keys}))
    return assumed


def linearise_assumed(
    problem: Problem, cube: Floats, groups: Sequence[Group], *, fine: bool = True
) -> Assumed:
    """Return the assumed numbers of a fit and the derivatives of its residuals by them."""
    identified = [p.kind.key for p in problem.pset.parameters if p.free or p.tie is not None]
    bearing = problem.pset.bearing(cube)
    residuals = np.concatenate(problem.parts(cube, fine=fine))
    # A derivative by finite differences: a part of a standard uncertainty for numbers of the
    # bearing, in which the model is not linear; a complete one for those of the tests.
    assumed, columns = [], []

    def _add(group: Group, part: float) -> None:
        moved = moved_parts(problem, bearing, [(group, part)], fine=fine)
        column = (
            np.zeros(len(residuals))
            if moved is None
            else (np.concatenate(moved) - residuals) / part
        )
        assumed.append(group)
        columns.append(column)

    for group in _assumed_groups(bearing, identified, groups):
        _add(group, PART)
    uncertain = [group for group in groups if not group.mistake]
    for group in groups_of_tests(problem.records, uncertain):
        _add(group, 1.0)
    shape = (len(residuals), len(assumed))
    return Assumed(tuple(assumed), np.array(columns).T if columns else np.zeros(shape))


def moved_parts(
    problem: Problem, bearing: Bearing, changes: Sequence[tuple[Group, float]], *, fine: bool = True
) -> list[Floats] | None:
    """Return the residuals with assumed groups changed by so many standard uncertainties.

    None if the model ends early.
    """
    records, delay = problem.records, 0.0
    for group, sigmas in changes:
        if group.key == DELAY:
            delay += sigmas * group.step(1.0) / MILLI
        elif group.of_tests:
            records = [moved_record(record, group, sigmas) for record in records]
        else:
            bearing = shift(bearing, group, sigmas)
    return problem.split_parts(bearing, records, fine=fine, delay=delay)


@dataclass(frozen=True)
class Evidence:
    """Evidence of the tests on one group, with the others as in the file."""

    group: Group
    sigmas: float  # wanted change of the file's values, in standard uncertainties
    stderr: float  # of `sigmas`, by the tests
    # Share of the squared residuals that this would remove, at most 1; negative where more heat
    # cells, whose effect is not scaled, would add to them.
    explained: float
    # [residual, 1 or test] change by one standard uncertainty that no parameter can imitate.
    columns: Floats = field(default_factory=lambda: np.zeros((0, 0)), repr=False, compare=False)
    imitated: bool = False  # with a possible cause of the misfit, the tests require no such change

    @property
    def contradicted(self) -> bool:
        """Whether the tests show that the values of the file are outside their uncertainty.

        A value that moves only because model and test differ by another cause is not contradicted.
        """
        return self.beyond and not self.imitated

    @property
    def beyond(self) -> bool:
        """Whether tests require a value beyond its uncertainty, all others as in the file."""
        change = abs(self.sigmas)
        return change > SURE * self.stderr and change > BEYOND * float(np.hypot(1.0, self.stderr))

    @property
    def is_main_mistake(self) -> bool:
        """Whether it is no assumed value, and would remove much of the squared residuals."""
        return self.group.mistake and self.explained > MAIN

    @property
    def conceivable(self) -> bool:
        """Whether the tests require less than a tenfold value, which no mistake explains.

        More heat cells are in one direction, and a cause only where they take a notable share
        of the squared residuals away.
        """
        if self.group.key == CELLS:
            return self.sigmas > 0.0 and self.explained > MUCH
        return abs(self.sigmas) * (self.group.relative or 0.0) < math.log(TENFOLD)

    @property
    def size(self) -> tuple[float, str]:
        """The change that the tests require, and its unit: that of the key, or %."""
        if self.group.absolute is not None:
            return self.sigmas * self.group.absolute, self.group.unit
        return 100.0 * float(np.expm1(self.sigmas * (self.group.relative or 0.0))), "%"

    def suspicion(self) -> dict[str, Any]:
        """Return the content of summary.json about the group as a suspect."""
        size, unit = self.size
        return {
            "name": self.group.name,
            "key": self.group.keys[0],
            "ambient_degC": self.group.at,
            "size": size,
            "unit": unit,
            "explained": self.explained,
        }

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the group."""
        return {
            "name": self.group.name,
            "keys": self.group.keys,
            "relative_uncertainty": self.group.relative,
            "absolute_uncertainty": self.group.absolute,
            "unit": self.group.unit,
            "source": ", ".join(filter(None, (self.group.source, self.group.note))),
            "tests_ask_for_sigmas": self.sigmas,
            "stderr_of_that": self.stderr if np.isfinite(self.stderr) else None,
            "contradicted": self.contradicted,
            "imitated": self.imitated,
        }


@dataclass(frozen=True)
class Propagated:
    """Effect of the uncertainty of the assumed numbers on the identified ones."""

    evidence: tuple[Evidence, ...]  # what the tests say about each group
    shifts: Floats  # [parameter, group] of the optimum by one standard uncertainty
    spread: Floats  # [group, group] mean square of the errors of the groups, given the tests

    @property
    def groups(self) -> tuple[Group, ...]:
        """The groups, in the order of the columns."""
        return tuple(item.group for item in self.evidence)

    @property
    def widening(self) -> Floats:
        """The factors on the uncertainty of each group, for intervals and draws."""
        return np.array([group.widening for group in self.groups])

    def _covariance(self, factors: Floats | float = 1.0) -> Floats:
        """Return the covariance of the parameters; `factors` multiply the uncertainty of groups."""
        shifts = self.shifts * factors
        return np.asarray(shifts @ self.spread @ shifts.T)


def _propagate(linear: Linear, assumed: Assumed) -> Propagated:
    """Propagate the uncertainty of the assumed numbers to the calibrated ones.

    The optimum moves by -(J^T J)^-1 J^T c for a column c (a "consider" analysis; Schmidt 1966).
    The error of the groups is the uncertainty of their sources given the tests: with the
    information H of the tests and b = H times the change that they require, the posterior of a
    normal prior has the covariance P = (1 + H)^-1 and the mean P b. The calibration keeps the
    values of the file, so that its error contains both.
    """
    columns = linear.weights[:, None] * assumed.columns
    shifts = -linear.solved(columns)
    unexplained = columns + linear.jacobian @ shifts  # what no change of the parameters can imitate
    evidence = [
        _weigh(linear, group, unexplained[:, [i]]) for i, group in enumerate(assumed.groups)
    ]
    inner = unexplained.T @ unexplained
    required = -np.linalg.pinv(inner, rcond=1e-10, hermitian=True) @ (
        unexplained.T @ linear.residuals
    )
    left_over = linear.residuals + unexplained @ required
    meat = linear.meat(unexplained, left_over) + np.diag(np.diag(inner)) * np.mean(left_over**2)
    inverse_meat = np.linalg.pinv(meat, rcond=1e-10, hermitian=True)
    # By eigenvalues: exact tests know nearly everything, and an inverse would not stay positive.
    information, axes = np.linalg.eigh(inner @ inverse_meat @ inner)
    information = np.maximum(information, 0.0)
    posterior = (axes / (1.0 + information)) @ axes.T
    mean = axes @ (information / (1.0 + information) * (axes.T @ required))
    return Propagated(tuple(evidence), shifts, posterior + np.outer(mean, mean))


def _weigh(
    linear: Linear, group: Group, columns: Floats, residuals: Floats | None = None
) -> Evidence:
    """Return the evidence on a group from the part of its columns that no parameter can imitate.

    `columns` has one column, or one for each test; then the largest change is that of the group.
    `residuals` are those of the fit by default.
    """
    residuals = linear.residuals if residuals is None else residuals
    inner = columns.T @ columns
    if float(np.trace(inner)) <= UNSEEN * max(linear.variance, 1e-300):
        return Evidence(group, 0.0, float("inf"), 0.0, columns)
    bread = np.linalg.pinv(inner, rcond=1e-10, hermitian=True)
    sigmas = -bread @ (columns.T @ residuals)
    left_over = residuals + columns @ sigmas  # or the error of the file would be taken for noise
    variance = bread @ linear.meat(columns, left_over) @ bread
    smallest = bread * float(left_over @ left_over) / len(left_over)
    removed = float(sigmas @ inner @ sigmas)
    if group.key == CELLS:  # whole numbers: what the finer calculation itself removes
        removed = float(-np.sum(2.0 * (columns.T @ residuals) + np.diag(inner)))
    explained = removed / max(float(residuals @ residuals), 1e-300)
    k = place_of_largest(np.abs(sigmas))
    stderr = float(np.sqrt(max(variance[k, k], smallest[k, k])))
    return Evidence(group, float(sigmas[k]), stderr, explained, columns)


def _with_imitations(linear: Linear, uncertainty: "Uncertainty") -> "Uncertainty":
    """Return the uncertainty whose evidence knows which changes a cause of the misfit imitates."""
    causes = uncertainty.suspects

    def _with_cause_free(item: Evidence, cause: Evidence) -> Evidence:
        """Return the evidence on a group with the values of a cause free as well."""
        both = np.column_stack([item.columns, linear.residuals])
        part = both - cause.columns @ np.linalg.lstsq(cause.columns, both, rcond=None)[0]
        return _weigh(linear, item.group, part[:, :-1], part[:, -1])

    evidence = tuple(
        replace(item, imitated=not all(_with_cause_free(item, cause).beyond for cause in others))
        if item.beyond and (others := [c for c in causes if c.group != item.group])
        else item
        for item in uncertainty.assumed.evidence
    )
    return replace(uncertainty, assumed=replace(uncertainty.assumed, evidence=evidence))


def _weigh_mistakes(
    problem: Problem, cube: Floats, groups: Sequence[Group], linear: Linear
) -> tuple[Evidence, ...]:
    """Return the evidence of the tests on mistakes that a calibration does not assume."""
    bearing, residuals = problem.pset.bearing(cube), np.concatenate(problem.parts(cube, fine=True))
    mistakes = [item for item in groups if item.mistake]
    evidence = []
    for group in [*groups_of_tests(problem.records, mistakes), *_of_bearing(mistakes)]:
        # Cells are whole numbers; other changes are small, since the model is not linear.
        part = 1.0 if group.key == CELLS else PART
        tests = range(len(problem.records)) if group.key in OF_EACH_TEST else [None]
        moved = [_moved_test(problem, bearing, group, part, test) for test in tests]
        columns = [(item - residuals) / part for item in moved if item is not None]
        if len(columns) == len(moved):
            matrix = linear.weights[:, None] * np.column_stack(columns)
            unexplained = matrix - linear.jacobian @ linear.solved(matrix)
            evidence.append(_weigh(linear, group, unexplained))
    return tuple(evidence)


def _of_bearing(groups: Sequence[Group]) -> list[Group]:
    return [group for group in groups if not group.of_tests]


def _moved_test(
    problem: Problem, bearing: Bearing, group: Group, part: float, test: int | None
) -> Floats | None:
    """Return the residuals of all tests with one of them changed by a group, or with all."""
    if test is None:
        moved = moved_parts(problem, bearing, [(group, part)])
    else:
        records = list(problem.records)
        records[test] = moved_record(records[test], group, part)
        moved = problem.split_parts(bearing, records)
    return None if moved is None else np.concatenate(moved)


@dataclass(frozen=True)
class Estimate:
    """A free parameter at the optimum, in its unit."""

    parameter: Parameter
    value: float
    stderr: float  # by the tests and the assumed values
    stderr_of_tests: float  # by the tests alone
    lower: float  # of the 95 % interval
    upper: float
    at_bound: bool
    lost: bool  # near a bound that is not an end of the law itself, as b = 0 is
    determined: bool  # by the tests, and not by a bound of the search
    well_determined: bool  # three standard errors are within 3 % of the value
    relative_error: float  # standard error over the value; infinite if not determined
    where: str  # how near to a bound it ended, or how uncertain it is, in words


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of all free parameters."""

    estimates: dict[str, Estimate]  # by dotted key
    covariance: Floats  # in the unit cube, by the tests and the assumed values
    of_tests: Floats  # in the unit cube, by the tests alone
    widening: float  # factor on the errors by the tests, for intervals and draws
    stretching: Floats  # factor on the errors of draws of each parameter, at least 1
    correlation: Floats  # by the tests alone
    assumed: Propagated
    mistakes: tuple[Evidence, ...]  # what the tests say about each
    samples: int
    effective_samples: float  # independent samples that they are worth
    rms: float  # of the residuals, relative to the peak force
    warnings: list[str] = field(default_factory=list)
    misfit: list[str] = field(default_factory=list)  # causes of residuals that are not noise

    @property
    def of_cells(self) -> Evidence | None:
        """What the tests say about more heat cells; None where that was not computed."""
        return next((item for item in self.mistakes if item.group.key == CELLS), None)

    @property
    def suspects(self) -> list[Evidence]:
        """Possible causes of residuals that are not noise, the least surprising first.

        These remove the residuals about as well as the best of all does. Which of them is the
        cause is not known by the residuals, so that the one is first that is off by the least
        part of its usual error. None where the tests require no value beyond its uncertainty.
        """
        evidence = [item for item in (*self.assumed.evidence, *self.mistakes) if item.conceivable]
        clear = [item for item in evidence if abs(item.sigmas) > SURE * item.stderr]
        if self.rms <= NEGLIGIBLE or not clear:
            return []
        best = max(item.explained for item in clear)
        similar = [item for item in clear if item.explained > AS_LIKELY * best]
        if not any(item.beyond or item.is_main_mistake for item in similar):
            return []
        # No bearing has heat cells: they come first only where nothing else explains more.
        last = [item.group.key == CELLS and item.explained < best for item in similar]
        surprises = [
            abs(item.sigmas) + (LAST if is_last else 0.0)
            for item, is_last in zip(similar, last, strict=True)
        ]
        order = order_from_largest([-surprise for surprise in surprises])
        return [similar[k] for k in order]


def _effective_samples(residuals: Floats) -> float:
    """Return the number of independent samples, n / (1 + 2 sum of the first rho_k > 0)."""
    n = len(residuals)
    centred = residuals - residuals.mean()
    spectrum = np.fft.rfft(centred, 2 * n)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2)[:n]
    if covariance[0] <= 0.0:
        return float(n)
    rho = covariance / covariance[0]
    negative = np.flatnonzero(rho <= 0.0)
    end = int(negative[0]) if len(negative) else n
    return float(n / (1.0 + 2.0 * rho[1:end].sum()))


def estimate(
    problem: Problem, cube: Floats, groups: Sequence[Group] | None = None, *, fine: bool = True
) -> Uncertainty:
    """Return standard errors, intervals and warnings at the optimum of a fit."""
    linear = linearise(problem, cube, fine=fine)
    groups = chosen_groups(None) if groups is None else groups
    assumed = _propagate(linear, linearise_assumed(problem, cube, groups, fine=fine))
    of_tests = linear.covariance()
    factor = widening(int(linear.blocks.max()) + 1 - len(cube))
    reach = _half_intervals(assumed, of_tests, factor)
    covariance, spread = of_tests + assumed._covariance(), np.sqrt(np.diag(of_tests))
    # A parameter without error, of exact tests, would divide the correlation by zero.
    safe = np.where(spread > 0.0, spread, 1.0)
    estimates = {
        p.kind.key: _estimate(p, *map(float, row))
        for p, *row in zip(problem.pset.free, cube, np.diag(covariance), spread, reach, strict=True)
    }
    uncertainty = Uncertainty(
        estimates=estimates,
        covariance=covariance,
        of_tests=of_tests,
        widening=factor,
        stretching=_stretching(assumed, of_tests, factor),
        correlation=np.asarray(of_tests / np.outer(safe, safe)),
        assumed=assumed,
        mistakes=_weigh_mistakes(problem, cube, groups, linear),
        samples=len(linear.weights),
        effective_samples=sum(_effective_samples(part) for part in linear.parts),
        # Of the residuals under the loss, which the warnings of a misfit are about.
        rms=float(np.sqrt(np.mean(linear.residuals**2))),
    )
    d_y = float(problem.pset.bearing(cube).hysteresis.yield_displacement)
    warnings = _signal_warnings(problem.records, d_y)
    warnings += _warnings(problem, uncertainty, d_y)
    uncertainty = _with_imitations(linear, uncertainty)
    misfit = _misfit(problem, uncertainty)
    return replace(uncertainty, warnings=warnings, misfit=misfit)


def _variances(assumed: Propagated, of_tests: Floats, factor: float) -> tuple[Floats, Floats]:
    """Return the variances in the unit cube of intervals, and of widened errors.

    `factor` widens the errors by the tests, whose covariance is `of_tests`.
    """
    # Errors of two groups may cancel in a parameter, and more so where only one of them is widened:
    # that makes no interval smaller.
    plain, widened = (np.diag(assumed._covariance(factors)) for factors in (1.0, assumed.widening))
    tests = factor**2 * np.diag(of_tests)
    return np.maximum(plain, widened) + tests, widened + tests


def _half_intervals(assumed: Propagated, of_tests: Floats, factor: float) -> Floats:
    """Return half the 95 % intervals in the unit cube, each part with its degrees of freedom."""
    of_intervals = _variances(assumed, of_tests, factor)[0]
    return np.asarray(half_interval(NORMAL_FREEDOM) * np.sqrt(of_intervals))


def _stretching(assumed: Propagated, of_tests: Floats, factor: float) -> Floats:
    """Return by how much draws of each parameter are stretched, to fill its interval."""
    of_intervals, of_draws = _variances(assumed, of_tests, factor)
    return np.sqrt(
        np.divide(of_intervals, of_draws, out=np.ones_like(of_draws), where=of_draws > 0)
    )


def _estimate(p: Parameter, u: float, variance: float, spread: float, reach: float) -> Estimate:
    """Return a parameter with its errors; `reach` is half the 95 % interval in the unit cube."""
    # A place outside the open interval is at a bound; an end of the law itself, as b = 0, is a
    # valid value and not a failed search.
    bound, value, slope = not AT_BOUND < u < 1.0 - AT_BOUND, p.at(u), p.slope(u)
    place, end = p.place(value), p.lower if p.place(value) < 0.5 else p.upper
    near_bound = min(place, 1.0 - place) < NEAR_BOUND and end != p.kind.end
    undetermined = 2.0 * reach > OPEN
    stderr, determined = float(np.sqrt(variance)) * slope, not (bound or near_bound or undetermined)
    smallest = 0.0 if p.kind.scale == "log" else LEAST
    position = "at its bound" if bound else f"within {NEAR_BOUND:.0%} of its bound"
    if undetermined and not (bound or near_bound):
        position = "uncertain by half of its range or more"
    bounded = determined and np.isfinite(stderr)
    relative = stderr / max(abs(value), smallest) if bounded else float("inf")
    return Estimate(
        parameter=p,
        value=value,
        stderr=stderr,
        stderr_of_tests=spread * slope,
        lower=p.at(max(u - reach, 0.0)),
        upper=p.at(min(u + reach, 1.0)),
        at_bound=bound,
        lost=near_bound,
        determined=determined,
        well_determined=relative <= WELL,
        relative_error=relative,
        where=position,
    )


def _warnings(problem: Problem, uncertainty: Uncertainty, d_y: float) -> list[str]:
    """Return warnings of bounds, weak and correlated parameters, and tests that are too similar."""
    warnings, estimates = _test_warnings(problem), uncertainty.estimates
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
    remedies = {
        key: f"{kinds.remedy(kinds.KINDS[key])}, and denser samples: {coarse}"
        for key in (kinds.K_V, kinds.C_V)
        if coarse
    }
    for item in estimates.values():
        kind = item.parameter.kind
        value = 0.0 if abs(item.value) < ROUNDING else item.value
        values = f"{kind.symbol} = {value:.3g} {kind.unit}".strip()
        remedy = remedies.get(kind.key, kinds.remedy(kind))
        if not item.determined:
            warnings.append(
                f"{kind.symbol} cannot be determined from these tests: its value, "
                f"{f'{value:.3g} {kind.unit}'.strip()}, is {item.where}. {remedy}"
            )
        elif item.relative_error > POOR:
            error = f"its standard error is {item.relative_error:.0%}"
            warnings.append(f"{values} is poorly determined, {error}. {remedy}")
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
                f"the tests determine {names} only in combination (correlation {rho:.2f}). "
                f"{kinds.remedy(*(item.parameter.kind for item in pair))}"
            )
    return warnings


def _misfit(problem: Problem, uncertainty: Uncertainty) -> list[str]:
    """Return possible causes of residuals that are not noise, the least surprising first."""
    if uncertainty.rms <= NEGLIGIBLE:  # the model met the tests: there is no misfit to explain
        return []
    sentences = []
    # Reversed, so that the most plausible suspect of each cause is the one that stays.
    by_cause = {_common_cause(item): item for item in reversed(uncertainty.suspects)}
    suspects = [item for item in uncertainty.suspects if by_cause[_common_cause(item)] is item]
    if suspects:
        peak = max(record.peak_force for record in problem.records)
        listed = suspects[:MOST_CAUSES]
        causes = "; ".join(_suspicion(item, problem.pset.base, peak) for item in listed)
        words = "The likely cause: " if len(suspects) == 1 else CANNOT_TELL
        sentences.append(f"{MISFIT}. {words}{causes}")
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


def _common_cause(item: Evidence) -> str:
    """Return what stands for the same cause: a cold specimen and a warm chamber are one."""
    key = item.group.keys[0]
    return AMBIENT if key == CONDITIONING else key


def _suspicion(item: Evidence, bearing: Bearing, peak: float) -> str:
    """Return a suspect with its size; `peak` is the largest force of the tests [kN]."""
    (size, unit), key = item.size, item.group.keys[0]
    words = f"{item.group.name} off by {size:+.2g} {unit}".rstrip()
    if key in kinds.KINDS:
        value = kinds.dotted_value(bearing, key) or 0.0
        moved = item.group.moved(key, value, item.sigmas)
        words = f"{item.group.name} = {moved:.3g} instead of {value:.3g}"
    if key == CELLS:
        words = item.group.name
    elif key in OF_EACH_TEST:
        words = f"{item.group.name} of {size:+.2g} {unit}"
    if key == FORCE:
        words += f" ({0.01 * size * peak:+.2g} kN at the peak)"
    return f"{words} ({item.group.cause})" if item.group.cause else words


def _signal_warnings(records: Sequence[TestRecord], d_y: float) -> list[str]:
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


def _test_warnings(problem: Problem) -> list[str]:
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
        speeds = np.empty(0)  # mean ones of large half cycles [mm/s]
        for record in problem.records:
            turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
            travel, time = np.abs(np.diff(record.displacement[turns])), np.diff(record.time[turns])
            # Small half cycles at the end of a block have other speeds and little force of their
            # own.
            large = travel > 0.5 * travel.max()
            speeds = np.append(speeds, travel[large] / time[large])
        if speeds.max() < SPEED_SPAN * speeds.min():
            span = f"{speeds.min():.3g} to {speeds.max():.3g} mm/s"
            warnings.append(
                f"c_v and K_v rest on mean speeds of {span} only. "
                f"{kinds.remedy(kinds.KINDS[kinds.C_V])}"
            )
    return warnings
