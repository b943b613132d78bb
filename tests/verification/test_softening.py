"""Cold and strained bearings: softened layers, and the hardening that never softens."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.verification import models
from tests.verification.softened import (
    SLOW,
    Trials,
    continuity,
    full_cycles,
    halving_errors,
    moved_by_a_parameter,
)
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.core.hardening import force_and_tangent, strain_factor
from thermobearing.core.march import copy_state
from thermobearing.core.records import Floats
from thermobearing.core.types import COMPLETED, SOFTENED, new_state
from thermobearing.model.constants import SHARING_START

TEMPERATURES = (-60.0, -40.0, -20.0, 0.0, 23.0, 60.0)
STRAINS = (0.5, 1.0, 2.0, 2.5, 3.0, 3.5)
COLD = (
    ("shen-hdr-specimen", -20.0, 2.5),
    ("shen-hdr-specimen", -40.0, 3.0),
    ("shen-hdr-specimen", -60.0, 3.5),
    ("shen-lhdr-specimen", -20.0, 2.5),
    ("shen-lhdr-specimen", -40.0, 3.0),
    ("shen-lhdr-specimen", -60.0, 3.5),
)


@pytest.mark.parametrize(("dt", "steps"), [(1e-4, 2000), (5e-3, 1000), (5e-2, 250)])
@pytest.mark.parametrize("half", [True, False])
def test_no_history_ends_a_run(dt: float, steps: int, half: bool) -> None:
    """Random smooth histories over the whole range of temperature and strain."""
    bearing, constants = models.specimen(), models.assembled(models.specimen(), half=half)
    d_y = bearing.hysteresis.yield_displacement * (1.0 + tol.BOUND_ROUNDING)
    rng = np.random.default_rng(21)
    softened = 0
    for temperature in TEMPERATURES:
        for strain in STRAINS:
            x = models.smooth_history(rng, strain * bearing.total_rubber_thickness, steps)
            run = models.marched(constants, x, dt, temperature, temperature)
            assert run.outcome in (COMPLETED, SOFTENED)
            assert len(run.response) == steps
            assert np.isfinite(models.numbers(run.response)).all()
            assert np.isfinite(run.cells).all()
            assert np.abs(run.z).max() <= d_y
            total = run.d @ constants.multiplicity
            assert_allclose(total, run.response["displacement"], rtol=0.0, atol=tol.ADDS_UP)
            softened += run.softened
    assert softened > 0  # the hard regime was visited


@pytest.mark.parametrize("half", [True, False])
def test_jumps_within_one_step_end_no_run(half: bool) -> None:
    """White noise up to 350 %, layers 20 K apart: coarser than sensible, but a trial may ask it."""
    constants, peak = (
        models.assembled(models.specimen(), half=half),
        3.5 * models.specimen().total_rubber_thickness,
    )
    rng = np.random.default_rng(22)
    for temperature in TEMPERATURES:
        for _ in range(10):
            x = rng.uniform(-peak, peak, 100)
            uneven = temperature + rng.uniform(-20.0, 20.0, len(constants.cells.capacity))
            run = models.marched(constants, x, 5e-3, uneven, temperature)
            assert run.outcome in (COMPLETED, SOFTENED)
            assert len(run.response) == len(x)
            assert np.isfinite(models.numbers(run.response)).all()
            assert_allclose(run.d @ constants.multiplicity, x, rtol=0.0, atol=tol.ADDS_UP)


def cold_run(dt: float, temperature: float = -40.0, strain: float = 3.0) -> models.Run:
    """Three cycles of 300 % at -40 degC."""
    x = models.sine(models.specimen(), strain=strain, period=4.0, cycles=3, dt=dt)
    return models.marched(models.assembled(models.specimen()), x, dt, temperature, temperature)


def test_softened_runs_converge_with_the_time_step() -> None:
    runs = [cold_run(dt) for dt in (10e-3, 5e-3, 2.5e-3)]
    assert all(run.softened > 0 for run in runs)
    peak = np.array([np.abs(run.response["force"]).max() for run in runs])
    work = np.array([run.response["work_in"][-1] for run in runs])
    assert_allclose(peak[:-1], peak[1:], rtol=tol.SOFTENED_PEAK, atol=0.0)
    assert_allclose(work[:-1], work[1:], rtol=tol.SOFTENED_WORK, atol=0.0)
    for values in (peak, work):  # and the differences shrink
        assert abs(values[2] - values[1]) < tol.HALVED * abs(values[1] - values[0])


@pytest.mark.parametrize(("name", "temperature", "strain"), quick_cases(COLD, 0, 5))
def test_force_is_continuous_within_a_step_and_the_tangent_its_slope(
    name: str, temperature: float, strain: float, measured: Recorder
) -> None:
    """Trial displacements in every softened step; the weight moves with x, and the tangent too."""
    seen = continuity(load_bearing(name), temperature, strain, dt=20e-3)
    assert seen.softened > 60
    given = f"{name}, {temperature:g} degC, {100.0 * strain:g} %"
    measured(f"jumps of F(x) inside softened steps, {given}", str(len(seen.jumps)), "0")
    error = seen.tangent_quantile
    measured(f"tangent in 90 % of them, {given}", error, f"{tol.SOFTENED_TANGENT:g}")
    assert len(seen.jumps) == 0
    assert error < tol.SOFTENED_TANGENT


@pytest.mark.parametrize("name", ["shen-hdr-specimen", "shen-lhdr-specimen"])
def test_force_is_continuous_in_slow_cycles(name: str) -> None:
    """At the speed of Table 3.4 the layers are far more unlike than in 4 s."""
    seen = continuity(load_bearing(name), -40.0, 3.0, dt=20e-3, period=SLOW)
    assert seen.softened > 500
    assert len(seen.jumps) == 0
    assert seen.tangent_quantile < tol.SOFTENED_TANGENT


def test_a_small_change_of_a_parameter_moves_samples_a_little() -> None:
    """Of the coldest and farthest case: a fit needs forces that are smooth in the parameters."""
    name, temperature, strain = COLD[-1]
    moved = moved_by_a_parameter(load_bearing(name), temperature, strain, change=2.5e-5)
    assert 0.0 < moved < tol.MOVED * 2.5e-5


def test_the_coldest_case_converges_with_the_time_step() -> None:
    name, temperature, strain = COLD[-1]
    errors = halving_errors(load_bearing(name), temperature, strain, (10e-3, 5e-3, 2.5e-3))
    assert errors[1] < tol.FIRST_ORDER * errors[0]


@pytest.mark.parametrize(("name", "temperature", "strain"), COLD)
def test_mismatch_is_reported_as_it_is(
    name: str, temperature: float, strain: float, measured: Recorder
) -> None:
    """In softened steps too, the reported mismatch is the distance from the printed law."""
    bearing = load_bearing(name)
    run = full_cycles(bearing, temperature, strain, 5e-3)
    rubber, force = run.response["rubber_force"], run.response["force"]
    apart = np.abs(models.layer_forces(bearing, run) - rubber[:, None]).max(axis=1)
    soft = run.response["sharing_weight"] > 0.0
    assert run.softened == np.count_nonzero(soft) > 0
    peak = np.abs(force).max()
    text = f"{apart.max():.2f} kN of {peak:.0f} kN"
    given = f"{name}, {temperature:g} degC, {100.0 * strain:g} %, five cycles"
    measured(f"softened layers, {given}: layer law at most this far from F", text, "reported")
    assert_allclose(
        run.response["layer_force_mismatch"], apart, rtol=0.0, atol=tol.EQUAL_FORCE * peak
    )
    assert_allclose(apart[~soft], 0.0, rtol=0.0, atol=tol.EQUAL_FORCE * peak)


def test_layer_forces_are_equal_under_the_law_that_softened_steps_use() -> None:
    """Hardening at (1 - w) d + w x/N, every other term of Eq. 4.34 as printed: one force."""
    bearing = models.specimen()
    run = cold_run(5e-3)
    h, t_r, w = (
        bearing.hysteresis,
        bearing.geometry.rubber_thickness,
        run.response["sharing_weight"][:, None],
    )
    mean = run.response["displacement"][:, None] / bearing.geometry.rubber_layers
    printed = h.hardening * (run.d / t_r) ** 2
    shared = h.hardening * (((1.0 - w) * run.d + w * mean) / t_r) ** 2
    warmer = h.hysteretic_temperature_coefficient * (run.layer_start - 23.0) / 100.0
    kh = (1.0 - h.post_yield_ratio) * np.exp(warmer) * h.layer_stiffness
    force = models.layer_forces(bearing, run) + (shared - printed) * kh * run.z
    common = run.response["force"][:, None]
    atol = tol.EQUAL_FORCE * np.abs(common).max()
    assert_allclose(force, np.broadcast_to(common, force.shape), rtol=0.0, atol=atol)


def edge_jumps(dt: float) -> tuple[float, float]:
    """Largest change of w in one step, and bend of the force [kN] where w leaves or enters zero."""
    run = cold_run(dt)
    weight, force = run.response["sharing_weight"], run.response["force"]
    edges = np.flatnonzero(np.diff((weight > 0.0).astype(int)) != 0)
    assert len(edges) == 12  # in and out, twice a cycle
    return float(np.abs(np.diff(weight)).max()), float(np.abs(np.diff(force, 2))[edges - 1].max())


def test_softening_sets_in_and_ends_without_a_jump() -> None:
    """A jump would stay as it is when the step is halved; a continuous rule halves it."""
    jumps = np.array([edge_jumps(dt) for dt in (4e-3, 2e-3, 1e-3)])
    assert (jumps[1:] < tol.HALVED * jumps[:-1]).all()


PRINTED = models.assembled(models.specimen()).rubber
MONOTONE = models.assembled(models.specimen(), hardening="monotone").rubber
KE, KH = 12.0, 80.0  # [kN/mm], as at -40 degC


def isothermal(bearing: Bearing, hardening: str, temperature: float, strain: float) -> Floats:
    """Slope of the force in every step of a sine on one layer that does not warm, over its ke."""
    one = models.changed(bearing, geometry={"rubber_layers": 1})
    constants = models.assembled(one, hardening=hardening)._replace(source_rise=0.0)
    x = models.sine(one, strain=strain, period=4.0, cycles=2, dt=5e-3)
    force = models.marched(constants, x, 5e-3, temperature, temperature).response["rubber_force"]
    h = bearing.hysteresis
    colder = (temperature - h.reference_temperature) / 100.0
    ke = h.post_yield_ratio * h.layer_stiffness * np.exp(h.elastic_temperature_coefficient * colder)
    return np.diff(force) / np.diff(x) / ke


@pytest.mark.parametrize(("name", "temperature", "strain"), COLD)
def test_unloading_is_monotone_and_the_print_is_not(
    name: str, temperature: float, strain: float
) -> None:
    bearing = tb.load_bearing(name)
    assert isothermal(bearing, "printed", temperature, strain).min() < 0.0
    least = isothermal(bearing, "monotone", temperature, strain).min()
    assert least < 1.5 * SHARING_START  # nearly reached: Z is nearly saturated
    assert least > SHARING_START * (1.0 - tol.CHORD)


@pytest.mark.parametrize("z", [-1.5, -0.3, 0.0, 0.3, 1.5])
@pytest.mark.parametrize("d", [-18.0, -4.0, 0.0, 4.0, 18.0])
def test_the_print_where_d_and_z_have_one_sign_or_strain_is_small(d: float, z: float) -> None:
    given = (KE, KH, d, z, 0.4, 0.0, 0.0)
    printed, monotone = (force_and_tangent(rubber, *given) for rubber in (PRINTED, MONOTONE))
    steepest = (1.0 - SHARING_START) * KE / (KH * PRINTED.yield_displacement)
    if d * z >= 0.0 or 2.0 * PRINTED.hardening * abs(d) <= steepest:
        assert monotone == printed
    else:
        hysteretic = [abs(force - KE * d) for force in (monotone[0], printed[0])]
        assert abs(KH * z) < hysteretic[0] < hysteretic[1]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_factor_goes_on_straight(sign: float) -> None:
    """Value and slope are continuous where the straight line begins, the slope everywhere that."""
    steepest = (1.0 - SHARING_START) * KE / (KH * MONOTONE.yield_displacement)
    limit = 0.5 * steepest / MONOTONE.hardening
    below, above = (
        strain_factor(MONOTONE, KE, KH, sign * (limit + by), -sign * 1.0) for by in (-1e-9, 1e-9)
    )
    assert_allclose(below, above, rtol=1e-7)
    for s in (0.5 * limit, 3.0 * limit):
        up, down = (strain_factor(MONOTONE, KE, KH, sign * s + h, -sign)[0] for h in (1e-5, -1e-5))
        slope = strain_factor(MONOTONE, KE, KH, sign * s, -sign)[1]
        assert_allclose((up - down) / 2e-5, slope, rtol=1e-6)


@pytest.mark.parametrize("half", [True, False])
def test_no_layer_softens_and_forces_are_equal(half: bool) -> None:
    """Over the whole range of temperature and strain, in steps of 5 and 50 ms."""
    constants = models.assembled(models.specimen(), half=half, hardening="monotone")
    rng = np.random.default_rng(23)
    for temperature in TEMPERATURES:
        for strain in STRAINS:
            x = models.smooth_history(rng, strain * models.specimen().total_rubber_thickness, 400)
            run = models.marched(
                constants, x, 5e-3 if strain < 3.0 else 5e-2, temperature, temperature
            )
            assert run.outcome == COMPLETED
            assert run.softened == 0
            peak = np.abs(run.response["force"]).max()
            assert run.response["layer_force_mismatch"].max() < tol.EQUAL_FORCE * peak


@pytest.mark.parametrize("source", ["work", "dissipation"])
def test_energy_balance_closes(source: str) -> None:
    x = models.sine(models.specimen(), strain=3.0, period=4.0, cycles=3, dt=5e-3)
    constants = models.assembled(models.specimen(), hardening="monotone", heat_source=source)
    response = models.marched(constants, x, 5e-3, -40.0, -40.0).response[-1]
    missing = response.work_in - response.heat_released - response.recoverable
    assert abs(missing) < tol.ENERGY_BALANCE * response.work_in


def test_tangent_is_the_derivative_of_the_force() -> None:
    trials = Trials(models.assembled(models.specimen(), hardening="monotone"), -40.0, 5e-3)
    new, errors, h = new_state(trials.constants, trials.state.temperature), [], 1e-5
    for i, x in enumerate(
        models.sine(models.specimen(), strain=3.0, period=4.0, cycles=1.5, dt=5e-3)
    ):
        tangent = trials.step(x, new)[1]
        if i % 10 == 7:
            slope = (trials.force(x + h) - trials.force(x - h)) / (2.0 * h)
            errors.append(abs(tangent / slope - 1.0))
        copy_state(new, trials.state)
    assert np.quantile(errors, 0.9) < tol.TANGENT_BEARING  # a layer may pass Z = 0 in between


def test_the_coldest_slow_case_converges_with_the_time_step() -> None:
    """Where the printed law does not: -60 degC, 350 %, at the speed of Table 3.4."""
    name, temperature, strain = COLD[-1]
    how = {"period": SLOW, "hardening": "monotone"}
    steps = (10e-3, 5e-3, 2.5e-3)
    errors = halving_errors(tb.load_bearing(name), temperature, strain, steps, **how)
    assert errors[1] < tol.FIRST_ORDER * errors[0]


def test_what_it_changes(measured: Recorder) -> None:
    """Third cycle of 250 %: a little stiffer, a little thinner, in the cold more."""
    for name in ("shen-hdr-specimen", "shen-lhdr-specimen"):
        for ambient in (-20.0, 23.0):
            printed, monotone = (
                tb.run(
                    name,
                    tb.cyclic_test(strain=[2.5], cycles=3),
                    ambient,
                    model=tb.ModelOptions(hardening=form),
                ).cycles.iloc[2]
                for form in ("printed", "monotone")
            )
            by = [float(monotone[n] / printed[n] - 1.0) for n in ("G_eq_MPa", "h_eq")]
            text = f"{100 * by[0]:+.1f} %, {100 * by[1]:+.1f} %"
            measured(
                f"{name}, {ambient:g} degC, monotone over printed: G_e, h_eq", text, "reported"
            )
            assert 0.0 <= by[0] < 0.01
            assert -0.02 < by[1] < 0.0
