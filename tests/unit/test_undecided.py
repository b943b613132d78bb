"""What tests do not decide: the factor on the rate branch, the other law of small loops, bands."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.bearing.scaling import acting_rate, build_bearing, extract_compound
from thermobearing.bearing.undecided import (
    RATE,
    SMALL_LOOPS,
    UNDECIDED_OF,
    alternatives,
    band,
    band_text,
    rate_alternatives,
)
from thermobearing.cli import app
from thermobearing.design.run import run_factors
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.model.options import build_model
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan

HDR, LHDR = tb.load_bearing("shen-hdr-bridge"), tb.load_bearing("shen-lhdr-bridge")
SHORT: dict[str, Any] = {"duration": 3.0, "dt": 0.01}


def with_factor(bearing: tb.Bearing, factor: float) -> tb.Bearing:
    assert bearing.rate_band is not None
    rate_band = bearing.rate_band.model_copy(update={"factor": factor})
    return bearing.model_copy(update={"rate_band": rate_band})


def test_the_branch_that_acts() -> None:
    """Its own one as it is; a borrowed one by the rules of scaling, and only with a factor."""
    assert LHDR.rate is not None
    assert acting_rate(LHDR) is LHDR.rate
    assert acting_rate(HDR) is None
    assert acting_rate(tb.load_bearing("lrb-example")) is None
    for factor in (0.5, 1.0):
        half = acting_rate(with_factor(LHDR, factor))
        assert half is not None
        assert (half.stiffness, half.damping) == (factor * 0.5, factor * 0.21)
        borrowed = acting_rate(with_factor(HDR, factor))
        assert borrowed is not None
        area, rubber = 480.0**2, 102.0
        assert_allclose(borrowed.stiffness, factor * 0.229166e-3 * area / rubber, rtol=1e-12)
        assert_allclose(borrowed.damping, factor * 0.0962498e-3 * area / rubber, rtol=1e-12)


def test_the_factor_in_the_constants_of_the_step() -> None:
    viscous = build_model(with_factor(LHDR, 0.5)).constants.viscous
    plain = build_model(LHDR).constants.viscous
    assert viscous.stiffness == 0.5 * plain.stiffness
    assert_allclose(viscous.relaxation, plain.relaxation, rtol=tol.ROUNDING)
    assert build_model(HDR).constants.viscous.stiffness == 0.0
    assert build_model(with_factor(LHDR, 0.0)).constants.viscous.stiffness == 0.0
    assert build_model(with_factor(HDR, 1e-9)).constants.viscous.stiffness > 0.0


@pytest.mark.parametrize("bearing", [with_factor(HDR, 0.7), with_factor(LHDR, 0.7)])
def test_a_compound_keeps_the_band(bearing: tb.Bearing) -> None:
    from thermobearing.bearing.scaling import lead_cores

    compound = extract_compound(bearing)
    again = build_bearing(compound, "again", bearing.geometry, lead_cores(bearing))
    assert again.rate_band == bearing.rate_band
    one, other = acting_rate(bearing), acting_rate(again)
    assert one is not None
    assert other is not None
    assert_allclose([one.stiffness, one.damping], [other.stiffness, other.damping], rtol=1e-12)


@pytest.mark.parametrize(
    ("bearing", "table", "says"),
    [
        (LHDR, {"shear_modulus": 1.0, "viscosity": 1.0}, "only without the table rate"),
        (LHDR, {"lowest": 2.0, "highest": 1.0}, "lowest = 2 is above highest = 1"),
        (LHDR, {"viscosity": 1.0}, "both shear_modulus and"),
        (LHDR, {"highest": 21.0}, "highest"),
    ],
)
def test_faults_of_a_band(bearing: Any, table: dict[str, float], says: str) -> None:
    with pytest.raises(tb.InputError, match=says):
        tb.changed_bearing(bearing, rate_band=table)


def test_alternatives_of_bearings() -> None:
    assert list(alternatives(HDR)) == [(RATE, "highest"), (SMALL_LOOPS, "closed")]
    assert list(alternatives(LHDR, "closed")) == [
        (RATE, "lowest"),
        (RATE, "highest"),
        (SMALL_LOOPS, "published"),
    ]
    assert rate_alternatives(LHDR.model_copy(update={"rate": None})) == {}
    assert alternatives(tb.load_bearing("lrb-example")) == {}  # linear, without a rate branch
    factors = [one.rate_band.factor for one in rate_alternatives(LHDR).values() if one.rate_band]
    assert factors == [0.2, 1.23]


def test_bands_hold_no_change_and_skip_what_is_not_known() -> None:
    assert band([np.nan, 0.03, 0.01]) == (0.0, 0.03)
    assert band_text(-0.004, 0.096) == "0 to +10 %"


def test_bands_of_an_analysis(tmp_path: Path) -> None:
    """Those of analyses with the alternatives, one by one."""
    result = tb.bridge([HDR, "shen-bilinear-bridge"], "jra-ii-i-1", [-20], bands=True, **SHORT)
    rows = result.bands.set_index(["undecided", "quantity"])
    assert set(result.bands["bearing"]) == {HDR.name}
    for what, options in ((RATE, {}), (SMALL_LOOPS, {"small_loops": "closed"})):
        other = with_factor(HDR, 1.0) if what == RATE else HDR
        with_other = tb.bridge(
            other, "jra-ii-i-1", [-20], **SHORT, model=tb.ModelOptions(**options)
        ).table
        for name in ("bearing_strain_max", "bearing_force_max_kN", "bearing_energy_kN_mm"):
            change = with_other[name][0] / result.table[name][0] - 1.0
            row = rows.loc[(what, name)]
            assert_allclose([row["lowest"], row["highest"]], band([change]), atol=1e-12)
    assert rows.loc[(RATE, "bearing_strain_max"), "lowest"] < -1e-3
    result.save(tmp_path / "out", figures=False)
    again = tb.load_result(tmp_path / "out")
    assert len(again.bands) == len(result.bands)
    assert "bands" in again.tables()
    assert [text for text in again.notes() if "rate: " in text and "small loops: " in text]
    assert (tmp_path / "out" / "bands.csv").is_file()


def test_bands_name_the_bearings_that_are_not_decided() -> None:
    """The bearing of the analysis is decided; those of two lines are not."""
    lines = [{"line": name, "bearing": HDR.name} for name in ("A1", "A2")]
    settings: dict[str, Any] = {"structure": "five-span-girder", "lines": lines, "bands": True}
    result = tb.bridge("lrb-example", "jra-ii-i-1", 23, **settings, **SHORT)
    assert set(result.bands["bearing"]) == {"lrb-example"}
    assert set(result.bands[UNDECIDED_OF]) == {HDR.name}
    (sentence,) = (text for text in result.notes() if text.startswith("not decided"))
    assert HDR.name in sentence
    assert "lrb-example" not in sentence
    assert HDR.name in str(result.tables()["bands"].caption)


def test_bands_without_small_loops_in_a_plane() -> None:
    pair = {"name": "jra-ii-i-1", "across": "jra-ii-i-2"}
    result = tb.bridge(HDR, pair, 23, structure="five-span-bridge", bands=True, **SHORT)
    assert set(result.bands["undecided"]) == {RATE}


def test_reports_name_what_is_not_decided() -> None:
    """An assumption without bands, a table with them; nothing of bilinear bearings."""
    from thermobearing.earthquake.report import build_pieces

    short: dict[str, Any] = {"motion": "jra-ii-i-1", "ambient": 23, **SHORT}
    for bearing, bands, stated, tables in (
        (HDR, False, True, False),
        (HDR, True, False, True),
        ("shen-bilinear-bridge", True, False, False),
    ):
        pieces = build_pieces(tb.bridge(bearing, bands=bands, **short))
        assert any("--bands" in text for text in pieces.assumptions) == stated
        assert ("bands" in pieces.tables) == tables


def test_a_specimen_outside_has_no_bands() -> None:
    outside = {"laboratory": {"specimen": "tcp://localhost:1"}, "ambient": [23.0]}
    outside |= {"bearings": ["shen-hdr-specimen"]}
    with pytest.raises(tb.InputError, match="bands: a specimen outside"):
        make_earthquake_case({"command": "hybrid"}, "here", bands=True, **outside)


@pytest.mark.thorough
def test_bands_as_an_option(tmp_path: Path) -> None:
    words = ["bridge", "--bands", "--bearing", LHDR.name, "--motion", "jra-ii-i-1"]
    words += ["--ambient", "23", "--duration", "2", "--no-figures", "-o", str(tmp_path / "out")]
    shown = CliRunner().invoke(app, words)
    assert shown.exit_code == 0, shown.output
    assert len(tb.load_result(tmp_path / "out").bands) == 8


def test_temperature_factors_state_the_band_of_the_rate() -> None:
    """More rate dependence than in the tests makes HDR stiffer; less makes LHDR softer."""
    options: dict[str, Any] = {"temperatures": [-20.0], "strains": [1.0]}
    hdr, lhdr = (run_factors([one], **options) for one in (HDR, LHDR))
    ends = [one.bands.set_index("quantity").loc["K_eq"] for one in (hdr, lhdr)]
    assert ends[0]["lowest"] == 0.0 < ends[0]["highest"]
    assert ends[1]["lowest"] < 0.0 < ends[1]["highest"]
    stiff = tb.temperature_factors(
        with_factor(HDR, 1.0), reference_temperature=23.0, **options
    ).query("basis == 'mean' and quantity == 'K_eq' and ambient_degC == 23")
    plain = hdr.table.query("basis == 'mean' and quantity == 'K_eq' and ambient_degC == 23")
    change = stiff["value"].iloc[0] / plain["value"].iloc[0] - 1.0
    assert_allclose(ends[0]["highest"], change, rtol=1e-12)
    assert "bands" in hdr.tables()
    assert run_factors(["lrb-example"], **options).bands.empty


def test_a_study_draws_the_factor() -> None:
    drawn = {"distribution": "uniform", "low": 0.0, "high": 1.0, "of": "value"}
    factors = {"bearing": HDR.name, "motion": "jra-ii-i-1", "ambient": "23 degC"}
    factors |= {"bearing.rate_band.factor": drawn}
    table = {"kind": "study", "name": "rate", "factors": factors, "design": {"samples": 4}}
    runs = Plan(make_study(table, "here")).runs
    assert runs["bearing.rate_band.factor"].between(0.0, 1.0).all()
    assert runs["bearing.rate_band.factor"].nunique() == 4
