"""The library of bearings: everything loads, every number has a source, nothing gets lost."""

import tomllib
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import SPECIMEN, changed_table, specimen_table, write_toml
from thermobearing.bearing.model import Bearing
from thermobearing.border.schema import validated
from thermobearing.border.toml import to_table

TEXT_KEYS = {"name", "kind", "description", "citation"}


def entries(table: dict[str, Any], key: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and raw entries of a bearing file, down to {value, source}."""
    for name, value in table.items():
        dotted = f"{key}.{name}" if key else name
        if isinstance(value, dict) and "value" not in value:
            yield from entries(value, dotted)
        else:
            yield dotted, value


@pytest.mark.parametrize("name", tb.bearing.list_bearings())
def test_every_number_has_a_source(name: str) -> None:
    file = resources.files("thermobearing") / "data" / "bearings" / f"{name}.toml"
    raw = dict(entries(tomllib.loads(file.read_text(encoding="utf-8"))))
    sourced = set(raw) - TEXT_KEYS
    assert len(sourced) >= 20
    for key in sourced:
        assert isinstance(raw[key], dict), f"{key} has no source"
        assert raw[key]["source"].strip(), f"{key} has an empty source"
        if raw[key]["source"] == "assumed":
            assert raw[key]["note"], f"{key} is assumed without a reason"
    bearing = tb.load_bearing(name)
    assert set(bearing.sources) == sourced
    assert bearing.name == name
    assert bearing.citation
    assert bearing.description


@pytest.mark.parametrize("name", tb.bearing.list_bearings())
def test_table_round_trip(name: str, tmp_path: Path) -> None:
    bearing = tb.load_bearing(name)
    again = tb.load_bearing(write_toml(tmp_path / "again.toml", to_table(bearing)))
    assert again.model_dump() == bearing.model_dump()
    assert validated(Bearing, bearing.model_dump(), "dump", from_file=False) == again


def test_numbers_of_the_specimen() -> None:
    bearing = tb.load_bearing(SPECIMEN)
    assert bearing.area == 57600.0
    assert bearing.total_rubber_thickness == 30.0
    assert bearing.geometry.plan.perimeter == 960.0
    assert bearing.sources["hysteresis.shape"] == "Table 4.2"
    assert bearing.sources["geometry.plan.side"].startswith("Table 3.1; ")


def test_own_file_by_path_and_text(tmp_path: Path) -> None:
    table = changed_table(specimen_table(), {"geometry.rubber_thickness": "0.7 cm"})
    path = write_toml(tmp_path / "mine.toml", table)
    assert tb.load_bearing(path) == tb.load_bearing(str(path))
    assert tb.load_bearing(path).geometry.rubber_thickness == 7.0


def test_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    """Windows editors write one, and TOML has no use for it."""
    path = write_toml(tmp_path / "plain.toml", specimen_table())
    marked = tmp_path / "marked.toml"
    marked.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert tb.load_bearing(marked) == tb.load_bearing(path)


def test_bearings_are_frozen() -> None:
    bearing = tb.load_bearing(SPECIMEN)
    with pytest.raises(ValueError, match="frozen"):
        bearing.geometry.rubber_layers = 5
    bearing.sources.clear()
    assert bearing.sources


@pytest.mark.parametrize(
    ("plan", "area", "perimeter", "breadth"),
    [
        ({"shape": "square", "side": "200 mm"}, 40000.0, 800.0, 200.0),
        ({"shape": "rectangular", "length": "20 cm", "width": "100 mm"}, 2e4, 600.0, 200.0),
        ({"shape": "circular", "diameter": "200 mm"}, 31415.926535897932, 628.3185307179587, 200.0),
    ],
)
def test_plans(
    plan: dict[str, str], area: float, perimeter: float, breadth: float, tmp_path: Path
) -> None:
    table = changed_table(specimen_table(), {"geometry.plan": plan})
    geometry = tb.load_bearing(write_toml(tmp_path / "b.toml", table)).geometry
    assert geometry.plan.area == pytest.approx(area, rel=tol.ROUNDING)
    assert geometry.plan.perimeter == pytest.approx(perimeter, rel=tol.ROUNDING)
    assert geometry.second_shape_factor == breadth / 30.0
