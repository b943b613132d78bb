"""Pages of the API reference: a table of the public names, a page for each of them.

The stub `__init__.pyi` is the one list of public names.
"""

import ast
from pathlib import Path

import thermobearing

# Headings of the page of names, by the place where a name is defined.
TITLES = {
    "cyclic": "Cyclic tests",
    "earthquake": "Bridges in earthquakes, hybrid tests",
    "bearing": "Bearings",
    "laws": "Laws of your own",
    "structure": "Structures",
    "motions": "Ground motions",
    "climate": "Weather",
    "intake": "Inspection of laboratory files",
    "identify": "Test records and calibration",
    "validate": "Validation",
    "design": "Design, temperature factors and bounds",
    "studies": "Parameter studies",
    "sequences": "Sequences of tests",
    "model": "Model options, and the bearing as an element",
    "results": "Cycles and figures",
    "loading": "Saved results",
    "opensees": "Elements of OpenSees models",
    "live": "Live page",
    "reporting": "Reports",
    "tables": "Tables of numbers",
    "border": "Errors",
}
PACKAGE = Path(str(thermobearing.__file__)).parent
TOP = "thermobearing"


def groups() -> list[tuple[str, list[str]]]:
    """Return the public names under a heading for each sub-package or module."""
    statements = ast.parse((PACKAGE / "__init__.pyi").read_text(encoding="utf-8")).body
    imports = [line for line in statements if isinstance(line, ast.ImportFrom)]
    names = [((line.module or "").split(".")[0], line.names[0].name) for line in imports]
    names = [
        entry for place, name in names for entry in ([(place, name)] if place else _inside(name))
    ]
    unknown = {place for place, _ in names} - set(TITLES)
    if unknown:
        raise ValueError(f"docs/builder/api.py has no heading for {', '.join(sorted(unknown))}")
    return [(title, [n for at, n in names if at == place]) for place, title in TITLES.items()]


def _inside(module: str) -> list[tuple[str, str]]:
    """Return the public names of a public module."""
    return [(module, f"{module}.{name}") for name in getattr(thermobearing, module).__all__]


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
