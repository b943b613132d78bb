"""Kernels from a library that was built ahead of time: loading it, and calling its functions.

`python -m kernels` builds a library for each platform and one description of all of them,
`kernels.json`, which says how arguments are laid out. A function of a library (a face) takes one
pointer to a table of slots of eight bytes:

    a number, integer or choice        its value
    an array                           its address, then its shape
    a record (named tuple)             the address of a table of its fields, one after the other
    a tuple of records or arrays       the address of a table with all of them, and their number
    a result                           where the face writes it, after the arguments

A record within a record has its slots among those of the outer one. Where a library does not fit
(a file that differs, another processor), or an argument (an array of another kind), numba compiles
a face that does (`objects.py`).
"""

import ctypes
import hashlib
import json
import os
import platform
import struct
import sys
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from thermobearing.core.compiled.kernel import Kernel, has_numba
from thermobearing.core.compiled.sources import sources_digest

FOLDER = Path(__file__).with_name("libraries")
DESCRIPTION = "kernels.json"
CHOICE = "THERMOBEARING_KERNELS"  # the environment variable: "jit", or a level such as "v1"
WARNED = "THERMOBEARING_KERNELS_WARNED"  # environment variable: the reason of the last warning
PREFIX = "thermobearing_"  # of the names of all faces

# What the system's processor must have for each level of x86-64, the best level first.
LEVELS = {
    "v4": frozenset(["avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"]),
    "v3": frozenset(["avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"]),
    "v1": frozenset[str](),
}
# Records that many calls get, and of how many at most the tables are kept, with the records.
REUSED = {"Constants": 64, "Workspace": 64, "State": 64, "Path": 1}

_ADDRESS: Any = ctypes.addressof
_BYTE: Any = ctypes.c_char.from_buffer
_ARRAY = np.ndarray
_BYTES = np.dtype(np.uint8)

Slots = list[Any]  # of a table, and what must live as long as it


class NotBuiltError(ValueError):
    """No library was built for this machine."""


class UnsuitableError(TypeError):
    """Arguments that a face was not built for."""


class Library(NamedTuple):
    """A library that was loaded."""

    file: Path
    code: ctypes.CDLL
    description: dict[str, Any]


def _level() -> str:
    """Return the best level of x86-64 that this processor is known to have."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:
        return "v1"
    lines = (line.partition(":")[2] for line in text.splitlines() if line.startswith("flags"))
    flags = set(next(lines, "").split())
    # An instruction that the processor lacks ends the program, so unknown flags mean the lowest
    # level.
    if not LEVELS["v3"] <= flags:
        return "v1"
    return "v4" if LEVELS["v4"] <= flags else "v3"


def library_name(choice: str = "") -> str:
    """Return the name of the library for this machine, as "linux-x86_64-v3"."""
    machine = platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    system = {"darwin": "macos", "win32": "windows"}.get(sys.platform, sys.platform)
    # A Python of 32 bits on a machine of 64 cannot load its libraries.
    if struct.calcsize("P") != 8:
        machine += "-32"
    if (system, machine) == ("linux", "x86_64"):
        machine += f"-{choice or _level()}"
    return f"{system}-{machine}"


@cache
def open_library() -> tuple[Library | None, str]:
    """Return the library of this machine, or None and the reason as a sentence.

    The library is looked for in the package only, and its content must have the digest that the
    description names. There is no warning in a checkout without libraries for this machine, where
    numba compiles, and none in a process whose parent has given it.
    """
    choice = os.environ.get(CHOICE, "")
    if choice == "jit":
        return None, f"{CHOICE}=jit requests kernels compiled by numba."
    if choice and choice not in LEVELS:
        warnings.warn(f"{CHOICE}={choice}: known: jit, {', '.join(LEVELS)}.", stacklevel=2)
        choice = ""
    if not (FOLDER / DESCRIPTION).is_file():
        return None, "This installation has no compiled kernels."
    try:
        return _load(FOLDER, library_name(choice)), ""
    except NotBuiltError as problem:
        return None, f"This installation has no compiled kernels for this machine: {problem}."
    except (OSError, ValueError, KeyError, AttributeError, TypeError) as problem:
        reason = f"The compiled kernels of this installation cannot be used: {problem}."
        if has_numba() and os.environ.get(WARNED) != reason:
            os.environ[WARNED] = reason
            warnings.warn(
                f"{reason} numba compiles them when they are first used (about ten seconds).",
                stacklevel=2,
            )
        return None, reason


def read_description(folder: Path) -> dict[str, Any]:
    """Return the description of all libraries; ValueError if built from other sources."""
    description: dict[str, Any] = json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))
    if description["sources"] != sources_digest():
        raise ValueError("they were built from other sources")
    return description


def read_library(folder: Path, name: str) -> tuple[Path, bytes, dict[str, Any]]:
    """Return the file and the content of a library, and the description of all of them.

    NotBuiltError if there is no such library; ValueError if they were built from other sources, or
    the content differs from what was built.
    """
    description = read_description(folder)
    entry = description["libraries"].get(name)
    if entry is None:
        raise NotBuiltError(f"there is no library for {name}")
    file = folder / entry["file"]
    content = file.read_bytes()
    if hashlib.sha256(content).hexdigest() != entry["sha256"]:
        raise ValueError(f"the content of {file.name} is not what was built")
    return file, content, description


def _load(folder: Path, name: str) -> Library:
    file, _, description = read_library(folder, name)
    code = ctypes.CDLL(str(file))
    built_from = ctypes.string_at(getattr(code, f"{PREFIX}sources")).decode("ascii")
    if built_from != description["sources"]:
        raise ValueError(f"{file.name} was built from other sources")
    return Library(file, code, description)


def find_face(kernel: Kernel) -> tuple[Callable[..., Any] | None, str]:
    """Return what calls a kernel in the library, or None and the reason.

    The reason is empty if the kernel has no face in any library, so that it may run as Python.
    """
    library, reason = open_library()
    if library is None:
        return None, reason
    entry = library.description["entries"].get(kernel.name)
    if entry is None:
        return None, ""
    function = getattr(library.code, entry["symbol"])
    return Face(function, library.description, kernel).call, ""


@cache
def _list_fields(row: Any) -> list[list[Any]]:
    """Return the fields of a record's numpy type, as the description has them."""
    return [[name, row[name].base.str, row.fields[name][1], *row[name].shape] for name in row.names]


class NumberKind:
    """A float, or an int or bool."""

    def __init__(self, described: str) -> None:
        self.format = "d" if described == "float" else "q"

    def add(self, number: Any, slots: Slots, _: Slots) -> None:
        """Append the number."""
        slots.append(number)


class ArrayKind:
    """An array: its dimensions, and the numpy types that fit."""

    def __init__(self, described: dict[str, Any], description: dict[str, Any]) -> None:
        self.format = "q" * (1 + described["dims"])
        self.dims: int = described["dims"]
        self.name = described["array"]
        self.row = description["rows"].get(self.name)
        self.usual: Any = None  # the type that was compared last and fits

    def _is_suitable(self, dtype: Any) -> bool:
        if self.row is None or dtype.names is None:
            return bool(dtype.str == self.name)
        has_same_fields: bool = _list_fields(dtype) == self.row["fields"]
        return has_same_fields and dtype.itemsize == self.row["size"]

    def add(self, array: Any, slots: Slots, _: Slots) -> None:
        """Append the address and the shape of an array."""
        if type(array) is not _ARRAY:
            raise UnsuitableError(f"{type(array).__name__} in place of an array")
        dtype = array.dtype
        if dtype is not self.usual:
            if not self._is_suitable(dtype):
                raise UnsuitableError(f"array of {dtype} in place of {self.name}")
            self.usual = dtype
        shape = array.shape
        if len(shape) != self.dims:
            raise UnsuitableError(f"array of shape {shape}")
        if not array.size:
            slots += (0, *shape)
            return
        try:  # a quarter of the time of array.ctypes.data
            plain = array if self.row is None else array.view(_BYTES)
            slots += (_ADDRESS(_BYTE(plain)), *shape)
        except (TypeError, ValueError):  # it is read-only, or not contiguous
            if not array.flags.c_contiguous:
                raise UnsuitableError(f"array of strides {array.strides}") from None
            slots += (array.ctypes.data, *shape)


class RecordKind:
    """A named tuple: the slots of its fields."""

    def __init__(self, described: dict[str, Any], description: dict[str, Any]) -> None:
        fields = description["records"][described["record"]]
        self.kinds: list[Kind] = [_new_kind(kind, description) for _, kind in fields]
        self.format: str = "".join(kind.format for kind in self.kinds)

    def add(self, record: Any, slots: Slots, references: Slots) -> None:
        """Append the slots of all fields."""
        if not isinstance(record, tuple) or len(record) != len(self.kinds):
            raise UnsuitableError(f"{type(record).__name__} in place of a record")
        for kind, field in zip(self.kinds, record):  # noqa: B905  # `strict` costs time
            kind.add(field, slots, references)


class TableKind:
    """Records or arrays in a separate table: `counted` is whether their number follows.

    The tables of the last `reused` records are kept.
    """

    def __init__(self, inner: RecordKind | ArrayKind, *, counted: bool, reused: int) -> None:
        self.format = "qq" if counted else "q"
        self.inner, self.counted, self.reused = inner, counted, reused
        self.layout = struct.Struct(inner.format)
        self.kept: dict[int, tuple[Any, Any, int]] = {}

    def add(self, records: Any, slots: Slots, references: Slots) -> None:
        """Append the address of a table, which `references` keeps alive."""
        entry = self.kept.get(id(records)) if self.reused else None
        # Another record may have the address of one that is gone: the kept one must be the same.
        if entry is None or entry[0] is not records:
            entry = self._new_table(records)
            if self.reused:
                if len(self.kept) >= self.reused:
                    self.kept.clear()
                self.kept[id(records)] = entry
        references.append(entry)
        slots.append(entry[2])
        if self.counted:
            slots.append(len(records))

    def _new_table(self, records: Any) -> tuple[Any, Any, int]:
        inner: Slots = []
        below: Slots = []
        if self.counted:
            for record in records:
                self.inner.add(record, inner, below)
            table = bytearray(struct.pack(self.inner.format * len(records), *inner))
        else:
            self.inner.add(records, inner, below)
            table = bytearray(self.layout.pack(*inner))
        return records, (table, below), _ADDRESS(_BYTE(table)) if table else 0


Kind = NumberKind | ArrayKind | RecordKind | TableKind


def _new_kind(described: Any, description: dict[str, Any]) -> Kind:
    if isinstance(described, str):
        return NumberKind(described)
    if "array" in described:
        return ArrayKind(described, description)
    if "record" in described:
        return RecordKind(described, description)
    inner: Any = _new_kind(described["tuple"], description)
    return TableKind(inner, counted=True, reused=0)


class Face:
    """A function of one pointer to a table, with the arguments and results of its kernel.

    Parameters
    ----------
    function : of ctypes.
    description : of the records, rows and entries, among them that of the kernel.
    kernel : what the function runs.
    fallback : runs the kernel with arguments that this face was not built for; numba by default.
    """

    def __init__(
        self,
        function: Any,
        description: dict[str, Any],
        kernel: Kernel,
        fallback: Callable[..., Any] | None = None,
    ) -> None:
        entry = description["entries"][kernel.name]
        self.kernel = kernel
        self.fallback = fallback or kernel.run_by_numba
        self.function = function
        self.function.restype = None
        self.kinds = []
        for _, described in entry["arguments"]:
            kind: Any = _new_kind(described, description)
            if isinstance(kind, RecordKind):
                reused = REUSED.get(described["record"].rstrip("2"), 0)
                kind = TableKind(kind, counted=False, reused=reused)
            self.kinds.append(kind)
        arguments = "".join(kind.format for kind in self.kinds)
        results = "".join(NumberKind(kind).format for kind in entry["results"])
        self.arguments = struct.Struct(arguments)
        self.results = struct.Struct(results)
        self.table = ctypes.c_char * (8 * (len(arguments) + len(results)))
        self.single = entry["single"]

    def prepare(self, *arguments: Any) -> Callable[..., Any] | None:
        """Return a function of the numbers among the arguments; None if they do not fit.

        The table of the call is filled once, with the addresses of the records.
        """
        slots: Slots = []
        references: Slots = []
        table = self.table()
        content = memoryview(table).cast("B")
        views = {code: content.cast(code) for code in "dq"}  # type: ignore[call-overload]
        places = []
        try:
            for kind, argument in zip(self.kinds, arguments, strict=True):
                if isinstance(kind, NumberKind):
                    places.append((views[kind.format], len(slots)))
                kind.add(argument, slots, references)
            self.arguments.pack_into(table, 0, *slots)
        except (UnsuitableError, struct.error, ValueError):
            return None
        function, results = self.function, self.results.unpack_from
        first, single = self.arguments.size, self.single

        def call(*numbers: Any, _: Slots = references) -> Any:
            for (view, place), number in zip(places, numbers, strict=True):
                view[place] = number
            function(table)
            values = results(table, first)
            return values[0] if single else values or None

        return call

    def call(self, *arguments: Any) -> Any:
        """Call the kernel; arguments that do not fit are left to another face."""
        slots: Slots = []
        references: Slots = []
        table = self.table()
        try:
            for kind, argument in zip(self.kinds, arguments, strict=True):
                kind.add(argument, slots, references)
            self.arguments.pack_into(table, 0, *slots)
        except (UnsuitableError, struct.error, ValueError) as problem:
            if not has_numba():
                raise UnsuitableError(f"{self.kernel.name}(): {problem}") from None
            return self.fallback(*arguments)
        self.function(table)
        values = self.results.unpack_from(table, self.arguments.size)
        return values[0] if self.single else values or None
