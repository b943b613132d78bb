"""Small errors of cyclic tests that went unseen once."""

import math
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.cyclic import dataset as label
from thermobearing.cyclic.equivalent import solve_backbone
from thermobearing.cyclic.history import Segment, longest_layer_increment
from thermobearing.cyclic.protocol import Recorded, Rest
from thermobearing.cyclic.result import _history_blocks


def test_history_has_the_steps_of_each_temperature_and_no_more() -> None:
    """A rest that settles ends sooner at one temperature than at another."""
    steps = [
        {"step": "ramp", "to_strain": 1.0, "duration": 1.0},
        {"step": "rest", "within": "0.5 K"},
    ]
    test = tb.CyclicTest.model_validate({"dt": 0.05, "steps": steps})
    result = tb.run("shen-hdr-specimen", test, [-20.0, 40.0])
    kept = (result["segment"].values >= 0).sum(axis=1)
    assert kept[0] != kept[1]
    rows = "".join(_history_blocks(result)).splitlines()[1:]
    assert [sum(row.startswith(f"{t:g},") for row in rows) for t in (-20.0, 40.0)] == list(kept)
    assert not any("nan" in row for row in rows)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_longest_step_is_that_either_way(way: float) -> None:
    x = way * np.array([0.0, 1.0, 13.0, 12.0])
    none = np.zeros(4)
    segment = Segment("ramp", "", x, none, none.astype(np.int32), none.astype(bool))
    assert longest_layer_increment([segment], 6) == pytest.approx(2.0)


def test_waiting_for_a_temperature_ends_after_two_weeks() -> None:
    rest = Rest.model_validate({"step": "rest", "within": "0.1 K"})
    assert rest.span == 14 * 86400.0


@pytest.mark.parametrize("first", [10.0, -10.0])
def test_a_recording_starts_where_the_bearing_is(first: float, tmp_path: Path) -> None:
    path = tmp_path / "recorded.csv"
    path.write_text(f"time_s,displacement_mm\n0,{first}\n1,5\n2,0\n")
    recorded = Recorded(file=str(path))
    with pytest.raises(tb.InputError, match="put a ramp before it"):
        recorded.points(0.0)
    gaps, x, _ = recorded.points(first)
    assert (list(gaps), list(x)) == ([1.0, 1.0], [first, 5.0, 0.0])


def test_backbone_is_the_slim_one_of_two() -> None:
    """Two loops have the stiffness and the damping; the other has nearly all of K_B in Q_d."""
    found = solve_backbone(2.0, 0.15, 100.0, 1.0 / 6.5)
    assert found is not None
    assert found.strength + found.post_yield * 100.0 == pytest.approx(200.0)
    yielding = found.strength / (found.initial - found.post_yield)
    area = 4.0 * found.strength * (100.0 - yielding)
    assert area == pytest.approx(2.0 * math.pi * 0.15 * 2.0 * 100.0**2)
    assert found.strength < 100.0


def test_labels_are_made_when_they_are_first_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """They take longer than a short run."""
    made = []
    whole = label.labelled
    monkeypatch.setattr(label, "labelled", lambda *told: made.append(1) or whole(*told))
    result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
    assert made == []
    assert result.outcome == "completed"
    assert result["force"] is not None
    assert made == [1]
