"""Records: rows of named numbers, the same in compiled code and in plain Python.

A class with nothing but annotations says what a row holds: names, kinds, and for numbers that
are shown to people the unit and the meaning. It is the only list of them; array types,
labels and columns follow from it. The class itself is never made: `rows(Books, 3)` is a numpy
array of three such rows, `array[0].force` one number, `array["force"]` all three.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple, Protocol, TypeVar, cast, get_type_hints, overload

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
R = TypeVar("R")
KINDS = {float: np.float64, int: np.int64}


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
        """The same numbers in an array of its own."""
        ...


class Label(NamedTuple):
    """The names of a number of a record in files and figures."""

    name: str
    unit: str
    meaning: str


@cache
def row_type(record: Any) -> np.dtype[Any]:
    """The numpy type of one row, aligned as compiled code likes it; one object per record."""
    hints = get_type_hints(record)
    fields = np.dtype([(name, KINDS[kind]) for name, kind in hints.items()], align=True)
    return np.dtype((np.record, fields))


def rows(record: type[R], *shape: int) -> Rows[R]:
    """An array of rows, all zero."""
    return cast(Rows[R], np.zeros(shape, dtype=row_type(cast(Any, record))))


def unset(record: type[R], *shape: int) -> Rows[R]:
    """An array of rows whose numbers are still to be written."""
    return cast(Rows[R], np.empty(shape, dtype=row_type(cast(Any, record))))


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
    return tuple(Label(name, *hint.__metadata__) for name, hint in hints.items())
