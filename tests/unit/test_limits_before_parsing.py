"""Files that would keep a parser busy for minutes are refused before, each with its reason."""

import fcntl
import os
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

import thermobearing as tb
from thermobearing.border.toml import read_toml
from thermobearing.identify.records.record import load_test
from thermobearing.results import directory as swap
from thermobearing.tables import text as sheets
from thermobearing.tables.text import MOST_ROWS, is_numeric, is_stamp

SOON = 15.0  # [s] on a busy machine; each of them took more than a minute
HEAD = "time_s,displacement_mm,force_kN\n"
BOOK = """<?xml version="1.0"?><worksheet
xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{rows}</sheetData>
</worksheet>"""


def workbook(path: Path, rows: str) -> Path:
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    openpyxl.Workbook().save(path.with_suffix(".plain"))
    with zipfile.ZipFile(path.with_suffix(".plain")) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            sheet = name.startswith("xl/worksheets/")
            new.writestr(name, BOOK.format(rows=rows) if sheet else old.read(name))
    return path


def text(content: str) -> Callable[[Path], Path]:
    def write(path: Path) -> Path:
        path.write_text(content)
        return path

    return write


TABLES: dict[str, tuple[Callable[[Path], Path], str]] = {
    "a cell of digits": (text(HEAD + "1" * 130_000 + "x,1,2\n" + "0,1,2\n" * 50), "not a number"),
    "cells of digits": (
        text(HEAD + ("1" * 10_000 + "x,1,2\n") * 100 + "0,1,2\n" * 50),
        "not a number",
    ),
    "a million columns": (text(("1," * 1_000_000 + "1\n") * 3), "more than 1000 columns"),
    "a far row": (
        lambda path: workbook(path.with_suffix(".xlsx"), '<row r="100000000000"/>'),
        f"more than {MOST_ROWS} rows",
    ),
    "empty rows": (
        lambda path: workbook(path.with_suffix(".xlsx"), "<row/>" * 30_000),
        "more than 20000 rows",
    ),
}


@pytest.mark.parametrize("kind", TABLES)
def test_a_table_is_refused_in_time(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, said = TABLES[kind]
    if kind == "empty rows":
        monkeypatch.setattr(sheets, "MOST_ROWS", 20_000)
    path = write(tmp_path / "t.csv")
    begun = time.process_time()
    with pytest.raises(tb.InputError, match=said):
        load_test(path)
    assert time.process_time() - begun < SOON


def test_a_row_that_looks_like_units_is_passed_in_time(tmp_path: Path) -> None:
    path = text(HEAD + "." * 100_000 + "x,mm,kN\n" + "0,1,2\n" * 50)(tmp_path / "t.csv")
    begun = time.process_time()
    load_test(path)
    assert time.process_time() - begun < SOON


def test_the_widest_table_is_read_in_time(tmp_path: Path) -> None:
    """A thousand columns with a title of their own; the work for titles grew with its square."""
    titles = ",".join(f"channel {k} [u{k}]" for k in range(997))
    path = text(HEAD.strip() + f",{titles}\n" + ("1,1,1" + ",0" * 997 + "\n") * 3)(
        tmp_path / "t.csv"
    )
    begun = time.process_time()
    load_test(path)
    assert time.process_time() - begun < SOON


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("a" + ".a" * 100_000 + " = 1", "line 1: a key of more than 50 parts"),
        ("[" + "a." * 100_000 + "a]\n", "line 1: a key of more than 50 parts"),
        ("b = 1\nc = { " + '"a" . ' * 100_000 + "a = 1 }\n", "line 2: a key of more than 50 parts"),
        ("".join(f"k{n} = 1\n" for n in range(500_000)), "more than 100000 keys"),
        ("[[a]]\n" * 1_600_000, "more than 100000 keys"),
    ],
    ids=["dotted key", "dotted header", "dotted key inside", "keys", "tables"],
)
def test_toml_is_refused_in_time(tmp_path: Path, content: str, said: str) -> None:
    path = text(content)(tmp_path / "d.toml")
    begun = time.process_time()
    with pytest.raises(tb.InputError, match=said):
        read_toml(path)
    assert time.process_time() - begun < SOON


def test_numbers_and_sentences_are_no_keys(tmp_path: Path) -> None:
    path = tmp_path / "d.toml"
    sentence = "A sentence. " * 60
    path.write_text(f'x = [{"0.5, " * 100}]\nnote = "{sentence}"\nmore = """\n{sentence}\n"""\n')
    assert len(read_toml(path)["x"]) == 100


def test_of_very_many_faults_the_first_are_told(tmp_path: Path) -> None:
    path = tmp_path / "d.toml"
    path.write_text("".join(f"k{n} = 1\n" for n in range(2000)))
    with pytest.raises(tb.InputError) as caught:
        tb.load_bearing(path)
    assert len(caught.value.problems) == 51
    assert caught.value.problems[-1].endswith(" more")


def test_a_long_cell_is_no_number_and_no_stamp() -> None:
    assert is_numeric("-" + "1" * 50)
    assert not is_numeric("1" * 61)
    assert is_stamp("12:00:00")
    assert not is_stamp("12:" + "0" * 61)


def test_a_named_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "f.toml")
    os.mkfifo(tmp_path / "f.csv")
    for read in (read_toml, load_test):
        for name in ("f.toml", "f.csv"):
            with pytest.raises(tb.InputError, match="named pipe"):
                read(tmp_path / name)


def test_a_folder_that_a_study_holds_takes_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(swap, "PATIENCE", 0.2)
    bearing = tb.load_bearing("shen-hdr-specimen")
    result = tb.run(bearing, tb.cyclic_test(strain=[0.5], cycles=1, rest=None), ambient=23.0)
    handle = os.open(tmp_path, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        result.save(tmp_path / "x", figures=False)
    finally:
        os.close(handle)
    assert (tmp_path / "x" / "summary.json").exists()
