"""Where a structure is looked at: the rows and numbers that its table of peaks is made of."""

from dataclasses import dataclass

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.structure.matrices import displacement_row, unit
from thermobearing.structure.model import Structure
from thermobearing.structure.parts import hinge_of


@dataclass(frozen=True)
class Reported:
    """Deck and pier of the report; rows are displacements per coordinate, relative to the ground.

    Attributes
    ----------
    deck, top, base : [n] of the deck, the pier top, and the pier top if only its base moves.
    hinge : number of the pier's hinge; None without one.
    yield_rotation : of that hinge [rad]; NaN without one.
    """

    deck: Floats
    top: Floats
    base: Floats
    hinge: int | None
    yield_rotation: float


def reported_of(structure: Structure) -> Reported:
    """Of what a structure says in its `report`.

    Examples
    --------
    >>> from thermobearing.structure.model import load_structure
    >>> round(reported_of(load_structure("pier-p1")).yield_rotation, 5)
    0.00309
    """
    report = structure.report
    hinge = hinge_of(structure, report.pier)
    return Reported(
        deck=unit(structure, f"{report.deck} x"),
        top=displacement_row(structure, report.pier, report.pier_top),
        base=displacement_row(structure, report.pier_base, report.pier_top),
        hinge=hinge,
        yield_rotation=np.nan if hinge is None else structure.hinges[hinge].yield_rotation,
    )
