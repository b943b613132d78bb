"""What the one number of a run is, in words: the `long_name` of its variable in a dataset."""

from collections.abc import Mapping
from typing import Final

from thermobearing.core.records import labels
from thermobearing.core.types import Books
from thermobearing.structure.types import MotionBooks

OWN: Final = {
    "outcome": "what ended the run",
    "energy_actuator": "work that delay and force error of the actuator take, at the end",
    "bearing_energy_end": "work done on one bearing at the end",
    "pier_displacement_residual": "displacement of the pier top relative to its base at the end",
    "steps": "steps of the run",
    "iterations": "iterations of Newton's method in the whole run",
    "substeps": "halvings of steps in the whole run",
    "pier_ductility": "largest rotation of the hinge over its yield rotation",
    "layer_force_mismatch_max": "largest difference of a layer law from the force",
    "loop_force_max": "largest force of the largest loop",
    "loop_force_min": "smallest force of the largest loop",
    "loop_displacement_max": "largest displacement of the largest loop",
    "loop_displacement_min": "smallest displacement of the largest loop",
    "loop_stiffness": "equivalent stiffness of the largest loop",
    "loop_damping_ratio": "equivalent damping ratio of the largest loop",
    "loop_modulus": "equivalent shear modulus of the largest loop",
    "loop_energy": "energy of the largest loop",
    "loop_start": "time when the largest loop begins",
    "loop_end": "time when the largest loop ends",
}
PEAK: Final = "_max"  # of a history
ENERGY, HEAT = "energy_", "heat_"  # of the structure, of one bearing


def meaning_of(name: str, histories: Mapping[str, str]) -> str:
    """What a number of a run is.

    Parameters
    ----------
    name : of its variable.
    histories : what each history is, by name.

    Examples
    --------
    >>> meaning_of("bearing_force_max", {"bearing_force": "force of one bearing"})
    'largest force of one bearing'
    >>> meaning_of("energy_input", {})
    'work of the ground, on motion relative to it, at the end'
    """
    if name in OWN:
        return OWN[name]
    for prefix, books in ((ENERGY, MotionBooks), (HEAT, Books)):
        meanings = {f"{prefix}{label.name}": label.meaning for label in labels(books)}
        if name in meanings:
            return f"{meanings[name].removesuffix(' now')}, at the end"
    return f"largest {histories[name.removesuffix(PEAK)]}"
