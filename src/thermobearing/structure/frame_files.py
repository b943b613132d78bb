"""Plane frames from tables of nodes and members, in text files and workbooks."""

import re
from collections.abc import Iterator
from pathlib import Path

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.units import conversion
from thermobearing.structure.fields import GROUND
from thermobearing.structure.frame import WAYS, Element, Frame, ImportedFrame, Node
from thermobearing.tables.columns import name_and_unit, plain_title, plain_unit, read_number
from thermobearing.tables.text import Row, Sheet, read_sheets

FIXED = "fixed"
MOST = 1e24  # of a number: 1 m^4 is 1e12 mm^4
# Columns of the parts of a table: words, and numbers with their units.
COLUMNS: dict[str, tuple[tuple[str, ...], dict[str, str]]] = {
    "nodes": (("node",), {"x": "m", "z": "m", "mass": "t", "inertia": "t m^2"}),
    "members": (("from", "to"), {"e": "kN/m^2", "a": "m^2", "i": "m^4"}),
    "supports": (("node",), {"x": "kN/m", "z": "kN/m", "rotation": "kN m/rad"}),
    "bearings": (("bearing", "lower", "upper", "count"), {"stiffness": "kN/m"}),
}
NEEDED = {"x", "z", "stiffness"}  # numbers of nodes and bearings that may not be empty
COUNT = re.compile(r"[1-9]\d{0,3}")
FORM = (
    "the parts nodes, members, supports and bearings each follow a line (or are in a sheet) of "
    "that name, and begin with a line of titles such as x [m]"
)


SCRIPTS = (".py", ".tcl")
WRITE_A_TABLE = (
    "is a script, and only tables (CSV, .xlsx) are imported; run it in openseespy, and let "
    "write_frame of docs/examples/frame_table.py write the table of its model"
)


def _split_parts(sheets: list[Sheet]) -> dict[str, tuple[Sheet, list[Row]]]:
    """Return the rows of each part of a table, with its sheet."""
    parts: dict[str, tuple[Sheet, list[Row]]] = {}
    for sheet in sheets:
        part = plain_title(sheet.name)
        for line, row in sheet.rows:
            cells = [cell.strip() for cell in row if cell.strip()]
            if len(cells) == 1 and plain_title(cells[0]) in COLUMNS:
                part = plain_title(cells[0])
            elif part in COLUMNS:
                parts.setdefault(part, (sheet, []))[1].append((line, row))
            elif not sheet.name:
                raise InputError(f'line {line}: "{shortened(cells[0])}" belongs to no part; {FORM}')
    if missing := COLUMNS.keys() - parts:
        raise InputError(f"has no part {' and no part '.join(sorted(missing))}; {FORM}")
    return parts


def _read_part(
    part: str, sheet: Sheet, rows: list[Row]
) -> Iterator[tuple[str, dict[str, str], list[float]]]:
    """Yield the line, the cells and the numbers of each row of a part; empty numbers are zero."""
    words, wanted = COLUMNS[part]
    (line, titles), *body = rows
    columns: dict[str, tuple[int, float]] = {}
    for k, title in enumerate(titles):
        name, unit = name_and_unit(title)
        name = plain_title(name)
        if name in columns:
            raise InputError(f'line {line}: column "{title}" appears twice')
        if name in words or (name in wanted and unit):
            scale = conversion(plain_unit(unit), wanted[name])[0] if name in wanted else 1.0
            columns[name] = k, scale
        elif title.strip():
            expected = [*words, *(f"{column} [{unit}]" for column, unit in wanted.items())]
            fault = "has no unit" if name in wanted else "is not known"
            raise InputError(f'line {line}: column "{title}" {fault}{nearest(title, expected)}')
    needed = [*words, *(column for column in wanted if column not in ("mass", "inertia"))]
    if missing := [column for column in needed if column not in columns]:
        hint = nearest(missing[0], titles)
        raise InputError(f"line {line}: {part} have no column {missing[0]}{hint}")
    for line, row in body:
        where = f"line {line}" + (f' of sheet "{sheet.name}"' if sheet.name else "")
        cells = {
            column: row[k].strip() if k < len(row) else "" for column, (k, _) in columns.items()
        }
        numbers = []
        for column in wanted:
            text = cells.get(column, "")
            required = part in ("nodes", "bearings") and column in NEEDED
            if (not text and not required) or (text.lower() == FIXED and part == "supports"):
                text = "0"
            try:
                scale = columns.get(column, (0, 1.0))[1]
                numbers.append(read_number(sheet.plain(text), MOST) * scale)
            except InputError as error:
                raise InputError(error.lines(f"{where}, {column}")) from None
        yield where, cells, numbers


def _read_table(path: Path) -> Frame:
    """Return the frame of a table."""
    split = _split_parts(read_sheets(path))
    parts = {part: list(_read_part(part, *sheet_rows)) for part, sheet_rows in split.items()}
    nodes: dict[str, Node] = {}
    for line, cells, (x, z, mass, inertia) in parts["nodes"]:
        if (name := cells["node"]) in (*nodes, "", GROUND):
            raise InputError(f'{line}: node "{name}" is empty, repeated, or the ground')
        nodes[name] = Node(x, z, (mass, mass, inertia), line)
    elements, fixed, ties = [], {}, []
    lines_of_members: dict[frozenset[str], str] = {}
    for line, cells, numbers in parts["members"]:
        ends, elastic = (cells["from"], cells["to"]), any(numbers)
        if elastic and not min(numbers) > 0.0:
            raise InputError(f"{line}: E, A and I must be positive, or empty for a rigid member")
        law = (numbers[0] * numbers[1], numbers[0] * numbers[2]) if elastic else None
        earlier = lines_of_members.setdefault(frozenset(ends), line)
        if earlier != line:
            raise InputError(f"{line}: the member {'-'.join(ends)} repeats that of {earlier}")
        elements.append(Element(f"member {'-'.join(ends)}", ends, law, line))
    for line, cells, numbers in parts["supports"]:
        if (name := cells["node"]) in fixed:
            raise InputError(f'{line}: node "{name}" has two supports')
        fixed[name] = tuple(cells[direction].lower() == FIXED for direction in WAYS)
        if any(numbers):
            elements.append(Element(f"support of {name}", (GROUND, name), tuple(numbers), line))
    for line, cells, (stiffness,) in parts["bearings"]:
        ends, count = (cells["lower"], cells["upper"]), cells["count"]
        if not (COUNT.fullmatch(count) and stiffness > 0.0):
            raise InputError(f"{line}: count must be an integer and stiffness positive")
        shear = int(count) * stiffness, 0.0, 0.0
        elements.append(Element(cells["bearing"], ends, shear, line, int(count)))
        ties.append((*ends, WAYS.index("z")))
    return Frame(str(path), nodes, elements, fixed, ties)


@checked
def import_frame(file: str | Path) -> ImportedFrame:
    r"""Import a plane frame of piers and decks as a structure, and compare its periods.

    Parameters
    ----------
    file : str or Path
        Table of nodes, members, supports and bearings (CSV or `.xlsx`), with the units in its
        titles. docs/examples/frame_table.py has a function that writes the table of a model
        in OpenSees.

    Returns
    -------
    ImportedFrame
        The structure with its modes, those of the frame, and warnings about the differences.

    Raises
    ------
    InputError
        Faults in the file with their lines, or a frame that is not of cantilever piers and decks.

    Examples
    --------
    >>> import tempfile
    >>> table = [
    ...     *("nodes", "node, x [m], z [m], mass [t]", "1,0,0,", "2,0,10,120", "3,0,10,600"),
    ...     *("members", "from, to, E [GPa], A [m^2], I [m^4]", "1,2,25,9,1.5"),
    ...     *("supports", "node, x [kN/m], z [kN/m], rotation [kN m/rad]", "1,fixed,fixed,fixed"),
    ...     *("bearings", "bearing, lower, upper, count, stiffness [kN/mm]", "G,2,3,6,2.5"),
    ... ]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "pier.csv"
    ...     _ = path.write_text("\n".join(table))
    ...     imported = import_frame(path)
    >>> imported.periods[["period_s", "frame_period_s"]].round(3).to_numpy().tolist()
    [[1.34, 1.34], [0.192, 0.192]]
    """
    path = Path(file)
    try:
        if path.suffix.lower() in SCRIPTS:
            raise InputError(WRITE_A_TABLE)
        return ImportedFrame(_read_table(path))
    except InputError as error:
        raise error.located(path) from None
