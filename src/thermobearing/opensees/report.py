"""Report of bearings that were elements of an OpenSees model."""

import tomllib
from collections.abc import Mapping
from typing import Any

from thermobearing import reported
from thermobearing.model.options import ModelOptions
from thermobearing.opensees.result import ServedResult
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.validity import VALID_UNTIL, has_invalid
from thermobearing.quantities.words import counted, number, quantity
from thermobearing.report import content
from thermobearing.report.pieces import Pieces, ReportFigure

ASSUMPTIONS = (
    "OpenSees computes the structure. Displacements of an element are those of its second node "
    "relative to its first; the duration of each step is that of the model.",
    "Two directions in which an element shears act together; energies are those of both.",
)


SPRINGS = {  # whether the axial force acts
    False: "Vertical, rotational and torsional springs, where an element has them, are linear and "
    "do not depend on temperature; axial force and shear do not interact.",
    True: "Rotational and torsional springs are linear and do not depend on temperature. The "
    "vertical spring is that of the temperatures and the displacement of the last committed step, "
    "and so is the part that the axial force takes from the shear force. Moments of the axial "
    "force on the displaced bearing are neglected.",
}


def build_pieces(result: ServedResult) -> Pieces:
    """Return the content of the report of served bearings."""
    data = result.dataset
    case = tomllib.loads(data.attrs["case"])
    bearing_sources = case.get("sources", {}).get(case["bearing"]["name"])
    source = f"{content.TESTED_RANGE} of {case['bearing']['name']}"
    input_keys = ("ambient", "initial", "count", "units", "axial", "joint", "dowel_length", "rate")
    range_rows = result.tested_range.to_dict("records")
    inputs: dict[str, Any] = {key: case[key] for key in input_keys if key in case}
    energies = result.energy_tables()
    energy = energies.pop("energy")
    caption = content.figure_captions("serve")["elements"]
    return content.build_pieces(
        "serve",
        f"{case['bearing']['name']} in an OpenSees model",
        _question(result, case),
        _answer(result),
        checks=reported.result_checks(result, case, content.IN_EARTHQUAKES, source),
        rate_rows=range_rows,
        residuals=reported.residual_rows(result.energy, case["analysis"]),
        inputs={
            **reported.bearing_tables(case["bearing"], bearing_sources),
            "serving": content.input_table("Serving", inputs, otherwise="input"),
            "analysis": reported.analysis_table(case["analysis"], ModelOptions()),
        },
        tables={"elements": result.tables()["elements"], **energies},
        figures={"elements": ReportFigure(caption, draw=result.plot.elements)},
        energy=energy,
        assumptions=[
            *ASSUMPTIONS,
            SPRINGS[case.get("axial") == "node"],
            *reported.model_assumptions(case["analysis"], [case["bearing"]]),
        ],
        **content.result_parts(result, str(data.attrs["case"]), "serve"),
    )


def _question(result: ServedResult, case: Mapping[str, Any]) -> str:
    elements = len(set(result.dataset["tag"].values.tolist()))
    side_by_side = counted(int(case.get("count", 1)), "bearing")
    return (
        f"This report gives the response of {reported.bearing_words(case['bearing'])} as "
        f"{counted(elements, 'element')} of an OpenSees model, each of {side_by_side}, at ambient "
        f"temperature {quantity(case['ambient'])}."
    )


def _answer(result: ServedResult) -> list[str]:
    table = result.table
    names = "strain_max", "bearing_force_max_kN", "rubber_highest_degC"
    strain_row, force_row, rubber_row = (place_of_largest(table[name]) for name in names)
    elements = table["element"]
    if has_invalid(table):
        unstable = table[VALID_UNTIL].notna()
        elements = elements.where(~unstable, elements + ", unstable: no result")
    lead = ""
    if result.has_lead:
        lead = f", the lead {number(table['lead_highest_degC'].max())} °C"
    sentence = (
        f"The largest shear strain is {100.0 * table['strain_max'][strain_row]:.0f} % (element "
        f"{elements[strain_row]}), the largest force of one bearing "
        f"{number(table['bearing_force_max_kN'][force_row])} kN (element {elements[force_row]}). "
        f"The rubber reaches {number(table['rubber_highest_degC'][rubber_row])} °C{lead}."
    )
    return [*reported.early_end("The analysis", "", result), sentence]
