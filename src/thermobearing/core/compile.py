"""Compilation of the kernels, and the cache of their machine code.

Every kernel is compiled by the decorator `compiled`. The machine code is kept on disk in a folder
named after the digest of all kernel sources. numba's own cache compares the path and the time
stamp of a single source file: it would compile everything again in every clone, and it would run
stale code after a change in an imported file. Here the digest alone decides.
"""

import contextlib
import hashlib
import os
import shutil
import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import caching as _caching
from platformdirs import user_cache_path

caching: Any = _caching  # numba has no types here

# Every file with kernels, and every file that they take functions, numbers or records from;
# folders stand for all their files. A test compares this with what the kernels import.
KERNELS = (
    "core",
    "motions/spectrum.py",
    "structure/forces.py",
    "structure/newmark.py",
    "structure/predictor.py",
    "structure/takeda.py",
    "structure/types.py",
)

ROOM = 25_000_000  # for the machine code of all kernels, and some more [bytes]

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
    """The digest that identifies a set of kernels and the version that compiles them."""
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
    try:
        found = user_cache_path("thermobearing", appauthor=False)
    except RuntimeError:
        return None
    return found if found.is_absolute() else None


def _has_room(folder: Path) -> bool:
    """Return whether the machine code can be kept there.

    A folder that is read-only, on a full disk, or open to other users is not used: numba ends the
    run when it cannot write, and it runs whatever code it finds.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
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


def _is_open_to_others(folder: Path) -> bool:
    """Return whether somebody else could put code into the folder."""
    if not hasattr(os, "getuid"):
        return False
    found = folder.stat()
    return found.st_uid != os.getuid() or bool(found.st_mode & 0o022)


class _Locator(caching._CacheLocator):
    """Locate the machine code of a function by the digest of all kernel sources."""

    def __init__(self, function: Callable[..., Any], source: str) -> None:
        self._py_file = source
        self._line = function.__code__.co_firstlineno
        self._path = Path(cache_directory() or "") / Path(source).parent.name

    @classmethod
    def from_function(cls, function: Callable[..., Any], source: str) -> "_Locator":
        """Return the locator of a function."""
        return cls(function, source)

    def get_cache_path(self) -> str:
        """Return the folder of the machine code."""
        return str(self._path)

    def get_source_stamp(self) -> str:
        """Return the digest of the sources; path and time stamp do not count."""
        return kernels_digest()

    def get_disambiguator(self) -> str:
        """Return what distinguishes functions of the same name in one file."""
        return str(self._line)


class _Implementation(caching.CompileResultCacheImpl):
    _locator_classes = (_Locator,)


class _Cache(caching.FunctionCache):
    """Cache of a compiled function that compiles again what cannot be read."""

    _impl_class = _Implementation

    def load_overload(self, signature: Any, target_context: Any) -> Any:
        """Return the kept machine code, or None; damaged files are removed."""
        try:
            return super().load_overload(signature, target_context)
        except Exception:  # a damaged pickle can raise anything
            folder = cache_directory()
            if folder is not None:
                shutil.rmtree(folder, ignore_errors=True)
            return None

    def save_overload(self, signature: Any, data: Any) -> None:
        """Keep the machine code; a full disk or a removed folder must not end the run."""
        with contextlib.suppress(OSError, EOFError):
            super().save_overload(signature, data)


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
    njit: Any = numba.njit
    dispatcher: Any = njit(**OPTIONS)(function)
    if cache_directory() is not None and hasattr(dispatcher, "_cache"):  # no JIT: plain Python
        dispatcher._cache = _Cache(function)
    return cast(F, dispatcher)
