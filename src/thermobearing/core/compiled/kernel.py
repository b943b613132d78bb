"""The decorator of kernels.

Every kernel is marked by the decorator `compiled`. Its first call decides what runs it
(`runners.py`). Physics imports this module, and the compiler imports physics; so this module
imports no compiler, and `runners.py` registers here what runs kernels.
"""

import importlib.util
import inspect
from collections.abc import Callable
from functools import cache, cached_property, update_wrapper
from typing import Any, NamedTuple, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R")


class Runners(NamedTuple):
    """What runs kernels and compiles them; the first argument of each function is a kernel."""

    choose: Callable[..., Callable[..., Any]]  # for the arguments of the first call, as a tuple
    run_by_numba: Callable[..., Any]  # with the arguments of a call
    part: Callable[..., Any]  # as numba compiles it into other kernels
    dispatcher: Callable[..., Any]  # as numba compiles it alone, for any arguments


REGISTERED: list[Runners] = []  # one, by the package `compiled` when it is imported


class Kernel:
    """A function that is run as machine code; the plain Python is `py_func`."""

    def __init__(self, function: Callable[..., Any], use: str = "inline") -> None:
        self.py_func = function
        self.use = use  # in other kernels: "inline", "once", "rare" or "shared"
        self.run: Callable[..., Any] = self._first_call
        update_wrapper(self, function)

    @property
    def name(self) -> str:
        """The place of the kernel in the package, as "core.march.march"."""
        return f"{self.__module__.partition('.')[2]}.{self.__qualname__}"

    @cached_property
    def part(self) -> Any:
        """The function as numba compiles it into other kernels."""
        return REGISTERED[0].part(self)

    @cached_property
    def dispatcher(self) -> Any:
        """The function as numba compiles it alone, for any arguments."""
        return REGISTERED[0].dispatcher(self)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Run the kernel."""
        if named:
            arguments = inspect.signature(self.py_func).bind(*arguments, **named).args
        return self.run(*arguments)

    def _first_call(self, *arguments: Any) -> Any:
        return self.chosen(arguments)(*arguments)

    def chosen(self, arguments: tuple[Any, ...]) -> Callable[..., Any]:
        """Return what runs the kernel, which its first arguments decide."""
        if self.run == self._first_call:
            self.run = REGISTERED[0].choose(self, arguments)
        return self.run

    def run_by_numba(self, *arguments: Any) -> Any:
        """Run the kernel by machine code that numba makes for these arguments."""
        return REGISTERED[0].run_by_numba(self, *arguments)

    def __getattr__(self, name: str) -> Any:
        """Return what numba knows of the function, such as `stats`."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    def __reduce__(self) -> str:
        """Return the name, by which another process finds the kernel."""
        return self.py_func.__qualname__


def prepare(kernel: Callable[..., R], *arguments: Any) -> Callable[..., R]:
    """Return what runs a kernel on the same records each time; it takes the numbers only.

    Parameters
    ----------
    kernel : marked with `compiled`.
    arguments : all of a call; the values of numbers among them do not matter.
    """
    face = getattr(cast("Kernel", kernel).chosen(arguments), "__self__", None)
    places = [k for k, argument in enumerate(arguments) if isinstance(argument, float | int)]

    def call(*numbers: float) -> R:
        values = [*arguments]
        for place, number in zip(places, numbers, strict=True):
            values[place] = number
        return kernel(*values)

    return (face and face.prepare(*arguments)) or call


@cache
def has_numba() -> bool:
    """Return whether numba is installed."""
    return importlib.util.find_spec("numba") is not None


def compiled(function: F) -> F:
    """Mark a function as a kernel, which is run as machine code.

    `contract` lets the compiler fuse a multiply and an add (same bits on one machine);
    no other floating-point rule is relaxed, so NaN checks and signs stay as written.
    `_nrt=False` leaves out numba's reference counting of arrays, and `forceinline` the passing
    of records between functions; each took more time than the physics. The price is that
    kernels cannot allocate, which they must not anyway. Without allocation nothing needs the
    interpreter, so threads may run side by side (`nogil`).
    """
    return cast(F, Kernel(function))


def compiled_apart(function: F) -> F:
    """Mark a function as a kernel that most steps do not run, such as the first step.

    It is called and not written into the kernels that call it. What every step runs stays small
    then, and fits the instruction cache of a processor (32 kB).
    """
    return cast(F, Kernel(function, "rare"))


def compiled_once(function: F) -> F:
    """Mark a function as a kernel that is called from several places, and not written into them.

    As with `compiled_apart`, what every step runs stays small; but here every step runs it.
    """
    return cast(F, Kernel(function, "once"))


def compiled_shared(function: F) -> F:
    """Mark a function as a kernel whose machine code is made once, for all kernels that call it.

    These are long functions that take little but records, such as the parts of a step: a call costs
    a hundredth of their time, and to write them into each caller took most of that of LLVM.
    """
    return cast(F, Kernel(function, "shared"))
