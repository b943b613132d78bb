"""Ground motions by name or file: those of the package, and user files.

`python -m benchmarks.stored_motions [NAME...]` makes the stored motions again.
"""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError, is_file
from thermobearing.border.library import data_path, unknown_name
from thermobearing.core.types import Floats
from thermobearing.motions.readers import read_motion
from thermobearing.motions.record import GroundMotion

STORED_DT = 0.01  # [s]
# One array [mm/s2] for each built-in motion, by name.
STORED = data_path("motions", "jra-level-2-stand-ins.npz")
ABOUT = "about"  # entry of the file with names and descriptions, as JSON


@cache
def _about() -> dict[str, dict[str, str]]:
    with np.load(STORED) as stored:
        return dict(json.loads(str(stored[ABOUT])))


@cache
def _stored(name: str) -> Floats:
    with np.load(STORED) as stored:
        return np.asarray(stored[name], dtype=np.float64)


def list_motions() -> list[str]:
    """Return the names of the built-in motions: `jra-<type>-<ground>-<seed>`.

    They are synthetic motions that fit the standard spectra of Level 2, not the accelerograms of
    the specifications, which may not be redistributed.

    Examples
    --------
    >>> list_motions()[:3]
    ['jra-i-i-1', 'jra-i-i-2', 'jra-i-i-3']
    """
    return sorted(_about())


def load_motion(name_or_path: str | Path, **options: Any) -> GroundMotion:
    """Return a built-in ground motion by name, or one of your own from a file.

    Parameters
    ----------
    name_or_path : a name of `list_motions()`, or a path to a record.
    options : of `read_motion`, for files only: unit, dt, component, name, trust_unit.

    Raises
    ------
    InputError : no such motion, or faults in the file.

    Examples
    --------
    >>> load_motion("jra-ii-i-1").dt
    0.01
    """
    text = str(name_or_path)
    if text in _about():
        given = sorted(key for key, value in options.items() if value not in (None, False))
        if given:
            raise InputError(f'"{text}" is built in and does not accept {", ".join(given)}')
        return GroundMotion(text, STORED_DT, _stored(text).copy(), **_about()[text])
    path = Path(text)
    looks_like_a_path = isinstance(name_or_path, Path) or path.suffix or "/" in text
    if not looks_like_a_path and not is_file(path):
        raise unknown_name("motion", text, list_motions())
    return read_motion(path, **options)
