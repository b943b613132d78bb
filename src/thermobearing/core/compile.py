"""How the scalar functions become machine code, and where that code is kept.

One decorator, `compiled`, so that every kernel is compiled the same way. The machine code
is cached on disk under a folder named after a hash of all sources that kernels are made of:
numba itself notices a change of the decorated function's own file only, and would happily run
a stale copy of a function or a number imported from another file.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

# Every file with kernels, and every file that they take functions, numbers or records from;
# folders stand for all their files. A test compares this with what the kernels import.
KERNELS = (
    "core",
    "structure/books.py",
    "structure/dense.py",
    "structure/forces.py",
    "structure/lines.py",
    "structure/lockstep.py",
    "structure/newmark.py",
    "structure/peaks.py",
    "structure/predictor.py",
    "structure/takeda.py",
    "structure/types.py",
    "motions/spectrum.py",
)

ROOM = 20_000_000  # for the machine code of all kernels, and some more [bytes]

OPTIONS: Any = {
    "error_model": "numpy",
    "fastmath": {"contract"},
    "forceinline": True,
    "_nrt": False,
    "nogil": True,
}

F = TypeVar("F", bound=Callable[..., Any])


def kernel_files() -> list[Path]:
    """The files of KERNELS."""
    package = Path(__file__).parents[1]
    found: list[Path] = []
    for part in KERNELS:
        place = package / part
        found += sorted(place.rglob("*.py")) if place.is_dir() else [place]
    return found


@cache
def kernels_digest() -> str:
    """What tells one set of kernels, and the version that compiles them, from another."""
    digest = hashlib.sha256(f"{numba.__version__}".encode())
    for source in kernel_files():
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_directory() -> Path | None:
    """Folder for the compiled code of exactly these sources, or None if none can be written."""
    base = _base()
    folder = base / kernels_digest() if base else None
    return folder if folder and _has_room(folder) else None


def _base() -> Path | None:
    """The user's folder for what can be made again; None where there is no home."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return Path(given)
    cache = os.environ.get("XDG_CACHE_HOME")
    try:
        home = Path(cache) if cache else Path.home() / ".cache"
    except RuntimeError:
        return None
    return home / "thermobearing" if home.is_absolute() else None


def _has_room(folder: Path) -> bool:
    """Whether the machine code can be written there: not if read-only, not if the disk is full.

    Numba would end the run when it cannot.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as trial:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(trial.fileno(), 0, ROOM)
    except OSError:
        return False
    return True


def is_compiled(kernel: str) -> bool:
    """Whether the machine code of a kernel, as "march.march", is kept from an earlier run."""
    folder = cache_directory()
    return folder is not None and any(folder.rglob(f"{kernel}-*.nbi"))


def compiled(function: F) -> F:
    """Compile a scalar function with numba; the plain Python stays at `.py_func`.

    `contract` lets the compiler fuse a multiply and an add (same bits on one machine);
    no other floating-point rule is relaxed, so NaN checks and signs stay as written.
    `_nrt=False` leaves out numba's reference counting of arrays, and `forceinline` the passing
    of records between functions; each took more time than the physics. The price is that
    kernels cannot allocate, which they must not anyway. Without allocation nothing needs the
    interpreter, so threads may run side by side (`nogil`).
    """
    folder = cache_directory()
    config: Any = numba.config
    njit: Any = numba.njit
    previous = config.CACHE_DIR
    config.CACHE_DIR = str(folder or "")
    try:
        decorate = njit(cache=folder is not None, **OPTIONS)
        return cast(F, decorate(function))
    finally:
        config.CACHE_DIR = previous
