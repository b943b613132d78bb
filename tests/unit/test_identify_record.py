"""Records as laboratories write them: encodings, headers, units, blocks, missing clocks."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.border.errors import InputError
from thermobearing.identify.records.record import ASSUMED_AMBIENT, load_test
from thermobearing.tables.laboratory import ASSUMED_SPEED

TIME = np.arange(400) * 0.02
X = 30.0 * np.sin(2.0 * np.pi * 0.5 * TIME)
FORCE = 2.0 * X + 10.0 * np.cos(2.0 * np.pi * 0.5 * TIME)


def write(
    path: Path,
    columns: dict[str, np.ndarray],
    before: str = "",
    after: str = "",
    encoding: str = "utf-8",
) -> Path:
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(f"{v!r}" for v in row.tolist()) for row in rows]
    text = before + ",".join(columns) + "\n" + after + "\n".join(lines) + "\n"
    path.write_bytes(text.encode(encoding))
    return path


def plain(path: Path) -> Path:
    return write(path, {"time_s": TIME, "displacement_mm": X, "force_kN": FORCE})


def test_plain_csv(tmp_path: Path) -> None:
    record = load_test(plain(tmp_path / "a.csv"))
    assert_allclose(record.force, FORCE, rtol=tol.CONVERSION)
    assert record.ambient == ASSUMED_AMBIENT
    assert any("ambient" in text for text in record.assumptions)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp932"])
def test_japanese_laboratory_file(tmp_path: Path, encoding: str) -> None:
    """Three lines before the header, a line of channels after it, cm and tonf."""
    columns = {"時間(s)": TIME, "変位": X / 10.0, "荷重(tonf)": FORCE / 9.80665}
    before, after = "試験体,HDR\n日付,2020/1/1\n担当,\n", "ch1,ch2,ch3\n"
    write(tmp_path / "t.csv", columns, before, after, encoding)
    (tmp_path / "t.toml").write_text(
        'ambient = "-20 degC"\nlines_before = 3\nlines_after = 1\n'
        '[columns]\ntime = "時間(s)"\ndisplacement = "変位"\nforce = "荷重(tonf)"\n'
        '[units]\ndisplacement = "cm"\n',
        encoding="utf-8",
    )
    record = load_test(tmp_path / "t.csv")
    assert_allclose(record.displacement, X, rtol=tol.CONVERSION, atol=tol.CONVERSION)
    assert_allclose(record.force, FORCE, rtol=tol.CONVERSION)
    assert record.ambient == -20.0
    assert record.assumptions == ()


@pytest.mark.parametrize(
    ("sidecar", "name", "wanted"),
    [
        ('[units]\nforce = "tonf"', "force", 9.80665 * FORCE),
        ('flip_force = true\nforce_offset = "3 kN"', "force", -(FORCE - 3.0)),
        ('displacement_offset = "1 mm"', "displacement", X - 1.0),
    ],
)
def test_units_signs_and_offsets(
    tmp_path: Path, sidecar: str, name: str, wanted: np.ndarray
) -> None:
    plain(tmp_path / "t.csv")
    (tmp_path / "t.toml").write_text(f'ambient = "0 degC"\n{sidecar}\n')
    found = getattr(load_test(tmp_path / "t.toml"), name)
    assert_allclose(found, wanted, rtol=tol.CONVERSION, atol=tol.CONVERSION)


def test_blocks_with_rests_make_one_line_of_time(tmp_path: Path) -> None:
    plain(tmp_path / "a.csv")
    plain(tmp_path / "b.csv")
    (tmp_path / "all.toml").write_text(
        'ambient = "0 degC"\nblocks = [{ file = "a.csv" }, { file = "b.csv", '
        'rest_before = "75 min" }]\n'
    )
    record = load_test(tmp_path / "all.toml")
    assert (np.diff(record.time) > 0.0).all()
    assert_allclose(record.time[400] - record.time[399], 4500.0, rtol=tol.CONVERSION)
    assert record.block.tolist() == [0] * 400 + [1] * 400


def test_without_a_clock_a_speed_is_assumed_and_said(tmp_path: Path) -> None:
    write(tmp_path / "t.csv", {"displacement_mm": X, "force_kN": FORCE})
    record = load_test(tmp_path / "t.csv")
    assert any(f"{ASSUMED_SPEED:g} mm/s" in text for text in record.assumptions)
    path = np.abs(np.diff(X)).sum()
    assert_allclose(record.time[-1], path / ASSUMED_SPEED, rtol=1e-3)
    (tmp_path / "t.toml").write_text('sampling = "50 Hz"\n')
    assert_allclose(load_test(tmp_path / "t.csv").time, TIME, atol=tol.CONVERSION)


def test_thermocouples(tmp_path: Path) -> None:
    columns = {"time_s": TIME, "displacement_mm": X, "force_kN": FORCE, "T1_degC": TIME + 1.0}
    write(tmp_path / "t.csv", columns)
    (tmp_path / "t.toml").write_text('[thermocouples]\nT1_degC = "rubber 1"\n')
    record = load_test(tmp_path / "t.csv")
    assert record.places == {"T1_degC": "rubber 1"}
    assert_allclose(record.temperatures["T1_degC"], TIME + 1.0, rtol=tol.CONVERSION)


@pytest.mark.parametrize(
    ("sidecar", "said"),
    [
        ('ambiant = "0 degC"\n', "ambient"),
        ("ambient = 0\n", "no unit"),
        ('file = "t.csv"\nblocks = [{ file = "t.csv" }]\n', "either file or blocks"),
        ('speed = "3 mm/s"\nsampling = "3 Hz"\n', "either speed or sampling"),
        ('[columns]\nforce = "Kraft"\n', 'no column "Kraft"'),
        ('[units]\nforce = "mm"\n', "cannot be converted"),
        ('[columns]\nForce = "x"\n', "known: ambient, displacement, force, time"),
        ('[thermocouples]\nT = "steel 1"\n', "must be"),
        ("lines_before = 900\n", "lines"),
    ],
)
def test_faults_are_named(tmp_path: Path, sidecar: str, said: str) -> None:
    plain(tmp_path / "t.csv")
    (tmp_path / "t.toml").write_text(sidecar)
    with pytest.raises(InputError, match=said):
        load_test(tmp_path / "t.csv")


def test_truncated_in_the_middle_of_a_line(tmp_path: Path) -> None:
    path = plain(tmp_path / "t.csv")
    text = path.read_text()
    path.write_text(text[: text.rindex(",") + 1])
    with pytest.raises(InputError, match="line 401"):
        load_test(path)
