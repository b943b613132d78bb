"""Check a file without running it: its kind, its main facts, and implausible values."""

from collections.abc import Callable
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from thermobearing.bearing.bilinear import BILINEAR, BilinearBearing, load_bilinear
from thermobearing.bearing.compound import COMPOUNDS, Compound, load_compound
from thermobearing.bearing.library import BEARINGS, load_bearing
from thermobearing.bearing.model import Bearing, TemperatureLaw, Validity
from thermobearing.bearing.plausible import implausible
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.opener import is_file
from thermobearing.border.toml import read_toml, split_sources, to_table
from thermobearing.climate.generator import Climate, load_climate
from thermobearing.cyclic.case import LIMITS, Case, Rig, load_case, load_rig
from thermobearing.cyclic.comparison import REFERENCE, TOLERABLE, cells_error
from thermobearing.cyclic.history import build_segments
from thermobearing.design.case import DesignCase, bearing_weight, load_design_case
from thermobearing.earthquake.case import EarthquakeCase, OnLine, load_earthquake_case
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.laws import find_law
from thermobearing.model.axial import BOLTED
from thermobearing.model.limits import Limits, load_limits
from thermobearing.model.options import build_model
from thermobearing.model.stack import build_stack
from thermobearing.opensees.case import ServedCase, load_served_case
from thermobearing.results.ranges import TESTED
from thermobearing.sequences.case import SequenceCase, load_sequence_case
from thermobearing.structure.model import STRUCTURES, DampingKind, Structure, load_structure
from thermobearing.structure.result import implausible_structure
from thermobearing.structure.run import prepare_structure
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.definition.motions import with_stand_ins
from thermobearing.studies.definition.record import Posterior, Study
from thermobearing.tables.laboratory import Sidecar

LIBRARIES = {"bearings", "bilinear", "climates", "compounds", "rigs", "structures", "studies"}
# Keys of one kind of file only, to recognise files that do not state what they are.
DESIGNS = set(DesignCase.model_fields) - set(EarthquakeCase.model_fields)
DESIGNS -= set(Sidecar.model_fields)
EARTHQUAKES = set(EarthquakeCase.model_fields) - set(Case.model_fields) - set(Sidecar.model_fields)
TESTS = set(Sidecar.model_fields) - set(Case.model_fields) - {"name", "speed"}


class Checked(NamedTuple):
    """The result of a check of a valid file."""

    kind: str
    facts: dict[str, str]
    warnings: list[str]


def named_file(path: Path) -> Path:
    """Return the file of a built-in bearing, compound or structure of that name, else the path."""
    for library in (BEARINGS, BILINEAR, COMPOUNDS, STRUCTURES):
        if str(path) in library.names() and not is_file(path):
            return library.path(str(path))
    return path


def check_file(path: Path) -> Checked:
    """Return the kind of a TOML file, its main facts, and warnings of implausible values.

    Kinds: "bearing", "bilinear bearing", "compound", "structure", "rig", "test record" (the file
    next to a CSV), "climate", "file of limits", "earthquake case", "study", "sequence case",
    "served case", "design case", and "case" of a cyclic test.
    """
    table, _ = split_sources(read_toml(path))
    kind = _find_kind(table, path)
    load, facts, parts = KINDS[kind]
    content = load(path)
    components = parts(content)
    structures = [component for component in components if isinstance(component, Structure)]
    bearings = {
        component.name: component
        for component in components
        if not isinstance(component, Structure)
    }
    for bearing in bearings.values():
        if isinstance(bearing, Bearing):
            build_model(bearing)  # raises what a run would raise about its laws
    named = (
        len([component for component in components if component not in structures]) > 1
        or "bearing" not in kind
    )
    warnings = [text for component in structures for text in implausible_structure(component)] + [
        f"{bearing.name}: {sentence}" if named else sentence
        for bearing in bearings.values()
        for sentence in implausible(bearing)
    ]
    return Checked(kind, facts(content), warnings)


def _find_kind(table: dict[str, Any], path: Path) -> str:
    """Return what a file is, by its keys."""
    keys = set(table)
    if table.get("kind") == "bilinear":
        return "bilinear bearing"
    if table.get("kind") in ("compound", "study"):
        return str(table["kind"])
    for kind, library in (("structure", STRUCTURES), ("compound", COMPOUNDS)):
        if table.get("based_on") in library.names():
            return kind
    # Data files of the package have keys that resemble those of cases.
    if path.parent.name not in LIBRARIES and path.absolute().is_relative_to(data_path()):
        raise InputError("is data of the package, not input of an analysis", str(path))
    if table.get("command") == "serve":
        return "served case"
    # The order matters: cases share keys, and the first kind that has one is taken.
    for kind, kind_keys in (
        ("file of limits", {"jra", "aashto", "pier"}),
        ("structure", {"bodies"}),
        ("sequence case", {"parts"}),
        ("earthquake case", {"command"}),
        ("bearing", {"geometry", "hysteresis", "materials", "kind", "based_on"}),
        ("climate", {"monthly_mean", "daily_range"}),
        ("design case", DESIGNS),
        ("earthquake case", EARTHQUAKES),
        ("test record", TESTS),
        ("rig", set(LIMITS)),
    ):
        if kind_keys & keys:
            return kind
    # A sidecar may be empty: the table next to it shows what it is.
    if "test" not in keys and is_file(path.with_suffix(".csv")):
        return "test record"
    return "case"


def _case_facts(case: Case) -> dict[str, str]:
    segments = build_segments(case.test, case.bearing.total_rubber_thickness)
    time = sum(float(segment.dt.sum()) for segment in segments)
    steps = sum(len(segment.x) for segment in segments)
    until = "at most " if any(segment.within for segment in segments) else ""
    ambient = case.ambient_series or ", ".join(f"{value:g} degC" for value in case.ambient)
    return {
        "bearing": f"{case.bearing.name} ({case.bearing.description})",
        "ambient": ambient,
        "test": f"{case.test.name}: " + "; ".join(segment.label for segment in segments),
        "duration": f"{until}{time:g} s in {until}{steps} steps per run",
        "scheme": f"{case.analysis.scheme}, {case.analysis.integrator} integrator",
    }


def _design_facts(case: DesignCase) -> dict[str, str]:
    loads = [
        f"{group.name}: {bearing_weight(case, group):.0f} kN per bearing".removeprefix(": ")
        for group in case.groups
    ]
    return {
        "compound": f"{case.compound_kind} {case.compound}",
        "motions": ", ".join(PurePath(motion.name).name for motion in case.motions),
        "start": f"{case.start:g} mm, {'; '.join(loads)}",
        "convergence": f"within {case.tolerance:.2%}, at most {case.most_rounds} rounds",
        "equal bearings": ", ".join(case.equal) or "none",
        **_structure_facts(case.structure),
    }


def _record_facts(record: TestRecord) -> dict[str, str]:
    return {
        "name": record.name,
        "bearing": record.bearing or "not named",
        "ambient": f"{record.ambient:g} degC",
        "samples": f"{len(record.time)} in {record.time[-1] - record.time[0]:g} s",
        "largest": f"{record.peak_displacement:.4g} mm, {record.peak_force:.4g} kN",
        "thermocouples": ", ".join(f"{k} ({v})" for k, v in record.places.items()) or "none",
        "assumed": "; ".join(record.assumptions) or "none",
    }


def _error(value: float) -> str:
    """Return an error with one digit and its sign, unless that digit would be zero."""
    return f"{value:+.1f}" if round(abs(value), 1) > 0.0 else "below 0.1"


def cells_facts(path: Path) -> dict[str, str]:
    """Return the error of the heat cells in the layers of a bearing, from a short test."""
    try:
        errors = cells_error(load_bearing(path))
    except InputError:
        return {"error of cells": "unknown: twice as many cells exceed the limit"}
    if errors is None:
        return {"error of cells": f"unknown: {REFERENCE} end early"}
    rise = f" of a rise of {errors.rise:.1f} K" if round(errors.rise, 1) > 0.0 else ""
    facts = {
        "error of cells": f"G {_error(100.0 * errors.stiffness)} %, energy "
        f"{_error(100.0 * errors.energy)} %, hottest layer {_error(errors.warming)} K{rise}",
        "estimated in": f"the last of {REFERENCE}, compared with twice as many cells",
    }
    if errors.worst > TOLERABLE:
        facts["advice"] = (
            f"{errors.cells} cells per layer are few; cells.rubber = {errors.advised}, shim = 2 "
            f"would reduce the error to about {100.0 * TOLERABLE:g} %"
        )
    return facts


def _earthquake_facts(case: EarthquakeCase) -> dict[str, str]:
    climates = case.weather or ", ".join(f"{value:g} degC" for value in case.ambient)
    count = len(case.bearings) * len(case.motions) * case.climates
    count *= len(case.modes) * len(case.directions)
    force = case.axial_force
    line_facts = {f"line {line.line}": _line_text(line) for line in case.lines}
    return {
        "command": case.command,
        "bearings": ", ".join(bearing.name for bearing in case.bearings),
        "motions": ", ".join(motion.title for motion in case.motions),
        "ambient": climates,
        **({} if force is None else {"axial force": f"{force:g} kN"}),
        **line_facts,
        "runs": f"{count}, {case.analysis.method}, dt {case.analysis.dt:g} s",
        **_structure_facts(case.structure, case.analysis.damping),
    }


def _line_text(line: OnLine) -> str:
    """Return the properties that a bearing line overrides."""
    parts = [line.bearing.name if line.bearing else "", line.weather or ""]
    parts += [f"{line.ambient:g} degC"] if line.ambient is not None else []
    parts += [f"{line.axial_force:g} kN"] if line.axial_force is not None else []
    return ", ".join(filter(None, parts))


def _study_facts(study: Study) -> dict[str, str]:
    plan = Plan(with_stand_ins(study))
    facts = {"design": study.design.kind, "runs": str(len(plan.runs))}
    for column in plan.columns:
        text = f"{len(column.levels)} levels"
        if len(column.levels) == 1:
            text = str(column.levels[0])
        elif column.distribution is not None:
            low, high = column.distribution.reach
            text = f"{column.distribution.kind}, {low:.4g} to {high:.4g} (one in a million outside)"
        elif column.share:
            text = "one value for each sample"
        facts[column.name] = text + (", chosen at random" if column.chances is not None else "")
    return facts


def _sequence_facts(case: SequenceCase) -> dict[str, str]:
    return {
        "bearing": f"{case.bearing.name} ({case.bearing.description})",
        "ambient": f"{case.ambient:g} degC",
        "parts": ", ".join(case.label(number) for number in range(len(case.parts))),
        "rig": case.rig.name if case.rig else "not named",
    }


def _served_facts(case: ServedCase) -> dict[str, str]:
    return {
        "bearing": f"{case.bearing.name} ({case.bearing.description})",
        "ambient": f"{case.ambient:g} degC",
        "element": f"{case.count} in parallel, in {case.units}-s",
        "axial force": f"of the nodes, {case.joint or BOLTED}" if case.has_axial else "off",
    }


def _structure_facts(structure: Structure, damping: DampingKind | None = None) -> dict[str, str]:
    """Return coordinates, masses, periods and damping of a structure."""
    prepared = prepare_structure(structure, damping=damping)
    total = 1e3 * sum(item.mass for item in structure.masses)
    about = f" ({structure.description})" if structure.description else ""
    return {
        "structure": f"{structure.name}{about}",
        "coordinates": ", ".join(prepared.matrices.coordinates),
        "mass": f"{total:g} t",
        "periods": ", ".join(f"{value:.3f}" for value in prepared.modes.periods) + " s",
        "damping": prepared.structure.damping.kind,
        "damping ratios": ", ".join(f"{value:.3f}" for value in prepared.ratios),
    }


def _bilinear_facts(bearing: BilinearBearing) -> dict[str, str]:
    return {
        "name": bearing.name,
        "description": bearing.description,
        "Q_d": f"{bearing.strength:g} kN",
        "K_1, K_2": f"{bearing.initial_stiffness:g}, {bearing.post_yield_stiffness:g} kN/mm",
        "rubber": f"{bearing.total_rubber_thickness:g} mm",
    }


def bearing_facts(bearing: Bearing) -> dict[str, str]:
    """Return the main dimensions and derived numbers of a bearing."""
    g = bearing.geometry
    half, full = build_stack(bearing, half=True), build_stack(bearing, half=False)
    return {
        "name": bearing.name,
        "kind": bearing.kind,
        "description": bearing.description,
        "plan": f"{g.plan.shape}, {bearing.area:g} mm2",
        "rubber": f"{g.rubber_layers} x {g.rubber_thickness:g} = {g.total_rubber_thickness:g} mm",
        "shims": f"{g.rubber_layers - 1} x {g.shim_thickness:g} mm",
        "end plates": f"{g.end_plate_thickness:g} mm",
        "shape factors": f"S1 = {g.first_shape_factor:.3g}, S2 = {g.second_shape_factor:.3g}",
        "temperatures": _range(bearing.temperature_law),
        "laws": _laws(bearing),
        "tested at": _tested(bearing.tested_range),
        "cells": f"{len(half.part)} in the half stack, {len(full.part)} in the full one",
    }


def _compound_facts(compound: Compound) -> dict[str, str]:
    """Return stresses, strains and other parameters of a compound."""
    rubber, lead, rate = compound.rubber, compound.lead, compound.rate
    facts = {
        "name": compound.name,
        "family": compound.family,
        "description": compound.description,
        "rubber": f"K_r t_r/A = {rubber.shear_modulus:.4g} MPa, alpha_0 = "
        f"{rubber.post_yield_ratio:.3g}, yield strain {rubber.yield_strain:.3g}, at "
        f"{rubber.reference_temperature:g} degC",
        "m_T, n_T": f"{rubber.elastic_temperature_coefficient:g}, "
        f"{rubber.hysteretic_temperature_coefficient:g} per 100 K",
        "temperatures": _range(compound.temperature_law),
        "tested at": _tested(compound.tested_range),
        "lead": f"{lead.yield_stress:g} MPa at {lead.reference_temperature:g} degC"
        if lead
        else "not stated",
        "rate": f"K_v H/A = {rate.shear_modulus:.3g} MPa" if rate else "rate-independent",
    }
    keys = ("rubber.elastic_temperature_coefficient", "rubber.hysteretic_temperature_coefficient")
    borrowed = sorted({compound.sources[key] for key in keys if key in compound.sources})
    return facts | {"source of m_T, n_T": "; ".join(borrowed)} if borrowed else facts


def _tested(tested: Validity | None) -> str:
    """Return the calibration range of a bearing or a compound."""
    if tested is None:
        return "range not given (tested_range)"
    ranges = [(*TESTED[name][1:4], ends) for name, ends in tested.ranges().items()]
    return ", ".join(
        f"{quantity} {' to '.join(dict.fromkeys(f'{factor * end:g}{unit}' for end in ends))}"
        for quantity, factor, unit, ends in ranges
    )


def _laws(bearing: Bearing) -> str:
    """Return the laws of a bearing by name; a registered one with its parameters."""
    rubber, registered = bearing.hysteresis, (bearing.temperature_law, bearing.hysteresis_law)
    names: list[str] = [rubber.hardening_form or "printed"]
    names += [] if bearing.hysteresis_law else [rubber.small_loops or "published"]
    for part in registered:
        if part is not None and part.law is not None:
            law = find_law(part.law)
            parameters = law.shown(law.values(part.parameters))
            names.append(f"{law.name} ({parameters})" if parameters else law.name)
    return ", ".join(names)


def _range(law: TemperatureLaw | None) -> str:
    """Return the range of a temperature law."""
    if law is None or law.range is None:
        return "the range of the temperature law is not stated (temperature_law)"
    low, high = law.range
    table = f", a table of {len(law.temperatures)} times m_T and n_T" if law.temperatures else ""
    return f"law identified at {low:g} to {high:g} degC{table}"


def _rig_facts(rig: Rig) -> dict[str, str]:
    limits = {name: getattr(rig, name) for name in LIMITS}
    text = {name: f"{v:g} {LIMITS[name][0]}" for name, v in limits.items() if v is not None}
    return {"name": rig.name, "description": rig.description, **text}


def _climate_facts(climate: Climate) -> dict[str, str]:
    coldest, warmest = min(climate.monthly_mean), max(climate.monthly_mean)
    monthly = f"{coldest:g} to {warmest:g} degC"
    return {"name": climate.name, "description": climate.description, "monthly means": monthly}


def _limits_facts(limits: Limits) -> dict[str, str]:
    return {
        f"{table}, {key.replace('_', ' ')}": str(entry["value"]) + f" ({limit.describe()})"
        for table, entries in to_table(limits).items()
        for key, entry in entries.items()
        if (limit := limits.of(table, key)) is not None
    }


def _levels(study: Study) -> list[Any]:
    """Return bearings and structures of a study, those that are levels."""
    bearings = [level for level in study.factors.bearing.levels if not isinstance(level, Posterior)]
    return [*bearings, *study.factors.structure.levels]


# Kind: how it is loaded, its facts, and the bearings and structures in it.
KINDS: dict[
    str, tuple[Callable[[Path], Any], Callable[[Any], dict[str, str]], Callable[[Any], list[Any]]]
] = {
    "bearing": (load_bearing, bearing_facts, lambda bearing: [bearing]),
    "bilinear bearing": (load_bilinear, _bilinear_facts, lambda bearing: [bearing]),
    "compound": (load_compound, _compound_facts, lambda _: []),
    "structure": (load_structure, _structure_facts, lambda structure: [structure]),
    "rig": (lambda path: load_rig(path.absolute()), _rig_facts, lambda _: []),
    "climate": (load_climate, _climate_facts, lambda _: []),
    "file of limits": (load_limits, _limits_facts, lambda _: []),
    "test record": (load_test, _record_facts, lambda _: []),
    "earthquake case": (
        load_earthquake_case,
        _earthquake_facts,
        lambda case: [*case.bearings, case.structure],
    ),
    "study": (load_study, _study_facts, _levels),
    "sequence case": (load_sequence_case, _sequence_facts, lambda case: [case.bearing]),
    "served case": (load_served_case, _served_facts, lambda case: [case.bearing]),
    "design case": (
        load_design_case,
        _design_facts,
        lambda case: [*map(load_bearing, case.equal), case.structure],
    ),
    "case": (load_case, _case_facts, lambda case: [case.bearing]),
}
