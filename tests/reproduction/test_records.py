"""Rows that need the test data, judged by records that the model makes, whole and changed."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from reproduction import work
from reproduction.__main__ import main
from reproduction.claims import (
    CLOSE,
    CONTRADICTED,
    HOLDS,
    NEEDS,
    REPRODUCED,
    Row,
    load_claims,
    make_row,
    record_needs,
)
from reproduction.records import Needs, check_records, list_wanted, missing, record_words
from reproduction.runs import Runs
from tests.reproduction import records
from thermobearing.border.errors import InputError

OPEN = "plan-distribution"  # the model has one temperature over the plan
CLAIMS = {claim.id: claim for claim in load_claims() if claim.rule.kind == "needs-test-data"}
COLD = "cyclic-hdr-minus20"
OF_CYCLIC_HDR = {
    "fig-3-11-first-plunge": CLOSE,  # within the record of the last cycle
    "table-4-2-r2": CONTRADICTED,  # the model follows itself better than a test
    "fig-4-7-fits": HOLDS,
    "fig-4-7-first-cycle": CLOSE,  # as strong as itself
    "fig-4-8-agrees": REPRODUCED,
    "fig-4-9-re": REPRODUCED,
    "7-1-4-1": HOLDS,
}
OF_OTHERS = {
    "record-ii-ii-1": REPRODUCED,
    "second-hdr-test-lower": HOLDS,
    "second-lhdr-test-lower": HOLDS,
    "fig-4-11-agrees": HOLDS,
    "fig-4-13-agrees": REPRODUCED,
    "fig-4-15-agrees": REPRODUCED,
    "fig-5-6-agreement": HOLDS,
    "fig-5-6-first-cycle": CLOSE,
    "fig-5-7-within-15": HOLDS,
    "fig-5-8-cooling": CLOSE,  # rests are sampled coarsely here
    "fig-5-11-improved": HOLDS,
    "fig-5-16-measured": REPRODUCED,
    "fig-5-18-acceleration": CLOSE,
    "fig-5-19-displacement": REPRODUCED,
    "fig-6-8-motions": HOLDS,
    "7-1-5-1-history": REPRODUCED,
    "7-1-5-2-accuracy": HOLDS,
}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The cyclic tests of the HDR specimen, and the accelerogram of the hybrid tests."""
    path = tmp_path_factory.mktemp("records")
    records.make_cyclic(path, "hdr")
    records.make_motion(path, "motion-ii-ii-1", records.STAND_IN, records.SECONDS)
    return path


@pytest.fixture
def changed(folder: Path, tmp_path: Path) -> Callable[[Callable[[pd.DataFrame], Any]], Path]:
    """Write the cyclic tests with a change; return their folder."""

    def write(change: Callable[[pd.DataFrame], Any]) -> Path:
        for file in folder.glob("cyclic-*.csv"):
            table = pd.read_csv(file)
            change(table)
            table.to_csv(tmp_path / file.name, index=False)
            sidecar = file.with_suffix(".toml")
            (tmp_path / sidecar.name).write_bytes(sidecar.read_bytes())
        return tmp_path

    return write


def judged(name: str, runs: Runs) -> Row:
    return make_row(CLAIMS[name], runs)


def kinds(folder: Path, names: Any) -> dict[str, str]:
    runs = Runs(records=folder)
    return {name: judged(name, runs).verdict.kind for name in names}


def test_every_row_says_what_judges_it_and_every_record_is_wanted() -> None:
    assert {name for name, claim in CLAIMS.items() if claim.measured is None} == {OPEN}
    assert {*record_needs()} == {*OF_CYCLIC_HDR, *OF_OTHERS}
    for needs in record_needs().values():
        names = [name for some in record_words(needs).values() for name in some]
        assert all(any(map(Needs(records=(pattern,)).wants, names)) for pattern in needs.records)
    assert all(rows for *_, rows in list_wanted(record_needs()))


def test_records_of_the_model_judge_their_rows(folder: Path) -> None:
    runs = Runs(records=folder)
    rows = {name: judged(name, runs) for name in OF_CYCLIC_HDR}
    assert {name: row.verdict.kind for name, row in rows.items()} == OF_CYCLIC_HDR
    assert np.min(rows["table-4-2-r2"].computed) > 0.999
    assert np.allclose(rows["fig-4-7-first-cycle"].computed, 1.0, atol=0.01)
    assert np.allclose(rows["fig-4-8-agrees"].computed, 1.0, atol=0.01)
    assert np.shape(rows["fig-4-8-agrees"].computed) == (2, 6)  # without the amplitude of 50 %
    assert np.shape(rows["fig-4-9-re"].computed) == (12,)  # 3 tests, 2 layers, 2 loadings
    assert np.allclose(rows["fig-4-9-re"].computed, 0.0, atol=0.02)
    assert np.allclose(rows["fig-3-11-first-plunge"].computed, 1.0, atol=0.02)
    assert rows["table-4-2-r2"].printed is not None
    assert rows["table-4-2-r2"].flips == ()
    assert judged("record-ii-ii-1", runs).computed == pytest.approx([8.02])


def test_a_stronger_and_cooler_test_turns_verdicts(changed: Any) -> None:
    def change(table: pd.DataFrame) -> None:
        table["force_kN"] *= 1.6
        for title in table.columns[table.columns.str.endswith("[degC]")]:
            table[title] -= 0.3 * (table[title] - table[title][0])

    assert kinds(changed(change), OF_CYCLIC_HDR) == OF_CYCLIC_HDR | {
        "fig-3-11-first-plunge": CONTRADICTED,
        "table-4-2-r2": CONTRADICTED,
        "fig-4-7-fits": CONTRADICTED,
        "fig-4-7-first-cycle": HOLDS,
        "fig-4-8-agrees": CONTRADICTED,
        "fig-4-9-re": CONTRADICTED,
        "7-1-4-1": CONTRADICTED,
    }


def test_noise_of_the_printed_size_gives_the_printed_r2(changed: Any) -> None:
    printed = dict(zip((23.0, 0.0, -20.0), (0.9484, 0.9765, 0.9601), strict=True))

    def change(table: pd.DataFrame) -> None:
        r2 = printed[round(table["rubber 1 [degC]"][0])]
        size = table["force_kN"].std() * np.sqrt((1.0 - r2) / r2)
        table["force_kN"] += size * np.random.default_rng(3).normal(size=len(table))

    row = judged("table-4-2-r2", Runs(records=changed(change)))
    assert row.verdict.kind == REPRODUCED
    assert np.allclose(row.computed, list(printed.values()), atol=0.005)


def test_rows_stay_open_and_name_the_files_that_are_missing(folder: Path, tmp_path: Path) -> None:
    assert set(kinds(tmp_path, CLAIMS).values()) == {NEEDS}
    file = folder / f"{COLD}.csv"
    (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / f"{COLD}.toml").write_text('ambient = "-20 degC"', encoding="utf-8")
    words = judged("table-4-2-r2", Runs(records=tmp_path)).verdict.words
    assert words.endswith("missing cyclic-hdr-23.csv, cyclic-hdr-0.csv")
    assert judged(OPEN, Runs(records=folder)).verdict == judged(OPEN, Runs()).verdict
    words = judged("fig-4-15-agrees", Runs(records=folder)).verdict.words
    assert "hybrid-hdr-rt-23.csv" in words
    assert "motion-ii-ii-1.csv" not in words


def test_a_test_without_a_column_that_a_row_wants_keeps_it_open(folder: Path) -> None:
    needs = record_needs()["table-4-2-r2"].model_copy(update={"columns": ("pier displacement",)})
    assert missing(needs, folder).startswith("cyclic-hdr-23 has no pier displacement; cyclic-hdr-0")


@pytest.mark.parametrize(
    ("files", "named"),
    [
        ({f"{COLD}.csv": "time_s,displacement_mm,force_kN\n0,0,0\n1,x,1\n2,0,0\n"}, "x"),
        ({f"{COLD}.csv": "time_s,displacement_mm\n0,0\n1,1\n2,0\n"}, "force"),
        ({f"{COLD}.csv": None}, "-20 degC"),  # no sidecar: 23 degC is assumed
        ({f"{COLD}.csv": "", f"{COLD}.txt": ""}, f"{COLD}.toml"),
        ({f"{COLD}.csv": "time_s,displacement_mm,force_kN\n0,0,0\n1,0,1\n2,0,0\n",
          f"{COLD}.toml": 'ambient = "-20 degC"'}, "displacement is constant"),
        ({"motion-i-i-1.csv": "time_s,acceleration\n0,0\n1,1\n"}, "unit"),
    ],
)  # fmt: skip
def test_a_record_that_cannot_be_used_is_named(
    files: dict[str, str | None],
    named: str,
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(work, "split_parts", lambda *_, **__: [])
    for name, text in files.items():
        data = (folder / name).read_text(encoding="utf-8") if text is None else text
        (tmp_path / name).write_text(data, encoding="utf-8")
    output = str(tmp_path / "out")
    assert main(["--chapter", "3", "--records", str(tmp_path), "-o", output]) == 2
    message = capsys.readouterr().err
    assert str(tmp_path) in message
    assert next(iter(files)).removesuffix(".csv") in message
    assert named in message
    assert not Path(output).exists()


def test_displacements_that_no_bearing_has_are_refused(changed: Any) -> None:
    def change(table: pd.DataFrame) -> None:
        table["displacement_mm"] *= 10.0

    with pytest.raises(InputError, match=r"cyclic-hdr-23\.toml") as error:
        check_records(changed(change))
    assert any("1495 %" in problem for problem in error.value.problems)


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        check_records(tmp_path / "nowhere")


@pytest.mark.drawn
def test_the_program_fills_rows_and_says_from_which_files(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    names = ("table-4-2-r2", "fig-6-8-motions")
    monkeypatch.setattr(work, "split_parts", lambda *_, **__: [work.Part("claims", names)])
    words = ["--jobs", "1", "--records", str(folder), "-o", str(tmp_path / "out")]
    assert main(words) == 0
    filled, left = json.loads((tmp_path / "out" / "ledger.json").read_text(encoding="utf-8"))
    assert (filled["verdict"], left["verdict"]) == (CONTRADICTED, NEEDS)
    assert filled["expression"] == "r2(tests)"
    assert len(filled["numbers"]) == 3
    assert filled["rule"].startswith("0.9484, 0.9765, 0.9601")
    assert "motion-i-i-1.csv" in left["words"]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["records"] == check_records(folder)
    capsys.readouterr()
    assert main(["--list"]) == 0
    assert "cyclic-hdr-minus20.csv" in capsys.readouterr().out


@pytest.mark.thorough
def test_records_of_all_tests_judge_every_row(tmp_path: Path) -> None:
    records.make_all(tmp_path)
    assert {needs for needs in record_needs() if missing(record_needs()[needs], tmp_path)} == set()
    runs = Runs(records=tmp_path)
    rows = {name: judged(name, runs) for name in OF_CYCLIC_HDR | OF_OTHERS}
    assert {name: row.verdict.kind for name, row in rows.items()} == OF_CYCLIC_HDR | OF_OTHERS
    for name in ("fig-4-15-agrees", "fig-5-18-acceleration", "fig-5-19-displacement"):
        assert np.allclose(rows[name].computed, 1.0, atol=0.003), name
    assert np.allclose(rows["fig-6-8-motions"].computed, 0.0, atol=1e-6)
