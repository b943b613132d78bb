"""`thermobearing structures`: a structure drawn and told before it is shaken."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.inputs import command, last_line
from tests.unit.test_lines_and_piers import bridge_of, two_piers
from thermobearing.border.toml import to_toml
from thermobearing.structure.figures import lay_out
from thermobearing.structure.model import load_structure


def test_show_writes_parts_periods_and_figures(tmp_path: Path) -> None:
    out = tmp_path / "pier"
    done = command("structures", "show", "pier-p1", "-o", str(out), "--json")
    assert done.exit_code == 0
    assert last_line(done)["outcome"] == "completed"
    files = {path.name for path in out.rglob("*") if path.is_file()}
    assert {"summary.json", "parts.csv", "periods.csv", "model.png", "modes.png"} <= files
    told = json.loads((out / "summary.json").read_text())
    assert told["structure"] == "pier-p1"
    assert told["reported_line"] == "G1-G5"
    assert_allclose(told["mass_t"], 973.8)
    assert [mode["mode"] for mode in told["modes"]] == [1, 2, 3, 4]
    assert "pier base" in done.stdout
    assert load_structure(out / "case.resolved.toml") == load_structure("pier-p1")


def test_show_without_a_directory_and_a_bad_name(tmp_path: Path) -> None:
    done = command("structures", "show", "hybrid-pier", "--json")
    assert last_line(done)["modes"][0]["mode"] == 1
    done = command("structures", "show", "pier-p2")
    assert done.exit_code == 2
    assert 'did you mean "pier-p1"' in done.stderr
    done = command("structures", "show", "pier-p1", "--mass", "heavy")
    assert done.exit_code == 2
    assert "mass = 'heavy': must be one of consistent, published" in done.stderr
    done = command("structures", "list")
    assert "pier-p1" in done.stdout
    own = tmp_path / "two.toml"
    own.write_text(to_toml(bridge_of(two_piers())))
    done = command("structures", "show", str(own), "--fixed-base")
    assert done.exit_code == 2
    assert "no body stands on springs" in done.stderr


def test_effective_masses_are_all_mass_that_moves() -> None:
    """And the modes of two unlike piers are those of the matrices."""
    result = tb.examine_structure(bridge_of(two_piers()))
    assert_allclose(result.effective_masses.sum(), 1.0, rtol=1e-9)
    shapes = result.table[result.prepared.matrices.coordinates].to_numpy()
    assert_allclose(np.abs(shapes).max(axis=1), 1.0)
    assert isinstance(result.parts, pd.DataFrame)
    assert set(result.parts["part"]) == {"mass", "spring", "hinge", "bearings"}


def test_piers_stand_side_by_side_and_the_deck_lies_over_them() -> None:
    layout = lay_out(bridge_of(two_piers()))
    assert layout.columns["A"] < layout.columns["deck"] < layout.columns["B"]
    assert layout.ends["A"] == (0.0, 10.0)
    assert layout.ends["deck"][0] > 10.0
    assert layout.scaled
    assert not lay_out(load_structure("hybrid-pier")).scaled


@pytest.mark.parametrize("name", ["pier-p1", "hybrid-pier"])
def test_figures_say_every_part(name: str) -> None:
    result = tb.examine_structure(name)
    (ax,) = result.plot.model().axes
    shown = " ".join(text.get_text() for text in ax.texts)
    for part in result.parts["name"]:
        assert part in shown
    assert len([a for a in result.plot.modes().axes if a.get_visible()]) == len(result.table)


ON_THE_GROUND = """name = "mass"
[[bodies]]
name = "deck"
moves = true
[[masses]]
body = "deck"
height = "0 m"
mass = "200 t"
[[bearings]]
name = "bearings"
body = "deck"
base = "ground"
count = 4
equivalent_stiffness = "2 kN/mm"
[report]
deck = "deck"
"""


def test_a_mass_on_the_ground_has_no_pier(tmp_path: Path) -> None:
    """Before: report.pier and report.pier_top were asked for."""
    path = tmp_path / "mass.toml"
    path.write_text(ON_THE_GROUND)
    assert load_structure(path).report.has_pier is False
    words = ["bridge", "--structure", str(path), "--bearing", "shen-hdr-bridge", "--ambient", "0"]
    words += ["--motion", "jra-ii-i-1", "--duration", "0.5", "-o", str(tmp_path / "out")]
    done = command(*words)
    assert done.exit_code == 0, done.output
    assert "pier mm" not in done.stdout
    assert "ductility" not in done.stdout
    text = path.read_text()
    path.write_text(
        text.replace(
            'name = "deck"\n', 'name = "pier"\nmoves = true\n[[bodies]]\nname = "deck"\n'
        ).replace('"ground"', '"pier"')
    )
    with pytest.raises(tb.InputError, match=r"report\.pier: which body is the pier"):
        load_structure(path)
