"""Laws, exports, pairs, posteriors, templates, limits, and what may be wrong in them. No tests."""

import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

import thermobearing as tb
import thermobearing.laws
from tests.fuzz import grammar
from tests.fuzz.judge import COMPLETED, Example
from tests.fuzz.misuse import VALUES
from tests.fuzz.mutations import damaged, plain_numbers, rows_of_numbers, toml_files
from thermobearing.border.library import data_path
from thermobearing.identify.quofem import PROBLEM, write_quofem, write_responses
from thermobearing.model.limits import load_limits
from thermobearing.opensees.specimen import read_address

LAW = """import math

import thermobearing as tb


def softer(temperature, rate=0.01, scale=1.0):
    return 1.0, scale * math.exp(-rate * (temperature - 23.0))


tb.laws.register("fuzzed", temperature=softer, bounds={"rate": (0.001, 0.1)}, range=(-50, 60))
"""
PIECES_OF_LAW = [
    ("0.01", "1e300"), ("0.01", "-5"), ("scale=1.0", "scale"), ("math.exp", "math.log"),
    ("23.0", "nan"), ("return 1.0,", "return"), ("-50, 60", "60, -50"), ("-50, 60", "None"),
    ("0.001, 0.1", "0.1, 0.001"), ("temperature=softer", "hysteresis=softer"), ("rate=0.01", "*r"),
    ("import math", "import maths"), ("fuzzed", "linear"), ("fuzzed", ""), ("temperature -", "t -"),
    ("return 1.0", "return None"), ("1.0, scale", "\"1\", scale"), ("rate *", "rate /"),
    ("23.0", "10**400"), ("scale *", "1j *"), ("return", "yield"),
]  # fmt: skip
POSTERIOR = "K_r,m_T\n30,-1.1\n31,-1.2\n29.5,-1.0\n"


@st.composite
def laws(draw: st.DrawFn) -> Example:
    text = LAW
    for old, new in draw(st.lists(st.sampled_from(PIECES_OF_LAW), max_size=3)):
        text = text.replace(old, new, 1)
    raw = draw(damaged(text.encode()))

    def read(folder: Path) -> str:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(thermobearing.laws, "_REGISTERED", {})
            for name in tb.laws.load(folder / "law.py"):
                tb.changed_bearing("shen-hdr-specimen", law=name)
        return COMPLETED

    return Example({"law.py": raw}, read, f"laws.load: {raw!r}")


@st.composite
def exports(draw: st.DrawFn) -> Example:
    """Structures as scripts of OpenSees, with bearings, motions and temperatures of any kind."""
    raw = draw(grammar.valid("structure").flatmap(toml_files))
    bearing = draw(st.sampled_from([None, "shen-hdr-bridge", "shen-bilinear-bridge", "lrb-example",
                                    ["shen-hdr-bridge"], "no-such", []]))  # fmt: skip
    motion = draw(st.sampled_from([None, "jra-ii-i-1", "no-such"]))
    ambient = draw(st.one_of(st.none(), st.just(-20.0), plain_numbers()))
    target = draw(st.sampled_from(["a.tcl", "a.py", "a", "", ".", "none/a.tcl", "a\0.tcl"]))

    def write(folder: Path) -> str:
        tb.opensees.write_structure(
            folder / "a.toml",
            target and folder / target,
            bearing=bearing,
            motion=motion,
            ambient=ambient,
        )
        return COMPLETED

    about = (
        f"write_structure {bearing} {motion} {ambient} {target!r}: {raw.decode('utf-8', 'replace')}"
    )
    return Example({"a.toml": raw}, write, about)


def plane_tables() -> st.SearchStrategy[dict[str, Any]]:
    """Tables of cyclic tests with a path in the plane."""
    path = {
        "step": st.just("path"),
        "path": st.sampled_from(["circle", "ellipse", "eight", "square", "spiral", "cruciform"]),
        "strain": st.sampled_from([0.1, 0.5, 1.5]),
        "count": st.integers(1, 2),
        "speed": st.sampled_from(["30 mm/s", "300 mm/s"]),
    }
    optional = {
        "ratio": st.floats(0.1, 1.0),
    }
    steps = st.fixed_dictionaries(path, optional=optional)
    test = st.fixed_dictionaries(
        {"dt": st.just("20 ms"), "steps": st.lists(steps, min_size=1, max_size=2)}
    )
    return st.fixed_dictionaries(
        {"bearing": st.sampled_from(["shen-hdr-specimen", "lrb-example"]), "test": test},
        optional={"ambient": st.just(["-20 degC"])},
    )


@st.composite
def pairs(draw: st.DrawFn) -> Example:
    """Pairs of motions of wrong steps, lengths, angles and types."""
    numbers = st.one_of(plain_numbers(), st.sampled_from(list(VALUES.values())))
    count = draw(st.sampled_from([2, 3, 50]))
    dt = draw(st.one_of(st.sampled_from([0.01, 0.02]), numbers))
    angle, axis = draw(numbers), draw(st.sampled_from(["x", "y", "z", None]))
    values = draw(st.lists(plain_numbers(), min_size=1, max_size=4))

    def make(_: Path) -> str:
        first = tb.GroundMotion("a", 0.01, np.ones(count))
        second = tb.GroundMotion("b", dt, np.resize(values, count))
        pair = tb.MotionPair(first, second, angle)
        assert np.isfinite(pair.rotated()).all()
        assert np.isfinite(pair.along(axis).acceleration).all()  # type: ignore[arg-type]
        return COMPLETED

    return Example({}, make, f"MotionPair of {count}: {dt!r} {angle!r} {axis!r} {values!r:.200}")


@st.composite
def posteriors(draw: st.DrawFn) -> Example:
    raw = draw(rows_of_numbers(POSTERIOR))
    count = draw(st.sampled_from([1, 3, 20, 0, -1, 10**9]))

    def read(folder: Path) -> str:
        made = tb.posterior_bearings("shen-hdr-specimen", folder / "p.csv", count)
        assert all(np.isfinite(item.hysteresis.layer_stiffness) for item in made)
        return COMPLETED

    return Example({"p.csv": raw}, read, f"posterior_bearings {count}: {raw!r}")


@cache
def calibration() -> str:
    """The problem of a folder of quoFEM, with a short test."""
    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None, dt=0.05)
    record = tb.synthetic_record("shen-hdr-specimen", 23.0, test, sampling=10.0)
    result = tb.identify_bearing(record, "shen-hdr-specimen", free=["K_r"], starts=1)
    with TemporaryDirectory() as folder:
        return Path(write_quofem(result, f"{folder}/q"), PROBLEM).read_text(encoding="utf-8")


def _places(table: Any) -> list[tuple[Any, Any]]:
    items = list(table.items()) if isinstance(table, dict) else list(enumerate(table))
    inner = [place for _, item in items if isinstance(item, dict | list) for place in _places(item)]
    return [(table, key) for key, _ in items[:12]] + inner


WRONG = [None, "x", 5, -1, [], {}, True, 1e300, float("nan"), [None], ["x"], {"x": 1}, "\0"]


@st.composite
def folders_of_quofem(draw: st.DrawFn) -> Example:
    table = json.loads(calibration())
    for _ in range(draw(st.integers(0, 2))):
        places = _places(table)
        holder, key = places[draw(st.integers(0, len(places) - 1))]
        if draw(st.integers(0, 3)):
            holder[key] = draw(st.sampled_from(WRONG))
        else:
            del holder[key]
    raw = draw(damaged(json.dumps(table).encode()))
    value = draw(st.sampled_from([30.0, "x", None, float("nan"), 1e300, 0.0, [1]]))
    name = draw(st.sampled_from(["K_r", "ln_K_r", "x"]))

    def write(folder: Path) -> str:
        write_responses({"K_r": 3.4, "ln_K_r": 3.4, name: value}, folder)
        text = (folder / "results.out").read_text()
        assert np.isfinite([float(word) for word in text.split()]).all()
        return COMPLETED

    return Example({PROBLEM: raw}, write, f"write_responses {name} = {value!r}: {raw[:300]!r}")


@st.composite
def addresses(draw: st.DrawFn) -> Example:
    host = draw(st.sampled_from(["127.0.0.1", "[::1]", "a.b", "", "x" * 300, "免震", "a..b", "-"]))
    port = draw(st.sampled_from(["8090", "0", "65536", "-1", "", "9" * 5000, "²", "1e3", "８０"]))
    text = draw(st.sampled_from([f"tcp://{host}:{port}", f"{host}:{port}", f"tcp:{host}", host]))
    text += draw(st.one_of(st.just(""), st.text(max_size=3)))

    def read(_: Path) -> str:
        try:
            host, port = read_address(text)
        except UnicodeError:
            raise
        except ValueError as error:  # in the model of a laboratory, whose message it becomes
            raise tb.InputError(str(error)) from None
        assert host
        assert 1 <= port <= 65535
        return COMPLETED

    return Example({}, read, f"read_address({text!r})")


@cache
def _result() -> Any:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05)
    return tb.run("shen-hdr-specimen", test, ambient=-20)


@st.composite
def templates(draw: st.DrawFn) -> Example:
    lines = data_path("reports", "cyclic.md").read_text(encoding="utf-8").splitlines()
    pieces = ["{{ tables }}", "{{ figures }}", "{{ table zzz }}", "{{", "}}", "{{}}", "{{ x y z }}",
              "# ", "#" * 200, "{{ figure \0 }}", "| a |", "{{ note }}", "免", "\x1b[2J",
              "{{ table cycles }}" * 50, " " * 5000]  # fmt: skip
    for _ in range(draw(st.integers(0, 3))):
        place = draw(st.integers(0, len(lines)))
        piece = draw(st.one_of(st.sampled_from(pieces), st.text(max_size=20)))
        lines[place : place + draw(st.integers(0, 1))] = [piece]
    raw = draw(damaged("\n".join(lines).encode("utf-8", "replace")))

    def write(folder: Path) -> str:
        options = {"template": folder / "t.md", "pdf": False, "live": False}
        (folder / "out").mkdir()
        tb.make_report(_result(), folder / "out", **options)
        return COMPLETED

    return Example({"t.md": raw}, write, f"template: {raw[-300:]!r}")


def limits() -> st.SearchStrategy[Example]:
    """Files of limits that an office enters."""
    value = st.one_of(
        st.just("250 %"),
        st.floats(0.1, 10.0),
        plain_numbers(),
        st.sampled_from(["5 mm", "x", True]),
    )
    entry = st.fixed_dictionaries(
        {"value": value, **dict.fromkeys(("edition", "clause", "entered_by"), st.just("2017"))},
        optional={"zzz": st.just(1)},
    )  # fmt: skip
    keys = {"jra": "level_2_shear_strain", "aashto": "total_shear_strain", "pier": "ductility",
            "bearing": "local_strain", "zzz": "zzz"}  # fmt: skip
    codes = [st.fixed_dictionaries({code: st.fixed_dictionaries({key: entry})})
             for code, key in keys.items()]  # fmt: skip
    tables = st.one_of(codes)
    return tables.flatmap(toml_files).map(_limits_file)


def _limits_file(raw: bytes) -> Example:
    def read(folder: Path) -> str:
        load_limits(folder / "limits.toml")
        return COMPLETED

    return Example({"limits.toml": raw}, read, f"load_limits: {raw!r}")
