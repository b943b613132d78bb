"""Motions of a study that are matched to a spectrum: computed once and stored.

A match takes seconds, so that its motion is stored in a cache: a second start, another part of the
study or a dry run reuse it. The directory of a study has its own copy, since the last bits of a
match depend on the machine, and the ids of runs depend on them.

recipes -> from the directory, the cache, or a new match -> checked -> a study with its motions
"""

import hashlib
import io
import json
import os
import struct
import time
import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.opener import LARGEST_STORE, opened
from thermobearing.border.text_file import write_whole
from thermobearing.core.compiled.sources import cache_directory
from thermobearing.earthquake.motions import CUT, Motion, cut_note, motion_table, pair_notes
from thermobearing.motions import targets
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, misfit
from thermobearing.motions.process import resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import check_record, make_motion, match_spectrum
from thermobearing.motions.targets import STANDARD_NAMES, DesignSpectrum, find_kind, load_spectrum
from thermobearing.quantities.warned import Warned
from thermobearing.studies.definition.record import MotionFactor, Study
from thermobearing.studies.run.processes import call_on_processes, raise_if_stopped

SEED, STEP = 1, 0.01  # defaults; [s]
PHASES = "jra-ii-i"  # default for a spectrum from a file
Progress = Callable[[int, int], None]
MOTIONS_FILE = "motions.npz"  # of the directory of a study
CACHE = "motions"  # folder next to the machine code
# Errors of numpy, zipfile and zlib for a file with a changed bit.
DAMAGED: tuple[type[Exception], ...] = (
    OSError,
    ValueError,
    KeyError,
    TypeError,
    EOFError,
    RuntimeError,
    OverflowError,
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
)
ABOUT = "about"  # entry of a file with its texts and numbers, as JSON
TEXTS = ("name", "description", "citation")
STAND_IN = f"{PHASES}-1"  # built-in motion in place of one that does not exist yet
NAMED = 3  # motions that a message names


@dataclass(frozen=True)
class Recipe:
    """Input of one matched motion: random phases of a seed, or those of a record."""

    name: str  # of the motion
    spectrum: DesignSpectrum
    phases: tuple[str, str] = ("II", "I")  # type and ground class of random phases
    seed: int = SEED  # of random phases
    dt: float = STEP
    record: GroundMotion | None = None  # whose phases are used instead

    @property
    def key(self) -> str:
        """Digest of the input without the name."""
        parts: list[Any] = [tuple(self.spectrum.curve), self.spectrum.factor]
        raw = b""
        if self.record is None:
            parts += [self.phases, self.seed, self.dt]
        else:
            parts += [self.record.dt]
            raw = self.record.acceleration.astype("<f8").tobytes()
        return hashlib.sha256(json.dumps(parts).encode() + raw).hexdigest()

    def make(self, progress: Progress | None = None) -> GroundMotion:
        """Match the motion, which takes seconds."""
        words: dict[str, Any] = {"spectrum": self.spectrum, "progress": progress}
        if self.record is not None:
            return match_spectrum(self.record, **words)
        return make_motion(*self.phases, self.seed, self.dt, **words)


def _recipes(factor: MotionFactor) -> list[Recipe]:
    """Return the recipes of a factor with `matched`."""
    assert factor.matched is not None
    spectrum = load_spectrum(factor.matched, factor.zone_factor or 1.0)
    if factor.levels is None:
        phase_name = spectrum.name if spectrum.name in STANDARD_NAMES else PHASES
        phases = find_kind(factor.phases or phase_name)
        first = SEED if factor.seed is None else factor.seed
        return [
            Recipe(name, spectrum, phases, first + place, factor.dt or STEP)
            for place, name in enumerate(factor.names)
        ]
    recipes: list[Recipe] = []
    faults: list[str] = []
    for name, level in zip(factor.names, factor.levels, strict=True):
        try:
            record = level.load()
            record = record if factor.dt is None else resampled(record, factor.dt)
            check_record(record)
            recipes.append(Recipe(name, spectrum, record=record))
        except InputError as error:
            faults += error.lines()
    if faults:
        raise InputError(faults)
    return recipes


@cache
def _sources() -> str:
    """Return a digest of the code that matches motions, and of its libraries."""
    digest = hashlib.sha256(f"numpy {version('numpy')} scipy {version('scipy')}".encode())
    folder = Path(targets.__file__).parent
    for path in [*sorted(folder.glob("*.py")), data_path("phases", "near-fault.toml")]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_file(recipe: Recipe) -> Path | None:
    folder = cache_directory()
    return None if folder is None else folder / CACHE / _sources() / f"{recipe.key[:32]}.npz"


def _cached(recipe: Recipe) -> GroundMotion | None:
    file = _cache_file(recipe)
    return None if file is None else _read_motions(file).get(recipe.key)


def _motions_bytes(motions: Mapping[str, GroundMotion]) -> bytes:
    attributes = {
        key: {"dt": motion.dt, **{name: getattr(motion, name) for name in TEXTS}}
        for key, motion in motions.items()
    }
    arrays: dict[str, Any] = {key: motion.acceleration for key, motion in motions.items()}
    arrays[ABOUT] = np.array(json.dumps(attributes))
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def _read_motions(path: Path) -> dict[str, GroundMotion]:
    """Return the motions of a file by key of their recipe; none if it is damaged or missing."""
    try:
        with (
            opened(path, LARGEST_STORE) as file,
            np.load(file, allow_pickle=False) as stored,
        ):
            motions = {}
            for key, attributes in json.loads(str(stored[ABOUT])).items():
                words: dict[str, Any] = {name: str(attributes[name]) for name in TEXTS}
                motions[key] = GroundMotion(
                    dt=float(attributes["dt"]), acceleration=stored[key], **words
                )
            return motions
    except DAMAGED:
        return {}


def motions_to_be(factor: MotionFactor) -> list[GroundMotion]:
    """Return a motion of zeros for each matched motion, with its time step."""
    try:
        sources = [recipe.record or recipe for recipe in _recipes(factor)]
    except InputError as error:
        raise InputError(error.lines("factors.motion")) from None
    return [GroundMotion("to be made", source.dt, np.zeros(2)) for source in sources]


def factor_motions(factor: MotionFactor) -> list[GroundMotion]:
    """Return the motions of the levels along the bridge, not scaled; matched here if need be."""
    if factor.matched is None:
        return [motion.load() for motion in factor.levels or ()]
    if not factor.matched_motions():
        factor.matched_motions(_matched_motions(factor, {}, 1, None))
    return list(factor.matched_motions())


def motion_levels(factor: MotionFactor) -> list[Motion]:
    """Return the motions as a case has them; a matched one contains its samples."""
    if factor.matched is None:
        return list(factor.levels or ())
    scales = [level.factor for level in factor.levels or ()] or [1.0] * len(factor.names)
    return [
        Motion(**(motion_table(motion) | {"factor": scale, "label": motion.name}))
        for motion, scale in zip(factor_motions(factor), scales, strict=True)
    ]


def study_notes(study: Study) -> list[str]:
    """Return what a study does with its motions that a reader may not expect, as sentences.

    Of pairs only one component acts on a structure that is not in plan, and a `duration` may end
    motions whose intensities are of the whole record.
    """
    tables = [level.model_dump(exclude_none=True) for level in study.factors.motion.levels or ()]
    notes = pair_notes(tables, plan=bool(study.factors.structure.levels[0].plan))
    if cut := cut_note(_lengths(study.factors.motion), study.case.duration):
        notes.append(Warned(f"{cut}; intensities are those of the whole records", CUT))
    return notes


def _lengths(factor: MotionFactor) -> list[tuple[str, float]]:
    """Return name and length [s] of the motions that exist, also where a file is gone."""
    if factor.matched is not None:
        return [(motion.name, motion.duration) for motion in factor.matched_motions()]
    lengths = []
    for name, motion in zip(factor.names, factor.levels or (), strict=True):
        with suppress(InputError):
            lengths.append((name, motion.load().duration))
    return lengths


def with_matched(
    study: Study,
    directory: Path | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """Return a study with matched motions: those of its directory or of the cache, or new ones."""
    factor = study.factors.motion
    if factor.matched is None:
        return study
    stored = _motions_by_key(factor)
    if directory is not None:
        stored |= _read_motions(directory / MOTIONS_FILE)
    return _with(study, _matched_motions(factor, stored, jobs or os.cpu_count() or 1, progress))


def with_kept(study: Study, directory: Path) -> Study:
    """Return a study with the motions of its directory, if it has all of them."""
    stored = _read_motions(directory / MOTIONS_FILE)
    required = _recipes(study.factors.motion) if stored and study.factors.motion.matched else []
    if not required or any(recipe.key not in stored for recipe in required):
        return study
    return _with(study, [replace(stored[recipe.key], name=recipe.name) for recipe in required])


def with_stand_ins(study: Study, motion: GroundMotion | None = None) -> Study:
    """Return a study that has one motion in place of all missing ones, to count and time runs."""
    factor = study.factors.motion
    if factor.matched is None or factor.matched_motions():
        return study
    motion = motion or load_motion(STAND_IN)
    return _with(study, [replace(motion, name=name) for name in factor.names])


def missing_motions(study: Study, directory: Path | None = None) -> list[Recipe]:
    """Return the motions that a start in a directory would match."""
    factor = study.factors.motion
    if factor.matched is None or factor.matched_motions():
        return []
    stored = {} if directory is None else _read_motions(directory / MOTIONS_FILE)
    return [
        recipe
        for recipe in _recipes(factor)
        if recipe.key not in stored and _cached(recipe) is None
    ]


def with_first_motion(study: Study) -> tuple[Study, int, float]:
    """Return a study whose runs can be timed, and number and seconds of missing motions."""
    missing = missing_motions(study)
    if not missing:
        return with_matched(study, jobs=1), 0, 0.0
    begin = time.perf_counter()
    (motion,) = _matched_motions(study.factors.motion, {}, 1, None, missing[:1])
    seconds = time.perf_counter() - begin
    return with_stand_ins(study, motion), len(missing_motions(study)), seconds


def _with(study: Study, motions: Sequence[GroundMotion]) -> Study:
    factor = study.factors.motion.model_copy()
    factor.matched_motions(motions)
    factors = study.factors.model_copy(update={"motion": factor})
    return study.model_copy(update={"factors": factors})


def _matched_motions(
    factor: MotionFactor,
    available: Mapping[str, GroundMotion],
    jobs: int,
    progress: Progress | None,
    recipes: Sequence[Recipe] | None = None,
) -> list[GroundMotion]:
    """Return the motion of each recipe; InputError names those whose misfit is too large."""
    required = _recipes(factor) if recipes is None else recipes
    motions: dict[str, GroundMotion] = {}
    missing_recipes: dict[str, Recipe] = {}  # by key: levels of one recipe share its motion
    for recipe in required:
        stored = available.get(recipe.key) or _cached(recipe)
        if stored is None:
            missing_recipes[recipe.key] = recipe
        else:
            motions[recipe.key] = stored
    missing = list(missing_recipes.values())
    completed = len(required) - len(missing)
    if progress and missing:
        progress(completed, len(required))
    for recipe, motion in call_on_processes(_make, None, missing, min(jobs, len(missing))):
        motions[recipe.key], completed = motion, completed + 1
        file = _cache_file(recipe)
        with suppress(OSError):  # without a cache the motion is matched again next time
            if file is not None:
                file.parent.mkdir(parents=True, exist_ok=True)
                write_whole(file, _motions_bytes({recipe.key: motion}))
        if progress:
            progress(completed, len(required))
    tolerance = LARGEST_MISFIT if factor.tolerance is None else factor.tolerance
    poor = []
    for recipe in required:
        error = misfit(motions[recipe.key], recipe.spectrum.at)
        if error > tolerance:
            replacement = "another seed" if recipe.record is None else "another record"
            poor.append(
                f"factors.motion: {recipe.name} has an rms misfit of {100 * error:.1f} % from "
                f"{recipe.spectrum.words}, more than {100 * tolerance:g} %; use {replacement}, "
                f"or set tolerance = {np.ceil(100 * error) / 100:g}"
            )
    if len(poor) > NAMED:
        poor = [*poor[:NAMED], f"and {len(poor) - NAMED} more of them"]
    if poor:
        raise InputError(poor)
    return [replace(motions[recipe.key], name=recipe.name) for recipe in required]


def _make(_: None, recipe: Recipe) -> GroundMotion:
    return recipe.make(progress=raise_if_stopped)


def _motions_by_key(factor: MotionFactor) -> dict[str, GroundMotion]:
    motions = factor.matched_motions()
    if not motions:
        return {}
    return {recipe.key: motion for recipe, motion in zip(_recipes(factor), motions, strict=True)}


def matched_motions_bytes(study: Study) -> bytes:
    """Return the file of matched motions of the directory of a study."""
    return _motions_bytes(_motions_by_key(study.factors.motion))
