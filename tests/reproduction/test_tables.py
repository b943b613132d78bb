"""Tables of the source and ours: every printed number has ours, a reason, or what broke."""

import numpy as np
import pandas as pd
import pytest

from reproduction.claims import load_claims
from reproduction.report import BEST, names_table, report_table
from reproduction.runs import Runs
from reproduction.tables import (
    COLUMNS,
    COMPUTED,
    DATA,
    PrintedRow,
    all_tables,
    compare_table,
    printed_tables,
)
from thermobearing.border.errors import InputError
from thermobearing.border.schema import validated

NUMBERS = [f"3.{k}" for k in range(1, 7)] + ["4.1", "4.2", "5.1", "5.2"]
NUMBERS += [f"6.{k}" for k in range(1, 5)] + ["A.1", "A.2"]
# Printed numbers that we do not take over, each with its reason in its file.
MENDED = {
    ("table_6_4", "K_r, initial stiffness of a layer", "HDR"),
    ("table_a_2", "d_1", "HDR G12"),
}
# What our numbers are away from printed ones that should follow from others [%]: rounded ones,
# nominal moduli, and those that contradict the numbers next to them.
AWAY = {
    "G, shear modulus": 50.0,
    "frequency": 4.0,
    "T, natural period": 15.3,
    "K_B, equivalent stiffness": 4.1,
    "u_y, yield displacement": 1.8,
}
ROUNDED = 0.2  # the others [%]


@pytest.fixture(scope="module")
def tables() -> dict:  # type: ignore[type-arg]
    return all_tables(Runs())


def test_every_table_is_there(tables) -> None:  # type: ignore[no-untyped-def]
    assert [table.number for table in printed_tables()] == NUMBERS
    assert list(tables) == [table.name for table in printed_tables()]
    for table in printed_tables():
        frame = tables[table.name]
        assert tuple(frame.columns) == COLUMNS
        cells = [value for row in table.row for value in row.printed if value != ""]
        assert (frame["printed"] != "").sum() == len(cells)
        assert not frame["by"].str.startswith("failed").any()


def test_data_files_say_what_is_printed(tables) -> None:  # type: ignore[no-untyped-def]
    seen = set()
    for name, frame in tables.items():
        for row in frame[frame["by"] == DATA].to_dict("records"):
            if row["difference_per_cent"] != 0.0:
                seen.add((name, row["what"], row["of"]))
                assert row["note"]
    assert seen == MENDED


def test_what_is_computed_is_near_the_print(tables) -> None:  # type: ignore[no-untyped-def]
    count = 0
    for frame in tables.values():
        mine = frame[(frame["by"] == COMPUTED) & (frame["printed"] != "")]
        for row in mine.to_dict("records"):
            assert abs(row["difference_per_cent"]) <= AWAY.get(row["what"], ROUNDED), row
            count += 1
    assert count >= 60
    period = tables["table_3_5"].set_index("what")["here"]["T, natural period"]
    assert period == pytest.approx(1.498, abs=5e-4)


def test_what_needs_the_tests_is_not_filled_in(tables) -> None:  # type: ignore[no-untyped-def]
    frame = tables["table_4_2"].set_index("what")
    for what in ("R2 at -20 degC", "R2 at 0 degC", "R2 at 23 degC"):
        assert frame["by"][what].startswith("needs the test data")
        assert frame["here"][what] is None or np.isnan(frame["here"][what])


def test_a_broken_row_says_so_and_the_others_stay() -> None:
    table = next(table for table in printed_tables() if table.number == "3.5")
    rows = tuple(
        row.model_copy(update={"computed": "[no_period]"}) if row.what.startswith("T, ") else row
        for row in table.row
    )
    frame = compare_table(table.model_copy(update={"row": rows}), Runs()).set_index("what")
    assert frame["by"]["T, natural period"].startswith("failed: NameError: ")
    assert frame["here"]["k_2, stiffness of pier"] == 400.0


def test_tables_of_a_document(tables) -> None:  # type: ignore[no-untyped-def]
    first = report_table("table_3_5", tables["table_3_5"])
    assert first.caption.startswith("Table 3.5: ")
    period = next(row for row in first.rows if row[0].startswith("T,"))
    texts = [column.text(value) for column, value in zip(first.columns, period, strict=True)]
    assert texts[2:6] == ["s", "1.3", "1.49801", "15.23"]


def test_functions_of_a_document_say_what_they_return() -> None:
    used = [claim.computed or "" for claim in load_claims("chapter-4")]
    rows = dict(map(tuple, names_table(used).rows))
    assert rows["at_rest"] == "the stiffness of a bearing at rest [kN/mm]."
    assert "shaken" not in rows


def test_the_best_sets_are_shown_without_their_numbers() -> None:
    sets = pd.DataFrame({"k": range(20), "met": range(20, 0, -1), "a: numbers": "1", "why": ""})
    shown = report_table("joint_bridge", sets)
    assert [column.head for column in shown.columns] == ["k", "met"]
    assert [row[1] for row in shown.rows] == list(range(20, 20 - BEST, -1))
    assert "20 sets" in shown.note


def test_a_changed_parameter_is_seen() -> None:
    table = next(table for table in printed_tables() if table.number == "5.2")
    frame = compare_table(table, Runs(change={"K_r": 1.05})).set_index("what")
    assert frame["difference_per_cent"]["K_r, initial stiffness of a layer"] == pytest.approx(5.0)


def test_a_row_says_one_source() -> None:
    with pytest.raises(InputError, match="exactly one of data, computed, why"):
        validated(PrintedRow, {"what": "x", "printed": [1.0]}, "here")
