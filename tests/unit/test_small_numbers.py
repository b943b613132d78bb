"""Single numbers that no whole run shows, or that it would show as well if they were wrong."""

import pytest

import thermobearing as tb
from thermobearing.design.case import make_design_case
from thermobearing.design.run import _one_turn
from thermobearing.design.sizing import design_values, load_curves, load_rubber


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


def test_a_first_guess_outside_the_curves_takes_their_nearest_strain() -> None:
    case = make_design_case({}, "test", motions=["jra-ii-i-1"], dt=0.01)
    (turn,) = _one_turn(
        case, 1, [1.0]
    ).rounds  # 1 mm over 14 mm of rubber; the curves begin at 20 %
    nearest = load_curves().smallest_strain * turn.size.total_rubber_thickness
    expected = design_values(load_rubber("G8", "HDR"), turn.size, nearest)
    assert (turn.stiffness, turn.damping) == expected
