"""A girder bridge in OpenSees, on served bearings, against the structure of this package."""

from itertools import product

import pytest

from benchmarks.opensees_girder import (
    AMBIENTS,
    BEARINGS,
    DURATION,
    Histories,
    cut,
    draw,
    in_opensees,
    ours,
    peaks,
)
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import needs_opensees

pytestmark = needs_opensees


def compare(both: tuple[Histories, Histories]) -> tuple[float, float]:
    """Return the largest difference of the peaks: of bearings, of piers."""
    table = peaks(*both)
    piers, off = table["peak"].str.startswith("top"), table["difference_%"].abs() / 100.0
    assert len(table) == 8
    return float(off[~piers].max()), float(off[piers].max())


@pytest.mark.thorough  # as test_opensees_serve.py and test_opensees_plan.py on smaller structures
def test_a_second_of_the_bridge_with_rigid_piers(measured: Recorder) -> None:
    """The same assumptions in both, lines of two temperatures, the strong part of the motion."""
    motion = cut(7.0, 1.5)
    both = ours(BEARINGS[0], -20.0, motion), in_opensees(BEARINGS[0], -20.0, motion, rigid=True)
    off = compare(both)
    assert max(off) < tol.OPENSEES_GIRDER_RIGID
    measured(
        "five-span girder bridge, rigid piers, peaks against OpenSees: bearings, piers",
        f"{off[0]:.1e}, {off[1]:.1e}",
        f"{tol.OPENSEES_GIRDER_RIGID:g}",
    )
    for one in both:
        warmer = max(abs(one.force["P2"])) / max(abs(one.force["P1"]))
        assert 0.93 < warmer < 0.96
        assert max(abs(one.displacement["P2"])) > max(abs(one.displacement["P1"]))
    assert len(draw({(BEARINGS[0], -20.0): both}).axes) == 2


@pytest.mark.thorough
@pytest.mark.parametrize(("bearing", "ambient"), list(product(BEARINGS, AMBIENTS)))
def test_the_bridge(bearing: str, ambient: float, measured: Recorder) -> None:
    motion = cut(0.0, DURATION)
    off = compare((ours(bearing, ambient, motion), in_opensees(bearing, ambient, motion)))
    assert off[0] < tol.OPENSEES_GIRDER_BEARINGS
    assert off[1] < tol.OPENSEES_GIRDER_PIERS
    measured(
        f"five-span girder bridge, {bearing}, {ambient:g} degC, peaks against OpenSees: "
        "bearings, piers",
        f"{off[0]:.1%}, {off[1]:.1%}",
        f"{tol.OPENSEES_GIRDER_BEARINGS:.0%}, {tol.OPENSEES_GIRDER_PIERS:.0%}",
    )
