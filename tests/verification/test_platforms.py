"""The kernels of `make kernels` for other platforms, compared with those of this machine.

A call is laid out as an image of memory, which node (WebAssembly) or an emulated program (AArch64)
carries out; wine runs the example in C for Windows.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.fixtures.images import Image, captured, write_image
from tests.fixtures.kernels import c_compiler
from tests.skip_reasons import NO_NODE
from thermobearing.core.compiled import native

FIXTURES = Path(__file__).parents[1] / "fixtures"
EXAMPLE = Path(__file__).parents[2] / "kernels" / "example.c"
SYSROOT = Path("/usr/aarch64-linux-gnu")  # of Debian's package libc6-arm64-cross
SCRATCH = ("work.", ".unknowns")  # arrays
ROUNDING = ("layer_force_mismatch",)  # fields that are nothing but rounding
RUNS: dict[str, Callable[[], object]] = {
    "march": lambda: tb.run(
        "shen-lhdr-specimen", tb.cyclic_test(strain=[0.5, 1.75], cycles=2, dt=0.05), ambient=-20.0
    ),
    "newmark_march": lambda: tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", -20.0, duration=4.0),
    "predictor_march": lambda: tb.hybrid(
        "shen-lhdr-specimen", ambient=-20.0, duration=1.0, laboratory={"mode": "pd"}
    ),
    "respond": lambda: tb.response_spectrum(tb.load_motion("jra-ii-i-1"), [0.3, 1.0]),
}
EVERY = [
    "march",
    *(pytest.param(name, marks=pytest.mark.thorough) for name in RUNS if name != "march"),
]
Call = tuple[Image, dict[str, np.ndarray]]


def library(name: str) -> Path:
    if native.open_library()[0] is None:
        pytest.skip("the kernels of these sources are not built: make kernels")
    known = json.loads((native.FOLDER / native.DESCRIPTION).read_text())["libraries"]
    if name not in known:
        pytest.skip(f"the kernels for {name} are not built")
    return native.FOLDER / str(known[name]["file"])


def program(name: str) -> str:
    """Return the path of a program; playwright, which looks at pages, brings node along."""
    playwright = find_spec("playwright")
    driver = Path(str(playwright.origin)).parent / "driver" if playwright else Path("/none")
    found = shutil.which(name) or shutil.which(name, path=str(driver))
    if found is None:
        pytest.skip(NO_NODE if name == "node" else f"{name} is not installed")
    return found


@cache
def native_call(kernel: str) -> Call:
    """A call of a kernel from a whole analysis, with the arrays that it leaves behind."""
    symbol = f"{native.PREFIX}{kernel}"
    with captured({symbol}) as found:
        RUNS[kernel]()
    return found[symbol]


@np.errstate(all="ignore")  # arrays that nothing writes may hold anything
def check(image: Image, expected: dict[str, np.ndarray], file: Path) -> None:
    after = image.contents(Path(f"{file}.after").read_bytes())
    assert after.keys() == expected.keys()
    np.testing.assert_array_equal(after["results"][:2], expected["results"][:2])
    changed = 0
    for name, theirs in expected.items():
        if any(word in name for word in SCRATCH):
            continue
        for field in set(theirs.dtype.names or [None]) - {*ROUNDING}:
            mine, right = (
                np.asarray(one if field is None else one[field], dtype=float)
                for one in (after[name], theirs)
            )
            scale = np.max(np.abs(right), initial=0.0, where=np.isfinite(right))
            apart = np.max(np.abs(mine - right), initial=0.0, where=np.isfinite(right))
            assert apart <= tol.WITHOUT_FUSING * scale, (name, field)
            changed += bool(scale)
    assert changed > 3


@pytest.mark.parametrize("kernel", EVERY)
def test_webassembly_in_node(kernel: str, tmp_path: Path) -> None:
    node, wasm = program("node"), library("wasm32")
    image, expected = native_call(kernel)
    file = write_image(image, tmp_path)
    subprocess.run([node, FIXTURES / "run_image.cjs", wasm, file], check=True)
    check(image, expected, file)


@pytest.fixture(scope="module")
def emulated(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The program of an AArch64 machine that carries out images, with its emulator."""
    emulator = program("qemu-aarch64")
    if not SYSROOT.is_dir():
        pytest.skip("there is no C library for AArch64: libc6-arm64-cross")
    pytest.importorskip("ziglang")
    made = tmp_path_factory.mktemp("aarch64") / "run_image"
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", "aarch64-linux-gnu.2.28"]
    subprocess.run([*compiler, str(FIXTURES / "run_image.c"), "-o", str(made)], check=True)
    return [emulator, "-L", str(SYSROOT), str(made)]


@pytest.mark.thorough
@pytest.mark.parametrize("kernel", RUNS)
def test_aarch64_emulated(kernel: str, emulated: list[str], tmp_path: Path) -> None:
    image, expected = native_call(kernel)
    file = write_image(image, tmp_path)
    said = json.loads(file.with_suffix(".json").read_text())
    words = [said["symbol"], str(said["base"]), str(said["table"])]
    subprocess.run([*emulated, str(library("linux-aarch64")), str(file), *words], check=True)
    check(image, expected, file)


def printed_rows(compiler: list[str], library: Path, folder: Path, *runner: str) -> np.ndarray:
    """Displacement, force and temperature that the example in C prints with a library."""
    shutil.copy(library, folder)
    example = folder / "example.exe"
    names = [EXAMPLE, library.name, f"-Wl,-rpath,{folder}", "-lm", "-o", example]
    flags = ["-O1", "-Wall", "-Werror", f"-I{native.FOLDER}"]
    cache = str(Path(tempfile.gettempdir()) / "zig")  # as `make kernels` has it
    environment = {
        **os.environ,
        "ZIG_GLOBAL_CACHE_DIR": cache,
        "WINEPREFIX": str(folder / "wine"),
        "WINEDEBUG": "-all",
    }
    for command in ([*compiler, *flags, *names], [*runner, example]):
        done = subprocess.run(
            command, cwd=folder, env=environment, stdout=subprocess.PIPE, check=True
        )
    return np.array([line.split() for line in done.stdout.decode().splitlines()], dtype=float)


@pytest.mark.thorough
def test_windows_under_wine(tmp_path: Path) -> None:
    wine, dll = program("wine"), library("windows-x86_64")
    pytest.importorskip("ziglang")
    folders = [tmp_path / "windows", tmp_path / "here"]
    for folder in folders:
        folder.mkdir()
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu"]
    rows = printed_rows(compiler, dll, folders[0], wine)
    expected = printed_rows(c_compiler(), library(native.library_name()), folders[1])
    assert rows.shape == expected.shape == (400, 3)
    scale = np.abs(expected).max(axis=0)
    assert scale[1] > 80.0
    assert np.all(np.abs(rows - expected) <= tol.WINDOWS * scale)
