"""small_loops = "closed": small reversals come back, steady loops stay as published."""

import copy
import pickle
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.verification.models import assembled, changed, marched, smooth_history, specimen
from tests.verification.softened import Trials
from tests.verification.test_lockstep import assert_alike as lockstep_is_one_by_one
from tests.verification.test_lockstep import variants
from thermobearing.bearing.scaling import extract_compound
from thermobearing.core.hysteresis import NO_MOTION, advance, remember
from thermobearing.core.march import copy_state
from thermobearing.core.records import Floats
from thermobearing.core.types import COMPLETED, DEPTH, SOFTENED, new_state

CLOSED: dict[str, Any] = {"small_loops": "closed"}
LOOPS_CLOSED = tb.ModelOptions(**CLOSED)
D_Y, SHAPES = 4.5, (-0.99, -0.86, -0.3, 0.5, 1.0, 1.7)  # [mm], [1]
NESTED = (20.0, 15.0, 18.0, 16.5, 17.5, 17.0, 18.0, 15.0, 20.0, 21.0)
LHDR, HDR = "shen-lhdr-specimen", "shen-hdr-specimen"


class Law:
    def __init__(self, shape: float = -0.86, small_loops: str = "closed") -> None:
        given = {"shape": shape, "yield_displacement": D_Y, "small_loops": small_loops}
        constants = assembled(changed(specimen(), hysteresis=given), small_loops=small_loops)
        self.rubber = constants.rubber
        self.old, self.new = (new_state(constants, np.full(19, 23.0)) for _ in range(2))

    def at(self, d: float) -> tuple[float, float]:
        """Z and dZ/dd at d; nothing is remembered."""
        z, slope = advance(self.rubber, self.old, 0, d, d - self.old.layers["d"][0])
        return float(z), float(slope)

    def to(self, d: float) -> float:
        layer = self.new.layers[0]
        layer.d, layer.z = d, self.at(d)[0]
        if self.rubber.closed_loops:
            remember(self.rubber, self.old, self.new, 0, d - float(self.old.layers["d"][0]))
        copy_state(self.new, self.old)
        return float(layer.z)

    def along(self, path: Iterable[float]) -> Floats:
        return np.array([self.to(d) for d in path])

    @property
    def turns(self) -> int:
        return int(self.old.layers["turns"][0])


def decaying(ratio: float, count: int, largest: float = 20.0) -> Floats:
    k = np.arange(count)
    return largest * (-ratio) ** k


def random_path(rng: np.random.Generator) -> Floats:
    return np.cumsum(rng.normal(size=20) * 10.0 ** rng.uniform(-1.5, 1.0, 20))


@pytest.mark.parametrize("shape", quick_cases(SHAPES, 0, 3))
@pytest.mark.parametrize(("amplitude", "apart"), [(3.0, 1e-5), (8.0, 1e-13)])
def test_steady_loops_are_the_published_ones(shape: float, amplitude: float, apart: float) -> None:
    """Closed loops repeat from the second cycle on, published ones converge: alike if saturated."""
    turns = [(-1.0) ** k * amplitude * D_Y for k in range(8)]
    path = np.concatenate([np.linspace(a, b, 60)[1:] for a, b in pairwise([0, *turns])])
    closed, published = (Law(shape, law).along(path) for law in ("closed", "published"))
    steady = slice(len(path) // 2, None)
    assert_allclose(closed[steady], published[steady], rtol=0, atol=apart * D_Y)


@pytest.mark.parametrize(("smallest", "limit"), [(10, 1e-4), (5, 5e-3)])
def test_loops_that_grow_and_shrink_hardly_differ(
    smallest: int, limit: float, measured: Recorder
) -> None:
    amplitudes = [*range(smallest, 41, 5), *range(40, smallest - 1, -5)]
    path = [sign * a for a in amplitudes for sign in (1, -1)]
    closed, published = (Law(small_loops=law).along(path) for law in ("closed", "published"))
    apart = np.abs(closed - published).max() / D_Y
    what = f"closed against published, loops of {smallest} to 40 mm and back, d_y 4.5 mm, of d_y"
    measured(what, apart, f"{limit:g}")
    assert apart < limit


def test_a_small_reversal_comes_back(measured: Recorder) -> None:
    z, back, again = Law().along([20, 19, 20])
    assert back < 0.5 * z
    assert again == z
    measured("Z after 20, 19, 20 mm, closed (published 1.596)", again, "4.499 +- 0.001")
    assert_allclose(
        [z, Law(small_loops="published").along([20, 19, 20])[2]], [4.499, 1.596], atol=5e-4
    )


def test_nested_loops_close_each() -> None:
    law = Law()
    z = dict(zip(range(len(NESTED)), law.along(NESTED), strict=True))
    assert (z[6], z[7], z[8]) == (z[2], z[1], z[0])
    assert law.turns == 0
    assert_allclose(z[9], Law().to(21.0), rtol=0, atol=tol.EXACT_Z * D_Y)


@pytest.mark.parametrize("paths", quick_cases([60, 300], 0))
def test_an_increment_cut_in_three_is_the_same(paths: int, measured: Recorder) -> None:
    worst = 0.0
    for seed in range(paths):
        rng = np.random.default_rng(seed)
        shape = SHAPES[seed % len(SHAPES)]
        path = random_path(rng)
        cuts = np.sort(rng.uniform(size=(len(path), 2)))
        fine = [
            a + part * (b - a)
            for a, b, c in zip([0.0, *path[:-1]], path, cuts, strict=True)
            for part in (*c, 1)
        ]
        whole, thirds = Law(shape).along(path), Law(shape).along(fine)[2::3]
        worst = max(worst, np.abs(whole - thirds).max() / D_Y)
        assert np.abs(thirds).max() <= D_Y * (1.0 + tol.BOUND_ROUNDING)
    measured("closed loops, increments cut in three, of d_y", worst, "1e-14")
    assert worst < 1e-14


@pytest.mark.parametrize("shape", SHAPES)
def test_tangent_is_the_derivative(shape: float) -> None:
    law, rng, h = Law(shape), np.random.default_rng(7), tol.TANGENT_STEP * D_Y
    for d in random_path(rng):
        for x in rng.uniform(-5.0, 5.0, 5) + law.old.layers["d"][0]:
            above, below = law.at(x + h)[0], law.at(x - h)[0]
            left, right = (law.at(x)[0] - below) / h, (above - law.at(x)[0]) / h
            if abs(left - right) < 0.01:  # no branch ends between
                difference, slope = (above - below) / (2.0 * h), law.at(x)[1]
                assert_allclose(slope, difference, rtol=1e-5, atol=1e-6)
        law.to(d)


@pytest.mark.parametrize("end", quick_cases([-30.0, 30.0], 0))
@pytest.mark.parametrize("ratio", quick_cases([0.94, 0.8], 0))
def test_more_reversals_than_are_remembered_leave_no_jump(ratio: float, end: float) -> None:
    """The outermost point of a full memory moves, so that Z is continuous (else by 0.8 d_y)."""
    law = Law()
    law.along(decaying(ratio, 3 * DEPTH))
    assert 0 < law.turns <= DEPTH
    places, step = np.linspace(law.old.layers["d"][0], end, 4001, retstep=True)
    z = [law.to(places[0])]
    for d in places[1:]:
        slope = law.at(d - step * (1.0 - 1e-9))[1]
        z.append(law.to(d))
        assert -1e-12 <= (z[-1] - z[-2]) / step <= slope + 1e-3  # branches bend downwards
    assert abs(z[-1]) == pytest.approx(Law().to(30.0), rel=1e-4)
    assert law.turns <= 1


def test_exactly_as_many_as_fit_close_again() -> None:
    law = Law()
    turns = decaying(0.8, DEPTH + 2)  # the second reversal is an outer one, the end none
    z = law.along(turns)
    assert law.turns == DEPTH
    assert_allclose(law.along(turns[-3::-2]), z[-3::-2], rtol=0, atol=0)


def test_rounding_is_no_reversal() -> None:
    law = Law()
    law.along([20, 19, 19.5])
    law.along(19.5 + 0.1 * NO_MOTION * D_Y * np.array([1, -1, 1, -1, 0, 1]))
    assert law.turns == 2


@pytest.fixture(scope="module")
def shaken() -> Floats:
    """A random history with reversals of 0.5 mm on it."""
    slow = smooth_history(np.random.default_rng(5), 60.0, 1500)
    return slow + 0.5 * np.sin(0.9 * np.arange(1500))


@pytest.mark.parametrize("temperature", quick_cases([-40.0, -20.0, 23.0], 0, 2))
@pytest.mark.parametrize("half", quick_cases([True, False], 0))
def test_layers_share_one_force_and_z_is_the_law(
    shaken: Floats, temperature: float, half: bool
) -> None:
    constants = assembled(specimen(), half=half, **CLOSED)
    run = marched(constants, shaken, 5e-3, temperature, temperature)
    assert run.outcome in (COMPLETED, SOFTENED)
    peak = np.abs(run.response["force"]).max()
    plain = run.response["sharing_weight"] == 0.0
    assert plain.mean() > 0.8
    assert run.response["layer_force_mismatch"][plain].max() < tol.EQUAL_FORCE * peak
    for j in range(run.d.shape[1]):
        law = Law()
        law.rubber = constants.rubber
        z = law.along(run.d[:, j])
        assert_allclose(run.z[:, j], z, rtol=0, atol=1e-10 * constants.rubber.yield_displacement)


@pytest.mark.parametrize("source", ["work", "dissipation"])
@pytest.mark.parametrize("temperature", [-30.0, 23.0])
def test_energy_balances(shaken: Floats, source: str, temperature: float) -> None:
    constants = assembled(specimen(), heat_source=source, **CLOSED)
    response = marched(constants, shaken, 5e-3, temperature, temperature).response[-1]
    missing = response.work_in - response.heat_released - response.recoverable
    assert abs(missing) < tol.ENERGY_BALANCE * response.work_in
    assert response.heat_released > 0.0


def test_the_tangent_of_a_bearing(shaken: Floats) -> None:
    trials = Trials(assembled(specimen(), **CLOSED), 0.0, 5e-3)
    new, errors, h = new_state(trials.constants, trials.state.temperature), [], 1e-6
    for i, x in enumerate(shaken[:600]):
        tangent = trials.step(x, new)[1]
        if i % 7 == 3:
            slope = (trials.force(x + h) - trials.force(x - h)) / (2.0 * h)
            errors.append(abs(tangent / slope - 1.0))
        copy_state(new, trials.state)
    assert np.quantile(errors, 0.9) < tol.TANGENT_BEARING


@pytest.mark.parametrize("name", [HDR, LHDR])
def test_lockstep_is_one_by_one(name: str) -> None:
    bearing = tb.load_bearing(name)
    outcomes = lockstep_is_one_by_one(bearing, variants(bearing, **CLOSED))
    assert set(outcomes) <= {COMPLETED, SOFTENED}


def test_an_element_commits_goes_back_and_is_copied() -> None:
    element = tb.element("shen-hdr-bridge", 23, model=LOOPS_CLOSED)
    for x in (*range(2, 101, 2), 99, 100.5):
        element.set_trial(x, 0.01)
        element.set_trial(x - 3.0, 0.01)  # a trial that is not taken leaves no turning point
        element.set_trial(x, 0.01)
        element.commit()
    assert set(element.state.layers["turns"]) == {0.0}
    saved = element.save()
    others = [copy.deepcopy(element), pickle.loads(pickle.dumps(element))]
    forces = []
    for one in (element, *others):
        for x in (98.0, 99.0, 98.5):
            result = one.set_trial(x, 0.01)
            one.commit()
        forces.append(result.force)
    assert set(element.state.layers["turns"]) == {3.0}
    assert len(set(forces)) == 1
    element.restore(saved)
    assert set(element.state.layers["turns"]) == {0.0}
    element.revert_to_start()
    virgin = tb.element("shen-hdr-bridge", 23, model=LOOPS_CLOSED)
    assert element.set_trial(30.0, 0.1).force == virgin.set_trial(30.0, 0.1).force


@pytest.mark.parametrize(("ambient", "published"), [(23.0, 210.0), (-20.0, 438.0)])
def test_a_reversal_of_1_mm_at_100_mm(ambient: float, published: float, measured: Recorder) -> None:
    """Force at 102 mm: published a quarter less than without a reversal, closed the same."""
    paths = {"without": range(2, 103), "with": [*range(2, 101), 99, 100, 101, 102]}
    result = {}
    for law in ("published", "closed"):
        for path, places in paths.items():
            element = tb.element("shen-hdr-bridge", ambient, model=tb.ModelOptions(small_loops=law))
            for x in places:
                force = element.set_trial(float(x), 0.01).force
                element.commit()
            result[law, path] = force
    assert result["published", "with"] == pytest.approx(published, abs=1.0)
    share = result["closed", "with"] / result["closed", "without"]
    measured(
        f"force at 102 mm after a reversal of 1 mm, closed, {ambient:g} degC", share, "1 +- 0.002"
    )
    assert share == pytest.approx(1.0, abs=2e-3)  # a little heat
    assert result["published", "with"] < 0.8 * result["published", "without"]


STEPS = [
    {"step": "cycles", "strain": 1.5, "wave": "sine", "period": 3.0, "count": 1},
    {"step": "ramp", "to_strain": 0.8, "speed": 40.0},
    {"step": "ramp", "to_strain": 0.7, "speed": 40.0},
    {"step": "ramp", "to_strain": 0.75, "speed": 40.0},
]
MORE = [{"step": "rest", "duration": 60.0}, {"step": "ramp", "to_strain": 0.9, "speed": 40.0}]


def made(steps: list[dict[str, Any]]) -> tb.CyclicTest:
    return tb.CyclicTest(dt=0.02, steps=steps)


@pytest.mark.parametrize("name", quick_cases([HDR, LHDR], 0))
def test_the_memory_is_handed_over(name: str, tmp_path: Any) -> None:
    whole = tb.run(name, made(STEPS + MORE), -10.0, model=LOOPS_CLOSED)
    first = tb.run(name, made(STEPS), -10.0, model=LOOPS_CLOSED)
    assert (first["state_layer_turns"].values == 3).all()
    second = tb.run(
        name,
        made(MORE),
        -10.0,
        initial=first.save(tmp_path / "a", figures=False),
        model=LOOPS_CLOSED,
    )
    assert_allclose(second["force"].values[0, -1], whole["force"].values[0, -1], rtol=tol.CUT)
    again = tb.run_case(
        tb.load_case(second.save(tmp_path / "b", figures=False) / "case.resolved.toml")
    )
    assert np.array_equal(again["force"], second["force"])
    forgetful = tb.run(name, made(STEPS), -10.0)
    assert "state_layer_turns" not in forgetful.dataset
    tb.run(
        name, made(MORE), -10.0, initial=forgetful, model=LOOPS_CLOSED
    )  # begins without turning points
    tb.run(name, made(MORE), -10.0, initial=first)  # and these are not read by the published law


def test_a_hybrid_test_hands_its_memory_over() -> None:
    first = tb.hybrid(
        [HDR, LHDR], ambient=-20, duration=3, keep=tb.Keep(every=1), model=LOOPS_CLOSED
    )
    for number, name in enumerate((HDR, LHDR)):
        left = tb.end_state(first, name)
        assert left.layer_turns == first.dataset["state_layer_turns"].values[number].tolist()
        element = tb.element(name, -20, initial=left, model=LOOPS_CLOSED)
        force = element.state.response["force"][0]
        assert element.set_trial(left.at, 1e-3).force == pytest.approx(force, rel=1e-3)


def test_a_rest_leaves_no_turning_points_of_rounding() -> None:
    test = made([*STEPS[:1], {"step": "rest", "duration": 3600.0}])
    result = tb.run(HDR, test, -20.0, model=LOOPS_CLOSED)
    assert result["state_layer_turns"].values.max() <= 4


def test_the_law_of_a_bearing_goes_with_it_and_euler_is_refused(tmp_path: Any) -> None:
    bearing = changed(tb.load_bearing(HDR), hysteresis=CLOSED)
    test = tb.cyclic_test(strain=[1.0, 0.3], cycles=1, rest=None, dt=0.02)
    by_option = tb.run(HDR, test, model=LOOPS_CLOSED)
    by_bearing = tb.run(bearing, test)
    assert np.array_equal(by_option["force"], by_bearing["force"])
    assert not np.array_equal(
        by_option["force"],
        tb.run(bearing, test, model=tb.ModelOptions(small_loops="published"))["force"],
    )
    for device, options in ((HDR, CLOSED), (bearing, {})):
        with pytest.raises(tb.InputError, match="small_loops"):
            tb.run(device, test, model=tb.ModelOptions(integrator="euler", **options))
    compound = extract_compound(bearing)
    assert compound.rubber.small_loops == "closed"


def test_a_fit_with_closed_loops_recovers_them() -> None:
    """The record of a bearing whose small loops close, fitted by the same law and by the other."""
    bearing = changed(tb.load_bearing(HDR), hysteresis=CLOSED)
    steps = made([*STEPS, {"step": "ramp", "to_strain": -1.0, "speed": 40.0}])
    record = tb.synthetic_record(bearing, 23.0, steps)
    free = ["K_r", "d_y", "s"]
    fits = [tb.identify_bearing(record, one, free=free, starts=1) for one in (bearing, HDR)]
    assert fits[0].bearing.hysteresis.small_loops == "closed"
    result = [fit.bearing.hysteresis.shape for fit in fits]
    assert result[0] == pytest.approx(bearing.hysteresis.shape, abs=0.01)
    assert abs(result[1] - bearing.hysteresis.shape) > 0.01
