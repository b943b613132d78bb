"""Files that somebody gives: regular ones of limited size, opened in one place."""

import ast
import os
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
from tests.unit import inputs
from thermobearing.border import opener, toml
from thermobearing.border.opener import append_text, opened, read_bytes, read_json
from thermobearing.border.toml import read_toml
from thermobearing.identify.records.record import load_test
from thermobearing.identify.uncertainty.samples import posterior_bearings
from thermobearing.loading import load_result
from thermobearing.motions.library import load_motion
from thermobearing.results.directory import check_seal
from thermobearing.results.saved import read_saved
from thermobearing.studies.store import Store
from thermobearing.tables import text

PACKAGE = Path(tb.__file__).parent
# Calls that open a file, by the name of the function or method.
METHODS = {"open", "read_text", "read_bytes"}
READERS = {
    *("ParquetFile", "read_schema", "read_table", "load_workbook", "ZipFile"),
    *("genfromtxt", "loadtxt", "fromfile", "memmap", "loadmat", "open_dataset", "load_dataset"),
    *("read_csv", "read_excel", "read_parquet", "read_json", "read_feather", "read_pickle"),
}
MODULES = {
    "np": {"load"},
    "numpy": {"load"},
    "xr": {"open_zarr"},
    "netCDF4": {"Dataset"},
    "tomllib": {"load"},
}
OURS = {"read_csv", "read_json", "read_text", "read_bytes"}  # plain calls of functions of ours
DATA = "a file of the package"
NEW = "a new file in a folder that this process has made"
# Functions that open a file themselves, and why nobody can have put a pipe there.
ALLOWED = {
    ("border/opener.py", "_open"): "the opener",
    ("border/opener.py", "append_text"): "the opener",
    ("border/text_file.py", "write_through"): NEW,
    ("border/units.py", "_common_factors"): DATA,
    ("quantities/register.py", "registered_quantities"): DATA,
    ("motions/library.py", "_about"): DATA,
    ("motions/library.py", "_stored"): DATA,
    ("studies/definition/motions.py", "_sources"): DATA,
    ("studies/definition/motions.py", "_read_motions"): "numpy gets the open file",
    ("studies/store.py", "_read_parquet"): "pyarrow gets the open file",
    ("studies/store.py", "_read_labels"): "pyarrow gets the open file",
    ("studies/store.py", "_read_notes"): "pyarrow gets the bytes",
    ("results/saved.py", "read_csv"): "pandas gets the open file",
    ("results/saved.py", "read_dataset"): "check_seal has opened it",
    ("results/directory.py", "seal"): NEW,
    ("results/directory.py", "locked"): "opened without waiting, and only locked",
    ("results/writing.py", "_reserve"): NEW,
    ("cyclic/result.py", "_write"): NEW,
    ("tables/columns.py", "even_table"): "numpy gets the lines",
    ("verify/references.py", "elements_digest"): DATA,
    ("verify/references.py", "opensees_script"): NEW,
    ("verify/references.py", "run_opensees"): NEW,
    ("tables/text.py", "_workbook"): "openpyxl gets the bytes",
    ("tables/text.py", "_refuse_large_workbook"): "zipfile gets the bytes",
    ("report/workbook.py", "_restamped"): "zipfile gets the bytes",
    ("report/figures.py", "picture_size"): "Pillow gets the bytes",
    ("live/data.py", "engine_source"): DATA,
    ("opensees/line.py", "_read_journal"): NEW,
    ("opensees/line.py", "_element_masses"): NEW,
    ("opensees/server.py", "__init__"): NEW,
    ("opensees/keeper.py", "_keep"): "the null device",
    ("commands/common.py", "_discard"): "the null device",
    ("commands/common.py", "guard_streams"): "the null device",
    ("commands/options.py", "_stored_descriptions"): DATA,
}


def opening_calls(source: str) -> Iterator[tuple[str, str, int]]:
    """Yield function, call and line of all calls that open a file."""
    scopes: list[tuple[ast.AST, str]] = [(ast.parse(source), "")]
    while scopes:
        node, function = scopes.pop()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            function = node.name
        scopes += [(child, function) for child in ast.iter_child_nodes(node)]
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        if isinstance(called, ast.Name) and called.id in {"open", *READERS} - OURS:
            yield function, called.id, node.lineno
        elif isinstance(called, ast.Attribute):
            owner = called.value
            module = owner.id if isinstance(owner, ast.Name) else ""
            packaged = isinstance(owner, ast.Call) and ast.unparse(owner.func) == "data_path"
            names = METHODS | READERS | MODULES.get(module, set())
            if called.attr in names and not packaged:
                yield function, ast.unparse(called), node.lineno


def test_only_the_opener_opens_files_that_somebody_gives() -> None:
    used, elsewhere = set(), []
    for file in sorted(PACKAGE.rglob("*.py")):
        name = file.relative_to(PACKAGE).as_posix()
        if name.startswith("core/"):  # machine code in folders of the package
            continue
        for function, call, line in opening_calls(file.read_text(encoding="utf-8")):
            used.add((name, function))
            if (name, function) not in ALLOWED:
                elsewhere.append(f"{name}:{line} {function}: {call}")
    assert elsewhere == []
    assert set(ALLOWED) - used == set()


def test_the_rule_sees_all_ways_to_open_a_file() -> None:
    calls = (
        *("open(x)", "x.open()", "x.read_text()", "x.read_bytes()", "os.open(x, 0)"),
        *("np.load(x)", "pd.read_csv(x)", "pd.read_excel(x)", "xr.load_dataset(x)"),
        *("xr.open_dataset(x)", "parquet.ParquetFile(x)", "parquet.read_schema(x)"),
        *("pq.read_table(x)", "zipfile.ZipFile(x)", "openpyxl.load_workbook(x)", "Image.open(x)"),
    )
    assert [next(opening_calls(f"def f(x):\n    {call}"))[0] for call in calls] == ["f"] * 16
    assert not list(opening_calls("read_json(x), read_bytes(x), json.loads(x), path.read(x)"))
    assert not list(opening_calls('data_path("a", "b").read_text(encoding="utf-8")'))


needs_pipes = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")


GIVEN: dict[str, Callable[[Path], Any]] = {
    "fit.toml": read_toml,
    "fit.csv": load_test,
    "test.xlsx": load_test,
    "posterior.csv": lambda path: posterior_bearings("shen-hdr-specimen", path),
    "motion.at2": load_motion,
    "bearing.toml": tb.load_bearing,
    "case.toml": tb.load_case,
    "summary.json": lambda path: read_saved(path.parent),
    "manifest.json": lambda path: Store(path.parent),
    "result.nc": check_seal,
}


@needs_pipes
@pytest.mark.parametrize("name", GIVEN)
def test_no_reader_waits_for_a_pipe(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    inputs.assert_refused(lambda: GIVEN[name](tmp_path / name), "is a named pipe")


@needs_pipes
def test_no_member_of_a_result_waits(tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text('{"command": "identify", "outcome": "good"}')
    os.mkfifo(tmp_path / "fit.csv")
    inputs.assert_refused(lambda: load_result(tmp_path), "fit.csv", "is a named pipe")
    with pytest.raises(OSError, match="No such device or address"):
        append_text(tmp_path / "fit.csv", "a line of the log")


def test_kinds_that_are_no_file(tmp_path: Path) -> None:
    inputs.assert_refused(lambda: read_bytes(tmp_path, 9), "is a directory")
    if hasattr(socket, "AF_UNIX"):
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(str(tmp_path / "s.csv"))
            inputs.assert_refused(lambda: read_bytes(tmp_path / "s.csv", 9), "is a socket")
    for device in ("/dev/zero", "/dev/tty"):
        if Path(device).exists():
            with pytest.raises(tb.InputError):
                read_bytes(Path(device), 9)


def test_size_is_known_before_anything_is_read(tmp_path: Path) -> None:
    """A file with a hole of a terabyte takes no place on the disk."""
    path = tmp_path / "sparse.csv"
    with path.open("wb") as file:
        file.truncate(10**11)
    inputs.assert_refused(lambda: opened(path, 10**8).__enter__(), "is larger than 100 MB")
    path.write_bytes(b"12345")
    assert read_bytes(path, 5) == b"12345"
    inputs.assert_refused(lambda: read_bytes(path, 4), "is larger than")


@pytest.mark.parametrize("text", ["[" * 100_000, "{", '{"a": 1' + "0" * 5000 + "}", "\udcff"])
def test_json_that_is_none(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text(text, encoding="utf-8", errors="surrogateescape")
    inputs.assert_refused(lambda: read_json(path), str(path), "is not valid JSON")


@pytest.mark.skipif(not Path("/dev/fd").exists(), reason="there is no /dev/fd")
def test_a_pipe_of_the_shell_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(opener, "PATIENCE", 0.05)
    read_end, write_end = os.pipe()
    try:
        path = Path(f"/dev/fd/{read_end}")
        os.write(write_end, b"12345")
        inputs.assert_refused(lambda: read_bytes(path, 9), "a pipe without data for 0.05 s")
        os.write(write_end, b"12345")
        inputs.assert_refused(lambda: read_bytes(path, 4), "is larger than")
        os.write(write_end, b"678")
        os.close(write_end)
        assert read_bytes(path, 9) == b"678"
    finally:
        os.close(read_end)


LONG_KEYS = {
    "plain": "a",
    "quoted": '"a"',
    "quoted equals sign": '"="',
    "literal bracket": "']'",
}


@pytest.mark.parametrize("part", LONG_KEYS.values(), ids=LONG_KEYS)
@pytest.mark.parametrize("form", ["{} = 1", "[{}]", 'x = {{y = """\nz""", {} = 1}}'])
def test_keys_of_many_parts_never_reach_the_parser(
    part: str, form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The time of tomllib grows with the square of the parts: 20 s for a file of 200 kB."""
    monkeypatch.delattr("tomllib.loads")
    path = tmp_path / "a.toml"
    path.write_text(form.format(".".join([part] * 60)))
    inputs.assert_refused(lambda: read_toml(path), "a key of more than 50 parts")


@pytest.mark.parametrize("item", ["{}", "[]", "{a=1}"])
def test_many_small_tables_never_reach_the_parser(
    item: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr("tomllib.loads")
    path = tmp_path / "a.toml"
    path.write_text("x = [" + f"{item}," * 100_001 + "]")
    inputs.assert_refused(lambda: read_toml(path), "has more than 100000 keys")


def test_many_values_and_parts_never_reach_the_parser(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delattr("tomllib.loads")
    monkeypatch.setattr(toml, "MOST_VALUES", 10)
    monkeypatch.setattr(toml, "MOST_PARTS", 10)
    path = tmp_path / "a.toml"
    path.write_text("x = [" + "1," * 11 + "]")
    inputs.assert_refused(lambda: read_toml(path), "more than 10 values")
    path.write_text("a.b.c.d = 1\n" * 4)
    inputs.assert_refused(lambda: read_toml(path), "more than 10 parts")


def test_marks_within_texts_and_comments_are_no_keys(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    dots = "a." * 60 + " = ]"
    texts = [f'a = "{dots} \\" "', f"b = '{dots}'", f'c = """\n{dots}""""', f"d = '''\n{dots}'''"]
    path.write_text("\n".join([*texts, f"# {dots}", 'e = ["' + '", "'.join(["f.csv"] * 60) + '"]']))
    table = read_toml(path)
    assert table["a"] == f'{dots} " '
    assert [table[key] for key in "bcd"] == [dots, f'{dots}"', dots]
    assert len(table["e"]) == 60


@pytest.mark.parametrize("block", [64, 1000])
def test_rows_of_a_workbook_are_counted_before_it_is_parsed(
    block: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """75 million empty rows in a file of half a megabyte took a parser minutes."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in range(20):
        book.active.append([row, row])
    book.save(tmp_path / "a.xlsx")
    patterns = {thing: pattern for pattern, _, thing in text.ELEMENTS["worksheets/"]}
    monkeypatch.setattr(text, "UNPACKED", block)
    for thing, number in (("rows", 20), ("cells", 40)):
        monkeypatch.setitem(text.ELEMENTS, "worksheets/", [(patterns[thing], number, thing)])
        assert len(text.read_sheets(tmp_path / "a.xlsx")[0].rows) == 20
        monkeypatch.setitem(text.ELEMENTS, "worksheets/", [(patterns[thing], number - 1, thing)])
        with monkeypatch.context() as without:
            without.delattr(openpyxl, "load_workbook")
            inputs.assert_refused(
                lambda: text.read_sheets(tmp_path / "a.xlsx"), f"more than {number - 1} {thing}"
            )
    assert all(p.search(b'<a:row r="1">') or p.search(b"<a:c/>") for p in patterns.values())
