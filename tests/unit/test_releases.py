"""Earlier releases that benchmarks build beside the present; nothing is timed here."""

import subprocess
from pathlib import Path

import pytest

from benchmarks import release_times, releases
from benchmarks.releases import Release, fastest, ratio_rows

AUTHOR = ("-c", "user.name=Name", "-c", "user.email=name@example.org")


@pytest.fixture
def history(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with three versions, and a commit after the last."""
    monkeypatch.setattr(releases, "ROOT", tmp_path)
    monkeypatch.setattr(releases, "FOLDER", tmp_path / "build" / "releases")
    releases.git("init", "--quiet")
    for name in ("src", "benchmarks", "tests"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("")
    project = tmp_path / "pyproject.toml"
    for version in ("0.1.0", "0.2.0", "0.3.0"):
        project.write_text(f'[project]\nname = "p"\nversion = "{version}"\n')
        releases.git("add", ".")
        releases.git(*AUTHOR, "commit", "--quiet", "--message", version)
    project.write_text(project.read_text().replace('"p"', '"other"'))
    releases.git(*AUTHOR, "commit", "--quiet", "--all", "--message", "later")
    return tmp_path


def test_releases_are_the_commits_that_changed_the_version(history: Path) -> None:
    assert [release.version for release in releases.releases()] == ["0.3.0", "0.2.0", "0.1.0"]
    assert [release.version for release in releases.compared()] == ["0.3.0", "0.2.0"]
    folder = releases.unpacked(releases.compared()[0])
    assert folder.parent == history / "build" / "releases"
    assert 'version = "0.3.0"' in (folder / "pyproject.toml").read_text()
    assert 'name = "p"' in (folder / "pyproject.toml").read_text()


def test_a_release_is_not_compared_with_itself(history: Path) -> None:
    subprocess.run(["git", "checkout", "--quiet", "HEAD~"], cwd=history, check=True)
    assert [release.version for release in releases.compared()] == ["0.2.0"]


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
