"""Random mutants: lost terms and factors, wrong variables, numbers, conditions, keys, statements.

Figures and tables on the terminal are left out. Changes that nearly always raise (swapped
arguments, a product for a path) are not made, since they flatter the tests. Some mutants are
equivalent to the original (a limit of iterations, a hint), so not all of them can be caught.
"""

import ast
import itertools
import random
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.mutants.kept import PACKAGE, ROOT, Mutant, nearest_tests, original

LEFT_OUT = ("figure", "drawing", "time_axis", "screen", "regenerate", "__init__", "compile")
OPERATORS: dict[type[ast.AST], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", "<"),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}
NAMES = {"min": "max", "max": "min", "argmin": "argmax", "argmax": "argmin", "any": "all"}
NAMES |= {"all": "any", "sin": "cos", "cos": "sin", "ceil": "floor", "floor": "ceil"}
NAMES |= {"mean": "max", "sum": "max", "sqrt": "abs", "abs": "float"}
ARITHMETIC = (ast.Add, ast.Sub, ast.Mult, ast.Div)
SLIGHTLY = 1.05  # factor on a number


@dataclass(frozen=True)
class _Edit:
    """Bytes `start` to `end` of a file replaced by `new`."""

    start: int
    end: int
    new: str
    line: int


class _Finder(ast.NodeVisitor):
    """All edits of one file."""

    def __init__(self, source: str) -> None:
        self.source = source.encode()
        self.lines = [0]
        for line in self.source.splitlines(keepends=True):
            self.lines.append(self.lines[-1] + len(line))
        tree = ast.parse(source)
        keys = (n.slice for n in ast.walk(tree) if isinstance(n, ast.Subscript))
        self.keys = sorted(
            {k.value for k in keys if isinstance(k, ast.Constant) and isinstance(k.value, str)}
        )
        self.found: list[_Edit] = []
        self.variables: list[str] = []  # of the function that is visited
        self.visit(tree)

    def _at(self, node: ast.AST) -> tuple[int, int]:
        """First byte of a node, and the one past its last."""
        return (
            self.lines[node.lineno - 1] + node.col_offset,  # type: ignore[attr-defined]
            self.lines[node.end_lineno - 1] + node.end_col_offset,  # type: ignore[attr-defined]
        )

    def _text(self, node: ast.AST) -> str:
        start, end = self._at(node)
        return self.source[start:end].decode()

    def _edit(self, start: int, end: int, new: str) -> None:
        line = self.source.count(b"\n", 0, start) + 1
        self.found.append(_Edit(start, end, new, line))

    def _replace(self, node: ast.AST, new: str) -> None:
        self._edit(*self._at(node), new)

    def _operator(self, left: ast.AST, kind: ast.AST, right: ast.AST) -> None:
        if type(kind) not in OPERATORS:
            return
        old, new = OPERATORS[type(kind)]
        start, end = self._at(left)[1], self._at(right)[0]
        place = self.source.find(old.encode(), start, end)
        if place >= 0:
            self._edit(place, place + len(old), new)

    def visit(self, node: ast.AST) -> None:
        """Everything but texts for people, types and imports."""
        skipped = (ast.JoinedStr, ast.Raise, ast.Import, ast.ImportFrom, ast.Assert)
        if isinstance(node, skipped):
            return
        method = getattr(self, f"visit_{type(node).__name__}", None)
        if method:
            method(node)
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "type_params"):
                continue
            for item in value if isinstance(value, list) else [value]:
                if isinstance(item, ast.AST):
                    self.visit(item)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Collect the variables of a function, each of which may stand for another."""
        names = [arg.arg for arg in (*node.args.posonlyargs, *node.args.args)]
        stored = (n for n in ast.walk(node) if isinstance(n, ast.Name))
        names += [n.id for n in stored if isinstance(n.ctx, ast.Store)]
        self.variables = [name for name in dict.fromkeys(names) if name not in ("self", "_")]

    def visit_BinOp(self, node: ast.BinOp) -> None:
        """Exchange + and -; lose a term or a factor; use another variable of the function."""
        self._operator(node.left, node.op, node.right)
        if not isinstance(node.op, ARITHMETIC):
            return
        sides = (node.left, node.right)
        if any(isinstance(side, ast.Constant | ast.JoinedStr) for side in sides):
            numbers = all(
                isinstance(side.value, int | float)
                for side in sides
                if isinstance(side, ast.Constant)
            )
            if not numbers:  # of text or of a path
                return
        if not (isinstance(node.op, ast.Div) and "path" in self._text(node.left).lower()):
            self._replace(node, f"({self._text(node.left)})")
        if isinstance(node.op, ast.Add | ast.Mult):
            self._replace(node, f"({self._text(node.right)})")
        for side in sides:
            if isinstance(side, ast.Name) and side.id in self.variables:
                place = self.variables.index(side.id)
                other = self.variables[(place + 1) % len(self.variables)]
                if other != side.id:
                    self._replace(side, other)

    def visit_Compare(self, node: ast.Compare) -> None:
        """A limit that belongs to the other side, or the wrong way round."""
        self._operator(node.left, node.ops[0], node.comparators[0])

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        """And for or."""
        self._operator(node.values[0], node.op, node.values[1])

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        """A lost sign or a lost not."""
        self._replace(node, f"({self._text(node.operand)})")

    def visit_Constant(self, node: ast.Constant) -> None:
        """Another number."""
        value = node.value
        if isinstance(value, bool):
            self._replace(node, str(not value))
        elif isinstance(value, int):
            self._replace(node, str(value + 1))
        elif isinstance(value, float):
            self._replace(node, repr(SLIGHTLY * value) if value else "1.0")

    def visit_If(self, node: ast.If) -> None:
        """The opposite condition."""
        if self._text(node.test) != "TYPE_CHECKING":
            self._replace(node.test, f"not ({self._text(node.test)})")

    def visit_IfExp(self, node: ast.IfExp) -> None:
        """The opposite condition."""
        self._replace(node.test, f"(not ({self._text(node.test)}))")

    def visit_Call(self, node: ast.Call) -> None:
        """Exchange min and max, any and all, and the like."""
        name = node.func.attr if isinstance(node.func, ast.Attribute) else self._text(node.func)
        if name in NAMES:
            end = self._at(node.func)[1]
            self._edit(end - len(name), end, NAMES[name])

    def visit_Slice(self, node: ast.Slice) -> None:
        """One too many or one too few."""
        for bound in (node.lower, node.upper):
            if bound is not None:
                self._replace(bound, f"{self._text(bound)} + 1")

    def visit_Subscript(self, node: ast.Subscript) -> None:
        """The next key of the file instead of the right one."""
        key = node.slice
        if isinstance(key, ast.Constant) and key.value in self.keys and len(self.keys) > 1:
            other = self.keys[(self.keys.index(key.value) + 1) % len(self.keys)]
            self._replace(key, f'"{other}"')

    def visit_Expr(self, node: ast.Expr) -> None:
        """A call that is not made."""
        if isinstance(node.value, ast.Call):
            self._replace(node, "pass")

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """A sum that is not added to."""
        self._replace(node, "pass")


def _mutant(file: str, edit: _Edit, tests: list[str]) -> Mutant | None:
    """A file with an edit; None if it is the same program, or none at all."""
    source = original(file)
    raw = source.encode()
    old = raw[edit.start : edit.end].decode()
    text = (raw[: edit.start] + edit.new.encode() + raw[edit.end :]).decode()
    try:
        if ast.dump(ast.parse(text)) == ast.dump(ast.parse(source)):
            return None
    except SyntaxError:
        return None
    told = " ".join(old.split()), " ".join(edit.new.split())
    means = f"line {edit.line}: {told[0][:60]} -> {told[1][:60]}"
    return Mutant(file, means, text, tuple(tests))


def files_of_the_package() -> list[str]:
    """Files that changes by chance are made in."""
    folder = ROOT / PACKAGE
    paths = (path.relative_to(folder).as_posix() for path in folder.rglob("*.py"))
    return sorted(path for path in paths if not any(word in Path(path).name for word in LEFT_OUT))


@cache
def _places() -> tuple[tuple[str, _Edit], ...]:
    """All edits of all files."""
    files = files_of_the_package()
    return tuple((file, edit) for file in files for edit in _Finder(original(file)).found)


def random_mutants(count: int, seed: int) -> list[Mutant]:
    """So many different changes, each place as likely as any other."""
    nearest = nearest_tests()
    places = list(_places())
    random.Random(seed).shuffle(places)
    made = (_mutant(file, edit, nearest[file]) for file, edit in places)
    return list(itertools.islice((mutant for mutant in made if mutant is not None), count))
