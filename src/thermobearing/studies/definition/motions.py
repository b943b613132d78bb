"""Motions matched to a spectrum for a study, computed once and kept.

A fit takes some seconds, so that its motion is kept: a second start, another part of the study or
a dry run find it. The directory of a study has its own copy, since the last bits of a fit are
those of the machine that made it, and the names of runs depend on them.

recipes -> the directory, or the cache, or a fit now -> checked -> a study that has them
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
from typing import Any, NamedTuple

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.text_file import write_whole
from thermobearing.core.compile import cache_directory
from thermobearing.earthquake.case import Motion, motion_table
from thermobearing.motions import targets
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, misfit
from thermobearing.motions.process import resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import check_record, make_motion, match_spectrum
from thermobearing.motions.targets import (
    DesignSpectrum,
    find_kind,
    list_spectra,
    load_spectrum,
)
from thermobearing.studies.definition.record import MotionFactor, Study
from thermobearing.studies.run.processes import call_on_processes, go_on

SEED, STEP = 1, 0.01  # defaults; [s]
PHASES = "jra-ii-i"  # default of a spectrum from a file
Progress = Callable[[int, int], None]
MADE = "motions.npz"  # of the directory of a study
CACHE = "motions"  # folder next to the machine code
# What numpy, zipfile and zlib raise for a file of which a bit was changed.
DAMAGED: tuple[type[Exception], ...] = (OSError, ValueError, KeyError, TypeError, EOFError)
DAMAGED += (RuntimeError, OverflowError, zipfile.BadZipFile, zlib.error, struct.error)
ABOUT = "about"  # entry of a file with what is no array, as JSON
STAND_IN = f"{PHASES}-1"  # a built-in motion in the place of one that is not made yet
NAMED = 3  # motions that are named in a message


class Fitted(NamedTuple):
    """A motion that was made, and the root mean square misfit to its spectrum."""

    motion: GroundMotion
    misfit: float


@dataclass(frozen=True)
class Recipe:
    """What one motion is made of: random phases of a seed, or those of a record."""

    name: str  # of the motion
    spectrum: DesignSpectrum  # that it shall fit
    phases: tuple[str, str] = ("II", "I")  # type and ground of the shaking, of random phases
    seed: int = SEED  # of random phases
    dt: float = STEP
    record: GroundMotion | None = None  # whose phases are kept instead

    @property
    def key(self) -> str:
        """Digest of all that goes into it but its name."""
        parts: list[Any] = [tuple(self.spectrum.curve), self.spectrum.factor]
        raw = b""
        if self.record is None:
            parts += [self.phases, self.seed, self.dt]
        else:
            parts += [self.record.dt]
            raw = self.record.acceleration.astype("<f8").tobytes()
        return hashlib.sha256(json.dumps(parts).encode() + raw).hexdigest()

    def make(self, progress: Progress | None = None) -> Fitted:
        """Make the motion; takes seconds."""
        words: dict[str, Any] = {"spectrum": self.spectrum, "progress": progress}
        if self.record is None:
            motion = make_motion(*self.phases, self.seed, self.dt, **words)
        else:
            motion = match_spectrum(self.record, **words)
        return Fitted(motion, misfit(motion, self.spectrum.at))


def _recipes(factor: MotionFactor) -> list[Recipe]:
    """Return what the motions of a factor with `matched` are made of."""
    assert factor.matched is not None
    spectrum = load_spectrum(factor.matched, factor.zone_factor or 1.0)
    if factor.levels is None:
        named = spectrum.name if spectrum.name in list_spectra() else PHASES
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
    """Return a digest of what makes motions: the files of their package, and the libraries."""
    found = hashlib.sha256(f"numpy {version('numpy')} scipy {version('scipy')}".encode())
    folder = Path(targets.__file__).parent
    for path in [*sorted(folder.glob("*.py")), data_path("phases", "near-fault.toml")]:
        found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _cache_file(recipe: Recipe) -> Path | None:
    folder = cache_directory()
    return None if folder is None else folder / CACHE / _sources() / f"{recipe.key[:32]}.npz"


def _cached(recipe: Recipe) -> Fitted | None:
    file = _cache_file(recipe)
    return None if file is None else _read_made(file).get(recipe.key)


def _keep(recipe: Recipe, one: Fitted) -> None:
    file = _cache_file(recipe)
    if file is not None:
        with suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True)
            write_whole(file, _made_bytes([(recipe, one)]))


def _made_bytes(pairs: Sequence[tuple[Recipe, Fitted]]) -> bytes:
    arrays: dict[str, Any] = {recipe.key: one.motion.acceleration for recipe, one in pairs}
    about = {
        recipe.key: {
            "name": recipe.name,
            "dt": one.motion.dt,
            "misfit": one.misfit,
            "description": one.motion.description,
            "citation": one.motion.citation,
        }
        for recipe, one in pairs
    }
    stream = io.BytesIO()
    arrays[ABOUT] = np.array(json.dumps(about))
    np.savez(stream, **arrays)
    return stream.getvalue()


def _read_made(path: Path) -> dict[str, Fitted]:
    """Return the motions of a file by key of their recipe; none if it is damaged or missing."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            found = {}
            for key, about in json.loads(str(stored[ABOUT])).items():
                words = {name: str(about[name]) for name in ("name", "description", "citation")}
                motion = GroundMotion(dt=float(about["dt"]), acceleration=stored[key], **words)
                found[key] = Fitted(motion, float(about["misfit"]))
            return found
    except DAMAGED:
        return {}


def motions_to_be(factor: MotionFactor) -> list[GroundMotion]:
    """Return a step of rest for each motion that is to be made, as long as its own steps."""
    try:
        steps = [recipe.record or recipe for recipe in _recipes(factor)]
    except InputError as error:
        raise InputError(error.lines("factors.motion")) from None
    return [GroundMotion("to be made", one.dt, np.zeros(2)) for one in steps]


def factor_motions(factor: MotionFactor) -> list[GroundMotion]:
    """Return the motions of the levels, not yet scaled; made here if nobody has made them."""
    if factor.matched is None:
        return [motion.load() for motion in factor.levels or ()]
    if factor.made is None:  # a fit is not done twice
        wanted = _recipes(factor)
        factor.keep_made(_checked(factor, wanted, _made(wanted, {}, 1, None)))
    assert factor.made is not None
    return list(factor.made.motions)


def motion_levels(factor: MotionFactor) -> list[Motion]:
    """Return the motions as a case has them; a made one holds its samples."""
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
    """Return a study whose motions are made; those of its directory or of the cache are taken."""
    factor = study.factors.motion
    if factor.matched is None:
        return study
    known = {recipe.key: one for recipe, one in _known(factor)}
    if directory is not None:
        known |= _read_made(directory / MADE)
    wanted = _recipes(factor)
    found = _made(wanted, known, jobs or os.cpu_count() or 1, progress)
    return _with(study, _checked(factor, wanted, found))


def with_kept(study: Study, directory: Path) -> Study:
    """Return a study with the motions of its directory, if it has all of them."""
    kept = _read_made(directory / MADE)
    wanted = _recipes(study.factors.motion) if kept and study.factors.motion.matched else []
    if not wanted or any(recipe.key not in kept for recipe in wanted):
        return study
    return _with(study, _named(wanted, [kept[recipe.key] for recipe in wanted]))


def with_stand_ins(study: Study, one: GroundMotion | None = None) -> Study:
    """Return a study whose missing motions are all the same one, to count and measure runs."""
    factor = study.factors.motion
    if factor.matched is None or factor.made is not None:
        return study
    one = one or load_motion(STAND_IN)
    return _with(study, [replace(one, name=name) for name in factor.names])


def missing_motions(study: Study, directory: Path | None = None) -> list[Recipe]:
    """Return the motions that a start in a directory would make."""
    factor = study.factors.motion
    if factor.matched is None or factor.made is not None:
        return []
    kept = {} if directory is None else _read_made(directory / MADE)
    return [one for one in _recipes(factor) if one.key not in kept and _cached(one) is None]


def with_first_motion(study: Study) -> tuple[Study, int, float]:
    """Return a study whose runs can be measured, and the number and seconds of missing motions.

    Where motions are missing, the first of them is made, and stands for all.
    """
    missing = missing_motions(study)
    if not missing:
        return with_matched(study, jobs=1), 0, 0.0
    begin = time.perf_counter()
    fitted = _made(missing[:1], {}, 1, None)
    took = time.perf_counter() - begin
    (motion,) = _checked(study.factors.motion, missing[:1], fitted)
    return with_stand_ins(study, motion), len(missing_motions(study)), took


def _with(study: Study, motions: Sequence[GroundMotion]) -> Study:
    factor = study.factors.motion.model_copy()
    factor.keep_made(motions)
    factors = study.factors.model_copy(update={"motion": factor})
    return study.model_copy(update={"factors": factors})


def _named(wanted: Sequence[Recipe], found: Sequence[Fitted]) -> list[GroundMotion]:
    pairs = zip(wanted, found, strict=True)
    return [replace(one.motion, name=recipe.name) for recipe, one in pairs]


def _checked(
    factor: MotionFactor, wanted: Sequence[Recipe], found: Sequence[Fitted]
) -> list[GroundMotion]:
    """Return motions that fit; InputError that names those that do not."""
    most = LARGEST_MISFIT if factor.tolerance is None else factor.tolerance
    poor = [
        f"factors.motion: {recipe.name} comes within {100 * one.misfit:.1f} % rms of "
        f"{recipe.spectrum.words}, more than {100 * most:g} %; take "
        + ("another record" if recipe.record is not None else "another seed")
        + f", or allow it with tolerance = {np.ceil(100 * one.misfit) / 100:g}"
        for recipe, one in zip(wanted, found, strict=True)
        if one.misfit > most
    ]
    if poor:
        more = len(poor) - NAMED
        raise InputError([*poor[:NAMED], *([f"and {more} more of them"] if more > 0 else [])])
    return _named(wanted, found)


def _made(
    wanted: Sequence[Recipe], kept: Mapping[str, Fitted], jobs: int, progress: Progress | None
) -> list[Fitted]:
    """Return each motion from `kept`, from the cache, or made now."""
    found = {recipe.key: kept.get(recipe.key) or _cached(recipe) for recipe in wanted}
    missing = list({recipe.key: recipe for recipe in wanted if found[recipe.key] is None}.values())
    if progress and missing:
        progress(len(wanted) - len(missing), len(wanted))
    calls = call_on_processes(_make, None, missing, min(jobs, len(missing)))
    for done, (recipe, one) in enumerate(calls, 1):
        found[recipe.key] = one
        _keep(recipe, one)
        if progress:
            progress(len(wanted) - len(missing) + done, len(wanted))
    return [fit for recipe in wanted if (fit := found[recipe.key]) is not None]


def _make(_: None, recipe: Recipe) -> Fitted:
    return recipe.make(progress=go_on)


def matched_motions_bytes(study: Study) -> bytes:
    """Return the file of made motions of the directory of a study."""
    return _made_bytes(_known(study.factors.motion))


def _known(factor: MotionFactor) -> list[tuple[Recipe, Fitted]]:
    if factor.made is None:
        return []
    return [
        (recipe, Fitted(motion, misfit(motion, recipe.spectrum.at)))
        for recipe, motion in zip(_recipes(factor), factor.made.motions, strict=True)
    ]
