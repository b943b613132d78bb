"""Kernels as numba compiles them: as parts of what calls them, and alone.

A kernel calls other kernels, and a step has a hundred of them. By itself numba would optimise each
of these functions together with all that it calls, and make machine code of it, before it goes into
the functions that call it: the same code a dozen times. Here numba only writes the functions (a
`Part`); they are linked, optimised and translated once, with the function that Python calls
(`faces.py`).

Nothing imports this before numba is needed. Importing it teaches numba the kernels and the lanes.
"""

import contextlib
import hashlib
import re
import shutil
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from numba import types
from numba.core import caching as _caching
from numba.core import cgutils, typed_passes, untyped_passes
from numba.core import codegen as _codegen
from numba.core.compiler import CompilerBase
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager
from numba.core.imputils import lower_constant
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.sigutils import normalize_signature
from numba.extending import models, register_model, typeof_impl

from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.native import PREFIX
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
        self.use = "inline"  # as of its kernel
        self.symbol = ""  # of a function with a separate object
        self.function = ""  # its name in the texts
        self._linked_module: Any = None

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
        if self._linked_module is None:
            module = _linked(_called(self, lambda _: False))
            # Several functions that numba compiles alone may contain this part: one of them is
            # kept.
            for function in module.functions:
                if not function.is_declaration:
                    function.linkage = "linkonce_odr"
            self._linked_module = module
        return self._linked_module

    @cached_property
    def text(self) -> str:
        """The module of a part with a separate object, in the language of LLVM."""
        return text_of(link(self)[0], self.symbol, is_called=True)


def link(part: Part) -> tuple[Any, list[Part]]:
    """Return a module of LLVM with a part and all that it calls, each once.

    The parts with separate objects are returned too, with those that they call; the module only
    declares them.
    """
    shared: dict[Part, None] = {}

    def is_outside(library: Any) -> bool:
        if library is part or not getattr(library, "symbol", ""):
            return False
        shared[library] = None
        return True

    module = _linked(_called(part, is_outside))
    for outside in shared:
        with contextlib.suppress(NameError):  # a rare part need not be called
            module.get_function(outside.function).name = outside.symbol
    if part.symbol:
        module.get_function(part.function).name = part.symbol
    # Shared parts have separate objects, and so have the shared parts that they call.
    below = [inner for outside in shared for inner in link(outside)[1]]
    return module, list(dict.fromkeys([*shared, *below]))


def text_of(module: Any, symbol: str, *, is_called: bool) -> str:
    """Return the text of a module with a function of some name, which may be called from outside.

    The names that numba gives count what was compiled before, so functions get other names: the
    same kernel has the same text in every process.
    """
    missing = [
        function.name
        for function in module.functions
        if function.is_declaration and function.name.startswith("_Z")
    ]
    if missing:
        raise RuntimeError(f"{symbol} calls what is not compiled: {', '.join(missing)}")
    defined = [function for function in module.functions if not function.is_declaration]
    for number, function in enumerate(defined):
        function.linkage = "internal"
        if function.name != symbol:
            function.name = f"{symbol}_{number}"
        elif is_called:
            function.linkage, function.visibility = "external", "hidden"
    for number, variable in enumerate(module.global_variables):
        if not variable.is_declaration:
            variable.name = f"{symbol}_variable_{number}"
    text = re.sub(r" = common (local_unnamed_addr )?global", " = internal global", str(module))
    lines = [line for line in text.splitlines() if not line.startswith(("target ", "source_file"))]
    return "\n".join(lines) + "\n"


def _linked(libraries: Iterator[Any]) -> Any:
    module = llvm.parse_assembly("")
    for library in libraries:
        if isinstance(library, Part):
            for text in library.texts:
                attributes = KEPT_APART.get(library.use, "")
                module.link_in(llvm.parse_assembly(_with_attributes(text, attributes)))
        else:
            module.link_in(library._get_module_for_linking(), preserve=True)
    return module


# Attributes of functions that are called, and not written into what calls them.
KEPT_APART = {"once": "noinline", "rare": "noinline cold"}
DEFINITION = re.compile(r"^(define .*\)[^()\n{]*?)\s*\{$", re.MULTILINE)


def _with_attributes(text: str, attributes: str) -> str:
    """Return a module in the language of LLVM whose functions have attributes.

    `add_function_attribute` of llvmlite 0.45 gives them to the value that a function returns.
    """
    return DEFINITION.sub(rf"\1 {attributes} {{", text) if attributes else text


def _called(library: Any, is_outside: Callable[[Any], bool]) -> Iterator[Any]:
    """Yield a library and all that it calls, each after one that calls it.

    LLVM leaves out functions of numba's own libraries that nothing has called yet. Those that are
    outside, and what only they call, are left out.
    """
    waiting = [library]
    entered = set()
    while waiting:
        library = waiting.pop()
        if library not in entered and not is_outside(library):
            entered.add(library)
            yield library
            if isinstance(library, Part):
                waiting += reversed(library._linking_libraries)


PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)


class PartCompiler(CompilerBase):
    """numba's compiler with the passes that kernels need.

    They have no closures, no expressions of arrays, and no arguments that are None: the passes for
    these take a quarter of the time, since most look at the whole function again.
    """

    def define_pipelines(self) -> list[PassManager]:
        """Return the passes, as the base class asks."""
        manager = PassManager("part")
        for compiler_pass in PASSES:
            manager.add_pass(compiler_pass, compiler_pass.__name__)
        manager.finalize()
        return [manager]


class _Remembered:
    """What numba asks again for every operation, remembered while it writes parts.

    To find the type of `a + b`, numba tries all it knows of sums: of dates, texts, arrays. To find
    the size of a double, it has LLVM read a module. Both took a third of the time.
    """

    def __init__(self) -> None:
        self._typing, self._target = cpu_target.typing_context, cpu_target.target_context
        self._resolve = self._typing.resolve_function_type
        self._measure = self._target.get_abi_sizeof
        self._signatures: dict[Any, Any] = {}
        self._sizes: dict[Any, int] = {}
        self._depth = 0

    def __enter__(self) -> None:
        self._depth += 1
        if self._depth == 1:
            self._usual = self._target.codegen()._library_class
            self._target.codegen()._library_class = Part
            self._typing.resolve_function_type = self._signature
            self._target.get_abi_sizeof = self._size

    def __exit__(self, *_: object) -> None:
        self._depth -= 1
        if not self._depth:
            self._target.codegen()._library_class = self._usual
            del self._typing.resolve_function_type
            del self._target.get_abi_sizeof

    def _signature(self, function: Any, arguments: Any, named: Any) -> Any:
        # Only what numba provides: kernels are compiled by being resolved.
        if named or not isinstance(function, types.Function):
            return self._resolve(function, arguments, named)
        key = function, tuple(arguments)
        if key not in self._signatures:
            self._signatures[key] = self._resolve(function, arguments, named)
        return self._signatures[key]

    def _size(self, kind: Any) -> int:
        if kind not in self._sizes:
            self._sizes[kind] = self._measure(kind)
        return self._sizes[kind]


class _PartDispatcher(CPUDispatcher):
    """A kernel as a part of the functions that call it."""

    kernel: Kernel | None = None

    def compile(self, signature: Any) -> Any:
        """Write the function for arguments of some types; numba's own also measures the time."""
        kinds = tuple(normalize_signature(signature)[0])
        with global_compiler_lock, _remembered:
            if kinds not in self.overloads:
                self.add_overload(self._compiler.compile(kinds, None))
                self._describe(self.overloads[kinds], kinds)
        return self.overloads[kinds].entry_point

    def _describe(self, overload: Any, kinds: tuple[Any, ...]) -> None:
        """Set how the part goes into what calls it."""
        part = overload.library
        part.function = overload.fndesc.llvm_func_name
        if self.kernel is not None:
            part.use = self.kernel.use
            if part.use == "shared":
                # The same kernel for other types is other machine code, and needs another name.
                words = hashlib.sha256(str(kinds).encode()).hexdigest()[:8]
                name = self.kernel.name.replace(".", "_")
                part.symbol = f"{PREFIX}{name}_{words}"


def new_part(kernel: Kernel) -> Any:
    """Return a kernel as a part of what calls it."""
    dispatcher = part_of(kernel.py_func, inline=kernel.use == "inline")
    dispatcher.kernel = kernel
    return dispatcher


def part_of(function: Callable[..., Any], *, inline: bool = True) -> Any:
    """Return a function as a part of what calls it."""
    wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    options = {**OPTIONS, **wrappers, "nopython": True, "boundscheck": None}
    return _PartDispatcher(
        py_func=function,
        locals={},
        targetoptions={**options, "forceinline": inline},
        pipeline_class=PartCompiler,
    )


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
        super().__init__(f"Choice({', '.join(str(version) for version in choice.versions)})")

    def _version(self, arguments: Any) -> Any:
        kind: Any = arguments[self.choice.at]
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
_remembered = _Remembered()
