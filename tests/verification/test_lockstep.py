"""Runs in lockstep against the same runs alone: one physics, two ways through it."""

import dataclasses
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from tests import tolerances as tol
from tests.quick import quick_cases
from tests.reference.lockstep import march_lanes
from tests.verification.models import assembled, changed
from tests.verification.structures import read_ground, real_bearing
from tests.verification.test_structures_in_plan import eccentric_deck
from thermobearing.bearing.library import list_bearings, load_bearing
from thermobearing.bearing.model import Bearing, Scragging, TemperatureLaw
from thermobearing.core import types
from thermobearing.core.lanes.memory import WIDTH, aligned, side_by_side
from thermobearing.core.march import march
from thermobearing.core.records import rows
from thermobearing.earthquake.measures import loading_speed
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure.lanes import Run, RunPeaks, run_lanes, run_peaks, with_shared_cells
from thermobearing.structure.matrices import displacement_row
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, StructureHistory, prepare_structure, run_structure

DT, STEPS = 0.02, 400
HDR, LHDR, LRB = "shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example"
MODELS: dict[str, dict[str, Any]] = {
    "conservative": {},
    "published": {"scheme": "published"},
    "euler": {"scheme": "published", "integrator": "euler"},
    "dissipation": {"heat_source": "dissipation"},
    "finite-plate": {"lead_ends": "finite-plate"},
    "monotone": {"hardening": "monotone"},
    "full": {"half": False},
}


def variants(bearing: Bearing, **options: Any) -> list[types.Constants]:
    k = bearing.hysteresis.layer_stiffness
    stiffer = [k * (0.8 + 0.4 * lane / WIDTH) for lane in range(WIDTH)]
    return [
        assembled(changed(bearing, hysteresis={"layer_stiffness": one}), **options)
        for one in stiffer
    ]


def begun(bearing: Bearing, constants: types.Constants, lane: int) -> tuple[Any, ...]:
    """Arguments of a march: growing cycles, another amplitude and temperature for every lane."""
    n, layers = len(constants.cells.capacity), len(constants.multiplicity)
    time = DT * np.arange(1, STEPS + 1)
    largest = bearing.total_rubber_thickness * (1.2 + 0.1 * lane)
    x = largest * time / time[-1] * np.sin(np.pi * time)
    x[STEPS // 2 : STEPS // 2 + 20] = x[STEPS // 2]
    air = -30.0 + 3.0 * lane
    state, spare = (types.new_state(constants, np.full(n, air)) for _ in range(2))
    path = types.Path(x, np.full(STEPS, DT), np.full(STEPS, air), np.ones(STEPS, np.bool_), 0.0)
    room = types.Kept(
        rows(types.BearingResponse, STEPS),
        *(np.zeros((STEPS, layers)) for _ in range(3)),
        np.zeros((STEPS, n)),
    )
    return constants, types.new_workspace(constants), state, spare, path, room


def assert_alike(bearing: Bearing, constants: list[types.Constants]) -> list[int]:
    """Lockstep and alone agree in force and temperatures; what ended the runs."""
    alone = [begun(bearing, one, lane) for lane, one in enumerate(constants)]
    together = side_by_side([begun(bearing, one, lane) for lane, one in enumerate(constants)])
    ends = aligned((3, WIDTH), np.float64)
    march_lanes(*together, ends)
    outcomes = []
    for lane, one in enumerate(alone):
        done, kept, outcome, softened, _ = march(*one)
        outcomes.append(outcome)
        assert ends[0, lane] == outcome
        if outcome in (types.COMPLETED, types.SOFTENED):  # one that failed goes on, to no use
            assert ends[1, lane] == softened
        room, room_together = one[-1], together[-1]
        force = room.response["force"][:kept]
        apart = np.abs(force - room_together.response["force"][:kept, lane]).max()
        assert apart <= tol.LANE_FORCE * np.abs(force).max()
        cells = room.cells[:kept] - room_together.cells[:kept, :, lane]
        assert np.abs(cells).max() <= tol.LANE_TEMPERATURE
        assert done == kept
    return outcomes


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", quick_cases([HDR, LHDR, "shen-lhdr-bridge", LRB], 0, 3))
def test_every_model_in_lockstep_is_the_model_alone(name: str, model: str) -> None:
    bearing = load_bearing(name)
    if bearing.lead is None and model == "finite-plate":
        assert HDR in list_bearings()
        return
    outcomes = assert_alike(bearing, variants(bearing, **MODELS[model]))
    assert set(outcomes) <= {types.COMPLETED, types.SOFTENED}


def test_a_run_that_fails_spoils_no_other() -> None:
    """Explicit Euler over a jump: some lanes end there, the others go on as alone."""
    bearing = load_bearing(HDR)
    constants = variants(bearing, **MODELS["euler"])
    alone = [begun(bearing, one, lane) for lane, one in enumerate(constants)]
    for lane, one in enumerate(alone):
        one[4].x[300] += 60.0 * (lane % 2)
    together = side_by_side(alone)
    ends = aligned((3, WIDTH), np.float64)
    march_lanes(*together, ends)
    for lane, one in enumerate(alone):
        done, _, outcome, _, _ = march(*one)
        assert ends[0, lane] == outcome
        assert outcome == (types.EULER_UNSTABLE if lane % 2 else types.COMPLETED)
        force = one[-1].response["force"][:done]
        apart = np.abs(force - together[-1].response["force"][:done, lane]).max()
        assert apart <= tol.LANE_FORCE * np.abs(force).max()


def test_virgin_rubber_in_lockstep() -> None:
    virgin = Scragging(
        amplitude=0.5, strain=1.0, mullins_amplitude=0.3, mullins_decay=4.0, mullins_renewal=0.5
    )
    bearing = load_bearing(HDR).model_copy(update={"scragging": virgin})
    assert_alike(bearing, variants(bearing))


@pytest.mark.parametrize("shape", [1.0, 2.5])
def test_other_curvatures_in_lockstep(shape: float) -> None:
    """Unloading along a straight line, and along a tanh (s > 1)."""
    bearing = changed(load_bearing(HDR), hysteresis={"shape": shape})
    assert_alike(bearing, variants(bearing))


@pytest.mark.parametrize("name", [HDR, LHDR])
def test_a_temperature_table_in_lockstep(name: str) -> None:
    """Lanes from -30 degC on, so that each part of the table and both its ends have some."""
    law = TemperatureLaw(
        temperatures=[-25.0, -20.0, -15.0],
        elastic=[1.4, 1.2, 1.0],
        hysteretic=[2.0, 1.3, 1.0],
        viscosity=[4.0, 2.0, 1.0],
    )
    none = {"elastic_temperature_coefficient": 0.0, "hysteretic_temperature_coefficient": 0.0}
    bearing = changed(load_bearing(name), hysteresis=none)
    assert_alike(bearing, variants(bearing.model_copy(update={"temperature_law": law})))


def leaving_tests(constants: list[types.Constants]) -> list[types.Constants]:
    """Lead that leaves its tests at another temperature in every lane, or never."""
    return [
        item._replace(lead=item.lead._replace(warmest_tested=-20.0 + 10.0 * lane))
        for lane, item in enumerate(constants)
    ]


@pytest.mark.parametrize("name", [LHDR, "shen-lhdr-softening"])
def test_lead_beyond_its_tests_in_lockstep(name: str) -> None:
    bearing = load_bearing(name)
    assert_alike(bearing, leaving_tests(variants(bearing)))


@pytest.mark.parametrize("within", [True, False])
def test_company_does_not_matter(within: bool) -> None:
    """A run has the same bits beside others, which need more trials, as beside copies of itself."""
    bearing = load_bearing(LHDR)
    constants = variants(bearing) if within else leaving_tests(variants(bearing))

    def march_together(lanes: Iterable[int]) -> types.Kept:
        joined = side_by_side([begun(bearing, constants[lane], lane) for lane in lanes])
        march_lanes(*joined, aligned((3, WIDTH), np.float64))
        return joined[-1]

    mixed = march_together(range(WIDTH))
    for lane in range(0, WIDTH, 3):
        alike = march_together([lane] * WIDTH)
        for name in ("force", "work_in", "heat_stored", "lead_temperature"):
            expected = np.repeat(mixed.response[name][..., lane, None], WIDTH, axis=-1)
            assert_array_equal(alike.response[name], expected)
        assert_array_equal(alike.cells[..., 0], mixed.cells[..., lane])


STRUCTURE = "pier-p1"  # in lockstep it is compiled for more than a minute: thorough


def shakes(dt: float = 0.01, duration: float = 12.0) -> list[Run]:
    """Runs of two shapes: three bearings, temperatures, scales; some hinges yield."""
    prepared = prepare_structure(load_structure(STRUCTURE))
    ground = read_ground("jra-ii-i-1", dt, duration)
    bearings = [
        real_bearing("shen-lhdr-bridge"),
        bilinear_constants(BilinearParameters(154.8, 2.0, 15.0)),
    ]
    result = []
    for number in range(WIDTH + 4):
        constants = bearings[number % 2]
        air = -25.0 + 2.5 * number
        line = Line(constants, np.full(len(constants.cells.capacity), air))
        shaken = (0.8 + 0.1 * number) * ground
        result.append(Run(prepared, [line], shaken, dt, air))
    return result


def list_numbers(result: RunPeaks) -> dict[str, Any]:
    groups = ("watches", "lines", "hinges", "energies", "bearings")
    columns = {group: getattr(result, group) for group in groups}
    return {f"{g}.{name}": c[name] for g, c in columns.items() for name in c.dtype.names}


NOISE = ("mismatch", "iterations")
SCALES = {  # what the end of a run is a part of
    "watches.residual": "watches.displacement",
    "bearings.displacement": "lines.displacement",
    "bearings.force": "lines.force",
    "bearings.rubber_force": "lines.force",
    "bearings.lead_force": "lines.force",
    "bearings.viscous_force": "lines.force",
    "energies.kinetic": "energies.input",
    "energies.springs": "energies.input",
    "energies.hinges": "energies.input",
}


def in_plan(run: Run) -> Run:
    """The same with a second motion across, and a mass next to the bearings: it twists."""
    prepared = prepare_structure(eccentric_deck())
    other = 0.8 * read_ground("jra-ii-i-2", run.dt, run.dt * (len(run.ground) - 1))
    ground = 0.5 * np.stack([run.ground, other], axis=-1)
    return dataclasses.replace(run, prepared=prepared, lines=[*run.lines] * 4, ground=ground)


@pytest.mark.thorough
@pytest.mark.parametrize("plan", [False, True])
def test_bridges_in_lockstep_are_bridges_alone(plan: bool) -> None:
    runs = [in_plan(run) for run in shakes()] if plan else shakes()
    together = run_lanes(runs)
    assert not any(one.alone for one in together)
    if not plan:
        bent = [float(one.hinges["rotation"][0]) for one in together]
        yields = runs[0].prepared.structure.hinges[0].yield_rotation
        assert min(bent) < yields < max(bent)
    for run, result in zip(runs, together, strict=True):
        wanted = run_peaks(run)
        assert (result.outcome, result.steps) == (wanted.outcome, wanted.steps)
        known = list_numbers(wanted)
        for name, values in list_numbers(result).items():
            if not name.endswith(NOISE):
                scale = known[SCALES.get(name, name)]
                if scale.shape != values.shape:  # components of a vector, and its peaks
                    scale = scale[..., -1:]
                apart = np.abs(values - known[name])
                assert np.all(apart <= tol.LANE_PEAK * np.abs(scale)), name


def with_rows(run: Run) -> StructureHistory:
    air = np.full(len(run.ground) - 1, run.ambient)
    return run_structure(run.prepared, run.lines, run.ground, run.dt, air)


def test_peaks_in_plan_are_those_of_the_rows() -> None:
    """The largest of each component and of the resultant."""
    run = in_plan(shakes(duration=8.0)[7])
    result, history = run_peaks(run), with_rows(run)
    assert (result.outcome, result.iterations) == (history.outcome, history.iterations)
    for line in range(4):
        for name in ("displacement", "force"):
            values = np.asarray(history.bearing(line)[name])
            size = np.hypot(values[:, 0], values[:, 1]).max()
            assert_array_equal(result.lines[name][line, :2], np.abs(values).max(axis=0))
            assert_allclose(result.lines[name][line, 2], size, rtol=tol.LOOP)
        speed = np.hypot(*loading_speed(history.bearing(line)).T).max()
        assert_allclose(result.lines["speed"][line, 2], speed, rtol=tol.LOOP)
    assert_array_equal(result.watches["displacement"][:, 0], np.abs(history.rows.q).max(axis=0))
    place = displacement_row(run.prepared.structure, "deck", 0.0, 1e4, 5e3)[None]
    watched = dataclasses.replace(run, places=place, carried=np.ones(1))
    acceleration = np.einsum("tn,nc->tc", history.rows.a, place[0]) + run.ground
    wanted = [*np.abs(acceleration).max(axis=0), np.hypot(*acceleration.T).max()]
    assert_allclose(run_peaks(watched).watches["acceleration"][0], wanted, rtol=tol.LOOP)


@pytest.mark.thorough
def test_peaks_are_those_of_the_rows() -> None:
    run = shakes()[7]
    result = run_peaks(run)
    history = with_rows(run)
    bearing, hinge = history.bearing(), history.hinge()
    assert (result.steps, result.iterations) == (history.steps, history.iterations)
    assert result.lines["displacement"][0] == np.abs(bearing["displacement"]).max()
    assert result.lines["force"][0] == np.abs(bearing["force"]).max()
    assert result.hinges["rotation"][0] == np.abs(hinge["rotation"]).max()
    assert result.hinges["moment"][0] == np.abs(hinge["moment"]).max()
    assert_array_equal(result.watches["displacement"], np.abs(history.rows.q).max(axis=0))
    assert_array_equal(result.watches["residual"], history.rows.q[-1])
    assert_array_equal(result.watches["acceleration"], np.abs(history.rows.a).max(axis=0))
    assert result.energies[0].input == history.rows.energies[-1].input
    warm = run_peaks(shakes()[8])
    air = shakes()[8]
    rows_ = with_rows(air)
    assert warm.lines["rubber_temperature"][0] == rows_.layers().max()
    lead = rows_.bearing()["lead_temperature"]
    assert warm.lines["lead_temperature"][0] == lead.max()
    assert warm.lines["coldest_lead"][0] == lead.min() < lead.max()
    speed = np.abs(loading_speed(rows_.bearing())).max()
    assert_allclose(warm.lines["speed"][0], speed, rtol=tol.LOOP)


def test_a_run_that_ends_early_has_the_numbers_of_its_last_whole_step() -> None:
    """Halves of the step in which it ends moved energies by 3 %, the bearing by 14 mm of 409."""
    prepared = prepare_structure(load_structure(STRUCTURE))
    constants, air = real_bearing("shen-lhdr-bridge"), 60.0
    constants = constants._replace(lead=constants.lead._replace(softening_beyond=0.0))
    line = Line(constants, np.full(len(constants.cells.capacity), air))
    run = Run(prepared, [line], 10.0 * read_ground("jra-ii-i-1", 0.01, 10.0), 0.01, air)
    result, history = run_peaks(run), with_rows(run)
    assert (result.outcome, result.steps) == (history.outcome, history.steps)
    assert result.outcome == "lead_melted"
    assert result.bearings[0] == history.bearing()[-1]
    for name in ("input", "kinetic", "hinges"):
        assert result.energies[0][name] == history.rows.energies[-1][name]
    at_once = run_peaks(dataclasses.replace(run, ground=np.array([0.0, np.nan])))
    work_and_input = at_once.bearings["work_in"][0], at_once.energies["input"][0]
    assert (at_once.steps, *work_and_input) == (0, 0, 0)


@pytest.mark.thorough
def test_absolute_acceleration_of_a_place() -> None:
    run = shakes()[0]
    places, carried = np.array([[1.0, 0.0, 0.0, 0.0]]), np.array([1.0])
    watched = Run(
        run.prepared, run.lines, run.ground, run.dt, run.ambient, places=places, carried=carried
    )
    history = with_rows(run)
    wanted = np.abs(history.rows.a[:, 0] + run.ground).max()
    for result in (run_peaks(watched), run_lanes([watched])[0]):
        assert result.watches["acceleration"][0] == pytest.approx(wanted, rel=tol.LANE_PEAK)


@pytest.mark.thorough
def test_order_of_bridges_does_not_matter() -> None:
    runs = shakes(duration=3.0)
    first = run_lanes(runs)
    second = run_lanes(runs[::-1])[::-1]
    single = run_lanes(runs[3:4])[0]
    for one, other in [*zip(first, second, strict=True), (first[3], single)]:
        mine, theirs = list_numbers(one), list_numbers(other)
        assert all(np.array_equal(mine[name], theirs[name]) for name in mine)


def test_groups_of_a_lockstep_leave_no_traces_in_each_other() -> None:
    """All groups are written into the same lanes: neither results nor starts may be shared."""
    runs = shakes(duration=2.0)
    halves = [dataclasses.replace(run, ground=0.5 * run.ground) for run in runs]
    together = run_lanes([*runs, *halves])
    apart = [*run_lanes(runs), *run_lanes(halves)]
    for one, other in zip(together, apart, strict=True):
        mine, theirs = list_numbers(one), list_numbers(other)
        assert all(np.array_equal(mine[name], theirs[name]) for name in mine)


@pytest.mark.thorough
def test_bearings_of_another_heat_are_in_another_lockstep() -> None:
    runs = shakes(duration=3.0)[:2]
    line = runs[0].lines[0]
    cells = line.constants.cells._replace(side_loss=0.01 + line.constants.cells.side_loss)
    other = dataclasses.replace(line, constants=line.constants._replace(cells=cells))
    air = runs[0].ambient + 50.0
    both = [dataclasses.replace(runs[0], lines=[one], ambient=air) for one in (line, other)]
    result = run_lanes(both)
    warm = [one.lines["rubber_temperature"][0] for one in result]
    assert warm[1] > warm[0] + 0.01
    for run, one in zip(both, result, strict=True):
        wanted = run_peaks(run).lines["rubber_temperature"][0]
        assert one.lines["rubber_temperature"][0] == pytest.approx(wanted, rel=tol.LANE_PEAK)
    shared = [with_shared_cells(one.lines[0].constants) for one in both]
    with pytest.raises(ValueError, match="unequal heat"):
        side_by_side(shared * (WIDTH // 2))


@pytest.mark.thorough
def test_what_leaves_the_lockstep_is_run_alone() -> None:
    """Steps that are cut, and numbers that end a run, together with one that goes through."""
    prepared = prepare_structure(load_structure(STRUCTURE))
    ground = read_ground("jra-ii-i-1", 0.05, 10.0)
    constants = real_bearing("shen-lhdr-bridge")
    spoilt = ground.copy()
    spoilt[100] = np.nan
    runs = []
    for shaken in (0.1 * ground, 9.0 * ground, spoilt, 0.05 * ground):
        line = Line(constants, np.full(len(constants.cells.capacity), -30.0))
        runs.append(Run(prepared, [line], shaken, 0.05, -30.0))
    result = run_lanes(runs)
    assert [one.alone for one in result] == [False, True, True, False]
    assert result[2].outcome != "completed"
    assert result[2].steps < len(ground) - 1
    for place in (1, 2):
        mine, theirs = list_numbers(result[place]), list_numbers(run_peaks(runs[place]))
        assert all(np.array_equal(mine[name], theirs[name]) for name in mine)
    quiet = run_lanes([runs[0]])[0]
    assert list_numbers(quiet)["lines.force"] == list_numbers(result[0])["lines.force"]


def test_the_predictor_has_no_lockstep() -> None:
    run = shakes(duration=1.0)[0]
    given = {name: getattr(run, name) for name in ("prepared", "lines", "ground", "dt", "ambient")}
    with pytest.raises(ValueError, match="predictor-corrector"):
        run_lanes([Run(**given, method="predictor-corrector")])
