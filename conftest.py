"""Before any test: one thread for BLAS, and the kernels compiled once."""

import subprocess
import sys
from pathlib import Path

import pytest

from thermobearing.commands.threads import one_blas_thread

one_blas_thread()  # before numpy is imported; the workers of pytest-xdist inherit it

COMPILE = """
import thermobearing as tb
tb.run("shen-lhdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05))
tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", -20.0, duration=0.1)
tb.hybrid("shen-lhdr-specimen", ambient=-20.0, duration=0.1, laboratory={"mode": "pd"})
tb.motions.response_spectrum(tb.load_motion("jra-ii-i-1"), [1.0])
"""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config: pytest.Config) -> None:
    """Compile before the workers start, who would all do the same at the same time.

    They find the machine code in its folder. In a process of its own, so that code that does
    not compile fails the tests that need it, and not all of them.
    """
    if not config.option.collectonly:
        command = [sys.executable, "-c", COMPILE]
        subprocess.run(command, cwd=Path(__file__).parent, capture_output=True, check=False)
