"""Earlier releases that benchmarks compare with the present; nothing is timed here."""

import io
import tarfile
from pathlib import Path

import pytest

from benchmarks import release_times, releases
from benchmarks.releases import NoReleaseError, Release, fastest, ratio_rows

VERSIONS = {"c" * 40: "0.3.0", "b" * 40: "0.2.0", "a" * 40: "0.1.0"}  # by commit, the last first


class History:
    """Answers of git about three commits that changed the version; some machines have no git."""

    head = "d" * 40

    def __call__(self, *arguments: str) -> bytes:
        if arguments[0] == "rev-parse":
            return f"{self.head}\n".encode()
        if arguments[0] == "log":
            return "\n".join(VERSIONS).encode()
        if arguments[0] == "show":
            return self.project(arguments[1].removesuffix(":pyproject.toml"))
        assert arguments[0] == "archive"
        content = self.project(arguments[1])
        member = tarfile.TarInfo("pyproject.toml")
        member.size = len(content)
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w") as members:
            members.addfile(member, io.BytesIO(content))
        return archive.getvalue()

    @staticmethod
    def project(commit: str) -> bytes:
        return f'[project]\nversion = "{VERSIONS[commit]}"\n'.encode()


@pytest.fixture
def history(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> History:
    answers = History()
    monkeypatch.setattr(releases, "git", answers)
    monkeypatch.setattr(releases, "FOLDER", tmp_path)
    return answers


@pytest.mark.usefixtures("history")
def test_the_last_release_and_the_anchor_are_unpacked(tmp_path: Path) -> None:
    assert [release.version for release in releases.releases()] == ["0.3.0", "0.2.0", "0.1.0"]
    last, anchor = releases.compared()
    assert (last.version, anchor.version) == ("0.3.0", "0.2.0")
    folder = releases.unpacked(last)
    assert folder == tmp_path / "0.3.0-cccccccc"
    assert 'version = "0.3.0"' in (folder / "pyproject.toml").read_text(encoding="utf-8")


def test_a_release_is_not_compared_with_itself(history: History) -> None:
    history.head = "c" * 40
    assert [release.version for release in releases.compared()] == ["0.2.0"]


def test_releases_in_the_history_of_this_project() -> None:
    """None where there is no git, no history, or only its last commit."""
    try:
        versions = [release.version for release in releases.releases()]
    except NoReleaseError:
        versions = []
    assert versions == [] or versions[-3:] == ["0.3.0", "0.2.0", "0.1.0"]


def test_without_a_history_there_is_no_target_to_miss(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(releases, "ROOT", tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    (row,) = releases.rows()
    assert (row.value, row.met) == (None, None)


STEP, PIER = "step, HDR specimen [us]", "pier P1 on LHDR, 8000 steps, in lockstep [ms]"


def test_ratios_are_of_calculations_that_both_have() -> None:
    now = fastest([{STEP: 0.3, PIER: 1.0}, {STEP: 0.2, PIER: 2.0}])
    assert now == {STEP: 0.2, PIER: 1.0}
    (row,) = ratio_rows(Release("0.3.0", "a" * 40), {STEP: 0.4}, now)
    assert (row.value, row.met) == (pytest.approx(0.5), True)


def test_of_the_anchor_only_steps_are_compared() -> None:
    (row,) = ratio_rows(Release("0.2.0", "a" * 40), {STEP: 0.4, PIER: 2.0}, {STEP: 0.36, PIER: 1.0})
    assert (row.value, row.met) == (pytest.approx(0.9), False)


def test_the_calculations_are_steps_and_piers() -> None:
    names = list(release_times.CALCULATIONS)
    assert {STEP, PIER} < set(names)
    assert all(name.endswith(("[us]", "[ms]")) for name in names)
