"""What is imported is declared with bounds; BLAS has one thread unless told otherwise."""

import ast
import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from thermobearing.border.threads import VARIABLES

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
# Tools of developers and openseespy, a peer of the tests, may be of any version.
EXTRAS = [
    text
    for extra, some in PROJECT["optional-dependencies"].items()
    for text in some
    if extra != "lint" and "openseespy" not in text
]


def plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def declared(texts: list[str]) -> set[str]:
    return {plain(re.split(r"[<>=!~;\[ ]", text)[0]) for text in texts}


def imported() -> set[str]:
    found = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.split(".")[0])
    return found - set(sys.stdlib_module_names) - {"thermobearing"}


def test_what_is_imported_is_declared() -> None:
    known = declared([*PROJECT["dependencies"], *EXTRAS])
    owners = packages_distributions()
    missing = {
        name
        for name in imported()
        if not known & {plain(owner) for owner in owners.get(name, [name])}
    }
    assert not missing


def test_every_dependency_has_an_upper_bound() -> None:
    open_ended = [
        text for text in [*PROJECT["dependencies"], *EXTRAS] if "<" not in text.split(";")[0]
    ]
    assert open_ended == []


COMMAND = """
import contextlib, sys
from thermobearing.cli import main
sys.argv = ["thermobearing", "motions", "show", "jra-ii-i-1", "-q"]
with contextlib.suppress(SystemExit):
    main()
"""
TESTS = "import conftest\nimport numpy, scipy.linalg\n"
ASK = """
import os
assert "numpy" in sys.modules and "scipy.linalg" in sys.modules
tasks = "/proc/self/task"  # only Linux tells how many threads there are
threads = os.listdir(tasks) if os.path.exists(tasks) else ["self"]
names = [open(f"{tasks}/{task}/comm").read() for task in threads if task != "self"] or ["python"]
print(os.environ["OPENBLAS_NUM_THREADS"], sum("jemalloc" not in name for name in names))
"""


def told(begin: str, **environment: str) -> list[str]:
    clean = {key: value for key, value in os.environ.items() if key not in VARIABLES}
    done = subprocess.run(
        [sys.executable, "-c", "import sys\n" + begin + ASK],
        cwd=ROOT,
        env=clean | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()[-1].split()


@pytest.mark.parametrize("begin", [COMMAND, TESTS], ids=["command", "tests"])
def test_blas_has_one_thread(begin: str) -> None:
    assert told(begin) == ["1", "1"]


def test_the_environment_may_say_otherwise() -> None:
    assert told(COMMAND, OPENBLAS_NUM_THREADS="2")[0] == "2"
