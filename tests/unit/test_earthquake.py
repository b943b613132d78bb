"""`bridge` and `hybrid`: files, the same bits again, executors, weather, bad input."""

import json
import tomllib
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import (
    REMOVED,
    Row,
    assert_told,
    by_name,
    changed_table,
    command,
    last_line,
    write_toml,
)
from thermobearing.bearing.ambient import Ambient
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.run import build_device, run_earthquake, soaked

SMALL: dict[str, Any] = {
    "command": "bridge",
    "bearings": ["shen-hdr-bridge"],
    "motions": ["jra-ii-i-1"],
    "ambient": ["-20 degC"],
    "duration": "4 s",
}
RUN_KEYS = {"motion", "ambient_degC", "outcome", "energy", "rubber_degC_max", "lead_degC_max"}
RUN_KEYS |= {"bearing_strain_max", "bearing_force_max_kN", "bearing_energy_kN_mm"}
RUN_KEYS |= {"pier_displacement_max_mm", "pier_ductility", "pier_moment_max_kN_m"}
RUN_KEYS |= {"deck_acceleration_max_m_s2"}
FILES = {"summary.json", "table.csv", "history.csv", "result.nc", "case.resolved.toml", "figures"}
FILES |= {"tested_range.csv"}
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


def test_files_and_summary(saved: Path) -> None:
    assert {path.name for path in saved.iterdir()} == FILES
    told = json.loads((saved / "summary.json").read_text())
    assert told["command"] == "bridge"
    assert told["bearing"] == "shen-lhdr-bridge"
    assert told["mass"] == "consistent"
    assert len(told["periods_s"]) == len(told["damping_ratios"]) == 4
    assert len(told["initial_periods_s"]["shen-lhdr-bridge"]) == 4
    assert told["initial_periods_s"]["shen-lhdr-bridge"][0] < told["periods_s"][0]
    assert [run["ambient_degC"] for run in told["runs"]] == [-20.0, 23.0]
    for run in told["runs"]:
        assert set(run) >= RUN_KEYS
        assert len(run["rubber_degC_max"]) == 3
        assert run["lead_degC_max"] > run["ambient_degC"]
        assert abs(run["energy"]["structure_residual"]) < tol.STRUCTURE_BOOKS
        assert abs(run["energy"]["thermal_residual"]) < tol.ENERGY_BOOKS
    assert {path.name for path in (saved / "figures").iterdir()} == FIGURES


def test_variables_say_their_unit_and_peaks_are_those_of_every_step(saved: Path) -> None:
    data = xr.load_dataset(saved / "result.nc", engine="netcdf4")
    for name in data.data_vars:
        assert "units" in data[name].attrs, name
    kept = np.nanmax(np.abs(data["bearing_force"].values), axis=1)
    peaks = data["bearing_force_max"].values
    assert np.all(peaks >= kept * (1.0 - 1e-6))
    assert np.all(peaks < kept * 1.02)


def test_resolved_case_gives_the_same_bits(saved: Path, tmp_path: Path) -> None:
    done = command("bridge", saved / "case.resolved.toml", "--no-figures", "-o", tmp_path / "again")
    assert done.exit_code == 0, done.output
    for name in ("summary.json", "table.csv", "history.csv", "case.resolved.toml"):
        assert (tmp_path / "again" / name).read_bytes() == (saved / name).read_bytes(), name


def test_hybrid_with_a_laboratory(tmp_path: Path) -> None:
    words = ["--bearing", "shen-hdr-specimen", "--ambient", -20, "--duration", 4, "--no-figures"]
    lab = ["--mode", "pd", "--delay", 0.01, "--force-noise", 0.5, "--seed", 3]
    done = command("hybrid", *words, *lab, "-o", tmp_path / "lab")
    assert done.exit_code == 0, done.output
    told = json.loads((tmp_path / "lab" / "summary.json").read_text())
    assert told["method"] == "predictor-corrector"
    assert told["runs"][0]["pier_ductility"] is None
    case = tomllib.loads((tmp_path / "lab" / "case.resolved.toml").read_text())
    assert case["laboratory"] == {
        "mode": ["pd"],
        "speed": "10.0 mm/s",
        "delay": "0.01 s",
        "force_noise": "0.5 kN",
        "seed": 3,
    }
    again = command("hybrid", *words, *lab, "-o", tmp_path / "again")
    assert again.exit_code == 0
    first, second = (tmp_path / name / "history.csv" for name in ("lab", "again"))
    assert first.read_bytes() == second.read_bytes()
    other = command("hybrid", *words, *lab[:-1], 4, "-o", tmp_path / "other")
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


def test_scaled_motion_and_cut() -> None:
    plain, double = (
        run_earthquake(small(motions=[{"name": "jra-ii-i-1", "factor": factor}]))
        for factor in (1.0, 2.0)
    )
    ground = [np.nanmax(np.abs(r["ground_acceleration"].values)) for r in (plain, double)]
    assert ground[1] == pytest.approx(2.0 * ground[0], rel=1e-6)
    assert np.nanmax(plain["time"].values) == pytest.approx(4.0)


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
    cells, lead = soaked(device, steady)
    assert np.allclose(cells, -12.0, atol=1e-9)
    assert lead == pytest.approx(-12.0)
    drop = Ambient.series([0.0, 1.0, 7200.0], [0.0, -20.0, -20.0])
    cells, lead = soaked(device, drop)
    test = tb.CyclicTest(dt=10.0, steps=[{"step": "rest", "duration": 7200.0}])
    bearing = tb.load_bearing("shen-lhdr-bridge")
    rest = tb.run(bearing, test, ambient=-20.0, initial=0.0)
    assert np.allclose(cells, rest["final_temperature"].values[0], atol=0.05)
    assert lead == pytest.approx(float(rest["final_lead_temperature"].values[0]), abs=0.05)


def test_interrupted_study_keeps_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    import thermobearing.earthquake.run as module

    calls = []
    real = module.run_task

    def second_stops(task: Any) -> Any:
        calls.append(task)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return real(task)

    monkeypatch.setattr(module, "run_task", second_stops)
    with ThreadPoolExecutor(1) as pool:
        result = run_earthquake(small(ambient=["1 degC", "2 degC", "3 degC"]), executor=pool)
    assert result.outcome == "interrupted"
    assert result.sentence.startswith("The run was interrupted")
    assert result.runs == 1


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
    ("no bearings", {"bearings": []}, ["bearings = []", "at least 1"]),
    ("unknown motion", {"motions": ["jra-ii-i-9"]}, ["motions[0]", '"jra-ii-i-']),
    ("motion twice", {"motions": ["jra-ii-i-1"] * 2}, ["more than once"]),
    ("motion without name", {"motions": [{"factor": 2.0}]}, ['missing key "motions[0].name"']),
    (
        "huge factor",
        {"motions": [{"name": "jra-ii-i-1", "factor": 1e4}]},
        ["factor", "at most 100"],
    ),
    ("no motions", {"motions": []}, ["motions = []", "at least 1"]),
    ("air twice", {"ambient": ["5 degC", "5 degC"]}, ["5 degC", "more than once"]),
    ("hot air", {"ambient": ["500 degC"]}, ["ambient[0]", "at most 100"]),
    ("air and weather", {"weather": "night.csv"}, ["ambient or weather, not both"]),
    (
        "missing weather",
        {"weather": "night.csv", "ambient": REMOVED},
        ["night.csv", "no such file"],
    ),
    ("negative duration", {"duration": "-1 s"}, ["duration", "at least 0.001 and at most"]),
    ("dt in mm", {"analysis": {"dt": "1 mm"}}, ["analysis.dt", "to s"]),
    ("dt too large", {"analysis": {"dt": "1 s"}}, ["analysis.dt", "at most 0.1"]),
    (
        "misspelt method",
        {"analysis": {"method": "average-aceleration"}},
        ['"average-acceleration"?'],
    ),
    ("misspelt mass", {"analysis": {"mass": "published "}}, ["analysis.mass", '"published"?']),
    ("misspelt analysis key", {"analysis": {"metod": "x"}}, ['"analysis.metod"', '"method"?']),
    ("unknown key", {"motion": ["jra-ii-i-1"]}, ['unknown key "motion"', '"motions"?']),
    ("delay with Newton", {"laboratory": {"delay": "10 ms"}}, ["predictor-corrector"]),
    ("pd with Newton", {"laboratory": {"mode": "pd"}}, ["predictor-corrector"]),
    ("misspelt mode", {"laboratory": {"mode": "real"}}, ["laboratory.mode", "'rt' or 'pd'"]),
    ("negative noise", {"laboratory": {"force_noise": "-1 kN"}}, ["force_noise", "at least 0"]),
    ("unknown command", {"command": "tunnel"}, ["command = 'tunnel'", '"hybrid"']),
    ("no bodies", structure(bodies=[]), ["structure.bodies", "at least 1"]),
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
        "mass in kN",
        structure(masses=[MASSES | {"mass": "1 kN"}]),
        ["structure.masses[0].mass", "kN"],
    ),
    (
        "spring without stiffness",
        structure(springs=[{"name": "s", "body": "deck"}]),
        ["either stiffness or rotational_stiffness"],
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
        with pytest.raises(tb.InputError) as caught:
            make_earthquake_case(table, str(path))
        assert_told(str(caught.value), pieces)
        return
    assert done.exit_code == 2, done.output
    assert_told(done.output, pieces)
    assert not (tmp_path / "out").exists()


def test_figures_of_many_motions_say_what_they_leave_out() -> None:
    motions = [f"jra-i-i-{k}" for k in (1, 2, 3)] + ["jra-ii-i-1", "jra-ii-i-2"]
    result = run_earthquake(small(motions=motions, duration="1 s"))
    figure = result.plot.loops()
    assert "first 4 of 5 motions" in figure._suptitle.get_text()  # type: ignore[attr-defined]
    assert len(figure.axes) == 4
