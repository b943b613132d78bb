"""Report of a structure: its inputs as a table, and the document of `structures show`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from thermobearing.border.lazy import pd
from thermobearing.border.schema import validated
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import counted, identity_rows, percent, tidy
from thermobearing.report.content import (
    COLUMNS,
    key_words,
    saved_figures,
    value_and_unit,
    with_sources,
)
from thermobearing.report.pieces import Pieces
from thermobearing.results.directory import RESOLVED
from thermobearing.results.saved import SavedResult
from thermobearing.structure.matrices import describe_coordinates
from thermobearing.structure.model import DIRECTIONS, STRUCTURES, Structure
from thermobearing.tables.text import read_text

TABLES = {"parts": "Parts", "periods": "Modes"}
EFFECTIVE_MASSES = ("effective_mass_x", "effective_mass_y", "effective_mass_twist")
MOST_COORDINATES = 6  # of a structure in plan that a table of modes shows; the file has all
LISTS = {
    "bodies": "body",
    "masses": "mass",
    "springs": "spring",
    "hinges": "hinge",
    "bearings": "bearing line",
}
NAMED = ("name", "body", "base", "on", "moves", "rotates", "twists", "base_height")
LINE_ASSUMPTION = (
    "Bodies are rigid; they move in one horizontal direction and rock; foundations rest on linear "
    "springs."
)
PLAN_ASSUMPTION = (
    "Bodies are rigid; they move in two horizontal directions, rock in both, and may twist about "
    "the vertical; foundations rest on linear springs. Hinges yield in each direction by "
    "themselves."
)
ASSUMPTIONS = [
    "Modes are those with hinges that do not yield and bearings of their equivalent stiffness."
]


def build_pieces(saved: SavedResult) -> Pieces:
    """Return the content of the document of `structures show`, from its directory."""
    summary = saved.summary
    name, modes = str(summary["structure"]), summary["modes"]
    text = read_text(saved.path / RESOLVED)
    case, sources = split_sources(read_toml(saved.path / RESOLVED))
    description = str(summary["description"] or name).rstrip(".")
    first = modes[0]
    plan = "effective_mass" not in first
    answer = [
        f"The first of {counted(len(modes), 'period')} is {first['period_s']:.3g} s, with a "
        f"damping of {percent(first['damping_ratio'], 1)} and {_mass_share(first)}.",
        f"The total mass is {summary['mass_t']:.4g} t ({summary['mass_model']} mass); viscous "
        f"damping: {summary['damping']}.",
    ]
    structure = validated(Structure, case, str(saved.path / RESOLVED))
    built = build_tables(structure, saved["parts"], saved["periods"])
    tables = {key: replace(built[key], caption=words) for key, words in TABLES.items()}
    if "frame" in saved.tables:
        tables["frame"] = frame_table(saved["frame"])
    return Pieces(
        command="structures show",
        title=f"Structure {name}",
        question=f"This report gives the parts and the modes of {name}. {description}.",
        answer=answer,
        inputs={"structure": structure_table(case, sources)},
        tables=tables,
        figures=saved_figures(saved, "structure"),
        assumptions=[PLAN_ASSUMPTION if plan else LINE_ASSUMPTION, *ASSUMPTIONS],
        warnings=[tidy(words) for words in saved.warnings],
        identity=identity_rows(
            str(summary["version"]), text, "thermobearing structures show case.resolved.toml"
        ),
    )


def build_tables(
    structure: Structure, parts: "pd.DataFrame", modes: "pd.DataFrame"
) -> dict[str, Table]:
    """Return the tables of the parts and the modes of a structure."""
    at = [Quantity(key[0], "mm", "g", key) for key in ("x_mm", "y_mm")]
    height = Quantity("Height", "mm", "g", "height_mm")
    columns: list[str | Quantity] = ["part", "name", "body", "base", *at, height, "size"]
    names: list[str | Quantity] = ["mode", quantity("period_s", form=".3f"), "damping_ratio"]
    names += ["effective_mass", *EFFECTIVE_MASSES]
    shapes = describe_coordinates(structure)
    # A structure in plan has several coordinates for each body: too many for a page.
    if len(shapes) <= MOST_COORDINATES or not structure.plan:
        names += [replace(kind, head=name, name=name) for name, kind in shapes]
    return {"parts": make_table(parts, columns, keys=4), "periods": make_table(modes, names)}


def frame_table(periods: "pd.DataFrame") -> Table:
    """Return the periods of an imported structure and of its frame."""
    names: list[str | Quantity] = ["mode", quantity("period_s", form=".4f"), "frame_period_s"]
    names += ["period_difference", "effective_mass", "frame_effective_mass"]
    return make_table(periods, names, caption="Periods of the structure and of the frame")


def _mass_share(mode: Mapping[str, Any]) -> str:
    """Return the share of a mode in the mass, of a structure in plan in each direction."""
    if "effective_mass" in mode:
        return f"{percent(mode['effective_mass'])} of the mass"
    along, across = (percent(mode[f"effective_mass_{axis}"]) for axis in DIRECTIONS)
    return f"{along} of the mass along the bridge and {across} across it"


def structure_table(
    structure: Mapping[str, Any], file_sources: Mapping[str, str] | None = None
) -> Table:
    """Return the parts of a structure of a resolved case; `own` are the sources of its file."""
    sources = STRUCTURES.sources(Structure, structure) | dict(file_sources or {})
    rows: list[tuple[Any, ...]] = []
    for key, kind in LISTS.items():
        for place, item in enumerate(structure.get(key, [])):
            owner = item.get("name") or item["body"]
            for name, value in item.items():
                if name in NAMED or (value in (0.0, "0.0 kN mm s^2") and name != "height"):
                    continue
                source = sources.get(f"{key}[{place}].{name}", "")
                label = f"{kind.capitalize()} {owner}: {key_words(name).lower()}"
                rows.append((label, *value_and_unit(value), source))
    for key in ("kind", "ratios", "modes"):
        if key in structure["damping"]:
            value = value_and_unit(structure["damping"][key])
            rows.append((f"Viscous damping: {key}", *value, sources.get(f"damping.{key}", "")))
    texts = [structure.get(key) for key in ("description", "citation")]
    note = " ".join(f"{str(text).rstrip('.')}." for text in texts if text)
    return with_sources(Table(f"Structure: {structure['name']}", COLUMNS, rows, note=note))
