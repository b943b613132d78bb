"""Posterior distribution of the parameters, and the forecast from it.

By default samples come from the normal distribution of the estimates (Laplace). With emcee
(Foreman-Mackey et al. 2013, the optional extra `bayes`) they come from the posterior itself,
whose likelihood is tempered by the effective number of samples (see covariance.py), flat
within the bounds on the scale of the search; the uncertainty of the assumed values is added to
its draws.
"""

import csv
import io
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.bearing.library import as_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import extract_compound, lead_cores, split_parts
from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.schema import validated
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.records.record import reached_values
from thermobearing.identify.result import Identification
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.results.ranges import compare_with_tests, limits_passed, outside_tests
from thermobearing.tables.text import read_text

WALKERS_PER = 3  # walkers for each parameter
LOW, HIGH = 0.025, 0.975
STEPS, BURN = 300, 100  # of a walker, kept and thrown away
MOST = 10_000  # of samples
FAR = 10.0  # standard deviations from the mean of the samples, ...
APART = 0.2  # ... and this part of it: not the bearing that they are of
ALIKE = 1e-6  # relative difference of two compounds that are one, their files read and written


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

    It contains the uncertainty of the parameters only, neither noise nor model error.
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
    beyond_tested: str = ""  # quantities outside the calibration range


@dataclass(frozen=True)
class Forecast:
    """Draws of the parameters, and their bands at some temperatures."""

    samples: Samples  # written as posterior.csv
    bands: tuple[Band, ...] = ()
    warnings: tuple[str, ...] = ()  # statements on extrapolation beyond the tests

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the forecast."""
        return {
            "source": self.samples.source,
            "samples": len(self.samples.cube),
            "acceptance": self.samples.acceptance,
            "autocorrelation_steps": self.samples.autocorrelation,
            "warnings": list(self.warnings),
            "peak_force": [
                {
                    "ambient_degC": band.ambient,
                    "best_kN": band.peak,
                    "lower_kN": band.peak_lower,
                    "upper_kN": band.peak_upper,
                    "beyond_tested": band.beyond_tested,
                }
                for band in self.bands
            ],
        }


def forecast(
    found: Identification, ambients: Sequence[float] = (), *, posterior: bool = False, seed: int = 0
) -> Forecast:
    """Predict loops at ambient temperatures, with 95 % bands by the uncertainty of parameters.

    Parameters
    ----------
    found : from `identify_bearing`.
    ambients : temperatures [degC], each in [-100, 100]; that of the first test by default.
    posterior : sample the posterior with emcee; otherwise the normal distribution of the estimates.
    seed : of the draws, >= 0.

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
    bands, rows = [], []
    for one in at:
        band, name = _predictive_band(found, samples, one, seed=seed), f"predicted at {one:g} degC"
        thickness = found.bearing.total_rubber_thickness
        reached = reached_values(found.records[0], thickness, one, band.lead)
        compared = list(compare_with_tests(name, reached, tested))
        bands.append(replace(band, beyond_tested=limits_passed(compared, [name])[0]))
        rows += compared
    said = outside_tests(found.bearing.name, rows, tested)
    return Forecast(samples, tuple(bands), tuple(said))


def _laplace_samples(found: Identification, count: int = 200, *, seed: int = 0) -> Samples:
    """Draw from the normal distribution of the fit, within the bounds."""
    draws = found.cube + _normal_draws(found.uncertainty.covariance, count, seed)
    return Samples(np.clip(draws, 0.0, 1.0), "laplace")


def _normal_draws(covariance: Floats, count: int, seed: int) -> Floats:
    """Return draws from a normal distribution [count, n], the same ones on every machine.

    The symmetric root of the covariance is unique, signs and axes of eigenvectors are not.
    """
    values, axes = np.linalg.eigh(covariance)
    root = (axes * np.sqrt(np.maximum(values, 0.0))) @ axes.T
    return np.asarray(np.random.default_rng(seed).normal(size=(count, len(root))) @ root)


def need_emcee() -> None:
    """Refuse a posterior without emcee before the calibration starts."""
    try:
        import emcee  # noqa: F401
    except ImportError:
        raise InputError(
            "the posterior needs emcee: pip install 'thermobearing[bayes]'; without it, "
            "the normal distribution of the estimates is sampled"
        ) from None


def _walkers(found: Identification) -> int:
    return max(2 * len(found.cube) + 2, WALKERS_PER * len(found.cube))


def posterior_effort(
    found: Identification, *, steps: int = STEPS, burn: int = BURN
) -> tuple[int, float]:
    """Return the largest number of runs of `_posterior_samples`, and their approximate time [s].

    Draws beyond a bound need no run; the time is measured with one run.
    """
    rounds = _walkers(found) * (burn + steps + 1)  # and each walker's begin
    begin = time.perf_counter()
    found.problem.parts(found.cube, fine=True)
    return rounds * len(found.records), rounds * (time.perf_counter() - begin)


def _posterior_samples(
    found: Identification, *, steps: int = STEPS, burn: int = BURN, seed: int = 0
) -> Samples:
    """Draw by the ensemble sampler of emcee: each walker makes `steps` after `burn`."""
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
    moved = cube.copy()
    moved[:, inside] += _normal_draws(assumed.spread, len(cube), seed) @ assumed.shifts.T
    return np.clip(moved, 0.0, 1.0)


def _predictive_band(
    found: Identification, samples: Samples, ambient: float, *, count: int = 60, seed: int = 0
) -> Band:
    """Return the band of loops as in the first test and of peak force at an ambient [degC]."""
    if not -100.0 <= ambient <= 100.0:
        raise InputError(f"ambient = {ambient} degC: must be between -100 and 100 degC")
    test = found.records[0]
    model = ForwardModel(test, found.bearing, fine=True, ambient=ambient)
    picked = np.random.default_rng(seed).choice(len(samples.cube), size=count)
    runs = [model.run(found.pset.bearing(samples.cube[i])) for i in picked]
    forces = np.array([run.force for run in runs if run is not None])
    best = model.run(found.bearing)
    if best is None or len(forces) == 0:
        raise InputError(f"the model does not complete the test at {ambient:g} degC")
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


def posterior_bearings(
    bearing: Bearing | str | Path, path: str | Path, count: int = 20
) -> list[Bearing]:
    r"""Return the calibrated bearing, followed by bearings of samples of its posterior.

    A bearing of another size, made of the calibrated compound, is possible if `bearing.toml` of the
    calibration is in the directory of the samples: each sample is then scaled to that size.

    Parameters
    ----------
    bearing : the calibrated one, or one made of its compound: a name, a file or a Bearing.
    path : posterior.csv of `identify`: a column for each parameter, a row for each sample.
    count : number of samples, 1 to 10 000, evenly through the file; all if it has fewer.

    Returns
    -------
    list of Bearing : the bearing itself first, then the samples, each with a unique name; for
        `tb.sweep`, `tb.bridge` and `temperature_factors`.

    Raises
    ------
    InputError : no such file, columns that are no parameters of the bearing, cells that are no
        numbers or that a bearing may not have; samples of another bearing.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "posterior.csv")
    ...     _ = file.write_text("K_r,m_T\n30,-1.1\n31,-1.2\n")
    ...     bearings = posterior_bearings("shen-hdr-specimen", file)
    >>> [(item.name, item.hysteresis.layer_stiffness) for item in bearings[1:]]
    [('shen-hdr-specimen, sample 1', 30.0), ('shen-hdr-specimen, sample 2', 31.0)]
    """
    first, where = as_bearing(bearing), str(path)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST:
        raise InputError(f"samples = {count!r}: must be an integer from 1 to {MOST}")
    rows = [row for row in csv.reader(io.StringIO(read_text(Path(path)))) if any(row)]
    if len(rows) < 2:
        raise InputError(
            "contains no samples: a line of symbols and a row for each sample are needed", where
        )
    fitted = _fitted(first, Path(path).parent / IDENTIFIED)
    keys = _keys(rows[0], fitted, where)
    chosen = np.unique(np.linspace(1, len(rows) - 1, min(count, len(rows) - 1)).round().astype(int))
    some = [_sample(fitted, keys, rows[k], k, where) for k in chosen.tolist()]
    if fitted is first:
        _refuse_others(first, keys, some, where)
        return [first, *some]
    sized = []
    for sample, number in zip(some, chosen, strict=True):
        parts = split_parts(extract_compound(sample), first.geometry, lead_cores(first))
        parts |= {"scragging": sample.scragging, "name": f"{first.name}, sample {number}"}
        sized.append(first.model_copy(update=parts))
    return [first, *sized]


def _fitted(bearing: Bearing, place: Path) -> Bearing:
    """Return the bearing of the samples: the one in their directory if it has another size."""
    if not is_file(place):
        return bearing
    try:
        fitted = load_bearing(place)
    except InputError:  # a poor fit does not load: the given bearing's numbers must do
        return bearing
    if fitted.geometry == bearing.geometry and lead_cores(fitted) == lead_cores(bearing):
        return bearing
    other = extract_compound(bearing).rubber
    for key, value in extract_compound(fitted).rubber:
        mine = getattr(other, key)
        number = isinstance(mine, float) and isinstance(value, float)
        if abs(mine - value) > ALIKE * abs(value) if number else mine != value:
            shown, wanted = (f"{v:.6g}" if number else str(v) for v in (mine, value))
            said = (
                f"{bearing.name} differs in size from {fitted.name}, to which the samples belong, "
            )
            said += f"and is not made of its compound: {key} is {shown}, not {wanted}; create it "
            said += f"with thermobearing new --compound {place}"
            raise InputError(said, str(place.with_name(SAMPLES)))
    return fitted


def _refuse_others(bearing: Bearing, keys: list[str], some: list[Bearing], where: str) -> None:
    """Refuse samples of a bearing of another size, by the numbers that depend on the size."""
    for kind in kinds.available(bearing):
        if kind.key not in keys or not kind.relative:
            continue
        values = np.array([kinds.dotted_value(one, kind.key) for one in some])
        own, mean = kinds.dotted_value(bearing, kind.key) or 0.0, float(values.mean())
        if abs(own - mean) > max(FAR * float(values.std()), APART * abs(mean)):
            said = f"{kind.symbol} is {mean:.4g} {kind.unit} in the samples and {own:.4g} in "
            said += (
                f"{bearing.name}: they belong to another bearing. A bearing of the same compound "
            )
            said += f"can use them if {IDENTIFIED} of the calibration is in their directory"
            raise InputError(said, where)


def _keys(head: list[str], bearing: Bearing, where: str) -> list[str]:
    known = kinds.keys_by_name(bearing)
    faults, keys = [], []
    data = bearing.model_dump()
    for symbol in (text.strip() for text in head):
        if symbol not in known:
            faults.append(f'no parameter is called "{symbol}"{nearest(symbol, known)}')
            continue
        key = known[symbol]
        if not isinstance(data.get(key.split(".")[0]), dict):
            faults.append(f'"{symbol}": {bearing.name} ({bearing.kind}) has none')
        keys.append(key)
    if len(set(keys)) < len(keys):
        faults.append("a parameter has two columns")
    if faults:
        raise InputError(faults, where)
    return keys


def _sample(bearing: Bearing, keys: list[str], cells: list[str], number: int, path: str) -> Bearing:
    where = f"{path}, row {number}"
    if len(cells) != len(keys):
        raise InputError(f"{len(cells)} numbers instead of {len(keys)}", where)
    data = bearing.model_dump()
    for key, cell in zip(keys, cells, strict=True):
        table, name = key.split(".")
        try:
            data[table][name] = float(cell)
        except ValueError:
            raise InputError(f'"{cell}" is not a number', where) from None
    data["name"] = f"{bearing.name}, sample {number}"
    return validated(Bearing, data, where, from_file=False)
