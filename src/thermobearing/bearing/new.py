"""New bearings from a compound and the dimensions of a drawing."""

import re
from pathlib import Path
from typing import Any

from thermobearing.bearing.cells import Cells
from thermobearing.bearing.compound import Compound, as_compound
from thermobearing.bearing.model import Bearing, Geometry
from thermobearing.bearing.scaling import RULES, Cores, build_bearing, extract_compound
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, validated
from thermobearing.border.units import parse_quantity, split_quantity

END_PLATE = 30.0  # [mm], default; usual are 20 to 50
TIMES = re.compile("[x×]")
GIVEN = {"lead.cores", "lead.diameter", "lead.confined", "lead.end_spreading"}


class Drawing(Strict):
    """The dimensions of a drawing, validated."""

    geometry: Geometry
    lead: Cores | None


@checked
def new_bearing(
    name: str,
    compound: Compound | Bearing | str | Path,
    *,
    layers: str,
    shim: str | float,
    plan: str | None = None,
    diameter: str | float | None = None,
    hole: str | float | None = None,
    end_plate: str | float | None = None,
    sealing_plate: str | float = 0.0,
    lead: str | float | None = None,
    cores: int = 1,
    confined: bool = False,
    end_spreading: float = 1.0,
    description: str = "",
) -> Bearing:
    """Return a bearing from a compound and the dimensions of a drawing (rules: bearing/scaling.py).

    Parameters
    ----------
    name : of the new bearing.
    compound : a Compound, a library name, a TOML file of a compound or of a bearing
        (such as a calibrated specimen), or a Bearing, whose compound is used.
    layers : number and thickness of the rubber layers, "20x8mm"; the number in [1, 200].
    shim : thickness of a plate between layers [mm], in [0.05, 1000]; text needs a unit, "3 mm".
    plan : length in the direction of motion and width, "1000x1000mm"; or give `diameter`.
    diameter : diameter of a round bearing [mm], in [1, 1e5].
    hole : diameter of an open hole along the axis of a round bearing without lead [mm], less than
        `diameter`; none by default.
    end_plate : thickness of an end plate [mm], in [0.05, 1000]; 30 mm are assumed by default.
    sealing_plate : thickness of a plate inside each end plate [mm], in [0, 1000]; none by default.
    lead : diameter of a lead core [mm], in [0.1, 1e4]; no lead by default.
    cores : number of lead cores, in [1, 1000].
    confined : cores in springs, which conduct heat to the end plates only.
    end_spreading : factor of heat into the end plates of confined cores, in [0.001, 1].
    description : what it is, in words.

    Returns
    -------
    Bearing, with the rule and the source of every number.

    Raises
    ------
    InputError : an unknown compound (with the nearest name), sizes without unit or out of range,
        lead without lead parameters in the compound, natural rubber without lead.

    Examples
    --------
    >>> size = {"plan": "1000x1000mm", "layers": "20x8mm", "shim": "3mm", "lead": "180mm"}
    >>> made = new_bearing("pier-3", "natural-rubber", **size)
    >>> made.kind, made.total_rubber_thickness, round(made.lead.core_strength)
    ('LRB', 160.0, 254)
    """
    if not str(name).strip(" .") or set(str(name)) & set("/\\"):
        raise InputError(f"name = {name!r}: must be a valid file name without blanks")
    source = as_compound(compound)
    rubber_compound = extract_compound(source) if isinstance(source, Bearing) else source
    size = {
        "plan": _plan(plan, diameter, hole),
        **_layers(layers),
        "shim_thickness": shim,
        "end_plate_thickness": END_PLATE if end_plate is None else end_plate,
        "sealing_plate_thickness": sealing_plate,
    }
    core = {"cores": cores, "diameter": lead, "confined": confined, "end_spreading": end_spreading}
    tables = {"geometry": size, "lead": None if lead is None else core}
    drawing = validated(Drawing, tables, f'new bearing "{name}"', from_file=False)
    bearing = build_bearing(
        rubber_compound,
        name,
        drawing.geometry,
        drawing.lead,
        cells=Cells(),
        description=description or f"{layers} of {rubber_compound.name}",
        citation=f"derived from compound {rubber_compound.name}"
        + (f": {rubber_compound.citation}" if rubber_compound.citation else ""),
    )
    return bearing.with_sources(_sources(bearing, rubber_compound, assumed_plate=end_plate is None))


def _plan(
    plan: str | None, diameter: str | float | None, hole: str | float | None
) -> dict[str, Any]:
    """Return the table `plan` of a bearing."""
    if (plan is None) == (diameter is None):
        raise InputError('give plan ("1000x1000mm") or diameter ("700mm")')
    if diameter is not None:
        sizes = {"diameter": diameter} if hole is None else {"diameter": diameter, "hole": hole}
        return {"shape": "circular", **sizes}
    if hole is not None:
        raise InputError(f'hole = "{hole}": needs diameter, of a round bearing')
    sides = _factors(str(plan))
    if sides is None:
        raise InputError(
            f'plan = "{plan}": give length and width, "1000x1000mm"; a round bearing has a diameter'
        )
    first, second = sides[0], _with_unit("plan", str(plan), sides[1])
    if _has_no_unit(first):  # the unit of the second applies to both
        first += second.lstrip("+-.0123456789 ")
    try:
        length, width = parse_quantity(first, "mm"), parse_quantity(second, "mm")
    except InputError as error:
        raise InputError(error.lines("plan")) from None
    # A square plan has its own shape, with one size.
    if length == width:
        return {"shape": "square", "side": length}
    return {"shape": "rectangular", "length": length, "width": width}


def _layers(layers: str) -> dict[str, Any]:
    """Return the number and thickness of the rubber layers."""
    factors = _factors(str(layers))
    if factors is None or not factors[0].isdecimal():
        raise InputError(
            f'layers = "{layers}": give number and thickness of the rubber layers, "20x8mm"'
        )
    thickness = _with_unit("layers", str(layers), factors[1])
    return {"rubber_layers": int(factors[0]), "rubber_thickness": thickness}


def _factors(text: str) -> tuple[str, str] | None:
    """Return the two factors of a text such as "20x8mm"; None for any other form."""
    factors = [factor.strip() for factor in TIMES.split(text)]
    return (factors[0], factors[1]) if len(factors) == 2 and all(factors) else None


def _has_no_unit(text: str) -> bool:
    """Return whether a text is a number alone."""
    parts = split_quantity(text)
    return parts is not None and not parts[1]


def _with_unit(key: str, text: str, length: str) -> str:
    """Return the length; InputError without a unit."""
    if _has_no_unit(length):
        raise InputError(
            f'{key} = "{text}" has no unit; write "{text.strip()}mm" if this is the intended unit'
        )
    return length


def _sources(bearing: Bearing, compound: Compound, *, assumed_plate: bool) -> dict[str, str]:
    """Return the rule and source of each number of the new bearing, by dotted key."""
    compound_sources = compound.sources
    sources = {}
    for key in _number_keys(bearing):
        if key.startswith("cells."):
            sources[key] = "default"
        elif key.startswith("geometry.") or key in GIVEN:
            sources[key] = "given"
        else:
            # Parameters without a size have the same key in rubber and hysteresis, and no rule.
            same = (key.replace("hysteresis.", "rubber.", 1), "", "")
            key_of_compound, _, rule = RULES.get(key, same)
            if (
                key == "lead.stiffness"
                and compound.lead
                and compound.lead.stiffness_ratio is not None
            ):
                rule, key_of_compound = "K_1/K_2 of the bearing", "lead.stiffness_ratio"
            parts = [rule, f"compound {compound.name}", compound_sources.get(key_of_compound, "")]
            sources[key] = "; ".join(part for part in parts if part)
    if assumed_plate:
        sources["geometry.end_plate_thickness"] = "assumed; not given"
    return sources


def _number_keys(model: Strict, before: str = "") -> list[str]:
    """Dotted keys of all entries of a record that are no tables, without texts at its top."""
    keys = []
    for name in type(model).model_fields:
        value = getattr(model, name)
        if isinstance(value, Strict):
            keys += _number_keys(value, f"{before}{name}.")
        elif value is not None and before:
            keys.append(f"{before}{name}")
    return keys
