"""What a fit assumes: its uncertainty is carried on, and the tests may contradict it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.bearing.model import Bearing
from thermobearing.identify.fit.parameters import BY_KEY, N_T, default_free
from thermobearing.identify.fit.problem import Linear
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.records.treatment import to_be_treated
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty.assumed import (
    Assumed,
    _assumed_groups,
    chosen_groups,
    propagate,
    shifted,
    usual_groups,
)
from thermobearing.identify.uncertainty.covariance import Uncertainty

HDR, LHDR, LRB = (
    tb.load_bearing(name) for name in ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example")
)


def names(bearing: Bearing, free: list[str]) -> list[str]:
    return [group.name for group in _assumed_groups(bearing, free, usual_groups())]


def test_groups_are_what_the_bearing_has_and_the_fit_has_not() -> None:
    assert "film coefficient of the sides" in names(HDR, [])
    assert "film coefficient of the sides" not in names(LHDR, [])  # its film is zero
    assert "heat capacity of the lead" not in names(HDR, [])
    assert "sigma_Y" in names(LHDR, [])
    assert "sigma_Y" not in names(LHDR, default_free(LHDR, [23.0]))
    assert not {"alpha_0", "s", "d_y", "b", "n_T"} & set(names(LRB, []))


def test_every_symbol_is_a_parameter_and_every_group_has_a_source() -> None:
    for group in usual_groups():
        assert group.source
        if group.keys[0] in BY_KEY:
            assert group.name == BY_KEY[group.keys[0]].symbol
        else:
            assert group.cause


@pytest.mark.parametrize(
    ("name", "key", "sigmas", "value"),
    [
        ("sigma_Y", "lead.yield_stress", 2.0, 12.0 * 1.3),
        ("E2", "lead.softening", 1.0, 0.002),
        ("heat capacity of the rubber", "materials.rubber.specific_heat", -1.0, 1732.0 * 0.94),
        ("m_T", "hysteresis.elastic_temperature_coefficient", 1.0, -1.724),
    ],
)
def test_shifted_numbers(name: str, key: str, sigmas: float, value: float) -> None:
    (group,) = (g for g in usual_groups() if g.name == name)
    part: object = shifted(LHDR, group, sigmas)
    for word in key.split("."):
        part = getattr(part, word)
    assert part == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(
    ("given", "pieces"),
    [
        ({"materials.side_flim": 0.1}, ["side_flim", "materials.side_film"]),
        ({"sigma_Y": 3.0}, ["sigma_Y = 3.0", "0 to 2"]),
        ({"sigma_Y": -0.1}, ["sigma_Y = -0.1", "0 to 2"]),
        ({"sigma_Y": "much"}, ["sigma_Y = 'much'"]),
        ({"sigma_Y": float("nan")}, ["sigma_Y = nan"]),
    ],
)
def test_uncertainties_that_cannot_be(given: dict[str, float], pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as told:
        chosen_groups(given)
    assert all(piece in str(told.value) for piece in pieces)


def test_exactly_known_is_not_assumed() -> None:
    groups = chosen_groups({"sigma_Y": 0.0, "materials.rubber.conductivity": 0.02})
    assert "sigma_Y" not in [g.name for g in _assumed_groups(LHDR, [], groups)]
    (heat,) = (g for g in groups if g.name == "conduction of heat")
    assert heat.relative == 0.02


SMALL = tb.cyclic_test(strain=[0.5, 1.5], cycles=2, rest=None)


@pytest.fixture(scope="module")
def pair() -> list[TestRecord]:
    return [synthetic_record(HDR, at, SMALL, noise=0.005, sampling=20.0) for at in (-20.0, 23.0)]


def fitted(records: list[TestRecord]) -> Uncertainty:
    found = identify_bearing(records, HDR, free=["K_r", "m_T", "n_T"], starts=1, blind=False)
    return found.uncertainty


def test_the_ambient_temperature_of_a_test_is_uncertain(pair: list[TestRecord]) -> None:
    """n_T comes from the difference of two temperatures, each known to 0.5 K by default."""
    exact = [replace(record, ambient_uncertainty=0.0) for record in pair]
    usual, known = fitted(pair).estimates[N_T], fitted(exact).estimates[N_T]
    more = np.sqrt(usual.stderr**2 - known.stderr**2)
    assert more == pytest.approx(0.5 * np.sqrt(2.0) / 43.0 * abs(usual.value), rel=0.1)
    # Three degrees of freedom: that part of the interval has Student's 3.18 in place of 1.96.
    assert usual.upper - usual.value > 2.8 * usual.stderr
    assert known.upper - known.value < 2.5 * known.stderr


def test_a_zero_of_the_force_is_fitted(pair: list[TestRecord]) -> None:
    """A load cell that is off by 1 % moves no parameter, and widens no standard error."""
    off = [replace(record, force=record.force + 0.01 * record.peak_force) for record in pair]
    right, wrong = fitted(pair).estimates, fitted(off).estimates
    for key, item in right.items():
        assert abs(wrong[key].value - item.value) < 0.1 * item.stderr_of_tests
        assert wrong[key].stderr_of_tests == pytest.approx(item.stderr_of_tests, rel=0.1)


def test_the_uncertainty_of_ambient_temperatures_is_read(tmp_path: Path) -> None:
    file = tmp_path / "cold.csv"
    file.write_text("time_s,displacement_mm,force_kN\n0,0,0\n1,5,9\n2,0,-1\n")
    assert load_test(file).ambient_uncertainty is None
    file.with_suffix(".toml").write_text('ambient = "-20 degC"\nambient_uncertainty = "0.2 K"')
    record = load_test(file)
    assert record.ambient_uncertainty == 0.2
    assert to_be_treated([record], False, "", 0.1)[0].ambient_uncertainty == 0.1
    with pytest.raises(tb.InputError, match="0 to 20 K"):
        to_be_treated([record], False, "", 21.0)
    (air,) = (g for g in chosen_groups({"ambient": 0.3}) if g.keys == ["ambient"])
    assert (air.absolute, air.relative) == (0.3, None)


def linear(residuals: np.ndarray, jacobian: np.ndarray) -> Linear:
    n, p = jacobian.shape
    inside = np.ones(p, dtype=bool)
    return Linear(inside, [residuals], np.ones(n), jacobian, np.arange(n) // 10)


def told(name: str) -> Assumed:
    (group,) = (g for g in usual_groups() if g.name == name)
    return Assumed((group,), np.zeros((0, 1)))


def test_an_unseen_number_carries_its_whole_uncertainty() -> None:
    """Its column is that of a parameter: the parameter takes all of it, by any amount."""
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(400, 2))
    noise = 0.01 * rng.normal(size=400)
    noise -= jacobian @ np.linalg.lstsq(jacobian, noise, rcond=None)[0]
    found = propagate(
        linear(noise, jacobian), Assumed(told("sigma_Y").groups, -3.0 * jacobian[:, :1])
    )
    assert found.shifts == pytest.approx(np.array([[3.0], [0.0]]), abs=1e-12)
    assert found.spread == pytest.approx(np.ones((1, 1)))
    assert found.covariance() == pytest.approx(np.diag([9.0, 0.0]), abs=1e-9)
    assert found.evidence[0].stderr == np.inf


@pytest.mark.parametrize("off", [0.0, 0.5, 8.0])
def test_what_the_tests_ask_for(off: float) -> None:
    """A number that is off by so many of its uncertainties, seen through noise."""
    rng = np.random.default_rng(2)
    jacobian = rng.normal(size=(400, 2))
    column = rng.normal(size=(400, 1)) + jacobian[:, :1]
    apart = column[:, 0] - jacobian @ np.linalg.lstsq(jacobian, column[:, 0], rcond=None)[0]
    noise = rng.normal(size=400)
    basis = np.column_stack([jacobian, apart])
    noise -= basis @ np.linalg.lstsq(basis, noise, rcond=None)[0]
    found = propagate(
        linear(noise - off * apart, jacobian), Assumed(told("sigma_Y").groups, column)
    )
    (item,) = found.evidence
    assert item.sigmas == pytest.approx(off, abs=1e-9)
    expected = 1.0 / np.linalg.norm(apart)
    assert 0.7 * expected < item.stderr < 1.4 * expected
    assert item.contradicted == (off > 3.1)
    # Posterior of a normal prior: nearly all of what was asked for, and a little spread.
    assert found.spread[0, 0] == pytest.approx(off**2, rel=0.03, abs=0.02)
    assert found.shifts[0, 0] == pytest.approx(-1.0, abs=0.15)
