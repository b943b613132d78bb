"""Fit of one or many records: from a starting set out of the loops to the best bearing."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.identify.checks import CheckReport, check_test
from thermobearing.identify.forward import Prediction
from thermobearing.identify.krill import krill_herd
from thermobearing.identify.parameters import ParameterSet, parameter_set
from thermobearing.identify.problem import ROBUST_SCALE, Problem
from thermobearing.identify.record import TestRecord, load_test
from thermobearing.identify.start import loop_start
from thermobearing.identify.uncertainty import Uncertainty, estimate

Floats = NDArray[np.float64]
Method = Literal["least-squares", "krill-herd", "differential-evolution"]
Loss = Literal["linear", "soft_l1", "huber", "cauchy"]

AROUND = 0.25  # half width, in the unit cube, of where other starts are drawn
PROBES = 12  # points looked at for each start that is taken
MOST_STEPS = 40  # of least squares from one start
POLISH_STEPS = 30
INSIDE = 1e-6  # of the cube: least squares starts strictly inside
SEARCH = 2000  # evaluations of krill herd and differential evolution


@dataclass(frozen=True)
class Identification:
    """What a fit found.

    Attributes
    ----------
    bearing : the bearing with the identified numbers.
    pset, cube : parameters, and where the optimum lies in their unit cube.
    records, checks, predictions : tests, what was said of them, the model at their samples.
    uncertainty : standard errors, intervals, correlation, warnings in words.
    start : values the fit started from.
    method, evaluations, seconds : how, and what it took (one evaluation runs all records).
    history : evaluations and best mean squared residual so far, for the convergence figure.
    outcome : "completed", or why not.
    """

    bearing: Bearing
    pset: ParameterSet
    cube: Floats
    records: list[TestRecord]
    checks: list[CheckReport]
    predictions: list[Prediction]
    uncertainty: Uncertainty
    start: dict[str, float]
    method: str
    evaluations: int
    seconds: float
    history: list[tuple[int, float]]
    outcome: str
    problem: Problem

    @property
    def values(self) -> dict[str, float]:
        """All parameters by dotted key."""
        return self.pset.values(self.cube)

    @property
    def warnings(self) -> list[str]:
        """Everything a reader of the numbers must know."""
        from thermobearing.identify.report import model_warnings

        said = [f.sentence for check in self.checks for f in check.findings if f.level != "note"]
        return [*said, *self.uncertainty.warnings, *model_warnings(self)]


def identify_bearing(
    records: Sequence[TestRecord | str | Path] | TestRecord | str | Path,
    bearing: Bearing | str | Path,
    *,
    free: Sequence[str] | None = None,
    bounds: dict[str, tuple[float, float]] | None = None,
    method: Method = "least-squares",
    seed: int = 0,
    starts: int = 3,
    loss: Loss = "linear",
    temperatures: bool = False,
    blind: bool = True,
    polish: bool = True,
    evaluations: int = SEARCH,
) -> Identification:
    """Parameters of a bearing from its tests.

    Parameters
    ----------
    records : one or more tests (`load_test`, `record_from_arrays`, or paths).
    bearing : geometry and materials, and the values of what is not free.
    free : keys or symbols ("K_r"), ties as "n_T = 2.4 * m_T"; the usual ones by default.
    bounds : other bounds than the usual, by key or symbol, in the unit of the parameter.
    method : "least-squares" (bounded trust region from several starts), "krill-herd"
        (Gandomi & Alavi 2012) or "differential-evolution"; the last two end with least
        squares unless `polish` is False.
    seed : of all random numbers.
    starts : least squares from so many points, >= 1; the first comes from the loops.
    loss : "linear", or a robust one of scipy: "soft_l1", "huber", "cauchy".
    temperatures : fit the thermocouples too.
    blind : start from the loops; False starts from the bearing's own values.
    polish : end with least squares.
    evaluations : budget of krill herd or differential evolution.

    Returns
    -------
    Identification

    Raises
    ------
    InputError : a test that cannot be used, with the reason; unknown names.

    Examples
    --------
    >>> import thermobearing as tb
    >>> from thermobearing.identify.record import record_from_arrays
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> run = tb.run(bearing, tb.cyclic_test(strain=[0.5, 1.5], cycles=2, rest=None), dt=0.02)
    >>> x, force = run["displacement"].values[0], run["force"].values[0]
    >>> record = record_from_arrays(run.time(0), x, force, 23.0)
    >>> found = identify_bearing(record, bearing, free=["K_r", "d_y"], starts=1)
    >>> abs(found.values["hysteresis.layer_stiffness"] / 30.738 - 1.0) < 0.02
    True
    """
    begin = time.perf_counter()
    tests = _records(records)
    base = bearing if isinstance(bearing, Bearing) else load_bearing(bearing)
    _check_options(method, loss, starts)
    checks = [check_test(record, base) for record in tests]
    refused = [line for check in checks for line in check.refusals]
    if refused:
        raise InputError(refused)
    pset = parameter_set(base, free, [record.ambient for record in tests], bounds)
    problem = Problem(
        tests,
        pset,
        temperatures=temperatures,
        loss=loss,
        clipped=[check.clipped for check in checks],
    )
    start = loop_start(tests, pset, problem.coarse) if blind else pset.values(pset.start)
    given = {p.kind.key for p in pset.parameters if not p.free} | set(bounds or {})
    problem.pset = pset = pset.with_start({k: v for k, v in start.items() if k not in given})
    cube = _search(problem, method, seed, starts, evaluations, loss)
    outcome = "completed"
    if polish:
        cube, converged = _least_squares(problem, cube, loss, POLISH_STEPS, fine=True)
        outcome = "completed" if converged else "not_converged"
    predictions = [p for p in problem.predict(cube) if p is not None]
    if len(predictions) != len(tests):
        raise InputError("the model does not get through these tests with any parameters tried")
    uncertainty = estimate(problem, cube)
    return Identification(
        bearing=pset.checked(cube), pset=pset, cube=cube, records=tests, checks=checks,
        predictions=predictions, uncertainty=uncertainty, start=start, method=method,
        evaluations=problem.evaluations, seconds=time.perf_counter() - begin,
        history=list(problem.history), outcome=outcome, problem=problem,
    )  # fmt: skip


def _records(given: Any) -> list[TestRecord]:
    several = [given] if isinstance(given, TestRecord | str | Path) else list(given)
    if not several:
        raise InputError("give at least one test")
    return [item if isinstance(item, TestRecord) else load_test(item) for item in several]


def _check_options(method: str, loss: str, starts: int) -> None:
    for name, value, known in (
        ("method", method, get_args(Method)),
        ("loss", loss, get_args(Loss)),
    ):
        if value not in known:
            raise InputError(f'{name} = "{value}": {nearest(value, known).removeprefix("; ")}')
    if starts < 1:
        raise InputError(f"starts = {starts}: must be at least 1")


def _search(
    problem: Problem, method: str, seed: int, starts: int, evaluations: int, loss: str
) -> Floats:
    """A point of the unit cube near the best one, with coarse steps."""
    first = np.clip(problem.pset.start, INSIDE, 1.0 - INSIDE)
    if method == "krill-herd":
        return krill_herd(
            problem.cost, len(first), evaluations=evaluations, seed=seed, start=first
        ).best
    if method == "differential-evolution":
        return _differential_evolution(problem, first, evaluations, seed)
    best, lowest = first, float("inf")
    for point in _starting_points(problem, first, starts, seed):
        found, _ = _least_squares(problem, point, loss, MOST_STEPS, fine=False)
        cost = problem.cost(found)
        if cost < lowest:
            best, lowest = found, cost
    return best


def _starting_points(problem: Problem, first: Floats, starts: int, seed: int) -> list[Floats]:
    """The start from the loops, and the best of a Latin hypercube around it."""
    from scipy.stats import qmc

    if starts == 1:
        return [first]
    cube = qmc.LatinHypercube(len(first), rng=seed).random(PROBES * (starts - 1))
    probes = np.clip(first + AROUND * (2.0 * cube - 1.0), INSIDE, 1.0 - INSIDE)
    costs = [problem.cost(point) for point in probes]
    return [first, *(probes[i] for i in np.argsort(costs)[: starts - 1])]


def _differential_evolution(problem: Problem, first: Floats, evaluations: int, seed: int) -> Floats:
    from scipy.optimize import differential_evolution

    size = 6  # members per dimension
    generations = max(1, evaluations // (size * len(first)) - 1)
    found = differential_evolution(
        problem.cost, [(0.0, 1.0)] * len(first), maxiter=generations, popsize=size, rng=seed,
        polish=False, x0=first, tol=0.0, init="latinhypercube",
    )  # fmt: skip
    return np.asarray(found.x)


def _least_squares(
    problem: Problem, start: Floats, loss: str, steps: int, *, fine: bool
) -> tuple[Floats, bool]:
    """Bounded trust-region least squares in the unit cube; whether it converged."""
    from scipy.optimize import least_squares

    found = least_squares(
        lambda u: problem.residuals(u, fine=fine),
        np.clip(start, INSIDE, 1.0 - INSIDE),
        jac=lambda u: problem.jacobian(u, fine=fine),
        bounds=(0.0, 1.0),
        method="trf",
        loss=loss,
        f_scale=ROBUST_SCALE,
        x_scale="jac",
        ftol=1e-7,
        xtol=1e-7,
        gtol=1e-9,
        max_nfev=steps,
    )
    return np.asarray(found.x), bool(found.status > 0)
