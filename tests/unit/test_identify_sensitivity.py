"""What is free by default follows from what the tests can tell."""

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.bearing.model import Bearing
from thermobearing.identify.fit.parameters import (
    ALIASES,
    BY_KEY,
    E2,
    HARDENING,
    K_R,
    M_T,
    N_T,
    SIGMA_Y,
    default_free,
    parameter_set,
    with_values,
)
from thermobearing.identify.fit.problem import Problem
from thermobearing.identify.fit.start import (
    BETTER,
    Sensitivity,
    candidates,
    sensitivities,
    without_needless,
)
from thermobearing.identify.fit.synthetic import forgotten, synthetic_record
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty.assumed import usual_groups

HDR, LHDR, LRB = (
    tb.load_bearing(name) for name in ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example")
)
HOT = tb.cyclic_test(strain=[0.25, 1.0, 2.0], cycles=3, wave="sine", speed=200.0, rest=None)
COOL = tb.cyclic_test(strain=[0.1, 0.25], cycles=2, wave="sine", speed=5.0, rest=None)


def records(
    bearing: Bearing, test: object, ambients: tuple[float, ...], sampling: float = 50.0
) -> list[TestRecord]:
    return [
        synthetic_record(bearing, at, test, seed=i, sampling=sampling)  # type: ignore[arg-type]
        for i, at in enumerate(ambients)
    ]


def told(bearing: Bearing, tests: list[TestRecord]) -> dict[str, Sensitivity]:
    """Sensitivities at the bearing's own values."""
    problem = Problem(tests, parameter_set(bearing, [K_R], [23.0]))
    keys = candidates(problem, usual_groups())
    wide = problem.with_parameters(parameter_set(bearing, keys, [23.0]))
    return {s.key: s for s in sensitivities(wide, wide.pset.start, usual_groups())}


def test_candidates_are_what_the_bearing_has() -> None:
    (record,) = records(LRB, COOL, (23.0,))
    problem = Problem([record], parameter_set(LRB, [K_R], [23.0]))
    symbols = {BY_KEY[key].symbol for key in candidates(problem, usual_groups())}
    assert symbols == {"K_r", "m_T", "K_l", "sigma_Y", "E2"}


@pytest.mark.parametrize(("test", "free"), [(HOT, True), (COOL, False)], ids=["hot", "cool"])
def test_softening_is_free_where_the_lead_gets_hot(test: object, free: bool) -> None:
    found = told(LRB, records(LRB, test, (23.0,)))
    assert found[E2].free is free
    assert not found[E2].usual
    assert (found[E2].stderr < BETTER * found[E2].spread) is free
    assert found[SIGMA_Y].free


def test_one_ambient_frees_no_temperature_coefficient() -> None:
    test = tb.cyclic_test(strain=[0.5, 2.0], cycles=2, rest=None)
    one, two = (told(HDR, records(HDR, test, at)) for at in ((23.0,), (-20.0, 23.0)))
    assert not {M_T, N_T} & {key for key, item in one.items() if item.free}
    assert {M_T, N_T} <= {key for key, item in two.items() if item.free}
    # Twice the tests, and the change with temperature, from tests at two temperatures.
    assert two[HARDENING].stderr < one[HARDENING].stderr


def test_what_tests_tell_nothing_of_is_held() -> None:
    """Strains of a twentieth do not harden rubber."""
    test = tb.cyclic_test(strain=[0.05], cycles=2, rest=None, closing_strain=None)
    found = told(HDR, records(HDR, test, (23.0,)))
    assert found[HARDENING].usual
    assert not found[HARDENING].free
    assert found[K_R].free


def test_lrb_from_a_file_of_nobody() -> None:
    """The softening of lead is free before a fit without it ends at a bound (sigma_Y = 2 MPa)."""
    start = with_values(forgotten(LRB), {E2: 0.0})
    found = identify_bearing(records(LRB, HOT, (-10.0, 30.0), 27.0), start, starts=1)
    assert found.values[SIGMA_Y] == pytest.approx(10.0, rel=0.02)
    assert found.values[E2] == pytest.approx(0.0069, rel=0.05)
    assert found.summary()["sensitivity"][E2]["free"]
    assert min(fit.R2 for fit in found.fits) > 0.99


def test_lead_without_softening_keeps_it_fixed() -> None:
    test = tb.cyclic_test(strain=[0.5, 2.5], cycles=2, wave="sine", rest=None)
    tests = records(LHDR, test, (23.0,))
    found = identify_bearing(tests, LHDR, starts=1, blind=False)
    (softening,) = (item for item in found.sensitivity if item.key == E2)
    assert softening.free
    assert not softening.usual
    assert E2 not in found.uncertainty.estimates
    assert set(found.uncertainty.estimates) == set(default_free(LHDR, (23.0,)))


def test_needed_parameters_stay() -> None:
    (record,) = records(LRB, HOT, (23.0,))
    pset = parameter_set(LRB, ["K_r", "E2"], [23.0])
    problem = Problem([record], pset)
    same, cube = without_needless(problem, pset.start, [ALIASES["E2"]])
    assert same is problem
    assert np.array_equal(cube, pset.start)
