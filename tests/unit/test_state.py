"""The state of the rubber: a monotone law between two limits, in every analysis, and reported."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.studies import small_study
from tests.unit.test_lead_strength import melted
from thermobearing.bearing.model import Bearing, Scragging
from thermobearing.bearing.state import RubberState, assumed, in_state, scragging_of
from thermobearing.border.errors import InputError
from thermobearing.cli import app
from thermobearing.cyclic.case import make_case
from thermobearing.cyclic.equivalent import bilinear_parameters
from thermobearing.design.bounds import bounds_study
from thermobearing.design.run import run_design, run_factors
from thermobearing.earthquake.analysis import run_other_bound
from thermobearing.earthquake.answer import main_results
from thermobearing.earthquake.report import build_pieces
from thermobearing.live.data import _fixed_numbers
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.shard import run_shard

HDR, LHDR, LRB = (
    tb.load_bearing(name) for name in ("shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example")
)
KNOWN = HDR.model_copy(update={"scragging": Scragging(amplitude=1.0, mullins_amplitude=0.2)})
TEST = tb.cyclic_test(strain=[1.0], cycles=3, rest=None, closing_strain=None, dt=0.02)
GOVERNING = (("jra-ii-i-2", 0.3), ("jra-ii-i-3", 0.3))  # motions with factors
BRIDGE: dict[str, Any] = {"motion": "jra-ii-i-1", "ambient": -20, "duration": 6}


def recovered(years: float, time_constant: float | None = None) -> RubberState:
    return RubberState(rubber="recovered", after=years, time_constant=time_constant)


def test_recovery_is_monotone_between_tested_and_virgin() -> None:
    years = np.concatenate([[0.0], np.geomspace(1e-6, 1000.0, 60)])
    for tau in (None, *(getattr(assumed().recovery, end) for end in ("lowest", "highest"))):
        share = np.array([recovered(float(t), tau).share for t in years])
        assert share[0] == 0.0
        assert share[-1] == 1.0
        assert np.all(np.diff(share) >= 0.0)
        assert np.all(np.diff(share[share < 0.999]) > 0.0)
        at = tau or assumed().recovery.time_constant
        assert recovered(at, tau).share == pytest.approx(1.0 - np.exp(-1.0))
    assert RubberState(rubber="tested").share == 0.0
    assert RubberState(rubber="virgin").share == 1.0


def forces(bearing: Bearing, state: Any) -> Any:
    return tb.run(bearing, TEST, 23.0, state=state)["force"].values


@pytest.mark.parametrize("bearing", [HDR, LHDR], ids=["HDR", "LHDR"])
def test_limits_of_the_state_have_the_same_bits(bearing: Bearing) -> None:
    plain = forces(bearing, None)
    for state in ("tested", "recovered after 0 days"):
        assert_array_equal(forces(bearing, state), plain)
    law, is_assumed = scragging_of(bearing)
    assert is_assumed
    virgin = forces(bearing.model_copy(update={"scragging": law}), None)
    for state in ("virgin", "recovered after 900 years"):
        assert_array_equal(forces(bearing, state), virgin)
    peaks = [np.abs(forces(bearing, f"recovered after {t} months")).max() for t in (1, 6, 24)]
    every = [np.abs(plain).max(), *peaks, np.abs(virgin).max()]
    assert np.all(np.diff(every) > 0.0)


def test_the_table_of_a_bearing_is_virgin_by_default_and_replaces_what_is_assumed() -> None:
    assert_array_equal(forces(KNOWN, "virgin"), forces(KNOWN, None))
    assert_array_equal(forces(KNOWN, "tested"), forces(HDR, None))
    half = in_state(KNOWN, recovered(0.1, 0.1 / np.log(2.0))).scragging
    assert half is not None
    assert (half.amplitude, half.mullins_amplitude) == pytest.approx((0.5, 0.1))
    assert half.strain == KNOWN.scragging.strain  # type: ignore[union-attr]
    assert not scragging_of(KNOWN)[1]


def test_assumed_scragging_is_as_stiff_as_published() -> None:
    """First-to-third force ratios of two compounds of a maker are 1.16 and 1.29."""
    for bearing, low, high in ((HDR, 1.25, 1.35), (LHDR, 1.1, 1.25), (LRB, 1.0, 1.1)):
        peaks = tb.run(bearing, TEST, 23.0, state="virgin").cycles["stress_max_MPa"]
        assert low < peaks.iloc[0] / peaks.iloc[2] < high, bearing.name
    assert_allclose(forces(LRB, "virgin"), forces(LRB, "tested"), rtol=tol.ROUNDING)


@pytest.mark.parametrize("bearing", [HDR, LHDR], ids=["HDR", "LHDR"])
def test_energy_balance_closes_in_every_state(bearing: Bearing) -> None:
    for state in ("virgin", "recovered after 3 months"):
        energy = tb.run(bearing, TEST, -20.0, state=state).energy.iloc[0]
        assert abs(energy["mechanical_residual"]) < tol.ENERGY_BALANCE
        assert abs(energy["thermal_residual"]) < tol.ENERGY_BALANCE


def test_lines_have_their_own_state() -> None:
    """A line without one keeps that of the analysis; of all lines it is the analysis' own."""
    name = "shen-hdr-bridge"
    structure = "five-span-girder"
    common = BRIDGE | {"structure": structure, "duration": 3}
    plain = tb.bridge(name, **common)
    lines = [str(line) for line in plain.lines["line"]]
    virgin = tb.bridge(name, **common, state="virgin")
    all_virgin = tb.bridge(
        name, **common, lines=[{"line": line, "state": "virgin"} for line in lines]
    )
    one = tb.bridge(name, **common, lines=[{"line": lines[0], "state": "virgin"}])
    back = tb.bridge(
        name, **common, state="virgin", lines=[{"line": line, "state": "tested"} for line in lines]
    )
    force = "line_force_max"
    assert_array_equal(all_virgin[force], virgin[force])
    assert_array_equal(back[force], plain[force])
    changed = (one[force].values != plain[force].values).reshape(-1)
    assert changed[0]
    ratio = (one[force].values / plain[force].values).reshape(-1)
    assert ratio[0] > 1.1
    assert np.all(ratio[1:] < 1.0)  # they give way to the stiffer line
    table = one.summary()["rubber_state"]
    assert list(table) == [f"{name} on {lines[0]}"]
    assert table[f"{name} on {lines[0]}"]["assumed"]
    assert "rubber_state" not in plain.summary()
    again = tb.bridge(
        name, **common, lines=[{"line": lines[0], "bearing": name, "state": "virgin"}]
    )
    assert_array_equal(again[force], one[force])


def test_governing_runs_have_the_other_bound() -> None:
    names, motions = ["shen-bilinear-bridge", "shen-hdr-bridge"], ["jra-i-i-1", "jra-ii-i-1"]
    case: dict[str, Any] = {"ambient": [23, -20], "duration": 8}
    tested = tb.bridge(names, motions, **case)
    bound = run_other_bound(tested)
    assert bound is not None
    assert (bound.state.rubber, bound.assumed) == ("virgin", True)
    virgin = tb.bridge(names, motions, state="virgin", **case)
    layered = tested.table["bearing"] == names[1]
    assert [peak.column for peak in bound.peaks] == ["bearing_force_max_kN", "pier_ductility"]
    assert set(bound.result["motion"].values.tolist()) == set(motions)
    assert {-20.0} <= set(bound.result.table["ambient_degC"]) <= {23.0, -20.0}
    rows = virgin.table[virgin.table["bearing"] == names[1]]
    for peak in bound.peaks:
        assert peak.place == tested.table[layered][peak.column].idxmax()
        at = rows["ambient_degC"].isin(set(bound.result.table["ambient_degC"]))
        assert bound.result.table[peak.column][peak.other_place] == rows[at][peak.column].max()
    ended = bound._replace(result=melted(bound.result, 0))
    assert "of which 1 did not complete (lead melted" in " ".join(main_results(tested, ended))
    assert "did not complete" not in " ".join(main_results(tested, bound))
    back = run_other_bound(virgin)
    assert back is not None
    assert (back.state.rubber, back.assumed) == ("tested", False)
    (peak,) = back.peaks
    strain = back.result.table["bearing_strain_max"][peak.other_place]
    assert strain == tested.table["bearing_strain_max"][layered].max()
    assert strain > virgin.table["bearing_strain_max"][peak.place]
    assert run_other_bound(tb.bridge(names[0], motions[0], **case)) is None
    assert run_other_bound(tb.bridge("lrb-example", motions[0], **case)) is None  # no excess
    answers = [build_pieces(result).answer for result in (tested, virgin)]
    assert [sum("more run" in text for text in answer) for answer in answers] == [1, 1]


def test_the_other_bound_may_govern_in_another_motion() -> None:
    """Scragged rubber has its largest force in one motion, virgin rubber in the other."""
    motions = [{"name": name, "factor": factor} for name, factor in GOVERNING]
    case: dict[str, Any] = {"ambient": [-20], "duration": 20}
    tested = tb.bridge("shen-hdr-bridge", motions, **case)
    bound = run_other_bound(tested)
    assert bound is not None
    virgin = tb.bridge("shen-hdr-bridge", motions, state="virgin", **case)
    force = "bearing_force_max_kN"
    (peak,) = [peak for peak in bound.peaks if peak.column == force]
    assert peak.place != peak.other_place
    assert bound.result.table[force][peak.other_place] == virgin.table[force].max()
    assert virgin.table[force][peak.place] < 0.99 * virgin.table[force].max()
    (sentence,) = [text for text in build_pieces(tested).answer if "virgin rubber" in text]
    named = [str(name) for name in tested["motion"].values]
    assert sentence.index(named[peak.other_place]) < sentence.index("instead of")
    assert sentence.index("instead of") < sentence.index(named[peak.place])


def test_energy_balance_of_a_bridge_on_virgin_rubber() -> None:
    result = tb.bridge(["shen-hdr-bridge", "shen-lhdr-bridge"], state="virgin", **BRIDGE)
    residual = result.energy["structure_residual"].abs().max()
    assert residual < tol.STRUCTURE_BALANCE


def test_study_varies_the_state() -> None:
    state = {"state": "recovered after 6 months"}
    factors: dict[str, Any] = {
        "bearing": ["shen-hdr-bridge"],
        "scale": [1.0],
        "case.analysis.state.after": {"of": "value", "levels": ["0 day", "0.5 year", "900 year"]},
    }
    study = small_study({"duration": "3 s", "analysis": state}, **factors)
    rows = Plan(study).runs
    assert list(rows["case.analysis.state.after"].unique()) == pytest.approx([0.0, 0.5, 900.0])
    alone = run_shard(Plan(study), rows)
    peaks = alone["bearing_strain_max"].to_numpy().reshape(2, 3)
    assert np.all(np.diff(peaks, axis=1) < 0.0)
    for place, words in ((0, "tested"), (2, "virgin")):
        ends = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], state=words, duration=3)
        assert_array_equal(ends.table["bearing_strain_max"], peaks[:, place])


@pytest.mark.thorough
def test_lines_with_their_own_state_in_lockstep_are_those_one_by_one() -> None:
    lines = [{"line": "A1", "state": "recovered after 6 months"}]
    case = {"duration": "3 s", "structure": "five-span-girder", "lines": lines}
    name = "case.lines[0].state.after"
    years = {"of": "value", "levels": ["0 year", "0.5 year"]}
    study = small_study(case, bearing=["shen-lhdr-bridge"], scale=[1.0], **{name: years})
    together = study.model_copy(
        update={"design": study.design.model_copy(update={"lockstep": True})}
    )
    rows = Plan(study).runs
    alone, lanes = run_shard(Plan(study), rows), run_shard(Plan(together), rows)
    for column in ("bearing_force_max_kN", "bearing_strain_max", "pier_displacement_max_mm"):
        assert_allclose(lanes[column], alone[column], rtol=tol.LANE_PEAK)
    lines[0]["state"] = "tested"
    result = tb.bridge(
        "shen-lhdr-bridge", "jra-ii-i-1", [23, -20], lines=lines, duration=3,
        structure="five-span-girder",
    )  # fmt: skip
    tested = alone[rows[name] == 0.0]
    assert_array_equal(tested["bearing_force_max_kN"], result.table["bearing_force_max_kN"])
    stiffer = alone[rows[name] == 0.5]["bearing_force_max_kN"].to_numpy()
    assert np.all(stiffer > tested["bearing_force_max_kN"].to_numpy())


def test_study_draws_the_time_constant_from_its_interval() -> None:
    """As the guide has it: the 90 % interval of data/scragging/assumed.toml."""
    recovery = assumed().recovery
    log_sd = np.log(recovery.highest / recovery.lowest) / (2.0 * 1.6448536)
    factor = {"of": "value", "distribution": "lognormal", "log_sd": float(round(log_sd, 2))}
    name = "case.analysis.state.time_constant"
    factors = {"bearing": ["shen-hdr-bridge"], "scale": [1.0], "ambient": ["23 degC"]}
    study = small_study(
        {"analysis": {"state": "recovered after 1 year"}},
        **factors,
        **{name: factor | {"median": f"{recovery.time_constant} year"}},
        design={"samples": 400, "kind": "latin-hypercube"},
    )
    drawn = Plan(study).runs[name]
    low, high = np.quantile(drawn, [0.05, 0.95])
    assert (low, high) == pytest.approx((recovery.lowest, recovery.highest), rel=0.2)


def test_unstated_state_does_not_change_ids_of_runs() -> None:
    """Those of a study before there was the key."""
    assert Plan(small_study()).runs["id"].iloc[0] == FIRST_ID
    stated = small_study({"analysis": {"state": "virgin"}})
    assert Plan(stated).runs["id"].iloc[0] != FIRST_ID


FIRST_ID = "0c829c2d0031868a"


@pytest.mark.parametrize(
    ("state", "words"),
    [
        ("vigrin", '"virgin"'),
        ("recovered after 5", "no unit"),
        ("recovered after 5 mm", "year"),
        ("recovered after -1 year", "at least 0"),
        ({"rubber": "recovered"}, "after"),
        ({"rubber": "virgin", "after": "1 year"}, "after"),
    ],
)
def test_wrong_states(state: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make_case({"bearing": "shen-hdr-specimen", "analysis": {"state": state}}, "case")


def test_states_that_cannot_be_had() -> None:
    with pytest.raises(InputError, match="bilinear"):
        tb.run("shen-hdr-specimen", TEST, model="bilinear", state="virgin")
    tb.run("shen-hdr-specimen", TEST, model="bilinear", state="tested")
    line = [{"line": "P1", "bearing": "shen-bilinear-bridge", "state": "virgin"}]
    with pytest.raises(InputError, match="no rubber"):
        tb.bridge("shen-hdr-bridge", structure="five-span-girder", lines=line, **BRIDGE)


def test_resolved_case_reads_back_to_the_same_state() -> None:
    table = {"bearing": "shen-hdr-specimen", "analysis": {"state": "recovered after 2 weeks"}}
    case = make_case(table, "case")
    again = tb.border.toml.tomllib.loads(case.to_toml())
    assert make_case(again, "case").analysis.state == case.analysis.state


def test_command_line(tmp_path: Path) -> None:
    words = "cyclic --bearing shen-hdr-specimen --strain 0.5 --cycles 1 --ambient 23 --no-figures"
    options = ["--state", "recovered after 1 year", "-o", str(tmp_path / "out"), "--quiet"]
    result = CliRunner().invoke(app, [*words.split(), *options])
    assert result.exit_code == 0, result.output
    summary = tb.load_result(tmp_path / "out").summary()
    assert summary["rubber_state"]["shen-hdr-specimen"]["share"] == pytest.approx(1 - np.exp(-2))
    assert any("assumed" in text for text in summary["warnings"])


def test_sequence_wears_virgin_rubber_once() -> None:
    cycles = [{"step": "cycles", "strain": 1.0, "count": 1, "speed": "60 mm/s"}]
    parts = [{"part": "cyclic", "steps": cycles, "dt": "20 ms"}] * 2
    peaks = {}
    for state in ("tested", "virgin"):
        result = tb.sequence({"bearing": "shen-hdr-specimen", "parts": parts}, state=state)
        peaks[state] = [float(part["force"].max()) for part in result.parts]
        assert sum("scragging" in text for text in result.warnings) == (state == "virgin")
        assert result.summary()["rubber_state"]["shen-hdr-specimen"]["state"] == state
    ratio = np.array(peaks["virgin"]) / np.array(peaks["tested"])
    assert ratio[0] > 1.2
    assert 1.0 < ratio[1] < ratio[0] - 0.05


def test_live_pages_compute_with_the_rubber_of_the_report() -> None:
    model = build_model(HDR, ModelOptions(state="virgin"))
    assert _fixed_numbers(HDR, model)["scragging_strain"] == assumed().high_damping.strain
    assert "scragging_strain" not in _fixed_numbers(HDR, build_model(HDR))


def test_element_and_options() -> None:
    constants = build_model(HDR, ModelOptions(state="virgin")).constants.rubber
    assert constants.virgin
    assert constants.scragging_amplitude == assumed().high_damping.amplitude
    trial = [tb.element("shen-hdr-specimen", state=s).set_trial(1.0, 0.1).force for s in WORDS]
    assert trial[1] > trial[0]


WORDS = ("tested", "virgin")


def test_lambda_has_the_bounds_of_both_states() -> None:
    report = run_factors(["shen-hdr-bridge"], strains=[1.75], temperatures=[-20.0])
    result = report._bounds.set_index("bound")
    assert list(result.index) == ["lower", "upper", "virgin"]
    assert result["Q_d_kN"].is_monotonic_increasing
    alone = run_factors(["shen-hdr-bridge"], strains=[1.75], temperatures=[-20.0], state="virgin")
    assert_array_equal(alone._bounds.drop(columns="bound"), report._bounds.drop(columns="bound"))
    first = alone.table.query("basis == 'first' and quantity == 'K_eq' and ambient_degC == -20")
    states = report.states.query("quantity == 'K_eq' and ambient_degC == -20")
    assert states["virgin"].iloc[0] == first["value"].iloc[0]
    assert 1.1 < states["ratio"].iloc[0] < 1.4
    assert {"bounds", "states"} <= set(report.tables())
    rubber = run_factors(["lrb-example"], strains=[1.0], temperatures=[-20.0])
    assert len(rubber.states) == 0
    assert list(rubber._bounds["bound"]) == ["lower", "upper"]


def test_bounds_compare_both_states() -> None:
    case: dict[str, Any] = {"duration": 8}
    table = bounds_study("shen-hdr-bridge", "jra-ii-i-1", [23.0, -20.0], **case)
    virgin = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], state="virgin", **case)
    rows = table.set_index("demand")
    for column in ("bearing_force_max_kN", "bearing_strain_max"):
        assert rows["other_coupled_max"][column] == virgin.table[column].max()
    assert set(table["other_state"]) == {"virgin"}
    force = rows.loc["bearing_force_max_kN"]
    assert force["other_coupled_max"] > force["coupled_max"]
    ends = force[["lower_bound", "upper_bound", "other_bound"]].max()
    both = max(force["other_coupled_max"], force["coupled_max"])
    assert force["envelope_over_both"] == pytest.approx(ends / both)
    back = bounds_study("shen-hdr-bridge", "jra-ii-i-1", [23.0, -20.0], state="virgin", **case)
    assert set(back["other_state"]) == {"tested"}
    assert_array_equal(back["other_coupled_max"], table["coupled_max"])
    assert_array_equal(back["coupled_max"], table["other_coupled_max"])
    assert_array_equal(back["other_bound"], table["lower_bound"])


def test_first_cycle_of_virgin_rubber_is_the_upper_bound() -> None:
    virgin = in_state(HDR, RubberState(rubber="virgin"))
    one, three = (bilinear_parameters(virgin, cycle=cycle) for cycle in (1, 3))
    assert one.strength > 1.1 * three.strength
    assert one.post_yield > 1.1 * three.post_yield


def test_design_checks_virgin_rubber() -> None:
    case: dict[str, Any] = {"motions": ["jra-ii-i-1"], "ambient": ["-20 degC"], "dt": "10 ms"}
    result = run_design(case, templates=[tb.load_bearing("shen-hdr-bridge")])
    assert result.usable
    (tested,), (virgin,) = (
        table.to_dict("records") for table in (result.temperatures, result.virgin)
    )
    assert virgin["force_kN"] > tested["force_kN"]
    assert virgin["displacement_mm"] < tested["displacement_mm"]
    assert len(result.summary()["both_states"]) == 1
    assert "virgin" in result.tables()
