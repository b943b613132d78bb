"""Patterns of the package on long hostile texts: none needs time that grows with their square.

Compiled patterns are taken from the modules, those of calls such as `re.sub` and of fields from
the source; each is tried as it is used, by a match at the begin or by a search.
"""

import ast
import importlib
import pkgutil
import re
import signal
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple

import pytest

import thermobearing as tb
from tests.unit import inputs
from thermobearing.border.schema import LONGEST_TEXT, Strict, validated
from thermobearing.border.units import split_quantity

LENGTH = 20_000
PROCESSOR_LIMIT = 5.0  # [s] of all texts; the slowest pattern needs below 0.3
UNITS = ("1", "1.", "1,", "1e", "0", " ", "\n", "a", "a ", "a.", "a_", "a=1 ", "-", '"', "[")
TEXTS = [unit * (LENGTH // len(unit)) + "!" for unit in UNITS]
SEARCHES = {"search", "sub", "subn", "split", "findall", "finditer"}
MATCHES = {"match", "fullmatch"}
PACKAGE = Path(tb.__file__).parent
# Patterns that a call builds, by their function, and why no text of a file makes them slow.
BUILT = {
    ("motions/run.py", "_reference"): "STANDARD, which is tried, and digits",
    ("report/figures.py", "picture_size"): "a constant name, on 4 kB",
    ("commands/common.py", "_as_options"): "names of parameters, on a message",
    ("commands/descriptions.py", "_help_text"): "names of parameters, on docstrings of the package",
    ("report/content.py", "_verdict"): "words of the package, on warnings",
}


class Tried(NamedTuple):
    """A pattern, its place, and whether texts are searched for it."""

    place: str
    pattern: re.Pattern[Any]
    searched: bool


class Scan(NamedTuple):
    """What the source of the package says about its patterns."""

    inline: list[Tried]
    built: set[tuple[str, str]]  # file and function
    compiled: set[tuple[str, str]]  # files and functions with re.compile, "" for a module
    searched: set[tuple[str, str]]  # files and names of patterns with a search


@cache
def scan() -> Scan:
    """Read all patterns in the source."""
    inline, built, compiled, searched = [], set(), set(), set()
    for file in sorted(PACKAGE.rglob("*.py")):
        name = file.relative_to(PACKAGE).as_posix()
        nodes: list[tuple[ast.AST, str]] = [(ast.parse(file.read_text(encoding="utf-8")), "")]
        while nodes:
            node, function = nodes.pop()
            function = node.name if isinstance(node, ast.FunctionDef) else function
            nodes += [(child, function) for child in ast.iter_child_nodes(node)]
            if not isinstance(node, ast.Call):
                continue
            text = next((k.value for k in node.keywords if k.arg == "pattern"), None)
            method = ""
            if isinstance(node.func, ast.Attribute):
                owner, method = ast.unparse(node.func.value).split(".")[-1], node.func.attr
                if owner == "re" and method == "compile":
                    compiled.add((name, function))
                elif owner == "re" and method in SEARCHES | MATCHES:
                    text = node.args[0]
                elif method in SEARCHES:
                    searched.add((name, owner))
            if text is None:
                continue
            if isinstance(text, ast.Constant) and isinstance(text.value, str | bytes):
                pattern = re.compile(text.value)
                inline.append(Tried(f"{name}:{node.lineno}", pattern, method not in MATCHES))
            else:
                built.add((name, function))
    return Scan(inline, built, compiled, searched)


def held(value: Any) -> Iterator[re.Pattern[Any]]:
    """Yield the patterns in a value, at any depth of collections."""
    if isinstance(value, re.Pattern):
        yield value
    elif isinstance(value, dict | list | tuple):
        for item in value.values() if isinstance(value, dict) else value:
            yield from held(item)


@cache
def compiled_patterns() -> list[Tried]:
    """Return the patterns that modules hold, alone or in a collection."""
    searched, patterns = scan().searched, {}
    for module in pkgutil.walk_packages(tb.__path__, "thermobearing."):
        if "__main__" in module.name:
            continue
        if module.name.endswith("verify.finite_elements") and not find_spec("skfem"):
            continue  # it has no patterns
        for name, value in vars(importlib.import_module(module.name)).items():
            file = module.name.partition(".")[2].replace(".", "/")
            # Those of a collection have the names of loops where they are used.
            search = not isinstance(value, re.Pattern) or bool(
                {(f"{file}.py", name), (f"{file}/__init__.py", name)} & searched
            )
            for item in held(value):
                search = search or (item in patterns and patterns[item].searched)
                patterns[item] = Tried(f"{module.name}.{name}", item, search)
    return list(patterns.values())


def test_every_pattern_of_the_source_is_tried() -> None:
    result = scan()
    assert result.built == set(BUILT)
    assert len(result.inline) > 30
    # A pattern that a function compiles is in no module.
    assert {function for _, function in result.compiled} == {""}
    assert len(compiled_patterns()) > 50


class TooSlowError(Exception):
    """The processor time is used up."""


def stop(number: int, frame: FrameType | None) -> None:
    """Handle the signal of the timer, which the engine of `re` looks for as it matches."""
    raise TooSlowError


def slow_ones(tried: Iterable[Tried]) -> list[str]:
    """Return the patterns that need more than the limit."""
    slow, before = [], signal.signal(signal.SIGVTALRM, stop)
    try:
        for place, pattern, searched in tried:
            signal.setitimer(signal.ITIMER_VIRTUAL, PROCESSOR_LIMIT)
            try:
                for text in TEXTS:
                    subject = text if isinstance(pattern.pattern, str) else text.encode()
                    pattern.match(subject)
                    pattern.fullmatch(subject)
                    if searched:
                        pattern.search(subject)
            except TooSlowError:
                slow.append(f"{place}: {pattern.pattern!r}")
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)
    return slow


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timer of processor time")
def test_no_pattern_needs_quadratic_time() -> None:
    assert slow_ones([*compiled_patterns(), *scan().inline]) == []


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timer of processor time")
def test_a_slow_pattern_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules[__name__], "PROCESSOR_LIMIT", 0.05)
    pattern = re.compile(r"\d+\.?\d*x")
    assert len(slow_ones([Tried("a", pattern, searched=True)])) == 1


def repeats(pattern: str | bytes) -> list[str]:
    """Return repetitions in others, both without a limit, in which a text fits in many ways."""
    parser = re._parser  # type: ignore[attr-defined]  # the parser of `re` has no other door
    endless = {parser.MAX_REPEAT, parser.MIN_REPEAT}
    nested: list[str] = []

    def _walk(items: Any, *, inside: bool) -> None:
        """Examine a sequence; `inside` one that is repeated and may consist of one item of it."""
        for item in items:
            code, argument = item
            # One item can be all of the sequence if the others may be empty.
            width = parser.SubPattern(items.state, [item]).getwidth()[0]
            whole = inside and items.getwidth()[0] == width
            if code in endless:
                _, high, body = argument
                many = high == parser.MAXREPEAT
                if many and whole:
                    nested.append(str(body))
                _walk(body, inside=many)
            elif code == parser.SUBPATTERN:
                _walk(argument[-1], inside=whole)
            elif code == parser.BRANCH:
                for branch in argument[1]:
                    _walk(branch, inside=whole)
            elif code in (parser.ASSERT, parser.ASSERT_NOT):
                _walk(argument[1], inside=False)

    _walk(parser.parse(pattern), inside=False)
    return nested


def test_no_pattern_has_nested_quantifiers() -> None:
    assert [len(repeats(text)) for text in (r"(a+)+", r"(?:\d+|b)*", r"(\s*a*)*")] == [1, 1, 2]
    assert [repeats(text) for text in (r"(?:a+b)+", r"(?:a++)*+", r"(a{1,3})+")] == [[], [], []]
    tried = [*compiled_patterns(), *scan().inline]
    assert [item.place for item in tried if repeats(item.pattern.pattern)] == []


@pytest.mark.parametrize("text", ["1" * 10_000, "1." * 5000, "1e" * 5000, "1 " * 5000 + "!"])
def test_one_parser_of_numbers_with_units(text: str) -> None:
    assert split_quantity(text) is None
    assert [split_quantity(item) for item in ("-2.5e3 kN/mm", ".5", " 7mm ", "x", "")] == [
        ("-2.5e3", "kN/mm"), (".5", ""), ("7", "mm"), None, None
    ]  # fmt: skip


def test_no_other_pattern_spells_a_number() -> None:
    spelled = [
        file.relative_to(PACKAGE).as_posix()
        for file in sorted(PACKAGE.rglob("*.py"))
        if re.search(r"\\d[+*](?:\(\?:)?\\\.\??\\d[*+]", file.read_text(encoding="utf-8"))
    ]
    assert spelled == ["border/units.py"]


def test_texts_of_a_file_have_a_limit() -> None:
    class Described(Strict):
        description: str = ""
        titles: dict[str, str] = {}  # noqa: RUF012

    longest = "x" * LONGEST_TEXT
    assert validated(Described, {"description": longest}, "t").description == longest
    for table in ({"description": longest + "x"}, {"titles": {"a": longest + "x"}}):
        inputs.assert_refused(
            lambda table=table: validated(Described, table, "t"), f"at most {LONGEST_TEXT} char"
        )
