"""The public interface: names at the top, their documentation, old places with a warning."""

import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args, is_typeddict

import numpy as np
import pytest
import xarray as xr

import thermobearing as tb
from thermobearing.results.writing import labelled_dataset

MOST = 81  # names that are promised; two are modules, which keep their own names apart
MODULES = {"laws", "opensees"}
PUBLIC = sorted(
    [getattr(tb, name) for name in tb.__all__ if name not in MODULES]
    + [getattr(tb.opensees, name) for name in tb.opensees.__all__]
    + [getattr(tb.laws, name) for name in tb.laws.__all__],
    key=lambda item: (item.__module__, item.__name__),
)
HEAVY = {"numpy", "scipy", "numba", "pandas", "xarray", "pydantic", "pint", "matplotlib", "rich"}
SECTION = r"\n\s*{}\n\s*-+\n(.*?)(?=\n\s*\w+\n\s*---|\Z)"
# What a description of a number has: its unit in brackets, or a word for one that has none.
UNIT = re.compile(
    r"\[.+?\]|\b(ratios?|shares?|relative|strains?|factors?|c_z|weights?|correlation|unit|as of)\b",
    re.IGNORECASE,
)
NAMED_UNIT = re.compile(r"^h_eq$|_(mm|MPa|kN)$")  # or its name says it


def ident(item: Any) -> str:
    return f"{item.__module__.removeprefix('thermobearing.')}.{item.__name__}"


def test_names_at_the_top_are_few_and_hidden_by_no_module() -> None:
    assert len(tb.__all__) <= MOST
    assert {"run", "bridge", "hybrid", "cyclic_test", "load_bearing", "InputError"} <= {*tb.__all__}
    folder = Path(str(tb.__file__)).parent
    modules = {path.stem for path in folder.glob("*.py")} | {path.name for path in folder.iterdir()}
    assert modules & set(tb.__all__) == MODULES
    assert all(getattr(tb, name).__name__ == name for name in set(tb.__all__) - MODULES)
    text = (folder / "__init__.pyi").read_text(encoding="ascii")  # a wheel needs it
    assert sorted(re.findall(r"^from \S+ import \w+ as (\w+)$", text, re.MULTILINE)) == sorted(
        tb.__all__
    )


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="nonsense"):
        _ = tb.nonsense  # type: ignore[attr-defined]


def test_importing_the_package_imports_nothing_heavy() -> None:
    code = "import sys, thermobearing; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "thermobearing" in loaded
    assert not loaded & HEAVY


def test_labelling_a_dataset_imports_no_other_arrays() -> None:
    code = """
import sys
import numpy as np
from thermobearing.results.writing import labelled_dataset
labelled_dataset({"force": ("time", np.zeros(3), {"units": "kN"})}, {"time": np.arange(3.0)})
print(*sys.modules)
"""
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert not set(process.stdout.split()) & {"pint", "dask.array", "sparse", "cupy"}


def test_labelled_datasets_are_those_of_xarray() -> None:
    force = ("ambient", "time"), np.arange(6.0).reshape(2, 3), {"units": "kN"}
    data: dict[str, Any] = {"force": force, "outcome": ("ambient", np.array(["a", None]))}
    coords: dict[str, Any] = {
        "ambient": (("ambient",), np.array([-20.0, 23.0]), {"units": "degC"}),
        "time": np.arange(3),
        "body": np.array(["deck", "pier"]),
        "component": ("component", np.array(["x", "y"], dtype=object)),
        "depth": ("time", np.ones(3)),
    }
    dataset = labelled_dataset(data, coords, {"title": "x"})
    expected = xr.Dataset(data, coords=coords, attrs={"title": "x"})
    assert dataset.identical(expected)
    assert list(dataset.variables) == list(expected.variables)
    assert {n: v.dtype for n, v in dataset.variables.items()} == {
        n: v.dtype for n, v in expected.variables.items()
    }
    assert all(dataset.indexes[n].equals(expected.indexes[n]) for n in expected.indexes)


def section(text: str, title: str) -> str:
    result = re.search(SECTION.format(title), text, re.DOTALL)
    return result[1] if result else ""


def arguments(item: Any) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for name, parameter in inspect.signature(item).parameters.items():
        if name == "self":
            continue
        kinds = [kind for kind in get_args(parameter.annotation) if is_typeddict(kind)]
        if not kinds:
            result[name] = parameter.annotation
        for kind in kinds:  # fields of ModelOptions are described there
            model = set(tb.ModelOptions.model_fields)
            result |= {key: of for key, of in kind.__annotations__.items() if key not in model}
    return result


def entry(text: str, name: str) -> str:
    """What a section says about an argument; several may be described together."""
    lines = text.split("\n")
    indent = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    reported, inside = [], False
    for line in lines:
        head = re.match(rf"\s{{{indent}}}([\w*][\w, *]*?)(?: :|$)", line)
        if head:
            inside = name in re.split(r",\s*", head[1].replace("*", "").strip())
        if inside:
            reported.append(line)
    return "\n".join(reported)


@pytest.mark.parametrize("item", [pytest.param(i, id=ident(i)) for i in PUBLIC])
def test_a_public_name_is_documented(item: Any) -> None:
    """What it takes or holds, with units, and an example that runs (the doctests do).

    A record, whose docstring says what it holds, needs no example: functions make it.
    """
    text = inspect.getdoc(item) or ""
    assert text, "no docstring"
    if inspect.isclass(item) and issubclass(item, Exception):
        return
    record = section(text, "Attributes")
    assert record or ">>>" in section(text, "Examples"), "no example"
    reported = record or section(text, "Parameters")
    for name, kind in arguments(item).items():
        output = entry(reported, name)
        assert output, f"{name} is not described"
        if "float" in str(kind):
            assert UNIT.search(output) or NAMED_UNIT.search(name), f"{name} has no unit"


def test_an_unknown_keyword_is_an_input_error_with_the_nearest_name(tmp_path: Path) -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    with pytest.raises(tb.InputError, match='"overwrit"; did you mean "overwrite"'):
        tb.save_bearing(bearing, tmp_path / "mine.toml", **{"overwrit": True})
    assert not [*tmp_path.iterdir()]


LIVE_REPORT = """
import sys
import thermobearing as tb
result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.2], cycles=1))
folder = result.save(sys.argv[1], figures=False)
result.report(folder, pdf=False, live=False)
print(*sys.modules)
"""


def test_a_report_of_a_result_in_memory_imports_no_reader_of_others(tmp_path: Path) -> None:
    command = [sys.executable, "-c", LIVE_REPORT, str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    modules = {name.partition(".")[2] for name in done.stdout.split() if "thermobearing." in name}
    assert {"reporting", "cyclic.report"} <= modules
    assert not modules & {"loading", "histories", "studies", "sequences", "identify"}
    assert (tmp_path / "out" / "report.html").is_file()
