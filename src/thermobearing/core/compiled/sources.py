"""The digest of the sources of all kernels, and the folder for the machine code that numba makes.

numba's own cache compares the path and the time stamp of a single source file: it would compile
everything again in every clone, and it would run stale code after a change in an imported file.
Here the digest of all kernel sources alone decides, and the folder is named after it.
"""

import hashlib
import os
import shutil
import tempfile
import warnings
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from platformdirs import user_cache_path

# Every file with kernels, and every file that they take functions, numbers or records from;
# folders stand for all their files. A test compares this with what the kernels import.
KERNELS = (
    "core",
    "model/lead_impedance.py",
    "motions/spectrum.py",
    "results/loop.py",
    "structure/connections/devices.py",
    "structure/connections/takeda.py",
    "structure/forces.py",
    "structure/newmark.py",
    "structure/predictor.py",
    "structure/types.py",
    "structure/vertical.py",
)

# How a kernel is compiled; part of the digest.
OPTIONS: Any = {
    "error_model": "numpy",
    "fastmath": {"contract"},
    "forceinline": True,
    "_nrt": False,
    "nogil": True,
}

# The files of this folder that decide what machine code is made of the sources.
COMPILERS = ("faces.py", "jit.py", "objects.py", "tables.py")

ROOM = 25_000_000  # for the machine code of all kernels, and some more [bytes]


def kernel_files() -> list[Path]:
    """Return the files of KERNELS. How kernels are loaded and called changes no number."""
    package = Path(__file__).parents[2]
    files: list[Path] = []
    for part in KERNELS:
        place = package / part
        files += sorted(place.rglob("*.py")) if place.is_dir() else [place]
    return [file for file in files if file.parent != Path(__file__).parent]


@cache
def sources_digest() -> str:
    """Return the digest that identifies the sources of the kernels."""
    digest = hashlib.sha256(repr(OPTIONS).encode())
    for source in kernel_files():
        digest.update(source.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:16]


@cache
def kernels_digest() -> str:
    """Return the digest that identifies a set of kernels and what compiles them."""
    try:
        compiler = version("numba")
    except PackageNotFoundError:
        compiler = ""
    digest = hashlib.sha256(f"{compiler} {sources_digest()}".encode())
    for name in COMPILERS:
        digest.update(Path(__file__).with_name(name).read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:16]


@cache
def cache_directory() -> Path | None:
    """Folder for the compiled code of exactly these sources, or None if none can be written."""
    base = _base()
    folder = base / kernels_digest() if base else None
    return folder if folder and _has_room(folder) else None


def _base() -> Path | None:
    """Return the user's folder for what can be made again; None where there is no home."""
    requested = os.environ.get("NUMBA_CACHE_DIR")
    if requested:
        return Path(requested)
    try:
        folder = user_cache_path("thermobearing", appauthor=False)
    except RuntimeError:
        return None
    return folder if folder.is_absolute() else None


def _has_room(folder: Path) -> bool:
    """Return whether the machine code can be kept there.

    A folder that is read-only, on a full disk, or open to other users is not used: numba ends the
    run when it cannot write, and it runs whatever code it finds.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if _is_open_to_others(folder) and _is_own(folder):
            # Whatever others could write is thrown away: everything in it can be made again. A
            # folder of an earlier version, or of an umask of 002, would be refused for ever.
            shutil.rmtree(folder)
            folder.mkdir(mode=0o700)
        if _is_open_to_others(folder):
            warnings.warn(
                f"The cache folder {folder} belongs to another user or can be written by others, "
                "so it is not used and every run compiles again. Remove the folder, or set "
                "NUMBA_CACHE_DIR to a folder of your own.",
                stacklevel=2,
            )
            return False
        with tempfile.TemporaryFile(dir=folder) as trial:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(trial.fileno(), 0, ROOM)
    except OSError:
        return False
    return True


def _is_own(folder: Path) -> bool:
    """Return whether a folder, and no link to one, belongs to this user."""
    return not folder.is_symlink() and folder.stat().st_uid == os.getuid()


def _is_open_to_others(folder: Path) -> bool:
    """Return whether somebody else could put code into the folder."""
    if not hasattr(os, "getuid"):
        return False
    status = folder.stat()
    return status.st_uid != os.getuid() or bool(status.st_mode & 0o022)
