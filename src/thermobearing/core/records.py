"""Records: rows of named numbers, the same in compiled code and in plain Python.

A class with nothing but annotations says what a row holds: names, kinds, and for numbers that
are shown to people the unit and the meaning. It is the only list of them; array types,
labels and columns follow from it. The class itself is never made: `rows(BearingResponse, 3)` is a
numpy array of three such rows, `array[0].force` one number, `array["force"]` all three.
"""

from collections.abc import Sequence
from functools import cache
from typing import (
    Annotated,
    Any,
    NamedTuple,
    Protocol,
    TypeAlias,
    TypeVar,
    cast,
    get_type_hints,
    overload,
)

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
R = TypeVar("R")
KINDS = {float: np.float64, int: np.int64}

# Vectors of a record, whose marks say how many numbers each has in a plane (core/vector.py).
VECTOR, MATRIX, PEAK = (2,), (2, 2), (3,)
Vector: TypeAlias = Annotated[float, VECTOR]
Matrix: TypeAlias = Annotated[float, MATRIX]
Peak: TypeAlias = Annotated[float, PEAK]  # the largest of x, of y and of the resultant


class Rows(Protocol[R]):
    """The part of numpy's arrays in use here, with records of the class R as rows."""

    def __len__(self) -> int: ...

    @overload
    def __getitem__(self, at: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, at: int | tuple[int, int]) -> R: ...
    @overload
    def __getitem__(self, at: slice | tuple[slice, int]) -> "Rows[R]": ...
    @overload
    def __setitem__(self, at: str, value: Any) -> None: ...
    @overload
    def __setitem__(self, at: int | tuple[int, int], value: R) -> None: ...

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of rows, in each direction."""
        ...

    def copy(self) -> "Rows[R]":
        """Return a copy of the numbers."""
        ...


class PlaneRow(np.record):  # type: ignore[misc]  # numpy types it as final
    """A row whose vectors are pairs in plain Python, as in compiled kernels."""

    def __getattribute__(self, name: str) -> Any:
        """Return a number, or the numbers of a vector."""
        value = super().__getattribute__(name)
        return tuple(value.tolist()) if type(value) is np.ndarray else value


class Label(NamedTuple):
    """The names of a number of a record in files and figures."""

    name: str
    unit: str
    meaning: str


@cache
def vector_fields(record: Any) -> dict[str, tuple[int, ...]]:
    """Return the fields of a record that are vectors or matrices, and their shape in a plane."""
    hints = get_type_hints(record, include_extras=True)
    marks = {name: getattr(hint, "__metadata__", ((),))[0] for name, hint in hints.items()}
    return {name: mark for name, mark in marks.items() if isinstance(mark, tuple) and mark}


@cache
def row_type(record: Any, components: int = 1) -> np.dtype[Any]:
    """The numpy type of one row, aligned as compiled code likes it; one object per record.

    With two components each vector is a field of that shape.
    """
    hints = get_type_hints(record)
    vector_shapes = vector_fields(record) if components > 1 else {}
    fields = [(name, KINDS[kind], vector_shapes.get(name, ())) for name, kind in hints.items()]
    return np.dtype((PlaneRow if vector_shapes else np.record, np.dtype(fields, align=True)))


def rows(record: type[R], *shape: int, components: int = 1) -> Rows[R]:
    """An array of rows, all zero."""
    return cast(Rows[R], np.zeros(shape, dtype=row_type(cast(Any, record), components)))


def unset(record: type[R], *shape: int, components: int = 1) -> Rows[R]:
    """An array of rows whose numbers are still to be written."""
    return cast(Rows[R], np.empty(shape, dtype=row_type(cast(Any, record), components)))


def filled(record: type[R], **columns: Any) -> Rows[R]:
    """An array of rows from its columns, each one number or one for every row."""
    length = max((len(column) for column in columns.values() if np.ndim(column)), default=1)
    array = np.zeros(length, dtype=row_type(cast(Any, record)))
    assert array.dtype.names is not None
    assert set(columns) == set(array.dtype.names), f"{record.__name__}: {sorted(columns)}"
    for name, column in columns.items():
        array[name] = column
    return cast(Rows[R], array)


@cache
def labels(record: Any) -> Sequence[Label]:
    """Name, unit and meaning of each number of a record, in their order."""
    hints = get_type_hints(record, include_extras=True)
    return tuple(Label(name, *hint.__metadata__[-2:]) for name, hint in hints.items())
