"""How fast bearings follow the air, against axisymmetric finite elements; rests of lead."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from thermobearing.bearing.ambient import Ambient
from thermobearing.core.lead_ends import longest_rest_step
from thermobearing.cyclic.history import build_segments, cut_rests, run_segments
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.earthquake.case import make_earthquake_case, settle_surroundings
from thermobearing.earthquake.run import Device, _soaked, build_device
from thermobearing.model.options import ModelOptions, build_model

pytest.importorskip("skfem", reason="scikit-fem is not installed")

HOUR = 3600.0
FILM, COVER = 12.0, 10.0  # as data/surroundings/outdoors.toml
BEHIND = "1000 kJ/(m^2 K)"  # some half a metre of concrete


def select_bearing(name: str) -> tb.Bearing:
    """One of the library, or a round one of 900 mm without lead, 20 layers of 10 mm."""
    if name != "round 900 mm":
        return tb.load_bearing(name)
    lrb = tb.load_bearing("lrb-example")
    plan = lrb.geometry.plan.model_copy(update={"diameter": 900.0})
    sizes = {"plan": plan, "rubber_thickness": 10.0, "shim_thickness": 4.0}
    geometry = lrb.geometry.model_copy(update=sizes)
    return lrb.model_copy(update={"geometry": geometry, "lead": None, "kind": "HDR"})


def in_the_weather(bearing: tb.Bearing, **analysis: Any) -> Device:
    table: dict[str, Any] = {"command": "bridge", "bearings": [bearing], "analysis": analysis}
    settle_surroundings(table)
    case = make_earthquake_case(table, "test")
    return build_device(case, case.bearings[0])


def time_at_level(hours: Any, mean: Any, level: float) -> float:
    """When a falling temperature is at a level, between samples as an exponential [h]."""
    return float(np.interp(-np.log(level), -np.log(mean), hours))


def cooling(device: Device, hours: Any) -> Any:
    """Mean of the rubber some hours after the air fell from 1 to 0 degC."""
    stack = device.stack
    assert stack is not None
    rubber = stack.thickness * np.array([part == "rubber" for part in stack.part])
    fall = [Ambient.series([0.0, 1e-3, HOUR * h], [1.0, 0.0, 0.0]) for h in hours]
    return np.array([_soaked(device, air)[0] @ rubber for air in fall]) / rubber.sum()


@pytest.mark.parametrize(
    "name",
    quick_cases(["shen-hdr-bridge", "shen-lhdr-bridge", "round 900 mm", "lrb-example"], 0, 1),
)
@pytest.mark.parametrize("behind", [0.0, 1000.0])
def test_bearing_follows_the_air_as_finite_elements_do(
    name: str, behind: float, measured: Recorder
) -> None:
    from thermobearing.verify.finite_elements import FiniteElements, mean_rubber, weather_problem

    bearing = select_bearing(name)
    problem = weather_problem(bearing, FILM, COVER, behind)
    elements = FiniteElements(problem)
    history = elements.march([(900.0, 4 * 30)], start=np.ones(elements.basis.N))
    level = np.exp(-1.0)
    fine = time_at_level(history.time[1:] / HOUR, mean_rubber(problem, history)[1:], level)
    face = {"film": f"{FILM} W/(m^2 K)", "heat_capacity": BEHIND}
    changed = {"upper_face": face, "lower_face": face} if behind else {}
    hours = fine * np.array([0.8, 0.9, 1.0, 1.1, 1.2])
    ours = time_at_level(hours, cooling(in_the_weather(bearing, **changed), hours), level)
    label = f"{name}{', girder and pier top behind the faces' if behind else ''}"
    measured(
        f"Weather, {label}: rubber to 1/e, against finite elements",
        f"{ours:.2f} of {fine:.2f} h",
        f"{tol.SOAKING:.0%}",
    )
    assert abs(ours / fine - 1.0) < tol.SOAKING


def test_faces_held_at_the_air_are_three_times_too_fast(measured: Recorder) -> None:
    """The exchange of laboratory tests (eta_B = 2, no cover), once the default of weather too."""
    for name, least in (("shen-hdr-bridge", 2.8), ("shen-lhdr-bridge", 2.2)):
        bearing = select_bearing(name)
        hours = np.arange(0.5, 9.0, 0.5)
        held = make_earthquake_case({"command": "bridge", "bearings": [bearing]}, "test")
        result = [
            time_at_level(hours, cooling(device, hours), np.exp(-1.0))
            for device in (build_device(held, bearing), in_the_weather(bearing))
        ]
        assert result[1] / result[0] > least
        text = f"{result[0]:.1f} h, {result[1]:.1f} h"
        measured(
            f"Weather, {name}: rubber to 1/e, faces held at the air and films", text, "reported"
        )


def rest(constants: Any, hours: float, pieces: int = 1) -> Any:
    """A bearing at 1 degC after a rest in air of 0 degC."""
    one: Any = {"step": "rest", "duration": HOUR * hours / pieces}
    segments = build_segments(CyclicTest(dt=10.0, steps=[one] * pieces), 1.0)
    uniform = np.ones(len(constants.cells.capacity))
    return run_segments(constants, segments, Ambient.constant(0.0), uniform, groups=())


def test_rest_of_lead_in_touch_is_one_whatever_its_pieces(measured: Recorder) -> None:
    from thermobearing.verify.finite_elements import (
        FiniteElements,
        bearing_problem,
        mean_rubber,
        weather_problem,
    )

    bearing = tb.load_bearing("lrb-example")
    model = build_model(bearing, ModelOptions())
    rubber = model.stack.thickness * np.array([part == "rubber" for part in model.stack.part])
    ends = [rest(model.constants, 6.0, pieces).state for pieces in (1, 360)]
    result = [float(end.temperature @ rubber / rubber.sum()) for end in ends]
    lead = [float(end.branches["lead_temperature"][0]) for end in ends]
    assert abs(result[0] - result[1]) < tol.REST_OF_LEAD
    assert abs(lead[0] - lead[1]) < tol.REST_OF_LEAD
    problem = weather_problem(bearing, bearing.materials.side_film, 0.0)
    problem = replace(problem, face_film=bearing_problem(bearing).face_film)
    elements = FiniteElements(problem)
    history = elements.march([(300.0, 72)], start=np.ones(elements.basis.N))
    fine = float(mean_rubber(problem, history)[-1])
    assert abs(result[0] - fine) < tol.REST_OF_LEAD_ELEMENTS
    measured(
        "lrb-example, rest of 6 h: share of the difference left, one rest, 360, finite elements",
        f"{result[0]:.3f}, {result[1]:.3f}, {fine:.3f}",
        f"{tol.REST_OF_LEAD:g}, {tol.REST_OF_LEAD_ELEMENTS:g}",
    )


def test_other_rests_keep_their_steps() -> None:
    """Confined lead, and bearings without, have no longest step; pieces fill what they cut."""
    segment = build_segments(CyclicTest(steps=[{"step": "rest", "duration": 9e4}]), 1.0)[0]
    keep = np.zeros(len(segment.x), dtype=bool)
    keep[::7] = True
    for name in ("shen-hdr-bridge", "shen-lhdr-bridge"):
        constants = build_model(tb.load_bearing(name)).constants
        assert longest_rest_step(constants) == np.inf
        assert cut_rests(constants, segment, keep, 0.0)[0] is segment
    constants = build_model(tb.load_bearing("lrb-example")).constants
    cut, kept, ends = cut_rests(constants, segment, keep, 0.0)
    assert cut.dt.max() <= longest_rest_step(constants)
    assert_array_equal(kept[ends], keep)
    assert kept.sum() == keep.sum()
    np.testing.assert_allclose(np.cumsum(cut.dt)[ends], np.cumsum(segment.dt), rtol=1e-12)
    moving = cut_rests(constants, segment, keep, 1.0)  # its first step comes from elsewhere
    assert moving[0].dt[0] == segment.dt[0]
    reported: list[int] = []
    uniform = np.ones(len(constants.cells.capacity))
    run_segments(constants, [segment], Ambient.constant(0.0), uniform, progress=reported.append)
    assert sum(reported) == len(segment.x)
