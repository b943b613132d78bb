"""Loads and directions of a bridge analysis that a reader must know: dead loads, one direction."""

import tomllib
from typing import TYPE_CHECKING

from thermobearing.border.lazy import pd
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import number, percent
from thermobearing.structure.fields import GRAVITY

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

ALLOWED = 0.05  # of the weight of the deck, by which the dead loads of its bearings may differ
COMBINATION = "the combination of directions (100 % of one and 30 % of the other) is not included"


def dead_load_table(result: "EarthquakeResult") -> Table:
    """Return the axial force on one bearing of each line and on all of it; empty without one.

    The note says where their sum differs from the weight of the deck by more than 5 %.
    """
    case = make_earthquake_case(tomllib.loads(str(result.dataset.attrs["case"])), "result")
    forces = case.axial_forces()
    rows = [
        {
            "line": line.name,
            "count": line.count,
            "force_of_one": forces[line.name],
            "force_of_all": line.count * forces[line.name],
        }
        for line in case.structure.bearings
        if line.name in forces
    ]
    if not rows:
        return make_table(pd.DataFrame())
    columns = [
        Quantity("Line", name="line"),
        Quantity("Bearings", name="count"),
        Quantity("Of one bearing", "kN", name="force_of_one", form=".5g"),
        Quantity("Of the line", "kN", name="force_of_all", form=".6g"),
    ]
    caption = "Axial forces of the bearing lines (dead load, positive in compression)"
    table = pd.DataFrame(rows)
    return make_table(table, columns, caption, keys=1, note=_weight_note(case, table))


def _weight_note(case: EarthquakeCase, loads: "pd.DataFrame") -> str:
    """Return how the dead loads of all lines compare with the weight of the deck."""
    total = float(loads["force_of_all"].sum())
    mass = sum(
        item.mass for item in case.structure.masses if item.body == case.structure.report.deck
    )
    weight = GRAVITY * mass
    if len(loads) < len(case.structure.bearings) or not weight > 0.0:
        return ""
    sums = f"Sum of all lines {number(total)} kN, weight of the deck {number(weight)} kN"
    difference = total / weight - 1.0
    if abs(difference) <= ALLOWED:
        return f"{sums}."
    word = "more" if difference > 0.0 else "less"
    return (
        f"{sums}: the bearings carry {percent(abs(difference))} {word} than the mass that the "
        "analysis moves. Compare masses and dead loads."
    )


def direction_note(result: "EarthquakeResult") -> str:
    """Return which directions an analysis is of and what it leaves out of them, as a sentence."""
    if result.in_plan:
        return "Both horizontal components of each ground motion act together."
    if result.directions:
        return f"Each horizontal direction is analysed on its own: {COMBINATION}."
    return (
        "The analysis is of one horizontal direction, longitudinal or transverse, whose stiffness "
        f"and masses the structure states; the other direction is not analysed, and {COMBINATION}."
    )
