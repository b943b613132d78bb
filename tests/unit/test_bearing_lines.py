"""Bearing lines side by side: any number of them, of one kind or of several."""

import os
import subprocess
import sys

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from tests import tolerances as tol
from tests.verification.structures import ground_of, linear_bearing, real_bearing, shaken
from thermobearing.core.types import Floats
from thermobearing.structure.forces import build_bearings
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.newmark import newmark_march
from thermobearing.structure.run import Line, StructureHistory, prepare_structure, run_structure

DT = 0.005


def pier_of(counts: list[int]) -> Structure:
    """Pier P1 with its bearings in several lines."""
    structure = load_structure("pier-p1")
    line = structure.bearings[0]
    lines = [
        line.model_copy(update={"name": str(k), "count": count}) for k, count in enumerate(counts)
    ]
    return structure.model_copy(update={"bearings": lines})


def test_five_bearings_in_any_number_of_lines_are_the_same() -> None:
    ground = ground_of("jra-ii-i-1", DT, 8.0)
    constants = real_bearing("shen-lhdr-bridge")
    _, one = shaken(pier_of([5]), constants, ground, DT)
    compiled = len(newmark_march.signatures)  # type: ignore[attr-defined]
    for counts in ([2, 3], [1, 1, 1, 1, 1]):
        _, other = shaken(pier_of(counts), constants, ground, DT)
        assert_allclose(other.rows.q, one.rows.q, atol=tol.SAME_MOTION * np.abs(one.rows.q).max())
        for line in range(len(counts)):
            warmed = one.layers().max() - one.layers().min()
            assert_allclose(other.layers(line), one.layers(), atol=tol.SAME_MOTION * warmed)
        assert_array_equal(other.bearing(1)["force"], other.bearing(0)["force"])
    assert len(newmark_march.signatures) == compiled  # type: ignore[attr-defined]


def test_lines_start_at_temperatures_of_their_own() -> None:
    ground = ground_of("jra-ii-i-1", DT, 4.0)
    constants = real_bearing("shen-hdr-bridge")
    cells = len(constants.cells.capacity)
    lines = [Line(constants, np.full(cells, t)) for t in (-20.0, 20.0)]
    history = run_structure(
        prepare_structure(pier_of([2, 3])), lines, ground, DT, np.zeros(len(ground) - 1)
    )
    assert_array_equal(history.layers(0)[0], -20.0)
    assert_array_equal(history.layers(1)[0], 20.0)
    cold, warm = (np.abs(history.bearing(line)["force"]).max() for line in (0, 1))
    assert cold > warm


def test_lines_of_one_kind_share_their_constants() -> None:
    a, b = linear_bearing(1.0), real_bearing("shen-hdr-bridge")
    starts = [np.full(len(one.cells.capacity), 7.0) for one in (a, b, a)]
    kinds = build_bearings([a, b, a], starts, [None, None, None])
    assert [list(kind.lines) for kind in kinds] == [[0, 2], [1]]
    assert kinds[0].constants is a
    assert kinds[0].states.temperature.shape == (2, len(a.cells.capacity))
    assert kinds[1].states.temperature.shape == (1, len(b.cells.capacity))


def shake_unlike_lines() -> tuple[StructureHistory, StructureHistory]:
    structure, ground = pier_of([1, 1]), ground_of("jra-ii-i-1", DT, 0.3)
    both = [linear_bearing(4.0), linear_bearing(9.0)]
    prepared = prepare_structure(structure)

    def shake(lines: list[Line]) -> StructureHistory:
        return run_structure(prepared, lines, ground, DT, np.zeros(len(ground) - 1))

    start: Floats = np.zeros(len(both[0].cells.capacity))
    mean = linear_bearing(6.5)
    return shake([Line(one, start) for one in both]), shake([Line(mean, start)] * 2)


def test_lines_of_several_kinds() -> None:
    """As plain Python: compiling for a second kind takes longer than all other tests here."""
    code = "from tests.unit.test_bearing_lines import check_unlike_lines; check_unlike_lines()"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def check_unlike_lines() -> None:
    unlike, alike = shake_unlike_lines()
    largest = np.abs(alike.rows.q).max()
    assert largest > 0.0
    assert_allclose(unlike.rows.q, alike.rows.q, atol=tol.SAME_MOTION * largest)
    forces = [np.abs(unlike.bearing(line)["force"]).max() for line in (0, 1)]
    assert_allclose(forces[1] / forces[0], 9.0 / 4.0, rtol=tol.SAME_MOTION)
    assert unlike.layers(1).shape == alike.layers(1).shape
