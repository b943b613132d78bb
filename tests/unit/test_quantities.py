"""The register of quantities, and tables that it describes."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_array_equal

from thermobearing.border.units import conversion
from thermobearing.quantities import register
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.results.screen import show_table
from thermobearing.results.writing import json_line, write_csv

ROWS = register.registered_quantities()


def test_factors_are_those_of_the_units() -> None:
    for (stored, shown), factor in register.FACTORS.items():
        written = {"%": "percent", "t": "tonne", "t m²": "tonne*m^2"}.get(shown, shown)
        assert conversion(stored, written)[0] == pytest.approx(factor)


@pytest.mark.parametrize("name", ROWS)
def test_a_row_formats_numbers_and_says_its_unit_in_its_name(name: str) -> None:
    row = ROWS[name]
    assert row.head
    for value in (0.0, -12.5, 1e5):
        text = row.text(value if row.form != "d" else int(value))
        float(text.removeprefix("< ").replace(register.MINUS, "-"))
    ends = {"_kN": "kN", "_degC": "degC", "_kN_mm": ("kN mm", "kN/mm"), "_MPa": "MPa"}
    ends["_s"] = ("s", "m/s", "cm/s", "mm/s")
    for end, unit in ends.items():
        if name.endswith(end):
            assert row.stored in unit if isinstance(unit, tuple) else row.stored == unit


RESIDUALS = {
    **dict.fromkeys(["mechanical_residual", "thermal_residual"], 1e-12),
    **dict.fromkeys(["structure_residual", "element_residual"], 1e-12),
    **dict.fromkeys(["layer_force_mismatch_max", "layer_force_mismatch_max_kN"], 1e-10),
    "end_velocity_cm_s": 1e-10,
    "end_displacement_cm": 1e-10,
}


def test_residuals_say_below_what_they_are_rounding() -> None:
    assert {name: row.rounding for name, row in ROWS.items() if row.rounding} == RESIDUALS
    for name, limit in RESIDUALS.items():
        assert f"0 where less than {limit:.0e}" in ROWS[name].definition


@pytest.mark.parametrize(("name", "limit"), RESIDUALS.items())
def test_rounding_is_zero_in_files_and_a_bound_for_readers(name: str, limit: float) -> None:
    row = ROWS[name]
    bound = f"< {limit:.0e}".replace("-", register.MINUS)
    for value in (0.0, 0.9 * limit, -0.9 * limit, np.float32(0.9 * limit)):
        assert row.text(value) == bound
        assert row.without_rounding(value) == row.shown(value) == 0.0
    for value in (1.1 * limit, -1.1 * limit):
        assert "<" not in row.text(value)
        assert row.without_rounding(value) == value
    assert row.text(np.nan) == ""
    assert row.without_rounding(None) is None
    rounded = row.without_rounding(np.array([0.5 * limit, np.nan, 2.0 * limit]))
    assert_array_equal(rounded, [0.0, np.nan, 2.0 * limit])


def test_files_have_no_digits_of_rounding(tmp_path: Path) -> None:
    values = {"thermal_residual": [3e-16, -2e-3], "strain_max": [3e-16, 1.0]}
    write_csv(tmp_path / "table.csv", pd.DataFrame(values))
    assert pd.read_csv(tmp_path / "table.csv").to_numpy().tolist() == [[0.0, 3e-16], [-2e-3, 1.0]]
    assert json.loads(json_line({"runs": [{name: v[0] for name, v in values.items()}]})) == {
        "runs": [{"thermal_residual": 0.0, "strain_max": 3e-16}]
    }


def test_numbers_are_shown_in_the_unit_of_the_head() -> None:
    frame = pd.DataFrame(
        {
            "motion": ["a", "b"],
            "bearing_energy_kN_mm": [5230.0, np.nan],
            "outcome": ["completed"] * 2,
        }
    )
    table = make_table(frame, ["motion", "bearing_energy_kN_mm", "pier_ductility"], "Runs")
    assert [c.title for c in table.columns] == ["Motion", "Energy of one [kJ]"]
    assert table.rows[0] == ["a", pytest.approx(5.23)]
    assert table.texts() == [["a", "5.2"], ["b", ""]]


def test_a_number_without_a_row_is_an_error_and_words_are_not() -> None:
    with pytest.raises(KeyError):
        make_table(pd.DataFrame({"no_such_number": [1.0]}))
    assert make_table(pd.DataFrame({"no_such_word": ["x"]})).columns[0].head == "No such word"


def test_marks_and_failed_runs(capsys: pytest.CaptureFixture[str]) -> None:
    frame = pd.DataFrame({"motion": ["a", "b"], "bearing_strain_max": [1.0, 3.0]})
    frame["outcome"] = ["completed", "pier_beyond_limit"]
    table = make_table(
        frame, ["motion", "bearing_strain_max"], marked={"bearing_strain_max": [False, True]}
    )
    assert table.marked == {(1, 1)}
    assert table.failed == {1}
    show_table(table)
    assert "300!" in capsys.readouterr().out


def test_sentences_follow_their_table(capsys: pytest.CaptureFixture[str]) -> None:
    """A column of sentences is as wide as the longest one, and no screen has so much room."""
    sentence = " ".join(10 * ["A pier exceeded its limits."])
    heads = [Quantity("Outcome"), Quantity("Explanation"), Quantity("Runs", form="d")]
    show_table(Table("Failed runs", heads, [["beyond", sentence, 35], ["torn", "short", 4]]))
    lines = capsys.readouterr().out.splitlines()
    assert lines[2:5] == ["Outcome  Runs", "beyond     35", "torn        4"]
    assert lines[5:] == [f"beyond: {sentence}", "torn: short"]


def test_a_key_with_one_value_is_stated_in_the_caption() -> None:
    frame = pd.DataFrame({"bearing": ["x", "x"], "motion": ["a", "b"], "ambient_degC": [-20, -20]})
    assert make_table(frame, None, "Runs", keys=3).rows == [["a"], ["b"]]
    caption = make_table(frame, None, "Runs", keys=3).caption
    assert caption == "Runs (bearing: x; ambient: \N{MINUS SIGN}20 °C)"
    assert len(make_table(frame, None, keys=3, keep_keys=True).columns) == 3
    marked = make_table(frame, None, keys=3, marked={"bearing": [True, False]})
    assert marked.marked == {(0, 0)}
    one = make_table(frame[:1], None, keys=3)  # one key stays
    assert one.rows == [["x"]]
    assert one.keys == 1


def test_text_of_numbers() -> None:
    column = Quantity("Force", "kN", ".1f")
    assert [column.text(v) for v in (-2.04, -0.01, np.nan, None, True, "x")] == [
        *("\N{MINUS SIGN}2.0", "0.0", "", "", "yes", "x")
    ]


def test_rows_that_read_the_same_become_one() -> None:
    frame = pd.DataFrame(
        {
            "motion": ["a", "a", "a"],
            "ambient_degC": [23.0, 0.0, -20.0],
            "bearing_strain_max": [1.0, 1.001, 1.0],
        }
    )
    marked = {"ambient_degC": [False, False, True]}
    table = make_table(frame, caption="Runs", keys=2, marked=marked).merged("ambient_degC")
    assert (table.keys, table.marked) == (1, {(1, 0)})
    assert table.texts() == [["23, 0", "100"], ["\N{MINUS SIGN}20", "100"]]
