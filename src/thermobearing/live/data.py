"""Data that the engine of the live page needs in addition to its module, as JSON.

The page computes with the kernels that Python uses, compiled to WebAssembly (`live/engine.js`).
Everything that Python knows and kernels do not is data here: constants of the bearings, matrices
of the structure, ground motions, limits of fields and sentences.
"""

import base64
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import thermobearing
from thermobearing.bearing.library import as_bearing, list_bearings
from thermobearing.bearing.model import (
    EARLIEST,
    HARDEST,
    LATEST,
    SOFTEST,
    THINNEST_SEALING,
    Bearing,
    RubberHysteresis,
    calibration_ranges,
)
from thermobearing.bearing.scaling import acting_rate
from thermobearing.bearing.state import in_state
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.schema import field_limits
from thermobearing.border.toml import read_toml
from thermobearing.core.compiled.native import DESCRIPTION, FOLDER, read_description, read_library
from thermobearing.core.lead_ends import longest_rest_step
from thermobearing.core.numbers import PARTS, LayerLaw
from thermobearing.core.records import labels
from thermobearing.core.types import COMPLETED, DEPTH, NEVER_MOVED, SOFTENED, BearingResponse
from thermobearing.cyclic.protocol import LARGEST_STRAIN, Cycles, CyclicTest, Rest, cyclic_test
from thermobearing.model.lead_ends import lead_sizes
from thermobearing.model.lead_impedance import MOST_TERMS, ROOM
from thermobearing.model.options import BearingModel, build_model
from thermobearing.model.outcomes import (
    ALL_SENTENCES,
    NOT_PHYSICAL,
    PIER_BEYOND_LIMIT,
    possible_temperatures,
)
from thermobearing.model.stack import MM_PER_M, EndFace
from thermobearing.motions.library import load_motion
from thermobearing.motions.record import GroundMotion
from thermobearing.results.metrics import LEAST_ENERGY
from thermobearing.structure.model import load_structure, reported_line
from thermobearing.structure.run import (
    BETA,
    GAMMA,
    HALVINGS,
    ITERATIONS,
    OUTCOMES,
    TOLERANCE,
    Line,
    Method,
    Prepared,
    build_system,
    new_motion,
    prepare_structure,
)

MODULE = "wasm32.wasm"
BUILD = "This installation has no kernels for web pages. In a clone, run `make kernels`."
MOTIONS = ("jra-ii-i-1",)
STRUCTURE = "pier-p1"
CALLED = re.compile(r'kernels\.call\("([\w.]+)"')  # a kernel that the engine calls
RUBBER = tuple(name for name in LayerLaw._fields if name in RubberHysteresis.model_fields)
# Numbers of a bearing file that make the law of a layer, as LayerLaw has them.
LAYERS = {"thickness": "geometry.rubber_thickness", **{k: f"hysteresis.{k}" for k in RUBBER}}
# Tables of a bearing file whose numbers the page can change.
EDITABLE = {
    "geometry": (
        "rubber_layers",
        "rubber_thickness",
        "shim_thickness",
        "end_plate_thickness",
        "sealing_plate_thickness",
    ),
    "hysteresis": RUBBER,
    "lead": ("cores", "diameter", "stiffness", "yield_stress", "softening"),
    "rate": ("stiffness", "damping"),
}


def live_module() -> bytes:
    """Return the WebAssembly module of the kernels.

    Raises InputError if the installation has none, or it was built from other sources.
    """
    with _built():
        return read_library(FOLDER, Path(MODULE).stem)[1]


@contextmanager
def _built() -> Iterator[None]:
    """Raise an InputError with the cure where the module is missing or does not fit."""
    if not (FOLDER / MODULE).is_file() or not (FOLDER / DESCRIPTION).is_file():
        raise InputError(BUILD)
    try:
        yield
    except ValueError as problem:
        raise InputError(
            f"The kernels for web pages cannot be used: {problem}. Run `make kernels` again."
        ) from None


def engine_source() -> str:
    """Return the text of the engine, a JavaScript module without imports."""
    return Path(__file__).with_name("engine.js").read_text(encoding="utf-8")


def live_data(
    bearings: Sequence[str | Path | Bearing] | None = None,
    motions: Sequence[str] = MOTIONS,
    structure: str = STRUCTURE,
) -> dict[str, Any]:
    """Return what `createEngine` of the engine takes, for `json.dumps`.

    The bearings are all of the library by default; motions and structures are those of the package.
    """
    names = list_bearings() if bearings is None else bearings
    selected = [as_bearing(name) for name in names]
    return engine_data([(bearing, build_model(bearing)) for bearing in selected]) | {
        "fields": _fields(selected),
        "structures": {structure: structure_data(_prepared(structure))},
        "motions": {name: motion_data(load_motion(name)) for name in motions},
        "protocols": {"table-3.4": engine_steps(cyclic_test())},
        "factors": read_toml(data_path("factors", "published.toml")),
    }


def engine_data(models: Sequence[tuple[Bearing, BearingModel]]) -> dict[str, Any]:
    """Return what the engine needs to test some bearings; InputError without a module."""
    for bearing, _ in models:
        if bearing.hysteresis_law is not None:
            raise InputError(f"{bearing.name}: a live page cannot have a hysteresis_law")
        if bearing.geometry.plan.inner_perimeter:
            raise InputError(f"{bearing.name}: a live page cannot have a plan with a hole")
    with _built():
        description = read_description(FOLDER)
    kernel_names = sorted(set(CALLED.findall(engine_source())))
    entries = {name: description["entries"][name] for name in kernel_names}
    coldest, hottest = possible_temperatures()
    return {
        "version": thermobearing.__version__,
        "sources": description["sources"],
        "kernels": {
            "entries": entries,
            **{  # of single runs
                part: {
                    name: layout
                    for name, layout in description[part].items()
                    if "Lanes" not in name
                }
                for part in ("records", "rows")
            },
        },
        "start": {"turns": DEPTH + 2, "idle": NEVER_MOVED},
        "response": [label._asdict() for label in labels(BearingResponse)],
        "parts": PARTS,
        "layer_law": LAYERS,
        "network": {"room": ROOM, "terms": MOST_TERMS},
        "limits": {
            "coldest": coldest,
            "hottest": hottest,
            "strain": LARGEST_STRAIN,
            "least_energy": LEAST_ENERGY,
            "thinnest_sealing": THINNEST_SEALING,
            "yield_strain": [EARLIEST, LATEST],
            "modulus_MPa": [SOFTEST, HARDEST],
        },
        "outcomes": {
            "good": [COMPLETED, SOFTENED],
            "names": {str(number): name for number, name in OUTCOMES.items()},
            "not_physical": NOT_PHYSICAL,
            "pier_beyond_limit": PIER_BEYOND_LIMIT,
            "sentences": ALL_SENTENCES,
        },
        "bearings": {bearing.name: _bearing(bearing, model) for bearing, model in models},
        "structures": {},
        "motions": {},
    }


def _tree(value: Any) -> Any:
    """Return numbers as they are, arrays as bytes with their shape, records by field."""
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: _tree(item) for name, item in zip(value._fields, value, strict=True)}
    if isinstance(value, np.ndarray):
        content = base64.b64encode(np.ascontiguousarray(value).tobytes()).decode("ascii")
        return {"shape": list(value.shape), "bytes": content}
    return value.item() if isinstance(value, np.generic) else value


def _values(bearing: Bearing) -> dict[str, Any]:
    """Return the numbers of a bearing that the page can change, by their key in its file."""
    plan = bearing.geometry.plan
    numbers = {f"geometry.plan.{name}": getattr(plan, name) for name in _plan_sizes(bearing)}
    for table, names in EDITABLE.items():
        part = acting_rate(bearing) if table == "rate" else getattr(bearing, table)
        if part is not None:
            numbers |= {f"{table}.{name}": getattr(part, name) for name in names}
    return numbers


def _plan_sizes(bearing: Bearing) -> tuple[str, ...]:
    """Return the sizes of a plan: along the motion and across, or one for both."""
    plan = bearing.geometry.plan
    return tuple(name for name in ("length", "width", "side", "diameter") if hasattr(plan, name))


def _bearing(bearing: Bearing, model: BearingModel) -> dict[str, Any]:
    # None stands for infinite numbers, which JSON does not have.
    law, stack, longest = bearing.temperature_law, model.stack, longest_rest_step(model.constants)
    return {
        "name": bearing.name,
        "kind": bearing.kind,
        "description": bearing.description,
        "citation": bearing.citation,
        "values": _values(bearing),
        "area_mm2": bearing.area,
        "rubber_thickness_mm": bearing.total_rubber_thickness,
        "plan": {
            "shape": bearing.geometry.plan.shape,
            "sizes": [f"geometry.plan.{name}" for name in _plan_sizes(bearing)],
            "share": bearing.geometry.plan._share,
        },
        "stack": {
            "part": list(stack.part),
            "thickness_mm": stack.thickness.tolist(),
            "depth_mm": stack.depth.tolist(),
            "half": stack.fold == 2,
        },
        "lead_ends": model.options.lead_ends if bearing.lead else None,
        "heat_source": model.options.heat_source,
        "tested_range": calibration_ranges(bearing),
        "law_range": None if law is None else law.range,
        "constants": _tree(model.constants),
        "longest_rest_step": float(longest) if np.isfinite(longest) else None,
        "cells": bearing.cells.model_dump() | {"plate_grading": bearing.cells.grading},
        "given": _fixed_numbers(bearing, model),
    }


def _fixed_numbers(bearing: Bearing, model: BearingModel) -> dict[str, Any]:
    """Return the plain numbers that the page cannot change, as kernels take them."""
    materials = bearing.materials
    steel, rubber, lead = materials.steel, materials.rubber, materials.lead
    face = model.options.upper_face
    numbers: dict[str, Any] = {
        "steel_conductivity": steel.conductivity / MM_PER_M,
        "steel_heat": steel.volumetric_heat,
        "rubber_conductivity": rubber.conductivity / MM_PER_M,
        "rubber_heat": rubber.volumetric_heat,
        "side_film": model.stack.side_film,
        "eta": face.eta or 0.0,
        "film": (face.film or 0.0) / MM_PER_M**2,
        "fold": model.stack.fold,
    }
    scragging = in_state(bearing, model.options.state).scragging
    if scragging is not None:
        numbers["scragging_strain"] = scragging.strain
    if bearing.lead is not None and lead is not None:
        clock = lead if bearing.lead.clock == "lead" else steel
        numbers |= {
            "surface_ratio": bearing.lead.surface_ratio,
            "confined": bearing.lead.confined,
            "lead_heat": lead.volumetric_heat,
            # The engine computes the film, which JSON could not hold where it is infinite.
            "lead_sizes": _tree(lead_sizes(bearing, model.stack, EndFace(film=0.0), None)),
            "diffusivity": clock.conductivity / MM_PER_M / clock.volumetric_heat,
        }
    return numbers


def _fields(bearings: Sequence[Bearing]) -> dict[str, Any]:
    """Return unit, limits and the words of `check` for each number that the page can change."""
    fields: dict[str, Any] = {}
    for bearing in bearings:
        for path in _values(bearing):
            if path not in fields:
                *tables, name = path.split(".")
                part: Any = bearing
                for table in tables:
                    part = getattr(part, table)
                fields[path] = field_limits(type(part), name)
    return fields


@cache
def _prepared(name: str) -> Prepared:
    return prepare_structure(load_structure(name))


def structure_data(
    prepared: Prepared, dt: float = 0.005, method: Method = "average-acceleration"
) -> dict[str, Any]:
    """Return a structure as the engine takes it, with the largest time step [s] and the method."""
    # The matrices do not depend on the bearings, of which all lines have the same.
    constants = build_model(as_bearing(list_bearings()[0])).constants
    line = Line(constants, np.zeros(len(constants.cells.capacity)))
    system = build_system(prepared, [line] * len(prepared.structure.bearings))
    (pier, top, base), structure = prepared.piers[0], prepared.structure
    return {
        "name": structure.name,
        "description": structure.description,
        "dt_s": dt,
        "system": _tree(system),
        "motion": _tree(new_motion(system)),
        "scheme": {
            "beta": BETA[method],
            "gamma": GAMMA,
            "tolerance": TOLERANCE,
            "iterations": ITERATIONS,
            "halvings": HALVINGS,
        },
        "deck": prepared.deck.tolist(),
        "top": top.tolist(),
        "base": base.tolist(),
        "hinge": pier.hinges[0],
        "line": reported_line(structure),
        "yield_rotations": [hinge.yield_rotation for hinge in structure.hinges],
        "piers": [
            {"height_mm": pier.height, "moved": (top - base).tolist(), "hinge": pier.hinges[0]}
            for pier, top, base in prepared.piers
        ],
        "limits": {"ductility": structure.limits.ductility, "drift": structure.limits.drift},
    }


def motion_data(motion: GroundMotion) -> dict[str, Any]:
    """Return a ground motion as the engine takes it."""
    return {
        "name": motion.name,
        "dt_s": motion.dt,
        "acceleration_mm_s2": _tree(np.asarray(motion.acceleration, dtype=float)),
    }


def engine_steps(test: CyclicTest) -> list[dict[str, Any]]:
    """Return the steps of a test for the engine; InputError for others than cycles and rests."""
    steps: list[dict[str, Any]] = []
    for step in test.steps:
        if isinstance(step, Cycles):
            steps.append(
                {
                    "strain": step.strain,
                    "amplitude_mm": step.amplitude,
                    "cycles": step.count,
                    "wave": "triangle" if step.wave == "triangular" else "sine",
                    "speed_mm_s": step.speed,
                    "frequency_hz": step.frequency or (step.period and 1.0 / step.period),
                    "closing_strain": step.closing_strain,
                }
            )
        elif isinstance(step, Rest):
            steps.append({"rest_s": step.duration, "rest_within_K": step.within})
        else:
            raise InputError(f'The engine of the live page has no step "{step.step}".')
    return steps
