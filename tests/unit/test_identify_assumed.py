"""Numbers that a fit assumes, parameters that it frees, and fits that are poor."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.inputs import command, write_test
from thermobearing.bearing.model import Bearing, Scragging
from thermobearing.commands.common import POOR_FIT
from thermobearing.identify.fit import parameters
from thermobearing.identify.fit.problem import Linear, Problem
from thermobearing.identify.fit.start import (
    BETTER,
    Sensitivity,
    _candidates,
    drop_needless,
    sensitivities,
)
from thermobearing.identify.fit.synthetic import generic_start, synthetic_record
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.records.treatment import request_treatment
from thermobearing.identify.report import _grade
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty import covariance, groups
from thermobearing.identify.uncertainty.evidence import Evidence, Propagated, Uncertainty

E2 = parameters.ALIASES["E2"]
HDR, LHDR, LRB = (
    tb.load_bearing(name) for name in ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example")
)


def names(bearing: Bearing, free: list[str]) -> list[str]:
    return [
        group.name
        for group in covariance._assumed_groups(bearing, free, groups.chosen_groups(None))
    ]


def test_groups_are_what_the_bearing_has_and_the_fit_has_not() -> None:
    assert "film coefficient of the sides" in names(HDR, [])
    assert "film coefficient of the sides" not in names(LHDR, [])  # its film is zero
    assert "heat capacity of the lead" not in names(HDR, [])
    assert "sigma_Y" in names(LHDR, [])
    assert "sigma_Y" not in names(LHDR, parameters.default_free(LHDR, [23.0]))
    assert not {"alpha_0", "s", "d_y", "b", "n_T"} & set(names(LRB, []))


def test_every_symbol_is_a_parameter_and_every_group_has_a_source() -> None:
    for group in groups.chosen_groups(None):
        assert group.source
        if group.keys[0] in parameters.KINDS:
            assert group.name == parameters.KINDS[group.keys[0]].symbol
        else:
            assert group.cause


@pytest.mark.parametrize(
    ("name", "key", "sigmas", "value"),
    [
        ("sigma_Y", "lead.yield_stress", 2.0, 12.0 * np.exp(0.3)),
        ("E2", "lead.softening", 1.0, 0.002),
        ("E2", "lead.softening", -1.0, 0.0),
        (
            "heat capacity of the rubber",
            "materials.rubber.specific_heat",
            -1.0,
            1732.0 * np.exp(-0.06),
        ),
        ("m_T", "hysteresis.elastic_temperature_coefficient", 1.0, -1.724),
    ],
)
def test_shifted_numbers(name: str, key: str, sigmas: float, value: float) -> None:
    (group,) = (g for g in groups.chosen_groups(None) if g.name == name)
    part: object = groups.shift(LHDR, group, sigmas)
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
    with pytest.raises(tb.InputError) as reported:
        groups.chosen_groups(given)
    assert all(piece in str(reported.value) for piece in pieces)


def test_exactly_known_is_not_assumed() -> None:
    chosen = groups.chosen_groups({"sigma_Y": 0.0, "materials.rubber.conductivity": 0.02})
    assert "sigma_Y" not in [g.name for g in covariance._assumed_groups(LHDR, [], chosen)]
    (heat,) = (g for g in chosen if g.name == "conduction of heat")
    assert heat.relative == 0.02


@pytest.mark.parametrize(
    ("sigmas", "stderr", "contradicted"),
    [(3.02, 0.1, True), (3.01, 0.1, False), (5.02, 1.0, True), (4.98, 1.0, False)],
)
def test_values_are_contradicted_beyond_both_limits(
    sigmas: float, stderr: float, contradicted: bool
) -> None:
    """Five standard errors of the tests, and three of tests and source: 3 sqrt(1 + 0.1^2)."""
    group = groups.chosen_groups(None)[0]
    assert Evidence(group, -sigmas, stderr, 0.1).contradicted is contradicted


SMALL = tb.cyclic_test(strain=[0.5, 1.5], cycles=2, rest=None)


@pytest.fixture(scope="module")
def pair() -> list[TestRecord]:
    return [synthetic_record(HDR, at, SMALL, noise=0.005, sampling=20.0) for at in (-20.0, 23.0)]


def fitted(records: list[TestRecord]) -> Uncertainty:
    result = identify_bearing(
        records, HDR, free=["K_r", "m_T", "n_T"], starts=1, start_from="bearing"
    )
    return result.uncertainty


def test_the_ambient_temperature_of_a_test_is_uncertain(pair: list[TestRecord]) -> None:
    """n_T comes from the difference of two temperatures, each known to 0.6 K by default."""
    exact = [replace(record, ambient_uncertainty=0.0) for record in pair]
    usual, known = fitted(pair).estimates[parameters.N_T], fitted(exact).estimates[parameters.N_T]
    more = np.sqrt(usual.stderr**2 - known.stderr**2)
    assert more == pytest.approx(0.6 * np.sqrt(2.0) / 43.0 * abs(usual.value), rel=0.1)
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
    assert request_treatment([record], False, "", 0.1)[0].ambient_uncertainty == 0.1
    with pytest.raises(tb.InputError, match="0 to 20 K"):
        request_treatment([record], False, "", 21.0)
    (air,) = (g for g in groups.chosen_groups({"ambient": 0.3}) if g.keys == ["ambient"])
    assert (air.absolute, air.relative) == (0.3, None)


def linear(residuals: np.ndarray, jacobian: np.ndarray) -> Linear:
    n = len(residuals)
    return Linear([residuals], np.ones(n), jacobian, np.arange(n) // 10)


def reported(name: str) -> covariance.Assumed:
    (group,) = (g for g in groups.chosen_groups(None) if g.name == name)
    return covariance.Assumed((group,), np.zeros((0, 1)))


def test_an_unseen_number_carries_its_whole_uncertainty() -> None:
    """Its column is that of a parameter: the parameter takes all of it, by any amount."""
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(400, 2))
    noise = 0.01 * rng.normal(size=400)
    noise -= jacobian @ np.linalg.lstsq(jacobian, noise, rcond=None)[0]
    result = covariance._propagate(
        linear(noise, jacobian),
        covariance.Assumed(reported("sigma_Y").groups, -3.0 * jacobian[:, :1]),
    )
    assert result.shifts == pytest.approx(np.array([[3.0], [0.0]]), abs=1e-12)
    assert result.spread == pytest.approx(np.ones((1, 1)))
    assert result._covariance() == pytest.approx(np.diag([9.0, 0.0]), abs=1e-9)
    assert result.evidence[0].stderr == np.inf


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
    result = covariance._propagate(
        linear(noise - off * apart, jacobian),
        covariance.Assumed(reported("sigma_Y").groups, column),
    )
    (item,) = result.evidence
    assert item.sigmas == pytest.approx(off, abs=1e-9)
    expected = 1.0 / np.linalg.norm(apart)
    assert 0.7 * expected < item.stderr < 1.4 * expected
    assert item.contradicted == (off > 3.1)
    # Posterior of a normal prior: nearly all of what was asked for, and a little spread.
    assert result.spread[0, 0] == pytest.approx(off**2, rel=0.03, abs=0.02)
    assert result.shifts[0, 0] == pytest.approx(-1.0, abs=0.15)


def test_more_heat_cells_are_a_cause_by_what_they_change_themselves() -> None:
    """Five times their change would remove all residuals: no calculation makes it, and they do not.

    The other groups are scaled to what the tests require.
    """
    (cells,) = (group for group in groups.chosen_groups(None) if group.key == groups.CELLS)
    other = cells.model_copy(update={"keys": ["materials.side_film"]})
    column = np.random.default_rng(3).normal(size=(300, 1))
    fit = linear(-5.0 * column[:, 0], np.ones((300, 1)))
    weighed = [covariance._weigh(fit, group, column) for group in (cells, other)]
    assert [item.sigmas for item in weighed] == pytest.approx([5.0, 5.0])
    share = 1.0 - (4.0 / 5.0) ** 2
    assert [item.explained for item in weighed] == pytest.approx([share, 1.0])
    assert Evidence(cells, 5.0, 0.1, 0.15).conceivable
    assert not Evidence(cells, 5.0, 0.1, 0.05).conceivable
    assert not Evidence(cells, -5.0, 0.1, 0.15).conceivable


def test_errors_that_cancel_make_no_interval_smaller() -> None:
    """Of two groups with opposite errors, only one with few degrees of freedom is widened."""
    two = [groups.chosen_groups(None)[0].model_copy(update={"freedom": n}) for n in (3, 10**6)]
    evidence = tuple(Evidence(group, 0.0, 1.0, 0.0) for group in two)
    spread = np.array([[1.0, -0.9], [-0.9, 1.0]])
    shifts = np.array([[0.5, 1.0], [1.0, 0.5]])
    variances = [0.25 + 1.0 - 0.9, 1.624**2 + 0.25 - 1.624 * 0.9]  # the first not widened
    propagated = Propagated(evidence, shifts, spread)
    reach = covariance._half_intervals(propagated, np.diag([0.01, 0.02]), 2.0)
    expected = 1.96 * np.sqrt(np.array(variances) + 4.0 * np.array([0.01, 0.02]))
    assert reach == pytest.approx(expected, rel=1e-3)
    # Draws of both errors, widened, are stretched to the intervals.
    stretching = covariance._stretching(propagated, np.diag([0.01, 0.02]), 2.0)
    widened = [1.624**2 * 0.25 + 1.0 - 1.624 * 0.9, variances[1]]
    drawn = 1.96 * np.sqrt(np.array(widened) + 4.0 * np.array([0.01, 0.02]))
    assert stretching * drawn == pytest.approx(reach, rel=1e-3)
    assert stretching[0] > 1.05
    assert stretching[1] == 1.0


HOT = tb.cyclic_test(strain=[0.25, 1.0, 2.0], cycles=3, wave="sine", speed=200.0, rest=None)
COOL = tb.cyclic_test(strain=[0.1, 0.25], cycles=2, wave="sine", speed=5.0, rest=None)


def records(
    bearing: Bearing, test: object, ambients: tuple[float, ...], sampling: float = 50.0
) -> list[TestRecord]:
    return [
        synthetic_record(bearing, at, test, seed=i, sampling=sampling)  # type: ignore[arg-type]
        for i, at in enumerate(ambients)
    ]


def find_sensitivity(bearing: Bearing, tests: list[TestRecord]) -> dict[str, Sensitivity]:
    problem = Problem(tests, parameters.parameter_set(bearing, [parameters.K_R], [23.0]))
    return {s.key: s for s in sensitivities(problem, {}, groups.chosen_groups(None))}


def test_candidates_are_what_the_bearing_has() -> None:
    (record,) = records(LRB, COOL, (23.0,))
    problem = Problem([record], parameters.parameter_set(LRB, [parameters.K_R], [23.0]))
    symbols = {
        parameters.KINDS[key].symbol for key in _candidates(problem, groups.chosen_groups(None))
    }
    assert symbols == {"K_r", "m_T", "K_l", "sigma_Y", "E2"}


@pytest.mark.parametrize(("test", "free"), [(HOT, True), (COOL, False)], ids=["hot", "cool"])
def test_softening_is_free_where_the_lead_gets_hot(test: object, free: bool) -> None:
    result = find_sensitivity(LRB, records(LRB, test, (23.0,)))
    assert result[E2].free is free
    assert not result[E2].usual
    assert (result[E2].stderr < BETTER * result[E2].spread) is free
    assert result[parameters.SIGMA_Y].free


def test_one_ambient_frees_no_temperature_coefficient() -> None:
    test = tb.cyclic_test(strain=[0.5, 2.0], cycles=2, rest=None)
    one, two = (find_sensitivity(HDR, records(HDR, test, at)) for at in ((23.0,), (-20.0, 23.0)))
    assert not {parameters.M_T, parameters.N_T} & {key for key, item in one.items() if item.free}
    assert {parameters.M_T, parameters.N_T} <= {key for key, item in two.items() if item.free}
    # Twice the tests, and the change with temperature, from tests at two temperatures.
    assert two[parameters.HARDENING].stderr < one[parameters.HARDENING].stderr


def test_what_tests_tell_nothing_of_is_held() -> None:
    test = tb.cyclic_test(strain=[0.05], cycles=2, rest=None, closing_strain=None)
    result = find_sensitivity(HDR, records(HDR, test, (23.0,)))
    assert result[parameters.HARDENING].usual
    assert not result[parameters.HARDENING].free
    assert result[parameters.K_R].free


@pytest.mark.thorough
def test_lrb_from_a_file_of_nobody() -> None:
    """The softening of lead is free before a fit without it ends at a bound (sigma_Y = 2 MPa)."""
    start = parameters.with_values(generic_start(LRB), {E2: 0.0})
    result = identify_bearing(records(LRB, HOT, (-10.0, 30.0), 27.0), start, starts=1)
    assert result.values[parameters.SIGMA_Y] == pytest.approx(10.0, rel=0.02)
    assert result.values[E2] == pytest.approx(0.0069, rel=0.05)
    assert result.summary()["sensitivity"][E2]["free"]
    assert min(fit.R2 for fit in result.fits) > 0.99


@pytest.mark.thorough
def test_lead_without_softening_keeps_it_fixed() -> None:
    test = tb.cyclic_test(strain=[0.5, 2.5], cycles=2, wave="sine", rest=None)
    tests = records(LHDR, test, (23.0,))
    result = identify_bearing(tests, LHDR, starts=1, start_from="bearing")
    (softening,) = (item for item in result.sensitivity if item.key == E2)
    assert softening.free
    assert not softening.usual
    assert E2 not in result.uncertainty.estimates
    assert set(result.uncertainty.estimates) == set(parameters.default_free(LHDR, (23.0,)))


def test_needed_parameters_stay() -> None:
    (record,) = records(LRB, HOT, (23.0,))
    pset = parameters.parameter_set(LRB, ["K_r", "E2"], [23.0])
    problem = Problem([record], pset)
    same, cube = drop_needless(problem, pset.start, [E2])
    assert same is problem
    assert np.array_equal(cube, pset.start)


SHORT = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, closing_strain=None)


@pytest.fixture(scope="module")
def record() -> TestRecord:
    return synthetic_record(HDR, 23.0, SHORT, sampling=20.0)


@pytest.fixture(scope="module")
def poor(record: TestRecord) -> Identification:
    soft = parameters.with_values(HDR, {"hysteresis.layer_stiffness": 12.0})
    return identify_bearing(record, soft, free=["s"], starts=1)


def test_a_poor_fit_says_why(poor: Identification) -> None:
    assert poor.outcome == "poor_fit"
    assert any("R2 = 0." in reason for reason in poor.poor)
    assert "--accept-poor" in poor.sentence
    assert "--free s,K_r" in "\n".join(poor.warnings)
    assert poor.summary()["poor"] == poor.poor


def test_its_bearing_does_not_load(poor: Identification, tmp_path: Path) -> None:
    folder = poor.save(tmp_path / "poor", figures=False)
    with pytest.raises(tb.InputError, match=r"poor_fit: .*R2 = 0"):
        tb.load_bearing(folder / "bearing.toml")
    assert not (folder / "compound.toml").exists()
    accepted = identify_bearing(
        poor.records[0], poor.pset.base, free=["s"], starts=1, accept_poor=True
    )
    assert accepted.outcome == "completed"
    assert "a poor fit" in "\n".join(accepted.warnings)
    folder = accepted.save(tmp_path / "accepted", figures=False)
    assert tb.load_bearing(folder / "bearing.toml").kind == "HDR"


def test_a_parameter_at_its_bound_is_a_poor_fit(record: TestRecord) -> None:
    result = identify_bearing(record, HDR, free=["K_r"], bounds={"K_r": (10.0, 30.0)}, starts=1)
    assert result.fits[0].R2 > 0.98
    assert result.poor == ["K_r = 30 kN/mm at its bound"]


def test_a_parameter_near_its_bound_is_not_determined(record: TestRecord) -> None:
    """Within 5 % of the range: the bound, not the test, may have given it. The truth is 30.7."""
    for upper, outcome in ((31.0, "poor_fit"), (40.0, "completed")):
        result = identify_bearing(record, HDR, free=["K_r"], bounds={"K_r": (10, upper)}, starts=1)
        (item,) = result.uncertainty.estimates.values()
        assert not item.at_bound
        assert result.outcome == outcome
        assert item.determined is (outcome == "completed")
        reported = result.summary()["parameters"]["hysteresis.layer_stiffness"]
        assert (_grade(reported) == "no") is (outcome == "poor_fit")


SCRAGGING = {  # as docs/files/record.md prints it
    "mullins_amplitude": 0.1, "mullins_decay": 2.0, "mullins_renewal": 0.1,
    "amplitude": 0.0, "strain": 0.5,
}  # fmt: skip


@pytest.mark.thorough
def test_optional_parameters_that_tests_leave_open_stay_at_their_start(tmp_path: Path) -> None:
    """Rubber that is not virgin, calibrated with a table of scragging: a poor fit in 0.3.0."""
    bearing = HDR.model_copy(update={"scragging": Scragging(**SCRAGGING)})
    test = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=3, rest=60)
    tests = [
        synthetic_record(HDR, at, test, noise=0.01, sampling=25.0, seed=i)
        for i, at in enumerate((0, 23))
    ]
    identification = identify_bearing(tests, bearing, starts=1)
    assert identification.outcome == "completed"
    assert identification.poor == []
    estimates = identification.uncertainty.estimates
    assert not {"scragging.strain", "scragging.mullins_decay"} & set(estimates)
    fixed = identification.summary()["fixed"]
    assert fixed["scragging.strain"]["value"] == SCRAGGING["strain"]
    assert fixed["scragging.mullins_decay"]["value"] == SCRAGGING["mullins_decay"]
    amplitude = estimates["scragging.amplitude"]
    assert 0.0 == amplitude.lower <= amplitude.value < amplitude.upper < 0.1  # on one side
    assert any("gamma_s" in text and "c_d" in text for text in identification.warnings)
    folder = identification.save(tmp_path / "fit", figures=False)
    assert tb.load_bearing(folder / "bearing.toml").kind == "HDR"


def test_temperature_coefficients_are_held_at_one_temperature(record: TestRecord) -> None:
    result = identify_bearing(record, HDR, free=["K_r", "m_T", "n_T = 2.4 * m_T"], starts=1)
    assert set(result.uncertainty.estimates) == {"hysteresis.layer_stiffness"}
    assert result.bearing.hysteresis.elastic_temperature_coefficient == -0.914
    assert any("m_T and n_T held" in text for text in result.warnings)
    with pytest.raises(tb.InputError, match="one-temperature"):
        identify_bearing(record, HDR, free=["m_T"], starts=1)
    forced = identify_bearing(record, HDR, free=["m_T"], starts=1, one_temperature=True)
    assert set(forced.uncertainty.estimates) == {parameters.M_T}


def test_the_fitted_bearing_is_checked_for_plausibility(record: TestRecord) -> None:
    """The sign of a temperature coefficient of the starting bearing, which the test cannot tell."""
    result = identify_bearing(
        record, parameters.with_values(HDR, {parameters.M_T: 1.0}), free=["K_r"], starts=1
    )
    assert any(parameters.M_T in text for text in result.warnings)
    assert result.outcome == "completed"


@pytest.mark.parametrize(("key", "value"), [("b", 0.0), ("alpha_0", 1.0), ("s", -0.98)])
def test_an_end_of_the_law_is_no_failure(key: str, value: float) -> None:
    """Rubber without hardening has b = 0; s = -0.98 is where the search was stopped."""
    (parameter,) = parameters.parameter_set(HDR, [key], [23.0]).free
    there = covariance._estimate(parameter, parameter.place(value), 0.0, 0.0, 0.0)
    assert there.lost == (key == "s")


def test_the_command_ends_with_its_status(record: TestRecord, tmp_path: Path) -> None:
    file = write_test(tmp_path, record, "test")
    words = [
        "identify",
        file,
        "--bearing",
        "shen-lhdr-specimen",
        "--free",
        "s",
        "--start-from",
        "bearing",
    ]
    words += ["--no-figures", "-o", tmp_path / "out", "--json", "-q"]
    ended = command(*words)
    assert ended.exit_code == POOR_FIT == 4
    last = json.loads(ended.stdout.splitlines()[-1])
    assert (last["outcome"], last["exit_status"]) == ("poor_fit", 4)
    assert "poor_fit = " in (tmp_path / "out" / "bearing.toml").read_text()
    ended = command(*words, "--overwrite", "--accept-poor")
    assert ended.exit_code == 0
    assert "poor_fit" not in (tmp_path / "out" / "bearing.toml").read_text()
