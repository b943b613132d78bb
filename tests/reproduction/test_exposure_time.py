"""The comparison with measured values after hours in the cold, on tables with invented values."""

from pathlib import Path

import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from reproduction.__main__ import main
from reproduction.exposure_time import compare_exposure_time
from thermobearing.design.factors import temperature_factors

TEMPLATE = Path(__file__).parents[2] / "reproduction" / "data" / "yasar-2023.toml"


def test_template_holds_no_values(capsys: pytest.CaptureFixture[str]) -> None:
    comparison = compare_exposure_time(TEMPLATE)
    assert len(comparison.skipped) == 18
    assert not len(comparison.table)
    assert main(["--exposure-time", str(TEMPLATE)]) == 0
    assert capsys.readouterr().out.count("skipped") == 18


def filled(tmp_path: Path, cells: dict[str, dict[str, str]]) -> Path:
    """Return a copy of the template with cells in the rows that contain a text."""
    lines = TEMPLATE.read_text(encoding="utf-8").splitlines()
    for place, values in cells.items():
        (number,) = [k for k, line in enumerate(lines) if place in line]
        for name, text in values.items():
            cell = f'{name.removesuffix("_factor")} = ""'
            lines[number] = lines[number].replace(cell, f"{name} = {text}")
    file = tmp_path / "filled.toml"
    file.write_text("\n".join(lines), encoding="utf-8")
    return file


SLOW = 'ambient = "-20 degC", conditioned = "6 h", frequency = "0.1 Hz"'
FAST = SLOW.replace("0.1 Hz", "0.5 Hz")
DAY = 'ambient = "0 degC", conditioned = "24 h", frequency = "0.1 Hz"'


def test_filled_cells_are_compared(tmp_path: Path) -> None:
    cells = {
        SLOW: {"K_d": '"1 kN/mm"', "Q_d": '"200 kN"'},
        DAY: {"K_d": '"1000 kN/m"'},
    }
    comparison = compare_exposure_time(filled(tmp_path, cells))
    table = comparison.table
    assert table["quantity"].tolist() == ["K_d", "Q_d", "K_d"]
    assert table["conditioned_h"].tolist() == [6.0, 6.0, 24.0]
    assert table["ratio"].between(0.7, 1.2).all()
    assert table["ratio"][0] == table["predicted"][0]
    assert len(comparison.skipped) == 16


def test_a_factor_is_relative_to_the_same_hours_at_the_reference(tmp_path: Path) -> None:
    """A bearing from 20 degC stays at 20 degC: its values there are those of cold throughout."""
    factor = {"K_d_factor": "1.25", "Q_d_factor": "1.25"}
    table = compare_exposure_time(filled(tmp_path, {SLOW: factor, FAST: factor})).table
    warm = temperature_factors(
        "lrb-example",
        reference_temperature=20,
        temperatures=[20],
        strains=[1],
        period=10,
        cycles=[3],
    )
    at_reference = warm[warm["basis"] == "mean"].set_index("quantity")["value"]
    values = {"K_d": '"1 kN/mm"', "Q_d": '"1 kN"'}
    absolute = compare_exposure_time(filled(tmp_path, {SLOW: values})).table
    expected = absolute["predicted"].to_numpy() / at_reference[["K_d", "Q_d"]].to_numpy()
    assert_allclose(table["predicted"][:2], expected, rtol=1e-6)
    assert_allclose(table["ratio"], table["predicted"] / 1.25)
    assert table["frequency_Hz"].tolist() == [0.1, 0.1, 0.5, 0.5]
    # Five times the speed warms the lead of the third cycle more, at both temperatures.
    assert table["predicted"][1] > table["predicted"][3] > 1.0


def test_a_row_may_have_its_own_strain(tmp_path: Path) -> None:
    file = filled(tmp_path, {SLOW: {"Q_d": '"200 kN"'}, DAY: {"Q_d": '"200 kN"'}})
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace(SLOW, f"{SLOW}, strain = 0.5"), encoding="utf-8")
    assert compare_exposure_time(file).table["strain"].tolist() == [0.5, 1.0]


def test_faults_name_the_key(tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(TEMPLATE.read_text().replace('conditioned = "3 h"', 'conditioned = "3"', 1))
    with pytest.raises(tb.InputError, match="conditioned"):
        compare_exposure_time(file)
    assert main(["--exposure-time", str(file)]) == 2
