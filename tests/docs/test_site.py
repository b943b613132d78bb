"""The site: blocks of tutorial and how-tos run, examples draw, every name has a page."""

import ast
import contextlib
import io
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from urllib.parse import parse_qsl

import matplotlib.pyplot as plt
import pytest
from matplotlib.figure import Figure

import thermobearing as tb
from docs.builder import api, docstrings, figures, links, outputs, pictures
from tests.opensees import needs_opensees
from tests.unit.inputs import command
from thermobearing.bearing.library import list_bearings
from thermobearing.border.library import data_path

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = [DOCS / "index.md", *sorted((DOCS / "guide").glob("[!i]*.md"))]
EXAMPLES = sorted((DOCS / "examples").glob("plot_*.py"))
SCREENS = 180  # lines of a how-to
QUICK = "index", "problems"  # pages whose blocks `make test` runs
QUICK_EXAMPLES = "plot_01_loops", "plot_16_structure"
MARKS = {name: [needs_opensees] for name in ("opensees", "opensees_space", "simcenter")}


def pages(paths: list[Path], quick: tuple[str, ...]) -> list[Any]:
    """Return files as cases, all but those of some names with the mark `thorough`."""
    return [
        pytest.param(
            path,
            id=path.stem,
            marks=[
                *MARKS.get(path.stem, []),
                *([] if path.stem in quick else [pytest.mark.thorough]),
            ],
        )
        for path in paths
    ]


@pytest.fixture(autouse=True)
def _no_figures() -> None:
    """Close figures of other pages: what draws into the current one would draw there."""
    plt.close("all")


def no_histories(*_: Any) -> None:
    """In place of the samples of studies, half the time of their commands; tested elsewhere."""


@pytest.mark.parametrize("path", pages(GUIDE, QUICK))
def test_every_block_of_a_page_runs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr(
        "thermobearing.earthquake.result.EarthquakeResult._write_histories", no_histories
    )
    draw = bool(pictures.page_pictures(path))
    with pictures.recorded() as shown:
        for block, printed in outputs.run(path, {"__name__": "page"}, command, draw=draw):
            lines = [line.rstrip() for line in printed.splitlines()]
            missing = [row for row in block["text"].splitlines() if row not in lines]
            assert not missing, f"{path.name} shows what is not printed: {missing}"
    message = pictures.outdated(pictures.shown_by_page(path, shown))
    assert not message, message


def test_a_how_to_is_short() -> None:
    lines = {path.stem: path.read_text(encoding="utf-8").count("\n") for path in GUIDE}
    del lines["index"], lines["tutorial"]
    assert max(lines.values()) <= SCREENS, lines


@pytest.mark.parametrize("path", pages(EXAMPLES, QUICK_EXAMPLES))
def test_an_example_draws(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    lines = path.read_text(encoding="utf-8").split("# %%")
    names: dict[str, Any] = {"__name__": "example"}
    drawn = 0
    with contextlib.redirect_stdout(io.StringIO()):
        for part in filter(lambda part: ast.parse(part).body, lines):  # some have text only
            drawn += isinstance(dotted_value(part, path.name, names), Figure)
    assert drawn >= 1


def test_examples_open_the_live_page_in_views_that_it_has() -> None:
    page = data_path("live", "page.html").read_text(encoding="utf-8")
    views = set(re.findall(r'data-views="(\w+)"', page))
    states = [
        dict(parse_qsl(fragment))
        for path in EXAMPLES
        for fragment in re.findall(r"bearing\.html#([^\"]+)", path.read_text(encoding="utf-8"))
    ]
    assert {state.get("view", "test") for state in states} == {"test", "bridge", "codes"} <= views
    assert {state["base"] for state in states} <= set(list_bearings())


def dotted_value(text: str, name: str, names: dict[str, Any]) -> Any:
    """The value of the last line of a part, as a notebook shows it; None without one."""
    *body, last = ast.parse(text).body
    exec(compile(ast.Module(body, []), name, "exec"), names)
    if not isinstance(last, ast.Expr):
        exec(compile(ast.Module([last], []), name, "exec"), names)
        return None
    return eval(compile(ast.Expression(last.value), name, "eval"), names)


def test_a_dozen_examples_and_a_page_for_each_name() -> None:
    assert len(EXAMPLES) >= 12
    listed = [name for _, names in api.groups() for name in names]
    modules = {"laws": tb.laws, "opensees": tb.opensees}
    inside = [f"{module}.{name}" for module in modules for name in modules[module].__all__]
    assert sorted(listed) == sorted({*tb.__all__} - {*modules} | {*inside})
    assert all(f"   {name}\n" in api.names_page() for name in listed)


PAGE = '<html><body><p class="edition">x 1.0, built today</p><h1 id="a">A</h1>{}</body></html>'


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ('<a href="two.html#b">b</a> <a href="#a">a</a> <a href="https://x.org/y">y</a>', None),
        ('<a href="two.html#c">b</a>', "two.html#c"),
        ('<a href="three.html">b</a>', "three.html"),
        ('<img src="figure.png">', "figure.png"),
        ('<script src="https://x.org/y.js"></script>', "https://x.org/y.js"),
    ],
)
def test_links_of_a_built_site_are_checked(tmp_path: Path, body: str, fault: str | None) -> None:
    (tmp_path / "one.html").write_text(PAGE.format(body))
    (tmp_path / "two.html").write_text(PAGE.format('<a id="b"></a>'))
    result = links.faults(tmp_path, "1.0")
    assert (result == []) if fault is None else (len(result) == 1 and fault in result[0])


def test_a_page_without_version_is_reported(tmp_path: Path) -> None:
    (tmp_path / "one.html").write_text(PAGE.format("").replace("1.0", "0.9"))
    assert "version" in links.faults(tmp_path, "1.0")[0]


def test_the_gallery_saves_what_a_block_returns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gallery = SimpleNamespace(figure_rst=lambda paths, folder: f"{paths[0]} in {folder}")
    monkeypatch.setitem(sys.modules, "sphinx_gallery.scrapers", gallery)
    names: dict[str, Any] = {"___": Figure()}
    picture = tmp_path / "a.png"
    variables = {"example_globals": names, "image_path_iterator": iter([str(picture)])}
    text = figures.returned_figures((), variables, {"src_dir": "there"})
    assert text == f"{picture} in there"
    assert picture.stat().st_size > 0
    assert figures.returned_figures((), variables, {"src_dir": "there"}) == ""


def test_words_of_a_docstring_move_below_the_name() -> None:
    lines = [
        "Parameters",
        "----------",
        "dt : step [s],",
        "    > 0.",
        "",
        "Notes",
        "-----",
        "a : b",
    ]
    docstrings.words_below_names(None, "function", "f", None, None, lines)
    assert lines[2:5] == ["dt", "    step [s],", "    > 0."]
    assert lines[-1] == "a : b"


def test_numbered_formulas_are_single_lines() -> None:
    """MathJax refuses a number in the environment that Sphinx makes of several lines."""
    for path in sorted(DOCS.glob("*.md")):
        for block in outputs.blocks(path):
            if block["language"] == "math" and "\\tag" in block["text"]:
                assert "\\\\" not in block["text"], f"{path.name}: {block['text']}"


def test_opensees_and_bridge_agree_on_the_pier_of_the_guide() -> None:
    page = (DOCS / "guide" / "opensees.md").read_text(encoding="utf-8")
    served = re.search(r"^ +2 +([\d.]+) +([\d.]+) +\S+\npier top ([\d.]+) mm", page, re.MULTILINE)
    bridge = re.search(r"^([\d.]+)% of (\d+) mm, ([\d.]+) kN, pier top ([\d.]+) mm", page, re.M)
    assert served
    assert bridge
    strain, thickness, force, top = map(float, bridge.groups())
    expected = [strain * thickness / 100, force, top]
    assert [float(text) for text in served.groups()] == pytest.approx(expected, rel=1e-3)
