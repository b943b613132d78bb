"""A structure before it is shaken: its parts, periods and mode shapes, and implausible numbers.

The usual ranges are in data/plausible/structure.toml, as those of bearings (bearing/plausible.py).
"""

from pathlib import Path
from typing import Any, get_args

import numpy as np

import thermobearing
from thermobearing.bearing.plausible import unusual, usual_values
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.toml import sourced_toml
from thermobearing.core.records import Floats
from thermobearing.quantities.governing import places_of_largest
from thermobearing.quantities.tables import Table
from thermobearing.quantities.warned import Warned
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import PERIODS, RESOLVED, STRUCTURE_PARTS
from thermobearing.results.screen import print_warnings, say, show_table
from thermobearing.results.writing import write_csv
from thermobearing.structure.fields import GRAVITY
from thermobearing.structure.matrices import twist_load
from thermobearing.structure.model import (
    DampingKind,
    Hinge,
    MassModel,
    Spring,
    Structure,
    device_ends,
    fixed_base,
    list_hinges,
    list_piers,
    load_structure,
    reported_line,
)
from thermobearing.structure.report import EFFECTIVE_MASSES, build_tables
from thermobearing.structure.run import Prepared, prepare_structure

TONNES = 1e3  # in kN s2/mm
KN_MM_PER_KN_M = 1e3
AT_REST = 1e-9  # share below which a coordinate or a mass rests in a mode of a structure in plan


def implausible_structure(structure: Structure, prepared: Prepared | None = None) -> list[Warned]:
    """Return a sentence for each unusual number, but not of specimens at a scale."""
    # Specimens are smaller than structures in use, whose ranges these are.
    if any(line.scale != 1.0 for line in structure.bearings):
        return []
    usual = {item.key: item for item in usual_values("structure.toml")}
    sentences = []
    for key, name, value in _derived(structure, prepared or prepare_structure(structure)):
        low, high = usual[key].ends
        if not low <= value <= high:
            sentences.append(unusual(f"{name}{key}", value, usual[key]))
    return sentences


def _derived(structure: Structure, prepared: Prepared) -> list[tuple[str, str, float]]:
    """Return key, name of the part, and value in the unit of the key."""
    deck = sum(item.mass for item in structure.masses if item.body == structure.report.deck)
    weight = GRAVITY * sum(item.mass for item in structure.masses)
    values = [
        ("first period", "", float(prepared.modes.periods[0])),
        ("mass of the deck", "", TONNES * deck),
    ]
    for pier in list_piers(structure):
        if pier.hinges[0] is None:
            continue
        hinge = list_hinges(structure)[pier.hinges[0]]
        values.append(("yield_rotation", f"{hinge.name}: ", hinge.yield_rotation))
        height = pier.top - structure.body(hinge.body).base_height
        if height > 0.0:
            key = "yield moment over all weight and the height of the pier"
            values.append((key, f"{hinge.name}: ", hinge.yield_moment / (weight * height)))
    return values


def _in_direction(part: Spring | Hinge) -> str:
    return f" in {part.direction}" if part.direction else ""


class StructureResult(Result):
    """What is known about a structure without an earthquake.

    Attributes
    ----------
    prepared : Prepared
        Matrices, modes with the equivalent stiffness of the bearings, damping.
    mass_model : str
        "consistent" or "published".
    """

    title = "Structure"
    _figures = "StructureFigures"

    def __init__(self, prepared: Prepared, mass_model: MassModel) -> None:
        self.prepared, self.mass_model = prepared, mass_model
        self.structure = prepared.structure
        self.mass = sum(item.mass for item in self.structure.masses)  # [kN s2/mm]

    @property
    def table(self) -> "pd.DataFrame":
        """One row per mode: period [s], damping ratio, effective mass, shape (largest 1)."""
        modes = self.prepared.modes
        largest = places_of_largest(np.abs(modes.shapes.T))
        shapes = modes.shapes / modes.shapes[largest, np.arange(len(largest))]
        if self.structure.plan:  # a coordinate at rest has the rounding of the others
            amplitude = np.sqrt(np.diag(self.prepared.matrices.mass))[:, None] * np.abs(shapes)
            shapes[amplitude < AT_REST * amplitude.max(axis=0)] = 0.0
        columns = {
            "mode": np.arange(1, len(modes.frequencies) + 1),
            "period_s": modes.periods,
            "frequency_Hz": 1.0 / modes.periods,
            "damping_ratio": self.prepared.ratios,
            **self._effective_masses(),
        }
        names = self.prepared.matrices.coordinates
        return pd.DataFrame(columns | dict(zip(names, shapes, strict=True)))

    def _effective_masses(self) -> dict[str, Floats]:
        """Return the share of each mode in the mass; in plan along, across and in twist."""
        matrices, shapes = self.prepared.matrices, self.prepared.modes.shapes
        # Of modes with unit modal mass: the square of the participation factor.
        modal_load = (shapes.T @ matrices.load) ** 2 / self.mass
        if not self.structure.plan:
            return {"effective_mass": modal_load}
        load, inertia = twist_load(self.structure)
        # A structure on one axis has no inertia about the vertical, and no share of it.
        twisted = (shapes.T @ load) ** 2 / (inertia or np.nan)
        shares = np.array([*modal_load.T, twisted])
        # Symmetry makes them zero; what is left is rounding, which differs between processors.
        shares[shares < AT_REST] = 0.0
        return dict(zip(EFFECTIVE_MASSES, shares, strict=True))

    @property
    def parts(self) -> "pd.DataFrame":
        """One row per mass, spring, hinge and bearing line: what it is, where, how large."""
        structure = self.structure
        rows = []
        for item in structure.masses:
            size = f"{TONNES * item.mass:g} t"
            if item.twist_inertia:
                size += f", {item.twist_inertia / KN_MM_PER_KN_M:g} t m² in twist"
            rows.append(("mass", item.body, item.body, "", item.height, size))
        for spring in structure.springs:
            size = (
                f"{spring.stiffness:g} kN/mm"
                if spring.stiffness is not None
                else f"{(spring.rotational_stiffness or 0.0) / KN_MM_PER_KN_M:g} kN m/rad"
            )
            size += _in_direction(spring)
            rows.append(("spring", spring.name, spring.body, spring.base, spring.height, size))
        for hinge in structure.hinges:
            height = structure.body(hinge.body).base_height
            size = f"yields at {hinge.yield_moment / KN_MM_PER_KN_M:g} kN m, "
            size += f"{1e3 * hinge.yield_rotation:g} mrad{_in_direction(hinge)}"
            rows.append(("hinge", hinge.name, hinge.body, hinge.base, height, size))
        for line in structure.bearings:
            size = f"{line.count} x {line.equivalent_stiffness:g} kN/mm"
            size += f", modelled at scale {line.scale:.4g}" if line.scale != 1.0 else ""
            if line.height_across is not None:
                size += f", across the bridge at {line.height_across:g} mm"
            rows.append(("bearings", line.name, line.body, line.base, line.height, size))
        for device in structure.device_list:
            body, base, height = device_ends(structure, device)
            rows.append((device.kind, device.name, body, base, height, device.describe()))
        columns = ["part", "name", "body", "base", "height_mm", "size"]
        table = pd.DataFrame(rows, columns=columns)
        if structure.plan:
            table[["x_mm", "y_mm"]] = self._places()
        return table

    def _places(self) -> list[tuple[float, float]]:
        """Return where each of the parts is in plan [mm]."""
        structure = self.structure
        return [
            *map(structure.point, structure.masses),
            *map(structure.point, structure.springs),
            *(structure.place(hinge.body) for hinge in structure.hinges),
            *map(structure.point, structure.bearings),
            *map(structure.point, structure.device_list),
        ]

    @property
    def warnings(self) -> list[str]:
        """Numbers that usual structures do not have."""
        return [*implausible_structure(self.structure, self.prepared)]

    def tables(self) -> dict[str, Table]:
        """Return the parts and the modes."""
        return build_tables(self.structure, self.parts, self.table)

    def show(self) -> None:
        """Print what the model is made of, and its modes."""
        structure, tables = self.structure, self.tables()
        say(": ".join(filter(None, (structure.name, structure.description))), "bold")
        show_table(tables["parts"])
        say(
            f"\ntotal mass {TONNES * self.mass:g} t ({self.mass_model} matrix), damping "
            f"{structure.damping.kind}; bearings with their equivalent stiffness"
        )
        show_table(tables["periods"])
        print_warnings(self.warnings)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
        structure = self.structure
        return {
            "command": "structures show",
            "structure": structure.name,
            "description": structure.description,
            "citation": structure.citation,
            "version": thermobearing.__version__,
            "outcome": COMPLETED,
            "warnings": self.warnings,
            "mass_t": TONNES * self.mass,
            "mass_model": self.mass_model,
            "damping": structure.damping.kind,
            "reported_line": structure.bearings[reported_line(structure)].name,
            "piers": [
                {
                    "name": pier.name,
                    "base": pier.base,
                    "top_mm": pier.top,
                    "hinge": None
                    if pier.hinges[0] is None
                    else list_hinges(structure)[pier.hinges[0]].name,
                }
                for pier in list_piers(structure)
            ],
            "parts": self.parts.to_dict("records"),
            "modes": self.table.to_dict("records"),
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / STRUCTURE_PARTS, self.parts)
        write_csv(folder / PERIODS, self.table)
        text = sourced_toml(self.structure, self.structure.sources)
        (folder / RESOLVED).write_text(text, encoding="utf-8")


@checked
def examine_structure(
    structure: Structure | str | Path,
    *,
    fixed: bool = False,
    mass: MassModel = "consistent",
    damping: DampingKind | None = None,
) -> StructureResult:
    """Examine a structure: parts, periods, damping, mode shapes, a drawing of the model.

    Parameters
    ----------
    structure : Structure, str or Path
        A Structure, a name of `list_structures()`, or a TOML file.
    fixed : bool
        Leave out the springs of the foundation.
    mass : str
        Mass matrix, "consistent" (default) or "published".
    damping : str, optional
        Kind of damping; that of the structure by default.

    Raises
    ------
    InputError
        No such structure, faults in the file, or a mechanism.

    Examples
    --------
    >>> examine_structure("pier-p1").table["period_s"].round(3).tolist()
    [1.746, 0.496, 0.082, 0.044]
    """
    if mass not in get_args(MassModel):
        raise InputError(f"mass = {mass!r}: must be one of {', '.join(get_args(MassModel))}")
    if not isinstance(structure, Structure):
        structure = load_structure(structure)
    structure = fixed_base(structure) if fixed else structure
    return StructureResult(prepare_structure(structure, mass, damping), mass)
