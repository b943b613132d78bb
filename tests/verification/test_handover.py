"""A history cut in parts, by hand or as a sequence, is the same history run at once."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from thermobearing.cyclic.case import end_state, make_case
from thermobearing.earthquake.case import load_earthquake_case
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.model.handover import MEMORY, PREFIX
from thermobearing.sequences.case import SequenceCase, make_sequence_case
from thermobearing.sequences.run import run_sequence

Result = tb.Result
CYCLES = {"step": "cycles", "strain": 1.5, "wave": "sine", "period": 3.0, "count": 1}
LOADED = {"step": "ramp", "to_strain": 0.8, "speed": 40.0}
HELD = {"step": "rest", "duration": 40.0}
BACK = {"step": "ramp", "to": 0.0, "speed": 25.0}
FIRST, SECOND = [CYCLES, LOADED], [HELD, BACK, CYCLES]
SECONDS = np.linspace(0.0, 3.0, 61)
CURVE = {
    "step": "recorded",
    "time_s": SECONDS.tolist(),
    "displacement_mm": (35.0 * np.sin(2.2 * SECONDS)).tolist(),
    "displacement_y_mm": (25.0 * np.sin(1.7 * SECONDS)).tolist(),
}
TURN = {"step": "path", "path": "eight", "strain": 1.2, "period": 3.0, "count": 1}
SUMS = ("work_in", "heat_released", "heat_lost_ends", "heat_lost_sides", "heat_stored")
NOW = ("displacement", "force", "rubber_temperature", "temperature")
BRANCHES = ("rubber_force", "lead_force", "viscous_force", "lead_temperature")
VIRGIN = {"amplitude": 1.5, "strain": 0.3, "mullins_amplitude": 0.25}


def select_bearing(name: str) -> tb.Bearing:
    if name != "virgin":
        return tb.load_bearing(name)
    table = tb.load_bearing("shen-hdr-specimen").model_dump()
    return tb.Bearing.model_validate(table | {"scragging": VIRGIN})


def made(steps: list[dict[str, Any]]) -> tb.CyclicTest:
    return tb.CyclicTest(dt=0.03, steps=steps)


PUBLISHED = tb.ModelOptions(scheme="published")
BEARINGS = {
    "HDR": ("shen-hdr-specimen", {}),
    "LHDR": ("shen-lhdr-specimen", {}),
    "natural rubber": ("lrb-example", {}),
    "virgin": ("virgin", {}),
    "monotone": ("shen-lhdr-specimen", {"model": tb.ModelOptions(hardening="monotone")}),
    "published": ("shen-lhdr-specimen", {"model": PUBLISHED}),
    "full": (
        "shen-hdr-specimen",
        {"model": tb.ModelOptions(stack="full", heat_source="dissipation")},
    ),
}


def close(result: Any, wanted: Any, name: str) -> None:
    scale = max(float(np.abs(wanted).max()), 1e-300)
    assert_allclose(result / scale, wanted / scale, rtol=0, atol=tol.CUT, err_msg=name)


IN_PLANE = [f"{name} in a plane" for name in BEARINGS if name not in ("monotone", "published")]


@pytest.fixture(scope="module", params=[*BEARINGS, *IN_PLANE])
def runs(request: Any) -> tuple[Result, Result, Result, dict[str, Any]]:
    name, options = BEARINGS[request.param.removesuffix(" in a plane")]
    bearing = select_bearing(name)
    before, after = FIRST, SECOND
    if request.param in IN_PLANE:
        before, after = [CURVE], [HELD, BACK, TURN]
    whole = tb.run(bearing, made(before + after), -20.0, **options)
    first = tb.run(bearing, made(before), -20.0, **options)
    second = tb.run(bearing, made(after), -20.0, initial=first, **options)
    return whole, first, second, {"bearing": bearing, **options}


def test_cut_in_two_is_the_whole(runs: tuple[Result, Result, Result, Any]) -> None:
    whole, first, second, _ = runs
    cut = first.dataset.sizes["time"] - 1
    assert np.abs(first["displacement"].values[0, -1]).min() > 1.0  # cut while it is loaded
    for name in (*NOW, *(name for name in BRANCHES if name in whole.dataset)):
        close(second[name].values[0], whole[name].values[0, cut:], name)
    for name in SUMS:
        total = first[name].values[0, -1] + second[name].values[0]
        close(total, whole[name].values[0, cut:], name)
    close(second.time(0) + first.time(0)[-1], whole.time(0)[cut:], "time")
    for key in MEMORY:
        if PREFIX + key in whole.dataset:
            close(second[PREFIX + key].values, whole[PREFIX + key].values, key)


def test_the_balance_of_each_part_closes(runs: tuple[Result, Result, Result, Any]) -> None:
    if runs[3].get("model") == PUBLISHED:
        return  # its balance has gaps by itself
    for part in runs[:3]:
        assert part.energy["mechanical_residual"].abs().max() < tol.ENERGY_BALANCE
        assert part.energy["thermal_residual"].abs().max() < tol.ENERGY_BALANCE


def test_a_directory_hands_over_the_same(tmp_path: Path) -> None:
    """From result.nc, and from the resolved case of the second part alone: the same bits."""
    bearing = select_bearing("virgin")
    first = tb.run(bearing, made(FIRST), -20.0)
    second = tb.run(bearing, made(SECOND), -20.0, initial=first)
    saved = first.save(tmp_path / "first", figures=False)
    for start in (saved, tb.load_result(saved)):
        read = tb.run(bearing, made(SECOND), -20.0, initial=start)
        assert np.array_equal(read["force"], second["force"])
    saved = second.save(tmp_path / "second", figures=False)
    again = tb.run_case(tb.load_case(saved / "case.resolved.toml"))
    assert again.dataset.drop_attrs().identical(second.dataset.drop_attrs())


def test_a_line_in_a_plane_is_along_x() -> None:
    """A test in a plane continues one on a line; a line cannot continue a plane."""
    bearing = select_bearing("virgin")
    line = tb.run(bearing, made(FIRST), -20.0)
    second = tb.run(bearing, made([HELD, BACK, TURN]), -20.0, initial=line)
    whole = tb.run(bearing, made([*FIRST, HELD, BACK, TURN]), -20.0)
    cut = line.dataset.sizes["time"] - 1
    for name in NOW:
        close(second[name].values[0], whole[name].values[0, cut:], name)
    left = end_state(line, bearing)
    assert left.across is None
    ours, theirs = (tb.element(bearing, ambient=-20.0, components=n, initial=left) for n in (1, 2))
    straight = ours.set_trial(20.0, dt=0.1)
    assert_allclose(theirs.set_trial((20.0, 0.0), dt=0.1).force, [straight.force, 0.0], rtol=1e-12)
    left = end_state(second, bearing)
    assert left.across is not None
    state = tb.element(bearing, ambient=-20.0, components=2, initial=left).state
    assert_array_equal(state.response["force"][0], second["force"].values[0, -1])
    for wrong in (
        lambda: tb.run(bearing, made([HELD]), -20.0, initial=second),
        lambda: tb.element(bearing, initial=left),
    ):
        with pytest.raises(tb.InputError, match="of a test in a plane"):
            wrong()


@pytest.mark.parametrize("name", quick_cases(["shen-hdr-bridge", "shen-lhdr-bridge"], 1))
def test_a_pier_in_plan_hands_over_both_directions(name: str) -> None:
    """An earthquake, a test that unloads the bearing where it was left, an earthquake."""
    plan = tb.load_structure("pier-p1").model_copy(update={"plan": True})
    pair = tb.MotionPair(tb.load_motion("jra-ii-i-1"), tb.load_motion("jra-ii-i-2"))
    options: dict[str, Any] = {"structure": plan, "keep": tb.Keep(every=1)}
    first = tb.bridge(name, pair, -20.0, duration=4.0, **options)
    left = end_state(first, name)
    assert left.across is not None
    x, y = left.displacement, left.across.displacement
    assert min(abs(x or 0.0), abs(y)) > 1.0
    test = tb.run(name, ([0.0, 20.0, 25.0], [x, x, 0.0], [y, y, 0.0]), -20.0, initial=first)
    assert_array_equal(test["force"].values[0, 0], [left.force, left.across.force])
    assert_array_equal(test["temperature"].values[0, 0], np.float32(left.temperature))
    last = tb.bridge(name, pair, -20.0, duration=2.0, initial=test, **options)
    assert last.outcome == "completed"
    assert_allclose(last["bearing_force"].values[0, 0, :2], test["force"].values[0, -1], rtol=1e-7)
    assert last.energy["mechanical_residual"].abs().max() < tol.ENERGY_BALANCE
    with pytest.raises(tb.InputError, match="of a test in a plane"):
        tb.bridge(name, pair.first, -20.0, duration=1.0, initial=test)


REFUSED = {
    "another bearing": ({"bearing": "shen-lhdr-specimen"}, "not of this"),
    "another stack": (
        {"model": tb.ModelOptions(stack="full")},
        "temperatures, but the model has 37 cells",
    ),
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


def test_a_damaged_state_in_a_case_is_reported(tmp_path: Path) -> None:
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
        ({"force": None}, "missing: force"),
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
    middle = cyclic({"step": "rest", "duration": "40 s"}, UNLOAD, SINE)
    parts = [{"part": "hybrid", "duration": "4 s"}, middle, {"part": "hybrid", "duration": "3 s"}]
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
    for call, output in (
        (
            lambda: tb.run("lrb-example", SHORT, 0.0, initial=study),
            'is a test of "shen-hdr-specimen"',
        ),
        (lambda: tb.run(HDR, SHORT, 5.0, initial=study), r"has 2 runs, at \[-20.   0.\] degC"),
        (lambda: tb.hybrid([HDR, LHDR], initial=study), "a single, layered bearing"),
        (lambda: tb.bridge("shen-bilinear-bridge", initial=study), "single, layered"),
        (lambda: tb.hybrid(HDR, ambient=0, initial=tmp_path), "initial_result: .*no result"),
        (lambda: tb.hybrid(HDR, ambient=0, initial=3), "an earlier result"),  # type: ignore[arg-type]
    ):
        with pytest.raises(tb.InputError, match=output):
            call()
    cold = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", 0, duration=1)
    assert not [name for name in cold.dataset if str(name).startswith(PREFIX)]
    with pytest.raises(tb.InputError, match="contains no final state"):
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


# The same steps as in a file.
SINE = CYCLES | {"period": "3 s"}
LOAD, UNLOAD = LOADED | {"speed": "40 mm/s"}, BACK | {"to": "0 mm", "speed": "25 mm/s"}
HYBRID = {"part": "hybrid", "duration": "6 s", "motion": {"name": "jra-ii-ii-1", "factor": 0.7}}
DT = "30 ms"


def sequence_case(*parts: dict[str, Any], **table: Any) -> SequenceCase:
    usual = {"bearing": "shen-lhdr-specimen", "ambient": "-20 degC", "between": "as-left"}
    return make_sequence_case({**usual, **table, "parts": list(parts)}, "test")


def cyclic(*steps: dict[str, Any], **table: Any) -> dict[str, Any]:
    return {"part": "cyclic", "dt": DT, "steps": list(steps), **table}


def the_same_end(result: Any, wanted: Any) -> None:
    for key in (*(PREFIX + key for key in MEMORY), "final_temperature", "final_lead_temperature"):
        close(result[key].values, wanted[key].values, key)


def test_cyclic_parts_are_one_test() -> None:
    rest = {"step": "rest", "duration": "20 s"}
    whole = run_sequence(sequence_case(cyclic(SINE, LOAD, rest, UNLOAD, SINE)))
    rest_part = {"part": "rest", "duration": "20 s"}
    # A part of rest has its own longest step; the default of a test is what both have here.
    parts = run_sequence(sequence_case(cyclic(SINE, LOAD), cyclic(rest), cyclic(UNLOAD, SINE)))
    the_same_end(parts[2], whole[0])
    assert run_sequence(sequence_case(cyclic(LOAD), rest_part))[1].outcome == "completed"
    assert_allclose(
        parts.table["energy_kN_mm"].sum(), whole.table["energy_kN_mm"].sum(), rtol=tol.CUT
    )


def test_a_hybrid_part_is_the_history_that_it_imposed(tmp_path: Path) -> None:
    """Its displacements recorded, and imposed on the same specimen together with what follows."""
    case = sequence_case(cyclic(SINE), HYBRID, cyclic(UNLOAD, SINE))
    result = run_sequence(case)
    hybrid = case.whole_part(1, None).model_copy(
        update={"initial_state": _state_after(sequence_case(cyclic(SINE)))}
    )
    (task,) = build_tasks(hybrid)  # type: ignore[arg-type]
    response = run_task(task).rows.bearings[:, 0]
    rows = zip(response["clock"].tolist(), response["displacement"].tolist(), strict=True)
    file = tmp_path / "hybrid.csv"
    text = "".join(f"{t!r},{x!r}\n" for t, x in rows)
    file.write_text("time_s,displacement_mm\n" + text)
    assert np.abs(response["displacement"]).max() > 15.0
    recorded = {"step": "recorded", "file": str(file)}
    whole = run_sequence(sequence_case(cyclic(SINE, recorded, UNLOAD, SINE)))
    the_same_end(result[2], whole[0])


def _state_after(case: SequenceCase) -> Any:
    from thermobearing.cyclic.case import final_state

    return final_state(run_sequence(case)[0].dataset, [-20.0])


@pytest.mark.parametrize("method", ["predictor-corrector", "average-acceleration"])
def test_the_force_at_rest_moves_no_structure(method: str) -> None:
    """It is in balance when the hybrid part begins; and the balance of all parts closes."""
    still = {**HYBRID, "motion": {"name": "jra-ii-ii-1", "factor": 1e-6}, "method": method}
    cooled = {"part": "rest", "duration": "24 h"}  # the rate branch has relaxed
    result = run_sequence(sequence_case(cyclic(LOAD), cooled, still))
    history = result.history(2)
    assert history["force_kN"].iloc[0] > 100.0
    assert_allclose(history["displacement_mm"], 24.0, atol=tol.STILL)
    shaken = run_sequence(sequence_case(cyclic(LOAD), {**HYBRID, "method": method}))
    energy = shaken[1].energy.iloc[0]
    assert abs(energy["mechanical_residual"]) < tol.ENERGY_BALANCE
    assert abs(energy["thermal_residual"]) < tol.ENERGY_BALANCE
    if method == "average-acceleration":
        assert abs(energy["structure_residual"]) < tol.STRUCTURE_BALANCE


def test_unloaded_specimens_start_from_zero() -> None:
    case = sequence_case(cyclic(LOAD), cyclic(SINE), between="unloaded")
    result = run_sequence(case)
    table = result.table
    assert abs(table["force_start_kN"][1]) < tol.UNLOADED
    assert table["displacement_start_mm"][1] == 0.0
    assert table["force_end_kN"][0] > 100.0
    state = result.parts[1].dataset
    zero = float(state[PREFIX + "displacement"][0])  # the cycle ends at the zero of instruments
    assert 1.0 < zero < 24.0
    # A loop around it: its mean force is the elastic one of the rubber there.
    loop = result.history(1)
    assert loop["displacement_mm"].max() == pytest.approx(45.0)
    assert loop["force_kN"].max() > -loop["force_kN"].min()
    left = run_sequence(sequence_case(cyclic(LOAD), cyclic(UNLOAD, SINE)))
    assert abs(left.table["force_start_kN"][1]) > 100.0


@pytest.mark.thorough
def test_a_second_hybrid_test_is_that_of_a_specimen_without_force() -> None:
    """Second over first peak: an offset of force made it 1.05, without it 0.996."""
    steps = [UNLOAD, SINE | {"strain": 2.5, "count": 5, "closing_strain": 0.1}]
    rest = {"part": "rest", "duration": "1.25 h"}
    first = {"part": "hybrid", "duration": "20 s"}
    for between, ratio, start in (("unloaded", 0.996, 0.0), ("as-left", 1.05, 56.0)):
        parts = (first, rest, cyclic(*steps, dt="5 ms"), rest, first)
        table = run_sequence(sequence_case(*parts, between=between)).table
        peaks = np.maximum(table["force_max_kN"], -table["force_min_kN"])
        assert peaks.iloc[-1] / peaks.iloc[0] == pytest.approx(ratio, abs=0.01)
        assert table["force_start_kN"].iloc[-1] == pytest.approx(start, abs=0.5)
