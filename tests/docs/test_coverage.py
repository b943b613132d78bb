"""docs/coverage.toml: every item of the source once, and every command in it can be given."""

import ast
import importlib.util
import inspect
import re
import shlex
import tomllib
import typing
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest
import typer

import thermobearing as tb
from docs import generate
from thermobearing.cli import app

ROOT = Path(__file__).parents[2]
ITEMS = generate.coverage_items()
COUNT = 109  # items of the first audit, whose numbers stay
KEYS = {"item", "source", "what", "run", "ours", "says", "verdict"}
TYPED = {"works", "partial", "outside", "later"}  # the other verdicts are those of the ledger
OF_THE_USER = {"CASE.toml", "TEST.toml", "TEST.csv"}


def nothing_wrong_with_command(words: list[str]) -> None:
    """The command is there, with these options and this number of arguments; files exist."""
    command: Any = typer.main.get_command(app)
    while hasattr(command, "commands"):
        command, words = command.commands[words[0]], words[1:]
    command = command.full
    context = command.context_class(command, info_name="thermobearing")
    options, others, _ = command.make_parser(context).parse_args(args=words)
    assert not others
    needed = {p.name for p in command.params if p.required}
    assert needed <= {name for name, value in options.items() if value}, words
    for name, value in options.items():
        for word in value if isinstance(value, (list, tuple)) else [value]:
            if isinstance(word, str) and word.endswith((".toml", ".csv")):
                assert word in OF_THE_USER or (ROOT / word).exists(), (name, word)


def nothing_wrong_with_test(word: str) -> None:
    path, _, name = word.partition("::")
    assert f"def {name}" in (ROOT / path).read_text()


def what_comes(node: ast.expr) -> Any:
    """A module, function or class that stands at a node; of a call, the class it returns."""
    if isinstance(node, ast.Name):
        assert node.id == "tb"
        return tb
    if isinstance(node, ast.Attribute):
        assert not node.attr.startswith("_")
        return attribute(what_comes(node.value), node.attr)
    assert isinstance(node, ast.Call), ast.dump(node)
    function = what_comes(node.func)
    assert {word.arg for word in node.keywords} <= keywords(function), ast.unparse(node)
    return function if inspect.isclass(function) else returned(function)


def keywords(function: Any) -> set[str]:
    """What a function takes by name, those of a TypedDict that it unpacks among them."""
    names = set()
    for given in inspect.signature(function).parameters.values():
        if given.kind is not given.VAR_KEYWORD:
            names.add(given.name)
            continue
        for options in typing.get_args(given.annotation):
            names |= getattr(options, "__annotations__", {}).keys()
    return names


def attribute(owner: Any, name: str) -> Any:
    """Of a module, or of what a class makes: a method, or the class of a property or field."""
    if inspect.isclass(owner) and name in getattr(owner, "model_fields", {}):
        return owner.model_fields[name].annotation
    if name == "plot" and getattr(owner, "_figures", ""):
        room = owner.__module__.rpartition(".")[0]
        return getattr(importlib.import_module(f"{room}.figures"), owner._figures)
    result = getattr(owner, name)
    if isinstance(result, cached_property):
        return returned(result.func)
    return returned(result.fget) if isinstance(result, property) else result


def returned(function: Any) -> Any:
    """The class that a function returns; views are imported for type checkers only."""
    views = f"{function.__module__.rpartition('.')[0]}.figures"
    there = importlib.util.find_spec(views) is not None
    known = dict(vars(importlib.import_module(views))) if there else {}
    return typing.get_type_hints(function, localns=known)["return"]


def nothing_wrong_with_python(line: str) -> None:
    tree = ast.parse(line, mode="eval")
    compile(tree, line, "eval")
    nodes = [n for n in ast.walk(tree) if isinstance(n, (ast.Call, ast.Attribute))]
    assert nodes
    for node in nodes:
        what_comes(node)


def nothing_wrong(run: str) -> None:
    first, *words = shlex.split(run) if not run.startswith("tb.") else [run]
    if first == "thermobearing":
        nothing_wrong_with_command(words)
    elif first == "pytest":
        nothing_wrong_with_test(*words)
    elif first == "python":
        assert words[0] == "-m"
        assert importlib.util.find_spec(words[1])
    else:
        nothing_wrong_with_python(run)


def test_every_item_is_there_once() -> None:
    assert [item["item"] for item in ITEMS] == list(range(1, COUNT + 1))
    for item in ITEMS:
        assert item.keys() - {"chapter", "ledger", "numbers"} == KEYS, item["item"]
        assert all(str(item[key]) for key in KEYS), item["item"]
        assert "|" not in "".join(str(item[key]) for key in KEYS), "it would end a cell"
        assert item["verdict"] in generate.VERDICTS, item["item"]


def test_numbers_and_verdicts_are_those_of_the_ledger() -> None:
    """An item with claims has no separate verdict; typed words have no result in them."""
    ledger = generate.load(generate.LEDGER)
    for item in tomllib.loads(generate.COVERAGE.read_text())["items"]:
        assert ("verdict" in item) != ("ledger" in item), item["item"]
        assert item.get("verdict", "works") in TYPED, item["item"]
        words = generate.NAMED.sub("", item.get("ours", ""))
        assert not re.search(r"\d\.\d{2}|\de-?\d", words.replace("1.25 h", "")), item["item"]
    shown = {item["item"]: item for item in ITEMS}
    for number, name in ((14, "table-3-4-rate-sines"), (104, "6-3-3-ductility-cold")):
        assert ledger[name]["verdict"] == shown[number]["verdict"] == "contradicted"
        assert ledger[name]["computed"] in shown[number]["ours"]
    assert shown[32]["verdict"] == "needs data"


def test_the_verdict_of_an_item_is_the_worst_of_its_claims() -> None:
    assert generate.coverage_verdict({"reproduced", "contradicted"}) == "contradicted"
    assert generate.coverage_verdict({"trend holds", "within 1 %"}) == "undecided"
    assert generate.coverage_verdict({"trend holds", "needs the test data"}) == "works"


@pytest.mark.parametrize("run", sorted({i["run"] for i in ITEMS if i["verdict"] != "later"}))
def test_every_command_can_be_given(run: str) -> None:
    nothing_wrong(run)


@pytest.mark.parametrize(
    "run",
    [
        "thermobearing hybird",
        "thermobearing hybrid --mod rt",
        "thermobearing hybrid CASE.toml more",
        "thermobearing validate shen-hdr-specimen",
        "thermobearing check src/thermobearing/data/bearings/none.toml",
        "pytest tests/verification/test_takeda.py::test_none",
        "python -m benchmarks.none",
        "tb.hybrid(",
        "tb.hybird()",
        "tb.hybrid(mode=1)",
        "tb.hybrid(geometry=1)",
        "tb.hybrid().plot.piers()",
        "tb.hybrid().plot._grid()",
    ],
)
def test_what_is_not_there_is_seen(run: str) -> None:
    with pytest.raises(Exception):  # noqa: B017, PT011 - whatever says no
        nothing_wrong(run)


def test_what_comes_later_is_not_there_yet() -> None:
    for run in [i["run"] for i in ITEMS if i["verdict"] == "later"]:
        with pytest.raises(KeyError):
            nothing_wrong(run)


def test_page_is_the_generated_one() -> None:
    folder = ROOT / "docs" / "appendix"
    page, rows = (folder / "coverage.md").read_text(), (folder / "coverage.csv").read_text()
    assert generate.coverage_texts(ITEMS) == (page, rows)
