"""One mass on one lead rubber bearing whose lead heats: here, and in OpenSees on LeadRubberX."""

import json
import subprocess
import sys

import numpy as np

import thermobearing as tb
from benchmarks.opensees_model import DT, MASS, PEAK, PERIOD, STEPS
from benchmarks.rows import Row, at_least, at_most, failed, plain
from benchmarks.specimen import seconds
from thermobearing.model.options import build_model
from thermobearing.structure.model import Structure
from thermobearing.structure.run import Line, prepare_structure, run_structure

OURS = "one mass on a lead rubber bearing (10 layers, 40 cells), a step of 5 ms"
THEIRS = "the same on OpenSees' LeadRubberX with lead heating"
BEARING, AMBIENT = "lrb-example", 20.0  # degC
LIMIT_US, LIMIT, MOST_US = 5.0, 10.0, 100.0
INSIDE = {
    "material": "our bearing in OpenSees as a material",
    "served": "our bearing in OpenSees, served",
    "many": "ten of our bearings in OpenSees, served as one element",
}


def one_mass() -> Structure:
    """A deck on one bearing; nothing else."""
    deck = {"name": "deck", "moves": True}
    mass = {"body": "deck", "height": "0 m", "mass": f"{MASS} kg"}
    line = {"name": "bearing", "body": "deck", "count": 1, "equivalent_stiffness": "1 kN/mm"}
    table = {
        "name": "one mass",
        "bodies": [deck],
        "masses": [mass],
        "bearings": [line],
        "report": {"deck": "deck", "pier": "deck", "pier_top": "0 m"},
    }
    return Structure.model_validate(table)


def our_step(keep_every: int) -> float:
    """Fastest time of a step [us]; every `keep_every`-th is kept."""
    constants = build_model(tb.load_bearing(BEARING)).constants
    prepared = prepare_structure(one_mass())
    ground = 1e3 * PEAK * np.sin(2.0 * np.pi / PERIOD * DT * np.arange(STEPS + 1))
    line = Line(constants, np.full(len(constants.cells.capacity), AMBIENT))
    air = np.full(STEPS, AMBIENT)

    def shake() -> None:
        run_structure(prepared, [line], ground, DT, air, keep_every=keep_every)

    return 1e6 * seconds(shake, 15)[0] / STEPS


def rows() -> list[Row]:
    """Time of a step without and with histories, and the ratios."""
    ours = {"bare": our_step(STEPS), "recorded": our_step(1)}
    measured = [at_most(f"{OURS}, histories kept", ours["recorded"], LIMIT_US, "us")]
    command = [sys.executable, "-m", "benchmarks.opensees_model"]
    process = subprocess.run(command, capture_output=True, text=True, check=False)
    if process.returncode:
        reason = (process.stderr.strip().splitlines() or ["no message"])[-1]
        return [*measured, failed(THEIRS, reason, f">= {LIMIT:g}")]
    theirs = json.loads(process.stdout.splitlines()[-1])
    heated = f"lead {theirs['rise']:.0f} K warmer, {theirs['iterations']} iterations a step"
    # Ours once more after theirs: the machine may have become faster or slower meanwhile.
    repeated = {"bare": min(ours["bare"], our_step(STEPS)), "recorded": our_step(1)}
    repeated["recorded"] = min(ours["recorded"], repeated["recorded"])
    for key, label in (("bare", "nothing kept"), ("recorded", "histories kept")):
        measured.append(plain(f"{THEIRS}, {label}", theirs[key], "us", heated))
        note = f"ours {repeated[key]:.2f} us in the same run"
        ratio = theirs[key] / repeated[key]
        measured.append(at_least(f"ratio of the two, one mass, {label}", ratio, LIMIT, note=note))
    bare = theirs["bare"]
    for key, label in INSIDE.items():
        note = f"{theirs[key] / bare:.2f} of the time of LeadRubberX in the same run"
        measured.append(plain(f"{label}, a step of one bearing", theirs[key], "us", note))
    difference = theirs["material"] - bare
    measured.append(at_most("the material, more than LeadRubberX", difference, MOST_US, "us"))
    return measured
