"""Faces of the kernels: functions of one pointer to a table, for callers without numba.

The arguments of a call from Python have numba types, and these say all there is to know; nothing is
listed by hand. From the types follow the description of the table (`Description`, which `native.py`
reads) and the function that reads it, with all that it calls (`compile_face`).
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from thermobearing.core import types as core_types
from thermobearing.core.compiled.jit import Part, link, part_of, text_of
from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.native import PREFIX, UnsuitableError
from thermobearing.core.compiled.tables import (
    BYTES,
    NUMBERS,
    SLOT,
    TABLE,
    Listed,
    argument_type,
    count_slots,
    load_argument,
    stored_type,
)
from thermobearing.core.records import row_type


def _results(kind: Any) -> list[Any]:
    if kind == types.none:
        return []
    return list(kind.types) if isinstance(kind, types.BaseTuple) else [kind]


class Compiled(NamedTuple):
    """A face as numba has written it."""

    symbol: str  # what callers use
    text: str  # the module in the language of LLVM, not optimised; it exports the symbol only
    results: list[Any]  # numba types
    for_pages: bool  # whether a page needs it
    shared: list[Part]  # with separate objects, which it needs


FACE = """
define void @{symbol}(ptr %table) {{
  %result = alloca ptr
  %problem = alloca ptr
  %status = call i32 @{symbol}_with_status(ptr %result, ptr %problem, ptr %table)
  ret void
}}
"""


def compile_face(kernel: Kernel, kinds_of_call: tuple[Any, ...]) -> Compiled:
    """Write the function that calls a kernel with the arguments in a table.

    Each record among the arguments has a separate table. The results follow all arguments.

    Raises
    ------
    UnsuitableError : tables cannot hold such arguments or results.
    """
    kinds = [stored_type(kind) for kind in kinds_of_call]
    slots = [1 if isinstance(kind, types.BaseTuple) else count_slots(kind) for kind in kinds]

    @intrinsic
    def arguments(_: Any, table: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            parts = [
                load_argument(context, builder, kind, values[0], sum(slots[:place]))
                for place, kind in enumerate(kinds)
            ]
            return context.make_tuple(builder, signature.return_type, parts)

        return types.Tuple([argument_type(kind) for kind in kinds])(table), code

    results: list[Any] = []

    @intrinsic
    def write(_: Any, table: Any, result: Any) -> Any:
        results[:] = _results(result)

        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            if not all(isinstance(kind, NUMBERS) for kind in results):
                return context.get_dummy_value()  # the kernel is refused below
            for k, kind in enumerate(results):
                single = not isinstance(result, types.BaseTuple)
                value = values[1] if single else builder.extract_value(values[1], k)
                # Slots have eight bytes: a bool or a short integer would leave the rest of its slot
                # unset.
                if not isinstance(kind, types.Float):
                    value = context.cast(builder, value, kind, types.int64)
                place = builder.gep(values[0], [ir.Constant(SLOT, sum(slots) + k)], inbounds=True)
                builder.store(value, builder.bitcast(place, value.type.as_pointer()), align=BYTES)
            return context.get_dummy_value()

        return types.none(table, result), code

    run = kernel.part

    def face(table: Any) -> None:
        write(table, run(*arguments(table)))

    dispatcher: Any = part_of(face)
    with _without_collection():
        dispatcher.compile((TABLE,))
    (overload,) = dispatcher.overloads.values()
    # Only now: the types of the results come from compiling the kernel.
    for kind in results:
        if not isinstance(kind, NUMBERS):
            raise UnsuitableError(f"{kind} has no place in a table")
    # numba's functions return a status, which callers without numba do not expect: FACE has none.
    symbol = PREFIX + kernel.__name__.strip("_")
    overload.library.symbol = f"{symbol}_with_status"
    module, shared = link(overload.library)
    text = text_of(module, overload.library.symbol, is_called=False) + FACE.format(symbol=symbol)
    return Compiled(symbol, text, results, is_for_pages(kernel), shared)


@contextmanager
def _without_collection() -> Iterator[None]:
    """Do not collect garbage: numba makes millions of objects, most of which live until the end."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _named_rows(modules: tuple[ModuleType, ...]) -> dict[str, str]:
    """Return the class of each kind of row, by its fields."""
    values = [value for module in modules for value in vars(module).values()]
    records: list[Any] = [
        value
        for value in values
        if isinstance(value, type)
        and not issubclass(value, tuple)
        and value.__module__.startswith("thermobearing.")
    ]
    names = {str(numba.from_dtype(row_type(row, 2))): f"{row.__name__}Plane" for row in records}
    # Last, so that rows without vectors, which are the same in a plane, have the plain name.
    return names | {str(numba.from_dtype(row_type(row))): row.__name__ for row in records}


class Description:
    """What `native.py` and other languages read: records, rows, entries.

    `modules` declare rows besides those of `core/types.py`; others are named "Row".
    """

    def __init__(self, *modules: ModuleType) -> None:
        self.records: dict[str, list[Any]] = {}
        self.rows: dict[str, Any] = {}
        self.entries: dict[str, Any] = {}
        self._names = _named_rows((core_types, *modules))

    def add(self, kernel: Kernel, kinds: tuple[Any, ...], face: Compiled) -> None:
        """Describe a face. Names of records and rows in lockstep end in "Lanes"."""
        names = kernel.py_func.__code__.co_varnames
        suffix = "Lanes" if is_lockstep(kernel) else ""
        self.entries[kernel.name] = {
            "symbol": face.symbol,
            "arguments": [
                [name, self._kind(stored_type(kind), suffix)]
                for name, kind in zip(names, kinds, strict=False)
            ],
            "results": [self._kind(kind, suffix) for kind in face.results],
            "single": len(face.results) == 1,
        }

    def all(self, sources: str) -> dict[str, Any]:
        """Return the description of all faces, and the digest of their sources."""
        return {
            "sources": sources,
            "entries": self.entries,
            "records": self.records,
            "rows": self.rows,
        }

    def _kind(self, kind: Any, suffix: str) -> Any:
        if isinstance(kind, types.BaseNamedTuple):
            fields = [
                [name, self._kind(field, suffix)]
                for name, field in zip(kind.fields, kind.types, strict=True)
            ]
            name = kind.instance_class.__name__ + suffix
            return {"record": _add_named(self.records, name, fields)}
        if isinstance(kind, Listed):
            return {"tuple": self._kind(kind.stored, suffix)}
        if isinstance(kind, types.Array):
            return {"array": self._item(kind.dtype, suffix), "dims": kind.ndim}
        if isinstance(kind, types.Float):
            return "float"
        return "bool" if kind == types.boolean else "int"

    def _item(self, kind: Any, suffix: str) -> str:
        if not isinstance(kind, types.Record):
            return str(np.dtype(str(kind)).str)
        fields = []
        for name, field in kind.fields.items():
            inner = field.type
            is_nested = isinstance(inner, types.NestedArray)
            item = np.dtype(str(inner.dtype if is_nested else inner)).str
            fields.append([name, item, field.offset, *(inner.shape if is_nested else ())])
        name = self._names.get(str(kind), "Row") + suffix
        return _add_named(self.rows, name, {"fields": fields, "size": kind.size})


def _add_named(contents: dict[str, Any], name: str, content: Any) -> str:
    """Add a content, with a number if another one has its name, and return its name."""
    number = 1
    while True:
        full = name if number == 1 else f"{name}{number}"
        if contents.setdefault(full, content) == content:
            return full
        number += 1


def is_lockstep(kernel: Kernel) -> bool:
    """Return whether a kernel takes several runs side by side, and so cannot run as Python."""
    return "as_lanes" in kernel.py_func.__code__.co_names


def is_for_pages(kernel: Kernel) -> bool:
    """Return whether a page may need a kernel: one run on a line."""
    return not {"as_lanes", "as_plane"} & set(kernel.py_func.__code__.co_names)
