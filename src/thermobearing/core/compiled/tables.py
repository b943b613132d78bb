"""Types of arguments in tables: records by their address, and any number of them.

The caller of a face has its arguments in tables (`native.py` describes them). Kernels get the
address of a record and load a field where they use it, so that functions pass one address and not
some hundred numbers and arrays: most of what numba had to write and LLVM to optimise.
"""

import hashlib
import operator
from collections.abc import Callable
from functools import cache
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typing.templates import AttributeTemplate, signature
from numba.extending import (
    infer_getattr,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
    type_callable,
)
from numba.np import arrayobj

from thermobearing.core.compiled.native import UnsuitableError
from thermobearing.core.lanes import views

TABLE = types.CPointer(types.int64)
NUMBERS = (types.Float, types.Integer, types.Boolean)
SLOT = ir.IntType(64)
BYTES = 8


class Stored(types.Type):
    """A record in a table, by its address.

    `stored` is the type of the named tuple whose fields are there, and `viewed` that of the named
    tuple which kernels find (`as_lanes` and `as_plane` change it).
    """

    def __init__(self, stored: Any, viewed: Any = None) -> None:
        self.stored, self.seen = stored, viewed or stored
        super().__init__(f"Stored({_short(self.stored)}, {_short(self.seen)})")

    def viewed(self, view: Callable[[Any], Any]) -> "Stored":
        """Return the type that `as_lanes` or `as_plane` gives to it."""
        return Stored(self.stored, view(self.seen))


class Listed(types.Type):
    """Any number of records or arrays of one type in a table; in kernels, like a tuple of them.

    Kernels are compiled by numba for tuples of each length; a face serves all lengths.
    """

    def __init__(self, stored: Any, viewed: Any = None) -> None:
        self.stored, self.seen = stored, viewed or stored
        super().__init__(f"Listed({_short(self.stored)}, {_short(self.seen)})")

    def viewed(self, view: Callable[[Any], Any]) -> "Listed":
        """Return the type that `as_lanes` or `as_plane` gives to it."""
        return Listed(self.stored, view(self.seen))

    @property
    def entry(self) -> Any:
        """The type of an entry."""
        return _found(self.stored, self.seen)


@cache
def _name(full: str, record: Any) -> str:
    return f"{record.__name__}_{hashlib.sha256(full.encode()).hexdigest()[:8]}"


def _short(kind: Any) -> str:
    """Return a short name of a type; the names of functions contain those of all arguments."""
    record = getattr(kind, "instance_class", None)
    return _name(kind.name, record) if record else str(kind)


def _found(stored: Any, seen: Any) -> Any:
    """Return the type with which kernels find a field or an entry."""
    return Stored(stored, seen) if isinstance(stored, types.BaseTuple) else seen


register_model(Stored)(models.OpaqueModel)


@register_model(Listed)
class ListedModel(models.StructModel):
    """Address and number of the entries."""

    def __init__(self, manager: Any, kind: Listed) -> None:
        super().__init__(manager, kind, [("table", TABLE), ("count", types.int64)])


@infer_getattr
class _Fields(AttributeTemplate):
    """The fields of a record in a table."""

    key = Stored

    def generic_resolve(self, record: Stored, name: str) -> Any:
        """Return the type of a field."""
        if name not in record.stored.fields:
            return None
        place = record.stored.fields.index(name)
        return _found(record.stored.types[place], record.seen.types[place])


@lower_getattr_generic(Stored)
def _lower_field(context: Any, builder: Any, record: Stored, value: Any, name: str) -> Any:
    place = record.stored.fields.index(name)
    slot = sum(count_slots(kind) for kind in record.stored.types[:place])
    table = builder.bitcast(value, SLOT.as_pointer())
    return _viewed(
        context, builder, record.stored.types[place], record.seen.types[place], table, slot
    )


def _viewed(context: Any, builder: Any, stored: Any, seen: Any, table: Any, slot: int) -> Any:
    """Return a field or an entry at a slot of a table, as kernels find it."""
    if isinstance(stored, types.BaseTuple):
        return _address(builder, table, slot)
    value = load(context, builder, stored, table, slot)
    return views.converted(context, builder, stored, value, seen)


def _address(builder: Any, table: Any, slot: int) -> Any:
    place = builder.gep(table, [ir.Constant(SLOT, slot)], inbounds=True)
    return builder.bitcast(place, ir.IntType(8).as_pointer())


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
            return signature(listed.entry, listed, types.int64)
        return None

    return typed


@lower_builtin(operator.getitem, Listed, types.Integer)
def _lower_entry(context: Any, builder: Any, called: Any, values: Any) -> Any:
    listed = called.args[0]
    table = context.make_helper(builder, listed, values[0]).table
    size = ir.Constant(SLOT, count_slots(listed.stored))
    start = builder.gep(table, [builder.mul(values[1], size)], inbounds=True)
    return _viewed(context, builder, listed.stored, listed.seen, start, 0)


def stored_type(kind: Any) -> Any:
    """Return the type that an argument of a type has in a table.

    Raises
    ------
    UnsuitableError : tables cannot hold such an argument.
    """
    if isinstance(kind, types.BaseNamedTuple):
        inner = [stored_type(field) for field in kind.types]
        return types.BaseTuple.from_types(inner, kind.instance_class)
    if isinstance(kind, types.BaseTuple) and not isinstance(next(iter(kind), None), NUMBERS):
        # Tuples of records are of one type for numba only if all lists in them have one length.
        entries = {stored_type(entry) for entry in kind.types}
        if len(entries) == 1:
            return Listed(entries.pop())
    # Kernels do not write into arrays that are read-only; with one type for both there is one face.
    if isinstance(kind, types.Array) and kind.layout == "C":
        return kind.copy(readonly=False)
    if isinstance(kind, NUMBERS):
        return types.unliteral(kind)
    raise UnsuitableError(f"{kind} has no place in a table")


def argument_type(stored: Any) -> Any:
    """Return the type with which a kernel gets an argument from a table."""
    return _found(stored, stored)


def count_slots(kind: Any) -> int:
    """Return the slots of eight bytes that an argument takes."""
    if isinstance(kind, types.BaseTuple):
        return sum(count_slots(field) for field in kind.types)
    if isinstance(kind, Listed):
        return 2
    return 1 + kind.ndim if isinstance(kind, types.Array) else 1


def load(context: Any, builder: Any, kind: Any, table: Any, slot: int) -> Any:
    """Return the number, array or list that begins at a slot of a table.

    Tables do not change while a kernel runs, so that a load may be moved or repeated.
    """

    def number(at: int, item_type: Any = SLOT) -> Any:
        place = builder.gep(table, [ir.Constant(SLOT, at)], inbounds=True)
        loaded = builder.load(builder.bitcast(place, item_type.as_pointer()), align=BYTES)
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded

    if isinstance(kind, Listed):
        listed = context.make_helper(builder, kind)
        listed.table = builder.inttoptr(number(slot), SLOT.as_pointer())
        listed.count = number(slot + 1)
        return listed._getvalue()
    if isinstance(kind, types.Array):
        shape = [number(slot + 1 + axis) for axis in range(kind.ndim)]
        item = context.get_data_type(kind.dtype)
        stride = ir.Constant(SLOT, context.get_abi_sizeof(item))
        strides = [stride]
        # The last axis is the nearest in memory.
        for length in reversed(shape[1:]):
            strides.insert(0, builder.mul(strides[0], length))
        array = context.make_array(kind)(context, builder)
        arrayobj.populate_array(
            array,
            data=builder.inttoptr(number(slot), item.as_pointer()),
            shape=shape,
            strides=strides,
            itemsize=stride,
            meminfo=None,
        )
        return array._getvalue()
    if isinstance(kind, types.Float):
        return number(slot, ir.DoubleType())
    integer = number(slot)
    return builder.trunc(integer, ir.IntType(1)) if kind == types.boolean else integer


def load_argument(context: Any, builder: Any, kind: Any, table: Any, slot: int) -> Any:
    """Return an argument of a face; a record has a separate table."""
    if isinstance(kind, types.BaseTuple):
        address = load(context, builder, types.int64, table, slot)
        return builder.inttoptr(address, ir.IntType(8).as_pointer())
    return load(context, builder, kind, table, slot)
