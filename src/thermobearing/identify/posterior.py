"""What the tests leave open, carried into loops and peak forces: samples and bands.

By default samples come from the normal distribution of the fit (Laplace). With emcee
(Foreman-Mackey et al. 2013, the optional extra `bayes`) they come from the posterior itself,
whose likelihood is tempered by the effective number of samples (see uncertainty.py), flat
within the bounds on the scale of the search.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.identify.forward import ForwardModel
from thermobearing.identify.record import TestRecord
from thermobearing.identify.run import Identification

Floats = NDArray[np.float64]

WALKERS_PER = 3  # walkers for each parameter
LOW, HIGH = 0.025, 0.975


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

    ambient: float
    displacement: Floats
    best: Floats
    lower: Floats
    upper: Floats
    peak: float
    peak_lower: float
    peak_upper: float


def laplace_samples(found: Identification, count: int = 200, *, seed: int = 0) -> Samples:
    """Draws from the normal distribution of the fit, within the bounds."""
    rng = np.random.default_rng(seed)
    values, vectors = np.linalg.eigh(found.uncertainty.covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    draws = found.cube + rng.normal(size=(count, len(found.cube))) @ root.T
    return Samples(np.clip(draws, 0.0, 1.0), "laplace")


def posterior_samples(
    found: Identification, *, steps: int = 300, burn: int = 100, seed: int = 0
) -> Samples:
    """Draws from the posterior by emcee's ensemble sampler.

    Parameters
    ----------
    found : a fit.
    steps : of each walker, after `burn` that are thrown away; both >= 1.
    seed : of the walkers.

    Raises
    ------
    InputError : emcee is not installed.
    """
    try:
        import emcee
    except ImportError:
        raise InputError(
            "the posterior needs emcee: pip install 'thermobearing[bayes]'; without it, "
            "laplace_samples draws from the normal distribution of the fit"
        ) from None
    problem, best = found.problem, found.cube
    residual = np.concatenate(problem.parts(best, fine=True))
    variance = float(residual @ residual) / max(len(residual) - len(best), 1)
    worth = found.uncertainty.effective_samples / found.uncertainty.samples

    def log_probability(u: Floats) -> float:
        if (u < 0.0).any() or (u > 1.0).any():
            return float("-inf")
        r = np.concatenate(problem.parts(u, fine=True))
        return -0.5 * worth * float(r @ r) / variance

    walkers = max(2 * len(best) + 2, WALKERS_PER * len(best))
    start = laplace_samples(found, walkers, seed=seed).cube
    start = np.clip(start + 1e-6 * np.random.default_rng(seed).random(start.shape), 0.0, 1.0)
    sampler = emcee.EnsembleSampler(walkers, len(best), log_probability)
    sampler.random_state = np.random.RandomState(seed).get_state()
    sampler.run_mcmc(start, burn + steps, skip_initial_state_check=True)
    tau = float(np.mean(sampler.get_autocorr_time(quiet=True, tol=0)))
    chain = np.asarray(sampler.get_chain(discard=burn, flat=True))
    return Samples(chain, "emcee", float(np.mean(sampler.acceptance_fraction)), tau)


def predictive_band(
    found: Identification,
    samples: Samples,
    ambient: float,
    *,
    record: TestRecord | None = None,
    count: int = 60,
    seed: int = 0,
) -> Band:
    """Band of loops and of peak force at an ambient temperature, tested or not.

    Parameters
    ----------
    found, samples : a fit and draws of its parameters.
    ambient : [degC], in [-100, 100].
    record : whose displacements to repeat; the first of the fit by default.
    count : draws to run.
    seed : picks the draws.

    Raises
    ------
    InputError : the temperature is out of range, or no draw gets through.
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
        raise InputError(f"the model does not get through the test at {ambient:g} degC")
    peaks = np.abs(forces).max(axis=1)
    lower, upper = np.quantile(forces, [LOW, HIGH], axis=0)
    return Band(
        ambient, test.displacement, best.force, lower, upper, float(np.abs(best.force).max()),
        *(float(q) for q in np.quantile(peaks, [LOW, HIGH])),
    )  # fmt: skip
