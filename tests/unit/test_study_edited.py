"""A study whose files were edited is not evaluated: the message names the file and the change."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

import thermobearing as tb
import thermobearing.studies.store
from tests.unit import inputs
from tests.unit.studies import kept, small_study
from thermobearing.motions.library import load_motion, save_motion
from thermobearing.results.directory import check_seal
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.engine import repeat_run, run_study, study_status
from thermobearing.studies.store import Store

RESUME = "--resume writes it again"


@pytest.fixture(scope="module")
def with_histories(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory of a small study that keeps all histories; not to be changed."""
    directory = tmp_path_factory.mktemp("kept") / "p1"
    run_study(small_study({"duration": "0.1 s"}, keep="all"), directory, jobs=1, size=4)
    return directory


@pytest.fixture
def copy(with_histories: Path, tmp_path: Path) -> Path:
    return shutil.copytree(with_histories, tmp_path / "p1")


def edit(directory: Path, **changes: object) -> None:
    path = directory / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"runs": 7}, "runs = 7, was 8"),
        ({"name": "other"}, "name = 'other', was 'small'"),
        ({"input": "0" * 64}, "input = '000"),
        ({"shard_size": 8}, "its digest is another one"),
    ],
)
def test_an_edited_manifest(copy: Path, changes: dict[str, object], words: str) -> None:
    edit(copy, **changes)
    for read in (tb.load_result, study_status, lambda path: Store(path).study()):
        inputs.assert_refused(lambda read=read: read(copy), "manifest.json", words)


def test_a_manifest_without_the_version(copy: Path) -> None:
    edit(copy, versions={"numpy": "2"})
    inputs.assert_refused(lambda: tb.load_result(copy), "manifest.json", "is damaged")


def test_manifests_of_earlier_versions_have_no_digest(copy: Path) -> None:
    edit(copy, format=2)
    assert tb.load_result(copy).runs == 8


def flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def replaced(path: Path) -> None:
    """Put another table there, whose own digest is right."""
    shutil.copy(path.parent / "shards" / "00000.parquet", path)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("plan.parquet", flipped),
        ("plan.parquet", replaced),
        ("plan.parquet", Path.unlink),
        ("shards/00001.parquet", flipped),
        ("histories/00001.nc", flipped),
    ],
)
def test_members_that_were_changed(
    copy: Path, with_histories: Path, name: str, change: Callable[[Path], None]
) -> None:
    """They are named; a resumed study writes them again, to the same bytes."""
    change(copy / name)
    read = (lambda: repeat(copy, 4)) if "histories" in name else (lambda: tb.load_result(copy))
    inputs.assert_refused(read, name, RESUME)
    run_study(small_study({"duration": "0.1 s"}, keep="all"), copy, jobs=1, resume=True)
    assert kept(copy) == kept(with_histories)
    assert tb.load_result(copy).runs == 8


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("shards/00000.parquet", ["worst"]),
        ("shards/00000.parquet", ["table"]),
        ("histories/00000.nc", ["repeat", "3"]),
    ],
)
def test_commands_name_what_was_changed(copy: Path, name: str, words: list[str]) -> None:
    flipped(copy / name)
    file = copy.parent / ("out" if words[0] == "repeat" else "t.csv")
    output = () if words[0] == "worst" else ("-o", file)
    done = inputs.command("study", words[0], copy, *words[1:], *output)
    assert done.exit_code == 2
    assert name in done.stderr


def test_histories_are_read_only_where_they_are_asked_for(
    copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Runs 0 to 3 are in the first file, 4 to 7 in the second."""
    flipped(copy / "histories" / "00001.nc")
    checked: list[str] = []

    def check(path: Path) -> None:
        checked.append(path.name)
        check_seal(path)

    monkeypatch.setattr(thermobearing.studies.store, "check_seal", check)
    assert tb.load_result(copy).runs == 8
    assert not checked
    assert repeat(copy, 3).runs == 1
    assert checked == ["00000.nc"]
    inputs.assert_refused(lambda: repeat(copy, 4), "histories/00001.nc")


def repeat(directory: Path, run: int) -> tb.EarthquakeResult:
    store = Store(directory)
    return repeat_run(store.study(), run, store)


def test_a_run_with_another_motion_is_not_repeated(tmp_path: Path) -> None:
    motion = tmp_path / "m.csv"
    record = load_motion("jra-ii-i-1")
    save_motion(record, motion)
    factors = {"bearing": "shen-hdr-bridge", "motion": str(motion), "ambient": ["0 degC"]}
    table = {"kind": "study", "name": "p1", "case": {"duration": "0.1 s"}, "factors": factors}
    run_study(make_study(table, "study.toml"), tmp_path / "p1", jobs=1)
    store = Store(tmp_path / "p1")
    assert repeat_run(store.study(), 0, store).runs == 1
    rows = pd.read_csv(motion, comment="#")
    rows.iloc[5, 1] += 1.0
    rows.to_csv(motion, index=False)
    assert len(Plan(store.study()).runs) == 1
    inputs.assert_refused(lambda: repeat_run(store.study(), 0, store), "has changed since it")
