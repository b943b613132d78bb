"""Banned words: `python -m docs.builder.vocabulary` (part of `make lint`), in texts and names.

Looks at string literals and docstrings of the package and of the reproduction, at data files, and
at the pages of the documentation that are not generated. CONTRIBUTING.md lists what to write
instead. Names of variables, parameters, functions and classes of the package that say nothing are
found too.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
BANNED = re.compile(
    r"\b(told|tells?|telling|beside|the print|the house|got through|gets? through|knows? no|"
    r"knows? nothing|energy books|blind to|what of|made[ -]up|stands? for itself|nobody's|"
    r"the source(?! of| file| code| distribution|s)|a hair|is asked of|judged anew|"
    r"worked rubber|one-directional)\b",
    re.IGNORECASE,
)
ALLOWED = re.compile(  # earlier names too
    r"""\bsource of\b|temperature-blind|[`"](?:--beside|tell)[`"]"""
)
EMPTY_NAMES = {
    *("found", "one", "ones", "known", "own", "given", "mine", "way", "ways", "said", "says"),
    *("held", "made", "told", "whole", "thing", "things"),
}
# Names that are left: fields of records, and sources whose edit needs new kernels.
EMPTY_NAMES_LEFT = {
    "bearing/new.py": {"given"},
    "core/compiled/tables.py": {"found"},
    "core/lanes/functions.py": {"one", "known"},
    "core/lanes/kinds.py": {"one"},
    "design/codes.py": {"says"},
    "design/peaks.py": {"says"},
    "design/sizing.py": {"found"},
    "identify/quofem.py": {"held"},
    "identify/uncertainty/bands.py": {"held"},
    "results/loop.py": {"found", "one"},
    "structure/frame.py": {"held", "ways"},
    "structure/model.py": {"own"},
    "studies/definition/record.py": {"whole"},
    "studies/result.py": {"things"},
    "studies/run/engine.py": {"made"},
    "studies/statistics/likelihood.py": {"known"},
    "tables/laboratory.py": {"given"},
}
SKIPPED = ("appendix", "api", "gallery")  # generated


def python_texts(path: Path) -> Iterator[tuple[int, str]]:
    """Give the string literals of a module with their lines."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            for k, line in enumerate(node.value.splitlines()):
                yield node.lineno + k, line


def file_texts(path: Path) -> Iterator[tuple[int, str]]:
    """Give the lines of a text."""
    yield from enumerate(path.read_text(encoding="utf-8").splitlines(), 1)


def empty_names(code: str) -> Iterator[tuple[int, str]]:
    """Yield the names in a module that say nothing, with their lines.

    >>> list(empty_names("def _found(given): own = 1; stiffness = own"))
    [(1, 'found'), (1, 'given'), (1, 'own')]
    """
    for node in ast.walk(ast.parse(code)):
        name = ""
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            name = node.id
        elif isinstance(node, ast.arg):
            name = node.arg
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name = node.name
        if name.strip("_").lower() in EMPTY_NAMES:
            yield node.lineno, name.strip("_").lower()


def findings() -> Iterator[str]:
    """Give a line for each banned word: file, line, word, text."""
    sources = [*ROOT.glob("src/**/*.py"), *ROOT.glob("reproduction/*.py")]
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]
    pages = [p for p in pages if not set(p.relative_to(ROOT).parts) & set(SKIPPED)]
    data = [*ROOT.glob("src/thermobearing/data/**/*.toml"), *ROOT.glob("src/**/data/**/*.md")]
    for path in [*sources, *pages, *data]:
        texts = python_texts(path) if path.suffix == ".py" else file_texts(path)
        for line, text in texts:
            for word in BANNED.finditer(ALLOWED.sub("", text)):
                yield f"{path.relative_to(ROOT)}:{line}: {word[0]!r} in {text.strip()[:90]!r}"

    package = ROOT / "src" / "thermobearing"
    for path in package.rglob("*.py"):
        place = path.relative_to(package).as_posix()
        for line, name in empty_names(path.read_text(encoding="utf-8")):
            if name not in EMPTY_NAMES_LEFT.get(place, ()):
                yield f"{path.relative_to(ROOT)}:{line}: the name {name!r} says nothing"


def main() -> None:
    """Print what was found; the exit status is 1 if there is anything."""
    lines = list(findings())
    for line in lines:
        print(line)
    print(f"{len(lines)} banned words")
    sys.exit(bool(lines))


if __name__ == "__main__":
    main()
