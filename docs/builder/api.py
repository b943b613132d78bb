"""Pages of the API reference: a table of names for each room, a page for each public name.

The stubs beside the rooms (`__init__.pyi`) are the one list of public names.
"""

import ast
from pathlib import Path

import thermobearing

PACKAGE = Path(str(thermobearing.__file__)).parent
TOP = "thermobearing"


def public_names(stub: Path) -> dict[str, str]:
    """Names that a stub exports, `from .x import y as y`, in its order, with the file of each."""
    statements = ast.parse(stub.read_text(encoding="utf-8")).body
    imports = [line for line in statements if isinstance(line, ast.ImportFrom)]
    return {name.name: line.module or "" for line in imports for name in line.names}


def at_the_top(room: str) -> list[str]:
    """Names of a room that are at the top too, where their pages are."""
    inner = f"{room.removeprefix(f'{TOP}.')}."
    names = public_names(PACKAGE / room.removeprefix(f"{TOP}.") / "__init__.pyi")
    top = public_names(PACKAGE / "__init__.pyi")
    return [name for name, file in names.items() if top.get(name) == inner + file]


def rooms() -> dict[str, list[str]]:
    """Public names by the place of their page: the top, which names its rooms, and each room."""
    top = public_names(PACKAGE / "__init__.pyi")
    found = {TOP: [name for name, file in top.items() if file]}
    for room in (f"{TOP}.{name}" for name, file in top.items() if not file):
        names = public_names(PACKAGE / room.removeprefix(f"{TOP}.") / "__init__.pyi")
        found[room] = [name for name in names if name not in at_the_top(room)]
    return found


def room_page(room: str, names: list[str]) -> str:
    """What a room is for, and its names, each with a page of its own."""
    about = ast.get_docstring(ast.parse(_source(room).read_text(encoding="utf-8"))) or ""
    first = about.split("\n\n")[0].replace("\n", " ")
    lines = [room, "=" * len(room), "", first, "", f".. currentmodule:: {room}", ""]
    lines += [".. autosummary::", "   :toctree: names", "   :nosignatures:", ""]
    lines += [f"   {name}" for name in names]
    also = [] if room == TOP else at_the_top(room)
    if also:
        told = ", ".join(f":obj:`tb.{name} <{TOP}.{name}>`" for name in also)
        lines += ["", f"At the top too: {told}."]
    return "\n".join(lines) + "\n"


def index_page(places: list[str]) -> str:
    """The rooms in the order of the stub."""
    title = "Python interface"
    words = (
        "A dozen names are at the top, ``import thermobearing as tb``; the others are in rooms, "
        "such as ``tb.motions``. Numbers without a unit are in kN, mm, s and degC."
    )
    lines = [title, "=" * len(title), "", words, "", ".. toctree::", "   :maxdepth: 2", ""]
    return "\n".join(lines + [f"   {place}" for place in places]) + "\n"


def write_pages(folder: Path) -> None:
    """All pages, where they are not there already with the same words (Sphinx looks at dates)."""
    found = rooms()
    pages = {"index": index_page(list(found))}
    pages |= {room: room_page(room, names) for room, names in found.items()}
    folder.mkdir(exist_ok=True)
    for name, text in pages.items():
        path = folder / f"{name}.rst"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _source(room: str) -> Path:
    return PACKAGE.joinpath(*room.split(".")[1:], "__init__.py")
