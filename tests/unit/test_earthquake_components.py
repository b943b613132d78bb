"""Earthquake analyses of structures in plan: one and two components of the ground motion."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.unit import inputs
from thermobearing.border.errors import InputError
from thermobearing.border.schema import validated
from thermobearing.border.toml import sourced_toml
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.tables import RULE
from thermobearing.structure.model import Structure

PAIR = {"name": "jra-ii-i-1", "across": "jra-ii-i-2", "angle": "20 deg"}
HINGE = {"yield_moment": "20 MN m", "yield_rotation": "0.002 rad", "hardening_ratio": 0.01}


def two_piers(**line: Any) -> Structure:
    """A deck that may twist on two piers with hinges, the same along and across."""
    piers = {"pier 1": "-20 m", "pier 2": "20 m"}
    table: dict[str, Any] = {
        "name": "two piers in plan",
        "plan": True,
        "bodies": [
            *({"name": n, "on": "ground", "rotates": True, "x": x} for n, x in piers.items()),
            {"name": "deck", "base_height": "10 m", "moves": True, "twists": True},
        ],
        "masses": [
            *(
                {"body": n, "height": "10 m", "mass": "200 t", "rotary_inertia": "1e3 kN mm s^2"}
                for n in piers
            ),
            {"body": "deck", "height": "10 m", "mass": "1200 t", "twist_inertia": "1e8 kN mm s^2"},
        ],
        "hinges": [{"name": f"base of {n}", "body": n, **HINGE} for n in piers],
        "bearings": [
            {
                **{"name": f"on {n}", "body": "deck", "base": n, "height": "10 m", "count": 6},
                **{"equivalent_stiffness": "8 kN/mm", **line},
            }
            for n in piers
        ],
        "report": {"deck": "deck", "pier": "pier 1", "pier_top": "10 m"},
    }
    return validated(Structure, table, "test")


def shaken(motion: Any = "jra-ii-i-1", **options: Any) -> EarthquakeResult:
    given = {"structure": two_piers(), "duration": 6.0} | options
    return tb.bridge("shen-lhdr-bridge", motion, 23, **given)


@pytest.fixture(scope="module")
def compared() -> EarthquakeResult:
    return shaken(PAIR, components=[1, 2])


def test_motion_along_the_bridge_alone_is_the_one_directional_analysis() -> None:
    """All that a structure in plan gives along x, bit for bit up to rounding of sums."""
    both, one = shaken(), shaken(components=1)
    assert one.run_names == ["shen-lhdr-bridge, jra-ii-i-1, 23 degC, x"]
    x, alone = both.sel(direction="x").dataset, one.sel(direction="x").dataset
    for name, expected in alone.data_vars.items():
        if expected.dtype.kind == "f":
            size = float(np.nanmax(np.abs(expected.values), initial=1e-3))
            error = np.abs(x[name].values - expected.values)
            assert np.nanmax(error, initial=0.0) <= tol.PLANE_TURNED * size, name
    across = both.sel(direction="y").table
    assert across["bearing_strain_max"].item() == across["pier_ductility"].item() == 0.0


def test_motion_at_45_degrees_is_the_same_in_both_directions() -> None:
    result = shaken({"name": "jra-ii-i-1", "angle": "45 deg"}, components=2)
    x, y, resultant = (result.sel(direction=way).table for way in ("x", "y", "resultant"))
    for name in ("bearing_strain_max", "bearing_force_max_kN", "pier_displacement_max_mm"):
        assert_allclose(x[name], y[name], rtol=tol.PLANE_TURNED)
        assert_allclose(resultant[name], np.sqrt(2.0) * x[name], rtol=tol.PLANE_TURNED)
    assert_allclose(resultant["pier_ductility"], x["pier_ductility"], rtol=tol.PLANE_TURNED)


def test_vectors_have_directions_and_the_resultant(compared: EarthquakeResult) -> None:
    data = compared.dataset
    assert data["direction"].values.tolist() == ["x", "y", "resultant"]
    moved = data["line_displacement"].values.astype(float)
    assert data["line_displacement"].dims == ("run", "step", "line", "direction")
    assert_allclose(np.hypot(moved[..., 0], moved[..., 1]), moved[..., 2], rtol=1e-5, atol=1e-6)
    rubber = tb.load_bearing("shen-lhdr-bridge").total_rubber_thickness
    every = compared.by_direction("lines").set_index(["direction", "line"])["strain_max"]
    for place, line in enumerate(data["line"].values):
        for k, way in enumerate(data["direction"].values):
            largest = np.abs(moved[0, :, place, k]).max() / rubber  # of every second step
            assert every[way, line] == pytest.approx(largest, rel=1e-3)
    assert compared.table["bearing_strain_max"].item() == every.max()
    ductility = compared.by_direction("piers").groupby("direction")["ductility"].max()
    assert ductility["resultant"] == max(ductility["x"], ductility["y"])
    assert data["heat_work_in"].dims == ("run",)
    assert abs(compared.energy["structure_residual"].item()) < tol.PLANE_TURNED
    assert abs(compared.energy["mechanical_residual"].item()) < tol.PLANE_TURNED


def test_two_components_are_compared_with_one(compared: EarthquakeResult) -> None:
    one = compared.one_component
    assert one is not None
    assert one.directions == ["x", "y"]
    frame = compared.components.set_index(["quantity", "combination"])
    x, y = (one.sel(direction=way).table["bearing_strain_max"].item() for way in ("x", "y"))
    strain = frame.loc["bearing_strain_max", "one_component"]
    assert strain["srss"] == pytest.approx(np.hypot(x, y))
    assert strain["rule"] == pytest.approx(np.hypot(max(x, y), RULE * min(x, y)))
    assert strain["larger"] == max(x, y)
    resultant = compared.table["bearing_strain_max"].item()
    ratio = frame.loc[("bearing_strain_max", "srss"), "two_over_one"]
    assert ratio == pytest.approx(resultant / np.hypot(x, y))
    assert frame.loc[("lead_rise_K", "larger"), "two_over_one"] > 1.0
    assert "srss" not in frame.loc["pier_ductility"].index
    assert "mean" not in compared.tables()["components"].caption  # of one motion


@pytest.mark.thorough
def test_results_in_plan_are_saved_and_loaded(compared: EarthquakeResult, tmp_path: Path) -> None:
    saved = compared.save(tmp_path / "out", figures=False)
    names = {path.name for path in saved.iterdir()}
    assert {"directions.csv", "components.csv", "lines.csv", "piers.csv"} <= names
    loaded = tb.load_result(saved)
    assert isinstance(loaded, EarthquakeResult)
    assert loaded.in_plan
    assert loaded.by_direction().equals(compared.by_direction())
    assert loaded.components.equals(compared.components)
    history = loaded.history(0)
    columns = {"time_s", "displacement_x_mm", "force_y_kN", "pier_moment_x_kN_m", "energy_kN_mm"}
    assert columns <= set(history)
    assert set(loaded.plot.draw_all()) >= {"orbit", "components", "peaks", "loops_x", "hinge_y"}
    assert set(loaded.tables()) >= {"directions", "components", "loops"}


def test_lines_in_plan_have_their_own_temperatures() -> None:
    sun = [{"line": "on pier 2", "ambient": "40 degC"}]
    result = shaken(PAIR, lines=sun, duration=3.0).lines.set_index("line")
    assert result["line_ambient_degC"].to_dict() == {"on pier 1": 23.0, "on pier 2": 40.0}
    assert result["force_max_kN"]["on pier 2"] < result["force_max_kN"]["on pier 1"]


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"structure": "pier-p1"}, "components"),
        ({"method": "predictor-corrector"}, "predictor-corrector"),
        ({"small_loops": "closed"}, "small_loops"),
        ({"components": 3}, "components"),
    ],
)
def test_what_does_not_go_with_two_components(change: dict[str, Any], key: str) -> None:
    table = {"structure": two_piers(), "motions": PAIR, "components": 2} | change
    with pytest.raises(InputError, match=key):
        make_earthquake_case({"command": "bridge"}, "test", **table)


def test_each_direction_alone_has_its_periods() -> None:
    """The arm of the bearings across the bridge makes the pier softer there."""
    result = shaken(PAIR, structure=two_piers(height_across="14 m"), components=1, duration=0.5)
    x, y = (result.sel(direction=way).dataset.attrs["periods_s"] for way in ("x", "y"))
    assert result.dataset.attrs["periods_s"] == x
    assert y[0] > 1.01 * x[0]


def test_hinges_have_no_resultant(compared: EarthquakeResult) -> None:
    with pytest.raises(InputError, match="direction"):
        compared.plot.hinge()


@pytest.mark.parametrize("components", [0, 2.5, "both", [1, 3], ["x"]])
def test_bad_numbers_of_components(components: Any) -> None:
    with pytest.raises(InputError, match="components"):
        shaken(PAIR, components=components)


def test_without_a_pair_there_is_nothing_to_compare() -> None:
    with pytest.raises(InputError, match="pairs"):
        shaken(components=[1, 2])


@pytest.mark.thorough
def test_components_on_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "plan.toml"
    file.write_text(sourced_toml(two_piers(), {}))
    words = "--bearing shen-hdr-bridge --motion jra-ii-i-1 --across jra-ii-i-2 --ambient 23"
    words += " --duration 2 --no-figures --components 1 --components 2 -o"
    done = inputs.command("bridge", "--structure", file, *words.split(), tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "out" / "components.csv").exists()


@pytest.mark.thorough
def test_a_deck_on_the_ground_has_no_pier(tmp_path: Path) -> None:
    """Neither tables nor figures show a pier, and the title has no empty description."""
    line = {"body": "deck", "height": "1 m", "count": 3, "equivalent_stiffness": "4 kN/mm"}
    mass = {"body": "deck", "height": "2 m", "mass": "600 t", "twist_inertia": "1e8 kN mm s^2"}
    table = {
        "name": "low deck",
        "plan": True,
        "bodies": [{"name": "deck", "moves": True, "twists": True}],
        "masses": [mass],
        "bearings": [{"name": "W", "x": "-9 m"} | line, {"name": "E", "x": "9 m"} | line],
        "report": {"deck": "deck"},
    }
    result = shaken(PAIR, structure=validated(Structure, table, "test"), components=2, duration=1)
    assert not len(result.piers)
    assert not [one for one in result.table if one.endswith("_pier")]
    assert result.table.filter(regex="^pier_").isna().all(axis=None)
    assert not [
        text for one in result.tables().values() for text in one.texts() if "ground" in text
    ]
    figures = result.plot.draw_all()
    assert not [name for name in figures if name.startswith("pier")]
    assert [ax.get_ylabel() for ax in figures["parts"]().axes if ax.get_visible()] == [
        "bearing strain [%]",
        "force of the line [kN]",
    ]
    for name in ("temperature", "loops_x"):
        assert "(line W)" in figures[name]().get_suptitle()
    assert figures["temperature"]().get_suptitle().startswith("low deck")
