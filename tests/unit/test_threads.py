"""BLAS has one thread in the command and in the tests, unless the environment says otherwise."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from thermobearing.border.threads import VARIABLES

ROOT = Path(__file__).parents[2]
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
print(os.environ["OPENBLAS_NUM_THREADS"], len(os.listdir(tasks)) if os.path.exists(tasks) else 1)
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
