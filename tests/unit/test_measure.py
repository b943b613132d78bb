"""`thermobearing measure`: sidecars, rests, cycles told apart, columns not used."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.cli import app

STRENGTH = 30.0  # [kN]


def logged(path: Path, *, separator: str = ",", comma: bool = False) -> Path:
    """A logger of 20 Hz through three cycles with rests in which the force is lost."""
    rng = np.random.default_rng(1)
    turn = np.linspace(0.0, 2.0 * np.pi, 201)[:-1]
    x, force = 30.0 * np.sin(turn), 60.0 * np.sin(turn) + STRENGTH * np.cos(turn)
    still = np.arange(2000)
    lost = STRENGTH * np.exp(-still / 100.0)
    ways = np.concatenate([np.concatenate([x, 0.0 * still])] * 3)
    forces = np.concatenate([np.concatenate([force, lost])] * 3)
    ways, forces = ways + 0.02 * rng.normal(size=len(ways)), forces + 0.1 * rng.normal(size=6600)
    lines = [separator.join(["Zeit [s]", "Weg (mm)", "Last", "T_3"])]
    for k, (a, b) in enumerate(zip(ways, forces, strict=True)):
        line = separator.join([f"{0.05 * k:.2f}", f"{a:.4f}", f"{-1e3 * b:.3f}", "1"])
        lines.append(line.replace(".", ",") if comma else line)
    path.write_text("\n".join(lines))
    path.with_suffix(".toml").write_text(
        'flip_force = true\n[columns]\ndisplacement = "Weg (mm)"\nforce = "Last"\n'
        '[units]\nforce = "N"\n'
    )
    return path


@pytest.mark.parametrize("ending", [".csv", ".toml"])
@pytest.mark.parametrize(("separator", "comma"), [(",", False), (";", True)])
def test_sidecar_and_rests(tmp_path: Path, ending: str, separator: str, comma: bool) -> None:
    path = logged(tmp_path / "t.csv", separator=separator, comma=comma).with_suffix(ending)
    done = CliRunner().invoke(
        app, ["measure", str(path), "--bearing", "shen-hdr-specimen", "--json"]
    )
    assert done.exit_code == 0, done.output
    said = json.loads(done.stdout.splitlines()[-1])
    strengths = [cycle["characteristic_strength_kN"] for cycle in said["cycles"]]
    assert_allclose(strengths, STRENGTH, rtol=tol.FORCE_AT_A_REST)
    assert [cycle["ends"] for cycle in said["cycles"]] == ["rest"] * 3
    assert "columns not used: T_3" in said["notes"]
    assert "columns not used: T_3" in done.stdout


def test_a_unit_that_no_bearing_can_have_is_told(tmp_path: Path) -> None:
    """Before: 2000 MPa, without a word."""
    path = logged(tmp_path / "t.csv")
    sidecar = path.with_suffix(".toml")
    sidecar.write_text(sidecar.read_text().replace('"N"', '"kN"'))
    done = CliRunner().invoke(app, ["measure", str(path), "--bearing", "shen-hdr-specimen"])
    assert done.exit_code == 0, done.output
    assert "more than any bearing has; is force in N labelled kN" in done.stdout


def test_written_like_the_others(tmp_path: Path) -> None:
    """Before: on the screen only."""
    path, out = logged(tmp_path / "t.csv"), tmp_path / "out"
    words = ["measure", str(path), "--bearing", "shen-hdr-specimen", "-o", str(out)]
    done = CliRunner().invoke(app, [*words, "--json"])
    assert done.exit_code == 0, done.output
    said = json.loads(done.stdout.splitlines()[-1])
    assert said["output"] == str(out)
    saved = tb.load_result(out)
    assert (saved.command, saved.outcome) == ("measure", "completed")
    table = saved["cycles"]
    assert table["cycle"].tolist() == [1, 2, 3]
    assert table["ends"].tolist() == ["rest"] * 3
    told = [cycle["stiffness_kN_mm"] for cycle in said["cycles"]]
    assert_allclose(table["K_eq_kN_mm"], told, rtol=tol.ROUNDING)
    assert_allclose(table["strain"], 1.0, rtol=tol.FORCE_AT_A_REST)
    assert [path.name for path in saved.figures] == ["loops.png"]
    assert "columns not used: T_3" in saved.summary["notes"]
    again = CliRunner().invoke(app, words)
    assert (again.exit_code, "--overwrite" in again.output) == (2, True), again.output
    quiet = CliRunner().invoke(app, [*words, "--overwrite", "-q", "--no-figures"])
    assert (quiet.exit_code, quiet.output) == (0, "")
    assert not (out / "figures").exists()
