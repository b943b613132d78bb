"""Samples of a posterior as bearings, bands of factors from them; K_2/K_1 by kind; codes."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.inputs import command, summary
from thermobearing.border.toml import to_toml
from thermobearing.cyclic.equivalent import backbone, bilinear_parameters, post_yield_ratio
from thermobearing.identify.uncertainty.samples import posterior_bearings

NAME = "shen-hdr-specimen"


def written(folder: Path, text: str) -> Path:
    file = folder / "posterior.csv"
    file.write_text(text)
    return file


def test_samples_become_bearings(tmp_path: Path) -> None:
    rows = "\n".join(f"{30.0 + k},{-1.0 - 0.1 * k}" for k in range(9))
    file = written(tmp_path, f"K_r,m_T\n{rows}\n")
    first, *others = posterior_bearings(NAME, file, 3)
    assert first == tb.load_bearing(NAME)
    assert [one.hysteresis.layer_stiffness for one in others] == [30.0, 34.0, 38.0]
    assert others[1].hysteresis.elastic_temperature_coefficient == pytest.approx(-1.4)
    assert len(posterior_bearings(NAME, file, 100)) == 10


def test_samples_are_reported_apart_in_a_sweep(tmp_path: Path) -> None:
    bearings = posterior_bearings(NAME, written(tmp_path, "K_r\n25\n30\n35\n"))
    test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None)
    band = tb.sweep(bearings, test=test, ambient=-20).G_eq_MPa.isel(strain=0, cycle=0, ambient=0)
    names = [NAME, *(f"{NAME}, sample {k}" for k in (1, 2, 3))]
    assert list(band.bearing.values) == names
    lowest, _, highest = band.sel(bearing=names[1:]).values
    assert lowest < band.sel(bearing=NAME).item() < highest


def test_bearings_of_other_thickness_share_the_strains_of_a_test(tmp_path: Path) -> None:
    """1.75 t/t is 1.75 but for rounding, which made three coordinates with gaps of one strain."""
    rows = "\n".join(str(4.9 + 0.013 * k) for k in range(12))
    file = written(tmp_path, f"geometry.rubber_thickness\n{rows}\n")
    test = tb.cyclic_test(strain=[0.5, 1.75], cycles=1, rest=None, dt=0.05)
    runs = [tb.run(bearing, test, ambient=[-20]) for bearing in posterior_bearings(NAME, file)]
    strains = {float(value) for result in runs for value in result.cycles["amplitude_strain"]}
    assert len(strains) > 2
    assert {tuple(result.to_dataset().strain.values) for result in runs} == {(0.5, 1.75)}


def test_a_full_size_bearing_takes_the_samples_of_its_specimen(tmp_path: Path) -> None:
    specimen = tb.load_bearing("shen-lhdr-specimen")
    large = tb.new_bearing(
        "large", specimen, plan="900x900mm", layers="6x22mm", shim="4.5mm", lead="130mm", cores=4
    )
    h, lead = specimen.hysteresis, specimen.lead
    assert lead is not None
    row = (1.1 * h.layer_stiffness, h.yield_displacement, 1.2 * lead.stiffness, -1.0)
    file = written(tmp_path, "K_r,d_y,K_l,m_T\n" + ",".join(map(str, row)) + "\n")
    with pytest.raises(tb.InputError, match="another bearing"):
        posterior_bearings(large, file)
    specimen_file = tmp_path / "bearing.toml"
    specimen_file.write_text(to_toml(specimen))
    first, other = posterior_bearings(large, file)
    assert first == large
    assert large.lead is not None
    assert other.lead is not None
    assert other.hysteresis.layer_stiffness == pytest.approx(1.1 * large.hysteresis.layer_stiffness)
    assert other.hysteresis.yield_displacement == pytest.approx(large.hysteresis.yield_displacement)
    assert other.lead.stiffness == pytest.approx(1.2 * large.lead.stiffness)
    assert other.hysteresis.elastic_temperature_coefficient == -1.0
    assert other.geometry == large.geometry
    assert other.name == "large, sample 1"
    with pytest.raises(tb.InputError, match="not made of its compound: shear_modulus"):
        posterior_bearings("shen-lhdr-bridge", file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("K_r,m_Q\n30,1\n", 'no parameter is called "m_Q"; did you mean'),
        ("K_r,sigma_Y\n30,9\n", '"sigma_Y": shen-hdr-specimen'),
        ("K_r\n", "contains no samples"),
        ("K_r,m_T\n30\n", "row 1: 1 numbers instead of 2"),
        ("K_r\nsoft\n", '"soft" is not a number'),
        ("K_r\n-3\n", "layer_stiffness"),
        ("K_r,K_r\n30,31\n", "two columns"),
    ],
)
def test_samples_that_are_none(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(tb.InputError, match=message):
        posterior_bearings(NAME, written(tmp_path, text))
    with pytest.raises(tb.InputError, match="from 1 to"):
        posterior_bearings(NAME, tmp_path / "posterior.csv", 0)


@pytest.mark.thorough
def test_a_band_from_the_command(tmp_path: Path) -> None:
    file = written(tmp_path, "K_r,m_T\n30,-0.5\n30,-1.5\n")
    out = tmp_path / "out"
    words = (NAME, "--temperature", "-20", "--strain", "1", "--cycles", "3", "--no-figures")
    done = command("lambda", *words, "--posterior", file, "-o", out)
    assert done.exit_code == 0
    reported = summary(out)
    assert reported["samples"] == 3
    rows = [r for r in reported["factors"] if r["quantity"] == "K_eq" and r["ambient_degC"] == -20]
    assert all(row["factor_low"] < row["factor_high"] for row in rows)
    assert reported["stiffness_ratio"]["K_2_over_K_1"] == 0.19
    assert [code["unverified"] for code in reported["codes"]] == [True] * 4
    assert "compared with codes" in done.stdout
    assert done.stdout.count("5 to 95 % of 3 bearings") == 2  # in factors, and beside the codes
    done = command("lambda", NAME, NAME, "--posterior", file)
    assert done.exit_code == 2
    assert "--posterior" in done.output


def test_the_ratio_is_that_of_the_kind() -> None:
    hdr, lead = (bilinear_parameters(name) for name in ("shen-hdr-bridge", "lrb-example"))
    assert_allclose(hdr.post_yield / hdr.initial, 0.19)
    assert_allclose(lead.initial / lead.post_yield, 6.5)
    assert not post_yield_ratio("HDR").unverified
    assert post_yield_ratio("LRB").unverified
    energy = 0.1 * 2.0 * np.pi * 2.0 * 100.0**2
    for kind in ("HDR", "LHDR", "LRB"):
        result = backbone(2.0, energy, 100.0, kind)
        assert_allclose(result.strength + 100.0 * result.post_yield, 200.0)
        moved = 100.0 - result.strength / (result.initial - result.post_yield)
        assert_allclose(4.0 * result.strength * moved, energy)
