"""Imported frames: exact periods, effective masses, files of several forms, refused input."""

import json
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import command, last_line
from tests.verification.frames import (
    TWO_PIERS,
    pier_table,
    rocking_pier_table,
    written,
)
from thermobearing.border.errors import InputError
from thermobearing.core.records import Floats
from thermobearing.structure.frame import Element, Frame, ImportedFrame, Node

EI = 25e6 * 1.2  # kN m2 of the piers of tables
FIRST_ROOT = 1.8751040687  # of cos x cosh x = -1


def imported(folder: Path, text: str, name: str = "frame.csv") -> ImportedFrame:
    return tb.import_frame(written(folder, name, text))


def frame_periods(result: ImportedFrame) -> Floats:
    return np.array(result.periods["frame_period_s"])


def test_a_mass_on_a_cantilever_and_a_deck(tmp_path: Path) -> None:
    """Two masses in series on 3 EI/h^3 and the bearings: both models are exact."""
    height, pier, deck, bearing = 8.0, 200.0, 500.0, 15e3
    result = imported(tmp_path, pier_table([0.0, height], [10.0, pier], 1e-3 * bearing))
    column = 3.0 * EI / height**3
    stiffness = np.array([[column + bearing, -bearing], [-bearing, bearing]])
    squares = np.linalg.eigvals(np.linalg.solve(np.diag([pier, deck]), stiffness))
    exact = np.sort(2.0 * np.pi / np.sqrt(squares))[::-1]
    assert_allclose(result.periods["period_s"], exact, rtol=tol.SAME_FRAME)
    assert_allclose(frame_periods(result), exact, rtol=tol.SAME_FRAME)
    assert not result.warnings
    spring = result.structure.springs[0]
    assert spring.rotational_stiffness == pytest.approx(1e3 * 3 * EI / height, rel=tol.SAME_FRAME)
    assert result.mass == pytest.approx(0.71)  # with the 10 t at the base


def test_a_deep_footing_without_inertia(tmp_path: Path) -> None:
    """The rotation at the foot, 2 m below the column, moves the seat by F (h + 2)^2/k."""
    height, depth, spring = 8.0, 2.0, 5e6
    table = pier_table([0.0, height], [0.0, 200.0])
    table = table.replace("deck,0,", f"foot,0,{-depth!r},0\ndeck,0,")
    table = table.replace("0,1,25", "foot,0,,,\n0,1,25")
    table = table.replace("0,fixed,fixed,fixed", f"foot,fixed,fixed,{spring!r}")
    result = imported(tmp_path, table)
    moved = height**3 / (3.0 * EI) + (height + depth) ** 2 / spring
    assert [body.name for body in result.structure.bodies] == ["pier", "deck"]
    (one,) = result.structure.springs
    assert one.rotational_stiffness == pytest.approx(1e3 * height**2 / moved, rel=tol.SAME_FRAME)
    assert_allclose(result.periods["period_s"], frame_periods(result), rtol=tol.SAME_FRAME)


def test_a_footing_that_rocks_and_slides(tmp_path: Path) -> None:
    """Below a column with a mass at its top only, all modes are those of the frame."""
    result = imported(tmp_path, rocking_pier_table())
    assert [body.name for body in result.structure.bodies] == ["footing", "pier", "deck"]
    assert result.bodies["1"] == "footing"
    assert len(result.periods) == 4
    assert_allclose(result.periods["period_s"], frame_periods(result), rtol=tol.SAME_FRAME)
    assert not result.warnings


def test_a_uniform_cantilever_converges() -> None:
    """The first mode of a column of equal members, to that of the continuous beam, order two."""
    height, mass = 8.0, 10.0
    exact = 2.0 * np.pi / FIRST_ROOT**2 * np.sqrt(mass * height**4 / EI)
    errors = []
    for count in (8, 16, 32):
        size = mass * height / count
        masses = [0.5 * size, *[size] * (count - 1), 0.5 * size]
        nodes = {
            str(k): Node(0.0, height * k / count, (one, one, 0.0), "")
            for k, one in enumerate(masses)
        }
        members = [Element("", (str(k), str(k + 1)), (2e8, EI), "") for k in range(count)]
        modes = Frame("", nodes, members, {"0": (True, True, True)}).modes()
        errors.append(modes.periods[0] / exact - 1.0)
    order = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert_allclose(order, 2.0, atol=tol.ORDER)
    assert abs(errors[-1]) < tol.FRAME_CAP


def test_effective_mass_of_a_uniform_pier(tmp_path: Path) -> None:
    """(3/8)^2/(33/140) of the mass at 22/35 of the height, as of a beam with a force at its end."""
    count, height, mass = 64, 8.0, 300.0
    size = mass / count
    masses = [0.5 * size, *[size] * (count - 1), 0.5 * size]
    heights = np.linspace(0.0, height, count + 1).tolist()
    first, *rest, _ = imported(tmp_path, pier_table(heights, masses)).structure.masses
    assert 1e3 * first.mass == pytest.approx(9 / 64 * 140 / 33 * mass, rel=tol.FRAME_CAP)
    assert 1e-3 * first.height == pytest.approx(22 / 35 * height, rel=tol.FRAME_CAP)
    whole = 1e3 * sum(one.mass for one in (first, *rest))
    assert whole == pytest.approx(mass, rel=tol.SAME_FRAME)


def test_two_piers(tmp_path: Path) -> None:
    """Parts, springs of footings, a spring without inertia in series, and the first periods."""
    result = imported(tmp_path, TWO_PIERS)
    structure = result.structure
    assert [body.name for body in structure.bodies] == ["footing 1", "pier 1", "pier 2", "deck"]
    assert [(line.name, line.base, line.count) for line in structure.bearings] == [
        *(("A1", "ground", 2), ("P1", "pier 1", 4)),
        *(("P2", "pier 2", 4), ("A2", "ground", 2)),
    ]
    assert [line.x for line in structure.bearings] == [0.0, 25e3, 55e3, 80e3]
    sizes = {
        one.name: one.stiffness or one.rotational_stiffness or 0.0 for one in structure.springs
    }
    column = 3.0 * EI / 9.0
    expected = {
        "footing 1, sideways": 1200.0,
        "footing 1, rocking": 2e9,
        "pier 1, bending": 1e3 * column,
        "pier 2, bending": 1e3 / (1.0 / column + 1e-8),
    }
    assert sizes.keys() == expected.keys()
    assert_allclose([*sizes.values()], [expected[key] for key in sizes], rtol=tol.SAME_FRAME)
    assert result.mass == pytest.approx(1.53)
    ratio = result.periods["period_s"] / frame_periods(result)
    assert_allclose(result.periods["period_difference"], ratio - 1.0, rtol=0.0, atol=1e-15)
    far = np.abs(ratio - 1.0)
    assert far[:3].max() < tol.CONDENSED
    assert far[3] < 0.01
    assert far[4] > 0.05  # the footing rocks below a pier that bends otherwise
    assert result.periods["mode"].isna().tolist() == [False] * 5 + [True]
    assert_allclose(
        result.periods["effective_mass"][:4], result.periods["frame_effective_mass"][:4], atol=3e-3
    )
    differs, lost = result.warnings
    assert "0.0413 s" in differs
    assert "0.0186 s" in lost


def test_equal_piers_mix_their_modes(tmp_path: Path) -> None:
    """Modes of one period have any shapes; they are paired nevertheless."""
    lines: dict[str, list[str]] = {"nodes": [], "members": [], "supports": [], "bearings": []}
    for k in range(4):
        lines["nodes"] += [f"F{k},{40 * k},0,", f"T{k},{40 * k},8,150", f"D{k},{40 * k},8,400"]
        lines["members"] += [f"F{k},T{k},25,8,1.2", *([f"D{k - 1},D{k},25,6,4"] if k else [])]
        lines["supports"].append(f"F{k},fixed,fixed,fixed")
        lines["bearings"].append(f"B{k},T{k},D{k},4,2.0")
    heads = {
        "nodes": "node,x [m],z [m],mass [t]",
        "members": "from,to,E [GPa],A [m^2],I [m^4]",
        "supports": "node,x [kN/m],z [kN/m],rotation [kN m/rad]",
        "bearings": "bearing,lower,upper,count,stiffness [kN/mm]",
    }
    text = "".join("\n".join([name, heads[name], *rows, ""]) for name, rows in lines.items())
    periods = imported(tmp_path, text).periods
    own = periods[periods["mode"].notna()]
    assert own["mode"].tolist() == [1, 2, 3, 4, 5]
    assert np.abs(own["period_difference"]).max() < tol.CONDENSED


def test_a_workbook_is_as_a_text(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    sheet.title = "Cover"
    sheet.append(["Bridge 7"])
    for line in TWO_PIERS.replace(",", ".").splitlines():
        words: list[str | float] = []
        for word in line.split(";"):
            try:
                words.append(float(word))
            except ValueError:
                words.append(word)
        if len(words) == 1:
            sheet = book.create_sheet(str(words[0]).title())
        else:
            sheet.append(
                [int(word) if isinstance(word, float) and word % 1 == 0 else word for word in words]
            )
    book.save(tmp_path / "frame.xlsx")
    text, sheets = imported(tmp_path, TWO_PIERS), tb.import_frame(tmp_path / "frame.xlsx")
    own = {"description": text.structure.description}
    assert sheets.structure.model_copy(update=own) == text.structure
    assert sheets.periods.equals(text.periods)


def test_units_of_tables(tmp_path: Path) -> None:
    in_metres = imported(tmp_path, rocking_pier_table())
    in_millimetres = imported(tmp_path, rocking_pier_table("N", "mm", 1e3))
    for name in ("period_s", "frame_period_s", "effective_mass"):
        assert_allclose(in_millimetres.periods[name], in_metres.periods[name], rtol=tol.SAME_FRAME)
    masses, expected = (
        [[mass.mass, mass.height, mass.rotary_inertia] for mass in result.structure.masses]
        for result in (in_millimetres, in_metres)
    )
    assert_allclose(masses, expected, rtol=tol.SAME_FRAME, atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("C1;25;4;80;", "C1;25;four;80;", ["line 7", '"four"', "z"]),
        ("C1;25;4;80;", "C1;25;;80;", ["line 7", "z"]),
        ("C1;25;4;80;", "C1;25;4;-80;", ["line 7", "negative"]),
        ("C1;25;4;80;", "T1;25;4;80;", ["T1"]),
        ("mass [t]", "mass", ["line 2", '"mass"', "unit", "mass [t]"]),
        ("mass [t]", "mass [kN]", ["kN"]),
        ("mass [t]", "mas [t]", ['"mas [t]"', "mass [t]"]),
        ("bearing;lower", "bearing;under", ["line 33", "under", "upper"]),
        ("A1;A1;D0;2;1,5", "A1;A1;D0;two;1,5", ["line 34", "count"]),
        ("A1;A1;D0;2;1,5", "A1;A9;D0;2;1,5", ["line 34", '"A9"', "known: A1,"]),
        ("B1;C1;25;8;1,2", "B1;C1;25;8;", ["line 19", "I"]),
        ("B1;C1;25;8;1,2", "B1;B1;25;8;1,2", ["line 19", "length"]),
        ("B1;C1;25;8;1,2", "B1;C1;25;;", ["line 19", "I"]),
        ("mass [t];inertia [t m^2]", "mass [t];mass [t]", ["line 2", "twice"]),
        ("A1;fixed", "F1;fixed", ["line 30", "two supports"]),
        ("C1;T1;25;8;1,2", "C1;B1;25;8;1,2", ["line 20", "line 19"]),
        ("members\n", "", ["no part members"]),
        ("nodes\n", "", ["line 1", "nodes"]),
        ("F2;fixed;fixed;1e8\n", "", ["pier 2", "0 supported nodes"]),
        ("F2;fixed;fixed;1e8", "F2;fixed;fixed;", ["mechanism"]),
        ("F2;fixed;fixed;1e8", "F2;fixed;fixed;1e8\nC2;fixed;;", ["pier 2", "2 supported nodes"]),
        ("T2;55;9;120;", "T2;55;9;;", None),
        ("P2;T2;D2;4;2,0", "P2;T2;T1;4;2,0", ["line 36", "pier 1", "pier 2"]),
        ("D2;D3;25;6;4", "D2;D3;25;6;4\nT2;D2;;;", ["line 36", "pier 1", "pier 2"]),
        ("F1;1,2e6", "D3;fixed;;\nF1;1,2e6", ["deck", "D3"]),
    ],
)
def test_refused_tables(tmp_path: Path, old: str, new: str, words: list[str] | None) -> None:
    """A message names the file, the line and what is wrong; a pier may have no mass at its top."""
    assert old in TWO_PIERS
    text = TWO_PIERS.replace(old, new, 1)
    if words is None:
        assert imported(tmp_path, text).outcome == "completed"
        return
    with pytest.raises(InputError) as caught:
        imported(tmp_path, text)
    for word in ("frame.csv", *words):
        assert word in str(caught.value)


@pytest.mark.parametrize("name", ["pier.tcl", "pier.py"])
def test_scripts_are_refused_with_the_way_to_a_table(tmp_path: Path, name: str) -> None:
    """No script is read, whatever it contains; the message names the function of the guide."""
    with pytest.raises(InputError, match="write_frame") as caught:
        imported(tmp_path, TWO_PIERS, name)
    assert name in str(caught.value)


@pytest.mark.thorough
def test_the_command_writes_a_structure(tmp_path: Path) -> None:
    """Its file is one that `structures show` and analyses read; the answer has both periods."""
    table = written(tmp_path, "girder.csv", TWO_PIERS)
    done = command("structures", "import", table, "-o", tmp_path / "out", "--json")
    assert last_line(done)["outcome"] == "completed"
    folder = tmp_path / "out"
    result = tb.examine_structure(folder / "case.resolved.toml")
    expected = tb.import_frame(table)
    assert_allclose(result.table["period_s"], expected.table["period_s"], rtol=1e-15)
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["frame"][0]["frame_period_s"] == expected.periods["frame_period_s"][0]
    names = {path.name for path in (folder / "figures").iterdir()}
    assert names == {"frame.png", "model.png", "modes.png"}
    assert tb.make_report(folder, pdf=False)
    done = command("structures", "import", tmp_path / "none.csv")
    assert done.exit_code == 2
