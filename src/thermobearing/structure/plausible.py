"""Whether a structure's numbers are those of usual ones: slips of units that pass checks.

As bearing/plausible.py for bearings; the usual ranges are in data/plausible/structure.toml.
"""

from thermobearing.bearing.plausible import sentence, usual_values
from thermobearing.border.units import parse_quantity
from thermobearing.structure.model import Structure
from thermobearing.structure.parts import piers_of
from thermobearing.structure.run import Prepared, prepare_structure

TONNES = 1e3  # in kN s2/mm
GRAVITY = parse_quantity("1 standard_gravity", "mm/s^2")


def implausible_structure(structure: Structure, prepared: Prepared | None = None) -> list[str]:
    """A sentence for each number of a structure that usual ones do not have.

    Parameters
    ----------
    structure : any; one whose bearings are specimens at a scale is not judged.
    prepared : its matrices and modes, if they are there.

    Returns
    -------
    list of str : what, value, usual range and its source, what is often behind it.

    Examples
    --------
    >>> from thermobearing.structure.model import load_structure
    >>> implausible_structure(load_structure("pier-p1"))
    []
    """
    if any(line.scale != 1.0 for line in structure.bearings):
        return []
    usual = {item.key: item for item in usual_values("structure.toml")}
    found = []
    for key, name, value in _derived(structure, prepared or prepare_structure(structure)):
        low, high = usual[key].ends
        if not low <= value <= high:
            found.append(sentence(f"{name}{key}", value, usual[key]))
    return found


def _derived(structure: Structure, prepared: Prepared) -> list[tuple[str, str, float]]:
    """Key, whose it is, and value in the unit of the key."""
    deck = sum(item.mass for item in structure.masses if item.body == structure.report.deck)
    weight = GRAVITY * sum(item.mass for item in structure.masses)
    found = [
        ("first period", "", float(prepared.modes.periods[0])),
        ("mass of the deck", "", TONNES * deck),
    ]
    for pier in piers_of(structure):
        if pier.hinge is None:
            continue
        hinge = structure.hinges[pier.hinge]
        found.append(("yield_rotation", f"{hinge.name}: ", hinge.yield_rotation))
        height = pier.top - structure.body(hinge.body).base_height
        if height > 0.0:
            key = "yield moment over all weight and the height of the pier"
            found.append((key, f"{hinge.name}: ", hinge.yield_moment / (weight * height)))
    return found
