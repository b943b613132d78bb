"""The kernels: which code runs them, and the cache of their machine code.

Every kernel is marked by the decorator `compiled`. Its first call decides what runs it: the library
that was built ahead of time (`core/native.py`), numba where there is none (`core/jit.py`), or plain
Python under NUMBA_DISABLE_JIT=1. numba is not imported before a kernel needs it.

The machine code of numba is kept on disk in a folder named after the digest of all kernel sources.
numba's own cache compares the path and the time stamp of a single source file: it would compile
everything again in every clone, and it would run stale code after a change in an imported file.
Here the digest alone decides.
"""

import hashlib
import importlib.util
import inspect
import os
import tempfile
import warnings
from collections.abc import Callable
from functools import cache, cached_property, update_wrapper
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, TypeVar, cast

from platformdirs import user_cache_path

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


# How a library is loaded and called changes nothing in what it computes.
NO_KERNELS = "core/native.py"


def kernel_files() -> list[Path]:
    """The files of KERNELS."""
    package = Path(__file__).parents[1]
    found: list[Path] = []
    for part in KERNELS:
        place = package / part
        found += sorted(place.rglob("*.py")) if place.is_dir() else [place]
    return [file for file in found if file != package / NO_KERNELS]


@cache
def sources_digest() -> str:
    """Return the digest that identifies the sources of the kernels."""
    digest = hashlib.sha256()
    for source in kernel_files():
        digest.update(source.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:16]


@cache
def kernels_digest() -> str:
    """Return the digest that identifies a set of kernels and the version that compiles them."""
    try:
        compiler = version("numba")
    except PackageNotFoundError:
        compiler = ""
    return hashlib.sha256(f"{compiler} {sources_digest()}".encode()).hexdigest()[:16]


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


class MissingKernelsError(RuntimeError):
    """The kernels can be run neither by a library nor by numba."""


class Kernel:
    """A function that is run as machine code; the plain Python is `py_func`."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        self.run: Callable[..., Any] = self._first_call
        update_wrapper(self, function)

    @property
    def name(self) -> str:
        """The place of the kernel in the package, as "core.march.march"."""
        return f"{self.__module__.partition('.')[2]}.{self.__qualname__}"

    @cached_property
    def dispatcher(self) -> Any:
        """The function as numba compiles it, for any arguments."""
        from thermobearing.core.jit import new_dispatcher

        return new_dispatcher(self.py_func)

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Run the kernel."""
        if named:
            given = inspect.signature(self.py_func).bind(*given, **named).args
        return self.run(*given)

    def _first_call(self, *given: Any) -> Any:
        self.run = self._choose()
        return self.run(*given)

    def _choose(self) -> Callable[..., Any]:
        """Return what runs the kernel from now on."""
        from thermobearing.core.native import find_face

        if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
            return self.py_func
        face, reason = find_face(self)
        if face is not None:
            return face
        if has_numba():
            return cast("Callable[..., Any]", self.dispatcher)
        if reason:
            raise MissingKernelsError(f"{reason} {NO_NUMBA}")
        return self.py_func

    def __getattr__(self, name: str) -> Any:
        """Return what numba knows of the function, such as `stats`."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    def __reduce__(self) -> str:
        """Return the name, by which another process finds the kernel."""
        return self.py_func.__qualname__


NO_NUMBA = (
    "numba, which could compile the kernels instead, is not installed: "
    'pip install "thermobearing[jit]"'
)


@cache
def has_numba() -> bool:
    """Return whether numba is installed."""
    return importlib.util.find_spec("numba") is not None


def is_compiled(kernel: str) -> bool:
    """Return whether a kernel, as "march.march", needs no compiling before its first run."""
    from thermobearing.core.native import open_library

    if open_library()[0] is not None:
        return True
    folder = cache_directory()
    return folder is not None and any(folder.rglob(f"{kernel}-*.nbi"))


def compiled(function: F) -> F:
    """Mark a function as a kernel, which is run as machine code.

    `contract` lets the compiler fuse a multiply and an add (same bits on one machine);
    no other floating-point rule is relaxed, so NaN checks and signs stay as written.
    `_nrt=False` leaves out numba's reference counting of arrays, and `forceinline` the passing
    of records between functions; each took more time than the physics. The price is that
    kernels cannot allocate, which they must not anyway. Without allocation nothing needs the
    interpreter, so threads may run side by side (`nogil`).
    """
    return cast(F, Kernel(function))
