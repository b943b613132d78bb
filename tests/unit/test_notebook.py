"""Results in the idiom of notebooks: short words, tables, labels as dimensions, pictures."""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_array_equal

import thermobearing as tb
from tests.unit.inputs import assert_refused
from thermobearing.design.run import run_bounds, run_factors
from thermobearing.motions.run import examine_motion
from thermobearing.results.profiles import overlay
from thermobearing.results.saved import SavedResult

SHORT = 300  # letters
NAMES = ["shen-lhdr-bridge", "shen-hdr-bridge"]


@pytest.fixture(scope="module")
def result() -> tb.Result:
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=None, dt=0.02)
    return tb.run("shen-lhdr-specimen", test, ambient=[-20.0, 23.0])


@pytest.fixture(scope="module")
def study() -> tb.EarthquakeResult:
    motions = ["jra-ii-i-1", "jra-i-i-1"]
    return tb.bridge(NAMES, motions, [23, -20], duration=2, rig="shen-rig")


@pytest.fixture(scope="module")
def fit() -> Any:
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, dt=0.02)
    record = tb.synthetic_record("shen-hdr-specimen", 23.0, test)
    return tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)


def test_words_are_short_and_html_holds_the_numbers(
    result: tb.Result, study: tb.EarthquakeResult, fit: Any
) -> None:
    bearing = tb.load_bearing("shen-lhdr-specimen")
    validation = tb.validate_bearing("shen-hdr-specimen", fit.records)
    for item, held in (
        (bearing, "mm2"),
        (result, "G_eq_MPa"),
        (study, "bearing_strain_max"),
        (fit, "K_r"),
        (validation, "K_eq_error"),
    ):
        assert len(repr(item)) < SHORT
        assert repr(item).startswith("<")
        html = item._repr_html_()
        assert held in html
        assert "<table" in html
        assert len(html) < 40_000
    assert "lead" in bearing._repr_html_()
    assert "lead" not in tb.load_bearing("shen-hdr-specimen")._repr_html_().split("citation")[0]


def test_show_prints_what_the_command_prints(
    result: tb.Result, study: tb.EarthquakeResult, fit: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    for item, words in ((result, "G_e"), (study, "ductility"), (fit, "Standard error")):
        item.show()
        assert words in capsys.readouterr().out


def test_some_runs_of_a_study(study: tb.EarthquakeResult) -> None:
    one = study.sel(bearing=NAMES[1], motion="jra-i-i-1", ambient=-20)
    number = next(
        k
        for k, row in enumerate(study.table.to_dict("records"))
        if (row["bearing"], row["motion"], row["ambient_degC"]) == (NAMES[1], "jra-i-i-1", -20)
    )
    assert one.runs == 1
    assert_array_equal(one["bearing_force"].values[0], study["bearing_force"].values[number])
    each = len(study.rig) // study.runs
    mine = study.rig.iloc[number * each : (number + 1) * each].reset_index(drop=True)
    pd.testing.assert_frame_equal(one.rig, mine)
    assert study.sel(ambient=[23, -20]).runs == study.runs
    assert study.sel(bearing=NAMES[0]).runs == study.runs // 2


def test_labels_become_dimensions_in_their_order(study: tb.EarthquakeResult) -> None:
    grid = study.to_dataset()
    assert list(grid["bearing"].values) == NAMES
    assert list(grid["ambient"].values) == [23.0, -20.0]
    assert grid["ambient"].attrs["units"] == "degC"
    assert grid["bearing_force"].dims[:3] == ("bearing", "motion", "ambient")
    for row in study.table.to_dict("records"):
        there = grid["bearing_force_max"].sel(
            bearing=row["bearing"], motion=row["motion"], ambient=row["ambient_degC"]
        )
        assert float(there) == row["bearing_force_max_kN"]
        assert there.attrs["units"] == "kN"


def test_a_grid_with_a_hole(study: tb.EarthquakeResult) -> None:
    data = study.dataset.isel(run=slice(1, None))
    grid = tb.EarthquakeResult(data).to_dataset()["bearing_force_max"]
    assert int(np.isnan(grid).sum()) == 1


def test_measures_have_labels(result: tb.Result) -> None:
    measures = result.to_dataset()
    for row in result.cycles.to_dict("records"):
        there = measures.sel(
            ambient=row["ambient_degC"], strain=row["amplitude_strain"], cycle=row["cycle"]
        )
        assert float(there["h_eq"]) == row["h_eq"]
        assert float(there["lead_degC"]) == row["lead_degC"]
    assert measures["post_yield_stiffness_kN_mm"].attrs["units"] == "kN/mm"
    cold = result.sel(ambient=-20)
    assert_array_equal(cold["force"].values[0], result["force"].values[0])
    assert len(cold.cycles) == len(result.cycles) / 2


@pytest.mark.parametrize(
    ("strain", "sizes"),
    [
        ([1.0], {"ambient": 1, "strain": 1, "cycle": 2}),
        ([0.5, 1.0], {"ambient": 1, "strain": 2, "cycle": 2}),
        ([0.5, 0.5], {"ambient": 1, "number": 4}),  # a strain that comes twice
    ],
)
def test_dimensions_of_measures(strain: list[float], sizes: dict[str, int]) -> None:
    test = tb.cyclic_test(strain=strain, cycles=2, rest=None, dt=0.02)
    assert dict(tb.run("shen-hdr-specimen", test).to_dataset().sizes) == sizes


def test_cycles_of_a_history_are_numbered() -> None:
    time = np.arange(0.0, 8.0, 0.02)
    wave = 20.0 * np.sin(np.pi * time / 2.0)
    actual = tb.run("shen-hdr-specimen", (time, wave), ambient=[-20, 23]).to_dataset()
    assert set(actual.sizes) == {"ambient", "number"}


def test_selection_of_a_thinned_result(result: tb.Result, tmp_path: Path) -> None:
    loaded = tb.load_result(result.save(tmp_path / "out", figures=False))
    assert isinstance(loaded, tb.Result)
    assert list(loaded.sel(ambient=23).cycles["ambient_degC"]) == [23.0] * 4


def test_sweeps(study: tb.EarthquakeResult) -> None:
    actual = tb.sweep(NAMES, motion=["jra-ii-i-1", "jra-i-i-1"], ambient=[23, -20], duration=2)
    same = study.to_dataset()["bearing_strain_max"]
    assert_array_equal(actual["bearing_strain_max"].values, same.values)
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.02)
    measured = tb.sweep(["shen-lhdr-specimen", "shen-hdr-bridge"], test=test, ambient=[23, -20])
    assert dict(measured.sizes) == {"bearing": 2, "ambient": 2, "strain": 1, "cycle": 1}
    lead = measured["lead_degC"].sel(bearing="shen-hdr-bridge")
    assert np.isnan(lead).all()
    assert np.isfinite(measured["G_eq_MPa"]).all()


def test_bad_labels(study: tb.EarthquakeResult, result: tb.Result) -> None:
    assert_refused(lambda: study.sel(bering="x"), 'no label "bering"', "bearing")
    assert_refused(lambda: study.sel(ambient=5), "no run with ambient = 5", "23.0, -20.0")
    assert_refused(lambda: study.sel(ambient="cold"), "no run with ambient = 'cold'")
    assert_refused(lambda: result.sel(ambient=5), "no run with ambient = 5")
    assert_refused(
        lambda: tb.sweep(NAMES, test=tb.cyclic_test(), motion="jra-ii-i-1"), "test or a motion"
    )
    assert_refused(lambda: tb.sweep([NAMES[0], NAMES[0]]), "unique")
    assert_refused(lambda: tb.element("shen-hdr-bridge", ambinet=-20), 'unknown key "ambinet"')


def test_a_notebook_gets_a_picture(result: tb.Result) -> None:
    figure: Any = result.plot.loops()
    assert isinstance(figure, Figure)
    assert figure._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize("kind", ["result", "study", "fit"])
def test_loops_go_into_a_panel_of_somebody_else(kind: str, request: pytest.FixtureRequest) -> None:
    item = request.getfixturevalue(kind)
    own = Figure()
    ax = own.subplots()
    given = item.plot.loops(ax=ax, label="mine", color="#123456")
    assert given is own
    lines = [line for line in ax.get_lines() if line.get_label() == "mine"]
    assert len(lines) == 1
    assert matplotlib.colors.to_hex(lines[0].get_color()) == "#123456"
    assert ax.get_xlabel()


def test_panels_of_a_study_take_an_ax(study: tb.EarthquakeResult) -> None:
    for name in ("strain", "pier", "pier_acceleration", "hinge", "deck", "energy"):
        ax = Figure().subplots()
        getattr(study.plot, name)(ax=ax)
        assert len(ax.get_lines()) == study.runs


def test_overlay(result: tb.Result, study: Any, fit: Any) -> None:
    both = overlay({"cold": result.sel(ambient=-20), "warm": result.sel(ambient=23)})
    (ax,) = both.axes
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["cold", "warm"]
    assert len({line.get_color() for line in ax.get_lines()}) == 2
    assert overlay({"a": fit, "b": fit}).axes
    assert_refused(lambda: overlay({"a": result, "b": study}), '"b" has loops of force')
    assert_refused(lambda: overlay({}), "no results")


def test_every_kind_of_result_is_read_again(
    result: tb.Result, study: Any, fit: Any, tmp_path: Path
) -> None:
    reports = {
        "identify": fit,
        "validate": tb.validate_bearing("shen-hdr-specimen", fit.records),
        "lambda": run_factors(["shen-hdr-bridge"], temperatures=[-20.0], strains=[1.0]),
        "motions show": examine_motion(tb.load_motion("jra-ii-i-1")),
        "bounds": run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0]),
    }
    for command, report in reports.items():
        folder = report.save(tmp_path / command.split()[0], figures=False)
        actual = tb.load_result(folder)
        assert isinstance(actual, SavedResult)
        assert actual.command == command
        assert actual.outcome == report.outcome if hasattr(report, "outcome") else "completed"
        assert actual.tables
        assert len(repr(actual)) < SHORT
        assert "<table" in actual._repr_html_()
    fitted = tb.load_result(tmp_path / "identify")
    assert isinstance(fitted, SavedResult)
    (bearing,) = fitted.bearings.values()
    assert bearing.hysteresis == fit.bearing.hysteresis
    assert len(fitted["fit"]) == sum(len(r.time) for r in fit.records)
    assert_refused(lambda: fitted["nonsense"], 'no table "nonsense"', "fit")
    for item, kind in ((result, tb.Result), (study, tb.EarthquakeResult)):
        folder = item.save(tmp_path / kind.__name__, figures=False)
        assert isinstance(tb.load_result(folder), kind)
        (folder / "result.nc").unlink()
        assert_refused(lambda folder=folder: tb.load_result(folder), "no result.nc there")


@pytest.mark.parametrize("text", ["", "{", "[]", '{"outcome": "completed"}', "[" * 5000])
def test_a_summary_that_is_none(text: str, tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text(text)
    assert_refused(lambda: tb.load_result(tmp_path), str(tmp_path))


def test_every_number_of_a_study_says_what_it_is() -> None:
    study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23], duration=2)
    data = study.to_dataset()
    mute = [name for name in data.data_vars if not data[name].attrs.get("long_name")]
    assert not mute
    assert data.bearing_force_max.attrs["long_name"] == "largest force of one bearing"
    assert data.ambient.attrs["long_name"] == "ambient temperature"
    assert "float64" not in str(data.attrs["periods_s"])


def test_a_motion_is_short_in_a_notebook() -> None:
    output = repr(tb.load_motion("jra-ii-i-1"))
    assert output == "<GroundMotion jra-ii-i-1: 647 gal, 50 s in steps of 0.01 s>"
