"""Kernels as numba compiles them: as parts of what calls them, and alone.

A kernel calls other kernels, and a step has a hundred of them. By itself numba would optimise each
of these functions together with all that it calls, and make machine code of it, before it goes into
the functions that call it: the same code a dozen times. Here numba only writes the functions (a
`Part`); they are linked, optimised and translated once, with the function that Python calls
(`faces.py`).

Nothing imports this before numba is needed. Importing it teaches numba the kernels and the lanes.
"""

import contextlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from numba import types
from numba.core import caching as _caching
from numba.core import cgutils
from numba.core import codegen as _codegen
from numba.core.compiler_lock import global_compiler_lock
from numba.core.imputils import lower_constant
from numba.core.registry import CPUDispatcher, cpu_target
from numba.extending import models, register_model, typeof_impl

from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.sources import OPTIONS, cache_directory, kernels_digest
from thermobearing.core.vector import Choice

caching: Any = _caching  # numba has no types here
codegen: Any = _codegen


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


class _NoEnvironment:
    """In place of numba's engine for parts, which have no machine code and run no Python code."""

    def set_env(self, *_: Any) -> None:
        """Do nothing: an environment is for code that calls the interpreter."""


class Part(codegen.JITCodeLibrary):
    """A function as numba has written it, which is not optimised and has no machine code."""

    def __init__(self, *settings: Any) -> None:
        super().__init__(*settings)
        self.texts: list[str] = []
        self.is_rare = False  # whether it stays a function of its own
        self._shared_module: Any = None

    @property
    def codegen(self) -> Any:
        """Return what takes the environment of the function."""
        return _NoEnvironment()

    def add_ir_module(self, ir_module: Any) -> None:
        """Keep what numba has written."""
        self.texts.append(cgutils.normalize_ir_text(str(ir_module)))

    def add_linking_library(self, library: Any) -> None:
        """Keep a library that this one calls."""
        self._linking_libraries.append(library)

    def finalize(self) -> None:
        """Do nothing: there is no machine code to be made of a part."""
        self._finalized = True

    def get_pointer_to_function(self, _: str) -> int:
        """Return no address: Python does not call a part."""
        return 0

    def _get_module_for_linking(self) -> Any:
        """Return the part with all that it calls, for a function that numba compiles alone."""
        if self._shared_module is None:
            module = linked(self)
            for function in module.functions:
                if not function.is_declaration:
                    function.linkage = "linkonce_odr"
            self._shared_module = module
        return self._shared_module


def linked(part: Part) -> Any:
    """Return a module of LLVM with a part and all that it calls, each once."""
    module = llvm.parse_assembly("")
    for library in dict.fromkeys(_called(part)):
        if isinstance(library, Part):
            for text in library.texts:
                part_module = llvm.parse_assembly(text)
                if library.is_rare:
                    _keep_apart(part_module)
                module.link_in(part_module)
        else:
            module.link_in(library._get_module_for_linking(), preserve=True)
    return module


def _keep_apart(module: Any) -> None:
    """Let the functions of a module be called, and not be written into what calls them."""
    for function in module.functions:
        if not function.is_declaration:
            function.add_function_attribute("noinline")
            function.add_function_attribute("cold")


def _called(library: Any) -> Iterator[Any]:
    """Yield all libraries that one calls, those that are called by others first, and itself."""
    waiting = [(library, False)]
    entered = set()
    while waiting:
        library, is_complete = waiting.pop()
        if is_complete:
            yield library
        elif library not in entered:
            entered.add(library)
            waiting.append((library, True))
            if isinstance(library, Part):
                waiting += [(called, False) for called in reversed(library._linking_libraries)]


class _PartDispatcher(CPUDispatcher):
    """A kernel as a part of the functions that call it."""

    is_rare = False

    def compile(self, signature: Any) -> Any:
        """Write the function for arguments of some types."""
        with global_compiler_lock:
            target = cpu_target.target_context.codegen()
            usual = target._library_class
            target._library_class = Part
            try:
                address = super().compile(signature)
            finally:
                target._library_class = usual
            for overload in self.overloads.values():
                overload.library.is_rare = self.is_rare
            return address


def new_part(function: Callable[..., Any], *, is_rare: bool = False) -> Any:
    """Return a kernel as a part of what calls it; a rare one stays a function of its own."""
    wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    options = {**OPTIONS, **wrappers, "nopython": True, "boundscheck": None}
    dispatcher = _PartDispatcher(
        py_func=function, locals={}, targetoptions={**options, "forceinline": not is_rare}
    )
    dispatcher.is_rare = is_rare
    return dispatcher


def new_dispatcher(function: Callable[..., Any]) -> Any:
    """Return a function as numba compiles it alone, or as it is where numba is disabled."""
    njit: Any = numba.njit
    dispatcher: Any = njit(**OPTIONS)(function)
    if cache_directory() is not None and hasattr(dispatcher, "_cache"):
        dispatcher._cache = _Cache(function)
    return dispatcher


@typeof_impl.register(Kernel)
def _typeof_kernel(kernel: Kernel, _: Any) -> Any:
    return types.Dispatcher(kernel.part)


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
        return types.Dispatcher(self.choice.versions[rank].part)

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
