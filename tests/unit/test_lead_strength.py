"""Lead that was never tested: peaks with other strengths; dead loads and what upper values omit."""

import tomllib
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.test_lines_and_piers import two_piers
from thermobearing.border.schema import validated
from thermobearing.earthquake.properties.lines import line_properties
from thermobearing.earthquake.properties.loads import dead_load_table, direction_note
from thermobearing.earthquake.properties.notes import lead_strength, left_out_note
from thermobearing.earthquake.properties.strength import (
    OF_STRENGTH,
    action_on_untested,
    run_strength_band,
    strength_sentence,
)
from thermobearing.earthquake.result import EarthquakeResult
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


def test_a_bridge_is_run_with_the_range_of_lead_that_was_never_tested(
    bridge: EarthquakeResult,
) -> None:
    """As with bearing files of these yield stresses; the action has the changes in per cent."""
    band = run_strength_band(bridge)
    assert band is not None
    assert (band.names, band.stresses, band.runs) == ([LRB], [7.0, 20.0], 2)
    weaker, stronger = (
        run_piers(tb.changed_bearing(LRB, lead={"yield_stress": stress})).table
        for stress in band.stresses
    )
    for column in OF_STRENGTH:
        expected = [table[column].max() for table in (bridge.table, weaker, stronger)]
        assert_allclose(band.peaks[column], expected)
    case = tomllib.loads(str(bridge.dataset.attrs["case"]))
    strains = np.array(band.peaks["bearing_strain_max"])
    changes = 100.0 * (strains / strains[0] - 1.0)
    assert np.ptp(changes) > 1.0
    text = action_on_untested(case, band)
    assert f"+{changes.max():.0f} %" in text
    assert LRB in text
    assert "2 more runs" in strength_sentence(band)


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
