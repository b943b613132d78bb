"""Accelerations, shares and largest loops of earthquake studies against what must hold."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.model.options import build_model
from thermobearing.results.metrics import largest_loop
from thermobearing.structure.matrices import mean_height
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure, run_structure

EVERY = tb.Keep(every=1)
SHORT: dict[str, Any] = {"duration": 6.0, "keep": EVERY}


@pytest.fixture(scope="module")
def study() -> Any:
    return tb.bridge(["shen-lhdr-bridge", "shen-bilinear-bridge"], "jra-ii-i-1", -20, **SHORT)


def test_forces_on_all_masses_are_those_of_the_ground() -> None:
    """Newton's law of the whole hybrid pier: inertia of both masses, and the pier's spring."""
    lab = {"duration": 4.0, "damping": "none", "method": "average-acceleration", "keep": EVERY}
    data = tb.hybrid("shen-lhdr-specimen", "jra-ii-ii-1", 0, **lab).dataset.isel(run=0)
    masses = np.array([10.156, 3.385])  # kN s2/mm, Table 3.5
    inertia = 1e3 * data["body_acceleration"].values @ masses
    spring = 400.0 * data["pier_displacement"].values
    assert list(data["body"].values) == ["deck", "pier"]
    largest = np.abs(spring).max()
    assert_allclose(inertia + spring, 0.0, atol=tol.HISTORY_DIGITS * largest)
    for body, name in ((0, "deck_acceleration"), (1, "pier_top_acceleration")):
        assert_allclose(data["body_acceleration"].values[:, body], data[name].values, rtol=1e-6)


def test_acceleration_is_the_second_difference_of_displacement(study: Any) -> None:
    """Absolute less ground is what moves the pier top and the deck relative to the ground."""
    data = study.dataset.isel(run=0)
    dt = float(np.diff(data["time"].values[:2])[0])
    ground = data["ground_acceleration"].values
    for place in ("deck", "pier_top"):
        q = data[f"{place}_displacement"].values.astype(float)
        bent = np.diff(q, 2) / dt**2 / 1e3
        a = (data[f"{place}_acceleration"].values - ground).astype(float)
        mean = 0.25 * (a[:-2] + 2.0 * a[1:-1] + a[2:])  # of constant mean acceleration
        assert_allclose(bent, mean, atol=tol.SECOND_DIFFERENCE * np.abs(a).max())
    relative = study.history(0)["deck_relative_acceleration_m_s2"]
    assert_allclose(relative, data["deck_acceleration"].values - ground, rtol=1e-6)


def test_masses_of_a_body_are_at_their_mean_height() -> None:
    pier = load_structure("pier-p1")
    assert mean_height(pier, "deck") == 10e3
    assert mean_height(pier.model_copy(update={"masses": []}), "footing") == -2e3


def test_shares_in_the_history_add_up(study: Any) -> None:
    frame = study.history(0)
    parts = frame[["rubber_force_kN", "lead_force_kN", "viscous_force_kN"]].sum(axis=1)
    largest = frame["force_kN"].abs().max()
    assert_allclose(parts, frame["force_kN"], atol=tol.HISTORY_DIGITS * largest)
    assert frame["lead_force_kN"].abs().max() > 0.1 * largest
    for name in ("deck_displacement_mm", "deck_relative_acceleration_m_s2"):
        assert np.isfinite(frame[name]).all()
    assert {"footing_acceleration_m_s2", "deck_acceleration_m_s2"} <= set(frame)


def test_an_elastic_hinge_has_its_stiffness_in_the_history(study: Any) -> None:
    frame, hinge = study.history(0), load_structure("pier-p1").hinges[0]
    rotation, moment = frame["pier_rotation_rad"], frame["pier_moment_kN_m"]
    assert 0.1 * hinge.yield_rotation < rotation.abs().max() < hinge.yield_rotation
    assert_allclose(1e3 * moment, hinge.stiffness * rotation, rtol=tol.HISTORY_DIGITS)


def test_largest_loop_of_a_run_is_that_of_its_history(study: Any) -> None:
    loops = study.largest_loops
    assert list(loops["bearing"]) == ["shen-lhdr-bridge", "shen-bilinear-bridge"]
    frame, row = study.history(0), loops.iloc[0]
    bearing = tb.load_bearing("shen-lhdr-bridge")
    result = largest_loop(
        frame["displacement_mm"].to_numpy(),
        frame["force_kN"].to_numpy(),
        frame["energy_kN_mm"].to_numpy(),
        area=bearing.area,
        total_rubber_thickness=bearing.total_rubber_thickness,
    )
    assert result is not None
    m = result.measures
    pairs = {
        "F_plus_kN": m.force_max_kN,
        "F_minus_kN": m.force_min_kN,
        "D_plus_mm": m.displacement_max_mm,
        "D_minus_mm": m.displacement_min_mm,
        "K_eq_kN_mm": m.stiffness_kN_mm,
        "h_eq": m.h_eq,
        "G_e_MPa": m.G_eq_MPa,
        "energy_kN_mm": m.energy_kN_mm,
        "start_s": frame["time_s"][result.first],
        "end_s": frame["time_s"][result.last],
    }
    for name, value in pairs.items():
        assert row[name] == pytest.approx(value, rel=tol.HISTORY_DIGITS), name
    farthest = frame["displacement_mm"].abs().max()
    assert max(row["D_plus_mm"], -row["D_minus_mm"]) == pytest.approx(farthest)
    assert np.isnan(loops["G_e_MPa"][1])
    assert study.table["loop_K_eq_kN_mm"][1] == loops["K_eq_kN_mm"][1] > 0.0


def test_a_history_without_a_closed_loop_says_so(tmp_path: Path) -> None:
    study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=0.5)
    assert study.largest_loops[["K_eq_kN_mm", "h_eq", "start_s"]].isna().all(axis=None)
    study.save(tmp_path / "short")


@pytest.fixture(scope="module")
def both() -> Any:
    lab = {"mode": ["rt", "pd"]}
    return tb.hybrid("shen-lhdr-specimen", "jra-ii-ii-1", [-20, 0], duration=11, laboratory=lab)


def test_both_modes_are_those_of_two_studies(both: Any) -> None:
    assert both.modes == ["rt", "pd", "rt", "pd"]
    for mode in ("rt", "pd"):
        lab = {"mode": mode}
        alone = tb.hybrid("shen-lhdr-specimen", "jra-ii-ii-1", 0, duration=11, laboratory=lab)
        mine = both.table.query("mode == @mode and ambient_degC == 0").iloc[0]
        for name, value in alone.table.iloc[0].items():
            if name != "energy_of_warmest" and value == value:  # no hinge: no ductility, no moment
                assert mine[name] == value, name
    warmest = both.table.set_index(["mode", "ambient_degC"])["energy_of_warmest"]
    assert warmest["rt", 0.0] == warmest["pd", 0.0] == 1.0


@pytest.mark.thorough
def test_real_time_over_pseudo_dynamic(both: Any, tmp_path: Path) -> None:
    rows, table = both.modes_table, both.table
    assert list(rows["ambient_degC"]) == [-20.0, 0.0]
    first = rows.iloc[0]
    assert (
        first["force_ratio"] == table["bearing_force_max_kN"][0] / table["bearing_force_max_kN"][1]
    )
    assert (
        first["energy_ratio"] == table["bearing_energy_kN_mm"][0] / table["bearing_energy_kN_mm"][1]
    )
    lead = both.dataset["lead_temperature"].values
    assert first["lead_rise_rt_K"] == pytest.approx(float(np.nanmax(lead[0]) - lead[0, 0]))
    assert first["lead_rise_pd_K"] == pytest.approx(float(np.nanmax(lead[1]) - lead[1, 0]))
    assert first["lead_rise_ratio"] > 1.0
    inner = both.dataset["rubber_temperature"].values[1, :, -1]
    assert first["inner_layer_rise_pd_K"] == pytest.approx(float(np.nanmax(inner) - inner[0]))
    folder = both.save(tmp_path / "both")
    assert (folder / "figures" / "modes.png").exists()
    reported = tb.load_result(folder)
    assert reported.modes_table.equals(rows)
    lines = (folder / "history.csv").read_text().splitlines()
    assert lines[0].startswith("bearing,motion,ambient_degC,mode,time_s")


def test_one_mode_makes_no_table_of_ratios() -> None:
    study = tb.hybrid("shen-hdr-specimen", ambient=0, duration=0.5)
    assert study.modes_table.empty


@pytest.mark.parametrize(
    ("mode", "piece"),
    [
        (["rt", "rt"], "laboratory.mode: one is given more than once"),
        (["rt", "slow"], "laboratory.mode[1] = 'slow'"),
    ],
)
def test_bad_modes(mode: Any, piece: str) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.hybrid("shen-hdr-specimen", laboratory={"mode": mode})
    assert piece in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_printed_pseudo_dynamic_column_is_the_same_test() -> None:
    """Table 3.6, pd: lengths s, times s, accelerations 1/s, so masses s^3 and stiffness s.

    The actuator has its own speed, so the specimen feels nothing of the printed clock.
    """
    s, pier = 1.0 / 6.0, load_structure("hybrid-pier")
    small = pier.model_copy(
        update={
            "masses": [m.model_copy(update={"mass": m.mass * s**3}) for m in pier.masses],
            "springs": tuple(
                k.model_copy(update={"stiffness": k.stiffness * s}) for k in pier.springs
            ),
            "bearings": [
                b.model_copy(
                    update={"scale": 1.0, "equivalent_stiffness": b.equivalent_stiffness * s}
                )
                for b in pier.bearings
            ],
        }
    )
    bearing = tb.load_bearing("shen-lhdr-specimen")
    constants = build_model(bearing).constants
    line = Line(constants, np.full(len(constants.cells.capacity), -20.0), speed=10.0)
    motion = tb.load_motion("jra-ii-ii-1")
    ground = np.interp(0.005 * np.arange(2201), motion.time, motion.acceleration)
    air = np.full(2200, -20.0)
    forces = [
        run_structure(
            prepare_structure(one), [line], ground * f, 0.005 / f, air,
            method="predictor-corrector",
        ).bearing()["force"]
        for one, f in ((pier, 1.0), (small, 6.0))
    ]  # fmt: skip
    largest = np.abs(forces[0]).max()
    assert largest > 100.0
    assert_allclose(forces[1], forces[0], atol=tol.SIMILAR * largest)


@pytest.fixture(scope="module")
def profiles() -> Any:
    bearings = ["shen-hdr-specimen", "shen-lhdr-specimen", "shen-bilinear-bridge"]
    keep = ["rubber", "cells"]
    return tb.hybrid(bearings, "jra-ii-ii-1", -20, duration=11, keep=tb.Keep(keep, every=10))


def test_cells_hold_the_layers_and_the_heat(profiles: Any) -> None:
    """The middle of a layer is the mean of its two cells; the cells hold the stored heat."""
    data = profiles.dataset
    for run, name in enumerate(["shen-hdr-specimen", "shen-lhdr-specimen"]):
        mine = data.isel(run=run)
        model = build_model(tb.load_bearing(name))
        stack = model.stack
        cells = len(stack.part)
        assert list(mine["part"].values[:cells]) == list(stack.part)
        assert_allclose(mine["cell_thickness"].values[:cells], stack.thickness)
        assert_allclose(mine["depth"].values[:cells], stack.depth)
        temperature = mine["temperature"].values[:, :cells].astype(float)
        assert_allclose(temperature[0], -20.0)
        rubber = np.flatnonzero(np.array(stack.part) == "rubber").reshape(3, -1)
        middles = np.stack([temperature[:, pair].mean(axis=1) for pair in rubber], axis=1)
        expected = mine["rubber_temperature"].values
        assert_allclose(middles, expected, atol=tol.SINGLE_PRECISION)
        lead = 0.0
        constants = model.constants
        if constants.lead.cores:
            rise = float(mine["lead_temperature"].values[-1]) + 20.0
            lead = constants.lead.cores * constants.lead.capacity * rise
        heat = constants.cells.capacity @ (temperature[-1] + 20.0) + lead
        assert heat == pytest.approx(float(mine["heat_heat_stored"]), rel=tol.HEAT_OF_CELLS)
    assert not np.isfinite(data["depth"].values[2]).any()


@pytest.mark.thorough
def test_profiles_at_chosen_times(profiles: Any, tmp_path: Path) -> None:
    figure = profiles.plot.profiles([5.0, 10.0])
    assert len(figure.axes) == 3  # two bearings, and the lead of one
    assert figure.axes[2].get_xlabel() == "lead [°C]"
    data = profiles.dataset.isel(run=0)
    row = int(np.abs(data["time"].values - 10.0).argmin())
    cells = np.isfinite(data["depth"].values)
    drawn = figure.axes[0].get_lines()[1].get_xdata()
    assert_allclose(drawn, data["temperature"].values[row, cells], rtol=1e-6)
    reported = [text.get_text() for text in figure.legends[0].get_texts()]
    assert reported[:3] == ["5 s", "10 s", "lead core (dashed)"]
    folder = profiles.save(tmp_path / "cells")
    assert (folder / "figures" / "profiles.png").exists()
    assert 'keep = [\n    "rubber",\n    "cells",\n]' in (folder / "case.resolved.toml").read_text()
    again = tb.load_result(folder).plot.profiles()
    assert again.legends[0].get_texts()[0].get_text() == "2.75 s"


@pytest.mark.parametrize(
    ("times", "piece"),
    [([12.0], "12.0 s is not in 0 to 11 s"), ([], "1 to 8"), ([1] * 9, "9 given")],
)
def test_bad_times_of_profiles(times: list[float], piece: str, profiles: Any) -> None:
    with pytest.raises(tb.InputError, match=piece):
        profiles.plot.profiles(times)


def test_profiles_need_cells(study: Any) -> None:
    assert "temperature" not in study.dataset
    with pytest.raises(tb.InputError, match='keep = \\["rubber", "cells"\\]'):
        study.plot.profiles()


@pytest.mark.parametrize(
    ("keep", "piece"), [(["cells"], 'need "rubber"'), (["rubber", "celss"], "analysis.keep[1]")]
)
def test_bad_keep(keep: list[str], piece: str) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.bridge("shen-hdr-bridge", keep=keep)
    assert piece in str(caught.value)


def test_profiles_of_one_temperature() -> None:
    options: dict[str, Any] = {"model": "single-temperature", "keep": ["rubber", "cells"]}
    study = tb.hybrid("shen-hdr-specimen", ambient=0, duration=1, **options)
    assert study.dataset["part"].values.tolist() == [["whole bearing"]]
    assert len(study.plot.profiles().axes) == 1
