"""Circular plasticity in a horizontal plane against ElastomericBearingPlasticity of OpenSees."""

import math

import numpy as np
import pytest

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import analyse, needs_opensees, ops
from tests.verification.test_plane import circle, moved, wandering
from thermobearing.core.types import Floats
from thermobearing.model.earlier import BilinearParameters, bilinear_constants

pytestmark = needs_opensees

STRENGTH, POST_YIELD, INITIAL = 120.0, 1.2, 15.0  # kN, kN/mm, kN/mm


def eight(size: float, steps: int) -> Floats:
    angle = 2.0 * math.pi * np.arange(1, 2 * steps + 1) / steps
    return size * np.stack([np.sin(angle), 0.5 * np.sin(2.0 * angle)], axis=1)


PATHS = {
    "circle": circle(150.0, 2, 400),
    "eight": eight(150.0, 400),
    "random walk": wandering(150.0, 800),
}


def opensees_forces(x: Floats) -> Floats:
    """Forces [steps, 2] of a bearing along displacements [steps, 2], in kN and mm."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node, free in ((1, 1), (2, 0)):
        ops.node(node, 0.0, 0.0, 0.0)
        ops.fix(node, free, free, free, 1, 1, 1)
    ops.uniaxialMaterial("Elastic", 1, 1000.0)
    others = [part for name in ("-P", "-T", "-My", "-Mz") for part in (name, 1)]
    ratios = (POST_YIELD / INITIAL, 0.0, 1.0)  # linear and other hardening, its exponent
    axes = ("-orient", 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    ops.element("elastomericBearingPlasticity", 1, 1, 2, INITIAL, STRENGTH, *ratios, *others, *axes)
    for k in (0, 1):
        values = (
            0.0,
            *x[:, k].tolist(),
            x[-1, k],
        )  # one more, for the end of a series is not in it
        ops.timeSeries("Path", k + 1, "-dt", 1.0, "-values", *values)
        ops.pattern("Plain", k + 1, k + 1)
        ops.sp(2, k + 1, 1.0)
    analyse("LoadControl", 1.0, most=20, system="FullGeneral")
    forces = []
    for _ in x:
        assert ops.analyze(1) == 0
        forces.append(ops.eleForce(1)[6:8])
    ops.wipe()
    return np.array(forces)


@pytest.mark.parametrize("name", PATHS)
def test_lead_in_a_plane_against_opensees(name: str, measured: Recorder) -> None:
    x = PATHS[name]
    constants = bilinear_constants(BilinearParameters(STRENGTH, POST_YIELD, INITIAL))
    rows, _ = moved(constants, x, 20.0)
    ours, theirs = rows.books["force"], opensees_forces(x)
    apart = np.abs(ours - theirs).max() / np.linalg.norm(theirs, axis=1).max()
    assert apart < tol.OPENSEES_PLANE
    measured(
        f"bilinear bearing in a plane, {name}, complete history of forces against OpenSees",
        f"{apart:.1e}",
        f"{tol.OPENSEES_PLANE:g}",
    )
