"""What compiled code is made of: its cache key, and its records."""

import ast
import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import thermobearing
from thermobearing.core import types
from thermobearing.core.compiled.sources import cache_directory, kernel_files
from thermobearing.core.records import filled, labels, row_type, rows
from thermobearing.core.types import BearingResponse, LayerCells, RubberResponse
from thermobearing.structure import types as structure_types

PACKAGE = Path(thermobearing.__file__).parent
DECORATORS = {"compiled", "compiled_apart"}


def is_kernel(node: ast.AST) -> bool:
    return isinstance(node, ast.FunctionDef) and any(
        isinstance(decorator, ast.Name) and decorator.id in DECORATORS
        for decorator in node.decorator_list
    )


def taken_from(tree: ast.Module) -> dict[str, Path]:
    result = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("thermobearing."):
            path = PACKAGE.parent / f"{str(node.module).replace('.', '/')}.py"
            result |= {alias.asname or alias.name: path for alias in node.names}
    return result


def test_cache_key_covers_all_that_kernels_use() -> None:
    covered = set(kernel_files())
    assert all(path.is_file() for path in covered)
    kernels = 0
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text if "@compiled" in text else "")
        imported = taken_from(tree)
        for node in filter(is_kernel, ast.walk(tree)):
            kernels += 1
            assert path in covered, f"{path.name} has a kernel, but is not in KERNELS"
            names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
            for name in names & set(imported) - DECORATORS:
                assert imported[name] in covered, f"{path.name} takes {name} from {imported[name]}"
    assert kernels > 40


def test_cache_key_leaves_out_what_has_no_kernels() -> None:
    names = {path.relative_to(PACKAGE).parts[-2:] for path in kernel_files()}
    assert ("core", "step.py") in names
    assert ("structure", "newmark.py") in names
    for other in ("kernel.py", "native.py", "run.py", "model.py", "matrices.py", "readers.py"):
        assert not [parts for parts in names if parts[-1] == other]


def record_classes() -> list[type]:
    result = [
        value
        for module in (types, structure_types)
        for value in vars(module).values()
        if isinstance(value, type) and value.__module__ == module.__name__
    ]
    return [value for value in result if not issubclass(value, tuple)]


@pytest.mark.parametrize("record", record_classes(), ids=lambda record: record.__name__)
def test_a_name_of_a_record_is_not_hidden_by_numpy(record: type) -> None:
    names = row_type(record).names
    assert names
    assert [name for name in names if hasattr(np.void, name)] == []
    assert row_type(record).itemsize == 8 * len(names)


def test_response_of_rubber_comes_first() -> None:
    """A bearing without lead and rate dependence is asked for the first of the same quantities."""
    first = labels(RubberResponse)
    assert labels(BearingResponse)[: len(first)] == first
    assert [label.name for label in labels(BearingResponse)] == list(
        row_type(BearingResponse).names or ()
    )


def test_a_record_needs_all_its_columns() -> None:
    places = filled(LayerCells, first=[3, 5], last=[5, 7], upper_middle=0, lower_middle=1)
    assert len(places) == 2
    assert (places[1].first, places[1].lower_middle) == (5, 1)
    with pytest.raises(AssertionError, match="LayerCells"):
        filled(LayerCells, first=[3, 5])


def test_rows_are_views_and_copies_are_not() -> None:
    response = rows(BearingResponse, 3)
    response[1].force = 2.0
    part = response[1:]
    part[0].force = 3.0
    assert_array_equal(response["force"], [0.0, 3.0, 0.0])
    part.copy()[0].force = 4.0
    assert response[1].force == 3.0


def found_with(monkeypatch: pytest.MonkeyPatch, **variables: str | None) -> Path | None:
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        if value is not None:
            monkeypatch.setenv(name, value)
    return cache_directory.__wrapped__()


def test_machine_code_goes_to_the_folder_of_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path / "given"))
    usual = found_with(monkeypatch, XDG_CACHE_HOME=str(tmp_path / "cache"))
    assert given is not None
    assert given.parent == tmp_path / "given"
    assert usual is not None
    assert usual.parent == tmp_path / "cache" / "thermobearing"
    assert list(usual.iterdir()) == []  # the trial leaves nothing


def test_no_home_means_no_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.path.expanduser", lambda path: path)
    assert found_with(monkeypatch) is None
    assert found_with(monkeypatch, XDG_CACHE_HOME="not/absolute") is None


def test_read_only_or_full_folder_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert found_with(monkeypatch, NUMBA_CACHE_DIR="/proc/none") is None
    (tmp_path / "file").write_text("")
    assert found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path / "file")) is None

    def full(*_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "posix_fallocate", full)
    assert found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path / "cache")) is None


def test_folder_that_others_could_write_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its machine code is thrown away, whoever wrote it: numba runs whatever it finds."""
    folder = found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path))
    assert folder is not None
    assert folder.stat().st_mode & 0o077 == 0
    (folder / "kernel.nbi").write_text("code of another user")
    folder.chmod(0o775)  # an umask of 002
    assert found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path)) == folder
    assert folder.stat().st_mode & 0o077 == 0
    assert list(folder.iterdir()) == []


def test_folder_of_another_user_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path))
    assert folder is not None
    user = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: user + 1)
    with pytest.warns(UserWarning, match="NUMBA_CACHE_DIR"):
        assert found_with(monkeypatch, NUMBA_CACHE_DIR=str(tmp_path)) is None


RUNS = """
import sys
from thermobearing.core.hysteresis import exact_increment
print(exact_increment(0.5, 2.0, 6.0, 1.0 / 6.0, 0.1)[0], "numba" in sys.modules)
"""


@pytest.mark.thorough
@pytest.mark.parametrize(
    "damage",
    [
        pytest.param([], id="none"),
        pytest.param(
            [(ending, length) for ending in ("json", "o") for length in (0, 40)],
            id="damaged",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_clone_at_another_path_uses_the_same_machine_code(
    tmp_path: Path, damage: list[tuple[str, int]]
) -> None:
    """The digest of the sources decides, not their path or time; damaged files compile again."""
    kept = tmp_path / "kept"
    package = Path(thermobearing.__file__).parent
    clone = shutil.copytree(package, tmp_path / "clone" / "thermobearing")
    for file in clone.rglob("*.py"):
        os.utime(file, (1.0, 1.0))  # copies keep the time of their originals

    def answer(**variables: str) -> list[str]:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(kept), **variables}
        command = [sys.executable, "-c", RUNS]
        done = subprocess.run(
            command, env=environment, stdout=subprocess.PIPE, text=True, check=True
        )
        return done.stdout.split()

    value, compiles = answer()
    assert compiles == "True"
    assert answer(PYTHONPATH=str(clone.parent)) == [value, "False"]
    # A power cut leaves empty files, a full disk short ones.
    for ending, length in damage:
        for file in kept.rglob(f"*.{ending}"):
            os.truncate(file, length)
        assert answer() == [value, "True"]
        assert answer() == [value, "False"]


COMPILES = """
import sys
from thermobearing.core.hysteresis import exact_increment
print("ready", flush=True)
sys.stdin.readline()
print(exact_increment(0.5, 2.0, 6.0, 1.0 / 6.0, 0.1))
"""


@pytest.mark.thorough
def test_two_processes_compile_the_same_kernel_at_once(tmp_path: Path) -> None:
    """Both end well and alike, and the machine code that is left can be loaded."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}

    def start() -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-c", COMPILES],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def answers(processes: list[subprocess.Popen[str]]) -> list[str]:
        for process in processes:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
        for process in processes:
            assert process.stdin is not None
            process.stdin.write("now\n")
            process.stdin.flush()
        reported = [process.communicate()[0] for process in processes]
        assert [process.returncode for process in processes] == [0] * len(processes)
        return reported

    first = answers([start(), start()])
    later = answers([start()])
    assert len({*first, *later}) == 1
    assert len(list(tmp_path.rglob("*.json"))) == 1
    assert not list(tmp_path.rglob("*.json.*"))


@pytest.mark.parametrize("begin", [" {", "\n{"])
def test_rare_functions_are_not_written_into_what_calls_them(begin: str) -> None:
    """numba begins the body of a function on a new line; llvmlite does not."""
    import llvmlite.binding as llvm

    from thermobearing.core.compiled.jit import KEPT_APART, _with_attributes

    text = f"define double @rare(double %x){begin}\n  ret double %x\n}}\n"
    (function,) = llvm.parse_assembly(_with_attributes(text, KEPT_APART["rare"])).functions
    assert {"noinline", "cold"} <= set(b" ".join(function.attributes).decode().split())
