"""Machine code of single kernels: made when one is first called, and kept for every process.

A checkout has no libraries. There the first call of a kernel compiles its face (`faces.py`) for the
processor of this machine, and keeps the object and its description in the folder of the user
(`sources.py`). Later processes load it without numba, which takes a second to import. Where several
processes need the same kernel at once, one compiles it and the others wait.
"""

import contextlib
import ctypes
import hashlib
import json
import os
import platform
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding as llvm

from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.native import Face, UnsuitableError
from thermobearing.core.compiled.sources import cache_directory, sources_digest

LEVEL = 3  # of LLVM's optimisation, the highest


class Processor(NamedTuple):
    """What machine code is made for, in the words of LLVM."""

    triple: str
    name: str
    features: str


@cache
def this_processor() -> Processor:
    """Return the processor of this machine, or that of NUMBA_CPU_NAME and NUMBA_CPU_FEATURES."""
    name = os.environ.get("NUMBA_CPU_NAME", "")
    features = os.environ.get("NUMBA_CPU_FEATURES", "")
    if not name:
        name, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    return Processor(llvm.get_process_triple(), name, features)


# How the code of a library finds its constants, and that of an object which is loaded into this
# process: there the two may lie far apart. The choices of numba (JITCPUCodegen).
IN_LIBRARY = {"reloc": "pic", "codemodel": "default"}
IN_PROCESS = {
    "reloc": "static" if platform.machine().lower() in ("x86_64", "amd64") else "default",
    "codemodel": "jitdefault",
    "jit": True,
}


def emit(text: str, processor: Processor, addresses: dict[str, Any]) -> bytes:
    """Return the object of a module in the language of LLVM, optimised for a processor.

    `addresses` is IN_LIBRARY or IN_PROCESS.
    """
    machine = llvm.Target.from_triple(processor.triple).create_target_machine(
        cpu=processor.name, features=processor.features, opt=LEVEL, **addresses
    )
    module = llvm.parse_assembly(
        f'target datalayout = "{machine.target_data}"\ntarget triple = "{processor.triple}"\n{text}'
    )
    options = llvm.create_pipeline_tuning_options(speed_level=LEVEL)
    # Loops are over ten layers, forty cells, or a few lines. Unrolled and in vectors they are no
    # faster, and twice as much code; lanes are vectors already.
    options.loop_vectorization = options.slp_vectorization = options.loop_unrolling = False
    passes = llvm.create_pass_builder(machine, options)
    passes.getModulePassManager().run(module, passes)
    content: bytes = machine.emit_object(module)
    return content


class Faces:
    """The faces of a kernel: those that are kept, and those that its calls need besides."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.faces = [_load(kernel, self.call, *code) for code in _read_kept(kernel)]

    def call(self, *arguments: Any) -> Any:
        """Call the kernel, with arguments of any kind."""
        return self.runner(arguments)(*arguments)

    def runner(self, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        """Return what runs the kernel with arguments like these."""
        # Kept faces first: numba takes a second to import.
        for face in self.faces:
            if face.prepare(*arguments):
                return face.call
        import numba

        try:
            code = compile_once(
                self.kernel, tuple(numba.typeof(argument) for argument in arguments)
            )
        except UnsuitableError:  # no table can hold them: numba compiles the kernel alone
            dispatcher: Callable[..., Any] = self.kernel.dispatcher
            return dispatcher
        self.faces.append(_load(self.kernel, self.call, *code))
        return self.faces[-1].call


@cache
def find_faces(kernel: Kernel) -> Faces:
    """Return the faces of a kernel."""
    return Faces(kernel)


def folder_of_objects() -> Path | None:
    """Return the folder of the objects for this processor; None if none can be kept."""
    folder = cache_directory()
    if folder is None:
        return None
    words = hashlib.sha256("\n".join(this_processor()).encode()).hexdigest()[:16]
    return folder / f"{this_processor().name}-{words}"


class Kept(NamedTuple):
    """A piece of machine code, and what is written about it."""

    contents: list[bytes]  # its object, then those that it needs
    description: dict[str, Any]


def _read_kept(kernel: Kernel) -> Iterator[Kept]:
    """Yield the objects and descriptions of a kernel that are kept and not damaged."""
    folder = folder_of_objects()
    for file in sorted(folder.glob(f"{kernel.name}-*.json")) if folder else ():
        code = _read_one(file)
        if code is not None:
            yield code


def _read_one(file: Path) -> Kept | None:
    """Return an object and its description; None if they are absent or damaged.

    The objects that it needs follow it.
    """
    try:
        description = json.loads(file.read_text(encoding="utf-8"))
        content = file.with_suffix(".o").read_bytes()
        complete = hashlib.sha256(content).hexdigest() == description["sha256"]
        shared = [_read_one(file.with_name(f"{name}.json")) for name in description["shared"]]
    except (OSError, ValueError, KeyError, TypeError):  # a power cut leaves anything
        return None
    contents = [content, *(code.contents[0] for code in shared if code is not None)]
    return Kept(contents, description) if complete and None not in shared else None


def compile_once(kernel: Kernel, kinds: tuple[Any, ...]) -> Kept:
    """Return the object of a kernel for arguments of some numba types, and its description.

    It is compiled where it is not kept yet and no other process is compiling it.
    """
    words = hashlib.sha256(str(kinds).encode()).hexdigest()[:16]
    return _made_once(f"{kernel.name}-{words}", lambda: _compile(kernel, kinds))


def _made_once(name: str, make: Callable[[], Kept]) -> Kept:
    """Return an object that is kept under a name, after it is made if it is not there."""
    folder = folder_of_objects()
    if folder is None:
        return make()
    file = folder / f"{name}.json"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    with _locked(file.with_suffix(".lock")):
        # Another process may have made it while this one waited for the lock.
        code = _read_one(file)
        if code is None:
            code = make()
            with contextlib.suppress(OSError):  # a full disk must not end the run
                _keep(file, *code)
    return code


@contextlib.contextmanager
def _locked(file: Path) -> Iterator[None]:
    """Let one process at a time compile a kernel; none waits where a file cannot be locked."""
    from filelock import FileLock

    lock = FileLock(file)
    try:
        lock.acquire()
    except (OSError, NotImplementedError):
        yield
        return
    try:
        yield
    finally:
        lock.release()


def _keep(file: Path, contents: list[bytes], description: dict[str, Any]) -> None:
    """Write an object, and then its description, each complete or not at all."""
    described = json.dumps(description).encode()
    # The description comes last: an object without one is not read.
    for path, data in ((file.with_suffix(".o"), contents[0]), (file, described)):
        part = path.with_name(f"{path.name}.{os.getpid()}")
        part.write_bytes(data)
        os.replace(part, path)


def _compile(kernel: Kernel, kinds: tuple[Any, ...]) -> Kept:
    """Compile the face of a kernel for arguments of some numba types."""
    from thermobearing.core.compiled.faces import Description, compile_face

    compiled = compile_face(kernel, kinds)
    description = Description()
    description.add(kernel, kinds, compiled)
    shared = [
        _made_once(part.symbol, lambda part=part: _emit(part.text, {}))  # type: ignore[misc]
        for part in compiled.shared
    ]
    face = _emit(compiled.text, description.all(sources_digest()))
    contents = [*face.contents, *(code.contents[0] for code in shared)]
    names = [part.symbol for part in compiled.shared]
    return Kept(contents, {**face.description, "shared": names})


def _emit(text: str, described: dict[str, Any]) -> Kept:
    _initialize()
    content = emit(text, this_processor(), IN_PROCESS)
    digest = hashlib.sha256(content).hexdigest()
    return Kept([content], {**described, "sha256": digest, "shared": []})


@cache
def _initialize() -> None:
    """Initialise LLVM for this machine."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


def _load(
    kernel: Kernel, fallback: Callable[..., Any], contents: list[bytes], description: dict[str, Any]
) -> Face:
    """Return the face of some objects; `fallback` runs the kernel with arguments that do not fit.

    Objects of one kernel export the same name, so each has a separate engine.
    """
    _initialize()
    machine = llvm.Target.from_triple(this_processor().triple).create_target_machine(**IN_PROCESS)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    for content in contents:
        engine.add_object_file(llvm.ObjectFileRef.from_data(content))
    engine.finalize_object()
    address = engine.get_function_address(description["entries"][kernel.name]["symbol"])
    function: Any = ctypes.CFUNCTYPE(None)(address)
    function.engine = engine  # it owns the machine code
    return Face(function, description, kernel, fallback)
