"""An imported frame, and the structure that it becomes, in OpenSees."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.cross_code.test_opensees_script import executed
from tests.opensees import needs_opensees, ops
from tests.verification.frames import PIER_PYTHON
from thermobearing.structure.fields import GROUND
from thermobearing.structure.frame import Element, Frame, Node

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "frame_table.py"


@needs_opensees
def test_a_frame_has_the_periods_of_opensees(tmp_path: Path) -> None:
    """The table that the example's function writes; then the structure, exported, in OpenSees."""
    write_frame = runpy.run_path(str(EXAMPLE))["write_frame"]
    end = "import math\nperiods = [2.0 * math.pi / value**0.5 for value in values]\n"
    periods = executed(PIER_PYTHON + end)
    write_frame(ops, tmp_path / "frame.csv")
    imported = tb.import_frame(tmp_path / "frame.csv")
    assert imported.mass == pytest.approx(1e-3 * (227.5 + 206.3 + 140 + 400 + 2.0 * 3.75))
    assert_allclose(imported.frame.modes().periods[:4], periods[:4], rtol=tol.SAME_FRAME)
    tb.opensees.write_structure(imported.structure, tmp_path / "again.py")
    again = executed((tmp_path / "again.py").read_text())
    assert_allclose(again, imported.table["period_s"], rtol=tol.OPENSEES_SCRIPT_PERIODS)


@needs_opensees
def test_inclined_members_as_in_opensees() -> None:
    """Members in any direction, a rigid link, a spring and equal displacements."""
    places = {"1": (0.0, 0.0), "2": (1.5, 5.0), "3": (7.0, 6.5), "4": (9.0, 0.0), "5": (7.5, 7.5)}
    masses = {"2": (30.0, 20.0, 4.0), "3": (50.0, 45.0, 0.0), "5": (10.0, 12.0, 3.0)}
    none = (0.0, 0.0, 0.0)
    nodes = {name: Node(*at, masses.get(name, none), "") for name, at in places.items()}
    law = 2.5e7 * 0.8, 2.5e7 * 0.1
    pairs = [("1", "2"), ("2", "3"), ("4", "3")]
    elements = [Element("", pair, law, "") for pair in pairs]
    elements += [Element("", ("3", "5"), None, ""), Element("", (GROUND, "1"), (2e5, 3e5, 4e5), "")]
    frame = Frame("", nodes, elements, {"4": (True, True, False)}, [("2", "4", 2)])
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for name, node in nodes.items():
        ops.node(int(name), node.x, node.z, "-mass", *node.mass)
    ops.node(9, 0.0, 0.0)
    ops.fix(9, 1, 1, 1)
    ops.fix(4, 1, 1, 0)
    ops.geomTransf("Linear", 1)
    for tag, (first, second) in enumerate(pairs, 1):
        ops.element("elasticBeamColumn", tag, int(first), int(second), 0.8, 2.5e7, 0.1, 1)
    for way, size in enumerate((2e5, 3e5, 4e5), 1):
        ops.uniaxialMaterial("Elastic", way, size)
    ops.element("zeroLength", 10, 9, 1, "-mat", 1, 2, 3, "-dir", 1, 2, 3)
    ops.rigidLink("beam", 3, 5)
    ops.equalDOF(2, 4, 3)
    periods = 2.0 * np.pi / np.sqrt(ops.eigen("-fullGenLapack", 5))
    assert_allclose(frame.modes().periods[:5], periods, rtol=tol.SAME_FRAME)
