"""Ground motions by name or file: those of the package, and user files.

`python -m benchmarks.stored_motions [NAME...]` makes the stored motions again.
"""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path, unknown_name
from thermobearing.border.opener import is_file
from thermobearing.border.text_file import write_file
from thermobearing.core.types import Floats
from thermobearing.motions.readers import TARGET, read_motion
from thermobearing.motions.record import MM_S2_PER_GAL, STANDARD_GRAVITY, GroundMotion

STORED_DT = 0.01  # [s]
# One array [mm/s2] for each built-in motion, by name.
STORED = data_path("motions", "jra-level-2-stand-ins.npz")
FORMATS = (".csv", ".at2")
AT2_ROW = 5  # accelerations in a line of an AT2 file
ABOUT = "about"  # entry of the file with names and descriptions, as JSON


@cache
def _about() -> dict[str, dict[str, Any]]:
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


@checked
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
        file_options = sorted(key for key, value in options.items() if value not in (None, False))
        if file_options:
            raise InputError(f'"{text}" is built in and does not accept {", ".join(file_options)}')
        return GroundMotion(text, STORED_DT, _stored(text).copy(), **_about()[text])
    path = Path(text)
    looks_like_a_path = isinstance(name_or_path, Path) or path.suffix or "/" in text
    if not looks_like_a_path and not is_file(path):
        raise unknown_name("motion", text, list_motions())
    return read_motion(path, **options)


@checked
def save_motion(motion: GroundMotion, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a ground motion as a table or in the format of PEER, which `load_motion` reads.

    Parameters
    ----------
    motion : the ground motion.
    path : of the file: ".csv" for the columns t_s [s] and acc_gal [gal], ".AT2" for accelerations
        in g, five in a line, below a header with name, number of samples and time step.
    overwrite : replace an existing file.

    Returns
    -------
    Path : the file.

    Raises
    ------
    InputError : another ending of the file.
    OutputError : the file exists and `overwrite` is False, or it cannot be written.

    Notes
    -----
    Accelerations have nine significant digits in a table and eight in an AT2 file. Above a table
    stand the description and the target spectrum of a generated motion; an AT2 file has the
    description alone, which names the spectrum, the seed and the misfit.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     load_motion(save_motion(load_motion("jra-ii-i-1"), folder + "/mine.AT2")).dt
    0.01
    """
    file = Path(path)
    if file.suffix.lower() not in FORMATS:
        raise InputError('is not a file that ends in ".csv" or ".AT2"', str(file))
    as_text = _csv_text if file.suffix.lower() == ".csv" else _at2_text
    write_file(file, as_text(motion), overwrite=overwrite)
    return file


def header_lines(motion: GroundMotion) -> list[str]:
    """Return description and target spectrum of a motion as comments above a table."""
    lines = [f"# {text}"] if (text := " ".join(motion.description.split())) else []
    if motion.target is not None:
        from thermobearing.motions.targets import target_text  # takes scipy

        lines.append(f"# {TARGET} {target_text(motion.target)}")
    return lines


def _csv_text(motion: GroundMotion) -> str:
    values = motion.acceleration / MM_S2_PER_GAL
    rows = (f"{t:.10g},{a:.9g}" for t, a in zip(motion.time, values, strict=True))
    return "\n".join([*header_lines(motion), "t_s,acc_gal", *rows, ""])


def _at2_text(motion: GroundMotion) -> str:
    """Return the text of an AT2 file: three free lines, the unit last, then counts and numbers."""
    values = [f"{value:15.7E}" for value in motion.acceleration / STANDARD_GRAVITY]
    rows = ["".join(values[k : k + AT2_ROW]) for k in range(0, len(values), AT2_ROW)]
    name = f"{motion.name}, {motion.component}" if motion.component else motion.name
    header = [
        " ".join(motion.description.split()) or "written by thermobearing",
        " ".join(name.split()),
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {len(values)}, DT= {motion.dt:.9g} SEC",
    ]
    return "\n".join([*header, *rows, ""])
