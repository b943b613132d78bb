"""Comparisons with other programs, a real test, and another processor, by stored numbers.

data/verify/references.json holds them, with the digest of the script that made them; finite
elements and OpenSees are computed here where their packages are installed.
"""

import hashlib
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing as tb
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.library import data_path
from thermobearing.core.records import Floats
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure.model import Damping, Structure, load_structure
from thermobearing.structure.run import Line, prepare_structure, run_structure
from thermobearing.verify.comparison import Comparison

STORED = "references.json"
SCRIPT = Path(__file__).with_name("finite_elements.py")
AMBIENT, END = -20.0, 50.0  # degC, s of loading
ELEMENTS = {  # bearing and place of each row
    "elements_outer_layer": ("shen-hdr-specimen", "middle of rubber 1"),
    "elements_inner_layer": ("shen-hdr-specimen", "middle of rubber 3"),
    "elements_lead": ("shen-lhdr-specimen", "lead"),
}
IN_OPENSEES = """
from pathlib import Path
from thermobearing.verify.references import preload_opensees
preload_opensees()
exec(compile(Path("model.py").read_text(encoding="utf-8"), "model.py", "exec"))
"""
DT, STEPS, EVERY = 0.01, 800, 20  # of the motion of the deck [s]; rows that are stored


@cache
def stored_references() -> Mapping[str, Any]:
    """Return the content of data/verify/references.json."""
    content: dict[str, Any] = json.loads(data_path("verify", STORED).read_text(encoding="utf-8"))
    return content


def script_digest(text: str) -> str:
    """Return the digest of a script, whatever its ends of lines are."""
    return hashlib.sha256("\n".join(text.splitlines()).encode()).hexdigest()


def elements_digest() -> str:
    """Return the digest of the script of the finite elements."""
    return script_digest(SCRIPT.read_text(encoding="utf-8"))


def is_installed(package: str) -> bool:
    """Return whether a package can be imported, so that references are computed here."""
    return find_spec(package) is not None


@cache
def _loading(bearing: str) -> tb.CyclicTest:
    wave = "sine" if bearing == "shen-lhdr-specimen" else "triangular"
    cycles = {"step": "cycles", "strain": 2.5, "wave": wave, "speed": 30.0, "count": 5}
    return tb.CyclicTest(dt=0.01, steps=[cycles])


@cache
def compute_elements(bearing: str) -> dict[str, float]:
    """Return rises of temperature at the end of loading by finite elements [K]; needs skfem."""
    from thermobearing.verify.finite_elements import FiniteElements, bearing_problem, released

    loaded = tb.load_bearing(bearing)
    result = tb.run(
        loaded,
        _loading(bearing),
        ambient=AMBIENT,
        keep=("rubber", "layer_displacement", "cells"),
    )
    history = FiniteElements(bearing_problem(loaded)).march([(0.1, 500)], released(loaded, result))
    wanted = [place for name, place in ELEMENTS.values() if name == bearing]
    return {place: float(history.means[place][-1]) for place in wanted}


@cache
def _rises(bearing: str) -> dict[str, float]:
    result = tb.run(tb.load_bearing(bearing), _loading(bearing), ambient=AMBIENT)
    row = int(np.searchsorted(result.time(0), END - 1e-6))
    layers = result["rubber_temperature"].values[0, row] - AMBIENT
    rises = {"middle of rubber 1": float(layers[0]), "middle of rubber 3": float(layers[2])}
    if result.has_lead:
        rises["lead"] = float(result["lead_temperature"].values[0, row] - AMBIENT)
    return rises


def _against_elements(bearing: str, place: str) -> Comparison:
    """Return the difference of a temperature rise from finite elements [K]."""
    stored = stored_references()["finite_elements"]
    if stored["script"] != elements_digest():
        return Comparison(math.inf, "The script of the finite elements is not that of the numbers.")
    installed = is_installed("skfem")
    reference = compute_elements(bearing)[place] if installed else stored[bearing][place]
    ours = _rises(bearing)[place]
    note = f"{ours:.1f} K, elements {reference:.1f} K"
    return Comparison(abs(ours - reference), note, recomputed=installed)


def _deck() -> tuple[Structure, Any, tb.GroundMotion]:
    """Return two masses, bilinear bearings between them, and a motion."""
    structure = load_structure("hybrid-pier")
    structure = structure.model_copy(update={"damping": Damping(kind="element")})
    motion = tb.load_motion("jra-ii-i-1")
    ground = np.interp(DT * np.arange(STEPS + 1), motion.time, motion.acceleration)
    ground[0] = 0.0
    return structure, load_bilinear("shen-bilinear-bridge"), tb.GroundMotion("x", DT, ground)


def _our_force() -> Floats:
    """Return the force of the line after each step [kN]."""
    structure, bearing, motion = _deck()
    law = BilinearParameters(
        bearing.strength, bearing.post_yield_stiffness, bearing.initial_stiffness
    )
    constants = bilinear_constants(law)
    line = Line(constants, np.full(len(constants.cells.capacity), 20.0))
    air = np.full(STEPS, 20.0)
    prepared = prepare_structure(structure)
    history = run_structure(prepared, [line], np.array(motion.acceleration), DT, air)
    support = structure.bearings[0]
    return np.array(history.bearing(0)["force"][1:] * support.count / support.scale**2)


def opensees_script(folder: Path) -> str:
    """Return the script of the same model for OpenSees, as this package exports it."""
    structure, bearing, motion = _deck()
    tb.opensees.write_structure(structure, folder / "model.py", bearing=bearing, motion=motion)
    return (folder / "model.py").read_text(encoding="utf-8")


def preload_opensees() -> None:
    """Load the libraries of the wheel of OpenSees that it does not find itself.

    It contains its own BLAS, and states the place only for the libraries that its module
    needs, not for those that they need in turn. Loaded under the same name, they are found.
    """
    from ctypes import CDLL

    spec = find_spec("openseespylinux")
    for folder in (spec and spec.submodule_search_locations) or ():
        for name in ("libquadmath.so.0", "libblas.so.3"):
            if (library := Path(folder, "lib", name)).exists():
                CDLL(str(library))


def run_opensees() -> Floats:
    """Return the force of the line after each step by OpenSees [kN]; needs openseespy.

    In a process of its own, since OpenSees writes to the terminal. Raises OSError if it fails.
    """
    with tempfile.TemporaryDirectory() as name:
        opensees_script(Path(name))
        ended = subprocess.run(
            [sys.executable, "-c", IN_OPENSEES], cwd=name, capture_output=True, check=False
        )
        if ended.returncode:
            raise OSError(ended.stderr.decode("utf-8", "replace").strip().splitlines()[-1])
        table = np.loadtxt(Path(name, "model-forces.txt"))
    return np.asarray(table[:, 1:].reshape(STEPS, 1, 12)[:, 0, 6])


def opensees_pier() -> Comparison:
    """Return the difference of a force history from OpenSees, of the peak."""
    stored, ours = stored_references()["opensees"], _our_force()
    if is_installed("openseespy"):
        theirs = run_opensees()
        return Comparison(float(np.abs(ours - theirs).max() / np.abs(theirs).max()), "", True)
    with tempfile.TemporaryDirectory() as name:
        digest = script_digest(opensees_script(Path(name)))
    if digest != stored["script"]:
        return Comparison(math.inf, "The exported script is not that of the stored numbers.")
    theirs = np.array(stored["force"])
    return Comparison(float(np.abs(ours[EVERY - 1 :: EVERY] - theirs).max() / np.abs(ours).max()))


def real_test() -> Comparison:
    """Return the recorded error of a calibration to a real test, relative."""
    stored = stored_references()["real_test"]
    return Comparison(float(stored["error"]), stored["note"])


def cyclic_numbers() -> list[float]:
    """Return numbers of a cyclic test with lead, by which machine code is compared."""
    test = tb.cyclic_test(strain=[0.5, 1.75], cycles=2, dt=0.05)
    data = tb.run("shen-lhdr-specimen", test, ambient=-20.0).dataset
    force, lead = data["force"].values[0], data["lead_temperature"].values[0]
    rubber = data["rubber_temperature"].values[0]
    rows = np.linspace(0, len(force) - 1, 12).astype(int)[1:]
    return [float(value) for value in (*force[rows], *lead[rows], *rubber[rows].ravel())]


def earthquake_numbers() -> list[float]:
    """Return peaks of a bridge in an earthquake, by which machine code is compared."""
    data = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", -20.0, duration=4.0).dataset
    names = ("bearing_force_max", "bearing_energy_end", "deck_displacement_max", "energy_input")
    return [float(data[name].squeeze()) for name in names]


def _against_stored(name: str, numbers: Callable[[], list[float]]) -> Comparison:
    stored = np.array([float.fromhex(text) for text in stored_references()[name]])
    ours = np.array(numbers())
    same = "the same bits" if np.array_equal(ours, stored) else "other bits"
    # Of the largest number: a force near zero has no accuracy of its own.
    return Comparison(float((np.abs(ours - stored) / np.abs(stored).max()).max()), same)


def platform_cyclic() -> Comparison:
    """Return the difference of a cyclic test from the stored numbers, of the largest."""
    return _against_stored("platform_cyclic", cyclic_numbers)


def platform_earthquake() -> Comparison:
    """Return the difference of an earthquake from the stored numbers, of the largest."""
    return _against_stored("platform_earthquake", earthquake_numbers)


def elements_outer_layer() -> Comparison:
    """Return the error of the outer layer [K]."""
    return _against_elements(*ELEMENTS["elements_outer_layer"])


def elements_inner_layer() -> Comparison:
    """Return the error of the inner layer [K]."""
    return _against_elements(*ELEMENTS["elements_inner_layer"])


def elements_lead() -> Comparison:
    """Return the error of the lead [K]."""
    return _against_elements(*ELEMENTS["elements_lead"])


CHECKS: Mapping[str, Callable[[], Comparison]] = {
    function.__name__: function
    for function in (
        elements_outer_layer,
        elements_inner_layer,
        elements_lead,
        opensees_pier,
        real_test,
        platform_cyclic,
        platform_earthquake,
    )
}
