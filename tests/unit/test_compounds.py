"""Compounds apart from bearings: every rule of size, new bearings, the library, bad input."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.bearing.compound import COMPOUNDS, Compound, _compound_from_table, as_compound
from thermobearing.bearing.scaling import build_bearing, extract_compound, lead_cores, resized
from thermobearing.border.toml import DIGITS, sourced_toml, to_table
from thermobearing.cli import app
from thermobearing.commands.check import check_file
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.design.sizing import damping_ratio, load_rubber, shear_modulus

NEW: dict[str, Any] = {
    "compound": "natural-rubber",
    "plan": "1000x1000mm",
    "layers": "20x8mm",
    "shim": "3mm",
    "lead": "180mm",
}
COMMAND = ["new", "pier", *(word for key, value in NEW.items() for word in (f"--{key}", value))]
PAIRS = {"shen-hdr": "shen-hdr-specimen", "shen-lhdr": "shen-lhdr-specimen"}


def made(**changes: Any) -> tb.Bearing:
    return tb.new_bearing("pier", **{**NEW, **changes})


@pytest.mark.parametrize("name", tb.list_bearings())
def test_a_bearing_of_its_own_compound_and_size_is_itself(name: str) -> None:
    bearing = tb.load_bearing(name)
    compound = extract_compound(bearing)
    assert resized(bearing, bearing.geometry).hysteresis == bearing.hysteresis
    again = build_bearing(
        compound, name, bearing.geometry, lead_cores(bearing), cells=bearing.cells
    )
    assert again.kind == bearing.kind
    before, after = (to_table(item) for item in (bearing, again))
    ranges = ("temperature_law", "tested_range")
    for key in ("geometry", "materials", "hysteresis", "lead", "cells", *ranges):
        assert after.get(key) == before.get(key), key
    if bearing.rate is not None:
        assert again.rate is not None
        for key in ("stiffness", "damping"):
            wanted = getattr(bearing.rate, key)
            assert getattr(again.rate, key) == pytest.approx(wanted, rel=tol.ROUNDING)


@pytest.mark.parametrize(("compound", "bearing"), PAIRS.items())
def test_the_compounds_of_the_source_are_those_of_its_specimens(
    compound: str, bearing: str
) -> None:
    shipped = tb.load_compound(compound)
    divided = extract_compound(tb.load_bearing(bearing))
    for table in ("rubber", "lead", "rate"):
        mine, theirs = getattr(shipped, table), getattr(divided, table)
        if theirs is None:
            assert mine is None
            continue
        for key, value in theirs.model_dump().items():
            reported = getattr(mine, key)
            number = isinstance(value, float)
            assert reported == (pytest.approx(value, rel=tol.SIX_DIGITS) if number else value)
    for table in ("materials", "temperature_law", "tested_range"):
        assert getattr(shipped, table) == getattr(divided, table), table
    assert set(shipped.sources) == set(divided.sources)


def test_every_rule_of_size() -> None:
    """Of the LHDR specimen's compound: layers 2.5 times as thick, 1.5 times as many, a plan of
    its own and cores of another size."""
    small = tb.load_bearing("shen-lhdr-specimen")
    large = tb.new_bearing(
        "large", small, plan="60x50cm", layers="9x12.5mm", shim="4mm", lead="60mm", cores=6
    )
    h, was = large.hysteresis, small.hysteresis
    assert small.lead
    assert small.rate
    assert large.lead
    assert large.rate
    area = (large.area - large.lead_area) / (small.area - small.lead_area)
    assert h.layer_stiffness == pytest.approx(area / 2.5 * was.layer_stiffness, rel=tol.ROUNDING)
    assert h.yield_displacement == pytest.approx(2.5 * was.yield_displacement, rel=tol.ROUNDING)
    same = ("post_yield_ratio", "shape", "hardening", "reference_temperature")
    exponents = ("elastic_temperature_coefficient", "hysteretic_temperature_coefficient")
    for key in (*same, *exponents):
        assert getattr(h, key) == getattr(was, key)
    core = (60.0 / 34.5) ** 2
    strength = large.lead.core_strength / small.lead.core_strength
    assert strength == pytest.approx(core, rel=tol.ROUNDING)
    wanted = core / 3.75 * small.lead.stiffness
    assert large.lead.stiffness == pytest.approx(wanted, rel=tol.ROUNDING)
    for key in ("stiffness", "damping"):
        wanted = area / 3.75 * getattr(small.rate, key)
        assert getattr(large.rate, key) == pytest.approx(wanted, rel=tol.ROUNDING)
    assert large.materials == small.materials
    assert large.geometry.plan.breadth == 600.0


def test_stress_at_a_strain_is_that_of_the_compound() -> None:
    sizes = (
        {"plan": "240x240mm", "layers": "6x5mm"},
        {"plan": "1000x600mm", "layers": "11x17mm"},
        {"diameter": "800mm", "layers": "3x30mm"},
    )
    cycles = [
        isothermal_cycle(tb.new_bearing("x", "shen-hdr", shim="3mm", **size), 1.5) for size in sizes
    ]
    for cycle in cycles[1:]:
        assert cycle.G_eq_MPa == pytest.approx(cycles[0].G_eq_MPa, rel=tol.LOOP)
        assert cycle.h_eq == pytest.approx(cycles[0].h_eq, rel=tol.OTHER_STEPS)


@pytest.mark.parametrize(
    ("kind", "stiffness", "damping", "printed"),
    [("hdr", 3.04, 0.182, (2.60, 0.170)), ("lhdr", 3.51, 0.223, (2.52, 0.297))],
)
def test_the_pairs_of_the_source_are_not_one_compound(
    kind: str, stiffness: float, damping: float, printed: tuple[float, float]
) -> None:
    """The numbers of docs/theory.md: the specimen at full size against the bridge bearing."""
    specimen, bridge = (tb.load_bearing(f"shen-{kind}-{size}") for size in ("specimen", "bridge"))
    made = resized(specimen, bridge.geometry, bridge.lead.diameter if bridge.lead else None)
    for bearing, (wanted, loss) in ((made, (stiffness, damping)), (bridge, printed)):
        cycle = isothermal_cycle(bearing, 178.0 / 102.0)
        assert cycle.stiffness_kN_mm == pytest.approx(wanted, abs=tol.SECOND_DECIMAL)
        assert cycle.h_eq == pytest.approx(loss, abs=tol.THIRD_DECIMAL)


def test_lead_as_a_ratio_of_stiffnesses() -> None:
    """lrb-example again: K_1 = 10 K_2."""
    example = tb.load_bearing("lrb-example")
    bearing = made(plan=None, diameter="700 mm", lead="150 mm")
    assert bearing.lead
    assert example.lead
    post_yield = bearing.hysteresis.layer_stiffness / 20
    assert bearing.lead.stiffness == pytest.approx(9.0 * post_yield, rel=tol.ROUNDING)
    assert bearing.lead.stiffness == pytest.approx(example.lead.stiffness, rel=tol.PRINTED_G)
    assert bearing.materials == example.materials
    two = made(cores=2)
    one = made()
    assert two.lead
    assert one.lead
    share = (two.area - two.lead_area) / (one.area - one.lead_area) / 2
    assert two.lead.stiffness == pytest.approx(share * one.lead.stiffness, rel=tol.ROUNDING)


def test_a_new_bearing_says_where_its_numbers_come_from(tmp_path: Path) -> None:
    bearing = made()
    assert bearing.sources["hysteresis.layer_stiffness"].startswith(
        "K_r = G_r A/t_r; compound natural-rubber"
    )
    assert bearing.sources["geometry.end_plate_thickness"] == "assumed; not given"
    assert made(end_plate="30 mm").sources["geometry.end_plate_thickness"] == "given"
    file = tmp_path / "pier.toml"
    file.write_text(sourced_toml(bearing, bearing.sources), encoding="utf-8")
    again = tb.load_bearing(file)
    assert to_table(again, DIGITS) == to_table(bearing, DIGITS)
    assert set(again.sources) == set(bearing.sources)


def test_a_bearing_is_its_compound(tmp_path: Path) -> None:
    """A fitted specimen, by its file, makes the same bearing as its compound."""
    file = tmp_path / "fit.toml"
    file.write_text(sourced_toml(tb.load_bearing("shen-lhdr-specimen"), {}), encoding="utf-8")
    size = {"plan": "500x500mm", "layers": "6x17mm", "shim": "3mm", "lead": "60mm"}
    by_file = tb.new_bearing("x", file, **size)
    by_name = tb.new_bearing("x", "shen-lhdr", **size)
    assert by_file.hysteresis.layer_stiffness == pytest.approx(
        by_name.hysteresis.layer_stiffness, rel=tol.SIX_DIGITS
    )
    compound = as_compound(file)
    assert not isinstance(compound, Compound)


@pytest.mark.parametrize(("kind", "grade"), [("HDR", "G8"), ("HDR", "G12"), ("HDR-S", "G10")])
def test_the_jra_compounds_meet_their_curves(kind: Any, grade: str) -> None:
    """As well as their files say; python -m benchmarks.jra_compounds looks at more strains."""
    name = f"jra-{kind}-{grade}".lower()
    output = tb.load_compound(name).sources["rubber.shear_modulus"]
    stiffness, damping = (float(word) / 100 for word in re.findall(r"within (\d+) %", output))
    bearing = tb.new_bearing(name, name, plan="500x500mm", layers="6x15mm", shim="3mm")
    curve = load_rubber(grade, kind)
    off = []
    for strain in (0.5, 1.0, 1.75, 2.5):
        cycle = isothermal_cycle(bearing, strain)
        off.append(cycle.G_eq_MPa / shear_modulus(curve, strain) - 1.0)
        assert cycle.h_eq == pytest.approx(damping_ratio(curve, strain), rel=damping)
    assert stiffness - 0.015 < max(map(abs, off)) < stiffness


@pytest.mark.parametrize("name", COMPOUNDS.names())
def test_built_in_compounds_are_checked_and_cited(name: str) -> None:
    compound = tb.load_compound(name)
    assert compound.citation
    table = to_table(compound)
    for key in (*(f"rubber.{k}" for k in table["rubber"]), "materials.rubber.conductivity"):
        assert key in compound.sources, key
    path = Path(tb.__file__).parent / f"data/compounds/{name}.toml"
    kind, facts, _ = check_file(path)
    assert (kind, facts["name"]) == ("compound", name)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"compound": "shen-hrd"}, ["compound", '"shen-hrd"', 'did you mean "shen-hdr"']),
        ({"plan": "1000x1000"}, ['plan = "1000x1000" has no unit', '"1000x1000mm"']),
        ({"plan": "10kNx10kN"}, ["plan", '"kN"', "mm"]),
        ({"plan": None}, ["give plan", "diameter"]),
        ({"layers": "20x8"}, ['layers = "20x8" has no unit', '"20x8mm"']),
        ({"layers": "2.5x8mm"}, ["layers", "number and thickness"]),
        ({"shim": "3"}, ["shim", "no unit", "3 mm"]),
        ({"lead": None}, ["natural-rubber", "needs lead"]),
        ({"compound": "shen-hdr"}, ["shen-hdr", "has no lead parameters"]),
        ({"lead": "1.2m"}, ["lead cores have an area", "the plan only 1e+06"]),
    ],
)
def test_bad_drawings(changes: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        made(**changes)
    for word in words:
        assert word in str(caught.value)


def test_faults_of_plates_and_cores_are_in_one_message() -> None:
    with pytest.raises(tb.InputError) as raised:
        made(sealing_plate=0.01, lead=2e4)
    assert 'new bearing "pier"' in str(raised.value)
    keys = ["geometry.sealing_plate_thickness", "lead.diameter"]
    assert [text.split()[0].rstrip(":") for text in raised.value.problems] == keys


@pytest.mark.parametrize("place", ["../pier", "pier.toml", "sub/pier"])
def test_a_new_bearing_in_another_folder(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here" / "sub").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    done = CliRunner().invoke(app, ["new", place, *COMMAND[2:]])
    assert done.exit_code == 0, done.output
    (file,) = tmp_path.rglob("*.toml")
    assert file == (tmp_path / "here" / place).resolve().with_suffix(".toml")
    assert tb.load_bearing(file).name == "pier"


def test_files_of_bearings_have_twelve_digits(tmp_path: Path) -> None:
    """36.0744696, not 36.07446959999999."""
    bearing = made(plan="870x910mm", layers="21x7.3mm")
    hysteresis = bearing.hysteresis.model_copy(update={"layer_stiffness": 36.07446959999999})
    bearing = bearing.model_copy(update={"hysteresis": hysteresis})
    file = tb.save_bearing(bearing, tmp_path / "pier.toml")
    numbers = re.findall(r"\d+\.\d+", file.read_text(encoding="utf-8"))
    assert "36.0744696" in numbers
    assert max(len(number.replace(".", "").lstrip("0")) for number in numbers) <= 12


@pytest.mark.parametrize("name", ["", "..", "a/b"])
def test_a_name_is_that_of_a_file(name: str) -> None:
    with pytest.raises(tb.InputError, match="name"):
        tb.new_bearing(name, **NEW)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"lead": {"yield_stress": "10 MPa"}}, ["either shear_modulus", "stiffness_ratio"]),
        ({"rubber": {"shear_modulus": 2.0}}, ["rubber.shear_modulus = 2.0", "has no unit", "MPa"]),
        ({"geometry": {}}, ["is a bearing, not a compound"]),
    ],
)
def test_bad_compounds(changes: dict[str, Any], words: list[str]) -> None:
    table = to_table(tb.load_compound("shen-hdr"))
    for key, value in changes.items():
        table[key] = {**table.get(key, {}), **value} if isinstance(value, dict) else value
    with pytest.raises(tb.InputError) as caught:
        _compound_from_table(table, "mine.toml")
    for word in (*words, "mine.toml"):
        assert word in str(caught.value)


def test_lead_of_a_compound_needs_its_material_and_a_ratio_linear_rubber() -> None:
    table = to_table(tb.load_compound("shen-lhdr"))
    del table["materials"]["lead"]
    with pytest.raises(tb.InputError, match=r"materials\.lead"):
        _compound_from_table(table, "mine.toml")
    table = to_table(tb.load_compound("shen-lhdr"))
    del table["lead"]["shear_modulus"]
    table["lead"]["stiffness_ratio"] = 10.0
    with pytest.raises(tb.InputError, match="linear"):
        _compound_from_table(table, "mine.toml")


def test_a_compound_where_a_bearing_is_wanted() -> None:
    path = Path(tb.__file__).parent / "data/compounds/shen-hdr.toml"
    with pytest.raises(tb.InputError, match="is a compound, not a bearing"):
        tb.load_bearing(path)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = CliRunner().invoke(app, [*COMMAND, "--json"])
    assert run.exit_code == 0, run.output
    assert "assumed" in run.output
    assert [path.name for path in tmp_path.iterdir()] == ["pier.toml"]
    assert to_table(tb.load_bearing("pier.toml"), DIGITS) == to_table(made(), DIGITS)
    again = CliRunner().invoke(app, COMMAND)
    assert (again.exit_code, "--overwrite" in again.output) == (2, True)
    assert CliRunner().invoke(app, [*COMMAND, "--overwrite", "-q"]).exit_code == 0
    for where in ("nowhere/a.toml", "."):
        failed = CliRunner().invoke(app, [*COMMAND, "-o", where])
        assert failed.exit_code == 2
        assert "Traceback" not in failed.output
    bad = CliRunner().invoke(app, [*COMMAND, "--layers", "20x8", "-o", "b.toml"])
    assert (bad.exit_code, "no unit" in bad.output) == (2, True)
    assert [path.name for path in tmp_path.iterdir()] == ["pier.toml"]


def test_new_lists_thermal_constants_that_nobody_measured(tmp_path: Path) -> None:
    """A compound from somebody's fit: heat constants are still those of the record it began with
    (before: listed only where the record itself said "assumed" or "borrowed")."""
    began = tb.load_compound("shen-hdr")
    keys = [key for key in began.sources if key.startswith("materials.")]
    assert len(keys) == 7
    measured = "materials.rubber.conductivity"
    reported = {**began.sources, measured: "hot wire, measured on a slab of the batch"}
    del reported["materials.side_film"]
    (tmp_path / "fit.toml").write_text(sourced_toml(began, reported), encoding="utf-8")
    words = [str(tmp_path / "fit.toml") if w == "natural-rubber" else w for w in COMMAND[:-2]]
    words += ["-o", str(tmp_path / "pier.toml"), "--json"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    output = json.loads(done.stdout.splitlines()[-1])["not_measured"]
    assert {key for key in output if key.startswith("materials.")} == {*keys} - {measured}
    assert output["materials.rubber.density"] == "compound shen-hdr; Table 4.1"
    assert "materials.rubber.specific_heat, density, materials.steel.conductivity" in done.stdout
