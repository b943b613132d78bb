"""Tests as steps: Table 3.4, waves and timings, ramps, rests, recordings followed exactly."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import SPECIMEN
from thermobearing.cyclic.history import FEWEST_STEPS, REST_GROWTH, Segment, build_segments
from thermobearing.cyclic.protocol import MAX_STEPS

RUBBER = 30.0  # total rubber thickness of the specimen [mm]


def built(*steps: dict[str, Any], dt: float = 0.01) -> list[Segment]:
    return build_segments(tb.CyclicTest(dt=dt, steps=list(steps)), RUBBER)


def cycles(**changes: Any) -> dict[str, Any]:
    return {"step": "cycles", "strain": 1.0, "count": 2, **changes}


def of_kind(segments: list[Segment], kind: str) -> list[Segment]:
    return [segment for segment in segments if segment.kind == kind]


@pytest.fixture(scope="module")
def table_3_4() -> list[Segment]:
    return build_segments(tb.cyclic_test(), RUBBER)


def test_table_3_4_amplitudes_and_periods(table_3_4: list[Segment]) -> None:
    loading = of_kind(table_3_4, "cycles")
    assert [segment.amplitude_strain for segment in loading] == [0.5, 1.0, 1.5, 2.0, 2.5]
    for segment, period in zip(loading, [2.0, 4.0, 6.0, 8.0, 10.0], strict=True):
        assert_allclose(segment.dt.sum(), 5 * period, rtol=tol.PROTOCOL)
        assert segment.dt.max() <= 0.005 * (1 + tol.PROTOCOL)
        assert_array_equal(np.unique(segment.cycle), [1, 2, 3, 4, 5])
        speed = np.abs(np.diff(segment.x, prepend=0.0)) / segment.dt
        assert_allclose(speed, 30.0, rtol=tol.PROTOCOL)


def test_table_3_4_closing_cycles_and_rests(table_3_4: list[Segment]) -> None:
    kinds = [segment.kind for segment in table_3_4]
    assert kinds == ["cycles", "closing cycle", "rest"] * 4 + ["cycles", "closing cycle"]
    for segment in of_kind(table_3_4, "closing cycle"):
        assert np.abs(segment.x).max() == 0.1 * RUBBER
        assert segment.x[-1] == 0.0
        assert not segment.cycle.any()
    for segment in of_kind(table_3_4, "rest"):
        assert_allclose(segment.dt.sum(), 4500.0, rtol=tol.PROTOCOL)
        assert not segment.x.any()


def test_name_tells_the_printed_test_from_others() -> None:
    assert tb.cyclic_test().name == "Table 3.4"
    assert tb.cyclic_test(wave="sine", dt=0.01).name == "Table 3.4"  # both waves are in it
    for other in ({"strain": [0.1, 0.2, 0.3, 0.4, 0.5]}, {"cycles": 3}, {"speed": 10.0}):
        assert tb.cyclic_test(**other).name == "cyclic test"


@pytest.mark.parametrize("wave", ["triangular", "sine"])
@pytest.mark.parametrize("dt", [0.013, 0.25, 10.0])
def test_peaks_and_zeros_are_hit_exactly(wave: str, dt: float) -> None:
    (segment,) = built(cycles(wave=wave, speed=30.0), dt=dt)
    per_cycle = len(segment.x) // 2
    steps = per_cycle // 4
    assert steps >= FEWEST_STEPS
    quarter = segment.x[steps - 1 :: steps]
    assert_array_equal(quarter, [30.0, 0.0, -30.0, 0.0] * 2)
    assert np.abs(segment.x).max() == 30.0
    assert segment.turning[steps - 1 :: steps].all()
    assert segment.turning.sum() == 8
    assert segment.dt.max() <= dt
    # The way down mirrors the way up, and the second half the first.
    one = np.concatenate([[0.0], segment.x[:per_cycle]])
    assert_array_equal(one[: 2 * steps + 1], one[: 2 * steps + 1][::-1])
    assert_array_equal(one[2 * steps :], -one[: 2 * steps + 1])


def test_sine_is_a_sine() -> None:
    (segment,) = built(cycles(wave="sine", period=4.0))
    time = np.cumsum(segment.dt)
    exact = 30.0 * np.sin(0.5 * np.pi * time)
    assert_allclose(segment.x, exact, rtol=0.0, atol=30.0 * tol.WAVE)


@pytest.mark.parametrize("wave", ["triangular", "sine"])
@pytest.mark.parametrize("amplitude", [{"strain": 1.5}, {"strain": None, "amplitude": 45.0}])
def test_speed_period_and_frequency_say_the_same(wave: str, amplitude: dict[str, Any]) -> None:
    timings = [{"speed": 30.0}, {"period": 6.0}, {"frequency": 1.0 / 6.0}]
    (first,), *others = [built(cycles(wave=wave, **amplitude, **timing)) for timing in timings]
    for (other,) in others:
        assert_allclose(other.x, first.x, rtol=tol.PROTOCOL)
        assert_allclose(other.dt, first.dt, rtol=tol.PROTOCOL)
    assert first.amplitude_strain == 1.5


def test_closing_cycle_keeps_the_speed() -> None:
    main, closing = built(cycles(strain=2.0, period=8.0, closing_strain=0.1))
    speeds = [np.abs(np.diff(part.x, prepend=0.0)) / part.dt for part in (main, closing)]
    assert_allclose(speeds[0], 30.0, rtol=tol.PROTOCOL)
    assert_allclose(speeds[1], 30.0, rtol=tol.PROTOCOL)


def test_ramps() -> None:
    there, back = built(
        {"step": "ramp", "to_strain": -0.5, "speed": 5.0},
        {"step": "ramp", "to": 10.0, "duration": 1.0},
    )
    assert_allclose(there.dt.sum(), 3.0, rtol=tol.PROTOCOL)
    assert_allclose(np.diff(there.x, prepend=0.0) / there.dt, -5.0, rtol=tol.PROTOCOL)
    assert there.x[-1] == -15.0
    assert_allclose(np.diff(back.x, prepend=-15.0) / back.dt, 25.0, rtol=tol.RAMP)
    assert back.x[-1] == 10.0
    assert_array_equal(np.flatnonzero(back.turning), [len(back.x) - 1])


@pytest.mark.parametrize("target", [0.3, -0.7, 1e-3, 70.1])
def test_ramp_ends_exactly(target: float) -> None:
    """0.1 + (0.3 - 0.1) is not 0.3, and cycles may only follow at zero."""
    ramps = [{"step": "ramp", "to": x, "duration": 0.07} for x in (0.1, target, 0.0)]
    assert [segment.x[-1] for segment in built(*ramps, cycles(speed=30.0))[:3]] == [
        0.1,
        target,
        0.0,
    ]


def test_ramp_to_where_it_is_takes_no_time() -> None:
    (segment,) = built({"step": "ramp", "to": 0.0, "speed": 1.0})
    assert_array_equal(segment.x, [0.0])
    assert 0.0 < segment.dt.sum() < 1e-6


@pytest.mark.parametrize("duration", [0.004, 1.0, 77.7, 4500.0, 1e6])
def test_rest_grows_its_steps_and_ends_exactly(duration: float) -> None:
    _, rest = built(
        {"step": "ramp", "to": 3.0, "duration": 1.0}, {"step": "rest", "duration": duration}
    )
    assert_allclose(rest.dt.sum(), duration, rtol=tol.PROTOCOL)
    assert (rest.x == 3.0).all()
    assert rest.dt[0] <= 0.01
    assert (rest.dt > 0.0).all()
    grown = rest.dt[1:-1] / rest.dt[:-2]
    assert (grown <= REST_GROWTH * (1 + tol.PROTOCOL)).all()
    assert rest.dt.max() <= max(0.01, 1.5 * min(duration / 100.0, 600.0))
    assert len(rest.dt) < 3000


def test_rest_within_ends_when_settled() -> None:
    """The heated bearing rests until every cell is that close to the air, and not a step more."""
    test = tb.CyclicTest(
        dt=0.01, steps=[cycles(speed=60.0, count=3), {"step": "rest", "within": 0.5}]
    )
    result = tb.run(SPECIMEN, test, ambient=0)
    rest = result["segment"].values[0] == 1
    farthest = np.abs(result["temperature"].values[0][rest]).max(axis=1)
    assert farthest[0] > 0.5
    assert (farthest[:-1] > 0.5).all()
    assert farthest[-1] <= 0.5
    assert result.outcome == "completed"
    assert_allclose(result["final_temperature"].values[0], 0.0, atol=0.5)


def recorded(tmp_path: Path, time: Any, x: Any, dt: float = 0.01) -> Segment:
    path = tmp_path / "moved.csv"
    rows = "\n".join(f"{a!r},{b!r}" for a, b in zip(time, x, strict=True))
    path.write_text("time_s,displacement_mm\n" + rows)
    (segment,) = built({"step": "recorded", "file": str(path)}, dt=dt)
    return segment


def test_recording_is_followed_exactly(tmp_path: Path) -> None:
    """Uneven times: every recorded point is the end of a step, straight lines between them."""
    rng = np.random.default_rng(8)
    time = np.cumsum(rng.uniform(0.001, 0.1, 300)).tolist()
    x = [0.0, *rng.uniform(-60.0, 60.0, 299).tolist()]
    segment = recorded(tmp_path, time, x)
    assert_array_equal(segment.x[segment.turning], x[1:])
    clock = time[0] + np.cumsum(segment.dt)
    assert_allclose(clock[segment.turning], time[1:], rtol=tol.PROTOCOL)
    line = np.interp(clock, time, x)
    assert_allclose(segment.x, line, rtol=0.0, atol=60.0 * tol.RECORDING)
    assert segment.dt.max() <= 0.01 * (1 + tol.PROTOCOL)
    assert_allclose(segment.amplitude_strain, np.abs(x).max() / RUBBER, rtol=tol.PROTOCOL)


def test_recording_with_long_dt_keeps_its_points(tmp_path: Path) -> None:
    segment = recorded(tmp_path, [0.0, 0.1, 0.2, 0.3], [0.0, 5.0, -5.0, 1.0], dt=10.0)
    assert_array_equal(segment.x, [5.0, -5.0, 1.0])


def test_steps_follow_one_another(tmp_path: Path) -> None:
    path = tmp_path / "moved.csv"
    path.write_text("time_s,displacement_mm\n7,15\n8,0\n")
    segments = built(
        {"step": "ramp", "to_strain": 0.5, "speed": 5.0},
        {"step": "recorded", "file": str(path)},
        cycles(speed=30.0),
    )
    assert [segment.kind for segment in segments] == ["ramp", "recorded", "cycles"]
    jumps = np.diff(np.concatenate([segment.x for segment in segments]), prepend=0.0)
    assert np.abs(jumps).max() < 0.5


def test_largest_test_is_refused_before_it_is_built() -> None:
    """The limit is on the sum of all steps; the arrays of the first would already be too large."""
    with pytest.raises(tb.InputError, match=f"the limit is {MAX_STEPS}"):
        built(cycles(speed=30.0, count=10_000), cycles(speed=30.0, count=20_000), dt=0.0002)
