"""The comparison with measured values after hours in the cold, on tables with invented values."""

from pathlib import Path

import pytest

import thermobearing as tb
from reproduction.__main__ import main
from reproduction.exposure_time import compare_exposure_time

TEMPLATE = Path(__file__).parents[2] / "reproduction" / "data" / "yasar-2023.toml"


def test_template_holds_no_values(capsys: pytest.CaptureFixture[str]) -> None:
    comparison = compare_exposure_time(TEMPLATE)
    assert len(comparison.skipped) == 9
    assert not len(comparison.table)
    assert main(["--exposure-time", str(TEMPLATE)]) == 0
    assert capsys.readouterr().out.count("skipped") == 9


def test_filled_cells_are_compared(tmp_path: Path) -> None:
    parts = TEMPLATE.read_text().split("[[rows]]")
    parts[2] = parts[2].replace('K_d = ""', 'K_d = "1 kN/mm"').replace('Q_d = ""', 'Q_d = "200 kN"')
    parts[9] = parts[9].replace('K_d = ""', 'K_d = "1000 kN/m"')
    file = tmp_path / "filled.toml"
    file.write_text("[[rows]]".join(parts))
    comparison = compare_exposure_time(file)
    table = comparison.table
    assert table["quantity"].tolist() == ["K_d", "Q_d", "K_d"]
    assert table["conditioned_h"].tolist() == [6.0, 6.0, 24.0]
    assert table["ratio"].between(0.7, 1.2).all()
    assert table["ratio"][0] == table["predicted"][0]
    assert len(comparison.skipped) == 8


def test_faults_name_the_key(tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(TEMPLATE.read_text().replace('conditioned = "3 h"', 'conditioned = "3"', 1))
    with pytest.raises(tb.InputError, match="conditioned"):
        compare_exposure_time(file)
    assert main(["--exposure-time", str(file)]) == 2
