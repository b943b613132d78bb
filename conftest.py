"""Before any test: one thread for BLAS, byte code kept, and the kernels compiled once."""

import gc
import os
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest
from typer import testing

from thermobearing.border.threads import one_blas_thread

one_blas_thread()  # before numpy is imported; the workers of pytest-xdist inherit it

# Where Python is set to keep no byte code, every worker and every program that a test starts
# would compile all sources again. What is kept lies in __pycache__, which git ignores.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# The commands with all their options are made once, and not for each call in a test.
testing._get_command = cache(testing._get_command)

# Doctests are collected from every module: not from one whose package is not installed.
NEEDS_ELEMENTS = "src/thermobearing/verify/finite_elements.py"
collect_ignore = [] if find_spec("skfem") else [NEEDS_ELEMENTS]
if not find_spec("importlinter"):  # of the extra `lint`
    collect_ignore.append("tests/circles.py")

pytest_plugins = ["tests.fixtures.kernels", "tests.fixtures.study"]


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config: pytest.Config) -> None:
    """Compile on all cores before the workers start, who would wait for each other.

    They find the machine code in its folder, where a stamp says that all is compiled. In a separate
    process, so that code that does not compile fails the tests that need it, and not all.
    """
    from thermobearing.core.compiled.native import open_library
    from thermobearing.core.compiled.sources import cache_directory

    if open_library()[0] is not None:
        return
    folder = cache_directory()
    stamp = folder / "all-for-tests" if folder else None
    if not (config.option.collectonly or (stamp and stamp.exists())):
        command = [sys.executable, "-m", "kernels", "cache"]
        done = subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, check=False)
        if stamp and done.returncode == 0:
            stamp.touch()


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """Collect garbage seldom, and not among what is imported, which took a tenth of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(10_000, 20, 50)
