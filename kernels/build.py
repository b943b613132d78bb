"""Libraries of the faces, for every platform, from their texts in the language of LLVM.

llvmlite emits the objects and the linkers in the wheel `ziglang` make libraries of them, all on
one machine and the same to the byte each time.
"""

import hashlib
import json
import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding as llvm

from kernels.header import header
from thermobearing.core.compiled.faces import Compiled
from thermobearing.core.compiled.native import PREFIX
from thermobearing.core.compiled.objects import IN_LIBRARY, Processor, emit


class Target(NamedTuple):
    """A platform, as LLVM and as zig call it."""

    name: str
    triple: str
    processor: str
    features: str
    linker: Sequence[str]
    suffix: str


class Emitted(NamedTuple):
    """An object for a platform."""

    target: Target
    content: bytes


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


def emit_all(faces: Sequence[Compiled], sources: str, targets: Sequence[Target]) -> list[Emitted]:
    """Return the objects of some faces for each target, made on all cores."""

    def texts(target: Target) -> list[str]:
        """Return the texts of a platform, those of shared functions once."""
        wanted = [face for face in faces if face.for_pages or target.suffix != "wasm"]
        shared = {part.symbol: part.text for face in wanted for part in face.shared}
        return [*(face.text for face in wanted), *shared.values()]

    version_of_sources = f"""
@{PREFIX}sources = constant [{len(sources) + 1} x i8] c"{sources}\\00"
@_fltused = constant i32 0
"""
    work = [(target, text) for target in targets for text in (version_of_sources, *texts(target))]
    work.sort(key=lambda item: -len(item[1]))  # the longest first, so that all cores end together
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        objects = pool.map(_emit, *zip(*work, strict=True))
        return [
            Emitted(target, content) for (target, _), content in zip(work, objects, strict=True)
        ]


def _emit(target: Target, text: str) -> bytes:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    processor = Processor(target.triple, target.processor, target.features)
    return emit(text, processor, IN_LIBRARY)


def link(objects: Sequence[bytes], target: Target, file: Path, symbols: Sequence[str]) -> None:
    """Write the library of some objects."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        names = [f"kernels{number}.o" for number in range(len(objects))]
        for object_name, content in zip(names, objects, strict=True):
            (folder / object_name).write_bytes(content)
        exports = [f"--export={symbol}" for symbol in symbols] if target.suffix == "wasm" else []
        command = [*target.linker, *exports, *names, "-o", file.name]
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
    emitted = emit_all(faces, described["sources"], targets)
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():  # of another build, perhaps of other sources
        old.unlink()
    libraries = {}
    symbols = [face.symbol for face in faces if face.for_pages] + [f"{PREFIX}sources"]
    for target in targets:
        file = folder / f"{target.name}.{target.suffix}"
        objects = sorted(item.content for item in emitted if item.target == target)
        link(objects, target, file, symbols)
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
    names = (f"-I{folder}", str(source), "-ldl", "-lm", "-Wl,-soname,ThermoBearing.so")
    subprocess.run([*compiler, *flags, *names, "-o", folder / "ThermoBearing.so"], check=True)
