"""Plane frames from files: tables of nodes and members, and scripts of OpenSees in Tcl or Python.

Scripts are read, never executed: commands of plane models with numbers, constants and arithmetic.
"""

import math
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.units import conversion
from thermobearing.structure.frame import WAYS, Element, Frame, ImportedFrame, Node
from thermobearing.structure.model import GROUND
from thermobearing.tables.columns import name_and_unit, plain_title, plain_unit, read_number
from thermobearing.tables.text import Row, Sheet, read_sheets, read_text

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


def _split_parts(sheets: list[Sheet]) -> dict[str, tuple[Sheet, list[Row]]]:
    """Return the rows of each part of a table, with its sheet."""
    found: dict[str, tuple[Sheet, list[Row]]] = {}
    for sheet in sheets:
        part = plain_title(sheet.name)
        for line, row in sheet.rows:
            held = [cell.strip() for cell in row if cell.strip()]
            if len(held) == 1 and plain_title(held[0]) in COLUMNS:
                part = plain_title(held[0])
            elif part in COLUMNS:
                found.setdefault(part, (sheet, []))[1].append((line, row))
            elif not sheet.name:
                raise InputError(f'line {line}: "{shortened(held[0])}" belongs to no part; {FORM}')
    if missing := COLUMNS.keys() - found:
        raise InputError(f"has no part {' and no part '.join(sorted(missing))}; {FORM}")
    return found


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
            known = [*words, *(f"{one} [{unit}]" for one, unit in wanted.items())]
            fault = "has no unit" if name in wanted else "is not known"
            raise InputError(f'line {line}: column "{title}" {fault}{nearest(title, known)}')
    needed = [*words, *(one for one in wanted if one not in ("mass", "inertia"))]
    if missing := [one for one in needed if one not in columns]:
        hint = nearest(missing[0], titles)
        raise InputError(f"line {line}: {part} have no column {missing[0]}{hint}")
    for line, row in body:
        where = f"line {line}" + (f' of sheet "{sheet.name}"' if sheet.name else "")
        cells = {one: row[k].strip() if k < len(row) else "" for one, (k, _) in columns.items()}
        numbers = []
        for one in wanted:
            text, full = cells.get(one, ""), part in ("nodes", "bearings") and one in NEEDED
            if (not text and not full) or (text.lower() == FIXED and part == "supports"):
                text = "0"
            try:
                numbers.append(read_number(sheet.plain(text), MOST) * columns.get(one, (0, 1.0))[1])
            except InputError as error:
                raise InputError(error.lines(f"{where}, {one}")) from None
        yield where, cells, numbers


def _read_table(path: Path) -> Frame:
    """Return the frame of a table."""
    split = _split_parts(read_sheets(path))
    parts = {part: list(_read_part(part, *some)) for part, some in split.items()}
    nodes: dict[str, Node] = {}
    for line, cells, (x, z, mass, inertia) in parts["nodes"]:
        if (name := cells["node"]) in (*nodes, "", GROUND):
            raise InputError(f'{line}: node "{name}" is empty, repeated, or the ground')
        nodes[name] = Node(x, z, (mass, mass, inertia), line)
    elements, held, ties = [], {}, []
    for line, cells, numbers in parts["members"]:
        ends, elastic = (cells["from"], cells["to"]), any(numbers)
        if elastic and not min(numbers) > 0.0:
            raise InputError(f"{line}: E, A and I must be positive, or empty for a rigid member")
        law = (numbers[0] * numbers[1], numbers[0] * numbers[2]) if elastic else None
        elements.append(Element(f"member {'-'.join(ends)}", ends, law, line))
    for line, cells, numbers in parts["supports"]:
        if (name := cells["node"]) in held:
            raise InputError(f'{line}: node "{name}" has two supports')
        held[name] = tuple(cells[way].lower() == FIXED for way in WAYS)
        if any(numbers):
            elements.append(Element(f"support of {name}", (GROUND, name), tuple(numbers), line))
    for line, cells, (stiffness,) in parts["bearings"]:
        ends, count = (cells["lower"], cells["upper"]), cells["count"]
        if not (COUNT.fullmatch(count) and stiffness > 0.0):
            raise InputError(f"{line}: count must be an integer and stiffness positive")
        shear = int(count) * stiffness, 0.0, 0.0
        elements.append(Element(cells["bearing"], ends, shear, line, int(count)))
        ties.append((*ends, WAYS.index("z")))
    return Frame(str(path), nodes, elements, held, ties)


COMMENT = re.compile(r"(?:^|(?<=[\s;]))#.*")
ADVICE = (
    "scripts are read command by command, with numbers and constants; write the model without "
    "loops, functions and arithmetic, or as a table of nodes and members (CSV, .xlsx)"
)
USAGE = {
    "model": "basic -ndm 2 -ndf 3 (plane models only)",
    "node": "TAG X Y [-mass MX MY MR]",
    "mass": "NODE MX MY MR",
    "fix": "NODE 0|1 0|1 0|1",
    "uniaxialMaterial": "TYPE TAG NUMBERS",
    "geomTransf": "TYPE TAG (without offsets)",
    "element": "elasticBeamColumn TAG NODE NODE A E I TRANSFORMATION [-mass M], or zeroLength TAG "
    "NODE NODE -mat TAGS -dir 1|2|3 with materials of type Elastic",
    "rigidLink": "beam NODE NODE",
    "equalDOF": "NODE NODE 1|2|3",
}
UNREAD = ("fixX", "fixY", "rigidDiaphragm", "equalDOF_Mixed", "block2D", "mesh", "remove", "source")
NAMES = "|".join([*USAGE, *UNREAD])
INSIDE = {  # a command that is not at the top of a script
    True: re.compile(rf"(?:^|[.;])\s*({NAMES})\(", re.MULTILINE),
    False: re.compile(rf"(?:^|[{{;\[])\s*({NAMES})\s", re.MULTILINE),
}
CALL = re.compile(r"(?:\w+\.)?(\w+)\((.*)\)", re.DOTALL)
CONSTANT = re.compile(r"(?:set\s+(\w+)\s|(\w+)\s*=)\s*([^\s=(]+)")
LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)  # -orient of elements along the axes


class _Script:
    """A model of OpenSees that grows command by command, in kN, m and t."""

    def __init__(self, units: str) -> None:
        force, _, length = units.partition("-")
        self.force, self.length = conversion(force, "kN")[0], conversion(length, "m")[0]
        self.nodes: dict[str, Node] = {}
        self.elements: list[Element] = []
        self.held: dict[str, tuple[bool, ...]] = {}
        self.ties: list[tuple[str, str, int]] = []
        self.spread: list[tuple[tuple[str, str], float]] = []  # masses of members by length
        self.springs: dict[str, float] = {}
        self.constants: dict[str, str] = {}
        self.line = ""

    def read(self, text: str, python: bool) -> None:
        """Read a script of Python or Tcl."""
        for number, statement in _statements(text):
            self.line, statement = f"line {number}", statement if python else statement.strip()
            call = CALL.fullmatch(statement) if python else None
            name, *words = re.split(r"[\s,]+", " ".join(call.groups() if call else (statement,)))
            if name in USAGE and (call or not python):
                words = [word.strip("\"'{}[]()*") for word in words]
                words = [self.constants.get(word.lstrip("$"), word) for word in words if word]
                try:
                    getattr(self, f"_{name.lower()}")(*words)
                except (ValueError, TypeError, LookupError):
                    given = (
                        f'"{shortened(" ".join([name, *words]))}"; expected {name} {USAGE[name]}'
                    )
                    raise InputError(f"{self.line}: cannot read {given}; {ADVICE}") from None
            elif found := INSIDE[python].search(statement):
                raise InputError(f"{self.line}: {found[1]} is not read here; {ADVICE}")
            elif found := CONSTANT.fullmatch(statement):
                value = self.constants.get(found[3].lstrip("$"), found[3])
                self.constants[found[1] or found[2]] = value
            else:  # what may change a constant
                for name in self.constants:
                    if re.search(rf"\b{name}\b[^=()]*=|\b(?:set|incr)\s+{name}\b", statement):
                        self.constants[name] = "unknown"

    def frame(self, path: Path) -> Frame:
        """Return the frame; each end of a member has half of its mass."""
        for ends, mass in self.spread:
            near, far = (self.nodes[end] for end in ends)
            own = 0.5 * mass * math.hypot(far.x - near.x, far.z - near.z)
            for end in ends:
                x, z, rotary = self.nodes[end].mass
                self.nodes[end] = self.nodes[end]._replace(mass=(x + own, z + own, rotary))
        return Frame(str(path), self.nodes, self.elements, self.held, self.ties)

    def _model(self, *words: str) -> None:
        sizes = dict(zip(words[1::2], words[2::2], strict=True))
        if (sizes["-ndm"], sizes.get("-ndf", "3")) != ("2", "3"):
            raise ValueError

    def _node(self, tag: str, x: str, y: str, *more: str) -> None:
        if tag in self.nodes:
            raise ValueError
        at = self.length * _number(x), self.length * _number(y)
        self.nodes[tag] = Node(*at, (0.0, 0.0, 0.0), self.line)
        if more:
            self._mass(tag, *more[("-mass",).index(more[0]) + 1 :])

    def _mass(self, tag: str, *masses: str) -> None:
        x, z, rotary = (self.force / self.length * _number(one) for one in masses)
        self.nodes[tag] = self.nodes[tag]._replace(mass=(x, z, self.length**2 * rotary))

    def _fix(self, tag: str, *held: str) -> None:
        x, z, rotation = (bool(("0", "1").index(one)) for one in held)
        self.held[tag] = x, z, rotation

    def _uniaxialmaterial(self, kind: str, tag: str, *numbers: str) -> None:
        if kind == "Elastic" and len(numbers) < 3:  # the third is a stiffness in compression
            self.springs[tag] = _number(numbers[0])

    def _geomtransf(self, kind: str, tag: str) -> None:
        """Accept any: without gravity, all are the same for small displacements."""

    def _rigidlink(self, kind: str, *ends: str) -> None:
        first, second = ends[("beam",).index(kind) :]
        self.elements.append(Element(f"link {first}-{second}", (first, second), None, self.line))

    def _equaldof(self, first: str, second: str, *ways: str) -> None:
        self.ties += [(first, second, ("1", "2", "3").index(way)) for way in ways]

    def _element(self, kind: str, tag: str, first: str, second: str, *more: str) -> None:
        law = [0.0, 0.0, 0.0]
        if not {first, second} <= self.nodes.keys():
            raise LookupError
        if kind == "elasticBeamColumn":
            area, modulus, inertia = map(_number, more[:3])
            law = [self.force * modulus * area, self.force * self.length**2 * modulus * inertia]
            if more[4:]:
                mass = _number(more[("-mass",).index(more[4]) + 5])
                self.spread.append(((first, second), self.force / self.length**2 * mass))
        else:
            flags = [
                *(k for k, one in enumerate(more) if one[0] == "-" and one[1:].isalpha()),
                len(more),
            ]
            given = {more[a]: more[a + 1 : b] for a, b in pairwise(flags)}
            given.pop("-doRayleigh", None)
            orient = tuple(map(float, given.pop("-orient", LEVEL)))
            if kind != "zeroLength" or orient != LEVEL or given.keys() != {"-mat", "-dir"}:
                raise ValueError
            for way, material in zip(given["-dir"], given["-mat"], strict=True):
                unit = self.force * (self.length if way == "3" else 1.0 / self.length)
                law[("1", "2", "3").index(way)] += unit * self.springs[material]
        self.elements.append(Element(f"element {tag}", (first, second), tuple(law), self.line))


def _number(text: str) -> float:
    """Return the number of a word."""
    return read_number(text, MOST)


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Yield the statements of a script with the lines they begin at, without comments."""
    held, depth, start = "", 0, 1
    for number, line in enumerate(text.splitlines(), 1):
        line, start = COMMENT.sub("", line).rstrip(), start if held else number
        depth += sum(map(line.count, "([{")) - sum(map(line.count, ")]}"))
        held += line.removesuffix("\\") + "\n"
        if depth <= 0 and not line.endswith("\\"):
            for part in re.split(r";(?![^{}]*\})", held):
                if part.strip():
                    yield start, part.strip("\n").rstrip()
            held, depth = "", 0
    if held:
        raise InputError(f"line {start}: a bracket is not closed")


def import_frame(file: str | Path, *, units: str | None = None) -> ImportedFrame:
    r"""Import a plane frame of piers and decks as a structure, and compare its periods.

    Parameters
    ----------
    file : str or Path
        Table of nodes, members, supports and bearings (CSV or `.xlsx`), or a script of OpenSees
        (`.tcl`, `.py`), which is read and not executed; see docs/guide/exchange.md.
    units : str, optional
        Force and length of a script, such as "kN-m" or "N-mm"; the time is in s. Tables have the
        units in their titles.

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
        if path.suffix.lower() not in (".py", ".tcl"):
            if units is not None:
                raise InputError(f'units = "{units}": a table has the units in its titles')
            return ImportedFrame(_read_table(path))
        if units is None:
            raise InputError('a script of OpenSees has no units; give units, such as "kN-m"')
        script = _Script(units)
        script.read(read_text(path), python=path.suffix.lower() == ".py")
    except InputError as error:
        raise error.located(path) from None
    return ImportedFrame(script.frame(path))
