"""Parts of a cyclic analysis by hand: warnings, restarts, kept rows, lost heat, comparisons."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.core.types import COMPLETED
from thermobearing.cyclic import dataset, history
from thermobearing.cyclic.case import final_state, initial_temperatures, make_case
from thermobearing.cyclic.comparison import _temperatures
from thermobearing.cyclic.dataset import _collect_warnings
from thermobearing.cyclic.equivalent import bilinear_parameters, isothermal_cycle, solve_backbone
from thermobearing.cyclic.history import Segment, _kept_steps, build_segments, run_segments
from thermobearing.cyclic.protocol import Recorded, Rest
from thermobearing.cyclic.result import _history_blocks
from thermobearing.cyclic.tables import cycles_table
from thermobearing.model.options import build_model

HDR = tb.load_bearing("shen-hdr-specimen")
LAYERS, YIELD = HDR.geometry.rubber_layers, HDR.hysteresis.yield_displacement
COLD = tb.Ambient.constant(-20.0)


def moved(x: list[float]) -> Segment:
    count = len(x)
    return Segment(
        "ramp", "x", np.array(x), np.full(count, 0.01), np.zeros(count, dtype=np.int32),
        np.zeros(count, dtype=bool),
    )  # fmt: skip


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("part", "reported"), [(0.98, False), (1.02, True)])
def test_coarse_steps_are_reported_where_a_layer_moves_by_its_yield_displacement(
    sign: float, part: float, reported: bool
) -> None:
    case = make_case({}, "test", bearing=HDR)
    far = sign * part * LAYERS * YIELD
    for segments in ([moved([far])], [moved([0.2 * far]), moved([0.1 * far, 1.1 * far])]):
        output = _collect_warnings(case, segments, [COLD])
        assert len(output) == int(reported)
        if reported:
            assert f"up to {part * YIELD:.2g} mm" in output[0]


def test_a_series_given_in_python_gives_a_warning() -> None:
    case = make_case({}, "test", bearing=HDR)
    series = tb.Ambient.series(np.array([0.0, 10.0]), np.array([0.0, 5.0]))
    assert "given in Python" in _collect_warnings(case, [moved([0.1])], [series])[0]
    assert _collect_warnings(case, [moved([0.1])], [COLD]) == []


def earlier() -> Any:
    """A result with runs at -20, 5 and 23 degC, whose cells and lead end at known numbers."""
    air = np.array([-20.0, 5.0, 23.0])
    profiles = air[:, np.newaxis] + np.array([0.5, 1.0, 1.5])
    data: Any = {
        "initial_temperature": (("ambient", "cell"), np.zeros((3, 3))),
        "final_temperature": (("ambient", "cell"), profiles),
        "final_lead_temperature": ("ambient", air + 40.0),
    }
    return xr.Dataset(data, coords={"ambient": air})


@pytest.mark.parametrize("air", [-20.0, 5.0, 23.0])
def test_restart_is_from_the_run_at_the_same_temperature(air: float) -> None:
    result = final_state(earlier(), [air])
    assert_allclose(result.temperature, air + np.array([0.5, 1.0, 1.5]))
    assert result.lead_temperature == air + 40.0
    assert not result.complete


def test_restart_from_an_only_run_and_from_none() -> None:
    only = earlier().isel(ambient=[1])
    assert_allclose(final_state(only, [-20.0]).temperature, [5.5, 6.0, 6.5])
    without = only.assign(final_lead_temperature=("ambient", [np.nan]))
    assert final_state(without, [5.0]).lead_temperature is None
    for air in ([0.0], [5.0, 23.0]):
        with pytest.raises(tb.InputError, match=r"has 3 runs, .*choose one of them"):
            final_state(earlier(), air)


def test_starts_by_hand() -> None:
    for profile, uniform, wanted in (
        (None, None, [7.0, 7.0]), (None, -3.0, [-3.0, -3.0]), ([1.0, 2.0], None, [1.0, 2.0]),
    ):  # fmt: skip
        case: Any = SimpleNamespace(initial_profile=profile, initial=uniform, initial_state=None)
        case.conditioning, case.initial_lead = None, 5.0
        temperature, lead = initial_temperatures(case, 2, 7.0)
        assert_allclose(temperature, wanted)
        assert lead == 5.0


def test_every_nth_step_and_the_ends_of_legs_are_kept() -> None:
    segment = moved([0.0] * 10)
    assert np.flatnonzero(_kept_steps(segment, 3)).tolist() == [2, 5, 8]
    segment.turning[3] = True
    assert np.flatnonzero(_kept_steps(segment, 4)).tolist() == [3, 7]
    assert _kept_steps(segment, 1).all()


def test_mismatch_is_the_largest_and_softened_steps_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = iter([(1, 0.2), (4, 0.5), (2, 0.1)])

    def march(*arguments: Any) -> tuple[int, int, int, int, float]:
        softened, mismatch = next(answers)
        return len(arguments[4].x), 0, COMPLETED, softened, mismatch

    monkeypatch.setattr(history, "march", march)
    model = build_model(HDR)
    cells = np.full(len(model.stack.part), -20.0)
    run = run_segments(model.constants, [moved([1.0, 2.0])] * 3, COLD, cells)
    assert (run.mismatch, run.softened_steps, run.steps) == (0.5, 7, 6)


def short_run(**options: Any) -> history.History:
    """A warming ramp of the air, and of the bearing to 100 %."""
    model = build_model(HDR)
    test = tb.CyclicTest(dt=0.02, steps=[{"step": "ramp", "to_strain": 1.0, "duration": 2.0}])
    air = tb.Ambient.series(np.array([0.0, 1.0, 2.0]), np.array([-20.0, 30.0, -20.0]))
    cells = np.full(len(model.stack.part), -20.0)
    segments = build_segments(test, HDR.total_rubber_thickness)
    return run_segments(model.constants, segments, air, cells, **options)


def test_chunks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = short_run()
    monkeypatch.setattr(history, "CHUNK", 7)
    again = short_run()
    for name in ("force", "heat_lost_ends", "heat_stored"):
        result, wanted = again.rows.response[name], whole.rows.response[name]
        assert_allclose(result, wanted, rtol=tol.PROTOCOL, atol=tol.PROTOCOL)


def test_a_run_that_was_cut_off_keeps_where_it_stood(monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(steps: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(history, "CHUNK", 7)
    run = short_run(keep_every=1000, progress=stop)
    assert run.outcome == "interrupted"
    assert len(run.segment) == 2
    kept = run.rows.cells[-1]
    assert_allclose(kept, run.state.temperature, atol=tol.SINGLE_PRECISION)
    assert np.abs(kept - run.initial).max() > 1e-3
    assert run.rows.response["clock"][-1] == run.state.response[0].clock > 0.0


@pytest.mark.parametrize("through", ["ends", "sides"])
def test_heat_is_lost_where_it_can_leave(through: str) -> None:
    film = {"side_film": 0.0 if through == "ends" else 20.0}
    bearing = HDR.model_copy(update={"materials": HDR.materials.model_copy(update=film)})
    face = tb.EndFace(eta=3.0 if through == "ends" else 1.0)
    test = tb.CyclicTest(dt=1.0, steps=[{"step": "rest", "duration": 600.0}])
    result = tb.run(
        bearing, test, -20.0, initial=20.0, model=tb.ModelOptions(upper_face=face, lower_face=face)
    )
    response = result.energy.iloc[0]
    lost = {name: response[f"heat_lost_{name}_kN_mm"] for name in ("ends", "sides")}
    assert lost.pop(through) > 1e3
    assert list(lost.values()) == [0.0]
    variable = result[f"heat_lost_{through}"]
    assert variable.values[0, -1] > 1e3
    assert variable.attrs["long_name"].split()[-1] in ("faces", "sides")
    assert ("sides" in variable.attrs["long_name"]) == (through == "sides")


@pytest.mark.parametrize(("half", "inner"), [(1, 5), (0, 3)])
def test_inner_layer_of_a_half_and_of_a_whole_stack(half: int, inner: int) -> None:
    """Of six modelled layers: the last one at the plane of symmetry, or the one in the middle."""
    values = np.arange(12.0).reshape(1, 2, 6)
    data = {"rubber_temperature": (("ambient", "time", "layer"), values)}
    result = tb.Result(xr.Dataset(data, attrs={"half_stack": half}))
    assert_allclose(_temperatures(result, 0, "inner layer"), [inner, 6 + inner])
    assert_allclose(_temperatures(result, 0, "outer layer"), [0, 6])


def test_equivalent_model_is_that_of_the_temperature_asked_for() -> None:
    warm, cold = (bilinear_parameters(HDR, strain=1.0, temperature=t) for t in (23.0, -20.0))
    assert cold.strength > 1.2 * warm.strength
    assert bilinear_parameters(HDR, strain=1.0) == warm
    m = isothermal_cycle(HDR, 1.0)
    assert m.force_max_kN == pytest.approx(-m.force_min_kN, rel=1e-9)
    assert m.amplitude_mm == pytest.approx(30.0)
    whole = tb.run(HDR, tb.cyclic_test(strain=[1.0], cycles=1), 23.0).cycles.iloc[0]
    assert m.h_eq > whole["h_eq"]  # the first cycle begins without force


@pytest.mark.parametrize(
    ("name", "wave"),
    [("shen-hdr-specimen", "triangular"), ("shen-lhdr-specimen", "sine"), ("lrb-example", "sine")],
)
def test_wave_of_table_3_4_depends_on_the_lead(name: str, wave: str) -> None:
    case = make_case({}, "test", bearing=name)
    assert {step.wave for step in case.test.steps if step.step == "cycles"} == {wave}


def test_largest_mismatch_of_a_run_is_that_of_its_worst_step() -> None:
    """Far and cold: hardening is shared on the way back, and no more at the end."""
    sine = {"step": "cycles", "strain": 3.0, "wave": "sine", "period": 4.0, "count": 1}
    rest = {"step": "rest", "duration": 1.0}
    result = tb.run(HDR, tb.CyclicTest(dt=0.05, steps=[sine, rest]), -40.0)
    steps = result["layer_force_mismatch"].values[0]
    worst = float(result["layer_force_mismatch_max"].values[0])
    assert worst == steps.max() > 10.0 * steps[-1]
    assert int(result["softened_steps"].values[0]) == int((result["sharing_weight"] > 0.0).sum())


def test_history_has_the_steps_of_each_temperature_and_no_more() -> None:
    steps = [{"step": "ramp", "to_strain": 1.0, "duration": 1.0}, {"step": "rest", "within": 0.5}]
    test = tb.CyclicTest(dt=0.05, steps=steps)
    result = tb.run("shen-hdr-specimen", test, [-20.0, 40.0])
    kept = (result["segment"].values >= 0).sum(axis=1)
    assert kept[0] != kept[1]
    rows = "".join(_history_blocks(result)).splitlines()[1:]
    assert [sum(row.startswith(f"{t:g},") for row in rows) for t in (-20.0, 40.0)] == list(kept)
    assert not any("nan" in row for row in rows)


def test_waiting_for_a_temperature_ends_after_two_weeks() -> None:
    rest = Rest.model_validate({"step": "rest", "within": "0.1 K"})
    assert rest.span == 14 * 86400.0


@pytest.mark.parametrize("first", [10.0, -10.0])
def test_a_recording_starts_where_the_bearing_is(first: float, tmp_path: Path) -> None:
    path = tmp_path / "recorded.csv"
    path.write_text(f"time_s,displacement_mm\n0,{first}\n1,5\n2,0\n")
    recorded = Recorded(file=str(path))
    with pytest.raises(tb.InputError, match="insert a ramp before it"):
        recorded.points(0.0)
    gaps, x, _ = recorded.points(first)
    assert (list(gaps), list(x)) == ([1.0, 1.0], [first, 5.0, 0.0])


def test_backbone_is_the_slim_one_of_two() -> None:
    """Two loops have the stiffness and the damping; the other has nearly all of K_B in Q_d."""
    result = solve_backbone(2.0, 0.15, 100.0, 1.0 / 6.5)
    assert result is not None
    assert result.strength + result.post_yield * 100.0 == pytest.approx(200.0)
    yielding = result.strength / (result.initial - result.post_yield)
    area = 4.0 * result.strength * (100.0 - yielding)
    assert area == pytest.approx(2.0 * math.pi * 0.15 * 2.0 * 100.0**2)
    assert result.strength < 100.0


def test_labels_are_made_when_they_are_first_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    whole = dataset.labelled
    monkeypatch.setattr(dataset, "labelled", lambda *reported: made.append(1) or whole(*reported))
    result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1))
    assert made == []
    assert result.outcome == "completed"
    assert result["force"] is not None
    assert made == [1]


def test_a_cycle_without_heating_leaves_the_lead_at_its_temperature() -> None:
    """No cycle is softer than the one before: the strength of the lead is that at the ambient."""
    second, third = (isothermal_cycle("lrb-example", 1.5, 300.0, -20.0, k) for k in (2, 3))
    assert third.stiffness_kN_mm == pytest.approx(second.stiffness_kN_mm, rel=1e-9)
    assert third.energy_kN_mm == pytest.approx(second.energy_kN_mm, rel=1e-9)


def test_the_brief_table_has_the_cycles_that_codes_take(tmp_path: Path) -> None:
    """The first, the third and the last of each amplitude; cycles.csv has all."""
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=12, rest=None, dt=0.05)
    result = tb.run("shen-hdr-specimen", test, ambient=[23.0])
    table = cycles_table(result, brief=True)
    place = [column.name for column in table.columns].index("cycle")
    assert [cells[place] for cells in table.texts()] == ["1", "3", "12"] * 2
    stored = pd.read_csv(result.save(tmp_path / "out", figures=False) / "cycles.csv")
    assert list(stored) == list(result.cycles)
    assert stored["cycle"].tolist() == [*range(1, 13)] * 2
    assert_allclose(stored["h_eq"], result.cycles["h_eq"], rtol=1e-6)


def test_a_recording_and_its_mirror_image_have_the_same_cycles(tmp_path: Path) -> None:
    """Each cycle has one amplitude, whichever side the recording begins to."""
    t = np.linspace(0.0, 1.0, 101)
    levels = [size * np.sin(2.0 * np.pi * t[:-1]) for size in (10.0, 10.0, 25.0, 25.0)]
    x = np.append(np.concatenate(levels), 0.0)
    tables = []
    for side in (1.0, -1.0):
        path = tmp_path / f"side{side:g}.csv"
        rows = "".join(f"{0.02 * k},{side * value:.9f}\n" for k, value in enumerate(x))
        path.write_text(f"time [s],displacement [mm]\n{rows}")
        test = tb.CyclicTest(steps=[{"step": "recorded", "file": str(path)}])
        tables.append(tb.run("shen-hdr-specimen", test, ambient=[23.0]).cycles)
    one, other = tables
    assert_allclose(one["amplitude_strain"], np.array([10.0, 10.0, 25.0, 25.0]) / 30.0, rtol=1e-3)
    for name in ("amplitude_strain", "K_eq_kN_mm", "h_eq", "energy_kN_mm"):
        assert_allclose(other[name], one[name], rtol=tol.LOOP, err_msg=name)
    assert_allclose(other["stress_max_MPa"], -one["stress_min_MPa"], rtol=tol.LOOP)
