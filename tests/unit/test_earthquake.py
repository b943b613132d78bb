"""`bridge` and `hybrid`: files, executors, weather, bad input, and their parts by hand."""

import json
import tomllib
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import (
    REMOVED,
    Row,
    assert_mentions,
    assert_refused,
    by_name,
    changed_table,
    command,
    last_line,
    write_toml,
)
from thermobearing.bearing.ambient import Ambient
from thermobearing.earthquake import run
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.dataset import label_analysis
from thermobearing.earthquake.run import _soaked, build_device, run_earthquake

SMALL: dict[str, Any] = {
    "command": "bridge",
    "bearings": ["shen-hdr-bridge"],
    "motions": ["jra-ii-i-1"],
    "ambient": ["-20 degC"],
    "duration": "4 s",
}
FILES = {"summary.json", "table.csv", "history.csv", "result.nc", "case.resolved.toml", "figures"}
FILES |= {"tested_range.csv", "checks.csv"}
FIGURES = {"loops.png", "strain.png", "energy.png", "pier.png", "deck.png", "peaks.png"}
FIGURES |= {"hinge.png", "temperature.png", "shares.png", "pier_acceleration.png"}
FIGURES |= {"largest_loops.png"}


def small(**changes: Any) -> EarthquakeCase:
    table = {key: value for key, value in (SMALL | changes).items() if value is not REMOVED}
    return make_earthquake_case(table, "test")


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bridge")
    path = write_toml(
        folder / "case.toml", SMALL | {"bearings": ["shen-lhdr-bridge"], "duration": "14 s"}
    )
    done = command(
        "bridge", path, "--ambient", -20, "--ambient", 23, "-o", folder / "out", "--json"
    )
    assert done.exit_code == 0, done.output
    assert last_line(done)["outcome"] == "completed"
    return folder / "out"


def test_files_and_figures(saved: Path) -> None:
    assert {path.name for path in saved.iterdir()} == FILES
    assert {path.name for path in (saved / "figures").iterdir()} == FIGURES


def test_variables_say_their_unit_and_peaks_are_those_of_every_step(saved: Path) -> None:
    data = xr.load_dataset(saved / "result.nc", engine="netcdf4")
    for name in data.data_vars:
        assert "units" in data[name].attrs, name
    kept = np.nanmax(np.abs(data["bearing_force"].values), axis=1)
    peaks = data["bearing_force_max"].values
    assert np.all(peaks >= kept * (1.0 - 1e-6))
    assert np.all(peaks < kept * 1.02)


@pytest.mark.thorough
def test_hybrid_with_a_laboratory(tmp_path: Path) -> None:
    words = ["--bearing", "shen-hdr-specimen", "--ambient", -20, "--duration", 4, "--no-figures"]
    lab = ["--mode", "pd", "--laboratory", "delay=10 ms", "--laboratory", "force_noise=0.5"]
    lab += ["--laboratory", "seed=3"]
    done = command("hybrid", *words, *lab, "-o", tmp_path / "lab")
    assert done.exit_code == 0, done.output
    reported = json.loads((tmp_path / "lab" / "summary.json").read_text())
    assert reported["method"] == "predictor-corrector"
    assert reported["runs"][0]["pier_ductility"] is None
    case = tomllib.loads((tmp_path / "lab" / "case.resolved.toml").read_text())
    assert case["laboratory"] == {
        "mode": ["pd"],
        "speed": "10.0 mm/s",
        "delay": "0.01 s",
        "force_noise": "0.5 kN",
        "seed": 3,
        "compensation": 0,
        "time_out": "10.0 s",
    }
    again = command("hybrid", *words, *lab, "-o", tmp_path / "again")
    assert again.exit_code == 0
    first, second = (tmp_path / name / "history.csv" for name in ("lab", "again"))
    assert first.read_bytes() == second.read_bytes()
    other = command("hybrid", *words, *lab[:-1], "seed=4", "-o", tmp_path / "other")
    assert other.exit_code == 0
    assert (tmp_path / "other" / "history.csv").read_bytes() != first.read_bytes()


def test_any_executor_gives_the_same_bits() -> None:
    case = small(ambient=["-20 degC", "23 degC"], duration="2 s")
    results = [run_earthquake(case)]
    with ThreadPoolExecutor(1) as pool:
        results.append(run_earthquake(case, executor=pool))
    with ProcessPoolExecutor(1) as pool:
        results.append(run_earthquake(case, executor=pool))
    for other in results[1:]:
        for name in results[0].dataset.data_vars:
            assert_array_equal(other[str(name)].values, results[0][str(name)].values)


def test_published_mass_and_scheme_change_something() -> None:
    base = run_earthquake(small()).table
    for change in (
        {"mass": "published"},
        {"scheme": "published"},
        {"method": "linear-acceleration"},
        {"dt": "0.0025 s"},
        {"integrator": "euler"},
        {"heat_source": "dissipation"},
    ):
        other = run_earthquake(small(analysis=change)).table
        assert other["bearing_force_max_kN"][0] != base["bearing_force_max_kN"][0], change


def night(tmp_path: Path) -> Path:
    """From -5 to -25 degC in twelve hours."""
    path = tmp_path / "night.csv"
    hours = np.linspace(0.0, 12.0, 49)
    rows = [f"{3600.0 * h},{-5.0 - 20.0 * h / 12.0}" for h in hours]
    path.write_text("time_s,temperature_degC\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def test_weather_before_the_earthquake(tmp_path: Path) -> None:
    """The bearing lags behind the night: warmer inside, softer than the air would make it.

    Two-dimensional finite volumes find -16.3 degC in the mean of the rubber.
    """
    path = night(tmp_path)
    case = small(weather=str(path), ambient=REMOVED)
    result = run_earthquake(case)
    cold = run_earthquake(small(ambient=["-25 degC"]))
    assert float(result["ambient"].values[0]) == -25.0
    inner = result["rubber_temperature"].values[0, 0]
    assert np.all(np.diff(inner) > 0.0)  # the inner layers lag more
    assert inner.mean() == pytest.approx(-16.8, abs=0.5)
    held = {face: {"eta": 2.0} for face in ("upper_face", "lower_face")}
    faces = run_earthquake(small(weather=str(path), ambient=REMOVED, analysis=held))
    assert faces["rubber_temperature"].values[0, 0].max() < -20.0
    assert cold["rubber_temperature"].values[0, 0] == pytest.approx([-25.0] * 3)
    first = [r.dataset.attrs["initial_periods_s:shen-hdr-bridge"][0] for r in (result, cold)]
    assert first[0] > first[1]
    resolved = tomllib.loads(result.dataset.attrs["case"])
    assert resolved["weather"] == str(path)
    assert "ambient" not in resolved


def test_weather_is_the_same_heat_model() -> None:
    """Soaking at one temperature is that temperature; a step decays as in a rest of a test."""
    case = small(bearings=["shen-lhdr-bridge"])
    device = build_device(case, case.bearings[0])
    steady = Ambient.series([0.0, 3600.0], [-12.0, -12.0])
    cells, lead = _soaked(device, steady)
    assert np.allclose(cells, -12.0, atol=1e-9)
    assert lead == pytest.approx(-12.0)
    drop = Ambient.series([0.0, 1.0, 7200.0], [0.0, -20.0, -20.0])
    cells, lead = _soaked(device, drop)
    test = tb.CyclicTest(dt=10.0, steps=[{"step": "rest", "duration": 7200.0}])
    bearing = tb.load_bearing("shen-lhdr-bridge")
    rest = tb.run(bearing, test, ambient=-20.0, initial=0.0)
    assert np.allclose(cells, rest["final_temperature"].values[0], atol=0.05)
    assert lead == pytest.approx(float(rest["final_lead_temperature"].values[0]), abs=0.05)


def test_interrupted_study_keeps_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    real = run.run_task

    def second_stops(task: Any) -> Any:
        calls.append(task)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return real(task)

    monkeypatch.setattr(run, "run_task", second_stops)
    with ThreadPoolExecutor(1) as pool:
        result = run_earthquake(small(ambient=["1 degC", "2 degC", "3 degC"]), executor=pool)
    assert result.outcome == "interrupted"
    assert result.sentence.startswith("The run was interrupted")
    assert result.runs == 1


def test_an_analysis_interrupted_at_once_is_a_result(tmp_path: Path) -> None:
    result = label_analysis(small(), [], [])
    assert (result.runs, result.outcome) == (0, "interrupted")
    result.show()
    assert json.loads((result.save(tmp_path / "out", figures=False) / "summary.json").read_text())


MASSES = {"body": "deck", "height": "0 m", "mass": "1 t"}
STRUCTURE: dict[str, Any] = {
    "name": "one",
    "bodies": [{"name": "deck", "moves": True}],
    "masses": [MASSES],
    "bearings": [{"name": "b", "body": "deck", "count": 1, "equivalent_stiffness": "1 kN/mm"}],
    "report": {"deck": "deck", "pier": "deck", "pier_top": "0 m"},
}


def structure(**changes: Any) -> dict[str, Any]:
    table = json.loads(json.dumps(STRUCTURE))
    return {"structure": changed_table(table, changes)}


BAD: list[Row] = [
    ("unknown structure", {"structure": "pier-p2"}, ["structure", '"pier-p1"?']),
    ("unknown bearing", {"bearings": ["shen-hdr-bridg"]}, ["bearings[0]", '"shen-hdr-bridge"?']),
    ("missing bearing file", {"bearings": ["mine.toml"]}, ["bearings[0]", "mine.toml", "no such"]),
    ("bearing twice", {"bearings": ["shen-hdr-bridge"] * 2}, ["more than once"]),
    ("unknown motion", {"motions": ["jra-ii-i-9"]}, ["motions[0]", '"jra-ii-i-']),
    ("motion twice", {"motions": ["jra-ii-i-1"] * 2}, ["more than once"]),
    ("air twice", {"ambient": ["5 degC", "5 degC"]}, ["5 degC", "more than once"]),
    ("air and weather", {"weather": "night.csv"}, ["ambient or weather, not both"]),
    (
        "missing weather",
        {"weather": "night.csv", "ambient": REMOVED},
        ["night.csv", "no such file"],
    ),
    (
        "misspelt method",
        {"analysis": {"method": "average-aceleration"}},
        ['"average-acceleration"?'],
    ),
    ("delay with Newton", {"laboratory": {"delay": "10 ms"}}, ["predictor-corrector"]),
    ("pd with Newton", {"laboratory": {"mode": "pd"}}, ["predictor-corrector"]),
    ("noise with Newton", {"laboratory": {"force_noise": "1 kN"}}, ["predictor-corrector"]),
    ("unknown command", {"command": "tunnel"}, ["command = 'tunnel'", '"hybrid"']),
    ("unknown body", structure(**{"report.deck": "dek"}), ['"dek"', '"deck"?']),
    ("body on nothing", structure(bodies=[{"name": "deck"}]), ["moves = true"]),
    (
        "carried by what comes later",
        structure(bodies=[{"name": "deck", "on": "pier"}, {"name": "pier", "moves": True}]),
        ['"pier", which is not above it'],
    ),
    (
        "coordinate without mass",
        structure(bodies=[{"name": "deck", "moves": True}, {"name": "x", "moves": True}]),
        ['"x x" has no mass'],
    ),
    (
        "mechanism",
        structure(
            bodies=[{"name": "deck", "moves": True}, {"name": "x", "moves": True}],
            masses=[MASSES, MASSES | {"body": "x"}],
        ),
        ["mechanism"],
    ),
]


@pytest.mark.parametrize(("changes", "pieces"), by_name(BAD))
def test_bad_case(tmp_path: Path, changes: dict[str, Any], pieces: list[str]) -> None:
    table = {key: value for key, value in (SMALL | changes).items() if value is not REMOVED}
    path = write_toml(tmp_path / "case.toml", table)
    done = command("bridge", path, "-o", tmp_path / "out")
    if changes.get("command") == "tunnel":
        assert_refused(lambda: make_earthquake_case(table, str(path)), *pieces)
        return
    assert done.exit_code == 2, done.output
    assert_mentions(done.output, pieces)
    assert not (tmp_path / "out").exists()


def test_figures_of_many_motions_say_what_they_leave_out() -> None:
    motions = [f"jra-i-i-{k}" for k in (1, 2, 3)] + ["jra-ii-i-1", "jra-ii-i-2"]
    result = run_earthquake(small(motions=motions, duration="1 s"))
    figure = result.plot.loops()
    assert "first 4 of 5 motions" in figure._suptitle.get_text()  # type: ignore[attr-defined]
    assert len(figure.axes) == 4


# Parts of an analysis by hand: motions, weather, noise, models of bearings.
HDR, BILINEAR = "shen-hdr-bridge", "shen-bilinear-bridge"


def make_case(command: str = "bridge", **options: Any) -> Any:
    given = {"bearings": [HDR], "motions": ["jra-ii-i-1"], **options}
    return make_earthquake_case({"command": command}, "test", **given)


def weather(folder: Path, begin: float) -> Path:
    """A night: 20 degC, six hours down to -10 degC."""
    path = folder / f"night-{begin:g}.csv"
    path.write_text(f"time_s,temperature_degC\n{begin},20\n{begin + 21600},-10\n")
    return path


@pytest.mark.parametrize("begin", [0.0, 1e8])  # longer than a weather may last
def test_weather_may_begin_at_any_time(begin: float, tmp_path: Path) -> None:
    (task,) = run.build_tasks(make_case(weather=str(weather(tmp_path, begin))))
    cells, lead = task.reported.temperature, task.reported.lead
    assert task.ambient == -10.0
    assert lead is None
    # Six hours of cooling air: the faces lag behind by less than the middle does.
    assert -10.0 < cells[0] < cells[-1] < 20.0
    other = run.build_tasks(make_case(weather=str(weather(tmp_path, 0.0))))[0].reported.temperature
    assert_allclose(cells, other, rtol=tol.LOOP)


def test_air_without_change_leaves_the_bearing_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "still.csv"
    path.write_text("time_s,temperature_degC\n0,-7\n3600,-7\n")
    (task,) = run.build_tasks(make_case(weather=str(path)))
    assert_allclose(task.reported.temperature, -7.0)
    steps = tmp_path / "steps.csv"
    steps.write_text("time_s,temperature_degC\n0,30\n1,0\n2,0\n")
    (task,) = run.build_tasks(make_case(weather=str(steps)))
    assert task.reported.temperature[-1] > 29.9  # two seconds are too short to cool the middle


def test_motion_is_scaled_cut_and_met_at_every_sample() -> None:
    motion = tb.load_motion("jra-ii-i-1")  # samples every 10 ms
    table = {"name": "jra-ii-i-1", "factor": 0.5}
    for dt, parts in ((0.01, 1), (0.02, 1), (0.005, 2), (0.004, 3), (0.0034, 3)):
        shaking = run.build_shaking(make_case(motions=[table], dt=dt, duration=2.0), 0, motion)
        assert shaking.dt == pytest.approx(0.01 / parts)
        assert len(shaking.ground) == 200 * parts + 1
        assert_allclose(shaking.ground[::parts], 0.5 * motion.acceleration[:201], rtol=tol.LOOP)
    whole = run.build_shaking(make_case(duration=1e4), 0, motion)
    assert len(whole.ground) == 2 * (len(motion.acceleration) - 1) + 1


def test_a_motion_file_is_read_once_until_it_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, read = tmp_path / "mine.csv", []
    monkeypatch.setattr(
        "thermobearing.earthquake.motions.load_motion",
        lambda *a, **_: read.append(a) or tb.load_motion(*a),
    )
    for size in (150.0, 200.5):
        path.write_text("t_s,acc_gal\n" + f"0,0\n0.01,{size}\n0.02,{-size}\n0.03,0\n")
        task = run.build_tasks(make_case(motions=[str(path)]))[0]
        assert np.max(task.shaking.ground) == pytest.approx(10.0 * size)
    assert len(read) == 2


@pytest.mark.parametrize(("mode", "speed"), [("rt", 0.0), ("pd", 25.0)])
def test_laboratory_by_hand(mode: str, speed: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Noise with the standard deviation that was asked for; a separate clock in pd only."""
    asked: dict[str, Any] = {}

    def fake(prepared: Any, lines: Any, ground: Any, dt: float, air: Any, **options: Any) -> Any:
        asked.update(options, lines=lines, air=air)
        return SimpleNamespace(outcome="interrupted", axial=None)

    monkeypatch.setattr(run, "run_structure", fake)
    lab = {"mode": mode, "speed": "25 mm/s", "force_noise": "3 kN", "seed": 4, "delay": "8 ms"}
    case = make_case(
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


def test_backbone_of_a_bilinear_bearing(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(run, "bilinear_constants", asked.append)
    bearing = tb.load_bilinear(BILINEAR)
    run.build_device(make_case(bearings=[BILINEAR]), bearing)
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
    result = tb.hybrid("shen-lhdr-specimen", ambient=0, duration=6, laboratory=lab)
    energy = result.energy.iloc[0]
    share = energy["actuator_kN_mm"] / energy["input_kN_mm"]
    assert share < -0.01  # a delay feeds energy to the structure
    assert abs(energy["structure_residual"]) < 1e-3
    assert any("actuator feed" in text for text in result.warnings) == (share < -0.05)
    assert "energy_actuator" not in tb.bridge(duration=1, ambient=23).dataset
