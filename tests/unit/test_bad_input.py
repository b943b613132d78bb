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
    assert_told,
    by_name,
    changed_table,
    quick_case,
    refusal,
    specimen_table,
    write_toml,
)
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
    ("half a unit", {H + "layer_stiffness": "5 kN/"}, ['unknown unit "kN/"', "kN/mm"]),
    ("decimal comma", {G + "rubber_thickness": "5,0 mm"}, ["'5,0 mm'", "use a decimal point"]),
    ("empty text", {G + "rubber_thickness": ""}, ["geometry.rubber_thickness = ''", MM]),
    ("true for a length", {G + "rubber_thickness": True}, ["= True", MM]),
    ("true for a number", {H + "hardening": True}, ["= True", "a number at least 0"]),
    ("text for a number", {H + "hardening": "0.272"}, ["hysteresis.hardening = '0.272'"]),
    ("unit on a pure number", {H + "shape": "-0.8 mm"}, ["= '-0.8 mm'", "at least -0.999"]),
    ("negative thickness", {G + "rubber_thickness": "-5 mm"}, ["'-5 mm'", "at least 0.05"]),
    ("part of a layer", {G + "rubber_layers": 5.5}, ["= 5.5", "an integer at least 1"]),
    ("a thousand cells", {"cells.rubber": 1001}, ["cells.rubber = 1001", "at most 1000"]),
    ("s = -1", {H + "shape": -1.0}, ["hysteresis.shape = -1.0", "at least -0.999"]),
    ("ratio 0", {H + "post_yield_ratio": 0.0}, ["= 0.0", "at least 0.001 and at most 1"]),
    ("NaN", {H + "elastic_temperature_coefficient": float("nan")}, ["nan", "at most 5"]),
    (
        "infinite",
        {H + "hysteretic_temperature_coefficient": float("-inf")},
        ["= -inf", "at most 5"],
    ),
    ("NaN for a length", {G + "plan.side": float("nan")}, ["plan.side = nan", "at most 100000 mm"]),
    ("absurdly small", {H + "yield_displacement": "1e-300 mm"}, ["at least 0.0001"]),
    ("absurdly large", {H + "elastic_temperature_coefficient": 1e300}, ["at most 5"]),
    ("negative film", {M + "side_film": "-1 W/(m^2 K)"}, ["materials.side_film", "W/(m^2 K)"]),
    ("hot reference", {H + "reference_temperature": "500 degC"}, ["at most 100 degC"]),
    ("cold in kelvin", {H + "reference_temperature": "-20 K"}, ["'-20 K'", "at least -100"]),
    ("misspelt key", {G + "ruber_layers": 6}, ['"geometry.ruber_layers"', '"rubber_layers"?']),
    ("misspelt table", {"hysterisis": {"shape": 1}}, ['"hysterisis"', 'did you mean "hysteresis"']),
    (
        "strange key",
        {"cells.zzz": 1},
        ['"cells.zzz"', "known: end_plate, rubber, sealing_plate, shim"],
    ),
    (
        "missing key",
        {H + "yield_displacement": REMOVED},
        ['missing key "hysteresis.yield', '"... mm"'],
    ),
    ("missing table", {"materials": REMOVED}, ['missing key "materials"']),
    ("misspelt kind", {"kind": "HRD"}, ["kind = 'HRD'", 'did you mean "HDR"']),
    ("unknown kind", {"kind": "friction pendulum"}, ["kind = 'friction pendulum'", "'HDR'"]),
    ("misspelt shape", {G + "plan.shape": "sqare"}, ["geometry.plan.shape = 'sqare'", '"square"?']),
    (
        "unknown shape",
        {G + "plan.shape": "star"},
        ["'star'", "'square', 'rectangular', 'circular'"],
    ),
    ("no shape", {G + "plan.shape": REMOVED}, ['missing key "geometry.plan.shape"']),
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
    (
        "negative scragging",
        {"scragging": {"amplitude": -1.0}},
        ["scragging.amplitude = -1.0", "at least 0"],
    ),
    (
        "scragging at no strain",
        {"scragging": {"strain": 0.0}},
        ["scragging.strain", "at least 0.0001"],
    ),
    ("scragging is a number", {"scragging": 1.0}, ["scragging", "must be a table"]),
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
    ("one for true", {"lead": LEAD | {"confined": 1}}, ["lead.confined = 1", "true or false"]),
    (
        "more lead than plan",
        {"kind": "LHDR", "lead": LEAD | {"cores": 400}, "materials.lead": LEAD_METAL},
        ["the lead cores take", "of a plan of 57600 mm2"],
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
    assert_told(message, pieces)


FILES: list[tuple[str, bytes, list[str]]] = [
    (
        "only a name",
        b'name = "x"\nkind = "HDR"',
        ['missing key "geometry"', 'missing key "materials"'],
    ),
    ("not TOML", b"kind = = 3", ["not valid TOML", "line 1, column 8"]),
    ("binary", bytes(range(256)), ["not UTF-8 text"]),
    ("another encoding", 'name = "免震"'.encode("cp932"), ["not UTF-8 text", "byte 9"]),
]


@pytest.mark.parametrize(("content", "pieces"), by_name(FILES))
def test_broken_file(tmp_path: Path, content: bytes, pieces: list[str]) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    message = refusal(path, tb.load_bearing)
    assert message.startswith(f"{path}: ")
    assert_told(message, pieces)


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
    with pytest.raises(tb.InputError) as caught:
        tb.load_bearing(name)
    assert_told(str(caught.value), pieces)


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
    ("step is no table", {"test": {"steps": ["cycles"]}}, [f"{STEP} = 'cycles'", "a table"]),
    ("no steps", {"test": {"steps": []}}, ["test.steps = []", "at least 1"]),
    ("steps missing", {"test": {"dt": "1 ms"}}, ['missing key "test.steps"']),
    ("two amplitudes", cycles(amplitude="3 mm"), [STEP, "exactly one", "got strain and amplitude"]),
    ("no amplitude", cycles(strain=REMOVED), [STEP, "exactly one of strain, amplitude; got none"]),
    ("no timing", cycles(speed=REMOVED), [STEP, "one of speed, period, frequency; got none"]),
    (
        "conflict beside a wrong unit",
        cycles(period="4 mm"),
        ["got speed and period", f"{STEP}.period = '4 mm'", "2 problems"],
    ),
    ("angles for cycles", cycles(speed=REMOVED, frequency="3 rad/s"), ["'3 rad/s'", "Hz"]),
    ("strain as text", cycles(strain="100 %"), [f"{STEP}.strain = '100 %'", "a number"]),
    ("strain in percent", cycles(strain=100), [f"{STEP}.strain = 100", "at most 5"]),
    ("amplitude in metres", cycles(strain=REMOVED, amplitude="3 m"), [STEP, "3000 mm", "500%"]),
    ("misspelt wave", cycles(wave="sin"), [f"{STEP}.wave = 'sin'", "'triangular'", '"sine"?']),
    ("misspelt key of a step", cycles(starin=1), [f'"{STEP}.starin"', '"strain"?']),
    ("creeping", cycles(speed="1e-6 mm/s"), ["test.dt = 0.01 s", f"at most {MAX_STEPS}"]),
    ("rest without end", steps({"step": "rest"}), [STEP, "one of duration, within; got none"]),
    ("rest with a temperature", steps({"step": "rest", "within": "5 degC"}), ["difference", " K"]),
    ("rest of an age", steps({"step": "rest", "duration": "1e300 s"}), ["at most 1e+08 s"]),
    ("ramp without speed", steps({"step": "ramp", "to": "5 mm"}), ["one of speed, duration"]),
    ("ramp too far", steps(RAMP | {"to": "1 m"}), [STEP, "1000 mm", "500%"]),
    ("cycles off zero", steps(RAMP, CYCLES), ["test.steps[1]", "at 5 mm", "put a ramp to 0 mm"]),
    ("negative dt", dt("-1 s"), ["test.dt = '-1 s'", "at least 1e-06 and at most 10 s"]),
    ("dt without unit", dt(0.005), ["test.dt = 0.005", '"0.005 s"']),
    (
        "misspelt scheme",
        {"analysis": {"scheme": "conservativ"}},
        ["'conservativ'", '"conservative"'],
    ),
    ("misspelt group", {"analysis": {"keep": ["rubbr"]}}, ["analysis.keep[0]", '"rubber"?']),
    ("keep is text", {"analysis": {"keep": "rubber"}}, ["analysis.keep = 'rubber'", "a list"]),
    ("eta 0.5", face(eta=0.5), ["analysis.upper_face.eta = 0.5", "at least 1 and at most 3"]),
    ("eta and film", face(eta=2.0, film="5 W/(m^2 K)"), ["analysis.upper_face", "either eta"]),
    ("neither", face(), ["analysis.upper_face", "either eta", "or film"]),
    (
        "half stack, unlike faces",
        {"analysis": {"stack": "half", "upper_face": {"eta": 3.0}}},
        ["alike"],
    ),
    ("hot air", {"ambient": "500 degC"}, ["ambient[0] = '500 degC'", "at most 100 degC"]),
    ("air without unit", {"ambient": [-20]}, ["ambient[0] = -20", '"-20 degC"']),
    ("air twice", {"ambient": ["5 degC", "5 degC"]}, ["ambient", "5 degC", "more than once"]),
    ("air and series", {"ambient_series": "night.csv"}, ["ambient or ambient_series, not both"]),
    ("unknown bearing", {"bearing": "shen-hdr-specimn"}, ['"shen-hdr-specimen"?']),
    ("missing bearing file", {"bearing": "mine.toml"}, ["bearing: ", "mine.toml: no such file"]),
    ("profile too short", {"initial_profile": ["1 degC"] * 2}, ["has 2 temperatures", "19 cells"]),
    ("lead in a bearing without", {"initial_lead": "5 degC"}, ["initial_lead", "with lead"]),
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
    ("misspelt lead ends", {"analysis": {"lead_ends": "halfspace"}}, ['"half-space"?']),
    ("two starts", {"initial": "1 degC", "initial_profile": ["1 degC"] * 19}, ["only one of"]),
    ("missing earlier result", {"initial_result": "none"}, ["initial_result", "no result.nc"]),
    ("misspelt case key", {"ambiant": "5 degC"}, ['unknown key "ambiant"', '"ambient"?']),
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
    assert_told(message, pieces)


def test_faults_of_a_bearing_within_a_case_are_told_with_the_others(tmp_path: Path) -> None:
    table = changed_table(specimen_table(), {G + "rubber_layers": 0, "kind": "HRD"})
    path = quick_case(tmp_path / "case.toml", bearing=table, ambient="500 degC")
    message = refusal(path, tb.load_case)
    told = ["3 problems", "bearing.geometry.rubber_layers = 0", "bearing.kind", "ambient[0]"]
    assert_told(message, told)


TEST = tb.cyclic_test(strain=[0.5], cycles=1)


@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"ambient": 500}, ["ambient[0] = '500.0 degC'", "at most 100 degC"]),
        ({"ambient": float("nan")}, ["ambient[0]", "not a finite number"]),
        ({"ambient": [1, float("inf")]}, ["ambient[1]", "not a finite number"]),
        ({"ambient": "cold"}, ["ambient[0] = 'cold'", '"1.5 degC"']),
        ({"ambient": True}, ["ambient[0] = True", '"1.5 degC"']),
        ({"scheme": "conservativ"}, ["analysis.scheme", 'did you mean "conservative"']),
        ({"heat_source": "sun"}, ["analysis.heat_source = 'sun'", "'dissipation'"]),
        ({"stack": "quarter"}, ["analysis.stack = 'quarter'", "'half'"]),
        ({"dt": "soon"}, ["test.dt = 'soon'", '"1.5 s"']),
        ({"dt": True}, ["test.dt = True", '"1.5 s"']),
        ({"upper_face": 2.0}, ["analysis.upper_face = 2.0", "must be a table"]),
        ({"keep": ["heat"]}, ["analysis.keep[0] = 'heat'", "'cells'"]),
        ({"keep": tb.Keep(every=0)}, ["analysis.keep_every = 0", "at least 1"]),
        ({"keep": tb.Keep(every=1.5)}, ["analysis.keep_every = 1.5", "integer"]),
        ({"initial": 500}, ["initial = '500.0 degC'", "at most 100 degC"]),
        ({"initial": [1, 2]}, ["has 2 temperatures", "19 cells"]),
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
    assert_told(str(caught.value), ["run(): ", *pieces])


@pytest.mark.parametrize(
    ("options", "pieces"),
    [
        ({"strain": [-1]}, ["steps[0].strain = -1", "at least 1e-06 and at most 5"]),
        ({"strain": [50, 100]}, ["steps[0].strain = 50", "steps[2].strain = 100"]),
        ({"strain": [float("nan")]}, ["strain = nan"]),
        ({"strain": None}, ["strain"]),
        ({"strain": []}, ["strain", "at least one"]),
        ({"cycles": 1.5}, ["count = 1.5", "integer"]),
        ({"wave": "sin"}, ["wave = 'sin'", '"sine"?']),
        ({"speed": 0}, ["speed = 0", "at least 1e-06 and at most 1e+06 mm/s"]),
        ({"dt": 100}, ["dt = 100", "at most 10 s"]),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_argument_of_cyclic_test(options: dict[str, Any], pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.cyclic_test(**options)
    assert_told(str(caught.value), ["cyclic_test(): ", *pieces])


@pytest.mark.parametrize(
    ("make", "pieces"),
    [
        (lambda: tb.EndFace(eta=5), ["EndFace()", "eta = 5", "at most 3"]),
        (lambda: tb.EndFace(eta=2.0, film=3.0), ["EndFace()", "either eta", "or film"]),
        (lambda: tb.EndFace(film=-3.0), ["film = -3.0", "at least 0 and at most 100000 W/(m^2 K)"]),
        (lambda: tb.CyclicTest(steps=[]), ["CyclicTest()", "steps = []", "at least 1"]),
        (lambda: tb.Ambient.constant(500), ["ambient", "500 degC", "-100 to 100 degC"]),
        (lambda: tb.Ambient.constant("cold"), ["ambient", "'cold'"]),
        (lambda: tb.Ambient.series([0, 1], [0]), ["equally long"]),
        (lambda: tb.Ambient.series([0, 0], [0, 1]), ["does not increase"]),
        (lambda: tb.Ambient.series([0, 1], [0, np.nan]), ["nan degC"]),
        (lambda: tb.Ambient.series([0, np.inf], [0, 1]), ["not finite"]),
        (lambda: tb.Ambient.series("night", "day"), ["numbers"]),
        (lambda: tb.load_result("no-such-result"), ["no-such-result", "no result.nc"]),
        (lambda: tb.load_result(__file__), [__file__, "not a result file"]),
    ],
    ids=range(13),
)
def test_bad_argument_elsewhere(make: Any, pieces: list[str]) -> None:
    with pytest.raises(tb.InputError) as caught:
        make()
    assert_told(str(caught.value), pieces)


def test_a_wrong_name_is_told_once_and_the_rest_is_checked() -> None:
    """Nothing takes the place of what cannot be loaded: only its own fault is reported."""
    names = ["shen-hdr-brige", "shen-lhdr-bridge"]
    with pytest.raises(tb.InputError) as caught:
        tb.bridge(names, "jra-ii-i-1", 500, structure="pier-p9", mass="heavy")
    starts = [text.split(" ")[0].rstrip(":") for text in caught.value.problems]
    assert starts == ["structure", "bearings[0]", "ambient[0]", "analysis.mass"]
