"""Posterior distribution of the parameters, and the forecast from it.

By default samples come from the normal distribution of the estimates (Laplace). With emcee
(Foreman-Mackey et al. 2013, the optional extra `bayes`) they come from the posterior itself,
whose likelihood is tempered by the effective number of samples (see covariance.py), flat
within the bounds on the scale of the search.

A sample has a value of every number that is uncertain: of the free parameters, and of all that are
held at an assumed value. The optimum moves with the assumed values (covariance.py), so both are
drawn together. Errors are widened by the factors that the intervals contain, and those of a
parameter in which widened errors cancel are stretched to its interval, which is not narrowed by it
(draws from the normal distribution only).
"""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.schema import check_seed
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.forward import ForwardModel, Prediction
from thermobearing.identify.fit.parameters import SPAN, ParameterSet
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.properties import (
    later_cycles,
    later_means,
)
from thermobearing.identify.records.cycles import compare_loops, full_cycles, largest_measures
from thermobearing.identify.records.record import reached_values
from thermobearing.identify.records.turns import turned_amplitudes
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.bands import (
    HIGH,
    LOW,
    MAIN,
    MEAN,
    UNITS,
    Band,
    Forecast,
    Narrowing,
    Predicted,
    PredictedCycle,
    Samples,
    widened_outside,
)
from thermobearing.identify.uncertainty.covariance import estimate
from thermobearing.identify.uncertainty.groups import AMBIENT, chosen_groups, shift
from thermobearing.quantities.governing import order_from_largest, place_of_least
from thermobearing.quantities.words import number, percent
from thermobearing.results.ranges import (
    compare_with_tests,
    extrapolation,
    limits_passed,
    outside_tests,
)
from thermobearing.results.sums import product_in_order, sum_of_products

WALKERS_PER = 3  # walkers for each parameter
# Of a forecast: the ends of a 95 % interval then vary by a tenth of its half width.
DRAWS = 400
MOST_ROUNDS = 50  # of draws until enough are within the bounds
IN_CYCLE = " in cycle "  # between the name of a quantity and the number of one cycle
CHAMBER = 0.2  # K, of a chamber that is known well
NO_SHARE = 1e-3  # of a variance: smaller ones are left out
LEAST_SHARE = 0.05  # of a variance: smaller ones are not named
PART = 0.5  # of a standard error: the step of a derivative
START_DIGITS = 4  # of a walker in the unit cube: far less than a standard error
STEPS, BURN = 300, 100  # of a walker, kept and thrown away


@checked
def forecast(
    identification: Identification,
    predict: Sequence[float] = (),
    *,
    posterior: bool = False,
    seed: int = 0,
    narrow: bool = True,
) -> Forecast:
    """Predict loops at ambient temperatures, with 95 % bands by the uncertainty of parameters.

    Parameters
    ----------
    identification : from `identify_bearing`.
    predict : ambient temperatures [degC], each in [-100, 100]; that of the first test by default.
    posterior : sample the posterior with emcee; otherwise the normal distribution of the estimates.
    seed : of the draws, >= 0.
    narrow : compute what would narrow the coldest band.

    Raises
    ------
    InputError : a temperature out of range, emcee is not installed, or every draw ends early.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None, dt=0.02)
    >>> record = tb.synthetic_record(tb.load_bearing("shen-hdr-specimen"), 23.0, test)
    >>> found = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    >>> colder, warmer = forecast(found, [-20.0, 23.0], narrow=False).bands
    >>> colder.peak > warmer.peak
    True
    """
    draws = _posterior_samples if posterior else _laplace_samples
    samples = draws(identification, seed=seed)
    temperatures = list(predict) or [identification.records[0].ambient]
    assert identification.bearing.tested_range is not None  # the range of the tests
    tested = identification.bearing.tested_range.ranges()
    bands, rows, extrapolations = [], [], []
    for ambient in temperatures:
        band = _predictive_band(identification, samples, ambient, seed=seed)
        name = f"the prediction at {ambient:.4g} degC"
        thickness = identification.bearing.total_rubber_thickness
        reached = reached_values(identification.records[0], thickness, ambient, band.lead)
        compared = list(compare_with_tests(name, reached, tested))
        extrapolations.append(extrapolation(compared))
        bands.append(widened_outside(band, limits_passed(compared, [name])[0], extrapolations[-1]))
        rows += compared
    warnings = outside_tests(identification.bearing.name, rows, tested)
    columns, notes = _sample_columns(identification, samples), [_share_note(band) for band in bands]
    coldest = place_of_least(temperatures)
    narrowing = _narrower(identification, bands[coldest], extrapolations[coldest]) if narrow else []
    if narrowing:
        test = identification.records[0].name
        notes.append(_narrowing_note(bands[coldest], narrowing, test))
    return Forecast(samples, tuple(bands), tuple(warnings), tuple(notes), columns, tuple(narrowing))


def _narrowing_note(band: Band, narrowing: Sequence[Narrowing], test: str) -> str:
    """Return how large the main quantity of a band is, and what would narrow its interval.

    `test` is the name of the test that is predicted.
    """
    options = "; ".join(f"{item.what} ({percent(item.half_width, 1)})" for item in narrowing)
    item = band.main
    extrapolated = ", extrapolated beyond the tests" if band.beyond_tested else ""
    unit = UNITS[item.quantity]
    best, lower, upper = (number(value, "#.3g") for value in (item.best, item.lower, item.upper))
    return (
        f"{_main_words(band)}, in a test like {test} at {band.ambient:.4g} degC{extrapolated}: "
        f"{best} {unit} (95 %: {lower} to {upper}). Half of this interval is "
        f"{percent(item.half_width, 1)} of the value. It would be less with one of these: {options}"
    )


def _main_words(band: Band) -> str:
    """Return the main quantity of a band with the cycle and the strain that it is of."""
    if band.main.quantity != MAIN:
        return "Peak force"
    largest = max((cycle.strain for cycle in band.cycles), default=0.0)
    strain = f" ({percent(largest)} shear strain)" if largest else ""
    return f"{MAIN} of the first cycle at the largest amplitude{strain}"


def _share_note(band: Band) -> str:
    """Return a sentence on the share of a band that the tests did not determine."""
    item = band.main
    shares = {name: share for name, share in item.shares.items() if share >= LEAST_SHARE}
    names = [list(shares)[k] for k in order_from_largest(list(shares.values()))]
    causes = ", ".join(f"{name} {percent(shares[name])}" for name in names)
    return (
        f"{_main_words(band)} at {band.ambient:.4g} degC: {percent(item.held_share)} of its "
        "variance come from what these tests do not determine; the largest shares of all causes: "
        f"{causes}"
    )


def _laplace_samples(
    identification: Identification, count: int = DRAWS, *, seed: int = 0
) -> Samples:
    """Draw from the normal distribution of the fit, within the bounds."""
    cube, changes = _draw(identification, count, seed)
    return Samples(cube, "laplace", changes)


def _draw(identification: Identification, count: int, seed: int) -> tuple[Floats, Floats]:
    """Return places in the unit cube [count, n] and changes of the assumed groups [count, m].

    Draws beyond a bound are drawn again: a parameter at its bound has draws on one side only, and
    the parameters that are correlated with it follow.
    """
    check_seed(seed)
    uncertainty, rng = identification.uncertainty, np.random.default_rng(seed)
    cubes, changes, count_inside = [], [], 0
    for _ in range(MOST_ROUNDS):
        change = _draw_held(identification, count, rng)
        errors = _normal_draws(uncertainty.widening**2 * uncertainty.of_tests, count, rng)
        errors += product_in_order(change, uncertainty.assumed.shifts.T)
        cube = identification.cube + uncertainty.stretching * errors
        inside = ((cube >= 0.0) & (cube <= 1.0)).all(axis=1)
        cubes.append(cube[inside])
        changes.append(change[inside])
        count_inside += int(inside.sum())
        if count_inside >= count:
            break
    else:  # nearly all are beyond a bound
        cubes.append(np.clip(cube, 0.0, 1.0))
        changes.append(change)
    return np.concatenate(cubes)[:count], np.concatenate(changes)[:count]


def _draw_held(identification: Identification, count: int, rng: np.random.Generator) -> Floats:
    """Return changes of the assumed groups, in standard uncertainties [count, groups]."""
    assumed = identification.uncertainty.assumed
    return _normal_draws(assumed.spread * np.outer(assumed.widening, assumed.widening), count, rng)


def _normal_draws(covariance: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return draws from a normal distribution [count, n], the same ones on every machine."""
    draws = rng.normal(size=(count, len(covariance)))
    return product_in_order(draws, _symmetric_root(covariance))


def _symmetric_root(covariance: Floats) -> Floats:
    """Return the symmetric root, which is unique: signs and axes of eigenvectors are not."""
    values, axes = np.linalg.eigh(covariance)
    return np.asarray((axes * np.sqrt(np.maximum(values, 0.0))) @ axes.T)


def drawn_bearing(identification: Identification, cube: Floats, changes: Floats) -> Bearing:
    """Return the bearing of a draw: its free parameters, and what is held at an assumed value."""
    bearing = identification.pset.bearing(cube)
    groups = identification.uncertainty.assumed.groups
    for group, sigmas in zip(groups, changes.tolist(), strict=True):
        if not group.of_tests:
            bearing = shift(bearing, group, sigmas)
    return bearing


def _sample_columns(identification: Identification, samples: Samples) -> dict[str, Floats]:
    """Return the columns of posterior.csv: free and tied parameters, then what is held."""
    names = {p.kind.key: p.kind.symbol for p in identification.pset.parameters}
    keys = [p.kind.key for p in identification.pset.free]
    keys += [p.kind.key for p in identification.pset.parameters if p.tie is not None]
    keys += [
        key
        for group in identification.uncertainty.assumed.groups
        if not group.of_tests
        for key in group.keys
        if kinds.dotted_value(identification.bearing, key) is not None
    ]
    bearings = [
        drawn_bearing(identification, place, changes)
        for place, changes in zip(samples.cube, samples.held, strict=True)
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


def _walkers(identification: Identification) -> int:
    return max(2 * len(identification.cube) + 2, WALKERS_PER * len(identification.cube))


def posterior_effort(
    identification: Identification, *, steps: int = STEPS, burn: int = BURN
) -> tuple[int, float]:
    """Return the largest number of runs of `_posterior_samples`, and their approximate time [s].

    Draws beyond a bound need no run; the time is measured with one run.
    """
    rounds = _walkers(identification) * (burn + steps + 1)  # and each walker's begin
    begin = time.perf_counter()
    identification.problem.parts(identification.cube, fine=True)
    return rounds * len(identification.records), rounds * (time.perf_counter() - begin)


def _posterior_samples(
    identification: Identification, *, steps: int = STEPS, burn: int = BURN, seed: int = 0
) -> Samples:
    """Draw by the ensemble sampler of emcee: each walker makes `steps` after `burn`."""
    need_emcee()
    import emcee

    problem, best = identification.problem, identification.cube
    residual = np.concatenate(problem.parts(best, fine=True))
    variance = float(residual @ residual) / max(len(residual) - len(best), 1)
    tempering = identification.uncertainty.effective_samples / identification.uncertainty.samples

    def _log_probability(u: Floats) -> float:
        if (u < 0.0).any() or (u > 1.0).any():
            return float("-inf")
        r = np.concatenate(problem.parts(u, fine=True))
        return -0.5 * tempering * float(r @ r) / variance

    walkers = _walkers(identification)
    # Moves of the walkers multiply differences of their starts. Rounded starts are the same on all
    # processors, on which the fit ends at places that differ by rounding.
    start = np.round(_laplace_samples(identification, walkers, seed=seed).cube, START_DIGITS)
    start = np.clip(start + 1e-6 * np.random.default_rng(seed).random(start.shape), 0.0, 1.0)
    sampler = emcee.EnsembleSampler(walkers, len(best), _log_probability)
    sampler.random_state = np.random.RandomState(seed).get_state()
    sampler.run_mcmc(start, burn + steps, skip_initial_state_check=True)
    tau = float(np.mean(sampler.get_autocorr_time(quiet=True, tol=0)))
    chain = np.asarray(sampler.get_chain(discard=burn, flat=True))
    changes = _draw_held(identification, len(chain), np.random.default_rng(seed))
    moved = chain + product_in_order(changes, identification.uncertainty.assumed.shifts.T)
    acceptance = float(np.mean(sampler.acceptance_fraction))
    return Samples(np.clip(moved, 0.0, 1.0), "emcee", changes, acceptance, tau)


def _predictive_band(
    identification: Identification,
    samples: Samples,
    ambient: float,
    *,
    count: int = DRAWS,
    seed: int = 0,
) -> Band:
    """Return the band of loops as in the first test and of its measures at an ambient [degC]."""
    if not -100.0 <= ambient <= 100.0:
        raise InputError(f"predict = {ambient} degC: must be between -100 and 100 degC")
    test, picked = identification.records[0], np.arange(len(samples.cube))
    # A quantile needs no more draws; each one is a run of the model.
    if len(picked) > count:
        picked = np.random.default_rng(seed).choice(len(picked), size=count, replace=False)
    best = _best(identification, ambient)
    force_of = _forces(identification, ambient)
    runs = [force_of(samples.cube[i], samples.held[i]) for i in picked] if force_of else []
    differences = [difference for difference in runs if difference is not None]
    if best is None or not differences:
        raise InputError(f"the model does not complete the test at {ambient:.4g} degC")
    forces = best.force + np.array(differences)
    lower, upper = np.quantile(forces, [LOW, HIGH], axis=0)
    measure = _measure_of_test(identification)
    middles = measure(best.force)
    measures = [item for item in map(measure, forces) if item.keys() >= middles.keys()]
    errors = _errors(identification, ambient)
    predicted: dict[str, list[Predicted]] = {}  # by the number of the cycle; "" of the test
    for name, value in middles.items():
        drawn = np.array([item[name] for item in measures])
        low, high = np.quantile(drawn, [LOW, HIGH]).tolist()
        error, (quantity, _, cycle) = errors[name], name.partition(IN_CYCLE)
        share = error.share_of_held
        item = Predicted(quantity, value, low, high, error.shares, share, drawn)
        predicted.setdefault(cycle, []).append(item)
    return Band(
        ambient=ambient,
        displacement=test.displacement,
        best=best.force,
        lower=lower,
        upper=upper,
        predicted=tuple(predicted.pop("")),
        lead=best.lead,
        cycles=_cycles(identification, predicted) if predicted else (),
    )


def _cycles(
    identification: Identification, predicted: Mapping[str, Sequence[Predicted]]
) -> tuple[PredictedCycle, ...]:
    """Return the cycles of the first test with what is predicted of each, by its number."""
    rubber = identification.bearing.total_rubber_thickness
    record = identification.records[0]
    cycles, amplitudes = full_cycles(record), turned_amplitudes(record)
    places = [int(cycle) for cycle in predicted]
    return tuple(
        PredictedCycle(k, cycles[k - 1].number, amplitudes[k - 1] / rubber, tuple(items))
        for k, items in zip(places, predicted.values(), strict=True)
    )


def _measure_of_test(identification: Identification) -> Callable[[Floats], dict[str, float]]:
    """Return a function of the force of the model in the first test [kN]: what is predicted."""
    test, cycles = identification.records[0], later_cycles(identification)

    def _measure(force: Floats) -> dict[str, float]:
        means = later_means(identification, force, cycles)
        named_means = {f"{MEAN}{name}": value for name, value in means.items()}
        of_cycles = {
            f"{name}{IN_CYCLE}{loop.cycle}": value
            for loop in compare_loops(test, force)[0]
            for name, value in loop.model_measures.items()
        }
        return largest_measures(test, force) | named_means | of_cycles

    return _measure


def _best(identification: Identification, ambient: float) -> Prediction | None:
    """Return the calibrated bearing in the first test at an ambient; None if it ends early."""
    test, bearing = identification.records[0], identification.bearing
    return ForwardModel(test, bearing, fine=True, ambient=ambient).run(bearing)


def _forces(
    identification: Identification, ambient: float
) -> Callable[[Floats, Floats], Floats | None] | None:
    """Return a function of a draw: the change of the force of the first test at an ambient [kN].

    With coarse steps, at a fifth of the time: the changes are those with fine steps. None if the
    model ends early, and so does the function.
    """
    model = ForwardModel(identification.records[0], identification.bearing, ambient=ambient)
    middle = model.run(identification.bearing)

    def _force(cube: Floats, changes: Floats) -> Floats | None:
        bearing = drawn_bearing(identification, cube, changes)
        run = model.rebuilt(bearing).run(bearing)
        return None if run is None or middle is None else run.force - middle.force

    return None if middle is None else _force


@dataclass(frozen=True)
class _Error:
    """Standard error of a prediction, and its causes."""

    size: float  # in the unit of the quantity
    shares: dict[str, float]  # of the variance, the largest first, without negligible ones
    share_of_held: float  # of numbers of the bearing that the tests did not determine


def _errors(identification: Identification, ambient: float) -> dict[str, _Error]:
    """Return the standard error of each quantity of the first test at an ambient [degC].

    By derivatives at the best estimate.
    """
    force_of, measure = _forces(identification, ambient), _measure_of_test(identification)
    best = _best(identification, ambient)
    if force_of is None or best is None:
        return {}
    middles = measure(best.force)

    def _measure(cube: Floats, changes: Floats) -> dict[str, float] | None:
        difference = force_of(cube, changes)
        moved = {} if difference is None else measure(best.force + difference)
        return moved if moved.keys() >= middles.keys() else None

    return propagate_errors(identification, _measure, middles)


def propagate_errors(
    identification: Identification,
    measure: Callable[[Floats, Floats], dict[str, float] | None],
    middles: Mapping[str, float],
) -> dict[str, _Error]:
    """Return the standard error of each quantity, by derivatives of `measure` at the best estimate.

    Along the axes of the errors by the tests, and by one standard uncertainty of each assumed
    group, with which the parameters move.
    """
    uncertainty = identification.uncertainty
    no_changes = np.zeros(len(uncertainty.assumed.groups))
    roots = _symmetric_root(uncertainty.widening**2 * uncertainty.of_tests)
    shifts, widening = uncertainty.assumed.shifts, uncertainty.assumed.widening

    def _slopes(along: Floats, changes: Floats) -> dict[str, float]:
        step = PART
        place = identification.cube + step * along
        if ((place < 0.0) | (place > 1.0)).any():  # beyond a bound: the other way
            step = -PART
        moved = measure(np.clip(identification.cube + step * along, 0.0, 1.0), step * changes)
        return {
            name: 0.0 if moved is None else (moved[name] - value) / step
            for name, value in middles.items()
        }

    of_tests = [_slopes(axis, no_changes) for axis in roots]
    of_groups = [
        _slopes(shifts[:, k] * factor, np.where(np.arange(len(no_changes)) == k, factor, 0.0))
        for k, factor in enumerate(widening)
    ]
    errors = {}
    for name in middles:
        slope = np.array([slopes[name] for slopes in of_groups])
        scatter = sum_of_products(*[[slopes[name] for slopes in of_tests]] * 2)
        parts = slope * product_in_order(uncertainty.assumed.spread, slope)
        # An exact test has no variance; shares are ratios to it.
        variance = max(scatter + float(np.sum(parts)), 1e-300)
        groups = uncertainty.assumed.groups
        causes = {"tests": scatter / variance}
        causes |= dict(zip((g.name for g in groups), (parts / variance).tolist(), strict=True))
        undetermined = sum(causes[group.name] for group in groups if not group.of_tests)
        order = [list(causes)[k] for k in order_from_largest(list(causes.values()))]
        share = min(max(undetermined, 0.0), 1.0)
        shares = {cause: causes[cause] for cause in order if abs(causes[cause]) >= NO_SHARE}
        errors[name] = _Error(math.sqrt(variance), shares, share)
    return errors


def _narrower(identification: Identification, band: Band, uncertainty: float) -> list[Narrowing]:
    """Return what would narrow K_eq of a band, or its force if there is no loop.

    A chamber that is known better, and one test like the first at the temperature of the band,
    whose residuals are as large as those of the first. `more` is the relative standard uncertainty
    outside the tests, which this test would remove.
    """
    item = band.main
    groups = [g for g in chosen_groups(identification.inputs.get("assumed")) if not g.mistake]
    problem, options = identification.problem, []
    of_chambers = [
        g.name for g in identification.uncertainty.assumed.groups if g.keys[0] == AMBIENT
    ]
    # Only where the chamber matters: a cause of a negligible share is no advice.
    if sum(item.shares.get(name, 0.0) for name in of_chambers) >= LEAST_SHARE:
        better = copy(problem)
        better.records = [replace(r, ambient_uncertainty=CHAMBER) for r in problem.records]
        options.append(
            (f"ambient temperatures known to {CHAMBER:g} K", better, identification, uncertainty)
        )
    # Not where a test exists: another test there would hardly add information.
    if min(abs(r.ambient - band.ambient) for r in identification.records) >= SPAN:
        planned, pset = _with_planned_test(identification, band.ambient)
        name = f"one test at {band.ambient:.4g} degC"
        options.append((name, planned, replace(identification, pset=pset, cube=pset.start), 0.0))
    narrowed = []
    for name, variant, fit, extra_uncertainty in options:
        variant.pset = fit.pset
        estimated = estimate(variant, fit.cube, groups, fine=False)
        error = _errors(replace(fit, uncertainty=estimated), band.ambient)[item.quantity]
        size = math.hypot(error.size / item.best, extra_uncertainty)
        narrowed.append(Narrowing(name, NormalDist().inv_cdf(HIGH) * size))
    return narrowed


def _with_planned_test(
    identification: Identification, ambient: float
) -> tuple[Problem, ParameterSet]:
    """Return the problem with one more test like the first, and m_T and n_T free."""
    temperatures = (ambient, ambient + SPAN)
    temperature_keys = {
        key
        for key in kinds.default_free(identification.bearing, temperatures)
        if kinds.is_of_temperature(key)
    }
    values = identification.values
    parameters = tuple(
        replace(
            p,
            value=values[p.kind.key],
            free=p.free or (p.kind.key in temperature_keys and p.tie is None),
        )
        for p in identification.pset.parameters
    )
    first = identification.records[0]
    middle, predicted = _best(identification, first.ambient), _best(identification, ambient)
    assert middle is not None
    assert predicted is not None
    # Residuals of the planned test are those of the first, in proportion to the peak force.
    scale = float(np.abs(predicted.force).max()) / first.peak_force
    force = predicted.force + scale * (first.force - middle.force)
    planned = replace(
        first,
        name="planned",
        force=force,
        ambient=ambient,
        ambient_uncertainty=None,
        temperatures={},
        places={},
    )
    problem, pset = identification.problem, ParameterSet(identification.pset.base, parameters)
    extended = Problem(
        [*problem.records, planned], pset, temperatures=problem.temperatures, loss=problem.loss
    )
    extended.weights = [*problem.weights, problem.weights[0]]
    return extended, pset
