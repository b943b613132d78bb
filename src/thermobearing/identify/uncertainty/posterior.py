"""Posterior distribution of the parameters, and the forecast from it.

By default samples come from the normal distribution of the estimates (Laplace). With emcee
(Foreman-Mackey et al. 2013, the optional extra `bayes`) they come from the posterior itself,
whose likelihood is tempered by the effective number of samples (see covariance.py), flat
within the bounds on the scale of the search.

A sample has a value of every number that is uncertain: of the free parameters, and of all that are
held at an assumed value. The optimum moves with the assumed values (covariance.py), so both are
drawn together. Errors are widened by the factors that the intervals contain.
"""

import csv
import io
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
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
from thermobearing.identify.records.cycles import largest_measures
from thermobearing.identify.records.record import TestRecord, reached_values
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.covariance import chosen_groups, shift
from thermobearing.quantities.governing import order_from_largest
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.results.ranges import (
    compare_with_tests,
    extrapolation,
    limits_passed,
    outside_tests,
    widened,
)
from thermobearing.results.sums import product_in_order, sum_of_products
from thermobearing.tables.text import read_text

WALKERS_PER = 3  # walkers for each parameter
LOW, HIGH = 0.025, 0.975
# Of a forecast: the ends of a 95 % interval then vary by a tenth of its half width.
DRAWS = 400
MOST_ROUNDS = 50  # of draws until enough are within the bounds
UNITS = {"force": "kN", "K_eq": "kN/mm", "Q_d": "kN", "energy": "kN mm"}
OUTSIDE = "outside the tests"  # among the causes of a band
LEAST_SHARE = 0.05  # of a variance: smaller ones are not named
PART = 0.5  # of a standard error: the step of a derivative
STEPS, BURN = 300, 100  # of a walker, kept and thrown away
MOST = 10_000  # of samples
HEAT = "materials."  # thermal numbers, which have no size
FAR = 10.0  # standard deviations from the mean of the samples, ...
APART = 0.2  # ... and this part of it: not the bearing that they are of
ALIKE = 1e-6  # relative difference of two compounds that are one, their files read and written


@dataclass(frozen=True)
class Samples:
    """Points of the unit cube from the posterior, and how they were drawn."""

    cube: Floats  # [samples, parameters]
    source: str  # "laplace" or "emcee"
    held: Floats  # [samples, groups] change of each assumed group, in standard uncertainties
    acceptance: float = 1.0
    autocorrelation: float = 1.0  # steps of a walker until it forgets; nan if not known


@dataclass(frozen=True)
class Predicted:
    """A quantity of a predicted test with its 95 % band, and where the band comes from."""

    quantity: str  # "force", "K_eq", "Q_d" or "energy"
    best: float  # [kN], [kN/mm], [kN], [kN mm]
    lower: float
    upper: float
    # Share of its variance by each cause: "tests" for their scatter, and the assumed groups.
    shares: dict[str, float] = field(default_factory=dict)
    held_share: float = 0.0  # of numbers of the bearing that the tests did not determine
    draws: Floats = field(default_factory=lambda: np.zeros(0), repr=False)  # that completed

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the quantity."""
        return {
            "quantity": self.quantity,
            "unit": UNITS[self.quantity],
            "best": self.best,
            "lower": self.lower,
            "upper": self.upper,
            "share_not_determined": self.held_share,
            "shares": self.shares,
        }


@dataclass(frozen=True)
class Band:
    """95 % band of the force at the samples of a test, and of its measures.

    It contains the uncertainty of the free parameters and of all that are held, neither noise nor
    model error.
    """

    ambient: float  # [degC]
    displacement: Floats  # at the samples [mm]
    best: Floats  # force [kN]
    lower: Floats
    upper: Floats
    predicted: tuple[Predicted, ...]  # the peak force first
    lead: tuple[float, float] | None = None  # coldest and warmest lead [degC]
    beyond_tested: str = ""  # quantities outside the calibration range

    @property
    def peak(self) -> float:
        """Largest force with the calibrated parameters [kN]."""
        return self.predicted[0].best

    @property
    def peak_lower(self) -> float:
        """Lower end of the 95 % band of the largest force [kN]."""
        return self.predicted[0].lower

    @property
    def peak_upper(self) -> float:
        """Upper end of the 95 % band of the largest force [kN]."""
        return self.predicted[0].upper


@dataclass(frozen=True)
class Forecast:
    """Draws of the parameters, and their bands at some temperatures."""

    samples: Samples
    bands: tuple[Band, ...] = ()
    warnings: tuple[str, ...] = ()  # statements on extrapolation beyond the tests
    notes: tuple[str, ...] = ()  # where the bands come from
    columns: dict[str, Floats] = field(default_factory=dict)  # of posterior.csv, by symbol or key

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the forecast."""
        return {
            "source": self.samples.source,
            "samples": len(self.samples.cube),
            "acceptance": self.samples.acceptance,
            "autocorrelation_steps": self.samples.autocorrelation,
            "warnings": list(self.warnings),
            "notes": list(self.notes),
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
            "predicted": [
                {
                    "ambient_degC": band.ambient,
                    **item.summary(),
                    "beyond_tested": band.beyond_tested,
                }
                for band in self.bands
                for item in band.predicted
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
        bands.append(_outside(band, limits_passed(compared, [name])[0], extrapolation(compared)))
        rows += compared
    said = outside_tests(found.bearing.name, rows, tested)
    columns = _sample_columns(found, samples)
    return Forecast(samples, tuple(bands), tuple(said), tuple(map(_share_note, bands)), columns)


def _outside(band: Band, beyond: str, more: float) -> Band:
    """Return a band with the quantities outside the tests, and as wide as that makes it.

    `more` is the relative standard uncertainty of forces there.
    """
    if not more:
        return replace(band, beyond_tested=beyond)
    lower, upper = widened(band.lower, band.upper, band.best, more, HIGH)
    predicted = []
    for item in band.predicted:
        low, high = map(float, widened(item.lower, item.upper, item.best, more, HIGH))
        grown = ((high - low) / max(item.upper - item.lower, 1e-300)) ** 2  # of the variance
        shares = {name: share / grown for name, share in item.shares.items()}
        shares[OUTSIDE] = 1.0 - 1.0 / grown
        held = item.held_share / grown + shares[OUTSIDE]
        predicted.append(replace(item, lower=low, upper=high, shares=shares, held_share=held))
    wide = replace(band, lower=lower, upper=upper, predicted=tuple(predicted))
    return replace(wide, beyond_tested=beyond)


def _share_note(band: Band) -> str:
    """Return a sentence on the share of a band that the tests did not determine."""
    item = next((p for p in band.predicted if p.quantity == "K_eq"), band.predicted[0])
    half = 0.5 * (item.upper - item.lower) / item.best
    shares = {name: share for name, share in item.shares.items() if share >= LEAST_SHARE}
    names = [list(shares)[k] for k in order_from_largest(list(shares.values()))]
    causes = ", ".join(f"{name} {shares[name]:.0%}" for name in names)
    return (
        f"{item.quantity} at {band.ambient:g} degC is known to \N{PLUS-MINUS SIGN}{half:.1%}; "
        f"{item.held_share:.0%} of its variance comes from what the tests did not determine "
        f"({causes})"
    )


def _laplace_samples(found: Identification, count: int = DRAWS, *, seed: int = 0) -> Samples:
    """Draw from the normal distribution of the fit, within the bounds."""
    cube, held = _draw(found, count, seed)
    return Samples(cube, "laplace", held)


def _draw(found: Identification, count: int, seed: int) -> tuple[Floats, Floats]:
    """Return places in the unit cube [count, n] and changes of the assumed groups [count, m].

    Draws beyond a bound are drawn again: a parameter at its bound has draws on one side only, and
    the parameters that are correlated with it follow.
    """
    about, rng = found.uncertainty, np.random.default_rng(seed)
    cubes, changes, kept = [], [], 0
    for _ in range(MOST_ROUNDS):
        held = _draw_held(found, count, rng)
        errors = _normal_draws(about.widening**2 * about.of_tests, count, rng)
        cube = found.cube + errors + product_in_order(held, about.assumed.shifts.T)
        inside = ((cube >= 0.0) & (cube <= 1.0)).all(axis=1)
        cubes.append(cube[inside])
        changes.append(held[inside])
        kept += int(inside.sum())
        if kept >= count:
            break
    else:  # nearly all are beyond a bound
        cubes.append(np.clip(cube, 0.0, 1.0))
        changes.append(held)
    return np.concatenate(cubes)[:count], np.concatenate(changes)[:count]


def _draw_held(found: Identification, count: int, rng: np.random.Generator) -> Floats:
    """Return changes of the assumed groups, in standard uncertainties [count, groups]."""
    assumed = found.uncertainty.assumed
    return _normal_draws(assumed.spread * np.outer(assumed.widening, assumed.widening), count, rng)


def _normal_draws(covariance: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return draws from a normal distribution [count, n], the same ones on every machine."""
    draws = rng.normal(size=(count, len(covariance)))
    return product_in_order(draws, _symmetric_root(covariance))


def _symmetric_root(covariance: Floats) -> Floats:
    """Return the symmetric root, which is unique: signs and axes of eigenvectors are not."""
    values, axes = np.linalg.eigh(covariance)
    return np.asarray((axes * np.sqrt(np.maximum(values, 0.0))) @ axes.T)


def drawn_bearing(found: Identification, cube: Floats, held: Floats) -> Bearing:
    """Return the bearing of a draw: its free parameters, and what is held at an assumed value."""
    bearing = found.pset.bearing(cube)
    for group, sigmas in zip(found.uncertainty.assumed.groups, held.tolist(), strict=True):
        if not group.of_tests:
            bearing = shift(bearing, group, sigmas)
    return bearing


def _sample_columns(found: Identification, samples: Samples) -> dict[str, Floats]:
    """Return the columns of posterior.csv: free and tied parameters, then what is held."""
    names = {p.kind.key: p.kind.symbol for p in found.pset.parameters}
    keys = [p.kind.key for p in found.pset.free]
    keys += [p.kind.key for p in found.pset.parameters if p.tie is not None]
    keys += [
        key
        for group in found.uncertainty.assumed.groups
        if not group.of_tests
        for key in group.keys
        if kinds.dotted_value(found.bearing, key) is not None
    ]
    bearings = [
        drawn_bearing(found, place, held)
        for place, held in zip(samples.cube, samples.held, strict=True)
    ]
    return {
        names.get(key, key): np.array([kinds.dotted_value(bearing, key) for bearing in bearings])
        for key in keys
    }


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
    chain = np.asarray(sampler.get_chain(discard=burn, flat=True))
    held = _draw_held(found, len(chain), np.random.default_rng(seed))
    moved = chain + product_in_order(held, found.uncertainty.assumed.shifts.T)
    acceptance = float(np.mean(sampler.acceptance_fraction))
    return Samples(np.clip(moved, 0.0, 1.0), "emcee", held, acceptance, tau)


def _predictive_band(
    found: Identification, samples: Samples, ambient: float, *, count: int = DRAWS, seed: int = 0
) -> Band:
    """Return the band of loops as in the first test and of its measures at an ambient [degC]."""
    if not -100.0 <= ambient <= 100.0:
        raise InputError(f"ambient = {ambient} degC: must be between -100 and 100 degC")
    test, picked = found.records[0], np.arange(len(samples.cube))
    if len(picked) > count:
        picked = np.random.default_rng(seed).choice(len(picked), size=count, replace=False)
    best = ForwardModel(test, found.bearing, fine=True, ambient=ambient).run(found.bearing)
    # Draws differ from the best estimate alike with coarse steps, at a fifth of the time.
    coarse = ForwardModel(test, found.bearing, ambient=ambient)
    middle = coarse.run(found.bearing)

    def _force(cube: Floats, held: Floats) -> Floats | None:
        bearing = drawn_bearing(found, cube, held)
        run = coarse.rebuilt(bearing).run(bearing)
        if run is None or best is None or middle is None:
            return None
        return np.asarray(best.force + (run.force - middle.force))

    runs = [_force(samples.cube[i], samples.held[i]) for i in picked]
    forces = np.array([force for force in runs if force is not None])
    if best is None or len(forces) == 0:
        raise InputError(f"the model does not complete the test at {ambient:g} degC")
    lower, upper = np.quantile(forces, [LOW, HIGH], axis=0)
    measures = [largest_measures(test, force) for force in forces]
    middles = largest_measures(test, best.force)
    sources = _sources(found, lambda *at: _measured(test, _force(*at)), middles)
    predicted = []
    for name, value in middles.items():
        drawn = np.array([item[name] for item in measures])
        low, high = np.quantile(drawn, [LOW, HIGH]).tolist()
        predicted.append(Predicted(name, value, low, high, *sources[name], drawn))
    return Band(
        ambient=ambient,
        displacement=test.displacement,
        best=best.force,
        lower=lower,
        upper=upper,
        predicted=tuple(predicted),
        lead=best.lead,
    )


def _measured(test: TestRecord, force: Floats | None) -> dict[str, float] | None:
    return None if force is None else largest_measures(test, force)


def _sources(
    found: Identification,
    measure: Callable[[Floats, Floats], dict[str, float] | None],
    middles: Mapping[str, float],
) -> dict[str, tuple[dict[str, float], float]]:
    """Return the share of each cause in the variance of each quantity, and that of what is held.

    By derivatives at the best estimate: along the axes of the errors by the tests, and by one
    standard uncertainty of each assumed group, with which the parameters move.
    """
    about = found.uncertainty
    nothing = np.zeros(len(about.assumed.groups))
    roots = _symmetric_root(about.widening**2 * about.of_tests)
    shifts, widening = about.assumed.shifts, about.assumed.widening

    def _slopes(along: Floats, held: Floats) -> dict[str, float]:
        step = PART
        place = found.cube + step * along
        if ((place < 0.0) | (place > 1.0)).any():  # beyond a bound: the other way
            step = -PART
        moved = measure(np.clip(found.cube + step * along, 0.0, 1.0), step * held)
        return {
            name: 0.0 if moved is None else (moved[name] - value) / step
            for name, value in middles.items()
        }

    of_tests = [_slopes(axis, nothing) for axis in roots]
    of_groups = [
        _slopes(shifts[:, k] * wide, np.where(np.arange(len(nothing)) == k, wide, 0.0))
        for k, wide in enumerate(widening)
    ]
    shares = {}
    for name in middles:
        slope = np.array([one[name] for one in of_groups])
        scatter = sum_of_products(*[[one[name] for one in of_tests]] * 2)
        parts = slope * product_in_order(about.assumed.spread, slope)
        whole = max(scatter + float(np.sum(parts)), 1e-300)
        groups = about.assumed.groups
        causes = {"tests": scatter / whole}
        causes |= dict(zip((g.name for g in groups), (parts / whole).tolist(), strict=True))
        held = sum(causes[group.name] for group in groups if not group.of_tests)
        order = [list(causes)[k] for k in order_from_largest(list(causes.values()))]
        shares[name] = {cause: causes[cause] for cause in order}, min(max(held, 0.0), 1.0)
    return shares


def posterior_bearings(
    bearing: Bearing | str | Path, path: str | Path, count: int = 20, *, heat: bool = True
) -> list[Bearing]:
    r"""Return the calibrated bearing, followed by bearings of samples of its posterior.

    A bearing of another size, made of the calibrated compound, is possible if `bearing.toml` of the
    calibration is in the directory of the samples: each sample is then scaled to that size.

    Parameters
    ----------
    bearing : the calibrated one, or one made of its compound: a name, a file or a Bearing.
    path : posterior.csv of `identify`: a column for each parameter, a row for each sample.
    count : number of samples, 1 to 10 000, evenly through the file; all if it has fewer.
    heat : draw the thermal numbers and the thickness of the rubber too. Studies leave them out,
        since runs in lockstep have the same cells.

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
        cells = {} if heat else {"geometry": first.geometry, "materials": first.materials}
        return [first, *(sample.model_copy(update=cells) for sample in some)]
    warm = [key for key in keys if heat and key.startswith(HEAT)]
    sized = []
    for sample, number in zip(some, chosen, strict=True):
        parts = split_parts(extract_compound(sample), first.geometry, lead_cores(first))
        parts |= {"scragging": sample.scragging, "name": f"{first.name}, sample {number}"}
        other = first.model_copy(update=parts)
        sized.append(_with_ratios(other, sample, fitted, warm))
    return [first, *sized]


def _with_ratios(bearing: Bearing, sample: Bearing, fitted: Bearing, keys: list[str]) -> Bearing:
    """Return a bearing whose thermal numbers differ as those of a sample from the calibration's."""
    values = {}
    for key in keys:
        numbers = [kinds.dotted_value(item, key) for item in (bearing, sample, fitted)]
        mine, drawn, middle = (0.0 if value is None else value for value in numbers)
        if middle:
            values[key] = mine * drawn / middle
    return kinds.with_values(bearing, values)


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
    held = [key for group in chosen_groups(None) if not group.of_tests for key in group.keys]
    known = kinds.keys_by_name(bearing) | {key: key for key in held}
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
        *tables, name = key.split(".")
        inner = data
        for table in tables:
            inner = inner[table]
        try:
            inner[name] = float(cell)
        except ValueError:
            raise InputError(f'"{cell}" is not a number', where) from None
    data["name"] = f"{bearing.name}, sample {number}"
    return validated(Bearing, data, where, from_file=False)
