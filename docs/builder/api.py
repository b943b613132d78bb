"""Pages of the API reference: a table of the public names, a page for each of them.

The stub `__init__.pyi` is the one list of public names.
"""

import ast
from itertools import groupby
from pathlib import Path

import thermobearing

PACKAGE = Path(str(thermobearing.__file__)).parent
TOP = "thermobearing"


def groups() -> list[tuple[str, list[str]]]:
    """Public names by the sub-package or module that they come from, as its docstring calls it."""
    statements = ast.parse((PACKAGE / "__init__.pyi").read_text(encoding="utf-8")).body
    imports = [line for line in statements if isinstance(line, ast.ImportFrom)]
    names = [((line.module or "").split(".")[0], line.names[0].name) for line in imports]
    grouped = groupby(names, key=lambda place_and_name: place_and_name[0])
    return [(_title(place), [name for _, name in each]) for place, each in grouped]


def names_page() -> str:
    """All public names, each with a page of its own."""
    lines = [TOP, "=" * len(TOP), "", f".. currentmodule:: {TOP}", ""]
    for title, names in groups():
        lines += [title, "-" * len(title), "", ".. autosummary::", "   :toctree: names"]
        lines += ["   :nosignatures:", "", *(f"   {name}" for name in names), ""]
    return "\n".join(lines)


def index_page() -> str:
    """What the interface is."""
    title = "Python interface"
    words = (
        "``import thermobearing as tb`` gives these names; other modules may change without "
        "notice. Numbers without a unit are in kN, mm, s and degC."
    )
    head = [title, "=" * len(title), "", words, "", ".. toctree::", "   :maxdepth: 2", ""]
    return "\n".join([*head, f"   {TOP}"]) + "\n"


def write_pages(folder: Path) -> None:
    """All pages, where they are not there already with the same words (Sphinx looks at dates)."""
    folder.mkdir(exist_ok=True)
    for name, text in {"index": index_page(), TOP: names_page()}.items():
        path = folder / f"{name}.rst"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _title(place: str) -> str:
    """The first clause of the docstring of a sub-package or module."""
    source = PACKAGE / place / "__init__.py"
    source = source if source.exists() else PACKAGE / f"{place}.py"
    about = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) or place
    return about.split("\n")[0].split(":")[0].rstrip(".")
