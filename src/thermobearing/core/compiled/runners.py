"""What runs a kernel, decided when it is first called.

That is the library that was built ahead of time (`native.py`), machine code that numba makes where
there is none (`objects.py`), or plain Python under NUMBA_DISABLE_JIT=1. numba is not imported
before a kernel is compiled.
"""

import os
from collections.abc import Callable
from typing import Any, cast

from thermobearing.core.compiled import native
from thermobearing.core.compiled.kernel import Kernel, Runners, has_numba
from thermobearing.core.compiled.sources import cache_directory

NO_NUMBA = (
    "numba, which could compile the kernels instead, is not installed: "
    'pip install "thermobearing[jit]"'
)


class MissingKernelsError(RuntimeError):
    """The kernels can be run neither by a library nor by numba."""


def choose(kernel: Kernel, arguments: tuple[Any, ...]) -> Callable[..., Any]:
    """Return what runs a kernel from its first call on, with arguments like these."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return kernel.py_func
    face, reason = native.find_face(kernel)
    if face is not None:
        return face
    if has_numba():
        if "<locals>" in kernel.py_func.__qualname__:  # several functions may share its name
            return cast("Callable[..., Any]", kernel.dispatcher)
        from thermobearing.core.compiled.objects import find_faces

        return find_faces(kernel).runner(arguments)
    if reason:
        raise MissingKernelsError(f"{reason} {NO_NUMBA}")
    return kernel.py_func


def is_compiled(kernel: str) -> bool:
    """Return whether a kernel, as "core.march.march", needs no compiling before its first run."""
    if native.open_library()[0] is not None:
        return True
    folder = cache_directory()
    return folder is not None and any(folder.glob(f"*/{kernel}-*.json"))


def _run_by_numba(kernel: Kernel, *arguments: Any) -> Any:
    from thermobearing.core.compiled.objects import find_faces

    return find_faces(kernel).call(*arguments)


def _part(kernel: Kernel) -> Any:
    from thermobearing.core.compiled.jit import new_part

    return new_part(kernel)


def _dispatcher(kernel: Kernel) -> Any:
    from thermobearing.core.compiled.jit import new_dispatcher

    return new_dispatcher(kernel.py_func)


RUNNERS = Runners(choose, _run_by_numba, _part, _dispatcher)
