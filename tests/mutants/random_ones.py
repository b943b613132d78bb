"""Random mutants: lost terms and factors, wrong variables, numbers, conditions, keys, statements.

Figures and tables on the terminal are left out. Changes that nearly always raise (swapped
arguments, a product for a path) are not made, since they flatter the tests. Some mutants are
equivalent to the original (a limit of iterations, a hint), so not all of them can be caught.
"""

import ast
import copy
import itertools
import random
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from tests.mutants.kept import PACKAGE, ROOT, Mutant, nearest_tests, original

LEFT_OUT = ("figure", "drawing", "time_axis", "screen", "regenerate", "__init__", "compile")
OPERATORS: dict[type[ast.AST], type[Any]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.Lt,
    ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip
NAMES = {"min": "max", "max": "min", "argmin": "argmax", "argmax": "argmin", "any": "all"}
NAMES |= {"all": "any", "sin": "cos", "cos": "sin", "ceil": "floor", "floor": "ceil"}
NAMES |= {"mean": "max", "sum": "max", "sqrt": "abs", "abs": "float"}
SLIGHTLY = 1.05  # factor on a number
SKIPPED = (ast.JoinedStr, ast.Raise, ast.Import, ast.ImportFrom, ast.Assert)
NOT_VISITED = ("annotation", "returns", "decorator_list", "type_params")
Place = tuple[ast.AST, ast.AST]  # a node, and what takes its place


def _other(items: list[str], item: str) -> str:
    return items[(items.index(item) + 1) % len(items)]


def _with(node: ast.AST, **changes: Any) -> ast.AST:
    """A copy with other fields: the parser shares operators between all nodes of a tree."""
    made = copy.copy(node)
    for name, value in changes.items():
        setattr(made, name, value)
    return made


def _products(node: ast.BinOp, variables: list[str]) -> Iterator[Place]:
    """Lose a term or a factor; use another variable of the function."""
    sides = (node.left, node.right)
    texts = [s for s in sides if isinstance(s, ast.Constant) and isinstance(s.value, str)]
    if texts or any(isinstance(side, ast.JoinedStr) for side in sides):
        return
    if not (isinstance(node.op, ast.Div) and "path" in ast.unparse(node.left).lower()):
        yield node, node.left
    if isinstance(node.op, ast.Add | ast.Mult):
        yield node, node.right
    for side in sides:
        if isinstance(side, ast.Name) and side.id in variables and len(variables) > 1:
            yield side, ast.Name(_other(variables, side.id), ast.Load())


def _changes(node: ast.AST, variables: list[str], keys: list[str]) -> Iterator[Place]:
    """All small errors at one node."""
    if isinstance(node, ast.BinOp | ast.BoolOp) and type(node.op) in OPERATORS:
        yield node, _with(node, op=OPERATORS[type(node.op)]())
    if isinstance(node, ast.Compare) and type(node.ops[0]) in OPERATORS:
        yield node, _with(node, ops=[OPERATORS[type(node.ops[0])](), *node.ops[1:]])
    match node:
        case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div()):
            yield from _products(node, variables)
        case ast.UnaryOp(operand=operand):
            yield node, operand
        case ast.Constant(value=bool(value)):
            yield node, ast.Constant(not value)
        case ast.Constant(value=int(value)):
            yield node, ast.Constant(value + 1)
        case ast.Constant(value=float(value)):
            yield node, ast.Constant(SLIGHTLY * value if value else 1.0)
        case ast.If(test=test) | ast.IfExp(test=test) if ast.unparse(test) != "TYPE_CHECKING":
            yield test, ast.UnaryOp(ast.Not(), test)
        case ast.Call(func=ast.Name(id=name)) if name in NAMES:
            yield node.func, ast.Name(NAMES[name], ast.Load())
        case ast.Call(func=ast.Attribute(value=owner, attr=name)) if name in NAMES:
            yield node.func, ast.Attribute(owner, NAMES[name], ast.Load())
        case ast.Slice(lower=lower, upper=upper):
            bounds = [bound for bound in (lower, upper) if bound is not None]
            yield from ((b, ast.BinOp(b, ast.Add(), ast.Constant(1))) for b in bounds)
        case ast.Subscript(slice=ast.Constant(value=str(key))) if len(keys) > 1:
            yield node.slice, ast.Constant(_other(keys, key))
        case ast.Expr(value=ast.Call()) | ast.AugAssign():
            yield node, ast.Pass()


def _walk(node: ast.AST, variables: list[str], keys: list[str]) -> Iterator[Place]:
    """Changes of a tree, but for texts for people, types and imports."""
    if isinstance(node, ast.FunctionDef):
        names = [arg.arg for arg in (*node.args.posonlyargs, *node.args.args)]
        stored = (n for n in ast.walk(node) if isinstance(n, ast.Name))
        names += [n.id for n in stored if isinstance(n.ctx, ast.Store)]
        variables = [name for name in dict.fromkeys(names) if name not in ("self", "_")]
    yield from _changes(node, variables, keys)
    for name, value in ast.iter_fields(node):
        for item in value if isinstance(value, list) else [value]:
            wanted = isinstance(item, ast.AST) and not isinstance(item, SKIPPED)
            if wanted and name not in NOT_VISITED:
                yield from _walk(item, variables, keys)


def _places(file: str) -> tuple[ast.Module, list[Place]]:
    tree = ast.parse(original(file))
    sliced = (n.slice for n in ast.walk(tree) if isinstance(n, ast.Subscript))
    keys = {k.value for k in sliced if isinstance(k, ast.Constant) and isinstance(k.value, str)}
    return tree, list(_walk(tree, [], sorted(keys)))


class _Swap(ast.NodeTransformer):
    def __init__(self, old: ast.AST, new: ast.AST) -> None:
        self.old, self.new = old, new

    def visit(self, node: ast.AST) -> ast.AST:
        return self.new if node is self.old else self.generic_visit(node)


def _mutant(file: str, number: int, tests: list[str]) -> Mutant | None:
    """A file with one change; None if it is the same program."""
    tree, places = _places(file)
    before, (old, new) = ast.unparse(tree), places[number]
    line = next((n.lineno for n in ast.walk(old) if hasattr(n, "lineno")), 0)
    means = f"line {line}: {ast.unparse(old)[:60]} -> {ast.unparse(new)[:60]}"
    text = ast.unparse(ast.fix_missing_locations(_Swap(old, new).visit(tree)))
    return None if text == before else Mutant(file, means, text, tuple(tests), by_chance=True)


def files_of_the_package() -> list[str]:
    """Files that changes by chance are made in."""
    folder = ROOT / PACKAGE
    paths = (path.relative_to(folder).as_posix() for path in folder.rglob("*.py"))
    return sorted(path for path in paths if not any(word in Path(path).name for word in LEFT_OUT))


@cache
def _all_places() -> tuple[tuple[str, int], ...]:
    files = files_of_the_package()
    return tuple((file, number) for file in files for number in range(len(_places(file)[1])))


def random_mutants(count: int, seed: int) -> list[Mutant]:
    """So many different changes, each place as likely as any other."""
    nearest = nearest_tests()
    places = list(_all_places())
    random.Random(seed).shuffle(places)
    made = (_mutant(file, number, nearest[file]) for file, number in places)
    return list(itertools.islice((mutant for mutant in made if mutant is not None), count))
