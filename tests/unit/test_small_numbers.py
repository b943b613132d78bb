"""Single numbers that no whole run shows, or that it would show as well if they were wrong."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.unit import motion_files as files
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.design.case import make_design_case
from thermobearing.design.factors import scaled_bearing
from thermobearing.design.run import _one_turn
from thermobearing.design.sizing import design_values, load_curves, load_rubber
from thermobearing.motions.measures import significant_interval
from thermobearing.motions.readers import read_motion
from thermobearing.motions.record import GroundMotion


@pytest.mark.parametrize(("layer_increment", "warned"), [(0.95, False), (1.05, True)])
def test_coarse_steps_are_told_from_one_yield_displacement_on(
    layer_increment: float, warned: bool
) -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    step = layer_increment * bearing.hysteresis.yield_displacement * bearing.geometry.rubber_layers
    ramp = {"step": "ramp", "to": 4.0 * step, "duration": 4.0}
    slow = {"step": "ramp", "to": 0.0, "duration": 40.0}  # the largest counts, not the mean
    result = tb.run(bearing, tb.CyclicTest(dt=1.0, steps=[ramp, slow]))
    assert any("coarse" in warning for warning in result.warnings) is warned


@pytest.mark.parametrize("name", ["shen-hdr-specimen", "shen-lhdr-bridge"])
@pytest.mark.parametrize("factor", [1.0 / 6.0, 3.0])
def test_scaled_bearing_has_the_same_stress_at_the_same_strain(name: str, factor: float) -> None:
    """In the same time and without heating: stiffness of rubber, lead and rate, and d_y."""
    bearing = tb.load_bearing(name)
    scaled = scaled_bearing(bearing, factor)
    one, other = isothermal_cycle(bearing, 1.0, 60.0), isothermal_cycle(scaled, 1.0, 60.0 * factor)
    assert_allclose(other.G_eq_MPa, one.G_eq_MPa, rtol=tol.SIMILAR)
    assert_allclose(other.h_eq, one.h_eq, rtol=tol.SIMILAR)
    assert_allclose(
        other.post_yield_stiffness_kN_mm, factor * one.post_yield_stiffness_kN_mm, rtol=tol.SIMILAR
    )


def test_significant_interval_of_an_even_motion() -> None:
    even = GroundMotion("even", 0.01, np.ones(1001))
    assert_allclose(significant_interval(even), (0.5, 9.5), rtol=tol.MEAN)


@pytest.mark.parametrize(("told", "refused"), [(301.0, False), (310.0, True), (290.0, True)])
def test_knet_maximum_that_is_off_by_a_few_per_cent(
    told: float, refused: bool, tmp_path: Path
) -> None:
    values = files.shaking(300.0)
    largest = float(np.abs(values - values.mean()).max())
    path = files.write(tmp_path / "a.NS", files.knet_text(largest=told / 300.0 * largest))
    if not refused:
        read_motion(path)
        return
    with pytest.raises(tb.InputError, match=r"Max\. Acc\."):
        read_motion(path)


def test_a_first_guess_outside_the_curves_takes_their_nearest_strain() -> None:
    case = make_design_case({}, "test", motions=["jra-ii-i-1"], dt=0.01)
    (turn,) = _one_turn(
        case, 1, [1.0]
    ).rounds  # 1 mm over 14 mm of rubber; the curves begin at 20 %
    nearest = load_curves().smallest_strain * turn.size.total_rubber_thickness
    expected = design_values(load_rubber("G8", "HDR"), turn.size, nearest)
    assert (turn.stiffness, turn.damping) == expected
