"""Uncertainty of calibrated parameters from the tests and from the values that are assumed.

Each number that is not identified has a standard uncertainty (data/identify/assumed.toml). The
columns of derivatives by them propagate it to the calibrated ones, and show when the tests require
another value than that in the file. The covariance by the tests is that of problem.py; both add up.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.parameters import Parameter
from thermobearing.identify.fit.problem import AT_BOUND, Linear, Problem, linearise
from thermobearing.identify.uncertainty.diagnosis import (
    describe_misfit,
    describe_signals,
    describe_weakness,
)
from thermobearing.identify.uncertainty.evidence import (
    Estimate,
    Evidence,
    Propagated,
    Uncertainty,
)
from thermobearing.identify.uncertainty.groups import (
    CELLS,
    DELAY,
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
    place_of_largest,
)

PART = 0.25  # of a standard uncertainty: the step of a derivative
UNSEEN = 1e-3  # of the variance: numbers that move the residuals less are not seen by the tests
CLEAR = 2.0  # standard errors between a determined number and its bounds
WELL = 0.01  # relative standard error of a well determined parameter: three are within 3 %
OPEN = 0.5  # of the range of the search: the interval of a parameter that the tests leave open
NEAR_BOUND = 0.05  # of the range of the search: nearer to a bound no parameter is determined
LEAST = 0.1  # m_T, n_T, b and s may be zero: errors are relative to this at least
MILLI = 1e3  # ms in a second


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


def _with_imitations(linear: Linear, uncertainty: Uncertainty) -> Uncertainty:
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
    warnings = describe_signals(problem.records, d_y)
    warnings += describe_weakness(problem, uncertainty, d_y)
    uncertainty = _with_imitations(linear, uncertainty)
    misfit = describe_misfit(problem, uncertainty)
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
