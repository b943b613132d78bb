"""The register of laws: those of the package, and functions of a user's file.

A bearing states a law by the value of a key. The laws of the package are data (data/laws). A file
registers a law (`register`), which `model/constants.py` puts into the constants of the
coupled step. A temperature law is tabulated: the step reads its table with the code that reads the
tables of bearing files, so that it needs no compiler and is available wherever a table is. A law of
hysteresis is compiled to a C function by numba, or called as Python where there is no numba, and
the step calls it by its address, which is valid in this process only.
"""

import ctypes
import hashlib
import inspect
import math
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache, lru_cache, partial
from itertools import combinations, pairwise, product
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, short_repr, shortened
from thermobearing.border.library import data_path
from thermobearing.border.opener import read_bytes
from thermobearing.border.toml import read_toml
from thermobearing.core.compiled.kernel import has_numba
from thermobearing.core.hysteresis import COMPONENTS, law_type
from thermobearing.core.records import Floats

__all__ = ["Law", "load", "register"]

MARK = "@"  # between the name of a law and the digest of its source
LARGEST_FILE = 1_000_000  # bytes of a file with laws
USUAL_RANGE = (-60.0, 150.0)  # in which a temperature law is tabulated by default [degC]
COLDEST, WARMEST = -150.0, 300.0  # [degC]
SMALLEST, LARGEST = 1e-3, 1e3  # factors on a stiffness
FIRST_STEP, SHORTEST = 10.0, 1e-6  # between temperatures of the table [K]
TABLE_ERROR = 1e-7  # largest relative difference of the table from the function
MOST_PIECES = 1000
ARGUMENTS = {  # first ones of the function of a law: their number and meaning
    "temperature": (1, "the temperature of the rubber [degC]"),
    "hysteresis": (2, "Z and the increment of the displacement, both relative to d_y"),
    "plane": (4, "Z_x, Z_y and the two components of the increment, all relative to d_y"),
}
MOST_PARAMETERS = 4  # of a law of hysteresis: LAW_1 to LAW_4 of the constants
LARGEST_Z = 4.0  # relative to d_y (EULER_LIMIT in core/sharing.py)
SLOPE_STEP, SLOPE_ERROR = 1e-6, 1e-5  # increment over d_y for differences, and their largest error
ENERGY_ERROR = 1e-9  # largest gain in a cycle, relative to the largest Z and d
AMPLITUDES = (0.3, 1.0, 3.0, 10.0)  # of checked cycles, over d_y
INCREMENTS = 200  # of a checked cycle; and twice, and four times
CONVERGED = 1e-9  # change of Z with shorter increments that needs no order
DIFFERENCE = 1e-4  # for slopes of the logarithm [K]
CHECKED = {  # components: values of each of Z and d where slopes are checked
    1: (np.linspace(-0.97, 0.97, 7), (-2.1, -0.3, -1e-3, 1e-3, 0.3, 2.1)),
    2: ((-0.5, 0.3), (0.4, -0.2), (-1.1, 0.2), (0.5, -0.01)),
}
AXIS = np.array([0.6, 0.8])  # of the comparison of a plane with a line
Move = Callable[[Floats, Floats], tuple[Floats, Floats]]  # Z and d -> Z and its slope
BOUNDS = 10.0  # default bounds of a parameter in a calibration: its default over and times this


@checked
@dataclass(frozen=True, eq=False)
class Law:
    """A law of the package, or a registered one.

    Attributes
    ----------
    name : by which `--law` and `changed_bearing` choose it.
    kind : what it is of: "temperature", "hysteresis", "hardening" or "lead".
    description : in a sentence; of a registered law the first line of the function's docstring.
    source : publication, or file with the source code; "" where there is none.
    key : of a bearing that uses the law, such as "temperature_law.law".
    also : further keys of the same table, which get the same value.
    value : of that key; of a registered law its name and the digest of its source.
    function : as registered; None for a law of the package.
    plane : the function for motions in a plane; None if there is none.
    parameters : default values by name, each in the unit that the function expects.
    bounds : lowest and highest value in a calibration, by name, each in the same unit.
    range : in which a temperature law is tabulated [degC].

    Examples
    --------
    >>> law = register("softer", temperature=lambda t, rate=0.01: (1.0, 2.0 ** (-rate * (t - 23))))
    >>> law.kind, law.parameters
    ('temperature', {'rate': 0.01})
    """

    name: str
    kind: str
    description: str
    source: str
    key: str
    value: str
    function: Any = None
    plane: Any = None
    parameters: dict[str, float] = field(default_factory=dict)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)
    range: tuple[float, float] = USUAL_RANGE
    also: tuple[str, ...] = ()

    @property
    def keys_in_table(self) -> list[str]:
        """Return the names of the keys within the table of the bearing that has them."""
        return [key.partition(".")[2] for key in (self.key, *self.also)]

    @property
    def addresses(self) -> tuple[int, int]:
        """Addresses of the C functions on a line and in a plane; 0 where there is none."""
        on_line, in_plane = _compiled(self)
        return on_line[0], in_plane[0]

    def values(self, parameters: Mapping[str, float] | None) -> tuple[float, ...]:
        """Return the parameters in the order of the function, with defaults filled in."""
        for name in parameters or {}:
            if name not in self.parameters:
                hint = nearest(name, self.parameters)
                raise InputError(f'law "{self.name}": no parameter "{name}"{hint}')
        return tuple((self.parameters | dict(parameters or {})).values())

    def shown(self, values: Sequence[float]) -> str:
        """Return the parameters with their values, in words."""
        if len(values) != len(self.parameters):
            count = f"{len(values)} values for {len(self.parameters)} parameters"
            raise InputError(f'law "{self.name}": {count}')
        return ", ".join(f"{n} = {v:g}" for n, v in zip(self.parameters, values, strict=True))


@cache
def built_in_laws() -> dict[str, Law]:
    """Return the laws of the package, by name."""
    table = read_toml(data_path("laws", "built_in.toml"))["laws"]
    return {
        name: Law(name, **row | {"also": tuple(row.get("also", ()))}) for name, row in table.items()
    }


_REGISTERED: dict[str, Law] = {}  # by name, of this program
# Laws by name of a command or of a file that is being run, in place of those of the program: they
# end with the command, and another thread does not see them.
_SCOPE: ContextVar[dict[str, Law] | None] = ContextVar("registered_laws", default=None)
# Names of the laws that every bearing gets that is loaded in a command; see `applied`.
_APPLIED: ContextVar[tuple[str, ...]] = ContextVar("applied_laws", default=())


def _registered() -> dict[str, Law]:
    """Return the registered laws by name, of the running command if there is one."""
    scope = _SCOPE.get()
    return _REGISTERED if scope is None else scope


@contextmanager
def _scope() -> Iterator[dict[str, Law]]:
    """Register laws meanwhile in a copy of the register, which is returned."""
    token = _SCOPE.set(dict(_registered()))
    try:
        yield _registered()
    finally:
        _SCOPE.reset(token)


@checked
def register(
    name: str,
    *,
    temperature: Callable[..., tuple[float, float]] | None = None,
    hysteresis: Callable[..., tuple[float, float]] | None = None,
    plane: Callable[..., Any] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    range: tuple[float, float] = USUAL_RANGE,
) -> Law:
    """Register a law, after checks, under a name that bearings can state.

    Parameters
    ----------
    name : letters, digits, "-", "_" and "."; a law of that name is replaced.
    temperature : function of the temperature of a rubber layer [degC] and of parameters with
        default values; it returns the factors on the elastic and on the hysteretic stiffness, in
        [1e-3, 1e3]. They multiply the factors by m_T and n_T; set both to 0 for a complete law.
    hysteresis : function of Z and of an increment of the displacement of a layer, both relative to
        d_y, and of at most 4 parameters with default values; it returns Z at the end of the
        increment, in [-4, 4], and dZ/dd there. Give this or `temperature`.
    plane : the same function for motions in a plane: of Z_x, Z_y, the two components of the
        increment, and the parameters; it returns Z_x, Z_y, and dZ/dd by rows (xx, xy, yx, yy).
        Without it the law cannot be used in a plane.
    bounds : lowest and highest value of parameters in a calibration, by name, in the unit that the
        function expects; a tenth and ten times the default for others.
    range : of temperatures in which a temperature law is used [degC], within -150 to 300; beyond it
        the logarithms of the factors continue with their slopes at the ends.

    Returns
    -------
    Law

    Raises
    ------
    InputError : a name, bounds or range that cannot be; a function that fails; factors that are not
        finite and positive, or change too abruptly for a table; a law of hysteresis whose slope is
        not its derivative, that gains energy in a cycle, or does not converge with shorter
        increments.

    Examples
    --------
    >>> import math
    >>> import thermobearing as tb
    >>> def arrhenius(temperature, elastic=300.0, hysteretic=900.0):
    ...     inverse = 1.0 / (temperature + 273.15) - 1.0 / 296.15
    ...     return math.exp(elastic * inverse), math.exp(hysteretic * inverse)
    >>> _ = tb.laws.register("arrhenius", temperature=arrhenius)
    >>> cold = tb.changed_bearing("shen-hdr-specimen", law="arrhenius")
    >>> result = tb.run(cold, tb.cyclic_test(strain=[0.5], cycles=1), ambient=-20)
    >>> result.outcome
    'completed'
    """
    where = f'laws.register("{shortened(str(name))}")'
    if not isinstance(name, str) or not name.replace("-", "").replace(".", "").isidentifier():
        raise InputError('the name must consist of letters, digits, "-", "_" and "."', where)
    if name in built_in_laws():
        raise InputError("this is the name of a built-in law", where)
    kind, function = "temperature", temperature
    if temperature is None:
        kind, function = "hysteresis", hysteresis
    if not callable(function) or None not in (temperature, hysteresis):
        raise InputError("give one function: temperature or hysteresis", where)
    if plane is not None and (hysteresis is None or not callable(plane)):
        raise InputError("plane: must be a function, in addition to hysteresis", where)
    if not hasattr(getattr(function, "py_func", function), "__code__"):
        raise InputError(f"{kind}: must be a function written in Python", where)
    low, high = _two_numbers(range, "range", where)
    if not COLDEST <= low < high <= WARMEST:
        raise InputError(
            f"range = {low:g} to {high:g} degC: must be within {COLDEST:g} to {WARMEST:g}", where
        )
    parameters = _parameters(function, kind, where)
    if hysteresis is not None and len(parameters) > MOST_PARAMETERS:
        raise InputError(f"a law of hysteresis has at most {MOST_PARAMETERS} parameters", where)
    if plane is not None and _parameters(plane, "plane", where) != parameters:
        raise InputError("plane: needs the parameters of hysteresis, with the same defaults", where)
    source, digest = _source(function)
    law = Law(
        name=name,
        kind=kind,
        description=(inspect.getdoc(function) or "").partition("\n")[0],
        source=source,
        key=f"{kind}_law.law",
        value=f"{name}{MARK}{digest}",
        function=function,
        plane=plane,
        parameters=parameters,
        bounds=_all_bounds(parameters, bounds or {}, where),
        range=(low, high),
    )
    if hysteresis is None:
        tabulate(law, law.values(None))
    else:
        check_hysteresis(law)
    _registered()[name] = law
    return law


def _parameters(function: Callable[..., Any], kind: str, where: str) -> dict[str, float]:
    """Return the defaults of the arguments of a function after the first ones."""
    plain = getattr(function, "py_func", function)  # of one that numba compiles
    try:
        all_arguments = list(inspect.signature(plain).parameters.values())
    except (TypeError, ValueError):
        raise InputError("the function must be written in Python", where) from None
    arguments, words = ARGUMENTS[kind]
    if len(all_arguments) < arguments:
        raise InputError(f"{kind}: the function must take {words} first, then parameters", where)
    for argument in all_arguments[arguments:]:
        if isinstance(argument.default, bool) or not isinstance(argument.default, int | float):
            raise InputError(
                f"the parameter {argument.name} of the function needs a number as default value",
                where,
            )
    return {argument.name: float(argument.default) for argument in all_arguments[arguments:]}


def _two_numbers(value: Any, key: str, where: str) -> tuple[float, float]:
    try:
        low, high = map(float, value)
    except (TypeError, ValueError):
        value_text = short_repr(value)
        raise InputError(f"{key} = {value_text}: must be two numbers", where) from None
    return low, high


def _all_bounds(
    parameters: Mapping[str, float], stated: Mapping[str, tuple[float, float]], where: str
) -> dict[str, tuple[float, float]]:
    """Return the bounds of parameters; those of one with default 0 must be given."""
    all_bounds = {}
    for name in stated:
        if name not in parameters:
            raise InputError(f'bounds: no parameter "{name}"{nearest(name, parameters)}', where)
    for name, value in parameters.items():
        if name not in stated and value == 0.0:
            continue  # it can be set, but not be calibrated
        ends = stated.get(name) or sorted((value / BOUNDS, value * BOUNDS))
        low, high = _two_numbers(ends, f"bounds of {name}", where)
        if not low < high or not low <= value <= high:
            raise InputError(
                f"bounds of {name} = {low:g} to {high:g}: must contain its default {value:g}", where
            )
        all_bounds[name] = (low, high)
    return all_bounds


def _source(function: Callable[..., Any]) -> tuple[str, str]:
    """Return the file of a function, and 8 digits of the file, or of the function alone."""
    plain: Any = getattr(function, "py_func", function)
    file = Path(plain.__code__.co_filename)
    if file.is_file():
        content = read_bytes(file, LARGEST_FILE).replace(b"\r\n", b"\n")
        return str(file.absolute()), hashlib.sha256(content).hexdigest()[:8]
    try:
        text = inspect.getsource(plain)
    except OSError:
        text = repr((plain.__code__.co_code, plain.__code__.co_consts))
    return "", hashlib.sha256(text.encode()).hexdigest()[:8]


@checked
def load(file: str | Path) -> list[str]:
    r"""Run a Python file that registers laws, and return their names.

    Parameters
    ----------
    file : ending in ".py". It is executed: load files only that you trust.

    Returns
    -------
    list of str : names of the laws, in the order of their registration.

    Raises
    ------
    InputError : the file cannot be read, fails, or registers no law.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> text = "import thermobearing as tb\n"
    >>> text += "tb.laws.register('flat', temperature=lambda t: (1.0, 1.0))\n"
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "my_law.py"
    ...     _ = path.write_text(text)
    ...     load(path)
    ['flat']
    """
    path = Path(file).absolute()
    if path.suffix != ".py":
        raise InputError("must be a Python file, ending in .py", str(file))
    content, laws = read_bytes(path, LARGEST_FILE), _registered()
    module = ModuleType(f"thermobearing_law_{path.stem}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module
    try:
        with _scope() as laws_after:
            exec(compile(content, path, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        frames = traceback.extract_tb(error.__traceback__)
        lines = [f", line {frame.lineno}" for frame in frames if frame.filename == str(path)]
        problems = [f"cannot be run: {_failure(error)}"]
        if isinstance(error, InputError):
            problems = error.lines()
        raise InputError(problems, f"{file}{lines[-1] if lines else ''}") from error
    new_laws = {name: law for name, law in laws_after.items() if laws.get(name) is not law}
    if not new_laws:
        raise InputError("registers no law; call tb.laws.register in it", str(file))
    laws.update(new_laws)
    return list(new_laws)


def _failure(error: BaseException) -> str:
    """Return kind and message of an exception."""
    return f"{type(error).__name__}: {shortened(str(error) or 'no message')}"


def loaded_files() -> list[str]:
    """Return the files of all registered laws, for other processes to load."""
    return sorted({law.source for law in _registered().values()} - {""})


def load_again(files: Sequence[str]) -> None:
    """Load files in another process, unless its own program has registered their laws."""
    for file in set(files).difference(loaded_files()):
        load(file)


@contextmanager
def applied(references: Sequence[str | Path]) -> Iterator[None]:
    """Use laws, by name or file, in every bearing that this context loads meanwhile.

    Laws of the files are registered meanwhile only, and in this thread: the threads of an analysis
    get constants, in which no law is looked up.

    A bearing that names a registered law gets no other registered one. Of several laws of one kind
    in files one is chosen by its name, here or in the bearing.
    """
    files = [str(reference) for reference in references]
    with _scope():
        names: list[str] = []
        for reference in files:
            names += load(reference) if reference.endswith(".py") else [reference]
        laws = [find_law(name) for name in dict.fromkeys(names)]
        kinds = [law.kind for law in laws]
        chosen = [law for law in laws if {law.name, law.value} & set(files)]
        for law, second in combinations(chosen, 2):
            if law.kind == second.kind:
                raise InputError(f"--law {law.name}: is a {law.kind} law, and so is {second.name}")
        usable = [law for law in laws if law in chosen or kinds.count(law.kind) == 1]
        token = _APPLIED.set(tuple(law.name for law in usable))
        try:
            yield
        finally:
            _APPLIED.reset(token)


def laws_to_apply() -> list[str]:
    """Return the laws of `applied`, empty outside of it."""
    return list(_APPLIED.get())


def known_laws() -> dict[str, Law]:
    """Return the laws of the package and the registered ones, by name."""
    return built_in_laws() | _registered()


def find_law(reference: str, kind: str = "") -> Law:
    """Return a law by its name, or by name and digest; with `kind` a registered one of that."""
    name, _, digest = reference.partition(MARK)
    law = known_laws().get(name)
    if law is None:
        candidates = [
            n
            for n, candidate in known_laws().items()
            if not kind or candidate.key == f"{kind}_law.law"
        ]
        raise InputError(
            f'law = "{reference}": is not registered; give the file that registers it (--law FILE, '
            f"or tb.laws.load(FILE) in Python){nearest(name, candidates)}"
        )
    if kind and law.kind != kind:
        raise InputError(f'law = "{reference}": is a {law.kind} law, not a {kind} law')
    if kind and law.function is None:
        raise InputError(f'law = "{name}": is built in; write {law.key} = "{law.value}"')
    if digest and reference != law.value:
        raise InputError(
            f'law = "{reference}": the registered law differs ("{law.value}"). Give the '
            f'original file, or write law = "{name}" to use the law as it is now'
        )
    return law


@cache
def _compiled(law: Law) -> list[tuple[int, Any]]:
    """Return the C functions on a line and in a plane: addresses, and what must stay alive."""
    functions = enumerate((law.function, law.plane), 1)
    return [_c_function(f, k, len(law.parameters)) if f else (0, None) for k, f in functions]


def _c_function(function: Callable[..., Any], components: int, parameters: int) -> tuple[int, Any]:
    """Return the address of a C function, compiled by numba where possible, and its object."""
    state_count = 2 * components
    argument_count, results = state_count + parameters, COMPONENTS[components]
    if not has_numba() or os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):

        def _write(*numbers: Any) -> None:
            for k, number in enumerate(function(*numbers[:argument_count])):
                numbers[-1][k] = number

        callback = law_type(components)(_write)
        return ctypes.cast(callback, ctypes.c_void_p).value or 0, callback
    import numba

    inner: Any = function
    if not hasattr(function, "py_func"):
        inner = numba.njit(error_model="numpy")(function)
    names = [f"a{k}" for k in range(state_count + MOST_PARAMETERS)]
    # A C function returns one number and has fixed arguments: this one writes into `out`, and
    # takes parameters that the law does not have.
    lines = [
        f"def law({', '.join(names)}, out):",
        f"    r = inner({', '.join(names[:argument_count])})",
    ]
    lines += [f"    out[{k}] = r[{k}]" for k in range(results)]
    space: dict[str, Any] = {"inner": inner}
    exec("\n".join(lines), space)
    kinds: Any = numba.types
    signature = kinds.void(*[kinds.float64] * len(names), kinds.CPointer(kinds.float64))
    try:
        compiled = numba.cfunc(signature)(space["law"])
    except numba.core.errors.NumbaError as error:
        error_text = shortened(str(error).strip().splitlines()[-1], 200)
        raise InputError(f"{function.__name__}: numba cannot compile it: {error_text}") from None
    return compiled.address or 0, compiled


def check_hysteresis(law: Law) -> None:
    """Check a law of hysteresis with its default parameters on a line and in a plane."""
    values = law.values(None)
    moves = [partial(_moved, law, f, values) for f in (law.function, law.plane) if f is not None]
    for components, move in enumerate(moves, 1):
        if components == 2:
            _check_line(law, *moves)
        for numbers in product(*CHECKED[components]):
            _check_slope(law, move, np.array(numbers[:components]), np.array(numbers[components:]))
        for amplitude in AMPLITUDES:
            _check_cycle(law, move, amplitude * np.eye(components))
        _check_compiled(law, components, move, values)


def _check_line(law: Law, on_line: Move, in_plane: Move) -> None:
    """Compare a plane with a line: AXIS."""
    for z, d in product((-0.7, 0.4), (-1.3, 0.2)):
        after, slope = on_line(np.array([z]), np.array([d]))
        turned, slopes = in_plane(z * AXIS, d * AXIS)
        expected = [*after * AXIS, slope[0, 0]]
        if not np.allclose([*turned, AXIS @ slopes @ AXIS], expected, rtol=0.0, atol=SLOPE_ERROR):
            raise InputError(
                f'law "{law.name}": the function plane differs from hysteresis on the line through '
                f"(0.6, 0.8), from Z = {z:g} by {d:g}"
            )


def _moved(
    law: Law, function: Any, values: tuple[float, ...], z: Floats, d: Floats
) -> tuple[Floats, Floats]:
    """Return Z after an increment [c] and its slope [c, c]."""
    where = f'law "{law.name}" from Z = {_shown(z)} by {_shown(d)}'
    returned = _numbers(function, (*z.tolist(), *d.tolist(), *values), COMPONENTS[len(z)], where)
    if not np.isfinite(returned).all() or np.abs(returned[: len(z)]).max() > LARGEST_Z:
        raise InputError(
            f"{where}: returns {_shown(returned)}: must be finite, and Z from -{LARGEST_Z:g} to "
            f"{LARGEST_Z:g} (relative to d_y)"
        )
    return returned[: len(z)], returned[len(z) :].reshape(len(z), len(z))


def _numbers(function: Any, arguments: tuple[float, ...], count: int, where: str) -> Floats:
    """Return what the function of a law returns, whatever may fail in it."""
    try:
        value = function(*arguments)
        if inspect.iscoroutine(value):
            value.close()
            value = None  # nobody waits for it
        numbers = np.array(value, dtype=float)
    except Exception as error:
        raise InputError(f"{where}: {_failure(error)}") from None
    if value is None:
        raise InputError(
            f"{where}: must return {count} numbers, not None; a law is no async function"
        )
    if numbers.shape != (count,):
        raise InputError(f"{where}: must return {count} numbers")
    return numbers


def _shown(numbers: Floats) -> str:
    return ", ".join(f"{number:.4g}" for number in numbers)


def _check_slope(law: Law, move: Move, z: Floats, d: Floats) -> None:
    """Compare the slope with differences, of one side where it jumps."""
    after, slope = move(z, d)
    for k, direction in enumerate(np.eye(len(z))):
        sides = [(move(z, d + h * direction)[0] - after) / h for h in (SLOPE_STEP, -SLOPE_STEP)]
        error = min(np.abs(side - slope[:, k]).max() for side in [*sides, sum(sides) / 2])
        if error > SLOPE_ERROR:
            raise InputError(
                f'law "{law.name}" from Z = {_shown(z)} by {_shown(d)}: dZ/dd is '
                f"{_shown(slope[:, k])}, but differences give {_shown(sides[0])}"
            )


def _check_cycle(law: Law, move: Move, axes: Floats) -> None:
    """Check that a steady cycle, in a plane a circle, gains no energy and that Z converges."""
    ends: list[Floats] = []
    for parts in (INCREMENTS, 2 * INCREMENTS, 4 * INCREMENTS):
        angle = np.linspace(0.0, 4.0 * np.pi, 2 * parts + 1)
        path = np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])[:, : len(axes)] @ axes
        z, work, largest = np.zeros(len(axes)), 0.0, 0.0
        for k, d in enumerate(np.diff(path, axis=0)):
            before = z
            z, _ = move(before, d)
            # The second of two cycles counts: the first begins away from the steady loop.
            work += float(0.5 * (before + z) @ d) if k >= parts else 0.0
            largest = max(largest, float(np.abs(z).max()))
        if work < -ENERGY_ERROR * max(largest, 1e-3) * axes.max():
            raise InputError(
                f'law "{law.name}": a cycle of amplitude {axes.max():g} d_y returns more energy '
                f"than it takes ({work:.3g} in units of d_y^2 times the hysteretic stiffness)"
            )
        ends.append(z)
    first, second = (float(np.abs(b - a).max()) for a, b in pairwise(ends))
    # Half the increments halve a change of first order; 0.7 leaves room for slower laws.
    if second > max(CONVERGED, 0.7 * first):
        raise InputError(
            f'law "{law.name}": Z in a cycle of amplitude {axes.max():g} d_y does not converge '
            f"with shorter increments: it changes by {first:.2g} and then by {second:.2g}"
        )


def _check_compiled(law: Law, components: int, move: Move, values: tuple[float, ...]) -> None:
    """Compare the C function with the Python function."""
    z, d = np.array([0.3, -0.4])[:components], np.array([-0.7, 0.2])[:components]
    output = (ctypes.c_double * COMPONENTS[components])()
    parameters = (*values, *[0.0] * (MOST_PARAMETERS - len(values)))
    law_type(components)(law.addresses[components - 1])(*z, *d, *parameters, output)
    after, slope = move(z, d)
    if not np.allclose(output, [*after, *slope.ravel()], rtol=1e-9, atol=1e-12):
        raise InputError(f'law "{law.name}": compiled by numba it gives other numbers')


@lru_cache(maxsize=256)
def tabulate(law: Law, values: tuple[float, ...]) -> tuple[Floats, Floats, Floats]:
    """Return temperatures [n], logarithms of the two factors there [n, 2], and their slopes.

    A cubic through values and slopes differs from the function by TABLE_ERROR at most. The function
    may bend, but not jump.
    """
    low, high = law.range

    @cache
    def _at(t: float) -> tuple[Floats, Floats]:
        after, before = min(t + DIFFERENCE, high), max(t - DIFFERENCE, low)
        rise = _log_factors(law, values, after) - _log_factors(law, values, before)
        return _log_factors(law, values, t), rise / (after - before)

    def _fits(a: float, b: float) -> bool:
        # Cubic Hermite polynomial of the values f and slopes s at both ends.
        (fa, sa), (fb, sb), h = _at(a), _at(b), b - a
        for s in (0.25, 0.5, 0.75):
            left, right = s * (1.0 - s) ** 2 * h * sa, s * s * (1.0 - s) * h * sb
            cubic = fa + s * s * (3.0 - 2.0 * s) * (fb - fa) + left - right
            if np.abs(cubic - _log_factors(law, values, a + s * h)).max() > TABLE_ERROR:
                return False
        return True

    nodes: list[float] = []

    def _add_nodes(a: float, b: float) -> None:
        """Add the nodes in [a, b)."""
        if _fits(a, b):
            nodes.append(a)
        elif b - a < SHORTEST:
            raise InputError(
                f'law "{law.name}": jumps, or changes too abruptly, at {round(b, 3) + 0.0:g} degC; '
                "the function must be continuous: connect its branches by a ramp"
            )
        else:
            _add_nodes(a, 0.5 * (a + b))
            _add_nodes(0.5 * (a + b), b)
        if len(nodes) > MOST_PIECES:
            raise InputError(
                f'law "{law.name}": changes too abruptly between {low:g} and {b:.4g} degC for a '
                f"table of {MOST_PIECES} pieces; give another range, or a smoother function"
            )

    for a, b in pairwise(np.linspace(low, high, math.ceil((high - low) / FIRST_STEP) + 1).tolist()):
        _add_nodes(a, b)
    nodes.append(high)
    logs, slopes = np.array([_at(t) for t in nodes]).transpose(1, 0, 2)
    return np.array(nodes), logs, slopes


def _log_factors(law: Law, values: tuple[float, ...], temperature: float) -> Floats:
    """Return the logarithms of both factors at a temperature [degC]."""
    parameters = law.shown(values)
    where = f'law "{law.name}" at {temperature:.4g} degC'
    if parameters:
        where = f"{where} with {parameters}"
    factors = _numbers(law.function, (temperature, *values), 2, where)
    for name, factor in zip(("elastic", "hysteretic"), factors, strict=True):
        if not SMALLEST <= factor <= LARGEST:
            raise InputError(
                f"{where}: the {name} factor is {factor:g}: must be {SMALLEST:g} to {LARGEST:g}"
            )
    return np.log(factors)
