"""Motion in a horizontal plane: the line as a special case, isotropy, exactness, heat, tests."""

import math
import os
import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.bearing.ambient import Ambient
from thermobearing.core.hysteresis import plane_increment
from thermobearing.core.lead import core_force
from thermobearing.core.plane import march_plane, step_plane
from thermobearing.core.step import step
from thermobearing.core.types import (
    COMPLETED,
    HEAT_FROM_DISSIPATION,
    HEAT_FROM_WORK,
    SOFTENED,
    Constants,
    Floats,
    Path,
    State,
    new_state,
    new_workspace,
)
from thermobearing.core.vector import lowest
from thermobearing.cyclic.history import Segment, room_for, run_segments
from thermobearing.model.earlier import BilinearParameters, bilinear_constants, isothermal
from thermobearing.model.options import ModelOptions, build_model

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
D_Y = 0.8  # [mm]
DT = 0.05  # [s]


@cache
def plane_constants(bearing: str, **options: Any) -> Constants:
    return build_model(tb.load_bearing(bearing), ModelOptions(**options)).constants


def begun(constants: Constants, temperature: float, components: int = 2) -> tuple[State, State]:
    start = np.full(len(constants.cells.capacity), temperature)
    first, second = (new_state(constants, start, components=components) for _ in range(2))
    return first, second


def moved(constants: Constants, x: Floats, temperature: float, dt: float = DT) -> Any:
    """BearingResponse [steps] and the last state of a march in the plane."""
    count = len(x)
    state, spare = begun(constants, temperature)
    path = Path(
        np.ascontiguousarray(x),
        *(np.full(count, one) for one in (dt, temperature)),
        np.ones(count, dtype=bool),
        0.0,
    )
    rows = room_for(constants, count, ("layer_displacement", "hysteretic"), 2)
    done, kept, outcome, *_ = march_plane(
        constants, new_workspace(constants, 2), state, spare, path, rows
    )
    assert (done, kept) == (count, count)
    assert outcome in (COMPLETED, SOFTENED)
    return rows, state


def circle(radius: float, cycles: float, steps: int) -> Floats:
    """A radius out, then round; `steps` a cycle."""
    out = np.linspace(0.0, 1.0, steps // 4 + 1)[1:, None] * [radius, 0.0]
    angle = 2.0 * math.pi * np.arange(1, round(cycles * steps) + 1) / steps
    return np.vstack([out, radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)])


def wandering(size: float, steps: int, seed: int = 3) -> Floats:
    """A random walk within a circle."""
    walk = np.cumsum(np.random.default_rng(seed).normal(0.0, 0.15 * size, (steps, 2)), axis=0)
    return walk * np.minimum(1.0, size / np.linalg.norm(walk, axis=1))[:, None]


def turned(x: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return x @ np.array([[c, s], [-s, c]])


def on_line(constants: Constants, x: Floats, temperature: float) -> list[tuple[float, float, int]]:
    state, spare = begun(constants, temperature, components=1)
    work, result = new_workspace(constants), []
    for at in x.tolist():
        result.append(step(constants, work, state, at, DT, temperature, spare))
        state, spare = spare, state
    return [*result, state]


CASES = {
    "hdr": (HDR, -20.0, 35.0, {}),
    "lead, softened": (LHDR, -35.0, 75.0, {"heat_source": "dissipation"}),
    "lead ends": (LHDR, -20.0, 75.0, {"lead_ends": "finite-plate"}),
}


@pytest.mark.parametrize("angle", [0.0, 0.7, 0.5 * math.pi, 4.0])
@pytest.mark.parametrize("case", CASES)
def test_a_line_in_the_plane_is_the_line(case: str, angle: float, measured: Recorder) -> None:
    bearing, temperature, size, options = CASES[case]
    constants = plane_constants(bearing, **options)
    if case == "hdr":
        virgin = {"virgin": True, "scragging_amplitude": 0.5, "mullins_amplitude": 0.2}
        constants = constants._replace(rubber=constants.rubber._replace(**virgin))
    i = np.arange(1, 61)
    x = size * np.sin(0.2 * i) * (1.0 + 0.2 * np.sin(0.07 * i))
    *line, last = on_line(constants, x, temperature)
    e = np.array([math.cos(angle), math.sin(angle)])
    state, spare = begun(constants, temperature)
    work = new_workspace(constants, 2)
    scale, apart = max(abs(force) for force, *_ in line), 0.0
    for at, (force, tangent, outcome) in zip(x, line, strict=True):
        *result, ended = step_plane(constants, work, state, *(at * e), DT, temperature, spare)
        state, spare = spare, state
        assert ended == outcome
        apart = max(apart, float(np.abs(result[:2] - force * e).max()) / scale)
        along = e @ np.reshape(result[2:], (2, 2)) @ e
        assert_allclose(along, tangent, rtol=0.0, atol=1e2 * tol.PLANE_LINE * scale)
    assert apart < tol.PLANE_LINE
    assert_allclose(state.temperature, last.temperature, rtol=0.0, atol=tol.PLANE_LINE * 100.0)
    for name in ("lead_temperature", "clock", "idle"):
        assert_allclose(state.branches[name], last.branches[name], rtol=tol.PLANE_LINE)
    for name in ("farthest", "virgin", "stored"):
        assert_allclose(state.layers[name], last.layers[name], rtol=tol.PLANE_LINE)
    name = "straight path at any angle in a plane: forces against a line, of the peak"
    measured(name, apart, f"{tol.PLANE_LINE:g}")


@pytest.mark.parametrize("bearing", [HDR, LHDR])
def test_turning_the_motion_turns_the_forces(bearing: str) -> None:
    constants, x = plane_constants(bearing), wandering(60.0, 150)
    plain, state = moved(constants, x, -20.0)
    other, last = moved(constants, turned(x, 1.1), -20.0)
    force = turned(plain.response["force"], 1.1)
    assert_allclose(other.response["force"], force, rtol=0.0, atol=tol.PLANE_TURNED)
    assert_allclose(other.hysteretic, turned(plain.hysteretic, 1.1), atol=tol.PLANE_TURNED)
    assert_allclose(last.temperature, state.temperature, rtol=0.0, atol=tol.PLANE_TURNED)


def curvature(s: float) -> float:
    return (1.0 - s) / ((1.0 + s) * D_Y**2)


def increments(count: int) -> list[tuple[float, Floats, Floats]]:
    """Shape s, Z and dX at random; Z within the circle of d_y, increments of 0.001 to 10 d_y."""
    rng, result = np.random.default_rng(7), []
    for _ in range(count):
        s = float(rng.choice([-0.7, 0.0, 0.4, 1.0, 2.5]))
        angles = rng.uniform(0.0, 2.0 * math.pi, 2)
        sizes = D_Y * np.array([math.sqrt(rng.random()), 10.0 ** rng.uniform(-3.0, 1.0)])
        z, dx = (
            size * np.array([math.cos(a), math.sin(a)])
            for a, size in zip(angles, sizes, strict=True)
        )
        result.append((s, z, dx))
    return result


def exact(z: Floats, dx: Floats, s: float) -> tuple[Floats, Floats]:
    after, slope = plane_increment((z[0], z[1]), (dx[0], dx[1]), D_Y, curvature(s))
    return np.array(after), np.array(slope)


def test_hysteresis_in_closed_form_solves_its_equation(measured: Recorder) -> None:
    beta_and_gamma, apart = 1.0 / D_Y**2, 0.0
    for s, z, dx in increments(300):
        beta = beta_and_gamma / (1.0 + s)

        def rate(
            _: float, now: Floats, dx: Floats = dx, beta: float = beta, s: float = s
        ) -> Floats:
            power = dx @ now
            return np.asarray(dx - now * (s * beta * power + beta * abs(power)))

        result, _ = exact(z, dx, s)
        # Split where the direction of loading changes, for the equation has a kink there.
        solved = solve_ivp(
            rate, (0.0, 1.0), z, method="DOP853", rtol=1e-12, atol=1e-13, max_step=0.1
        )
        apart = max(apart, float(np.abs(result - solved.y[:, -1]).max()) / D_Y)
        assert np.linalg.norm(result) <= D_Y * (1.0 + tol.SPLIT_INCREMENT)
    assert apart < tol.PLANE_HYSTERESIS
    name = "hysteresis in a plane against scipy solve_ivp, 300 increments, of d_y"
    measured(name, apart, f"{tol.PLANE_HYSTERESIS:g}")


def test_tangent_of_the_hysteresis() -> None:
    h = tol.TANGENT_STEP * D_Y
    for s, z, dx in increments(100):
        _, slope = exact(z, dx, s)
        for k, by in enumerate(h * np.eye(2)):
            ahead, behind = exact(z, dx + by, s)[0], exact(z, dx - by, s)[0]
            assert_allclose(slope[:, k], (ahead - behind) / (2.0 * h), atol=tol.PLANE_TANGENT)


@pytest.mark.parametrize("s", [-0.7, 0.4, 2.5])
@pytest.mark.parametrize("z", [(0.3, -0.5), (-0.2, 0.1), (D_Y, 0.0)])
def test_short_increments_have_the_tangent_of_the_equation(
    s: float, z: tuple[float, float]
) -> None:
    """dZ = dX - Z (gamma dX . Z + beta |dX . Z|), on both sides of SHORT."""
    beta = 1.0 / ((1.0 + s) * D_Y**2)
    at = np.array(z)
    for angle in (0.3, 2.0, 4.0):
        e = np.array([math.cos(angle), math.sin(angle)])
        limit = np.eye(2) - (s * beta + beta * math.copysign(1.0, e @ at)) * np.outer(at, at)
        for size in (1e-9, 1e-6):
            _, slope = exact(at, size * D_Y * e, s)
            assert_allclose(slope, limit, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("source", [HEAT_FROM_WORK, HEAT_FROM_DISSIPATION])
@pytest.mark.parametrize("softening", [0.0, 0.0069])
def test_lead_returns_to_its_circle(source: int, softening: float) -> None:
    lead = plane_constants(LHDR).lead._replace(softening=softening)
    before, dx, h = (6.0, -4.0), np.array([0.6, 0.9]), 1e-5

    def force(dx: Floats) -> Floats:
        return np.array(core_force(lead, source, -20.0, before, (dx[0], dx[1]))[0])  # type: ignore[arg-type]

    after, slope = core_force(lead, source, -20.0, before, (dx[0], dx[1]))  # type: ignore[arg-type]
    for k, by in enumerate(h * np.eye(2)):
        expected = (force(dx + by) - force(dx - by)) / (2.0 * h)
        assert_allclose(np.array(slope)[:, k], expected, atol=tol.PLANE_TANGENT * lead.stiffness)
    trial = before + lead.stiffness * dx
    assert_allclose(np.cross(np.append(trial, 0.0), np.append(after, 0.0)), 0.0, atol=1e-10)
    heat = 0.5 * (np.array(before) + after) @ dx
    if source == HEAT_FROM_DISSIPATION:
        heat -= 0.5 * (np.dot(after, after) - np.dot(before, before)) / lead.stiffness
    warm = -20.0 + heat / lead.capacity - lead.reference_temperature
    assert_allclose(np.linalg.norm(after), lead.strength * math.exp(-softening * warm), rtol=1e-12)


@pytest.mark.parametrize(
    ("bearing", "temperature", "heat"),
    [(HDR, -40.0, "work"), (LHDR, -20.0, "work"), (LHDR, -35.0, "dissipation")],
)
def test_tangent_and_energy_of_a_step(
    bearing: str, temperature: float, heat: str, measured: Recorder
) -> None:
    """Central differences on an eight that softens layers; the balances of a random walk."""
    constants, h = plane_constants(bearing, heat_source=heat), 1e-5
    angle = 2.0 * math.pi * np.arange(1, 61) / 40
    eight = 75.0 * np.stack([np.sin(angle), np.sin(2.0 * angle)], axis=1)
    state, spare = begun(constants, temperature)
    work, softened = new_workspace(constants, 2), 0

    def take(x: Floats) -> tuple[Floats, int]:
        *result, outcome = step_plane(constants, work, state, *x.tolist(), DT, temperature, spare)
        return np.array(result), outcome

    for number, x in enumerate(eight):
        result, outcome = take(x)
        softened += outcome == SOFTENED
        if number % 4 == 3 or outcome == SOFTENED:
            for k, by in enumerate(h * np.eye(2)):
                expected = (take(x + by)[0][:2] - take(x - by)[0][:2]) / (2.0 * h)
                slope = result[2:].reshape(2, 2)[:, k]
                assert_allclose(slope, expected, atol=tol.PLANE_TANGENT * np.abs(expected).max())
            take(x)
        state, spare = spare, state
    assert softened > 0
    rows, state = moved(constants, wandering(70.0, 300), temperature)
    for response in (state.response[0], rows.response[100]):
        lost = response.heat_lost_ends + response.heat_lost_sides
        residual = max(
            abs(response.work_in - response.heat_released - response.recoverable),
            abs(response.heat_released - response.heat_stored - lost),
        )
        assert residual <= tol.ENERGY_BALANCE * response.work_in
        name = "energy balance of random walks in a plane, of the work"
        measured(name, residual / response.work_in, f"{tol.ENERGY_BALANCE:g}")
    assert_allclose(
        rows.layer_displacement[-1].T @ constants.multiplicity, rows.response["displacement"][-1]
    )


def test_layers_soften_by_the_smallest_eigenvalue() -> None:
    """Equal layers move alike, so that the weight follows from d and Z after each step."""
    constants = isothermal(plane_constants(HDR))
    rubber = constants.rubber
    rows, _ = moved(constants, wandering(75.0, 400), -40.0)
    cold = -40.0 - rubber.reference_temperature
    ke = rubber.elastic_stiffness * math.exp(rubber.elastic_exponent * cold)
    kh = rubber.hysteretic_stiffness * math.exp(rubber.hysteretic_exponent * cold)
    expected = []
    for d, z in zip(rows.layer_displacement[:, 0], rows.hysteretic[:, 0], strict=True):
        loading = np.eye(2) - np.outer(z, z) / rubber.yield_displacement**2
        hardening = 1.0 + rubber.hardening * d @ d
        tangent = hardening * loading + 2.0 * rubber.hardening * np.outer(z, d)
        least = np.linalg.eigvalsh(np.eye(2) + kh / ke * 0.5 * (tangent + tangent.T))[0]
        t = (rubber.sharing_start - least) / (rubber.sharing_start - rubber.sharing_full)
        t = min(max(t, 0.0), 1.0)
        expected.append(t * t * (3.0 - 2.0 * t))
    assert 0.0 < np.mean(np.array(expected) > 0.0) < 0.5
    assert_allclose(rows.response["sharing_weight"], expected, rtol=0.0, atol=1e-9)


def test_smallest_eigenvalue_of_the_symmetric_part() -> None:
    for matrix in np.random.default_rng(2).normal(size=(20, 2, 2)):
        result = lowest((tuple(matrix[0]), tuple(matrix[1])))  # type: ignore[arg-type]
        assert_allclose(result, np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[0], atol=1e-14)


def test_a_circle_has_a_force_of_constant_size(measured: Recorder) -> None:
    """Of constant p and q: p' = 1 - p^2/d_y^2 + q/r = 0 and q' = -p q/d_y^2 - p/r = 0.

    So |Z| = d_y, and Z is behind the direction of motion by the angle whose sine is d_y/r.
    """
    constants = isothermal(plane_constants(HDR))
    rubber, radius, steps = constants.rubber, 40.0, 2000
    rows, _ = moved(constants, circle(radius, 3, steps), rubber.reference_temperature)
    r, d_y = radius / rubber.layer_count, rubber.yield_displacement
    behind = math.asin(d_y / r)
    phi = np.array([math.sin(behind), math.cos(behind)])  # of Z, outward and in the motion
    h = 1.0 + rubber.hardening * r * r
    expected = rubber.hysteretic_stiffness * h * d_y * phi + [rubber.elastic_stiffness * r, 0.0]
    x, force = rows.response["displacement"][-steps:], rows.response["force"][-steps:]
    outward = x / radius
    onward = np.stack([-outward[:, 1], outward[:, 0]], axis=1)
    result = np.stack([(force * outward).sum(axis=1), (force * onward).sum(axis=1)], axis=1)
    assert_allclose(result, np.broadcast_to(expected, result.shape), rtol=tol.PLANE_CIRCLE)
    assert_allclose(np.linalg.norm(force, axis=1).std(), 0.0, atol=1e-9)
    lag = np.arctan2(*result.T[::-1])
    wanted = math.atan2(expected[1], expected[0])
    apart = float(np.abs(lag - wanted).max())
    assert apart < tol.PLANE_CIRCLE
    name = "isothermal circle: force behind the displacement, from p and q; largest difference"
    measured(name, f"{math.degrees(wanted):.3f} deg; {apart:.1e} rad", f"{tol.PLANE_CIRCLE:g} rad")


def test_a_rigid_plastic_core_works_pi_half_times_as_much_on_a_circle(measured: Recorder) -> None:
    constants = bilinear_constants(BilinearParameters(5.0, 1e-3, 1e7))
    radius, steps = 40.0, 2000
    rows, _ = moved(constants, circle(radius, 3, steps), 20.0)
    work = rows.response["work_in"]
    line = 4.0 * 5.0 * radius
    ratio = float(work[-1] - work[-1 - steps]) / line
    assert_allclose(ratio, 0.5 * math.pi, rtol=tol.PLANE_CIRCLE)
    name = "rigid-plastic core on a circle: work per turn over that of a line (pi/2)"
    measured(name, f"{ratio:.5f}", f"{tol.PLANE_CIRCLE:g}")


AXES = np.array([[1.0, 0.0], [1.0, 1.0]])  # what makes a line and a circle of a circle


@pytest.mark.parametrize("bearing", [HDR, LHDR])
def test_the_order_of_the_temperatures_is_that_of_a_line(bearing: str, measured: Recorder) -> None:
    """Temperatures of all cells after two cycles, from steps of T/1600, T/3200 and T/6400."""
    constants = plane_constants(bearing)

    def order(shape: Any) -> float:
        result = [
            moved(constants, shape(steps), -20.0, 4.0 / steps)[1].temperature
            for steps in (1600, 3200, 6400)
        ]
        first, second = np.abs(np.diff(result, axis=0)).max(axis=1)
        return math.log2(first / second)

    orders = [order(lambda steps, axes=axes: circle(50.0, 2, steps) * axes) for axes in AXES]
    assert_allclose(orders, 1.0, atol=tol.ORDER)
    name = f"observed order in time of temperatures, {bearing}: line, circle"
    measured(name, ", ".join(f"{one:.2f}" for one in orders), f"1 within {tol.ORDER:g}")


def rubber_forces(x: Floats) -> tuple[Floats, Floats]:
    """Displacements and forces of the last 400 steps, of the HDR specimen at 23 degC."""
    rows, _ = moved(isothermal(plane_constants(HDR)), x, 23.0)
    last = rows.response[-400:]
    return last["displacement"], last["force"]


def test_displacement_across_raises_the_force_in_the_main_direction(measured: Recorder) -> None:
    """As in full-scale tests of high-damping rubber (Yamamoto et al. 2012)."""
    angle = 2.0 * math.pi * np.arange(1, 1201) / 400
    main, peaks = 60.0 * np.sin(angle), []
    for across in (0.0, 30.0, 60.0):
        out = np.linspace(0.0, across, 101)[1:, None] * [0.0, 1.0]
        path = np.vstack([out, np.stack([main, np.full(len(main), across)], axis=1)])
        peaks.append(float(rubber_forces(path)[1][:, 0].max()))
    rises = np.array(peaks[1:]) / peaks[0] - 1.0
    assert 0.02 < rises[0] < rises[1] - 0.02
    measured(
        "force in the main direction at 200 %, with 100 % and 200 % across, over none across",
        ", ".join(f"{100.0 * one:+.1f}%" for one in rises),
        "rises, as in full-scale tests",
    )


def test_the_largest_force_across_is_near_zero_displacement_across(measured: Recorder) -> None:
    """On an ellipse, where hardening by the main displacement is largest (Yamamoto et al. 2012)."""
    x, force = rubber_forces(circle(75.0, 3, 400) * [1.0, 0.1])
    most = np.abs(force[:, 1]).argmax()
    share = float(abs(x[most, 1])) / 7.5
    assert share < 0.25
    assert abs(x[most, 0]) > 0.95 * 75.0
    measured(
        "ellipse of 250 % by 25 %: displacement across at the largest force across, of its peak",
        f"{share:.2f}",
        "0.25; near zero in full-scale tests",
    )


def test_a_circle_of_350_percent_has_less_force_than_a_line_of_400() -> None:
    """As in the law of Yamamoto et al. (2012), see tests/cross_code/test_opensees_plane.py."""
    circular, straight = (
        float(np.linalg.norm(rubber_forces(circle(strain * 30.0, 3, 400) * axes)[1], axis=1).max())
        for strain, axes in ((3.5, [1.0, 1.0]), (4.0, [1.0, 0.0]))
    )
    assert 0.5 < circular / straight < 0.7


def test_a_test_along_a_line_in_the_plane() -> None:
    """With a rest that is cut into short steps for the heat flow out of lead."""
    constants = plane_constants("lrb-example", lead_ends="finite-plate")
    x = np.append(60.0 * np.sin(0.1 * np.arange(1, 101)), np.full(3, 60.0 * math.sin(10.0)))
    dt = np.append(np.full(100, DT), [10.0, 500.0, 500.0])
    e = np.array([0.6, -0.8])
    runs = [
        run_segments(
            constants,
            [Segment("recorded", "", path, dt, np.zeros(103, np.int32), np.arange(103) % 9 == 0)],
            Ambient.constant(-20.0),
            np.full(len(constants.cells.capacity), -20.0),
            keep_every=5,
            groups=("rubber", "cells", "layer_displacement"),
        )
        for path in (x, np.outer(x, e))
    ]
    line, plane = runs
    assert (line.outcome, line.kept, line.steps) == (plane.outcome, plane.kept, plane.steps)
    assert line.steps > len(x)
    scale = np.abs(line.rows.response["force"]).max() * tol.PLANE_LINE
    force = np.outer(line.rows.response["force"], e)
    assert_allclose(plane.rows.response["force"], force, rtol=0.0, atol=scale)
    d = line.rows.layer_displacement[..., np.newaxis] * e
    assert_allclose(plane.rows.layer_displacement, d, rtol=0.0, atol=100.0 * tol.PLANE_LINE)
    for name in ("rubber", "cells"):
        assert_allclose(getattr(plane.rows, name), getattr(line.rows, name), rtol=1e-6)


def test_an_element_moves_in_the_plane() -> None:
    element = tb.element(HDR, ambient=-20.0, components=2)
    trial = element.set_trial([3.0, 4.0], dt=0.1)
    along = tb.element(HDR, ambient=-20.0).set_trial(5.0, dt=0.1)
    assert trial.outcome == "completed"
    assert_allclose(trial.force, along.force * np.array([0.6, 0.8]), rtol=tol.PLANE_LINE)
    e = np.array([0.6, 0.8])
    assert_allclose(e @ trial.tangent @ e, along.tangent, rtol=1e2 * tol.PLANE_LINE)
    element.commit()
    saved = element.save()
    other = element.set_trial(np.array([-3.0, 9.0]), dt=0.1)
    element.commit()
    element.restore(saved)
    assert_allclose(element.state.response["displacement"], [[3.0, 4.0]])
    again = element.set_trial((-3.0, 9.0), dt=0.1)
    assert again.force.tolist() == other.force.tolist()
    element.revert_to_start()
    assert element.set_trial((3.0, 4.0), dt=0.1).force.tolist() == trial.force.tolist()


@pytest.mark.parametrize("wrong", [3.0, (1.0, 2.0, 3.0), (1.0, math.nan), "3", None])
def test_a_pair_is_wanted_in_the_plane(wrong: Any) -> None:
    with pytest.raises(tb.InputError, match=r"set_trial\(\): x"):
        tb.element(HDR, components=2).set_trial(wrong, dt=0.1)


@pytest.mark.parametrize(
    "options", [{"integrator": "euler"}, {"small_loops": "closed"}, {"hardening": "monotone"}]
)
def test_what_is_for_a_line_only_is_refused(options: dict[str, Any]) -> None:
    with pytest.raises(tb.InputError) as refused:
        tb.element(HDR, components=2, model=ModelOptions(**options))
    assert " = ".join(*options.items()) in str(refused.value)


def test_states_of_a_line_are_refused() -> None:
    line, plane = tb.element(HDR), tb.element(HDR, components=2)
    with pytest.raises(tb.InputError, match="restore"):
        plane.restore(line.save())
    with pytest.raises(tb.InputError, match="components"):
        tb.element(HDR, components=3)


def test_plain_python_gives_the_same_numbers() -> None:
    code = """
import thermobearing as tb
element = tb.element("shen-lhdr-specimen", ambient=-20.0, components=2)
for x in ((9.0, 4.0), (5.0, 30.0), (-20.0, 10.0)):
    trial = element.set_trial(x, dt=0.1)
    element.commit()
print(*trial.force, *trial.tangent.ravel(), *element.state.temperature)
"""
    numbers = [
        np.array(
            subprocess.run(
                [sys.executable, "-c", code],
                env={**os.environ, "NUMBA_DISABLE_JIT": plain},
                capture_output=True,
                text=True,
                check=True,
            ).stdout.split(),
            dtype=float,
        )
        for plain in ("1", "0")
    ]
    assert_allclose(*numbers, rtol=tol.PLANE_LINE)
