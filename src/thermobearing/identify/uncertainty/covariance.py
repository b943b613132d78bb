"""Uncertainty of calibrated parameters from the tests and from the values that are assumed.

Each number that is not identified has a standard uncertainty (data/identify/assumed.toml). The
columns of derivatives by them propagate it to the calibrated ones, and show when the tests require
another value than that in the file. The covariance by the tests is that of problem.py; both add up.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.border.units import is_number
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.parameters import Parameter, at_one_temperature
from thermobearing.identify.fit.problem import AT_BOUND, BLOCK_TURN, Linear, Problem, linearise
from thermobearing.identify.records.cycles import dead_band, estimate_noise, turning_points
from thermobearing.identify.records.record import TestRecord
from thermobearing.quantities.governing import largest_by, order_from_largest

PART = 0.25  # of a standard uncertainty: the step of a derivative
LARGEST_SPREAD = 2.0  # relative standard uncertainty
SURE, BEYOND = 5.0, 3.0  # standard errors of the tests, of tests and source together
CLEAR = 2.0  # standard errors between a determined number and its bounds
NORMAL_FREEDOM = 10**6  # degrees of freedom with which Student's distribution is the normal one
AMBIENT, TURNS, FORCE, CONDITIONING = "ambient", "turns", "force", "conditioning"
OF_TESTS = (AMBIENT, TURNS, FORCE, CONDITIONING)  # keys of the tests, not of the bearing
UNSEEN = 1e-3  # of the variance: numbers that move the residuals less are not seen by the tests
WELL = 0.01  # relative standard error of a well determined parameter: three are within 3 %
OPEN = 0.5  # of the range of the search: the interval of a parameter that the tests leave open
NEAR_BOUND = 0.05  # of the range of the search: nearer to a bound no parameter is determined
POOR = 0.1  # relative standard error of a poorly determined one
LEAST = 0.1  # m_T, n_T, b and s may be zero: errors are relative to this at least
LEVEL = 0.95
CORRELATED = 0.95
NEGLIGIBLE = 1e-3  # of the peak force: smaller residuals are no matter for a warning
ALIKE = 0.2  # effective over actual samples, below which residuals are not noise
TEMPERATURE_SPAN = 15.0  # K between tests that fix a temperature coefficient
# Entropy stiffens warm rubber by T/T_0, a third in 100 K; no more.
ENTROPIC = 0.35
MOST_CAUSES = 4  # that are named
TENFOLD = 10.0
AS_LIKELY = 0.7  # of what the likeliest cause explains
MUCH = 0.1  # of the squared misfit, which one more free parameter would take away ...
SURELY = 3.0  # ... and by so many standard errors
ROUNDING = 1e-9  # a parameter nearer to zero is at it
SPEED_SPAN = 3.0  # ratio of speeds that fixes rate dependence


def _half_interval(freedom: float) -> float:
    """Return half a 95 % interval over its standard error, by Student's distribution."""
    from scipy.stats import t as student

    return float(student.ppf(0.5 + 0.5 * LEVEL, max(freedom, 2)))


def widening(freedom: float) -> float:
    """Return the ratio of a 95 % interval with few degrees of freedom to that of a normal error.

    Intervals and draws of the posterior contain this one factor, so that 95 % of the draws of a
    parameter are its interval.
    """
    return _half_interval(freedom) / _half_interval(NORMAL_FREEDOM)


class Group(Strict):
    """Numbers of a bearing with a common error."""

    name: str  # or the symbol of a parameter
    keys: list[str]  # dotted keys of a bearing
    relative: float | None = None  # standard uncertainty over the value, or
    absolute: float | None = None  # in the unit of the key
    source: str
    note: str = ""
    unit: str = ""  # of `absolute`; empty where the key says it
    # Degrees of freedom (JCGM 100:2008, G.4.2): how well the uncertainty itself is known.
    freedom: float = Field(default=NORMAL_FREEDOM, gt=0.0)
    cause: str = ""  # another reason for which tests require another value
    mistake: bool = False  # no uncertainty, but a suspect where residuals are not noise
    at: float | None = None  # of the tests at this ambient temperature only [degC]

    @model_validator(mode="after")
    def _one_uncertainty(self) -> "Group":
        if (self.relative is None) == (self.absolute is None):
            raise ValueError("needs relative or absolute, one of them")
        return self

    def step(self, value: float) -> float:
        """Return the standard uncertainty of a value, in its unit."""
        return self.absolute if self.absolute is not None else (self.relative or 0.0) * abs(value)

    def moved(self, key: str, value: float, sigmas: float) -> float:
        """Return the value of a key, changed by `sigmas` standard uncertainties.

        Relative uncertainties are those of the logarithm, so that a number keeps its sign; a
        parameter stays within the bounds of its search, which no bearing may leave.
        """
        if self.absolute is None:
            changed = value * float(np.exp(sigmas * (self.relative or 0.0)))
        else:
            changed = value + sigmas * self.absolute
        kind = kinds.KINDS.get(key)
        if kind is None or kind.relative:
            return changed
        return min(max(changed, min(kind.lower, value)), max(kind.upper, value))

    @property
    def of_tests(self) -> bool:
        """Whether the numbers are of the tests, and none of the bearing."""
        return self.keys[0] in OF_TESTS

    @property
    def widening(self) -> float:
        """Factor on its uncertainty, by which 95 % of a normal distribution are a 95 % interval."""
        return widening(self.freedom)


class Groups(Strict):
    """Content of data/identify/assumed.toml."""

    groups: list[Group]


def chosen_groups(given: Mapping[str, float] | None) -> tuple[Group, ...]:
    """Return the default uncertainties, some of them replaced.

    `given` holds relative standard uncertainties in [0, 2] by the name of a group or a key of one;
    that of "ambient" is in K.
    """
    groups = list(read_data(Groups, "identify", "assumed.toml").groups)
    for name, value in (given or {}).items():
        places = [i for i, g in enumerate(groups) if name == g.name or name in g.keys]
        if not places:
            known = [word for group in groups for word in (group.name, *group.keys)]
            raise InputError(f'assumed: there is no number "{name}"{nearest(name, known)}')
        if not (is_number(value) and 0.0 <= value <= LARGEST_SPREAD):
            said = "must be a relative standard uncertainty, 0 to"
            raise InputError(f"assumed: {name} = {value!r} {said} {LARGEST_SPREAD:g}")
        which = "absolute" if groups[places[0]].keys == [AMBIENT] else "relative"
        change: dict[str, Any] = {"relative": None, "absolute": None, which: float(value)}
        change |= {"source": "given", "note": ""}
        groups[places[0]] = groups[places[0]].model_copy(update=change)
    return tuple(groups)


class Assumed(NamedTuple):
    """Numbers that a calibration does not identify."""

    groups: tuple[Group, ...]  # of the bearing, not free and not known exactly
    columns: Floats  # [residual, group] change by one standard uncertainty


def shift(bearing: Bearing, group: Group, sigmas: float) -> Bearing:
    """Return a bearing whose numbers of a group are changed by `sigmas` standard uncertainties."""
    values = {key: kinds.dotted_value(bearing, key) for key in group.keys}
    known = {key: value for key, value in values.items() if value is not None}
    return kinds.with_values(
        bearing, {key: round(group.moved(key, v, sigmas), 12) for key, v in known.items()}
    )


def _assumed_groups(
    bearing: Bearing, identified: Sequence[str], groups: Sequence[Group]
) -> list[Group]:
    """Return the groups that a calibration assumes: neither identified nor exact nor zero."""
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    assumed, without = [], {*identified, *kinds.replaced_by_laws(bearing)}
    for group in groups:
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
    here = np.concatenate(problem.parts(cube, fine=fine))
    kept, columns = [], []

    def _add(group: Group, part: float) -> None:
        moved = moved_parts(problem, bearing, [(group, part)], fine=fine)
        column = np.zeros(len(here)) if moved is None else (np.concatenate(moved) - here) / part
        kept.append(group)
        columns.append(column)

    usual = [group for group in groups if not group.mistake]
    for group in _assumed_groups(bearing, identified, usual):
        _add(group, PART)
    for group in _groups_of_tests(problem.records, usual):
        _add(group, 1.0)
    shape = (len(here), len(kept))
    return Assumed(tuple(kept), np.array(columns).T if columns else np.zeros(shape))


def moved_parts(
    problem: Problem, bearing: Bearing, changes: Sequence[tuple[Group, float]], *, fine: bool = True
) -> list[Floats] | None:
    """Return the residuals with assumed groups changed by so many standard uncertainties.

    None if the model ends early.
    """
    records = problem.records
    for group, sigmas in changes:
        if group.of_tests:
            records = [_moved_record(record, group, sigmas) for record in records]
        else:
            bearing = shift(bearing, group, sigmas)
    return problem.split_parts(bearing, records, fine=fine)


def _groups_of_tests(records: Sequence[TestRecord], groups: Sequence[Group]) -> list[Group]:
    """Return the systematic errors of the tests.

    Tests at the same temperature share its error: they had one chamber and thermometer.
    """
    errors = []
    for group in groups:
        if group.keys[0] not in (AMBIENT, CONDITIONING):
            errors += [group] if group.of_tests else []
            continue
        for ambient in dict.fromkeys(record.ambient for record in records):
            name = f"{group.name} of {ambient:.4g} degC"
            update: dict[str, Any] = {"name": name, "at": ambient}
            if group.keys[0] == AMBIENT:
                steps = [_kelvin(r, group) for r in records if r.ambient == ambient]
                update["absolute"] = max(steps)
            errors.append(group.model_copy(update=update))
    return errors


def _kelvin(record: TestRecord, group: Group) -> float:
    """Return the standard uncertainty of the ambient temperature of a test [K]."""
    stated = record.ambient_uncertainty
    return group.step(0.0) if stated is None else stated


def _moved_record(record: TestRecord, group: Group, sigmas: float) -> TestRecord:
    """Return a test, changed by some standard uncertainties of a systematic error."""
    key = group.keys[0]
    if key == AMBIENT:
        if record.ambient != group.at:
            return record
        return replace(record, ambient=record.ambient + sigmas * _kelvin(record, group))
    if key == CONDITIONING:
        if record.ambient != group.at:
            return record
        return replace(record, start_offset=record.start_offset + sigmas * group.step(0.0))
    if key == TURNS:  # less far out, by the uncertainty from the noise
        x, less = record.displacement, record.displacement.copy()
        at = turning_points(x, dead_band(x))[1:-1]
        less[at] -= sigmas * group.step(estimate_noise(x)) * np.sign(x[at] - x[at - 1])
        return replace(record, displacement=less)
    return replace(record, force=(1.0 + sigmas * group.step(1.0)) * record.force)


@dataclass(frozen=True)
class Evidence:
    """Evidence of the tests on one group, with the others as in the file."""

    group: Group
    sigmas: float  # wanted change of the file's values, in standard uncertainties
    stderr: float  # of `sigmas`, by the tests
    explained: float  # share of the squared residuals that this would remove, in [0, 1]

    @property
    def contradicted(self) -> bool:
        """Whether the tests show that the values of the file are outside their uncertainty."""
        off = abs(self.sigmas)
        return off > SURE * self.stderr and off > BEYOND * float(np.hypot(1.0, self.stderr))

    @property
    def conceivable(self) -> bool:
        """Whether the tests require less than a tenfold value, which no mistake explains."""
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
    apart = columns + linear.jacobian @ shifts  # what no change of the parameters can imitate
    evidence = [_weigh(linear, group, apart[:, i]) for i, group in enumerate(assumed.groups)]
    inner = apart.T @ apart
    wanted = -np.linalg.pinv(inner, rcond=1e-10, hermitian=True) @ (apart.T @ linear.residuals)
    left_over = linear.residuals + apart @ wanted
    meat = linear.meat(apart, left_over) + np.diag(np.diag(inner)) * np.mean(left_over**2)
    against = np.linalg.pinv(meat, rcond=1e-10, hermitian=True)
    # By eigenvalues: exact tests know nearly everything, and an inverse would not stay positive.
    known, axes = np.linalg.eigh(inner @ against @ inner)
    known = np.maximum(known, 0.0)
    posterior = (axes / (1.0 + known)) @ axes.T
    mean = axes @ (known / (1.0 + known) * (axes.T @ wanted))
    return Propagated(tuple(evidence), shifts, posterior + np.outer(mean, mean))


def _weigh(linear: Linear, group: Group, column: Floats) -> Evidence:
    """Return the evidence on a group from the part of its column that no parameter can imitate."""
    residuals = linear.residuals
    norm = float(column @ column)
    if norm <= UNSEEN * max(linear.variance, 1e-300):
        return Evidence(group, 0.0, float("inf"), 0.0)
    sigmas = -float(column @ residuals) / norm
    left_over = residuals + sigmas * column  # or the error of the file would be taken for noise
    meat = float(linear.meat(column[:, None], left_over)[0, 0])
    least = norm * float(left_over @ left_over) / len(left_over)
    explained = sigmas**2 * norm / max(float(residuals @ residuals), 1e-300)
    return Evidence(group, sigmas, float(np.sqrt(max(meat, least))) / norm, explained)


def _weigh_mistakes(
    problem: Problem, cube: Floats, groups: Sequence[Group], linear: Linear
) -> tuple[Evidence, ...]:
    """Return the evidence of the tests on mistakes that a calibration does not assume."""
    bearing, residuals = problem.pset.bearing(cube), np.concatenate(problem.parts(cube, fine=True))
    evidence = []
    for group in _groups_of_tests(problem.records, [item for item in groups if item.mistake]):
        moved = moved_parts(problem, bearing, [(group, PART)])
        if moved is not None:
            column = linear.weights * (np.concatenate(moved) - residuals) / PART
            apart = column - linear.jacobian @ linear.solved(column)
            evidence.append(_weigh(linear, group, apart))
    return tuple(evidence)


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
    where: str  # how near to a bound it ended, or how far open it is, in words


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of all free parameters."""

    estimates: dict[str, Estimate]  # by dotted key
    covariance: Floats  # in the unit cube, by the tests and the assumed values
    of_tests: Floats  # in the unit cube, by the tests alone
    widening: float  # factor on the errors by the tests, for intervals and draws
    correlation: Floats  # by the tests alone
    assumed: Propagated
    mistakes: tuple[Evidence, ...]  # what the tests say about each
    samples: int
    effective_samples: float  # independent samples that they are worth
    rms: float  # of the residuals, relative to the peak force
    warnings: list[str] = field(default_factory=list)
    misfit: list[str] = field(default_factory=list)  # likely causes of residuals that are not noise

    @property
    def suspects(self) -> list[Evidence]:
        """Likely causes of residuals that are not noise, the least surprising first.

        These remove the residuals about as well as the best of all does. Which of them is the
        cause is not known by the residuals, so that the one is first that is off by the least
        part of its usual error. None where no value is contradicted by the tests.
        """
        every = [item for item in (*self.assumed.evidence, *self.mistakes) if item.conceivable]
        clear = [item for item in every if abs(item.sigmas) > SURE * item.stderr]
        if self.rms <= NEGLIGIBLE or not clear:
            return []
        best = max(item.explained for item in clear)
        alike = [item for item in clear if item.explained > AS_LIKELY * best]
        if not any(item.contradicted for item in alike):
            return []
        order = order_from_largest([-abs(item.sigmas) for item in alike])
        return [alike[k] for k in order]


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
    wide = widening(int(linear.blocks.max()) + 1 - len(cube))
    # Of the intervals: each part with its own degrees of freedom.
    square = np.diag(assumed._covariance(assumed.widening)) + wide**2 * np.diag(of_tests)
    reach = _half_interval(NORMAL_FREEDOM) * np.sqrt(square)
    covariance, spread = of_tests + assumed._covariance(), np.sqrt(np.diag(of_tests))
    safe = np.where(spread > 0.0, spread, 1.0)
    estimates = {
        p.kind.key: _estimate(p, *map(float, row))
        for p, *row in zip(problem.pset.free, cube, np.diag(covariance), spread, reach, strict=True)
    }
    found = Uncertainty(
        estimates=estimates,
        covariance=covariance,
        of_tests=of_tests,
        widening=wide,
        correlation=np.asarray(of_tests / np.outer(safe, safe)),
        assumed=assumed,
        mistakes=_weigh_mistakes(problem, cube, groups, linear),
        samples=len(linear.weights),
        effective_samples=sum(_effective_samples(part) for part in linear.parts),
        rms=float(np.sqrt(np.mean(linear.residuals**2))),
    )
    warnings, misfit = _warnings(problem, found), _misfit(problem, found)
    return replace(found, warnings=warnings, misfit=misfit)


def _estimate(p: Parameter, u: float, variance: float, spread: float, reach: float) -> Estimate:
    """Return a parameter with its errors; `reach` is half the 95 % interval in the unit cube."""
    bound, value, slope = not AT_BOUND < u < 1.0 - AT_BOUND, p.at(u), p.slope(u)
    place, end = p.place(value), p.lower if p.place(value) < 0.5 else p.upper
    lost = min(place, 1.0 - place) < NEAR_BOUND and end != p.kind.end
    wide = 2.0 * reach > OPEN
    stderr, determined = float(np.sqrt(variance)) * slope, not (bound or lost or wide)
    least = 0.0 if p.kind.scale == "log" else LEAST
    where = "at its bound" if bound else f"within {NEAR_BOUND:.0%} of its bound"
    if wide and not (bound or lost):
        where = "with an interval of half its range or more"
    known = determined and np.isfinite(stderr)
    relative = stderr / max(abs(value), least) if known else float("inf")
    return Estimate(
        parameter=p,
        value=value,
        stderr=stderr,
        stderr_of_tests=spread * slope,
        lower=p.at(max(u - reach, 0.0)),
        upper=p.at(min(u + reach, 1.0)),
        at_bound=bound,
        lost=lost,
        determined=determined,
        well_determined=relative <= WELL,
        relative_error=relative,
        where=where,
    )


def _warnings(problem: Problem, found: Uncertainty) -> list[str]:
    """Return warnings of bounds, weak and correlated parameters, and tests that are too similar."""
    said, estimates = _test_warnings(problem), found.estimates
    warm = [estimates[key] for key in (kinds.M_T, kinds.N_T) if key in estimates]
    if warm and all(item.lower > ENTROPIC for item in warm):  # of no rubber
        shown = " and ".join(f"{e.parameter.kind.symbol} = {e.value:.2f}" for e in warm)
        said.append(
            f"{shown} describes a rubber that stiffens as it warms: are the ambient temperatures "
            "of the tests swapped?"
        )
    for item in estimates.values():
        kind = item.parameter.kind
        value = 0.0 if abs(item.value) < ROUNDING else item.value
        shown = f"{kind.symbol} = {value:.4g} {kind.unit}".strip()
        if not item.determined:
            ends = f"95 % interval {item.lower:.3g} to {item.upper:.3g}"
            said.append(
                f"{shown} is not determined (it ended {item.where}; {ends}): {kinds.remedy(kind)}"
            )
        elif item.relative_error > POOR:
            error = f"standard error {item.stderr:.2g}"
            said.append(f"{shown} is poorly determined ({error}): {kinds.remedy(kind)}")
    for i, j in zip(*np.triu_indices(len(estimates), 1), strict=True):
        rho, pair = float(found.correlation[i, j]), [list(estimates.values())[k] for k in (i, j)]
        if abs(rho) > CORRELATED and any(item.relative_error > WELL for item in pair):
            names = " and ".join(item.parameter.kind.symbol for item in pair)
            said.append(
                f"{names} are strongly correlated ({rho:.2f}): only a combination of them is "
                f"determined; {kinds.remedy(*(item.parameter.kind for item in pair))}"
            )
    return said


def _misfit(problem: Problem, found: Uncertainty) -> list[str]:
    """Return likely causes of residuals that are not noise; contradicted assumptions first."""
    if found.rms <= NEGLIGIBLE:  # the model met the tests: there is no misfit to explain
        return []
    said = []
    named = {item.group.keys[0]: item for item in reversed(found.suspects)}  # first of each key
    if suspects := [item for item in found.suspects if named[item.group.keys[0]] is item]:
        peak = max(record.peak_force for record in problem.records)
        some = suspects[:MOST_CAUSES]
        causes = "; ".join(_suspicion(item, problem.pset.base, peak) for item in some)
        said.append(
            f"the residuals are not noise; likely causes, the least surprising first: {causes}"
        )
    evidence = list(found.assumed.evidence)
    if at_one_temperature(record.ambient for record in problem.records):  # freeing needs more
        evidence = [item for item in evidence if item.group.keys[0] not in (kinds.M_T, kinds.N_T)]
    held = [
        item
        for item in evidence
        if (key := item.group.keys[0]) in kinds.KINDS or key.startswith(kinds.LAWS)
        if item.explained > MUCH and abs(item.sigmas) > SURELY * item.stderr
    ]
    if held:  # parameters whose freedom would remove much of the misfit
        worst = largest_by(held, lambda item: item.explained)
        name = worst.group.name
        free = [*(item.parameter.kind.symbol for item in found.estimates.values()), name]
        said.append(
            f"another {name} than that of the file would reduce the squared residuals by "
            f"{worst.explained:.0%}: free it (--free {','.join(free)})"
        )
    if not said and found.effective_samples < ALIKE * found.samples:
        said.append(
            f"the residuals are not noise ({found.samples} samples are worth "
            f"{found.effective_samples:.0f} independent ones): the model lacks an effect, or the "
            "force was filtered; the standard errors hold for the parameters of this model"
        )
    return said


def _suspicion(item: Evidence, bearing: Bearing, peak: float) -> str:
    """Return a suspect with its size; `peak` is the largest force of the tests [kN]."""
    (size, unit), key = item.size, item.group.keys[0]
    words = f"{item.group.name} off by {size:+.2g} {unit}".rstrip()
    if key in kinds.KINDS:
        value = kinds.dotted_value(bearing, key) or 0.0
        moved = item.group.moved(key, value, item.sigmas)
        words = f"{item.group.name} = {moved:.3g} instead of {value:.3g}"
    if key == FORCE:
        words += f" ({0.01 * size * peak:+.2g} kN at the peak)"
    return f"{words} ({item.group.cause})" if item.group.cause else words


def _test_warnings(problem: Problem) -> list[str]:
    """Return warnings of tests at too similar temperatures or speeds."""
    said = []
    free = {p.kind.key for p in problem.pset.free}
    ambients = [record.ambient for record in problem.records]
    low, high = min(ambients), max(ambients)
    if free & {kinds.M_T, kinds.N_T} and high - low < TEMPERATURE_SPAN:
        span = f"{low:g} to {high:g}" if high > low else f"{low:g}"
        said.append(
            f"m_T and n_T were calibrated to tests at {span} degC only, mostly by self-heating: "
            f"{kinds.remedy(kinds.KINDS[kinds.M_T])}"
        )
    if free & {kinds.C_V, kinds.K_V}:
        speeds = np.empty(0)  # mean ones of large half cycles [mm/s]
        for record in problem.records:
            turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
            way, time = np.abs(np.diff(record.displacement[turns])), np.diff(record.time[turns])
            large = way > 0.5 * way.max()
            speeds = np.append(speeds, way[large] / time[large])
        if speeds.max() < SPEED_SPAN * speeds.min():
            span = f"{speeds.min():.3g} to {speeds.max():.3g} mm/s"
            said.append(
                f"c_v and K_v were calibrated to mean speeds of {span} only: "
                f"{kinds.remedy(kinds.KINDS[kinds.C_V])}"
            )
    return said
