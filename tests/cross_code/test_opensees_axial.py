"""Bearings under axial forces against `LeadRubberX` of OpenSees (shared/spec/axial.md, 6 and 10).

The package computes here with the vertical stiffness of the element, which has the factor of an
open hole for lead-filled bearings.
"""

from itertools import pairwise

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import analyse, needs_opensees, ops
from tests.verification.lead_rubber import GRAVITY, YIELD_RATIO, LeadRubber, make_line, shake
from tests.verification.test_axial_earthquakes import STABLE, UNSTABLE, WIDE, peaks, record
from thermobearing.core.axial import (
    counted_overlap,
    layer_compression,
    stiffness_reduction,
    tension,
    vertical_stiffness,
)
from thermobearing.core.records import Floats
from thermobearing.earthquake.axial import with_axial_outcome
from thermobearing.model.axial import column_of

pytestmark = needs_opensees

BULK = 2.0  # GPa
SAMPLE = LeadRubber(700, 140, 22, 8, 3.2, 0.45e-3, 10e-3)
# Effects of the element: cavitation, shear under axial force, its limit, vertical stiffness, heat.
ALL, STIFFNESS, SHEAR, TENSION, NONE = (
    (1, 1, 1, 1, 0),
    (0, 0, 0, 1, 0),
    (0, 1, 1, 0, 0),
    (1, 0, 0, 1, 0),
    (0, 0, 0, 0, 0),
)


def add_element(bearing: LeadRubber, effects: tuple[int, ...], tag: int = 1) -> None:
    """Add a bearing between two nodes at one place; vertical is z, shear along x."""
    nodes = 2 * tag - 1, 2 * tag
    rubber = bearing.strength, YIELD_RATIO, bearing.modulus, BULK
    sizes = bearing.core, bearing.diameter, bearing.shim, bearing.thickness, bearing.layers
    column = bearing.constants()[1][0]
    law = column.strengthening, column.damage, column.damage_rate
    vertical = (*law, 0.5, 0.0, 0.0, 0.0)  # shear distance, mass, damping, cover
    heat = (11200.0, 130.0, 50.0, 1.41e-5)  # of lead and steel, without effect
    axes = (0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    ops.element("LeadRubberX", tag, *nodes, *rubber, *sizes, *axes, *vertical, *heat, *effects)


def begin() -> None:
    """Begin a model of one bearing, whose top moves along x and z."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node in (1, 2):
        ops.node(node, 0.0, 0.0, 0.0)
    ops.fix(1, 1, 1, 1, 1, 1, 1)
    # Free along y too, where nothing happens: a model needs a free coordinate.
    ops.fix(2, 0, 0, 0, 1, 1, 1)


def add_bearing(bearing: LeadRubber, effects: tuple[int, ...]) -> None:
    """Begin a model of one lead rubber bearing."""
    begin()
    add_element(bearing, effects)


def press(loads: dict[int, float]) -> None:
    """Apply vertical loads [kN] to nodes, and keep them."""
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node, load in loads.items():
        ops.load(node, 0.0, 0.0, -load, 0.0, 0.0, 0.0)
    analyse("LoadControl", 0.1, system="FullGeneral")
    assert ops.analyze(10) == 0
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()


def prescribe(path: Floats, direction: int, tag: int) -> None:
    """Prescribe displacements [mm] of the top, one for each unit of time."""
    ops.timeSeries("Path", tag, "-dt", 1.0, "-values", 0.0, *path.tolist(), path[-1])
    ops.pattern("Plain", tag, tag)
    ops.sp(2, direction, 1.0)


def forces_along(steps: int) -> Floats:
    """Shear and axial compression [kN] of the bearing in each step."""
    analyse("LoadControl", 1.0, most=30, system="FullGeneral")
    rows = []
    for _ in range(steps):
        assert ops.analyze(1) == 0
        force = ops.eleForce(1)
        rows.append((force[6], -force[8]))
    return np.array(rows)


def compression_of(bearing: LeadRubber) -> float:
    """c of all layers [mm3/kN]."""
    rubber = bearing.layers * bearing.thickness
    column = bearing.constants()[1][0]
    return float(layer_compression.py_func(column, 1.0 / bearing.modulus) * rubber)


@pytest.mark.parametrize("offset", [0.0, 150.0, 420.0])
def test_vertical_stiffness(offset: float, measured: Recorder) -> None:
    add_bearing(SAMPLE, STIFFNESS)
    path = np.concatenate([np.linspace(0.0, offset, 51)[1:], np.full(20, offset)])
    prescribe(path, 1, 2)
    prescribe(np.concatenate([np.zeros(50), -0.05 * np.arange(1, 21)]), 3, 3)
    forces = forces_along(len(path))[50:, 1]
    column = SAMPLE.constants()[1][0]
    stiffness = vertical_stiffness.py_func(column, compression_of(SAMPLE), offset, 0.0)
    off = abs(forces[-1] / (0.05 * 20) / stiffness - 1.0)
    assert off < tol.OPENSEES_AXIAL
    measured(
        f"vertical stiffness at {offset:g} mm against LeadRubberX",
        f"{off:.1e}",
        f"{tol.OPENSEES_AXIAL:g}",
    )


RING = tb.new_bearing(
    "ring", "shen-hdr", diameter="500 mm", hole="100 mm", layers="25x6mm", shim="3 mm"
)


@pytest.mark.parametrize("offset", [0.0, 150.0])
def test_vertical_stiffness_with_a_hole(offset: float, measured: Recorder) -> None:
    """Of a ring of rubber between plates with an open hole, against `ElastomericX`."""
    modulus, geometry = 0.6e-3, RING.geometry
    begin()
    rubber = 50.0, YIELD_RATIO, modulus, BULK  # yield force, which has no effect here
    sizes = 100.0, 500.0, geometry.shim_thickness, geometry.rubber_thickness
    axes = (0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    law = (10.0, 0.75, 1.0, 0.5, 0.0, 0.0, 0.0, 0, 0, 0, 1)
    ops.element("ElastomericX", 1, 1, 2, *rubber, *sizes, geometry.rubber_layers, *axes, *law)
    prescribe(np.concatenate([np.linspace(0.0, offset, 51)[1:], np.full(20, offset)]), 1, 2)
    prescribe(np.concatenate([np.zeros(50), -0.05 * np.arange(1, 21)]), 3, 3)
    force = forces_along(70)[-1, 1]
    column = column_of(RING)[0]
    compression = layer_compression.py_func(column, 1.0 / modulus) * RING.total_rubber_thickness
    stiffness = vertical_stiffness.py_func(column, compression, offset, 0.0)
    off = abs(force / (0.05 * 20) / stiffness - 1.0)
    assert off < tol.OPENSEES_AXIAL
    measured(
        f"vertical stiffness with a hole at {offset:g} mm against ElastomericX",
        f"{off:.1e}",
        f"{tol.OPENSEES_AXIAL:g}",
    )


@pytest.mark.parametrize("offset", [0.0, 150.0])
def test_cavitation(offset: float, measured: Recorder) -> None:
    """Loops of extension to multiples of that of cavitation, at a constant displacement."""
    column, compression = SAMPLE.constants()[1][0], compression_of(SAMPLE)
    stiffness = float(vertical_stiffness.py_func(column, compression, offset, 0.0))
    strength = column.cavitation * SAMPLE.modulus * SAMPLE.area
    targets = np.array([0.0, 3.0, -0.5, 1.0, 6.0, 0.0, 4.0, 10.0, -0.5]) * strength / stiffness
    legs = [np.linspace(a, b, 401)[1:] for a, b in pairwise(targets)]
    extension, sway = np.concatenate(legs), np.linspace(0.0, offset, 51)[1:]
    add_bearing(SAMPLE, TENSION)
    prescribe(np.concatenate([sway, np.full(len(extension), offset)]), 1, 2)
    prescribe(np.concatenate([np.zeros(50), extension]), 3, 3)
    theirs = -forces_along(50 + len(extension))[50:, 1]
    memory, ours = 1.0, []
    for e in extension:
        ours.append(tension.py_func(column, float(e), stiffness, strength, memory)[0])
        memory = max(memory, float(e) * stiffness / strength)
    off = np.abs(np.array(ours) - theirs).max() / strength
    assert off < tol.OPENSEES_CAVITATION
    measured(
        f"loops of cavitation at {offset:g} mm against LeadRubberX, of the cavitation force",
        f"{off:.1e}",
        f"{tol.OPENSEES_CAVITATION:g}",
    )


def test_shear_under_axial_force(measured: Recorder) -> None:
    """What a constant axial force takes from the shear force; both as of the step before."""
    load, path = 1800.0, np.linspace(0.0, 600.0, 601)[1:]
    shears = []
    for effects in (SHEAR, NONE):
        add_bearing(SAMPLE, effects)
        press({2: load})
        prescribe(path, 1, 2)
        shears.append(forces_along(len(path))[:, 0])
    taken = (shears[1] - shears[0]) / path
    column, compression = SAMPLE.constants()[1][0], compression_of(SAMPLE)
    before = path - path[0]
    ours = [
        stiffness_reduction.py_func(
            column, compression, load, counted_overlap.py_func(column, x, 0.0)
        )[0]
        for x in before
    ]
    off = float(np.abs((ours - taken) * path).max() / np.abs(shears[1]).max())
    assert off < tol.OPENSEES_AXIAL
    measured(
        "shear force under an axial force of 1800 kN against LeadRubberX, of the peak",
        f"{off:.1e}",
        f"{tol.OPENSEES_AXIAL:g}",
    )


def earthquake_of(
    bearing: LeadRubber, load: float, ground: Floats, dt: float
) -> tuple[float, float]:
    """Largest displacement [mm] and shear force [kN] of the element under a rigid mass."""
    add_bearing(bearing, (0, 1, 1, 1, 0))
    ops.mass(2, load / GRAVITY, 0.0, load / GRAVITY, 0.0, 0.0, 0.0)
    press({2: load})
    ops.timeSeries("Path", 2, "-dt", dt, "-values", *ground.tolist(), 0.0)
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    analyse(tolerance=1e-9, system="FullGeneral")
    largest = [0.0, 0.0]
    for _ in range(len(ground) - 1):
        assert ops.analyze(1, dt) == 0
        values = ops.nodeDisp(2, 1), ops.eleForce(1)[6]
        largest = [max(past, abs(now)) for past, now in zip(largest, values, strict=True)]
    ops.wipe()
    return largest[0], largest[1]


@pytest.mark.thorough
@pytest.mark.parametrize("name", list(STABLE))
def test_one_bearing_in_an_earthquake(name: str, measured: Recorder) -> None:
    bearing, pressure, factor, _, _ = STABLE[name]
    ground, dt = record()
    load = pressure * bearing.area
    ours = peaks(shake(bearing, load, factor * ground, dt, upwards=np.zeros_like(ground)))
    theirs = earthquake_of(bearing, load, factor * ground, dt)
    off = [abs(a / b - 1.0) for a, b in zip(ours, theirs, strict=True)]
    assert max(off) < tol.OPENSEES_AXIAL_EARTHQUAKE
    measured(
        f"earthquake, axial force on {name} bearing: displacement, force against LeadRubberX",
        f"{off[0]:.1e}, {off[1]:.1e}",
        f"{tol.OPENSEES_AXIAL_EARTHQUAKE:g}",
    )


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["warm, strong", "cold, strong"])
def test_an_element_that_buckles_reports_success(name: str) -> None:
    """The element goes on, on a remainder of its stiffness, to tens of metres."""
    bearing, pressure, factor = UNSTABLE[name]
    ground, dt = record()
    load = pressure * bearing.area
    displacement, _ = earthquake_of(bearing, load, factor * ground, dt)
    assert displacement > 10e3  # mm
    upwards = np.zeros_like(ground)
    history = shake(bearing, load, factor * ground, dt, upwards=upwards)
    assert with_axial_outcome("completed", history.axial) == "unstable"


PLACES = np.array([-5000.0, -2500.0, 0.0, 2500.0, 5000.0])
HEIGHT = 1800.0  # mm
STIFF = 1e9, 200.0, 80.0, 1e16, 1e16, 1e16  # area, moduli and inertias of a beam [mm, kN]


def line_of(loads: Floats, motions: tuple[Floats, Floats], dt: float, damping: float) -> Floats:
    """Displacement, shear and axial forces of five bearings under a rigid deck, in each step."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    deck = 100
    ops.node(deck, 0.0, 0.0, HEIGHT)
    ops.fix(deck, 0, 1, 0, 1, 0, 1)
    ops.geomTransf("Linear", 1, 0.0, 1.0, 0.0)
    mass = float(loads.sum()) / GRAVITY
    ops.mass(deck, mass, 0.0, mass, 0.0, 0.0, 0.0)
    for tag, place in enumerate(PLACES, 1):
        for node in (2 * tag - 1, 2 * tag):
            ops.node(node, place, 0.0, 0.0)
        ops.fix(2 * tag - 1, 1, 1, 1, 1, 1, 1)
        add_element(WIDE, ALL, tag)
        # Stiff beams: rigid links are wrong in static analyses of this version.
        ops.element("elasticBeamColumn", 50 + tag, deck, 2 * tag, *STIFF, 1)
    stiffness = WIDE.area / compression_of(WIDE)
    ops.uniaxialMaterial("Viscous", 1, 2.0 * damping * (mass * len(loads) * stiffness) ** 0.5, 1.0)
    ops.node(deck + 1, 0.0, 0.0, HEIGHT)
    ops.fix(deck + 1, 1, 1, 1, 1, 1, 1)
    ops.element("zeroLength", deck, deck + 1, deck, "-mat", 1, "-dir", 3)
    press({deck: float(loads.sum())})
    for tag, (direction, motion) in enumerate(zip((1, 3), motions, strict=True), 2):
        ops.timeSeries("Path", tag, "-dt", dt, "-values", *motion.tolist(), 0.0)
        ops.pattern("UniformExcitation", tag, direction, "-accel", tag)
    analyse(tolerance=1e-8, system="FullGeneral")
    rows = []
    for _ in range(len(motions[0]) - 1):
        assert ops.analyze(1, dt) == 0
        forces = [ops.eleForce(tag) for tag in range(1, len(PLACES) + 1)]
        shear = sum(force[6] for force in forces)
        rows.append((ops.nodeDisp(2, 1), shear, *(-force[8] for force in forces)))
    ops.wipe()
    return np.array(rows)


@pytest.mark.thorough
@pytest.mark.parametrize("upwards", [0.0, 2000.0])
def test_five_bearings_of_a_deck(upwards: float, measured: Recorder) -> None:
    """Overturning, without and with a vertical motion [mm/s2] near the period of the bearings."""
    loads, (ground, dt) = np.full(len(PLACES), 3660.0), record()
    time = dt * np.arange(len(ground))
    vertical = upwards * np.sin(16.0 * np.pi * time) * np.sin(np.pi * time / time[-1]) ** 2
    damping, motion = 0.03, 0.7 * ground
    ours = make_line(
        WIDE,
        loads,
        motion,
        dt,
        upwards=vertical,
        places=PLACES,
        height=HEIGHT,
        damping_ratio=damping,
    )
    theirs = line_of(loads, (motion, vertical), dt, damping)
    displacement, force = peaks(ours)
    largest = np.abs(theirs).max(axis=0)
    off = abs(displacement / largest[0] - 1.0), abs(len(loads) * force / largest[1] - 1.0)
    assert max(off) < tol.OPENSEES_AXIAL_EARTHQUAKE
    assert ours.axial is not None
    axial = ours.axial.force[1:]
    of_range = np.abs(axial - theirs[:, 2:]).max() / np.ptp(axial)
    assert of_range < tol.OPENSEES_AXIAL_LINE
    measured(
        f"five bearings of a deck, vertical motion of {upwards:g} mm/s2, axial forces in time "
        "against LeadRubberX, of their range",
        f"{of_range:.1e}",
        f"{tol.OPENSEES_AXIAL_LINE:g}",
    )
