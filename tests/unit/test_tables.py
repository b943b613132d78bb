"""CSV tables as laboratories write them: header styles, units, encodings, line ends."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.tables.columns import Layout

WANTED = {"time": "s", "displacement": "mm"}


def read(tmp_path: Path, text: str | bytes, wanted: dict[str, str] = WANTED) -> dict[str, list]:
    path = tmp_path / "table.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return {name: values.tolist() for name, values in tb.read_columns(path, wanted).items()}


@pytest.mark.parametrize(
    "header",
    [
        "time_s,displacement_mm",
        "Time [s],Displacement [mm]",
        "time (s) , displacement (mm)",
        "t_s,disp_mm",
        '"time_s","displacement_mm"',
        "time_s,displacement_mm,",
    ],
)
def test_header_styles(tmp_path: Path, header: str) -> None:
    data = read(tmp_path, header + "\n0,0.25\n1,-3e-1\n")
    assert data == {"time": [0.0, 1.0], "displacement": [0.25, -0.3]}


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp932"])
def test_encodings_and_line_ends(tmp_path: Path, encoding: str, end: str) -> None:
    lines = ["time_s,備考,displacement_mm", "0,初期,0", "", "1,載荷,5", ""]
    data = read(tmp_path, end.join(lines).encode(encoding))
    assert data == {"time": [0.0, 1.0], "displacement": [0.0, 5.0]}


def test_columns_are_found_by_name_in_any_order(tmp_path: Path) -> None:
    data = read(tmp_path, "force_kN,displacement_cm,note,time_ms\n7,1,a,0\n8,2,b,500\n")
    assert data == {"time": [0.0, 0.5], "displacement": [10.0, 20.0]}


def test_column_in_the_wanted_unit_comes_first(tmp_path: Path) -> None:
    """Converted twice by the laboratory, rounded once: the column that needs no conversion."""
    data = read(tmp_path, "force_tonf,force_kN\n1,9.8\n2,19.6\n", {"force": "kN"})
    assert data == {"force": [9.8, 19.6]}


@pytest.mark.parametrize(
    ("unit", "cells"),
    [("degC", (0, 100)), ("K", (273.15, 373.15)), ("degF", (32, 212)), ("°C", (0, 100))],
)
def test_temperatures_are_converted_with_their_offset(
    tmp_path: Path, unit: str, cells: tuple[float, float]
) -> None:
    text = f"temperature [{unit}]\n{cells[0]}\n{cells[1]}\n"
    data = read(tmp_path, text, {"temperature": "degC"})
    assert_allclose(data["temperature"], [0, 100], rtol=tol.CONVERSION, atol=tol.ZERO_DEGREES)


def test_many_rows_keep_their_bits(tmp_path: Path) -> None:
    values = np.random.default_rng(1).normal(size=(5000, 2))
    path = tmp_path / "table.csv"
    rows = "\n".join(f"{a!r},{b!r}" for a, b in values.tolist())
    path.write_text("time_s,displacement_mm\n" + rows)
    data = tb.read_columns(path, WANTED)
    assert_array_equal(np.column_stack([data["time"], data["displacement"]]), values)


def test_faults_are_told_with_the_line_of_the_file(tmp_path: Path) -> None:
    """Lines before the header and between it and the numbers count too."""
    path = tmp_path / "t.csv"
    path.write_text("laboratory\nnumber 7\ntime_s,force_kN\n[s],[kN]\n0,1\n1,lost\n2,3\n")
    layout = Layout(lines_before=2, lines_after=1)
    with pytest.raises(tb.InputError, match='line 6, force_kN: "lost" is not a number'):
        tb.read_columns(path, {"time": "s", "force": "kN"}, layout=layout)
