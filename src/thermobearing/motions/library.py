"""Ground motions by name or by file: those shipped with the package, and the user's own."""

import json
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError, nearest
from thermobearing.motions.readers import read_motion
from thermobearing.motions.record import GroundMotion

STORED_DT = 0.01  # [s]
FILE = "jra-level-2-stand-ins.npz"
ABOUT = "about"  # entry of the file with names and descriptions, as JSON


def stored_motions() -> Path:
    """The file of the built-in motions: one array [mm/s2] for each, by name."""
    return Path(str(resources.files("thermobearing") / "data" / "motions" / FILE))


@cache
def _about() -> dict[str, dict[str, str]]:
    with np.load(stored_motions()) as stored:
        return dict(json.loads(str(stored[ABOUT])))


def list_motions() -> list[str]:
    """Names of the built-in motions: `jra-<type>-<ground>-<seed>`.

    They are synthetic stand-ins that fit the standard spectra of Level 2, not the accelerograms
    of the specifications, which are not free to ship.

    Examples
    --------
    >>> list_motions()[:3]
    ['jra-i-i-1', 'jra-i-i-2', 'jra-i-i-3']
    """
    return sorted(_about())


def load_motion(name_or_path: str | Path, **options: Any) -> GroundMotion:
    """A built-in ground motion by name, or one of your own from a file.

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
            raise InputError(f'"{text}" is built in and takes no {", ".join(given)}')
        with np.load(stored_motions()) as stored:
            values = np.asarray(stored[text], dtype=np.float64)
        return GroundMotion(text, STORED_DT, values, **_about()[text])
    path = Path(text)
    if not (isinstance(name_or_path, Path) or path.suffix or "/" in text):
        try:
            known = path.exists()
        except (OSError, ValueError):
            known = False
        if not known:
            raise InputError(f'no motion is called "{text}"{nearest(text, list_motions())}')
    return read_motion(path, **options)
