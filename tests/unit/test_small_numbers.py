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
from thermobearing.design.run import one_turn
from thermobearing.design.sizing import design_values, load_curves, load_rubber
from thermobearing.identify.fit.problem import ROBUST_SCALE, _robust_weights, _sample_weights
from thermobearing.identify.records.cycles import full_cycles
from thermobearing.identify.records.record import TestRecord, record_from_arrays
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


def sines(amplitudes: list[float], **options: float) -> TestRecord:
    """A record of one sine a second for each amplitude [mm]; the force is the displacement."""
    phase = np.linspace(0.0, 1.0, 41)[:-1]
    x = np.concatenate([a * np.sin(2.0 * np.pi * phase) for a in amplitudes] + [[0.0]])
    record = record_from_arrays(np.arange(len(x)) / 40.0, x, x, 23.0, name="sines")
    return record if not options else TestRecord(**{**vars(record), **options})


def test_weights_are_roots() -> None:
    """They multiply residuals, which are squared: a weight of 4 counts four times."""
    record = sines([10.0, 10.0, 20.0], weight=4.0, first_cycle_weight=0.25)
    expected = np.repeat([2.0 * 0.5, 2.0, 2.0 * 0.5], 40)
    assert_allclose(_sample_weights(record)[:-1], expected, rtol=tol.ROUNDING)


def test_balanced_cycles_count_by_their_own_peak() -> None:
    record = sines([10.0, 20.0], cycle_balance=1.0)
    assert_allclose(_sample_weights(record)[:-1], np.repeat([2.0, 1.0], 40), rtol=tol.ROUNDING)


LOSSES = {  # rho(z) as scipy documents them
    "linear": lambda z: z,
    "soft_l1": lambda z: 2.0 * (np.sqrt(1.0 + z) - 1.0),
    "huber": lambda z: np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
    "cauchy": lambda z: np.log(1.0 + z),
}


@pytest.mark.parametrize("loss", LOSSES)
def test_robust_weights_are_the_slope_of_the_loss(loss: str) -> None:
    z, h = np.array([0.01, 0.5, 2.0, 4.0, 100.0]), 1e-5
    slope = (LOSSES[loss](z + h) - LOSSES[loss](z - h)) / (2.0 * h)
    weights = _robust_weights(ROBUST_SCALE * np.sqrt(z), loss)
    assert_allclose(weights, slope, rtol=tol.LOSS_SLOPE)


@pytest.mark.parametrize(("amplitude", "closing"), [(4.9, True), (5.1, False)])
def test_cycle_below_a_quarter_of_the_one_before_closes(amplitude: float, closing: bool) -> None:
    cycles = full_cycles(sines([20.0, 20.0, amplitude, 20.0]))
    assert [cycle.closing for cycle in cycles] == [False, False, closing, False]
    assert (cycles[3].number > 1) is closing  # else the last one follows another amplitude


def test_a_first_guess_outside_the_curves_takes_their_nearest_strain() -> None:
    case = make_design_case({}, "test", motions=["jra-ii-i-1"], dt=0.01)
    (turn,) = one_turn(case, 1, [1.0]).rounds  # 1 mm over 14 mm of rubber; the curves begin at 20 %
    nearest = load_curves().smallest_strain * turn.size.total_rubber_thickness
    expected = design_values(load_rubber("G8", "HDR"), turn.size, nearest)
    assert (turn.stiffness, turn.damping) == expected
