"""Structures as scripts of OpenSees: periods and histories of the scripts, and errors."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import needs_opensees, ops
from tests.quick import quick_cases
from tests.reference.opensees_pier import elastic_pier
from tests.unit.inputs import command
from tests.verification.structures import read_ground
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.core.types import Floats
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure import run
from thermobearing.structure.model import Damping, Structure, along, list_structures, load_structure

DT, STEPS = 0.01, 800
BEARING = load_bilinear("shen-bilinear-bridge")


def written(structure: Structure | str, folder: Path, **given: Any) -> tuple[list[str], str]:
    """Return the remarks and the text of a script in Python."""
    remarks = tb.opensees.write_structure(structure, folder / "model.py", **given)
    return remarks, (folder / "model.py").read_text()


def executed(text: str) -> Floats:
    """Run a script; return its periods [s]."""
    assert ops.wipe  # the libraries that the script needs are loaded
    names: dict[str, Any] = {}
    exec(compile(text, "model.py", "exec"), names)
    return np.array(names["periods"])


@needs_opensees
def test_periods_are_those_of_the_structure(tmp_path: Path, measured: Recorder) -> None:
    worst = 0.0
    bridge = load_structure("five-span-bridge")
    one_way = [along(bridge, "x"), along(bridge, "y")]
    for number, one in enumerate([*map(load_structure, list_structures()), *one_way]):
        folder = tmp_path / str(number)
        folder.mkdir()
        theirs = executed(written(one, folder)[1])
        ours = run.prepare_structure(one).modes.periods
        worst = max(worst, float(np.abs(theirs / ours - 1.0).max()))
    assert worst < tol.OPENSEES_SCRIPT_PERIODS
    measured(
        "periods of all structures, of exported scripts of OpenSees",
        f"{worst:.1e}",
        f"{tol.OPENSEES_SCRIPT_PERIODS:g}",
    )


def forces(structure: Structure, ground: Floats) -> Floats:
    """Return the forces of the lines [steps, b, 1 or 2] of this package [kN]."""
    law = BilinearParameters(
        BEARING.strength, BEARING.post_yield_stiffness, BEARING.initial_stiffness
    )
    constants = bilinear_constants(law)
    line = run.Line(constants, np.full(len(constants.cells.capacity), 20.0), None)
    lines = [line] * len(structure.bearings)
    prepared = run.prepare_structure(structure)
    history = run.run_structure(prepared, lines, ground, DT, np.full(STEPS, 20.0))
    assert history.outcome == "completed"
    result = [
        np.asarray(history.bearing(k)["force"]).reshape(STEPS + 1, -1) * one.count / one.scale**2
        for k, one in enumerate(structure.bearings)
    ]
    return np.stack(result, axis=1)[1:]


@needs_opensees
@pytest.mark.parametrize(
    "name", quick_cases(["pier-p1", "hybrid-pier", "five-span-girder", "five-span-bridge"], 0, 1, 2)
)
def test_bilinear_bearings_in_a_motion(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, measured: Recorder
) -> None:
    """Forces of all lines over the whole motion, in one direction and in plan, with damping."""
    structure = elastic_pier() if name == "pier-p1" else load_structure(name)
    if structure.damping.kind == "modal":
        structure = structure.model_copy(update={"damping": Damping(kind="element")})
    first = read_ground("jra-ii-i-1", DT, STEPS * DT)
    along_x = tb.GroundMotion("x", DT, first)
    if structure.plan:
        across = np.concatenate([np.zeros(100), 0.7 * first[:-100]])
        motion: Any = tb.MotionPair(along_x, tb.GroundMotion("y", DT, across), 0.0)
        ground = np.column_stack([first, across])
    else:
        motion, ground = along_x, first
    _, text = written(structure, tmp_path, bearing=BEARING, motion=motion)
    monkeypatch.chdir(tmp_path)
    executed(text)
    theirs = np.loadtxt("model-forces.txt")[:, 1:].reshape(STEPS, len(structure.bearings), 12)
    ours = forces(structure, ground)
    apart = np.abs(theirs[:, :, 6 : 6 + ours.shape[2]] - ours).max() / np.abs(ours).max()
    assert apart < tol.OPENSEES_HISTORY
    measured(
        f"{name}, forces of an exported script of OpenSees on bilinear bearings",
        f"{apart:.1e}",
        f"{tol.OPENSEES_HISTORY:g}",
    )


def test_both_languages_have_the_same_commands(tmp_path: Path) -> None:
    done = command("structures", "export", "five-span-girder", "-o", str(tmp_path / "model.tcl"))
    assert done.exit_code == 0, done.stderr
    tcl = (tmp_path / "model.tcl").read_text().split("set periods")[0].splitlines()
    python = written("five-span-girder", tmp_path)[1].split("values =")[0].splitlines()
    words = [line.removeprefix("ops.").replace('"', "") for line in python if "import" not in line]
    plain = [" ".join(line.replace("(", " ").replace(",", "").split()) for line in words if line]
    plain = [line.removesuffix(")") if not line.startswith("#") else line for line in plain]
    commands = [line for line in tcl if not line.startswith("#")]
    assert [line.strip() for line in plain if not line.startswith("#")] == commands


def test_layered_bearings_are_stiffer_in_the_cold(tmp_path: Path) -> None:
    """The element of the line has K_1 and Q_d of the bilinear model at the temperature."""
    laws = []
    for ambient in (-20.0, 23.0):
        _, text = written(
            "pier-p1", tmp_path, bearing="shen-hdr-bridge", ambient=ambient, overwrite=True
        )
        (line,) = [row for row in text.splitlines() if "elastomericBearingPlasticity" in row]
        laws.append([float(word) for word in line.split(",")[4:6]])
    assert laws[0][0] > 1.2 * laws[1][0]
    assert laws[0][1] > 1.2 * laws[1][1]


@pytest.mark.parametrize(
    ("file", "given", "key"),
    [
        ("model.txt", {}, ".tcl"),
        ("model.py", {"bearing": [BEARING, BEARING]}, "2 for 1"),
        ("model.py", {"bearing": "shen-bilinear-brige"}, "shen-bilinear-bridge"),
    ],
)
def test_errors(file: str, given: dict[str, Any], key: str, tmp_path: Path) -> None:
    with pytest.raises(tb.InputError, match=key):
        tb.opensees.write_structure("pier-p1", tmp_path / file, **given)
    assert not list(tmp_path.iterdir())
