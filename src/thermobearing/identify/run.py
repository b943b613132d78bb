"""Calibrate a bearing to its tests.

    tests -> checks -> start from the loops -> what is free -> search -> polish -> uncertainty

`identify_bearing` creates a case from its arguments, `run_identify` runs it. The residuals are in
problem.py, the model in forward.py, the search in search.py.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing, Validity
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.identify.case import (
    IdentifyCase,
    IdentifyKeywords,
    Search,
    Test,
    make_identify_case,
)
from thermobearing.identify.fit.forward import ForwardModel, Prediction, unstable_tests
from thermobearing.identify.fit.parameters import (
    KINDS,
    M_T,
    SPAN,
    ParameterSet,
    at_one_temperature,
    available,
    default_free,
    dotted_value,
    is_of_temperature,
    parameter_set,
    remedy,
    split_at_one_temperature,
)
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.fit.search import polish as polished
from thermobearing.identify.fit.search import search
from thermobearing.identify.fit.start import (
    Sensitivity,
    drop_needless,
    hold_undetermined,
    loop_start,
    sensitivities,
)
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.cycles import full_cycles
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.turns import largest_displacement, turned_amplitudes
from thermobearing.identify.result import Identification
from thermobearing.identify.uncertainty.covariance import estimate
from thermobearing.identify.uncertainty.groups import chosen_groups
from thermobearing.results.ranges import cycles_in_a_row, largest_speed


@checked
def identify_bearing(
    records: Sequence[Test] | Test,
    bearing: Bearing | str | Path,
    **options: Unpack[IdentifyKeywords],
) -> Identification:
    """Identify the parameters of a bearing from its tests.

    Parameters
    ----------
    records : one or more tests of `load_test` or `record_from_arrays`, or their files.
    bearing : geometry and materials, and the values of what is not free.
    free : keys or symbols ("K_r"), ties as "n_T = 2.4 * m_T"; by default the parameters that
        these tests can determine.
    bounds : replacements of default bounds, by key or symbol, in the unit of the parameter.
    search : a function in place of the search by least squares (bounded trust region from several
        starts). It takes the objective, a function of a point of the unit cube of the free
        parameters, and the start, and returns the best point. Least squares follow unless `polish`
        is False.
    seed : of all random numbers.
    starts : points that least squares starts from, 1 to 100; the first comes from the loops.
    loss : "linear", or a robust one of scipy: "soft_l1", "huber", "cauchy".
    temperatures : calibrate to the thermocouples too.
    start_from : starting values of the free parameters: "loops", estimates from the measured
        loops, or "bearing", the values of the bearing.
    polish : end with least squares.
    assumed : relative standard uncertainty, 0 to 2, of values that are not identified, by dotted
        key or symbol: {"materials.side_film": 0.1}; 0 is known exactly. Others keep the default.
    accept_poor : accept a poor agreement (R2 below 0.9, a parameter near its bound).
    one_temperature : free m_T and n_T, if `free` contains them, even if the ambient temperatures
        of the tests differ by less than 10 K; otherwise they are held, with a warning.

    Raises
    ------
    InputError : a test that cannot be used, with the reason; unknown names; a model that ends
        early in the tests.

    Examples
    --------
    >>> import thermobearing as tb
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> run = tb.run(bearing, tb.cyclic_test(strain=[0.5, 1.5], cycles=2, rest=None), dt=0.02)
    >>> x, force = run["displacement"].values[0], run["force"].values[0]
    >>> record = tb.record_from_arrays(run.time(0), x, force, 23.0)
    >>> found = identify_bearing(record, bearing, free=["K_r", "d_y"], starts=1)
    >>> abs(found.values["hysteresis.layer_stiffness"] / 30.738 - 1.0) < 0.02
    True
    """
    return run_identify(make_identify_case(records, bearing, **options))


def run_identify(case: IdentifyCase) -> Identification:
    """Run the calibration of a case from `make_identify_case`."""
    begin = time.perf_counter()
    records, base = case.records, case.bearing
    checks = [check_test(record, base) for record in records]
    refused = [line for check in checks for line in check.refusals]
    if refused:
        raise InputError(refused)
    treated = [check.treatment.to_fit(check.clipped) for check in checks if check.treatment]
    records, left_out = [record for record, _ in treated], [bad for _, bad in treated]
    case, temperature_warnings = _without_temperature_law(case)
    problem, start, sensitivity = _problem(case, records, left_out)
    cube, converged = search(problem, case), True
    if case.free is None:
        # What was freed on trial, and had no effect, goes back before the costly fine steps.
        added = [item.key for item in sensitivity if item.free and not item.usual]
        problem, cube = drop_needless(problem, cube, added)
    undetermined: list[str] = []
    # An undetermined parameter would widen the errors of the others: hold it, fit again.
    while case.polish:
        cube, converged = polished(problem, cube)
        problem, cube, keys = hold_undetermined(problem, cube)
        if not keys:
            break
        undetermined += keys
    predictions = [p for p in problem.predict(cube) if p is not None]
    if len(predictions) != len(records):
        raise InputError("the model did not complete these tests with any of the parameters tried")
    covered = _range_of_tests(records, predictions, base.total_rubber_thickness)
    uncertainty = estimate(problem, cube, chosen_groups(case.assumed))
    uncertainty.warnings[:0] = [
        *temperature_warnings,
        *_left_open(undetermined, base),
        *unstable_tests(records, predictions),
    ]
    method = "least-squares" if case.search is None else _name_of_search(case.search)
    identification = Identification(
        bearing=problem.pset.checked(cube).model_copy(update={"tested_range": covered}),
        pset=problem.pset,
        cube=cube,
        records=records,
        checks=checks,
        predictions=predictions,
        uncertainty=uncertainty,
        start=start,
        method=method,
        evaluations=problem.evaluations,
        seconds=time.perf_counter() - begin,
        history=list(problem.history),
        outcome="completed" if converged else "not_converged",
        problem=problem,
        sensitivity=sensitivity,
        inputs=_inputs(case, method),
    )
    return (
        replace(identification, outcome="poor_fit")
        if identification.poor and not case.accept_poor
        else identification
    )


def _inputs(case: IdentifyCase, method: str) -> dict[str, Any]:
    """Return the options of a calibration for its summary."""
    names = ("seed", "starts", "loss", "temperatures", "start_from", "polish")
    inputs: dict[str, Any] = {"start": case.bearing.name, "method": method}
    inputs |= {name: getattr(case, name) for name in names}
    inputs["free"] = None if case.free is None else list(case.free)
    inputs["bounds"] = {key: list(ends) for key, ends in (case.bounds or {}).items()}
    inputs["assumed"] = dict(case.assumed or {})
    return inputs


def _name_of_search(search: Search) -> str:
    """Return the name of a function, or of the type of an object that can be called."""
    return getattr(search, "__qualname__", type(search).__qualname__).split(".")[0]


def _without_temperature_law(case: IdentifyCase) -> tuple[IdentifyCase, list[str]]:
    ambients = [record.ambient for record in case.records]
    # Tests at two temperatures determine the coefficients; nothing is held.
    if not at_one_temperature(ambients):
        return case, []
    if case.free is None:
        return case, _held_coefficients(case, ambients)
    if case.one_temperature:
        return case, []
    remaining, symbols = split_at_one_temperature(case.bearing, case.free)
    if not symbols:
        return case, []
    reason = (
        f"{' and '.join(symbols)} held at the values of {case.bearing.name}, because all tests are "
        f"at {ambients[0]:.4g} degC. {remedy(KINDS[M_T])}. --one-temperature "
        "(one_temperature=True) frees them nevertheless"
    )
    if not remaining:
        raise InputError(f"free: nothing else is free; {reason}")
    return replace(case, free=remaining), [reason]


def _held_coefficients(case: IdentifyCase, ambients: Sequence[float]) -> list[str]:
    """Return a sentence on coefficients that tests at one temperature leave as they are."""
    temperatures = (ambients[0], ambients[0] + SPAN)
    keys = [key for key in default_free(case.bearing, temperatures) if is_of_temperature(key)]
    groups = {key: group for group in chosen_groups(case.assumed) for key in group.keys}
    symbols = {kind.key: kind.symbol for kind in available(case.bearing)}
    values = []
    for key in keys:
        value = dotted_value(case.bearing, key) or 0.0
        uncertainty = f" \N{PLUS-MINUS SIGN} {groups[key].step(value):.2g}" if key in groups else ""
        values.append(f"{symbols[key]} = {value:.4g}{uncertainty}")
    if not values:
        return []
    return [
        f"{' and '.join(values)} held at the values of {case.bearing.name}, because all tests are "
        f"at {ambients[0]:.4g} degC. Forces at other temperatures depend on them. "
        f"{remedy(KINDS[M_T])}"
    ]


def _left_open(keys: Sequence[str], bearing: Bearing) -> list[str]:
    """Return a sentence on optional parameters that are held, since no test determines them."""
    if not keys:
        return []
    held_kinds = [KINDS[key] for key in keys]
    values = [f"{kind.symbol} = {dotted_value(bearing, kind.key):.4g}" for kind in held_kinds]
    return [
        f"{' and '.join(values)} held, because the tests do not determine "
        f"{'it' if len(held_kinds) == 1 else 'them'}. {remedy(*held_kinds)}"
    ]


def _problem(
    case: IdentifyCase, records: list[TestRecord], left_out: list[NDArray[np.bool_]]
) -> tuple[Problem, dict[str, float], list[Sensitivity]]:
    """Return the problem with its free parameters, the starting values, and the sensitivities."""
    base, ambients = case.bearing, [record.ambient for record in records]
    coarse = [ForwardModel(record, base) for record in records]

    def _begin(free: Sequence[str] | None) -> tuple[ParameterSet, dict[str, float]]:
        pset = parameter_set(base, free, ambients, case.bounds)
        from_loops = case.start_from == "loops"
        start = loop_start(records, pset, coarse) if from_loops else pset.values(pset.start)
        fixed = {p.kind.key for p in pset.parameters if not p.free}
        return pset.with_start({k: v for k, v in start.items() if k not in fixed}), start

    pset, start = _begin(case.free)
    problem = Problem(
        records,
        pset,
        temperatures=case.temperatures,
        loss=case.loss,
        clipped=left_out,
        coarse=coarse,
    )
    if case.free is not None:
        return problem, start, []
    groups = chosen_groups(case.assumed)
    sensitivity = sensitivities(problem, start, groups, case.bounds)
    free = [item.key for item in sensitivity if item.free]
    # The usual parameters are free already: start and models can stay.
    if all(item.free == item.usual for item in sensitivity):
        return problem, start, sensitivity
    pset, start = _begin(free)
    return problem.with_parameters(pset), start, sensitivity


def _range_of_tests(
    records: Sequence[TestRecord], predictions: Sequence[Prediction], rubber: float
) -> Validity:
    """Return the calibration range that tests cover, as in the file of a bearing.

    Strains are those of the full cycles (of the complete test if there are none), over the total
    thickness `rubber` [mm]; the temperature of the lead is the model's.
    """
    strains, speeds = [], []
    for record in records:
        cycles = zip(full_cycles(record), turned_amplitudes(record), strict=True)
        sizes = [amplitude for cycle, amplitude in cycles if not cycle.closing]
        strains += [size / rubber for size in sizes or [largest_displacement(record)]]
        speeds.append(largest_speed(record.time, record.displacement) / rubber)
    leads = [end for prediction in predictions for end in prediction.lead or ()]
    ends = {
        name: [float(f"{end:.5g}") for end in (min(values), max(values))]
        for name, values in (
            ("strain", strains),
            ("strain_rate", speeds),
            ("ambient", [float(record.ambient) for record in records]),
            ("lead_temperature", leads),
        )
        if values
    }
    cycles_in_row = max(cycles_in_a_row(record.time, record.displacement) for record in records)
    return Validity(**ends, cycles=[0.0, cycles_in_row])
