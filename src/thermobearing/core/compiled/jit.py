"""Kernels compiled by numba at their first run, and the cache of their machine code.

Nothing imports this before numba is needed. Importing it teaches numba the kernels and the lanes.
"""

import contextlib
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba import types
from numba.core import caching as _caching
from numba.core.imputils import lower_constant
from numba.extending import models, register_model, typeof_impl

from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.sources import OPTIONS, cache_directory, kernels_digest
from thermobearing.core.vector import Choice

caching: Any = _caching  # numba has no types here


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
        """Keep the machine code; a full disk or a damaged index must not end the run."""
        with contextlib.suppress(Exception):
            super().save_overload(signature, data)


def new_dispatcher(function: Callable[..., Any]) -> Any:
    """Return a function as numba compiles it, or as it is where numba is disabled."""
    njit: Any = numba.njit
    dispatcher: Any = njit(**OPTIONS)(function)
    if cache_directory() is not None and hasattr(dispatcher, "_cache"):
        dispatcher._cache = _Cache(function)
    return dispatcher


@typeof_impl.register(Kernel)
def _typeof_kernel(kernel: Kernel, _: Any) -> Any:
    return types.Dispatcher(kernel.dispatcher)


class ChoiceType(types.Callable, types.Opaque):
    """Versions of a kernel; the type of one argument decides which one a call compiles."""

    def __init__(self, choice: Choice) -> None:
        self.choice = choice
        super().__init__(f"Choice({', '.join(str(one) for one in choice.versions)})")

    def _version(self, given: Any) -> Any:
        kind: Any = given[self.choice.at]
        rank = 0
        while isinstance(kind, types.BaseTuple):
            columns: Any = kind
            kind, rank = columns.types[0], rank + 1
        return types.Dispatcher(self.choice.versions[rank].dispatcher)

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a call."""
        return self._version(args).get_call_type(context, args, kws)

    def get_call_signatures(self) -> Any:
        """Return the signatures that are known: none."""
        return (), True

    def get_impl_key(self, sig: Any) -> Any:
        """Return what identifies the machine code of a call."""
        return self._version(sig.args).get_impl_key(sig)


register_model(ChoiceType)(models.OpaqueModel)


@typeof_impl.register(Choice)
def _typeof_choice(choice: Choice, _: Any) -> Any:
    return ChoiceType(choice)


@lower_constant(ChoiceType)
def _lower_choice(context: Any, *_: Any) -> Any:
    return context.get_dummy_value()


from thermobearing.core.lanes import arithmetic, choices, functions, views  # noqa: E402

TAUGHT = (arithmetic, choices, functions, views)
