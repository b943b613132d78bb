"""A study from the table of its file; all errors are in one message."""

import re
from itertools import product
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing, load_device
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.new import new_bearing
from thermobearing.border.cases import absolute, load_things, unlike
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import Library, is_path
from thermobearing.border.opener import is_file
from thermobearing.border.schema import Strict, validated
from thermobearing.border.title import case_table
from thermobearing.border.units import with_unit
from thermobearing.earthquake.case import (
    EarthquakeCase,
    FurtherAnalyses,
    make_earthquake_case,
    settle_surroundings,
)
from thermobearing.earthquake.motions import settle_motions
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.model.limits import CodeChecks
from thermobearing.motions.record import GroundMotion
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.structure.model import load_structure
from thermobearing.studies.definition import record
from thermobearing.studies.definition.designs import Plan, reach_faults
from thermobearing.studies.definition.motions import STAND_IN, motions_to_be, with_kept
from thermobearing.studies.definition.targets import affects_rest_temperature, spelled

M = TypeVar("M", bound=Strict)
NAMED = {"bearings": "bearing", "motions": "motion", "structure": "structure", "ambient": "ambient"}
FACTORS = {
    "structure": record.StructureFactor,
    "bearing": record.BearingFactor,
    "motion": record.MotionFactor,
    "scale": record.ScaleFactor,
    "ambient": record.AmbientFactor,
}
DEFAULT = "pier-p1"  # structure, as in `bridge`
KEY = re.compile(r"[a-z_][\w.\[\]]*(?: = |: )")  # start of a problem that begins with its key
# Keys of a case that a study does not have.
REFUSED = {
    "weather": "use factors.ambient",
    "initial_state": "the bearings of a study have no earlier loading",
    "initial_result": "the bearings of a study have no earlier loading",
    "rig": "a study has no rig",
    **dict.fromkeys(CodeChecks.model_fields, "a study checks no bearings after codes"),
    **dict.fromkeys(FurtherAnalyses.model_fields, "a study has its own runs only"),
}
STUDIES = Library("study", "studies")


def load_study(name_or_path: str | Path) -> record.Study:
    """Return a study from its TOML file, or an example; InputError lists all errors of the file."""
    path = STUDIES.path(name_or_path)
    return with_kept(make_study(case_table(path), str(path), path.parent), path.parent)


def make_study(table: dict[str, Any], where: str, folder: Path = Path()) -> record.Study:
    """Check a study from the table of a file; paths in it are relative to `folder`."""
    unknown = [
        f'unknown key "{key}"{nearest(key, record.Study.model_fields)}'
        for key in table
        if key not in record.Study.model_fields
    ]
    if table.get("kind") != "study":
        raise InputError([f'kind = {table.get("kind")!r}: must be "study"', *unknown], where)
    study, faults = _settled(table, folder)
    if study is None or faults or unknown:
        raise InputError([*unknown, *faults], where)
    return study


def _settled(table: dict[str, Any], folder: Path) -> tuple[record.Study | None, list[str]]:
    """Return the study of a table, or None, and the errors."""
    faults: list[str] = []
    case, factor_tables = _split_table(table, faults)
    parts: dict[str, Any] = {}
    for key, model in (("design", record.Design), ("keep", record.Keep)):
        parts[key] = _checked(model, table.get(key, {}), key, faults)
    motions: list[GroundMotion] = []
    if "motion" in factor_tables:
        motions = _settle_motions(factor_tables["motion"], folder, faults)
    if "bearing" in factor_tables:
        _settle_bearings(factor_tables["bearing"], folder, faults)
    _settle_structures(factor_tables["structure"], folder, faults)
    if "ambient" in factor_tables:
        _settle_weather(factor_tables["ambient"], folder)
    checked_factors: dict[str, Any] = {
        name: _checked(FACTORS.get(name, record.NumberFactor), item, f"factors.{name}", faults)
        for name, item in factor_tables.items()
    }
    numbers = {
        name: checked_factors.pop(name) for name in list(checked_factors) if name not in FACTORS
    }
    faults += [
        f"factors: factors.{name} is missing"
        for name in ("bearing", "motion", "ambient")
        if name not in factor_tables
    ]
    study_name = table.get("name")
    if not isinstance(study_name, str):
        faults.append(
            'missing key "name"' if study_name is None else f"name = {study_name!r}: must be text"
        )
    if faults:
        return None, faults
    try:
        if checked_factors["motion"].matched is not None:
            motions = motions_to_be(checked_factors["motion"])
        factors = validated(record.Factors, checked_factors | {"numbers": numbers}, "")
        common_case, factors = _with_case(case, factors, motions, folder)
        study_table = {"name": study_name, "case": common_case, "factors": factors}
        study = validated(record.Study, study_table | parts, "")
    except InputError as error:
        return None, error.lines()
    return study, _study_faults(study)


def _split_table(table: dict[str, Any], faults: list[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the common case of all runs, and the table of each factor."""
    case, factors = table.get("case", {}), table.get("factors", {})
    for key, item in (("case", case), ("factors", factors)):
        if not isinstance(item, dict):
            faults.append(f"{key}: must be a table")
    case = dict(case) if isinstance(case, dict) else {}
    factor_tables = {"structure": [DEFAULT]} | (dict(factors) if isinstance(factors, dict) else {})
    factor_names = [*FACTORS, "bearing.K_r", "structure.<...>", "case.<...>"]
    for name in factor_tables:
        if name not in FACTORS and "." not in name:
            faults.append(f'unknown factor "{name}"{nearest(name, factor_names)}')
    for key, name in NAMED.items():
        if key not in case:
            continue
        if isinstance(factors, dict) and name in factors:
            faults.append(f"case.{key}: also given as factors.{name}; remove one of them")
        factor_tables[name] = case.pop(key)
    faults += [f"case.{key}: {REFUSED[key]}" for key in case if key in REFUSED]
    return case, {name: _as_table(item) for name, item in factor_tables.items()}


def _as_table(item: Any) -> Any:
    """Return a factor as a table; levels may be given alone, and one level without a list."""
    if isinstance(item, dict):
        levels = item.get("levels")
        is_single = levels is not None and not isinstance(levels, list | tuple)
        return {**item, "levels": [levels]} if is_single else dict(item)
    return {"levels": list(item) if isinstance(item, list | tuple) else [item]}


def _checked(model: type[M], table: Any, key: str, faults: list[str]) -> M | None:
    try:
        return validated(model, table, "")
    except InputError as error:
        messages = [
            f"{key}.{text}" if KEY.match(text) else f"{key}: {text}" for text in error.problems
        ]
        faults += unlike(messages, faults)
        return None


def _settle_structures(table: dict[str, Any], folder: Path, faults: list[str]) -> None:
    if not isinstance(table.get("levels"), list):
        return
    faults += load_things(table, "levels", load_structure, folder, before="factors.structure.")
    faults += _duplicate_faults(table["levels"], "structure")


CHANGES = {  # by which a level gets another name in Python
    "bearing": 'tb.changed_bearing("...", name="...")',
    "structure": 'model_copy(update={"name": "..."})',
}


def _duplicate_faults(levels: list[Any], factor: str) -> list[str]:
    names = [getattr(item, "name", "") for item in levels]
    duplicates = dict.fromkeys(name for name in names if name and names.count(name) > 1)
    return [
        f'factors.{factor}.levels: two have the name "{name}"; give one another name, by the key '
        f"name of its file or table, or in Python by {CHANGES[factor]}"
        for name in duplicates
    ]


def _settle_weather(table: dict[str, Any], folder: Path) -> None:
    """Make the paths of weather and of a climate file absolute."""
    absolute(table, "weather", folder)
    if is_path(table.get("climate") or ""):
        absolute(table, "climate", folder)


def _settle_motions(table: dict[str, Any], folder: Path, faults: list[str]) -> list[GroundMotion]:
    """Make the paths of motions absolute; return the motions."""
    levels, matched = table.get("levels"), table.get("matched")
    if isinstance(matched, str) and is_file(folder / matched):
        table["matched"] = str((folder / matched).absolute())
    if not isinstance(levels, list):
        return []
    table["levels"], motions, motion_faults = settle_motions(
        levels, folder, "factors.motion.levels[{}]"
    )
    faults += [text.replace("motions:", "factors.motion:", 1) for text in motion_faults]
    pairs = [level for level in table["levels"] if isinstance(level, dict) and "across" in level]
    if matched is not None and pairs:
        faults.append("factors.motion.matched: single records can be matched, not pairs")
    if not motion_faults:  # a plan has names without paths
        for item, motion in zip(table["levels"], motions, strict=False):
            if isinstance(item, dict) and item.get("label") is None:
                item["label"] = motion.name
    return motions


def _with_case(
    case: dict[str, Any], factors: record.Factors, motions: list[GroundMotion], folder: Path
) -> tuple[EarthquakeCase, record.Factors]:
    """Return the common case of all runs, and factors with complete structures."""
    ambient = factors.ambient.levels[0] if factors.ambient.levels else 0.0
    bearings = [
        level.bearing if isinstance(level, record.Posterior) else level
        for level in factors.bearing.levels
    ]
    if factors.ambient.hourly:
        case = dict(case)
        settle_surroundings(case)
    # The case of each structure has the first bearing, motion and temperature; a motion that is to
    # be matched does not exist yet, and a built-in one takes its place.
    recorded = factors.motion.levels if factors.motion.matched is None else None
    motion = recorded[0] if recorded else STAND_IN
    first = {
        "bearings": bearings[:1],
        "motions": [motion],
        "ambient": [with_unit(ambient, "degC")],
    }
    cases = [
        make_earthquake_case({**case, **first, "structure": structure}, "case", folder)
        for structure in factors.structure.levels
    ]
    faults: list[str] = []
    for level_case in cases:
        faults += level_case.model_copy(update={"bearings": bearings}).faults()
    faults += cases[0].motion_faults(motions)
    if faults:
        raise InputError([f"case: {text}" for text in dict.fromkeys(faults)])
    structures = [level_case.structure for level_case in cases]
    factor = factors.structure.model_copy(update={"levels": structures})
    return cases[0], factors.model_copy(update={"structure": factor})


def _plan_faults(study: record.Study) -> list[str]:
    """Return what cannot be combined with structures in plan, which are moved by pairs."""
    motion, plans = study.factors.motion, [level.plan for level in study.factors.structure.levels]
    if not any(plans):
        return []
    if not all(plans):
        return ["factors.structure: structures in plan and others require separate studies"]
    pairs = motion.matched is None and all(level.is_pair for level in motion.levels or [])
    if not pairs or study.case.components == 1:
        return [
            "factors.motion: a study of structures in plan takes pairs, which act together; give "
            "every motion across, and leave out components"
        ]
    if study.keep.histories != "none":
        return ["keep.histories: not available for structures in plan"]
    return []


def _study_faults(study: record.Study) -> list[str]:
    """Return the errors in the combination of the parts of a study."""
    factors, faults = study.factors, []
    laboratory = study.case.laboratory
    if laboratory is not None and len(laboratory.mode) > 1:
        faults.append("case.laboratory.mode: a study has one mode")
    if study.case.specimen is not None:
        faults.append("case.laboratory.specimen: a study cannot use a real specimen; remove it")
    faults += _plan_faults(study)
    keys: dict[tuple[str, str], list[str]] = {}
    for name in factors.numbers:
        keys.setdefault(spelled(name), []).append(name)
    faults += [
        f"factors: {' and '.join(names)} are the same number"
        for names in keys.values()
        if len(names) > 1
    ]
    try:
        weather = factors.ambient.read_weather()
        if weather is not None:
            weather.hours_at(np.zeros(1), factors.ambient.history or 0.0)
    except InputError as error:
        faults += error.lines("factors.ambient")
    try:
        plan = Plan(study)
        faults += [*reach_faults(plan), *_heat_faults(plan)]
    except InputError as error:
        faults += error.problems
    return faults


def _heat_faults(plan: Plan) -> list[str]:
    """Return the errors of varied thermal properties where many runs share their temperatures."""
    ambient = plan.study.factors.ambient
    names = [target.name for target in plan.targets if affects_rest_temperature(target)]
    faults = []
    if ambient.hourly and ambient.history is None:
        faults += [
            f"factors.{name}: changes thermal properties, so that every run would integrate over "
            'all weather before it, which takes 20 times as long; set history = "10 d" in '
            "factors.ambient, which is long enough"
            for name in names
        ]
    if plan.study.design.lockstep:
        faults += [
            f"design.lockstep: true is impossible, because factors.{name} changes thermal "
            "properties from run to run; remove it"
            for name in names
        ]
    return faults


AnyLevel = Bearing | BilinearBearing | record.Posterior | Any  # others are found by later checks
ANY = "shen-bilinear-bridge"
OF_POSTERIOR = ("posterior", "bearing", "count", "name")
OF_COMPOUND = ("compound", "size", "name")
SIZES = ("plan", "diameter", "hole", "layers", "shim", "end_plate", "sealing_plate", "lead")  # text
OTHERS = ("cores", "confined", "end_spreading")


def _settle_bearings(table: dict[str, Any], folder: Path, faults: list[str]) -> None:
    """Replace the levels of a table `factors.bearing` by records of bearings and posteriors."""
    inline_level: dict[str, Any] = {}
    if {"posterior", "compound"} & set(table):
        inline_level = {
            key: table.pop(key)
            for key in list(table)
            if key not in record.BearingFactor.model_fields
        }
    if inline_level and "levels" in table:
        faults.append(
            f"factors.bearing: {', '.join(sorted(inline_level))} in addition to levels; add a "
            'level such as {posterior = "fit"} instead'
        )
    levels = table.get("levels") if not inline_level else [inline_level]
    if not isinstance(levels, list):
        return
    level_records: list[AnyLevel] = []
    faults_before = len(faults)
    for number, item in enumerate(levels):
        key = "factors.bearing" if inline_level else f"factors.bearing.levels[{number}]"
        try:
            level_records += _level(item, folder)
        except InputError as error:
            faults += error.lines(key)
    # After an error a library bearing lets the other checks continue.
    table["levels"] = level_records
    if len(faults) > faults_before and not level_records:
        table["levels"] = [load_device(ANY)]
    faults += _duplicate_faults(level_records, "bearing")


def _level(item: Any, folder: Path) -> list[AnyLevel]:
    if isinstance(item, str | Path):
        return [load_device(folder / item if str(item).endswith(".toml") else item)]
    if isinstance(item, dict) and "posterior" in item and item.get("kind") != "posterior":
        return [_posterior(item, folder)]
    if isinstance(item, dict) and "compound" in item:
        return list(_compound_bearings(item, folder))
    return [item]


def _posterior(item: dict[str, Any], folder: Path) -> record.Posterior:
    """Return the checked samples of a calibration, from its directory or file."""
    _refuse_unknown(item, OF_POSTERIOR)
    source = item["posterior"]
    if not isinstance(source, str | Path) or not str(source):
        raise InputError("posterior: must be the directory of a calibration, or its posterior.csv")
    path = (folder / source).absolute()
    path = path if is_file(path) else path / SAMPLES
    if not is_file(path):
        raise InputError(
            f'posterior = "{source}": has no {SAMPLES}; identify writes it with --posterior'
        )
    fitted, bearing = path.with_name(IDENTIFIED), item.get("bearing")
    if bearing is None and not is_file(fitted):
        raise InputError(
            f"posterior: the key bearing is missing, and there is no {IDENTIFIED} next to it"
        )
    if isinstance(bearing, str | Path):
        is_file_name = str(bearing).endswith(".toml")
        bearing = load_bearing(folder / bearing if is_file_name else bearing)
    bearing = load_bearing(fitted) if bearing is None else bearing
    if not isinstance(bearing, Bearing):
        raise InputError("bearing: must be the name or the file of a bearing")
    options = {"count": item["count"]} if "count" in item else {}
    posterior = record.Posterior(
        name=item.get("name", bearing.name), posterior=str(path), bearing=bearing, **options
    )
    # Raises InputError where the samples do not fit the bearing.
    posterior_bearings(posterior.bearing, path, posterior.count)
    return posterior


def _compound_bearings(item: dict[str, Any], folder: Path) -> list[Bearing]:
    """Return bearings of a compound, one for each combination of sizes."""
    _refuse_unknown(item, OF_COMPOUND)
    size = item.get("size")
    if not isinstance(size, dict) or not size:
        raise InputError(
            'size: must be a table such as {plan = "1 x 1 m", layers = "20x8mm", shim = "3 mm"}'
        )
    for key in size:
        if key not in (*SIZES, *OTHERS):
            raise InputError(f'size: unknown key "{key}"{nearest(key, [*SIZES, *OTHERS])}')
    if missing := [key for key in ("layers", "shim") if key not in size]:
        raise InputError(f"size: missing {' and '.join(missing)}")
    compounds = _listed(item["compound"])
    choices = {"compound": compounds} | {key: _listed(value) for key, value in size.items()}
    for key in set(SIZES) & set(size):
        for value in choices[key]:
            if not isinstance(value, str):
                raise InputError(f'size.{key} = {value!r} has no unit; write "{value} mm"')
    varied = [key for key, values in choices.items() if len(values) > 1]
    bearings = []
    for values in product(*choices.values()):
        sizes = dict(zip(choices, values, strict=True))
        compound = sizes.pop("compound")
        compound_source = folder / compound if is_path(compound) else compound
        words = [str(item.get("name", Path(str(compound)).stem))]
        words += [f"{key} {sizes[key]}" for key in varied if key != "compound"]
        if "name" in item and "compound" in varied:
            words.append(Path(str(compound)).stem)
        name = " ".join(words).replace("/", " ").replace("\\", " ")
        bearings.append(new_bearing(name, compound_source, **sizes))
    return bearings


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _refuse_unknown(item: dict[str, Any], known_keys: tuple[str, ...]) -> None:
    unknown = [
        f'unknown key "{key}"{nearest(key, known_keys)}' for key in item if key not in known_keys
    ]
    if unknown:
        raise InputError(unknown)
