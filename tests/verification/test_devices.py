"""Devices parallel to bearings: exact solutions, another integrator, OpenSees, energy."""

import dataclasses
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import analyse, needs_opensees, ops
from tests.verification.structures import (
    AMBIENT,
    energy_residual,
    exact_linear,
    linear_bearing,
    read_ground,
    real_bearing,
    shaken,
)
from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.structure.connections.devices import SMOOTHED
from thermobearing.structure.connections.model import build_devices, relative_dissipation
from thermobearing.structure.lanes import Run, run_lanes, run_peaks
from thermobearing.structure.model import Structure, along, load_structure
from thermobearing.structure.run import Line, StructureHistory, prepare_structure

MASS, SPRING = 0.4, 4.0  # kN s2/mm, kN/mm: 2 s
WEAK = 1e-6  # kN/mm: a bearing that holds nothing
DT = 0.005
DAMPER = {"kind": "damper", "name": "D", "line": "L", "force": 300.0, "exponent": 0.3}
SLIDER = {"kind": "slider", "name": "S", "line": "L", "normal_force": 3000.0, "friction": 0.06}
FASTER = SLIDER | {"slow_friction": 0.02, "friction_rate": 0.02}
GAP = {"kind": "gap", "name": "G", "line": "L", "gap": 60.0, "stiffness": 60.0}
DULL = GAP | {"restitution": 0.6, "closing_speed": 300.0}
ALL = [DAMPER, FASTER, DULL]


def deck(*devices: dict[str, Any], spring: float = SPRING, plan: bool = False) -> Structure:
    """A mass on a bearing line, with devices parallel to it."""
    table = {
        "name": "deck",
        "plan": plan or None,
        "bodies": [{"name": "deck", "moves": True}],
        "masses": [{"body": "deck", "height": 0.0, "mass": MASS}],
        "bearings": [{"name": "L", "body": "deck", "count": 1, "equivalent_stiffness": spring}],
        "damping": {"kind": "none"},
        "report": {"deck": "deck"},
        "devices": list(devices),
    }
    return Structure(**table)


def shaken_deck(
    *devices: dict[str, Any], ground: Floats, dt: float = DT, spring: float = SPRING
) -> StructureHistory:
    structure = deck(*devices, spring=spring)
    _, history = shaken(structure, linear_bearing(spring), ground, dt)
    assert (history.outcome, history.steps) == ("completed", len(ground) - 1)
    return history


def smooth_ground(dt: float, duration: float = 10.0) -> Floats:
    time = dt * np.arange(round(duration / dt) + 1)
    return np.asarray(1500.0 * np.sin(3.0 * time) * np.sin(np.pi * time / duration) ** 2)


def pushed(speed: float, dt: float, duration: float, push: float = 0.1) -> Floats:
    """A ground whose push leaves a free mass with a velocity relative to it [mm/s]."""
    time = dt * np.arange(round(duration / dt) + 1)
    pulse = np.where(time < push, -(np.sin(np.pi * time / push) ** 2), 0.0)
    return np.asarray(2.0 * speed / push * pulse)


def test_linear_damper_is_exact_with_second_order() -> None:
    linear = DAMPER | {"exponent": 1.0}
    errors = []
    for dt in (0.01, 0.005, 0.0025):
        ground = smooth_ground(dt)
        prepared, history = shaken(deck(linear), linear_bearing(SPRING), ground, dt)
        damped = dataclasses.replace(prepared, damping=np.array([[0.3]]))
        exact = exact_linear(damped, np.array([[SPRING]]), ground, dt)
        errors.append(np.abs(history.rows.q[:, 0] - exact).max() / np.abs(exact).max())
    assert errors[0] < 1e-3
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert_allclose(orders, 2.0, atol=tol.ORDER)


@pytest.mark.parametrize("exponent", [0.3, 1.7])
def test_damper_follows_another_integrator(exponent: float) -> None:
    dt = 0.002
    ground = smooth_ground(dt)
    history = shaken_deck(DAMPER | {"exponent": exponent}, ground=ground, dt=dt)
    time = dt * np.arange(len(ground))

    def rates(t: float, state: Floats) -> list[float]:
        x, v = state
        force = 300.0 * math.copysign(abs(v / 1000.0) ** exponent, v)
        pushed_by = float(np.interp(t, time, ground))
        return [v, -pushed_by - (SPRING * x + force) / MASS]

    options: Any = {"rtol": 1e-8, "atol": 1e-6, "method": "LSODA", "max_step": dt}
    known = solve_ivp(rates, (0.0, time[-1]), [0.0, 0.0], t_eval=time, **options)
    largest = np.abs(known.y[0]).max()
    assert np.abs(history.rows.q[:, 0] - known.y[0]).max() < 1e-3 * largest


def test_oil_factor_and_warming() -> None:
    table = {"temperatures": [-40.0, 0.0, 40.0], "factors": [1.8, 1.2, 1.0]}
    ground = smooth_ground(DT)
    cold = shaken_deck(DAMPER | table, ground=ground)  # at -20 degC
    same = shaken_deck(DAMPER | {"force": 450.0}, ground=ground)
    assert_allclose(cold.rows.q, same.rows.q, rtol=1e-12, atol=1e-9)
    capacity = 2000.0  # kN mm/K
    warming = shaken_deck(DAMPER | table | {"heat_capacity": capacity}, ground=ground)
    response = warming.device()
    assert_allclose(response["heated"], response["work"] / capacity)
    assert response["heated"][-1] > 10.0
    oil = AMBIENT + response["heated"][:-1]
    assert_allclose(response["factor"][1:], np.interp(oil, [-40.0, 0.0, 40.0], [1.8, 1.2, 1.0]))


def test_block_slides_as_newmark_says() -> None:
    dt, acceleration, duration = 0.002, 3000.0, 0.4
    friction = 0.06 * 3000.0 / MASS  # mm/s2: below the acceleration of the ground
    ground = np.zeros(1501)
    ground[1 : round(duration / dt) + 1] = -acceleration
    slider = SLIDER | {"elastic_displacement": 0.001}
    history = shaken_deck(slider, ground=ground, dt=dt, spring=WEAK)
    # The ramps at both ends of the pulse together last one step.
    speed = (acceleration - friction) * duration
    known = 0.5 * speed * duration + speed**2 / (2.0 * friction)
    assert history.rows.q[-1, 0] == pytest.approx(known, rel=2e-3)
    assert history.device_peaks["force"][0] == pytest.approx(180.0, rel=1e-12)


def test_friction_depends_on_the_velocity() -> None:
    history = shaken_deck(FASTER, ground=read_ground("jra-ii-i-1", DT, 15.0))
    response = history.device()
    speed = np.abs(response["velocity"])
    limit = 3000.0 * (0.06 - 0.04 * np.exp(-0.02 * speed))
    assert (np.abs(response["force"]) <= limit * (1.0 + 1e-12)).all()
    slides = np.abs(response["force"]) >= limit * (1.0 - 1e-9)
    assert slides.mean() > 0.5
    assert np.abs(response["force"]).max() > 0.055 * 3000.0


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("restitution", [None, 0.6, 0.3])
def test_bounce_is_exact(side: float, restitution: float | None) -> None:
    dt, speed = 1e-3, 300.0
    gap = GAP | {"sides": "positive" if side > 0.0 else "negative"}
    if restitution is not None:
        gap |= {"restitution": restitution, "closing_speed": speed}
    ground = side * pushed(speed, dt, 0.6)
    history = shaken_deck(gap, ground=ground, dt=dt, spring=WEAK)
    v = history.rows.v[:, 0]
    before = v[120]  # at 0.12 s, before the impact at about 0.25 s
    assert before == pytest.approx(side * speed, rel=1e-4)
    assert v[-1] == pytest.approx(-before * (restitution or 1.0), rel=2e-4)
    if restitution is None:
        deepest = np.abs(history.rows.q).max() - 60.0
        assert deepest == pytest.approx(speed * math.sqrt(MASS / 60.0), rel=1e-5)
    # A gap that closes on the other side is not there.
    free = shaken_deck(gap, ground=-ground, dt=dt, spring=WEAK)
    assert free.device_peaks["force"][0] == 0.0


def test_bounce_loses_more_when_it_is_faster() -> None:
    a = relative_dissipation(0.6)
    assert a - math.log1p(a) == pytest.approx(-0.6 * a - math.log1p(-0.6 * a), rel=1e-9)


@pytest.mark.parametrize("devices", [[DAMPER], [FASTER], [GAP], [DULL], ALL])
def test_energy_balance(devices: list[dict[str, Any]], measured: Recorder) -> None:
    history = shaken_deck(*devices, ground=read_ground("jra-ii-i-1", DT, 20.0))
    measured("energy balance of a deck with devices", energy_residual(history), "1e-9")
    assert energy_residual(history) < 1e-9
    energies = history.rows.energies[-1]
    works = {"damper": energies.dampers, "slider": energies.sliders, "gap": energies.gaps}
    for number, table in enumerate(devices):
        response = history.device(number)
        works[table["kind"]] -= response["work"][-1]
        lost = response["work"] - response["stored"]
        # The step in which a gap closes has no force at its start: 2e-3 at 5 ms.
        assert lost.min() > -5e-3 * max(response["work"].max(), 1.0)
        assert response["work"].max() > 0.0
    assert_allclose(list(works.values()), 0.0, atol=1e-9 * energies.input)


def test_count_multiplies() -> None:
    for device, keys in ((DAMPER, ["force"]), (FASTER, ["normal_force"]), (DULL, ["stiffness"])):
        triple = device | {key: 3.0 * device[key] for key in keys}
        two = [
            build_devices(deck(one).device_list, [0.0]) for one in (device | {"count": 3}, triple)
        ]
        assert_allclose(two[0][0].tolist(), two[1][0].tolist(), rtol=1e-12)


@pytest.mark.parametrize("device", [DAMPER, FASTER, DULL])
def test_turned_in_plan(device: dict[str, Any]) -> None:
    ground = read_ground("jra-ii-i-1", DT, 8.0)
    line = shaken_deck(device, ground=ground)
    angle = 0.6
    axis = np.array([math.cos(angle), math.sin(angle)])
    turned = device if device["kind"] == "slider" else device | {"angle": angle}
    pair = ground[:, None] * axis
    _, plan = shaken(deck(turned, plan=True), linear_bearing(SPRING), pair, DT)
    largest = np.abs(line.rows.q).max()
    assert np.abs(plan.rows.q - line.rows.q * axis).max() < 1e-9 * largest
    assert energy_residual(plan) < 1e-9
    if device["kind"] != "slider":
        peaks: Any = plan.device_peaks
        assert peaks["force"][0, 0] == pytest.approx(line.device_peaks["force"][0], rel=1e-9)
        single = along(deck(turned, plan=True), "y")
        assert single.device_list[0].angle == pytest.approx(angle - 0.5 * math.pi)
        across, _ = shaken(single, linear_bearing(SPRING), ground, DT)
        assert_allclose(across.matrices.device_rows, [[math.sin(angle)]])


def test_slider_resists_in_the_direction_of_its_motion() -> None:
    time = 0.002 * np.arange(4001)
    pair = 1500.0 * np.stack([np.sin(3.0 * time), np.sin(3.0 * time + 1.0)], axis=1)
    pair *= np.minimum(time / 2.0, 1.0)[:, None]
    structure = deck(SLIDER, plan=True)
    _, history = shaken(structure, linear_bearing(SPRING), pair, 0.002)
    response = history.device()
    force, velocity = response["force"][2000:], response["velocity"][2000:]
    assert_allclose(np.linalg.norm(force, axis=1), 180.0, rtol=1e-9)
    speeds = np.linalg.norm(velocity, axis=1)
    cosine = (force * velocity).sum(axis=1) / (180.0 * speeds)
    assert cosine.min() > 0.999


@pytest.mark.parametrize("plan", [False, True])
def test_lockstep_is_each_alone(plan: bool) -> None:
    runs = []
    constants = linear_bearing(SPRING)
    line = Line(constants, np.full(len(constants.cells.capacity), AMBIENT))
    for size in (0.5, 1.0, 1.5):
        ground = size * read_ground("jra-ii-i-1", DT, 4.0)
        prepared = prepare_structure(
            deck(DAMPER | {"force": 200.0 * size}, FASTER, DULL, plan=plan)
        )
        ground = np.stack([ground, 0.5 * ground], axis=-1) if plan else ground
        runs.append(Run(prepared, [line], ground, DT, AMBIENT))
    for run, result in zip(runs, run_lanes(runs), strict=True):
        known = run_peaks(run)
        assert not result.alone
        for name in ("stroke", "velocity", "force"):
            largest = np.abs(known.devices[name]).max()
            assert_allclose(result.devices[name], known.devices[name], atol=1e-9 * largest)
        for name in ("dampers", "sliders", "gaps", "bearings"):
            energy = known.energies["input"][0]
            assert_allclose(result.energies[name], known.energies[name], atol=1e-9 * energy)


def test_pier_with_devices_and_a_real_bearing() -> None:
    structure = load_structure("pier-p1")
    devices = [{**device, "line": "G1-G5"} for device in ALL]
    table = structure.model_dump(exclude_unset=True) | {"devices": devices}
    with_devices = Structure(**table)
    bearing, ground = real_bearing("lrb-example"), read_ground("jra-ii-i-1", DT, 12.0)
    _, plain = shaken(structure, bearing, ground, DT)
    _, history = shaken(with_devices, bearing, ground, DT)
    assert history.outcome == "completed"
    assert energy_residual(history) < 1e-9
    drift = [np.abs(run.bearing()["displacement"]).max() for run in (plain, history)]
    assert drift[1] < 0.95 * drift[0]


def test_bridge_has_a_row_for_each_device() -> None:
    structure = load_structure("pier-p1")
    oil = {"temperatures": [0.0, 40.0], "factors": [1.2, 1.0]}
    devices = [{**device, "line": "G1-G5"} for device in (DAMPER | oil, FASTER)]
    table = structure.model_dump(exclude_unset=True) | {"devices": devices}
    result = tb.bridge(
        "lrb-example", "jra-ii-i-1", [23.0, -20.0], structure=Structure(**table), duration=10
    )
    assert result.energy["structure_residual"].abs().max() < 1e-9
    rows = result.devices
    assert rows["device"].tolist() == ["D", "S"] * 2
    assert rows["device_energy_kN_mm"].groupby(rows["device"]).sum()["D"] == pytest.approx(
        result.energy["dampers_kN_mm"].sum()
    )
    assert (rows["device_stroke_mm"] > 10.0).all()
    assert "gaps_kN_mm" not in result.energy
    cold = result.sel(ambient=-20)
    assert len(cold.devices) == 2
    assert [row["device"] for row in cold.summary()["runs"][0]["devices"]] == ["D", "S"]
    assert [text for text in result.warnings if "damper D" in text and "-20 degC" in text]
    assert len(result.tables()["devices"]) == 4


def _in_opensees(material: list[Any], ground: Floats, dt: float) -> Floats:
    """Displacements of the same mass on its spring, with a device of OpenSees parallel to it."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, MASS)
    ops.uniaxialMaterial("Elastic", 1, SPRING)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    for number, entry in enumerate(material, 2):
        ops.uniaxialMaterial(entry[0], number, *entry[1:])
        ops.element("zeroLength", number, 1, 2, "-mat", number, "-dir", 1)
    ops.timeSeries("Path", 1, "-dt", dt, "-values", *ground, ground[-1])
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    analyse(tolerance=1e-8, most=200)
    places = [0.0]
    for _ in range(len(ground) - 1):
        if ops.analyze(1, dt) != 0:
            ops.algorithm("KrylovNewton")
            assert ops.analyze(1, dt) == 0
            ops.algorithm("Newton")
        places.append(ops.nodeDisp(2, 1))
    return np.array(places)


# Its Newton finds no equilibrium with Viscous of exponent 0.3; ViscousDamper has a spring in
# series.
COMPARED: dict[str, tuple[dict[str, Any], list[list[Any]], float]] = {
    "Viscous": (DAMPER | {"exponent": 0.7}, [["Viscous", 300.0 / 1e3**0.7, 0.7, SMOOTHED]], 1e-4),
    "ViscousDamper": (DAMPER, [["ViscousDamper", 1e4, 300.0 / 1e3**0.3, 0.3]], 5e-3),
    "Steel01": (SLIDER, [["Steel01", 180.0, 900.0, 0.0]], 1e-9),
    "ElasticPPGap": (
        GAP,
        [["ElasticPPGap", 60.0, 1e9, 60.0], ["ElasticPPGap", 60.0, -1e9, -60.0]],
        1e-9,
    ),
}


@needs_opensees
@pytest.mark.parametrize("name", list(COMPARED))
def test_opensees_has_the_same_device(name: str, measured: Recorder) -> None:
    device, material, tolerance = COMPARED[name]
    dt = 0.002
    ground = read_ground("jra-ii-i-1", dt, 20.0)
    result = shaken_deck(device, ground=ground, dt=dt).rows.q[:, 0]
    known = _in_opensees(material, ground, dt)
    error = float(np.abs(result - known).max() / np.abs(known).max())
    measured(f"device against {name} of OpenSees, displacement", error, f"{tolerance:g}")
    assert error < tolerance


# --- P-delta ---------------------------------------------------------------------------------
HEIGHT, TOP_MASS, LOAD, TURN = 8000.0, 0.2, 12_000.0, 5e8  # mm, kN s2/mm, kN, kN mm/rad


def pier(
    *, p_delta: bool, load: float = LOAD, bearing: float = 4.0, plan: bool = False
) -> Structure:
    """A rigid pier on an elastic hinge, with a deck on bearings on its top."""
    axial = {"dead_load": load}
    line = {"name": "L", "body": "deck", "base": "pier", "height": HEIGHT, "count": 1}
    table = {
        "name": "pier",
        "plan": plan or None,
        "p_delta": p_delta,
        "bodies": [
            {"name": "deck", "moves": True, "base_height": HEIGHT},
            {"name": "pier", "on": "ground", "rotates": True},
        ],
        "masses": [
            {"body": "deck", "height": HEIGHT, "mass": MASS},
            {"body": "pier", "height": HEIGHT, "mass": TOP_MASS},
        ],
        "springs": [{"name": "base", "body": "pier", "rotational_stiffness": TURN}],
        "bearings": [line | {"equivalent_stiffness": bearing, "axial": axial}],
        "damping": {"kind": "none"},
        "report": {"deck": "deck", "pier": "pier", "pier_top": HEIGHT},
    }
    return Structure(**table)


@pytest.mark.parametrize("plan", [False, True])
def test_weights_take_stiffness(plan: bool) -> None:
    prepared = prepare_structure(pier(p_delta=True, plan=plan))
    weight = 9806.65 * TOP_MASS * HEIGHT
    known = np.array([[0.0, -0.5 * LOAD], [-0.5 * LOAD, -weight]])
    result = prepared.matrices.geometric
    assert_allclose(result[::2, ::2] if plan else result, known, rtol=1e-12, atol=1e-6)
    if plan:
        assert_allclose(result[1::2, 1::2], known, rtol=1e-12, atol=1e-6)
        assert np.abs(result[::2, 1::2]).max() == 0.0
    assert not prepare_structure(pier(p_delta=False, plan=plan)).matrices.geometric.any()


def test_pendulum_has_its_period() -> None:
    """On a bearing that is nearly rigid the deck is a part of the pendulum."""
    load = 9806.65 * MASS
    prepared = prepare_structure(pier(p_delta=True, load=load, bearing=1e6))
    inertia = (MASS + TOP_MASS) * HEIGHT**2
    turning = TURN - 9806.65 * (MASS + TOP_MASS) * HEIGHT
    assert prepared.modes.frequencies[0] == pytest.approx(math.sqrt(turning / inertia), rel=1e-4)
    plain = prepare_structure(pier(p_delta=False, load=load, bearing=1e6))
    assert plain.modes.frequencies[0] > 1.04 * prepared.modes.frequencies[0]


def test_energy_with_weights() -> None:
    ground = 0.3 * read_ground("jra-ii-i-1", DT, 15.0)
    largest = []
    for p_delta in (False, True):
        _, history = shaken(pier(p_delta=p_delta), linear_bearing(4.0), ground, DT)
        assert energy_residual(history) < 1e-9
        largest.append(np.abs(history.rows.q[:, 1]).max())
    assert abs(largest[1] / largest[0] - 1.0) > 0.01


def test_weights_that_overturn_are_refused() -> None:
    table = pier(p_delta=True).model_dump(exclude_unset=True)
    table["masses"][1]["mass"] = 1e4
    with pytest.raises(InputError, match="p_delta: its weights overturn"):
        prepare_structure(Structure(**table))
    del table["bearings"][0]["axial"]
    with pytest.raises(InputError, match="p_delta: needs"):
        Structure(**table)


@pytest.mark.parametrize("load", [400.0, 5600.0])
def test_large_p_delta_is_a_warning(load: float) -> None:
    table = load_structure("pier-p1").model_dump(exclude_unset=True)
    table["bearings"][0]["axial"] = {"dead_load": load}
    table["hinges"][0]["yield_moment"] = yields = 8e6
    results = []
    for p_delta in (False, True):
        structure = Structure(**table | {"p_delta": p_delta})
        result = tb.bridge("lrb-example", "jra-ii-i-1", 23.0, structure=structure, duration=10)
        texts = [text for text in result.warnings if "yield moment of the pier" in text]
        share = 5.0 * load * result.table["pier_displacement_max_mm"][0] / yields
        assert bool(texts) == (share > 0.25) == (load > 1000.0)
        assert all(("p_delta = true" in text) != p_delta for text in texts)
        results.append(result)
    periods = [result.dataset.attrs["periods_s"][0] for result in results]
    assert periods[1] > periods[0]


BAD = {
    "no bearing line is called": DAMPER | {"line": "M"},
    "give the line": DAMPER | {"body": "deck"},
    "the line has it": DAMPER | {"height": 3.0},
    "at least 0.1": DAMPER | {"exponent": 0.01},
    "temperatures, factors": DAMPER | {"factors": [1.0, 2.0]},
    "one for each of": DAMPER | {"factors": [1.0, 2.0], "temperatures": [0.0, 1.0, 2.0]},
    "must rise": DAMPER | {"factors": [1.0, 2.0], "temperatures": [1.0, 1.0]},
    "exceeds friction": FASTER | {"slow_friction": 0.5},
    "friction_rate: give both": SLIDER | {"slow_friction": 0.02},
    "closing_speed: give both": GAP | {"restitution": 0.5},
    "less than 1": DULL | {"restitution": 1.0},
    "add plan = true": GAP | {"angle": "30 deg"},
    "with itself": {**GAP, "line": None, "body": "deck", "base": "deck"},
    "no body is called": {**GAP, "line": None, "body": "dekc"},
    "kind": GAP | {"kind": "spring"},
}


@pytest.mark.parametrize("text", list(BAD))
def test_bad_devices_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=re.escape(text)):
        deck(BAD[text])


def test_two_devices_of_one_name() -> None:
    with pytest.raises(InputError, match='two devices are called "D"'):
        deck(DAMPER, DAMPER)


def test_predictor_corrector_and_scripts_refuse_devices(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="predictor-corrector"):
        shaken(deck(DAMPER), linear_bearing(SPRING), np.zeros(3), DT, method="predictor-corrector")
    with pytest.raises(InputError, match="devices") as refusal:
        tb.opensees.write_structure(deck(*ALL), tmp_path / "model.py")
    # Each device, with the constants by which a user enters it in the script.
    texts = "\n".join(refusal.value.problems)
    for device in deck(*ALL).devices or ():
        assert f"{device.name}: 1 " in texts
        assert all(str(constant) in texts for constant in device.constants())


def test_constants_for_other_programs() -> None:
    """By hand, in kN, m and s, of one device whatever the count."""
    warm = {"temperatures": [-20.0, 20.0], "factors": [1.2, 1.0]}
    devices = deck(DAMPER | warm | {"velocity": 500.0, "count": 4}, FASTER, DULL).devices or ()
    damper, slider, gap = (
        {constant.name: (constant.value, constant.unit) for constant in device.constants()}
        for device in devices
    )
    coefficient, unit = damper["damping coefficient C"]
    # At 0.5 m/s it gives the stated force.
    assert coefficient * 0.5**0.3 == pytest.approx(300.0, rel=1e-12)
    assert unit == "kN (s/m)^alpha"
    assert damper["damping exponent alpha"] == (0.3, "")
    assert damper["factor of C with oil at -20 degC"][0] == 1.2
    assert slider["normal force"] == (3000.0, "kN")
    assert slider["fast friction coefficient"][0] == 0.06
    assert slider["slow friction coefficient"][0] == 0.02
    assert slider["rate parameter"] == (pytest.approx(20.0), "s/m")
    # It begins to slide at 0.2 mm.
    assert slider["stiffness before sliding"][0] * 0.2e-3 == pytest.approx(180.0)
    assert gap["opening (both sides)"] == (pytest.approx(0.06), "m")
    assert gap["stiffness in contact"] == (pytest.approx(60000.0), "kN/m")
    assert gap["coefficient of restitution at 0.3 m/s"][0] == 0.6
    assert devices[0].title() == "D: 4 viscous dampers parallel to the line L"
