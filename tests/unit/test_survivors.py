"""Claims that random mutants of the code contradicted while no other test failed."""

import json
from types import SimpleNamespace
from typing import Any

import xarray as xr
from numpy.testing import assert_array_equal

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.border.toml import to_table
from thermobearing.climate.generator import MONTH_OF, ColdSpells, _spell_rate
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.dataset import INTERRUPTED, _interrupted
from thermobearing.reported import model_assumptions
from thermobearing.results.selection import gridded
from thermobearing.sequences import run as sequences


def test_cold_spells_begin_in_their_months_only() -> None:
    spells = ColdSpells(months=[1, 12], per_year=4.0, depth=6.0, length=96.0)
    begins = _spell_rate(spells) > 0.0
    assert set(MONTH_OF[begins]) == {0, 11}  # January is month 0 of the year
    assert begins[:744].all()
    assert begins[-744:].all()


def test_generated_weather_has_fifty_years_by_default() -> None:
    leap_days = 12
    hours = 24 * (50 * 365 + leap_days)
    assert len(tb.generate_weather("cold-town").temperature) == hours


def test_one_exposed_bearing_of_two_is_reported() -> None:
    fresh = to_table(tb.load_bearing("shen-hdr-specimen"))
    aged = fresh | {"exposure": {"years": 20}}
    pairs = ([aged, fresh], [fresh, aged], [aged, aged])
    counted, *same = (model_assumptions({}, pair) for pair in pairs)
    assert same == [counted, counted]
    assert counted != model_assumptions({}, [fresh, fresh])


def test_a_grid_of_two_labels_drops_other_coordinates_of_runs() -> None:
    labels = {"a": ("run", [1, 1, 2, 2]), "b": ("run", ["x", "y", "x", "y"])}
    other = {"number": ("run", [0, 1, 2, 3])}
    data = xr.Dataset({"peak": ("run", [1.0, 2.0, 3.0, 4.0])}, coords=labels | other)
    grid = gridded(data, ["a", "b"])
    assert_array_equal(grid["peak"].sel(a=2, b="y"), 4.0)
    assert set(grid.coords) == {"a", "b"}


def test_list_prints_text_without_json() -> None:
    done = command("list")
    assert done.exit_code == 0
    lines = done.stdout.strip().splitlines()
    assert not lines[-1].startswith("{")
    assert lines.count("") == 4  # between bearings, compounds, structures, laws and motions
    assert json.loads(command("list", "--json").stdout.strip().splitlines()[-1])


def test_progress_of_a_sequence_counts_from_one(monkeypatch: Any) -> None:
    ended = SimpleNamespace(outcome="completed")
    monkeypatch.setattr(sequences, "_run_part", lambda _: (ended, None))
    monkeypatch.setattr(sequences, "SequenceResult", lambda *_, **__: ended)
    case: Any = SimpleNamespace(parts=[1, 2], whole_part=lambda *_: None, between="as-left")
    calls: list[tuple[int, int]] = []
    sequences.run_sequence(case, progress=lambda *count: calls.append(count))
    assert calls == [(1, 2), (2, 2)]


def test_one_interrupted_run_of_several_interrupts_the_analysis() -> None:
    case = make_earthquake_case({}, "test", ambient=[23.0, 0.0], motions=["jra-ii-i-1"])
    count = len(case.bearings) * len(case.motions) * case.climates * len(case.modes)
    histories: list[Any] = [SimpleNamespace(outcome=0) for _ in range(count)]
    assert count > 1
    assert not _interrupted(count, histories)
    assert _interrupted(count, histories[:-1])
    histories[-1] = SimpleNamespace(outcome=INTERRUPTED)
    assert _interrupted(count, histories)
