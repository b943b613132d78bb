"""Kernels built ahead of time: tables, loading, refusals, and the C interface.

The tests of whole programs run on the libraries of `make kernels` where these exist, and on numba
with THERMOBEARING_KERNELS=jit.
"""

import json
import os
import shutil
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from tests.fixtures.kernels import c_compiler, calls
from tests.verification.structures import real_bearing
from thermobearing.core import march, step, types
from thermobearing.core.compiled import native, runners
from thermobearing.core.compiled.kernel import Kernel, prepare
from thermobearing.core.compiled.objects import find_faces
from thermobearing.core.compiled.runners import MissingKernelsError
from thermobearing.core.records import row_type
from thermobearing.structure import forces
from thermobearing.structure import types as structure_types

ROOT = Path(__file__).parents[2]
KERNELS: dict[str, Any] = {
    kernel.name: kernel
    for kernel in vars(march).values()
    if isinstance(kernel, Kernel)  # type: ignore[arg-type]
}


def described(folder: Path) -> dict[str, Any]:
    result: dict[str, Any] = json.loads((folder / native.DESCRIPTION).read_text())
    return result


def face(folder: Path, name: str) -> Callable[..., Any]:
    library = native._load(folder, native.library_name())
    function = getattr(library.code, library.description["entries"][name]["symbol"])
    return native.Face(function, library.description, KERNELS[name]).call


def arrays(given: Any) -> list[Any]:
    if isinstance(given, tuple):
        return [array for one in given for array in arrays(one)]
    return [given] if isinstance(given, np.ndarray) else []


def check_layout(description: dict[str, Any]) -> int:
    """What the description says of records and rows is what their classes say."""
    modules = (types, structure_types, forces)
    classes = {name: one for module in modules for name, one in vars(module).items()}
    checked = 0
    for name, fields in description["records"].items():
        plain = classes[name.removesuffix("2").removesuffix("Lanes")]
        assert [field for field, _ in fields] == list(plain._fields)
        checked += 1
    for name, row in description["rows"].items():
        components = 2 if name.endswith("Plane") else 1
        plain = row_type(classes[name.removesuffix("Lanes").removesuffix("Plane")], components)
        assert [field for field, *_ in row["fields"]] == list(plain.names or ())
        if not name.endswith("Lanes"):
            assert row["size"] == plain.itemsize
            assert row["fields"] == native._list_fields(plain)
        checked += 1
    return checked


def test_tables_follow_the_records(small_library: Path) -> None:
    assert check_layout(described(small_library)) >= 4


def test_numba_alone_gives_the_numbers_of_a_face() -> None:
    """Arguments that no table holds, such as an array with strides, are left to numba alone."""
    ours, theirs = calls()["core.march.hours_at_rest"], calls()["core.march.hours_at_rest"]
    find_faces(march.hours_at_rest).call(*ours)  # type: ignore[arg-type]
    KERNELS["core.march.hours_at_rest"].dispatcher(*theirs)
    for array, expected in zip(arrays(ours), arrays(theirs), strict=True):
        np.testing.assert_allclose(array, expected, rtol=1e-14)


def test_records_with_lists_of_unlike_lengths_are_one_list() -> None:
    """Lines of bearings of several kinds: two of one kind and one of the other."""
    import numba

    from thermobearing.core.compiled.native import UnsuitableError
    from thermobearing.core.compiled.tables import Listed, stored_type

    one, two = (numba.typeof((np.zeros((2, 2)),) * count) for count in (1, 2))
    numbers = numba.typeof((1.0, 2.0))
    lists = stored_type(numba.types.Tuple((one, two)))
    assert isinstance(lists, Listed)
    assert lists.stored == stored_type(one) == stored_type(two)
    for unlike in (numba.types.Tuple((one, numba.typeof(np.zeros(2)))), numbers):
        with pytest.raises(UnsuitableError):
            stored_type(unlike)


def test_a_face_gives_the_bits_of_numba(small_library: Path) -> None:
    for name in ("core.march.copy_state", "core.march.hours_at_rest"):
        ours, theirs = calls()[name], calls()[name]
        face(small_library, name)(*ours)
        find_faces(KERNELS[name]).call(*theirs)
        for array, expected in zip(arrays(ours), arrays(theirs), strict=True):
            assert_array_equal(array, expected)


@pytest.mark.thorough
def test_a_march_gives_the_bits_of_numba(library_with_march: Path) -> None:
    name = "core.march.march"
    ours, theirs = calls("march")[name], calls("march")[name]
    results = face(library_with_march, name)(*ours)
    assert results == find_faces(KERNELS[name]).call(*theirs)
    assert results[:3] == (300, 300, types.COMPLETED)
    for array, expected in zip(arrays(ours), arrays(theirs), strict=True):
        assert_array_equal(array, expected)


def test_arguments_that_do_not_fit_are_left_to_numba(small_library: Path) -> None:
    """Kinds that a face was not built for; without numba they are an error."""
    kept, early, late, air, places, now, after, result = (*calls()["core.march.hours_at_rest"],)
    run = face(small_library, "core.march.hours_at_rest")
    expected = np.zeros_like(result)
    run(kept, early, late, air, places, now.copy(), after, expected)
    wide = np.zeros((3, 8))[:, ::2]
    run(kept, early, late, air, places, now.copy(), after, wide)
    assert_array_equal(wide, expected)
    for array in (air, places):
        array.flags.writeable = False
    fixed = np.zeros_like(result)
    run(kept, early, late, air, places, now.copy(), after, fixed)
    assert_array_equal(fixed, expected)
    few = places.astype(np.int32)
    again = np.zeros_like(result)
    run(kept, early, late, air, few, now.copy(), after, again)
    assert_array_equal(again, expected)


@pytest.mark.parametrize("wrong", ["type", "order", "dimensions", "kind", "record"])
def test_arguments_that_do_not_fit_are_refused_without_numba(
    wrong: str, small_library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(native, "has_numba", lambda: False)
    name = "core.march.hours_at_rest"
    arguments: list[Any] = [*calls()[name]]
    arguments[0] = {
        "type": arguments[0].astype(np.float32),
        "order": arguments[0].T,
        "dimensions": arguments[0][0],
        "kind": arguments[0].tolist(),
        "record": arguments[0],
    }[wrong]
    if wrong == "record":
        name, arguments = "core.march.copy_state", [np.zeros(3), np.zeros(3)]
    with pytest.raises(native.UnsuitableError, match=name):
        face(small_library, name)(*arguments)


def test_states_may_change_between_calls(small_library: Path) -> None:
    """Tables of states are kept; another state at the same place in memory has its own."""
    run = face(small_library, "core.march.copy_state")
    for number in range(200):
        source, target = calls()["core.march.copy_state"]
        assert isinstance(source, types.State)
        assert isinstance(target, types.State)
        source.temperature[:] = number
        run(source, target)
        assert_array_equal(target.temperature, number)
        source.layers["d"] = 3.0
        run(source, target)
        assert (target.layers["d"] == 3.0).all()


def damaged(folder: Path, copy: Path, how: str) -> Path:
    shutil.copytree(folder, copy)
    description = described(copy)
    (name,) = description["libraries"]
    file = copy / description["libraries"][name]["file"]
    if how == "truncated":
        os.truncate(file, file.stat().st_size // 2)
    elif how == "replaced":
        file.write_bytes(file.read_bytes()[:-1] + b"x")
    elif how == "absent":
        file.unlink()
    elif how == "foreign":
        description["libraries"] = {"plan9-x86_64": description["libraries"][name]}
    elif how == "earlier sources":
        description["sources"] = "0" * 16
    (copy / native.DESCRIPTION).write_text(
        "{" if how == "no description" else json.dumps(description)
    )
    return copy


DAMAGES = ["truncated", "replaced", "absent", "earlier sources", "no description"]


def copy_state_kernel() -> Any:
    """Return a new kernel, which has chosen neither a library nor numba yet."""
    compiled: Any = march.copy_state
    return Kernel(compiled.py_func)


@pytest.mark.parametrize("how", DAMAGES)
def test_a_library_that_differs_is_refused(
    how: str, small_library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """numba is taken in its place, and one sentence says so; without numba an error does."""
    arguments = calls()["core.march.copy_state"]
    monkeypatch.setattr(native, "FOLDER", damaged(small_library, tmp_path / "copy", how))
    monkeypatch.delenv(native.CHOICE, raising=False)
    monkeypatch.setenv(native.WARNED, "")
    native.open_library.cache_clear()
    kernel = copy_state_kernel()
    try:
        with pytest.warns(UserWarning, match="numba") as output:
            chosen = [runners.choose(kernel, arguments), runners.choose(kernel, arguments)]
        assert len(output) == 1
        native.open_library.cache_clear()  # as in a process that this one starts
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert native.open_library()[0] is None
        assert chosen == [find_faces(kernel).faces[0].call] * 2
        monkeypatch.setattr(runners, "has_numba", lambda: False)
        with pytest.raises(MissingKernelsError, match="thermobearing\\[jit\\]"):
            runners.choose(kernel, arguments)
    finally:
        native.open_library.cache_clear()


def test_a_library_is_taken_from_the_package_only(
    small_library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder without libraries is a checkout: numba compiles, and nothing is said."""
    monkeypatch.setattr(native, "FOLDER", tmp_path / "none")
    monkeypatch.delenv(native.CHOICE, raising=False)
    monkeypatch.chdir(small_library)
    native.open_library.cache_clear()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert native.open_library()[0] is None
        monkeypatch.setattr(native, "FOLDER", small_library)
        native.open_library.cache_clear()
        assert native.open_library()[0] is not None
        monkeypatch.setenv(native.CHOICE, "jit")
        native.open_library.cache_clear()
        assert native.open_library()[0] is None
    finally:
        native.open_library.cache_clear()


def test_libraries_of_other_machines_are_no_reason_to_warn(
    small_library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As after `make kernels KERNELS=wasm32`."""
    monkeypatch.setattr(native, "FOLDER", damaged(small_library, tmp_path / "copy", "foreign"))
    monkeypatch.delenv(native.CHOICE, raising=False)
    native.open_library.cache_clear()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            library, reason = native.open_library()
        assert library is None
        assert native.library_name() in reason
        monkeypatch.setattr(runners, "has_numba", lambda: False)
        kernel = copy_state_kernel()
        with pytest.raises(MissingKernelsError, match="thermobearing\\[jit\\]"):
            runners.choose(kernel, calls()["core.march.copy_state"])
    finally:
        native.open_library.cache_clear()


WITHOUT_NUMBA = """
import sys
sys.modules["numba"] = sys.modules["llvmlite"] = None
import thermobearing as tb
import thermobearing.structure.lanes, thermobearing.motions.spectrum
from thermobearing.core.compiled import native, runners
from thermobearing.core.types import new_state
from thermobearing.core.march import copy_state
from pathlib import Path
native.FOLDER = Path(sys.argv[1])
element = tb.element("shen-hdr-specimen", ambient=-20)
element.restore(element.save())
print(type(copy_state.run).__name__, copy_state.run.__self__.function.__name__)
"""


def test_the_package_works_without_numba(small_library: Path) -> None:
    environment = {key: value for key, value in os.environ.items() if key != native.CHOICE}
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_NUMBA, str(small_library)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["method", "thermobearing_copy_state"]


NEITHER = """
import sys
sys.modules["numba"] = None
from pathlib import Path
from thermobearing.core.compiled import native, runners
from thermobearing.cli import main
native.FOLDER = Path(sys.argv.pop())
main()
"""


def test_a_command_without_any_kernels_says_what_to_install(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", NEITHER, "cyclic", "-q", "-o", "out", str(tmp_path / "none")],
        env={key: value for key, value in os.environ.items() if key != native.CHOICE},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "thermobearing[jit]" in line


@pytest.mark.parametrize(
    ("flags", "level"),
    [
        ("fpu sse2", "v1"),
        ("avx avx2 bmi1 bmi2 f16c fma abm movbe", "v3"),
        ("avx avx2 bmi1 bmi2 f16c fma abm movbe avx512f avx512bw avx512cd avx512dq avx512vl", "v4"),
        ("avx512f avx512bw avx512cd avx512dq avx512vl", "v1"),
    ],
)
def test_the_level_of_the_processor(
    flags: str, level: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "read_text", lambda *_, **__: f"processor : 0\nflags\t\t: {flags}\n")
    assert native._level() == level


@pytest.mark.thorough
def test_c_runs_a_test_of_a_bearing(library_with_march: Path, tmp_path: Path) -> None:
    """The example in C gives the loops that Python gives for the same bearing."""
    (library,) = library_with_march.glob("*.so")
    example = ROOT / "kernels" / "example.c"
    command = [*c_compiler(), "-O1", "-Wall", "-Werror", f"-I{library_with_march}", str(example)]
    command += [str(library), f"-Wl,-rpath,{library_with_march}", "-lm", "-o", "example"]
    subprocess.run(command, cwd=tmp_path, check=True)
    reported = subprocess.run(
        [tmp_path / "example"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    x, force, warm = np.array([line.split() for line in reported], dtype=float).T
    assert len(x) == 400
    assert np.ptp(x) == pytest.approx(60.0)
    work = float(np.sum(0.5 * (force + np.append(0.0, force[:-1])) * np.diff(x, prepend=0.0)))
    assert work > 0.0
    assert warm[-1] > warm[0] > -20.0
    assert warm[-1] + 20.0 < work / 2000.0
    assert force[99] == pytest.approx(force[199], rel=0.05)


@pytest.mark.parametrize("misfit", [False, True])
def test_a_prepared_call_is_the_call(misfit: bool) -> None:
    """It takes new numbers and the present content of records; a misfit is left to the kernel."""
    constants = real_bearing("shen-lhdr-specimen")
    start = np.linspace(-20.0, -10.0, len(constants.cells.capacity))
    state, new = types.new_state(constants, start), types.new_state(constants, start)
    work = types.new_workspace(constants)
    target = types.new_state(constants, start[::-1])
    if misfit:
        target = target._replace(temperature=np.zeros(2 * len(start))[::2])
    run = prepare(step.step, constants, work, state, 0.0, 0.0, 0.0, new)
    accept = prepare(march.copy_state, new, target)
    for x in (3.0, 4.0):
        result = run(x, 0.1, -20.0)
        accept()
        assert_array_equal(target.temperature, new.temperature)
        other = types.new_state(constants, start)
        assert result == step.step(constants, work, state, x, 0.1, -20.0, other)
        assert_array_equal(other.temperature, new.temperature)
        march.copy_state(new, state)
