"""Laws of a command: they end with it, and another thread does not see them."""

import contextlib
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.laws import ARRHENIUS
from tests.unit.test_laws import HDR, SHORT
from thermobearing import laws
from thermobearing.cli import app

pytestmark = pytest.mark.usefixtures("no_other_laws")


def test_a_command_leaves_no_law_to_the_next_one(law_file: Path, tmp_path: Path) -> None:
    words = ["cyclic", "--strain", "0.2", "--cycles", "1", "--ambient", "-20", "--no-figures"]
    forces = []
    for number, options in enumerate(([], ["--law", str(law_file)], [])):
        out = tmp_path / str(number)
        done = CliRunner().invoke(app, [*words, *options, "-o", str(out)])
        assert done.exit_code == 0, done.output
        forces.append(tb.load_result(out)["force"].values)
    assert_array_equal(forces[0], forces[2])
    assert not np.array_equal(forces[0], forces[1])
    out = tmp_path / "by-name"
    done = CliRunner().invoke(app, [*words, "--law", "arrhenius", "-o", str(out)])
    assert done.exit_code == 2  # as in a process of its own


def test_two_threads_have_laws_of_their_own(tmp_path: Path) -> None:
    """Two laws of one name, each in a file of a folder, are applied at the same time."""
    barrier = threading.Barrier(3, timeout=60)

    def force(elastic: float | None) -> tuple[float, float]:
        with contextlib.ExitStack() as stack:
            if elastic is not None:
                folder = tmp_path / f"{elastic:g}"
                folder.mkdir()
                law_file = folder / "my_law.py"
                law_file.write_text(ARRHENIUS.replace("elastic=300.0", f"elastic={elastic}"))
                stack.enter_context(laws.applied([law_file]))
            barrier.wait()
            cyclic = tb.run(HDR, SHORT, ambient=-20)
            # Its runs are on further threads, which need no register.
            bridge = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", -20, duration=3)
            barrier.wait()
        return float(cyclic["force"].max()), float(bridge["bearing_force"].max())

    choices = (None, 300.0, 900.0)
    with ThreadPoolExecutor(3) as threads:
        together = list(threads.map(force, choices))
    assert len({pair[0] for pair in together}) == len({pair[1] for pair in together}) == 3
    assert not laws._REGISTERED
    for elastic, (cyclic_force, _) in zip(choices, together, strict=True):
        alone = tb.load_bearing(HDR)
        if elastic is not None:
            tb.laws.load(tmp_path / f"{elastic:g}" / "my_law.py")
            alone = tb.changed_bearing(HDR, law="arrhenius")
        assert float(tb.run(alone, SHORT, ambient=-20)["force"].max()) == cyclic_force


def test_a_file_that_fails_registers_nothing(law_file: Path) -> None:
    law_file.write_text(f"{ARRHENIUS}raise ValueError('last line')\n")
    with pytest.raises(tb.InputError, match="last line"):
        tb.laws.load(law_file)
    assert not laws.known_laws().keys() - laws.built_in_laws().keys()
