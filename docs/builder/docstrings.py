"""How docstrings of this package become those that numpydoc reads.

Here an argument stands as "name : what it is [unit], and its range", which may go on in the next
lines. numpydoc takes all behind the colon for a type, in one line. So the words move below.
"""

import re
from typing import Any

SECTIONS = {"Parameters", "Attributes", "Returns", "Raises", "Yields", "Warns"}
ENTRY = re.compile(r"(?P<name>[\w*][\w*, .]*) : (?P<words>.+)")


def words_below_names(
    app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Change the lines of a docstring in place (an event of Sphinx)."""
    changed: list[str] = []
    inside = False
    for place, line in enumerate(lines):
        below = lines[place + 1] if place + 1 < len(lines) else ""
        if below.startswith("---"):
            inside = line.strip() in SECTIONS
        entry = ENTRY.fullmatch(line) if inside else None
        changed += [entry["name"], f"    {entry['words']}"] if entry else [line]
    lines[:] = changed


def setup(app: Any) -> dict[str, bool]:
    """Before numpydoc, whose priority is 500."""
    app.connect("autodoc-process-docstring", words_below_names, priority=400)
    return {"parallel_read_safe": True}
