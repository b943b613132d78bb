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
from thermobearing.border.text_file import write_whole
from thermobearing.core.compiled.sources import cache_directory
from thermobearing.earthquake.motions import Motion, motion_table
from thermobearing.motions import targets
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, misfit
from thermobearing.motions.process import resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import check_record, make_motion, match_spectrum
from thermobearing.motions.targets import STANDARD_NAMES, DesignSpectrum, find_kind, load_spectrum
from thermobearing.studies.definition.record import MotionFactor, Study
from thermobearing.studies.run.processes import call_on_processes, go_on

SEED, STEP = 1, 0.01  # defaults; [s]
PHASES = "jra-ii-i"  # default for a spectrum from a file
Progress = Callable[[int, int], None]
MADE = "motions.npz"  # of the directory of a study
CACHE = "motions"  # folder next to the machine code
# Errors of numpy, zipfile and zlib for a file with a changed bit.
DAMAGED: tuple[type[Exception], ...] = (OSError, ValueError, KeyError, TypeError, EOFError)
DAMAGED += (RuntimeError, OverflowError, zipfile.BadZipFile, zlib.error, struct.error)
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
        named = spectrum.name if spectrum.name in STANDARD_NAMES else PHASES
        phases = find_kind(factor.phases or named)
        first = SEED if factor.seed is None else factor.seed
        return [
            Recipe(name, spectrum, phases, first + place, factor.dt or STEP)
            for place, name in enumerate(factor.names)
        ]
    found: list[Recipe] = []
    faults: list[str] = []
    for name, level in zip(factor.names, factor.levels, strict=True):
        try:
            record = level.load()
            record = record if factor.dt is None else resampled(record, factor.dt)
            check_record(record)
            found.append(Recipe(name, spectrum, record=record))
        except InputError as error:
            faults += error.lines()
    if faults:
        raise InputError(faults)
    return found


@cache
def _sources() -> str:
    """Return a digest of the code that matches motions, and of its libraries."""
    found = hashlib.sha256(f"numpy {version('numpy')} scipy {version('scipy')}".encode())
    folder = Path(targets.__file__).parent
    for path in [*sorted(folder.glob("*.py")), data_path("phases", "near-fault.toml")]:
        found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _cache_file(recipe: Recipe) -> Path | None:
    folder = cache_directory()
    return None if folder is None else folder / CACHE / _sources() / f"{recipe.key[:32]}.npz"


def _cached(recipe: Recipe) -> GroundMotion | None:
    file = _cache_file(recipe)
    return None if file is None else _read_made(file).get(recipe.key)


def _made_bytes(made: Mapping[str, GroundMotion]) -> bytes:
    about = {
        key: {"dt": one.dt, **{name: getattr(one, name) for name in TEXTS}}
        for key, one in made.items()
    }
    arrays: dict[str, Any] = {key: one.acceleration for key, one in made.items()}
    arrays[ABOUT] = np.array(json.dumps(about))
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def _read_made(path: Path) -> dict[str, GroundMotion]:
    """Return the motions of a file by key of their recipe; none if it is damaged or missing."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            found = {}
            for key, about in json.loads(str(stored[ABOUT])).items():
                words = {name: str(about[name]) for name in TEXTS}
                found[key] = GroundMotion(dt=float(about["dt"]), acceleration=stored[key], **words)
            return found
    except DAMAGED:
        return {}


def motions_to_be(factor: MotionFactor) -> list[GroundMotion]:
    """Return a motion of zeros for each matched motion, with its time step."""
    try:
        steps = [recipe.record or recipe for recipe in _recipes(factor)]
    except InputError as error:
        raise InputError(error.lines("factors.motion")) from None
    return [GroundMotion("to be made", one.dt, np.zeros(2)) for one in steps]


def factor_motions(factor: MotionFactor) -> list[GroundMotion]:
    """Return the motions of the levels along the bridge, not scaled; matched here if need be."""
    if factor.matched is None:
        return [motion.load() for motion in factor.levels or ()]
    return list(factor.matched_motions() or factor.matched_motions(_made(factor, {}, 1, None)))


def motion_levels(factor: MotionFactor) -> list[Motion]:
    """Return the motions as a case has them; a matched one contains its samples."""
    if factor.matched is None:
        return list(factor.levels or ())
    factors = [one.factor for one in factor.levels] if factor.levels else [1.0] * len(factor.names)
    return [
        Motion(**(motion_table(motion) | {"factor": own, "label": motion.name}))
        for motion, own in zip(factor_motions(factor), factors, strict=True)
    ]


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
    known = _known(factor)
    if directory is not None:
        known |= _read_made(directory / MADE)
    return _with(study, _made(factor, known, jobs or os.cpu_count() or 1, progress))


def with_kept(study: Study, directory: Path) -> Study:
    """Return a study with the motions of its directory, if it has all of them."""
    kept = _read_made(directory / MADE)
    wanted = _recipes(study.factors.motion) if kept and study.factors.motion.matched else []
    if not wanted or any(recipe.key not in kept for recipe in wanted):
        return study
    return _with(study, [replace(kept[recipe.key], name=recipe.name) for recipe in wanted])


def with_stand_ins(study: Study, one: GroundMotion | None = None) -> Study:
    """Return a study that has one motion in place of all missing ones, to count and time runs."""
    factor = study.factors.motion
    if factor.matched is None or factor.matched_motions():
        return study
    one = one or load_motion(STAND_IN)
    return _with(study, [replace(one, name=name) for name in factor.names])


def missing_motions(study: Study, directory: Path | None = None) -> list[Recipe]:
    """Return the motions that a start in a directory would match."""
    factor = study.factors.motion
    if factor.matched is None or factor.matched_motions():
        return []
    kept = {} if directory is None else _read_made(directory / MADE)
    return [one for one in _recipes(factor) if one.key not in kept and _cached(one) is None]


def with_first_motion(study: Study) -> tuple[Study, int, float]:
    """Return a study whose runs can be timed, and number and seconds of missing motions."""
    missing = missing_motions(study)
    if not missing:
        return with_matched(study, jobs=1), 0, 0.0
    begin = time.perf_counter()
    (motion,) = _made(study.factors.motion, {}, 1, None, missing[:1])
    took = time.perf_counter() - begin
    return with_stand_ins(study, motion), len(missing_motions(study)), took


def _with(study: Study, motions: Sequence[GroundMotion]) -> Study:
    factor = study.factors.motion.model_copy()
    factor.matched_motions(motions)
    factors = study.factors.model_copy(update={"motion": factor})
    return study.model_copy(update={"factors": factors})


def _made(
    factor: MotionFactor,
    kept: Mapping[str, GroundMotion],
    jobs: int,
    progress: Progress | None,
    recipes: Sequence[Recipe] | None = None,
) -> list[GroundMotion]:
    """Return the motion of each recipe; InputError names those whose misfit is too large."""
    wanted = _recipes(factor) if recipes is None else recipes
    found = {one.key: motion for one in wanted if (motion := kept.get(one.key) or _cached(one))}
    missing = list({one.key: one for one in wanted if one.key not in found}.values())
    done = len(wanted) - len(missing)
    if progress and missing:
        progress(done, len(wanted))
    for recipe, motion in call_on_processes(_make, None, missing, min(jobs, len(missing))):
        found[recipe.key], done = motion, done + 1
        file = _cache_file(recipe)
        with suppress(OSError):
            if file is not None:
                file.parent.mkdir(parents=True, exist_ok=True)
                write_whole(file, _made_bytes({recipe.key: motion}))
        if progress:
            progress(done, len(wanted))
    most = LARGEST_MISFIT if factor.tolerance is None else factor.tolerance
    poor = [
        f"factors.motion: {one.name} has an rms misfit of {100 * error:.1f} % from "
        f"{one.spectrum.words}, more than {100 * most:g} %; use "
        + ("another record" if one.record is not None else "another seed")
        + f", or set tolerance = {np.ceil(100 * error) / 100:g}"
        for one in wanted
        if (error := misfit(found[one.key], one.spectrum.at)) > most
    ]
    if poor:
        more = len(poor) - NAMED
        raise InputError([*poor[:NAMED], *([f"and {more} more of them"] if more > 0 else [])])
    return [replace(found[one.key], name=one.name) for one in wanted]


def _make(_: None, recipe: Recipe) -> GroundMotion:
    return recipe.make(progress=go_on)


def _known(factor: MotionFactor) -> dict[str, GroundMotion]:
    made = factor.matched_motions()
    return (
        {one.key: motion for one, motion in zip(_recipes(factor), made, strict=True)}
        if made
        else {}
    )


def matched_motions_bytes(study: Study) -> bytes:
    """Return the file of matched motions of the directory of a study."""
    return _made_bytes(_known(study.factors.motion))
