"""Limits of address space, as of `ulimit -v`: a sentence within seconds, whatever the limit is."""

import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from thermobearing.border.threads import NEEDED

SECONDS = 60.0  # a last resort: an allocation that is tried for ever takes all of them
PROGRAM = """
    import resource
    from thermobearing.cli import main
    resource.setrlimit(resource.RLIMIT_AS, ({limit}, {limit}))
    main()
"""


def limited(megabytes: float, words: list[str]) -> "subprocess.CompletedProcess[str]":
    pytest.importorskip("resource")  # not on Windows
    program = dedent(PROGRAM).format(limit=int(1e6 * megabytes))
    return subprocess.run(
        [sys.executable, "-c", program, *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=SECONDS,
    )


@pytest.mark.parametrize("megabytes", [160, 280, 380, 420, 440, 460, 480, 500, 560])
def test_too_little_for_an_analysis(megabytes: float, tmp_path: Path) -> None:
    """OpenBLAS asked for its buffers for ever at 460 MB, and HDF5 crashed at 560."""
    words = ["cyclic", "--bearing", "shen-hdr-specimen", "--ambient", "-20"]
    ended = limited(megabytes, [*words, "-o", str(tmp_path / "out")])
    assert ended.returncode == 2, ended.stderr
    assert ended.stderr.count("\n") == 1
    assert "ulimit -v" in ended.stderr
    assert not list(tmp_path.iterdir())


def test_enough_for_an_analysis(tmp_path: Path) -> None:
    words = ["cyclic", "--bearing", "shen-hdr-specimen", "--ambient", "-20"]
    ended = limited(2.5e-6 * NEEDED, [*words, "-o", str(tmp_path / "out")])
    assert ended.returncode == 0, ended.stderr
