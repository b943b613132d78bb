"""A test cut in two, the second begun where the first ended, is the same history run at once."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.cyclic.case import make_case
from thermobearing.earthquake.case import load_earthquake_case
from thermobearing.model.handover import MEMORY, PREFIX

Result = tb.Result
CYCLES = {"step": "cycles", "strain": 1.5, "wave": "sine", "period": 3.0, "count": 1}
LOADED = {"step": "ramp", "to_strain": 0.8, "speed": 40.0}
HELD = {"step": "rest", "duration": 40.0}
BACK = {"step": "ramp", "to": 0.0, "speed": 25.0}
FIRST, SECOND = [CYCLES, LOADED], [HELD, BACK, CYCLES]
SUMS = ("work_in", "heat_released", "heat_lost_ends", "heat_lost_sides", "heat_stored")
NOW = ("displacement", "force", "rubber_temperature", "temperature")
BRANCHES = ("rubber_force", "lead_force", "viscous_force", "lead_temperature")
VIRGIN = {"amplitude": 1.5, "strain": 0.3, "mullins_amplitude": 0.25}


def bearing_of(name: str) -> tb.Bearing:
    if name != "virgin":
        return tb.load_bearing(name)
    table = tb.load_bearing("shen-hdr-specimen").model_dump()
    return tb.Bearing.model_validate(table | {"scragging": VIRGIN})


def made(steps: list[dict[str, Any]]) -> tb.CyclicTest:
    return tb.CyclicTest(dt=0.03, steps=steps)


BEARINGS = {
    "HDR": ("shen-hdr-specimen", {}),
    "LHDR": ("shen-lhdr-specimen", {}),
    "natural rubber": ("lrb-example", {}),
    "virgin": ("virgin", {}),
    "monotone": ("shen-lhdr-specimen", {"hardening": "monotone"}),
    "published": ("shen-lhdr-specimen", {"scheme": "published"}),
    "full": ("shen-hdr-specimen", {"stack": "full", "heat_source": "dissipation"}),
}


def close(found: Any, wanted: Any, name: str) -> None:
    scale = max(float(np.abs(wanted).max()), 1e-300)
    assert_allclose(found / scale, wanted / scale, rtol=0, atol=tol.CUT, err_msg=name)


@pytest.fixture(scope="module", params=BEARINGS)
def runs(request: Any) -> tuple[Result, Result, Result, dict[str, Any]]:
    name, options = BEARINGS[request.param]
    bearing = bearing_of(name)
    whole = tb.run(bearing, made(FIRST + SECOND), -20.0, **options)
    first = tb.run(bearing, made(FIRST), -20.0, **options)
    second = tb.run(bearing, made(SECOND), -20.0, initial=first, **options)
    return whole, first, second, {"bearing": bearing, **options}


def test_cut_in_two_is_the_whole(runs: tuple[Result, Result, Result, Any]) -> None:
    whole, first, second, _ = runs
    cut = first.dataset.sizes["time"] - 1
    assert abs(first["displacement"].values[0, -1]) > 1.0  # cut while it is loaded
    for name in (*NOW, *(name for name in BRANCHES if name in whole.dataset)):
        close(second[name].values[0], whole[name].values[0, cut:], name)
    for name in SUMS:
        total = first[name].values[0, -1] + second[name].values[0]
        close(total, whole[name].values[0, cut:], name)
    close(second.time(0) + first.time(0)[-1], whole.time(0)[cut:], "time")
    for key in MEMORY:
        if PREFIX + key in whole.dataset:
            close(second[PREFIX + key].values, whole[PREFIX + key].values, key)


def test_the_books_of_each_part_close(runs: tuple[Result, Result, Result, Any]) -> None:
    if runs[3].get("scheme") == "published":
        return  # its books have gaps by themselves
    for part in runs[:3]:
        assert part.energy["mechanical_residual"].abs().max() < tol.ENERGY_BOOKS
        assert part.energy["thermal_residual"].abs().max() < tol.ENERGY_BOOKS


def test_a_directory_hands_over_the_same(tmp_path: Path) -> None:
    """From result.nc, and from the resolved case of the second part alone: the same bits."""
    bearing = bearing_of("virgin")
    first = tb.run(bearing, made(FIRST), -20.0)
    second = tb.run(bearing, made(SECOND), -20.0, initial=first)
    saved = first.save(tmp_path / "first", figures=False)
    for start in (saved, tb.load_result(saved)):
        read = tb.run(bearing, made(SECOND), -20.0, initial=start)
        assert np.array_equal(read["force"], second["force"])
    saved = second.save(tmp_path / "second", figures=False)
    again = tb.run_case(tb.load_case(saved / "case.resolved.toml"))
    assert again.dataset.drop_attrs().identical(second.dataset.drop_attrs())


REFUSED = {
    "another bearing": ({"bearing": "shen-lhdr-specimen"}, "not of this"),
    "another stack": ({"stack": "full"}, "temperatures, but the model has 37 cells"),
    "two starts": ({"initial": tb.InitialState(lead=3.0)}, "needs a bearing with lead"),
}


@pytest.mark.parametrize("change", REFUSED)
def test_a_state_that_does_not_fit_is_refused(change: str) -> None:
    first = tb.run("shen-hdr-specimen", made([LOADED]), -20.0)
    options, piece = REFUSED[change]
    given: dict[str, Any] = {"bearing": "shen-hdr-specimen", "initial": first} | options
    with pytest.raises(tb.InputError, match=piece):
        tb.run(test=made([HELD]), ambient=-20.0, **given)
    with pytest.raises(tb.InputError, match="bearing is at 24 mm"):
        tb.run("shen-hdr-specimen", made([CYCLES]), -20.0, initial=first)


def test_a_damaged_state_in_a_case_is_told(tmp_path: Path) -> None:
    first = tb.run("shen-lhdr-specimen", made([LOADED]), -20.0)
    second = tb.run("shen-lhdr-specimen", made([HELD]), -20.0, initial=first)
    table = tomllib.loads(second.dataset.attrs["case"])
    state = table["initial_state"]
    for change, piece in (
        ({"layer_displacement": state["layer_displacement"][:-1]}, "modelled layers"),
        ({"lead_terms": ["1 K"]}, "has 1 lead_terms"),
        ({"layer_hysteretic": ["900 mm"] * 3}, "layer_hysteretic reaches 900 mm"),
        ({"displacement": "3 mm"}, "does not add up"),
        ({"layer_virgin": [7.0] * 3}, "at most 1"),
        ({"force": None}, "a part of the state is missing: force"),
    ):
        broken = {k: v for k, v in (state | change).items() if v is not None}
        with pytest.raises(tb.InputError, match=piece):
            make_case(table | {"initial_state": broken}, "case")


LHDR, HDR = "shen-lhdr-specimen", "shen-hdr-specimen"
SHORT = made([HELD, BACK, CYCLES])


@pytest.fixture(scope="module")
def study() -> tb.EarthquakeResult:
    return tb.hybrid([HDR, LHDR], ambient=[-20.0, 0.0], duration=4.0)


def test_a_test_goes_on_from_a_hybrid_one_as_in_a_sequence(tmp_path: Path) -> None:
    """hybrid -> cyclic -> hybrid, each from the result of the one before: the sequence."""
    steps = [
        {"step": "rest", "duration": "40 s"},
        {"step": "ramp", "to": "0 mm", "speed": "25 mm/s"},
        {"step": "cycles", "strain": 1.5, "wave": "sine", "period": "3 s", "count": 1},
    ]
    cyclic = {"part": "cyclic", "dt": "30 ms", "steps": steps}
    parts = [{"part": "hybrid", "duration": "4 s"}, cyclic, {"part": "hybrid", "duration": "3 s"}]
    table = {"bearing": LHDR, "ambient": "-20 degC", "parts": parts, "between": "as-left"}
    wanted = tb.sequence(table)
    first = tb.hybrid(LHDR, ambient=-20, duration=4, keep=tb.Keep(every=1))
    first.save(tmp_path / "first", figures=False)
    second = tb.run(LHDR, SHORT, -20.0, initial=tmp_path / "first")
    third = tb.hybrid(LHDR, ambient=-20, duration=3, keep=tb.Keep(every=1), initial=second)
    for name in ("force", "temperature", "lead_temperature"):
        close(second[name].values, wanted[1].dataset[name].values, name)  # type: ignore[union-attr]
    for key in (*(PREFIX + key for key in MEMORY), "final_temperature", "bearing_force"):
        close(third.dataset[key].values, wanted[2].dataset[key].values, key)


def test_the_run_of_the_same_bearing_and_temperature_goes_on(study: tb.EarthquakeResult) -> None:
    for name in (HDR, LHDR):
        for air in (-20.0, 0.0):
            alone = tb.hybrid(name, ambient=air, duration=4.0)
            one = tb.run(name, SHORT, air, initial=alone)
            of_study = tb.run(name, SHORT, air, initial=study)
            close(of_study["force"].values, one["force"].values, name)
            assert abs(one["force"].values[0, 0]) > 0.0


def test_what_no_test_can_go_on_from(study: tb.EarthquakeResult, tmp_path: Path) -> None:
    for call, said in (
        (
            lambda: tb.run("lrb-example", SHORT, 0.0, initial=study),
            'is a test of "shen-hdr-specimen"',
        ),
        (lambda: tb.run(HDR, SHORT, 5.0, initial=study), r"has 2 runs, at \[-20.   0.\] degC"),
        (lambda: tb.hybrid([HDR, LHDR], initial=study), "is of one bearing"),
        (lambda: tb.bridge("shen-bilinear-bridge", initial=study), "none that is bilinear"),
        (lambda: tb.hybrid(HDR, ambient=0, initial=tmp_path), "initial_result: .*no result"),
        (lambda: tb.hybrid(HDR, ambient=0, initial=3), "an earlier result"),  # type: ignore[arg-type]
    ):
        with pytest.raises(tb.InputError, match=said):
            call()
    cold = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", 0, duration=1)
    assert not [name for name in cold.dataset if str(name).startswith(PREFIX)]
    with pytest.raises(tb.InputError, match="holds no ends"):
        tb.run(HDR, SHORT, 0.0, initial=cold)


def test_a_case_file_names_the_earlier_result(study: tb.EarthquakeResult, tmp_path: Path) -> None:
    study.save(tmp_path / "mine", figures=False)
    file = tmp_path / "case.toml"
    file.write_text(f'bearings = "{HDR}"\nambient = "0 degC"\ninitial_result = "mine"\n')
    case = load_earthquake_case(file, command="hybrid")
    assert case.initial_state is not None
    force = study.dataset[PREFIX + "force"].values[1]  # of HDR at 0 degC
    assert case.initial_state.force == force
    file.write_text(case.to_toml())
    assert load_earthquake_case(file).initial_state == case.initial_state
