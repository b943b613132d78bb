"""What the documents of every analysis say of bearings and of how they are modelled."""

from collections.abc import Mapping, Sequence
from typing import Any

from thermobearing.bearing.bilinear import BILINEAR, BilinearBearing
from thermobearing.bearing.library import BEARINGS
from thermobearing.bearing.model import Bearing, Cells
from thermobearing.border.toml import flat, to_table
from thermobearing.model.earlier import BLIND
from thermobearing.model.options import ModelOptions
from thermobearing.report.content import (
    input_table,
)
from thermobearing.report.pieces import ReportTable
from thermobearing.report.words import number, quantity

Table = Mapping[str, Any]
TOLD = ("name", "kind", "description", "citation", "poor_fit")  # in the note
HELD = ("temperature_law", "tested_range")  # what the parameters are known to hold for
DEFAULT = "default of the program"
CASE = "as asked for"
PLACES = {"finite-plate": "plates of finite thickness", "half-space": "a half-space (Eq. 5.4-5.5)"}


def _bearing_sources(table: Table, own: Mapping[str, str] | None = None) -> dict[str, str]:
    """Sources of the numbers of a bearing: its own file's, or those of the library's of its name.

    Parameters
    ----------
    table : of the bearing in a resolved case, which holds no sources.
    own : by dotted key, where the file of the bearing had them.
    """
    bilinear = table.get("kind") == "bilinear"
    library, model = (BILINEAR, BilinearBearing) if bilinear else (BEARINGS, Bearing)
    return library.sources(model, table) | dict(own or {})


def bearing_tables(
    table: Table, own: Mapping[str, str] | None = None, *, otherwise: str = "not stated"
) -> dict[str, ReportTable]:
    """A bearing of a resolved case: what it is, its parameters, and what those hold for.

    Parameters
    ----------
    table : of the bearing.
    own : sources of its file, by dotted key.
    otherwise : source of the numbers that have none and are no default.
    """
    name = str(table["name"])
    sources = _defaults(table) | _bearing_sources(table, own)
    about = ". ".join(
        str(table[k]).rstrip(".") for k in ("description", "citation") if table.get(k)
    )
    note = f"{about}." if about else ""
    build = {k: v for k, v in table.items() if k in ("geometry", "materials", "cells")}
    rest = {k: v for k, v in table.items() if k not in (*TOLD, *build, *HELD)}
    held = {k: v for k, v in table.items() if k in HELD}
    parts = (
        ("geometry", f"{name}: geometry and materials", build, note),
        ("parameters", f"{name}: parameters of the model", rest, "" if build else note),
        ("range", f"{name}: range that the parameters were identified in", held, ""),
    )
    return {
        f"{name}.{key}": input_table(caption, part, sources, note=told, otherwise=otherwise)
        for key, caption, part, told in parts
        if part
    }


def _defaults(table: Table) -> dict[str, str]:
    """Numbers that are as they would be if nobody had said them: cells, no sealing plate."""
    usual = {f"cells.{name}": value for name, value in to_table(Cells()).items()}
    usual["geometry.sealing_plate_thickness"] = "0.0 mm"
    given = flat(table)
    return {key: DEFAULT for key, value in usual.items() if given.get(key) == value}


def analysis_table(
    analysis: Table, defaults: ModelOptions, known: Mapping[str, str] | None = None
) -> ReportTable:
    """Options of the model and of the computation; each is a default, or was asked for.

    Parameters
    ----------
    analysis : table of a resolved case.
    defaults : the options of that analysis, as they are without a word.
    known : sources of defaults, by dotted key.
    """
    usual = flat(to_table(defaults))
    settled = {
        "small_loops",
        "heat_source",
        "lead_ends",
        "clock",
    }  # depend on the bearing where not given
    sources = {
        key: (known or {}).get(key, DEFAULT)
        if usual.get(key, value if key in settled else None) == value
        else CASE
        for key, value in flat(analysis).items()
    }
    return input_table("Model and computation", analysis, sources)


def bearing_words(table: Table) -> str:
    """A bearing in a sentence: name, kind, plan, rubber, lead.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> bearing_words(to_table(load_bearing("shen-hdr-specimen")))
    'shen-hdr-specimen (HDR, square 240 mm, 6 layers of 5 mm rubber)'
    """
    if table.get("kind") == "bilinear":
        return f"{table['name']} (bilinear: no temperature, no rate)"
    geometry = table["geometry"]
    plan = dict(geometry["plan"])
    shape = plan.pop("shape")
    sizes = " x ".join(number(float(str(size).split()[0])) for size in plan.values())
    thickness = number(float(str(geometry["rubber_thickness"]).split()[0]))
    told = f"{shape} {sizes} mm, {geometry['rubber_layers']} layers of {thickness} mm rubber"
    lead = table.get("lead")
    if lead:
        diameter = number(float(str(lead["diameter"]).split()[0]))
        cores = "core" if lead["cores"] == 1 else "cores"
        told += f", {lead['cores']} lead {cores} of {diameter} mm"
    return f"{table['name']} ({table['kind']}, {told})"


def model_assumptions(analysis: Table, bearings: Sequence[Table]) -> list[str]:
    """What holds for every run of some options and bearings, in sentences."""
    layered = [table for table in bearings if table.get("kind") != "bilinear"]
    found = [
        "Shear acts in one direction, under a vertical load that does not change; rocking, "
        "torsion and buckling are not in the model."
    ]
    if len(layered) < len(bearings):
        names = [str(table["name"]) for table in bearings if table.get("kind") == "bilinear"]
        found.append(f"Bilinear, blind to temperature and rate: {', '.join(names)}.")
    if not layered:
        return found
    model = str(analysis.get("model", "multi-layer"))
    if model != "multi-layer":
        blind = "; it knows no temperature" if model in BLIND else ""
        found.append(f"An earlier model stands in for the full one: {model}{blind}.")
    found += [heat_flow(analysis, layered), _scheme(analysis), _heat_source(analysis)]
    if any(table.get("lead") for table in layered):
        found.append(_lead(analysis))
    found += [_virgin(layered), _exposure(analysis, bearings)]
    if analysis.get("hardening") == "monotone":
        found.append("Strain hardening is monotone: unloading never goes up.")
    laws = [analysis.get("small_loops") or t["hysteresis"].get("small_loops") for t in layered]
    if "closed" in laws:
        found.append("Small loops close: rubber returns to the point where a small reversal began.")
    if set(laws) != {"closed"}:
        found.append(
            "Small loops follow the published law and stay open: after a small reversal the force "
            "remains below that of uninterrupted loading."
        )
    return found


def heat_flow(analysis: Table, bearings: Sequence[Table]) -> str:
    """Return how heat flows through bearings and out of them, in a sentence.

    Parameters
    ----------
    analysis, bearings : tables of a resolved case.
    """
    films = {str(table["materials"].get("side_film", "0.0 W/(m^2 K)")) for table in bearings}
    values = sorted(float(film.split()[0]) for film in films)
    sides = (
        "none leaves through the sides"
        if values == [0.0]
        else f"the sides exchange it by a film of {' or '.join(number(v) for v in values)} W/(m² K)"
    )
    if side := analysis.get("side"):
        sides = (
            f"the sides exchange it by a film of {quantity(side['film'])} beyond "
            f"{quantity(side.get('cover', '0 mm'))} of cover rubber"
        )
    faces = []
    for key, name in (("upper_face", "upper"), ("lower_face", "lower")):
        face = analysis.get(key, {"eta": 2.0})
        if "eta" in face:
            faces.append(f"{name} η_B = {face['eta']:g} (1 adiabatic, 3 at ambient)")
        else:
            behind = face.get("heat_capacity")
            more = f" beyond {quantity(behind)}" if behind else ""
            faces.append(f"{name} film {quantity(face['film'])}{more}")
    return (
        f"Heat flows through the thickness only (one-dimensional), {sides}; end faces: "
        f"{', '.join(faces)}. Thermal properties do not change with temperature."
    )


def _scheme(analysis: Table) -> str:
    if analysis.get("scheme") == "published":
        return (
            "Heat scheme as published: sources and conduction as the source prints them, whose "
            "energy books have gaps."
        )
    return "Heat scheme conservative: all heat that is released is stored or leaves the bearing."


def _heat_source(analysis: Table) -> str:
    source = analysis.get("heat_source")
    if source == "dissipation":
        return "Dissipated work becomes heat; elastic work is given back."
    if source == "work":
        return "All work on the bearing becomes heat at once (Eq. 4.22)."
    return (
        "All work becomes heat at once in bearings of high damping rubber (Eq. 4.22), dissipated "
        "work only in those of natural rubber."
    )


def _lead(analysis: Table) -> str:
    ends = str(analysis.get("lead_ends") or "finite-plate")
    if analysis.get("scheme") == "published":
        ends = "half-space"
    clock = analysis.get("clock")
    told = f", dimensionless time by the diffusivity of {clock}" if clock else ""
    return f"Lead passes its heat to {PLACES.get(ends, ends)}{told}; it has one temperature."


def _virgin(bearings: Sequence[Table]) -> str:
    if any(table.get("scragging") for table in bearings):
        return "The stiffness of virgin rubber is in the model; recovery in rests is not."
    return (
        "The rubber has worked before: the excess stiffness of virgin rubber is not in the model."
    )


def _exposure(analysis: Table, bearings: Sequence[Table]) -> str:
    if analysis.get("exposure") or any(table.get("exposure") for table in bearings):
        return "Long cold and age are counted by the factors of the table of inputs."
    return (
        "Days of cold (crystallisation) and years of age are not counted: temperatures are those "
        "of the moment, and no factor stands for them."
    )
