"""Bearings as uniaxial materials that OpenSees runs itself, without a server.

`kernels/opensees.c` is such a material: it calls the step kernel of the libraries that are built
ahead of time. What it reads is written here: the constants, states and workspace of a bearing as
they lie in memory, and where among them the pointers are.
"""

import ctypes
import struct
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import BuiltinFunctionType
from typing import Any, get_args

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, short_repr
from thermobearing.border.text_file import write_file
from thermobearing.border.units import HUGEST, is_number
from thermobearing.core.compiled import native
from thermobearing.core.types import State, new_workspace
from thermobearing.model.element import BearingElement
from thermobearing.opensees.case import UnitNames, Units
from thermobearing.opensees.element import SHORTEST_STEP

NAME = "ThermoBearing"  # of the type of material
KIND = b"tb-ops-1"
HEAD = struct.Struct("=8s9q5d")  # `Head` in kernels/opensees.c
ALIGNED = 64  # [bytes]
STEP = "core.step.step"
BUILD = (
    "A material of OpenSees needs kernels compiled ahead of time: in a clone, run `make kernels`."
)


class _Image:
    """Records and arrays as kernels take them, with offsets in place of addresses."""

    def __init__(self, description: dict[str, Any]) -> None:
        self.records = description["records"]
        self.content = bytearray()
        self.pointers: list[int] = []  # where an offset stands

    def add(self, content: bytes) -> int:
        """Append bytes and return their offset."""
        self.content += bytes(-len(self.content) % ALIGNED)
        offset = len(self.content)
        self.content += content
        return offset

    def slots(self, kind: Any, value: Any) -> list[Any]:
        """Append the arrays of a value and return its slots; offsets stand in lists."""
        if isinstance(kind, str):
            return [float(value) if kind == "float" else int(value)]
        if "record" in kind:
            fields = zip(self.records[kind["record"]], value, strict=True)
            return [
                slot
                for (_, inner), field_value in fields
                for slot in self.slots(inner, field_value)
            ]
        return [[self.add(np.ascontiguousarray(value).tobytes())], *value.shape]

    def table(self, slots: list[Any]) -> int:
        """Append a table and return its offset."""
        plain = [slot[0] if isinstance(slot, list) else slot for slot in slots]
        form = "".join("d" if isinstance(slot, float) else "q" for slot in plain)
        offset = self.add(struct.pack(f"={form}", *plain))
        self.pointers += [offset + 8 * k for k, slot in enumerate(slots) if isinstance(slot, list)]
        return offset


@checked
def write_material(
    file: str | Path,
    element: BearingElement,
    *,
    units: str = "kN-mm",
    count: int = 1,
    rate: float | None = None,
) -> Path:
    """Write what `uniaxialMaterial ThermoBearing TAG FILE` reads in Tcl and xara.

    The file belongs to this machine: it names the library with the kernels, which a wheel has and
    `make kernels` builds in a clone.

    Parameters
    ----------
    file : to be written.
    element : from `tb.element`, without a hysteresis_law; its committed state is that at the start.
    units : force and length of the model, such as "kN-mm", "kN-m" or "N-m".
    count : number of equal bearings side by side that an element stands for.
    rate : speed [mm/s] of static analyses, > 0. Steps without velocity then last as long as this
        speed needs; by default, the time of the model is the clock, and must not go back.

    Returns
    -------
    Path : the file.

    Raises
    ------
    InputError : a number that is not positive, unknown units, or no compiled kernels for this
        machine.
    OutputError : the file cannot be written.

    Examples
    --------
    >>> import tempfile, thermobearing as tb
    >>> pier = tb.element("shen-hdr-bridge", ambient=-20)
    >>> folder = tempfile.mkdtemp()
    >>> write_material(Path(folder, "pier"), pier, units="kN-m").name  # doctest: +SKIP
    'pier'
    """
    if element.constants.rubber.law != 0:
        raise InputError("element: a file cannot hold a hysteresis_law; use add_material or serve")
    file = Path(file)
    write_file(file, _pack(element, units, count, rate)[0], overwrite=True)
    return file


def _pack(
    element: BearingElement, units: str, count: int, rate: float | None
) -> tuple[bytes, list[int]]:
    """Return the content of a file, and the offsets of the arrays of the committed state."""
    for name, number in {"count": count, "rate": 1.0 if rate is None else rate}.items():
        if not is_number(number) or not 0.0 < number < HUGEST:
            raise InputError(f"{name} = {number!r}: must be a positive number")
    if element.components > 1:
        raise InputError("element: a uniaxial material takes an element with one component")
    if units not in get_args(UnitNames):
        raise InputError(f"units = {units!r}: must be one of {', '.join(get_args(UnitNames))}")
    factors = Units.named(units)
    scales = factors.length, count / factors.force
    library, reason = native.open_library()
    if library is None:
        raise InputError(f"{reason} {BUILD}")
    image = _Image(library.description)
    kinds = dict(library.description["entries"][STEP]["arguments"])
    state = element.state
    values = {
        "constants": element.constants,
        "work": new_workspace(element.constants),
        "state": state,
        "new": state,
    }
    arguments: dict[str, Any] = {"x": 0.0, "dt": 0.0, "ambient": element.ambient}
    # Each value is written without gaps from `begin` on: the C code saves and restores a state
    # by copying its bytes.
    begins, arrays = {}, {}
    for name, value in values.items():
        begins[name] = image.add(b"")
        slots = image.slots(kinds[name], value)
        arrays[name] = [slot[0] for slot in slots if isinstance(slot, list)]
        size = len(image.content) - begins[name]
        arguments[name] = [image.table(slots)]
    begin = begins["state"]
    start = image.add(bytes(image.content[begin : begin + size]))
    call = image.table([*(arguments[name] for name in kinds), 0.0, 0.0, 0])
    texts = (str(library.file), library.description["sources"])
    places = [image.add(text.encode() + b"\0") for text in texts]
    pointers = len(image.pointers)
    offsets = (len(image.content), pointers, call, start, begin, begins["new"], size, *places)
    # The strain of the material is zero where the bearing is at the start.
    zero = float(state.response["displacement"][0])
    head = HEAD.pack(KIND, *offsets, *scales, zero, rate or 0.0, SHORTEST_STEP)
    return head + struct.pack(f"={pointers}q", *image.pointers) + image.content, arrays["state"]


@cache
def _material_library() -> ctypes.PyDLL:
    """Load `ThermoBearing.so`; a loader that is asked for this name finds it from then on."""
    file = native.FOLDER / f"{NAME}.so"
    if not native.library_name().startswith("linux-x86_64"):
        raise InputError("materials of OpenSees run on Linux with x86-64 only; serve the bearing")
    try:
        code = ctypes.PyDLL(str(file))  # openseespy writes messages through Python
    except OSError as problem:
        raise InputError(f"{problem}. {BUILD}") from None
    code.thermobearing_problem.restype = ctypes.c_char_p
    code.thermobearing_image.restype = ctypes.c_void_p
    return code


@checked
@dataclass(frozen=True)
class Material:
    """A bearing as a uniaxial material of a program.

    Attributes
    ----------
    tag : of the material.
    start : the state of every bearing at the start.
    places : of the arrays of a state in memory.
    """

    tag: int
    start: State
    places: list[int]

    def states(self) -> list[State]:
        """Return copies of the committed states of all elements with this material.

        They have the order in which the elements were added, and the fields of
        `BearingElement.state`.
        """
        code = _material_library()
        copies: list[State] = []
        while address := code.thermobearing_image(self.tag, len(copies) + 1):
            arrays: list[Any] = []
            for offset, array in zip(self.places, self.start, strict=True):
                content = np.frombuffer(
                    ctypes.string_at(address + offset, array.nbytes), array.dtype
                )
                arrays.append(content.reshape(array.shape).copy())
            copies.append(State(*arrays))
        return copies


@checked
def add_material(
    program: Any,
    tag: int,
    element: BearingElement,
    *,
    units: str = "kN-mm",
    count: int = 1,
    rate: float | None = None,
) -> Material:
    """Add a bearing as a uniaxial material to the model of a program; elements copy it.

    Strain is displacement and stress is force, as in `zeroLength` and `twoNodeLink`, which take one
    material of any kind for each direction.

    Parameters
    ----------
    program : the module `openseespy.opensees`, or a `Model` of xara.
    tag : of the material.
    element : from `tb.element`; its committed state is that at the start.
    units, count, rate : as of `write_material`.

    Returns
    -------
    Material : its `states` are those of the bearings.

    Raises
    ------
    InputError : the tag is in use; this version of the program cannot take it.

    Examples
    --------
    >>> import thermobearing as tb
    >>> import openseespy.opensees as ops  # doctest: +SKIP
    >>> pier = tb.element("shen-hdr-bridge", ambient=-20)
    >>> bearing = add_material(ops, 7, pier, units="N-m")  # doctest: +SKIP
    >>> ops.element("zeroLength", 101, 11, 21, "-mat", 7, "-dir", 1)  # doctest: +SKIP
    """
    if not callable(getattr(program, "wipe", None)):
        message = "must be the module openseespy.opensees, or a Model of xara"
        raise InputError(f"program = {short_repr(program)}: {message}", "add_material()")
    content, arrays = _pack(element, units, count, rate)
    code = _material_library()
    with tempfile.NamedTemporaryFile(suffix=".bearing") as file:
        file.write(content)
        file.flush()
        if not isinstance(program.wipe, BuiltinFunctionType):  # xara, which loads by name
            program.uniaxialMaterial(NAME, tag, file.name)
        else:
            module = str(sys.modules[program.wipe.__module__].__file__)
            if code.thermobearing_add(module.encode(), tag, file.name.encode()):
                raise InputError(f"add_material(): {code.thermobearing_problem().decode()}")
    return Material(tag, element.save(), arrays)
