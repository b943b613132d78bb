"""States that cannot be true end with a typed outcome: temperatures, energy, lead that melts."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit.inputs import changed_table, cyclic, last_line, quick_case, specimen_table
from thermobearing.bearing.library import bearing_from_table
from thermobearing.core.types import State, new_state
from thermobearing.cyclic.protocol import LARGEST_STRAIN
from thermobearing.design.run import run_bounds, run_factors
from thermobearing.earthquake.report import build_pieces
from thermobearing.model.earlier import Model
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.outcomes import (
    ALL_SENTENCES,
    INTERRUPTED,
    NAMES,
    NOT_PHYSICAL,
    PIER_BEYOND_LIMIT,
    SENTENCES,
    is_physical,
    temperature_limits,
)
from thermobearing.quantities.words import plain
from thermobearing.report.pieces import EXCEEDED
from thermobearing.structure.run import (
    DISPLACEMENT_LIMIT,
    FORCE_LIMIT,
    IMPLAUSIBLE_ENERGY,
    IMPLAUSIBLE_FORCE,
    IMPLAUSIBLE_STIFFNESS,
    OUTCOMES,
    SENSOR_STUCK,
    SPECIMEN_LOST,
    Method,
)
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.shard import run_shard
from thermobearing.studies.statistics.demand import counted
from thermobearing.studies.tables import count_failures

LIMITS = temperature_limits()
LEAD = "shen-lhdr-specimen"
MELTED = "lead_melted"
FAST = tb.CyclicTest(
    steps=[{"step": "cycles", "strain": 1.5, "wave": "sine", "period": 1.0, "count": 60}]
)


def test_lead_does_not_heat_beyond_its_melting_point() -> None:
    """Lead of constant strength goes on heating; what was computed until it melts is kept."""
    result = tb.run(tb.changed_bearing(LEAD, law="constant-lead"), FAST, ambient=23.0)
    assert result.outcome == MELTED
    hottest = float(result["lead_temperature"].max())
    assert 0.95 * LIMITS.lead_melts < hottest <= LIMITS.lead_melts
    assert str(int(LIMITS.lead_melts)) in SENTENCES[result.outcome]
    for limit in (LIMITS.absolute_zero, LIMITS.rubber_decomposes):
        assert str(int(limit)) in SENTENCES["temperature_runaway"]
    rows = result.bearing_checks
    assert rows["verdict"].tolist() == ["NG", "NG"]
    assert_allclose(rows["value"], LIMITS.lead_melts)
    assert_allclose(rows["limit"], [LIMITS.lead_melts, 0.8 * LIMITS.lead_melts])


def test_lead_beyond_its_tests_softens_before_it_melts() -> None:
    """The published rate is the default beyond the tests: before, this run ended with melted lead.

    Its last rows are a check that is not met.
    """
    result = tb.run(LEAD, FAST, ambient=23.0)
    hottest = float(result["lead_temperature"].max())
    assert result.outcome == "completed"
    assert 96.0 < hottest < LIMITS.lead_melts
    melting, near = result.bearing_checks.to_dict("records")
    assert melting["verdict"] == "OK"
    assert (near["value"], near["verdict"]) == (hottest, "NG" if hottest > near["limit"] else "OK")


def test_rubber_does_not_heat_beyond_its_decomposition() -> None:
    blind = dict.fromkeys(
        (f"hysteresis.{name}_temperature_coefficient" for name in ("elastic", "hysteretic")), 0.0
    )
    changes = {"hysteresis.layer_stiffness": "500 kN/mm", **blind}
    table = changed_table(specimen_table(), changes)
    result = tb.run(bearing_from_table(table, "stiff"), FAST, ambient=23.0)
    assert result.outcome == "temperature_runaway"
    assert 200.0 < float(result["rubber_temperature"].max()) <= LIMITS.rubber_decomposes
    assert "decomposes" in SENTENCES[result.outcome]


def make_table(dump: dict[str, Any]) -> dict[str, Any]:
    """A dumped bearing as a table with units, for `bearing_from_table`."""
    from thermobearing.bearing.model import Bearing
    from thermobearing.border.schema import validated
    from thermobearing.border.toml import to_table

    return to_table(validated(Bearing, dump, "dump", from_file=False))


def test_a_run_that_is_not_physical_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A typed outcome, exit status 3, and what was computed until then; here steel melts early."""
    early = LIMITS.model_copy(update={"steel_melts": 20.0})
    monkeypatch.setattr("thermobearing.model.outcomes.temperature_limits", lambda: early)
    case = quick_case(tmp_path / "case.toml", ambient="23 degC")
    done = cyclic(case, "-o", tmp_path / "out", "--json")
    output = last_line(done)
    assert (output["outcome"], done.exit_code) == (NOT_PHYSICAL, 3)
    assert "energy balance" in done.stderr
    assert np.isfinite(tb.load_result(tmp_path / "out")["force"]).all()


@pytest.mark.parametrize("dt", [0.005, 1.0, 10.0])
def test_a_rest_does_not_ring(dt: float) -> None:
    """Long first steps would throw a plate from one side of the ambient temperature to the other.

    42 degC were reached on the way from -20 to 23 degC.
    """
    rest = tb.CyclicTest(dt=dt, steps=[{"step": "rest", "duration": 4500.0}])
    result = tb.run("shen-hdr-bridge", rest, 23.0, initial=-20.0)
    assert float(result["temperature"].min()) >= -20.0
    assert float(result["temperature"].max()) <= 23.0


def test_a_bearing_that_would_tear_in_an_earthquake() -> None:
    """Beyond 500 %, where a test may not go either."""
    motion = {"name": "jra-ii-i-1", "factor": 8.0}
    study = tb.bridge("shen-hdr-bridge", motion, 23, duration=15)
    assert float(study["bearing_strain_max"][0]) > 5.0
    assert study.outcome == NOT_PHYSICAL
    assert "500 %" in study.sentence
    assert json.dumps(study.summary(), allow_nan=True)


def test_a_bilinear_bearing_has_no_heat_to_lose() -> None:
    """Its endless heat capacity times the rounding of a temperature came to kN mm a step."""
    motion = {"name": "jra-ii-i-1", "factor": 0.02}
    study = tb.bridge("shen-bilinear-bridge", motion, [-20.0, 23.0], duration=5)
    assert study.energy["thermal_residual"].abs().max() < tol.ENERGY_BALANCE
    assert study["bearing_force"].values[0].tolist() == study["bearing_force"].values[1].tolist()


@pytest.mark.parametrize("factor", [0.001, 0.1])
def test_the_bilinear_model_of_a_layered_bearing_may_stay_elastic(factor: float) -> None:
    """A step of 1e-3 kN mm is below the rounding of -20 degC times its heat capacity."""
    motion = {"name": "jra-ii-i-1", "factor": factor}
    bearings = ["shen-hdr-bridge", "shen-lhdr-bridge"]
    study = tb.bridge(bearings, motion, -20, model="bilinear", duration=5)
    assert study.dataset["outcome"].values.tolist() == ["completed"] * 2
    assert study["bearing_strain_max"].max() < 0.02


HDR = tb.load_bearing("shen-hdr-specimen")
MODEL = build_model(HDR)


def line_state(**response: float) -> State:
    """100 kN mm of work, 70 of them heat: 20 stored, 30 lost at the ends, 20 at the sides."""
    state = new_state(MODEL.constants, np.full(len(MODEL.stack.part), 20.0))
    given = {
        "work_in": 100.0, "heat_released": 70.0, "recoverable": 30.0, "heat_stored": 20.0,
        "heat_lost_ends": 30.0, "heat_lost_sides": 20.0, **response,
    }  # fmt: skip
    for name, value in given.items():
        setattr(state.response[0], name, value)
    return state


@pytest.mark.parametrize("cell", [0, -1])
@pytest.mark.parametrize(
    ("degrees", "possible"), [(-273.0, True), (-274.0, False), (1499.0, True), (1501.0, False)]
)
def test_temperatures(cell: int, degrees: float, possible: bool) -> None:
    state = line_state()
    state.temperature[cell] = degrees
    assert is_physical(MODEL.constants, state) is possible


def test_nan_is_not_physical() -> None:
    state = line_state()
    state.temperature[3] = np.nan
    assert not is_physical(MODEL.constants, state)
    assert not is_physical(MODEL.constants, line_state(work_in=np.nan))


@pytest.mark.parametrize("name", ["work_in", "recoverable", "heat_stored", "heat_lost_ends",
                                  "heat_lost_sides"])  # fmt: skip
@pytest.mark.parametrize(("missing", "possible"), [(0.09, True), (0.2, False), (-0.2, False)])
def test_energy_balance(name: str, missing: float, possible: bool) -> None:
    """0.1 % of the largest energy may be missing, in either balance and either way."""
    state = line_state()
    setattr(state.response[0], name, getattr(state.response[0], name) + missing)
    assert is_physical(MODEL.constants, state) is possible


def test_published_balances_have_gaps_of_their_own() -> None:
    published = build_model(HDR, ModelOptions(scheme="published")).constants
    assert is_physical(published, line_state(heat_stored=50.0))
    hot = line_state()
    hot.temperature[:] = 2000.0
    assert not is_physical(published, hot)


CYCLES = {"step": "cycles", "strain": 2.5, "speed": 1000.0, "count": 60}
HOT = tb.CyclicTest(dt=0.02, steps=[CYCLES])


@pytest.fixture(scope="module")
def shake(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """A sine near the period of a pier on its bearings, far beyond any earthquake."""
    file = tmp_path_factory.mktemp("motion") / "sine.csv"
    t = np.arange(0.0, 20.0, 0.01)
    a = 500.0 * np.sin(2.0 * np.pi * t / 1.2)
    rows = "\n".join(f"{x:.2f},{y:.3f}" for x, y in zip(t, a, strict=True))
    file.write_text(f"t_s,acc_gal\n{rows}\n")
    return {"name": str(file), "factor": 3.0}


def test_the_sentence_says_so() -> None:
    assert "327 degC" in SENTENCES[MELTED]


@pytest.mark.parametrize("model", ["multi-layer", "adiabatic", "lead-alone", "temperature-blind"])
def test_cyclic(model: Model) -> None:
    result = tb.run(LEAD, HOT, model=model)
    assert (result.outcome, result.sentence) == (MELTED, SENTENCES[MELTED])
    assert 320.0 < np.nanmax(result["lead_temperature"]) <= 327.5


@pytest.mark.parametrize("method", quick_cases(["average-acceleration", "predictor-corrector"], 0))
def test_structures(method: Method, shake: dict[str, object]) -> None:
    """With Newmark's method halving the step does not cool the lead (before: no_equilibrium)."""
    study = tb.bridge("shen-lhdr-bridge", shake, 23.0, method=method)
    assert study.outcome == MELTED
    assert any("lead 327" in text and "above the 96 degC" in text for text in study.warnings)
    rows = study.bearing_checks
    assert rows["verdict"].tolist() == ["NG", "NG"]
    assert_allclose(rows["value"], LIMITS.lead_melts)
    pieces = build_pieces(study)
    assert SENTENCES[MELTED].split(",")[0] in pieces.answer[0].replace(" °C", " degC")
    exceeded = [check.what for check in pieces.checks if check.verdict == EXCEEDED]
    assert {plain(what) for what in rows["what"]} <= set(exceeded)


def test_studies_count_melted_lead_as_failed_and_name_it_first() -> None:
    outcomes = ["completed", *["pier_beyond_limit"] * 3, MELTED, "completed"]
    table = pd.DataFrame({"run": range(6), "outcome": outcomes, "sentence": "", "demand": 1.0})
    table["pier_ductility"] = 1.0
    failures = count_failures(table)
    assert failures["outcome"].tolist() == [MELTED, "pier_beyond_limit"]
    assert failures["runs"].tolist() == [1, 3]
    # The hinge law is not valid beyond the limits of the pier; the run goes on to the end.
    for demand, failed, counts in (
        ("demand", "computed", (1, 0)),
        ("demand", "left-out", (4, 0)),
        ("demand", "collapse", (0, 4)),
        ("pier_ductility", "computed", (1, 3)),
        ("pier_ductility", "left-out", (1, 3)),
        ("pier_ductility", "collapse", (0, 4)),
    ):
        runs = counted(table, demand, failed)
        assert (runs.left_out, runs.collapsed) == counts, (demand, failed)
        assert np.isfinite(runs.demand).sum() == 2 + runs.computed
        assert f"4 of {len(table)} runs failed" in runs.sentence


@pytest.mark.parametrize("lockstep", [False, True])
def test_a_study_has_every_limit_that_a_run_passed(
    shake: dict[str, object], lockstep: bool
) -> None:
    """The lead melts in three runs; two of them have passed 500 % and the limits of the pier."""
    table = {
        "kind": "study",
        "name": "limits",
        "case": {"structure": "pier-p1"},
        "design": {"lockstep": lockstep},
        "factors": {
            "bearing": ["shen-lhdr-bridge"],
            "motion": [shake["name"]],
            "scale": [0.02, 1.5, 3.0, 6.0],
            "ambient": ["23 degC"],
        },
    }
    plan = Plan(make_study(table, "test"))
    runs = run_shard(plan, plan.runs)
    assert runs["outcome"].tolist() == ["completed", *[MELTED] * 3]
    strain = runs["bearing_strain_max"] > LARGEST_STRAIN
    assert strain.tolist() == [False, False, True, True]
    torn = "strain lead_temperature pier"
    assert runs["limits_passed"].tolist() == ["", "lead_temperature", torn, torn]
    (row,) = count_failures(runs).to_dict("records")
    assert (row["runs"], row["also"][:2]) == (3, "2 ")
    (without,) = count_failures(runs.drop(columns="limits_passed")).to_dict("records")
    assert without["also"] == row["also"].partition(" and ")[0]


def test_validation(tmp_path: Path) -> None:
    t = np.arange(0.0, 12.0, 0.005)
    x = 75.0 * np.sin(2.0 * np.pi * t / 0.3)
    record = tb.record_from_arrays(t, x, 3.0 * x + 90.0 * np.sign(np.gradient(x)), 23.0)
    result = tb.validate_bearing(LEAD, record)
    assert list(result.table["outcome"]) == [MELTED]
    assert result.outcome == "partly"
    assert SENTENCES[MELTED] in result.sentence
    assert result.summary()["comparisons"][0]["outcome"] == MELTED


def test_factors_and_bounds(shake: dict[str, object]) -> None:
    with pytest.raises(tb.InputError, match=r"lead_melted at 250%: "):
        run_factors([LEAD], temperatures=[0.0], strains=[2.5], speed=1000.0, cycles=[100])
    pier = tb.load_structure("pier-p1")
    limits = pier.limits.model_copy(update={"ductility": 1000.0, "drift": 1.0})
    pier = pier.model_copy(update={"limits": limits})  # or the pier ends the run before
    report = run_bounds(["shen-lhdr-bridge"], [shake], [23.0, 0.0], structure=pier)
    assert report.outcome == MELTED
    assert report.summary()["outcome"] == MELTED
    assert report.sentence == SENTENCES[MELTED]


def test_every_outcome_has_a_sentence() -> None:
    assert set(SENTENCES) == {*NAMES.values(), NOT_PHYSICAL, INTERRUPTED}
    laboratory = {SPECIMEN_LOST, FORCE_LIMIT, DISPLACEMENT_LIMIT, SENSOR_STUCK}
    laboratory |= {IMPLAUSIBLE_FORCE, IMPLAUSIBLE_STIFFNESS, IMPLAUSIBLE_ENERGY}
    others = {*OUTCOMES.values(), PIER_BEYOND_LIMIT, *laboratory}
    assert set(ALL_SENTENCES) == {*SENTENCES, *others}
