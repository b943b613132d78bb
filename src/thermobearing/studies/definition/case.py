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
from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.library import Library, is_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.units import with_unit
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case, settle_surroundings
from thermobearing.earthquake.motions import settle_motions
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.motions.record import GroundMotion
from thermobearing.report.title import case_table
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.structure.model import load_structure
from thermobearing.studies.definition import record
from thermobearing.studies.definition.designs import (
    list_targets,
    moves_warmth,
    reach_faults,
    spelled,
)
from thermobearing.studies.definition.motions import STAND_IN, motions_to_be, with_kept

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
    case, given = _parted(table, faults)
    parts: dict[str, Any] = {}
    for key, model in (("design", record.Design), ("keep", record.Keep)):
        parts[key] = _checked(model, table.get(key, {}), key, faults)
    motions: list[GroundMotion] = []
    if "motion" in given:
        motions = _settle_motions(given["motion"], folder, faults)
    if "bearing" in given:
        _settle_bearings(given["bearing"], folder, faults)
    _settle_structures(given["structure"], folder, faults)
    if "ambient" in given:
        _settle_weather(given["ambient"], folder)
    made: dict[str, Any] = {
        name: _checked(FACTORS.get(name, record.NumberFactor), item, f"factors.{name}", faults)
        for name, item in given.items()
    }
    numbers = {name: made.pop(name) for name in list(made) if name not in FACTORS}
    faults += [
        f"factors: factors.{name} is missing"
        for name in ("bearing", "motion", "ambient")
        if name not in given
    ]
    called = table.get("name")
    if not isinstance(called, str):
        faults.append(
            'missing key "name"' if called is None else f"name = {called!r}: must be text"
        )
    if faults:
        return None, faults
    try:
        if made["motion"].matched is not None:
            motions = motions_to_be(made["motion"])
        factors = validated(record.Factors, made | {"numbers": numbers}, "")
        found = _with_case(case, factors, motions, folder)
        merged = {"name": called, "case": found[0], "factors": found[1]}
        study = validated(record.Study, merged | parts, "")
    except InputError as error:
        return None, error.lines()
    return study, _study_faults(study)


def _parted(table: dict[str, Any], faults: list[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the common case of all runs, and the table of each factor."""
    case, factors = table.get("case", {}), table.get("factors", {})
    for key, item in (("case", case), ("factors", factors)):
        if not isinstance(item, dict):
            faults.append(f"{key}: must be a table")
    case = dict(case) if isinstance(case, dict) else {}
    given = {"structure": [DEFAULT]} | (dict(factors) if isinstance(factors, dict) else {})
    known = [*FACTORS, "bearing.K_r", "structure.<...>", "case.<...>"]
    for name in given:
        if name not in FACTORS and "." not in name:
            faults.append(f'unknown factor "{name}"{nearest(name, known)}')
    for key, name in NAMED.items():
        if key not in case:
            continue
        if isinstance(factors, dict) and name in factors:
            faults.append(f"case.{key}: also given as factors.{name}; remove one of them")
        given[name] = case.pop(key)
    faults += [f"case.{key}: {REFUSED[key]}" for key in case if key in REFUSED]
    return case, {name: _as_table(item) for name, item in given.items()}


def _as_table(item: Any) -> Any:
    """Return a factor as a table; levels may be given alone, and one level without a list."""
    if isinstance(item, dict):
        levels = item.get("levels")
        alone = levels is not None and not isinstance(levels, list | tuple)
        return {**item, "levels": [levels]} if alone else dict(item)
    return {"levels": list(item) if isinstance(item, list | tuple) else [item]}


def _checked(model: type[M], table: Any, key: str, faults: list[str]) -> M | None:
    try:
        return validated(model, table, "")
    except InputError as error:
        found = [
            f"{key}.{text}" if KEY.match(text) else f"{key}: {text}" for text in error.problems
        ]
        faults += unlike(found, faults)
        return None


def _settle_structures(table: dict[str, Any], folder: Path, faults: list[str]) -> None:
    if not isinstance(table.get("levels"), list):
        return
    faults += load_things(table, "levels", load_structure, folder, before="factors.structure.")
    faults += _twice(table["levels"], "structure")


def _twice(levels: list[Any], factor: str) -> list[str]:
    names = [getattr(item, "name", "") for item in levels]
    twice = dict.fromkeys(name for name in names if name and names.count(name) > 1)
    return [
        f'factors.{factor}.levels: two have the name "{name}"; names must differ' for name in twice
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
    table["levels"], motions, found = settle_motions(levels, folder, "factors.motion.levels[{}]")
    faults += [text.replace("motions:", "factors.motion:", 1) for text in found]
    pairs = [one for one in table["levels"] if isinstance(one, dict) and "across" in one]
    if matched is not None and pairs:
        faults.append("factors.motion.matched: single records can be matched, not pairs")
    if not found:  # a plan has names without paths
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
        one.bearing if isinstance(one, record.Posterior) else one for one in factors.bearing.levels
    ]
    if factors.ambient.hourly:
        case = dict(case)
        settle_surroundings(case)
    plain = factors.motion.matched is None
    first = {
        "bearings": bearings[:1],
        "motions": [factors.motion.levels[0] if plain and factors.motion.levels else STAND_IN],
        "ambient": [with_unit(ambient, "degC")],
    }
    made = [
        make_earthquake_case({**case, **first, "structure": one}, "case", folder)
        for one in factors.structure.levels
    ]
    found: list[str] = []
    for one in made:
        found += one.model_copy(update={"bearings": bearings}).faults()
    found += made[0].motion_faults(motions)
    if found:
        raise InputError([f"case: {text}" for text in dict.fromkeys(found)])
    structures = factors.structure.model_copy(update={"levels": [one.structure for one in made]})
    return made[0], factors.model_copy(update={"structure": structures})


def _plan_faults(study: record.Study) -> list[str]:
    """Return what cannot be combined with structures in plan, which are moved by pairs."""
    motion, plans = study.factors.motion, [one.plan for one in study.factors.structure.levels]
    if not any(plans):
        return []
    if not all(plans):
        return ["factors.structure: structures in plan and others require separate studies"]
    pairs = motion.matched is None and all(one.is_pair for one in motion.levels or [])
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
        faults += [*reach_faults(study), *_heat_faults(study)]
    except InputError as error:
        faults += error.problems
    return faults


def _heat_faults(study: record.Study) -> list[str]:
    """Return the errors of varied thermal properties where many runs share their temperatures."""
    ambient = study.factors.ambient
    names = [target.name for target in list_targets(study) if moves_warmth(target)]
    faults = []
    if ambient.hourly and ambient.history is None:
        faults += [
            f"factors.{name}: changes thermal properties, so that every run would integrate over "
            'all weather before it, which takes 20 times as long; set history = "10 d" in '
            "factors.ambient, which is long enough"
            for name in names
        ]
    if study.design.lockstep:
        faults += [
            f"design.lockstep: true is impossible, because factors.{name} changes thermal "
            "properties from run to run; remove it"
            for name in names
        ]
    return faults


AnyLevel = Bearing | BilinearBearing | record.Posterior | Any  # others are found by later checks
ANY = "shen-bilinear-bridge"
OF_POSTERIOR = ("posterior", "bearing", "count", "name")
OF_DRAWING = ("compound", "size", "name")
SIZES = ("plan", "diameter", "layers", "shim", "end_plate", "sealing_plate", "lead")  # text
OTHERS = ("cores", "confined", "end_spreading")


def _settle_bearings(table: dict[str, Any], folder: Path, faults: list[str]) -> None:
    """Replace the levels of a table `factors.bearing` by records of bearings and posteriors."""
    own: dict[str, Any] = {}
    if {"posterior", "compound"} & set(table):
        own = {
            key: table.pop(key)
            for key in list(table)
            if key not in record.BearingFactor.model_fields
        }
    if own and "levels" in table:
        faults.append(
            f"factors.bearing: {', '.join(sorted(own))} in addition to levels; add a level "
            'such as {posterior = "fit"} instead'
        )
    levels = table.get("levels") if not own else [own]
    if not isinstance(levels, list):
        return
    settled: list[AnyLevel] = []
    before = len(faults)
    for number, item in enumerate(levels):
        key = "factors.bearing" if own else f"factors.bearing.levels[{number}]"
        try:
            settled += _level(item, folder)
        except InputError as error:
            faults += error.lines(key)
    # After an error a library bearing lets the other checks continue.
    table["levels"] = settled or [load_device(ANY)] if len(faults) > before else settled
    faults += _twice(settled, "bearing")


def _level(item: Any, folder: Path) -> list[AnyLevel]:
    if isinstance(item, str | Path):
        return [load_device(folder / item if str(item).endswith(".toml") else item)]
    if isinstance(item, dict) and "posterior" in item and item.get("kind") != "posterior":
        return [_posterior(item, folder)]
    if isinstance(item, dict) and "compound" in item:
        return list(_drawn(item, folder))
    return [item]


def _posterior(item: dict[str, Any], folder: Path) -> record.Posterior:
    """Return the checked samples of a calibration, from its directory or file."""
    _refuse_unknown(item, OF_POSTERIOR)
    given = item["posterior"]
    if not isinstance(given, str | Path) or not str(given):
        raise InputError("posterior: must be the directory of a calibration, or its posterior.csv")
    path = (folder / given).absolute()
    path = path if is_file(path) else path / SAMPLES
    if not is_file(path):
        raise InputError(
            f'posterior = "{given}": has no {SAMPLES}; identify writes it with --posterior'
        )
    fitted, bearing = path.with_name(IDENTIFIED), item.get("bearing")
    if bearing is None and not is_file(fitted):
        raise InputError(
            f"posterior: the key bearing is missing, and there is no {IDENTIFIED} next to it"
        )
    if isinstance(bearing, str | Path):
        own = str(bearing).endswith(".toml")
        bearing = load_bearing(folder / bearing if own else bearing)
    bearing = load_bearing(fitted) if bearing is None else bearing
    if not isinstance(bearing, Bearing):
        raise InputError("bearing: must be the name or the file of a bearing")
    more = {"count": item["count"]} if "count" in item else {}
    made = record.Posterior(
        name=item.get("name", bearing.name), posterior=str(path), bearing=bearing, **more
    )
    posterior_bearings(made.bearing, path, made.count)
    return made


def _drawn(item: dict[str, Any], folder: Path) -> list[Bearing]:
    """Return bearings of a compound, one for each combination of sizes."""
    _refuse_unknown(item, OF_DRAWING)
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
    several = {"compound": compounds} | {key: _listed(value) for key, value in size.items()}
    for key in set(SIZES) & set(size):
        for value in several[key]:
            if not isinstance(value, str):
                raise InputError(f'size.{key} = {value!r} has no unit; write "{value} mm"')
    vary = [key for key, values in several.items() if len(values) > 1]
    found = []
    for values in product(*several.values()):
        one = dict(zip(several, values, strict=True))
        compound = one.pop("compound")
        own = folder / compound if is_path(compound) else compound
        words = [str(item.get("name", Path(str(compound)).stem))]
        words += [f"{key} {one[key]}" for key in vary if key != "compound"]
        if "name" in item and "compound" in vary:
            words.append(Path(str(compound)).stem)
        name = " ".join(words).replace("/", " ").replace("\\", " ")
        found.append(new_bearing(name, own, **one))
    return found


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _refuse_unknown(item: dict[str, Any], known: tuple[str, ...]) -> None:
    unknown = [f'unknown key "{key}"{nearest(key, known)}' for key in item if key not in known]
    if unknown:
        raise InputError(unknown)
