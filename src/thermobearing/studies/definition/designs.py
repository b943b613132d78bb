"""Columns and designs of a study: one row for each run, identified by a digest of its input.

A column of the plan is a factor. Factors with levels are crossed; every combination has a row for
each sample of the drawn factors (distributions, random levels). See `plan`.
"""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numpy as np

from thermobearing.bearing.ambient import COLDEST, HOTTEST
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.lazy import pd
from thermobearing.border.schema import Strict, find_unit, validated
from thermobearing.core.records import Floats, Ints
from thermobearing.earthquake.motions import Motion
from thermobearing.identify.fit.parameters import ALIASES
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.definition.motions import factor_motions, motion_levels
from thermobearing.studies.definition.record import (
    COLUMNS,
    MOST_RUNS,
    OF_FACTORS,
    AmbientFactor,
    Design,
    Distribution,
    MotionFactor,
    NumberFactor,
    Picked,
    Posterior,
    ScaleFactor,
    Study,
    intensity,
    parse_number,
)

NumberPath = tuple[str | int, ...]
S = TypeVar("S", bound=Strict)
FACES = (("analysis", "upper_face"), ("analysis", "lower_face"), ("analysis", "side"))
# Numbers of a bearing that do not affect its heat cells.
WITHOUT_HEAT: dict[str | int, set[str] | None] = {
    "hysteresis": None,
    "scragging": None,
    "rate": None,
    "lead": {
        "stiffness",
        "yield_stress",
        "softening",
        "softening_beyond_tests",
        "reference_temperature",
    },
}


@dataclass(frozen=True)
class Target:
    """A number that a study varies."""

    name: str  # dotted, as in the study
    part: str  # "bearing", "structure" or "case"
    paths: Sequence[NumberPath | None]  # in each level of the part; None in one without it
    unit: str | None  # None if dimensionless
    of: str  # "factor" multiplies it, "value" replaces it

    def change(self, level: int, record: Strict, number: float) -> dict[NumberPath, float]:
        """Return the changed number of a record of a level, by its path; {} without it."""
        path = self.paths[level]
        if path is None:
            return {}
        return {path: number * _value_at(record, path) if self.of == "factor" else number}


def _find_target(name: str, of: str, levels: Mapping[str, Sequence[Strict]]) -> Target:
    part, key = spelled(name)
    if part not in levels:
        raise InputError(f'factors: no part "{part}" in "{name}"; known: {", ".join(levels)}')
    without = OF_FACTORS if part == "case" else ()
    known = [_number_paths(level, without) for level in levels[part]]
    found = [paths.get(key) for paths in known]
    units = [place[1] for place in found if place is not None]
    if not units:
        names = {f"{part}.{key}" for paths in known for key in paths}
        if part == "bearing":
            names |= {
                f"bearing.{alias}" for alias, key in ALIASES.items() if f"bearing.{key}" in names
            }
        raise InputError(f'factors: no number "{name}"{_nearest(name, names)}')
    return Target(name, part, [None if one is None else one[0] for one in found], units[0], of)


def _nearest(name: str, names: set[str]) -> str:
    close = nearest(name, names)
    if not close.startswith("; known"):
        return close
    part = name.rpartition(".")[0]
    within = sorted(one for one in names if one.rpartition(".")[0] == part)
    return nearest(name, within or {one.rpartition(".")[0] + ".…" for one in names})


def _number_paths(
    record: Strict, without: Sequence[str] = ()
) -> dict[str, tuple[NumberPath, str | None]]:
    """Return path and unit of all numbers of a record except counts, by dotted name."""
    found = _numbers(record, "", ())
    return {name: (path, unit) for name, path, unit in found if path[0] not in without}


def _numbers(
    record: Strict, before: str, above: NumberPath
) -> Iterator[tuple[str, NumberPath, str | None]]:
    for key in type(record).model_fields:
        value = getattr(record, key)
        name, path = f"{before}{key}", (*above, key)
        if isinstance(value, float):
            yield name, path, find_unit(type(record), key)
        elif isinstance(value, Strict):
            yield from _numbers(value, f"{name}.", path)
        elif isinstance(value, list | tuple):
            for number, (label, item) in enumerate(zip(_labels(value), value, strict=True)):
                if isinstance(item, Strict):
                    yield from _numbers(item, f"{name}{label}.", (*path, number))


def _labels(items: list[Any] | tuple[Any, ...]) -> list[str]:
    """Return the key of each item of a list: its name, its body, or its number."""
    names = [str(getattr(item, "name", getattr(item, "body", ""))) for item in items]
    return [
        f".{name}" if name and names.count(name) == 1 else f"[{number}]"
        for number, name in enumerate(names)
    ]


def spelled(name: str) -> tuple[str, str]:
    """Return part and dotted key of a number: of "bearing.K_r" hysteresis.layer_stiffness."""
    part, _, key = name.partition(".")
    return part, ALIASES.get(key, key) if part == "bearing" else key


def _value_at(record: Any, path: NumberPath) -> float:
    """Return the number at a path."""
    for step in path:
        record = record[step] if isinstance(step, int) else getattr(record, step)
    return float(record)


def with_numbers(record: S, changes: Mapping[NumberPath, float]) -> S:
    """Return the record with other numbers, without checking limits again."""
    update: dict[str, Any] = {}
    for key in dict.fromkeys(path[0] for path in changes):
        inner = {path[1:]: value for path, value in changes.items() if path[0] == key}
        assert isinstance(key, str)
        update[key] = _changed(getattr(record, key), inner)
    return record.model_copy(update=update)


def _changed(value: Any, changes: Mapping[NumberPath, float]) -> Any:
    """Return a number, a record or a list of records with other numbers."""
    if () in changes:
        return changes[()]
    if isinstance(value, Strict):
        return with_numbers(value, changes)
    made = list(value)
    for number in {path[0] for path in changes}:
        assert isinstance(number, int)
        inner = {path[1:]: new for path, new in changes.items() if path[0] == number}
        made[number] = with_numbers(made[number], inner)
    return type(value)(made)


def moves_heat(path: NumberPath) -> bool:
    """Return whether a number of a bearing affects its heat cells."""
    if path[0] not in WITHOUT_HEAT:
        return True
    within = WITHOUT_HEAT[path[0]]
    return within is not None and path[1] not in within


def moves_warmth(target: Target) -> bool:
    """Return whether a varied number changes the temperature of a bearing at rest."""
    path = next(one for one in target.paths if one is not None)
    if target.part == "case":
        return path[:2] in FACES
    return target.part == "bearing" and moves_heat(path)


THINGS = ("structure", "bearing", "motion")
AMBIENT, HOUR = "ambient_degC", "hour"
SAMPLE = "bearing.sample"  # number of a posterior sample; -1 of a bearing without


@dataclass(frozen=True)
class Column:
    """One factor."""

    name: str
    levels: Sequence[str] | Sequence[float] = ()  # names or numbers; none with a distribution
    distribution: Distribution | None = None
    chances: Sequence[float] | None = None  # of random levels; None if levels are crossed
    share: bool = False  # a number in [0, 1) that selects a posterior sample or an hour

    @property
    def drawn(self) -> bool:
        """Whether each sample draws it; otherwise its levels are crossed."""
        return self.share or self.distribution is not None or self.chances is not None

    def _values_at(self, places: Ints) -> Any:
        """Return numbers at places of the levels; of names the places."""
        if self.levels and isinstance(self.levels[0], str):
            return places
        return np.array(self.levels, dtype=np.float64)[places]

    def _at(self, probability: Floats) -> Any:
        """Return numbers or places at probabilities."""
        if self.share:
            return probability
        if self.distribution is not None:
            return self.distribution.at(probability)
        ends: Floats = np.cumsum(np.array(self.chances))[:-1]
        return self._values_at(np.searchsorted(ends, probability, side="right"))


def list_columns(study: Study) -> list[Column]:
    """Return the columns of a study: names, then numbers, those with dotted names last."""
    factors = study.factors
    columns = []
    for name in THINGS:
        factor = getattr(factors, name)
        motions = isinstance(factor, MotionFactor)
        names = factor.names if motions else [str(one.name) for one in factor.levels]
        columns.append(Column(name, names, chances=_chances(factor, len(names))))
        if name == "bearing" and any(isinstance(one, Posterior) for one in factor.levels):
            columns.append(Column(SAMPLE, share=True))
    columns.append(_number(factors.scale, "scale", factors.scale.unit, "factors.scale"))
    if factors.ambient.hourly:
        columns.append(Column(HOUR, share=True))
    else:
        columns.append(_number(factors.ambient, AMBIENT, "degC", "factors.ambient"))
    for target in list_targets(study):
        unit = target.unit if target.of == "value" else None
        number = factors.numbers[target.name]
        columns.append(_number(number, target.name, unit, f"factors.{target.name}"))
    return columns


def _chances(factor: Picked, count: int) -> list[float] | None:
    weights = list(factor.weights) if factor.weights is not None else [1.0] * count
    return [weight / sum(weights) for weight in weights] if factor.random else None


def _number(
    factor: ScaleFactor | AmbientFactor | NumberFactor, name: str, unit: str | None, key: str
) -> Column:
    """Return the column of a numeric factor in a unit (None: dimensionless)."""
    if (factor.levels is None) == (factor.distribution is None):
        raise InputError(f"{key}: give either levels or a distribution")
    if factor.levels is None:
        if factor.random:
            raise InputError(f"{key}.random: only with levels")
        return Column(name, distribution=factor._read(unit, key))
    numbers, faults = [], []
    for place, level in enumerate(factor.levels):
        try:
            ready = isinstance(factor, AmbientFactor)  # its levels have been converted
            numbers.append(float(level) if ready else parse_number(level, unit))
        except InputError as error:
            faults += error.lines(f"{key}.levels[{place}]")
    if not faults and len(set(numbers)) < len(numbers) and not isinstance(factor, AmbientFactor):
        faults = [f"{key}.levels: a level is given twice"]
    if faults:
        raise InputError(faults)
    return Column(name, numbers, chances=_chances(factor, len(numbers)))


def list_targets(study: Study) -> list[Target]:
    """Return the numbers that a study varies by dotted name."""
    levels = _levels_by_part(study)
    return [_find_target(name, one.of, levels) for name, one in study.factors.numbers.items()]


def _levels_by_part(study: Study) -> dict[str, list[Strict]]:
    """Return the records whose numbers have dotted names, by the first part of the name."""
    bearings = study.factors.bearing.levels
    return {
        "bearing": [one.bearing if isinstance(one, Posterior) else one for one in bearings],
        "structure": list(study.factors.structure.levels),
        "case": [study.case],
    }


LARGEST_SCALE = 1000.0
CUT = "; truncate it with low and high, or use a narrower one"


def reach_faults(study: Study) -> list[str]:
    """Return the errors of numbers that a study of a million runs may have."""
    ends: dict[str, tuple[float, float]] = {}
    drawn: dict[str, str] = {}
    for column in list_columns(study):
        if column.distribution is not None:
            ends[column.name] = column.distribution.reach
            drawn[column.name] = f"a {column.distribution.kind} distribution reaches "
        elif column.levels and not isinstance(column.levels[0], str):
            numbers = np.array(column.levels, dtype=np.float64)
            ends[column.name] = float(numbers.min()), float(numbers.max())
    return _faults(study, ends, drawn)


def _check_numbers(study: Study, numbers: Mapping[str, Floats]) -> None:
    """Raise InputError for drawn numbers outside their limits, by column."""
    known = {name: values[~np.isnan(values)] for name, values in numbers.items()}
    ends = {name: (float(v.min()), float(v.max())) for name, v in known.items() if len(v)}
    if found := _faults(study, ends, {}):
        raise InputError(found)


def _faults(
    study: Study, ends: Mapping[str, tuple[float, float]], drawn: Mapping[str, str]
) -> list[str]:
    """Return the errors of the smallest and the largest number of each column."""
    faults = []
    scale, top = study.factors.scale, LARGEST_SCALE
    limits = {"scale": (0.0, top, scale.unit or ""), AMBIENT: (COLDEST, HOTTEST, "degC")}
    for name in (name for name in limits if name in ends):
        (low, high, unit), (smallest, largest) = limits[name], ends[name]
        positive = name == "scale"
        if smallest < low or largest > high or (positive and smallest <= 0.0):
            wrong = smallest if smallest < low or smallest == low == 0.0 else largest
            least = "greater than 0 and at most" if positive else f"{low:g} to"
            faults.append(
                f"factors.{'scale' if positive else 'ambient'}: "
                + f"{drawn.get(name, '')}{wrong:g} {unit}".rstrip()
                + f": must be {least} {high:g} {unit}".rstrip()
                + (CUT if name in drawn else "")
            )
    records = _levels_by_part(study)
    for target in list_targets(study):
        if target.name in ends:
            faults += _target_faults(target, records[target.part], ends[target.name], drawn)
    return faults


def _target_faults(
    target: Target, records: list[Any], ends: tuple[float, float], drawn: Mapping[str, str]
) -> list[str]:
    """Return the faults of a bearing, a structure or a case with the number."""
    for level, record in enumerate(records):
        path = target.paths[level]
        if path is None:
            continue
        for number in ends:
            made = with_numbers(record, target.change(level, record, number))
            try:
                validated(type(made), made.model_dump(), "", from_file=False)
            except InputError as error:
                what, more = f"{number:g}", ""
                if target.of == "factor":
                    what, more = f"{number:g} of it", f" (it is {_value_at(record, path):g})"
                text = f"factors.{target.name}: {drawn.get(target.name, '')}{what}: "
                text += "; ".join(error.problems) + more
                return [text + (CUT if target.name in drawn else "")]
    return []


AnyBearing: TypeAlias = Bearing | BilinearBearing


class Levels:
    """The levels of a study; `bearings` has a place for each sample of a posterior."""

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def _each(self) -> list[list[AnyBearing]]:
        """Bearings of each level: the samples of a posterior, or a single one."""
        return [
            list(posterior_bearings(one.bearing, Path(one.posterior), one.count, heat=False)[1:])
            if isinstance(one, Posterior)
            else [one]
            for one in self.study.factors.bearing.levels
        ]

    @cached_property
    def bearings(self) -> list[AnyBearing]:
        """All bearings, level after level."""
        return [bearing for level in self._each for bearing in level]

    @cached_property
    def _counts(self) -> Ints:
        """Number of samples of each level of the bearing; 0 of a single bearing."""
        levels = zip(self._each, self.study.factors.bearing.levels, strict=True)
        counts = [len(each) if isinstance(one, Posterior) else 0 for each, one in levels]
        return np.array(counts, dtype=np.int64)

    def place(self, level: Ints, sample: Ints) -> Ints:
        """Return the places in `bearings` of samples (-1: none) of levels."""
        taken = np.maximum(self._counts, 1)
        return np.asarray((np.cumsum(taken) - taken)[level] + np.maximum(sample, 0))

    @cached_property
    def motions(self) -> Sequence[GroundMotion | MotionPair]:
        """Ground motions, not scaled; pairs for structures in plan."""
        factor = self.study.factors.motion
        if self.study.case.components > 1:
            return [motion.load_pair() for motion in motion_levels(factor)]
        return factor_motions(factor)

    @cached_property
    def listed(self) -> list[Motion]:
        """The motions as records of a case, with the factors of their levels."""
        return motion_levels(self.study.factors.motion)


RUN_BYTES = 8  # of the id of a run: ten million runs have a collision once in 400 000 studies


def _digest(*parts: Any) -> bytes:
    """Return a digest of numbers, texts and arrays, equal on all machines."""
    found = hashlib.sha256()
    for part in parts:
        if isinstance(part, bytes):
            raw = part
        elif isinstance(part, Strict):
            raw = json.dumps(part.model_dump(), sort_keys=True).encode()
        elif hasattr(part, "tobytes"):
            raw = part.astype("<f8").tobytes()
        else:
            raw = json.dumps(part, sort_keys=True).encode()
        found.update(len(raw).to_bytes(8, "little") + raw)
    return found.digest()


def _shared_digest(study: Study) -> bytes:
    """Return a digest of the case without factors and texts, and of the weather."""
    table = study.case.model_dump(
        exclude={"structure", "bearings", "motions", "ambient", "weather", "sources", "rig"}
    )
    for key in ("keep", "keep_every"):
        table["analysis"].pop(key)
    weather = study.factors.ambient.read_weather()
    hourly = [] if weather is None else [weather.temperature, weather.recurs]
    return _digest(_digest(table), *hourly, study.factors.ambient.history)


def _samples(motion: GroundMotion | MotionPair) -> Floats:
    """Return the accelerations of a motion, of a pair in both directions of the structure."""
    return motion.rotated() if isinstance(motion, MotionPair) else motion.acceleration


def _run_ids(
    study: Study, levels: Levels, places: Mapping[str, Ints], numbers: Mapping[str, Floats]
) -> list[str]:
    """Return the ids of runs; `places` and `numbers` (NaN: a run has none) by column."""
    shared = _shared_digest(study)
    pairs = zip(levels.motions, levels.listed, strict=True)
    parts = {
        "structure": [_digest(one) for one in study.factors.structure.levels],
        "bearing": [_digest(one) for one in levels.bearings],
        "motion": [_digest(one.dt, _samples(one), level.factor) for one, level in pairs],
    }
    counts = [len(parts[name]) for name in THINGS]
    combined = np.ravel_multi_index(tuple(places[name] for name in THINGS), counts)
    names = sorted(numbers)
    values = np.column_stack([numbers[name] for name in names])
    without = np.isnan(values)
    ids = np.empty(len(values), dtype=object)
    for gaps in np.unique(without, axis=0):
        rows = np.flatnonzero((without == gaps).all(axis=1))
        known = [name for name, gap in zip(names, gaps, strict=True) if not gap]
        different, of_row = np.unique(combined[rows], return_inverse=True)
        heads = []
        for here in zip(*np.unravel_index(different, counts), strict=True):
            things = [parts[name][place] for name, place in zip(THINGS, here, strict=True)]
            heads.append(_digest(shared, *things, known))
        own = values[rows][:, ~gaps].astype("<f8")
        raw, width = own.tobytes(), 8 * own.shape[1]
        for row, head in enumerate(of_row.tolist()):
            content = heads[head] + raw[row * width : (row + 1) * width]
            ids[rows[row]] = hashlib.blake2b(content, digest_size=RUN_BYTES).hexdigest()
    return [str(text) for text in ids]


A, B, SWAPPED = "A", "B", "AB"
MANY = 5000  # runs from which lockstep saves more time than its compilation takes
SPARE = 16  # bits of an id that its seed drops: 48 bits are exact in any table


@dataclass(frozen=True)
class Draws:
    """Probabilities of drawn factors, and the places of their rows in the arrangement."""

    values: Floats  # [rows, drawn factors] in [0, 1)
    sample: Ints  # [rows] number of the sample
    matrix: list[str] | None = None  # [rows] "A", "B" or "AB <factor>"; none in a plain arrangement


def plan(study: Study) -> "pd.DataFrame":
    """Return all runs of a study, one row each; equal studies have equal bits.

    The columns are `run` (from 0), `id` (16 hexadecimal digits: a digest of the input of the run,
    whatever its place in the plan), `seed` (from it), `sample`, with Saltelli's arrangement
    `matrix`, then a column for each factor: structure, bearing, motion, scale, ambient_degC, and
    numbers by their dotted names. InputError for too many runs, samples that contradict the
    factors, or drawn numbers outside their limits.
    """
    columns = list_columns(study)
    picked, each, cells = _picked(study, columns)
    frame = pd.DataFrame({"run": np.arange(cells * len(each[0].sample))})
    frame["sample"] = np.tile(each[0].sample, cells)
    if each[0].matrix is not None:
        frame["matrix"] = pd.Categorical(each[0].matrix * cells)
    return _with_ids(study, columns, picked, frame)


def in_lockstep(study: Study) -> bool:
    """Return whether runs are computed in lockstep, where all must share thermal properties."""
    case, wanted = study.case, study.design.lockstep
    alone = case.analysis.method == "predictor-corrector" or study.keep.histories == "all"
    if alone or wanted is False or any(moves_warmth(target) for target in list_targets(study)):
        return False
    columns = list_columns(study)
    drawn = [column for column in columns if column.drawn]
    cells = math.prod(len(column.levels) for column in columns if not column.drawn)
    return wanted is True or cells * _rows(study.design, drawn) >= MANY


def _rows(design: Design, drawn: Sequence[Column]) -> int:
    return (design.samples or 1) * (len(drawn) + 2 if design.arrangement == "saltelli" else 1)


def _picked(study: Study, columns: Sequence[Column]) -> tuple[dict[str, Any], list[Draws], int]:
    """Return places, numbers and shares of every row by column; draws; combinations of levels."""
    crossed = [column for column in columns if not column.drawn]
    drawn = [column for column in columns if column.drawn]
    cells = math.prod(len(column.levels) for column in crossed)
    _refuse(study.design, cells, drawn)
    own = 1 if study.design.paired else cells
    each = [_draws(study.design, drawn, cell) for cell in range(own)]
    rows = len(each[0].sample)
    places = np.array(
        list(product(*(range(len(column.levels)) for column in crossed))), dtype=np.int64
    )
    picked: dict[str, Any] = {}
    for number, column in enumerate(crossed):
        picked[column.name] = column._values_at(np.repeat(places[:, number], rows))
    for number, column in enumerate(drawn):
        found = [column._at(draws.values[:, number]) for draws in each]
        picked[column.name] = np.tile(np.concatenate(found), cells // own)
    return picked, each, cells


def _refuse(design: Design, cells: int, drawn: Sequence[Column]) -> None:
    names = ", ".join(column.name for column in drawn)
    if drawn and design.samples is None:
        raise InputError(f"design.samples: required to draw {names}")
    if not drawn and design.samples is not None:
        raise InputError(
            "design.samples: no factor is drawn, all have levels; remove it, or give a factor a "
            "distribution or random = true"
        )
    rows = _rows(design, drawn)
    if cells * rows > MOST_RUNS:
        raise InputError(
            f"the study has {cells * rows} runs, {cells} combinations of levels with {rows} draws "
            f"each; at most {MOST_RUNS}: use random levels (random = true) or fewer samples"
        )


def _draws(design: Design, drawn: Sequence[Column], cell: int) -> Draws:
    """Return the probabilities of one combination of levels, or of all with paired draws."""
    samples, width = design.samples or 1, len(drawn)
    seed = [design.seed] if design.paired else [design.seed, cell]
    rng = np.random.default_rng(seed)
    number = np.arange(samples, dtype=np.int64)
    if design.arrangement == "plain":
        return Draws(_points(design.kind, width, samples, rng), number)
    # A and B are halves of points in twice the dimensions: independent and each space-filling.
    both = _points(design.kind, 2 * width, samples, rng)
    first, second = both[:, :width], both[:, width:]
    blocks, names = [first, second], [A] * samples + [B] * samples
    for k, column in enumerate(drawn):
        swapped = first.copy()
        swapped[:, k] = second[:, k]
        blocks.append(swapped)
        names += [f"{SWAPPED} {column.name}"] * samples
    return Draws(np.concatenate(blocks), np.tile(number, len(blocks)), names)


def _points(kind: str, width: int, samples: int, rng: np.random.Generator) -> Floats:
    """Return points of a design in the unit cube, [samples, width]."""
    if width == 0:
        return np.zeros((samples, 0))
    if kind not in ("latin-hypercube", "sobol"):
        return rng.random((samples, width))
    from scipy.stats import qmc  # takes a second to read; processes that run need it not

    if kind == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(width, rng=rng).random(samples), dtype=np.float64)
    made = qmc.Sobol(width, scramble=True, rng=rng)
    return np.asarray(made.random_base2(samples.bit_length() - 1), dtype=np.float64)


def _settled(study: Study, levels: Levels, picked: dict[str, Any]) -> dict[str, Any]:
    """Return the picked values, with samples and hours for shares, NaN for missing numbers."""
    found = dict(picked)
    if SAMPLE in found:
        counts = levels._counts[found["bearing"]]
        found[SAMPLE] = np.where(counts > 0, (found[SAMPLE] * counts).astype(np.int64), -1)
    weather = study.factors.ambient.read_weather()
    if weather is not None:
        history = study.factors.ambient.history or 0.0
        found[HOUR] = weather.hours_at(found[HOUR], history)
        found[AMBIENT] = weather.temperature[found[HOUR]]
    for target in list_targets(study):
        if target.part in found:
            known = np.array([path is not None for path in target.paths])
            found[target.name] = np.where(known[found[target.part]], found[target.name], np.nan)
    return found


def _with_ids(
    study: Study, columns: Sequence[Column], picked: dict[str, Any], frame: "pd.DataFrame"
) -> "pd.DataFrame":
    """Return the plan with ids and seeds of runs, and its columns."""
    levels, scale = Levels(study), study.factors.scale
    found = _settled(study, levels, picked)
    pairs = zip(levels.motions, levels.listed, strict=True)
    strengths = np.array([one.factor * intensity(motion, scale) for motion, one in pairs])
    strength = strengths[found["motion"]]
    given = scale.of == "intensity"  # exactly as given, so that stripes are complete
    intensities = found["scale"] if given else found["scale"] * strength
    if given:
        found["scale"] = intensities / strength
    _check_numbers(study, {name: found[name] for name in found if name not in THINGS})
    none = np.full(len(frame), -1, dtype=np.int64)
    places = {name: found[name] for name in THINGS}
    places["bearing"] = levels.place(places["bearing"], found.get(SAMPLE, none))
    of = {name: one.of for name, one in study.factors.numbers.items()}
    numbers = {name: found[name] for name in ("scale", AMBIENT if HOUR not in found else HOUR)}
    numbers |= {f"{'.'.join(spelled(name))} {of[name]}": found[name] for name in of}
    ids = _run_ids(study, levels, places, numbers)
    frame.insert(1, "id", ids)
    frame.insert(2, "seed", [int(text, 16) >> SPARE for text in ids])
    for column in columns:
        values = found[column.name]
        if column.name in THINGS:
            values = pd.Categorical.from_codes(values, categories=pd.Index(column.levels))
        frame[column.name] = values
        if column.name == "scale":
            frame[COLUMNS[scale.measure]] = intensities
        if column.name == HOUR:
            frame[AMBIENT] = found[AMBIENT]
    return frame
