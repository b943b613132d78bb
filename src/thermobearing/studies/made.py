"""Files of made motions: the user's cache, and the copy in the directory of a study.

A fit takes some seconds, so that what is made is kept: a second start, another part of the study
or a dry run find it. The directory of a study has its own copy, since the last bits of a fit are
those of the machine that made it, and the names of runs depend on them.
"""

import hashlib
import io
import json
import struct
import zipfile
import zlib
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.library import data_path
from thermobearing.border.text_file import write_whole
from thermobearing.core.compile import cache_directory
from thermobearing.motions import targets
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.recipes import Fitted, Recipe

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


def cached(recipe: Recipe) -> Fitted | None:
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
        write_whole(file, made_bytes([recipe], [one]))
    except OSError:
        return


def made_bytes(wanted: Sequence[Recipe], found: Sequence[Fitted]) -> bytes:
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
