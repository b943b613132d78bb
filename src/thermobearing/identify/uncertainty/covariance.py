"""Standard errors, intervals and correlation of the parameters, and which test would help.

The covariance by the tests (problem.py) and by the assumed values (assumed.py) add up.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.parameters import Parameter, at_one_temperature
from thermobearing.identify.fit.problem import AT_BOUND, BLOCK_TURN, Problem, linearised
from thermobearing.identify.records.cycles import turning_points
from thermobearing.identify.uncertainty.assumed import (
    Group,
    Propagated,
    linearise_assumed,
    propagate,
    usual_groups,
)

WELL = 0.01  # relative standard error of a well determined parameter: three are within 3 %
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
MOST_CAUSES = 3  # that are named
AS_LIKELY = 0.7  # of what the likeliest cause explains
MUCH = 0.1  # of the squared misfit, which one more free parameter would take away ...
SURELY = 3.0  # ... and by so many standard errors
SPEED_SPAN = 3.0  # ratio of speeds that fixes rate dependence


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

    @property
    def lost(self) -> bool:
        """Whether it ended near a bound that is not an end of the law itself, as b = 0 is."""
        u, key = self.parameter.place(self.value), self.parameter.kind.key
        end = self.parameter.lower if u < 0.5 else self.parameter.upper
        return min(u, 1.0 - u) < NEAR_BOUND and (key, end) not in kinds.ENDS

    @property
    def determined(self) -> bool:
        """Whether the tests, and not a bound of the search, gave the value."""
        return not (self.at_bound or self.lost)

    @property
    def where(self) -> str:
        """How near to a bound it ended, in words."""
        return "at its bound" if self.at_bound else f"within {NEAR_BOUND:.0%} of its bound"

    @property
    def relative_error(self) -> float:
        """Standard error over the value; infinite where it is not determined."""
        least = 0.0 if self.parameter.kind.transform == "log" else LEAST
        known = self.determined and np.isfinite(self.stderr)
        return self.stderr / max(abs(self.value), least) if known else float("inf")

    @property
    def well_determined(self) -> bool:
        """Whether three standard errors are within 3 % of the value."""
        return self.relative_error <= WELL


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of all free parameters."""

    estimates: dict[str, Estimate]  # by dotted key
    covariance: Floats  # in the unit cube; zero for parameters at bounds
    correlation: Floats  # by the tests alone
    assumed: Propagated
    inside: NDArray[np.bool_]  # of the free parameters, those that are not at a bound
    samples: int
    effective_samples: float  # independent samples that they are worth
    rms: float  # of the residuals, relative to the peak force
    warnings: list[str] = field(default_factory=list)
    misfit: list[str] = field(default_factory=list)  # likely causes of residuals that are no noise


def effective_samples(residuals: Floats) -> float:
    """Return the number of independent samples that a correlated series is worth.

    It is n / (1 + 2 sum rho_k), the sum up to the first lag at which rho is not positive.
    """
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


def estimate(problem: Problem, cube: Floats, groups: Sequence[Group] | None = None) -> Uncertainty:
    """Return standard errors, intervals and warnings at the optimum of a fit."""
    linear = linearised(problem, cube)
    groups = usual_groups() if groups is None else groups
    assumed = propagate(linear, linearise_assumed(problem, cube, groups))
    inside = np.ix_(linear.inside, linear.inside)
    of_tests, covariance = np.zeros((2, len(cube), len(cube)))
    of_tests[inside] = linear.covariance()
    covariance[inside] = of_tests[inside] + assumed.covariance()
    half = np.zeros(len(cube))  # of the intervals: each part with its own degrees of freedom
    wide = np.array([_wide(item.group.freedom) for item in assumed.evidence])
    half[linear.inside] = np.diag(assumed.covariance(wide))
    half += _wide(int(linear.blocks.max()) + 1 - len(cube)) ** 2 * np.diag(of_tests)
    spread = np.sqrt(np.diag(of_tests))
    safe = np.where(spread > 0.0, spread, 1.0)
    estimates = {}
    for i, parameter in enumerate(problem.pset.free):
        u, whole, reach = float(cube[i]), float(covariance[i, i]), float(np.sqrt(half[i]))
        bound = not AT_BOUND < u < 1.0 - AT_BOUND
        slope = parameter.slope(u) if not bound else float("nan")
        estimates[parameter.kind.key] = Estimate(
            parameter=parameter,
            value=parameter.at(u),
            stderr=float(np.sqrt(whole)) * slope,
            stderr_of_tests=float(spread[i]) * slope,
            lower=parameter.at(max(u - reach, 0.0)),
            upper=parameter.at(min(u + reach, 1.0)),
            at_bound=bound,
        )
    found = Uncertainty(
        estimates=estimates,
        covariance=covariance,
        correlation=np.asarray(of_tests / np.outer(safe, safe)),
        assumed=assumed,
        inside=linear.inside,
        samples=len(linear.weights),
        effective_samples=sum(effective_samples(part) for part in linear.parts),
        rms=float(np.sqrt(np.mean(linear.residuals**2))),
    )
    found.warnings.extend(_warnings(problem, found))
    found.misfit.extend(_misfit(problem, found))
    return found


def _wide(freedom: float) -> float:
    """Return half a 95 % interval over its standard error, by Student's distribution."""
    from scipy.stats import t as student

    return float(student.ppf(0.5 + 0.5 * LEVEL, max(freedom, 2)))


def remedy(keys: set[str]) -> str:
    """Return which tests would fix parameters, given by their dotted keys."""
    words = (words for known, words in kinds.REMEDIES if keys & known)
    return next(words, "other tests would be needed")


def _warnings(problem: Problem, found: Uncertainty) -> list[str]:
    """Return warnings of bounds reached, weak and entangled parameters, and tests too alike."""
    said, estimates = _test_warnings(problem), found.estimates
    warm = [estimates[key] for key in (kinds.M_T, kinds.N_T) if key in estimates]
    if warm and all(item.lower > ENTROPIC for item in warm):  # of no rubber
        shown = " and ".join(f"{e.parameter.kind.symbol} = {e.value:.2f}" for e in warm)
        said.append(
            f"{shown} would be rubber that stiffens as it warms: are the ambient temperatures of "
            "the tests swapped?"
        )
    for key, item in estimates.items():
        kind = item.parameter.kind
        shown = f"{kind.symbol} = {item.value:.4g} {kind.unit}".strip()
        if not item.determined:
            said.append(f"{shown} is not determined, it ended {item.where}: {remedy({key})}")
        elif item.relative_error > POOR:
            error = f"standard error {item.stderr:.2g}"
            said.append(f"{shown} is poorly determined ({error}): {remedy({key})}")
    for i, j in zip(*np.triu_indices(len(estimates), 1), strict=True):
        rho, pair = float(found.correlation[i, j]), [list(estimates.values())[k] for k in (i, j)]
        if abs(rho) > CORRELATED and any(item.relative_error > WELL for item in pair):
            names = " and ".join(item.parameter.kind.symbol for item in pair)
            said.append(
                f"{names} are entangled (correlation {rho:.2f}): only a combination of them is "
                f"known; {remedy({item.parameter.kind.key for item in pair})}"
            )
    return said


def _misfit(problem: Problem, found: Uncertainty) -> list[str]:
    """Return likely causes of residuals that are no noise: first what the tests contradict."""
    if found.rms <= NEGLIGIBLE:  # the model met the tests: there is no misfit to explain
        return []
    evidence = sorted(found.assumed.evidence, key=lambda item: -item.explained)
    if at_one_temperature(record.ambient for record in problem.records):
        evidence = [item for item in evidence if item.group.keys[0] not in (kinds.M_T, kinds.N_T)]
    said = []
    if evidence and evidence[0].contradicted:
        worst = evidence[0]
        alike = [
            t for t in evidence if t.contradicted and t.explained > AS_LIKELY * worst.explained
        ]
        causes = [item.group.cause or f"the value of {item.group.name}" for item in alike]
        said.append(
            f"likely {'; or '.join(causes[:MOST_CAUSES])}: the tests ask for "
            f"{'more' if worst.sigmas > 0.0 else 'less'} {worst.group.name} than was assumed, by "
            f"{abs(worst.sigmas):.0f} times its uncertainty"
        )
    held = [
        item
        for item in evidence
        if item.group.keys[0] in kinds.BY_KEY
        and item.explained > MUCH
        and abs(item.sigmas) > SURELY * item.stderr
    ]
    if held:  # parameters whose freedom would remove much of the misfit
        worst = max(held, key=lambda item: item.explained)
        name = worst.group.name
        free = [*(item.parameter.kind.symbol for item in found.estimates.values()), name]
        said.append(
            f"{worst.explained:.0%} of the squared misfit would go with another {name} than the "
            f"file has: free {name} (--free {','.join(free)})"
        )
    if not said and found.effective_samples < ALIKE * found.samples:
        said.append(
            f"the residuals are not noise ({found.samples} samples are worth "
            f"{found.effective_samples:.0f} independent ones): the law misses something, or the "
            "force was filtered; standard errors are those of the numbers of this law"
        )
    return said


def _test_warnings(problem: Problem) -> list[str]:
    """Return warnings of tests at too similar temperatures or speeds."""
    said = []
    free = {p.kind.key for p in problem.pset.free}
    ambients = [record.ambient for record in problem.records]
    low, high = min(ambients), max(ambients)
    if free & {kinds.M_T, kinds.N_T} and high - low < TEMPERATURE_SPAN:
        span = f"{low:g} to {high:g}" if high > low else f"{low:g}"
        said.append(
            f"m_T and n_T were fitted to tests at {span} degC only, mostly from self-heating: "
            f"{remedy({kinds.M_T})}"
        )
    if free & {kinds.C_V, kinds.K_V}:
        speeds = np.empty(0)  # mean ones of large half cycles [mm/s]
        for record in problem.records:
            x, time = record.displacement, record.time
            turns = turning_points(x, BLOCK_TURN * record.peak_displacement)
            way = np.abs(np.diff(x[turns]))
            large = way > 0.5 * way.max()
            speeds = np.append(speeds, way[large] / np.diff(time[turns])[large])
        if speeds.max() < SPEED_SPAN * speeds.min():
            said.append(
                f"c_v and K_v were fitted to mean speeds of {speeds.min():.3g} to "
                f"{speeds.max():.3g} mm/s only: {remedy({kinds.C_V})}"
            )
    return said
