"""The library of bearings, and bearings with other numbers: sources, checks, round trips."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import SPECIMEN, changed_table, specimen_table, write_toml
from thermobearing.bearing.cells import Cells
from thermobearing.bearing.library import BEARINGS
from thermobearing.bearing.model import Bearing, Material
from thermobearing.border.schema import validated
from thermobearing.border.toml import to_table
from thermobearing.commands.check import check_file

TEXT_KEYS = {"name", "kind", "description", "citation"}


def entries(table: dict[str, Any], key: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and raw entries of a bearing file, down to {value, source}."""
    for name, value in table.items():
        dotted = f"{key}.{name}" if key else name
        if isinstance(value, dict) and "value" not in value:
            yield from entries(value, dotted)
        else:
            yield dotted, value


@pytest.mark.parametrize("name", tb.list_bearings())
def test_every_number_has_a_source(name: str) -> None:
    raw = dict(entries(BEARINGS.table(name)[0]))
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


@pytest.mark.parametrize("name", tb.list_bearings())
def test_table_round_trip(name: str, tmp_path: Path) -> None:
    bearing = tb.load_bearing(name)
    again = tb.load_bearing(write_toml(tmp_path / "again.toml", to_table(bearing)))
    assert again.model_dump() == bearing.model_dump()
    assert validated(Bearing, bearing.model_dump(), "dump", from_file=False) == again


def test_a_file_that_is_based_on_another_has_what_differs(tmp_path: Path) -> None:
    base = tb.load_bearing("shen-lhdr-specimen")
    touching = tb.load_bearing("shen-lhdr-in-touch")
    assert base.lead is not None
    assert touching.lead == base.lead.model_copy(update={"confined": False})
    assert touching.hysteresis == base.hysteresis
    assert touching.sources["lead.confined"].startswith("alternative")
    assert touching.sources["lead.diameter"] == base.sources["lead.diameter"]
    mine = {"name": "mine", "based_on": "above.toml", "geometry": {"rubber_thickness": "7 mm"}}
    path = write_toml(tmp_path / "mine.toml", mine)
    above = {"name": "above", "based_on": SPECIMEN, "geometry": {"rubber_layers": 4}}
    write_toml(tmp_path / "above.toml", above)
    assert tb.load_bearing(path).total_rubber_thickness == 28.0
    assert check_file(path).kind == "bearing"
    for base_of, output in (("mine.toml", "based on each other"), ("shen-x", "shen-x"), (3, "= 3")):
        write_toml(tmp_path / "above.toml", above | {"based_on": base_of})
        with pytest.raises(tb.InputError, match=output):
            tb.load_bearing(path)


def test_own_file_by_path_and_text(tmp_path: Path) -> None:
    table = changed_table(specimen_table(), {"geometry.rubber_thickness": "0.7 cm"})
    path = write_toml(tmp_path / "mine.toml", table)
    assert tb.load_bearing(path) == tb.load_bearing(str(path))
    assert tb.load_bearing(path).geometry.rubber_thickness == 7.0


def test_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    path = write_toml(tmp_path / "plain.toml", specimen_table())
    marked = tmp_path / "marked.toml"
    marked.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert tb.load_bearing(marked) == tb.load_bearing(path)


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
    assert geometry.first_shape_factor == pytest.approx(area / perimeter / 5.0, rel=tol.ROUNDING)


def test_numbers_of_lead_and_steel() -> None:
    """By hand from Tables 3.1 and 5.2: four cores of 34.5 mm, 12 MPa."""
    bearing = tb.load_bearing("shen-lhdr-specimen")
    assert bearing.lead is not None
    assert bearing.lead.radius == 17.25
    assert bearing.lead.core_area == pytest.approx(934.82, rel=1e-5)
    assert bearing.lead.core_strength == pytest.approx(11.2178, rel=1e-5)
    assert bearing.lead_area == pytest.approx(4 * 934.82, rel=1e-5)
    steel = Material(conductivity=43.0, specific_heat=461.0, density=7850.0)
    assert steel.volumetric_heat == pytest.approx(3.61885e-3, rel=tol.ROUNDING)  # J/(mm3 K)


@pytest.mark.parametrize("name", ["here.toml", "./here", "sub/here"])
def test_what_is_taken_for_a_path(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sub").mkdir()
    write_toml(tmp_path / name, specimen_table())
    monkeypatch.chdir(tmp_path)
    assert tb.load_bearing(name) == tb.load_bearing(tmp_path / name)
    assert tb.load_bearing(Path(name)).name == SPECIMEN


@pytest.mark.parametrize(("diameter", "fits"), [("270 mm", True), ("272 mm", False)])
def test_lead_must_leave_room_for_rubber(diameter: str, fits: bool, tmp_path: Path) -> None:
    """One core in a plan of 240 x 240 mm: 57 256 and 58 107 of 57 600 mm2."""
    table = to_table(tb.load_bearing("shen-lhdr-specimen"))
    path = write_toml(
        tmp_path / "b.toml", changed_table(table, {"lead.cores": 1, "lead.diameter": diameter})
    )
    if fits:
        assert tb.load_bearing(path).lead_area < tb.load_bearing(path).area
    else:
        with pytest.raises(tb.InputError, match="the lead cores have an area of 58106"):
            tb.load_bearing(path)


def test_bilinear_bearing_is_stiff_first() -> None:
    given = {"name": "b", "total_rubber_thickness": 100.0, "strength": 90.0}
    with pytest.raises(tb.InputError, match="must be greater than post_yield_stiffness"):
        tb.BilinearBearing(**given, initial_stiffness=2.0, post_yield_stiffness=2.0)
    assert tb.BilinearBearing(**given, initial_stiffness=2.0, post_yield_stiffness=1.9)


def test_what_is_read_once_is_nobodys_to_change() -> None:
    first, where = BEARINGS.table(SPECIMEN)
    first["geometry"]["rubber_layers"] = 1
    again, there = BEARINGS.table(SPECIMEN)
    assert (again, there) == (specimen_table(), where)


def test_what_is_reported_changes_and_nothing_else() -> None:
    before = tb.load_bearing(SPECIMEN)
    made = tb.changed_bearing(
        SPECIMEN, name="mine", hysteresis={"layer_stiffness": "40 kN/mm", "hardening": 0.3}
    )
    assert (made.name, made.hysteresis.layer_stiffness, made.hysteresis.hardening) == (
        "mine",
        40.0,
        0.3,
    )
    expected = before.model_dump()
    expected["name"] = "mine"
    expected["hysteresis"] |= {"layer_stiffness": 40.0, "hardening": 0.3}
    assert made.model_dump() == expected
    assert before == tb.load_bearing(SPECIMEN)  # untouched


def test_sources_follow_the_numbers() -> None:
    before = tb.load_bearing(SPECIMEN)
    made = tb.changed_bearing(before, hysteresis={"layer_stiffness": 40.0})
    assert made.sources["hysteresis.layer_stiffness"] == "changed, was 30.738"
    assert made.sources["hysteresis.hardening"] == before.sources["hysteresis.hardening"]


def test_plans_and_records_are_taken_whole() -> None:
    made = tb.changed_bearing(
        SPECIMEN,
        geometry={"plan": {"shape": "circular", "diameter": 270.0}},
        cells=Cells(rubber=4, shim=2),
        tested_range=None,
    )
    assert (made.geometry.plan.breadth, made.cells.rubber, made.tested_range) == (270.0, 4, None)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"hysteresis": {"layer_stiffness": -40.0}}, "hysteresis.layer_stiffness = -40.0"),
        ({"hysteresis": {"stiffnes": 1.0}}, 'unknown key "hysteresis.stiffnes"'),
        ({"hysteresis": {"layer_stiffness": 4e5}}, "shear modulus"),
        ({"lead": None, "kind": "LHDR"}, "needs the tables lead"),
    ],
)
def test_nonsense_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(tb.InputError, match="changed_bearing") as reported:
        tb.changed_bearing(SPECIMEN, **changes)
    assert message in str(reported.value)


def test_a_file_reads_back_and_is_not_written_over(tmp_path: Path) -> None:
    made = tb.changed_bearing("shen-lhdr-specimen", name="mine", lead={"yield_stress": 9.0})
    path = tb.save_bearing(made, tmp_path / "mine.toml")
    again = tb.load_bearing(path)
    assert again == made
    assert again.sources == made.sources
    with pytest.raises(tb.OutputError, match="overwrite=True"):
        tb.save_bearing(made, path)
    tb.save_bearing(tb.load_bearing(SPECIMEN), path, overwrite=True)
    assert tb.load_bearing(path).name == SPECIMEN


def test_assignment_says_what_to_do_instead() -> None:
    bearing = tb.load_bearing(SPECIMEN)
    with pytest.raises(
        tb.InputError, match=r"layer_stiffness: records are immutable.*changed_bearing"
    ):
        bearing.hysteresis.layer_stiffness = 40.0
