"""Poor fits end with a status of their own, and their bearing does not load unless accepted."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.inputs import write_test
from thermobearing.cli import app
from thermobearing.commands.common import POOR_FIT
from thermobearing.identify.fit.parameters import M_T, parameter_set, with_values
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.tables import grade

HDR = tb.load_bearing("shen-hdr-specimen")
SHORT = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, closing_strain=None)


@pytest.fixture(scope="module")
def record() -> TestRecord:
    return synthetic_record(HDR, 23.0, SHORT, sampling=20.0)


@pytest.fixture(scope="module")
def poor(record: TestRecord) -> Identification:
    """Only the shape is free, of a bearing that is half as stiff."""
    soft = with_values(HDR, {"hysteresis.layer_stiffness": 12.0})
    return identify_bearing(record, soft, free=["s"], starts=1)


def test_a_poor_fit_says_why(poor: Identification) -> None:
    assert poor.outcome == "poor_fit"
    assert any("R2 = 0." in reason for reason in poor.poor)
    assert "--accept-poor" in poor.sentence
    assert "a poor fit" in "\n".join(poor.warnings)
    assert poor.summary()["poor"] == poor.poor


def test_a_poor_fit_names_what_to_free(poor: Identification) -> None:
    said = "\n".join(poor.warnings)
    assert "free K_r (--free s,K_r)" in said


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
    found = identify_bearing(record, HDR, free=["K_r"], bounds={"K_r": (10.0, 30.0)}, starts=1)
    assert found.fits[0].R2 > 0.98
    assert found.poor == ["K_r = 30 kN/mm at its bound"]


def test_a_parameter_near_its_bound_is_not_determined(record: TestRecord) -> None:
    """Within 5 % of the range: the bound, not the test, may have given it. The truth is 30.7."""
    for upper, outcome in ((31.0, "poor_fit"), (40.0, "completed")):
        found = identify_bearing(record, HDR, free=["K_r"], bounds={"K_r": (10, upper)}, starts=1)
        (item,) = found.uncertainty.estimates.values()
        assert not item.at_bound
        assert found.outcome == outcome
        assert item.determined is (outcome == "completed")
        told = found.summary()["parameters"]["hysteresis.layer_stiffness"]
        assert (grade(told) == "no") is (outcome == "poor_fit")


def test_temperature_coefficients_are_held_at_one_temperature(record: TestRecord) -> None:
    found = identify_bearing(record, HDR, free=["K_r", "m_T", "n_T = 2.4 * m_T"], starts=1)
    assert set(found.uncertainty.estimates) == {"hysteresis.layer_stiffness"}
    assert found.bearing.hysteresis.elastic_temperature_coefficient == -0.914
    assert any("m_T and n_T held" in text for text in found.warnings)
    with pytest.raises(tb.InputError, match="one-temperature"):
        identify_bearing(record, HDR, free=["m_T"], starts=1)
    forced = identify_bearing(record, HDR, free=["m_T"], starts=1, one_temperature=True)
    assert set(forced.uncertainty.estimates) == {M_T}


def test_the_fitted_bearing_is_checked_for_plausibility(record: TestRecord) -> None:
    """The sign of a temperature coefficient of the starting bearing, which the test cannot tell."""
    found = identify_bearing(record, with_values(HDR, {M_T: 1.0}), free=["K_r"], starts=1)
    assert any(M_T in text for text in found.warnings)
    assert found.outcome == "completed"


@pytest.mark.parametrize(("key", "value"), [("b", 0.0), ("alpha_0", 1.0), ("s", -0.98)])
def test_an_end_of_the_law_is_no_failure(key: str, value: float, record: TestRecord) -> None:
    """Rubber without hardening has b = 0; s = -0.98 is where the search was stopped."""
    found = identify_bearing(record, HDR, free=["K_r"], starts=1)
    (item,) = found.uncertainty.estimates.values()
    (parameter,) = parameter_set(HDR, [key], [23.0]).free
    there = replace(item, parameter=parameter, value=value, at_bound=True)
    assert there.lost == (key == "s")


def test_the_command_ends_with_its_status(record: TestRecord, tmp_path: Path) -> None:
    file = write_test(tmp_path, record, "test")
    words = [
        "identify",
        str(file),
        "--bearing",
        "shen-lhdr-specimen",
        "--free",
        "s",
        "--from-start",
        "--no-figures",
    ]
    words += ["-o", str(tmp_path / "out"), "--json", "-q"]
    ended = CliRunner().invoke(app, words)
    assert ended.exit_code == POOR_FIT == 4
    last = json.loads(ended.stdout.splitlines()[-1])
    assert (last["outcome"], last["exit_status"]) == ("poor_fit", 4)
    assert "poor_fit = " in (tmp_path / "out" / "bearing.toml").read_text()
    ended = CliRunner().invoke(app, [*words, "--overwrite", "--accept-poor"])
    assert ended.exit_code == 0
    assert "poor_fit" not in (tmp_path / "out" / "bearing.toml").read_text()
