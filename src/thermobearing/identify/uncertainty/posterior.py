"""Posterior distribution of the parameters, and the forecast from it.

By default samples come from the normal distribution of the fit (Laplace). With emcee
(Foreman-Mackey et al. 2013, the optional extra `bayes`) they come from the posterior itself,
whose likelihood is tempered by the effective number of samples (see covariance.py), flat
within the bounds on the scale of the search; the uncertainty of the assumed values (assumed.py) is
added to its draws.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.agreement import reached_in
from thermobearing.results.ranges import Row, asked_of_tests, limits_passed, outside_tests

WALKERS_PER = 3  # walkers for each parameter
LOW, HIGH = 0.025, 0.975
MOST_STEPS = 100_000  # of a walker
STEPS, BURN = 300, 100  # of a walker, kept and thrown away


@dataclass(frozen=True)
class Samples:
    """Points of the unit cube from the posterior, and how they were drawn."""

    cube: Floats  # [samples, parameters]
    source: str  # "laplace" or "emcee"
    acceptance: float = 1.0
    autocorrelation: float = 1.0  # steps of a walker until it forgets; nan if not known


@dataclass(frozen=True)
class Band:
    """95 % band of the force at the samples of a test, and of its peak.

    It carries the uncertainty of the parameters of this law; noise and what the law misses
    come on top.
    """

    ambient: float  # [degC]
    displacement: Floats  # at the samples [mm]
    best: Floats  # force [kN]
    lower: Floats
    upper: Floats
    peak: float  # largest force [kN]
    peak_lower: float
    peak_upper: float
    lead: tuple[float, float] | None = None  # coldest and warmest lead [degC]
    asked: tuple[Row, ...] = ()  # of the range of the tests, rows of `compared`

    @property
    def name(self) -> str:
        """Name of the run in sentences."""
        return f"predicted at {self.ambient:g} degC"

    @property
    def beyond_tested(self) -> str:
        """Quantities that are beyond the tests of the fit."""
        return limits_passed(self.asked, [self.name])[0]

    def summary(self) -> dict[str, Any]:
        """Return what summary.json says of the band."""
        return {
            "ambient_degC": self.ambient,
            "best_kN": self.peak,
            "lower_kN": self.peak_lower,
            "upper_kN": self.peak_upper,
            "beyond_tested": self.beyond_tested,
        }


@dataclass(frozen=True)
class Forecast:
    """Draws of the parameters, and their bands at some temperatures."""

    samples: Samples  # written as posterior.csv
    bands: tuple[Band, ...] = ()
    warnings: tuple[str, ...] = ()  # what of it goes beyond the tests

    def summary(self) -> dict[str, Any]:
        """Return what summary.json says of the forecast."""
        return {
            "source": self.samples.source,
            "samples": len(self.samples.cube),
            "acceptance": self.samples.acceptance,
            "autocorrelation_steps": self.samples.autocorrelation,
            "warnings": list(self.warnings),
            "peak_force": [band.summary() for band in self.bands],
        }


def forecast(
    found: Identification,
    ambients: Sequence[float] = (),
    *,
    posterior: bool = False,
    seed: int = 0,
) -> Forecast:
    """What the tests leave open at some temperatures: a band around the predicted loops.

    Parameters
    ----------
    found : from `identify_bearing`.
    ambients : temperatures [degC], each in [-100, 100]; that of the first test by default.
    posterior : sample the posterior with emcee; else the normal distribution of the fit.
    seed : of the draws, >= 0.

    Returns
    -------
    Forecast

    Raises
    ------
    InputError : a temperature out of range, emcee is not installed, or every draw ends early.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> colder, warmer = forecast(found, [-20.0, 23.0]).bands
    >>> colder.peak > warmer.peak
    True
    """
    draws = _posterior_samples if posterior else _laplace_samples
    samples = draws(found, seed=seed)
    at = list(ambients) or [found.records[0].ambient]
    assert found.bearing.tested_range is not None  # the range of the tests
    tested = found.bearing.tested_range.ranges()
    bands = []
    for one in at:
        band = _predictive_band(found, samples, one, seed=seed)
        thickness = found.bearing.total_rubber_thickness
        reached = reached_in(found.records[0], thickness, band.ambient, band.lead)
        bands.append(replace(band, asked=tuple(asked_of_tests(band.name, reached, tested))))
    rows = [row for band in bands for row in band.asked]
    said = outside_tests(found.bearing.name, rows, tested)
    return Forecast(samples, tuple(bands), tuple(said))


def _laplace_samples(found: Identification, count: int = 200, *, seed: int = 0) -> Samples:
    """Draw from the normal distribution of the fit, within the bounds."""
    rng = np.random.default_rng(seed)
    values, vectors = np.linalg.eigh(found.uncertainty.covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    draws = found.cube + rng.normal(size=(count, len(found.cube))) @ root.T
    return Samples(np.clip(draws, 0.0, 1.0), "laplace")


def need_emcee() -> None:
    """Refuse a posterior without emcee, before an hour of fitting."""
    try:
        import emcee  # noqa: F401
    except ImportError:
        raise InputError(
            "the posterior needs emcee: pip install 'thermobearing[bayes]'; without it, "
            "the normal distribution of the fit is sampled"
        ) from None


def _walkers(found: Identification) -> int:
    return max(2 * len(found.cube) + 2, WALKERS_PER * len(found.cube))


def posterior_effort(
    found: Identification, *, steps: int = STEPS, burn: int = BURN
) -> tuple[int, float]:
    """Return the most runs of a test that `_posterior_samples` takes, and about how long [s].

    Draws beyond a bound need no run; the time is that of one more run of the fit by the clock.
    """
    rounds = _walkers(found) * (burn + steps + 1)  # and each walker's begin
    begin = time.perf_counter()
    found.problem.parts(found.cube, fine=True)
    return rounds * len(found.records), rounds * (time.perf_counter() - begin)


def _posterior_samples(
    found: Identification, *, steps: int = STEPS, burn: int = BURN, seed: int = 0
) -> Samples:
    """Draw from the posterior by the ensemble sampler of emcee.

    Each walker makes `steps` after `burn` steps that do not count.
    """
    if not (1 <= steps <= MOST_STEPS and 0 <= burn <= MOST_STEPS):
        raise InputError(f"steps = {steps}, burn = {burn}: must be 1 and 0 to {MOST_STEPS}")
    need_emcee()
    import emcee

    problem, best = found.problem, found.cube
    residual = np.concatenate(problem.parts(best, fine=True))
    variance = float(residual @ residual) / max(len(residual) - len(best), 1)
    worth = found.uncertainty.effective_samples / found.uncertainty.samples

    def _log_probability(u: Floats) -> float:
        if (u < 0.0).any() or (u > 1.0).any():
            return float("-inf")
        r = np.concatenate(problem.parts(u, fine=True))
        return -0.5 * worth * float(r @ r) / variance

    walkers = _walkers(found)
    start = _laplace_samples(found, walkers, seed=seed).cube
    start = np.clip(start + 1e-6 * np.random.default_rng(seed).random(start.shape), 0.0, 1.0)
    sampler = emcee.EnsembleSampler(walkers, len(best), _log_probability)
    sampler.random_state = np.random.RandomState(seed).get_state()
    sampler.run_mcmc(start, burn + steps, skip_initial_state_check=True)
    tau = float(np.mean(sampler.get_autocorr_time(quiet=True, tol=0)))
    chain = _with_assumed(found, np.asarray(sampler.get_chain(discard=burn, flat=True)), seed)
    return Samples(chain, "emcee", float(np.mean(sampler.acceptance_fraction)), tau)


def _with_assumed(found: Identification, cube: Floats, seed: int) -> Floats:
    """Return draws moved by the uncertainty of the assumed values."""
    assumed, inside = found.uncertainty.assumed, found.uncertainty.inside
    groups = len(assumed.spread)
    rng = np.random.default_rng(seed)
    off = rng.multivariate_normal(np.zeros(groups), assumed.spread, size=len(cube))
    moved = cube.copy()
    moved[:, inside] += off @ assumed.shifts.T
    return np.clip(moved, 0.0, 1.0)


def _predictive_band(
    found: Identification,
    samples: Samples,
    ambient: float,
    *,
    record: TestRecord | None = None,
    count: int = 60,
    seed: int = 0,
) -> Band:
    """Return the band of loops and of peak force at an ambient temperature [degC], -100 to 100.

    It repeats the displacements of `record`, by default the first of the fit, with `count` draws.
    """
    if not -100.0 <= ambient <= 100.0:
        raise InputError(f"ambient = {ambient} degC: must be between -100 and 100 degC")
    test = record or found.records[0]
    model = ForwardModel(test, found.bearing, fine=True, ambient=ambient)
    picked = np.random.default_rng(seed).choice(len(samples.cube), size=count)
    runs = [model.run(found.pset.bearing(samples.cube[i])) for i in picked]
    forces = np.array([run.force for run in runs if run is not None])
    best = model.run(found.bearing)
    if best is None or len(forces) == 0:
        raise InputError(f"the model ends early in the test at {ambient:g} degC")
    lower, upper = np.quantile(forces, [LOW, HIGH], axis=0)
    peak_lower, peak_upper = np.quantile(np.abs(forces).max(axis=1), [LOW, HIGH])
    return Band(
        ambient=ambient,
        displacement=test.displacement,
        best=best.force,
        lower=lower,
        upper=upper,
        peak=float(np.abs(best.force).max()),
        peak_lower=float(peak_lower),
        peak_upper=float(peak_upper),
        lead=best.lead,
    )
