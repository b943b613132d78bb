"""Motions and histories as arrays, names that tell motions apart, and single numbers."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import thermobearing as tb
from tests.unit import motion_files as files
from thermobearing.design.case import make_design_case
from thermobearing.design.run import _one_turn
from thermobearing.design.sizing import design_values, load_curves, load_rubber
from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case
from thermobearing.motions.record import GroundMotion, motion_from_arrays

SHORT = files.shaking(3000.0)
QUICK: dict[str, Any] = {"bearing": "shen-bilinear-bridge", "ambient": 23, "duration": 1.0}


def kiknet(folder: Path) -> list[str]:
    """Two horizontal components of one station, distinguished by the ending of the file only."""
    result = []
    for end, direction in (("EW2", "5"), ("NS2", "4")):
        path = folder / f"ABCH011103111446.{end}"
        path.write_text(files.knet_text(direction=direction))
        result.append(str(path))
    return result


def test_components_of_a_station_have_names_of_their_own(tmp_path: Path) -> None:
    result = tb.bridge(motion=kiknet(tmp_path), **QUICK)
    names = ["ABCH011103111446-EW", "ABCH011103111446-NS"]
    assert list(result.table["motion"]) == names
    result.save(tmp_path / "out")  # the figures too
    again = load_earthquake_case(tmp_path / "out" / "case.resolved.toml")
    assert [motion.label for motion in again.motions] == names


def test_one_record_at_two_sizes(tmp_path: Path) -> None:
    path = kiknet(tmp_path)[0]
    twice = [{"name": path, "factor": factor} for factor in (1.0, 1.5)]
    small, large = tb.bridge(motion=twice, **QUICK).table["motion"]
    assert (small, large) == ("ABCH011103111446-x1", "ABCH011103111446-x1.5")


def test_the_same_motion_twice_is_a_fault() -> None:
    with pytest.raises(tb.InputError, match='"jra-ii-i-1" is given more than once'):
        make_earthquake_case({}, "test", motions=["jra-ii-i-1", "jra-ii-i-1"])
    two = [{"name": name, "label": "x"} for name in ("jra-ii-i-1", "jra-ii-i-2")]
    with pytest.raises(tb.InputError, match='"x" is given more than once'):
        make_earthquake_case({}, "test", motions=two)


def test_a_ground_motion_is_run_as_its_file_is(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text(files.csv_text())
    read = tb.load_motion(file)
    from_file = tb.bridge(motion=file, **QUICK)
    from_array = tb.bridge(motion=read, **QUICK)
    assert_array_equal(from_array["bearing_force"], from_file["bearing_force"])
    from_array.save(tmp_path / "out", figures=False)
    again = load_earthquake_case(tmp_path / "out" / "case.resolved.toml")
    assert_array_equal(again.motions[0].load().acceleration, read.acceleration)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"acceleration": np.ones((3, 2))}, "list of numbers"),
        ({"acceleration": [0.0, np.nan]}, "not finite"),
        ({"dt": 0.0}, "dt = 0.0"),
        ({"dt": "0.01 s"}, "dt = '0.01 s'"),
    ],
)
def test_ground_motions_that_are_none(change: dict[str, Any], message: str) -> None:
    with pytest.raises(tb.InputError, match=message):
        GroundMotion(**({"name": "mine", "dt": 0.01, "acceleration": SHORT} | change))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time": [0.0, 0.01]}, "2 times and 400 accelerations"),
        ({"time": -0.01 * np.arange(400)}, "sample 2: time does not increase"),
        ({"dt": 10.0}, "is it in seconds"),
        ({"dt": None}, "give dt"),
        ({"unit": "g"}, "is the unit wrong"),
        ({"unit": "furlong"}, "unknown unit"),
        ({"unit": None}, "unit = None: must be text"),
        ({"dt": "0.01"}, "must be a number of seconds"),
        ({"acceleration": [[1.0]]}, "list of numbers"),
    ],
)
def test_arrays_that_are_no_motion(change: dict[str, Any], message: str) -> None:
    given = {"acceleration": SHORT, "unit": "mm/s2", "dt": 0.01} | change
    given |= {"dt": None} if "time" in change else {}
    with pytest.raises(tb.InputError, match=message):
        motion_from_arrays(**given)


def test_two_samples_have_a_step() -> None:
    assert motion_from_arrays([0.0, 300.0], unit="gal", time=[0.0, 0.02]).dt == pytest.approx(0.02)


def test_a_motion_in_another_unit_is_refused() -> None:
    """In m/s2 instead of mm/s2: 3 mm/s2 are no earthquake."""
    with pytest.raises(tb.InputError, match="its acceleration must be in mm/s2") as caught:
        tb.bridge(motion=GroundMotion("mine", 0.01, 1e-3 * SHORT), **QUICK)
    assert "trust_unit" not in str(caught.value)  # an option of files, which a case does not have


def test_a_history_is_run_as_its_file_is(tmp_path: Path) -> None:
    time = 0.02 * np.arange(101)
    x = 30.0 * np.sin(2.0 * np.pi * time)
    file = tmp_path / "x.csv"
    rows = "".join(f"{t!r},{u!r}\n" for t, u in zip(time.tolist(), x.tolist(), strict=True))
    file.write_text("time_s,displacement_mm\n" + rows)
    steps = [{"step": "recorded", "file": str(file)}]
    expected = tb.run("shen-hdr-specimen", tb.CyclicTest(steps=steps), ambient=-20)
    result = tb.run("shen-hdr-specimen", test=(time, x), ambient=-20)
    assert_array_equal(result["force"], expected["force"])
    result.save(tmp_path / "out", figures=False)
    again = tb.load_case(tmp_path / "out" / "case.resolved.toml")
    assert again.test == tb.load_case(tmp_path / "out" / "case.resolved.toml").test
    assert again.test.steps[0].points(0.0)[1].tolist() == x.tolist()  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("history", "message"),
    [
        ((1.0,), "two arrays"),
        (([0.0, 1.0], [0.0]), "2 times and 1 displacements"),
        (([0.0, 1.0, 1.0], [0.0, 1.0, 2.0]), "time does not increase from 1 to 1 s"),
        (([0.0, 1.0], [0.0, np.inf]), "not finite"),
        (([0.0, 1.0], [[0.0], [1.0]]), "list of numbers"),
        (([0.0, 1.0], [5.0, 6.0]), "starts at 5 mm but the bearing is at 0 mm"),
        (([0.0, 1.0], [0.0, 1e4]), "is the unit right"),
    ],
)
def test_histories_that_are_none(history: Any, message: str) -> None:
    with pytest.raises(tb.InputError, match=message):
        tb.run("shen-hdr-specimen", test=history)


@pytest.mark.parametrize(("layer_increment", "warned"), [(0.95, False), (1.05, True)])
def test_coarse_steps_are_reported_from_one_yield_displacement_on(
    layer_increment: float, warned: bool
) -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    step = layer_increment * bearing.hysteresis.yield_displacement * bearing.geometry.rubber_layers
    ramp = {"step": "ramp", "to": 4.0 * step, "duration": 4.0}
    slow = {"step": "ramp", "to": 0.0, "duration": 40.0}  # the largest counts, not the mean
    result = tb.run(bearing, tb.CyclicTest(dt=1.0, steps=[ramp, slow]))
    assert any("inaccurate" in warning for warning in result.warnings) is warned


def test_a_first_guess_outside_the_curves_takes_their_nearest_strain() -> None:
    case = make_design_case({}, "test", motions=["jra-ii-i-1"], dt=0.01)
    # 1 mm over 14 mm of rubber; the curves begin at 20 %
    (turn,) = _one_turn(case, 1, [1.0]).rounds
    nearest = load_curves().smallest_strain * turn.size.total_rubber_thickness
    expected = design_values(load_rubber("G8", "HDR"), turn.size, nearest)
    assert (turn.stiffness, turn.damping) == expected
