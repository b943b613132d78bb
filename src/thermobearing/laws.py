"""Laws of your own: functions of a file that take the place of the laws of the package.

A file registers a law (`register`), a bearing names it (`temperature_law.law`,
`hysteresis_law.law`), and `model/constants.py` puts it into the constants of the coupled step. A
temperature law is tabulated: the step reads its table with the code that reads the tables of
bearing files, so that it needs no compiler and is available wherever a table is. A law of
hysteresis is compiled to a C function by numba, or called as Python where there is no numba, and
the step calls it by its address, which is valid in this process only.
"""

import ctypes
import hashlib
import inspect
import math
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from importlib.util import module_from_spec, spec_from_file_location
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError, nearest, read_bytes, shortened
from thermobearing.core.compiled.kernel import has_numba
from thermobearing.core.hysteresis import COMPONENTS, law_type
from thermobearing.core.records import Floats

__all__ = ["Law", "load", "register"]

BUILT_IN = ("published", "closed")  # laws of small loops (core/hysteresis.py), of every bearing
MARK = "@"  # between the name of a law and the digest of its source
LARGEST_FILE = 1_000_000  # bytes of a file with laws
USUAL_RANGE = (-60.0, 150.0)  # in which a temperature law is tabulated by default [degC]
COLDEST, WARMEST = -150.0, 300.0  # [degC]
SMALLEST, LARGEST = 1e-3, 1e3  # factors on a stiffness
FIRST_STEP, SHORTEST = 10.0, 0.02  # between temperatures of the table [K]
TABLE_ERROR = 1e-7  # largest relative difference of the table from the function
MOST_PIECES = 1000
MOST_PARAMETERS = 4  # of a law of hysteresis: LAW_1 to LAW_4 of the constants
LARGEST_Z = 4.0  # relative to d_y (EULER_LIMIT in core/sharing.py)
SLOPE_STEP, SLOPE_ERROR = 1e-6, 1e-5  # increment over d_y for differences, and their largest error
ENERGY_ERROR = 1e-9  # largest gain in a cycle, relative to the largest Z and d
AMPLITUDES = (0.3, 1.0, 3.0, 10.0)  # of checked cycles, over d_y
INCREMENTS = 200  # of a checked cycle; and twice, and four times
CONVERGED = 1e-9  # change of Z with shorter increments that needs no order
DIFFERENCE = 1e-3  # for slopes of the logarithm [K]
AXIS = np.array([0.6, 0.8])  # of the comparison of a plane with a line
BOUNDS = 10.0  # default bounds of a parameter in a calibration: its default over and times this


@dataclass(frozen=True, eq=False)
class Law:
    """A registered law.

    Attributes
    ----------
    name : by which bearings name it.
    kind : what it is of: "temperature" or "hysteresis".
    function : as registered.
    plane : the function for motions in a plane; None if there is none.
    parameters : default values by name, each in the unit that the function expects.
    bounds : lowest and highest value in a calibration, by name, each in the same unit.
    range : in which a temperature law is tabulated [degC].
    file : with the source code; None where there is none.
    digest : of the source code, 8 hexadecimal digits.

    Examples
    --------
    >>> law = register("softer", temperature=lambda t, rate=0.01: (1.0, 2.0 ** (-rate * (t - 23))))
    >>> law.kind, law.parameters
    ('temperature', {'rate': 0.01})
    """

    name: str
    kind: str
    function: Callable[..., Any]
    plane: Callable[..., Any] | None
    parameters: dict[str, float]
    bounds: dict[str, tuple[float, float]]
    range: tuple[float, float]
    file: Path | None
    digest: str

    @property
    def reference(self) -> str:
        """Name and digest, as results state them."""
        return f"{self.name}{MARK}{self.digest}"

    @property
    def addresses(self) -> tuple[int, int]:
        """Addresses of the C functions on a line and in a plane; 0 where there is none."""
        return _compiled(self)[0]

    def values(self, given: Mapping[str, float] | None) -> tuple[float, ...]:
        """Return the parameters in the order of the function, with defaults filled in."""
        for name in given or {}:
            if name not in self.parameters:
                known = nearest(name, self.parameters) if self.parameters else "; it has none"
                raise InputError(f'law "{self.name}": no parameter "{name}"{known}')
        return tuple((self.parameters | dict(given or {})).values())


_KNOWN: dict[str, Law] = {}  # by name
_LOADED: dict[Path, list[str]] = {}  # files of `load`, and the names in them
_APPLIED: list[str] = []  # laws that every bearing gets that is loaded; see `applied`


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
    if name in BUILT_IN:
        raise InputError("this is the name of a built-in law", where)
    function = hysteresis if temperature is None else temperature
    if not callable(function) or None not in (temperature, hysteresis):
        raise InputError("give one function: temperature or hysteresis", where)
    if plane is not None and (hysteresis is None or not callable(plane)):
        raise InputError("plane: must be a function, in addition to hysteresis", where)
    low, high = map(float, range)
    if not COLDEST <= low < high <= WARMEST:
        raise InputError(
            f"range = {low:g} to {high:g} degC: must be within {COLDEST:g} to {WARMEST:g}", where
        )
    parameters = _parameters(function, 1 if hysteresis is None else 2, where)
    if hysteresis is not None and len(parameters) > MOST_PARAMETERS:
        raise InputError(f"a law of hysteresis has at most {MOST_PARAMETERS} parameters", where)
    if plane is not None and _parameters(plane, 4, where) != parameters:
        raise InputError("plane: needs the parameters of hysteresis, with the same defaults", where)
    file, digest = _source(function)
    ends = _all_bounds(parameters, bounds or {}, where)
    kind = "temperature" if hysteresis is None else "hysteresis"
    law = Law(name, kind, function, plane, parameters, ends, (low, high), file, digest)
    if hysteresis is None:
        tabulate(law, law.values(None))
    else:
        check_hysteresis(law)
    _KNOWN[name] = law
    return law


def _parameters(function: Callable[..., Any], arguments: int, where: str) -> dict[str, float]:
    """Return the defaults of the arguments of a function after the first ones."""
    plain = getattr(function, "py_func", function)  # of one that numba compiles
    try:
        found = list(inspect.signature(plain).parameters.values())
    except (TypeError, ValueError):
        raise InputError("the function must be written in Python", where) from None
    if len(found) < arguments:
        raise InputError(f"the function needs {arguments} arguments at least", where)
    for one in found[arguments:]:
        if isinstance(one.default, bool) or not isinstance(one.default, int | float):
            raise InputError(
                f"the parameter {one.name} of the function needs a number as default value", where
            )
    return {one.name: float(one.default) for one in found[arguments:]}


def _all_bounds(
    parameters: Mapping[str, float], given: Mapping[str, tuple[float, float]], where: str
) -> dict[str, tuple[float, float]]:
    """Return the bounds of parameters; those of one with default 0 must be given."""
    found = {}
    for name in given:
        if name not in parameters:
            raise InputError(f'bounds: no parameter "{name}"{nearest(name, parameters)}', where)
    for name, value in parameters.items():
        if name not in given and value == 0.0:
            continue  # it can be set, but not be calibrated
        ends = given.get(name) or sorted((value / BOUNDS, value * BOUNDS))
        low, high = map(float, ends)
        if not low < high or not low <= value <= high:
            raise InputError(
                f"bounds of {name} = {low:g} to {high:g}: must contain its default {value:g}", where
            )
        found[name] = (low, high)
    return found


def _source(function: Callable[..., Any]) -> tuple[Path | None, str]:
    """Return the file of a function, and a digest of the file, or of the function alone."""
    plain: Any = getattr(function, "py_func", function)
    file = Path(plain.__code__.co_filename)
    if file.is_file():
        content = file.read_bytes().replace(b"\r\n", b"\n")
        return file.absolute(), hashlib.sha256(content).hexdigest()[:8]
    try:
        text = inspect.getsource(plain)
    except OSError:
        text = repr((plain.__code__.co_code, plain.__code__.co_consts))
    return None, hashlib.sha256(text.encode()).hexdigest()[:8]


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
    digest = hashlib.sha256(read_bytes(path, LARGEST_FILE)).hexdigest()[:8]
    before = dict(_KNOWN)
    module_name = f"thermobearing_law_{path.stem}_{digest}"
    spec: Any = spec_from_file_location(module_name, path)
    module = module_from_spec(spec)
    sys.modules[module_name] = module
    try:
        spec.loader.exec_module(module)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        sys.modules.pop(module_name, None)
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"cannot be run: {type(error).__name__}: {about}", str(file)) from error
    names = [name for name, law in _KNOWN.items() if before.get(name) is not law]
    if not names:
        raise InputError("registers no law; call tb.laws.register in it", str(file))
    _LOADED[path] = names
    return names


def loaded_files() -> list[str]:
    """Return the files of all registered laws, for other processes to load."""
    return sorted({str(law.file) for law in _KNOWN.values() if law.file is not None})


def load_again(files: Sequence[str]) -> None:
    """Load files in another process, unless its own program has registered their laws."""
    known = {law.file for law in _KNOWN.values()}
    for file in files:
        if Path(file) not in known:
            load(file)


@contextmanager
def applied(files: Sequence[str | Path]) -> Iterator[None]:
    """Load files, and use their laws and built-in ones in every bearing that is loaded meanwhile.

    Of several laws of one kind the bearing must name one itself.
    """
    given = [[str(file)] if str(file) in BUILT_IN else load(file) for file in files]
    names = [name for some in given for name in some]
    kinds = [_KNOWN[name].kind if name in _KNOWN else name for name in names]
    _APPLIED[:] = [n for n, kind in zip(names, kinds, strict=True) if kinds.count(kind) == 1]
    try:
        yield
    finally:
        _APPLIED.clear()


def laws_to_apply() -> list[str]:
    """Return the laws of `applied`, empty outside of it."""
    return list(_APPLIED)


def find_law(reference: str, kind: str = "") -> Law:
    """Return a registered law by its name, or by name and digest."""
    name, _, digest = reference.partition(MARK)
    law = _KNOWN.get(name)
    if law is None:
        known = nearest(name, [*BUILT_IN, *_KNOWN])
        raise InputError(
            f'law = "{reference}": is not registered{known}. Give the file that registers it: '
            "--law FILE, or tb.laws.load(FILE) in Python"
        )
    if kind and law.kind != kind:
        raise InputError(f'law = "{reference}": is a {law.kind} law, not a {kind} law')
    if digest and digest != law.digest:
        raise InputError(
            f'law = "{reference}": the registered law differs ("{law.reference}"). Give the '
            f'original file, or write law = "{name}" to use the law as it is now'
        )
    return law


@cache
def _compiled(law: Law) -> tuple[tuple[int, int], list[Any]]:
    """Return the addresses of C functions on a line and in a plane, and what must stay alive."""
    functions = [law.function, law.plane]
    made = [f and _c_function(f, k, len(law.parameters)) for k, f in enumerate(functions, 1)]
    return (made[0][0] if made[0] else 0, made[1][0] if made[1] else 0), made


def _c_function(function: Callable[..., Any], components: int, parameters: int) -> tuple[int, Any]:
    """Return the address of a C function, compiled by numba where possible, and its object."""
    given = 2 * components
    used, results = given + parameters, COMPONENTS[components]
    if not has_numba() or os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):

        def _write(*numbers: Any) -> None:
            for k, one in enumerate(function(*numbers[:used])):
                numbers[-1][k] = one

        called = law_type(components)(_write)
        return ctypes.cast(called, ctypes.c_void_p).value or 0, called
    import numba

    inner: Any = function
    if not hasattr(function, "py_func"):
        inner = numba.njit(error_model="numpy")(function)
    names = [f"a{k}" for k in range(given + MOST_PARAMETERS)]
    lines = [f"def law({', '.join(names)}, out):", f"    r = inner({', '.join(names[:used])})"]
    lines += [f"    out[{k}] = r[{k}]" for k in range(results)]
    space: dict[str, Any] = {"inner": inner}
    exec("\n".join(lines), space)
    kinds: Any = numba.types
    wanted = kinds.void(*[kinds.float64] * len(names), kinds.CPointer(kinds.float64))
    try:
        made = numba.cfunc(wanted)(space["law"])
    except numba.core.errors.NumbaError as error:
        about = shortened(str(error).strip().splitlines()[-1], 200)
        raise InputError(f"{function.__name__}: numba cannot compile it: {about}") from None
    return made.address or 0, made


def check_hysteresis(law: Law) -> None:
    """Check a law of hysteresis with its default parameters on a line and in a plane."""
    values = law.values(None)
    on_line = partial(_moved, law, law.function, values)
    for z, d in product(np.linspace(-0.97, 0.97, 7), (-2.1, -0.3, -1e-3, 1e-3, 0.3, 2.1)):
        _check_slope(law, on_line, np.array([z]), np.array([d]))
    for amplitude in AMPLITUDES:
        _check_cycle(law, on_line, amplitude * np.array([[1.0]]))
    for components, address in enumerate(law.addresses, 1):
        if address:
            _check_compiled(law, components, values)
    if law.plane is None:
        return
    in_plane = partial(_moved, law, law.plane, values)
    for z, d in product((-0.7, 0.4), (-1.3, 0.2)):
        after, slope = on_line(np.array([z]), np.array([d]))
        turned, slopes = in_plane(z * AXIS, d * AXIS)
        if not np.allclose(turned, after * AXIS, rtol=0.0, atol=SLOPE_ERROR) or not np.isclose(
            AXIS @ slopes @ AXIS, slope[0, 0], rtol=0.0, atol=SLOPE_ERROR
        ):
            raise InputError(
                f'law "{law.name}": the function plane differs from hysteresis on the line through '
                f"(0.6, 0.8), from Z = {z:g} by {d:g}"
            )
    for z_x, z_y, d_x, d_y in product((-0.5, 0.3), (0.4, -0.2), (-1.1, 0.2), (0.5, -0.01)):
        _check_slope(law, in_plane, np.array([z_x, z_y]), np.array([d_x, d_y]))
    for amplitude in AMPLITUDES:
        _check_cycle(law, in_plane, amplitude * np.eye(2))


def _moved(
    law: Law, function: Callable[..., Any], values: tuple[float, ...], z: Floats, d: Floats
) -> tuple[Floats, Floats]:
    """Return Z after an increment [c] and its slope [c, c]."""
    where = f'law "{law.name}" from Z = {_shown(z)} by {_shown(d)}'
    try:
        found = np.array(function(*z.tolist(), *d.tolist(), *values), dtype=float)
    except Exception as error:
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"{where}: {type(error).__name__}: {about}") from None
    if found.shape != (COMPONENTS[len(z)],):
        raise InputError(f"{where}: must return {COMPONENTS[len(z)]} numbers")
    if not np.isfinite(found).all() or np.abs(found[: len(z)]).max() > LARGEST_Z:
        raise InputError(
            f"{where}: returns {_shown(found)}: must be finite, and Z from -{LARGEST_Z:g} to "
            f"{LARGEST_Z:g} (relative to d_y)"
        )
    return found[: len(z)], found[len(z) :].reshape(len(z), len(z))


def _shown(numbers: Floats) -> str:
    return ", ".join(f"{one:.4g}" for one in numbers)


def _check_slope(law: Law, move: Callable[..., Any], z: Floats, d: Floats) -> None:
    """Compare the slope with differences, of one side where it jumps."""
    after, slope = move(z, d)
    for k, one in enumerate(np.eye(len(z))):
        sides = [(move(z, d + h * one)[0] - after) / h for h in (SLOPE_STEP, -SLOPE_STEP)]
        error = min(np.abs(side - slope[:, k]).max() for side in [*sides, sum(sides) / 2])
        if error > SLOPE_ERROR:
            raise InputError(
                f'law "{law.name}" from Z = {_shown(z)} by {_shown(d)}: dZ/dd is '
                f"{_shown(slope[:, k])}, but differences give {_shown(sides[0])}"
            )


def _check_cycle(law: Law, move: Callable[..., Any], axes: Floats) -> None:
    """Check that a steady cycle, in a plane a circle, gains no energy and that Z converges."""
    ends: list[Floats] = []
    for parts in (INCREMENTS, 2 * INCREMENTS, 4 * INCREMENTS):
        angle = np.linspace(0.0, 4.0 * np.pi, 2 * parts + 1)
        path = np.column_stack([np.sin(angle), 1.0 - np.cos(angle)])[:, : len(axes)] @ axes
        z, work, largest = np.zeros(len(axes)), 0.0, 0.0
        for k, d in enumerate(np.diff(path, axis=0)):
            before, (z, _) = z, move(z, d)
            work += float(0.5 * (before + z) @ d) if k >= parts else 0.0
            largest = max(largest, float(np.abs(z).max()))
        if work < -ENERGY_ERROR * max(largest, 1e-3) * axes.max():
            raise InputError(
                f'law "{law.name}": a cycle of amplitude {axes.max():g} d_y returns more energy '
                f"than it takes ({work:.3g} in units of d_y^2 times the hysteretic stiffness)"
            )
        ends.append(z)
    first, second = (float(np.abs(b - a).max()) for a, b in pairwise(ends))
    if second > max(CONVERGED, 0.7 * first):
        raise InputError(
            f'law "{law.name}": Z in a cycle of amplitude {axes.max():g} d_y does not converge '
            f"with shorter increments: it changes by {first:.2g} and then by {second:.2g}"
        )


def _check_compiled(law: Law, components: int, values: tuple[float, ...]) -> None:
    """Compare the C function with the Python function."""
    function = law.function if components == 1 else law.plane
    assert function is not None
    z, d = np.array([0.3, -0.4])[:components], np.array([-0.7, 0.2])[:components]
    room = (ctypes.c_double * COMPONENTS[components])()
    more = (*values, *[0.0] * (MOST_PARAMETERS - len(values)))
    law_type(components)(law.addresses[components - 1])(*z, *d, *more, room)
    after, slope = _moved(law, function, values, z, d)
    if not np.allclose(room, [*after, *slope.ravel()], rtol=1e-9, atol=1e-12):
        raise InputError(f'law "{law.name}": compiled by numba it gives other numbers')


@lru_cache(maxsize=256)
def tabulate(law: Law, values: tuple[float, ...]) -> tuple[Floats, Floats, Floats]:
    """Return temperatures [n], logarithms of the two factors there [n, 2], and their slopes.

    A cubic through values and slopes differs from the function by TABLE_ERROR at most, or is
    shorter than SHORTEST, where the function jumps.
    """
    low, high = law.range

    @cache
    def _at(t: float) -> tuple[Floats, Floats]:
        after, before = min(t + DIFFERENCE, high), max(t - DIFFERENCE, low)
        rise = _log_factors(law, values, after) - _log_factors(law, values, before)
        return _log_factors(law, values, t), rise / (after - before)

    def _fits(a: float, b: float) -> bool:
        (fa, sa), (fb, sb), h = _at(a), _at(b), b - a
        for s in (0.25, 0.5, 0.75):
            left, right = s * (1.0 - s) ** 2 * h * sa, s * s * (1.0 - s) * h * sb
            cubic = fa + s * s * (3.0 - 2.0 * s) * (fb - fa) + left - right
            if np.abs(cubic - _log_factors(law, values, a + s * h)).max() > TABLE_ERROR:
                return False
        return True

    def _nodes(a: float, b: float) -> list[float]:
        """Return the nodes in [a, b)."""
        if b - a < 2.0 * SHORTEST or _fits(a, b):
            return [a]
        middle = 0.5 * (a + b)
        return _nodes(a, middle) + _nodes(middle, b)

    coarse = np.linspace(low, high, math.ceil((high - low) / FIRST_STEP) + 1).tolist()
    found: list[float] = []
    for a, b in pairwise(coarse):
        found += _nodes(a, b)
        if len(found) > MOST_PIECES:
            raise InputError(
                f'law "{law.name}": changes too abruptly between {low:g} and {b:.4g} degC for a '
                f"table of {MOST_PIECES} pieces; give another range, or a smoother function"
            )
    found.append(high)
    logs, slopes = np.array([_at(t) for t in found]).transpose(1, 0, 2)
    return np.array(found), logs, slopes


def _log_factors(law: Law, values: tuple[float, ...], temperature: float) -> Floats:
    """Return the logarithms of both factors at a temperature [degC]."""
    shown = ", ".join(f"{n} = {v:g}" for n, v in zip(law.parameters, values, strict=True))
    where = f'law "{law.name}" at {temperature:.4g} degC' + (f" with {shown}" if shown else "")
    try:
        elastic, hysteretic = map(float, law.function(temperature, *values))
    except Exception as error:
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"{where}: {type(error).__name__}: {about}") from None
    for name, factor in (("elastic", elastic), ("hysteretic", hysteretic)):
        if not SMALLEST <= factor <= LARGEST:
            raise InputError(
                f"{where}: the {name} factor is {factor:g}: must be {SMALLEST:g} to {LARGEST:g}"
            )
    return np.log([elastic, hysteretic])
