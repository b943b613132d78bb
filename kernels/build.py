"""Libraries of the faces, for every platform, from one text in LLVM's language.

llvmlite emits the objects and the linkers in the wheel `ziglang` make libraries of them, all on
one machine and the same to the byte each time.
"""

import hashlib
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding as llvm

from kernels.faces import Compiled
from kernels.header import header
from thermobearing.core.compiled.native import PREFIX


class Target(NamedTuple):
    """A platform, as LLVM and as zig call it."""

    name: str
    triple: str
    processor: str
    features: str
    linker: Sequence[str]
    suffix: str


_ZIG = (sys.executable, "-m", "ziglang")
_ELF = (
    *(*_ZIG, "ld.lld", "-shared", "--gc-sections", "-s"),
    *("--build-id=none", "-z", "noexecstack"),
)
_WASM = (
    *(*_ZIG, "wasm-ld", "--no-entry", "--import-memory", "--allow-undefined"),
    *("--gc-sections", "--strip-all", "-O3"),
)


MATERIAL = (*_ZIG, "cc", "-target", "x86_64-linux-gnu.2.17", "-s")


def _c_compiler(target: str) -> Sequence[str]:
    return (*_ZIG, "cc", "-target", target, "-shared", "-s", "-Wl,--gc-sections")


TARGETS = (
    Target("linux-x86_64-v1", "x86_64-unknown-linux-gnu", "x86-64", "", _ELF, "so"),
    Target("linux-x86_64-v3", "x86_64-unknown-linux-gnu", "x86-64-v3", "", _ELF, "so"),
    Target(
        "linux-x86_64-v4", "x86_64-unknown-linux-gnu", "x86-64-v4", "-prefer-256-bit", _ELF, "so"
    ),
    Target("linux-aarch64", "aarch64-unknown-linux-gnu", "generic", "", _ELF, "so"),
    Target(
        "macos-aarch64",
        "arm64-apple-macosx11.0.0",
        "apple-m1",
        "",
        _c_compiler("aarch64-macos"),
        "dylib",
    ),
    Target(
        "windows-x86_64",
        "x86_64-pc-windows-gnu",
        "x86-64",
        "",
        _c_compiler("x86_64-windows-gnu"),
        "dll",
    ),
    Target("wasm32", "wasm32-unknown-unknown", "generic", "", _WASM, "wasm"),
)


def combine(faces: Iterable[Compiled], sources: str) -> str:
    """Return one module of all faces, which exports these and the digest of the sources.

    What numba adds for Python is dropped.
    """
    whole = llvm.parse_assembly(
        f"""
@{PREFIX}sources = constant [{len(sources) + 1} x i8] c"{sources}\\00"
@_fltused = constant i32 0
"""
    )
    for face in faces:
        whole.link_in(llvm.parse_assembly(_exported(face)))
    return _without_unused(whole)


def _exported(face: Compiled) -> str:
    """Return the text of a face whose function takes the table only."""
    text = re.sub(r" = common (local_unnamed_addr )?global", r" = internal global", face.text)
    text = "\n".join(
        line for line in text.splitlines() if not line.startswith(("target ", "source_filename"))
    )
    module = llvm.parse_assembly(text)
    module.get_function(face.function).name = inner = f"{face.symbol}_with_status"
    for k, function in enumerate(one for one in module.functions if not one.is_declaration):
        function.linkage = "internal"
        if function.name != inner:  # numba's names count what was compiled before
            function.name = f"{face.symbol}_{k}"
    return f"""{module}
define void @{face.symbol}(ptr %table) {{
  %result = alloca ptr
  %problem = alloca ptr
  %status = call i32 @{inner}(ptr %result, ptr %problem, ptr %table)
  ret void
}}
"""


def _without_unused(module: Any) -> str:
    target = llvm.Target.from_triple("x86_64-unknown-linux-gnu").create_target_machine()
    builder = llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options(speed_level=2))
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.run(module, builder)
    return str(module)


def emit(text: str, target: Target) -> bytes:
    """Return the object of a module for a platform."""
    machine = llvm.Target.from_triple(target.triple).create_target_machine(
        cpu=target.processor,
        features=target.features,
        opt=3,
        reloc="pic",
        codemodel="default",
    )
    lines = [line for line in text.splitlines() if not line.startswith("target ")]
    head = f'target datalayout = "{machine.target_data}"\ntarget triple = "{target.triple}"\n'
    module = llvm.parse_assembly(head + "\n".join(lines))
    found: bytes = machine.emit_object(module)
    return found


def link(objects: bytes, target: Target, file: Path, symbols: Sequence[str]) -> None:
    """Write the library of an object."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernels.o").write_bytes(objects)
        exports = [f"--export={symbol}" for symbol in symbols] if target.suffix == "wasm" else []
        command = [*target.linker, *exports, "kernels.o", "-o", file.name]
        done = subprocess.run(
            command,
            cwd=folder,
            env={**os.environ, "ZIG_GLOBAL_CACHE_DIR": str(Path(tempfile.gettempdir()) / "zig")},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise RuntimeError(f"{target.name}: {done.stderr.strip()}")
        content = (folder / file.name).read_bytes()
        file.write_bytes(_without_time(content) if target.suffix == "dll" else content)


def _without_time(content: bytes) -> bytes:
    """Return a library for Windows whose header does not say when it was linked."""
    (header,) = struct.unpack_from("<I", content, 0x3C)
    assert content[header : header + 4] == b"PE\0\0"
    return content[: header + 8] + bytes(4) + content[header + 12 :]


def build(
    faces: Sequence[Compiled], described: dict[str, Any], folder: Path, targets: Sequence[Target]
) -> None:
    """Write the libraries for some platforms and the description of all of them."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    single = [face for face in faces if face.for_pages]
    texts = {
        wide: combine(faces if wide else single, described["sources"])
        for wide in {target.suffix != "wasm" for target in targets}
    }
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():  # of another build, perhaps of other sources
        old.unlink()
    libraries = {}
    symbols = [face.symbol for face in single] + [f"{PREFIX}sources"]
    for target in targets:
        file = folder / f"{target.name}.{target.suffix}"
        link(emit(texts[target.suffix != "wasm"], target), target, file, symbols)
        content = file.read_bytes()
        libraries[target.name] = {
            "file": file.name,
            "sha256": hashlib.sha256(content).hexdigest(),
        }
        print(f"{file.name:28} {len(content) / 1e3:7.0f} kB")
    text = header(described, version("thermobearing"))
    (folder / "thermobearing.h").write_text(text, encoding="utf-8")
    whole = json.dumps({**described, "libraries": libraries}, indent=1)
    (folder / "kernels.json").write_text(whole + "\n", encoding="utf-8")


def build_material(folder: Path, compiler: Sequence[str] = MATERIAL) -> None:
    """Write the material of OpenSees, which loads the library of a level itself."""
    source = Path(__file__).with_name("opensees.c")
    flags = ("-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC")
    names = (f"-I{folder}", str(source), "-ldl", "-Wl,-soname,ThermoBearing.so")
    subprocess.run([*compiler, *flags, *names, "-o", folder / "ThermoBearing.so"], check=True)
