"""Bearings under an axial force: closed forms of the specification (shared/spec/axial.md, 7)."""

import math
import tomllib

import numpy as np
import pytest

import thermobearing as tb
from tests.tolerances import ROUNDING
from thermobearing.bearing.model import CircularPlan, Geometry, LeadCores, SquarePlan
from thermobearing.border.toml import to_toml
from thermobearing.core.axial import (
    buckling_load,
    cavitated_strength,
    compliance,
    counted_overlap,
    overlap_share,
    stiffness_reduction,
    tension,
    vertical_stiffness,
)
from thermobearing.cyclic.case import make_case
from thermobearing.design.factors import scaled_bearing
from thermobearing.live.data import engine_data
from thermobearing.model.axial import (
    axial_rows,
    axial_stiffness,
    build_column,
    column_of,
    compression_modulus,
    critical_load,
    find_section,
    overlap_area,
    second_moments,
)
from thermobearing.model.options import build_model
from thermobearing.reported import bearing_words

CLOSED = 1e-6  # relative: the digits of the published cases
LEAD = LeadCores(
    cores=1, diameter=140, stiffness=8.0, yield_stress=10, reference_temperature=23, confined=False
)


def _geometry(plan, layers, rubber, shim):
    return Geometry(
        plan=plan,
        rubber_layers=layers,
        rubber_thickness=rubber,
        shim_thickness=shim,
        end_plate_thickness=25,
    )


BEARING_L = _geometry(CircularPlan(shape="circular", diameter=700), 22, 8.0, 3.2)
RING = _geometry(CircularPlan(shape="circular", diameter=500, hole=100), 25, 6.0, 3.0)
SQUARE = _geometry(SquarePlan(shape="square", side=600), 10, 12.0, 4.0)


def layer_sums(column, moduli, counts):
    """c, g and smallest G of layers, through the kernel that takes stiffness terms."""
    stiffness = np.array(moduli) * column.area / column.layer_thickness
    return compliance.py_func(column, np.array(counts, float), stiffness, np.zeros(len(moduli)))


@pytest.mark.parametrize(
    ("geometry", "modulus", "expected"),
    [
        (BEARING_L, 0.45e-3, (369451.30, 178.4657, 0.663786, 1393.391, 11629.50, 498.759)),
        (
            RING,
            0.6e-3,
            (188495.56, 127.4755, 0.474007, 595.6549, 4816.997, 339.292),
        ),
        (SQUARE, 0.8e-3, (360000.0, 173.2051, 0.538975, 1616.925, 19384.13, 864.0)),
    ],
    ids=["filled", "annular", "square"],
)
def test_stiffness_and_critical_load_of_plans(geometry, modulus, expected):
    lead = LEAD if geometry is BEARING_L else None
    column = build_column(geometry, lead)[0]
    compression, shear, softest = layer_sums(column, [modulus], [geometry.rubber_layers])
    computed = (
        column.area,
        math.sqrt(column.inertia_x / column.area),
        geometry.total_rubber_thickness / compression,
        column.area / compression,
        buckling_load.py_func(column, compression, shear),
        column.cavitation * softest * column.area,
    )
    assert computed == pytest.approx(expected, rel=CLOSED)
    # The functions of checks and springs are the same ones.
    assert compression_modulus(geometry, modulus, lead) == pytest.approx(computed[2], rel=1e-14)
    assert axial_stiffness(geometry, modulus, lead) == pytest.approx(computed[3], rel=1e-14)
    assert critical_load(geometry, modulus, lead) == pytest.approx(computed[4], rel=1e-14)


@pytest.mark.parametrize(
    ("x", "overlap", "vertical", "critical", "kappa", "of_square"),
    [
        (0.0, 1.0, 1393.391, 11629.50, 0.015411, (1.0, 1616.925)),
        (280.0, 0.504632, 797.035, 5868.61, 0.060516, (0.533333, 901.116)),
        (420.0, 0.284757, 519.246, 3311.58, 0.190052, (0.3, 580.103)),
        (560.0, 0.2, 348.970, 2325.90, 0.385267, (0.2, 387.062)),
    ],
)
def test_offset(x, overlap, vertical, critical, kappa, of_square):
    column = build_column(BEARING_L, LEAD)[0]
    compression, shear, _ = layer_sums(column, [0.45e-3], [22])
    counted = counted_overlap.py_func(column, x, 0.0)
    assert counted == pytest.approx(overlap, rel=2e-6)
    assert vertical_stiffness.py_func(column, compression, x, 0.0) == pytest.approx(
        vertical, abs=6e-4
    )
    assert buckling_load.py_func(column, compression, shear) * counted == pytest.approx(
        critical, abs=6e-3
    )
    along, across = stiffness_reduction.py_func(column, compression, 1500.0, counted)
    assert along == across == pytest.approx(kappa, abs=6e-7)
    square = build_column(SQUARE)[0]
    compression, _, _ = layer_sums(square, [0.8e-3], [10])
    assert (
        counted_overlap.py_func(square, x, 0.0),
        vertical_stiffness.py_func(square, compression, x, 0.0),
    ) == pytest.approx(of_square, rel=2e-6)


def test_a_hole_is_no_part_of_the_plan():
    """Area, shape factor, heat, stress and twist; the side that cools is the outer one."""
    assert RING.plan.area == pytest.approx(0.25 * math.pi * (500.0**2 - 100.0**2), rel=1e-15)
    assert RING.plan.perimeter == pytest.approx(500.0 * math.pi)
    assert RING.first_shape_factor == pytest.approx(400.0 / (4.0 * 6.0))
    assert find_section(RING).shape_factor == pytest.approx(RING.first_shape_factor)
    inertia = math.pi / 64.0 * (500.0**4 - 100.0**4)
    assert second_moments(RING.plan) == pytest.approx((inertia, inertia))
    size = {"diameter": "500 mm", "layers": "25x6mm", "shim": "3 mm"}
    solid, ring = (tb.new_bearing("b", "shen-hdr", **size, hole=hole) for hole in (None, "100 mm"))
    share = ring.area / solid.area
    assert share == pytest.approx(0.96)
    capacities = [build_model(one).constants.cells.capacity.sum() for one in (solid, ring)]
    assert capacities[1] == pytest.approx(0.96 * capacities[0], rel=1e-12)
    assert ring.hysteresis.layer_stiffness == pytest.approx(0.96 * solid.hysteresis.layer_stiffness)
    half = scaled_bearing(ring, 0.5).geometry.plan
    assert (half.diameter, half.hole) == (250.0, 50.0)
    table = tomllib.loads(to_toml(ring))
    assert "circular 500 mm with a hole of 100 mm" in bearing_words(table)
    assert tb.new_bearing("b", "shen-hdr", **size).geometry.plan.hole is None


@pytest.mark.parametrize(
    ("sizes", "words"),
    [
        ({"diameter": "500 mm", "hole": "500 mm"}, "must be less than diameter"),
        ({"plan": "500x500mm", "hole": "100 mm"}, "needs diameter"),
        ({"diameter": "500 mm", "hole": "0.1 mm"}, "hole"),
        ({"diameter": "500 mm", "hole": "100 mm", "lead": "90 mm"}, "has no open hole"),
    ],
)
def test_holes_that_do_not_fit_are_refused(sizes, words):
    rubber = {"layers": "25x6mm", "shim": "3 mm"}
    with pytest.raises(tb.InputError, match=words):
        tb.new_bearing("b", "shen-lhdr", **rubber, **sizes)


@pytest.mark.parametrize("plan", [BEARING_L.plan, SQUARE.plan, RING.plan])
def test_overlap_share_is_the_overlap_area_over_the_plan(plan):
    moved = np.random.default_rng(3).uniform(-1.2, 1.2, (60, 2)) * plan.breadth
    column = build_column(_geometry(plan, 4, 10.0, 3.0))[0]
    shares = [overlap_share.py_func(column, *pair) for pair in moved]
    assert shares == pytest.approx(overlap_area(plan, moved) / plan.area, abs=1e-14)


@pytest.mark.parametrize(
    ("x", "cavitation", "ends", "work"),
    [
        (
            0.0,
            0.357946,
            (500.7807, -249.3796, 255.0067, 503.7860, 0.0, 372.6879, 507.7431, -249.3796),
            623.651,
        ),
        (
            150.0,
            0.434809,
            (501.2129, -249.3796, 255.1125, 504.8537, 0.0, 373.3839, 509.6347, -249.3796),
            757.304,
        ),
    ],
)
def test_cavitation(x, cavitation, ends, work):
    column = build_column(BEARING_L, LEAD)[0]
    compression, _, softest = layer_sums(column, [0.45e-3], [22])
    stiffness = vertical_stiffness.py_func(column, compression, x, 0.0)
    strength = column.cavitation * softest * column.area
    assert strength / stiffness == pytest.approx(cavitation, rel=2e-6)
    memory, forces, extensions, reached = 1.0, [0.0], [0.0], []
    for target in (3.0, -0.5, 1.0, 6.0, 0.0, 4.0, 10.0, -0.5):
        for e in np.linspace(extensions[-1], target * strength / stiffness, 801)[1:]:
            forces.append(tension.py_func(column, e, stiffness, strength, memory)[0])
            extensions.append(float(e))
            memory = max(memory, e / strength * stiffness)
        reached.append(forces[-1])
    assert reached == pytest.approx(ends, rel=CLOSED, abs=1e-9)
    assert cavitated_strength.py_func(column, strength, memory) == pytest.approx(
        124.7360, rel=CLOSED
    )
    assert np.trapezoid(forces, extensions) == pytest.approx(work, rel=CLOSED)


@pytest.mark.parametrize("memory", [1.0, 1.0 + 1e-12, 2.5, 40.0])
def test_tension_grows_with_extension_and_its_tangent_is_its_slope(memory):
    column = build_column(BEARING_L, LEAD)[0]
    law = (1000.0, 500.0, memory)
    extensions = np.linspace(-1.0, 25.0, 4001)
    forces = [tension.py_func(column, e, *law)[0] for e in extensions]
    assert (np.diff(forces) > 0.0).all()
    for e in (-0.7, 0.1, 0.9, 3.3, 19.0):
        rise = [tension.py_func(column, e + side, *law)[0] for side in (1e-6, -1e-6)]
        slope = tension.py_func(column, e, *law)[1]
        assert (rise[0] - rise[1]) / 2e-6 == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize(
    ("temperatures", "expected"),
    [
        ((23.0, 23.0, 23.0), (372.173, 619.067, 9248.19, 0.102292, 691.200)),
        ((-20.0, -20.0, -20.0), (274.561, 839.158, 13057.20, 0.075463, 1017.831)),
        ((-20.0, -12.0, -5.0), (289.653, 795.434, 12273.80, 0.079612, 889.295)),
    ],
)
def test_cold_layers(temperatures, expected):
    geometry = _geometry(SquarePlan(shape="square", side=480), 6, 17.0, 6.4)
    column = build_column(geometry)[0]
    moduli = 1e-3 * np.exp(-0.9 * (np.array(temperatures) - 23.0) / 100.0)
    compression, shear, softest = layer_sums(column, moduli, [2, 2, 2])
    computed = (
        compression,
        vertical_stiffness.py_func(column, compression, 0.0, 0.0),
        buckling_load.py_func(column, compression, shear),
        stiffness_reduction.py_func(column, compression, 2000.0, 1.0)[0],
        column.cavitation * softest * column.area,
    )
    assert computed[3] == pytest.approx(expected[3], abs=6e-7)
    assert computed == pytest.approx(expected, rel=7e-6)


def _bouc_wen(displacement):
    """Force of the bearing of the case without axial force [kN]: K_el u + Q z, by Runge-Kutta."""
    strength, yielding, parts = 153.938, 18.107, 8
    z, forces = 0.0, [0.0]

    def _slope(value, sign):
        return sign - value * abs(value) if value * sign >= 0.0 else sign * (1.0 + 0.8 * value**2)

    for du in np.diff(displacement):
        h, sign = abs(du) / yielding / parts, math.copysign(1.0, du)
        for _ in range(parts if du else 0):
            a = _slope(z, sign)
            b = _slope(z + 0.5 * h * a, sign)
            c = _slope(z + 0.5 * h * b, sign)
            z += h / 6.0 * (a + 2.0 * b + 2.0 * c + _slope(z + h * c, sign))
        forces.append(strength * z)
    return np.array(forces) + 0.944620 * displacement


def _constant_modulus(modulus):
    """Constants of rubber with one modulus [GPa] at any temperature, in the plan of bearing L."""
    constants = build_model(tb.load_bearing("lrb-example")).constants
    stiffness = modulus * find_section(BEARING_L, LEAD).area / BEARING_L.rubber_thickness
    rubber = constants.rubber._replace(
        elastic_stiffness=stiffness,
        hysteretic_stiffness=0.0,
        elastic_exponent=0.0,
        hysteretic_exponent=0.0,
    )
    return constants._replace(rubber=rubber, law=constants.law[:0])


def _sway(dt, duration, factor, steady=0.0, slow=0.0, fast=0.0):
    """Displacements of the case, and what the axial force does, at steps of dt."""
    time = dt * np.arange(round(duration / dt) + 1)
    moved = 200.0 * np.sin(np.pi * time) * np.minimum(1.0, 0.5 * time)
    force = steady + slow * np.sin(np.pi * time) + fast * np.sin(12.0 * np.pi * time)
    constants = _constant_modulus(0.45e-3)
    temperature = np.full((len(time), len(constants.multiplicity)), 23.0)
    column = build_column(BEARING_L, LEAD, factor=factor)
    return moved, axial_rows(column, constants, moved, force, temperature)


VARYING = {"steady": 1500.0, "slow": 900.0, "fast": 500.0}


@pytest.mark.parametrize(
    ("load", "factor", "forces", "share", "lent"),
    [
        (
            {"steady": 1800.0},
            "overlap",
            (198.602, -151.349, -289.375, 153.938, 332.068, -153.938, -332.068, 153.938),
            0.24138,
            -3.468,
        ),
        (
            {"steady": 1800.0},
            "potential",
            (198.834, -151.349, -292.302, 153.938, 338.424, -153.938, -338.424, 153.938),
            0.24138,
            0.0,
        ),
        (
            VARYING,
            "overlap",
            (197.596, -151.349, -294.979, 153.938, 323.973, -153.938, -341.737, 153.938),
            0.38615,
            -18.682,
        ),
        (
            VARYING,
            "potential",
            (198.002, -151.349, -295.284, 153.938, 335.095, -153.938, -342.399, 153.938),
            0.38615,
            -5.259,
        ),
    ],
)
def test_shear_under_axial_force(load, factor, forces, share, lent):
    moved, axial = _sway(0.001, 4.0, factor, **load)
    total = _bouc_wen(moved) - axial["stiffness_reduction"] * moved
    peak = 342.862
    assert total[500::500] == pytest.approx(forces, abs=1e-5 * peak)
    assert (axial["axial_force"] / axial["critical_load"]).max() == pytest.approx(share, rel=2e-5)
    assert axial["lent"][-1] == pytest.approx(lent, abs=2e-3)
    if factor == "potential":
        assert np.abs(axial["axial_mismatch"]).max() == 0.0


def test_shear_and_vertical_stiffness_have_one_potential():
    """The work of the axial force is what is stored, and what it lends to the shear."""
    residuals = []
    for dt in (0.004, 0.002, 0.001, 0.0005):
        _, axial = _sway(dt, 3.3, "potential", **VARYING)
        stored = axial["axial_stored"][-1] - axial["axial_stored"][0]
        residuals.append(axial["axial_work"][-1] - stored - axial["lent"][-1])
    assert residuals == pytest.approx([1.797, 0.931, 0.474, 0.239], abs=6e-4)
    assert (axial["axial_work"][-1], stored, axial["lent"][-1]) == pytest.approx(
        (-668.280, -767.993, 99.474), abs=6e-4
    )


TEST = tb.cyclic_test(strain=[2.0], cycles=1, closing_strain=None, dt=0.02)
PRESSED = 3000.0  # kN


@pytest.fixture(scope="module")
def runs():
    """A test without the effect of the axial force, and with it by the two keywords."""
    history = ([0.0, 1.0], [PRESSED, PRESSED])
    return (
        tb.run("lrb-example", TEST, 0.0, axial_force=PRESSED),
        tb.run("lrb-example", TEST, 0.0, axial_force=PRESSED, axial="constant"),
        tb.run("lrb-example", TEST, 0.0, axial_force=history),
    )


def test_constant_axial_force_in_a_test(runs):
    plain, pressed, history = runs
    assert pressed["force"].equals(history["force"])
    for name in ("displacement", "heat_released", "work_in", "rubber_temperature"):
        assert pressed[name].equals(plain[name])
    assert pressed["recoverable"].equals(plain["recoverable"])
    lost = (plain["force"] - pressed["force"]).values[0]
    taken = (pressed["stiffness_reduction"] * pressed["displacement"]).values[0]
    assert lost == pytest.approx(taken, abs=ROUNDING * float(plain["force"].max()))
    # At the largest displacement by hand: with the temperatures of the step before.
    bearing = tb.load_bearing("lrb-example")
    constants, column = build_model(bearing).constants, column_of(bearing)[0]
    place = int(np.abs(plain["displacement"].values[0]).argmax())
    before, rubber = place - 1, constants.rubber
    t = pressed["rubber_temperature"].values[0, before] - rubber.reference_temperature
    secant = rubber.elastic_stiffness * np.exp(rubber.elastic_exponent * t)
    law = bearing.hysteresis
    share = (1.0 + law.hardening) * law.yield_displacement / bearing.geometry.rubber_thickness
    secant += share * rubber.hysteretic_stiffness * np.exp(rubber.hysteretic_exponent * t)
    net_area = math.pi / 4.0 * (bearing.geometry.plan.diameter**2 - bearing.lead.diameter**2)
    moduli = secant * bearing.geometry.rubber_thickness / net_area
    compression, shear, _ = layer_sums(column, moduli, constants.multiplicity)
    counted = counted_overlap.py_func(column, plain["displacement"].values[0, before], 0.0)
    kappa = stiffness_reduction.py_func(column, compression, PRESSED, counted)[0]
    assert pressed["stiffness_reduction"].values[0, place] == pytest.approx(kappa, rel=1e-9)
    limit = buckling_load.py_func(column, compression, shear) * counted
    assert pressed["critical_load"].values[0, before] == pytest.approx(limit, rel=1e-9)
    row = pressed.bearing_checks.set_index("what").filter(like="in the analysis", axis=0)
    assert row["value"].tolist() == [PRESSED]
    assert row["limit"].iloc[0] == float(pressed["critical_load"].min())


def test_outcomes_of_an_axial_force():
    history = ([0.0, 2.0, 4.0], [500.0, 500.0, 20000.0])
    unstable = tb.run("lrb-example", TEST, 23.0, axial_force=history)
    assert unstable.outcome == "unstable"
    assert "critical load" in unstable.sentence
    assert any("unstable" in text for text in unstable.warnings)
    pulled = tb.run("lrb-example", TEST, 23.0, axial_force=-2000.0, axial="constant")
    assert pulled.outcome == "cavitated"
    below = tb.run("lrb-example", TEST, 23.0, axial_force=-1.0, axial="constant")
    assert below.outcome == "completed"


def test_axial_force_in_a_plane():
    circle = tb.cyclic_test(strain=[1.0], cycles=1, path="circle", frequency=0.5, dt=0.02)
    plain = tb.run("lrb-example", circle, 23.0, axial_force=PRESSED)
    pressed = tb.run("lrb-example", circle, 23.0, axial_force=PRESSED, axial="constant")
    lost = (plain["force"] - pressed["force"]).values[0]
    taken = pressed["stiffness_reduction"].values[0, :, np.newaxis]
    moved = pressed["displacement"].values[0]
    assert lost == pytest.approx(taken * moved, abs=ROUNDING * float(plain["force"].max()))


@pytest.mark.parametrize(
    ("table", "key"),
    [
        ({"analysis": {"axial": "constant"}}, "axial_force"),
        ({"analysis": {"axial": "history"}}, "axial_history"),
        ({"axial_history": {"time_s": [0], "force_kN": [1]}}, "axial_history"),
        ({"analysis": {"axial_factor": "potential"}}, "axial_factor"),
        ({"analysis": {"axial": "constant", "model": "bilinear"}, "axial_force": "1 kN"}, "model"),
        ({"analysis": {"axial": "constant", "keep_every": 2}, "axial_force": "1 kN"}, "keep_every"),
        (
            {
                "analysis": {"axial": "history"},
                "axial_history": {"time_s": [0, 1], "force_kN": [1]},
            },
            "force_kN",
        ),
        (
            {
                "analysis": {"axial": "history"},
                "axial_history": {"time_s": [1, 1], "force_kN": [1, 2]},
            },
            "increase",
        ),
    ],
)
def test_refused_axial_forces(table, key):
    with pytest.raises(tb.InputError) as caught:
        make_case(table, "case.toml")
    assert key in str(caught.value)
    assert "case.toml" in str(caught.value)


def test_a_live_page_has_no_holes():
    ring = tb.new_bearing(
        "ring", "shen-hdr", diameter="500 mm", hole="100 mm", layers="25x6mm", shim="3 mm"
    )
    with pytest.raises(tb.InputError, match="hole"):
        engine_data([(ring, build_model(ring))])
