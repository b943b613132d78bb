"""A table in place of the exponents of Eq. 4.34, the stated range, and what is said beyond it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import thermobearing as tb
from tests.conftest import Recorder
from tests.tolerances import ENERGY_BALANCE, ISOTHERMAL_FORCE, LOOP, TABLE_SLOPE
from tests.verification.models import Run, assembled, changed, marched, numbers, sine, specimen
from thermobearing.bearing.compound import load_compound
from thermobearing.bearing.model import Bearing, TemperatureLaw
from thermobearing.core.step import tabled
from thermobearing.model.constants import LAW_RANGE, _law_pieces, outside_law, with_parameters
from thermobearing.model.stack import build_stack

# G_eq over that at 20 degC, measured, of a high damping rubber for buildings (Toyo, G0.35).
MEASURED = {-20: 1.47, -10: 1.22, 0: 1.14, 10: 1.05, 20: 1.00, 30: 0.99, 40: 0.93}
NO_EXPONENTS = {"elastic_temperature_coefficient": 0.0, "hysteretic_temperature_coefficient": 0.0}


def tabled_bearing(elastic: Any, hysteretic: Any, temperatures: Any = tuple(MEASURED)) -> Bearing:
    law = TemperatureLaw(
        temperatures=[float(t) for t in temperatures],
        elastic=[float(f) for f in elastic],
        hysteretic=[float(f) for f in hysteretic],
    )
    return changed(specimen(), hysteresis=NO_EXPONENTS).model_copy(update={"temperature_law": law})


def cycles(bearing: Bearing, temperature: float) -> Run:
    """Two cycles of 150 %."""
    x = sine(bearing, strain=1.5, period=4.0, cycles=2, dt=5e-3)
    return marched(assembled(bearing), x, 5e-3, temperature, temperature)


@pytest.mark.parametrize("temperature", [-45.0, -13.0, 23.0, 38.0])
def test_a_table_of_the_exponential_law_is_that_law(temperature: float) -> None:
    """Inside the table and beyond both ends: a straight line of the logarithm goes on straight."""
    h = specimen().hysteresis
    warmer = (np.array(list(MEASURED)) - h.reference_temperature) / 100.0
    elastic = np.exp(h.elastic_temperature_coefficient * warmer)
    hysteretic = np.exp(h.hysteretic_temperature_coefficient * warmer)
    result = cycles(tabled_bearing(elastic, hysteretic), temperature)
    wanted = cycles(specimen(), temperature)
    force = wanted.response["force"]
    atol = ISOTHERMAL_FORCE * np.abs(force).max()
    assert_allclose(result.response["force"], force, rtol=0.0, atol=atol)


def test_table_is_met_and_monotone_and_smooth_between() -> None:
    factors = list(MEASURED.values())
    law = tabled_bearing(factors, np.square(factors)).temperature_law
    pieces = _law_pieces(law)
    at = np.linspace(-40.0, 60.0, 2001)
    elastic, hysteretic, viscous = np.array([tabled(pieces, t) for t in at]).T
    for t, factor in MEASURED.items():
        assert_allclose(np.exp(tabled(pieces, float(t))), [factor, factor**2, 1.0], rtol=LOOP)
    assert (np.diff(elastic) < 0.0).all()  # the table falls everywhere
    assert_allclose(hysteretic, 2.0 * elastic, rtol=LOOP, atol=LOOP)
    assert (viscous == 0.0).all()
    slope = np.diff(elastic) / np.diff(at)
    assert np.abs(np.diff(slope)).max() < TABLE_SLOPE  # no kink where two pieces meet
    assert_allclose(np.diff(slope[at[:-1] < -20.05]), 0.0, atol=LOOP)  # straight beyond the ends
    assert_allclose(np.diff(slope[at[:-1] > 40.0]), 0.0, atol=LOOP)


def test_stiffness_is_that_of_the_table() -> None:
    """At one temperature: the bearing whose K_r is multiplied by the factor, to rounding."""
    at, factor = 40.0, MEASURED[40]
    # Heat that no temperature feels: the first steps, before the rubber warms.
    result = cycles(tabled_bearing(MEASURED.values(), MEASURED.values()), at)
    h = specimen().hysteresis
    softer = changed(
        specimen(), hysteresis=NO_EXPONENTS | {"layer_stiffness": factor * h.layer_stiffness}
    )
    assert_allclose(result.response["force"][0], cycles(softer, at).response["force"][0], rtol=LOOP)


def test_the_exponential_law_is_too_soft_when_warm(measured: Recorder) -> None:
    """Against the measured table: the specimen's law at 40 degC, relative to 20 degC."""
    strain = {"strain": [1.75], "cycles": 1}
    warm, usual = (
        tb.run("shen-hdr-specimen", tb.cyclic_test(**strain), t).cycles["G_eq_MPa"].iloc[0]
        for t in (40.0, 20.0)
    )
    off = float(warm / usual / MEASURED[40] - 1.0)
    measured(
        "G_eq at 40 over 20 degC, law against a measured table", f"{100 * off:+.0f} %", "reported"
    )
    assert -0.25 < off < -0.10


def with_viscosity(factors: list[float], **hysteresis: float) -> Bearing:
    """The LHDR specimen whose c_v has these factors at -20, 0 and 40 degC."""
    law = TemperatureLaw(temperatures=[-20.0, 0.0, 40.0], viscosity=factors)
    bearing = changed(tb.load_bearing("shen-lhdr-specimen"), hysteresis=hysteresis)
    return bearing.model_copy(update={"temperature_law": law})


def test_a_viscosity_of_one_is_that_without_a_table() -> None:
    x = sine(specimen(), strain=1.5, period=2.0, cycles=1, dt=0.01)
    plain = marched(assembled(tb.load_bearing("shen-lhdr-specimen")), x, 0.01, -20.0, -20.0)
    table = marched(assembled(with_viscosity([1.0, 1.0, 1.0])), x, 0.01, -20.0, -20.0)
    assert_array_equal(numbers(table.response), numbers(plain.response))


def viscous_force(dt: float, source: str = "work") -> tuple[Run, Any]:
    """Three cycles that warm a bearing from -20 degC, and the branch by scipy."""
    bearing, period = with_viscosity([8.0, 3.0, 1.0]), 1.0
    x = sine(bearing, strain=2.0, period=period, cycles=3, dt=dt)
    run = marched(assembled(bearing, heat_source=source), x, dt, -20.0, -20.0)
    time = dt * np.arange(1, len(x) + 1)
    layers = np.vstack([run.layer_start[1:], run.layer_start[-1:]])
    law, share = bearing.temperature_law, run.constants.multiplicity
    assert law is not None
    assert bearing.rate is not None
    factor = PchipInterpolator(law.temperatures, np.log([8.0, 3.0, 1.0]))
    fluidity = np.exp(-factor(layers)) @ share / share.sum()
    k, c = bearing.rate.stiffness, bearing.rate.damping
    omega, amplitude = 2.0 * np.pi / period, 2.0 * bearing.total_rubber_thickness

    def slope(t: float, f: Any) -> Any:
        speed = amplitude * omega * np.cos(omega * t)
        return k * (speed - f * np.interp(t, time, fluidity) / c)

    solved = solve_ivp(slope, (0.0, time[-1]), [0.0], t_eval=time, rtol=1e-8, max_step=dt)
    return run, solved.y[0]


def test_viscosity_follows_the_layers_as_scipy_integrates_it(measured: Recorder) -> None:
    """The temperatures of the start of a step: first order in the step, and small."""
    errors, warmed = [], 0.0
    for dt in (0.01, 0.005):
        run, exact = viscous_force(dt)
        errors.append(float(np.abs(run.response["viscous_force"] - exact).max() / exact.max()))
        warmed = float(run.layer_start[-1].mean() + 20.0)
    assert warmed > 5.0  # else the test shows nothing
    measured(
        "viscous force whose viscosity depends on temperature, from scipy, dt = 5 ms, relative",
        errors[1],
        "2e-03",
    )
    assert errors[1] < 2e-3
    assert errors[1] / errors[0] < 0.6


@pytest.mark.parametrize("source", ["work", "dissipation"])
def test_energy_balance_with_a_viscosity_that_falls(source: str) -> None:
    bearing = with_viscosity([8.0, 3.0, 1.0])
    x = sine(bearing, strain=2.0, period=1.0, cycles=3, dt=0.01)
    run = marched(assembled(bearing, heat_source=source), x, 0.01, -20.0, -20.0)
    end = run.response[-1]
    stored = end["heat_stored"] + end["heat_lost_ends"] + end["heat_lost_sides"]
    assert abs(end["work_in"] - end["heat_released"] - end["recoverable"]) < (
        ENERGY_BALANCE * end["work_in"]
    )
    assert abs(end["heat_released"] - stored) < ENERGY_BALANCE * end["work_in"]


def test_parameters_of_a_fit_leave_the_table_alone() -> None:
    bearing = tabled_bearing(MEASURED.values(), MEASURED.values())
    constants = assembled(bearing)
    other = changed(bearing, hysteresis={"hysteretic_temperature_coefficient": -1.0})
    again = with_parameters(constants, other, build_stack(bearing, half=True))
    assert again.law is constants.law
    assert again.rubber.hysteretic_exponent == -0.01


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"coldest": 0.0}, "give both coldest and warmest"),
        ({"coldest": 10.0, "warmest": 0.0}, "coldest must be below warmest"),
        ({"temperatures": [0.0, 1.0]}, "a table needs temperatures, elastic and hysteretic"),
        ({"temperatures": [0.0, 1.0], "elastic": [1.0, 1.0], "viscosity": [1.0, 1.0]}, "viscosity"),
        ({"viscosity": [1.0, 1.0]}, "or temperatures and viscosity"),
        ({"temperatures": [1.0, 0.0], "elastic": [1.0, 1.0], "hysteretic": [1.0, 1.0]}, "increase"),
        ({"temperatures": [0.0, 1.0], "elastic": [1.0], "hysteretic": [1.0, 1.0]}, "equally long"),
        ({"temperatures": [0.0, 1.0], "elastic": [1.0, 0.0], "hysteretic": [1.0, 1.0]}, "0.001"),
    ],
)
def test_a_broken_law_is_reported(given: dict[str, Any], message: str) -> None:
    with pytest.raises(tb.InputError, match=message):
        TemperatureLaw(**given)


def of_the_law(warnings: list[str]) -> list[str]:
    """Those about the temperature law, not those about what the bearing was tested at."""
    return [text for text in warnings if "temperature law" in text]


def test_extrapolation_is_said() -> None:
    """Colder than the tests; warmer, since the rubber heats up; and nothing in between."""
    test = tb.cyclic_test(strain=[1.75], cycles=3)
    cold = tb.run("shen-hdr-specimen", test, [-30.0, 0.0])
    (output,) = of_the_law(cold.warnings)
    assert "reaches -30.0 degC, 10 K below the range of the temperature law, -20 to 34" in output
    assert "in 1 of 2 runs; longest in the run at -30 degC" in output
    assert cold.summary()["warnings"] == cold.warnings
    layers, time = cold["rubber_temperature"].values[0], cold.time(0)
    outside = np.diff(time, prepend=time[0])[(layers < -22.0).any(axis=1)].sum()
    assert f"({outside:.3g} s; " in output
    assert "above" not in output
    assert of_the_law(tb.run("shen-hdr-specimen", test, [-20.0, 0.0]).warnings) == []
    blind = tb.run("shen-hdr-specimen", test, -30.0, model="temperature-blind")
    assert of_the_law(blind.warnings) == []
    warm = tb.run("shen-hdr-specimen", test, 34.0)
    warmest = float(warm["rubber_temperature"].max())
    assert (
        f"reaches {warmest:.1f} degC, {warmest - 34.0:.0f} K above" in of_the_law(warm.warnings)[0]
    )


def test_a_table_in_a_file(tmp_path: Path) -> None:
    from thermobearing.border.toml import to_table

    source = Path(tb.__file__).parent / "data/bearings/shen-hdr-specimen.toml"
    table = '[temperature_law]\ntemperatures = ["-20 degC", "313.15 K"]\nelastic = [1.4, 0.9]\n'
    head, tail = source.read_text().split("[temperature_law]")
    rest = tail[tail.index("[cells]") :]
    path = tmp_path / "mine.toml"
    path.write_text(f"{head}{table}hysteretic = [2.0, 0.8]\n{rest}")
    law = tb.load_bearing(path).temperature_law
    assert law is not None
    assert law.range == (-20.0, 40.0)
    assert to_table(tb.load_bearing(path))["temperature_law"]["elastic"] == [1.4, 0.9]


def test_a_fit_states_the_range_of_its_own_tests() -> None:
    """Of two temperatures where n_T was free; that of the template where it was not."""
    from thermobearing.identify.result import _bearing_table

    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    records = [
        tb.synthetic_record(specimen(), ambient, test, noise=0.0) for ambient in (-10.0, 15.0)
    ]
    options: dict[str, Any] = {"starts": 1, "start_from": "bearing"}
    free = tb.identify_bearing(records, specimen(), free=["n_T"], **options)
    law = _bearing_table(free)["temperature_law"]
    assert (law["coldest"]["value"], law["warmest"]["value"]) == ("-10.0 degC", "15.0 degC")
    assert law["warmest"]["source"].startswith("ambient temperatures of the tests")
    held = tb.identify_bearing(records, specimen(), free=["K_r"], **options)
    assert _bearing_table(held)["temperature_law"]["warmest"]["value"] == "34.0 degC"


@pytest.mark.parametrize("compound", ["jra-hdr-g10", "jra-hdr-g8", "jra-hdr-s-g12"])
def test_a_borrowed_law_has_the_range_of_its_source(compound: str) -> None:
    law = load_compound(compound).temperature_law
    assert law is not None
    assert law.range == (-20.0, 34.0)
    runs = [("cold", np.array([0.0, 1.0]), np.full((2, 3), -25.0))]
    source = load_compound(compound).sources[LAW_RANGE]
    (message,) = outside_law(compound, law, runs, source)
    assert "5 K below" in message
    assert "borrowed from shen-hdr" in message
