"""Motions of a study that are made to fit a spectrum, each once, before the plan.

recipes -> the directory, or the cache, or a fit now -> checked -> a study that has them
"""

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.earthquake.motion import Motion, table_of
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, misfit
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.factors import MotionFactor
from thermobearing.studies.made import MADE, cached, keep, made_bytes, read_made
from thermobearing.studies.processes import each_on_processes, go_on
from thermobearing.studies.recipes import PHASES, Fitted, Progress, Recipe, recipes
from thermobearing.studies.record import Study

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


def motions_of(factor: MotionFactor) -> list[GroundMotion]:
    """Ground motions of the levels, not yet scaled; made here if nobody has made them."""
    if factor.matched is None:
        return [motion.load() for motion in factor.levels or ()]
    if factor.made is None:  # what asks next finds them: a fit is not done twice
        wanted = recipes(factor)
        factor.keep_made(_checked(factor, wanted, _made(wanted, {}, 1, None)))
    assert factor.made is not None
    return list(factor.made.motions)


def levels_of(factor: MotionFactor) -> list[Motion]:
    """The motions as a case has them; a made one holds its samples."""
    if factor.matched is None:
        return list(factor.levels or ())
    factors = [one.factor for one in factor.levels] if factor.levels else [1.0] * len(factor.names)
    return [
        Motion(**(table_of(motion) | {"factor": own, "label": motion.name}))
        for motion, own in zip(motions_of(factor), factors, strict=True)
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


def missing_of(study: Study, directory: Path | None = None) -> list[Recipe]:
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
    return [one for one in recipes(factor) if one.key not in kept and cached(one) is None]


def tried(study: Study) -> tuple[Study, int, float]:
    """A study whose runs can be measured, motions that a start would make, seconds for each.

    Where there are some, the first of them is made, and stands for all.

    Raises
    ------
    InputError : it does not come near enough to the spectrum.
    """
    missing = missing_of(study)
    if not missing:
        return with_matched(study, jobs=1), 0, 0.0
    begin = time.perf_counter()
    (one,) = _made(missing[:1], {}, 1, None)
    took = time.perf_counter() - begin
    (motion,) = _checked(study.factors.motion, missing[:1], [one])
    return with_stand_ins(study, motion), len(missing_of(study)), took


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
        f"{recipe.spectrum.told}, more than {100 * most:g} %; take "
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
        recipe.key: kept.get(recipe.key) or cached(recipe) for recipe in wanted
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


def content_of(study: Study) -> bytes:
    """What the directory of a study keeps of its made motions, which are there."""
    known = _known(study.factors.motion)
    return made_bytes([recipe for recipe, _ in known], [one for _, one in known])


def _known(factor: MotionFactor) -> list[tuple[Recipe, Fitted]]:
    """Motions that are made already."""
    if factor.made is None:
        return []
    return [
        (recipe, Fitted(motion, misfit(motion, recipe.spectrum.at)))
        for recipe, motion in zip(recipes(factor), factor.made.motions, strict=True)
    ]
