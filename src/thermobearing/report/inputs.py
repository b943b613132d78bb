"""The inputs of an analysis as tables."""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from thermobearing.border.toml import flat
from thermobearing.report.pieces import Column, ReportTable
from thermobearing.report.words import printed_unit

# By the dotted key's end; the longest that fits counts.
NAMES = {
    "name": "Name",
    "kind": "Kind",
    "description": "Description",
    "citation": "Citation",
    "plan.shape": "Plan",
    "plan.side": "Side of the plan",
    "plan.length": "Length in the direction of motion",
    "plan.width": "Width across the motion",
    "plan.diameter": "Diameter of the plan",
    "rubber_layers": "Number of rubber layers",
    "rubber_thickness": "Thickness of one rubber layer t_r",
    "shim_thickness": "Thickness of a steel shim",
    "end_plate_thickness": "Thickness of an end plate",
    "sealing_plate_thickness": "Thickness of a sealing plate",
    "total_rubber_thickness": "Total rubber thickness",
    "materials.rubber.conductivity": "Rubber: thermal conductivity",
    "materials.rubber.specific_heat": "Rubber: specific heat",
    "materials.rubber.density": "Rubber: density",
    "materials.steel.conductivity": "Steel: thermal conductivity",
    "materials.steel.specific_heat": "Steel: specific heat",
    "materials.steel.density": "Steel: density",
    "materials.lead.conductivity": "Lead: thermal conductivity",
    "materials.lead.specific_heat": "Lead: specific heat",
    "materials.lead.density": "Lead: density",
    "side_film": "Film coefficient of the side",
    "hysteresis.post_yield_ratio": "Elastic part of the layer stiffness α₀",
    "hysteresis.layer_stiffness": "Initial stiffness of one layer K_r",
    "hysteresis.shape": "Shape of the loop s",
    "hysteresis.yield_displacement": "Yield displacement of one layer d_y",
    "hysteresis.hardening": "Strain hardening b",
    "hysteresis.small_loops": "Small loops of the rubber",
    "elastic_temperature_coefficient": "Temperature coefficient, elastic part m_T",
    "hysteretic_temperature_coefficient": "Temperature coefficient, hysteretic part n_T",
    "reference_temperature": "Reference temperature T_0",
    "temperature_law.coldest": "Coldest rubber in the tests behind m_T, n_T",
    "temperature_law.warmest": "Warmest rubber in the tests behind m_T, n_T",
    "temperature_law.temperatures": "Temperatures of the table of factors",
    "temperature_law.elastic": "Factors on the elastic part",
    "temperature_law.hysteretic": "Factors on the hysteretic part",
    "tested_range.strain": "Tested shear strain, largest of a test",
    "tested_range.strain_rate": "Tested strain rate, largest of a test",
    "tested_range.ambient": "Tested ambient temperature",
    "tested_range.cycles": "Tested cycles in a row",
    "tested_range.lead_temperature": "Lead temperature in the tests",
    "scragging.amplitude": "Scragging: excess of virgin rubber b",
    "scragging.strain": "Scragging: strain in which it falls by 1/e",
    "mullins_amplitude": "Virgin share: excess a",
    "mullins_decay": "Virgin share: decay c",
    "mullins_renewal": "Virgin share: renewal l",
    "lead.cores": "Number of lead cores",
    "lead.diameter": "Diameter of a lead core",
    "lead.stiffness": "Stiffness of one lead core K_l",
    "lead.yield_stress": "Yield stress of lead σ_Y",
    "lead.softening": "Softening of lead E_2",
    "lead.surface_ratio": "Rise at the core's surface over its bulk p",
    "lead.confined": "Cores confined (heat leaves through the ends only)",
    "lead.clock": "Diffusivity in dimensionless time",
    "lead.end_spreading": "Spreading resistance of the end plates",
    "rate.stiffness": "Rate branch: stiffness K_v",
    "rate.damping": "Rate branch: damping c_v",
    "exposure.stiffness": "Long cold and age: factor on stiffness",
    "exposure.strength": "Long cold and age: factor on strength",
    "exposure.source": "Long cold and age: source",
    "cells.end_plate": "Heat cells of an end plate",
    "cells.rubber": "Heat cells of a rubber layer",
    "cells.shim": "Heat cells of a shim",
    "cells.sealing_plate": "Heat cells of a sealing plate",
    "strength": "Characteristic strength Q_d",
    "initial_stiffness": "Initial stiffness K_1",
    "post_yield_stiffness": "Post-yield stiffness K_2",
    "equivalent_stiffness": "Equivalent stiffness of one bearing K_B",
    "rotary_inertia": "Rotary inertia",
    "yield_moment": "Yield moment",
    "yield_rotation": "Yield rotation",
    "hardening_ratio": "Hardening ratio",
    "unloading_exponent": "Unloading exponent (Takeda)",
    "damping_ratio": "Damping ratio",
    "rotational_stiffness": "Rotational stiffness",
    "base_height": "Height where it stands",
    "dt": "Largest time step",
    "method": "Time integration",
    "mass": "Mass",
    "scheme": "Heat scheme",
    "integrator": "Integration of Z",
    "small_loops": "Small loops of the rubber",
    "heat_source": "Heat source",
    "lead_ends": "Heat out of the lead",
    "clock": "Diffusivity in dimensionless time",
    "stack": "Part of the height that is modelled",
    "keep_every": "Kept steps: every",
    "keep": "Kept temperatures and layers",
    "histories": "Histories in files",
    "model": "Model of the bearing",
    "upper_face.eta": "Heat exchange of the upper face η_B",
    "lower_face.eta": "Heat exchange of the lower face η_B",
    "upper_face.film": "Film coefficient of the upper face",
    "lower_face.film": "Film coefficient of the lower face",
    "upper_face.heat_capacity": "Heat capacity behind the upper face",
    "lower_face.heat_capacity": "Heat capacity behind the lower face",
    "side.film": "Film coefficient of the side",
    "side.cover": "Cover rubber of the side",
    "laboratory.mode": "Mode of the laboratory",
    "laboratory.speed": "Speed of a pseudo-dynamic test",
    "laboratory.delay": "Delay of the actuator",
    "laboratory.force_noise": "Noise of the measured force",
    "rig.force": "Rig: largest force",
    "rig.stroke": "Rig: largest stroke",
    "rig.speed": "Rig: largest speed",
}


def key_words(key: str) -> str:
    """Words for a dotted key; the key in words where nothing is known.

    Examples
    --------
    >>> key_words("geometry.rubber_thickness"), key_words("springs[0].anything_else")
    ('Thickness of one rubber layer t_r', 'Springs, anything else')
    """
    parts = key.split(".")
    for first in range(len(parts)):
        if known := NAMES.get(".".join(parts[first:])):
            return known
    words = ", ".join(part.split("[")[0].replace("_", " ") for part in parts)
    return words[:1].upper() + words[1:]


QUANTITY = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\s+(.+))?")
COLUMNS = (Column("What"), Column("Value", form=".6g"), Column("Unit"), Column("Source"))
RANGES = ("tested_range.",)  # keys whose two values are ends


def input_table(
    caption: str,
    table: Mapping[str, Any],
    sources: Mapping[str, str] | None = None,
    *,
    without: Collection[str] = (),
    otherwise: str = "",
    note: str = "",
) -> ReportTable:
    """A row for each value of a table of a resolved input.

    Parameters
    ----------
    caption : what they are.
    table : as it is read from TOML: numbers with a unit are text.
    sources : of values, by dotted key.
    without : keys that are left out, with everything below them.
    otherwise : source of the values that have none of their own.
    note : below the table.

    Examples
    --------
    >>> table = {"geometry": {"rubber_layers": 6, "rubber_thickness": "5.0 mm"}}
    >>> input_table("Bearing", table, {"geometry.rubber_layers": "Table 3.1"}).rows[0]
    ('Number of rubber layers', 6, '', 'Table 3.1')
    """
    told = sources or {}
    rows = [
        (key_words(key), *value_and_unit(value, ends=key.startswith(RANGES)), _source(key, told))
        for key, value in flat(table).items()
        if not any(key == one or key.startswith((f"{one}.", f"{one}[")) for one in without)
    ]
    rows = [(what, value, unit, source or otherwise) for what, value, unit, source in rows]
    return ReportTable(caption, COLUMNS, rows, note=note)


def _source(key: str, sources: Mapping[str, str]) -> str:
    """Of a value, or of the list that it stands in."""
    return sources.get(key) or sources.get(key.split("[")[0], "")


def value_and_unit(value: Any, *, ends: bool = False) -> tuple[Any, str]:
    """A value of TOML as a number or text, and its unit as one prints it.

    Parameters
    ----------
    value : such as "0.4 kN s^2/mm".
    ends : two values are the ends of a range.

    Examples
    --------
    >>> value_and_unit("0.4 kN s^2/mm"), value_and_unit(["-20 degC", "23 degC"], ends=True)
    ((400.0, 't'), ('−20 to 23', '°C'))
    """
    if isinstance(value, list | tuple):
        return _several(value, ends)
    if not isinstance(value, str):
        return value, ""
    found = QUANTITY.fullmatch(value.strip())
    if found is None or found[2] is None:
        return value, ""
    unit, factor = printed_unit(found[2])
    return factor * float(found[1]), unit


def _several(values: Sequence[Any], ends: bool) -> tuple[Any, str]:
    """Values of a list in one cell, where they have one unit."""
    pairs = [value_and_unit(value) for value in values]
    units = {unit for _, unit in pairs}
    if len(units) > 1:
        return ", ".join(f"{Column('').text(v)} {u}".strip() for v, u in pairs), ""
    cell = Column("", form=".6g")
    between = " to " if ends and len(pairs) == 2 else ", "
    if between == " to " and pairs[0] == pairs[1]:
        return pairs[0]
    return between.join(cell.text(value) for value, _ in pairs), "".join(units)
