"""hardening = "monotone": the print while d and Z have one sign, unloading that never goes up."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.conftest import Recorder
from tests.tolerances import CHORD, ENERGY_BOOKS, EQUAL_FORCE, FIRST_ORDER, TANGENT_BEARING
from tests.verification.models import assembled, changed, marched, sine, smooth_history, specimen
from tests.verification.softened import SLOW, Trials, halving_errors
from tests.verification.test_softening import COLD, STRAINS, TEMPERATURES
from thermobearing.bearing.model import Bearing
from thermobearing.core.hardening import force_and_tangent, strain_factor
from thermobearing.core.march import copy_state
from thermobearing.core.records import Floats
from thermobearing.core.types import COMPLETED, new_state
from thermobearing.model.constants import SHARING_START

PRINTED = assembled(specimen()).rubber
MONOTONE = assembled(specimen(), hardening="monotone").rubber
KE, KH = 12.0, 80.0  # [kN/mm], as at -40 degC


def isothermal(bearing: Bearing, hardening: str, temperature: float, strain: float) -> Floats:
    """Slope of the force in every step of a sine on one layer that does not warm, over its ke."""
    one = changed(bearing, geometry={"rubber_layers": 1})
    constants = assembled(one, hardening=hardening)._replace(source_rise=0.0)
    x = sine(one, strain=strain, period=4.0, cycles=2, dt=5e-3)
    force = marched(constants, x, 5e-3, temperature, temperature).books["rubber_force"]
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
    assert least > SHARING_START * (1.0 - CHORD)


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
    constants = assembled(specimen(), half=half, hardening="monotone")
    rng = np.random.default_rng(23)
    for temperature in TEMPERATURES:
        for strain in STRAINS:
            x = smooth_history(rng, strain * specimen().total_rubber_thickness, 400)
            run = marched(constants, x, 5e-3 if strain < 3.0 else 5e-2, temperature, temperature)
            assert run.outcome == COMPLETED
            assert run.softened == 0
            peak = np.abs(run.books["force"]).max()
            assert run.books["layer_force_mismatch"].max() < EQUAL_FORCE * peak


@pytest.mark.parametrize("source", ["work", "dissipation"])
def test_energy_books_close(source: str) -> None:
    x = sine(specimen(), strain=3.0, period=4.0, cycles=3, dt=5e-3)
    constants = assembled(specimen(), hardening="monotone", heat_source=source)
    books = marched(constants, x, 5e-3, -40.0, -40.0).books[-1]
    missing = books.work_in - books.heat_released - books.recoverable
    assert abs(missing) < ENERGY_BOOKS * books.work_in


def test_tangent_is_the_derivative_of_the_force() -> None:
    trials = Trials(assembled(specimen(), hardening="monotone"), -40.0, 5e-3)
    new, errors, h = new_state(trials.constants, trials.state.temperature), [], 1e-5
    for i, x in enumerate(sine(specimen(), strain=3.0, period=4.0, cycles=1.5, dt=5e-3)):
        tangent = trials.step(x, new)[1]
        if i % 10 == 7:
            slope = (trials.force(x + h) - trials.force(x - h)) / (2.0 * h)
            errors.append(abs(tangent / slope - 1.0))
        copy_state(new, trials.state)
    assert np.quantile(errors, 0.9) < TANGENT_BEARING  # a layer may pass Z = 0 in between


def test_the_coldest_slow_case_converges_with_the_time_step() -> None:
    """Where the printed law does not: -60 degC, 350 %, at the speed of Table 3.4."""
    name, temperature, strain = COLD[-1]
    how = {"period": SLOW, "hardening": "monotone"}
    steps = (10e-3, 5e-3, 2.5e-3)
    errors = halving_errors(tb.load_bearing(name), temperature, strain, steps, **how)
    assert errors[1] < FIRST_ORDER * errors[0]


def test_what_it_changes(measured: Recorder) -> None:
    """Third cycle of 250 %: a little stiffer, a little thinner, in the cold more."""
    for name in ("shen-hdr-specimen", "shen-lhdr-specimen"):
        for ambient in (-20.0, 23.0):
            printed, monotone = (
                tb.run(
                    name, tb.cyclic_test(strain=[2.5], cycles=3), ambient, hardening=form
                ).cycles.iloc[2]
                for form in ("printed", "monotone")
            )
            by = [float(monotone[n] / printed[n] - 1.0) for n in ("G_eq_MPa", "h_eq")]
            text = f"{100 * by[0]:+.1f} %, {100 * by[1]:+.1f} %"
            measured(f"{name}, {ambient:g} degC, monotone over printed: G_e, h_eq", text, "told")
            assert 0.0 <= by[0] < 0.01
            assert -0.02 < by[1] < 0.0
