"""Every number that a file may hold has limits; files that would keep a parser busy end soon."""

import fcntl
import os
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, get_args

import pytest
from pydantic import BaseModel, Field
from pydantic.fields import FieldInfo

import thermobearing as tb
from tests.unit.inputs import SPECIMEN, assert_refused, changed_table, specimen_table
from thermobearing.bearing.bilinear import BILINEAR, BilinearBearing, load_bilinear
from thermobearing.bearing.library import bearing_from_table
from thermobearing.bearing.model import Bearing, Validity
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.case import Case
from thermobearing.design.case import DesignCase
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.identify.records.record import load_test
from thermobearing.results import directory as swap
from thermobearing.structure.model import Structure, list_structures, load_structure
from thermobearing.tables import text as sheets
from thermobearing.tables.text import MOST_ROWS, is_numeric, is_stamp

FILES = (Bearing, BilinearBearing, Structure, Case, EarthquakeCase, DesignCase)
USUAL = 10.0  # how far the limits are from what is in the library, at least
# Ratios that end at 1 by their meaning, and s that ends at -1; besides these, temperatures (and
# their coefficients, which are logarithms already) and what is zero for nothing are left out.
MEANT = {"post_yield_ratio", "surface_ratio", "end_spreading", "yield_rotation", "shape"}


def parts(item: Any) -> Iterator[Any]:
    inner = [*item.metadata, item.annotation] if isinstance(item, FieldInfo) else get_args(item)
    yield item
    for part in inner:
        yield from parts(part)


def models_below(model: type[BaseModel], seen: dict[str, type[BaseModel]]) -> None:
    if model.__name__ in seen:
        return
    seen[model.__name__] = model
    for field in model.model_fields.values():
        for part in parts(field):
            if isinstance(part, type) and issubclass(part, BaseModel):
                models_below(part, seen)


MODELS: dict[str, type[BaseModel]] = {}
for file in FILES:
    models_below(file, MODELS)


def limits(model: type[BaseModel], name: str) -> tuple[list[float], list[float]]:
    result = list(parts(model.model_fields[name]))
    instances = [part for part in result if not isinstance(part, type)]

    def _stated(*names: str) -> list[float]:
        return [getattr(part, name) for part in instances for name in names if hasattr(part, name)]

    return _stated("ge", "gt"), _stated("le", "lt")


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_every_number_has_two_limits(model: type[BaseModel]) -> None:
    """A count has at least a lower one, and is at most as large as what it repeats allows."""
    for name, field in model.model_fields.items():
        kinds = {part for part in parts(field) if isinstance(part, type)}
        low, high = limits(model, name)
        if float in kinds:
            assert low, f"{model.__name__}.{name} has no lower limit"
            assert high, f"{model.__name__}.{name} has no upper limit"
            assert low[0] < high[0]
        elif int in kinds:
            assert low, f"{model.__name__}.{name} has no lower limit"


def numbers(model: BaseModel) -> Iterator[tuple[type[BaseModel], str, float]]:
    for name in type(model).model_fields:
        value = getattr(model, name)
        for item in value if isinstance(value, list | tuple) else [value]:
            if isinstance(item, BaseModel):
                yield from numbers(item)
            elif isinstance(item, float):
                yield type(model), name, item


LIBRARY: list[Strict] = [
    *(tb.load_bearing(name) for name in tb.list_bearings()),
    *(load_bilinear(name) for name in BILINEAR.names()),
    *(load_structure(name) for name in list_structures()),
]


@pytest.mark.parametrize("record", LIBRARY, ids=lambda record: record.name)
def test_limits_are_a_factor_of_ten_from_the_usual(record: Strict) -> None:
    for model, name, value in numbers(record):
        low, high = limits(model, name)
        if value == 0.0 or name in MEANT or name.endswith(("_ratio", "exponent", "scale")):
            continue
        if "temperature" in name or name in ("coldest", "warmest") or model is Validity:
            continue  # what a test reached is no number of a bearing
        size = abs(value)
        assert USUAL * size <= max(abs(high[0]), abs(low[0])), f"{model.__name__}.{name} = {value}"
        if low[0] > 0.0:
            assert size / USUAL >= low[0], f"{model.__name__}.{name} = {value}"


H, G, M = "hysteresis.", "geometry.", "materials."


@pytest.mark.parametrize(
    ("changes", "pieces"),
    [
        ({H + "layer_stiffness": "200000 kN/mm"}, ["K_r t_r / A of 1.74e+04 MPa", "10000 MPa"]),
        ({H + "layer_stiffness": "0.001 kN/mm"}, ["K_r t_r / A of 8.68e-05 MPa", "0.001 to"]),
        ({H + "yield_displacement": "1 um"}, ["yield strain of 0.0002", "0.001 to 10"]),
        ({H + "yield_displacement": "60 mm"}, ["yield strain of 12", "0.001 to 10"]),
        ({G + "sealing_plate_thickness": "5e-324 mm"}, ["sealing_plate_thickness", "must be 0 or"]),
        ({G + "sealing_plate_thickness": "0.001 mm"}, ["0.001 mm must be 0 or at least 0.05 mm"]),
    ],
    ids=range(6),
)
def test_nonsense_in_a_bearing(changes: dict[str, Any], pieces: list[str]) -> None:
    table = changed_table(specimen_table(), changes)
    assert_refused(lambda: bearing_from_table(table, "bearing"), *pieces)


@pytest.mark.parametrize("thickness", ["0 mm", "0.05 mm", "3 cm"])
def test_no_sealing_plate_or_one(thickness: str) -> None:
    table = changed_table(specimen_table(), {G + "sealing_plate_thickness": thickness})
    assert bearing_from_table(table, "bearing").name == SPECIMEN


def test_a_field_without_limits_has_those_of_a_slip() -> None:
    class Free(Strict):
        number: float

    assert validated(Free, {"number": -1e12}, "free").number == -1e12
    with pytest.raises(tb.InputError, match=r"at most 1e\+12 in size; check the unit"):
        validated(Free, {"number": 1e13}, "free")


class Walk(Strict):
    length: Annotated[float, in_unit("mm"), Field(gt=0)] = 1.0
    share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    steps: Annotated[int, Field(gt=2, le=5)] = 3
    drift: float = 0.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"length": 0.0}, "length = 0.0: must be a number greater than 0 mm"),
        ({"share": -0.1}, "share = -0.1: must be a number at least 0 and less than 1"),
        ({"share": 1.0}, "share = 1.0: must be a number at least 0 and less than 1"),
        ({"steps": 2}, "steps = 2: must be an integer greater than 2 and at most 5"),
        ({"steps": 6}, "steps = 6: must be an integer greater than 2 and at most 5"),
        ({"length": 1.1e12}, "length = 1100000000000.0: must be at most 1e+12 mm in size"),
        ({"length": 0.9e-12}, "length = 9e-13: must be at least 1e-12 mm in size"),
        ({"drift": -2e12}, "drift = -2000000000000.0: must be at most 1e+12 in size"),
        ({"drift": float("nan")}, "drift = nan: must be a finite number"),
        ({"steps": True}, "steps = True: must be an integer"),
        ({"lenght": 2.0}, 'unknown key "lenght"; did you mean "length"?'),
    ],
)
def test_what_is_allowed(given: dict[str, Any], message: str) -> None:
    assert_refused(lambda: Walk(**given), message)


@pytest.mark.parametrize("given", [{"length": 1e12}, {"length": 1e-12}, {"drift": 1e-300}])
def test_sizes_that_are_no_slip(given: dict[str, float]) -> None:
    assert Walk(**given).model_dump() | given == Walk(**given).model_dump()


SOON = 15.0  # [s] on a busy machine; each of them took more than a minute
HEAD = "time_s,displacement_mm,force_kN\n"
BOOK = """<?xml version="1.0"?><worksheet
xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{rows}</sheetData>
</worksheet>"""


def workbook(path: Path, rows: str) -> Path:
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    openpyxl.Workbook().save(path.with_suffix(".plain"))
    with zipfile.ZipFile(path.with_suffix(".plain")) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            sheet = name.startswith("xl/worksheets/")
            new.writestr(name, BOOK.format(rows=rows) if sheet else old.read(name))
    return path


def text(content: str) -> Callable[[Path], Path]:
    def write(path: Path) -> Path:
        path.write_text(content)
        return path

    return write


TABLES: dict[str, tuple[Callable[[Path], Path], str]] = {
    "a cell of digits": (text(HEAD + "1" * 130_000 + "x,1,2\n" + "0,1,2\n" * 50), "not a number"),
    "cells of digits": (
        text(HEAD + ("1" * 10_000 + "x,1,2\n") * 100 + "0,1,2\n" * 50),
        "not a number",
    ),
    "a million columns": (text(("1," * 1_000_000 + "1\n") * 3), "more than 1000 columns"),
    "a far row": (
        lambda path: workbook(path.with_suffix(".xlsx"), '<row r="100000000000"/>'),
        f"more than {MOST_ROWS} rows",
    ),
    "empty rows": (
        lambda path: workbook(path.with_suffix(".xlsx"), "<row/>" * 30_000),
        "more than 20000 rows",
    ),
}


@pytest.mark.parametrize("kind", TABLES)
def test_a_table_is_refused_in_time(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, output = TABLES[kind]
    if kind == "empty rows":
        monkeypatch.setattr(sheets, "MOST_ROWS", 20_000)
    path = write(tmp_path / "t.csv")
    begun = time.process_time()
    with pytest.raises(tb.InputError, match=output):
        load_test(path)
    assert time.process_time() - begun < SOON


def test_a_row_that_looks_like_units_is_passed_in_time(tmp_path: Path) -> None:
    path = text(HEAD + "." * 100_000 + "x,mm,kN\n" + "0,1,2\n" * 50)(tmp_path / "t.csv")
    begun = time.process_time()
    load_test(path)
    assert time.process_time() - begun < SOON


def test_the_widest_table_is_read_in_time(tmp_path: Path) -> None:
    """A thousand columns with separate titles; the work for titles grew with its square."""
    titles = ",".join(f"channel {k} [u{k}]" for k in range(997))
    path = text(HEAD.strip() + f",{titles}\n" + ("1,1,1" + ",0" * 997 + "\n") * 3)(
        tmp_path / "t.csv"
    )
    begun = time.process_time()
    load_test(path)
    assert time.process_time() - begun < SOON


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("a" + ".a" * 100_000 + " = 1", "line 1: a key of more than 50 parts"),
        ("[" + "a." * 100_000 + "a]\n", "line 1: a key of more than 50 parts"),
        ("b = 1\nc = { " + '"a" . ' * 100_000 + "a = 1 }\n", "line 2: a key of more than 50 parts"),
        ("".join(f"k{n} = 1\n" for n in range(500_000)), "more than 100000 keys"),
        ("[[a]]\n" * 1_600_000, "more than 100000 keys"),
    ],
    ids=["dotted key", "dotted header", "dotted key inside", "keys", "tables"],
)
def test_toml_is_refused_in_time(tmp_path: Path, content: str, message: str) -> None:
    path = text(content)(tmp_path / "d.toml")
    begun = time.process_time()
    with pytest.raises(tb.InputError, match=message):
        read_toml(path)
    assert time.process_time() - begun < SOON


def test_numbers_and_sentences_are_no_keys(tmp_path: Path) -> None:
    path = tmp_path / "d.toml"
    sentence = "A sentence. " * 60
    path.write_text(f'x = [{"0.5, " * 100}]\nnote = "{sentence}"\nmore = """\n{sentence}\n"""\n')
    assert len(read_toml(path)["x"]) == 100


def test_of_very_many_faults_the_first_are_reported(tmp_path: Path) -> None:
    path = tmp_path / "d.toml"
    path.write_text("".join(f"k{n} = 1\n" for n in range(2000)))
    with pytest.raises(tb.InputError) as caught:
        tb.load_bearing(path)
    assert len(caught.value.problems) == 51
    assert caught.value.problems[-1].endswith(" more")


def test_a_long_cell_is_no_number_and_no_stamp() -> None:
    assert is_numeric("-" + "1" * 50)
    assert not is_numeric("1" * 61)
    assert is_stamp("12:00:00")
    assert not is_stamp("12:" + "0" * 61)


def test_a_named_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "f.toml")
    os.mkfifo(tmp_path / "f.csv")
    for read in (read_toml, load_test):
        for name in ("f.toml", "f.csv"):
            with pytest.raises(tb.InputError, match="named pipe"):
                read(tmp_path / name)


def test_a_folder_that_a_study_holds_takes_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(swap, "PATIENCE", 0.2)
    bearing = tb.load_bearing("shen-hdr-specimen")
    result = tb.run(bearing, tb.cyclic_test(strain=[0.5], cycles=1, rest=None), ambient=23.0)
    handle = os.open(tmp_path, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        result.save(tmp_path / "x", figures=False)
    finally:
        os.close(handle)
    assert (tmp_path / "x" / "summary.json").exists()
