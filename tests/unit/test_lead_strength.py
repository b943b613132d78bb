"""Lead that was never tested: peaks with other strengths; dead loads and what upper values omit."""

import tomllib
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.test_lines_and_piers import two_piers
from thermobearing.border.schema import validated
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.properties import peaks, strength, trials
from thermobearing.earthquake.properties.bridge import nominal_note
from thermobearing.earthquake.properties.lines import line_properties
from thermobearing.earthquake.properties.links import trials_note
from thermobearing.earthquake.properties.loads import dead_load_table, direction_note
from thermobearing.earthquake.properties.notes import lead_strength, left_out_note, with_bounds
from thermobearing.earthquake.properties.peaks import settle_bridge, step_note
from thermobearing.earthquake.properties.strength import (
    OF_STRENGTH,
    action_on_untested,
    run_strength_band,
    strength_sentence,
)
from thermobearing.earthquake.properties.trials import try_links
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.checks import FAILED, PASSED
from thermobearing.model.outcomes import MELTED, NOT_PHYSICAL
from thermobearing.reported import governing_checks
from thermobearing.structure.fields import GRAVITY
from thermobearing.structure.model import Structure

LRB, HDR = "lrb-example", "shen-hdr-bridge"
MOTION: dict[str, Any] = {"name": "jra-ii-i-1", "factor": 0.4}


def run_piers(bearing: Any, **options: Any) -> EarthquakeResult:
    structure = validated(Structure, two_piers(), "test")
    lines = [{"line": "on A", "bearing": HDR}]
    return tb.bridge(bearing, MOTION, 23.0, structure=structure, lines=lines, duration=8, **options)


@pytest.fixture(scope="module")
def bridge() -> EarthquakeResult:
    return run_piers(LRB)


@pytest.fixture(scope="module")
def bridge_of_two() -> EarthquakeResult:
    structure = validated(Structure, two_piers(), "test")
    motions = [MOTION, MOTION | {"name": "jra-ii-i-2"}]
    lines = [{"line": "on A", "bearing": HDR}]
    return tb.bridge(LRB, motions, 23.0, structure=structure, lines=lines, duration=8)


def test_a_bridge_is_run_with_the_range_of_lead_that_was_never_tested(
    bridge: EarthquakeResult,
) -> None:
    """As with bearing files of these yield stresses; the action has the changes in per cent."""
    band = run_strength_band(bridge)
    assert band is not None
    assert (band.names, band.stresses, band.runs) == ([LRB], [7.0, 20.0], 2)
    (comparison,) = band.comparisons
    assert (comparison.stresses, comparison.compared) == (band.stresses, band.of_analysis)
    assert not band.early
    weaker, stronger = (
        run_piers(tb.changed_bearing(LRB, lead={"yield_stress": stress})).table
        for stress in band.stresses
    )
    for column in OF_STRENGTH:
        expected = [table[column].max() for table in (bridge.table, weaker, stronger)]
        assert_allclose(comparison.peaks[column], expected)
    case = tomllib.loads(str(bridge.dataset.attrs["case"]))
    strains = np.array(comparison.peaks["bearing_strain_max"])
    changes = 100.0 * (strains / strains[0] - 1.0)
    assert np.ptp(changes) > 1.0
    text = action_on_untested(case, band)
    assert f"+{changes.max():.0f} %" in text
    assert LRB in text
    assert "2 more runs" in strength_sentence(band)


def melted(result: EarthquakeResult, run: int) -> EarthquakeResult:
    """Return a result in which the lead of a run melted."""
    outcomes = result["outcome"].values.astype(object)
    outcomes[run] = MELTED
    return EarthquakeResult(result.dataset.assign(outcome=("run", outcomes)))


def test_a_run_that_melts_is_named_and_compared_with_nothing(
    bridge_of_two: EarthquakeResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The largest peak of fewer runs is not compared with that of all of them."""
    table = bridge_of_two.table
    worst = int(table["bearing_strain_max"].idxmax())

    def _run(case: EarthquakeCase) -> EarthquakeResult:
        result = run_earthquake(case)
        stress = case.bearings[0].lead.yield_stress  # type: ignore[union-attr]
        return melted(result, worst) if stress > 7.0 else result

    monkeypatch.setattr(strength, "run_earthquake", _run)
    band = run_strength_band(bridge_of_two)
    assert band is not None
    (early,) = band.early
    assert (early.stress, early.outcome) == (20.0, MELTED)
    all_runs, fewer = band.comparisons
    strain = "bearing_strain_max"
    assert (all_runs.stresses, all_runs.compared) == ([7.0], 2)
    assert (fewer.stresses, fewer.compared) == ([20.0], 1)
    assert all_runs.peaks[strain][0] == table[strain][worst]
    assert fewer.peaks[strain][0] == table[strain][1 - worst]
    case = tomllib.loads(str(bridge_of_two.dataset.attrs["case"]))
    for text in (strength_sentence(band), action_on_untested(case, band)):
        assert f"lead melts in {table['motion'][worst]} at 23 °C" in text
        assert f"{100.0 * early.strain:.0f} % until then" in text
        assert "1 run " in text


def test_a_run_with_another_outcome_at_half_the_step_does_not_settle(
    bridge_of_two: EarthquakeResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other motion alone has the design peak: it may differ by little."""
    lesser = int(bridge_of_two.table["bearing_strain_max"].idxmin())
    monkeypatch.setattr(peaks, "run_earthquake", lambda case: melted(run_earthquake(case), lesser))
    settled = settle_bridge(bridge_of_two)
    assert settled.runs
    assert settled.halvings == 3  # two that agree, after the one that changes the outcome
    assert set(settled.differences.values()) == {np.inf}
    assert "another outcome" in step_note(settled)


def test_links_name_the_runs_that_they_leave_out(
    bridge_of_two: EarthquakeResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    coupled = settle_bridge(bridge_of_two)._replace(result=melted(bridge_of_two, 1))
    monkeypatch.setattr(
        trials, "settle_case", lambda case, first, *_: coupled._replace(first=first, result=first)
    )
    lines = with_bounds(line_properties(bridge_of_two))
    tried = try_links({str(lines["state"].iloc[0]): coupled}, lines)
    (name,) = set(tried.left_out)
    assert str(bridge_of_two.table["motion"][1]) in name
    assert name in trials_note(tried)


def test_a_torn_bearing_is_named_with_its_line(bridge: EarthquakeResult) -> None:
    """The name of a run begins with the bearing of the analysis, which A does not carry."""
    torn = bridge.dataset.assign(
        bearing_strain_max=bridge["bearing_strain_max"] * 0.0 + 5.1,
        line_strain_max=bridge["line_strain_max"] * 0.0 + [5.1, 1.0],
        outcome=("run", [NOT_PHYSICAL]),
    ).assign_attrs(outcome=NOT_PHYSICAL)
    sentence = EarthquakeResult(torn).sentence
    assert f"510 % (line on A with {HDR}, jra-ii-i-1" in sentence
    assert LRB not in sentence


def test_failed_checks_name_all_lines_that_fail() -> None:
    columns = {"run": "lrb, DE, 23 degC", "bearing": "lrb", "code": "", "what": "load"}
    columns |= {"value": 2.0, "limit": 1.0, "least": False, "unit": "kN", "used": 2.0}
    rows = [columns | {"part": part, "verdict": FAILED} for part in ("P1", "P2", "P3", "P4")]
    passing = columns | {"part": "A1", "verdict": PASSED, "used": 0.5}
    for count, name in ((1, "P1"), (2, "P1 and P2"), (4, "P1 and 3 more")):
        governing = governing_checks(pd.DataFrame([passing, *rows[:count]]), every_part=False)
        assert governing["part"].tolist() == [name]


def test_nominal_stiffness_says_what_it_changes(bridge: EarthquakeResult) -> None:
    """Modal damping is of the structure without its bearings."""
    assert bridge.dataset.attrs["damping"] == "modal"
    assert nominal_note(bridge).endswith("for these modes only")
    element = EarthquakeResult(bridge.dataset.assign_attrs(damping="element"))
    assert nominal_note(element).endswith("for damping")


def test_lead_that_was_tested_needs_no_range() -> None:
    result = tb.bridge("shen-lhdr-bridge", MOTION, 23.0, duration=2)
    assert run_strength_band(result) is None
    assert action_on_untested(tomllib.loads(str(result.dataset.attrs["case"])), None) == ""


def test_dead_loads_are_compared_with_the_weight_of_the_deck() -> None:
    structure = validated(Structure, two_piers(), "test")
    deck = structure.report.deck
    weight = GRAVITY * sum(item.mass for item in structure.masses if item.body == deck)
    bearings = sum(line.count for line in structure.bearings)
    for factor, text in ((1.0, ""), (1.12, "12 % more"), (0.9, "10 % less")):
        result = run_piers(LRB, axial_force=factor * weight / bearings)
        table = dead_load_table(result)
        assert len(table.rows) == len(structure.bearings)
        assert sum(float(row[-1]) for row in table.rows) == pytest.approx(factor * weight)
        assert text in table.note
        assert ("Compare masses" in table.note) == bool(text)


def test_one_direction_is_said_to_be_one(bridge: EarthquakeResult) -> None:
    assert not dead_load_table(bridge).rows
    assert "100 % of one and 30 %" in direction_note(bridge)


def test_upper_values_name_what_they_leave_out(bridge: EarthquakeResult) -> None:
    lines = line_properties(bridge)
    note = left_out_note(lines)
    rate = f"{100.0 * lead_strength().rate:.0f} %"
    assert all(word in note for word in ("ageing", "contamination", "crystallization", rate))
    assert rate not in left_out_note(lines[~lines["has_lead"].astype(bool)])
    assert left_out_note(lines.iloc[:0]) == ""
