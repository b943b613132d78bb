"""Both structures with linear and bilinear bearings against OpenSees."""

import numpy as np
import pytest

from benchmarks.opensees_pier_figure import draw
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import needs_opensees, ops
from tests.reference.opensees_pier import build, spring_bearing
from tests.reference.pier_comparison import compare
from tests.verification.structures import linear_bearing, shaken
from thermobearing.core.types import Floats

pytestmark = needs_opensees

DT = 0.005


@pytest.mark.parametrize("name", ["pier-p1", "hybrid-pier"])
@pytest.mark.parametrize("kind", ["linear", "bilinear"])
def test_structure_against_opensees(name: str, kind: str, measured: Recorder) -> None:
    ours, theirs = compare(name, kind)
    for quantity, values in ours.items():
        reference = theirs[quantity]
        largest = np.abs(reference).max()
        peak = abs(np.abs(values).max() / largest - 1.0)
        whole = np.abs(values - reference).max() / largest
        assert peak < tol.OPENSEES_PEAK, quantity
        assert whole < tol.OPENSEES_HISTORY, quantity
        measured(
            f"{name}, {kind} bearings, {quantity} against OpenSees: peak, whole history",
            f"{peak:.1e}, {whole:.1e}",
            f"{tol.OPENSEES_PEAK:g}, {tol.OPENSEES_HISTORY:g}",
        )


def test_periods_of_pier_p1_against_opensees(measured: Recorder) -> None:
    ground: Floats = np.zeros(3)
    prepared, _ = shaken("pier-p1", linear_bearing(2.6153), ground, DT)
    build(prepared, spring_bearing(2.6153, 5), ground, DT, (0.0, 0.0))
    theirs = 2.0 * np.pi / np.sqrt(np.array(ops.eigen("-fullGenLapack", 4)))
    ops.wipe()
    worst = float(np.abs(prepared.modes.periods / theirs - 1.0).max())
    assert worst < tol.OPENSEES_PERIODS
    measured(
        "four periods of pier P1 against OpenSees", f"{worst:.1e}", f"{tol.OPENSEES_PERIODS:g}"
    )


def test_figure_of_both() -> None:
    """The figure of docs/verification.md is drawn from the same runs."""
    assert len(draw("hybrid-pier", "bilinear").axes) == 4
