"""Weights, errors, intervals and samples of a fit, each by hand from a record that is known."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import t as student

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.border.errors import InputError
from thermobearing.identify.comparison import Comparison
from thermobearing.identify.fit import search as search
from thermobearing.identify.fit.forward import ForwardModel, Prediction, _pause
from thermobearing.identify.fit.parameters import (
    C_V,
    HARDENING,
    K_R,
    K_V,
    KINDS,
    M_T,
    SHAPE,
    Kind,
    Parameter,
    ParameterSet,
    _full_key,
    parameter_set,
    remedy,
)
from thermobearing.identify.fit.problem import (
    LOST,
    Problem,
    _robust_weights,
    _sample_weights,
    half_cycles,
)
from thermobearing.identify.fit.start import _with_temperature, loop_start
from thermobearing.identify.fit.synthetic import generic_start, synthetic_record
from thermobearing.identify.records.cycles import (
    Loop,
    compute_measures,
    full_cycles,
    level_amplitudes,
    property_cycles,
    turning_points,
)
from thermobearing.identify.records.record import TestRecord, record_from_arrays
from thermobearing.identify.records.turns import (
    describe_coarse_samples,
    find_cut_turns,
    find_sharp_turns,
    largest_displacement,
    step_at_reversals,
    turned_amplitudes,
)
from thermobearing.identify.result import _fit_warnings
from thermobearing.identify.uncertainty.covariance import _effective_samples, estimate
from thermobearing.identify.uncertainty.diagnosis import (
    _Advice,
    describe_signals,
    describe_similar_tests,
)

HDR, LHDR = tb.load_bearing("shen-hdr-specimen"), tb.load_bearing("shen-lhdr-specimen")
SHORT = tb.cyclic_test(strain=[0.5, 2.5], cycles=2, rest=600.0)
POINTS = 200  # of a cycle
AMPLITUDES = (10.0, 10.0, 4.0, 0.8, 30.0, 30.0)  # 4 is a separate level, 0.8 stops the motion


def sines(amplitudes: tuple[float, ...] = AMPLITUDES, sign: float = 1.0) -> TestRecord:
    """One sine after the other, force 2 kN/mm and a viscous part of 5 kN."""
    phase = 2.0 * np.pi * np.arange(POINTS) / POINTS
    x = np.concatenate([*(a * np.sin(phase) for a in amplitudes), [0.0]])
    ahead = np.concatenate([*(np.cos(phase) for _ in amplitudes), [0.0]])
    time = 0.01 * np.arange(len(x))
    return record_from_arrays(time, sign * x, sign * (2.0 * x + 5.0 * ahead), 23.0)


def rows(record: TestRecord, cycle: int) -> slice:
    """Samples inside a cycle, from 0, away from its ends."""
    return slice(POINTS * cycle + 2, POINTS * (cycle + 1) - 2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_cycles_are_counted_within_their_amplitude(sign: float) -> None:
    cycles = full_cycles(sines(sign=sign))
    assert [c.closing for c in cycles] == [False, False, False, True, False, False]
    assert [c.number for c in cycles if not c.closing] == [1, 2, 1, 1, 2]
    assert_allclose([c.amplitude for c in cycles], AMPLITUDES, rtol=tol.LOOP)
    force = sines(sign=sign).force
    measures = compute_measures(sines(sign=sign), force, HDR.area, HDR.total_rubber_thickness)
    assert_allclose([m.amplitude_mm for m in measures], AMPLITUDES, rtol=tol.LOOP)


@pytest.mark.parametrize(("amplitude", "closing"), [(4.9, True), (5.1, False)])
def test_cycle_below_a_quarter_of_the_one_before_closes(amplitude: float, closing: bool) -> None:
    cycles = full_cycles(sines((20.0, 20.0, amplitude, 20.0)))
    assert [cycle.closing for cycle in cycles] == [False, False, closing, False]
    assert (cycles[3].number > 1) is closing  # else the last one follows another amplitude


def test_weights_of_samples_are_roots() -> None:
    """Squared residuals count `weight` times, those of first cycles `first_cycle_weight` more."""
    record = replace(sines(), weight=4.0, first_cycle_weight=9.0)
    weights = _sample_weights(record)
    wanted = [6.0, 2.0, 6.0, 2.0, 6.0, 2.0]  # of the second: small cycle 4 mm is a first one
    for cycle, value in enumerate(wanted):
        assert_allclose(weights[rows(record, cycle)], value, rtol=tol.LOOP)


def test_balance_counts_small_cycles_relative_to_their_own_peak() -> None:
    for power in (1.0, 0.5):
        record = replace(sines(), cycle_balance=power)
        weights = _sample_weights(record)
        for cycle in (0, 4):
            peak = np.abs(record.force[POINTS * cycle : POINTS * (cycle + 1)]).max()
            wanted = (record.peak_force / peak) ** power
            assert_allclose(weights[rows(record, cycle)], wanted, rtol=tol.LOOP)


@pytest.mark.parametrize(
    ("loss", "rho"),
    [
        ("soft_l1", lambda z: 2.0 * (np.sqrt(1.0 + z) - 1.0)),
        ("huber", lambda z: np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0)),
        ("cauchy", np.log1p),
        ("linear", lambda z: z),
    ],
)
def test_robust_weights_are_the_derivatives_of_the_losses(loss: str, rho: Any) -> None:
    """d rho / d z of scipy's losses, z the squared residual over its scale of 2 %."""
    z = np.array([0.01, 0.5, 2.0, 9.0, 100.0])
    step = 1e-5
    wanted = (rho(z + step) - rho(z - step)) / (2.0 * step)
    assert_allclose(_robust_weights(0.02 * np.sqrt(z), loss), wanted, rtol=1e-6)


def make_problem(records: list[TestRecord], **options: Any) -> Problem:
    return Problem(records, parameter_set(HDR, ["K_r", "d_y"], [23.0]), **options)


def test_clipped_samples_do_not_count() -> None:
    record = sines((10.0, 10.0))
    clipped = np.zeros(len(record.time), dtype=bool)
    clipped[30:60] = True
    problem = make_problem([record], clipped=[clipped])
    part = problem.parts(problem.pset.start)[0]
    assert (part[30:60] == 0.0).all()
    assert (part[60:] != 0.0).any()


def test_where_the_model_does_not_get_through(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each sample of force and thermocouples is off by twice the largest force."""
    count = len(sines((10.0,)).time)
    record = replace(sines((10.0,)), temperatures={"T": np.zeros(count)}, places={"T": "rubber 1"})
    monkeypatch.setattr(ForwardModel, "run", lambda *_: None)
    for temperatures, size in ((False, count), (True, 2 * count)):
        problem = make_problem([record], temperatures=temperatures)
        assert_allclose(problem.parts(problem.pset.start)[0], np.full(size, LOST))


@pytest.mark.parametrize("central", [False, True])
def test_jacobian_of_straight_lines_is_exact(
    central: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Inside the cube and at its faces, where the difference is turned inwards."""
    matrix = np.array([[3.0, -1.0], [0.5, 2.0], [0.0, 7.0]])
    problem = make_problem([sines((10.0,))])
    monkeypatch.setattr(problem, "parts", lambda cube, *, fine: [matrix @ cube])
    for cube in ([0.4, 0.6], [1.0, 0.5], [0.0, 1.0], [0.9996, 0.0003]):
        result = problem.jacobian(np.array(cube), central=central)
        assert_allclose(result, matrix, rtol=1e-9, atol=1e-9)


def lopsided(record: TestRecord, up: float, down: float) -> np.ndarray:
    """The force of a record, its upper half times `up`, its lower half times `down`."""
    return np.asarray(record.force * np.where(record.force > 0.0, up, down))


def _comparison(record: TestRecord, prediction: Prediction) -> Comparison:
    return Comparison(record, "shen-hdr-specimen", "identified", 50.0, prediction)


def test_errors_of_cycles_by_hand() -> None:
    """The model 30 % too strong upwards and 10 % too weak downwards."""
    record = sines((10.0, 10.0, 0.8))
    fit = _comparison(record, Prediction(lopsided(record, 1.3, 0.9), {}))
    assert [c.number for c in fit.loops] == [1, 2]  # not the closing one
    for loop in fit.loops:
        errors = loop.errors
        assert loop.amplitude == pytest.approx(10.0)
        assert errors["G_eq_error"] == pytest.approx(0.1, rel=1e-6)
        assert errors["force_max_error"] == pytest.approx(0.3, rel=1e-6)
        # Half of the loop is 30 % larger, half of it 10 % smaller; h_eq is energy over stiffness.
        assert errors["energy_error"] == pytest.approx(0.1, abs=2e-3)
        assert errors["h_eq_error"] == pytest.approx((1.0 + errors["energy_error"]) / 1.1 - 1.0)


def test_measures_of_a_fit_by_hand() -> None:
    """R2 is relative to the mean of the test, NRMSE to its largest force either way."""
    record = replace(sines((10.0,)), force=sines((10.0,)).force + 7.0)
    off = np.where(np.arange(len(record.force)) % 2, 1.0, -1.0)
    fit = _comparison(record, Prediction(record.force + off, {}))
    peak = np.abs(record.force).max()
    assert pytest.approx(1.0 / peak, rel=tol.LOOP) == fit.NRMSE
    variance = float(np.mean((record.force - record.force.mean()) ** 2))
    assert pytest.approx(1.0 - 1.0 / variance, rel=tol.LOOP) == fit.R2


@pytest.mark.parametrize(("first", "reported"), [(1.2, True), (1.0, False), (0.8, False)])
def test_stiffer_first_cycles_are_reported(first: float, reported: bool) -> None:
    record = sines((10.0, 10.0, 10.0))
    force = record.force.copy()
    force[:POINTS] *= first
    fit = _comparison(replace(record, force=force), Prediction(record.force, {}))
    output = [text for text in _fit_warnings(fit) if "scragging" in text]
    assert len(output) == int(reported)
    if reported:
        assert "17 % stronger" in output[0]  # 1 - 1/1.2
        assert "first_cycle_weight = 0" in output[0]
        fit = replace(fit, record=replace(fit.record, first_cycle_weight=0.0))
        (text,) = (text for text in _fit_warnings(fit) if "scragging" in text)
        assert "They had no weight" in text
        assert "first_cycle_weight" not in text


def linear_problem(sizes: tuple[float, float]) -> tuple[Any, np.ndarray]:
    """A model that is linear in K_r's and b's places, white noise; and the best place."""
    record = sines((10.0,) * 12)
    rng = np.random.default_rng(5)
    n = len(record.time)
    columns = np.column_stack([record.displacement / 10.0, rng.normal(size=n)]) * sizes
    best = np.array([0.4, 0.7])
    noise = 0.01 * rng.normal(size=n)
    noise -= columns @ np.linalg.lstsq(columns, noise, rcond=None)[0]
    free = [Parameter(KINDS[K_R], 30.0, 3.0, 300.0), Parameter(KINDS[HARDENING], 0.1, 0.0, 2.0)]
    problem = SimpleNamespace(
        records=[record], loss="linear", pset=ParameterSet(HDR, tuple(free)),
        parts=lambda cube, *, fine=False: [columns @ (cube - best) + noise],
        jacobian=lambda cube, *, fine, central: columns,
    )  # fmt: skip
    return problem, best


def test_intervals_are_those_of_student() -> None:
    problem, best = linear_problem((1.0, 0.5))
    result = estimate(problem, best, [])
    sigma = np.sqrt(np.diag(result.covariance))
    record = problem.records[0]
    blocks = len(np.unique(half_cycles(record)))
    assert blocks >= 23  # half cycles
    wide = float(student.ppf(0.975, blocks - 2))
    K, b = result.estimates[K_R], result.estimates[HARDENING]
    # Linear scale: value and error are 2 times those of the place.
    assert b.value == pytest.approx(1.4)
    assert b.stderr == pytest.approx(2.0 * sigma[1], rel=tol.LOOP)
    assert b.upper - b.value == pytest.approx(wide * b.stderr, rel=1e-9)
    assert b.value - b.lower == pytest.approx(wide * b.stderr, rel=1e-9)
    # Logarithmic scale: d value / d place is the value times the logarithm of the range.
    assert K.value == pytest.approx(3.0 * 100.0**0.4)
    assert K.stderr == pytest.approx(np.log(100.0) * K.value * sigma[0], rel=1e-9)
    assert K.upper == pytest.approx(K.value * 100.0 ** (wide * sigma[0]), rel=1e-9)
    # White noise: not less than the textbook has, and not far from it.
    columns = problem.jacobian(best, fine=True, central=True)
    residual = problem.parts(best)[0]
    textbook = np.linalg.inv(columns.T @ columns) * (residual @ residual) / (len(residual) - 2)
    ratio = sigma / np.sqrt(np.diag(textbook))
    assert ((ratio > 1.0 - 1e-9) & (ratio < 2.0)).all()
    assert result.rms == pytest.approx(float(np.sqrt(np.mean(residual**2))))
    assert result.samples == len(residual)


@pytest.mark.parametrize("place", [0.001, 0.999])
def test_both_bounds_are_noticed(place: float) -> None:
    problem, best = linear_problem((1.0, 0.5))
    result = estimate(problem, np.array([best[0], place]), [])
    assert result.estimates[HARDENING].at_bound
    assert not result.estimates[K_R].at_bound
    assert any("at its bound" in text for text in result.warnings)


@pytest.mark.parametrize(("faster", "narrow"), [(1.2, True), (10.0, False)])
def test_similar_speeds_are_reported(faster: float, narrow: bool) -> None:
    record = sines((10.0,))
    records = [record, replace(record, time=record.time / faster)]
    problem: Any = SimpleNamespace(records=records, pset=parameter_set(LHDR, ["c_v"], [23.0]))
    assert bool(describe_similar_tests(problem)) is narrow


def test_remedies_belong_to_their_parameters() -> None:
    for key, words in (
        (M_T, "ambient temperatures"), (C_V, "loading speeds"), (K_V, "loading speeds"),
        (HARDENING, "several amplitudes"), (SHAPE, "small strain"),
    ):  # fmt: skip
        assert words in remedy(KINDS[key])
    assert "Other tests" in remedy(Kind(key="x", symbol="x", scale="log", lower=0.1, upper=1.0))


@pytest.mark.parametrize("transform", ["log", "log1p", "linear"])
def test_slope_of_each_scale_is_the_derivative(transform: Any) -> None:
    parameter = Parameter(
        Kind(key="x", symbol="x", scale=transform, lower=0.2, upper=3.0), 1.0, 0.2, 3.0
    )
    for place in (0.1, 0.5, 0.8):
        step = 1e-6
        wanted = (parameter.at(place + step) - parameter.at(place - step)) / (2.0 * step)
        assert parameter.slope(place) == pytest.approx(wanted, rel=1e-8)
        assert parameter.place(parameter.at(place)) == pytest.approx(place)


def test_relative_bounds_move_with_the_start() -> None:
    moved = parameter_set(HDR, ["K_r", "b"], [23.0]).with_start({K_R: 5.0, HARDENING: 0.5})
    stiffness, hardening = moved.free
    assert (stiffness.value, stiffness.lower, stiffness.upper) == (5.0, 0.5, 50.0)
    assert (hardening.value, hardening.lower, hardening.upper) == (0.5, 0.0, 2.0)


def test_thermocouples_of_the_lower_half_read_its_mirror_image() -> None:
    """Six layers: 4, 5, 6 are as warm as 3, 2, 1 (the outer one)."""
    count = len(sines((10.0,)).time)
    places = {f"T{k}": f"rubber {k}" for k in range(1, 7)}
    record = replace(
        sines((10.0,)), places=places, temperatures={name: np.zeros(count) for name in places}
    )
    layers = ForwardModel(record, HDR)._layers
    assert [layers[f"T{k}"] for k in range(1, 7)] == [0, 1, 2, 2, 1, 0]


@pytest.mark.parametrize("duration", [0.3, 7.0, 3600.0])
def test_pauses_are_filled_with_growing_steps(duration: float) -> None:
    sizes = _pause(duration, 0.0, 1.2, 40)
    assert sizes.sum() == pytest.approx(duration, rel=tol.PROTOCOL)
    assert sizes[0] == 0.05
    assert (sizes[1:] <= 1.5 * np.maximum(1.2 * sizes[:-1], duration / 40)).all()
    later = _pause(duration, 0.2, 1.2, 40)  # goes on from a pause before it
    assert later[0] == pytest.approx(0.2 if duration > 0.3 else duration)


@pytest.mark.parametrize("coefficient", [-2.0, 0.7])
def test_temperature_law_from_two_tests(coefficient: float) -> None:
    """v = 30 exp(m (T - 23)/100), at -20 and 0 degC."""
    ambients = np.array([-20.0, 0.0])
    values = list(30.0 * np.exp(coefficient * (ambients - 23.0) / 100.0))
    result = _with_temperature(values, ambients, 23.0, -0.5, True)
    assert_allclose(result, [30.0, coefficient], rtol=1e-9)
    held = _with_temperature(values[:1], ambients[:1], 23.0, coefficient, False)
    assert_allclose(held, [30.0, coefficient], rtol=1e-9)


def test_search_keeps_the_best_of_its_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    problem: Any = SimpleNamespace(
        pset=SimpleNamespace(start=np.array([0.5])), cost=lambda u: float((u[0] - 0.3) ** 2)
    )
    points = [np.array([0.7]), np.array([0.31]), np.array([0.9])]
    monkeypatch.setattr(search, "_starting_points", lambda *_: points)
    monkeypatch.setattr(search, "_least_squares", lambda _, point, *__, **___: (point, True))
    case: Any = SimpleNamespace(search=None)
    assert search.search(problem, case)[0] == 0.31


def test_least_squares_gets_the_loss_and_its_scale(monkeypatch: pytest.MonkeyPatch) -> None:
    import scipy.optimize

    asked: dict[str, Any] = {}

    def solve(fun: Any, start: np.ndarray, **options: Any) -> Any:
        asked.update(options)
        return SimpleNamespace(x=start, status=1)

    monkeypatch.setattr(scipy.optimize, "least_squares", solve)
    problem: Any = SimpleNamespace(residuals=None, jacobian=None, loss="huber")
    result, converged = search._least_squares(problem, np.array([0.0, 2.0]), 7, fine=True)
    assert converged
    assert_allclose(result, [1e-6, 1.0 - 1e-6])
    assert (asked["loss"], asked["f_scale"], asked["max_nfev"]) == ("huber", 0.02, 7)
    assert asked["bounds"] == (0.0, 1.0)


def test_symbols_and_keys_name_the_same() -> None:
    for kind in KINDS.values():
        assert _full_key(kind.symbol, LHDR) == _full_key(kind.key, LHDR) == kind.key
    assert _full_key("Q_l", LHDR) == "lead.yield_stress"
    with pytest.raises(InputError, match="K_r"):
        _full_key("Kr", LHDR)


def test_values_come_back_from_the_cube() -> None:
    result = parameter_set(LHDR, None, [-20.0, 23.0])
    assert len(result.free) == 11
    for key, value in result.values(result.start).items():
        table, name = key.split(".")
        assert_allclose(value, getattr(getattr(LHDR, table), name), rtol=tol.CONVERSION)


def test_ties_and_bounds() -> None:
    result = parameter_set(HDR, ["m_T", "n_T = 2.5 * m_T"], [23.0], {"m_T": (-2.0, 0.0)})
    values = result.values(np.array([0.25]))
    assert_allclose(values["hysteresis.elastic_temperature_coefficient"], -1.5)
    assert_allclose(values["hysteresis.hysteretic_temperature_coefficient"], -3.75)


def test_unusable_choices() -> None:
    for free, output in ((["K_l"], "no lead"), ([], "nothing is free"), (["Kr"], "K_r")):
        with pytest.raises(InputError, match=output):
            parameter_set(HDR, free, [23.0])
    with pytest.raises(InputError, match="empty"):
        parameter_set(HDR, ["K_r"], [23.0], {"K_r": (3.0, 2.0)})


def test_one_temperature_frees_no_coefficients() -> None:
    symbols = [p.kind.symbol for p in parameter_set(HDR, None, [23.0, 23.0]).free]
    assert symbols == ["alpha_0", "K_r", "s", "d_y", "b"]


def test_turns_in_noise() -> None:
    t = np.linspace(0.0, 3.0, 3001)
    x = np.sin(2.0 * np.pi * t) + np.random.default_rng(0).normal(size=len(t)) * 1e-3
    assert len(turning_points(x, 0.05)) == 2 + 6
    x[1:4] = x[0] - 0.01, x[0] + 0.01, x[0] - 0.02  # noise before the first way
    for offset in (-7.0, 0.0, 7.0):
        assert len(turning_points(x + offset, 0.05)) == 2 + 6


@pytest.mark.parametrize(("bearing", "at"), [(HDR, -20.0), (LHDR, -20.0), (HDR, 23.0)])
def test_coarse_steps_are_near_all_steps(bearing: tb.Bearing, at: float) -> None:
    record = synthetic_record(bearing, at, SHORT, noise=0.0)
    coarse, fine = (ForwardModel(record, bearing, fine=fine) for fine in (False, True))
    assert len(coarse._grid.x) < 0.8 * len(fine._grid.x)
    a, b = coarse.run(bearing), fine.run(bearing)
    assert a is not None
    assert b is not None
    rms = float(np.sqrt(np.mean((a.force - b.force) ** 2)))
    assert rms < tol.COARSE_FORCE * record.peak_force


def test_forward_model_is_the_simulation() -> None:
    """Every step recorded: the same force as `run`, from constants that were only updated."""
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    record = synthetic_record(LHDR, 0.0, test, noise=0.0, sampling=200.0)
    model = ForwardModel(record, generic_start(LHDR), fine=True)
    predicted = model.run(LHDR)
    assert predicted is not None
    assert_allclose(predicted.force[1:], record.force[1:], atol=tol.SAME_FORCE * record.peak_force)


def test_a_weight_counts_force_and_temperature_alike() -> None:
    """Weight w makes the squared residuals of a record w times as large, row by row."""
    test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None)
    bare = replace(synthetic_record(HDR, 23.0, test, noise=0.05), places={"T": "rubber 1"})
    record = replace(bare, temperatures={"T": np.full(len(bare.time), 30.0)})
    pset = parameter_set(HDR, ["K_r"], [23.0])
    one, four = (
        Problem([replace(record, weight=weight)], pset, temperatures=True).parts(pset.start)[0]
        for weight in (1.0, 4.0)
    )
    assert np.abs(one[-len(record.time) :]).min() > 0.0  # the rows of the temperature are there
    assert_allclose(four, 2.0 * one, rtol=tol.ROUNDING)


def test_start_from_the_loops_knows_the_order_of_things() -> None:
    records = [synthetic_record(HDR, at, SHORT) for at in (-20.0, 23.0)]
    pset = parameter_set(generic_start(HDR), None, [-20.0, 23.0])
    start = loop_start(records, pset, Problem(records, pset).coarse)
    assert_allclose(start["hysteresis.layer_stiffness"], 30.7, rtol=tol.BACKBONE_START)
    assert_allclose(
        start["hysteresis.hysteretic_temperature_coefficient"], -2.19, rtol=tol.BACKBONE_START
    )


def test_effective_samples_of_correlated_noise() -> None:
    """An AR(1) series with rho = 0.9 is worth n (1 - rho) / (1 + rho)."""
    rng, rho, n = np.random.default_rng(1), 0.9, 40_000
    x = rng.normal(size=n)
    for i in range(1, n):
        x[i] += rho * x[i - 1]
    assert_allclose(_effective_samples(x), n * (1.0 - rho) / (1.0 + rho), rtol=0.2)


def record_of_cycles(*amplitudes: float) -> TestRecord:
    """Return one cycle of each amplitude [mm] in a row."""
    turn = np.linspace(0.0, 2.0 * np.pi, 101)[1:]
    displacement = np.concatenate([[0.0], *(size * np.sin(turn) for size in amplitudes)])
    time = 0.02 * np.arange(len(displacement))
    return record_from_arrays(time, displacement, displacement, 23.0)


def test_a_closing_cycle_is_no_common_amplitude() -> None:
    """Levels of 30 and 15 mm with closing cycles of 3 mm share none, those of 15 mm share one."""
    large, small, both = (
        level_amplitudes(record_of_cycles(*amplitudes))
        for amplitudes in ((30.0, 30.0, 3.0), (15.0, 15.0, 3.0), (15.0, 15.0, 3.0, 30.0, 30.0, 3.0))
    )
    assert list(both) == [0, 1, 3, 4]
    assert property_cycles([large, small]) == [[1], [1]]
    assert property_cycles([both, small]) == [[1], [1]]
    assert property_cycles([both, large, small]) == [[4], [1], [1]]


def test_properties_are_those_of_the_cycles_with_intervals() -> None:
    """The bearing that the records are of lies within the intervals; ratios are quotients."""
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=3, rest=None, dt=0.02)
    short = tb.cyclic_test(strain=[1.0], cycles=3, rest=None, dt=0.02)
    records = [synthetic_record(HDR, -20.0, test), synthetic_record(HDR, 23.0, short)]
    result = tb.identify_bearing(records, HDR, free=["K_r", "n_T"], starts=1, start_from="bearing")
    properties = {(item.quantity, item.ambient_degC): item for item in result.properties}
    assert len(properties) == len(result.properties) == 8
    size = HDR.area, HDR.total_rubber_thickness
    fields = {"G_e": "G_eq_MPa", "h_eq": "h_eq", "Q_d": "characteristic_strength_kN"}
    fields["K_d"] = "post_yield_stiffness_kN_mm"
    for record in result.records:
        force = ForwardModel(record, HDR, fine=True).run(HDR)
        assert force is not None
        truth, cycles = (
            [c for c in compute_measures(record, one, *size) if c.amplitude_mm > 29.0][1:]
            for one in (force.force, record.force)
        )
        for symbol, field in fields.items():
            item = properties[symbol, record.ambient]
            mean = np.mean([getattr(cycle, field) for cycle in cycles])
            assert item.measured == pytest.approx(mean)
            assert item.strain == pytest.approx(1.0, rel=1e-3)
            true = float(np.mean([getattr(cycle, field) for cycle in truth]))
            assert item.model is not None
            assert item.lower is not None
            assert item.upper is not None
            assert item.lower < true < item.upper
            assert item.upper - item.lower < 0.2 * item.model
    for symbol in fields:
        cold, warm = properties[symbol, -20.0], properties[symbol, 23.0]
        assert warm.ratio is None
        assert cold.model is not None
        assert warm.model is not None
        assert cold.ratio == pytest.approx(cold.model / warm.model)
        assert cold.ratio_lower is not None
        assert cold.ratio is not None
        assert cold.ratio_lower < cold.ratio
    tables = list(result.tables())
    assert tables.index("properties") < tables.index("parameters")


def triangles(per_cycle: int, noise: float = 0.0) -> TestRecord:
    """Three triangular cycles of 20 mm and 4 s, sampled `per_cycle` times each."""
    t = np.linspace(0.0, 12.0, 3 * per_cycle + 1)
    x = 20.0 * (2.0 / np.pi) * np.arcsin(np.sin(0.5 * np.pi * t))
    x = x + noise * np.random.default_rng(3).normal(size=len(x))
    return record_from_arrays(t, x, 2.0 * x, 23.0)


def moving_legs(rate: float, rounding: float, noise: float) -> TestRecord:
    """Triangular cycles of 20 mm and 30 mm/s, whose turns are a mean over `rounding` [s]."""
    t = np.arange(0.0, 8.0, 1.0 / rate)
    fine = t[:, None] + rounding * np.linspace(-0.5, 0.5, 101)[None, :]
    x = np.mean(20.0 * (2.0 / np.pi) * np.arcsin(np.sin(0.75 * np.pi * (fine - 0.003))), axis=1)
    x = x + noise * np.random.default_rng(3).normal(size=len(x))
    return record_from_arrays(t, x, 2.0 * x, 23.0)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_turns_between_two_samples_follow_from_straight_legs(noise: float) -> None:
    """Every turn is at 20 mm, where steps are 0.6 mm; rounded turns and sines are left alone."""
    record = moving_legs(50.0, 0.0, noise)
    turns = find_cut_turns(record.time, record.displacement)
    assert len(turns) == 6
    for number, turn in enumerate(turns):
        assert turn.time == pytest.approx(
            2.0 / 3.0 + number * 4.0 / 3.0 + 0.003, abs=1e-9 + 2.0 * noise
        )
        assert abs(turn.displacement) == pytest.approx(20.0, abs=0.01 + 2.0 * noise)
        assert abs(record.displacement[turn.before : turn.before + 2]).max() < 20.0 + 3.0 * noise
    assert max(turn.cut for turn in turns) > 0.2
    for rounding in (0.04, 0.2):
        rounded = moving_legs(50.0, rounding, noise)
        assert find_sharp_turns(rounded.time, rounded.displacement) == []
    for rate in (12.0, 50.0, 400.0):
        t = np.arange(0.0, 12.0, 1.0 / rate)
        x = 20.0 * np.sin(0.5 * np.pi * t) + noise * np.random.default_rng(3).normal(size=len(t))
        assert find_sharp_turns(t, x) == []


def test_the_model_turns_where_the_legs_meet() -> None:
    """Samples of 50 Hz cut up to 0.3 mm off the tips; d_y is 1.5 mm."""
    dense, rare = moving_legs(1000.0, 0.0, 0.0), moving_legs(50.0, 0.0, 0.0)
    exact, forces = ForwardModel(dense, HDR, fine=True).run(), []
    for fine in (True, False):
        run = ForwardModel(rare, HDR, fine=fine).run()
        assert run is not None
        forces.append(run.force)
    assert exact is not None
    truth = exact.force[::20]
    for force, limit in zip(forces, (2e-3, 2e-2), strict=True):
        assert_allclose(force, truth, atol=limit * float(truth.max()), rtol=0.0)


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_amplitudes_are_those_between_samples(noise: float) -> None:
    """Samples miss the turns at 20 mm by up to 0.3 mm; rounded turns are what the samples are."""
    record = moving_legs(50.0, 0.0, noise)
    assert len(turned_amplitudes(record)) == len(full_cycles(record))
    assert turned_amplitudes(record) == pytest.approx([20.0] * 2, abs=0.01 + noise)
    assert min(cycle.amplitude for cycle in full_cycles(record)) < 19.85
    assert largest_displacement(record) == pytest.approx(20.0, abs=0.01 + 2.0 * noise)
    rounded = moving_legs(50.0, 0.2, 0.0)
    sampled = [cycle.amplitude for cycle in full_cycles(rounded)]
    assert turned_amplitudes(rounded) == sampled
    assert largest_displacement(rounded) == rounded.peak_displacement


def test_the_peak_force_of_a_loop_is_that_of_the_larger_side() -> None:
    test = {"F+": 90.0, "F-": -100.0, "K_eq": 5.0, "h_eq": 0.2, "energy": 10.0}
    model = test | {"F+": 110.0, "F-": -80.0}
    loop = Loop(0, 9, 1, 1, 20.0, 20.0, -20.0, test, model, (30.0, 31.0))
    assert loop.errors["force_max_error"] == pytest.approx(0.1)
    assert loop.model_measures["force"] == 110.0
    assert loop.model_measures["Q_d"] == 31.0


def test_samples_that_do_not_resolve_a_turn_are_named() -> None:
    """0.6 mm are 0.4 of d_y = 1.5 mm: enough where sharp turns are known, not where rounded."""
    sharp, rounded = moving_legs(50.0, 0.0, 0.02), moving_legs(50.0, 0.04, 0.02)
    assert describe_coarse_samples(sharp, 1.5) == ""
    assert "80 Hz" in describe_coarse_samples(sharp, 1.5, also_sharp=True)  # 50 * 0.6 / 0.375
    assert describe_coarse_samples(rounded, 1.5) != ""
    dense = moving_legs(200.0, 0.04, 0.02)
    assert describe_coarse_samples(dense, 1.5, also_sharp=True) == ""


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.07, 0.0875, 0.12])
def test_noise_does_not_make_steps_longer_or_turns_round(noise: float) -> None:
    """Steps of 0.3 mm, resolved by d_y = 1.214 mm; a rest that is held makes most of the record."""
    for shift in range(3):
        legs = moving_legs(100.0, 0.0, 0.0)
        motion = legs.displacement
        scatter = noise * np.random.default_rng(shift).normal(size=len(motion))
        x = np.append(motion + scatter, np.full(1200, motion[-1]))
        record = record_from_arrays(0.01 * np.arange(len(x)), x, 2.0 * x, 23.0)
        assert step_at_reversals(record) == pytest.approx(0.3, abs=0.005 + 0.2 * noise)
        assert describe_coarse_samples(record, 1.214) == ""
        if noise < 0.05:
            assert len(find_sharp_turns(record.time, record.displacement)) == 6


def test_the_rate_that_is_asked_for_is_above_that_of_the_record() -> None:
    """Steps of 0.294 mm are 105 and 118 % of the limit, a quarter of d_y, where turns are round."""
    record = moving_legs(100.0, 0.04, 0.0)
    assert describe_coarse_samples(record, 4.0 * 0.294 / 1.05) == ""
    assert "118 Hz or more instead of 100 Hz" in describe_coarse_samples(record, 1.0)


def test_displacements_that_make_intervals_too_narrow() -> None:
    """d_y is 1.549 mm: steps of 2 and 0.5 mm, noise of 0.22 and 0.05 mm, and a sine."""
    assert step_at_reversals(triangles(40)) == pytest.approx(2.0)
    assert step_at_reversals(triangles(160)) == pytest.approx(0.5)
    t = np.linspace(0.0, 12.0, 121)
    sine = record_from_arrays(t, 20.0 * np.sin(0.5 * np.pi * t), t, 23.0)
    assert step_at_reversals(sine) == pytest.approx(20.0 * (1.0 - np.cos(np.pi / 20.0)))
    d_y = float(HDR.hysteresis.yield_displacement)
    assert describe_signals([sine, triangles(160, 0.05)], d_y) == []
    (coarse,) = describe_signals([triangles(160), triangles(40)], d_y)
    assert "2 mm" in coarse
    assert "52 Hz" in coarse  # 10 Hz, and 2 mm are 5.16 times a quarter of d_y
    (noisy,) = describe_signals([triangles(160, 0.22), triangles(160)], d_y)
    assert "14 % of d_y" in noisy or "15 % of d_y" in noisy
    assert "0.15 mm" in noisy  # a tenth of d_y


@pytest.mark.parametrize(
    ("span", "largest", "misfit", "words"),
    [
        (15.0, 40.0, False, {"temperature", "hardening"}),
        (20.5, 40.0, False, {"hardening"}),
        (20.5, 60.5, False, set()),
        (15.0, 60.5, True, {"temperature", "misfit"}),
    ],
)
def test_advice_names_what_the_tests_do_not_have(
    span: float, largest: float, misfit: bool, words: set[str]
) -> None:
    """HDR has 30 mm of rubber: two amplitudes up to 60 mm are several up to 200 %."""
    records = [replace(sines((10.0, largest)), ambient=ambient) for ambient in (0.0, span)]
    problem: Any = SimpleNamespace(records=records, pset=parameter_set(HDR, ["n_T"], [0.0, span]))
    advice = _Advice(problem, misfit)
    texts = {"temperature": advice.on(KINDS[M_T]), "hardening": advice.on(KINDS[HARDENING])}
    expected = {"temperature": "at least 20 K apart", "hardening": "amplitudes up to 200 %"}
    named = {name for name, text in texts.items() if expected[name] in text}
    named |= (
        {"misfit"} if all("Remove the misfit first" in text for text in texts.values()) else set()
    )
    assert named == words
