"""Tests in a plane: shapes of paths, what is refused, datasets, measures, files and figures."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.shared_data import shared_data
from tests.unit.inputs import assert_refused
from thermobearing.border.errors import InputError
from thermobearing.cli import app
from thermobearing.cyclic.case import load_case, make_case
from thermobearing.cyclic.comparison import comparison_table, test_on_line
from thermobearing.cyclic.history import Segment, build_segments
from thermobearing.cyclic.protocol import PlanePath
from thermobearing.cyclic.result import Result
from thermobearing.loading import load_result
from thermobearing.quantities.register import registered_quantities
from thermobearing.report.content import LINE

test_on_line.__test__ = False  # type: ignore[attr-defined]  # a function of the package
RUBBER = 30.0  # total rubber thickness of the specimen [mm]
HDR = "shen-hdr-specimen"
SHAPES = ("circle", "ellipse", "eight", "square", "spiral", "cruciform")


def turns(path: str, **changes: Any) -> dict[str, Any]:
    return {"step": "path", "path": path, "strain": 1.0, "period": 4.0, "count": 2, **changes}


def built(*steps: dict[str, Any], dt: float = 0.02) -> list[Segment]:
    return build_segments(tb.CyclicTest(dt=dt, steps=list(steps)), RUBBER)


def refusal(*steps: dict[str, Any], **changes: Any) -> str:
    try:
        test = tb.CyclicTest(dt=0.02, steps=list(steps))
        make_case({}, "case", bearing=HDR, test=test, ambient=[23.0], **changes)
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("path", SHAPES)
def test_paths_begin_and_end_at_the_origin(path: str) -> None:
    segments = built(turns(path))
    (loading,) = (part for part in segments if part.kind == "path")
    assert {part.x.shape[1] for part in segments} == {2}
    assert_array_equal(segments[-1].x[-1], [0.0, 0.0])
    assert_allclose(loading.dt.sum(), 8.0, rtol=tol.ROUNDING)
    assert_array_equal(np.unique(loading.cycle), [1, 2])
    jumps = np.hypot(
        *np.diff(np.concatenate([np.zeros((1, 2)), *(s.x for s in segments)]), axis=0).T
    )
    assert jumps.max() < 0.1 * RUBBER  # without a gap between ramps and turns
    assert_allclose(np.abs(loading.x[:, 0]).max(), RUBBER, rtol=tol.ROUNDING)
    across = {"ellipse": 0.5, "eight": 0.5, "spiral": 0.875}.get(path, 1.0)
    assert_allclose(np.abs(loading.x[:, 1]).max(), across * RUBBER, rtol=2e-2)
    assert max(part.dt.max() for part in segments) <= 0.02 * (1.0 + tol.ROUNDING)


def test_radii_of_circle_and_spiral() -> None:
    circle = np.hypot(*built(turns("circle"))[1].x.T)
    assert_allclose(circle, RUBBER, rtol=tol.ROUNDING)
    spiral = np.hypot(*built(turns("spiral"))[0].x.T)
    assert_allclose(spiral, RUBBER * np.arange(1, len(spiral) + 1) / len(spiral), rtol=tol.ROUNDING)


@pytest.mark.parametrize(
    ("path", "length"), [("circle", 2.0 * math.pi), ("square", 8.0), ("cruciform", 8.0)]
)
def test_speed_is_the_mean_one(path: str, length: float) -> None:
    step = PlanePath(path=path, amplitude=10.0, speed=5.0)
    assert_allclose(step.turn_duration(RUBBER), 10.0 * length / 5.0, rtol=1e-6)


def test_ratio_is_the_amplitude_across() -> None:
    x = built(turns("ellipse", ratio=0.3))[1].x
    assert_allclose(np.abs(x).max(axis=0), [RUBBER, 0.3 * RUBBER], rtol=tol.ROUNDING)


def test_steps_of_a_line_move_along_x_in_a_plane() -> None:
    cycles = {"step": "cycles", "strain": 0.5, "period": 1.0, "count": 1}
    ramp = {"step": "ramp", "to": 5.0, "duration": 1.0}
    rest = {"step": "rest", "duration": 1.0}
    mixed, line = built(turns("circle"), cycles, ramp, rest)[3:], built(cycles, ramp, rest)
    for one, other in zip(mixed, line, strict=True):
        assert_array_equal(one.x[:, 0], other.x)
        assert not one.x[:, 1].any()


@pytest.mark.parametrize(
    ("step", "words"),
    [
        (turns("circle", ratio=0.5), ["ratio"]),
        (turns("oval"), ["path"]),
        (turns("ellipse", ratio=2.0), ["ratio"]),
        ({"step": "path", "path": "circle", "strain": 1.0}, ["speed", "period", "frequency"]),
        (turns("square", strain=4.0), ["169.7", "unit"]),
        (
            {"step": "recorded", "time_s": [0, 1], "displacement_mm": [0, 1],
             "displacement_y_mm": [0, 1, 2]},
            ["2", "3", "(y)"],
        ),
        (
            {"step": "recorded", "time_s": [0, 1], "displacement_mm": [0, 1], "column_y": "y"},
            ["column_y", "displacement_y_mm"],
        ),
        (
            {"step": "recorded", "time_s": [0, 1], "displacement_mm": [0, 1],
             "displacement_y_mm": [7, 8]},
            ["(0, 7)", "(0, 0)"],
        ),
    ],
)  # fmt: skip
def test_faults_of_paths_name_what_is_wrong(step: dict[str, Any], words: list[str]) -> None:
    message = refusal(step)
    assert all(word in message for word in words), message


@pytest.mark.parametrize(
    ("option", "value"),
    [("integrator", "euler"), ("small_loops", "closed"), ("hardening", "monotone")],
)
def test_options_of_a_line_are_refused_by_name(option: str, value: str) -> None:
    message = refusal(turns("circle"), **{option: value})
    assert f"analysis.{option} = {value}" in message
    case = make_case({}, "line", bearing=HDR, ambient=[23.0], **{option: value})
    assert getattr(case.analysis, option) == value


def test_ratio_needs_a_path() -> None:
    with pytest.raises(InputError):
        tb.cyclic_test(strain=[1.0], ratio=0.5)


def test_recorded_columns_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "orbit.csv").write_text("t [s];ux [mm];uy [cm]\n0;0;0\n1;3;0,2\n2;0;0\n")
    text = 'bearing = "shen-hdr-specimen"\nambient = ["23 degC"]\n[test]\n[[test.steps]]\n'
    text += 'step = "recorded"\nfile = "orbit.csv"\ncolumn_y = "{}"\n'
    for title in ("uy [cm]", "uz [cm]"):
        (tmp_path / f"{title[:2]}.toml").write_text(text.format(title))
    case = load_case(tmp_path / "uy.toml")
    (segment,) = build_segments(case.test, RUBBER)
    assert_allclose(np.abs(segment.x).max(axis=0), [3.0, 2.0], rtol=tol.ROUNDING)
    assert_refused(lambda: load_case(tmp_path / "uz.toml"), "uz [cm]", "uy [cm]")


def run_turns(path: str, *, ambient: Any = 23.0, **changes: Any) -> Result:
    test = tb.CyclicTest(dt=0.02, steps=[turns(path, **{"count": 1, **changes})])
    return tb.run(HDR, test, ambient, keep=["rubber", "cells", "layer_displacement"])


@pytest.fixture(scope="module")
def circle() -> Result:
    return run_turns("circle", ambient=[-20.0, 23.0])


def test_dataset_has_components(circle: Result) -> None:
    data = circle.dataset
    for name in ("displacement", "force", "strain", "stress"):
        assert data[name].dims == ("ambient", "time", "component")
    assert data["layer_displacement"].dims == ("ambient", "time", "layer", "component")
    assert data["component"].values.tolist() == ["x", "y"]
    for name in ("work_in", "heat_released", "rubber_temperature", "temperature"):
        assert "component" not in data[name].dims
    assert (circle.energy[["mechanical_residual", "thermal_residual"]].abs() < 1e-10).all(axis=None)


def test_measures_of_turns(circle: Result) -> None:
    known = registered_quantities()
    assert all(name in known for name in circle.cycles if not name.startswith("rubber"))
    assert len(circle.cycles) == 2
    data, row = circle.dataset.isel(ambient=1), circle.cycles.iloc[1]
    turn = data["cycle"].values == 1
    first = int(np.flatnonzero(turn)[0]) - 1
    x, f = (data[name].values[first:][: turn.sum() + 1] for name in ("displacement", "force"))
    work = float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(x, axis=0)))
    assert_allclose(row["energy_kN_mm"], work, rtol=1e-9)
    assert_allclose(row["energy_x_kN_mm"] + row["energy_y_kN_mm"], work, rtol=1e-9)
    assert row["peak_force_kN"] == np.hypot(*f.T).max()
    corner = run_turns("square").cycles.iloc[0]
    assert corner["peak_force_kN"] > 1.1 * max(corner["peak_force_x_kN"], corner["peak_force_y_kN"])
    stiffness = float(np.mean(np.sum(f * x, axis=1))) / RUBBER**2
    assert_allclose(row["K_eq_kN_mm"], stiffness, rtol=1e-9)
    assert_allclose(row["h_eq"], work / (2.0 * np.pi * stiffness * RUBBER**2), rtol=1e-9)


def test_cycles_in_a_plane_have_the_measures_of_the_line() -> None:
    cycles = {"step": "cycles", "strain": 1.0, "period": 4.0, "count": 1}
    line, plane = (
        tb.run(HDR, tb.CyclicTest(dt=0.02, steps=[cycles, *more]), 23.0).cycles.iloc[0]
        for more in ([], [turns("circle", count=1)])
    )
    for name in ("G_eq_MPa", "K_eq_kN_mm", "h_eq", "energy_kN_mm", "stress_max_MPa"):
        assert_allclose(plane[name], line[name], rtol=1e-9, err_msg=name)
    assert plane["energy_y_kN_mm"] == 0.0


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ("--path circle", "--strain"),
        ("--path circle --strain 1 --wave sine", "--wave"),
        ("--path circle --strain 1 --ratio 0.5", "--ratio"),
        (
            "--path circle --strain 1 --model-option small_loops=closed",
            "--model-option small_loops",
        ),
        ("--ratio 0.5 --strain 1", "path"),
    ],
)
def test_faults_of_a_path_on_the_command_line(words: str, named: str, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["cyclic", *words.split(), "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert named in done.output
    assert not (tmp_path / "out").exists()


def test_turns_cut_off_are_not_measured(circle: Result) -> None:
    data = circle.dataset.isel(time=slice(0, 150)).copy()
    data["outcome"] = data["outcome"].astype(object)
    data["outcome"][:] = "too_hot"
    assert len(Result(data).cycles) == 0


def test_results_in_a_plane_are_saved_and_loaded(circle: Result, tmp_path: Path) -> None:
    circle.save(tmp_path / "out")
    loaded = load_result(tmp_path / "out")
    assert isinstance(loaded, Result)
    assert loaded.in_plane
    assert_allclose(loaded.cycles.to_numpy(float), circle.cycles.to_numpy(float), rtol=tol.ROUNDING)
    head = (tmp_path / "out" / "history.csv").read_text().splitlines()[0].split(",")
    assert {"displacement_x_mm", "displacement_y_mm", "force_x_kN", "force_y_kN"} <= set(head)
    assert len(circle.to_dataset()["energy_y_kN_mm"]) == 2
    again = load_case(tmp_path / "out" / "case.resolved.toml")
    assert again.test.in_plane


@pytest.mark.thorough
def test_reports_of_tests_in_a_plane(circle: Result, tmp_path: Path) -> None:
    line = tb.run(HDR, test_on_line(tb.CyclicTest(dt=0.02, steps=[turns("circle")]), RUBBER), 23.0)
    result = Result(circle.sel(ambient=23.0).dataset)
    result.compared = {"plane": result, "line": line}
    result.save(tmp_path / "out")
    (file, *_) = result.report(tmp_path / "out", pdf=False)
    text = file.read_text(encoding="utf-8")
    assert "1 turn" in text
    assert re.findall("<option[^>]*>([^<]*)", text)[:2] == ["displacement", "force"]
    assert LINE in text
    assert "Shear acts in one direction" not in text


def test_figures_in_a_plane(circle: Result) -> None:
    drawn = circle.plot.draw_all()
    assert "orbit" in drawn
    assert not {"loops", "force_shares", "layer_shear"} & set(drawn)
    way, force = circle.plot.orbit().axes
    reach = max(float(np.nanmax(np.abs(line.get_ydata()))) for line in way.lines)
    assert_allclose(reach, RUBBER, rtol=1e-2)
    reach = max(float(np.nanmax(np.abs(line.get_ydata()))) for line in force.lines)
    assert_allclose(reach, np.abs(circle["force"].values[..., 1]).max(), rtol=1e-2)
    assert len(circle.plot.displacement().axes[0].lines) >= 2


def test_circle_warms_more_than_a_line(circle: Result) -> None:
    test = tb.CyclicTest(dt=0.02, steps=[turns("circle", count=1)])
    on_line = test_on_line(test, RUBBER)
    assert not on_line.in_plane
    assert on_line.steps[0].model_dump()["period"] == 4.0
    line = tb.run(HDR, on_line, [-20.0, 23.0])
    table = comparison_table({"plane": circle, "line": line})
    assert len(table) == 4
    assert (table["rise_ratio"] > 1.3).all()
    circle.compared = {"plane": circle, "line": line}
    try:
        assert "line" in circle.tables()
        assert len(circle.plot.comparison().axes) >= 2
    finally:
        del circle.compared


def test_measured_path_of_gallardo() -> None:
    """A closed orbit of an HDR bearing of 650 mm, at the strains of the specimen."""
    x, y, _ = np.loadtxt(shared_data("bearing_tests/gallardo_biaxial/Fig10.txt"))[::10].T
    scale = RUBBER / 204.0
    x, y = scale * (x - x[0]), scale * (y - y[0])
    result = tb.run(HDR, (0.1 * np.arange(len(x)), x, y), 23.0, dt=0.1)
    assert result.outcome == "completed"
    assert (result.energy["mechanical_residual"].abs() < 1e-10).all()
    assert float(result.magnitude("strain").max()) == pytest.approx(np.hypot(x, y).max() / RUBBER)
