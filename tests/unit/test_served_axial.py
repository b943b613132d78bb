"""Served bearings whose axial force, from their nodes, acts on the shear force."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.core.types import Floats
from thermobearing.earthquake.axial import with_axial_outcome
from thermobearing.model.axial import column_of, compression_constants
from thermobearing.model.options import build_model
from thermobearing.opensees.case import Layout, ServedCase, make_served_case
from thermobearing.opensees.element import ServedElement
from thermobearing.opensees.recording import ROWS_IN_MEMORY, Journal
from thermobearing.opensees.report import build_pieces
from thermobearing.opensees.result import ServedResult
from thermobearing.opensees.wire import Action, Request
from thermobearing.structure.fields import GRAVITY
from thermobearing.structure.model import Structure
from thermobearing.structure.run import (
    Line,
    PressedLine,
    StructureHistory,
    prepare_structure,
    run_structure,
)

LINE, PLANE = Layout.of(1, (1,), 3, "test"), Layout.of(1, (1, 2), 3, "test")
TOP = 6  # place of the first degree of freedom of the upper node
DT = 0.02  # s
TIME = DT * np.arange(1, 201)
GROWING = np.minimum(TIME / 2.0, 1.0)
X = 180.0 * np.sin(0.5 * math.pi * TIME) * GROWING  # mm
Y = 60.0 * np.sin(0.7 * math.pi * TIME) * GROWING
P = 900.0 + 800.0 * np.sin(3.0 * math.pi * TIME)  # kN


@pytest.fixture(scope="module")
def slender() -> tb.Bearing:
    return tb.new_bearing("slender", "shen-hdr", plan="350x310mm", layers="8x17mm", shim="4 mm")


def case(bearing: tb.Bearing, **given: object) -> ServedCase:
    return make_served_case({}, "test", bearing=bearing, **({"axial": "node"} | given))


class Driver:
    """Moves the upper node of an element.

    Numbers here are of one bearing in mm and kN; `length` [mm] and `force` [1/kN] are those of the
    model and of the bearings side by side.
    """

    def __init__(self, element: ServedElement, length: float = 1.0, force: float = 1.0) -> None:
        self.element, self._length, self._force = element, length, force

    def _request(self, action: Action, place: Floats, time: float) -> Request:
        n = self.element.layout.size
        x = [0.0] * TOP + (place / self._length).tolist()
        return Request(action, x, [1.0] * n, [0.0] * n, time)

    def ask(self, place: Floats, time: float) -> tuple[Floats, Floats]:
        """Return forces on the upper node and the tangent at a trial."""
        self.element.answer(self._request(Action.SET_TRIAL, place, time))
        force = np.asarray(self.element.answer(self._request(Action.FORCE, place, time)))
        tangent = np.asarray(self.element.answer(self._request(Action.TANGENT, place, time)))
        assert force[:TOP] == pytest.approx(-force[TOP:])
        stiffness = tangent.reshape(2 * TOP, 2 * TOP)[TOP:, TOP:] / (self._force * self._length)
        return force[TOP:] / self._force, stiffness

    def step(self, place: Floats, time: float) -> Floats:
        force, _ = self.ask(place, time)
        self.element.answer(self._request(Action.COMMIT, place, time))
        # Recorders ask for the force of a step after its commit.
        after = np.asarray(self.element.answer(self._request(Action.FORCE, place, time)))
        assert (after[TOP:] / self._force == force).all()
        return force

    def pressed(self, x: float, y: float, force: float, time: float) -> Floats:
        """Commit a step in which the axial force has a value in compression."""
        place = np.array([x, y, 0.0, 0.0, 0.0, 0.0])
        _, tangent = self.ask(place, time)
        place[2] = -force / tangent[2, 2]
        return self.step(place, time)


def follow(element: ServedElement, length: float = 1.0, force: float = 1.0) -> Floats:
    """Forces on the upper node along the histories above."""
    driver = Driver(element, length, force)
    y = Y if len(element.layout.directions) > 1 else 0.0 * Y
    return np.array([driver.pressed(*row) for row in zip(X, y, P, TIME, strict=True)])


def cyclic(bearing: tb.Bearing, components: int) -> tb.Result:
    """The same in a cyclic test with prescribed axial forces."""
    time = np.concatenate([[0.0], TIME])
    path = [np.concatenate([[0.0], side]) for side in (X, Y)[:components]]
    axial_force = time.tolist(), [0.0, *P.tolist()]
    return tb.run(bearing, (time, *path), ambient=-20.0, dt=DT, axial_force=axial_force)


@pytest.mark.parametrize("layout", [LINE, PLANE])
def test_the_law_is_that_of_cyclic_tests(slender: tb.Bearing, layout: Layout) -> None:
    components = len(layout.directions)
    expected = cyclic(slender, components)
    served = case(slender, ambient=-20.0)
    element = ServedElement(served, layout, 1)
    forces = follow(element)
    right = expected["force"].values[0, 1:].reshape(len(TIME), -1)
    peak = np.abs(right).max()
    assert np.abs(forces[:, :components] - right).max() < 1e-9 * peak
    assert np.abs(-forces[:, 2] - P).max() < 1e-9 * P.max()
    taken = np.abs(expected["stiffness_reduction"].values[0, 1:] * X).max()
    assert taken > 0.05 * peak  # the axial force matters
    result = ServedResult.of(served, element.histories())
    for k in range(components):
        assert np.abs(result["force"].values[k, 1:] - right[:, k]).max() < 1e-9 * peak
    # Works there are of the forces at the ends of steps, as in a structure.
    assert np.abs(result.energy["element_residual"]).max() < 1e-12
    for name in ("critical_load", "vertical_stiffness", "cavitation_force"):
        values = expected[name].values[0]
        assert result[name].values[0] == pytest.approx(values, rel=1e-9, abs=1e-9)


def test_units_count_and_journal_change_nothing(slender: tb.Bearing, tmp_path: Path) -> None:
    assert len(TIME) < ROWS_IN_MEMORY
    one = ServedElement(case(slender, ambient=-20.0), LINE, 1)
    right = follow(one)
    with (tmp_path / "histories").open("w+b") as file:
        journal = Journal(file)
        served = case(slender, ambient=-20.0, units="N-m", count=3)
        three = ServedElement(served, LINE, 1, journal=journal)
        forces = follow(three, length=1e3, force=3e3)
        three.flush()
        (written,) = journal.histories()
    assert forces == pytest.approx(right, rel=1e-9, abs=1e-9)
    assert written.axial["axial_force"][1:] == pytest.approx(P, rel=1e-9)
    assert written.response["force"][1:] == pytest.approx(right[:, 0], rel=1e-9, abs=1e-9)


def test_tangent_is_the_slope_of_the_force(slender: tb.Bearing) -> None:
    driver = Driver(ServedElement(case(slender), PLANE, 1))
    driver.pressed(90.0, 30.0, 1500.0, 0.5)
    place, h = np.array([95.0, 33.0, -0.4, 0.0, 0.0, 0.0]), 1e-6
    _, tangent = driver.ask(place, 0.6)
    for axis in range(3):
        moved = np.eye(6)[axis] * h
        slope = (driver.ask(place + moved, 0.6)[0] - driver.ask(place - moved, 0.6)[0]) / (2 * h)
        assert slope == pytest.approx(tangent[:, axis], rel=1e-4, abs=1e-4)


def test_bolted_bearings_cavitate_and_dowelled_ones_lift(slender: tb.Bearing) -> None:
    bolted = Driver(ServedElement(case(slender), LINE, 1))
    start = bolted.element.histories()[0].axial
    strength, stiffness = start["cavitation_force"][0], start["vertical_stiffness"][0]
    reach = strength / stiffness  # extension of cavitation [mm]
    law = compression_constants()
    k, phi = 0.01, law["cavitation_damage"]
    rubber = slender.total_rubber_thickness
    up = np.array([0.0, 0.0, 3.0 * reach, 0.0, 0.0, 0.0])
    pulled = bolted.step(up, 1.0)[2]
    beyond = (1.0 - math.exp(-k * 2.0 * reach)) / (k * rubber)
    assert pulled == pytest.approx(strength * (1.0 + beyond), rel=1e-9)
    weakened = strength * (1.0 - phi * (1.0 - math.exp(-2.0)))
    first = weakened / stiffness
    assert bolted.step(up * first / (3.0 * reach), 2.0)[2] == pytest.approx(weakened, rel=1e-9)
    (history,) = bolted.element.histories()
    assert history.outcome == "cavitated"

    served = case(slender, joint="dowelled")
    dowelled = Driver(ServedElement(served, LINE, 1))
    # Before any load too it has a stiffness, with which it can take one.
    assert dowelled.ask(0.0 * up, 0.5)[1][2, 2] == pytest.approx(stiffness)
    assert dowelled.step(up, 1.0)[2] == 0.0
    assert dowelled.step(-up, 2.0)[2] < 0.0
    dowelled.step(np.array([5.0, *up[1:]]), 3.0)
    result = ServedResult.of(served, dowelled.element.histories())
    assert result.outcome == "completed"
    assert result.table["uplift_mm"][0] == pytest.approx(3.0 * reach)
    assert result.table["cavitation_share"][0] == 0.0


def test_an_unstable_bearing_is_marked(slender: tb.Bearing) -> None:
    served = case(slender)
    element = ServedElement(served, LINE, 7)
    driver = Driver(element)
    driver.pressed(20.0, 0.0, 500.0, 1.0)
    assert element.histories()[0].outcome == "completed"
    driver.pressed(250.0, 0.0, 3000.0, 2.0)
    driver.pressed(10.0, 0.0, 100.0, 4.0)
    result = ServedResult.of(served, element.histories())
    assert result.outcome == "unstable"
    row = result.table.iloc[0]
    assert row["critical_share"] > 1.0
    assert row["valid_until_s"] == 2.0
    (warning,) = (text for text in result.warnings if getattr(text, "code", "") == "unstable")
    assert "element 7" in warning
    table = result.tables()["elements"]
    marked = {table.columns[place].name for _, place in table.marked}
    assert {"strain_max", "bearing_force_max_kN"} <= marked
    assert (result.bearing_checks["used"] > 1.0).any()
    driver.element.reset()
    assert element.histories()[-1].outcome == "completed"


def test_a_gravity_stage_with_a_rate_presses_the_bearing(slender: tb.Bearing) -> None:
    element = ServedElement(case(slender, rate=10.0), LINE, 1)
    down = [0.0] * (TOP + 2) + [-1.0, 0.0, 0.0, 0.0]
    still = [0.0] * (2 * TOP)
    for action in (Action.SET_TRIAL, Action.FORCE, Action.COMMIT):
        element.answer(Request(action, down, still, still, 1.0))
    moved = [*down]
    moved[TOP] = 5.0
    reduced = {}
    for axial in ("node", "off"):
        other = element if axial == "node" else ServedElement(case(slender, axial=axial), LINE, 1)
        other.answer(Request(Action.SET_TRIAL, moved, [1.0] * (2 * TOP), still, 1.5))
        reduced[axial] = np.asarray(other.answer(Request(Action.FORCE, moved, still, still, 1.5)))
    assert reduced["node"][TOP] < reduced["off"][TOP]


@pytest.mark.parametrize(
    "given",
    [
        {"joint": "dowelled", "axial": None},
        {"axial": "dead"},
        {"dowel_length": 40.0},
        {"joint": "dowelled", "dowel_length": 0.0},
    ],
)
def test_options_that_do_not_fit_are_refused(slender: tb.Bearing, given: dict[str, object]) -> None:
    with pytest.raises(tb.InputError):
        case(slender, **given)


def test_an_element_without_vertical_direction_is_refused(slender: tb.Bearing) -> None:
    with pytest.raises(tb.InputError, match="vertical"):
        case(slender).check_layout(Layout.of(1, (1,), None, "test"), "test")
    case(slender, axial="off").check_layout(Layout.of(1, (1,), None, "test"), "test")


LIFTED_MASS, SIDEWAYS, WARM = 0.05, 1000.0, 23.0  # kN s2/mm, mm/s2, degC
START = 1.0  # s: of the motion, after the dead load
LIFT_TIME = 0.0025 * np.arange(801)  # s
UPWARDS = 8000.0 * np.sin(20.0 * math.pi * LIFT_TIME) * np.minimum(LIFT_TIME, 1.0)  # mm/s2


def lifting_structure(bearing: tb.Bearing, joint: str, dowel_length: float) -> StructureHistory:
    """A mass on one bearing, which lifts or cavitates in a vertical motion."""
    line = {"name": "L", "body": "deck", "base": "ground", "count": 1, "equivalent_stiffness": 2.0}
    table = {
        "name": "lifting",
        "bodies": [{"name": "deck", "moves": True, "base_height": 0.0}],
        "masses": [{"body": "deck", "height": 0.0, "mass": LIFTED_MASS}],
        "bearings": [line],
        "damping": {"kind": "none"},
        "report": {"deck": "deck"},
    }
    constants = build_model(bearing).constants
    pressed = PressedLine(
        columns=column_of(bearing),
        dead_loads=np.array([GRAVITY * LIFTED_MASS]),
        places=np.zeros(1),
        moves=True,
        dowelled=joint == "dowelled",
        dowel_length=dowel_length,
        mass=LIFTED_MASS,
    )
    start = np.full(len(constants.cells.capacity), WARM)
    ground = SIDEWAYS * np.sin(2.0 * math.pi * LIFT_TIME) * np.minimum(LIFT_TIME, 1.0)
    return run_structure(
        prepare_structure(Structure(**table)),
        [Line(constants, start, pressed=pressed)],
        ground,
        float(LIFT_TIME[1]),
        np.full(len(LIFT_TIME) - 1, WARM),
        vertical=UPWARDS,
    )


def downward_displacement(force: Floats, start: float) -> Floats:
    """Displacement of the mass downwards [mm], from the axial force on it, by Newmark's method."""
    dt, displacement = float(LIFT_TIME[1]), [start]
    acceleration = GRAVITY - force / LIFTED_MASS + UPWARDS
    velocity = 0.0
    for before, after in pairwise(acceleration):
        displacement.append(displacement[-1] + dt * velocity + 0.25 * dt * dt * (before + after))
        velocity += 0.5 * dt * (before + after)
    return np.array(displacement)


def follow_structure(
    structure: StructureHistory, bearing: tb.Bearing, **options: object
) -> tuple[Floats, ServedResult]:
    """Axial forces of a served bearing along the motion of one in a structure, and its result."""
    assert structure.axial is not None
    axial = structure.axial.force[:, 0]
    served = case(bearing, ambient=WARM, **options)
    driver = Driver(ServedElement(served, LINE, 1))
    driver.pressed(0.0, 0.0, float(axial[0]), START)
    # The first step has pressed it; its shear begins with the next one.
    start = -float(driver.element.histories()[0].axial["shortening"][-1])
    moved, forces = structure.bearing()["displacement"], []
    downwards = downward_displacement(axial, -start)
    for x, downward, time in zip(moved[1:], downwards[1:], LIFT_TIME[1:], strict=True):
        place = np.array([x, 0.0, -downward, 0.0, 0.0, 0.0])
        forces.append(-driver.step(place, START + time)[2])
    return np.array(forces), ServedResult.of(served, driver.element.histories())


@pytest.mark.parametrize("longer", [0.9, 1.1])
def test_uplift_is_that_of_a_structure(slender: tb.Bearing, longer: float) -> None:
    peak = lifting_structure(slender, "dowelled", 0.0).axial.peaks[0]
    dowel_length = longer * float(peak.uplift)
    structure = lifting_structure(slender, "dowelled", dowel_length)
    forces, result = follow_structure(
        structure, slender, joint="dowelled", dowel_length=dowel_length
    )
    axial = structure.axial.force[1:, 0]
    assert (axial == 0.0).any()
    assert forces == pytest.approx(axial, abs=1e-8 * axial.max())
    shear, right = result["force"].values[0, 2:], structure.bearing()["force"][1:]
    assert shear == pytest.approx(right, abs=1e-9 * np.abs(right).max())
    taken = result["stiffness_reduction"].values[0, 2:] * structure.bearing()["displacement"][1:]
    assert np.abs(taken).max() > 1.0
    assert result.table["uplift_mm"][0] == pytest.approx(peak.uplift, rel=1e-8)
    outcome = with_axial_outcome("completed", structure.axial)
    assert result.outcome == outcome == ("uplift" if longer < 1.0 else "completed")
    (warning,) = (text for text in result.warnings if getattr(text, "code", "") == "uplift")
    assert f"first at {START + peak.least_time:.4g} s" in warning


@pytest.mark.parametrize(("joint", "outcome"), [("dowelled", "completed"), ("bolted", "cavitated")])
def test_works_are_those_of_a_structure(slender: tb.Bearing, joint: str, outcome: str) -> None:
    structure = lifting_structure(slender, joint, 0.0)
    _, result = follow_structure(structure, slender, joint=joint)
    assert result.outcome == outcome == with_axial_outcome("completed", structure.axial)
    row, works = result.energy.iloc[0], structure.axial.energies[0]
    pressed = result["axial_work"].values[0, 1]  # before the motion
    dead_load = GRAVITY * LIFTED_MASS
    assert pressed == pytest.approx(0.5 * dead_load * result["shortening"].values[0, 1])
    assert row["axial_work_kN_mm"] - pressed == pytest.approx(works.axial_work, rel=1e-7)
    assert row["lent_kN_mm"] == pytest.approx(works.lent, rel=1e-7)
    # What the motion of the ground and the dead load put in, the mass and the bearing have.
    input_energy = works.weight + works.vertical_input - works.vertical_kinetic
    scale = 1e-9 * works.vertical_input
    assert row["axial_work_kN_mm"] - pressed == pytest.approx(input_energy, abs=scale)
    input_energy = structure.rows.energies["input"][-1] - structure.rows.energies["kinetic"][-1]
    shear = row["node_work_kN_mm"] - row["axial_work_kN_mm"]
    assert shear == pytest.approx(input_energy, rel=1e-9)
    assert abs(row["element_residual"]) < 1e-10
    tables = result.tables()
    assert "axial_work_kN_mm" in [column.name for column in tables["node_works"].columns]
    assert "axial_work_kN_mm" not in [column.name for column in tables["energy"].columns]
    assert "node_works" in build_pieces(result).tables
    earlier = ServedResult(result.dataset.drop_vars(["axial_work", "axial_stored"]))
    assert list(earlier.tables()) == [name for name in tables if name != "node_works"]
