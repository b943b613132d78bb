"""What a stranger gets from a package index: the wheel works by itself, the sdist holds no more."""

import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NEEDED = {"src", "README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE", "pyproject.toml"}
MADE = {"PKG-INFO", ".gitignore"}  # by the build itself
USE = """
import sys
import thermobearing as tb
assert tb.__file__.startswith(sys.argv[1]), tb.__file__
test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.1)
print(tb.run("lrb-example", test, ambient=-20).outcome)
print(len(tb.list_motions()), tb.load_structure("pier-p1").name)
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel and the sdist."""
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "-d", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.thorough
def test_wheel_works_outside_the_repository(built: Path, tmp_path: Path) -> None:
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(tmp_path)
    assert (tmp_path / "thermobearing" / "py.typed").exists()
    assert (tmp_path / "thermobearing" / "__init__.pyi").exists()
    sys_path_first = f"import sys; sys.path.insert(0, sys.argv[1])\n{USE}"
    done = subprocess.run(
        [sys.executable, "-P", "-c", sys_path_first, str(tmp_path)],
        cwd=tmp_path,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},  # nothing is in the cache for this place
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["completed", "18", "pier-p1"]


def test_sdist_holds_what_is_needed(built: Path) -> None:
    (sdist,) = built.glob("*.tar.gz")
    with tarfile.open(sdist) as packed:
        names = packed.getnames()
    parts = [Path(name).parts for name in names]
    assert {part[1] for part in parts} - MADE == NEEDED
    sources = [part for part in parts if part[1] == "src"]
    assert {Path(*part).suffix for part in sources} == {
        ".py",
        ".pyi",
        ".toml",
        ".npz",
        ".typed",
        ".md",
        *(".css", ".html", ".js", ".typ"),  # of reports
    }
