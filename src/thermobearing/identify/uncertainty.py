"""How well the tests fix each parameter: intervals, correlation, and what test would help.

Residuals of neighbouring samples are alike (filters, and above all model error), so the
textbook covariance sigma^2 (J^T J)^-1 is far too small. Gradients are summed over half
cycles, which are taken to be independent (cluster-robust "sandwich"; Huber 1967, White
1980): (J^T J)^-1 (sum g_b g_b^T) (J^T J)^-1 with B/(B - p) for few blocks. The textbook
value is kept as a floor.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermobearing.identify import kinds
from thermobearing.identify.forward import turning_points
from thermobearing.identify.parameters import Parameter
from thermobearing.identify.problem import Problem, robust_weights
from thermobearing.identify.record import TestRecord

Floats = NDArray[np.float64]

AT_BOUND = 2e-3  # of the range: nearer to a bound than this is at it
WELL = 0.01  # relative standard error of a well determined parameter: three are within 3 %
POOR = 0.1  # relative standard error of a poorly determined one
LEAST = 0.1  # m_T, n_T, b and s may be zero: errors are relative to this at least
LEVEL = 0.95
CORRELATED = 0.95
NEGLIGIBLE = 1e-3  # of the peak force: smaller residuals are no matter for a warning
ALIKE = 0.2  # effective over actual samples, below which residuals are not noise
BLOCK_TURN = 0.05  # of the largest displacement: half cycles larger than this are blocks
TEMPERATURE_SPAN = 15.0  # K between tests that fix a temperature coefficient
SPEED_SPAN = 3.0  # ratio of speeds that fixes rate dependence


@dataclass(frozen=True)
class Estimate:
    """One free parameter: value, standard error, 95 % interval [in its unit]."""

    parameter: Parameter
    value: float
    stderr: float
    lower: float
    upper: float
    at_bound: bool

    @property
    def relative_error(self) -> float:
        """Standard error over the value; infinite at a bound."""
        least = 0.0 if self.parameter.kind.transform == "log" else LEAST
        known = not self.at_bound and np.isfinite(self.stderr)
        return self.stderr / max(abs(self.value), least) if known else float("inf")

    @property
    def well_determined(self) -> bool:
        """Whether three standard errors are within 3 % of the value."""
        return self.relative_error <= WELL


@dataclass(frozen=True)
class Uncertainty:
    """Of all free parameters.

    Attributes
    ----------
    estimates : by dotted key.
    covariance : in the unit cube; rows and columns of parameters at bounds are zero.
    correlation : the same, normalised.
    samples, effective_samples : how many, and how many independent ones they are worth.
    rms : root mean square of the residuals, relative to the peak force.
    warnings : in words.
    """

    estimates: dict[str, Estimate]
    covariance: Floats
    correlation: Floats
    samples: int
    effective_samples: float
    rms: float
    warnings: list[str] = field(default_factory=list)


def _blocks(record: TestRecord) -> Floats:
    """Number of the half cycle that each sample belongs to, cut half-way between turns.

    Not at the turns: there the gradients of stiffness, d_y and s change sign at once, and noise
    that is alike on both sides cancels, which sums cut there would not see.
    """
    turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
    middles = (turns[:-1] + turns[1:]) // 2
    return np.searchsorted(middles, np.arange(len(record.time)), side="right").astype(float)


def effective_samples(residuals: Floats) -> float:
    """Number of independent samples that a correlated series is worth.

    n / (1 + 2 sum rho_k), the sum up to the first lag at which rho is not positive.

    Parameters
    ----------
    residuals : in the order of time, in any unit.

    Returns
    -------
    float : at most about the number of residuals.

    Examples
    --------
    >>> white = np.random.default_rng(0).normal(size=4000)
    >>> bool(effective_samples(white) > 2500)
    True
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


def _covariance(problem: Problem, cube: Floats) -> tuple[Floats, float, int, float]:
    """Covariance in the unit cube, effective samples, all samples, rms of the residuals."""
    plain = problem.parts(cube, fine=True)
    roots = [np.sqrt(robust_weights(part, problem.loss)) for part in plain]
    parts = [root * part for root, part in zip(roots, plain, strict=True)]
    jacobian = problem.jacobian(cube, fine=True, central=True)
    residuals = np.concatenate(parts)
    inside = (cube > AT_BOUND) & (cube < 1.0 - AT_BOUND)
    J = np.concatenate(roots)[:, None] * jacobian[:, inside]
    scale = np.maximum(np.linalg.norm(J, axis=0), 1e-12)
    J = J / scale
    bread = np.linalg.pinv(J.T @ J, rcond=1e-12)
    n, p = J.shape
    classical = bread * float(residuals @ residuals) / max(n - p, 1)
    sums, first, effective = [], 0, 0.0
    for record, part in zip(problem.records, parts, strict=True):
        rows = slice(first, first + len(part))
        labels = np.resize(_blocks(record), len(part)).astype(int)
        products = J[rows] * part[:, None]
        sums.append([products[labels == k].sum(axis=0) for k in np.unique(labels)])
        effective += effective_samples(part)
        first += len(part)
    g = np.array([row for rows in sums for row in rows])
    count = len(g)
    meat = g.T @ g * count / max(count - p, 1)
    sandwich = bread @ meat @ bread
    grow = np.sqrt(np.maximum(1.0, np.diag(classical) / np.maximum(np.diag(sandwich), 1e-300)))
    chosen = sandwich * np.outer(grow, grow) / np.outer(scale, scale)
    full = np.zeros((len(cube), len(cube)))
    full[np.ix_(inside, inside)] = chosen
    return full, effective, n, float(np.sqrt(np.mean(residuals**2)))


def estimate(problem: Problem, cube: Floats) -> Uncertainty:
    """Standard errors, intervals and warnings at the optimum of a fit.

    Parameters
    ----------
    problem : residuals of the tests.
    cube : the optimum, in [0, 1] for each free parameter.

    Returns
    -------
    Uncertainty

    Examples
    --------
    >>> import thermobearing as tb
    >>> from thermobearing.identify.parameters import parameter_set
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.identify.synthetic_record(bearing, 23.0, test)
    >>> pset = parameter_set(bearing, ["K_r"], [23.0])
    >>> estimate(Problem([record], pset), pset.start).estimates[kinds.K_R].relative_error < 0.05
    True
    """
    from scipy.stats import t as student

    covariance, effective, samples, rms = _covariance(problem, cube)
    blocks = sum(len(np.unique(_blocks(record))) for record in problem.records)
    wide = float(student.ppf(0.5 + 0.5 * LEVEL, max(blocks - len(cube), 2)))
    estimates = {}
    for i, parameter in enumerate(problem.pset.free):
        u = float(cube[i])
        sigma = float(np.sqrt(covariance[i, i]))
        bound = not AT_BOUND < u < 1.0 - AT_BOUND
        estimates[parameter.kind.key] = Estimate(
            parameter=parameter,
            value=parameter.at(u),
            stderr=sigma * parameter.slope(u) if not bound else float("nan"),
            lower=parameter.at(max(u - wide * sigma, 0.0)),
            upper=parameter.at(min(u + wide * sigma, 1.0)),
            at_bound=bound,
        )
    spread = np.sqrt(np.diag(covariance))
    safe = np.where(spread > 0.0, spread, 1.0)
    correlation = covariance / np.outer(safe, safe)
    found = Uncertainty(estimates, covariance, correlation, samples, effective, rms)
    found.warnings.extend(_warnings(problem, found))
    return found


def _remedy(keys: set[str]) -> str:
    for known, words in kinds.REMEDIES:
        if keys & known:
            return words
    return "other tests would be needed"


def _warnings(problem: Problem, found: Uncertainty) -> list[str]:
    """Bounds reached, weak and entangled parameters, and tests too alike, in words."""
    said = _test_warnings(problem)
    for key, item in found.estimates.items():
        symbol, unit = item.parameter.kind.symbol, item.parameter.kind.unit
        shown = f"{symbol} = {item.value:.4g} {unit}".strip()
        if item.at_bound:
            said.append(f"{shown} ended at a bound: {_remedy({key})}")
        elif item.relative_error > POOR:
            said.append(
                f"{shown} is poorly determined (standard error {item.stderr:.2g}): {_remedy({key})}"
            )
    keys = list(found.estimates)
    for i, j in zip(*np.triu_indices(len(keys), 1), strict=True):
        rho = float(found.correlation[i, j])
        if abs(rho) > CORRELATED:
            a, b = (found.estimates[keys[k]].parameter.kind.symbol for k in (i, j))
            weak = any(found.estimates[keys[k]].relative_error > WELL for k in (i, j))
            if weak:
                said.append(
                    f"{a} and {b} are entangled (correlation {rho:.2f}): only a combination of "
                    f"them is known; {_remedy({keys[i], keys[j]})}"
                )
    if found.rms > NEGLIGIBLE and found.effective_samples < ALIKE * found.samples:
        said.append(
            "the residuals are not noise: they repeat themselves from sample to sample "
            f"({found.samples} samples are worth {found.effective_samples:.0f} independent ones), "
            "so the law misses something or the force was filtered; standard errors say how well "
            "the tests fix the numbers of this law, not that the law is right"
        )
    return said


def _test_warnings(problem: Problem) -> list[str]:
    """What the tests cannot tell, whatever they measured."""
    said = []
    free = {p.kind.key for p in problem.pset.free}
    ambients = [record.ambient for record in problem.records]
    if free & {kinds.M_T, kinds.N_T} and max(ambients) - min(ambients) < TEMPERATURE_SPAN:
        span = f"{min(ambients):g}"
        if max(ambients) > min(ambients):
            span += f" to {max(ambients):g}"
        said.append(
            f"m_T and n_T were fitted to tests at {span} degC only, mostly from self-heating: "
            f"{_remedy({kinds.M_T})}"
        )
    if free & {kinds.C_V, kinds.K_V}:
        speeds = [s for record in problem.records for s in _speeds(record)]
        if max(speeds) < SPEED_SPAN * min(speeds):
            said.append(
                f"c_v and K_v were fitted to mean speeds of {min(speeds):.3g} to "
                f"{max(speeds):.3g} mm/s only: {_remedy({kinds.C_V})}"
            )
    return said


def _speeds(record: TestRecord) -> list[float]:
    """Mean speed of each large half cycle [mm/s]."""
    turns = turning_points(record.displacement, BLOCK_TURN * record.peak_displacement)
    way = np.abs(np.diff(record.displacement[turns]))
    time = np.diff(record.time[turns])
    large = way > 0.5 * way.max()
    return [float(speed) for speed in way[large] / time[large]]
