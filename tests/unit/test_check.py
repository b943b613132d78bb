"""`thermobearing check`: every file the package ships or writes is accepted, slips are named."""

import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.inputs import SPECIMEN, changed_table, specimen_table, write_toml
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.plausible import implausible, usual_values
from thermobearing.border.library import data_path
from thermobearing.border.schema import find_unit
from thermobearing.border.toml import to_toml
from thermobearing.cli import app
from thermobearing.commands.check import KINDS, LIBRARIES, check_file

SHIPPED = sorted(path for name in LIBRARIES for path in data_path(name).glob("*.toml"))
INPUTS = Path(__file__).parents[1] / "regression" / "inputs"
# All but one that goes on where another command's result ended.
READY = sorted(path for path in INPUTS.glob("*.toml") if path.stem != "restart")
LHDR = "shen-lhdr-specimen"
# One command of each kind of file that commands write.


@pytest.mark.parametrize("path", SHIPPED, ids=[path.stem for path in SHIPPED])
def test_every_shipped_file_is_accepted(path: Path) -> None:
    kind, facts, warnings = check_file(path)
    assert kind in KINDS
    assert facts
    assert warnings == []


def test_data_of_the_package_is_no_input() -> None:
    kinds = {check_file(path).kind for path in SHIPPED}
    assert {"bearing", "bilinear bearing", "structure", "rig", "climate", "study"} <= kinds
    with pytest.raises(tb.InputError, match="data of the package"):
        check_file(data_path("materials", "limits.toml"))


@pytest.mark.parametrize("path", READY, ids=[path.stem for path in READY])
def test_every_input_of_the_golden_cases_is_accepted(path: Path, tmp_path: Path) -> None:
    shutil.copytree(INPUTS, tmp_path / "in")
    shutil.copy(data_path("bearings", "lrb-example.toml"), tmp_path / "in" / "mine.toml")
    wanted = {"cold": "test record", "warm": "test record", "sequence": "sequence case"}
    wanted |= {"design": "design case", "design-lines": "design case", "weather": "earthquake case"}
    wanted |= {"laboratory": "earthquake case", "lines": "earthquake case"}
    wanted |= {"two-piers": "structure"}
    assert check_file(tmp_path / "in" / path.name).kind == wanted.get(path.stem, "case")


SLIPS: dict[str, tuple[dict[str, Any], str]] = {
    "K_r in N/mm": (
        {"hysteresis.layer_stiffness": "30738 kN/mm"},
        "shear modulus K_r t_r / A = 2668 MPa: the usual range is 0.2 to 15 MPa",
    ),
    "layers of 20 cm": (
        {"geometry.rubber_thickness": "20 cm", "hysteresis.yield_displacement": "60 mm"},
        "geometry.rubber_thickness = 200 mm: the usual range is 1.5 to 40 mm",
    ),
    "a conductivity of 310": (
        {"materials.rubber.conductivity": "310 W/(m K)"},
        "materials.rubber.conductivity = 310 W/(m K): the usual range is 0.1 to 0.6 W/(m K) (",
    ),
    "m_T of the wrong sign": (
        {"hysteresis.elastic_temperature_coefficient": 1.2},
        "elastic_temperature_coefficient = 1.2: the usual range is -5 to -0.1",
    ),
    "m_T per K": (
        {"hysteresis.elastic_temperature_coefficient": -0.0091},
        "elastic_temperature_coefficient = -0.0091: the usual range is -5 to -0.1",
    ),
    "n_T per K": (
        {"hysteresis.hysteretic_temperature_coefficient": -0.0219},
        "hysteretic_temperature_coefficient = -0.0219: the usual range is -8 to -0.1",
    ),
    "kJ for J": (
        {"materials.steel.specific_heat": "4320 J/(kg K)"},
        "materials.steel.specific_heat = 4320 J/(kg K)",
    ),
    "a film of 1160": ({"materials.side_film": "1160 W/(m^2 K)"}, "materials.side_film = 1160"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_named(slip: str, tmp_path: Path) -> None:
    changes, output = SLIPS[slip]
    file = write_toml(tmp_path / "mine.toml", changed_table(specimen_table(), changes))
    checked = check_file(file)
    assert checked.kind == "bearing"
    assert any(output in sentence for sentence in checked.warnings), checked.warnings
    mine = next(sentence for sentence in checked.warnings if output in sentence)
    assert "Usual cause: " in mine
    assert "Shen" in mine  # where the usual range is from


def test_slips_are_warnings_and_tell_the_bearing_of_a_case(tmp_path: Path) -> None:
    changes = SLIPS["a conductivity of 310"][0]
    bearing = write_toml(tmp_path / "mine.toml", changed_table(specimen_table(), changes))
    done = CliRunner().invoke(app, ["check", str(bearing)], env={"COLUMNS": "300"})
    assert done.exit_code == 0
    assert "warning: materials.rubber.conductivity = 310" in done.output
    case = tmp_path / "case.toml"
    case.write_text('command = "bridge"\nbearings = ["mine.toml", "shen-hdr-bridge"]\n')
    (sentence,) = check_file(case).warnings
    assert sentence.startswith(f"{SPECIMEN}: materials.rubber.conductivity")


def test_lead_and_backbones(tmp_path: Path) -> None:
    bearing = tb.load_bearing(LHDR)
    assert bearing.lead is not None
    slips = {"stiffness": 0.022, "yield_stress": 120.0, "softening": 0.069}
    odd = bearing.model_copy(update={"lead": bearing.lead.model_copy(update=slips)})
    keys = [sentence.split(" = ")[0] for sentence in implausible(odd)]
    assert keys == [
        "lead.yield_stress",
        "lead.softening",
        "shear modulus of a lead core K_l H / A_l",
    ]
    backbone = BilinearBearing(
        name="x",
        total_rubber_thickness=112.0,
        strength=125400.0,  # N for kN
        initial_stiffness=9.51,
        post_yield_stiffness=1.81,
    )
    file = tmp_path / "backbone.toml"
    file.write_text(to_toml(backbone))
    assert "yield displacement Q_d / (K_1 - K_2) = 1.629e+04 mm" in check_file(file).warnings[0]


def test_placeholders_are_no_slips() -> None:
    """A law that is all in a table has m_T = n_T = 0; linear rubber has no yield strain."""
    bearing = tb.load_bearing(SPECIMEN)
    table = {"temperatures": [-20, 40], "elastic": [1.4, 0.9], "hysteretic": [2, 0.8]}
    law = type(bearing.temperature_law)(**table)  # type: ignore[misc]
    none = {"elastic_temperature_coefficient": 0.0, "hysteretic_temperature_coefficient": 0.0}
    rubber = bearing.hysteresis.model_copy(update=none)
    assert len(implausible(bearing.model_copy(update={"hysteresis": rubber}))) == 2
    update = {"hysteresis": rubber, "temperature_law": law}
    assert implausible(bearing.model_copy(update=update)) == []
    both = bearing.model_copy(update={"temperature_law": law})
    (warned,) = implausible(both)
    assert "temperature_law" in warned
    assert f"m_T = {bearing.hysteresis.elastic_temperature_coefficient:g} " in warned
    result = tb.run(both, tb.cyclic_test(strain=0.5, cycles=1, dt=0.05))
    assert f"{SPECIMEN}: {warned}" in result.warnings


def test_usual_values_have_the_units_of_their_keys() -> None:
    for usual in usual_values():
        low, high = usual.ends
        assert low < high
        assert usual.unit == usual.largest.partition(" ")[2]
        model: Any = Bearing
        *tables, name = usual.key.split(".")
        if not tables:
            continue
        for table in tables:
            annotation = model.model_fields[table].annotation
            parts = getattr(annotation, "__args__", (annotation,))
            model = next(part for part in parts if hasattr(part, "model_fields"))
        assert (find_unit(model, name) or "") == usual.unit, usual.key


def test_what_a_bearing_was_tested_at_is_a_fact() -> None:
    facts = check_file(data_path("bearings", f"{SPECIMEN}.toml")).facts
    assert facts["tested at"].startswith(
        "strain 50 % to 250 %, strain rate 0.333/s to 1/s, ambient"
    )
    facts = check_file(data_path("bearings", "lrb-example.toml")).facts
    assert facts["tested at"] == "range not given (tested_range)"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"2615.3 N/mm"', '"2.6153 N/mm"', ["first period", "N/mm for kN/mm"]),
        ('"400 t"', '"400 kg"', ["mass of the deck = 0.4 t", "kg for t"]),
        ('"34839 kN m"', '"34839 N m"', ["pier base: yield moment", "N m for kN m"]),
        ('"0.309e-2 rad"', '"0.309 rad"', ["pier base: yield_rotation = 0.309 rad"]),
    ],
)
def test_slips_in_a_structure(tmp_path: Path, old: str, new: str, message: list[str]) -> None:
    text = (data_path("structures") / "pier-p1.toml").read_text()
    file = tmp_path / "mine.toml"
    file.write_text(text)
    assert check_file(file).warnings == []
    assert old in text
    file.write_text(text.replace(old, new))
    warnings = check_file(file).warnings
    for words in message:
        assert any(words in text for text in warnings), warnings
    case = tmp_path / "case.toml"
    case.write_text('structure = "mine.toml"\ncompound = "G8"\n')
    assert set(warnings) <= set(check_file(case).warnings)
    shown = CliRunner().invoke(app, ["structures", "show", str(file)])
    assert "Usual cause" in shown.output
