"""What `make dist` leaves for a page of releases, and the make targets that CI calls."""

import hashlib
import re
import subprocess
import tomllib
from pathlib import Path

import pytest

import thermobearing
from docs import release
from tests.distribution import check_sums

ROOT = Path(__file__).parents[2]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
WORKFLOW = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
RUN = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LISTED = {
    *("thermobearing-{}-py3-none-any.whl", "thermobearing-{}.tar.gz"),
    *("bearing.html", "report-example.html", "report-example.pdf", "verify.html"),
    *("CITATION.cff", "SHA256SUMS", "notes.md"),
}


def dry_run(*words: str) -> str:
    """Return the lines that make would run."""
    command = ["make", "--dry-run", *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def make_targets(text: str) -> set[str]:
    """Return the phony targets that lines of a description of CI call."""
    text = re.sub(r"(^| )#.*", "", text, flags=re.MULTILINE)
    lines = re.findall(r"(?:^|[ '(:])make ((?:[\w./=\" -]|\\\n)+)", text, re.MULTILINE)
    words = {word for line in lines for word in line.split() if "=" not in word}
    return {word for word in words if re.fullmatch(r"[a-z][a-z-]+", word)}


def writes_its_files(*words: str) -> None:
    """Write what a command of the release would, in a moment."""
    target = next(Path(word) for word in reversed(words) if "/" in word)
    if words[0] != "bridge":
        target.write_text(words[0], encoding="utf-8")
        return
    target.mkdir()
    for suffix in ("html", "pdf"):
        (target / f"report.{suffix}").write_text(suffix, encoding="utf-8")


def test_a_release_has_all_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    version = thermobearing.__version__
    expected = {name.format(version) for name in LISTED}
    assert release.release_files(version) == expected
    for name in release.PACKAGES:
        (tmp_path / name.format(version=version)).write_text(name, encoding="utf-8")
    monkeypatch.setattr(release, "run_program", writes_its_files)
    release.write_release(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == expected
    sums = dict(reversed(line.split("  ")) for line in (tmp_path / release.SUMS).open())
    assert {name.strip() for name in sums} == expected - {release.SUMS}
    for name, digest in sums.items():
        assert digest == hashlib.sha256((tmp_path / name.strip()).read_bytes()).hexdigest()
    assert (tmp_path / "notes.md").read_text(encoding="utf-8").startswith("## ")
    check_sums(tmp_path)
    (tmp_path / "notes.md").write_text("other", encoding="utf-8")
    with pytest.raises(SystemExit, match=r"notes\.md"):
        check_sums(tmp_path)


def test_the_notes_are_the_newest_section_with_lines() -> None:
    text = "# Changelog\n\n## Unreleased\n\n## 0.4.0\n\n* New.\n\n## 0.3.0\n\n* Old.\n"
    assert release.release_notes(text) == "## 0.4.0\n\n* New.\n"
    with pytest.raises(ValueError, match="no section"):
        release.release_notes("# Changelog\n\n## Unreleased\n")


def test_make_dist_and_release_write_these_files() -> None:
    lines = dry_run("dist")
    steps = [
        lines.index(step) for step in ("-m kernels all", "hatchling build", "docs.release dist")
    ]
    assert steps == sorted(steps)
    recipe = MAKEFILE.partition("\nrelease:")[2].partition("\n\n")[0]
    assert "$(MAKE) dist" in recipe.splitlines()[-1]


@pytest.mark.parametrize("text", [WORKFLOW, RUN], ids=["workflow", "script"])
def test_ci_calls_targets_that_exist(text: str) -> None:
    phony = re.search(r"^\.PHONY: (.*)$", MAKEFILE, re.MULTILINE)
    assert phony
    called = make_targets(text)
    assert len(called) >= 6
    assert called <= set(phony[1].split())


def test_the_workflow_calls_what_the_script_calls() -> None:
    assert make_targets(RUN) <= make_targets(WORKFLOW)
    classifiers = " ".join(PROJECT["classifiers"])
    versions = re.findall(r"Python :: (3\.\d+)", classifiers)
    (matrix,) = re.findall(r"python: \[(.*)\]", WORKFLOW)
    assert re.findall(r"3\.\d+", matrix) == versions
    (systems,) = re.findall(r"system: \[(.*)\]", WORKFLOW)
    assert [name.partition("-")[0] for name in systems.split(", ")] == [
        "ubuntu",
        "macos",
        "windows",
    ]
