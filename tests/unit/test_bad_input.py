"""Bad input: one message that names file, key, value, unit, what is allowed, nearest name.

Each row of a table is one broken thing and pieces of text that its message must hold. Every
broken file also goes through the command `check`, which must end with status 2, one message
and no traceback. Broken CSV files are in test_tables.py.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.inputs import (
    CYCLES,
    REMOVED,
    Row,
    assert_mentions,
    assert_refused,
    by_name,
    changed_table,
    quick_case,
    refusal,
    specimen_table,
    write_toml,
)
from thermobearing.border.opener import read_bytes
from thermobearing.cyclic.protocol import MAX_STEPS

G, H, M = "geometry.", "hysteresis.", "materials."
MM = '"1.5 mm"'

LEAD = {
    "cores": 4,
    "diameter": "34.5 mm",
    "stiffness": "22 kN/mm",
    "yield_stress": "12 MPa",
    "reference_temperature": "23 degC",
    "confined": True,
}
LEAD_METAL = {
    "conductivity": "35.3 W/(m K)",
    "specific_heat": "130 J/(kg K)",
    "density": "11336 kg/m^3",
}

BEARINGS: list[Row] = [
    ("no unit", {G + "shim_thickness": 3.2}, ["geometry.shim_thickness = 3.2", '"3.2 mm"']),
    ("no unit, sourced", {G + "plan.side": {"value": 240, "source": "?"}}, ['"240 mm"']),
    ("unit of another kind", {G + "rubber_thickness": "5 kg"}, ['"kg"', "to mm"]),
    ("decimal comma", {G + "rubber_thickness": "5,0 mm"}, ["'5,0 mm'", "use a decimal point"]),
    ("true for a number", {H + "hardening": True}, ["= True", "a number at least 0"]),
    ("negative thickness", {G + "rubber_thickness": "-5 mm"}, ["'-5 mm'", "at least 0.05"]),
    ("part of a layer", {G + "rubber_layers": 5.5}, ["= 5.5", "an integer at least 1"]),
    ("NaN", {H + "elastic_temperature_coefficient": float("nan")}, ["nan", "at most 5"]),
    ("cold in kelvin", {H + "reference_temperature": "-20 K"}, ["'-20 K'", "at least -100"]),
    ("misspelt key", {G + "ruber_layers": 6}, ['"geometry.ruber_layers"', '"rubber_layers"?']),
    (
        "strange key",
        {"cells.zzz": 1},
        ['"cells.zzz"', "known: end_plate, plate_grading, rubber, sealing_plate, shim"],
    ),
    (
        "missing key",
        {H + "yield_displacement": REMOVED},
        ['missing key "hysteresis.yield', '"... mm"'],
    ),
    ("unknown kind", {"kind": "friction pendulum"}, ["kind = 'friction pendulum'", "'HDR'"]),
    ("misspelt shape", {G + "plan.shape": "sqare"}, ["geometry.plan.shape = 'sqare'", '"square"?']),
    (
        "keys of another shape",
        {G + "plan.shape": "circular"},
        ['missing key "geometry.plan.diameter"', 'unknown key "geometry.plan.side"', "2 problems"],
    ),
    ("text for a table", {"geometry": "flat"}, ["geometry = 'flat'", "must be a table"]),
    ("source without value", {G + "rubber_layers": {"source": "?"}}, ['needs a "value"', "source"]),
    (
        "misspelt source",
        {G + "rubber_layers": {"value": 6, "sorce": "?"}},
        ['unknown key "sorce"', 'did you mean "source"'],
    ),
    ("empty name", {"name": ""}, ["name = ''", "must not be empty"]),
    ("HDR with lead", {"lead": LEAD}, ['kind "HDR" has no lead']),
    ("lead missing", {"kind": "LHDR"}, ["LHDR bearing needs the tables lead and materials.lead"]),
    (
        "faults in lead",
        {"lead": LEAD | {"confined": "yes", "clock": "stel", "cores": 0, "softening": "2 1/K"}},
        [
            "4 problems",
            "lead.confined = 'yes': must be true or false",
            'did you mean "steel"',
            "lead.cores = 0",
            "at most 0.1 1/K",
        ],
    ),
    (
        "more lead than plan",
        {"kind": "LHDR", "lead": LEAD | {"cores": 400}, "materials.lead": LEAD_METAL},
        ["the lead cores have an area", "the plan only 57600 mm2"],
    ),
    (
        "many faults at once",
        {
            G + "ruber_layers": 6,
            G + "rubber_layers": REMOVED,
            G + "shim_thickness": "-3 mm",
            M + "rubber.density": "3 K",
            H + "shape": REMOVED,
            H + "hardening": -1,
            "kind": "HRD",
            "cells.rubber": 0,
        },
        [
            "8 problems",
            'unknown key "geometry.ruber_layers"',
            'missing key "geometry.rubber_layers"',
            "geometry.shim_thickness = '-3 mm'",
            "materials.rubber.density = '3 K'",
            'missing key "hysteresis.shape"',
            "hysteresis.hardening = -1",
            "kind = 'HRD'",
            "cells.rubber = 0",
        ],
    ),
]


@pytest.mark.parametrize(("changes", "pieces"), by_name(BEARINGS))
def test_broken_bearing(tmp_path: Path, changes: dict[str, Any], pieces: list[str]) -> None:
    path = write_toml(tmp_path / "broken.toml", changed_table(specimen_table(), changes))
    message = refusal(path, tb.load_bearing)
    assert message.startswith(f"{path}: ")
    assert_mentions(message, pieces)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("missing.py", ""),
        ("laws.py", ""),
        ("nosuch.toml", ""),
        ("pier-2.toml", '; did you mean "pier-1.toml"?'),
        ("pier-1.csv", '; did you mean "pier-1.txt"?'),
        ("pier-1.md", '; did you mean "pier-1.txt"?'),
        ("pier1.txt", '; did you mean "pier-1.txt"?'),
    ],
)
def test_a_common_suffix_does_not_make_names_similar(tmp_path: Path, name: str, hint: str) -> None:
    for file in ("sig.py", "raise.py", "bin.toml", "pier-1.toml", "pier-1.txt"):
        (tmp_path / file).touch()
    with pytest.raises(tb.InputError) as caught:
        read_bytes(tmp_path / name, 10)
    assert str(caught.value).endswith(f"no such file{hint}")


FILES: list[tuple[str, bytes, list[str]]] = [
    (
        "only a name",
        b'name = "x"\nkind = "HDR"',
        ['missing key "geometry"', 'missing key "materials"'],
    ),
    ("not TOML", b"kind = = 3", ["not valid TOML", "line 1, column 8"]),
    ("binary", bytes(range(256)), ["not UTF-8 text"]),
]


@pytest.mark.parametrize(("content", "pieces"), by_name(FILES))
def test_broken_file(tmp_path: Path, content: bytes, pieces: list[str]) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    message = refusal(path, tb.load_bearing)
    assert message.startswith(f"{path}: ")
    assert_mentions(message, pieces)


def test_empty_bearing_file_lists_all_that_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "empty.toml"
    path.touch()
    with pytest.raises(tb.InputError) as caught:
        tb.load_bearing(path)
    missing = ["name", "kind", "geometry", "materials", "hysteresis"]
    assert caught.value.problems == [f'missing key "{key}"' for key in missing]


@pytest.mark.parametrize(
    ("name", "pieces"),
    [
        ("shen-hdr-speciman", ['"shen-hdr-speciman"', 'did you mean "shen-hdr-specimen"?']),
        ("zzz", ['"zzz"', "known: lrb-example, shen-hdr-bridge, shen-hdr-specimen"]),
        ("", ['""', "known: "]),
        ("a\0b.toml", ["cannot be read"]),
        ("x" * 5000 + ".toml", ["cannot be read"]),
    ],
    ids=["nearest", "none near", "empty", "null byte", "too long"],
)
def test_unknown_bearing_name(name: str, pieces: list[str]) -> None:
    assert_refused(lambda: tb.load_bearing(name), *pieces)


def cycles(**changes: Any) -> dict[str, Any]:
    step = {key: value for key, value in (CYCLES | changes).items() if value is not REMOVED}
    return {"test": {"dt": "10 ms", "steps": [step]}}


def steps(*given: dict[str, Any]) -> dict[str, Any]:
    return {"test": {"dt": "10 ms", "steps": list(given)}}


def dt(value: Any) -> dict[str, Any]:
    return {"test": {"dt": value, "steps": [CYCLES]}}


def face(**values: Any) -> dict[str, Any]:
    return {"analysis": {"upper_face": values}}


STEP = "test.steps[0]"
RAMP = {"step": "ramp", "to": "5 mm", "speed": "1 mm/s"}

CASES: list[Row] = [
    ("unknown step", steps({"step": "cycls"}), [f"{STEP}.step = 'cycls'", '"cycles"?', "'ramp'"]),
    ("no step", steps({"strain": 1.0}), [f'missing key "{STEP}.step"']),
    ("no steps", {"test": {"steps": []}}, ["test.steps = []", "at least 1"]),
    ("two amplitudes", cycles(amplitude="3 mm"), [STEP, "exactly one", "got strain and amplitude"]),
    ("no amplitude", cycles(strain=REMOVED), [STEP, "exactly one of strain, amplitude; got none"]),
    (
        "conflict and a wrong unit",
        cycles(period="4 mm"),
        ["got speed and period", f"{STEP}.period = '4 mm'", "2 problems"],
    ),
    ("angles for cycles", cycles(speed=REMOVED, frequency="3 rad/s"), ["'3 rad/s'", "Hz"]),
    ("amplitude in metres", cycles(strain=REMOVED, amplitude="3 m"), [STEP, "3000 mm", "500%"]),
    ("misspelt key of a step", cycles(starin=1), [f'"{STEP}.starin"', '"strain"?']),
    ("creeping", cycles(speed="1e-6 mm/s"), ["test.dt = 0.01 s", f"the limit is {MAX_STEPS}"]),
    ("rest without end", steps({"step": "rest"}), [STEP, "one of duration, within; got none"]),
    ("rest with a temperature", steps({"step": "rest", "within": "5 degC"}), ["difference", " K"]),
    ("ramp too far", steps(RAMP | {"to": "1 m"}), [STEP, "1000 mm", "500%"]),
    ("cycles off zero", steps(RAMP, CYCLES), ["test.steps[1]", "at 5 mm", "insert a ramp to 0 mm"]),
    ("dt without unit", dt(0.005), ["test.dt = 0.005", '"0.005 s"']),
    ("misspelt group", {"analysis": {"keep": ["rubbr"]}}, ["analysis.keep[0]", '"rubber"?']),
    ("eta 0.5", face(eta=0.5), ["analysis.upper_face.eta = 0.5", "at least 1 and at most 3"]),
    ("eta and film", face(eta=2.0, film="5 W/(m^2 K)"), ["analysis.upper_face", "either eta"]),
    (
        "half stack, unlike faces",
        {"analysis": {"stack": "half", "upper_face": {"eta": 3.0}}},
        ["alike"],
    ),
    ("air without unit", {"ambient": [-20]}, ["ambient[0] = -20", '"-20 degC"']),
    ("air twice", {"ambient": ["5 degC", "5 degC"]}, ["ambient", "5 degC", "more than once"]),
    ("air and series", {"ambient_series": "night.csv"}, ["ambient or ambient_series, not both"]),
    ("unknown bearing", {"bearing": "shen-hdr-specimn"}, ['"shen-hdr-specimen"?']),
    ("profile too short", {"initial_profile": ["1 degC"] * 2}, ["has 2 temperatures", "19 cells"]),
    ("model of lead without", {"analysis": {"model": "lead-alone"}}, ["lead-alone", "with lead"]),
    (
        "finite plates without lead",
        {"analysis": {"lead_ends": "finite-plate"}},
        ["analysis.lead_ends", "a bearing with lead"],
    ),
    (
        "finite plates as published",
        {"analysis": {"lead_ends": "finite-plate", "scheme": "published"}},
        ['scheme "published"', 'needs lead_ends "half-space"'],
    ),
    ("two starts", {"initial": "1 degC", "initial_profile": ["1 degC"] * 19}, ["only one of"]),
    ("missing earlier result", {"initial_result": "none"}, ["initial_result", "no result.nc"]),
    (
        "faults everywhere",
        {
            "bearing": "shen-hdr-specimn",
            "ambient": "500 degC",
            "analysis": {"scheme": "x"},
            **cycles(count=0, wave="sin"),
        },
        ["5 problems", '"shen-hdr-specimen"?', "500 degC", "'x'", "count = 0", "'sin'"],
    ),
]


@pytest.mark.parametrize(("changes", "pieces"), by_name(CASES))
def test_broken_case(tmp_path: Path, changes: dict[str, Any], pieces: list[str]) -> None:
    path = quick_case(tmp_path / "case.toml", **changes)
    message = refusal(path, tb.load_case)
    assert message.startswith(f"{path}: ")
    assert_mentions(message, pieces)


def test_faults_of_a_bearing_within_a_case_are_reported_with_the_others(tmp_path: Path) -> None:
    table = changed_table(specimen_table(), {G + "rubber_layers": 0, "kind": "HRD"})
    path = quick_case(tmp_path / "case.toml", bearing=table, ambient="500 degC")
    message = refusal(path, tb.load_case)
    reported = ["3 problems", "bearing.geometry.rubber_layers = 0", "bearing.kind", "ambient[0]"]
    assert_mentions(message, reported)


TEST = tb.cyclic_test(strain=[0.5], cycles=1)


@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"ambient": 500}, ["ambient[0] = '500.0 degC'", "at most 100 degC"]),
        ({"ambient": [1, float("inf")]}, ["ambient[1]", "not a finite number"]),
        ({"ambient": "cold"}, ["ambient[0] = 'cold'", '"1.5 degC"']),
        ({"dt": "soon"}, ["test.dt = 'soon'", '"1.5 s"']),
        ({"keep": tb.Keep(every=0)}, ["analysis.keep_every = 0", "at least 1"]),
        ({"keep": tb.Keep(every=1.5)}, ["analysis.keep_every = 1.5", "integer"]),
        ({"initial": np.full(19, np.nan)}, ["19 problems", "initial_profile[18]"]),
        ({"test": "Table 3.4"}, ["test = 'Table 3.4'", "two arrays"]),
        ({"bearing": 3}, ["bearing = 3", "must be a table"]),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_argument_of_run(options: dict[str, Any], pieces: list[str]) -> None:
    given = {"bearing": "shen-hdr-specimen", "test": TEST, "ambient": 0} | options
    with pytest.raises(tb.InputError) as caught:
        tb.run(**given)
    assert_mentions(str(caught.value), ["run(): ", *pieces])


@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"strain": [-1]}, ["steps[0].strain = -1", "at least 1e-06 and at most 5"]),
        ({"strain": None}, ["strain"]),
        ({"strain": []}, ["strain", "at least one"]),
        ({"cycles": 1.5}, ["cycles = 1.5", "integer"]),
        ({"strain": [1], "rest": -5}, ["rest = -5", "at least 1e-06 and at most 1e+08 s"]),
        ({"speed": 0}, ["speed = 0", "at least 1e-06 and at most 1e+06 mm/s"]),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_argument_of_cyclic_test(options: dict[str, Any], pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.cyclic_test(**options)
    assert_mentions(str(caught.value), ["cyclic_test(): ", *pieces])


@pytest.mark.parametrize(
    ("make", "pieces"),
    [
        (lambda: tb.EndFace(eta=2.0, film=3.0), ["EndFace()", "either eta", "or film"]),
        (lambda: tb.Ambient.constant(500), ["ambient", "500 degC", "-100 to 100 degC"]),
        (lambda: tb.Ambient.constant("cold"), ["ambient", "'cold'"]),
        (lambda: tb.Ambient.series([0, 1], [0]), ["equally long"]),
        (lambda: tb.Ambient.series([0, 0], [0, 1]), ["does not increase"]),
        (lambda: tb.Ambient.series([0, 1], [0, np.nan]), ["nan degC"]),
        (lambda: tb.Ambient.series("night", "day"), ["numbers"]),
        (lambda: tb.load_result("no-such-result"), ["no-such-result", "no result.nc"]),
        (lambda: tb.load_result(__file__), [__file__, "not a result file"]),
    ],
    ids=range(9),
)
def test_bad_argument_elsewhere(make: Any, pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        make()
    assert_mentions(str(caught.value), pieces)


def test_a_wrong_name_is_reported_once_and_the_rest_is_checked() -> None:
    """Nothing takes the place of what cannot be loaded: only its own fault is reported."""
    names = ["shen-hdr-brige", "shen-lhdr-bridge"]
    with pytest.raises(tb.InputError) as caught:
        tb.bridge(names, "jra-ii-i-1", 500, structure="pier-p9", mass="heavy")
    starts = [text.split(" ")[0].rstrip(":") for text in caught.value.problems]
    assert starts == ["structure", "bearings[0]", "ambient[0]", "analysis.mass"]
