"""Wrong arguments of every public callable: one after another, in calls that are valid otherwise.

The valid call is the first one of the example of a docstring, or one of `CALLS`, where an example
takes long or there is none. `python -m tests.fuzz.misuse [NAME ...]` tries all values and prints
how many calls end in an exception of another library, by name. No tests.
"""

import contextlib
import doctest
import importlib
import inspect
import io
import os
import signal
import sys
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType, SimpleNamespace
from typing import Any

import numpy as np

import thermobearing as tb
from tests.fuzz.judge import TookTooLong
from thermobearing.border.errors import ThermobearingError

SECONDS = 5.0  # of processor time, which no wrong argument may take
MODULES = ("laws", "opensees")


class _Fixed:
    """An object of no type that a function takes, with a text that does not change."""

    def __repr__(self) -> str:
        return "<object>"


# None is also a value that many arguments take; so are some of the numbers and texts.
VALUES: dict[str, Any] = {
    "None": None,
    "True": True,
    "empty text": "",
    "text": "x",
    "5": 5,
    "-1": -1,
    "0": 0,
    "0.5": 0.5,
    "nan": float("nan"),
    "inf": float("inf"),
    "1e300": 1e300,
    "empty list": [],
    "list": [1.0, "x"],
    "list of None": [None],
    "table": {},
    "table of 1": {"x": 1},
    "table of numbers": {1: 2},
    "object": _Fixed(),
    "class": int,
    "bytes": b"x",
    "complex": 1j,
    "path": Path("/nonexistent"),
    "folder": Path(),
    "path of NUL": Path("a\0b"),
    "NUL": "a\0b",
    "surrogate": "\ud800",
    "long text": "x" * 5000,
    "empty array": np.zeros(0),
    "matrix": np.ones((2, 3)),
    "texts": np.array(["a", "b"]),
    "objects": np.array([None, {}], dtype=object),
    "array of nan": np.array([np.nan, 1.0]),
    "complex array": np.array([1j, 2.0]),
    "numpy integer": np.int64(3),
    "numpy number": np.float32(2.5),
    "numpy boolean": np.bool_(True),
    "date": np.datetime64("2024-01-01"),
    "huge integer": 10**400,
    "huger integer": 10**5000,
    "function": len,
    "set": {1},
}
# Functions of the caller, whose exceptions are those of the caller.
CALLBACKS = ("progress",)
QUICK = ("None", "object", "-1", "nan", "NUL", "huger integer", "table of numbers", "complex array")


@dataclass(frozen=True)
class Target:
    """A callable and a valid call of it."""

    name: str
    function: Callable[..., Any]
    arguments: Mapping[str, Any]  # of the valid call, by name


class _Captured(BaseException):
    """Ends an example at the call that is looked for."""


class _Names:
    """The package with one name replaced."""

    def __init__(self, replaced: Mapping[str, Any]) -> None:
        vars(self).update(replaced)

    def __getattr__(self, name: str) -> Any:
        return getattr(tb, name)


def public_items() -> dict[str, Any]:
    """Return the promised functions and classes by name."""
    items = {name: getattr(tb, name) for name in tb.__all__ if name not in MODULES}
    for module in MODULES:
        part = getattr(tb, module)
        items |= {f"{module}.{name}": getattr(part, name) for name in part.__all__}
    return items


def bound(item: Any, args: tuple[Any, ...], keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a call by name, also those that the signature collects."""
    arguments = inspect.signature(item).bind(*args, **keywords).arguments
    collected = arguments.pop("options", {}) if "options" in arguments else {}
    for key in ("overrides", "changes", "fit", "data"):
        collected = {**collected, **arguments.pop(key, {})}
    return {**arguments, **collected}


def example_call(name: str, item: Any) -> Mapping[str, Any] | None:
    """Return the arguments of the first call in the example of a docstring."""
    captured: list[Mapping[str, Any]] = []

    def record(*args: Any, **keywords: Any) -> None:
        captured.append(bound(item, args, keywords))
        raise _Captured

    short = name.rpartition(".")[2]
    namespace = dict(vars(importlib.import_module(item.__module__)))
    replaced: dict[str, Any] = {short: record}
    if "." in name:
        module = name.partition(".")[0]
        part = getattr(tb, module)
        names = {key: getattr(part, key) for key in part.__all__}
        replaced = {short: record, module: SimpleNamespace(**{**names, short: record})}
    proxy = _Names(replaced)
    namespace |= {"tb": proxy, short: record, "np": np}
    examples = doctest.DocTestParser().get_examples(inspect.getdoc(item) or "")
    try:
        for example in examples:
            if example.source.startswith("import thermobearing as tb"):
                continue
            if not example.options.get(doctest.SKIP) or f"{short}(" in example.source:
                with contextlib.redirect_stdout(io.StringIO()):
                    exec(compile(example.source, name, "single"), namespace)
                namespace["tb"] = proxy
                if namespace.get(short) is not record:  # the example imports the name
                    namespace[short] = record
    except _Captured:
        return captured[0]
    return None


@contextlib.contextmanager
def lasting_folders(folder: Path) -> Iterator[None]:
    """Keep the folders of examples, which end with the example, until this context ends."""
    import tempfile

    class _Lasting:
        def __init__(self, *_: object, **__: object) -> None:
            self.name = tempfile.mkdtemp(dir=folder)

        def cleanup(self) -> None: ...

        def __enter__(self) -> str:
            return self.name

        def __exit__(self, *_: object) -> None: ...

    here, usual = Path.cwd(), tempfile.TemporaryDirectory
    tempfile.TemporaryDirectory = _Lasting  # type: ignore[assignment,misc]
    os.chdir(folder)
    try:
        yield
    finally:
        tempfile.TemporaryDirectory = usual  # type: ignore[misc]
        os.chdir(here)


def _cyclic() -> Any:
    return tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05))


def _bridge() -> Any:
    return tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=0.5, axial_force=800)


def _record() -> Any:
    test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None, dt=0.02)
    return tb.synthetic_record("shen-hdr-specimen", 23.0, test)


def _study() -> Any:
    factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    return tb.study(
        {"kind": "study", "name": "p1", "case": {"duration": "1 s"}, "factors": factors}
    )


def _pair() -> Any:
    north = tb.GroundMotion("north", 0.01, np.array([0.0, 100.0]))
    return tb.MotionPair(north, tb.GroundMotion("east", 0.01, np.array([0.0, 0.0])))


SHORT = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": 23.0, "duration": 0.2}
# Valid calls where an example takes long, or a class has none.
CALLS: dict[str, Callable[[], Mapping[str, Any]]] = {
    "Ambient": lambda: {"time": np.array([0.0, 9.0]), "temperature": np.array([1.0, 2.0])},
    "Bearing": lambda: dict(tb.load_bearing("shen-hdr-specimen")),
    "BilinearBearing": lambda: dict(tb.load_bilinear("shen-bilinear-bridge")),
    "DesignSpectrum": lambda: dict(vars(tb.load_spectrum("jra-ii-i"))),
    "InitialState": lambda: {"temperature": 0.0, "lead": None, "result": None},
    "Keep": lambda: {"groups": ["rubber"], "every": 2, "histories": "all"},
    "ModelOptions": lambda: dict(tb.ModelOptions()),
    "Result": lambda: {"dataset": _cyclic().dataset},
    "EarthquakeResult": lambda: {"dataset": _bridge().dataset},
    "TestRecord": lambda: {
        name: getattr(_record(), name)
        for name in inspect.signature(tb.TestRecord).parameters
    },
    "Structure": lambda: dict(tb.load_structure("pier-p1")),
    "CyclicTest": lambda: dict(tb.cyclic_test(strain=[0.5])),
    "bridge": lambda: {**SHORT, "structure": "pier-p1", "progress": None, "keep": None},
    "bounds_study": lambda: {**SHORT, "ambient": [23.0], "strain": 1.75},
    "hybrid": lambda: {"bearing": "shen-hdr-specimen", "ambient": -20, "duration": 0.2,
                       "laboratory": {"mode": "pd", "delay": "10 ms"}},
    "run": lambda: {"bearing": "shen-hdr-specimen", "ambient": -20, "dt": 0.05,
                    "test": tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05)},
    "run_design": lambda: {"case": None, "motions": ["jra-ii-i-1"], "templates": ()},
    "make_report": lambda: {"result": _cyclic(), "directory": "out", "html": True, "pdf": False},
    "forecast": lambda: {
        "found": tb.identify_bearing(_record(), "shen-hdr-specimen", free=["K_r"], starts=1),
        "ambients": [0.0], "narrow": False,
    },
    "identify_bearing": lambda: {"records": _record(), "bearing": "shen-hdr-specimen",
                                 "free": ["K_r"], "starts": 1},
    "live_page": lambda: {"path": "b.html", "bearing": "shen-lhdr-specimen", "overwrite": True},
    "sequence": lambda: {"case": {"parts": [{"part": "hybrid", "duration": "0.2 s"}]}},
    "study": lambda: {"source": {
        "kind": "study", "name": "p1", "case": {"duration": "0.2 s"},
        "factors": {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]},
    }},
    "generate_weather": lambda: {"climate": "cold-town", "years": 1, "seed": 3},
    "opensees.Material": lambda: {
        "tag": 1, "start": tb.element("shen-hdr-specimen").save(), "places": [0]},
    "opensees.add_material": lambda: {
        "program": SimpleNamespace(), "tag": 7, "element": tb.element("shen-hdr-bridge")},
    "opensees.write_material": lambda: {
        "file": "pier", "element": tb.element("shen-hdr-bridge"), "units": "kN-m"},
    "laws.Law": lambda: dict(vars(tb.laws.register("softer", temperature=_softer))),
}  # fmt: skip
# Methods: what makes an instance, and the arguments that a method needs.
METHODS: dict[str, tuple[Callable[[], Any], dict[str, dict[str, Any]]]] = {
    "Ambient": (
        lambda: tb.Ambient.constant(5.0),
        {"series": {"time": np.array([0.0, 9.0]), "temperature": np.array([1.0, 2.0])},
         "constant": {"temperature": 5.0}, "from_csv": {"path": "a.csv"},
         "at": {"time": 5.0}, "means": {"start": 0.0, "dt": np.array([1.0])}},
    ),
    "BearingElement": (
        lambda: tb.element("shen-hdr-specimen"),
        {"set_trial": {"x": 1.0, "dt": 0.01, "ambient": None}, "restore": {"saved": None},
         "from_constants": {"constants": None, "ambient": 5.0, "initial": None}},
    ),
    "BearingElements": (
        lambda: tb.BearingElements([tb.element("shen-hdr-specimen")]),
        {"set_trial": {"x": [1.0], "dt": 0.01, "ambient": None}},
    ),
    "DesignSpectrum": (lambda: tb.load_spectrum("jra-ii-i"), {"at": {"periods": [0.5, 1.0]}}),
    "Hourly": (
        lambda: tb.Hourly([-8.0, -10.0, -13.0], begins=np.datetime64("2024-01-31T22")),
        {"before": {"hour": 2, "history": 2.0}, "full_hours": {"history": 1.0},
         "hours_at": {"shares": np.array([0.5]), "history": 1.0}},
    ),
    "InitialState": (tb.InitialState, {"of": {"value": 5.0}}),
    "Keep": (tb.Keep, {"of": {"value": ["rubber"]}}),
    "ModelOptions": (
        tb.ModelOptions,
        {name: {"bearing": tb.load_bearing("shen-hdr-specimen")}
         for name in ("build_stack", "misfits", "settled")},
    ),
    "MotionPair": (_pair, {"rotated": {"angle": 5.0}, "along": {"axis": "x"}}),
    "Result": (
        _cyclic,
        {"sel": {"ambient": 23.0}, "tested_to": {"run": 0, "limit": "temperature"},
         "magnitude": {"name": "force"}, "time": {"run": 0}, "largest_tested":
         {"run": "0", "limit": "temperature"}, "__getitem__": {"name": "force"},
         "save": {"directory": "saved", "overwrite": True, "figures": False},
         "report": {"directory": "out", "pdf": False}},
    ),
    "EarthquakeResult": (
        _bridge,
        {"sel": {"ambient": 23.0}, "history": {"run": 0}, "places": {"run": 0},
         "rises": {"run": 0}, "hottest": {"run": 0}, "moves_along": {"direction": "x"},
         "by_direction": {"name": "table"}, "tested_to": {"runs": [0], "limit": "temperature"},
         "__getitem__": {"name": "bearing_force"},
         "save": {"directory": "saved", "overwrite": True, "figures": False}},
    ),
    "StudyResult": (
        _study,
        {"demand": {"demand": None, "across": "ambient_degC", "by": None, "failed": "computed"},
         "ida": {"demand": None, "failed": "computed"}, "select": {"ambient": 0.0},
         "fragility": {"capacity": 1.0, "demand": None, "name": ""},
         "fragilities": {"capacity": 1.0, "demand": None, "by": "ambient_degC"},
         "over_climate": {"curves": {}, "temperatures": [0.0]},
         "rates": {"curves": {}, "hazard": None},
         "rates_table": {"curves": {}, "rates": {}, "to": None},
         "variance": {"demand": None}, "worst": {"count": 3, "by": None},
         "save": {"directory": "saved", "overwrite": True, "figures": False}},
    ),
    "TestRecord": (_record, {"of_bearing": {"bearing": tb.load_bearing("shen-hdr-specimen")}}),
    "laws.Law": (
        lambda: tb.laws.register("softer", temperature=_softer),
        {"values": {"given": {}}, "shown": {"values": (0.01,)}},
    ),
}  # fmt: skip


def _softer(temperature: float, rate: float = 0.01) -> tuple[float, float]:
    return 1.0, 2.0 ** (-rate * (temperature - 23.0))


# Records that only the package makes, exceptions, and what needs a model and a server of OpenSees
# (tests/cross_code/test_opensees_replaced.py has its misuses).
MADE = {"Design", "Identification", "SequenceResult", "StudyResult", "Validation", "InputError",
        "OutputError", "opensees.Line", "opensees.ServingError",
        "opensees.replace_elements"}  # fmt: skip


def targets(names: set[str] | None = None) -> Iterator[Target]:
    """Yield the public callables with their valid calls, and the methods of public classes."""
    for name, item in public_items().items():
        if names and name not in names:
            continue
        if name not in MADE:
            arguments = CALLS[name]() if name in CALLS else example_call(name, item)
            assert arguments is not None, f"{name}: no call in its example"
            yield Target(name, item, arguments)
        if name in METHODS:
            make, methods = METHODS[name]
            instance = make()
            for method, values in methods.items():
                yield Target(f"{name}.{method}", getattr(instance, method), values)


def misuses(target: Target, values: Mapping[str, Any] = VALUES) -> Iterator[tuple[str, str, Any]]:
    """Yield the name of an argument, that of a wrong value, and a call."""
    names = dict.fromkeys([*target.arguments, *_optional(target.function)])
    for argument in names:
        if argument in CALLBACKS:
            values = {label: value for label, value in values.items() if not callable(value)}
        for label, value in values.items():
            arguments = {**target.arguments, argument: value}
            yield argument, label, lambda arguments=arguments: target.function(**arguments)


def _optional(function: Callable[..., Any]) -> list[str]:
    parameters = inspect.signature(function).parameters.values()
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return [item.name for item in parameters if item.kind in named]


@dataclass
class Counts:
    """How the calls of one callable ended."""

    calls: int = 0
    ends: Counter[str] = field(default_factory=Counter)
    faults: dict[str, list[str]] = field(default_factory=dict)


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    def stop(_: int, frame: FrameType | None) -> None:
        raise TookTooLong(f"more than {SECONDS:g} s of processor time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def count_faults(target: Target, values: Mapping[str, Any] = VALUES) -> Counts:
    """Make all wrong calls of a target; return how they ended."""
    counts = Counts()
    for argument, label, call in misuses(target, values):
        counts.calls += 1
        try:
            with _limited(), contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                _check_numbers(call())
            counts.ends["completed"] += 1
        except ThermobearingError as error:
            counts.ends["typed error"] += 1
            if not str(error).strip() or "Traceback" in str(error):
                counts.faults.setdefault("no message", []).append(f"{argument} = {label}")
        except (Exception, TookTooLong) as error:
            counts.ends["foreign"] += 1
            signature = f"{type(error).__name__} in {_place(error)}"
            text = f"{argument} = {label}: {str(error)[:150]!r}"
            counts.faults.setdefault(signature, []).append(text)
    return counts


def _place(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    package = f"{os.sep}thermobearing{os.sep}"
    ours = [frame for frame in frames if package in frame.filename] or frames
    return f"{Path(ours[-1].filename).name}:{ours[-1].lineno} {ours[-1].name}"


def _check_numbers(value: Any) -> None:
    """Refuse NaN in a number, an array or a sequence that is returned."""
    if isinstance(value, tuple | list):
        for item in value:
            _check_numbers(item)
    elif isinstance(value, float | np.ndarray) and np.asarray(value).dtype.kind == "f":
        if np.isnan(value).any():
            raise AssertionError("NaN is returned")
    elif isinstance(value, tb.GroundMotion):
        _check_numbers([value.acceleration, value.dt])


def main(names: list[str]) -> None:
    """Print the counts of each name, and one example of each fault."""
    total = Counts()
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder, lasting_folders(Path(folder)):
        for target in targets({*names}):
            counts = count_faults(target)
            total.calls += counts.calls
            total.ends += counts.ends
            print(f"{target.name}: {counts.ends['foreign']} of {counts.calls} foreign", flush=True)
            for signature, texts in counts.faults.items():
                print(f"    {len(texts)} {signature}: {texts[0]}")
    print(f"all: {total.calls} calls, {dict(total.ends)}")


if __name__ == "__main__":
    main(sys.argv[1:])
