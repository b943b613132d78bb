"""Columns and designs of a study: one row for each run, identified by a digest of its input.

A column of the plan is a factor. Factors with levels are crossed; every combination has a row for
each sample of the drawn factors (distributions, random levels). A `Plan` is made once for a study
and handed on.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from thermobearing.bearing.ambient import COLDEST, HOTTEST
from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.schema import Strict, validated
from thermobearing.core.records import Floats, Ints
from thermobearing.earthquake.case import FurtherAnalyses
from thermobearing.earthquake.motions import Motion
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.model.limits import CodeChecks
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.definition.motions import factor_motions, motion_levels
from thermobearing.studies.definition.record import (
    COLUMNS,
    MOST_RUNS,
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
from thermobearing.studies.definition.targets import (
    Target,
    affects_rest_temperature,
    find_target,
    spelled,
    value_at,
    with_numbers,
)

NAMED_FACTORS = ("structure", "bearing", "motion")
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


def _list_columns(study: Study, targets: Sequence[Target]) -> list[Column]:
    """Return the columns of a study: names, then numbers, those with dotted names last."""
    factors = study.factors
    columns = []
    for name in NAMED_FACTORS:
        factor = getattr(factors, name)
        motions = isinstance(factor, MotionFactor)
        names = factor.names if motions else [str(level.name) for level in factor.levels]
        columns.append(Column(name, names, chances=_chances(factor, len(names))))
        if name == "bearing" and any(isinstance(level, Posterior) for level in factor.levels):
            columns.append(Column(SAMPLE, share=True))
    columns.append(_number(factors.scale, "scale", factors.scale.unit, "factors.scale"))
    if factors.ambient.hourly:
        columns.append(Column(HOUR, share=True))
    else:
        columns.append(_number(factors.ambient, AMBIENT, "degC", "factors.ambient"))
    for target in targets:
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
            is_converted = isinstance(factor, AmbientFactor)  # its levels have been converted
            numbers.append(float(level) if is_converted else parse_number(level, unit))
        except InputError as error:
            faults += error.lines(f"{key}.levels[{place}]")
    if not faults and len(set(numbers)) < len(numbers) and not isinstance(factor, AmbientFactor):
        faults = [f"{key}.levels: a level is given twice"]
    if faults:
        raise InputError(faults)
    return Column(name, numbers, chances=_chances(factor, len(numbers)))


def _levels_by_part(study: Study) -> dict[str, list[Strict]]:
    """Return the records whose numbers have dotted names, by the first part of the name."""
    bearings = study.factors.bearing.levels
    return {
        "bearing": [level.bearing if isinstance(level, Posterior) else level for level in bearings],
        "structure": list(study.factors.structure.levels),
        "case": [study.case],
    }


LARGEST_SCALE = 1000.0
CUT = "; truncate it with low and high, or use a narrower one"


def reach_faults(plan: "Plan") -> list[str]:
    """Return the errors of numbers that a study of a million runs may have."""
    ends: dict[str, tuple[float, float]] = {}
    drawn: dict[str, str] = {}
    for column in plan.columns:
        if column.distribution is not None:
            ends[column.name] = column.distribution.reach
            drawn[column.name] = f"a {column.distribution.kind} distribution reaches "
        elif column.levels and not isinstance(column.levels[0], str):
            numbers = np.array(column.levels, dtype=np.float64)
            ends[column.name] = float(numbers.min()), float(numbers.max())
    return _faults(plan, ends, drawn)


def _check_numbers(plan: "Plan", numbers: Mapping[str, Floats]) -> None:
    """Raise InputError for drawn numbers outside their limits, by column."""
    finite = {name: values[~np.isnan(values)] for name, values in numbers.items()}
    ends = {name: (float(v.min()), float(v.max())) for name, v in finite.items() if len(v)}
    if faults := _faults(plan, ends, {}):
        raise InputError(faults)


def _faults(
    plan: "Plan", ends: Mapping[str, tuple[float, float]], drawn: Mapping[str, str]
) -> list[str]:
    """Return the errors of the smallest and the largest number of each column."""
    study, faults = plan.study, []
    scale, top = study.factors.scale, LARGEST_SCALE
    limits = {"scale": (0.0, top, scale.unit or ""), AMBIENT: (COLDEST, HOTTEST, "degC")}
    for name in (name for name in limits if name in ends):
        (low, high, unit), (smallest, largest) = limits[name], ends[name]
        positive = name == "scale"
        if smallest < low or largest > high or (positive and smallest <= 0.0):
            faulty = smallest if smallest < low or smallest == low == 0.0 else largest
            bound = "greater than 0 and at most" if positive else f"{low:g} to"
            faults.append(
                f"factors.{'scale' if positive else 'ambient'}: "
                + f"{drawn.get(name, '')}{faulty:g} {unit}".rstrip()
                + f": must be {bound} {high:g} {unit}".rstrip()
                + (CUT if name in drawn else "")
            )
    records = _levels_by_part(study)
    for target in plan.targets:
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
            changed = with_numbers(record, target.change(level, record, number))
            try:
                validated(type(changed), changed.model_dump(), "", from_file=False)
            except InputError as error:
                number_text, remark = f"{number:g}", ""
                if target.of == "factor":
                    number_text = f"{number:g} of it"
                    remark = f" (it is {value_at(record, path):g})"
                reach, cure = drawn.get(target.name, ""), CUT if target.name in drawn else ""
                problems = "; ".join(error.problems)
                return [f"factors.{target.name}: {reach}{number_text}: {problems}{remark}{cure}"]
    return []


AnyBearing: TypeAlias = Bearing | BilinearBearing


def _sampled_bearings(level: Posterior) -> list[AnyBearing]:
    """Return the bearing of each sample of a posterior."""
    path = Path(level.posterior)
    # The first bearing is the calibrated one.
    return list(posterior_bearings(level.bearing, path, level.count, heat=False)[1:])


class Levels:
    """The levels of a study; `bearings` has a place for each sample of a posterior."""

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def _level_bearings(self) -> list[list[AnyBearing]]:
        """Bearings of each level: the samples of a posterior, or a single one."""
        return [
            _sampled_bearings(level) if isinstance(level, Posterior) else [level]
            for level in self.study.factors.bearing.levels
        ]

    @cached_property
    def bearings(self) -> list[AnyBearing]:
        """All bearings, level after level."""
        return [bearing for level in self._level_bearings for bearing in level]

    @cached_property
    def _counts(self) -> Ints:
        """Number of samples of each level of the bearing; 0 of a single bearing."""
        levels = zip(self._level_bearings, self.study.factors.bearing.levels, strict=True)
        counts = [
            len(bearings) if isinstance(level, Posterior) else 0 for bearings, level in levels
        ]
        return np.array(counts, dtype=np.int64)

    def place(self, level: Ints, sample: Ints) -> Ints:
        """Return the places in `bearings` of samples (-1: none) of levels."""
        sizes = np.maximum(self._counts, 1)
        return np.asarray((np.cumsum(sizes) - sizes)[level] + np.maximum(sample, 0))

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


# Keys which are no part of ids while they are unstated.
LATER_KEYS = ("state", "axial", "axial_factor", "devices", "p_delta", "hole", "plate_grading")
RUN_BYTES = 8  # of the id of a run: ten million runs have a collision once in 400 000 studies


def _digest(*parts: Any) -> bytes:
    """Return a digest of numbers, texts and arrays, equal on all machines."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, bytes):
            raw = part
        elif isinstance(part, Strict):
            raw = json.dumps(_without_later_keys(part.model_dump()), sort_keys=True).encode()
        elif hasattr(part, "tobytes"):
            raw = part.astype("<f8").tobytes()
        else:
            raw = json.dumps(part, sort_keys=True).encode()
        # The length keeps parts apart: "ab" and "c" differ from "a" and "bc".
        digest.update(len(raw).to_bytes(8, "little") + raw)
    return digest.digest()


def _without_later_keys(table: Any) -> Any:
    """Return a table without the keys of later versions that it does not state: ids stay."""
    if isinstance(table, dict):
        return {
            key: _without_later_keys(value)
            for key, value in table.items()
            if value is not None or key not in LATER_KEYS
        }
    return [_without_later_keys(item) for item in table] if isinstance(table, list) else table


def _shared_digest(study: Study) -> bytes:
    """Return a digest of the case without factors and texts, and of the weather."""
    # Checks and limits of the rig change no result; a study has no further analyses.
    apart = {"structure", "bearings", "motions", "ambient", "weather", "sources", "rig", "limits"}
    apart |= {*CodeChecks.model_fields, *FurtherAnalyses.model_fields}
    table = study.case.model_dump(exclude=apart)
    for key in ("keep", "keep_every"):
        table["analysis"].pop(key)
    weather = study.factors.ambient.read_weather()
    hourly = [] if weather is None else [weather.temperature, weather.recurs]
    return _digest(_digest(_without_later_keys(table)), *hourly, study.factors.ambient.history)


def _samples(motion: GroundMotion | MotionPair) -> Floats:
    """Return the accelerations of a motion, of a pair in both directions of the structure."""
    return motion.rotated() if isinstance(motion, MotionPair) else motion.acceleration


def _vertical_samples(study: Study, motion: Motion) -> list[Floats]:
    """Return the accelerations of the vertical record of a motion, where it acts."""
    record = motion.load_vertical() if study.case.analysis.axial == "vertical" else None
    return [] if record is None else [record.acceleration]


def _run_ids(
    study: Study, levels: Levels, places: Mapping[str, Ints], numbers: Mapping[str, Floats]
) -> list[str]:
    """Return the ids of runs; `places` and `numbers` (NaN: a run has none) by column."""
    shared = _shared_digest(study)
    pairs = zip(levels.motions, levels.listed, strict=True)
    parts = {
        "structure": [_digest(structure) for structure in study.factors.structure.levels],
        "bearing": [_digest(bearing) for bearing in levels.bearings],
        "motion": [
            _digest(motion.dt, _samples(motion), level.factor, *_vertical_samples(study, level))
            for motion, level in pairs
        ],
    }
    counts = [len(parts[name]) for name in NAMED_FACTORS]
    combined = np.ravel_multi_index(tuple(places[name] for name in NAMED_FACTORS), counts)
    names = sorted(numbers)
    values = np.column_stack([numbers[name] for name in names])
    without = np.isnan(values)
    ids = np.empty(len(values), dtype=object)
    # Runs that lack the same numbers are done together. What runs of one structure, bearing and
    # motion have in common is hashed once, and then with the numbers of each run.
    for gaps in np.unique(without, axis=0):
        rows = np.flatnonzero((without == gaps).all(axis=1))
        present_names = [name for name, gap in zip(names, gaps, strict=True) if not gap]
        combinations, head_of_row = np.unique(combined[rows], return_inverse=True)
        heads = []
        for indices in zip(*np.unravel_index(combinations, counts), strict=True):
            digests = [
                parts[name][place] for name, place in zip(NAMED_FACTORS, indices, strict=True)
            ]
            heads.append(_digest(shared, *digests, present_names))
        present_values = values[rows][:, ~gaps].astype("<f8")
        raw, width = present_values.tobytes(), 8 * present_values.shape[1]
        for row, head in enumerate(head_of_row.tolist()):
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


class Plan:
    """What a study varies and its runs, each found once; equal studies have equal bits.

    Another process gets it without the levels, which it reads, and without the runs.
    """

    def __init__(self, study: Study) -> None:
        self.study = study

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key not in ("levels", "runs")}

    @cached_property
    def targets(self) -> list[Target]:
        """The numbers that vary by dotted name."""
        levels, numbers = _levels_by_part(self.study), self.study.factors.numbers
        return [find_target(name, factor.of, levels) for name, factor in numbers.items()]

    @cached_property
    def columns(self) -> list[Column]:
        """The factors: names, then numbers, those with dotted names last."""
        return _list_columns(self.study, self.targets)

    @cached_property
    def levels(self) -> Levels:
        """The bearings and motions of the levels."""
        return Levels(self.study)

    @cached_property
    def varies_rest_temperature(self) -> bool:
        """Whether a varied number changes the temperature of a bearing at rest."""
        return any(map(affects_rest_temperature, self.targets))

    @cached_property
    def lockstep(self) -> bool:
        """Whether runs are computed in lockstep, where all must share thermal properties."""
        case, requested = self.study.case, self.study.design.lockstep
        histories = self.study.keep.histories
        unsupported = case.analysis.method == "predictor-corrector" or histories == "all"
        if unsupported or requested is False or self.varies_rest_temperature:
            return False
        drawn = [column for column in self.columns if column.drawn]
        cells = math.prod(len(column.levels) for column in self.columns if not column.drawn)
        return requested is True or cells * _rows(self.study.design, drawn) >= MANY

    @cached_property
    def runs(self) -> "pd.DataFrame":
        """All runs, one row each.

        The columns are `run` (from 0), `id` (16 hexadecimal digits: a digest of the input of the
        run, whatever its place in the plan), `seed` (from it), `sample`, with Saltelli's
        arrangement `matrix`, then a column for each factor: structure, bearing, motion, scale,
        ambient_degC, and numbers by their dotted names. InputError for too many runs, samples that
        contradict the factors, or drawn numbers outside their limits.
        """
        picked, draws, cells = _picked(self.study, self.columns)
        frame = pd.DataFrame({"run": np.arange(cells * len(draws[0].sample))})
        frame["sample"] = np.tile(draws[0].sample, cells)
        if draws[0].matrix is not None:
            frame["matrix"] = pd.Categorical(draws[0].matrix * cells)
        return _with_ids(self, picked, frame)


def _rows(design: Design, drawn: Sequence[Column]) -> int:
    return (design.samples or 1) * (len(drawn) + 2 if design.arrangement == "saltelli" else 1)


def _picked(study: Study, columns: Sequence[Column]) -> tuple[dict[str, Any], list[Draws], int]:
    """Return places, numbers and shares of every row by column; draws; combinations of levels."""
    crossed = [column for column in columns if not column.drawn]
    drawn = [column for column in columns if column.drawn]
    cells = math.prod(len(column.levels) for column in crossed)
    _refuse(study.design, cells, drawn)
    draw_count = 1 if study.design.paired else cells
    draws = [_draws(study.design, drawn, cell) for cell in range(draw_count)]
    rows = len(draws[0].sample)
    places = np.array(
        list(product(*(range(len(column.levels)) for column in crossed))), dtype=np.int64
    )
    picked: dict[str, Any] = {}
    for number, column in enumerate(crossed):
        picked[column.name] = column._values_at(np.repeat(places[:, number], rows))
    for number, column in enumerate(drawn):
        values = [column._at(cell_draws.values[:, number]) for cell_draws in draws]
        picked[column.name] = np.tile(np.concatenate(values), cells // draw_count)
    return picked, draws, cells


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
    points = _points(design.kind, 2 * width, samples, rng)
    first, second = points[:, :width], points[:, width:]
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
    sampler = qmc.Sobol(width, scramble=True, rng=rng)
    return np.asarray(sampler.random_base2(samples.bit_length() - 1), dtype=np.float64)


def _settled(plan: Plan, picked: dict[str, Any]) -> dict[str, Any]:
    """Return the picked values, with samples and hours for shares, NaN for missing numbers."""
    study, values = plan.study, dict(picked)
    if SAMPLE in values:
        counts = plan.levels._counts[values["bearing"]]
        values[SAMPLE] = np.where(counts > 0, (values[SAMPLE] * counts).astype(np.int64), -1)
    weather = study.factors.ambient.read_weather()
    if weather is not None:
        history = study.factors.ambient.history or 0.0
        values[HOUR] = weather.hours_at(values[HOUR], history)
        values[AMBIENT] = weather.temperature[values[HOUR]]
    for target in plan.targets:
        if target.part in values:
            has_number = np.array([path is not None for path in target.paths])
            values[target.name] = np.where(
                has_number[values[target.part]], values[target.name], np.nan
            )
    return values


def _with_ids(plan: Plan, picked: dict[str, Any], frame: "pd.DataFrame") -> "pd.DataFrame":
    """Return the rows with ids and seeds of runs, and a column for each factor."""
    study, levels, scale = plan.study, plan.levels, plan.study.factors.scale
    values_by_column = _settled(plan, picked)
    pairs = zip(levels.motions, levels.listed, strict=True)
    strengths = np.array([level.factor * intensity(motion, scale) for motion, level in pairs])
    strength = strengths[values_by_column["motion"]]
    is_intensity = scale.of == "intensity"  # exactly as given, so that stripes are complete
    if is_intensity:
        intensities = values_by_column["scale"]
        values_by_column["scale"] = intensities / strength
    else:
        intensities = values_by_column["scale"] * strength
    drawn = {name: v for name, v in values_by_column.items() if name not in NAMED_FACTORS}
    _check_numbers(plan, drawn)
    no_sample = np.full(len(frame), -1, dtype=np.int64)
    places = {name: values_by_column[name] for name in NAMED_FACTORS}
    places["bearing"] = levels.place(places["bearing"], values_by_column.get(SAMPLE, no_sample))
    effects = {name: factor.of for name, factor in study.factors.numbers.items()}
    surroundings = HOUR if HOUR in values_by_column else AMBIENT
    numbers = {name: values_by_column[name] for name in ("scale", surroundings)}
    for name, effect in effects.items():
        numbers[f"{'.'.join(spelled(name))} {effect}"] = values_by_column[name]
    ids = _run_ids(study, levels, places, numbers)
    frame.insert(1, "id", ids)
    frame.insert(2, "seed", [int(text, 16) >> SPARE for text in ids])
    for column in plan.columns:
        values = values_by_column[column.name]
        if column.name in NAMED_FACTORS:
            values = pd.Categorical.from_codes(values, categories=pd.Index(column.levels))
        frame[column.name] = values
        if column.name == "scale":
            frame[COLUMNS[scale.measure]] = intensities
        if column.name == HOUR:
            frame[AMBIENT] = values_by_column[AMBIENT]
    return frame
