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


def test_too_little_for_numpy_and_scipy() -> None:
    ended = limited(0.5e-6 * NEEDED, ["cyclic", "--bearing", "shen-hdr-specimen"])
    assert ended.returncode == 2, ended.stderr
    assert ended.stderr.count("\n") == 1
    assert "ulimit -v" in ended.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("megabytes", [380, 420, 440, 460, 480, 500])
def test_too_little_for_an_analysis(megabytes: int, tmp_path: Path) -> None:
    """OpenBLAS asked for its buffers for ever at 460 MB."""
    words = ["cyclic", "--bearing", "shen-hdr-specimen", "--ambient", "-20"]
    ended = limited(megabytes, [*words, "-o", str(tmp_path / "out")])
    assert ended.returncode in (0, 2), ended.stderr
    if ended.returncode:
        # The library that writes netCDF has a message of its own.
        assert "not enough memory" in ended.stderr or "cannot be written" in ended.stderr
        assert ended.stderr.count("\n") == 1
        assert not list(tmp_path.iterdir())
