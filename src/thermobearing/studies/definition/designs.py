"""Designs of a study: one row for each run, identified by a digest of its input.

A column of the plan is a factor. Factors with levels are crossed; for every combination, what is
drawn (distributions, levels by lot) has a row for each sample. `plan` is the story.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats, Ints
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.definition.columns import (
    AMBIENT,
    HOUR,
    SAMPLE,
    THINGS,
    Column,
    check_numbers,
    list_columns,
    list_targets,
    moves_warmth,
    spelled,
)
from thermobearing.studies.definition.levels import Levels
from thermobearing.studies.definition.record import COLUMNS, MOST_RUNS, Design, Study, intensity

RUN_BYTES = 8  # of the digest that names a run: among ten million, two alike once in 400 000


def _digest(*parts: Any) -> bytes:
    """Return a digest of numbers, texts and arrays, the same on every machine."""
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


def _motion_digest(motion: GroundMotion, factor: float) -> bytes:
    """Return a digest of the samples of a motion, from any file, and the factor of its level."""
    return _digest(motion.dt, motion.acceleration, factor)


def _shared_digest(study: Study, levels: Levels) -> bytes:
    """Return a digest of the case without factors and documents, and of the weather."""
    table = study.case.model_dump(
        exclude={"structure", "bearings", "motions", "ambient", "weather", "sources", "rig"}
    )
    for key in ("keep", "keep_every"):
        table["analysis"].pop(key)
    weather = levels.weather
    air = [] if weather is None else [weather.temperature, weather.recurs]
    return _digest(_digest(table), *air, study.factors.ambient.history)


def _run_ids(
    study: Study, levels: Levels, places: Mapping[str, Ints], numbers: Mapping[str, Floats]
) -> list[str]:
    """Return names of runs, 16 hexadecimal digits each.

    `places` are those of the things of each row, of bearings in `Levels.bearings`; `numbers` have
    NaN where a run has no such number.
    """
    shared = _shared_digest(study, levels)
    pairs = zip(levels.motions, [one.factor for one in levels.listed], strict=True)
    parts = {
        "structure": [_digest(one) for one in study.factors.structure.levels],
        "bearing": [_digest(one) for one in levels.bearings],
        "motion": [_motion_digest(*one) for one in pairs],
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
MANY = 5000  # runs from which compiling for lockstep, once for all studies, is worth it
SPARE = 16  # bits of an id that its seed does without: 48 are exact in any table


@dataclass(frozen=True)
class Draws:
    """Probabilities for each drawn factor, and where in the arrangement a row of them belongs."""

    values: Floats  # [rows, drawn factors] in [0, 1)
    sample: Ints  # [rows] number of the sample
    matrix: list[str] | None = None  # [rows] "A", "B" or "AB <factor>"; none in a plain arrangement


def plan(study: Study) -> pd.DataFrame:
    """Return all runs of a study, one row each; the same study gives the same bits.

    The columns are `run` (from 0), `id` (16 hexadecimal digits: a digest of the input of the run,
    whatever its place in the plan), `seed` (from it), `sample`, with Saltelli's arrangement
    `matrix`, then a column for each factor: structure, bearing, motion, scale, ambient_degC, and
    numbers by their dotted names. InputError for too many runs, samples that do not go with the
    factors, or drawn numbers that a bearing or a structure may not have.
    """
    columns = list_columns(study)
    picked, each, cells = _picked(study, columns)
    frame = pd.DataFrame({"run": np.arange(cells * len(each[0].sample))})
    frame["sample"] = np.tile(each[0].sample, cells)
    if each[0].matrix is not None:
        frame["matrix"] = pd.Categorical(each[0].matrix * cells)
    return _with_ids(study, columns, picked, frame)


def in_lockstep(study: Study) -> bool:
    """Return whether runs of a study are carried out side by side; a study alone decides it.

    Runs side by side have the heat of their cells in common, so that a study which varies it from
    run to run goes one by one.
    """
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
        picked[column.name] = column.of(np.repeat(places[:, number], rows))
    for number, column in enumerate(drawn):
        found = [column.at(draws.values[:, number]) for draws in each]
        picked[column.name] = np.tile(np.concatenate(found), cells // own)
    return picked, each, cells


def _refuse(design: Design, cells: int, drawn: Sequence[Column]) -> None:
    names = ", ".join(column.name for column in drawn)
    if drawn and design.samples is None:
        raise InputError(f"design: how many draws of {names}? Give samples")
    if not drawn and design.samples is not None:
        raise InputError(
            "design.samples: every factor has levels, and nothing is drawn; leave it out, or give "
            "a factor a distribution or random = true"
        )
    rows = _rows(design, drawn)
    if cells * rows > MOST_RUNS:
        raise InputError(
            f"makes {cells * rows} runs, {cells} combinations of levels and {rows} draws of each; "
            f"at most {MOST_RUNS} are done: draw levels by lot (random = true) or fewer samples"
        )


def _draws(design: Design, drawn: Sequence[Column], cell: int) -> Draws:
    """Return probabilities of one combination of levels, or of all that share them."""
    samples, width = design.samples or 1, len(drawn)
    seed = [design.seed] if design.paired else [design.seed, cell]
    rng = np.random.default_rng(seed)
    number = np.arange(samples, dtype=np.int64)
    if design.arrangement == "plain":
        return Draws(_points(design.kind, width, samples, rng), number)
    # A and B are halves of points in twice the dimensions: independent, and each well spread.
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
    """Return what was picked, with samples and hours for shares, NaN for missing numbers."""
    found = dict(picked)
    if SAMPLE in found:
        counts = levels.counts[found["bearing"]]
        found[SAMPLE] = np.where(counts > 0, (found[SAMPLE] * counts).astype(np.int64), -1)
    if levels.weather is not None:
        history = study.factors.ambient.history or 0.0
        found[HOUR] = levels.weather.hours_at(found[HOUR], history)
        found[AMBIENT] = levels.weather.temperature[found[HOUR]]
    for target in list_targets(study):
        if target.part in found:
            known = np.array([path is not None for path in target.paths])
            found[target.name] = np.where(known[found[target.part]], found[target.name], np.nan)
    return found


def _with_ids(
    study: Study, columns: Sequence[Column], picked: dict[str, Any], frame: pd.DataFrame
) -> pd.DataFrame:
    """Return the plan with names and seeds of runs, and its columns for readers."""
    levels, scale = Levels(study), study.factors.scale
    found = _settled(study, levels, picked)
    pairs = zip(levels.motions, levels.listed, strict=True)
    strengths = np.array([one.factor * intensity(motion, scale) for motion, one in pairs])
    strength = strengths[found["motion"]]
    given = scale.of == "intensity"  # to the last bit as given, so that stripes are complete
    intensities = found["scale"] if given else found["scale"] * strength
    if given:
        found["scale"] = intensities / strength
    check_numbers(study, {name: found[name] for name in found if name not in THINGS})
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
