"""What compiled code is made of: its cache key, and its records."""

import ast
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import thermobearing
from thermobearing.core import types
from thermobearing.core.compile import kernel_files
from thermobearing.core.records import filled, labels, row_type, rows
from thermobearing.core.types import Books, LayerCells, RubberBooks
from thermobearing.structure import types as structure_types

PACKAGE = Path(thermobearing.__file__).parent


def is_kernel(node: ast.AST) -> bool:
    return isinstance(node, ast.FunctionDef) and any(
        isinstance(decorator, ast.Name) and decorator.id == "compiled"
        for decorator in node.decorator_list
    )


def taken_from(tree: ast.Module) -> dict[str, Path]:
    """File of the package that each imported name comes from."""
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("thermobearing."):
            path = PACKAGE.parent / f"{str(node.module).replace('.', '/')}.py"
            found |= {alias.asname or alias.name: path for alias in node.names}
    return found


def test_cache_key_covers_all_that_kernels_use() -> None:
    """Every file with a kernel, and every file a kernel takes a name from."""
    covered = set(kernel_files())
    assert all(path.is_file() for path in covered)
    kernels = 0
    for path in PACKAGE.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        imported = taken_from(tree)
        for node in filter(is_kernel, ast.walk(tree)):
            kernels += 1
            assert path in covered, f"{path.name} has a kernel, but is not in KERNELS"
            names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
            for name in names & set(imported):
                assert imported[name] in covered, f"{path.name} takes {name} from {imported[name]}"
    assert kernels > 40


def test_cache_key_leaves_out_what_has_no_kernels() -> None:
    """An edit there must not compile everything again."""
    names = {path.relative_to(PACKAGE).parts[-2:] for path in kernel_files()}
    assert ("core", "step.py") in names
    assert ("structure", "newmark.py") in names
    for other in ("run.py", "model.py", "matrices.py", "readers.py"):
        assert not [parts for parts in names if parts[-1] == other]


def record_classes() -> list[type]:
    """Those that rows are made of: classes with annotations only."""
    found = [
        value
        for module in (types, structure_types)
        for value in vars(module).values()
        if isinstance(value, type) and value.__module__ == module.__name__
    ]
    return [value for value in found if not issubclass(value, tuple)]


@pytest.mark.parametrize("record", record_classes(), ids=lambda record: record.__name__)
def test_a_name_of_a_record_is_not_hidden_by_numpy(record: type) -> None:
    """Plain Python looks names up in numpy's own record first."""
    names = row_type(record).names
    assert names
    assert [name for name in names if hasattr(np.void, name)] == []
    assert row_type(record).itemsize == 8 * len(names)


def test_books_of_rubber_come_first() -> None:
    """A bearing without lead and rate dependence is asked for the first of the same books."""
    first = labels(RubberBooks)
    assert labels(Books)[: len(first)] == first
    assert [label.name for label in labels(Books)] == list(row_type(Books).names or ())


def test_a_record_needs_all_its_columns() -> None:
    places = filled(LayerCells, first=[3, 5], last=[5, 7], upper_middle=0, lower_middle=1)
    assert len(places) == 2
    assert (places[1].first, places[1].lower_middle) == (5, 1)
    with pytest.raises(AssertionError, match="LayerCells"):
        filled(LayerCells, first=[3, 5])


def test_rows_are_views_and_copies_are_not() -> None:
    books = rows(Books, 3)
    books[1].force = 2.0
    part = books[1:]
    part[0].force = 3.0
    assert_array_equal(books["force"], [0.0, 3.0, 0.0])
    part.copy()[0].force = 4.0
    assert books[1].force == 3.0
