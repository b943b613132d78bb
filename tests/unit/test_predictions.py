"""Predictions of a calibration contain everything that is uncertain."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from thermobearing.bearing.model import Validity
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.parameters import (
    D_Y,
    HARDENING,
    M_T,
    N_T,
    dotted_value,
    parameter_set,
    with_values,
)
from thermobearing.identify.properties import (
    LATER,
    later_cycles,
    later_means,
    predicted_cycles_table,
    prediction_sentence,
)
from thermobearing.identify.records.cycles import (
    compare_loops,
    compute_measures,
    largest_measures,
)
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.report import _contradictions, _enlarged
from thermobearing.identify.uncertainty.bands import OUTSIDE
from thermobearing.identify.uncertainty.covariance import _estimate
from thermobearing.identify.uncertainty.diagnosis import size_words
from thermobearing.identify.uncertainty.evidence import Evidence
from thermobearing.identify.uncertainty.groups import chosen_groups
from thermobearing.identify.uncertainty.posterior import _draw, drawn_bearing, forecast
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.results.ranges import compare_with_tests, extrapolation, widened

HDR = tb.load_bearing("shen-hdr-specimen")
TEST = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=2, rest=None, dt=0.02)
OFF = {M_T: -1.4 * 0.2, N_T: -1.7 * 0.3}  # of the file, 1.4 and 1.7 of the assumed uncertainties
TRUTH = with_values(HDR, {key: (dotted_value(HDR, key) or 0.0) + off for key, off in OFF.items()})


@pytest.fixture(scope="module")
def warm_only() -> tb.Identification:
    """Tests at 23 degC only, of rubber whose m_T and n_T are not those of the file."""
    record = tb.synthetic_record(TRUTH, 23.0, TEST, noise=0.01)
    identification = tb.identify_bearing(record, HDR, starts=1)
    assert {M_T, N_T}.isdisjoint(identification.uncertainty.estimates)
    return identification.with_forecast(forecast(identification, [-20.0, 23.0]))


def test_draws_are_stretched_to_the_intervals(warm_only: tb.Identification) -> None:
    """Each parameter of its own; the numbers that are held are drawn as before."""
    uncertainty = warm_only.uncertainty
    plain, held = _draw(warm_only, 20, 0)
    stretching = uncertainty.stretching * np.arange(1.0, len(warm_only.cube) + 1.0)
    wide = replace(warm_only, uncertainty=replace(uncertainty, stretching=stretching))
    stretched, same = _draw(wide, 20, 0)
    assert same == pytest.approx(held)
    ratios = (stretched - warm_only.cube) / (plain - warm_only.cube)
    expected = np.arange(1.0, len(warm_only.cube) + 1.0)
    assert ratios == pytest.approx(np.broadcast_to(expected, ratios.shape))


def test_the_band_in_the_cold_contains_what_is_held(warm_only: tb.Identification) -> None:
    cold = tb.synthetic_record(TRUTH, -20.0, TEST, noise=0.0)
    cycles = later_cycles(warm_only)
    means = later_means(replace(warm_only, records=[cold]), cold.force, cycles)
    assert means.keys() == LATER.keys()
    truth = largest_measures(cold, cold.force) | {f"mean {k}": value for k, value in means.items()}
    assert warm_only.forecast is not None
    band, warm = warm_only.forecast.bands
    for item in band.predicted:
        assert item.lower < truth[item.quantity] < item.upper, item.quantity
        assert item.held_share > 0.9
        assert sum(item.shares.values()) == pytest.approx(1.0, abs=0.01)
        assert max(item.shares, key=lambda name: item.shares[name]) in ("n_T", "m_T")
    at_23 = {item.quantity: item for item in warm.predicted}
    assert at_23["K_eq"].upper / at_23["K_eq"].lower < 1.06  # which the test measured
    # Both are means over the same cycles, so that they can be divided.
    in_test = {item.quantity: item.model for item in warm_only.properties}
    for name in LATER:
        assert at_23[f"mean {name}"].best == pytest.approx(in_test[name], rel=1e-6)


def test_each_cycle_of_a_test_is_predicted(warm_only: tb.Identification, tmp_path: Path) -> None:
    """The cycles of the file of the truth lie in the intervals; the table has those of codes."""
    cold = tb.synthetic_record(TRUTH, -20.0, TEST, noise=0.0)
    truth = {loop.cycle: loop.model_measures for loop in compare_loops(cold, cold.force)[0]}
    rows = pd.read_csv(warm_only.save(tmp_path / "fit", figures=False) / "predicted.csv")
    rows = rows[rows["ambient_degC"] == -20.0]
    assert list(dict.fromkeys(rows["cycle"])) == list(truth)
    assert len(rows) == sum(map(len, truth.values()))
    for row in rows.itertuples():
        assert row.lower < truth[row.cycle][row.quantity] < row.upper, (row.cycle, row.quantity)
    assert warm_only.forecast is not None
    table = predicted_cycles_table(warm_only.forecast.summary())
    assert [column.title for column in table.columns][3:5] == ["Peak force [kN]", "K_eq [kN/mm]"]
    # No amplitude has a third cycle: the second one, its last, stands for it.
    levels = [(strain, number) for strain in ("50", "100", "175") for number in ("1", "2")]
    assert [tuple(cells[1:3]) for cells in table.texts()[:6]] == levels
    assert {row for row, _ in table.marked} == set(range(6))  # none of those at 23 degC


def test_the_table_has_the_first_and_the_third_cycle() -> None:
    row = {"ambient_degC": 0.0, "strain": 1.0, "quantity": "K_eq", "unit": "kN/mm"}
    row |= {"best": 5.0, "lower": 4.9, "upper": 5.1, "beyond_tested": ""}
    numbers = [1, 2, 3, 4, 1, 1, 2]
    rows = [row | {"cycle": k, "number": number} for k, number in enumerate(numbers)]
    table = predicted_cycles_table({"predicted_cycles": rows})
    assert [cells[2] for cells in table.texts()] == ["1", "3", "1", "1", "2"]
    assert {cells[3] for cells in table.texts()} == {"5.000 (4.900 to 5.100)"}


def test_samples_hold_every_number_that_is_held(
    warm_only: tb.Identification, tmp_path: Path
) -> None:
    folder = warm_only.save(tmp_path / "fit", figures=False)
    head = (folder / "posterior.csv").read_text().splitlines()[0].split(",")
    assert {"m_T", "n_T", "geometry.rubber_thickness", "materials.side_film"} < set(head)
    assert warm_only.forecast is not None
    samples = warm_only.forecast.samples
    assert len(samples.cube) == 400
    best, *others = posterior_bearings(folder / "bearing.toml", folder / "posterior.csv", 400)
    drawn = drawn_bearing(warm_only, samples.cube[7], samples.held[7])
    for key in (M_T, N_T, "materials.rubber.conductivity", "geometry.rubber_thickness"):
        spread = np.std([dotted_value(bearing, key) for bearing in others])
        assert spread > 0.005 * abs(dotted_value(best, key) or 0.0), key
        assert dotted_value(others[7], key) == pytest.approx(dotted_value(drawn, key), rel=1e-5)


def test_factors_of_the_samples_contain_the_truth(
    warm_only: tb.Identification, tmp_path: Path
) -> None:
    """The factor of K_eq at -20 degC, whose band of 90 % was 1.91 to 1.93 without m_T and n_T."""
    folder = warm_only.save(tmp_path / "fit", figures=False)
    bearings = posterior_bearings(folder / "bearing.toml", folder / "posterior.csv", 20)
    options = {"reference_temperature": 23.0, "temperatures": [-20.0], "strains": [1.75]}
    rows, truth = (
        table.query("basis == 'first' and quantity == 'K_eq' and ambient_degC == -20").iloc[0]
        for table in (
            tb.temperature_factors(bearings, cycles=[1], **options),
            tb.temperature_factors(TRUTH, cycles=[1], **options),
        )
    )
    assert rows["factor_low"] < truth["factor"] < rows["factor_high"]


def test_a_bearing_of_another_size_takes_what_is_held(
    warm_only: tb.Identification, tmp_path: Path
) -> None:
    """Thermal numbers by their ratio; the thickness by its effect on the modulus."""
    folder = warm_only.save(tmp_path / "fit", figures=False)
    sizes = {"plan": "480x480mm", "layers": "6x17mm", "shim": "6.4mm"}
    large = tb.new_bearing("large", folder / "bearing.toml", **sizes)
    small = posterior_bearings(folder / "bearing.toml", folder / "posterior.csv", 5)
    others = posterior_bearings(large, folder / "posterior.csv", 5)
    cells = [
        (b.geometry, b.materials)
        for b in posterior_bearings(large, folder / "posterior.csv", 5, heat=False)
    ]
    assert cells == [(large.geometry, large.materials)] * 6
    for specimen, other in zip(small[1:], others[1:], strict=True):
        assert other.geometry == large.geometry
        for key in ("rubber.conductivity", "steel.specific_heat", "side_film"):
            values = [dotted_value(b, f"materials.{key}") for b in (specimen, other)]
            assert values[0] == pytest.approx(values[1], rel=1e-9)
        moduli = [
            b.hysteresis.layer_stiffness * b.geometry.rubber_thickness / b.area
            for b in (specimen, other)
        ]
        assert moduli[0] == pytest.approx(moduli[1])


def soaked(offset: float) -> list[TestRecord]:
    """Tests at -20 and 23 degC; the specimen of the first is warmer than its chamber."""
    rng, records = np.random.default_rng(0), []
    for ambient, warmer in ((-20.0, offset), (23.0, 0.0)):
        record = tb.synthetic_record(HDR, ambient, TEST, noise=0.0)
        begun = replace(record, start_offset=warmer)
        run = ForwardModel(begun, HDR, fine=True).run(HDR)
        assert run is not None
        noise = 0.005 * record.peak_force * rng.normal(size=len(run.force))
        records.append(replace(record, force=run.force + noise))
    return records


@pytest.fixture(scope="module")
def two_temperatures() -> tb.Identification:
    """Tests at -20 and 23 degC of a specimen that is as warm as its chamber."""
    return tb.identify_bearing(soaked(0.0), HDR, starts=1)


def keys_of_suspects(identification: tb.Identification) -> list[str]:
    return [item["key"] for item in identification.summary()["suspects"]]


def test_a_specimen_that_was_not_soaked_is_the_first_suspect(
    two_temperatures: tb.Identification,
) -> None:
    """In 0.3.0: "the tests require a larger scale of the force than assumed, by 201 times"."""
    identification = tb.identify_bearing(soaked(20.0), HDR, starts=1)
    first = identification.summary()["suspects"][0]
    assert (first["key"], first["unit"]) == ("conditioning", "K")
    cold = next(
        item
        for item in identification.summary()["suspects"]
        if item["key"] == "conditioning" and item["ambient_degC"] == -20.0
    )
    assert 15.0 < cold["size"] < 45.0  # linear in 20 K
    assert keys_of_suspects(identification).index("force") > keys_of_suspects(identification).index(
        "ambient"
    )
    assert "load cell" not in " ".join(identification.warnings)
    assert keys_of_suspects(two_temperatures) == []


def test_a_coefficient_of_one_temperature_is_a_suspect(warm_only: tb.Identification) -> None:
    """n_T is -2.70 in truth and -2.19 in the file; self-heating shows it."""
    first = warm_only.summary()["suspects"][0]
    assert first["key"] == N_T
    assert -0.9 < first["size"] < -0.4
    assert "load cell" not in " ".join(warm_only.warnings)


def test_a_suspect_is_conceivable() -> None:
    (film,) = (g for g in chosen_groups(None) if g.keys == ["materials.side_film"])
    assert Evidence(film, 5.0, 0.1, 0.5).conceivable  # exp(5 * 0.4) = 7.4
    assert not Evidence(film, 6.0, 0.1, 0.5).conceivable
    assert Evidence(film, -1.0, 0.1, 0.5).size == (pytest.approx(-32.97, abs=0.01), "%")


@pytest.fixture(scope="module")
def at_bound() -> tb.Identification:
    """A test at 25 % strain, whose noise moves b to 0; in truth it is 0.272."""
    test = tb.cyclic_test(strain=[0.25], cycles=3, rest=None)
    record = tb.synthetic_record(HDR, 23.0, test, noise=0.02, seed=20)
    free = ["alpha_0", "K_r", "s", "d_y", "b"]
    return tb.identify_bearing(record, HDR, starts=2, free=free)


def test_a_parameter_at_its_bound_has_an_interval_on_one_side(at_bound: tb.Identification) -> None:
    """In 0.3.0 the interval of b was 0 to 0, and that of d_y narrower by a third."""
    b = at_bound.uncertainty.estimates[HARDENING]
    assert b.at_bound
    assert not b.determined
    assert b.lower == pytest.approx(0.0, abs=1e-9)
    assert b.lower < (dotted_value(HDR, HARDENING) or 0.0) < b.upper
    for key, item in at_bound.uncertainty.estimates.items():
        assert item.lower < (dotted_value(HDR, key) or 0.0) < item.upper, key
    assert at_bound.uncertainty.estimates[D_Y].stderr > 0.04  # 0.041 without b


def test_a_prediction_at_another_strain_contains_the_bound(at_bound: tb.Identification) -> None:
    """K_eq at 175 %, of a fit whose hardening is open above 0."""
    test = tb.cyclic_test(strain=[1.75], cycles=2, rest=None)
    large = tb.synthetic_record(HDR, 23.0, test, noise=0.0)
    model, values = ForwardModel(large, at_bound.bearing), []
    samples = forecast(at_bound).samples
    for cube, held in zip(samples.cube[::4], samples.held[::4], strict=True):
        bearing = drawn_bearing(at_bound, cube, held)
        run = model.rebuilt(bearing).run(bearing)
        assert run is not None
        values.append(largest_measures(large, run.force)["K_eq"])
    low, high = np.quantile(values, [0.025, 0.975])
    assert low < largest_measures(large, large.force)["K_eq"] < high


def test_an_interval_of_half_the_range_is_not_determined() -> None:
    (parameter,) = parameter_set(HDR, ["b"], [23.0]).free
    for reach, determined in ((0.24, True), (0.26, False)):
        item = _estimate(parameter, 0.4, 0.01, 0.1, reach)
        assert item.determined is determined
        assert not item.lost


TESTED = {"ambient": (-20.0, 23.0), "strain": (0.5, 2.0), "strain_rate": (0.1, 1.0)}


@pytest.mark.parametrize(
    ("reached", "expected"),
    [
        ({"ambient": -20.0, "strain": 2.0, "strain_rate": 1.0}, 0.0),
        ({"ambient": -40.0}, 0.003 * 20.0),
        ({"ambient": 33.0}, 0.003 * 10.0),
        ({"strain": 2.5}, 0.1 * 0.5),
        ({"strain_rate": 8.0}, 0.05 * np.log(8.0)),
        ({"ambient": -40.0, "strain": 2.5}, np.hypot(0.06, 0.05)),
    ],
)
def test_extrapolation_by_hand(reached: dict[str, float], expected: float) -> None:
    rows = compare_with_tests("run", reached, TESTED)
    assert extrapolation(rows) == pytest.approx(expected)
    only = 0.003 * max(-20.0 - reached.get("ambient", 0.0), reached.get("ambient", 0.0) - 23.0, 0.0)
    assert extrapolation(rows, only=("ambient",)) == pytest.approx(only)


def test_tests_at_one_temperature_have_their_coefficients_drawn() -> None:
    rows = compare_with_tests("run", {"ambient": -40.0}, {"ambient": (23.0, 23.0)})
    assert rows[0]["outside"]
    assert extrapolation(rows) == 0.0


def test_a_band_with_another_error() -> None:
    low, high = widened(9.0, 12.0, 10.0, 0.1, 0.975)
    assert (10.0 - low, high - 10.0) == pytest.approx(np.hypot([1.0, 2.0], 1.959964), rel=1e-6)
    # A middle below the band, as the first of bearings that are no samples.
    assert widened(11.0, 12.0, 10.0, 0.1, 0.975)[0] == pytest.approx(11.0 - 1.959964)
    assert widened(11.0, 12.0, 10.0, 0.0, 0.975) == (11.0, 12.0)


@pytest.mark.thorough
def test_bands_outside_the_tests_are_wider(two_temperatures: tb.Identification) -> None:
    ahead = forecast(two_temperatures, [-20.0, -40.0], narrow=False)
    inside, outside = ahead.bands
    assert (inside.beyond_tested, outside.beyond_tested) == ("", "ambient")
    for near, far in zip(inside.predicted, outside.predicted, strict=True):
        assert OUTSIDE not in near.shares
        assert far.shares[OUTSIDE] > 0.3
        assert sum(far.shares.values()) == pytest.approx(1.0, abs=0.01)
        half = 0.5 * (far.upper - far.lower) / far.best
        assert half > 1.96 * 0.003 * 20.0 > 0.5 * (near.upper - near.lower) / near.best
    rows = ahead.summary()["predicted"]
    beyond = {row["ambient_degC"]: row["beyond_tested"] for row in rows}
    assert beyond == {-20.0: "", -40.0: "ambient"}


def test_factors_outside_the_tests_have_wider_bands() -> None:
    """By 20 K times 0.3 % on either side of the factor, of samples that differ by nothing else."""
    ranges = Validity(ambient=[-20.0, 23.0], strain=[0.5, 2.0])
    bearing = HDR.model_copy(update={"tested_range": ranges})
    table = tb.temperature_factors(
        [bearing, bearing], reference_temperature=23.0, temperatures=[-40.0, -20.0], strains=[1.0]
    )
    for ambient, more in ((-40.0, 1.644854 * 0.06), (-20.0, 0.0)):
        rows = table[table["ambient_degC"] == ambient]
        half = 0.5 * (rows["factor_high"] - rows["factor_low"]) / rows["factor"]
        assert half.to_numpy() == pytest.approx(np.full(len(rows), more), abs=1e-6)


def test_coefficients_that_are_held_are_reported(
    warm_only: tb.Identification, two_temperatures: tb.Identification
) -> None:
    (text,) = (text for text in warm_only.warnings if "m_T = " in text and "held" in text)
    assert all(word in text for word in ("-0.914", "0.2", "-2.189", "0.3", "23 degC"))
    assert not any("held" in text for text in two_temperatures.warnings)
    lead = tb.load_bearing("lrb-example")  # linear rubber: one coefficient
    test = tb.cyclic_test(strain=[1.0], cycles=2, wave="sine", rest=None)
    (record,) = (tb.synthetic_record(lead, 10.0, test, sampling=20.0),)
    (text,) = (t for t in tb.identify_bearing(record, lead, starts=1).warnings if "held" in t)
    assert "n_T" not in text


def test_a_planned_test_narrows(warm_only: tb.Identification) -> None:
    assert warm_only.forecast is not None
    wide = warm_only.forecast.bands[0].main.half_width
    (planned,) = warm_only.forecast.narrowing  # ambient temperatures do not matter yet
    assert "-20 degC" in planned.what
    assert wide > 0.15
    assert planned.half_width < 0.2 * wide


@pytest.mark.thorough
def test_a_planned_test_narrows_as_the_test_itself_does(warm_only: tb.Identification) -> None:
    """Half widths of K_eq at -20 degC: with the test that is planned, and with it made."""
    assert warm_only.forecast is not None
    (planned,) = warm_only.forecast.narrowing
    cold = tb.synthetic_record(TRUTH, -20.0, TEST, noise=0.01, seed=3)
    identification = tb.identify_bearing([*warm_only.records, cold], HDR, starts=1)
    band = forecast(identification, [-20.0])
    assert planned.half_width == pytest.approx(band.bands[0].main.half_width, rel=0.3)
    (chamber,) = band.narrowing
    records = [replace(record, ambient_uncertainty=0.2) for record in identification.records]
    exact = forecast(tb.identify_bearing(records, HDR, starts=1), [-20.0], narrow=False)
    assert exact.narrowing == ()
    assert chamber.half_width == pytest.approx(exact.bands[0].main.half_width, rel=0.3)
    assert chamber.half_width < 0.7 * band.bands[0].main.half_width
    row = band.summary()["narrowing"][0]
    assert row == {"what": chamber.what, "half_width": chamber.half_width}


def test_a_prediction_at_a_temperature_of_the_tests_is_the_cycle_of_the_model_there() -> None:
    """Bounds of cycles are the same in predictions, in cycles.csv and in the table of properties.

    The rests have the jitter of an instrument, and the record ends 1 % of the peak from zero.
    """
    test = tb.cyclic_test(strain=[0.5, 1.75], cycles=2, rest=60, dt=0.02)
    records = []
    for ambient in (23.0, -20.0):
        record = tb.synthetic_record(HDR, ambient, test, noise=0.01)
        moving = np.flatnonzero(np.abs(record.displacement) > 0.02 * record.peak_displacement)
        # In the middle of a leg towards zero, as a logger that is switched off early.
        end = slice(0, int(moving[-1]) + 2)
        shorter = {
            name: getattr(record, name)[end] for name in ("time", "displacement", "force", "block")
        }
        x = shorter["displacement"]
        assert -0.015 < x[-1] / record.peak_displacement < -0.005
        x += np.random.default_rng(7).normal(0.0, 0.001 * np.abs(x).max(), len(x))
        records.append(replace(record, **shorter))
    # The same displacement at both temperatures: the prediction is of the loading of the first.
    records[1] = replace(records[1], displacement=records[0].displacement)
    identification = tb.identify_bearing(records, HDR, starts=1)
    bands = forecast(identification, [23.0, -20.0], narrow=False).bands
    for band, comparison in zip(bands, identification.fits, strict=True):
        loops = comparison.loops
        first = max(loops, key=lambda loop: (loop.number == 1, loop.amplitude))
        assert comparison.largest is first
        predicted = {item.quantity: item.best for item in band.predicted}
        cycle = {"K_eq": first.model["K_eq"], "energy": first.model["energy"]}
        cycle |= {"Q_d": first.strengths[1]}
        assert {name: predicted[name] for name in cycle} == pytest.approx(cycle, rel=1e-9)
        of_properties = compute_measures(comparison.record, comparison.record.force, 1.0, 1.0)
        measured = of_properties[first.cycle - 1]
        assert first.strengths[0] == pytest.approx(measured.characteristic_strength_kN, rel=1e-12)


def test_the_sentence_marks_what_is_outside_the_tests() -> None:
    row = {"quantity": "h_eq", "cycles": "first of the largest", "unit": "", "ambient_degC": -30.0}
    row |= {"best": 0.2, "lower": 0.19, "upper": 0.21}
    inside, outside = (
        prediction_sentence({"predicted": [row | {"beyond_tested": text}]})
        for text in ("", "ambient")
    )
    assert "h_eq 0.2 (0.19 to 0.21)" in inside
    assert ("extrapolated" in inside, "extrapolated" in outside) == (False, True)


def test_the_report_names_what_is_contradicted_and_what_a_cause_imitates() -> None:
    film, scale = (
        {"name": name, "contradicted": not imitated, "imitated": imitated}
        | {"tests_ask_for": -43.4, "unit_of_that": "%", "tests_ask_for_sigmas": -189.6}
        for name, imitated in (("film", True), ("scale", False))
    )
    assert _contradictions([], []) == []
    (sentence,) = _contradictions([scale], [])
    assert "film" not in sentence
    assert "\N{MINUS SIGN}43 % (190 usual errors)" in sentence
    assert "number and thickness" not in sentence
    causes = [{"name": name, "named": name != "zero"} for name in ("zero", "film", "scale")]
    first, second = _contradictions([film, scale], causes)
    assert ("scale" in first, "film" in second) == (True, True)
    assert "number 2 of 2" in first
    assert "number and thickness" in first
    assert "scale" not in second


def test_the_note_states_by_how_much_a_misfit_enlarges_errors() -> None:
    rows = [{"name": name, "enlarged_by": by} for name, by in (("film", 7.04), ("scale", 1.2))]
    rows.append({"name": "ambient temperature of 22.7 degC", "enlarged_by": 2.0})
    note = _enlarged(rows)
    assert "film by 7 and ambient temperature by 2" in note
    assert "scale" not in note
    assert _enlarged(rows[1:2]) == ""


def test_causes_of_an_implausible_size_come_last() -> None:
    """Three usual errors of an assumed value, ten of a mistake; sizes have no exponent."""
    first, *_ = chosen_groups(None)
    sizes = {False: (2.9, 3.1), True: (9.0, 11.0)}
    plausible = [
        Evidence(first.model_copy(update={"mistake": mistake}), -sigmas, 0.1, 0.5).plausible
        for mistake, both in sizes.items()
        for sigmas in both
    ]
    assert plausible == [True, False, True, False]
    assert size_words(485.2, "%") == "+490 %"
    assert size_words(-0.0123, "K") == "\N{MINUS SIGN}0.012 K"
