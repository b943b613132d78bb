"""Motions matched to a spectrum for a study, computed once and kept.

A fit takes some seconds, so that what is made is kept: a second start, another part of the study
or a dry run find it. The directory of a study has its own copy, since the last bits of a fit are
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
from dataclasses import dataclass, replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.text_file import write_whole
from thermobearing.core.compile import cache_directory
from thermobearing.earthquake.inputs import Motion, make_table
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
from thermobearing.studies.definition.factors import MotionFactor
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.processes import each_on_processes, go_on

SEED, STEP = 1, 0.01  # where nothing is said; [s]
PHASES = "jra-ii-i"  # likewise, of a spectrum of one's own
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Recipe:
    """What one motion is made of: random phases of a seed, or those of a record.

    Attributes
    ----------
    name : of the motion.
    spectrum : that it shall fit.
    phases : type and ground of the shaking, of random phases.
    seed, dt : of random phases.
    record : whose phases are kept instead.
    """

    name: str
    spectrum: DesignSpectrum
    phases: tuple[str, str] = ("II", "I")
    seed: int = SEED
    dt: float = STEP
    record: GroundMotion | None = None

    @property
    def key(self) -> str:
        """Digest of all that goes into it, whatever it is called."""
        told: list[Any] = [tuple(self.spectrum.curve), self.spectrum.factor]
        raw = b""
        if self.record is None:
            told += [self.phases, self.seed, self.dt]
        else:
            told += [self.record.dt]
            raw = self.record.acceleration.astype("<f8").tobytes()
        return hashlib.sha256(json.dumps(told).encode() + raw).hexdigest()

    def make(self, progress: Progress | None = None) -> "Fitted":
        """Make it; takes seconds."""
        words: dict[str, Any] = {"spectrum": self.spectrum, "progress": progress}
        if self.record is None:
            motion = make_motion(*self.phases, self.seed, self.dt, **words)
        else:
            motion = match_spectrum(self.record, **words)
        return Fitted(motion, misfit(motion, self.spectrum.at))


@dataclass(frozen=True)
class Fitted:
    """A motion that was made, and the root mean square of how far it is from its spectrum."""

    motion: GroundMotion
    misfit: float


def recipes(factor: MotionFactor) -> list[Recipe]:
    """What the motions of a factor are made of.

    Parameters
    ----------
    factor : with `matched`.

    Raises
    ------
    InputError : no such spectrum, records that cannot be adjusted.
    """
    assert factor.matched is not None
    spectrum = load_spectrum(factor.matched, factor.zone_factor or 1.0)
    faults: list[str] = []
    if factor.levels is None:
        named = spectrum.name if spectrum.name in list_spectra() else PHASES
        phases, first = find_kind(factor.phases or named), factor.seed
        first = SEED if first is None else first
        return [
            Recipe(name, spectrum, phases, first + place, factor.dt or STEP)
            for place, name in enumerate(factor.names)
        ]
    found = []
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


MADE = "motions.npz"  # of the directory of a study
CACHE = "motions"  # folder beside the machine code, which is as easily made again
# What numpy, zipfile and zlib meet in a file of which a bit was changed.
DAMAGED: tuple[type[Exception], ...] = (OSError, ValueError, KeyError, TypeError, EOFError)
DAMAGED += (RuntimeError, OverflowError, zipfile.BadZipFile, zlib.error, struct.error)
ABOUT = "about"  # entry of a file with what is no array, as JSON


@cache
def _sources() -> str:
    """Digest of what makes motions: the files of their room, and the libraries below."""
    found = hashlib.sha256(f"numpy {version('numpy')} scipy {version('scipy')}".encode())
    folder = Path(targets.__file__).parent
    for path in [*sorted(folder.glob("*.py")), data_path("phases", "near-fault.toml")]:
        found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _cache_file(recipe: Recipe) -> Path | None:
    folder = cache_directory()
    return None if folder is None else folder / CACHE / _sources() / f"{recipe.key[:32]}.npz"


def _cached(recipe: Recipe) -> Fitted | None:
    """What an earlier start made of it."""
    file = _cache_file(recipe)
    return None if file is None else read_made(file).get(recipe.key)


def keep(recipe: Recipe, one: Fitted) -> None:
    """Remember a motion; a cache that cannot be written only costs time."""
    file = _cache_file(recipe)
    if file is None:
        return
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, _made_bytes([recipe], [one]))
    except OSError:
        return


def _made_bytes(wanted: Sequence[Recipe], found: Sequence[Fitted]) -> bytes:
    """Made motions as the content of a file; the same motions make the same bytes."""
    arrays: dict[str, Any] = {}
    about: dict[str, Any] = {}
    for recipe, one in zip(wanted, found, strict=True):
        motion = one.motion
        arrays[recipe.key] = motion.acceleration
        about[recipe.key] = {
            "name": recipe.name,
            "dt": motion.dt,
            "misfit": one.misfit,
            "description": motion.description,
            "citation": motion.citation,
        }
    stream = io.BytesIO()
    arrays[ABOUT] = np.array(json.dumps(about))
    np.savez(stream, **arrays)
    return stream.getvalue()


def read_made(path: Path) -> dict[str, Fitted]:
    """Motions of a file by key of their recipe; none if it is damaged or not there."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            about = json.loads(str(stored[ABOUT]))
            return {key: _fitted(stored[key], told) for key, told in about.items()}
    except DAMAGED:
        return {}


def _fitted(acceleration: Any, told: dict[str, Any]) -> Fitted:
    words = {key: str(told[key]) for key in ("name", "description", "citation")}
    motion = GroundMotion(dt=float(told["dt"]), acceleration=acceleration, **words)
    return Fitted(motion, float(told["misfit"]))


STAND_IN = f"{PHASES}-1"  # a built-in motion where one of those that are to be made must stand
TOLD = 3  # motions that are named in a message


def is_matched(study: Study) -> bool:
    """Whether its motions are made to fit a spectrum."""
    return study.factors.motion.matched is not None


def motions_to_be(factor: MotionFactor) -> list[GroundMotion]:
    """For each motion that is to be made a step of rest, as long as its own steps.

    Raises
    ------
    InputError : see `recipes`.
    """
    try:
        steps = [recipe.record or recipe for recipe in recipes(factor)]
    except InputError as error:
        raise InputError(error.lines("factors.motion")) from None
    return [GroundMotion("to be made", one.dt, np.zeros(2)) for one in steps]


def factor_motions(factor: MotionFactor) -> list[GroundMotion]:
    """Ground motions of the levels, not yet scaled; made here if nobody has made them."""
    if factor.matched is None:
        return [motion.load() for motion in factor.levels or ()]
    if factor.made is None:  # what asks next finds them: a fit is not done twice
        wanted = recipes(factor)
        factor.keep_made(_checked(factor, wanted, _made(wanted, {}, 1, None)))
    assert factor.made is not None
    return list(factor.made.motions)


def motion_levels(factor: MotionFactor) -> list[Motion]:
    """The motions as a case has them; a made one holds its samples."""
    if factor.matched is None:
        return list(factor.levels or ())
    factors = [one.factor for one in factor.levels] if factor.levels else [1.0] * len(factor.names)
    return [
        Motion(**(make_table(motion) | {"factor": own, "label": motion.name}))
        for motion, own in zip(factor_motions(factor), factors, strict=True)
    ]


def with_matched(
    study: Study,
    directory: Path | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Study:
    """A study whose motions are made, each once: those of its directory or of the cache are taken.

    Parameters
    ----------
    study : from `load_study`; one without such motions is returned as it is.
    directory : of the study, if it has one.
    jobs : processes; as many as there are cores by default.
    progress : called with (motions that are there, all).

    Raises
    ------
    InputError : a motion does not come near enough to the spectrum.
    """
    factor = study.factors.motion
    if factor.matched is None:
        return study
    known = {recipe.key: one for recipe, one in _known(factor)}
    if directory is not None:
        known |= read_made(directory / MADE)
    wanted = recipes(factor)
    found = _made(wanted, known, jobs or os.cpu_count() or 1, progress)
    return _with(study, _checked(factor, wanted, found))


def with_kept(study: Study, directory: Path) -> Study:
    """A study with the motions of its directory, if all of them are there."""
    if not is_matched(study) or not (directory / MADE).is_file():
        return study
    kept = read_made(directory / MADE)
    wanted = recipes(study.factors.motion)
    if not all(recipe.key in kept for recipe in wanted):
        return study
    return _with(study, _named(wanted, [kept[recipe.key] for recipe in wanted]))


def with_stand_ins(study: Study, one: GroundMotion | None = None) -> Study:
    """A study whose motions are all the same one, to count runs and to measure them.

    Parameters
    ----------
    study : one whose motions are there is returned as it is.
    one : the motion; a built-in one by default.
    """
    factor = study.factors.motion
    if factor.matched is None or factor.made is not None:
        return study
    one = one or load_motion(STAND_IN)
    return _with(study, [replace(one, name=name) for name in factor.names])


def missing_motions(study: Study, directory: Path | None = None) -> list[Recipe]:
    """Motions that a start would make.

    Parameters
    ----------
    study : from `load_study`.
    directory : of the study, if it has one.
    """
    factor = study.factors.motion
    if factor.matched is None or factor.made is not None:
        return []
    kept = {} if directory is None else read_made(directory / MADE)
    return [one for one in recipes(factor) if one.key not in kept and _cached(one) is None]


def tried(study: Study) -> tuple[Study, int, float]:
    """A study whose runs can be measured, motions that a start would make, seconds for each.

    Where there are some, the first of them is made, and stands for all.

    Raises
    ------
    InputError : it does not come near enough to the spectrum.
    """
    missing = missing_motions(study)
    if not missing:
        return with_matched(study, jobs=1), 0, 0.0
    begin = time.perf_counter()
    (one,) = _made(missing[:1], {}, 1, None)
    took = time.perf_counter() - begin
    (motion,) = _checked(study.factors.motion, missing[:1], [one])
    return with_stand_ins(study, motion), len(missing_motions(study)), took


def _with(study: Study, motions: Sequence[GroundMotion]) -> Study:
    """The same study, whose motions are made."""
    factor = study.factors.motion.model_copy()
    factor.keep_made(motions)
    factors = study.factors.model_copy(update={"motion": factor})
    return study.model_copy(update={"factors": factors})


def _named(wanted: Sequence[Recipe], found: Sequence[Fitted]) -> list[GroundMotion]:
    """Motions under the names that the study has for them."""
    return [
        replace(one.motion, name=recipe.name) for recipe, one in zip(wanted, found, strict=True)
    ]


def _checked(
    factor: MotionFactor, wanted: Sequence[Recipe], found: Sequence[Fitted]
) -> list[GroundMotion]:
    """Motions that fit; InputError that names those that do not."""
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
        more = len(poor) - TOLD
        raise InputError([*poor[:TOLD], *([f"and {more} more of them"] if more > 0 else [])])
    return _named(wanted, found)


def _made(
    wanted: Sequence[Recipe], kept: Mapping[str, Fitted], jobs: int, progress: Progress | None
) -> list[Fitted]:
    """Each motion from the directory, from the cache, or made now."""
    found: dict[str, Fitted | None] = {
        recipe.key: kept.get(recipe.key) or _cached(recipe) for recipe in wanted
    }
    missing = list({recipe.key: recipe for recipe in wanted if found[recipe.key] is None}.values())
    if progress and missing:
        progress(len(wanted) - len(missing), len(wanted))
    for done, (recipe, one) in enumerate(each_on_processes(_make, missing, jobs), 1):
        found[recipe.key] = one
        keep(recipe, one)
        if progress:
            progress(len(wanted) - len(missing) + done, len(wanted))
    return [fit for recipe in wanted if (fit := found[recipe.key]) is not None]


def _make(recipe: Recipe) -> Fitted:
    """One motion, in whichever process."""
    return recipe.make(progress=go_on)


def kept_motions_digest(study: Study) -> bytes:
    """What the directory of a study keeps of its made motions, which are there."""
    known = _known(study.factors.motion)
    return _made_bytes([recipe for recipe, _ in known], [one for _, one in known])


def _known(factor: MotionFactor) -> list[tuple[Recipe, Fitted]]:
    """Motions that are made already."""
    if factor.made is None:
        return []
    return [
        (recipe, Fitted(motion, misfit(motion, recipe.spectrum.at)))
        for recipe, motion in zip(recipes(factor), factor.made.motions, strict=True)
    ]
