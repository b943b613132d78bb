"""Faces of the kernels: functions of one pointer to a table, for callers without numba.

The arguments of a call from Python have numba types, and these say all there is to know; nothing is
listed by hand. From the types follow the description of the table (`Description`, which `native.py`
reads) and the function that reads it, with all that it calls (`compile_face`).
"""

import gc
import operator
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import signature
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable
from numba.np import arrayobj

from thermobearing.core import types as core_types
from thermobearing.core.compiled.jit import linked, new_part
from thermobearing.core.compiled.kernel import Kernel
from thermobearing.core.compiled.native import PREFIX, UnsuitableError
from thermobearing.core.lanes import views
from thermobearing.core.records import row_type

TABLE = types.CPointer(types.int64)
_NUMBERS = (types.Float, types.Integer, types.Boolean)
SLOT = ir.IntType(64)
BYTES = 8


class Listed(types.Type):
    """Any number of records or arrays of one type in a table; in kernels, like a tuple of them.

    Kernels are compiled by numba for tuples of each length; a face serves all lengths.
    """

    def __init__(self, item: Any, found: Any = None) -> None:
        self.item, self.found = item, found or item  # in the table, and what a kernel gets
        super().__init__(f"Listed({item}, {self.found})")

    def viewed(self, view: Callable[[Any], Any]) -> "Listed":
        """The type that `as_lanes` or `as_plane` gives to it."""
        return Listed(self.item, view(self.found))


@register_model(Listed)
class ListedModel(models.StructModel):
    """Address and number of the entries."""

    def __init__(self, manager: Any, kind: Listed) -> None:
        super().__init__(manager, kind, [("table", TABLE), ("count", types.int64)])


@type_callable(len)
def _type_len(_: Any) -> Any:
    return lambda listed: signature(types.int64, listed) if isinstance(listed, Listed) else None


@lower_builtin(len, Listed)
def _lower_len(context: Any, builder: Any, called: Any, values: Any) -> Any:
    return context.make_helper(builder, called.args[0], values[0]).count


@type_callable(operator.getitem)
def _type_entry(_: Any) -> Any:
    def typed(listed: Any, place: Any) -> Any:
        if isinstance(listed, Listed) and isinstance(place, types.Integer):
            return signature(listed.found, listed, types.int64)
        return None

    return typed


@lower_builtin(operator.getitem, Listed, types.Integer)
def _lower_entry(context: Any, builder: Any, called: Any, values: Any) -> Any:
    listed = called.args[0]
    table = context.make_helper(builder, listed, values[0]).table
    size = ir.Constant(SLOT, count_slots(listed.item))
    start = builder.gep(table, [builder.mul(values[1], size)], inbounds=True)
    value, _ = _load(context, builder, listed.item, start, 0)
    return views.converted(context, builder, listed.item, value, listed.found)


def face_type(kind: Any) -> Any:
    """Return the type that a face gives to an argument of a type.

    Raises
    ------
    UnsuitableError : tables cannot hold such an argument.
    """
    if isinstance(kind, types.BaseNamedTuple):
        inner = [face_type(one) for one in kind.types]
        return types.BaseTuple.from_types(inner, kind.instance_class)
    if isinstance(kind, types.UniTuple) and not isinstance(kind.dtype, _NUMBERS):
        return Listed(face_type(kind.dtype))
    if isinstance(kind, types.Array) and kind.layout == "C":
        return kind.copy(readonly=False)
    if isinstance(kind, _NUMBERS):
        return types.unliteral(kind)
    raise UnsuitableError(f"{kind} has no place in a table")


def count_slots(kind: Any) -> int:
    """Return the slots of eight bytes that an argument takes."""
    if isinstance(kind, types.BaseTuple):
        return sum(count_slots(one) for one in kind.types)
    if isinstance(kind, Listed):
        return 2
    return 1 + kind.ndim if isinstance(kind, types.Array) else 1


def _load(context: Any, builder: Any, kind: Any, table: Any, slot: int) -> tuple[Any, int]:
    """Return what stands in a table from a slot on, and the slot after it.

    Tables do not change while a kernel runs, so that a load may be moved or repeated.
    """

    def number(at: int, wanted: Any = SLOT) -> Any:
        place = builder.gep(table, [ir.Constant(SLOT, at)], inbounds=True)
        loaded = builder.load(builder.bitcast(place, wanted.as_pointer()), align=BYTES)
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded

    if isinstance(kind, types.BaseTuple):
        parts = []
        for one in kind.types:
            part, slot = _load(context, builder, one, table, slot)
            parts.append(part)
        return context.make_tuple(builder, kind, parts), slot
    if isinstance(kind, Listed):
        listed = context.make_helper(builder, kind)
        listed.table = builder.inttoptr(number(slot), SLOT.as_pointer())
        listed.count = number(slot + 1)
        return listed._getvalue(), slot + 2
    if isinstance(kind, types.Array):
        shape = [number(slot + 1 + axis) for axis in range(kind.ndim)]
        item = context.get_data_type(kind.dtype)
        stride = ir.Constant(SLOT, context.get_abi_sizeof(item))
        strides = [stride]
        for length in reversed(shape[1:]):
            strides.insert(0, builder.mul(strides[0], length))
        made = context.make_array(kind)(context, builder)
        arrayobj.populate_array(
            made,
            data=builder.inttoptr(number(slot), item.as_pointer()),
            shape=shape,
            strides=strides,
            itemsize=stride,
            meminfo=None,
        )
        return made._getvalue(), slot + 1 + kind.ndim
    if isinstance(kind, types.Float):
        return number(slot, ir.DoubleType()), slot + 1
    whole = number(slot)
    return builder.trunc(whole, ir.IntType(1)) if kind == types.boolean else whole, slot + 1


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


def compile_face(kernel: Kernel, kinds_of_call: tuple[Any, ...]) -> Compiled:
    """Write the function that calls a kernel with what stands in a table.

    Records that are arguments stand in tables of their own, and results after all arguments.

    Raises
    ------
    UnsuitableError : tables cannot hold such arguments or results.
    """
    kinds = [face_type(kind) for kind in kinds_of_call]

    @intrinsic
    def arguments(_: Any, table: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            parts, slot = [], 0
            for kind in kinds:
                table, at = values[0], slot
                if isinstance(kind, types.BaseTuple):
                    address, slot = _load(context, builder, types.int64, table, slot)
                    table, at = builder.inttoptr(address, SLOT.as_pointer()), 0
                    part, _ = _load(context, builder, kind, table, at)
                else:
                    part, slot = _load(context, builder, kind, table, at)
                parts.append(part)
            return context.make_tuple(builder, signature.return_type, parts)

        return types.Tuple(kinds)(table), code

    first = sum(1 if isinstance(kind, types.BaseTuple) else count_slots(kind) for kind in kinds)
    results: list[Any] = []

    @intrinsic
    def write(_: Any, table: Any, result: Any) -> Any:
        results[:] = _results(result)

        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            if not all(isinstance(kind, _NUMBERS) for kind in results):
                return context.get_dummy_value()  # the kernel is refused below
            for k, kind in enumerate(results):
                single = not isinstance(result, types.BaseTuple)
                value = values[1] if single else builder.extract_value(values[1], k)
                if not isinstance(kind, types.Float):
                    value = context.cast(builder, value, kind, types.int64)
                place = builder.gep(values[0], [ir.Constant(SLOT, first + k)], inbounds=True)
                builder.store(value, builder.bitcast(place, value.type.as_pointer()), align=BYTES)
            return context.get_dummy_value()

        return types.none(table, result), code

    run = kernel.part

    def face(table: Any) -> None:
        write(table, run(*arguments(table)))

    dispatcher: Any = new_part(face)
    with _without_collection():
        dispatcher.compile((TABLE,))
    (overload,) = dispatcher.overloads.values()
    for kind in results:
        if not isinstance(kind, _NUMBERS):
            raise UnsuitableError(f"{kind} has no place in a table")
    symbol = PREFIX + kernel.__name__.strip("_")
    text = _exported(linked(overload.library), overload.fndesc.llvm_func_name, symbol)
    return Compiled(symbol, text, results, is_for_pages(kernel))


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


def _exported(module: Any, function: str, symbol: str) -> str:
    """Return the text of a module that exports one function, which takes the table only.

    The names that numba gives count what was compiled before, so functions get other names: the
    same kernel has the same text in every process.
    """
    inner = f"{symbol}_with_status"
    module.get_function(function).name = inner
    defined = [function for function in module.functions if not function.is_declaration]
    for number, part in enumerate(defined):
        part.linkage = "internal"
        if part.name != inner:
            part.name = f"{symbol}_{number}"
    for number, variable in enumerate(module.global_variables):
        if not variable.is_declaration:
            variable.name = f"{symbol}_variable_{number}"
    text = re.sub(r" = common (local_unnamed_addr )?global", " = internal global", str(module))
    lines = [line for line in text.splitlines() if not line.startswith(("target ", "source_file"))]
    return (
        "\n".join(lines)
        + f"""
define void @{symbol}(ptr %table) {{
  %result = alloca ptr
  %problem = alloca ptr
  %status = call i32 @{inner}(ptr %result, ptr %problem, ptr %table)
  ret void
}}
"""
    )


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

    def add(self, kernel: Kernel, given: tuple[Any, ...], face: Compiled) -> None:
        """Describe a face. What it takes in lockstep has a name of its own."""
        names = kernel.py_func.__code__.co_varnames
        suffix = "Lanes" if is_lockstep(kernel) else ""
        self.entries[kernel.name] = {
            "symbol": face.symbol,
            "arguments": [
                [name, self._kind(face_type(kind), suffix)]
                for name, kind in zip(names, given, strict=False)
            ],
            "results": [self._kind(kind, suffix) for kind in face.results],
            "single": len(face.results) == 1,
        }

    def all(self, sources: str) -> dict[str, Any]:
        """Return the whole description of faces that were compiled from some sources."""
        return {
            "sources": sources,
            "entries": self.entries,
            "records": self.records,
            "rows": self.rows,
        }

    def _kind(self, kind: Any, suffix: str) -> Any:
        if isinstance(kind, types.BaseNamedTuple):
            fields = [
                [name, self._kind(one, suffix)]
                for name, one in zip(kind.fields, kind.types, strict=True)
            ]
            name = kind.instance_class.__name__ + suffix
            return {"record": _add_named(self.records, name, fields)}
        if isinstance(kind, Listed):
            return {"tuple": self._kind(kind.item, suffix)}
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
            wide = isinstance(inner, types.NestedArray)
            item = np.dtype(str(inner.dtype if wide else inner)).str
            fields.append([name, item, field.offset, *(inner.shape if wide else ())])
        name = self._names.get(str(kind), "Row") + suffix
        return _add_named(self.rows, name, {"fields": fields, "size": kind.size})


def _add_named(known: dict[str, Any], name: str, content: Any) -> str:
    """Return the name under which a content is known, after it is."""
    number = 1
    while True:
        full = name if number == 1 else f"{name}{number}"
        if known.setdefault(full, content) == content:
            return full
        number += 1


def is_lockstep(kernel: Kernel) -> bool:
    """Return whether a kernel takes several runs side by side, and so cannot run as Python."""
    return "as_lanes" in kernel.py_func.__code__.co_names


def is_for_pages(kernel: Kernel) -> bool:
    """Return whether a page may need a kernel: one run on a line."""
    return not {"as_lanes", "as_plane"} & set(kernel.py_func.__code__.co_names)
