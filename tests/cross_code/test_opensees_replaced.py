"""Bearings of OpenSees that are replaced by served ones, in a model in space."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.cross_code.test_opensees_plane import lead_rubber_x, plasticity
from tests.cross_code.test_opensees_serve import AMBIENT, BEARING, DT, GROUND, MASS, PLAIN
from tests.opensees import analyse, needs_opensees, ops
from thermobearing.core.types import Floats
from thermobearing.opensees.line import Line, replace_elements, serve

pytestmark = needs_opensees

STRONG, STEPS = 800, 300  # of the motion: where it begins to be strong, and how much of it
MAKERS = {"ElastomericBearingPlasticity3d": plasticity, "LeadRubberX": lead_rubber_x}


def nodes_in_space(height: float = 0.0, dofs: int = 6) -> None:
    """A mass above a fixed node, which moves in the plane only."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", dofs)
    ops.node(1, 0.0, 0.0, 0.0)
    ops.node(2, 0.0, 0.0, height, "-mass", *([MASS] * 3 + [MASS * 1e6] * 3)[:dofs])
    ops.fix(1, *[1] * dofs)
    ops.uniaxialMaterial("Elastic", 1, 1000.0)


def shaken() -> Floats:
    """Displacements [steps, 2] of the mass under a motion along a line in the plane."""
    for axis, share in ((1, 1.0), (2, 0.5)):
        ops.timeSeries("Path", axis, "-dt", DT, "-values", *(share * GROUND[STRONG:]))
        ops.pattern("UniformExcitation", axis, axis, "-accel", axis)
    analyse(tolerance=1e-11, **PLAIN)
    rows = []
    for _ in range(STEPS):
        assert ops.analyze(1, DT) == 0
        rows.append(ops.nodeDisp(2)[:2])
    return np.array(rows)


@pytest.mark.parametrize("kind", MAKERS)
def test_a_replaced_bearing_is_the_served_one(kind: str) -> None:
    """The same motion as of a model made with the served bearing; forces of the same element."""
    with serve(BEARING, ambient=AMBIENT) as line:
        nodes_in_space()
        ops.element(*line.element(1, (1, 2), directions=(1, 2), vertical=3))
        expected = shaken()
        nodes_in_space()
        MAKERS[kind]()
        assert replace_elements(ops, 1, line) == {1: kind}
        assert ops.eleType(1) != kind
        replaced = shaken()
        force = np.array(ops.eleForce(1)[6:8])
        ops.wipe()
    assert (replaced == expected).all()
    assert np.abs(replaced).max() > 50.0
    element = tb.element(BEARING, ambient=AMBIENT, components=2)
    for place in replaced.tolist():
        resistance = element.set_trial(tuple(place), dt=DT).force
        element.commit()
    assert force == pytest.approx(np.asarray(resistance), rel=tol.OPENSEES_SERVED)


def test_an_exported_structure_with_its_heat_is_that_of_this_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pier P1 of `write_structure`, on served bearings, against the same damping and step here."""
    monkeypatch.chdir(tmp_path)
    bearing, motion, duration = "shen-lhdr-bridge", "jra-ii-i-1", 13.0
    tb.opensees.write_structure("pier-p1", "pier.py", bearing=bearing, motion=motion)
    model, begin, analysis = Path("pier.py").read_text().partition("ops.timeSeries")
    short = re.sub(r"analyze\(\d+", f"analyze({round(duration / DT)}", begin + analysis)
    exec(compile(model, "pier.py", "exec"), {})
    (tag,) = (tag for tag in ops.getEleTags() if ops.eleType(tag) in MAKERS)
    count = tb.load_structure("pier-p1").bearings[0].count
    with serve(bearing, ambient=AMBIENT, count=count, units="kN-m") as line:
        replace_elements(ops, tag, line, directions=1, vertical=None)
        exec(compile(short, "pier.py", "exec"), {"ops": ops})
    (served,) = line.results().table.to_dict("records")
    ours = tb.bridge(bearing, motion, [AMBIENT], duration=duration, damping="element", dt=DT)
    (row,) = ours.table.to_dict("records")
    for theirs, key in (
        ("bearing_force_max_kN", "bearing_force_max_kN"),
        ("strain_max", "bearing_strain_max"),
    ):
        assert served[theirs] == pytest.approx(row[key], rel=tol.OPENSEES_SERVED_PIER), key
    assert served["bearing_force_max_kN"] > 500.0


@pytest.fixture(scope="module")
def line() -> Iterator[Line]:
    with serve(BEARING, ambient=AMBIENT) as made:
        yield made
        ops.wipe()


def test_what_cannot_be_replaced_is_refused_before_anything_is_removed(line: Line) -> None:
    nodes_in_space()
    plasticity()
    ops.element("zeroLength", 2, 1, 2, "-mat", 1, "-dir", 3)
    with pytest.raises(tb.InputError, match=r"element 2: is a ZeroLength.*LeadRubberX"):
        replace_elements(ops, [1, 2], line)
    with pytest.raises(tb.InputError, match="no element 7"):
        replace_elements(ops, [1, 7], line)
    with pytest.raises(tb.InputError, match="twice"):
        replace_elements(ops, [1, 1], line)
    with pytest.raises(tb.InputError, match="vertical"):
        replace_elements(ops, [1], line, vertical=2)
    with pytest.raises(tb.InputError, match="program"):
        replace_elements("model.tcl", [1], line)
    assert ops.eleType(1) == "ElastomericBearingPlasticity3d"


def test_a_bearing_with_height_mass_or_displacement_is_refused(line: Line) -> None:
    others = [part for name in ("-P", "-T", "-My", "-Mz") for part in (name, 1)]
    words = ("elastomericBearingPlasticity", 1, 1, 2, 15.0, 120.0, 0.08, 0.0, 1.0, *others)
    nodes_in_space(height=0.2)
    ops.element(*words)
    with pytest.raises(tb.InputError, match=r"0\.2 apart"):
        replace_elements(ops, 1, line)
    nodes_in_space()
    ops.element(*words, "-orient", 0, 0, 1, 1, 0, 0, "-mass", 0.5)
    with pytest.raises(tb.InputError, match=r"mass of 0\.5"):
        replace_elements(ops, 1, line)
    nodes_in_space()
    ops.element(*words, "-orient", 0, 0, 1, 1, 0, 0)
    shaken()
    with pytest.raises(tb.InputError, match="have moved"):
        replace_elements(ops, 1, line)
