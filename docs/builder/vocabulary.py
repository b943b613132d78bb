"""Banned words in text that users read: `python -m docs.builder.vocabulary` (part of `make lint`).

Looks at string literals and docstrings of the package and of the reproduction, at data files, and
at the pages of the documentation that are not generated. CONTRIBUTING.md lists what to write
instead.
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
ALLOWED = re.compile(r"\bsource of\b|temperature-blind|`--beside`|`tell`")  # earlier names too
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


def main() -> None:
    """Print what was found; the exit status is 1 if there is anything."""
    found = list(findings())
    for line in found:
        print(line)
    print(f"{len(found)} banned words")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
