"""Parts of an earthquake study by hand: motions, weather, noise, models of bearings."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.earthquake import run
from thermobearing.earthquake.case import make_earthquake_case

HDR, BILINEAR = "shen-hdr-bridge", "shen-bilinear-bridge"


def case_of(command: str = "bridge", **options: Any) -> Any:
    given = {"bearings": [HDR], "motions": ["jra-ii-i-1"], **options}
    return make_earthquake_case({"command": command}, "test", **given)


def weather(folder: Path, begin: float) -> Path:
    """A night: 20 degC, six hours down to -10 degC."""
    path = folder / f"night-{begin:g}.csv"
    path.write_text(f"time_s,temperature_degC\n{begin},20\n{begin + 21600},-10\n")
    return path


@pytest.mark.parametrize("begin", [0.0, 86400.0])
def test_weather_may_begin_at_any_time(begin: float, tmp_path: Path) -> None:
    """What counts is how long it lasted; the earthquake comes at its end."""
    (task,) = run.build_tasks(case_of(weather=str(weather(tmp_path, begin))))
    cells, lead = task.reported.temperature, task.reported.lead
    assert task.ambient == -10.0
    assert lead is None
    # Six hours of cooling air: the faces lag behind by less than the middle does.
    assert -10.0 < cells[0] < cells[-1] < 20.0
    other = run.build_tasks(case_of(weather=str(weather(tmp_path, 0.0))))[0].reported.temperature
    assert_allclose(cells, other, rtol=tol.LOOP)


def test_air_without_change_leaves_the_bearing_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "still.csv"
    path.write_text("time_s,temperature_degC\n0,-7\n3600,-7\n")
    (task,) = run.build_tasks(case_of(weather=str(path)))
    assert_allclose(task.reported.temperature, -7.0)
    steps = tmp_path / "steps.csv"
    steps.write_text("time_s,temperature_degC\n0,30\n1,0\n2,0\n")
    (task,) = run.build_tasks(case_of(weather=str(steps)))
    assert task.reported.temperature[-1] > 29.9  # two seconds are too short to cool the middle


def test_motion_is_scaled_cut_and_met_at_every_sample() -> None:
    motion = tb.load_motion("jra-ii-i-1")  # samples every 10 ms
    table = {"name": "jra-ii-i-1", "factor": 0.5}
    for dt, parts in ((0.01, 1), (0.02, 1), (0.005, 2), (0.004, 3), (0.0034, 3)):
        shaking = run.build_shaking(case_of(motions=[table], dt=dt, duration=2.0), 0, motion)
        assert shaking.dt == pytest.approx(0.01 / parts)
        assert len(shaking.ground) == 200 * parts + 1
        assert_allclose(shaking.ground[::parts], 0.5 * motion.acceleration[:201], rtol=tol.LOOP)
    whole = run.build_shaking(case_of(duration=1e4), 0, motion)
    assert len(whole.ground) == 2 * (len(motion.acceleration) - 1) + 1


@pytest.mark.parametrize(("mode", "speed"), [("rt", 0.0), ("pd", 25.0)])
def test_laboratory_by_hand(mode: str, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Noise with the standard deviation that was asked for; a clock of its own in pd only."""
    asked: dict[str, Any] = {}

    def fake(prepared: Any, lines: Any, ground: Any, dt: float, air: Any, **options: Any) -> Any:
        asked.update(options, lines=lines, air=air)
        return SimpleNamespace(outcome="interrupted")

    monkeypatch.setattr(run, "run_structure", fake)
    lab = {"mode": mode, "speed": "25 mm/s", "force_noise": "3 kN", "seed": 4, "delay": "8 ms"}
    case = case_of(
        "hybrid", bearings=["shen-hdr-specimen"], laboratory=lab, duration=4.0, ambient=-20.0
    )
    (task,) = run.build_tasks(case)
    run.run_task(task)
    steps = len(task.shaking.ground) - 1
    wanted = 3.0 * np.random.default_rng(4).standard_normal(steps)
    assert_allclose(asked["noise"], wanted, rtol=tol.LOOP)
    assert asked["delay"] == pytest.approx(0.008)
    assert [line.speed for line in asked["lines"]] == [speed]
    assert asked["method"] == "predictor-corrector"
    assert_allclose(asked["air"], np.full(steps, -20.0))


def test_source_s_actuator_moves_at_10_mm_per_second() -> None:
    case = case_of("hybrid", bearings=["shen-hdr-specimen"], laboratory={"mode": "pd"})
    assert case.laboratory.speed == 10.0
    assert case.analysis.method == "predictor-corrector"


@pytest.mark.parametrize("lab", [{"delay": "1 ms"}, {"force_noise": "1 kN"}, {"mode": "pd"}])
def test_what_needs_a_specimen_that_moves_once_per_step(lab: dict[str, str]) -> None:
    with pytest.raises(tb.InputError, match="predictor-corrector"):
        case_of("hybrid", bearings=["shen-hdr-specimen"], laboratory=lab,
                method="average-acceleration")  # fmt: skip


def test_backbone_of_a_bilinear_bearing(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(run, "bilinear_constants", asked.append)
    bearing = tb.load_bilinear(BILINEAR)
    run.build_device(case_of(bearings=[BILINEAR]), bearing)
    (p,) = asked
    assert (p.strength, p.initial, p.post_yield) == (
        bearing.strength, bearing.initial_stiffness, bearing.post_yield_stiffness,
    )  # fmt: skip


@pytest.mark.parametrize(("given", "left"), [("ambient", "weather"), ("weather", "ambient")])
def test_air_of_the_command_line_replaces_that_of_the_file(
    given: str, left: str, tmp_path: Path
) -> None:
    air = {"ambient": [5.0], "weather": str(weather(tmp_path, 0.0))}
    table = {"command": "bridge", "ambient": ["5 degC"], "weather": air["weather"]}
    del table[given]
    case = make_earthquake_case(table, "test", **{given: air[given]})
    assert (case.weather is None) == (given == "ambient")
    if given == "ambient":
        assert case.ambient == [5.0]


@pytest.mark.parametrize("lab", [{"delay": 0.03}, {"delay": 0.005, "force_noise": 2.0}])
def test_work_of_the_actuator_closes_the_energy_balance(lab: dict[str, float]) -> None:
    """Before, 0.59 of the input was missing with a delay of 30 ms, and nothing said so."""
    result = tb.hybrid("shen-lhdr-specimen", ambient=0, duration=6, laboratory=lab)
    energy = result.energy.iloc[0]
    share = energy["actuator_kN_mm"] / energy["input_kN_mm"]
    assert share < -0.01  # a delay feeds energy to the structure
    assert abs(energy["structure_residual"]) < 1e-3
    assert any("actuator feed" in text for text in result.warnings) == (share < -0.05)
    assert "energy_actuator" not in tb.bridge(duration=1, ambient=23).dataset
